//! A structure taken apart for the tests of coverage: its undivided voxels, and which a walk visits.

use std::ops::ControlFlow;

use glam::Vec3;

use super::lattice::Lattice;
use crate::aabb::Aabb;
use crate::arena::{Arena, Form, Voxel, VoxelWord};
use crate::build::{self, Structure};
use crate::dda::{BRICK_MARGIN, LIST_MARGIN};
use crate::lanes::WIDE;
use crate::mesh::TriMesh;
use crate::ray::Ray;
use crate::traverse::Visit;
use crate::validate::validate;

/// Which datum of the arena a walk reads when it visits a voxel.
#[derive(Clone, Copy)]
pub(super) enum Slot {
    Word(usize),
    /// An empty voxel of that brick.
    Brick(usize),
}

/// A box in the grid.
#[derive(Clone, Copy, Debug)]
pub(super) enum Place {
    /// A cube with this lower corner and side, in parts of the top grid's cells.
    Cube([u64; 3], u64),
    /// Lower and upper corner, in cells.
    Box([[f64; 3]; 2]),
}

impl Place {
    /// Lower and upper corner, in cells of so many parts.
    pub(super) fn corners(&self, parts: u64) -> [[f64; 3]; 2] {
        match *self {
            Self::Cube(lo, side) => [lo, lo.map(|i| i + side)].map(|at| at.map(|i| i as f64 / parts as f64)),
            Self::Box(corners) => corners,
        }
    }

    /// The part of a box that lies in this place, of cells of so many parts.
    fn clip(&self, [lo, hi]: [[f64; 3]; 2], parts: u64) -> Option<Self> {
        let [own_lo, own_hi] = self.corners(parts);
        let lo: [f64; 3] = std::array::from_fn(|axis| lo[axis].max(own_lo[axis]));
        let hi: [f64; 3] = std::array::from_fn(|axis| hi[axis].min(own_hi[axis]));
        (0..3).all(|axis| lo[axis] <= hi[axis]).then_some(Self::Box([lo, hi]))
    }
}

/// An undivided voxel, or what of a voxel is around its brick.
pub(super) struct Leaf {
    pub(super) place: Place,
    /// The brick.
    pub(super) hole: Option<Place>,
    pub(super) slot: Slot,
    pub(super) clusters: Vec<u32>,
    /// The boxes of the clusters, in cells; none in lists.
    pub(super) boxes: Vec<[[f32; 3]; 2]>,
}

/// A structure, its leaves and where they are.
pub(super) struct Subject {
    pub(super) arena: Arena,
    pub(super) parts: u64,
    pub(super) leaves: Vec<Leaf>,
    /// The margin that voxels are built with.
    pub(super) margin: f64,
    pub(super) bounds: Aabb,
}

impl Subject {
    pub(super) fn new(mesh: &TriMesh<'_>, structure: Structure) -> Self {
        let (_, arena) = build::build(mesh, &structure.into()).unwrap();
        let depth = validate(&arena, mesh.len()).unwrap().depth as u32;
        let parts = match arena.form {
            Form::Lists { divisions } => u64::from(divisions).pow(depth),
            Form::Bricks => 1,
        };
        let margin = if arena.form == Form::Bricks { BRICK_MARGIN } else { LIST_MARGIN };
        let margin = margin * arena.grid.cell * f64::from(arena.grid.longest());
        let bounds = arena.bounds();
        let mut subject = Self { arena, parts, leaves: Vec::new(), margin, bounds };
        let dims = subject.arena.grid.dims.map(|n| n as usize);
        for i in 0..subject.arena.grid.len() {
            let at = [i % dims[0], i / dims[0] % dims[1], i / dims[0] / dims[1]];
            subject.voxel(Slot::Word(i), Place::Cube(at.map(|x| x as u64 * parts), parts));
        }
        subject
    }

    fn voxel(&mut self, slot: Slot, place: Place) {
        let word = match slot {
            Slot::Word(word) => self.arena.words[word],
            Slot::Brick(_) => VoxelWord::EMPTY,
        };
        let mut leaf = Leaf { place, hole: None, slot, clusters: Vec::new(), boxes: Vec::new() };
        match (word.get(), place) {
            (Voxel::Node(first), Place::Cube(lo, side)) if self.arena.form != Form::Bricks => {
                return self.parts(first as usize, lo, side);
            }
            (Voxel::Node(first), _) => return self.brick(first as usize, leaf),
            (Voxel::Leaf(first), _) => self.list(first as usize, &mut leaf),
            (Voxel::Empty, _) => {}
        }
        self.leaves.push(leaf);
    }

