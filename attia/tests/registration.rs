//! A program must register the formulation in point coordinates before it can use it. This process starts without the
//! registration.

use hardpoint_engine::mechanism::DesignFault;
use hardpoint_engine::plan::Plan;
use hardpoint_engine::study::Study;
use std::path::Path;

/// Before the registration, the program reads a study that asks for the formulation, but refuses to solve it and names the
/// formulation. After the registration, it solves every station.
#[test]
fn a_study_is_refused_until_its_formulation_is_registered() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../studies/attia.toml");
    let study = Study::read(&path, &[]).unwrap_or_else(|e| panic!("{e}"));
    let solve =
        || hardpoint_engine::curves::curves(study.wheel(), &Plan::of(study.one_wheel().unwrap()));
    let fault = solve().unwrap_err();
    assert_eq!(fault, DesignFault::NoFormulation("point_coordinates"));
    assert!(
        fault
            .to_string()
            .contains("formulation = \"point_coordinates\"")
    );
    hardpoint_attia::register();
    let solved = solve().unwrap();
    assert!(!solved.stations.is_empty());
    assert_eq!(solved.failed(), 0);
}
