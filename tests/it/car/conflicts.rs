//! Tests of conflicts between constraints of a car.

use super::commands::{hardpoint, text};
use crate::support::{one_line, studies};
use hardpoint::study::CarStudy;

/// Constraints and targets of a tuning. Two limits of the same result contradict each other. The other limits do not
/// take part in this conflict.
const CHANGES: [&str; 3] = [
    "optimise.variables=[{axle=\"front\",rate=\"spring\",percent=30.0}, \
     {axle=\"front\",hardpoint=\"tie_rod_inner\",axis=\"z\",range=[-5.0,5.0]}]",
    "optimise.targets=[{characteristic=\"roll_gradient\",case=\"static\",value=3.4,tolerance=0.01}]",
    "optimise.constraints=[{case=\"static\",characteristic=\"front_left_wheel_load\",at_most=8000.0}, \
     {case=\"static\",characteristic=\"roll_gradient\",at_least=3.5}, \
     {axle=\"front\",length=\"tie_rod\",at_most=2000.0}, \
     {case=\"static\",characteristic=\"roll_gradient\",at_most=3.45}]",
];

/// The tuning names the two constraints that contradict each other, and no others.
#[test]
fn a_smallest_set_is_named() {
    let study = CarStudy::read(&studies().join("car.toml"), &CHANGES.map(str::to_owned))
        .unwrap_or_else(|errors| panic!("{errors}"));
    let tuned = study
        .tuned(study.optimise.as_ref().unwrap(), Default::default())
        .unwrap();
    // The program names constraints of load cases before constraints of axles.
    assert_eq!(tuned.tuning.contradiction, [1, 2]);
    let directory = tempfile::tempdir().unwrap();
    let path = studies().join("car.toml");
    let mut arguments = vec!["optimise", path.to_str().unwrap(), "--out", "tuned"];
    for change in CHANGES {
        arguments.extend(["--set", change]);
    }
    let said = hardpoint(directory.path(), &arguments).code(1);
    let said = text(&said.get_output().stdout);
    let said = one_line(&said);
    let words = "these constraints cannot all be satisfied: roll_gradient in static (at least 3.5";
    assert!(said.contains(words), "{said}");
    assert!(
        said.contains("; roll_gradient in static (at most 3.45"),
        "{said}"
    );
}

/// The tuning also names a constraint of an axle that cannot be met by itself.
#[test]
fn a_conflict_of_an_axle_alone_is_named() {
    let constraints = "optimise.constraints=[{axle=\"front\",length=\"tie_rod\",at_most=1.0}]";
    let changes = [CHANGES[0], CHANGES[1], constraints].map(str::to_owned);
    let study = CarStudy::read(&studies().join("car.toml"), &changes)
        .unwrap_or_else(|errors| panic!("{errors}"));
    let tuned = study
        .tuned(study.optimise.as_ref().unwrap(), Default::default())
        .unwrap();
    assert_eq!(tuned.tuning.contradiction, [0]);
}
