//! A scene ready for queries.

use std::ops::ControlFlow;

use crate::arena::Arena;
use crate::build::{self, BuildError, BuildOptions, Part, Structure};
use crate::cluster::Cluster;
use crate::descent::Walk;
use crate::hit::Hit;
use crate::kernel::{Double, Exact, Fused, Kernel, Plain, Test};
use crate::lanes::Isa;
use crate::mesh::TriMesh;
use crate::query::{All, Any, Closest, Query};
use crate::ray::Ray;
use crate::traverse::{self, PerRay, Visit};
use crate::validate::{self, Statistics, Violation};

/// Triangles in a voxel structure, ready for queries.
///
/// Holds copies of the triangles, not the mesh. Queries need no exclusive access, neither panic nor
/// allocate, and give the same bits with every structure, instruction set and number of threads.
///
/// ```
/// use octogrid::{Ray, Scene, TriMesh};
/// let vertices = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]];
/// let scene = Scene::build(&TriMesh::new(&vertices, &[[0, 1, 2]])?, &Default::default())?;
/// let ray = Ray::new([0.0, 0.0, 2.0], [0.0, 0.0, -1.0]);
/// assert_eq!(scene.closest(&ray).t, 2.0);
/// assert!(!scene.occluded(&ray.with_interval(0.0, 1.9)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Scene {
    pub(crate) arena: Arena,
    pub(crate) structure: Structure,
    pub(crate) isa: Isa,
    pub(crate) walk: Walk,
    pub(crate) triangles: usize,
}

/// How many hits [`Scene::all`] has written, and whether these are all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AllHits {
    /// The number of hits at the start of the buffer.
    pub len: usize,
    /// Whether the buffer had room for all; where not, it holds the first ones along the ray.
    pub complete: bool,
}

impl Scene {
    /// Builds the structure that `options` asks for. O(n log n) for n triangles.
    ///
    /// # Errors
    /// [`BuildError`] where a parameter is out of its range or the memory limit does not suffice.
    pub fn build(mesh: &TriMesh<'_>, options: &BuildOptions) -> Result<Self, BuildError> {
        let (structure, arena) = build::build(mesh, options)?;
        Ok(Self::of(arena, structure, mesh.len(), options))
    }

    pub(crate) fn of(arena: Arena, structure: Structure, triangles: usize, options: &BuildOptions) -> Self {
        // Recursive grids have no special walk, and a part that is asked for costs what it costs.
        let general =
            matches!(structure, Structure::Recursive(_)) || options.forced.get(Part::Bricks) == Some(true);
        let walk = if general { Walk::General } else { options.walk };
        Self { arena, structure, isa: options.isa, walk, triangles }
    }

    /// The closest hit, or [`Hit::MISS`]; of hits with the same t the one with the least index.
    pub fn closest(&self, ray: &Ray) -> Hit {
        traverse::answer::<Closest>(self.isa, &self.arena, self.walk, ray)
    }

    /// Whether there is any hit.
    pub fn occluded(&self, ray: &Ray) -> bool {
        traverse::answer::<Any>(self.isa, &self.arena, self.walk, ray)
    }

