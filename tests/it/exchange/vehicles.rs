//! Tests of invented vehicles of Project Chrono.

use super::{Said, car_of, file, imported, study};
use hardpoint::exchange::{CAR_FILES, ImportedCar};
use hardpoint::model::AxlePosition;
use hardpoint::number::Vector3;
use hardpoint::study::CarStudy;
use std::path::Path;

/// Invented double wishbone suspension of Project Chrono.
const WISHBONES: &str = r#"{ "Type": "Suspension", "Template": "DoubleWishbone",
"Spindle": { "Mass": 1.5, "COM": [0.0, 0.8, 0.02] },
"Upright": { "Mass": 2.5 },
"Upper Control Arm": { "Location Chassis Front": [0.06, 0.44, 0.2], "Location Chassis Back": [-0.19, 0.45, 0.19],
  "Location Upright": [-0.03, 0.68, 0.21] },
"Lower Control Arm": { "Location Chassis Front": [0.21, 0.31, -0.09], "Location Chassis Back": [-0.2, 0.32, -0.08],
  "Location Upright": [-0.01, 0.74, -0.12] },
"Tierod": { "Location Chassis": [-0.21, 0.39, -0.02], "Location Upright": [-0.16, 0.73, -0.03] },
"Spring": { "Location Chassis": [0.05, 0.47, 0.31], "Location Arm": [0.05, 0.56, -0.09], "Free Length": 0.5,
  "Spring Coefficient": 50000.0 } }"#;

/// The import writes the spring of a single suspension into the study of an axle. In the study of a single wheel, it
/// lists the spring as left out.
#[test]
fn springs_of_single_suspensions_are_not_lost() {
    let directory = tempfile::tempdir().unwrap();
    let path = file(&directory, "wishbones.json", WISHBONES.as_bytes());
    let wheel = imported(&path, "double_wishbone", &Said::default()).unwrap();
    let said = wheel.left_out.join("\n");
    assert!(said.contains("Spring: rate 50000.0 N/m"), "{said}");
    let car = car_of(&vehicle(directory.path(), VEHICLE), None).unwrap();
    for axle in &car.axles {
        assert!(
            axle.left_out
                .iter()
                .all(|line| !line.contains("Spring: rate"))
        );
    }
}

/// Vehicle with these wishbones at both axles. The rear axle is the first axle in the file.
const VEHICLE: &str = r#"{ "Type": "Vehicle", "Template": "WheeledVehicle",
"Chassis": { "Input File": "made/chassis.json" },
"Axles": [
  { "Suspension Input File": "made/wishbones.json", "Suspension Location": [-1.25, 0, 0.5],
    "Left Wheel Input File": "made/wheel.json" },
  { "Suspension Input File": "made/wishbones.json", "Suspension Location": [1.5, 0, 0.25],
    "Left Wheel Input File": "made/wheel.json" } ] }"#;

const CHASSIS: &str = r#"{ "Components": [
  { "Mass": 1000.0, "Centroidal Frame": { "Location": [0.25, 0, 0.5] }, "Void": false },
  { "Mass": 200.0, "Centroidal Frame": { "Location": [0.25, 0, 1.0] }, "Void": true } ] }"#;

