//! Every invariant of an arena, proved, and its statistics.

use std::fmt;

use glam::Vec4;

use crate::arena::{Arena, BRICK_LEVELS, Form, Grid, LIST_LEVELS, Voxel, VoxelWord};
use crate::cluster::Cluster;
use crate::lanes::{WIDE, WIDTH};

/// What a structure is made of. Prints as lines of a name and a value.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Statistics {
    /// Triangles of the mesh.
    pub triangles: usize,
    /// Of these, left out because their area is zero.
    pub degenerate: usize,
    /// Clusters of up to 8 triangles.
    pub clusters: usize,
    /// Empty voxels that are stored.
    pub empty: usize,
    /// Voxels that are leaves.
    pub leaves: usize,
    /// Voxels that are divided.
    pub nodes: usize,
    /// References from leaves to clusters.
    pub references: usize,
    /// The most references of one leaf.
    pub largest_leaf: usize,
    /// Levels below the top grid.
    pub depth: usize,
    /// Voxels along each axis of the top grid.
    pub grid: [u32; 3],
    /// Bytes by kind.
    pub bytes: Vec<(&'static str, usize)>,
}

impl Statistics {
    /// The share of stored voxels that are not empty.
    pub fn occupancy(&self) -> f64 {
        let full = self.leaves + self.nodes;
        full as f64 / (full + self.empty).max(1) as f64
    }

    /// References a cluster.
    pub fn references_a_cluster(&self) -> f64 {
        self.references as f64 / self.clusters.max(1) as f64
    }

    /// All bytes.
    pub fn total_bytes(&self) -> usize {
        self.bytes.iter().map(|(_, bytes)| bytes).sum()
    }
}

impl fmt::Display for Statistics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.grid;
        writeln!(f, "triangles             {} ({} of zero area left out)", self.triangles, self.degenerate)?;
        writeln!(f, "clusters              {}", self.clusters)?;
        writeln!(f, "top grid              {x} x {y} x {z}")?;
        writeln!(f, "levels below          {}", self.depth)?;
        writeln!(
            f,
            "voxels                {} empty, {} leaves, {} divided",
            self.empty, self.leaves, self.nodes
        )?;
        writeln!(f, "occupancy             {:.1} %", 100.0 * self.occupancy())?;
        writeln!(f, "references a cluster  {:.2}", self.references_a_cluster())?;
        writeln!(f, "largest leaf          {} clusters", self.largest_leaf)?;
        for (kind, bytes) in &self.bytes {
            writeln!(f, "bytes of {kind:<12} {bytes}")?;
        }
        write!(f, "bytes a triangle      {:.1}", self.total_bytes() as f64 / self.triangles.max(1) as f64)
    }
}

/// An invariant that does not hold.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Violation(pub(crate) String);

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Violation {}

macro_rules! require {
    ($condition:expr, $($message:tt)*) => {
        if !$condition {
            return Err(Violation(format!($($message)*)));
        }
    };
}

/// Proves that:
/// - every triangle of the mesh is in at most one cluster, and lanes without one repeat the first;
/// - corners and the grid are finite, and the grid has its words;
/// - every word, reference, brick and box group is used by exactly one voxel, in bounds;
/// - bricks are where they can be, and their voxels have sides;
/// - there are no more levels than the walks have room for;
/// - every cluster is referred to, a leaf refers to a cluster once;
/// - padding is zero, and boxes that hold no cluster are empty.
///
/// This is all that walks rely on to stay in bounds and to end, whoever made the arena. O(size of the
/// arena), in memory too, whatever number of triangles is claimed.
pub(crate) fn validate(arena: &Arena, triangles: usize) -> Result<Statistics, Violation> {
    let stored = clusters(arena, triangles)?;
    let mut check = Check {
        arena,
        statistics: Statistics {
            triangles,
            degenerate: triangles - stored,
            clusters: arena.clusters.len(),
            grid: arena.grid.dims,
            bytes: arena.bytes_by_kind().to_vec(),
            ..Statistics::default()
        },
        words: vec![false; arena.words.len()],
        bricks: vec![false; arena.bricks.len()],
        entries: vec![false; arena.references.len().max(arena.groups.len())],
        referred: vec![usize::MAX; arena.clusters.len()],
    };
    check_grid(arena)?;
    if arena.is_brute() {
        return Ok(check.statistics);
    }
    for voxel in 0..arena.grid.len() {
        check.voxel(voxel, 0)?;
    }
    check.all_used()
}

