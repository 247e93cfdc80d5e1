//! Tests of reachable travels, limits, assemblies, certificates and loads on the command line.

use super::*;

/// If the mechanism cannot reach a travel, the program writes the other stations and gives the reason. Cells without a
/// result are empty.
#[test]
fn what_cannot_be_reached_is_reported_and_left_empty() {
    let directory = tempfile::tempdir().unwrap();
    let out = directory.path().join("run");
    let study = studies().join("macpherson_solve.toml");
    let assert = hardpoint(&[
        "solve",
        study.to_str().unwrap(),
        "--set",
        "motion.travel={from=-400.0,to=400.0,steps=9}",
        "--out",
        out.to_str().unwrap(),
    ])
    .code(1);
    let said = text(&assert.get_output().stdout);
    assert!(said.contains("7 of 9 stations"), "{said}");
    assert!(said.contains("the wheel travel ends"), "{said}");
    let (header, rows) = csv(&directory, "curves.csv");
    assert_eq!(header.last().unwrap(), "status");
    for row in [&rows[0], &rows[8]] {
        assert_eq!(row.last().unwrap(), "unreachable");
        assert!(
            row[1..row.len() - 1].iter().all(String::is_empty),
            "{row:?}"
        );
    }
    assert_eq!(rows[4].last().unwrap(), "ok");
}

/// The program solves a travel just inside the limits and refuses a travel just outside. (`tests/it/hard_cases.rs`
/// compares the limits with the reference.)
#[test]
fn limits_are_sharp_and_have_a_cause() {
    let study = studies().join("macpherson_solve.toml");
    let arguments = ["limits", study.to_str().unwrap(), "--format", "json"];
    let assert = hardpoint(&arguments).success();
    let table: serde_json::Value = serde_json::from_slice(&assert.get_output().stdout).unwrap();
    let travel = &table["limits"][0];
    assert_eq!(travel["quantity"], "travel_mm");
    let (from, to) = (
        travel["from"].as_f64().unwrap(),
        travel["to"].as_f64().unwrap(),
    );
    assert!(
        (-500.0..-200.0).contains(&from) && (200.0..500.0).contains(&to),
        "{from} {to}"
    );
    let lowest = "the wheel centre is at its lowest point, no part is at a singularity";
    assert!(travel["because"].as_str().unwrap().starts_with(lowest));
    // The message names the part that is nearest to its singularity, by the part's name in this topology.
    let wishbones = studies().join("double_wishbone_solve.toml");
    let assert = hardpoint(&["limits", wishbones.to_str().unwrap(), "--format", "json"]).success();
    let other: serde_json::Value = serde_json::from_slice(&assert.get_output().stdout).unwrap();
    let nearest = "; nearest to its singularity: the upper arm, ";
    assert!(
        other["limits"][0]["because"]
            .as_str()
            .unwrap()
            .contains(nearest)
    );
    // A travel just inside the limits has a pose (exit code 0). A travel just outside has none (exit code 1).
    for (travel, code) in [
        (to - 1e-6, 0),
        (to + 1e-6, 1),
        (from + 1e-6, 0),
        (from - 1e-6, 1),
    ] {
        let set = format!("motion.travel=[{travel:?}]");
        let study = study.to_str().unwrap();
        hardpoint(&["solve", study, "--set", &set, "--out", "-"]).code(code);
    }
}

#[test]
fn assemblies_are_listed_and_the_connected_one_is_named() {
    let study = studies().join("macpherson_solve.toml");
    let arguments = [
        "assemblies",
        study.to_str().unwrap(),
        "--travel",
        "30",
        "--format",
        "json",
    ];
    let assert = hardpoint(&arguments).success();
    let table: serde_json::Value = serde_json::from_slice(&assert.get_output().stdout).unwrap();
    let rows = table["assemblies"].as_array().unwrap();
    let connected: Vec<_> = rows.iter().filter(|r| r["connected"] == true).collect();
    assert_eq!(connected.len(), 1, "{rows:?}");
    assert!((connected[0]["wheel_centre_z_mm"].as_f64().unwrap() - 330.0).abs() < 1e-9);
    assert_eq!(connected[0]["strut"], "upright");
}

