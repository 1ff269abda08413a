//! What is right: octogrid's own answers, of which some are confirmed by brute force.

use octogrid::oracle::brute;
use octogrid::{Scene, TriMesh};

use crate::peer::{Answer, Peer, Question};
use crate::peers::octogrid::{Built, Calls};
use crate::sets::RaySet;

/// Rays of a set that brute force confirms.
const CONFIRMED: usize = 128;
/// Relative difference of t from which an answer is wrong.
const TOLERANCE: f32 = 1e-4;

/// The answers to one set, and room for a contender's.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Answers {
    Closest(Vec<Answer>),
    Any(Vec<bool>),
    All(Vec<u32>),
}

impl Answers {
    /// Room for the answers to a set.
    pub(crate) fn room(set: &RaySet) -> Self {
        let n = set.rays.len();
        match set.question {
            Question::Closest => Self::Closest(vec![Answer::MISS; n]),
            Question::Any => Self::Any(vec![false; n]),
            Question::All => Self::All(vec![0; n]),
        }
    }

    /// Lets a contender fill it.
    pub(crate) fn ask(&mut self, peer: &dyn Peer, set: &RaySet) {
        match self {
            Self::Closest(answers) => peer.closest(&set.rays, set.coherent, answers),
            Self::Any(blocked) => peer.occluded(&set.rays, set.coherent, blocked),
            Self::All(counts) => peer.count(&set.rays, counts),
        }
    }

    /// The number of answers that differ: of closest hits in hit or miss or in t, not in the triangle,
    /// as any may be named where several meet; where `exact`, in any bit.
    ///
    /// # Panics
    /// Where the answers are to different questions.
    pub(crate) fn wrong(&self, right: &Self, exact: bool) -> usize {
        match (self, right) {
            (Self::Closest(a), Self::Closest(b)) => {
                a.iter().zip(b).filter(|(a, b)| if exact { a != b } else { differ(a, b) }).count()
            }
            (Self::Any(a), Self::Any(b)) => a.iter().zip(b).filter(|(a, b)| a != b).count(),
            (Self::All(a), Self::All(b)) => a.iter().zip(b).filter(|(a, b)| a != b).count(),
            _ => panic!("answers to different questions"),
        }
    }

    /// Compares some answers with brute force, bit for bit.
    fn confirm(&self, mesh: TriMesh<'_>, set: &RaySet) -> Result<(), String> {
        let step = set.rays.len().div_ceil(CONFIRMED).max(1);
        let some: Vec<_> = set.rays.iter().copied().step_by(step).collect();
        for (i, brute) in brute::answers(&mesh, &some).iter().enumerate() {
            let agree = match self {
                Self::Closest(all) => {
                    all[i * step] == Answer { t: brute.closest.t, prim: brute.closest.prim }
                }
                Self::Any(all) => all[i * step] == brute.occluded,
                Self::All(all) => all[i * step] as usize == brute.all.len(),
            };
            if !agree {
                return Err(format!("octogrid and brute force differ on {:?}: {brute:?}", some[i]));
            }
        }
        Ok(())
    }

    /// How many of the rays hit, or the mean number of hits.
    pub(crate) fn mean(&self) -> f64 {
        let (sum, n) = match self {
            Self::Closest(answers) => (answers.iter().filter(|a| a.is_hit()).count(), answers.len()),
            Self::Any(blocked) => (blocked.iter().filter(|b| **b).count(), blocked.len()),
            Self::All(counts) => (counts.iter().map(|&c| c as usize).sum(), counts.len()),
        };
        sum as f64 / n.max(1) as f64
    }
}

fn differ(a: &Answer, b: &Answer) -> bool {
    a.is_hit() != b.is_hit() || (a.is_hit() && (a.t - b.t).abs() > TOLERANCE * b.t.abs())
}

/// The right answers to each set.
///
/// # Errors
/// Where brute force does not agree.
pub(crate) fn answers(scene: Scene, mesh: TriMesh<'_>, sets: &[RaySet]) -> Result<Vec<Answers>, String> {
    let peer = Built::new(scene, Calls::Batch);
    let right = |set: &RaySet| {
        let mut answers = Answers::room(set);
        answers.ask(&peer, set);
        answers.confirm(mesh, set).map(|()| answers)
    };
    sets.iter().map(right).collect()
}
