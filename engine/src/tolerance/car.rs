//! Scatter of a car's results in every load case. The deviations of three kinds of inputs scatter: parts of both axles, rates
//! (stiffnesses), and values of the car such as its mass.
//!
//! The parts of each axle are assembled as in a study of the axle ([`crate::assembly`]). The car with these parts is in
//! equilibrium on its springs. First-order results are exact and follow from the chain rule. One factor is the derivatives
//! of every result with respect to the hardpoints. The other factor is the derivatives of the built designs with respect
//! to each tolerance source. Rates and values of the car add further terms. Module `car_second` computes the second order.

use super::axle_expansion::{Moves as PointMoves, moves};
use super::draw::middle;
use super::histogram::Histogram;
use super::monte_carlo::moments;
use super::{Estimate, PERCENTILES, Problem, Spread, car_second, with_rounding};
use crate::assembly::SetUpError;
use crate::car::{Car, CarFault, CarRequest, Case, CaseResult};
use crate::evaluate::along;
use crate::model::Side;
use crate::sorting::sort_numbers;
use crate::study::{CarContributor, CarStudy, CarTolerance, Source};
use crate::sweep::{in_order, uniform};
use std::ops::ControlFlow;

/// For each tolerance source of a contributor: its variance, and the derivatives of the points of both wheels with respect to it.
type Ways = Vec<(f64, [PointMoves; 2])>;

/// Number of builds in a block.
const BLOCK: u64 = 16;

/// Prepared tolerance analysis of a car.
pub struct CarProblem<'a> {
    /// The study.
    pub study: &'a CarStudy,
    /// Tolerances of the parts and values of the car, and the limits for its results.
    pub tolerance: &'a CarTolerance,
    /// Results of the load cases, case by case: first the study's results, then other results that bands limit.
    pub request: CarRequest<'a>,
    /// For each band (lower and upper limit of a result), the index of this result among all results.
    places: Vec<usize>,
    pub(super) axles: [Problem<'a>; 2],
}

/// Results of many builds of a car.
#[derive(Clone, Debug)]
pub struct CarBuilds {
    /// Number of finished builds, including the builds that failed.
    pub builds: u64,
    /// Spread of each result, in printed units.
    pub spreads: Vec<Spread>,
    /// Number of builds that cannot be assembled, or cannot be solved in every case.
    pub failed: u64,
    /// Number of the first build that failed, and the reason.
    pub first_failed: Option<(u64, String)>,
    /// For each band (lower and upper limit of a result), the number of builds within these limits.
    pub in_bands: Vec<u64>,
    /// Number of builds within the limits of every band.
    pub in_all_bands: u64,
}

/// Scatter of one result, to first and second order in the deviations of the tolerances, in printed units.
#[derive(Clone, Debug)]
pub struct CarExpansion {
    /// First-order variance of the result from each contributor (scattering part). NaN if the result has no derivatives.
    pub variances: Vec<f64>,
    /// Estimate from all contributors together.
    pub estimate: Estimate,
    /// True if the value scatters ([`Estimate::scatters`]).
    pub scatters: bool,
}

impl CarExpansion {
    /// First-order standard deviation of the result.
    pub fn sigma(&self) -> f64 {
        self.estimate.sigma()
    }

    /// Share of a contributor in the variance of the result.
    pub fn share(&self, contributor: usize) -> f64 {
        self.variances[contributor] / self.estimate.variance
    }

    /// Returns true if the linear result is valid ([`Estimate::holds`]). `None` if this is unknown, or if the value does not
    /// scatter.
    pub fn holds(&self, spread: &Spread) -> Option<bool> {
        self.estimate.holds(spread).filter(|_| self.scatters)
    }
}

impl<'a> CarProblem<'a> {
    /// Prepares the tolerances of a car.
    ///
    /// # Errors
    /// Returns the axle and the reason if the design of an axle cannot be assembled.
    pub fn of(
        study: &'a CarStudy,
        tolerance: &'a CarTolerance,
    ) -> Result<Self, (usize, SetUpError)> {
        let further = tolerance.bands.iter().map(|band| CaseResult {
            case: band.case,
            quantity: band.quantity,
        });
        let request = CarRequest::of(&study.cases, &study.kept_quantities(), further);
        let of_bands = tolerance.bands.iter();
        let places = of_bands.filter_map(|band| request.place(band.case, band.quantity));
        let places = places.collect();
        let axle = |number: usize| {
            let problem = Problem::of(&study.axles[number], &tolerance.axles[number]);
            problem.map_err(|why| (number, why))
        };
        Ok(CarProblem {
            study,
            tolerance,
            request,
            places,
            axles: [axle(0)?, axle(1)?],
        })
    }

