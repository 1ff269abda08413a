//! What a query reports, and which of two hits comes first.

use bytemuck::{Pod, Zeroable};

/// Where a ray meets a triangle.
///
/// The point is `(1 - u - v) * v0 + u * v1 + v * v2`. t is the exact distance rounded to the nearest
/// f32 (ties to even); u and v lie in [0, 1] and are rounded from more than f32 precision. All three
/// depend on the ray and the triangle alone, so every structure, thread count and instruction set
/// reports the same bits.
///
/// 16 bytes without padding, in the order `t u v prim`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Hit {
    /// Distance in units of the length of the ray's direction; infinite where there is no hit.
    pub t: f32,
    /// Barycentric coordinate of the triangle's second vertex.
    pub u: f32,
    /// Barycentric coordinate of the triangle's third vertex.
    pub v: f32,
    /// Index of the triangle in the mesh; `u32::MAX` where there is no hit.
    pub prim: u32,
}

impl Hit {
    /// No hit.
    pub const MISS: Hit = Hit { t: f32::INFINITY, u: 0.0, v: 0.0, prim: u32::MAX };

    /// Whether there is a hit.
    pub fn is_hit(&self) -> bool {
        self.prim != u32::MAX
    }

    /// The order of hits along a ray: by t, and by index of the triangle where t is equal.
    ///
    /// [`Hit::MISS`] comes last.
    pub fn precedes(&self, other: &Hit) -> bool {
        (self.t, self.prim) < (other.t, other.prim)
    }
}

const _: () = assert!(size_of::<Hit>() == 16);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ties_go_to_the_lower_index() {
        let hit = |t, prim| Hit { t, u: 0.0, v: 0.0, prim };
        assert!(hit(1.0, 7).precedes(&hit(2.0, 3)));
        assert!(hit(1.0, 3).precedes(&hit(1.0, 7)));
        assert!(!hit(1.0, 3).precedes(&hit(1.0, 3)));
        assert!(hit(f32::MAX, 3).precedes(&Hit::MISS));
    }
}
