//! Tests of the paper's example as a study, through the program.

use super::table::check_table;
use super::{at, bound, number, reference, size, strut, vector};
use assert_cmd::Command;
use hardpoint::attia::Drive;
use hardpoint::attia::PointCoordinates;
use hardpoint::attia::Rates;
use hardpoint::attia::StrutPoints;
use hardpoint::number::Vector3;
use std::collections::HashMap;
use std::path::Path;

const FORMULATIONS: [&str; 2] = ["point_coordinates", "knuckle_pose"];

fn study_file(name: &str) -> String {
    format!("{}/studies/{name}.toml", env!("CARGO_MANIFEST_DIR"))
}

/// CSV file by rows and column names.
struct Table {
    places: HashMap<String, usize>,
    rows: Vec<Vec<String>>,
}

impl Table {
    fn cell(&self, row: usize, column: &str) -> &str {
        let place = self.places.get(column);
        &self.rows[row][*place.unwrap_or_else(|| panic!("there is no column {column}"))]
    }

    fn number(&self, row: usize, column: &str) -> f64 {
        self.cell(row, column).parse().unwrap()
    }

    fn vector(&self, row: usize, name: impl Fn(&str) -> String) -> Vector3<f64> {
        let [x, y, z] = ["x", "y", "z"].map(|axis| self.number(row, &name(axis)));
        Vector3::new(x, y, z)
    }

    /// Position of a point with its velocity and acceleration (derivatives with respect to time).
    fn point(&self, row: usize, name: &str) -> [Vector3<f64>; 3] {
        [("", "m"), ("v", "m_per_s"), ("a", "m_per_s2")]
            .map(|(letter, unit)| self.vector(row, |axis| format!("{name}_{letter}{axis}_{unit}")))
    }

    /// Angular velocity and acceleration of the knuckle.
    fn knuckle(&self, row: usize) -> [Vector3<f64>; 2] {
        [("omega", "rad_per_s"), ("alpha", "rad_per_s2")]
            .map(|(what, unit)| self.vector(row, |axis| format!("knuckle_{what}_{axis}_{unit}")))
    }

    /// Eleven vectors at one time of Table 2, in its order.
    fn of_table_2(&self, row: usize) -> Vec<Vector3<f64>> {
        let points = ["tie_rod_outer", "rod_point", "wheel_centre"];
        let points = points.into_iter().flat_map(|name| self.point(row, name));
        points.chain(self.knuckle(row)).collect()
    }
}

/// Solves a study and returns its curves with the exit code and the messages.
fn solve(study: &str, overrides: &[&str]) -> (Table, i32, String) {
    let mut command = Command::cargo_bin("hardpoint").unwrap();
    command.args(["solve", &study_file(study), "--out", "-"]);
    for set in overrides {
        command.args(["--set", set]);
    }
    let output = command.output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    let mut reader = csv::Reader::from_reader(&output.stdout[..]);
    let header = reader.headers().unwrap().clone();
    let places = header
        .iter()
        .enumerate()
        .map(|(i, name)| (name.to_owned(), i));
    let rows = reader
        .records()
        .map(|r| r.unwrap().iter().map(str::to_owned).collect());
    let table = Table {
        places: places.collect(),
        rows: rows.collect(),
    };
    (table, output.status.code().unwrap(), said)
}

fn solve_example(formulation: &str) -> Table {
    let set = format!("solver.formulation={formulation}");
    let (table, code, said) = solve("attia", &[&set]);
    assert_eq!(code, 0, "{said}");
    assert_eq!(table.rows.len(), 201);
    table
}

/// Row of a time in the example, which has a hundred steps per second.
fn row(time: f64) -> usize {
    (100.0 * time) as usize
}

#[test]
fn the_sample_study_writes_table_2() {
    for formulation in FORMULATIONS {
        let table = solve_example(formulation);
        check_table(|time| {
            assert_eq!(table.number(row(time), "time_s"), time);
            table.of_table_2(row(time))
        });
    }
}

