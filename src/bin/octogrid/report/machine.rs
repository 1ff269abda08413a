//! What a run ran on.

use std::time::SystemTime;

use octogrid::Isa;
use serde::Serialize;

/// What one needs to know to compare figures.
#[derive(Serialize)]
pub(super) struct Machine {
    pub(super) cpu: Option<String>,
    pub(super) cores: usize,
    pub(super) threads: usize,
    pub(super) os: &'static str,
    pub(super) architecture: &'static str,
    pub(super) isa: String,
    pub(super) compiler: String,
    pub(super) version: &'static str,
    pub(super) date: String,
    pub(super) command: String,
}

impl Machine {
    /// This one, now.
    pub(super) fn here() -> Self {
        let command: Vec<String> = std::env::args_os().map(|a| a.to_string_lossy().into_owned()).collect();
        Self {
            cpu: cpu(),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            threads: rayon::current_num_threads(),
            os: std::env::consts::OS,
            architecture: std::env::consts::ARCH,
            isa: Isa::detect().to_string(),
            compiler: format!("rustc {}", rustc_version_runtime::version()),
            version: env!("CARGO_PKG_VERSION"),
            date: humantime::format_rfc3339_seconds(SystemTime::now()).to_string(),
            command: command.join(" "),
        }
    }

    /// What and how much, for a table.
    pub(super) fn pairs(&self) -> [(&'static str, String); 5] {
        [
            ("processor", self.cpu.clone().unwrap_or_else(|| self.architecture.to_owned())),
            ("cores, threads", format!("{}, {}", self.cores, self.threads)),
            ("instruction set", self.isa.clone()),
            ("compiler", self.compiler.clone()),
            ("date", self.date.clone()),
        ]
    }
}

/// The processor's name where Linux tells it.
fn cpu() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}
