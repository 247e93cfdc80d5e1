//! Tests of commands on studies of cars.

use crate::support::{one_line, studies};
use std::fs;
use std::path::Path;

pub(super) fn hardpoint(directory: &Path, arguments: &[&str]) -> assert_cmd::assert::Assert {
    let mut command = assert_cmd::Command::cargo_bin("hardpoint").unwrap();
    command.current_dir(directory).args(arguments).assert()
}

pub(super) fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// `hardpoint new` writes three files that other commands accept, and overwrites no file. The three files equal the
/// samples.
#[test]
fn new_cars_run() {
    let directory = tempfile::tempdir().unwrap();
    for name in ["car", "formula_student_car"] {
        hardpoint(directory.path(), &["new", name]).success();
        for end in ["", "_front", "_rear"] {
            let file = format!("{name}{end}.toml");
            let sample = fs::read(studies().join(&file)).unwrap();
            assert_eq!(
                fs::read(directory.path().join(&file)).unwrap(),
                sample,
                "{file}"
            );
        }
        let again = hardpoint(directory.path(), &["new", name]).code(2);
        assert!(text(&again.get_output().stderr).contains("already exists"));
        let study = format!("{name}.toml");
        hardpoint(directory.path(), &["check", &study]).success();
        hardpoint(directory.path(), &["solve", &study]).success();
        let cases = fs::read_to_string(directory.path().join(format!("out/{name}/cases.csv")));
        let cases = cases.unwrap();
        assert!(
            cases.lines().nth(1).unwrap().starts_with("static,"),
            "{cases}"
        );
        assert!(
            cases.lines().skip(1).all(|line| line.ends_with(",ok")),
            "{cases}"
        );
    }
}

/// A tuned car consists of three studies whose results are those of the tuning.
#[test]
fn tuned_cars_are_studies() {
    let directory = tempfile::tempdir().unwrap();
    hardpoint(directory.path(), &["new", "car"]).success();
    hardpoint(
        directory.path(),
        &["optimise", "car.toml", "--report", "--out", "tuned"],
    )
    .success();
    let tuned = directory.path().join("tuned");
    hardpoint(&tuned, &["solve", "optimised.toml", "--out", "again"]).success();
    let read = |path: &str| fs::read_to_string(tuned.join(path)).unwrap();
    // The page shows the misfit before and after the tuning. For every variable it shows the values.
    let summary: serde_json::Value = serde_json::from_str(&read("summary.json")).unwrap();
    let page = read("report.html");
    let (_, section) = page.split_once("<section id=\"variables\">").unwrap();
    let (section, _) = section.split_once("</section>").unwrap();
    let rows: Vec<&str> = section.split("<tr>").skip(2).collect();
    let variables = summary["variables"].as_array().unwrap();
    assert_eq!(rows.len(), variables.len(), "{section}");
    assert!(variables.len() >= 2);
    for (row, variable) in rows.iter().zip(variables) {
        let name = variable["name"].as_str().unwrap().replace('_', "_<wbr>");
        assert!(row.contains(&name), "{row} {name}");
        assert_eq!(row.matches("<td class=\"number\">").count(), 4, "{row}");
    }
    assert!(page.contains("<dt>Misfit</dt><dd>"));
    assert!(section.contains(" → "), "{section}");
    assert_eq!(read("cases.csv"), read("again/cases.csv"));
    assert_ne!(read("cases.csv"), read("cases_before.csv"));
}

/// Commands that do not support cars refuse them with a message.
#[test]
fn other_commands_refuse_cars() {
    let car = studies().join("car.toml");
    let car = car.to_str().unwrap();
    let directory = tempfile::tempdir().unwrap();
    for command in ["kc", "setup", "assemblies"] {
        let refused = hardpoint(directory.path(), &[command, car]).code(2);
        let said = text(&refused.get_output().stderr);
        assert!(
            said.contains("[car] makes this the study of a car"),
            "{command}: {said}"
        );
        // The help names all commands that support cars.
        for supported in [
            "check",
            "convert",
            "report",
            "studio",
            "bench cars accept cars",
        ] {
            assert!(said.contains(supported), "{command}: {said}");
        }
    }
}

/// `--set` changes the studies of the axles too.
#[test]
fn changes_reach_the_axles() {
    let directory = tempfile::tempdir().unwrap();
    let car = studies().join("car.toml");
    let share = |set: &str| {
        let arguments = ["solve", car.to_str().unwrap(), "--out", "-", "--set", set];
        let said = hardpoint(directory.path(), &arguments).success();
        let csv = text(&said.get_output().stdout);
        let mut rows = csv.lines();
        let header: Vec<&str> = rows.next().unwrap().split(',').collect();
        let name = "lateral_load_transfer_distribution_percent";
        let column = header.iter().position(|column| *column == name).unwrap();
        let turn = rows.find(|row| row.starts_with("turn,")).unwrap();
        turn.split(',').nth(column).unwrap().parse::<f64>().unwrap()
    };
    let soft = share("front.anti_roll_bar.rate=300000.0");
    let stiff = share("front.anti_roll_bar.rate=1200000.0");
    assert!(stiff > soft + 3.0, "{soft} {stiff}");
}

