//! Warnings about the positions of the carrier's joints and of the arms' pivots.

use super::PlausibilityRemarks;
use super::distances::FAR;
use crate::model::{Body, Constraint, Mechanism, PointId, Suspension};
use crate::number::Vector3;
use crate::report::figure::brief;

/// Largest plausible distance of the wheel centre beyond the points of its carrier, in wheel radii. The first number is for the
/// height, the second for the direction x.
const OFF_CARRIER: [f64; 2] = [0.25, 1.0];

/// Largest plausible distance of an outer joint from the wheel centre, in wheel radii. Outer joints are inside the rim or a
/// little above the tyre.
const JOINT: f64 = 2.0;
/// Largest plausible distance between the front and the rear pivot of an arm, in wheel radii.
const PIVOTS_APART: f64 = 3.0;
/// Largest plausible distance of an inner joint beyond the centre plane, relative to the distance between the wheel and this
/// plane.
const BEYOND_CENTRE: f64 = 0.1;

impl PlausibilityRemarks<'_> {
    /// Warnings about joints of arms and links. One of their coordinates may have a wrong sign or decimal place. There are three
    /// cases. An outer joint is far from the wheel centre, an inner joint is on the other side of the car, or the pivots of one arm
    /// are far apart. Rigid axles are left out.
    pub(super) fn joints(&mut self) {
        let Suspension {
            mechanism,
            length_unit,
            ..
        } = self.suspension;
        if mechanism.rigid_axle.is_some() {
            return;
        }
        let wheel_radius = self.usual_radius();
        let unit = length_unit.symbol();
        let centre = self.at(mechanism.wheel_centre);
        let mut outer = carrier_joints(mechanism);
        outer.retain(|id| mechanism.body(*id) == Body::Knuckle);
        for id in outer {
            let away = (self.at(id) - centre).norm();
            // Another warning names points that are even farther away.
            if wheel_radius.is_some_and(|radius| away > JOINT * radius && away <= FAR * radius) {
                self.say(format!(
                    "{} is {} {unit} away from wheel_centre. Is one of its coordinates wrong?",
                    self.name(id),
                    brief(away)
                ));
            }
        }
        let links = mechanism.constraints.iter().filter_map(Constraint::link);
        let pivots = mechanism.arms.iter().flat_map(|arm| [arm.front, arm.rear]);
        let inner = links.map(|(inner, _)| inner).chain(pivots);
        let inner = inner.filter(|id| matches!(mechanism.body(*id), Body::Chassis | Body::Rack));
        for id in without_repetition(inner) {
            let y = self.at(id).y;
            if y < -BEYOND_CENTRE * centre.y {
                self.say(format!(
                    "{} is {} {unit} beyond the centre plane, on the other side of the car. Does y have the wrong sign?",
                    self.name(id),
                    brief(-y)
                ));
            }
        }
        for arm in &mechanism.arms {
            let apart = (self.at(arm.front) - self.at(arm.rear)).norm();
            if wheel_radius.is_some_and(|radius| apart > PIVOTS_APART * radius) {
                let [front, rear] = [arm.front, arm.rear].map(|id| self.name(id));
                self.say(format!(
                    "{front} and {rear} are {} {unit} apart. Is one of their coordinates wrong?",
                    brief(apart)
                ));
            }
        }
    }

    /// Warning about a wheel centre well above, below, ahead of or behind all points of its carrier. Probably its coordinates
    /// have another unit or origin. Rigid axles are left out: their points may all be high above the wheel centres.
    pub(super) fn wheel_centre_off_its_carrier(&mut self) {
        let Suspension {
            mechanism,
            design,
            length_unit,
            ..
        } = self.suspension;
        let usual = self.usual_radius();
        let Some(radius) = usual.filter(|_| mechanism.rigid_axle.is_none()) else {
            return;
        };
        let joints = carrier_joints(mechanism);
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

/// Joints of the wheel carrier: outer ends of links and arms, and the top mount of a strut.
fn carrier_joints(mechanism: &Mechanism) -> Vec<PointId> {
    let joint = |constraint: &Constraint| match *constraint {
        Constraint::Link { outer, .. } => Some(outer),
        Constraint::StrutLine { top, .. } => Some(top),
        Constraint::BallJoint { at } | Constraint::ArmJoint { at, .. } => Some(at),
        _ => None,
    };
    without_repetition(mechanism.constraints.iter().filter_map(joint))
}

/// These points, each once, in the order of their first occurrence.
fn without_repetition(points: impl Iterator<Item = PointId>) -> Vec<PointId> {
    let mut once = Vec::new();
    for id in points {
        if !once.contains(&id) {
            once.push(id);
        }
    }
    once
}
