//! Tests of rockers: bell cranks of pushrods and pullrods, and anti-roll bars.

use super::truth::{Errors, PLACES, Truth, half_tangent, lift, slope};
use super::{at, characteristics, template, travel};
use crate::support::random::Random;
use crate::support::{Worst, larger};
use hardpoint::analyse::{Load, Reaction, Support};
use hardpoint::bench::DoubleDouble as Dd;
use hardpoint::characteristics::{Characteristic as C, Constants, Quantity, WheelReading};
use hardpoint::derive::{DesignSeries, Linearised, MotionPoint};
use hardpoint::mechanism::Pose;
use hardpoint::model::{Body, Mechanism, PointId, RockerId, Suspension};
use hardpoint::number::{Jet, Real, Scalar, Vector3};

const STUDY: &str = "double_wishbone_pushrod";

/// The sample study with a pushrod, and variants with rod, bar or spring on another body.
fn variants() -> Vec<(&'static str, Suspension)> {
    let plain = template(STUDY);
    let put = |name: &str, body: &str| {
        let mut suspension = plain.clone();
        let mechanism = &mut suspension.mechanism;
        let id = mechanism.point(name).unwrap();
        let body = mechanism.bodies.iter().find(|(b, _)| *b == body).unwrap().1;
        mechanism.points[id.0].body = body;
        suspension
    };
    vec![
        ("lower arm, bar on the rocker", plain.clone()),
        ("knuckle", put("pushrod_outer", "knuckle")),
        ("upper arm", put("pushrod_outer", "upper_arm")),
        ("bar on the lower arm", put("drop_link_outer", "lower_arm")),
        ("spring on the upper arm", put("spring_lower", "upper_arm")),
    ]
}

/// Rods keep their lengths, whatever body they are attached to and however the wheel is steered.
#[test]
fn rods_keep_their_lengths() {
    let mut random = Random(22);
    for (name, suspension) in variants() {
        let mechanism = &suspension.mechanism;
        let mut worst = Worst::default();
        for _ in 0..500 {
            let design = random.scattered(&suspension.design, 8.0);
            let design_series = DesignSeries::<1>::new(mechanism, &design);
            let point = travel(35.0 * random.signed(), 15.0 * random.signed());
            at(mechanism, &design, point, |solver, pose| {
                let configuration = solver
                    .configuration_series(&design_series, pose, &point.along_drive())
                    .unwrap();
                for rocker in &mechanism.rockers {
                    let now = |id: PointId| configuration.point(id).map(|c| c[0]);
                    let length = (design[rocker.inner.0] - design[rocker.outer.0]).norm();
                    let found = (now(rocker.inner) - now(rocker.outer)).norm();
                    worst.note((found - length) / length);
                }
            })
            .unwrap()
            .unwrap();
        }
        println!("{name}: {:.1e}", worst.0);
        assert!(worst.0 < 1e-13, "{name}: {:e}", worst.0);
    }
}

/// Points of rockers agree with a solution of thirty digits. The test compares values, first and second derivatives,
/// and the sensitivities of these three to every hardpoint. The bound of the error is divided by the leverages, which
/// are above 0.2 here. For derivatives, it is divided once more for each order.
#[test]
fn points_of_rockers_agree_with_thirty_digits() {
    let mut random = Random(23);
    for (name, suspension) in variants() {
        let mut errors = Errors::default();
        for i in 0..100 {
            let design = random.scattered(&suspension.design, 8.0);
            let (value, rack) = (30.0 * random.signed(), 15.0 * random.signed());
            errors.check(&suspension.mechanism, &design, value, rack, i % 50 == 0);
        }
        println!("{name}: {errors:?}");
        assert_eq!(errors.disagreed, 0);
        assert_eq!(errors.solved, 100);
        assert!(errors.by_order[0].0 < 1e-13, "{name}: {errors:?}");
        for e in [errors.by_order[1], errors.by_order[2]] {
            assert!(e.0 < 1e-11, "{name}: {errors:?}");
        }
        for e in errors.sensitivities {
            assert!(e.0 < 1e-10, "{name}: {errors:?}");
        }
    }
}

