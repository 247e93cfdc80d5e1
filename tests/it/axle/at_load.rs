//! Tests of roll at constant wheel load.

use super::commands::{run, study as sample};
use super::tuning::study;
use crate::support::larger;
use hardpoint::axle::{AxleQuantity, AxleSolver, Placement, Quantity, WheelQuantity, axle_curves};
use hardpoint::model::{PointId, Side};
use hardpoint::number::Vector3;
use hardpoint::study::Study;

const LOADS: [Quantity; 2] = [
    Quantity::Wheel(Side::Left, WheelQuantity::WheelLoad),
    Quantity::Wheel(Side::Right, WheelQuantity::WheelLoad),
];
const MOMENT: Quantity = Quantity::Axle(AxleQuantity::RollMoment);

fn at(heave: f64, roll: f64, rack: f64) -> Placement {
    let roll = roll.to_radians();
    Placement::AtLoad { heave, roll, rack }
}

/// In roll at constant load, the sum of both wheel loads equals the sum in the level position. This holds for any roll
/// angle and rack displacement. The body rises or sinks to keep this sum constant.
#[test]
fn the_sum_of_the_wheel_loads_is_held() {
    for name in ["macpherson_axle", "five_link_axle"] {
        let study = study(name, &[]);
        let axle = &study.axle().unwrap().axle;
        let mut solver = AxleSolver::<3>::new(axle, &LOADS, false).unwrap();
        let mut sum = |placement: &Placement| {
            let placed = solver.place(placement).unwrap();
            let state = solver.read(&placed).unwrap().state;
            let heave = 0.5 * (placed.travels[0] + placed.travels[1]);
            (LOADS.map(|q| q.evaluate(&state)).iter().sum::<f64>(), heave)
        };
        for heave in [0.0, -8.0] {
            let (level, _) = sum(&Placement::Roll {
                heave,
                roll: 0.0,
                rack: 0.0,
            });
            let mut moved = 0.0_f64;
            for (roll, rack) in [(0.0, 0.0), (2.5, 0.0), (-3.0, 0.0), (1.0, 12.0)] {
                let rack = if name == "five_link_axle" { 0.0 } else { rack };
                let (load, found) = sum(&at(heave, roll, rack));
                assert!(
                    (load - level).abs() < 1e-11 * level,
                    "{name}: {load} {level}"
                );
                moved = larger(moved, (found - heave).abs());
            }
            assert!(moved > 1e-3, "{name}: {moved}");
        }
    }
}

/// In roll at constant load, the slope of the roll moment equals `roll_stiffness_at_load`. The reference tests check
/// the formula of that quantity.
#[test]
fn the_slope_of_the_roll_moment_is_the_stiffness_at_load() {
    let study = study("macpherson_axle", &[]);
    let axle = &study.axle().unwrap().axle;
    let stiffness = Quantity::Axle(AxleQuantity::RollStiffnessAtLoad);
    let mut solver = AxleSolver::<3>::new(axle, &[MOMENT, stiffness], false).unwrap();
    let mut value = |quantity: Quantity, roll: f64| {
        let placed = solver.place(&at(0.0, roll, 0.0)).unwrap();
        quantity.evaluate(&solver.read(&placed).unwrap().state)
    };
    for roll in [0.0, 1.5] {
        let step = 0.1_f64;
        let slope: f64 = [(1.0, 0.75), (2.0, -0.15), (3.0, 1.0 / 60.0)]
            .map(|(k, weight)| {
                weight * (value(MOMENT, roll + k * step) - value(MOMENT, roll - k * step))
            })
            .iter()
            .sum();
        let (slope, wanted) = (slope / step.to_radians(), value(stiffness, roll));
        assert!(
            (slope - wanted).abs() < 1e-9 * wanted,
            "{roll}: {slope} {wanted}"
        );
    }
}

/// Derivatives with respect to the hardpoints of either side include the change of the mean travel. They also include the
/// change of the held load. This is the load of the level axle, which depends on the hardpoints.
#[test]
fn gradients_follow_the_load() {
    let study = study("five_link_axle", &[]);
    let axle = &study.axle().unwrap().axle;
    let sought = [
        Quantity::Corner(
            Side::Left,
            hardpoint::characteristics::Characteristic::Camber,
        ),
        LOADS[1],
        Quantity::Axle(AxleQuantity::Track),
    ];
    let placement = at(-4.0, 1.8, 0.0);
    let mut solver = AxleSolver::<3>::new(axle, &sought, false).unwrap();
    let placed = solver.place(&placement).unwrap();
    let mut gradients = vec![[Vec::new(), Vec::new()]; sought.len()];
    let receive = |quantity: usize, found: [&[Vector3<f64>]; 2]| {
        gradients[quantity] = found.map(<[Vector3<f64>]>::to_vec);
    };
    solver.gradients(&placed, &sought, receive).unwrap();
    let designs = [Side::Left, Side::Right].map(|side| axle.suspension(side).design.clone());
    let mut values = |designs: &[Vec<Vector3<f64>>; 2]| {
        solver
            .prepare(designs.each_ref().map(Vec::as_slice))
            .unwrap();
        let placed = solver.place(&placement).unwrap();
        let state = solver.read(&placed).unwrap().state;
        sought.map(|quantity| quantity.evaluate(&state))
    };
    for (side, point, axis) in [(0, 0, 2), (0, 4, 1), (1, 2, 2), (1, 7, 0)] {
        let moved = |by: f64| {
            let mut designs = designs.clone();
            let at = &mut designs[side][PointId(point).0];
            let mut coordinates = at.to_array();
            coordinates[axis] += by;
            *at = coordinates.into();
            designs
        };
        let step = 0.02;
        let mut slopes = [0.0; 3];
        for (k, weight) in [(1.0, 0.75), (2.0, -0.15), (3.0, 1.0 / 60.0)] {
            let [up, down] = [k, -k].map(|k| values(&moved(k * step)));
            for (slope, (up, down)) in slopes.iter_mut().zip(up.iter().zip(down)) {
                *slope += weight * (up - down) / step;
            }
        }
        for (quantity, slope) in slopes.iter().enumerate() {
            let all = gradients[quantity].iter().flatten();
            let largest = all.map(|by| by.norm()).fold(0.0, larger);
            let found = gradients[quantity][side][point].to_array()[axis];
            assert!(
                (found - slope).abs() < 2e-8 * largest,
                "{quantity}: {found} {slope}"
            );
        }
    }
}

