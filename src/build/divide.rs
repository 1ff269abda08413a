//! Voxels into leaves and divided voxels, one voxel of the top grid after the other.
//!
//! ```text
//! voxel(items):  empty                                    if there are no items
//!                leaf                                     if the policy does not divide
//!                divided, each part by voxel(its items)   if even with leaves for parts that costs less
//! ```
//!
//! One work list (`items`, a stack) serves all levels, as does one of where the items of each part start.
//! Parts are made depth first in the order of their index.

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use bytemuck::Zeroable;
use glam::Vec4;

use super::options::BuildError;
use super::piece::Piece;
use super::policy::Policy;
use super::split::{Limits, sort};
use super::voxel::{Cuboid, Item, VoxelView, Voxels, scatter};
use crate::aabb::Aabb;
use crate::arena::{BoxGroup, Brick, Form, Grid, Reference, VoxelWord};
use crate::cluster::Cluster;
use crate::lanes::{Lanes, WIDE};

/// A brick whose clusters are in this many of its parts or more on average, as long slivers are, takes more memory and
/// time to build than it saves.
const MOST_PARTS: usize = 4;

/// What all voxels have in common.
pub(super) struct Space<'a, L, P> {
    pub(super) lanes: L,
    pub(super) policy: &'a P,
    pub(super) clusters: &'a [Cluster],
    pub(super) grid: &'a Grid,
    pub(super) limits: Limits,
    /// Bytes of the pieces that are finished.
    pub(super) held: AtomicUsize,
}

/// Makes a piece.
pub(super) struct Divider<'a, L, P> {
    space: &'a Space<'a, L, P>,
    /// References, beyond which voxels are no longer divided.
    references: usize,
    form: Form,
    /// The margin and the least side, as lengths.
    margin: f64,
    least_side: f64,
    piece: Piece,
    /// The work list: the items of the voxel at hand above those of the voxels around it.
    items: Vec<Item>,
    /// Items with the part of the voxel they are in, before they are sorted by it.
    parts: Vec<(u32, Item)>,
    /// Where the items of each part start, for the voxel at hand above those around it.
    starts: Vec<usize>,
    /// What each part costs as a leaf, likewise.
    costs: Vec<f32>,
}

impl<'a, L: Lanes, P: Policy> Divider<'a, L, P> {
    pub(super) fn new(space: &'a Space<'a, L, P>, references: usize) -> Self {
        Self {
            references,
            form: space.policy.form(),
            margin: space.limits.margin_in(space.grid),
            least_side: space.limits.least_side_in(space.grid),
            space,
            piece: Piece::default(),
            items: Vec::new(),
            parts: Vec::new(),
            starts: Vec::new(),
            costs: Vec::new(),
        }
    }

    pub(super) fn piece(self) -> Piece {
        self.space.held.fetch_add(self.piece.bytes(), Ordering::Relaxed);
        self.piece
    }

    /// Makes a voxel of the top grid.
    pub(super) fn top_voxel(
        &mut self,
        cube: Cuboid,
        items: impl Iterator<Item = Item>,
    ) -> Result<(), BuildError> {
        self.items.extend(items);
        let items = 0..self.items.len();
        let leaf_cost = self.space.policy.leaf_cost(&self.view(items.clone(), cube));
        let word = self.voxel(items, cube, leaf_cost, 0)?;
        self.items.clear();
        self.piece.top.push(word);
        Ok(())
    }

