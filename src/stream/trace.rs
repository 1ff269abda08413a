//! Streams: many rays in any order, those that go alike together.

use rayon::prelude::*;

use super::gather::{Gather, OPEN};
use super::rows::{self, TILE};
use crate::arena::Form;
use crate::hit::Hit;
use crate::lanes::dispatch;
use crate::query::{Any, Closest};
use crate::ray::Ray;
use crate::scene::Scene;
use crate::traverse::{self, FEWEST, GROUP, Group, Outcome, PACKETS, Packet, PerRay};

/// Rays a task.
const CHUNK: usize = 4096;

/// Rays in rows that are copied into the order of tiles at a time.
const TILED: usize = 1024;

/// Rays after which it is judged whether gathering pays.
const BLOCK: usize = 256;

/// Blocks that are gathered after one in which it paid.
const GATHERED: usize = 15;

/// Groups that are traced ray by ray after a block in which it did not pay.
const PAUSE: usize = 60;

/// Rays of a block that are looked at before it is gathered, by fours.
const SAMPLED: usize = 32;

/// Of those, how many have to meet the scene's box: to find out that a ray does not takes less than to gather it.
const FEWEST_ENTERING: u32 = 20;

/// Groups that the first 64 rays of a block may open: more show that rays go all ways.
const MOST_OPENED: usize = 16;

impl Scene {
    /// [`Scene::closest`] of each ray, with rays that go alike traced together.
    ///
    /// Rays may come in any order: neighbours that go alike are found in it, and rays of a camera's pixels row by
    /// row, which are taken in tiles.
    ///
    /// # Panics
    /// Where the slices differ in length.
    pub fn closest_stream(&self, rays: &[Ray], hits: &mut [Hit]) {
        assert_eq!(rays.len(), hits.len(), "one hit a ray");
        parallel::<Closest>(self, rays, hits);
    }

    /// [`Scene::occluded`] of each ray, as [`Scene::closest_stream`] does it.
    ///
    /// # Panics
    /// Where the slices differ in length.
    pub fn occluded_stream(&self, rays: &[Ray], occluded: &mut [bool]) {
        assert_eq!(rays.len(), occluded.len(), "one answer a ray");
        parallel::<Any>(self, rays, occluded);
    }
}

/// How the next rays are taken.
#[derive(Clone, Copy)]
enum Mode {
    /// As they come, together.
    Runs,
    /// Gathered into groups, for so many blocks more.
    Gather(usize),
    /// Ray by ray, for so many groups more.
    Single(usize),
}

/// A chunk of a stream on its way.
struct Stream<'a, Q: PerRay> {
    scene: &'a Scene,
    rays: &'a [Ray],
    answers: &'a mut [Q::Answer],
    group: Group<'a>,
    gather: Gather,
    gathered: Gathered,
    /// Room for the rays of a gathered group, and for their answers.
    room: ([Ray; GROUP], [Q::Answer; GROUP]),
}

/// What has become of the rays gathered in a block.
#[derive(Clone, Copy, Default)]
struct Gathered {
    /// They were traced together.
    together: usize,
    /// They were not to be traced together.
    refused: usize,
}

impl Gathered {
    /// Whether that was faster than ray by ray.
    fn pays(&self) -> bool {
        8 * self.refused <= self.together
    }
}

