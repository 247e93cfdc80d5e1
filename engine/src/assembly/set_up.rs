//! Setting a suspension up: adjustments that give wanted static values.
//!
//! With a the adjustments and w(a) what is wanted at rest, Gauss and Newton's step is da = -W^+ (w - wanted), W the
//! exact derivative and W^+ its pseudo-inverse: Newton's method where there are as many adjustments as wanted values, the
//! smallest adjustment where there are more, the least squares where there are fewer. A tenth of a degree counts as
//! much as a length unit of a millimetre. Shims come in steps: in the order of the study each is rounded to whole
//! ones, and what is adjusted after it makes up for that.

use super::assembler::{Assembler, Reject};
use super::derivatives::built_curves;
use super::parts::{BuildParameter, Member};
use super::rest::{Built, Direction, Rest};
use crate::ask::Unit;
use crate::characteristics::Characteristic;
use crate::mechanism::DesignFault;
use crate::plan::Plan;
use crate::study::{Adjustment, Drive, Outputs, Setup, Study};
use nalgebra::{DMatrix, DVector};

/// The most steps of Newton's method.
const MOST_STEPS: usize = 40;
/// The largest adjustment, relative to the size of the suspension.
const FARTHEST: f64 = 0.1;
/// What counts as met: rounding, in degrees or length units.
const MET: f64 = 1e-9;
/// What half a shim leaves may be so much more than its slopes say.
const CURVED: f64 = 1.01;
/// Singular values of W below this part of the largest are directions that no wanted value feels.
const FLAT: f64 = 1e-8;

/// A quantity of the resting position: of the catalogue, or the height of the wheel centre above its drawn one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Static {
    /// A characteristic at travel 0.
    Characteristic(Characteristic),
    /// The ride height.
    RideHeight,
}

/// A suspension at rest with its parts adjusted.
#[derive(Clone, Debug)]
pub struct AdjustedSuspension {
    /// Amount of each adjustment.
    pub amounts: Vec<f64>,
    /// The parts put together.
    pub built: Built,
    /// The static values, as they are printed.
    pub values: Vec<f64>,
    /// Their derivatives by each adjustment, by adjustment and value.
    pub by: Vec<Vec<f64>>,
}

/// A set-up solved.
#[derive(Clone, Debug)]
pub struct SetUp {
    /// The static values: camber, toe, caster and bump steer if they exist, further ones that are wanted, and the ride
    /// height.
    pub statics: Vec<Static>,
    /// For each static value, the wanted one as it is printed; `None` if none is.
    pub wanted: Vec<Option<f64>>,
    /// What is left of each wanted value by steps of shims that nothing adjusted after them can make up for.
    pub by_steps: Vec<f64>,
    /// The state of the drawing, at the wanted ride height.
    pub drawn: AdjustedSuspension,
    /// After each adjustment, in the order of the study.
    pub steps: Vec<AdjustedSuspension>,
}

/// A wish that is missed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Miss {
    /// The value.
    pub of: Static,
    /// What it comes to, as it is printed.
    pub value: f64,
    /// What is wanted of it, as it is printed.
    pub wanted: f64,
}

/// Why a set-up has no answer.
#[derive(Clone, Debug, PartialEq)]
pub enum NoSetUp {
    /// The parts as drawn, or adjusted a little, cannot be put together.
    Reject(Reject),
    /// Put together they are no design that moves.
    Fault(DesignFault),
    /// Newton's method does not settle: what is wanted is beyond what the adjustments reach.
    Unsettled,
    /// The same of wishes: those that are missed where the method ends.
    OutOfReach(Vec<Miss>),
    /// What is wanted takes an adjustment that no workshop makes: more than a tenth of the suspension's size.
    Absurd {
        /// Number of the adjustment.
        adjustment: usize,
        /// How much it would be.
        amount: f64,
    },
}

impl From<Reject> for NoSetUp {
    fn from(reject: Reject) -> Self {
        NoSetUp::Reject(reject)
    }
}

impl From<DesignFault> for NoSetUp {
    fn from(fault: DesignFault) -> Self {
        NoSetUp::Fault(fault)
    }
}

