//! The triangles as the user holds them: borrowed vertices and indices, checked once.

use std::fmt;

use glam::Vec3;

/// A triangle mesh: vertices, and three indices into them for each triangle.
///
/// Borrows both. Triangles are numbered in the order of `triangles`, and hits name them by that
/// number. Zero-area triangles and repeated ones are accepted; the former are never hit.
///
/// ```
/// use octogrid::{MeshError, TriMesh};
/// let vertices = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// assert_eq!(TriMesh::new(&vertices, &[[0, 1, 2]])?.len(), 1);
/// let error = TriMesh::new(&vertices, &[[0, 1, 3]]).unwrap_err();
/// assert_eq!(error, MeshError::IndexOutOfRange { triangle: 0, index: 3, vertices: 3 });
/// # Ok::<(), MeshError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct TriMesh<'a> {
    vertices: &'a [[f32; 3]],
    triangles: &'a [[u32; 3]],
}

impl<'a> TriMesh<'a> {
    /// The largest number of triangles: a cluster reference has 31 bits, a triangle index 32, and
    /// `u32::MAX` means no triangle.
    pub const MAX_TRIANGLES: usize = (1 << 31) - 1;

    /// Checks the mesh. O(vertices + triangles).
    ///
    /// # Errors
    /// [`MeshError`] on the first vertex that is NaN or infinite (used or not), the first index out
    /// of range, and on more than [`TriMesh::MAX_TRIANGLES`] triangles.
    pub fn new(vertices: &'a [[f32; 3]], triangles: &'a [[u32; 3]]) -> Result<Self, MeshError> {
        if triangles.len() > Self::MAX_TRIANGLES {
            return Err(MeshError::TooManyTriangles { triangles: triangles.len() });
        }
        if let Some(vertex) = vertices.iter().position(|v| v.iter().any(|x| !x.is_finite())) {
            return Err(MeshError::NotFinite { vertex, position: vertices[vertex] });
        }
        for (triangle, indices) in triangles.iter().enumerate() {
            if let Some(&index) = indices.iter().find(|&&i| i as usize >= vertices.len()) {
                return Err(MeshError::IndexOutOfRange { triangle, index, vertices: vertices.len() });
            }
        }
        Ok(Self { vertices, triangles })
    }

    /// The number of triangles.
    pub fn len(&self) -> usize {
        self.triangles.len()
    }

    /// Whether there is no triangle.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// All vertices.
    pub fn vertices(&self) -> &'a [[f32; 3]] {
        self.vertices
    }

    /// The vertex indices of all triangles.
    pub fn triangles(&self) -> &'a [[u32; 3]] {
        self.triangles
    }

    /// The three corners of one triangle.
    ///
    /// # Panics
    /// Where `triangle` is not below [`TriMesh::len`].
    #[inline]
    pub fn corners(&self, triangle: u32) -> [Vec3; 3] {
        self.corners_of(self.triangles[triangle as usize])
    }

    #[inline(always)]
    pub(crate) fn corners_of(&self, [a, b, c]: [u32; 3]) -> [Vec3; 3] {
        // The function of arrays is not inlined, which loops over triangles would feel.
        let vertex = |i: u32| Vec3::from_array(self.vertices[i as usize]);
        [vertex(a), vertex(b), vertex(c)]
    }
}

/// Why a mesh can't be used.
#[derive(Clone, Debug, PartialEq)]
pub enum MeshError {
    /// A vertex has a coordinate that is NaN or infinite.
    NotFinite {
        /// The index of the vertex.
        vertex: usize,
        /// Its coordinates.
        position: [f32; 3],
    },
    /// A triangle names a vertex that does not exist.
    IndexOutOfRange {
        /// The number of the triangle.
        triangle: usize,
        /// The index that it names.
        index: u32,
        /// The number of vertices that there are.
        vertices: usize,
    },
    /// There are more triangles than [`TriMesh::MAX_TRIANGLES`].
    TooManyTriangles {
        /// The number of triangles.
        triangles: usize,
    },
}

impl fmt::Display for MeshError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite { vertex, position: [x, y, z] } => {
                write!(f, "vertex {vertex} is not finite: ({x}, {y}, {z})")
            }
            Self::IndexOutOfRange { triangle, index, vertices } => {
                write!(f, "triangle {triangle} names vertex {index}, but there are only {vertices} vertices")
            }
            Self::TooManyTriangles { triangles } => {
                write!(f, "{triangles} triangles are more than the {} that fit", TriMesh::MAX_TRIANGLES)
            }
        }
    }
}

impl std::error::Error for MeshError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_name_the_offender() {
        let fine = [[0.0f32; 3]; 3];
        let mut bad = fine;
        bad[1][2] = f32::NAN;
        let error = TriMesh::new(&bad, &[]).unwrap_err();
        assert_eq!(error.to_string(), "vertex 1 is not finite: (0, 0, NaN)");
        let error = TriMesh::new(&fine, &[[0, 1, 2], [0, 9, 1]]).unwrap_err();
        assert_eq!(error.to_string(), "triangle 1 names vertex 9, but there are only 3 vertices");
    }
}
