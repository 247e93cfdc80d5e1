//! Tests of Table 2 of the paper.

use super::{DATA, at, reference, strut};
use hardpoint::attia::Drive;
use hardpoint::attia::PointCoordinates;
use hardpoint::attia::Rates;
use hardpoint::attia::StrutPoints;
use hardpoint::number::Vector3;

/// Eleven vectors of the paper's example at a time of Table 2, in the table's order. The drive is `theta`.
fn table_row(theta: [f64; 3]) -> Vec<Vector3<f64>> {
    let strut = strut(&reference("attia-example"));
    let mechanism = PointCoordinates::new(&strut, StrutPoints::Study, Drive::PaperTheta).unwrap();
    let pose = mechanism.track(&mechanism.design(), at(theta[0])).unwrap();
    let rates = Rates {
        drive: theta[1],
        drive_acceleration: theta[2],
        ..Rates::default()
    };
    let motion = mechanism.motion(&pose, rates).unwrap();
    let angular = mechanism.angular_motion(&pose, &motion);
    let all = [pose.moving(), &motion.velocity, &motion.acceleration];
    let centre = mechanism.wheel_centre();
    let mut row: Vec<_> = all.map(|m| m[3]).into();
    row.extend(all.map(|m| m[4]));
    row.extend(all.map(|m| centre.of(m)));
    row.extend([angular.velocity, angular.acceleration]);
    row
}

/// Entries of Table 2 that differ from the computed values by more than half a unit of the last printed digit. There
/// are eleven vectors at each time. Each entry has its name, the printed value, and the computed value with four
/// decimals.
fn misses(row: impl Fn(f64) -> Vec<Vector3<f64>>) -> Vec<(String, f64, String)> {
    let table = std::fs::read_to_string(format!("{DATA}/attia-table-2.csv")).unwrap();
    let lines: Vec<Vec<&str>> = table
        .lines()
        .skip(1)
        .map(|l| l.split(',').collect())
        .collect();
    assert_eq!(lines.len(), 33);
    let mut missed = Vec::new();
    for (rows, time) in lines.chunks(11).zip([0.0, 1.0, 2.0]) {
        for (line, computed) in rows.iter().zip(row(time)) {
            assert_eq!(line[0].parse::<f64>().unwrap(), time);
            for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
                let printed = line[2 + k];
                let decimals = printed
                    .split_once('.')
                    .map_or(0, |(_, digits)| digits.len());
                let half_a_unit = 0.5 * 0.1_f64.powi(decimals as i32);
                let (printed, computed) = (printed.parse::<f64>().unwrap(), computed.to_array()[k]);
                if (printed - computed).abs() > half_a_unit {
                    let name = format!("{} {axis} at {time} s", line[1]);
                    missed.push((name, printed, format!("{computed:.4}")));
                }
            }
        }
    }
    missed
}

/// Asserts that ninety of the ninety-nine entries agree, and that the nine listed entries do not.
pub(super) fn check_table(row: impl Fn(f64) -> Vec<Vector3<f64>>) {
    let missed = misses(row);
    let missed: Vec<_> = missed
        .iter()
        .map(|(name, printed, computed)| (name.as_str(), *printed, computed.as_str()))
        .collect();
    let expected = [
        ("position_10 y at 1 s", 0.34, "0.3104"),
        ("velocity_10 x at 1 s", -0.007, "0.0002"),
        ("velocity_10 y at 1 s", -0.6, "-0.6630"),
        ("acceleration_10 x at 1 s", 0.14, "0.1571"),
        ("acceleration_10 z at 1 s", 0.82, "1.0213"),
        ("alpha_knuckle y at 1 s", 0.3, "-0.2989"),
        ("velocity_9 y at 2 s", 0.22, "0.0221"),
        ("position_10 x at 2 s", 1.59, "1.5981"),
        ("position_10 y at 2 s", 0.5, "0.4488"),
    ];
    assert_eq!(missed, expected);
}

#[test]
fn ninety_entries_of_table_2_come_out_and_nine_do_not() {
    check_table(|t| table_row([1.0 + t + 0.5 * t * t, 1.0 + t, 1.0]));
}

/// The printed drive, 1 + t + t^2, is a misprint. At the start, this drive has the correct angle and rate, so only
/// accelerations differ. At 1 s and 2 s, almost no entry of the table agrees.
#[test]
fn with_the_printed_drive_the_table_does_not_come_out() {
    let missed = misses(|t| table_row([1.0 + t + t * t, 1.0 + 2.0 * t, 2.0]));
    let missed_at = |time: &str| {
        missed
            .iter()
            .filter(|(name, ..)| name.ends_with(time))
            .count()
    };
    assert_eq!(33 - missed_at("at 0 s"), 22);
    assert_eq!(33 - missed_at("at 1 s"), 3);
    assert_eq!(33 - missed_at("at 2 s"), 1);
}
