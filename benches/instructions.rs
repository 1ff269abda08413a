//! Instruction counts under valgrind: `cargo bench --bench instructions`.
//!
//! Needs valgrind and gungraun-runner; `cargo bench --bench gate` compares the counts with those that
//! are committed. Every case checks its answers in its set-up, which is not counted, and gives back what it was
//! given, as what it takes to free that depends on the heap.

mod cases;

use std::hint::black_box;
use std::ops::ControlFlow;

use cases::{Case, Query, run};
use glam::Vec3;
use gungraun::{library_benchmark, library_benchmark_group, main};
use octogrid::descent::{General, Halves, Walk, first_exit};
use octogrid::{
    BuildOptions, Cluster, EdgeRule, Forced, Hit, Isa, Ray, RayPacket, Scene, Structure, intersect,
};
use rayon::{ThreadPool, ThreadPoolBuilder};

/// When a ray enters a divided voxel: exits, widths, time, rising axes.
type Entry = ([f64; 3], [f64; 3], f64, u32);

/// Entry points of all octants, a quarter of them of rays parallel to an axis, none on a middle plane.
fn entries() -> Vec<Entry> {
    let mut rng = octogrid::Rng::new(1);
    (0..64)
        .map(|i| {
            let mut width = [0; 3].map(|_| rng.range(1.0, 4.0));
            if i % 4 == 3 {
                width[i / 4 % 3] = (1u64 << 60) as f64;
            }
            let exit = width.map(|w| 1.0 + w * rng.range(0.0, 1.0));
            (exit, width, 1.0, i as u32 % 8)
        })
        .collect()
}

fn down_general<const N: u32>(entries: &[Entry], levels: u32) -> u32 {
    let mut sum = 0;
    for &(exit, width, time, rises) in entries {
        let mut part = General::<N>::whole(exit, width);
        for _ in 0..levels {
            part = part.descend(time, rises);
            sum += part.voxel;
        }
    }
    sum
}

fn down_halves(entries: &[Entry], levels: u32) -> u32 {
    let mut sum = 0;
    for &(exit, width, time, rises) in entries {
        let mut part = Halves::whole(exit, width);
        for _ in 0..levels {
            part = part.descend(time, rises);
            sum += part.voxel;
        }
    }
    sum
}

/// The entries, after a check that both codes for N = 2 agree on them.
fn checked_entries(levels: u32) -> (Vec<Entry>, u32) {
    let entries = entries();
    assert_eq!(down_general::<2>(&entries, levels), down_halves(&entries, levels));
    (entries, levels)
}

#[library_benchmark(setup = checked_entries)]
#[bench::one_level(1)]
#[bench::to_the_leaf(8)]
fn descend_general_2((entries, levels): (Vec<Entry>, u32)) -> (u32, Vec<Entry>) {
    (black_box(down_general::<2>(black_box(&entries), black_box(levels))), entries)
}

// Two levels of N = 2 at once.
#[library_benchmark(setup = checked_entries)]
#[bench::one_level(1)]
#[bench::to_the_leaf(4)]
fn descend_general_4((entries, levels): (Vec<Entry>, u32)) -> (u32, Vec<Entry>) {
    (black_box(down_general::<4>(black_box(&entries), black_box(levels))), entries)
}

#[library_benchmark(setup = checked_entries)]
#[bench::one_level(1)]
#[bench::to_the_leaf(8)]
fn descend_halves((entries, levels): (Vec<Entry>, u32)) -> (u32, Vec<Entry>) {
    (black_box(down_halves(black_box(&entries), black_box(levels))), entries)
}

/// Where a step leads.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Step {
    Sibling,
    /// Out of the divided voxel, into one that is not divided.
    Out,
    /// Out of the divided voxel, into one that is divided otherwise: coefficients anew.
    OtherwiseDivided,
}

/// Parts of divided voxels with the axes along which a ray rises, by both codes.
type Parts = (Vec<(General<2>, u32)>, Vec<(Halves, u32)>);

