//! Tests of variables that change the same distance of a car.

use super::one_point;
use crate::support::larger;
use hardpoint::car::{CarQuantity, CarSolver, CarVariable, Case, Moves, moved};
use hardpoint::model::Axis;
use hardpoint::study::CarStudy;
use std::path::Path;

/// A variable moves the front wheel centre along x, and another one changes the wheelbase. The order of the variables does not
/// matter, and the slopes are those of finite differences.
#[test]
fn the_order_of_variables_does_not_matter() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies/off_road_car.toml");
    let base = CarStudy::read(&path, &[]).unwrap().car;
    let centre = one_point(0, base.axles[0].left.mechanism.wheel_centre, Axis::X);
    let wheelbase = Moves::Wheelbase.value(&base).unwrap();
    let variables = [centre, Moves::Wheelbase].map(|moves| CarVariable {
        moves,
        range: [f64::NEG_INFINITY, f64::INFINITY],
    });
    let x = [4.0, wheelbase + 30.0];
    let car = moved(&base, &variables, &x);
    let mut reversed = variables.clone();
    reversed.reverse();
    assert_eq!(moved(&base, &reversed, &[x[1], x[0]]), car);
    let mut case = Case::at_rest("static");
    case.setting.elastic_tyres = false;
    let distance = CarQuantity::named("wheelbase_at_contact")[0];
    let at = |x: &[f64]| {
        let car = moved(&base, &variables, x);
        let mut solver = CarSolver::new(&car).unwrap();
        let found = solver.solve(&case).unwrap();
        let of = solver.gradients(&case, &found, &[distance]).unwrap();
        (
            of[0].value,
            variables
                .each_ref()
                .map(|own| own.moves.slope(&car, &of[0])),
        )
    };
    let (_, slopes) = at(&x);
    let mut worst = 0.0;
    for (k, slope) in slopes.into_iter().enumerate() {
        let beside = |step: f64| {
            let mut x = x;
            x[k] += step;
            at(&x).0
        };
        let by_step = (beside(0.01) - beside(-0.01)) / 0.02;
        worst = larger(worst, (slope - by_step).abs());
    }
    assert!(worst < 1e-5, "{worst}");
}
