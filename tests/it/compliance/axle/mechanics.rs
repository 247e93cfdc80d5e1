//! Tests of elastic axles against mechanics: single wheels, the design position, rigid limits, reciprocity, derivatives.

use super::{Case, HELD, LINKS, LOWER, WISHBONES, random_loads, sample};
use crate::support::larger;
use crate::support::random::Random;
use hardpoint::axle::Law;
use hardpoint::compliance::{
    AxleChange, AxleOnTape, AxleParameter, ElasticAxle, ElasticWheel, HeldQuantity, Parameter,
    Relaxed, Shape, WheelFigures, WheelLoads,
};
use hardpoint::model::{Axis, Side};
use hardpoint::number::{Real, Tape};

/// Returns the largest difference of angles (rad) and of positions divided by 100 mm.
fn difference(a: &WheelFigures, b: &WheelFigures) -> f64 {
    let moved = [(a.centre - b.centre).norm(), (a.contact - b.contact).norm()];
    let angles = [a.toe - b.toe, a.camber - b.camber, a.spin - b.spin];
    let angles = angles.map(f64::abs).into_iter();
    angles.chain(moved.map(|m| m / 100.0)).fold(0.0, larger)
}

/// If the wheels have no common elastic part, each wheel moves like a single wheel.
#[test]
fn wheels_that_share_nothing_are_single_wheels() {
    let mut random = Random(21);
    for topology in [WISHBONES, "five_link"] {
        let mut case = sample(topology, &[], Relaxed::AtDesignLoad, &mut random);
        (case.parts.rack_rate, case.parts.bar_rate) = (None, None);
        case.parts.column = None;
        let axle = case.axle();
        let wheel = ElasticWheel::new(&case.suspension, &case.parts.wheels[0]).unwrap();
        let rack = if topology == WISHBONES { 7.0 } else { 0.0 };
        let station = axle.at([12.0, -9.0], rack).unwrap();
        let given = random_loads(&mut random, 1200.0);
        let at = axle.loaded_about(&station, &station, &given, HELD).unwrap();
        for (side, travel, rack) in [(Side::Left, 12.0, rack), (Side::Right, -9.0, -rack)] {
            let alone = wheel.at(travel, rack).unwrap();
            let alone = wheel
                .loaded_about(&alone, &alone, &given[side as usize], HELD)
                .unwrap();
            let off = difference(&axle.figures(&at, side), &wheel.figures(&alone));
            assert!(off < 1e-13, "{topology} {off:e}");
            let loads = axle.wheel_load(&at, side) - wheel.wheel_load(&alone);
            assert!(loads.abs() < 1e-8, "{topology} {loads:e}");
        }
    }
}

/// With `at_design_load` the nominal design is the equilibrium. Of all sets of bushing forces that balance the loads, the
/// actual one has the least elastic energy. For this set, force divided by stiffness is the displacement at each mount.
/// These displacements belong to one small rigid motion of all bodies, without torsion.
#[test]
fn the_drawing_is_the_equilibrium_at_the_design_load() {
    let mut random = Random(22);
    for (topology, carries) in [(WISHBONES, &LOWER[..]), ("five_link", &LINKS[..])] {
        let case = sample(topology, carries, Relaxed::AtDesignLoad, &mut random);
        let axle = case.axle();
        let at = axle.at([0.0; 2], 0.0).unwrap();
        assert!(axle.out_of_balance(&at) < 1e-8);
        let design = case.suspension.design[case.suspension.mechanism.wheel_centre.0];
        for side in Side::ALL {
            let moved = axle.figures(&at, side).centre - design;
            assert!(moved.norm() < 1e-10, "{moved:?}");
        }
        let [left, right] = axle.design_loads().unwrap();
        assert!((left - right).abs() < 1e-9 && left > 1000.0);
        // Deflections of the left mounts without other loads. Force divided by stiffness is the displacement in a motion
        // of one rigid body. On a symmetric axle this body moves along x and z and rotates about y.
        let mounts = &case.parts.subframe.as_ref().unwrap().mounts;
        let first = case.parts.wheels[0].bushings.len();
        let readings = axle.bushings(&at, Side::Left);
        let moved: Vec<[f64; 3]> = mounts
            .iter()
            .zip(&readings[first..])
            .map(|(mount, reading)| {
                let force = reading.force.to_array();
                [0, 1, 2].map(|k: usize| match mount.shapes[k] {
                    Shape::Cubic { rate, .. } => -force[k] / rate,
                    Shape::Curve { .. } => panic!(),
                })
            })
            .collect();
        let (a, b) = (&mounts[0].at, &mounts[1].at);
        // A rotation w about y moves x by w dz and z by -w dx.
        let turn = -(moved[0][2] - moved[1][2]) / (a.x - b.x);
        let expected = turn * (a.z - b.z);
        let size = moved
            .iter()
            .flatten()
            .fold(0.0_f64, |m, d| larger(m, d.abs()));
        assert!(size > 1e-3);
        assert!((moved[0][0] - moved[1][0] - expected).abs() < 1e-10 * size);
        assert!(moved.iter().all(|d| d[1].abs() < 1e-10 * size));
    }
}

