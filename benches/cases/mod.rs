//! The cases of all benches: scenes, structures and rays, with their answers checked.
#![allow(dead_code, reason = "each bench uses its part")]

use octogrid::oracle::{Answer, brute};
use octogrid::{BuildOptions, Hit, Model, Ray, Scene, Structure, builtin};

/// The scenes: a room, a large interior, an object.
pub(crate) const SCENES: [&str; 3] = ["room", "interior", "torus"];

/// What a query is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Query {
    Closest,
    Any,
    All,
}

/// All queries with their names.
pub(crate) const QUERIES: [(&str, Query); 3] =
    [("closest", Query::Closest), ("any", Query::Any), ("all", Query::All)];

/// A built-in scene with rays of its first camera and from what they hit.
pub(crate) struct Case {
    pub(crate) name: &'static str,
    pub(crate) model: Model,
    pub(crate) rays: Vec<Ray>,
}

impl Case {
    /// About `n` rays: half from the camera, half from where those hit into all directions.
    pub(crate) fn new(name: &'static str, n: usize) -> Self {
        let builtin = builtin::by_name(name).expect("a built-in scene");
        let model = (builtin.model)();
        let scene =
            Scene::build(&model.mesh().expect("a sound mesh"), &BuildOptions::default()).expect("a scene");
        let mut rays = camera_rays(&builtin.cameras[0], n / 2);
        let mut rng = octogrid::Rng::new(1);
        let bounces: Vec<Ray> = rays
            .iter()
            .map(|ray| (ray, scene.closest(ray)))
            .filter(|(_, hit)| hit.is_hit())
            .map(|(ray, hit)| {
                let dir: [f32; 3] = std::array::from_fn(|_| rng.range(-1.0, 1.0) as f32);
                Ray::new(ray.at(0.999 * hit.t), dir)
            })
            .collect();
        rays.extend(bounces);
        Self { name, model, rays }
    }

    /// The scene in one structure, after a check of its answers on some of the rays.
    pub(crate) fn scene(&self, structure: Structure) -> Scene {
        self.scene_with(&structure.into())
    }

    /// The same with any options.
    pub(crate) fn scene_with(&self, options: &BuildOptions) -> Scene {
        let mesh = self.model.mesh().expect("a sound mesh");
        let scene = Scene::build(&mesh, options).expect("a scene");
        let sample: Vec<Ray> =
            self.rays.iter().copied().step_by(self.rays.len().div_ceil(64).max(1)).collect();
        for (ray, answer) in sample.iter().zip(brute::answers(&mesh, &sample)) {
            check(&scene, ray, &answer);
        }
        scene
    }
}

fn check(scene: &Scene, ray: &Ray, answer: &Answer) {
    let mut hits = vec![Hit::MISS; answer.all.len() + 1];
    let all = scene.all(ray, &mut hits);
    assert_eq!(scene.closest(ray), answer.closest, "{} {ray:?}", scene.structure());
    assert_eq!(scene.occluded(ray), answer.occluded, "{} {ray:?}", scene.structure());
    assert_eq!(hits[..all.len], answer.all, "{} {ray:?}", scene.structure());
}

/// Runs a query for each ray; a number that depends on every answer.
pub(crate) fn run(scene: &Scene, query: Query, rays: &[Ray]) -> u64 {
    let mut buffer = [Hit::MISS; 256];
    let answer = |ray: &Ray| match query {
        Query::Closest => u64::from(scene.closest(ray).t.to_bits()),
        Query::Any => u64::from(scene.occluded(ray)),
        Query::All => scene.all(ray, &mut buffer).len as u64,
    };
    rays.iter().map(answer).fold(0, u64::wrapping_add)
}

fn camera_rays(camera: &builtin::Camera, n: usize) -> Vec<Ray> {
    use glam::Vec3;
    let [eye, target, up] = [camera.eye, camera.target, camera.up].map(Vec3::from_array);
    let forward = (target - eye).normalize();
    let right = forward.cross(up).normalize();
    let up = right.cross(forward);
    let half = (0.5 * camera.vertical_fov_degrees).to_radians().tan();
    let side = (n as f32).sqrt().ceil() as usize;
    (0..side * side)
        .map(|i| {
            let at = |k: usize| half * (2.0 * (k as f32 + 0.5) / side as f32 - 1.0);
            Ray::new(eye, forward + at(i % side) * right - at(i / side) * up)
        })
        .collect()
}
