//! Tests of the texts of converted studies: numbers, comments and errors.

use super::{INCHES, METRES, ROOT, converted, is_elastic, run, studies};
use hardpoint::study::Study;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Collects all values of a study under their key paths: numbers as numbers, all other values as text.
fn leaves(value: &toml::Value, path: &str, into: &mut BTreeMap<String, Result<f64, String>>) {
    match value {
        toml::Value::Table(table) => {
            for (key, value) in table {
                leaves(value, &format!("{path}.{key}"), into);
            }
        }
        toml::Value::Array(list) => {
            for (index, value) in list.iter().enumerate() {
                leaves(value, &format!("{path}[{index}]"), into);
            }
        }
        toml::Value::Float(number) => _ = into.insert(path.to_owned(), Ok(*number)),
        toml::Value::Integer(number) => _ = into.insert(path.to_owned(), Ok(*number as f64)),
        other => _ = into.insert(path.to_owned(), Err(other.to_string())),
    }
}

fn numbers(text: &str) -> BTreeMap<String, Result<f64, String>> {
    let mut found = BTreeMap::new();
    leaves(&text.parse::<toml::Table>().unwrap().into(), "", &mut found);
    let units = ["length_unit", "force_unit", "mass_unit", "frame"];
    found.retain(|path, _| !units.iter().any(|unit| path.ends_with(unit)));
    found
}

fn assert_same_numbers(label: &str, old: &str, new: &str) {
    let (old, new) = (numbers(old), numbers(new));
    assert_eq!(
        old.keys().collect::<Vec<_>>(),
        new.keys().collect::<Vec<_>>(),
        "{label}"
    );
    for (path, value) in &old {
        match (value, &new[path]) {
            (Ok(one), Ok(other)) => {
                let error = (one - other).abs();
                // Each conversion rounds twice.
                assert!(
                    error <= 8.0 * f64::EPSILON * one.abs(),
                    "{label} {path}: {one} {other}"
                );
            }
            (one, other) => assert_eq!(one, other, "{label} {path}"),
        }
    }
}

/// A conversion followed by its inverse gives the same numbers, and keeps all comments.
#[test]
fn there_and_back_gives_the_numbers_of_every_sample_study() {
    let directory = tempfile::tempdir().unwrap();
    let back = [
        "--unit",
        "mm",
        "--force-unit",
        "N",
        "--mass-unit",
        "kg",
        "--frame",
        "iso8855",
    ];
    let mut compared = 0;
    for file in studies() {
        let text = fs::read_to_string(&file).unwrap();
        // Omits Attia's study, which is already in metres.
        if text.contains("length_unit = \"m\"") {
            continue;
        }
        let forces: &[&str] = if is_elastic(&file) {
            &["--mass-unit", "lb"]
        } else {
            &["--mass-unit", "lb", "--force-unit", "lbf"]
        };
        let options = [&INCHES[..], forces].concat();
        let there = converted(&file, &options, &directory.path().join("there"));
        let new = converted(&there, &back, &directory.path().join("back"));
        let (new, there) = (
            fs::read_to_string(new).unwrap(),
            fs::read_to_string(there).unwrap(),
        );
        assert_same_numbers(file.to_str().unwrap(), &text, &new);
        assert!(numbers(&there) != numbers(&text), "{}", file.display());
        let comments = |text: &str| text.matches('#').count();
        assert_eq!(comments(&text), comments(&there), "{}", file.display());
        compared += 1;
    }
    assert!(compared > 40, "{compared}");
}

/// Study with entries that no sample has: components along axes, forces, rates, and one-sided limits.
const ENTRIES: &str = r#"
[compliance]
relaxed = "free"
tests = [
  { load = "lateral", trail = 30.0, window = 500.0 },
  { load = "aligning", window = 50000.0 },
  { load = "steering" },
]

[bushings.lower_arm_front]
stiffness = [800.0, 9000.0, 9000.0, 2.0e4, 1.0e6, 1.0e6]
cubic = [8.0, 90.0, 90.0, 0.0, 0.0, 0.0]
preload = [1.0, 2.0, 3.0, 400.0, 500.0, 600.0]
x_axis = [1.0, 0.25, 0.5]

