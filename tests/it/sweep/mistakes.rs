//! Tests that sweeps name mistakes in their input, and write nothing.

use super::*;
use hardpoint::study::Study;

#[test]
fn only_the_same_sweep_is_taken_up_again() {
    let bench = Bench::new(STUDY);
    bench.sweep("run", &[]).success();
    let refused = |more: &[&str], phrase: &str| {
        let (_, error) = said(&bench.sweep("run", more).code(2));
        assert!(error.contains("run") && error.contains(phrase), "{error}");
    };
    refused(&["--resume", "--set", "sweep.seed=4"], "another study");
    let moved = "suspension.hardpoints.strut_top=[-35.0, 575.0, 851.0]";
    refused(&["--resume", "--set", moved], "another study");
    // Before a run is resumed, entries of the study that do not affect the results may change.
    let commented =
        format!("# A comment.\n{STUDY}").replace("\n[optimise]\n", "\n[optimise]\nstarts = 5\n");
    fs::write(bench.path("study.toml"), commented).unwrap();
    bench.sweep("run", &["--resume"]).success();
    // If someone has edited a result file, the program refuses to resume the run.
    let path = bench.path("run/designs.csv");
    let written = fs::read_to_string(&path).unwrap();
    fs::write(&path, written.replacen("\n5,", "\n55,", 1)).unwrap();
    refused(&["--resume"], "designs.csv: changed since it was written");
    // The program also detects an edit that keeps the length.
    let row = written.lines().nth(6).unwrap();
    let digit = row.rfind(['1', '2', '3']).unwrap();
    let edited = format!("{}4{}", &row[..digit], &row[digit + 1..]);
    fs::write(&path, written.replacen(row, &edited, 1)).unwrap();
    refused(&["--resume"], "designs.csv: changed since it was written");
    let (_, error) = said(&bench.run(&["merge", "--out", "merged", "run"]).code(2));
    assert!(error.contains("another checksum"), "{error}");
    let (_, error) = said(&bench.sweep("-", &["--resume"]).code(2));
    assert!(error.contains("--resume"), "{error}");
    bench.sweep("run", &["--force"]).success();
    assert_eq!(fs::read_to_string(&path).unwrap(), written);
    // The program does not restart an unfinished sweep unless the user requests it.
    let manifest = bench.path("run/run.json");
    let ended = fs::read_to_string(&manifest).unwrap();
    let begun = ended.replace("\"finished\": true", "\"finished\": false");
    fs::write(&manifest, begun).unwrap();
    fs::remove_file(&path).unwrap();
    refused(&[], "unfinished sweep");
    bench.sweep("run", &["--resume"]).success();
    assert_eq!(fs::read_to_string(&manifest).unwrap(), ended);
    assert_eq!(fs::read_to_string(&path).unwrap(), written);
}

/// A shard of a sweep with another name, without a ranking, or without a remark on constraints does not delete the results of
/// other shards.
#[test]
fn shards_of_other_sweeps_delete_nothing() {
    let bench = Bench::new(STUDY);
    let unchecked = [
        "--set",
        "optimise.constraints=[{ length = \"tie_rod\", at_most = 360.6 }]",
        "--set",
        "sweep.constraints=false",
    ];
    let shard = |study: &str, shard: &str, more: &[&str]| {
        let arguments = ["sweep", study, "--out", "run", "--shard", shard];
        bench.run(&[&arguments[..], more].concat())
    };
    shard("study.toml", "2/2", &unchecked).success();
    let written = fs::read(bench.path("run/designs.csv")).unwrap();
    fs::copy(bench.path("study.toml"), bench.path("copy.toml")).unwrap();
    let fit = [&unchecked[..], &["--set", "optimise.fit=true"]].concat();
    for (study, more) in [
        ("copy.toml", &unchecked[..]),
        ("study.toml", &fit[..]),
        ("study.toml", &[][..]),
    ] {
        let (_, error) = said(&shard(study, "1/2", more).code(2));
        assert!(error.contains("which would be lost"), "{error}");
        assert_eq!(fs::read(bench.path("run/designs.csv")).unwrap(), written);
    }
    shard("study.toml", "1/2", &unchecked).success();
}

