//! What is measured of a structure on a scene: one column of the paper's tables.

use octogrid::{OctreeParams, RecursiveParams, Structure};
use serde::Serialize;

/// The structure that others are compared with.
pub(super) const REFERENCE: &str = "R[19,4]";

/// A quantity of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Measure {
    Rendering,
    Memory,
    Preprocessing,
}

impl Measure {
    pub(super) const ALL: [Measure; 3] = [Self::Rendering, Self::Memory, Self::Preprocessing];

    /// With its unit.
    pub(super) fn label(self) -> &'static str {
        match self {
            Self::Rendering => "rendering, s",
            Self::Memory => "memory, KB",
            Self::Preprocessing => "preprocessing, s",
        }
    }
}

/// Figures of one structure: a sample a round, none where nothing was measured.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Column {
    pub(super) structure: String,
    /// Seconds of the queries of a whole image.
    pub(super) rendering: Vec<f64>,
    /// Kilobytes of the voxels, without the triangles.
    pub(super) memory: Vec<f64>,
    /// Seconds of the build.
    pub(super) preprocessing: Vec<f64>,
}

impl Column {
    pub(super) fn samples(&self, measure: Measure) -> &[f64] {
        match measure {
            Measure::Rendering => &self.rendering,
            Measure::Memory => &self.memory,
            Measure::Preprocessing => &self.preprocessing,
        }
    }
}

/// The column of a structure.
pub(super) fn find<'a>(columns: &'a [Column], structure: &str) -> Option<&'a Column> {
    columns.iter().find(|c| c.structure == structure)
}

/// R\[`threshold`, `divisions`\].
pub(super) fn recursive(threshold: u32, divisions: u32, top_grid: bool) -> Structure {
    Structure::Recursive(RecursiveParams { threshold, divisions, top_grid })
}

/// O\[`threshold`, `plane_weight`\].
pub(super) fn octree(threshold: u32, plane_weight: u32) -> Structure {
    Structure::Octree(OctreeParams { threshold, plane_weight })
}

/// The structures of the paper's tables, the reference first, and ours.
///
/// O\[4,0\] is the octree of the paper with the same limit for triangles of different planes, blind to
/// planes.
pub(super) fn structures() -> Vec<Structure> {
    vec![
        recursive(19, 4, true),
        recursive(10, 4, true),
        recursive(16, 4, true),
        recursive(22, 4, true),
        recursive(31, 4, true),
        recursive(19, 4, false),
        recursive(19, 2, true),
        recursive(19, 2, false),
        octree(2, 15),
        octree(4, 15),
        octree(6, 15),
        octree(8, 15),
        octree(4, 0),
        Structure::UNIFORM,
        Structure::HYBRID,
    ]
}
