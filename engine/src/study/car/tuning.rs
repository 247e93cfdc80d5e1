//! `[optimise]` of a car: variables, and targets and constraints of load cases and of each axle alone.

use super::super::constraints::{each_constraint, visible_change};
use super::super::names::choose;
use super::super::resolve::{Context, each, some};
use super::super::suspension::{above_zero, positive};
use super::super::targets::each_target;
use super::super::{Motion, Move, Optimise, TargetKind, Variable, parse};
use super::variables::Written;
use super::{CarOptimise, ENDS, Resolver};
use crate::ask::Need;
use crate::axle::Quantity;
use crate::car::{Car, CarConstraint, CarRun, CarTarget, CarVariable, Case, Moves, RigGoals};
use hardpoint_study_file::car_file;
use hardpoint_study_file::error::Source;
use hardpoint_study_file::file;
use hardpoint_study_file::value::{LimitText, Number, OneOr, Text};
use std::ops::Range as Span;
use std::path::Path;
use std::sync::Arc;
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
        let tolerance = above_zero(&written.tolerance, self.problems)?;
        let weight = positive(&written.weight, self.problems)?.unwrap_or(1.0);
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

    /// Targets and constraints of a single axle, read like those in a study of this axle.
    fn rig(
        &mut self,
        end: usize,
        variables: &[CarVariable],
        targets: &[&Spanned<file::Target>],
        constraints: &[&Spanned<file::Constraint>],
    ) -> Option<Option<RigGoals>> {
        let places = targets.iter().map(|entry| entry.span());
        let mut places = places.chain(constraints.iter().map(|entry| entry.span()));
        let Some(first) = places.next() else {
            return Some(None);
        };
        let (columns, own) = variables_of(end, variables);
        if columns.is_empty() {
            let message = format!("no variable moves a hardpoint of the {} axle", ENDS[end].0);
            return self.problems.refuse(first, message);
        }
        let study = &self.axles[end];
        let source = Arc::new(Source {
            name: study.name.clone(),
            text: study.text.clone(),
        });
        // The file was read before, so its errors are already reported.
        let file = parse::parse(&source).ok()?;
        let still = Motion::still();
        let context = Context {
            suspension: study.wheel(),
            motion: Some(&still),
            motions: &study.motions,
            loads: &[],
            axle: study.axle(),
            elastic: None,
            file: &file,
            directory: Path::new(""),
        };
        let read = each_target(targets.iter().copied(), false, &context, self.problems);
        let kept = each_constraint(constraints.iter().copied(), &context, self.problems);
        let (read, _) = read?;
        for (target, entry) in read.iter().zip(targets) {
            if let TargetKind::Axle(quantities) = &target.of.kind {
                self.refuse_moved_rates(end, variables, quantities, entry.span())?;
            }
        }
        Some(Some(RigGoals {
            columns,
            optimise: Optimise {
                targets: read,
                constraints: kept?,
                ..without_goals(own)
            },
        }))
    }

    /// Refuses a quantity of a single axle if it depends on a rate that is a variable. The calculation of a single axle
    /// uses the rates of the axle's study, not the variable.
    fn refuse_moved_rates(
        &mut self,
        end: usize,
        variables: &[CarVariable],
        quantities: &[Quantity],
        place: Span<usize>,
    ) -> Option<()> {
        let rates = [
            Need::SpringForce,
            Need::Springs,
            Need::HeaveSpring,
            Need::TBar,
            Need::HeaveBar,
            Need::BarRate,
            Need::TyreRate,
        ];
        let depends = |quantity: &&Quantity| {
            let mut needs = quantity.info().needs.iter();
            needs.any(|need| rates.contains(need))
        };
        let moves = |variable: &CarVariable| matches!(variable.moves, Moves::Rate { axle, .. } if axle == end);
        match quantities.iter().find(depends) {
            Some(_) if variables.iter().any(moves) => {
                let message = format!(
                    "this target depends on rates of the {} axle, which are variables here: use a \
                     target with the key \"case\"",
                    ENDS[end].0
                );
                self.problems.refuse(place, message)
            }
            _ => Some(()),
        }
    }
}

impl CarOptimise {
    /// Returns the part of the tuning that could be in a study of one axle.
    pub(crate) fn of_axle(&self, end: usize) -> Optimise {
        Optimise {
            side_effects: self.side_effects,
            ..match &self.rigs[end] {
                Some(goals) => goals.optimise.clone(),
                None => without_goals(variables_of(end, &self.variables).1),
            }
        }
    }
}

/// Tuning of a single axle, with these variables and without targets.
fn without_goals(variables: Vec<Variable>) -> Optimise {
    Optimise {
        starts: 1,
        seed: 1,
        max_iterations: 1,
        variables,
        targets: Vec::new(),
        constraints: Vec::new(),
        good_enough: 0.0,
        fit: false,
        front: Vec::new(),
        scatter: None,
        side_effects: false,
    }
}

/// Variables that move hardpoints of an axle, in the form of a study of the axle, with their indices.
fn variables_of(end: usize, variables: &[CarVariable]) -> (Vec<usize>, Vec<Variable>) {
    let own = variables
        .iter()
        .enumerate()
        .filter_map(|(number, variable)| {
            let moves = variable.moves.points().iter().filter(|at| at.axle == end);
            let moves: Vec<Move> = moves
                .map(|at| Move {
                    point: at.point,
                    axis: at.axis,
                    factor: at.factor,
                })
                .collect();
            let variable = Variable {
                name: String::new(),
                moves,
                turn: None,
                rate: None,
                range: variable.range,
                cost: 1.0,
            };
            (!variable.moves.is_empty()).then_some((number, variable))
        });
    own.unzip()
}
