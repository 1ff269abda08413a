//! The usual triangle test, for crates that leave it to their users or cull back faces.

use glam::Vec3A;
use octogrid::{Ray, TriMesh};

/// A corner and two edges (Möller, Trumbore 1997).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triangle {
    corner: Vec3A,
    edges: [Vec3A; 2],
}

impl Triangle {
    /// All triangles of a mesh.
    pub(crate) fn all(mesh: TriMesh<'_>) -> impl ExactSizeIterator<Item = Self> {
        (0..mesh.len()).map(move |i| Self::new(mesh.corners(i as u32).map(Vec3A::from)))
    }

    fn new([a, b, c]: [Vec3A; 3]) -> Self {
        Self { corner: a, edges: [b - a, c - a] }
    }

    /// The least and the greatest corner of its box.
    pub(crate) fn bounds(&self) -> [Vec3A; 2] {
        let [a, b, c] = [self.corner, self.corner + self.edges[0], self.corner + self.edges[1]];
        [a.min(b).min(c), a.max(b).max(c)]
    }

    /// t of the hit with either side in \[`t_min`, `t_max`\].
    #[inline(always)]
    pub(crate) fn hit(&self, ray: &Ray, t_max: f32) -> Option<f32> {
        let (origin, dir) = (Vec3A::from(ray.origin), Vec3A::from(ray.dir));
        let p = dir.cross(self.edges[1]);
        let inverse = 1.0 / self.edges[0].dot(p);
        let s = origin - self.corner;
        let u = s.dot(p) * inverse;
        let q = s.cross(self.edges[0]);
        let v = dir.dot(q) * inverse;
        let t = self.edges[1].dot(q) * inverse;
        // NaN and infinities of parallel rays fail, too.
        let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
        (inside && t >= ray.t_min && t <= t_max).then_some(t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_sides_are_hit_within_the_interval() {
        let vertices = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let mesh = TriMesh::new(&vertices, &[[0, 1, 2]]).unwrap();
        let triangle = Triangle::all(mesh).next().unwrap();
        for side in [1.0, -1.0] {
            let ray = |x| Ray::new([x, 0.25, 2.0 * side], [0.0, 0.0, -side]);
            assert_eq!(triangle.hit(&ray(0.25), f32::INFINITY), Some(2.0));
            assert_eq!(triangle.hit(&ray(0.25), 1.9), None);
            assert_eq!(triangle.hit(&ray(0.8), f32::INFINITY), None);
        }
        let parallel = Ray::new([-1.0, 0.25, 0.0], [1.0, 0.0, 0.0]);
        assert_eq!(triangle.hit(&parallel, f32::INFINITY), None);
    }
}
