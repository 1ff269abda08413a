//! All samples as CSV, one a line.

use std::io::Write;

use serde::Serialize;

use crate::clock::Elapsed;
use crate::measure::Measured;
use crate::roster::Contender;

#[derive(Serialize)]
struct Line<'a> {
    scene: &'a str,
    triangles: usize,
    contender: &'a str,
    /// `build`, `build of two` or the name of a set.
    what: &'a str,
    round: usize,
    rays: Option<usize>,
    cpu_seconds: f64,
    wall_seconds: f64,
    bytes: Option<usize>,
    peak_bytes: Option<usize>,
    wrong: Option<usize>,
}

/// Writes the samples of all scenes.
///
/// # Errors
/// Where the file can't be written.
pub(crate) fn write(file: impl Write, scenes: &[Measured], contenders: &[Contender]) -> csv::Result<()> {
    let mut file = csv::Writer::from_writer(file);
    for measured in scenes {
        for (contender, score) in contenders.iter().zip(&measured.scores) {
            let blank = |what, round, sample: &Elapsed| Line {
                scene: &measured.scene,
                triangles: measured.triangles,
                contender: contender.name,
                what,
                round,
                rays: None,
                cpu_seconds: sample.cpu,
                wall_seconds: sample.wall,
                bytes: None,
                peak_bytes: None,
                wrong: None,
            };
            let (bytes, peak_bytes) = (Some(score.bytes.held), Some(score.bytes.peak));
            for (round, sample) in score.builds.iter().enumerate() {
                file.serialize(Line { bytes, peak_bytes, ..blank("build", round, sample) })?;
            }
            for (round, sample) in score.builds_of_two.iter().enumerate() {
                file.serialize(blank("build of two", round, sample))?;
            }
            for (&(name, rays, _), trace) in measured.sets.iter().zip(&score.traces) {
                let Some(trace) = trace else { continue };
                for (round, sample) in trace.times.iter().enumerate() {
                    let (rays, wrong) = (Some(rays), Some(trace.wrong));
                    file.serialize(Line { rays, wrong, ..blank(name, round, sample) })?;
                }
            }
        }
    }
    Ok(file.flush()?)
}
