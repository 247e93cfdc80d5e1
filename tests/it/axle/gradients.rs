//! Tests of gradients with respect to hardpoints against finite differences of fourth order.

use super::{axle, reference::read};
use crate::support::larger;
use hardpoint::axle::{AxleQuantity as A, AxleSolver, Placement, Quantity, WheelQuantity as W};
use hardpoint::model::Side::{Left, Right};
use hardpoint::number::Vector3;

/// Gradients equal slopes in three kinds of motion: in roll, where the travels depend on the design; at given travels, where
/// the roll angle depends on the design; and on pads. The test includes quantities that are made of second derivatives.
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
                // The roll centre has steep gradients where the normals are nearly parallel. Their finite differences have the
                // largest errors.
                assert!(
                    error < 1e-6,
                    "{quantity:?} by {name} {component}, {placement:?}: {} {slope}",
                    found[k]
                );
            }
        }
    }
}

/// The values of an axle are functions of the design. The derivatives of these functions equal the slopes. The test
/// includes an axle whose right wheel has separate hardpoints.
#[test]
fn an_axle_is_a_function_of_its_design() {
    use hardpoint::study::Study;
    use hardpoint::{DesignFunction, DesignStatus, DesignVariable};
    let path = crate::support::studies().join("macpherson_axle.toml");
    let few = "motion={ roll = [-1.5, 0.0, 2.0], rack = [0.0, 15.0] }".to_owned();
    let own = "axle.right={ hardpoints = { tie_rod_inner = [-110.0, -332.0, 245.0] } }".to_owned();
    for set in [vec![few.clone()], vec![few, own]] {
        let study = Study::read(&path, &set).unwrap();
        let names = ["strut_top_dy", "tie_rod_outer_z", "lower_arm_front_dz"];
        let variables = names.map(|name| DesignVariable::named(name, &study).unwrap());
        let f = DesignFunction::with_variables(&study, variables.into()).unwrap();
        let both = study.axle().unwrap();
        let curves = hardpoint::axle::axle_curves(&both.axle, &both.plan)
            .unwrap()
            .curves;
        let (outputs, stations) = (f.outputs(), f.stations());
        assert_eq!(stations, curves.stations.len());
        let id = study.wheel().mechanism.point("tie_rod_outer").unwrap();
        let height = study.wheel().design[id.0].z;
        let mut evaluation = f.evaluation();
        let mut values = |x: [f64; 3]| {
            let (mut values, mut status) = (vec![0.0; f.len()], [DesignStatus::Faulty]);
            evaluation.values(&x, &mut values, &mut status);
            assert_eq!(status, [DesignStatus::Ok]);
            values
        };
        let plain = values([0.0, height, 0.0]);
        for (k, name) in outputs.iter().enumerate() {
            let column = curves.columns.iter().position(|c| c.name == *name).unwrap();
            for (s, station) in curves.stations.iter().enumerate() {
                match station.value(column) {
                    None => assert!(plain[k * stations + s].is_nan(), "{name}"),
                    Some(wanted) => {
                        let found = plain[k * stations + s];
                        let scale = wanted.abs().max(1.0);
                        assert!(
                            (found - wanted).abs() < 1e-9 * scale,
                            "{name}: {found} {wanted}"
                        );
                    }
                }
            }
        }
        let x = [2.0, height - 1.0, 1.5];
        let (mut there, mut jacobian) = (vec![0.0; f.len()], vec![0.0; 3 * f.len()]);
        let mut status = [DesignStatus::Faulty];
        let mut differentiated = f.evaluation();
        differentiated.value_and_jacobian(&x, &mut there, &mut jacobian, &mut status);
        assert_eq!(status, [DesignStatus::Ok]);
        let h = 0.05;
        let mut compared = 0;
        for j in 0..3 {
            let mut at = |step: f64| {
                let mut moved = x;
                moved[j] += step;
                values(moved)
            };
            let [a, b, c, d] = [h, -h, 2.0 * h, -2.0 * h].map(&mut at);
            for (k, output) in outputs.iter().enumerate() {
                let row = (k * stations..(k + 1) * stations).filter(|i| there[*i].is_finite());
                let scale = row
                    .clone()
                    .map(|i| jacobian[3 * i + j].abs())
                    .fold(0.0, larger);
                for i in row {
                    let slope = (8.0 * (a[i] - b[i]) - (c[i] - d[i])) / (12.0 * h);
                    let found = jacobian[3 * i + j];
                    let bound = 1e-5 * scale + 1e-10 * there[i].abs().max(1.0) / h;
                    assert!(
                        (found - slope).abs() < bound,
                        "{output} {j}: {found} {slope}"
                    );
                    compared += 1;
                }
            }
        }
        // Only the Ackermann percentage and the turning circle have no value near straight ahead.
        assert!(compared > 3 * 9 * f.len() / 10, "{compared}");
    }
}
