//! Tests of studies with rockers as a user runs them: limits, outputs and refusals.

mod toggles;

use crate::support::{larger, one_line};
use assert_cmd::Command;
use hardpoint::curves::{Curves, Status, curves};
use hardpoint::model::Rod;
use hardpoint::number::Vector3;
use hardpoint::plan::Plan;
use hardpoint::report::{CurveTable, curves_csv, remarks, sensitivities_csv};
use hardpoint::solve::Solver;
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

/// If the study does not name the body of a drop link, the program uses the nearest body, if this is clear. It reports
/// this choice. If the study names the body, the program uses it without a message. With the drop link on the lower arm,
/// the bar of this study would turn less than half as far.
#[test]
fn a_drop_link_beside_a_rocker_is_never_assumed_silently() {
    let said = "drop_link_outer = \"rocker\"";
    let ratio = |text: &str| {
        let (study, found, _) = run(text);
        let columns = &found.columns;
        let ratio = columns
            .iter()
            .position(|c| c.output == "anti_roll_bar_motion_ratio");
        let middle = &found.stations[found.stations.len() / 2];
        let doubts = hardpoint::report::plausibility(study.wheel()).unwrap();
        (middle.values[ratio.unwrap()].unwrap(), doubts)
    };
    let outputs = (
        "characteristics",
        "characteristics = [\"anti_roll_bar_motion_ratio\"]",
    );
    let named = with_lines(&[outputs]);
    assert!(named.contains(said));
    let (wanted, doubts) = ratio(&named);
    assert!(
        !doubts.iter().any(|d| d.contains("drop_link_outer")),
        "{doubts:?}"
    );
    let (unnamed, doubts) = ratio(&named.replace(said, ""));
    assert_eq!(unnamed, wanted);
    let doubt = doubts
        .iter()
        .find(|d| d.contains("drop_link_outer"))
        .unwrap();
    for words in [
        "Assumed: rocker",
        "lower arm",
        "[suspension.bodies]",
        " mm away",
    ] {
        assert!(doubt.contains(words), "{doubt}");
    }
    // A point on the body itself has the distance 0.
    let at_rod = named
        .replace(said, "")
        .replace("[ -30.0,  160.0,  420.0]", "[   0.0,  265.0,  455.0]");
    let (_, doubts) = ratio(&at_rod);
    assert!(
        doubts.iter().any(|d| d.contains("rocker (0 mm away)")),
        "{doubts:?}"
    );
    let on_arm = named.replace(said, "drop_link_outer = \"lower_arm\"");
    let (arm, doubts) = ratio(&on_arm);
    assert!(
        !doubts.iter().any(|d| d.contains("drop_link_outer")),
        "{doubts:?}"
    );
    assert!(wanted.abs() > 2.0 * arm.abs(), "{wanted} {arm}");
    // A drop link near the lower arm is attached to that arm, and the program reports this too.
    let low = named
        .replace(said, "")
        .replace("[ -30.0,  160.0,  420.0]", "[ -30.0,  430.0,  150.0]")
        .replace("[ -30.0,  155.0,  330.0]", "[ -30.0,  425.0,  330.0]");
    let study = read(&low).unwrap();
    let mechanism = &study.wheel().mechanism;
    let link = mechanism.point("drop_link_outer").unwrap();
    assert!(matches!(
        mechanism.body(link),
        hardpoint::model::Body::Arm(_)
    ));
    let doubts = hardpoint::report::plausibility(study.wheel()).unwrap();
    assert!(
        doubts.iter().any(|d| d.contains("Assumed: lower arm")),
        "{doubts:?}"
    );
    // If points move far enough, the program attaches the drop link to another body. If the points do not move, the body
    // stays the same.
    let high = read(&named.replace(said, "")).unwrap();
    let (high, low) = (high.wheel(), study.wheel());
    assert!(high.mechanism.keeps_drop_link(&high.design));
    assert!(low.mechanism.keeps_drop_link(&low.design));
    assert!(!high.mechanism.keeps_drop_link(&low.design));
    assert!(!low.mechanism.keeps_drop_link(&high.design));
    assert!(
        read(&named)
            .unwrap()
            .wheel()
            .mechanism
            .keeps_drop_link(&low.design)
    );
}

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

