//! Tests of side effects of tunings. The side effects are compared with the curves of both designs. Other tests check the
//! rules and the reports in all formats.

mod axle;

use crate::support::{larger, one_line};
use hardpoint::characteristics::Characteristic;
use hardpoint::side_effects::side_effects;
use hardpoint::study::{Outputs, Study};
use hardpoint::{Control, SideEffect};
use serde_json::Value;
use std::path::{Path, PathBuf};

fn path(name: &str) -> PathBuf {
    crate::support::studies().join(format!("{name}.toml"))
}

fn study(name: &str, overrides: &[&str]) -> Study {
    crate::support::study(&format!("{name}.toml"), overrides)
}

/// Returns the study, the tuned study, and the side effects of the tuning.
fn tuned(name: &str, overrides: &[&str]) -> (Study, Study, Vec<SideEffect>) {
    let study = study(name, overrides);
    let best = study.tune(Control::default()).unwrap().best.unwrap();
    let after = study.moved(&best.offsets);
    let effects = side_effects(&study, &after).unwrap();
    (study, after, effects)
}

fn named<'e>(effects: &'e [SideEffect], output: &str) -> &'e SideEffect {
    let found = effects.iter().find(|e| e.output == output);
    found.unwrap_or_else(|| panic!("{output} is not among {effects:?}"))
}

/// Returns the values of a characteristic over `[motion]`, each with its travel.
fn values(study: &Study, characteristic: Characteristic) -> Vec<(f64, f64)> {
    let mut alone = study.clone();
    alone.one_wheel_mut().unwrap().outputs = Outputs::of(vec![characteristic]);
    let curves = alone.curves().unwrap();
    let stations = curves.stations.iter();
    stations
        .map(|s| (s.at[0].unwrap(), s.values[0].unwrap()))
        .collect()
}

fn changes(before: &Study, after: &Study, of: Characteristic) -> Vec<(f64, f64)> {
    let pairs = values(before, of).into_iter().zip(values(after, of));
    pairs.map(|((at, b), (_, a))| (at, a - b)).collect()
}

/// Returns the largest change, with its travel.
fn largest(changes: &[(f64, f64)]) -> (f64, f64) {
    let all = changes.iter().copied();
    all.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).unwrap()
}

/// If only camber and kingpin curves of a strut are targets, toe becomes much worse. The reported change of toe equals
/// the difference between the curves of both designs, and toe is listed first. Outputs with a target are not listed.
#[test]
fn an_output_without_a_target_is_compared_with_the_curves_of_both_designs() {
    let targets = "optimise.targets=[\
        { characteristic = \"camber\", points = [[-80.0, 1.16], [0.0, -0.52], [80.0, -0.94]], tolerance = 0.02 }, \
        { characteristic = \"kingpin_inclination\", points = [[-80.0, 9.9], [80.0, 13.38]], tolerance = 0.05 }]";
    let variables = "optimise.variables=[\
        { hardpoint = \"strut_top\", axis = \"y\", range = [-20.0, 20.0] }, \
        { hardpoint = \"lower_arm_front\", axis = \"z\", range = [-20.0, 20.0] }]";
    let (before, after, effects) = tuned("macpherson_front", &[targets, variables]);
    for (output, of) in [
        ("toe", Characteristic::Toe),
        ("caster", Characteristic::Caster),
        ("scrub_radius", Characteristic::ScrubRadius),
        ("half_track_change", Characteristic::HalfTrackChange),
    ] {
        let effect = named(&effects, output);
        let (at, change) = largest(&changes(&before, &after, of));
        let found = effect.largest_change.unwrap();
        assert!((found - change).abs() < 1e-9, "{output}: {found} {change}");
        assert_eq!(effect.at[0].value, at, "{output}");
        for (study, ends) in [
            (&before, [effect.before_min, effect.before_max]),
            (&after, [effect.after_min, effect.after_max]),
        ] {
            let all = values(study, of).into_iter().map(|(_, value)| value);
            let low = all.clone().fold(f64::INFINITY, f64::min);
            let high = all.fold(f64::NEG_INFINITY, larger);
            assert!((ends[0].unwrap() - low).abs() < 1e-9, "{output}");
            assert!((ends[1].unwrap() - high).abs() < 1e-9, "{output}");
        }
        let flagged = effect.tolerance.is_some_and(|most| change.abs() > most);
        assert_eq!(effect.flagged, flagged, "{output}");
    }
    assert!(
        effects
            .iter()
            .all(|e| e.output != "camber" && e.output != "kingpin_inclination")
    );
    let flagged = effects.iter().take_while(|e| e.flagged).count();
    assert!(flagged > 0 && effects[flagged..].iter().all(|e| !e.flagged));
    assert_eq!(effects[0].output, "toe");
}

