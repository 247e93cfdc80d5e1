//! Tests of studies with rockers as a user runs them: limits, outputs and refusals.

mod mistakes;
mod toggles;

use crate::support::larger;
use assert_cmd::Command;
use hardpoint::curves::{Curves, curves};
use hardpoint::plan::Plan;
use hardpoint::report::{CurveTable, curves_csv};
use hardpoint::study::{Study, StudyErrors};
use std::fs;
use std::path::Path;

fn sample() -> String {
    crate::support::sample("double_wishbone_pushrod.toml")
}

fn read(text: &str) -> Result<Study, StudyErrors> {
    Study::from_text("study.toml", text, Path::new("."))
}

/// Sample with some lines replaced. The start of a line identifies the line.
fn with_lines(lines: &[(&str, &str)]) -> String {
    let sample = sample();
    for (start, _) in lines {
        let count = sample.lines().filter(|l| l.starts_with(start)).count();
        assert_eq!(count, 1, "{start}");
    }
    let replaced = sample.lines().map(|line| {
        let found = lines.iter().find(|(start, _)| line.starts_with(start));
        found.map_or(line, |(_, line)| *line)
    });
    replaced.collect::<Vec<_>>().join("\n")
}

fn run(text: &str) -> (Study, Curves, CurveTable) {
    let study = read(text).unwrap_or_else(|e| panic!("{e}"));
    let plan = Plan::of(study.one_wheel().unwrap());
    let found = curves(study.wheel(), &plan).unwrap();
    let csv = curves_csv(&found);
    (study, found, CurveTable::read(&csv).unwrap())
}

/// Pushrod whose rocker is 22.5 degrees (a quarter of a right angle) from its toggle in the design position.
const NEAR_TOGGLE: (&str, &str) = ("pushrod_inner ", "pushrod_inner = [0.0, 185.0, 486.0]");

const OUTPUTS: (&str, &str) = (
    "characteristics",
    "characteristics = [\"motion_ratio\", \"rocker_angle\", \"camber\"]",
);

const POINTS: (&str, &str) = (
    "points",
    "points = [\"pushrod_outer\", \"spring_lower\"]\nsensitivities = [\"pushrod_inner\"]",
);

/// The program warns of a pushrod without a stated body if its end is far from the usual body and near another one.
#[test]
fn a_rod_far_from_its_assumed_body_is_doubted() {
    let doubts = |text: &str| {
        let study = read(text).unwrap_or_else(|e| panic!("{e}"));
        let doubts = hardpoint::report::plausibility(study.wheel()).unwrap();
        doubts
            .into_iter()
            .filter(|d| d.contains("pushrod_outer"))
            .collect::<Vec<_>>()
    };
    assert_eq!(doubts(&sample()), Vec::<String>::new());
    let high = ("pushrod_outer ", "pushrod_outer = [-5.0, 500.0, 359.0]");
    let text = with_lines(&[high]);
    let said = doubts(&text);
    assert!(
        said[0].contains("nearer") && said[0].contains("upper arm"),
        "{said:?}"
    );
    let named = text.replace(
        "\n[suspension.bodies]\n",
        "\n[suspension.bodies]\npushrod_outer = \"upper_arm\"\n",
    );
    assert_eq!(doubts(&named), Vec::<String>::new());
}

