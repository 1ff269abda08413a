//! Instructions, counted by valgrind in a process of its own.

use std::hint::black_box;
use std::process::{Child, Command, Stdio};

use octogrid::Scene;

use super::rays::{Rays, trace};
use super::variants::{Kind, Variant};

/// The instructions that each variant takes for the rays, in other processes of this program; none where there is
/// no valgrind, and none of mere structures, which would take long.
pub(super) fn instructions(scene: &str, variants: &[Variant], rays: u32) -> Vec<Option<u64>> {
    let start = |variant: &Variant| {
        let program = std::env::current_exe().ok()?;
        let mut valgrind = Command::new("valgrind");
        valgrind
            .args(["--tool=callgrind", "--callgrind-out-file=/dev/null", "--collect-atstart=no"])
            .arg("--toggle-collect=*report*plan*count*counted*")
            .arg(program)
            .args(["report", "plan", scene, "--count", &variant.name, "--rays", &rays.to_string()])
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::piped());
        (variant.kind != Kind::Structure).then(|| valgrind.spawn().ok())?
    };
    let running: Vec<Option<Child>> = variants.iter().map(start).collect();
    running.into_iter().map(|child| collected(child?)).collect()
}

fn collected(child: Child) -> Option<u64> {
    let output = child.wait_with_output().ok()?;
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    let (_, count) = text.lines().find_map(|line| line.split_once("Collected :"))?;
    count.trim().parse().ok().filter(|&count| output.status.success() && count > 0)
}

/// What is counted.
#[inline(never)]
pub(super) fn counted(scene: &Scene, rays: &Rays) {
    for (kind, rays) in rays.kinds().enumerate() {
        black_box(trace(scene, kind, rays));
    }
}