fn check_grid(arena: &Arena) -> Result<(), Violation> {
    let Grid { lo, cell, dims, .. } = arena.grid;
    let len = dims.iter().try_fold(1u32, |len, &n| len.checked_mul(n)).unwrap_or(0);
    let is_stored = arena.is_brute() || len as usize <= arena.words.len();
    require!(len > 0 && is_stored, "the top grid of {dims:?} exceeds the words");
    require!(cell > 0.0 && cell.is_finite(), "the cell is {cell}");
    require!(lo.iter().all(|x| x.is_finite()), "the lower corner is {lo:?}");
    let foreign = match arena.form {
        _ if arena.is_brute() => arena.references.len() + arena.bricks.len() + arena.groups.len(),
        Form::Lists { .. } => arena.bricks.len() + arena.groups.len(),
        Form::Bricks => arena.references.len(),
    };
    require!(foreign == 0, "{foreign} items of another form");
    Ok(())
}

/// Returns the number of triangles.
fn clusters(arena: &Arena, triangles: usize) -> Result<usize, Violation> {
    let mut stored = Vec::new();
    for (i, cluster) in arena.clusters.iter().enumerate() {
        let occupied = cluster.occupied();
        require!(
            occupied & 1 != 0 && occupied.count_ones() == occupied.trailing_ones(),
            "gaps in cluster {i}"
        );
        require!(
            (0..WIDTH).all(|l| cluster.triangle(l).iter().all(|v| v.is_finite())),
            "corners of cluster {i}"
        );
        for (lane, &id) in cluster.ids().iter().enumerate() {
            if id == Cluster::NO_TRIANGLE {
                require!(cluster.triangle(lane) == cluster.triangle(0), "lane {lane} of cluster {i}");
                continue;
            }
            require!((id as usize) < triangles, "triangle {id} of cluster {i} is out of range");
            stored.push(id);
        }
    }
    let repeated = first_repeated(&mut stored, triangles);
    require!(repeated.is_none(), "triangle {} is repeated", repeated.unwrap_or_default());
    Ok(stored.len())
}

/// A number that occurs twice, of numbers below `end`.
fn first_repeated(numbers: &mut [u32], end: usize) -> Option<u32> {
    if end / 32 <= numbers.len() {
        let mut seen = vec![false; end];
        return numbers.iter().copied().find(|&i| std::mem::replace(&mut seen[i as usize], true));
    }
    // Slower, but with no flag for each of so many that are not there.
    numbers.sort_unstable();
    numbers.windows(2).find(|pair| pair[0] == pair[1]).map(|pair| pair[0])
}

struct Check<'a> {
    arena: &'a Arena,
    statistics: Statistics,
    /// What was met so far.
    words: Vec<bool>,
    bricks: Vec<bool>,
    entries: Vec<bool>,
    /// For each cluster the leaf that referred to it last.
    referred: Vec<usize>,
}

fn meet(seen: &mut [bool], index: usize, what: &str) -> Result<(), Violation> {
    require!(seen.get(index) == Some(&false), "{what} {index} is out of range or used twice");
    seen[index] = true;
    Ok(())
}