/// Parts from which the next step leads there.
fn parts(step: Step) -> (Parts, Step) {
    let mut all = (Vec::new(), Vec::new());
    for (exit, width, time, rises) in entries() {
        let mut general = General::<2>::whole(exit, width).descend(time, rises);
        let mut halves = Halves::whole(exit, width).descend(time, rises);
        for _ in 0..6 {
            let (before, axis) = ((general, halves), first_exit(&general.exit));
            let inside = general.step(axis, rises);
            assert_eq!(
                (inside, general.voxel, general.exit),
                (halves.step(axis, rises), halves.voxel, *halves.exit())
            );
            if inside == (step == Step::Sibling) {
                all.0.push((before.0, rises));
                all.1.push((before.1, rises));
                break;
            }
        }
    }
    all.0.truncate(32);
    all.1.truncate(32);
    assert_eq!(all.0.len(), 32);
    (all, step)
}

#[library_benchmark(setup = parts)]
#[bench::sibling(Step::Sibling)]
#[bench::out(Step::Out)]
#[bench::otherwise_divided(Step::OtherwiseDivided)]
fn step_general_2((parts, step): (Parts, Step)) -> (u32, Parts) {
    let mut sum = 0;
    for (part, rises) in black_box(&parts.0) {
        let mut part = *part;
        let axis = first_exit(&part.exit);
        let time = part.exit[axis];
        part.step(axis, *rises);
        let part = if step == Step::OtherwiseDivided { part.descend(time, *rises) } else { part };
        sum += part.voxel;
    }
    (black_box(sum), parts)
}

#[library_benchmark(setup = parts)]
#[bench::sibling(Step::Sibling)]
#[bench::out(Step::Out)]
#[bench::otherwise_divided(Step::OtherwiseDivided)]
fn step_halves((parts, step): (Parts, Step)) -> (u32, Parts) {
    let mut sum = 0;
    for (part, rises) in black_box(&parts.1) {
        let mut part = *part;
        let axis = first_exit(part.exit());
        let time = part.exit()[axis];
        part.step(axis, *rises);
        let part = if step == Step::OtherwiseDivided { part.descend(time, *rises) } else { part };
        sum += part.voxel;
    }
    (black_box(sum), parts)
}

/// `room` with few rays: valgrind is slow.
fn room(structure: Structure, walk: Walk, query: Query) -> (Scene, Vec<Ray>, Query) {
    let case = Case::new("room", 256);
    (case.scene_with(&BuildOptions { walk, ..structure.into() }), case.rays, query)
}

#[library_benchmark(setup = room)]
#[bench::general(Structure::OCTREE, Walk::General, Query::Closest)]
#[bench::special(Structure::OCTREE, Walk::Special, Query::Closest)]
fn same_octree((scene, rays, query): (Scene, Vec<Ray>, Query)) -> (u64, Scene) {
    (black_box(run(black_box(&scene), query, black_box(&rays))), scene)
}

/// Rays that end at their hit, so that a walk over them needs no test to know where to stop.
fn ended(walk: Walk) -> (Scene, Vec<Ray>) {
    let case = Case::new("room", 256);
    let scene = case.scene_with(&BuildOptions { walk, ..Structure::OCTREE.into() });
    let rays = case.rays.iter().map(|r| r.with_interval(0.0, scene.closest(r).t)).collect();
    (scene, rays)
}

// The traversal alone: through the voxels to the hit, without a test of what is in them.
#[library_benchmark(setup = ended)]
#[bench::general(Walk::General)]
#[bench::special(Walk::Special)]
fn same_octree_without_tests((scene, rays): (Scene, Vec<Ray>)) -> (u32, Scene) {
    let mut clusters = 0;
    for ray in black_box(&rays) {
        scene.clusters_along(ray, |_| {
            clusters += 1;
            ControlFlow::Continue(())
        });
    }
    (black_box(clusters), scene)
}

