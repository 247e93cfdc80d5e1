//! Tests of the import of axles and cars: solid axles, vehicles of Project Chrono, both axles of Assetto Corsa, and
//! bushings of Adams/Car.

use super::{Said, file, imported};
use hardpoint::exchange::{
    CAR_FILES, ImportOptions, ImportedCar, Outgoing, csv, import_car, point_rows, read_points,
    suspensions_ini, suspensions_ini_of_car,
};
use hardpoint::model::{AxlePosition, Frame, FrameConvention, LengthUnit, Side, Topology};
use hardpoint::number::Vector3;
use hardpoint::study::{CarStudy, Study};
use std::collections::BTreeMap;
use std::path::Path;

fn studies() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/studies"))
}

fn study(text: &str) -> Study {
    Study::elastic_from_text("s.toml", text, Path::new("."))
        .unwrap_or_else(|e| panic!("{e}\n{text}"))
}

fn car_of(path: &Path, radius: Option<f64>) -> Result<ImportedCar, String> {
    let table = read_points(path, None, None).map_err(|refusal| refusal.to_string())?;
    let none = BTreeMap::new();
    let options = |axle: AxlePosition| {
        let topology = table
            .topology(Some(axle))
            .map_err(|refusal| refusal.to_string())?;
        Ok::<_, String>(ImportOptions {
            topology,
            unit: None,
            frame: None,
            axes: None,
            side: None,
            axle: Some(axle),
            half_track: None,
            radius,
            bushings: false,
            names: &none,
            bodies: &none,
        })
    };
    let (front, rear) = (options(AxlePosition::Front)?, options(AxlePosition::Rear)?);
    import_car(&table, [&front, &rear], "there").map_err(|refusal| refusal.to_string())
}

/// Writes the files of a car, and reads them again.
fn kept(directory: &Path, car: &ImportedCar) -> CarStudy {
    for (name, text) in CAR_FILES.iter().zip(&car.files) {
        std::fs::write(directory.join(name), text).unwrap();
    }
    CarStudy::read(&directory.join(CAR_FILES[0]), &[]).unwrap_or_else(|e| panic!("{e}"))
}

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

