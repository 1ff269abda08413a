//! Why an OBJ or MTL file can't be read or written.

use std::path::{Path, PathBuf};
use std::{error, fmt, io};

use crate::mesh::MeshError;

/// Why a file can't be read or written. Displays as one line.
#[derive(Debug)]
pub enum ObjError {
    /// The system refused.
    Io {
        /// What was tried: "read" or "write".
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// Its reason.
        source: io::Error,
    },
    /// A line is at fault.
    Line {
        /// The file.
        path: PathBuf,
        /// The number of the line, from 1.
        line: usize,
        /// What is wrong with it.
        problem: Problem,
    },
    /// The parser refused a file in which the checks had found no fault.
    Refused {
        /// The file.
        path: PathBuf,
        /// Its reason.
        reason: String,
    },
    /// The model to write is not a valid mesh.
    Mesh(MeshError),
    /// The model to write has neither no material index nor a valid one for each triangle.
    MaterialIds,
    /// The model to write has a material name that an MTL file can't hold, or that occurs twice.
    MaterialName(String),
}

/// What is wrong with a line of an OBJ or MTL file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Problem {
    /// The file holds bytes that no text has.
    NotText,
    /// Something is not a number.
    NotANumber(String),
    /// A number is NaN, infinite or too large for f32.
    NotFinite(String),
    /// There are too few or too many numbers.
    NumberCount {
        /// What is allowed.
        expected: &'static str,
        /// How many there are.
        found: usize,
    },
    /// The weight of a vertex is zero.
    ZeroWeight,
    /// A face has fewer than three corners.
    TooFewCorners(usize),
    /// The corner of a face is not v, v/vt, v//vn or v/vt/vn.
    BadCorner(String),
    /// A corner names something that does not exist.
    IndexOutOfRange {
        /// "vertex", "texture coordinate" or "normal".
        what: &'static str,
        /// The index as written.
        index: i64,
        /// How many there are.
        count: usize,
    },
    /// A material has no name.
    NoName,
}

impl ObjError {
    pub(super) fn at(path: &Path, line: usize, problem: Problem) -> Self {
        Self::Line { path: path.to_owned(), line, problem }
    }

    pub(super) fn io(action: &'static str, path: &Path, source: io::Error) -> Self {
        Self::Io { action, path: path.to_owned(), source }
    }
}

impl fmt::Display for ObjError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io { action, path, source } => write!(f, "can't {action} {}: {source}", path.display()),
            Self::Line { path, line, problem } => write!(f, "{}:{line}: {problem}", path.display()),
            Self::Refused { path, reason } => write!(f, "{}: {reason}", path.display()),
            Self::Mesh(error) => write!(f, "the model can't be written: {error}"),
            Self::MaterialIds => {
                f.write_str("the model can't be written: give each triangle a valid material, or none to all")
            }
            Self::MaterialName(name) => {
                write!(
                    f,
                    "the material name {name:?} can't be written: give each material its own plain name"
                )
            }
        }
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotText => f.write_str("this is not text; give an OBJ file"),
            Self::NotANumber(token) => write!(f, "{token:?} is not a number"),
            Self::NotFinite(token) => {
                write!(f, "{token:?} is not a finite 32-bit number; correct or scale it")
            }
            Self::NumberCount { expected, found } => write!(f, "expected {expected}, found {found}"),
            Self::ZeroWeight => f.write_str("the weight of a vertex must not be zero"),
            Self::TooFewCorners(n) => write!(f, "a face needs at least 3 corners, found {n}; remove it"),
            Self::BadCorner(token) => {
                write!(f, "{token:?} is not a corner of a face: v, v/vt, v//vn or v/vt/vn")
            }
            Self::IndexOutOfRange { what, index, count } => {
                write!(
                    f,
                    "{what} {index} does not exist: the file has {count} of these here; correct the index"
                )
            }
            Self::NoName => f.write_str("a material needs a name"),
        }
    }
}

impl error::Error for ObjError {
    fn source(&self) -> Option<&(dyn error::Error + 'static)> {
        match self {
            Self::Io { source, .. } => Some(source),
            Self::Mesh(error) => Some(error),
            _ => None,
        }
    }
}
