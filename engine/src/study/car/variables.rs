//! Variables of a car as written: hardpoints, rates and values of the car, with their ranges.

use super::super::moves::{self, range};
use super::super::names::choose;
use super::super::suspension::above_zero;
use super::{ENDS, Resolver};
use crate::ask::six_digits;
use crate::car::{AxleParameter, BodyParameter, Car, CarVariable, Moves, PointMove};
use hardpoint_study_file::car_file;
use hardpoint_study_file::file::Coordinates;
use hardpoint_study_file::value::{Number, OneOrMore, Text};
use std::ops::Range as Span;
use toml::Spanned;

/// Keys that name a part of the car, and the change of this part.
pub(super) struct Written<'a> {
    place: Span<usize>,
    axle: Option<(Span<usize>, Vec<&'a str>)>,
    hardpoint: &'a Option<Text>,
    hardpoints: &'a Option<Spanned<Vec<Text>>>,
    factors: &'a Option<Spanned<Vec<Number>>>,
    axis: Option<&'a Text>,
    direction: Option<&'a Coordinates>,
    rate: Option<&'a Text>,
    car: Option<&'a Text>,
    range: Option<&'a Spanned<Vec<Number>>>,
    percent: Option<&'a Number>,
}

/// Macro that copies the keys of a variable from the file as written. The type of the variable must have all of these keys.
macro_rules! moved_by {
    ($written:expr) => {{
        let own = $written.get_ref();
        Written {
            place: $written.span(),
            axle: own.axle.as_ref().map(|axle| (axle.span(), names(axle))),
            hardpoint: &own.hardpoint,
            hardpoints: &own.hardpoints,
            factors: &own.factors,
            axis: own.axis.as_ref(),
            direction: own.direction.as_ref(),
            rate: own.rate.as_ref(),
            car: own.car.as_ref(),
            range: own.range.as_ref(),
            percent: own.percent.as_ref(),
        }
    }};
}

fn names(axle: &Spanned<OneOrMore>) -> Vec<&str> {
    match axle.get_ref() {
        OneOrMore::One(name) => vec![name],
        OneOrMore::More(names) => names.iter().map(|name| name.get_ref().as_str()).collect(),
    }
}

impl<'a> Written<'a> {
    pub(super) fn of(written: &'a Spanned<car_file::Variable>) -> Self {
        moved_by!(written)
    }

    pub(super) fn of_sweep(written: &'a Spanned<car_file::SweepVariable>) -> Self {
        moved_by!(written)
    }

    /// Reads the keys of a scatter entry for a rate or a value of the car.
    pub(super) fn of_scatter(written: &'a Spanned<car_file::Scatter>) -> Self {
        let own = written.get_ref();
        let axle = own.axle.as_ref();
        Written {
            place: written.span(),
            axle: axle.map(|text| (text.span(), vec![text.get_ref().as_str()])),
            hardpoint: &None,
            hardpoints: &None,
            factors: &None,
            axis: None,
            direction: None,
            rate: own.rate.as_ref(),
            car: own.car.as_ref(),
            range: None,
            percent: own.percent.as_ref(),
        }
    }
}

