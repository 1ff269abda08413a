//! What of a structure a scene needs, and why.

use std::fmt;

use super::options::{HybridParams, Structure};
use super::profile::SceneProfile;

/// What a structure can have or leave out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Voxels at all; without them every triangle is tested for every ray ([`Structure::Brute`]).
    Voxels,
    /// A top grid of twice as many voxels.
    FineGrid,
    /// Bricks that divide the voxels of the top grid, and the code that walks through them.
    Bricks,
}

impl Part {
    /// All parts.
    pub const ALL: [Self; 3] = [Self::Voxels, Self::FineGrid, Self::Bricks];

    /// `voxels`, `fine-grid` or `bricks`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Voxels => "voxels",
            Self::FineGrid => "fine-grid",
            Self::Bricks => "bricks",
        }
    }
}

/// Parts that are kept or left out whatever a plan says; none by default.
///
/// ```
/// use octogrid::{Forced, Part};
/// let forced = Forced::default().with(Part::Bricks, false);
/// assert_eq!((forced.get(Part::Bricks), forced.get(Part::Voxels)), (Some(false), None));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Forced([Option<bool>; Part::ALL.len()]);

impl Forced {
    /// All parts kept (`true`) or left out.
    pub fn all(keep: bool) -> Self {
        Self([Some(keep); Part::ALL.len()])
    }

    /// The same, and a part that is kept (`true`) or left out.
    pub fn with(mut self, part: Part, keep: bool) -> Self {
        self.0[part as usize] = Some(keep);
        self
    }

    /// Whether a part is forced, and to what.
    pub fn get(&self, part: Part) -> Option<bool> {
        self.0[part as usize]
    }
}

/// What a plan says of a part.
#[derive(Clone, Debug, PartialEq)]
pub struct Decision {
    /// The part.
    pub part: Part,
    /// Whether it is kept.
    pub kept: bool,
    /// Whether that is forced, whatever the figure.
    pub forced: bool,
    /// What decides, and which side of its limit it is on.
    pub reason: String,
}

impl fmt::Display for Decision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let what = if self.kept { "kept" } else { "left out" };
        let by = if self.forced { "as asked; else decided by: " } else { "" };
        write!(f, "{:<10} {what:<9} {by}{}", self.part.name(), self.reason)
    }
}

/// What of a structure a scene needs, with the figures that decide: what
/// [`BuildOptions::structure`](crate::BuildOptions) is where none is given.
///
/// Prints as one line a part. The limits are measured, see ARCHITECTURE.md.
///
/// ```
/// use octogrid::{Forced, Part, Plan, SceneProfile, Structure, builtin};
/// let profile = SceneProfile::new(&builtin::cube().mesh()?);
/// let plan = Plan::new(&profile, Forced::default());
/// assert_eq!(plan.structure(), Structure::Brute);
/// let plan = Plan::new(&profile, Forced::default().with(Part::Voxels, true));
/// assert_eq!(plan.structure().name(), "hybrid");
/// # Ok::<(), octogrid::MeshError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    decisions: [Decision; Part::ALL.len()],
}

impl Plan {
    /// The most triangles to be tested one by one.
    const FEW: usize = 40;
    /// The most triangles for a fine grid.
    const SMALL: usize = 20_000;
    /// The most triangles around an average one without bricks.
    const CROWD: f64 = 512.0;

    /// What a scene needs, but for parts that are forced.
    pub fn new(profile: &SceneProfile, forced: Forced) -> Self {
        Self::of(profile.triangles, profile.crowding, forced)
    }

    /// The same from what counts of the profile.
    pub(super) fn of(n: usize, crowding: f64, forced: Forced) -> Self {
        let many = n > Self::FEW;
        let decision = |part, needed, reason| {
            let force = forced.get(part);
            Decision { part, kept: force.unwrap_or(needed), forced: force.is_some(), reason }
        };
        let of_voxels = |part, needed, reason| match forced.get(Part::Voxels).unwrap_or(many) {
            true => decision(part, needed, reason),
            false => Decision { part, kept: false, forced: false, reason: "there are no voxels".to_owned() },
        };
        let (few, small, crowd) = (Self::FEW, Self::SMALL, Self::CROWD);
        let voxels = match many {
            true => format!("{n} triangles: above {few} a walk is faster than testing them all"),
            false => format!("{n} triangles: up to {few} testing them all is faster than a walk"),
        };
        let fine = match n <= small {
            true => format!("{n} triangles: up to {small} smaller voxels save tests"),
            false => {
                format!("{n} triangles: above {small} smaller voxels cost more memory than they save tests")
            }
        };
        let bricks = match crowding > crowd {
            true => format!(
                "{crowding:.0} triangles around an average one: above {crowd:.0} dividing voxels pays"
            ),
            false => {
                format!(
                    "{crowding:.0} triangles around an average one: up to {crowd:.0} boxes alone sort them as well"
                )
            }
        };
        Self {
            decisions: [
                decision(Part::Voxels, many, voxels),
                of_voxels(Part::FineGrid, n <= small, fine),
                of_voxels(Part::Bricks, crowding > crowd, bricks),
            ],
        }
    }

    /// The decisions, in the order of [`Part::ALL`].
    pub fn decisions(&self) -> &[Decision] {
        &self.decisions
    }

    /// Whether a part is kept.
    pub fn keeps(&self, part: Part) -> bool {
        self.decisions[part as usize].kept
    }

    /// The structure with these parts.
    pub fn structure(&self) -> Structure {
        if !self.keeps(Part::Voxels) {
            return Structure::Brute;
        }
        let HybridParams { density, levels, .. } = HybridParams::DEFAULT;
        Structure::Hybrid(HybridParams {
            density: if self.keeps(Part::FineGrid) { 2.0 * density } else { density },
            levels: if self.keeps(Part::Bricks) { levels } else { 0 },
            ..HybridParams::DEFAULT
        })
    }
}

impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [first, others @ ..] = &self.decisions;
        write!(f, "{first}")?;
        others.iter().try_for_each(|decision| write!(f, "\n{decision}"))
    }
}
