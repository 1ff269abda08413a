//! Saved scenes.

use std::ops::ControlFlow::Continue;
use std::sync::LazyLock;

use octogrid::oracle::{forge, rays};
use octogrid::{Closest, Hit, Kernel, Ray, Scene, builtin};

static RAYS: LazyLock<Vec<Ray>> =
    LazyLock::new(|| rays::hazards(&builtin::cube().mesh().unwrap(), 1, 2 * rays::RaySet::ALL.len()));

/// A file as it is, and with the checksums of a whole one: an error, or a scene that is the same when saved
/// again, and that answers every query with a triangle of its own.
pub fn ogrid(data: &[u8]) {
    let _ = Scene::load(data);
    let mut file = data.to_vec();
    forge::seal(&mut file);
    let Ok(scene) = Scene::load(&file[..]) else { return };
    let mut again = Vec::new();
    scene.save(&mut again).unwrap();
    assert!(file.starts_with(&again));
    scene.validate().unwrap();
    for ray in RAYS.iter() {
        let mut hits = [Hit::MISS; 4];
        let len = scene.all(ray, &mut hits).len;
        scene.occluded(ray);
        scene.clusters_along(ray, |_| Continue(()));
        for kernel in Kernel::ALL {
            let mut query = Closest::new(ray.t_max);
            scene.query_with(kernel, ray, &mut query);
            let found = hits[..len]
                .iter()
                .chain([&query.hit()])
                .all(|hit| !hit.is_hit() || (hit.prim as usize) < scene.triangles());
            assert!(found, "{ray:?}");
        }
    }
}
