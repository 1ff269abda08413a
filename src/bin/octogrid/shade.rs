//! Direct light on surfaces: one shadow ray to each light, weakened through glass.

use std::ops::ControlFlow;

use glam::{DVec3, Vec3};
use octogrid::{All, EdgeRule, Hit, Material, Model, Query, Ray, Scene};
use rayon::prelude::*;

use crate::frame::Rate;
use crate::lights::Light;
use crate::survey::{bounds, corners};

/// Glass surfaces that light goes through at most; beyond it is dark.
pub(crate) const MOST_GLASS: usize = 32;

/// A point on a surface, on the side that is seen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surface {
    /// Off the surface by a little, so that rays from here don't meet it.
    pub(crate) point: DVec3,
    /// Of length 1.
    pub(crate) normal: DVec3,
    /// Back along the ray that met it, of length 1.
    pub(crate) to_eye: DVec3,
    /// Whether this is the side from which the triangle's corners run counter-clockwise.
    pub(crate) front: bool,
    /// Where the ray met it.
    pub(crate) hit: Hit,
}

/// A scene with its lights.
pub(crate) struct Shading<'a> {
    model: &'a Model,
    scene: &'a Scene,
    lights: Vec<Light>,
    glass: bool,
    default: Material,
    /// How far rays start and end from surfaces.
    offset: f64,
    up: DVec3,
}

impl<'a> Shading<'a> {
    /// Gathers the lights.
    pub(crate) fn new(model: &'a Model, scene: &'a Scene, up: DVec3) -> Self {
        // Some hundred units in the last place of the largest coordinate or distance.
        let (low, high) = bounds(model).unwrap_or_default();
        let offset = 1e-5 * (high - low).max(high.abs().max(low.abs())).max_element();
        let glass = model.materials.iter().any(|m| m.opacity < 1.0);
        Self { model, scene, lights: Light::all(model), glass, default: Material::default(), offset, up }
    }

    /// The number of lights.
    pub(crate) fn lights(&self) -> usize {
        self.lights.len()
    }

    /// All triangles.
    pub(crate) fn triangles(&self) -> std::ops::Range<u32> {
        0..self.model.triangles.len() as u32
    }

    /// The corners of a triangle.
    pub(crate) fn corners(&self, triangle: u32) -> [DVec3; 3] {
        corners(self.model, triangle)
    }

    /// How far rays start and end from surfaces.
    pub(crate) fn offset(&self) -> f64 {
        self.offset
    }

    /// The material of a triangle.
    pub(crate) fn material(&self, triangle: u32) -> &Material {
        self.model.material(triangle).unwrap_or(&self.default)
    }

    /// The unit normal on the side from which a ray meets a surface, if it does.
    pub(crate) fn normal(&self, ray: &Ray, hit: &Hit) -> Option<DVec3> {
        hit.is_hit().then(|| self.surface(ray, hit).normal)
    }

    /// Where a ray meets a surface.
    pub(crate) fn surface(&self, ray: &Ray, hit: &Hit) -> Surface {
        let [a, b, c] = corners(self.model, hit.prim);
        let to_eye = -ray.dir.as_dvec3().normalize();
        let normal = (b - a).cross(c - a).normalize_or(to_eye);
        let front = normal.dot(to_eye) >= 0.0;
        let normal = if front { normal } else { -normal };
        let point = a + (b - a) * f64::from(hit.u) + (c - a) * f64::from(hit.v);
        Surface { point: point + normal * self.offset, normal, to_eye, front, hit: *hit }
    }

    /// The light that each surface receives, over pi: what white would send back.
    pub(crate) fn light(&self, surfaces: &[Surface], shadow: &mut Rate) -> Vec<Vec3> {
        if self.lights.is_empty() {
            return surfaces.iter().map(|s| self.headlight(s)).collect();
        }
        let (offered, rays): (Vec<_>, Vec<_>) =
            surfaces.par_iter().enumerate().flat_map_iter(|(i, s)| self.offers(i, s)).unzip();
        let passing = self.transmittances(&rays, shadow);
        let mut light = vec![Vec3::ZERO; surfaces.len()];
        for ((at, irradiance), passing) in offered.iter().zip(passing) {
            light[*at] += irradiance * passing * std::f32::consts::FRAC_1_PI;
        }
        light
    }

