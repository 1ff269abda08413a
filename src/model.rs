//! A scene as files and generators hold it: owned triangles with their materials.

use std::collections::HashMap;

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
    /// The lights: connected groups of triangles whose material emits.
    ///
    /// Triangles are connected where they share a vertex index. Groups are in the order of their
    /// lowest triangle, and so are the triangles within each.
    pub fn lights(&self) -> Vec<Vec<u32>> {
        let emits = |t: &u32| self.material(*t).is_some_and(Material::is_light);
        let emitters: Vec<u32> = (0..self.triangles.len() as u32).filter(emits).collect();
        let mut parents: Vec<u32> = (0..self.vertices.len() as u32).collect();
        for [a, b, c] in emitters.iter().map(|&t| self.triangles[t as usize]) {
            unite(&mut parents, a, b);
            unite(&mut parents, a, c);
        }
        let mut groups: Vec<Vec<u32>> = Vec::new();
        let mut group_of = HashMap::new();
        for triangle in emitters {
            let root = find(&mut parents, self.triangles[triangle as usize][0]);
            let group = *group_of.entry(root).or_insert_with(|| {
                groups.push(Vec::new());
                groups.len() - 1
            });
            groups[group].push(triangle);
        }
        groups
    }
}

/// The representative of a set of the union-find forest, with path halving.
fn find(parents: &mut [u32], mut item: u32) -> u32 {
    while parents[item as usize] != item {
        let grandparent = parents[parents[item as usize] as usize];
        parents[item as usize] = grandparent;
        item = grandparent;
    }
    item
}

fn unite(parents: &mut [u32], a: u32, b: u32) {
    let (a, b) = (find(parents, a), find(parents, b));
    parents[a.max(b) as usize] = a.min(b);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lights_are_connected_groups() {
        let mut lamp = Material::diffuse("lamp", [1.0; 3]);
        lamp.emission = [0.0, 2.0, 0.0];
        let model = Model {
            vertices: vec![[0.0; 3]; 9],
            triangles: vec![[0, 1, 2], [6, 7, 8], [3, 4, 5], [2, 3, 6], [8, 1, 1]],
            materials: vec![Material::default(), lamp],
            material_ids: vec![1, 1, 1, 0, 1],
        };
        assert_eq!(model.lights(), [vec![0, 1, 4], vec![2]]);
        assert!(Model::default().lights().is_empty());
    }
}