impl Resolver<'_> {
    /// Indices of the axles that a variable or a scatter entry names.
    fn ends(&mut self, own: &Written<'_>) -> Option<Vec<usize>> {
        let Some((place, names)) = &own.axle else {
            return Some(Vec::new());
        };
        let mut ends = Vec::new();
        for name in names {
            let text = Spanned::new(place.clone(), (*name).to_owned());
            let end = choose(&text, "axle", &ENDS, self.problems)?;
            if ends.contains(&end) {
                let message = format!("{name} is listed twice");
                return self.problems.refuse(place.clone(), message);
            }
            ends.push(end);
        }
        Some(ends)
    }

    /// Finds the part of the car that a variable or a scatter entry changes: hardpoints with a direction, a rate, or a value of
    /// the car.
    pub(super) fn moves(&mut self, car: &Car, own: &Written<'_>) -> Option<Moves> {
        let ends = self.ends(own)?;
        let has_points = own.hardpoint.is_some() || own.hardpoints.is_some();
        match (ends.as_slice(), has_points, own.rate, own.car) {
            ([_, ..], true, None, None) => self.points(car, &ends, own),
            ([axle], false, Some(rate), None) => {
                let rates = [
                    ("spring", AxleParameter::SpringRate),
                    ("anti_roll_bar", AxleParameter::BarRate),
                    ("heave_spring", AxleParameter::HeaveSpringRate),
                    ("t_bar", AxleParameter::TBarRate),
                    ("heave_bar", AxleParameter::HeaveBarRate),
                    ("tyre", AxleParameter::TyreRate),
                ];
                let parameter = choose(rate, "rate", &rates, self.problems)?;
                Some(Moves::Rate {
                    axle: *axle,
                    parameter,
                })
            }
            ([], false, None, Some(figure)) => self.figure(figure),
            _ => {
                let message = "expected \"axle\" with \"hardpoint\" and \"axis\", one \"axle\" with \"rate\", or \"car\"";
                self.problems.refuse(own.place.clone(), message)
            }
        }
    }

    /// Coordinates of hardpoints. If the variable names two axles, both axles must have points with these names. The
    /// factors of the first axle's points come first, then the factors of the second axle's points.
    fn points(&mut self, car: &Car, ends: &[usize], own: &Written<'_>) -> Option<Moves> {
        if own.axis.is_none() && own.direction.is_none() {
            let message = "a hardpoint needs axis = \"x\", \"y\" or \"z\", or a direction";
            return self.problems.refuse(own.place.clone(), message);
        }
        let named = own
            .hardpoints
            .as_ref()
            .map_or(1, |list| list.get_ref().len());
        let factors = self.factors(own, named, ends.len())?;
        let mut found = Vec::new();
        for (k, end) in ends.iter().enumerate() {
            let written = moves::Written {
                place: own.place.clone(),
                hardpoint: own.hardpoint,
                hardpoints: own.hardpoints,
                factors: &None,
                axis: own.axis,
                direction: own.direction,
            };
            let suspension = &car.axles[*end].left;
            let own = moves::moves(&written, suspension, self.problems)?;
            // With a direction, each point has several consecutive coordinates.
            let per_point = own.len() / named.max(1);
            found.extend(own.iter().enumerate().map(|(place, at)| PointMove {
                axle: *end,
                point: at.point,
                axis: at.axis,
                factor: at.factor * factors[k * named + place / per_point.max(1)],
            }));
        }
        Some(Moves::Hardpoints(found))
    }

    /// Displacement of each hardpoint of each axle, per unit of the variable.
    fn factors(&mut self, own: &Written<'_>, named: usize, ends: usize) -> Option<Vec<f64>> {
        let count = named * ends;
        let Some(list) = own.factors else {
            return Some(vec![1.0; count]);
        };
        let factors: Vec<f64> = list.get_ref().iter().map(|n| n.value).collect();
        if factors.len() != count || factors.contains(&0.0) {
            let message = format!(
                "expected {count} factors other than 0, one for each hardpoint of each axle, found {}",
                factors.len()
            );
            return self.problems.refuse(list.span(), message);
        }
        Some(factors)
    }

    /// A value of the car, such as a mass.
    fn figure(&mut self, figure: &Text) -> Option<Moves> {
        let figures = [
            ("mass", Moves::Body(BodyParameter::Mass)),
            ("cg_x", Moves::Body(BodyParameter::CgX)),
            ("cg_y", Moves::Body(BodyParameter::CgY)),
            ("cg_z", Moves::Body(BodyParameter::CgZ)),
            (
                "brake_share_front",
                Moves::Body(BodyParameter::BrakeShareFront),
            ),
            (
                "drive_share_front",
                Moves::Body(BodyParameter::DriveShareFront),
            ),
            ("wheelbase", Moves::Wheelbase),
        ];
        choose(figure, "value of the car", &figures, self.problems)
    }

    /// Converts a percentage of the study's value `now` to the unit of this value. Refuses a value of 0; the message names
    /// `instead` as the key to use.
    pub(super) fn percent_of(&mut self, part: &Number, now: f64, instead: &str) -> Option<f64> {
        let percent = above_zero(part, self.problems)?;
        if now == 0.0 {
            let message =
                format!("the study's value is 0, so percent has no effect: expected {instead}");
            return self.problems.refuse(part.span.clone(), message);
        }
        Some(percent / 100.0 * now.abs())
    }

    /// Refuses two variables with the same name, or with the same effect.
    pub(super) fn distinct(
        &mut self,
        names: &[String],
        variables: &[CarVariable],
        places: &[Span<usize>],
    ) -> Option<()> {
        for (k, own) in variables.iter().enumerate() {
            let named = names[..k].iter().position(|known| *known == names[k]);
            let moved = || variables[..k].iter().position(|v| v.moves == own.moves);
            let (first, message) = match (named, moved()) {
                (Some(first), _) => (first, format!("{} is already a variable", names[k])),
                (None, Some(first)) => (first, "another variable has the same effect".to_owned()),
                (None, None) => continue,
            };
            let error = self.problems.add(places[k].clone(), message);
            error.related(places[first].clone(), "here");
            return None;
        }
        Some(())
    }

    /// Reads a variable with its range. `None` if it has an error.
    pub(super) fn variable(&mut self, car: &Car, own: &Written<'_>) -> Option<CarVariable> {
        let place = own.place.clone();
        let moves = self.moves(car, own)?;
        if self.file.car.get_ref().wheelbase.is_some() && moves.changes_wheelbase(car) {
            let message =
                "wheel_centre moves along x, and [car] wheelbase fixes the distance of the axles";
            self.problems.add(place, message).help(
                "give rear_offset in [car] instead of wheelbase: each axle then keeps its \
                 position on the body",
            );
            return None;
        }
        let Some(now) = moves.value(car) else {
            let message = "the study does not give this value, so it cannot vary";
            return self.problems.refuse(place, message);
        };
        let [_, nouns] = moves.nouns();
        let (range, written) = match (own.range, own.percent) {
            (Some(list), None) => (range(list, nouns, self.problems)?, list.span()),
            _ if !moves.points().is_empty() => {
                let message = "a hardpoint needs \"range\", in the length unit; the key \"percent\" is for rates and \
                               values of the car";
                return self.problems.refuse(place, message);
            }
            (None, Some(part)) => {
                let change = self.percent_of(part, now, "range")?;
                ([now - change, now + change], part.span.clone())
            }
            _ => {
                let message = "expected \"range\" or \"percent\", and only one of them";
                return self.problems.refuse(place, message);
            }
        };
        let accepted = moves.accepted(car);
        if let Some(end) = accepted.first_outside(range) {
            let message = format!("expected {nouns} {accepted}, found {}", six_digits(end));
            let error = self.problems.add(written, message);
            if let Some(reason) = moves.reason_of_limits(car) {
                error.help(reason);
            }
            return None;
        }
        if !(range[0]..=range[1]).contains(&now) {
            let message = format!("the range does not include the study's value {now}");
            return self.problems.refuse(place, message);
        }
        Some(CarVariable { moves, range })
    }
}
