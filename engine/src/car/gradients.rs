//! Derivatives of results by hardpoints and parameters, equation (10) of [`super`].

use super::equations::Balance;
use super::parameters::{Parameter, Parameters};
use super::rates::{Plain, Solved, settle};
use super::solver::{Base, CarSolver, Equilibrium};
use super::{CarQuantity, Case, NoEquilibrium};
use crate::model::Side;
use crate::number::{Scalar, Tape, Tracked, Vector3};

/// A result with its derivatives.
#[derive(Clone, Debug)]
pub struct CarGradient {
    /// The value, in radians, newtons and length units.
    pub value: f64,
    /// For each axle the derivatives by the hardpoints of the left wheel, in the kernel's frame. The right wheel's hardpoints
    /// move with them as mirror images.
    pub hardpoints: [Vec<Vector3<f64>>; 2],
    /// For each wheel the derivatives by its own hardpoints, in the kernel's frame of its side: front left, front right, rear
    /// left, rear right.
    pub wheels: [Vec<Vector3<f64>>; 4],
    /// Derivatives by all parameters.
    pub parameters: [f64; Parameter::COUNT],
}

impl<'a> CarSolver<'a> {
    /// The state with its derivatives along directions.
    pub fn solved(
        &mut self,
        case: &Case,
        found: &Equilibrium,
    ) -> Result<Solved<'a, f64>, NoEquilibrium> {
        let readings = self.readings(found)?;
        let parameters = Parameters::of(self.car, case);
        let base = readings.base(self.held(case, found));
        let plain = Plain::of(&base, &parameters, found.unknowns);
        let plain = plain.ok_or(NoEquilibrium::Singular)?;
        Ok(Solved::of(self.car, &base, &parameters, &plain, |c: f64| c))
    }

    /// Results with their derivatives by everything.
    pub fn gradients(
        &mut self,
        case: &Case,
        found: &Equilibrium,
        quantities: &[CarQuantity],
    ) -> Result<Vec<CarGradient>, NoEquilibrium> {
        let readings = self.readings(found)?;
        let parameters = Parameters::of(self.car, case);
        let held = self.held(case, found);
        let base = readings.base(held);
        let plain = Plain::of(&base, &parameters, found.unknowns);
        let plain = plain.ok_or(NoEquilibrium::Singular)?;
        let linearised = |axle: usize| {
            let linearised = self.axles[axle].linearised(&found.placed[axle]);
            linearised.map_err(|failure| NoEquilibrium::NoPose { axle, failure })
        };
        let linearised = [linearised(0)?, linearised(1)?];
        let tape = Tape::default();
        let tracked = parameters.map(|value| tape.input(value));
        let placed = linearised.each_ref().map(|axle| axle.on_tape(&tape));
        let first = placed
            .each_ref()
            .map(|axle| axle.each_ref().map(|(_, first)| *first));
        let wheels = placed.map(|axle| axle.map(|(wheel, _)| wheel));
        let ([a, b], [c, d]) = (&wheels[0], &wheels[1]);
        let base = Base {
            held,
            readings: [a, b, c, d],
            travels: base.travels,
        };
        let same = std::convert::identity::<Tracked<'_>>;
        let x = settle(&base, &tracked, &plain, same);
        let now: Balance<Tracked<'_>> = base.balance(&tracked, x, same);
        let is_along = quantities.iter().any(|quantity| quantity.info().is_rate);
        let solved = is_along.then(|| Solved::of(self.car, &base, &tracked, &plain, same));
        let mut adjoints = Vec::new();
        let mut buffers = linearised.each_ref().map(|axle| axle.buffer());
        let gradient = |quantity: &CarQuantity| {
            let value = match &solved {
                Some(solved) if quantity.info().is_rate => quantity.evaluate(solved),
                _ => quantity.evaluate_state(&now),
            };
            tape.gradient(value, &mut adjoints);
            let mut parameters = [0.0; Parameter::COUNT];
            if adjoints.len() >= Parameter::COUNT {
                parameters.copy_from_slice(&adjoints[..Parameter::COUNT]);
            }
            let none = |axle: usize| {
                let points = self.car.axles[axle].left.mechanism.points.len();
                vec![Vector3::default(); points]
            };
            let mut wheels = [0, 0, 1, 1].map(none);
            for axle in [0, 1] {
                let inputs = linearised[axle].inputs();
                for side in Side::ALL {
                    let from = first[axle][side as usize];
                    // A shorter list means that the value does not depend on the rest.
                    let to = (from + inputs).min(adjoints.len());
                    if from >= to {
                        continue;
                    }
                    let mut by = vec![0.0; inputs];
                    by[..to - from].copy_from_slice(&adjoints[from..to]);
                    let into = &mut wheels[2 * axle + side as usize];
                    linearised[axle].add_gradient(side, &by, &mut buffers[axle], into);
                }
            }
            let hardpoints = [0, 1].map(|axle| {
                let [left, right] = [&wheels[2 * axle], &wheels[2 * axle + 1]];
                let both = left.iter().zip(right);
                both.map(|(left, right)| *left + *right).collect()
            });
            CarGradient {
                value: value.value(),
                hardpoints,
                wheels,
                parameters,
            }
        };
        Ok(quantities.iter().map(gradient).collect())
    }
}
