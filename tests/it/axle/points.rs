//! Tests of points and angular velocities of both wheels of an axle, with their derivatives with respect to the motion
//! and to hardpoints.

use super::{solved, value};
use hardpoint::curves::Curves;

const POINTS: &str = "outputs={characteristics=[\"camber\"], points=[\"wheel_centre\", \"tie_rod_inner\", \"drop_link_inner\", \
    \"strut_lower\"], knuckle=true, order=\"velocity\"}";

/// Central difference of eighth order over nine stations with this step.
fn difference(at: impl Fn(usize) -> f64, step: f64) -> f64 {
    let weights = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];
    let pairs = weights.iter().enumerate();
    pairs.map(|(k, w)| w * (at(5 + k) - at(3 - k))).sum::<f64>() / step
}

/// Points are given in body axes with their actual y. In the design position they equal the design. In roll the right
/// wheel's points mirror those of the left wheel at the opposite roll angle.
#[test]
fn both_wheels_have_their_points_in_the_body_s_axes() {
    let found = solved(
        "macpherson_axle",
        &[POINTS, "motion={roll=[-2.0, 0.0, 2.0], rack=0.0}"],
    );
    for (name, place) in [
        ("left_wheel_centre", [0.0, 760.0, 300.0]),
        ("right_wheel_centre", [0.0, -760.0, 300.0]),
        ("right_tie_rod_inner", [-110.0, -330.0, 243.0]),
        ("left_drop_link_inner", [40.0, 610.0, 210.0]),
    ] {
        for (axis, wanted) in ["x", "y", "z"].iter().zip(place) {
            let found = value(&found, 1, &format!("{name}_{axis}_mm"));
            assert!((found - wanted).abs() < 1e-9, "{name}_{axis}: {found}");
        }
    }
    let mut seen = 0;
    for column in &found.columns {
        let Some(rest) = column
            .name
            .strip_prefix("left_")
            .filter(|n| !n.starts_with("camber"))
        else {
            continue;
        };
        // Lateral displacements and rotations about x and z change their sign, and so does every derivative with
        // respect to roll angle or rack.
        let name = &column.output;
        let mut sign = 1.0;
        for turns in [
            name.ends_with("_y") && !name.contains("omega"),
            name.contains("omega") && !name.ends_with("_y"),
            rest.contains("_by_roll"),
            rest.contains("_by_rack"),
        ] {
            sign *= if turns { -1.0 } else { 1.0 };
        }
        for station in [0, 2] {
            let left = value(&found, station, &column.name);
            let right = value(&found, 2 - station, &format!("right_{rest}"));
            assert!(
                (left - sign * right).abs() < 1e-9 * left.abs().max(1.0),
                "{rest}: {left} {right}"
            );
        }
        seen += 1;
    }
    assert!(seen > 40, "{seen}");
}

