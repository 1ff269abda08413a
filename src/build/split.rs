//! The build driver: clusters into the voxels of the top grid, and these into pieces of the arena.
//!
//! ```text
//! place the grid, list the clusters in each of its voxels, and sort them by it
//! make pieces of neighbouring voxels   in parallel
//! join the pieces
//! ```
//!
//! What the pieces are depends on the clusters alone, so that the result is the same for any number of
//! threads.

use std::ops::Range;
use std::sync::atomic::AtomicUsize;

use super::divide::{Divider, Space};
use super::options::BuildError;
use super::piece::{self, Piece};
use super::policy::Policy;
use super::voxel::{Item, Voxels, scatter};
use crate::arena::{Arena, Grid, VoxelWord};
use crate::cluster::Cluster;
use crate::lanes::Lanes;
use crate::parallel;

/// Builds the voxels over `clusters`.
pub(crate) fn build<L: Lanes + Sync, P: Policy>(
    lanes: L,
    policy: &P,
    clusters: Vec<Cluster>,
    limits: Limits,
) -> Result<Arena, BuildError> {
    let whole = whole_items(lanes, &clusters);
    let grid = place_grid(policy.grid(), &whole, &limits);
    // Before it is there: a word, and where the items of a voxel start.
    let voxels = grid.len() * (size_of::<VoxelWord>() + size_of::<usize>());
    limits.check(size_of_val(&*clusters) + size_of_val(&*whole) + voxels)?;
    let space = Space { lanes, policy, clusters: &clusters, grid: &grid, limits, held: AtomicUsize::new(0) };
    let lists = listed(&space, &whole)?;
    let (order, starts) = sorted(&lists, grid.len());
    let parts = portions(&starts);
    let pieces: Result<Vec<Piece>, _> =
        parallel::map(&parts, |part| piece(&space, part.clone(), &lists, &order, &starts))
            .into_iter()
            .collect();
    let mut arena = Arena { clusters, ..Arena::new(grid, policy.form()) };
    piece::join(&mut arena, pieces?)?;
    limits.check(arena.bytes())?;
    Ok(arena)
}

