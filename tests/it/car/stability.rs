//! Tests of the end of equilibrium: a car that is built to overturn, and stable states whose stiffness matrix is not
//! symmetric.

use super::formula_student_car;
use crate::support::larger;
use hardpoint::axle::{Preloaded, RockerSprings};
use hardpoint::car::{
    Car, CarQuantity, CarSolver, Case, Longitudinal, LongitudinalShares, NoEquilibrium,
};
use hardpoint::mechanism::{Failure, LimitCause, NoPose};
use hardpoint::model::Side;
use hardpoint::study::CarStudy;
use std::path::Path;

fn value(solver: &mut CarSolver<'_>, case: &Case, name: &str) -> f64 {
    let found = solver.solve(case).unwrap();
    let solved = solver.solved(case, &found).unwrap();
    CarQuantity::named(name)[0].evaluate(&solved)
}

fn at_rest() -> Case {
    let mut case = Case::at_rest("rest");
    case.setting.elastic_tyres = false;
    case
}

/// The roll stiffness falls with the height of the centre of gravity, because the weight tilts the body. A car at rest
/// overturns just above the height where this stiffness is zero, and not just below.
#[test]
fn a_high_car_tips_where_its_roll_stiffness_ends() {
    let car = formula_student_car();
    let at = |height: f64| {
        let mut high = car.clone();
        high.cg.z = height;
        high
    };
    let solve = |height: f64| {
        let high = at(height);
        let solved = CarSolver::new(&high).unwrap().solve(&at_rest());
        solved.map(|found| found.lifted)
    };
    let (mut low, mut high) = (car.cg.z, 60.0 * car.cg.z);
    assert!(solve(high).is_err());
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        match solve(middle) {
            Ok(lifted) => {
                assert_eq!(lifted, [false; 4]);
                low = middle;
            }
            Err(_) => high = middle,
        }
    }
    assert_eq!(solve(low * (1.0 + 1e-6)), Err(NoEquilibrium::Tips));
    let stiffness = |height: f64| {
        let high = at(height);
        let mut solver = CarSolver::new(&high).unwrap();
        value(&mut solver, &at_rest(), "body_roll_stiffness")
    };
    // Estimates the height of zero stiffness by a straight line through two values just below the limit.
    let [near, far] = [1e-5, 2e-5].map(|part| stiffness(low * (1.0 - part)));
    let root = low * (1.0 - 1e-5 + 1e-5 * near / (far - near));
    // The solver finds a state to 1e-10 or refuses it. At a relative distance p below the height of zero stiffness,
    // rounding is amplified by 1/p.
    assert!((root / low - 1.0).abs() < 1e-6, "{root} {low}");
    let at_design = stiffness(car.cg.z);
    assert!(near > 0.0 && near < 1e-4 * at_design, "{near} {at_design}");
}

/// Car with rockers whose front axle has only a heave bar. At rest, the bar carries the load of the springs that it replaces.
/// The axle has no roll stiffness.
fn without_front_roll_stiffness() -> Car {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/own/free_bodies.toml");
    let mut car = CarStudy::read(&path, &[]).unwrap().car;
    let mut solver = CarSolver::new(&car).unwrap();
    let rest = at_rest();
    let found = solver.solve(&rest).unwrap();
    let state = solver.balance(&rest, &found).unwrap();
    let wheel = &state.wheels[0];
    let [angle, by_travel] = wheel.corner.rocker.angle;
    let work = wheel.parts[0] * state.road.up.dot(wheel.contact_rate);
    // The heave bar acts as 60 N/mm at each wheel.
    let rate = 0.5 * 60.0 / (by_travel * by_travel);
    let setup = &mut car.axles[0].setup;
    (setup.springs, setup.bar_rate) = (None, None);
    setup.rocker_springs = RockerSprings {
        heave_bar: Some(Preloaded {
            load: work / by_travel - 2.0 * rate * angle,
            rate,
        }),
        ..RockerSprings::default()
    };
    car
}