impl Check<'_> {
    fn voxel(&mut self, word: usize, depth: usize) -> Result<(), Violation> {
        meet(&mut self.words, word, "word")?;
        match self.arena.words[word].get() {
            Voxel::Empty => self.statistics.empty += 1,
            Voxel::Leaf(first) => {
                self.statistics.leaves += 1;
                let before = self.statistics.references;
                match self.arena.form {
                    Form::Lists { .. } => self.list(first as usize)?,
                    Form::Bricks => self.groups(first as usize)?,
                }
                let size = self.statistics.references - before;
                self.statistics.largest_leaf = self.statistics.largest_leaf.max(size);
            }
            Voxel::Node(first) => {
                self.statistics.nodes += 1;
                self.statistics.depth = self.statistics.depth.max(depth + 1);
                self.node(first as usize, depth + 1)?;
            }
        }
        Ok(())
    }

    fn node(&mut self, first: usize, depth: usize) -> Result<(), Violation> {
        let levels = match self.arena.form {
            Form::Lists { .. } => LIST_LEVELS,
            Form::Bricks => BRICK_LEVELS,
        };
        require!(depth <= levels as usize, "more than {levels} levels");
        let words = match self.arena.form {
            Form::Lists { divisions } => first..first + divisions.pow(3) as usize,
            Form::Bricks => {
                meet(&mut self.bricks, first, "brick")?;
                let brick = self.arena.bricks[first];
                require!(
                    brick.occupied != 0 && brick.padding == 0,
                    "brick {first} is empty or its padding is not"
                );
                let (lo, side) = (brick.lo, brick.side);
                let is_box = lo.is_finite() && side.is_finite() && side.cmpgt(Vec4::ZERO).all();
                require!(is_box, "brick {first} is at {lo} with voxels of {side}");
                let start = brick.first as usize;
                start..start + brick.occupied.count_ones() as usize
            }
        };
        require!(
            words.end <= self.arena.words.len().min(u32::MAX as usize),
            "voxels {words:?} exceed the words"
        );
        for word in words {
            let empty = self.arena.words[word] == VoxelWord::EMPTY;
            require!(!(empty && self.arena.form == Form::Bricks), "an occupied voxel of a brick is empty");
            self.voxel(word, depth)?;
        }
        Ok(())
    }

    fn list(&mut self, first: usize) -> Result<(), Violation> {
        for index in first.. {
            meet(&mut self.entries, index, "reference")?;
            let reference = self.arena.references[index];
            self.refer(reference.cluster() as usize)?;
            if reference.is_last() {
                break;
            }
        }
        Ok(())
    }

    fn groups(&mut self, first: usize) -> Result<(), Violation> {
        for index in first.. {
            meet(&mut self.entries, index, "box group")?;
            let group = &self.arena.groups[index];
            let last = group.clusters[0].is_last();
            let full = (0..WIDE).take_while(|&lane| group.planes[0][0][lane] != f32::INFINITY).count();
            require!(full > 0 && (last || full == WIDE), "box group {index} has gaps");
            for lane in 0..WIDE {
                require!(group.clusters[lane].is_last() == last, "the end of box group {index}");
                let [lo, hi] = group.planes.map(|side| side.map(|axis| axis[lane]));
                let empty = (lo, hi) == ([f32::INFINITY; 3], [f32::INFINITY; 3]);
                let ordered = (0..3).all(|a| lo[a] <= hi[a]);
                require!(if lane < full { ordered } else { empty }, "box {lane} of group {index}");
                if lane < full {
                    self.refer(group.clusters[lane].cluster() as usize)?;
                }
            }
            if last {
                break;
            }
        }
        Ok(())
    }

    fn refer(&mut self, cluster: usize) -> Result<(), Violation> {
        let leaf = self.statistics.leaves;
        let last = self.referred.get(cluster).copied();
        require!(last.is_some_and(|l| l != leaf), "cluster {cluster} is out of range or twice in a leaf");
        self.referred[cluster] = leaf;
        self.statistics.references += 1;
        Ok(())
    }

    fn all_used(self) -> Result<Statistics, Violation> {
        let used =
            [("word", &self.words), ("brick", &self.bricks), ("reference or box group", &self.entries)];
        for (what, seen) in used {
            let unused = seen.iter().position(|s| !s);
            require!(unused.is_none(), "{what} {} is not used", unused.unwrap_or_default());
        }
        let lost = self.referred.iter().position(|&l| l == usize::MAX);
        require!(lost.is_none(), "cluster {} is in no voxel", lost.unwrap_or_default());
        Ok(self.statistics)
    }
}
