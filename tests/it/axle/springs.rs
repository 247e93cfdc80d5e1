//! Force curves of springs and bump stops, between and beyond their points.

use super::commands::{run, study};
use hardpoint::axle::ForceCurve;

/// The manual's example, by hand: slopes 176/3 and 3850/23 at the neighbours of 15 mm, so that the cubic is below the straight
/// line by 1.25 of their difference.
#[test]
fn a_force_curve_is_the_cubic_that_the_manual_describes() {
    let points = [[0.0, 0.0], [10.0, 400.0], [20.0, 1500.0], [30.0, 5000.0]];
    let curve = ForceCurve::through(&points).unwrap();
    let at = |x: f64| -> f64 { curve.at(x) };
    let wanted: f64 = 950.0 + 1.25 * (176.0 / 3.0 - 3850.0 / 23.0);
    assert!((at(15.0) - wanted).abs() < 1e-10, "{}", at(15.0));
    assert!((wanted - 814.0).abs() < 0.1);
    // Beyond the ends it goes on with the slopes of its first and last pair of points.
    assert!((at(34.0) - (5000.0 + 4.0 * 350.0)).abs() < 1e-9);
    assert!((at(-3.0) + 3.0 * 40.0).abs() < 1e-9);
}

/// A motion that goes beyond the points of a curve is doubted, with the travel and both lengths; one that does not is not.
#[test]
fn travels_beyond_a_force_curve_are_named() {
    let path = study("macpherson_axle.toml");
    let path = path.to_str().unwrap();
    let outputs = "outputs.characteristics=[\"wheel_load\"]";
    let check = |more: &[&str]| {
        let mut arguments = vec!["check", path, "--set", outputs];
        arguments.extend(more.iter().flat_map(|set| ["--set", set]));
        let (said, doubts) = run(&arguments, 0);
        (said + &doubts)
            .split_whitespace()
            .collect::<Vec<_>>()
            .join(" ")
    };
    let motion = "motion={ travel_left = [0.0, 60.0], travel_right = [-10.0, 20.0] }";
    let short =
        "bump_stop={ gap = 20.0, force_curve = [[0.0, 0.0], [10.0, 400.0], [20.0, 1500.0]] }";
    let said = check(&[motion, short]);
    assert!(
        said.contains("left wheel at travel 60 mm: the bump stop is compressed by"),
        "{said}"
    );
    assert!(
        said.contains("beyond the end of its force_curve at 20 mm"),
        "{said}"
    );
    assert!(!said.contains("right wheel at travel"), "{said}");
    let long =
        "bump_stop={ gap = 20.0, force_curve = [[0.0, 0.0], [10.0, 400.0], [60.0, 9000.0]] }";
    let said = check(&[motion, long]);
    assert!(!said.contains("force_curve at"), "{said}");
    // The strut is 483 mm long in the design position, and longer in droop.
    let spring = "spring={ force_curve = [[420.0, 6000.0], [485.0, 3800.0]] }";
    let said = check(&[motion, long, spring]);
    assert!(
        said.contains("right wheel at travel -10 mm: the spring is"),
        "{said}"
    );
    assert!(
        said.contains("beyond the end of its force_curve at 485 mm"),
        "{said}"
    );
}
