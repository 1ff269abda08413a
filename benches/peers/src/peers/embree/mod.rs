//! Embree 4 through its C interface.

mod ffi;
mod layout;

use octogrid::{Ray, TriMesh};

use crate::memory::Bytes;
use crate::peer::{Answer, Build, Peer, Question, Tracer};
use ffi::{Arguments, Device, Scene};
use layout::{NONE, Packet, RayHit};

pub(crate) use ffi::library_is_there;

/// Its levels of build quality, by their values.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Quality {
    Low = 0,
    Medium = 1,
    High = 2,
}

/// How rays are handed over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Calls {
    Single,
    Packets8,
    Packets16,
}

/// A configuration.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Embree {
    pub(crate) quality: Quality,
    /// Whether rays near edges are tested with more care.
    pub(crate) robust: bool,
    pub(crate) calls: Calls,
}

impl Tracer for Embree {
    fn prepare<'a>(&self, mesh: TriMesh<'a>, threads: usize) -> Build<'a> {
        let Self { quality, robust, calls } = *self;
        let device = Device::new(threads, mesh);
        Box::new(move || Box::new(Built { scene: device.build(quality as u32, robust), calls }))
    }
}

struct Built {
    scene: Scene,
    calls: Calls,
}

impl Peer for Built {
    fn closest(&self, rays: &[Ray], coherent: bool, answers: &mut [Answer]) {
        let arguments = &Arguments::of(coherent);
        match self.calls {
            Calls::Packets8 => closest::<8>(rays, answers, |packet| self.scene.intersect8(packet, arguments)),
            Calls::Packets16 => {
                closest::<16>(rays, answers, |packet| self.scene.intersect16(packet, arguments))
            }
            Calls::Single => {
                let mut hit = RayHit::default();
                for (ray, answer) in rays.iter().zip(answers) {
                    hit.set(ray);
                    self.scene.intersect(&mut hit, arguments);
                    *answer = hit.answer();
                }
            }
        }
    }

    fn occluded(&self, rays: &[Ray], coherent: bool, blocked: &mut [bool]) {
        let arguments = &Arguments::of(coherent);
        match self.calls {
            Calls::Packets8 => occluded::<8>(rays, blocked, |packet| self.scene.occluded8(packet, arguments)),
            Calls::Packets16 => {
                occluded::<16>(rays, blocked, |packet| self.scene.occluded16(packet, arguments))
            }
            Calls::Single => {
                let mut hit = RayHit::default();
                for (ray, blocked) in rays.iter().zip(blocked) {
                    hit.set(ray);
                    self.scene.occluded(&mut hit.ray, arguments);
                    *blocked = hit.ray.t_far < 0.0;
                }
            }
        }
    }

    /// By a filter that counts each hit and then rejects it.
    fn count(&self, rays: &[Ray], counts: &mut [u32]) {
        let mut hit = RayHit::default();
        for (ray, count) in rays.iter().zip(counts) {
            hit.set(ray);
            *count = self.scene.count(&mut hit);
        }
    }

    fn answers(&self, question: Question) -> bool {
        self.calls == Calls::Single || question != Question::All
    }

    fn bytes(&self) -> Option<Bytes> {
        Some(self.scene.bytes())
    }
}

#[inline(always)]
fn closest<const N: usize>(rays: &[Ray], answers: &mut [Answer], trace: impl Fn(&mut Packet<N>)) {
    let mut packet = Packet::default();
    for (rays, answers) in rays.chunks(N).zip(answers.chunks_mut(N)) {
        packet.set(rays);
        trace(&mut packet);
        for (lane, answer) in answers.iter_mut().enumerate() {
            let hit = packet.geometry[lane] != NONE;
            *answer =
                if hit { Answer { t: packet.t_far[lane], prim: packet.prim[lane] } } else { Answer::MISS };
        }
    }
}

#[inline(always)]
fn occluded<const N: usize>(rays: &[Ray], blocked: &mut [bool], trace: impl Fn(&mut Packet<N>)) {
    let mut packet = Packet::default();
    for (rays, blocked) in rays.chunks(N).zip(blocked.chunks_mut(N)) {
        packet.set(rays);
        trace(&mut packet);
        blocked.iter_mut().zip(packet.t_far).for_each(|(blocked, t)| *blocked = t < 0.0);
    }
}