fn vehicle(directory: &Path, vehicle: &str) -> std::path::PathBuf {
    let made = directory.join("data/made");
    std::fs::create_dir_all(made.join("vehicle")).unwrap();
    std::fs::write(made.join("wishbones.json"), WISHBONES).unwrap();
    std::fs::write(made.join("wheel.json"), r#"{ "Mass": 16.0 }"#).unwrap();
    std::fs::write(made.join("chassis.json"), CHASSIS).unwrap();
    let path = made.join("vehicle/car.json");
    std::fs::write(&path, vehicle).unwrap();
    path
}

/// Writes the files of a car, and reads them again.
fn kept(directory: &Path, car: &ImportedCar) -> CarStudy {
    for (name, text) in CAR_FILES.iter().zip(&car.files) {
        std::fs::write(directory.join(name), text).unwrap();
    }
    CarStudy::read(&directory.join(CAR_FILES[0]), &[]).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn a_vehicle_of_chrono_is_a_car_that_is_solved() {
    let directory = tempfile::tempdir().unwrap();
    let path = vehicle(directory.path(), VEHICLE);
    let car = car_of(&path, Some(0.31)).unwrap();
    assert_eq!(car.missing, Vec::<String>::new());
    let study = kept(directory.path(), &car);
    // The axle farther forward is the front axle. A point is the point of the file plus the position of the axle.
    let at = |axle: usize, name: &str| {
        let suspension = study.axles[axle].wheel();
        let place = suspension.design[suspension.mechanism.point(name).unwrap().0];
        suspension.frame.vector(place).to_array()
    };
    for (axle, [x, z]) in [[1.5, 0.25], [-1.25, 0.5]].into_iter().enumerate() {
        assert_eq!(at(axle, "wheel_centre"), [0.0 + x, 0.8, 0.02 + z]);
        assert_eq!(at(axle, "upper_arm_rear"), [-0.19 + x, 0.45, 0.19 + z]);
        let setup = &study.axles[axle].axle().unwrap().axle.setup;
        // Mass of two wheels, each with spindle, upright and wheel.
        assert_eq!(setup.unsprung_mass, Some(2.0 * (1.5 + 2.5 + 16.0)));
    }
    // The spring is 0.41 m long, the hypotenuse of 0.09 and 0.4.
    let force = 50000.0 * (0.5 - f64::hypot(0.09, 0.4));
    assert!(car.files[1].contains("rate = 50000.0"), "{}", car.files[1]);
    let line = car.files[1]
        .lines()
        .find(|line| line.starts_with("force = "))
        .unwrap();
    let written: f64 = line.split_whitespace().nth(2).unwrap().parse().unwrap();
    assert!((written - force).abs() < 1e-9 * force, "{line}");
    // The import subtracts the mass of a hole. Height of the centre of gravity: 1000 kg at 0.5 m minus 200 kg at 1 m,
    // divided by 800 kg.
    assert_eq!(study.car.mass, 800.0);
    assert!((study.car.cg - Vector3::new(0.25, 0.0, 0.375)).norm() < 1e-15);
    assert_eq!(study.car.rear_offset, Vector3::new(0.0, 0.0, 0.0));
    // Without a radius the import lists what the car still needs.
    let lacking = car_of(&path, None).unwrap().missing;
    assert!(
        lacking.iter().all(|line| line.contains("--radius")) && lacking.len() == 2,
        "{lacking:?}"
    );
}

/// The import can read a single axle of the same vehicle. It refuses vehicles that are not cars with two axles.
#[test]
fn vehicles_that_are_no_cars_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    let path = vehicle(directory.path(), VEHICLE);
    let said = Said {
        axle: Some(AxlePosition::Rear),
        ..Said::default()
    };
    let rear = imported(&path, "double_wishbone", &said).unwrap();
    study(&rear.study("rear", "there").unwrap());
    let axles =
        r#"{ "Suspension Input File": "made/wishbones.json", "Suspension Location": [0, 0, 0] },"#;
    for (from, to, expected) in [
        (
            "\"Axles\": [",
            &*format!("\"Axles\": [ {axles}"),
            "the vehicle has 3 axles",
        ),
        (
            "made/wishbones.json",
            "made/none.json",
            "is not in a folder above the vehicle",
        ),
        (
            "made/wishbones.json",
            "../wishbones.json",
            "is outside the folder of the vehicle",
        ),
        (
            "made/wishbones.json",
            "/etc/passwd",
            "is outside the folder of the vehicle",
        ),
        (
            "[-1.25, 0, 0.5]",
            "[-1.25, 0.1, 0.5]",
            "from the centre plane",
        ),
        (
            "made/wishbones.json",
            "made/wheel.json",
            "is not a suspension of Project Chrono",
        ),
        ("\"Axles\"", "\"Track Assemblies\"", "without Axles"),
    ] {
        let path = vehicle(directory.path(), &VEHICLE.replacen(from, to, 1));
        let refused = car_of(&path, None).unwrap_err();
        assert!(refused.contains(expected), "{expected}: {refused}");
    }
}
