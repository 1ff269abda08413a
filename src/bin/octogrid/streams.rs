//! Random numbers for each of many things.

use octogrid::Rng;

/// A generator for the thing of that number, which depends on no other thing.
pub(crate) fn generator(seed: u64, number: u64) -> Rng {
    Rng::new(seed ^ Rng::new(number).bits())
}
