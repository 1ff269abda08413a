//! Sine and cosine from additions and multiplications alone: the functions of the platform's
//! maths library differ in the last bits, and scenes must not.

use std::f64::consts::TAU;

/// Sine and cosine of an angle in full turns; good to 1e-15 for small angles.
pub(crate) fn sin_cos(turns: f64) -> (f64, f64) {
    let quarter = (turns * 4.0).round();
    let x = (turns - quarter / 4.0) * TAU;
    let (sin, cos) = (sin_taylor(x), cos_taylor(x));
    match quarter.rem_euclid(4.0) as u32 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// |x| <= pi / 4, where the first term left out is below 1e-16.
fn sin_taylor(x: f64) -> f64 {
    let (mut term, mut sum) = (x, x);
    for k in 1..8 {
        let n = f64::from(2 * k);
        term *= -x * x / (n * (n + 1.0));
        sum += term;
    }
    sum
}

/// |x| <= pi / 4, where the first term left out is below 1e-16.
fn cos_taylor(x: f64) -> f64 {
    let (mut term, mut sum) = (1.0, 1.0);
    for k in 1..9 {
        let n = f64::from(2 * k);
        term *= -x * x / (n * (n - 1.0));
        sum += term;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_the_library() {
        for i in -1000..1000 {
            let turns = f64::from(i) / 365.0;
            let (sin, cos) = sin_cos(turns);
            assert!((sin - (turns * TAU).sin()).abs() < 1e-13, "sine of {turns} turns");
            assert!((cos - (turns * TAU).cos()).abs() < 1e-13, "cosine of {turns} turns");
        }
    }

    #[test]
    fn quarters_are_exact() {
        assert_eq!(sin_cos(0.25), (1.0, 0.0));
        assert_eq!(sin_cos(0.5), (0.0, -1.0));
        assert_eq!(sin_cos(0.75), (-1.0, 0.0));
    }
}
