//! Policies: where to split. The driver in [`super::split`] does everything else.

use super::analysis::{Analysis, planes};
use super::grid;
use super::options::{HybridParams, OctreeParams, RecursiveParams, UniformParams};
use super::profile::share_occupied;
use super::voxel::{Item, VoxelView};
use crate::arena::{Form, Grid};
use crate::mesh::TriMesh;

/// Where to split.
pub(crate) trait Policy: Sync {
    /// The grid on top.
    fn grid(&self) -> Grid;

    /// How divided voxels and leaves are stored.
    fn form(&self) -> Form;

    /// Whether to try and divide a voxel that costs `leaf_cost` as a leaf.
    fn divides(&self, voxel: &VoxelView<'_>, leaf_cost: f32) -> bool;

    /// The cost of a voxel as a leaf. A voxel is divided only if that costs less.
    fn leaf_cost(&self, _voxel: &VoxelView<'_>) -> f32 {
        f32::INFINITY
    }

    /// The cost of a divided voxel, from the sum of its voxels' costs, their number, and the chance of a ray through
    /// it to meet them at all.
    fn node_cost(&self, _children: f32, _count: u32, _chance: f32) -> f32 {
        0.0
    }
}

/// One level (paper, section 3.1).
pub(crate) struct Uniform {
    grid: Grid,
}

impl Uniform {
    pub(crate) fn new(params: &UniformParams, analysis: &Analysis) -> Self {
        let target = f64::from(params.density) * analysis.len() as f64;
        Self { grid: grid::cubic(&analysis.bounds, target) }
    }
}

impl Policy for Uniform {
    fn grid(&self) -> Grid {
        self.grid
    }
    fn form(&self) -> Form {
        Form::Lists { divisions: 1 }
    }
    fn divides(&self, _: &VoxelView<'_>, _: f32) -> bool {
        false
    }
}

/// More than a number of triangles (paper, section 3.2).
pub(crate) struct Recursive {
    params: RecursiveParams,
    grid: Grid,
}

impl Recursive {
    /// The top grid has few voxels where the scene is uneven and many where it is even, as the paper
    /// asks: the share of occupied voxels of a fine grid is the measure.
    pub(crate) fn new(params: &RecursiveParams, analysis: &Analysis) -> Self {
        let grid = if params.top_grid {
            let even = analysis.len() as f64 / f64::from(params.threshold.max(1));
            let occupants = analysis.occupants(analysis.len() as f64 / 8.0);
            grid::cubic(&analysis.bounds, 4.0 * even * share_occupied(&occupants))
        } else {
            grid::cube(&analysis.bounds)
        };
        Self { params: *params, grid }
    }
}

impl Policy for Recursive {
    fn grid(&self) -> Grid {
        self.grid
    }
    fn form(&self) -> Form {
        Form::Lists { divisions: self.params.divisions }
    }
    fn divides(&self, voxel: &VoxelView<'_>, _: f32) -> bool {
        voxel.triangles() > self.params.threshold as usize
    }
}

/// More than a number of triangles, those of one plane counting less (paper, section 3.3).
pub(crate) struct Octree {
    params: OctreeParams,
    grid: Grid,
    planes: Vec<u32>,
}

impl Octree {
    pub(crate) fn new(params: &OctreeParams, mesh: &TriMesh<'_>, analysis: &Analysis) -> Self {
        Self { params: *params, grid: grid::cube(&analysis.bounds), planes: planes(mesh, analysis) }
    }
}

impl Policy for Octree {
    fn grid(&self) -> Grid {
        self.grid
    }
    fn form(&self) -> Form {
        Form::Lists { divisions: 2 }
    }

    /// The paper's loop over triangles sorted by plane, with the budget that its text asks for
    /// (`(PLANE_WEIGHT + 1) * VX_THRESHOLD`, where the printed code starts at VX_THRESHOLD): each
    /// triangle costs 1 and each plane after the first PLANE_WEIGHT on top.
    fn divides(&self, voxel: &VoxelView<'_>, _: f32) -> bool {
        let weight = self.params.plane_weight as usize;
        let budget = (weight + 1).saturating_mul(self.params.threshold as usize);
        let triangles = voxel.triangles();
        if triangles > budget || weight == 0 {
            return triangles > budget;
        }
        let mut planes: Vec<u32> = voxel.ids().map(|id| self.planes[id as usize]).collect();
        planes.sort_unstable();
        planes.dedup();
        triangles + weight * planes.len().saturating_sub(1) > budget
    }
}

/// Where a cost model says that it pays.
pub(crate) struct Hybrid {
    params: HybridParams,
    grid: Grid,
}

impl Hybrid {
    pub(crate) fn new(params: &HybridParams, analysis: &Analysis, clusters: usize) -> Self {
        let target = f64::from(params.density) * clusters as f64;
        Self { params: *params, grid: grid::cubic(&analysis.bounds, target) }
    }
}

impl Policy for Hybrid {
    fn grid(&self) -> Grid {
        self.grid
    }
    fn form(&self) -> Form {
        Form::Bricks
    }

    /// A leaf of eight clusters is as cheap as a leaf gets, and what costs little more than a brick does not repay the
    /// trial.
    fn divides(&self, voxel: &VoxelView<'_>, leaf_cost: f32) -> bool {
        voxel.items.len() > crate::lanes::WIDTH && leaf_cost > 4.0 * self.params.brick_cost
    }

    /// A ray through a voxel meets a cluster's box with a chance that is the ratio of the areas. Boxes are counted by
    /// eight, though sixteen are tested at once: leaves get too long otherwise.
    fn leaf_cost(&self, voxel: &VoxelView<'_>) -> f32 {
        let groups = voxel.items.len().div_ceil(crate::lanes::WIDTH) as f32;
        let area = voxel.bounds.half_area();
        let chance = |item: &Item| (item.bounds.half_area() / area).min(1.0);
        let clusters: f32 = voxel.items.iter().map(chance).sum();
        groups * self.params.group_cost + clusters
    }

    /// A ray through a brick meets one of its 4 x 4 x 4 parts with a chance of 1/16.
    fn node_cost(&self, children: f32, count: u32, chance: f32) -> f32 {
        self.params.brick_cost + chance / 16.0 * (children + self.params.voxel_cost * count as f32)
    }
}
