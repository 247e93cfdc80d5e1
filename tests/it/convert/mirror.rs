//! Tests of `hardpoint convert --side`: the study of the wheel on the other side of the car.

use super::physical::{
    FIRST_ITERATION, assert_near, compare, is_plain_tuning, sign, summary, tables_of_results,
};
use super::{ROOT, converted, done, is_elastic, results, run, studies};
use hardpoint::characteristics::Characteristic;
use hardpoint::study::{CarStudy, Study};
use std::fs;
use std::path::{Path, PathBuf};

const RIGHT: [&str; 2] = ["--side", "right"];
const LEFT: [&str; 2] = ["--side", "left"];

/// Sample studies of one wheel, which is a left wheel.
fn wheels() -> Vec<PathBuf> {
    let mut files = studies();
    files.retain(|file| !CarStudy::is_at(file) && read(file).one_wheel().is_some());
    assert!(files.len() > 20, "{files:?}");
    files
}

fn read(file: &Path) -> Study {
    Study::read_elastic(file, &[]).unwrap_or_else(|errors| panic!("{}: {errors}", file.display()))
}

/// Sign of a column of the mirror image. Characteristics keep their signs. Components along y change them, and so do
/// components about x and z.
fn mirrored(stem: &str) -> f64 {
    // The steer to the left and the displacement of the rack along +y both change their signs.
    if stem.starts_with("steer_by_rack") {
        return 1.0;
    }
    if stem.starts_with("knuckle_omega_") || stem.starts_with("knuckle_alpha_") {
        return if stem.contains("_y") { 1.0 } else { -1.0 };
    }
    sign(stem, [1.0, -1.0, 1.0])
}

/// Options that add several positions of the rack to a study and, if its parts are rigid, outputs: all characteristics, all
/// points, forces under a load.
fn more_outputs(study: &Study) -> Vec<String> {
    let wheel = study.wheel();
    let names = |names: Vec<&str>| format!("{names:?}");
    let has = |c: &&Characteristic| c.info().needs.iter().all(|need| need.met_by(wheel));
    let characteristics = Characteristic::ALL.iter().filter(has);
    let characteristics = characteristics.map(|c| c.info().name).collect();
    let points = wheel.mechanism.points.iter();
    let points = points.map(|point| point.name.as_str()).collect();
    let millimetre = wheel.length_unit.per_metre() / 1000.0;
    let rack = [-8.0, 0.0, 15.0].map(|rack| rack * millimetre);
    let mut sets = vec![format!("motion.rack={rack:?}")];
    // The tests of a wheel with elastic parts have their own results.
    if study.is_elastic() {
        return sets;
    }
    // With the equations of the paper, gains have no second derivative.
    let is_paper = study.text.contains("formulation = \"point_coordinates\"");
    let order = if is_paper { "velocity" } else { "acceleration" };
    sets.extend([
        format!("outputs.characteristics={}", names(characteristics)),
        format!("outputs.points={}", names(points)),
        format!("outputs.order={order:?}"),
        "outputs.knuckle=true".to_owned(),
    ]);
    let torque = [4000.0, -5000.0, 6000.0].map(|moment| moment * millimetre);
    if !is_paper {
        sets.push(format!(
            "outputs.loads=[{{name=\"corner\",at=\"wheel_centre\",force=[100.0,-200.0,3000.0],moment={torque:?}}}]"
        ));
    }
    sets
}

/// Each result at each station is the same for the wheel on the other side. Only components along y, and components about x and
/// z, change their signs.
#[test]
fn every_sample_wheel_has_the_same_results_on_the_other_side() {
    let directory = tempfile::tempdir().unwrap();
    let mut compared = 0;
    for file in wheels() {
        let sets = more_outputs(&read(&file));
        let sets: Vec<&str> = sets.iter().flat_map(|set| ["--set", set]).collect();
        let command = if is_elastic(&file) { "kc" } else { "solve" };
        let old = results(command, &file, &sets, directory.path());
        let place = directory.path().join("right");
        let right = converted(&file, &[&RIGHT[..], &sets].concat(), &place);
        let new = results(command, &right, &[], &place);
        for name in tables_of_results(&old) {
            let label = format!("{} {name}", file.display());
            compare(&label, &old.join(&name), &new.join(&name), &mirrored, 1e-12);
            compared += 1;
        }
    }
    assert!(compared >= 25, "{compared}");
}

/// Targets keep their meaning: the misfit of the design does not change.
#[test]
fn every_sample_tuning_of_a_wheel_begins_with_the_same_misfit_on_the_other_side() {
    let directory = tempfile::tempdir().unwrap();
    let mut compared = 0;
    for file in wheels().into_iter().filter(|file| is_plain_tuning(file)) {
        let old = summary(&results(
            "optimise",
            &file,
            &FIRST_ITERATION,
            directory.path(),
        ));
        let place = directory.path().join("right");
        let right = converted(&file, &RIGHT, &place);
        let new = summary(&results("optimise", &right, &FIRST_ITERATION, &place));
        let label = file.display().to_string();
        assert_near(&label, &old["misfit_before"], &new["misfit_before"], 1e-9);
        compared += 1;
    }
    assert!(compared > 5, "{compared}");
}

