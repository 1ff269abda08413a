//! Arguments that several commands share.

use clap::ValueEnum;
use octogrid::{BuildOptions, Structure};

use crate::failure::Failure;
use crate::params::{self, Param};

/// The values of `--structure`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Choice {
    /// The best structure for the scene
    Auto,
    /// One regular grid
    Uniform,
    /// A grid whose crowded voxels are divided, recursively
    Recursive,
    /// A cube divided by halves
    Octree,
    /// A grid on top of 4x4x4 bricks
    Hybrid,
}

impl Choice {
    /// The structure with default parameters.
    fn structure(self) -> Structure {
        match self {
            Self::Uniform => Structure::UNIFORM,
            Self::Recursive => Structure::RECURSIVE,
            Self::Octree => Structure::OCTREE,
            Self::Auto | Self::Hybrid => Structure::HYBRID,
        }
    }
}

/// How to build the structure.
#[derive(Debug, clap::Args)]
pub(crate) struct BuildArgs {
    /// Parameters of the structure, such as threshold=31,divisions=2
    #[arg(long, value_name = "KEY=VALUE", value_delimiter = ',')]
    params: Vec<Param>,
    /// The most bytes that the structure may hold; K, M and G multiply by 1024
    #[arg(long, value_name = "SIZE", value_parser = parse_size)]
    memory_limit: Option<usize>,
}

impl BuildArgs {
    /// Whether nothing is asked for.
    pub(crate) fn is_empty(&self) -> bool {
        self.params.is_empty() && self.memory_limit.is_none()
    }

    /// The options of the library.
    ///
    /// # Errors
    /// On a parameter that the structure does not have.
    pub(crate) fn options(&self, choice: Choice) -> Result<BuildOptions, Failure> {
        if choice == Choice::Auto && !self.params.is_empty() {
            return Err(Failure::Usage("--params needs --structure with a structure other than auto".into()));
        }
        let structure = params::apply(choice.structure(), &self.params).map_err(Failure::Usage)?;
        let default = BuildOptions::default();
        Ok(BuildOptions {
            structure,
            memory_limit: self.memory_limit.unwrap_or(default.memory_limit),
            ..default
        })
    }

    /// Options for each of the four structures with default parameters.
    ///
    /// # Errors
    /// Where there are parameters, since no structure is chosen to have them.
    pub(crate) fn options_of_all(&self) -> Result<Vec<BuildOptions>, Failure> {
        let default = self.options(Choice::Auto)?;
        Ok(Structure::ALL.map(|structure| BuildOptions { structure, ..default }).into())
    }
}

/// Bytes, with an optional suffix K, M or G.
fn parse_size(text: &str) -> Result<usize, String> {
    let split = text.len() - text.ends_with(['K', 'M', 'G', 'k', 'm', 'g']) as usize;
    let (digits, suffix) = text.split_at(split);
    let shift = match suffix {
        "K" | "k" => 10,
        "M" | "m" => 20,
        "G" | "g" => 30,
        _ => 0,
    };
    let number: usize = digits.parse().map_err(|_| "not a number of bytes such as 500000, 64M or 2G")?;
    number.checked_mul(1 << shift).ok_or_else(|| "too large".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_have_suffixes() {
        assert_eq!(parse_size("12"), Ok(12));
        assert_eq!(parse_size("3k"), Ok(3072));
        assert_eq!(parse_size("2G"), Ok(2 << 30));
        for bad in ["", "K", "-1", "1.5M", "9KK", "99999999999999G", "1é"] {
            assert!(parse_size(bad).is_err(), "{bad}");
        }
    }
}
