//! Tests of certificates of axles: the bounds contain the 60-digit reference values, and the certifier never certifies
//! a false pose.

use super::reference::{names, placement, read};
use super::{axle, sample};
use hardpoint::axle::{AxleCertifier, AxlePose, AxleSolver, Hold, Placement, axle_curves};
use hardpoint::mechanism::Configuration;
use hardpoint::model::Side;
use hardpoint::number::{Interval, Jet, Vector3};
use hardpoint::study::Study;
use serde_json::Value;

fn study(name: &str, overrides: &[&str]) -> Study {
    sample(name, overrides).unwrap_or_else(|e| panic!("{e}"))
}

/// Positions of the wheel centres, each in the solver's frame of its side.
fn centres(both: &hardpoint::axle::Axle, placed: &AxlePose) -> [Vector3<f64>; 2] {
    [Side::Left, Side::Right].map(|side| {
        let suspension = both.suspension(side);
        let at = Configuration {
            mechanism: &suspension.mechanism,
            design: &suspension.design,
            pose: placed.poses()[side as usize],
            rack: 0.0,
            steering: None,
        };
        at.point(suspension.mechanism.wheel_centre)
    })
}

/// The certified bounds contain travels, roll angle and wheel centres of every reference state. The bounds are hardly
/// wider than the rounding error.
#[test]
fn the_answers_at_sixty_digits_lie_within_the_proof() {
    for name in ["macpherson_front", "double_wishbone_front"] {
        let case = read(name);
        let both = axle(&case);
        let mut solver = AxleSolver::<2>::new(&both, &[], false).unwrap();
        let certifier = AxleCertifier::new(&both);
        let names = names(&case, "values");
        let states = case["states"].as_array().unwrap();
        assert!(states.len() >= 13, "{name}");
        for state in states {
            let label = state["motion"].to_string();
            let placement = placement(&state["motion"]);
            let placed = solver.place(&placement).expect(&label);
            let proof = certifier.prove(&placement, &placed).expect(&label);
            let expected = |name: &str| -> f64 {
                let index = names.iter().position(|n| *n == name).expect(name);
                let text: &Value = &state["values"][index];
                text.as_str().unwrap().parse().unwrap()
            };
            // Reading a reference value as a double rounds it once.
            let rounding = |value: f64| f64::EPSILON * value.abs();
            let found = centres(&both, &placed);
            for (i, side) in ["left", "right"].into_iter().enumerate() {
                let travel = expected(&format!("travel_{side}"));
                let error = (placed.travels[i] - travel).abs();
                assert!(
                    error <= proof.travel_error + rounding(travel),
                    "{label}: {proof:?}"
                );
                // The solver's frame of the right wheel is mirrored, so y changes its sign.
                let sign = [1.0, -1.0][i];
                let centre = Vector3::new(
                    expected(&format!("wheel_centre_x_{side}")),
                    sign * expected(&format!("wheel_centre_y_{side}")),
                    expected(&format!("wheel_centre_z_{side}")),
                );
                let error = (found[i] - centre).norm();
                let bound = proof.position_errors[i] + rounding(centre.norm());
                assert!(error <= bound, "{label} {side}: {error:e} {proof:?}");
            }
            let roll = expected("roll_angle");
            // A roll angle in degrees is rounded when it is converted to radians.
            let bound = proof.roll_error + 2.0 * rounding(roll);
            assert!((placed.roll - roll).abs() <= bound, "{label}: {proof:?}");
            let sharp = proof.position_errors.into_iter().all(|e| e < 1e-10);
            assert!(sharp && proof.travel_error < 1e-10, "{label}: {proof:?}");
            assert!(
                proof.roll_error < 1e-13 && proof.uniqueness > 0.1,
                "{label}: {proof:?}"
            );
        }
    }
}

/// The certifier certifies every station of the samples: in roll, on pads, and with both travels on a plane.
#[test]
fn every_station_of_the_samples_is_proved() {
    let samples = [
        ("macpherson_axle", &[][..]),
        ("five_link_axle", &[][..]),
        ("macpherson_axle", &TRAVELS[..]),
        ("macpherson_axle", &TRAVELS[..2]),
    ];
    for (name, overrides) in samples {
        let mut overrides = overrides.to_vec();
        overrides.push("outputs.certify=true");
        let both = study(name, &overrides).axle().unwrap().clone();
        let curves = axle_curves(&both.axle, &both.plan).unwrap().curves;
        assert!(curves.stations.len() >= 12, "{name}");
        for station in &curves.stations {
            let proof = station.proof.as_ref();
            let proof = proof.unwrap_or_else(|| panic!("{:?}", station.status));
            let [errors @ .., uniqueness] = &proof.bounds[..] else {
                panic!("{proof:?}");
            };
            assert!(
                errors.iter().all(|e| *e < 1e-9) && errors.len() == curves.bounds.len() - 1,
                "{proof:?}"
            );
            assert!(
                proof.position_error == errors[0].max(errors[1]) && *uniqueness > 0.1,
                "{proof:?}"
            );
        }
    }
}

const TRAVELS: [&str; 3] = [
    "motion={travel_left=[-30.0, 0.0, 40.0], travel_right=[-20.0, 30.0], rack=[0.0, 25.0]}",
    "outputs.characteristics=[\"camber\", \"toe\"]",
    "motion.ground=\"plane\"",
];