/// Only the rear axle resists roll. When the inner rear wheel lifts, only one rear wheel and the middle of the front
/// axle support the body, so the body overturns. The limit of equilibrium is this lift, and the program reports
/// overturning.
#[test]
fn a_car_on_two_supports_tips_at_the_lift() {
    let car = without_front_roll_stiffness();
    let mut solver = CarSolver::new(&car).unwrap();
    let case = Case::along("turn", 90.0, &at_rest());
    let limits = solver.limits(&case).unwrap();
    let lift = limits.lift.unwrap();
    assert_eq!(lift.wheel.0, 2, "{lift:?}");
    assert!(lift.others_loaded, "{lift:?}");
    assert!((limits.end - lift.acceleration).abs() < 1e-5, "{limits:?}");
    let beyond = Case {
        ay: lift.acceleration + 1e-3,
        ..case
    };
    let lifted = [false, false, true, false];
    let why = solver.solve(&beyond).unwrap_err();
    assert_eq!(why, NoEquilibrium::TipsOver { lifted });
    let words =
        "the car tips over: the rear left wheel lifts, and the other wheels cannot hold the body";
    assert_eq!(why.describe(&car), words);
}

/// In steady cornering, first one inner wheel lifts, then the other inner wheel loses its load, and the car tips over its
/// outer wheels. Each sample car ends in this way, in both directions, with equal shares of the longitudinal force as
/// well. Moving the longitudinal force to the loaded wheels would not help, so the program does not recommend it.
#[test]
fn a_cornering_car_tips_over_its_outer_wheels() {
    for name in ["car.toml", "formula_student_car.toml"] {
        let path = crate::support::studies().join(name);
        let car = CarStudy::read(&path, &[]).unwrap().car;
        let mut solver = CarSolver::new(&car).unwrap();
        let mut rest = at_rest();
        rest.setting.elastic_tyres = car.tyres.is_some();
        for (degrees, left_lifts) in [(90.0, true), (270.0, false)] {
            let lifted = [left_lifts, !left_lifts, left_lifts, !left_lifts];
            let turn = Case::along("turn", degrees, &rest);
            let limits = solver.limits(&turn).unwrap();
            assert_eq!(
                limits.why,
                Some(NoEquilibrium::TipsOver { lifted }),
                "{name}"
            );
            let g = limits.end;
            let last = solver.solve(&Case {
                ay: turn.ay * (g - 1e-5),
                ..turn.clone()
            });
            let last = last.unwrap();
            let loads = &last.unknowns[7..11];
            let inner = (0..4).filter(|wheel| lifted[*wheel]);
            let most = loads.iter().copied().fold(0.0, larger);
            assert!(
                inner.clone().all(|wheel| loads[wheel] < 1e-2 * most),
                "{name} {loads:?}"
            );
            let mut beyond = turn.clone();
            beyond.ay *= g + 0.05;
            for shares in [LongitudinalShares::ByLoad, LongitudinalShares::Equal] {
                beyond.setting.longitudinal_shares = shares;
                let why = solver.solve(&beyond).unwrap_err();
                assert_eq!(why, NoEquilibrium::TipsOver { lifted }, "{name} {shares:?}");
            }
        }
    }
}

/// If the message recommends other shares of the forces, the case has an equilibrium with these shares.
#[test]
fn recommended_shares_give_an_equilibrium() {
    let path = crate::support::studies().join("car.toml");
    let study = CarStudy::read(&path, &[]).unwrap();
    let mut solver = CarSolver::new(&study.car).unwrap();
    let mut recommended = 0;
    for case in study
        .cases
        .iter()
        .filter(|case| case.ax != 0.0 || case.ay != 0.0)
    {
        let end = solver.limits(case).unwrap().end / case.ax.hypot(case.ay);
        for factor in [1.0 + 1e-4, 1.02, 1.1, 1.3] {
            let mut beyond = case.clone();
            beyond.ax *= factor * end;
            beyond.ay *= factor * end;
            if let Err(NoEquilibrium::NoContactSet {
                remedy: Some(_), ..
            }) = solver.solve(&beyond)
            {
                recommended += 1;
                beyond.setting.longitudinal_shares = LongitudinalShares::ByLoad;
                assert!(solver.solve(&beyond).is_ok(), "{} {factor}", case.name);
            }
        }
    }
    assert!(recommended > 0);
}

