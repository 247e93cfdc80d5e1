//! Curves of a study, with their CSV files, tables and remarks, and the record of a run for its report page.

use crate::ask::NoValue;
use crate::axle::{AxleCurves, AxlePlan, AxlePose, axle_curves};
use crate::curves::{Curves, wheel_curves};
use crate::mechanism::NoPose;
use crate::plan::Plan;
use crate::report::{
    CurveTable, DrawnDesign, FailureRange, MotionRecord, Record, SolveSummary, SolvedAxle, Summary,
    both_wheels_plausibility, curves_csv, plausibility, rack_doubt, remarks, sensitivities_csv,
    spring_doubts,
};
use crate::study::{AxleStudy, Study, Vehicle, WheelStudy};

/// Curves of a study, with the plan by which they were computed.
pub struct Solved<'s> {
    study: &'s Study,
    pub(crate) curves: Curves,
    plan: Planned<'s>,
}

/// Plan by which the curves were computed.
enum Planned<'s> {
    Corner(Plan),
    /// Axle, plan of its curves, and pose of the axle at each station (or the reason why the axle has no pose).
    Axle(&'s AxleStudy, AxlePlan, Vec<Result<AxlePose, NoPose>>),
}

/// Label of a design, name of the file with its curves, and the curves.
pub type Labelled<'a> = (&'a str, &'a str, &'a Solved<'a>);

impl<'s> Solved<'s> {
    /// Solves the curves of the study's outputs. An error explains in words why a wheel cannot be solved in its design position.
    pub fn of(study: &'s Study) -> Result<Self, String> {
        match &study.vehicle {
            Vehicle::Wheel(own) => Solved::of_wheel(study, own, Plan::of(own)),
            Vehicle::Axle(both) => Solved::of_axle(study, both, both.plan.clone()),
        }
    }

    /// Solves the curves of the study's outputs and of the quantities of its targets. An error explains in words why a wheel cannot
    /// be solved in its design position.
    pub fn with_targets(study: &'s Study) -> Result<Self, String> {
        let targets = study.optimise.as_ref().map(|o| &o.targets[..]);
        match &study.vehicle {
            Vehicle::Wheel(own) => {
                Solved::of_wheel(study, own, Plan::with_targets(own, study.optimise.as_ref()))
            }
            Vehicle::Axle(both) => {
                Solved::of_axle(study, both, both.plan_with(targets.unwrap_or(&[])))
            }
        }
    }

    fn of_wheel(study: &'s Study, own: &WheelStudy, plan: Plan) -> Result<Self, String> {
        let curves = wheel_curves(own, &plan);
        let curves = curves.map_err(|f| f.describe(&own.suspension.mechanism))?;
        Ok(Solved {
            study,
            curves,
            plan: Planned::Corner(plan),
        })
    }

    fn of_axle(study: &'s Study, both: &'s AxleStudy, plan: AxlePlan) -> Result<Self, String> {
        let found = axle_curves(&both.axle, &plan).map_err(|f| both.axle.describe_fault(f))?;
        Ok(Solved {
            study,
            curves: found.curves,
            plan: Planned::Axle(both, plan, found.placed),
        })
    }

    /// Copy of these curves with other values. `value` returns the value of a column at a station, in internal units (radians for
    /// angles). Values that are not finite count as missing. For an axle, values that are missing in these curves stay missing.
    pub fn with_values(&self, value: impl Fn(usize, usize) -> f64) -> Self {
        let mut curves = self.curves.clone();
        let keeps_empty = matches!(self.plan, Planned::Axle(..));
        for (number, station) in curves.stations.iter_mut().enumerate() {
            for (k, own) in station.values.iter_mut().enumerate() {
                let found = value(k, number) * curves.columns[k].factor();
                *own = match *own {
                    Err(reason) if keeps_empty || !found.is_finite() => Err(reason),
                    Ok(_) if !found.is_finite() => Err(NoValue::NotFinite),
                    _ => Ok(found),
                };
            }
        }
        let plan = match &self.plan {
            Planned::Corner(plan) => Planned::Corner(plan.clone()),
            Planned::Axle(both, plan, placed) => Planned::Axle(both, plan.clone(), placed.clone()),
        };
        Solved {
            study: self.study,
            curves,
            plan,
        }
    }

    /// Table of a study's curves, including the curves of its targets. `None` if the study cannot be solved.
    pub fn table(study: &Study) -> Option<CurveTable> {
        CurveTable::read(&Solved::with_targets(study).ok()?.csv()).ok()
    }

    /// Curves with stations and columns.
    pub fn curves(&self) -> &Curves {
        &self.curves
    }

