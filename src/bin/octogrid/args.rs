//! Arguments that several commands share.

use clap::ValueEnum;
use octogrid::{BuildOptions, Forced, Model, Part, Quality, Structure};

use crate::failure::Failure;
use crate::params::{self, Param};

/// The values of `--structure`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Choice {
    /// The hybrid without the parts that the scene does not need
    Auto,
    /// One regular grid
    Uniform,
    /// A grid whose crowded voxels are divided, recursively
    Recursive,
    /// A cube divided by halves
    Octree,
    /// A grid on top of 4x4x4 bricks
    Hybrid,
    /// No voxels: every triangle for every ray
    Brute,
}

impl Choice {
    /// The structure with default parameters; none where the plan chooses it.
    fn structure(self) -> Option<Structure> {
        match self {
            Self::Auto => None,
            Self::Uniform => Some(Structure::UNIFORM),
            Self::Recursive => Some(Structure::RECURSIVE),
            Self::Octree => Some(Structure::OCTREE),
            Self::Hybrid => Some(Structure::HYBRID),
            Self::Brute => Some(Structure::Brute),
        }
    }
}

/// The values of `--quality`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum QualityChoice {
    /// Fast where fewer than two rays a triangle are known to be asked, else balanced
    Auto,
    /// Built in some 0.6 of the time; rays take some 1.15 of it
    Fast,
    /// For more rays than a few a triangle
    Balanced,
}

impl QualityChoice {
    /// The quality; none where the number of rays chooses it.
    fn quality(self) -> Option<Quality> {
        match self {
            Self::Auto => None,
            Self::Fast => Some(Quality::Fast),
            Self::Balanced => Some(Quality::Balanced),
        }
    }
}

/// How to build the structure.
#[derive(Debug, clap::Args)]
pub(crate) struct BuildArgs {
    /// Parameters of the structure, such as threshold=31,divisions=2
    #[arg(long, value_name = "KEY=VALUE", value_delimiter = ',')]
    params: Vec<Param>,
    /// Parts to keep or to leave out whatever the plan says, such as bricks=off,fine-grid=on
    #[arg(long, value_name = "PART=on|off", value_delimiter = ',', value_parser = parse_force)]
    force: Vec<(Part, bool)>,
    /// How much work is put into the build
    #[arg(long, value_name = "QUALITY", default_value = "auto")]
    quality: QualityChoice,
    /// The most bytes that the structure may hold; K, M and G multiply by 1024
    #[arg(long, value_name = "SIZE", value_parser = parse_size)]
    memory_limit: Option<usize>,
}

impl BuildArgs {
    /// Whether nothing is asked for.
    pub(crate) fn is_empty(&self) -> bool {
        self.params.is_empty()
            && self.force.is_empty()
            && self.quality == QualityChoice::Auto
            && self.memory_limit.is_none()
    }

    /// The options of the library.
    ///
    /// # Errors
    /// On a parameter that the structure does not have.
    pub(crate) fn options(&self, choice: Choice) -> Result<BuildOptions, Failure> {
        let structure = match choice.structure() {
            None if !self.params.is_empty() => {
                return Err(Failure::Usage(
                    "--params needs --structure with a structure other than auto".into(),
                ));
            }
            Some(_) if !self.force.is_empty() => {
                return Err(Failure::Usage(
                    "--force needs the structure auto, as others are built as they are".into(),
                ));
            }
            None => None,
            Some(structure) => Some(params::apply(structure, &self.params).map_err(Failure::Usage)?),
        };
        let default = BuildOptions::default();
        Ok(BuildOptions {
            structure,
            forced: self.forced(),
            quality: self.quality.quality().unwrap_or_default(),
            memory_limit: self.memory_limit.unwrap_or(default.memory_limit),
            ..default
        })
    }

    /// The same where at least so many rays will be asked of a model.
    pub(crate) fn for_rays(&self, options: &BuildOptions, rays: usize, model: &Model) -> BuildOptions {
        let suitable = Quality::for_rays(rays as u64, model.triangles.len());
        BuildOptions { quality: self.quality.quality().unwrap_or(suitable), ..*options }
    }

    /// The parts that are forced.
    pub(crate) fn forced(&self) -> Forced {
        self.force.iter().fold(Forced::default(), |forced, &(part, keep)| forced.with(part, keep))
    }

    /// Options for the plan's structure and each of the four voxel structures with default parameters.
    ///
    /// # Errors
    /// Where there are parameters, since no structure is chosen to have them.
    pub(crate) fn options_of_all(&self) -> Result<Vec<BuildOptions>, Failure> {
        let default = self.options(Choice::Auto)?;
        let structures = std::iter::once(None).chain(Structure::ALL.map(Some));
        Ok(structures.map(|structure| BuildOptions { structure, ..default }).collect())
    }
}

/// A part and whether it is kept.
fn parse_force(text: &str) -> Result<(Part, bool), String> {
    let names = || Part::ALL.map(Part::name).join(", ");
    let (name, keep) =
        text.split_once('=').ok_or_else(|| format!("not of the form PART=on: parts are {}", names()))?;
    let part = Part::ALL.into_iter().find(|part| part.name() == name);
    let part = part.ok_or_else(|| format!("no part '{name}': there are {}", names()))?;
    match keep {
        "on" => Ok((part, true)),
        "off" => Ok((part, false)),
        _ => Err(format!("'{keep}' must be on or off")),
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
    fn parts_are_forced_by_name() {
        assert_eq!(parse_force("fine-grid=off"), Ok((Part::FineGrid, false)));
        assert_eq!(parse_force("bricks=on"), Ok((Part::Bricks, true)));
        assert_eq!(
            parse_force("bricks"),
            Err("not of the form PART=on: parts are voxels, fine-grid, bricks".into())
        );
        assert_eq!(
            parse_force("boxes=on"),
            Err("no part 'boxes': there are voxels, fine-grid, bricks".into())
        );
        assert_eq!(parse_force("bricks=1"), Err("'1' must be on or off".into()));
    }

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
