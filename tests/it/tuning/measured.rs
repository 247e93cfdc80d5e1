//! Tests of targets from measured curves. Each row of a measured sheet applies at its own rack displacement and travel.

use hardpoint::curves::curves;
use hardpoint::optimise::{Control, tune};
use hardpoint::plan::Plan;
use hardpoint::study::Study;
use std::path::Path;

const SOLVE: &str = include_str!("../../../studies/double_wishbone_solve.toml");

/// Study of a wishbone with two rack displacements. The variable is the height of the tie rod's inner joint.
fn text(targets: &str) -> String {
    let of_racks = SOLVE.replace("\nrack = 0.0 ", "\nrack = [0.0, 10.0] ");
    assert_ne!(of_racks, SOLVE);
    format!(
        "{of_racks}\n[optimise]\nmax_iterations = 2\nvariables = [{{ hardpoint = \"tie_rod_inner\", axis = \"z\", range = [-5.0, 5.0] }}]\n\
         {targets}\n"
    )
}

fn read(directory: &Path, targets: &str) -> Result<Study, String> {
    Study::from_text("study.toml", &text(targets), directory).map_err(|e| e.to_string())
}

/// Toe of the wishbone at both rack displacements, as a sheet.
fn sheet(study: &Study) -> String {
    let plan = Plan::with_targets(study.one_wheel().unwrap(), study.optimise.as_ref());
    let curves = curves(study.wheel(), &plan).unwrap();
    let toe = curves.columns.iter().position(|c| c.name == "toe_deg");
    let mut sheet = "travel_mm,rack_mm,toe_deg\n".to_owned();
    for station in &curves.stations {
        let [travel, rack] = [0, 1].map(|k| station.at[k].unwrap());
        sheet += &format!("{travel},{rack},{}\n", station.value(toe.unwrap()).unwrap());
    }
    sheet
}

/// A sheet holds the toe of a design at two rack displacements. With one target for each displacement, this design has
/// zero misfit. The program refuses a single target for both displacements, because it would compare each displacement
/// with the mean of the two curves.
#[test]
fn a_sheet_of_several_racks_has_a_curve_for_each() {
    let directory = tempfile::tempdir().unwrap();
    let place = directory.path();
    let any = "targets = [{ characteristic = \"toe\", at = 0.0, value = 0.0, tolerance = 1.0 }]";
    let sheet = sheet(&read(place, any).unwrap());
    assert_eq!(sheet.lines().count(), 1 + 2 * 41);
    std::fs::write(place.join("sheet.csv"), sheet).unwrap();
    let target = |rack: &str| {
        format!(
            "{{ characteristic = \"toe\", file = \"sheet.csv\", rack = {rack}, tolerance = 0.01 }}"
        )
    };
    for fit in ["", "fit = true\n"] {
        let each = format!("{fit}targets = [{}, {}]", target("0.0"), target("10.0"));
        let study = read(place, &each).unwrap();
        let tuning = tune(
            &study.vehicle,
            study.optimise.as_ref().unwrap(),
            Control::default(),
        );
        let before = tuning.unwrap().before.unwrap();
        assert_eq!(before.targets.len(), 2);
        assert!(before.misfit < 1e-9, "{fit}{}", before.misfit);
        let both = format!("{fit}targets = [{}]", target("[0.0, 10.0]"));
        let error = read(place, &both).unwrap_err();
        assert!(error.contains("sheet.csv:2"), "{error}");
        assert!(error.contains("one target for each rack"), "{error}");
    }
}

/// With `fit = true`, the points of a target are measurements. The program refuses a measured point outside the motion
/// and names its line in the file. The program also refuses a target for a single travel outside the motion. Without
/// `fit`, it ignores the points of a target curve outside the motion.
#[test]
fn measurements_outside_of_the_motion_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    let place = directory.path();
    let rows = "travel_mm,toe_deg\n-60,0.3\n0,0.1\n60,0.2\n-200,5\n";
    std::fs::write(place.join("sheet.csv"), rows).unwrap();
    let target = |what: &str| {
        format!("targets = [{{ characteristic = \"toe\", {what}, tolerance = 0.01 }}]")
    };
    let points = "points = [[-200.0, 5.0], [0.0, 0.1], [60.0, 0.2]]";
    let outside = "-200 is outside of the motion, which runs from -80 to 80";
    for what in ["file = \"sheet.csv\"", points] {
        let error = read(place, &format!("fit = true\n{}", target(what))).unwrap_err();
        assert!(error.contains(outside), "{error}");
        assert!(error.contains("extend the motion"), "{error}");
        assert!(
            !what.starts_with("file") || error.contains("sheet.csv:5"),
            "{error}"
        );
        assert!(read(place, &target(what)).is_ok());
    }
    let error = read(place, &target("at = -200.0, value = 5.0")).unwrap_err();
    assert!(error.contains(outside), "{error}");
}
