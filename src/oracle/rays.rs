//! Seeded sets of rays for a mesh: ordinary ones and hazards.

use std::f64::consts::TAU;

use glam::{DVec3, Vec3};

use super::exact;
use super::source::{Source, narrow, towards};
use crate::mesh::TriMesh;
use crate::query::EdgeRule;
use crate::ray::Ray;
use crate::rng::Rng;

/// A kind of rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RaySet {
    /// From around the bounding sphere to points in the bounding box.
    Random,
    /// From points in the box and on triangles, in any direction.
    Inside,
    /// A pinhole camera's, one a pixel, row after row.
    Camera,
    /// At vertices and at points of edges, many of them exactly.
    Aimed,
    /// Along axes and with one component of zero of either sign, from the coordinates of vertices.
    Axis,
    /// Along diagonals of two or three axes, from vertices and points of edges: through edges and
    /// corners of voxels.
    Diagonal,
    /// In the plane of a triangle, along its edges and across.
    Planar,
    /// At points of triangles, almost in their planes.
    Grazing,
    /// At points of triangles that are long and thin, from near and far.
    Sliver,
    /// From 10^6 and 10^18 times the size away.
    Far,
    /// With directions from subnormal to 10^38 long, some with an end of the interval at a hit.
    Scaled,
    /// With ends of the interval on a surface, next to it, negative and infinite.
    Interval,
    /// With NaN, infinities, a direction of zero or an empty interval: these meet nothing.
    Invalid,
}

impl RaySet {
    /// All of them.
    pub const ALL: [RaySet; 13] = [
        Self::Random,
        Self::Inside,
        Self::Camera,
        Self::Aimed,
        Self::Axis,
        Self::Diagonal,
        Self::Planar,
        Self::Grazing,
        Self::Sliver,
        Self::Far,
        Self::Scaled,
        Self::Interval,
        Self::Invalid,
    ];

    /// `n` rays, the same ones for the same mesh and seed.
    pub fn rays(self, mesh: &TriMesh<'_>, seed: u64, n: usize) -> Vec<Ray> {
        let source = &mut Source::new(mesh, seed);
        if self == Self::Camera {
            return camera(source, n);
        }
        (0..n).map(|_| self.ray(source)).collect()
    }

    fn ray(self, source: &mut Source<'_>) -> Ray {
        match self {
            Self::Random | Self::Camera => random(source),
            Self::Inside => inside(source),
            Self::Aimed => aimed(source),
            Self::Axis => axis(source),
            Self::Diagonal => diagonal(source),
            Self::Planar => planar(source),
            Self::Grazing => grazing(source),
            Self::Sliver => sliver(source),
            Self::Far => far(source),
            Self::Scaled => scaled(source),
            Self::Interval => interval(source),
            Self::Invalid => invalid(source),
        }
    }
}

/// `n` rays of all sets in turn.
pub fn hazards(mesh: &TriMesh<'_>, seed: u64, n: usize) -> Vec<Ray> {
    in_turn(&RaySet::ALL, mesh, seed, n)
}

/// `n` rays of some sets in turn; none where there are no sets.
pub fn in_turn(sets: &[RaySet], mesh: &TriMesh<'_>, seed: u64, n: usize) -> Vec<Ray> {
    let each = n.div_ceil(sets.len().max(1));
    let rays: Vec<Vec<Ray>> = sets.iter().map(|set| set.rays(mesh, seed, each)).collect();
    let end = if sets.is_empty() { 0 } else { n };
    (0..end).map(|i| rays[i % rays.len()][i / rays.len()]).collect()
}

/// Each ray `n` times, the first time as it is and then moved a little, so that all go nearly alike: a few
/// units in the last place, or up to 1/100 of its direction, or with another interval.
pub fn companions(rays: &[Ray], seed: u64, n: usize) -> Vec<Ray> {
    let rng = &mut Rng::new(seed);
    rays.iter()
        .flat_map(|ray| (0..n).map(|i| if i == 0 { *ray } else { companion(ray, rng) }).collect::<Vec<_>>())
        .collect()
}

