//! `[motion]` of an axle, and its named motions.

use super::super::error::Problems;
use super::super::file::{self, File};
use super::super::motion::{list, time_law, values};
use super::super::names::{choose, choose_or};
use super::super::value::{Number, Text, Values};
use super::super::{MOST_STATIONS, TimeLaw};
use super::coordinates;
use crate::axle::{Axle, AxleMotion, AxleTime, Combine, Coordinate, Motion, WheelMotion};
use crate::number::Each;
use std::ops::Range as Span;
use toml::Spanned;

/// Returns true if the roll motion keeps the wheel loads constant instead of the mean travel.
fn at_load(
    file: &File,
    section: &file::Motion,
    axle: &Axle,
    problems: &mut Problems,
) -> Option<bool> {
    let Some(text) = &section.hold else {
        return Some(false);
    };
    let holds = [("mean_travel", false), ("wheel_load", true)];
    // In studies before version 0.2.0, the value is `load`.
    let at_load = match text.get_ref().as_str() {
        "load" => true,
        _ => choose(text, "hold", &holds, problems)?,
    };
    let certifies = file.outputs.as_ref().and_then(|o| o.certify.as_ref());
    let order = file.outputs.as_ref().and_then(|o| o.order.as_ref());
    let has_derivatives = order.is_some_and(|order| order.get_ref() != "position");
    // Derivatives along roll are computed at constant mean travel. At constant wheel load the motion differs, so
    // derivatives are refused.
    let message = if at_load && (has_derivatives || section.time.is_some()) {
        "hold = \"wheel_load\" does not work with derivatives; expected order = \"position\" and no time law, or hold = \"mean_travel\""
    } else if section.roll.is_none() {
        "the key \"hold\" applies to roll, and this motion has no roll"
    } else if at_load && !axle.setup.is_sprung() {
        "hold = \"wheel_load\" needs [spring] or [heave_spring] for the wheel loads"
    } else if at_load && certifies.is_some_and(|c| *c.get_ref()) {
        "the key \"certify\" does not work with hold = \"wheel_load\"; expected hold = \"mean_travel\", or no certify"
    } else if at_load && file.tolerance.is_some() {
        "[tolerance] does not work with hold = \"wheel_load\"; expected hold = \"mean_travel\", or no [tolerance]"
    } else {
        return Some(at_load);
    };
    problems.refuse(text.span(), message)
}

/// Reads the time law of the coordinate that moves over time. Also returns the values of this coordinate, in units of the study.
/// `Some(None)` if the study gives no time law, `None` if the time law has an error.
fn over_time(
    section: &file::Motion,
    axle: &Axle,
    problems: &mut Problems,
) -> Option<Option<(AxleTime, Vec<f64>)>> {
    let Some(time) = &section.time else {
        return Some(None);
    };
    let names = Coordinate::ALL.each(|coordinate| (coordinate.key(), coordinate));
    let coordinate = choose_or(&section.drive, Coordinate::Heave, "drive", &names, problems)?;
    let key = coordinate.key();
    let given = Coordinate::ALL.into_iter().zip(coordinates!(section));
    for (_, given) in given.filter(|(other, _)| *other == coordinate) {
        if let Some(given) = given {
            let message = format!(
                "the key \"time\" already gives the drive values; expected either {key} or \"time\""
            );
            let error = problems.add(given.span(), message);
            error.related(time.span(), "given here");
            return None;
        }
    }
    let polynomial = time.get_ref().polynomial.span();
    let written = time_law(time.get_ref(), |c| c, problems)?;
    let values: Vec<f64> = written.times.iter().map(|t| written.value(*t)).collect();
    if values.iter().any(|v| v.abs() > Number::MOST) {
        let message = "the polynomial grows beyond 1e12 between these times";
        return problems.refuse(polynomial, message);
    }
    let in_kernel = |c: &f64| coordinate.in_kernel(*c, axle);
    let law = TimeLaw {
        polynomial: written.polynomial.iter().map(in_kernel).collect(),
        ..written
    };
    Some(Some((AxleTime { coordinate, law }, values)))
}

