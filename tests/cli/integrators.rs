//! The integrators of `octogrid render`: path and photon find the same light, whatever the threads.

use crate::support::Folder;

/// Luminance of every pixel of `room`.
fn luminance(integrator: &str, size: &str, samples: u32, extra: &[&str]) -> Vec<f32> {
    let folder = Folder::new();
    let samples = samples.to_string();
    let args = ["render", "room", "--size", size, "--integrator", integrator, "--samples", &samples];
    let run = folder.run(&[&args[..], &["--linear", "image.npy"], extra].concat());
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""), "{integrator}");
    let file = std::fs::read(folder.path("image.npy")).unwrap();
    let file = npyz::NpyFile::new(&file[..]).unwrap();
    assert_eq!(file.shape()[2], 3);
    let colours: Vec<f32> = file.into_vec().unwrap();
    assert!(colours.iter().all(|c| c.is_finite() && *c >= 0.0), "{integrator}");
    colours.chunks(3).map(|c| 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]).collect()
}

fn mean(image: &[f32]) -> f64 {
    image.iter().map(|&l| f64::from(l)).sum::<f64>() / image.len() as f64
}

/// The mean difference of pixels, relative to their mean.
fn difference(a: &[f32], b: &[f32]) -> f64 {
    let differences: Vec<f32> = a.iter().zip(b).map(|(a, b)| (a - b).abs()).collect();
    mean(&differences) / mean(a)
}

#[test]
fn path_and_photon_converge_to_the_same() {
    let images = [4, 16, 64].map(|samples| {
        let of = |integrator| luminance(integrator, "96x72", samples, &[]);
        [of("path"), of("photon")]
    });
    let [few, more, most] = images.each_ref().map(|[path, photon]| difference(path, photon));
    assert!(few > more && more > most, "the images don't approach: {few} {more} {most}");
    let [path, photon] = images[2].each_ref().map(|image| mean(image));
    assert!((path - photon).abs() < 0.02 * path, "path {path}, photon {photon}");
}

#[test]
fn numbers_depend_on_the_seed_and_not_on_threads() {
    for integrator in ["path", "photon"] {
        let of = |extra| luminance(integrator, "24x18", 8, extra);
        let one = of(&["--threads", "1"]);
        assert!(one == of(&["--threads", "2"]), "{integrator} depends on threads");
        assert!(one != of(&["--seed", "1"]), "{integrator} ignores the seed");
    }
}

/// Inside a closed box of albedo a whose walls all emit, every point receives the same radiance, and
/// n reflections add up to emission * (1 + a + ... + a^n).
#[test]
fn a_furnace_is_evenly_bright() {
    let folder = Folder::new();
    folder.write("box.mtl", "newmtl wall\nKd 0.5 0.5 0.5\nKe 1 1 1\n");
    folder.write("box.obj", FURNACE);
    for integrator in ["path", "photon"] {
        let args = ["render", "box.obj", "--camera", "0.2,0.1,0.3:1,0.4,0.2", "--size", "48x48"];
        let rest = ["--integrator", integrator, "--samples", "256", "--bounces", "3", "--linear", "i.npy"];
        let run = folder.run(&[&args[..], &rest].concat());
        assert_eq!(run.stderr, "");
        let file = std::fs::read(folder.path("i.npy")).unwrap();
        let colours: Vec<f32> = npyz::NpyFile::new(&file[..]).unwrap().into_vec().unwrap();
        assert!((mean(&colours) / 1.875 - 1.0).abs() < 0.01, "{integrator}: {}", mean(&colours));
    }
}

const FURNACE: &str = "mtllib box.mtl\nusemtl wall\n\
    v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n\
    f 1 2 3 4\nf 5 6 7 8\nf 1 2 6 5\nf 4 3 7 8\nf 1 4 8 5\nf 2 3 7 6\n";
