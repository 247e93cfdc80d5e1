//! Designs of a sweep that its page shows, with their curves and their mechanism.

use super::{Solved, drawn};
use crate::curves::wheel_curves;
use crate::mechanism::DesignFault;
use crate::plan::Plan;
use crate::report::{CurveTable, DrawnDesigns, Record, SweepSummary, curves_csv};
use crate::study::{Study, WheelStudy};
use crate::sweep::SweepPlan;

/// Largest number of designs that the page of a sweep shows, without the nominal design.
const MOST_DESIGNS: usize = 16;
/// Largest number of stations at which each shown design is solved.
const MOST_STATIONS: usize = 45;
/// Largest number of rack displacements among the stations of each shown design.
const MOST_RACKS: usize = 3;

impl DrawnDesigns {
    /// Selects the best designs of a sweep, and some designs of its Pareto front. Without targets, it selects the designs with the
    /// smallest or largest outputs. Designs that cannot be solved in the design position are left out. The nominal design `own`
    /// comes first.
    ///
    /// # Errors
    /// If the nominal design cannot be solved in the design position.
    pub fn of(
        study: &Study,
        own: &WheelStudy,
        plan: &SweepPlan<'_>,
        summary: &SweepSummary,
    ) -> Result<Self, DesignFault> {
        let mut numbers: Vec<Option<u64>> = vec![None];
        numbers.extend(
            summary
                .representative_designs(MOST_DESIGNS)
                .into_iter()
                .map(Some),
        );
        let asked = Plan {
            sensitivities: Vec::new(),
            loads: Vec::new(),
            certify: false,
            ..Plan::with_targets(own, study.optimise.as_ref())
        };
        let asked = asked.thinned(MOST_STATIONS, MOST_RACKS);
        let mut solved = Vec::new();
        for number in numbers {
            let moved = number.map(|n| plan.moved(n));
            let moved = moved.as_ref().and_then(Study::one_wheel);
            let wheel = moved.unwrap_or(own).clone();
            match wheel_curves(&wheel, &asked) {
                Ok(curves) => solved.push((number, wheel, curves)),
                Err(fault) if number.is_none() => return Err(fault),
                Err(_) => {}
            }
        }
        let named: Vec<(String, String)> = solved
            .iter()
            .map(|(number, ..)| match number {
                None => ("as given".to_owned(), String::new()),
                Some(number) => (format!("design {number}"), String::new()),
            })
            .collect();
        let designs: Vec<Solved<'_>> = solved
            .iter()
            .zip(&named)
            .map(|((_, wheel, curves), (label, file))| (&**label, &**file, wheel, curves))
            .collect();
        let table = |(_, _, curves): &(_, _, crate::curves::Curves)| {
            let csv = curves_csv(curves);
            CurveTable::read(&csv).expect("it was written just before")
        };
        Ok(DrawnDesigns {
            digest: plan.record.digest.clone(),
            designs: solved.iter().map(|(number, ..)| *number).collect(),
            record: Record::with("sweep", study, &asked, drawn(&asked, &designs)?, Vec::new()),
            curves: solved.iter().map(table).collect(),
        })
    }
}