/// Travels and rack displacements that are not numbers have no equilibrium: a correction that is NaN does not count as small.
#[test]
fn inputs_that_are_not_numbers_have_no_equilibrium() {
    let mut random = Random(29);
    let case = sample(WISHBONES, &LOWER, Relaxed::AtDesignLoad, &mut random);
    let axle = case.axle();
    let unknown = f64::NAN;
    for (travels, rack) in [
        ([unknown, 0.0], 0.0),
        ([0.0, unknown], 0.0),
        ([0.0; 2], unknown),
    ] {
        assert!(axle.at(travels, rack).is_err(), "{travels:?} {rack}");
    }
}

/// If the stiffness of mounts, rack and steering column rises, the axle approaches an axle in which these parts are rigid.
/// The difference is inversely proportional to the stiffness.
#[test]
fn stiff_shared_parts_are_rigid_ones() {
    let mut random = Random(23);
    let soft = sample(WISHBONES, &LOWER, Relaxed::Free, &mut random);
    let mut rigid = Case {
        suspension: soft.suspension.clone(),
        parts: soft.parts.clone(),
    };
    (rigid.parts.subframe, rigid.parts.rack_rate) = (None, None);
    rigid.parts.column = None;
    let given = random_loads(&mut random, 1000.0);
    let state = |axle: &ElasticAxle| {
        let station = axle.at([10.0, 5.0], 6.0).unwrap();
        let at = axle.loaded_about(&station, &station, &given, HELD).unwrap();
        axle.figures(&at, Side::Left)
    };
    let expected = state(&rigid.axle());
    let errors = [1e3, 1e4, 1e5].map(|factor| {
        let mut stiff = soft.parts.clone();
        stiff.rack_rate = stiff.rack_rate.map(|rate| rate * factor);
        stiff.column.as_mut().unwrap().rate *= factor;
        for mount in &mut stiff.subframe.as_mut().unwrap().mounts {
            for shape in &mut mount.shapes {
                if let Shape::Cubic { rate, .. } = shape {
                    *rate *= factor;
                }
            }
        }
        let case = Case {
            suspension: soft.suspension.clone(),
            parts: stiff,
        };
        difference(&state(&case.axle()), &expected)
    });
    assert!(errors[2] < 1e-6, "{errors:?}");
    for pair in errors.windows(2) {
        let ratio = pair[0] / pair[1];
        assert!((9.5..10.5).contains(&ratio), "{errors:?}");
    }
}

