//! Whether a scene is that of a mesh.

use std::array::from_fn;
use std::fmt;

use glam::Vec3;

use crate::exact::{Difference, cross};
use crate::mesh::TriMesh;
use crate::scene::Scene;

/// Why a scene is not that of a mesh.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum MeshMismatch {
    /// They have different numbers of triangles.
    Count {
        /// The number of triangles of the scene.
        scene: usize,
        /// The number of triangles of the mesh.
        mesh: usize,
    },
    /// A triangle lies elsewhere.
    Triangle {
        /// The number of the triangle.
        triangle: u32,
    },
}

impl fmt::Display for MeshMismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Count { scene, mesh } => {
                write!(
                    f,
                    "the structure was built from {scene} triangles, but the mesh has {mesh}: build it anew"
                )
            }
            Self::Triangle { triangle } => {
                write!(
                    f,
                    "the structure was built from another triangle {triangle} than the mesh has: build it anew"
                )
            }
        }
    }
}

impl std::error::Error for MeshMismatch {}

impl Scene {
    /// Whether this scene, loaded perhaps, was built from `mesh`: compares all triangles. O(triangles).
    ///
    /// ```
    /// use octogrid::{MeshMismatch, Scene, builtin};
    /// let (cube, room) = (builtin::cube(), builtin::room());
    /// let scene = Scene::build(&cube.mesh()?, &Default::default())?;
    /// assert_eq!(scene.check_mesh(&cube.mesh()?), Ok(()));
    /// assert!(matches!(scene.check_mesh(&room.mesh()?), Err(MeshMismatch::Count { scene: 12, .. })));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`MeshMismatch`] where it was not.
    pub fn check_mesh(&self, mesh: &TriMesh<'_>) -> Result<(), MeshMismatch> {
        if self.triangles != mesh.len() {
            return Err(MeshMismatch::Count { scene: self.triangles, mesh: mesh.len() });
        }
        let mut seen = vec![false; mesh.len()];
        for cluster in &self.arena.clusters {
            let lanes = cluster.occupied().count_ones() as usize;
            for (lane, &triangle) in cluster.ids()[..lanes].iter().enumerate() {
                if cluster.triangle(lane) != mesh.corners(triangle) {
                    return Err(MeshMismatch::Triangle { triangle });
                }
                seen[triangle as usize] = true;
            }
        }
        // What is in no cluster was left out because no ray can hit it.
        match (0..mesh.len() as u32).find(|&i| !seen[i as usize] && has_area(mesh.corners(i))) {
            Some(triangle) => Err(MeshMismatch::Triangle { triangle }),
            None => Ok(()),
        }
    }
}

fn has_area([v0, v1, v2]: [Vec3; 3]) -> bool {
    let edge = |to: Vec3| from_fn(|axis| Difference::new(f64::from(to[axis]), f64::from(v0[axis])));
    cross(&edge(v1), &edge(v2)).iter().any(|area| area.sign() != 0.0)
}
