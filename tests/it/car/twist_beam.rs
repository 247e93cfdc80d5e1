//! Tests of twist beams in cars.

use hardpoint::car::{AxleEnd, AxleResult, CarQuantity, CarSolver, WheelPlace, WheelResult};
use hardpoint::study::CarStudy;
use std::path::Path;

/// Torsional rate of the beam, N mm/rad.
const BEAM: f64 = 5.0e5;
/// Torsional rate of the front anti-roll bar, N mm/rad.
const BAR: f64 = 6.0e5;

/// The torque of a twist beam is a separate result from the torque of an anti-roll bar. The energy of the car is the
/// sum of the energies of springs, front bar and beam. The energy of the beam is T^2/(2 k), which confirms the
/// magnitude of the torque. The torque has the sign of the roll angle.
#[test]
fn the_beam_has_a_torque_and_no_bar() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/own/twist_beam_car.toml");
    let study = CarStudy::read(&path, &[]).unwrap();
    let car = &study.car;
    let (bar, beam) = (AxleResult::BarTorque, AxleResult::BeamTorque);
    let met = |end, result| CarQuantity::Axle(end, result).is_met_by(car);
    assert!(met(AxleEnd::Front, bar) && !met(AxleEnd::Front, beam));
    assert!(!met(AxleEnd::Rear, bar) && met(AxleEnd::Rear, beam));

    let mut solver = CarSolver::new(car).unwrap();
    for ay in [0.3, -0.2] {
        let mut case = study.cases[1].clone();
        case.ay = ay;
        let found = solver.solve(&case).unwrap();
        let solved = solver.solved(&case, &found).unwrap();
        let value = |quantity: CarQuantity| quantity.evaluate(&solved);
        let springs = WheelPlace::ALL.map(|place| {
            let of = |result| value(CarQuantity::Wheel(place, result));
            let (force, travel) = (of(WheelResult::SpringForce), of(WheelResult::SpringTravel));
            // The spring force grows linearly with the travel from the design position. The motion reaches no stops.
            let rate = [30.0, 28.0][place.0 / 2];
            (force - 0.5 * rate * travel) * travel
        });
        let torque = |end, result| value(CarQuantity::Axle(end, result));
        let (front, rear) = (torque(AxleEnd::Front, bar), torque(AxleEnd::Rear, beam));
        let twisted = 0.5 * (front * front / BAR + rear * rear / BEAM);
        let energy = value(CarQuantity::named("energy")[0]);
        let error = energy - springs.iter().sum::<f64>() - twisted;
        assert!(twisted > 0.01 * energy.abs(), "{twisted} {energy}");
        assert!(error.abs() < 1e-9 * energy.abs(), "{error} {energy}");
        let roll = value(CarQuantity::named("roll")[0]);
        assert!(rear * roll > 0.0 && roll * ay > 0.0, "{rear} {roll}");
    }
}

/// Scatter of the parts of a twist beam causes scatter of car results. The first-order standard deviations equal the
/// slopes of the results by central differences between built cars.
#[test]
fn parts_of_a_beam_scatter_in_a_car() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/own/twist_beam_car.toml");
    for part in [
        r#"hardpoint = "mount", axis = "x", side = "left""#,
        r#"hardpoint = "shear_centre", axis = "z""#,
        r#"hardpoint = "wheel_centre", axis = "z", side = "right""#,
    ] {
        let scattered = |law: &str| {
            let set = format!("tolerance.scatter=[{{ axle = \"rear\", {part}, {law} }}]");
            CarStudy::read(&path, &[set]).unwrap_or_else(|e| panic!("{}", e.render(false)))
        };
        super::assert_scatter_is_slope(part, scattered, 5);
    }
}
