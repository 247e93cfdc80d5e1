//! Tests of mistakes in the study of a car: the message names file, line and key.

use super::commands::{hardpoint, text};
use crate::support::studies;
use std::fs;

/// Replaces `from` in the study of the car by `to`. Asserts that the message names the file and says `said`.
fn assert_mistake(from: &str, to: &str, said: &str) {
    let directory = tempfile::tempdir().unwrap();
    hardpoint(directory.path(), &["new", "car"]).success();
    let path = directory.path().join("car.toml");
    // Removes `[sweep]`, so that mistakes can be inserted there.
    let good = fs::read_to_string(&path).unwrap();
    let (head, rest) = good.split_once("[sweep]").unwrap();
    let (_, tail) = rest.split_once("[optimise]").unwrap();
    let good = format!("{head}[optimise]{tail}");
    assert!(good.contains(from), "{from}");
    fs::write(&path, good.replacen(from, to, 1)).unwrap();
    let refused = hardpoint(directory.path(), &["check", "car.toml"]).code(2);
    let message = text(&refused.get_output().stderr);
    assert!(message.contains(said), "{from}: {message}");
    assert!(message.contains("car.toml:"), "{message}");
}

#[test]
fn mistakes_in_the_car_and_its_cases_are_named() {
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
            "rear = \"car_rear.toml\"",
            "rear = \"car_front.toml\"",
            "describes the other axle",
        ),
    ] {
        assert_mistake(from, to, said);
    }
}

#[test]
fn mistakes_in_targets_are_named() {
    for (from, to, said) in [
        (
            "case = \"turn\", value = 3.2",
            "case = \"trun\", value = 3.2",
            "unknown case \"trun\"",
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
    ] {
        assert_mistake(from, to, said);
    }
}

#[test]
fn mistakes_in_the_sweep_and_the_scatter_are_named() {
    for (section, said) in [
        (
            "[sweep]\nvariables = [{ car = \"mass\", percent = 10.0 }]",
            "car_mass needs the key \"steps\"",
        ),
        (
            "[sweep]\nmethod = \"sobol\"\nsamples = 4\nvariables = [{ car = \"mass\", percent = 10.0 }, { car = \"mass\", percent = 20.0 }]",
            "car_mass is already a variable",
        ),
        (
            "[tolerance]\nscatter = [{ axle = \"front\", hardpoint = \"tie_rod\", sigma = 0.1 }]",
            "unknown hardpoint \"tie_rod\"",
        ),
        (
            "[tolerance]\nscatter = [{ car = \"mass\", side = \"left\", sigma = 0.1 }]",
            "the key side is not available for a rate or a value of the car",
        ),
        (
            "[sweep]\nvariables = [{ axle = \"rear\", hardpoint = \"wheel_centre\", axis = \"x\", range = [-5.0, 5.0], steps = 3 }]",
            "[car] wheelbase fixes the distance of the axles",
        ),
        (
            "[tolerance]\nscatter = [{ car = \"mass\", sigma = 1.0 }]\nbands = [{ characteristic = \"roll\", case = \"turn\" }]",
            "expected one of between = [lowest, highest], at_least and at_most",
        ),
    ] {
        assert_mistake("[optimise]", &format!("{section}\n[optimise]"), said);
    }
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
            "cases",
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
