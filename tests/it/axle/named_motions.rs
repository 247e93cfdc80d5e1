//! Tests of `[motions.NAME]` of an axle: separate curves, and constraints on both wheels.

use super::commands::{folder, run, study as sample};
use super::tuning::study;
use super::with;
use crate::support::{larger, one_line};
use hardpoint::characteristics::Characteristic;
use hardpoint::optimise::Control;
use hardpoint::study::{Motion, Study, Vehicle, WheelStudy};

/// A motion in `[motions.NAME]` has the same curves as the same motion in `[motion]`. The test covers each kind of
/// motion.
#[test]
fn a_named_motion_has_the_curves_of_the_same_motion() {
    let given = study("macpherson_axle", &[]);
    for motion in [
        "{ heave = [-30.0, 0.0, 30.0] }",
        "{ roll = [-2.0, 0.0, 2.0], rack = [-10.0, 10.0] }",
        "{ travel_left = [-20.0, 20.0], travel_right = 5.0 }",
        "{ travel_left = 10.0, travel_right = -10.0, ground = \"plane\" }",
        "{ heave = 10.0, steering_wheel_angle = [-90.0, 0.0, 90.0] }",
    ] {
        let named = with(&given, &[&format!("motions.other={motion}")]).unwrap();
        assert_eq!(named.motion_names(), ["other"]);
        let own = with(&given, &[&format!("motion={motion}")]).unwrap();
        let found = named.in_motion("other").unwrap().curves().unwrap();
        assert_eq!(found, own.curves().unwrap(), "{motion}");
        assert_eq!(named.curves().unwrap(), given.curves().unwrap());
    }
    assert!(given.in_motion("other").is_none());
}

/// Largest half track change of one wheel along a motion of that wheel.
fn most(study: &Study, travels: [f64; 2]) -> f64 {
    let mut own = WheelStudy::of(study.wheel().clone());
    own.outputs.characteristics = vec![Characteristic::HalfTrackChange];
    own.motion = Motion::travel(travels[0]..=travels[1], 4001).unwrap();
    let alone = Study {
        vehicle: Vehicle::Wheel(Box::new(own)),
        optimise: None,
        ..study.clone()
    };
    let curves = alone.curves().unwrap();
    let values = curves.stations.iter().map(|s| s.values[0].unwrap());
    values.fold(f64::NEG_INFINITY, larger)
}

/// A limit over a motion of the axle applies to both wheels, each with its own travel. If `side` names a wheel, the
/// limit applies only to that wheel. The limit is active at one wheel at least.
#[test]
fn a_constraint_holds_at_both_wheels_or_at_one() {
    let given = study("macpherson_axle_front", &[]);
    let motion = "motions.turn={ travel_left = [-60.0, -20.0, 20.0, 60.0], travel_right = [-90.0, -45.0, 0.0, 45.0] }";
    let tuned = |side: &str| {
        let constraint = format!(
            "optimise.constraints=[{{ characteristic = \"half_track_change\", at_most = 0.5, motion = \"turn\"{side} }}]"
        );
        let study = with(&given, &[motion, &constraint, "optimise.starts=1"]).unwrap();
        let tuning = study.tune(Control::default()).unwrap();
        let best = tuning.best.unwrap();
        let margins: Vec<f64> = best.constraints.iter().map(|c| c.margin).collect();
        (study.at_design(best.design), margins)
    };
    let (both, margins) = tuned("");
    assert_eq!(margins.len(), 2);
    let (left, right) = (most(&both, [-60.0, 60.0]), most(&both, [-90.0, 45.0]));
    for (margin, most) in margins.iter().zip([left, right]) {
        assert!((0.5 - most - margin).abs() < 1e-5, "{margin} {most}");
    }
    assert!(margins.iter().all(|margin| *margin > -1e-6), "{margins:?}");
    assert!(margins.iter().any(|margin| *margin < 1e-5), "{margins:?}");
    let (one, margins) = tuned(", side = \"left\"");
    assert_eq!(margins.len(), 1);
    assert!(most(&one, [-60.0, 60.0]) < 0.5 + 1e-5);
}

