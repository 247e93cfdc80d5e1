//! Tests of sweeps as a user runs them: the same bytes however they are run, known results, counts of failures, and
//! messages about mistakes.

mod answers;
mod blocks;
mod bytes;
mod failures;
mod mistakes;
mod statistics;

use assert_cmd::Command;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

/// Strut with a sweep of a coordinate of its tie rod and one of its mount. The motion has only four travels, to save time.
const STUDY: &str = r#"[suspension]
topology = "macpherson"

[suspension.hardpoints]
lower_arm_front  = [ 120.0, 360.0, 195.0]
lower_arm_rear   = [-260.0, 350.0, 205.0]
lower_ball_joint = [   5.0, 705.0, 190.0]
strut_top        = [ -35.0, 575.0, 850.0]
strut_lower      = [ -11.0, 623.0, 370.0]
tie_rod_inner    = [-110.0, 330.0, 243.0]
tie_rod_outer    = [-130.0, 690.0, 240.0]
wheel_centre     = [   0.0, 760.0, 300.0]
spindle_inner    = [  -0.2, 660.0, 299.1]

[motion]
travel = [-60.0, -20.0, 20.0, 60.0]

[outputs]
characteristics = ["camber", "toe"]

[sweep]
method = "latin_hypercube"
samples = 700
seed = 3
curves = true
variables = [
  { hardpoint = "tie_rod_inner", axis = "z", range = [-10.0, 10.0] },
  { hardpoint = "strut_top", axis = "y", range = [-20.0, 20.0] },
]

[optimise]
variables = [ { hardpoint = "tie_rod_inner", axis = "z", range = [-10.0, 10.0] } ]
targets = [
  { characteristic = "toe", points = [[-60.0, 0.1], [60.0, 0.1]], tolerance = 0.01 },
  { characteristic = "camber", at = 0.0, value = -0.5, tolerance = 0.05 },
]
"#;

/// Study of the sweep whose designs come from a file.
fn study_of_file(designs: &str) -> String {
    let [from, to] = ["method = \"latin", "[optimise]"].map(|text| STUDY.find(text).unwrap());
    format!(
        "{}designs = \"{designs}\"\n{}",
        &STUDY[..from],
        &STUDY[to..]
    )
}

/// Directory with a study, in which commands run.
struct Bench(tempfile::TempDir);

impl Bench {
    fn new(study: &str) -> Self {
        let directory = tempfile::tempdir().unwrap();
        fs::write(directory.path().join("study.toml"), study).unwrap();
        Bench(directory)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn run(&self, arguments: &[&str]) -> assert_cmd::assert::Assert {
        let mut command = Command::cargo_bin("hardpoint").unwrap();
        command.current_dir(self.0.path()).args(arguments).assert()
    }

    fn sweep(&self, out: &str, more: &[&str]) -> assert_cmd::assert::Assert {
        self.run(&[&["sweep", "study.toml", "--out", out], more].concat())
    }

    fn json(&self, name: &str) -> Value {
        serde_json::from_slice(&fs::read(self.path(name)).unwrap()).unwrap()
    }

    fn designs(&self, out: &str) -> Table {
        Table::read(&self.path(out).join("designs.csv"))
    }

    /// Asserts that the results of two runs are equal, byte by byte.
    fn assert_same(&self, one: &str, other: &str) {
        let names = |run: &str| {
            let entries = fs::read_dir(self.path(run)).unwrap();
            let mut names: Vec<_> = entries.map(|e| e.unwrap().file_name()).collect();
            // `run.json` differs, because it records the command.
            names.retain(|name| name != "run.json");
            names.sort();
            names
        };
        assert_eq!(names(one), names(other));
        assert!(names(one).len() >= 4);
        for name in names(one) {
            let read = |run: &str| fs::read(self.path(run).join(&name)).unwrap();
            assert!(read(one) == read(other), "{name:?} of {one} and {other}");
        }
    }
}

struct Table {
    header: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    fn read(path: &Path) -> Self {
        let mut reader = csv::Reader::from_path(path).unwrap();
        let header = reader
            .headers()
            .unwrap()
            .iter()
            .map(str::to_owned)
            .collect();
        let rows = reader
            .records()
            .map(|r| r.unwrap().iter().map(str::to_owned).collect());
        Table {
            header,
            rows: rows.collect(),
        }
    }

    fn text(&self, column: &str) -> Vec<&str> {
        let k = self.header.iter().position(|n| n == column);
        let k = k.unwrap_or_else(|| panic!("{column} in {:?}", self.header));
        self.rows.iter().map(|row| row[k].as_str()).collect()
    }

    fn numbers(&self, column: &str) -> Vec<f64> {
        self.text(column)
            .iter()
            .map(|c| c.parse().unwrap())
            .collect()
    }
}

fn said(assert: &assert_cmd::assert::Assert) -> (String, String) {
    let output = assert.get_output();
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
    (text(&output.stdout), text(&output.stderr))
}

/// Entry of an output column in the summary.
fn output<'a>(summary: &'a Value, column: &str) -> &'a Value {
    let outputs = summary["outputs"].as_array().unwrap();
    outputs.iter().find(|o| o["column"] == column).unwrap()
}