impl SetUp {
    /// The adjustments that give what a study wants.
    pub fn solve(study: &Study, setup: &Setup, assembler: &Assembler) -> Result<SetUp, NoSetUp> {
        let problem = Problem::of(study, setup, assembler);
        let drawn = problem.state(&vec![0.0; setup.adjust.len()])?;
        let free: Vec<usize> = (0..setup.adjust.len()).collect();
        let mut state = problem.settle(drawn.clone(), &free)?;
        let mut by_steps = vec![0.0; problem.statics.len()];
        for (k, adjustment) in setup.adjust.iter().enumerate() {
            let Some(step) = adjustment.step else {
                continue;
            };
            let mut amounts = state.amounts.clone();
            amounts[k] = (amounts[k] / step).round() * step;
            state = problem.state(&amounts)?;
            let later: Vec<usize> = (0..amounts.len())
                .filter(|j| *j != k && (*j > k || setup.adjust[*j].step.is_none()))
                .collect();
            for (left, by) in by_steps.iter_mut().zip(problem.left_by(&state, k, &later)) {
                *left += 0.5 * step * by;
            }
            state = problem.settle(state, &later)?;
        }
        let steps = (0..setup.adjust.len()).map(|last| {
            let mut amounts = state.amounts.clone();
            amounts[last + 1..].fill(0.0);
            problem.state(&amounts)
        });
        let steps = steps.collect::<Result<_, _>>()?;
        let most = FARTHEST * assembler.suspension().size();
        let amounts = state.amounts.iter().copied().enumerate();
        let mut absurd = amounts.filter(|(_, amount)| amount.abs() > most);
        if let Some((adjustment, amount)) = absurd.next() {
            return Err(NoSetUp::Absurd { adjustment, amount });
        }
        Ok(SetUp {
            by_steps,
            drawn,
            steps,
            statics: problem.statics,
            wanted: problem.wanted,
        })
    }

    /// The parts as drawn, and what each adjustment does to them: where there is no set-up, too.
    pub fn drawn(study: &Study, setup: &Setup, assembler: &Assembler) -> Result<SetUp, NoSetUp> {
        let problem = Problem::of(study, setup, assembler);
        Ok(SetUp {
            by_steps: vec![0.0; problem.statics.len()],
            drawn: problem.state(&vec![0.0; setup.adjust.len()])?,
            steps: Vec::new(),
            statics: problem.statics,
            wanted: problem.wanted,
        })
    }

    /// The state after all adjustments.
    pub fn last(&self) -> &AdjustedSuspension {
        self.steps.last().unwrap_or(&self.drawn)
    }

    /// What is left of each wanted value: by how much its value misses what is wanted.
    pub fn misses(&self) -> Vec<Option<f64>> {
        let values = self.last().values.iter().zip(&self.wanted);
        values
            .map(|(value, wanted)| Some(value - (*wanted)?))
            .collect()
    }

    /// Whether every wanted value is met, but for whole steps of shims.
    pub fn is_met(&self) -> bool {
        let misses = self.misses();
        let mut misses = misses.iter().zip(&self.by_steps);
        misses.all(|(miss, by_steps)| miss.is_none_or(|miss| miss.abs() <= MET + by_steps))
    }
}

/// The problem that is solved.
struct Problem<'a> {
    assembler: &'a Assembler,
    directions: Vec<[(BuildParameter, f64); 1]>,
    plan: Plan,
    rest: Rest,
    statics: Vec<Static>,
    wanted: Vec<Option<f64>>,
    /// Weight of each value's miss, per unit in which it is printed: 10 per degree, 1 per millimetre.
    weights: Vec<f64>,
}

