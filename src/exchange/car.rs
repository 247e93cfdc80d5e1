//! Imports a car from a file with two axles: two studies of axles, and a study of the car that names them.

use super::axes::Axes;
use super::compose::one_line;
use super::import::{ImportOptions, Imported, for_axle};
use super::refusal::Refusal;
use super::table::PointTable;
use crate::model::{AxlePosition, Side};
use std::fmt::Write;

/// Names of the files: the car, its front axle and its rear axle.
pub const CAR_FILES: [&str; 3] = ["car.toml", "car_front.toml", "car_rear.toml"];

/// An imported car.
#[derive(Clone, Debug)]
pub struct ImportedCar {
    /// Front and rear axle, each represented by its left wheel.
    pub axles: [Imported; 2],
    /// Texts of the files, in the order of [`CAR_FILES`].
    pub files: [String; 3],
    /// Keys that the study of the car needs but the file does not have.
    pub missing: Vec<String>,
}

/// Imports both axles from a file's points. `options` are those of the front and the rear axle; `origin` names the file in
/// comments.
///
/// # Errors
/// An axle cannot be imported or forms no valid suspension, or the axles have different units or axes.
pub fn import_car(
    table: &PointTable,
    options: [&ImportOptions<'_>; 2],
    origin: &str,
) -> Result<ImportedCar, Refusal> {
    let ends = [AxlePosition::Front, AxlePosition::Rear];
    let mut axles = Vec::new();
    let mut texts = Vec::new();
    for (options, end) in options.into_iter().zip(ends) {
        let of_side = |side: Side| {
            let options = ImportOptions {
                axle: Some(end),
                side: Some(side),
                ..*options
            };
            for_axle(table, &options)
        };
        let name = super::corner::name_of(end);
        let fault = |reason: Refusal| match reason {
            Refusal::Wrong(reason) => Refusal::Wrong(format!("{name} axle: {reason}")),
            open => open,
        };
        let mut left = of_side(Side::Left).map_err(fault)?;
        let right = if left.topology.carries_both_wheels() {
            None
        } else {
            Some(of_side(Side::Right).map_err(fault)?)
        };
        let text = left.axle_study(right.as_ref(), &format!("the {name} study"), origin);
        let (text, notes) = text.map_err(|reason| {
            Refusal::Wrong(format!(
                "the points of the {name} axle do not form a valid suspension\n{reason}"
            ))
        })?;
        let notes = notes.into_iter().map(|note| format!("{name} axle: {note}"));
        left.notes.extend(notes);
        texts.push(text);
        axles.push(left);
    }
    let [front, rear] = <[Imported; 2]>::try_from(axles).expect("there are two axles");
    if front.unit != rear.unit || front.frame != rear.frame {
        return Err(Refusal::Wrong(
            "the axles have different units or axes: give --unit and --axes or --frame".to_owned(),
        ));
    }
    let mut missing = Vec::new();
    let car = car(table, &front, &rear, origin, &mut missing);
    let [front_text, rear_text] = <[String; 2]>::try_from(texts).expect("there are two axles");
    Ok(ImportedCar {
        axles: [front, rear],
        files: [car, front_text, rear_text],
        missing,
    })
}

/// Keys that a car needs, but that are missing in the study of this axle.
fn needs_of(axle: &Imported) -> Vec<&'static str> {
    let mut needs = Vec::new();
    if axle.wheel_radius.is_none() {
        needs.push("radius in [wheel] (--radius)");
    }
    let has_spring = axle
        .hardpoints
        .iter()
        .any(|h| ["spring_lower", "strut_lower"].contains(&h.name));
    if !has_spring {
        needs.push("spring_upper and spring_lower");
    }
    if axle.figures.spring.is_none() || !has_spring {
        needs.push("rate and force in [spring]");
    }
    if axle.figures.unsprung_mass.is_none() {
        needs.push("unsprung_mass in [vehicle]");
    }
    needs
}

/// Forward coordinate of an axle's wheel centre, in the study's unit.
fn ahead(axle: &Imported) -> f64 {
    let mut hardpoints = axle.hardpoints.iter();
    let centre = hardpoints.find(|h| h.name == "wheel_centre");
    centre.map_or(0.0, |h| Axes::of(axle.frame).to_iso(h.position)[0])
}

/// Text of the study of the car. Adds the keys that are not known to `missing`, by file.
fn car(
    table: &PointTable,
    front: &Imported,
    rear: &Imported,
    origin: &str,
    missing: &mut Vec<String>,
) -> String {
    for (axle, file) in [(front, CAR_FILES[1]), (rear, CAR_FILES[2])] {
        let needs = needs_of(axle);
        if !needs.is_empty() {
            missing.push(format!("{file}: {}", needs.join(", ")));
        }
    }
    let figures = table.car.clone().unwrap_or_default();
    let unit = front.unit;
    let mut text = format!(
        "# A car of two axles, from {}\n\n[car]\nfront = \"{}\"\nrear = \"{}\"\n",
        one_line(origin),
        CAR_FILES[1],
        CAR_FILES[2]
    );
    match (figures.rear_offset, table.car.is_some()) {
        (Some([x, y, z]), _) => {
            let _ = writeln!(
                text,
                "rear_offset = [{x:?}, {y:?}, {z:?}]      # position of the rear study's origin \
                 in the front study"
            );
        }
        // If all points of this file share one origin, `rear_offset` is zero.
        (None, false) if ahead(front) > ahead(rear) => {
            text +=
                "rear_offset = [0.0, 0.0, 0.0]      # both studies have the origin of the file\n"
        }
        _ => {
            missing.push(format!("{}: wheelbase or rear_offset", CAR_FILES[0]));
            let _ = writeln!(
                text,
                "# wheelbase = ...              # {}; or rear_offset = [x, y, z]",
                unit.symbol()
            );
        }
    }
    match figures.mass {
        Some(mass) => {
            let [x, y, z] = mass.cg;
            let (key, cg) = if mass.is_sprung {
                ("sprung_mass", "sprung_cg")
            } else {
                ("mass", "cg")
            };
            let _ = writeln!(
                text,
                "{key} = {:?}           # kg\n{cg} = [{x:?}, {y:?}, {z:?}]   # in the front study's axes, design position",
                mass.mass
            );
        }
        None => {
            missing.push(format!("{}: mass and cg", CAR_FILES[0]));
            text += "# mass = ...                   # kg, with cg; or sprung_mass with sprung_cg\n\
                     # cg = [..., 0.0, ...]         # in the front study's axes, design position\n";
        }
    }
    text += "drive_share_front = 0.0          # assumed: rear drive; it keeps the car's speed \
             constant in a turn\n# brake_share_front = 0.6        # needed by cases that \
             brake\n\n[[cases]]\nname = \"turn\"\nay = 0.5                         # g, to the \
             left\n";
    text
}
