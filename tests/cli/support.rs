//! Runs the command in a folder of its own, and makes its input.

use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use tempfile::TempDir;

/// Longer than any run here should take, however busy the machine.
const TIMEOUT: Duration = Duration::from_secs(120);

/// Two unit squares at z = 0 and z = -1, each a face of four corners.
pub(crate) const QUADS: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 -1\nv 1 0 -1\nv 1 1 -1\nv 0 1 -1\n\
                         f 1 2 3 4\nf 5 6 7 8\n";

/// What a run left.
#[derive(Debug)]
pub(crate) struct Run {
    /// None where it was ended by a signal or took too long.
    pub(crate) code: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

/// The command with its arguments, without standard input.
pub(crate) fn command(args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_octogrid"));
    command.args(args).stdin(Stdio::null());
    command
}

/// A temporary folder.
pub(crate) struct Folder(TempDir);

impl Folder {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), content).unwrap();
    }

    /// The sorted names of all that is in the folder, hidden or not.
    pub(crate) fn names(&self) -> Vec<String> {
        let name = |entry: std::io::Result<std::fs::DirEntry>| entry.unwrap().file_name();
        let names = std::fs::read_dir(self.0.path()).unwrap().map(name);
        let mut names: Vec<_> = names.map(|name| name.into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// Runs the command in the folder.
    pub(crate) fn run(&self, args: &[&str]) -> Run {
        run(self.0.path(), args)
    }
}

fn run(folder: &Path, args: &[&str]) -> Run {
    let mut command = command(args);
    command.current_dir(folder).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let start = Instant::now();
    let status = loop {
        match child.try_wait().unwrap() {
            Some(status) => break Some(status),
            None if start.elapsed() > TIMEOUT => {
                child.kill().unwrap();
                break None;
            }
            None => std::thread::sleep(Duration::from_millis(2)),
        }
    };
    let text = |pipe: &mut dyn Read| {
        let mut text = String::new();
        pipe.read_to_string(&mut text).unwrap();
        text
    };
    Run {
        code: status.and_then(|status| status.code()),
        stdout: text(child.stdout.as_mut().unwrap()),
        stderr: text(child.stderr.as_mut().unwrap()),
    }
}

/// An npy file of version 1 from the text of its header and its data.
pub(crate) fn npy(header: &str, data: &[u8]) -> Vec<u8> {
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend((header.len() as u16).to_le_bytes());
    file.extend(header.as_bytes());
    file.extend(data);
    file
}

/// An npy file of rays.
pub(crate) fn rays(rays: &[[f32; 8]]) -> Vec<u8> {
    let shape = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({}, 8), }}\n", rays.len());
    let data: Vec<u8> = rays.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
    npy(&shape, &data)
}