/// The right wheel, seen as a left wheel, has the opposite rack displacement. So a limit on the steer angle of both
/// wheels at rack +x limits the left wheel at rack +x and at rack -x.
#[test]
fn the_right_wheel_steers_the_other_way() {
    let given = study("macpherson_axle_front", &[]);
    let constraint =
        "optimise.constraints=[{ characteristic = \"toe\", at_most = 90.0, motion = \"lock\" }]";
    let study = with(
        &given,
        &["motions.lock={ heave = 0.0, rack = 30.0 }", constraint],
    )
    .unwrap();
    let constraints = &study.optimise.as_ref().unwrap().constraints;
    let racks = constraints
        .iter()
        .map(|c| c.site.as_ref().unwrap().racks.clone());
    assert_eq!(racks.collect::<Vec<_>>(), [[30.0], [-30.0]]);
    let names: Vec<&str> = constraints.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(
        names,
        ["toe at most 90, left wheel", "toe at most 90, right wheel"]
    );
}

#[test]
fn motions_that_do_not_fit_are_refused() {
    let given = study("macpherson_axle_front", &[]);
    let limit = |rest: &str| {
        format!(
            "optimise.constraints=[{{ characteristic = \"toe\", at_most = 1.0, motion = \"m\"{rest} }}]"
        )
    };
    let refused = |edits: &[&str], said: &str| {
        let error = with(&given, edits).unwrap_err();
        assert!(error.contains(said), "{error}");
    };
    refused(
        &["motions.m={ heave = 1.0, travel = 2.0 }"],
        "travel drives one wheel only",
    );
    refused(
        &["motions.m={ roll = 1.0, travel_left = 2.0 }"],
        "roll keeps the mean travel constant",
    );
    refused(
        &["motions.m={ roll = [0.0, 1.0] }", &limit("")],
        "on a plane ground the travels of the wheels follow from the design",
    );
    refused(
        &["motions.m={ heave = 1.0 }", &limit(", rack = 3.0")],
        "remove the key \"rack\"",
    );
    refused(
        &["motions.m={ travel = 1.0 }", &limit(", side = \"right\"")],
        "the motion m moves the left wheel alone",
    );
    refused(
        &["motions.m={ heave = 1.0 }", &limit(", side = \"both\"")],
        "side",
    );
    let own = "axle.right={ hardpoints = { tie_rod_outer = [-130.0, -688.0, 240.0] } }";
    refused(
        &[own, "motions.m={ heave = 1.0 }", &limit("")],
        "the right wheel has different dimensions",
    );
}

/// A quantity may be unavailable in one motion: without steering there is no Ackermann percentage. This is no error if
/// another motion has the quantity. If no motion has it, the exit code is 1 with the reason.
#[test]
fn a_value_of_another_motion_is_enough() {
    let path = sample("double_wishbone_axle.toml");
    let path = path.to_str().unwrap();
    let out = folder("a_value_of_another_motion");
    let steer = "{ heave = 0.0, steering_wheel_angle = [-60.0, 0.0, 60.0] }";
    let heave = "{ heave = [-10.0, 0.0, 10.0] }";
    let said = |motion: &str, named: &str, code: i32| {
        let sets = [
            "outputs.characteristics=[\"ackermann\"]".to_owned(),
            format!("motion={motion}"),
            format!("motions.other={named}"),
        ];
        let sets = sets.iter().flat_map(|set| ["--set", set]);
        let sets: Vec<&str> = sets.collect();
        let directory = ["--out", out.to_str().unwrap(), "--force"];
        let solved = run(&[&["solve", path][..], &directory, &sets].concat(), code);
        let checked = run(&[&["check", path][..], &sets].concat(), code);
        [solved, checked].map(|(said, errors)| one_line(&(said + &errors)))
    };
    for said in said(heave, steer, 0) {
        assert!(
            said.contains("ackermann_percent has no value in this motion: not defined near"),
            "{said}"
        );
        assert!(
            said.contains("motion other: ackermann_percent has no value at 1 station"),
            "{said}"
        );
        assert!(!said.contains("warning: ackermann"), "{said}");
    }
    for said in said(steer, heave, 0) {
        assert!(
            said.contains("motion other: ackermann_percent has no value in this motion"),
            "{said}"
        );
    }
    for said in said(heave, heave, 1) {
        let warning = "ackermann_percent has no value at any station: not defined near";
        assert!(said.contains(&format!("warning: {warning}")), "{said}");
        assert!(
            said.contains(&format!("warning: motion other: {warning}")),
            "{said}"
        );
    }
}