/// The first study of the README keeps toe to 0.1 degrees at every station. The program flags no angle as a side effect.
#[test]
fn the_first_study_keeps_its_toe() {
    let (before, after, effects) = tuned("macpherson_front", &[]);
    let (at, change) = largest(&changes(&before, &after, Characteristic::Toe));
    assert!(change.abs() < 0.1, "{change} at {at}");
    let angles = effects.iter().filter(|e| e.unit == "deg");
    assert!(angles.clone().count() > 0);
    assert!(angles.clone().all(|e| !e.flagged), "{effects:?}");
}

/// Returns the part of a change that is outside the range from zero to the target change of the nearest station.
fn beyond(change: f64, wanted: f64) -> f64 {
    change - change.clamp(wanted.min(0.0), wanted.max(0.0))
}

/// If caster has a target in the design position, caster may change by the same amount at every station. Only the rest
/// of the change is a side effect. A constraint on the kingpin inclination allows a change in the same way.
#[test]
fn a_change_that_a_target_asks_for_at_one_place_is_taken_off_elsewhere() {
    let targets = "optimise.targets=[{ characteristic = \"caster\", at = 0.0, value = 5.0, tolerance = 0.01 }]";
    let variables = "optimise.variables=[\
        { hardpoint = \"strut_top\", axis = \"x\", range = [-40.0, 40.0] }, \
        { hardpoint = \"strut_top\", axis = \"y\", range = [-40.0, 40.0] }]";
    let constraint = "optimise.constraints=[{ characteristic = \"kingpin_inclination\", between = [12.0, 14.0], at = \"design\" }]";
    let (before, after, effects) = tuned("macpherson_front", &[targets, variables, constraint]);
    for (output, of) in [
        ("caster", Characteristic::Caster),
        ("kingpin_inclination", Characteristic::KingpinInclination),
    ] {
        let changes = changes(&before, &after, of);
        let wanted = changes.iter().find(|(at, _)| *at == 0.0).unwrap().1;
        assert!(wanted.abs() > 0.5, "{output}: {wanted}");
        let beyond: Vec<(f64, f64)> = changes
            .iter()
            .map(|(at, c)| (*at, beyond(*c, wanted)))
            .collect();
        let (at, change) = largest(&beyond);
        let effect = named(&effects, output);
        let found = effect.largest_change.unwrap();
        assert!((found - change).abs() < 1e-9, "{output}: {found} {change}");
        assert_eq!(effect.at[0].value, at);
        let exceeds = change.abs() > effect.tolerance.unwrap();
        assert_eq!(effect.flagged, exceeds, "{effect:?}");
        assert!(change.abs() < 0.5 * wanted.abs(), "{effect:?}");
    }
}

/// A target of bump steer over the whole travel counts as a target of toe. If the target covers only a part of the
/// travel, it allows some change of toe beyond this part. The allowed change is the change of toe at the end of the
/// part, plus the change of slope there times the distance. Only a larger change is a side effect.
#[test]
fn a_target_of_a_gain_is_one_of_the_curve() {
    let of = |ends: &str| {
        let target = format!(
            "optimise.targets=[{{ characteristic = \"bump_steer\", points = [[-80.0, 0.0], [{ends}, 0.0]], tolerance = 0.001 }}]"
        );
        let variables = "optimise.variables=[{ hardpoint = \"tie_rod_inner\", axis = \"z\", range = [-10.0, 10.0] }]";
        tuned("macpherson_front", &[&target, variables])
    };
    let (_, _, effects) = of("80.0");
    assert!(effects.iter().all(|e| e.output != "toe"), "{effects:?}");
    let (before, after, effects) = of("20.0");
    let changes = changes(&before, &after, Characteristic::Toe);
    let end = changes.iter().find(|(at, _)| *at == 20.0).unwrap().1;
    let [was, is] = [&before, &after].map(|study| {
        let found = values(study, Characteristic::BumpSteer);
        found.iter().find(|(at, _)| *at == 20.0).unwrap().1
    });
    let rest = changes.iter().filter(|(at, _)| *at > 20.0);
    let rest: Vec<(f64, f64)> = rest
        .map(|(at, c)| (*at, beyond(*c, end + (is - was) * (at - 20.0))))
        .collect();
    let (at, change) = largest(&rest);
    let toe = named(&effects, "toe");
    assert!((toe.largest_change.unwrap() - change).abs() < 1e-9);
    assert!(change == 0.0 || toe.at[0].value == at, "{toe:?}");
}

