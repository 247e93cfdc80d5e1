//! Tests of `hardpoint compare` with one design in different axes and units: `compare` finds no difference.

use crate::support::{larger, one_line};
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

/// Copies a study and replaces some of its lines. The beginning of a line selects that line.
fn changed(text: &str, lines: &[(&str, &str)]) -> String {
    let mut text = text.to_owned();
    for (start, new) in lines {
        let found = text.lines().find(|line| line.starts_with(start));
        text = text.replacen(&found.unwrap().to_owned(), new, 1);
    }
    text
}

/// Study of one wheel with several rack displacements, and components of points and forces.
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

/// Study of an axle with several rack displacements, and components of points and forces.
fn axle() -> String {
    changed(
        &sample("double_wishbone_axle.toml"),
        &[
            ("roll = ", "travel_left = [-5.0, 5.0]"),
            ("heave = ", "rack = [-4.0, 0.0, 8.0]"),
            ("steering_wheel_angle = ", ""),
            // The new line omits the quantities of the sample that need a plane ground or steered wheels.
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

/// Compares two studies or runs. Returns the number of rows, and the largest difference of each column relative to its
/// largest value.
fn compare(directory: &Path, sources: [&str; 2]) -> (usize, BTreeMap<String, f64>) {
    let [one, other] = sources;
    let [_, said] = run(
        directory,
        &["compare", one, other, "--out", "sides", "--force"],
        0,
    );
    assert!(!said.contains("only in"), "{sources:?}: {said}");
    let mut reader = csv::Reader::from_path(directory.join("sides/comparison.csv")).unwrap();
    let header = reader.headers().unwrap().clone();
    let rows: Vec<_> = reader.records().map(|row| row.unwrap()).collect();
    let largest = |column: usize| {
        let cells = rows
            .iter()
            .filter_map(|row| row[column].parse::<f64>().ok());
        cells.fold(0.0, |most: f64, value| larger(most, value.abs()))
    };
    let columns = header.iter().enumerate();
    let differences = columns.filter(|(_, name)| name.contains(" - "));
    let relative = differences.map(|(column, name)| {
        // The column to the left contains the value of the second design.
        (
            name.to_owned(),
            largest(column) / largest(column - 1).max(1e-3),
        )
    });
    (rows.len(), relative.collect())
}

#[track_caller]
fn assert_same(directory: &Path, sources: [&str; 2], rows: usize, columns: usize) {
    let (found, differences) = compare(directory, sources);
    assert_eq!(found, rows, "{sources:?}");
    assert!(
        differences.len() >= columns,
        "{sources:?}: {}",
        differences.len()
    );
    for (name, difference) in differences {
        assert!(difference <= 1e-12, "{sources:?} {name}: {difference}");
    }
}

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

/// A design converted to another unit counts as unmoved, although the conversion rounds its coordinates. `compare`
/// lists a real move of a nanometre.
#[test]
fn conversions_of_units_move_no_point() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    fs::write(at.join("own.toml"), wheel()).unwrap();
    let moved = wheel().replace("[-140.0,  685.0,  228.0]", "[-140.0, 685.000001, 228.0]");
    assert_ne!(moved, wheel());
    fs::write(at.join("moved.toml"), moved).unwrap();
    let compared = |sources: [&str; 2]| {
        let [one, other] = sources;
        let arguments = ["compare", one, other, "--out", "sides", "--force"];
        run(at, &arguments, 0)[0].clone()
    };
    for unit in ["in", "m"] {
        let other = format!("{unit}.toml");
        run(
            at,
            &["convert", "own.toml", "--unit", unit, "--out", &other],
            0,
        );
        for sources in [["own.toml", &*other], [&*other, "own.toml"]] {
            let said = compared(sources);
            assert!(!said.contains("moved"), "{sources:?}: {said}");
        }
        let said = compared([&other, "moved.toml"]);
        assert!(said.contains("moved"), "{said}");
    }
}

/// A run of `setup` is compared with its adjusted points, also at stations that the run does not have.
#[test]
fn a_set_up_is_compared_with_its_adjustments() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    let study = |travel: &str| {
        changed(
            &sample("double_wishbone_tolerance.toml"),
            &[("travel = ", travel)],
        )
    };
    fs::write(at.join("few.toml"), study("travel = [-5.0, 0.0, 5.0]")).unwrap();
    fs::write(at.join("own.toml"), study("travel = [-10.0, 0.0, 10.0]")).unwrap();
    run(at, &["--quiet", "solve", "few.toml", "--out", "few"], 0);
    let want = "setup.want={ camber = -1.5 }";
    let set_up = ["--quiet", "setup", "own.toml", "--set", want];
    run(at, &[&set_up[..], &["--out", "set_up"]].concat(), 0);

    let compare = ["compare", "few", "set_up", "--out", "sides"];
    let [tables, said] = run(at, &compare, 0);
    assert!(said.contains("solved again"), "{said}");
    assert!(tables.contains("moved"), "{tables}");
    let at_static = |file: &str, name: &str| {
        let csv = fs::read_to_string(at.join(file)).unwrap();
        let mut lines = csv.lines().map(|line| line.split(',').collect::<Vec<_>>());
        let header = lines.next().unwrap();
        let column = header.iter().position(|own| *own == name);
        let column = column.unwrap_or_else(|| panic!("{header:?}"));
        let row = lines.find(|row| row[0] == "0.0").unwrap();
        row[column].parse::<f64>().unwrap()
    };
    let of_run = at_static("set_up/curves.csv", "camber_deg");
    let again = at_static("sides/comparison.csv", "camber_deg [set_up]");
    // Before the adjustments, camber is -2 degrees.
    assert!((of_run + 1.5).abs() <= 0.1, "{of_run}");
    assert!((again - of_run).abs() <= 1e-9, "{again} {of_run}");

    // `export` has no adjusted study, so it refuses the run.
    let [_, said] = run(at, &["export", "set_up", "--to", "csv"], 2);
    let said = one_line(&said);
    assert!(said.contains("the points before the adjustments"), "{said}");
}

/// Curves at a single rack displacement have no column for the rack. `compare` still uses the displacement.
#[test]
fn a_fixed_rack_is_part_of_the_station() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    let fixed = changed(&wheel(), &[("rack = ", "rack = 10.0")]);
    fs::write(at.join("fixed.toml"), fixed).unwrap();
    fs::write(at.join("all.toml"), wheel()).unwrap();
    run(
        at,
        &[
            "convert",
            "fixed.toml",
            "--frame",
            "x_rear",
            "--out",
            "other.toml",
        ],
        0,
    );
    for (study, out) in [("all.toml", "all"), ("other.toml", "other")] {
        run(at, &["--quiet", "solve", study, "--out", out], 0);
    }
    for (sources, rows) in [
        (["fixed.toml", "other.toml"], 3),
        // The second run has no curves at two of the rack displacements, so `compare` solves its study again.
        (["all", "other"], 9),
        (["other", "all"], 3),
    ] {
        assert_same(at, sources, rows, 50);
    }
}

