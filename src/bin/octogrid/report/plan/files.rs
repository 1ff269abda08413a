//! What is said and written.

use octogrid::Part;
use serde::Serialize;

use super::bars::{self, Bars};
use super::measure::Point;
use super::rays::KINDS;
use super::savings::{IMAGES, Ratios, against, best, geometric_mean};
use super::variants::Kind;
use crate::failure::Failure;
use crate::report::folder::{Folder, stem};
use crate::report::machine::Machine;
use crate::report::numbers::short;
use crate::table;

/// All that a report says.
#[derive(Serialize)]
pub(super) struct Report {
    pub(super) machine: Machine,
    pub(super) rays: u32,
    pub(super) rounds: u16,
    /// The variants by scene.
    pub(super) scenes: Vec<Vec<Point>>,
}

/// What the work of a ray is counted in.
fn work(report: &Report) -> &'static str {
    let compared = report.scenes.iter().flatten().filter(|point| point.kind != Kind::Structure);
    let counted = compared.into_iter().all(|point| point.instructions_a_ray.is_some());
    if counted { "instructions" } else { "clusters and lines" }
}

/// The whole plan, each part, and the choice.
pub(super) fn tables(report: &Report) -> String {
    format!(
        "The plan relative to all parts (below 1 it saves):\n{}\n\n\
         The plan relative to one part the other way round, geometric means:\n{}\n\n\
         Time to an image, build and rays of three kinds as streams, relative to the best structure and quality:\n{}",
        whole(report),
        parts(report),
        choices(report)
    )
}

fn ratios(ratios: &Ratios) -> [String; 4] {
    ratios.all().map(|ratio| format!("{ratio:.2}"))
}

fn whole(report: &Report) -> String {
    let header = ["scene", "triangles", "plan", "bytes/tri", "bytes", work(report), "time", "build"];
    let all = against(&report.scenes, Kind::All);
    let row = |(plan, r): &(&Point, Ratios)| {
        let [bytes, work, time, build] = ratios(r);
        let (triangles, bytes_each) = (plan.triangles.to_string(), short(plan.bytes_a_triangle));
        [stem(&plan.scene), triangles, plan.structure.clone(), bytes_each, bytes, work, time, build]
    };
    let mut rows: Vec<_> = all.iter().map(row).collect();
    let only: Vec<Ratios> = all.iter().map(|(_, ratios)| *ratios).collect();
    if let Some(mean) = Ratios::mean(&only) {
        let [bytes, work, time, build] = ratios(&mean);
        let name = "geometric mean".to_owned();
        rows.push([name, String::new(), String::new(), String::new(), bytes, work, time, build]);
    }
    table::grid(header, rows).to_string()
}

fn parts(report: &Report) -> String {
    let header = ["part", "", "scenes", "bytes", work(report), "time", "build", "most saved, of these"];
    let mut rows = Vec::new();
    for part in Part::ALL {
        for (keep, what) in [(true, "left out"), (false, "kept")] {
            let found = against(&report.scenes, Kind::Flipped(part, keep));
            let only: Vec<Ratios> = found.iter().map(|(_, ratios)| *ratios).collect();
            let Some(mean) = Ratios::mean(&only) else { continue };
            let [bytes, work, time, build] = ratios(&mean);
            let least = |r: &Ratios| r.bytes.min(r.work).min(r.time);
            let most = found.iter().min_by(|a, b| least(&a.1).total_cmp(&least(&b.1)));
            let most = most.map_or(String::new(), |(plan, r)| {
                format!("{} ({:.2} {:.2} {:.2})", stem(&plan.scene), r.bytes, r.work, r.time)
            });
            let scenes = found.len().to_string();
            rows.push([part.name().to_owned(), what.to_owned(), scenes, bytes, work, time, build, most]);
        }
    }
    table::grid(header, rows).to_string()
}

fn choices(report: &Report) -> String {
    let header = ["scene", "10^5 rays", "best", "10^6 rays", "best", "10^7 rays", "best"];
    let name = |point: &Point| if point.kind == Kind::Plan { "plan" } else { &point.variant }.to_owned();
    let row = |points: &Vec<Point>| {
        let [a, b, c] = IMAGES.map(|rays| best(points, rays));
        let ratio = |x: f64| format!("{x:.2}");
        [stem(&points[0].scene), ratio(a.1), name(a.0), ratio(b.1), name(b.0), ratio(c.1), name(c.0)]
    };
    let mut rows: Vec<_> = report.scenes.iter().map(row).collect();
    if !rows.is_empty() {
        let mean = |rays| geometric_mean(report.scenes.iter().map(|points| best(points, rays).1));
        let [a, b, c] = IMAGES.map(|rays| format!("{:.2}", mean(rays)));
        let none = String::new;
        rows.push(["geometric mean".to_owned(), a, none(), b, none(), c, none()]);
    }
    table::grid(header, rows).to_string()
}

/// Writes `report.json`, `report.csv` and `savings.svg`.
///
/// # Errors
/// Where the system does.
pub(super) fn write(folder: &Folder, report: &Report) -> Result<(), Failure> {
    folder.write_json("report.json", report)?;
    folder.write("report.csv", &csv(&report.scenes))?;
    let saved = |ratio: f64| 100.0 * (1.0 - ratio);
    let bars = Bars {
        title: "what the plan leaves out, relative to all parts",
        unit: "% saved",
        series: &["bytes", work(report), "time of rays"],
        rows: against(&report.scenes, Kind::All)
            .iter()
            .map(|(plan, r)| (stem(&plan.scene), vec![saved(r.bytes), saved(r.work), saved(r.time)]))
            .collect(),
    };
    let svg = bars::svg(&bars).map_err(|e| Failure::Expected(e.to_string()))?;
    folder.write("savings.svg", &svg)
}

/// One line a scene and variant.
fn csv(scenes: &[Vec<Point>]) -> String {
    let mut text = "scene,triangles,variant,structure,bytes_a_triangle,build_ms".to_owned();
    KINDS.iter().for_each(|kind| text += &format!(",{kind}_ns_a_ray"));
    KINDS.iter().for_each(|kind| text += &format!(",{kind}_stream_ns_a_ray"));
    text += ",clusters_a_ray,cache_lines_a_ray,instructions_a_ray\n";
    for p in scenes.iter().flatten() {
        text += &format!("\"{}\",{},{},\"{}\"", p.scene, p.triangles, p.variant, p.structure);
        text += &format!(",{},{}", p.bytes_a_triangle, p.image_ms(0.0));
        for spread in p.ns_a_ray.iter().chain(&p.stream_ns_a_ray) {
            text += &spread.map_or(",".to_owned(), |spread| format!(",{}", spread.median));
        }
        let instructions = p.instructions_a_ray.map_or(String::new(), |count| count.to_string());
        text += &format!(",{},{},{instructions}\n", p.clusters_a_ray, p.cache_lines_a_ray);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_scenes_are_no_failure() {
        let report = Report { machine: Machine::here(), rays: 1, rounds: 1, scenes: Vec::new() };
        assert!(tables(&report).contains("best structure and quality"));
        assert_eq!(csv(&report.scenes).lines().count(), 1);
    }
}
