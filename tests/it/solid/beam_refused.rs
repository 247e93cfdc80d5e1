//! Tests of studies of twist beams that the program refuses, and of the reasons of stations beyond the range of heave.

use super::STILL;
use super::twist_beam::random;
use crate::support::random::Random;
use hardpoint::study::Study;
use std::path::Path;

/// The program refuses entries that have no meaning for a twist beam, and states the reason.
#[test]
fn what_a_twist_beam_lacks_is_refused() {
    let beam = random(&mut Random(77));
    let outputs = |of: &str| format!("{STILL}[outputs]\n{of}\n");
    let quantity = |name: &str| outputs(&format!("characteristics = [\"{name}\"]"));
    for (further, reason) in [
        (quantity("axle_steer"), "needs a solid axle"),
        (quantity("roll_centre_height"), "twist beam"),
        (quantity("anti_roll_bar_angle"), "twist beam"),
        (outputs("certify = true"), "hinge"),
        (
            format!("{STILL}[anti_roll_bar]\nrate = 1.0e5\n"),
            "torsional_rate",
        ),
    ] {
        let text = beam.text(&further);
        let errors = Study::from_text("beam.toml", &text, Path::new("")).unwrap_err();
        assert!(errors.to_string().contains(reason), "{further}: {errors}");
    }
    let mut aside = beam.clone();
    aside.shear_centre[1] = 1.0;
    let mut on_line = beam.clone();
    on_line.shear_centre = [beam.mount[0], 0.0, beam.mount[2]];
    let mut near_line = on_line.clone();
    near_line.shear_centre[2] += 0.25;
    let mut of_right = beam.clone();
    of_right.mount[1] *= -1.0;
    for (beam, reason) in [
        (aside, "y = 0"),
        (
            of_right,
            "is not on the left side of the car: expected the coordinates of the left mount",
        ),
        (on_line, "lies 0 mm from the line through both mounts"),
        (near_line, "lies 0.25 mm from the line through both mounts"),
    ] {
        let errors = Study::from_text("beam.toml", &beam.text(STILL), Path::new("")).unwrap_err();
        assert!(errors.to_string().contains(reason), "{errors}");
    }
}

/// Below the sample's range, the arms become vertical. Above the range, a second solution with twisted halves branches off from
/// the solution with equal halves. This happens 3 degrees before the arms are vertical. Every station beyond an end of the
/// range has the same reason, whatever stopped the solver. No reason names links, because a twist beam has none.
#[test]
fn heaves_beyond_the_range_have_one_reason_at_each_end() {
    let text = include_str!("../../../studies/twist_beam_solve.toml");
    let start = text.find("roll = {").unwrap();
    let end = text[start..].find("\n[outputs]").unwrap() + start;
    for (heaves, reason) in [
        ("-900.0, -600.0, -590.0, -372.0", "the arms are vertical"),
        (
            "451.38, 451.5, 451.8, 452.0, 600.0, 900.0",
            "the path meets another assembly there",
        ),
    ] {
        let stations = heaves.split(',').count();
        let heaves = format!("heave = [{heaves}]\n");
        let text = format!("{}{heaves}{}", &text[..start], &text[end..]);
        let study = Study::from_text("beam.toml", &text, Path::new("")).unwrap();
        let failures = hardpoint::solved::Solved::of(&study).unwrap().failures();
        let failed: usize = failures.iter().map(|range| range.stations()).sum();
        assert_eq!(failed, stations);
        for failure in failures.iter().map(ToString::to_string) {
            assert!(failure.contains(reason), "{failure}");
        }
    }
}
