//! Tests of messages for a person: suggestions for common names, and targets in the unit of the target.

use super::{Called, study};
use serde_json::Value;

#[test]
fn usual_names_get_a_suggestion() {
    for (name, meant) in [
        ("multilink", "five_link"),
        ("double wishbone", "double_wishbone"),
        ("trailing_arm", "semi_trailing_arm"),
        ("live_axle", "solid_axle"),
        ("mcpherson", "macpherson"),
    ] {
        let called = Called::with(&["new", name], &[]);
        assert_eq!(called.code(), Some(2));
        let said = called.complained();
        assert!(said.contains(&format!("did you mean {meant}?")), "{said}");
    }
    let help = Called::with(&["new", "--help"], &[]).said();
    for name in ["semi_trailing_arm", "solid_axle", "formula_student_car"] {
        assert!(help.contains(name), "{help}");
    }
}

/// Study that requests a characteristic by another name.
fn with_characteristic(name: &str) -> String {
    let text = std::fs::read_to_string(study("macpherson_solve")).unwrap();
    let outputs = text.find("characteristics = [").unwrap();
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("s.toml");
    let changed = text[outputs..].replacen('[', &format!("[\"{name}\", "), 1);
    std::fs::write(&path, text[..outputs].to_owned() + &changed).unwrap();
    let called = Called::with(&["check", path.to_str().unwrap()], &[]);
    assert_eq!(called.code(), Some(2));
    called.complained()
}

#[test]
fn quantities_of_an_axle_say_so() {
    for (name, said) in [
        ("kpi", "did you mean \"kingpin_inclination\"?"),
        ("ackerman", "did you mean \"ackermann\"?"),
        ("wheel_rate", "wheel_rate is a quantity of an axle"),
        ("ride_frequency", "ride_frequency needs [axle]"),
    ] {
        let found = with_characteristic(name);
        assert!(found.contains(said), "{name}: {found}");
    }
}

/// After a tuning, the program prints the largest deviation of each target. This number equals the largest distance of
/// the curve from the target, in the unit of the target.
#[test]
fn targets_are_off_by_what_the_curves_say() {
    let called = Called::on("optimise", "macpherson_bump_steer", &[]);
    let said = called.said();
    assert!(
        said.contains("off: largest deviation from the target"),
        "{said}"
    );
    let summary: Value = serde_json::from_str(&called.file("summary.json")).unwrap();
    let target = &summary["targets"][0];
    let number = |value: &Value| value.as_f64().unwrap();
    let (after, tolerance) = (&target["after"], number(&target["tolerance"]));
    let off = number(&after["worst_in_unit"]);
    assert!((off - number(&after["worst"]) * tolerance).abs() <= 1e-12 * tolerance);
    let column = target["output"].as_str().unwrap();
    let curves = called.file("curves.csv");
    let mut lines = curves.lines();
    let place = lines
        .next()
        .unwrap()
        .split(',')
        .position(|name| name == column);
    let values = lines.filter_map(|line| line.split(',').nth(place?)?.parse::<f64>().ok());
    // The target toe of this study is a single number.
    let wanted = number(&target["wanted"][0]);
    assert_eq!(wanted, number(&target["wanted"][1]));
    let largest = values
        .map(|value| value - wanted)
        .max_by(|a, b| a.abs().total_cmp(&b.abs()));
    assert!(
        (largest.unwrap().abs() - off.abs()).abs() < 1e-9,
        "{largest:?} {off}"
    );
}
