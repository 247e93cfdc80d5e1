//! Limits on the values of a car in a study. The program checks them when it reads a study, for ranges of variables,
//! for scatter, and for the designs of sweeps and tunings.

use super::parameters::{AxleParameter, BodyParameter};
use super::{Car, Masses, Moves};
use crate::ask::{Accepted, six_digits};

/// Rates of an axle that a study can vary.
const RATES: [AxleParameter; 6] = [
    AxleParameter::SpringRate,
    AxleParameter::BarRate,
    AxleParameter::HeaveSpringRate,
    AxleParameter::TBarRate,
    AxleParameter::HeaveBarRate,
    AxleParameter::TyreRate,
];

/// Values of the whole car that a study can vary.
const FIGURES: [Moves; 7] = [
    Moves::Body(BodyParameter::Mass),
    Moves::Body(BodyParameter::CgX),
    Moves::Body(BodyParameter::CgY),
    Moves::Body(BodyParameter::CgZ),
    Moves::Body(BodyParameter::BrakeShareFront),
    Moves::Body(BodyParameter::DriveShareFront),
    Moves::Wheelbase,
];

impl Car {
    /// Returns the first value that a study does not accept. `None` if a study accepts all values of this car.
    fn refused(&self) -> Option<(Moves, f64)> {
        Moves::values().find_map(|moves| {
            let value = moves.value(self)?;
            (!moves.accepted(self).contains(value)).then_some((moves, value))
        })
    }

    /// Describes the first value that a study does not accept. `None` if a study accepts all values of this car.
    pub fn refusal(&self) -> Option<String> {
        let (moves, value) = self.refused()?;
        let [noun, _] = moves.nouns();
        Some(format!(
            "{} is {}: expected a {noun} {}",
            moves.label(self),
            six_digits(value),
            moves.accepted(self)
        ))
    }

    /// Describes the first value that a study does not accept, without numbers, so that equal reasons can be counted.
    pub(crate) fn counted_refusal(&self) -> Option<String> {
        let (moves, _) = self.refused()?;
        let [noun, _] = moves.nouns();
        let reason = moves.reason_of_limits(self);
        let reason = reason.map(|reason| format!(": {reason}"));
        Some(format!(
            "{} is not an accepted {noun}{}",
            moves.label(self),
            reason.unwrap_or_default()
        ))
    }

    /// Height of the ground under the front axle in the design position, in the car's frame.
    pub(crate) fn ground(&self) -> f64 {
        let front = &self.axles[0];
        front.mean_wheel_centre().z - front.setup.wheel_radius.unwrap_or(0.0)
    }

    /// Distances of the front and the rear axle from the origin in the design position, positive if the axle is ahead
    /// of the origin.
    pub(crate) fn axles_ahead(&self) -> [f64; 2] {
        let [front, rear] = self.axles.each_ref().map(|axle| axle.mean_wheel_centre().x);
        [front, rear + self.rear_offset.x]
    }
}

impl Moves {
    /// Returns the values that a study can vary, except hardpoints: first the rates of both axles, then the values of
    /// the whole car.
    pub fn values() -> impl Iterator<Item = Moves> {
        let rates = [0, 1].into_iter().flat_map(|axle| {
            let rate = move |parameter| Moves::Rate { axle, parameter };
            RATES.map(rate)
        });
        rates.chain(FIGURES)
    }

    /// Returns the range of values that a study accepts for this value, in the study's unit. All other values of the
    /// car stay unchanged.
    pub fn accepted(&self, car: &Car) -> Accepted {
        match *self {
            Moves::Hardpoints(_) => Accepted::All,
            Moves::Rate { axle, parameter } => match parameter {
                AxleParameter::SpringRate => Accepted::Above(self.excess_of_left(car, axle)),
                _ => Accepted::Above(0.0),
            },
            Moves::Wheelbase => match car.masses {
                // The centre of gravity of the whole car must be between the axles.
                Masses::Whole => Accepted::Above((car.axles_ahead()[0] - car.cg.x).max(0.0)),
                Masses::Sprung => Accepted::Above(0.0),
            },
            Moves::Body(parameter) => match parameter {
                BodyParameter::Mass => match car.masses {
                    Masses::Whole => {
                        let own = car.axles.iter().filter_map(|axle| axle.setup.unsprung_mass);
                        Accepted::Above(own.sum::<f64>() / car.mass_unit.kilograms())
                    }
                    Masses::Sprung => Accepted::Above(0.0),
                },
                BodyParameter::CgX if car.masses == Masses::Whole => {
                    let sign = Moves::sign(parameter, car);
                    let [front, rear] = car.axles_ahead().map(|x| sign * x);
                    Accepted::Between(front.min(rear), front.max(rear))
                }
                BodyParameter::CgZ if Moves::sign(parameter, car) > 0.0 => {
                    Accepted::Above(car.ground())
                }
                BodyParameter::CgZ => Accepted::Below(-car.ground()),
                BodyParameter::BrakeShareFront | BodyParameter::DriveShareFront => Accepted::Share,
                _ => Accepted::All,
            },
        }
    }

    /// Returns the left spring rate minus the right spring rate, or 0 if the left rate is lower. A variable changes
    /// both rates by the same amount. So the left rate must stay above this difference, or the right rate would not be
    /// positive.
    fn excess_of_left(&self, car: &Car, axle: usize) -> f64 {
        let Some(laws) = &car.axles[axle].setup.springs else {
            return 0.0;
        };
        match laws.each_ref().map(|law| law.rate()) {
            [Some(left), Some(right)] => (left - right).max(0.0) / self.written_unit(car),
            // A spring with a force curve has no rate, so no variable changes its rate.
            _ => 0.0,
        }
    }

    /// Returns the noun for the value in singular and plural, for messages.
    pub fn nouns(&self) -> [&'static str; 2] {
        match self {
            Moves::Hardpoints(_) => ["offset", "offsets"],
            Moves::Rate { .. } => ["rate", "rates"],
            Moves::Body(BodyParameter::Mass) => ["mass", "masses"],
            Moves::Body(BodyParameter::BrakeShareFront | BodyParameter::DriveShareFront) => {
                ["share", "shares"]
            }
            Moves::Body(_) => ["coordinate", "coordinates"],
            Moves::Wheelbase => ["wheelbase", "wheelbases"],
        }
    }

    /// Returns the reason why other values of the car limit the range of this variable. `None` if they do not, and for a
    /// spring rate that the other wheel's rate limits.
    pub(crate) fn reason_of_limits(&self, car: &Car) -> Option<&'static str> {
        match (self, car.masses) {
            (Moves::Body(BodyParameter::Mass), Masses::Whole) => {
                Some("the mass of the whole car includes the unsprung masses of its axles")
            }
            (Moves::Body(BodyParameter::CgX) | Moves::Wheelbase, Masses::Whole) => {
                Some("the centre of gravity of the whole car must be between the axles")
            }
            (Moves::Body(BodyParameter::CgZ), _) => {
                Some("the centre of gravity must be above the ground")
            }
            _ => None,
        }
    }
}
