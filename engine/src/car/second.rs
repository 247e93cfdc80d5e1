//! Second derivatives of a state along directions of the design and of the parameters.
//!
//! Along a direction, parameters, wheels and unknowns are Taylor series in a number e. Let G(x, e) be the residuals of
//! the equations, and G_x their derivatives with respect to the unknowns x in the state without changes. Each step x -
//! G_x^-1 G(x(e), e) makes one more order of the unknowns exact. The formulas of the results then use these series.
//!
//! Some results contain derivatives with respect to accelerations, couples and motions of the body. These results need
//! one more derivative of the wheels with respect to travel. Only independent wheels have this derivative.

use super::equations::Held;
use super::parameters::Parameters;
use super::rates::{Plain, Solved, settle};
use super::solver::{Base, CarSolver, Equilibrium};
use super::{Car, CarQuantity, Case, NoEquilibrium, WholeResult};
use crate::axle::{Axle, Carriers, Expandable, ExpandedWheel, Series};
use crate::number::{Each, Real, Vector3};

/// Number of derivative orders that [`Series`] contains.
const ORDERS: usize = 2;

/// A state in which wheels and parameters may be Taylor series along a direction.
pub(crate) struct ExpandedState<'a> {
    car: &'a Car,
    case: &'a Case,
    found: Equilibrium,
    parameters: Parameters<f64>,
    plain: Plain,
    wheels: Vec<Expandable<'a>>,
    /// Wheels of the design without changes.
    still: Vec<ExpandedWheel>,
    travels: [f64; 4],
    carriers: [Carriers; 2],
}

impl<'a> CarSolver<'a> {
    /// Prepares a state for Taylor series along directions.
    pub(crate) fn expanded(
        &mut self,
        case: &'a Case,
        found: Equilibrium,
    ) -> Result<ExpandedState<'a>, NoEquilibrium> {
        let readings = self.readings(&found)?;
        let parameters = Parameters::of(self.car, case);
        let base = readings.base(self.held(case, &found));
        let plain = Plain::of(&base, &parameters, found.unknowns);
        let plain = plain.ok_or(NoEquilibrium::Singular)?;
        let (travels, carriers) = (base.travels, base.carriers);
        let mut wheels = Vec::with_capacity(4);
        for (solver, placed) in self.axles.iter().zip(&readings.placed) {
            wheels.extend(solver.expandable(placed).ok_or(NoEquilibrium::Singular)?);
        }
        Ok(ExpandedState {
            still: wheels.iter().map(Expandable::still).collect(),
            car: self.car,
            case,
            found,
            parameters,
            plain,
            wheels,
            travels,
            carriers,
        })
    }
}

impl ExpandedState<'_> {
    /// Returns a wheel whose design is a Taylor series. `number` is 0 to 3: front left, front right, rear left, rear
    /// right.
    pub(crate) fn wheel(&self, number: usize, design: &[Vector3<Series>]) -> ExpandedWheel {
        self.wheels[number].along(design)
    }

    /// Returns true if second derivatives of this result can be computed.
    pub(crate) fn knows(&self, quantity: CarQuantity) -> bool {
        let is_rigid = self.car.axles.iter().any(Axle::is_rigid);
        !(quantity.info().is_rate && !quantity.is_since_rest() && is_rigid)
    }

    /// Returns the parameters as constant Taylor series.
    pub(crate) fn parameters(&self) -> Parameters<Series> {
        self.parameters.map(Series::constant)
    }

    /// Returns second derivatives of results; NaN if they cannot be computed. `moved` contains the wheels whose design is
    /// a Taylor series. The other wheels have the unchanged design. For results that are measured from the car at rest,
    /// these derivatives do not include the motion of the car at rest.
    pub(crate) fn second_derivatives(
        &self,
        moved: [Option<&ExpandedWheel>; 4],
        parameters: &Parameters<Series>,
        quantities: impl Iterator<Item = CarQuantity> + Clone,
    ) -> Vec<f64> {
        let wheel = |number: usize| moved[number].unwrap_or(&self.still[number]);
        let base = Base {
            held: Held {
                car: self.car,
                case: self.case,
                lifted: self.found.lifted,
            },
            readings: [0, 1, 2, 3].each(wheel),
            travels: self.travels,
            racks: None,
            carriers: self.carriers,
        };
        let same = std::convert::identity::<Series>;
        let by_rate = |of: &CarQuantity| of.info().is_rate && !of.is_since_rest();
        let heave = CarQuantity::Whole(WholeResult::Heave);
        let x = settle(&base, parameters, &self.plain, same, ORDERS);
        let now = base.balance(parameters, x, same);
        let mut known = quantities.clone().filter(|of| self.knows(*of));
        let solved = known
            .any(|of| by_rate(&of))
            .then(|| Solved::of(self.car, &base, parameters, &self.plain, same, ORDERS));
        let value = |of: CarQuantity| match &solved {
            _ if !self.knows(of) => now.unknowns[0].constant(f64::NAN),
            _ if of.is_since_rest() => -heave.evaluate_state(&now),
            Some(solved) if by_rate(&of) => of.evaluate(solved),
            _ => of.evaluate_state(&now),
        };
        quantities.map(|of| value(of).derivative(ORDERS)).collect()
    }
}
