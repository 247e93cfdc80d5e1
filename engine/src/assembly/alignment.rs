//! Toe and camber, set again after assembly.
//!
//! Adjustments a keep values w of the static position (toe and camber) at their nominal values. M is the pseudo-inverse
//! of the derivative dw/da at the nominal design. The iteration
//!
//! ```text
//! a <- a - M (w(parts + a) - wanted)
//! ```
//!
//! converges faster, the closer the parts are to nominal. If the numbers carry derivatives, each correction makes one
//! more order of the derivatives exact. The carrier's pose is corrected together with the adjustments (module `settle`).
//! This needs the derivative of the pose with respect to each adjustment.

use super::assembler::Assembler;
use super::assembly_error::AssemblyError;
use super::parts::{BuildParameter, Parts};
use super::rest::Built;
use super::set_up::SetUpError;
use crate::characteristics::Characteristic;
use crate::derive::DesignedSpinAxis;
use crate::linear::lu::Vector6;
use crate::mechanism::{Pose, Twist};
use crate::model::{Mechanism, Side};
use crate::number::{Real, Vector3, larger};
use crate::study::Adjustment;
use nalgebra::DMatrix;

/// Largest number of characteristics that adjustments keep: toe and camber.
pub(super) const MOST_HELD: usize = 2;
/// Maximum number of corrections of the adjustments of a build. After each correction, the build is assembled again.
const MOST_ROUNDS: usize = 30;
/// Size of a correction of an adjustment, relative to the suspension's size, below which it counts as a rounding error.
pub(super) const ROUNDING: f64 = 1e-14;

/// Adjustments that keep toe and camber at their nominal values.
#[derive(Clone, Debug)]
pub(crate) struct Alignment {
    adjust: Vec<(BuildParameter, f64)>,
    /// Characteristics that keep their nominal values.
    held: Vec<Characteristic>,
    /// Matrix M, the pseudo-inverse of the derivative of the characteristics with respect to the adjustments. It has a row for
    /// each adjustment and a column for each entry of `held`.
    inverse: DMatrix<f64>,
    /// Derivative of the carrier's pose with respect to each adjustment, at the nominal design.
    follow: Vec<Vector6<f64>>,
    size: f64,
}

impl Alignment {
    /// Makes an alignment that keeps toe and camber at their nominal values. It uses the adjustments of the set-up that
    /// act on the wheel of this side. `side` is `None` for a single wheel. A single adjustment keeps only toe. A wheel
    /// without adjustments keeps its toe and camber as built. Other targets of the set-up are ignored. A solid axle cannot be
    /// aligned.
    pub(crate) fn of(
        adjust: &[Adjustment],
        side: Option<Side>,
        assembler: &Assembler,
    ) -> Result<Self, SetUpError> {
        let adjust: Vec<&Adjustment> = adjust.iter().filter(|a| a.is_of(side)).collect();
        let suspension = assembler.suspension();
        let held: &[Characteristic] = match adjust.len() {
            0 => &[],
            1 => &[Characteristic::Toe],
            _ => &[Characteristic::Toe, Characteristic::Camber],
        };
        let mut alignment = Alignment {
            adjust: adjust.iter().map(|a| a.change).collect(),
            held: held.to_vec(),
            inverse: DMatrix::zeros(0, 0),
            follow: adjust
                .iter()
                .map(|a| assembler.twist_by(a.change))
                .collect(),
            size: suspension.size(),
        };
        let built = assembler.build_drawn()?;
        let by = alignment.by(assembler, &built);
        alignment.inverse = inverse(&by).ok_or(SetUpError::Unsettled)?;
        // If no adjustment changes a characteristic, the alignment cannot keep its value.
        let held_all =
            (&by * &alignment.inverse - DMatrix::identity(held.len(), held.len())).amax();
        if held_all < 1e-6 {
            Ok(alignment)
        } else {
            Err(SetUpError::Unsettled)
        }
    }

    /// Computes the derivatives of a build's characteristics in `held` with respect to the adjustments: the matrix dw/da of this
    /// module. It has a row for each characteristic and a column for each adjustment.
    fn by(&self, assembler: &Assembler, built: &Built) -> DMatrix<f64> {
        let mut by = DMatrix::zeros(self.held.len(), self.adjust.len());
        for (k, change) in self.adjust.iter().enumerate() {
            let design = assembler.design_series(built, &[*change]);
            for (i, c) in self.held.iter().enumerate() {
                by[(i, k)] = value(&assembler.suspension().mechanism, &design, *c)[1];
            }
        }
        by
    }

    /// Returns the same alignment, with the matrix M computed for this build instead of for the nominal design. With this matrix,
    /// one correction of the adjustments for each order makes the derivatives at this build exact.
    pub(crate) fn about(&self, assembler: &Assembler, built: &Built) -> Option<Self> {
        Some(Alignment {
            inverse: inverse(&self.by(assembler, built))?,
            ..self.clone()
        })
    }