/// All clusters.
fn whole_items<L: Lanes + Sync>(lanes: L, clusters: &[Cluster]) -> Vec<Item> {
    let indices: Vec<u32> = (0..clusters.len() as u32).collect();
    parallel::map(&indices, |&i| {
        lanes.vectorize(
            #[inline(always)]
            || Item::whole(lanes, i, &clusters[i as usize]),
        )
    })
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

impl Limits {
    /// The margin as a length.
    pub(super) fn margin_in(&self, grid: &Grid) -> f64 {
        self.margin * (grid.cell * f64::from(grid.longest()))
    }

    /// The least side as a length.
    pub(super) fn least_side_in(&self, grid: &Grid) -> f64 {
        self.least_side * (grid.cell * f64::from(grid.longest()))
    }

    /// Fails where `needed` bytes exceed the limit.
    pub(super) fn check(&self, needed: usize) -> Result<(), BuildError> {
        let limit = self.memory;
        if needed > limit { Err(BuildError::MemoryLimit { limit, needed }) } else { Ok(()) }
    }
}

/// Items to be worked on together.
const PORTION: usize = 1024;

/// The policy's grid or, where its voxels would have too many references, the next coarser one: large
/// triangles one above the other would be in all of them.
fn place_grid(mut grid: Grid, items: &[Item], limits: &Limits) -> Grid {
    while grid.len() > 1 && estimate(items, &grid, limits) > limits.references as f64 {
        grid = grid.coarser();
    }
    grid
}

/// About how many references the voxels of a grid would have, seldom less: all voxels in the box of a
/// cluster, or as many as three planes may meet of them.
fn estimate(items: &[Item], grid: &Grid, limits: &Limits) -> f64 {
    let (margin, cells) = (limits.margin_in(grid), Voxels::from(grid));
    let voxels = |item: &Item| {
        let [x, y, z] = cells.range(&item.bounds, margin).map(|range| range.len() as f64);
        (x * y * z).min(3.0 * (x * y + y * z + z * x))
    };
    let portions: Vec<&[Item]> = items.chunks(PORTION).collect();
    parallel::map(&portions, |items| items.iter().map(voxels).sum::<f64>()).into_iter().sum()
}

/// Items with the voxels of the grid that they are in, by portions of the clusters.
type Lists = Vec<Vec<(u32, Item)>>;

fn listed<L: Lanes + Sync, P: Policy>(space: &Space<'_, L, P>, whole: &[Item]) -> Result<Lists, BuildError> {
    let portions: Vec<&[Item]> = whole.chunks(PORTION).collect();
    let lists: Lists =
        parallel::map(&portions, |items| list(space, items)).into_iter().collect::<Result<_, _>>()?;
    let listed = lists.iter().map(Vec::len).sum::<usize>();
    let work = listed * (size_of::<(u32, Item)>() + size_of::<Listed>());
    space.limits.check(size_of_val(space.clusters) + size_of_val(whole) + work)?;
    Ok(lists)
}

/// One of the lists, and the place in it.
type Listed = [u32; 2];

/// What is listed in the order of its voxels, and where each of these starts, and the end.
fn sorted(lists: &Lists, voxels: usize) -> (Vec<Listed>, Vec<usize>) {
    let (mut order, mut starts) = (Vec::new(), Vec::new());
    let places = lists.iter().enumerate().flat_map(|(list, items)| {
        items.iter().enumerate().map(move |(i, (voxel, _))| (*voxel, [list as u32, i as u32]))
    });
    sort(places, voxels, [0; 2], &mut order, &mut starts);
    (order, starts)
}

/// Lists the items with the voxels of the grid that they overlap.
fn list<L: Lanes + Sync, P: Policy>(
    space: &Space<'_, L, P>,
    items: &[Item],
) -> Result<Vec<(u32, Item)>, BuildError> {
    let (margin, cells) = (space.limits.margin_in(space.grid), Voxels::from(space.grid));
    let mut list = Vec::with_capacity(items.len());
    space.lanes.vectorize(
        #[inline(always)]
        || {
            for item in items {
                scatter(space.lanes, space.clusters, item, &cells, margin, |voxel, item| {
                    list.push((voxel, item));
                });
                let work = list.len() * (size_of::<(u32, Item)>() + size_of::<Listed>());
                space.limits.check(size_of_val(space.clusters) + work)?;
            }
            Ok(())
        },
    )?;
    Ok(list)
}

/// Sorts what is listed by voxel, on top of `sorted`, and puts where that of each of the `voxels` starts, and
/// the end, on top of `starts`. Counting sort: within a voxel the order stays.
pub(super) fn sort<T: Copy>(
    list: impl DoubleEndedIterator<Item = (u32, T)> + Clone,
    voxels: usize,
    none: T,
    sorted: &mut Vec<T>,
    starts: &mut Vec<usize>,
) {
    let base = starts.len();
    starts.resize(base + voxels + 1, 0);
    let starts = &mut starts[base..];
    list.clone().for_each(|(voxel, _)| starts[voxel as usize] += 1);
    let mut end = sorted.len();
    for start in &mut *starts {
        end += *start;
        *start = end;
    }
    sorted.resize(end, none);
    // From the last to the first, so that the end of each voxel moves to its start.
    for (voxel, item) in list.rev() {
        starts[voxel as usize] -= 1;
        sorted[starts[voxel as usize]] = item;
    }
}

/// Neighbouring voxels, together with about as many items as are worth a piece.
fn portions(starts: &[usize]) -> Vec<Range<usize>> {
    let mut portions = Vec::new();
    let mut first = 0;
    for end in 1..starts.len() {
        if starts[end] - starts[first] >= PORTION || end + 1 == starts.len() {
            portions.push(first..end);
            first = end;
        }
    }
    portions
}

/// Makes the voxels of a part of the grid.
fn piece<L: Lanes + Sync, P: Policy>(
    space: &Space<'_, L, P>,
    voxels: Range<usize>,
    lists: &Lists,
    order: &[Listed],
    starts: &[usize],
) -> Result<Piece, BuildError> {
    let own = starts[voxels.end] - starts[voxels.start];
    // Each piece may have as many references for an item as the others.
    let share = own as f64 / order.len().max(1) as f64;
    let mut divider = Divider::new(space, (share * space.limits.references as f64) as usize);
    let cells = Voxels::from(space.grid);
    for i in voxels {
        let items =
            order[starts[i]..starts[i + 1]].iter().map(|&[list, i]| lists[list as usize][i as usize].1);
        divider.top_voxel(cells.nth(i), items)?;
    }
    Ok(divider.piece())
}
