//! Random walks of light: straight from surface to surface, through glass by chance, on by the cosine
//! law. They serve light that is followed from the eye and from the lights alike.

use glam::{DVec3, Vec3};
use octogrid::{Material, Ray, Rng, Scene};
use rayon::prelude::*;

use crate::frame::{self, Rate};
use crate::shade::{MOST_GLASS, Shading, Surface, transmittance};

/// A walk on its way.
#[derive(Clone, Debug)]
pub(super) struct Flight {
    /// What the walk is for.
    pub(super) owner: usize,
    pub(super) ray: Ray,
    /// The part of light that comes through, over the chance of coming this way.
    pub(super) weight: Vec3,
    /// The density a unit of solid angle with which the direction was chosen.
    pub(super) density: f64,
    pub(super) rng: Rng,
}

/// A walk at a surface that reflects it.
#[derive(Clone, Debug)]
pub(super) struct Vertex {
    pub(super) owner: usize,
    pub(super) surface: Surface,
    pub(super) weight: Vec3,
    pub(super) rng: Rng,
}

/// What becomes of a walk that meets a surface.
enum Fate {
    Reflected(Vertex),
    Passed(Flight),
    Absorbed,
}

/// A direction on the side of a unit normal, with the density cos / pi.
pub(super) fn cosine(normal: DVec3, rng: &mut Rng) -> DVec3 {
    (normal + rng.on_sphere()).normalize_or(normal)
}

impl Vertex {
    /// Leaves the surface.
    pub(super) fn depart(mut self) -> Flight {
        let dir = cosine(self.surface.normal, &mut self.rng);
        Flight {
            owner: self.owner,
            ray: Ray::new(self.surface.point.as_vec3(), dir.as_vec3()),
            weight: self.weight,
            density: self.surface.normal.dot(dir) * std::f64::consts::FRAC_1_PI,
            rng: self.rng,
        }
    }
}

impl Flight {
    /// Chooses reflection, passage or absorption by their parts of the light.
    fn meet(mut self, surface: Surface, material: &Material) -> Fate {
        let passing = transmittance(material);
        let reflected = Vec3::from_array(material.diffuse) * material.opacity.clamp(0.0, 1.0);
        let pass = passing.max_element();
        let reflect = reflected.max_element().min(1.0 - pass);
        let chance = self.rng.unit() as f32;
        if chance < pass {
            let ray = self.ray.with_interval(surface.hit.t, self.ray.t_max);
            Fate::Passed(Self { ray, weight: self.weight * passing / pass, ..self })
        } else if chance < pass + reflect {
            let weight = self.weight * reflected / reflect;
            Fate::Reflected(Vertex { owner: self.owner, surface, weight, rng: self.rng })
        } else {
            Fate::Absorbed
        }
    }
}

/// Follows walks to the surfaces that reflect them.
///
/// `find` is called in parallel at every surface on the way, and what it finds is given to `keep`
/// with the owner, in an order that doesn't depend on the number of threads.
pub(super) fn follow<T: Send>(
    shading: &Shading,
    scene: &Scene,
    mut flights: Vec<Flight>,
    rate: &mut Rate,
    find: impl Fn(&Flight, &Surface) -> T + Sync,
    mut keep: impl FnMut(usize, T),
) -> Vec<Vertex> {
    let mut reflected = Vec::new();
    for _ in 0..=MOST_GLASS {
        if flights.is_empty() {
            break;
        }
        let rays: Vec<Ray> = flights.iter().map(|f| f.ray).collect();
        let hits = frame::closest(scene, &rays, rate);
        let met: Vec<_> = flights
            .into_par_iter()
            .zip(hits)
            .filter(|(_, hit)| hit.is_hit())
            .map(|(flight, hit)| {
                let surface = shading.surface(&flight.ray, &hit);
                let found = find(&flight, &surface);
                (flight.owner, found, flight.meet(surface, shading.material(hit.prim)))
            })
            .collect();
        flights = Vec::new();
        for (owner, found, fate) in met {
            keep(owner, found);
            match fate {
                Fate::Reflected(vertex) => reflected.push(vertex),
                Fate::Passed(flight) => flights.push(flight),
                Fate::Absorbed => {}
            }
        }
    }
    reflected
}