/// The import refuses two upper links together with a Panhard rod: these five links overconstrain a rigid axle. A
/// single upper link keeps its actual y, because it has no mirror image.
#[test]
fn five_links_of_a_solid_axle_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(studies().join("solid_axle_five_links.toml")).unwrap();
    let five = Study::elastic_from_text("five", &text, Path::new(""));
    let five = five.unwrap_or_else(|errors| panic!("{}", errors.render(false)));
    let rows = point_rows(&Outgoing::of(&five, None, None));
    let table = String::from_utf8(csv(&rows)).unwrap();
    let read = |table: &str| {
        let path = file(&directory, "axle.csv", table.as_bytes());
        imported(&path, "solid_axle", &Said::default())
    };
    let refused = read(&table).unwrap_err();
    assert!(
        refused.contains("upper_link_chassis") && refused.contains("--with five_links"),
        "{refused}"
    );
    let without = |part: &str, side: &str| -> String {
        let is_dropped = |line: &&str| line.starts_with(part) && line.contains(side);
        let lines = table.lines().filter(|line| !is_dropped(line));
        lines.map(|line| format!("{line}\n")).collect()
    };
    for (table, is_single) in [
        (without("upper_link", "right"), true),
        (without("panhard", "iso8855"), false),
    ] {
        let study = read(&table).unwrap().study("s", "there").unwrap();
        assert_eq!(study.contains("single = [\"upper_link\"]"), is_single);
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

#[test]
fn a_vehicle_of_chrono_is_a_car_that_is_solved() {
    let directory = tempfile::tempdir().unwrap();
    let path = vehicle(directory.path(), VEHICLE);
    let car = car_of(&path, Some(0.31)).unwrap();
    assert_eq!(car.missing, Vec::<String>::new());
    let study = kept(directory.path(), &car);
    // The axle farther forward is the front axle. Points are those of the file plus the position of the axle.
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

/// The import reads the points of solid axles of Project Chrono: two pairs of links, and a triangular upper link.
#[test]
fn solid_axles_of_chrono_are_read() {
    let upper = [
        (
            "SolidAxle",
            "Upper Link",
            [0.355, 0.5, 0.15],
            [-0.055, 0.2, 0.15],
        ),
        (
            "SolidThreeLinkAxle",
            "Triangular Link",
            [0.4, 0.3, 0.2],
            [0.0, 0.0, 0.25],
        ),
    ];
    let directory = tempfile::tempdir().unwrap();
    for (template, name, chassis, axle) in upper {
        let lower = match template {
            "SolidAxle" => "Lower Link",
            _ => "Longitudinal Link",
        };
        let text = format!(
            r#"{{ "Type": "Suspension", "Template": "{template}", "Spindle": {{ "COM": [0, 0.91, 0] }},
            "{name}": {{ "Location Chassis": {chassis:?}, "Location Axle": {axle:?} }},
            "{lower}": {{ "Location Chassis": [0.45, 0.35, -0.045], "Location Axle": [0.01, 0.6, -0.075] }},
            "Draglink": {{ "Location Chassis": [0.3, 0.4, 0] }},
            "Spring": {{ "Location Chassis": [-0.08, 0.56, 0.3], "Location Axle": [-0.065, 0.575, -0.025] }} }}"#
        );
        let path = file(&directory, "axle.json", text.as_bytes());
        let table = read_points(&path, None, None).unwrap();
        assert_eq!(table.topology(None).unwrap().name, "solid_axle");
        let read = imported(&path, "solid_axle", &Said::default()).unwrap();
        let at = |name: &str| {
            read.hardpoints
                .iter()
                .find(|h| h.name == name)
                .unwrap()
                .position
        };
        assert_eq!(at("upper_link_chassis"), chassis);
        assert_eq!(at("upper_link_axle"), axle);
        assert_eq!(at("lower_link_axle"), [0.01, 0.6, -0.075]);
        assert_eq!(at("spring_lower"), [-0.065, 0.575, -0.025]);
        assert!(
            read.left_out
                .iter()
                .any(|line| line.starts_with("Draglink"))
        );
        let study = study(&read.study("axle", "there").unwrap());
        assert!(study.axle().unwrap().axle.is_rigid());
        let right = Said {
            side: Some(Side::Right),
            ..Said::default()
        };
        assert!(
            imported(&path, "solid_axle", &right)
                .unwrap_err()
                .contains("both wheels")
        );
    }
}

/// Solid axles with four links, or with a Panhard rod, keep their points through an export to Assetto Corsa and back.
/// The points are relative to the midpoint of both wheel centres.
#[test]
fn solid_axles_come_back_from_assetto_corsa() {
    let directory = tempfile::tempdir().unwrap();
    for name in ["solid_axle_solve.toml", "solid_axle_rear.toml"] {
        let own = Study::read(&studies().join(name), &[]).unwrap();
        let outgoing = Outgoing::of(&own, Some(LengthUnit::Metre), None);
        let written = suspensions_ini(&outgoing).unwrap();
        let path = file(&directory, "suspensions.ini", &written.bytes);
        let said = Said {
            axle: Some(AxlePosition::Rear),
            ..Said::default()
        };
        let back = imported(&path, "solid_axle", &said).unwrap();
        let mechanism = &own.wheel().mechanism;
        let centre = outgoing.place(Side::Left, mechanism.wheel_centre);
        let wheel = back
            .hardpoints
            .iter()
            .find(|h| h.name == "wheel_centre")
            .unwrap();
        let frame = Frame::new(back.frame, Side::Left);
        let links = back
            .hardpoints
            .iter()
            .filter(|h| h.name.contains("link") || h.name.contains("panhard"));
        let mut count = 0;
        for hardpoint in links {
            let id = mechanism.point(hardpoint.name).unwrap();
            let mut wanted = outgoing.place(Side::Left, id) - centre;
            wanted.y += centre.y;
            let wanted = frame.vector(wanted).to_array();
            let found = [
                hardpoint.position[0] - wheel.position[0],
                hardpoint.position[1],
                hardpoint.position[2] - wheel.position[2],
            ];
            for (found, wanted) in found.into_iter().zip(wanted) {
                assert!(
                    (found - wanted).abs() < 1e-14,
                    "{name} {}: {found} {wanted}",
                    hardpoint.name
                );
            }
            count += 1;
        }
        let has_panhard = mechanism.point("panhard_axle").is_some();
        assert_eq!(count, if has_panhard { 6 } else { 4 }, "{name}");
        study(&back.study("back", "there").unwrap());
    }
}

