//! Resolved targets and constraints: quantities, sites, target values and limits.

use super::drive_rounding::DriveRounding;
use super::*;

/// Quantity of a target, with its name and unit in the study.
#[derive(Clone, Debug, PartialEq)]
pub struct TargetQuantity {
    /// Quantities in the kernel's frame (left wheel, x forward, y left, z up).
    pub kind: TargetKind,
    /// Name of the quantity with the unit, as in a column heading.
    pub column: String,
    /// Physical type of the quantity's value. It determines the unit.
    pub unit: Unit,
    /// Unit of length of the study.
    pub length: LengthUnit,
    /// Sign of the study's axis: 1 if it has the direction of a left wheel's axis (x forward, y left, z up), -1 if the
    /// opposite direction.
    pub sign: f64,
}

/// Kind of quantity of a target.
#[derive(Clone, Debug, PartialEq)]
pub enum TargetKind {
    /// A measure of one wheel.
    Wheel(Measure),
    /// A quantity of an axle, or the same quantity of both wheels.
    Axle(Vec<crate::axle::Quantity>),
    /// A value of one wheel with elastic parts in equilibrium.
    Elastic(KcValue),
}

impl TargetQuantity {
    /// Makes the quantity of a characteristic.
    pub fn characteristic(characteristic: Characteristic, length: LengthUnit) -> Self {
        TargetQuantity {
            kind: TargetKind::Wheel(Measure::Quantity(Quantity::Characteristic(characteristic))),
            column: characteristic.column(length),
            unit: characteristic.info().unit,
            length,
            sign: 1.0,
        }
    }

    /// Factor that converts a value inside the program to the printed value. Inside the program, values are in the axes of
    /// a left wheel (x forward, y left, z up), in radians, length units and newtons.
    pub fn factor(&self) -> f64 {
        self.unit.printed_factor(self.length) * self.sign
    }

    /// Converts a printed value to the value inside the program. See [`TargetQuantity::factor`].
    pub fn from_printed(&self, printed: f64) -> f64 {
        self.unit.from_printed(printed, self.length) * self.sign
    }

    /// Measure of one wheel. `None` for other quantities.
    pub fn of_wheel(&self) -> Option<&Measure> {
        match &self.kind {
            TargetKind::Wheel(measure) => Some(measure),
            TargetKind::Axle(_) | TargetKind::Elastic(_) => None,
        }
    }

    /// Characteristic of one wheel. `None` for other quantities.
    pub fn as_characteristic(&self) -> Option<Characteristic> {
        match &self.kind {
            TargetKind::Wheel(Measure::Quantity(Quantity::Characteristic(c)))
            | TargetKind::Elastic(KcValue::Wheel(c)) => Some(*c),
            _ => None,
        }
    }

    /// Returns true for a test result of elastic parts, of a wheel or an axle.
    pub fn is_figure(&self) -> bool {
        match &self.kind {
            TargetKind::Elastic(KcValue::Figure { .. }) => true,
            TargetKind::Axle(quantities) => {
                use crate::axle::Quantity as OfAxle;
                quantities.iter().all(|q| matches!(q, OfAxle::Figure(_)))
            }
            TargetKind::Wheel(_) | TargetKind::Elastic(_) => false,
        }
    }

    /// Test result of elastic parts. `None` for other quantities.
    pub fn as_figure(&self) -> Option<ElasticFigure> {
        let TargetKind::Elastic(value @ KcValue::Figure { .. }) = self.kind else {
            return None;
        };
        let unit = self.unit.suffix(self.length);
        let name = self.column.strip_suffix(&format!("_{unit}"));
        Some(ElasticFigure {
            name: name.unwrap_or(&self.column).to_owned(),
            value,
            unit: self.unit,
        })
    }
}

/// Stations of a target or a constraint: its motion, and the rack displacements.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Site {
    /// Motion with its name. `None` for the study's `[motion]`.
    pub motion: Option<(String, Motion)>,
    /// Rack displacements along the study's +y. If empty, the rack is at the motion's displacement. If the motion moves the
    /// rack, the rack is straight ahead.
    pub racks: Vec<f64>,
    /// For an axle: the coordinate that varies, and the values of the other coordinates.
    pub axle: Option<AxleSite>,
}

