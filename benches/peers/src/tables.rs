//! Figures as Markdown.

use comfy_table::{CellAlignment, ContentLineStyle, Table, presets::NOTHING};

use crate::figures::{Figures, geometric_mean};
use crate::measure::Measured;
use crate::roster::{BASELINE, Contender};

/// What was measured on one scene, under a heading.
pub(crate) fn scene(measured: &Measured, contenders: &[Contender], figures: &[Figures]) -> String {
    let names = measured.sets.iter().map(|(name, ..)| format!("{name}, Mray/s"));
    let header = ["", "build, ms", "2 threads, ms", "bytes/triangle", "at peak"].map(String::from);
    let header = header.into_iter().chain(names).chain(["image, ms".into()]);
    let rows = contenders.iter().zip(figures).map(|(contender, figures)| {
        let rates = figures.sets.iter().map(|rate| {
            rate.map(|rate| format!("{} ({:.2})", digits(rate.rays / 1e6), rate.ratio)).unwrap_or_default()
        });
        let built = [
            contender.name.to_owned(),
            digits(1e3 * figures.build),
            figures.build_of_two.map(|seconds| digits(1e3 * seconds)).unwrap_or_default(),
            format!("{:.0}", figures.held),
            format!("{:.0}", figures.peak),
        ];
        let image = figures.image.map(|seconds| format!("{:.0}", 1e3 * seconds)).unwrap_or_default();
        built.into_iter().chain(rates).chain([image]).collect()
    });
    let facts = measured.sets.iter().map(|(name, rays, hits)| format!("{name} {rays} ({hits:.3})"));
    format!(
        "## {}: {} triangles\n\nRays (hits a ray): {}. In brackets: rate over that of {BASELINE}.\n\n{}\n\n{}",
        measured.scene,
        measured.triangles,
        facts.collect::<Vec<_>>().join(", "),
        markdown(header.collect(), rows),
        wrong(measured, contenders, figures),
    )
}

/// The contenders with wrong answers, in one line.
fn wrong(measured: &Measured, contenders: &[Contender], figures: &[Figures]) -> String {
    let of = |(contender, figures): (&Contender, &Figures)| {
        let sets = measured.sets.iter().zip(&figures.sets);
        let counts = sets.filter_map(|((name, ..), rate)| Some((name, rate.as_ref()?.wrong)));
        let counts: Vec<String> =
            counts.filter(|(_, n)| *n > 0).map(|(name, n)| format!("{name} {n}")).collect();
        (!counts.is_empty()).then(|| format!("{}: {}", contender.name, counts.join(", ")))
    };
    let all: Vec<String> = contenders.iter().zip(figures).filter_map(of).collect();
    format!("Wrong answers: {}.", if all.is_empty() { "none".to_owned() } else { all.join("; ") })
}

/// Geometric means over scenes, relative to the baseline, with the worst scene in brackets.
pub(crate) fn means(
    scenes: &[Measured],
    contenders: &[Contender],
    figures: &[Vec<Figures>],
    baseline: usize,
) -> String {
    let header = ["", "build", "2 threads", "bytes", "at peak"].into_iter();
    let header =
        header.chain(scenes[0].sets.iter().map(|(name, ..)| *name)).chain(["image", "image, best other"]);
    let rows = (0..contenders.len()).map(|at| {
        let cost = |of: &dyn Fn(&Figures) -> Option<f64>| {
            let ratios = figures.iter().map(|scene| Some(of(&scene[at])? / of(&scene[baseline])?));
            cell(ratios, f64::max)
        };
        let costs = [
            contenders[at].name.to_owned(),
            cost(&|f| Some(f.build)),
            cost(&|f| f.build_of_two),
            cost(&|f| Some(f.held)),
            cost(&|f| Some(f.peak)),
        ];
        let rates = (0..scenes[0].sets.len())
            .map(|set| cell(figures.iter().map(|scene| Some(scene[at].sets[set]?.ratio)), f64::min));
        let best = figures.iter().map(|scene| Some(scene[at].image? / best_other(contenders, scene, at)?));
        let images = [cost(&|f| f.image), cell(best, f64::max)];
        costs.into_iter().chain(rates).chain(images).collect()
    });
    format!(
        "## Geometric means over {} scenes, in brackets the worst\n\n\
         Relative to {BASELINE}: of seconds and bytes less is better, of rates (the sets) more. \
         The last column is relative to the shortest time to image of another library.\n\n{}",
        scenes.len(),
        markdown(header.map(String::from).collect(), rows),
    )
}

/// The shortest time to image of other libraries on a scene.
fn best_other(contenders: &[Contender], figures: &[Figures], at: usize) -> Option<f64> {
    let others = contenders.iter().zip(figures).filter(|(c, _)| c.library() != contenders[at].library());
    others.filter_map(|(_, figures)| figures.image).reduce(f64::min)
}

/// Mean and worst, where there is a ratio for every scene.
fn cell(ratios: impl Iterator<Item = Option<f64>>, worse: fn(f64, f64) -> f64) -> String {
    let Some(ratios) = ratios.collect::<Option<Vec<f64>>>() else { return String::new() };
    let worst = ratios.iter().copied().reduce(worse);
    geometric_mean(&ratios)
        .zip(worst)
        .map(|(mean, worst)| format!("{mean:.2} ({worst:.2})"))
        .unwrap_or_default()
}

/// Three digits or more.
fn digits(value: f64) -> String {
    let decimals = (2 - value.log10().floor() as i32).clamp(0, 3) as usize;
    format!("{value:.decimals$}")
}

/// A table whose columns but the first are aligned to the right, in the source as well.
fn markdown(header: Vec<String>, rows: impl Iterator<Item = Vec<String>>) -> String {
    let mut table = Table::new();
    table.load_style(NOTHING.content_lines(ContentLineStyle::new('|', '|', '|')));
    let rule = (0..header.len()).map(|column| if column == 0 { "---" } else { "--:" });
    let rule = rule.map(String::from).collect::<Vec<_>>();
    table.add_row(header).add_row(rule).add_rows(rows);
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_markdown() {
        let cells = |row: [&str; 2]| row.map(String::from).to_vec();
        let table = markdown(cells(["", "rate"]), [cells(["embree-med", "1"])].into_iter());
        let lines = ["|            | rate |", "| ---        |  --: |", "| embree-med |    1 |"];
        assert_eq!(table, lines.join("\n"));
    }

    #[test]
    fn numbers_have_three_digits() {
        assert_eq!(
            [0.001_234, 0.1234, 12.34, 123.4, 12_345.6].map(digits),
            ["0.001", "0.123", "12.3", "123", "12346"]
        );
    }

    #[test]
    fn a_mean_needs_every_scene() {
        assert_eq!(cell([Some(2.0), Some(8.0)].into_iter(), f64::min), "4.00 (2.00)");
        assert_eq!(cell([Some(2.0), None].into_iter(), f64::min), "");
    }
}
