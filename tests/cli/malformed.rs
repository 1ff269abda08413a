//! Malformed input of every kind: the exit code, one line that says why, and nothing left behind.

use crate::support::{Folder, QUADS, npy, rays};

const ONE_RAY: [f32; 8] = [0.25, 0.5, 5.0, 0.0, 0.0, 0.0, -1.0, f32::INFINITY];

/// OBJ files that no scene can be made of, and the line at fault.
const OBJ_FILES: &[(&str, &str, u32)] = &[
    ("nan.obj", "v 0 0 0\nv NaN 0 0\nv 0 1 0\nf 1 2 3\n", 2),
    ("infinite.obj", "v 0 0 0\nv 1 0 0\nv 0 inf 0\nf 1 2 3\n", 3),
    ("range.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", 4),
    ("zero.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", 4),
    ("before.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -4 1 2\n", 4),
    ("edge.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\n", 4),
    ("short.obj", "v 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", 1),
    ("words.obj", "v a b c\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", 1),
];

/// npy files that are not rays, and a part of what is said of them.
fn npy_files() -> Vec<(&'static str, Vec<u8>, &'static str)> {
    let header = |descr: &str, order: &str, shape: &str| {
        format!("{{'descr': {descr}, 'fortran_order': {order}, 'shape': {shape}, }}\n")
    };
    let fine = rays(&[ONE_RAY]);
    let with = |descr, order, shape| npy(&header(descr, order, shape), &[0; 64]);
    let mut magic = fine.clone();
    magic[0] = b'N';
    let mut version = fine.clone();
    version[6] = 9;
    let mut long = fine.clone();
    long[6..10].copy_from_slice(&[2, 0, 255, 255]);
    long[10..12].copy_from_slice(&[255, 255]);
    vec![
        ("nothing.npy", vec![], "not an npy file"),
        ("magic.npy", magic, "not an npy file"),
        ("version.npy", version, "version 9"),
        ("long.npy", long, "bytes is not one of rays"),
        ("half.npy", fine[..40].to_vec(), "header is truncated"),
        ("f8.npy", with("'<f8'", "False", "(1, 8)"), "the file has <f8"),
        ("big.npy", with("'>f4'", "False", "(1, 8)"), "the file has >f4"),
        ("fields.npy", with("[('t', '<f4')]", "False", "(1, 8)"), "a structured type"),
        ("flat.npy", with("'<f4'", "False", "(8,)"), "(8,), C order"),
        ("seven.npy", with("'<f4'", "False", "(1, 7)"), "(1,7,), C order"),
        ("cube.npy", with("'<f4'", "False", "(1, 1, 8)"), "(1,1,8,), C order"),
        ("fortran.npy", with("'<f4'", "True", "(2, 8)"), "Fortran order"),
        ("huge.npy", with("'<f4'", "False", "(18446744073709551615, 8)"), "n < 2^32"),
        ("claim.npy", with("'<f4'", "False", "(4000000000, 8)"), "truncated: 2 rays of 4000000000"),
        ("negative.npy", with("'<f4'", "False", "(-1, 8)"), "no valid 'shape'"),
        ("dict.npy", npy("{'descr': '<f4'}", &[0; 32]), "no valid 'fortran_order'"),
        ("nested.npy", npy(&"(".repeat(60_000), &[]), "no valid 'descr'"),
        ("data.npy", fine[..fine.len() - 1].to_vec(), "truncated: 0 rays of 1"),
    ]
}

