//! Tests of every quantity of an axle with different sides. One reference is the mirrored axle. The other reference is
//! an independent evaluation from wheel positions, ground geometry and finite differences between positions.

use super::independent::Independent;
use super::independent_values::{Values, axle_values, values_of_motions, wheel_values};
use super::one_state::{axles, natural};
use super::reference::condition;
use hardpoint::axle::{
    Axle, AxleQuantity as A, AxleSolver, Placement, Quantity, WheelQuantity as W,
};
use hardpoint::characteristics::Characteristic as C;
use hardpoint::model::Side::{Left, Right};
use hardpoint::number::Vector3;
use std::collections::BTreeMap;

/// Axles whose right wheel is not the mirror image of the left one.
fn different() -> Vec<(&'static str, Axle)> {
    let all = axles().into_iter().filter(|(_, axle)| axle.right.is_some());
    let all: Vec<_> = all.collect();
    assert_eq!(all.len(), 3);
    all
}

/// Mirrored axle: each wheel on the other side.
fn mirrored(axle: &Axle) -> Axle {
    let mut setup = axle.setup.clone();
    if let Some(springs) = &mut setup.springs {
        springs.swap(0, 1);
    }
    Axle {
        left: axle.right.clone().unwrap(),
        right: Some(axle.left.clone()),
        setup,
        elastic: None,
    }
}

fn mirrored_placement(placement: &Placement) -> Placement {
    match *placement {
        Placement::Roll { heave, roll, rack } => Placement::Roll {
            heave,
            roll: -roll,
            rack: -rack,
        },
        Placement::AtLoad { heave, roll, rack } => Placement::AtLoad {
            heave,
            roll: -roll,
            rack: -rack,
        },
        Placement::Travels {
            travels: [left, right],
            rack,
            on_plane,
        } => Placement::Travels {
            travels: [right, left],
            rack: -rack,
            on_plane,
        },
    }
}

/// True if the quantity changes its sign in the mirrored axle.
fn is_odd(quantity: Quantity) -> bool {
    match quantity {
        Quantity::Corner(..) | Quantity::Figure(_) => false,
        Quantity::Wheel(_, q) => matches!(q, W::Steer | W::RollCamber | W::RollCamberToRoad),
        Quantity::Axle(q) => matches!(
            q,
            A::RollAngle
                | A::RollCentreLateral
                | A::RollCentreMigrationVertical
                | A::ForceRollCentreMigration
                | A::JackingForceRatio
                | A::MeanSteer
                | A::BarTorque
                | A::TBarTorque
                | A::RollMoment
        ),
    }
}

fn on_other_side(quantity: Quantity) -> Quantity {
    let other = |side| if side == Left { Right } else { Left };
    match quantity {
        Quantity::Corner(side, c) => Quantity::Corner(other(side), c),
        Quantity::Wheel(side, q) => Quantity::Wheel(other(side), q),
        axle => axle,
    }
}

fn placements(steers: bool) -> Vec<Placement> {
    let rack = |rack: f64| if steers { rack } else { 0.0 };
    let roll = |heave: f64, degrees: f64, by: f64| Placement::Roll {
        heave,
        roll: degrees.to_radians(),
        rack: rack(by),
    };
    let travels = |travels: [f64; 2], by: f64, on_plane| Placement::Travels {
        travels,
        rack: rack(by),
        on_plane,
    };
    vec![
        roll(0.0, 0.0, 0.0),
        roll(6.0, -1.6, 12.0),
        roll(-7.0, 1.2, -14.0),
        travels([5.0, -8.0], 11.0, false),
        travels([-4.0, 9.0], -9.0, true),
        Placement::AtLoad {
            heave: 4.0,
            roll: 1.1_f64.to_radians(),
            rack: rack(8.0),
        },
    ]
}

/// Quantities of the catalogue that are available for the axle.
fn quantities(axle: &Axle) -> Vec<Quantity> {
    let all = Quantity::names().into_iter().flat_map(Quantity::named);
    all.filter(|quantity| axle.has(*quantity)).collect()
}

/// Every quantity of the mirrored axle, with opposite roll angle and rack displacement, has the same value or the
/// opposite value.
#[test]
fn a_mirror_exchanges_the_sides() {
    let mut compared = BTreeMap::new();
    for (name, axle) in different() {
        let image = mirrored(&axle);
        let all = quantities(&axle);
        let mut solver = AxleSolver::<3>::new(&axle, &all, true).unwrap();
        let mut image_solver = AxleSolver::<3>::new(&image, &all, true).unwrap();
        for placement in placements(axle.setup.c_factor.is_some()) {
            let placed = solver.place(&placement).unwrap();
            let read = solver.read(&placed).unwrap();
            let other = image_solver.place(&mirrored_placement(&placement)).unwrap();
            let other = image_solver.read(&other).unwrap();
            for quantity in &all {
                let values = (read.value(*quantity), other.value(on_other_side(*quantity)));
                let (Ok(a), Ok(b)) = values else {
                    assert_eq!(values.0.err(), values.1.err(), "{name} {quantity:?}");
                    continue;
                };
                let b = if is_odd(*quantity) { -b } else { b };
                let size = natural(quantity.info().unit).max(a.abs());
                let size = size * condition(&quantity.name(), &read.state);
                assert!(
                    (a - b).abs() < 1e-11 * size,
                    "{name} {placement} {}: {a}, in a mirror {b}",
                    quantity.name()
                );
                *compared.entry(quantity.info().name).or_insert(0) += 1;
            }
        }
    }
    assert_all_compared(&compared);
}

