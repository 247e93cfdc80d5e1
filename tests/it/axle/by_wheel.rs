//! Tests of commands that treat each wheel of an axle separately: assemblies, set-up, limits of builds.

use super::commands::{folder, run, study};
use serde_json::Value;
use std::fs;

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

/// On a mirrored axle, the assemblies of the right wheel at rack +10 are mirror images of those of the left wheel at rack -10.
#[test]
fn assemblies_of_a_mirror_image_are_mirror_images() {
    let path = study("macpherson_axle.toml");
    let path = path.to_str().unwrap();
    let assemblies = |rack: &str| {
        let more = ["--rack", rack, "--travel", "15", "--format", "json"];
        let (out, _) = run(&[&["assemblies", path], &more[..]].concat(), 0);
        json(&out)["assemblies"].as_array().unwrap().clone()
    };
    let of = |rows: &[Value], side: &str| -> Vec<Value> {
        let rows = rows.iter().filter(|row| row["side"] == side);
        rows.cloned().collect()
    };
    let (to_left, to_right) = (assemblies("10"), assemblies("-10"));
    let (right, left) = (of(&to_left, "right"), of(&to_right, "left"));
    assert!(!right.is_empty());
    assert_eq!(right.len(), left.len());
    for (right, left) in right.iter().zip(&left) {
        let number = |row: &Value, name: &str| row[name].as_f64().unwrap();
        for (name, sign) in [
            ("wheel_centre_x_mm", 1.0),
            ("wheel_centre_y_mm", -1.0),
            ("camber_deg", 1.0),
            ("toe_deg", 1.0),
        ] {
            let (ours, theirs) = (number(right, name), sign * number(left, name));
            assert!((ours - theirs).abs() < 1e-9, "{name}: {ours} {theirs}");
        }
        assert!(left["connected"].is_boolean(), "{left}");
        assert_eq!(right["connected"], left["connected"]);
    }
    // With the rack at zero, the assemblies of one wheel apply to both wheels.
    let (out, _) = run(&["assemblies", path], 0);
    assert!(out.contains("mirror image"), "{out}");
    assert!(!out.contains("right wheel:"), "{out}");
}

/// Value of a column at the station where every coordinate of the motion is zero.
fn at_design(out: &std::path::Path, name: &str) -> f64 {
    let curves = fs::read(out.join("curves.csv")).unwrap();
    let curves = hardpoint::report::CurveTable::read(&curves).unwrap();
    let roll = curves.column("roll_deg").unwrap();
    let heave = curves.column("heave_mm").unwrap();
    let row = (0..curves.rows()).find(|row| [roll[*row], heave[*row]] == [Some(0.0); 2]);
    curves.column(name).unwrap()[row.unwrap()].unwrap()
}

/// A set-up of an axle has target values of each wheel. The program refuses a quantity of both wheels and names the alternative.
#[test]
fn a_set_up_has_target_values_of_each_wheel() {
    let path = study("macpherson_axle.toml");
    for (want, help) in [
        ("total_toe", "give half of total_toe as toe"),
        ("ackermann", "give values of one wheel"),
    ] {
        let set = format!(
            "setup={{ adjust = [{{ length = \"tie_rod\", per_turn = 1.5 }}], want = {{ {want} = 0.2 }} }}"
        );
        let (_, said) = run(&["check", path.to_str().unwrap(), "--set", &set], 2);
        let words = format!("{want} describes both wheels");
        assert!(said.contains(&words) && said.contains(help), "{said}");
        assert!(!said.contains("needs [axle]"), "{said}");
    }
}

/// One set-up applies to both wheels of a mirrored axle. Both wheels reach the target camber and toe. The curves of the
/// axle start from these values.
#[test]
fn a_mirrored_axle_is_set_up_alike() {
    let (path, out) = (study("macpherson_axle.toml"), folder("setup_mirrored"));
    let sets = [
        "setup={ adjust = [{ shim = \"strut_top\", axis = \"y\" }, { length = \"tie_rod\", per_turn = 1.5 }], \
         want = { camber = -1.0, toe = 0.1 } }",
        "outputs.characteristics=[\"camber\", \"toe\"]",
    ];
    let sets = sets.iter().flat_map(|set| ["--set", set]);
    let base = [
        "setup",
        path.to_str().unwrap(),
        "--out",
        out.to_str().unwrap(),
    ];
    let arguments: Vec<&str> = base.into_iter().chain(sets).collect();
    let (printed, _) = run(&arguments, 0);
    assert!(
        printed.contains("Instructions for both wheels"),
        "{printed}"
    );
    // The printed direction applies to both wheels. The shim moves a strut top: for -1 deg of camber, the strut top
    // must move inboard.
    assert!(printed.contains("move inboard by "), "{printed}");
    for side in ["left", "right"] {
        let camber = at_design(&out, &format!("{side}_camber_deg"));
        let toe = at_design(&out, &format!("{side}_toe_deg"));
        assert!((camber + 1.0).abs() < 1e-8, "{side} camber {camber}");
        assert!((toe - 0.1).abs() < 1e-8, "{side} toe {toe}");
    }
    let steps = fs::read_to_string(out.join("setup.csv")).unwrap();
    assert!(steps.starts_with("side,step,"), "{steps}");
    assert_eq!(
        json(&fs::read_to_string(out.join("summary.json")).unwrap())["side"],
        "both"
    );
}

