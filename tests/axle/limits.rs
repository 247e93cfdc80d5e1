//! How far axles go.

use super::{axle, reference::read};
use hardpoint::axle::{AxleSolver, Placement};
use hardpoint::model::Side;

/// The rack goes as far as the first tie rod lets it: one of a strut from -113.3 to 164.5 mm, so both from -113.3 to
/// 113.3. Rolled almost to the end the axle has a position, beyond it none.
#[test]
fn the_first_wheel_to_end_is_the_end() {
    let axle = axle(&read("macpherson_front"));
    let mut solver = AxleSolver::<1>::new(&axle, &[], false).unwrap();
    let limits = solver.limits().unwrap();
    let [lower, upper] = limits.rack.unwrap();
    assert_eq!((lower.side, upper.side), (Side::Left, Side::Right));
    assert!((lower.value + 113.3).abs() < 0.05, "{}", lower.value);
    assert_eq!(lower.value, -upper.value);

    let [lower, upper] = limits.roll.map(Option::unwrap);
    assert_eq!((lower.side, upper.side), (Side::Left, Side::Right));
    assert!((lower.value + upper.value).abs() < 1e-9, "{}", lower.value);
    let mut at = |share: f64| {
        solver.place(&Placement::Roll {
            heave: 0.0,
            roll: share * upper.value,
            rack: 0.0,
        })
    };
    let placed = at(0.9999).unwrap();
    let end = limits.travels[1].upper.value();
    assert!(
        (placed.travels[1] - end).abs() < 1e-3 * end,
        "{placed:?} {end}"
    );
    assert!(at(1.001).is_err());
}
