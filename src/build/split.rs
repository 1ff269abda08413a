//! The build driver: voxels into leaves and divided voxels.
//!
//! ```text
//! voxel(items):  empty                                    if there are no items
//!                leaf                                     if the policy does not divide
//!                divided, each part by voxel(its items)   if that costs less than a leaf
//! ```
//!
//! One work list (`items`, a stack) serves all levels. Parts are made depth first in the order of their
//! index, so that the result is the same for every run.

use std::ops::Range;

use glam::Vec3;

use super::options::BuildError;
use super::policy::Policy;
use crate::aabb::Aabb;
use crate::arena::{Arena, BoxGroup, Brick, Form, Grid, Reference, VoxelWord};
use crate::cluster::Cluster;
use crate::lanes::{Lanes, WIDTH};
use crate::overlap::overlapping;

/// A cluster in a voxel, with the lanes whose triangles overlap it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Item {
    pub(crate) cluster: u32,
    pub(crate) mask: u8,
}

/// A voxel to be judged by a policy.
pub(crate) struct VoxelView<'a> {
    pub(crate) items: &'a [Item],
    clusters: &'a [Cluster],
    /// The voxel, enlarged by the margin.
    pub(crate) bounds: Aabb,
}

impl VoxelView<'_> {
    /// The number of triangles.
    pub(crate) fn triangles(&self) -> usize {
        self.items.iter().map(|item| item.mask.count_ones() as usize).sum()
    }

    /// The triangles.
    pub(crate) fn ids(&self) -> impl Iterator<Item = u32> + '_ {
        self.items.iter().flat_map(|item| {
            let ids = self.clusters[item.cluster as usize].ids();
            (0..WIDTH).filter(|lane| item.mask >> lane & 1 != 0).map(|lane| ids[lane])
        })
    }

    /// The longest side of each triangle's box.
    fn extents(&self) -> impl Iterator<Item = f32> + '_ {
        self.items.iter().flat_map(|item| {
            let cluster = &self.clusters[item.cluster as usize];
            let lanes = (0..WIDTH).filter(|lane| item.mask >> lane & 1 != 0);
            lanes.map(|lane| Aabb::around(cluster.triangle(lane)).extent().max_element())
        })
    }

    /// The box of an item's triangles within the voxel.
    pub(crate) fn clipped(&self, item: &Item) -> Aabb {
        self.clusters[item.cluster as usize].bounds(item.mask).intersection(self.bounds)
    }
}

/// Builds the voxels over `clusters`.
pub(crate) fn build<L: Lanes, P: Policy>(
    lanes: L,
    policy: &P,
    clusters: Vec<Cluster>,
    limits: Limits,
) -> Result<Arena, BuildError> {
    let arena = Arena {
        grid: policy.grid(),
        form: policy.form(),
        clusters,
        words: Vec::new(),
        references: Vec::new(),
        bricks: Vec::new(),
        groups: Vec::new(),
    };
    let items = (0..arena.clusters.len() as u32)
        .map(|cluster| Item { cluster, mask: arena.clusters[cluster as usize].occupied() })
        .collect();
    let (margin, least_side) = (0.0, 0.0);
    let mut splitter =
        Splitter { lanes, policy, limits, margin, least_side, arena, items, parts: Vec::new() };
    let grid = splitter.place_grid();
    // Before it is there: a word, and twice where the items of a voxel start.
    splitter.check_memory(grid.len() * (size_of::<VoxelWord>() + 2 * size_of::<usize>()))?;
    splitter.list_parts(0..splitter.items.len(), &grid)?;
    let starts = splitter.sort_parts(&grid);
    splitter.arena.words.resize(grid.len(), VoxelWord::EMPTY);
    for (i, range) in starts.windows(2).enumerate() {
        let (x, yz) = (i as u32 % grid.dims[0], i as u32 / grid.dims[0]);
        let corner = grid.corner([x, yz % grid.dims[1], yz / grid.dims[1]]);
        let cube = Cube { lo: corner, side: grid.cell };
        splitter.arena.words[i] = splitter.voxel(range[0]..range[1], cube, 0)?.0;
    }
    let mut arena = splitter.arena;
    arena.words.shrink_to_fit();
    arena.references.shrink_to_fit();
    arena.bricks.shrink_to_fit();
    arena.groups.shrink_to_fit();
    Ok(arena)
}

