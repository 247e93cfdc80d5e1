//! Tests that `docs/study.md` lists exactly the keys that the program accepts in a study.
//!
//! If a study contains an unknown key, the program lists all known keys. The test reads this list.

use hardpoint::study::{CarStudy, Study};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

/// Tables of a study. Each entry has the name of the table in the manual, and a part of [`STUDY`] with a replacement. The
/// replacement adds the key `bogus` to the table.
const TABLES: &[(&str, &str, &str)] = &[
    ("suspension", "topology =", "bogus = 1\ntopology ="),
    (
        "suspension.extra_points.NAME",
        "{ body =",
        "{ bogus = 1, body =",
    ),
    ("wheel", "[wheel]", "[wheel]\nbogus = 1"),
    ("vehicle", "[vehicle]", "[vehicle]\nbogus = 1"),
    (
        "axle",
        "right = \"mirrored\"",
        "bogus = 1\nright = \"mirrored\"",
    ),
    ("axle.right", "\"mirrored\"", "{ bogus = 1 }"),
    (
        "axle.right.bushings.NAME",
        "\"mirrored\"",
        "{ bushings = { rear = { bogus = 1 } } }",
    ),
    (
        "axle.right.wheel",
        "\"mirrored\"",
        "{ wheel = { bogus = 1 } }",
    ),
    (
        "axle.right.spring",
        "\"mirrored\"",
        "{ spring = { bogus = 1 } }",
    ),
    ("steering", "[steering]", "[steering]\nbogus = 1"),
    ("spring", "[spring]", "[spring]\nbogus = 1"),
    ("twist_beam", "[twist_beam]", "[twist_beam]\nbogus = 1"),
    ("bump_stop", "[bump_stop]", "[bump_stop]\nbogus = 1"),
    (
        "rebound_stop",
        "[rebound_stop]",
        "[rebound_stop]\nbogus = 1",
    ),
    (
        "anti_roll_bar",
        "[anti_roll_bar]",
        "[anti_roll_bar]\nbogus = 1",
    ),
    (
        "heave_spring",
        "[heave_spring]",
        "[heave_spring]\nbogus = 1",
    ),
    ("t_bar", "[t_bar]", "[t_bar]\nbogus = 1"),
    ("heave_bar", "[heave_bar]", "[heave_bar]\nbogus = 1"),
    ("tyre", "[tyre]", "[tyre]\nbogus = 1"),
    ("compliance", "[compliance]", "[compliance]\nbogus = 1"),
    (
        "compliance.tests",
        "tests = [{ load = \"lateral\" }]",
        "tests = [{ bogus = 1 }]",
    ),
    (
        "bushings.NAME",
        "[motion]",
        "[bushings.rear]\nbogus = 1\n[motion]",
    ),
    ("subframe", "[motion]", "[subframe]\nbogus = 1\n[motion]"),
    ("links.NAME", "[motion]", "[links.rod]\nbogus = 1\n[motion]"),
    ("motion", "[motion]", "[motion]\nbogus = 1"),
    (
        "motion.travel (every range)",
        "travel = {",
        "travel = { bogus = 1,",
    ),
    (
        "motions.NAME",
        "[solver]",
        "[motions.steer]\nbogus = 1\n[solver]",
    ),
    ("motion.time", "travel = { from", "time = { bogus = 1, from"),
    ("solver", "[solver]", "[solver]\nbogus = 1"),
    ("outputs", "[outputs]", "[outputs]\nbogus = 1"),
    (
        "outputs.loads",
        "[outputs]",
        "[outputs]\nloads = [{ bogus = 1 }]",
    ),
    ("sweep", "[sweep]", "[sweep]\nbogus = 1"),
    (
        "sweep.variables",
        "[sweep]",
        "[sweep]\nvariables = [{ bogus = 1 }]",
    ),
    ("optimise", "[optimise]", "[optimise]\nbogus = 1"),
    (
        "optimise.variables",
        "variables = []",
        "variables = [{ bogus = 1 }]",
    ),
    (
        "optimise.targets",
        "targets = []",
        "targets = [{ bogus = 1 }]",
    ),
    ("setup", "[setup]", "[setup]\nbogus = 1"),
    ("setup.adjust", "adjust = []", "adjust = [{ bogus = 1 }]"),
    ("tolerance", "[tolerance]", "[tolerance]\nbogus = 1"),
    (
        "tolerance.scatter",
        "scatter = []",
        "scatter = [{ bogus = 1 }]",
    ),
    (
        "tolerance.bands",
        "scatter = []",
        "scatter = []\nbands = [{ bogus = 1 }]",
    ),
    (
        "optimise.constraints",
        "targets = []",
        "targets = []\nconstraints = [{ bogus = 1 }]",
    ),
    (
        "optimise.constraints.inside (and outside)",
        "targets = []",
        "targets = []\nconstraints = [{ inside = { bogus = 1 } }]",
    ),
    (
        "optimise.constraints.inside.half_space",
        "targets = []",
        "targets = []\nconstraints = [{ inside = { half_space = { bogus = 1 } } }]",
    ),
    (
        "optimise.constraints.inside.sphere",
        "targets = []",
        "targets = []\nconstraints = [{ inside = { sphere = { bogus = 1 } } }]",
    ),
    (
        "optimise.constraints.inside.cylinder",
        "targets = []",
        "targets = []\nconstraints = [{ inside = { cylinder = { bogus = 1 } } }]",
    ),
];

