//! Mistakes are named, and nothing is written.

use super::*;

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
fn mistakes_in_the_rows_of_designs_are_named() {
    let (from, to) = ("method = \"latin_hypercube\"", "\n[optimise]");
    let [from, to] = [from, to].map(|text| STUDY.find(text).unwrap());
    let study = [&STUDY[..from], "designs = \"rows.csv\"\n", &STUDY[to..]].concat();
    let bench = Bench::new(&study);
    for (rows, phrases) in [
        (
            "tie_rod_inner_z\n1e13\n",
            &[
                "rows.csv:2",
                "a number between -1e12 and 1e12 as tie_rod_inner_z",
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
        ("tie_rod_inner_z\n", &["rows.csv", "found none"]),
        ("tie_rod_iner_z\n1\n", &["rows.csv:1", "tie_rod_inner"]),
        ("tie_rod_inner_z,tie_rod_inner_z\n1,1\n", &["there twice"]),
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
