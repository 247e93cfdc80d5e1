//! Tests of solid axles against independent results, and against their mirror images and limits.

mod beam_builds;
mod beam_loads;
mod beam_refused;
mod beam_set_up;
mod builds;
mod built_beam;
mod by_design;
mod certificate;
mod differences;
mod elastic;
mod kinds;
mod lanes;
mod loads;
mod own;
mod planted;
mod rates;
mod reference;
mod refused;
mod robust;
mod roll_limits;
mod set_up;
mod steered;
mod tolerance;
mod tuned;
mod twist_beam;
mod units;
mod watt;

use hardpoint::axle::{AxleSolver, Placement, Quantity};
use hardpoint::model::PointId;
use hardpoint::number::Vector3;
use hardpoint::study::{AxleStudy, Study};
use serde_json::Value;
use std::fmt::Write as _;
use std::path::Path;

/// Text of the study of a solid axle, with the points of the left half.
pub fn text(points: &[(&str, [f64; 3])], single: bool, further: &str) -> String {
    let mut text = String::from("[suspension]\ntopology = \"solid_axle\"\n");
    if single {
        text += "single = [\"upper_link\"]\n";
    }
    text += "[suspension.hardpoints]\n";
    for (name, [x, y, z]) in points {
        // Numbers in a study have a decimal point.
        let _ = writeln!(text, "{name} = [{x:?}, {y:?}, {z:?}]");
    }
    text + "[wheel]\nradius = 330.0\nstatic_camber = 0.0\nstatic_toe = 0.0\n[vehicle]\nwheelbase = 2700.0\n\
            cg_height = 620.0\nposition = \"rear\"\nbrakes = \"outboard\"\nbrake_share_front = 0.6\n\
            drive_torque = \"carrier\"\ndrive_share_front = 0.0\n"
        + further
}

/// Axle of a study.
pub fn axle(text: &str) -> AxleStudy {
    let study = Study::from_text("solid.toml", text, Path::new(""));
    let study = study.unwrap_or_else(|errors| panic!("{errors}\n{text}"));
    study.axle().expect("a solid axle is an axle").clone()
}

/// Returns derivatives of quantities with respect to a coordinate of a point, from difference quotients (fourth order) of
/// complete designs.
pub fn slopes_of_designs<const N: usize>(
    solver: &mut AxleSolver<'_, N>,
    (base, placement, wanted): (&[Vector3<f64>], &Placement, &[Quantity]),
    (point, axis): (PointId, usize),
) -> Vec<f64> {
    let mut value = |by: f64| -> Vec<f64> {
        let mut design = base.to_vec();
        let mut place = design[point.0].to_array();
        place[axis] += by;
        design[point.0] = place.into();
        solver.prepare([&design, &design]).unwrap();
        let placed = solver.place(placement).unwrap();
        let read = solver.read(&placed).unwrap();
        wanted.iter().map(|q| q.evaluate(&read.state)).collect()
    };
    let mut slope = |h: f64| -> Vec<f64> {
        let (above, below) = (value(h), value(-h));
        (0..wanted.len())
            .map(|k| (above[k] - below[k]) / (2.0 * h))
            .collect()
    };
    let (near, far) = (slope(0.05), slope(0.1));
    let slopes = near.iter().zip(far);
    slopes.map(|(near, far)| (4.0 * near - far) / 3.0).collect()
}

/// Placeholder motion for tests of single positions.
pub const STILL: &str = "[motion]\nheave = [0.0]\n";

/// Reference case in `tests/data/reference/solid`.
pub fn case(name: &str) -> Value {
    let path = format!(
        "{}/tests/data/reference/solid/{name}.json",
        env!("CARGO_MANIFEST_DIR")
    );
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{path}: {e}"));
    serde_json::from_str(&text).expect("valid JSON")
}

/// Names of the points of a reference case, in the study and in the reference.
pub fn points_of(case: &Value) -> Vec<(&'static str, &'static str)> {
    let names = [
        ("lower_link_chassis", "lower_left_chassis"),
        ("lower_link_axle", "lower_left_axle"),
        ("upper_link_chassis", "upper_left_chassis"),
        ("upper_link_axle", "upper_left_axle"),
        ("upper_link_chassis", "upper_chassis"),
        ("upper_link_axle", "upper_axle"),
        ("panhard_chassis", "panhard_chassis"),
        ("panhard_axle", "panhard_axle"),
        ("wheel_centre", "wheel_centre_left"),
        ("spring_upper", "spring_upper_left"),
        ("spring_lower", "spring_lower_left"),
    ];
    let given = names.into_iter();
    given
        .filter(|(_, name)| !case["points"][name].is_null())
        .collect()
}

/// Study of a reference case.
pub fn study_of(case: &Value, further: &str) -> String {
    let at = |name: &str| [0, 1, 2].map(|i| case["points"][name][i].as_f64().unwrap());
    let points: Vec<_> = points_of(case)
        .into_iter()
        .map(|(ours, theirs)| (ours, at(theirs)))
        .collect();
    let single = !case["points"]["upper_axle"].is_null();
    text(&points, single, further)
}