/// At equal travels, the anti-roll bar has no torque. In roll, the bar raises the load transfer between the wheels.
#[test]
fn equal_travels_leave_the_bar_alone() {
    let mut random = Random(24);
    let case = sample(WISHBONES, &LOWER, Relaxed::AtDesignLoad, &mut random);
    let axle = case.axle();
    let level = axle.at([15.0, 15.0], 0.0).unwrap();
    assert!(axle.bar_torque(&level).unwrap().abs() < 1e-6);
    let [left, right] = Side::ALL.map(|side| axle.figures(&level, side));
    assert!(difference(&left, &right) < 1e-13);
    let rolled = axle.at([15.0, -15.0], 0.0).unwrap();
    let mut alone = Case {
        suspension: case.suspension.clone(),
        parts: case.parts.clone(),
    };
    alone.parts.bar_rate = None;
    let alone = alone.axle();
    let without = alone.at([15.0, -15.0], 0.0).unwrap();
    let transfer =
        |axle: &ElasticAxle, at| axle.wheel_load(at, Side::Left) - axle.wheel_load(at, Side::Right);
    assert!(axle.bar_torque(&rolled).unwrap().abs() > 1e4);
    assert!(transfer(&axle, &rolled) > 1.05 * transfer(&alone, &without));
}

/// Forces and displacements of both wheel centres are reciprocal (symmetric compliance matrix).
#[test]
fn the_compliance_of_both_wheel_centres_is_symmetric() {
    let mut random = Random(25);
    for (topology, carries) in [(WISHBONES, &LOWER[..]), ("five_link", &LINKS[..])] {
        let case = sample(topology, carries, Relaxed::Free, &mut random);
        let axle = case.axle();
        let at = axle.at([8.0, -6.0], 0.0).unwrap();
        let tangent = axle.tangent(&at, HeldQuantity::WheelLoad).unwrap();
        let mut matrix = [[0.0; 12]; 12];
        for column in 0..12 {
            let mut loads = [WheelLoads::none(0.0); 2];
            let of = &mut loads[column / 6];
            let part = if column % 6 < 3 {
                &mut of.centre
            } else {
                &mut of.moment
            };
            part[Axis::ALL[column % 3]] = 1.0;
            let twists = axle.twists_along(&tangent, &loads);
            let values = twists.iter().flatten().flat_map(|v| v.to_array());
            for (row, value) in values.enumerate() {
                matrix[row][column] = value;
            }
        }
        for i in 0..12 {
            for j in 0..i {
                let (a, b) = (matrix[i][j], matrix[j][i]);
                let scale = (matrix[i][i] * matrix[j][j]).sqrt();
                assert!(
                    (a - b).abs() < 1e-11 * scale,
                    "{topology} {i} {j}: {a:e} {b:e}"
                );
            }
        }
    }
}

/// Derivatives along loads, travels and the rack equal the limits of difference quotients.
#[test]
fn derivatives_are_limits_of_differences() {
    let mut random = Random(26);
    let case = sample(WISHBONES, &LOWER, Relaxed::Free, &mut random);
    let axle = case.axle();
    let (travels, rack) = ([9.0, -4.0], 3.0);
    let at = axle.at(travels, rack).unwrap();
    let tangent = axle.tangent(&at, HELD).unwrap();
    let along = |change: &AxleChange| axle.figures_along(&tangent, change);
    // `bound` contains the allowed relative and absolute error.
    let check =
        |found: [WheelFigures; 2], ends: [[WheelFigures; 2]; 2], step: f64, bound: [f64; 2]| {
            for side in 0..2 {
                let [low, high] = [&ends[0][side], &ends[1][side]];
                let found = &found[side];
                for (found, low, high) in [
                    (found.toe, low.toe, high.toe),
                    (found.camber, low.camber, high.camber),
                    (
                        found.centre.y * 1e-2,
                        low.centre.y * 1e-2,
                        high.centre.y * 1e-2,
                    ),
                ] {
                    let quotient = (high - low) / (2.0 * step);
                    assert!(
                        (found - quotient).abs() < bound[0] * quotient.abs() + bound[1],
                        "{found} {quotient}"
                    );
                }
            }
        };
    let figures = |at: &_| Side::ALL.map(|side| axle.figures(at, side));
    let travelled = |t: f64| {
        figures(
            &axle
                .at([travels[0] + t, travels[1] - 0.5 * t], rack)
                .unwrap(),
        )
    };
    let change = AxleChange::Travels([1.0, -0.5]);
    let by_length = [1e-7, 1e-10];
    check(
        along(&change),
        [travelled(-0.01), travelled(0.01)],
        0.01,
        by_length,
    );
    let steered = |r: f64| figures(&axle.at(travels, rack + r).unwrap());
    check(
        along(&AxleChange::Rack),
        [steered(-0.01), steered(0.01)],
        0.01,
        by_length,
    );
    let mut unit = [WheelLoads::none(0.0); 2];
    (unit[0].side, unit[0].trail) = (1.0, 30.0);
    unit[1].contact.x = -0.7;
    let loaded = |force: f64| {
        let loads = unit.map(|unit| {
            let mut load = WheelLoads::none(0.0).plus(&unit, force);
            load.trail = unit.trail;
            load
        });
        figures(&axle.loaded_about(&at, &at, &loads, HELD).unwrap())
    };
    // Derivatives by load are about 1e-7 rad/N. Rounding of 1e-13 rad over 4 N is far below the absolute bound.
    check(
        along(&AxleChange::Loads(unit)),
        [loaded(-2.0), loaded(2.0)],
        2.0,
        [1e-5, 1e-12],
    );
}