    /// Indices of the bands that the nominal design misses, each with its nominal value. `nominal` has all nominal results.
    pub fn bands_missed(&self, nominal: &[f64]) -> Vec<(usize, f64)> {
        let bands = self.tolerance.bands.iter().zip(&self.places).enumerate();
        let missed = bands.filter_map(|(number, (band, place))| {
            let [low, high] = with_rounding(band.between);
            let value = nominal[*place];
            (!(low..=high).contains(&value)).then_some((number, value))
        });
        missed.collect()
    }

    /// Car of the build with this number. An error names the wheel that cannot be assembled, or the value that a study does
    /// not accept.
    pub fn built(&self, number: u64) -> Result<Car, String> {
        let mut car = self.study.car.clone();
        for (axle, problem) in self.axles.iter().enumerate() {
            if problem.tolerance.scatter.is_empty() {
                continue;
            }
            let wheels = problem.built_wheels(number).map_err(|(side, reject)| {
                let end = crate::car::AXLE_NAMES[axle];
                match side {
                    Some(side) => format!("{end} axle, {}", side.about(&reject)),
                    None => format!("{end} axle: {reject}"),
                }
            })?;
            let mut wheels = wheels.into_iter();
            if let Some(left) = wheels.next() {
                let own = &mut car.axles[axle];
                (own.left, own.right) = (left, wheels.next());
            }
        }
        let figures = self.tolerance.contributors.iter().enumerate();
        for (stream, contributor) in figures {
            let CarContributor::Figure { moves, law, .. } = contributor else {
                continue;
            };
            let fraction = middle(uniform(number, stream, self.tolerance.figure_seed));
            let deviation = law.quantile(fraction);
            let nominal = moves.value(&car).unwrap_or(0.0);
            moves.apply(nominal + deviation, &mut car);
        }
        match car.refusal() {
            Some(reason) => Err(reason),
            None => Ok(car),
        }
    }

    /// Nominal car, in the form that builds use. If parts of an axle scatter, both wheels of this axle have the points of the
    /// assembled suspension, including a point of the spin axis.
    fn drawn(&self) -> Car {
        let mut car = self.study.car.clone();
        for (axle, problem) in self.axles.iter().enumerate() {
            let mut wheels = problem.wheel_assemblers.iter();
            let mut next = || Some(wheels.next()?.assembler.suspension().clone());
            if let (false, Some(left)) = (problem.tolerance.scatter.is_empty(), next()) {
                let own = &mut car.axles[axle];
                (own.left, own.right) = (left, next());
            }
        }
        car
    }

    /// Nominal results, in printed units. NaN for missing results.
    ///
    /// # Errors
    /// Returns the reason if the design position cannot be solved.
    pub fn nominal(&self) -> Result<Vec<f64>, CarFault> {
        let mut values = vec![f64::NAN; self.request.results.len()];
        self.request.values(&self.study.car, &mut values)?;
        Ok(values)
    }

    /// Scatter of every result, to first and second order in the deviations of the tolerances.
    ///
    /// # Errors
    /// Returns the axle and the reason if the design of an axle cannot be assembled or solved.
    pub fn expansion(&self) -> Result<Vec<CarExpansion>, (usize, SetUpError)> {
        let drawn = self.drawn();
        let gradients = self.request.gradients(&drawn);
        let gradients = gradients.map_err(|(axle, _, fault)| (axle, SetUpError::Fault(fault)))?;
        let mut ways: [Vec<Ways>; 2] = Default::default();
        for (axle, problem) in self.axles.iter().enumerate() {
            for contributor in &problem.tolerance.scatter {
                let sources: Vec<&Source> = contributor.sources.iter().collect();
                let moves = moves(problem, &sources).map_err(|why| (axle, why))?;
                let variances = sources.iter().map(|source| source.law.variance());
                ways[axle].push(variances.zip(moves).collect());
            }
        }
        let length = self.study.car.length_unit;
        let rests = [false, true].map(|elastic| {
            let mut rest = Case::at_rest("static");
            rest.setting.elastic_tyres = elastic;
            rest
        });
        let second = car_second::second(self, &drawn, &rests)?;
        let results = self.request.results.iter().zip(&gradients).zip(second);
        let expansions = results.map(|((result, gradient), second)| {
            let printed = result.quantity.info().unit.printed_factor(length);
            let contributors = self.tolerance.contributors.iter();
            let variance = |contributor: &CarContributor| {
                let Some(gradient) = gradient else {
                    return f64::NAN;
                };
                let variance: f64 = match contributor {
                    CarContributor::Part { axle, number, .. } => {
                        let sources = ways[*axle][*number].iter();
                        let parts = sources.map(|(variance, moves)| {
                            let of_side = |side: Side| {
                                let by = &gradient.wheels[2 * axle + side as usize];
                                along(&moves[side as usize], by)
                            };
                            let slope = Side::ALL.map(of_side).iter().sum::<f64>();
                            variance * slope * slope
                        });
                        parts.sum()
                    }
                    CarContributor::Figure { moves, law, .. } => {
                        let slope = moves.slope(&drawn, gradient);
                        law.variance() * slope * slope
                    }
                };
                variance
            };
            let variances: Vec<f64> = contributors.map(variance).collect();
            let estimate = Estimate {
                variance: variances.iter().sum(),
                second,
            };
            CarExpansion {
                scatters: gradient
                    .as_ref()
                    .is_some_and(|gradient| estimate.scatters(gradient.value)),
                estimate: estimate.scaled(printed),
                variances: variances.iter().map(|v| printed * printed * v).collect(),
            }
        });
        Ok(expansions.collect())
    }

