//! Tests of comparisons of cars, and of files with their points.

use super::commands::{hardpoint, text};
use std::fs;

/// A comparison lists the changes between two cars. Its differences equal those of the two solutions.
#[test]
fn changes_and_differences_are_listed() {
    let directory = tempfile::tempdir().unwrap();
    let directory = directory.path();
    hardpoint(directory, &["new", "car"]).success();
    let changes = ["front.anti_roll_bar.rate=700000.0", "car.wheelbase=2700.0"];
    let mut arguments = vec!["solve", "car.toml", "--out", "changed"];
    for change in changes {
        arguments.extend(["--set", change]);
    }
    hardpoint(directory, &arguments).success();
    let arguments = [
        "compare", "car.toml", "changed", "--out", "sides", "--format", "csv",
    ];
    let said = hardpoint(directory, &arguments).success();
    let said = text(&said.get_output().stdout);
    for line in [
        "front.anti_roll_bar.rate,N_mm_per_rad,600000.0,700000.0",
        "car.wheelbase,mm,2650.0,2700.0",
    ] {
        assert!(said.contains(line), "{line}: {said}");
    }
    let csv = fs::read_to_string(directory.join("sides/comparison.csv")).unwrap();
    let cases = fs::read_to_string(directory.join("changed/cases.csv")).unwrap();
    let mut reader = csv::Reader::from_reader(csv.as_bytes());
    let mut compared = 0;
    for row in reader.records() {
        let row = row.unwrap();
        assert_eq!(row.len(), 6);
        let number = |k: usize| row[k].parse::<f64>().ok();
        if let [Some(first), Some(second), Some(difference)] = [3, 4, 5].map(number) {
            assert_eq!(second - first, difference);
            compared += 1;
        }
        // The values of the second car equal those of its own run.
        assert!(row[4].is_empty() || cases.contains(&row[4]), "{row:?}");
    }
    assert!(compared > 300, "{compared}");
    let same = ["compare", "car.toml", "car.toml", "--out", "same"];
    let said = hardpoint(directory, &same).success();
    let [stdout, stderr] = [&said.get_output().stdout, &said.get_output().stderr].map(|s| text(s));
    assert!(
        stdout.is_empty() && stderr.contains("no differences"),
        "{stdout}{stderr}"
    );
    // `compare` refuses a car with an axle.
    let refused = hardpoint(directory, &["compare", "car.toml", "car_front.toml"]).code(2);
    assert!(text(&refused.get_output().stderr).contains("a car can be compared with cars only"));
}

/// A car in other units is the same car: no change is listed, and the results differ only by rounding errors. A change
/// is stated in the units of the first car.
#[test]
fn cars_in_other_units_are_compared() {
    let directory = tempfile::tempdir().unwrap();
    let directory = directory.path();
    hardpoint(directory, &["new", "car"]).success();
    let units = [
        &["--unit", "in"][..],
        &["--unit", "in", "--force-unit", "lbf", "--mass-unit", "lb"],
        &["--unit", "m", "--frame", "sae_j670"],
    ];
    for (number, unit) in units.into_iter().enumerate() {
        let out = format!("other_{number}");
        let base = ["convert", "car.toml", "--out", &out];
        hardpoint(directory, &[&base[..], unit].concat()).success();
        let other = format!("{out}/car.toml");
        for [first, second] in [["car.toml", &other], [&other, "car.toml"]] {
            let out = format!("sides_{number}_{}", usize::from(first == "car.toml"));
            let arguments = ["compare", first, second, "--out", &out, "--format", "csv"];
            let said = hardpoint(directory, &arguments).success();
            let said = text(&said.get_output().stdout);
            assert!(
                !said.contains("car.wheelbase") && !said.contains("rate"),
                "{unit:?}: {said}"
            );
            assert!(
                !said.contains("_inner.") && !said.contains("car.cg"),
                "{unit:?}: {said}"
            );
            let csv = fs::read(directory.join(&out).join("comparison.csv")).unwrap();
            let mut compared = 0;
            for row in csv::Reader::from_reader(csv.as_slice()).records() {
                let row = row.unwrap();
                let number = |k: usize| row[k].parse::<f64>().ok();
                let [Some(a), Some(b)] = [3, 4].map(number) else {
                    assert_eq!(row[3].is_empty(), row[4].is_empty(), "{row:?}");
                    continue;
                };
                // Equilibria that are solved in other units agree to about ten digits. Loads of several kN set the
                // scale for the errors of small forces.
                let scale = a.abs().max(b.abs()).max(1.0);
                assert!((a - b).abs() <= 1e-7 * scale, "{unit:?}: {row:?}");
                compared += 1;
            }
            assert!(compared > 300, "{compared}");
        }
    }
    let changed = ["solve", "other_1/car.toml", "--out", "changed", "--set"];
    hardpoint(
        directory,
        &[&changed[..], &["front.spring.rate=200.0"]].concat(),
    )
    .success();
    let arguments = [
        "compare", "car.toml", "changed", "--out", "both", "--format", "csv",
    ];
    let said = hardpoint(directory, &arguments).success();
    let said = text(&said.get_output().stdout);
    // 200 lbf/in = 200 x 4.4482216152605 N / 25.4 mm.
    assert!(
        said.contains("front.spring.rate,N_per_mm,30.0,35.025"),
        "{said}"
    );
}