impl<'a> Problem<'a> {
    fn of(study: &Study, setup: &Setup, assembler: &'a Assembler) -> Self {
        let mechanism = &study.suspension.mechanism;
        let usual = [
            Characteristic::Camber,
            Characteristic::Toe,
            Characteristic::Caster,
            Characteristic::BumpSteer,
        ];
        let mut characteristics: Vec<_> = usual
            .into_iter()
            .filter(|c| mechanism.steering_axis.is_some() || !c.info().reads_steering_axis())
            .collect();
        for want in &setup.want {
            if !characteristics.contains(&want.characteristic) {
                characteristics.push(want.characteristic);
            }
        }
        let mut at_rest = study.clone();
        at_rest.suspension = assembler.suspension().clone();
        at_rest.outputs = Outputs::of(characteristics.clone());
        at_rest.formulation = crate::study::Formulation::KnucklePose;
        at_rest.motion.drive = Drive::Travel;
        at_rest.motion.values = vec![0.0];
        at_rest.motion.rack = vec![0.0];
        at_rest.motion.time = None;
        let on_spring = setup.adjust.iter().any(|a| lifts(a, study));
        let length = study.suspension.length_unit;
        let millimetre = 1e-3 * length.per_metre();
        let (mut statics, mut wanted, mut weights) = (Vec::new(), Vec::new(), Vec::new());
        for c in characteristics {
            let want = setup.want.iter().find(|want| want.characteristic == c);
            statics.push(Static::Characteristic(c));
            wanted.push(want.map(|want| want.value * c.info().unit.printed_factor(length)));
            weights.push(match c.info().unit {
                Unit::Angle => 10.0,
                Unit::AnglePerLength => 10.0 / (0.01 / millimetre),
                Unit::Length => 1.0 / millimetre,
                _ => 1.0,
            });
        }
        statics.push(Static::RideHeight);
        wanted.push(setup.ride_height.filter(|_| on_spring));
        weights.push(1.0 / millimetre);
        Problem {
            assembler,
            directions: setup.adjust.iter().map(|a| [a.change]).collect(),
            plan: Plan::of(&at_rest),
            rest: match on_spring {
                true => Rest::Spring(0.0),
                false => Rest::Height(setup.ride_height.unwrap_or(0.0)),
            },
            statics,
            wanted,
            weights,
        }
    }

    fn state(&self, amounts: &[f64]) -> Result<AdjustedSuspension, NoSetUp> {
        let mechanism = &self.assembler.suspension().mechanism;
        let mut parts = self.assembler.drawn().clone();
        for (direction, amount) in self.directions.iter().zip(amounts) {
            for (parameter, share) in direction {
                parts.change(mechanism, *parameter, share * amount);
            }
        }
        let built = self.assembler.build(&parts, self.rest)?;
        let directions: Vec<&Direction> = self.directions.iter().map(|d| &d[..]).collect();
        let found = built_curves(self.assembler, &built, &self.plan, &directions)?;
        let values = found.curves.stations[0].values.iter();
        let values = values.map(|v| v.unwrap_or(f64::NAN));
        let columns = found.curves.columns.len();
        Ok(AdjustedSuspension {
            amounts: amounts.to_vec(),
            values: values.chain([built.height]).collect(),
            by: (0..directions.len())
                .map(|d| {
                    let by = (0..columns).map(|column| found.derivative(d, 0, column));
                    by.chain([found.height[d]]).collect()
                })
                .collect(),
            built,
        })
    }

    /// What is left of each value, at most, per unit by which an adjustment is off: what it does to the value itself, or
    /// what least squares over the `later` adjustments make of that, which trade one target for another. The part of its
    /// effects that they cannot undo is (1 - U U^T) w, with U an orthonormal basis of theirs and w its own, weighted.
    fn left_by(&self, state: &AdjustedSuspension, adjustment: usize, later: &[usize]) -> Vec<f64> {
        let mut left: Vec<f64> = state.by[adjustment].iter().map(|by| by.abs()).collect();
        let targets = self.targets();
        if targets.is_empty() || later.is_empty() {
            return left;
        }
        let own = self.weighted_effects(state, &targets, &[adjustment]);
        let own = own.column(0);
        let decomposed = self
            .weighted_effects(state, &targets, later)
            .svd(true, false);
        let flat = FLAT * decomposed.singular_values.max();
        let mut rest = own.clone_owned();
        if let Some(basis) = &decomposed.u {
            let felt = basis.column_iter().zip(decomposed.singular_values.iter());
            for (direction, _) in felt.filter(|(_, singular)| **singular > flat) {
                rest -= direction * direction.dot(&own);
            }
        }
        for (target, rest) in targets.into_iter().zip(rest.iter()) {
            left[target] = left[target].max(CURVED * rest.abs() / self.weights[target]);
        }
        left
    }

