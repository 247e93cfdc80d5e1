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

/// The program names mistakes with file, line and key.
#[test]
fn mistakes_are_named() {
    let directory = tempfile::tempdir().unwrap();
    hardpoint(directory.path(), &["new", "car"]).success();
    let path = directory.path().join("car.toml");
    // Removes `[sweep]`, so that mistakes can be inserted there.
    let good = fs::read_to_string(&path).unwrap();
    let (head, rest) = good.split_once("[sweep]").unwrap();
    let (_, tail) = rest.split_once("[optimise]").unwrap();
    let good = format!("{head}[optimise]{tail}");
    for (from, to, said) in [
        (
            "wheelbase = 2650.0",
            "wheelbas = 2650.0",
            "unknown key \"wheelbas\"",
        ),
        (
            "name = \"braking\"",
            "name = \"static\"",
            "other than front, rear, left, right and static",
        ),
        (
            "brake_share_front = 0.68",
            "",
            "needs brake_share_front in [car]",
        ),
        (
            "sprung_mass = 1450.0",
            "mass = 1450.0",
            "expected mass with cg of the whole car",
        ),
        (
            "case = \"turn\", value = 3.2",
            "case = \"trun\", value = 3.2",
            "unknown case \"trun\"",
        ),
        (
            "rear = \"car_rear.toml\"",
            "rear = \"car_front.toml\"",
            "describes the other axle",
        ),
        (
            "characteristic = \"roll_gradient\"",
            "characteristic = \"rol_gradient\"",
            "did you mean \"roll_gradient\"? docs/car.md lists",
        ),
        (
            "characteristic = \"roll_gradient\"",
            "characteristic = \"roll_angle\"",
            "did you mean \"roll\"? docs/car.md lists",
        ),
        (
            "characteristic = \"lateral_load_transfer_distribution\", case = \"turn\"",
            "characteristic = \"lltd\", case = \"turn\"",
            "did you mean \"lateral_load_transfer_distribution\"? docs/car.md lists",
        ),
        (
            "characteristic = \"roll_gradient\"",
            "characteristic = \"qqq\"",
            "help: docs/car.md lists the results of a car",
        ),
        (
            "characteristic = \"lateral_load_transfer_distribution\", case = \"turn\"",
            "characteristic = \"lateral_load_transfer_distribution\", case = \"braking\"",
            "at ay = 0 no load is transferred",
        ),
        (
            "value = 3.2,",
            "",
            "expected one of between = [lowest, highest], at_least and at_most",
        ),
        (
            "value = 3.2,",
            "value = 3.2, at_least = 3.0,",
            "expected one of the keys \"value\", \"between\", \"at_least\" and \"at_most\"",
        ),
        (
            "[optimise]",
            "[sweep]\nvariables = [{ car = \"mass\", percent = 10.0 }]\n[optimise]",
            "car_mass needs the key \"steps\"",
        ),
        (
            "[optimise]",
            "[sweep]\nmethod = \"sobol\"\nsamples = 4\nvariables = [{ car = \"mass\", percent = 10.0 }, { car = \"mass\", percent = 20.0 }]\n[optimise]",
            "car_mass is already a variable",
        ),
        (
            "[optimise]",
            "[tolerance]\nscatter = [{ axle = \"front\", hardpoint = \"tie_rod\", sigma = 0.1 }]\n[optimise]",
            "unknown hardpoint \"tie_rod\"",
        ),
        (
            "[optimise]",
            "[tolerance]\nscatter = [{ car = \"mass\", side = \"left\", sigma = 0.1 }]\n[optimise]",
            "the key side is not available for a rate or a value of the car",
        ),
        (
            "[optimise]",
            "[sweep]\nvariables = [{ axle = \"rear\", hardpoint = \"wheel_centre\", axis = \"x\", range = [-5.0, 5.0], steps = 3 }]\n[optimise]",
            "[car] wheelbase fixes the distance of the axles",
        ),
        (
            "[optimise]",
            "[tolerance]\nscatter = [{ car = \"mass\", sigma = 1.0 }]\nbands = [{ characteristic = \"roll\", case = \"turn\" }]\n[optimise]",
            "expected one of between = [lowest, highest], at_least and at_most",
        ),
    ] {
        assert!(good.contains(from), "{from}");
        fs::write(&path, good.replacen(from, to, 1)).unwrap();
        let refused = hardpoint(directory.path(), &["check", "car.toml"]).code(2);
        let message = text(&refused.get_output().stderr);
        assert!(message.contains(said), "{from}: {message}");
        assert!(message.contains("car.toml:"), "{message}");
    }
}

