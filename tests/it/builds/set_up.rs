//! Set-ups: what is wanted is there when the parts so adjusted are put together.

use super::{assembler, study};
use hardpoint::assembly::{Rest, SetUp, Static};
use hardpoint::characteristics::Characteristic;

fn solved(name: &str, overrides: &[&str]) -> SetUp {
    let study = study(name, overrides);
    SetUp::solve(&study, study.setup.as_ref().unwrap(), &assembler(&study)).unwrap()
}

fn value(found: &SetUp, of: Static) -> f64 {
    let place = found.statics.iter().position(|s| *s == of).unwrap();
    found.last().values[place]
}

/// As many adjustments as wanted values: all are met to rounding, and the spring has its drawn length.
#[test]
fn wishes_are_met_exactly_where_there_are_as_many_adjustments() {
    let found = solved(
        "double_wishbone_tolerance",
        &[
            "setup.adjust=[{length=\"pushrod\"},{shim=\"upper_ball_joint\",axis=\"y\"},{length=\"tie_rod\"}]",
        ],
    );
    assert!(found.is_met());
    let met = [
        (Static::Characteristic(Characteristic::Camber), -1.5),
        (Static::Characteristic(Characteristic::Toe), -0.1),
        (Static::RideHeight, 5.0),
    ];
    for (of, wanted) in met {
        assert!((value(&found, of) - wanted).abs() < 1e-10, "{of:?}");
    }
    let study = study("double_wishbone_tolerance", &[]);
    let [upper, lower] =
        ["spring_upper", "spring_lower"].map(|n| study.suspension.mechanism.point(n).unwrap().0);
    let length =
        |design: &[hardpoint::number::Vector3<f64>]| (design[upper] - design[lower]).norm();
    let off = length(&study.suspension.design) - length(&found.last().built.suspension.design);
    assert!(off.abs() < 1e-10, "{off}");
}

/// What a length unit of an adjustment does is the slope of the static values, those of the ride height with it.
#[test]
fn effects_are_slopes_of_the_static_values() {
    let name = "double_wishbone_tolerance";
    let study = study(name, &[]);
    let (assembler, setup) = (assembler(&study), study.setup.as_ref().unwrap());
    let found = SetUp::solve(&study, setup, &assembler).unwrap();
    for (k, adjustment) in setup.adjust.iter().enumerate() {
        // Differences of order four.
        let h = 0.05;
        let heights = [-2.0, -1.0, 1.0, 2.0].map(|step| {
            let mut parts = assembler.drawn().clone();
            let (parameter, share) = adjustment.change;
            parts.change(
                &assembler.suspension().mechanism,
                parameter,
                share * step * h,
            );
            assembler.build(&parts, Rest::Spring(0.0)).unwrap().height
        });
        let [a, b, c, d] = heights;
        let slope = (a - 8.0 * b + 8.0 * c - d) / (12.0 * h);
        let exact = *found.drawn.by[k].last().unwrap();
        assert!(
            (slope - exact).abs() < 1e-7 * exact.abs().max(0.1),
            "{slope} {exact}"
        );
    }
}

/// Shims are whole, a thread makes up for them where it can, and a wanted value that nothing moves is no set-up.
#[test]
fn shims_come_whole_and_what_cannot_be_met_is_named() {
    let stepped = solved("double_wishbone_tolerance", &[]);
    let shims = stepped.last().amounts[1] / 0.5;
    assert!((shims - shims.round()).abs() < 1e-12);
    assert!(stepped.is_met());

    let alone = solved(
        "macpherson_tolerance",
        &[
            "setup.adjust=[{length=\"tie_rod\"}]",
            "setup.want={camber=-2.0,toe=0.1}",
        ],
    );
    assert!(!alone.is_met());
    // The least squares of both: toe, which the rod moves most, nearly, camber hardly.
    let misses = alone.misses();
    assert!(misses[0].unwrap().abs() > 1.0 && misses[1].unwrap().abs() < 0.2);

    // More adjustments than wanted values: met, by the smallest of them.
    let more = solved("macpherson_tolerance", &["setup.want={toe=0.3}"]);
    assert!(more.is_met());
    let by = &more.drawn.by;
    let ratio = more.last().amounts[0] / more.last().amounts[1];
    assert!((ratio - by[0][1] / by[1][1]).abs() < 0.01, "{ratio}");
}

/// Least squares share out what a whole shim leaves: then a wish is missed that the shim itself hardly moves, and by no
/// more than that it is met. One that the adjustments do not reach is not, however coarse the shims are elsewhere.
#[test]
fn what_whole_shims_leave_is_none_wherever_it_ends() {
    let adjust = "setup.adjust=[{length=\"pushrod\",per_turn=2.5},{shim=\"upper_ball_joint\",axis=\"y\",step=1.0}]";
    for camber in (0..40).map(|k| -1.3 - 0.011 * f64::from(k)) {
        let want = format!("setup.want={{camber={camber:?}}}");
        let found = solved("double_wishbone_tolerance", &[adjust, &want]);
        assert!(
            found.is_met(),
            "{camber}: {:?} {:?}",
            found.misses(),
            found.by_steps
        );
        // Half a shim of 1 mm, 0.23 deg a mm; a tenth of a degree counts as a millimetre.
        for (by_steps, most) in found.by_steps.iter().zip([0.12, 0.06, 0.01, 0.001, 0.5]) {
            assert!(*by_steps < most, "{:?}", found.by_steps);
        }
    }
    let want = "setup.want={camber=-1.3,toe=3.0}";
    assert!(!solved("double_wishbone_tolerance", &[adjust, want]).is_met());
}