/// The derivatives of coordinates with respect to each motion coordinate equal the slopes of the values. The angular
/// velocity gives the velocities of the wheel carrier's points.
#[test]
fn points_move_at_their_derivatives() {
    let step = 0.125;
    let range = |middle: f64| {
        let values: Vec<_> = (-4..=4).map(|k| middle + step * f64::from(k)).collect();
        format!("{values:?}")
    };
    for (motion, by, unit) in [
        (
            format!("roll={}, heave=10.0, rack=8.0", range(1.5)),
            "roll",
            "deg",
        ),
        (
            format!("roll=1.5, heave={}, rack=8.0", range(10.0)),
            "heave",
            "mm",
        ),
        (
            format!("roll=1.5, heave=10.0, rack={}", range(8.0)),
            "rack",
            "mm",
        ),
        (
            format!(
                "ground=\"plane\", travel_left={}, travel_right=-12.0, rack=8.0",
                range(10.0)
            ),
            "travel_left",
            "mm",
        ),
        (
            format!(
                "ground=\"plane\", travel_left=10.0, travel_right=-12.0, rack={}",
                range(8.0)
            ),
            "rack",
            "mm",
        ),
    ] {
        let found = solved(
            "macpherson_axle",
            &[POINTS, &format!("motion={{{motion}}}")],
        );
        assert_eq!(found.stations.len(), 9);
        let mut compared = 0;
        for column in found
            .columns
            .iter()
            .filter(|c| c.name.contains(&format!("_by_{by}_")))
        {
            if column.name.contains("omega") || column.name.contains("camber") {
                continue;
            }
            let stem = &column.output;
            let slope = difference(|k| value(&found, k, &format!("{stem}_mm")), step);
            let own = value(&found, 4, &column.name);
            // Rounding errors of the coordinates, divided by the step. Measured: at most 4e-12.
            assert!((own - slope).abs() < 1e-9, "{}: {own} {slope}", column.name);
            compared += 1;
        }
        // Three coordinates of four points of both wheels.
        assert_eq!(compared, 3 * 4 * 2, "{motion}");
        for side in ["left", "right"] {
            let vector =
                |name: &str| ["x", "y", "z"].map(|axis| value(&found, 4, &name.replace('#', axis)));
            let omega = vector(&format!("{side}_knuckle_omega_#_by_{by}_rad_per_{unit}"));
            // The points strut_lower and wheel_centre belong to the wheel carrier.
            let arm = {
                let [a, b] =
                    ["strut_lower", "wheel_centre"].map(|p| vector(&format!("{side}_{p}_#_mm")));
                [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
            };
            let [a, b] = ["strut_lower", "wheel_centre"]
                .map(|p| vector(&format!("{side}_{p}_#_by_{by}_mm_per_{unit}")));
            for k in 0..3 {
                let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                let turned = omega[i] * arm[j] - omega[j] * arm[i];
                assert!(
                    (a[k] - b[k] - turned).abs() < 1e-10,
                    "{side} by {by}, {k}: {turned}"
                );
            }
        }
    }
}

/// Sensitivities of coordinates with respect to a hardpoint of either wheel equal slopes. If the sides differ, each wheel has its
/// own hardpoint. In roll, the travels of both wheels depend on the hardpoints of each wheel.
#[test]
fn points_have_sensitivities() {
    let outputs = "outputs={points=[\"wheel_centre\", \"toe_link_outer\"], sensitivities=[\"toe_link_inner\", \"lower_rear_link_outer\"]}";
    for motion in [
        "motion={roll=2.0, heave=5.0}",
        "motion={travel_left=10.0, travel_right=-4.0}",
    ] {
        let found = solved("five_link_axle", &[outputs, motion]);
        let step = 0.1;
        let at = |k: usize, side: &str| {
            let moved = 250.0 + step * (k as f64 - 4.0);
            // Each wheel has its own coordinates of the point.
            let set = match side {
                "left" => format!(
                    "suspension.hardpoints.lower_rear_link_outer=[-55.0, {:?}, 190.0]",
                    455.0 + moved
                ),
                _ => format!(
                    "axle.right.hardpoints.lower_rear_link_outer=[-55.0, {:?}, 190.0]",
                    -455.0 - moved
                ),
            };
            let other = match side {
                "left" => "axle.right.hardpoints.lower_rear_link_outer=[-55.0, -705.0, 190.0]",
                _ => "suspension.hardpoints.lower_rear_link_outer=[-55.0, 705.0, 190.0]",
            };
            solved("five_link_axle", &[outputs, motion, &set, other])
        };
        for side in ["left", "right"] {
            let runs: Vec<_> = (0..9).map(|k| at(k, side)).collect();
            let mut seen = 0;
            for s in &found.sensitivities {
                let of_side = s.side.is_some_and(|s| s.name() == side);
                let column = &found.columns[s.column];
                let is_point =
                    s.axis == hardpoint::model::Axis::Y && s.point.0 == lower_rear(&found);
                if !(of_side && is_point) {
                    continue;
                }
                let sign = if side == "left" { 1.0 } else { -1.0 };
                let slope = sign * difference(|k| value(&runs[k], 0, &column.name), step);
                assert!(
                    (s.value - slope).abs() < 1e-8,
                    "{side} {motion} {}: {} {slope}",
                    column.name,
                    s.value
                );
                seen += 1;
            }
            assert_eq!(seen, 12, "{side}");
        }
    }
}

/// Index of the point with respect to which the test differentiates: the first of the two points with sensitivities.
fn lower_rear(found: &Curves) -> usize {
    let points = found.sensitivities.iter().map(|s| s.point.0);
    let mut points: Vec<_> = points.collect();
    points.sort_unstable();
    points.dedup();
    assert_eq!(points.len(), 2);
    // Links keep the order of the file, with the toe link last.
    points[0]
}
