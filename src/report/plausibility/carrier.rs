//! Warning about the position of the wheel centre on its carrier.

use super::PlausibilityRemarks;
use crate::model::{Constraint, PointId, Suspension};
use crate::number::Vector3;
use crate::report::figure::brief;

/// Largest plausible distance of the wheel centre beyond the points of its carrier, in wheel radii: in height and along x.
const OFF_CARRIER: [f64; 2] = [0.25, 1.0];

impl PlausibilityRemarks<'_> {
    /// Warning about a wheel centre well above, below, ahead of or behind all points of its carrier. Probably its coordinates
    /// have another unit or origin. Axles are left out: their points may all be high above the wheel centres.
    pub(super) fn wheel_centre_off_its_carrier(&mut self) {
        let Suspension {
            mechanism,
            design,
            length_unit,
            wheel_radius,
            ..
        } = self.suspension;
        let Some(radius) = wheel_radius.filter(|_| mechanism.rigid_axle.is_none()) else {
            return;
        };
        let joint = |constraint: &Constraint| match *constraint {
            Constraint::Link { outer, .. } => Some(outer),
            Constraint::StrutLine { top, .. } => Some(top),
            Constraint::BallJoint { at } | Constraint::ArmJoint { at, .. } => Some(at),
            _ => None,
        };
        let mut joints: Vec<PointId> = mechanism.constraints.iter().filter_map(joint).collect();
        joints.dedup();
        let points: Vec<Vector3<f64>> = joints.into_iter().map(|id| design[id.0]).collect();
        if points.len() < 2 {
            return;
        }
        let centre = self.at(mechanism.wheel_centre);
        let [height, along] = OFF_CARRIER;
        for (k, limit, words) in [
            (2, height, ["above", "below"]),
            (0, along, ["ahead of", "behind"]),
        ] {
            let of = |point: &Vector3<f64>| point.to_array()[k];
            let low = points.iter().map(of).fold(f64::INFINITY, f64::min);
            let high = points.iter().map(of).fold(f64::NEG_INFINITY, f64::max);
            let here = of(&centre);
            let [above, below] = [here - high, low - here];
            let (off, word) = if above > below {
                (above, words[0])
            } else {
                (below, words[1])
            };
            if off > limit * radius {
                let unit = length_unit.symbol();
                self.say(format!(
                    "wheel_centre is {} {unit} {word} every joint of its carrier. Is it in another unit, or from another \
                     origin?",
                    brief(off)
                ));
            }
        }
    }
}
