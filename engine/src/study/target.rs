//! Targets and constraints, resolved: quantities, sites, wanted values and limits.

use super::*;

/// Quantity of a target, with its name and unit in the study.
#[derive(Clone, Debug, PartialEq)]
pub struct TargetQuantity {
    /// The quantities, in the kernel's frame.
    pub kind: TargetKind,
    /// Name with the unit, as in a column heading.
    pub column: String,
    /// Kind of quantity, from which its unit follows.
    pub unit: Unit,
    /// The study's unit of length.
    pub length: LengthUnit,
    /// -1 where the study's axis points the other way than the kernel's.
    pub sign: f64,
}

/// Kind of quantity of a target.
#[derive(Clone, Debug, PartialEq)]
pub enum TargetKind {
    /// A measure of one wheel.
    Wheel(Measure),
    /// A quantity of an axle, or the same quantity of either wheel.
    Axle(Vec<crate::axle::Quantity>),
    /// A value of one wheel with elastic parts.
    Elastic(KcValue),
}

impl TargetQuantity {
    /// A characteristic.
    pub fn characteristic(characteristic: Characteristic, length: LengthUnit) -> Self {
        TargetQuantity {
            kind: TargetKind::Wheel(Measure::Quantity(Quantity::Characteristic(characteristic))),
            column: characteristic.column(length),
            unit: characteristic.info().unit,
            length,
            sign: 1.0,
        }
    }

    /// Factor from a value in the kernel's frame, in radians, length units and newtons, to a printed one.
    pub fn factor(&self) -> f64 {
        self.unit.printed_factor(self.length) * self.sign
    }

    /// Converts a printed value into one in the kernel's frame.
    pub fn from_printed(&self, printed: f64) -> f64 {
        self.unit.from_printed(printed, self.length) * self.sign
    }

    /// The measure, if it is of one wheel.
    pub fn of_wheel(&self) -> Option<&Measure> {
        match &self.kind {
            TargetKind::Wheel(measure) => Some(measure),
            TargetKind::Axle(_) | TargetKind::Elastic(_) => None,
        }
    }

    /// The characteristic of one wheel, if it is one.
    pub fn as_characteristic(&self) -> Option<Characteristic> {
        match &self.kind {
            TargetKind::Wheel(Measure::Quantity(Quantity::Characteristic(c)))
            | TargetKind::Elastic(KcValue::Wheel(c)) => Some(*c),
            _ => None,
        }
    }

    /// Returns true if it is a figure of a test on elastic parts, of a wheel or an axle.
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

    /// The figure of a test on elastic parts, if it is one.
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

/// Place of a target or a constraint: its motion, and the positions of the rack.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Site {
    /// Name of a motion; the study's `[motion]` without it.
    pub motion: Option<(String, Motion)>,
    /// Rack displacements along the study's +y. If empty, the rack is at the motion's displacement, or straight ahead
    /// if the motion moves it.
    pub racks: Vec<f64>,
    /// For an axle: the number of the motion that it is over, and where the others are held.
    pub axle: Option<AxleSite>,
}

/// A wanted curve, value or band. Values in the kernel's frame, in radians or length units (for gains:
/// radians per length unit).
#[derive(Clone, Debug, PartialEq)]
pub struct Target {
    /// The quantity that the target is about.
    pub of: TargetQuantity,
    /// Wanted value, curve or band of that quantity.
    pub wanted: Wanted,
    /// Acceptable deviation, in the unit of the values.
    pub tolerance: f64,
    /// Weight against the other targets.
    pub weight: f64,
    /// Place where the target applies.
    pub site: Site,
    /// Further drive values at which it is compared, beside those of the motion.
    pub stations: Vec<f64>,
}

impl Target {
    /// Name of the target: the characteristic's, or the column's without its unit.
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

    /// The drive values of a motion, and those added for this target.
    pub fn stations_in(&self, motion: &Motion) -> Vec<f64> {
        self.stations_among(&motion.values)
    }

    /// The given values, and those added for this target.
    pub fn stations_among(&self, values: &[f64]) -> Vec<f64> {
        let added = self.stations.iter().filter(|v| !values.contains(v));
        values.iter().chain(added).copied().collect()
    }

    /// A drive value (for an axle, a value of the number that the target is over) as it is printed. `drive` is the
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

    /// Returns true if it is about a characteristic in the study's own motion. Sweeps compare only such targets.
    pub fn is_in_motion(&self) -> bool {
        let of = &self.of;
        let is_curve = of.as_characteristic().is_some() || of.as_figure().is_some();
        self.site == Site::default() && is_curve
    }

    /// Returns true if a picture can show the target as a line: a value or curve of a characteristic in the study's
    /// own motion.
    pub fn is_plain(&self) -> bool {
        !matches!(self.wanted, Wanted::Band { .. }) && self.is_in_motion()
    }
}

/// Wanted value, curve or band of a target.
#[derive(Clone, Debug, PartialEq)]
pub enum Wanted {
    /// A curve over the drive, compared at the stations of the motion between its ends.
    Curve {
        /// Drive value (as in [`Motion::values`]) and wanted value, by rising drive value.
        points: Vec<[f64; 2]>,
        /// Interpolation between its points.
        interpolation: Interpolation,
    },
    /// A single value at one drive value.
    At {
        /// Drive value.
        drive: f64,
        /// Wanted value.
        value: f64,
    },
    /// Measured points, each compared where it was measured: drive value and value.
    Points(Vec<[f64; 2]>),
    /// Anything between two limits.
    Band {
        /// The one drive value where it is wanted; `None` for the stations of the motion.
        at: Option<f64>,
        /// Lower limit; `None` for no limit.
        lower: Option<Limit>,
        /// Upper limit; `None` for no limit.
        upper: Option<Limit>,
    },
}

/// The limit of a band.
#[derive(Clone, Debug, PartialEq)]
pub enum Limit {
    /// The same everywhere.
    Value(f64),
    /// A curve over the drive, which limits between its ends.
    Curve {
        /// Drive value and limit, by rising drive value.
        points: Vec<[f64; 2]>,
        /// Interpolation between its points.
        interpolation: Interpolation,
    },
}

/// Limits that a design must keep.
#[derive(Clone, Debug, PartialEq)]
pub struct Constraint {
    /// Description in words.
    pub name: String,
    /// Measures that must all be within limits.
    pub parts: Vec<Limited>,
    /// Place where it must hold; `None` for the design position alone.
    pub site: Option<Site>,
}

/// A measure that must be within limits.
#[derive(Clone, Debug, PartialEq)]
pub struct Limited {
    /// The measure that must be within the limits.
    pub of: Measure,
    /// Lower limit; `None` for no limit.
    pub lower: Option<f64>,
    /// Upper limit; `None` for no limit. Equal to `lower`, it makes an equality.
    pub upper: Option<f64>,
    /// Change of the measure that counts as 1 in the rows of a tuning: a visible one, such as a millimetre or a degree.
    pub scale: f64,
    /// The same change in `unit`.
    pub visible: f64,
    /// Unit of the limits as the study writes them, which margins and prices have too. "1" for a plain number.
    pub unit: String,
}

impl Limited {
    /// Margin between the measure and one of its limits in `unit`, from the value of the limit's row:
    /// (measure - limit)/scale, with the opposite sign for a lower limit. Negative if the limit is violated.
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
    /// The smooth piecewise cubic that overshoots nowhere (F. N. Fritsch, R. E. Carlson, Monotone
    /// piecewise cubic interpolation, SIAM J. Numer. Anal. 17, 1980).
    MonotoneCubic,
}
