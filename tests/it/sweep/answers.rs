//! Tests of sweeps with known results.

use super::*;
use crate::support::{larger, one_line};

/// The targets are values of one point of a grid. The sweep finds this point as the best design and as the only point
/// of the Pareto front.
#[test]
fn a_planted_design_is_found() {
    let bench = Bench::new(STUDY);
    let grid = |inner: f64, top: f64| {
        let inner = format!("tie_rod_inner    = [-110.0, 330.0, {:?}]", 243.0 + inner);
        let top = format!("strut_top        = [ -35.0, {:?}, 850.0]", 575.0 + top);
        STUDY
            .replace("tie_rod_inner    = [-110.0, 330.0, 243.0]", &inner)
            .replace("strut_top        = [ -35.0, 575.0, 850.0]", &top)
    };
    fs::write(bench.path("planted.toml"), grid(-4.0, 12.0)).unwrap();
    bench
        .run(&["solve", "planted.toml", "--out", "planted"])
        .success();
    let planted = Table::read(&bench.path("planted/curves.csv"));
    let target = |column: &str| {
        let (travel, values) = (planted.text("travel_mm"), planted.text(column));
        let points = travel
            .iter()
            .zip(values)
            .map(|(t, v)| format!("[{t}, {v}]"));
        points.collect::<Vec<_>>().join(", ")
    };
    let from = STUDY.find("targets = [").unwrap();
    let study = STUDY[..from]
        .replace("latin_hypercube", "grid")
        .replace("samples = 700\n", "")
        .replace(
            "range = [-10.0, 10.0] },\n  {",
            "range = [-10.0, 10.0], steps = 11 },\n  {",
        )
        .replace("range = [-20.0, 20.0]", "range = [-20.0, 20.0], steps = 11")
        + &format!(
            "targets = [\n{{ characteristic = \"toe\", points = [{}], tolerance = 0.01 }},\n\
             {{ characteristic = \"camber\", points = [{}], tolerance = 0.01 }} ]\n",
            target("toe_deg"),
            target("camber_deg")
        );
    let bench = Bench::new(&study);
    bench.sweep("run", &[]).success();
    let summary = bench.json("run/summary.json");
    // -4 is value number 3 of the first variable. 12 is value number 8 of the second variable, which changes fastest.
    let best = &summary["best"][0];
    assert_eq!(best["design"], 3 * 11 + 8);
    assert_eq!(best["variables"], serde_json::json!([-4.0, 12.0]));
    assert!(best["misfit"].as_f64().unwrap() < 1e-8);
    assert!(summary["best"][1]["misfit"].as_f64().unwrap() > 0.1);
    assert_eq!(summary["pareto"], serde_json::json!([41]));
    assert_eq!(Table::read(&bench.path("run/pareto.csv")).rows.len(), 1);
    // The study of this design has the curves from which the targets were taken.
    let (text, _) = said(
        &bench
            .run(&["sweep", "study.toml", "--design", "41"])
            .success(),
    );
    fs::write(bench.path("best.toml"), text).unwrap();
    bench
        .run(&["solve", "best.toml", "--out", "best"])
        .success();
    let best = Table::read(&bench.path("best/curves.csv"));
    assert_eq!(best.rows, planted.rows);
}

