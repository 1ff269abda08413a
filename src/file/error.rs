//! Why a file can't be loaded.

use std::{error, fmt, io};

use super::header::Header;
use crate::validate::Violation;

/// Why [`Scene::load`](crate::Scene::load) gives no scene. Displays as one line.
#[derive(Debug)]
pub enum LoadError {
    /// Reading failed, or there is too little memory.
    Io(io::Error),
    /// This was not written by [`Scene::save`](crate::Scene::save).
    Foreign,
    /// The file has another version of the format than this crate reads.
    Version {
        /// The version of the file.
        found: u32,
    },
    /// The file is shorter than it says.
    Truncated {
        /// The part in which it ends: `header`, `clusters`, `voxels`, `references`, `bricks` or `boxes`.
        section: &'static str,
        /// The number of bytes that there are.
        len: u64,
    },
    /// A part of the file is not what was written: its checksum differs, or what fills it up is not zero.
    Damaged {
        /// The part, as in [`LoadError::Truncated`].
        section: &'static str,
        /// Where the part starts, in bytes.
        start: u64,
    },
    /// The file is as it was written, but not by this crate: it holds no structure.
    Invalid(Violation),
}

impl fmt::Display for LoadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io(error) => write!(f, "can't read: {error}"),
            Self::Foreign => f.write_str("this is no saved scene: give a file that octogrid has written"),
            Self::Version { found } => {
                let this = Header::VERSION;
                let remedy = if *found > this { "update octogrid, or build" } else { "build" };
                write!(f, "the file has version {found} of the format, not {this}: {remedy} the scene anew")
            }
            Self::Truncated { section, len } => {
                write!(
                    f,
                    "the file ends after {len} bytes, in its {section}: copy it again, or build it anew"
                )
            }
            Self::Damaged { section, start } => {
                write!(
                    f,
                    "the file is damaged in its {section}, from byte {start} on: copy it again, or build it anew"
                )
            }
            Self::Invalid(violation) => {
                write!(f, "the file holds no valid structure ({violation}): build it anew")
            }
        }
    }
}

impl error::Error for LoadError {
    fn source(&self) -> Option<&(dyn error::Error + 'static)> {
        match self {
            Self::Io(error) => Some(error),
            Self::Invalid(violation) => Some(violation),
            _ => None,
        }
    }
}

impl From<io::Error> for LoadError {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}
