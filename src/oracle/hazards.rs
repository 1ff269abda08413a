//! What has broken other ray tracers: scenes and rays, by name; and closed meshes.

use glam::{DVec3, Vec3};

use super::extremes::{crowd, identical, lattice, line, moved, nested, snapped, turned};
use super::meshes::{Mesh, MeshKind, closed_mesh, random_mesh};
use super::rays::RaySet;
use super::watertight::closed_part;
use crate::builtin;
use crate::model::Model;

/// Scenes and rays that share a danger.
#[derive(Clone, Copy, Debug)]
pub struct Hazard {
    /// What the danger is.
    pub name: &'static str,
    /// Scenes that have it, or to which rays bring it.
    pub scenes: &'static [HazardScene],
    /// Sets of rays, to be traced in turn.
    pub rays: &'static [RaySet],
}

/// A scene of a [`Hazard`].
#[derive(Clone, Copy, Debug)]
pub struct HazardScene {
    /// A short name.
    pub name: &'static str,
    /// How often to make it.
    pub kind: SceneKind,
    /// Makes it.
    pub mesh: fn(seed: u64) -> Mesh,
}

/// How often to make a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SceneKind {
    /// Small, another one for each seed.
    Seeded,
    /// The same for all seeds.
    Fixed,
    /// The same for all seeds, of 10^6 triangles: it takes seconds to build, and up to seconds a ray.
    Huge,
}

const fn seeded(name: &'static str, mesh: fn(u64) -> Mesh) -> HazardScene {
    HazardScene { name, kind: SceneKind::Seeded, mesh }
}

const fn fixed(name: &'static str, mesh: fn(u64) -> Mesh) -> HazardScene {
    HazardScene { name, kind: SceneKind::Fixed, mesh }
}

const fn huge(name: &'static str, mesh: fn(u64) -> Mesh) -> HazardScene {
    HazardScene { name, kind: SceneKind::Huge, mesh }
}

const fn of_rays(name: &'static str, rays: &'static [RaySet]) -> Hazard {
    Hazard { name, scenes: &SHAPES, rays }
}

const fn of_scenes(name: &'static str, scenes: &'static [HazardScene]) -> Hazard {
    Hazard { name, scenes, rays: &RaySet::ALL }
}

/// Ordinary scenes for hazardous rays: in voxel planes, closed, degenerate, crowded, round.
const SHAPES: [HazardScene; 5] = [
    fixed("lattice", |_| lattice(4)),
    seeded("closed", |seed| closed_mesh(seed, 3)),
    seeded("integer", |seed| random_mesh(seed, MeshKind::Integer)),
    seeded("clustered", |seed| random_mesh(seed, MeshKind::Clustered)),
    fixed("torus", |_| of(builtin::torus(32, 12))),
];

