//! Limits of an axle: the travel of each wheel, the rack of both wheels, and the roll angle.
//!
//! In roll, the rack is fixed, and the travels of both wheel centres are heave +- s. Roll continues until the first
//! wheel reaches the end of its travel. A rigid axle rolls until its links reach a fold, the turning point at which the
//! travel reverses. The roll angle at the end is the angle of the plane under both wheels.

use super::Axle;
use super::solver::{AxlePose, AxleSolver, Placement};
use crate::analyse::{AT_TOGGLE, Range, RangeEnd, RockerRange};
use crate::mechanism::{DesignFault, Failure, Pose};
use crate::model::{AxleTravel, Drive, Rod, Side};
use crate::number::Each;
use crate::solve::Solver;

/// Limits of an axle's motion, found by moving the axle away from its design position.
#[derive(Clone, Debug, PartialEq)]
pub struct AxleLimits {
    /// Ranges of the wheels' travels.
    pub travels: TravelRanges,
    /// Ranges of the rockers of each wheel up to their toggles, within the wheel's travel. Empty if one body carries
    /// both wheels.
    pub rockers: [Vec<RockerRange>; 2],
    /// Smallest and largest displacement of the rack at zero travel, positive in the outboard direction of the left
    /// wheel. For a steered solid axle, these are displacements of the drag link. `None` if nothing steers the wheels.
    pub rack: Option<[AxleEnd; 2]>,
    /// Smallest and largest roll angle (radians) at zero heave, with the rack centred. `None` if the axle has no pose at
    /// this end or shortly before it.
    pub roll: [Option<AxleEnd>; 2],
}

/// Limits of the travels of an axle's wheels, found by moving away from the design position.
#[derive(Clone, Debug, PartialEq)]
pub enum TravelRanges {
    /// Travels of the left and right wheel separately, with the rack centred.
    OfWheels([Range; 2]),
    /// Travels of a rigid axle.
    OfAxle {
        /// Mean travel, if both wheels have equal travels.
        heave: Range,
        /// Half the difference of the travels, left minus right, at zero mean travel.
        half_difference: Range,
    },
}

/// End of an axle's range. It is the value at which the first of the two wheels reaches an end.
#[derive(Clone, Debug, PartialEq)]
pub struct AxleEnd {
    /// Value at the end: a travel, a rack displacement or a roll angle in radians.
    pub value: f64,
    /// Wheel that reaches its end.
    pub side: Side,
    /// End of the travel or of the rack of this wheel, in the wheel's own frame.
    pub end: RangeEnd,
}

/// Fraction of the roll angle at an end of roll. The axle must have a pose at this fraction. Otherwise the end is not
/// reported.
const BEFORE_END: f64 = 0.999;
/// Fraction as in [`BEFORE_END`], but for a rigid axle. Near a fold, where a rigid axle's motion ends, the heights of the
/// wheels change with the square root of the distance to the fold.
const BEFORE_FOLD: f64 = 0.97;
/// Fractions of the travel at which a rod is at its toggle (dead centre). The program tries them in turn until the axle has
/// a pose. At these fractions, the wheel centres are within 1e-8 of the travel from their heights at the toggle.
const BEFORE_TOGGLE: [f64; 3] = [1.0 - 1e-12, 1.0 - 1e-10, 1.0 - 1e-8];
/// Largest displacement of a steering gear, relative to the mechanism's size, in the search for toggles.
const FARTHEST_GEAR: f64 = 2.0;

impl Axle {
    /// Returns the limits of the axle's motion, found by moving the axle away from its design position.
    ///
    /// # Errors
    /// If the design position of a wheel is singular.
    pub fn limits(&self) -> Result<AxleLimits, (Side, DesignFault)> {
        AxleSolver::<1>::new(self, &[], false)?.limits()
    }
}