fn assert_all_compared(compared: &BTreeMap<&str, usize>) {
    let wheel = W::ALL.iter().map(|q| q.info().name);
    // `tests/it/solid` compares the quantities that exist only for solid axles and twist beams.
    let of_solid = [
        A::AxleSteer,
        A::AxleLateral,
        A::AxleLongitudinal,
        A::PinionAngle,
        A::RigidAntiSquat,
        A::RigidAntiLift,
        A::RigidAntiDive,
        A::DriveLoadTransfer,
        A::BeamTwist,
        A::BeamTorque,
    ];
    // `rocker_springs` checks springs between the rockers against their energies.
    let between = [
        A::HeaveSpringForce,
        A::HeaveSpringLength,
        A::HeaveSpringMotionRatio,
        A::TBarTorque,
        A::HeaveBarTorque,
    ];
    // `springs` checks stiffnesses with and without tyres against slopes of moments.
    let tyres = [A::RollStiffnessWithTyres, A::RideRateWithoutTyres];
    let lists: [&[A]; 3] = [&of_solid, &between, &tyres];
    let elsewhere = |q: &A| lists.iter().any(|list| list.contains(q));
    let axle = A::ALL.iter().filter(|q| !elsewhere(q));
    let axle = axle.map(|q| q.info().name);
    for name in wheel.chain(axle) {
        assert!(compared.contains_key(name), "{name} is compared nowhere");
    }
}

/// On axles with different sides, every quantity of the catalogue equals its independent evaluation. That evaluation
/// uses only wheel positions, the outputs of each wheel, and finite differences between positions.
#[test]
fn quantities_are_those_of_an_independent_evaluation() {
    let mut compared = BTreeMap::new();
    for (name, mut axle) in different() {
        axle.setup.tyre_rate.get_or_insert(190.0);
        axle.setup.sprung_mass.get_or_insert(610.0);
        axle.setup.unsprung_mass.get_or_insert(85.0);
        let all: Vec<Quantity> = quantities(&axle);
        let mut both = Independent::new(&axle, &all);
        for placement in placements(axle.setup.c_factor.is_some()) {
            let placed = both.solver.place(&placement).unwrap();
            let mut values = Values::new();
            wheel_values(&mut both, &placed, &mut values);
            axle_values(&mut both, &placed, &mut values);
            match placement {
                Placement::Roll { heave, roll, rack } => {
                    values_of_motions(&mut both, [heave, roll, rack], false, &mut values);
                }
                Placement::AtLoad { heave, roll, rack } => {
                    let mean = 0.5 * (placed.travels[0] + placed.travels[1]);
                    let mut moving = Values::new();
                    values_of_motions(&mut both, [mean, roll, rack], false, &mut moving);
                    values.append(&mut moving);
                    values_of_motions(&mut both, [heave, roll, rack], true, &mut moving);
                    let of_load = Quantity::Axle(A::RollStiffnessAtLoad);
                    values.extend(moving.into_iter().filter(|(q, _)| *q == of_load));
                }
                Placement::Travels { .. } => {}
            }
            for side in [Left, Right] {
                let spring = &axle.setup.springs.as_ref().unwrap()[side as usize];
                let read = both.solver.read(&placed).unwrap();
                let length = Quantity::Corner(side, C::SpringLength).evaluate(&read.state);
                let designed = both.axle.suspension(side);
                let [lower, upper] = spring_ends(designed);
                let force = spring.force(length, (upper - lower).norm());
                values.push((Quantity::Wheel(side, W::SpringForce), force));
            }
            let read = both.solver.read(&placed).unwrap();
            for (quantity, expected) in values.into_iter().filter(|(q, _)| axle.has(*q)) {
                let found = read
                    .value(quantity)
                    .unwrap_or_else(|why| panic!("{quantity:?}: {why:?}"));
                let size = natural(quantity.info().unit).max(expected.abs());
                let size = size * condition(&quantity.name(), &read.state);
                assert!(
                    (found - expected).abs() < 1e-7 * size,
                    "{name} {placement} {}: {found}, not {expected}",
                    quantity.name()
                );
                *compared.entry(quantity.info().name).or_insert(0) += 1;
            }
        }
    }
    assert_all_compared(&compared);
}

/// Ends of the spring or of the strut in the design position.
fn spring_ends(suspension: &hardpoint::model::Suspension) -> [Vector3<f64>; 2] {
    let names = ["spring_lower", "spring_upper", "strut_lower", "strut_top"];
    let found = names.map(|name| suspension.mechanism.point(name));
    let at = |id: Option<hardpoint::model::PointId>| id.map(|id| suspension.design[id.0]);
    match found.map(at) {
        [Some(lower), Some(upper), ..] | [_, _, Some(lower), Some(upper)] => [lower, upper],
        _ => panic!("no spring"),
    }
}
