//! Collects the parts of a scene: positions in f64, triangles, and the material in use.

use glam::DVec3;

use super::trig::sin_cos;
use crate::model::{Material, Model};

/// A scene under construction. Parts share vertices within themselves, not with each other.
#[derive(Debug, Default)]
pub(crate) struct Builder {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    materials: Vec<Material>,
    material_ids: Vec<u32>,
    material: u32,
}

impl Builder {
    /// Makes a diffuse material the one in use; each name is one material.
    pub(crate) fn paint(&mut self, name: &str, diffuse: [f32; 3]) {
        self.select(Material::diffuse(name, diffuse));
    }

    /// Makes a light the material in use.
    pub(crate) fn light(&mut self, name: &str, emission: [f32; 3]) {
        self.select(Material { emission, ..Material::diffuse(name, [0.9; 3]) });
    }

    /// Makes a translucent material the one in use.
    pub(crate) fn glass(&mut self, name: &str, diffuse: [f32; 3], opacity: f32) {
        self.select(Material { opacity, ..Material::diffuse(name, diffuse) });
    }

    fn select(&mut self, material: Material) {
        let known = self.materials.iter().position(|m| m.name == material.name);
        let id = known.unwrap_or_else(|| {
            self.materials.push(material);
            self.materials.len() - 1
        });
        self.material = id as u32;
    }

    /// Adds a vertex and returns its index.
    pub(crate) fn vertex(&mut self, position: DVec3) -> u32 {
        self.positions.push(position);
        (self.positions.len() - 1) as u32
    }

    /// Adds a triangle of the material in use.
    pub(crate) fn triangle(&mut self, corners: [u32; 3]) {
        self.triangles.push(corners);
        self.material_ids.push(self.material);
    }

    /// Adds a quadrangle, divided from its first to its third corner.
    pub(crate) fn quad(&mut self, [a, b, c, d]: [u32; 4]) {
        self.triangle([a, b, c]);
        self.triangle([a, c, d]);
    }

    /// Builds a part in its own coordinates, turns it about the y axis and moves it to `at`.
    pub(crate) fn place(&mut self, at: DVec3, turns: f64, part: impl FnOnce(&mut Self)) {
        let first = self.positions.len();
        part(self);
        let (sin, cos) = sin_cos(turns);
        for p in &mut self.positions[first..] {
            *p = at + DVec3::new(cos * p.x + sin * p.z, p.y, cos * p.z - sin * p.x);
        }
    }

    /// The finished scene, rounded to f32.
    pub(crate) fn finish(self) -> Model {
        Model {
            vertices: self.positions.iter().map(|p| p.as_vec3().to_array()).collect(),
            triangles: self.triangles,
            material_ids: if self.materials.is_empty() { Vec::new() } else { self.material_ids },
            materials: self.materials,
        }
    }
}