/// Coefficients of the eighth-order central difference.
const STENCIL: [f64; 4] = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];

/// Inputs for the comparison of derivatives: hardpoints, then rates.
fn inputs(case: &Case) -> Vec<Parameter> {
    let first = case.parts.wheels[0].bushings.len();
    let point = |name: &str| case.suspension.mechanism.point(name).unwrap();
    vec![
        Parameter::Point(point("tie_rod_inner"), Axis::Z),
        Parameter::Point(point("lower_ball_joint"), Axis::Y),
        Parameter::Point(point("lower_arm_rear"), Axis::X),
        Parameter::Point(point("spring_upper"), Axis::X),
        Parameter::Point(point("drop_link_inner"), Axis::Z),
        Parameter::Stiffness(0, 1),
        Parameter::Stiffness(first, 1),
        Parameter::Stiffness(first + 1, 2),
        Parameter::RackRate,
        Parameter::ColumnRate,
        Parameter::BarRate,
        Parameter::SpringRate,
    ]
}

/// Returns the axle with a hardpoint moved by a length, or with a rate changed by a fraction.
fn varied(case: &Case, parameter: Parameter, by: f64) -> Case {
    let mut changed = Case {
        suspension: case.suspension.clone(),
        parts: case.parts.clone(),
    };
    let first = case.parts.wheels[0].bushings.len();
    let scale = |shape: &mut Shape| {
        if let Shape::Cubic { rate, .. } = shape {
            *rate *= 1.0 + by;
        }
    };
    let parts = &mut changed.parts;
    match parameter {
        Parameter::Point(id, axis) => changed.suspension.design[id.0][axis] += by,
        Parameter::RackRate => *parts.rack_rate.as_mut().unwrap() *= 1.0 + by,
        Parameter::ColumnRate => parts.column.as_mut().unwrap().rate *= 1.0 + by,
        Parameter::BarRate => *parts.bar_rate.as_mut().unwrap() *= 1.0 + by,
        Parameter::SpringRate => {
            for wheel in &mut parts.wheels {
                if let Law::Linear { rate, .. } = &mut wheel.spring.as_mut().unwrap().spring {
                    *rate *= 1.0 + by;
                }
            }
        }
        Parameter::Stiffness(number, axis) if number >= first => {
            scale(&mut parts.subframe.as_mut().unwrap().mounts[number - first].shapes[axis]);
        }
        Parameter::Stiffness(number, axis) => {
            for wheel in &mut parts.wheels {
                scale(&mut wheel.bushings[number].shapes[axis]);
            }
        }
        _ => panic!(),
    }
    changed
}

/// Rate of the elastic part to which a parameter belongs. 1 for a coordinate of a hardpoint.
fn rate_of(case: &Case, parameter: Parameter) -> f64 {
    let parts = &case.parts;
    let first = parts.wheels[0].bushings.len();
    let rate = |shape: &Shape| match shape {
        Shape::Cubic { rate, .. } => *rate,
        Shape::Curve { .. } => panic!(),
    };
    match parameter {
        Parameter::RackRate => parts.rack_rate.unwrap(),
        Parameter::ColumnRate => parts.column.unwrap().rate,
        Parameter::BarRate => parts.bar_rate.unwrap(),
        Parameter::SpringRate => match parts.wheels[0].spring.as_ref().unwrap().spring {
            Law::Linear { rate, .. } => rate,
            Law::Curve(_) => panic!(),
        },
        Parameter::Stiffness(number, axis) if number >= first => {
            rate(&parts.subframe.as_ref().unwrap().mounts[number - first].shapes[axis])
        }
        Parameter::Stiffness(number, axis) => rate(&parts.wheels[0].bushings[number].shapes[axis]),
        _ => 1.0,
    }
}