/// If a travel is wrong by a nanometre, the certified error is at least a nanometre. The same applies to a wrong roll
/// angle.
#[test]
fn a_false_root_is_not_proved_to_be_near() {
    let both = study("macpherson_axle", &[]).axle().unwrap().clone().axle;
    let mut solver = AxleSolver::<2>::new(&both, &[], false).unwrap();
    let certifier = AxleCertifier::new(&both);
    let (heave, roll, rack) = (12.0, 0.04, 7.0);
    let wanted = Placement::Roll { heave, roll, rack };
    let right = solver.place(&wanted).unwrap();
    let proof = certifier.prove(&wanted, &right).unwrap();
    assert!(proof.travel_error < 1e-10, "{proof:?}");
    for off in [1e-6, 1e-3] {
        let travels = [right.travels[0] + off, right.travels[1] - off];
        let on_plane = false;
        let mut planted = solver
            .place(&Placement::Travels {
                travels,
                rack,
                on_plane,
            })
            .unwrap();
        (planted.roll, planted.hold) = (roll, Hold::MeanTravel);
        let proof = certifier.prove(&wanted, &planted).unwrap();
        assert!(proof.travel_error >= off, "{off}: {proof:?}");
        assert!(proof.travel_error < 1.1 * off, "{off}: {proof:?}");
        // The certified position errors of the carriers are at least 0.9 times `off`.
        assert!(proof.position_errors.into_iter().all(|e| e >= 0.9 * off));
    }
    // If the stated travels are 1e-6 mm away from those of the poses, the certified error is at least this large.
    let mut planted = right;
    planted.travels = [right.travels[0] + 1e-6, right.travels[1] - 1e-6];
    let proof = certifier.prove(&wanted, &planted).unwrap();
    assert!(proof.travel_error >= 1e-6, "{proof:?}");
    // Travels that are 300 mm away cannot be certified.
    planted.travels = [right.travels[0] + 300.0, right.travels[1] - 300.0];
    assert!(
        certifier
            .prove(&wanted, &planted)
            .unwrap_err()
            .is_unproven()
    );

    let wanted = Placement::Travels {
        travels: right.travels,
        rack,
        on_plane: true,
    };
    let mut tilted = solver.place(&wanted).unwrap();
    let proof = certifier.prove(&wanted, &tilted).unwrap();
    assert!(
        proof.roll_error < 1e-13 && proof.travel_error == 0.0,
        "{proof:?}"
    );
    assert!((tilted.roll - roll).abs() < 1e-13);
    tilted.roll += 1e-9;
    let proof = certifier.prove(&wanted, &tilted).unwrap();
    assert!(
        proof.roll_error >= 1e-9 && proof.roll_error < 1.1e-9,
        "{proof:?}"
    );
}

/// The enclosure of poses over an interval of travel contains the solved poses. The enclosure of the derivative
/// contains the derivative of the Taylor series.
#[test]
fn poses_over_an_interval_of_travel_are_enclosed() {
    let both = study("five_link_axle", &[]).axle().unwrap().clone().axle;
    let mut solver = AxleSolver::<2>::new(&both, &[], false).unwrap();
    let certifier = AxleCertifier::new(&both);
    let mut at = |travel: f64| {
        let placement = Placement::Travels {
            travels: [travel; 2],
            rack: 0.0,
            on_plane: false,
        };
        let placed = solver.place(&placement).unwrap();
        (
            placed.poses()[0],
            solver.read(&placed).unwrap().state.readings[0],
        )
    };
    let (middle, reach) = (15.0, 2.0);
    let interval = Interval::bounds(middle - reach, middle + reach);
    let inclusion = certifier
        .wheel(Side::Left)
        .over_travels(&at(middle).0, interval, 0.0)
        .unwrap();
    // The slack covers the error of the solver, and for slopes the error of the finite differences.
    let holds = |enclosed: Interval, value: f64, slack: f64| {
        assert!(enclosed.low - slack <= value && value <= enclosed.high + slack);
        assert!(enclosed.high - enclosed.low < 10.0 * reach);
    };
    for k in -4..=4 {
        let travel = middle + 0.25 * reach * f64::from(k);
        let (pose, _) = at(travel);
        // This test computes slopes from finite differences of fourth order.
        let step = 0.05;
        let around = [-2.0, -1.0, 1.0, 2.0].map(|n| at(travel + n * step).0);
        let rate = |number: &dyn Fn(&hardpoint::mechanism::Pose<f64>) -> f64| {
            let [a, b, c, d] = around.each_ref().map(number);
            (a - 8.0 * b + 8.0 * c - d) / (12.0 * step)
        };
        let check = |enclosed: Jet<Interval, 2>,
                     number: &dyn Fn(&hardpoint::mechanism::Pose<f64>) -> f64| {
            holds(enclosed[0], number(&pose), 1e-9);
            holds(enclosed[1], rate(number), 1e-8);
        };
        check(inclusion.pose.origin.x, &|p| p.origin.x);
        check(inclusion.pose.origin.y, &|p| p.origin.y);
        check(inclusion.pose.origin.z, &|p| p.origin.z);
        for i in 0..3 {
            check(inclusion.pose.rotation.columns[i].x, &move |p| {
                p.rotation.columns[i].x
            });
            check(inclusion.pose.rotation.columns[i].z, &move |p| {
                p.rotation.columns[i].z
            });
        }
    }
}
