//! `[bushings.NAME]`: point, force laws and axes of a bushing.

use super::super::axle;
use super::super::error::{Problems, Source, StudyError, StudyErrors};
use super::super::file;
use super::super::names::nearest;
use super::super::source::{LONGEST_TEXT, read_text};
use super::super::suspension::three;
use super::super::value::{Number, Text};
use crate::axle::ForceCurve;
use crate::compliance::{BushingPart, Shape, bushing_points};
use crate::model::{Constraint, LengthUnit, PointId, Suspension};
use crate::number::{Each, Vector3};
use hardpoint_study_file::bushing_file::{self, CurvePoint};
use std::path::Path;
use std::sync::Arc;
use toml::Spanned;

/// Sine of the smallest angle, 1 degree, between the directions of the x axis and the z axis.
const NEARLY_PARALLEL: f64 = 0.01745;

/// Keys of the force and torque curves of a bushing.
const CURVES: [&str; 6] = ["fx", "fy", "fz", "tx", "ty", "tz"];

/// Reads six numbers that satisfy `is_right`. Returns `default` if the key is missing.
fn six(
    written: &Option<Spanned<Vec<Number>>>,
    default: f64,
    expected: &str,
    is_right: impl Fn(f64) -> bool,
    problems: &mut Problems,
) -> Option<[f64; 6]> {
    let Some(list) = written else {
        return Some([default; 6]);
    };
    let Ok(numbers) = <&[Number; 6]>::try_from(list.get_ref().as_slice()) else {
        let message = format!(
            "expected six numbers (along x, y, z and about them), found {}",
            list.get_ref().len()
        );
        return problems.refuse(list.span(), &message);
    };
    for number in numbers {
        if !is_right(number.value) {
            let message = format!("expected {expected}, found {}", number.value);
            return problems.refuse(number.span.clone(), &message);
        }
    }
    Some(numbers.each_ref().each(|number| number.value))
}

/// Reads a bushing.
pub(super) fn bushing(
    name: &Text,
    written: &Spanned<file::Bushing>,
    suspension: &Suspension,
    directory: &Path,
    problems: &mut Problems,
) -> Option<BushingPart> {
    let point = bushing_point(name, suspension, problems)?;
    let Rubber {
        shapes,
        preload,
        x_axis,
        z_axis,
    } = rubber(name, written, suspension, directory, problems)?;
    let part = BushingPart {
        point,
        shapes,
        preload,
        x_axis,
        z_axis,
    };
    let mechanism = &suspension.mechanism;
    let is_top = |c: &Constraint| matches!(c, Constraint::StrutLine { top, .. } if *top == point);
    let default_z = if mechanism.constraints.iter().any(is_top) {
        "the line of the strut"
    } else {
        "the vertical"
    };
    let directions = part.directions(mechanism, &suspension.design);
    check_directions(name, written, directions, default_z, problems)?;
    Some(part)
}

/// Force laws and axes of a bushing, without its position.
pub(super) struct Rubber {
    pub(super) shapes: [Shape; 6],
    pub(super) preload: [f64; 6],
    pub(super) x_axis: Option<Vector3<f64>>,
    pub(super) z_axis: Option<Vector3<f64>>,
}

/// Reads the force laws and axes of a bushing.
pub(super) fn rubber(
    name: &Text,
    written: &Spanned<file::Bushing>,
    suspension: &Suspension,
    directory: &Path,
    problems: &mut Problems,
) -> Option<Rubber> {
    let part = written.get_ref();
    let shapes = match &part.file {
        None => shapes(name, written, problems)?,
        Some(file) => {
            let length = suspension.length_unit;
            shapes_of_file(name, file, part, directory, length, problems)?
        }
    };
    let any = |_: f64| true;
    let preload = six(&part.preload, 0.0, "a number", any, problems)?;
    if name.get_ref() == "strut_top" && !is_free_about_z(&shapes, &preload) {
        let message = "a strut turns freely about its line: expected 0.0 as the last entry of \
                       stiffness, cubic and preload, and no torque tz";
        return problems.refuse(written.span(), message);
    }
    let direction = |axis: &Option<file::Coordinates>, problems: &mut Problems| match axis {
        None => Some(None),
        Some(written) => {
            let v = three(written, "components [x, y, z]", problems)?;
            if v == Vector3::default() {
                return problems.refuse(
                    written.span(),
                    "expected a direction, found a vector of length 0",
                );
            }
            Some(Some(suspension.frame.vector(v)))
        }
    };
    let x_axis = direction(&part.x_axis, problems)?;
    let z_axis = direction(&part.z_axis, problems)?;
    Some(Rubber {
        shapes,
        preload,
        x_axis,
        z_axis,
    })
}