/// Compared outputs, as functions that the test can compute exactly: the spring length, and tangents of half the
/// angles.
const REPORTED: [C; 3] = [C::SpringLength, C::RockerAngle, C::AntiRollBarAngle];
/// Step of the difference quotients of the exact solution.
const H: f64 = 1e-4;

/// Exact values of the compared outputs after more travel: the length, and tangents of half the angles with the signs of
/// the catalogue.
fn exact_values(
    truth: &Truth<'_>,
    mechanism: &Mechanism,
    design: &[Vector3<Dd>],
    more: f64,
) -> Vector3<Dd> {
    let pose = truth.pose(design, more, 0.0);
    let place = |id| super::truth::place(mechanism, design, &pose, id);
    let u = |k: usize| {
        let rocker = &mechanism.rockers[k];
        let [a, b, i, o] =
            [rocker.first, rocker.second, rocker.inner, rocker.outer].map(|p| design[p.0]);
        let pushed = (b - a).cross(i - a).dot(i - o).sign();
        half_tangent(mechanism, design, &pose, rocker) * pushed
    };
    let spring = mechanism.spring.unwrap();
    let length = (place(spring.upper) - place(spring.lower)).norm();
    Vector3::new(length, u(0), u(1))
}

/// Exact values and rates of the compared outputs.
fn exact_curve(
    truth: &Truth<'_>,
    mechanism: &Mechanism,
    design: &[Vector3<Dd>],
) -> [Vector3<Dd>; 2] {
    let values = |more: f64| exact_values(truth, mechanism, design, more);
    [values(0.0), slope(PLACES.map(|k| values(k * H)), H)]
}

/// Exact derivatives of values and rates with respect to every coordinate.
fn exact_slopes(
    truth: &Truth<'_>,
    mechanism: &Mechanism,
    exact: &[Vector3<Dd>],
) -> Vec<[Vector3<Dd>; 2]> {
    let by_coordinate = |moved: usize| {
        let curves = PLACES.map(|k| {
            let mut design = exact.to_vec();
            let mut p = design[moved / 3].to_array();
            p[moved % 3] = p[moved % 3] + Dd::from(k * H);
            design[moved / 3] = Vector3::from(p);
            exact_curve(truth, mechanism, &design)
        });
        [0, 1].map(|order| slope(curves.map(|c| c[order]), H))
    };
    (0..3 * exact.len()).map(by_coordinate).collect()
}

/// tan(angle/2) of a Taylor series of an angle. A length stays a length.
fn half(k: usize, jet: Jet<f64, 3>) -> Jet<f64, 3> {
    match k {
        0 => jet,
        _ => {
            let (sine, cosine) = jet.sin_cos();
            sine / (Jet::constant(1.0) + cosine)
        }
    }
}

/// Series of the compared outputs.
fn found_values(view: &WheelReading<3>, linearised: &Linearised<'_, 3>) -> [Jet<f64, 3>; 3] {
    REPORTED.map(|c| view.value(&linearised.at, Quantity::Characteristic(c)))
}

/// Gradients of an output with respect to every hardpoint: of its value, and of its derivatives up to an order.
fn found_gradients(
    view: &WheelReading<3>,
    linearised: &Linearised<'_, 3>,
    c: C,
    highest: usize,
    points: usize,
) -> Vec<Vec<Vector3<f64>>> {
    let mut all = vec![vec![Vector3::default(); points]; highest + 1];
    let mut buffer = vec![Vector3::new(0.0, 0.0, 0.0).map(Jet::constant); points];
    view.gradients(
        linearised,
        Quantity::Characteristic(c),
        highest,
        &mut buffer,
        &mut |order, PointId(p), g| all[order][p] = g,
    );
    all
}

