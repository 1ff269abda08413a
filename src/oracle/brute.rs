//! Brute force with the library's own kernel: the same bits as every structure must give.
//!
//! Eight rays against one triangle at a time, the other direction of the kernel than in a structure.

use super::scan::Answer;
use crate::filter::{RayLanes, candidates};
use crate::hit::Hit;
use crate::lanes::{Isa, Lanes, dispatch};
use crate::mesh::TriMesh;
use crate::parallel;
use crate::query::EdgeRule;
use crate::ray::{Ray, RayPacket};
use crate::triangle::intersect;

/// The answers to all three queries for each ray.
pub fn answers(mesh: &TriMesh<'_>, rays: &[Ray]) -> Vec<Answer> {
    let isa = Isa::detect();
    let packets: Vec<&[Ray]> = rays.chunks(RayPacket::LEN).collect();
    parallel::map(&packets, |rays| dispatch!(isa, lanes => packet(lanes, mesh, rays))).concat()
}

#[inline(always)]
fn packet<L: Lanes>(lanes: L, mesh: &TriMesh<'_>, rays: &[Ray]) -> Vec<Answer> {
    let ray_lanes = RayLanes::gather(lanes, &RayPacket::new(rays));
    let valid: u32 = (0..).zip(rays).map(|(lane, ray)| u32::from(ray.is_valid()) << lane).sum();
    let mut closed = vec![Vec::new(); rays.len()];
    let mut crossings = closed.clone();
    for prim in 0..mesh.len() as u32 {
        let corners = mesh.corners(prim);
        let splat = corners.map(|corner| corner.to_array().map(|x| lanes.splat(x)));
        let mut bits = valid & candidates(lanes, &ray_lanes, splat);
        while bits != 0 {
            let lane = bits.trailing_zeros() as usize;
            bits &= bits - 1;
            let ray = &rays[lane];
            for (rule, hits) in [(EdgeRule::Closed, &mut closed), (EdgeRule::Crossing, &mut crossings)] {
                let at = intersect(ray, corners, rule).filter(|at| ray.t_min < at.t && at.t <= ray.t_max);
                hits[lane].extend(at.map(|at| Hit { t: at.t, u: at.u, v: at.v, prim }));
            }
        }
    }
    closed.into_iter().zip(crossings).map(|(closed, all)| Answer::of(closed, all)).collect()
}
