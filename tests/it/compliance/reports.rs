//! Tests of what `kc` and `limits` report: columns of links, names of stops and bushings, and causes of failures.

use super::command::hardpoint;
use super::support::{elastic, with};
use crate::support::{one_line, rows_by_column};
use hardpoint::axle::ForceCurve;
use hardpoint::compliance::{ElasticAxle, ElasticFault, Lack, NoEquilibrium, Shape};
use hardpoint::mechanism::NoPose;
use hardpoint::report::no_equilibrium;
use hardpoint::study::Study;
use hardpoint::threads::stoppable;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

const SUBFRAME: &str = "subframe_axle_compliance.toml";
const TUBES: &str = "formula_student_compliance.toml";

/// Output of a command for a study, with its error messages.
fn said(command: &str, text: &str, directory: &Path) -> String {
    std::fs::write(directory.join("case.toml"), text).unwrap();
    let arguments: &[&str] = match command {
        "kc" => &["kc", "case.toml", "--out", "kc", "--force"],
        // The cells of a text table are broken into lines.
        "limits" => &["limits", "case.toml", "--format", "json"],
        _ => &[command, "case.toml"],
    };
    let ran = hardpoint(arguments, directory);
    let all = [ran.stdout, ran.stderr].concat();
    one_line(&String::from_utf8_lossy(&all))
}

/// Load levels that `kc` writes for a study.
fn levels(text: &str) -> Vec<BTreeMap<String, String>> {
    let directory = tempfile::tempdir().unwrap();
    let said = said("kc", text, directory.path());
    let written = std::fs::read(directory.path().join("kc/levels.csv"));
    rows_by_column(&written.unwrap_or_else(|_| panic!("{said}")))
}

/// Without `[spring]`, no force acts on a pushrod. Its column is empty. The other columns are those of a study whose
/// pushrod is rigid.
#[test]
fn a_pushrod_without_a_spring_has_an_empty_column() {
    let text = with(TUBES, "");
    let (head, tail) = text.split_once("[spring]").unwrap();
    let (_, tail) = tail.split_once("\n[").unwrap();
    let text = format!("{head}[{tail}")
        .replace("\"at_design_load\"", "\"free\"")
        .replace("  { load = \"vertical\", window = 400.0 },\n", "");
    let (plain, rod) = text.split_once("[links.pushrod]").unwrap();
    assert!(rod.trim().lines().count() == 2, "{rod}");
    let (with_rod, without) = (levels(&text), levels(plain));
    assert!(with_rod.len() > 10 && with_rod.len() == without.len());
    let mut tensions = 0;
    for (row, expected) in with_rod.iter().zip(&without) {
        assert_eq!(row["pushrod_tension_N"], "");
        for (column, cell) in expected {
            assert_eq!(&row[column], cell, "{column}");
            tensions += usize::from(column.ends_with("_tension_N") && !cell.is_empty());
        }
    }
    assert!(tensions > with_rod.len());
}

/// The bushing of a part in the middle of a solid axle belongs to the left half only. So its force has values for the left wheel,
/// and empty cells for the right wheel.
#[test]
fn a_bushing_in_the_middle_of_a_solid_axle_is_in_the_results() {
    let directory = tempfile::tempdir().unwrap();
    let text = with("solid_axle_five_links.toml", "").replace(", \"panhard_tension\"", "");
    let (head, tail) = text.split_once("[links.panhard]").unwrap();
    let tail = tail
        .split_once("\n[")
        .map_or(String::new(), |(_, rest)| format!("[{rest}"));
    let rubber =
        "[bushings.panhard_chassis]\nstiffness = [8000.0, 8000.0, 8000.0, 1.0e5, 1.0e5, 1.0e5]\n";
    let said = said("kc", &format!("{head}{rubber}{tail}"), directory.path());
    assert!(!said.contains("panicked"), "{said}");
    let written = std::fs::read(directory.path().join("kc/levels.csv")).unwrap();
    let rows = rows_by_column(&written);
    assert!(rows.iter().any(|row| row["status"] == "ok"));
    for row in rows.iter().filter(|row| row["status"] == "ok") {
        assert_eq!(row["right_panhard_chassis_force_x_N"], "");
        assert_ne!(row["left_panhard_chassis_force_x_N"], "");
    }
}

/// Semi-trailing arm with these bushings and this further text.
fn trailing(axial: f64, further: &str) -> String {
    let bushing = |name: &str| {
        format!("[bushings.{name}]\nstiffness = [{axial:?}, 5000.0, 5000.0, 1.0e5, 1.0e5, 1.0e5]\n")
    };
    format!(
        "[suspension]\ntopology = \"semi_trailing_arm\"\n[suspension.hardpoints]\n\
         arm_pivot_inner = [270.0, 170.0, 262.0]\narm_pivot_outer = [410.0, 550.0, 248.0]\n\
         wheel_centre = [0.0, 740.0, 310.0]\nspindle_inner = [-0.2, 640.0, 308.7]\n\
         spring_upper = [60.0, 570.0, 560.0]\nspring_lower = [70.0, 580.0, 270.0]\n[wheel]\nradius = 310.0\n\
         [spring]\nrate = 60.0\nforce = 4000.0\n{further}{}{}",
        bushing("arm_pivot_inner"),
        bushing("arm_pivot_outer")
    )
}

