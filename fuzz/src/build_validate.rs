//! Builds with any parameters.

use octogrid::oracle::brute;
use octogrid::{BuildError, Scene};

use super::case::Case;
use super::options::Options;

/// A typed error, or a structure whose invariants hold, within its memory limit, that finds the
/// closest hits.
pub fn build_validate((options, case): &(Options, Case)) {
    case.run(|mesh, rays| {
        let options = options.with(case.isa());
        let scene = match Scene::build(mesh, &options) {
            Ok(scene) => scene,
            Err(BuildError::Parameter { .. }) => return,
            Err(BuildError::MemoryLimit { limit, needed })
                if limit == options.memory_limit && needed > limit =>
            {
                return;
            }
            Err(error) => panic!("{error}"),
        };
        scene.validate().unwrap_or_else(|violation| panic!("{violation:?}"));
        assert!(scene.bytes() <= options.memory_limit, "{} bytes", scene.bytes());
        for (ray, answer) in rays.iter().zip(brute::answers(mesh, rays)) {
            assert_eq!(scene.closest(ray), answer.closest, "{ray:?}");
        }
    });
}
