//! Builds and traces in turns, so that a disturbance of the machine meets all alike.

use std::thread;
use std::time::Duration;

use octogrid::{Scene, TriMesh};

use crate::clock::{Elapsed, time};
use crate::load::Loaded;
use crate::memory::{self, Bytes};
use crate::peer::Peer;
use crate::reference::{self, Answers};
use crate::roster::Contender;
use crate::sets::{self, RaySet};
use crate::threads::on;

/// Rounds that even the slowest contender takes part in.
const FEWEST_ROUNDS: usize = 3;

/// How long to measure.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(crate) struct Effort {
    /// Rays a set
    #[arg(long, value_name = "N", default_value_t = 250_000, value_parser = clap::value_parser!(u32).range(100..))]
    rays: u32,
    /// Rounds of tracing
    #[arg(long, value_name = "N", default_value_t = 7)]
    rounds: usize,
    /// Rounds of building with one thread, and as many with two
    #[arg(long, value_name = "N", default_value_t = 5)]
    build_rounds: usize,
    /// Seconds of a build or of a set from which a contender takes part in three rounds at most
    #[arg(long, value_name = "SECONDS", default_value_t = 1.0)]
    patience: f64,
}

impl Effort {
    /// For a test.
    #[cfg(test)]
    pub(crate) fn least() -> Self {
        Self { rays: 1000, rounds: 1, build_rounds: 1, patience: 1.0 }
    }

    /// Whether to measure in this round what took `first` seconds in the first.
    fn goes_on(&self, round: usize, first: Option<f64>) -> bool {
        round < FEWEST_ROUNDS || first.is_none_or(|seconds| seconds < self.patience)
    }
}

/// What is measured of all contenders on one scene.
pub(crate) struct Measured {
    pub(crate) scene: String,
    pub(crate) triangles: usize,
    /// Each set's name, number of rays, and hits a ray.
    pub(crate) sets: Vec<(&'static str, usize, f64)>,
    /// One for each contender.
    pub(crate) scores: Vec<Score>,
}

/// What is measured of one contender; samples by round.
#[derive(Default)]
pub(crate) struct Score {
    /// Builds with one thread.
    pub(crate) builds: Vec<Elapsed>,
    /// Builds with two threads, where it can use them.
    pub(crate) builds_of_two: Vec<Elapsed>,
    pub(crate) bytes: Bytes,
    /// One for each set; none where it does not answer that question.
    pub(crate) traces: Vec<Option<Trace>>,
}

/// How a contender traced a set; samples by round.
#[derive(Default)]
pub(crate) struct Trace {
    pub(crate) times: Vec<Elapsed>,
    pub(crate) wrong: usize,
}

/// Measures all contenders on one scene.
///
/// # Errors
/// Where octogrid's answers are not those of brute force.
pub(crate) fn scene(loaded: &Loaded, contenders: &[Contender], effort: &Effort) -> Result<Measured, String> {
    let mesh = loaded.model.mesh().map_err(|e| e.to_string())?;
    let scene = Scene::build(&mesh, &Default::default()).map_err(|e| e.to_string())?;
    let sets = sets::all(loaded, &scene, effort.rays as usize);
    let right = reference::answers(scene, mesh, &sets)?;
    let mut scores: Vec<Score> = contenders.iter().map(|_| Score::default()).collect();
    // First all of one thread: pools of more go on spinning for a while.
    let built = builds(mesh, contenders, &mut scores, 1, effort);
    builds(mesh, contenders, &mut scores, 2, effort);
    for (set, right) in sets.iter().zip(&right) {
        let traces = on(1, || trace(&built, contenders, set, right, effort));
        scores.iter_mut().zip(traces).for_each(|(score, trace)| score.traces.push(trace));
    }
    let facts = sets.iter().zip(&right).map(|(set, right)| (set.name, set.rays.len(), right.mean()));
    Ok(Measured { scene: loaded.name.clone(), triangles: mesh.len(), sets: facts.collect(), scores })
}

/// Builds all in rounds; what the first round has built.
fn builds(
    mesh: TriMesh<'_>,
    contenders: &[Contender],
    scores: &mut [Score],
    threads: usize,
    effort: &Effort,
) -> Vec<Box<dyn Peer>> {
    let mut first = Vec::new();
    for round in 0..effort.build_rounds.max(1) {
        for (contender, score) in contenders.iter().zip(&mut *scores) {
            let samples = if threads == 1 { &mut score.builds } else { &mut score.builds_of_two };
            let useful = threads == 1 || contender.tracer.builds_in_parallel();
            if !useful || !effort.goes_on(round, samples.first().map(|sample| sample.wall)) {
                continue;
            }
            let prepared = contender.tracer.prepare(mesh, threads);
            // Until the threads of the one before have gone to sleep: a library's may spin for a while.
            thread::sleep(Duration::from_millis(20));
            let ((peer, elapsed), bytes) = on(threads, || memory::measure(|| time(prepared)));
            samples.push(elapsed);
            if threads == 1 && round == 0 {
                score.bytes = peer.bytes().unwrap_or(bytes);
                first.push(peer);
            }
        }
    }
    first
}

/// Traces a set with all in rounds, each of them beginning with another contender. Before that each
/// traces it once to warm up and to be checked.
fn trace(
    built: &[Box<dyn Peer>],
    contenders: &[Contender],
    set: &RaySet,
    right: &Answers,
    effort: &Effort,
) -> Vec<Option<Trace>> {
    let mut room = Answers::room(set);
    let check = |peer: &dyn Peer, contender: &Contender| {
        if !peer.answers(set.question) {
            return None;
        }
        let mut answers = Answers::room(set);
        answers.ask(peer, set);
        Some(Trace { wrong: answers.wrong(right, contender.tracer.is_exact()), times: Vec::new() })
    };
    let checked = built.iter().zip(contenders).map(|(peer, contender)| check(&**peer, contender));
    let mut traces: Vec<Option<Trace>> = checked.collect();
    for round in 0..effort.rounds.max(1) {
        for turn in 0..built.len() {
            let at = (turn + round) % built.len();
            let Some(trace) = &mut traces[at] else { continue };
            if effort.goes_on(round, trace.times.first().map(|sample| sample.wall)) {
                trace.times.push(time(|| room.ask(&*built[at], set)).1);
            }
        }
    }
    traces
}
