//! Closed meshes: no ray gets out of them unseen.

use octogrid::oracle::hazards::{CLOSED, HazardScene, SceneKind};
use octogrid::oracle::meshes::Mesh;
use octogrid::oracle::watertight::{Leaks, Watertight, closed_part};
use octogrid::{Structure, TriMesh};
use rayon::prelude::*;

use super::{Found, Round};
use crate::failure::Failure;
use crate::load;

/// Rays a mesh and round.
const RAYS: usize = 1 << 15;
/// The same for meshes with more triangles, which take longer.
const RAYS_IN_LARGE: usize = 1 << 11;
const LARGE: usize = 1 << 14;

/// A closed mesh with what has been found on it.
pub(super) struct Case<'a> {
    pub(super) name: &'a str,
    mesh: CaseMesh<'a>,
    pub(super) tally: Tally,
}

enum CaseMesh<'a> {
    /// The same in all rounds.
    Fixed(Watertight<'a>),
    Seeded(&'static HazardScene),
}

/// How many rays there were, and the failures.
#[derive(Clone, Default)]
pub(super) struct Tally {
    /// The most triangles of a mesh.
    pub(super) triangles: usize,
    pub(super) inside: u64,
    pub(super) escapes: u64,
    pub(super) outside: u64,
    pub(super) miscounts: u64,
    pub(super) first: Option<Found>,
}

impl std::ops::AddAssign for Tally {
    fn add_assign(&mut self, other: Self) {
        self.triangles = self.triangles.max(other.triangles);
        self.inside += other.inside;
        self.escapes += other.escapes;
        self.outside += other.outside;
        self.miscounts += other.miscounts;
        self.first = Found::first(self.first.take(), other.first);
    }
}

/// A mesh by its name.
pub(super) enum Source {
    Fixed(String, Mesh),
    Seeded(&'static HazardScene),
}

/// The built-in meshes and what is closed of more scenes.
///
/// # Errors
/// On a scene that can't be read, and on one of which nothing is closed.
pub(super) fn sources(scenes: &[String]) -> Result<Vec<Source>, Failure> {
    let own = CLOSED.iter().map(|scene| match scene.kind {
        SceneKind::Seeded => Source::Seeded(scene),
        _ => Source::Fixed(scene.name.to_owned(), (scene.mesh)(0)),
    });
    let mut sources: Vec<Source> = own.collect();
    for name in scenes {
        let model = load::load(name)?.model;
        let mesh = closed_part(&(model.vertices, model.triangles));
        if mesh.1.is_empty() {
            return Err(Failure::Expected(format!("{name}: no part of it is closed")));
        }
        sources.push(Source::Fixed(name.clone(), mesh));
    }
    Ok(sources)
}

/// Builds the meshes that are the same in all rounds.
///
/// # Errors
/// Where a build fails.
pub(super) fn build(sources: &[Source]) -> Result<Vec<Case<'_>>, Failure> {
    sources.par_iter().map(Case::new).collect()
}

fn build_one((vertices, triangles): &Mesh) -> Result<Watertight<'_>, Failure> {
    Ok(Watertight::new(TriMesh::new(vertices, triangles)?, &Structure::ALL)?)
}

/// Traces rounds, all in parallel.
///
/// # Errors
/// Where a build fails.
pub(super) fn trace(cases: &mut [Case<'_>], rounds: &[Round]) -> Result<(), Failure> {
    cases.par_iter_mut().try_for_each(|case| {
        let tallies: Result<Vec<Tally>, Failure> =
            rounds.par_iter().map(|&round| case.trace(round)).collect();
        tallies?.into_iter().for_each(|tally| case.tally += tally);
        Ok(())
    })
}

impl<'a> Case<'a> {
    fn new(source: &'a Source) -> Result<Self, Failure> {
        let (name, mesh) = match source {
            Source::Fixed(name, mesh) => (&**name, CaseMesh::Fixed(build_one(mesh)?)),
            Source::Seeded(scene) => (scene.name, CaseMesh::Seeded(scene)),
        };
        Ok(Self { name, mesh, tally: Tally::default() })
    }

    /// About how many rays a round has.
    pub(super) fn rays_a_round(&self) -> u64 {
        match &self.mesh {
            CaseMesh::Fixed(mesh) if mesh.mesh().len() > LARGE => RAYS_IN_LARGE as u64,
            _ => RAYS as u64,
        }
    }

    fn trace(&self, round: Round) -> Result<Tally, Failure> {
        Ok(match &self.mesh {
            CaseMesh::Fixed(mesh) => self.send(mesh, round),
            CaseMesh::Seeded(scene) => self.send(&build_one(&(scene.mesh)(round.random()))?, round),
        })
    }

    fn send(&self, mesh: &Watertight<'_>, round: Round) -> Tally {
        let rays = self.rays_a_round() as usize;
        let Leaks { inside, escapes, outside, miscounts, first } = mesh.check(round.random(), rays);
        Tally {
            triangles: mesh.mesh().len(),
            inside: inside as u64,
            escapes: escapes as u64,
            outside: outside as u64,
            miscounts: miscounts as u64,
            first: first.map(|what| Found::new(round, "closed mesh", self.name, &what)),
        }
    }
}
