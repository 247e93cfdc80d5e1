//! Sweeps as a user meets them: the same bytes however they are run, answers known beforehand found,
//! failures counted, mistakes named.

use assert_cmd::Command;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

/// A strut with two travels to be quick, and a sweep of two coordinates of its tie rod.
const STUDY: &str = r#"[suspension]
topology = "macpherson"

[suspension.hardpoints]
lower_arm_front  = [ 120.0, 360.0, 195.0]
lower_arm_rear   = [-260.0, 350.0, 205.0]
lower_ball_joint = [   5.0, 705.0, 190.0]
strut_top        = [ -35.0, 575.0, 850.0]
strut_lower      = [ -11.0, 623.0, 370.0]
tie_rod_inner    = [-110.0, 330.0, 243.0]
tie_rod_outer    = [-130.0, 690.0, 240.0]
wheel_centre     = [   0.0, 760.0, 300.0]
spindle_inner    = [  -0.2, 660.0, 299.1]

[motion]
travel = [-60.0, -20.0, 20.0, 60.0]

[outputs]
characteristics = ["camber", "toe"]

[sweep]
method = "latin_hypercube"
samples = 700
seed = 3
curves = true
variables = [
  { hardpoint = "tie_rod_inner", axis = "z", range = [-10.0, 10.0] },
  { hardpoint = "strut_top", axis = "y", range = [-20.0, 20.0] },
]

[optimise]
variables = [ { hardpoint = "tie_rod_inner", axis = "z", range = [-10.0, 10.0] } ]
targets = [
  { characteristic = "toe", points = [[-60.0, 0.1], [60.0, 0.1]], tolerance = 0.01 },
  { characteristic = "camber", at = 0.0, value = -0.5, tolerance = 0.05 },
]
"#;

/// A directory with a study, to run in.
struct Bench(tempfile::TempDir);

impl Bench {
    fn new(study: &str) -> Self {
        let directory = tempfile::tempdir().unwrap();
        fs::write(directory.path().join("study.toml"), study).unwrap();
        Bench(directory)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn run(&self, arguments: &[&str]) -> assert_cmd::assert::Assert {
        let mut command = Command::cargo_bin("hardpoint").unwrap();
        command.current_dir(self.0.path()).args(arguments).assert()
    }

    fn sweep(&self, out: &str, more: &[&str]) -> assert_cmd::assert::Assert {
        self.run(&[&["sweep", "study.toml", "--out", out], more].concat())
    }

    fn json(&self, name: &str) -> Value {
        serde_json::from_slice(&fs::read(self.path(name)).unwrap()).unwrap()
    }

    fn designs(&self, out: &str) -> Table {
        Table::read(&self.path(out).join("designs.csv"))
    }

    /// Every file of one run is in the other, byte by byte.
    fn assert_same(&self, one: &str, other: &str) {
        let names = |run: &str| {
            let entries = fs::read_dir(self.path(run)).unwrap();
            let mut names: Vec<_> = entries.map(|e| e.unwrap().file_name()).collect();
            names.sort();
            names
        };
        assert_eq!(names(one), names(other));
        assert!(names(one).len() >= 4);
        for name in names(one) {
            let read = |run: &str| fs::read(self.path(run).join(&name)).unwrap();
            assert!(read(one) == read(other), "{name:?} of {one} and {other}");
        }
    }
}

struct Table {
    header: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    fn read(path: &Path) -> Self {
        let mut reader = csv::Reader::from_path(path).unwrap();
        let header = reader
            .headers()
            .unwrap()
            .iter()
            .map(str::to_owned)
            .collect();
        let rows = reader
            .records()
            .map(|r| r.unwrap().iter().map(str::to_owned).collect());
        Table {
            header,
            rows: rows.collect(),
        }
    }

    fn text(&self, column: &str) -> Vec<&str> {
        let k = self.header.iter().position(|n| n == column);
        let k = k.unwrap_or_else(|| panic!("{column} in {:?}", self.header));
        self.rows.iter().map(|row| row[k].as_str()).collect()
    }