/// In droop, `limits` and `kc` name the rebound stop; in jounce they name the bump stop.
#[test]
fn each_stop_has_its_own_name() {
    let stop = "gap = 40.0\nforce_curve = [[0.0, 0.0], [5.0, 500.0], [10.0, 6000.0]]\n";
    let compliance =
        "[compliance]\nrelaxed = \"free\"\ntests = [{ load = \"lateral\", stations = \"all\" }]\n";
    for (section, travel, own, other) in [
        ("rebound_stop", "[-80.0, 0.0]", "rebound stop", "bump stop"),
        ("bump_stop", "[0.0, 70.0]", "bump stop", "rebound stop"),
    ] {
        let directory = tempfile::tempdir().unwrap();
        let text = trailing(
            500.0,
            &format!("[motion]\ntravel = {travel}\n[{section}]\n{stop}{compliance}"),
        );
        let limits = said("limits", &text, directory.path());
        assert!(limits.contains(&format!("{own} beyond")), "{limits}");
        let rig = said("kc", &text, directory.path());
        assert!(
            rig.contains(&format!("the {own} is in contact in")),
            "{rig}"
        );
        // The rebound stop acts before the spring is slack. Beyond this, the stop pulls.
        assert_eq!(
            limits.contains("spring slack"),
            own == "bump stop",
            "{limits}"
        );
        for said in [limits, rig] {
            assert!(!said.contains(other), "{said}");
        }
    }
}

fn axle_of(study: &Study) -> Result<ElasticAxle, hardpoint::compliance::AxleFault> {
    let own = study.axle().unwrap();
    let parts = &own.axle.elastic.as_ref().unwrap().parts;
    let suspensions = own.axle.on_rig(None).suspensions;
    let designs = suspensions.map(|wheel| &wheel.design[..]);
    ElasticAxle::of(suspensions, designs, parts)
}

/// If the force curve of a subframe's mount does not reach the force at the design load, the message names the mount.
#[test]
fn a_mount_out_of_reach_is_named() {
    let study = elastic(&with(SUBFRAME, ""));
    let own = study.axle().unwrap();
    let mut parts = own.axle.elastic.as_ref().unwrap().parts.clone();
    let points = [
        [-0.02, -10.0],
        [-0.01, -10.0],
        [0.0, 0.0],
        [0.01, 10.0],
        [0.02, 10.0],
    ];
    parts.subframe.as_mut().unwrap().mounts[1].shapes[2] = Shape::Curve {
        curve: ForceCurve::through(&points).unwrap(),
        scale: 1.0,
    };
    let suspensions = own.axle.on_rig(None).suspensions;
    let designs = suspensions.map(|wheel| &wheel.design[..]);
    let fault = ElasticAxle::of(suspensions, designs, &parts).unwrap_err();
    assert!(
        matches!(&fault.fault, ElasticFault::OutOfReach { bushing, axis: 2 } if bushing == "subframe_rear"),
        "{fault:?}"
    );
    assert!(
        fault
            .describe()
            .contains("along z of the bushing subframe_rear"),
        "{fault:?}"
    );
}

/// The search for an equilibrium of an axle stops if a later request raises the flag.
#[test]
fn the_search_of_an_axle_can_be_stopped() {
    let axle = axle_of(&elastic(&with(SUBFRAME, ""))).unwrap();
    let search = || axle.at([10.0, -10.0], 0.0).is_ok();
    let flag = |raised: bool| Arc::new(AtomicBool::new(raised));
    assert_eq!(stoppable(&flag(false), search), Some(true));
    assert_eq!(stoppable(&flag(true), search), None);
}

/// A failure names its own cause: singular equations, and parts without elastic model, are not instability.
#[test]
fn failures_have_their_own_causes() {
    let of = |lack: Lack| NoEquilibrium {
        share: 0.0,
        lack,
        softest: None,
    };
    let unstable = "not stable";
    for (lack, words, pose) in [
        (Lack::Stability, unstable, NoPose::Unstable),
        (
            Lack::Equilibrium,
            "no equilibrium is found",
            NoPose::NoEquilibrium { share: 0.0 },
        ),
        (Lack::Derivatives, "no derivatives", NoPose::NoDerivatives),
        (
            Lack::Model("the curve ends".to_owned()),
            "the curve ends",
            NoPose::NoModel,
        ),
    ] {
        let why = of(lack);
        let said = no_equilibrium(&why);
        assert!(said.contains(words), "{said}");
        assert_eq!(said.contains(unstable), pose == NoPose::Unstable);
        assert_eq!(NoPose::from(why), pose);
    }
}

/// If at most the torsional stiffness of bushings holds an unloaded part, the message names this part. The parts are a wheel
/// carrier, and a subframe whose mounts have no stiffness along x.
#[test]
fn unloaded_parts_without_stiffness_are_named() {
    let directory = tempfile::tempdir().unwrap();
    let motion = "[motion]\ntravel = 0.0\n[compliance]\nrelaxed = \"free\"\n";
    let mirrored = motion.replace("travel", "heave") + "[axle]\nright = \"mirrored\"\n";
    let subframe = with(SUBFRAME, "")
        .replace("\"at_design_load\"", "\"free\"")
        .replace("[4000.0, 5000.0, 3500.0,", "[0.0, 5000.0, 3500.0,")
        .replace("[3000.0, 4000.0, 2500.0,", "[0.0, 4000.0, 2500.0,");
    for (text, part) in [
        (trailing(0.0, motion), "the wheel carrier"),
        (trailing(0.0, &mirrored), "the left wheel carrier"),
        (subframe, "the subframe or the rack"),
    ] {
        let said = said("kc", &text, directory.path());
        let cause = format!("at most the torsional stiffness of bushings holds {part}:");
        assert!(said.contains(&cause), "{said}");
    }
    let held = said("kc", &trailing(500.0, motion), directory.path());
    assert!(
        held.contains("toe_by_heave") && !held.contains("torsional"),
        "{held}"
    );
}