/// Solid axles and a twist beam are exported to a table and imported again. The left half keeps its coordinates, in
/// every unit and in all axes. The import names points of a right half that differs.
#[test]
fn axles_of_one_body_come_back_from_tables() {
    let directory = tempfile::tempdir().unwrap();
    for (name, topology) in [
        ("solid_axle_solve.toml", "solid_axle"),
        ("solid_axle_rear.toml", "solid_axle"),
        ("twist_beam_solve.toml", "twist_beam"),
    ] {
        let own = Study::read(&studies().join(name), &[]).unwrap();
        let mechanism = &own.wheel().mechanism;
        for unit in LengthUnit::ALL {
            for convention in FrameConvention::ALL {
                let rows = point_rows(&Outgoing::of(&own, Some(unit), Some(convention)));
                let path = file(&directory, "points.csv", &csv(&rows));
                let back = imported(&path, topology, &Said::default()).unwrap();
                assert_eq!(back.left_out, Vec::<String>::new(), "{name}");
                assert_eq!((back.unit, back.frame), (unit, convention));
                let frame = Frame::new(convention, Side::Left);
                for hardpoint in &back.hardpoints {
                    let id = mechanism.point(hardpoint.name).unwrap();
                    let length = |x: f64| unit.convert_decimal(x, own.wheel().length_unit);
                    let wanted = frame
                        .vector(own.wheel().design[id.0].map(length))
                        .to_array();
                    assert_eq!(
                        hardpoint.position.map(|x| x + 0.0),
                        wanted.map(|x| x + 0.0),
                        "{name} {}",
                        hardpoint.name
                    );
                }
            }
        }
        let rows = point_rows(&Outgoing::of(&own, None, None));
        let path = file(&directory, "points.csv", &csv(&rows));
        let back = imported(&path, topology, &Said::default()).unwrap();
        let again = study(&back.study("back", "there").unwrap());
        assert_eq!(
            again.wheel().mechanism.points.len(),
            mechanism.points.len(),
            "{name}"
        );
        for (number, point) in mechanism.points.iter().enumerate() {
            let id = again.wheel().mechanism.point(&point.name).unwrap();
            let (found, wanted) = (again.wheel().design[id.0], own.wheel().design[number]);
            assert_eq!(found, wanted, "{name} {}", point.name);
        }
        let mut moved = String::from_utf8(csv(&rows)).unwrap();
        moved += "wheel_centre,0.0,-750.0,330.0,right,iso8855,\n";
        let path = file(&directory, "points.csv", moved.as_bytes());
        let back = imported(&path, topology, &Said::default()).unwrap();
        let right: Vec<_> = back
            .right_half
            .iter()
            .map(|h| (h.name, h.position))
            .collect();
        assert_eq!(right, [("wheel_centre", [0.0, -750.0, 330.0])]);
    }
}

