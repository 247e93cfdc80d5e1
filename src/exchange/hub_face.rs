//! Wheels that are given by the hub instead of the wheel centre, as in the geometry files of Suspension Explorer.
//!
//! Its documents (`suspension-explorer-core`, README and the schema of the geometry files) give two points of the spin
//! axis, `axle_inboard` and `axle_outboard`. The second point is the mounting face of the hub. The wheel centre is on the
//! axis, at the distance `wheel.offset` (ET, in millimetres, positive inboard) from this point. The tyre's nominal radius
//! is half the rim's diameter (inches) plus the side wall, `aspect_ratio` (0.55, not 55) times `section_width` (millimetres).

use super::figure_names::{FigureKind, figure};
use super::table::{Figure, Marks, NamedPoint, PointTable};
use super::unit::FileUnit;
use crate::model::LengthUnit;

/// Names of the values in the file, or the ends of these names.
const OFFSET: &str = "wheel offset";
const RIM_DIAMETER: &str = "tire rim_diameter";
const SECTION_WIDTH: &str = "tire section_width";
const ASPECT_RATIO: &str = "tire aspect_ratio";

/// Largest aspect ratio that is read. Tyres have at most about 1.
const MOST_ASPECT_RATIO: f64 = 2.0;

/// Moves each hub face to the wheel centre, and adds the tyre's nominal radius. Does nothing if the table has no wheel offset. A
/// table without a unit is read in millimetres.
///
/// # Errors
/// Both points of the axis coincide, or the aspect ratio of the tyre is not a fraction.
pub(super) fn to_wheel_centres(table: &mut PointTable) -> Result<(), String> {
    let ends_with = |name: &str, end: &str| name == end || name.ends_with(&format!(" {end}"));
    let number = |end: &str| {
        let mut figures = table.figures.iter();
        let found = figures.find(|figure| ends_with(&figure.name, end));
        found.map(|figure| figure.value)
    };
    let Some(offset) = number(OFFSET) else {
        return Ok(());
    };
    let unit = table.unit;
    let unit = unit.unwrap_or(FileUnit::of(LengthUnit::Millimetre));
    let millimetre = unit.unit.per_metre() / unit.factor / 1000.0;
    let tyre = (
        number(RIM_DIAMETER),
        number(SECTION_WIDTH),
        number(ASPECT_RATIO),
    );
    let inboard = |point: &&NamedPoint| ends_with(&point.name, "axle_inboard");
    let inboard: Vec<NamedPoint> = table.points.iter().filter(inboard).cloned().collect();
    let faces = table.points.iter_mut();
    for face in faces.filter(|point| ends_with(&point.name, "axle_outboard")) {
        let same_wheel = inboard.iter().find(|point| point.marks == face.marks);
        let (Some(Ok(inner)), Ok(outer)) = (same_wheel.map(|p| &p.position), &face.position) else {
            continue;
        };
        let axis: [f64; 3] = std::array::from_fn(|k| outer[k] - inner[k]);
        let length = axis[0].hypot(axis[1]).hypot(axis[2]);
        let inward = offset * millimetre / length;
        if !inward.is_finite() {
            return Err(format!(
                "{}: the hub face and axle_inboard coincide, so there is no spin axis",
                face.place
            ));
        }
        table.notes.push(format!(
            "wheel_centre: {offset} mm inboard of the hub face {:?} along the spin axis",
            face.name
        ));
        face.position = Ok(std::array::from_fn(|k| outer[k] - inward * axis[k]));
        face.read_as = "wheel_centre".to_owned();
    }
    table
        .figures
        .retain(|figure| !ends_with(&figure.name, OFFSET));
    let is_radius = |given: &Figure| {
        figure(&given.read_as).is_some_and(|(kind, ..)| kind == FigureKind::WheelRadius)
    };
    // A loaded radius in the file has priority over the nominal one.
    let has_radius = table.figures.iter().any(is_radius);
    if let (Some(rim), Some(width), Some(ratio)) = tyre
        && !has_radius
    {
        // The ratio 55 instead of 0.55 would give a radius of 11 m.
        if !(0.0..=MOST_ASPECT_RATIO).contains(&ratio) {
            return Err(format!(
                "{ASPECT_RATIO} is {ratio}; expected a fraction, as in 0.55 for a tyre 205/55 R16"
            ));
        }
        let radius = (0.5 * 25.4 * rim + ratio * width) * millimetre;
        table.figures.push(Figure {
            name: "wheel radius".to_owned(),
            read_as: "wheel radius".to_owned(),
            value: radius,
            marks: Marks::default(),
            remark: String::new(),
            place: "the tyre's size".to_owned(),
        });
        table.notes.push(format!(
            "[wheel] radius: {radius} is the nominal radius of the tyre's size, not the loaded one"
        ));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tyre 205/55 R16: half of 16 in, plus a side wall of 0.55 times 205 mm, in each unit of the file.
    #[test]
    fn tyres_have_their_nominal_radius() {
        for unit in LengthUnit::ALL {
            let figure = |name: &str, value: f64| Figure {
                name: name.to_owned(),
                read_as: name.to_owned(),
                value,
                marks: Marks::default(),
                remark: String::new(),
                place: "row 1".to_owned(),
            };
            let point = |name: &str, position: [f64; 3]| NamedPoint {
                name: name.to_owned(),
                read_as: name.to_owned(),
                marks: Marks::default(),
                mirrored: false,
                position: Ok(position),
                has_number: true,
                body: None,
                place: "row 1".to_owned(),
            };
            let mut table = PointTable {
                points: vec![
                    point("axle_inboard", [0.0, 2.0, 1.0]),
                    point("axle_outboard", [0.0, 5.0, 5.0]),
                ],
                figures: vec![
                    figure("wheel offset", 40.0),
                    figure("tire rim_diameter", 16.0),
                    figure("tire section_width", 205.0),
                    figure("tire aspect_ratio", 0.55),
                ],
                unit: Some(FileUnit::of(unit)),
                ..PointTable::default()
            };
            let length = |mm: f64| unit.convert(mm, LengthUnit::Millimetre);
            let mut in_percent = table.clone();
            in_percent.figures[3].value = 55.0;
            let refused = to_wheel_centres(&mut in_percent).unwrap_err();
            assert!(refused.contains("aspect_ratio is 55"), "{refused}");
            to_wheel_centres(&mut table).unwrap();
            let radius = table.figures.iter().find(|f| f.name == "wheel radius");
            let radius = radius.unwrap().value;
            assert!(
                (radius / length(203.2 + 112.75) - 1.0).abs() < 1e-14,
                "{radius}"
            );
            // The wheel centre is 40 mm inboard of the hub face, along the spin axis (0, 3, 4).
            let centre = table.points[1].position.clone().unwrap();
            let expected = [0.0, 5.0 - 0.6 * length(40.0), 5.0 - 0.8 * length(40.0)];
            for (found, expected) in centre.iter().zip(expected) {
                assert!((found - expected).abs() < 1e-12, "{centre:?}");
            }
        }
    }
}
