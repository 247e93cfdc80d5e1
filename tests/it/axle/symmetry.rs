//! Tests of an axle without reference: mirror images, the curves of one wheel, statics.

use super::commands::{folder, run, study};
use super::{axle, reference::read};
use hardpoint::analyse::{Load, Support};
use hardpoint::axle::{
    AxleMotion, AxlePlan, AxleQuantity as A, AxleSolver, Placement, Quantity, WheelMotion,
    WheelQuantity as W, axle_curves,
};
use hardpoint::characteristics::Characteristic;
use hardpoint::curves::curves;
use hardpoint::model::Side::{Left, Right};
use hardpoint::number::Vector3;
use hardpoint::plan::Plan;
use hardpoint::solve::{Solver, StationOrder};
use hardpoint::study::Study;
use std::fs;
use std::ops::ControlFlow;

/// A mirrored axle at opposite roll angle and rack displacement is its own mirror image, bit for bit.
#[test]
fn mirrored_axles_give_mirrored_bits() {
    let case = read("macpherson_front");
    let axle = axle(&case);
    let wheel = |side| {
        [
            Quantity::Corner(side, Characteristic::Camber),
            Quantity::Corner(side, Characteristic::CasterTrail),
            Quantity::Wheel(side, W::CamberToRoad),
            Quantity::Wheel(side, W::JackingCoefficient),
            Quantity::Wheel(side, W::RollCamber),
            Quantity::Wheel(side, W::WheelLoad),
        ]
    };
    let even = [
        A::Track,
        A::RollCentreHeight,
        A::RollStiffness,
        A::TurningCircle,
    ]
    .map(Quantity::Axle);
    let odd = [A::MeanSteer, A::RollCentreLateral, A::RollMoment].map(Quantity::Axle);
    let all: Vec<_> = [wheel(Left), wheel(Right)]
        .concat()
        .into_iter()
        .chain(even)
        .chain(odd)
        .collect();
    let mut solver = AxleSolver::<3>::new(&axle, &all, true).unwrap();
    for (heave, roll, rack) in [(0.0, 0.03, 0.0), (15.0, -0.05, 40.0), (-20.0, 0.02, -25.0)] {
        let mut at = |roll, rack| {
            let placed = solver
                .place(&Placement::Roll { heave, roll, rack })
                .unwrap();
            (placed, solver.read(&placed).unwrap().state)
        };
        let (placed, state) = at(roll, rack);
        let (mirrored, image) = at(-roll, -rack);
        assert_eq!(placed.travels[0].to_bits(), mirrored.travels[1].to_bits());
        assert_eq!(placed.travels[1].to_bits(), mirrored.travels[0].to_bits());
        for (own, other) in wheel(Left).into_iter().zip(wheel(Right)) {
            let values = [own.evaluate(&state), other.evaluate(&image)];
            // The roll angle has opposite signs as seen from both sides, and so have derivatives with respect to it.
            let by_roll = matches!(own, Quantity::Wheel(_, W::RollCamber));
            let sign = if by_roll { -1.0 } else { 1.0 };
            assert_eq!(values[0], sign * values[1], "{own:?}");
        }
        for quantity in even {
            assert_eq!(
                quantity.evaluate(&state),
                quantity.evaluate(&image),
                "{quantity:?}"
            );
        }
        for quantity in odd {
            assert_eq!(
                quantity.evaluate(&state),
                -quantity.evaluate(&image),
                "{quantity:?}"
            );
        }
    }
}

/// An axle in heave on pads has the curves of one wheel, bit for bit.
#[test]
fn an_axle_in_heave_is_two_corners() {
    for name in [
        "macpherson_solve",
        "five_link_solve",
        "semi_trailing_arm_solve",
    ] {
        let path = crate::support::studies().join(format!("{name}.toml"));
        let study = Study::read(&path, &[]).unwrap();
        let corner = curves(study.wheel(), &Plan::of(study.one_wheel().unwrap())).unwrap();
        let listed = study.one_wheel().unwrap().outputs.characteristics.iter();
        let asked: Vec<_> = listed
            .copied()
            .filter(|c| *c != Characteristic::RollCentreHeight)
            .collect();
        let case = read("macpherson_front");
        let mut both = axle(&case);
        both.left = study.wheel().clone();
        both.setup.constants = hardpoint::characteristics::Constants::of(&both.left);
        let course = AxleMotion {
            combine: hardpoint::axle::Combine::All,
            wheels: WheelMotion::Heave(study.motion().values.clone()),
            racks: vec![0.0],
            shows_rack: false,
            steering_wheel: None,
            time: None,
        };
        let quantities = asked.iter().map(|c| Quantity::Corner(Left, *c)).collect();
        let plan = AxlePlan::of(course, quantities);
        let axle = axle_curves(&both, &plan).unwrap().curves;
        assert_eq!(axle.stations.len(), corner.stations.len());
        assert!(asked.len() >= 2 && corner.stations.len() >= 3, "{name}");
        for (k, c) in asked.iter().enumerate() {
            let column = corner
                .columns
                .iter()
                .position(|column| column.output == c.info().name);
            let column = column.unwrap();
            for (one, two) in corner.stations.iter().zip(&axle.stations) {
                assert_eq!(
                    one.values[column], two.values[k],
                    "{name} {c:?} at {:?}",
                    one.at
                );
            }
        }
    }
}