/// The study of the right wheel, converted to the left and again to the right, is the same file. On the left, the file is the
/// original: each number has the digits of the original. A study that does not name its side gets this key.
#[test]
fn to_the_other_side_and_back_gives_the_same_file() {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name);
    let text = |file: &Path| fs::read_to_string(file).unwrap();
    for file in wheels() {
        let right = converted(&file, &RIGHT, &at("right"));
        let left = converted(&right, &LEFT, &at("left"));
        let again = converted(&left, &RIGHT, &at("again"));
        assert_eq!(text(&right), text(&again), "{}", file.display());
        assert_ne!(text(&right), text(&left), "{}", file.display());
        let original = text(&file);
        let names_side = original.contains("\nside = \"left\"");
        let back = text(&left);
        let back = if names_side {
            back
        } else {
            back.replacen("side = \"left\"\n", "", 1)
        };
        assert_eq!(back, original, "{}", file.display());
    }
}

/// Study of a left wheel with entries that depend on the side.
const ENTRIES: &str = r#"
[compliance]
relaxed = "free"
tests = [{ load = "steering" }, { load = "lateral" }]

[bushings.lower_arm_front]
stiffness = [0.0, 0.0, 9000.0, 2.0e4, 1.0e6, 1.0e6]
fx = [[-2.0, -3000.0], [0.0, 0.0], [2.0, 2500.0]]
fy = [[-1.0, -9000.0], [0.0, 0.0], [2.0, 8000.0]]
preload = [1.0, 2.0, 3.0, 400.0, 500.0, 600.0]
x_axis = [1.0, 0.25, 0.50]

[optimise]
variables = [
  { hardpoint = "tie_rod_inner", axis = "y", range = [-5.0, 8.00] },
  { hardpoint = "tie_rod_outer", axis = "z", range = [-5.0, 8.00] },
  { hardpoint = "wheel_centre", direction = [0.0, 0.6, 0.8], range = [-4.0, 6.0] },
]
targets = [
  { figure = "steer_by_rack", at_least = -0.5, tolerance = 0.01 },
  { figure = "caster_by_rack", at_least = -0.5, tolerance = 0.01 },
  { figure = "toe_by_lateral_force", value = 0.1, tolerance = 0.01 },
]
"#;

/// The axes of a bushing are mirrored with the wheel, so its laws keep their signs.
#[test]
fn entries_are_mirrored_by_their_quantity() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("left.toml");
    let text = fs::read_to_string(Path::new(ROOT).join("studies/double_wishbone_compliance.toml"));
    let text = text.unwrap();
    let end = text.find("\n[compliance]").unwrap();
    fs::write(&file, text[..end].to_owned() + ENTRIES).unwrap();
    let right = converted(&file, &RIGHT, &directory.path().join("right"));
    let new = fs::read_to_string(&right).unwrap();
    for line in [
        "fy = [[-1.0, -9000.0], [0.0, 0.0], [2.0, 8000.0]]",
        "preload = [1.0, 2.0, 3.0, 400.0, 500.0, 600.0]",
        "x_axis = [1.0, -0.25, 0.50]",
        "axis = \"y\", range = [-8.00, 5.0]",
        "axis = \"z\", range = [-5.0, 8.00]",
        "direction = [0.0, -0.6, 0.8], range = [-4.0, 6.0]",
        "{ figure = \"steer_by_rack\", at_least = -0.5, tolerance = 0.01 }",
        "{ figure = \"caster_by_rack\", tolerance = 0.01, at_most = 0.5 }",
        "{ figure = \"toe_by_lateral_force\", value = 0.1, tolerance = 0.01 }",
    ] {
        assert!(new.contains(line), "{line}\n{new}");
    }
}

/// The study of a right wheel becomes the study of an axle: converted to the left, with `[axle]` and heave instead of travel.
#[test]
fn a_right_wheel_becomes_an_axle_with_its_targets() {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name);
    let file = Path::new(ROOT).join("studies/macpherson_bump_steer.toml");
    let right = converted(&file, &RIGHT, &at("right"));
    let left = converted(&right, &LEFT, &at("left"));
    for (wheel, code) in [(&right, 2), (&left, 0)] {
        let text = fs::read_to_string(wheel).unwrap();
        let mut text = text.replace("\ntravel = {", "\nheave = {");
        text += "\n[axle]\nright = \"mirrored\"\n";
        let axle = at("axle.toml");
        fs::write(&axle, text).unwrap();
        let (found, said) = run(&["check", axle.to_str().unwrap()]);
        assert_eq!(found, code, "{said}");
        assert_eq!(said.contains("hardpoint convert --side left"), code == 2);
    }
    let axle = read(&at("axle.toml"));
    assert!(!axle.optimise.unwrap().targets.is_empty());
}

/// Axles and cars have both wheels. Their conversion to a side is refused.
#[test]
fn axles_and_cars_have_no_side() {
    let directory = tempfile::tempdir().unwrap();
    let out = directory.path().join("out");
    let out = out.to_str().unwrap();
    for name in ["macpherson_axle.toml", "solid_axle_solve.toml", "car.toml"] {
        let study = Path::new(ROOT).join("studies").join(name);
        let study = study.to_str().unwrap();
        for side in ["left", "right"] {
            let (code, said) = run(&["convert", study, "--side", side, "--out", out]);
            assert_eq!(code, 2, "{said}");
            assert!(said.contains("both wheels of an axle"), "{said}");
            assert!(!Path::new(out).exists());
        }
    }
    let wheel = Path::new(ROOT).join("studies/macpherson_solve.toml");
    done(&[
        "convert",
        wheel.to_str().unwrap(),
        "--side",
        "right",
        "--out",
        out,
    ]);
}