impl<Q: PerRay> Stream<'_, Q> {
    /// Answers all rays.
    fn run(&mut self) {
        let mut mode =
            if self.scene.arena.form == Form::Bricks { Mode::Runs } else { Mode::Single(usize::MAX) };
        // Groups alone after the last one that was given up: more and more, until one is answered.
        let mut alone = 0;
        let mut at = 0;
        while at < self.rays.len() {
            let end = self.rays.len().min(at + if matches!(mode, Mode::Gather(_)) { BLOCK } else { GROUP });
            mode = match mode {
                Mode::Runs => match self.run_of_rays(at, end) {
                    Outcome::Answered => {
                        alone = 0;
                        Mode::Runs
                    }
                    Outcome::Apart => {
                        mode = Mode::Gather(0);
                        continue;
                    }
                    Outcome::GivenUp => {
                        alone = PAUSE.min(2 * alone + 1);
                        mode = Mode::Single(alone);
                        continue;
                    }
                },
                Mode::Gather(0) if !self.enter(at, end) => {
                    mode = Mode::Single(PAUSE);
                    continue;
                }
                Mode::Gather(blocks) => match self.gather(at, end) {
                    true if blocks == 0 => Mode::Gather(GATHERED),
                    true if blocks == 1 => Mode::Runs,
                    true => Mode::Gather(blocks - 1),
                    false => Mode::Single(PAUSE),
                },
                Mode::Single(groups) => {
                    self.scene.each_ray::<Q>(&self.rays[at..end], &mut self.answers[at..end]);
                    if groups > 1 { Mode::Single(groups - 1) } else { Mode::Runs }
                }
            };
            at = end;
        }
        (0..OPEN).for_each(|slot| self.close(slot));
    }

    /// Answers neighbours together.
    fn run_of_rays(&mut self, at: usize, end: usize) -> Outcome {
        let Scene { isa, arena, .. } = self.scene;
        let (rays, answers) = (&self.rays[at..end], &mut self.answers[at..end]);
        if rays.len() < FEWEST {
            return Outcome::Apart;
        }
        traverse::group::<Q>(*isa, arena, &mut self.group, rays, answers)
    }

    /// Whether enough of the rays meet the scene's box.
    fn enter(&self, at: usize, end: usize) -> bool {
        let Scene { isa, arena, .. } = self.scene;
        let sampled = |i: usize| self.rays[at + i * (end - at) / SAMPLED];
        let entering = |i: usize| traverse::entering(*isa, arena, &[0, 1, 2, 3].map(|k| sampled(i + k)));
        (0..SAMPLED).step_by(4).map(entering).sum::<u32>() >= FEWEST_ENTERING
    }

    /// Adds rays to the groups that are open; whether that paid.
    fn gather(&mut self, at: usize, end: usize) -> bool {
        dispatch!(self.scene.isa, lanes => {
            let mut opened = 0;
            self.gathered = Gathered::default();
            for i in at..end {
                if i == at + GROUP && opened > MOST_OPENED {
                    self.scene.each_ray::<Q>(&self.rays[i..end], &mut self.answers[i..end]);
                    return false;
                }
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
            opened * FEWEST <= end - at && self.gathered.pays()
        })
    }

    /// Answers the rays of an open group, which stays open without them.
    #[inline(never)]
    fn close(&mut self, slot: usize) {
        let len = std::mem::take(&mut self.gather.len[slot]);
        let members = &self.gather.rays[slot][..len];
        let (rays, answers) = (&mut self.room.0[..len], &mut self.room.1[..len]);
        (0..len).for_each(|i| rays[i] = self.rays[members[i] as usize]);
        let Scene { isa, arena, .. } = self.scene;
        let mut together = || traverse::group::<Q>(*isa, arena, &mut self.group, rays, answers);
        if len >= FEWEST && together() == Outcome::Answered {
            self.gathered.together += len;
        } else {
            self.gathered.refused += if len >= FEWEST { len } else { 0 };
            self.scene.each_ray::<Q>(rays, answers);
        }
        (0..len).for_each(|i| self.answers[members[i] as usize] = answers[i]);
    }
}

/// Answers the rays, task by task.
fn parallel<Q: PerRay>(scene: &Scene, rays: &[Ray], answers: &mut [Q::Answer]) {
    let rows = if scene.arena.form == Form::Bricks { rows::width(rays) } else { None };
    let task = rows.map_or(CHUNK, |width| {
        let band = TILE * width;
        band * (CHUNK / band).max(1)
    });
    rays.par_chunks(task).zip(answers.par_chunks_mut(task)).for_each(|(rays, answers)| match rows {
        Some(width) => in_tiles::<Q>(scene, width, rays, answers),
        None => stream::<Q>(scene, rays, answers),
    });
}

/// Answers rays in rows of that width, in the order of tiles.
fn in_tiles<Q: PerRay>(scene: &Scene, width: usize, rays: &[Ray], answers: &mut [Q::Answer]) {
    let mut order = [0; TILED];
    let (mut tiled, mut found) = ([rays[0]; TILED], [Q::up_to(0.0).answer(); TILED]);
    let mut flush = |members: &[u32]| {
        let (tiled, found) = (&mut tiled[..members.len()], &mut found[..members.len()]);
        tiled.iter_mut().zip(members).for_each(|(ray, &i)| *ray = rays[i as usize]);
        stream::<Q>(scene, tiled, found);
        found.iter().zip(members).for_each(|(answer, &i)| answers[i as usize] = *answer);
    };
    let mut len = 0;
    rows::tiles(rays.len(), width, |tile| {
        if len + tile.len() > TILED {
            flush(&order[..len]);
            len = 0;
        }
        order[len..len + tile.len()].copy_from_slice(tile);
        len += tile.len();
    });
    flush(&order[..len]);
}

fn stream<Q: PerRay>(scene: &Scene, rays: &[Ray], answers: &mut [Q::Answer]) {
    let grid = &scene.arena.grid;
    let gather = Gather::new(grid.cell * f64::from(grid.longest()));
    let mut packets = [Packet::ZERO; PACKETS];
    let (group, gathered) = (Group::new(&mut packets), Gathered::default());
    let room = ([rays[0]; GROUP], [Q::up_to(0.0).answer(); GROUP]);
    Stream::<Q> { scene, rays, answers, group, gather, gathered, room }.run();
}
