//! What is said and written.

use serde::Serialize;

use super::measure::{Cost, Point};
use crate::failure::Failure;
use crate::report::fit;
use crate::report::folder::{Folder, stem};
use crate::report::machine::Machine;
use crate::report::numbers::short;
use crate::report::plot::{Labels, Scale, Series};
use crate::report::statistics::Spread;
use crate::table;

const AXES: Labels = Labels { title: "", x: "triangles", y: "", scale: Scale::Log };

/// All that a report says.
#[derive(Serialize)]
pub(super) struct Report<'a> {
    pub(super) machine: Machine,
    pub(super) rays: u32,
    pub(super) rounds: u16,
    pub(super) seed: u64,
    pub(super) points: &'a [Point],
}

/// One row a scene and size.
pub(super) fn table(report: &Report) -> String {
    let header = [
        "scene",
        "triangles",
        "bytes/triangle",
        "build, ns/triangle",
        "speed-up",
        "trace, ns/ray",
        "speed-up",
    ];
    let spread = |s: Option<Spread>, number: fn(f64) -> String| {
        s.map_or("-".to_owned(), |s| format!("{} ({}-{})", number(s.median), number(s.low), number(s.high)))
    };
    let ns = |cost: &Cost| spread(cost.ns, short);
    let speedup = |cost: &Cost| spread(cost.speedup, |x| format!("{x:.2}"));
    let row = |p: &Point| {
        [
            p.scene.clone(),
            p.triangles.to_string(),
            short(p.bytes_a_triangle),
            ns(&p.build),
            speedup(&p.build),
            ns(&p.trace),
            speedup(&p.trace),
        ]
    };
    format!(
        "times on one thread, and their ratio to those on {}: medians of {} rounds, with intervals\n{}",
        report.machine.threads,
        report.rounds,
        table::grid(header, report.points.iter().map(row))
    )
}

/// Writes `report.json`, `report.csv` and the plots.
///
/// # Errors
/// Where the system does.
pub(super) fn write(folder: &Folder, report: &Report) -> Result<(), Failure> {
    folder.write_json("report.json", report)?;
    folder.write("report.csv", &csv(report.points))?;
    let median = |cost: &Cost| cost.ns.map_or(f64::NAN, |s| s.median);
    let build =
        Labels { title: "build time by size of the scene", y: "build on one thread, ns a triangle", ..AXES };
    folder.write_plot("build.svg", &build, &series(report.points, |p| median(&p.build)))?;
    let trace =
        Labels { title: "trace time by size of the scene", y: "closest hit on one thread, ns a ray", ..AXES };
    folder.write_plot("trace.svg", &trace, &series(report.points, |p| median(&p.trace)))
}

/// A line a scene, named with its slope.
fn series(points: &[Point], y: impl Fn(&Point) -> f64) -> Vec<Series> {
    let series = |of_scene: &[Point]| {
        let points: Vec<(f64, f64)> = of_scene.iter().map(|p| (p.triangles as f64, y(p))).collect();
        let slope = fit::slope(&points).map_or(String::new(), |slope| format!(", slope {slope:.2}"));
        let scene = of_scene.first().map_or(String::new(), |p| stem(&p.scene));
        Series { name: format!("{scene}{slope}"), points, joined: true, look: None }
    };
    points.chunk_by(|a, b| a.scene == b.scene).map(series).collect()
}

/// One line a scene and size.
fn csv(points: &[Point]) -> String {
    let mut text = "scene,triangles,bytes_a_triangle".to_owned();
    for name in ["build_ns_a_triangle", "build_speedup", "trace_ns_a_ray", "trace_speedup"] {
        text += &format!(",{name},{name}_low,{name}_high");
    }
    text += "\n";
    for p in points {
        text += &format!("\"{}\",{},{}", p.scene, p.triangles, p.bytes_a_triangle);
        for spread in [p.build.ns, p.build.speedup, p.trace.ns, p.trace.speedup] {
            let fields = spread.map(|s| format!(",{},{},{}", s.median, s.low, s.high));
            text += fields.as_deref().unwrap_or(",,,");
        }
        text += "\n";
    }
    text
}
