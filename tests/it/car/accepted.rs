//! Tests that ranges, scatter and designs of a car stay within the values that its study accepts.

use super::commands::{hardpoint, text};
use crate::support::studies;
use hardpoint::study::CarStudy;
use hardpoint::tolerance::CarProblem;
use std::fs;
use std::path::Path;

/// Reads the study of the road car with these changes.
fn read(changes: &[&str]) -> Result<CarStudy, String> {
    let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
    CarStudy::read(&studies().join("car.toml"), &changes).map_err(|errors| errors.to_string())
}

fn refusal(changes: &[&str]) -> String {
    read(changes).map_or_else(|why| why, |_| panic!("accepted: {changes:?}"))
}

/// Scatter and variables of a hardpoint. They stay valid whatever value of the car the test changes.
const SCATTER: &str =
    "tolerance.scatter=[{ axle = \"front\", hardpoint = \"tie_rod_inner\", sigma = 0.1 }]";
const TUNED: &str = "optimise.variables=[{ axle = \"front\", hardpoint = \"tie_rod_inner\", \
                     axis = \"z\", range = [-5.0, 5.0] }]";
const SWEPT: &str = "sweep.variables=[{ axle = \"front\", hardpoint = \"tie_rod_inner\", \
                     axis = \"z\", range = [-5.0, 5.0] }]";

/// Makes this entry the only variable of the sweep and of the tuning.
fn variable(written: &str) -> [String; 2] {
    [
        format!("sweep.variables=[{{{written}}}]"),
        format!("optimise.variables=[{{{written}}}]"),
    ]
}

/// The range of a variable may end at any value that the study accepts, and at no other value.
#[test]
fn a_range_ends_where_the_study_accepts_the_value() {
    let up =
        |key: &str, inside: f64, outside: f64, from: f64| (key.to_owned(), [inside, outside, from]);
    // Columns: part, key of the value, an accepted value, a refused value, and the other end of the range.
    let of_car = [
        (
            "brake_share_front",
            up("car.brake_share_front", 1.0, 1.001, 0.5),
        ),
        (
            "brake_share_front",
            up("car.brake_share_front", 0.0, -0.001, 0.9),
        ),
        (
            "drive_share_front",
            up("car.drive_share_front", 1.0, 1.5, 0.1),
        ),
        ("mass", up("car.sprung_mass", 1e-3, 0.0, 1500.0)),
        ("mass", up("car.sprung_mass", 1e-3, -139.0, 1500.0)),
        ("wheelbase", up("car.wheelbase", 1.0, 0.0, 2700.0)),
    ];
    let of_axle = [
        ("spring", up("front.spring.rate", 1e-3, 0.0, 40.0)),
        ("spring", up("front.spring.rate", 1e-3, -1.0, 40.0)),
        (
            "anti_roll_bar",
            up("front.anti_roll_bar.rate", 1.0, -2e5, 1e6),
        ),
        ("tyre", up("front.tyre.rate", 1.0, 0.0, 400.0)),
    ];
    let of_car = of_car.map(|(name, own)| (format!("car = {name:?}"), own));
    let of_axle = of_axle.map(|(name, own)| (format!("axle = \"front\", rate = {name:?}"), own));
    for (part, (key, [inside, outside, other])) in of_car.into_iter().chain(of_axle) {
        for (value, is_accepted) in [(inside, true), (outside, false)] {
            // The scatter and the variables of the sample are not valid for every value, so the test replaces them.
            let own = read(&[&format!("{key}={value:?}"), SCATTER, TUNED, SWEPT]);
            assert_eq!(own.is_ok(), is_accepted, "{key} = {value}");
            let (low, high) = (value.min(other), value.max(other));
            for change in variable(&format!("{part}, range = [{low:?}, {high:?}]")) {
                let more = ["sweep.method=\"sobol\"", "sweep.samples=2", change.as_str()];
                let found = read(&more);
                assert_eq!(found.is_ok(), is_accepted, "{change}: {:?}", found.err());
            }
        }
    }
}

