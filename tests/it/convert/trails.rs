//! Tests of names of test results in other units. A name contains the trail: the distance of the lateral force behind
//! the contact point.

use super::{METRES, converted, done};
use hardpoint::study::Study;
use std::fs;
use std::path::{Path, PathBuf};

const INCHES: [&str; 2] = ["--unit", "in"];

/// Templates with elastic parts.
const TEMPLATES: [&str; 5] = [
    "double_wishbone",
    "macpherson",
    "five_link",
    "semi_trailing_arm",
    "trailing_arm_two_links",
];

/// Writes a template of `hardpoint new` with the options `--with parts` to a file.
fn template(directory: &Path, name: &str, parts: &str) -> PathBuf {
    let mut command = assert_cmd::Command::cargo_bin("hardpoint").unwrap();
    let made = command
        .args(["new", name, "--with", parts])
        .assert()
        .success();
    let path = directory.join(format!("{name}_{}.toml", parts.replace(',', "_")));
    fs::write(&path, &made.get_output().stdout).unwrap();
    path
}

fn figures(path: &Path) -> Vec<String> {
    let text = fs::read_to_string(path).unwrap();
    let study = Study::elastic_from_text("s.toml", &text, Path::new("."));
    let study = study.unwrap_or_else(|errors| panic!("{}: {errors}", path.display()));
    let of_axle = study.axle().map(|both| both.axle.figures());
    let of_axle = of_axle.iter().flat_map(|own| own.iter());
    let of_axle = of_axle.map(|figure| figure.stem());
    let of_wheel = study.one_wheel().map(|own| own.figures());
    let of_wheel = of_wheel.into_iter().flatten().map(|figure| figure.name);
    of_axle.chain(of_wheel).collect()
}

/// The template has a default test with a trail of 30 mm: its force acts 30 mm behind the contact point. A conversion
/// of the study to other units converts the trail in the names of the results. A conversion back restores the names.
#[test]
fn a_converted_study_names_the_trail_of_its_default_test() {
    let directory = tempfile::tempdir().unwrap();
    let directory = directory.path();
    let kinds = ["bushings", "bushings,axle"];
    let all = TEMPLATES
        .into_iter()
        .flat_map(|name| kinds.map(|parts| (name, parts)));
    for (name, parts) in all {
        let path = template(directory, name, parts);
        let figures = figures(&path);
        let with_trail = figures.iter().filter(|own| own.contains("_trail_"));
        let with_trail: Vec<&String> = with_trail.collect();
        assert!(!with_trail.is_empty(), "{name}");
        for figure in &with_trail {
            assert!(figure.contains("_trail_30"), "{figure}");
        }
        let figure = with_trail[0];
        let named = directory.join("named.toml");
        let set = format!("outputs.characteristics=[{figure:?}]");
        let plain = |arguments: &[&str]| {
            let path = path.to_str().unwrap();
            done(&[&["convert", path, "--set", &set, "--force"], arguments].concat());
        };
        for (options, trail) in [(&INCHES[..], "_trail_1.1811"), (&METRES[..], "_trail_0.03")] {
            let out = ["--out", named.to_str().unwrap()];
            plain(&[options, &out[..]].concat());
            let text = fs::read_to_string(&named).unwrap();
            let renamed = figure.replace("_trail_30", trail);
            assert!(
                text.contains(&format!("{renamed:?}")),
                "{name} {options:?}: {text}"
            );
            assert!(
                self::figures(&named).contains(&renamed),
                "{name} {options:?}"
            );
            // Converting back gives the old name, also from inches to metres and from metres to inches.
            for back in [&["--unit", "mm"][..], &INCHES, &METRES] {
                let again = converted(&named, back, &directory.join("again"));
                self::figures(&again);
                if back[1] == "mm" {
                    let text = fs::read_to_string(&again).unwrap();
                    assert!(text.contains(&format!("{figure:?}")), "{name}: {text}");
                }
            }
        }
    }
}

/// The name of a test result contains the trail that the study gives for this test. Conversions to other units and back
/// keep the name and the trail, even if the trail is not a round number in any unit.
#[test]
fn an_explicit_trail_keeps_its_figure() {
    let directory = tempfile::tempdir().unwrap();
    let directory = directory.path();
    let path = template(directory, "double_wishbone", "bushings");
    let tests = "compliance.tests=[{load=\"lateral\",trail=17.123456789}]";
    let figure = "outputs.characteristics=[\"toe_by_lateral_force_trail_17.1235\"]";
    let changed = directory.join("changed.toml");
    let (path, out) = (path.to_str().unwrap(), changed.to_str().unwrap());
    done(&[
        "convert", path, "--unit", "mm", "--set", tests, "--set", figure, "--out", out,
    ]);
    let inches = converted(&changed, &INCHES, &directory.join("in"));
    let metres = converted(&inches, &METRES, &directory.join("m"));
    let back = converted(&metres, &["--unit", "mm"], &directory.join("mm"));
    let text = fs::read_to_string(back).unwrap();
    assert!(
        text.contains("toe_by_lateral_force_trail_17.1235"),
        "{text}"
    );
    assert!(text.contains("17.123456789"), "{text}");
}

/// A measured sheet in the layout of `kc.csv` contains targets. If a study refers to such a sheet, `convert` writes its
/// targets in the new units.
#[test]
fn targets_of_a_sheet_are_converted() {
    let directory = tempfile::tempdir().unwrap();
    let directory = directory.path();
    let path = template(directory, "double_wishbone", "bushings");
    let (study, out) = (path.to_str().unwrap(), directory.join("kc"));
    done(&["kc", study, "--out", out.to_str().unwrap()]);
    let rows = fs::read_to_string(out.join("kc.csv")).unwrap();
    let with_tolerance = rows.lines().enumerate().map(|(k, row)| {
        let cell = if k == 0 { "tolerance" } else { "0.1" };
        format!("{row},{cell}\n")
    });
    let sheet: String = with_tolerance.collect();
    fs::write(directory.join("sheet.csv"), sheet).unwrap();
    let optimise = "optimise={fit=true,variables=[{rate=\"spring\",range=[5.0,150.0]}],\
                    targets=[{file=\"sheet.csv\",tolerance=1.0}]}";
    for options in [&INCHES[..], &METRES] {
        let new = directory.join("new.toml");
        let base = [
            "convert",
            study,
            "--set",
            optimise,
            "--force",
            "--out",
            new.to_str().unwrap(),
        ];
        done(&[&base, options].concat());
        let text = fs::read_to_string(&new).unwrap();
        assert!(text.contains("_trail_"), "{text}");
        figures(&new);
    }
}