/// If the design cannot be assembled, the command states this in one sentence and exits with code 1.
#[test]
fn no_assembly_is_said_in_a_sentence() {
    let study = studies().join("macpherson_solve.toml");
    let call = ["assemblies", study.to_str().unwrap(), "--travel", "500"];
    let assert = hardpoint(&call).code(1);
    let said = "at travel 500 mm, rack 0 mm the parts of the design cannot be assembled\n";
    assert_eq!(text(&assert.get_output().stdout), said);
    let assert = hardpoint(&[&call[..], &["--format", "json"]].concat()).code(1);
    let table: serde_json::Value = serde_json::from_slice(&assert.get_output().stdout).unwrap();
    assert_eq!(table["assemblies"], serde_json::json!([]));
    assert_eq!(text(&assert.get_output().stderr), said);
}

#[test]
fn assemblies_of_every_topology_are_listed_with_their_branch() {
    for (study, columns) in [
        ("macpherson_solve", "arm_angle_deg,strut,tie_rod,"),
        ("double_wishbone_solve", "arm_angle_deg,upper_arm,tie_rod,"),
        ("semi_trailing_arm_solve", "arm_angle_deg,arm,"),
        ("five_link_solve", "turn_deg,determinant,"),
    ] {
        let study = studies().join(format!("{study}.toml"));
        let arguments = ["assemblies", study.to_str().unwrap(), "--format", "csv"];
        let assert = hardpoint(&arguments).success();
        let table = text(&assert.get_output().stdout);
        let (header, rows) = table.split_once('\n').unwrap();
        let next = "wheel_centre_x_mm,wheel_centre_y_mm,wheel_centre_z_mm,camber_deg,toe_deg,";
        assert!(
            header.starts_with(&format!("table,{columns}{next}")),
            "{header}"
        );
        assert!(header.ends_with(",connected"), "{header}");
        let connected: Vec<&str> = rows.lines().filter(|row| row.ends_with(",true")).collect();
        assert_eq!(connected.len(), 1, "{table}");
        assert!(!connected[0].contains("across") && !connected[0].contains("reversed"));
        assert!(!table.contains("NaN"), "{table}");
    }
    let study = studies().join("five_link_solve.toml");
    for travel in ["nan", "inf", "-inf", "high"] {
        let travel = format!("--travel={travel}");
        let assert = hardpoint(&["assemblies", study.to_str().unwrap(), &travel]).code(2);
        assert!(text(&assert.get_output().stderr).contains("--travel"));
    }
}

/// Every station of an ordinary study is certified up to rounding errors, on one solution branch. `check` names the key that
/// requests certificates.
#[test]
fn a_certificate_covers_the_whole_curve() {
    let certify = ["--set", "outputs.certify=true"];
    let (directory, said) = run("solve", "macpherson_solve.toml", &certify);
    let proved = "certificate: 41 of 41 stations certified; the whole curve is on one branch";
    assert!(said.contains(proved), "{said}");
    let table = csv(&directory, "curves.csv");
    let errors = column(&table, "position_error_mm");
    let apart = column(&table, "uniqueness_mm");
    // The strut is about 700 mm long.
    assert!(errors.iter().all(|e| *e > 0.0 && *e < 1e-10), "{errors:?}");
    assert!(apart.iter().all(|u| *u > 1.0), "{apart:?}");
    let summary = json(&directory, "summary.json");
    let certificate = &summary["certificate"];
    assert_eq!(certificate["proved"], 41);
    assert_eq!(certificate["one_branch"], true);
    let worst = errors.iter().copied().fold(0.0, larger);
    assert_eq!(certificate["largest_position_error"], worst);

    let study = studies().join("macpherson_solve.toml");
    let assert = hardpoint(&["check", study.to_str().unwrap(), certify[0], certify[1]]).success();
    let said = text(&assert.get_output().stdout);
    let row = said
        .lines()
        .find(|line| line.contains("certificate"))
        .unwrap();
    assert!(
        row.contains(" on ") && row.contains("outputs.certify (line "),
        "{row}"
    );
    let (directory, said) = run("solve", "macpherson_solve.toml", &[]);
    assert!(!said.contains("certificate"), "{said}");
    assert!(json(&directory, "summary.json")["certificate"].is_null());
}