/// Commands accept `hold = "wheel_load"` in a motion with roll. They refuse this option without roll, without springs,
/// or together with certificates.
#[test]
fn a_load_is_held_where_the_motion_says_so() {
    let path = sample("macpherson_axle.toml");
    let path = path.to_str().unwrap();
    let motion = "motion={ roll = [-2.0, 0.0, 2.0], hold = \"wheel_load\" }";
    let outputs = "outputs.characteristics=[\"wheel_load\", \"camber\"]";
    let (csv, _) = run(
        &[
            "solve", path, "--set", motion, "--set", outputs, "--out", "-",
        ],
        0,
    );
    let rows: Vec<Vec<&str>> = csv.lines().map(|l| l.split(',').collect()).collect();
    let column = |name: &str| rows[0].iter().position(|n| *n == name).unwrap();
    let number = |row: usize, name: &str| -> f64 { rows[row][column(name)].parse().unwrap() };
    let heave = |row| 0.5 * (number(row, "travel_left_mm") + number(row, "travel_right_mm"));
    assert_eq!(number(1, "heave_mm"), 0.0);
    assert_eq!(heave(2), 0.0);
    assert!(heave(1).abs() > 1e-3 && (heave(1) - heave(3)).abs() < 1e-9);
    for (motion, more, wanted) in [
        (
            "motion={ heave = 0.0, hold = \"wheel_load\" }",
            "",
            "has no roll",
        ),
        (motion, "outputs.certify=true", "certify\" does not work"),
        (motion, "outputs.certify=false", ""),
        // The program refuses derivatives, because they would be derivatives at constant mean travel, not at constant load.
        (
            motion,
            "outputs.order=\"velocity\"",
            "does not work with derivatives",
        ),
        (
            "motion={ roll = 1.0, hold = \"weight\" }",
            "",
            "unknown hold \"weight\"",
        ),
    ] {
        let mut arguments = vec!["check", path, "--set", motion, "--set", outputs];
        if !more.is_empty() {
            arguments.extend(["--set", more]);
        }
        let code = if wanted.is_empty() { 0 } else { 2 };
        let (_, said) = run(&arguments, code);
        assert!(said.contains(wanted), "{said}");
    }
    let alone = sample("five_link_axle_rear.toml");
    let arguments = ["check", alone.to_str().unwrap(), "--set", motion];
    let (_, said) = run(&arguments, 2);
    assert!(said.contains("needs [spring]"), "{said}");
}

/// At a heave of -30 mm and 6 degrees of roll, the mean travel of the level axle is out of reach: one wheel would be
/// beyond its travel. The search then increases the roll angle from zero in steps. It finds the load at a smaller
/// droop.
#[test]
fn the_load_is_found_where_the_level_travel_is_out_of_reach() {
    let loads = |motion: &str| -> Vec<f64> {
        let path = sample("double_wishbone_axle.toml");
        let outputs = "outputs={ characteristics = [\"wheel_load\"] }";
        let study = Study::read(&path, &[motion, outputs].map(str::to_owned)).unwrap();
        let both = study.axle().unwrap();
        let curves = axle_curves(&both.axle, &both.plan).unwrap().curves;
        let stations = curves.stations.iter();
        stations
            .map(|at| at.value(0).unwrap_or(f64::NAN) + at.value(1).unwrap_or(f64::NAN))
            .collect()
    };
    let level = loads("motion={ heave = [-30.0], roll = [0.0] }")[0];
    let held = loads(
        "motion={ heave = [-30.0], roll = [-6.4, -6.0, 5.8, 6.0, 6.4], hold = \"wheel_load\" }",
    );
    assert_eq!(held.len(), 5);
    for load in held {
        assert!((load - level).abs() < 1e-9 * level, "{load} {level}");
    }
    let out_of_reach = loads("motion={ heave = [-30.0], roll = [6.0] }")[0];
    assert!(out_of_reach.is_nan(), "{out_of_reach}");
}
