//! Points on lights, chosen in proportion to the power that they send out.

use glam::{DVec3, Vec3};
use octogrid::Rng;

use crate::shade::Shading;

/// A point on a light.
#[derive(Clone, Copy, Debug)]
pub(super) struct LightPoint {
    pub(super) point: DVec3,
    /// Of length 1, to either side.
    pub(super) normal: DVec3,
    /// Radiance.
    pub(super) emission: Vec3,
}

/// A triangle that emits.
struct Emitter {
    corners: [DVec3; 3],
    normal: DVec3,
    emission: Vec3,
    /// The power of all emitters up to this one.
    cumulative: f64,
}

/// The triangles that emit.
pub(super) struct Emitters {
    emitters: Vec<Emitter>,
    /// Emission, summed over colours, times area.
    power: f64,
}

impl Emitters {
    /// The triangles of a scene that have power; none where no triangle has.
    pub(super) fn new(shading: &Shading) -> Option<Self> {
        let (mut emitters, mut power) = (Vec::new(), 0.0);
        for triangle in shading.triangles() {
            let emission = Vec3::from_array(shading.material(triangle).emission);
            let corners @ [a, b, c] = shading.corners(triangle);
            let normal = (b - a).cross(c - a);
            let own = brightness(emission) * normal.length() / 2.0;
            if own > 0.0 && own.is_finite() {
                power += own;
                emitters.push(Emitter { corners, normal: normal.normalize(), emission, cumulative: power });
            }
        }
        (power > 0.0).then_some(Self { emitters, power })
    }

    /// A random point, uniform on each triangle.
    pub(super) fn sample(&self, rng: &mut Rng) -> LightPoint {
        let at = rng.unit() * self.power;
        let chosen = self.emitters.partition_point(|e| e.cumulative <= at).min(self.emitters.len() - 1);
        let Emitter { corners: [a, b, c], normal, emission, .. } = self.emitters[chosen];
        let root = rng.unit().sqrt();
        let (u, v) = (1.0 - root, root * rng.unit());
        LightPoint { point: a + (b - a) * u + (c - a) * v, normal, emission }
    }

    /// The density a unit of area with which [`Emitters::sample`] chooses a point of such emission.
    pub(super) fn density(&self, emission: Vec3) -> f64 {
        brightness(emission) / self.power
    }
}

fn brightness(emission: Vec3) -> f64 {
    f64::from(emission.element_sum())
}
