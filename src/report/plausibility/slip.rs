//! Warning about one coordinate with a wrong sign or decimal place, which explains all other warnings.

use super::doubts;
use crate::model::{PointId, Suspension};
use crate::number::Vector3;
use crate::report::Slip;

/// Warning about the one coordinate that explains all other warnings. `None` if there is no such coordinate.
pub(super) fn explains(suspension: &Suspension) -> Option<String> {
    let own: Vec<[f64; 3]> = suspension.design.iter().map(|p| p.to_array()).collect();
    let with = |points: &[[f64; 3]]| Suspension {
        design: points.iter().copied().map(Vector3::from).collect(),
        ..suspension.clone()
    };
    let slip = Slip::of(&own, |points| {
        doubts(&with(points)).is_ok_and(|doubts| doubts.is_empty())
    })?;
    let id = PointId(slip.point);
    let written = |at: Vector3<f64>| suspension.frame.vector(at).to_array()[slip.axis] + 0.0;
    let mut likely = own.clone();
    likely[slip.point][slip.axis] = slip.likely;
    let words = slip.describe(
        written(suspension.design[id.0]),
        written(Vector3::from(likely[slip.point])),
    );
    Some(format!(
        "please check: {} seems to have {words}: with this value the suspension is plausible",
        suspension.mechanism.name(id)
    ))
}
