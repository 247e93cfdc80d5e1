//! Tests of recorded numbers.

use super::*;
use crate::number::{Dual, Jet};

fn formula<T: Real>(x: T, y: T) -> T {
    (x.sqrt() / (x.one() + y * y)).asin() + (x * y - x).atan2(x.constant(0.3) + y) - (-y)
}

/// Backward and forward differentiation give the same derivatives, also for the slope of a series.
#[test]
fn agrees_with_dual_numbers() {
    let tape = Tape::new();
    let (x, y) = (tape.input(0.6), tape.input(-0.4));
    let (p, q) = (Dual::<f64, 2>::input(0.6, 0), Dual::input(-0.4, 1));
    let series = (Jet([x, x.one()]), Jet::constant(y));
    let results = [formula(x, y), formula(series.0, series.1)[1]];
    let along = formula(Jet::<_, 2>::variable(p), Jet::constant(q))[1];
    let expected = [formula(p, q).partials, along.partials];
    tape.gradients(&results, 2, |number, gradient| {
        for (found, expected) in gradient.iter().zip(expected[number]) {
            assert!((found - expected).abs() < 1e-14, "{found} {expected}");
        }
    });
}

/// A tape may be used inside another one, and the older of two tapes may be dropped first. Each tape starts with its own
/// inputs, and the record is empty after the last tape.
#[test]
fn tapes_share_a_record() {
    let gradient = |tape: &Tape, of: Tracked<'_>| {
        let mut found = Vec::new();
        tape.gradients(&[of], 2, |_, by| found = by.to_vec());
        found
    };
    let of_two = |tape: &Tape| {
        let (x, y) = (tape.input(0.6), tape.input(-0.4));
        gradient(tape, formula(x, y))
    };
    let outer = Tape::new();
    let (x, y) = (outer.input(0.6), outer.input(-0.4));
    let product = x * y;
    let alone = of_two(&Tape::new());
    assert_eq!(outer.len(), 3);
    assert_eq!(gradient(&outer, product * x), [2.0 * 0.6 * -0.4, 0.36]);
    assert_eq!(gradient(&outer, formula(x, y)), alone);
    let newest = Tape::new();
    drop(outer);
    assert_eq!(of_two(&newest), alone);
    drop(newest);
    assert_eq!(RECORD.with_borrow(|record| record.nodes.len()), 0);
}

/// Results that share a pass are bit-identical to results of separate passes. Some results are constants or inputs, or have
/// undefined slopes.
#[test]
fn results_do_not_touch_each_other() {
    let tape = Tape::new();
    let inputs: Vec<_> = (0..5)
        .map(|k| tape.input(0.3 + 0.1 * f64::from(k)))
        .collect();
    let mut results: Vec<_> = (0..30)
        .map(|k| formula(inputs[k % 5], inputs[(k * 3 + 1) % 5].scaled(-1.0)))
        .collect();
    results[4] = Tracked::constant(2.0);
    results[9] = inputs[3];
    results[17] = (inputs[0] - inputs[0]).sqrt();
    let gradients = |of: &[Tracked<'_>]| {
        let mut all = Vec::new();
        tape.gradients(of, inputs.len(), |_, gradient| {
            all.push(gradient.iter().map(|g| g.to_bits()).collect::<Vec<_>>());
        });
        all
    };
    let together = gradients(&results);
    let alone: Vec<_> = results
        .iter()
        .flat_map(|result| gradients(&[*result]))
        .collect();
    assert_eq!(together, alone);
    assert_eq!(together[4], [0; 5]);
    assert!(f64::from_bits(together[17][0]).is_nan());
    let finite = together.iter().enumerate().filter(|(k, _)| *k != 17);
    assert!(
        finite
            .flat_map(|(_, g)| g)
            .all(|bits| f64::from_bits(*bits).is_finite())
    );
}
