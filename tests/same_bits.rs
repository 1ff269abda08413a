//! One number for all hits, the same on every machine.
#![cfg(all(feature = "oracle", feature = "parallel"))]

#[allow(dead_code)]
mod common;

use std::hash::Hasher;

use octogrid::oracle::meshes::Mesh;
use octogrid::oracle::rays::RaySet;
use octogrid::{BuildOptions, Hit, Isa, Ray, Scene, Structure, TriMesh};
use rayon::ThreadPoolBuilder;

/// The hash of the hits of [`SETS`] on the built-in scenes of up to 6,000 triangles. Scenes and rays come
/// from additions, multiplications, divisions and square roots alone, which are rounded alike everywhere.
const EXPECTED: u64 = 0x4301_1991_a240_8675;

const SETS: [RaySet; 3] = [RaySet::Random, RaySet::Camera, RaySet::Inside];

/// FNV-1a: G. Fowler, L. C. Noll, K.-P. Vo, 1991.
struct Fnv(u64);

impl Hasher for Fnv {
    fn write(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
        }
    }
    fn finish(&self) -> u64 {
        self.0
    }
}

/// Of the answers to all three queries, as little-endian bytes.
fn hash(scenes: &[(Scene, Vec<Ray>)]) -> u64 {
    let mut hash = Fnv(0xcbf2_9ce4_8422_2325);
    let mut add = |hits: &[Hit]| {
        for hit in hits {
            for word in [hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.prim] {
                hash.write(&word.to_le_bytes());
            }
        }
    };
    let mut found = Vec::new();
    for (scene, rays) in scenes {
        let mut closest = vec![Hit::MISS; rays.len()];
        let mut occluded = vec![false; rays.len()];
        scene.closest_batch(rays, &mut closest);
        scene.occluded_batch(rays, &mut occluded);
        add(&closest);
        add(&scene.all_batch(rays).hits);
        found.extend(occluded.into_iter().map(u8::from));
    }
    hash.write(&found);
    hash.finish()
}

#[test]
fn every_structure_instruction_set_and_number_of_threads() {
    let meshes: Vec<_> =
        common::builtin_scenes().map(|(_, mesh)| mesh).filter(|mesh| mesh.1.len() <= 6_000).collect();
    let pools = [1, 2].map(|n| (n, ThreadPoolBuilder::new().num_threads(n).build().unwrap()));
    let mut ran = String::new();
    for structure in Structure::ALL {
        for isa in Isa::available() {
            let scenes: Vec<_> = meshes.iter().map(|mesh| scene(mesh, structure, isa)).collect();
            for (threads, pool) in &pools {
                let found = pool.install(|| hash(&scenes));
                assert_eq!(found, EXPECTED, "{found:#018x}: {structure}, {isa}, {threads} threads");
                ran += &format!(" {structure}/{isa}/{threads}");
            }
        }
    }
    common::announce(&format!("{EXPECTED:#018x} from{ran}"));
}

fn scene((vertices, triangles): &Mesh, structure: Structure, isa: Isa) -> (Scene, Vec<Ray>) {
    let mesh = TriMesh::new(vertices, triangles).unwrap();
    let rays = SETS.iter().flat_map(|set| set.rays(&mesh, 1, 300)).collect();
    (
        Scene::build(&mesh, &BuildOptions { structure: Some(structure), isa, ..Default::default() }).unwrap(),
        rays,
    )
}