/// Reads the key `combine`: the rule that combines the lists of a motion into stations.
fn combine(section: &file::Motion, problems: &mut Problems) -> Option<Combine> {
    let Some(text) = &section.combine else {
        return Some(Combine::All);
    };
    let kinds = [("all", Combine::All), ("rows", Combine::Rows)];
    let combine = choose(text, "combine", &kinds, problems)?;
    if combine == Combine::Rows
        && let Some(time) = &section.time
    {
        let message = "combine = \"rows\" does not work with \"time\"; expected lists of values, or no \"combine\"";
        return problems.refuse(time.span(), message);
    }
    Some(combine)
}

/// Keys of an axle's motion, as written in the file.
struct MotionKeys<'a> {
    place: Span<usize>,
    section: &'a file::Motion,
    axle: &'a Axle,
}

/// Values of a coordinate, if the motion gives them.
type Given = Option<Vec<f64>>;

impl MotionKeys<'_> {
    /// Reports an error at a key, or at the section if the key is missing.
    fn refuse<T>(
        &self,
        given: &Option<Spanned<Values>>,
        message: &str,
        problems: &mut Problems,
    ) -> Option<T> {
        let place = given.as_ref().map_or(self.place.clone(), Spanned::span);
        problems.refuse(place, message)
    }

    /// Repeats single values, so that all lists are as long as the longest list. Reports a list of another length.
    fn in_rows(&self, read: &mut [Given], problems: &mut Problems) -> Option<()> {
        let rows = read.iter().flatten().map(Vec::len).max().unwrap_or(1);
        let written = Coordinate::ALL.into_iter().zip(coordinates!(self.section));
        for ((coordinate, written), values) in written.zip(read.iter_mut()) {
            let Some(values) = values else { continue };
            match values.len() {
                1 => *values = vec![values[0]; rows],
                own if own == rows => {}
                own => {
                    let key = coordinate.key();
                    let message = format!(
                        "{key} has {own} values, and another coordinate has {rows}: with combine = \"rows\" each list has one value per row"
                    );
                    return self.refuse(written, &message, problems);
                }
            }
        }
        Some(())
    }

    fn in_kernel(&self, coordinate: Coordinate, written: &[f64]) -> Vec<f64> {
        let values = written.iter();
        values
            .map(|v| coordinate.in_kernel(*v, self.axle))
            .collect()
    }

    /// Returns true if the motion gives rack displacements or steering-wheel angles, as values or over time.
    fn steers(&self) -> bool {
        let drive = self.section.time.as_ref().and(self.section.drive.as_ref());
        let steering = [Coordinate::Rack, Coordinate::SteeringWheel];
        let is_driven = |drive: &Text| steering.iter().any(|own| own.key() == drive.get_ref());
        self.section.rack.is_some()
            || self.section.steering_wheel_angle.is_some()
            || drive.is_some_and(is_driven)
    }

    /// Motion of the wheels, from the values of roll, heave, left travel and right travel. `None` if these keys have an
    /// error.
    fn wheels(
        &self,
        given: (Given, Given, Given, Given),
        on_plane: Option<(bool, Span<usize>)>,
        at_load: Option<bool>,
        problems: &mut Problems,
    ) -> Option<WheelMotion> {
        let (roll, heave, left, right) = given;
        let has_travels = left.is_some() || right.is_some();
        // A motion that only steers has both wheels at the design height.
        let only_steers = self.steers() && roll.is_none() && !has_travels;
        let heave = heave.or_else(|| only_steers.then(|| vec![0.0]));
        Some(match (heave, roll) {
            (_, Some(_)) if has_travels => {
                let message = "roll keeps the mean travel constant; expected roll and heave, or \
                               travel_left and travel_right";
                return self.refuse(&self.section.roll, message, problems);
            }
            (Some(_), _) if has_travels => {
                let message =
                    "heave moves both wheels; expected heave, or travel_left and travel_right";
                return self.refuse(&self.section.heave, message, problems);
            }
            (heave, Some(roll)) => {
                if let Some((false, span)) = on_plane {
                    let message = "roll needs a plane ground; expected ground = \"plane\", or travel_left and travel_right on pads";
                    return problems.refuse(span, message);
                }
                WheelMotion::Roll {
                    heave: heave.unwrap_or_else(|| vec![0.0]),
                    roll: self.in_kernel(Coordinate::Roll, &roll),
                    at_load: at_load?,
                }
            }
            (Some(heave), None) => match on_plane {
                Some((true, _)) => WheelMotion::Roll {
                    heave,
                    roll: vec![0.0],
                    at_load: false,
                },
                _ => WheelMotion::Heave(heave),
            },
            (None, None) if !has_travels => {
                let message = "expected heave, roll, travel_left and travel_right, rack or steering_wheel_angle";
                return problems.refuse(self.place.clone(), message);
            }
            (None, None) => WheelMotion::Travels {
                left: left.unwrap_or_else(|| vec![0.0]),
                right: right.unwrap_or_else(|| vec![0.0]),
                on_plane: on_plane.is_some_and(|(plane, _)| plane),
            },
        })
    }

    /// Rack displacements, and the angles of the steering wheel if the motion gives angles.
    fn racks(&self, given: (Given, Given), problems: &mut Problems) -> Option<(Vec<f64>, Given)> {
        let by_angle = &self.section.steering_wheel_angle;
        match given {
            (Some(_), Some(_)) => {
                let message = "the keys \"rack\" and \"steering_wheel_angle\" both give the rack displacement; expected one of them";
                self.refuse(by_angle, message, problems)
            }
            (racks, None) => {
                let racks = racks.unwrap_or_else(|| vec![0.0]);
                Some((self.in_kernel(Coordinate::Rack, &racks), None))
            }
            (None, Some(_)) if self.axle.setup.c_factor.is_none() => {
                let message = "steering_wheel_angle needs c_factor in [steering]";
                self.refuse(by_angle, message, problems)
            }
            (None, Some(angles)) => {
                let racks = self.in_kernel(Coordinate::SteeringWheel, &angles);
                Some((
                    racks,
                    Some(angles.into_iter().map(f64::to_radians).collect()),
                ))
            }
        }
    }
}