/// `compare` converts forces in pounds-force to the newtons of the first study, and the reverse.
#[test]
fn a_design_is_the_same_in_other_units() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    let text = changed(&wheel(), &[("rack = ", "rack = 0.0")]);
    fs::write(at.join("own.toml"), text).unwrap();
    let inches = ["convert", "own.toml", "--unit", "in", "--out", "in.toml"];
    run(at, &inches, 0);
    run(
        at,
        &[
            "convert",
            "in.toml",
            "--force-unit",
            "lbf",
            "--out",
            "lbf.toml",
        ],
        0,
    );
    for sources in [
        ["own.toml", "lbf.toml"],
        ["in.toml", "lbf.toml"],
        ["lbf.toml", "own.toml"],
    ] {
        let (rows, differences) = compare(at, sources);
        assert!(rows == 3 && differences.len() > 50, "{sources:?}");
        for (name, difference) in differences {
            // Accelerations are second derivatives of rounded coordinates, so their bound is larger.
            assert!(difference <= 1e-9, "{sources:?} {name}: {difference}");
        }
    }
}

/// `compare` solves every other study over the drive of the first study, or states why it cannot.
#[test]
fn studies_follow_the_drive_of_the_first_study() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    let travel = sample("double_wishbone_solve.toml");
    let with = |motion: &str| changed(&travel, &[("travel = ", motion)]);
    let write = |name: &str, text: &str| fs::write(at.join(name), text).unwrap();
    write("travel.toml", &travel);
    write(
        "angle.toml",
        &with("drive = \"arm_angle\"\narm_angle = { from = -5.0, to = 5.0, steps = 5 }"),
    );
    write(
        "time.toml",
        &with("time = { polynomial = [0.0, 20.0], from = -1.0, to = 1.0, steps = 7 }"),
    );
    write("macpherson.toml", &sample("macpherson_solve.toml"));
    write("five_link.toml", &sample("five_link_solve.toml"));
    write("elastic.toml", &sample("double_wishbone_compliance.toml"));
    for (first, rows, columns) in [
        ("travel.toml", 41, 9),
        ("angle.toml", 5, 10),
        ("time.toml", 7, 9),
    ] {
        for other in ["travel.toml", "angle.toml", "time.toml"] {
            assert_same(at, [first, other], rows, columns);
        }
    }
    // Another design has other travels at the same arm angles.
    let sources = ["compare", "angle.toml", "macpherson.toml", "--out", "-"];
    let [csv, _] = run(at, &sources, 0);
    assert!(csv.starts_with("arm_angle_deg,travel_mm [angle],"), "{csv}");
    assert_eq!(csv.lines().count(), 1 + 5);
    for (other, reason) in [
        ("five_link.toml", "five_link has no arm"),
        (
            "elastic.toml",
            "studies with [compliance] are solved over travel",
        ),
    ] {
        let [_, said] = run(at, &["compare", "angle.toml", other, "--out", "-"], 2);
        let said = one_line(&said);
        assert!(said.contains(reason), "{said}");
    }
    // A run that contains its study is solved again over the motion of the first run. A run without its study cannot be
    // solved again.
    run(at, &["--quiet", "solve", "angle.toml", "--out", "run"], 0);
    assert_same(at, ["run", "travel.toml"], 5, 10);
    assert_same(at, ["travel.toml", "run"], 41, 9);
    fs::remove_file(at.join("run/study.toml")).unwrap();
    let [_, said] = run(at, &["compare", "run", "travel.toml", "--out", "-"], 2);
    let said = one_line(&said);
    assert!(
        said.contains("the curves of run are over arm_angle_deg"),
        "{said}"
    );
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