/// Study with every table. Only the keys matter, not the values.
const STUDY: &str = r#"
[suspension]
topology = "macpherson"
[suspension.hardpoints]
[suspension.extra_points]
seat = { body = "knuckle", position = [0.0, 0.0, 0.0] }
[wheel]
[vehicle]
[axle]
right = "mirrored"
[steering]
c_factor = 1.0
[twist_beam]
torsional_rate = 1.0
[spring]
[bump_stop]
gap = 1.0
force_curve = []
[rebound_stop]
gap = 1.0
force_curve = []
[anti_roll_bar]
rate = 1.0
[heave_spring]
rate = 1.0
force = 1.0
[t_bar]
rate = 1.0
[heave_bar]
rate = 1.0
torque = 1.0
[tyre]
rate = 1.0
[compliance]
tests = [{ load = "lateral" }]
[motion]
travel = { from = 0.0, to = 1.0, steps = 2 }
[solver]
[outputs]
[sweep]
[optimise]
variables = []
targets = []
[setup]
adjust = []
[tolerance]
scatter = []
"#;

/// Keys of a study that the program accepts in the table of `text` with the key `bogus`.
fn known_keys(text: &str) -> BTreeSet<String> {
    let refused = Study::from_text("keys.toml", text, Path::new("")).unwrap_err();
    keys_in(&refused.render(false), text)
}

/// Keys of the study of a car that the program accepts in the table of `text` with the key `bogus`.
fn known_keys_of_car(text: &str) -> BTreeSet<String> {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("car.toml");
    std::fs::write(&path, text).unwrap();
    let refused = CarStudy::read(&path, &[]).unwrap_err();
    keys_in(&refused.render(false), text)
}

/// Keys that a message lists.
fn keys_in(said: &str, text: &str) -> BTreeSet<String> {
    let (_, known) = said
        .split_once("unknown key \"bogus\"; known here: ")
        .unwrap_or_else(|| panic!("{said}\n{text}"));
    let known = known.lines().next().unwrap_or_default();
    known.split(", ").map(str::to_owned).collect()
}

/// Keys in the first column of each section of the manual.
fn documented_keys(page: &str) -> BTreeMap<String, BTreeSet<String>> {
    let manual = std::fs::read_to_string(Path::new(ROOT).join(page)).unwrap();
    let (_, manual) = manual.split_once("keys.md -->\n").unwrap();
    let mut sections = BTreeMap::new();
    for section in manual.split("\n## ").skip(1) {
        let (name, rows) = section.split_once('\n').unwrap();
        let keys = rows.lines().filter_map(|row| {
            let (key, _) = row.strip_prefix("| `")?.split_once('`')?;
            Some(key.to_owned())
        });
        sections.insert(name.to_owned(), keys.collect());
    }
    sections
}

