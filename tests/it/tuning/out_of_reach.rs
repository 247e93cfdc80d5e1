//! Tests of constraints and targets that cannot be met. Messages name them before and after the tuning.

use super::edited;
use hardpoint::optimise::{Control, tune};
use hardpoint::report::{TuningSummary, variable_plausibility, violated_constraints};
use hardpoint::study::Study;

fn summary(study: &Study) -> TuningSummary {
    let optimise = study.optimise.as_ref().unwrap();
    let tuning = tune(&study.vehicle, optimise, Control::default()).unwrap();
    TuningSummary::of(study, optimise, &tuning, None)
}

/// A length must differ by a metre, which no start can satisfy. The tuning keeps the start with the smallest violation.
/// The message states this violation with its amount.
#[test]
fn an_impossible_constraint_is_named_with_its_violation() {
    let far = "optimise.constraints=[{ length = \"tie_rod\", between = [1340.0, 1380.0] }]";
    let study = edited("double_wishbone_front.toml", &[far, "optimise.starts=4"]);
    let summary = summary(&study);
    let remarks = summary.remarks().join("\n");
    for phrase in [
        "no design within the ranges satisfies this constraint: length tie_rod between 1340 and 1380",
        "is kept because its largest violation is the smallest",
        "Missed: length tie_rod between 1340 and 1380 by ",
    ] {
        assert!(remarks.contains(phrase), "{phrase}: {remarks}");
    }
    let table = serde_json::to_value(&summary).unwrap();
    let room = table["constraints"][0]["margin"].as_f64().unwrap();
    assert!(
        room < -900.0 && remarks.contains(&format!("{:.0}", -room)),
        "{remarks}"
    );
    let ended: Vec<&str> = table["starts"]
        .as_array()
        .unwrap()
        .iter()
        .map(|s| s["ended"].as_str().unwrap())
        .collect();
    assert!(
        !ended.iter().any(|ended| ended.contains("contradict")),
        "{ended:?}"
    );
    // The nominal length already violates this limit, so the program reports it before the tuning.
    let before = violated_constraints(&study).unwrap();
    let [line] = &before[..] else {
        panic!("{before:?}")
    };
    assert!(
        line.contains("length tie_rod between 1340 and 1380, missed by "),
        "{line}"
    );
    let near = "optimise.constraints=[{ length = \"tie_rod\", between = [100.0, 900.0] }]";
    let study = edited("double_wishbone_front.toml", &[near]);
    assert!(violated_constraints(&study).unwrap().is_empty());
}

/// The program warns if target points are far beyond the motion, as when they are in another unit. It does not warn of
/// points slightly beyond the motion.
#[test]
fn a_target_that_spans_much_more_than_its_motion_is_doubted() {
    for (end, is_doubted) in [(1500.0, true), (100.0, false)] {
        let target = format!(
            "optimise.targets=[{{ characteristic = \"toe\", points = [[-{end:?}, 0.0], [{end:?}, 0.0]], tolerance = 0.01 }}]"
        );
        let study = edited("double_wishbone_front.toml", &[&target]);
        let doubts = variable_plausibility(&study).join("\n");
        assert_eq!(
            doubts.contains("please check: the points of the target toe_deg run from -1500"),
            is_doubted,
            "{doubts}"
        );
    }
}

/// A target curve that is longer than the motion is compared only within the motion. A note states both ranges.
#[test]
fn a_part_of_a_target_outside_of_the_motion_is_named() {
    for (points, is_named) in [
        ("points = [[-90.0, 0.0], [20.0, 0.0]]", true),
        ("points = [[-60.0, 0.0], [60.0, 0.0]]", false),
        ("at_most = [[-10.0, 1.0], [70.0, 1.0]]", true),
        ("at_most = 1.0", false),
    ] {
        let target = format!(
            "optimise.targets=[{{ characteristic = \"toe\", {points}, tolerance = 0.01 }}]"
        );
        let study = edited("double_wishbone_front.toml", &[&target]);
        let notes = variable_plausibility(&study).join("\n");
        let words = "its motion from -60 to 60 mm: the part outside of the motion has no effect";
        assert_eq!(notes.contains(words), is_named, "{points}: {notes}");
    }
}

/// The program refuses a column of a target file if its name states another unit than that of the target.
#[test]
fn a_column_in_another_unit_is_refused() {
    let directory = tempfile::tempdir().unwrap();
    let curve = directory.path().join("curve.csv");
    std::fs::write(
        &curve,
        "travel_mm,toe_rad,toe_in\n-30,0.0035,0.2\n30,0.0035,0.2\n",
    )
    .unwrap();
    let of = |column: &str| {
        let target = format!(
            "optimise.targets=[{{ characteristic = \"toe\", file = {curve:?}, column = {column:?}, tolerance = 0.01 }}]"
        );
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
        Study::read(&path.join("studies/double_wishbone_front.toml"), &[target])
    };
    let refused = of("toe_rad").unwrap_err().to_string();
    let words =
        "the column toe_rad is in rad according to its name, and the target toe_deg is in deg";
    assert!(refused.contains(words), "{refused}");
    assert!(of("toe_in").is_ok());
}

/// The tuning of a new study is the first one that a user sees. It meets its targets.
#[test]
fn tunings_of_new_studies_meet_their_targets() {
    for topology in [
        "double_wishbone",
        "macpherson",
        "five_link",
        "semi_trailing_arm",
        "trailing_arm_two_links",
        "integral_link",
        "h_arm",
        "solid_axle",
        "twist_beam",
    ] {
        let mut command = assert_cmd::Command::cargo_bin("hardpoint").unwrap();
        command.args(["new", topology, "--with", "optimise"]);
        let text = command.assert().success().get_output().stdout.clone();
        let text = String::from_utf8(text).unwrap();
        let study = Study::from_text("new.toml", &text, std::path::Path::new("")).unwrap();
        let missed = summary(&study);
        assert!(
            missed.missed().is_empty(),
            "{topology}: {:?}",
            missed.missed()
        );
    }
}
