//! Rays, alone and in packets.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// A ray, of which the points `origin + t * dir` with t in (`t_min`, `t_max`] count.
///
/// The direction need not be normalised: t is in units of its length. 32 bytes without padding, in
/// the order `ox oy oz t_min dx dy dz t_max`, so that a slice of rays can be cast from and to
/// `[[f32; 8]]` with `bytemuck`.
///
/// A ray with a NaN anywhere, an infinite origin or direction, or a direction of zero meets
/// nothing; `t_min` and `t_max` may be infinite.
///
/// ```
/// use octogrid::Ray;
/// let ray = Ray::new([0.0, 0.0, 5.0], [0.0, 0.0, -1.0]);
/// assert_eq!(ray.at(2.0).to_array(), [0.0, 0.0, 3.0]);
/// assert_eq!((ray.t_min, ray.t_max), (0.0, f32::INFINITY));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Ray {
    /// Where t = 0.
    pub origin: Vec3,
    /// Hits at or before this t do not count (open end).
    pub t_min: f32,
    /// The direction, of any length but zero.
    pub dir: Vec3,
    /// Hits beyond this t do not count (closed end).
    pub t_max: f32,
}

impl Ray {
    /// The ray with the interval (0, ∞].
    pub fn new(origin: impl Into<Vec3>, dir: impl Into<Vec3>) -> Self {
        Self { origin: origin.into(), t_min: 0.0, dir: dir.into(), t_max: f32::INFINITY }
    }

    /// The segment from `from` to `to`, both ends open: t is 0 at `from` and 1 at `to`.
    ///
    /// For shadow rays, which must meet neither the surface nor the light that they join.
    pub fn segment(from: impl Into<Vec3>, to: impl Into<Vec3>) -> Self {
        let origin = from.into();
        Self { origin, t_min: 0.0, dir: to.into() - origin, t_max: 1.0f32.next_down() }
    }

    /// The same ray with the interval (`t_min`, `t_max`].
    #[must_use]
    pub fn with_interval(self, t_min: f32, t_max: f32) -> Self {
        Self { t_min, t_max, ..self }
    }

    /// The point at `t`, in f32.
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + t * self.dir
    }

    /// Whether the ray can meet anything at all: finite origin and direction, a direction that is
    /// not zero, no NaN, and an interval that is not empty.
    pub fn is_valid(&self) -> bool {
        self.origin.is_finite() && self.dir.is_finite() && self.dir != Vec3::ZERO && self.t_min < self.t_max
    }

    /// The octant of the direction: bit `axis` is set where it points to lower coordinates. Zeros of
    /// either sign count as positive.
    pub fn octant(&self) -> u32 {
        (0..3).map(|axis| u32::from(self.dir[axis] < 0.0) << axis).sum()
    }
}

/// Eight rays as a structure of arrays, one SIMD lane a ray.
///
/// 256 bytes, aligned to 32. [`RayPacket::new`] gathers rays; a packet of fewer than eight is filled
/// up with rays whose interval is empty, which meet nothing.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct RayPacket {
    /// Origins, an axis each.
    pub origin: [wide::f32x8; 3],
    /// Open lower ends of the intervals.
    pub t_min: wide::f32x8,
    /// Directions, an axis each.
    pub dir: [wide::f32x8; 3],
    /// Closed upper ends of the intervals.
    pub t_max: wide::f32x8,
}

impl RayPacket {
    /// The number of rays in a packet.
    pub const LEN: usize = 8;

    /// Gathers the first eight of `rays`.
    pub fn new(rays: &[Ray]) -> Self {
        let none = Ray { origin: Vec3::ZERO, t_min: 0.0, dir: Vec3::X, t_max: -1.0 };
        let lane = |f: &dyn Fn(&Ray) -> f32| {
            wide::f32x8::from(std::array::from_fn::<f32, 8, _>(|i| f(rays.get(i).unwrap_or(&none))))
        };
        Self {
            origin: std::array::from_fn(|axis| lane(&|r| r.origin[axis])),
            t_min: lane(&|r| r.t_min),
            dir: std::array::from_fn(|axis| lane(&|r| r.dir[axis])),
            t_max: lane(&|r| r.t_max),
        }
    }

    /// The ray of one lane.
    ///
    /// # Panics
    /// Where `lane` is 8 or more.
    pub fn get(&self, lane: usize) -> Ray {
        let at = |v: &wide::f32x8| v.as_array()[lane];
        Ray {
            origin: Vec3::from_array(std::array::from_fn(|axis| at(&self.origin[axis]))),
            t_min: at(&self.t_min),
            dir: Vec3::from_array(std::array::from_fn(|axis| at(&self.dir[axis]))),
            t_max: at(&self.t_max),
        }
    }
}

const _: () = assert!(size_of::<Ray>() == 32);
const _: () = assert!(size_of::<RayPacket>() == 256);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn invalid_rays_are_told() {
        let ray = Ray::new([0.0; 3], [0.0, 0.0, 1.0]);
        assert!(ray.is_valid());
        assert!(!Ray::new([0.0; 3], [0.0, -0.0, 0.0]).is_valid());
        assert!(!Ray::new([f32::NAN, 0.0, 0.0], [1.0, 0.0, 0.0]).is_valid());
        assert!(!Ray::new([0.0; 3], [f32::INFINITY, 0.0, 0.0]).is_valid());
        assert!(!ray.with_interval(1.0, 1.0).is_valid());
        assert!(!ray.with_interval(f32::NAN, 1.0).is_valid());
        assert!(ray.with_interval(f32::NEG_INFINITY, f32::INFINITY).is_valid());
    }

    #[test]
    fn octant_ignores_the_sign_of_zero() {
        assert_eq!(Ray::new([0.0; 3], [-0.0, -1.0, 1.0]).octant(), 2);
    }

    #[test]
    fn packet_keeps_rays_and_fills_up_with_empty_ones() {
        let ray = Ray::new([1.0, 2.0, 3.0], [4.0, 5.0, 6.0]);
        let packet = RayPacket::new(&[ray; 3]);
        assert_eq!(packet.get(2), ray);
        assert!(!packet.get(3).is_valid());
    }
}
