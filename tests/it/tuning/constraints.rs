//! Tests of constraints in SIMD lanes against constraints station by station.

use super::{DRIVE_SHAFT, edited};
use hardpoint::number::Width;
use hardpoint::optimise::{Assessment, Constrained, Objective, TargetLayout};
use nalgebra::DVector;

/// Every kind of constraint that is available in SIMD lanes, on a wishbone with a drive shaft.
const CONSTRAINTS: &str = "optimise.constraints=[\
    { characteristic = \"toe\", between = [-9.0, 9.0] }, \
    { length = [\"tie_rod_outer\", \"lower_arm_front\"], at_least = 10.0 }, \
    { point = \"tie_rod_outer\", inside = { rim = 150.0, from = -90.0, to = 20.0 } }, \
    { point = \"tie_rod_outer\", inside = { box = [[-500, 0, 0], [500, 900, 900]] } }, \
    { point = \"wheel_centre\", outside = { cylinder = { from = [0, 100, 100], to = [50, 400, 120], radius = 30.0 } } }, \
    { members = [\"tie_rod\", \"lower_arm_front\"], clearance = 5.0 }, \
    { members = [\"tie_rod\"], inside = { rim = 260.0, from = -90.0 } }, \
    { articulation = \"lower_ball_joint\", at_most = 20.0 }, \
    { articulation = \"tie_rod_outer\", at_most = 25.0 }, \
    { articulation = \"drive_shaft_outer\", at_most = 40.0 }, \
    { articulation = \"drive_shaft_inner\", at_most = 20.0 }, \
    { plunge = \"drive_shaft\", between = [-30.0, 20.0] }, \
    { coplanar = [\"lower_arm_front\", \"lower_arm_rear\", \"lower_ball_joint\", \"tie_rod_outer\"] }]";

/// Constraint values and their derivatives in SIMD lanes equal those of one station after another. They have the same
/// bits at every lane width.
#[test]
fn rows_in_lanes_are_those_of_station_by_station() {
    let [inner, outer] = DRIVE_SHAFT;
    let study = edited("double_wishbone_front.toml", &[inner, outer, CONSTRAINTS]);
    let (suspension, optimise) = (study.wheel(), study.optimise.as_ref().unwrap());
    let layout = TargetLayout::of(optimise, &study.vehicle);
    let x = DVector::from_column_slice(&[4.0, -3.0, 6.0, -7.0]);
    let at = |width: Option<Width>| {
        let problem = Objective::new(suspension, &optimise.variables, &layout).unwrap();
        let mut problem = problem.with_width(suspension, width);
        assert_eq!(problem.is_in_lanes(&x), width.is_some());
        let mut at = Assessment::new(&problem.shape());
        problem.assess(&x, &mut at).unwrap();
        at
    };
    let (alone, widest) = (at(None), at(Width::widest()));
    let off = |a: f64, b: f64| (a - b).abs() / (1.0 + b.abs());
    let residuals = widest
        .rows
        .residuals
        .iter()
        .zip(alone.rows.residuals.iter());
    let slopes = widest.rows.jacobian.iter().zip(alone.rows.jacobian.iter());
    assert!(residuals.len() > 300);
    for (a, b) in residuals.chain(slopes) {
        assert!(off(*a, *b) < 1e-11, "{a} {b}");
    }
    for width in Width::available() {
        assert_eq!(at(Some(width)), widest);
    }
}
