//! `octogrid report paper`: its files are whole and agree with each other.
#![cfg(feature = "cli")]

#[path = "cli/support.rs"]
#[allow(dead_code)]
mod support;

use support::Folder;

/// The fields of a CSV line; quotes hold commas.
fn fields(line: &str) -> Vec<String> {
    let mut fields = vec![String::new()];
    let mut quoted = false;
    for c in line.chars() {
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => fields.push(String::new()),
            c => fields.last_mut().unwrap().push(c),
        }
    }
    fields
}

fn svg_holds(folder: &Folder, name: &str, labels: &[&str]) {
    let svg = std::fs::read_to_string(folder.path(name)).unwrap();
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"), "{name}");
    for label in labels {
        assert!(svg.contains(label), "{label} in {name}");
    }
}

#[test]
fn the_papers_report_has_all_its_parts() {
    let folder = Folder::new();
    let run = folder.run(&["report", "paper", "--size", "32x24", "--rounds", "2", "--out", "new/report"]);
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""));
    for number in 1..=8 {
        assert!(run.stdout.contains(&format!("\n({number}) ")), "{number} in {}", run.stdout);
    }

    let csv = std::fs::read_to_string(folder.path("new/report/report.csv")).unwrap();
    let rows: Vec<Vec<String>> = csv.lines().map(fields).collect();
    assert!(rows.iter().all(|row| row.len() == rows[0].len()), "{csv}");
    for row in &rows[1..] {
        let numbers = row[3..].iter().filter(|field| !field.is_empty());
        assert!(numbers.map(|n| n.parse::<f64>().unwrap()).all(|n| n.is_finite() && n > 0.0), "{row:?}");
    }
    for structure in ["R[10,4]", "R[19,2] without top grid", "O[8,15]", "uniform[4]"] {
        let of_it = rows.iter().filter(|row| row[1] == structure);
        assert_eq!(of_it.count(), 2 * 6, "{structure}");
    }

    let json = std::fs::read(folder.path("new/report/report.json")).unwrap();
    let json: serde_json::Value = serde_json::from_slice(&json).unwrap();
    assert_eq!((json["rounds"].as_u64(), json["size"][0].as_u64()), (Some(2), Some(32)));
    for field in ["cores", "isa", "compiler", "date", "command"] {
        assert!(!json["machine"][field].is_null(), "{field}");
    }
    assert_eq!(json["conclusions"].as_array().unwrap().len(), 8);
    assert_eq!(json["scenes"][0]["triangles"].as_u64(), Some(97_036));
    assert_eq!(json["scenes"][1]["columns"][0]["rendering"].as_array().unwrap().len(), 2);

    for scene in ["interior", "room"] {
        let memory = format!("new/report/{scene}-memory.svg");
        svg_holds(&folder, &memory, &["memory, KB", "speed, Mray/s", "R[10..31,4]"]);
        let build = format!("new/report/{scene}-preprocessing.svg");
        svg_holds(&folder, &build, &["preprocessing, s", "speed, Mray/s", "O[2..8,15]"]);
    }
}

#[test]
fn a_sweep_names_the_best_of_each_structure() {
    let folder = Folder::new();
    folder.write("quads.obj", support::QUADS);
    let run = folder.run(&["report", "paper", "--size", "32x24", "--sweep", "quads.obj", "room"]);
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""));
    assert!(
        run.stdout.contains("quads.obj: 4 triangles") && run.stdout.contains("hybrid["),
        "{}",
        run.stdout
    );
    let json = std::fs::read(folder.path("report-paper/sweep-room.json")).unwrap();
    let json: serde_json::Value = serde_json::from_slice(&json).unwrap();
    assert_eq!(json["best"].as_array().unwrap().len(), 4);
    svg_holds(&folder, "report-paper/sweep-quads-memory.svg", &["memory, KB", "best: "]);
}

#[test]
fn wrong_use_is_told() {
    let folder = Folder::new();
    assert_eq!(folder.run(&["report"]).code, Some(2));
    assert_eq!(folder.run(&["report", "paper", "--rounds", "0"]).code, Some(2));
    folder.write("file", "");
    let run = folder.run(&["report", "paper", "--out", "file"]);
    assert_eq!((run.code, run.stderr.lines().count()), (Some(1), 1), "{}", run.stderr);
    let run = folder.run(&["report", "paper", "--sweep", "missing.obj"]);
    assert_eq!((run.code, run.stderr.lines().count()), (Some(1), 1), "{}", run.stderr);
}
