//! Static values of a set-up, their target values, and states of the adjusted suspension.

use super::elastic::Elastic;
use super::levels::{Levels, felt};
use super::subject::Subject;
use super::{
    AdjustedSuspension, Aim, MET, MissedTarget, PARTS_OF_A_TURN, SetUpError, Static, is_continuous,
};
use crate::ask::Unit;
use crate::assembly::assembler::Assembler;
use crate::assembly::parts::{BuildParameter, Member};
use crate::assembly::rest::Rest;
use crate::axle::{FROM_DESIGN, Quantity};
use crate::characteristics::Characteristic;
use crate::model::{Mechanism, RockerId, Side, SteeringAxis};
use crate::number::Each;
use crate::study::{AxleStudy, Increment, Setup, Study, Vehicle};
use nalgebra::{DMatrix, DVector};

/// Safety factor on the error that a rounding by half a step causes. The error is a linear estimate; the factor covers
/// its nonlinear terms.
const CURVED: f64 = 1.01;

/// A set-up to solve.
pub(super) struct Problem<'a> {
    subject: Subject<'a>,
    pub(super) increments: Vec<Increment>,
    rest: Rest,
    pub(super) statics: Vec<Static>,
    pub(super) aims: Vec<Aim>,
    /// Weight of each value's error, per printed unit: 10 per degree, 10 per 0.01 deg/mm, 1 per millimetre. 1 for any
    /// other unit.
    pub(super) weights: Vec<f64>,
    /// Length of 1 mm in length units.
    millimetre: f64,
}

impl<'a> Problem<'a> {
    /// Makes the set-up and the state of its design. The set-up is for one wheel, or for both wheels of an axle with
    /// elastic parts and equal wheels.
    pub(super) fn of(
        study: &Study,
        setup: &Setup,
        assembler: &'a Assembler,
    ) -> Result<(Self, AdjustedSuspension), SetUpError> {
        let (mechanism, adjust) = (&study.wheel().mechanism, &setup.adjust);
        let characteristics = characteristics(mechanism, setup, study.is_elastic());
        let statics = characteristics.iter().copied();
        let statics = statics.map(Static::Characteristic).collect();
        let lifts = adjust.iter().any(|a| a.lifts(mechanism));
        let elastic = match &study.vehicle {
            Vehicle::Wheel(own) => own
                .compliance
                .as_ref()
                .map(|elastic| Elastic::wheel(assembler, elastic, adjust, &characteristics, lifts)),
            Vehicle::Axle(both) => both.axle.elastic.as_ref().map(|_| {
                let of_left = |c: &Characteristic| Quantity::Corner(Side::Left, *c);
                let of_left: Vec<Quantity> = characteristics.iter().map(of_left).collect();
                Elastic::axle([assembler; 2], &both.axle, adjust, &of_left, lifts)
            }),
        };
        let subject = match elastic.transpose()? {
            Some(elastic) => Subject::Elastic(Box::new(elastic)),
            None => Subject::wheel(assembler, adjust, characteristics),
        };
        let mut problem = Problem::with(subject, setup, statics, lifts);
        let drawn = problem.state(&vec![0.0; adjust.len()])?;
        problem.keep_toe(&drawn, setup);
        Ok((problem, drawn))
    }

