//! Ratios of the plan to what it is compared with.

use octogrid::Quality;

use super::measure::Point;
use super::rays::KINDS;
use super::variants::Kind;

/// Rays of each kind in an image.
pub(super) const IMAGES: [f64; 3] = [1e5, 1e6, 1e7];

/// The figures of the plan relative to others: below 1 where it saves.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ratios {
    pub(super) bytes: f64,
    /// Instructions, or cluster tests and cache lines.
    pub(super) work: f64,
    pub(super) time: f64,
    pub(super) build: f64,
}

impl Ratios {
    /// Of the plan to another variant of the same scene.
    fn new(plan: &Point, other: &Point) -> Self {
        Self {
            bytes: plan.bytes_a_triangle / other.bytes_a_triangle,
            work: plan.work() / other.work(),
            time: plan.ns() / other.ns(),
            build: plan.image_ms(0.0) / other.image_ms(0.0),
        }
    }

    /// In this order.
    pub(super) fn all(&self) -> [f64; 4] {
        [self.bytes, self.work, self.time, self.build]
    }

    /// The geometric mean; none of nothing.
    pub(super) fn mean(ratios: &[Self]) -> Option<Self> {
        let mean = |of: fn(&Self) -> f64| geometric_mean(ratios.iter().map(of));
        (!ratios.is_empty()).then(|| Self {
            bytes: mean(|r| r.bytes),
            work: mean(|r| r.work),
            time: mean(|r| r.time),
            build: mean(|r| r.build),
        })
    }
}

/// The geometric mean of positive numbers.
pub(super) fn geometric_mean(numbers: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = numbers.fold((0.0, 0), |(sum, n), x| (sum + x.ln(), n + 1));
    (sum / f64::from(n)).exp()
}

fn of_kind(points: &[Point], kind: Kind) -> Option<&Point> {
    points.iter().find(|point| point.kind == kind)
}

/// The plan of a scene.
pub(super) fn plan(points: &[Point]) -> &Point {
    of_kind(points, Kind::Plan).expect("each scene has a plan")
}

/// The plan relative to the variants of a kind, of each scene that has one.
pub(super) fn against(scenes: &[Vec<Point>], kind: Kind) -> Vec<(&Point, Ratios)> {
    let of = |points| Some((plan(points), Ratios::new(plan(points), of_kind(points, kind)?)));
    scenes.iter().filter_map(|points: &Vec<Point>| of(points)).collect()
}

/// The structure and quality with the shortest time to an image, and relative to it the time of the plan in the
/// quality for so many rays.
pub(super) fn best(points: &[Point], rays: f64) -> (&Point, f64) {
    let choices = points.iter().filter(|p| matches!(p.kind, Kind::Structure | Kind::Plan | Kind::Fast));
    let best = choices.min_by(|a, b| a.image_ms(rays).total_cmp(&b.image_ms(rays)));
    let plan = plan(points);
    let auto = match Quality::for_rays((KINDS.len() as f64 * rays) as u64, plan.triangles) {
        Quality::Fast => of_kind(points, Kind::Fast).unwrap_or(plan),
        Quality::Balanced => plan,
    };
    let best = best.expect("each scene has a plan");
    (best, auto.image_ms(rays) / best.image_ms(rays))
}
