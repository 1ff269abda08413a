//! Seeded small meshes in which degeneracies abound, and closed ones.

use glam::Vec3;

use crate::rng::Rng;

/// Vertices, and three indices into them for each triangle.
pub type Mesh = (Vec<[f32; 3]>, Vec<[u32; 3]>);

/// A kind of random meshes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshKind {
    /// Coordinates are integers in -4..=4: shared vertices, coplanar and zero-area triangles.
    Integer,
    /// Coordinates have any finite bits.
    Wild,
    /// Small triangles crowded at a few places of a wide scene.
    Clustered,
    /// Triangles of an aspect up to 10^8.
    Slivers,
    /// The same few triangles over and over, turned and flipped.
    Duplicates,
    /// All in one axis-parallel plane.
    Flat,
}

impl MeshKind {
    /// All of them.
    pub const ALL: [MeshKind; 6] =
        [Self::Integer, Self::Wild, Self::Clustered, Self::Slivers, Self::Duplicates, Self::Flat];
}

/// A mesh of 1 to 60 triangles, the same for the same seed and kind.
pub fn random_mesh(seed: u64, kind: MeshKind) -> Mesh {
    let rng = &mut Rng::new(seed);
    let n = 1 + rng.below(60);
    match kind {
        MeshKind::Integer => indexed(rng, n, |rng| [(); 3].map(|()| rng.integer(4))),
        MeshKind::Wild => indexed(rng, n, |rng| [(); 3].map(|()| rng.finite())),
        MeshKind::Clustered => clustered(rng, n),
        MeshKind::Slivers => soup((0..n).map(|_| sliver(rng)).collect()),
        MeshKind::Duplicates => duplicates(rng, n),
        MeshKind::Flat => {
            let (axis, level) = (rng.below(3), rng.integer(4) / 3.0);
            indexed(rng, n, |rng| {
                let mut v = [(); 3].map(|()| rng.integer(8) / 8.0);
                v[axis] = level;
                v
            })
        }
    }
}

/// A box of 12 triangles with outward faces, its corners at `min` and `max`.
pub fn cuboid(min: Vec3, max: Vec3) -> Mesh {
    let corner = |i: u32| std::array::from_fn(|axis| if i >> axis & 1 == 0 { min[axis] } else { max[axis] });
    let vertices = (0..8).map(corner).collect();
    let mut triangles = Vec::new();
    for axis in 0..3 {
        let (a, b, up) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3), 1 << axis);
        triangles.extend([[0, b, a | b], [0, a | b, a]]);
        triangles.extend([[0, a, a | b], [0, a | b, b]].map(|t| t.map(|i| i | up)));
    }
    (vertices, triangles)
}

/// A closed mesh with integer coordinates below 2^12: a random tetrahedron (it may be flat) whose
/// triangles are divided into four `levels` times, each new vertex moved by a random step that all
/// triangles around it share. It may intersect itself.
pub fn closed_mesh(seed: u64, levels: u32) -> Mesh {
    let rng = &mut Rng::new(seed);
    let size = 8 << levels;
    let mut vertices: Vec<[f32; 3]> =
        (0..4).map(|_| [(); 3].map(|()| rng.integer(4) * size as f32)).collect();
    let mut triangles = vec![[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]];
    for level in 0..levels {
        triangles = subdivide(&triangles, &mut vertices, |a, b| {
            let step = size >> (level + 2);
            std::array::from_fn(|axis| (0.5 * (a[axis] + b[axis])).floor() + rng.integer(step))
        });
    }
    (vertices, triangles)
}

/// Divides each triangle into four; `between` places the new vertex of an edge.
fn subdivide(
    triangles: &[[u32; 3]],
    vertices: &mut Vec<[f32; 3]>,
    mut between: impl FnMut([f32; 3], [f32; 3]) -> [f32; 3],
) -> Vec<[u32; 3]> {
    let mut middles = std::collections::HashMap::new();
    let mut middle = |a: u32, b: u32| {
        *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
            let vertex = between(vertices[a as usize], vertices[b as usize]);
            vertices.push(vertex);
            vertices.len() as u32 - 1
        })
    };
    let divide = |&[a, b, c]: &[u32; 3]| {
        let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
        [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
    };
    triangles.iter().flat_map(divide).collect()
}

/// `n` triangles between about as many vertices as a closed mesh would have.
fn indexed(rng: &mut Rng, n: usize, mut vertex: impl FnMut(&mut Rng) -> [f32; 3]) -> Mesh {
    let vertices: Vec<_> = (0..n / 2 + 3).map(|_| vertex(rng)).collect();
    let triangles = (0..n).map(|_| [(); 3].map(|()| rng.below(vertices.len()) as u32)).collect();
    (vertices, triangles)
}

pub(super) fn soup(triangles: Vec<[Vec3; 3]>) -> Mesh {
    let indices = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    (triangles.iter().flatten().map(|v| v.to_array()).collect(), indices)
}

fn clustered(rng: &mut Rng, n: usize) -> Mesh {
    let centers = [(); 3].map(|()| 1000.0 * rng.in_cube().as_vec3());
    let triangle = |_| {
        let (center, size) = (rng.pick(&centers), rng.pick(&[1.0, 0.01, 100.0]));
        [(); 3].map(|()| center + size * rng.in_cube().as_vec3())
    };
    soup((0..n).map(triangle).collect())
}

fn sliver(rng: &mut Rng) -> [Vec3; 3] {
    let (a, b) = (rng.in_cube(), rng.in_cube());
    let aspect = rng.pick(&[1e-2, 1e-4, 1e-6, 1e-8]);
    let c = a.lerp(b, rng.unit()) + aspect * rng.in_cube();
    [a, b, c].map(|v| v.as_vec3())
}

fn duplicates(rng: &mut Rng, n: usize) -> Mesh {
    let (vertices, triangles) = indexed(rng, 3, |rng| rng.in_cube().as_vec3().to_array());
    let copy = |_| {
        let mut triangle = rng.pick(&triangles);
        triangle.rotate_left(rng.below(3));
        if rng.below(2) == 0 {
            triangle.swap(0, 1);
        }
        triangle
    };
    (vertices, (0..n).map(copy).collect())
}
