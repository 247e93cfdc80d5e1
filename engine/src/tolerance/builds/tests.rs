//! Compares builds in lanes with builds one by one.

use super::*;
use crate::study::Study;
use std::path::Path;

const BUILDS: usize = BLOCK;

fn study(name: &str, overrides: &[&str]) -> Study {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../studies/{name}.toml"));
    let overrides: Vec<String> = overrides.iter().map(|o| (*o).to_owned()).collect();
    Study::read(&path, &overrides).unwrap_or_else(|e| panic!("{e}"))
}

/// Studies of several topologies, some with rocker and anti-roll bar, and the adjustments of their toe and camber.
const STUDIES: [(&str, &str); 5] = [
    (
        "macpherson_solve",
        "{length=\"tie_rod\"},{shim=\"strut_top\",axis=\"y\"}",
    ),
    (
        "double_wishbone_solve",
        "{length=\"tie_rod\"},{shim=\"upper_ball_joint\",axis=\"y\"}",
    ),
    (
        "double_wishbone_rocker",
        "{length=\"tie_rod\"},{shim=\"upper_arm_front\",axis=\"y\"},{shim=\"upper_arm_rear\",axis=\"y\"}",
    ),
    (
        "five_link_solve",
        "{length=\"toe_link\"},{length=\"upper_rear_link\"}",
    ),
    (
        "semi_trailing_arm_solve",
        "{shim=\"arm_pivot_outer\",axis=\"x\"},{shim=\"arm_pivot_outer\",axis=\"z\"}",
    ),
];

/// Every coordinate of every hardpoint scatters by up to 2 mm, and so does the length of every member.
fn everything_scattered(name: &str, adjust: &str, aligned: bool) -> Study {
    let plain = study(name, &[]);
    let mechanism = &plain.wheel().mechanism;
    let points = mechanism.points.iter().map(|p| format!("{:?}", p.name));
    let points = points.collect::<Vec<_>>().join(",");
    let mut scatter = format!("{{hardpoints=[{points}],limits=[-2.0,2.0]}}");
    for (length, _) in crate::assembly::Member::all(mechanism) {
        scatter += &format!(",{{length={length:?},sigma=0.7}}");
    }
    study(
        name,
        &[
            "motion.travel=[-20.0,0.0,15.0]",
            "outputs.characteristics=[\"camber\",\"toe\",\"camber_gain\"]",
            &format!("setup.adjust=[{adjust}]"),
            &format!("tolerance.builds={BUILDS}"),
            "tolerance.seed=5",
            &format!("tolerance.aligned={aligned}"),
            &format!("tolerance.scatter=[{scatter}]"),
            "tolerance.bands=[]",
        ],
    )
}

/// Builds that are drawn, assembled and solved in lanes equal builds one by one, for every topology, with and without alignment.
/// The results have the same bits at any width, whatever the neighbouring builds are.
#[test]
fn builds_in_lanes_are_those_one_by_one() {
    for (name, adjust) in STUDIES {
        for aligned in [false, true] {
            let study = everything_scattered(name, adjust, aligned);
            let problem = Problem::of(&study, study.tolerance.as_ref().unwrap()).unwrap();
            let size = study.wheel().size();
            let mut single = Builder::new(&problem, None).unwrap();
            let rejects = single.solve(0, BUILDS).unwrap().rejects;
            let mut first: Option<Vec<Vector3<f64>>> = None;
            for width in Width::ALL.into_iter().filter(|w| w.is_available()) {
                let mut lanes = Builder::new(&problem, Some(width)).unwrap();
                let found = lanes.solve(0, BUILDS).unwrap();
                assert_eq!(found.rejects, rejects);
                let accepted = lanes.wheels[0].lanes.as_ref().unwrap().accepted;
                let in_lanes = accepted.iter().filter(|r| **r).count();
                assert!(in_lanes * 10 >= BUILDS * 9, "{name} {aligned}: {in_lanes}");
                for (a, b) in lanes.wheels[0]
                    .designs
                    .iter()
                    .zip(&single.wheels[0].designs)
                {
                    let off = (*a - *b).norm();
                    assert!(off < 1e-13 * size, "{name} {aligned}: {off}");
                }
                for output in 0..3 {
                    for build in 0..lanes.block.designs() {
                        let values = lanes.block.values(build, output);
                        for (a, b) in values.zip(single.block.values(build, output)) {
                            assert!((a - b).abs() < 1e-12 * size, "{name}: {a} {b}");
                        }
                    }
                }
                let before = first.get_or_insert(lanes.wheels[0].designs.clone());
                assert_eq!(before, &lanes.wheels[0].designs);
                lanes.solve(3, BUILDS - 3).unwrap();
                let points = study
                    .wheel()
                    .design
                    .len()
                    .max(lanes.wheels[0].parts.points.len());
                assert_eq!(before[3 * points..], lanes.wheels[0].designs);
            }
        }
    }
}

/// Builds far from the nominal design, of which many cannot be assembled. Assembly in lanes and one by one reject the same
/// builds. No build succeeds in lanes but fails one by one.
#[test]
fn builds_that_lanes_refuse_go_one_by_one() {
    for aligned in [false, true] {
        let study = study(
            "macpherson_tolerance",
            &[
                "motion.travel=[0.0,20.0]",
                "tolerance.builds=128",
                &format!("tolerance.aligned={aligned}"),
                "tolerance.scatter=[{length=\"tie_rod\",sigma=60.0},{length=\"lower_arm_front\",sigma=40.0}]",
                "tolerance.bands=[]",
            ],
        );
        let problem = Problem::of(&study, study.tolerance.as_ref().unwrap()).unwrap();
        let mut single = Builder::new(&problem, None).unwrap();
        let expected = single.solve(0, BUILDS).unwrap();
        let mut lanes = Builder::new(&problem, Some(Width::widest())).unwrap();
        let found = lanes.solve(0, BUILDS).unwrap();
        assert_eq!(found.rejects.len(), expected.rejects.len());
        assert!(!found.rejects.is_empty());
        let accepted = lanes.wheels[0].lanes.as_ref().unwrap().accepted;
        let in_lanes = accepted.iter().filter(|r| **r).count();
        assert!(in_lanes > 8 && in_lanes < BUILDS - found.rejects.len());
        assert_eq!(lanes.places, single.places);
        let size = study.wheel().size();
        for (a, b) in lanes.wheels[0]
            .designs
            .iter()
            .zip(&single.wheels[0].designs)
        {
            assert!((*a - *b).norm() < 1e-11 * size, "{:?}", *a - *b);
        }
    }
}

/// A block of random numbers equals the numbers of its builds.
#[test]
fn draws_by_the_block_are_those_by_the_build() {
    let study = study("double_wishbone_tolerance", &[]);
    let tolerance = study.tolerance.as_ref().unwrap();
    let mut block = vec![1.0; tolerance.sources() * BLOCK];
    tolerance.draw_block(1000, 100, &mut block);
    let mut draws = vec![0.0; tolerance.sources()];
    for place in 0..100 {
        tolerance.draw(1000 + place as u64, &mut draws);
        for (source, draw) in draws.iter().enumerate() {
            assert_eq!(block[source * BLOCK + place].to_bits(), draw.to_bits());
        }
    }
    assert!(block[100..BLOCK].iter().all(|z| *z == 0.0));
}
