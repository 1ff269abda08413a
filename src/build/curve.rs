//! The cells of a grid along Morton's curve, on which neighbours mostly follow one another.
//!
//! Source: G. M. Morton, "A Computer Oriented Geodetic Data Base and a New Technique in File Sequencing", 1966.

use super::grid::Places;
use crate::aabb::Aabb;
use crate::arena::Grid;

/// Places on the curve.
pub(super) struct Curve {
    places: Places,
    /// By axis and index along it: the bits of a place.
    bits: [Vec<u32>; 3],
    len: usize,
}

impl Curve {
    /// Through the cells of a grid with no more than 2^31 of them, were each of its sides a power of two.
    pub(super) fn new(grid: &Grid) -> Self {
        let mut bits = grid.dims.map(|n| vec![0; n as usize]);
        let mut place = 0;
        for bit in 0..u32::BITS {
            for axis in 0..3 {
                if grid.dims[axis] > 1 && (grid.dims[axis] - 1) >> bit != 0 {
                    (0..).zip(&mut bits[axis]).for_each(|(i, all): (u32, _)| *all |= (i >> bit & 1) << place);
                    place += 1;
                }
            }
        }
        Self { places: Places::new(grid), bits, len: 1 << place }
    }

    /// One more than the last place.
    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// The place of the cell that the centre of a box is in, but for rounding.
    #[inline(always)]
    pub(super) fn of(&self, b: &Aabb) -> u32 {
        let at = self.places.at(b);
        (0..3).map(|axis| self.bits[axis][at[axis] as usize]).sum()
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn every_cell_has_a_place_of_its_own() {
        for dims in [[1, 1, 1], [4, 4, 4], [5, 1, 9], [1, 1000, 2]] {
            let curve = Curve::new(&Grid::new([0.0; 3], 1.0, dims));
            let cells = (0..dims[2])
                .flat_map(|z| (0..dims[1]).flat_map(move |y| (0..dims[0]).map(move |x| [x, y, z])));
            let middle = |cell: [u32; 3]| Vec3::from_array(cell.map(|i| i as f32 + 0.5));
            let mut places: Vec<u32> =
                cells.map(|c| curve.of(&Aabb { lo: middle(c), hi: middle(c) })).collect();
            places.sort_unstable();
            assert!(places.windows(2).all(|two| two[0] < two[1]), "{dims:?}");
            assert!(places.iter().all(|&place| (place as usize) < curve.len()), "{dims:?}");
        }
        let curve = Curve::new(&Grid::new([0.0; 3], 1.0, [2, 2, 2]));
        let corner = Vec3::new(1.5, 0.5, 1.5);
        assert_eq!(curve.of(&Aabb { lo: corner, hi: corner }), 0b101);
    }
}
