//! A scene ready for queries.

use crate::build::{BuildError, BuildOptions, Structure};
use crate::hit::Hit;
use crate::mesh::TriMesh;
use crate::query::{All, Any, Closest, Query};
use crate::ray::Ray;

/// Triangles in a voxel structure, ready for queries.
#[derive(Clone, Debug)]
pub struct Scene {
    structure: Structure,
    triangles: usize,
}

/// How many hits [`Scene::all`] has written, and whether these are all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AllHits {
    /// The number of hits at the start of the buffer.
    pub len: usize,
    /// Whether the buffer had room for all.
    pub complete: bool,
}

impl Scene {
    /// Builds the structure.
    pub fn build(mesh: &TriMesh<'_>, options: &BuildOptions) -> Result<Self, BuildError> {
        Ok(Self { structure: options.structure, triangles: mesh.len() })
    }

    /// The closest hit, or [`Hit::MISS`].
    pub fn closest(&self, ray: &Ray) -> Hit {
        let mut query = Closest::new(ray.t_max);
        self.query(ray, &mut query);
        query.hit()
    }

    /// Whether there is any hit.
    pub fn occluded(&self, ray: &Ray) -> bool {
        let mut query = Any::new(ray.t_max);
        self.query(ray, &mut query);
        query.found()
    }

    /// All hits, sorted by (t, triangle), into `hits`.
    pub fn all(&self, ray: &Ray, hits: &mut [Hit]) -> AllHits {
        let mut query = All::new(ray.t_max, hits);
        self.query(ray, &mut query);
        AllHits { len: query.len(), complete: query.is_complete() }
    }

    /// Runs any query.
    pub fn query<Q: Query>(&self, ray: &Ray, query: &mut Q) {
        let _ = (ray, query);
    }

    /// The number of triangles of the mesh.
    pub fn triangles(&self) -> usize {
        self.triangles
    }

    /// The structure and its parameters.
    pub fn structure(&self) -> Structure {
        self.structure
    }

    /// The bytes that the scene holds.
    pub fn bytes(&self) -> usize {
        0
    }

    /// [`Scene::closest`] for many rays, on the threads of the current rayon pool.
    #[cfg(feature = "parallel")]
    pub fn closest_batch(&self, rays: &[Ray], hits: &mut [Hit]) {
        let _ = (rays, hits);
    }

    /// [`Scene::occluded`] for many rays.
    #[cfg(feature = "parallel")]
    pub fn occluded_batch(&self, rays: &[Ray], occluded: &mut [bool]) {
        let _ = (rays, occluded);
    }

    /// [`Scene::all`] for many rays.
    #[cfg(feature = "parallel")]
    pub fn all_batch(&self, rays: &[Ray]) -> HitLists {
        let _ = rays;
        HitLists::default()
    }

    /// Proves every invariant of the structure and measures it.
    pub fn validate(&self) -> Result<Statistics, Violation> {
        Ok(Statistics::default())
    }
}

/// The hits of many rays in one flat list.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HitLists {
    /// The hits of ray i are `hits[offsets[i]..offsets[i + 1]]`.
    pub offsets: Vec<usize>,
    /// All hits, ray after ray.
    pub hits: Vec<Hit>,
}

/// What a structure is made of. Prints as a table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Statistics {
    /// Triangles stored.
    pub triangles: usize,
    /// Triangles left out because their area is zero.
    pub degenerate: usize,
    /// Clusters of up to 8 triangles.
    pub clusters: usize,
    /// Voxels: empty ones, leaves, divided ones.
    pub empty: usize,
    /// Leaves.
    pub leaves: usize,
    /// Divided voxels.
    pub nodes: usize,
    /// References to clusters.
    pub references: usize,
    /// The deepest level, the top grid being 0.
    pub depth: usize,
    /// Bytes by kind.
    pub bytes: Vec<(&'static str, usize)>,
}

/// An invariant that does not hold.
#[derive(Clone, Debug, PartialEq)]
pub struct Violation(pub String);
