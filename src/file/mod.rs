//! Saving and loading of built scenes: one file, the arrays as they are in memory.
//!
//! All numbers are little-endian; nothing is packed, so that loading is reading. A file is a header of 192
//! bytes and five sections, each filled up with zeros to a multiple of 64 bytes. The table is that of
//! [`Scene::save`].

mod belongs;
mod error;
mod header;
mod source;

use std::io::{self, ErrorKind, Read, Write};

use bytemuck::{bytes_of, cast_slice};

pub use belongs::MeshMismatch;
pub use error::LoadError;
pub(crate) use header::Header;

use crate::arena::Arena;
use crate::build::BuildOptions;
use crate::scene::Scene;
use crate::validate::validate;
use source::Source;

/// What the starts of sections are multiples of, in bytes.
pub(crate) const ALIGN: usize = 64;

/// The zeros that fill a section of that many bytes up.
pub(crate) fn padding(bytes: usize) -> usize {
    bytes.next_multiple_of(ALIGN) - bytes
}

impl Scene {
    /// Writes the structure with its triangles, so that [`Scene::load`] needs no build. O(size of the
    /// structure).
    ///
    /// The file has the same bytes wherever it is written, and holds triangles alone: no vertices as
    /// they were shared, no materials. By convention its name ends in `.ogrid`. All numbers are
    /// little-endian:
    ///
    /// | bytes | type | what |
    /// |---|---|---|
    /// | 0..8 | `u8` | `89 6f 67 72 69 64 0d 0a`, which is `\x89ogrid\r\n` |
    /// | 8..12 | `u32` | the version of the format, 2 |
    /// | 12..16 | `u32` | the structure: 1 uniform, 2 recursive, 3 octree, 4 hybrid, 5 brute force |
    /// | 16..48 | `u32` or `f32` | its parameters in the order of their declaration, then zeros |
    /// | 48..56 | `u64` | the number of triangles of the mesh |
    /// | 56..104 | `f64`, `u32` | the top grid: lower corner (3), side of a voxel, voxels along each axis (3), zero |
    /// | 104..184 | `u64`, `u32` | for each section its items, the CRC-32 of its bytes, and zero |
    /// | 184..192 | `u32` | zero, and the CRC-32 of all bytes before |
    /// | 192.. | | five sections, each filled up with zeros to a multiple of 64 bytes: |
    /// | | `f32`, `u32` | clusters, 320 bytes: coordinates by corner, axis and lane, ids by lane |
    /// | | `u32` | voxels, 4 bytes: 0 empty, bit 31 a leaf and its first reference or box, else 1 + a divided voxel |
    /// | | `u32` | references, 4 bytes: bit 31 the last of its leaf, and a cluster |
    /// | | `f32`, `u64`, `u32` | bricks, 48 bytes: lower corner (x, y, z, z), sides of a voxel (x, y, z, z), the occupied ones of 64, the first of them, zero |
    /// | | `f32`, `u32` | boxes, 224 bytes: lower and upper corners by axis and lane, references by lane |
    ///
    /// ```
    /// use octogrid::{Ray, Scene, builtin};
    /// let scene = Scene::build(&builtin::cube().mesh()?, &Default::default())?;
    /// let mut file = Vec::new(); // or File::create("cube.ogrid")?
    /// scene.save(&mut file)?;
    /// let loaded = Scene::load(&file[..])?;
    /// let ray = Ray::new([0.1, 0.2, 9.0], [0.0, 0.0, -1.0]);
    /// assert_eq!(loaded.closest(&ray), scene.closest(&ray));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Those of `to`, which needs no buffer; [`io::ErrorKind::Unsupported`] on a big-endian processor.
    pub fn save(&self, mut to: impl Write) -> io::Result<()> {
        require_little_endian()?;
        let sections = bytes_of_sections(&self.arena);
        let header = Header::new(&self.structure, self.triangles, &self.arena, sections);
        to.write_all(bytes_of(&header))?;
        for section in sections {
            to.write_all(section)?;
            to.write_all(&[0; ALIGN][..padding(section.len())])?;
        }
        to.flush()
    }

    /// Reads what [`Scene::save`] wrote, and nothing that may follow it. O(size of the structure), bound
    /// by reading.
    ///
    /// Whatever `from` holds, queries on a loaded scene neither panic nor fail to end: every invariant
    /// that [`Scene::validate`] proves has been proved. Memory is taken as bytes arrive, whatever the file
    /// says of its length. Queries use the best instruction set of this processor.
    ///
    /// A file that was made with the intention to deceive can hold other triangles or lose some of
    /// them: checksums are no signature.
    ///
    /// ```
    /// use octogrid::{LoadError, Scene};
    /// let error = Scene::load(&b"# Blender\nv 0 0 0\n"[..]).unwrap_err();
    /// assert!(matches!(error, LoadError::Foreign));
    /// ```
    ///
    /// # Errors
    /// [`LoadError`] where `from` fails, ends too early, was damaged, or holds something else; as
    /// [`Scene::save`] on a big-endian processor.
    pub fn load(from: impl Read) -> Result<Self, LoadError> {
        require_little_endian()?;
        let mut source = Source::new(from);
        let header = source.header()?;
        let structure = header.structure().map_err(LoadError::Invalid)?;
        let [clusters, words, references, bricks, groups] = header.sections;
        let arena = Arena {
            grid: header.grid(),
            form: header::form(&structure),
            clusters: source.section("clusters", &clusters)?,
            words: source.section("voxels", &words)?,
            references: source.section("references", &references)?,
            bricks: source.section("bricks", &bricks)?,
            groups: source.section("boxes", &groups)?,
        };
        let triangles = header.triangles().map_err(LoadError::Invalid)?;
        validate(&arena, triangles).map_err(LoadError::Invalid)?;
        let arena = Arena { grid: arena.grid.fitted(&arena.bounds()), ..arena };
        Ok(Self::of(arena, structure, triangles, &BuildOptions::default()))
    }
}

/// The arrays in memory are those of the file only there.
fn require_little_endian() -> io::Result<()> {
    if cfg!(target_endian = "little") { Ok(()) } else { Err(ErrorKind::Unsupported.into()) }
}

/// The sections, in the order of [`Arena::bytes_by_kind`].
fn bytes_of_sections(arena: &Arena) -> [&[u8]; 5] {
    [
        cast_slice(&arena.clusters),
        cast_slice(&arena.words),
        cast_slice(&arena.references),
        cast_slice(&arena.bricks),
        cast_slice(&arena.groups),
    ]
}
