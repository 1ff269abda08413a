//! Seeded meshes that take one property to its end.

use glam::{DQuat, DVec3, Vec3};

use super::meshes::{Mesh, closed_mesh, cuboid, soup};
use super::source::narrow;
use crate::rng::Rng;

/// The mesh with `place` of every vertex in place of it, rounded to f32.
pub fn moved((vertices, triangles): &Mesh, place: impl Fn(DVec3) -> DVec3) -> Mesh {
    let vertex = |&v: &[f32; 3]| narrow(place(Vec3::from_array(v).as_dvec3())).to_array();
    (vertices.iter().map(vertex).collect(), triangles.clone())
}

/// The mesh turned about a random axis by a random angle.
pub fn turned(mesh: &Mesh, seed: u64) -> Mesh {
    let rng = &mut Rng::new(seed);
    let turn = DQuat::from_axis_angle(rng.on_sphere(), rng.range(0.0, std::f64::consts::TAU));
    moved(mesh, |v| turn * v)
}

/// The mesh with vertices rounded to multiples of 2^-`bits` of the power of two above the largest
/// coordinate. A closed mesh stays closed, and rays between vertices become exact.
pub fn snapped(mesh: &Mesh, bits: i32) -> Mesh {
    let largest = mesh.0.as_flattened().iter().fold(f32::MIN_POSITIVE, |a, b| a.max(b.abs()));
    let step = (f64::from(largest).log2().floor() as i32 + 1 - bits) as f64;
    moved(mesh, |v| (v * (-step).exp2()).round() * step.exp2())
}

/// Both meshes as one, the triangles of `a` first.
pub fn joined(a: &Mesh, b: &Mesh) -> Mesh {
    let first = a.0.len() as u32;
    let faces = b.1.iter().map(|face| face.map(|i| i + first));
    ([&*a.0, &b.0].concat(), a.1.iter().copied().chain(faces).collect())
}

/// The cubes of an `n` x `n` x `n` lattice of integers: 6 * (n + 1) * n^2 triangles, all in planes in
/// which a grid of 2^k voxels has its own where n is a power of two.
pub fn lattice(n: u32) -> Mesh {
    let side = n + 1;
    let vertex = |i: u32| [i % side, i / side % side, i / side / side].map(|x| x as f32);
    let vertices = (0..side.pow(3)).map(vertex).collect();
    let strides = [1, side, side * side];
    let mut triangles = Vec::new();
    for axis in 0..3 {
        let [up, right] = [strides[(axis + 1) % 3], strides[(axis + 2) % 3]];
        for square in 0..side * n * n {
            let (level, i, j) = (square / (n * n), square / n % n, square % n);
            let at = level * strides[axis] + i * up + j * right;
            triangles.extend([[at, at + up, at + up + right], [at, at + up + right, at + right]]);
        }
    }
    (vertices, triangles)
}

/// `n` times the same triangle.
pub fn identical(seed: u64, n: usize) -> Mesh {
    let rng = &mut Rng::new(seed);
    ([(); 3].map(|()| rng.in_cube().as_vec3().to_array()).to_vec(), vec![[0, 1, 2]; n])
}

/// `even` triangles strewn over [-1, 1]^3, each about as large as their mean distance, and `crowd`
/// small ones in a cube of side 10^-3.
pub fn crowd(seed: u64, even: usize, crowd: usize) -> Mesh {
    let rng = &mut Rng::new(seed);
    let place = rng.in_cube();
    let around =
        |rng: &mut Rng, center: DVec3, size: f64| [(); 3].map(|()| (center + size * rng.in_cube()).as_vec3());
    let size = (even.max(1) as f64).cbrt().recip();
    let triangle = |i| {
        let near = i >= even;
        let (center, size) = if near { (place + 5e-4 * rng.in_cube(), 5e-5) } else { (rng.in_cube(), size) };
        around(rng, center, size)
    };
    soup((0..even + crowd).map(triangle).collect())
}

/// 60 triangles along one line, of area zero or so thin that they nearly are.
pub fn line(seed: u64) -> Mesh {
    let rng = &mut Rng::new(seed);
    let (start, dir) = (rng.in_cube(), rng.pick(&[DVec3::X, DVec3::Y, DVec3::Z, DVec3::ONE]));
    let off = |i: usize| if i.is_multiple_of(2) { 0.0 } else { 1e-7 };
    soup(
        (0..60)
            .map(|i| [(); 3].map(|()| (start + rng.signed() * dir + off(i) * rng.in_cube()).as_vec3()))
            .collect(),
    )
}

/// A closed mesh within a box 10^9 times as large.
pub fn nested(seed: u64) -> Mesh {
    let (far, faces) = cuboid(Vec3::NEG_ONE, Vec3::ONE);
    let near = closed_mesh(seed, 3);
    let size = near.0.as_flattened().iter().fold(1.0f32, |a, b| a.max(b.abs()));
    let side = 1e9 * f64::from(size);
    joined(&near, &moved(&(far, faces), |v| side * v))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lattices_are_planes_of_squares() {
        let (vertices, triangles) = lattice(2);
        assert_eq!((vertices.len(), triangles.len()), (27, 6 * 3 * 4));
        for triangle in triangles {
            let corners = triangle.map(|i| Vec3::from_array(vertices[i as usize]));
            let extent =
                corners[0].max(corners[1]).max(corners[2]) - corners[0].min(corners[1]).min(corners[2]);
            assert_eq!(extent.to_array().iter().sum::<f32>(), 2.0, "{corners:?}");
        }
    }

    #[test]
    fn snapped_vertices_are_multiples() {
        let (vertices, _) = snapped(&moved(&closed_mesh(1, 3), |v| 0.7 * v), 8);
        let largest = vertices.as_flattened().iter().fold(0.0f32, |a, b| a.max(b.abs()));
        let step = (largest.log2().floor() + 1.0 - 8.0).exp2();
        assert!(vertices.as_flattened().iter().all(|x| (x / step).fract() == 0.0));
    }

    #[test]
    fn nested_meshes_are_far_apart() {
        let (vertices, triangles) = nested(1);
        assert_eq!(triangles.len(), 4 * 64 + 12);
        let sizes = vertices.iter().map(|v| Vec3::from_array(*v).abs().max_element());
        assert!(sizes.clone().fold(0.0, f32::max) > 1e8 * sizes.fold(f32::MAX, f32::min));
    }
}