/// A case cannot displace the rack of an unsteered axle.
#[test]
fn a_rack_needs_something_to_steer() {
    let directory = tempfile::tempdir().unwrap();
    for file in [
        "off_road_car.toml",
        "off_road_car_front.toml",
        "off_road_car_rear.toml",
    ] {
        fs::copy(studies().join(file), directory.path().join(file)).unwrap();
    }
    let path = directory.path().join("off_road_car.toml");
    let good = fs::read_to_string(&path).unwrap();
    for (rear, is_refused) in [("0.0", false), ("5.0", true)] {
        let both = format!("rack = 25.0\nrack_rear = {rear}\n#");
        fs::write(&path, good.replacen("rack = 25.0 ", &both, 1)).unwrap();
        let code = if is_refused { 2 } else { 0 };
        let checked = hardpoint(directory.path(), &["check", "off_road_car.toml"]).code(code);
        let said = text(&checked.get_output().stderr);
        assert_eq!(
            said.contains("the rear axle is not steered"),
            is_refused,
            "{said}"
        );
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

/// The program refuses meaningless inputs of cars, with the location and the reason.
#[test]
fn wrong_inputs_of_cars_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    hardpoint(directory.path(), &["new", "car"]).success();
    let good = fs::read_to_string(directory.path().join("car.toml")).unwrap();
    let axle = fs::read_to_string(directory.path().join("car_front.toml")).unwrap();
    let case = "\n[[cases]]\nname = \"odd\"\n";
    let with_case = |line: &str| format!("{good}{case}{line}\n");
    let ay = "ay = { from = 0.0, to = 0.8, steps = 5 }";
    let with_map = |line: &str| good.replace(ay, line);
    // The template gives the sprung mass.
    let with_cg = |point: &str| {
        let line = good.lines().find(|line| line.starts_with("sprung_cg = "));
        let whole = good.replace(line.expect("a centre of gravity"), &format!("cg = {point}"));
        whole.replace("sprung_mass = ", "mass = ")
    };
    for (text, place, reason) in [
        (
            with_case("speed = -50.0"),
            "cases[4].speed",
            "expected a speed of 0 or more, found -50",
        ),
        (
            with_case("lateral_share_left = [0.5, 1.2]"),
            "cases[4].lateral_share_left",
            "expected shares from 0 to 1, found 1.2",
        ),
        (
            with_cg("[-1200.0, 0.0, -520.0]"),
            "car.cg",
            "below the ground; does z have the wrong sign?",
        ),
        (
            good.replace("5.0, 560.0]", "5.0, -560.0]"),
            "car.sprung_cg",
            "below the ground",
        ),
        (
            with_cg("[1200.0, 0.0, 520.0]"),
            "car.cg",
            "ahead of the front axle, so the rear wheels would lift",
        ),
        (
            with_cg("[-9200.0, 0.0, 520.0]"),
            "car.cg",
            "behind the rear axle, so the front wheels would lift",
        ),
        (
            with_map("ay = { from = 0.0, to = 0.8, steps = 1 }"),
            "gg_map.ay.steps",
            "one step cannot reach from 0 to 0.8",
        ),
        (
            with_map("ay = { from = 0.8, to = 0.0, steps = 5 }"),
            "gg_map.ay.from",
            "the range is reversed",
        ),
        (
            with_map(&format!("{ay}\nspeed = -1.0")),
            "gg_map.speed",
            "0 or more",
        ),
        (
            good.replace("\"car_front.toml\"", "\"car.toml\""),
            "car.front",
            "expected the study of an axle, found the study of a car",
        ),
        (
            good.replace("\"car_front.toml\"", "\"absent.toml\""),
            "car.front",
            "absent.toml cannot be read: the file does not exist",
        ),
        (
            format!("{axle}{case}"),
            "cases[0]",
            "[cases] is a section of the study of a car, which also has a section [car]",
        ),
    ] {
        fs::write(directory.path().join("odd.toml"), &text).unwrap();
        let refused = hardpoint(directory.path(), &["check", "odd.toml"]).code(2);
        let said = super::commands::text(&refused.get_output().stderr);
        assert!(
            said.contains(place) && said.contains(reason) && said.contains("odd.toml:"),
            "{place}: {said}"
        );
    }
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
