//! Error against time, and what nothing else beats in both.

use octogrid::{Kernel, Structure};

use super::measure::Point;
use super::variants;
use crate::report::plot::{Look, Marker, Series};

/// What a plot shows along y.
pub(super) type Along = fn(&Point) -> f64;

/// The points that no other one beats: in neither time nor error worse, and in one better.
///
/// Sorted by time.
pub(super) fn front(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut best = f64::INFINITY;
    sorted.retain(|point| {
        point.1 < best && {
            best = point.1;
            true
        }
    });
    sorted
}

/// A colour a kernel, a marker a structure, the front as a line, and a ring around the default.
pub(super) fn series(points: &[&Point], y: Along) -> Vec<Series> {
    let place = |point: &Point| point.ns.map(|ns| (ns.median, y(point)));
    let mut series = Vec::new();
    let all: Vec<(f64, f64)> = points.iter().filter_map(|p| place(p)).collect();
    let line = Look { colour: 6, marker: Marker::None };
    series.push(Series { name: "Pareto front".into(), points: front(&all), joined: true, look: Some(line) });
    for (colour, kernel) in Kernel::ALL.into_iter().enumerate() {
        for (structure, marker) in Structure::ALL.into_iter().rev().zip(Marker::FILLED) {
            let of = |p: &&&Point| p.kernel == kernel && p.structure.name() == structure.name();
            series.push(Series {
                name: format!("{}, {}", variants::name(kernel), structure.name()),
                points: points.iter().filter(of).filter_map(|p| place(p)).collect(),
                joined: false,
                look: Some(Look { colour, marker }),
            });
        }
    }
    let ring = Look { colour: 7, marker: Marker::Ring };
    let default = points.iter().filter(|p| p.default).filter_map(|p| place(p)).collect();
    series.push(Series { name: "default".into(), points: default, joined: false, look: Some(ring) });
    series
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_beats_the_front() {
        let points = [(3.0, 1.0), (1.0, 5.0), (2.0, 5.0), (2.0, 3.0), (4.0, 2.0), (5.0, 0.0), (6.0, 0.0)];
        assert_eq!(front(&points), [(1.0, 5.0), (2.0, 3.0), (3.0, 1.0), (5.0, 0.0)]);
        assert_eq!(front(&[]), []);
    }
}
