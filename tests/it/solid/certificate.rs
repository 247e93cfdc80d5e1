//! Tests of certificates of solid axles: certified bounds contain reference values of 90 digits, and the certifier never
//! certifies a false pose.

use super::{STILL, axle, case, study_of};
use crate::support::number;
use hardpoint::axle::{AxleCertifier, AxleSolver, Placement, axle_curves};

const CASES: [&str; 2] = ["solid_four_link", "solid_three_link_panhard"];

/// The certified bounds contain the midpoint of both wheel centres of every reference state. The bounds are close to the
/// rounding error.
#[test]
fn the_answers_at_ninety_digits_lie_within_the_proof() {
    let mut proved = 0;
    for name in CASES {
        let case = case(name);
        let study = axle(&study_of(&case, STILL));
        let mut solver = AxleSolver::<2>::new(&study.axle, &[], false).unwrap();
        let certifier = AxleCertifier::new(&study.axle);
        let names = case["names"].as_array().unwrap();
        let lateral = names.iter().position(|n| n == "axle_lateral").unwrap();
        for state in case["states"].as_array().unwrap() {
            let placement = Placement::Roll {
                heave: state["heave"].as_f64().unwrap(),
                roll: state["roll_deg"].as_f64().unwrap().to_radians(),
                rack: 0.0,
            };
            let placed = solver.place(&placement).unwrap();
            let proof = certifier.prove(&placement, &placed);
            let proof = proof.unwrap_or_else(|e| panic!("{name} {placement}: {e:?}"));
            let read = solver.read(&placed).unwrap();
            use hardpoint::axle::{AxleQuantity, Quantity};
            let found = Quantity::Axle(AxleQuantity::AxleLateral).evaluate(&read.state);
            let expected = number(&state["values"][lateral]);
            let [left, right] = proof.position_errors;
            let bound = 0.5 * (left + right) + 4.0 * f64::EPSILON * 800.0;
            assert!(
                (found - expected).abs() <= bound,
                "{name} {placement}: {found} {expected} {proof:?}"
            );
            assert!(
                left.max(right) < 1e-9 && proof.travel_error < 1e-9,
                "{proof:?}"
            );
            assert!(proof.uniqueness > 1e-6, "{proof:?}");
            proved += 1;
        }
    }
    assert!(proved > 4, "{proved}");
}

/// If a position is slightly wrong, the certificate has a bound that covers the deviation, or there is no certificate.
#[test]
fn positions_that_are_off_have_bounds_that_say_so() {
    for name in CASES {
        let study = axle(&study_of(&case(name), STILL));
        let mut solver = AxleSolver::<2>::new(&study.axle, &[], false).unwrap();
        let certifier = AxleCertifier::new(&study.axle);
        let at = |heave: f64, roll: f64| Placement::Roll {
            heave,
            roll,
            rack: 0.0,
        };
        let placed = solver.place(&at(10.0, 0.03)).unwrap();
        assert!(certifier.prove(&at(10.0, 0.03), &placed).is_ok(), "{name}");
        // Per radian of roll, half the difference of the travels changes by half the track, about 750 mm.
        for (other, least) in [(at(10.0, 0.030_000_1), 7e-5), (at(10.000_01, 0.03), 0.9e-5)] {
            let Ok(proof) = certifier.prove(&other, &placed) else {
                continue;
            };
            let [left, right] = proof.position_errors;
            let bound = proof.travel_error.max(left).max(right);
            assert!(bound > least, "{name} {other}: {proof:?}");
        }
        // A position with a large error has no certificate.
        assert!(certifier.prove(&at(10.0, 0.2), &placed).is_err(), "{name}");
    }
}

/// Curves with `certify` have a certificate at every station, in roll and at given travels.
#[test]
fn curves_are_proved() {
    for motion in [
        "[motion]\nroll = [-3.0, 0.0, 2.0]\nheave = [-20.0, 15.0]\n",
        "[motion]\nheave = [-30.0, 0.0, 30.0]\n",
        "[motion]\ntravel_left = [-20.0, 10.1]\ntravel_right = [0.3, 15.7]\nground = \"plane\"\n",
    ] {
        let further = format!("{motion}[outputs]\ncertify = true\ncharacteristics = [\"toe\"]\n");
        let study = axle(&study_of(&case("solid_four_link"), &further));
        let curves = axle_curves(&study.axle, &study.plan).unwrap().curves;
        assert!(curves.stations.len() >= 3, "{motion}");
        for station in &curves.stations {
            let proof = station.proof.as_ref();
            assert!(proof.is_some(), "{motion}: {:?}", station.status);
        }
    }
}