#[test]
fn the_manual_lists_the_keys_that_the_reader_knows() {
    let documented = documented_keys("docs/study.md");
    let mut read = BTreeMap::new();
    for (table, what, by) in TABLES {
        assert!(STUDY.contains(what), "{table}");
        read.insert(
            (*table).to_owned(),
            known_keys(&STUDY.replacen(what, by, 1)),
        );
    }
    assert_eq!(documented, read);
    // [`TABLES`] contains every section of a study.
    let sections = known_keys(&format!("bogus = 1\n{STUDY}"));
    let tables: BTreeSet<String> = TABLES
        .iter()
        .map(|(table, ..)| table.split('.').next().unwrap_or_default().to_owned())
        .collect();
    assert_eq!(sections, tables);
}

/// Tables of the study of a car. Each entry has the name of the table in the manual, and the text of a study in which
/// this table has the key `bogus`.
const TABLES_OF_CAR: &[(&str, &str)] = &[
    ("car", "[car]\nbogus = 1"),
    ("car.aero", "[car]\naero = { bogus = 1 }"),
    (
        "car.aero.front (and rear)",
        "[car]\naero = { rear = { bogus = 1 } }",
    ),
    ("car.aero.drag", "[car]\naero = { drag = { bogus = 1 } }"),
    ("cases", "[[cases]]\nbogus = 1"),
    ("gg_map", "[gg_map]\nbogus = 1"),
    ("gg_map.ax (and ay)", "[gg_map]\nay = { bogus = 1 }"),
    ("outputs", "[outputs]\nbogus = 1"),
    ("sweep", "[sweep]\nbogus = 1"),
    ("sweep.variables", "[sweep]\nvariables = [{ bogus = 1 }]"),
    ("optimise", "[optimise]\nbogus = 1"),
    (
        "optimise.variables",
        "[optimise]\nvariables = [{ bogus = 1 }]",
    ),
    ("optimise.targets", "[optimise]\ntargets = [{ bogus = 1 }]"),
    (
        "optimise.constraints",
        "[optimise]\nconstraints = [{ bogus = 1 }]",
    ),
    (
        "optimise.constraints.inside (and outside)",
        "[optimise]\nconstraints = [{ inside = { bogus = 1 } }]",
    ),
    (
        "optimise.constraints.inside.half_space",
        "[optimise]\nconstraints = [{ inside = { half_space = { bogus = 1 } } }]",
    ),
    (
        "optimise.constraints.inside.sphere",
        "[optimise]\nconstraints = [{ inside = { sphere = { bogus = 1 } } }]",
    ),
    (
        "optimise.constraints.inside.cylinder",
        "[optimise]\nconstraints = [{ inside = { cylinder = { bogus = 1 } } }]",
    ),
    ("tolerance", "[tolerance]\nbogus = 1"),
    (
        "tolerance.scatter",
        "[tolerance]\nscatter = [{ bogus = 1 }]",
    ),
    ("tolerance.bands", "[tolerance]\nbands = [{ bogus = 1 }]"),
];

#[test]
fn the_manual_lists_the_keys_of_cars() {
    let read: BTreeMap<String, BTreeSet<String>> = TABLES_OF_CAR
        .iter()
        .map(|(table, text)| ((*table).to_owned(), known_keys_of_car(text)))
        .collect();
    assert_eq!(documented_keys("docs/car.md"), read);
    let sections = known_keys_of_car("bogus = 1");
    let tables: BTreeSet<String> = TABLES_OF_CAR
        .iter()
        .map(|(table, _)| table.split('.').next().unwrap_or_default().to_owned())
        .collect();
    assert_eq!(sections, tables);
}
