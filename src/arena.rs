//! The arena: every structure as flat arrays of plain data.
//!
//! All four structures share it. `words` starts with the voxels of the top grid (one for the octree),
//! x fastest, and goes on with the voxels of divided ones:
//!
//! - a **list** structure (uniform, recursive, octree) keeps all N x N x N voxels of a divided voxel
//!   together, x fastest, and its leaves are runs of [`Reference`]s to clusters;
//! - a **brick** structure (hybrid) keeps only the occupied ones of the 64, behind a [`Brick`] with
//!   their mask, and its leaves are runs of [`BoxGroup`]s.
//!
//! Brute force has clusters alone: a list structure of one level without words.

use bytemuck::{Pod, Zeroable};
use glam::Vec4;

use crate::aabb::Aabb;
use crate::cluster::Cluster;
use crate::lanes::WIDE;

/// A voxel in 32 bits: empty, a leaf, or divided.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub(crate) struct VoxelWord(u32);

/// What a [`VoxelWord`] says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Voxel {
    /// No triangles.
    Empty,
    /// The index of the first reference (list) or box group (brick).
    Leaf(u32),
    /// The index of the first voxel word (list) or of the brick.
    Node(u32),
}

impl VoxelWord {
    pub(crate) const EMPTY: Self = Self(0);
    const LEAF: u32 = 1 << 31;

    /// A leaf; `None` where the index has more than 31 bits.
    pub(crate) fn leaf(first: usize) -> Option<Self> {
        let first = u32::try_from(first).ok().filter(|i| i & Self::LEAF == 0)?;
        Some(Self(Self::LEAF | first))
    }

    /// A divided voxel; `None` where the index does not fit.
    pub(crate) fn node(first: usize) -> Option<Self> {
        let word = u32::try_from(first).ok()?.checked_add(1)?;
        (word & Self::LEAF == 0).then_some(Self(word))
    }

    /// What it says.
    #[inline(always)]
    pub(crate) fn get(self) -> Voxel {
        match self.0 {
            0 => Voxel::Empty,
            word if word & Self::LEAF != 0 => Voxel::Leaf(word & !Self::LEAF),
            word => Voxel::Node(word - 1),
        }
    }
}

/// A reference to a cluster, and whether it is the last one of its leaf.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub(crate) struct Reference(u32);

impl Reference {
    const LAST: u32 = 1 << 31;

    /// There are never more than 2^31 - 1 triangles, so never more clusters.
    pub(crate) fn new(cluster: u32, last: bool) -> Self {
        debug_assert!(cluster & Self::LAST == 0);
        Self(cluster | if last { Self::LAST } else { 0 })
    }

    #[inline(always)]
    pub(crate) fn cluster(self) -> u32 {
        self.0 & !Self::LAST
    }

    #[inline(always)]
    pub(crate) fn is_last(self) -> bool {
        self.0 & Self::LAST != 0
    }
}

/// The occupied ones of 4 x 4 x 4 voxels that fill a box around all that is in the divided voxel.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Brick {
    /// The box's lower corner by axis, relative to the grid's, in cells of the top grid; the fourth lane repeats the
    /// third.
    pub(crate) lo: Vec4,
    /// The sides of a voxel, above 0, likewise.
    pub(crate) side: Vec4,
    /// Bit x + 4 y + 16 z: that voxel is not empty.
    pub(crate) occupied: u64,
    /// The index of the word of the first occupied voxel; the others follow in the order of the bits.
    pub(crate) first: u32,
    /// Zero.
    pub(crate) padding: u32,
}

/// Up to sixteen cluster boxes, clipped to the voxel that they lie in, each operand in one cache line.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(64))]
pub(crate) struct BoxGroup {
    /// Lower and upper corners by axis and lane, relative to the grid's lower corner, in cells of the
    /// top grid. Lanes without a cluster hold a box at infinity, which no path reaches.
    pub(crate) planes: [[[f32; WIDE]; 3]; 2],
    /// The clusters. The first carries whether the group is the last of its leaf.
    pub(crate) clusters: [Reference; WIDE],
}

const _: () = assert!(size_of::<VoxelWord>() == 4 && size_of::<Reference>() == 4);
const _: () = assert!(size_of::<Brick>() == 48 && size_of::<BoxGroup>() == 448);

/// The uniform grid on top: cubic voxels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Grid {
    /// The lower corner.
    pub(crate) lo: [f64; 3],
    /// The side of a voxel, above 0.
    pub(crate) cell: f64,
    /// The number of voxels along each axis, at least 1.
    pub(crate) dims: [u32; 3],
    /// The same for the walks.
    pub(crate) axes: GridAxes,
}

/// What each query needs of a grid, an axis a lane; the fourth lane is that of an axis at 0 with one voxel of
/// infinite width.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct GridAxes {
    /// The lower corner.
    pub(crate) lo: [f64; 4],
    /// The width.
    pub(crate) size: [f64; 4],
    /// Where the box around the scene begins and ends, from either side of the grid.
    pub(crate) near: [f64; 4],
    pub(crate) far: [f64; 4],
    /// The number of voxels.
    pub(crate) dims: [f64; 4],
    /// The distance in `words` between neighbours.
    pub(crate) strides: [f64; 4],
    /// Voxels a unit of length.
    pub(crate) per_length: f64,
}

impl Grid {
    pub(crate) fn new(lo: [f64; 3], cell: f64, dims: [u32; 3]) -> Self {
        let [x, y, z] = dims.map(f64::from);
        let axes = GridAxes {
            lo: [lo[0], lo[1], lo[2], 0.0],
            size: [x * cell, y * cell, z * cell, f64::INFINITY],
            near: [0.0; 4],
            far: [x * cell, y * cell, z * cell, f64::INFINITY],
            dims: [x, y, z, 1.0],
            strides: [1.0, x, x * y, 0.0],
            per_length: 1.0 / cell,
        };
        Self { lo, cell, dims, axes }
    }