impl<const N: usize> AxleSolver<'_, N> {
    /// Ranges of both travels, of the rack and of roll.
    ///
    /// # Errors
    /// If the design position of a wheel is singular.
    pub fn limits(&mut self) -> Result<AxleLimits, (Side, DesignFault)> {
        // Without displacement, the axle has its solved design, so the call cannot fail.
        let _ = self.steer(0.0);
        let left = self.limits_of(Side::Left)?;
        let right = self.limits_of(Side::Right)?;
        let rack = left.rack.as_ref().zip(right.rack.as_ref());
        // In its own frame, the right wheel's rack moves in the opposite direction.
        let rack = rack.map(|(left, right)| {
            let lower = nearer([(&left.lower, 1.0), (&right.upper, -1.0)]);
            let upper = nearer([(&left.upper, 1.0), (&right.lower, -1.0)]);
            [lower, upper]
        });
        let rack = rack.or_else(|| self.drag_link_range());
        let rockers = if self.is_rigid() {
            [Vec::new(), Vec::new()]
        } else {
            [left.rockers, right.rockers]
        };
        let (left, right) = (left.travel, right.travel);
        // At a positive roll angle, the left wheel is in droop.
        let upper = self.roll_end([&left.lower, &right.upper]);
        let lower = self.roll_end([&left.upper, &right.lower]);
        let roll = [lower, upper];
        let travels = if self.is_rigid() {
            TravelRanges::OfAxle {
                heave: self.heave_range()?,
                half_difference: left,
            }
        } else {
            TravelRanges::OfWheels([left, right])
        };
        Ok(AxleLimits {
            travels,
            rockers,
            rack,
            roll,
        })
    }

    /// Returns the range of the steering gear of a steered axle in which the axle has a position at zero travel. `None`
    /// for other axles.
    fn drag_link_range(&mut self) -> Option<[AxleEnd; 2]> {
        if !self.is_steered() {
            return None;
        }
        let ends = [-1.0, 1.0].map(|sign| self.drag_link_end(sign));
        // The remaining limits apply to the axle straight ahead.
        let _ = self.steer(0.0);
        Some(ends)
    }

    /// Finds one end of the steering gear's range: first by equal steps, then by halving the last step.
    fn drag_link_end(&mut self, sign: f64) -> AxleEnd {
        let size = self.size();
        let level = |displacement: f64| Placement::Travels {
            travels: [0.0; 2],
            rack: displacement,
            on_plane: false,
        };
        let step = sign * size / 32.0;
        let (mut value, mut last, mut beyond) = (0.0_f64, None, None);
        while beyond.is_none() && value.abs() < FARTHEST_GEAR * size {
            match self.place(&level(value + step)) {
                Ok(placed) => (value, last) = (value + step, Some(placed)),
                Err(failure) => beyond = Some((value + step, failure)),
            }
        }
        while let Some((outside, _)) = beyond
            && (outside - value).abs() > 1e-13 * size
        {
            let middle = 0.5 * (value + outside);
            match self.place(&level(middle)) {
                Ok(placed) => (value, last) = (middle, Some(placed)),
                Err(failure) => beyond = Some((middle, failure)),
            }
        }
        let nearest = last.and_then(|placed| self.nearest_toggle(&placed));
        let toggle = |(side, rod): (Side, Rod)| (side, RangeEnd::Toggle { value, rod });
        let end = nearest.map(toggle).or_else(|| {
            let (beyond, failure) = beyond?;
            match failure.of_wheel()? {
                Failure::Toggle(rod @ Rod::TieRod) => Some(toggle((Side::Right, *rod))),
                Failure::Toggle(rod) => Some(toggle((Side::Left, *rod))),
                _ => Some((Side::Left, RangeEnd::Fold(self.gear_fold(value, beyond)?))),
            }
        });
        let (side, end) = end.unwrap_or((Side::Left, RangeEnd::Unresolved(value)));
        AxleEnd { value, side, end }
    }

    /// Finds a rod that is at its toggle, and the side of the knuckle that this rod steers. The solver first turns the
    /// knuckles while the axle is at rest. Then it moves the axle to the final position. So a rod can be at its toggle
    /// at rest or in the final position. `None` if no rod is at its toggle.
    fn nearest_toggle(&mut self, placed: &AxlePose) -> Option<(Side, Rod)> {
        self.steer(placed.rack).ok()?;
        let steering = self.axle.left.mechanism.axle_steering()?;
        let both = [
            self.configuration_at_rest(),
            self.configuration_of(Side::Left, placed),
        ];
        let knuckles = [steering.near_knuckle, steering.far_knuckle];
        let leverages = knuckles.each(|id| {
            let leverages = both.iter().map(|at| at.leverage(id));
            leverages.fold(f64::INFINITY, f64::min)
        });
        let side = if leverages[0] <= leverages[1] {
            Side::Left
        } else {
            Side::Right
        };
        let mechanism = &self.axle.left.mechanism;
        let rod = mechanism.rocker(knuckles[side as usize]).rod;
        (leverages[side as usize] < AT_TOGGLE).then_some((side, rod))
    }

    /// Finds the range of the mean travel of a rigid axle, with equal travels of both wheels.
    fn heave_range(&self) -> Result<Range, (Side, DesignFault)> {
        let [left, _] = self.designs();
        let mechanism = self.axle.left.mechanism.holding(AxleTravel::Difference);
        let solver = Solver::new(&mechanism, &left);
        let limits = solver.and_then(|mut solver| solver.drive_range(Drive::Travel, 0.0));
        limits.map_err(|fault| (Side::Left, fault))
    }

    /// Finds the roll angle at which the first wheel reaches the end of its travel. `ends` contains the end of the left
    /// wheel and the end of the right wheel, for one direction of roll. `None` if no pose exists at this end or shortly
    /// before it, or if no plane touches both wheels at this end.
    fn roll_end(&mut self, ends: [&RangeEnd; 2]) -> Option<AxleEnd> {
        let [left, right] = ends;
        let end = if self.is_rigid() {
            // From each wheel, the parts of a rigid axle have other names (left or right). The result has the names as seen
            // from the left wheel.
            AxleEnd {
                value: left.value(),
                side: Side::Left,
                end: left.clone(),
            }
        } else {
            nearer([(left, 1.0), (right, -1.0)])
        };
        let poses = match ends {
            // The two ends describe the same position of the axle, each as seen from one wheel.
            [RangeEnd::Fold(left), RangeEnd::Fold(right)] if self.is_rigid() => {
                [left.pose, right.pose]
            }
            _ => self.poses_at(&end)?,
        };
        let roll = self.plane_under(&poses).filter(|roll| roll.is_finite())?;
        let share = if self.is_rigid() {
            BEFORE_FOLD
        } else {
            BEFORE_END
        };
        let before = Placement::Roll {
            heave: 0.0,
            roll: share * roll,
            rack: 0.0,
        };
        let is_reached = self.place(&before).is_ok();
        is_reached.then_some(AxleEnd { value: roll, ..end })
    }

    /// Returns the poses of both wheels in which the first wheel reaches its end. The other wheel has the opposite
    /// travel. At the toggle of a rod there is no pose. In this case, the function returns the poses shortly before the
    /// toggle.
    fn poses_at(&mut self, end: &AxleEnd) -> Option<[Pose<f64>; 2]> {
        let mut opposite = |side: Side, travel: f64| match side {
            Side::Left => self.pose(Side::Left, travel),
            Side::Right => self.pose(Side::Right, -travel),
        };
        match (&end.end, end.side) {
            (RangeEnd::Fold(limit), Side::Left) => {
                Some([limit.pose, opposite(Side::Right, end.value)?])
            }
            (RangeEnd::Fold(limit), Side::Right) => {
                Some([opposite(Side::Left, end.value)?, limit.pose])
            }
            (RangeEnd::Toggle { .. }, _) => {
                let mut before = BEFORE_TOGGLE.iter().map(|share| share * end.value);
                before.find_map(|travel| {
                    let left = opposite(Side::Left, travel)?;
                    Some([left, opposite(Side::Right, travel)?])
                })
            }
            _ => None,
        }
    }
}

/// Returns the end that is nearer to the design position. Each end has a sign, which converts the value of the wheel to
/// the value of the axle.
fn nearer(ends: [(&RangeEnd, f64); 2]) -> AxleEnd {
    let [left, right] = ends.each(|(end, sign)| (end, sign * end.value()));
    let (side, (end, value)) = if left.1.abs() <= right.1.abs() {
        (Side::Left, left)
    } else {
        (Side::Right, right)
    };
    AxleEnd {
        value,
        side,
        end: end.clone(),
    }
}
