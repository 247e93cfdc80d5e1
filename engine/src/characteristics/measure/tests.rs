//! Tests of the formulas of geometric measures.

use super::formula::{between_segments, versine};
use super::{MOST, Measure};
use crate::model::PointId;
use crate::number::{Dual, Vector3};

fn vector(x: f64, y: f64, z: f64) -> Vector3<f64> {
    Vector3::new(x, y, z)
}

#[test]
fn distances_of_segments_are_those_of_their_nearest_places() {
    let along_x = [vector(0.0, 0.0, 0.0), vector(10.0, 0.0, 0.0)];
    for (other, distance) in [
        // Second segment of each pair, and its distance from the first one. The pairs: crossing at a distance, nearest
        // beyond an end, end to end, parallel with overlap, parallel without overlap.
        ([vector(5.0, -5.0, 3.0), vector(5.0, 5.0, 3.0)], 3.0),
        ([vector(13.0, 4.0, 0.0), vector(13.0, 9.0, 0.0)], 5.0),
        ([vector(12.0, 0.0, 0.0), vector(20.0, 1.0, 0.0)], 2.0),
        ([vector(4.0, 0.0, 7.0), vector(30.0, 0.0, 7.0)], 7.0),
        ([vector(13.0, 4.0, 0.0), vector(20.0, 4.0, 0.0)], 5.0),
    ] {
        let found = between_segments(along_x, other);
        assert!((found - distance).abs() < 1e-12, "{found} {distance}");
        let swapped = between_segments(other, along_x);
        assert!((swapped - distance).abs() < 1e-12, "{swapped} {distance}");
    }
}

#[test]
fn a_box_is_negative_inside_and_round_outside() {
    let measure = Measure::FromBox {
        point: PointId(0),
        middle: vector(0.0, 0.0, 0.0),
        half: vector(1.0, 2.0, 3.0),
    };
    let at = |x, y, z| {
        let mut inputs = [vector(0.0, 0.0, 0.0); MOST];
        inputs[0] = vector(x, y, z);
        measure.formula(&inputs)
    };
    assert_eq!(at(0.0, 0.0, 0.0), -1.0);
    assert_eq!(at(0.0, -1.5, 0.0), -0.5);
    assert_eq!(at(-3.0, 0.0, 0.0), 2.0);
    assert_eq!(at(4.0, 6.0, 0.0), 5.0);
}

/// The part of a member that is inside a rim is farthest from the spin axis at one of two points. These points are the
/// member's outer end and the crossing with the plane of the rim's edge.
#[test]
fn a_member_is_inside_of_a_rim_where_its_outer_end_and_its_entry_are() {
    let mut seed = 1_u64;
    let mut off = |by: f64| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        by * (2.0 * (seed >> 11) as f64 / (1_u64 << 53) as f64 - 1.0)
    };
    for _ in 0..200 {
        let axis = vector(off(0.2), 1.0, off(0.2)).normalised();
        let centre = vector(off(9.0), 700.0, 300.0);
        let outer = centre + vector(off(150.0), -40.0 + off(30.0), off(150.0));
        let inner = outer + vector(off(200.0), -300.0 + off(250.0), off(200.0));
        let from = -80.0;
        if (outer - centre).dot(axis) < from {
            continue;
        }
        let mut inputs = [vector(0.0, 0.0, 0.0); MOST];
        inputs[..4].copy_from_slice(&[outer, inner, centre, axis]);
        let entry = Measure::FromSpinAxisAt([PointId(0); 2], from).formula(&inputs);
        let radial = |p: Vector3<f64>| (p - centre).cross(axis).norm();
        let places = (0..=2000).map(|k| outer + (inner - outer) * (f64::from(k) / 2000.0));
        let beyond = places.filter(|p| (*p - centre).dot(axis) >= from);
        let farthest = beyond.map(radial).fold(0.0, f64::max);
        let found = radial(outer).max(entry);
        // The member is sampled at steps of a few tenths of a millimetre.
        assert!(
            found >= farthest - 1e-9 && found <= farthest + 0.4,
            "{found} {farthest}"
        );
    }
}

/// A measure, its vectors at the time t = 0, and their rates.
type AtKink = (Measure, Vec<Vector3<f64>>, Vec<Vector3<f64>>);

