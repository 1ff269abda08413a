//! The tables of a report on the terminal.

use comfy_table::Table;

use super::files::{ClosedRow, HazardRow, Report};
use crate::table;

/// Both tables, the first failure, and how to go on.
pub(super) fn all(report: &Report) -> String {
    let Report { seed, from_round, end_round, rays, failures, .. } = report;
    let first =
        report.first_failure.as_ref().map_or(String::new(), |text| format!("\nfirst failure: {text}"));
    format!(
        "\n{}\n\n{}\n{first}\n\
         {rays} rays, {failures} failures; --seed {seed} --from-round {from_round} to {}\n\
         go on with --seed {seed} --from-round {end_round}",
        hazards(&report.hazards),
        closed(&report.closed),
        end_round.saturating_sub(1),
    )
}

fn hazards(rows: &[HazardRow]) -> Table {
    let row = |row: &HazardRow| {
        let exact = 100.0 * row.exact as f64 / row.rays.max(1) as f64;
        [
            row.hazard.to_owned(),
            row.scenes.join("; "),
            row.triangles.to_string(),
            row.rays.to_string(),
            format!("brute force 100%, exact {exact:.1}%"),
            row.failures.to_string(),
        ]
    };
    let header = ["hazard", "scenes", "triangles", "rays", "compared with", "failures"];
    table::grid(header, rows.iter().map(row))
}

fn closed(rows: &[ClosedRow]) -> Table {
    let row = |row: &ClosedRow| {
        [
            row.mesh.clone(),
            row.triangles.to_string(),
            row.inside.to_string(),
            row.escapes.to_string(),
            row.outside.to_string(),
            row.miscounts.to_string(),
        ]
    };
    let header = ["closed mesh", "triangles", "from inside", "escapes", "from outside", "wrong parity"];
    table::grid(header, rows.iter().map(row))
}
