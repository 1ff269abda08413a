//! Which columns make a curve.

use super::columns::{Column, Measure, find};
use super::measure::Measured;
use crate::report::plot::Series;
use crate::report::statistics::Spread;

/// Curves by rising threshold; every other structure is a point of its own.
const CURVES: [(&str, &[&str]); 2] = [
    ("R[10..31,4]", &["R[10,4]", "R[16,4]", "R[19,4]", "R[22,4]", "R[31,4]"]),
    ("O[2..8,15]", &["O[2,15]", "O[4,15]", "O[6,15]", "O[8,15]"]),
];

/// Speed, in Mray/s, against a measure.
pub(super) fn series(measured: &Measured, against: Measure) -> Vec<Series> {
    let point = |column: &Column| {
        let median = |measure| Spread::of(column.samples(measure)).map(|s| s.median);
        let seconds = median(Measure::Rendering)?;
        Some((median(against)?, measured.rays() as f64 / seconds / 1e6))
    };
    let named = |name: &&str| find(&measured.columns, name).and_then(point);
    let curves = CURVES.iter().map(|(name, members)| Series {
        name: (*name).to_owned(),
        points: members.iter().filter_map(named).collect(),
        joined: true,
        look: None,
    });
    let alone = measured.columns.iter().filter(|c| !CURVES.iter().any(|f| f.1.contains(&&*c.structure)));
    let points = alone.map(|column| Series {
        name: column.structure.clone(),
        points: point(column).into_iter().collect(),
        joined: false,
        look: None,
    });
    curves.chain(points).collect()
}
