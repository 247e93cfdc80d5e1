//! Exact second-order result of the tolerance analysis of a car.
//!
//! The deviations move along a direction of the tolerance sources by a variable distance. The built designs of both axles,
//! the rates and the values of the car are Taylor series in this distance. The wheels, the unknowns of each state and the
//! results are then Taylor series, too ([`crate::car`], module `second`). If an axle is solid, results that are derivatives
//! of a state have no second-order result.

use super::Problem;
use super::car::CarProblem;
use super::expansion::of_pairs;
use crate::assembly::{Built, SetUpError};
use crate::axle::{ExpandedWheel, Series};
use crate::car::{
    Car, CarQuantity, CarSolver, Case, ExpandedState, NoEquilibrium, Parameter, Parameters,
    WholeResult,
};
use crate::number::{Each, Jet, Vector3};
use crate::study::{CarContributor, Law, Source};
use rayon::prelude::*;

/// Largest number of Taylor series of states. Their computation takes some seconds.
const MOST_SERIES: usize = 100_000;

/// A tolerance source of a car.
#[derive(Clone, Copy)]
enum Moved<'p> {
    /// Parts of an axle: index of the axle (0 front, 1 rear), and tolerance source of the parts.
    Parts(usize, &'p Source),
    /// Parameter of the car, with its change per standard deviation.
    Parameter(Parameter, f64),
}

/// Equilibrium state of a load case.
struct State<'p> {
    expanded: ExpandedState<'p>,
    /// For each tolerance source, the wheels that it moves.
    wheels: Vec<[Option<Box<ExpandedWheel>>; 4]>,
}

/// Designs of the four wheels as Taylor series. `None` for a wheel that does not move.
type Designs = [Option<Vec<Vector3<Series>>>; 4];

/// Computes second derivatives of a car's results along its tolerance sources, from the equilibrium states of its load cases.
struct Expander<'p> {
    problem: &'p CarProblem<'p>,
    /// Both wheels of each axle, built from nominal parts.
    built: [Vec<Built>; 2],
    sources: Vec<Moved<'p>>,
    /// State of each load case. `None` for a case without an equilibrium, or without requested results.
    states: Vec<Option<State<'p>>>,
    /// The car at rest on rigid and on elastic tyres, if results are measured from these states.
    rests: [Option<State<'p>>; 2],
}

/// Second-order terms of the mean and of the variance of each result, in program units. `drawn` is the nominal car, and
/// `rests` are cases of the car at rest on rigid and on elastic tyres.
pub(super) fn second(
    problem: &CarProblem<'_>,
    drawn: &Car,
    rests: &[Case; 2],
) -> Result<Vec<[f64; 2]>, (usize, SetUpError)> {
    let results = &problem.request.results;
    let (laws, sources) = sources(problem, drawn);
    let count = laws.len();
    let states = problem.request.cases.len();
    if (count * (count + 1) / 2).saturating_mul(states) > MOST_SERIES {
        return Ok(vec![[f64::NAN; 2]; results.len()]);
    }
    let mut built: [Vec<Built>; 2] = Default::default();
    for (axle, built) in built.iter_mut().enumerate() {
        for wheel in &problem.axles[axle].wheel_assemblers {
            let found = wheel.assembler.build_drawn();
            built.push(found.map_err(|why| (axle, SetUpError::from(why)))?);
        }
    }
    let mut expander = Expander {
        problem,
        built,
        sources,
        states: Vec::new(),
        rests: [None, None],
    };
    let singles: Vec<Designs> = (0..count)
        .map(|number| expander.designs(number, None))
        .collect();
    let solver = CarSolver::new(drawn);
    let mut solver = solver.map_err(|(axle, _, fault)| (axle, SetUpError::Fault(fault)))?;
    for (number, case) in problem.request.cases.iter().enumerate() {
        let is_wanted = results.iter().any(|result| result.case == number);
        let state = is_wanted.then(|| State::of(&mut solver, case, &singles));
        expander.states.push(state.and_then(Result::ok));
        let from_rest = |case: usize, quantity: CarQuantity| {
            case == number && quantity == CarQuantity::Whole(WholeResult::JackingHeave)
        };
        let place = usize::from(case.setting.elastic_tyres);
        let mut results = results.iter();
        if expander.rests[place].is_none() && results.any(|of| from_rest(of.case, of.quantity)) {
            expander.rests[place] = State::of(&mut solver, &rests[place], &singles).ok();
        }
    }
    let is_readable = |cell: usize| {
        let result = results[cell];
        let state = expander.states[result.case].as_ref();
        state.is_some_and(|state| state.expanded.knows(result.quantity))
    };
    let second_derivatives = |first, other| expander.second_derivatives(first, other);
    Ok(of_pairs(
        &laws,
        results.len(),
        is_readable,
        second_derivatives,
    ))
}

