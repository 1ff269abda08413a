//! Every invariant of an arena, proved, and its statistics.

use std::fmt;

use crate::arena::{Arena, Form, Voxel, VoxelWord};
use crate::cluster::Cluster;
use crate::lanes::WIDTH;

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
pub struct Violation(String);

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
/// - every word, reference, brick and box group is used by exactly one voxel, in bounds;
/// - every cluster is referred to, a leaf refers to a cluster once;
/// - padding is zero, and boxes that hold no cluster are empty.
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
    require!(arena.grid.len() <= arena.words.len(), "the top grid exceeds the words");
    require!(arena.grid.cell > 0.0 && arena.grid.cell.is_finite(), "the cell is {}", arena.grid.cell);
    require!(arena.grid.padding == 0, "padding of the grid");
    for voxel in 0..arena.grid.len() {
        check.voxel(voxel, 0)?;
    }
    check.all_used()
}

/// Returns the number of triangles.
fn clusters(arena: &Arena, triangles: usize) -> Result<usize, Violation> {
    let mut seen = vec![false; triangles];
    for (i, cluster) in arena.clusters.iter().enumerate() {
        let occupied = cluster.occupied();
        require!(
            occupied & 1 != 0 && occupied.count_ones() == occupied.trailing_ones(),
            "gaps in cluster {i}"
        );
        for (lane, &id) in cluster.ids().iter().enumerate() {
            if id == Cluster::NO_TRIANGLE {
                require!(cluster.triangle(lane) == cluster.triangle(0), "lane {lane} of cluster {i}");
                continue;
            }
            let slot = seen.get_mut(id as usize);
            require!(
                slot.as_ref().is_some_and(|s| !**s),
                "triangle {id} of cluster {i} is out of range or repeated"
            );
            slot.into_iter().for_each(|s| *s = true);
        }
    }
    Ok(seen.into_iter().filter(|&s| s).count())
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
        let words = match self.arena.form {
            Form::Lists { divisions } => first..first + divisions.pow(3) as usize,
            Form::Bricks => {
                meet(&mut self.bricks, first, "brick")?;
                let brick = self.arena.bricks[first];
                require!(
                    brick.occupied != 0 && brick.padding == 0,
                    "brick {first} is empty or its padding is not"
                );
                let start = brick.first as usize;
                start..start + brick.occupied.count_ones() as usize
            }
        };
        require!(words.end <= self.arena.words.len(), "voxels {words:?} exceed the words");
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
            let full = (0..WIDTH).take_while(|&lane| group.planes[0][0][lane] != f32::INFINITY).count();
            require!(full > 0 && (last || full == WIDTH), "box group {index} has gaps");
            for lane in 0..WIDTH {
                require!(group.clusters[lane].is_last() == last, "the end of box group {index}");
                let empty = (0..6).all(|i| group.planes[i / 3][i % 3][lane] == f32::INFINITY);
                let ordered = (0..3).all(|a| group.planes[0][a][lane] <= group.planes[1][a][lane]);
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
