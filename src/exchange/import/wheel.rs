//! Values of the wheel: loaded radius, camber and toe, with their sources.

use super::super::corner::{Corner, Picked};
use super::super::figure_names::{FigureKind, figure};
use super::super::figures::Figures;
use super::super::notes::Notes;
use super::super::place::Placed;
use super::super::table::{NamedPoint, PointTable};
use super::Imported;

/// Name of the contact point, and its distance from the wheel centre in the file's unit. `None` unless the file has both points.
pub(super) fn contact_radius(
    table: &PointTable,
    corner: Corner,
    placed: Placed,
    picked: &[Picked],
) -> Option<(String, f64)> {
    let centre = picked.iter().find(|p| p.hardpoint.name == "wheel_centre")?;
    let centre = centre.hardpoint.position;
    let is_contact = |point: &&NamedPoint| {
        figure(&point.read_as).is_some_and(|(kind, marks, _)| {
            let marks = point.marks.or(marks);
            let is_side = marks.side.is_none() || marks.side == corner.side;
            let is_axle =
                marks.axle.is_none() || corner.axle.is_none() || marks.axle == corner.axle;
            kind == FigureKind::ContactPoint && is_side && is_axle
        })
    };
    let contact = table.points.iter().find(is_contact)?;
    let mut position = contact.position.clone().ok()?;
    // A contact point for both wheels has the coordinates of the left wheel. So its lateral coordinate may need the
    // other sign.
    let (across, _) = placed.axes.across();
    if position[across] * centre[across] < 0.0 {
        position[across] = -position[across];
    }
    let apart: [f64; 3] = std::array::from_fn(|k| position[k] - centre[k]);
    Some((
        contact.name.clone(),
        apart[0].hypot(apart[1]).hypot(apart[2]),
    ))
}

/// Finds the loaded radius: a value of the file or the user, half of the tyre's diameter, or the distance of the contact point. A
/// note names the second or third source, or states that the file has no radius.
pub(super) fn radius(
    contact: Option<(String, f64)>,
    is_optimum: bool,
    figures: &mut Figures,
    notes: &mut Notes,
) {
    if figures.radius.is_some() {
        return;
    }
    if let Some(diameter) = figures.tyre_diameter {
        let tool = if is_optimum {
            ", as OptimumKinematics reads it"
        } else {
            ""
        };
        notes.push(format!(
            "[wheel] radius: half of the tyre diameter {diameter}{tool}, not the loaded radius"
        ));
        return;
    }
    if let Some((name, radius)) = contact {
        let note = format!("[wheel] radius: the distance of {name:?} from the wheel centre");
        notes.push(note);
        figures.radius = Some(radius);
        return;
    }
    notes.push(
        "[wheel] radius, the loaded radius, is not in the file; outputs that need it are not \
         requested"
            .to_owned(),
    );
}

/// Sets camber and toe if no point defines the spin axis. A missing angle is assumed to be 0, with a note.
pub(super) fn angles(figures: &Figures, imported: &mut Imported) {
    let has_spindle = imported
        .hardpoints
        .iter()
        .any(|h| h.name == "spindle_inner");
    if has_spindle {
        if figures.camber.or(figures.toe).is_some() {
            let reason = "static camber and toe: spindle_inner defines them";
            imported.left_out.push(reason.to_owned());
        }
        return;
    }
    let lacking = match (figures.camber, figures.toe) {
        (None, None) => Some("static_camber and static_toe are"),
        (None, _) => Some("static_camber is"),
        (_, None) => Some("static_toe is"),
        _ => None,
    };
    if let Some(lacking) = lacking {
        imported.notes.push(format!(
            "{lacking} assumed to be 0: the file has no point spindle_inner of the spin axis, and \
             no angle that can be read"
        ));
    }
    imported.static_camber = Some(figures.camber.unwrap_or(0.0));
    imported.static_toe = Some(figures.toe.unwrap_or(0.0));
}
