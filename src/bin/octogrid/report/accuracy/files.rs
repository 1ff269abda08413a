//! What is said and written.

use octogrid::Structure;
use serde::Serialize;

use super::errors::Ulps;
use super::measure::{ALL, Point};
use super::pareto::{self, Along};
use super::truth::SAMPLE;
use super::variants;
use crate::failure::Failure;
use crate::report::folder::{Folder, stem};
use crate::report::machine::Machine;
use crate::report::numbers::short;
use crate::report::plot::{Labels, Scale};
use crate::table;

/// All that a report says.
#[derive(Serialize)]
pub(super) struct Report<'a> {
    pub(super) machine: Machine,
    pub(super) seed: u64,
    pub(super) rounds: usize,
    pub(super) scenes: &'a [Measured],
}

/// What was measured on a scene.
#[derive(Serialize)]
pub(super) struct Measured {
    pub(super) scene: String,
    pub(super) triangles: usize,
    pub(super) points: Vec<Point>,
}

/// Every kernel: on the default structure by set of rays, and on each structure over all sets.
pub(super) fn tables(measured: &Measured) -> String {
    let Measured { scene, triangles, points } = measured;
    let by_set = points.iter().filter(|p| p.structure == Structure::HYBRID);
    let is_default = |p: &&Point| Structure::ALL.contains(&p.structure);
    let by_structure = points.iter().filter(|p| p.set == ALL).filter(is_default);
    format!(
        "{scene}: {triangles} triangles; errors are differences from exact arithmetic (the triangle from\n\
         the exact kernel, which on {SAMPLE} rays a set was compared with exact arithmetic over all triangles)\n\
         {}\n\n{}",
        table::grid(header("set"), by_set.map(|p| row(p.set.to_owned(), p))),
        table::grid(header("structure"), by_structure.map(|p| row(p.structure.to_string(), p))),
    )
}

fn header(first: &'static str) -> [&'static str; 9] {
    [first, "kernel", "ns/ray", "to plain", "wrong hits", "wrong ids", "t, ulps", "u, ulps", "v, ulps"]
}

/// Ulps are median, 99.9% and maximum.
fn row(first: String, point: &Point) -> [String; 9] {
    let e = &point.errors;
    let count = |n: usize| match n {
        0 => "0".to_owned(),
        _ => format!("{n} ({}%)", short(100.0 * n as f64 / e.rays as f64)),
    };
    let ulps = |u: &Ulps| [u.median, u.high, u.max].map(|x| short(x.into())).join(" ");
    [
        first,
        variants::name(point.kernel),
        point.ns.map_or("-".to_owned(), |ns| short(ns.median)),
        point.to_plain.map_or("-".to_owned(), |s| format!("{:.2} ({:.2}-{:.2})", s.median, s.low, s.high)),
        count(e.wrong_hits),
        count(e.wrong_ids),
        ulps(&e.t),
        ulps(&e.u),
        ulps(&e.v),
    ]
}

/// Writes `report.json`, `report.csv` and the plots.
///
/// # Errors
/// Where the system does.
pub(super) fn write(folder: &Folder, report: &Report) -> Result<(), Failure> {
    folder.write_json("report.json", report)?;
    folder.write("report.csv", &csv(report.scenes))?;
    report.scenes.iter().try_for_each(|measured| plots(folder, measured))
}

/// Wrong answers of each set and of all sets, and the error of t of all sets.
fn plots(folder: &Folder, measured: &Measured) -> Result<(), Failure> {
    const WRONG: (&str, &str, Along) = ("wrong", "wrong answers, share of rays", |p| p.errors.wrong);
    const T: (&str, &str, Along) = ("t", "error of t at 99.9% of hits, ulps", |p| p.errors.t.high.into());
    let stem = stem(&measured.scene);
    for of_set in measured.points.chunk_by(|a, b| a.set == b.set) {
        let points: Vec<&Point> = of_set.iter().collect();
        let Some(set) = points.first().map(|p| p.set) else { continue };
        for (suffix, label, y) in [WRONG, T] {
            let title = format!("{stem}, {set} rays: error against run time");
            let labels =
                Labels { title: &title, x: "time a ray on one thread, ns", y: label, scale: Scale::Log };
            folder.write_plot(&format!("{stem}-{set}-{suffix}.svg"), &labels, &pareto::series(&points, y))?;
        }
    }
    Ok(())
}

/// One line a scene, set, kernel and structure.
fn csv(scenes: &[Measured]) -> String {
    let mut text = "scene,set,kernel,structure,default,ns,ns_low,ns_high,to_plain,to_plain_low,to_plain_high,\
                    rays,wrong_hits,wrong_ids,t_median,t_99.9,t_max,u_median,u_99.9,u_max,v_median,v_99.9,v_max\n"
        .to_owned();
    for Measured { scene, points, .. } in scenes {
        for p in points {
            let e = &p.errors;
            text += &format!(
                "\"{scene}\",{},{},\"{}\",{}",
                p.set,
                variants::name(p.kernel),
                p.structure,
                p.default
            );
            for spread in [p.ns, p.to_plain] {
                let fields = spread.map(|s| format!(",{},{},{}", s.median, s.low, s.high));
                text += fields.as_deref().unwrap_or(",,,");
            }
            text += &format!(",{},{},{}", e.rays, e.wrong_hits, e.wrong_ids);
            for Ulps { median, high, max } in [e.t, e.u, e.v] {
                text += &format!(",{median},{high},{max}");
            }
            text += "\n";
        }
    }
    text
}