    /// Content of `curves.csv`.
    pub fn csv(&self) -> Vec<u8> {
        curves_csv(&self.curves)
    }

    /// Content of `sensitivities.csv`, if the study requests it.
    pub fn sensitivities_csv(&self) -> Option<Vec<u8>> {
        let asked = match &self.plan {
            Planned::Corner(plan) => &plan.sensitivities,
            Planned::Axle(_, plan, _) => &plan.sensitivities,
        };
        (!asked.is_empty()).then(|| sensitivities_csv(self.study, &self.curves))
    }

    /// True if every station is solved with all its defined values, and every column has a value at some station.
    pub fn is_complete(&self) -> bool {
        self.curves.are_complete()
    }

    /// Warnings about the design, one per line.
    pub fn plausibility(&self) -> Result<Vec<String>, String> {
        let wheel = self.study.wheel();
        let mut found = match &self.plan {
            Planned::Corner(_) => plausibility(wheel).map_err(|f| f.describe(&wheel.mechanism))?,
            Planned::Axle(both, plan, placed) => {
                let found = AxleCurves {
                    curves: self.curves.clone(),
                    placed: placed.clone(),
                };
                both_wheels_plausibility(&both.axle, plan, &found)
                    .map_err(|f| both.axle.describe_fault(f))?
            }
        };
        found.extend(rack_doubt(self.study));
        found.extend(spring_doubts(self.study, &self.curves));
        Ok(found)
    }

    /// Remarks on the curves, one per line: their accuracy, and missing values.
    pub fn remarks(&self) -> Vec<String> {
        remarks(&self.curves, self.study.wheel().length_unit)
    }

    /// Ranges of stations without a pose, with the reason.
    pub fn failures(&self) -> Vec<FailureRange> {
        FailureRange::all(&self.curves, self.study.wheel())
    }

    /// Content of `summary.json` of a solve.
    pub fn summary(&self) -> Result<Summary, String> {
        let design = match &self.plan {
            Planned::Corner(_) => None,
            Planned::Axle(both, plan, _) => {
                let design = axle_curves(&both.axle, &plan.at_design());
                Some(design.map_err(|f| both.axle.describe_fault(f))?.curves)
            }
        };
        let summary = SolveSummary::of(self.study, &self.curves, design.as_ref());
        Ok(Summary::Solve(Box::new(summary)))
    }

    /// Record of these designs over the named motion `name`, for the report page. In each study, this motion has replaced the
    /// study's own motion. All designs describe one wheel, or all describe an axle.
    pub(crate) fn motion_record(name: &str, designs: &[Labelled<'_>]) -> MotionRecord {
        let (.., last) = designs.last().expect("a run has a design");
        let study = designs[0].2.study;
        match &last.plan {
            Planned::Corner(plan) => {
                let drawn = designs.iter().map(|(label, file, solved)| DrawnDesign {
                    label,
                    file,
                    curves: &solved.curves,
                    frames: Vec::new(),
                });
                MotionRecord::of_wheel(study, Some(name), plan, drawn.collect())
            }
            Planned::Axle(_, plan, _) => {
                let axles: Vec<_> = axles(designs).collect();
                MotionRecord::of_axle(study, Some(name), plan, &axles, Vec::new())
            }
        }
    }

    /// Record of a run of these designs, for the report page. All designs describe one wheel, or all describe an axle. The last
    /// design determines the plan of the record, and for one wheel its sensitivities.
    pub fn record(command: &str, designs: &[Labelled<'_>]) -> Result<Record, String> {
        let (.., last) = designs.last().expect("a run has a design");
        let study = designs[0].2.study;
        match &last.plan {
            Planned::Corner(plan) => {
                let wheels = designs.iter().filter_map(|(label, file, solved)| {
                    Some((*label, *file, solved.study.one_wheel()?, &solved.curves))
                });
                let record = Record::of(command, study, plan, &wheels.collect::<Vec<_>>());
                record.map_err(|f| f.describe(&study.wheel().mechanism))
            }
            Planned::Axle(both, plan, _) => {
                let axles: Vec<_> = axles(designs).collect();
                let record = Record::of_axle(command, study, plan, &axles);
                record.map_err(|f| both.axle.describe_fault(f))
            }
        }
    }
}

/// Designs of axles for the record of a run. Designs of one wheel are left out.
fn axles<'a>(designs: &'a [Labelled<'a>]) -> impl Iterator<Item = SolvedAxle<'a>> {
    designs.iter().filter_map(|(label, file, solved)| {
        let own = &solved.study.axle()?.axle;
        Some((*label, *file, own, &solved.curves))
    })
}