    fn view(&self, range: Range<usize>, cube: Cuboid) -> VoxelView<'_> {
        let bounds = cube.enlarged(self.margin);
        VoxelView { items: &self.items[range], clusters: self.space.clusters, bounds }
    }

    /// Makes a voxel and returns its word.
    fn voxel(
        &mut self,
        range: Range<usize>,
        cube: Cuboid,
        leaf_cost: f32,
        depth: u32,
    ) -> Result<VoxelWord, BuildError> {
        if range.is_empty() {
            return Ok(VoxelWord::EMPTY);
        }
        let view = self.view(range.clone(), cube);
        let divides = self.may_divide(cube, depth) && self.space.policy.divides(&view, leaf_cost);
        if divides
            && self.separates(&view, cube.longest())
            && let Some(word) = self.divide(range.clone(), cube, leaf_cost, depth)?
        {
            return Ok(word);
        }
        self.leaf(range)
    }

    fn may_divide(&self, cube: Cuboid, depth: u32) -> bool {
        let references = self.piece.references.len() + WIDE * self.piece.groups.len();
        depth < self.space.limits.levels
            && cube.longest() / f64::from(self.form.divisions()) >= self.least_side
            && references < self.references
    }

    /// Whether a triangle is not much larger than the voxel; else smaller voxels would only chase the
    /// vertex or the edge that all triangles share.
    fn separates(&self, voxel: &VoxelView<'_>, side: f64) -> bool {
        let most = 16.0 * side;
        self.form == Form::Bricks || voxel.extents().any(|extent| f64::from(extent) < most)
    }

    /// Divides a voxel; `None` where that gains nothing.
    fn divide(
        &mut self,
        range: Range<usize>,
        cube: Cuboid,
        leaf_cost: f32,
        depth: u32,
    ) -> Result<Option<VoxelWord>, BuildError> {
        let parts = match self.form {
            Form::Lists { divisions } => Parts::of_all(cube, divisions),
            Form::Bricks => self.fitted(range.clone(), cube),
        };
        let (floor, start) = (self.items.len(), self.starts.len());
        self.list_parts(range.clone(), &parts.voxels)?;
        let mut divided = None;
        if self.gains(range) {
            sort(
                self.parts.iter().copied(),
                parts.voxels.len(),
                Item::NONE,
                &mut self.items,
                &mut self.starts,
            );
            let costs = self.costs.len();
            if self.cost_in_leaves(&parts, start) < leaf_cost {
                divided = Some(self.node(&parts, start, costs, depth)?);
            }
            self.costs.truncate(costs);
        }
        self.items.truncate(floor);
        self.starts.truncate(start);
        Ok(divided)
    }

    /// The items of part `i` of a divided voxel, whose parts start at `starts[start..]`.
    fn part(&self, start: usize, i: usize) -> Range<usize> {
        self.starts[start + i]..self.starts[start + i + 1]
    }

    /// The parts of a brick around the items of a voxel, but no smaller than the least side.
    ///
    /// Where the items are flat, it begins where they do, so that they are in one layer of it.
    fn fitted(&self, items: Range<usize>, cube: Cuboid) -> Parts {
        let grid = self.space.grid;
        let all = self.items[items].iter().fold(Aabb::EMPTY, |all, item| all.union(ordered(&item.bounds)));
        let least = (self.least_side / grid.cell) as f32;
        let [lo, hi] = in_cells(&all, grid, self.margin);
        let side = [0, 1, 2].map(|axis| (0.25 * (hi[axis] - lo[axis])).next_up().max(least));
        let place = |axis: usize| grid.lo[axis] + f64::from(lo[axis]) * grid.cell;
        let sides = side.map(|side| f64::from(side) * grid.cell);
        let voxels = Voxels::new(std::array::from_fn(place), sides, [4; 3]);
        let area = |cube: Cuboid| cube.enlarged(self.margin).half_area();
        let chance = (area(voxels.whole()) / area(cube)).min(1.0);
        let four = |[x, y, z]: [f32; 3]| Vec4::new(x, y, z, z);
        Parts { voxels, chance, brick: Brick { lo: four(lo), side: four(side), ..Brick::zeroed() } }
    }

    /// What a divided voxel costs if its parts are leaves; puts what each of them costs on top of `costs`.
    fn cost_in_leaves(&mut self, parts: &Parts, start: usize) -> f32 {
        let policy = self.space.policy;
        let (mut sum, mut count) = (0.0, 0);
        for i in 0..parts.voxels.len() {
            let items = self.part(start, i);
            let leaf_cost = if items.is_empty() {
                0.0
            } else {
                count += 1;
                policy.leaf_cost(&self.view(items, parts.voxels.nth(i)))
            };
            self.costs.push(leaf_cost);
            sum += leaf_cost;
        }
        policy.node_cost(sum, count, parts.chance)
    }

    /// Makes the parts of a divided voxel, whose items start at `starts[start..]`, and which cost
    /// `costs[costs..]` as leaves.
    fn node(
        &mut self,
        parts: &Parts,
        start: usize,
        costs: usize,
        depth: u32,
    ) -> Result<VoxelWord, BuildError> {
        let is_occupied = |i: usize| !self.part(start, i).is_empty();
        let len = parts.voxels.len();
        let (node, first) = match self.form {
            Form::Lists { .. } => self.reserve_list(len)?,
            Form::Bricks => {
                let mask = (0..len).map(|i| u64::from(is_occupied(i)) << i).sum();
                self.reserve_brick(Brick { occupied: mask, ..parts.brick })?
            }
        };
        let mut rank = 0;
        for i in 0..len {
            let items = self.part(start, i);
            if !items.is_empty() {
                let word = self.voxel(items, parts.voxels.nth(i), self.costs[costs + i], depth + 1)?;
                let slot = if self.form == Form::Bricks { rank } else { i };
                self.piece.words[first + slot] = word;
                rank += 1;
            }
        }
        Ok(node)
    }

    /// Lists the items with the parts of the voxel that they overlap.
    fn list_parts(&mut self, range: Range<usize>, voxels: &Voxels) -> Result<(), BuildError> {
        self.parts.clear();
        let space = self.space;
        space.lanes.vectorize(
            #[inline(always)]
            || {
                for item in &self.items[range] {
                    scatter(space.lanes, space.clusters, item, voxels, self.margin, |part, item| {
                        self.parts.push((part, item));
                    });
                }
            },
        );
        self.check_memory()
    }

    /// Whether division spares a ray through the voxel some tests, given that it meets a part with a
    /// chance of 1 / N^2 (the ratio of the areas).
    ///
    /// Without this, a threshold below the number of triangles around a vertex would never be met there. Bricks are
    /// judged by their cost; here only by what they take.
    fn gains(&self, whole: Range<usize>) -> bool {
        let n = self.form.divisions() as usize;
        if self.form == Form::Bricks {
            return self.parts.len() < MOST_PARTS * whole.len();
        }
        let triangles = |item: &Item| item.mask.count_ones() as usize;
        let parts: usize = self.parts.iter().map(|(_, item)| triangles(item)).sum();
        let whole: usize = self.items[whole].iter().map(triangles).sum();
        // About 3 N / 2 steps lead through the parts, each as dear as a test.
        parts + n * n * (3 * n / 2) < n * n * whole
    }

    /// Makes room for all parts of a divided voxel: its word, and the index of the first part's.
    fn reserve_list(&mut self, parts: usize) -> Result<(VoxelWord, usize), BuildError> {
        let first = self.piece.words.len();
        self.piece.words.resize(first + parts, VoxelWord::EMPTY);
        self.check_memory()?;
        Ok((VoxelWord::node(first).ok_or(BuildError::TooLarge { what: "voxels" })?, first))
    }

    /// Makes room for the occupied parts of a divided voxel: its word, and the index of the first one's.
    fn reserve_brick(&mut self, brick: Brick) -> Result<(VoxelWord, usize), BuildError> {
        let too_large = BuildError::TooLarge { what: "voxels" };
        let piece = &mut self.piece;
        let words = piece.words.len();
        let Some(first) = u32::try_from(words).ok() else { return Err(too_large) };
        piece.words.resize(words + brick.occupied.count_ones() as usize, VoxelWord::EMPTY);
        piece.bricks.push(Brick { first, ..brick });
        let node = VoxelWord::node(piece.bricks.len() - 1);
        self.check_memory()?;
        Ok((node.ok_or(too_large)?, words))
    }

    fn leaf(&mut self, range: Range<usize>) -> Result<VoxelWord, BuildError> {
        let items = &self.items[range];
        let word = match self.form {
            Form::Lists { .. } => {
                let references = &mut self.piece.references;
                let word = VoxelWord::leaf(references.len());
                let last = items.len() - 1;
                references.extend((0..).zip(items).map(|(i, item)| Reference::new(item.cluster, i == last)));
                word
            }
            Form::Bricks => {
                let word = VoxelWord::leaf(self.piece.groups.len());
                let last = items.len().div_ceil(WIDE) - 1;
                for (i, items) in items.chunks(WIDE).enumerate() {
                    self.piece.groups.push(group(items, self.space.grid, self.margin, i == last));
                }
                word
            }
        };
        self.check_memory()?;
        word.ok_or(BuildError::TooLarge { what: "references" })
    }

    /// Fails where the clusters and this piece, with the work on it or with the finished pieces, exceed the
    /// limit: whatever the threads, as the pieces are all of the arena.
    fn check_memory(&self) -> Result<(), BuildError> {
        // Each part is going to be an item, too.
        let parts = self.parts.len() * (size_of::<(u32, Item)>() + size_of::<Item>());
        let work = size_of_val(&*self.items) + parts;
        let held = self.space.held.load(Ordering::Relaxed);
        let own = size_of_val(self.space.clusters) + self.piece.bytes();
        self.space.limits.check(own + work.max(held))
    }
}

