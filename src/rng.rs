//! Rng (Steele, Lea, Flood 2014): a tiny generator with the same numbers on every platform.

use glam::DVec3;

/// A deterministic random number generator. Not for secrets.
#[derive(Clone, Debug)]
pub struct Rng {
    state: u64,
}

impl Rng {
    /// A generator whose numbers depend on the seed alone.
    pub fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Uniform in [low, high).
    pub fn range(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Uniform in [-1, 1).
    pub fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// Uniform in 0..n, but for a bias below n / 2^64; 0 where n is 0.
    pub fn below(&mut self, n: usize) -> usize {
        ((u128::from(self.bits()) * n as u128) >> 64) as usize
    }

    /// An integer in [-`n`, `n`], as f32.
    pub fn integer(&mut self, n: usize) -> f32 {
        self.below(2 * n + 1) as f32 - n as f32
    }

    /// One of the elements.
    ///
    /// # Panics
    /// Where there are none.
    pub fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.below(from.len())]
    }

    /// Uniform in the cube [-1, 1)^3.
    pub fn in_cube(&mut self) -> DVec3 {
        DVec3::from_array([(); 3].map(|()| self.signed()))
    }

    /// Uniform on the unit sphere.
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
            let x = f32::from_bits(self.bits() as u32);
            if x.is_finite() {
                return x;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_those_of_the_reference() {
        let mut rng = Rng::new(1_234_567);
        assert_eq!(rng.bits(), 6_457_827_717_110_365_317);
        assert_eq!(rng.bits(), 3_203_168_211_198_807_973);
    }

    #[test]
    fn ranges_hold() {
        let mut rng = Rng::new(1);
        for n in 1..1000 {
            assert!((-2.0..3.0).contains(&rng.range(-2.0, 3.0)));
            assert!(rng.below(n) < n);
        }
        assert_eq!(rng.below(0), 0);
    }
}