    /// All hits, each triangle once, sorted by (t, index), into the start of `hits`.
    ///
    /// A ray through a shared edge or vertex crosses one of the triangles there (see
    /// [`crate::EdgeRule::Crossing`]), so a closed mesh is met an even number of times.
    ///
    /// ```
    /// use octogrid::{Hit, Ray, Scene, TriMesh};
    /// let vertices = [[0.0, 0.0, 1.0], [9.0, 0.0, 1.0], [0.0, 9.0, 1.0], [0.0, 9.0, 4.0], [9.0, 0.0, 4.0]];
    /// let mesh = TriMesh::new(&vertices, &[[0, 4, 3], [0, 1, 2]])?;
    /// let scene = Scene::build(&mesh, &Default::default())?;
    /// let mut hits = [Hit::MISS; 8];
    /// let found = scene.all(&Ray::new([1.0, 1.0, 0.0], [0.0, 0.0, 1.0]), &mut hits);
    /// assert!(found.complete);
    /// assert_eq!(hits[..found.len].iter().map(|h| h.prim).collect::<Vec<_>>(), [1, 0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn all(&self, ray: &Ray, hits: &mut [Hit]) -> AllHits {
        let mut query = All::new(ray.t_max, hits);
        self.query(ray, &mut query);
        AllHits { len: query.len(), complete: query.is_complete() }
    }

    /// Runs any query.
    pub fn query<Q: Query>(&self, ray: &Ray, query: &mut Q) {
        self.run::<Exact, Q>(ray, query);
    }

    /// Runs any query with another kernel than the exact one.
    ///
    /// Its answers may differ from those of [`Scene::query`] where a ray passes near the edge of a
    /// triangle or grazes it; see [`Kernel`].
    ///
    /// ```
    /// use octogrid::{Closest, Kernel, Ray, Scene, builtin};
    /// let scene = Scene::build(&builtin::cube().mesh()?, &Default::default())?;
    /// let ray = Ray::new([0.1, 0.2, 9.0], [0.0, 0.0, -1.0]);
    /// let mut query = Closest::new(ray.t_max);
    /// scene.query_with(Kernel::Plain, &ray, &mut query);
    /// assert_eq!(query.hit().prim, scene.closest(&ray).prim);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn query_with<Q: Query>(&self, kernel: Kernel, ray: &Ray, query: &mut Q) {
        match kernel {
            Kernel::Exact => self.run::<Exact, Q>(ray, query),
            Kernel::Double => self.run::<Double, Q>(ray, query),
            Kernel::Plain => self.run::<Plain, Q>(ray, query),
            Kernel::Fused => self.run::<Fused, Q>(ray, query),
        }
    }

    fn run<K: Test, Q: Query>(&self, ray: &Ray, query: &mut Q) {
        traverse::query::<K, Q>(self.isa, &self.arena, self.walk, ray, query);
    }

    /// Answers a query for each ray, one after the other.
    pub(crate) fn each_ray<Q: PerRay>(&self, rays: &[Ray], answers: &mut [Q::Answer]) {
        traverse::batch::<Q>(self.isa, &self.arena, self.walk, rays, answers);
    }

    /// Visits the clusters near a ray voxel by voxel, without testing them: for intersection tests of
    /// your own. `Break` ends the walk, as do the end of the scene and the ray's `t_max`.
    ///
    /// No cluster with a triangle that the ray meets within its interval is left out. One that lies in
    /// several voxels comes several times.
    ///
    /// ```
    /// use octogrid::{Ray, Scene, builtin};
    /// use std::ops::ControlFlow;
    /// let scene = Scene::build(&builtin::cube().mesh()?, &Default::default())?;
    /// let mut triangles = 0;
    /// scene.clusters_along(&Ray::new([0.1, 0.2, 9.0], [0.0, 0.0, -1.0]), |cluster| {
    ///     triangles += cluster.occupied().count_ones();
    ///     ControlFlow::Continue(())
    /// });
    /// assert!(triangles >= 2);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn clusters_along(&self, ray: &Ray, each: impl FnMut(&Cluster) -> ControlFlow<()>) {
        let mut clusters = Each { arena: &self.arena, t_max: ray.t_max, each };
        traverse::visit(self.isa, &self.arena, self.walk, ray, &mut clusters);
    }

    /// The number of triangles of the mesh.
    pub fn triangles(&self) -> usize {
        self.triangles
    }

    /// The structure and its parameters.
    pub fn structure(&self) -> Structure {
        self.structure
    }

    /// The bytes that the structure holds, triangles included.
    pub fn bytes(&self) -> usize {
        self.arena.bytes()
    }

    /// Proves every invariant of the structure and measures it. O(size of the structure).
    ///
    /// # Errors
    /// The first invariant that does not hold; that would be a defect of this crate.
    pub fn validate(&self) -> Result<Statistics, Violation> {
        validate::validate(&self.arena, self.triangles)
    }
}

/// Hands each cluster on.
struct Each<'a, F> {
    arena: &'a Arena,
    t_max: f32,
    each: F,
}

impl<F: FnMut(&Cluster) -> ControlFlow<()>> Visit for Each<'_, F> {
    #[inline(always)]
    fn cluster(&mut self, index: u32) -> ControlFlow<()> {
        (self.each)(&self.arena.clusters[index as usize])
    }

    #[inline(always)]
    fn t_max(&self) -> f32 {
        self.t_max
    }
}
