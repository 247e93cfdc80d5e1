//! Gradients by hardpoints against differences of fourth order.

use super::{axle, reference::read};
use hardpoint::axle::{AxleQuantity as A, AxleSolver, Placement, Quantity, WheelQuantity as W};
use hardpoint::model::Side::{Left, Right};
use hardpoint::number::Vector3;

/// Also where the travels follow from the design (roll), where the roll angle does, and on pads; of quantities
/// made of second derivatives too.
#[test]
fn gradients_are_slopes() {
    let case = read("macpherson_front");
    let axle = axle(&case);
    let quantities = [
        Quantity::Axle(A::RollStiffness),
        Quantity::Axle(A::RollStiffnessOnRoad),
        Quantity::Axle(A::RollStiffnessAtLoad),
        Quantity::Axle(A::RideRate),
        Quantity::Axle(A::RollCentreHeight),
        Quantity::Axle(A::RollAngle),
        Quantity::Wheel(Right, W::WheelRate),
        Quantity::Wheel(Left, W::CamberToRoad),
    ];
    let rack = 30.0;
    let travels = |on_plane| Placement::Travels {
        travels: [12.0, -20.0],
        rack,
        on_plane,
    };
    let roll = Placement::Roll {
        heave: 10.0,
        roll: 0.04,
        rack,
    };
    for placement in [roll, travels(true), travels(false)] {
        let mut solver = AxleSolver::<4>::new(&axle, &quantities, false).unwrap();
        let placed = solver.place(&placement).unwrap();
        for (name, component) in [
            ("lower_arm_front", 2),
            ("tie_rod_outer", 0),
            ("strut_top", 1),
        ] {
            let id = axle.left.mechanism.point(name).unwrap().0;
            let mut found = vec![0.0; quantities.len()];
            let take = |k: usize, [left, right]: [&[Vector3<f64>]; 2]| {
                found[k] = (left[id] + right[id]).to_array()[component];
            };
            solver.gradients(&placed, &quantities, take).unwrap();
            let values = |h: f64| {
                let mut moved = axle.clone();
                let mut point = moved.left.design[id].to_array();
                point[component] += h;
                moved.left.design[id] = Vector3::from(point);
                let mut solver = AxleSolver::<4>::new(&moved, &quantities, false).unwrap();
                let placed = solver.place(&placement).unwrap();
                let state = solver.read(&placed).unwrap().state;
                quantities.map(|q| q.evaluate(&state))
            };
            let h = 0.05;
            let [a, b, c, d] = [h, -h, 2.0 * h, -2.0 * h].map(values);
            for (k, quantity) in quantities.iter().enumerate() {
                let slope = (8.0 * (a[k] - b[k]) - (c[k] - d[k])) / (12.0 * h);
                let size = slope.abs().max(1e-4 * a[k].abs()).max(1e-9);
                let error = (found[k] - slope).abs() / size;
                // The roll centre's is steep where the normals are close to parallel.
                assert!(
                    error < 1e-6,
                    "{quantity:?} by {name} {component}, {placement:?}: {} {slope}",
                    found[k]
                );
            }
        }
    }
}