/// A run with other stations is solved again, so the comparison has every station of the first design. A run without
/// its study is compared only at the common stations, and the command states their number.
#[test]
fn runs_with_other_stations_are_compared_at_all_stations_of_the_first() {
    let directory = tempfile::tempdir().unwrap();
    let directory = directory.path();
    let study = |pivot: &str, from: f64, to: f64, steps: u32| {
        changed(
            &sample("double_wishbone_solve.toml"),
            &[
                (
                    "travel = ",
                    &format!("travel = {{ from = {from:?}, to = {to:?}, steps = {steps} }}"),
                ),
                ("lower_arm_front", pivot),
            ],
        )
    };
    let text = sample("double_wishbone_solve.toml");
    let pivot = text
        .lines()
        .find(|line| line.starts_with("lower_arm_front"))
        .unwrap();
    let moved = "lower_arm_front = [150.0, 350.0, 205.0]";
    fs::write(directory.join("first.toml"), study(pivot, -40.0, 40.0, 5)).unwrap();
    fs::write(directory.join("moved.toml"), study(moved, -40.0, 40.0, 5)).unwrap();
    fs::write(directory.join("other.toml"), study(moved, -30.0, 60.0, 10)).unwrap();
    run(directory, &["solve", "other.toml", "--out", "other"], 0);
    let [whole, _] = run(
        directory,
        &["compare", "first.toml", "moved.toml", "--out", "-"],
        0,
    );
    let [again, said] = run(
        directory,
        &["compare", "first.toml", "other", "--out", "-"],
        0,
    );
    assert!(said.contains("solved again over the same motion"), "{said}");
    assert_eq!(whole.replace("moved", "other"), again);
    fs::remove_file(directory.join("other/study.toml")).unwrap();
    fs::remove_file(directory.join("other/run.json")).unwrap();
    let [few, said] = run(
        directory,
        &["compare", "first.toml", "other", "--out", "-"],
        0,
    );
    // The common stations are -20, 0, 20 and 40: `other` has multiples of 10, from -30 on.
    assert_eq!(few.lines().count(), 5, "{few}");
    let said = one_line(&said);
    assert!(
        said.contains("cover only 4 common stations (first has 5, other has 10)"),
        "{said}"
    );
    // A run without its study does not affect the studies that follow: the command still solves them over the motion of
    // the first.
    let three = ["compare", "first.toml", "other", "other.toml", "--out", "-"];
    let [_, said] = run(directory, &three, 0);
    let said = one_line(&said);
    assert!(
        said.contains("(first has 5, other has 10, other.toml has 5)"),
        "{said}"
    );
}

