//! Tests of sweeps with designs that fail, and of their counts.

use super::*;
use crate::support::one_line;

/// If some designs cannot reach the whole motion, the sweep counts them by reason. Values that cannot be computed have
/// empty cells. The sweep never reports a range over a part of the motion.
#[test]
fn what_fails_is_counted_and_left_empty() {
    let bench = Bench::new(STUDY);
    let travel = "motion.travel={from=-330.0,to=330.0,steps=12}";
    let (text, _) = said(
        &bench
            .sweep("run", &["--set", travel, "--set", "sweep.samples=300"])
            .code(1),
    );
    let designs = bench.designs("run");
    let failed: Vec<usize> = (0..300)
        .filter(|i| designs.text("status")[*i] != "ok")
        .collect();
    assert!((10..290).contains(&failed.len()), "{}", failed.len());
    for i in &failed {
        assert_eq!(designs.text("status")[*i], "unreachable");
        assert!(designs.text("reason")[*i].contains("travel ends"));
        assert_eq!(
            designs.text("failed_at_mm")[*i]
                .parse::<f64>()
                .unwrap()
                .abs(),
            330.0
        );
        assert_eq!(designs.text("camber_min_deg")[*i], "");
        assert_eq!(designs.text("toe_max_deg")[*i], "");
        assert_ne!(designs.text("camber_design_deg")[*i], "");
        assert_ne!(designs.text("rms_camber")[*i], "");
    }
    let summary = bench.json("run/summary.json");
    assert_eq!(summary["solved"], 300 - failed.len());
    let reasons = summary["failures"].as_array().unwrap();
    let counted: u64 = reasons.iter().map(|r| r["designs"].as_u64().unwrap()).sum();
    assert_eq!(counted, failed.len() as u64);
    // The evaluation in SIMD lanes accepts no design that fails during the motion. The program evaluates
    // each such design singly.
    let one_by_one = summary["one_by_one"].as_u64().unwrap();
    assert!((counted..=300).contains(&one_by_one), "{one_by_one}");
    assert_eq!(reasons[0]["examples"][0], failed[0]);
    assert!(
        text.contains("unreachable") && text.contains("reason"),
        "{text}"
    );
    let curves = Table::read(&bench.path("run/curves.csv"));
    let open = curves
        .text("status")
        .iter()
        .filter(|s| **s == "unreachable")
        .count();
    assert!(open >= failed.len());
    for row in curves.rows.iter().filter(|row| row.last().unwrap() != "ok") {
        assert_eq!(row[2..4], ["", ""]);
    }
    // This design is not a mechanism, because the arm's outer joint is on the arm's axis.
    let point =
        "lower_ball_joint_x,lower_ball_joint_y,lower_ball_joint_z\n120,360,195\n5,705,190\n";
    fs::write(bench.path("rows.csv"), point).unwrap();
    fs::write(bench.path("study.toml"), study_of_file("rows.csv")).unwrap();
    bench.sweep("flat", &[]).code(1);
    let designs = bench.designs("flat");
    assert_eq!(designs.text("status"), ["degenerate", "ok"]);
    assert!(designs.text("reason")[0].contains("lower_ball_joint"));
    assert_eq!(designs.text("camber_design_deg")[0], "");
    assert_eq!(designs.text("failed_at_mm")[0], "");
}

