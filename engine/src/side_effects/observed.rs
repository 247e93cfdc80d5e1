//! Values of a design at stations. For one wheel or an axle, these are the stations of a motion. For a car, they are the load
//! cases.

use super::customary::Tolerance;
use super::{PlaceCoordinate, axle, corner, customary};
use crate::ask::Unit;
use crate::mechanism::DesignFault;
use crate::model::LengthUnit;
use crate::sorting::sort_numbers;
use crate::study::{Study, Vehicle};
use std::collections::{HashMap, HashSet};

/// Distance below which two positions are equal, as a share of the motion's range. For a coordinate that does not move, the
/// distance is in the coordinate's own unit (lengths, radians).
const SAME_PLACE: f64 = 1e-9;

/// Values of a design over a motion, or in the load cases of a car.
pub(super) struct Observed {
    /// Name of the motion. `None` for `[motion]`.
    pub motion: Option<String>,
    /// Stations of the motion.
    pub stations: Vec<Station>,
    /// Values of each output, and for an axle or a car of each wheel.
    pub series: Vec<Series>,
}

/// Station of a motion.
pub(super) struct Station {
    /// Coordinates, each divided by the range of this coordinate over the motion.
    pub position: Vec<f64>,
    /// Coordinates in the study's units.
    pub place: Vec<PlaceCoordinate>,
    /// Name of the load case, for a car.
    pub case: Option<String>,
    /// True if the rack is at 0. For a car, true if both racks are at 0.
    pub is_straight: bool,
}

impl Station {
    /// Drive value in the study's unit. 0 for a load case.
    pub(super) fn drive(&self) -> f64 {
        self.place.first().map_or(0.0, |drive| drive.value)
    }
}

/// Values of one output at all stations.
pub(super) struct Series {
    /// Name without unit; the same for both wheels of an axle.
    pub output: String,
    /// Unit, as in column names.
    pub unit: String,
    /// Customary tolerance for a change of the output. `None` if the output has none.
    pub tolerance: Option<Tolerance>,
    /// True if stations with the rack away from 0 are omitted.
    pub straight_only: bool,
    /// Name of the wheel, for an axle or a car.
    pub wheel: Option<&'static str>,
    /// Stations at which a target or a constraint applies to the output, or to a gain that is the slope of the output.
    pub wanted: Vec<usize>,
    /// Gains with targets or constraints that are slopes of the output.
    pub gains: Vec<Gain>,
    /// Values in printed units.
    pub values: Vec<Option<f64>>,
}

/// Gain of one wheel that is the slope of an output over the travel of this wheel.
pub(super) struct Gain {
    /// Stations at which a target or a constraint applies to the gain.
    pub wanted: HashSet<usize>,
    /// Slope of the output at all stations, in printed units.
    pub slopes: Vec<Option<f64>>,
    /// Travel of the wheel at all stations. `None` if it is unknown.
    pub travels: Vec<Option<f64>>,
}

impl Series {
    /// Makes a series for a quantity with this name, unit and customary tolerance.
    pub(super) fn new(name: &str, unit: Unit, length: LengthUnit, stations: &[Station]) -> Self {
        let is_judged_straight = customary::is_judged_straight_ahead(name);
        let straight_only = is_judged_straight && stations.iter().any(|s| s.is_straight);
        let tolerance = customary::tolerance(name, unit, length);
        Series {
            output: name.to_owned(),
            unit: unit.suffix(length),
            // Some quantities have a customary tolerance only with the rack at 0. If no station has the rack at 0, these
            // quantities have no tolerance.
            tolerance: tolerance.filter(|_| straight_only || !is_judged_straight),
            straight_only,
            wheel: None,
            wanted: Vec::new(),
            gains: Vec::new(),
            values: Vec::new(),
        }
    }
}

/// Computes the values of a study's design over a named motion, or over `[motion]` if `name` is `None`.
pub(super) fn observe(study: &Study, name: Option<&str>) -> Result<Observed, DesignFault> {
    let moved = name.and_then(|name| study.in_motion(name));
    let study = moved.as_ref().unwrap_or(study);
    let observed = match &study.vehicle {
        Vehicle::Wheel(own) => corner::observe(study, own, name),
        Vehicle::Axle(both) => axle::observe(study, both, name),
    }?;
    Ok(Observed {
        motion: name.map(str::to_owned),
        ..observed
    })
}

/// Grid of a motion's stations.
pub(super) struct Grid {
    /// Range of each coordinate. 1 for a coordinate that does not move.
    ranges: Vec<f64>,
    /// Different values of each coordinate, in rising order.
    axes: Vec<Vec<f64>>,
    /// Index of each station, by the indices of the station's coordinates in `axes`.
    numbers: HashMap<Vec<usize>, usize>,
}

impl Grid {
    /// Makes the grid of stations with these coordinates.
    pub(super) fn of(places: &[Vec<f64>]) -> Self {
        let count = places.first().map_or(0, Vec::len);
        let axis = |k: usize| {
            let mut values: Vec<f64> = places.iter().map(|place| place[k]).collect();
            sort_numbers(&mut values);
            values.dedup();
            values
        };
        let axes: Vec<Vec<f64>> = (0..count).map(axis).collect();
        let range = |axis: &Vec<f64>| match axis[axis.len() - 1] - axis[0] {
            range if range > 0.0 => range,
            _ => 1.0,
        };
        let mut grid = Grid {
            ranges: axes.iter().map(range).collect(),
            axes,
            numbers: HashMap::new(),
        };
        for (number, place) in places.iter().enumerate() {
            let key = (0..count).map(|k| grid.nearest(k, place[k])).collect();
            grid.numbers.entry(key).or_insert(number);
        }
        grid
    }

    /// Coordinates of a position, each divided by the range of this coordinate.
    pub(super) fn shares(&self, place: &[f64]) -> Vec<f64> {
        let shares = place.iter().zip(&self.ranges);
        shares.map(|(at, range)| at / range).collect()
    }

    /// Index in `axes` of the coordinate value that is nearest to another value.
    fn nearest(&self, coordinate: usize, value: f64) -> usize {
        let axis = &self.axes[coordinate];
        let above = axis
            .partition_point(|other| *other < value)
            .min(axis.len() - 1);
        let below = above.saturating_sub(1);
        if value - axis[below] < axis[above] - value {
            below
        } else {
            above
        }
    }

    /// Station whose coordinate `along` is nearest to the same coordinate of a position. `None` if another coordinate of the
    /// position, or the combination of the coordinates, is not in the grid.
    pub(super) fn station(&self, place: &[f64], along: usize) -> Option<usize> {
        let mut key = Vec::with_capacity(place.len());
        for (k, value) in place.iter().enumerate() {
            let nearest = self.nearest(k, *value);
            let away = (self.axes[k][nearest] - value).abs();
            if k != along && away > SAME_PLACE * self.ranges[k] {
                return None;
            }
            key.push(nearest);
        }
        self.numbers.get(&key).copied()
    }
}
