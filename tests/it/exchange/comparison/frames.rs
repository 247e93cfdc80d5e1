//! Tests of designs, rig tests, cars and exported curves in other axes: `compare` finds no difference.

use super::{FRAMES, assert_same, axle, changed, run, sample, wheel};
use std::collections::BTreeMap;
use std::fs;

/// A design in other axes has no differences in racks, points, velocities, accelerations, angular velocities and
/// forces. This holds for studies and for runs, in both orders.
#[test]
fn a_design_is_the_same_in_other_axes() {
    for (text, rows, columns) in [(wheel(), 9, 50), (axle(), 6, 140)] {
        let directory = tempfile::tempdir().unwrap();
        let at = directory.path();
        fs::write(at.join("own.toml"), text).unwrap();
        run(at, &["--quiet", "solve", "own.toml", "--out", "run"], 0);
        for frame in FRAMES {
            let [file, out] = [format!("{frame}.toml"), format!("run_{frame}")];
            run(
                at,
                &["convert", "own.toml", "--frame", frame, "--out", &file],
                0,
            );
            run(at, &["--quiet", "solve", &file, "--out", &out], 0);
            for sources in [
                ["own.toml", &*file],
                [&*file, "own.toml"],
                ["run", &*out],
                [&*out, "own.toml"],
                ["run", &*file],
            ] {
                assert_same(at, sources, rows, columns);
            }
        }
    }
}

/// Results of rig tests at the same physical rack positions are equal. `compare` lists them at the rack positions of
/// the first run.
#[test]
fn rig_tests_are_the_same_in_other_axes() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    let text = changed(
        &sample("double_wishbone_compliance.toml"),
        &[
            ("travel = ", "travel = 0.0\nrack = [-4.0, 0.0, 8.0]"),
            (
                "[compliance]",
                "[compliance]\ntests = [{ load = \"steering\", stations = \"all\" }]",
            ),
        ],
    );
    fs::write(at.join("own.toml"), text).unwrap();
    run(at, &["--quiet", "kc", "own.toml", "--out", "own"], 0);
    for frame in FRAMES {
        let file = format!("{frame}.toml");
        run(
            at,
            &["convert", "own.toml", "--frame", frame, "--out", &file],
            0,
        );
        run(at, &["--quiet", "kc", &file, "--out", frame], 0);
        run(
            at,
            &["compare", "own", frame, "--out", "sides", "--force"],
            0,
        );
        let mut reader = csv::Reader::from_path(at.join("sides/comparison.csv")).unwrap();
        let header = reader.headers().unwrap().clone();
        let column = |name: &str| header.iter().position(|own| own == name).unwrap();
        let [rack, quantity] = ["rack_mm", "quantity"].map(column);
        let difference = column(&format!("{frame}_difference"));
        let mut found = Vec::new();
        for row in reader.records() {
            let row = row.unwrap();
            let apart = row[difference].parse::<f64>().unwrap();
            assert!(apart.abs() <= 1e-9, "{row:?}");
            found.push(format!("{} {}", &row[quantity], &row[rack]));
        }
        for name in ["steer_by_rack", "caster_by_rack", "rack_force"] {
            for rack in ["-4.0", "0.0", "8.0"] {
                assert!(found.contains(&format!("{name} {rack}")), "{found:?}");
            }
        }
    }
    // Without its study, the axes of a run are unknown.
    fs::remove_file(at.join("x_rear/study.toml")).unwrap();
    let [_, said] = run(at, &["compare", "own", "x_rear", "--out", "sides"], 2);
    assert!(said.contains("depends on the axes"), "{said}");
}

/// A car in other axes has no changed input.
#[test]
fn a_car_is_the_same_in_other_axes() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    for name in ["off_road_car", "off_road_car_front", "off_road_car_rear"] {
        let name = format!("{name}.toml");
        fs::write(at.join(&name), sample(&name)).unwrap();
    }
    let file = "off_road_car.toml";
    for frame in FRAMES {
        run(at, &["convert", file, "--frame", frame, "--out", frame], 0);
        let other = format!("{frame}/{file}");
        let arguments = [
            "compare", file, &other, "--out", "sides", "--force", "--format", "csv",
        ];
        let [printed, _] = run(at, &arguments, 0);
        let rows = printed
            .lines()
            .filter(|line| !line.is_empty() && !line.starts_with("table,"));
        assert_eq!(rows.count(), 0, "{printed}");
    }
    // `compare` shows a change in the axes of the first car.
    let other = format!("{}/{file}", FRAMES[0]);
    let text = fs::read_to_string(at.join(&other)).unwrap();
    let centre = text.lines().find(|line| line.starts_with("cg = "));
    let centre = centre.unwrap_or_else(|| panic!("{text}")).to_owned();
    let numbers = |line: &str| -> Vec<f64> {
        let (_, list) = line.split_once('[').unwrap();
        let (list, _) = list.split_once(']').unwrap();
        list.split(',')
            .map(|number| number.trim().parse().unwrap())
            .collect()
    };
    let place = numbers(&centre);
    let lower = format!(
        "cg = [{:?}, {:?}, {:?}]",
        place[0],
        place[1],
        place[2] + 10.0
    );
    fs::write(at.join(&other), text.replace(&centre, &lower)).unwrap();
    let arguments = [
        "compare", file, &other, "--out", "sides", "--force", "--format", "csv",
    ];
    let [printed, _] = run(at, &arguments, 0);
    let [up, lower] = [-place[2], -place[2] - 10.0];
    assert!(
        printed.contains(&format!("cg_z,mm,{up:?},{lower:?}")),
        "{printed}"
    );
}

/// Exported curves equal the curves of the converted study. The test covers components of points and forces, and the
/// rack.
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
                // If the y axis is reversed, the rack displacements are in reverse order. So the test sorts the cells.
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

/// Number with seven decimals. Other text stays unchanged.
fn rounded(cell: &str) -> String {
    let number = cell.parse::<f64>();
    number.map_or(cell.to_owned(), |number| format!("{:.7}", number + 0.0))
}