/// A sweep does not compute lengths, plunges, joint angles and clearances. A note names these keys.
#[test]
fn keys_that_a_sweep_ignores_are_named() {
    let bench = Bench::new(STUDY);
    let lengths = "outputs.lengths=[\"tie_rod\"]";
    let (_, said) = said(&bench.sweep("run", &["--set", lengths]).success());
    let said = crate::support::one_line(&said);
    let note = "A sweep ignores lengths, plunges, articulations and clearances of [outputs]";
    assert!(said.contains(note), "{said}");
}

#[test]
fn only_whole_sweeps_are_merged() {
    let bench = Bench::new(STUDY);
    for (name, seed) in [("run", "sweep.seed=3"), ("other", "sweep.seed=9")] {
        bench.sweep(name, &["--set", seed]).success();
    }
    let refused = |parts: &[&str], phrase: &str| {
        let arguments = [&["merge", "--out", "merged"], parts].concat();
        let (_, error) = said(&bench.run(&arguments).code(2));
        assert!(error.contains(phrase), "{parts:?}: {error}");
        assert!(!bench.path("merged").exists());
    };
    refused(&["run", "other"], "not of the same sweep");
    refused(&["run", "absent"], "no sweep.json");
    bench.run(&["merge", "--out", "run", "run"]).code(2);
    let path = bench.path("run/designs.csv");
    let contents = fs::read(&path).unwrap();
    fs::write(&path, &contents[..contents.len() / 2]).unwrap();
    refused(&["run"], "changed since it was written");
    fs::remove_file(&path).unwrap();
    refused(&["run"], "1 of 1 parts are missing");
}

/// A sweep with `samples` and without `method` is a Sobol sweep. With `steps`, it stays a grid, which has no `samples`.
#[test]
fn samples_without_a_method_are_sobol_samples() {
    let read = |text: &str| Study::from_text("study.toml", text, Path::new("."));
    let method = "method = \"latin_hypercube\"\n";
    assert_eq!(STUDY.matches(method).count(), 1);
    let without = STUDY.replace(method, "");
    let sobol = STUDY.replace("latin_hypercube", "sobol");
    let [found, expected] = [&without, &sobol].map(|text| read(text).unwrap().sweep);
    assert_eq!(found, expected);
    let with_steps = without.replace(
        "range = [-20.0, 20.0] }",
        "range = [-20.0, 20.0], steps = 3 }",
    );
    assert_ne!(with_steps, without);
    let message = read(&with_steps).unwrap_err().to_string();
    assert!(
        message.contains("\"samples\" is not available for a grid"),
        "{message}"
    );
}

/// Replaces `from` in the study by `to`. Asserts that the sweep names the file and these phrases, and writes nothing.
fn assert_mistake(from: &str, to: &str, phrases: &[&str]) {
    assert!(STUDY.contains(from), "{from}");
    let mut study = STUDY.replacen(from, to, 1);
    if to.contains("theta") || to.contains("solver") {
        // `[optimise]` would be refused for other reasons, so the study omits it.
        study.truncate(study.find("[optimise]").unwrap());
    }
    let bench = Bench::new(&study);
    let (_, error) = said(&bench.run(&["sweep", "study.toml"]).code(2));
    assert!(error.contains("study.toml"), "{to}: {error}");
    for phrase in phrases {
        assert!(error.contains(phrase), "{to} lacks {phrase:?}: {error}");
    }
    assert!(!bench.path("out").exists());
}

