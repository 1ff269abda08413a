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
        // Without short cuts: one branch.
        (self.t < other.t) | ((self.t == other.t) & (self.prim < other.prim))
    }
}

/// Eight hits as a structure of arrays, the answers to a [`crate::RayPacket`].
///
/// 128 bytes, aligned to 32.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct HitPacket {
    /// [`Hit::t`].
    pub t: wide::f32x8,
    /// [`Hit::u`].
    pub u: wide::f32x8,
    /// [`Hit::v`].
    pub v: wide::f32x8,
    /// [`Hit::prim`].
    pub prim: wide::u32x8,
}

impl HitPacket {
    /// Gathers eight hits.
    pub fn new(hits: &[Hit; 8]) -> Self {
        Self {
            t: hits.map(|hit| hit.t).into(),
            u: hits.map(|hit| hit.u).into(),
            v: hits.map(|hit| hit.v).into(),
            prim: hits.map(|hit| hit.prim).into(),
        }
    }

    /// The hit of one lane.
    ///
    /// # Panics
    /// Where `lane` is 8 or more.
    pub fn get(&self, lane: usize) -> Hit {
        Hit {
            t: self.t.as_array()[lane],
            u: self.u.as_array()[lane],
            v: self.v.as_array()[lane],
            prim: self.prim.as_array()[lane],
        }
    }
}

const _: () = assert!(size_of::<Hit>() == 16);
const _: () = assert!(size_of::<HitPacket>() == 128);

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
