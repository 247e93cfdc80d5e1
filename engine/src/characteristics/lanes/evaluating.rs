//! Values of quantities, and their derivatives with respect to the drive coordinate, for several poses at once (one in
//! each SIMD lane).

use super::{EvaluationRule, LaneInputs, LaneReader};
use crate::characteristics::gains::{by_drive, is_angle};
use crate::characteristics::{Characteristic, Inputs, Quantity, Wheel};
use crate::number::{Jet, Outlined, SimdReal, outlined};
use std::hint::black_box;

impl LaneReader<'_> {
    /// Writes the values of all quantities. The values of successive quantities are `stride` numbers apart. NaN replaces a
    /// value that is not finite.
    #[inline(always)]
    pub fn values<B: SimdReal>(&self, read: &LaneInputs<B>, to: &mut [f64], stride: usize) {
        read.inputs.turn.x.outlined(Evaluating {
            rules: &self.rules,
            read,
            to,
            stride,
        });
    }

    /// Writes the derivatives of all quantities with respect to the drive coordinate, in the order of
    /// [`LaneReader::values`]. The inputs must have rates. NaN for quantities that contain velocities, because their
    /// derivatives need accelerations.
    #[inline(always)]
    pub fn slopes<B: SimdReal>(&self, read: &LaneInputs<B>, to: &mut [f64], stride: usize) {
        let inputs = &read.inputs;
        let unknown = inputs.turn.x.constant(f64::NAN);
        let mut takes_series = false;
        for (number, rule) in self.rules.iter().enumerate() {
            let slope = match (rule, self.quantities[number]) {
                (EvaluationRule::Coordinate(point, axis), _) => read.points[*point][1][*axis],
                (_, Quantity::Characteristic(c)) if is_angle(c) => {
                    let slope = outlined!(
                        [B: SimdReal] unknown; c: Characteristic = c, inputs: &'p Inputs<B> = inputs
                            => Option<B> { by_drive(c, inputs) }
                    );
                    slope.unwrap_or(unknown)
                }
                (_, quantity) => {
                    takes_series = takes_series || quantity.rate_order() == 0;
                    unknown
                }
            };
            slope.finite().store(&mut to[number * stride..]);
        }
        if !takes_series {
            return;
        }
        // The lanes are computed one after another. A single SIMD function of all formulas as series would take too
        // long to compile.
        for lane in 0..B::LANES {
            let series = series(inputs, lane);
            for (k, quantity) in self.quantities.iter().enumerate() {
                if let Quantity::Characteristic(c) = quantity
                    && !is_angle(*c)
                {
                    to[k * stride + lane] = c.slope(&series).finite();
                }
            }
        }
    }
}

/// Task that evaluates quantities.
struct Evaluating<'i, B> {
    rules: &'i [EvaluationRule],
    read: &'i LaneInputs<B>,
    to: &'i mut [f64],
    stride: usize,
}

impl<B: SimdReal> Outlined for Evaluating<'_, B> {
    type Output = ();
    #[inline(always)]
    fn work(self) {
        let mut first = 0;
        for rule in self.rules {
            // Without `black_box`, the compiler moves work ahead of the choice of the formula. The code would then
            // compute the divisions and roots of all formulas for each characteristic.
            let read = black_box(self.read);
            let value = match rule {
                EvaluationRule::Formula(c) => c.evaluate(&read.inputs),
                EvaluationRule::Slope(angle) => {
                    by_drive(*angle, &read.inputs).expect("the characteristic is an angle")
                }
                EvaluationRule::Coordinate(point, axis) => read.points[*point][0][*axis],
                EvaluationRule::AngularVelocity(axis) => read.inputs.turn[*axis],
            };
            value.finite().store(&mut self.to[first..]);
            first += self.stride;
        }
    }
}

/// Inputs of one lane as series in the drive.
#[inline(always)]
fn series<B: SimdReal>(inputs: &Inputs<B>, lane: usize) -> Inputs<Jet<f64, 2>> {
    let one = inputs.map(
        #[inline(always)]
        |number: B| number.in_lane(lane),
    );
    let nothing = Wheel::filled(Jet([f64::NAN; 2]));
    Inputs {
        now: one.now.with_rate(&one.rate),
        rate: nothing,
        turn: nothing.centre,
        design: one.design.map(Jet::constant),
        constants: one.constants,
    }
}

impl Characteristic {
    /// Slope with respect to the drive coordinate in one lane, from inputs as series.
    #[inline(never)]
    fn slope(self, inputs: &Inputs<Jet<f64, 2>>) -> f64 {
        if self.info().reads_rates() {
            f64::NAN
        } else {
            self.evaluate(inputs)[1]
        }
    }
}
