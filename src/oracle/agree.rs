//! The one assertion: every structure answers every query as brute force and exact arithmetic do.

use super::compare::{self, Subject};
use super::disagreement::Disagreement;
use super::{brute, exact};
use crate::build::{
    BuildOptions, Forced, HybridParams, OctreeParams, Part, Quality, RecursiveParams, Structure,
    UniformParams,
};
use crate::lanes::Isa;
use crate::mesh::TriMesh;
use crate::ray::Ray;
use crate::scene::Scene;

/// What to compare.
///
/// ```
/// use octogrid::oracle::{Agreement, rays};
/// use octogrid::{Structure, TriMesh};
/// let vertices = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = TriMesh::new(&vertices, &[[0, 1, 2]])?;
/// let octree = Agreement { structures: vec![Structure::OCTREE.into()], ..Agreement::quick() };
/// let report = octree.assert(&mesh, &rays::hazards(&mesh, 1, 100));
/// assert_eq!((report.rays, report.structures), (100, 1));
/// # Ok::<(), octogrid::MeshError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Agreement {
    /// What to build, each for each instruction set in place of its own; brute force only of meshes of up to
    /// 4096 triangles.
    pub structures: Vec<BuildOptions>,
    /// The instruction sets to run the queries with.
    pub isas: Vec<Isa>,
    /// The number of threads of each pool in which batches run; without the feature `parallel` no
    /// batches run.
    pub threads: Vec<usize>,
    /// About how many rays, evenly chosen, to compare with exact arithmetic too.
    pub exact: usize,
    /// About how many rays, evenly chosen, to run with counting queries and too small buffers too.
    pub decorated: usize,
}

impl Agreement {
    /// What the plan says, the four structures with default parameters, a hybrid of many bricks and brute force,
    /// one thread, all rays against exact arithmetic: for many small cases.
    pub fn quick() -> Self {
        let structures = Structure::ALL.into_iter().chain([bricks(8), Structure::Brute]);
        Self {
            structures: structures.map(BuildOptions::from).chain([BuildOptions::default()]).collect(),
            isas: vec![Isa::detect()],
            threads: vec![1],
            exact: usize::MAX,
            decorated: usize::MAX,
        }
    }

    /// Every structure with default and with extreme parameters, plans with every part forced on and off and of
    /// every quality, every instruction set, one and two threads, all rays against exact arithmetic, some of them
    /// decorated.
    pub fn thorough() -> Self {
        let structures = Structure::ALL.into_iter().chain(variants()).map(BuildOptions::from);
        let structures = structures.chain(plans()).collect();
        Self { structures, threads: vec![1, 2], isas: Isa::available(), decorated: 50, ..Self::quick() }
    }

    /// Compares, and panics at the first disagreement with all that is needed to replay it.
    ///
    /// # Panics
    /// With the [`Disagreement`], if there is one.
    #[track_caller]
    pub fn assert(&self, mesh: &TriMesh<'_>, rays: &[Ray]) -> Report {
        match self.check(mesh, rays) {
            Ok(report) => report,
            Err(disagreement) => panic!("{disagreement}"),
        }
    }

    /// Compares.
    ///
    /// # Errors
    /// The first disagreement.
    pub fn check(&self, mesh: &TriMesh<'_>, rays: &[Ray]) -> Result<Report, Box<Disagreement>> {
        self.build(mesh)?.check(rays)
    }

    /// Builds every structure for every instruction set, to compare them on more than one set of rays.
    ///
    /// # Errors
    /// A build that fails, and an invariant that does not hold.
    pub fn build<'a>(&self, mesh: &TriMesh<'a>) -> Result<Subjects<'a>, Box<Disagreement>> {
        let mut subjects = Vec::new();
        for &isa in &self.isas {
            for options in &self.structures {
                let scene = build(mesh, &BuildOptions { isa, ..*options })?;
                // Of large meshes that would compare brute force with itself for long.
                if scene.structure() != Structure::Brute || mesh.len() <= 4096 {
                    subjects.push(Subject::new(scene, mesh, isa)?);
                }
            }
        }
        Ok(Subjects { agreement: self.clone(), mesh: *mesh, subjects })
    }
}

impl Default for Agreement {
    fn default() -> Self {
        Self::thorough()
    }
}

/// The scenes of one mesh to be compared, made by [`Agreement::build`].
pub struct Subjects<'a> {
    agreement: Agreement,
    mesh: TriMesh<'a>,
    subjects: Vec<Subject<'a>>,
}

