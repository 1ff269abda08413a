//! Streams: many rays in any order, those that go alike together.

use rayon::prelude::*;

use super::gather::Gather;
use crate::arena::Form;
use crate::hit::Hit;
use crate::lanes::{WIDTH, dispatch};
use crate::ray::Ray;
use crate::scene::Scene;
use crate::traverse::{self, FEWEST, GROUP, Group};

/// Rays a task.
const CHUNK: usize = 4096;

/// Rays after which it is judged whether gathering pays.
const BLOCK: usize = 256;

/// Blocks that are traced ray by ray after one in which it did not pay.
const PAUSE: usize = 7;

impl Scene {
    /// [`Scene::closest`] of each ray, with rays that go alike traced together.
    ///
    /// Rays may come in any order, and neighbours that go alike are found in it.
    ///
    /// # Panics
    /// Where the slices differ in length.
    pub fn closest_stream(&self, rays: &[Ray], hits: &mut [Hit]) {
        assert_eq!(rays.len(), hits.len(), "one hit a ray");
        rays.par_chunks(CHUNK)
            .zip(hits.par_chunks_mut(CHUNK))
            .for_each(|(rays, hits)| stream(self, rays, Closest(hits)));
    }

    /// [`Scene::occluded`] of each ray, as [`Scene::closest_stream`] does it.
    ///
    /// # Panics
    /// Where the slices differ in length.
    pub fn occluded_stream(&self, rays: &[Ray], occluded: &mut [bool]) {
        assert_eq!(rays.len(), occluded.len(), "one answer a ray");
        rays.par_chunks(CHUNK)
            .zip(occluded.par_chunks_mut(CHUNK))
            .for_each(|(rays, occluded)| stream(self, rays, Occluded(occluded)));
    }
}

/// Where the answers of a chunk go.
trait Answers {
    /// Whether any hit will do.
    const ANY: bool;
    fn single(&mut self, scene: &Scene, ray: &Ray, at: usize);
    fn grouped(&mut self, hit: Hit, at: usize);
}

struct Closest<'a>(&'a mut [Hit]);
struct Occluded<'a>(&'a mut [bool]);

impl Answers for Closest<'_> {
    const ANY: bool = false;
    #[inline(always)]
    fn single(&mut self, scene: &Scene, ray: &Ray, at: usize) {
        self.0[at] = scene.closest(ray);
    }
    #[inline(always)]
    fn grouped(&mut self, hit: Hit, at: usize) {
        self.0[at] = hit;
    }
}

impl Answers for Occluded<'_> {
    const ANY: bool = true;
    #[inline(always)]
    fn single(&mut self, scene: &Scene, ray: &Ray, at: usize) {
        self.0[at] = scene.occluded(ray);
    }
    #[inline(always)]
    fn grouped(&mut self, hit: Hit, at: usize) {
        self.0[at] = hit.is_hit();
    }
}

/// How the next rays are taken.
#[derive(Clone, Copy)]
enum Mode {
    /// As they come, together.
    Runs,
    /// Gathered into groups, for so many blocks more.
    Gather(usize),
    /// Ray by ray, for so many blocks more.
    Single(usize),
}

/// A chunk of a stream on its way.
struct Stream<'a, A> {
    scene: &'a Scene,
    rays: &'a [Ray],
    answers: A,
    group: Group,
    gather: Gather,
    /// Rays gathered in this block that were not to be traced together.
    refused: usize,
}

impl<A: Answers> Stream<'_, A> {
    /// Answers all rays.
    fn run(&mut self) {
        let mut mode =
            if self.scene.arena.form == Form::Bricks { Mode::Runs } else { Mode::Single(usize::MAX) };
        let mut at = 0;
        while at < self.rays.len() {
            let end = self.rays.len().min(at + if matches!(mode, Mode::Runs) { GROUP } else { BLOCK });
            mode = match mode {
                Mode::Runs if self.run_of_rays(at, end) => Mode::Runs,
                Mode::Runs => {
                    mode = Mode::Gather(0);
                    continue;
                }
                Mode::Gather(blocks) => match self.gather(at, end) {
                    true if blocks == 0 => Mode::Gather(PAUSE),
                    true if blocks == 1 => Mode::Runs,
                    true => Mode::Gather(blocks - 1),
                    false => Mode::Single(PAUSE),
                },
                Mode::Single(blocks) => {
                    (at..end).for_each(|i| self.answers.single(self.scene, &self.rays[i], i));
                    if blocks == 0 { Mode::Runs } else { Mode::Single(blocks - 1) }
                }
            };
            at = end;
        }
        (0..WIDTH).for_each(|slot| self.close(slot));
    }

    /// Traces neighbours together; false where they don't go alike, and nothing is answered.
    fn run_of_rays(&mut self, at: usize, end: usize) -> bool {
        let rays = &self.rays[at..end];
        let together =
            rays.len() >= FEWEST && trace::<A>(self.scene, &mut self.group, rays.len(), |i| rays[i]);
        if together {
            (at..end).for_each(|i| self.answers.grouped(self.group.hit(i - at), i));
        }
        together
    }

    /// Adds rays to the groups that are open; whether that paid.
    fn gather(&mut self, at: usize, end: usize) -> bool {
        dispatch!(self.scene.isa, lanes => {
            let mut opened = 0;
            self.refused = 0;
            for i in at..end {
                let ray = &self.rays[i];
                let slot = match self.gather.find(lanes, ray) {
                    Some(slot) => slot,
                    None => {
                        let slot = self.gather.oldest();
                        self.close(slot);
                        self.gather.open(slot, ray);
                        opened += 1;
                        slot
                    }
                };
                if self.gather.add(slot, i as u32) {
                    self.close(slot);
                }
            }
            opened * FEWEST <= end - at && 2 * self.refused <= end - at
        })
    }

    /// Answers the rays of an open group, which stays open without them.
    #[inline(never)]
    fn close(&mut self, slot: usize) {
        let len = std::mem::take(&mut self.gather.len[slot]);
        let members = &self.gather.rays[slot][..len];
        let ray = |i: usize| self.rays[members[i] as usize];
        let together = len >= FEWEST && trace::<A>(self.scene, &mut self.group, len, ray);
        if len >= FEWEST && !together {
            self.refused += len;
        }
        for (i, &at) in members.iter().enumerate() {
            let at = at as usize;
            if together {
                self.answers.grouped(self.group.hit(i), at);
            } else {
                self.answers.single(self.scene, &self.rays[at], at);
            }
        }
    }
}

/// Traces rays together; false where they don't go alike, and nothing is answered.
fn trace<A: Answers>(scene: &Scene, group: &mut Group, len: usize, ray: impl Fn(usize) -> Ray) -> bool {
    group.load(len, ray);
    let (isa, arena) = (scene.isa, &scene.arena);
    if A::ANY {
        traverse::group::<true>(isa, arena, group)
    } else {
        traverse::group::<false>(isa, arena, group)
    }
}

fn stream<A: Answers>(scene: &Scene, rays: &[Ray], answers: A) {
    let grid = &scene.arena.grid;
    let gather = Gather::new(grid.cell * f64::from(grid.longest()));
    Stream { scene, rays, answers, group: Group::new(), gather, refused: 0 }.run();
}
