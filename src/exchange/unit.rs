//! Unit of a file's coordinates: the stated unit, or the unit that gives the points the size of a car's suspension.

use super::ImportOptions;
use super::corner::Picked;
use super::table::PointTable;
use crate::model::LengthUnit;

/// Smallest and largest size of a wheel's suspension, in metres. They identify an unstated unit.
const USUAL_SIZE: [f64; 2] = [0.15, 3.0];

/// Finds the unit of the coordinates.
pub(super) fn unit(
    table: &PointTable,
    options: &ImportOptions<'_>,
    picked: &[Picked],
    notes: &mut Vec<String>,
) -> Result<LengthUnit, String> {
    // If the file has no wheel centre, any joint at the wheel is sufficient.
    let at_wheel = ["wheel_centre", "lower_ball_joint", "lower_front_link_outer"];
    let centre = at_wheel
        .iter()
        .find_map(|name| picked.iter().find(|p| p.hardpoint.name == *name));
    let (centre, from) = match centre {
        Some(p) => (p.hardpoint.position, "the wheel"),
        None => ([0.0; 3], "the origin"),
    };
    let distance = |p: &Picked| {
        let squares = p
            .hardpoint
            .position
            .iter()
            .zip(centre)
            .map(|(a, b)| (a - b) * (a - b));
        squares.sum::<f64>().sqrt()
    };
    let size = picked.iter().map(distance).fold(0.0, f64::max);
    let [least, most] = USUAL_SIZE;
    let fits = |unit: &LengthUnit| (least..=most).contains(&(size / unit.per_metre()));
    let fitting = LengthUnit::ALL.into_iter().find(fits);
    let stated = match (options.unit, table.unit) {
        (Some(unit), written) => {
            if written.is_some_and(|written| written != unit) {
                notes.push(format!(
                    "--unit {} replaces the unit stated in the file",
                    unit.symbol()
                ));
            }
            Some(unit)
        }
        (None, written) => written,
    };
    match (stated, fitting) {
        (Some(unit), _) if fits(&unit) => Ok(unit),
        (Some(unit), fitting) => {
            let better = fitting.map_or(String::new(), |unit| {
                format!("; in {} they would be", unit.symbol())
            });
            notes.push(format!(
                "please check: the points are up to {size:.4} {} from {from}, which is not the size of \
                 a car's suspension{better}",
                unit.symbol()
            ));
            Ok(unit)
        }
        (None, Some(unit)) => {
            notes.push(format!(
                "unit: {}, because the file states none and the points are up to {size:.4} from {from}, the size of a \
                 car's suspension (--unit changes this)",
                unit.symbol()
            ));
            Ok(unit)
        }
        (None, None) => Err(format!(
            "the points are up to {size:.4} from {from}: no car's suspension has this size in mm, m or in. State the \
             unit with --unit"
        )),
    }
}
