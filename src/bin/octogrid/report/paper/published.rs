//! The paper's own figures: a Pentium III at 450 MHz, 800 x 600, one ray a pixel, direct light.

use super::columns::Column;

/// A structure with rendering in seconds, memory in KB and preprocessing in seconds.
type Row = (&'static str, f64, f64, f64);

/// Scene 1: 97,036 triangles, 39 lights.
const INTERIOR: [Row; 10] = [
    ("R[10,4]", 114.0, 7965.5, 10.044),
    ("R[16,4]", 114.0, 6280.3, 8.211),
    ("R[22,4]", 113.0, 5110.9, 6.850),
    ("R[31,4]", 116.0, 4091.6, 5.718),
    ("O[2,15]", 123.0, 16324.2, 9.825),
    ("O[4,15]", 124.0, 11145.8, 6.529),
    ("O[6,15]", 127.0, 8446.92, 4.97),
    ("O[8,15]", 129.0, 7003.86, 4.006),
    ("R[19,4] without top grid", 128.0, 5759.0, 7.911),
    ("R[19,2]", 128.0, 3107.6, 5.44),
];

/// Scene 2: a room with a table and chairs, 3,368 triangles, 5 lights.
const ROOM: [Row; 10] = [
    ("R[10,4]", 41.0, 403.004, 0.37),
    ("R[16,4]", 38.0, 175.2, 0.19),
    ("R[22,4]", 39.0, 92.90, 0.13),
    ("R[31,4]", 40.0, 73.24, 0.1),
    ("O[2,15]", 37.0, 172.852, 0.08),
    ("O[4,15]", 37.0, 109.9, 0.05),
    ("O[6,15]", 40.0, 80.6, 0.04),
    ("O[8,15]", 41.0, 60.81, 0.03),
    ("R[19,4] without top grid", 105.0, 127.16, 0.14),
    ("R[19,2]", 100.0, 75.12, 0.11),
];

/// The paper's figures for a scene of ours; none where it has none.
///
/// It calls \[19,4\] the optimum but prints no figures there: R\[19,4\] is halfway between its
/// neighbours R\[16,4\] and R\[22,4\].
pub(super) fn columns(scene: &str) -> Vec<Column> {
    let rows = match scene {
        "interior" => &INTERIOR,
        "room" => &ROOM,
        _ => return Vec::new(),
    };
    let [below, above] = [rows[1], rows[2]];
    let middle = |a: f64, b: f64| f64::midpoint(a, b);
    let reference = ("R[19,4]", middle(below.1, above.1), middle(below.2, above.2), middle(below.3, above.3));
    std::iter::once(&reference).chain(rows).map(column).collect()
}

fn column(&(structure, rendering, memory, preprocessing): &Row) -> Column {
    Column {
        structure: structure.to_owned(),
        rendering: vec![rendering],
        memory: vec![memory],
        preprocessing: vec![preprocessing],
    }
}
