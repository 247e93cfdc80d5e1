//! Tests of mistakes in the study of a tuning.

use super::*;

/// If inputs of the Pareto front, of the scatter or of constraints are missing, the program reports them with the line.
#[test]
fn mistakes_in_front_scatter_and_constraints_are_refused() {
    for (edit, wanted) in [
        (
            "optimise.constraints=[{ point = \"wheel_centre\", inside = { rim = 150.0 } }]",
            "wheel_centre lies on the spin axis",
        ),
        (
            "optimise.constraints=[{ coplanar = [\"lower_arm_front\", \"lower_arm_rear\", \
             \"lower_arm_front\", \"tie_rod_inner\"] }]",
            "lower_arm_front is listed twice",
        ),
        (
            "optimise.constraints=[{ line = [\"strut_top\", \"strut_top\", \"tie_rod_inner\"] }]",
            "strut_top is listed twice",
        ),
        ("optimise.front=[\"camber\"]", "two or three targets"),
        (
            "optimise.front=[\"camber\", \"cambre\"]",
            "did you mean \"camber\"",
        ),
        ("optimise.front=[\"camber\", \"camber\"]", "listed twice"),
        ("optimise.scatter=64", "needs [tolerance]"),
        ("optimise.scatter=1", "from 2 to"),
    ] {
        let refused =
            hardpoint(&["optimise", "studies/macpherson_front.toml", "--set", edit]).code(2);
        let said = String::from_utf8(refused.get_output().stderr.clone()).unwrap();
        assert!(said.contains(wanted), "{edit}: {said}");
    }
}

/// Mistakes in constraints of drive shafts and of members in rims are reported.
#[test]
fn mistakes_in_shafts_and_rims_are_refused() {
    let [inner, outer] = DRIVE_SHAFT;
    for (constraint, wanted) in [
        ("{ plunge = \"drive_shaft\" }", "expected a limit"),
        (
            "{ plunge = \"drive_shaft\", between = [1.0, 2.0] }",
            "0 between them",
        ),
        (
            "{ articulation = \"drive_shaft_outer\", at_least = 3.0 }",
            "at_least has no meaning",
        ),
        (
            "{ members = [\"tie_rod\"], inside = { sphere = { centre = [0, 0, 0], radius = 9.0 } } }",
            "expected the key \"rim\"",
        ),
        (
            "{ members = [\"tie_rod\"], inside = { rim = 9.0 }, clearance = 9.0 }",
            "the region is empty",
        ),
        (
            "{ members = [\"tie_rod\"], inside = { rim = 9.0 }, radii = [1.0, 2.0] }",
            "one for each member",
        ),
        ("{ members = [\"tie_rod\"] }", "expected two members"),
        (
            "{ point = \"wheel_centre\", inside = { rim = 9.0 } }",
            "lies on the spin axis",
        ),
    ] {
        let constraint = format!("optimise.constraints=[{constraint}]");
        let path = crate::support::studies().join("macpherson_front.toml");
        let overrides = [inner.to_owned(), outer.to_owned(), constraint.clone()];
        let said = match Study::read(&path, &overrides) {
            Ok(_) => panic!("{constraint}"),
            Err(errors) => errors.to_string(),
        };
        assert!(said.contains(wanted), "{constraint}: {said}");
    }
}
