//! Tests of faulty study files: the program solves a file, or refuses it with a reason that names file and line.
//!
//! `corpus/` contains difficult studies, each with the expected result. In addition, a generator damages the sample
//! studies: it deletes, duplicates and swaps lines, replaces numbers by unusual ones, truncates files and inserts
//! unusual characters. `CASES=5000 cargo test --test it study_files::` tries more cases.

use crate::support::mutants::mutilated;
use crate::support::random::Random;
use hardpoint::axle::axle_curves;
use hardpoint::curves::curves;
use hardpoint::plan::Plan;
use hardpoint::report::{SolveSummary, curves_csv, sensitivities_csv};
use hardpoint::solve::StationOrder;
use hardpoint::study::{AxleStudy, Study, StudyErrors, Vehicle};
use std::collections::BTreeSet;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

fn directory(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

/// File, line of the first mistake, and a phrase of the message.
const CORPUS: &[(&str, usize, &str)] = &[
    ("ball_joint_on_arm_axis", 10, "the arm cannot move it"),
    (
        "solver_accuracy",
        22,
        "poses always have full double precision",
    ),
    (
        "certify_paper_theta",
        23,
        "no certificates for the drive \"paper_theta\"",
    ),
    (
        "certify_point_coordinates",
        25,
        "certify is not available for the formulation in point coordinates",
    ),
    (
        "coordinate_1e300",
        10,
        "expected a number with a magnitude of at most 1e12, found 1e300",
    ),
    (
        "coordinate_infinite",
        10,
        "expected a finite number, found -inf",
    ),
    (
        "coordinate_missing",
        10,
        "expected three coordinates [x, y, z], found 2",
    ),
    ("coordinate_nan", 10, "expected a finite number, found nan"),
    (
        "coordinate_overflows",
        10,
        "floating-point number overflowed",
    ),
    ("cyrillic_letter", 11, "invalid unquoted key"),
    (
        "every_point_the_same",
        8,
        "the lower arm would have no length",
    ),
    ("nested_arrays", 10, "max recursion depth"),
    ("point_twice", 12, "duplicate key"),
    ("points_coincide", 14, "the tie rod would have no length"),
    ("polynomial_explodes", 19, "grows beyond 1e12"),
    ("range_backwards_to_itself", 19, "the range is empty"),
    ("section_twice", 20, "duplicate key"),
    (
        "steps_a_billion",
        19,
        "expected from 1 to 100000, found 1000000000",
    ),
    ("steps_a_fraction", 19, "expected a whole number, found 2.5"),
    (
        "steps_huge",
        19,
        "expected a whole number, found 99999999999999999999\n",
    ),
    ("steps_negative", 19, "expected from 1 to 100000, found -5"),
    (
        "strut_points_coincide",
        11,
        "the strut would have no length",
    ),
    ("travel_infinite", 19, "expected a finite number, found inf"),
    ("truncated_in_a_string", 5, "invalid basic string"),
    ("truncated_in_an_array", 11, "unclosed array"),
    ("zero_byte", 3, "invalid basic string"),
];
/// Files that the program refuses as a whole.
const UNREADABLE: &[(&str, &str)] = &[
    ("empty", "the file is empty"),
    ("byte_not_utf8", "line 3 is not UTF-8 text"),
];
/// Unusual but valid files.
const SOUND: &[&str] = &["byte_order_mark", "carriage_returns"];

fn corpus(name: &str) -> PathBuf {
    directory("tests/corpus").join(format!("{name}.toml"))
}

fn refused(name: &str) -> StudyErrors {
    match Study::read(&corpus(name), &[]) {
        Ok(_) => panic!("{name} is accepted"),
        Err(errors) => errors,
    }
}

#[test]
fn nasty_studies_are_refused_by_line() {
    for (name, line, phrase) in CORPUS {
        let errors = refused(name);
        let first = &errors.all()[0];
        let text = first.to_string() + "\n";
        assert!(text.contains(phrase), "{name}: {text}");
        assert!(text.contains(&format!("{name}.toml:{line}:")), "{text}");
    }
    for (name, phrase) in UNREADABLE {
        let text = refused(name).to_string();
        assert!(text.contains(phrase), "{text}");
        assert!(text.contains(&format!("{name}.toml")), "{text}");
    }
    for name in SOUND {
        let study = Study::read(&corpus(name), &[]).unwrap_or_else(|e| panic!("{e}"));
        judge(&study);
    }
}

#[test]
fn the_whole_corpus_is_tested() {
    let stem = |path: PathBuf| path.file_stem().unwrap().to_str().unwrap().to_owned();
    let files = fs::read_dir(directory("tests/corpus")).unwrap();
    let files: BTreeSet<_> = files.map(|f| stem(f.unwrap().path())).collect();
    let listed = CORPUS.iter().map(|(name, ..)| *name);
    let listed = listed.chain(UNREADABLE.iter().map(|(name, _)| *name));
    let listed: BTreeSet<_> = listed
        .chain(SOUND.iter().copied())
        .map(str::to_owned)
        .collect();
    assert_eq!(files, listed);
}

/// Solves an axle in its design position. Returns true if the study has a design position to solve.
fn judge_axle(both: &AxleStudy) -> bool {
    match axle_curves(&both.axle, &both.plan.at_design()) {
        Ok(found) => found.curves.stations[0].status.word() == "ok",
        Err(fault) => {
            assert!(!both.axle.describe_fault(fault).is_empty());
            false
        }
    }
}

/// Solves a study with a few of its stations, and checks all results. Returns true if the study has something to solve.
fn judge(study: &Study) -> bool {
    let own = match &study.vehicle {
        Vehicle::Wheel(own) => own,
        Vehicle::Axle(both) => return judge_axle(both),
    };
    let whole = Plan::of(own);
    assert!(!whole.effects(study).is_empty());
    let thinned = |values: &[f64]| -> Vec<f64> {
        let step = values.len().div_ceil(5);
        values.iter().copied().step_by(step).collect()
    };
    let plan = Plan {
        station_order: StationOrder::through(&thinned(whole.station_order.values())),
        racks: thinned(&whole.racks),
        // The motion has fewer stations now, so the times of the stations are removed.
        time: None,
        ..whole
    };
    let suspension = study.wheel();
    let mechanism = &suspension.mechanism;
    hardpoint::attia::register();
    let found = match curves(suspension, &plan) {
        Ok(found) => found,
        Err(fault) => {
            assert!(!fault.describe(mechanism).is_empty());
            return false;
        }
    };
    let summary = serde_json::to_string(&SolveSummary::of(study, &found, None)).unwrap();
    let tables = [
        curves_csv(&found),
        sensitivities_csv(study, &found),
        summary.into_bytes(),
    ];
    for table in tables {
        let text = String::from_utf8(table).unwrap();
        for cell in text.split([',', '\n', ':', '}']) {
            let number: Option<f64> = cell.trim().parse().ok();
            assert!(number.is_none_or(f64::is_finite), "{cell}");
        }
    }
    for station in &found.stations {
        assert!(station.values.iter().flatten().all(|v| v.is_finite()));
        assert!(!station.status.word().is_empty());
    }
    found.failed() < found.stations.len()
}

#[test]
fn mutilated_studies_are_solved_or_refused_with_a_reason() {
    mutilate(100);
}

#[test]
#[ignore = "CASES times as many studies as there are, by default 3,000, take minutes"]
fn many_mutilated_studies_are_solved_or_refused_with_a_reason() {
    mutilate(std::env::var("CASES").map_or(3_000, |text| text.parse().unwrap()));
}

fn mutilate(cases: u64) {
    let mut paths: Vec<_> = fs::read_dir(directory("studies"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect();
    paths.sort();
    let (mut solved, mut refused, mut faulty) = (0, 0, 0);
    for (sample, path) in paths.iter().enumerate() {
        let text = fs::read_to_string(path).unwrap();
        for case in 0..cases {
            let mut random = Random(case + 1_000_000 * sample as u64);
            let text = mutilated(&text, &mut random);
            let outcome = catch_unwind(AssertUnwindSafe(|| {
                match Study::from_text("study.toml", &text, &directory("studies")) {
                    Ok(study) => {
                        if judge(&study) {
                            solved += 1
                        } else {
                            faulty += 1
                        }
                    }
                    Err(errors) => {
                        refused += 1;
                        assert!(!errors.all().is_empty());
                        for error in errors.all() {
                            let said = error.to_string();
                            assert!(
                                said.starts_with("error: ") && said.contains("study.toml"),
                                "{said}"
                            );
                            // The message names no line if the file is empty or lacks a required section.
                            let whole = ["is empty", "missing"];
                            let lineless = whole.iter().any(|phrase| said.contains(phrase));
                            assert!(error.position().is_some() || lineless, "{said}");
                        }
                    }
                }
            }));
            if outcome.is_err() {
                panic!("{}, case {case}:\n{text}", path.display());
            }
        }
    }
    println!("{solved} solved, {refused} refused, {faulty} without a solved station");
    // The share of refused studies shows that the generator causes neither too much nor too little damage.
    assert!(solved > refused / 20 && refused > solved / 20);
}