/// The program computes jacking coefficients and wheel loads from velocities. They equal the values from the static
/// forces of the links.
#[test]
fn jacking_and_wheel_loads_are_those_of_the_links() {
    for name in ["macpherson_front", "double_wishbone_front"] {
        let case = read(name);
        let mut axle = axle(&case);
        axle.setup.bar_rate = None;
        let quantities = [
            Quantity::Wheel(Left, W::JackingCoefficient),
            Quantity::Wheel(Left, W::WheelLoad),
            Quantity::Wheel(Left, W::SpringForce),
        ];
        let mut solver = AxleSolver::<2>::new(&axle, &quantities, false).unwrap();
        let mechanism = &axle.left.mechanism;
        for (heave, roll, rack) in [(0.0, 0.0, 0.0), (10.0, 0.04, -30.0), (-30.0, -0.05, 20.0)] {
            let placed = solver
                .place(&Placement::Roll { heave, roll, rack })
                .unwrap();
            let state = solver.read(&placed).unwrap().state;
            let [jacking, load, spring_force] = quantities.map(|q| q.evaluate(&state));
            let wheel = state.wheels()[0];
            let (point, ground) = (wheel.contact_point(), wheel.ground);
            let mut links = Solver::new(mechanism, &axle.left.design).unwrap();
            let order = StationOrder::through(&[placed.travels[0]]);
            let drive = hardpoint::model::Drive::Travel;
            let mut compared = 0;
            links
                .for_each_pose(drive, &order, rack, |solver, _, pose| {
                    let pose = pose.unwrap();
                    let carried = |support, force| {
                        let moment = Vector3::new(0.0, 0.0, 0.0);
                        let load = Load {
                            point,
                            force,
                            moment,
                        };
                        solver
                            .balance(pose, rack, support)
                            .unwrap()
                            .under(&load)
                            .support
                    };
                    let held = |force| carried(Support::WheelCentre, force);
                    let statics = held(ground.outboard()) / held(ground.normal());
                    assert!((statics - jacking).abs() < 1e-12, "{statics} {jacking}");
                    let spring = Support::Spring(mechanism.spring.unwrap());
                    let force = carried(spring, ground.normal() * load);
                    let error = (force - spring_force).abs() / spring_force.abs();
                    assert!(error < 1e-12, "{force} {spring_force}");
                    compared += 1;
                    ControlFlow::Continue(())
                })
                .unwrap();
            assert!(compared > 0, "{name}");
        }
    }
}

/// The same axle in another coordinate frame has the same results. Only the rack displacement, which is along the
/// frame's y axis, changes its sign.
#[test]
fn frames_change_the_rack_alone() {
    let solved = |set: &[&str]| {
        let path = study("macpherson_axle.toml");
        let mut arguments = vec!["solve", path.to_str().unwrap(), "--out", "-"];
        for set in set {
            arguments.extend(["--set", set]);
        }
        let (csv, _) = run(&arguments, 0);
        csv
    };
    let plain = solved(&["steering.c_factor=-60.0"]);
    let text = fs::read_to_string(study("macpherson_axle.toml")).unwrap();
    let mut mirrored = String::new();
    for line in text.lines() {
        let point = line.split_once('[').and_then(|(name, rest)| {
            let (numbers, _) = rest.split_once(']')?;
            let numbers: Vec<f64> = numbers
                .split(',')
                .map_while(|n| n.trim().parse().ok())
                .collect();
            match (name.contains('='), numbers.as_slice()) {
                (true, [x, y, z]) if !name.contains("heave") => {
                    Some(format!("{name}[{x:?}, {:?}, {:?}]", -y, -z))
                }
                _ => None,
            }
        });
        mirrored += &point.unwrap_or_else(|| line.to_owned());
        mirrored += "\n";
    }
    let mirrored = mirrored
        .replace("topology =", "frame = \"sae_j670\"\ntopology =")
        .replace("c_factor = -52.0", "c_factor = 60.0");
    let folder = folder("sae");
    fs::create_dir_all(&folder).unwrap();
    let file = folder.join("sae.toml");
    fs::write(&file, mirrored).unwrap();
    let (sae, _) = run(&["solve", file.to_str().unwrap(), "--out", "-"], 0);
    let rack = plain
        .lines()
        .next()
        .unwrap()
        .split(',')
        .position(|c| c == "rack_mm")
        .unwrap();
    assert_eq!(plain.lines().count(), sae.lines().count());
    assert!(plain.lines().count() > 30);
    for (one, two) in plain.lines().zip(sae.lines()).skip(1) {
        let [one, two] = [one, two].map(|line| line.split(',').collect::<Vec<_>>());
        assert_eq!(one.len(), two.len());
        for (column, (one, two)) in one.iter().zip(&two).enumerate() {
            if column == rack {
                assert_eq!(one.parse::<f64>().unwrap(), -two.parse::<f64>().unwrap())
            } else {
                assert_eq!(one, two)
            }
        }
    }
}