/// Largest errors of angles and spring length.
#[derive(Default, Debug)]
struct AngleErrors {
    values: Worst,
    rates: Worst,
    by_point: [Worst; 2],
}

impl AngleErrors {
    fn compare_values(&mut self, found: &[Jet<f64, 3>; 3], wanted: [Vector3<Dd>; 2]) {
        let scales = [200.0, 1.0, 1.0];
        for (k, jet) in found.iter().enumerate() {
            let jet = half(k, *jet);
            let error = |found: f64, wanted: Vector3<Dd>| {
                (Dd::from(found) - wanted.to_array()[k]).value() / scales[k]
            };
            self.values.note(error(jet[0], wanted[0]));
            self.rates.note(100.0 * error(jet[1], wanted[1]));
        }
    }

    /// Compares the gradients of the output `k` with exact derivatives.
    fn compare_gradients(
        &mut self,
        k: usize,
        found: &Jet<f64, 3>,
        gradients: &[Vec<Vector3<f64>>],
        wanted: &[[Vector3<Dd>; 2]],
    ) {
        let largest = |order: usize| {
            let sizes = wanted.iter().map(|t| t[order].to_array()[k].value().abs());
            sizes.fold(0.0, larger)
        };
        for (moved, wanted) in wanted.iter().enumerate() {
            let (p, axis) = (moved / 3, moved % 3);
            let [g, h] = [0, 1].map(|order| gradients[order][p].to_array()[axis]);
            // With u = tan(a/2), the derivative of u with respect to a parameter p is u_p = (1 + u^2)
            // a_p/2. The rate follows by one more derivative.
            let found = match k {
                0 => [g, h],
                _ => {
                    let u = half(k, *found);
                    let s = 0.5 * (1.0 + u[0] * u[0]);
                    [s * g, s * h + u[0] * u[1] * g]
                }
            };
            for order in 0..2 {
                let wanted = wanted[order].to_array()[k].value();
                self.by_point[order].note((found[order] - wanted) / largest(order));
            }
        }
    }
}

/// Variant with a random design at a random station.
struct Solved<'a> {
    /// Name of the variant.
    name: &'a str,
    suspension: &'a Suspension,
    point: MotionPoint<f64>,
    pose: &'a Pose<f64>,
    view: &'a WheelReading<3>,
    linearised: &'a Linearised<'a, 3>,
}