#[library_benchmark(setup = room)]
#[bench::uniform_closest(Structure::UNIFORM, Walk::Special, Query::Closest)]
#[bench::uniform_any(Structure::UNIFORM, Walk::Special, Query::Any)]
#[bench::uniform_all(Structure::UNIFORM, Walk::Special, Query::All)]
#[bench::recursive_closest(Structure::RECURSIVE, Walk::Special, Query::Closest)]
#[bench::recursive_any(Structure::RECURSIVE, Walk::Special, Query::Any)]
#[bench::recursive_all(Structure::RECURSIVE, Walk::Special, Query::All)]
#[bench::octree_closest(Structure::OCTREE, Walk::Special, Query::Closest)]
#[bench::octree_any(Structure::OCTREE, Walk::Special, Query::Any)]
#[bench::octree_all(Structure::OCTREE, Walk::Special, Query::All)]
#[bench::hybrid_closest(Structure::HYBRID, Walk::Special, Query::Closest)]
#[bench::hybrid_any(Structure::HYBRID, Walk::Special, Query::Any)]
#[bench::hybrid_all(Structure::HYBRID, Walk::Special, Query::All)]
fn structures((scene, rays, query): (Scene, Vec<Ray>, Query)) -> (u64, Scene) {
    (black_box(run(black_box(&scene), query, black_box(&rays))), scene)
}

/// A scene as its plan says, or with all parts of a structure.
fn planned(name: &'static str, all: bool) -> (Scene, Vec<Ray>) {
    let case = Case::new(name, 256);
    let forced = if all { Forced::all(true) } else { Forced::default() };
    (case.scene_with(&BuildOptions { forced, ..Default::default() }), case.rays)
}

#[library_benchmark(setup = planned)]
#[bench::few_triangles("cube", false)]
#[bench::few_triangles_with_all_parts("cube", true)]
#[bench::evenly_spread("torus", false)]
#[bench::evenly_spread_with_all_parts("torus", true)]
#[bench::crowded("stadium", false)]
fn plan((scene, rays): (Scene, Vec<Ray>)) -> (u64, Scene) {
    (black_box(run(black_box(&scene), Query::Closest, black_box(&rays))), scene)
}

/// A cluster of triangles in front of a ray, one of them in its way.
fn kernel_case() -> (Isa, Cluster, RayPacket, Ray, [Vec3; 3]) {
    let corners = |i: usize| {
        let at = Vec3::new(2.0 * i as f32, 0.0, i as f32);
        [at, at + Vec3::X, at + Vec3::Y]
    };
    let cluster = Cluster::new(&std::array::from_fn::<_, 8, _>(|i| (i as u32, corners(i))));
    let rays: Vec<Ray> = (0..8).map(|i| Ray::new([6.2 + i as f32, 0.3, -5.0], [0.0, 0.1, 3.0])).collect();
    let isa = Isa::detect();
    assert_eq!(cluster.candidates(isa, &rays[0]), 1 << 3);
    assert_eq!(RayPacket::new(&rays).candidates(isa, corners(3)), 1);
    (isa, cluster, RayPacket::new(&rays), rays[0], corners(3))
}

#[library_benchmark(setup = kernel_case)]
#[bench::one_ray_eight_triangles()]
fn kernel_ray((isa, cluster, _, ray, _): (Isa, Cluster, RayPacket, Ray, [Vec3; 3])) -> u8 {
    black_box(black_box(&cluster).candidates(isa, black_box(&ray)))
}

#[library_benchmark(setup = kernel_case)]
#[bench::eight_rays_one_triangle()]
fn kernel_packet((isa, _, packet, _, corners): (Isa, Cluster, RayPacket, Ray, [Vec3; 3])) -> u8 {
    black_box(black_box(&packet).candidates(isa, black_box(corners)))
}

#[library_benchmark(setup = kernel_case)]
#[bench::rounded()]
fn kernel_decision((_, _, _, ray, corners): (Isa, Cluster, RayPacket, Ray, [Vec3; 3])) -> u32 {
    black_box(intersect(black_box(&ray), black_box(corners), EdgeRule::Closed).map_or(0, |at| at.t.to_bits()))
}

