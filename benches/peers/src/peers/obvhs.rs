//! obvhs with its author's presets, triangles in the order of the leaves as its examples have them.

use glam::Vec3A;
use obvhs::BvhBuildParams;
use obvhs::bvh2::{Bvh2, builder::build_bvh2_from_tris};
use obvhs::cwbvh::{CwBvh, builder::build_cwbvh_from_tris};
use obvhs::ray::{Ray as ObvhsRay, RayHit};
use obvhs::rt_triangle::RtTriangle;
use obvhs::triangle::Triangle;
use octogrid::{Ray, TriMesh};

use crate::peer::{Answer, Build, Peer, Tracer};

/// Which of its structures.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Kind {
    /// Eight compressed children a node.
    Wide,
    /// Two children a node.
    Binary,
}

/// A structure with a preset.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Obvhs {
    pub(crate) kind: Kind,
    pub(crate) preset: fn() -> BvhBuildParams,
}

impl Tracer for Obvhs {
    fn prepare<'a>(&self, mesh: TriMesh<'a>, _: usize) -> Build<'a> {
        let Self { kind, preset } = *self;
        Box::new(move || match kind {
            Kind::Wide => Box::new(Built::<CwBvh>::new(&triangles(mesh), preset())),
            Kind::Binary => Box::new(Built::<Bvh2>::new(&triangles(mesh), preset())),
        })
    }
}

fn triangles(mesh: TriMesh<'_>) -> Vec<Triangle> {
    let corners = (0..mesh.len() as u32).map(|i| mesh.corners(i).map(Vec3A::from));
    corners.map(|[v0, v1, v2]| Triangle { v0, v1, v2 }).collect()
}

fn ray_of(ray: &Ray) -> ObvhsRay {
    ObvhsRay::new(ray.origin.into(), ray.dir.into(), ray.t_min, ray.t_max)
}

struct Built<B> {
    bvh: B,
    triangles: Vec<RtTriangle>,
}

/// The two structures have functions of the same names, but no trait for them.
macro_rules! built {
    ($bvh:ident, $build:ident) => {
        impl Built<$bvh> {
            fn new(triangles: &[Triangle], params: BvhBuildParams) -> Self {
                let bvh = $build(triangles, params, &mut Default::default());
                let triangles =
                    bvh.primitive_indices.iter().map(|&i| (&triangles[i as usize]).into()).collect();
                Self { bvh, triangles }
            }
        }

        impl Peer for Built<$bvh> {
            fn closest(&self, rays: &[Ray], _: bool, answers: &mut [Answer]) {
                for (ray, answer) in rays.iter().zip(answers) {
                    let mut hit = RayHit::none();
                    let test = |ray: &ObvhsRay, id: usize| self.triangles[id].intersect(ray);
                    *answer = if self.bvh.ray_traverse(ray_of(ray), &mut hit, test) {
                        Answer { t: hit.t, prim: self.bvh.primitive_indices[hit.primitive_id as usize] }
                    } else {
                        Answer::MISS
                    };
                }
            }

            fn occluded(&self, rays: &[Ray], _: bool, blocked: &mut [bool]) {
                for (ray, blocked) in rays.iter().zip(blocked) {
                    let test = |ray: &ObvhsRay, id: usize| self.triangles[id].intersect(ray);
                    *blocked = !self.bvh.ray_traverse_miss(ray_of(ray), test);
                }
            }

            fn count(&self, rays: &[Ray], counts: &mut [u32]) {
                for (ray, count) in rays.iter().zip(counts) {
                    *count = 0;
                    self.bvh.ray_traverse_anyhit(ray_of(ray), |ray, id| {
                        *count += u32::from(self.triangles[id].intersect(ray) < f32::INFINITY);
                    });
                }
            }
        }
    };
}

built!(CwBvh, build_cwbvh_from_tris);
built!(Bvh2, build_bvh2_from_tris);
