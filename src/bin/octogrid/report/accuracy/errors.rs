//! How far answers are from the truth.

use octogrid::Hit;
use serde::Serialize;

use super::truth::Truth;

/// The errors of many answers.
#[derive(Clone, Debug, Default)]
pub(super) struct Errors {
    rays: usize,
    wrong_hits: usize,
    wrong_ids: usize,
    /// Of t, u and v in ulps, where the triangle is the right one.
    ulps: [Vec<u32>; 3],
}

impl Errors {
    /// Adds those of answers.
    pub(super) fn add(&mut self, truths: &[Truth], hits: &[Hit]) {
        self.rays += hits.len();
        for (truth, hit) in truths.iter().zip(hits) {
            match truth {
                Some((prim, exact)) if hit.prim == *prim => {
                    let pairs = [(hit.t, exact.t), (hit.u, exact.u as f32), (hit.v, exact.v as f32)];
                    self.ulps.iter_mut().zip(pairs).for_each(|(all, (a, b))| all.push(ulps(a, b)));
                }
                Some(_) if hit.is_hit() => self.wrong_ids += 1,
                None if !hit.is_hit() => {}
                _ => self.wrong_hits += 1,
            }
        }
    }

    /// Adds those of another.
    pub(super) fn merge(&mut self, other: &Self) {
        self.rays += other.rays;
        self.wrong_hits += other.wrong_hits;
        self.wrong_ids += other.wrong_ids;
        self.ulps.iter_mut().zip(&other.ulps).for_each(|(all, more)| all.extend(more));
    }

    pub(super) fn summary(&self) -> Summary {
        let wrong = (self.wrong_hits + self.wrong_ids) as f64 / self.rays.max(1) as f64;
        let [t, u, v] = self.ulps.each_ref().map(|ulps| Ulps::of(ulps));
        let Self { rays, wrong_hits, wrong_ids, .. } = *self;
        Summary { rays, wrong_hits, wrong_ids, wrong, t, u, v }
    }
}

/// The errors of a kernel on a set of rays.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct Summary {
    pub(super) rays: usize,
    /// Hits where there is none, and misses where there is one.
    pub(super) wrong_hits: usize,
    /// Hits on another triangle than the first one.
    pub(super) wrong_ids: usize,
    /// The share of both in all rays.
    pub(super) wrong: f64,
    pub(super) t: Ulps,
    pub(super) u: Ulps,
    pub(super) v: Ulps,
}

/// Units in the last place between answers and the exact values rounded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub(super) struct Ulps {
    pub(super) median: u32,
    /// That 99.9% don't exceed.
    pub(super) high: u32,
    pub(super) max: u32,
}

impl Ulps {
    fn of(ulps: &[u32]) -> Self {
        let mut sorted = ulps.to_vec();
        sorted.sort_unstable();
        let part = |share: f64| {
            let rank = (share * sorted.len() as f64).ceil() as usize;
            sorted.get(rank.saturating_sub(1)).copied().unwrap_or(0)
        };
        Self { median: part(0.5), high: part(0.999), max: part(1.0) }
    }
}

/// The number of steps from one f32 to the next that lead from a to b; both zeros are one.
fn ulps(a: f32, b: f32) -> u32 {
    let ordered = |x: f32| {
        let magnitude = i64::from(x.to_bits() & 0x7fff_ffff);
        if x.is_sign_negative() { -magnitude } else { magnitude }
    };
    u32::try_from(ordered(a).abs_diff(ordered(b))).unwrap_or(u32::MAX)
}

#[cfg(test)]
mod tests {
    use octogrid::oracle::exact::ExactHit;

    use super::*;

    #[test]
    fn ulps_are_steps() {
        assert_eq!(ulps(1.0, 1.0), 0);
        assert_eq!(ulps(0.0, -0.0), 0);
        assert_eq!(ulps(1.0, 1.0f32.next_up()), 1);
        assert_eq!(ulps(2.0f32.next_down(), 2.0f32.next_up()), 2);
        assert_eq!(ulps(f32::from_bits(3), -f32::from_bits(2)), 5);
        assert_eq!(ulps(f32::INFINITY, f32::NEG_INFINITY), 2 * 0x7f80_0000);
    }

    #[test]
    fn ranks_are_those_of_the_sorted_values() {
        let ulps: Vec<u32> = (1..=2000).rev().collect();
        assert_eq!(Ulps::of(&ulps), Ulps { median: 1000, high: 1998, max: 2000 });
        assert_eq!(Ulps::of(&[7]), Ulps { median: 7, high: 7, max: 7 });
        assert_eq!(Ulps::of(&[]), Ulps::default());
    }

    #[test]
    fn every_kind_of_error_is_counted() {
        let truth = Some((3, ExactHit { t: 1.0, u: 0.25, v: 0.5 }));
        let right = Hit { t: 1.0f32.next_up(), u: 0.25, v: 0.5, prim: 3 };
        let other = Hit { prim: 4, ..right };
        let mut errors = Errors::default();
        errors.add(&[truth, truth, truth, None, None], &[right, other, Hit::MISS, right, Hit::MISS]);
        let summary = errors.summary();
        assert_eq!((summary.rays, summary.wrong_hits, summary.wrong_ids, summary.wrong), (5, 2, 1, 0.6));
        assert_eq!((summary.t.max, summary.u.max), (1, 0));
    }
}
