//! A scene as files and generators hold it: owned triangles with their materials.

use crate::mesh::{MeshError, TriMesh};

/// What a renderer needs to know of a surface, and no more.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// The name, as in an MTL file.
    pub name: String,
    /// Diffuse reflectance, linear RGB in [0, 1].
    pub diffuse: [f32; 3],
    /// Emitted radiance, linear RGB; triangles of a material that emits are lights.
    pub emission: [f32; 3],
    /// 1 is opaque, 0 lets all light through.
    pub opacity: f32,
}

impl Material {
    /// An opaque diffuse material.
    pub fn diffuse(name: &str, diffuse: [f32; 3]) -> Self {
        Self { name: name.to_owned(), diffuse, emission: [0.0; 3], opacity: 1.0 }
    }

    /// Whether triangles of this material are lights.
    pub fn is_light(&self) -> bool {
        self.emission.iter().any(|&e| e > 0.0)
    }
}

impl Default for Material {
    fn default() -> Self {
        Self::diffuse("default", [0.7; 3])
    }
}

/// Vertices, triangles and their materials.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Model {
    /// Positions.
    pub vertices: Vec<[f32; 3]>,
    /// Three vertex indices for each triangle.
    pub triangles: Vec<[u32; 3]>,
    /// The materials; may be empty.
    pub materials: Vec<Material>,
    /// For each triangle the index of its material; empty where there are no materials.
    pub material_ids: Vec<u32>,
}

impl Model {
    /// The checked mesh, borrowed.
    ///
    /// # Errors
    /// As [`TriMesh::new`].
    pub fn mesh(&self) -> Result<TriMesh<'_>, MeshError> {
        TriMesh::new(&self.vertices, &self.triangles)
    }

    /// The material of a triangle, if it has one.
    pub fn material(&self, triangle: u32) -> Option<&Material> {
        let id = *self.material_ids.get(triangle as usize)?;
        self.materials.get(id as usize)
    }
}
