//! Which structure to build, and with which parameters.

use std::fmt;
use std::ops::RangeInclusive;

use super::plan::Forced;
use crate::arena::BRICK_LEVELS;
use crate::descent::Walk;
use crate::lanes::Isa;

/// Parameters of the uniform grid (paper, section 3.1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UniformParams {
    /// Voxels a triangle that the resolution aims at, above 0.
    pub density: f32,
}

/// Parameters of the recursive regular grid R\[VOX_NTRG_THR, N_SUB_VOXELS\] (paper, section 3.2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RecursiveParams {
    /// VOX_NTRG_THR: a voxel with more triangles than this is divided.
    pub threshold: u32,
    /// N_SUB_VOXELS: the number of parts along each axis, in [`RecursiveParams::DIVISIONS`].
    pub divisions: u32,
    /// Whether there is a uniform grid on top; without it the root is one cube.
    pub top_grid: bool,
}

impl RecursiveParams {
    /// The values of N_SUB_VOXELS that there is code for.
    pub const DIVISIONS: RangeInclusive<u32> = 2..=8;
}

/// Parameters of the octree O\[VX_THRESHOLD, PLANE_WEIGHT\] (paper, section 3.3).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OctreeParams {
    /// VX_THRESHOLD: a voxel keeps up to this many triangles of different planes.
    pub threshold: u32,
    /// PLANE_WEIGHT: a voxel keeps up to `(plane_weight + 1) * threshold` triangles of one plane.
    pub plane_weight: u32,
}

/// Parameters of the hybrid: a uniform grid on top of 4x4x4 bricks.
///
/// Costs are relative to the test of one cluster.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HybridParams {
    /// Voxels of the top grid a cluster, above 0.
    pub density: f32,
    /// The most levels of bricks below the top grid; 0 leaves the top grid alone.
    pub levels: u32,
    /// Cost of testing eight cluster boxes.
    pub group_cost: f32,
    /// Cost of entering a brick.
    pub brick_cost: f32,
    /// Cost of entering a voxel of a brick.
    pub voxel_cost: f32,
}

impl HybridParams {
    /// What is fastest on the geometric mean of many scenes.
    pub const DEFAULT: Self =
        Self { density: 0.1, levels: 8, group_cost: 0.5, brick_cost: 4.0, voxel_cost: 1.0 };
}

/// A voxel structure with its parameters.
///
/// ```
/// use octogrid::{BuildOptions, RecursiveParams, Structure};
/// let r31_2 = Structure::Recursive(RecursiveParams { threshold: 31, divisions: 2, top_grid: true });
/// assert_eq!(r31_2.to_string(), "R[31,2]");
/// assert_eq!(Structure::OCTREE.to_string(), "O[4,15]");
/// let options = BuildOptions { structure: Some(r31_2), ..Default::default() };
/// # let _ = options;
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Structure {
    /// One regular grid of cubic voxels.
    Uniform(UniformParams),
    /// A grid whose crowded voxels are divided into N x N x N, recursively.
    Recursive(RecursiveParams),
    /// A cube divided by halves.
    Octree(OctreeParams),
    /// A grid on top of 4x4x4 bricks, split by a cost model.
    Hybrid(HybridParams),
    /// No voxels: every triangle for every ray, which is fastest for a handful of them.
    Brute,
}

impl Structure {
    /// The uniform grid with default parameters.
    pub const UNIFORM: Structure = Structure::Uniform(UniformParams { density: 4.0 });
    /// R\[19,4\], the paper's optimum.
    pub const RECURSIVE: Structure =
        Structure::Recursive(RecursiveParams { threshold: 19, divisions: 4, top_grid: true });
    /// O\[4,15\], the paper's optimum.
    pub const OCTREE: Structure = Structure::Octree(OctreeParams { threshold: 4, plane_weight: 15 });
    /// The hybrid with default parameters.
    pub const HYBRID: Structure = Structure::Hybrid(HybridParams::DEFAULT);
    /// All voxel structures with default parameters.
    pub const ALL: [Structure; 4] = [Self::UNIFORM, Self::RECURSIVE, Self::OCTREE, Self::HYBRID];

    /// `uniform`, `recursive`, `octree`, `hybrid` or `brute`.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Uniform(_) => "uniform",
            Self::Recursive(_) => "recursive",
            Self::Octree(_) => "octree",
            Self::Hybrid(_) => "hybrid",
            Self::Brute => "brute",
        }
    }
}

impl fmt::Display for Structure {
    /// The paper's notation where it has one.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Uniform(p) => write!(f, "uniform[{}]", p.density),
            Self::Recursive(p) => {
                write!(f, "R[{},{}]", p.threshold, p.divisions)?;
                if p.top_grid { Ok(()) } else { f.write_str(" without top grid") }
            }
            Self::Octree(p) => write!(f, "O[{},{}]", p.threshold, p.plane_weight),
            Self::Hybrid(p) => write!(f, "hybrid[{},{}]", p.density, p.levels),
            Self::Brute => f.write_str("brute force"),
        }
    }
}