/// At the times of the table, both formulations agree with 110-digit values within their conditioning. This includes
/// the paper's two angles of Fig. 5.
#[test]
fn the_sample_study_is_right_to_the_accuracy_of_its_conditioning() {
    let case = reference("attia-example");
    let strut = strut(&case);
    let equations = PointCoordinates::new(&strut, StrutPoints::Spread, Drive::PaperTheta).unwrap();
    for table in FORMULATIONS.map(solve_example) {
        for (time, state) in [0.0, 1.0, 2.0]
            .into_iter()
            .zip(case["states"].as_array().unwrap())
        {
            let row = row(time);
            assert_eq!(state["drive"]["kind"], "paper_theta");
            let theta = number(&state["drive"]["value"]);
            assert!((table.number(row, "theta_deg") - theta.to_degrees()).abs() < 1e-13);
            let pose = equations.track(&equations.design(), at(theta)).unwrap();
            let rates = Rates {
                drive: number(&state["time"]["drive_rate"]),
                drive_acceleration: number(&state["time"]["drive_accel"]),
                ..Rates::default()
            };
            let motion = equations.motion(&pose, rates).unwrap();
            let sizes = [pose.moving(), &motion.velocity, &motion.acceleration].map(size);
            let bounds = [0, 1, 2].map(|k| bound(&equations, &pose, k, sizes[k]));
            let keys = [
                &state["positions"],
                &state["time"]["vel"],
                &state["time"]["acc"],
            ];
            for (name, number) in [
                ("tie_rod_outer", "p8"),
                ("rod_point", "p9"),
                ("wheel_centre", "p10"),
            ] {
                let found = table.point(row, name);
                for k in 0..3 {
                    let error = (found[k] - vector(&keys[k][number])).norm();
                    assert!(error < bounds[k], "{name}, order {k}, {time} s: {error:e}");
                }
            }
            for (k, key) in ["omega", "alpha"].into_iter().enumerate() {
                let error = (table.knuckle(row)[k] - vector(&state["time"][key])).norm();
                // The error of an angular rate is the error of a velocity divided by the shortest lever, 50 mm.
                assert!(error < bounds[k + 1] / 0.05, "{key}, {time} s: {error:e}");
            }
            for (column, key) in [
                ("attia_kingpin_deg", "paper_alpha"),
                ("attia_camber_deg", "paper_beta"),
            ] {
                let expected = number(&state["angles"][key]["d0"]);
                let error = table.number(row, column).to_radians() - expected;
                // The lines 5-7 and 7-10 are at least 0.15 m long.
                assert!(
                    error.abs() < bounds[0] / 0.15,
                    "{column}, {time} s: {error:e}"
                );
            }
        }
    }
}

/// This is Fig. 4 over the whole motion. The wheel falls until the arm reverses at theta = pi, t = 1.2985 s. The wheel
/// centre is lowest 0.02 s before and after that time. Both formulations agree along the whole motion.
///
/// The error bound grows with the condition number of the equations. It is divided by sin(theta) once for each order of
/// the derivative. It is also divided by the shortest lever, 50 mm, because an angular rate is a velocity divided by a
/// lever.
#[test]
fn the_formulations_agree_through_the_bounce() {
    let strut = strut(&reference("attia-example"));
    let equations = PointCoordinates::new(&strut, StrutPoints::Spread, Drive::PaperTheta).unwrap();
    let [paper, production] = FORMULATIONS.map(solve_example);
    let fall = |row: usize| paper.number(row, "wheel_centre_vz_m_per_s");
    assert!((0..126).all(|row| fall(row) < 0.0) && (132..201).all(|row| fall(row) > 0.0));
    let mut pose = equations.design();
    for row in 0..201 {
        let theta = paper.number(row, "theta_deg").to_radians();
        pose = equations.track(&pose, at(theta)).unwrap();
        let (ours, theirs) = (production.of_table_2(row), paper.of_table_2(row));
        for (place, (ours, theirs)) in ours.iter().zip(&theirs).enumerate() {
            let order = [0, 1, 2, 0, 1, 2, 0, 1, 2, 1, 2][place];
            let loss = theta.sin().abs().powi(order) * 0.05;
            let bound = bound(&equations, &pose, order as usize, ours.norm()) / loss;
            let apart = (*ours - *theirs).norm();
            assert!(
                apart < bound,
                "row {row}, place {place}: {apart:e}, {bound:e}"
            );
        }
    }
}

