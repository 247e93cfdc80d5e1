//! Methods that make studies, motions, variables and targets from numbers.

use super::Error;
use super::error::{checked, finite};
use crate::characteristics::Characteristic;
use crate::model::{Axis, PointId, Suspension};
use crate::number::Each;
use crate::study::{
    Designs, FileFormat, Interpolation, Motion, Move, Optimise, Order, Sampled, Sampling, Site,
    Study, Sweep, SweepVariable, Target, TargetQuantity, Variable, Vehicle, Wanted, WheelStudy,
};
use crate::study::{GOOD_ENOUGH, MAX_ITERATIONS};
use std::ops::RangeInclusive;

impl Motion {
    /// Makes a motion with one travel of the wheel and one displacement of the rack along the suspension's +y.
    ///
    /// # Errors
    /// Returns an error if a number is not finite.
    pub fn at(travel: f64, rack: f64) -> Result<Self, Error> {
        Ok(Motion {
            values: vec![finite("the travel", travel)?],
            rack: vec![finite("the rack displacement", rack)?],
            ..Motion::still()
        })
    }

    /// Makes a motion with evenly spaced travels over a range, both ends included, and the rack straight ahead.
    ///
    /// # Errors
    /// Returns an error if an end is not finite, the upper end is not above the lower one, or there are fewer than two stations.
    pub fn travel(range: RangeInclusive<f64>, stations: usize) -> Result<Self, Error> {
        let [low, high] = ends("the travel", &range)?;
        if stations < 2 {
            return Err(Error::Number {
                what: "the number of stations".to_owned(),
                value: stations as f64,
                expected: "at least 2",
            });
        }
        let step = |k: usize| k as f64 / (stations - 1) as f64;
        Ok(Motion {
            values: (0..stations)
                .map(|k| low * (1.0 - step(k)) + high * step(k))
                .collect(),
            ..Motion::still()
        })
    }

    /// Returns the motion at each of these rack displacements, along the suspension's +y.
    ///
    /// # Errors
    /// Returns an error if the list is empty, or a displacement is not finite.
    pub fn with_racks(mut self, racks: &[f64]) -> Result<Self, Error> {
        for rack in racks {
            finite("the rack displacement", *rack)?;
        }
        if racks.is_empty() {
            return Err(Error::Empty("rack displacement"));
        }
        self.rack = racks.to_vec();
        self.rack_moves = true;
        Ok(self)
    }
}

impl Study {
    /// Makes a study of a suspension. The study covers only the design position and requests no results.
    ///
    /// Its `text` is empty. Functions that edit the text of a study ([`Study::with_points_of`]) need a study from a file or
    /// text.
    pub fn of(suspension: Suspension) -> Self {
        Study {
            name: suspension.mechanism.topology.name.to_owned(),
            text: String::new(),
            directory: std::path::PathBuf::new(),
            inputs: Vec::new(),
            vehicle: Vehicle::Wheel(Box::new(WheelStudy::of(suspension))),
            motions: Vec::new(),
            optimise: None,
            sweep: None,
            setup: None,
            tolerance: None,
        }
    }

    /// Returns the study with this motion. A study of an axle does not change, because its motion is in its text.
    pub fn over(mut self, motion: Motion) -> Self {
        if let Some(own) = self.one_wheel_mut() {
            own.motion = motion;
        }
        self
    }

    /// Returns the study with a request for these characteristics, and for their derivatives with respect to travel up to
    /// `order`. This request replaces earlier requests.
    ///
    /// # Errors
    /// [`Error::Lacking`] if the suspension lacks an input or part that a characteristic needs. [`Error::Axle`] for a study
    /// of an axle, whose requests are in its text.
    pub fn asking(
        mut self,
        characteristics: &[Characteristic],
        order: Order,
    ) -> Result<Self, Error> {
        let own = self.wheel_to_ask()?;
        for characteristic in characteristics {
            Error::if_lacking(&own.suspension, *characteristic)?;
        }
        own.outputs.characteristics = characteristics.to_vec();
        own.outputs.order = order;
        Ok(self)
    }

    /// Returns the study with a request for the positions of these points. This request replaces earlier requests.
    ///
    /// # Errors
    /// [`Error::UnknownPoint`] if no point has one of the names. [`Error::Axle`] as for [`Study::asking`].
    pub fn asking_points(mut self, names: &[&str]) -> Result<Self, Error> {
        let own = self.wheel_to_ask()?;
        let points = names.iter().map(|name| own.suspension.point_named(name));
        own.outputs.points = points.collect::<Result<_, _>>()?;
        Ok(self)
    }