/// How sixteen rays go.
#[derive(Clone, Copy)]
enum Sixteen {
    /// Through neighbouring pixels of a room.
    Together,
    /// Every way through it.
    Apart,
    /// Together, but for the size of the small object in a large scene that they meet.
    AtASmallObject,
}

/// The rays, and their hits one by one.
fn sixteen(sixteen: Sixteen) -> (Scene, [RayPacket; 2]) {
    let room = Case::new(if let Sixteen::AtASmallObject = sixteen { "stadium" } else { "room" }, 20_000);
    let rays = match sixteen {
        Sixteen::Together => {
            let dir = |i: u16| Vec3::new(0.01 * f32::from(i % 4), 0.01 * f32::from(i / 4), 1.0);
            (0..16).map(|i| Ray { dir: dir(i), ..room.rays[0] }).collect()
        }
        Sixteen::Apart => room.rays[room.rays.len() - 16..].to_vec(),
        Sixteen::AtASmallObject => room.rays[5040..5056].to_vec(),
    };
    let scene = room.scene(Structure::HYBRID);
    let packets = [RayPacket::new(&rays), RayPacket::new(&rays[8..])];
    let hits = scene.closest_packet(&packets);
    assert!((0..16).all(|i| hits[i / 8].get(i % 8) == scene.closest(&rays[i])));
    (scene, packets)
}

#[library_benchmark(setup = sixteen)]
#[bench::together(Sixteen::Together)]
#[bench::apart(Sixteen::Apart)]
#[bench::at_a_small_object(Sixteen::AtASmallObject)]
fn sixteen_rays((scene, packets): (Scene, [RayPacket; 2])) -> (u32, Scene) {
    (black_box(black_box(&scene).closest_packet(black_box(&packets))[1].get(7).prim), scene)
}

/// How many rays are handed over.
#[derive(Clone, Copy)]
enum Call {
    Batch,
    Stream,
}

/// Rays of the camera of `room` and from what these hit, room for their hits, and a pool of this thread alone:
/// what others do would count.
fn many(call: Call) -> (Scene, Vec<Ray>, Vec<Hit>, ThreadPool, Call) {
    let room = Case::new("room", 1024);
    let (scene, mut hits) = (room.scene(Structure::HYBRID), vec![Hit::MISS; room.rays.len()]);
    let pool = ThreadPoolBuilder::new().num_threads(1).use_current_thread().build().expect("a pool");
    pool.install(|| trace(&scene, call, &room.rays, &mut hits));
    assert!(room.rays.iter().zip(&hits).all(|(ray, hit)| *hit == scene.closest(ray)));
    (scene, room.rays, hits, pool, call)
}

fn trace(scene: &Scene, call: Call, rays: &[Ray], hits: &mut [Hit]) {
    match call {
        Call::Batch => scene.closest_batch(rays, hits),
        Call::Stream => scene.closest_stream(rays, hits),
    }
}

#[library_benchmark(setup = many)]
#[bench::batch(Call::Batch)]
#[bench::stream(Call::Stream)]
fn many_rays(
    (scene, rays, mut hits, pool, call): (Scene, Vec<Ray>, Vec<Hit>, ThreadPool, Call),
) -> (Vec<Hit>, Scene, Vec<Ray>, ThreadPool) {
    pool.install(|| trace(black_box(&scene), call, black_box(&rays), &mut hits));
    (hits, scene, rays, pool)
}

library_benchmark_group!(
    name = descents,
    benchmarks = [descend_general_2, descend_general_4, descend_halves]
);
library_benchmark_group!(name = steps, benchmarks = [step_general_2, step_halves]);
library_benchmark_group!(
    name = walks,
    benchmarks = [same_octree, same_octree_without_tests, structures, plan]
);
library_benchmark_group!(name = kernels, benchmarks = [kernel_ray, kernel_packet, kernel_decision]);
library_benchmark_group!(name = packed, benchmarks = [sixteen_rays, many_rays]);

main!(library_benchmark_groups = [descents, steps, walks, kernels, packed]);
