//! `octogrid build`, and what takes its files.

use crate::support::{Folder, QUADS, Run, rays};

const RAYS: [[f32; 8]; 2] = [
    [0.25, 0.5, 5.0, 0.0, 0.0, 0.0, -1.0, f32::INFINITY],
    [2.0, 1.3, 2.0, 0.0, 0.3, -0.4, 0.5, f32::INFINITY],
];

/// Runs a line, which must succeed, or fail with one line that says something.
fn run(folder: &Folder, line: &str, fails: Option<(i32, &str)>) -> Run {
    let run = folder.run(&line.split_whitespace().collect::<Vec<_>>());
    let (code, said) = fails.unwrap_or((0, ""));
    assert_eq!(run.code, Some(code), "{line}: {run:?}");
    assert!(run.stderr.contains(said) && !run.stderr.contains("panicked"), "{line}: {}", run.stderr);
    assert!(fails.is_some() || run.stderr.is_empty(), "{line}: {}", run.stderr);
    run
}

#[test]
fn a_saved_structure_answers_as_the_scene_does() {
    let folder = Folder::new();
    folder.write("quads.obj", QUADS);
    folder.write("rays.npy", rays(&RAYS));
    for scene in ["quads.obj", "room"] {
        for structure in ["auto", "uniform", "recursive", "octree"] {
            let built = run(&folder, &format!("build {scene} -o s.ogrid --structure {structure}"), None);
            let bytes = std::fs::metadata(folder.path("s.ogrid")).unwrap().len();
            assert!(built.stdout.contains("build, ms") && built.stdout.contains(&bytes.to_string()));
            for query in ["closest", "any", "all"] {
                for source in [scene, "s.ogrid"] {
                    let line = format!("trace {source} --rays rays.npy --query {query} --hits {source}.npy");
                    run(&folder, &line, None);
                }
                let [a, b] = [scene, "s.ogrid"].map(|s| std::fs::read(folder.path(&format!("{s}.npy"))));
                assert!(a.unwrap() == b.unwrap(), "{scene} {structure} {query}");
            }
        }
    }
    let traced = run(&folder, "trace s.ogrid --rays rays.npy --query any --hits h.npy --json", None);
    let json: serde_json::Value = serde_json::from_str(&traced.stdout).unwrap();
    assert_eq!((&json["scene"], &json["structure"]), (&"s.ogrid".into(), &"octree".into()));
    assert!(json["load_ms"].as_f64() > Some(0.0) && json["build_ms"] == 0.0, "{json}");
}

#[test]
fn a_picture_from_a_saved_structure_is_the_same() {
    let folder = Folder::new();
    run(&folder, "build room -o room.ogrid", None);
    run(&folder, "render room --size 24x18 -o built", None);
    let loaded = run(&folder, "render room --size 24x18 -o loaded --accel room.ogrid", None);
    assert!(loaded.stdout.contains("load, ms"));
    assert!(std::fs::read(folder.path("built")).unwrap() == std::fs::read(folder.path("loaded")).unwrap());
}

#[test]
fn files_that_do_not_fit_are_refused() {
    let folder = Folder::new();
    folder.write("rays.npy", rays(&RAYS));
    folder.write("quads.obj", QUADS);
    folder.write("moved.obj", QUADS.replacen("v 1 0 0", "v 1.5 0 0", 1));
    run(&folder, "build quads.obj -o quads.ogrid", None);
    let mut file = std::fs::read(folder.path("quads.ogrid")).unwrap();
    folder.write("short.ogrid", &file[..300]);
    file[300] ^= 1;
    folder.write("damaged.ogrid", &file);
    file[8] += 1;
    folder.write("newer.ogrid", &file);
    folder.write("text.ogrid", QUADS);
    let before = folder.names();
    for (file, said) in [
        ("short", "ends after 300 bytes, in its clusters"),
        ("damaged", "damaged in its clusters"),
        ("newer", "version 4"),
        ("text", "no saved scene"),
        ("none", "none.ogrid: No such file"),
    ] {
        let trace = format!("trace {file}.ogrid --rays rays.npy --query any --hits out");
        run(&folder, &trace, Some((1, said)));
        run(&folder, &format!("render quads.obj --accel {file}.ogrid -o out"), Some((1, said)));
    }
    for (line, code, said) in [
        ("render room --accel quads.ogrid -o out", 1, "built from 4 triangles"),
        ("render moved.obj --accel quads.ogrid -o out", 1, "another triangle"),
        ("render quads.ogrid -o out", 1, "--accel"),
        ("render quads.obj --accel quads.ogrid --structure octree -o out", 2, "--structure"),
        ("trace quads.ogrid --structure octree --rays rays.npy --query any --hits out", 2, "built already"),
        ("trace quads.ogrid --memory-limit 1G --rays rays.npy --query any --hits out", 2, "built already"),
        ("trace quads.ogrid --quality balanced --rays rays.npy --query any --hits out", 2, "built already"),
        ("render quads.obj --accel quads.ogrid --quality fast -o out", 2, "--quality"),
        ("build quads.obj -o out", 2, ".ogrid"),
        ("build quads.obj -o missing/out.ogrid", 1, "the folder does not exist"),
        ("build nowhere -o out.ogrid", 1, "interior"),
        ("build quads.obj -o out.ogrid --memory-limit 16", 1, "limit"),
    ] {
        run(&folder, line, Some((code, said)));
    }
    assert_eq!(folder.names(), before);
}
