//! Tests of the whole car against independent results and statics.

mod accepted;
mod commands;
mod comparison;
mod conflicts;
mod free_bodies;
mod limits;
mod maps;
mod mechanics;
mod mistakes;
mod moves;
mod page;
mod reference;
mod rest;
mod rigs;
mod second_order;
mod side_effects;
mod solid;
mod stability;
mod steered;
mod sweep;
mod textbook;
mod tolerance;
mod twist_beam;
mod units;
mod verdict;

use crate::support::random::Random;
use hardpoint::Unit;
use hardpoint::axle::{Axle, BumpStop, ForceCurve, Law, Setup, SpringLaw};
use hardpoint::car::{
    Air, AirForce, Car, CarQuantity, Case, LateralShares, Longitudinal, LongitudinalShares, Masses,
    Moves, PointMove, Tyre, TyreAxes,
};
use hardpoint::characteristics::Constants;
use hardpoint::model::{Axis, LengthUnit, MassUnit, PointId, Suspension};
use hardpoint::number::Vector3;
use hardpoint::study::{CarStudy, Study};
use hardpoint::tolerance::CarProblem;
use serde_json::Value;
use std::path::Path;

/// Number, stored as a number or as text.
pub fn number(value: &Value) -> f64 {
    match value {
        Value::String(text) => text.parse().unwrap_or(f64::NAN),
        other => other.as_f64().unwrap_or(f64::NAN),
    }
}

fn vector(value: &Value) -> Vector3<f64> {
    Vector3::from([0, 1, 2].map(|k| number(&value[k])))
}

/// Left wheel of an axle of `tests/data/reference/car`, as a study would define it.
fn suspension(axle: &Value) -> Suspension {
    let mut text = format!("[suspension]\ntopology = {}\n", axle["type"]);
    text += "[suspension.hardpoints]\n";
    for (name, point) in axle["points"].as_object().unwrap() {
        text += &format!("{name} = {point}\n");
    }
    text += "[suspension.bodies]\n";
    for (name, body) in axle["on"].as_object().into_iter().flatten() {
        text += &format!("{name} = {body}\n");
    }
    text += &format!("[wheel]\nradius = {}\n", axle["radius"]);
    for key in ["static_camber", "static_toe"] {
        if !axle[key].is_null() {
            text += &format!("{key} = {}\n", axle[key]);
        }
    }
    let torque = |path: &Value| match path.as_str() {
        Some("shafts") => "shafts",
        _ => "carrier",
    };
    let brakes = axle["brakes"].as_str().unwrap();
    text += &format!(
        "[vehicle]\nbrakes = {brakes:?}\ndrive_torque = {:?}\n",
        torque(&axle["drive_torque"])
    );
    text += "[motion]\ntravel = 0.0\n";
    let study = Study::from_text("case.toml", &text, Path::new("."));
    study.unwrap_or_else(|e| panic!("{e:?}")).into_wheel()
}

fn stop(value: &Value) -> Option<BumpStop> {
    let points: Vec<[f64; 2]> = value["curve"]
        .as_array()?
        .iter()
        .map(|point| [number(&point[0]), number(&point[1])])
        .collect();
    Some(BumpStop {
        gap: number(&value["gap"]),
        curve: ForceCurve::through(&points).unwrap(),
    })
}

fn axle(value: &Value) -> Axle {
    let left = suspension(value);
    let spring = SpringLaw {
        spring: Law::Linear {
            force: number(&value["spring"]["force"]),
            rate: number(&value["spring"]["rate"]),
        },
        bump_stop: stop(&value["bump_stop"]),
        rebound_stop: stop(&value["rebound_stop"]),
        own_length: None,
    };
    let setup = Setup {
        wheel_radius: left.wheel_radius,
        springs: Some([spring.clone(), spring]),
        bar_rate: value["bar"]["rate"].as_f64(),
        // The reference gives the mass of one wheel.
        unsprung_mass: value["unsprung_mass"].as_f64().map(|mass| 2.0 * mass),
        constants: Constants::of(&left),
        per_metre: 1000.0,
        ..Setup::default()
    };
    Axle {
        left,
        right: None,
        setup,
        elastic: None,
    }
}

fn air_force(value: &Value, area: &str) -> Option<AirForce> {
    let area = value[area].as_array()?;
    Some(AirForce {
        point: vector(&value["point"]),
        area: std::array::from_fn(|k| number(&area[k])),
    })
}

/// The car of a reference file.
pub fn car(file: &Value) -> Car {
    let body = &file["body"];
    let aero = &file["aero"];
    let tyre = |axle: &str| Tyre {
        rate: number(&file[axle]["tyre"]["rate"]),
        load: Some(number(&file[axle]["tyre"]["load"])),
    };
    Car {
        axles: [axle(&file["front"]), axle(&file["rear"])],
        rear_offset: vector(&file["rear"]["offset"]),
        masses: Masses::Sprung,
        mass: number(&body["sprung_mass"]),
        mass_unit: MassUnit::Kilogram,
        cg: vector(&body["sprung_cg"]),
        brake_share_front: body["brake_share_front"].as_f64(),
        drive_share_front: body["drive_share_front"].as_f64(),
        yaw_inertia: body["yaw_inertia"].as_f64(),
        pitch_inertia: body["pitch_inertia"].as_f64(),
        ride_height_points: ["ride_height_front", "ride_height_rear"]
            .map(|p| Some(vector(&body[p]))),
        tyres: Some([tyre("front"), tyre("rear")]),
        air: Some(Air {
            density: number(&aero["density"]),
            downforce: [
                air_force(&aero["front"], "cla"),
                air_force(&aero["rear"], "cla"),
            ],
            drag: air_force(&aero["drag"], "cda"),
        }),
        length_unit: LengthUnit::Millimetre,
    }
}

