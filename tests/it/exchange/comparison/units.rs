//! Tests of `compare` with one design in different units.

use super::{changed, compare, run, wheel};
use std::fs;

/// A design converted to another unit counts as unmoved, although the conversion rounds its coordinates. `compare`
/// lists a real move of a nanometre.
#[test]
fn conversions_of_units_move_no_point() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    fs::write(at.join("own.toml"), wheel()).unwrap();
    let moved = wheel().replace("[-140.0,  685.0,  228.0]", "[-140.0, 685.000001, 228.0]");
    assert_ne!(moved, wheel());
    fs::write(at.join("moved.toml"), moved).unwrap();
    let compared = |sources: [&str; 2]| {
        let [one, other] = sources;
        let arguments = ["compare", one, other, "--out", "sides", "--force"];
        run(at, &arguments, 0)[0].clone()
    };
    for unit in ["in", "m"] {
        let other = format!("{unit}.toml");
        run(
            at,
            &["convert", "own.toml", "--unit", unit, "--out", &other],
            0,
        );
        for sources in [["own.toml", &*other], [&*other, "own.toml"]] {
            let said = compared(sources);
            assert!(!said.contains("moved"), "{sources:?}: {said}");
        }
        let said = compared([&other, "moved.toml"]);
        assert!(said.contains("moved"), "{said}");
    }
}

/// `compare` converts forces in pounds-force to the newtons of the first study, and the reverse.
#[test]
fn a_design_is_the_same_in_other_units() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    let text = changed(&wheel(), &[("rack = ", "rack = 0.0")]);
    fs::write(at.join("own.toml"), text).unwrap();
    let inches = ["convert", "own.toml", "--unit", "in", "--out", "in.toml"];
    run(at, &inches, 0);
    run(
        at,
        &[
            "convert",
            "in.toml",
            "--force-unit",
            "lbf",
            "--out",
            "lbf.toml",
        ],
        0,
    );
    for sources in [
        ["own.toml", "lbf.toml"],
        ["in.toml", "lbf.toml"],
        ["lbf.toml", "own.toml"],
    ] {
        let (rows, differences) = compare(at, sources);
        assert!(rows == 3 && differences.len() > 50, "{sources:?}");
        for (name, difference) in differences {
            // Accelerations are second derivatives of rounded coordinates, so their bound is larger.
            assert!(difference <= 1e-9, "{sources:?} {name}: {difference}");
        }
    }
}
