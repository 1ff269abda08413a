//! Meshes and rays out of any bytes, in three regimes of numbers.

use arbitrary::{Arbitrary, Result, Unstructured};
use octogrid::oracle::{Agreement, rays};
use octogrid::{BuildOptions, Isa, MeshError, Ray, TriMesh};

/// Limits that keep an execution short: the oracle takes their product.
const TRIANGLES: usize = 32;
const RAYS: usize = 6;

/// A small mesh, rays, and whom to ask.
#[derive(Arbitrary, Clone, Debug)]
pub struct Case {
    structure: u8,
    isa: u8,
    /// Seeds rays that the oracle makes for the mesh, one of each set of hazards.
    hazards: u16,
    numbers: Numbers,
}

#[derive(Arbitrary, Clone, Debug)]
enum Numbers {
    /// All arithmetic is exact; vertices on edges, coplanar triangles and ties abound.
    Exact(Shapes<Integer>),
    /// A few units in the last place away from that.
    Near(Shapes<Near>),
    /// All bits, NaN and infinities too.
    Float(Shapes<f32>),
}

#[derive(Arbitrary, Clone, Debug)]
struct Shapes<N> {
    vertices: Vec<[N; 3]>,
    /// Taken modulo the number of vertices.
    triangles: Vec<[u8; 3]>,
    rays: Vec<[N; 8]>,
}

/// An integer from -4 to 4.
#[derive(Clone, Copy, Debug)]
struct Integer(i8);

/// An integer from -4 to 4, moved by units in its last place.
#[derive(Arbitrary, Clone, Copy, Debug)]
struct Near(Integer, i8);

impl Case {
    /// Calls `check` with the mesh and rays of all kinds; a vertex that is not finite must be the
    /// mesh's error.
    pub fn run(&self, check: impl FnOnce(&TriMesh<'_>, &[Ray])) {
        let (vertices, triangles, mut rays) = match &self.numbers {
            Numbers::Exact(shapes) => shapes.floats(),
            Numbers::Near(shapes) => shapes.floats(),
            Numbers::Float(shapes) => shapes.floats(),
        };
        let bad = vertices.iter().position(|v| v.iter().any(|x| !x.is_finite()));
        match (TriMesh::new(&vertices, &triangles), bad) {
            (Ok(mesh), None) => {
                rays.extend(rays::hazards(&mesh, self.hazards.into(), rays::RaySet::ALL.len()));
                check(&mesh, &rays);
            }
            (Err(MeshError::NotFinite { vertex, .. }), Some(bad)) => assert_eq!(vertex, bad),
            (result, bad) => panic!("{result:?} where vertex {bad:?} is not finite"),
        }
    }

    /// The rays of integers, if this is the regime, over their whole lines.
    pub fn integer_lines(&self) -> Vec<Ray> {
        let Numbers::Exact(shapes) = &self.numbers else { return Vec::new() };
        let line = |ray: Ray| ray.with_interval(f32::NEG_INFINITY, f32::INFINITY);
        shapes.floats().2.into_iter().map(line).collect()
    }

    /// One structure of [`Agreement::thorough`] on one instruction set, single rays alone, and some of
    /// them against exact arithmetic, which takes longer than all else.
    pub fn agreement(&self) -> Agreement {
        let all = Agreement::thorough();
        let (own, planned): (Vec<BuildOptions>, Vec<BuildOptions>) =
            all.structures.into_iter().partition(|o| o.structure.is_some());
        // Inputs found earlier keep their structures.
        let structure = match usize::from(self.structure).checked_sub(240) {
            Some(i) => planned[i % planned.len()],
            None => own[usize::from(self.structure) % own.len()],
        };
        let structures = vec![structure];
        Agreement { structures, isas: vec![self.isa()], threads: vec![], exact: 4, decorated: 0 }
    }

    /// Any instruction set that there is.
    pub fn isa(&self) -> Isa {
        let all = Isa::available();
        all[usize::from(self.isa) % all.len()]
    }
}

impl<N: Copy + Into<f32>> Shapes<N> {
    fn floats(&self) -> (Vec<[f32; 3]>, Vec<[u32; 3]>, Vec<Ray>) {
        let vertices: Vec<_> = self.vertices.iter().map(|v| v.map(N::into)).collect();
        let rays = self.rays.iter().take(RAYS).map(|ray| bytemuck::cast(ray.map(N::into))).collect();
        let corners = |t: &[u8; 3]| t.map(|i| u32::from(i) % vertices.len() as u32);
        let len = if vertices.is_empty() { 0 } else { TRIANGLES };
        let triangles = self.triangles.iter().take(len).map(corners).collect();
        (vertices, triangles, rays)
    }
}

impl<'a> Arbitrary<'a> for Integer {
    fn arbitrary(bytes: &mut Unstructured<'a>) -> Result<Self> {
        bytes.int_in_range(-4..=4).map(Self)
    }

    fn size_hint(_: usize) -> (usize, Option<usize>) {
        (1, Some(1))
    }
}

impl From<Integer> for f32 {
    fn from(Integer(x): Integer) -> f32 {
        x.into()
    }
}

impl From<Near> for f32 {
    fn from(Near(x, ulps): Near) -> f32 {
        f32::from_bits(f32::from(x).to_bits().saturating_add_signed(ulps.into()))
    }
}