/// A row of a sweep has the misfits of the optimisation, and the minimum, maximum and design value of the curves.
#[test]
fn a_row_says_what_solve_and_optimise_say() {
    let study = crate::support::sample("macpherson_front.toml");
    // Replaces the study's band of toe. One limit of the new band is a constant, the other is a curve.
    let (study, _) = study.split_once("# At most 0.1 degrees").unwrap();
    let study = study.to_owned();
    let band = "\n[[optimise.targets]]\ncharacteristic = \"toe\"\nbetween = [-0.1, [[-80.0, 0.0], [80.0, 0.2]]]\ntolerance = 0.05\n";
    let bench = Bench::new(&(study + band + "\n[sweep]\ndesigns = \"rows.csv\"\n"));
    fs::write(
        bench.path("rows.csv"),
        "strut_top_dy,tie_rod_inner_z\n0,243\n5,244.5\n",
    )
    .unwrap();
    bench.sweep("run", &[]).success();
    bench.run(&[
        "optimise",
        "study.toml",
        "--out",
        "tuned",
        "--set",
        "optimise.max_iterations=1",
    ]);
    bench
        .run(&["solve", "study.toml", "--out", "solved"])
        .success();
    let designs = bench.designs("run");
    let summary = bench.json("tuned/summary.json");
    let misfit = summary["misfit_before"].as_f64().unwrap();
    // The sweep is evaluated in SIMD lanes. There, the wheel centres agree with the travel to 1e-12 of the suspension
    // size.
    assert!((designs.numbers("misfit")[0] / misfit - 1.0).abs() < 1e-11);
    let targets = summary["targets"].as_array().unwrap();
    assert_eq!(targets.len(), 3);
    for target in targets {
        let name = target["output"].as_str().unwrap().trim_end_matches("_deg");
        let rms = target["before"]["rms"].as_f64().unwrap();
        assert!((designs.numbers(&format!("rms_{name}"))[0] / rms - 1.0).abs() < 1e-11);
    }
    let solved = Table::read(&bench.path("solved/curves.csv"));
    for (name, unit) in [("camber", "deg"), ("scrub_radius", "mm")] {
        let curve = solved.numbers(&format!("{name}_{unit}"));
        let min = curve.iter().copied().fold(f64::INFINITY, f64::min);
        let max = curve.iter().copied().fold(f64::NEG_INFINITY, larger);
        let found =
            ["min", "max", "design"].map(|w| designs.numbers(&format!("{name}_{w}_{unit}"))[0]);
        for (found, wanted) in found.iter().zip([min, max, curve[20]]) {
            assert!((found - wanted).abs() < 2e-9, "{name}: {found} {wanted}");
        }
    }
    assert_eq!(designs.numbers("strut_top_dy_mm"), [0.0, 5.0]);
    assert_eq!(designs.numbers("tie_rod_inner_z_mm"), [243.0, 244.5]);
    assert_ne!(designs.rows[0], designs.rows[1]);
    // The program does not know how the rows were sampled, so the summary has no shares of variance.
    let summary = bench.json("run/summary.json");
    assert!(output(&summary, "misfit")["effects"][0]["share"].is_null());
}

/// Targets apply at rack displacements of the motion. At each of these displacements, they have the deviations of the
/// optimisation.
#[test]
fn targets_at_racks_of_the_motion_are_compared() {
    let from = STUDY.find("targets = [").unwrap();
    let with = |targets: &str| {
        let study = STUDY[..from].replace("[motion]\n", "[motion]\nrack = [-10.0, 10.0]\n");
        Bench::new(
            &format!("{study}targets = [{targets}]\n").replace("samples = 700", "samples = 3"),
        )
    };
    let toe = |rack: &str| {
        format!(
            "{{ characteristic = \"toe\", points = [[-60.0, 0.1], [60.0, 0.1]], rack = {rack}, tolerance = 0.01 }}"
        )
    };
    // This motion does not contain the rack displacement 0. But the design position of every sweep is at rack
    // displacement 0.
    let targets = [toe("-10.0"), toe("[-10.0, 10.0]"), toe("0.0")].join(", ");
    let bench = with(&targets);
    bench.sweep("run", &[]).success();
    bench.run(&[
        "optimise",
        "study.toml",
        "--out",
        "tuned",
        "--set",
        "optimise.max_iterations=1",
    ]);
    let [swept, tuned] = ["run", "tuned"].map(|run| bench.json(&format!("{run}/summary.json")));
    let misfit = tuned["misfit_before"].as_f64().unwrap();
    let at_design = output(&swept, "misfit")["at_design"].as_f64().unwrap();
    assert!(
        (at_design / misfit - 1.0).abs() < 1e-11,
        "{at_design} {misfit}"
    );
    for (target, column) in ["rms_toe", "rms_toe_2", "rms_toe_3"].iter().enumerate() {
        let rms = tuned["targets"][target]["before"]["rms"].as_f64().unwrap();
        let found = output(&swept, column)["at_design"].as_f64().unwrap();
        assert!((found / rms - 1.0).abs() < 1e-11, "{column}: {found} {rms}");
    }
    assert_eq!(swept["best"].as_array().unwrap().len(), 3);
    assert!(!swept["notes"].to_string().contains("cannot evaluate"));
}

