//! Targets and constraints of a single axle in `[optimise]` of a car.

use super::super::constraints::each_constraint;
use super::super::resolve::{Context, each};
use super::super::targets::each_target;
use super::super::{Constraint, Motion, Move, Optimise, Target, TargetKind, Variable, parse};
use super::{CarOptimise, ENDS, Resolver};
use crate::ask::Need;
use crate::axle::{Quantity, WheelMotion};
use crate::car::{CarVariable, Moves, RigGoals};
use crate::characteristics::Measure;
use hardpoint_study_file::error::Source;
use hardpoint_study_file::file;
use std::ops::Range as Span;
use std::sync::Arc;
use toml::Spanned;

/// Required inputs of quantities that are rates (of springs, bars or tyres). A variable of a car can change each of them.
const RATES: [Need; 7] = [
    Need::SpringForce,
    Need::Springs,
    Need::HeaveSpring,
    Need::TBar,
    Need::HeaveBar,
    Need::BarRate,
    Need::TyreRate,
];

/// Returns true if a quantity of an axle depends on rates.
fn has_rates(quantity: &Quantity) -> bool {
    let mut needs = quantity.info().needs.iter();
    needs.any(|need| RATES.contains(need))
}

/// Returns true if a target of an axle depends on rates: by its quantity, or by a motion at constant wheel load.
fn is_of_rates(target: &Target) -> bool {
    let site = target.site.axle.as_ref();
    let at_load = |own: &WheelMotion| matches!(own, WheelMotion::Roll { at_load: true, .. });
    site.is_some_and(|site| at_load(&site.held.wheels))
        || matches!(&target.of.kind, TargetKind::Axle(of) if of.iter().any(has_rates))
}

/// Returns true if a constraint of an axle depends on rates.
fn limits_rates(constraint: &Constraint) -> bool {
    let mut parts = constraint.parts.iter();
    parts.any(|part| matches!(&part.of, Measure::OfAxle(of) if has_rates(of)))
}

impl Resolver<'_> {
    /// Targets and constraints of a single axle, read like those in a study of this axle.
    pub(super) fn rig(
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
        let axles = self.axles;
        let study = &axles[end];
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
            directory: &study.directory,
        };
        let is_rate = |variable: &CarVariable| matches!(variable.moves, Moves::Rate { axle, .. } if axle == end);
        let moves_rates = variables.iter().any(is_rate);
        let targets = each(targets, |entry| {
            let (read, _) = each_target([*entry], false, &context, self.problems)?;
            if moves_rates && read.iter().any(is_of_rates) {
                return self.refuse_moved_rates(end, "target", entry.span());
            }
            Some(read)
        });
        let constraints = each(constraints, |entry| {
            let read = each_constraint([*entry], &context, self.problems)?;
            if moves_rates && read.iter().any(limits_rates) {
                return self.refuse_moved_rates(end, "constraint", entry.span());
            }
            Some(read)
        });
        Some(Some(RigGoals {
            columns,
            optimise: Optimise {
                targets: targets?.into_iter().flatten().collect(),
                constraints: constraints?.into_iter().flatten().collect(),
                ..without_goals(own)
            },
        }))
    }

    /// Refuses a target or a constraint of a single axle that depends on a rate, if such a rate is a variable. The calculation
    /// of a single axle uses the rates of the axle's study, not the variable.
    fn refuse_moved_rates<T>(&mut self, end: usize, goal: &str, place: Span<usize>) -> Option<T> {
        let message = format!(
            "this {goal} depends on rates of the {} axle, which are variables here: use a {goal} with the key \"case\"",
            ENDS[end].0
        );
        self.problems.refuse(place, message)
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