/// A centre of gravity stays above the ground. The centre of gravity of a whole car stays between its axles.
#[test]
fn the_centre_of_gravity_stays_between_the_axles() {
    let of_sprung = variable("car = \"cg_z\", range = [-400.0, 600.0]");
    for change in &of_sprung {
        let said = refusal(&[change]);
        assert!(said.contains("expected coordinates above "), "{said}");
        assert!(
            said.contains("the centre of gravity must be above the ground"),
            "{said}"
        );
    }
    let directory = tempfile::tempdir().unwrap();
    let path = whole_car(directory.path());
    let whole = |changes: &[&str]| {
        let changes: Vec<String> = changes.iter().map(|&c| c.to_owned()).collect();
        CarStudy::read(&path, &changes).map_err(|errors| errors.to_string())
    };
    for (range, is_accepted) in [
        ("cg_x\", range = [-2649.0, -1.0]", true),
        ("cg_x\", range = [-2651.0, -1.0]", false),
        ("cg_x\", range = [-2000.0, 1.0]", false),
        ("wheelbase\", range = [1291.0, 2700.0]", true),
        ("wheelbase\", range = [1289.0, 2700.0]", false),
        ("mass\", range = [20.0, 1700.0]", false),
    ] {
        let [_, change] = variable(&format!("car = \"{range}"));
        let found = whole(&[&change]);
        assert_eq!(found.is_ok(), is_accepted, "{change}: {:?}", found.err());
    }
}

/// Writes the road car with the mass of the whole car.
fn whole_car(directory: &Path) -> std::path::PathBuf {
    hardpoint(directory, &["new", "car"]).success();
    let path = directory.join("car.toml");
    let text = fs::read_to_string(&path).unwrap();
    let text = text.replace("sprung_mass =", "mass =");
    fs::write(&path, text.replace("sprung_cg =", "cg =")).unwrap();
    path
}

/// The program accepts a sweep over the centre of gravity and the wheelbase if each range alone is valid. A design
/// fails if its centre of gravity is behind its rear axle.
#[test]
fn an_impossible_design_of_a_sweep_fails() {
    let directory = tempfile::tempdir().unwrap();
    let directory = directory.path();
    whole_car(directory);
    let sweep = "sweep={method=\"grid\",variables=[{car=\"cg_x\",range=[-2000.0,-900.0],steps=2}, \
                 {car=\"wheelbase\",range=[1500.0,2700.0],steps=2}]}";
    let arguments = ["sweep", "car.toml", "--set", sweep, "--out", "swept"];
    hardpoint(directory, &arguments).code(1);
    let designs = fs::read_to_string(directory.join("swept/designs.csv")).unwrap();
    let rows: Vec<&str> = designs.lines().skip(1).collect();
    assert_eq!(rows.len(), 4);
    for row in rows {
        let cells: Vec<&str> = row.split(',').collect();
        let impossible = cells.contains(&"-2000.0") && cells.contains(&"1500.0");
        assert_eq!(impossible, !row.ends_with("ok"), "{row}");
    }
}

/// The program refuses scatter beyond the accepted values, and states the numbers.
#[test]
fn scatter_keeps_to_accepted_values() {
    for (entry, words) in [
        (
            "{ car = \"brake_share_front\", sigma = 2.0 }",
            "at 4 standard deviations below nominal the share is -7.32: expected a smaller sigma",
        ),
        (
            "{ car = \"brake_share_front\", sigma = 0.1 }",
            "at 4 standard deviations above nominal the share is 1.08: expected a smaller sigma",
        ),
        (
            "{ axle = \"rear\", rate = \"anti_roll_bar\", percent = 200.0 }",
            "expected a smaller percent",
        ),
        (
            "{ axle = \"front\", rate = \"spring\", limits = [-31.0, 0.0] }",
            "expected a rate above 0",
        ),
    ] {
        let said = refusal(&[&format!("tolerance.scatter=[{entry}]")]);
        assert!(said.contains(words), "{entry}: {said}");
    }
    // The scatter of four sigma stays within the limits in both directions: 0.68 - 4 x 0.07 and 0.68 + 4 x 0.07.
    read(&["tolerance.scatter=[{ car = \"brake_share_front\", sigma = 0.07 }]"]).unwrap();
}