/// A car's export contains the points of both axles in the axes of the car. The rear wheel centre is one wheelbase
/// behind the front wheel centre.
#[test]
fn exported_points_are_those_of_the_car() {
    let directory = tempfile::tempdir().unwrap();
    let directory = directory.path();
    hardpoint(directory, &["new", "car"]).success();
    let said = hardpoint(directory, &["export", "car.toml", "--to", "csv"]).success();
    let csv = text(&said.get_output().stdout);
    assert!(
        csv.starts_with("axle,hardpoint,x_mm,y_mm,z_mm,side,frame,body"),
        "{csv}"
    );
    let x = |axle: &str| {
        let line = csv
            .lines()
            .find(|line| line.starts_with(&format!("{axle},wheel_centre,")));
        line.unwrap()
            .split(',')
            .nth(2)
            .unwrap()
            .parse::<f64>()
            .unwrap()
    };
    assert!((x("front") - x("rear") - 2650.0).abs() < 1e-9);
    let curves = hardpoint(
        directory,
        &["export", "car.toml", "--to", "csv", "--curves"],
    )
    .success();
    assert!(text(&curves.get_output().stdout).starts_with("case,ax_g,ay_g"));
    hardpoint(
        directory,
        &["export", "car.toml", "--to", "xlsx", "--out", "car.xlsx"],
    )
    .success();
    // An export in a format for a single axle is refused, and the message names the axles.
    let refused = hardpoint(directory, &["export", "car.toml", "--to", "adams"]).code(2);
    assert!(text(&refused.get_output().stderr).contains("car_rear.toml"));
}

/// Cars that differ only in a point of the right wheel. The comparison lists this point. It does not list the mirror images.
#[test]
fn points_of_right_wheels_are_compared() {
    let directory = tempfile::tempdir().unwrap();
    let directory = directory.path();
    hardpoint(directory, &["new", "car"]).success();
    // The left point is at y = 330.
    let right = "front.axle.right={ hardpoints = { tie_rod_inner = [-110.0, -330.5, 243.0] } }";
    let solve = ["solve", "car.toml", "--out", "changed", "--set", right];
    hardpoint(directory, &solve).success();
    let arguments = ["compare", "car.toml", "changed", "--format", "csv"];
    let said = hardpoint(directory, &arguments).success();
    let said = text(&said.get_output().stdout);
    let row = "front.right_tie_rod_inner.y,mm,-330.0,-330.5";
    assert!(said.contains(row), "{said}");
    assert_eq!(said.matches(".right_").count(), 1, "{said}");
}

/// If a file does not exist, the error names the file and does not speak of other kinds of studies.
#[test]
fn a_missing_file_is_named() {
    let directory = tempfile::tempdir().unwrap();
    let directory = directory.path();
    hardpoint(directory, &["new", "car"]).success();
    for sources in [["car.toml", "missing.toml"], ["missing.toml", "car.toml"]] {
        let said = hardpoint(directory, &["compare", sources[0], sources[1]]).code(2);
        let said = text(&said.get_output().stderr);
        assert!(said.contains("missing.toml"), "{said}");
        assert!(!said.contains("cars only"), "{said}");
    }
}
