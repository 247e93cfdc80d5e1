//! Tests of the statistics of rows: which designs are ranked, and which sums the main effects use. Also a test of the record.

use super::{Bench, STUDY};
use hardpoint::report::SweepSummary;
use hardpoint::study::Study;
use hardpoint::sweep::{Effects, Failing, SweepPlan, SweepStatistics};

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

/// Some designs of a grid have no value for one output. The main effects then use the same designs as if these designs had failed,
/// with the same correction for an incomplete grid.
#[test]
fn an_incomplete_grid_has_corrected_shares() {
    let study = STUDY
        .replace("latin_hypercube", "grid")
        .replace("samples = 700\n", "");
    let study = study.replace(
        "-10.0, 10.0] },\n  { hardpoint = \"strut",
        "-10.0, 10.0], steps = 9 },\n  { hardpoint = \"strut",
    );
    let bench = Bench::new(&study.replace("-20.0, 20.0] },\n]", "-20.0, 20.0], steps = 9 },\n]"));
    let study = Study::read(&bench.path("study.toml"), &[]).unwrap();
    let plan = SweepPlan::of(&study, study.sweep.as_ref().unwrap()).unwrap();
    let (record, width) = (&plan.record, plan.record.outputs.len());
    let whole = plan.worker().unwrap().rows(0).clone();
    assert_eq!(whole.designs(), 81);
    let (mut lacking, mut failed) = (whole.clone(), whole.clone());
    for design in [3, 4, 5, 12, 13, 14, 80] {
        lacking.outputs[design * width] = f64::NAN;
        failed.failing[design] = Some(Failing {
            status: "unreachable".to_owned(),
            reason: "planted".to_owned(),
            stations: 1,
            at: None,
        });
    }
    let [whole, lacking, failed] = [whole, lacking, failed].map(|rows| {
        let effects = Effects::all(record, &SweepStatistics::of(record, &rows)).unwrap();
        effects.into_iter().map(|own| own.of).collect::<Vec<_>>()
    });
    assert_eq!(lacking, failed);
    assert_ne!(lacking, whole);
}

/// One solved design has no value of an output, and one design that is not solved everywhere has a value. The note counts the
/// solved design.
#[test]
fn a_note_counts_the_solved_designs_without_a_value() {
    let bench = Bench::new(&STUDY.replace("samples = 700", "samples = 60"));
    let study = Study::read(&bench.path("study.toml"), &[]).unwrap();
    let plan = SweepPlan::of(&study, study.sweep.as_ref().unwrap()).unwrap();
    let record = &plan.record;
    let mut rows = plan.worker().unwrap().rows(0).clone();
    rows.outputs[4 * record.outputs.len()] = f64::NAN;
    rows.failing[9] = Some(Failing {
        status: "unreachable".to_owned(),
        reason: "planted".to_owned(),
        stations: 1,
        at: None,
    });
    let statistics = SweepStatistics::of(record, &rows);
    let mut twice = statistics.clone();
    twice.absorb(record, &statistics);
    for (statistics, words) in [
        (&statistics, "1 solved design lacks"),
        (&twice, "2 solved designs lack"),
    ] {
        let summary = SweepSummary::of(record, statistics);
        let wanted = format!("{words} {}:", record.outputs[0].column);
        let notes = summary.notes();
        assert!(notes.iter().any(|n| n.starts_with(&wanted)), "{notes:?}");
    }
}

/// Statistics of an older version lack the numbers of solved designs with a value. The program sums them again from the rows.
#[test]
fn statistics_of_an_older_version_are_summed_again() {
    let bench = Bench::new(&STUDY.replace("samples = 700", "samples = 60"));
    bench.sweep("run", &[]).success();
    let summary = bench.json("run/summary.json");
    let mut part = bench.json("run/designs.json");
    let statistics = part["statistics"].as_object_mut().unwrap();
    assert!(statistics.remove("solved_values").is_some());
    std::fs::write(bench.path("run/designs.json"), part.to_string()).unwrap();
    bench.run(&["report", "run"]).success();
    bench.run(&["merge", "--out", "merged", "run"]).success();
    assert_eq!(bench.json("merged/summary.json"), summary);
}

/// The x axis of the study points rearward, against the axis of the program. The tolerance in the record stays positive.
#[test]
fn tolerances_of_reversed_axes_are_positive() {
    let study = STUDY.replace(
        "[suspension]\n",
        "[suspension]\nframe = \"x_rear\"\nside = \"right\"\n",
    );
    let bench = Bench::new(&study);
    let target = "optimise.targets=[{ point = \"wheel_centre\", axis = \"x\", at = 0.0, value = 1.0, tolerance = 0.5 }]";
    let study = Study::read(&bench.path("study.toml"), &[target.to_owned()]).unwrap();
    let plan = SweepPlan::of(&study, study.sweep.as_ref().unwrap()).unwrap();
    assert_eq!(plan.record.targets[0].tolerance, 0.5);
}
