//! The inequalities of the error analysis (ARCHITECTURE.md), checked in exact arithmetic.
//!
//! - A triangle that meets a voxel enlarged by 15/16 of the margin is listed there, and the box of its
//!   cluster contains their common part, enlarged once more; or the brick of the voxel does.
//! - The voxels that a walk visits, enlarged by 9/16 of the margin, hold every point of the ray in the scene.
//! - A triangle that meets a box is never said not to.
//!
//! So every triangle lies, where a ray meets it, in a voxel that is visited.

use glam::Vec3;
use num_bigint::BigInt;

use super::extremes::crowd;
use super::lattice::{Lattice, Line, overlap};
use super::meshes::{Mesh, MeshKind, closed_mesh, random_mesh};
use super::rays::hazards;
use super::subject::{Leaf, Subject, Visited};
use crate::aabb::Aabb;
use crate::arena::Grid;
use crate::build::{HybridParams, RecursiveParams, Structure, UniformParams};
use crate::cluster::Cluster;
use crate::descent::Walk;
use crate::lanes::{Isa, WIDTH, dispatch};
use crate::mesh::TriMesh;
use crate::overlap::overlapping;
use crate::ray::Ray;
use crate::rng::Rng;
use crate::traverse;

impl Subject {
    /// The first inequality.
    fn assert_voxels_list_what_they_meet(&self, mesh: &TriMesh<'_>) {
        let lattice = self.lattice(mesh, &[]);
        let margin = lattice.length(0.9375 * self.margin);
        let clusters = (0..).zip(&self.arena.clusters);
        let lanes =
            clusters.flat_map(|(i, c)| (0..WIDTH).map(move |lane| (i, c.ids()[lane], c.triangle(lane))));
        let lanes = lanes.filter(|(_, id, _)| *id != u32::MAX);
        let triangles: Vec<_> =
            lanes.map(|(i, id, t)| (i, id, Aabb::around(t), t.map(|v| lattice.point(v)))).collect();
        for leaf in &self.leaves {
            let voxel = lattice.place(&leaf.place, &margin);
            for (cluster, id, bounds, corners) in &triangles {
                if !self.are_near(leaf, bounds) || !overlap(corners, &voxel) {
                    continue;
                }
                // What is around a brick has no list, and lists have no boxes.
                let bounds = if let Some(hole) = leaf.hole {
                    hole.corners(self.parts)
                } else {
                    let place = leaf.clusters.iter().position(|c| c == cluster);
                    let place =
                        place.unwrap_or_else(|| panic!("triangle {id} is not listed at {:?}", leaf.place));
                    let Some(bounds) = leaf.boxes.get(place) else { continue };
                    bounds.map(|side| side.map(f64::from))
                };
                for axis in 0..3 {
                    let of = corners.each_ref().map(|corner| &corner[axis]);
                    let lo = of.into_iter().min().unwrap().max(&voxel[0][axis]) - &margin;
                    let hi = of.into_iter().max().unwrap().min(&voxel[1][axis]) + &margin;
                    let [below, above] = bounds.map(|side| lattice.cells(side[axis]));
                    assert!(below <= lo && hi <= above, "the box of triangle {id} at {:?}", leaf.place);
                }
            }
        }
    }

    /// The second inequality.
    fn assert_walks_cover(&self, mesh: &TriMesh<'_>, rays: &[Ray]) {
        let lattice = self.lattice(mesh, rays);
        let margin = lattice.length(0.5625 * self.margin);
        let bounds = [self.bounds.lo, self.bounds.hi].map(|p| lattice.point(p));
        for ray in rays {
            let line = lattice.line(ray);
            let Some([start, end]) = line.times(&bounds).filter(|[_, end]| *end >= BigInt::ZERO) else {
                continue;
            };
            for walk in [Walk::Special, Walk::General] {
                let mut visited = Visited::new(&self.arena);
                traverse::visit(Isa::detect(), &self.arena, walk, ray, &mut visited);
                if visited.all {
                    continue;
                }
                let leaves = self.leaves.iter().filter(|leaf| visited.has(leaf.slot));
                let mut intervals: Vec<_> =
                    leaves.flat_map(|leaf| intervals(&lattice, &line, leaf, &margin)).collect();
                intervals.sort();
                let mut reached = start.clone().max(BigInt::ZERO);
                for [from, to] in intervals {
                    if from <= reached {
                        reached = reached.max(to);
                    }
                }
                assert!(reached >= end, "{ray:?} is lost on its way through {:?}", self.arena.grid);
            }
        }
    }

    /// Rays that cross a plane between voxels at a corner or anywhere, from steeply to almost in it.
    fn grazing(&self, rng: &mut Rng, n: usize) -> Vec<Ray> {
        let grid = &self.arena.grid;
        let size = grid.cell * f64::from(grid.longest());
        let mut ray = || {
            let leaf = &self.leaves[rng.below(self.leaves.len())];
            let steepest = rng.below(3);
            let [mut target, mut dir] = [[0.0; 3]; 2];
            for axis in 0..3 {
                let inside = if rng.below(4) == 0 { rng.unit() } else { 0.0 };
                let [lo, hi] = leaf.place.corners(self.parts).map(|corner| corner[axis]);
                let place = lo + inside * (hi - lo);
                target[axis] = grid.lo[axis] + place * grid.cell;
                dir[axis] = rng.signed() * size;
                if axis != steepest {
                    dir[axis] *= 0.5f64.powi(rng.below(50) as i32);
                }
            }
            let back = rng.range(0.0, 1.0) * rng.pick(&[1.0, 1.0, 1e9, 1e18]);
            let vec3 = |v: [f64; 3]| Vec3::from_array(v.map(|x| x as f32));
            Ray::new(vec3(std::array::from_fn(|axis| target[axis] - back * dir[axis])), vec3(dir))
        };
        (0..n).map(|_| ray()).collect()
    }
}

