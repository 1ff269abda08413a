//! Compares instruction counts with those that are committed: `cargo bench --bench gate`.
//!
//! Fails where a case takes over 1% more instructions than `benches/instructions.csv` says, and where
//! the cases are not the same. `cargo bench --bench gate -- --update` writes the file anew; its diff is
//! the record of what changed.

use std::collections::BTreeMap;
use std::process::{Command, ExitCode, Stdio};

const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/instructions.csv");

/// Above this share of what is committed, a count fails.
const TOLERANCE: f64 = 1.01;

type Counts = BTreeMap<String, u64>;

fn main() -> ExitCode {
    let counts = measure();
    if std::env::args().any(|argument| argument == "--update") {
        let lines = counts.iter().map(|(case, count)| format!("{case},{count}\n"));
        std::fs::write(FILE, lines.collect::<String>()).expect("the file can be written");
        println!("wrote {} counts to {FILE}", counts.len());
        return ExitCode::SUCCESS;
    }
    let committed = read(&std::fs::read_to_string(FILE).expect("the committed counts"));
    let faults = faults(&committed, &counts);
    for fault in &faults {
        eprintln!("{fault}");
    }
    println!("{} passed, {} failed", counts.len() - faults.len().min(counts.len()), faults.len());
    if faults.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// Runs the bench `instructions` and reads its counts.
fn measure() -> Counts {
    let output = Command::new(env!("CARGO"))
        .args(["bench", "--quiet", "--bench", "instructions", "--", "--output-format=json"])
        .stderr(Stdio::inherit())
        .output()
        .expect("cargo runs");
    assert!(
        output.status.success(),
        "the bench `instructions` failed: are valgrind and gungraun-runner installed?"
    );
    let text = String::from_utf8(output.stdout).expect("the output is text");
    let summaries = text.lines().filter(|line| line.starts_with('{'));
    summaries.map(|line| count(&serde_json::from_str(line).expect("a summary is JSON"))).collect()
}

/// The name of a case and its instructions.
fn count(summary: &serde_json::Value) -> (String, u64) {
    let text = |key: &str| summary[key].as_str().unwrap_or_default().to_owned();
    let function = text("module_path").rsplit("::").next().unwrap_or_default().to_owned();
    let count = summary.pointer("/profiles/0/data/total/metrics/Ir/values/new").and_then(|c| c.as_u64());
    (
        format!("{function}/{}", text("id")),
        count.unwrap_or_else(|| panic!("no instruction count in {summary}")),
    )
}

fn read(text: &str) -> Counts {
    let line = |line: &str| {
        let (case, count) = line.split_once(',')?;
        Some((case.to_owned(), count.parse().ok()?))
    };
    text.lines().map(|l| line(l).unwrap_or_else(|| panic!("not a line of `case,count`: {l}"))).collect()
}

fn faults(committed: &Counts, counts: &Counts) -> Vec<String> {
    let mut faults = Vec::new();
    for (case, &count) in counts {
        match committed.get(case) {
            None => faults.push(format!("{case} is not in {FILE}: run with --update")),
            Some(&limit) if count as f64 > TOLERANCE * limit as f64 => {
                let more = 100.0 * (count as f64 / limit as f64 - 1.0);
                faults.push(format!("{case} takes {count} instructions, {more:.2}% more than {limit}"));
            }
            Some(_) => {}
        }
    }
    let gone = committed.keys().filter(|case| !counts.contains_key(*case));
    faults.extend(gone.map(|case| format!("{case} is committed but was not measured: run with --update")));
    faults
}
