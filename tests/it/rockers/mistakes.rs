//! Tests of mistakes in the points and bodies of rockers, anti-roll bars and springs.

use super::{read, run, sample, with_lines};
use crate::support::one_line;
use hardpoint::study::Study;

/// Replaces the line of the sample that begins with `start`. Asserts that the study then has one mistake, on the line that
/// begins with `on`, and that the message has these phrases.
fn assert_mistake(start: &str, becomes: &str, on: &str, phrases: &[&str]) {
    let text = with_lines(&[(start, becomes)]);
    let errors = read(&text).expect_err(becomes);
    let said = errors.render(false);
    assert_eq!(errors.all().len(), 1, "{said}");
    let (number, _) = errors.all()[0].position().unwrap();
    let found = text.lines().nth(number - 1).unwrap();
    assert!(
        found.starts_with(on),
        "expected the line with {on}:\n{said}"
    );
    for phrase in phrases {
        let phrase = one_line(phrase);
        assert!(said.contains(&phrase), "expected {phrase:?}:\n{said}");
    }
}

/// Points of rockers, bars and springs that are missing, given twice or in impossible positions.
#[test]
fn mistakes_in_points_are_named() {
    let sample = sample();
    let pushrod_outer = sample.lines().find(|l| l.starts_with("pushrod_outer"));
    let pushrod_outer = pushrod_outer.unwrap();
    let pullrod =
        pushrod_outer.replace("pushrod_outer     ", "pullrod_outer") + "\n" + pushrod_outer;
    for (start, becomes, on, phrases) in [
        (
            "rocker_pivot_rear",
            "",
            "pushrod_outer",
            &[
                "missing for the rocker: rocker_pivot_rear (rear point of the rocker's axis on the body)",
                "or none",
            ][..],
        ),
        (
            "pushrod_inner",
            "",
            "pushrod_outer",
            &["missing for the rocker: pushrod_inner (pushrod at the rocker)"],
        ),
        (
            "pushrod_outer",
            &pullrod,
            "pullrod_outer",
            &[
                "pullrod_outer and pushrod_outer are both given: expected only one of them for the rocker",
            ],
        ),
        (
            "drop_link_inner",
            "",
            "drop_link_outer",
            &["missing for the anti-roll bar: drop_link_inner"],
        ),
        (
            "spring_upper",
            "",
            "spring_lower",
            &["missing for the spring: spring_upper"],
        ),
        (
            "rocker_pivot_rear",
            "rocker_pivot_rear = [20.0, 205.0, 420.0]",
            "rocker_pivot_rear",
            &[
                "rocker_pivot_rear coincides with rocker_pivot_front: they define the axis of the rocker",
            ],
        ),
        (
            "pushrod_inner",
            "pushrod_inner = [0.0, 530.0, 155.0]",
            "pushrod_inner",
            &["the pushrod would have no length"],
        ),
        (
            "pushrod_inner",
            "pushrod_inner = [0.0, 205.0, 420.0]",
            "pushrod_inner",
            &[
                "pushrod_inner lies on the line through rocker_pivot_front and rocker_pivot_rear, so it has no lever arm to turn the rocker",
            ],
        ),
        // The lever points from the rocker's pivot straight towards the outer end of the rod.
        (
            "pushrod_inner",
            "pushrod_inner = [0.0, 270.0, 367.0]",
            "pushrod_inner",
            &[
                "the pushrod is at toggle in the design position: pushrod_outer, pushrod_inner and the axis from \
               rocker_pivot_front to rocker_pivot_rear lie in one plane, so it cannot turn the rocker",
            ],
        ),
    ] {
        assert_mistake(start, becomes, on, phrases);
    }
}

/// Rods and links on unknown bodies, on bodies that cannot carry them, or without their points.
#[test]
fn mistakes_in_bodies_are_named() {
    for (becomes, on, phrases) in [
        (
            "drop_link_outer = \"roker\"",
            "drop_link_outer =",
            &["unknown body \"roker\"", "rocker"][..],
        ),
        (
            "drop_link_outer = \"anti_roll_bar\"",
            "drop_link_outer =",
            &["unknown body \"anti_roll_bar\""],
        ),
        (
            "pushrod_outer = \"rocker\"",
            "pushrod_outer =",
            &["unknown body \"rocker\""],
        ),
        (
            "wheel_centre = \"rocker\"",
            "wheel_centre =",
            &[
                "wheel_centre has a fixed body in every double_wishbone",
                "outer ends",
            ],
        ),
        (
            "pullrod_outer = \"knuckle\"",
            "pullrod_outer =",
            &["this study does not give pullrod_outer"],
        ),
        (
            "damper = \"knuckle\"",
            "damper =",
            &["double_wishbone has no hardpoint \"damper\""],
        ),
    ] {
        assert_mistake("drop_link_outer =", becomes, on, phrases);
    }
}

