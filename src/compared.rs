//! Studies as designs to be compared: each over the motion of the first one.

use crate::model::{Axis, LengthUnit, Suspension};
use crate::report::{Compared, CurveTable};
use crate::solved::Solved;
use crate::study::{Drive, Study};

/// The travels and racks of the first study, and the unit they are in.
pub type FirstMotion = Option<(Vec<f64>, Vec<f64>, bool, LengthUnit)>;

/// The curves and points of a study, and whether every curve is complete. `first` is the motion of the first study, which
/// this call sets if it has none.
///
/// # Errors
/// The reason in words.
pub fn of_study(
    mut study: Study,
    label: String,
    first: &mut FirstMotion,
) -> Result<(Compared, bool), String> {
    let unit = study.suspension.length_unit;
    let motion = &mut study.motion;
    if motion.drive == Drive::Travel && motion.time.is_none() {
        match first {
            None => {
                let racks = (motion.rack.clone(), motion.rack_moves);
                *first = Some((motion.values.clone(), racks.0, racks.1, unit));
            }
            Some((travels, racks, moves, of)) => {
                let ratio = unit.per_metre() / of.per_metre();
                motion.values = travels.iter().map(|travel| travel * ratio).collect();
                motion.rack = racks.iter().map(|rack| rack * ratio).collect();
                motion.rack_moves = *moves;
            }
        }
    }
    let solved = Solved::of(&study)?;
    let table = CurveTable::read(&solved.csv()).expect("curves are written as they are read");
    let compared = compared(label, &study.suspension, table);
    Ok((compared, solved.is_complete()))
}

/// A design with these curves.
pub fn compared(label: String, suspension: &Suspension, curves: CurveTable) -> Compared {
    let points = suspension.mechanism.points.iter().zip(&suspension.design);
    let points = points.map(|(point, at)| (point.name.clone(), at.to_array()));
    Compared {
        label,
        topology: Some(suspension.mechanism.topology.name.to_owned()),
        curves,
        unit: suspension.length_unit,
        points: Some((
            points.collect(),
            Axis::ALL.map(|axis| suspension.frame.sign(axis)),
        )),
    }
}