/// Linearises each variant at two random designs and stations, and passes the results on.
fn for_each_variant(mut read: impl FnMut(Solved<'_>)) {
    let mut random = Random(24);
    for (name, mut suspension) in variants() {
        let nominal = suspension.design.clone();
        for _ in 0..2 {
            suspension.design = random.scattered(&nominal, 8.0);
            let point = travel(30.0 * random.signed(), 15.0 * random.signed());
            let (mechanism, design) = (&suspension.mechanism, &suspension.design);
            let design_series = DesignSeries::<3>::new(mechanism, design);
            at(mechanism, design, point, |solver, pose| {
                let linearised = solver
                    .linearised(&design_series, pose, &point.along_drive())
                    .unwrap();
                let view = WheelReading::of(&linearised.at, Constants::of(&suspension));
                read(Solved {
                    name,
                    suspension: &suspension,
                    point,
                    pose,
                    view: &view,
                    linearised: &linearised,
                });
            })
            .unwrap()
            .unwrap();
        }
    }
}

/// Compares angles and spring length with thirty digits: values, rates, and the sensitivities of values and rates to
/// every hardpoint.
#[test]
fn angles_and_lengths_agree_with_thirty_digits() {
    for_each_variant(|solved| {
        let Solved {
            name,
            suspension,
            point,
            pose,
            view,
            linearised,
        } = solved;
        let (mechanism, design) = (&suspension.mechanism, &suspension.design);
        let mut errors = AngleErrors::default();
        let truth = Truth::around(mechanism, design, pose, point.value, point.rack);
        let exact: Vec<_> = design.iter().copied().map(lift).collect();
        let found = found_values(view, linearised);
        errors.compare_values(&found, exact_curve(&truth, mechanism, &exact));
        let wanted = exact_slopes(&truth, mechanism, &exact);
        for (k, c) in REPORTED.into_iter().enumerate() {
            let gradients = found_gradients(view, linearised, c, 1, design.len());
            errors.compare_gradients(k, &found[k], &gradients, &wanted);
        }
        println!("{name}: {errors:?}");
        let AngleErrors {
            values,
            rates,
            by_point,
        } = errors;
        assert!(values.0 < 1e-13 && rates.0 < 1e-11, "{name}");
        assert!(by_point.iter().all(|e| e.0 < 1e-10), "{name}: {by_point:?}");
    });
}

/// The motion ratios are the rates of spring length and bar angle, computed by another method. The drive is the travel,
/// so the wheel centre rises by 1 per unit of the drive in every design.
#[test]
fn motion_ratios_are_rates() {
    for_each_variant(|solved| {
        let Solved {
            name,
            view,
            linearised,
            ..
        } = solved;
        let points = solved.suspension.design.len();
        let found = found_values(view, linearised);
        let mut ratios = Worst::default();
        for (ratio, of, sign) in [
            (C::MotionRatio, 0, -1.0),
            (C::AntiRollBarMotionRatio, 2, 1.0),
        ] {
            let jet = view.value(&linearised.at, Quantity::Characteristic(ratio));
            let scale = found[of][1].abs();
            ratios.note((jet[0] - sign * found[of][1]) / scale);
            ratios.note((jet[1] - sign * 2.0 * found[of][2]) / scale);
            let rate = found_gradients(view, linearised, REPORTED[of], 1, points);
            let own = found_gradients(view, linearised, ratio, 0, points);
            let largest = rate[1].iter().map(|g| g.norm()).fold(0.0, larger);
            for (a, b) in own[0].iter().zip(&rate[1]) {
                ratios.note((*a - *b * sign).norm() / largest);
            }
        }
        println!("{name}: {ratios:?}");
        assert!(ratios.0 < 1e-11, "{name}: {ratios:?}");
    });
}

/// The lower arm is in equilibrium about its hinge, under the forces of pushrod and ball joint. The rocker is in
/// equilibrium about its axis, under the forces of pushrod and spring. The spring force times the motion ratio equals
/// the wheel force.
#[test]
fn pushrod_arm_and_rocker_are_in_equilibrium() {
    let suspension = template(STUDY);
    let mechanism = &suspension.mechanism;
    let spring = mechanism.spring.unwrap();
    let rocker = mechanism.rockers[0];
    assert_eq!(
        mechanism.body(rocker.outer),
        Body::Arm(hardpoint::model::ArmId(0))
    );
    let mut random = Random(25);
    for _ in 0..100 {
        let point = travel(30.0 * random.signed(), 10.0 * random.signed());
        let design_series = DesignSeries::<2>::new(mechanism, &suspension.design);
        at(mechanism, &suspension.design, point, |solver, pose| {
            let configuration = solver
                .configuration_series(&design_series, pose, &point.along_drive())
                .unwrap();
            let place = |id| configuration.point(id).map(|c| c[0]);
            let load = Load {
                point: place(mechanism.wheel_centre),
                force: Vector3::new(0.0, 0.0, 2000.0),
                moment: Vector3::default(),
            };
            let found = solver
                .balance(pose, point.rack, Support::Spring(spring))
                .unwrap()
                .under(&load);
            let unit = |from, to| (place(to) - place(from)).normalised();
            let tension = found.rod.unwrap();
            assert!(tension < 0.0 && found.support > 0.0);

            // Force of the wheel carrier on the arm's joint. The opposite force is the sum of the forces of the arm's
            // legs and of the rod.
            let arm = mechanism.arms[0];
            let mut on_carrier = found.support_force;
            for reaction in found.constraints {
                if let Reaction::Rod {
                    inner,
                    outer,
                    tension,
                } = reaction
                    && outer == arm.outer
                {
                    on_carrier = on_carrier + unit(outer, inner) * tension;
                }
            }
            let (front, rear) = (place(arm.front), place(arm.rear));
            let about = |at: PointId, force: Vector3<f64>| {
                (rear - front)
                    .normalised()
                    .dot((place(at) - front).cross(force))
            };
            let pull = unit(rocker.outer, rocker.inner) * tension;
            let left = about(arm.outer, -on_carrier) + about(rocker.outer, pull);
            assert!(left.abs() < 1e-12 * 2000.0 * 600.0, "arm: {left:e}");

            let axis = (place(rocker.second) - place(rocker.first)).normalised();
            let about = |at: PointId, force: Vector3<f64>| {
                axis.dot((place(at) - place(rocker.first)).cross(force))
            };
            let push = unit(spring.upper, spring.lower) * found.support;
            let left = about(rocker.inner, -pull) + about(spring.lower, push);
            assert!(left.abs() < 1e-12 * 4000.0 * 100.0, "rocker: {left:e}");

            let view = WheelReading::of(&configuration, Constants::of(&suspension));
            let quantity = Quantity::Characteristic(C::MotionRatio);
            let ratio = view.value(&configuration, quantity)[0];
            assert!((found.support * ratio - 2000.0).abs() < 1e-12 * 2000.0);
        })
        .unwrap()
        .unwrap();
    }
}

/// A pullrod is a pushrod in tension: the same points under the other name give the same results, but the angle has the
/// opposite sign.
#[test]
fn a_pullrod_differs_from_a_pushrod_by_its_sign() {
    let pushrod = template(STUDY);
    let topology = pushrod.mechanism.topology;
    let name = |name: &str| -> &'static str {
        let name = name.replace("pushrod", "pullrod");
        topology
            .all_hardpoints()
            .find(|h| h.name == name)
            .unwrap()
            .name
    };
    let names: Vec<_> = pushrod
        .mechanism
        .points
        .iter()
        .map(|p| name(&p.name))
        .collect();
    let mut mechanism = (topology.build)(topology, &names);
    let design = mechanism.points.iter().map(|point| {
        let place = names.iter().position(|n| *n == point.name).unwrap();
        pushrod.design[place]
    });
    let design: Vec<_> = design.collect();
    let outer = mechanism.rockers[0].outer;
    let drop_link = mechanism.rockers[1].outer;
    // The default body of the rod is the upper arm.
    assert_eq!(mechanism.body(outer), Body::Arm(hardpoint::model::ArmId(1)));
    mechanism.points[outer.0].body = Body::Arm(hardpoint::model::ArmId(0));
    mechanism.points[drop_link.0].body = Body::Rocker(RockerId(0));
    mechanism.spin_axis = match pushrod.mechanism.spin_axis {
        along @ hardpoint::model::SpinAxis::Along(_) => along,
        _ => mechanism.spin_axis,
    };
    let pullrod = Suspension {
        mechanism,
        design: design.clone(),
        ..pushrod.clone()
    };
    let read = [C::RockerAngle, C::MotionRatio, C::AntiRollBarAngle];
    for value in [-25.0, 10.0, 30.0] {
        let point = travel(value, 0.0);
        let pushed = characteristics(&pushrod, &pushrod.design, point, &read).unwrap();
        let pulled = characteristics(&pullrod, &design, point, &read).unwrap();
        assert_eq!(pushed[0][0], -pulled[0][0]);
        assert_eq!(pushed[1][0], pulled[1][0]);
        assert_eq!(pushed[2][0], pulled[2][0]);
        assert!(pushed[0][0] * value > 0.0);
    }
}
