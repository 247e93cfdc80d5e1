//! Imports a car from a file with two axles: two studies of axles, and a study of the car that names them.

use super::axes::Axes;
use super::compose::one_line;
use super::import::{ImportOptions, Imported, for_axle};
use super::notes::Notes;
use super::refusal::Refusal;
use super::table::PointTable;
use crate::model::{AxlePosition, Side};
use std::fmt::Write;

/// Names of the files that the import of a car writes: the car, its front axle and its rear axle.
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

/// Imports both axles from a file's points. `options` has the options of the front and the rear axle; `origin` names the file in
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
        // Without points of the right wheel, the right wheel is the mirror image.
        let right = if left.topology.carries_both_wheels() || !table.has_right_wheel() {
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
        left.notes.add(&notes.about(&format!("{name} axle")));
        texts.push(text);
        axles.push(left);
    }
    let [mut front, rear] = <[Imported; 2]>::try_from(axles).expect("there are two axles");
    if front.unit != rear.unit || front.frame != rear.frame {
        return Err(Refusal::Wrong(
            "the axles have different units or axes: give --unit and --axes or --frame".to_owned(),
        ));
    }
    let mut missing = Vec::new();
    let mut notes = Notes::default();
    let lists = (&mut missing, &mut notes);
    let car = car(table, &front, &rear, origin, lists);
    front.notes.add(&notes);
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
    wheel_centre(axle)[0]
}

/// Wheel centre of an axle in the axes of ISO 8855. The zero vector if the axle has no wheel centre.
fn wheel_centre(axle: &Imported) -> [f64; 3] {
    let mut hardpoints = axle.hardpoints.iter();
    let centre = hardpoints.find(|h| h.name == "wheel_centre");
    centre.map_or([0.0; 3], |h| Axes::of(axle.frame).to_iso(h.position))
}

/// True if the points of both axles have the same origin. Then their wheel centres are a wheelbase apart along x. With an origin of
/// its own, each axle has its wheel centre near x = 0. `wheelbase` is the value of the file.
fn have_one_origin(front: &Imported, rear: &Imported, wheelbase: Option<f64>) -> bool {
    let apart = ahead(front) - ahead(rear);
    match wheelbase {
        // The wheelbase in the file may be rounded, or be measured in another position of the wheels. So a deviation of 10 % is
        // allowed.
        Some(wheelbase) => (apart - wheelbase).abs() <= 0.1 * wheelbase,
        // Without a wheelbase in the file: every car is longer than half of its width.
        None => apart > across(front).max(across(rear)),
    }
}

/// Distance of an axle's wheel centre from the centre plane, in the study's unit.
fn across(axle: &Imported) -> f64 {
    wheel_centre(axle)[1].abs()
}

/// Line of the study of the car with the position of the rear axle: `rear_offset` or `wheelbase`.
fn position(
    table: &PointTable,
    [front, rear]: [&Imported; 2],
    (missing, notes): (&mut Vec<String>, &mut Notes),
) -> String {
    let unit = front.unit.symbol();
    let wheelbase = match (front.wheelbase, rear.wheelbase) {
        (Some(front), Some(rear)) if front != rear => None,
        (front, rear) => front.or(rear),
    };
    let offset = table.car.as_ref().and_then(|car| car.rear_offset);
    let is_table = table.car.is_none();
    match (offset, wheelbase) {
        (Some([x, y, z]), _) => format!(
            "rear_offset = [{x:?}, {y:?}, {z:?}]      # position of the rear study's origin in the front study\n"
        ),
        // If all points of this file share one origin, `rear_offset` is zero.
        (None, _) if is_table && have_one_origin(front, rear, wheelbase) => {
            "rear_offset = [0.0, 0.0, 0.0]      # both studies have the origin of the file\n"
                .to_owned()
        }
        (None, Some(wheelbase)) if is_table => {
            notes.push(format!(
                "wheelbase: {wheelbase:?} {unit}, from the file, because the points of the rear axle have their own origin. Assumed: both \
                 origins are at the same height"
            ));
            format!(
                "wheelbase = {wheelbase:?}                # between the wheel centres; both origins at the same height\n"
            )
        }
        _ => {
            missing.push(format!("{}: wheelbase or rear_offset", CAR_FILES[0]));
            format!("# wheelbase = ...              # {unit}; or rear_offset = [x, y, z]\n")
        }
    }
}

/// Text of the study of the car. Adds the keys that are not known to `missing`, by file, and assumptions to `notes`.
fn car(
    table: &PointTable,
    front: &Imported,
    rear: &Imported,
    origin: &str,
    (missing, notes): (&mut Vec<String>, &mut Notes),
) -> String {
    for (axle, file) in [(front, CAR_FILES[1]), (rear, CAR_FILES[2])] {
        let needs = needs_of(axle);
        if !needs.is_empty() {
            missing.push(format!("{file}: {}", needs.join(", ")));
        }
    }
    let figures = table.car.clone().unwrap_or_default();
    let mut text = format!(
        "# A car of two axles, from {}\n\n[car]\nfront = \"{}\"\nrear = \"{}\"\n",
        one_line(origin),
        CAR_FILES[1],
        CAR_FILES[2]
    );
    text += &position(table, [front, rear], (&mut *missing, notes));
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
