//! Single rays.

use super::case::Case;

/// One structure against brute force and exact arithmetic, ray by ray.
pub fn closest(case: &Case) {
    case.run(|mesh, rays| {
        case.agreement().assert(mesh, rays);
    });
}
