//! The command as scripts see it: arguments in, exit code, output and files out.
#![cfg(feature = "cli")]

#[path = "cli/build.rs"]
mod build;
#[path = "cli/integrators.rs"]
mod integrators;
#[path = "cli/malformed.rs"]
mod malformed;
#[path = "cli/support.rs"]
mod support;
#[path = "cli/trace.rs"]
mod trace;

use std::process::Stdio;

use snapbox::assert_data_eq;
use support::{Folder, command};

#[test]
fn help_is_as_documented() {
    let help = |args: &[&str]| {
        let run = Folder::new().run(args);
        assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""));
        run.stdout
    };
    assert_data_eq!(help(&["--help"]), snapbox::file!["cli/help.txt"]);
    assert_data_eq!(help(&["render", "--help"]), snapbox::file!["cli/help-render.txt"]);
    assert_data_eq!(help(&["trace", "--help"]), snapbox::file!["cli/help-trace.txt"]);
    assert_data_eq!(help(&["analyze", "--help"]), snapbox::file!["cli/help-analyze.txt"]);
    assert_data_eq!(help(&["build", "--help"]), snapbox::file!["cli/help-build.txt"]);
    assert_data_eq!(help(&["scene", "--help"]), snapbox::file!["cli/help-scene.txt"]);
    assert_data_eq!(help(&["report", "--help"]), snapbox::file!["cli/help-report.txt"]);
    assert_data_eq!(help(&["report", "paper", "--help"]), snapbox::file!["cli/help-report-paper.txt"]);
    let convergence = help(&["report", "convergence", "--help"]);
    assert_data_eq!(convergence, snapbox::file!["cli/help-report-convergence.txt"]);
    assert_data_eq!(help(&["report", "accuracy", "--help"]), snapbox::file!["cli/help-report-accuracy.txt"]);
    assert_data_eq!(
        help(&["report", "stability", "--help"]),
        snapbox::file!["cli/help-report-stability.txt"]
    );
    assert_data_eq!(help(&["report", "scaling", "--help"]), snapbox::file!["cli/help-report-scaling.txt"]);
    assert_data_eq!(help(&["report", "plan", "--help"]), snapbox::file!["cli/help-report-plan.txt"]);
}

#[test]
fn every_view_is_a_picture_of_the_asked_size() {
    let folder = Folder::new();
    for view in ["shaded", "normals", "depth", "heat"] {
        let output = format!("{view}.png");
        let run = folder.run(&["render", "room", "--size", "40x30", "--view", view, "-o", &output]);
        assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""), "{view}");
        assert!(run.stdout.contains("Mray/s"));
        let png = std::fs::read(folder.path(&output)).unwrap();
        assert_eq!(png[..8], *b"\x89PNG\r\n\x1a\n");
        assert_eq!(png[16..24], [0, 0, 0, 40, 0, 0, 0, 30], "{view}");
    }
    assert_eq!(folder.names(), ["depth.png", "heat.png", "normals.png", "shaded.png"]);
}

#[test]
fn pictures_do_not_depend_on_threads() {
    let folder = Folder::new();
    for threads in ["1", "2"] {
        let args = ["render", "room", "--size", "24x18", "-o", threads, "--threads", threads];
        assert_eq!(folder.run(&args).code, Some(0));
    }
    assert!(std::fs::read(folder.path("1")).unwrap() == std::fs::read(folder.path("2")).unwrap());
}

#[test]
fn a_file_without_lights_or_camera_is_rendered() {
    let folder = Folder::new();
    folder.write("quads.obj", support::QUADS);
    for extra in [&["--up", "z"][..], &["--camera", "0.5,0.5,-3:0.5,0.5,0:40"], &["--structure", "octree"]] {
        let args = [&["render", "quads.obj", "--size", "9x7", "-o", "q.png"], extra].concat();
        assert_eq!(folder.run(&args).stderr, "", "{extra:?}");
    }
    assert_eq!(folder.names(), ["q.png", "quads.obj"]);
}