/// Measures whose vectors reach a kink (a jump of the derivatives) at t = 0.
fn cases_at_kinks() -> Vec<AtKink> {
    let ids = [PointId(0); 2];
    let still = vector(0.0, 0.0, 0.0);
    let (x, y, z) = (
        vector(1.0, 0.0, 0.0),
        vector(0.0, 1.0, 0.0),
        vector(0.0, 0.0, 1.0),
    );
    let cube = Measure::FromBox {
        point: PointId(0),
        middle: still,
        half: vector(2.0, 2.0, 2.0),
    };
    let tube = Measure::FromTube {
        point: PointId(0),
        middle: still,
        along: z,
        half: 3.0,
        radius: 2.0,
    };
    let clearance = Measure::Clearance([ids; 2]);
    let member = [still, x * 10.0];
    let rim = Measure::FromSpinAxisAt(ids, -80.0);
    vec![
        (cube.clone(), vec![vector(3.0, 2.0, 0.5)], vec![y]),
        (cube.clone(), vec![vector(1.5, 1.5, 0.2)], vec![y - x * 0.3]),
        (tube, vec![vector(2.0, 0.0, 4.0)], vec![x + z * 0.4]),
        (
            clearance.clone(),
            vec![
                member[0],
                member[1],
                vector(10.0, -5.0, 3.0),
                vector(10.0, 5.0, 3.0),
            ],
            vec![still, still, x, x + y * 0.1],
        ),
        (
            clearance.clone(),
            vec![
                member[0],
                member[1],
                vector(3.0, 0.0, 4.0),
                vector(8.0, 0.0, 4.0),
            ],
            vec![still, still, z, z * -1.0],
        ),
        (
            rim,
            vec![
                vector(90.0, 620.0, 310.0),
                vector(40.0, 300.0, 280.0),
                vector(0.0, 700.0, 300.0),
                y,
            ],
            vec![y, still, still, still],
        ),
    ]
}

/// Near a kink, the derivatives belong to the side on which the point lies. The test moves the vectors across each of these
/// kinks and reaches the kink at t = 0:
///
/// - edge and middle of a box,
/// - rim of the end of a tube,
/// - change of a member's nearest point to its end,
/// - parallel members,
/// - end of a member on the edge of a rim.
#[test]
fn derivatives_beside_kinks_are_those_of_their_side() {
    let still = vector(0.0, 0.0, 0.0);
    for (number, (measure, at, by)) in cases_at_kinks().into_iter().enumerate() {
        let inputs = |t: Dual<f64, 1>| {
            let mut inputs = [still.map(Dual::constant); MOST];
            for (input, (at, by)) in inputs.iter_mut().zip(at.iter().zip(&by)) {
                *input = at.map(Dual::constant) + by.map(Dual::constant) * t;
            }
            inputs
        };
        let value = |t: f64| measure.formula(&inputs(Dual::constant(t))).value;
        let slope = |t: f64| measure.formula(&inputs(Dual::input(t, 0))).partials[0];
        let sides = [-1e-2, 1e-2].map(|t: f64| {
            let h = 1e-3;
            let rise = |k: f64| value(t + k * h) - value(t - k * h);
            let difference = (0.75 * rise(1.0) - 0.15 * rise(2.0) + rise(3.0) / 60.0) / h;
            let found = slope(t);
            assert!(
                (found - difference).abs() < 1e-9,
                "{number} at {t}: {found} {difference}"
            );
            found
        });
        assert!(
            (sides[0] - sides[1]).abs() > 1e-3,
            "{number} has a kink: {sides:?}"
        );
        // At the kink itself, the derivative lies between the derivatives of both sides. The tolerance allows for their
        // change near the kink.
        let (low, high) = (sides[0].min(sides[1]), sides[0].max(sides[1]));
        assert!((low - 0.02..=high + 0.02).contains(&slope(0.0)), "{number}");
    }
}

#[test]
fn the_versine_of_an_angle_is_smooth_at_none() {
    let x = vector(2.0, 0.0, 0.0);
    let turned = |angle: f64| vector(3.0 * angle.cos(), 3.0 * angle.sin(), 0.0);
    for angle in [0.0, 1e-8, 0.3, 1.5] {
        let wanted = 2.0 * (0.5_f64 * angle).sin().powi(2);
        assert!((versine(x, turned(angle)) - wanted).abs() <= 1e-15 * (1.0 + wanted));
    }
}
