//! Tests of solid axles in files of Assetto Corsa.

use super::commands::sample;
use std::fs;
use std::path::Path;

fn run(arguments: &[&str]) -> (u8, String) {
    hardpoint::cli::run_captured([&["hardpoint", "--quiet"], arguments].concat())
}

/// File for the axle of a sample, and the notes of the export.
fn exported(name: &str, directory: &Path) -> (String, String) {
    let file = directory.join("suspensions.ini");
    let out = file.to_str().unwrap();
    let base = ["export", &sample(name), "--to", "assetto", "--force"].map(str::to_owned);
    let base: Vec<&str> = base.iter().map(String::as_str).collect();
    let command = [&["hardpoint"], &base[..], &["--out", out]].concat();
    let (code, said) = hardpoint::cli::run_captured(command);
    assert_eq!(code, 0, "{said}");
    (fs::read_to_string(file).unwrap(), said)
}

fn value(text: &str, key: &str) -> f64 {
    let start = format!("{key}=");
    let line = text.lines().find(|line| line.starts_with(&start)).unwrap();
    line[start.len()..].parse().unwrap()
}

/// The format has the links of only one solid axle, so the export refuses a car with two solid axles.
#[test]
fn a_second_solid_axle_is_not_exported() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("suspensions.ini");
    let arguments = [
        "export",
        &sample("off_road_car.toml"),
        "--to",
        "assetto",
        "--out",
        file.to_str().unwrap(),
    ];
    let (code, said) = run(&arguments);
    assert_eq!(code, 2, "{said}");
    assert!(
        said.contains("car.front and car.rear are solid axles"),
        "{said}"
    );
    assert!(!file.exists());
}

/// The import refuses a file with two sections of links, and a file with one section of links for two axles. Otherwise
/// it could assign links to the wrong axle.
#[test]
fn links_of_two_axles_are_not_mixed() {
    let directory = tempfile::tempdir().unwrap();
    let directory = directory.path();
    let (rear, _) = exported("off_road_car_rear.toml", directory);
    let rear = &rear[rear.find("[REAR]").unwrap()..];
    let (axle, links) = rear.split_at(rear.find("[AXLE]").unwrap());
    let front = axle.replace("[REAR]", "[FRONT]");
    let other_links = links.replace("J0_CAR=", "J0_CAR=0");
    let head = "[HEADER]\nVERSION=2\n[BASIC]\nWHEELBASE=2.7\n";
    let path = directory.join("suspensions.ini");
    let path_text = path.to_str().unwrap();
    let import = [
        "import",
        path_text,
        "--radius",
        "0.375",
        "--topology",
        "solid_axle",
    ];
    for (text, words) in [
        (
            format!("{head}{front}{other_links}{axle}{links}"),
            "a second section [AXLE]",
        ),
        (
            format!("{head}{axle}{other_links}{links}"),
            "a second section [AXLE]",
        ),
        (
            format!("{head}{front}{axle}{links}"),
            "[AXLE] has the links of one axle only",
        ),
    ] {
        fs::write(&path, text).unwrap();
        for axle in [&["--axle", "rear"][..], &["--axle", "front"], &["--car"]] {
            let out = directory.join("out");
            let out = ["--out", out.to_str().unwrap()];
            let (code, said) = run(&[&import, axle, &out].concat());
            assert_eq!(code, 2, "{said}");
            assert!(said.contains(words), "{said}");
        }
    }
    fs::write(&path, format!("{head}{axle}{links}")).unwrap();
    let (code, said) = run(&[&import[..], &["--axle", "rear"]].concat());
    assert_eq!(code, 0, "{said}");
}

/// Both wheels of a solid axle rise together. The exported rate per wheel is half of the increase of both wheel loads
/// together, divided by the heave.
#[test]
fn the_rate_is_that_of_the_axle_in_heave() {
    let directory = tempfile::tempdir().unwrap();
    let directory = directory.path();
    let name = "off_road_car_rear.toml";
    let (text, said) = exported(name, directory);
    assert!(
        said.contains("SPRING_RATE is the rate of the axle in heave, per wheel,"),
        "{said}"
    );
    let heave = 0.01;
    let out = directory.join("curves");
    let changes = [
        "outputs={characteristics=[\"wheel_load\"]}".to_owned(),
        format!("motion={{heave={{from=-{heave},to={heave},steps=3}}}}"),
    ];
    let (code, said) = run(&[
        "solve",
        &sample(name),
        "--set",
        &changes[0],
        "--set",
        &changes[1],
        "--out",
        out.to_str().unwrap(),
    ]);
    assert_eq!(code, 0, "{said}");
    let csv = fs::read(out.join("curves.csv")).unwrap();
    let mut reader = csv::Reader::from_reader(csv.as_slice());
    let header = reader.headers().unwrap().clone();
    let loads: Vec<f64> = reader
        .records()
        .map(|row| {
            let row = row.unwrap();
            let cells = header.iter().zip(row.iter());
            let own = cells.filter(|(name, _)| name.ends_with("wheel_load_N"));
            own.map(|(_, cell)| cell.parse::<f64>().unwrap()).sum()
        })
        .collect();
    // The error of the difference quotient is of second order in the heave.
    let expected = 1000.0 * 0.5 * (loads[2] - loads[0]) / (2.0 * heave);
    let found = value(&text, "SPRING_RATE");
    assert!(
        (found - expected).abs() < 1e-5 * expected,
        "{found} {expected}"
    );
}

/// An axle steered by a drag link has an internal point. The list of derivatives omits it.
#[test]
fn derivatives_by_internal_points_are_not_listed() {
    let directory = tempfile::tempdir().unwrap();
    let directory = directory.path();
    let out = directory.join("car");
    let (code, said) = run(&[
        "solve",
        &sample("off_road_car.toml"),
        "--set",
        "outputs={characteristics=[\"roll\"],sensitivities=true}",
        "--out",
        out.to_str().unwrap(),
    ]);
    assert_eq!(code, 0, "{said}");
    let rows = fs::read_to_string(out.join("sensitivities.csv")).unwrap();
    assert!(rows.contains("front,drag_link_body,x,"), "{rows}");
    assert!(!rows.contains("drag_link_place"));
}

/// The export refuses a Watt linkage. The format could hold only one of its links, which would act like a Panhard rod
/// of half the length.
#[test]
fn a_watt_linkage_is_not_exported() {
    let directory = tempfile::tempdir().unwrap();
    let study = directory.path().join("axle.toml");
    let text = hardpoint::cli::template("solid_axle", &["watt".to_owned()]).unwrap();
    fs::write(&study, text).unwrap();
    let (code, said) = run(&["export", study.to_str().unwrap(), "--to", "assetto"]);
    assert_eq!(code, 2, "{said}");
    assert!(said.contains("Watt linkage"), "{said}");
}