/// A target for bump steer at one station requests a change of toe in proportion to the distance. Toe then changes as requested
/// at all other stations, except for a small curvature.
#[test]
fn a_gain_at_one_station_asks_for_the_slope_of_the_curve() {
    let target = "optimise.targets=[{ characteristic = \"bump_steer\", at = 0.0, value = 0.01, tolerance = 0.0001 }]";
    let variables = "optimise.variables=[{ hardpoint = \"tie_rod_inner\", axis = \"z\", range = [-20.0, 20.0] }]";
    let outputs = "outputs.characteristics=[\"toe\", \"camber\"]";
    let (before, after, effects) = tuned("macpherson_front", &[target, variables, outputs]);
    let changes = changes(&before, &after, Characteristic::Toe);
    let [was, is] = [&before, &after].map(|study| {
        let found = values(study, Characteristic::BumpSteer);
        found.iter().find(|(at, _)| *at == 0.0).unwrap().1
    });
    assert!((is - was).abs() > 0.001, "{was} {is}");
    let rest = changes.iter().filter(|(at, _)| *at != 0.0);
    let rest: Vec<(f64, f64)> = rest
        .map(|(at, c)| (*at, beyond(*c, (is - was) * at)))
        .collect();
    let (_, change) = largest(&rest);
    let toe = named(&effects, "toe");
    assert!((toe.largest_change.unwrap() - change).abs() < 1e-9);
    let whole = largest(&changes).1.abs();
    assert!(toe.asked_change.abs() > 0.5 * whole, "{toe:?} {whole}");
    assert!(change.abs() < 0.5 * whole, "{toe:?} {whole}");
    // The gain is no output of the study, so it is not compared.
    assert!(effects.iter().all(|e| e.output != "bump_steer"));
}

/// A tuned rocker does not affect the wheel: camber, toe and steering axis do not change at all. The spring length is
/// not a side effect. It has a target in the design position, and the motion ratio determines it at other travels.
#[test]
fn a_rocker_leaves_the_wheel_alone() {
    let (_, _, effects) = tuned("double_wishbone_rocker", &[]);
    for output in ["camber", "toe", "caster", "kingpin_inclination"] {
        let effect = named(&effects, output);
        assert!(effect.is_unchanged() && !effect.flagged, "{effect:?}");
        assert_eq!(effect.largest_change, Some(0.0));
        assert!(effect.at.is_empty());
    }
    assert!(effects.iter().all(|e| e.output != "spring_length"));
    // Without a wheel radius there is neither a contact point nor a scrub radius.
    assert!(effects.iter().all(|e| e.output != "scrub_radius"));
}

/// Flags do not depend on units: in inches every length and its tolerance is 1/25.4 of the value in millimetres.
#[test]
fn inches_flag_what_millimetres_flag() {
    let text = std::fs::read_to_string(path("double_wishbone_front")).unwrap();
    let targets = "optimise.targets=[{ characteristic = \"camber\", at = 0.0, between = [-5.0, 5.0], tolerance = 0.1 }]";
    let study = Study::from_text("mm.toml", &text, Path::new("."))
        .unwrap()
        .with_overrides("mm.toml", &[targets.to_owned()])
        .unwrap();
    let moved = study.moved(&[8.0, -4.0, 12.0, -6.0]);
    let effects = side_effects(&study, &moved).unwrap();
    let scaled = |study: &Study| {
        let mut scaled = study.clone();
        let own = scaled.one_wheel_mut().unwrap();
        own.suspension.length_unit = hardpoint::LengthUnit::Inch;
        for point in &mut own.suspension.design {
            *point = *point * (1.0 / 25.4);
        }
        own.suspension.wheel_radius = own.suspension.wheel_radius.map(|r| r / 25.4);
        for value in &mut own.motion.values {
            *value /= 25.4;
        }
        scaled
    };
    let inches = side_effects(&scaled(&study), &scaled(&moved)).unwrap();
    assert_eq!(effects.len(), inches.len());
    let lengths = effects.iter().filter(|e| e.unit == "mm");
    assert!(lengths.clone().any(|e| e.flagged) && lengths.count() >= 3);
    for (mm, inch) in effects.iter().zip(&inches) {
        assert_eq!((&mm.output, mm.flagged), (&inch.output, inch.flagged));
        let factor = match mm.unit.as_str() {
            "mm" => 1.0 / 25.4,
            "deg" => 1.0,
            _ => continue,
        };
        let pairs = [
            (mm.largest_change, inch.largest_change),
            (mm.tolerance, inch.tolerance),
            (mm.after_max, inch.after_max),
        ];
        for (mm, inch) in pairs {
            let (mm, inch) = (mm.unwrap() * factor, inch.unwrap());
            assert!((mm - inch).abs() < 1e-9, "{mm} {inch}");
        }
    }
}