    fn numbers(&self, column: &str) -> Vec<f64> {
        self.text(column)
            .iter()
            .map(|c| c.parse().unwrap())
            .collect()
    }
}

fn said(assert: &assert_cmd::assert::Assert) -> (String, String) {
    let output = assert.get_output();
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
    (text(&output.stdout), text(&output.stderr))
}

/// The summary's entry of an output column.
fn output<'a>(summary: &'a Value, column: &str) -> &'a Value {
    let outputs = summary["outputs"].as_array().unwrap();
    outputs.iter().find(|o| o["column"] == column).unwrap()
}

#[test]
fn threads_and_shards_give_the_same_bytes() {
    let bench = Bench::new(STUDY);
    bench.sweep("one", &["--threads", "1"]).success();
    bench.sweep("three", &["--threads", "3"]).success();
    bench.assert_same("one", "three");
    // Six blocks of designs; more shards than blocks, so that some are empty.
    for shards in [2, 7] {
        let mut parts = Vec::new();
        for i in (1..=shards).rev() {
            let (part, shard) = (format!("part{i}of{shards}"), format!("{i}/{shards}"));
            bench.sweep(&part, &["--shard", &shard]).success();
            parts.push(part);
        }
        let mut arguments = vec!["merge", "--out", "merged"];
        arguments.extend(parts.iter().map(String::as_str));
        bench.run(&arguments).success();
        bench.assert_same("one", "merged");
    }
    let designs = bench.designs("one");
    assert_eq!(designs.rows.len(), 700);
    assert!(designs.text("status").iter().all(|s| *s == "ok"));
    let curves = Table::read(&bench.path("one/curves.csv"));
    assert_eq!(curves.rows.len(), 700 * 4);
}

/// Wherever it was torn, in rows or curves, at a row's end or within, a sweep goes on to the same bytes.
#[test]
fn a_torn_sweep_is_taken_up_again_to_the_same_bytes() {
    let bench = Bench::new(STUDY);
    bench.sweep("whole", &[]).success();
    let sizes = ["designs.csv", "curves.csv"].map(|name| {
        let contents = fs::read(bench.path("whole").join(name)).unwrap();
        (name, contents)
    });
    for (designs, curves) in [(0.5, 0.7), (0.9, 0.3), (1.0, 0.999), (0.02, 1.0)] {
        let torn = bench.path("torn");
        fs::create_dir_all(&torn).unwrap();
        fs::copy(bench.path("whole/sweep.json"), torn.join("sweep.json")).unwrap();
        for ((name, contents), share) in sizes.iter().zip([designs, curves]) {
            let length = (contents.len() as f64 * share) as usize;
            fs::write(torn.join(name), &contents[..length]).unwrap();
        }
        bench
            .sweep("torn", &["--resume", "--threads", "2"])
            .success();
        bench.assert_same("whole", "torn");
    }
    // A finished one is left as it is; one that was never begun is begun.
    bench.sweep("whole", &["--resume"]).success();
    bench.assert_same("whole", "torn");
    bench.sweep("begun", &["--resume"]).success();
    bench.assert_same("whole", "begun");
}

#[test]
fn only_the_same_sweep_is_taken_up_again() {
    let bench = Bench::new(STUDY);
    bench.sweep("run", &[]).success();
    let refused = |more: &[&str], phrase: &str| {
        let (_, error) = said(&bench.sweep("run", &[&["--resume"], more].concat()).code(2));
        assert!(error.contains("run") && error.contains(phrase), "{error}");
    };
    refused(&["--set", "sweep.seed=4"], "another study");
    refused(
        &[
            "--set",
            "suspension.hardpoints.strut_top=[-35.0, 575.0, 851.0]",
        ],
        "another study",
    );
    refused(&["--shard", "1/2"], "the whole sweep");
    // What the results do not depend on may change.
    let commented =
        format!("# A comment.\n{STUDY}").replace("\n[optimise]\n", "\n[optimise]\nstarts = 5\n");
    fs::write(bench.path("study.toml"), commented).unwrap();
    bench.sweep("run", &["--resume"]).success();
    // A file that someone has edited is not gone on with.
    let path = bench.path("run/designs.csv");
    let edited = fs::read_to_string(&path)
        .unwrap()
        .replacen("\n5,", "\n55,", 1);
    fs::write(&path, edited).unwrap();
    refused(&[], "design 5 ");
    let (_, error) = said(&bench.sweep("-", &["--resume"]).code(2));
    assert!(error.contains("--resume"), "{error}");
}

