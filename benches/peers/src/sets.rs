//! The rays, the same for all: of a camera, to lights, off surfaces, and across the scene.
//!
//! `t_min` is 0 throughout, as some contenders have none; origins on surfaces are pushed off them
//! instead. Directions have length 1.

use glam::DVec3;
use octogrid::{Model, Ray, Rng, Scene};

use crate::camera::Pinhole;
use crate::load::Loaded;
use crate::peer::Question;
use crate::{survey, viewpoint};

/// Side of the tiles in which pixels follow one another.
const TILE: u32 = 8;
/// Lights that shadow rays go to in turn.
const LIGHTS: usize = 5;

/// Rays and what is asked of them.
pub(crate) struct RaySet {
    pub(crate) name: &'static str,
    pub(crate) question: Question,
    /// Whether neighbours start and point nearly alike.
    pub(crate) coherent: bool,
    pub(crate) rays: Vec<Ray>,
}

/// All sets, of about `n` rays each; the same for the same model and number.
pub(crate) fn all(loaded: &Loaded, scene: &Scene, n: usize) -> Vec<RaySet> {
    let side = ((n as f64).sqrt() as u32 / TILE).max(1) * TILE;
    let camera = viewpoint::camera(loaded, scene, [side; 2]);
    let primary = primary(&camera, side);
    let points = points(&loaded.model, scene, &primary);
    let bounds = survey::bounds(&loaded.model).unwrap_or_default();
    let set = |name, question, coherent, rays| RaySet { name, question, coherent, rays };
    let shadow = shadow(bounds, primary[0].origin.as_dvec3(), &points, n);
    let random = random(bounds, n);
    vec![
        set("primary", Question::Closest, true, primary),
        set("shadow", Question::Any, true, shadow),
        set("diffuse", Question::Closest, false, diffuse(&points, n)),
        set("random", Question::Closest, false, random.clone()),
        set("all hits", Question::All, false, random),
    ]
}

/// One ray a pixel, tile after tile.
fn primary(camera: &Pinhole, side: u32) -> Vec<Ray> {
    let tiles = side / TILE;
    let pixel = |i: u32| {
        let (tile, within) = (i / (TILE * TILE), i % (TILE * TILE));
        let (x, y) = (tile % tiles * TILE + within % TILE, tile / tiles * TILE + within / TILE);
        (y * side + x) as usize
    };
    (0..side * side).map(|i| camera.ray(pixel(i))).collect()
}

/// A point beside a surface, on the side of the viewer, and the normal there.
struct Point {
    at: DVec3,
    normal: DVec3,
}

/// Where the rays hit.
fn points(model: &Model, scene: &Scene, rays: &[Ray]) -> Vec<Point> {
    let (low, high) = survey::bounds(model).unwrap_or_default();
    let size = low.distance(high);
    let point = |ray: &Ray| {
        let hit = scene.closest(ray);
        let [a, b, c] = hit.is_hit().then(|| survey::corners(model, hit.prim))?;
        let normal = (b - a).cross(c - a).try_normalize()?;
        let normal = -normal * normal.dot(ray.dir.as_dvec3()).signum();
        let at = ray.origin.as_dvec3() + f64::from(hit.t) * ray.dir.as_dvec3();
        // Far enough for f32, near enough for small triangles.
        let step = (1e-5 * size).min(1e-4 * f64::from(hit.t)).max(4e-6 * at.abs().max_element());
        Some(Point { at: at + step * normal, normal })
    };
    rays.iter().filter_map(point).collect()
}

/// `n` of the points, in order; each several times where there are fewer.
fn spread(points: &[Point], n: usize) -> impl Iterator<Item = &Point> {
    (0..if points.is_empty() { 0 } else { n }).map(move |i| &points[i * points.len() / n])
}

/// From each point to each light, until just before it. Lights are above the scene, or above the middle
/// of what is seen where the eye is inside.
fn shadow((low, high): (DVec3, DVec3), eye: DVec3, points: &[Point], n: usize) -> Vec<Ray> {
    let rng = &mut Rng::new(101);
    let inside = eye.cmpge(low).all() && eye.cmple(high).all();
    let seen = points.iter().map(|point| (point.at, point.at));
    let seen = seen.reduce(|(low, high), (at, _)| (low.min(at), high.max(at))).unwrap_or((low, high));
    let light = |()| {
        if inside {
            let (low, high) = seen;
            let at = DVec3::new(rng.range(0.1, 0.9), rng.range(0.6, 0.95), rng.range(0.1, 0.9));
            low + at * (high - low)
        } else {
            let up = rng.on_sphere();
            low.midpoint(high) + 0.6 * low.distance(high) * up.with_y(up.y.abs())
        }
    };
    let lights = [(); LIGHTS].map(light);
    let ray = |from: DVec3, to: DVec3| {
        let way = to - from;
        let ray = Ray::new(from.as_vec3(), way.normalize().as_vec3());
        ray.with_interval(0.0, 0.999 * way.length() as f32)
    };
    spread(points, n / LIGHTS).flat_map(|point| lights.map(|light| ray(point.at, light))).collect()
}

/// From each point in a direction by the cosine law.
fn diffuse(points: &[Point], n: usize) -> Vec<Ray> {
    let rng = &mut Rng::new(202);
    let ray = |point: &Point| {
        let dir = (point.normal + rng.on_sphere()).normalize_or(point.normal);
        Ray::new(point.at.as_vec3(), dir.as_vec3())
    };
    spread(points, n).map(ray).collect()
}

/// From the bounding sphere to points of the box.
fn random((low, high): (DVec3, DVec3), n: usize) -> Vec<Ray> {
    let rng = &mut Rng::new(303);
    let ray = |_| {
        let from = low.midpoint(high) + low.distance(high) / 2.0 * rng.on_sphere();
        let part = DVec3::new(rng.unit(), rng.unit(), rng.unit());
        let dir = low + part * (high - low) - from;
        Ray::new(from.as_vec3(), dir.normalize_or(DVec3::X).as_vec3())
    };
    (0..n).map(ray).collect()
}
