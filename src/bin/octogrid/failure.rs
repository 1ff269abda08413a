//! What can go wrong, by exit code.

use std::fmt::Display;
use std::path::Path;

use octogrid::obj::ObjError;
use octogrid::{BuildError, MeshError};

/// Why the command stops.
#[derive(Debug)]
pub(crate) enum Failure {
    /// Exit code 2: the command line asks for something that does not exist.
    Usage(String),
    /// Exit code 1: a file, a format, a scene or a limit.
    Expected(String),
}

impl Failure {
    /// A failure about a file.
    pub(crate) fn at(path: &Path, what: impl Display) -> Self {
        Self::Expected(format!("{}: {what}", path.display()))
    }
}

impl From<BuildError> for Failure {
    fn from(error: BuildError) -> Self {
        match error {
            BuildError::Parameter { .. } => Self::Usage(error.to_string()),
            _ => Self::Expected(error.to_string()),
        }
    }
}

impl From<MeshError> for Failure {
    fn from(error: MeshError) -> Self {
        Self::Expected(error.to_string())
    }
}

impl From<ObjError> for Failure {
    /// The error names the file itself, which may be that of the materials.
    fn from(error: ObjError) -> Self {
        Self::Expected(error.to_string())
    }
}
