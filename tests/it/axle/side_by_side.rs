//! Tests of `hardpoint compare` with axles.

use super::commands::{folder, run, study};
use crate::support::{larger, one_line};
use hardpoint::report::CurveTable;
use std::fs;
use std::path::Path;

fn comparison(out: &Path) -> CurveTable {
    CurveTable::read(&fs::read(out.join("comparison.csv")).unwrap()).unwrap()
}

/// Writes a study of a five-link axle whose right toe link is 2 mm longer into this folder.
fn longer(folder: &Path) -> String {
    fs::create_dir_all(folder).unwrap();
    let text = fs::read_to_string(study("five_link_axle.toml")).unwrap();
    let changed = text
        .replace("-347.0", "-345.0")
        .replace("steps = 13", "steps = 3");
    assert_ne!(text, changed);
    let path = folder.join("longer.toml");
    fs::write(&path, changed).unwrap();
    path.to_str().unwrap().to_owned()
}

/// An axle compared with itself shows no difference at any station of roll, heave and steering. The values equal those of the
/// run. The travels are results of roll and heave, so the comparison contains them as curves.
#[test]
fn an_axle_does_not_differ_from_itself() {
    let folder = folder("compare_same");
    let (run_of, out) = (folder.join("run"), folder.join("compared"));
    let (run_of, out_name) = (run_of.to_str().unwrap(), out.to_str().unwrap());
    let path = study("macpherson_axle.toml");
    run(&["solve", path.to_str().unwrap(), "--out", run_of], 0);
    let arguments = ["compare", run_of, path.to_str().unwrap(), "--out", out_name];
    let (printed, _) = run(&arguments, 0);
    assert!(printed.contains("at heave_mm"), "{printed}");

    let solved = fs::read(Path::new(run_of).join("curves.csv")).unwrap();
    let solved = CurveTable::read(&solved).unwrap();
    let compared = comparison(&out);
    assert_eq!(
        compared.header[..3],
        ["roll_deg", "heave_mm", "steering_wheel_angle_deg"]
    );
    assert_eq!(compared.rows(), 13 * 3 * 2);
    for name in ["travel_left_mm", "rack_mm", "right_camber_deg", "track_mm"] {
        for label in ["run", "macpherson_axle"] {
            let column = compared.column(&format!("{name} [{label}]"));
            assert!(column.is_some(), "{name} of {label}");
            assert_eq!(column, solved.column(name), "{name} of {label}");
        }
        let difference = compared.column(&format!("{name} [macpherson_axle - run]"));
        let mut differences = difference.unwrap().iter();
        assert!(differences.all(|own| *own == Some(0.0)), "{name}");
    }
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains(r#"data-over="heave_mm""#));
}

/// `compare` solves the second study over the motion of the first, and names a moved point of the right wheel.
#[test]
fn points_of_a_right_wheel_of_its_own_are_told_apart() {
    let folder = folder("compare_own");
    let (other, out) = (longer(&folder), folder.join("compared"));
    let path = study("five_link_axle.toml");
    let arguments = ["compare", path.to_str().unwrap(), &other];
    let more = ["--out", out.to_str().unwrap(), "--format", "csv"];
    let (printed, _) = run(&[&arguments[..], &more].concat(), 0);
    let row = "right,toe_link_inner,longer,0.0,2.0,0.0,2.0";
    assert!(printed.contains(row), "{printed}");
    assert!(!printed.contains("left,toe_link_inner"), "{printed}");
    let compared = comparison(&out);
    assert_eq!(compared.rows(), 13 * 3);
    let largest = |name: &str| {
        let name = format!("{name} [longer - five_link_axle]");
        let differences = compared.column(&name).unwrap().iter().flatten();
        differences.fold(0.0_f64, |most, d| larger(most, d.abs()))
    };
    assert!(
        largest("right_toe_deg") > 0.02,
        "{}",
        largest("right_toe_deg")
    );
}

/// `compare` refuses motions that cannot have a common station, and states the reason.
#[test]
fn wheels_and_axles_and_other_motions_are_not_mixed() {
    let wheel = study("five_link_solve.toml");
    let axle = study("five_link_axle.toml");
    let (wheel, axle) = (wheel.to_str().unwrap(), axle.to_str().unwrap());
    for pair in [[wheel, axle], [axle, wheel]] {
        let (_, said) = run(&["compare", pair[0], pair[1], "--out", "-"], 2);
        let said = one_line(&said);
        assert!(said.contains("compare axles with axles"), "{said}");
    }
    let folder = folder("compare_motions");
    let runs = ["heave", "travels"].map(|name| folder.join(name));
    let runs = runs.each_ref().map(|run| run.to_str().unwrap());
    for (out, motion) in [
        (runs[0], "motion={ heave = [0.0, 10.0] }"),
        (runs[1], "motion={ travel_left = [0.0, 10.0] }"),
    ] {
        let few = "outputs.characteristics=[\"camber\"]";
        let few = [
            "--set",
            motion,
            "--set",
            few,
            "--set",
            "outputs.sensitivities=[]",
        ];
        run(&[&["solve", axle, "--out", out], &few[..]].concat(), 0);
    }
    // `compare` solves a run that contains its study again, over the motion of the first run. Both runs have the same
    // design, so the differences are zero.
    for pair in [[runs[0], runs[1]], [runs[1], runs[0]]] {
        let (csv, said) = run(&["compare", pair[0], pair[1], "--out", "-"], 0);
        assert!(said.contains("solved again over the same motion"), "{said}");
        let mut reader = csv::Reader::from_reader(csv.as_bytes());
        let header = reader.headers().unwrap().clone();
        let difference = header.iter().position(|name| name.contains(" - ")).unwrap();
        let rows: Vec<_> = reader.records().map(Result::unwrap).collect();
        assert_eq!(rows.len(), 2);
        for row in rows {
            assert!(
                row[difference].parse::<f64>().unwrap().abs() < 1e-9,
                "{row:?}"
            );
        }
    }
    for run in runs {
        std::fs::remove_file(format!("{run}/study.toml")).unwrap();
    }
    for pair in [[runs[0], runs[1]], [runs[1], runs[0]]] {
        let (_, said) = run(&["compare", pair[0], pair[1], "--out", "-"], 2);
        let said = one_line(&said);
        assert!(said.contains("run them over the same motion"), "{said}");
    }
}

/// Writes a study of the repository with changed texts into this folder.
fn changed(folder: &Path, name: &str, changes: &[(&str, &str)]) -> String {
    fs::create_dir_all(folder).unwrap();
    let mut text = fs::read_to_string(study(&format!("{name}.toml"))).unwrap();
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replacen(from, to, 1);
    }
    let path = folder.join(format!("{name}_changed.toml"));
    fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

/// The motion of the first study moves a rack that a second, unsteered solid axle does not have. The comparison contains
/// derivatives of this axle with respect to roll and heave, but not with respect to the rack.
#[test]
fn an_axle_without_a_rack_has_no_derivatives_by_the_rack() {
    let folder = folder("compare_rack");
    let order = ("[outputs]", "[outputs]\norder = \"velocity\"");
    let few = ("steering_wheel_angle = [0.0, 120.0]", "rack = [0.0, 10.0]");
    let first = changed(&folder, "macpherson_axle", &[few, order]);
    let solid = changed(&folder, "solid_axle_solve", &[order]);
    let out = folder.join("compared");
    run(
        &["compare", &first, &solid, "--out", out.to_str().unwrap()],
        0,
    );
    let header = comparison(&out).header;
    let of_solid = |name: &&String| name.ends_with("[solid_axle_solve_changed]");
    let of_solid: Vec<_> = header.iter().filter(of_solid).collect();
    for derivative in ["roll_steer_by_roll_", "roll_steer_by_heave_"] {
        assert!(
            of_solid.iter().any(|name| name.starts_with(derivative)),
            "{header:?}"
        );
    }
    assert!(
        of_solid.iter().all(|name| !name.contains("_by_rack")),
        "{header:?}"
    );
    // A rack that follows a time law gives no time derivatives of this axle either.
    let law =
        "drive = \"rack\"\ntime = { polynomial = [0.0, 10.0], from = 0.0, to = 1.0, steps = 2 }";
    let first = changed(
        &folder,
        "macpherson_axle",
        &[("steering_wheel_angle = [0.0, 120.0]", law)],
    );
    let (_, said) = run(&["compare", &first, &solid, "--out", "-"], 2);
    assert!(
        one_line(&said).contains("this axle has no rack and no drag link"),
        "{said}"
    );
}

/// Derivatives along roll are at constant mean travel. So `compare` refuses them, and certificates, if the first study holds the
/// wheel loads instead.
#[test]
fn what_a_study_cannot_have_at_constant_wheel_loads_is_refused() {
    let folder = folder("compare_loads");
    let hold = (
        "steering_wheel_angle = [0.0, 120.0]",
        "hold = \"wheel_load\"",
    );
    let first = changed(&folder, "macpherson_axle", &[hold]);
    for (key, wanted) in [
        ("order = \"velocity\"", "does not work with derivatives"),
        ("certify = true", "does not work with certify"),
    ] {
        let outputs = format!("[outputs]\n{key}\ncharacteristics = [\"camber\"]\n");
        let text = fs::read_to_string(study("macpherson_axle.toml")).unwrap();
        let other = folder.join("other.toml");
        fs::write(
            &other,
            text.split("[outputs]").next().unwrap().to_owned() + &outputs,
        )
        .unwrap();
        let arguments = ["compare", &first, other.to_str().unwrap(), "--out", "-"];
        let (_, said) = run(&arguments, 2);
        assert!(one_line(&said).contains(wanted), "{said}");
    }
}