fn companion(ray: &Ray, rng: &mut Rng) -> Ray {
    let mut near = *ray;
    let axis = rng.below(3);
    match rng.below(5) {
        0 => {}
        1 => near.dir[axis] = [near.dir[axis].next_up(), near.dir[axis].next_down()][rng.below(2)],
        2 => near.origin[axis] = [near.origin[axis].next_up(), near.origin[axis].next_down()][rng.below(2)],
        3 => near.dir += (0.01 * rng.unit()) as f32 * near.dir.abs().max_element() * rng.in_cube().as_vec3(),
        _ => near.t_max = (rng.unit() * 2.0) as f32 * near.t_max.min(1.0),
    }
    near
}

fn random(source: &mut Source<'_>) -> Ray {
    towards(source.around(1.5), source.inside())
}

fn inside(source: &mut Source<'_>) -> Ray {
    let origin = if source.rng.below(2) == 0 { source.inside() } else { source.on_triangle() };
    Ray::new(narrow(origin), source.rng.on_sphere().as_vec3())
}

fn camera(source: &mut Source<'_>, n: usize) -> Vec<Ray> {
    let eye = source.around(2.0);
    let forward = (source.center() - eye).normalize();
    let right = forward.any_orthonormal_vector();
    let up = right.cross(forward);
    let side = (n as f64).sqrt().ceil() as usize;
    let offset = |pixel: usize| 1.1 * ((pixel as f64 + 0.5) / side as f64 - 0.5);
    let pixel = |i| forward + offset(i % side) * right - offset(i / side) * up;
    (0..n).map(|i| Ray::new(narrow(eye), pixel(i).as_vec3())).collect()
}

fn aimed(source: &mut Source<'_>) -> Ray {
    let target = narrow(if source.rng.below(2) == 0 { source.vertex() } else { source.on_edge() });
    let target = target.as_dvec3();
    match source.rng.below(4) {
        0 => towards(source.around(1.5), target),
        1 => towards(source.vertex(), target),
        _ => {
            let step = source.short_vector(4);
            Ray::new(narrow(target - source.rng.pick(&[1.0, 2.0, 4.0, 0.5]) * step), narrow(step))
        }
    }
}

/// Along `free` axes only; the other components are zeros of random sign.
fn along(source: &mut Source<'_>, free: usize) -> Ray {
    let first = source.rng.below(3);
    let target = narrow(source.on_edge());
    let mut ray = Ray::new(target, [0.0; 3]);
    for i in 0..3 {
        let axis = (first + i) % 3;
        let component = if i < free { source.short_vector(4)[axis] as f32 } else { 0.0 };
        ray.dir[axis] = component * source.rng.pick(&[1.0, -1.0]);
    }
    if ray.dir == Vec3::ZERO {
        ray.dir[first] = source.radius() as f32;
    }
    let back = source.rng.pick(&[0.0, 1.0, 8.0]);
    Ray::new(narrow(target.as_dvec3() - back * ray.dir.as_dvec3()), ray.dir)
}

fn axis(source: &mut Source<'_>) -> Ray {
    match source.rng.below(3) {
        0 => along(source, 2),
        1 => along(source, 1),
        _ => {
            // The coordinates of different vertices: on vertex planes, seldom on a vertex.
            let mut ray = along(source, 1);
            let fixed = (0..3).find(|&axis| ray.dir[axis] == 0.0).unwrap_or(0);
            ray.origin[fixed] = narrow(source.vertex())[fixed];
            ray
        }
    }
}

fn diagonal(source: &mut Source<'_>) -> Ray {
    let target = narrow(source.on_edge()).as_dvec3();
    let dir = source.short_vector(1);
    Ray::new(narrow(target - source.rng.pick(&[0.0, 1.0, 4.0, 8.0]) * dir), narrow(dir))
}

fn planar(source: &mut Source<'_>) -> Ray {
    let [a, b, c] = source.corners().map(|v| v.as_dvec3());
    let [s, t, back] = [(); 3].map(|()| f64::from(source.rng.integer(2)));
    let dir = s * (b - a) + t * (c - a);
    let start = source.rng.pick(&[a, b, c, 0.5 * (b + c)]);
    Ray::new(narrow(start - back * dir), narrow(dir))
}

