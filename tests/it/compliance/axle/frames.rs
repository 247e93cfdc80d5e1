//! Tests that results of an axle do not depend on the axes of the study. Also tests that the heave test raises both
//! wheels by the same travel.

use super::super::command::{hardpoint, study};
use super::super::support::{elastic, fourth_order};
use crate::support::rows_by_column;
use hardpoint::axle::axle_curves;
use std::collections::BTreeMap;
use std::path::Path;

/// Text of the subframe study with this motion, different wheels and a load case.
fn turned_in(motion: &str) -> String {
    let text = std::fs::read_to_string(study("subframe_axle_compliance.toml")).unwrap();
    let own = "[axle]\n[axle.right.hardpoints]\ntie_rod_outer = [-143.0, -683.0, 231.0]\n\
               [axle.right.spring]\nrate = 55.0\nforce = 7000.0\n";
    let load = "\n[outputs]\ncharacteristics = [\"toe\", \"toe_by_lateral_force_trail_30\", \"steer_by_rack\"]\n\
                loads = [{ name = \"kerb\", at = \"contact_point\", force = [-1500.0, 700.0, 2000.0] }]\n";
    let replaced = |text: String, old: &str, new: &str| {
        assert!(text.contains(old), "{old}");
        text.replacen(old, new, 1)
    };
    let text = replaced(text, "[axle]\nright = \"mirrored\"\n", own);
    replaced(
        text,
        "heave = { from = -30.0, to = 30.0, steps = 3 }",
        motion,
    ) + load
}

type Rows = Vec<BTreeMap<String, String>>;

/// Results of `kc` and `solve` in a directory: `kc.csv`, `levels.csv` and `curves.csv`.
fn results(here: &Path, name: &str) -> [Rows; 3] {
    for command in ["kc", "solve"] {
        let out = format!("{command}_{name}");
        let ran = hardpoint(&[command, name, "--out", &out, "--threads", "1"], here);
        let errors = String::from_utf8_lossy(&ran.stderr);
        assert_eq!(ran.status.code(), Some(0), "{command} {name}: {errors}");
    }
    ["kc/kc.csv", "kc/levels.csv", "solve/curves.csv"].map(|path| {
        let path = path.replacen('/', &format!("_{name}/"), 1);
        rows_by_column(&std::fs::read(here.join(path)).unwrap())
    })
}

/// Tests, loads and results of the same axle agree in three axis conventions. If +y points to the right, displacements
/// and forces along the rack change their sign.
#[test]
fn results_do_not_depend_on_the_axes() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let text = turned_in("heave = [6.0]\nrack = [-18.0]");
    std::fs::write(here.join("iso8855.toml"), text).unwrap();
    let expected = results(here, "iso8855.toml");
    // Deflections and forces of bushings are along the axes of the bushings.
    let along_study = |column: &str| {
        let parts = ["contact_point", "wheel_centre", "ball_joint"];
        parts.iter().any(|part| column.contains(part))
    };
    assert!(expected[0].iter().any(|row| row["rack_mm"] == "-18.0"));
    for (frame, turned) in [("x_rear", ["_x_", "_y_"]), ("sae_j670", ["_y_", "_z_"])] {
        let name = format!("{frame}.toml");
        let arguments = ["convert", "iso8855.toml", "--frame", frame, "--out", &name];
        assert_eq!(hardpoint(&arguments, here).status.code(), Some(0));
        let found = results(here, &name);
        for (found, expected) in found.iter().zip(&expected) {
            assert_eq!(found.len(), expected.len(), "{frame}");
            assert!(!found.is_empty());
            for (found, expected) in found.iter().zip(expected) {
                let quantity = expected.get("quantity").map_or("", String::as_str);
                let turns = |column: &str| {
                    let is_value = ["value", "secant"].contains(&column);
                    let along_rack = |name: &str| {
                        name.contains("steer_by_rack")
                            || name.contains("rack_force")
                            || name.contains("caster_by_rack")
                    };
                    column == "rack_mm"
                        || along_rack(column)
                        || is_value && along_rack(quantity)
                        || along_study(column) && turned.iter().any(|axis| column.contains(axis))
                };
                assert_eq!(
                    found.keys().collect::<Vec<_>>(),
                    expected.keys().collect::<Vec<_>>(),
                    "{frame}"
                );
                for (column, expected) in expected {
                    let numbers = [&found[column], expected].map(|text| text.parse::<f64>());
                    let [Ok(found), Ok(expected)] = numbers else {
                        assert_eq!(&found[column], expected, "{frame} {column}");
                        continue;
                    };
                    let expected = if turns(column) { -expected } else { expected };
                    let most = 1e-8 * expected.abs().max(1e-3);
                    assert!(
                        (found - expected).abs() <= most,
                        "{frame} {quantity} {column}: {found} {expected}"
                    );
                }
            }
        }
    }
}

/// In the test `heave` both wheels rise by the same travel. The change of wheel load per rise of the contact point is a
/// stiffness. The ride rate is this stiffness in series with the tyre. The wheels have different springs, so equal
/// loads would give different travels.
#[test]
fn ride_rates_of_heave_are_those_of_equal_travels() {
    let motion = |heave: f64| format!("heave = [{heave:?}]");
    let tyre = 220.0;
    // Height of the contact point and wheel load, for both wheels.
    let at = |heave: f64| {
        let text = turned_in(&motion(heave)).replace("\"toe\"", "\"camber\", \"wheel_load\"");
        let study = elastic(&text);
        let both = study.axle().unwrap();
        let curves = axle_curves(&both.axle, &both.plan).unwrap().curves;
        let value = |name: &str| {
            let column = curves.columns.iter().position(|c| c.name == name).unwrap();
            curves.stations[0].value(column).unwrap()
        };
        ["left", "right"].map(|side| {
            let camber = value(&format!("{side}_camber_deg")).to_radians();
            let height = heave - 310.0 * camber.cos();
            [height, value(&format!("{side}_wheel_load_N"))]
        })
    };
    let study = elastic(&turned_in(&motion(0.0)));
    let tests = hardpoint::rig::RigTests::of(&study, None).unwrap();
    let rows = rows_by_column(&tests.results.kc_csv());
    let step = 0.05;
    let around = [-2.0, -1.0, 1.0, 2.0].map(|steps| at(steps * step));
    for (side, name) in ["left", "right"].into_iter().enumerate() {
        let by = [0, 1].map(|what| fourth_order(around.map(|at| at[side][what]), step));
        let rate = by[1] / by[0];
        let expected = rate * tyre / (rate + tyre);
        let row = rows.iter().find(|row| {
            row["load"] == "heave"
                && row["quantity"] == "compliant_ride_rate"
                && row["wheel"] == name
        });
        let found: f64 = row.unwrap()["value"].parse().unwrap();
        assert!(
            (found - expected).abs() < 1e-7 * expected,
            "{name}: {found} {expected}"
        );
    }
}
