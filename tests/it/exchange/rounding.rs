//! Tests of `hardpoint export --round`: the coordinates that it rounds, and the unit of its length.

use super::export_commands::{points, run};
use crate::support::studies;
use hardpoint::exchange::Outgoing;
use hardpoint::study::Study;
use std::collections::BTreeMap;
use std::path::Path;

/// Exports the points of a source as a table. Returns the points, and the messages.
fn export(source: &str, more: &[&str]) -> (BTreeMap<String, [f64; 3]>, String) {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("points.csv");
    let to = ["export", source, "--to", "csv", "--force", "--out"];
    let (_, said) = run(&[&to[..], &[file.to_str().unwrap()], more].concat(), 0);
    (points(&file), said)
}

/// Coordinates of a study as an export writes them.
fn coordinates(study: &Study) -> BTreeMap<String, [f64; 3]> {
    let outgoing = Outgoing::of(study, None, None);
    let side = study.wheel().frame.meaning().1;
    let points = outgoing
        .points(side)
        .map(|(name, _, position)| (name.to_owned(), position));
    points.collect()
}

/// Rounding changes only coordinates that a tuning may move or has moved. With `--round-all` it changes all
/// coordinates.
#[test]
fn rounding_moves_what_was_tuned() {
    let directory = tempfile::tempdir().unwrap();
    let path = studies().join("macpherson_bump_steer.toml");
    let out = directory.path().join("tuned");
    let study = Study::read(&path, &[]).unwrap();
    let [path, out] = [&path, &out].map(|p| p.to_str().unwrap());
    run(
        &[
            "-q",
            "optimise",
            path,
            "--out",
            out,
            "--set",
            "optimise.starts=1",
        ],
        0,
    );
    let tuned = Study::read(&Path::new(out).join("optimised.toml"), &[]).unwrap();
    let [before, after] = [&study, &tuned].map(coordinates);
    let variables = &study.optimise.as_ref().unwrap().variables;
    let may_move = |name: &str| {
        variables.iter().any(|v| {
            v.points()
                .any(|id| study.wheel().mechanism.name(id) == name)
        })
    };
    // The test rounds the run to 7 mm, because no coordinate is a multiple of 7 mm by chance.
    let (rounded, said) = export(out, &["--round", "7"]);
    assert!(
        said.contains("coordinates rounded to 7 mm: misfit"),
        "{said}"
    );
    let mut count = 0;
    for (name, position) in &after {
        for axis in 0..3 {
            let found = rounded[name][axis];
            if position[axis] == before[name][axis] {
                assert_eq!(found, position[axis], "{name}");
            } else {
                count += 1;
                assert!(
                    may_move(name) && (found / 7.0).fract() == 0.0,
                    "{name} {found}"
                );
            }
        }
    }
    assert!(count > 0);
    // The test also rounds the tuned study without its run. The variables of the study then determine which coordinates
    // are rounded.
    let file = Path::new(out).join("optimised.toml");
    let (rounded, _) = export(file.to_str().unwrap(), &["--round", "7"]);
    for (name, position) in &after {
        assert!(may_move(name) || rounded[name] == *position, "{name}");
    }
    let (rounded, _) = export(out, &["--round", "7", "--round-all"]);
    assert!(rounded.values().flatten().all(|x| (x / 7.0).fract() == 0.0));
}

/// In a study without a tuning, only the points that `--set` has moved are rounded.
#[test]
fn rounding_moves_what_was_set() {
    let plain = studies().join("macpherson_solve.toml");
    let plain = plain.to_str().unwrap();
    let (same, said) = export(plain, &["--round", "7"]);
    assert!(said.contains("no coordinate was moved or tuned"), "{said}");
    assert_eq!(
        same,
        coordinates(&Study::read(Path::new(plain), &[]).unwrap())
    );
    let moved = "suspension.hardpoints.tie_rod_inner=[-110.0, 330.0, 241.3]";
    let (one, _) = export(plain, &["--round", "7", "--set", moved]);
    let changed: Vec<_> = one.iter().filter(|(name, p)| **p != same[*name]).collect();
    assert_eq!(changed.len(), 1);
    assert_eq!(changed[0].1[2] % 7.0, 0.0);
}

/// The length of `--round` may have its own unit. Without a unit, it has the unit of the file.
#[test]
fn the_length_of_a_rounding_has_a_unit() {
    let directory = tempfile::tempdir().unwrap();
    let path = studies().join("double_wishbone_solve.toml");
    let path = path.to_str().unwrap();
    let export = |to: &str, more: &[&str]| {
        let file = directory.path().join("file");
        let out = file.to_str().unwrap();
        let base = [
            "export",
            path,
            "--to",
            to,
            "--force",
            "--round-all",
            "--out",
            out,
        ];
        let (_, said) = run(&[&base[..], more].concat(), 0);
        (std::fs::read_to_string(&file).unwrap(), said)
    };
    let (plain, _) = export("csv", &["--round", "7"]);
    for same in ["7mm", "7 mm", "0.7cm", "7.0mm"] {
        let (text, said) = export("csv", &["--round", same]);
        assert_eq!(text, plain, "{same}");
        assert!(said.contains("rounded to 7 mm"), "{said}");
    }
    // In a file in inches, the coordinates are multiples of 7 mm.
    export("csv", &["--round", "7mm", "--unit", "in"]);
    for x in points(&directory.path().join("file")).values().flatten() {
        let steps = x * 25.4 / 7.0;
        assert!((steps - steps.round()).abs() < 1e-12, "{x}");
    }
    // The study is in millimetres. Multiples of 0.25 in have at most two decimals there.
    let (study, said) = export("toml", &["--round", "0.25in"]);
    assert!(said.contains("rounded to 0.25 in"), "{said}");
    let study = Study::from_text("rounded.toml", &study, Path::new("")).unwrap();
    let coordinates = study.wheel().design.iter().flat_map(|p| p.to_array());
    for x in coordinates {
        assert!((x / 6.35 - (x / 6.35).round()).abs() < 1e-12, "{x}");
        assert_eq!(format!("{x:.2}").parse(), Ok(x), "{x}");
    }
    for wrong in ["7kg", "mm", "0mm", "-7mm", "7mmm"] {
        let (_, said) = run(
            &["export", path, "--to", "csv", &format!("--round={wrong}")],
            2,
        );
        assert!(said.contains("0.5mm"), "{wrong}: {said}");
    }
}