#[test]
fn mistakes_in_the_sweep_are_named() {
    for (from, to, phrases) in [
        ("samples = 700\n", "", &["latin_hypercube", "samples"][..]),
        (
            "samples = 700",
            "samples = 0",
            &["sweep.samples: expected from 1 to", "found 0"],
        ),
        ("\"latin_hypercube\"", "\"lhs\"", &["lhs", "sweep.method"]),
        (
            "\"latin_hypercube\"",
            "\"grid\"",
            &["steps", "tie_rod_inner_dz", "not available for a grid"],
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
            "travel = [-60.0, -20.0, 20.0, 60.0]",
            "drive = \"paper_theta\"\ntheta = [90.0]",
            &["paper_theta", "[sweep]"],
        ),
        (
            "[motion]",
            "[solver]\nformulation = \"point_coordinates\"\n[motion]",
            &["knuckle_pose", "[sweep]"],
        ),
    ] {
        assert_mistake(from, to, phrases);
    }
}

#[test]
fn mistakes_in_the_variables_of_a_sweep_are_named() {
    let first = r#"{ hardpoint = "tie_rod_inner", axis = "z", range = [-10.0, 10.0] }"#;
    for (to, phrases) in [
        (
            r#"{ axis = "z", range = [-10.0, 10.0] }"#,
            &["expected the key \"hardpoint\"", "variables[0]"][..],
        ),
        (
            r#"{ hardpoint = "tie_rod_iner", axis = "z", range = [-1, 1] }"#,
            &["did you mean \"tie_rod_inner\"?"],
        ),
        (
            r#"{ hardpoint = "tie_rod_inner", axis = "w", range = [-1, 1] }"#,
            &["axis", "\"w\""],
        ),
        (
            r#"{ hardpoint = "tie_rod_inner", axis = "z", range = [1, -1] }"#,
            &["reversed", "range = [-1, 1]"],
        ),
        (
            r#"{ hardpoint = "tie_rod_inner", axis = "z", range = [1, 1] }"#,
            &["empty"],
        ),
        (
            r#"{ hardpoint = "tie_rod_inner", axis = "z", range = [1] }"#,
            &["two numbers"],
        ),
        (
            r#"{ hardpoint = "tie_rod_inner", axis = "z", range = [-1, 1], steps = 1 }"#,
            &["one step"],
        ),
        (
            r#"{ hardpoint = "strut_top", axis = "y", range = [-1, 1] }"#,
            &["strut_top_dy is already a variable"],
        ),
        (
            r#"{ hardpoint = "strut_top", axis = "y", range = [570, 580], absolute = true }"#,
            &["another variable moves it"],
        ),
        (
            r#"{ hardpoint = "strut_top", hardpoints = ["tie_rod_inner"], axis = "y", range = [-1, 1] }"#,
            &["found both"],
        ),
        (
            r#"{ hardpoints = ["tie_rod_inner", "tie_rod_outer"], factors = [1], axis = "z", range = [-1, 1] }"#,
            &["factor for each of the 2", "found 1"],
        ),
        (
            r#"{ hardpoints = ["tie_rod_inner", "tie_rod_inner"], axis = "z", range = [-1, 1] }"#,
            &["listed twice"],
        ),
        (
            r#"{ hardpoints = ["tie_rod_inner"], axis = "z", range = [1, 2], absolute = true }"#,
            &["have offsets, not coordinates"],
        ),
        (
            r#"{ hardpoint = "tie_rod_inner", axis = "z", range = [-1, 1], name = "a,b" }"#,
            &["letters", "a,b"],
        ),
        (
            r#"{ hardpoint = "tie_rod_inner", axis = "z", range = [-1, 1], name = "failed_at" }"#,
            &["two columns", "failed_at_mm"],
        ),
    ] {
        assert_mistake(first, to, phrases);
    }
}