impl Site {
    /// Returns true if the site (the stations of a target) consists of all stations of one wheel's motion, with the rack of
    /// this motion. `name` is the name of the motion.
    pub fn is_whole_motion(&self, name: Option<&str>) -> bool {
        let own = self.motion.as_ref().map(|(name, _)| name.as_str());
        own == name && self.racks.is_empty() && self.axle.is_none()
    }
}

/// Target curve, value or band. Values are in the axes of a left wheel (x forward, y left, z up). They are in radians,
/// length units or newtons (for gains: radians per length unit).
#[derive(Clone, Debug, PartialEq)]
pub struct Target {
    /// Quantity that has the target.
    pub of: TargetQuantity,
    /// Target value, curve or band of this quantity.
    pub wanted: Wanted,
    /// Acceptable deviation, in the unit of the values.
    pub tolerance: f64,
    /// Weight relative to the other targets.
    pub weight: f64,
    /// Stations of the target.
    pub site: Site,
    /// Additional drive values at which the target is compared.
    pub stations: Vec<f64>,
}

impl Target {
    /// Name of the target: name of the characteristic, or name of the column without its unit.
    pub fn name(&self, length: LengthUnit) -> String {
        match self.of.as_characteristic() {
            Some(characteristic) => characteristic.info().name.to_owned(),
            None => {
                let unit = format!("_{}", self.of.unit.suffix(length));
                let name = self.of.column.strip_suffix(&unit);
                name.unwrap_or(&self.of.column).to_owned()
            }
        }
    }

    /// Drive values of a motion, and the additional drive values of this target.
    pub fn stations_in(&self, motion: &Motion) -> Vec<f64> {
        self.stations_among(&motion.values)
    }

    /// The given drive values, and the additional drive values of this target.
    pub fn stations_among(&self, values: &[f64]) -> Vec<f64> {
        let rounding = DriveRounding::of(values);
        let added = self.stations.iter();
        let added = added.filter(|own| !rounding.is_among(**own, values));
        values.iter().chain(added).copied().collect()
    }

    /// Printed form of a drive value. For an axle, the drive value is the value of the coordinate that varies. `drive` is the
    /// drive of the study's own motion.
    pub fn printed_at(&self, drive: Drive, at: f64) -> f64 {
        match (&self.site.axle, &self.site.motion) {
            (Some(_), _) => at,
            (None, Some((_, motion))) => motion.drive.printed(at),
            (None, None) => drive.printed(at),
        }
    }

    /// Unit of [`Target::printed_at`].
    pub fn unit_at(&self, drive: Drive, length: LengthUnit) -> &'static str {
        match (&self.site.axle, &self.site.motion) {
            (Some(site), _) => site.over.unit(length),
            (None, Some((_, motion))) => motion.drive.unit(length),
            (None, None) => drive.unit(length),
        }
    }

    /// Returns true if a sweep solves all stations of the target. This is the case for every target of an axle. A target of one
    /// wheel must be a characteristic or a test result in `motion`, the study's own motion, at rack displacements that the
    /// sweep solves.
    pub fn is_in_sweep(&self, motion: &Motion) -> bool {
        if self.site.axle.is_some() {
            return true;
        }
        // Each sweep solves the design position straight ahead.
        let is_solved =
            |rack: &f64| motion.rack.contains(rack) || motion.rack_moves && *rack == 0.0;
        self.has_curve() && self.site.motion.is_none() && self.site.racks.iter().all(is_solved)
    }

    /// Name of the target in the columns of a sweep: its name and the name of its motion.
    pub fn swept_name(&self, length: LengthUnit) -> String {
        let name = self.name(length);
        match &self.site.motion {
            Some((motion, _)) => format!("{name}_{motion}"),
            None => name,
        }
    }

    /// Returns true if a chart can show the target as a line. A chart can show values or a curve of a characteristic or a test
    /// result of one wheel.
    pub fn is_plain(&self) -> bool {
        !matches!(self.wanted, Wanted::Band { .. }) && self.has_curve()
    }

    /// Returns true if the quantity has a column in the curves of the wheel.
    fn has_curve(&self) -> bool {
        self.of.as_characteristic().is_some() || self.of.as_figure().is_some()
    }
}

