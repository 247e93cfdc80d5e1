//! Limits of builds (assembled parts with random deviations from `[tolerance]`), and the nearest limits among many builds.

use super::elastic::{in_equilibrium, rows_of_axle, rows_of_wheel};
use super::{LimitEnd, LimitRow, WheelLimits, axle_rows, travel_left};
use crate::analyse::Range;
use crate::axle::{AxlePlan, axle_curves};
use crate::mechanism::DesignFault;
use crate::study::{AxleStudy, Drive, Study, Vehicle, WheelStudy};
use crate::tolerance::Problem;

/// Limits of one vehicle: the vehicle of a study, or a build of its `[tolerance]`.
#[derive(Clone, Debug)]
pub struct VehicleLimits {
    /// A row for each quantity, with the limits of this quantity while the other quantities stay constant. All builds of a
    /// study have the same rows.
    pub rows: Vec<LimitRow>,
    /// Distance from the study's motion to the nearest limit of its drive, at the rack displacements that can be reached; negative
    /// if the motion goes beyond it. A length, or radians for an arm angle. `None` with the drive of Attia's paper, if no rack
    /// displacement can be reached, and for an elastic wheel whose limit is not known. Also `None` for axles, because their motion
    /// has several quantities.
    pub margin: Option<f64>,
    /// True if the study's motion goes beyond the limits of the drive or of the rack. Always false with the drive of Attia's paper.
    pub is_short: bool,
}

impl VehicleLimits {
    /// Limits of a vehicle of a study.
    ///
    /// # Errors
    /// The vehicle has no position, or no equilibrium. The text explains why.
    pub fn of_vehicle(study: &Study, vehicle: &Vehicle) -> Result<Self, String> {
        match vehicle {
            Vehicle::Wheel(own) => VehicleLimits::of_wheel(study, own),
            Vehicle::Axle(both) => VehicleLimits::of_axle(study, both),
        }
    }

    /// Limits of the build with this number. `None` if it cannot be assembled, cannot move or has no equilibrium.
    pub fn of_build(study: &Study, problem: &Problem, number: u64) -> Option<Self> {
        let built = problem.built_vehicle(number).ok()?;
        VehicleLimits::of_vehicle(study, &built).ok()
    }

    fn of_wheel(study: &Study, own: &WheelStudy) -> Result<Self, String> {
        let suspension = &own.suspension;
        let fault = |fault: DesignFault| fault.describe(&suspension.mechanism);
        let (rows, margin, has_all_racks) = match &own.compliance {
            Some(elastic) => {
                let (rows, margin) = rows_of_wheel(own, elastic).map_err(fault)?;
                (in_equilibrium(rows)?, margin, true)
            }
            None => {
                let found = WheelLimits::of(own).map_err(fault)?;
                let rows = found.rows(study);
                let by_rack = || found.by_rack.iter().map(|(_, range)| range);
                let margin = travel_left(by_rack(), found.plan.station_order.values());
                let is_compared = study.motion().drive != Drive::PaperTheta;
                let margin = (is_compared && margin.is_finite()).then_some(margin);
                let has_all_racks = !is_compared || !by_rack().any(Range::is_empty);
                (rows, margin, has_all_racks)
            }
        };
        Ok(VehicleLimits {
            rows,
            margin,
            is_short: !has_all_racks || margin.is_some_and(|margin| margin < 0.0),
        })
    }

    fn of_axle(study: &Study, both: &AxleStudy) -> Result<Self, String> {
        let axle = &both.axle;
        let fault = |fault| axle.describe_fault(fault);
        let rows = match &axle.elastic {
            Some(elastic) => in_equilibrium(rows_of_axle(axle, elastic)?)?,
            None => axle_rows(study, axle, &axle.limits().map_err(fault)?),
        };
        let positions = AxlePlan::of(both.plan.motion.clone(), Vec::new());
        let moved = axle_curves(axle, &positions).map_err(fault)?.curves;
        Ok(VehicleLimits {
            rows,
            margin: None,
            is_short: !moved.are_complete(),
        })
    }