/// Derivatives with respect to hardpoints, rates, mounts, rack and bar equal finite differences of eighth order. The test
/// compares states, and their derivatives with respect to loads.
#[test]
fn derivatives_by_the_design_agree_with_differences() {
    let mut random = Random(27);
    let (travels, rack) = ([9.0, -4.0], 3.0);
    let mut unit = [WheelLoads::none(0.0); 2];
    (unit[0].side, unit[1].side) = (1.0, -1.0);
    // Toe of the left wheel, its derivative with respect to lateral forces, and the wheel load of the right wheel.
    let values = |case: &Case| {
        let axle = case.axle();
        let at = axle.at(travels, rack).unwrap();
        let tangent = axle.tangent(&at, HELD).unwrap();
        let by = axle.figures_along(&tangent, &AxleChange::Loads(unit));
        let load = axle.wheel_load(&at, Side::Right);
        [axle.figures(&at, Side::Left).toe, by[0].toe, load]
    };
    for relaxed in [Relaxed::Free, Relaxed::AtDesignLoad] {
        let case = sample(WISHBONES, &LOWER, relaxed, &mut random);
        let parameters = inputs(&case);
        let at = case.axle().at(travels, rack).unwrap();
        let tape = Tape::new();
        let designs = [&case.suspension.design[..]; 2];
        let wheels = [&case.suspension; 2];
        let by: Vec<AxleParameter> = parameters
            .iter()
            .copied()
            .map(AxleParameter::from)
            .collect();
        let on_tape = AxleOnTape::new(wheels, designs, &case.parts, &by, &tape).unwrap();
        let here = on_tape.carried(&at).unwrap();
        let tangent = on_tape.axle.tangent(&here, HELD).unwrap();
        let load = on_tape.axle.wheel_load(&here, Side::Right);
        let loads = unit.map(|unit| unit.map(|c| load.constant(c)));
        let by = on_tape
            .axle
            .figures_along(&tangent, &AxleChange::Loads(loads));
        let toe = on_tape.axle.figures(&here, Side::Left).toe;
        let quotients: Vec<[f64; 3]> = parameters
            .iter()
            .map(|parameter| {
                let step = if matches!(parameter, Parameter::Point(..)) {
                    0.5
                } else {
                    0.02
                };
                let mut sum = [0.0; 3];
                for (k, weight) in STENCIL.into_iter().enumerate() {
                    let far = step * (k + 1) as f64;
                    let ends = [far, -far].map(|by| values(&varied(&case, *parameter, by)));
                    for (sum, (high, low)) in sum.iter_mut().zip(ends[0].iter().zip(ends[1])) {
                        *sum += weight * (high - low) / step;
                    }
                }
                sum
            })
            .collect();
        let mut gradient = Vec::new();
        for (k, value) in [toe, by[0].toe, load].into_iter().enumerate() {
            tape.gradients(&[value], parameters.len(), |_, by| gradient = by.to_vec());
            let scaled = parameters.iter().zip(&gradient);
            let scaled = scaled.map(|(parameter, by)| by * rate_of(&case, *parameter));
            let found: Vec<f64> = scaled.collect();
            assert_eq!(found.len(), parameters.len());
            let largest = found.iter().fold(0.0_f64, |m, by| larger(m, by.abs()));
            for (number, found) in found.into_iter().enumerate() {
                let miss = (found - quotients[number][k]).abs();
                assert!(
                    miss < 1e-9 * largest,
                    "{relaxed:?} {k} {:?}: {found:e} {:e} of {largest:e}",
                    parameters[number],
                    quotients[number][k]
                );
            }
        }
    }
}
