//! A study's curves, of one wheel or of both, and what is made of them: files, tables, words and the record of a run.

use crate::axle::{AxleCurves, AxlePlan, axle_curves};
use crate::curves::{Curves, curves};
use crate::plan::Plan;
use crate::report::{
    AxleSummary, FailureRange, Record, SolveSummary, Summary, axle_curves_csv, axle_failures,
    axle_remarks, axle_sensitivities_csv, both_wheels_plausibility, curves_csv, plausibility,
    rack_doubt, remarks, sensitivities_csv,
};
use crate::study::{AxleStudy, Study};

/// The curves of a study. What fails here is a wheel that cannot be solved in its design position: in words.
pub struct Solved<'s> {
    study: &'s Study,
    found: Found<'s>,
}

enum Found<'s> {
    Wheel(Plan, Curves),
    Axle(&'s AxleStudy, AxlePlan, AxleCurves),
}

/// Name of some curves, the file that holds them, and the curves.
pub type Labelled<'a> = (&'a str, &'a str, &'a Solved<'a>);

impl<'s> Solved<'s> {
    /// Solves the curves of a study.
    pub fn of(study: &'s Study) -> Result<Self, String> {
        match &study.axle {
            None => Solved::of_wheel(study, Plan::of(study)),
            Some(both) => Solved::of_axle(study, both, both.plan.clone()),
        }
    }

    /// Solves the curves of a study, with the quantities of its targets.
    pub fn with_targets(study: &'s Study) -> Result<Self, String> {
        let targets = study.optimise.as_ref().map(|o| &o.targets[..]);
        match &study.axle {
            None => Solved::of_wheel(study, Plan::with_targets(study)),
            Some(both) => Solved::of_axle(study, both, both.plan_with(targets.unwrap_or(&[]))),
        }
    }

    fn of_wheel(study: &'s Study, plan: Plan) -> Result<Self, String> {
        let wheel = &study.suspension;
        let curves = curves(wheel, &plan).map_err(|f| f.describe(&wheel.mechanism))?;
        let found = Found::Wheel(plan, curves);
        Ok(Solved { study, found })
    }

    fn of_axle(study: &'s Study, both: &'s AxleStudy, plan: AxlePlan) -> Result<Self, String> {
        let curves = axle_curves(&both.axle, &plan).map_err(|f| both.axle.describe_fault(f))?;
        let found = Found::Axle(both, plan, curves);
        Ok(Solved { study, found })
    }

    /// The same with other values by column and station, in the units of the kernel; of an axle where there were some.
    pub fn with_values(&self, value: impl Fn(usize, usize) -> f64) -> Self {
        let found = match &self.found {
            Found::Wheel(plan, drawn) => {
                let mut curves = drawn.clone();
                for (number, station) in curves.stations.iter_mut().enumerate() {
                    for (k, own) in station.values.iter_mut().enumerate() {
                        let found = value(k, number) * drawn.columns[k].factor();
                        *own = found.is_finite().then_some(found);
                    }
                }
                Found::Wheel(plan.clone(), curves)
            }
            Found::Axle(both, plan, drawn) => {
                let mut curves = drawn.clone();
                for (number, station) in curves.stations.iter_mut().enumerate() {
                    for (k, own) in station.values.iter_mut().enumerate() {
                        *own = own.map(|_| value(k, number) * drawn.columns[k].factor);
                    }
                }
                Found::Axle(both, plan.clone(), curves)
            }
        };
        let study = self.study;
        Solved { study, found }
    }

    /// The curves, of one wheel.
    pub fn wheel(&self) -> Option<&Curves> {
        match &self.found {
            Found::Wheel(_, curves) => Some(curves),
            Found::Axle(..) => None,
        }
    }

    /// `curves.csv`.
    pub fn csv(&self) -> Vec<u8> {
        match &self.found {
            Found::Wheel(plan, curves) => {
                curves_csv(curves, plan, self.study.suspension.length_unit)
            }
            Found::Axle(both, plan, curves) => axle_curves_csv(&both.axle, plan, curves),
        }
    }