fn grazing(source: &mut Source<'_>) -> Ray {
    let corners @ [a, b, c] = source.corners().map(|v| v.as_dvec3());
    let target = source.within(corners);
    let normal = (b - a).cross(c - a).normalize_or(DVec3::Y);
    let along = normal.any_orthonormal_vector().rotate_axis(normal, source.rng.range(0.0, TAU));
    let angle = source.rng.pick(&[1e-2, 1e-3, 1e-4, 1e-5, 1e-7]);
    let distance = (b - a).length().max((c - a).length()) * source.rng.pick(&[0.5, 1.0, 10.0]);
    towards(target - distance * (along + angle * normal), target)
}

fn sliver(source: &mut Source<'_>) -> Ray {
    let thin = source.thin();
    let target = source.within(thin);
    let distance = source.radius() * source.rng.pick(&[1.5, 0.1, 0.01]);
    towards(target + distance * source.rng.on_sphere(), target)
}

fn far(source: &mut Source<'_>) -> Ray {
    let distance = source.rng.pick(&[1e6, 1e18]);
    match source.rng.below(3) {
        0 => towards(source.around(distance), source.on_triangle()),
        1 => {
            let ray = towards(source.around(distance), source.on_triangle());
            Ray { dir: ray.dir.as_dvec3().normalize_or_zero().as_vec3(), ..ray }
        }
        _ => {
            let ray = along(source, 1);
            let origin = ray.origin.as_dvec3() - distance * ray.dir.as_dvec3();
            Ray { origin: narrow(origin), ..ray }
        }
    }
}

fn scaled(source: &mut Source<'_>) -> Ray {
    let (ray, met) = match source.rng.below(3) {
        0 => (random(source), None),
        1 => (aimed(source), None),
        _ => {
            let (ray, corners) = at_triangle(source);
            (ray, Some(corners))
        }
    };
    let length = source.rng.pick(&[1e-44, 1e-42, 1e-38, 1e-30, 1e-10, 1e10, 1e30, 1e38]);
    let dir = ray.dir.as_dvec3().normalize_or_zero() * length;
    let ray = Ray { dir: narrow(dir), ..ray };
    met.map_or(ray, |corners| ending_at(source, ray, corners))
}

fn interval(source: &mut Source<'_>) -> Ray {
    let (ray, corners) = at_triangle(source);
    ending_at(source, ray, corners)
}

/// A ray and a triangle that it mostly meets.
fn at_triangle(source: &mut Source<'_>) -> (Ray, [Vec3; 3]) {
    let corners = source.corners();
    let target = corners.iter().map(|v| v.as_dvec3()).sum::<DVec3>() / 3.0;
    let ray = match source.rng.below(3) {
        0 => along(source, 1),
        1 => towards(source.inside(), target),
        _ => towards(source.around(1.5), target),
    };
    (ray, corners)
}

/// The ray with an end of its interval where it meets the triangle, or next to that.
fn ending_at(source: &mut Source<'_>, ray: Ray, corners: [Vec3; 3]) -> Ray {
    let on = exact::intersect(&ray, corners, EdgeRule::Closed).map_or(1.0, |hit| hit.t);
    let t = source.rng.pick(&[on, on.next_up(), on.next_down()]);
    match source.rng.below(6) {
        0 => ray.with_interval(t, f32::INFINITY),
        1 => ray.with_interval(f32::NEG_INFINITY, t),
        2 => ray.with_interval(t.next_down(), t),
        3 => ray.with_interval(0.0, t),
        4 => ray.with_interval(-t.abs(), 2.0 * t.abs()),
        _ => ray.with_interval(f32::NEG_INFINITY, -0.0),
    }
}

fn invalid(source: &mut Source<'_>) -> Ray {
    let mut values = bytemuck::cast::<Ray, [f32; 8]>(random(source));
    let at = source.rng.below(8);
    match source.rng.below(4) {
        0 => values[at] = f32::NAN,
        1 => values[4 + at % 3] = source.rng.pick(&[f32::INFINITY, f32::NEG_INFINITY]),
        2 => values[4..7].fill(source.rng.pick(&[0.0, -0.0])),
        _ => values[7] = source.rng.pick(&[values[3], -1.0, f32::NEG_INFINITY]),
    }
    bytemuck::cast(values)
}
