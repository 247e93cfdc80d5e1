//! Tests of drawings of an axle: the ground stays level while the body rolls.

use super::one_state::axles;
use crate::compliance::support::{elastic, with};
use hardpoint::axle::{Placement, WheelMotion, axle_curves, axle_frames};

/// A drawing of a mirrored axle in the design position has the points of the design. In roll both wheels stand on the same level
/// ground.
#[test]
fn the_ground_of_a_drawing_stays_where_it_is_in_the_design_position() {
    for (name, axle) in axles() {
        let at = |heave: f64, roll: f64| Placement::Roll {
            heave,
            roll: f64::to_radians(roll),
            rack: 0.0,
        };
        let placements = [at(0.0, 0.0), at(0.0, 1.5), at(8.0, -1.0), at(-6.0, 0.0)];
        let frames = axle_frames(&axle, &placements).unwrap();
        let frames: Vec<_> = frames.into_iter().map(Result::unwrap).collect();
        let level = frames[0].contact.unwrap()[2];
        // If the wheels differ, their contact points have slightly different heights in the design position. The
        // ground is at the mean of both heights.
        let right = frames[0].right.as_ref().unwrap().contact.unwrap()[2];
        let ground = 0.5 * (level + right);
        let own = &axle.left;
        assert!(frames[0].points.len() >= own.design.len(), "{name}");
        // If the sides differ, the drawing rotates and lifts both wheels, so that they stand on level ground.
        let most = if axle.right.is_some() { 5.0 } else { 1e-9 };
        for (drawn, design) in frames[0].points.iter().zip(&own.design) {
            let design = own.frame.vector(*design).to_array();
            for axis in 0..2 {
                let off = (drawn[axis] - design[axis]).abs();
                assert!(
                    axle.right.is_some() || off < 1e-9,
                    "{name}: {drawn:?} {design:?}"
                );
            }
            assert!(
                (drawn[2] - design[2]).abs() < most,
                "{name}: {drawn:?} {design:?}"
            );
        }
        for drawn in &frames {
            let right = drawn.right.as_ref().unwrap().contact.unwrap()[2];
            for height in [drawn.contact.unwrap()[2], right] {
                assert!((height - ground).abs() < 1e-6, "{name}: {height} {ground}");
            }
        }
    }
}

/// The drawing shows an axle with elastic parts in equilibrium: the drawn spin axes have the camber of the curves. The
/// height difference of the wheel centres equals the difference of the travels.
#[test]
fn an_elastic_axle_is_drawn_in_equilibrium() {
    let mut study = elastic(&with("subframe_axle_compliance.toml", ""));
    let both = study.axle_mut().unwrap();
    let pads = [(-30.0, -30.0), (0.0, 0.0), (25.0, -15.0), (30.0, 30.0)];
    let placements = pads.map(|(left, right)| Placement::Travels {
        travels: [left, right],
        rack: 0.0,
        on_plane: false,
    });
    let frames = axle_frames(&both.axle, &placements).unwrap();
    assert_eq!(frames.len(), pads.len());
    for ((left, right), drawn) in pads.into_iter().zip(frames) {
        let drawn = drawn.unwrap();
        both.plan.motion.wheels = WheelMotion::Travels {
            left: vec![left],
            right: vec![right],
            on_plane: false,
        };
        let curves = axle_curves(&both.axle, &both.plan).unwrap().curves;
        let camber = |name: &str| {
            let of_name = curves.columns.iter().position(|c| c.name == name).unwrap();
            curves.stations[0].value(of_name).unwrap()
        };
        let other = drawn.right.unwrap();
        for (axis, name) in [
            (drawn.spin_axis, "left_camber_deg"),
            (other.spin_axis, "right_camber_deg"),
        ] {
            // If the top of the wheel leans outboard, the spin axis points outboard and down.
            let drawn = -axis[2].asin().to_degrees();
            assert!(
                (drawn - camber(name)).abs() < 1e-9,
                "{name} at {left}, {right}: {drawn}"
            );
        }
        let centre = both.axle.left.mechanism.wheel_centre.0;
        let [at_left, at_right] =
            [0, drawn.points.len() / 2].map(|first| drawn.points[first + centre]);
        let apart = at_left[2] - at_right[2];
        assert!((apart - (left - right)).abs() < 1e-9, "{apart}");
    }
}