/// Targets at other racks, in other motions, and of lengths have the same deviations as in a tuning: in the study's own design,
/// and in a design of the sweep that a tuning starts from.
#[test]
fn targets_beside_the_motion_have_the_deviations_of_a_tuning() {
    let from = STUDY.find("targets = [").unwrap();
    let targets = "targets = [\n\
        { characteristic = \"camber\", at = 0.0, value = -0.5, tolerance = 0.05 },\n\
        { characteristic = \"toe\", motion = \"lock\", at = 0.0, value = 9.0, tolerance = 0.05 },\n\
        { characteristic = \"toe\", rack = 5.0, at = 0.0, value = 0.0, tolerance = 0.05, weight = 2.0 },\n\
        { length = \"tie_rod\", at = 0.0, value = 360.0, tolerance = 1.0 } ]\n\
        [motions.lock]\ntravel = { from = -20.0, to = 20.0, steps = 5 }\nrack = 12.0\n";
    let study = format!("{}{targets}", &STUDY[..from]).replace("samples = 700", "samples = 3");
    let bench = Bench::new(&study);
    bench.sweep("run", &[]).success();
    let summary = bench.json("run/summary.json");
    assert_eq!(summary["best"].as_array().unwrap().len(), 3);
    let designs = bench.designs("run");
    let moved = bench
        .run(&["sweep", "study.toml", "--design", "1"])
        .success();
    fs::write(bench.path("moved.toml"), &moved.get_output().stdout).unwrap();
    let columns = [
        "rms_camber",
        "rms_toe_lock",
        "rms_toe",
        "rms_tie_rod_length",
    ];
    for (study, row) in [("study.toml", None), ("moved.toml", Some(1))] {
        let tuned = format!("tuned_{study}");
        let once = "optimise.max_iterations=1";
        bench.run(&["optimise", study, "--out", &tuned, "--set", once]);
        let tuned = bench.json(&format!("{tuned}/summary.json"));
        let found = |column: &str| match row {
            None => output(&summary, column)["at_design"].as_f64().unwrap(),
            Some(row) => designs.numbers(column)[row],
        };
        for (target, column) in columns.iter().enumerate() {
            let rms = tuned["targets"][target]["before"]["rms"].as_f64().unwrap();
            let found = found(column);
            assert!((found / rms - 1.0).abs() < 1e-9, "{column}: {found} {rms}");
        }
        let misfit = tuned["misfit_before"].as_f64().unwrap();
        assert!((found("misfit") / misfit - 1.0).abs() < 1e-9, "{misfit}");
    }
}

/// The margins of the designs follow from the length of the tie rod, which the test computes from the columns of its ends.
/// Only designs with a positive margin are ranked.
#[test]
fn a_sweep_ranks_only_designs_that_satisfy_the_constraints() {
    let constraint = "optimise.constraints=[{ length = \"tie_rod\", at_most = 360.6 }, { length = \"tie_rod\", kept = true }]";
    let bench = Bench::new(&STUDY.replace("samples = 700", "samples = 60"));
    let (stdout, _) = said(&bench.sweep("run", &["--set", constraint]).success());
    let designs = bench.designs("run");
    let margins = designs.numbers("margin_length_tie_rod_at_most_360.6_mm");
    let kept = designs.numbers("margin_length_tie_rod_kept_mm");
    let summary = bench.json("run/summary.json");
    let own = output(&summary, "margin_length_tie_rod_at_most_360.6_mm")["at_design"]
        .as_f64()
        .unwrap();
    for (margin, kept) in margins.iter().zip(&kept) {
        assert!(
            (kept + (margin - own).abs()).abs() < 1e-9,
            "{margin} {kept}"
        );
    }
    let violators = margins.iter().filter(|margin| **margin < 0.0).count();
    assert!((1..60).contains(&violators), "{margins:?}");
    assert_eq!(summary["violating"], violators);
    let best = summary["best"].as_array().unwrap();
    assert!(!best.is_empty());
    for design in best {
        assert!(margins[design["design"].as_u64().unwrap() as usize] >= 0.0);
    }
    let misfits = designs.numbers("misfit");
    let satisfying = (0..60).filter(|design| margins[*design] >= 0.0);
    let least = satisfying
        .map(|design| misfits[design])
        .fold(f64::INFINITY, f64::min);
    assert_eq!(best[0]["misfit"].as_f64().unwrap(), least);
    assert!(
        stdout.contains(&format!("{violators} outside the constraints")),
        "{stdout}"
    );
}