    /// Returns the study of the wheel, so that the caller can change its requests. Returns an error for the study of an axle.
    fn wheel_to_ask(&mut self) -> Result<&mut WheelStudy, Error> {
        let refusal = Error::Axle("write the requested outputs in its study file");
        self.one_wheel_mut().ok_or(refusal)
    }

    /// Returns the study with variables and targets for [`Study::tune`]. Further settings are fields of [`Study::optimise`].
    pub fn tuning(mut self, variables: Vec<Variable>, targets: Vec<Target>) -> Self {
        self.optimise = Some(Optimise::of(variables, targets));
        self
    }

    /// Returns the study with designs sampled from the ranges of variables. [`Study::sweep`] computes these designs, and
    /// reports errors in the method, the variables and the number of samples.
    ///
    /// A grid has the same number of values for every variable, and `samples` is that number to the power of the number of
    /// variables. For example, 5 values for each of 3 variables give 125 samples. To give variables different numbers of
    /// values, set the fields of [`Sampled::variables`].
    pub fn sampling(
        mut self,
        method: Sampling,
        samples: u64,
        seed: u32,
        variables: &[Variable],
    ) -> Self {
        let steps = match method {
            Sampling::Grid => steps_of_grid(samples, variables.len()),
            _ => None,
        };
        let variables = variables.iter().map(|variable| SweepVariable {
            name: variable.label(),
            moves: variable.moves.clone(),
            rate: variable.rate,
            absolute: false,
            // The design variable of a rate (stiffness of an elastic part) has a range of logarithms of factors, or of
            // changes. A sweep needs the range as factors or rates.
            range: match &variable.rate {
                Some(rate) if rate.is_relative => variable.range.each(f64::exp),
                Some(rate) => variable.range.each(|change| rate.design + change),
                None => variable.range,
            },
            steps,
        });
        self.sweep = Some(Sweep {
            designs: Designs::Sampled(Sampled {
                method,
                samples,
                seed,
                variables: variables.collect(),
            }),
            curves: false,
            format: FileFormat::Csv,
            constraints: true,
        });
        self
    }
}

impl Optimise {
    /// Makes a tuning of these variables towards these targets. The tuning starts from the design itself, with the default
    /// settings of a study.
    pub fn of(variables: Vec<Variable>, targets: Vec<Target>) -> Self {
        Optimise {
            starts: 1,
            seed: 0,
            max_iterations: MAX_ITERATIONS.into(),
            variables,
            targets,
            constraints: Vec::new(),
            good_enough: GOOD_ENOUGH,
            fit: false,
            front: Vec::new(),
            scatter: None,
            side_effects: true,
        }
    }
}

impl Variable {
    /// Makes a variable that moves one coordinate of a hardpoint by an offset within a range, in the suspension's axes.
    ///
    /// # Errors
    /// [`Error::UnknownPoint`] if no point has this name. Also returns an error if an end of the range is not finite, or if
    /// the upper end is not above the lower one.
    pub fn offset(
        suspension: &Suspension,
        point: &str,
        axis: Axis,
        range: RangeInclusive<f64>,
    ) -> Result<Self, Error> {
        Variable::together(suspension, &[(point, 1.0)], axis, range)
    }

    /// Makes a variable that moves one coordinate of several hardpoints. Each point moves by its factor times the offset.
    ///
    /// # Errors
    /// The errors of [`Variable::offset`], and [`Error::Empty`] if there is no point.
    pub fn together(
        suspension: &Suspension,
        points: &[(&str, f64)],
        axis: Axis,
        range: RangeInclusive<f64>,
    ) -> Result<Self, Error> {
        if points.is_empty() {
            return Err(Error::Empty("point that moves"));
        }
        let mut moves = Vec::new();
        for (name, factor) in points {
            moves.push(Move {
                point: suspension.point_named(name)?,
                axis,
                factor: finite("a factor", *factor)?,
            });
        }
        let names: Vec<&str> = points.iter().map(|(name, _)| *name).collect();
        Ok(Variable {
            name: names.join("+"),
            moves,
            turn: None,
            rate: None,
            range: ends("an offset", &range)?,
            cost: 1.0,
        })
    }
}

