//! How the triangles of a scene lie, as far as a plan depends on it.

use super::analysis::Analysis;
use super::grid;
use crate::mesh::TriMesh;
use crate::parallel;

/// How the triangles of a scene lie: what a [`Plan`](crate::Plan) is made from.
///
/// Lengths are in the units of the mesh. Triangles without an area count in `degenerate` alone.
///
/// ```
/// use octogrid::{SceneProfile, builtin};
/// let profile = SceneProfile::new(&builtin::stadium().mesh()?);
/// assert_eq!((profile.triangles, profile.degenerate), (100_012, 0));
/// assert!(profile.crowding > 10_000.0 && profile.evenness < 0.1);
/// # Ok::<(), octogrid::MeshError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SceneProfile {
    /// Triangles whose area is not zero.
    pub triangles: usize,
    /// Triangles of zero area, which no ray can hit.
    pub degenerate: usize,
    /// The lengths of the box around the triangles.
    pub extent: [f64; 3],
    /// The least of these over the greatest, in [0, 1]: 0 where the scene is flat.
    pub flatness: f64,
    /// The largest coordinate over the greatest length, both absolute: rounding to f32 moves a point by up to
    /// 2^-24 of the scene times this.
    pub magnitude: f64,
    /// Triangles by the greatest length of their box: at `i` those of at least 2^-i of the scene's greatest
    /// length, and less than twice that; at the end all smaller ones, too.
    pub sizes: [usize; Self::SIZES],
    /// How many triangles there are around an average one: in the voxel of its centre, of a grid of about one voxel
    /// for 80 triangles: about 80 where they are spread evenly.
    pub crowding: f64,
    /// The share of those voxels that have any, in [0, 1].
    pub evenness: f64,
}

impl SceneProfile {
    /// The number of sizes that are told apart.
    pub const SIZES: usize = 32;

    /// Measures a mesh. O(n), in parallel; the same for any number of threads.
    pub fn new(mesh: &TriMesh<'_>) -> Self {
        parallel::enter(|| Self::of(&Analysis::new(mesh), mesh.len()))
    }

    /// The same for a mesh of `all` triangles that is analysed already.
    pub(super) fn of(analysis: &Analysis, all: usize) -> Self {
        let (triangles, bounds) = (analysis.len(), analysis.bounds);
        let (_, extent) = grid::corner_and_extent(&bounds);
        let longest = extent.into_iter().fold(0.0, f64::max);
        let over_longest = |length: f64| if longest > 0.0 { length / longest } else { 0.0 };
        let farthest = f64::from(bounds.lo.abs().max(bounds.hi.abs()).max_element());
        let (crowding, evenness) = crowding(analysis);
        Self {
            triangles,
            degenerate: all - triangles,
            extent,
            flatness: over_longest(extent.into_iter().fold(longest, f64::min)),
            magnitude: over_longest(farthest),
            sizes: sizes(analysis, longest),
            crowding,
            evenness,
        }
    }
}

/// [`SceneProfile::crowding`] and [`SceneProfile::evenness`].
pub(super) fn crowding(analysis: &Analysis) -> (f64, f64) {
    let triangles = analysis.len();
    let occupants = analysis.occupants(triangles as f64 / 80.0);
    let pairs: f64 = occupants.iter().map(|&n| f64::from(n) * f64::from(n)).sum();
    (pairs / triangles.max(1) as f64, share_occupied(&occupants))
}

/// The share of numbers above 0.
pub(super) fn share_occupied(occupants: &[u32]) -> f64 {
    occupants.iter().filter(|&&n| n > 0).count() as f64 / occupants.len() as f64
}

fn sizes(analysis: &Analysis, longest: f64) -> [usize; SceneProfile::SIZES] {
    let scale = 1.0 / longest;
    let classes = parallel::map(&analysis.boxes, |b| {
        // Where f32 overflows the length is close to that of the scene.
        let length = f64::from(b.extent().max_element()) * scale;
        // Rounded down; 1023 stands for 0.
        let exponent = (length.to_bits() >> 52) as usize;
        1023usize.saturating_sub(exponent).min(SceneProfile::SIZES - 1) as u8
    });
    let mut sizes = [0; SceneProfile::SIZES];
    classes.iter().for_each(|&class| sizes[class as usize] += 1);
    sizes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin;

    fn profile(model: crate::Model) -> SceneProfile {
        SceneProfile::new(&model.mesh().unwrap())
    }

    #[test]
    fn nothing_has_a_profile() {
        let empty = profile(builtin::empty());
        assert_eq!((empty.triangles, empty.extent, empty.crowding), (0, [0.0; 3], 0.0));
        assert_eq!((empty.flatness, empty.magnitude, empty.evenness), (0.0, 0.0, 0.0));
    }

    #[test]
    fn shape_place_and_sizes_are_measured() {
        let vertices = [[8.0, 0.0, 0.0], [12.0, 0.0, 0.0], [8.0, 2.0, 0.0], [8.0, 0.0, 1.0], [8.0, 1.0, 0.0]];
        let mesh = TriMesh::new(&vertices, &[[0, 1, 2], [0, 3, 4], [0, 0, 1], [1, 2, 3]]).unwrap();
        let profile = SceneProfile::new(&mesh);
        assert_eq!((profile.triangles, profile.degenerate), (3, 1));
        assert_eq!((profile.extent, profile.flatness, profile.magnitude), ([4.0, 2.0, 1.0], 0.25, 3.0));
        assert_eq!(profile.sizes[..4], [2, 0, 1, 0]);
        assert_eq!((profile.crowding, profile.evenness), (3.0, 1.0));
    }

    #[test]
    fn a_crowd_in_a_corner_shows() {
        let even = profile(builtin::soup(8000, 1));
        assert!(even.crowding < 150.0 && even.evenness > 0.5, "{even:?}");
    }
}