/// `cases.csv` has columns of member loads, including the tie rod tension of each front wheel.
#[test]
fn member_loads_are_written() {
    let directory = tempfile::tempdir().unwrap();
    hardpoint(directory.path(), &["new", "car"]).success();
    let set = "outputs.member_loads=true";
    let said = hardpoint(
        directory.path(),
        &["solve", "car.toml", "--out", "-", "--set", set],
    );
    let csv = text(&said.success().get_output().stdout);
    let mut rows = csv.lines();
    let header: Vec<&str> = rows.next().unwrap().split(',').collect();
    assert_eq!(csv.lines().count(), 1 + 5);
    let columns = ["front_left_tie_rod_N", "rear_right_toe_link_N"];
    for name in columns {
        let column = header.iter().position(|column| *column == name).unwrap();
        let force = |row: &str| row.split(',').nth(column).unwrap().parse::<f64>();
        assert!(csv.lines().skip(1).all(|row| force(row).unwrap() != 0.0));
    }
    assert_eq!(header[header.len() - 2..], ["reason", "status"]);
}

/// A tuning of a car accepts several starts and refuses numbers out of range.
#[test]
fn starts_of_a_tuning_are_checked() {
    let directory = tempfile::tempdir().unwrap();
    hardpoint(directory.path(), &["new", "car"]).success();
    let check = |starts: &str, code: i32| {
        let set = format!("optimise.starts={starts}");
        let said = hardpoint(directory.path(), &["check", "car.toml", "--set", &set]);
        text(&said.code(code).get_output().stderr)
    };
    check("3", 0);
    let said = check("0", 2);
    assert!(said.contains("expected 1 to 10000 starts"), "{said}");
}

/// A tuning of a car refuses `--prices` instead of ignoring it.
#[test]
fn a_tuning_of_a_car_refuses_prices() {
    let directory = tempfile::tempdir().unwrap();
    hardpoint(directory.path(), &["new", "car"]).success();
    let refused = hardpoint(directory.path(), &["optimise", "car.toml", "--prices"]).code(2);
    let said = text(&refused.get_output().stderr);
    assert!(
        said.contains("--prices is not available for a car"),
        "{said}"
    );
    assert!(!directory.path().join("out").exists());
}

/// Values of a map equal the numbers that their decimal text represents.
#[test]
fn values_of_maps_are_decimals() {
    let directory = tempfile::tempdir().unwrap();
    hardpoint(directory.path(), &["new", "car"]).success();
    let range = "gg_map.ay={from=0.0,to=0.6,steps=7}";
    let one = "gg_map.ax={from=0.0,to=0.0,steps=1}";
    let run = [
        "solve", "car.toml", "--set", range, "--set", one, "--out", "run",
    ];
    hardpoint(directory.path(), &run).success();
    let map = fs::read(directory.path().join("run/gg.csv")).unwrap();
    let rows = crate::support::rows_by_column(&map);
    let values: Vec<&str> = rows.iter().map(|row| row["ay_g"].as_str()).collect();
    assert_eq!(values, ["0.0", "0.1", "0.2", "0.3", "0.4", "0.5", "0.6"]);
}

/// A remark names values of `[vehicle]` that contradict the car. Values that agree with the car give no remark.
#[test]
fn values_of_axles_that_contradict_the_car_are_named() {
    let directory = tempfile::tempdir().unwrap();
    let car = studies().join("car.toml");
    let said = |sets: &[&str]| {
        let mut arguments = vec!["check", car.to_str().unwrap()];
        for set in sets {
            arguments.extend(["--set", set]);
        }
        let said = hardpoint(directory.path(), &arguments).success();
        let said = text(&said.get_output().stdout) + &text(&said.get_output().stderr);
        one_line(&said)
    };
    // Statics: the front axle carries 1450 kg times (2650 - 1290)/2650 = 744 kg.
    let same = said(&[
        "front.vehicle.wheelbase=2650.0",
        "front.vehicle.sprung_mass=744.0",
    ]);
    assert!(!same.contains("the front study has other values"), "{same}");
    let other = said(&[
        "front.vehicle.wheelbase=2700.0",
        "front.vehicle.cg_height=700.0",
        "front.vehicle.sprung_mass=600.0",
    ]);
    let remark = "note: the front study has other values than the car: wheelbase 2700 mm (car: 2650 mm), cg_height 700 mm \
                  (car: 5";
    assert!(other.contains(remark), "{other}");
    assert!(other.contains("sprung_mass 600 kg (car: 74"), "{other}");
}

/// If equal longitudinal shares of the wheels prevent an equilibrium, the message names the key that a user can change. It
/// names no key if the change would not help.
#[test]
fn the_key_of_equal_shares_is_named() {
    let directory = tempfile::tempdir().unwrap();
    hardpoint(directory.path(), &["new", "car"]).success();
    let path = directory.path().join("car.toml");
    let good = fs::read_to_string(&path).unwrap();
    let (head, _) = good.split_once("[[cases]]").unwrap();
    let remedy = "set longitudinal_shares = \"by_load\"";
    let said = |keys: &str, code: i32| {
        fs::write(&path, format!("{head}[[cases]]\nname = \"a\"\n{keys}\n")).unwrap();
        let said = hardpoint(directory.path(), &["solve", "car.toml", "--force"]).code(code);
        let said = text(&said.get_output().stdout) + &text(&said.get_output().stderr);
        one_line(&said)
    };
    let words = said("ax = -2.435", 1);
    assert!(words.contains(remedy), "{words}");
    assert!(!words.contains("lateral_shares"), "{words}");
    said("ax = -2.435\nlongitudinal_shares = \"by_load\"", 0);
    // At this acceleration the car tips over with any shares, so the message names no key.
    for shares in ["", "longitudinal_shares = \"by_load\""] {
        let words = said(&format!("ay = 10.0\n{shares}"), 1);
        assert!(
            words.contains("the car tips over: the front left wheel and the rear left wheel lift"),
            "{words}"
        );
        assert!(!words.contains("share of a force"), "{words}");
    }
}