    fn parts(&mut self, first: usize, lo: [u64; 3], side: u64) {
        let n = self.arena.form.divisions() as usize;
        for i in 0..n * n * n {
            let (at, side) = ([i % n, i / n % n, i / n / n], side / n as u64);
            let lo = std::array::from_fn(|axis| lo[axis] + at[axis] as u64 * side);
            self.voxel(Slot::Word(first + i), Place::Cube(lo, side));
        }
    }

    /// The voxels of a brick, and what is around them, in the voxel that it divides.
    fn brick(&mut self, index: usize, around: Leaf) {
        let brick = self.arena.bricks[index];
        let plane =
            |axis: usize, i: usize| f64::from(brick.lo[axis]) + i as f64 * f64::from(brick.side[axis]);
        let corners = |from: [usize; 3], n: usize| {
            [0, n].map(|n| std::array::from_fn(|axis| plane(axis, from[axis] + n)))
        };
        let place = around.place;
        self.leaves.push(Leaf {
            hole: Some(Place::Box(corners([0; 3], 4))),
            slot: Slot::Brick(index),
            ..around
        });
        let mut next = brick.first as usize;
        for i in 0..64 {
            let mut slot = Slot::Brick(index);
            if brick.occupied >> i & 1 != 0 {
                slot = Slot::Word(next);
                next += 1;
            }
            if let Some(place) = place.clip(corners([i % 4, i / 4 % 4, i / 16], 1), self.parts) {
                self.voxel(slot, place);
            }
        }
    }

    fn list(&self, first: usize, leaf: &mut Leaf) {
        if self.arena.form != Form::Bricks {
            let list = &self.arena.references[first..];
            let last = list.iter().position(|reference| reference.is_last()).unwrap();
            leaf.clusters = list[..=last].iter().map(|reference| reference.cluster()).collect();
            return;
        }
        let groups = &self.arena.groups[first..];
        let last = groups.iter().position(|group| group.clusters[0].is_last()).unwrap();
        for group in &groups[..=last] {
            for lane in (0..WIDE).filter(|&lane| group.planes[0][0][lane] != f32::INFINITY) {
                leaf.clusters.push(group.clusters[lane].cluster());
                leaf.boxes.push(group.planes.map(|side| side.map(|axis| axis[lane])));
            }
        }
    }

    pub(super) fn lattice(&self, mesh: &TriMesh<'_>, rays: &[Ray]) -> Lattice {
        let vertices = mesh.vertices().iter().map(|&v| Vec3::from_array(v));
        let points = vertices.chain(rays.iter().map(|ray| ray.origin));
        let values = points.flat_map(|p| p.as_dvec3().to_array()).chain([0.0625 * self.margin]);
        Lattice::new(&self.arena.grid, self.parts, values)
    }

    /// False only where a leaf is certainly far from a box.
    pub(super) fn are_near(&self, leaf: &Leaf, bounds: &Aabb) -> bool {
        let grid = &self.arena.grid;
        let corners = leaf.place.corners(self.parts);
        (0..3).all(|axis| {
            let plane = |i: usize| grid.lo[axis] + corners[i][axis] * grid.cell;
            let [lo, hi] = [bounds.lo[axis], bounds.hi[axis]].map(f64::from);
            let slack = 2.0 * self.margin + 1e-9 * (lo.abs() + hi.abs());
            plane(0) - slack <= hi && lo <= plane(1) + slack
        })
    }
}

/// Notes the voxels that a walk visits, by what it reads.
pub(super) struct Visited<'a> {
    arena: &'a Arena,
    words: Vec<bool>,
    bricks: Vec<bool>,
    /// Whether clusters came without voxels, for a ray that no walk can follow.
    pub(super) all: bool,
}

impl<'a> Visited<'a> {
    pub(super) fn new(arena: &'a Arena) -> Self {
        let (words, bricks) = (vec![false; arena.words.len()], vec![false; arena.bricks.len()]);
        Self { arena, words, bricks, all: false }
    }

    pub(super) fn has(&self, slot: Slot) -> bool {
        match slot {
            Slot::Word(word) => self.words[word],
            Slot::Brick(brick) => self.bricks[brick],
        }
    }
}

impl Visit for Visited<'_> {
    fn read<T>(&mut self, data: &T) {
        fn index<T, U>(data: &T, of: &[U]) -> Option<usize> {
            let offset = std::ptr::from_ref(data).addr().checked_sub(of.as_ptr().addr())?;
            Some(offset / size_of::<U>()).filter(|&i| i < of.len())
        }
        if let Some(word) = index(data, &self.arena.words) {
            self.words[word] = true;
        }
        if let Some(brick) = index(data, &self.arena.bricks) {
            self.bricks[brick] = true;
        }
    }

    fn cluster(&mut self, _: u32) -> ControlFlow<()> {
        self.all |= !self.words.contains(&true);
        ControlFlow::Continue(())
    }

    fn t_max(&self) -> f32 {
        f32::INFINITY
    }
}
