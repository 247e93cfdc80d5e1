//! Tests of the limits of a car along directions of acceleration.

use super::{car, formula_student_car, reference};
use crate::support::larger;
use crate::support::rows_by_column;
use hardpoint::car::{Car, CarQuantity, CarSolver, Case, WheelPlace, WheelResult};

/// Load case scaled to this horizontal acceleration, in g.
fn at(case: &Case, g: f64) -> Case {
    let length = case.ax.hypot(case.ay);
    Case {
        ax: case.ax * g / length,
        ay: case.ay * g / length,
        ..case.clone()
    }
}

fn loads(solver: &mut CarSolver<'_>, case: &Case) -> ([f64; 4], [bool; 4]) {
    let found = solver.solve(case).unwrap();
    let solved = solver.solved(case, &found).unwrap();
    let load = |place| CarQuantity::Wheel(place, WheelResult::Load).evaluate(&solved);
    (WheelPlace::ALL.map(load), found.lifted)
}

fn directions(car: &Car) -> Vec<Case> {
    let mut rest = Case::at_rest("static");
    rest.setting.elastic_tyres = car.tyres.is_some();
    let eighths = (0..8).map(|k| Case::along("direction", 45.0 * f64::from(k), &rest));
    eighths.collect()
}

/// At a lift limit one wheel has zero load and the other wheels are loaded. Just below this limit every wheel is on
/// the ground; just beyond it the wheel is lifted. The car has an equilibrium just below the end of equilibrium, but
/// not just beyond this end.
#[test]
fn limits_are_where_loads_vanish() {
    let car = car(&reference());
    let mut solver = CarSolver::new(&car).unwrap();
    let (mut lifts, mut single, mut ends) = (0, 0, 0);
    for case in directions(&car) {
        let limits = solver.limits(&case).unwrap();
        if let Some(lift) = limits.lift {
            lifts += 1;
            let (found, lifted) = loads(&mut solver, &at(&case, lift.acceleration));
            let most = found.iter().copied().fold(0.0, larger);
            let wheel = lift.wheel.0;
            // If both wheels of an axle lift at once, their loads change steeply.
            let bound = if lift.others_loaded { 1e-10 } else { 1e-7 };
            assert!(found[wheel].abs() < bound * most, "{found:?}");
            let (below, down) = loads(&mut solver, &at(&case, lift.acceleration - 1e-5));
            assert_eq!(down, [false; 4], "{lifted:?}");
            assert!(below[wheel] > 0.0);
            if lift.others_loaded {
                let others = (0..4).filter(|other| *other != wheel);
                assert!(others.clone().all(|other| found[other] > 1.0), "{found:?}");
                let (_, up) = loads(&mut solver, &at(&case, lift.acceleration + 1e-5));
                assert!(up[wheel], "{case:?}");
                single += 1;
            }
        }
        if limits.why.is_some() {
            assert!(solver.solve(&at(&case, limits.end - 1e-5)).is_ok());
            assert!(solver.solve(&at(&case, limits.end + 1e-4)).is_err());
            ends += 1;
        }
    }
    assert!(lifts >= 4, "{lifts}");
    assert!(single > 0 && ends > 0, "{single} {ends}");
}

/// A symmetric car lifts mirrored wheels at the same accelerations. In straight acceleration it lifts both front wheels
/// at once.
#[test]
fn limits_of_a_mirror_image_are_mirrored() {
    let car = formula_student_car();
    let mut solver = CarSolver::new(&car).unwrap();
    let limits: Vec<_> = directions(&car)
        .iter()
        .map(|case| solver.limits(case).unwrap())
        .collect();
    for (left, right) in [(1, 7), (2, 6), (3, 5)] {
        let [one, other] = [left, right].map(|k| limits[k].lift.unwrap());
        let apart = (one.acceleration - other.acceleration).abs();
        assert!(apart < 1e-6, "{one:?} {other:?}");
        assert_eq!(one.wheel.0 ^ 1, other.wheel.0);
        assert!(one.others_loaded && other.others_loaded);
    }
    // Under braking both rear wheels lift at once, and then the rear axle cannot brake.
    let braking = &limits[4];
    let lift = braking.lift.unwrap();
    assert!(!lift.others_loaded && lift.wheel.0 / 2 == 1, "{braking:?}");
    assert!(
        (braking.end - lift.acceleration).abs() < 1e-5,
        "{braking:?}"
    );
    let last = at(&directions(&car)[4], braking.end - 1e-5);
    let (loads, _) = loads(&mut solver, &last);
    assert!(loads[2] > 0.0 && loads[2] < 0.1 * loads[0], "{loads:?}");
    assert!((loads[2] - loads[3]).abs() < 1e-6 * loads[0], "{loads:?}");
    // A turn to the left unloads a left wheel.
    assert_eq!(limits[2].lift.unwrap().wheel.0 % 2, 0);
}

/// In a steady turn, the car tips about the contact line of its outer wheels. Without roll it tips at ay = t/(2 h) in
/// g, with the track t and the height h of the centre of gravity. Roll moves the centre of gravity outward, so the
/// equilibrium ends earlier, by less than a quarter.
#[test]
fn the_lateral_limit_is_below_that_of_a_rigid_car() {
    let car = formula_student_car();
    let mut solver = CarSolver::new(&car).unwrap();
    let case = &directions(&car)[2];
    let end = solver.limits(case).unwrap().end;
    let rest = Case::at_rest("static");
    let found = solver.solve(&rest).unwrap();
    let solved = solver.solved(&rest, &found).unwrap();
    let value = |name: &str| CarQuantity::named(name)[0].evaluate(&solved);
    let track = 0.5 * (value("track_front") + value("track_rear"));
    let bound = track / (2.0 * value("cg_height"));
    assert!(end < bound && end > 0.75 * bound, "{end} {bound}");
}

/// The command prints directions and cases, and writes a table for other programs.
#[test]
fn the_command_prints_a_table() {
    let directory = tempfile::tempdir().unwrap();
    let study = crate::support::studies().join("car.toml");
    let study = study.to_str().unwrap();
    let arguments = ["limits", study, "--format", "csv"];
    let said = super::commands::hardpoint(directory.path(), &arguments).success();
    let csv = super::commands::text(&said.get_output().stdout);
    // The table prints only digits that the program knows: at most five decimals.
    let ends = rows_by_column(&said.get_output().stdout);
    let ends = ends.iter().filter_map(|row| row.get("end_g"));
    let places = |number: &String| number.split_once('.').map_or(0, |(_, places)| places.len());
    let places: Vec<usize> = ends.filter(|end| !end.is_empty()).map(places).collect();
    assert!(
        !places.is_empty() && places.iter().all(|places| *places <= 5),
        "{csv}"
    );
    let header = "case,direction_deg,g,ax_g,ay_g,wheel,others_loaded,end_g,reason,status";
    assert!(csv.contains(header), "{csv}");
    // In CSV, yes and no are true and false.
    assert!(csv.contains(",front_left,true,"), "{csv}");
    assert!(!csv.contains(",yes,"), "{csv}");
    for case in ["turn,90", "braking,180", "trail_braking,", "fast,90"] {
        assert!(
            csv.contains(&format!("\nlift_limits,{case}")),
            "{case}: {csv}"
        );
    }
}
