//! The header of a file: what there is to read, and the structure's parameters.

use bytemuck::{Pod, Zeroable, bytes_of};

use crate::arena::{Arena, BoxGroup, Brick, Form, Grid, Reference, VoxelWord};
use crate::build::{HybridParams, OctreeParams, RecursiveParams, Structure, UniformParams};
use crate::cluster::Cluster;
use crate::mesh::TriMesh;
use crate::validate::Violation;

/// An array of the arena.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Section {
    /// The length of the array.
    pub(crate) items: u64,
    /// The CRC-32 of its bytes.
    pub(crate) checksum: u32,
    padding: u32,
}

/// The top grid.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct GridRecord {
    lo: [f64; 3],
    cell: f64,
    dims: [u32; 3],
    padding: u32,
}

/// The first bytes of a file; the table is that of [`Scene::save`](crate::Scene::save).
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Header {
    pub(crate) magic: [u8; 8],
    pub(crate) version: u32,
    kind: u32,
    params: [u32; 8],
    triangles: u64,
    grid: GridRecord,
    pub(crate) sections: [Section; 5],
    padding: u32,
    checksum: u32,
}

const _: () = assert!(size_of::<Header>() == 3 * super::ALIGN);
const _: () = {
    let [cluster, word, reference, brick, group] = Header::ITEM_BYTES;
    assert!(size_of::<Cluster>() == cluster && size_of::<VoxelWord>() == word);
    assert!(size_of::<Reference>() == reference && size_of::<Brick>() == brick);
    assert!(size_of::<BoxGroup>() == group);
};

impl Header {
    /// A byte that no text has, the name, and a line end that a transfer as text would change.
    pub(crate) const MAGIC: [u8; 8] = *b"\x89ogrid\r\n";
    /// The version of the format. Any change of a type in the arena needs another one.
    pub(crate) const VERSION: u32 = 3;
    /// The bytes of an item of each section.
    pub(crate) const ITEM_BYTES: [usize; 5] = [320, 4, 4, 48, 448];

    pub(super) fn new(structure: &Structure, triangles: usize, arena: &Arena, sections: [&[u8]; 5]) -> Self {
        debug_assert_eq!(form(structure), arena.form);
        let (kind, params) = encode(structure);
        let Grid { lo, cell, dims, .. } = arena.grid;
        let section = |i: usize| Section {
            items: (sections[i].len() / Self::ITEM_BYTES[i]) as u64,
            checksum: crc32fast::hash(sections[i]),
            padding: 0,
        };
        let mut header = Self {
            magic: Self::MAGIC,
            version: Self::VERSION,
            kind,
            params,
            triangles: triangles as u64,
            grid: GridRecord { lo, cell, dims, padding: 0 },
            sections: std::array::from_fn(section),
            padding: 0,
            checksum: 0,
        };
        header.seal();
        header
    }

    /// Sets the checksum.
    pub(crate) fn seal(&mut self) {
        self.checksum = self.sum();
    }

    /// Whether the header is as it was written.
    pub(super) fn is_whole(&self) -> bool {
        self.checksum == self.sum()
    }

    fn sum(&self) -> u32 {
        let bytes = bytes_of(self);
        crc32fast::hash(&bytes[..bytes.len() - size_of_val(&self.checksum)])
    }

    /// The top grid, whatever its numbers.
    pub(super) fn grid(&self) -> Grid {
        Grid::new(self.grid.lo, self.grid.cell, self.grid.dims)
    }

    /// The number of triangles of the mesh.
    pub(super) fn triangles(&self) -> Result<usize, Violation> {
        let fits = usize::try_from(self.triangles).ok().filter(|&n| n <= TriMesh::MAX_TRIANGLES);
        fits.ok_or_else(|| Violation(format!("{} triangles are more than fit", self.triangles)))
    }

    /// The structure, its parameters in their ranges, the form of its grid, and nothing but zeros elsewhere.
    pub(super) fn structure(&self) -> Result<Structure, Violation> {
        let structure = decode(self.kind, &self.params)
            .filter(|structure| encode(structure) == (self.kind, self.params))
            .ok_or_else(|| Violation(format!("structure {} {:?} is unknown", self.kind, self.params)))?;
        structure.check().map_err(|error| Violation(error.to_string()))?;
        let zeros = self.padding == 0
            && self.grid.padding == 0
            && self.sections.iter().all(|section| section.padding == 0);
        // Its walk starts in the one voxel.
        let one = !matches!(structure, Structure::Octree(_)) || self.grid.dims == [1; 3];
        match (zeros, one) {
            (true, true) => Ok(structure),
            (false, _) => Err(Violation("padding of the header".to_owned())),
            (_, false) => Err(Violation(format!("an octree with a top grid of {:?} voxels", self.grid.dims))),
        }
    }
}

/// How a structure is stored.
pub(super) fn form(structure: &Structure) -> Form {
    match structure {
        Structure::Brute => Form::BRUTE,
        Structure::Uniform(_) => Form::Lists { divisions: 1 },
        Structure::Recursive(p) => Form::Lists { divisions: p.divisions },
        Structure::Octree(_) => Form::Lists { divisions: 2 },
        Structure::Hybrid(_) => Form::Bricks,
    }
}

fn encode(structure: &Structure) -> (u32, [u32; 8]) {
    match *structure {
        Structure::Uniform(p) => (1, words([p.density.to_bits()])),
        Structure::Recursive(p) => (2, words([p.threshold, p.divisions, p.top_grid.into()])),
        Structure::Octree(p) => (3, words([p.threshold, p.plane_weight])),
        Structure::Hybrid(p) => {
            let [group, brick, voxel] = [p.group_cost, p.brick_cost, p.voxel_cost].map(f32::to_bits);
            (4, words([p.density.to_bits(), p.levels, group, brick, voxel]))
        }
        Structure::Brute => (5, words([])),
    }
}

fn words<const N: usize>(params: [u32; N]) -> [u32; 8] {
    std::array::from_fn(|i| params.get(i).copied().unwrap_or(0))
}

fn decode(kind: u32, params: &[u32; 8]) -> Option<Structure> {
    let number = |i: usize| f32::from_bits(params[i]);
    Some(match kind {
        1 => Structure::Uniform(UniformParams { density: number(0) }),
        2 => Structure::Recursive(RecursiveParams {
            threshold: params[0],
            divisions: params[1],
            top_grid: params[2] != 0,
        }),
        3 => Structure::Octree(OctreeParams { threshold: params[0], plane_weight: params[1] }),
        4 => Structure::Hybrid(HybridParams {
            density: number(0),
            levels: params[1],
            group_cost: number(2),
            brick_cost: number(3),
            voxel_cost: number(4),
        }),
        5 => Structure::Brute,
        _ => return None,
    })
}