[bushings.lower_arm_rear]
stiffness = [0.0, 9000.0, 9000.0, 2.0e4, 1.0e6, 1.0e6]
fx = [[-2.0, -3000.0], [0.0, 0.0], [2.0, 2500.0]]

[links.tie_rod]
modulus = 210000.0
area = 120.0

[optimise]
good_enough = 0.5
variables = [
  { hardpoint = "tie_rod_inner", axis = "y", range = [-5.0, 8.0] },
  { hardpoint = "tie_rod_outer", direction = [0.0, 0.6, 0.8], range = [-4.0, 6.0] },
  { bushing = "lower_arm_front", stiffness = "ty", range = [5.0e5, 2.0e6] },
  { bushing = "lower_arm_front", stiffness = "y", range = [0.5, 2.0], relative = true },
  { link = "tie_rod", range = [2.0e7, 3.0e7] },
]
targets = [
  { figure = "toe_by_lateral_force_trail_30", value = 0.1, tolerance = 0.01 },
  { figure = "steer_by_rack", at_least = -0.5, tolerance = 0.01 },
  { figure = "steer_by_rack", between = [-0.2, 0.5], tolerance = 0.01 },
]
"#;

/// Text of a wheel's sample study whose elastic parts are replaced by other sections.
fn elastic_study() -> String {
    let text = fs::read_to_string(Path::new(ROOT).join("studies/double_wishbone_compliance.toml"));
    let text = text.unwrap();
    let end = text.find("\n[compliance]").unwrap();
    text[..end].to_owned() + ENTRIES
}

fn text_in(text: &str, options: &[&str]) -> (u8, String, String) {
    let directory = tempfile::tempdir().unwrap();
    let (old, new) = (
        directory.path().join("old.toml"),
        directory.path().join("new.toml"),
    );
    fs::write(&old, text).unwrap();
    let base = [
        "convert",
        old.to_str().unwrap(),
        "--out",
        new.to_str().unwrap(),
    ];
    let (code, said) = run(&[&base[..], options].concat());
    (code, said, fs::read_to_string(new).unwrap_or_default())
}

