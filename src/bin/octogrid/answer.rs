//! The answers to a query on many rays, and the file of them.

use std::io::{self, Write};

use octogrid::{Hit, HitLists, Ray, Scene};

use super::npy::{self, AllRow, HitRow};

/// The answers to all rays.
pub(crate) enum Answer {
    Closest(Vec<Hit>),
    Any(Vec<bool>),
    All(HitLists),
}

impl Answer {
    /// Room for the closest hit of that many rays.
    pub(crate) fn closest(rays: usize) -> Self {
        Self::Closest(vec![Hit::MISS; rays])
    }

    /// Room for whether there is a hit on that many rays.
    pub(crate) fn any(rays: usize) -> Self {
        Self::Any(vec![false; rays])
    }

    /// No hit of any ray yet.
    pub(crate) fn all() -> Self {
        Self::All(HitLists::default())
    }

    /// Asks, on the threads of the current pool.
    ///
    /// # Panics
    /// Where there is room for another number of rays.
    pub(crate) fn ask(&mut self, scene: &Scene, rays: &[Ray]) {
        match self {
            Self::Closest(hits) => scene.closest_stream(rays, hits),
            Self::Any(hits) => scene.occluded_stream(rays, hits),
            Self::All(lists) => *lists = scene.all_batch(rays),
        }
    }

    /// The number of hits.
    pub(crate) fn hits(&self) -> usize {
        match self {
            Self::Closest(hits) => hits.iter().filter(|h| h.is_hit()).count(),
            Self::Any(hits) => hits.iter().filter(|&&h| h).count(),
            Self::All(lists) => lists.hits.len(),
        }
    }

    /// Writes a NumPy file, a row a ray, or for all hits a row a hit.
    ///
    /// # Errors
    /// Where `file` does.
    pub(crate) fn write(&self, file: &mut impl Write) -> io::Result<()> {
        match self {
            Self::Closest(hits) => {
                let rows = hits.iter().map(|&Hit { t, u, v, prim }| HitRow { t, u, v, prim });
                npy::write_rows(file, hits.len(), rows)
            }
            Self::Any(hits) => npy::write_rows(file, hits.len(), hits.iter().copied()),
            Self::All(lists) => {
                let of_ray = |(ray, ends): (usize, &[usize])| (ray as u32, ends[0]..ends[1]);
                let rows = lists.offsets.windows(2).enumerate().map(of_ray).flat_map(|(ray, range)| {
                    let row = move |&Hit { t, u, v, prim }: &Hit| AllRow { ray, t, u, v, prim };
                    lists.hits[range].iter().map(row)
                });
                npy::write_rows(file, lists.hits.len(), rows)
            }
        }
    }
}