/// What bounds a build.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    /// Bytes of the arena, at most.
    pub(crate) memory: usize,
    /// References, beyond which voxels are no longer divided and the top grid gets coarser.
    pub(crate) references: usize,
    /// The distance by which voxels are enlarged, so that what a ray meets lies in a voxel that its walk
    /// visits in spite of the walk's rounding errors; in sizes of the top grid.
    pub(crate) margin: f64,
    /// The least side of a voxel, in sizes of the top grid.
    pub(crate) least_side: f64,
    /// Levels below the top grid, at most.
    pub(crate) levels: u32,
}

/// A voxel's place.
#[derive(Clone, Copy)]
struct Cube {
    lo: [f64; 3],
    side: f64,
}

impl Cube {
    /// The cube enlarged by `margin`, rounded outwards.
    fn enlarged(&self, margin: f64) -> Aabb {
        let down = |x: f64| (x as f32).next_down();
        let up = |x: f64| (x as f32).next_up();
        Aabb {
            lo: Vec3::from_array(self.lo.map(|x| down(x - margin))),
            hi: Vec3::from_array(self.lo.map(|x| up(x + self.side + margin))),
        }
    }
}

struct Splitter<'a, L, P> {
    lanes: L,
    policy: &'a P,
    limits: Limits,
    /// The margin and the least side for the grid at hand.
    margin: f64,
    least_side: f64,
    arena: Arena,
    /// The work list: the items of the voxel at hand above those of the voxels around it.
    items: Vec<Item>,
    /// Items with the part of the grid they are in, before they are sorted by it.
    parts: Vec<(u32, Item)>,
}