/// Anti-dive and anti-lift under strong braking make the stiffness matrix very unsymmetric: its symmetric part is not
/// positive definite. Still each wheel is loaded, and each wheel load changes smoothly. The program solves the car
/// until the rear wheels have no load, and not beyond.
#[test]
fn a_braking_car_is_solved_until_its_rear_wheels_lift() {
    let car = formula_student_car();
    let mut solver = CarSolver::new(&car).unwrap();
    let mut rest = Case::at_rest("rest");
    rest.setting.elastic_tyres = car.tyres.is_some();
    let braking = Case::along("braking", 180.0, &rest);
    let limits = solver.limits(&braking).unwrap();
    let at = |g: f64| Case {
        ax: -g,
        ..braking.clone()
    };
    println!("{limits:?}");
    assert_eq!(braking.setting.longitudinal, Longitudinal::Brake);
    let loads = |solver: &mut CarSolver<'_>, g: f64| {
        let found = solver.solve(&at(g)).unwrap();
        [found.unknowns[7], found.unknowns[9], found.unknowns[10]]
    };
    // Just below the end the rear wheels have almost no load.
    let [front, left, right] = loads(&mut solver, limits.end - 1e-5);
    assert!((left - right).abs() < 1e-6 * front);
    assert!(left > 0.0 && left < 1e-3 * front, "{left} {front}");
    assert_eq!(limits.why, Some(NoEquilibrium::AxleLifted { axle: 1 }));
    // The load falls steadily. At a turning point of the equilibrium path, the curve would be vertical.
    let steps = [0.12, 0.09, 0.06, 0.03].map(|less| loads(&mut solver, limits.end - less)[1]);
    let slopes: Vec<f64> = steps.windows(2).map(|pair| pair[0] - pair[1]).collect();
    for pair in slopes.windows(2) {
        assert!((pair[1] / pair[0] - 1.0).abs() < 0.1, "{slopes:?}");
    }
}

/// Springs act through links that fold. Such springs carry a car up to a certain vertical acceleration. Near this
/// limit, heave grows faster and faster, while roll hardly changes. So the reported reason is that the body sinks, not
/// that the car overturns.
#[test]
fn a_car_whose_links_fold_sinks() {
    let path = crate::support::studies().join("off_road_car.toml");
    let car = CarStudy::read(&path, &[]).unwrap().car;
    let mut solver = CarSolver::new(&car).unwrap();
    let at = |az: f64| Case { az, ..at_rest() };
    let heave = [0.5, 0.6, 0.7].map(|az| value(&mut solver, &at(az), "heave"));
    let [first, last] = [heave[1] - heave[0], heave[2] - heave[1]];
    assert!(last > 1.2 * first && first > 0.0, "{heave:?}");
    for az in [0.75, 0.9] {
        let why = solver.solve(&at(az)).unwrap_err();
        assert_eq!(why, NoEquilibrium::Sinks);
        let words = why.describe(&car);
        assert!(words.starts_with("the body sinks: "), "{words}");
    }
}

/// The error for a rack displacement beyond the limit states the limit with its unit. The limit has the sign of the
/// displacement, whichever wheel reaches it.
#[test]
fn an_unreachable_rack_has_its_sign_and_unit() {
    let path = crate::support::studies().join("car.toml");
    let car = CarStudy::read(&path, &[]).unwrap().car;
    let unreachable = |side: Side| {
        let limit = 40.0;
        let failure = Failure::RackUnreachable {
            limit: side.sign() * limit,
            cause: LimitCause::TieRodToggle,
        };
        let failure = NoPose::Wheel {
            side,
            travel: 0.0,
            failure,
        };
        NoEquilibrium::NoPose { axle: 0, failure }.describe(&car)
    };
    for side in Side::ALL {
        let words = unreachable(side);
        assert!(words.contains("no further than 40.000000 mm"), "{words}");
    }
}