/// If the halves differ, the table has one row for each side of each point. The import of this table gives the same
/// axle.
#[test]
fn axles_with_different_halves_come_back_from_tables() {
    let directory = tempfile::tempdir().unwrap();
    for (topology, name, place) in [
        ("twist_beam", "mount", [405.0, -520.0, 345.0]),
        ("solid_axle", "lower_link_chassis", [535.0, -425.0, 310.0]),
    ] {
        let text = hardpoint::cli::template(topology, &[]).unwrap();
        let own = study(&format!(
            "{text}\n[axle.right.hardpoints]\n{name} = {place:?}\n"
        ));
        let table = String::from_utf8(csv(&point_rows(&Outgoing::of(&own, None, None)))).unwrap();
        let right: Vec<&str> = table.lines().filter(|row| row.contains("right")).collect();
        let [x, y, z] = place;
        assert_eq!(right, [format!("{name},{x:?},{y:?},{z:?},right,iso8855,")]);
        let path = file(&directory, "points.csv", table.as_bytes());
        let back = imported(&path, topology, &Said::default()).unwrap();
        let again = study(&back.study("back", "there").unwrap());
        assert_eq!(again.wheel().design, own.wheel().design, "{topology}");
    }
    // A drag link has no mirror image, so such an axle always has two different halves.
    let steered = Study::read(&studies().join("off_road_car_front.toml"), &[]).unwrap();
    let rows = csv(&point_rows(&Outgoing::of(&steered, None, None)));
    let table = String::from_utf8(rows).unwrap();
    assert_eq!(table.matches("\nwheel_centre,").count(), 1, "{table}");
}

/// The import refuses links that a solid axle cannot have, with the reason. If the user assigns names to the links,
/// the import succeeds.
#[test]
fn other_links_of_assetto_corsa_are_named() {
    let directory = tempfile::tempdir().unwrap();
    let own = Study::read(&studies().join("solid_axle_solve.toml"), &[]).unwrap();
    let written = suspensions_ini(&Outgoing::of(&own, None, None)).unwrap();
    let text = String::from_utf8(written.bytes).unwrap();
    assert!(text.contains("LINK_COUNT=4"), "{text}");
    // The file has two further links that are not mirror images.
    let more = text.replace("LINK_COUNT=4", "LINK_COUNT=6")
        + "J4_CAR=0.6,0.01,0.48\nJ4_AXLE=0,0.02,-0.03\nJ5_CAR=-0.6,-0.01,0.48\nJ5_AXLE=0,0.02,-0.03\n";
    let path = file(&directory, "suspensions.ini", more.as_bytes());
    let mut said = Said {
        axle: Some(AxlePosition::Rear),
        ..Said::default()
    };
    let refused = imported(&path, "solid_axle", &said).unwrap_err();
    assert!(
        refused.contains("2 mirrored pairs and 2 single ones") && refused.contains("--map"),
        "{refused}"
    );
    let links = [("lower_link", 0), ("upper_link", 2)];
    for (part, number) in links {
        for (end, key) in [("chassis", "CAR"), ("axle", "AXLE")] {
            said.names
                .insert(format!("{part}_{end}"), format!("AXLE J{number}_{key}"));
        }
    }
    let read = imported(&path, "solid_axle", &said).unwrap();
    assert!(
        read.left_out.iter().any(|line| line.contains("J5_CAR")),
        "{:?}",
        read.left_out
    );
    let wrong = file(
        &directory,
        "suspensions.ini",
        text.replace("LINK_COUNT=4", "LINK_COUNT=5").as_bytes(),
    );
    let refused = imported(&wrong, "solid_axle", &said).unwrap_err();
    assert!(refused.contains("LINK_COUNT is 5"), "{refused}");
}

/// Rate at the left wheel in N/m: increase of the wheel load per heave of the wheel centre. With camber, the heave of
/// the contact point differs from this heave by less than 1 %.
fn springs_alone(study: &Study) -> f64 {
    let start = study.text.find("[motion]").unwrap();
    let text = study.text[..start].to_owned()
        + "[motion]\nheave = [-0.5, 0.0, 0.5]\n[outputs]\ncharacteristics = [\"wheel_load\"]\n";
    let heaving = self::study(&text);
    let solved = hardpoint::solved::Solved::of(&heaving).unwrap();
    let stations = &solved.curves().stations;
    let load = |k: usize| stations[k].value(0).unwrap();
    1000.0 * (load(2) - load(0))
}