#[test]
fn entries_are_converted_by_their_quantity() {
    let text = elastic_study();
    Study::elastic_from_text("old.toml", &text, Path::new("")).unwrap();
    let (code, said, new) = text_in(&text, &METRES);
    assert_eq!(code, 0, "{said}");
    let value: toml::Table = new.parse().unwrap();
    let at = |path: &str| {
        let root = toml::Value::from(value.clone());
        let step = |own: toml::Value, key: &str| match key.parse::<usize>() {
            Ok(index) => own[index].clone(),
            Err(_) => own[key].clone(),
        };
        path.split('.').fold(root, step)
    };
    let list = |path: &str| -> Vec<f64> {
        let list = at(path);
        list.as_array()
            .unwrap()
            .iter()
            .map(|n| n.as_float().unwrap())
            .collect()
    };
    let number = |path: &str| at(path).as_float().unwrap();
    assert_eq!(number("compliance.tests.0.trail"), 0.03);
    assert_eq!(number("compliance.tests.0.window"), 500.0);
    // 50000 N mm are 50 N m.
    assert_eq!(number("compliance.tests.1.window"), 50.0);
    let front = "bushings.lower_arm_front";
    assert_eq!(
        list(&format!("{front}.stiffness")),
        [8e5, 9e6, 9e6, 20.0, 1000.0, 1000.0]
    );
    // N/mm3 becomes N/m3.
    assert_eq!(list(&format!("{front}.cubic"))[..3], [8e9, 9e10, 9e10]);
    assert_eq!(
        list(&format!("{front}.preload")),
        [1.0, 2.0, 3.0, 0.4, 0.5, 0.6]
    );
    assert_eq!(list(&format!("{front}.x_axis")), [-1.0, -0.25, 0.5]);
    assert_eq!(list("bushings.lower_arm_rear.fx.2"), [0.002, 2500.0]);
    // N/mm2 becomes N/m2, and mm2 becomes m2.
    assert_eq!(number("links.tie_rod.modulus"), 2.1e11);
    assert_eq!(number("links.tie_rod.area"), 1.2e-4);
    // The y axis is reversed, so the ends of the range are exchanged.
    assert_eq!(list("optimise.variables.0.range"), [-0.008, 0.005]);
    // A conversion rotates a direction with the axes, so the range along the direction does not change.
    assert_eq!(list("optimise.variables.1.direction"), [0.0, -0.6, 0.8]);
    assert_eq!(list("optimise.variables.1.range"), [-0.004, 0.006]);
    assert_eq!(list("optimise.variables.2.range"), [500.0, 2000.0]);
    assert_eq!(list("optimise.variables.3.range"), [0.5, 2.0]);
    assert_eq!(list("optimise.variables.4.range"), [2e7, 3e7]);
    // The name of a test result contains the trail, in the unit of the study. Here the unit is the metre.
    assert_eq!(
        at("optimise.targets.0.figure").as_str(),
        Some("toe_by_lateral_force_trail_0.03")
    );
    // The target is steer per displacement of the rack along +y. Its unit changes from deg/mm to deg/m. The y axis is
    // reversed, so the sign changes, and a lower limit becomes an upper limit.
    assert_eq!(number("optimise.targets.1.at_most"), 500.0);
    assert!(at("optimise.targets.1").get("at_least").is_none());
    let line = "{ figure = \"steer_by_rack\", tolerance = 10.0, at_most = 500.0 },";
    assert!(new.contains(line), "{new}");
    assert_eq!(list("optimise.targets.2.between"), [-500.0, 200.0]);
    assert_eq!(number("optimise.targets.2.tolerance"), 10.0);
    assert_eq!(number("optimise.good_enough"), 0.5);
}

#[test]
fn a_key_that_cannot_be_converted_is_named_with_its_line() {
    let macpherson = fs::read_to_string(Path::new(ROOT).join("studies/macpherson_solve.toml"));
    let macpherson = macpherson.unwrap();
    let scatter = "\n[tolerance]\nscatter = [\n  { hardpoint = \"tie_rod_inner\", limits = [-0.1, 0.3] },\n]\n";
    let tolerance = format!("{macpherson}{scatter}");
    let line = 1 + tolerance[..tolerance.find("limits").unwrap()]
        .matches('\n')
        .count();
    let designs = format!("{macpherson}\n[sweep]\ndesigns = \"designs.csv\"\n");
    let axle = fs::read_to_string(Path::new(ROOT).join("studies/double_wishbone_axle.toml"));
    let (axle, _) = axle.as_deref().unwrap().split_once("[motion]").unwrap();
    let motion =
        "heave = [0.0, 5.0]\nrack = { from = -5.0, to = 5.0, steps = 2 }\ncombine = \"rows\"\n";
    let rows = format!("{axle}[motion]\n{motion}");
    let cases: [(&str, &[&str], &[&str]); 6] = [
        (&rows, &METRES, &["motion.rack", "old.toml:", "list"]),
        (
            &tolerance,
            &METRES,
            &[
                "tolerance.scatter[0].limits",
                &format!("old.toml:{line}:"),
                "axis",
            ],
        ),
        (&designs, &METRES, &["sweep.designs", "old.toml:"]),
        (
            &macpherson,
            &["--force-unit", "lbf"],
            &["suspension.length_unit", "inches", "mm"],
        ),
        (
            &elastic_study(),
            &["--unit", "in", "--force-unit", "lbf"],
            &["elastic parts", "old.toml:"],
        ),
        (&macpherson, &[], &["--unit"]),
    ];
    for (text, options, phrases) in cases {
        let (code, said, new) = text_in(text, options);
        assert_eq!((code, &*new), (2, ""), "{options:?} {said}");
        for phrase in phrases {
            assert!(said.contains(phrase), "{phrase}: {said}");
        }
    }
    // A change of units keeps all signs. So a study whose limits differ between the sides can be converted.
    let (code, said, new) = text_in(&tolerance, &["--unit", "m"]);
    assert_eq!(code, 0, "{said}");
    assert!(new.contains("limits = [-0.0001, 0.0003]"), "{new}");
}

