//! What a report says, and its files.

use serde::Serialize;

use super::{Found, Round, closed, hazards};
use crate::failure::Failure;
use crate::report::folder::Folder;
use crate::report::machine::Machine;

/// All that a report says.
#[derive(Serialize)]
pub(super) struct Report {
    pub(super) machine: Machine,
    pub(super) seed: u64,
    pub(super) from_round: u64,
    /// The round after the last one.
    pub(super) end_round: u64,
    pub(super) rays: u64,
    pub(super) failures: u64,
    pub(super) hazards: Vec<HazardRow>,
    pub(super) closed: Vec<ClosedRow>,
    pub(super) first_failure: Option<String>,
}

/// A hazard on all of its scenes.
#[derive(Serialize)]
pub(super) struct HazardRow {
    pub(super) hazard: &'static str,
    pub(super) scenes: Vec<&'static str>,
    /// The most triangles of a scene.
    pub(super) triangles: usize,
    pub(super) rays: u64,
    /// Rays that were compared with exact arithmetic too.
    pub(super) exact: u64,
    pub(super) failures: u64,
}

/// A closed mesh.
#[derive(Serialize)]
pub(super) struct ClosedRow {
    pub(super) mesh: String,
    pub(super) triangles: usize,
    pub(super) inside: u64,
    pub(super) escapes: u64,
    pub(super) outside: u64,
    /// Rays from inside with an even number of crossings and from outside with an odd one.
    pub(super) miscounts: u64,
}

impl Report {
    /// Of the rounds from `from` until before `end`.
    pub(super) fn new(
        machine: Machine,
        from: Round,
        end: Round,
        cases: &[hazards::Case<'_>],
        meshes: &[closed::Case<'_>],
    ) -> Self {
        let hazards: Vec<HazardRow> =
            cases.chunk_by(|a, b| a.hazard.name == b.hazard.name).map(HazardRow::new).collect();
        let closed: Vec<ClosedRow> = meshes.iter().map(ClosedRow::new).collect();
        let found = cases.iter().map(|case| &case.tally.first).chain(meshes.iter().map(|m| &m.tally.first));
        let first = found.fold(None, |first, found| Found::first(first, found.clone()));
        Self {
            machine,
            seed: from.seed,
            from_round: from.number,
            end_round: end.number,
            rays: hazards.iter().map(|row| row.rays).sum::<u64>()
                + closed.iter().map(ClosedRow::rays).sum::<u64>(),
            failures: hazards.iter().map(|row| row.failures).sum::<u64>()
                + closed.iter().map(|row| row.escapes + row.miscounts).sum::<u64>(),
            hazards,
            closed,
            first_failure: first.map(|found| found.text),
        }
    }
}

impl HazardRow {
    fn new(cases: &[hazards::Case<'_>]) -> Self {
        let mut sum = hazards::Tally::default();
        cases.iter().for_each(|case| sum += case.tally.clone());
        Self {
            hazard: cases[0].hazard.name,
            scenes: cases.iter().map(|case| case.scene.name).collect(),
            triangles: sum.triangles,
            rays: sum.rays,
            exact: sum.exact,
            failures: sum.failures,
        }
    }
}

impl ClosedRow {
    fn new(case: &closed::Case<'_>) -> Self {
        let closed::Tally { triangles, inside, escapes, outside, miscounts, .. } = case.tally;
        Self { mesh: case.name.to_owned(), triangles, inside, escapes, outside, miscounts }
    }

    fn rays(&self) -> u64 {
        self.inside + self.outside
    }
}

/// Writes `report.json` and `report.csv`.
///
/// # Errors
/// Where the system does.
pub(super) fn write(folder: &Folder, report: &Report) -> Result<(), Failure> {
    folder.write_json("report.json", report)?;
    folder.write("report.csv", &csv(report))
}

/// One line a hazard and a closed mesh.
fn csv(report: &Report) -> String {
    let mut text = "kind,name,scenes,triangles,rays,exact,failures\n".to_owned();
    for row in &report.hazards {
        let HazardRow { hazard, scenes, triangles, rays, exact, failures } = row;
        text +=
            &format!("hazard,\"{hazard}\",\"{}\",{triangles},{rays},{exact},{failures}\n", scenes.join(", "));
    }
    for row in &report.closed {
        let (mesh, triangles, failures) = (&row.mesh, row.triangles, row.escapes + row.miscounts);
        text += &format!("closed mesh,\"{mesh}\",\"{mesh}\",{triangles},{},0,{failures}\n", row.rays());
    }
    text
}
