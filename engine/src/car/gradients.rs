//! Derivatives of results with respect to hardpoints and parameters, equation (10) of [`super`].

use super::equations::Balance;
use super::parameters::{AxleParameter, BodyParameter, Parameter, Parameters};
use super::rates::{Plain, Solved, settle};
use super::solver::{Base, CarSolver, Equilibrium, Wheels};
use super::{Car, CarQuantity, Case, NoEquilibrium, WholeResult};
use crate::axle::Axle;
use crate::model::Side;
use crate::number::{Each, Scalar, Tape, Tracked, Vector3};

/// A result with its derivatives.
#[derive(Clone, Debug)]
pub struct CarGradient {
    /// Value of the result, in radians, newtons and length units.
    pub value: f64,
    /// Derivatives with respect to the hardpoints of each axle's left wheel, in the kernel's frame. The right wheel's
    /// hardpoints move as mirror images.
    pub hardpoints: [Vec<Vector3<f64>>; 2],
    /// Derivatives with respect to the hardpoints of each wheel alone, in the kernel's frame of its side. Order of the
    /// wheels: front left, front right, rear left, rear right. For a solid axle or twist beam, each wheel has the
    /// derivatives for all points of the axle, in the frame of the wheel's side.
    pub wheels: [Vec<Vector3<f64>>; 4],
    /// Derivatives with respect to all parameters.
    pub parameters: [f64; Parameter::COUNT],
}

impl CarGradient {
    /// Sets the value and all derivatives to NaN.
    fn remove(&mut self) {
        self.value = f64::NAN;
        self.parameters = [f64::NAN; Parameter::COUNT];
        for by in self.hardpoints.iter_mut().chain(&mut self.wheels).flatten() {
            *by = Vector3::new(f64::NAN, f64::NAN, f64::NAN);
        }
    }
}