#[test]
fn comments_and_layout_stay() {
    let text = fs::read_to_string(Path::new(ROOT).join("studies/macpherson_solve.toml")).unwrap();
    let (code, said, new) = text_in(&text, &["--unit", "m", "--frame", "x_rear"]);
    assert_eq!(code, 0, "{said}");
    assert!(
        new.contains("# front pivot of the lower arm on the body"),
        "{new}"
    );
    assert!(new.contains("# x rearward, y right, z up"), "{new}");
    assert_eq!(text.lines().count(), new.lines().count());
    // Angles stay exactly as the user wrote them.
    let angles = |text: &str| -> Vec<String> {
        let lines = text.lines().filter(|line| line.contains("static_"));
        lines.map(str::to_owned).collect()
    };
    assert_eq!(angles(&text), angles(&new));
}

#[test]
fn a_converted_file_never_replaces_its_study() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("own.toml");
    let text = fs::read(Path::new(ROOT).join("studies/macpherson_solve.toml")).unwrap();
    fs::write(&file, &text).unwrap();
    let path = file.to_str().unwrap();
    let (code, said) = run(&["convert", path, "--unit", "in", "--out", path, "--force"]);
    assert_eq!(code, 2, "{said}");
    assert_eq!(fs::read(&file).unwrap(), text);
    // A conversion of a car writes three files to another directory. The program refuses the studies' own directory and
    // standard output.
    let studies = Path::new(ROOT).join("studies");
    let car = studies.join("car.toml");
    let car = car.to_str().unwrap();
    for out in [studies.to_str().unwrap(), "-"] {
        let (code, said) = run(&["convert", car, "--unit", "in", "--out", out, "--force"]);
        assert_eq!(code, 2, "{said}");
    }
}

/// A conversion keeps the number of stations of a target curve and of a limit curve. The test varies the travel at the
/// ends of the curves.
#[test]
fn targets_keep_their_stations_in_other_units() {
    let studies = Path::new(ROOT).join("studies");
    let base = fs::read_to_string(studies.join("macpherson_solve.toml")).unwrap();
    let base: toml::Table = base.parse().unwrap();
    let stations = |text: &str| -> Vec<usize> {
        let study = Study::from_text("own.toml", text, &studies).unwrap();
        let targets = &study.optimise.as_ref().unwrap().targets;
        let count = |target: &hardpoint::study::Target| {
            let stations = target.stations_in(study.motion());
            target.wanted.samples(&stations).len()
        };
        targets.iter().map(count).collect()
    };
    for last in 1..=20_u8 {
        let mut own = base.clone();
        let tail = format!(
            r#"
[motion]
travel = {{ from = -40.0, to = 40.0, steps = 81 }}
[optimise]
variables = [{{ hardpoint = "tie_rod_outer", axis = "z", range = [-5.0, 5.0] }}]
targets = [
  {{ characteristic = "toe", points = [[-{last}, 0.1], [{last}, -0.1]], tolerance = 0.05 }},
  {{ characteristic = "camber", at_least = [[-{last}, -1.0], [{last}, -3.0]], tolerance = 0.05 }},
  {{ characteristic = "toe", points = [[-4{last}, 0.1], [-{last}, -0.1]], tolerance = 0.05 }},
]
"#
        );
        own.remove("motion");
        let tail: toml::Table = tail.parse().unwrap();
        own.extend(tail);
        let text = toml::to_string(&own).unwrap();
        let expected = stations(&text);
        let of_range = 2 * usize::from(last) + 1;
        assert_eq!(expected[..2], [of_range; 2], "to {last} mm");
        for unit in ["in", "m"] {
            let (code, said, new) = text_in(&text, &["--unit", unit]);
            assert_eq!(code, 0, "{said}");
            assert_eq!(stations(&new), expected, "to {last} mm, in {unit}");
        }
    }
}
