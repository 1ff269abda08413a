//! parry3d: its mesh as it comes, and its tree with a plain triangle test.

use octogrid::{Ray, TriMesh};
use parry3d::bounding_volume::Aabb;
use parry3d::math::Vector;
use parry3d::partitioning::{Bvh, BvhBuildStrategy, TraversalAction};
use parry3d::query::{Ray as ParryRay, RayCast};
use parry3d::shape::{CompositeShapeRef, TriMesh as ParryMesh};

use crate::peer::{Answer, Build, Peer, Question, Tracer};
use crate::triangle::Triangle;

/// Its triangle mesh.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mesh;

/// Its tree with the strategy that its documentation recommends for rays.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tree;

impl Tracer for Mesh {
    fn prepare<'a>(&self, mesh: TriMesh<'a>, _: usize) -> Build<'a> {
        Box::new(move || {
            let vertices = mesh.vertices().iter().map(|&v| v.into()).collect();
            Box::new(ParryMesh::new(vertices, mesh.triangles().to_vec()).expect("it builds"))
        })
    }

    fn builds_in_parallel(&self) -> bool {
        false
    }
}

impl Tracer for Tree {
    fn prepare<'a>(&self, mesh: TriMesh<'a>, _: usize) -> Build<'a> {
        Box::new(move || {
            let triangles: Vec<Triangle> = Triangle::all(mesh).collect();
            let leaf = |triangle: &Triangle| {
                let [low, high] = triangle.bounds().map(|corner| Vector::from(corner.to_array()));
                Aabb::new(low, high)
            };
            let tree = Bvh::from_iter(BvhBuildStrategy::Ploc, triangles.iter().map(leaf).enumerate());
            Box::new(Built { tree, triangles })
        })
    }

    fn builds_in_parallel(&self) -> bool {
        false
    }
}

fn ray_of(ray: &Ray) -> ParryRay {
    let [origin, dir] = [ray.origin, ray.dir].map(|v| Vector::from(v.to_array()));
    ParryRay::new(origin, dir)
}

/// The end of the ray: infinity means a miss to this crate.
fn end(ray: &Ray) -> f32 {
    ray.t_max.min(f32::MAX)
}

fn answer_of(hit: Option<(u32, f32)>) -> Answer {
    hit.map_or(Answer::MISS, |(prim, t)| Answer { t, prim })
}

impl Peer for ParryMesh {
    fn closest(&self, rays: &[Ray], _: bool, answers: &mut [Answer]) {
        // What the mesh itself calls, but it tells the triangle as well.
        let mesh = CompositeShapeRef(self);
        for (ray, answer) in rays.iter().zip(answers) {
            *answer = answer_of(mesh.cast_local_ray(&ray_of(ray), end(ray), false));
        }
    }

    fn occluded(&self, rays: &[Ray], _: bool, blocked: &mut [bool]) {
        for (ray, blocked) in rays.iter().zip(blocked) {
            *blocked = self.intersects_local_ray(&ray_of(ray), end(ray));
        }
    }

    fn count(&self, _: &[Ray], _: &mut [u32]) {
        unreachable!("it has no such query");
    }

    fn answers(&self, question: Question) -> bool {
        question != Question::All
    }
}

struct Built {
    tree: Bvh,
    triangles: Vec<Triangle>,
}

impl Built {
    /// Calls `visit` for each leaf whose box the ray meets, until that says so.
    #[inline(always)]
    fn walk(&self, ray: &Ray, mut visit: impl FnMut(&Triangle) -> TraversalAction) {
        let parry_ray = ray_of(ray);
        self.tree.traverse(|node| {
            if node.cast_ray(&parry_ray, end(ray)) == f32::MAX {
                return TraversalAction::Prune;
            }
            node.leaf_data().map_or(TraversalAction::Continue, |leaf| visit(&self.triangles[leaf as usize]))
        });
    }
}

impl Peer for Built {
    fn closest(&self, rays: &[Ray], _: bool, answers: &mut [Answer]) {
        for (ray, answer) in rays.iter().zip(answers) {
            let test = |leaf: u32, best: f32| self.triangles[leaf as usize].hit(ray, best);
            *answer = answer_of(self.tree.cast_ray(&ray_of(ray), end(ray), test));
        }
    }

    fn occluded(&self, rays: &[Ray], _: bool, blocked: &mut [bool]) {
        for (ray, blocked) in rays.iter().zip(blocked) {
            *blocked = false;
            self.walk(ray, |triangle| {
                *blocked = triangle.hit(ray, ray.t_max).is_some();
                if *blocked { TraversalAction::EarlyExit } else { TraversalAction::Continue }
            });
        }
    }

    fn count(&self, rays: &[Ray], counts: &mut [u32]) {
        for (ray, count) in rays.iter().zip(counts) {
            *count = 0;
            self.walk(ray, |triangle| {
                *count += u32::from(triangle.hit(ray, ray.t_max).is_some());
                TraversalAction::Continue
            });
        }
    }
}