/// The wheels of an axle with different sides are set up separately to the same values. A lowered car has higher spring
/// forces.
#[test]
fn wheels_that_differ_are_set_up_one_by_one() {
    let path = study("five_link_axle.toml");
    let out = folder("setup_own");
    let set_up = |travel: &str| {
        let setup = format!(
            "setup={{ adjust = [{{ length = \"toe_link\" }}, {{ length = \"upper_front_link\" }}], \
             want = {{ camber = -1.2, toe = 0.15 }}, travel = {travel} }}"
        );
        let few = "outputs.characteristics=[\"camber\", \"toe\", \"spring_force\"]";
        let base = [
            "setup",
            path.to_str().unwrap(),
            "--out",
            out.to_str().unwrap(),
        ];
        let sets = [
            "--set",
            &setup,
            "--set",
            few,
            "--set",
            "outputs.sensitivities=[]",
            "--force",
        ];
        run(&[&base[..], &sets].concat(), 0);
        at_design(&out, "left_spring_force_N")
    };
    let (level, lowered) = (set_up("0.0"), set_up("10.0"));
    // The spring rate is 60 N/mm. The changed links move the spring seat by less than 2 mm, so by less than 120 N. The
    // lowered car compresses the spring by nearly 10 mm.
    assert!((level - 4200.0).abs() < 120.0, "{level}");
    assert!(
        (400.0..700.0).contains(&(lowered - level)),
        "{level} {lowered}"
    );
    for side in ["left", "right"] {
        let camber = at_design(&out, &format!("{side}_camber_deg"));
        let toe = at_design(&out, &format!("{side}_toe_deg"));
        assert!((camber + 1.2).abs() < 1e-8, "{side} camber {camber}");
        assert!((toe - 0.15).abs() < 1e-8, "{side} toe {toe}");
    }
    let summary = json(&fs::read_to_string(out.join("summary.json")).unwrap());
    let wheels = summary["wheels"].as_array().unwrap();
    let sides: Vec<_> = wheels.iter().map(|wheel| wheel["side"].clone()).collect();
    assert_eq!(sides, ["left", "right"]);
    // The two toe links have different lengths before the set-up, so their adjustments differ.
    let amount = |wheel: &Value| wheel["adjustments"][0]["amount"].as_f64().unwrap();
    assert_ne!(amount(&wheels[0]), amount(&wheels[1]));
}

/// The program refuses an adjustment that is too large to be real, and names the wheel, the amount and the unit.
#[test]
fn absurd_adjustments_of_a_wheel_are_refused() {
    let (path, out) = (study("five_link_axle.toml"), folder("setup_absurd"));
    let arguments = [
        "setup",
        path.to_str().unwrap(),
        "--out",
        out.to_str().unwrap(),
        "--set",
        "setup={ adjust = [{ length = \"toe_link\" }], want = { camber = 3.0 } }",
    ];
    let (_, said) = run(&arguments, 1);
    assert!(
        said.contains("left wheel: the target values need ") && said.contains(" mm at toe_link"),
        "{said}"
    );
}

/// Both wheels of a build scatter independently. The program gives the limits that every build reaches, and names the build with
/// the nearest limit. This build, written as a study, has the same limit.
#[test]
fn builds_of_an_axle_have_limits_of_both_wheels() {
    let path = study("five_link_axle_tolerance.toml");
    let arguments = [
        "limits",
        path.to_str().unwrap(),
        "--builds",
        "12",
        "--format",
        "json",
    ];
    let (out, _) = run(&arguments, 0);
    let found = json(&out);
    let rows = found["limits"].as_array().unwrap();
    let names: Vec<_> = rows
        .iter()
        .map(|row| row["quantity"].as_str().unwrap())
        .collect();
    assert_eq!(names[..2], ["left_travel_mm", "right_travel_mm"]);
    assert!(names.contains(&"roll_deg"), "{names:?}");
    let number = |row: &Value, name: &str| row[name].as_f64().unwrap();
    assert!(number(&rows[0], "nearest") != number(&rows[1], "nearest"));
    let build = number(&rows[0], "in_build").to_string();
    let (text, _) = run(&["tolerance", path.to_str().unwrap(), "--build", &build], 0);
    let built = folder("limits_build");
    fs::create_dir_all(&built).unwrap();
    let built = built.join("built.toml");
    fs::write(&built, text).unwrap();
    let (out, _) = run(&["limits", built.to_str().unwrap(), "--format", "json"], 0);
    let own = number(&json(&out)["limits"][0], "from");
    // The printed study has rounded numbers of the build, so the limits differ by rounding errors.
    assert!((own - number(&rows[0], "nearest")).abs() < 1e-6, "{own}");
}

/// The benchmark measures the evaluation in SIMD lanes if sweeps of the axle can use it. The benchmarks `accuracy` and `effects`
/// refuse an axle, because they support only one wheel.
#[test]
fn an_axle_is_timed_by_its_positions() {
    if !crate::support::has_lanes() {
        return;
    }
    let path = study("five_link_axle.toml");
    let path = path.to_str().unwrap();
    let few = [
        "--set",
        "motion={ roll = [-2.0, 0.0, 2.0] }",
        "--set",
        "outputs.characteristics=[\"camber\"]",
    ];
    let arguments = ["bench", "throughput", path, "--samples", "1", "--out", "-"];
    let more = ["--threads", "1"];
    let (csv, _) = run(&[&arguments[..], &more, &few].concat(), 0);
    for row in [
        "four angles of both wheels,\"lanes, ",
        "four angles of both wheels,one by one,1,",
        "outputs of the study,one by one,1,",
        "derivatives of four angles of both wheels by every hardpoint,one by one,1,",
    ] {
        assert!(csv.contains(row), "{row}: {csv}");
    }
    for kind in ["accuracy", "effects"] {
        let (_, said) = run(&["bench", kind, path, "--out", "-"], 2);
        assert!(said.contains("remove [axle]"), "{said}");
    }
}
