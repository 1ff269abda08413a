//! Closed meshes: no ray gets out of one unseen.
//!
//! A mesh is closed where each of its edges belongs to an even number of triangles. Then all rays from
//! a point cross it equally often but for an even number, however it is bent or crosses itself: an odd
//! number of times from inside, an even one from outside. So a count that is not of the parity of the
//! origin shows that a crossing was lost or counted twice, and a miss from inside that a ray escaped.
//! What an origin's parity is, exact arithmetic finds on one ray.

use std::collections::HashSet;

use glam::DVec3;

use super::disagreement::Disagreement;
use super::exact;
use super::meshes::Mesh;
use super::source::{Source, narrow, towards};
use crate::build::{BuildError, Structure};
use crate::hit::Hit;
use crate::mesh::TriMesh;
use crate::ray::Ray;
use crate::scene::Scene;

/// Rays from one origin.
const RAYS: usize = 256;
/// Points tried to find one inside.
const TRIES: usize = 64;

/// A closed mesh in some structures.
///
/// ```
/// use octogrid::oracle::watertight::Watertight;
/// use octogrid::{Structure, builtin};
/// let cube = builtin::cube();
/// let leaks = Watertight::new(cube.mesh()?, &Structure::ALL)?.check(1, 1024);
/// assert_eq!((leaks.inside + leaks.outside, leaks.escapes, leaks.miscounts), (1024, 0, 0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Watertight<'a> {
    mesh: TriMesh<'a>,
    scenes: Vec<Scene>,
}

/// What [`Watertight::check`] has found.
#[derive(Clone, Debug, Default)]
pub struct Leaks {
    /// Rays from inside.
    pub inside: usize,
    /// Of these, those that [`Scene::closest`] sees escape.
    pub escapes: usize,
    /// Rays from outside.
    pub outside: usize,
    /// Rays of both that [`Scene::all`] sees cross the mesh a number of times that has the wrong parity.
    pub miscounts: usize,
    /// The first failure.
    pub first: Option<Box<Disagreement>>,
}

impl<'a> Watertight<'a> {
    /// Builds the scenes.
    ///
    /// # Errors
    /// As [`Scene::build`].
    ///
    /// # Panics
    /// Where the mesh is not closed: see [`closed_part`].
    pub fn new(mesh: TriMesh<'a>, structures: &[Structure]) -> Result<Self, BuildError> {
        assert!(odd_edges(mesh.triangles()).is_empty(), "the mesh is not closed");
        let build = |&structure: &Structure| Scene::build(&mesh, &structure.into());
        Ok(Self { mesh, scenes: structures.iter().map(build).collect::<Result<_, _>>()? })
    }

    /// The mesh.
    pub fn mesh(&self) -> &TriMesh<'a> {
        &self.mesh
    }

    /// Sends about `rays` rays at vertices, edges and triangles, as many from inside as there are points
    /// inside to be found, 256 from an origin, the next structure for each origin.
    pub fn check(&self, seed: u64, rays: usize) -> Leaks {
        let source = &mut Source::new(&self.mesh, seed);
        let mut leaks = Leaks::default();
        let mut hits = vec![Hit::MISS; self.mesh.len()];
        for scene in self.scenes.iter().cycle().take(rays.div_ceil(RAYS)) {
            let Some((origin, inside)) = self.origin(source) else { continue };
            for _ in 0..RAYS {
                let ray = towards(origin, target(source));
                if ray.is_valid() {
                    self.ray(scene, &ray, inside, &mut hits, &mut leaks);
                }
            }
        }
        leaks
    }

    fn ray(&self, scene: &Scene, ray: &Ray, inside: bool, hits: &mut [Hit], leaks: &mut Leaks) {
        let closest = scene.closest(ray);
        let all = scene.all(ray, hits);
        *(if inside { &mut leaks.inside } else { &mut leaks.outside }) += 1;
        let fail = |query, expected: &str, found: &dyn std::fmt::Debug| {
            let prims = hits[..all.len].iter().map(|hit| hit.prim);
            Disagreement::new(scene.structure().to_string(), query, &expected, found)
                .on(ray, &self.mesh, prims)
        };
        if inside && !closest.is_hit() {
            leaks.escapes += 1;
            leaks.first.get_or_insert_with(|| fail("closest from inside", "a hit", &closest));
        }
        if (all.len % 2 == 1) != inside || !all.complete {
            leaks.miscounts += 1;
            let parity = if inside { "an odd number of hits" } else { "an even number of hits" };
            leaks.first.get_or_insert_with(|| fail("all", parity, &&hits[..all.len]));
        }
    }

    /// A point off the surface, and whether it is inside.
    fn origin(&self, source: &mut Source<'_>) -> Option<(DVec3, bool)> {
        let wanted = source.rng.below(4) > 0;
        let mut found = None;
        for _ in 0..TRIES {
            let point = if wanted { source.inside() } else { source.around(1.5) };
            let point = narrow(point).as_dvec3();
            let Some(inside) = self.is_inside(source, point) else { continue };
            found = Some((point, inside));
            if inside == wanted {
                break;
            }
        }
        found
    }

    /// By the exact number of crossings of a random ray; `None` on the surface.
    fn is_inside(&self, source: &mut Source<'_>, point: DVec3) -> Option<bool> {
        let ray = Ray::new(narrow(point), source.rng.on_sphere().as_vec3());
        let answer = exact::answer(&self.mesh, &ray.with_interval(-f32::MIN_POSITIVE, f32::INFINITY));
        let touches = answer.closest.is_hit() && answer.closest.t <= f32::MIN_POSITIVE;
        (!touches).then_some(answer.all.len() % 2 == 1)
    }
}

