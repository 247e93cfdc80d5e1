//! Values of the wheel: loaded radius, camber and toe, with their sources.

use super::super::figures::Figures;
use super::Imported;

/// Loaded radius. A note names its source: the values of the file, the tyre's diameter, or the contact point.
pub(super) fn radius(
    contact: Option<(String, f64)>,
    is_optimum: bool,
    figures: &mut Figures,
    notes: &mut Vec<String>,
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

/// Sets camber and toe if no point defines the spin axis.
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
