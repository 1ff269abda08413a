//! Numbers for people.

/// A number with three digits and no more zeros than it needs.
pub(super) fn short(x: f64) -> String {
    let digits = (2.0 - x.abs().max(1e-9).log10().floor()).clamp(0.0, 9.0) as usize;
    let text = format!("{x:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!([0.0, 0.05, 1.0, 2.5, 1000.0].map(short), ["0", "0.05", "1", "2.5", "1000"]);
    }
}
