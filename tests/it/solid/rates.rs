//! Tests of spring rates at the wheels of solid axles, against the change of the loads between positions.

use super::{axle, case, study_of};
use hardpoint::axle::{AxleQuantity as A, AxleSolver, Placement, Quantity, WheelQuantity as W};
use hardpoint::model::Side::{Left, Right};

const SPRINGS: &str =
    "[spring]\nrate = 32.0\nforce = 4200.0\n[tyre]\nrate = 200.0\n[motion]\nheave = [0.0]\n";

/// Loads of both wheels and heights of both contact points, at travels on level pads.
fn at(solver: &mut AxleSolver<3>, travels: [f64; 2]) -> [[f64; 2]; 2] {
    let placement = Placement::Travels {
        travels,
        rack: 0.0,
        on_plane: false,
    };
    let placed = solver.place(&placement).unwrap();
    let read = solver.read(&placed).unwrap();
    let load = |side| Quantity::Wheel(side, W::WheelLoad).evaluate(&read.state);
    let height = |side| read.state.wheel(side).contact_point().z;
    [[load(Left), load(Right)], [height(Left), height(Right)]]
}

/// Wheel rates equal the change of load per change of height of one pad, while the other pad stays fixed. The test
/// computes both travels from differences of the contact point heights.
#[test]
fn wheel_rates_are_loads_by_heights_of_one_pad() {
    for name in ["solid_four_link", "solid_three_link_panhard"] {
        let study = axle(&study_of(&case(name), SPRINGS));
        let wanted = [Left, Right].map(|side| Quantity::Wheel(side, W::WheelRate));
        let mut solver = AxleSolver::<3>::new(&study.axle, &wanted, false).unwrap();
        for travels in [[0.0, 0.0], [25.0, -15.0], [30.0, 30.0]] {
            let placement = Placement::Travels {
                travels,
                rack: 0.0,
                on_plane: false,
            };
            let placed = solver.place(&placement).unwrap();
            let read = solver.read(&placed).unwrap();
            let found = wanted.map(|q| q.evaluate(&read.state));
            // Derivatives of loads and heights with respect to each travel. Two step sizes are extrapolated.
            let slopes = [0, 1].map(|wheel| {
                let mut slope = |h: f64| {
                    let mut moved = |by: f64| {
                        let mut travels = travels;
                        travels[wheel] += by;
                        at(&mut solver, travels)
                    };
                    let (above, below) = (moved(h), moved(-h));
                    [0, 1].map(|k| [0, 1].map(|i| (above[k][i] - below[k][i]) / (2.0 * h)))
                };
                let (near, far) = (slope(0.5), slope(1.0));
                [0, 1].map(|k| [0, 1].map(|i| (4.0 * near[k][i] - far[k][i]) / 3.0))
            });
            let [[by_left, rise_by_left], [by_right, rise_by_right]] = slopes;
            let determinant =
                rise_by_left[0] * rise_by_right[1] - rise_by_right[0] * rise_by_left[1];
            let expected = [
                (by_left[0] * rise_by_right[1] - by_right[0] * rise_by_left[1]) / determinant,
                (by_right[1] * rise_by_left[0] - by_left[1] * rise_by_right[0]) / determinant,
            ];
            for (found, expected) in found.into_iter().zip(expected) {
                assert!(
                    (found - expected).abs() < 1e-7 * expected.abs(),
                    "{name} {travels:?}: {found} {expected}"
                );
            }
        }
    }
}

/// The hop frequency of both wheels together comes from two parallel rates: the ride rate without tyres, and the tyre
/// rate.
#[test]
fn wheels_hop_together() {
    let share = "drive_share_front = 0.0\n";
    let text = study_of(&case("solid_four_link"), SPRINGS);
    assert!(text.contains(share));
    let text = text.replace(share, &format!("{share}unsprung_mass = 120.0\n"));
    let study = axle(&text);
    let wanted = [A::WheelHopFrequency, A::RideRate].map(Quantity::Axle);
    let mut solver = AxleSolver::<3>::new(&study.axle, &wanted, false).unwrap();
    let placement = Placement::Travels {
        travels: [0.0, 0.0],
        rack: 0.0,
        on_plane: false,
    };
    let placed = solver.place(&placement).unwrap();
    let read = solver.read(&placed).unwrap();
    let [hop, ride] = wanted.map(|q| q.evaluate(&read.state));
    // The ride rate includes the tyre in series.
    let (tyre, mass) = (200.0, 120.0);
    let rate = ride * tyre / (tyre - ride);
    let expected = (2.0 * (rate + tyre) * 1000.0 / mass).sqrt() / (2.0 * std::f64::consts::PI);
    assert!((hop - expected).abs() < 1e-9 * expected, "{hop} {expected}");
}
