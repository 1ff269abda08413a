//! Scenes in several sizes.

use octogrid::{Model, builtin};

use crate::failure::Failure;
use crate::load;

/// Triangles of the smallest scenes.
const SMALLEST: usize = 10_000;

/// A scene in every size that it can have; as it is where it is too large for all.
///
/// # Errors
/// Where it can't be used, or has no triangles.
pub(super) fn models(scene: &str, largest: usize) -> Result<Vec<Model>, Failure> {
    let sizes = sizes(largest);
    if scene == "soup" {
        return Ok(sizes.into_iter().map(|n| builtin::soup(n, 1)).collect());
    }
    let model = load::load(scene)?.model;
    let own = model.triangles.len();
    if own == 0 {
        return Err(Failure::Expected(format!("{scene} has no triangles to divide")));
    }
    let models: Vec<Model> = sizes.into_iter().filter(|&n| n >= own).map(|n| refined(&model, n)).collect();
    Ok(if models.is_empty() { vec![model] } else { models })
}

/// The powers of ten below a number, and the number.
fn sizes(largest: usize) -> Vec<usize> {
    let below = std::iter::successors(Some(SMALLEST), |n| n.checked_mul(10)).take_while(|&n| n < largest);
    below.chain([largest]).collect()
}

/// A model of some triangles divided into at least `size`, two more at most. Without materials.
///
/// All are divided alike but for the last time, when those that are lie evenly spread in their order.
/// Every division makes vertices of its own.
fn refined(model: &Model, size: usize) -> Model {
    let (mut vertices, mut triangles) = (model.vertices.clone(), model.triangles.clone());
    while triangles.len() < size {
        let count = triangles.len();
        let divided = (size - count).div_ceil(3).min(count);
        let mut parts = Vec::with_capacity(count + 3 * divided);
        for (i, &triangle) in triangles.iter().enumerate() {
            if (i + 1) * divided / count > i * divided / count {
                parts.extend(quarters(triangle, &mut vertices));
            } else {
                parts.push(triangle);
            }
        }
        triangles = parts;
    }
    Model { vertices, triangles, ..Default::default() }
}

/// The parts of a triangle between its corners and the middles of its edges.
fn quarters([a, b, c]: [u32; 3], vertices: &mut Vec<[f32; 3]>) -> [[u32; 3]; 4] {
    let mut middle = |i: u32, j: u32| {
        let [p, q] = [i, j].map(|i| vertices[i as usize]);
        vertices.push(std::array::from_fn(|axis| f32::midpoint(p[axis], q[axis])));
        vertices.len() as u32 - 1
    };
    let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_powers_of_ten_and_the_largest() {
        assert_eq!(sizes(7), [7]);
        assert_eq!(sizes(10_000), [10_000]);
        assert_eq!(sizes(250_000), [10_000, 100_000, 250_000]);
    }

    #[test]
    fn refined_triangles_cover_the_same_area() {
        let cube = builtin::cube();
        for size in [12, 13, 20, 48, 1000] {
            let refined = refined(&cube, size);
            assert!((size..size + 3).contains(&refined.triangles.len()), "{size}");
            let mesh = refined.mesh().unwrap();
            let area = |i| {
                let [a, b, c] = mesh.corners(i);
                0.5 * (b - a).cross(c - a).length()
            };
            let area: Vec<f32> = (0..mesh.len() as u32).map(area).collect();
            assert_eq!(area.iter().sum::<f32>(), 24.0, "{size}");
            let least = area.iter().copied().fold(f32::MAX, f32::min);
            assert!(area.iter().all(|&a| a <= 4.0 * least), "{size}");
        }
    }
}
