//! Range of a mechanism: the values at which it folds (turning points at which the motion reverses), the reasons, and
//! the derivatives of these values with respect to the design.
//!
//! Let F be the closure equations, x the pose, q the drive value and p the hardpoints. Subscripts denote derivatives.
//! At a fold, the pose can still move along a direction t while the drive value does not change: F_x t = 0. There are
//! multipliers w with w F_x = 0 and w F_q = 1. The value q at the fold satisfies
//!
//! ```text
//! F(x, q, p) = 0   =>   dq/dp = - w . F_p                                         (1)
//! ```
//!
//! The change of the pose cancels, so the gradient needs only one back-substitution.
//!
//! `solve::cause` finds the reason for the fold.

use crate::derive::MotionPoint;
use crate::derive::sensitivity::HardpointGradient;
use crate::mechanism::DesignFault;
use crate::mechanism::Pose;
use crate::mechanism::ROUNDING;
use crate::mechanism::RowSet;
use crate::mechanism::{LimitCause, PartMeasure, Toggle};
use crate::model::Drive;
use crate::model::{PointId, RockerId, Rod};
use crate::number::{Each, Vector3};
use crate::solve::cause::{dependent_links, nearest_part, outer_ends};
use crate::solve::continuation::{Curve, CurvePoint, Moving, PathEnd};
use crate::solve::{Solver, StationOrder};
use std::ops::ControlFlow;

/// A limit of the motion: a value at which the mechanism folds.
#[derive(Clone, Debug, PartialEq)]
pub struct Limit {
    /// Value of the limited coordinate (travel, rack or arm angle) at the fold, in the mechanism's length unit or in radians.
    pub value: f64,
    /// Reason why the mechanism cannot move beyond `value`.
    pub cause: LimitCause,
    /// Part that is nearest to a singular position, if the mechanism is a strut or a double wishbone with a closed
    /// form.
    pub nearest: Option<PartMeasure>,
    /// Outer ends of the links that are at a toggle with each other. Empty if such a toggle is not the reason for the fold. For
    /// a rigid axle, the list contains the outer end of the link with the largest force at the fold.
    pub dependent: Vec<PointId>,
    /// Pose at the fold.
    pub pose: Pose<f64>,
    /// Derivative of `value` with respect to every point of the design.
    pub gradient: Vec<Vector3<f64>>,
    /// Derivative of `value` with respect to the drive value. It belongs to a limit of the rack, or of the travel of a rigid axle
    /// that is not the drive. 0 for a limit of the drive itself.
    pub by_drive: f64,
}

/// One end of a range.
#[derive(Clone, Debug, PartialEq)]
pub enum RangeEnd {
    /// The mechanism folds: its motion reverses.
    Fold(Limit),
    /// The arm can rotate fully: there is no limit before -pi or pi.
    FullTurn,
    /// Toggle of a rod that rotates a rocker of the mechanism, such as a Watt rocker: the rod is in line with its lever
    /// and the rocker's axis.
    Toggle {
        /// Value of the coordinate at the toggle, in the mechanism's length unit or in radians.
        value: f64,
        /// Rod that is at its toggle.
        rod: Rod,
    },
    /// The solver could not follow the motion beyond this value.
    Unresolved(f64),
}

impl RangeEnd {
    /// Value of the coordinate at the end. For a full turn, it is pi at both ends; see [`Range::ends`].
    pub fn value(&self) -> f64 {
        match self {
            RangeEnd::Fold(limit) => limit.value,
            RangeEnd::FullTurn => std::f64::consts::PI,
            RangeEnd::Toggle { value, .. } | RangeEnd::Unresolved(value) => *value,
        }
    }
}

/// Range of one coordinate around the design position, with the other coordinates fixed.
#[derive(Clone, Debug, PartialEq)]
pub struct Range {
    /// End of the range at negative values of the coordinate.
    pub lower: RangeEnd,
    /// End of the range at positive values of the coordinate.
    pub upper: RangeEnd,
}

impl Range {
    /// Distance from `value` to the nearer end. Negative if `value` is beyond this end.
    pub fn margin(&self, value: f64) -> f64 {
        let [lower, upper] = self.ends();
        (upper - value).min(value - lower)
    }

