//! Tests of the page of a car.

use super::commands::{hardpoint, text};
use std::fs;

/// The page has every section. The components in the record add up to the load transfer, and no picture contains an
/// invalid number.
#[test]
fn the_page_shows_the_run() {
    let directory = tempfile::tempdir().unwrap();
    let directory = directory.path();
    hardpoint(directory, &["new", "car"]).success();
    hardpoint(
        directory,
        &["solve", "car.toml", "--out", "run", "--report"],
    )
    .success();
    let page = fs::read_to_string(directory.join("run/report.html")).unwrap();
    for id in [
        "weights",
        "transfer",
        "map",
        "roll-axis",
        "attitude",
        "cases",
    ] {
        assert!(page.contains(&format!("<section id=\"{id}\">")), "{id}");
    }
    assert!(!page.contains("NaN") && !page.contains("inf\""));
    assert!(page.contains("Every case is in equilibrium."));
    // The page made from the record alone is identical.
    fs::remove_file(directory.join("run/report.html")).unwrap();
    hardpoint(directory, &["report", "run"]).success();
    assert_eq!(
        fs::read_to_string(directory.join("run/report.html")).unwrap(),
        page
    );
    let record: serde_json::Value =
        serde_json::from_slice(&fs::read(directory.join("run/report.json")).unwrap()).unwrap();
    let mut compared = 0;
    for case in record["cases"].as_array().unwrap() {
        let state = &case["state"];
        let numbers = |value: &serde_json::Value| -> Vec<f64> {
            value
                .as_array()
                .unwrap()
                .iter()
                .map(|n| n.as_f64().unwrap())
                .collect()
        };
        let loads = numbers(&state["loads"]);
        for axle in [0, 1] {
            let parts: f64 = numbers(&state["transfer"][axle]).iter().sum();
            let whole = 0.5 * (loads[2 * axle + 1] - loads[2 * axle]);
            assert!((parts - whole).abs() < 1e-9 * loads.iter().sum::<f64>());
            compared += 1;
        }
        // The drawing shows a loaded wheel with its contact point on the ground.
        for wheel in 0..4 {
            let height = numbers(&state["contacts"][wheel])[2];
            let lifted = state["lifted"][wheel].as_bool().unwrap();
            assert!(lifted || height.abs() < 1e-6, "{height}");
        }
    }
    assert_eq!(compared, 10);
}

/// The page of a tuning begins with its targets.
#[test]
fn the_page_of_a_tuning_answers_first() {
    let directory = tempfile::tempdir().unwrap();
    let directory = directory.path();
    hardpoint(directory, &["new", "car"]).success();
    hardpoint(
        directory,
        &["optimise", "car.toml", "--out", "run", "--report"],
    )
    .success();
    let page = fs::read_to_string(directory.join("run/report.html")).unwrap();
    assert!(page.contains("All targets are met within their tolerances."));
    let targets = page.find("<section id=\"targets\">").unwrap();
    let effects = page.find("<section id=\"side_effects\">").unwrap();
    assert!(targets < effects);
    assert!(effects < page.find("<section id=\"weights\">").unwrap());
    assert!(page.contains("side effects beyond their tolerances."));
    // A car's run has no curves to plot; the command refuses `--plots`.
    let refused = hardpoint(directory, &["report", "run", "--plots", "pictures"]).code(2);
    assert!(text(&refused.get_output().stderr).contains("its page has pictures"));
}