    /// The same with a box around the scene that is no larger than the scene by much: it begins on both sides where
    /// the wider one of two margins ends, but for 2^-32 of the grid's width, for rounding.
    pub(crate) fn fitted(mut self, bounds: &Aabb) -> Self {
        for axis in 0..3 {
            let size = self.axes.size[axis];
            let below = f64::from(bounds.lo[axis]) - self.lo[axis];
            let above = size - (f64::from(bounds.hi[axis]) - self.lo[axis]);
            let near = below.min(above) - size / (1u64 << 32) as f64;
            // A scene without triangles has infinite bounds.
            if near > 0.0 && near.is_finite() {
                self.axes.near[axis] = near;
                self.axes.far[axis] = size - near;
            }
        }
        self
    }

    /// The number of voxels.
    pub(crate) fn len(&self) -> usize {
        self.dims.iter().map(|&n| n as usize).product()
    }

    /// The most voxels along an axis.
    pub(crate) fn longest(&self) -> u32 {
        self.dims[0].max(self.dims[1]).max(self.dims[2])
    }

    /// The distance in `words` between neighbours along each axis.
    pub(crate) fn strides(&self) -> [u32; 3] {
        [1, self.dims[0], self.dims[0] * self.dims[1]]
    }

    /// Voxels twice as wide around the same middle, so that what was inside is so by no smaller part.
    pub(crate) fn coarser(&self) -> Self {
        let odd = self.dims.map(|n| 0.5 * f64::from(n % 2) * self.cell);
        let lo = std::array::from_fn(|axis| self.lo[axis] - odd[axis]);
        Self::new(lo, 2.0 * self.cell, self.dims.map(|n| n.div_ceil(2)))
    }
}

/// How divided voxels and leaves are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Form {
    /// N x N x N words; leaves of references.
    Lists {
        /// N.
        divisions: u32,
    },
    /// Bricks; leaves of box groups.
    Bricks,
}

impl Form {
    /// That of clusters without voxels.
    pub(crate) const BRUTE: Self = Self::Lists { divisions: 1 };

    /// The number of parts along each axis of a divided voxel.
    pub(crate) fn divisions(self) -> u32 {
        match self {
            Self::Lists { divisions } => divisions,
            Self::Bricks => 4,
        }
    }
}

/// The most levels of divided voxels in a list structure.
pub(crate) const LIST_LEVELS: u32 = 22;

/// The most levels of bricks.
pub(crate) const BRICK_LEVELS: u32 = 8;

/// A voxel structure.
#[derive(Clone, Debug)]
pub(crate) struct Arena {
    pub(crate) grid: Grid,
    pub(crate) form: Form,
    pub(crate) clusters: Vec<Cluster>,
    pub(crate) words: Vec<VoxelWord>,
    pub(crate) references: Vec<Reference>,
    pub(crate) bricks: Vec<Brick>,
    pub(crate) groups: Vec<BoxGroup>,
}

impl Arena {
    /// Nothing yet.
    pub(crate) fn new(grid: Grid, form: Form) -> Self {
        let (clusters, words, references, bricks, groups) = Default::default();
        Self { grid, form, clusters, words, references, bricks, groups }
    }

    /// Whether there are no voxels, only clusters.
    pub(crate) fn is_brute(&self) -> bool {
        self.form == Form::BRUTE && self.words.is_empty()
    }

    /// The box around all triangles.
    #[cfg(any(feature = "file", all(test, feature = "oracle")))]
    pub(crate) fn bounds(&self) -> Aabb {
        use crate::lanes::{Isa, dispatch};
        dispatch!(Isa::detect(), lanes => {
            let boxes = self.clusters.iter().map(
                #[inline(always)]
                |cluster| cluster.bounds(lanes, cluster.occupied()),
            );
            boxes.fold(Aabb::EMPTY, Aabb::union)
        })
    }

    /// Bytes by kind.
    pub(crate) fn bytes_by_kind(&self) -> [(&'static str, usize); 5] {
        [
            ("clusters", size_of_val(&*self.clusters)),
            ("voxels", size_of_val(&*self.words)),
            ("references", size_of_val(&*self.references)),
            ("bricks", size_of_val(&*self.bricks)),
            ("boxes", size_of_val(&*self.groups)),
        ]
    }

    /// All bytes.
    pub(crate) fn bytes(&self) -> usize {
        self.bytes_by_kind().iter().map(|(_, bytes)| bytes).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_say_what_they_were_made_of() {
        assert_eq!(VoxelWord::EMPTY.get(), Voxel::Empty);
        assert_eq!(VoxelWord::leaf(0).unwrap().get(), Voxel::Leaf(0));
        assert_eq!(VoxelWord::leaf(0x7fff_ffff).unwrap().get(), Voxel::Leaf(0x7fff_ffff));
        assert_eq!(VoxelWord::node(0).unwrap().get(), Voxel::Node(0));
        assert_eq!(VoxelWord::node(0x7fff_fffe).unwrap().get(), Voxel::Node(0x7fff_fffe));
        assert_eq!(VoxelWord::leaf(0x8000_0000), None);
        assert_eq!(VoxelWord::node(0x7fff_ffff), None);
        assert_eq!(VoxelWord::node(usize::MAX), None);
    }

    #[test]
    fn references_end_with_the_last() {
        let r = Reference::new(5, true);
        assert_eq!((r.cluster(), r.is_last()), (5, true));
        let r = Reference::new(5, false);
        assert_eq!((r.cluster(), r.is_last()), (5, false));
    }
}
