//! bvh. Its ordered iterator goes on to the end of the ray and its own triangle test culls back
//! faces: so here is its unordered iterator over boxes nearer than the hit so far, which is faster,
//! with a two-sided test.

use std::cell::Cell;

use bvh::aabb::{Aabb, Bounded, IntersectsAabb};
use bvh::bounding_hierarchy::{BHShape, BoundingHierarchy};
use bvh::bvh::Bvh as Tree;
use bvh::ray::Ray as BvhRay;
use nalgebra::{Point3, Vector3};
use octogrid::{Ray, TriMesh};

use crate::peer::{Answer, Build, Peer, Tracer};
use crate::triangle::Triangle;

/// The crate, which has no options.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bvh;

impl Tracer for Bvh {
    fn prepare<'a>(&self, mesh: TriMesh<'a>, threads: usize) -> Build<'a> {
        Box::new(move || {
            let shape = |(prim, triangle)| Shape { triangle, prim, node: 0 };
            let mut shapes: Vec<Shape> = (0..).zip(Triangle::all(mesh)).map(shape).collect();
            let tree = match threads {
                1 => Tree::build(&mut shapes),
                _ => Tree::build_par(&mut shapes),
            };
            Box::new(Built { tree, shapes })
        })
    }
}

struct Built {
    tree: Tree<f32, 3>,
    shapes: Vec<Shape>,
}

#[derive(Clone, Copy)]
struct Shape {
    triangle: Triangle,
    prim: u32,
    node: u32,
}

impl Bounded<f32, 3> for Shape {
    fn aabb(&self) -> Aabb<f32, 3> {
        let [low, high] = self.triangle.bounds().map(|corner| Point3::from(corner.to_array()));
        Aabb::with_bounds(low, high)
    }
}

impl BHShape<f32, 3> for Shape {
    fn set_bh_node_index(&mut self, index: usize) {
        self.node = index as u32;
    }

    fn bh_node_index(&self) -> usize {
        self.node as usize
    }
}

/// A ray whose end comes nearer with each hit.
struct Shrinking {
    ray: BvhRay<f32, 3>,
    t_max: Cell<f32>,
}

impl Shrinking {
    fn new(ray: &Ray) -> Self {
        let [origin, dir] = [ray.origin, ray.dir].map(|v| v.to_array());
        Self { ray: BvhRay::new(Point3::from(origin), Vector3::from(dir)), t_max: Cell::new(ray.t_max) }
    }
}

impl IntersectsAabb<f32, 3> for Shrinking {
    #[inline(always)]
    fn intersects_aabb(&self, bounds: &Aabb<f32, 3>) -> bool {
        self.ray.intersection_slice_for_aabb(bounds).is_some_and(|(near, _)| near <= self.t_max.get())
    }
}

impl Peer for Built {
    fn closest(&self, rays: &[Ray], _: bool, answers: &mut [Answer]) {
        for (ray, answer) in rays.iter().zip(answers) {
            *answer = Answer::MISS;
            let query = Shrinking::new(ray);
            for shape in self.tree.traverse_iterator(&query, &self.shapes) {
                if let Some(t) = shape.triangle.hit(ray, query.t_max.get()) {
                    *answer = Answer { t, prim: shape.prim };
                    query.t_max.set(t);
                }
            }
        }
    }

    fn occluded(&self, rays: &[Ray], _: bool, blocked: &mut [bool]) {
        for (ray, blocked) in rays.iter().zip(blocked) {
            let query = Shrinking::new(ray);
            let mut met = self.tree.traverse_iterator(&query, &self.shapes);
            *blocked = met.any(|shape| shape.triangle.hit(ray, ray.t_max).is_some());
        }
    }

    fn count(&self, rays: &[Ray], counts: &mut [u32]) {
        for (ray, count) in rays.iter().zip(counts) {
            let query = Shrinking::new(ray);
            let met = self.tree.traverse_iterator(&query, &self.shapes);
            *count = met.filter(|shape| shape.triangle.hit(ray, ray.t_max).is_some()).count() as u32;
        }
    }
}
