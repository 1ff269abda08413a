//! Many rays at once, on the threads of the current rayon pool.
//!
//! Answers come in the order of the rays and are the same for any number of threads.

mod gather;
mod rows;
mod trace;

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use crate::hit::Hit;
use crate::query::{Any, Closest};
use crate::ray::Ray;
use crate::scene::Scene;

/// Rays a task: enough to make up for its cost, few enough to spread uneven work.
const CHUNK: usize = 1024;

/// The hits of many rays in one flat list.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HitLists {
    /// The hits of ray i are `hits[offsets[i]..offsets[i + 1]]`; one more than there are rays.
    pub offsets: Vec<usize>,
    /// All hits, ray after ray.
    pub hits: Vec<Hit>,
}

impl HitLists {
    /// The hits of one ray.
    ///
    /// # Panics
    /// Where `ray` is not below the number of rays.
    pub fn of(&self, ray: usize) -> &[Hit] {
        &self.hits[self.offsets[ray]..self.offsets[ray + 1]]
    }
}

/// There are more hits than [`Scene::all_stream`] was to hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooManyHits {
    /// How many hits there may be.
    pub limit: usize,
}

impl std::fmt::Display for TooManyHits {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "the rays have more than {} hits", self.limit)
    }
}

impl std::error::Error for TooManyHits {}

impl Scene {
    /// [`Scene::closest`] of each ray.
    ///
    /// # Panics
    /// Where the slices differ in length.
    pub fn closest_batch(&self, rays: &[Ray], hits: &mut [Hit]) {
        assert_eq!(rays.len(), hits.len(), "one hit a ray");
        rays.par_chunks(CHUNK)
            .zip(hits.par_chunks_mut(CHUNK))
            .for_each(|(rays, hits)| self.each_ray::<Closest>(rays, hits));
    }

    /// [`Scene::occluded`] of each ray.
    ///
    /// # Panics
    /// Where the slices differ in length.
    pub fn occluded_batch(&self, rays: &[Ray], occluded: &mut [bool]) {
        assert_eq!(rays.len(), occluded.len(), "one answer a ray");
        rays.par_chunks(CHUNK)
            .zip(occluded.par_chunks_mut(CHUNK))
            .for_each(|(rays, occluded)| self.each_ray::<Any>(rays, occluded));
    }

    /// [`Scene::all`] of each ray, complete.
    pub fn all_batch(&self, rays: &[Ray]) -> HitLists {
        let mut lists = HitLists::default();
        self.all_stream(rays, usize::MAX, &mut lists).expect("no list is longer");
        lists
    }

    /// [`Scene::all`] of each ray, complete, in place of what is in `lists`, whose memory is used again.
    ///
    /// # Errors
    /// Where there are more than `limit` hits in all; `lists` is empty then, and no more than twice as many
    /// have been held.
    pub fn all_stream(&self, rays: &[Ray], limit: usize, lists: &mut HitLists) -> Result<(), TooManyHits> {
        lists.offsets.clear();
        lists.hits.clear();
        let found = AtomicUsize::new(0);
        let chunk = |rays: &[Ray]| {
            let chunk = self.all_of_chunk(rays, limit);
            let before = found.fetch_add(chunk.1.len(), Ordering::Relaxed);
            if before.saturating_add(chunk.1.len()) <= limit { Ok(chunk) } else { Err(TooManyHits { limit }) }
        };
        let chunks: Vec<(Vec<usize>, Vec<Hit>)> =
            rays.par_chunks(CHUNK).map(chunk).collect::<Result<_, _>>()?;
        lists.offsets.push(0);
        for (ends, hits) in chunks {
            let start = lists.hits.len();
            lists.offsets.extend(ends.into_iter().map(|end| start + end));
            lists.hits.extend(hits);
        }
        Ok(())
    }

    /// Where the hits of each ray end, and all hits; or those up to the first ray with which they are more
    /// than `limit`.
    fn all_of_chunk(&self, rays: &[Ray], limit: usize) -> (Vec<usize>, Vec<Hit>) {
        let mut buffer = vec![Hit::MISS; 64];
        let (mut ends, mut hits) = (Vec::with_capacity(rays.len()), Vec::new());
        for ray in rays {
            let mut found = self.all(ray, &mut buffer);
            while !found.complete {
                buffer.resize(2 * buffer.len(), Hit::MISS);
                found = self.all(ray, &mut buffer);
            }
            hits.extend_from_slice(&buffer[..found.len]);
            ends.push(hits.len());
            if hits.len() > limit {
                break;
            }
        }
        (ends, hits)
    }
}
