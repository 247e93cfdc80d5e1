//! Tests of studies of solid axles that the program refuses. The message states the reason.

use super::{STILL, case, study_of, text};
use hardpoint::study::Study;
use std::path::Path;

fn refusal(text: &str) -> String {
    match Study::from_text("solid.toml", text, Path::new("")) {
        Ok(_) => panic!("accepted:\n{text}"),
        Err(errors) => errors.to_string(),
    }
}

fn four_link() -> String {
    study_of(&case("solid_four_link"), STILL)
}

fn panhard() -> String {
    study_of(&case("solid_three_link_panhard"), STILL)
}

#[test]
fn five_links_are_refused_by_name() {
    let rod =
        "panhard_chassis = [-140.0, 480.0, 360.0]\npanhard_axle = [-140.0, -470.0, 330.0]\n[wheel]";
    let found = refusal(&four_link().replace("[wheel]", rod));
    assert!(found.contains("five links"), "{found}");
    assert!(found.contains("single = [\"upper_link\"]"), "{found}");
}

#[test]
fn links_that_do_not_hold_the_axle_sideways_are_refused() {
    let parallel = [
        ("lower_link_chassis", [540.0, 500.0, 305.0]),
        ("lower_link_axle", [0.0, 500.0, 255.0]),
        ("upper_link_chassis", [340.0, 300.0, 445.0]),
        ("upper_link_axle", [20.0, 300.0, 470.0]),
        ("wheel_centre", [0.0, 750.0, 330.0]),
    ];
    let found = refusal(&text(&parallel, false, STILL));
    assert!(found.contains("sideways"), "{found}");
    let without_rod = panhard();
    let lines = without_rod
        .lines()
        .filter(|line| !line.starts_with("panhard_"));
    let found = refusal(&lines.collect::<Vec<_>>().join("\n"));
    assert!(found.contains("three links"), "{found}");
}

#[test]
fn motions_and_parts_of_other_axles_are_refused() {
    for (motion, reason) in [
        ("[motion]\ntravel = [0.0]\n", "two travels"),
        ("[motion]\nheave = [0.0]\nrack = [5.0]\n", "no rack"),
        (
            "[motion]\nheave = [0.0]\n[outputs]\ncharacteristics = [\"ackermann\"]\n",
            "solid axle",
        ),
        (
            "[motion]\nheave = [0.0]\n[outputs]\ncharacteristics = [\"camber_gain\"]\n",
            "solid axle",
        ),
        (
            "[motion]\nheave = [0.0]\n[axle.right.hardpoints]\nlower_link_axle = [0.0, -500.0, 255.0]\n[axle.right.wheel]\nstatic_toe = 0.1\n",
            "leave [axle.right.wheel] out",
        ),
        (
            "[motion]\nheave = [0.0]\n[axle.right.hardpoints]\npanhard_axle = [-140.0, -470.0, 330.0]\n",
            "has only one",
        ),
    ] {
        let found = refusal(&panhard().replace(STILL, motion));
        assert!(found.contains(reason), "{motion}: {found}");
    }
}

/// Points for both kinds of Watt linkage, on an axle with a single upper link.
const WATT: &str = "watt_pivot = [-150.0, 0.0, 340.0]\nwatt_axis = [-100.0, 0.0, 340.0]\n\
    watt_upper_chassis = [-150.0, 480.0, 400.0]\nwatt_upper_rocker = [-150.0, 0.0, 410.0]\n\
    watt_lower_chassis = [-150.0, -480.0, 280.0]\nwatt_lower_rocker = [-150.0, 0.0, 270.0]\n";

fn with_watt(text: &str) -> String {
    let lines = text.lines().filter(|line| !line.starts_with("panhard_"));
    let text: String = lines.map(|line| format!("{line}\n")).collect();
    text.replace("[wheel]", &format!("{WATT}[wheel]"))
}

/// The lower link of a Watt linkage is at the axle, the upper link at the body. The message names one hardpoint of each
/// kind. The rocker's pivot belongs to both kinds, so the message does not name it.
#[test]
fn links_of_two_kinds_of_watt_linkages_are_named() {
    let mixed = with_watt(&panhard()).replace("watt_lower_chassis", "watt_lower_axle");
    let found = refusal(&mixed);
    let reason = "watt_lower_axle and watt_upper_chassis are both given: expected only one of them for \
        the Watt linkage";
    assert!(found.contains(reason), "{found}");
}

#[test]
fn watt_linkages_are_refused_where_they_do_not_fit() {
    let proved = with_watt(&panhard()).replace(
        STILL,
        "[motion]\nheave = [0.0]\n[outputs]\ncertify = true\ncharacteristics = [\"camber\"]\n",
    );
    let found = refusal(&proved);
    assert!(found.contains("quadratic"), "{found}");
    let both = panhard().replace("[wheel]", &format!("{WATT}[wheel]"));
    let found = refusal(&both);
    assert!(found.contains("expected one of them"), "{found}");
    let found = refusal(&four_link().replace("[wheel]", &format!("{WATT}[wheel]")));
    assert!(
        found.contains("five links") && found.contains("Watt linkage"),
        "{found}"
    );
    let part = WATT.replace("watt_axis = [-100.0, 0.0, 340.0]\n", "");
    let found = refusal(&with_watt(&panhard()).replace(WATT, &part));
    assert!(found.contains("watt_axis"), "{found}");
}

/// The program refuses quantities of solid axles for axles of other kinds.
#[test]
fn quantities_of_solid_axles_need_one() {
    let text = include_str!("../../../studies/macpherson_axle.toml");
    let study = Study::from_text("axle.toml", text, Path::new("")).unwrap();
    assert!(
        study
            .axle()
            .unwrap()
            .axle
            .quantities("pinion_angle")
            .is_empty()
    );
    assert_eq!(study.axle().unwrap().axle.quantities("anti_dive").len(), 2);
}