/// The plan computes a rocker if a requested output uses this rocker, and names the output and the line. Otherwise the
/// rocker is off.
#[test]
fn rockers_are_computed_where_they_are_asked_for() {
    let states = |characteristics: &str, more: &str| {
        let outputs = format!("characteristics = {characteristics}\n{more}");
        let text = with_lines(&[
            ("characteristics", &outputs),
            ("points", ""),
            ("loads", ""),
            ("order", ""),
        ]);
        let study = read(&text).unwrap_or_else(|e| panic!("{e}"));
        let effects = Plan::of(study.one_wheel().unwrap()).effects(&study);
        ["rocker", "anti-roll bar", "rates"].map(|name| {
            let effect = effects.iter().find(|e| e.name == name).unwrap();
            assert_eq!(effect.on, effect.because.contains("(line"), "{effect:?}");
            // The line is that of the key, not of the section.
            let line = effect.because.rsplit_once("(line ");
            let line = line.map(|(_, line)| line.trim_end_matches(')').parse::<usize>().unwrap());
            let line = line.map(|line| text.lines().nth(line - 1).unwrap());
            let keys = ["characteristics = ", "points = ", "loads = "];
            assert!(
                line.is_none_or(|line| keys.iter().any(|key| line.starts_with(key))),
                "{line:?}"
            );
            effect.on
        })
    };
    assert_eq!(states("[\"camber\"]", ""), [false, false, false]);
    assert_eq!(states("[\"spring_length\"]", ""), [true, false, false]);
    assert_eq!(states("[\"motion_ratio\"]", ""), [true, false, true]);
    assert_eq!(states("[\"rocker_angle\"]", ""), [true, false, false]);
    // The drop link is on the rocker.
    assert_eq!(states("[\"anti_roll_bar_angle\"]", ""), [true, true, false]);
    let points = "points = [\"pushrod_outer\"]";
    assert_eq!(states("[\"camber\"]", points), [false, false, false]);
    let points = "points = [\"drop_link_inner\"]";
    assert_eq!(states("[\"camber\"]", points), [true, true, false]);
    let load = "loads = [{ name = \"kerb\", at = \"wheel_centre\", force = [0, 0, 1] }]";
    assert_eq!(states("[\"camber\"]", load), [true, false, false]);
}

/// A sweep finds the same values as `solve`. If designs fail at a toggle, the sweep names the toggle.
#[test]
fn sweeps_and_solves_agree() {
    let directory = tempfile::tempdir().unwrap();
    let sweep = "\n[sweep]\nmethod = \"grid\"\nvariables = [\n  { hardpoint = \"pushrod_inner\", axis = \"y\", \
                 range = [185.0, 265.0], absolute = true, steps = 2 },\n]\n";
    let text = with_lines(&[
        ("travel", "travel = [-50.0, 0.0, 50.0]"),
        ("loads", ""),
        ("order", ""),
        ("points", ""),
    ]) + sweep;
    // The first design is near its toggle. The second design is that of the sample.
    let text = text.replace("265.0,  455.0]", "265.0,  486.0]");
    fs::write(directory.path().join("study.toml"), &text).unwrap();
    let mut command = Command::cargo_bin("hardpoint").unwrap();
    command.current_dir(directory.path());
    command
        .args(["sweep", "study.toml", "--out", "run"])
        .assert()
        .code(1);
    let mut reader = csv::Reader::from_path(directory.path().join("run/designs.csv")).unwrap();
    let header = reader.headers().unwrap().clone();
    let rows: Vec<_> = reader.records().map(Result::unwrap).collect();
    let cell = |row: usize, name: &str| {
        let k = header.iter().position(|n| n == name).unwrap();
        rows[row][k].to_owned()
    };
    assert_eq!(rows.len(), 2);
    assert_eq!(cell(0, "status"), "toggle");
    assert!(cell(0, "reason").contains("the pushrod is at toggle"));
    assert_eq!(
        (
            cell(0, "failed_stations").as_str(),
            cell(0, "failed_at_mm").as_str()
        ),
        ("1", "50.0")
    );
    assert!(cell(0, "motion_ratio_max").is_empty() && !cell(0, "camber_max_deg").is_empty());
    assert!(!cell(0, "motion_ratio_design").is_empty());
    assert_eq!(cell(1, "status"), "ok");

    let (_, found, table) = run(&text);
    assert!(found.are_complete());
    for name in [
        "motion_ratio",
        "spring_length_mm",
        "anti_roll_bar_angle_deg",
        "camber_deg",
    ] {
        let values = table.column(name).unwrap().iter().flatten();
        let largest = values.copied().fold(f64::NEG_INFINITY, larger);
        let (stem, unit) = match name.rsplit_once('_').unwrap() {
            (stem, unit @ ("mm" | "deg")) => (stem, format!("_{unit}")),
            _ => (name, String::new()),
        };
        // The sweep uses SIMD lanes. `solve` uses the solver for single designs.
        let swept: f64 = cell(1, &format!("{stem}_max{unit}")).parse().unwrap();
        assert!((swept - largest).abs() <= 1e-12 * largest.abs(), "{name}");
    }
}

