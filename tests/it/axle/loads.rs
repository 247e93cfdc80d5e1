//! Tests of loads on both wheels of an axle: against each wheel alone, against mirror images, and against the work of the
//! spring.

use super::{sample as study, solved};
use hardpoint::axle::axle_curves;
use hardpoint::curves::{Curves, curves};
use hardpoint::plan::Plan;
use hardpoint::report::curves_csv;
use hardpoint::study::Study;
use std::path::Path;

fn column<'c>(curves: &'c Curves, name: &str) -> impl Iterator<Item = f64> + 'c {
    let place = curves.columns.iter().position(|c| c.name == name);
    let place = place.unwrap_or_else(|| panic!("{name}"));
    curves
        .stations
        .iter()
        .map(move |s| s.value(place).expect("a force"))
}

const LOADS: &str = "outputs.loads=[{name=\"braking\", at=\"contact_point\", force=[-3000.0, 400.0, 4000.0], \
    moment=[2e4, -3e4, 5e4]}, {name=\"kerb\", at=\"wheel_centre\", force=[-1000.0, -200.0, 2500.0]}]";

/// On level pads, the forces of the left wheel are identical, bit for bit, to those of the same study without an axle.
#[test]
fn on_pads_the_left_wheel_carries_what_a_corner_does() {
    for (name, corner) in [
        (
            "macpherson_axle",
            "motion={travel=[-30.0, 0.0, 40.0], rack=[0.0, 20.0]}",
        ),
        ("five_link_axle", "motion={travel=[-30.0, 0.0, 40.0]}"),
    ] {
        let few = "outputs.characteristics=[\"camber\"]";
        let motion = corner.replace("travel=", "heave=");
        let both = study(name, &[LOADS, few, &motion, "outputs.sensitivities=false"]).unwrap();
        let left = {
            let text = crate::support::sample(&format!("{name}.toml"));
            // Same study without its axle.
            let mut kept = String::new();
            let mut skips = false;
            for line in text.lines() {
                if line.starts_with('[') {
                    let of_axle = ["[axle", "[steering", "[spring", "[bump", "[anti", "[tyre"];
                    skips = of_axle.iter().any(|section| line.starts_with(section));
                }
                if !skips {
                    kept += line;
                    kept += "\n";
                }
            }
            let sets = [LOADS, few, corner, "outputs.sensitivities=false"];
            let directory = Path::new(env!("CARGO_TARGET_TMPDIR")).join("axle_loads");
            std::fs::create_dir_all(&directory).unwrap();
            let file = directory.join(format!("{name}.toml"));
            std::fs::write(&file, kept).unwrap();
            Study::read(&file, &sets.map(str::to_owned)).unwrap_or_else(|e| panic!("{e}"))
        };
        let found = curves(left.wheel(), &Plan::of(left.one_wheel().unwrap())).unwrap();
        let both = both.axle().unwrap().clone();
        let axle = axle_curves(&both.axle, &both.plan).unwrap().curves;
        assert_eq!(found.stations.len(), axle.stations.len());
        let mut forces = 0;
        for (k, force) in found.columns.iter().enumerate() {
            if !force.name.ends_with("_N") {
                continue;
            }
            let ours: Vec<_> = column(&axle, &format!("left_{}", force.name)).collect();
            let theirs: Vec<_> = found
                .stations
                .iter()
                .map(|s| s.values[k].unwrap())
                .collect();
            assert_eq!(ours, theirs, "{name} {}", force.name);
            forces += 1;
        }
        assert!(forces >= 12, "{forces}");
    }
}

/// Mirrored loads on a mirrored axle at zero roll cause mirrored forces. In roll the wheels swap roles when the angle
/// changes sign.
#[test]
fn mirrored_loads_are_carried_alike() {
    let few = "outputs.characteristics=[\"camber\"]";
    let loads = "outputs.loads=[{name=\"side\", side=\"left\", at=\"contact_point\", force=[-900.0, 1500.0, 4000.0], \
        moment=[2e4, -3e4, 5e4]}, {name=\"side\", side=\"right\", at=\"contact_point\", force=[-900.0, -1500.0, 4000.0], \
        moment=[-2e4, -3e4, -5e4]}]";
    // A load name may appear once on each side, but a load for both sides may not reuse that name.
    let both = loads.replacen("side=\"left\", ", "", 1);
    let said = study("macpherson_axle", &[&both]).unwrap_err();
    assert!(said.contains("is the name of another load"), "{said}");
    let motion = "motion={roll=[-2.0, 2.0], heave=10.0}";
    let found = solved("macpherson_axle", &[loads, few, motion]);
    let mut seen = 0;
    for name in found.columns.iter().map(|c| &c.name) {
        let Some(rest) = name.strip_prefix("left_side_") else {
            continue;
        };
        let left: Vec<_> = column(&found, name).collect();
        let right: Vec<_> = column(&found, &format!("right_side_{rest}")).collect();
        let sign = if rest.ends_with("_y_N") { -1.0 } else { 1.0 };
        let swapped = [sign * right[1], sign * right[0]];
        assert_eq!(left, swapped, "{name}");
        assert!(left[0] != left[1], "{name}");
        seen += 1;
    }
    assert!(seen > 8, "{seen}");
}

