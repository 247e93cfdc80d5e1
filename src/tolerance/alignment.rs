//! Toe and camber set again after assembly.
//!
//! Adjustments a hold wanted values w of the resting position. With M the pseudo-inverse of dw/da of the drawing,
//!
//! ```text
//! a <- a - M (w(parts + a) - wanted)
//! ```
//!
//! contracts as fast as parts differ from the drawing; over derivative numbers it mends order by order.

use crate::build::{Assembler, BuildParameter, Built, NoSetUp, Parts, Reject, Rest};
use crate::characteristics::{Characteristic, Constants, Inputs, Slots};
use crate::mechanism::{Configuration, Pose};
use crate::model::Suspension;
use crate::number::{Matrix3, Real, Vector3};
use crate::study::Adjustment;
use nalgebra::DMatrix;

/// The most corrections of a build.
const MOST_ROUNDS: usize = 30;
/// Corrections below this, in parts of the size, are rounding.
const ROUNDING: f64 = 1e-14;

/// What is held by what.
#[derive(Clone, Debug)]
pub(crate) struct Alignment {
    adjust: Vec<(BuildParameter, f64)>,
    /// What keeps the values that the drawing has.
    held: Vec<Characteristic>,
    /// M, a row for each adjustment.
    inverse: DMatrix<f64>,
    constants: Constants,
    slots: Slots,
    size: f64,
}

impl Alignment {
    /// Toe and camber of the drawing by the adjustments of the set-up; toe alone where there is one. Wishes of the set-up
    /// that are neither are not held.
    pub(crate) fn of(adjust: &[Adjustment], assembler: &Assembler) -> Result<Self, NoSetUp> {
        let suspension = assembler.suspension();
        let held: &[Characteristic] = match adjust.len() {
            1 => &[Characteristic::Toe],
            _ => &[Characteristic::Toe, Characteristic::Camber],
        };
        let slots = Slots::of(held.iter().map(|c| c.info().reads));
        let constants = Constants::of(suspension);
        let mut alignment = Alignment {
            adjust: adjust.iter().map(|a| a.change).collect(),
            held: held.to_vec(),
            inverse: DMatrix::zeros(0, 0),
            constants,
            slots,
            size: suspension.size(),
        };
        let built = assembler.build(assembler.drawn(), Rest::Height(0.0))?;
        let by = alignment.by(assembler, &built);
        alignment.inverse = inverse(&by).ok_or(NoSetUp::Unsettled)?;
        // A wish that no adjustment moves cannot be held.
        let held_all =
            (&by * &alignment.inverse - DMatrix::identity(held.len(), held.len())).amax();
        match held_all < 1e-6 {
            true => Ok(alignment),
            false => Err(NoSetUp::Unsettled),
        }
    }

    /// dw/da of a build: a row for each characteristic held, a column for each adjustment.
    fn by(&self, assembler: &Assembler, built: &Built) -> DMatrix<f64> {
        let mut by = DMatrix::zeros(self.held.len(), self.adjust.len());
        for (k, change) in self.adjust.iter().enumerate() {
            let design = assembler.design_series(built, &[*change]);
            for (i, c) in self.held.iter().enumerate() {
                by[(i, k)] = self.value(assembler.suspension(), &design, *c)[1];
            }
        }
        by
    }

    /// The same with M of a build, so that derivatives about it are exact after one correction for each order.
    pub(crate) fn about(&self, assembler: &Assembler, built: &Built) -> Option<Self> {
        Some(Alignment {
            inverse: inverse(&self.by(assembler, built))?,
            ..self.clone()
        })
    }

    /// A characteristic of a built design at rest.
    fn value<T: Real>(
        &self,
        suspension: &Suspension,
        design: &[Vector3<T>],
        c: Characteristic,
    ) -> T {
        let mechanism = &suspension.mechanism;
        let origin = design[mechanism.origin.0];
        let at = Configuration {
            mechanism,
            design,
            pose: Pose {
                origin,
                rotation: Matrix3::identity(origin.x),
            },
            rack: origin.x.zero(),
            steering: None,
        };
        c.evaluate(&Inputs::standing(&at, self.constants, self.slots))
    }

    /// Adds to the changes of the parts what the adjustments have to be.
    fn adjust<T: Real>(
        &self,
        suspension: &Suspension,
        parts: &mut Parts<T>,
        design: &[Vector3<T>],
    ) -> Vec<T> {
        let miss = |c: &Characteristic| {
            let wanted = self.value(suspension, &parts.drawn, *c);
            self.value(suspension, design, *c) - wanted
        };
        let misses: Vec<T> = self.held.iter().map(miss).collect();
        let mut corrections = Vec::with_capacity(self.adjust.len());
        for (k, (parameter, share)) in self.adjust.iter().enumerate() {
            let mut by = misses[0].zero();
            for (i, miss) in misses.iter().enumerate() {
                by = by - miss.scaled(self.inverse[(k, i)]);
            }
            parts.change(&suspension.mechanism, *parameter, by.scaled(*share));
            corrections.push(by);
        }
        corrections
    }

    /// Aligns a build and writes its design.
    pub(crate) fn assemble(
        &self,
        assembler: &Assembler,
        parts: &mut Parts<f64>,
        into: &mut [Vector3<f64>],
    ) -> Result<(), Reject> {
        for _ in 0..MOST_ROUNDS {
            assembler.assemble(parts, 0.0, into)?;
            let corrections = self.adjust(assembler.suspension(), parts, into);
            let largest = corrections
                .iter()
                .fold(0.0, |most: f64, c| most.max(c.abs()));
            if largest <= ROUNDING * self.size {
                return Ok(());
            }
            if largest.is_nan() || largest > self.size {
                break;
            }
        }
        Err(Reject::Unaligned)
    }

    /// The built design along a direction of the drawing, aligned throughout, to as many orders as the number has.
    pub(crate) fn design<T: Real>(
        &self,
        assembler: &Assembler,
        built: &Built,
        parts: &mut Parts<T>,
        orders: usize,
    ) -> Vec<Vector3<T>> {
        let mut design = assembler.design_of(built, parts, orders);
        for _ in 0..orders {
            self.adjust(assembler.suspension(), parts, &design);
            design = assembler.design_of(built, parts, orders);
        }
        design
    }

    /// What the adjustments have to be by each unit of a direction: the direction with them.
    pub(super) fn aligned_direction(
        &self,
        assembler: &Assembler,
        built: &Built,
        direction: &[(BuildParameter, f64)],
    ) -> Vec<(BuildParameter, f64)> {
        let design = assembler.design_series(built, direction);
        let mut aligned = direction.to_vec();
        for (k, (parameter, share)) in self.adjust.iter().enumerate() {
            let mut by = 0.0;
            for (i, c) in self.held.iter().enumerate() {
                let miss = self.value(assembler.suspension(), &design, *c)[1];
                by -= self.inverse[(k, i)] * miss;
            }
            aligned.push((*parameter, by * share));
        }
        aligned
    }
}

/// The pseudo-inverse.
fn inverse(by: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    by.clone().pseudo_inverse(1e-9 * by.amax()).ok()
}