    /// Corrects the adjustments of the parts once. Returns the corrections.
    fn adjust<T: Real>(
        &self,
        mechanism: &Mechanism,
        parts: &mut Parts<T>,
        design: &[Vector3<T>],
    ) -> Vec<T> {
        let miss = |c: &Characteristic| {
            let wanted = value(mechanism, &parts.drawn, *c);
            value(mechanism, design, *c) - wanted
        };
        let misses: Vec<T> = self.held.iter().map(miss).collect();
        let mut corrections = Vec::with_capacity(self.adjust.len());
        for (k, (parameter, share)) in self.adjust.iter().enumerate() {
            let mut by = misses[0].zero();
            for (i, miss) in misses.iter().enumerate() {
                by = by - miss.scaled(self.inverse[(k, i)]);
            }
            parts.change(mechanism, *parameter, by.scaled(*share));
            corrections.push(by);
        }
        corrections
    }

    /// Assembles parts, adjusts them until toe and camber are nominal, and writes the built design.
    pub(crate) fn assemble(
        &self,
        assembler: &Assembler,
        parts: &mut Parts<f64>,
        into: &mut [Vector3<f64>],
    ) -> Result<(), AssemblyError> {
        let mut aligned = parts.clone();
        if let Some(pose) = assembler.settle(&mut aligned, Some(self), 0.0, assembler.home()) {
            *parts = aligned;
            return assembler.place_checked(parts, &pose, into);
        }
        // Far from nominal, the parts are assembled again after every correction.
        let mechanism = &assembler.suspension().mechanism;
        for _ in 0..MOST_ROUNDS {
            let _ = assembler.assemble(parts, 0.0, into)?;
            let corrections = self.adjust(mechanism, parts, into);
            let largest = corrections
                .iter()
                .fold(0.0, |most: f64, c| larger(most, c.abs()));
            if largest <= ROUNDING * self.size {
                return Ok(());
            }
            if largest.is_nan() || largest > self.size {
                break;
            }
        }
        Err(AssemblyError::Unaligned)
    }

    /// Nominal values of the characteristics in `held`.
    #[inline(always)]
    pub(super) fn wanted<T: Real>(
        &self,
        mechanism: &Mechanism,
        drawn: &[Vector3<T>],
    ) -> [T; MOST_HELD] {
        let axis = DesignedSpinAxis::of(mechanism, drawn).direction;
        let mut wanted = [axis.x.zero(); MOST_HELD];
        for (wanted, c) in wanted.iter_mut().zip(&self.held) {
            *wanted = c.of_spin_axis(axis);
        }
        wanted
    }

    /// Corrects the adjustments, and moves the pose by the effect of these corrections. `apply` receives each computed
    /// correction and returns the correction to use.
    #[inline(always)]
    pub(super) fn correct<T: Real>(
        &self,
        mechanism: &Mechanism,
        wanted: &[T; MOST_HELD],
        parts: &mut Parts<T>,
        pose: &mut Pose<T>,
        mut apply: impl FnMut(T) -> T,
    ) {
        let designed = DesignedSpinAxis::of(mechanism, &parts.points).direction;
        let axis = pose.rotation.apply(designed);
        let zero = axis.x.zero();
        let mut misses = *wanted;
        for (miss, c) in misses.iter_mut().zip(&self.held) {
            *miss = c.of_spin_axis(axis) - *miss;
        }
        let mut twist = [zero; 6];
        for (k, (parameter, share)) in self.adjust.iter().enumerate() {
            let mut by = zero;
            for (i, miss) in misses[..self.held.len()].iter().enumerate() {
                by = by - miss.scaled(self.inverse[(k, i)]);
            }
            let by = apply(by);
            parts.change(mechanism, *parameter, by.scaled(*share));
            for (sum, follow) in twist.iter_mut().zip(&self.follow[k]) {
                *sum = *sum + by.scaled(*follow);
            }
        }
        let Twist { shift, turn } = Twist::from_array(twist);
        *pose = pose.moved(shift, turn * zero.constant(0.5));
    }

    /// Returns the built design of parts whose dimensions are derivative numbers with `orders` orders. Toe and camber
    /// stay nominal in all orders.
    pub(crate) fn design<T: Real>(
        &self,
        assembler: &Assembler,
        built: &Built,
        parts: &mut Parts<T>,
        orders: usize,
    ) -> Vec<Vector3<T>> {
        let mut design = assembler.design_of(built, parts, orders);
        for _ in 0..orders {
            self.adjust(&assembler.suspension().mechanism, parts, &design);
            design = assembler.design_of(built, parts, orders);
        }
        design
    }

    /// Returns `direction`, a change of the parts, extended by changes of the adjustments. With these changes, the
    /// characteristics in `held` keep their values along the direction.
    pub(crate) fn aligned_direction(
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
                let miss = value(&assembler.suspension().mechanism, &design, *c)[1];
                by -= self.inverse[(k, i)] * miss;
            }
            aligned.push((*parameter, by * share));
        }
        aligned
    }
}

/// Returns the value of a characteristic of a built design in its static position.
fn value<T: Real>(mechanism: &Mechanism, design: &[Vector3<T>], c: Characteristic) -> T {
    c.of_spin_axis(DesignedSpinAxis::of(mechanism, design).direction)
}

/// Returns the pseudo-inverse of a matrix. For a wheel without adjustments, it is empty like the matrix itself.
fn inverse(by: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    if by.is_empty() {
        return Some(by.transpose());
    }
    by.clone().pseudo_inverse(1e-9 * by.amax()).ok()
}