#[test]
fn a_sweep_without_designs_is_refused() {
    let bench = Bench::new(&STUDY[..STUDY.find("[sweep]").unwrap()]);
    let (_, error) = said(&bench.run(&["sweep", "study.toml"]).code(2));
    assert!(error.contains("[sweep]"), "{error}");
    let file = "[sweep]\ndesigns = \"absent.csv\"\n";
    let bench = Bench::new(&(STUDY[..STUDY.find("[sweep]").unwrap()].to_owned() + file));
    let (_, error) = said(&bench.run(&["sweep", "study.toml"]).code(2));
    let named = ": sweep.designs: cannot read absent.csv: the file does not exist";
    assert!(
        error.starts_with("error: study, line ") && error.contains(named),
        "{error}"
    );
    // `solve` still accepts the same study.
    bench.run(&["solve", "study.toml"]).success();
}

#[test]
fn mistakes_in_the_rows_of_designs_are_named() {
    let bench = Bench::new(&study_of_file("rows.csv"));
    for (rows, phrases) in [
        (
            "tie_rod_inner_z\n1e13\n",
            &[
                "rows.csv:2",
                "a number with a magnitude of at most 1e12 as tie_rod_inner_z",
                "1e13",
            ][..],
        ),
        (
            "tie_rod_inner_z\n243\ninf\n",
            &["rows.csv:3", "a finite number"],
        ),
        (
            "tie_rod_inner_z\n243,1\n",
            &["rows.csv:2", "expected 1 value"],
        ),
        ("tie_rod_inner_z\n", &["rows.csv", "a row for each design"]),
        ("tie_rod_iner_z\n1\n", &["rows.csv:1", "tie_rod_inner"]),
        ("tie_rod_inner_z,tie_rod_inner_z\n1,1\n", &["occurs twice"]),
    ] {
        fs::write(bench.path("rows.csv"), rows).unwrap();
        let (_, error) = said(&bench.sweep("run", &[]).code(2));
        for phrase in phrases {
            assert!(error.contains(phrase), "{rows:?}: {error}");
        }
        assert!(!bench.path("run").exists());
    }
}

#[test]
fn what_a_sweep_leaves_to_solve_is_said() {
    let bench = Bench::new(STUDY);
    let few = ["--set", "sweep.samples=10"];
    let (_, error) = said(&bench.sweep("plain", &few).success());
    assert!(!error.contains("hardpoint solve"), "{error}");
    let asked = [
        "--set",
        "outputs.certify=true",
        "--set",
        "outputs.order=velocity",
    ];
    let certified = [&few[..], &asked[..2]].concat();
    let (_, error) = said(&bench.sweep("more", &certified).success());
    assert!(error.contains("certify of [outputs]"), "{error}");
    let (_, error) = said(&bench.sweep("most", &[&few[..], &asked].concat()).success());
    assert!(error.contains("order, certify of [outputs]"), "{error}");
}

/// A sweep without outputs is refused, also by `check`. A sweep with points as its only outputs is accepted.
#[test]
fn a_sweep_of_nothing_is_refused() {
    let study = &STUDY[..STUDY.find("[optimise]").unwrap()];
    for outputs in [
        "characteristics = []",
        "",
        "characteristics = []\norder = \"velocity\"",
    ] {
        let bench = Bench::new(&study.replace("characteristics = [\"camber\", \"toe\"]", outputs));
        for command in ["check", "sweep"] {
            let (_, error) = said(&bench.run(&[command, "study.toml"]).code(2));
            assert!(
                error.contains("nothing to write for each design"),
                "{error}"
            );
        }
        let points = ["--set", "outputs.points=[\"wheel_centre\"]"];
        bench.sweep("run", &points).success();
        assert_eq!(bench.designs("run").header[3], "wheel_centre_x_min_mm");
    }
}

/// The target ranks no designs, because it is a measurement. So the results would have no values.
#[test]
fn a_fit_without_outputs_is_refused() {
    let bench = Bench::new(STUDY);
    let target =
        "optimise.targets=[{ length = \"tie_rod\", at = 0.0, value = 360.0, tolerance = 1.0 }]";
    let more = ["--set", "outputs.characteristics=[]", "--set", target];
    let more = [&more[..], &["--set", "optimise.fit=true"]].concat();
    let (_, error) = said(&bench.sweep("run", &more).code(2));
    for phrase in ["study.toml", "[sweep]", "nothing to write for each design"] {
        assert!(error.contains(phrase), "{error}");
    }
}

