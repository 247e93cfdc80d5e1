//! Tests of the loads of a study as a user sees them in `curves.csv`. The forces of links, joints and spring balance
//! the wheel carrier, and the work of the spring equals the work of the load.

use crate::support::Worst;
use hardpoint::curves::{Curves, Status, curves};
use hardpoint::model::Axis;
use hardpoint::number::Vector3;
use hardpoint::plan::Plan;
use hardpoint::report::{CurveTable, curves_csv};
use hardpoint::study::Study;
use std::path::Path;

const LOADS: &str = "loads=[
    {name=\"braking\", at=\"contact_point\", force=[-3000.0, 400.0, 4000.0], moment=[2e4, -3e4, 5e4]},
    {name=\"kerb\", at=\"wheel_centre\", force=[-1000.0, -200.0, 2500.0]},
    {name=\"torque\", at=\"wheel_centre\", moment=[0.0, 7e5, 1e5]}]";

fn study(name: &str, overrides: &[String]) -> Study {
    let path = crate::support::studies().join(name);
    Study::read(&path, overrides).unwrap_or_else(|e| panic!("{e}"))
}

fn run(study: &Study) -> (Curves, CurveTable) {
    let plan = Plan::of(study.one_wheel().unwrap());
    let found = curves(study.wheel(), &plan).unwrap();
    let table = CurveTable::read(&curves_csv(&found)).unwrap();
    assert!(table.rows() > 0);
    (found, table)
}

/// Sample study for a wheel of the given side in the given axes, with loads and all outputs of the force balance.
/// `signs` convert coordinates from the sample's axes and side.
fn loaded(name: &str, side: &str, frame: &str, signs: [f64; 3]) -> Study {
    let (file, body) = match name {
        "pushrod_on_knuckle" => ("double_wishbone_pushrod.toml", Some("knuckle")),
        "double_wishbone_pushrod" => ("double_wishbone_pushrod.toml", None),
        name => (&*format!("{name}_solve.toml"), None),
    };
    let sample = study(file, &[]).into_wheel();
    let mechanism = &sample.mechanism;
    let names: Vec<String> = mechanism.points.iter().map(|p| p.name.clone()).collect();
    let mut overrides = vec![
        format!("suspension.side=\"{side}\""),
        format!("suspension.frame=\"{frame}\""),
        format!(
            "outputs={{characteristics=[\"motion_ratio\"], points={names:?}, order=\"velocity\", \
             knuckle=true, {}}}",
            LOADS.replace('\n', " ")
        ),
    ];
    if mechanism.steering_axis.is_some() {
        overrides.push("motion.rack=[-12.0, 0.0, 12.0]".to_owned());
    }
    for (name, p) in names.iter().zip(&sample.design) {
        let [x, y, z] = [signs[0] * p.x, signs[1] * p.y, signs[2] * p.z];
        overrides.push(format!(
            "suspension.hardpoints.{name}=[{x:?}, {y:?}, {z:?}]"
        ));
    }
    overrides.extend(body.map(|body| format!("suspension.bodies.pushrod_outer=\"{body}\"")));
    study(file, &overrides)
}

/// Row of `curves.csv`.
struct Row<'a> {
    table: &'a CurveTable,
    number: usize,
}

impl Row<'_> {
    fn value(&self, column: &str) -> f64 {
        let values = self
            .table
            .column(column)
            .unwrap_or_else(|| panic!("{column} of {:?}", self.table.header));
        values[self.number].unwrap()
    }

    fn vector(&self, column: impl Fn(&str) -> String) -> Vector3<f64> {
        Vector3::from(Axis::ALL.map(|axis| self.value(&column(axis.name()))))
    }

    fn point(&self, name: &str) -> Vector3<f64> {
        self.vector(|axis| format!("{name}_{axis}_mm"))
    }

    /// Forces that balance the wheel carrier under a load, each with its point of application.
    fn forces(&self, topology: &str, load: &str) -> Vec<(Vector3<f64>, Vector3<f64>)> {
        let newtons = |name: &str| self.value(&format!("{load}_{name}_N"));
        let vector = |name: &str| self.vector(|axis| format!("{load}_{name}_{axis}_N"));
        let between = |a: &str, b: &str| (self.point(b) - self.point(a)).normalised();
        let rod = |name: &str| {
            let [inner, outer] = ["inner", "outer"].map(|end| format!("{name}_{end}"));
            (self.point(&outer), between(&outer, &inner) * newtons(name))
        };
        let joint = |name: &str| (self.point(name), vector(name));
        let spring = |upper: &str, lower: &str| {
            (self.point(lower), between(upper, lower) * newtons("spring"))
        };
        match topology {
            "double_wishbone" | "double_wishbone_pushrod" => vec![
                joint("upper_ball_joint"),
                joint("lower_ball_joint"),
                rod("tie_rod"),
            ],
            "pushrod_on_knuckle" => vec![
                joint("upper_ball_joint"),
                joint("lower_ball_joint"),
                rod("tie_rod"),
                rod("pushrod"),
            ],
            "macpherson" => vec![
                joint("lower_ball_joint"),
                (self.point("strut_top"), vector("strut_side")),
                spring("strut_top", "strut_lower"),
                rod("tie_rod"),
            ],
            "five_link" => vec![
                rod("upper_front_link"),
                rod("upper_rear_link"),
                rod("lower_front_link"),
                rod("lower_rear_link"),
                rod("toe_link"),
                spring("spring_upper", "spring_lower"),
            ],
            "semi_trailing_arm" => vec![
                joint("arm_pivot_inner"),
                joint("arm_pivot_outer"),
                spring("spring_upper", "spring_lower"),
            ],
            other => panic!("{other}"),
        }
    }

    /// Point on the ground below the wheel, in the wheel plane.
    fn contact_point(&self, up: Vector3<f64>, radius: f64) -> Vector3<f64> {
        let centre = self.point("wheel_centre");
        let spin = (centre - self.point("spindle_inner")).normalised();
        let upward = up - spin * up.dot(spin);
        centre - upward.normalised() * radius
    }
}

#[test]
fn the_wheel_carrier_is_in_equilibrium_and_the_spring_takes_the_work() {
    for name in [
        "double_wishbone",
        "macpherson",
        "five_link",
        "semi_trailing_arm",
        "double_wishbone_pushrod",
        "pushrod_on_knuckle",
    ] {
        for (side, frame, signs) in [
            ("left", "iso8855", [1.0, 1.0, 1.0]),
            ("right", "iso8855", [1.0, -1.0, 1.0]),
            ("left", "sae_j670", [1.0, -1.0, -1.0]),
            ("right", "x_rear", [-1.0, 1.0, 1.0]),
        ] {
            let study = loaded(name, side, frame, signs);
            let (found, table) = run(&study);
            assert!(found.are_complete());
            let radius = study.wheel().wheel_radius.unwrap();
            let up = Vector3::new(0.0, 0.0, signs[2]);
            let (mut balance, mut work) = (Worst::default(), Worst::default());
            for number in 0..table.rows() {
                let row = Row {
                    table: &table,
                    number,
                };
                let contact = row.contact_point(up, radius);
                let centre = row.point("wheel_centre");
                let zero = Vector3::default();
                for (load, at, force, moment) in [
                    (
                        "braking",
                        contact,
                        Vector3::new(-3000.0, 400.0, 4000.0),
                        Vector3::new(2e4, -3e4, 5e4),
                    ),
                    ("kerb", centre, Vector3::new(-1000.0, -200.0, 2500.0), zero),
                    ("torque", centre, zero, Vector3::new(0.0, 7e5, 1e5)),
                ] {
                    let mut forces = row.forces(name, load);
                    forces.push((at, force));
                    let size: f64 = forces.iter().map(|(_, f)| f.norm()).sum();
                    let sum = forces.iter().fold(zero, |sum, (_, f)| sum + *f);
                    let turning = forces
                        .iter()
                        .fold(moment, |sum, (p, f)| sum + (*p - centre).cross(*f));
                    balance.note(sum.norm() / size);
                    balance.note(turning.norm() / (size * radius));

                    let velocity = row.vector(|axis| format!("wheel_centre_{axis}_d1_mm_per_mm"));
                    let turn = row.vector(|axis| format!("knuckle_omega_{axis}_rad_per_mm"));
                    let power = force.dot(velocity + turn.cross(at - centre)) + moment.dot(turn);
                    let spring = row.value(&format!("{load}_spring_N"));
                    work.note((spring * row.value("motion_ratio") - power) / size);
                }
            }
            println!(
                "{name}, {side}, {frame}: balance {:.1e}, work {:.1e}",
                balance.0, work.0
            );
            assert!(balance.0 < 1e-12, "{name}, {side}, {frame}: {balance:?}");
            assert!(work.0 < 1e-12, "{name}, {side}, {frame}: {work:?}");
        }
    }
}

/// The forces of the two legs of an arm without a spring add up to the printed force in the arm's joint.
#[test]
fn the_legs_of_an_arm_add_up_to_the_force_in_its_joint() {
    let study = loaded("double_wishbone", "left", "iso8855", [1.0; 3]);
    let (_, table) = run(&study);
    for number in 0..table.rows() {
        let row = Row {
            table: &table,
            number,
        };
        let joint = row.point("upper_ball_joint");
        let leg = |pivot: &str| {
            let tension = row.value(&format!("braking_{pivot}_N"));
            (row.point(pivot) - joint).normalised() * tension
        };
        let legs = leg("upper_arm_front") + leg("upper_arm_rear");
        let force = row.vector(|axis| format!("braking_upper_ball_joint_{axis}_N"));
        assert!((legs - force).norm() < 1e-12 * force.norm());
    }
    // The spring bends the lower arm, so forces along the legs alone cannot describe the load of the arm. The program
    // omits these forces.
    assert_eq!(table.column("braking_lower_arm_front_N"), None);
}

/// A spring whose line meets the hinge of the arm has no leverage. The station has a status and no values.
#[test]
fn what_nothing_carries_has_a_status_and_no_values() {
    let overrides = [
        // With these points, the spring's line passes through the middle of the hinge in the design position.
        "suspension.hardpoints.spring_lower=[70.0, 580.0, 270.0]",
        "suspension.hardpoints.spring_upper=[205.0, 470.0, 262.5]",
        "motion.travel=[-40.0, 0.0, 40.0]",
        "outputs={characteristics=[\"camber\"], loads=[{name=\"kerb\", at=\"wheel_centre\", force=[0, 0, 1000]}]}",
    ];
    let study = study(
        "semi_trailing_arm_solve.toml",
        &overrides.map(str::to_owned),
    );
    let (found, table) = run(&study);
    assert_eq!(table.status, ["ok", "unsupported", "ok"]);
    assert_eq!(found.stations[1].status, Status::Unsupported);
    assert_eq!((found.failed(), found.are_complete()), (0, false));
    assert!(table.column("camber_deg").unwrap()[1].is_some());
    for (name, values) in table.header.iter().zip(&table.columns) {
        let is_force = name.ends_with("_N");
        assert_eq!(values[1].is_none(), is_force, "{name}");
        assert!(values[0].is_some() && values[2].is_some(), "{name}");
    }
    // The wheel passes the dead centre: on one side of it the spring pushes against the load, on the other side it pulls.
    let spring = table.column("kerb_spring_N").unwrap();
    assert!(spring[0].unwrap() * spring[2].unwrap() < 0.0);
}

/// If the study has no spring, the program supports the wheel by a vertical force at the wheel centre. The work of this
/// force balances the work of the load.
#[test]
fn without_a_spring_the_wheel_is_held() {
    let text = crate::support::sample("five_link_solve.toml");
    let lines: Vec<&str> = text.lines().filter(|l| !l.starts_with("spring_")).collect();
    let text = lines.join("\n").replace(", \"motion_ratio\"", "");
    let loads = "\nloads = [{ name = \"kerb\", at = \"wheel_centre\", force = [0, 0, 1000] }]\n";
    let text = text.replace("[outputs]\n", &format!("[outputs]{loads}"));
    let study = Study::from_text("study.toml", &text, Path::new(".")).unwrap();
    let (found, table) = run(&study);
    assert!(found.are_complete());
    // The vertical support at the wheel centre balances the load directly, so the five links carry no force.
    let mut forces = 0;
    for (name, values) in table.header.iter().zip(&table.columns) {
        let expected = match name.as_str() {
            "kerb_support_N" => -1000.0,
            _ if name.ends_with("_N") => 0.0,
            _ => continue,
        };
        for value in values {
            assert!(
                (value.unwrap() - expected).abs() < 1e-9,
                "{name}: {value:?}"
            );
        }
        forces += 1;
    }
    assert_eq!(forces, 6);
}