/// How much work a build puts into clusters: groups of eight triangles that a ray tests at once.
///
/// ```
/// use octogrid::{BuildOptions, Quality, Ray, Scene, builtin};
/// let options = BuildOptions { quality: Quality::Fast, ..Default::default() };
/// let scene = Scene::build(&builtin::cube().mesh()?, &options)?;
/// assert!(scene.closest(&Ray::new([0.2, 0.1, 9.0], [0.0, 0.0, -1.0])).is_hit());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Quality {
    /// Triangles that follow one another along a space-filling curve, in O(n): for scenes of which fewer rays are asked
    /// than some two a triangle ([`Quality::for_rays`]).
    Fast,
    /// Split by the surface area heuristic, in O(n log n).
    #[default]
    Balanced,
}

impl Quality {
    /// What takes the shorter time for a build and so many rays of a scene, whose structures are built and whose rays
    /// are traced on as many threads: two rays a triangle decide, see ARCHITECTURE.md.
    ///
    /// ```
    /// use octogrid::Quality;
    /// assert_eq!(Quality::for_rays(100_000, 1_000_000), Quality::Fast);
    /// assert_eq!(Quality::for_rays(1_000_000, 100_000), Quality::Balanced);
    /// ```
    pub const fn for_rays(rays: u64, triangles: usize) -> Self {
        if rays / 2 < triangles as u64 { Self::Fast } else { Self::Balanced }
    }
}

/// How to build a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BuildOptions {
    /// The structure and its parameters; none is that of the scene's [`Plan`](crate::Plan).
    pub structure: Option<Structure>,
    /// Parts that are kept or left out whatever the plan says; of no effect where `structure` is given.
    pub forced: Forced,
    /// How much work is put into the build; answers do not depend on it.
    pub quality: Quality,
    /// The build fails rather than hold more than this many bytes for the finished structure.
    pub memory_limit: usize,
    /// The instruction set of the queries; answers do not depend on it.
    pub isa: Isa,
    /// Whether walks leave out what the structure does not have; answers do not depend on it.
    pub walk: Walk,
}

impl Default for BuildOptions {
    /// What the scene's plan says, at most 16 GiB, the best instruction set of this processor.
    fn default() -> Self {
        Self {
            structure: None,
            forced: Forced::default(),
            quality: Quality::default(),
            memory_limit: 16 << 30,
            isa: Isa::detect(),
            walk: Walk::Special,
        }
    }
}

impl From<Structure> for BuildOptions {
    /// That structure, and what is default otherwise.
    fn from(structure: Structure) -> Self {
        Self { structure: Some(structure), ..Self::default() }
    }
}

impl Structure {
    /// Checks the parameters.
    pub(crate) fn check(&self) -> Result<(), BuildError> {
        let above_zero = |name, value: f32| {
            let fine = value > 0.0 && value.is_finite();
            require(fine, name, f64::from(value), "finite and above 0")
        };
        match *self {
            Structure::Uniform(p) => above_zero("density", p.density),
            Structure::Recursive(p) => {
                let fine = RecursiveParams::DIVISIONS.contains(&p.divisions);
                require(fine, "divisions", f64::from(p.divisions), "from 2 to 8")
            }
            Structure::Octree(_) | Structure::Brute => Ok(()),
            Structure::Hybrid(p) => {
                above_zero("density", p.density)?;
                for (name, cost) in
                    [("group_cost", p.group_cost), ("brick_cost", p.brick_cost), ("voxel_cost", p.voxel_cost)]
                {
                    let fine = cost >= 0.0 && cost.is_finite();
                    require(fine, name, f64::from(cost), "finite and at least 0")?;
                }
                require(p.levels <= BRICK_LEVELS, "levels", f64::from(p.levels), "at most 8")
            }
        }
    }
}

fn require(fine: bool, name: &'static str, value: f64, must_be: &'static str) -> Result<(), BuildError> {
    if fine { Ok(()) } else { Err(BuildError::Parameter { name, value, must_be }) }
}

/// Why a scene can't be built.
#[derive(Clone, Debug, PartialEq)]
pub enum BuildError {
    /// The structure would need more than [`BuildOptions::memory_limit`].
    MemoryLimit {
        /// The limit, in bytes.
        limit: usize,
        /// What was needed when the build gave up, in bytes.
        needed: usize,
    },
    /// The structure has more voxels, bricks or references than 31 bits can number.
    TooLarge {
        /// What there is too much of.
        what: &'static str,
    },
    /// A parameter is out of its range.
    Parameter {
        /// The name of the parameter.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        must_be: &'static str,
    },
}

impl fmt::Display for BuildError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::MemoryLimit { limit, needed } => write!(
                f,
                "the structure needs at least {needed} bytes, over the limit of {limit}: raise the limit or split less"
            ),
            Self::TooLarge { what } => write!(f, "more than 2^31 {what}: choose parameters that split less"),
            Self::Parameter { name, value, must_be } => write!(f, "{name} is {value}, but must be {must_be}"),
        }
    }
}

impl std::error::Error for BuildError {}
