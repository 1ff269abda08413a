//! From triangles to an arena: analyse, cluster, split.
//!
//! A chain of functions over flat arrays. One driver ([`split`]) owns the work list; a policy only
//! answers where to split.

mod analysis;
mod cluster;
mod curve;
mod divide;
mod grid;
mod options;
mod piece;
mod plan;
mod policy;
mod profile;
mod sah;
mod split;
mod voxel;

pub use options::{
    BuildError, BuildOptions, HybridParams, OctreeParams, Quality, RecursiveParams, Structure, UniformParams,
};
pub use plan::{Decision, Forced, Part, Plan};
pub use profile::SceneProfile;

use crate::arena::{Arena, BRICK_LEVELS, Form, LIST_LEVELS};
use crate::cluster::Cluster;
use crate::dda::{BRICK_MARGIN, LIST_MARGIN};
use crate::lanes::dispatch;
use crate::mesh::TriMesh;
use crate::parallel;
use analysis::Analysis;
use policy::Policy;

/// Builds the structure that `options` asks for.
pub(crate) fn build(mesh: &TriMesh<'_>, options: &BuildOptions) -> Result<(Structure, Arena), BuildError> {
    options.structure.as_ref().map_or(Ok(()), Structure::check)?;
    parallel::enter(|| build_in_pool(mesh, options))
}

fn build_in_pool(mesh: &TriMesh<'_>, options: &BuildOptions) -> Result<(Structure, Arena), BuildError> {
    let analysis = Analysis::new(mesh);
    let structure = match options.structure {
        Some(structure) => structure,
        None => {
            let (crowding, _) = profile::crowding(&analysis);
            Plan::of(analysis.len(), crowding, options.forced).structure()
        }
    };
    Ok((structure, structured(mesh, &analysis, &structure, options)?))
}

fn structured(
    mesh: &TriMesh<'_>,
    analysis: &Analysis,
    structure: &Structure,
    options: &BuildOptions,
) -> Result<Arena, BuildError> {
    let clusters = match structure {
        Structure::Brute => cluster::in_order(mesh, analysis),
        _ => cluster::clusters(mesh, analysis, options.isa, options.quality),
    };
    match structure {
        Structure::Uniform(p) => finish(&policy::Uniform::new(p, analysis), clusters, analysis, 0, options),
        Structure::Recursive(p) => {
            finish(&policy::Recursive::new(p, analysis), clusters, analysis, LIST_LEVELS, options)
        }
        Structure::Octree(p) => {
            finish(&policy::Octree::new(p, mesh, analysis), clusters, analysis, LIST_LEVELS, options)
        }
        Structure::Hybrid(p) => {
            let policy = policy::Hybrid::new(p, analysis, clusters.len());
            finish(&policy, clusters, analysis, p.levels, options)
        }
        Structure::Brute => brute(clusters, analysis, options),
    }
}

/// Clusters without voxels.
fn brute(clusters: Vec<Cluster>, analysis: &Analysis, options: &BuildOptions) -> Result<Arena, BuildError> {
    // Only the box around all of them counts, which few voxels fit well.
    let grid = grid::cubic(&analysis.bounds, 64.0).fitted(&analysis.bounds);
    let arena = Arena { clusters, ..Arena::new(grid, Form::BRUTE) };
    let (limit, needed) = (options.memory_limit, arena.bytes());
    if needed > limit { Err(BuildError::MemoryLimit { limit, needed }) } else { Ok(arena) }
}

fn finish<P: Policy>(
    policy: &P,
    clusters: Vec<Cluster>,
    analysis: &Analysis,
    levels: u32,
    options: &BuildOptions,
) -> Result<Arena, BuildError> {
    // Divided voxels pay only down to where the margin is a small part of them.
    // References are as many bytes at most in either form: 4 each, or 28 with their boxes.
    let (margin, least_side, most_levels, references) = match policy.form() {
        Form::Lists { .. } => (LIST_MARGIN, 1.0 / f64::from(1u32 << 22), LIST_LEVELS, 64),
        Form::Bricks => (BRICK_MARGIN, 1.0 / f64::from(1u32 << 14), BRICK_LEVELS, 8),
    };
    let limits = split::Limits {
        memory: options.memory_limit,
        references: (1 << 16) + references * analysis.len(),
        margin,
        least_side,
        levels: levels.min(most_levels),
    };
    let arena = dispatch!(options.isa, lanes => split::build(lanes, policy, clusters, limits))?;
    Ok(Arena { grid: arena.grid.fitted(&analysis.bounds), ..arena })
}