/// With `constraints = false` a sweep does not check constraints. If it ranks designs, the terminal, `summary.json` and the
/// page name the constraints.
#[test]
fn constraints_that_a_sweep_does_not_check_are_named() {
    let constraint = "optimise.constraints=[{ length = \"tie_rod\", at_most = 10.0 }]";
    let bench = Bench::new(&STUDY.replace("samples = 700", "samples = 3"));
    let unchecked = [
        "--set",
        constraint,
        "--set",
        "sweep.constraints=false",
        "--report",
    ];
    let (stdout, stderr) = said(&bench.sweep("run", &unchecked).success());
    let words = "does not check the constraints of [optimise], so the best designs may violate them: \
                 length tie_rod at most 10";
    let summary = bench.json("run/summary.json");
    assert!(!summary["best"].as_array().unwrap().is_empty());
    let page = fs::read_to_string(bench.path("run/report.html")).unwrap();
    for text in [
        summary["notes"].to_string(),
        page,
        format!("{stdout}{stderr}"),
    ] {
        assert!(one_line(&text).contains(words), "{text}");
    }
    let (stdout, stderr) = said(&bench.sweep("free", &[]).success());
    assert!(!format!("{stdout}{stderr}").contains("constraints of [optimise]"));
}

/// The gain of a quantity made of velocities is its derivative with respect to travel, and equals the derivative of
/// `solve`. A quantity that is itself a gain has no gain.
#[test]
fn gains_of_what_is_made_of_velocities_are_those_of_solve() {
    let study = crate::support::sample("double_wishbone_pushrod.toml");
    let bench = Bench::new(&(study + "\n[sweep]\ndesigns = \"rows.csv\"\n"));
    let rows = "tie_rod_inner_dz,rocker_pivot_front_dz\n0,0\n3,-4\n-2,1.5\n";
    fs::write(bench.path("rows.csv"), rows).unwrap();
    let asked = "outputs.characteristics=[\"camber\", \"motion_ratio\", \"roll_centre_height\", \
                 \"bump_steer\", \"anti_roll_bar_motion_ratio\"]";
    // The test also displaces the rack in the design position.
    for rack in ["motion.rack=0.0", "motion.rack=6.0"] {
        let out = ["run", rack].concat();
        let set = ["--set", asked, "--set", rack, "--set", "outputs.loads=[]"];
        bench.sweep(&out, &set).success();
        let designs = bench.designs(&out);
        for number in 0..3 {
            let call = ["sweep", "study.toml", "--design", &number.to_string()];
            let text = said(&bench.run(&[&call[..], &set].concat()).success()).0;
            fs::write(bench.path("one.toml"), text).unwrap();
            let still = ["--set", "motion.travel=[0.0]", "--out", "one", "--force"];
            bench
                .run(&[&["solve", "one.toml"], &still[..]].concat())
                .success();
            let solved = Table::read(&bench.path("one/curves.csv"));
            for (gain, slope) in [
                ("motion_ratio_gain_per_mm", "motion_ratio_d1_per_mm"),
                (
                    "roll_centre_height_gain_mm_per_mm",
                    "roll_centre_height_d1_mm_per_mm",
                ),
                (
                    "anti_roll_bar_motion_ratio_gain_deg_per_mm2",
                    "anti_roll_bar_motion_ratio_d1_deg_per_mm2",
                ),
            ] {
                let (found, wanted) = (designs.numbers(gain)[number], solved.numbers(slope)[0]);
                assert!(
                    (found / wanted - 1.0).abs() < 1e-9,
                    "{gain}: {found} {wanted}"
                );
            }
        }
        let header = fs::read_to_string(bench.path(&out).join("designs.csv")).unwrap();
        assert!(header.contains("camber_gain") && !header.contains("bump_steer_gain"));
    }
}