/// The drive accepts angles in degrees, and derivatives are with respect to these angles. The solver refuses a station
/// at a multiple of 180 degrees with the reason. It solves the stations beside this angle. Beyond this angle the arm
/// moves back.
#[test]
fn dead_centres_are_refused_with_the_reason() {
    for (formulation, reason) in FORMULATIONS
        .into_iter()
        .zip(["theta gets no further", "theta takes the arm"])
    {
        let set = format!("solver.formulation={formulation}");
        let motion = "motion={ drive = \"paper_theta\", theta = [60, 120, 179, 180, 240, 300] }";
        let (table, code, said) = solve("attia", &[&set, motion]);
        assert_eq!(code, 1);
        let status: Vec<_> = (0..6).map(|row| table.cell(row, "status")).collect();
        assert_eq!(
            status,
            ["ok", "ok", "ok", "unreachable", "ok", "ok"],
            "{formulation}"
        );
        assert!(
            said.contains("theta 180 deg") && said.contains(reason),
            "{said}"
        );
        assert_eq!(table.cell(3, "wheel_centre_z_m"), "");
        for (there, back) in [(0, 5), (1, 4)] {
            for (column, sign) in [
                ("wheel_centre_z_m", 1.0),
                ("wheel_centre_z_d1_m_per_deg", -1.0),
            ] {
                let [there, back] = [there, back].map(|row| table.number(row, column));
                assert!(
                    (there - sign * back).abs() < 1e-14,
                    "{formulation}, {column}"
                );
            }
        }
    }
}

/// In a road car, the arm axis is neither level nor beside point 1. For such a car, theta is the angle of (15) in both
/// formulations.
#[test]
fn theta_of_a_road_car_is_that_of_equation_15() {
    let motion = "motion={ drive = \"paper_theta\", theta = [88.0, 90.0, 92.0, 95.0], rack = 5.0 }";
    let outputs =
        "outputs={ points = [\"lower_ball_joint\", \"wheel_centre\"], order = \"acceleration\" }";
    let solved = FORMULATIONS.map(|formulation| {
        let set = format!("solver.formulation={formulation}");
        let (table, code, said) = solve("macpherson_solve", &[&set, motion, outputs]);
        assert_eq!(code, 0, "{said}");
        table
    });
    let (p1, p5) = (
        Vector3::new(120.0, 360.0, 195.0),
        Vector3::new(5.0, 705.0, 190.0),
    );
    for row in 0..4 {
        for table in &solved {
            let theta = table.number(row, "theta_deg").to_radians();
            let height = table.number(row, "lower_ball_joint_z_mm") - p1.z;
            assert!((height - (p5 - p1).norm() * theta.cos()).abs() < 1e-12);
        }
        for (column, rounding) in [
            ("wheel_centre_x_mm", 1e-10),
            ("wheel_centre_y_d1_mm_per_deg", 1e-11),
            ("wheel_centre_z_d2_mm_per_deg2", 1e-11),
        ] {
            let [a, b] = [0, 1].map(|k| solved[k].number(row, column));
            assert!((a - b).abs() < rounding, "{column}: {a} {b}");
        }
    }
}