    /// Returns true if the range is empty, usually because the rack cannot reach its displacement.
    pub fn is_empty(&self) -> bool {
        use RangeEnd::Unresolved;
        matches!((&self.lower, &self.upper), (Unresolved(lower), Unresolved(upper)) if lower == upper)
    }

    /// Returns the values at both ends. If the coordinate can rotate fully, they are -pi and pi.
    pub fn ends(&self) -> [f64; 2] {
        let lower = match &self.lower {
            RangeEnd::FullTurn => -std::f64::consts::PI,
            end => end.value(),
        };
        [lower, self.upper.value()]
    }
}

/// Ranges of a suspension around its design position.
#[derive(Clone, Debug, PartialEq)]
pub struct Limits {
    /// Wheel travel, with the rack centred.
    pub travel: Range,
    /// Rack displacement towards the kernel's +y, at zero travel. `None` if no point is on the rack.
    pub rack: Option<Range>,
    /// Angle of the first arm (radians), with the rack centred. `None` if there is no arm.
    pub arm_angle: Option<Range>,
    /// Toggles of rockers within the range of the wheel travel, with the rack centred.
    pub rockers: Vec<RockerRange>,
}

/// Wheel travel until a rocker reaches a toggle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RockerRange {
    /// Rocker that reaches the toggles.
    pub rocker: RockerId,
    /// Toggle in droop. `None` if the wheel's own travel ends first, or if no toggle was found.
    pub lower: Option<Toggle>,
    /// Toggle in jounce. `None` if the wheel's own travel ends first, or if no toggle was found.
    pub upper: Option<Toggle>,
}

/// Number of steps to the end of the travel. A rocker is checked after each step, except at the end itself.
const LOOKS: u32 = 256;

