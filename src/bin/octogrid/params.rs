//! `--params KEY=VALUE`: the fields of the chosen structure by name.

use std::str::FromStr;

use octogrid::Structure;

/// One `KEY=VALUE`.
#[derive(Clone, Debug)]
pub(crate) struct Param {
    key: String,
    value: String,
}

impl FromStr for Param {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (key, value) = text.split_once('=').ok_or("not of the form KEY=VALUE")?;
        Ok(Self { key: key.to_owned(), value: value.to_owned() })
    }
}

/// Where a value goes, by its type.
enum Field<'a> {
    Number(&'a mut f32),
    Count(&'a mut u32),
    Switch(&'a mut bool),
}

impl Field<'_> {
    /// Stores the value, or says what it must be.
    fn set(self, value: &str) -> Result<(), &'static str> {
        match self {
            Self::Number(field) => {
                let number = value.parse().ok().filter(|x: &f32| x.is_finite());
                *field = number.ok_or("a number")?;
            }
            Self::Count(field) => *field = value.parse().map_err(|_| "a whole number")?,
            Self::Switch(field) => {
                *field = match value {
                    "on" => true,
                    "off" => false,
                    _ => return Err("on or off"),
                }
            }
        }
        Ok(())
    }
}

/// The parameters of a structure.
fn fields(structure: &mut Structure) -> Vec<(&'static str, Field<'_>)> {
    use Field::{Count, Number, Switch};
    match structure {
        Structure::Uniform(p) => vec![("density", Number(&mut p.density))],
        Structure::Recursive(p) => vec![
            ("threshold", Count(&mut p.threshold)),
            ("divisions", Count(&mut p.divisions)),
            ("top_grid", Switch(&mut p.top_grid)),
        ],
        Structure::Octree(p) => {
            vec![("threshold", Count(&mut p.threshold)), ("plane_weight", Count(&mut p.plane_weight))]
        }
        Structure::Hybrid(p) => vec![
            ("density", Number(&mut p.density)),
            ("levels", Count(&mut p.levels)),
            ("group_cost", Number(&mut p.group_cost)),
            ("brick_cost", Number(&mut p.brick_cost)),
            ("voxel_cost", Number(&mut p.voxel_cost)),
        ],
        Structure::Brute => vec![],
    }
}

/// The structure with `params` in place of its own; ranges are left to the build.
///
/// # Errors
/// On an unknown key, naming the known ones, and on a value of the wrong type.
pub(crate) fn apply(mut structure: Structure, params: &[Param]) -> Result<Structure, String> {
    for Param { key, value } in params {
        let name = structure.name();
        let mut fields = fields(&mut structure);
        let keys = fields.iter().map(|f| f.0).collect::<Vec<_>>().join(", ");
        let Some(at) = fields.iter().position(|f| f.0 == key) else {
            let known = if keys.is_empty() { "has none".to_owned() } else { format!("has {keys}") };
            return Err(format!("no parameter '{key}': {name} {known}"));
        };
        let set = fields.swap_remove(at).1.set(value);
        set.map_err(|must_be| format!("the parameter {key} is '{value}', but must be {must_be}"))?;
    }
    Ok(structure)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn applied(structure: Structure, params: &[&str]) -> Result<String, String> {
        let params: Vec<Param> = params.iter().map(|p| p.parse().unwrap()).collect();
        apply(structure, &params).map(|s| s.to_string())
    }

    #[test]
    fn params_replace_fields() {
        let set = applied(Structure::RECURSIVE, &["divisions=2", "top_grid=off"]);
        assert_eq!(set.unwrap(), "R[19,2] without top grid");
        assert_eq!(applied(Structure::UNIFORM, &["density=0.5"]).unwrap(), "uniform[0.5]");
    }

    #[test]
    fn unknown_keys_list_the_known_ones() {
        let error = applied(Structure::OCTREE, &["levels=2"]).unwrap_err();
        assert_eq!(error, "no parameter 'levels': octree has threshold, plane_weight");
        assert!(applied(Structure::OCTREE, &["threshold=-1"]).unwrap_err().ends_with("a whole number"));
        assert!(applied(Structure::UNIFORM, &["density=NaN"]).unwrap_err().ends_with("a number"));
    }
}
