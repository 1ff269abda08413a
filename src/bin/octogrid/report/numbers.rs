//! Numbers for people.

/// A number with three digits and no more zeros than it needs.
pub(super) fn short(x: f64) -> String {
    let trim = |text: &str| text.trim_end_matches('0').trim_end_matches('.').to_owned();
    if x != 0.0 && !(1e-4..1e6).contains(&x.abs()) {
        let text = format!("{x:.2e}");
        return text.split_once('e').map_or(text.clone(), |(digits, e)| format!("{}e{e}", trim(digits)));
    }
    let digits = (2.0 - x.abs().max(1e-9).log10().floor()).clamp(0.0, 9.0) as usize;
    let text = format!("{x:.digits$}");
    if text.contains('.') { trim(&text) } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!([0.0, 0.05, 1.0, 2.5, 1000.0].map(short), ["0", "0.05", "1", "2.5", "1000"]);
        assert_eq!([1e-6, 2.5e9, -1.234e7].map(short), ["1e-6", "2.5e9", "-1.23e7"]);
    }
}