/// Named motions have separate rows in the list. If the rack is at a stop, toe is a steer angle, which has no tolerance.
#[test]
fn named_motions_are_compared_too() {
    let (study, after, effects) = tuned("formula_student_front", &["optimise.starts=1"]);
    let locked = &study.motions[0].1;
    let [before, after] = [&study, &after].map(|of| of.clone().over(locked.clone()));
    let toe = named(&effects, "toe, locked");
    assert_eq!((toe.tolerance, toe.flagged), (None, false));
    // No target affects the half track, so its whole change counts.
    let (_, change) = largest(&changes(&before, &after, Characteristic::HalfTrackChange));
    let found = named(&effects, "half_track_change, locked")
        .largest_change
        .unwrap();
    assert!((found - change).abs() < 1e-9, "{found} {change}");
    assert!(
        named(&effects, "half_track_change, locked")
            .at
            .iter()
            .any(|c| c.name == "rack")
    );
}

/// The time to compare a motion with many stations is proportional to the number of stations. The program finds the
/// nearest station of a target without comparing all pairs.
#[test]
fn many_stations_are_compared_in_linear_time() {
    let motion = "motion.travel={ from = -40.0, to = 40.0, steps = 20001 }";
    let targets = "optimise.targets=[{ characteristic = \"toe\", points = [[-40.0, 0.1], [0.0, 0.1]], tolerance = 0.1 }]";
    let study = study("macpherson_front", &[motion, targets]);
    let moved = study.moved(&[1.0; 7]);
    let start = std::time::Instant::now();
    let effects = side_effects(&study, &moved).unwrap();
    assert!(named(&effects, "toe").largest_change.unwrap().abs() > 1e-3);
    assert!(start.elapsed().as_secs() < 60);
}

fn run(arguments: &[&str]) -> std::process::Output {
    let mut command = assert_cmd::Command::cargo_bin("hardpoint").unwrap();
    command
        .env_remove("COLUMNS")
        .args(arguments)
        .output()
        .unwrap()
}

/// Terminal, CSV, JSON, summary and page show the same side effects. If side effects are off, they show none, and `check`
/// reports that they are off.
#[test]
fn every_reader_gets_the_same_side_effects_or_none() {
    let directory = tempfile::tempdir().unwrap();
    let out = directory.path().join("run");
    let study = path("double_wishbone_front");
    let (study, to) = (study.to_str().unwrap(), out.to_str().unwrap());
    let said = run(&["optimise", study, "--out", to, "--report"]);
    let said = String::from_utf8(said.stdout).unwrap();
    let read = |name: &str| std::fs::read_to_string(out.join(name)).unwrap();
    let summary: Value = serde_json::from_str(&read("summary.json")).unwrap();
    let effects = summary["side_effects"].as_array().unwrap();
    let flagged = effects.iter().filter(|e| e["flagged"] == true).count();
    assert!(
        flagged > 0 && said.contains(&format!("{flagged} side effect")),
        "{said}"
    );
    let csv = read("side_effects.csv");
    let mut lines = csv.lines();
    assert_eq!(
        lines.next().unwrap(),
        "output,unit,before_min,before_max,after_min,after_max,largest_change,at,tolerance,flagged,lost"
    );
    assert_eq!(lines.count(), effects.len());
    // The page may break names after underscores.
    let page = read("report.html").replace("<wbr>", "");
    for effect in effects {
        let output = effect["output"].as_str().unwrap();
        assert!(csv.contains(&format!("\n{output},")), "{output}");
        assert!(page.contains(output), "{output}");
    }
    let printed = run(&["optimise", study, "--out", to, "--format", "json"]);
    let tables: Value = serde_json::from_slice(&printed.stdout).unwrap();
    let rows = tables["side_effects"].as_array().unwrap();
    assert_eq!(rows.len(), effects.len());
    for (row, effect) in rows.iter().zip(effects) {
        for key in [
            "output",
            "before_min",
            "after_max",
            "largest_change",
            "tolerance",
            "flagged",
        ] {
            assert_eq!(row[key], effect[key], "{key}");
        }
    }

    let off = ["--set", "optimise.side_effects=false"];
    let arguments = [
        "optimise", study, "--out", to, "--force", "--format", "json",
    ];
    let printed = run(&[&arguments[..], &off].concat());
    let tables: Value = serde_json::from_slice(&printed.stdout).unwrap();
    assert!(tables.get("side_effects").is_none());
    assert!(!out.join("side_effects.csv").exists());
    let summary: Value = serde_json::from_str(&read("summary.json")).unwrap();
    assert_eq!(summary["side_effects"].as_array().map(Vec::len), Some(0));
    let checked = |more: &[&str]| {
        let said = run(&[&["check", study][..], more].concat());
        one_line(&String::from_utf8(said.stdout).unwrap())
    };
    assert!(checked(&[]).contains("changes that no target asks for are reported"));
    assert!(checked(&off).contains("off (side_effects = false)"));
    let wrong = run(&["check", study, "--set", "optimise.side_effects=2"]);
    assert_eq!(wrong.status.code(), Some(2));
}

