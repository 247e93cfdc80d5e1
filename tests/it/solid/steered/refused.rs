//! Tests of studies of steered axles that the program refuses. The message states the reason.

use super::{random, study};
use crate::support::random::Random;
use hardpoint::study::Study;
use std::path::Path;

fn refusal(text: &str) -> String {
    match Study::from_text("steered.toml", text, Path::new("")) {
        Ok(_) => panic!("accepted:\n{text}"),
        Err(errors) => errors.to_string(),
    }
}

const STILL: &str = "[motion]\nheave = [0.0]\n";

fn steered(further: &str) -> String {
    study(&random(&mut Random(466), true, 10.0), further)
}

#[test]
fn keys_that_a_drag_link_does_not_have_are_refused() {
    let outputs = "[outputs]\ncharacteristics = [\"steer\"]\n";
    for (further, reason) in [
        (
            "[motion]\nheave = [0.0]\nsteering_wheel_angle = [90.0]\n".to_owned(),
            "expected the key \"rack\"",
        ),
        (
            format!("{STILL}{outputs}certify = true\n"),
            "knuckles of a steered axle",
        ),
        (
            format!("{STILL}[outputs]\ncharacteristics = [\"steering_ratio\"]\n"),
            "independently suspended wheels",
        ),
        (
            format!("{STILL}[axle.right.hardpoints]\ndrag_link_body = [190.0, 400.0, 545.0]\n"),
            "has only one",
        ),
        (
            format!(
                "{STILL}[compliance]\nrelaxed = \"free\"\n[links.panhard]\naxial_stiffness = 1.0e5\n"
            ),
            "elastic parts are not available for a steered solid axle",
        ),
    ] {
        let found = refusal(&steered(&further));
        assert!(found.contains(reason), "{further}: {found}");
    }
}

#[test]
fn sections_and_points_that_do_not_fit_are_refused() {
    let sound = steered(STILL);
    let line = |name: &str| {
        let found = sound.lines().find(|line| line.starts_with(name));
        format!("{}\n", found.unwrap())
    };
    let direction = line("direction");
    for (from, to, reason) in [
        (
            direction.clone(),
            "c_factor = 50.0\n".to_owned(),
            "only the key \"direction\"",
        ),
        (
            direction.clone(),
            "direction = [0.0, 0.0, 0.0]\n".to_owned(),
            "has length 0",
        ),
        (
            direction.clone(),
            "direction = [0.0, 1.0]\n".to_owned(),
            "three components",
        ),
        (line("tie_rod_end"), String::new(), "tie_rod_end"),
        (
            line("drag_link_knuckle"),
            "drag_link_knuckle = [160.0, -560.0, 480.0]\n".to_owned(),
            "left knuckle",
        ),
    ] {
        let text = sound.replacen(&from, &to, 1);
        assert_ne!(text, sound);
        let found = refusal(&text);
        assert!(found.contains(reason), "{to}: {found}");
    }
    let steering = ["kingpin_", "drag_link_", "tie_rod_end"];
    let lines = sound
        .lines()
        .filter(|line| !steering.iter().any(|name| line.starts_with(name)));
    let without: String = lines.map(|line| format!("{line}\n")).collect();
    let found = refusal(&without);
    assert!(found.contains("no drag link"), "{found}");
    let found = refusal(&without.replacen(&direction, "", 1));
    assert!(found.contains("needs its drag link"), "{found}");
}

/// The program refuses a kingpin through the end of the drag link, because the arm of the drag link then has zero length.
#[test]
fn arms_without_a_length_are_refused() {
    let world = random(&mut Random(467), true, 10.0);
    let mut inline = world.clone();
    let place = |name: &str| world.at(name);
    let (upper, lower) = (place("kingpin_upper"), place("kingpin_lower"));
    let middle = [0, 1, 2].map(|k| (upper[k] + lower[k]).scaled(0.5));
    for (name, point) in &mut inline.points {
        if *name == "drag_link_knuckle" {
            *point = middle;
        }
    }
    let found = refusal(&study(&inline, STILL));
    assert!(found.contains("left knuckle"), "{found}");
}