/// When a line is in a leaf enlarged by a margin, but not in its hole, which all that is in the leaf lies in by more
/// than the margin.
fn intervals(lattice: &Lattice, line: &Line, leaf: &Leaf, margin: &BigInt) -> Vec<[BigInt; 2]> {
    let Some([start, end]) = line.times(&lattice.place(&leaf.place, margin)) else { return vec![] };
    let hole = leaf.hole.and_then(|hole| line.times(&lattice.place(&hole, &-margin)));
    match hole {
        Some([from, to]) => vec![[start.clone(), from.min(end.clone())], [to.max(start), end]],
        None => vec![[start, end]],
    }
}

fn structures() -> Vec<Structure> {
    let recursive = Structure::Recursive(RecursiveParams { threshold: 3, divisions: 3, top_grid: true });
    let deep = HybridParams { density: 0.01, levels: 8, group_cost: 1.0, brick_cost: 0.0, voxel_cost: 0.0 };
    let more = [recursive, Structure::Uniform(UniformParams { density: 64.0 }), Structure::Hybrid(deep)];
    Structure::ALL.into_iter().chain(more).collect()
}

fn scenes() -> impl Iterator<Item = Mesh> {
    let kinds = MeshKind::ALL.into_iter();
    let random = kinds.flat_map(|kind| (0..2).map(move |seed| random_mesh(seed, kind)));
    // The first of these in bricks of three levels.
    random.chain([crowd(3, 100, 200), strip(), closed_mesh(1, 4), closed_mesh(2, 5)])
}

/// Rays from near and far that touch the bottom of the strip at its middle and sink no further.
fn to_the_middle_of_the_strip() -> impl Iterator<Item = Ray> {
    let power = |exponent: i32| 2f32.powi(exponent);
    let distances = [0, 10, 20, 30, 38, 40, 45].into_iter();
    distances.map(move |far| Ray::new([-power(far), 1.5 + power(-23), 0.0], [1.0, -power(-23 - far), 0.0]))
}

/// A strip that is as wide as one unit in the last place of its y, 1024 times as long, and touches the
/// bottom at its middle.
fn strip() -> Mesh {
    let unit = 0.5f32.powi(23);
    let vertex = |i: u32| [(8 * (i / 2)) as f32 - 512.0, (i % 2) as f32, (i % 4) as f32 / 4.0];
    let vertices = (0..258).map(vertex).map(|[x, y, z]| [x * unit, 1.5 + y * unit, z * unit]);
    (vertices.collect(), (0..256).map(|i| [i, i + 1, i + 2]).collect())
}

#[test]
fn voxels_list_what_they_meet() {
    for (vertices, triangles) in scenes().take(15) {
        let mesh = TriMesh::new(&vertices, &triangles).unwrap();
        for structure in structures() {
            Subject::new(&mesh, structure).assert_voxels_list_what_they_meet(&mesh);
        }
    }
}

#[test]
fn walks_cover_their_rays() {
    for (seed, (vertices, triangles)) in (0..).zip(scenes()) {
        let mesh = TriMesh::new(&vertices, &triangles).unwrap();
        for structure in structures() {
            let subject = Subject::new(&mesh, structure);
            let mut rays = hazards(&mesh, seed, 100);
            rays.extend(subject.grazing(&mut Rng::new(seed), 200));
            rays.extend(to_the_middle_of_the_strip());
            rays.retain(Ray::is_valid);
            rays.iter_mut().for_each(|ray| *ray = ray.with_interval(0.0, f32::INFINITY));
            subject.assert_walks_cover(&mesh, &rays);
        }
    }
}

/// Boxes with integer corners, or one unit in the last place off, around the corners of triangles and
/// beside them.
#[test]
fn overlap_is_never_denied() {
    let rng = &mut Rng::new(1);
    let mut counts = [0; 2];
    for _ in 0..20_000 {
        let scale = 2f32.powi(rng.below(240) as i32 - 120);
        let corners = [(); 3].map(|()| {
            let moved = rng.pick(&[0.0, 0.0, 1.0, 1e-6]) * rng.in_cube().as_vec3();
            (Vec3::from_array([(); 3].map(|()| rng.integer(3))) + moved) * scale
        });
        let lo: [f32; 3] = [(); 3].map(|()| rng.integer(3) * scale);
        let lo = lo.map(|x| rng.pick(&[x, x, x.next_up(), x.next_down()]));
        let hi = lo.map(|x| x + rng.pick(&[0.0, 0.5, 1.0, 2.0]) * scale);
        let bounds = Aabb { lo: Vec3::from_array(lo), hi: Vec3::from_array(hi) };

        let points = [corners[0], corners[1], corners[2], bounds.lo, bounds.hi];
        let values = points.into_iter().flat_map(|p| p.as_dvec3().to_array());
        let lattice = Lattice::new(&Grid::new([0.0; 3], 1.0, [1; 3]), 1, values);
        let meets =
            overlap(&corners.map(|v| lattice.point(v)), &[bounds.lo, bounds.hi].map(|p| lattice.point(p)));
        let cluster = Cluster::new(&[(0, corners)]);
        let said = dispatch!(Isa::detect(), lanes => overlapping(lanes, cluster.lanes(lanes), &bounds)) != 0;
        assert!(said || !meets, "{corners:?} {bounds:?}");
        counts[usize::from(said)] += 1;
    }
    assert!(counts.iter().all(|&count| count > 1_000), "{counts:?}");
}