fn bushing_point(name: &Text, suspension: &Suspension, problems: &mut Problems) -> Option<PointId> {
    let mechanism = &suspension.mechanism;
    let points = bushing_points(mechanism);
    let found = points
        .iter()
        .find(|id| mechanism.name(**id) == name.get_ref());
    if found.is_none() {
        let message = format!("{:?} cannot have a bushing", name.get_ref());
        let error = problems.add(name.span(), message);
        let names = || points.iter().map(|id| mechanism.name(*id));
        match nearest(name.get_ref(), names()) {
            Some(near) => error.help(format!("did you mean \"{near}\"?")),
            None => error.help(format!(
                "bushings may be at {}",
                names().collect::<Vec<_>>().join(", ")
            )),
        };
    }
    found.copied()
}

/// Force laws of a bushing along its axes, and torque laws about them.
fn shapes(
    name: &Text,
    written: &Spanned<file::Bushing>,
    problems: &mut Problems,
) -> Option<[Shape; 6]> {
    let part = written.get_ref();
    let curves = [&part.fx, &part.fy, &part.fz, &part.tx, &part.ty, &part.tz];
    if part.stiffness.is_none() && curves.iter().any(|curve| curve.is_none()) {
        let message = format!(
            "expected the key stiffness for {:?}, or the six curves fx, fy, fz, \
                               tx, ty and tz",
            name.get_ref()
        );
        return problems.refuse(written.span(), &message);
    }
    let not_negative = |number: f64| number >= 0.0;
    let zero_or_more = "a number of 0 or more";
    let stiffness = six(&part.stiffness, 0.0, zero_or_more, not_negative, problems);
    let cubic = six(&part.cubic, 0.0, zero_or_more, not_negative, problems);
    let above = |number: f64| number > 0.0;
    let scale = six(&part.scale, 1.0, "a number above 0", above, problems);
    let (stiffness, cubic, scale) = (stiffness?, cubic?, scale?);
    let mut shapes = Vec::new();
    for (k, curve) in curves.into_iter().enumerate() {
        let Some(curve) = curve else {
            shapes.push(Shape::Cubic {
                rate: stiffness[k] * scale[k],
                cubic: cubic[k] * scale[k],
            });
            continue;
        };
        if stiffness[k] != 0.0 || cubic[k] != 0.0 {
            let key = ["fx", "fy", "fz", "tx", "ty", "tz"][k];
            let message = format!(
                "{key} already gives the curve of this axis; expected 0.0 as entry {} of stiffness and cubic",
                k + 1
            );
            return problems.refuse(curve.span(), &message);
        }
        shapes.push(Shape::Curve {
            curve: rising(curve, problems)?,
            scale: scale[k],
        });
    }
    shapes.try_into().ok()
}

fn is_free_about_z(shapes: &[Shape; 6], preload: &[f64; 6]) -> bool {
    let is_free = matches!(shapes[5], Shape::Cubic { rate, cubic } if rate == 0.0 && cubic == 0.0);
    is_free && preload[5] == 0.0
}

/// Checks that both numbers of a curve rise from point to point.
fn rising(
    written: &Spanned<Vec<Spanned<Vec<Number>>>>,
    problems: &mut Problems,
) -> Option<ForceCurve> {
    let curve = axle::force_curve(written, 1.0, problems)?;
    for (k, pair) in curve.points().windows(2).enumerate() {
        if pair[0][1] >= pair[1][1] {
            let message = format!(
                "expected each force above the force of the point before it, found {} after {}",
                pair[1][1], pair[0][1]
            );
            return problems.refuse(written.get_ref()[k + 1].span(), &message);
        }
    }
    Some(curve)
}

/// Checks that two different directions give the axes of a bushing. `default_z` describes the z direction without the key
/// z_axis.
pub(super) fn check_directions(
    name: &Text,
    written: &Spanned<file::Bushing>,
    [x, z]: [Vector3<f64>; 2],
    default_z: &str,
    problems: &mut Problems,
) -> Option<()> {
    if x.normalised().cross(z.normalised()).norm() >= NEARLY_PARALLEL {
        return Some(());
    }
    let name = name.get_ref();
    let message = match written.get_ref().z_axis {
        Some(_) => format!(
            "the x axis and the z axis of {name:?} are within 1 degree of each other: expected another direction as z_axis"
        ),
        None => format!(
            "the x axis of {name:?} is within 1 degree of {default_z}: expected z_axis, or another direction as x_axis"
        ),
    };
    problems.refuse(written.span(), &message)
}

