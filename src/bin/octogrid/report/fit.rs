//! The slope of points on logarithmic axes.

/// The exponent of the power law with the least squares of the differences of logarithms.
///
/// None without two different x, and where a number is not above 0.
pub(super) fn slope(points: &[(f64, f64)]) -> Option<f64> {
    let logs: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let mean = |of: fn(&(f64, f64)) -> f64| logs.iter().map(of).sum::<f64>() / logs.len() as f64;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let squares: f64 = logs.iter().map(|p| (p.0 - x).powi(2)).sum();
    let products: f64 = logs.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    Some(products / squares).filter(|slope| slope.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_exponent_is_found_again() {
        let points = [1.0, 2.0, 5.0, 40.0].map(|x: f64| (x, 3.0 * x.powf(-0.5)));
        assert!((slope(&points).unwrap() + 0.5).abs() < 1e-12);
    }

    #[test]
    fn noise_of_either_sign_cancels() {
        let points = [(1.0, 1.1), (10.0, 0.1 / 1.1), (100.0, 0.01 / 1.1), (1000.0, 0.0011)];
        assert!((slope(&points).unwrap() + 1.0).abs() < 1e-12);
    }

    #[test]
    fn no_line_is_none() {
        for points in [&[][..], &[(1.0, 2.0)], &[(1.0, 2.0), (1.0, 3.0)], &[(1.0, 0.0), (2.0, 1.0)]] {
            assert_eq!(slope(points), None, "{points:?}");
        }
    }
}
