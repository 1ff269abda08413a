//! SplitMix64: the same numbers from the same seed, everywhere and for ever.
//!
//! Steele, Lea and Flood, "Fast splittable pseudorandom number generators", 2014.

use glam::DVec3;

/// A small seeded generator.
///
/// ```
/// use octogrid::oracle::SplitMix64;
/// assert_eq!(SplitMix64::new(0).next_u64(), 0xe220_a839_7b1d_cdaf);
/// ```
#[derive(Clone, Debug)]
pub struct SplitMix64(u64);

impl SplitMix64 {
    /// Starts from a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// 64 random bits.
    pub fn next_u64(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = self.0;
        let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// An integer in [0, `n`).
    ///
    /// # Panics
    /// Where `n` is 0.
    pub fn below(&mut self, n: usize) -> usize {
        (self.next_u64() % n as u64) as usize
    }

    /// One of the elements.
    ///
    /// # Panics
    /// Where there are none.
    pub fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.below(from.len())]
    }

    /// An integer in [-`n`, `n`], as f32.
    pub fn integer(&mut self, n: usize) -> f32 {
        self.below(2 * n + 1) as f32 - n as f32
    }

    /// A number in [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A number in [-1, 1).
    pub fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// A point in the cube [-1, 1)^3.
    pub fn in_cube(&mut self) -> DVec3 {
        DVec3::from_array([(); 3].map(|()| self.signed()))
    }

    /// A point of the unit sphere, uniformly.
    pub fn on_sphere(&mut self) -> DVec3 {
        loop {
            let p = self.in_cube();
            if (1e-6..=1.0).contains(&p.length_squared()) {
                return p.normalize();
            }
        }
    }

    /// Any f32 bits but those of NaN and infinity.
    pub fn finite(&mut self) -> f32 {
        loop {
            let x = f32::from_bits(self.next_u64() as u32);
            if x.is_finite() {
                return x;
            }
        }
    }
}
