//! Shadow rays and complete lists of hits.

use octogrid::TriMesh;
use octogrid::oracle::{Agreement, brute};

use super::case::Case;

/// Counted queries and buffers that are too small, on a closed mesh: each triangle becomes a
/// tetrahedron with the first vertex, so that every line crosses an even number of triangles.
pub fn any_all(case: &Case) {
    case.run(|mesh, rays| {
        let close = |&[a, b, c]: &[u32; 3]| [[a, b, c], [0, b, a], [0, c, b], [0, a, c]];
        let triangles: Vec<_> = mesh.triangles().iter().take(6).flat_map(close).collect();
        let mesh = TriMesh::new(mesh.vertices(), &triangles).expect("the mesh was valid");
        let agreement = Agreement { decorated: 4, ..case.agreement() };
        agreement.assert(&mesh, rays);

        let lines = case.integer_lines();
        for (line, answer) in lines.iter().zip(brute::answers(&mesh, &lines)) {
            assert!(answer.all.len().is_multiple_of(2), "{line:?} has an odd number of {:?}", answer.all);
        }
    });
}
