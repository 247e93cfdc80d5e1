//! Tests of curves of axles with elastic parts: derivatives along motions, sensitivities, and an axle that equals one wheel.

use super::support::{asymmetric, curves, replaced, values};
use crate::compliance::support::{elastic, fourth_order, with};
use hardpoint::model::Side;

const OUTPUTS: &str = r#"
[outputs]
characteristics = [
  "camber", "toe", "caster", "kingpin_offset", "steer", "mean_steer", "track", "track_change", "wheel_load",
]
order = "velocity"
"#;

/// Derivatives along both travels and the rack equal difference quotients. The wheels are different.
#[test]
fn derivatives_along_motions_agree_with_differences() {
    let here = [-10.0, 5.0, 3.0];
    let at = |[left, right, rack]: [f64; 3]| {
        let motion =
            format!("travel_left = [{left:?}]\ntravel_right = [{right:?}]\nrack = [{rack:?}]");
        values(&asymmetric(&motion, OUTPUTS), 0)
    };
    let found = at(here);
    let mut checked = 0;
    for (number, along) in ["travel_left", "travel_right", "rack"].iter().enumerate() {
        let moved: Vec<_> = [-0.2, -0.1, 0.1, 0.2]
            .iter()
            .map(|by| {
                let mut place = here;
                place[number] += by;
                at(place)
            })
            .collect();
        for (k, (name, _)) in found.iter().enumerate() {
            let marks = ["travel_left", "travel_right", "rack"];
            if marks
                .iter()
                .any(|mark| name.contains(&format!("_by_{mark}_")))
            {
                continue;
            }
            let mark = format!("_by_{along}_");
            let derivative = found[k + 1..]
                .iter()
                .find(|(other, _)| other.contains(&mark))
                .unwrap_or_else(|| panic!("{name} {mark}"));
            let expected = fourth_order(std::array::from_fn(|at| moved[at][k].1), 0.1);
            assert!(
                (derivative.1 - expected).abs() < 1e-8 * expected.abs().max(1.0),
                "{}: {} {expected}",
                derivative.0,
                derivative.1
            );
            checked += 1;
        }
    }
    assert_eq!(checked, 3 * 15);
}

/// Sensitivities to the hardpoints of either wheel equal difference quotients.
#[test]
fn sensitivities_by_both_wheels_agree_with_differences() {
    let outputs = r#"
[outputs]
characteristics = ["camber", "mean_steer", "wheel_load", "toe_by_lateral_force_trail_30", "camber_by_roll_without_bar"]
sensitivities = ["lower_arm_rear"]
"#;
    let motion = "travel_left = [-10.0]\ntravel_right = [5.0]\nrack = [3.0]";
    let study = elastic(&asymmetric(motion, outputs));
    let curves = curves(&study);
    let values_at = |side: Side, axis: usize, by: f64| {
        let mut text = asymmetric(motion, outputs);
        let (old, mut place) = match side {
            Side::Left => (
                "lower_arm_rear      = [-200.0, 375.0, 198.0]",
                [-200.0, 375.0, 198.0],
            ),
            Side::Right => (
                "lower_arm_rear = [-196.0, -372.0, 201.0]",
                [-196.0, -372.0, 201.0],
            ),
        };
        place[axis] += by;
        text = replaced(&text, old, &format!("lower_arm_rear = {place:?}"));
        values(&text, 0)
    };
    let mut checked = 0;
    for side in Side::ALL {
        for axis in 0..3 {
            let moved: Vec<_> = [-0.2, -0.1, 0.1, 0.2]
                .map(|by| values_at(side, axis, by))
                .into();
            for (k, column) in curves.columns.iter().enumerate() {
                let own = curves
                    .sensitivities
                    .iter()
                    .find(|s| s.column == k && s.side == Some(side) && s.axis as usize == axis);
                let own = own
                    .unwrap_or_else(|| panic!("{} {side:?}", column.name))
                    .value;
                let expected = fourth_order(std::array::from_fn(|at| moved[at][k].1), 0.1);
                let scale = curves.stations[0].value(k).unwrap().abs().max(1.0);
                assert!(
                    (own - expected).abs() < 1e-9 * scale,
                    "{} {side:?} {axis}: {own} {expected}",
                    column.name
                );
                checked += 1;
            }
        }
    }
    assert_eq!(checked, 6 * 9);
}

/// Without subframe, elastic rack and bar, each wheel of a symmetric axle equals a single wheel. Heave of the axle
/// corresponds to the travel of the single wheel. A parallel load on the axle corresponds to the load on the single
/// wheel.
#[test]
fn a_symmetric_axle_in_heave_is_one_wheel() {
    let tests = "relaxed = \"at_design_load\"\ntests = [{ load = \"lateral\", trail = 30.0 }, { load = \"braking\" }]\n";
    let outputs = r#"
[outputs]
characteristics = ["toe", "camber", "caster", "half_track_change", "toe_by_lateral_force_trail_30", "recession_by_braking_secant"]
sensitivities = ["tie_rod_inner", "lower_arm_rear"]
"#;
    let wheel = with("double_wishbone_compliance.toml", outputs);
    let wheel = replaced(&wheel, "relaxed = \"at_design_load\"", tests);
    let axle = replaced(&wheel, "travel = {", "heave = {") + "\n[axle]\nright = \"mirrored\"\n";
    let one = elastic(&wheel).curves().unwrap();
    let both = curves(&elastic(&axle));
    let mut checked = 0;
    for (k, column) in both.columns.iter().enumerate() {
        let name = column.name.split_once('_').unwrap().1;
        let own = one.columns.iter().position(|c| c.name == name);
        let own = own.unwrap_or_else(|| panic!("{name} in {:?}", one.columns));
        for (station, (both_at, one_at)) in both.stations.iter().zip(&one.stations).enumerate() {
            let (found, expected) = (both_at.value(k).unwrap(), one_at.value(own).unwrap());
            assert!(
                (found - expected).abs() < 1e-9 * expected.abs().max(1e-3),
                "{name} {station}: {found} {expected}"
            );
            for s in both
                .sensitivities
                .iter()
                .filter(|s| s.column == k && s.station == station)
            {
                let same = one.sensitivities.iter().find(|o| {
                    (o.station, o.column, o.point, o.axis) == (station, own, s.point, s.axis)
                });
                let expected = same.unwrap().value;
                assert!(
                    (s.value - expected).abs() < 1e-8 * expected.abs().max(1e-3),
                    "{name} {station} {:?}: {} {expected}",
                    s.axis,
                    s.value
                );
                checked += 1;
            }
        }
    }
    // Number of compared values: two wheels, six outputs, five stations, and six coordinates (two points).
    assert_eq!(checked, 2 * 6 * 5 * 6);
}