/// A coordinate without effect on an output has no share of the output's variance. This holds even for few designs. Here the
/// output is the height of the wheel centre in the design position. The coordinates of `tie_rod_inner` and `strut_top` do not
/// change this height.
#[test]
fn what_moves_nothing_has_no_share() {
    let from = STUDY.find("[sweep]").unwrap();
    let study = STUDY[..from].replace("[outputs]", "[outputs]\npoints = [\"wheel_centre\"]")
        + r#"[sweep]
method = "latin_hypercube"
samples = 100
variables = [
  { hardpoint = "wheel_centre", axis = "z", range = [-3.0, 3.0] },
  { hardpoint = "tie_rod_inner", axis = "z", range = [-5.0, 5.0] },
  { hardpoint = "strut_top", axis = "y", range = [-5.0, 5.0] },
]
"#;
    let bench = Bench::new(&study);
    for method in ["latin_hypercube", "sobol", "random", "saltelli"] {
        let set = format!("sweep.method={method}");
        bench.sweep(method, &["--set", &set]).success();
        let summary = bench.json(&format!("{method}/summary.json"));
        let height = output(&summary, "wheel_centre_z_design_mm");
        let shares: Vec<f64> = height["effects"]
            .as_array()
            .unwrap()
            .iter()
            .map(|effect| effect["share"].as_f64().unwrap())
            .collect();
        // With Saltelli's samples, the share of the only variable with an effect still has a random error.
        let tolerance = if method == "saltelli" { 0.2 } else { 1e-9 };
        assert!((shares[0] - 1.0).abs() < tolerance, "{method}: {shares:?}");
        assert!(shares[1] < 1e-9 && shares[2] < 1e-9, "{method}: {shares:?}");
        assert!(shares.iter().all(|s| (0.0..=1.0).contains(s)));
    }
}

/// The height of the wheel centre in the design position is a + 2 b. The range of a is 6 mm wide, and that of b 4 mm.
/// So b has 16/25 of the variance, and a has 9/25.
#[test]
fn main_effects_of_a_linear_response_are_known() {
    let from = STUDY.find("[sweep]").unwrap();
    let study = STUDY[..from].replace("[outputs]", "[outputs]\npoints = [\"wheel_centre\"]")
        + r#"[sweep]
method = "grid"
variables = [
  { hardpoint = "wheel_centre", axis = "z", range = [-3.0, 3.0], steps = 17 },
  { hardpoints = ["wheel_centre", "spindle_inner"], factors = [2.0, 1.0], axis = "z", range = [-2.0, 2.0], steps = 17, name = "b" },
]
"#;
    let bench = Bench::new(&study);
    // Permitted error of each sampling method in the share of a variable in the variance.
    for (method, tolerance) in [
        ("grid", 1e-12),
        ("sobol", 0.02),
        ("latin_hypercube", 0.06),
        ("random", 0.06),
        ("saltelli", 0.02),
    ] {
        let set = format!("sweep.method={method}");
        let mut more = vec!["--set", set.as_str()];
        if method != "grid" {
            more.extend(["--set", "sweep.samples=2048"]);
        }
        bench.sweep(method, &more).success();
        let summary = bench.json(&format!("{method}/summary.json"));
        let height = output(&summary, "wheel_centre_z_design_mm");
        assert!(
            (height["r2"].as_f64().unwrap() - 1.0).abs() < 1e-10,
            "{method}: {height}"
        );
        let effects = height["effects"].as_array().unwrap();
        assert_eq!(effects.len(), 2);
        for (effect, (change, share)) in effects.iter().zip([(6.0, 0.36), (8.0, 0.64)]) {
            let found = |key: &str| effect[key].as_f64().unwrap();
            assert!(
                (found("change") - change).abs() < 1e-9,
                "{method}: {effect}"
            );
            assert!(
                (found("share") - share).abs() < tolerance,
                "{method}: {effect}"
            );
            if method == "saltelli" {
                assert!((found("total") - share).abs() < tolerance, "{effect}");
            }
        }
    }
    let designs = bench.designs("saltelli");
    assert_eq!(designs.rows.len(), 2048 * 4);
    for (row, height) in designs
        .rows
        .iter()
        .zip(designs.numbers("wheel_centre_z_design_mm"))
    {
        let [a, b] = [&row[1], &row[2]].map(|cell| cell.parse::<f64>().unwrap());
        assert!((height - (300.0 + a + 2.0 * b)).abs() < 1e-12);
    }
}