/// `check` shows the design position with derivatives with respect to theta, the study's drive. The derivative of z5 is
/// -d51 sin(theta), so the ball joint falls when theta increases.
#[test]
fn check_differentiates_by_theta() {
    let strut = strut(&reference("attia-example"));
    let leg = strut.lower_ball_joint - strut.lower_arm_front;
    let slope = -leg.x.hypot(leg.y).to_radians();
    for formulation in FORMULATIONS {
        let set = format!("solver.formulation={formulation}");
        let outputs = "outputs={ points = [\"lower_ball_joint\"], order = \"velocity\" }";
        let study = study_file("attia");
        let mut command = Command::cargo_bin("hardpoint").unwrap();
        let set = ["--set", &set, "--set", outputs, "--format", "csv"];
        let output = command.args(["check", &study]).args(set).output().unwrap();
        let text = String::from_utf8(output.stdout).unwrap();
        let name = "design,lower_ball_joint_z_d1_m_per_deg,";
        let found = text.lines().find_map(|line| line.strip_prefix(name));
        let found = found.and_then(|cells| cells.split(',').next());
        let found: f64 = found.unwrap_or_else(|| panic!("{text}")).parse().unwrap();
        assert!((found / slope - 1.0).abs() < 1e-12, "{found} {slope}");
    }
}

/// If the formulation or the drive cannot give an output, the program refuses it with the line number, before it solves
/// anything.
#[test]
fn what_cannot_be_given_is_refused_by_line() {
    let paper = "solver.formulation=point_coordinates";
    for (study, overrides, expected) in [
        (
            "macpherson_solve",
            &[paper, "outputs.sensitivities=[\"strut_top\"]"][..],
            "but [outputs] requests them",
        ),
        ("macpherson_front", &[paper], "but [optimise] needs them"),
        (
            "macpherson_solve",
            &[
                paper,
                "outputs.characteristics=[\"camber_gain\"]",
                "outputs.order=acceleration",
            ],
            "camber_gain with order = \"acceleration\" needs derivatives up to order 3",
        ),
        (
            "attia",
            &[
                "solver.formulation=knuckle_pose",
                "outputs.sensitivities=true",
            ],
            "the drive \"paper_theta\"",
        ),
        (
            "double_wishbone_solve",
            &[paper],
            "those of a MacPherson strut, not of a double_wishbone",
        ),
        (
            "attia",
            &["solver.formulation=closed"],
            "unknown formulation \"closed\"; expected \"knuckle_pose\" or \"point_coordinates\"",
        ),
        (
            "attia",
            &["motion.travel=0"],
            "travel is given, but the drive is \"paper_theta\"",
        ),
        (
            "macpherson_solve",
            &["outputs.characteristics=[\"attia_camber\"]"],
            "attia_camber needs strut_upper in [suspension.hardpoints]",
        ),
    ] {
        let mut command = Command::cargo_bin("hardpoint").unwrap();
        command.args(["solve", &study_file(study), "--out", "-"]);
        for set in overrides {
            command.args(["--set", set]);
        }
        let output = command.output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(
            said.contains(expected) && said.contains(".toml (with --set):"),
            "{said}"
        );
    }
}

/// The paper's formulation refuses a design that its equations cannot describe, and names the cause. The default
/// formulation solves this design.
#[test]
fn a_ball_joint_on_the_strut_axis_is_named() {
    let study = study_file("macpherson_solve");
    assert!(Path::new(&study).exists());
    let joint = "suspension.hardpoints.strut_lower=[-11, 653, 410]";
    let joint_on_axis = "suspension.hardpoints.lower_ball_joint=[5.0, 705.0, 190.0]";
    let top = "suspension.hardpoints.strut_top=[-27.0, 601.0, 630.0]";
    let common = [joint_on_axis, joint, top];
    let (table, code, said) = solve("macpherson_solve", &common);
    assert_eq!((code, table.rows.len()), (0, 41), "{said}");
    let mut command = Command::cargo_bin("hardpoint").unwrap();
    command.args([
        "solve",
        &study,
        "--out",
        "-",
        "--set",
        "solver.formulation=point_coordinates",
    ]);
    for set in common {
        command.args(["--set", set]);
    }
    let output = command.output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(
        said.contains("the ball joint lies on the axis of the strut"),
        "{said}"
    );
}