/// All hazards.
pub static HAZARDS: [Hazard; 21] = [
    of_rays("direction components of 0 and -0", &[RaySet::Axis]),
    of_rays("directions subnormal to 1e38 long", &[RaySet::Scaled]),
    of_rays("through vertices and edges", &[RaySet::Aimed]),
    of_rays("diagonals through voxel corners", &[RaySet::Diagonal]),
    of_rays("in planes, along edges", &[RaySet::Planar]),
    of_rays("grazing", &[RaySet::Grazing]),
    of_rays("far origins, 1e6 and 1e18 sizes", &[RaySet::Far]),
    of_rays("interval ends on surfaces", &[RaySet::Interval]),
    of_rays("NaN, infinite and empty rays", &[RaySet::Invalid]),
    of_scenes(
        "scales 1e-18 to 1e18",
        &[
            seeded("1e-18", |seed| scaled(seed, 1e-18)),
            seeded("1e-9", |seed| scaled(seed, 1e-9)),
            seeded("1e9", |seed| scaled(seed, 1e9)),
            seeded("1e18", |seed| scaled(seed, 1e18)),
        ],
    ),
    of_scenes(
        "1e6 sizes off the origin",
        &[
            fixed("torus", |seed| offset(seed, &of(builtin::torus(32, 12)))),
            seeded("closed", |seed| offset(seed, &closed_mesh(seed, 3))),
        ],
    ),
    of_scenes(
        "turned out of the axes",
        &[
            seeded("lattice", |seed| turned(&lattice(3), seed)),
            seeded("closed", |seed| turned(&closed_mesh(seed, 3), seed)),
        ],
    ),
    of_scenes(
        "millimetre triangles",
        &[
            fixed("sphere of 1 cm", |_| moved(&of(builtin::sphere(32, 32)), |v| 0.005 * v)),
            fixed("in a room", |_| of(builtin::room())),
        ],
    ),
    of_scenes(
        "aspect ratios to 1e8",
        &[
            seeded("slivers", |seed| random_mesh(seed, MeshKind::Slivers)),
            fixed("needles", |_| of(builtin::slivers())),
            seeded("squeezed", |seed| moved(&closed_mesh(seed, 2), |v| v * DVec3::new(1.0, 1e-4, 1e-8))),
        ],
    ),
    of_scenes(
        "sizes to 1e9 apart",
        &[seeded("nested", nested), fixed("stadium", |_| of(builtin::stadium()))],
    ),
    of_scenes(
        "flat and one-dimensional",
        &[
            seeded("flat", |seed| random_mesh(seed, MeshKind::Flat)),
            fixed("plane", |_| of(builtin::plane(16))),
            seeded("line", line),
        ],
    ),
    of_scenes(
        "one triangle, none",
        &[
            seeded("one", |seed| identical(seed, 1)),
            fixed("none", |_| Mesh::default()),
            fixed("a point", |_| (vec![[3.0; 3]], vec![[0, 0, 0]; 9])),
        ],
    ),
    of_scenes(
        "identical triangles",
        &[
            seeded("turned, flipped", |seed| random_mesh(seed, MeshKind::Duplicates)),
            seeded("40", |seed| identical(seed, 40)),
            huge("10^6", |seed| identical(seed, 1_000_000)),
        ],
    ),
    of_scenes(
        "triangles in voxel planes",
        &[fixed("lattice 2", |_| lattice(2)), fixed("lattice 8", |_| lattice(8))],
    ),
    of_scenes(
        "crowded cells",
        &[
            seeded("100 + 200", |seed| crowd(seed, 100, 200)),
            fixed("10^4 + 10^4", |seed| crowd(seed, 10_000, 10_000)),
            huge("10^4 + 10^6", |seed| crowd(seed, 10_000, 1_000_000)),
        ],
    ),
    of_scenes("any finite bits", &[seeded("wild", |seed| random_mesh(seed, MeshKind::Wild))]),
];

/// Closed meshes, for [`super::watertight`].
pub static CLOSED: [HazardScene; 11] = [
    fixed("cube", |_| of(builtin::cube())),
    fixed("sphere", |_| of(builtin::sphere(64, 64))),
    fixed("torus", |_| of(builtin::torus(128, 32))),
    fixed("stadium", |_| of(builtin::stadium())),
    fixed("sphere on a lattice", |_| snapped(&of(builtin::sphere(64, 64)), 11)),
    fixed("torus on a lattice", |_| snapped(&of(builtin::torus(128, 32)), 9)),
    fixed("torus 1e6 sizes off", |seed| offset(seed, &of(builtin::torus(32, 12)))),
    fixed("torus squeezed to 1e-4", |_| {
        moved(&of(builtin::torus(32, 12)), |v| v * DVec3::new(1.0, 1e-2, 1e-4))
    }),
    fixed("room, what is closed", |_| closed_part(&of(builtin::room()))),
    fixed("interior, what is closed", |_| closed_part(&of(builtin::interior()))),
    seeded("random, self-intersecting", |seed| closed_mesh(seed, 1 + seed as u32 % 4)),
];

fn of(model: Model) -> Mesh {
    (model.vertices, model.triangles)
}

fn scaled(seed: u64, scale: f64) -> Mesh {
    let mesh = closed_mesh(seed, 3);
    moved(&mesh, |v| scale / largest(&mesh) * v)
}

/// The mesh at 10^6 times its size in a random direction.
fn offset(seed: u64, mesh: &Mesh) -> Mesh {
    let far = 1e6 * largest(mesh) * crate::rng::Rng::new(seed).on_sphere();
    moved(mesh, |v| v + far)
}

/// The largest coordinate, at least 1.
fn largest((vertices, _): &Mesh) -> f64 {
    f64::from(vertices.iter().fold(1.0, |a: f32, &v| a.max(Vec3::from_array(v).abs().max_element())))
}
