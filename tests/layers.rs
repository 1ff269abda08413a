//! Holds the layering of ARCHITECTURE.md: a module imports only from layers above its own.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// The modules of each layer, the lowest-level layer first. A folder stands for all files in it.
const LAYERS: &[(&str, &[&str])] = &[
    ("numbers", &["lanes", "aabb", "exact", "rng", "parallel"]),
    ("vocabulary", &["ray", "hit", "query", "mesh", "model"]),
    (
        "pieces",
        &[
            "triangle", "filter", "prepared", "cluster", "bundle", "kernel", "overlap", "arena", "descent",
            "dda", "validate",
        ],
    ),
    ("phases", &["build", "traverse"]),
    ("surface", &["scene", "packets", "stream", "file"]),
    ("edges", &["builtin", "obj", "oracle"]),
];

/// Modules of the same layer that may import each other, in one direction: (importer, imported).
const WITHIN: &[(&str, &str)] = &[
    ("hit", "ray"),
    ("query", "hit"),
    ("model", "mesh"),
    ("filter", "triangle"),
    ("cluster", "filter"),
    ("prepared", "filter"),
    ("prepared", "triangle"),
    ("bundle", "cluster"),
    ("kernel", "cluster"),
    ("kernel", "filter"),
    ("kernel", "triangle"),
    ("arena", "cluster"),
    ("dda", "arena"),
    ("dda", "descent"),
    ("validate", "arena"),
    ("validate", "cluster"),
    ("packets", "scene"),
    ("stream", "scene"),
    ("file", "scene"),
    ("obj", "builtin"),
    ("oracle", "builtin"),
    ("oracle", "obj"),
];

fn layer(module: &str) -> usize {
    let at = LAYERS.iter().position(|(_, modules)| modules.contains(&module));
    at.unwrap_or_else(|| panic!("module {module} has no layer: add it to tests/layers.rs"))
}

/// All source files of the library with the name of their top-level module.
fn sources(folder: &Path, module: Option<&str>, found: &mut Vec<(String, PathBuf)>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let stem = path.file_stem().unwrap().to_str().unwrap().to_owned();
        if path.is_dir() {
            if stem != "bin" {
                sources(&path, Some(module.unwrap_or(&stem)), found);
            }
        } else if !(module.is_none() && stem == "lib") {
            found.push((module.unwrap_or(&stem).to_owned(), path));
        }
    }
}

/// The top-level modules that a file names after `crate::`, its tests left out.
fn imports(text: &str) -> Vec<String> {
    let code = text.split("#[cfg(test)]").next().unwrap();
    let code: String = code.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
    let name = |rest: &str| rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    let modules = code.split("crate::").skip(1).flat_map(|rest| match rest.strip_prefix('{') {
        Some(group) => group.split('}').next().unwrap().split(',').map(|part| name(part.trim())).collect(),
        None => vec![name(rest)],
    });
    modules.filter(|name| name.chars().next().is_some_and(char::is_lowercase)).collect()
}

#[test]
fn modules_import_from_layers_above() {
    let mut found = Vec::new();
    sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), None, &mut found);
    assert!(found.len() > 20, "the sources were not found");
    for (module, path) in found {
        for imported in imports(&fs::read_to_string(&path).unwrap()) {
            let downward = layer(&imported) < layer(&module);
            let allowed = imported == module || WITHIN.contains(&(&module, &imported));
            assert!(downward || allowed, "{} imports crate::{imported}", path.display());
        }
    }
}

#[test]
fn the_order_within_layers_has_no_cycle() {
    let mut after: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    WITHIN.iter().for_each(|(from, to)| after.entry(from).or_default().push(to));
    fn depth(module: &str, after: &BTreeMap<&str, Vec<&str>>, left: usize) {
        assert!(left > 0, "a cycle through {module}");
        after.get(module).into_iter().flatten().for_each(|next| depth(next, after, left - 1));
    }
    after.keys().for_each(|module| depth(module, &after, WITHIN.len() + 1));
}
