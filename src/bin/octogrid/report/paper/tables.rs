//! The tables of a report on the terminal.

use comfy_table::Table;

use super::columns::{Column, Measure, REFERENCE, find};
use super::conclusions::Conclusion;
use super::measure::Measured;
use super::published;
use crate::report::statistics::Spread;
use crate::table;

/// One row a structure: ours, relative to the reference, and the paper's.
pub(super) fn figures(measured: &Measured) -> String {
    let rays = |traced: usize, total: usize, kind: &str| format!("{traced} of {total} {kind} rays");
    let primary = rays(measured.traced_primary_rays, measured.primary_rays, "primary");
    let shadow = rays(measured.traced_shadow_rays, measured.shadow_rays, "shadow");
    let (scene, triangles) = (measured.scene, measured.triangles);
    format!(
        "{scene}: {triangles} triangles; traced {primary} and {shadow}, times are those of all\n{}\n\n{}",
        times(measured),
        comparison(measured)
    )
}

fn times(measured: &Measured) -> Table {
    let header = [
        "structure",
        "rendering, s",
        "interval",
        "memory, KB",
        "preproc., s",
        "interval",
        "voxels/ray",
        "clusters/ray",
        "lines/ray",
    ];
    let rows = measured.columns.iter().zip(&measured.work).map(|(column, work)| {
        let spread = |measure| measured.spread(column, measure);
        let median = |measure| spread(measure).map_or(String::new(), |s| digits(s.median));
        let interval = |measure| {
            spread(measure).map_or(String::new(), |s| format!("{}-{}", digits(s.low), digits(s.high)))
        };
        [
            column.structure.clone(),
            median(Measure::Rendering),
            interval(Measure::Rendering),
            median(Measure::Memory),
            median(Measure::Preprocessing),
            interval(Measure::Preprocessing),
            format!("{:.2}", work[0]),
            format!("{:.2}", work[1]),
            format!("{:.2}", work[2]),
        ]
    });
    table::grid(header, rows)
}

/// Relative to the reference, beside the paper's figures.
fn comparison(measured: &Measured) -> Table {
    let header = [
        "relative to R[19,4]",
        "rendering",
        "paper",
        "memory",
        "paper",
        "preproc.",
        "paper",
        "paper, s",
        "paper, KB",
        "paper, s",
    ];
    let paper = published::columns(measured.scene);
    let rows = measured.columns.iter().map(|column| {
        let mut row = vec![column.structure.clone()];
        for measure in Measure::ALL {
            row.push(relative(&measured.columns, column, measure));
            row.push(relative(&paper, column, measure));
        }
        let own = |measure| find(&paper, &column.structure).map_or(&[][..], |c| c.samples(measure));
        row.extend(Measure::ALL.map(|m| own(m).first().map_or("-".to_owned(), |&x| digits(x))));
        row
    });
    table::grid(header, rows)
}

/// The ratio of a column to the reference, where both have figures.
fn relative(columns: &[Column], column: &Column, measure: Measure) -> String {
    let samples = |name: &str| find(columns, name).map(|c| c.samples(measure));
    let pair = samples(&column.structure).zip(samples(REFERENCE));
    let ratio = pair.and_then(|(own, reference)| Spread::of_ratios(own, reference));
    ratio.map_or("-".to_owned(), |ratio| format!("{:.2}", ratio.median))
}

/// One row a check below one a conclusion.
pub(super) fn conclusions(ours: &[Conclusion], papers: &[Conclusion]) -> String {
    let verdict = |c: &Conclusion| c.verdict.map_or("no figures".to_owned(), |v| v.to_string());
    let mut text = String::new();
    for (own, paper) in ours.iter().zip(papers) {
        let (number, claim) = (own.number, own.text);
        text +=
            &format!("\n({number}) {claim}: {}; by the paper's figures: {}\n", verdict(own), verdict(paper));
        for check in &own.checks {
            let papers = published::columns(check.scene);
            let papers = [&check.above, &check.below].map(|name| figure(&papers, name, check.measure));
            let papers = match papers {
                [Some(above), Some(below)] => format!(", paper {:.3}", above / below),
                _ => String::new(),
            };
            let claim = format!("{} {} {}", check.above, check.claim, check.below);
            let what = format!("{} {:?}", check.scene, check.measure).to_lowercase();
            let Spread { median, low, high } = check.ratio;
            let verdict = check.verdict;
            text += &format!(
                "    {verdict:<13} {what:<23} {claim:<38} {median:.3} ({low:.3}-{high:.3}){papers}\n"
            );
        }
    }
    text.trim_start_matches('\n').trim_end().to_owned()
}

/// The first figure of a structure.
fn figure(columns: &[Column], name: &str, measure: Measure) -> Option<f64> {
    find(columns, name)?.samples(measure).first().copied()
}

/// Four digits.
pub(super) fn digits(x: f64) -> String {
    let digits = (3.0 - x.abs().max(1e-3).log10().floor()).clamp(0.0, 5.0) as usize;
    format!("{x:.digits$}")
}