/// Distributions of all tolerance sources, and the items of the car that they change, contributor by contributor.
fn sources<'p>(problem: &'p CarProblem<'_>, drawn: &Car) -> (Vec<Law>, Vec<Moved<'p>>) {
    let (mut laws, mut sources) = (Vec::new(), Vec::new());
    for contributor in &problem.tolerance.contributors {
        match contributor {
            CarContributor::Part { axle, number, .. } => {
                let of_axle = &problem.tolerance.axles[*axle];
                for source in &of_axle.scatter[*number].sources {
                    laws.push(source.law);
                    sources.push(Moved::Parts(*axle, source));
                }
            }
            CarContributor::Figure { moves, law, .. } => {
                if let Some((parameter, rate)) = moves.direction(drawn) {
                    laws.push(*law);
                    sources.push(Moved::Parameter(parameter, rate * law.variance().sqrt()));
                }
            }
        }
    }
    (laws, sources)
}

impl<'p> State<'p> {
    /// Solves a load case, and computes its wheels along each tolerance source.
    fn of(
        solver: &mut CarSolver<'p>,
        case: &'p Case,
        singles: &[Designs],
    ) -> Result<Self, NoEquilibrium> {
        let found = solver.solve(case)?;
        let expanded = solver.expanded(case, found)?;
        let wheels = singles.par_iter().map(|designs| {
            [0, 1, 2, 3].map(|number: usize| {
                let design = designs[number].as_ref()?;
                Some(Box::new(expanded.wheel(number, design)))
            })
        });
        Ok(State {
            wheels: wheels.collect(),
            expanded,
        })
    }

    /// Second derivatives of results along one tolerance source, or along the sum of two sources. `designs` holds the designs of
    /// the wheels that both sources move.
    fn second_derivatives(
        &self,
        (first, other): (usize, Option<usize>),
        designs: &Designs,
        parameters: &dyn Fn(Parameters<Series>) -> Parameters<Series>,
        quantities: impl Iterator<Item = CarQuantity> + Clone,
    ) -> Vec<f64> {
        let both = [0, 1, 2, 3].map(|number: usize| {
            let design = designs[number].as_ref()?;
            Some(self.expanded.wheel(number, design))
        });
        let moved = [0, 1, 2, 3].each(|number: usize| {
            let own = |source: usize| self.wheels[source][number].as_deref();
            both[number]
                .as_ref()
                .or_else(|| own(first))
                .or_else(|| own(other?))
        });
        let parameters = parameters(self.expanded.parameters());
        self.expanded
            .second_derivatives(moved, &parameters, quantities)
    }
}

impl Expander<'_> {
    /// Designs of the wheels along a tolerance source, or along the sum of two sources that both move the wheel.
    fn designs(&self, first: usize, other: Option<usize>) -> Designs {
        [0, 1, 2, 3].map(|number: usize| {
            let problem: &Problem<'_> = &self.problem.axles[number / 2];
            let wheel = problem.wheel_assemblers.get(number % 2)?;
            let built = self.built[number / 2].get(number % 2)?;
            let mut moving = Vec::with_capacity(2);
            for source in [Some(first), other].into_iter().flatten() {
                match self.sources[source] {
                    Moved::Parts(axle, source)
                        if axle == number / 2 && !wheel.changes(source).is_empty() =>
                    {
                        moving.push(source);
                    }
                    _ => return None,
                }
            }
            Some(wheel.series(built, &moving))
        })
    }

    /// Second derivatives of all results along one tolerance source, or along the sum of two sources.
    fn second_derivatives(&self, first: usize, other: Option<usize>) -> Vec<f64> {
        let designs = match other {
            Some(_) => self.designs(first, other),
            None => Designs::default(),
        };
        let parameters = |mut parameters: Parameters<Series>| {
            for source in [Some(first), other].into_iter().flatten() {
                if let Moved::Parameter(parameter, rate) = self.sources[source] {
                    let moved = &mut parameters.0[parameter.place()];
                    *moved = *moved + Jet([0.0, rate, 0.0]);
                }
            }
            parameters
        };
        let along = (first, other);
        let results = &self.problem.request.results;
        let heave = CarQuantity::Whole(WholeResult::Heave);
        let rests = self.rests.each_ref().map(|rest| {
            let rest = rest.as_ref()?;
            let quantities = std::iter::once(heave);
            rest.second_derivatives(along, &designs, &parameters, quantities)
                .pop()
        });
        let mut values = Vec::with_capacity(results.len());
        for (case, state) in self.states.iter().enumerate() {
            let of_case = results.iter().filter(|result| result.case == case);
            let Some(state) = state else {
                values.extend(of_case.map(|_| f64::NAN));
                continue;
            };
            let quantities = of_case.map(|result| result.quantity);
            let of_states =
                state.second_derivatives(along, &designs, &parameters, quantities.clone());
            let setting = &self.problem.request.cases[case].setting;
            let rest = rests[usize::from(setting.elastic_tyres)].unwrap_or(f64::NAN);
            let since_rest = CarQuantity::Whole(WholeResult::JackingHeave);
            values.extend(quantities.zip(of_states).map(|(quantity, value)| {
                if quantity == since_rest {
                    value + rest
                } else {
                    value
                }
            }));
        }
        values
    }
}
