//! Results of load cases for several designs of a car, one design after another.

use super::{Car, CarGradient, CarQuantity, CarSolver, Case, NoEquilibrium};
use crate::mechanism::DesignFault;
use crate::model::Side;
use crate::sorting::sort_by_key;

/// A result of a load case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CaseResult {
    /// Index of the case.
    pub case: usize,
    /// The result, for example the roll angle or a wheel load.
    pub quantity: CarQuantity,
}

/// Results of load cases that are requested for each design, ordered by case.
#[derive(Clone, Debug)]
pub struct CarRequest<'c> {
    /// Load cases.
    pub cases: &'c [Case],
    /// Requested results, ordered by case.
    pub results: Vec<CaseResult>,
}

/// Number of load cases without an equilibrium for one design, and the first such case.
#[derive(Clone, Debug, PartialEq)]
pub struct FailedCases {
    /// Number of cases that failed.
    pub count: usize,
    /// Index of the first failed case.
    pub first: usize,
    /// Reason of the first failed case.
    pub why: NoEquilibrium,
}

/// Fault of a design that cannot be solved at all: index of the axle, side of the wheel, reason.
pub type CarFault = (usize, Side, DesignFault);

impl<'c> CarRequest<'c> {
    /// For every case, requests all results that are defined in this case. Also requests the `further` results.
    pub fn of(
        cases: &'c [Case],
        quantities: &[CarQuantity],
        further: impl IntoIterator<Item = CaseResult>,
    ) -> Self {
        let mut results = Vec::new();
        for (case, own) in cases.iter().enumerate() {
            let defined = quantities.iter().filter(|q| q.undefined_in(own).is_none());
            results.extend(defined.map(|quantity| CaseResult {
                case,
                quantity: *quantity,
            }));
        }
        for result in further {
            if !results.contains(&result) {
                results.push(result);
            }
        }
        // The sort is stable: within a case the order of the study remains.
        sort_by_key(&mut results, |result| result.case);
        CarRequest { cases, results }
    }

    /// Returns the index of a result among the requested results; `None` if it is not requested.
    pub fn place(&self, case: usize, quantity: CarQuantity) -> Option<usize> {
        let wanted = CaseResult { case, quantity };
        self.results.iter().position(|result| *result == wanted)
    }

    /// Name of the column of a result, with its case and its unit: `turn_roll_deg`.
    pub fn column(&self, result: &CaseResult, car: &Car) -> String {
        let case = &self.cases[result.case].name;
        format!("{case}_{}", result.quantity.column(car.length_unit))
    }

    /// Returns the index of a case's first result, and all results of the case.
    fn of_case(&self, case: usize) -> (usize, &[CaseResult]) {
        let from = self.results.partition_point(|result| result.case < case);
        let to = self.results.partition_point(|result| result.case <= case);
        (from, &self.results[from..to])
    }

    /// Writes the results of a design to `into`, in printed units. Missing results are NaN. The solver starts every
    /// case from the design position, so its results do not depend on other cases.
    ///
    /// # Errors
    /// Returns the reason if the design position cannot be solved.
    pub fn values(&self, car: &Car, into: &mut [f64]) -> Result<Option<FailedCases>, CarFault> {
        into.fill(f64::NAN);
        let mut solver = CarSolver::new(car)?;
        let mut failed: Option<FailedCases> = None;
        for (number, case) in self.cases.iter().enumerate() {
            let (from, results) = self.of_case(number);
            if results.is_empty() {
                continue;
            }
            let found = solver.solve(case);
            let quantities = results.iter().map(|of| of.quantity);
            match found.and_then(|found| solver.solved_for(case, &found, quantities)) {
                Ok(solved) => {
                    for (value, result) in into[from..].iter_mut().zip(results) {
                        let printed = result.quantity.printed(&solved, case);
                        // Adding 0 converts a negative zero to 0.
                        *value = printed.map_or(f64::NAN, |value| value + 0.0);
                    }
                }
                Err(why) => match &mut failed {
                    Some(failed) => failed.count += 1,
                    None => {
                        failed = Some(FailedCases {
                            count: 1,
                            first: number,
                            why,
                        });
                    }
                },
            }
        }
        Ok(failed)
    }

    /// Returns every result with its derivatives, in radians, newtons and length units. `None` if the result's case has
    /// no equilibrium, if the derivatives of its state do not exist, or if the result is measured from a car at rest that has
    /// no equilibrium.
    ///
    /// # Errors
    /// Returns the reason if the design position cannot be solved.
    pub fn gradients(&self, car: &Car) -> Result<Vec<Option<CarGradient>>, CarFault> {
        let mut solver = CarSolver::new(car)?;
        let mut all = Vec::with_capacity(self.results.len());
        for (number, case) in self.cases.iter().enumerate() {
            let (_, results) = self.of_case(number);
            if results.is_empty() {
                continue;
            }
            let quantities: Vec<CarQuantity> = results.iter().map(|of| of.quantity).collect();
            let found = solver.solve(case);
            let gradients = found.and_then(|found| solver.gradients(case, &found, &quantities));
            match gradients {
                Ok(gradients) => {
                    let known = quantities.iter().zip(gradients).map(|(of, gradient)| {
                        let lacks_rest = of.is_since_rest() && gradient.value.is_nan();
                        (!lacks_rest).then_some(gradient)
                    });
                    all.extend(known);
                }
                Err(_) => all.extend(quantities.iter().map(|_| None)),
            }
        }
        Ok(all)
    }
}