    /// Makes the set-up of an axle whose wheels are set up together, and the state of its design.
    pub(super) fn of_axle(
        both: &AxleStudy,
        setup: &Setup,
        assemblers: [&'a Assembler; 2],
    ) -> Result<(Self, AdjustedSuspension), SetUpError> {
        let quantities = quantities(both, setup);
        let statics = quantities.iter().copied().map(Static::Axle).collect();
        let subject = if both.axle.elastic.is_some() {
            let adjust = &setup.adjust;
            let elastic = Elastic::axle(assemblers, &both.axle, adjust, &quantities, false)?;
            Subject::Elastic(Box::new(elastic))
        } else {
            Subject::axle(assemblers, both, &setup.adjust, quantities)
        };
        let mut problem = Problem::with(subject, setup, statics, false);
        let drawn = problem.state(&vec![0.0; setup.adjust.len()])?;
        if both.axle.is_rigid() {
            problem.keep_steer(&drawn, setup, both);
        } else {
            problem.keep_toe(&drawn, setup);
        }
        Ok((problem, drawn))
    }

    /// Makes a set-up with the target values of the study. `lifts` is true if an adjustment sets the ride height.
    fn with(subject: Subject<'a>, setup: &Setup, mut statics: Vec<Static>, lifts: bool) -> Self {
        let length = subject.suspension().length_unit;
        let millimetre = 1e-3 * length.per_metre();
        let (mut aims, mut weights) = (Vec::new(), Vec::new());
        statics.push(Static::RideHeightChange);
        for value in &statics {
            let unit = value.unit();
            let want = setup.want.iter().find(|want| want.of == *value);
            aims.push(want.map_or(Aim::Free, |want| Aim::Wanted(want.value)));
            weights.push(match unit {
                Unit::Angle => 10.0,
                Unit::AnglePerLength => 10.0 / (0.01 / millimetre),
                Unit::Length => 1.0 / millimetre,
                _ => 1.0,
            });
        }
        // A single adjustment cannot keep the height and also meet another target.
        *aims.last_mut().expect("the ride height is the last value") =
            match setup.ride_height_change {
                Some(change) if lifts => Aim::Wanted(change),
                None if lifts && setup.adjust.len() > 1 => Aim::Kept(0.0),
                _ => Aim::Free,
            };
        let travel = -setup.ride_height_change.unwrap_or(0.0);
        Problem {
            subject,
            increments: setup.adjust.iter().map(|a| a.increment).collect(),
            rest: if lifts {
                Rest::Spring(0.0)
            } else {
                Rest::Height(travel)
            },
            statics,
            aims,
            weights,
            millimetre,
        }
    }

    /// Size of the suspension.
    pub(super) fn size(&self) -> f64 {
        self.subject.suspension().size()
    }

    /// Keeps the toe of the design under three conditions. The study gives no target for toe. The wheel has several
    /// adjustments. One of them is continuous and for toe. An adjustment is for toe if it changes toe more than camber,
    /// caster and ride height. A single adjustment serves only the values with targets.
    fn keep_toe(&mut self, drawn: &AdjustedSuspension, setup: &Setup) {
        let toes: Vec<usize> = self.toes().collect();
        for toe in toes {
            let side = self.statics[toe].side();
            let is_other = |of: &Static| match (of, of.characteristic()) {
                (Static::RideHeightChange, _) => true,
                (of, Some(Characteristic::Camber | Characteristic::Caster)) => of.side() == side,
                _ => false,
            };
            let sets_toe = |k: usize| {
                let effect = |i: usize| (drawn.by[k][i] * self.weights[i]).abs();
                let others = self.statics.iter().enumerate();
                let mut others = others.filter(|(_, of)| is_other(of));
                effect(toe) > 0.0 && others.all(|(i, _)| effect(i) < effect(toe))
            };
            let own = |k: &usize| setup.adjust[*k].is_of(side);
            let has_several = (0..setup.adjust.len()).filter(own).count() > 1;
            let is_free = self.aims[toe] == Aim::Free && drawn.values[toe].is_finite();
            if is_free && has_several && self.threads().filter(own).any(sets_toe) {
                self.aims[toe] = Aim::Kept(drawn.values[toe]);
            }
        }
    }

    /// Keeps the toe of a solid axle's left wheel if its drag link is one of several adjustments. Keeps the toe of the
    /// right wheel if the tie rod is another one. Toe for which the study gives a target is not kept.
    fn keep_steer(&mut self, drawn: &AdjustedSuspension, setup: &Setup, both: &AxleStudy) {
        let Some(steering) = both.axle.left.mechanism.axle_steering() else {
            return;
        };
        let adjusts = |rocker: RockerId| {
            let rod = BuildParameter::Length(Member::Rod(rocker));
            setup.adjust.iter().any(|a| a.change.0 == rod)
        };
        let turns_left = setup.adjust.len() > 1 && adjusts(steering.near_knuckle);
        let keeps = [turns_left, turns_left && adjusts(steering.far_knuckle)];
        let toes: Vec<usize> = self.toes().collect();
        for (toe, _) in toes.into_iter().zip(keeps).filter(|(_, keeps)| *keeps) {
            if self.aims[toe] == Aim::Free {
                self.aims[toe] = Aim::Kept(drawn.values[toe]);
            }
        }
    }

    /// Indices of the toe of each wheel among the static values.
    fn toes(&self) -> impl Iterator<Item = usize> {
        let statics = self.statics.iter().enumerate();
        let toes = statics.filter(|(_, of)| of.characteristic() == Some(Characteristic::Toe));
        toes.map(|(i, _)| i)
    }

    /// Indices of the continuous adjustments, such as threaded adjusters.
    pub(super) fn threads(&self) -> impl Iterator<Item = usize> {
        let increments = self.increments.iter().enumerate();
        increments.filter_map(|(k, increment)| is_continuous(*increment).then_some(k))
    }

    /// Indices of the shims, with their steps.
    pub(super) fn shims(&self) -> impl Iterator<Item = (usize, f64)> {
        let increments = self.increments.iter().enumerate();
        increments.filter_map(|(k, increment)| match increment {
            Increment::Shims { step } => Some((k, *step)),
            Increment::Thread { .. } | Increment::Free => None,
        })
    }

    /// Indices of the values that have a target or are kept.
    pub(super) fn targets(&self) -> Vec<usize> {
        let aims = self.aims.iter().enumerate();
        let targets = aims.filter_map(|(i, aim)| aim.value().map(|_| i));
        targets.collect()
    }

    /// Returns the order in which a mechanic makes the adjustments: shims, then threaded adjusters. If toe has a target
    /// or is kept, the adjuster that changes toe most comes last.
    pub(super) fn order(&self, drawn: &AdjustedSuspension) -> Vec<usize> {
        let mut order: Vec<usize> = self.shims().map(|(k, _)| k).collect();
        order.extend(self.threads());
        let toes: Vec<usize> = self.toes().collect();
        if toes.iter().any(|toe| self.aims[*toe] != Aim::Free) {
            let effect = |k: usize| toes.iter().map(|toe| drawn.by[k][*toe].abs()).sum::<f64>();
            let last = self
                .threads()
                .max_by(|a, b| effect(*a).total_cmp(&effect(*b)));
            if let Some(last) = last {
                order.retain(|k| *k != last);
                order.push(last);
            }
        }
        order
    }

    /// Assembles the parts with these amounts of the adjustments.
    pub(super) fn state(&self, amounts: &[f64]) -> Result<AdjustedSuspension, SetUpError> {
        self.subject.state(amounts, self.rest)
    }

    /// Returns the weighted derivatives `W`, with a row for each of `values` and a column for each of `adjustments`.
    pub(super) fn effects(
        &self,
        state: &AdjustedSuspension,
        values: &[usize],
        adjustments: &[usize],
    ) -> DMatrix<f64> {
        DMatrix::from_fn(values.len(), adjustments.len(), |i, k| {
            state.by[adjustments[k]][values[i]] * self.weights[values[i]]
        })
    }

    /// Weighted errors `D (w - b)` of these values.
    pub(super) fn errors(&self, state: &AdjustedSuspension, values: &[usize]) -> DVector<f64> {
        let error = |i: &usize| {
            let aim = self.aims[*i].value().unwrap_or(f64::NAN);
            (state.values[*i] - aim) * self.weights[*i]
        };
        DVector::from_iterator(values.len(), values.iter().map(error))
    }

    /// Returns an error that lists the missed targets among these values. A value that is not defined misses its
    /// target.
    pub(super) fn out_of_reach(&self, state: &AdjustedSuspension, values: &[usize]) -> SetUpError {
        let missed = values.iter().filter_map(|i| {
            let (value, wanted) = (state.values[*i], self.aims[*i].value()?);
            let met = (value - wanted).abs() <= MET;
            (!met).then_some(MissedTarget {
                of: self.statics[*i],
                value,
                wanted,
            })
        });
        SetUpError::OutOfReach(missed.collect())
    }

    /// Returns the smallest change that a mechanic can make to an adjustment.
    fn grid(&self, increment: Increment) -> f64 {
        match increment {
            Increment::Shims { step } => step,
            Increment::Thread { per_turn } => per_turn / PARTS_OF_A_TURN,
            // A hundredth of a millimetre, or the next smaller power of ten in another unit.
            Increment::Free => 10f64.powf((0.01 * self.millimetre).log10().floor()),
        }
    }

    /// Returns the nearest amount that a mechanic can set.
    pub(super) fn rounded(&self, increment: Increment, amount: f64) -> f64 {
        let grid = self.grid(increment);
        (amount / grid).round() * grid
    }

    /// Errors that half steps of shims may cause, in printed units, by equation (7) of module `set_up`. 0 for a value that
    /// threaded adjusters set.
    pub(super) fn half_steps(&self, levels: &Levels, state: &AdjustedSuspension) -> Vec<f64> {
        let mut allowed = vec![0.0; self.statics.len()];
        let by = self.reduced_effects(levels, state);
        for (column, (_, step)) in self.shims().enumerate() {
            for (row, i) in levels.rest.iter().enumerate() {
                allowed[*i] += CURVED * 0.5 * step * by[(row, column)].abs() / self.weights[*i];
            }
        }
        allowed
    }

    /// Errors that half steps of shims may cause, plus the effect of half the smallest change of every continuous adjustment.
    pub(super) fn with_half_turns(&self, allowed: &[f64], state: &AdjustedSuspension) -> Vec<f64> {
        let mut allowed = allowed.to_vec();
        for k in self.threads() {
            let half = 0.5 * self.grid(self.increments[k]);
            for (allowed, by) in allowed.iter_mut().zip(&state.by[k]) {
                *allowed += CURVED * half * by.abs();
            }
        }
        allowed
    }

    /// Assigns each value with a target to the threaded adjusters or to the shims. Uses the derivatives of a state and equation
    /// (1) of module `set_up`.
    pub(super) fn levels(&self, state: &AdjustedSuspension) -> Levels {
        let targets = self.targets();
        let threads: Vec<usize> = self.threads().collect();
        let met = felt(self.effects(state, &targets, &threads));
        Levels {
            exact: met.iter().map(|row| targets[*row]).collect(),
            rest: (0..targets.len())
                .filter(|row| !met.contains(row))
                .map(|row| targets[row])
                .collect(),
            threads,
            shims: self.shims().map(|(k, _)| k).collect(),
        }
    }
}

/// Characteristics of a set-up: the default characteristics that the suspension has, and further characteristics with
/// targets.
fn characteristics(mechanism: &Mechanism, setup: &Setup, is_elastic: bool) -> Vec<Characteristic> {
    let usual = [
        Characteristic::Camber,
        Characteristic::Toe,
        Characteristic::Caster,
        Characteristic::BumpSteer,
    ];
    let usual = usual.into_iter();
    let mut characteristics: Vec<_> = usual
        .filter(|c| has_value(*c, mechanism, is_elastic))
        .collect();
    for want in &setup.want {
        match want.of {
            Static::Characteristic(c) if !characteristics.contains(&c) => characteristics.push(c),
            _ => {}
        }
    }
    characteristics
}

/// Returns true if a suspension has the steering axis that a characteristic needs. In an equilibrium only joints
/// define the axis.
fn has_value(of: Characteristic, mechanism: &Mechanism, is_elastic: bool) -> bool {
    let has_axis = match mechanism.steering_axis {
        Some(SteeringAxis::Through { .. }) => true,
        axis => axis.is_some() && !is_elastic,
    };
    has_axis || !of.info().reads_steering_axis()
}

/// Quantities of an axle whose wheels are set up together: the default quantities that the axle has, and further
/// quantities with targets.
fn quantities(both: &AxleStudy, setup: &Setup) -> Vec<Quantity> {
    let usual = [
        Characteristic::Camber,
        Characteristic::Toe,
        Characteristic::Caster,
    ];
    let of_wheels = usual
        .into_iter()
        .flat_map(|c| Side::ALL.each(|side| Quantity::Corner(side, c)));
    let usual = of_wheels.chain(FROM_DESIGN.each(Quantity::Axle));
    let (mechanism, is_elastic) = (&both.axle.left.mechanism, both.axle.elastic.is_some());
    let is_read = |quantity: &Quantity| match *quantity {
        Quantity::Corner(_, of) if !has_value(of, mechanism, is_elastic) => false,
        quantity => both.axle.has(quantity),
    };
    let mut quantities: Vec<_> = usual.filter(is_read).collect();
    for want in &setup.want {
        match want.of {
            Static::Axle(quantity) if !quantities.contains(&quantity) => quantities.push(quantity),
            _ => {}
        }
    }
    quantities
}