impl<'a> Subjects<'a> {
    /// The mesh.
    pub fn mesh(&self) -> &TriMesh<'a> {
        &self.mesh
    }

    /// The same scenes, saved and loaded.
    ///
    /// # Errors
    /// A scene that can't be loaded.
    #[cfg(feature = "file")]
    pub fn reload(self) -> Result<Self, crate::LoadError> {
        let subjects = self.subjects.into_iter().map(Subject::reload).collect::<Result<_, _>>()?;
        Ok(Self { subjects, ..self })
    }

    /// Compares.
    ///
    /// # Errors
    /// The first disagreement.
    pub fn check(&self, rays: &[Ray]) -> Result<Report, Box<Disagreement>> {
        let agreement = &self.agreement;
        let answers = brute::answers(&self.mesh, rays);
        let mut report =
            Report { rays: rays.len(), structures: agreement.structures.len(), ..Report::default() };
        for i in sample(rays.len(), agreement.exact) {
            compare::with_exact(&self.mesh, &rays[i], &answers[i], &exact::answer(&self.mesh, &rays[i]))?;
            report.exact += 1;
            report.comparisons += 1;
        }
        for subject in &self.subjects {
            for (ray, answer) in rays.iter().zip(&answers) {
                report.comparisons += subject.one_by_one(ray, answer)?;
            }
            for i in sample(rays.len(), agreement.decorated) {
                report.comparisons += subject.decorated(&rays[i], &answers[i])?;
            }
            report.comparisons += subject.packets(rays, &answers)?;
            #[cfg(feature = "parallel")]
            for &threads in &agreement.threads {
                report.comparisons += subject.batches(threads, rays, &answers)?;
            }
        }
        Ok(report)
    }
}

/// How much was compared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Report {
    /// Rays, each compared with brute force.
    pub rays: usize,
    /// Of these, compared with exact arithmetic.
    pub exact: usize,
    /// Structures.
    pub structures: usize,
    /// Answers that were compared.
    pub comparisons: usize,
}

/// [`Agreement::assert`] with [`Agreement::thorough`].
///
/// # Panics
/// With the [`Disagreement`], if there is one.
#[track_caller]
pub fn assert_agree(mesh: &TriMesh<'_>, rays: &[Ray]) -> Report {
    Agreement::thorough().assert(mesh, rays)
}

/// [`Agreement::check`] with [`Agreement::thorough`].
///
/// # Errors
/// The first disagreement.
pub fn check_agree(mesh: &TriMesh<'_>, rays: &[Ray]) -> Result<Report, Box<Disagreement>> {
    Agreement::thorough().check(mesh, rays)
}

/// About `n` of the indices below `len`, evenly chosen.
fn sample(len: usize, n: usize) -> impl Iterator<Item = usize> {
    let end = if n == 0 { 0 } else { len };
    (0..end).step_by(len.div_ceil(n.max(1)).max(1))
}

fn build(mesh: &TriMesh<'_>, options: &BuildOptions) -> Result<Scene, Box<Disagreement>> {
    let name = || options.structure.map_or("auto".to_owned(), |structure| structure.to_string());
    Scene::build(mesh, options).map_err(|error| {
        Disagreement::new(format!("{}, {}", name(), options.isa), "build", &"a scene", &error.to_string())
    })
}

/// Plans with each part forced on and off, and of the other quality.
fn plans() -> impl Iterator<Item = BuildOptions> {
    let forced = |keep: [Option<bool>; 3]| {
        let parts = Part::ALL.into_iter().zip(keep).filter_map(|(part, keep)| Some((part, keep?)));
        parts.fold(Forced::default(), |forced, (part, keep)| forced.with(part, keep))
    };
    let (on, off) = (Some(true), Some(false));
    [[None; 3], [on, on, on], [on, off, off], [off, None, None]]
        .into_iter()
        .map(move |keep| BuildOptions { forced: forced(keep), ..Default::default() })
        .chain([BuildOptions { quality: Quality::Fast, ..Default::default() }])
}

/// Parameters away from the defaults: the paper's, no top grid, no depth, much depth.
fn variants() -> Vec<Structure> {
    let recursive = |threshold, divisions, top_grid| {
        Structure::Recursive(RecursiveParams { threshold, divisions, top_grid })
    };
    let octree = |threshold, plane_weight| Structure::Octree(OctreeParams { threshold, plane_weight });
    let uniform = |density| Structure::Uniform(UniformParams { density });
    let hybrid = |density| Structure::Hybrid(HybridParams { density, ..HybridParams::DEFAULT });
    vec![
        recursive(3, 2, true),
        recursive(19, 2, false),
        recursive(10, 4, false),
        recursive(8, 3, true),
        octree(2, 15),
        octree(4, 0),
        uniform(0.05),
        uniform(64.0),
        hybrid(8.0),
        bricks(8),
        bricks(1),
    ]
}

/// A hybrid that divides wherever it may.
fn bricks(levels: u32) -> Structure {
    let params = HybridParams { density: 0.1, levels, group_cost: 1.0, brick_cost: 0.0, voxel_cost: 0.0 };
    Structure::Hybrid(params)
}
