//! The five-link suspension, by the general closure.

use super::support::Worst;
use super::support::double_double::DoubleDouble as Dd;
use super::support::random::Random;
use super::truth::{Errors, H, Truth, lift, slope};
use super::{at, template, travel};
use hardpoint::characteristics::{Characteristic, Constants, Quantity, View};
use hardpoint::kinematics::{Lifted, Pose};
use hardpoint::model::{Drive, Mechanism, PointId};
use hardpoint::number::{Jet, Matrix3, Real, Vector3};
use std::array::from_fn;

/// A smooth motion of a knuckle is made up first; the rods are then cut to the length they have along
/// it. Their chassis ends are the centres about which the knuckle points move: five linear equations
/// for each would be needed in general, so the motion is planted in one pose instead, by choosing the
/// height of the wheel and reading off where the solver must arrive.
#[test]
fn ten_thousand_random_linkages_agree_with_thirty_digits() {
    let suspension = template("five_link");
    let mut random = Random(5);
    let mut errors = Errors::default();
    for i in 0..10_000 {
        let design = random.scattered(&suspension.design, 30.0);
        let (value, rack) = (80.0 * random.signed(), 20.0 * random.signed());
        errors.check(&suspension.mechanism, &design, value, rack, i % 100 == 0);
    }
    println!("{errors:?}");
    assert_eq!(errors.disagreed, 0);
    assert!(errors.solved > 9_000, "{errors:?}");
    assert!(errors.by_order[0].0 < 1e-13, "{errors:?}");
    for e in [errors.by_order[1], errors.by_order[2]] {
        assert!(e.0 < 1e-10, "{errors:?}");
    }
    for e in errors.sensitivities {
        assert!(e.0 < 1e-10, "{errors:?}");
    }
}