impl<L: Lanes, P: Policy> Splitter<'_, L, P> {
    /// The policy's grid or, where its voxels would have too many references, the next coarser one: large
    /// triangles one above the other would be in all of them.
    fn place_grid(&mut self) -> Grid {
        let mut grid = self.arena.grid;
        loop {
            let size = grid.cell * f64::from(grid.longest());
            (self.margin, self.least_side) = (self.limits.margin * size, self.limits.least_side * size);
            if grid.len() == 1 || self.estimate(&grid) <= self.limits.references as f64 {
                self.arena.grid = grid;
                return grid;
            }
            grid = grid.coarser();
        }
    }

    /// About how many references the voxels of a grid would have, seldom less: all voxels in the box of a
    /// cluster, or as many as three planes may meet of them.
    fn estimate(&self, grid: &Grid) -> f64 {
        let voxels = |item: &Item| {
            let [x, y, z] = self.range(*item, grid).map(|range| range.len() as f64);
            (x * y * z).min(3.0 * (x * y + y * z + z * x))
        };
        self.items.iter().map(voxels).sum()
    }

    /// Makes a voxel and returns its word and cost.
    fn voxel(&mut self, range: Range<usize>, cube: Cube, depth: u32) -> Result<(VoxelWord, f32), BuildError> {
        if range.is_empty() {
            return Ok((VoxelWord::EMPTY, 0.0));
        }
        let bounds = cube.enlarged(self.margin);
        let view = VoxelView { items: &self.items[range.clone()], clusters: &self.arena.clusters, bounds };
        let leaf_cost = self.policy.leaf_cost(&view);
        let divides = self.may_divide(cube, depth) && self.policy.divides(&view, leaf_cost);
        if divides && self.separates(&view, cube.side) {
            let mark = self.mark();
            if let Some((word, cost)) = self.divide(range.clone(), cube, depth)?
                && cost < leaf_cost
            {
                return Ok((word, cost));
            }
            self.roll_back(mark);
        }
        Ok((self.leaf(range, &bounds)?, leaf_cost))
    }

    fn may_divide(&self, cube: Cube, depth: u32) -> bool {
        let references = self.arena.references.len() + WIDTH * self.arena.groups.len();
        depth < self.limits.levels
            && cube.side / f64::from(self.arena.form.divisions()) >= self.least_side
            && references < self.limits.references
    }

    /// Divides a voxel; `None` where that gains nothing.
    fn divide(
        &mut self,
        range: Range<usize>,
        cube: Cube,
        depth: u32,
    ) -> Result<Option<(VoxelWord, f32)>, BuildError> {
        let form = self.arena.form;
        let n = form.divisions();
        let parts = Grid::new(cube.lo, cube.side / f64::from(n), [n; 3]);
        let floor = self.items.len();
        self.list_parts(range.clone(), &parts)?;
        let starts = self.sort_parts(&parts);
        if !self.gains(range, starts[0]..self.items.len()) {
            self.items.truncate(floor);
            return Ok(None);
        }
        let occupied: Vec<u32> =
            (0..n * n * n).filter(|&i| starts[i as usize] < starts[i as usize + 1]).collect();
        let (node, first) = self.reserve(&occupied)?;
        let mut sum = 0.0;
        for (rank, &i) in occupied.iter().enumerate() {
            let corner = parts.corner([i % n, i / n % n, i / n / n]);
            let items = starts[i as usize]..starts[i as usize + 1];
            let (word, cost) = self.voxel(items, Cube { lo: corner, side: parts.cell }, depth + 1)?;
            let slot = if form == Form::Bricks { rank } else { i as usize };
            self.arena.words[first + slot] = word;
            sum += cost;
        }
        self.items.truncate(floor);
        Ok(Some((node, self.policy.node_cost(sum, occupied.len() as u32))))
    }

    /// Whether a triangle is not much larger than the voxel; else smaller voxels would only chase the
    /// vertex or the edge that all triangles share.
    fn separates(&self, voxel: &VoxelView<'_>, side: f64) -> bool {
        let most = 16.0 * side;
        self.arena.form == Form::Bricks || voxel.extents().any(|extent| f64::from(extent) < most)
    }

    /// Whether division spares a ray through the voxel some tests, given that it meets a part with a
    /// chance of 1 / N^2 (the ratio of the areas).
    ///
    /// Without this, a threshold below the number of triangles around a vertex would never be met there,
    /// and a cost model would look into parts of parts where nothing can be told apart.
    fn gains(&self, whole: Range<usize>, parts: Range<usize>) -> bool {
        let n = self.arena.form.divisions() as usize;
        if self.arena.form == Form::Bricks {
            return parts.len() < n * n * whole.len();
        }
        let triangles =
            |r: Range<usize>| self.items[r].iter().map(|i| i.mask.count_ones() as usize).sum::<usize>();
        // About 3 N / 2 steps lead through the parts, each as dear as a test.
        triangles(parts) + n * n * (3 * n / 2) < n * n * triangles(whole)
    }

    /// Makes room for the parts of a divided voxel: its word, and the index of the first part's.
    fn reserve(&mut self, occupied: &[u32]) -> Result<(VoxelWord, usize), BuildError> {
        let arena = &mut self.arena;
        let first = arena.words.len();
        let node = match arena.form {
            Form::Lists { divisions } => {
                arena.words.resize(first + divisions.pow(3) as usize, VoxelWord::EMPTY);
                VoxelWord::node(first)
            }
            Form::Bricks => {
                arena.words.resize(first + occupied.len(), VoxelWord::EMPTY);
                let mask = occupied.iter().fold(0, |mask, &i| mask | 1u64 << i);
                let first = u32::try_from(first).map_err(|_| BuildError::TooLarge { what: "voxels" })?;
                arena.bricks.push(Brick { occupied: mask, first, padding: 0 });
                VoxelWord::node(arena.bricks.len() - 1)
            }
        };
        self.check_memory(0)?;
        Ok((node.ok_or(BuildError::TooLarge { what: "voxels" })?, first))
    }

    fn leaf(&mut self, range: Range<usize>, bounds: &Aabb) -> Result<VoxelWord, BuildError> {
        let word = match self.arena.form {
            Form::Lists { .. } => {
                let first = self.arena.references.len();
                let last = range.end - 1;
                let items = &self.items;
                self.arena.references.extend(range.map(|i| Reference::new(items[i].cluster, i == last)));
                VoxelWord::leaf(first)
            }
            Form::Bricks => {
                let first = self.arena.groups.len();
                let end = range.end;
                for start in range.step_by(WIDTH) {
                    let group = self.group(start..end.min(start + WIDTH), bounds, start + WIDTH >= end);
                    self.arena.groups.push(group);
                }
                VoxelWord::leaf(first)
            }
        };
        self.check_memory(0)?;
        word.ok_or(BuildError::TooLarge { what: "references" })
    }

    /// The boxes of up to eight items, clipped to the voxel and enlarged by the margin.
    fn group(&self, range: Range<usize>, bounds: &Aabb, last: bool) -> BoxGroup {
        let grid = &self.arena.grid;
        let view = VoxelView { items: &self.items[range], clusters: &self.arena.clusters, bounds: *bounds };
        let mut group =
            BoxGroup { planes: [[[f32::INFINITY; WIDTH]; 3]; 2], clusters: [Reference::new(0, last); WIDTH] };
        for (lane, item) in view.items.iter().enumerate() {
            let b = view.clipped(item);
            // What only rounding has let overlap the voxel may lie beside it.
            let (lo, hi) = (b.lo.min(b.hi), b.lo.max(b.hi));
            for axis in 0..3 {
                let local =
                    |x: f32, margin: f64| ((f64::from(x) + margin - grid.lo[axis]) / grid.cell) as f32;
                group.planes[0][axis][lane] = local(lo[axis], -self.margin).next_down();
                group.planes[1][axis][lane] = local(hi[axis], self.margin).next_up();
            }
            group.clusters[lane] = Reference::new(item.cluster, last);
        }
        group
    }

    /// Lists the items with the voxels of `grid` that they overlap.
    fn list_parts(&mut self, range: Range<usize>, grid: &Grid) -> Result<(), BuildError> {
        let mut parts = std::mem::take(&mut self.parts);
        parts.clear();
        self.lanes.vectorize(
            #[inline(always)]
            || {
                for i in range {
                    self.scatter(self.items[i], grid, &mut parts);
                    // Each is going to be an item, too.
                    self.check_memory(parts.len() * (size_of::<(u32, Item)>() + size_of::<Item>()))?;
                }
                Ok(())
            },
        )?;
        self.parts = parts;
        Ok(())
    }

    /// Sorts the listed parts by voxel, on top of the work list.
    ///
    /// Returns where the items of each voxel start, and the end. Counting sort: within a voxel the
    /// order of the items stays.
    fn sort_parts(&mut self, grid: &Grid) -> Vec<usize> {
        let mut starts = vec![0; grid.len() + 1];
        self.parts.iter().for_each(|(voxel, _)| starts[*voxel as usize + 1] += 1);
        starts[0] = self.items.len();
        for i in 0..grid.len() {
            starts[i + 1] += starts[i];
        }
        self.items.resize(starts[grid.len()], Item { cluster: 0, mask: 0 });
        let mut next = starts.clone();
        for &(voxel, item) in &self.parts {
            self.items[next[voxel as usize]] = item;
            next[voxel as usize] += 1;
        }
        starts
    }

    /// The voxels of `grid` that the box of an item overlaps.
    fn range(&self, item: Item, grid: &Grid) -> [Range<u32>; 3] {
        let bounds = self.arena.clusters[item.cluster as usize].bounds(item.mask);
        std::array::from_fn(|axis| {
            let index = |x: f64| ((x - grid.lo[axis]) / grid.cell) as u32;
            let last = grid.dims[axis] - 1;
            let lo = index(f64::from(bounds.lo[axis].next_down()) - self.margin).min(last);
            let hi = index(f64::from(bounds.hi[axis].next_up()) + self.margin).min(last);
            lo..hi + 1
        })
    }

    /// Lists the voxels of `grid` that an item overlaps.
    #[inline(always)]
    fn scatter(&self, item: Item, grid: &Grid, parts: &mut Vec<(u32, Item)>) {
        let cluster = &self.arena.clusters[item.cluster as usize];
        let range = self.range(item, grid);
        let alone = range.iter().all(|r| r.len() == 1);
        let corners = cluster.lanes(self.lanes);
        let strides = grid.strides();
        for z in range[2].clone() {
            for y in range[1].clone() {
                for x in range[0].clone() {
                    let cube = Cube { lo: grid.corner([x, y, z]), side: grid.cell };
                    let inside = if alone {
                        0xff
                    } else {
                        overlapping(self.lanes, corners, &cube.enlarged(self.margin)) as u8
                    };
                    let mask = item.mask & inside;
                    if mask != 0 {
                        let voxel = x * strides[0] + y * strides[1] + z * strides[2];
                        parts.push((voxel, Item { mask, ..item }));
                    }
                }
            }
        }
    }

    /// The lengths of the arena's arrays.
    fn mark(&self) -> [usize; 4] {
        let a = &self.arena;
        [a.words.len(), a.references.len(), a.bricks.len(), a.groups.len()]
    }

    /// Takes back what was made since `mark`.
    fn roll_back(&mut self, [words, references, bricks, groups]: [usize; 4]) {
        self.arena.words.truncate(words);
        self.arena.references.truncate(references);
        self.arena.bricks.truncate(bricks);
        self.arena.groups.truncate(groups);
    }

    /// Fails where what is held and `more` bytes exceed the limit.
    fn check_memory(&self, more: usize) -> Result<(), BuildError> {
        let work = size_of_val(&*self.items) + size_of_val(&*self.parts);
        let needed = self.arena.bytes() + work + more;
        if needed > self.limits.memory {
            return Err(BuildError::MemoryLimit { limit: self.limits.memory, needed });
        }
        Ok(())
    }
}
