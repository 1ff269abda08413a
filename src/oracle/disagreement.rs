//! Two answers that differ, with all that is needed to ask again.

use std::fmt;

use glam::Vec3;

use crate::mesh::TriMesh;
use crate::ray::Ray;

/// Two answers that differ. Prints the ray and the triangles in decimal and in bits.
#[derive(Clone, Debug)]
pub struct Disagreement {
    /// Who gave the answer `found`: a structure and its instruction set, or brute force.
    pub subject: String,
    /// The query, and how it was run.
    pub query: String,
    /// The ray, where one was involved.
    pub ray: Option<Ray>,
    /// What was expected.
    pub expected: String,
    /// What was found instead.
    pub found: String,
    /// The triangles that either answer names.
    pub triangles: Vec<(u32, [Vec3; 3])>,
}

impl Disagreement {
    /// One without a ray.
    pub(super) fn new(
        subject: impl Into<String>,
        query: impl Into<String>,
        expected: &dyn fmt::Debug,
        found: &dyn fmt::Debug,
    ) -> Box<Self> {
        Box::new(Self {
            subject: subject.into(),
            query: query.into(),
            ray: None,
            expected: format!("{expected:?}"),
            found: format!("{found:?}"),
            triangles: Vec::new(),
        })
    }

    /// Adds the ray and the triangles that were hit.
    pub(super) fn on(
        mut self: Box<Self>,
        ray: &Ray,
        mesh: &TriMesh<'_>,
        prims: impl IntoIterator<Item = u32>,
    ) -> Box<Self> {
        self.ray = Some(*ray);
        let mut prims: Vec<u32> = prims.into_iter().filter(|&p| (p as usize) < mesh.len()).collect();
        prims.sort_unstable();
        prims.dedup();
        self.triangles = prims.into_iter().map(|prim| (prim, mesh.corners(prim))).collect();
        self
    }
}

impl fmt::Display for Disagreement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{} disagrees on `{}`", self.subject, self.query)?;
        writeln!(f, "  expected {}", self.expected)?;
        writeln!(f, "  found    {}", self.found)?;
        if let Some(ray) = self.ray {
            let values: [f32; 8] = bytemuck::cast(ray);
            writeln!(f, "  ray [ox oy oz t_min dx dy dz t_max] = {values:?}")?;
            writeln!(f, "    bits {}", bits(&values))?;
        }
        for (prim, corners) in &self.triangles {
            let values: [f32; 9] = bytemuck::cast(*corners);
            writeln!(f, "  triangle {prim} = {corners:?}")?;
            writeln!(f, "    bits {}", bits(&values))?;
        }
        Ok(())
    }
}

impl std::error::Error for Disagreement {}

/// As a list of u32 literals, to paste into `f32::from_bits`.
fn bits(values: &[f32]) -> String {
    let words: Vec<String> = values.iter().map(|x| format!("{:#010x}", x.to_bits())).collect();
    format!("[{}]", words.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prints_what_a_replay_needs() {
        let vertices = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let mesh = TriMesh::new(&vertices, &[[0, 1, 2]]).unwrap();
        let ray = Ray::new([0.5, -0.0, 2.0], [0.0, 0.0, -1.0]);
        let text = Disagreement::new("O[4,15]", "closest", &1, &2).on(&ray, &mesh, [0, u32::MAX]).to_string();
        assert!(text.starts_with("O[4,15] disagrees on `closest`\n  expected 1\n  found    2\n"), "{text}");
        assert!(text.contains("[0.5, -0.0, 2.0, 0.0, 0.0, 0.0, -1.0, inf]"), "{text}");
        assert!(text.contains("bits [0x3f000000, 0x80000000, 0x40000000, 0x00000000,"), "{text}");
        assert!(text.contains("triangle 0 = "), "{text}");
    }
}
