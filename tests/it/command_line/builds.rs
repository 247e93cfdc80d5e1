//! Tests of `hardpoint setup` and `hardpoint tolerance`.

use super::*;

/// If the set-up cannot reach a target value, the program names the target and the effect of each adjustment.
#[test]
fn a_set_up_out_of_reach_names_the_wish() {
    let directory = tempfile::tempdir().unwrap();
    let out = directory.path().join("run");
    let study = studies().join("double_wishbone_tolerance.toml");
    let call = |want: &str| {
        let set = format!("setup.want={want}");
        let (study, out) = (study.to_str().unwrap(), out.to_str().unwrap());
        hardpoint(&["setup", study, "--set", &set, "--out", out, "--force"])
    };
    call("{ camber = -1.5 }").success();
    // The summary contains the target values as the user wrote them.
    let summary = fs::read_to_string(out.join("summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    assert_eq!(summary["statics"][0]["column"], "camber_deg");
    assert_eq!(summary["statics"][0]["wanted"].to_string(), "-1.5");
    let assert = call("{ camber = -90.3, toe = -5.0 }").code(1);
    let output = assert.get_output();
    let (said, error) = (text(&output.stdout), text(&output.stderr));
    assert!(
        error.contains("cannot be reached: camber_deg ends at ")
            && error.contains(", not -90.3")
            && !error.contains("toe_deg"),
        "{error}"
    );
    assert!(
        said.contains("Effect of each adjustment") && said.contains("tie_rod"),
        "{said}"
    );
    let (header, rows) = csv(&directory, "effects.csv");
    assert_eq!((header[0].as_str(), rows.len()), ("adjustment", 5));
    // The failed run has removed the files of the earlier set-up run.
    for name in ["setup.csv", "summary.json", "curves.csv"] {
        assert!(!out.join(name).exists(), "{name}");
    }
    assert!(
        fs::read_to_string(out.join("run.json"))
            .unwrap()
            .contains("\"finished\": true")
    );
}

/// Tables of a set-up have at most 100 columns of text, with every name and heading complete. Instructions use workshop
/// terms.
#[test]
fn a_set_up_is_printed_for_a_mechanic() {
    let more = [
        "--set",
        "setup.want={camber=-1.5,toe=-0.1,bump_steer=-0.01}",
    ];
    let directory = tempfile::tempdir().unwrap();
    let (study, out) = (
        studies().join("double_wishbone_tolerance.toml"),
        directory.path().join("run"),
    );
    let call = [
        "setup",
        study.to_str().unwrap(),
        "--out",
        out.to_str().unwrap(),
    ];
    let assert = hardpoint(&[&call[..], &more].concat()).code(1);
    let said = text(&assert.get_output().stdout);
    for line in said.lines().filter(|line| !line.contains("run:")) {
        assert!(line.chars().count() <= 100, "{line}");
    }
    let rows = |name: &str| {
        said.lines()
            .filter(|line| line.split("  ").any(|cell| cell.trim() == name))
            .count()
    };
    assert_eq!(rows("upper_ball_joint y"), 2, "{said}");
    // Five rows: three for the adjustments, one for their steps, and one for the target values.
    assert_eq!(rows("bump_steer_deg_per_mm"), 5, "{said}");
    assert_eq!(rows("ride_height_change_mm"), 5, "{said}");
    assert!(
        said.contains("turns")
            && said.contains("lengthen")
            && said.contains("move outboard by ") | said.contains("move inboard by "),
        "{said}"
    );
    assert!(
        said.contains("not met: bump_steer_deg_per_mm ends at "),
        "{said}"
    );
    let summary = json(&directory, "summary.json");
    assert_eq!(summary["met"], false);
    let mut with_target = 0;
    for value in summary["statics"].as_array().unwrap() {
        let wanted = value["wanted"].as_f64();
        assert_eq!(value["miss_rounded"].is_number(), wanted.is_some());
        if let Some(wanted) = wanted {
            with_target += 1;
            let off = |set: &str, miss: &str| {
                value[set].as_f64().unwrap() - wanted - value[miss].as_f64().unwrap()
            };
            assert!(
                off("set", "miss").abs() < 1e-12
                    && off("set_rounded", "miss_rounded").abs() < 1e-12
            );
        }
    }
    // Three targets of the command, and the ride height of the study.
    assert_eq!(with_target, 4);
    // The order of adjustments is: shims first, toe last.
    let order: Vec<_> = summary["adjustments"]
        .as_array()
        .unwrap()
        .iter()
        .map(|a| a["adjustment"].as_str().unwrap())
        .collect();
    assert_eq!(order, ["upper_ball_joint y", "pushrod", "tie_rod"]);
    let (header, rows) = csv(&directory, "setup.csv");
    assert!(
        header.contains(&"instruction".to_owned())
            && header.contains(&"ride_height_change_mm".to_owned())
    );
    assert_eq!(rows.len(), 6);
    // Tables and summary use one word for the values of the design.
    assert_eq!(rows[0][0], "nominal");
    assert!(summary["statics"][0]["nominal"].is_number());
}

/// If no build can be assembled, the program reports nothing about builds. The program refuses limits that make a
/// length 0 or negative.
#[test]
fn no_builds_have_no_linear_answer() {
    let short = "tolerance.scatter=[{ length = \"tie_rod\", limits = [-300.0, -250.0] }]";
    let few = [
        "--set",
        "tolerance.builds=100",
        "--set",
        "tolerance.aligned=false",
        "--set",
    ];
    let (directory, said) = run(
        "tolerance",
        "macpherson_tolerance.toml",
        &[&few[..], &[short]].concat(),
    );
    assert!(said.contains("100 builds rejected"), "{said}");
    let (header, rows) = csv(&directory, "tolerance.csv");
    let place = header
        .iter()
        .position(|name| name == "linear_holds")
        .unwrap();
    assert!(!rows.is_empty() && rows.iter().all(|row| row[place].is_empty()));
    assert!(
        said.lines()
            .filter(|line| line.contains("_deg "))
            .all(|line| !line.contains("yes")),
        "{said}"
    );

    let none = "tolerance.scatter=[{ length = \"tie_rod\", limits = [-500.0, 0.5] }]";
    let study = studies().join("macpherson_tolerance.toml");
    let call = ["tolerance", study.to_str().unwrap(), "--set", none];
    let error = text(&hardpoint(&call).code(2).get_output().stderr);
    assert!(
        error.contains(
            "tolerance.scatter[0].limits: the lowest limit makes the length 0 or negative: tie_rod is 360"
        ),
        "{error}"
    );
}

/// If the nominal design is outside a band, `tolerance` and `check` report it with the value. A nominal design inside the band
/// is not reported.
#[test]
fn a_nominal_design_outside_a_band_is_reported() {
    let bands = |low: f64| {
        let band = format!("{{ characteristic = \"toe\", at = 0.0, between = [{low:?}, 1.0] }}");
        format!("tolerance.bands=[{band}]")
    };
    let [outside, inside] = [0.5, -0.5].map(bands);
    let few = ["--set", "tolerance.builds=300", "--set"];
    let study = studies().join("macpherson_tolerance.toml");
    let words = "the nominal design is outside the band toe_deg at 0: 0.5 to 1; nominal: toe_deg";
    for (set, is_outside) in [(&outside, true), (&inside, false)] {
        let (directory, said) = run(
            "tolerance",
            "macpherson_tolerance.toml",
            &[&few[..], &[set]].concat(),
        );
        let said = one_line(&said);
        assert_eq!(said.contains(words), is_outside, "{said}");
        assert_eq!(said.contains("at travel 0 mm"), is_outside, "{said}");
        let summary = json(&directory, "summary.json");
        assert_eq!(summary["nominal_outside"].is_array(), is_outside);
        let call = ["check", study.to_str().unwrap(), "--set", set];
        let said = text(&hardpoint(&call).success().get_output().stdout);
        let said = one_line(&said);
        assert_eq!(said.contains(words), is_outside, "{said}");
    }
}

/// The heading of the ranking is `largest share`. The key in JSON is `share`.
#[test]
fn the_share_of_a_ranking_is_the_largest() {
    let few = ["--set", "tolerance.builds=300"];
    let (_, said) = run("tolerance", "macpherson_tolerance.toml", &few);
    assert!(
        said.contains("contributor") && said.contains("largest share"),
        "{said}"
    );
    let (_, printed) = run(
        "tolerance",
        "macpherson_tolerance.toml",
        &[&few[..], &["--format", "json"]].concat(),
    );
    let tables: serde_json::Value = serde_json::from_str(&printed).unwrap();
    let first = &tables["ranking"][0];
    assert!(
        first["share"].is_f64() && first["largest_share"].is_null(),
        "{first}"
    );
    // The ranking names the output to which the share belongs, and the values have an explanation of their rows.
    let output = first["output"].as_str().unwrap();
    assert!(["caster_deg", "toe_deg"].contains(&output), "{first}");
    assert!(said.contains("of the variance of"), "{said}");
    assert!(said.contains("a row where its sigma is largest"), "{said}");
}