/// Target value, curve or band.
#[derive(Clone, Debug, PartialEq)]
pub enum Wanted {
    /// A target curve over the drive. The tuning compares the curve at the stations of the motion between the ends of the
    /// curve.
    Curve {
        /// Drive value (as in [`Motion::values`]) and target value of each point, in the order of the drive value.
        points: Vec<[f64; 2]>,
        /// Interpolation between the points of the curve.
        interpolation: Interpolation,
    },
    /// A single value at one drive value.
    At {
        /// Drive value at which the target applies.
        drive: f64,
        /// Target value at this drive value.
        value: f64,
    },
    /// Measured points, each as [drive value, value]. Each is compared at its own drive value.
    Points(Vec<[f64; 2]>),
    /// A band: every value between two limits meets the target.
    Band {
        /// Single drive value of the band. `None` for the stations of the motion.
        at: Option<f64>,
        /// Lower limit. `None` means no limit.
        lower: Option<Limit>,
        /// Upper limit. `None` means no limit.
        upper: Option<Limit>,
    },
}

/// Limit of a band.
#[derive(Clone, Debug, PartialEq)]
pub enum Limit {
    /// A constant limit.
    Value(f64),
    /// A limit curve over the drive. The curve sets no limit beyond its ends.
    Curve {
        /// Drive value and limit of each point, in the order of the drive value.
        points: Vec<[f64; 2]>,
        /// Interpolation between the points of the limit curve.
        interpolation: Interpolation,
    },
}

/// Limits that a design must satisfy.
#[derive(Clone, Debug, PartialEq)]
pub struct Constraint {
    /// Description of the constraint in words.
    pub name: String,
    /// Measures that must all be within limits.
    pub parts: Vec<Limited>,
    /// Stations of the constraint. `None` for the design position only.
    pub site: Option<Site>,
}

impl Constraint {
    /// Visible change of the measures, as in [`Limited::visible`]. All parts of a constraint have the same unit.
    pub fn visible(&self) -> f64 {
        self.parts.first().map_or(1.0, |part| part.visible)
    }
}

/// A measure that must be within limits.
#[derive(Clone, Debug, PartialEq)]
pub struct Limited {
    /// Measure with limits.
    pub of: Measure,
    /// Lower limit. `None` means no limit.
    pub lower: Option<f64>,
    /// Upper limit. `None` means no limit. If it equals `lower`, the constraint is an equality.
    pub upper: Option<f64>,
    /// Change of the measure by which a tuning divides deviations from the limits. It is a change that a user would notice,
    /// such as 1 mm or 1 degree.
    pub scale: f64,
    /// The change `scale`, expressed in `unit`.
    pub visible: f64,
    /// Unit of limits and margins, as the study writes it. Lagrange multipliers are per this unit. "1" for a plain number.
    pub unit: String,
}

impl Limited {
    /// Lower and upper limit in `unit`. `None` without a limit. The limits of a force in a member and of a coordinate have
    /// the signs of a left wheel's axes (x forward, y left, z up).
    pub fn limits(&self) -> [Option<f64>; 2] {
        let printed = |limit: f64| {
            if self.of.is_versine() {
                (1.0 - limit).acos().to_degrees()
            } else {
                limit / self.scale * self.visible
            }
        };
        [self.lower, self.upper].map(|limit| limit.map(printed))
    }

    /// Margin (distance) between the measure and one of its limits, in `unit`. `row` is (measure - limit)/scale, with the
    /// opposite sign for a lower limit. The margin is negative if the limit is violated.
    pub(crate) fn margin(&self, row: f64) -> f64 {
        match (self.of.is_versine(), self.upper) {
            (true, Some(limit)) => {
                let angle = |versine: f64| 2.0 * (0.5 * versine).clamp(0.0, 1.0).sqrt().asin();
                (angle(limit) - angle(limit + row * self.scale)).to_degrees()
            }
            _ => -row * self.visible,
        }
    }
}

/// Interpolation of a curve between its points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// Straight lines.
    Linear,
    /// A smooth piecewise cubic without overshoot (F. N. Fritsch, R. E. Carlson, Monotone piecewise cubic interpolation,
    /// SIAM J. Numer. Anal. 17, 1980).
    MonotoneCubic,
}
