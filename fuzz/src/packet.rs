//! Many rays at once.

use octogrid::Ray;
use octogrid::oracle::rays::companions;
use octogrid::oracle::{Agreement, brute};

use super::case::Case;

/// Packets, streams and batches on one and two threads against single rays, also of rays that go nearly
/// alike; where in a packet a ray is does not matter.
pub fn packet(case: &Case) {
    case.run(|mesh, rays| {
        let agreement = Agreement { threads: vec![1, 2], exact: 0, ..case.agreement() };
        agreement.assert(mesh, rays);
        agreement.assert(mesh, &companions(rays, 1, 8));
        let reversed: Vec<Ray> = rays.iter().rev().copied().collect();
        let answers = brute::answers(mesh, &reversed);
        assert!(answers.iter().rev().eq(&brute::answers(mesh, rays)), "{rays:?}");
    });
}