    /// True if a lower or upper limit of a row has no value.
    fn is_unknown(&self) -> bool {
        let mut ends = self.rows.iter().flat_map(|row| &row.ends);
        ends.any(|end| end.value.is_none())
    }
}

/// Nearest lower or upper limit of a quantity among builds, with the number of the build that has it.
#[derive(Clone, Debug)]
pub struct NearestEnd {
    /// Value and cause of the limit.
    pub end: LimitEnd,
    /// Number of the build.
    pub build: u64,
}

impl NearestEnd {
    /// Returns the nearer one of two limits. `is_beyond` is true if its first value is the nearer limit. A known limit is nearer
    /// than an unknown one. Of two equal limits, returns `self`.
    fn nearer(self, later: NearestEnd, is_beyond: fn(&f64, &f64) -> bool) -> NearestEnd {
        match (self.end.value, later.end.value) {
            (Some(mine), Some(theirs)) if is_beyond(&theirs, &mine) => later,
            (None, Some(_)) => later,
            _ => self,
        }
    }
}

/// Count of some builds, and the number of the first build among them. The number is `None` if the count is 0.
type Counted = (u64, Option<u64>);

/// Nearest limits among some builds. If limits are equal, the first build counts.
#[derive(Clone, Debug, Default)]
pub struct NearestLimits {
    /// Largest lower limit and smallest upper limit of the builds, for each row of [`VehicleLimits`]. Empty if no build has limits.
    pub rows: Vec<[NearestEnd; 2]>,
    /// Smallest [`VehicleLimits::margin`] of the builds, with the number of its build. `None` if no build has a margin.
    pub margin: Option<(f64, u64)>,
    /// Count of builds that cannot be assembled, cannot move or have no equilibrium.
    pub rejected: Counted,
    /// Count of builds that do not reach the motion of the study.
    pub short: Counted,
    /// Count of builds with an unknown limit.
    pub unknown: Counted,
}

impl NearestLimits {
    /// Limits of one build. `None` for a build without limits.
    pub fn of(build: u64, limits: Option<VehicleLimits>) -> Self {
        let Some(limits) = limits else {
            return NearestLimits {
                rejected: (1, Some(build)),
                ..NearestLimits::default()
            };
        };
        let counted = |is: bool| (u64::from(is), is.then_some(build));
        let unknown = counted(limits.is_unknown());
        let rows = limits.rows.into_iter();
        NearestLimits {
            rows: rows
                .map(|row| row.ends.map(|end| NearestEnd { end, build }))
                .collect(),
            margin: limits.margin.map(|margin| (margin, build)),
            rejected: (0, None),
            short: counted(limits.is_short),
            unknown,
        }
    }

    /// Merges these limits with the limits of builds that have higher numbers.
    #[must_use]
    pub fn and(self, later: NearestLimits) -> NearestLimits {
        let rows = if self.rows.is_empty() {
            later.rows
        } else if later.rows.is_empty() {
            self.rows
        } else {
            let both = self.rows.into_iter().zip(later.rows);
            let nearer = |([lower, upper], [later_lower, later_upper]): ([_; 2], [_; 2])| {
                [
                    NearestEnd::nearer(lower, later_lower, f64::gt),
                    NearestEnd::nearer(upper, later_upper, f64::lt),
                ]
            };
            both.map(nearer).collect()
        };
        let counted = |mine: Counted, theirs: Counted| (mine.0 + theirs.0, mine.1.or(theirs.1));
        NearestLimits {
            rows,
            margin: match (self.margin, later.margin) {
                (Some(mine), Some(theirs)) if theirs.0 < mine.0 => Some(theirs),
                (mine, theirs) => mine.or(theirs),
            },
            rejected: counted(self.rejected, later.rejected),
            short: counted(self.short, later.short),
            unknown: counted(self.unknown, later.unknown),
        }
    }
}