/// Two tolerances change the same rate. Each tolerance reduces the rate by up to two thirds, with uniform
/// distribution. In one eighth of the builds, the rate falls below zero, and the program rejects these builds.
#[test]
fn impossible_builds_are_rejected() {
    let rate = 30.0;
    let own = format!("front.spring.rate={rate:?}");
    let entry = format!(
        "{{ axle = \"front\", rate = \"spring\", limits = [{}, 0.0] }}",
        -rate * 2.0 / 3.0
    );
    let builds = 800;
    let study = read(&[
        &own,
        &format!("tolerance.scatter=[{entry}, {entry}]"),
        &format!("tolerance.builds={builds}"),
    ])
    .unwrap();
    let problem = CarProblem::of(&study, study.tolerance.as_ref().unwrap()).unwrap();
    let refused: Vec<String> = (0..builds).filter_map(|n| problem.built(n).err()).collect();
    let expected = builds as f64 / 8.0;
    let deviation = (expected * 7.0 / 8.0).sqrt();
    let found = refused.len() as f64;
    assert!(
        (found - expected).abs() < 5.0 * deviation,
        "{found} {expected}"
    );
    for why in refused {
        assert!(why.starts_with("front.spring.rate is -"), "{why}");
        assert!(why.ends_with(": expected a rate above 0"), "{why}");
    }
}

/// The program refuses a second variable for the same value or the same coordinate.
#[test]
fn a_value_has_one_variable() {
    let pairs = [
        (
            "{axle=\"front\",rate=\"spring\",percent=10.0},{axle=\"front\",rate=\"spring\",range=[20.0,40.0]}",
            "front_spring_rate is already a variable",
        ),
        (
            "{car=\"cg_z\",percent=5.0},{car=\"cg_z\",range=[540.0,580.0]}",
            "car_cg_z is already a variable",
        ),
        (
            "{axle=\"front\",hardpoint=\"tie_rod_inner\",axis=\"z\",range=[-5.0,5.0]},\
             {axle=\"front\",hardpoints=[\"tie_rod_inner\"],axis=\"z\",range=[-9.0,5.0]}",
            "front_tie_rod_inner_dz is already a variable",
        ),
    ];
    for (variables, words) in pairs {
        for section in ["optimise", "sweep"] {
            let said = refusal(&[&format!("{section}.variables=[{variables}]")]);
            assert!(said.contains(words), "{section}: {said}");
        }
    }
}

/// The program refuses a percentage of 0, because it would have no effect.
#[test]
fn a_percentage_of_zero_is_refused() {
    let zero = "car.sprung_cg=[-1290.0, 0.0, 560.0]";
    let words = "the study's value is 0, so percent has no effect: expected ";
    let scatter = refusal(&[zero, "tolerance.scatter=[{car=\"cg_y\",percent=10.0}]"]);
    assert!(
        scatter.contains(&format!("{words}sigma or limits")),
        "{scatter}"
    );
    for change in variable("car = \"cg_y\", percent = 10.0") {
        let said = refusal(&[zero, &change]);
        assert!(said.contains(&format!("{words}range")), "{said}");
        read(&[&change, "sweep.method=\"sobol\""]).unwrap();
    }
}

/// A case requests elastic tyres, but the car has rigid tyres. The program refuses this, and its message gives the
/// reason that applies.
#[test]
fn elastic_tyres_of_a_rigid_case_have_the_right_reason() {
    let case = "cases=[{name=\"turn\",ay=0.6,tyres=\"elastic\"}]";
    let said = refusal(&["car.tyres=\"rigid\"", case]);
    assert!(
        said.contains("[car] tyres = \"rigid\" makes the tyres of every case rigid"),
        "{said}"
    );
    assert!(!said.contains("both axle studies"), "{said}");
}

/// If only one axle has `[tyre]`, the study must request rigid tyres, and the message names the axle without tyres.
#[test]
fn an_axle_without_tyres_is_named() {
    let directory = tempfile::tempdir().unwrap();
    let directory = directory.path();
    for (end, other) in [("front", "rear"), ("rear", "front")] {
        for file in ["car", "car_front", "car_rear"].map(|name| format!("{name}.toml")) {
            fs::copy(studies().join(&file), directory.join(&file)).unwrap();
        }
        let path = directory.join(format!("car_{end}.toml"));
        let study = fs::read_to_string(&path).unwrap();
        let (head, tail) = study.split_once("[tyre]").unwrap();
        let tail = tail.split_once("\n[").map_or("", |(_, rest)| rest);
        fs::write(&path, format!("{head}[{tail}")).unwrap();
        let refused = hardpoint(directory, &["check", "car.toml"]).code(2);
        let said = text(&refused.get_output().stderr);
        assert!(
            said.contains(&format!("the {end} study has no [tyre]")),
            "{said}"
        );
        assert!(
            !said.contains(&format!("the {other} study has no")),
            "{said}"
        );
        assert!(said.contains("tyres = \"rigid\""), "{said}");
        let rigid = ["check", "car.toml", "--set", "car.tyres=\"rigid\""];
        hardpoint(directory, &rigid).success();
    }
}
