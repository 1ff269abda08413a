//! Path tracing (Kajiya 1986) with next-event estimation and the balance heuristic (Veach 1997).
//!
//! ```text
//! at each surface of a path:
//!     choose a point on a light;  add what it sends here, if a shadow ray gets through
//!     choose a direction by the cosine law;  add what the lights send that it meets
//!     go on at the surface that it meets
//! ```
//!
//! Two strategies may find the same light, so each counts it by its share of the density. Diffuse
//! reflection has the density cos / pi, which cancels, and both add
//!
//! ```text
//! emission * cosine density / (cosine density + light density)
//! ```
//!
//! which never exceeds the emission: no bright dots.

use glam::{DVec3, Vec3};
use octogrid::{Ray, Scene};
use rayon::prelude::*;

use super::Settings;
use super::emitters::Emitters;
use super::walk::{self, Flight, Vertex};
use crate::frame::{Rate, Rates};
use crate::shade::{Shading, Surface};
use crate::streams::generator;

/// A scene to be lit by paths.
pub(super) struct PathTracer<'a> {
    settings: &'a Settings,
    shading: &'a Shading<'a>,
    scene: &'a Scene,
    emitters: Emitters,
    /// The number of paths so far.
    paths: u64,
}

impl<'a> PathTracer<'a> {
    pub(super) fn new(
        settings: &'a Settings,
        shading: &'a Shading<'a>,
        scene: &'a Scene,
        emitters: Emitters,
    ) -> Self {
        Self { settings, shading, scene, emitters, paths: 0 }
    }

    /// The light that each surface receives, over pi.
    pub(super) fn light(&mut self, surfaces: &[Surface], rates: &mut Rates) -> Vec<Vec3> {
        let samples = self.settings.samples as usize;
        let mut light = vec![DVec3::ZERO; surfaces.len()];
        let mut vertices = self.start(surfaces);
        for _ in 0..self.settings.bounces {
            self.add_chosen(&mut vertices, &mut light, &mut rates.shadow);
            let flights = vertices.into_par_iter().map(Vertex::depart).collect();
            let find = |flight: &Flight, surface: &Surface| self.found(flight, surface);
            let keep = |owner: usize, found: Vec3| light[owner] += found.as_dvec3();
            vertices = walk::follow(self.shading, self.scene, flights, &mut rates.scattered, find, keep);
        }
        light.iter().map(|sum| (sum / samples as f64).as_vec3()).collect()
    }

    /// Paths that start at the surfaces.
    fn start(&mut self, surfaces: &[Surface]) -> Vec<Vertex> {
        let (seed, first) = (self.settings.seed, self.paths);
        let samples = self.settings.samples as usize;
        let paths = surfaces.len() * samples;
        self.paths += paths as u64;
        let vertex = |path: usize| Vertex {
            owner: path / samples,
            surface: surfaces[path / samples],
            weight: Vec3::ONE,
            rng: generator(seed, first + path as u64),
        };
        (0..paths).into_par_iter().map(vertex).collect()
    }

    /// Adds what a chosen point of the lights sends to each vertex.
    fn add_chosen(&self, vertices: &mut [Vertex], light: &mut [DVec3], shadow: &mut Rate) {
        let (offers, rays): (Vec<_>, Vec<_>) =
            vertices.par_iter_mut().filter_map(|vertex| self.offer(vertex)).unzip();
        let passing = self.shading.transmittances(&rays, shadow);
        for ((owner, offer), passing) in offers.into_iter().zip(passing) {
            light[owner] += (offer * passing).as_dvec3();
        }
    }

    /// What a chosen point of the lights would send, and the ray that tells whether it does.
    fn offer(&self, vertex: &mut Vertex) -> Option<((usize, Vec3), Ray)> {
        let source = self.emitters.sample(&mut vertex.rng);
        let Surface { point, normal, .. } = vertex.surface;
        let side = source.normal.dot(point - source.point);
        let target = source.point + source.normal * self.shading.offset().copysign(side);
        let dir = (target - point).try_normalize()?;
        let cosine = normal.dot(dir) * std::f64::consts::FRAC_1_PI;
        let square = target.distance_squared(point);
        let share = self.share(cosine, source.emission, square, source.normal.dot(dir));
        let offer = vertex.weight * source.emission * share;
        (share > 0.0).then(|| ((vertex.owner, offer), Ray::segment(point.as_vec3(), target.as_vec3())))
    }

    /// What a flight receives from the surface that it meets.
    fn found(&self, flight: &Flight, surface: &Surface) -> Vec3 {
        let emission = Vec3::from_array(self.shading.material(surface.hit.prim).emission);
        if emission == Vec3::ZERO {
            return Vec3::ZERO;
        }
        let square = f64::from(surface.hit.t).powi(2);
        let facing = surface.normal.dot(surface.to_eye);
        flight.weight * emission * self.share(flight.density, emission, square, facing)
    }

    /// The share of a direction's cosine density in the densities of both strategies.
    fn share(&self, cosine: f64, emission: Vec3, square: f64, facing: f64) -> f32 {
        if cosine <= 0.0 || facing == 0.0 {
            return 0.0;
        }
        let light = self.emitters.density(emission) * square / facing.abs();
        (cosine / (cosine + light)) as f32
    }
}