/// Reads the stations of an axle's motion. `None` if the motion has an error.
pub(super) fn motion(
    file: &File,
    section: &Spanned<file::Motion>,
    axle: &Axle,
    problems: &mut Problems,
) -> Option<AxleMotion> {
    let (place, section) = (section.span(), section.get_ref());
    let on_plane = match &section.ground {
        None => None,
        Some(text) => Some((
            choose(
                text,
                "ground",
                &[("plane", true), ("pads", false)],
                problems,
            )?,
            text.span(),
        )),
    };
    let at_load = at_load(file, section, axle, problems);
    let time = over_time(section, axle, problems)?;
    let combine = combine(section, problems)?;
    let coordinates = Coordinate::ALL.into_iter().zip(coordinates!(section));
    let read = coordinates.map(|(coordinate, given)| match (&time, given) {
        (Some((time, values)), _) if time.coordinate == coordinate => Some(Some(values.clone())),
        (_, None) => Some(None),
        (_, Some(given)) if combine == Combine::Rows => list(given, problems).map(Some),
        (_, Some(given)) => values(given, problems).map(Some),
    });
    let mut read: Vec<Given> = read.collect::<Option<_>>()?;
    let written = MotionKeys {
        place: place.clone(),
        section,
        axle,
    };
    let has_rows = combine == Combine::Rows;
    if has_rows {
        written.in_rows(&mut read, problems)?;
    }
    let rows = read.iter().flatten().map(Vec::len).max().unwrap_or(1);
    let [roll, heave, left, right, rack, angle] = std::array::from_fn(|k| read[k].take());
    let wheels = written.wheels((roll, heave, left, right), on_plane, at_load, problems)?;
    let (racks, steering_wheel) = written.racks((rack, angle), problems)?;
    let mut motion = AxleMotion {
        wheels,
        racks,
        combine,
        shows_rack: section.rack.is_some()
            || section.steering_wheel_angle.is_some()
            || time
                .as_ref()
                .is_some_and(|(time, _)| time.coordinate.motion() == Motion::Rack),
        steering_wheel,
        time: time.map(|(time, _)| time),
    };
    if has_rows {
        // A coordinate that the study does not give is 0 at every station.
        for coordinate in Coordinate::ALL {
            if let Some(values) = motion.along(coordinate).filter(|own| own.len() != rows) {
                *values = vec![values[0]; rows];
            }
        }
    }
    if motion.stations() > MOST_STATIONS {
        let message = format!(
            "{} stations; expected at most {MOST_STATIONS}",
            motion.stations()
        );
        return problems.refuse(place, message);
    }
    Some(motion)
}
