//! `[optimise]` of a car: variables, and targets and constraints of load cases.

use super::super::constraints::visible_change;
use super::super::names::choose;
use super::super::resolve::{each, some};
use super::super::targets::{not_tiny, weight};
use super::variables::Written;
use super::{CarOptimise, ENDS, Resolver};
use crate::car::{Car, CarConstraint, CarRun, CarTarget, Case};
use hardpoint_study_file::car_file;
use hardpoint_study_file::file;
use hardpoint_study_file::value::{LimitText, Number, OneOr, Text};
use std::ops::Range as Span;
use toml::Spanned;

/// Largest number of starts.
const MOST_STARTS: i64 = 10_000;

/// Part of the study to which a target or a constraint applies: a case or an axle.
enum Place {
    /// A case, by its name. Its index is looked up later.
    Case(Text),
    /// A single axle.
    Axle(usize),
}

impl Resolver<'_> {
    pub(super) fn optimise(&mut self, car: &Car, cases: &[Case]) -> Option<Option<CarOptimise>> {
        let file = self.file;
        let Some(section) = &file.optimise else {
            return Some(None);
        };
        let run = self.run(section);
        let listed = some(&section.variables, "variable", self.problems)?;
        let variables = each(listed, |written| self.variable(car, &Written::of(written)));
        let written = some(&section.targets, "target", self.problems)?;
        let (mut targets, mut constraints) = (Vec::new(), Vec::new());
        let mut rig_targets = [Vec::new(), Vec::new()];
        let mut rig_constraints = [Vec::new(), Vec::new()];
        let mut sound = true;
        for entry in written {
            let own = entry.get_ref();
            match self.place([&own.case, &own.axle], entry.span()) {
                Some(Place::Axle(end)) => rig_targets[end].push(entry),
                Some(Place::Case(case)) => match self.target(car, cases, &case, entry) {
                    Some(found) => targets.extend(found),
                    None => sound = false,
                },
                None => sound = false,
            }
        }
        for entry in &section.constraints {
            let own = entry.get_ref();
            match self.place([&own.case, &own.axle], entry.span()) {
                Some(Place::Axle(end)) => rig_constraints[end].push(entry),
                Some(Place::Case(case)) => match self.constraint(car, cases, &case, entry) {
                    Some(found) => constraints.extend(found),
                    None => sound = false,
                },
                None => sound = false,
            }
        }
        let variables = variables?;
        let names: Vec<String> = variables.iter().map(|own| own.moves.stem(car)).collect();
        let places: Vec<_> = listed.iter().map(Spanned::span).collect();
        self.distinct(&names, &variables, &places)?;
        let rig = |end: usize, own: &mut Self| {
            own.rig(end, &variables, &rig_targets[end], &rig_constraints[end])
        };
        let rigs = [rig(0, self), rig(1, self)];
        let [front, rear] = rigs;
        let (run, rigs) = (run?, [front?, rear?]);
        sound.then_some(Some(CarOptimise {
            run,
            variables,
            targets,
            constraints,
            rigs,
            side_effects: section
                .side_effects
                .as_ref()
                .is_none_or(|said| *said.get_ref()),
        }))
    }

    /// Reads the largest number of iterations, the number of starts and the seed.
    fn run(&mut self, section: &car_file::Optimise) -> Option<CarRun> {
        let max_iterations = match &section.max_iterations {
            Some(most) if *most.get_ref() < 1 => {
                return self
                    .problems
                    .refuse(most.span(), "expected at least 1 iteration");
            }
            Some(most) => *most.get_ref() as u64,
            None => 200,
        };
        let starts = match &section.starts {
            Some(starts) if !(1..=MOST_STARTS).contains(starts.get_ref()) => {
                let message = format!("expected 1 to {MOST_STARTS} starts");
                return self.problems.refuse(starts.span(), message);
            }
            Some(starts) => *starts.get_ref() as usize,
            None => 1,
        };
        let seed = match &section.seed {
            Some(seed) => match u32::try_from(*seed.get_ref()) {
                Ok(seed) => seed,
                Err(_) => {
                    let message = format!("expected a seed from 0 to {}", u32::MAX);
                    return self.problems.refuse(seed.span(), message);
                }
            },
            None => 1,
        };
        Some(CarRun {
            max_iterations,
            starts,
            seed,
        })
    }

    /// Finds the case or the axle that a target or a constraint names.
    fn place(&mut self, [case, axle]: [&Option<Text>; 2], place: Span<usize>) -> Option<Place> {
        match (case, axle) {
            (Some(case), None) => Some(Place::Case(case.clone())),
            (None, Some(axle)) => {
                let end = choose(axle, "axle", &ENDS, self.problems)?;
                Some(Place::Axle(end))
            }
            _ => {
                let message = "expected the key \"case\" (a load case) or the key \"axle\" (front or rear alone), and \
                               only one of them";
                self.problems.refuse(place, message)
            }
        }
    }

    /// Refuses keys that a target or a constraint of a case does not accept.
    fn refuse_rig_keys<const N: usize>(
        &mut self,
        given: [(&str, Option<Span<usize>>); N],
    ) -> Option<()> {
        match given
            .into_iter()
            .find_map(|(key, place)| Some((key, place?)))
        {
            None => Some(()),
            Some((key, place)) => {
                let message = format!(
                    "{key} is for a single axle (axle = \"front\" or \"rear\"), not for a case"
                );
                self.problems.refuse(place, message)
            }
        }
    }

    /// Reads the targets of one case from an element of `targets`.
    fn target(
        &mut self,
        car: &Car,
        cases: &[Case],
        case: &Text,
        entry: &Spanned<file::Target>,
    ) -> Option<Vec<CarTarget>> {
        let written = entry.get_ref();
        let text = |text: &Option<Text>| text.as_ref().map(Spanned::span);
        let numbers = |n: &Option<Spanned<_>>| n.as_ref().map(Spanned::span);
        self.refuse_rig_keys([
            ("point", text(&written.point)),
            ("axis", text(&written.axis)),
            ("length", written.length.as_ref().map(Spanned::span)),
            ("load", text(&written.load)),
            ("figure", text(&written.figure)),
            ("points", written.points.as_ref().map(Spanned::span)),
            ("file", text(&written.file)),
            ("column", text(&written.column)),
            ("at", written.at.as_ref().map(|n| n.span.clone())),
            ("over", text(&written.over)),
            ("side", text(&written.side)),
            ("roll", numbers(&written.roll)),
            ("heave", numbers(&written.heave)),
            ("travel_left", numbers(&written.travel_left)),
            ("travel_right", numbers(&written.travel_right)),
            (
                "steering_wheel_angle",
                numbers(&written.steering_wheel_angle),
            ),
            ("rack", numbers(&written.rack)),
            ("motion", text(&written.motion)),
            ("interpolation", text(&written.interpolation)),
        ])?;
        let name = self.characteristic(&written.characteristic, entry.span())?;
        let quantities = self.named(car, name)?;
        let case = self.case_of(&quantities, case, cases)?;
        let tolerance = not_tiny(&written.tolerance, self.problems)?;
        let weight = weight(&written.weight, self.problems)?;
        let has_band =
            written.between.is_some() || written.at_least.is_some() || written.at_most.is_some();
        let wanted = match &written.value {
            Some(value) if has_band => {
                let message =
                    "expected one of the keys \"value\", \"between\", \"at_least\" and \"at_most\"";
                return self.problems.refuse(value.span.clone(), message);
            }
            Some(value) => [value.value; 2],
            None => self.band_of(written, entry.span())?,
        };
        let target = |quantity| CarTarget {
            quantity,
            case,
            wanted,
            tolerance,
            weight,
        };
        Some(quantities.into_iter().map(target).collect())
    }

    fn characteristic<'t>(
        &mut self,
        name: &'t Option<Text>,
        place: Span<usize>,
    ) -> Option<&'t Text> {
        match name {
            Some(name) => Some(name),
            None => {
                let message =
                    "expected the key \"characteristic\": the name of a result of the case";
                self.problems.refuse(place, message)
            }
        }
    }

    /// Reads the tolerance band of a target of a case.
    fn band_of(&mut self, written: &file::Target, place: Span<usize>) -> Option<[f64; 2]> {
        let mut number = |limit: &LimitText, place: Span<usize>| match limit {
            OneOr::One(value) => Some(Number {
                value: *value,
                span: place,
            }),
            OneOr::Many(_) => {
                let message =
                    "a target of a case has one value, so its limit is one number, not a curve";
                self.problems.refuse(place, message)
            }
        };
        let between = match &written.between {
            None => None,
            Some(list) => {
                let numbers = list.get_ref().iter();
                let numbers = numbers.map(|limit| number(limit, list.span()));
                let numbers: Option<Vec<Number>> = numbers.collect();
                Some(Spanned::new(list.span(), numbers?))
            }
        };
        let mut one = |limit: &Option<Spanned<LimitText>>| match limit {
            None => Some(None),
            Some(limit) => number(limit.get_ref(), limit.span()).map(Some),
        };
        let (low, high) = (one(&written.at_least)?, one(&written.at_most)?);
        self.limits((between.as_ref(), low.as_ref(), high.as_ref()), place)
    }

    /// Reads the constraints of one case from an element of `constraints`.
    fn constraint(
        &mut self,
        car: &Car,
        cases: &[Case],
        case: &Text,
        entry: &Spanned<file::Constraint>,
    ) -> Option<Vec<CarConstraint>> {
        let written = entry.get_ref();
        let text = |text: &Option<Text>| text.as_ref().map(Spanned::span);
        let names = |list: &Option<Spanned<Vec<Text>>>| list.as_ref().map(Spanned::span);
        self.refuse_rig_keys([
            ("length", written.length.as_ref().map(Spanned::span)),
            ("point", text(&written.point)),
            ("members", names(&written.members)),
            ("articulation", text(&written.articulation)),
            ("plunge", written.plunge.as_ref().map(Spanned::span)),
            ("load", text(&written.load)),
            ("coplanar", names(&written.coplanar)),
            ("line", names(&written.line)),
            ("kept", written.kept.as_ref().map(Spanned::span)),
            ("inside", written.inside.as_ref().map(Spanned::span)),
            ("outside", written.outside.as_ref().map(Spanned::span)),
            (
                "clearance",
                written.clearance.as_ref().map(|n| n.span.clone()),
            ),
            ("radii", written.radii.as_ref().map(Spanned::span)),
            ("at", text(&written.at)),
            ("rack", written.rack.as_ref().map(Spanned::span)),
            ("motion", text(&written.motion)),
            ("side", text(&written.side)),
        ])?;
        let name = self.characteristic(&written.characteristic, entry.span())?;
        let quantities = self.named(car, name)?;
        let number = self.case_of(&quantities, case, cases)?;
        let limits = (
            written.between.as_ref(),
            written.at_least.as_ref(),
            written.at_most.as_ref(),
        );
        let between = self.limits(limits, entry.span())?;
        let own = written.name.as_ref().map(|name| name.get_ref().clone());
        let constraint = |quantity: crate::car::CarQuantity| CarConstraint {
            name: own
                .clone()
                .unwrap_or_else(|| format!("{} in {}", quantity.name(), case.get_ref())),
            quantity,
            case: number,
            between,
            visible: visible_change(quantity.info().unit, car.length_unit).0,
        };
        Some(quantities.into_iter().map(constraint).collect())
    }
}