    /// What each of these adjustments does to each of these values, weighted: a row for a value, a column for an
    /// adjustment.
    fn weighted_effects(
        &self,
        state: &AdjustedSuspension,
        targets: &[usize],
        adjustments: &[usize],
    ) -> DMatrix<f64> {
        DMatrix::from_fn(targets.len(), adjustments.len(), |i, k| {
            state.by[adjustments[k]][targets[i]] * self.weights[targets[i]]
        })
    }

    /// Numbers of the values of which something is wanted.
    fn targets(&self) -> Vec<usize> {
        let wanted = self.wanted.iter().enumerate();
        let targets = wanted.filter(|(_, wanted)| wanted.is_some());
        targets.map(|(target, _)| target).collect()
    }

    /// The state in which the wanted values are met as well as they can be by some of the adjustments.
    fn settle(
        &self,
        mut state: AdjustedSuspension,
        free: &[usize],
    ) -> Result<AdjustedSuspension, NoSetUp> {
        let targets = self.targets();
        if targets.is_empty() || free.is_empty() {
            return Ok(state);
        }
        let missed = |state: &AdjustedSuspension| {
            let miss = |i: &usize| {
                let wanted = self.wanted[*i].unwrap_or(f64::NAN);
                (state.values[*i] - wanted) * self.weights[*i]
            };
            DVector::from_iterator(targets.len(), targets.iter().map(miss))
        };
        for _ in 0..MOST_STEPS {
            let misses = missed(&state);
            let out_of_reach = || {
                let missed = targets.iter().filter_map(|target| {
                    let (value, wanted) = (state.values[*target], self.wanted[*target]?);
                    // What has no value is missed.
                    let met = (value - wanted).abs() <= MET;
                    (!met).then_some(Miss {
                        of: self.statics[*target],
                        value,
                        wanted,
                    })
                });
                NoSetUp::OutOfReach(missed.collect())
            };
            if misses.iter().any(|m| m.is_nan()) {
                return Err(out_of_reach());
            }
            let decomposed = self
                .weighted_effects(&state, &targets, free)
                .svd(true, true);
            let flat = FLAT * decomposed.singular_values.max();
            let Ok(step) = decomposed.solve(&misses, flat) else {
                return Err(out_of_reach());
            };
            let size = self.assembler.suspension().size();
            if step.norm() <= 1e-14 * size {
                return Ok(state);
            }
            let mut share = 1.0;
            let next = loop {
                let mut amounts = state.amounts.clone();
                for (k, adjustment) in free.iter().enumerate() {
                    amounts[*adjustment] -= share * step[k];
                }
                // Where the parts do not go together, or the wanted values are missed by more, half the step.
                if let Ok(next) = self.state(&amounts)
                    && missed(&next).norm() <= misses.norm()
                {
                    break Some(next);
                }
                share *= 0.5;
                if share < 1e-3 {
                    break None;
                }
            };
            match next {
                Some(next) => state = next,
                // Rounding: no step makes it better.
                None if step.norm() <= 1e-7 * size => return Ok(state),
                None => return Err(out_of_reach()),
            }
        }
        Err(NoSetUp::Unsettled)
    }
}

/// Whether an adjustment is made to lift the car: it is of the way from the spring to the arm. The height then is where
/// the spring has its drawn length.
fn lifts(adjustment: &Adjustment, study: &Study) -> bool {
    let mechanism = &study.suspension.mechanism;
    let Some(spring) = mechanism.spring else {
        return false;
    };
    match adjustment.change.0 {
        BuildParameter::Length(Member::Rod(rocker)) => Some(rocker) == mechanism.spring_rocker(),
        BuildParameter::Length(Member::Link(_)) => false,
        BuildParameter::Coordinate(point, _) => {
            let is_strut = matches!(mechanism.closed_form, Some(crate::model::ClosedForm::Strut));
            !is_strut && (point == spring.upper || point == spring.lower)
        }
    }
}