/// A car with two double wishbone axles is exported to Assetto Corsa and imported again. The points relative to the
/// wheel centres, the wheelbase, the weight distribution and the heights stay the same.
#[test]
fn a_car_comes_back_from_assetto_corsa() {
    let directory = tempfile::tempdir().unwrap();
    let own = CarStudy::read(&studies().join("formula_student_car.toml"), &[]).unwrap();
    let written = suspensions_ini_of_car(&own).unwrap();
    let path = file(&directory, "suspensions.ini", &written.bytes);
    let mass = format!("[BASIC]\nTOTALMASS={:?}\n", own.car.mass);
    file(&directory, "car.ini", mass.as_bytes());
    let car = car_of(&path, None).unwrap();
    let metres = |length: f64| LengthUnit::Metre.convert(length, own.car.length_unit);
    let near =
        |found: f64, wanted: f64| assert!((found - wanted).abs() < 1e-12, "{found} {wanted}");
    for (axle, (back, text)) in car.axles.iter().zip(&car.files[1..]).enumerate() {
        study(text);
        let suspension = own.axles[axle].wheel();
        let at = |name: &str| {
            back.hardpoints
                .iter()
                .find(|h| h.name == name)
                .unwrap()
                .position
        };
        let centre = suspension.design[suspension.mechanism.wheel_centre.0];
        for hardpoint in &back.hardpoints {
            let id = suspension.mechanism.point(hardpoint.name).unwrap();
            let wanted = (suspension.design[id.0] - centre).to_array();
            let wheel = at("wheel_centre");
            for k in 0..3 {
                near(hardpoint.position[k] - wheel[k], metres(wanted[k]));
            }
        }
        near(2.0 * at("wheel_centre")[1], metres(2.0 * centre.y));
        let unsprung = own.axles[axle].axle().unwrap().axle.setup.unsprung_mass;
        assert!(
            text.contains(&format!("unsprung_mass = {:?}", unsprung.unwrap())),
            "{text}"
        );
    }
    // Rate at the wheel in N/m.
    let ini = String::from_utf8(written.bytes).unwrap();
    let rates = ini.lines().filter_map(|l| l.strip_prefix("SPRING_RATE="));
    let rates: Vec<f64> = rates.map(|rate| rate.parse().unwrap()).collect();
    assert_eq!(rates.len(), 2);
    for (axle, rate) in own.axles.iter().zip(rates) {
        let slope = springs_alone(axle);
        assert!((rate / slope - 1.0).abs() < 0.01, "{rate} {slope}");
    }
    // In the game's files, springs have a rate at the wheel and no points. The import lists the missing data.
    let left_out = car.axles[0].left_out.join("\n");
    assert!(
        left_out.contains("N/m at the wheel") && left_out.contains("motion_ratio^2"),
        "{left_out}"
    );
    assert!(
        car.missing.iter().any(|line| line.contains("[spring]")),
        "{:?}",
        car.missing
    );
    let number = |key: &str, place: usize| -> f64 {
        let line = car.files[0]
            .lines()
            .find(|line| line.starts_with(key))
            .unwrap();
        let numbers = line.split(['[', ',', ']', '=']).map(str::trim);
        numbers
            .filter_map(|word| word.parse().ok())
            .nth(place)
            .unwrap()
    };
    let front = own.axles[0].wheel();
    let front = front.design[front.mechanism.wheel_centre.0];
    near(number("cg =", 0), metres(own.car.cg.x - front.x));
    near(number("cg =", 2), metres(own.car.cg.z - front.z));
    let rear = own.axles[1].wheel();
    let rear = rear.design[rear.mechanism.wheel_centre.0] + own.car.rear_offset;
    near(number("rear_offset", 2), metres(rear.z - front.z));
    let back = car.axles[1]
        .hardpoints
        .iter()
        .find(|h| h.name == "wheel_centre")
        .unwrap();
    near(-back.position[0], metres(front.x - rear.x));
}

