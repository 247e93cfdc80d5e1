//! Drawings of an axle: the ground stays, the body rolls on it.

use super::one_state::axles;
use hardpoint::axle::{Placement, axle_frames};

/// A drawing of the design position has the design's points, and in roll both wheels stand on the same level ground.
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
        // Wheels that differ are a little apart in the design position, where the ground is in the middle.
        let right = frames[0].right.as_ref().unwrap().contact.unwrap()[2];
        let ground = 0.5 * (level + right);
        let own = &axle.left;
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
                (drawn[2] - design[2]).abs() < 5.0,
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