/// Arguments, exit code, and a part of what is said.
const COMMAND_LINES: &[(&str, i32, &str)] = &[
    ("", 2, "Usage"),
    ("draw", 2, "unrecognized subcommand"),
    ("render nowhere -o out", 1, "interior"),
    ("render nowhere.obj -o out", 1, "no such file"),
    ("render folder -o out", 1, "folder"),
    ("render room -o missing/out", 1, "the folder does not exist"),
    ("render room -o fine.obj/out", 1, "can't write"),
    ("render room -o folder", 1, "is a directory"),
    ("render room -o out --structure bush", 2, "hybrid"),
    ("render room -o out --structure octree --params levels=3", 2, "threshold, plane_weight"),
    ("render room -o out --structure octree --params threshold=x", 2, "a whole number"),
    ("render room -o out --structure octree --params threshold", 2, "KEY=VALUE"),
    ("render room -o out --params density=1", 2, "--structure"),
    ("render room -o out --view upwards", 2, "normals"),
    ("render room -o out --size 0x0", 2, "at least one pixel"),
    ("render room -o out --size 100000x100000", 2, "pixels"),
    ("render room -o out --size 99999999999x1", 2, "number of pixels"),
    ("render room -o out --size 800", 2, "WxH"),
    ("render room -o out --camera 999", 2, "no camera 999"),
    ("render fine.obj -o out --camera 0", 2, "no camera 0"),
    ("render room -o out --camera here", 2, "X,Y,Z"),
    ("render room -o out --camera 0,1,2:0,1,2", 2, "the eye is at the target"),
    ("render room -o out --camera 0,1,2:0,1", 2, "not a point"),
    ("render room -o out --camera 0,1,2:0,0,0:200", 2, "field of view"),
    ("render room -o out --threads 0", 2, "threads"),
    ("render room -o out --memory-limit 12Q", 2, "bytes"),
    ("render room -o out --memory-limit 16", 1, "limit"),
    ("trace fine.obj --query any --hits out", 2, "--rays"),
    ("trace fine.obj --rays none.npy --query any --hits out", 1, "none.npy"),
    ("trace fine.obj --rays folder --query any --hits out", 1, "folder"),
    ("trace fine.obj --rays fine.npy --query some --hits out", 2, "closest"),
    ("trace fine.obj --rays fine.npy --query any --hits out --repeat 0", 2, "repeat"),
    ("scene nowhere -o out.obj", 1, "interior"),
    ("scene room", 2, "--output"),
];

fn folder() -> Folder {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("folder")).unwrap();
    folder.write("fine.obj", QUADS);
    folder.write("fine.npy", rays(&[ONE_RAY]));
    folder
}

fn check(folder: &Folder, line: &str, code: i32, said: &str) {
    let before = folder.names();
    let run = folder.run(&line.split_whitespace().collect::<Vec<_>>());
    assert_eq!(run.code, Some(code), "{line}: {run:?}");
    assert!(run.stderr.contains(said), "{line}: {}", run.stderr);
    assert!(!run.stderr.contains("panicked"), "{line}: {}", run.stderr);
    assert_eq!(run.stdout, "", "{line}");
    if code == 1 {
        assert_eq!(run.stderr.lines().count(), 1, "{line}: {}", run.stderr);
    }
    assert_eq!(folder.names(), before, "{line}");
}

#[test]
fn obj_files() {
    let folder = folder();
    for (name, content, line) in OBJ_FILES {
        folder.write(name, content);
        let said = format!("octogrid: {name}:{line}: ");
        check(&folder, &format!("analyze {name}"), 1, &said);
        check(&folder, &format!("render {name} -o out"), 1, &said);
    }
}

#[test]
fn mtl_files() {
    let folder = folder();
    folder.write("scene.obj", format!("mtllib words.mtl\n{QUADS}"));
    folder.write("words.mtl", "newmtl a\nKd red 0 0\n");
    check(&folder, "analyze scene.obj", 1, "octogrid: words.mtl:2: ");
}

#[test]
fn npy_arrays() {
    let folder = folder();
    for (name, content, said) in npy_files() {
        folder.write(name, content);
        check(&folder, &format!("trace fine.obj --rays {name} --query any --hits out"), 1, said);
    }
}

#[test]
fn command_lines() {
    let folder = folder();
    for (line, code, said) in COMMAND_LINES {
        check(&folder, line, *code, said);
    }
}

/// A grid far beyond the memory limit is refused, not made first: there is address space for less.
#[cfg(target_os = "linux")]
#[test]
fn a_grid_beyond_the_memory_limit_is_not_made() {
    let line = "ulimit -v 2000000 && exec \"$0\" analyze cube --structure uniform --params density=1e30 \
                --memory-limit 1M";
    let sh = std::process::Command::new("sh").args(["-c", line, env!("CARGO_BIN_EXE_octogrid")]).output();
    let output = sh.expect("there is a shell");
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    assert!(String::from_utf8_lossy(&output.stderr).contains("limit of 1048576"), "{output:?}");
}