/// Each case has an edit of the sample, the line that the message names, and the text of the message.
#[test]
fn mistakes_are_named() {
    let line = |start: &str| {
        let sample = sample();
        sample
            .lines()
            .find(|l| l.starts_with(start))
            .unwrap()
            .to_owned()
    };
    let pushrod_outer = line("pushrod_outer");
    let pullrod =
        pushrod_outer.replace("pushrod_outer     ", "pullrod_outer") + "\n" + &pushrod_outer;
    for (start, becomes, on, phrases) in [
        (
            "rocker_pivot_rear",
            "",
            "pushrod_outer",
            &[
                "missing for the rocker: rocker_pivot_rear (rear point of the rocker's axis on the body)",
                "or none",
            ][..],
        ),
        (
            "pushrod_inner",
            "",
            "pushrod_outer",
            &["missing for the rocker: pushrod_inner (pushrod at the rocker)"],
        ),
        (
            "pushrod_outer",
            &pullrod,
            "pullrod_outer",
            &[
                "pullrod_outer and pushrod_outer are both given: expected only one of them for the rocker",
            ],
        ),
        (
            "drop_link_inner",
            "",
            "drop_link_outer",
            &["missing for the anti-roll bar: drop_link_inner"],
        ),
        (
            "spring_upper",
            "",
            "spring_lower",
            &["missing for the spring: spring_upper"],
        ),
        (
            "rocker_pivot_rear",
            "rocker_pivot_rear = [20.0, 205.0, 420.0]",
            "rocker_pivot_rear",
            &[
                "rocker_pivot_rear coincides with rocker_pivot_front: they define the axis of the rocker",
            ],
        ),
        (
            "pushrod_inner",
            "pushrod_inner = [0.0, 530.0, 155.0]",
            "pushrod_inner",
            &["the pushrod would have no length"],
        ),
        (
            "pushrod_inner",
            "pushrod_inner = [0.0, 205.0, 420.0]",
            "pushrod_inner",
            &[
                "pushrod_inner lies on the line through rocker_pivot_front and rocker_pivot_rear, so it has no lever arm to turn the rocker",
            ],
        ),
        // The lever points from the rocker's pivot straight towards the outer end of the rod.
        (
            "pushrod_inner",
            "pushrod_inner = [0.0, 270.0, 367.0]",
            "pushrod_inner",
            &[
                "the pushrod is at toggle in the design position: pushrod_outer, pushrod_inner and the axis from \
               rocker_pivot_front to rocker_pivot_rear lie in one plane, so it cannot turn the rocker",
            ],
        ),
        (
            "drop_link_outer =",
            "drop_link_outer = \"roker\"",
            "drop_link_outer =",
            &["unknown body \"roker\"", "rocker"],
        ),
        (
            "drop_link_outer =",
            "drop_link_outer = \"anti_roll_bar\"",
            "drop_link_outer =",
            &["unknown body \"anti_roll_bar\""],
        ),
        (
            "drop_link_outer =",
            "pushrod_outer = \"rocker\"",
            "pushrod_outer =",
            &["unknown body \"rocker\""],
        ),
        (
            "drop_link_outer =",
            "wheel_centre = \"rocker\"",
            "wheel_centre =",
            &[
                "wheel_centre has a fixed body in every double_wishbone",
                "outer ends",
            ],
        ),
        (
            "drop_link_outer =",
            "pullrod_outer = \"knuckle\"",
            "pullrod_outer =",
            &["this study does not give pullrod_outer"],
        ),
        (
            "drop_link_outer =",
            "damper = \"knuckle\"",
            "damper =",
            &["double_wishbone has no hardpoint \"damper\""],
        ),
    ] {
        let text = with_lines(&[(start, becomes)]);
        let errors = read(&text).expect_err(becomes);
        let said = errors.render(false);
        assert_eq!(errors.all().len(), 1, "{said}");
        let (number, _) = errors.all()[0].position().unwrap();
        let found = text.lines().nth(number - 1).unwrap();
        assert!(
            found.starts_with(on),
            "expected the line with {on}:\n{said}"
        );
        for phrase in phrases {
            let phrase = one_line(phrase);
            assert!(said.contains(&phrase), "expected {phrase:?}:\n{said}");
        }
    }
    // Outputs that need a rocker are refused without one.
    let plain = crate::support::studies().join("double_wishbone_solve.toml");
    for (name, needs) in [
        ("rocker_angle", "a rocker with its pushrod or pullrod"),
        (
            "anti_roll_bar_motion_ratio",
            "an anti-roll bar with its drop link",
        ),
    ] {
        let asked = format!("outputs.characteristics=[\"{name}\"]");
        let said = Study::read(&plain, &[asked]).unwrap_err().render(false);
        assert!(
            said.contains(&format!(
                "{name} needs {needs}, which this study does not give"
            )),
            "{said}"
        );
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
