//! Axis-aligned boxes.

use glam::{Vec3, Vec4};

/// A closed axis-aligned box; empty where `lo` exceeds `hi`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Aabb {
    pub(crate) lo: Vec3,
    pub(crate) hi: Vec3,
}

impl Aabb {
    pub(crate) const EMPTY: Self = Self { lo: Vec3::INFINITY, hi: Vec3::NEG_INFINITY };

    /// The least box around points.
    pub(crate) fn around(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| Self { lo: b.lo.min(p), hi: b.hi.max(p) })
    }

    /// The least box around both.
    pub(crate) fn union(self, other: Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    /// The common part.
    pub(crate) fn intersection(self, other: Self) -> Self {
        Self { lo: self.lo.max(other.lo), hi: self.hi.min(other.hi) }
    }

    /// The extent along each axis, zero where the box is empty.
    pub(crate) fn extent(&self) -> Vec3 {
        (self.hi - self.lo).max(Vec3::ZERO)
    }

    /// Half the surface area, to which the number of random rays that meet the box is proportional.
    pub(crate) fn half_area(&self) -> f32 {
        let e = self.extent();
        e.x * e.y + e.y * e.z + e.z * e.x
    }

    /// [`Aabb::center`] on four lanes, of which the last means nothing.
    #[inline(always)]
    pub(crate) fn center4(&self) -> Vec4 {
        self.lo.extend(0.0) * 0.5 + self.hi.extend(0.0) * 0.5
    }

    /// The middle; finite where the box is.
    pub(crate) fn center(&self) -> Vec3 {
        0.5 * self.lo + 0.5 * self.hi
    }
}