#[test]
fn only_whole_sweeps_are_merged() {
    let bench = Bench::new(STUDY);
    for i in ["1", "2", "3"] {
        bench.sweep(i, &["--shard", &format!("{i}/3")]).success();
    }
    bench
        .sweep("other", &["--shard", "3/3", "--set", "sweep.seed=9"])
        .success();
    let refused = |parts: &[&str], phrase: &str| {
        let arguments = [&["merge", "--out", "merged"], parts].concat();
        let (_, error) = said(&bench.run(&arguments).code(2));
        assert!(error.contains(phrase), "{parts:?}: {error}");
        assert!(!bench.path("merged").exists());
    };
    refused(&["1", "3"], "shard 2/3");
    refused(&["1", "2", "2", "3"], "the same shard, 2 of 3");
    refused(&["1", "2", "other"], "not a shard of the same sweep");
    refused(&["1", "2", "absent"], "no sweep.json");
    let path = bench.path("2/designs.csv");
    let contents = fs::read(&path).unwrap();
    fs::write(&path, &contents[..contents.len() / 2]).unwrap();
    refused(&["1", "2", "3"], "not finished");
    let arguments = ["merge", "--out", "1", "1", "3"];
    bench.run(&arguments).code(2);
}

/// Targets read off one point of a grid: that point is the best design, and the only one without a
/// better.
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
    // -4 is value 3 of the first variable, 12 is value 8 of the second, which runs faster.
    let best = &summary["best"][0];
    assert_eq!(best["design"], 3 * 11 + 8);
    assert_eq!(best["variables"], serde_json::json!([-4.0, 12.0]));
    assert!(best["misfit"].as_f64().unwrap() < 1e-8);
    assert!(summary["best"][1]["misfit"].as_f64().unwrap() > 0.1);
    assert_eq!(summary["pareto"], serde_json::json!([41]));
    assert_eq!(Table::read(&bench.path("run/pareto.csv")).rows.len(), 1);
    // The design as a study has the planted curves.
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

/// The misfit of a sweep is the one of the optimisation, and its summary the one of the curves.
#[test]
fn a_row_says_what_solve_and_optimise_say() {
    let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies/macpherson_front.toml");
    let study = fs::read_to_string(sample).unwrap();
    let bench = Bench::new(&(study + "\n[sweep]\ndesigns = \"rows.csv\"\n"));
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
    assert!((designs.numbers("misfit")[0] / misfit - 1.0).abs() < 1e-12);
    for target in summary["targets"].as_array().unwrap() {
        let name = target["output"].as_str().unwrap().trim_end_matches("_deg");
        let rms = target["before"]["rms"].as_f64().unwrap();
        assert!((designs.numbers(&format!("rms_{name}"))[0] / rms - 1.0).abs() < 1e-12);
    }
    let solved = Table::read(&bench.path("solved/curves.csv"));
    for (name, unit) in [("camber", "deg"), ("scrub_radius", "mm")] {
        let curve = solved.numbers(&format!("{name}_{unit}"));
        let min = curve.iter().copied().fold(f64::INFINITY, f64::min);
        let max = curve.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let found =
            ["min", "max", "design"].map(|w| designs.numbers(&format!("{name}_{w}_{unit}"))[0]);
        assert_eq!(found, [min, max, curve[20]]);
    }
    assert_eq!(designs.numbers("strut_top_dy_mm"), [0.0, 5.0]);
    assert_eq!(designs.numbers("tie_rod_inner_z_mm"), [243.0, 244.5]);
    assert_ne!(designs.rows[0], designs.rows[1]);
    // Nothing is known of how the rows came about, so there are no shares of variance.
    let summary = bench.json("run/summary.json");
    assert!(output(&summary, "misfit")["effects"][0]["share"].is_null());
}