/// Force and torque laws of a bushing from a property file.
fn shapes_of_file(
    name: &Text,
    path: &Text,
    written: &file::Bushing,
    directory: &Path,
    length: LengthUnit,
    problems: &mut Problems,
) -> Option<[Shape; 6]> {
    let curves = [
        &written.fx,
        &written.fy,
        &written.fz,
        &written.tx,
        &written.ty,
        &written.tz,
    ];
    let mut others = vec![
        ("stiffness", written.stiffness.as_ref().map(Spanned::span)),
        ("cubic", written.cubic.as_ref().map(Spanned::span)),
    ];
    let spans = curves.iter().map(|curve| curve.as_ref().map(Spanned::span));
    others.extend(CURVES.into_iter().zip(spans));
    for (key, span) in others {
        if let Some(span) = span {
            let message = format!(
                "the file already gives the curves of {:?}: remove the key {key}",
                name.get_ref()
            );
            return problems.refuse(span, &message);
        }
    }
    let above = |number: f64| number > 0.0;
    let scale = six(&written.scale, 1.0, "a number above 0", above, problems)?;
    let full = directory.join(path.get_ref());
    let text = match read_text(&full, LONGEST_TEXT) {
        Ok(text) => text,
        Err(reason) => {
            let message = format!("cannot read {}: {reason}", full.display());
            let error = problems.add(path.span(), message);
            error.help("the path is relative to the study file");
            return None;
        }
    };
    let source = Arc::new(Source {
        name: full.display().to_string(),
        text,
    });
    let shapes = bushing_file::read(&source).and_then(|file| {
        let curves = file.curves.iter().zip(scale).enumerate();
        let shapes: Result<Vec<Shape>, StudyErrors> = curves
            .map(|(k, (points, scale))| shape_of_points(k, points, scale, length, &source))
            .collect();
        shapes
    });
    match shapes {
        Ok(shapes) => shapes.try_into().ok(),
        Err(error) => {
            problems.append(error);
            None
        }
    }
}

/// Force law through the points of a property file. A curve that is 0 everywhere means no stiffness.
fn shape_of_points(
    axis: usize,
    points: &[CurvePoint],
    scale: f64,
    length: LengthUnit,
    source: &Arc<Source>,
) -> Result<Shape, StudyErrors> {
    if points.iter().all(|point| point.force == 0.0) {
        return Ok(Shape::Cubic {
            rate: 0.0,
            cubic: 0.0,
        });
    }
    let wrong = points
        .windows(2)
        .find(|pair| pair[0].deflection >= pair[1].deflection || pair[0].force >= pair[1].force);
    if let Some([_, second]) = wrong {
        let message = format!(
            "the curve {} must rise in both numbers: expected each number above the number in the line before",
            CURVES[axis]
        );
        let place = Some(second.place.clone());
        return Err(StudyError::new(source.clone(), place, message).into());
    }
    let metre = length.per_metre();
    let [of_deflection, of_force] = if axis < 3 { [metre, 1.0] } else { [1.0, metre] };
    let points: Vec<[f64; 2]> = points
        .iter()
        .map(|point| [point.deflection * of_deflection, point.force * of_force])
        .collect();
    let curve = ForceCurve::through(&points);
    let curve =
        curve.ok_or_else(|| StudyError::new(source.clone(), None, "the curve has no points"))?;
    Ok(Shape::Curve { curve, scale })
}

/// Force and torque laws of a bushing from a file, in a form that a study's text can contain.
#[derive(Clone, Debug)]
pub(in super::super) struct BushingText {
    /// Name of the bushing.
    pub name: String,
    /// Key of each curve with its points, without the factor `scale`. Axes without stiffness are left out.
    pub curves: Vec<(&'static str, Vec<[f64; 2]>)>,
}

impl BushingText {
    /// Converts the force and torque laws of a bushing that came from a file.
    pub(in super::super) fn of(name: &str, shapes: &[Shape; 6]) -> Self {
        let curves = CURVES.into_iter().zip(shapes);
        let given = curves.filter_map(|(key, shape)| match shape {
            Shape::Curve { curve, .. } => Some((key, curve.points().to_vec())),
            Shape::Cubic { .. } => None,
        });
        BushingText {
            name: name.to_owned(),
            curves: given.collect(),
        }
    }
}
