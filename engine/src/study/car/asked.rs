//! Requests of a study of a car: results, sweep and tolerances.

use super::super::motion::within;
use super::super::names::{choose, nearest};
use super::super::resolve::{each, some};
use super::super::suspension::above_zero;
use super::super::sweep as samples;
use super::super::{Law, SweepVariable, Tolerance, tolerance};
use super::variables::Written;
use super::{CarBand, CarContributor, CarSweep, CarTolerance, ENDS, Resolver};
use crate::car::{Car, CarQuantity, CarVariable, Case};
use hardpoint_study_file::car_file;
use hardpoint_study_file::value::{Number, Text};
use std::ops::Range as Span;
use toml::Spanned;

/// Largest number of builds (cars with random deviations). The values of all builds are kept in memory.
const MOST_BUILDS: i64 = 100_000;

/// Difference between successive seeds: the seeds of the front axle, of the rear axle and of the values of the car.
const STREAM: u32 = 0x9e37_79b9;

/// `between`, `at_least` and `at_most` of a target, a constraint or a band.
type Limits<'a> = (
    Option<&'a Spanned<Vec<Number>>>,
    Option<&'a Number>,
    Option<&'a Number>,
);

impl Resolver<'_> {
    pub(super) fn quantities(&mut self, car: &Car) -> Option<Vec<CarQuantity>> {
        let Some(list) = &self.file.outputs.characteristics else {
            return Some(CarQuantity::default_columns(car));
        };
        let mut found = Vec::new();
        let mut sound = true;
        for text in list.get_ref() {
            match self.named(car, text) {
                Some(quantities) => found.extend(quantities),
                None => sound = false,
            }
        }
        sound.then_some(found)
    }

    pub(super) fn named(&mut self, car: &Car, text: &Text) -> Option<Vec<CarQuantity>> {
        let found = CarQuantity::named(text.get_ref());
        if found.is_empty() {
            self.refuse_unknown(text);
            return None;
        }
        let met: Vec<CarQuantity> = found.iter().copied().filter(|q| q.is_met_by(car)).collect();
        if met.is_empty() {
            let mut needs: Vec<&str> = Vec::new();
            for need in found.iter().flat_map(|q| q.info().needs) {
                // A result of both axles needs the same keys at each axle, so each key is listed only once.
                if !needs.contains(&need.key()) {
                    needs.push(need.key());
                }
            }
            let message = format!("{} needs {}", text.get_ref(), needs.join(" and "));
            return self.problems.refuse(text.span(), message);
        }
        Some(met)
    }

    /// Refuses an unknown result, and suggests the result that was probably meant.
    fn refuse_unknown(&mut self, text: &Text) {
        let name = text.get_ref();
        let names = CarQuantity::names();
        let list = "docs/car.md lists the results of a car under Results";
        let help = match nearest(name, names.iter().map(String::as_str)) {
            Some(near) => format!("did you mean \"{near}\"? {list}"),
            None => list.to_owned(),
        };
        let message = format!("unknown result of a car {name:?}");
        self.problems.add(text.span(), message).help(help);
    }

    /// Index of the case with this name, in which the results are evaluated.
    pub(super) fn case_of(
        &mut self,
        quantities: &[CarQuantity],
        written: &Text,
        cases: &[Case],
    ) -> Option<usize> {
        let names: Vec<(&str, usize)> = cases
            .iter()
            .enumerate()
            .map(|(k, case)| (case.name.as_str(), k))
            .collect();
        let case = choose(written, "case", &names, self.problems)?;
        for quantity in quantities {
            if let Some(why) = quantity.undefined_in(&cases[case]) {
                let message = format!("{} has no value in this case: {why}", quantity.name());
                return self.problems.refuse(written.span(), message);
            }
        }
        Some(case)
    }

    /// Lower and upper limit of a target, a constraint or a band. `place` is its position in the file.
    pub(super) fn limits(
        &mut self,
        (between, at_least, at_most): Limits<'_>,
        place: Span<usize>,
    ) -> Option<[f64; 2]> {
        match (between, at_least, at_most) {
            (Some(between), None, None) => match between.get_ref().as_slice() {
                [low, high] if low.value < high.value => Some([low.value, high.value]),
                _ => {
                    let message =
                        "expected between = [lowest, highest], the first below the second";
                    self.problems.refuse(between.span(), message)
                }
            },
            (None, Some(low), None) => Some([low.value, f64::INFINITY]),
            (None, None, Some(high)) => Some([f64::NEG_INFINITY, high.value]),
            _ => {
                let message = "expected one of between = [lowest, highest], at_least and at_most";
                self.problems.refuse(place, message)
            }
        }
    }

    pub(super) fn sweep(&mut self, car: &Car) -> Option<Option<CarSweep>> {
        let file = self.file;
        let Some(section) = &file.sweep else {
            return Some(None);
        };
        let written = section.get_ref();
        let asked = samples::SamplingKeys {
            section: section.span(),
            variables: written.variables.span(),
            method: &written.method,
            samples: &written.samples,
            seed: &written.seed,
            has_steps: written
                .variables
                .get_ref()
                .iter()
                .any(|v| v.get_ref().steps.is_some()),
        };
        let rules = asked.rules(self.problems);
        let listed = some(&written.variables, "variable", self.problems)?;
        let read = each(listed, |variable| self.swept(car, variable))?;
        let (variables, columns): (Vec<CarVariable>, Vec<SweepVariable>) = read.into_iter().unzip();
        let names: Vec<String> = columns.iter().map(|column| column.name.clone()).collect();
        let places: Vec<_> = listed.iter().map(Spanned::span).collect();
        self.distinct(&names, &variables, &places)?;
        Some(Some(CarSweep {
            sampled: asked.sampled(rules, columns, &places, self.problems)?,
            variables,
            format: samples::format(&written.format, self.problems)?,
            constraints: written.constraints.unwrap_or(true),
        }))
    }

    fn swept(
        &mut self,
        car: &Car,
        written: &Spanned<car_file::SweepVariable>,
    ) -> Option<(CarVariable, SweepVariable)> {
        let variable = self.variable(car, &Written::of_sweep(written))?;
        let own = written.get_ref();
        let steps = match &own.steps {
            None => None,
            Some(steps) => Some(samples::steps(steps, Some(variable.range), self.problems)?),
        };
        let name = match &own.name {
            Some(name) => samples::plain(name, self.problems)?,
            None => variable.moves.stem(car),
        };
        let column = SweepVariable {
            name,
            moves: Vec::new(),
            rate: None,
            absolute: false,
            range: variable.range,
            steps,
        };
        Some((variable, column))
    }

    pub(super) fn tolerance(&mut self, car: &Car, cases: &[Case]) -> Option<Option<CarTolerance>> {
        let file = self.file;
        let Some(section) = &file.tolerance else {
            return Some(None);
        };
        let written = section.get_ref();
        let mut whole = |number: &Option<Spanned<i64>>, default: i64, range| match number {
            None => Some(default),
            Some(number) => within(number, range, self.problems),
        };
        let builds = whole(&written.builds, 2000, 2..=MOST_BUILDS)?;
        let seed = whole(&written.seed, 1, 0..=i64::from(u32::MAX))?;
        let seed = u32::try_from(seed).ok()?;
        let of_axle = |number: u32| Tolerance {
            builds: builds as u64,
            // The random streams of both axles and of the car's values are separate.
            seed: seed.wrapping_add(number.wrapping_mul(STREAM)),
            aligned: false,
            scatter: Vec::new(),
            bands: Vec::new(),
        };
        let mut tolerance = CarTolerance {
            builds: builds as u64,
            seed,
            figure_seed: of_axle(2).seed,
            axles: [of_axle(0), of_axle(1)],
            contributors: Vec::new(),
            bands: Vec::new(),
        };
        let mut sound = true;
        for entry in some(&written.scatter, "scatter", self.problems)? {
            sound &= self.scatter(car, entry, &mut tolerance).is_some();
        }
        for band in written.bands.iter().flatten() {
            match self.band(car, cases, band) {
                Some(bands) => tolerance.bands.extend(bands),
                None => sound = false,
            }
        }
        sound.then_some(Some(tolerance))
    }

    /// Adds the tolerance sources that an entry of `scatter` names.
    fn scatter(
        &mut self,
        car: &Car,
        written: &Spanned<car_file::Scatter>,
        into: &mut CarTolerance,
    ) -> Option<()> {
        let own = written.get_ref();
        if own.rate.is_none() && own.car.is_none() {
            return self.scattered_parts(written, into);
        }
        let keys = [
            (own.hardpoint.as_ref().map(Spanned::span), "hardpoint"),
            (own.hardpoints.as_ref().map(Spanned::span), "hardpoints"),
            (own.length.as_ref().map(Spanned::span), "length"),
            (own.jig.as_ref().map(Spanned::span), "jig"),
            (own.side.as_ref().map(Spanned::span), "side"),
            (own.axis.as_ref().map(Spanned::span), "axis"),
            (own.shift.as_ref().map(|n| n.span.clone()), "shift"),
            (own.turn.as_ref().map(|n| n.span.clone()), "turn"),
        ];
        if let Some((Some(place), key)) = keys.into_iter().find(|(place, _)| place.is_some()) {
            let message =
                format!("the key {key} is not available for a rate or a value of the car");
            return self.problems.refuse(place, message);
        }
        let moves = self.moves(car, &Written::of_scatter(written))?;
        let Some(now) = moves.value(car) else {
            let message = "the study does not give this value, so it cannot scatter";
            return self.problems.refuse(written.span(), message);
        };
        let law = match (&own.sigma, &own.percent, &own.limits) {
            (Some(sigma), None, None) => Law::Normal {
                sigma: above_zero(sigma, self.problems)?,
            },
            (None, Some(part), None) => Law::Normal {
                sigma: self.percent_of(part, now, "sigma or limits")?,
            },
            (None, None, Some(limits)) => match limits.get_ref().as_slice() {
                [low, high] if low.value < high.value => Law::Uniform {
                    low: low.value,
                    high: high.value,
                },
                _ => {
                    let message = "expected limits = [lowest, highest], the first below the second";
                    return self.problems.refuse(limits.span(), message);
                }
            },
            _ => {
                let message = "expected one of the keys \"sigma\", \"percent\" and \"limits\"";
                return self.problems.refuse(written.span(), message);
            }
        };
        let [noun, _] = moves.nouns();
        let remedy = if own.percent.is_some() {
            "a smaller percent"
        } else {
            "a smaller sigma"
        };
        let value = |deviation| now + deviation;
        let accepted = moves.accepted(car);
        if let Some(message) = tolerance::unacceptable(law, value, accepted, [noun, remedy]) {
            let error = self.problems.add(written.span(), message);
            if let Some(reason) = moves.reason_of_limits(car) {
                error.help(reason);
            }
            return None;
        }
        let name = moves.stem(car);
        into.contributors
            .push(CarContributor::Figure { name, moves, law });
        Some(())
    }

    /// Adds the scattering parts of one axle, like a study of this axle.
    fn scattered_parts(
        &mut self,
        written: &Spanned<car_file::Scatter>,
        into: &mut CarTolerance,
    ) -> Option<()> {
        let own = written.get_ref();
        let Some(text) = &own.axle else {
            let message =
                "expected the key \"axle\" together with a part of this axle, or the key \"car\"";
            return self.problems.refuse(written.span(), message);
        };
        let axle = choose(text, "axle", &ENDS, self.problems)?;
        if let Some(part) = &own.percent {
            let message = "the key \"percent\" is for rates and values of the car; a part needs \"sigma\" or \"limits\"";
            return self.problems.refuse(part.span.clone(), message);
        }
        let study = self.axles[axle].axle()?;
        let entry = Spanned::new(written.span(), own.of_axle());
        let found =
            tolerance::contributors_of_axle(&entry, study, &study.axle.left, None, self.problems)?;
        let known = &mut into.axles[axle].scatter;
        for contributor in found {
            into.contributors.push(CarContributor::Part {
                name: format!("{} {}", crate::car::AXLE_NAMES[axle], contributor.name),
                axle,
                number: known.len(),
            });
            known.push(contributor);
        }
        Some(())
    }

    fn band(
        &mut self,
        car: &Car,
        cases: &[Case],
        written: &Spanned<car_file::Band>,
    ) -> Option<Vec<CarBand>> {
        let own = written.get_ref();
        let quantities = self.named(car, &own.characteristic)?;
        let case = self.case_of(&quantities, &own.case, cases)?;
        let limits = (
            own.between.as_ref(),
            own.at_least.as_ref(),
            own.at_most.as_ref(),
        );
        let between = self.limits(limits, written.span())?;
        let band = |quantity| CarBand {
            quantity,
            case,
            between,
        };
        Some(quantities.into_iter().map(band).collect())
    }
}