/// In the default output directory, a comparison does not overwrite an earlier comparison of other designs.
#[test]
fn another_comparison_replaces_no_earlier_one() {
    let directory = tempfile::tempdir().unwrap();
    let directory = directory.path();
    fs::write(directory.join("a.toml"), wheel()).unwrap();
    let text = wheel();
    let pivot = text
        .lines()
        .find(|line| line.starts_with("lower_arm_front"))
        .unwrap();
    for (name, z) in [("b.toml", 205.0), ("c.toml", 206.0)] {
        let line = format!("lower_arm_front = [150.0, 350.0, {z:?}]");
        fs::write(directory.join(name), wheel().replace(pivot, &line)).unwrap();
    }
    let first = directory.join("out/compare/comparison.csv");
    run(directory, &["compare", "a.toml", "b.toml"], 0);
    let of_b = fs::read(&first).unwrap();
    // A repeated comparison of the same designs replaces the earlier one.
    run(directory, &["compare", "a.toml", "b.toml"], 0);
    let [_, said] = run(directory, &["compare", "a.toml", "c.toml"], 0);
    assert!(said.contains("are now in out/compare.1"), "{said}");
    assert_eq!(
        fs::read(directory.join("out/compare.1/comparison.csv")).unwrap(),
        of_b
    );
    assert_ne!(fs::read(&first).unwrap(), of_b);
    // If the user names the output directory, the program does not move earlier results to another directory. It
    // replaces these results only with `--force`.
    run(
        directory,
        &["compare", "a.toml", "b.toml", "--out", "mine"],
        0,
    );
    run(
        directory,
        &["compare", "a.toml", "c.toml", "--out", "mine"],
        2,
    );
    run(
        directory,
        &["compare", "a.toml", "c.toml", "--out", "mine", "--force"],
        0,
    );
}

/// A comparison of runs says at how many stations each design has no values, and exits with 1, like a comparison of studies.
#[test]
fn runs_with_unsolved_stations_are_incomplete() {
    let directory = tempfile::tempdir().unwrap();
    let study = changed(
        &sample("double_wishbone_solve.toml"),
        &[("travel = ", "travel = [-250.0, 0.0, 40.0, 250.0]")],
    );
    fs::write(directory.path().join("a.toml"), &study).unwrap();
    for run_name in ["first", "second"] {
        run(directory.path(), &["solve", "a.toml", "--out", run_name], 1);
    }
    for sources in [["first", "second"], ["first", "a.toml"]] {
        let arguments = [
            &["compare"],
            &sources[..],
            &["--out", "compared", "--force"],
        ]
        .concat();
        let [_, noted] = run(directory.path(), &arguments, 1);
        let [first, second] = sources.map(|name| name.trim_end_matches(".toml"));
        assert!(
            noted.contains(&format!(
                "Stations without all values: {first} 1 of 4, {second} 1 of 4."
            )),
            "{noted}"
        );
    }
}
