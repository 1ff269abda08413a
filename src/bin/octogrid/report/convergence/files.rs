//! What is said and written.

use serde::Serialize;

use super::measure::{Curve, Measured, TARGET};
use crate::failure::Failure;
use crate::report::folder::{Folder, stem};
use crate::report::machine::Machine;
use crate::report::numbers::short;
use crate::report::plot::{Labels, Scale, Series};
use crate::report::statistics::Spread;
use crate::table;

/// All that a report says.
#[derive(Serialize)]
pub(super) struct Report<'a> {
    pub(super) machine: Machine,
    pub(super) size: [u32; 2],
    pub(super) seed: u64,
    /// The error whose seconds are told.
    pub(super) target: f64,
    pub(super) measured: &'a [Measured],
}

/// One row a structure.
pub(super) fn table(measured: &Measured) -> String {
    let Measured { scene, integrator, samples, rmse, reference_samples, .. } = measured;
    let errors: Vec<String> =
        samples.iter().zip(rmse).map(|(n, e)| format!("{n}: {}", percent(*e))).collect();
    let slope = measured.slope.map_or(String::new(), |s| format!(", slope {s:.2}"));
    let most = samples.last().copied().unwrap_or(0);
    let header = [
        "structure".to_owned(),
        format!("s at {most}"),
        "slope".into(),
        format!("s to {}", percent(TARGET)),
        "interval".into(),
        "relative".into(),
    ];
    let rows = measured.curves.iter().map(|curve| {
        let two = |s: Option<Spread>| s.map_or("-".to_owned(), |s| format!("{:.2}", s.median));
        [
            curve.structure.clone(),
            curve.seconds.last().map_or("-".to_owned(), |s| short(s.median)),
            two(curve.slope),
            curve.to_target.map_or("-".to_owned(), |s| short(s.median)),
            curve.to_target.map_or("-".to_owned(), |s| format!("{}-{}", short(s.low), short(s.high))),
            two(curve.relative),
        ]
    });
    format!(
        "{scene}, {integrator}: RMSE over mean luminance by samples a pixel, against {reference_samples} samples:\n\
         {}{slope}\n{}",
        errors.join(", "),
        table::grid(header, rows)
    )
}

/// Writes `report.json`, two CSV files, and the plots.
///
/// # Errors
/// Where the system does.
pub(super) fn write(folder: &Folder, report: &Report) -> Result<(), Failure> {
    folder.write_json("report.json", report)?;
    folder.write("report.csv", &csv(report.measured))?;
    folder.write("summary.csv", &summary(report.measured))?;
    for measured in report.measured {
        let Measured { scene, integrator, .. } = measured;
        let stem = stem(scene);
        let title = format!("{stem}, {integrator}: error against run time");
        let series: Vec<Series> =
            measured.curves.iter().map(|curve| series(measured, curve, &curve.structure)).collect();
        write_plot(folder, &format!("{stem}-{integrator}.svg"), &title, &series)?;
    }
    for of_scene in report.measured.chunk_by(|a, b| a.scene == b.scene) {
        let Some(Measured { scene, curves, .. }) = of_scene.first() else { continue };
        let Some(first) = curves.first() else { continue };
        let stem = stem(scene);
        let title = format!("{stem}, {}: error against run time", first.structure);
        let one =
            |measured: &Measured| Some(series(measured, measured.curves.first()?, &measured.integrator));
        let series: Vec<Series> = of_scene.iter().filter_map(one).collect();
        write_plot(folder, &format!("{stem}.svg"), &title, &series)?;
    }
    Ok(())
}

fn write_plot(folder: &Folder, name: &str, title: &str, series: &[Series]) -> Result<(), Failure> {
    let labels =
        Labels { title, x: "run time of an image, s", y: "RMSE over mean luminance", scale: Scale::Log };
    folder.write_plot(name, &labels, series)
}

fn series(measured: &Measured, curve: &Curve, name: &str) -> Series {
    let slope = curve.slope.map_or(String::new(), |s| format!(", slope {:.2}", s.median));
    let seconds = curve.seconds.iter().map(|s| s.median);
    let points = seconds.zip(measured.rmse.iter().copied()).collect();
    Series { name: format!("{name}{slope}"), points, joined: true, look: None }
}

/// One line an image and structure.
fn csv(measured: &[Measured]) -> String {
    let mut text = "scene,integrator,structure,samples,rmse,seconds,low,high\n".to_owned();
    for m in measured {
        for curve in &m.curves {
            for ((samples, rmse), s) in m.samples.iter().zip(&m.rmse).zip(&curve.seconds) {
                let start = start(m, curve);
                text += &format!("{start},{samples},{rmse},{},{},{}\n", s.median, s.low, s.high);
            }
        }
    }
    text
}

/// One line an integrator and structure; empty where there is no line through the points.
fn summary(measured: &[Measured]) -> String {
    let mut text = "scene,integrator,structure,slope_over_samples,slope_over_seconds,seconds_to_1_percent,low,high,relative\n".to_owned();
    let number = |x: Option<f64>| x.map_or(String::new(), |x| x.to_string());
    for m in measured {
        for curve in &m.curves {
            let target = |of: fn(&Spread) -> f64| number(curve.to_target.as_ref().map(of));
            let fields = [
                start(m, curve),
                number(m.slope),
                number(curve.slope.map(|s| s.median)),
                target(|s| s.median),
                target(|s| s.low),
                target(|s| s.high),
                number(curve.relative.map(|s| s.median)),
            ];
            text += &format!("{}\n", fields.join(","));
        }
    }
    text
}

fn start(measured: &Measured, curve: &Curve) -> String {
    format!("\"{}\",{},\"{}\"", measured.scene, measured.integrator, curve.structure)
}

fn percent(x: f64) -> String {
    format!("{}%", short(100.0 * x))
}