/// A table with both axles and a right wheel that is not the mirror image is imported as a car.
#[test]
fn a_table_with_four_corners_is_a_car() {
    let template = Topology::named("double_wishbone").unwrap().template;
    let own = study(template);
    let suspension = own.wheel();
    let mut table = "corner,name,x [mm],y [mm],z [mm]\n".to_owned();
    for (corner, sign, behind) in [
        ("FL", 1.0, 0.0),
        ("FR", -1.0, 0.0),
        ("RL", 1.0, 2500.0),
        ("RR", -1.0, 2500.0),
    ] {
        for (point, place) in suspension.mechanism.points.iter().zip(&suspension.design) {
            // The inner point of the tie rod at the right rear is 2 mm higher.
            let up = if corner == "RR" && point.name == "tie_rod_inner" {
                2.0
            } else {
                0.0
            };
            table += &format!(
                "{corner},{},{:?},{:?},{:?}\n",
                point.name,
                place.x - behind,
                sign * place.y,
                place.z + up
            );
        }
    }
    let directory = tempfile::tempdir().unwrap();
    let path = file(&directory, "points.csv", table.as_bytes());
    let read = read_points(&path, None, None).unwrap();
    assert!(read.has_two_axles());
    assert!(
        read.topology(None)
            .unwrap_err()
            .to_string()
            .contains("--topology")
    );
    let none = BTreeMap::new();
    let options = ImportOptions {
        topology: Topology::named("double_wishbone").unwrap(),
        unit: None,
        frame: None,
        axes: None,
        side: None,
        axle: None,
        half_track: None,
        radius: Some(300.0),
        bushings: false,
        names: &none,
        bodies: &none,
    };
    let car = import_car(&read, [&options, &options], "points.csv").unwrap();
    assert!(
        car.files[1].contains("right = \"mirrored\""),
        "{}",
        car.files[1]
    );
    assert!(
        !car.files[2].contains("right = \"mirrored\""),
        "{}",
        car.files[2]
    );
    let rear = study(&car.files[2]);
    let right = rear.axle().unwrap().axle.right.as_ref().unwrap();
    let id = right.mechanism.point("tie_rod_inner").unwrap();
    let left = rear.wheel().design[id.0];
    assert_eq!(right.design[id.0].z - left.z, 2.0);
    assert!(
        car.files[0].contains("rear_offset = [0.0, 0.0, 0.0]"),
        "{}",
        car.files[0]
    );
}

const SUBSYSTEM: &str = "\
[UNITS]
 LENGTH = 'mm'
 ANGLE = 'degrees'
[HARDPOINT]
{hardpoint_name   symmetry  x_value y_value z_value}
 'lca_front' 'left/right' -160.0 -380.0 190.0
 'lca_rear' 'left/right' 200.0 -375.0 198.0
 'lca_outer' 'left/right' -10.0 -700.0 180.0
 'uca_front' 'left/right' -80.0 -440.0 508.0
 'uca_rear' 'left/right' 150.0 -430.0 492.0
 'uca_outer' 'left/right' 25.0 -650.0 520.0
 'tierod_inner' 'left/right' 130.0 -385.0 235.0
 'tierod_outer' 'left/right' 140.0 -685.0 228.0
 'wheel_center' 'left/right' 0.0 -760.0 310.0
[BUSHING_ASSEMBLY]
 USAGE = 'bkl_lca_front'
 SYMMETRY = 'left/right'
 PROPERTY_FILE = 'mdids://made_up/bushings.tbl/soft.bus'
 FZ_SCALING_FACTOR = 2.0
[BUSHING_ASSEMBLY]
 USAGE = 'uca_front'
 PROPERTY_FILE = '<made_up>/bushings.tbl/other.bus'
