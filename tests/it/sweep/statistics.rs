//! Tests of the statistics of rows: which designs are ranked, and which sums the main effects use.

use super::{Bench, STUDY};
use hardpoint::study::Study;
use hardpoint::sweep::{SweepPlan, SweepStatistics};

/// The best design loses its margin. It then no longer satisfies the constraint, so it is not ranked.
#[test]
fn a_design_without_a_margin_is_not_ranked() {
    let bench = Bench::new(&STUDY.replace("samples = 700", "samples = 60"));
    let constraint = "optimise.constraints=[{ length = \"tie_rod\", at_most = 360.6 }]";
    let study = Study::read(&bench.path("study.toml"), &[constraint.to_owned()]).unwrap();
    let plan = SweepPlan::of(&study, study.sweep.as_ref().unwrap()).unwrap();
    let record = &plan.record;
    let mut rows = plan.worker().unwrap().rows(0).clone();
    let before = SweepStatistics::of(record, &rows);
    let best = before.best[0].design;
    let (margin, _) = record.limits()[0];
    rows.outputs[best as usize * record.outputs.len() + margin] = f64::NAN;
    let after = SweepStatistics::of(record, &rows);
    assert!(after.best.iter().all(|candidate| candidate.design != best));
    assert_eq!(after.best[0], before.best[1]);
    assert_eq!(after.violators, before.violators + 1);
    assert_eq!(after.violating[margin], before.violating[margin] + 1);
}
