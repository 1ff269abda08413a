//! The folder of a report's files.

use std::io::Write;
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::plot::{self, Labels, Series};
use crate::failure::Failure;
use crate::output::Output;

/// A folder for the files of a report.
pub(super) struct Folder(PathBuf);

impl Folder {
    /// Makes sure before the long work that there is one and that it can be written.
    ///
    /// # Errors
    /// Where it can't.
    pub(super) fn at(path: &Path) -> Result<Self, Failure> {
        std::fs::create_dir_all(path).map_err(|e| Failure::at(path, e))?;
        Output::at(&path.join("report.json"))?;
        Ok(Self(path.to_owned()))
    }

    /// Where it is.
    pub(super) fn path(&self) -> &Path {
        &self.0
    }

    /// Writes a whole file, or nothing.
    ///
    /// # Errors
    /// Where the system does.
    pub(super) fn write(&self, name: &str, text: &str) -> Result<(), Failure> {
        Output::at(&self.0.join(name))?.write(|file| file.write_all(text.as_bytes()))
    }

    /// Writes an object as JSON.
    ///
    /// # Errors
    /// Where the system does.
    pub(super) fn write_json(&self, name: &str, object: &impl Serialize) -> Result<(), Failure> {
        let json = serde_json::to_string_pretty(object).map_err(|e| Failure::Expected(e.to_string()))?;
        self.write(name, &format!("{json}\n"))
    }

    /// Draws a plot.
    ///
    /// # Errors
    /// Where the system does.
    pub(super) fn write_plot(&self, name: &str, labels: &Labels, series: &[Series]) -> Result<(), Failure> {
        let svg = plot::svg(labels, series).map_err(|e| Failure::Expected(e.to_string()))?;
        self.write(name, &svg)
    }
}

/// The name of a scene's file without folder and ending.
pub(super) fn stem(scene: &str) -> String {
    Path::new(scene).file_stem().unwrap_or_default().to_string_lossy().into_owned()
}
