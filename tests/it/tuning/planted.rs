//! Tests of tunings whose result the test has constructed.

use super::*;

/// The targets are the camber and kingpin curves of a known design. The search finds this design to 1e-9 m from 20
/// starts. The starts are up to 10 mm away in six coordinates, and the search takes tens of iterations.
#[test]
fn a_planted_design_is_recovered_from_every_start() {
    let study = strut();
    let suspension = study.wheel();
    let mut optimise = planted(&study);
    let variables = optimise.variables.clone();
    for seed in 0..20_u32 {
        // A simple generator is enough: the starts only have to be spread and reproducible.
        let mut state = u64::from(seed).wrapping_mul(0x9E37_79B9_7F4A_7C15) + 1;
        let mut offset = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            20.0 * ((state >> 11) as f64 / (1_u64 << 53) as f64) - 10.0
        };
        let mut start = suspension.clone();
        optimise.variables = variables
            .iter()
            .map(|variable| {
                let away = offset();
                let [moved] = variable.moves[..] else {
                    panic!("one coordinate each");
                };
                let point = &mut start.design[moved.point.0];
                let mut coordinates = point.to_array();
                coordinates[moved.axis as usize] += away;
                *point = coordinates.into();
                Variable {
                    range: [-30.0, 30.0],
                    ..variable.clone()
                }
            })
            .collect();
        let tuning = tune(
            &study.at_design(start.design.clone()).vehicle,
            &optimise,
            Control::default(),
        )
        .unwrap();
        let best = tuning
            .best
            .unwrap_or_else(|| panic!("seed {seed}: {:?}", tuning.before));
        let fit = tuning.starts.best_fit().unwrap();
        let iterations = fit.history.last().unwrap().iteration;
        let worst = best
            .design
            .iter()
            .zip(&suspension.design)
            .map(|(found, planted)| (*found - *planted).norm())
            .fold(0.0, larger);
        println!(
            "seed {seed}: {iterations} iterations, {worst:.1e} mm, {}",
            fit.termination
        );
        assert!(
            worst < 1e-6,
            "seed {seed}: {worst} mm away after {iterations} iterations"
        );
        assert!(iterations < 50, "seed {seed}: {iterations} iterations");
    }
}

/// Two lengths contradict each other. The tuning names these two lengths, and nothing else.
#[test]
fn a_planted_contradiction_is_named() {
    let study = edited(
        "macpherson_front.toml",
        &[
            "motion.travel={ from = -60.0, to = 60.0, steps = 7 }",
            "optimise.starts=1",
            "optimise.variables=[{ hardpoint = \"tie_rod_inner\", axis = \"y\", range = [-20.0, 20.0] }, \
             { hardpoint = \"lower_arm_front\", axis = \"z\", range = [-10.0, 10.0] }]",
            "optimise.constraints=[{ length = \"lower_arm_front\", at_least = 300.0 }, \
             { name = \"short\", length = \"tie_rod\", at_most = 355.0 }, \
             { name = \"long\", length = [\"tie_rod_inner\", \"tie_rod_outer\"], at_least = 365.0 }]",
        ],
    );
    let tuning = study.tune(Control::default()).unwrap();
    assert_eq!(tuning.contradiction, [1, 2]);
    let best = tuning.best.unwrap();
    assert!(best.constraints[1].margin < -1.0 || best.constraints[2].margin < -1.0);
}