/// A design that cannot reach the whole motion is neither among the best designs nor on the Pareto front. This holds
/// even if its misfit at one station is smaller. A note states the number of such designs.
#[test]
fn only_solved_designs_are_ranked() {
    let bench = Bench::new(STUDY);
    let travel = "motion.travel={from=-330.0,to=330.0,steps=12}";
    let outputs = "outputs.characteristics=[\"kingpin_inclination\",\"bump_steer\"]";
    let few = "sweep.samples=300";
    let few = ["--set", travel, "--set", outputs, "--set", few];
    bench.sweep("first", &few).code(1);
    let first = bench.designs("first");
    let mut failed = (0..300).filter(|i| first.text("status")[*i] != "ok");
    let failed = failed.next().unwrap();
    // The targets are values of a design that fails.
    let target = |name: &str, unit: &str, tolerance: f64| {
        let value = first.text(&format!("{name}_design_{unit}"))[failed];
        format!("{{characteristic=\"{name}\",at=0.0,value={value},tolerance={tolerance}}}")
    };
    let kingpin = target("kingpin_inclination", "deg", 0.01);
    let steer = target("bump_steer", "deg_per_mm", 0.001);
    let targets = format!("optimise.targets=[{kingpin},{steer}]");
    let more = [&few[..], &["--set", &targets]].concat();
    let (text, _) = said(&bench.sweep("run", &more).code(1));
    let designs = bench.designs("run");
    let (misfit, status) = (designs.numbers("misfit"), designs.text("status"));
    let is_solved = |design: &usize| status[*design] == "ok";
    let mut ranked: Vec<usize> = (0..300).filter(is_solved).collect();
    ranked.sort_by(|a, b| misfit[*a].total_cmp(&misfit[*b]));
    let summary = bench.json("run/summary.json");
    let best = summary["best"].as_array().unwrap().iter();
    let best: Vec<usize> = best
        .map(|d| d["design"].as_u64().unwrap() as usize)
        .collect();
    assert_eq!(best, ranked[..10]);
    let front = summary["pareto"].as_array().unwrap().iter();
    let mut front = front.map(|d| d.as_u64().unwrap() as usize);
    assert!(front.all(|design| is_solved(&design)));
    let smaller = |design: &usize| !is_solved(design) && misfit[*design] < misfit[ranked[0]];
    let count = (0..300).filter(smaller).count();
    assert!(count > 0 && misfit[failed] < 1e-6, "{}", misfit[failed]);
    let number = match count {
        1 => "1 design".to_owned(),
        2..10 => format!("{count} designs"),
        _ => "At least 10 designs".to_owned(),
    };
    let note = format!("{number} with a smaller misfit than design {}", ranked[0]);
    assert!(
        summary["notes"].to_string().contains(&note),
        "{note}: {}",
        summary["notes"]
    );
    assert!(one_line(&text).contains(&note), "{text}");
}

/// A file of designs may contain numbers of designs. The results use row numbers, and a note states that the two
/// numbers differ.
#[test]
fn other_numbers_in_a_file_of_designs_are_reported() {
    let bench = Bench::new(&study_of_file("rows.csv"));
    for (rows, differs) in [("7,1.0\n3,2.0\n", true), ("0,1.0\n1,2.0\n", false)] {
        fs::write(
            bench.path("rows.csv"),
            format!("design,tie_rod_inner_dz\n{rows}"),
        )
        .unwrap();
        let (_, error) = said(&bench.sweep("run", &["--force"]).success());
        let error = one_line(&error);
        assert_eq!(
            error.contains("number the designs from 0"),
            differs,
            "{error}"
        );
        assert_eq!(bench.designs("run").text("design"), ["0", "1"]);
    }
}

/// Before the first part is complete, the summary states that no design is done.
#[test]
fn a_sweep_of_which_nothing_is_done_says_so() {
    use hardpoint::report::SweepSummary;
    use hardpoint::sweep::{SweepPlan, SweepStatistics};
    let study = hardpoint::study::Study::from_text("study.toml", STUDY, Path::new(".")).unwrap();
    let plan = SweepPlan::of(&study, study.sweep.as_ref().unwrap()).unwrap();
    let none = SweepStatistics::empty(&plan.record);
    let summary = SweepSummary::of(&plan.record, &none);
    let designs = plan.record.designs;
    let said = format!("none of {designs} designs done yet; --resume continues");
    assert_eq!(summary.headline(), said);
    assert!(!summary.is_complete());
}
