//! Tests of spin axes given by camber and toe: a deviation of the wheel centre translates the axis.

use super::{assembler, parameter, plan, study};
use hardpoint::assembly::{Rest, built_curves};
use hardpoint::curves::curves;
use hardpoint::tolerance::Problem;

const ANGLES: &str = "outputs.characteristics=[\"camber\",\"toe\"]";
const POSITION: &str = "outputs.order=\"position\"";
/// Studies whose spin axis is given by angles.
const STUDIES: [&str; 3] = [
    "double_wishbone_tolerance",
    "five_link_rear",
    "semi_trailing_arm_rear",
];

/// A build has a wheel centre that is higher in its carrier by dz. At travel 0 this centre is at its design height, so
/// the carrier has the pose of travel -dz. So camber and toe change by -dz times their slopes over travel. Horizontal
/// deviations of the wheel centre do not change camber and toe. The wheel radius has no effect.
#[test]
fn a_wheel_centre_moves_its_spin_axis_in_parallel() {
    const STEP: f64 = 0.5;
    for name in STUDIES {
        for radius in ["wheel.radius=150.0", "wheel.radius=600.0"] {
            let travel = format!(
                "motion.travel=[{:?},{:?},0.0,{STEP:?},{:?}]",
                -2.0 * STEP,
                -STEP,
                2.0 * STEP
            );
            let study = study(name, &[radius, ANGLES, POSITION, &travel]);
            let assembler = assembler(&study);
            let nominal = assembler.build(assembler.drawn(), Rest::Height(0.0));
            let directions = ["x", "y", "z"]
                .map(|axis| [(parameter(&assembler, "wheel_centre", Some(axis)), 1.0)]);
            let directions: Vec<_> = directions.iter().map(|own| &own[..]).collect();
            let found =
                built_curves(&assembler, &nominal.unwrap(), &plan(&study), &directions).unwrap();
            for column in 0..2 {
                let value = |station: usize| found.curves.stations[station].values[column].unwrap();
                let near = (value(3) - value(1)) * 8.0;
                let slope = (near - (value(4) - value(0))) / (12.0 * STEP);
                let by = [0, 1, 2].map(|axis| found.derivative(axis, 2, column));
                assert!(by[0].abs() < 1e-12 && by[1].abs() < 1e-12, "{name}: {by:?}");
                assert!(
                    (by[2] + slope).abs() < 1e-9,
                    "{name}: {by:?}, slope {slope}"
                );
            }
            assert!(found.derivative(2, 2, 0).abs() > 1e-3, "{name}");
        }
    }
}

/// Builds with a scattered wheel centre have the same camber and toe for every radius of the wheel.
#[test]
fn angles_of_builds_do_not_depend_on_the_radius() {
    let scatter = "tolerance.scatter=[{hardpoint=\"wheel_centre\",sigma=1.0}]";
    let further = [
        "tolerance.bands=[]",
        "tolerance.aligned=false",
        "motion.travel=[-30.0,0.0,30.0]",
        ANGLES,
        POSITION,
        scatter,
    ];
    let values = |radius: &str, build: u64| {
        let overrides = [&further[..], &[radius]].concat();
        let study = study("double_wishbone_tolerance", &overrides);
        let problem = Problem::of(&study, study.tolerance.as_ref().unwrap()).unwrap();
        let built = problem.built(build).unwrap();
        let found = curves(&built, &plan(&study)).unwrap();
        let angles = found
            .stations
            .into_iter()
            .flat_map(|station| station.values);
        angles.map(Result::unwrap).collect::<Vec<f64>>()
    };
    for build in 0..4 {
        let usual = values("wheel.radius=300.0", build);
        for radius in ["wheel.radius=150.0", "wheel.radius=600.0"] {
            let found = values(radius, build);
            for (one, other) in usual.iter().zip(&found) {
                assert!((one - other).abs() < 1e-11, "{radius}: {one} {other}");
            }
        }
    }
}
