//! octogrid, as its users call it.

use std::sync::Mutex;

use octogrid::{BuildOptions, Hit, Ray, RayPacket, Scene, TriMesh};

use crate::peer::{Answer, Build, Peer, Tracer};

/// Hits that the buffer of `all` has room for at first.
const ROOM: usize = 256;

/// How rays are handed over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Calls {
    /// One call a ray.
    Single,
    /// One call for all rays of a set.
    Batch,
    /// One call for all rays of a set, those that go alike together.
    Stream,
    /// One call for 16 rays.
    Packets16,
}

/// A configuration.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Octogrid {
    pub(crate) options: BuildOptions,
    pub(crate) calls: Calls,
}

impl Tracer for Octogrid {
    fn prepare<'a>(&self, mesh: TriMesh<'a>, _: usize) -> Build<'a> {
        let Self { options, calls } = *self;
        Box::new(move || {
            let scene = Scene::build(&mesh, &options).expect("it builds");
            Box::new(Built::new(scene, calls))
        })
    }

    fn is_exact(&self) -> bool {
        true
    }
}

/// A scene.
pub(crate) struct Built {
    scene: Scene,
    calls: Calls,
    /// Room for those of many rays, kept from call to call.
    hits: Mutex<Vec<Hit>>,
}

impl Peer for Built {
    fn closest(&self, rays: &[Ray], _: bool, answers: &mut [Answer]) {
        match self.calls {
            Calls::Single => {
                rays.iter()
                    .zip(answers)
                    .for_each(|(ray, answer)| *answer = answer_of(&self.scene.closest(ray)));
            }
            Calls::Batch | Calls::Stream => {
                let mut hits = self.hits.lock().expect("no call panics");
                hits.resize(rays.len(), Hit::MISS);
                match self.calls {
                    Calls::Stream => self.scene.closest_stream(rays, &mut hits),
                    _ => self.scene.closest_batch(rays, &mut hits),
                }
                hits.iter().zip(answers).for_each(|(hit, answer)| *answer = answer_of(hit));
            }
            Calls::Packets16 => {
                for (rays, answers) in rays.chunks(16).zip(answers.chunks_mut(16)) {
                    let hits = self.scene.closest_packet(&packets(rays));
                    for (i, answer) in answers.iter_mut().enumerate() {
                        *answer = answer_of(&hits[i / 8].get(i % 8));
                    }
                }
            }
        }
    }

    fn occluded(&self, rays: &[Ray], _: bool, blocked: &mut [bool]) {
        match self.calls {
            Calls::Single => {
                rays.iter().zip(blocked).for_each(|(ray, blocked)| *blocked = self.scene.occluded(ray));
            }
            Calls::Batch => self.scene.occluded_batch(rays, blocked),
            Calls::Stream => self.scene.occluded_stream(rays, blocked),
            Calls::Packets16 => {
                for (rays, blocked) in rays.chunks(16).zip(blocked.chunks_mut(16)) {
                    let bits = self.scene.occluded_packet(&packets(rays));
                    blocked.iter_mut().enumerate().for_each(|(i, b)| *b = bits[i / 8] >> (i % 8) & 1 != 0);
                }
            }
        }
    }

    /// Unlike the others it collects and sorts the hits: that is how it knows each only once.
    fn count(&self, rays: &[Ray], counts: &mut [u32]) {
        match self.calls {
            Calls::Single | Calls::Packets16 => {
                let mut hits = vec![Hit::MISS; ROOM];
                rays.iter().zip(counts).for_each(|(ray, count)| *count = self.count_one(ray, &mut hits));
            }
            Calls::Batch | Calls::Stream => {
                let lists = self.scene.all_batch(rays);
                let lengths = lists.offsets.windows(2).map(|pair| (pair[1] - pair[0]) as u32);
                lengths.zip(counts).for_each(|(length, count)| *count = length);
            }
        }
    }
}

impl Built {
    pub(crate) fn new(scene: Scene, calls: Calls) -> Self {
        Self { scene, calls, hits: Mutex::default() }
    }

    fn count_one(&self, ray: &Ray, hits: &mut Vec<Hit>) -> u32 {
        loop {
            let found = self.scene.all(ray, hits);
            if found.complete {
                return found.len as u32;
            }
            hits.resize(2 * hits.len(), Hit::MISS);
        }
    }
}

/// Up to 16 rays as two packets.
fn packets(rays: &[Ray]) -> [RayPacket; 2] {
    [RayPacket::new(rays), RayPacket::new(rays.get(8..).unwrap_or(&[]))]
}

#[inline(always)]
fn answer_of(hit: &Hit) -> Answer {
    Answer { t: hit.t, prim: hit.prim }
}
