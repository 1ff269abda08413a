//! The hazards: all structures against brute force and exact arithmetic.

use octogrid::oracle::hazards::{HAZARDS, Hazard, HazardScene, SceneKind};
use octogrid::oracle::meshes::Mesh;
use octogrid::oracle::{Agreement, Disagreement, Subjects, rays};
use octogrid::{Ray, TriMesh};
use rayon::prelude::*;

use super::{Found, Round};

/// Rays a scene and round.
const RAYS: usize = 32;
/// The same for huge scenes, where a ray may meet 10^6 triangles.
const RAYS_IN_HUGE: usize = 4;
/// Of the rays of a scene and round, those that are compared with exact arithmetic.
const EXACT: usize = 4;

/// About how many rays a round has.
pub(super) const RAYS_A_ROUND: u64 = 80 * RAYS as u64;

/// A scene of a hazard with what has been found on it.
pub(super) struct Case<'a> {
    pub(super) hazard: &'static Hazard,
    pub(super) scene: &'static HazardScene,
    /// Of a scene that is the same in all rounds.
    subjects: Option<Built<'a>>,
    pub(super) tally: Tally,
}

type Built<'a> = Result<Subjects<'a>, Box<Disagreement>>;

/// How much was compared, and the failures.
#[derive(Clone, Default)]
pub(super) struct Tally {
    /// The most triangles of a scene.
    pub(super) triangles: usize,
    /// Rays, each compared with brute force.
    pub(super) rays: u64,
    /// Of these, compared with exact arithmetic.
    pub(super) exact: u64,
    /// Rays on which some answers differ; a build that fails counts as one.
    pub(super) failures: u64,
    pub(super) first: Option<Found>,
}

impl std::ops::AddAssign for Tally {
    fn add_assign(&mut self, other: Self) {
        self.triangles = self.triangles.max(other.triangles);
        self.rays += other.rays;
        self.exact += other.exact;
        self.failures += other.failures;
        self.first = Found::first(self.first.take(), other.first);
    }
}

/// A scene of a hazard, and its mesh if it is the same in all rounds.
pub(super) struct Source {
    hazard: &'static Hazard,
    scene: &'static HazardScene,
    mesh: Option<Mesh>,
}

/// The scenes of all hazards, the huge ones only where they are wanted.
pub(super) fn sources(huge: bool) -> Vec<Source> {
    let all = HAZARDS.iter().flat_map(|hazard| hazard.scenes.iter().map(move |scene| (hazard, scene)));
    let wanted = all.filter(|(_, scene)| huge || scene.kind != SceneKind::Huge);
    let mesh = |scene: &HazardScene| (scene.kind != SceneKind::Seeded).then(|| (scene.mesh)(0));
    wanted.map(|(hazard, scene)| Source { hazard, scene, mesh: mesh(scene) }).collect()
}

/// Builds the scenes that are the same in all rounds.
pub(super) fn build(sources: &[Source]) -> Vec<Case<'_>> {
    sources.par_iter().map(Case::new).collect()
}

fn build_one<'a>(scene: &HazardScene, (vertices, triangles): &'a Mesh) -> Built<'a> {
    let mesh = TriMesh::new(vertices, triangles).expect("generated meshes are sound");
    let exact = if scene.kind == SceneKind::Huge { 1 } else { EXACT };
    Agreement { exact, decorated: 2, threads: Vec::new(), ..Agreement::quick() }.build(&mesh)
}

/// Traces rounds, all in parallel.
pub(super) fn trace(cases: &mut [Case<'_>], rounds: &[Round]) {
    cases.par_iter_mut().for_each(|case| {
        let skips = |round: &&Round| case.scene.kind != SceneKind::Huge || round.has_huge_scenes();
        let rounds: Vec<&Round> = rounds.iter().filter(skips).collect();
        let tallies: Vec<Tally> = rounds.par_iter().map(|round| case.trace(**round)).collect();
        tallies.into_iter().for_each(|tally| case.tally += tally);
    });
}

impl<'a> Case<'a> {
    fn new(Source { hazard, scene, mesh }: &'a Source) -> Self {
        let subjects = mesh.as_ref().map(|mesh| build_one(scene, mesh));
        Case { hazard, scene, subjects, tally: Tally::default() }
    }

    fn trace(&self, round: Round) -> Tally {
        match &self.subjects {
            Some(built) => self.compare(built, round),
            None => self.compare(&build_one(self.scene, &(self.scene.mesh)(round.random())), round),
        }
    }

    fn compare(&self, built: &Built<'_>, round: Round) -> Tally {
        let found = |what: &Disagreement| Some(Found::new(round, self.hazard.name, self.scene.name, what));
        let subjects = match built {
            Ok(subjects) => subjects,
            Err(failure) => return Tally { failures: 1, first: found(failure), ..Tally::default() },
        };
        let n = if self.scene.kind == SceneKind::Huge { RAYS_IN_HUGE } else { RAYS };
        let rays = rays::in_turn(self.hazard.rays, subjects.mesh(), round.random(), n);
        let tally = Tally { triangles: subjects.mesh().len(), rays: n as u64, ..Tally::default() };
        match subjects.check(&rays) {
            Ok(report) => Tally { exact: report.exact as u64, ..tally },
            Err(failure) => {
                let fails = |ray: &&Ray| subjects.check(&[**ray]).is_err();
                let failures = rays.iter().filter(fails).count().max(1) as u64;
                Tally { failures, first: found(&failure), ..tally }
            }
        }
    }
}
