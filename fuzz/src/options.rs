//! How to build a structure, in range or not.

use arbitrary::Arbitrary;
use octogrid::descent::Walk;
use octogrid::{
    BuildOptions, Forced, HybridParams, Isa, OctreeParams, Part, Quality, RecursiveParams, Structure,
    UniformParams,
};

/// Any parameters of any structure.
#[derive(Arbitrary, Clone, Debug)]
pub struct Options {
    memory_limit: u32,
    general_walk: bool,
    structure: AnyStructure,
}

#[derive(Arbitrary, Clone, Copy, Debug)]
enum AnyStructure {
    Uniform { density: f32 },
    Recursive { threshold: u8, divisions: u8, top_grid: bool },
    Octree { threshold: u8, plane_weight: u32 },
    Hybrid { density: f32, levels: u8, costs: [f32; 3] },
}

impl Options {
    /// The options of the library; the memory limit is below 1 MiB to keep an execution short.
    pub fn with(&self, isa: Isa) -> BuildOptions {
        BuildOptions {
            // The bits below the memory limit.
            structure: match self.memory_limit % 16 {
                0 => None,
                1 => Some(Structure::Brute),
                _ => Some(self.structure.into()),
            },
            forced: self.forced(),
            // The lowest bit of the memory limit.
            quality: if self.memory_limit >> 12 & 1 == 0 { Quality::Balanced } else { Quality::Fast },
            memory_limit: self.memory_limit as usize >> 12,
            isa,
            walk: if self.general_walk { Walk::General } else { Walk::Special },
        }
    }

    fn forced(&self) -> Forced {
        (2..).zip(Part::ALL).fold(Forced::default(), |forced, (i, part)| {
            match self.memory_limit >> (2 * i) & 3 {
                2 => forced.with(part, true),
                3 => forced.with(part, false),
                _ => forced,
            }
        })
    }
}

impl From<AnyStructure> for Structure {
    fn from(structure: AnyStructure) -> Self {
        match structure {
            AnyStructure::Uniform { density } => Self::Uniform(UniformParams { density }),
            AnyStructure::Recursive { threshold, divisions, top_grid } => {
                let [threshold, divisions] = [threshold, divisions].map(u32::from);
                Self::Recursive(RecursiveParams { threshold, divisions, top_grid })
            }
            AnyStructure::Octree { threshold, plane_weight } => {
                Self::Octree(OctreeParams { threshold: threshold.into(), plane_weight })
            }
            AnyStructure::Hybrid { density, levels, costs: [group_cost, brick_cost, voxel_cost] } => {
                let levels = levels.into();
                Self::Hybrid(HybridParams { density, levels, group_cost, brick_cost, voxel_cost })
            }
        }
    }
}
