//! What is compared: every kernel on every structure with its main parameter.

use octogrid::{Kernel, Structure};

use crate::failure::Failure;
use crate::params;

/// Structures with values of their main parameter, the default one in the middle.
const MAIN: [(Structure, &str, [&str; 3]); 4] = [
    (Structure::HYBRID, "density", ["0.05", "0.1", "0.2"]),
    (Structure::OCTREE, "threshold", ["2", "4", "8"]),
    (Structure::RECURSIVE, "threshold", ["10", "19", "31"]),
    (Structure::UNIFORM, "density", ["1", "4", "16"]),
];

/// The structures, those of a kind together.
///
/// # Errors
/// Never, as long as the parameters exist.
pub(super) fn structures() -> Result<Vec<Structure>, Failure> {
    let with = |structure, key: &str, value: &str| {
        let param = format!("{key}={value}").parse().map_err(Failure::Usage)?;
        params::apply(structure, &[param]).map_err(Failure::Usage)
    };
    let all = MAIN.iter().flat_map(|(s, key, values)| values.map(|value| with(*s, key, value)));
    all.collect()
}

/// Whether it is what one gets without asking.
pub(super) fn is_default(kernel: Kernel, structure: Structure) -> bool {
    kernel == Kernel::default() && structure == Structure::HYBRID
}

/// The name of a kernel in tables.
pub(super) fn name(kernel: Kernel) -> String {
    format!("{kernel:?}").to_lowercase()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_are_among_the_structures() {
        let structures = structures().unwrap();
        assert_eq!(structures.len(), 12);
        assert!(Structure::ALL.iter().all(|default| structures.contains(default)));
    }
}
