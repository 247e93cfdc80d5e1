//! Tests of gradients with respect to hardpoints against difference quotients of complete designs, and of mirror
//! images.

use super::{axle, case, study_of};
use hardpoint::axle::{AxleQuantity as A, AxleSolver, Placement, Quantity, WheelQuantity as W};
use hardpoint::model::Axis;
use hardpoint::model::Side::{Left, Right};

const SPRINGS: &str = "[spring]\nrate = 32.0\nforce = 4200.0\n[motion]\nheave = [0.0]\n";

fn wanted() -> Vec<Quantity> {
    let mut all: Vec<_> = [
        A::AxleSteer,
        A::AxleLateral,
        A::AxleLongitudinal,
        A::PinionAngle,
        A::RollSteer,
        A::RollCentreHeight,
        A::RollCentreLateral,
        A::ForceRollCentreHeight,
        A::JackingForceRatio,
        A::RigidAntiSquat,
        A::RigidAntiLift,
        A::DriveLoadTransfer,
        A::RollMoment,
        A::RideRate,
    ]
    .map(Quantity::Axle)
    .to_vec();
    all.extend([Left, Right].map(|side| Quantity::Wheel(side, W::WheelLoad)));
    all
}

const PLACES: [Placement; 3] = [
    Placement::Roll {
        heave: 12.0,
        roll: 0.05,
        rack: 0.0,
    },
    Placement::Travels {
        travels: [30.0, -10.0],
        rack: 0.0,
        on_plane: true,
    },
    Placement::Travels {
        travels: [30.0, -10.0],
        rack: 0.0,
        on_plane: false,
    },
];

/// Gradients equal difference quotients of complete designs, in which a point of the left half moves together with its
/// mirror image. The error of the quotient falls with the square of the step, so the test extrapolates from two steps.
/// Rounding leaves an error of 1e-9 of the size of the values.
#[test]
fn gradients_are_those_of_whole_designs() {
    for name in ["solid_four_link", "solid_three_link_panhard"] {
        let study = axle(&study_of(&case(name), SPRINGS));
        let wanted = wanted();
        let mut solver = AxleSolver::<4>::new(&study.axle, &wanted, false).unwrap();
        let base = study.axle.left.design.clone();
        for placement in PLACES {
            let placed = solver.place(&placement).unwrap();
            let mut gradients = vec![Vec::new(); wanted.len()];
            solver
                .gradients(&placed, &wanted, |number, [left, right]| {
                    let sum = left.iter().zip(right).map(|(l, r)| *l + *r);
                    gradients[number] = sum.collect::<Vec<_>>();
                })
                .unwrap();
            for point in [
                "lower_link_axle",
                "upper_link_chassis",
                "wheel_centre",
                "spring_upper",
            ] {
                let id = study.axle.left.mechanism.point(point).unwrap();
                for axis in Axis::ALL {
                    let mut values = |by: f64| {
                        let mut moved = base.clone();
                        moved[id.0][axis] += by;
                        solver.prepare([&moved, &moved]).unwrap();
                        let placed = solver.place(&placement).unwrap();
                        let state = solver.read(&placed).unwrap().state;
                        wanted
                            .iter()
                            .map(|q| q.evaluate(&state))
                            .collect::<Vec<_>>()
                    };
                    let mut quotient = |h: f64| {
                        let (up, down) = (values(h), values(-h));
                        up.iter()
                            .zip(down)
                            .map(|(u, d)| (u - d) / (2.0 * h))
                            .collect::<Vec<_>>()
                    };
                    let (coarse, fine) = (quotient(0.2), quotient(0.1));
                    let here = values(0.0);
                    for (k, quantity) in wanted.iter().enumerate() {
                        let expected = (4.0 * fine[k] - coarse[k]) / 3.0;
                        let found = gradients[k][id.0][axis];
                        let size = expected.abs().max(1e-2 * here[k].abs()).max(1e-4);
                        let error = (found - expected).abs() / size;
                        assert!(
                            error < 1e-6,
                            "{name} {placement} {quantity:?} by {point}.{}: {found} {expected}",
                            axis.name()
                        );
                    }
                }
            }
            solver.prepare([&base, &base]).unwrap();
        }
    }
}

/// A symmetric axle at a roll angle is the mirror image of itself at the opposite roll angle.
#[test]
fn a_symmetric_axle_is_its_mirror_image() {
    let study = axle(&study_of(&case("solid_four_link"), SPRINGS));
    assert!(study.axle.right.is_none());
    let wanted = wanted();
    let mut solver = AxleSolver::<3>::new(&study.axle, &wanted, false).unwrap();
    let mut at = |roll: f64| {
        let placement = Placement::Roll {
            heave: -15.0,
            roll,
            rack: 0.0,
        };
        let placed = solver.place(&placement).unwrap();
        solver.read(&placed).unwrap().state
    };
    let (left, right) = (at(0.06), at(-0.06));
    let value = |q: A, state| Quantity::Axle(q).evaluate(state);
    for (odd, scale) in [
        (A::AxleSteer, 1.0),
        (A::AxleLateral, 1e3),
        (A::RollCentreLateral, 1e3),
        (A::JackingForceRatio, 1.0),
        (A::DriveLoadTransfer, 1.0),
        (A::RollMoment, 1e7),
    ] {
        let sum = value(odd, &left) + value(odd, &right);
        assert!(sum.abs() < 1e-12 * scale, "{odd:?}: {sum:e}");
    }
    for (even, scale) in [
        (A::PinionAngle, 1.0),
        (A::AxleLongitudinal, 1e3),
        (A::RollCentreHeight, 1e3),
        (A::RigidAntiSquat, 1e2),
        (A::RideRate, 1e2),
    ] {
        let apart = value(even, &left) - value(even, &right);
        assert!(apart.abs() < 1e-12 * scale, "{even:?}: {apart:e}");
    }
}
