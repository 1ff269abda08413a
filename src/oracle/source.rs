//! Random points on and around a mesh, which ray sets are made of.

use glam::{DVec3, Vec3};

use crate::mesh::TriMesh;
use crate::ray::Ray;
use crate::rng::Rng;

/// A mesh with its bounds and a generator.
pub(super) struct Source<'a> {
    mesh: TriMesh<'a>,
    center: DVec3,
    half: DVec3,
    pub(super) rng: Rng,
}

impl<'a> Source<'a> {
    pub(super) fn new(mesh: &TriMesh<'a>, seed: u64) -> Self {
        let points = || mesh.vertices().iter().map(|&v| Vec3::from_array(v).as_dvec3());
        let min = points().reduce(DVec3::min).unwrap_or(DVec3::ZERO);
        let max = points().reduce(DVec3::max).unwrap_or(DVec3::ZERO);
        let (center, half) = (0.5 * (min + max), 0.5 * (max - min));
        Self { mesh: *mesh, center, half, rng: Rng::new(seed) }
    }

    pub(super) fn center(&self) -> DVec3 {
        self.center
    }

    /// The radius of the bounding sphere; 1 where the mesh is a point or empty.
    pub(super) fn radius(&self) -> f64 {
        let radius = self.half.length();
        if radius > 0.0 { radius } else { 1.0 }
    }

    /// A point at `radii` times the bounding sphere's radius from its centre.
    pub(super) fn around(&mut self, radii: f64) -> DVec3 {
        self.center + radii * self.radius() * self.rng.on_sphere()
    }

    /// A point in the bounding box.
    pub(super) fn inside(&mut self) -> DVec3 {
        self.center + self.half * self.rng.in_cube()
    }

    /// The corners of some triangle; three times the origin where there is none.
    pub(super) fn corners(&mut self) -> [Vec3; 3] {
        match self.mesh.len() {
            0 => [Vec3::ZERO; 3],
            n => self.mesh.corners(self.rng.below(n) as u32),
        }
    }

    /// A vertex of some triangle.
    pub(super) fn vertex(&mut self) -> DVec3 {
        let corners = self.corners();
        self.rng.pick(&corners).as_dvec3()
    }

    /// A point of an edge: a vertex, the midpoint or any other, before rounding to f32.
    pub(super) fn on_edge(&mut self) -> DVec3 {
        let [a, b, _] = self.corners().map(|v| v.as_dvec3());
        let s = match self.rng.below(4) {
            0 => 0.0,
            1 => 0.5,
            2 => 0.25,
            _ => self.rng.unit(),
        };
        a.lerp(b, s)
    }

    /// A point of a triangle, before rounding to f32.
    pub(super) fn on_triangle(&mut self) -> DVec3 {
        let corners = self.corners().map(|v| v.as_dvec3());
        self.within(corners)
    }

    /// A point between three others.
    pub(super) fn within(&mut self, [a, b, c]: [DVec3; 3]) -> DVec3 {
        a.lerp(b, self.rng.unit()).lerp(c, self.rng.unit())
    }

    /// The corners of that one of 16 triangles which is the thinnest and has an area.
    pub(super) fn thin(&mut self) -> [DVec3; 3] {
        let triangles = [(); 16].map(|()| self.corners().map(|v| v.as_dvec3()));
        let width = |[a, b, c]: &[DVec3; 3]| {
            let edges = [b - a, c - b, a - c].map(DVec3::length_squared);
            let width = (b - a).cross(c - a).length() / edges.into_iter().fold(0.0, f64::max);
            if width > 0.0 { width } else { f64::INFINITY }
        };
        triangles.into_iter().min_by(|a, b| width(a).total_cmp(&width(b))).unwrap_or_default()
    }

    /// A vector of integers of at most `most`, not zero, times a power of two, about as long as the
    /// bounding sphere's radius where they are 4: sums of it and of coordinates often are exact.
    pub(super) fn short_vector(&mut self, most: usize) -> DVec3 {
        let unit = self.radius().log2().floor().exp2() / 4.0;
        loop {
            let v = Vec3::from_array([(); 3].map(|()| self.rng.integer(most)));
            if v != Vec3::ZERO {
                return unit * v.as_dvec3();
            }
        }
    }
}

/// The ray from a point towards another.
pub(super) fn towards(origin: DVec3, target: DVec3) -> Ray {
    let origin = narrow(origin);
    Ray::new(origin, narrow(target - origin.as_dvec3()))
}

/// Rounds to f32, at most to the largest finite one.
pub(super) fn narrow(v: DVec3) -> Vec3 {
    v.clamp(DVec3::splat(f32::MIN.into()), DVec3::splat(f32::MAX.into())).as_vec3()
}
