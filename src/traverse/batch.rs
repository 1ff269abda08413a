//! Rays one by one, set up four at a time.

use super::hybrid::{Hybrid, Start};
use super::leaf::LeafTest;
use super::leaves_out_bricks;
use super::nearest::Nearest;
use crate::arena::{Arena, Form};
use crate::dda::Quad;
use crate::descent::Walk;
use crate::hit::Hit;
use crate::kernel::Exact;
use crate::lanes::{Isa, Lanes, WIDTH, dispatch};
use crate::query::{Any, Closest, Query};
use crate::ray::Ray;

/// A query that is made of each ray, and its answer.
pub(crate) trait PerRay: Query {
    type Answer: Copy + Send;
    fn up_to(t_max: f32) -> Self;
    fn answer(&self) -> Self::Answer;
    /// The answers of eight rays that have been traced together.
    fn answers<L: Lanes>(lanes: L, nearest: &Nearest) -> [Self::Answer; WIDTH];
}

impl PerRay for Closest {
    type Answer = Hit;
    #[inline(always)]
    fn up_to(t_max: f32) -> Self {
        Self::new(t_max)
    }
    #[inline(always)]
    fn answer(&self) -> Hit {
        self.hit()
    }
    #[inline(always)]
    fn answers<L: Lanes>(lanes: L, nearest: &Nearest) -> [Hit; WIDTH] {
        nearest.hits(lanes)
    }
}

impl PerRay for Any {
    type Answer = bool;
    #[inline(always)]
    fn up_to(t_max: f32) -> Self {
        Self::new(t_max)
    }
    #[inline(always)]
    fn answer(&self) -> bool {
        self.found()
    }
    #[inline(always)]
    fn answers<L: Lanes>(_lanes: L, nearest: &Nearest) -> [bool; WIDTH] {
        std::array::from_fn(
            #[inline(always)]
            |lane| nearest.is_hit(lane),
        )
    }
}

/// Answers the query for each ray.
#[inline(never)]
pub(crate) fn batch<Q: PerRay>(isa: Isa, arena: &Arena, walk: Walk, rays: &[Ray], answers: &mut [Q::Answer]) {
    let batch = Batch { isa, arena, walk };
    if arena.form != Form::Bricks {
        rays.iter().zip(answers).for_each(|(ray, answer)| *answer = batch.alone::<Q>(ray));
    } else if leaves_out_bricks(arena, walk) {
        dispatch!(isa, lanes => batch.run::<false, _, Q>(lanes, rays, answers));
    } else {
        dispatch!(isa, lanes => batch.run::<true, _, Q>(lanes, rays, answers));
    }
}

/// How many of four rays meet the scene's box.
#[cfg(feature = "parallel")]
#[inline(never)]
pub(crate) fn entering(isa: Isa, arena: &Arena, rays: &[Ray; 4]) -> u32 {
    dispatch!(isa, lanes => Quad::new(lanes, rays, &arena.grid).entering.count_ones())
}

struct Batch<'a> {
    isa: Isa,
    arena: &'a Arena,
    walk: Walk,
}

impl Batch<'_> {
    #[inline(always)]
    fn run<const BRICKS: bool, L: Lanes, Q: PerRay>(
        &self,
        lanes: L,
        rays: &[Ray],
        answers: &mut [Q::Answer],
    ) {
        for (rays, answers) in rays.chunks(4).zip(answers.chunks_mut(4)) {
            let quad = match rays.first_chunk() {
                Some(four) => Quad::new(lanes, four, &self.arena.grid),
                None => {
                    let mut four = [rays[0]; 4];
                    four[..rays.len()].copy_from_slice(rays);
                    Quad::new(lanes, &four, &self.arena.grid)
                }
            };
            for (i, (ray, answer)) in rays.iter().zip(answers).enumerate() {
                *answer = if quad.alone >> i & 1 != 0 {
                    self.alone::<Q>(ray)
                } else if quad.entering >> i & 1 != 0 {
                    self.walk::<BRICKS, L, Q>(lanes, &quad, i, ray)
                } else {
                    Q::up_to(ray.t_max).answer()
                };
            }
        }
    }

    /// In a function of its own, so that registers are found for the walk and not for what is around it.
    #[inline(never)]
    fn walk<const BRICKS: bool, L: Lanes, Q: PerRay>(
        &self,
        lanes: L,
        quad: &Quad,
        i: usize,
        ray: &Ray,
    ) -> Q::Answer {
        lanes.vectorize(
            #[inline(always)]
            || {
                let mut query = Q::up_to(ray.t_max);
                let mut leaves = LeafTest::<_, Exact, Q>::new(lanes, self.arena, ray, &mut query);
                let start = Start::of_quad(quad, i);
                if Hybrid::<BRICKS>::walk_from(lanes, self.arena, start, &mut leaves).is_continue() {
                    leaves.finish();
                }
                query.answer()
            },
        )
    }

    /// A ray that is set up by itself.
    #[cold]
    #[inline(never)]
    fn alone<Q: PerRay>(&self, ray: &Ray) -> Q::Answer {
        super::answer::<Q>(self.isa, self.arena, self.walk, ray)
    }
}
