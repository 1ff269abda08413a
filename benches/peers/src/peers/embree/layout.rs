//! Rays and hits as Embree 4 lays them out in memory (`rtcore_ray.h`).

use octogrid::Ray;

use crate::peer::Answer;

/// RTC_INVALID_GEOMETRY_ID.
pub(super) const NONE: u32 = u32::MAX;

/// RTCRay.
#[derive(Clone, Copy, Default)]
#[repr(C, align(16))]
pub(super) struct RtcRay {
    origin: [f32; 3],
    t_near: f32,
    dir: [f32; 3],
    time: f32,
    pub(super) t_far: f32,
    mask: u32,
    id: u32,
    flags: u32,
}

/// RTCRayHit.
#[derive(Clone, Copy, Default)]
#[repr(C, align(16))]
pub(super) struct RayHit {
    pub(super) ray: RtcRay,
    normal: [f32; 3],
    uv: [f32; 2],
    prim: u32,
    geometry: u32,
    /// The instance, and room for what a build with more of them writes.
    instance: [u32; 9],
}

impl RayHit {
    /// Makes it a ray that has not hit anything.
    #[inline(always)]
    pub(super) fn set(&mut self, ray: &Ray) {
        self.ray = RtcRay {
            origin: ray.origin.to_array(),
            t_near: ray.t_min,
            dir: ray.dir.to_array(),
            t_far: ray.t_max,
            mask: u32::MAX,
            ..RtcRay::default()
        };
        self.geometry = NONE;
    }

    #[inline(always)]
    pub(super) fn answer(&self) -> Answer {
        if self.geometry == NONE { Answer::MISS } else { Answer { t: self.ray.t_far, prim: self.prim } }
    }
}

/// RTCRayHit8 or RTCRayHit16, after the mask of lanes in use that is passed beside it.
#[repr(C, align(64))]
pub(super) struct Packet<const N: usize> {
    origin: [[f32; N]; 3],
    t_near: [f32; N],
    dir: [[f32; N]; 3],
    time: [f32; N],
    pub(super) t_far: [f32; N],
    mask: [u32; N],
    id: [u32; N],
    flags: [u32; N],
    normal: [[f32; N]; 3],
    uv: [[f32; N]; 2],
    pub(super) prim: [u32; N],
    pub(super) geometry: [u32; N],
    instance: [[u32; N]; 3],
    /// Not Embree's: -1 in lanes in use.
    pub(super) valid: Lanes<N>,
}

/// A mask as wide as the packet, aligned as Embree wants it.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct Lanes<const N: usize>(pub(super) [i32; N]);

impl<const N: usize> Default for Packet<N> {
    fn default() -> Self {
        Self {
            origin: [[0.0; N]; 3],
            t_near: [0.0; N],
            dir: [[0.0; N]; 3],
            time: [0.0; N],
            t_far: [0.0; N],
            mask: [u32::MAX; N],
            id: [0; N],
            flags: [0; N],
            normal: [[0.0; N]; 3],
            uv: [[0.0; N]; 2],
            prim: [NONE; N],
            geometry: [NONE; N],
            instance: [[NONE; N]; 3],
            valid: Lanes([0; N]),
        }
    }
}

impl<const N: usize> Packet<N> {
    /// Fills the first lanes with rays that have not hit anything; the others are not in use.
    #[inline(always)]
    pub(super) fn set(&mut self, rays: &[Ray]) {
        self.valid = Lanes(std::array::from_fn(|lane| if lane < rays.len() { -1 } else { 0 }));
        self.geometry = [NONE; N];
        for (lane, ray) in rays.iter().enumerate() {
            for axis in 0..3 {
                self.origin[axis][lane] = ray.origin[axis];
                self.dir[axis][lane] = ray.dir[axis];
            }
            self.t_near[lane] = ray.t_min;
            self.t_far[lane] = ray.t_max;
        }
    }
}

const _: () = assert!(size_of::<RtcRay>() == 48);
const _: () = assert!(std::mem::offset_of!(RayHit, geometry) == 72);
const _: () = assert!(std::mem::offset_of!(Packet<8>, geometry) == 18 * 32);
const _: () = assert!(std::mem::offset_of!(Packet<16>, geometry) == 18 * 64);