impl Solver<'_> {
    /// Ranges of travel, rack and arm angle.
    ///
    /// # Errors
    /// Returns the fault of the design if the design position itself is singular.
    pub fn limits(&mut self) -> Result<Limits, DesignFault> {
        let mechanism = self.mechanism();
        let has_rack = mechanism.has_rack();
        let travel = self.drive_range(Drive::Travel, 0.0)?;
        let ends = [travel.lower.value(), travel.upper.value()];
        let rockers: Vec<RockerId> = (0..mechanism.rockers.len()).map(RockerId).collect();
        let [lower, upper] = ends.map(|end| self.toggles_towards(&rockers, end));
        let toggles = lower?.into_iter().zip(upper?);
        let ranges = rockers.into_iter().zip(toggles);
        let ranges = ranges.map(|(rocker, (lower, upper))| RockerRange {
            rocker,
            lower,
            upper,
        });
        Ok(Limits {
            travel,
            rockers: ranges.collect(),
            rack: has_rack.then(|| self.rack_range()).transpose()?,
            arm_angle: (!mechanism.arms.is_empty())
                .then(|| self.drive_range(Drive::ArmAngle, 0.0))
                .transpose()?,
        })
    }

    /// Finds the first toggle of each rocker as the wheel moves to `end`.
    fn toggles_towards(
        &mut self,
        rockers: &[RockerId],
        end: f64,
    ) -> Result<Vec<Option<Toggle>>, DesignFault> {
        if rockers.is_empty() {
            return Ok(Vec::new());
        }
        let places: Vec<f64> = (1..LOOKS)
            .map(|k| end * f64::from(k) / f64::from(LOOKS))
            .collect();
        let firsts = self.first_toggles(rockers, &places)?;
        let mut toggles = Vec::with_capacity(rockers.len());
        for (rocker, first) in rockers.iter().zip(firsts) {
            toggles.push(match first {
                None => None,
                Some((place, rod)) => {
                    let inside = place.checked_sub(1).map_or(0.0, |k| places[k]);
                    Some(self.toggle_between(*rocker, [inside, places[place]], rod)?)
                }
            });
        }
        Ok(toggles)
    }

    /// Finds the toggle of a rocker between two travels by halving. Only at the first travel the rocker has a position. `rod` is
    /// the rod at its toggle at the second travel.
    fn toggle_between(
        &mut self,
        rocker: RockerId,
        [mut inside, mut outside]: [f64; 2],
        mut rod: Rod,
    ) -> Result<Toggle, DesignFault> {
        while (outside - inside).abs() > ROUNDING * outside.abs() {
            let middle = 0.5 * (inside + outside);
            match self.first_toggles(&[rocker], &[middle])?[0] {
                Some((_, found)) => (outside, rod) = (middle, found),
                None => inside = middle,
            }
        }
        Ok(Toggle {
            travel: inside,
            rod,
        })
    }

    /// Finds for each rocker the first of several travels, in outward order, at which it has no position. Returns the index of
    /// this travel, and the rod at its toggle. `None` if there is no such travel, or if a travel before it has no pose.
    fn first_toggles(
        &mut self,
        rockers: &[RockerId],
        travels: &[f64],
    ) -> Result<Vec<Option<(usize, Rod)>>, DesignFault> {
        let mut firsts = vec![None; rockers.len()];
        self.for_each_pose(
            Drive::Travel,
            &StationOrder::through(travels),
            0.0,
            |solver, place, pose| {
                let Ok(pose) = pose else {
                    return ControlFlow::Break(());
                };
                let at = solver.configuration(pose, 0.0);
                for (rocker, first) in rockers.iter().zip(&mut firsts) {
                    *first = first.or_else(|| at.toggle(*rocker).map(|rod| (place, rod)));
                }
                if firsts.iter().all(Option::is_some) {
                    ControlFlow::Break(())
                } else {
                    ControlFlow::Continue(())
                }
            },
        )?;
        Ok(firsts)
    }

    /// Range of a drive with the rack displaced by `rack` (towards the kernel's +y).
    ///
    /// # Errors
    /// Returns the fault of the design if the design position itself is singular. If the rack cannot reach the displacement, there
    /// is no error: the range is empty, with both ends at zero and unresolved.
    pub fn drive_range(&mut self, drive: Drive, rack: f64) -> Result<Range, DesignFault> {
        self.range(drive, Moving::Drive, rack)
    }

    /// Range of the rack, with the drive at zero travel. For a rigid axle, range of the travel that is not the drive.
    ///
    /// # Errors
    /// Returns the fault of the design if the design position itself is singular.
    pub(crate) fn rack_range(&mut self) -> Result<Range, DesignFault> {
        self.range(Drive::Travel, Moving::Rack, 0.0)
    }

    fn range(&mut self, drive: Drive, moving: Moving, rack: f64) -> Result<Range, DesignFault> {
        let start = match self.placed(drive, rack)? {
            Ok(start) => start,
            Err(_) => {
                return Ok(Range {
                    lower: RangeEnd::Unresolved(0.0),
                    upper: RangeEnd::Unresolved(0.0),
                });
            }
        };
        let farthest = match (moving, drive) {
            (Moving::Drive, Drive::ArmAngle) => std::f64::consts::PI,
            _ => f64::INFINITY,
        };
        let curve = self.curve(moving, start.1);
        let value = match moving {
            Moving::Drive => start.1.value,
            Moving::Rack => start.1.rack,
        };
        let end = |target: f64| match curve.to(&start.0, value, target) {
            Ok(_) => RangeEnd::FullTurn,
            Err(PathEnd::Unresolved(value)) => RangeEnd::Unresolved(value),
            Err(PathEnd::Fold(fold)) => {
                let (at, cause) = (curve.configuration(&fold), curve.cause(&fold));
                RangeEnd::Fold(Limit {
                    value: fold.value(),
                    cause,
                    nearest: nearest_part(&at),
                    dependent: match cause {
                        LimitCause::DependentLinks => {
                            dependent_links(curve.closure, &at, curve.size)
                        }
                        LimitCause::AxleFolds => curve.holding_link(&fold).into_iter().collect(),
                        _ => Vec::new(),
                    },
                    pose: fold.pose(),
                    gradient: curve.fold_gradient(&fold),
                    by_drive: match moving {
                        Moving::Drive => 0.0,
                        // The last closure equation is the drive's equation: wheel-centre height minus drive.
                        Moving::Rack => curve.fold_multipliers(&fold)[5],
                    },
                })
            }
        };
        let range = Range {
            lower: end(-farthest),
            upper: end(farthest),
        };
        match moving {
            Moving::Drive => self.with_toggles(range, drive, rack),
            Moving::Rack => Ok(range),
        }
    }

    /// If the solver could not follow the motion beyond an end of the range, a rod may be at its toggle there. The rod is the link
    /// of a Watt rocker, or the drag link or tie rod of a knuckle. In this case, the function replaces the end by this toggle.
    /// Beyond the toggle, the Watt rocker or knuckle has no position.
    fn with_toggles(
        &mut self,
        mut range: Range,
        drive: Drive,
        rack: f64,
    ) -> Result<Range, DesignFault> {
        let rods = self.mechanism().rockers.iter().map(|rocker| rocker.rod);
        let holding = rods
            .enumerate()
            .filter(|(_, rod)| matches!(rod, Rod::WattLink | Rod::DragLink | Rod::TieRod));
        let holding: Vec<(usize, Rod)> = holding.collect();
        for end in [&mut range.lower, &mut range.upper] {
            let RangeEnd::Unresolved(value) = *end else {
                continue;
            };
            for (rocker, rod) in &holding {
                let leverage = self.least_leverage(RockerId(*rocker), drive, [value, rack])?;
                if leverage < AT_TOGGLE {
                    *end = RangeEnd::Toggle { value, rod: *rod };
                    break;
                }
            }
        }
        Ok(range)
    }

    /// Returns the smallest leverage of a rod in poses shortly before a value of the drive. Infinite without such
    /// poses.
    fn least_leverage(
        &mut self,
        rocker: RockerId,
        drive: Drive,
        [value, rack]: [f64; 2],
    ) -> Result<f64, DesignFault> {
        let places = BEFORE_END.each(|share| value * share);
        let mut leverage = f64::INFINITY;
        self.for_each_pose(
            drive,
            &StationOrder::through(&places),
            rack,
            |solver, _, pose| {
                let Ok(pose) = pose else {
                    return ControlFlow::Break(());
                };
                let found = solver.configuration(pose, rack).leverage(rocker);
                leverage = if found.is_finite() {
                    leverage.min(found)
                } else {
                    leverage
                };
                ControlFlow::Continue(())
            },
        )?;
        Ok(leverage)
    }
}

