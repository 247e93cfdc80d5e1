//! Tests of the page and the pictures of a run: required content, forbidden content, and the display in a browser.

mod access;
mod browser;
mod motions;
mod page;
mod pictures;
mod plausibility;
mod refusals;
mod sweep;

use crate::support::studies;
use assert_cmd::Command;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

/// Run in a temporary directory.
struct Run {
    directory: tempfile::TempDir,
}

impl Run {
    /// Runs a command on a study with this name and text, with `--report`. Adds `--plots` if the command makes curves.
    fn of(command: &str, name: &str, study: &str, more: &[&str]) -> Run {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join(format!("{name}.toml"));
        fs::write(&path, study).unwrap();
        let run = Run { directory };
        let has_pictures = !["sweep", "setup", "kc"].contains(&command);
        let mut command = hardpoint(&[command]);
        command.arg(&path).arg("--out").arg(run.path());
        command.arg("--report");
        if has_pictures {
            command.arg("--plots").arg(run.plots());
        }
        let ended = command.args(more).output().unwrap();
        let said = String::from_utf8_lossy(&ended.stderr);
        assert!(matches!(ended.status.code(), Some(0 | 1)), "{said}");
        run
    }

    fn path(&self) -> PathBuf {
        self.directory.path().join("run")
    }

    fn plots(&self) -> PathBuf {
        self.directory.path().join("plots")
    }

    fn page(&self) -> String {
        fs::read_to_string(self.path().join("report.html")).unwrap()
    }

    /// Data in the page.
    fn data(&self) -> Value {
        let page = self.page();
        let opening = r#"<script type="application/json" id="run">"#;
        let start = page.find(opening).unwrap() + opening.len();
        let end = start + page[start..].find("</script>").unwrap();
        serde_json::from_str(&page[start..end]).unwrap()
    }

    /// Header of a CSV file, and its cells as one list per column.
    fn csv(&self, name: &str) -> (Vec<String>, Vec<Vec<String>>) {
        let mut reader = csv::Reader::from_path(self.path().join(name)).unwrap();
        let header: Vec<String> = reader
            .headers()
            .unwrap()
            .iter()
            .map(str::to_owned)
            .collect();
        let mut columns = vec![Vec::new(); header.len()];
        for record in reader.records() {
            for (column, cell) in columns.iter_mut().zip(&record.unwrap()) {
                column.push(cell.to_owned());
            }
        }
        (header, columns)
    }
}

fn hardpoint(arguments: &[&str]) -> Command {
    let mut command = Command::cargo_bin("hardpoint").unwrap();
    command.args(arguments);
    command
}

fn study(name: &str) -> String {
    fs::read_to_string(studies().join(name)).unwrap()
}

/// Travel beyond the reach of the strut, at several rack displacements.
const TOO_FAR: [&str; 4] = [
    "--set",
    "motion.travel={from=-360.0,to=360.0,steps=37}",
    "--set",
    "motion.rack={from=-40.0,to=40.0,steps=3}",
];

/// Name with markup, a script, a template, right-to-left text, and a car emoji.
const HOSTILE_NAME: &str = "<img src=x onerror=alert(1)>\"'&amp;{data} \u{202e}abc 🏎";

/// Sweep of the sample study with this name.
fn sweep(name: &str, more: &[&str]) -> Run {
    Run::of("sweep", name, &study("macpherson_sweep.toml"), more)
}

/// Tuning whose study has this name, with constraints that the page draws.
fn hostile() -> Run {
    let outputs = "[outputs]\npoints = [\"wheel_centre\"]";
    let mut text = study("macpherson_front.toml").replace("[outputs]", outputs);
    text += r#"
[[optimise.constraints]]
point = "lower_ball_joint"
inside = { rim = 400.0, from = -300.0, to = 300.0 }

[[optimise.constraints]]
members = ["tie_rod", "strut"]
clearance = 1.0
"#;
    Run::of("optimise", HOSTILE_NAME, &text, &[])
}