/// If a load along the ground normal equals the wheel load, it needs exactly the spring force that the program reports.
/// This also holds in roll. For any load, the spring force does the same work as the load.
#[test]
fn the_spring_takes_the_work() {
    let quantities = "outputs.characteristics=[\"wheel_load\", \"spring_force\", \"motion_ratio\"]";
    let motion = "motion={roll=3.0, heave=-12.0, rack=15.0}";
    let mut without_bar = study("macpherson_axle", &[quantities, motion])
        .unwrap()
        .axle()
        .unwrap()
        .clone();
    without_bar.axle.setup.bar_rate = None;
    let found = axle_curves(&without_bar.axle, &without_bar.plan)
        .unwrap()
        .curves;
    let value = |name: &str| column(&found, name).next().unwrap();
    let (sine, cosine) = 3.0_f64.to_radians().sin_cos();
    for side in ["left", "right"] {
        let load = value(&format!("{side}_wheel_load_N"));
        // Components in body axes, which are rolled relative to the ground.
        let (y, z) = (load * sine, load * cosine);
        let loads = format!(
            "outputs.loads=[{{name=\"ground\", side=\"{side}\", at=\"contact_point\", force=[0.0, {y:?}, {z:?}]}}]"
        );
        let found = solved("macpherson_axle", &[quantities, motion, &loads]);
        let carried = column(&found, &format!("{side}_ground_spring_N"))
            .next()
            .unwrap();
        let spring = value(&format!("{side}_spring_force_N"));
        assert!(
            (carried - spring).abs() < 1e-12 * spring.abs(),
            "{side}: {carried} {spring}"
        );
    }
    // At the wheel centre, the work of a vertical force is the force times the travel.
    let loads = "outputs.loads=[{name=\"kerb\", at=\"wheel_centre\", force=[0.0, 0.0, 2500.0]}]";
    let found = solved(
        "five_link_axle",
        &[
            "outputs={characteristics=[\"motion_ratio\"], sensitivities=false}",
            "motion={roll=[-3.0, 0.0, 3.0]}",
            loads,
        ],
    );
    for side in ["left", "right"] {
        let spring = column(&found, &format!("{side}_kerb_spring_N"));
        for (spring, ratio) in spring.zip(column(&found, &format!("{side}_motion_ratio"))) {
            assert!(
                (spring * ratio - 2500.0).abs() < 1e-9,
                "{side}: {spring} {ratio}"
            );
        }
    }
}

/// At the station where the spring has no leverage, the forces of the loaded wheel have no values. The status of this
/// station is `unsupported`.
#[test]
fn what_nothing_carries_has_a_status_and_no_values() {
    let text = crate::support::sample("semi_trailing_arm_solve.toml");
    let head = text.split("[motion]").next().unwrap();
    let text =
        format!("{head}[axle]\nright = \"mirrored\"\n[motion]\nheave = [-40.0, 0.0, 40.0]\n");
    let directory = Path::new(env!("CARGO_TARGET_TMPDIR")).join("axle_loads");
    std::fs::create_dir_all(&directory).unwrap();
    let file = directory.join("dead_centre.toml");
    std::fs::write(&file, text).unwrap();
    let overrides = [
        // In the design position, the upper spring end lies on the line from the lower spring end through the middle of the
        // hinge. So the spring has no leverage.
        "suspension.hardpoints.spring_lower=[70.0, 580.0, 270.0]",
        "suspension.hardpoints.spring_upper=[205.0, 470.0, 262.5]",
        "outputs={characteristics=[\"camber\"], loads=[{name=\"kerb\", at=\"wheel_centre\", force=[0, 0, 1000], side=\"right\"}]}",
    ];
    let study = Study::read(&file, &overrides.map(str::to_owned)).unwrap_or_else(|e| panic!("{e}"));
    let both = study.axle().unwrap().clone();
    let found = axle_curves(&both.axle, &both.plan).unwrap().curves;
    let words: Vec<_> = found.stations.iter().map(|s| s.status.word()).collect();
    assert_eq!(words, ["ok", "unsupported", "ok"]);
    assert!(!found.are_complete());
    for (k, c) in found.columns.iter().enumerate() {
        assert_eq!(
            found.stations[1].value(k).is_none(),
            c.name.ends_with("_N"),
            "{}",
            c.name
        );
        assert!(found.stations[0].value(k).is_some() && found.stations[2].value(k).is_some());
    }
    let csv = String::from_utf8(curves_csv(&found)).unwrap();
    assert!(
        csv.lines().nth(2).unwrap().ends_with(",,unsupported"),
        "{csv}"
    );
}

#[test]
fn mistakes_in_loads_are_named() {
    for (loads, words) in [
        (
            "{name=\"a\", at=\"contact_point\", side=\"middle\", force=[0, 0, 1]}",
            "unknown side",
        ),
        ("{name=\"a\", at=\"hub\", force=[0, 0, 1]}", "unknown place"),
        (
            "{name=\"a\", at=\"wheel_centre\"}",
            "expected a force, a moment or both",
        ),
        (
            "{name=\"a\", at=\"wheel_centre\", force=[1.0]}",
            "expected three components",
        ),
    ] {
        let said = study("macpherson_axle", &[&format!("outputs.loads=[{loads}]")]).unwrap_err();
        assert!(said.contains(words), "{loads}: {said}");
    }
    let load = "outputs.loads=[{name=\"a\", at=\"wheel_centre\", side=\"left\", force=[0, 0, 1]}]";
    let said = study("macpherson_solve", &[load]).unwrap_err();
    assert!(said.contains("side needs [axle]"), "{said}");
}