/// The height of the wheel centre in the design position is a + 2 b with a over 6 and b over 4 mm: so
/// b has 16/25 of the variance, a 9/25.
#[test]
fn main_effects_of_a_linear_response_are_known() {
    let from = STUDY.find("[sweep]").unwrap();
    let study = STUDY[..from].replace("[outputs]", "[outputs]\npoints = [\"wheel_centre\"]")
        + r#"[sweep]
method = "grid"
samples = 2048
variables = [
  { hardpoint = "wheel_centre", axis = "z", range = [-3.0, 3.0], steps = 17 },
  { hardpoints = ["wheel_centre", "spindle_inner"], factors = [2.0, 1.0], axis = "z", range = [-2.0, 2.0], steps = 17, name = "b" },
]
"#;
    let bench = Bench::new(&study);
    // What chance leaves of each method.
    for (method, tolerance) in [
        ("grid", 1e-12),
        ("sobol", 0.02),
        ("latin_hypercube", 0.06),
        ("random", 0.06),
        ("saltelli", 0.02),
    ] {
        let set = format!("sweep.method={method}");
        bench.sweep(method, &["--set", &set]).success();
        let summary = bench.json(&format!("{method}/summary.json"));
        let height = output(&summary, "wheel_centre_z_design_mm");
        assert!(
            (height["r2"].as_f64().unwrap() - 1.0).abs() < 1e-10,
            "{method}: {height}"
        );
        for (effect, (change, share)) in height["effects"]
            .as_array()
            .unwrap()
            .iter()
            .zip([(6.0, 0.36), (8.0, 0.64)])
        {
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

/// Beyond the reach of some designs: they are counted by reason, keep what exists of them, and have
/// empty cells, never a range over a part of the motion.
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
    assert_eq!(reasons[0]["examples"][0], failed[0]);
    assert!(
        text.contains("unreachable") && text.contains("because"),
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
    // A design that is no mechanism at all: the arm's outer joint on its axis.
    let point =
        "lower_ball_joint_x,lower_ball_joint_y,lower_ball_joint_z\n120,360,195\n5,705,190\n";
    fs::write(bench.path("rows.csv"), point).unwrap();
    let from = STUDY.find("method = \"latin").unwrap();
    let to = STUDY.find("[optimise]").unwrap();
    let file = [&STUDY[..from], "designs = \"rows.csv\"\n", &STUDY[to..]].concat();
    fs::write(bench.path("study.toml"), file).unwrap();
    bench.sweep("flat", &[]).code(1);
    let designs = bench.designs("flat");
    assert_eq!(designs.text("status"), ["degenerate", "ok"]);
    assert!(designs.text("reason")[0].contains("lower_ball_joint"));
    assert_eq!(designs.text("camber_design_deg")[0], "");
    assert_eq!(designs.text("failed_at_mm")[0], "");
}

#[test]
fn mistakes_in_the_sweep_are_named() {
    let first = r#"{ hardpoint = "tie_rod_inner", axis = "z", range = [-10.0, 10.0] }"#;
    let cases: &[(&str, &str, &[&str])] = &[
        ("samples = 700\n", "", &["latin_hypercube", "samples"]),
        (
            "samples = 700",
            "samples = 0",
            &["at least 1", "samples", "from 1"],
        ),
        ("\"latin_hypercube\"", "\"lhs\"", &["lhs", "sweep.method"]),
        (
            "\"latin_hypercube\"",
            "\"grid\"",
            &["steps", "tie_rod_inner_dz"],
        ),
        (
            "curves = true",
            "curve = true",
            &["curve", "did you mean \"curves\"?"],
        ),
        ("curves = true", "format = \"xlsx\"", &["xlsx", "csv"]),
        (
            "curves = true",
            "designs = \"rows.csv\"",
            &["found both", "sweep.variables"],
        ),
        (
            first,
            r#"{ axis = "z", range = [-10.0, 10.0] }"#,
            &["expected hardpoint", "variables[0]"],
        ),
        (
            first,
            r#"{ hardpoint = "tie_rod_iner", axis = "z", range = [-1, 1] }"#,
            &["did you mean \"tie_rod_inner\"?"],
        ),
        (
            first,
            r#"{ hardpoint = "tie_rod_inner", axis = "w", range = [-1, 1] }"#,
            &["axis", "\"w\""],
        ),
        (
            first,
            r#"{ hardpoint = "tie_rod_inner", axis = "z", range = [1, -1] }"#,
            &["reversed", "range = [-1, 1]"],
        ),
        (
            first,
            r#"{ hardpoint = "tie_rod_inner", axis = "z", range = [1, 1] }"#,
            &["empty"],
        ),
        (
            first,
            r#"{ hardpoint = "tie_rod_inner", axis = "z", range = [1] }"#,
            &["two numbers"],
        ),
        (
            first,
            r#"{ hardpoint = "tie_rod_inner", axis = "z", range = [-1, 1], steps = 1 }"#,
            &["one step"],
        ),
        (
            first,
            r#"{ hardpoint = "strut_top", axis = "y", range = [-1, 1] }"#,
            &["strut_top_dy is already a variable"],
        ),
        (
            first,
            r#"{ hardpoint = "strut_top", axis = "y", range = [570, 580], absolute = true }"#,
            &["set by one variable and moved by another"],
        ),
        (
            first,
            r#"{ hardpoint = "strut_top", hardpoints = ["tie_rod_inner"], axis = "y", range = [-1, 1] }"#,
            &["found both"],
        ),
        (
            first,
            r#"{ hardpoints = ["tie_rod_inner", "tie_rod_outer"], factors = [1], axis = "z", range = [-1, 1] }"#,
            &["factor for each of the 2", "found 1"],
        ),
        (
            first,
            r#"{ hardpoints = ["tie_rod_inner", "tie_rod_inner"], axis = "z", range = [-1, 1] }"#,
            &["listed twice"],
        ),
        (
            first,
            r#"{ hardpoints = ["tie_rod_inner"], axis = "z", range = [1, 2], absolute = true }"#,
            &["given by an offset"],
        ),
        (
            first,
            r#"{ hardpoint = "tie_rod_inner", axis = "z", range = [-1, 1], name = "a,b" }"#,
            &["letters", "a,b"],
        ),
        (
            first,
            r#"{ hardpoint = "tie_rod_inner", axis = "z", range = [-1, 1], name = "failed_at" }"#,
            &["two columns", "failed_at_mm"],
        ),
        (
            "travel = [-60.0, -20.0, 20.0, 60.0]",
            "drive = \"paper_theta\"\ntheta = [90.0]",
            &["paper_theta", "[sweep]"],
        ),
        (
            "[motion]",
            "[solver]\nformulation = \"point_coordinates\"\n[motion]",
            &["knuckle_pose", "[sweep]"],
        ),
    ];
    for (from, to, phrases) in cases {
        assert!(STUDY.contains(from), "{from}");
        let mut study = STUDY.replacen(from, to, 1);
        if to.contains("theta") || to.contains("solver") {
            // [optimise] has its own objections.
            study.truncate(study.find("[optimise]").unwrap());
        }
        let bench = Bench::new(&study);
        let (_, error) = said(&bench.run(&["sweep", "study.toml"]).code(2));
        assert!(error.contains("study.toml"), "{to}: {error}");
        let some = |phrase: &&&str| error.contains(**phrase);
        // "samples = 0" may be said either way.
        let least = if to.contains("= 0") { 2 } else { phrases.len() };
        assert!(
            phrases.iter().filter(some).count() >= least,
            "{to}: {error}"
        );
        assert!(!bench.path("out").exists());
    }
    let bench = Bench::new(&STUDY[..STUDY.find("[sweep]").unwrap()]);
    let (_, error) = said(&bench.run(&["sweep", "study.toml"]).code(2));
    assert!(error.contains("[sweep]"), "{error}");
    let file = "[sweep]\ndesigns = \"absent.csv\"\n";
    let bench = Bench::new(&(STUDY[..STUDY.find("[sweep]").unwrap()].to_owned() + file));
    let (_, error) = said(&bench.run(&["sweep", "study.toml"]).code(2));
    assert!(error.contains("absent.csv"), "{error}");
    // The same study is still to be solved.
    bench.run(&["solve", "study.toml"]).success();
}

#[test]
fn the_designs_alone_go_to_standard_output() {
    let bench = Bench::new(STUDY);
    bench.sweep("run", &[]).success();
    let (out, error) = said(&bench.sweep("-", &[]).success());
    assert_eq!(
        out,
        fs::read_to_string(bench.path("run/designs.csv")).unwrap()
    );
    assert!(error.contains("700 designs, all solved"), "{error}");
}
