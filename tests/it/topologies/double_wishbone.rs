//! Tests of the double wishbone, which the program solves in closed form.

use super::truth::Errors;
use super::{characteristics, template, travel};
use crate::support::random::Random;
use hardpoint::characteristics::Characteristic;
use hardpoint::number::Vector3;

#[test]
fn random_designs_agree_with_thirty_digits() {
    random_designs(2_500);
}

#[test]
#[ignore = "10,000 designs: with .ci/long"]
fn ten_thousand_random_designs_agree_with_thirty_digits() {
    random_designs(10_000);
}

/// Compares `designs` random designs with the reference. They are scattered around the template, each at one position
/// within +-80 mm travel and +-40 mm rack.
fn random_designs(designs: usize) {
    let suspension = template("double_wishbone");
    let mut random = Random(1);
    let mut errors = Errors::default();
    for i in 0..designs {
        let design = random.scattered(&suspension.design, 40.0);
        let (value, rack) = (80.0 * random.signed(), 40.0 * random.signed());
        errors.check(&suspension.mechanism, &design, value, rack, i % 100 == 0);
    }
    println!("{errors:?}");
    assert_eq!(errors.disagreed, 0);
    assert!(10 * errors.solved > 9 * designs, "{errors:?}");
    // In ten thousand designs, the largest errors of positions, first and second derivatives are 1.7e-15, 2.5e-14 and 9.1e-14.
    // The largest error of sensitivities is 3.7e-12.
    assert!(errors.by_order[0].0 < 1e-13, "{errors:?}");
    for e in [errors.by_order[1], errors.by_order[2]] {
        assert!(e.0 < 1e-12, "{errors:?}");
    }
    for e in errors.sensitivities {
        assert!(e.0 < 1e-10, "{errors:?}");
    }
}

/// In the design position all characteristics of wheel and steering axis follow directly from the hardpoints.
#[test]
fn static_characteristics_are_those_of_the_hardpoints() {
    let suspension = template("double_wishbone");
    let mechanism = &suspension.mechanism;
    let mut random = Random(2);
    for _ in 0..100 {
        let design = random.scattered(&suspension.design, 20.0);
        let p = |name: &str| design[mechanism.point(name).unwrap().0];
        let (lower, upper) = (p("lower_ball_joint"), p("upper_ball_joint"));
        let (centre, inner) = (p("wheel_centre"), p("spindle_inner"));
        let k = upper - lower;
        let spin = centre - inner;
        let length = (spin.x * spin.x + spin.y * spin.y + spin.z * spin.z).sqrt();
        let level = (spin.x * spin.x + spin.y * spin.y).sqrt();
        // The contact point is one radius below the wheel centre, in the wheel plane.
        let radius = suspension.wheel_radius.unwrap();
        let (sine, cosine) = (spin.z / length, level / length);
        let contact = Vector3::new(
            centre.x + radius * sine * spin.x / level,
            centre.y + radius * sine * spin.y / level,
            centre.z - radius * cosine,
        );
        let on_axis = |z: f64| lower + k * ((z - lower.z) / k.z);
        let ground = on_axis(contact.z) - contact;
        let (ahead, outboard) = (
            Vector3::new(spin.y / level, -spin.x / level, 0.0),
            Vector3::new(spin.x / level, spin.y / level, 0.0),
        );
        let expected = [
            (Characteristic::Camber, -(spin.z / length).asin()),
            (Characteristic::Toe, (spin.x / spin.y).atan()),
            (Characteristic::Caster, (-k.x / k.z).atan()),
            (Characteristic::KingpinInclination, (-k.y / k.z).atan()),
            (
                Characteristic::ScrubRadius,
                -(ground.x * outboard.x + ground.y * outboard.y),
            ),
            (
                Characteristic::CasterTrail,
                ground.x * ahead.x + ground.y * ahead.y,
            ),
            (
                Characteristic::KingpinOffset,
                centre.y - on_axis(centre.z).y,
            ),
            (Characteristic::SpindleTrail, on_axis(centre.z).x - centre.x),
            (Characteristic::HalfTrackChange, 0.0),
            (Characteristic::WheelbaseChange, 0.0),
        ];
        let wanted = expected.map(|(c, _)| c);
        let found = characteristics(&suspension, &design, travel(0.0, 0.0), &wanted).unwrap();
        for (found, (c, expected)) in found.iter().zip(expected) {
            // The bound covers rounding of lengths of some hundred millimetres and of angles of some tenths of a
            // radian.
            let error = (found[0] - expected).abs();
            assert!(error < 1e-12, "{}: {error:e}", c.info().name);
        }
    }
}
