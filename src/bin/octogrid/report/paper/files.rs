//! The files of a report.

use serde::Serialize;

use super::columns::{Column, Measure, REFERENCE, find};
use super::conclusions::Conclusion;
use super::families;
use super::measure::Measured;
use super::published;
use crate::failure::Failure;
use crate::report::folder::Folder;
use crate::report::machine::Machine;
use crate::report::plot::{Labels, Scale};
use crate::report::statistics::Spread;

/// All that a report says.
#[derive(Serialize)]
pub(super) struct Report<'a> {
    pub(super) machine: Machine,
    pub(super) size: [u32; 2],
    pub(super) rounds: usize,
    pub(super) full: bool,
    pub(super) scenes: &'a [Measured],
    pub(super) paper: [Vec<Column>; 2],
    pub(super) conclusions: &'a [Conclusion],
    pub(super) conclusions_of_papers_figures: &'a [Conclusion],
}

/// Writes `report.json`, `report.csv` and two plots a scene.
///
/// # Errors
/// Where the system does.
pub(super) fn write(folder: &Folder, report: &Report) -> Result<(), Failure> {
    folder.write_json("report.json", report)?;
    folder.write("report.csv", &csv(report.scenes))?;
    for measured in report.scenes {
        for (measure, suffix) in [(Measure::Memory, "memory"), (Measure::Preprocessing, "preprocessing")] {
            let title = format!("{}: speed against {suffix}", measured.scene);
            let labels =
                Labels { title: &title, x: measure.label(), y: "speed, Mray/s", scale: Scale::Linear };
            let name = format!("{}-{suffix}.svg", measured.scene);
            folder.write_plot(&name, &labels, &families::series(measured, measure))?;
        }
    }
    Ok(())
}

/// One line a scene, structure and measure; empty where there is no figure.
fn csv(scenes: &[Measured]) -> String {
    let mut text =
        "scene,structure,measure,median,low,high,to_reference,paper,paper_to_reference\n".to_owned();
    for measured in scenes {
        let paper = published::columns(measured.scene);
        for (column, work) in measured.columns.iter().zip(&measured.work) {
            let start = format!("{},\"{}\"", measured.scene, column.structure);
            for measure in Measure::ALL {
                let figures = [&measured.columns, &paper].map(|columns| figures(columns, column, measure));
                let label = measure.label().replace(", ", "_").to_lowercase();
                text += &format!("{start},{label},{},{}\n", figures[0].0, figures[1].1);
            }
            for (name, count) in ["voxels_a_ray", "clusters_a_ray", "cache_lines_a_ray"].iter().zip(work) {
                text += &format!("{start},{name},{count},{count},{count},,,\n");
            }
        }
    }
    text
}

/// Median, interval and ratio to the reference; and median and ratio alone.
fn figures(columns: &[Column], column: &Column, measure: Measure) -> (String, String) {
    let samples = |name: &str| find(columns, name).map(|c| c.samples(measure));
    let spread = samples(&column.structure).and_then(Spread::of);
    let ratio = samples(&column.structure).zip(samples(REFERENCE));
    let ratio = ratio.and_then(|(own, reference)| Spread::of_ratios(own, reference));
    match (spread, ratio) {
        (Some(spread), Some(ratio)) => (
            format!("{},{},{},{}", spread.median, spread.low, spread.high, ratio.median),
            format!("{},{}", spread.median, ratio.median),
        ),
        _ => (",,,".to_owned(), ",".to_owned()),
    }
}