/// A sweep contains no infinite numbers: the program refuses tolerances that are smaller than the rounding errors of
/// values.
#[test]
fn tolerances_below_rounding_are_refused() {
    let bench = Bench::new(&STUDY.replace("tolerance = 0.01", "tolerance = 1e-300"));
    let (_, error) = said(&bench.run(&["sweep", "study.toml"]).code(2));
    assert!(
        error.contains("tolerance") && error.contains("1e-12"),
        "{error}"
    );
    let bench = Bench::new(&STUDY.replace("tolerance = 0.01", "tolerance = 1e-12"));
    bench.sweep("run", &[]).success();
    assert!(!bench.designs("run").text("misfit").contains(&"inf"));
    bench.run(&["report", "run"]).success();
}

/// The program refuses to read endless files.
#[cfg(unix)]
#[test]
fn devices_are_no_inputs() {
    let bench = Bench::new(STUDY);
    let target =
        "optimise.targets=[{characteristic=\"camber\", file=\"/dev/zero\", tolerance=1.0}]";
    for command in ["solve", "sweep"] {
        let call = [command, "study.toml", "--set", target];
        let (_, error) = said(&bench.run(&call).code(2));
        assert!(error.contains("/dev/zero: it is a device"), "{error}");
    }
    let (_, error) = said(&bench.run(&["solve", "/dev/zero"]).code(2));
    assert!(error.contains("it is a device"), "{error}");
    fs::write(bench.path("study.toml"), study_of_file("/dev/zero")).unwrap();
    let (_, error) = said(&bench.run(&["sweep", "study.toml"]).code(2));
    assert!(error.contains("it is a device"), "{error}");
}

/// Only two designs of every group of Saltelli's samples are independent. The statistics use only these two designs,
/// and the program reports this.
#[test]
fn it_is_said_which_designs_statistics_are_of() {
    let bench = Bench::new(STUDY);
    let few = [
        "--set",
        "sweep.samples=50",
        "--set",
        "sweep.method=saltelli",
    ];
    let (text, _) = said(&bench.sweep("run", &few).success());
    assert!(
        text.contains("refer to the 100 designs of the two independent"),
        "{text}"
    );
    let summary = bench.json("run/summary.json");
    assert_eq!(
        (&summary["done"], &summary["statistics_designs"]),
        (&200.into(), &100.into())
    );
    assert_eq!(output(&summary, "camber_min_deg")["count"], 200);
}

/// The program starts at most as many CPU threads as there are cores and blocks, and reports this.
#[test]
fn threads_are_no_more_than_help() {
    let bench = Bench::new(STUDY);
    let begun = std::time::Instant::now();
    let (_, error) = said(&bench.sweep("run", &["--threads", "10000"]).success());
    assert!(error.contains("of the 10000 requested threads"), "{error}");
    assert!(begun.elapsed().as_secs() < 30);
}

/// All designs of a Latin hypercube depend on their number. The program explains this if a run is resumed with another number.
#[test]
fn a_latin_hypercube_is_not_extended() {
    let bench = Bench::new(STUDY);
    let sweep = |samples: &str, more: &[&str]| {
        let samples = format!("sweep.samples={samples}");
        let method = "sweep.method=\"latin_hypercube\"";
        bench.sweep(
            "run",
            &[&["--set", method, "--set", samples.as_str()], more].concat(),
        )
    };
    sweep("20", &[]).success();
    sweep("20", &["--resume"]).success();
    for samples in ["40", "10"] {
        let (_, error) = said(&sweep(samples, &["--resume"]).code(2));
        let expected =
            format!("run has a Latin hypercube of 20 designs, but the study has one of {samples}");
        assert!(
            crate::support::one_line(&error).contains(&expected),
            "{error}"
        );
    }
}