impl Target {
    /// Makes a target curve of a characteristic over the travel. `points` are pairs of travel and target value, in the unit
    /// of the characteristic's column. Monotone cubics connect the points. The tuning compares the curve at its points,
    /// and at the stations of the motion between its ends. `tolerance` is the acceptable deviation, in the same unit.
    ///
    /// # Errors
    /// [`Error::Lacking`] if the suspension lacks an input of the characteristic. Also returns an error for fewer than two
    /// points, a number that is not finite, travels that do not rise, or a tolerance that is not positive. For a value at one
    /// travel, use [`Target::at`].
    pub fn curve(
        suspension: &Suspension,
        characteristic: Characteristic,
        points: &[[f64; 2]],
        tolerance: f64,
    ) -> Result<Self, Error> {
        if points.len() < 2 {
            return Err(Error::Number {
                what: "the number of points of a curve".to_owned(),
                value: points.len() as f64,
                expected: "at least 2, or Target::at for a value at one travel",
            });
        }
        let mut last = f64::NEG_INFINITY;
        for [travel, value] in points {
            checked(
                "a travel",
                *travel,
                "a finite number above the one before",
                |t| t.is_finite() && t > last,
            )?;
            finite("a target value", *value)?;
            last = *travel;
        }
        Target::of(suspension, characteristic, tolerance, |of| {
            let stations = points.iter().map(|[travel, _]| *travel).collect();
            let points = points.iter();
            let curve = Wanted::Curve {
                points: points
                    .map(|[t, value]| [*t, of.from_printed(*value)])
                    .collect(),
                interpolation: Interpolation::MonotoneCubic,
            };
            (curve, stations)
        })
    }

    /// Makes a target value of a characteristic at one travel. The motion does not need a station at this travel. The
    /// value has the unit of the characteristic's column. `tolerance` is the acceptable deviation, in the same unit.
    ///
    /// # Errors
    /// [`Error::Lacking`] if the suspension lacks an input of the characteristic. Also returns an error if a number is not
    /// finite, or if the tolerance is not positive.
    pub fn at(
        suspension: &Suspension,
        characteristic: Characteristic,
        travel: f64,
        value: f64,
        tolerance: f64,
    ) -> Result<Self, Error> {
        let drive = finite("a travel", travel)?;
        let printed = finite("a target value", value)?;
        Target::of(suspension, characteristic, tolerance, |of| {
            let value = of.from_printed(printed);
            (Wanted::At { drive, value }, vec![drive])
        })
    }

    /// Makes a target from values of a characteristic, and from travels to compare in addition to the travels of the motion.
    fn of(
        suspension: &Suspension,
        characteristic: Characteristic,
        tolerance: f64,
        wanted: impl Fn(&TargetQuantity) -> (Wanted, Vec<f64>),
    ) -> Result<Self, Error> {
        Error::if_lacking(suspension, characteristic)?;
        let is_right = |t: f64| t.is_finite() && t > 0.0;
        checked("the tolerance", tolerance, "a number above 0", is_right)?;
        let of = TargetQuantity::characteristic(characteristic, suspension.length_unit);
        let (wanted, stations) = wanted(&of);
        Ok(Target {
            tolerance: of.from_printed(tolerance).abs(),
            of,
            wanted,
            weight: 1.0,
            site: Site::default(),
            stations,
        })
    }
}

impl Suspension {
    /// Finds the point with this name.
    fn point_named(&self, name: &str) -> Result<PointId, Error> {
        let mechanism = &self.mechanism;
        mechanism.point(name).ok_or_else(|| {
            let known: Vec<&str> = mechanism.points.iter().map(|p| p.name.as_str()).collect();
            Error::UnknownPoint {
                name: name.to_owned(),
                topology: mechanism.topology.name,
                known: known.join(", "),
            }
        })
    }
}

/// Returns the ends of a range, or an error unless both are finite and the upper end is above the lower one.
fn ends(what: &str, range: &RangeInclusive<f64>) -> Result<[f64; 2], Error> {
    let low = finite(&format!("{what}'s lowest value"), *range.start())?;
    let high = checked(
        &format!("{what}'s highest value"),
        *range.end(),
        "a finite number above the lowest",
        |high| high.is_finite() && high > low,
    )?;
    Ok([low, high])
}

/// Returns the number of values of each variable in a grid with `points` designs, at least 2. `None` if there is no such grid.
fn steps_of_grid(points: u64, variables: usize) -> Option<u64> {
    let variables = u32::try_from(variables).ok().filter(|n| *n > 0)?;
    // Below 2^53, the nearest whole number is the exact root if an exact root exists. `refuse_wrong` refuses larger
    // numbers.
    let steps = (points as f64).powf(1.0 / f64::from(variables)).round() as u64;
    (steps >= 2 && steps.checked_pow(variables) == Some(points)).then_some(steps)
}