/// The travel has a limit (fold) at 349.66780703583492 mm. Two assemblies merge there. Very close to the limit, both
/// are equal in double precision. There, the program gives a pose only without `certify`. Just before the limit the
/// program marks derivatives as inaccurate.
#[test]
fn stations_at_a_fold_are_flagged_or_not_proved() {
    let study = studies().join("macpherson_solve.toml");
    let solved = |travels: &str, more: &[&str]| {
        let travel = format!("motion.travel={travels}");
        let upper = "suspension.hardpoints.strut_upper=[-17, 611, 490]";
        let mut arguments = vec![
            "solve",
            study.to_str().unwrap(),
            "--out",
            "-",
            "--set",
            &travel,
        ];
        for set in [upper].iter().chain(more) {
            arguments.extend(["--set", set]);
        }
        let output = hardpoint(&arguments).get_output().clone();
        let rows = text(&output.stdout);
        let status = |row: &str| row.rsplit(',').next().unwrap().to_owned();
        let status: Vec<_> = rows.lines().skip(1).map(status).collect();
        (output.status.code(), status, rows, text(&output.stderr))
    };
    let near = "[0, 349.667, 349.66780703583]";
    let (code, status, _, said) = solved(near, &["outputs.order=velocity"]);
    assert_eq!(code, Some(0), "{said}");
    assert_eq!(status, ["ok", "ok", "ill_conditioned"], "{said}");
    assert!(
        said.contains("warning: 1 station has fewer than six correct digits"),
        "{said}"
    );
    assert!(said.contains("at travel 349.668 mm"), "{said}");

    let at_fold = "[0, 300, 349.667807035834]";
    let (code, status, rows, said) = solved(at_fold, &["outputs.certify=true"]);
    assert_eq!(code, Some(1), "{said}");
    assert_eq!(status, ["ok", "ok", "uncertified"], "{said}");
    assert!(rows.lines().last().unwrap().contains(",,,"), "{rows}");
    assert!(
        said.contains("travel 349.668 mm: the pose is not certified"),
        "{said}"
    );
    assert!(said.contains("2 of 3 stations certified"), "{said}");
}

/// The program reports loads that the mechanism cannot carry. It exits with code 1 (incomplete results).
#[test]
fn loads_without_support_are_reported() {
    let study = studies().join("semi_trailing_arm_solve.toml");
    let assert = hardpoint(&[
        "solve",
        study.to_str().unwrap(),
        "--out",
        "-",
        // This value puts `spring_upper` in line with the lower end of the spring and the hinge.
        "--set",
        "suspension.hardpoints.spring_upper=[205.0, 470.0, 262.5]",
        "--set",
        "motion.travel=[-40.0, 0.0, 40.0]",
        "--set",
        "outputs.loads=[{name=\"kerb\", at=\"wheel_centre\", force=[0, 0, 1000]}]",
    ])
    .code(1);
    let (csv, said) = (&assert.get_output().stdout, &assert.get_output().stderr);
    let csv = text(csv);
    assert!(
        csv.lines()
            .next()
            .unwrap()
            .ends_with(",kerb_spring_N,status")
    );
    assert!(csv.lines().nth(2).unwrap().ends_with(",,,,unsupported"));
    let warning = "warning: loads cannot be carried at 1 station, the first at travel 0 mm: the spring, or the support that replaces it, has almost no leverage";
    assert!(text(said).contains(warning), "{}", text(said));
}
