//! `octogrid trace`: known answers.

use std::fmt::Debug;

use npyz::{Deserialize, NpyFile};

use crate::support::{Folder, QUADS, Run, rays};

const INF: f32 = f32::INFINITY;
const NONE: u32 = u32::MAX;

/// Rays against the two squares: through both, the same but ended between them, starting between
/// them, beside them, not a number, and without a direction.
const RAYS: [[f32; 8]; 6] = [
    [0.25, 0.5, 5.0, 0.0, 0.0, 0.0, -1.0, INF],
    [0.25, 0.5, 5.0, 0.0, 0.0, 0.0, -2.0, 2.75],
    [0.75, 0.25, -0.5, 0.0, 0.0, 0.0, -1.0, INF],
    [2.0, 0.5, 5.0, 0.0, 0.0, 0.0, -1.0, INF],
    [f32::NAN, 0.5, 5.0, 0.0, 0.0, 0.0, -1.0, INF],
    [0.25, 0.5, 5.0, 0.0, 0.0, 0.0, 0.0, INF],
];

#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
struct HitRow {
    t: f32,
    u: f32,
    v: f32,
    prim: u32,
}

#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
struct AllRow {
    ray: u32,
    t: f32,
    u: f32,
    v: f32,
    prim: u32,
}

fn trace(query: &str, more: &[&str]) -> (Folder, Run) {
    let folder = Folder::new();
    folder.write("quads.obj", QUADS);
    folder.write("rays.npy", rays(&RAYS));
    let args = ["trace", "quads.obj", "--rays", "rays.npy", "--query", query, "--hits", "hits.npy"];
    let run = folder.run(&[&args, more].concat());
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""));
    assert_eq!(folder.names(), ["hits.npy", "quads.obj", "rays.npy"]);
    (folder, run)
}

fn rows<T: Deserialize>(folder: &Folder) -> Vec<T> {
    let file = std::fs::read(folder.path("hits.npy")).unwrap();
    let npy = NpyFile::new(&file[..]).unwrap();
    assert_eq!(npy.shape().len(), 1);
    npy.into_vec().unwrap()
}

fn is_same<T: PartialEq + Debug>(found: &[T], expected: &[T]) {
    assert_eq!(found, expected);
}

#[test]
fn closest() {
    let hit = |t, u, v, prim| HitRow { t, u, v, prim };
    let miss = hit(INF, 0.0, 0.0, NONE);
    for structure in ["auto", "uniform", "recursive", "octree", "hybrid"] {
        let (folder, _) = trace("closest", &["--structure", structure]);
        let expected = [hit(5.0, 0.25, 0.25, 1), hit(2.5, 0.25, 0.25, 1), hit(0.5, 0.5, 0.25, 2)];
        is_same(&rows(&folder), &[&expected[..], &[miss; 3]].concat());
    }
}

#[test]
fn any() {
    let (folder, run) = trace("any", &[]);
    is_same(&rows(&folder), &[true, true, true, false, false, false]);
    assert!(run.stdout.contains("Mray/s"));
}

#[test]
fn all() {
    let (folder, _) = trace("all", &["--repeat", "3"]);
    let hit = |ray, t, u, v, prim| AllRow { ray, t, u, v, prim };
    let expected = [
        hit(0, 5.0, 0.25, 0.25, 1),
        hit(0, 6.0, 0.25, 0.25, 3),
        hit(1, 2.5, 0.25, 0.25, 1),
        hit(2, 0.5, 0.5, 0.25, 2),
    ];
    is_same(&rows(&folder), &expected);
}

#[test]
fn headers_are_those_that_numpy_writes() {
    let fields = "('t', '<f4'), ('u', '<f4'), ('v', '<f4'), ('prim', '<u4')";
    for (query, descr, len) in [
        ("closest", format!("[{fields}, ]"), 6),
        ("any", "'|b1'".to_owned(), 6),
        ("all", format!("[('ray', '<u4'), {fields}, ]"), 4),
    ] {
        let (folder, _) = trace(query, &[]);
        let file = std::fs::read(folder.path("hits.npy")).unwrap();
        let header = String::from_utf8_lossy(&file[10..10 + usize::from(file[8])]).into_owned();
        assert!(header.contains(&format!("'descr': {descr}")), "{header}");
        assert!(header.contains(&format!("'shape': ({len},")), "{header}");
    }
}

#[test]
fn json_has_every_field() {
    let (_, run) = trace("all", &["--json", "--threads", "2", "--repeat", "4"]);
    let json: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    let mut keys: Vec<&str> = json.as_object().unwrap().keys().map(String::as_str).collect();
    keys.sort_unstable();
    let mut expected = [
        "scene",
        "triangles",
        "structure",
        "build_ms",
        "bytes_per_triangle",
        "query",
        "rays",
        "hits",
        "threads",
        "best_s",
        "median_s",
        "mrays_per_s",
    ];
    expected.sort_unstable();
    assert_eq!(keys, expected);
    assert_eq!(json["scene"], "quads.obj");
    assert_eq!(json["query"], "all");
    assert_eq!(json["structure"], "brute");
    for (key, number) in [("triangles", 4), ("rays", 6), ("hits", 4), ("threads", 2)] {
        assert_eq!(json[key], number, "{key}");
    }
    assert!(json["best_s"].as_f64() <= json["median_s"].as_f64());
    assert!(json["mrays_per_s"].as_f64() > Some(0.0));
}

#[test]
fn hits_do_not_depend_on_threads() {
    let folder = Folder::new();
    // A fixed mixture of directions from a point within the room.
    let direction = |i: u32, k: u32| ((i * k) % 1009) as f32 / 504.0 - 1.0;
    let around = |i| [2.0, 1.3, 2.0, 0.0, direction(i, 7), direction(i, 101), direction(i, 577), INF];
    folder.write("rays.npy", rays(&(1..2000).map(around).collect::<Vec<_>>()));
    for query in ["closest", "any", "all"] {
        for threads in ["1", "2"] {
            let args = ["trace", "room", "--rays", "rays.npy", "--query", query, "--hits", threads];
            assert_eq!(folder.run(&[&args[..], &["--threads", threads]].concat()).stderr, "");
        }
        let [one, two] = ["1", "2"].map(|name| std::fs::read(folder.path(name)).unwrap());
        assert!(one == two, "{query}");
    }
}

#[test]
fn no_rays_are_no_failure() {
    let folder = Folder::new();
    folder.write("rays.npy", rays(&[]));
    for query in ["closest", "any", "all"] {
        let args = ["trace", "room", "--rays", "rays.npy", "--query", query, "--hits", "hits.npy", "--json"];
        let run = folder.run(&args);
        assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""));
        assert!(run.stdout.contains("\"rays\":0,\"hits\":0"));
    }
}