impl<'a> CarSolver<'a> {
    /// Computes a state with its derivatives with respect to accelerations, a couple on the body, body motions, and
    /// warp of the ground.
    pub fn solved(
        &mut self,
        case: &Case,
        found: &Equilibrium,
    ) -> Result<Solved<'a, f64>, NoEquilibrium> {
        self.solved_for(case, found, [CarQuantity::Whole(WholeResult::JackingHeave)])
    }

    /// Computes the same as [`CarSolver::solved`], but solves the car at rest only if one of the results `quantities` is
    /// measured from the car at rest.
    pub fn solved_for(
        &mut self,
        case: &Case,
        found: &Equilibrium,
        quantities: impl IntoIterator<Item = CarQuantity>,
    ) -> Result<Solved<'a, f64>, NoEquilibrium> {
        let wheels = self.wheels_of(found)?;
        let parameters = Parameters::of(self.car, case);
        let (car, held, x) = (self.car, self.held(case, found), found.unknowns);
        let solved = match &wheels {
            Wheels::Near(near) => Solved::at(car, &near.base(held), &parameters, x),
            Wheels::Exact(exact) => Solved::at(car, &exact.base(held), &parameters, x),
        };
        let mut solved = solved.ok_or(NoEquilibrium::Singular)?;
        if quantities.into_iter().any(CarQuantity::is_since_rest) {
            solved.rest_heave = self.heave_at_rest(case).unwrap_or(f64::NAN);
        }
        Ok(solved)
    }

    /// Computes the heave (lowering of the body from the design position) of the car at rest, with
    /// the tyres of a case.
    fn heave_at_rest(&mut self, case: &Case) -> Result<f64, NoEquilibrium> {
        let (rest, found) = self.at_rest(case)?;
        let state = self.balance(&rest, &found)?;
        Ok(CarQuantity::Whole(WholeResult::Heave).evaluate_state(&state))
    }

    /// Solves the car at rest with the tyres of a case (rigid or elastic).
    fn at_rest(&mut self, case: &Case) -> Result<(Case, Equilibrium), NoEquilibrium> {
        let rest = self.rest_of(case, "static");
        let found = self.solve(&rest)?;
        Ok((rest, found))
    }

    /// Computes the heave of the car at rest with its derivatives.
    fn gradient_at_rest(&mut self, case: &Case) -> Result<CarGradient, NoEquilibrium> {
        let heave = [CarQuantity::Whole(WholeResult::Heave)];
        let (rest, found) = self.at_rest(case)?;
        Ok(self.gradients(&rest, &found, &heave)?.swap_remove(0))
    }

    /// Adds the heave of the car at rest to results that are measured from the car at rest. Also adds the derivatives
    /// of this heave with respect to the design. This heave does not depend on the accelerations, speed, warp or racks
    /// of the case. If the car at rest has no equilibrium, these results become NaN.
    fn add_rest(&mut self, case: &Case, quantities: &[CarQuantity], gradients: &mut [CarGradient]) {
        if !quantities.iter().any(|quantity| quantity.is_since_rest()) {
            return;
        }
        let at_rest = self.gradient_at_rest(case);
        let of_case = |place: usize| {
            use AxleParameter::Rack;
            use BodyParameter::{Ax, Ay, Az, Speed, Warp};
            let of_body = [Ax, Ay, Az, Speed, Warp].each(|own| Parameter::Body(own).place());
            let racks = [0, 1].each(|axle| Parameter::Axle(axle, Rack).place());
            of_body.contains(&place) || racks.contains(&place)
        };
        for (quantity, gradient) in quantities.iter().zip(gradients) {
            if !quantity.is_since_rest() {
                continue;
            }
            let Ok(at_rest) = &at_rest else {
                gradient.remove();
                continue;
            };
            gradient.value += at_rest.value;
            for (place, sum) in gradient.parameters.iter_mut().enumerate() {
                if !of_case(place) {
                    *sum += at_rest.parameters[place];
                }
            }
            let points = gradient.hardpoints.iter_mut().chain(&mut gradient.wheels);
            let of_rest = at_rest.hardpoints.iter().chain(&at_rest.wheels);
            for (into, by) in points.zip(of_rest) {
                for (sum, by) in into.iter_mut().zip(by) {
                    *sum = *sum + *by;
                }
            }
        }
    }

    /// Computes results with their derivatives with respect to all hardpoints and parameters. Results that are measured from
    /// the car at rest have the value NaN if the car at rest has no equilibrium.
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
            let linearised = self.axles[axle].linearised(&readings.placed[axle]);
            linearised.map_err(|failure| NoEquilibrium::NoPose { axle, failure })
        };
        let linearised = [linearised(0)?, linearised(1)?];
        let tape = Tape::new();
        let tracked = parameters.map(|value| tape.input(value));
        let placed = linearised.each_ref().each(|axle| axle.on_tape(&tape));
        let first = placed
            .each_ref()
            .each(|axle| axle.each_ref().each(|(_, first)| *first));
        let wheels = placed.each(|axle| axle.each(|(wheel, _)| wheel));
        let ([a, b], [c, d]) = (&wheels[0], &wheels[1]);
        let base = Base {
            held,
            readings: [a, b, c, d],
            travels: base.travels,
            racks: base.racks,
            carriers: base.carriers,
        };
        let same = std::convert::identity::<Tracked<'_>>;
        let x = settle(&base, &tracked, &plain, same, 1);
        let now: Balance<Tracked<'_>> = base.balance(&tracked, x, same);
        let is_along = quantities
            .iter()
            .any(|quantity| quantity.info().is_rate && !quantity.is_since_rest());
        let solved = is_along.then(|| Solved::of(self.car, &base, &tracked, &plain, same, 1));
        let heave = CarQuantity::Whole(WholeResult::Heave);
        let mut buffers = linearised.each_ref().map(|axle| axle.buffer());
        let value = |quantity: &CarQuantity| match &solved {
            // The call of `add_rest` below adds the heave of the car at rest.
            _ if quantity.is_since_rest() => -heave.evaluate_state(&now),
            Some(solved) if quantity.info().is_rate => quantity.evaluate(solved),
            _ => quantity.evaluate_state(&now),
        };
        let values: Vec<_> = quantities.iter().map(value).collect();
        let inputs = linearised.each_ref().each(|axle| axle.inputs());
        let mut gradients = Vec::with_capacity(quantities.len());
        tape.gradients(&values, first[1][1] + inputs[1], |number, by_numbers| {
            let mut wheels = [0, 0, 1, 1].map(|axle| no_gradients(&self.car.axles[axle]));
            for axle in [0, 1] {
                for side in Side::ALL {
                    let by = &by_numbers[first[axle][side as usize]..][..inputs[axle]];
                    let into = &mut wheels[2 * axle + side as usize];
                    linearised[axle].add_gradient(side, by, &mut buffers[axle], into);
                }
            }
            gradients.push(CarGradient {
                value: values[number].value(),
                hardpoints: of_both_sides(self.car, &wheels),
                parameters: self.of_parameters(by_numbers, &wheels),
                wheels,
            });
        });
        self.add_rest(case, quantities, &mut gradients);
        Ok(gradients)
    }

    /// Returns the derivatives of a result with respect to the parameters. In `by_numbers`, these derivatives come first.
    /// With a steering gear, the derivative with respect to the rack is computed from the derivatives with respect to the
    /// points of the axle. Derivatives with respect to the racks are NaN if they are not known.
    fn of_parameters(
        &self,
        by_numbers: &[f64],
        wheels: &[Vec<Vector3<f64>>; 4],
    ) -> [f64; Parameter::COUNT] {
        let mut parameters = [0.0; Parameter::COUNT];
        parameters.copy_from_slice(&by_numbers[..Parameter::COUNT]);
        for axle in [0, 1] {
            let by_gear =
                self.car.axles[axle].by_steering_gear([&wheels[2 * axle], &wheels[2 * axle + 1]]);
            let by_rack = &mut parameters[Parameter::Axle(axle, AxleParameter::Rack).place()];
            match by_gear {
                Some(by_gear) => *by_rack = by_gear,
                None if !self.by_rack => *by_rack = f64::NAN,
                None => {}
            }
        }
        parameters
    }
}

/// Returns zero vectors as the derivatives with respect to the hardpoints of a wheel.
fn no_gradients(axle: &Axle) -> Vec<Vector3<f64>> {
    vec![Vector3::default(); axle.left.mechanism.points.len()]
}

/// Returns the derivatives of a result with respect to the hardpoints of each left wheel. The right wheel's hardpoints
/// move as mirror images.
fn of_both_sides(car: &Car, wheels: &[Vec<Vector3<f64>>; 4]) -> [Vec<Vector3<f64>>; 2] {
    [0, 1].map(|axle| {
        let (mut left, mut right) = (wheels[2 * axle].clone(), wheels[2 * axle + 1].clone());
        if let Some(rigid) = &car.axles[axle].left.mechanism.rigid_axle {
            rigid.gather([&mut left, &mut right]);
        }
        let both = left.into_iter().zip(right);
        both.map(|(left, right)| left + right).collect()
    })
}
