//! Where to stand in a scene that doesn't say: inside a closed interior, else before the object.

use glam::DVec3;
use octogrid::{Hit, Model, Ray, Scene};

use crate::camera::{Pinhole, Viewpoint};
use crate::load::Loaded;
use crate::survey::{self, bounds};

/// Rays that probe a place.
const PROBES: usize = 200;

/// The first built-in camera, else a sensible one, y pointing up.
pub(crate) fn camera(loaded: &Loaded, scene: &Scene, size: [u32; 2]) -> Pinhole {
    let view = match loaded.cameras.first() {
        Some(camera) => camera.into(),
        None => automatic(&loaded.model, scene, 1),
    };
    Pinhole::new(&view, DVec3::Y, size)
}

/// A viewpoint for the scene, `up` being the index of the vertical axis.
pub(crate) fn automatic(model: &Model, scene: &Scene, up: usize) -> Viewpoint {
    let (low, high) = bounds(model).unwrap_or((DVec3::ZERO, DVec3::ONE));
    let at = |fractions: DVec3| low + (high - low) * fractions;
    let mut middle = DVec3::splat(0.5);
    middle[up] = 0.45;
    if Probe::at(model, scene, at(middle)).is_inside() {
        inside(model, scene, at, up)
    } else {
        outside(low, high, up)
    }
}

/// Near that corner from which one sees farthest.
fn inside(model: &Model, scene: &Scene, at: impl Fn(DVec3) -> DVec3, up: usize) -> Viewpoint {
    let place = |x: f64, y: f64, height: f64| {
        let mut fractions = DVec3::ZERO;
        fractions[(up + 1) % 3] = x;
        fractions[(up + 2) % 3] = y;
        fractions[up] = height;
        at(fractions)
    };
    let corner =
        |inset: f64| [(inset, inset), (1.0 - inset, inset), (inset, 1.0 - inset), (1.0 - inset, 1.0 - inset)];
    let corners = [0.15, 0.25].into_iter().flat_map(corner);
    let eyes = corners.flat_map(|(x, y)| [0.35, 0.6].map(|height| place(x, y, height)));
    let probes = eyes.map(|eye| (Probe::at(model, scene, eye), eye)).filter(|(p, _)| p.is_inside());
    let best = probes.max_by(|a, b| a.0.median.total_cmp(&b.0.median));
    // In a building of several rooms the centre of all is behind a wall, that of what is seen is not.
    let middle = place(0.5, 0.5, 0.45);
    let (centre, eye) = best.map_or((middle, place(0.15, 0.15, 0.5)), |(probe, eye)| (probe.centre, eye));
    let mut towards = centre - eye;
    towards[up] = 0.0;
    // A little downwards: floors carry more than ceilings.
    towards[up] = -0.2 * towards.length();
    Viewpoint { eye, target: eye + towards, fov_degrees: 65.0 }
}

/// A three-quarter view that holds the bounding sphere.
fn outside(low: DVec3, high: DVec3, up: usize) -> Viewpoint {
    let fov_degrees: f64 = 35.0;
    let target = (low + high) / 2.0;
    let mut towards = DVec3::ZERO;
    towards[(up + 1) % 3] = if up == 1 { 1.0 } else { 0.6 };
    towards[(up + 2) % 3] = if up == 1 { 0.6 } else { -1.0 };
    towards[up] = 0.55;
    let radius = ((high - low).length() / 2.0).max(f64::from(f32::MIN_POSITIVE));
    let distance = 0.9 * radius / (fov_degrees / 2.0).to_radians().sin();
    Viewpoint { eye: target + towards.normalize() * distance, target, fov_degrees }
}

/// What one sees around a point.
struct Probe {
    /// Parts of the directions in which there is something.
    closed: f64,
    /// Parts of the hits that meet the front of something like a wall, floor or ceiling.
    walls: f64,
    /// Median distance of a hit.
    median: f64,
    /// The mean of the hits.
    centre: DVec3,
}

impl Probe {
    fn at(model: &Model, scene: &Scene, point: DVec3) -> Self {
        let rays = (0..PROBES).map(|i| Ray::new(point.as_vec3(), direction(i).as_vec3()));
        let seen: Vec<(Ray, Hit)> =
            rays.map(|ray| (ray, scene.closest(&ray))).filter(|(_, hit)| hit.is_hit()).collect();
        let walls = seen.iter().filter(|(ray, hit)| meets_wall(model, ray, hit)).count();
        let reached = seen.iter().map(|(ray, hit)| ray.at(hit.t).as_dvec3());
        let centre = reached.sum::<DVec3>() / seen.len().max(1) as f64;
        let mut distances: Vec<f32> = seen.iter().map(|(_, hit)| hit.t).collect();
        distances.sort_by(f32::total_cmp);
        Self {
            closed: seen.len() as f64 / PROBES as f64,
            walls: walls as f64 / seen.len().max(1) as f64,
            median: distances.get(distances.len() / 2).copied().map_or(0.0, f64::from),
            centre,
        }
    }

    /// A room is closed around and shows the fronts of walls; a solid object shows its backs within,
    /// and a hollow one is round. Real rooms show 80% to 99% walls, closed objects and trees
    /// less than half.
    fn is_inside(&self) -> bool {
        self.closed > 0.9 && self.walls > 0.6
    }
}

/// Whether the ray meets the front of a triangle that stands across an axis, within 8 degrees.
fn meets_wall(model: &Model, ray: &Ray, hit: &Hit) -> bool {
    let [a, b, c] = survey::corners(model, hit.prim);
    let normal = (b - a).cross(c - a).normalize_or_zero();
    normal.dot(ray.dir.as_dvec3()) < 0.0 && normal.abs().max_element() > 0.99
}

/// The i-th of [`PROBES`] directions, spread evenly along a spiral over the sphere.
fn direction(i: usize) -> DVec3 {
    let z = 1.0 - (2.0 * i as f64 + 1.0) / PROBES as f64;
    let angle = i as f64 * std::f64::consts::PI * (3.0 - 5f64.sqrt());
    let radius = (1.0 - z * z).sqrt();
    DVec3::new(radius * angle.cos(), radius * angle.sin(), z)
}
