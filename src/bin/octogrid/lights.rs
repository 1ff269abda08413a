//! Lights: connected groups of emissive triangles, each seen as one point.

use glam::{DVec3, Vec3};
use octogrid::Model;

use crate::survey::corners;

/// A light.
#[derive(Clone, Debug)]
pub(crate) struct Light {
    centre: DVec3,
    /// The unit normal of a flat light; none where the light has volume.
    normal: Option<DVec3>,
    area: f64,
    emission: Vec3,
    /// For a light with volume the points that stand for it as seen along each axis, from below and
    /// from above.
    faces: [[DVec3; 2]; 3],
}

impl Light {
    /// All lights of a model that have an area.
    pub(crate) fn all(model: &Model) -> Vec<Self> {
        model.lights().iter().filter_map(|group| Self::new(model, group)).collect()
    }

    fn new(model: &Model, group: &[u32]) -> Option<Self> {
        let emission = model.material(*group.first()?)?.emission.into();
        let triangles: Vec<(DVec3, DVec3)> = group
            .iter()
            .map(|&triangle| {
                let [a, b, c] = corners(model, triangle);
                ((a + b + c) / 3.0, (b - a).cross(c - a) / 2.0)
            })
            .collect();
        let area: f64 = triangles.iter().map(|(_, normal)| normal.length()).sum();
        if !(area.is_finite() && area > 0.0) {
            return None;
        }
        let centre = triangles.iter().map(|(point, normal)| point * normal.length()).sum::<DVec3>() / area;
        let net: DVec3 = triangles.iter().map(|(_, normal)| normal).sum();
        let normal = (net.length() > 0.5 * area).then(|| net.normalize());
        let faces = std::array::from_fn(|axis| [-1.0, 1.0].map(|sign| extreme(&triangles, axis, sign)));
        Some(Self { centre, normal, area, emission, faces })
    }

    /// A point on the light, moved off it by `offset`, to be seen from `point`.
    pub(crate) fn target(&self, point: DVec3, offset: f64) -> DVec3 {
        let away = point - self.centre;
        if let Some(normal) = self.normal {
            return self.centre + normal * offset.copysign(normal.dot(away));
        }
        let axis = away.abs().max_position();
        let mut target = self.faces[axis][usize::from(away[axis] > 0.0)];
        target[axis] += offset.copysign(away[axis]);
        target
    }

    /// Irradiance of a surface at `point` whose unit normal is `normal`, if nothing is between.
    ///
    /// Inverse-square and cosine laws; a flat light shines to both sides, and one with volume has on
    /// average a quarter of its area in view. Near by the light counts as a disc, not as a point.
    pub(crate) fn irradiance(&self, point: DVec3, normal: DVec3, target: DVec3) -> Vec3 {
        let towards = target - point;
        let square = towards.length_squared();
        let Some(direction) = towards.try_normalize() else { return Vec3::ZERO };
        let seen = self.normal.map_or(self.area / 4.0, |n| self.area * n.dot(direction).abs());
        let form = normal.dot(direction).max(0.0) * seen / (square + self.area / std::f64::consts::PI);
        self.emission * form as f32
    }
}

/// The centre of the triangle that lies farthest along an axis.
fn extreme(triangles: &[(DVec3, DVec3)], axis: usize, sign: f64) -> DVec3 {
    let along = |(point, _): &&(DVec3, DVec3)| sign * point[axis];
    triangles.iter().max_by(|a, b| along(a).total_cmp(&along(b))).map_or(DVec3::ZERO, |t| t.0)
}

#[cfg(test)]
mod tests {
    use octogrid::Material;

    use super::*;

    #[test]
    fn a_flat_light_obeys_both_laws() {
        let vertices = vec![[-0.01, 2.0, -0.01], [0.01, 2.0, -0.01], [0.01, 2.0, 0.01], [-0.01, 2.0, 0.01]];
        let lamp = Material { emission: [1.0; 3], ..Material::default() };
        let model = Model {
            vertices,
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            materials: vec![lamp],
            material_ids: vec![0, 0],
        };
        let light = Light::all(&model).remove(0);
        let at = |point: DVec3| light.irradiance(point, DVec3::Y, light.target(point, 0.0)).x;
        assert!((at(DVec3::ZERO) / 1e-4 - 1.0).abs() < 1e-3);
        // At 45 degrees: twice the square of the distance, and two cosines.
        assert!((at(DVec3::new(2.0, 0.0, 0.0)) / 2.5e-5 - 1.0).abs() < 1e-3);
        assert!(light.target(DVec3::ZERO, 0.1).y < 2.0 && light.target(DVec3::Y * 5.0, 0.1).y > 2.0);
    }
}