/// A report compares a robust tuning with the optimum without scatter. This optimum equals the tuning of the study
/// without `scatter`. Builds and yields equal those of `hardpoint tolerance`.
#[test]
fn a_robust_tuning_stands_beside_the_plain_optimum() {
    let directory = tempfile::tempdir().unwrap();
    let place = |name: &str| directory.path().join(name).to_str().unwrap().to_owned();
    let text = std::fs::read_to_string(path("double_wishbone_robust")).unwrap();
    let text = text
        .replace("builds = 20000", "builds = 2000")
        .replace("scatter = 64", "scatter = 16");
    // The bands are so narrow that some builds miss them.
    let text = text.replace("between = [-0.006, 0.006]", "between = [-0.002, 0.002]");
    let (robust, plain) = (place("robust.toml"), place("plain.toml"));
    std::fs::write(&robust, &text).unwrap();
    std::fs::write(&plain, text.replace("scatter = 16\n", "")).unwrap();
    let read = |run: &str, file: &str| -> Value {
        let text = std::fs::read_to_string(Path::new(run).join(file)).unwrap();
        serde_json::from_str(&text).unwrap()
    };
    let (out, other, builds) = (place("out"), place("other"), place("builds"));
    let said = run(&["optimise", &robust, "--out", &out]);
    let said = String::from_utf8(said.stdout).unwrap();
    run(&["optimise", &plain, "--out", &other]);
    let tuned = Path::new(&other).join("optimised.toml");
    run(&["tolerance", tuned.to_str().unwrap(), "--out", &builds]);
    let yields = &read(&out, "summary.json")["yields"];
    let share = yields["plain"].as_f64().unwrap();
    assert!((0.01..0.99).contains(&share), "{share}");
    let own = read(&builds, "summary.json")["yield_of_all"]
        .as_f64()
        .unwrap();
    assert_eq!(share, own);
    assert!(said.contains("optimum without scatter"), "{said}");
    let bands = yields["bands"].as_array().unwrap();
    assert!(!bands.is_empty());
    for band in bands {
        assert!(band["plain"].as_f64().is_some());
    }
}

/// If a target demands a change, the terminal lists this change in a separate line, not as unchanged. In this test the target is
/// for the caster in the design position. The motion is so short that the caster changes by the same amount everywhere.
#[test]
fn changes_as_asked_have_their_own_line() {
    let directory = tempfile::tempdir().unwrap();
    let out = directory.path().join("run");
    let study = path("macpherson_front");
    let sets = [
        "optimise.targets=[{ characteristic = \"caster\", at = 0.0, value = 5.0, tolerance = 0.01 }]",
        "optimise.variables=[{ hardpoint = \"strut_top\", axis = \"x\", range = [-40.0, 40.0] }]",
        "optimise.starts=1",
        "motion.travel=[-1.0, 0.0, 1.0]",
    ];
    let mut call = vec![
        "optimise",
        study.to_str().unwrap(),
        "--out",
        out.to_str().unwrap(),
    ];
    call.extend(sets.iter().flat_map(|set| ["--set", set]));
    let said = String::from_utf8(run(&call).stdout).unwrap();
    let text = std::fs::read_to_string(out.join("summary.json")).unwrap();
    let summary: Value = serde_json::from_str(&text).unwrap();
    let effects = summary["side_effects"].as_array().unwrap();
    let caster = effects.iter().find(|e| e["output"] == "caster").unwrap();
    assert!(
        caster["asked_change"].as_f64().unwrap().abs() > 0.1,
        "{caster}"
    );
    assert!(
        caster["largest_change"].as_f64().unwrap().abs() < 0.005,
        "{caster}"
    );
    let words = one_line(&said);
    let (before, unchanged) = words.split_once("unchanged: ").unwrap();
    assert!(before.contains("as targets ask: caster_deg"), "{said}");
    let (unchanged, _) = unchanged.split_once(" start ").unwrap();
    assert!(!unchanged.contains("caster_deg"), "{said}");
}