/// The load case of a reference state.
pub fn case(value: &Value) -> Case {
    let figure = |key: &str| value[key].as_f64().unwrap_or(0.0);
    let mut case = Case::at_rest(value["name"].as_str().unwrap());
    (case.ax, case.ay, case.az) = (figure("ax"), figure("ay"), figure("az"));
    case.speed = figure("speed");
    case.yaw_acceleration = figure("yaw_acceleration");
    case.racks = [figure("rack"), 0.0];
    let setting = &mut case.setting;
    setting.elastic_tyres = value["tyres"] == "elastic";
    if case.ax < 0.0 {
        setting.longitudinal = Longitudinal::Brake;
    }
    setting.lateral_shares = match &value["lateral_shares"] {
        Value::Array(shares) => LateralShares::Left([number(&shares[0][0]), number(&shares[1][0])]),
        shares if shares == "equal" => LateralShares::Equal,
        _ => LateralShares::ByLoad,
    };
    if value["longitudinal_shares"] == "by_load" {
        setting.longitudinal_shares = LongitudinalShares::ByLoad;
    }
    if value["tyre_axes"] == "road" {
        setting.tyre_axes = TyreAxes::Road;
    }
    case
}

/// Random load case on rigid tyres. `most` has the largest longitudinal and lateral acceleration and the largest rack
/// displacement.
fn random_case(random: &mut Random, most: [f64; 3]) -> Case {
    let mut case = Case::at_rest("random");
    case.setting.elastic_tyres = false;
    (case.ax, case.ay) = (most[0] * random.signed(), most[1] * random.signed());
    case.az = 0.1 * random.signed();
    case.racks[0] = most[2] * random.signed();
    if case.ax < 0.0 {
        case.setting.longitudinal = Longitudinal::Brake;
    }
    case
}

/// Usual size of a result in its printed unit: forces and torques are thousands, other results are about 1.
fn usual_size(quantity: CarQuantity) -> f64 {
    match quantity.info().unit {
        Unit::Force | Unit::Torque | Unit::TorquePerAngle => 1e3,
        _ => 1.0,
    }
}

/// Asserts that the first-order standard deviations of the results equal slopes of the results. Central differences between
/// two built cars give the slopes. `study` adds a law of scatter for the part to the study. More than `least` results scatter.
fn assert_scatter_is_slope(part: &str, study: impl Fn(&str) -> CarStudy, least: usize) {
    let h = 0.05;
    let values = [-h, h].map(|step| {
        let [low, high] = [step - 1e-12, step + 1e-12];
        let study = study(&format!("limits = [{low:?}, {high:?}]"));
        let problem = problem(&study);
        let car = problem.built(0).unwrap();
        let mut values = vec![0.0; problem.request.results.len()];
        assert_eq!(problem.request.values(&car, &mut values).unwrap(), None);
        values
    });
    let study = study("sigma = 1.0");
    let problem = problem(&study);
    let expansion = problem.expansion().unwrap_or_else(|_| panic!("expands"));
    let mut scatter = 0;
    for (place, expansion) in expansion.iter().enumerate() {
        let slope = (values[1][place] - values[0][place]) / (2.0 * h);
        let sigma = expansion.sigma();
        let error = (sigma - slope.abs()).abs();
        let result = &problem.request.results[place];
        // Error of central differences, plus rounding errors.
        let rounding = 1e-9 * usual_size(result.quantity);
        assert!(
            error < 1e-4 * sigma + rounding,
            "{part}, {result:?}: {sigma} {slope}"
        );
        scatter += usize::from(sigma > 1e-4);
    }
    assert!(scatter > least, "{part}: {scatter}");
}

/// A variable that moves one coordinate of a hardpoint.
fn one_point(axle: usize, point: PointId, axis: Axis) -> Moves {
    Moves::Hardpoints(vec![PointMove {
        axle,
        point,
        axis,
        factor: 1.0,
    }])
}

/// Reference of a car with strut front and five-link rear axle, solved at 90 digits.
pub fn reference() -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/reference/car/road_car.json");
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

/// Car of the sample study `formula_student_car.toml`.
fn formula_student_car() -> Car {
    let path = crate::support::studies().join("formula_student_car.toml");
    CarStudy::read(&path, &[]).unwrap().car
}

/// Tolerance analysis of a car.
fn problem(study: &CarStudy) -> CarProblem<'_> {
    CarProblem::of(study, study.tolerance.as_ref().unwrap())
        .unwrap_or_else(|(axle, _)| panic!("axle {axle}"))
}