/// Outputs that need a rocker or a bar are refused without one.
#[test]
fn outputs_without_their_parts_are_refused() {
    let plain = crate::support::studies().join("double_wishbone_solve.toml");
    for (name, needs) in [
        ("rocker_angle", "a rocker with its pushrod or pullrod"),
        (
            "anti_roll_bar_motion_ratio",
            "an anti-roll bar with its drop link",
        ),
    ] {
        let asked = format!("outputs.characteristics=[\"{name}\"]");
        let said = Study::read(&plain, &[asked]).unwrap_err().render(false);
        assert!(
            said.contains(&format!(
                "{name} needs {needs}, which this study does not give"
            )),
            "{said}"
        );
    }
}

/// If the study does not name the body of a drop link, the program uses the nearest body, if this is clear. It reports
/// this choice. If the study names the body, the program uses it without a message. With the drop link on the lower arm,
/// the bar of this study would turn less than half as far.
#[test]
fn a_drop_link_beside_a_rocker_is_never_assumed_silently() {
    let said = "drop_link_outer = \"rocker\"";
    let ratio = |text: &str| {
        let (study, found, _) = run(text);
        let columns = &found.columns;
        let ratio = columns
            .iter()
            .position(|c| c.output == "anti_roll_bar_motion_ratio");
        let middle = &found.stations[found.stations.len() / 2];
        let doubts = hardpoint::report::plausibility(study.wheel()).unwrap();
        (middle.values[ratio.unwrap()].unwrap(), doubts)
    };
    let outputs = (
        "characteristics",
        "characteristics = [\"anti_roll_bar_motion_ratio\"]",
    );
    let named = with_lines(&[outputs]);
    assert!(named.contains(said));
    let (wanted, doubts) = ratio(&named);
    assert!(
        !doubts.iter().any(|d| d.contains("drop_link_outer")),
        "{doubts:?}"
    );
    let (unnamed, doubts) = ratio(&named.replace(said, ""));
    assert_eq!(unnamed, wanted);
    let doubt = doubts
        .iter()
        .find(|d| d.contains("drop_link_outer"))
        .unwrap();
    for words in [
        "Assumed: rocker",
        "lower arm",
        "[suspension.bodies]",
        " mm away",
    ] {
        assert!(doubt.contains(words), "{doubt}");
    }
    // A point on the body itself has the distance 0.
    let at_rod = named
        .replace(said, "")
        .replace("[ -30.0,  160.0,  420.0]", "[   0.0,  265.0,  455.0]");
    let (_, doubts) = ratio(&at_rod);
    assert!(
        doubts.iter().any(|d| d.contains("rocker (0 mm away)")),
        "{doubts:?}"
    );
    let on_arm = named.replace(said, "drop_link_outer = \"lower_arm\"");
    let (arm, doubts) = ratio(&on_arm);
    assert!(
        !doubts.iter().any(|d| d.contains("drop_link_outer")),
        "{doubts:?}"
    );
    assert!(wanted.abs() > 2.0 * arm.abs(), "{wanted} {arm}");
    // A drop link near the lower arm is attached to that arm, and the program reports this too.
    let low = named
        .replace(said, "")
        .replace("[ -30.0,  160.0,  420.0]", "[ -30.0,  430.0,  150.0]")
        .replace("[ -30.0,  155.0,  330.0]", "[ -30.0,  425.0,  330.0]");
    let study = read(&low).unwrap();
    let mechanism = &study.wheel().mechanism;
    let link = mechanism.point("drop_link_outer").unwrap();
    assert!(matches!(
        mechanism.body(link),
        hardpoint::model::Body::Arm(_)
    ));
    let doubts = hardpoint::report::plausibility(study.wheel()).unwrap();
    assert!(
        doubts.iter().any(|d| d.contains("Assumed: lower arm")),
        "{doubts:?}"
    );
    // If points move far enough, the program attaches the drop link to another body. If the points do not move, the body
    // stays the same.
    let high = read(&named.replace(said, "")).unwrap();
    let (high, low) = (high.wheel(), study.wheel());
    assert!(high.mechanism.keeps_drop_link(&high.design));
    assert!(low.mechanism.keeps_drop_link(&low.design));
    assert!(!high.mechanism.keeps_drop_link(&low.design));
    assert!(!low.mechanism.keeps_drop_link(&high.design));
    assert!(
        read(&named)
            .unwrap()
            .wheel()
            .mechanism
            .keeps_drop_link(&low.design)
    );
}