    /// What each light that a surface faces would give it, and the ray that tells whether it does.
    fn offers(&self, at: usize, surface: &Surface) -> impl Iterator<Item = ((usize, Vec3), Ray)> {
        self.lights.iter().filter_map(move |light| {
            let target = light.target(surface.point, self.offset);
            let irradiance = light.irradiance(surface.point, surface.normal, target);
            let ray = Ray::segment(surface.point.as_vec3(), target.as_vec3());
            (irradiance != Vec3::ZERO).then_some(((at, irradiance), ray))
        })
    }

    /// The rays from a surface to all lights that it faces.
    pub(crate) fn shadow_rays(&self, surface: &Surface) -> Vec<Ray> {
        self.offers(0, surface).map(|(_, ray)| ray).collect()
    }

    /// How much light comes through along each ray.
    pub(crate) fn transmittances(&self, rays: &[Ray], shadow: &mut Rate) -> Vec<Vec3> {
        if self.glass {
            let through = || rays.par_iter().map(|ray| self.through_glass(ray)).collect();
            return shadow.time(rays.len(), through);
        }
        let mut occluded = vec![false; rays.len()];
        shadow.time(rays.len(), || self.scene.occluded_stream(rays, &mut occluded));
        occluded.iter().map(|&occluded| if occluded { Vec3::ZERO } else { Vec3::ONE }).collect()
    }

    fn through_glass(&self, ray: &Ray) -> Vec3 {
        let mut hits = [Hit::MISS; MOST_GLASS];
        let is_opaque = |prim| self.material(prim).opacity >= 1.0;
        let mut panes = Panes { is_opaque, glass: All::new(ray.t_max, &mut hits), blocked: false };
        self.scene.query(ray, &mut panes);
        let (blocked, len) = (panes.blocked, panes.glass.len());
        if blocked {
            return Vec3::ZERO;
        }
        hits[..len].iter().map(|hit| transmittance(self.material(hit.prim))).product()
    }

    /// Light from over the viewer's shoulder, from the eye and from the sky, for scenes without
    /// lights. Nothing casts shadows in it.
    fn headlight(&self, surface: &Surface) -> Vec3 {
        let shoulder = surface.to_eye + 0.6 * self.up + 0.6 * self.up.cross(surface.to_eye);
        let key = surface.normal.dot(shoulder.normalize_or_zero()).max(0.0);
        let facing = surface.normal.dot(surface.to_eye);
        let sky = 0.5 + 0.5 * surface.normal.dot(self.up);
        Vec3::splat((0.65 * key + 0.2 * facing + 0.15 * sky) as f32)
    }
}

/// The glass along a ray, up to the first surface that lets nothing through.
struct Panes<'a, F> {
    is_opaque: F,
    glass: All<'a>,
    /// By something opaque, or by more glass than there is room for.
    blocked: bool,
}

impl<F: Fn(u32) -> bool> Query for Panes<'_, F> {
    const RULE: EdgeRule = All::RULE;

    fn t_max(&self) -> f32 {
        self.glass.t_max()
    }

    fn accept(&mut self, hit: Hit) -> ControlFlow<()> {
        self.blocked = (self.is_opaque)(hit.prim);
        if !self.blocked {
            self.glass.accept(hit)?;
            self.blocked = !self.glass.is_complete();
        }
        if self.blocked { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// The part of light that a surface lets through, coloured as the surface is.
pub(crate) fn transmittance(material: &Material) -> Vec3 {
    let diffuse = Vec3::from_array(material.diffuse);
    let brightest = diffuse.max_element();
    let tint = if brightest > 0.0 { diffuse / brightest } else { Vec3::ONE };
    tint * (1.0 - material.opacity).clamp(0.0, 1.0)
}
