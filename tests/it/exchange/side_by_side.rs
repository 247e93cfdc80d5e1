//! `hardpoint compare` of one design in different axes and units: it does not differ from itself.

use assert_cmd::Command;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

const FRAMES: [&str; 2] = ["sae_j670", "x_rear"];

fn sample(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("studies")
        .join(name);
    fs::read_to_string(path).unwrap()
}

/// Runs a command in a directory. Returns standard output and standard error.
fn run(directory: &Path, arguments: &[&str], code: i32) -> [String; 2] {
    let mut command = Command::cargo_bin("hardpoint").unwrap();
    let done = command.current_dir(directory).args(arguments).assert();
    let output = done.code(code).get_output().clone();
    [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap())
}

/// Copies a study with replaced lines. Each line is named by its beginning.
fn changed(text: &str, lines: &[(&str, &str)]) -> String {
    let mut text = text.to_owned();
    for (start, new) in lines {
        let found = text.lines().find(|line| line.starts_with(start));
        text = text.replacen(&found.unwrap().to_owned(), new, 1);
    }
    text
}

/// A study of one wheel with several racks, components of points and forces.
fn wheel() -> String {
    changed(
        &sample("double_wishbone_solve.toml"),
        &[
            (
                "travel = ",
                "travel = { from = -20.0, to = 20.0, steps = 3 }",
            ),
            ("rack = ", "rack = [-4.0, 0.0, 10.0]"),
            (
                "# points = ",
                "points = [\"wheel_centre\", \"tie_rod_outer\"]\norder = \"acceleration\"\nknuckle = true\n\
                 loads = [{ name = \"braking\", at = \"contact_point\", force = [-3000.0, 500.0, 4000.0] }]",
            ),
        ],
    )
}

/// A study of an axle with several racks, components of points and forces.
fn axle() -> String {
    changed(
        &sample("double_wishbone_axle.toml"),
        &[
            ("roll = ", "travel_left = [-5.0, 5.0]"),
            ("heave = ", "rack = [-4.0, 0.0, 8.0]"),
            ("steering_wheel_angle = ", ""),
            // Other quantities of the sample need a plane ground or steered wheels.
            (
                "  \"camber_to_road\"",
                "  \"camber_to_road\", \"steer\", \"force_roll_centre_height\",",
            ),
            (
                "[outputs]",
                "[outputs]\npoints = [\"wheel_centre\", \"tie_rod_outer\"]\norder = \"velocity\"\nknuckle = true\n\
                 loads = [{ name = \"braking\", at = \"contact_point\", force = [-3000.0, 500.0, 4000.0] }]",
            ),
        ],
    )
}

/// Exported curves are those of the converted study: components of points and forces, and the rack.
#[test]
fn exported_curves_are_those_of_the_converted_study() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    fs::write(at.join("wheel.toml"), wheel()).unwrap();
    fs::write(at.join("axle.toml"), axle()).unwrap();
    for end in ["", "_front", "_rear"] {
        let name = format!("car{end}.toml");
        fs::write(at.join(&name), sample(&name)).unwrap();
    }
    let member_loads = sample("car.toml") + "\n[outputs]\nmember_loads = true\n";
    fs::write(at.join("car.toml"), member_loads).unwrap();
    for (study, curves, forces) in [
        ("wheel", "curves.csv", 2),
        ("axle", "curves.csv", 4),
        ("car", "cases.csv", 4),
    ] {
        for frame in FRAMES {
            let file = format!("{study}.toml");
            let export = ["export", &file, "--to", "csv", "--curves", "--frame", frame];
            let [exported, _] = run(at, &export, 0);
            let new = format!("{frame}/{file}");
            fs::create_dir_all(at.join(frame)).unwrap();
            let out = if study == "car" { frame } else { &*new };
            run(at, &["convert", &file, "--frame", frame, "--out", out], 0);
            run(
                at,
                &["--quiet", "solve", &new, "--out", "run", "--force"],
                0,
            );
            let expected = fs::read_to_string(at.join("run").join(curves)).unwrap();
            let [mut found, mut expected] = [exported, expected].map(|text| columns(&text));
            let names: Vec<String> = expected.keys().cloned().collect();
            let is_force = |name: &&String| name.ends_with("_y_N");
            assert!(names.iter().filter(is_force).count() >= forces, "{names:?}");
            for name in names {
                // Ranges of racks begin at the other end.
                let sorted = |cells: Option<Vec<String>>| {
                    let mut cells: Vec<_> = cells.unwrap().iter().map(|c| rounded(c)).collect();
                    cells.sort();
                    cells
                };
                let [own, other] = [found.remove(&name), expected.remove(&name)].map(sorted);
                assert_eq!(own, other, "{study} {frame} {name}");
            }
        }
    }
}

/// Cells of each column of a table.
fn columns(text: &str) -> BTreeMap<String, Vec<String>> {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let header = reader.headers().unwrap().clone();
    let rows: Vec<_> = reader.records().map(|row| row.unwrap()).collect();
    let column = |k: usize| rows.iter().map(|row| row[k].to_owned()).collect();
    let names = header.iter().enumerate();
    names
        .map(|(k, name)| (name.to_owned(), column(k)))
        .collect()
}

/// Number with seven digits behind the point. Other text stays.
fn rounded(cell: &str) -> String {
    let number = cell.parse::<f64>();
    number.map_or(cell.to_owned(), |number| format!("{:.7}", number + 0.0))
}