/// The tuning of the sample meets its target curves.
#[test]
fn a_rocker_is_tuned_to_a_rising_rate() {
    let study = crate::support::studies().join("double_wishbone_rocker.toml");
    let directory = tempfile::tempdir().unwrap();
    let mut command = Command::cargo_bin("hardpoint").unwrap();
    command
        .current_dir(directory.path())
        .arg("optimise")
        .arg(study);
    command.args(["--out", "run"]).assert().success();
    let table =
        CurveTable::read(&fs::read(directory.path().join("run/curves.csv")).unwrap()).unwrap();
    let travel = table.column("travel_mm").unwrap();
    let ratio = table.column("motion_ratio").unwrap();
    assert_eq!((travel.len(), ratio.len()), (31, 31));
    for (travel, ratio) in travel.iter().zip(ratio) {
        let wanted = 0.65 + 0.05 * travel.unwrap() / 30.0;
        assert!((ratio.unwrap() - wanted).abs() < 0.005, "{travel:?}");
    }
}

/// For every topology, an anti-roll bar can have its drop link on the wheel carrier or an arm. The lever turns, and
/// `check` names the body to which the drop link is attached.
#[test]
fn every_topology_takes_an_anti_roll_bar() {
    let bar = [
        "suspension.hardpoints.drop_link_inner=[-110.0, 470.0, 330.0]",
        "suspension.hardpoints.anti_roll_bar_inner=[-210.0, 200.0, 330.0]",
        "suspension.hardpoints.anti_roll_bar_outer=[-210.0, 470.0, 330.0]",
        "suspension.hardpoints.drop_link_outer=[-110.0, 480.0, 220.0]",
        "outputs={characteristics=[\"anti_roll_bar_angle\", \"anti_roll_bar_motion_ratio\"]}",
        "motion.travel=[-20.0, 0.0, 20.0]",
    ]
    .map(str::to_owned);
    for (name, body) in [
        ("macpherson", "lower_arm"),
        ("macpherson", "knuckle"),
        ("double_wishbone", "lower_arm"),
        ("double_wishbone", "knuckle"),
        ("five_link", "knuckle"),
        ("semi_trailing_arm", "arm"),
    ] {
        let path = crate::support::studies().join(format!("{name}_solve.toml"));
        let mut overrides = bar.to_vec();
        overrides.push(format!("suspension.bodies.drop_link_outer=\"{body}\""));
        let study = Study::read(&path, &overrides).unwrap_or_else(|e| panic!("{name}: {e}"));
        let plan = Plan::of(study.one_wheel().unwrap());
        let found = curves(study.wheel(), &plan).unwrap();
        assert!(found.are_complete(), "{name}");
        let [below, design, above] = [0, 1, 2].map(|i| found.stations[i].values[0].unwrap());
        // The drop link is below the lever and pushes it up in jounce.
        let angles = [below, design, above];
        assert!(below < -1.0 && above > 1.0, "{name}: {angles:?}");
        // In the design position the bar angle is 0 degrees, except for rounding errors of the points of an arm.
        assert!(design.abs() < 1e-12, "{name}: {angles:?}");
        let effects = plan.effects(&study);
        let effect = effects.iter().find(|e| e.name == "anti-roll bar").unwrap();
        let from = format!("turned by the drop link on the {}", body.replace('_', " "));
        assert_eq!(effect.what, from, "{name}");
    }
}
