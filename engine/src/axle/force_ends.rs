//! Finds poses in which a spring is in tension, or in which a spring or bump stop is beyond the ends of its force
//! curve.

use super::spring::{ForceCurve, Law, SpringLaw};
use super::{Axle, AxleCurves};
use crate::mechanism::Configuration;
use crate::model::Side;

/// Part with a force curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ForcePart {
    /// Spring, with its length as abscissa.
    Spring,
    /// Bump stop, with its compression as abscissa.
    BumpStop,
}

/// Pose in which a part is farthest beyond an end of its force curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeyondCurve {
    /// Wheel to which the part belongs.
    pub side: Side,
    /// Part whose force curve is exceeded.
    pub part: ForcePart,
    /// Length of the spring or compression of the bump stop, in the study's unit.
    pub value: f64,
    /// Length of the spring or compression of the bump stop at this end of the curve, in the same unit.
    pub end: f64,
    /// Travel of the wheel.
    pub travel: f64,
}

/// Station at which a spring is in tension.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pull {
    /// Wheel to which the spring belongs.
    pub side: Side,
    /// Force of the spring without its stops, in newtons. It is negative.
    pub force: f64,
    /// Index of this station in the curves.
    pub station: usize,
}

impl BeyondCurve {
    fn distance(&self) -> f64 {
        (self.value - self.end).abs()
    }
}

impl Axle {
    /// Finds the station farthest beyond each end of the force curves of springs and bump stops, for each wheel. Rebound stops
    /// are not checked.
    pub fn beyond_force_curves(&self, curves: &AxleCurves) -> Vec<BeyondCurve> {
        let mut found: Vec<BeyondCurve> = Vec::new();
        for placed in &curves.placed {
            let Ok(placed) = placed else {
                continue;
            };
            for side in Side::ALL {
                let travel = placed.travels[side as usize];
                let rack = placed.rack * side.sign();
                let pose = placed.poses()[side as usize];
                let beyond = self.beyond_at(side, pose, rack);
                for (part, value, end) in beyond.into_iter().flatten() {
                    let here = BeyondCurve {
                        side,
                        part,
                        value,
                        end,
                        travel,
                    };
                    let same = |b: &&mut BeyondCurve| (b.side, b.part, b.end) == (side, part, end);
                    match found.iter_mut().find(same) {
                        Some(known) if known.distance() < here.distance() => *known = here,
                        Some(_) => {}
                        None => found.push(here),
                    }
                }
            }
        }
        found
    }

    /// Finds the station with the largest tension in a spring. `None` if no spring is in tension. The forces of stops
    /// are excluded, because a rebound stop is always in tension.
    pub fn pulling_spring(&self, curves: &AxleCurves) -> Option<Pull> {
        let stations = curves.placed.iter().enumerate();
        let forces = stations.flat_map(|(station, placed)| {
            let placed = placed.as_ref().ok();
            let of_side = move |side: Side| {
                let placed = placed?;
                let (pose, rack) = (placed.poses()[side as usize], placed.rack * side.sign());
                let ([length, design], law) = self.spring_lengths(side, pose, rack)?;
                Some(Pull {
                    side,
                    force: law.force_without_stops(length, design),
                    station,
                })
            };
            Side::ALL.into_iter().filter_map(of_side)
        });
        let least = forces.min_by(|a, b| a.force.total_cmp(&b.force))?;
        (least.force < 0.0).then_some(least)
    }

    /// Returns the length of a wheel's spring in a pose, its length in the design position, and its law. `None` without
    /// a spring.
    fn spring_lengths(
        &self,
        side: Side,
        pose: crate::mechanism::Pose<f64>,
        rack: f64,
    ) -> Option<([f64; 2], &SpringLaw)> {
        let wheel = self.suspension(side);
        let (spring, springs) = (wheel.mechanism.spring?, self.setup.springs.as_ref()?);
        let at = Configuration::new(&wheel.mechanism, &wheel.design, pose, rack);
        let length = (at.point(spring.upper) - at.point(spring.lower)).norm();
        let design = (at.designed(spring.upper) - at.designed(spring.lower)).norm();
        Some(([length, design], &springs[side as usize]))
    }

    /// Returns the parts of a wheel that are beyond an end of their force curve in a pose. For each part, the result
    /// contains the value and the end of the curve.
    fn beyond_at(
        &self,
        side: Side,
        pose: crate::mechanism::Pose<f64>,
        rack: f64,
    ) -> [Option<(ForcePart, f64, f64)>; 2] {
        let Some(([length, design], law)) = self.spring_lengths(side, pose, rack) else {
            return [None; 2];
        };
        let of_spring = match &law.spring {
            Law::Curve(curve) => beyond(curve, length).map(|end| (ForcePart::Spring, length, end)),
            Law::Linear { .. } => None,
        };
        let stop = law.bump_stop.as_ref().and_then(|stop| {
            let compression = law.shortened(length, design) - stop.gap;
            let end = beyond(&stop.curve, compression).filter(|_| compression > 0.0)?;
            Some((ForcePart::BumpStop, compression, end))
        });
        [of_spring, stop]
    }
}

/// Returns the end of the curve that a value exceeds. `None` if the value is within the curve.
fn beyond(curve: &ForceCurve, value: f64) -> Option<f64> {
    let (first, last) = (curve.points().first()?[0], curve.points().last()?[0]);
    if value < first {
        Some(first)
    } else if value > last {
        Some(last)
    } else {
        None
    }
}