#[test]
fn analyze_compares_the_structures() {
    let folder = Folder::new();
    folder.write("quads.obj", support::QUADS);
    let run = folder.run(&["analyze", "quads.obj"]);
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""));
    for part in ["uniform[", "R[19,4]", "O[4,15]", "hybrid[", "refs/cluster", "100.0%"] {
        assert!(run.stdout.contains(part), "{part} in {}", run.stdout);
    }
    let run = folder.run(&["analyze", "quads.obj", "--structure", "recursive", "--params", "divisions=2"]);
    assert!(run.stdout.contains("R[19,2]") && !run.stdout.contains("O[4,15]"), "{}", run.stdout);
}

#[test]
fn analyze_tells_what_is_left_out_and_why() {
    let folder = Folder::new();
    let run = folder.run(&["analyze", "cube"]);
    for part in
        ["Plan: brute force", "voxels     left out  12 triangles: up to 40", "with all parts 117.7 bytes"]
    {
        assert!(run.stdout.contains(part), "{part} in {}", run.stdout);
    }
    let run = folder.run(&["analyze", "room", "--force", "fine-grid=off,bricks=on"]);
    for part in ["Plan: hybrid[0.1,8]", "fine-grid  left out  as asked", "bricks     kept      as asked"] {
        assert!(run.stdout.contains(part), "{part} in {}", run.stdout);
    }
}

/// One structure over the limit says nothing of the others.
#[test]
fn analyze_goes_on_where_a_plan_is_over_the_limit() {
    let run = Folder::new().run(&["analyze", "soup", "--memory-limit", "6M"]);
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""));
    for part in ["Plan: hybrid[0.1,0]", "with all parts not built (the structure needs at least", "R[19,4]"] {
        assert!(run.stdout.contains(part), "{part} in {}", run.stdout);
    }
}

#[test]
fn forced_parts_change_no_pixel() {
    let folder = Folder::new();
    let picture = |force: &[&str]| {
        let args = [&["render", "room", "--size", "40x30", "-o", "room.png"], force].concat();
        let run = folder.run(&args);
        assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""));
        std::fs::read(folder.path("room.png")).unwrap()
    };
    let planned = picture(&[]);
    for force in ["voxels=off", "bricks=on", "fine-grid=off", "bricks=on,fine-grid=off"] {
        assert!(picture(&["--force", force]) == planned, "{force}");
    }
}

#[test]
fn parts_that_are_not_there_are_no_parts() {
    let folder = Folder::new();
    for (force, what) in
        [("boxes=on", "no part 'boxes': there are voxels"), ("bricks=no", "must be on or off")]
    {
        let run = folder.run(&["analyze", "cube", "--force", force]);
        assert!(run.code == Some(2) && run.stderr.contains(what), "{}", run.stderr);
    }
    let run = folder.run(&["render", "cube", "--structure", "octree", "--force", "bricks=on"]);
    assert!(run.code == Some(2) && run.stderr.contains("--force needs the structure auto"), "{}", run.stderr);
}

#[test]
fn built_in_scenes_are_listed_and_written() {
    let folder = Folder::new();
    let run = folder.run(&["scene", "--list"]);
    assert_eq!(run.code, Some(0));
    assert!(run.stdout.contains("room") && run.stdout.contains("interior"));
    let run = folder.run(&["scene", "room", "-o", "room.obj"]);
    assert_eq!((run.code, run.stdout.as_str(), run.stderr.as_str()), (Some(0), "", ""));
    assert_eq!(folder.names(), ["room.mtl", "room.obj"]);
    let run = folder.run(&["analyze", "room.obj"]);
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""));
}

#[test]
fn a_reader_that_goes_away_is_no_failure() {
    for args in [&["scene", "--list"][..], &["analyze", "room"], &["--help"]] {
        let mut child = command(args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert_eq!((output.status.code(), output.stderr), (Some(0), vec![]), "{args:?}");
    }
}