/// What a voxel is divided into.
struct Parts {
    voxels: Voxels,
    /// Of a ray through the voxel to meet them at all.
    chance: f32,
    /// Where they are, in a structure of bricks.
    brick: Brick,
}

impl Parts {
    /// The whole voxel.
    fn of_all(cube: Cuboid, n: u32) -> Self {
        let voxels = Voxels::new(cube.lo, cube.side.map(|side| side / f64::from(n)), [n; 3]);
        Self { voxels, chance: 1.0, brick: Brick::zeroed() }
    }
}

/// What only rounding has let overlap a voxel may lie beside it: its box without sides below 0.
fn ordered(b: &Aabb) -> Aabb {
    Aabb { lo: b.lo.min(b.hi), hi: b.lo.max(b.hi) }
}

/// The corners of a box enlarged by the margin and rounded outwards, relative to the grid's lower one, in cells.
fn in_cells(b: &Aabb, grid: &Grid, margin: f64) -> [[f32; 3]; 2] {
    let cells =
        |x: f32, axis: usize, margin: f64| ((f64::from(x) + margin - grid.lo[axis]) / grid.cell) as f32;
    let lo = std::array::from_fn(|axis| cells(b.lo[axis], axis, -margin).next_down());
    let hi = std::array::from_fn(|axis| cells(b.hi[axis], axis, margin).next_up());
    [lo, hi]
}

/// The boxes of up to sixteen items, enlarged by the margin, in cells of the grid.
fn group(items: &[Item], grid: &Grid, margin: f64, last: bool) -> BoxGroup {
    let mut group =
        BoxGroup { planes: [[[f32::INFINITY; WIDE]; 3]; 2], clusters: [Reference::new(0, last); WIDE] };
    for (lane, item) in items.iter().enumerate() {
        let corners = in_cells(&ordered(&item.bounds), grid, margin);
        for axis in 0..3 {
            group.planes[0][axis][lane] = corners[0][axis];
            group.planes[1][axis][lane] = corners[1][axis];
        }
        group.clusters[lane] = Reference::new(item.cluster, last);
    }
    group
}
