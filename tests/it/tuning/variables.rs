//! Tests of variables that move several coordinates.

use super::*;

/// The test raises and tilts an arm together with the rack, and takes the curves of this design as targets. The tuning finds
/// the same moves.
#[test]
fn points_moved_together_come_back() {
    let variables = "optimise.variables=[
        { hardpoints = [\"lower_arm_front\", \"lower_arm_rear\"], axis = \"z\", range = [-30.0, 30.0] },
        { hardpoints = [\"lower_arm_front\", \"lower_arm_rear\"], factors = [1.0, -0.5], axis = \"z\", range = [-30.0, 30.0] },
        { hardpoint = \"tie_rod_inner\", axis = \"y\", range = [-30.0, 30.0] }]";
    let path = crate::support::studies().join("macpherson_front.toml");
    let study = Study::read(&path, &[variables.to_owned()]).unwrap_or_else(|e| panic!("{e}"));
    let optimise = planted(&study);
    assert_eq!(optimise.variables[1].name, "lower_arm_front+lower_arm_rear");
    let mut start = study.wheel().clone();
    let away = nalgebra::DVector::from_column_slice(&[-6.0, 8.0, 5.0]);
    let frame = study.wheel().frame;
    let design = &study.wheel().design;
    moved_design(
        design,
        &frame,
        &optimise.variables,
        &away,
        &mut start.design,
    );
    let point = |name: &str| study.wheel().mechanism.point(name).unwrap().0;
    let rear = point("lower_arm_rear");
    assert_eq!(start.design[rear].z - design[rear].z, -6.0 - 0.5 * 8.0);
    let tuning = tune(
        &study.at_design(start.design.clone()).vehicle,
        &optimise,
        Control::default(),
    )
    .unwrap();
    let best = tuning.best.unwrap();
    let apart = best.design.iter().zip(design);
    let worst = apart.map(|(a, b)| (*a - *b).norm()).fold(0.0, larger);
    assert!(worst < 1e-6, "{worst}");
    for (offset, away) in best.offsets.iter().zip(&away) {
        assert!((offset + away).abs() < 1e-6);
    }
}

/// A variable along a direction equals its coordinates moved together: the tuned design has the combined moves. The
/// table names the direction. The program refuses an invalid direction.
#[test]
fn a_variable_along_a_direction_is_its_coordinates_together() {
    let study = |variable: &str| {
        let variables = format!(
            "optimise.variables=[{variable}, \
             {{ hardpoint = \"tie_rod_inner\", axis = \"z\", range = [-20.0, 20.0] }}]"
        );
        let path = crate::support::studies().join("macpherson_front.toml");
        let travel = "motion.travel={ from = -60.0, to = 60.0, steps = 5 }".to_owned();
        Study::read(&path, &[variables, travel])
    };
    let along = "{ hardpoint = \"strut_top\", direction = [0.0, 3.0, 4.0], range = [-20.0, 20.0] }";
    let tuned = |written: &str| {
        let study = study(written).unwrap_or_else(|e| panic!("{e}"));
        let optimise = study.optimise.clone().unwrap();
        let control = Control::default();
        let tuning = tune(&study.vehicle, &optimise, control).unwrap();
        (study, optimise, tuning.best.unwrap())
    };
    let (study_of, optimise, best) = tuned(along);
    assert_eq!(optimise.variables[0].label(), "strut_top_along");
    assert_eq!(optimise.variables[0].name, "strut_top");
    let top = study_of.wheel().mechanism.point("strut_top").unwrap().0;
    let moved = best.design[top] - study_of.wheel().design[top];
    let by = best.offsets[0];
    assert!(by.abs() > 0.1, "{by}");
    let off = moved - hardpoint::number::Vector3::new(0.0, 0.6 * by, 0.8 * by);
    assert!(off.norm() < 1e-12 * moved.norm() + 1e-12, "{off:?}");
    // An axis written as a direction equals that axis.
    let axis = tuned("{ hardpoint = \"strut_top\", axis = \"y\", range = [-20.0, 20.0] }");
    let same =
        tuned("{ hardpoint = \"strut_top\", direction = [0.0, 5.0, 0.0], range = [-20.0, 20.0] }");
    assert_eq!(axis.1.variables, same.1.variables);
    assert_eq!(axis.2.offsets, same.2.offsets);
    for (written, wanted) in [
        (
            "{ hardpoint = \"strut_top\", direction = [0, 0, 0], range = [-2.0, 2.0] }",
            "expected a direction",
        ),
        (
            "{ hardpoint = \"strut_top\", direction = [0, 1], range = [-2.0, 2.0] }",
            "expected a direction",
        ),
        (
            "{ hardpoint = \"strut_top\", axis = \"x\", direction = [0, 1, 1], range = [-2.0, 2.0] }",
            "\"axis\" or \"direction\"",
        ),
        (
            "{ hardpoint = \"strut_top\", range = [-2.0, 2.0] }",
            "\"axis\" is missing",
        ),
        (
            &format!("{along}, {along}"),
            "along of strut_top is already a variable",
        ),
    ] {
        let said = match study(written) {
            Ok(_) => panic!("{written}"),
            Err(errors) => errors.to_string(),
        };
        assert!(said.contains(wanted), "{written}: {said}");
    }
}