/// Positions at which the leverage of a rod is checked, as fractions of the distance from the design position to an end of the
/// range.
const BEFORE_END: [f64; 4] = [0.99, 0.9999, 0.999_999, 0.999_999_99];
/// Leverage below which a rod counts as being at its toggle. At this leverage, the angle between the rod and its lever is about
/// half a degree.
pub(crate) const AT_TOGGLE: f64 = 0.01;

impl Curve<'_> {
    /// Returns the outer end of the link with the largest force at the fold. This force is proportional to the link's multiplier w
    /// in equation (1) of this module.
    fn holding_link(&self, fold: &CurvePoint) -> Option<PointId> {
        let ends = outer_ends(self.mechanism).into_iter();
        let forces = ends.zip(self.fold_multipliers(fold));
        let links = forces.filter_map(|(end, force)| Some((end?, force.abs())));
        let largest = links.max_by(|a, b| a.1.total_cmp(&b.1));
        largest.map(|(end, _)| end)
    }

    /// Derivative of the value at a fold with respect to every point of the design.
    fn fold_gradient(&self, fold: &CurvePoint) -> Vec<Vector3<f64>> {
        let motion: MotionPoint<f64> = self.motion(fold.value());
        let at = self.configuration(fold);
        let mut gradient = vec![Vector3::new(0.0, 0.0, 0.0); self.design.len()];
        self.closure.differential(
            RowSet::ALL,
            &at,
            motion.driver(),
            &self.fold_multipliers(fold).each(|m| -m),
            &mut HardpointGradient(gradient.as_mut_slice()),
        );
        gradient
    }
}