[BUSHING_ASSEMBLY]
 USAGE = 'tierod_inner'
 PROPERTY_FILE = '<made_up>/bushings.tbl/soft.bus'
[BUSHING_ASSEMBLY]
 USAGE = 'subframe_mount'
 PROPERTY_FILE = '<made_up>/bushings.tbl/soft.bus'
";

fn bus(fy: f64) -> String {
    let mut text = "[UNITS]\nLENGTH = 'mm'\nANGLE = 'degrees'\nFORCE = 'newton'\n".to_owned();
    for (axis, at_end) in [("FX", 9000.0), ("FY", fy), ("FZ", 1500.0)] {
        text += &format!("[{axis}_CURVE]\n-1.0 {}\n0 0\n1.0 {at_end}\n", -at_end);
    }
    for axis in ["TX", "TY"] {
        text += &format!("[{axis}_CURVE]\n-2.0 -500.0\n-1.0 -100.0\n0 0\n1.0 100.0\n2.0 500.0\n");
    }
    text + "[TZ_CURVE]\n-1.0 -50.0\n1.0 50.0\n"
}

/// The import reads a bushing if the files determine its directions. It names the other bushings.
#[test]
fn bushings_of_adams_are_taken_where_their_directions_are_known() {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name);
    for folder in ["subsystems.tbl", "bushings.tbl"] {
        std::fs::create_dir(at(folder)).unwrap();
    }
    std::fs::write(at("subsystems.tbl/front.sub"), SUBSYSTEM).unwrap();
    std::fs::write(at("bushings.tbl/soft.bus"), bus(9000.0)).unwrap();
    std::fs::write(at("bushings.tbl/other.bus"), bus(8000.0)).unwrap();
    let path = at("subsystems.tbl/front.sub");
    let plain = imported(&path, "double_wishbone", &Said::default()).unwrap();
    assert!(
        plain
            .left_out
            .iter()
            .any(|line| line.contains("--bushings")),
        "{:?}",
        plain.left_out
    );
    assert!(!plain.study("s", "there").unwrap().contains("[bushings"));

    let table = read_points(&path, None, None).unwrap();
    let none = BTreeMap::new();
    let options = ImportOptions {
        topology: Topology::named("double_wishbone").unwrap(),
        unit: None,
        frame: None,
        axes: None,
        side: None,
        axle: None,
        half_track: None,
        radius: Some(310.0),
        bushings: true,
        names: &none,
        bodies: &none,
    };
    let read = hardpoint::exchange::import(&table, &options).unwrap();
    let reasons = read.left_out.join("\n");
    for expected in [
        "FX and FY differ",
        "it is at tie_rod_inner",
        "is not a hardpoint of this wheel",
    ] {
        assert!(reasons.contains(expected), "{expected}: {reasons}");
    }
    let text = read.study("s", "there").unwrap();
    let study = study(&text);
    assert!(study.wheel().mechanism.point("lower_arm_front").is_some());
    // The z axis in the Adams file is the bushing's x axis in the study. The file has a separate scale factor for this
    // axis. 50 N mm at 1 deg are 50 x 180/pi N mm/rad.
    let about = 50.0 * 180.0 / std::f64::consts::PI;
    let line = text
        .lines()
        .find(|line| line.starts_with("stiffness"))
        .unwrap();
    let numbers: Vec<f64> = line
        .split(['[', ',', ']'])
        .filter_map(|word| word.trim().parse().ok())
        .collect();
    assert_eq!(numbers[..3], [3000.0, 9000.0, 9000.0]);
    assert!((numbers[3] - about).abs() < 1e-9 * about, "{line}");
    assert_eq!(numbers[4..], [0.0, 0.0]);
    let degree = std::f64::consts::PI / 180.0;
    assert!(
        text.contains(&format!("ty = [[{:?}, -500.0]", -2.0 * degree)),
        "{text}"
    );
}