    /// `sensitivities.csv`, where the study asks for it.
    pub fn sensitivities_csv(&self) -> Option<Vec<u8>> {
        let wheel = &self.study.suspension;
        let (asked, csv): (_, Box<dyn Fn() -> Vec<u8>>) = match &self.found {
            Found::Wheel(plan, curves) => (
                &plan.sensitivities,
                Box::new(|| sensitivities_csv(curves, plan, &wheel.mechanism, wheel.length_unit)),
            ),
            Found::Axle(both, plan, curves) => (
                &plan.sensitivities,
                Box::new(|| axle_sensitivities_csv(&both.axle, plan, curves)),
            ),
        };
        (!asked.is_empty()).then(csv)
    }

    /// Whether everything asked for was found.
    pub fn is_complete(&self) -> bool {
        match &self.found {
            Found::Wheel(_, curves) => curves.are_complete(),
            Found::Axle(_, _, curves) => curves.are_complete(),
        }
    }

    /// Doubts about the design, one line each.
    pub fn plausibility(&self) -> Result<Vec<String>, String> {
        let wheel = &self.study.suspension;
        let mut found = match &self.found {
            Found::Wheel(..) => plausibility(wheel).map_err(|f| f.describe(&wheel.mechanism))?,
            Found::Axle(both, plan, curves) => both_wheels_plausibility(&both.axle, plan, curves)
                .map_err(|f| both.axle.describe_fault(f))?,
        };
        found.extend(rack_doubt(self.study));
        Ok(found)
    }

    /// Remarks on the curves, one line each: their accuracy, and values that do not exist.
    pub fn remarks(&self) -> Vec<String> {
        match &self.found {
            Found::Wheel(_, curves) => remarks(self.study, curves),
            Found::Axle(both, plan, curves) => axle_remarks(&both.axle, plan, curves),
        }
    }

    /// Stations without a position.
    pub fn failures(&self) -> Vec<FailureRange> {
        match &self.found {
            Found::Wheel(plan, curves) => {
                FailureRange::all(curves, plan.drive, &self.study.suspension)
            }
            Found::Axle(both, plan, curves) => axle_failures(&both.axle, plan, curves),
        }
    }

    /// `summary.json` of a solve.
    pub fn summary(&self) -> Result<Summary, String> {
        Ok(match &self.found {
            Found::Wheel(_, curves) => {
                Summary::Solve(Box::new(SolveSummary::of(self.study, curves)))
            }
            Found::Axle(both, plan, curves) => {
                let design = axle_curves(&both.axle, &plan.at_design());
                let design = design.map_err(|f| both.axle.describe_fault(f))?;
                let summary = AxleSummary::of(&self.study.name, &both.axle, plan, curves, &design);
                Summary::Axle(summary)
            }
        })
    }

    /// The record of a run of these, all of one wheel or all of both; what matters most is the last.
    pub fn record(command: &str, designs: &[Labelled<'_>]) -> Result<Record, String> {
        let (.., last) = designs.last().expect("a run is of a design at least");
        let study = designs[0].2.study;
        match &last.found {
            Found::Wheel(plan, _) => {
                let wheels = designs.iter().filter_map(|(label, file, solved)| {
                    Some((*label, *file, &solved.study.suspension, solved.wheel()?))
                });
                let record = Record::of(command, study, plan, &wheels.collect::<Vec<_>>());
                record.map_err(|f| f.describe(&study.suspension.mechanism))
            }
            Found::Axle(both, plan, _) => {
                let axles = designs.iter().filter_map(|(label, file, solved)| {
                    let Found::Axle(both, _, curves) = &solved.found else {
                        return None;
                    };
                    Some((*label, *file, &both.axle, curves))
                });
                let record = Record::of_axle(command, study, plan, &axles.collect::<Vec<_>>());
                record.map_err(|f| both.axle.describe_fault(f))
            }
        }
    }
}