    /// Solves the builds on the CPU threads of the current rayon pool. `note` gets the number of finished builds, in order,
    /// and may stop the work early. Results do not depend on the number of CPU threads.
    pub fn monte_carlo(
        &self,
        nominal: &[f64],
        mut note: impl FnMut(u64) -> ControlFlow<()> + Send,
    ) -> CarBuilds {
        let results = self.request.results.len();
        let total = self.tolerance.builds;
        let bands = self.tolerance.bands.len();
        let mut all = CarBuilds {
            builds: 0,
            spreads: Vec::with_capacity(results),
            failed: 0,
            first_failed: None,
            in_bands: vec![0; bands],
            in_all_bands: 0,
        };
        let mut columns: Vec<Vec<f64>> = vec![Vec::new(); results];
        let work = |row: &mut Vec<f64>, block: u64| {
            let numbers = block * BLOCK..total.min((block + 1) * BLOCK);
            let builds = numbers.map(|number| {
                row.resize(results, f64::NAN);
                let failure = self.build(number, row);
                (row.clone(), failure)
            });
            Some(builds.collect::<Vec<_>>())
        };
        // An early stop is not an error.
        let _: Result<(), ()> = in_order(
            0..total.div_ceil(BLOCK),
            Vec::new,
            work,
            |builds: Vec<(Vec<f64>, Option<String>)>| {
                for (values, failure) in builds {
                    if let Some(reason) = failure {
                        all.failed += 1;
                        all.first_failed.get_or_insert((all.builds, reason));
                    }
                    for (column, value) in columns.iter_mut().zip(&values) {
                        if !value.is_nan() {
                            column.push(*value);
                        }
                    }
                    let mut is_in_all = true;
                    let bands = self.tolerance.bands.iter().zip(&self.places);
                    for ((band, place), count) in bands.zip(&mut all.in_bands) {
                        let [low, high] = with_rounding(band.between);
                        let is_in = (low..=high).contains(&values[*place]);
                        *count += u64::from(is_in);
                        is_in_all &= is_in;
                    }
                    all.in_all_bands += u64::from(is_in_all);
                    all.builds += 1;
                }
                match note(all.builds) {
                    ControlFlow::Continue(()) => Ok(()),
                    ControlFlow::Break(()) => Err(()),
                }
            },
        );
        for (column, nominal) in columns.into_iter().zip(nominal) {
            all.spreads.push(spread(column, *nominal));
        }
        all
    }

    /// Writes the results of a build. Returns the reason if the build cannot be assembled, or if a load case has no
    /// equilibrium.
    fn build(&self, number: u64, row: &mut [f64]) -> Option<String> {
        row.fill(f64::NAN);
        let car = match self.built(number) {
            Ok(car) => car,
            Err(reason) => return Some(reason),
        };
        match self.request.values(&car, row) {
            Ok(None) => None,
            Ok(Some(failed)) => {
                let case = &self.study.cases[failed.first].name;
                Some(format!("case {case}: {}", failed.why.describe(&car)))
            }
            Err(fault) => Some(car.describe_fault(&fault)),
        }
    }
}

/// Spread of values about a nominal value. Sums run in the order of the builds.
fn spread(mut values: Vec<f64>, nominal: f64) -> Spread {
    let about = if nominal.is_nan() {
        values.first().copied().unwrap_or(0.0)
    } else {
        nominal
    };
    let mut powers = [0.0; 5];
    for value in &values {
        let mut power = 1.0;
        for sum in &mut powers {
            *sum += power;
            power *= value - about;
        }
    }
    let [mean, sigma, sigma_error] = moments(powers);
    sort_numbers(&mut values);
    let at = |percent: f64| {
        let number = (percent / 100.0 * values.len() as f64).ceil().max(1.0) as usize;
        values.get(number - 1).copied().unwrap_or(f64::NAN)
    };
    let end = |value: Option<&f64>| value.copied().unwrap_or(f64::NAN);
    Spread {
        count: values.len() as u64,
        mean: about + mean,
        sigma,
        sigma_error,
        range: [end(values.first()), end(values.last())],
        percentiles: PERCENTILES.map(at),
        histogram: Histogram::of(values.iter().map(|value| (*value, 1))),
    }
}