/// A vertex, a point of an edge or of a triangle.
fn target(source: &mut Source<'_>) -> DVec3 {
    match source.rng.below(3) {
        0 => source.vertex(),
        1 => source.on_edge(),
        _ => source.on_triangle(),
    }
}

/// The triangles that are left when those at an edge of an odd number of triangles are taken away, again
/// and again: what is closed of a mesh. O(edges) for each time.
pub fn closed_part((vertices, triangles): &Mesh) -> Mesh {
    let mut triangles = triangles.clone();
    loop {
        let odd = odd_edges(&triangles);
        if odd.is_empty() {
            return (vertices.clone(), triangles);
        }
        triangles.retain(|triangle| !edges(triangle).iter().any(|edge| odd.contains(edge)));
    }
}

/// The edges of an odd number of triangles.
fn odd_edges(triangles: &[[u32; 3]]) -> HashSet<[u32; 2]> {
    let mut odd = HashSet::new();
    for edge in triangles.iter().flat_map(edges).filter(|[p, q]| p != q) {
        if !odd.insert(edge) {
            odd.remove(&edge);
        }
    }
    odd
}

fn edges(&[a, b, c]: &[u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]].map(|[p, q]| [p.min(q), p.max(q)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::oracle::meshes::{closed_mesh, cuboid};
    use glam::Vec3;

    #[test]
    fn a_hole_leaks() {
        let (vertices, triangles) = cuboid(Vec3::ZERO, Vec3::ONE);
        let mesh = TriMesh::new(&vertices, &triangles).unwrap();
        let holed = TriMesh::new(&vertices, &triangles[1..]).unwrap();
        let scenes = vec![Scene::build(&holed, &Default::default()).unwrap()];
        let leaks = Watertight { mesh, scenes }.check(1, 8000);
        assert!(leaks.inside > 4000 && leaks.outside > 500, "{leaks:?}");
        assert!(leaks.escapes > 10 && leaks.miscounts > leaks.escapes, "{leaks:?}");
        let text = leaks.first.unwrap().to_string();
        assert!(text.contains("from inside") || text.contains("`all`"), "{text}");
    }

    #[test]
    fn what_is_closed_stays() {
        let mut mesh = closed_mesh(1, 1);
        assert_eq!(closed_part(&mesh), mesh);
        let first = mesh.0.len() as u32;
        mesh.0.extend([[0.0; 3], [1.0; 3], [2.0; 3], [3.0; 3]]);
        mesh.1.extend([[0, 1, 2], [1, 2, 3]].map(|t: [u32; 3]| t.map(|i| first + i)));
        assert_eq!(closed_part(&mesh).1.len(), 16);
        mesh.1.swap_remove(3);
        assert_eq!(closed_part(&mesh).1.len(), 0);
    }
}
