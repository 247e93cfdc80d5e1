//! Tests of rockers: bell cranks of pushrods and pullrods, and anti-roll bars.

use super::truth::{Errors, PLACES, Truth, half_tangent, lift, slope};
use super::{at, characteristics, template, travel};
use crate::support::Worst;
use crate::support::larger;
use crate::support::random::Random;
use hardpoint::analyse::{Load, Reaction, Support};
use hardpoint::bench::DoubleDouble as Dd;
use hardpoint::characteristics::{Characteristic as C, Constants, Quantity, WheelReading};
use hardpoint::derive::{DesignSeries, MotionPoint};
use hardpoint::model::{Body, Drive, Mechanism, PointId, RockerId, Suspension, Topology};
use hardpoint::number::{Jet, Matrix3, Real, Scalar, Vector3};

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

/// Point rotated by `angle` about the line from `first` to `second`.
fn turned(first: Vector3<f64>, second: Vector3<f64>, angle: f64, p: Vector3<f64>) -> Vector3<f64> {
    let half = (second - first).normalised() * (0.5 * angle).tan();
    first + Matrix3::identity(0.0).turned(half).apply(p - first)
}

/// Trailing arm with a pushrod or pullrod on it.
fn trailing_arm(rod: &str) -> Mechanism {
    let topology = Topology::named("semi_trailing_arm").unwrap();
    let [outer, inner] = match rod {
        "pushrod" => ["pushrod_outer", "pushrod_inner"],
        _ => ["pullrod_outer", "pullrod_inner"],
    };
    let names = [
        "arm_pivot_inner",
        "arm_pivot_outer",
        "wheel_centre",
        "spindle_inner",
        "spring_upper",
        "spring_lower",
        outer,
        inner,
        "rocker_pivot_front",
        "rocker_pivot_rear",
    ];
    (topology.build)(topology, &names)
}

/// Reads results of a trailing arm that is rotated by an angle. A positive angle raises the wheel centre.
fn read_arm(
    mechanism: &Mechanism,
    design: &[Vector3<f64>],
    angle: f64,
) -> (Jet<f64, 3>, Vector3<f64>) {
    let point = MotionPoint {
        drive: Drive::ArmAngle,
        value: angle,
        rack: 0.0,
    };
    let design_series = DesignSeries::<3>::new(mechanism, design);
    at(mechanism, design, point, |solver, pose| {
        let configuration = solver
            .configuration_series(&design_series, pose, &point.along_drive())
            .unwrap();
        let spring = configuration.point(mechanism.spring.unwrap().lower);
        (
            configuration.rocker_angle(RockerId(0)),
            spring.map(|c| c[0]),
        )
    })
    .unwrap()
    .unwrap()
}

/// The test chooses angles of an arm and a rocker, and constructs a rod with equal lengths before and after the motion.
/// The solver must find these angles, wherever the axes are. Let p, a point on the rocker's axis, be the origin. Let i
/// be the inner end, o and o' the outer end before and after, and R the rocker's rotation. The lengths are equal if 2
/// i.(R'o' - o) = o'.o' - o.o, which is the equation of a plane for i.
#[test]
fn planted_angles_come_back() {
    let mut random = Random(21);
    let (mut tried, mut worst) = (0, 0.0_f64);
    for rod in ["pushrod", "pullrod"] {
        let mechanism = trailing_arm(rod);
        let id = |name: &str| mechanism.point(name).unwrap().0;
        let rocker = mechanism.rockers[0];
        while tried < if rod == "pushrod" { 2000 } else { 4000 } {
            let mut design = vec![Vector3::default(); mechanism.points.len()];
            design[id("arm_pivot_inner")] = random.vector(60.0);
            design[id("arm_pivot_outer")] = Vector3::new(-40.0, 300.0, 10.0) + random.vector(60.0);
            design[id("wheel_centre")] = Vector3::new(-400.0, 500.0, 0.0) + random.vector(60.0);
            design[id("spindle_inner")] = Vector3::new(-400.0, 400.0, 0.0) + random.vector(20.0);
            design[id("spring_upper")] = Vector3::new(100.0, 100.0, 300.0) + random.vector(60.0);
            design[id("spring_lower")] = Vector3::new(-100.0, 100.0, 300.0) + random.vector(60.0);
            let [first, second, inner, outer] =
                [rocker.first, rocker.second, rocker.inner, rocker.outer].map(|p| p.0);
            design[first] = Vector3::new(-200.0, 100.0, 300.0) + random.vector(60.0);
            design[second] = design[first] + random.vector(60.0);
            design[outer] = Vector3::new(-300.0, 300.0, 20.0) + random.vector(60.0);

            // A positive rotation of the arm raises the wheel centre.
            let [a, b] = ["arm_pivot_inner", "arm_pivot_outer"].map(|name| design[id(name)]);
            let raises = (b - a).cross(design[id("wheel_centre")] - a).z.signum();
            let (theta, phi) = (0.3 * random.signed(), 0.5 * random.signed());
            let moved = turned(a, b, raises * theta, design[outer]);
            let base = design[first];
            let back = turned(base, design[second], -phi, moved) - base;
            let normal = back - (design[outer] - base);
            let wanted =
                0.5 * ((moved - base).norm_squared() - (design[outer] - base).norm_squared());
            let start = random.vector(90.0);
            let lever = start + normal * ((wanted - start.dot(normal)) / normal.norm_squared());
            if lever.norm() > 200.0 {
                continue;
            }
            design[inner] = base + lever;

            // The rod must not pass a toggle: the moment of the rod about the rocker's axis keeps its sign.
            let moment = |inner: Vector3<f64>, outer: Vector3<f64>| {
                let axis = (design[second] - base).normalised();
                axis.cross(inner - base).dot(inner - outer)
            };
            let end = turned(base, design[second], phi, design[inner]);
            let (before, after) = (moment(design[inner], design[outer]), moment(end, moved));
            let rod_squared = (design[inner] - design[outer]).norm_squared();
            let leverage = after.abs() / (lever.norm() * rod_squared.sqrt());
            if before * after <= 0.0 || leverage < 0.02 {
                continue;
            }
            tried += 1;
            let (angle, spring) = read_arm(&mechanism, &design, theta);
            // The angle is positive in the direction in which the rod turns the rocker in jounce, by a push or a pull.
            let sense = before.signum() * if rod == "pushrod" { 1.0 } else { -1.0 };
            let turned_spring = turned(base, design[second], phi, design[id("spring_lower")]);
            // Squares of lengths are accurate to a few units in the last place, and the pose to 1e-13 of the
            // mechanism's size. The moment is the derivative of the square with respect to the angle.
            let q = (moved - base).norm_squared();
            let squares = rod_squared + q + lever.norm_squared();
            let allowed =
                (64.0 * f64::EPSILON * squares + 1e-13 * 600.0 * rod_squared.sqrt()) / after.abs();
            let error = (angle[0] - sense * phi).abs();
            assert!(error <= allowed, "{rod}: {error:e} of {allowed:e}");
            let error = (spring - turned_spring).norm() / 600.0;
            assert!(error <= allowed + 1e-13, "{rod}: {error:e} of {allowed:e}");
            worst = larger(worst, error);
        }
    }
    println!("{tried} planted, worst {worst:.1e}");
}

/// In a planar bell crank, angles follow from the law of cosines. With the rocker's pivot p, the angle at p between the
/// rod's outer and inner end is acos((q^2 + r^2 - L^2)/(2 q r)). Here q and r are the distances from p to the outer and
/// the inner end, and L is the rod's length.
#[test]
fn a_plane_bell_crank_is_a_triangle() {
    let mechanism = trailing_arm("pushrod");
    // All axes of rotation are along y.
    let plane = |x: f64, z: f64| Vector3::new(x, 0.0, z);
    let names = [
        ("arm_pivot_inner", plane(0.0, 0.0)),
        ("arm_pivot_outer", Vector3::new(0.0, 300.0, 0.0)),
        ("wheel_centre", Vector3::new(-450.0, 400.0, -20.0)),
        ("spindle_inner", Vector3::new(-450.0, 300.0, -20.0)),
        ("spring_upper", plane(200.0, 330.0)),
        ("spring_lower", plane(-30.0, 350.0)),
        ("pushrod_outer", plane(-300.0, 20.0)),
        ("pushrod_inner", plane(-110.0, 300.0)),
        ("rocker_pivot_front", plane(-40.0, 280.0)),
        ("rocker_pivot_rear", Vector3::new(-40.0, 50.0, 280.0)),
    ];
    let mut design = vec![Vector3::default(); mechanism.points.len()];
    for (name, p) in names {
        design[mechanism.point(name).unwrap().0] = p;
    }
    let at = |name: &str| design[mechanism.point(name).unwrap().0];
    let (pivot, inner, outer) = (
        at("rocker_pivot_front"),
        at("pushrod_inner"),
        at("pushrod_outer"),
    );
    let (r, rod) = ((inner - pivot).norm(), (inner - outer).norm());
    // Angles count from -x towards +z.
    let bearing = |p: Vector3<f64>| (p.z - pivot.z).atan2(pivot.x - p.x);
    let corner = |outer: Vector3<f64>| {
        let q = (outer - pivot).norm();
        ((q * q + r * r - rod * rod) / (2.0 * q * r)).acos()
    };
    let side = (bearing(inner) - bearing(outer)).signum();
    for step in -10..=10 {
        let theta = 0.02 * f64::from(step);
        // The arm points rearward from its hinge and rises.
        let (sine, cosine) = theta.sin_cos();
        let moved = plane(
            cosine * outer.x + sine * outer.z,
            -sine * outer.x + cosine * outer.z,
        );
        let expected = bearing(moved) + side * corner(moved) - bearing(inner);
        let (angle, _) = read_arm(&mechanism, &design, theta);
        // When the rod pushes upward, the angle of the inner end increases.
        assert!(
            (angle[0] - expected).abs() < 1e-13,
            "{theta}: {} and {expected}",
            angle[0]
        );
        if step == 10 {
            assert!(angle[0] > 0.2, "the pushrod pushes in jounce: {}", angle[0]);
        }
    }
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

/// Compares angles and spring length with thirty digits: values, rates, and the sensitivities of values and rates to
/// every hardpoint. Then compares the motion ratios, because these are the same rates, computed by another method.
#[test]
fn angles_lengths_and_ratios_agree_with_thirty_digits() {
    const H: f64 = 1e-4;
    let mut random = Random(24);
    for (name, suspension) in variants() {
        let mechanism = &suspension.mechanism;
        let spring = mechanism.spring.unwrap();
        let (mut values, mut rates) = (Worst::default(), Worst::default());
        let (mut by_point, mut ratios) = ([Worst::default(); 2], Worst::default());
        for _ in 0..2 {
            let design = random.scattered(&suspension.design, 8.0);
            let (value, rack) = (30.0 * random.signed(), 15.0 * random.signed());
            let point = travel(value, rack);
            let design_series = DesignSeries::<3>::new(mechanism, &design);
            at(mechanism, &design, point, |solver, pose| {
                let linearised = solver
                    .linearised(&design_series, pose, &point.along_drive())
                    .unwrap();
                let view = WheelReading::of(&linearised.at, Constants::of(&suspension));
                let truth = Truth::around(mechanism, &design, pose, value, rack);
                let exact: Vec<_> = design.iter().copied().map(lift).collect();
                // Length, and tangents of half the angles with the signs of the catalogue.
                let read = |design: &[Vector3<Dd>], more: f64| {
                    let pose = truth.pose(design, more, 0.0);
                    let place = |id| super::truth::place(mechanism, design, &pose, id);
                    let u = |k: usize| {
                        let rocker = &mechanism.rockers[k];
                        let [a, b, i, o] =
                            [rocker.first, rocker.second, rocker.inner, rocker.outer]
                                .map(|p| design[p.0]);
                        let pushed = (b - a).cross(i - a).dot(i - o).sign();
                        half_tangent(mechanism, design, &pose, rocker) * pushed
                    };
                    let length = (place(spring.upper) - place(spring.lower)).norm();
                    Vector3::new(length, u(0), u(1))
                };
                let curve = |design: &[Vector3<Dd>]| {
                    [
                        read(design, 0.0),
                        slope(PLACES.map(|k| read(design, k * H)), H),
                    ]
                };
                let [wanted, wanted_rate] = curve(&exact);
                let scales = [200.0, 1.0, 1.0];
                // tan(angle/2) of a Taylor series.
                let half = |k: usize, jet: Jet<f64, 3>| match k {
                    0 => jet,
                    _ => {
                        let (sine, cosine) = jet.sin_cos();
                        sine / (Jet::constant(1.0) + cosine)
                    }
                };
                let found: Vec<Jet<f64, 3>> = REPORTED
                    .iter()
                    .map(|c| view.value(&linearised.at, Quantity::Characteristic(*c)))
                    .collect();
                for (k, jet) in found.iter().enumerate() {
                    let jet = half(k, *jet);
                    let error = |found: f64, wanted: Vector3<Dd>| {
                        (Dd::from(found) - wanted.to_array()[k]).value() / scales[k]
                    };
                    values.note(error(jet[0], wanted));
                    rates.note(100.0 * error(jet[1], wanted_rate));
                }

                // Takes the derivative with respect to every coordinate.
                let points = design.len();
                let mut truths = Vec::new();
                for moved in 0..3 * points {
                    let curves = PLACES.map(|k| {
                        let mut design = exact.clone();
                        let mut p = design[moved / 3].to_array();
                        p[moved % 3] = p[moved % 3] + Dd::from(k * H);
                        design[moved / 3] = Vector3::from(p);
                        curve(&design)
                    });
                    truths.push([0, 1].map(|order| slope(curves.map(|c| c[order]), H)));
                }
                let mut buffer = vec![Vector3::new(0.0, 0.0, 0.0).map(Jet::constant); points];
                let mut gradient = |c: C, highest: usize| {
                    let mut all = vec![vec![Vector3::default(); points]; highest + 1];
                    let quantity = Quantity::Characteristic(c);
                    view.gradients(
                        &linearised,
                        quantity,
                        highest,
                        &mut buffer,
                        &mut |order, PointId(p), g| all[order][p] = g,
                    );
                    all
                };
                for (k, c) in REPORTED.into_iter().enumerate() {
                    let all = gradient(c, 1);
                    let largest = |order: usize| {
                        let sizes = truths.iter().map(|t| t[order].to_array()[k].value().abs());
                        sizes.fold(0.0, larger)
                    };
                    for (moved, truth) in truths.iter().enumerate() {
                        let (p, axis) = (moved / 3, moved % 3);
                        let [g, h] = [0, 1].map(|order| all[order][p].to_array()[axis]);
                        // With u = tan(a/2), the derivative of u with respect to a parameter p is u_p = (1 + u^2)
                        // a_p/2. The rate follows by one more derivative.
                        let found = match k {
                            0 => [g, h],
                            _ => {
                                let u = half(k, found[k]);
                                let s = 0.5 * (1.0 + u[0] * u[0]);
                                [s * g, s * h + u[0] * u[1] * g]
                            }
                        };
                        for order in 0..2 {
                            let wanted = truth[order].to_array()[k].value();
                            by_point[order].note((found[order] - wanted) / largest(order));
                        }
                    }
                }

                // The drive is the travel, so the wheel centre rises by 1 per unit of the drive in every design. Rates
                // along the drive are therefore motion ratios.
                for (ratio, of, sign) in [
                    (C::MotionRatio, 0, -1.0),
                    (C::AntiRollBarMotionRatio, 2, 1.0),
                ] {
                    let jet = view.value(&linearised.at, Quantity::Characteristic(ratio));
                    let scale = found[of][1].abs();
                    ratios.note((jet[0] - sign * found[of][1]) / scale);
                    ratios.note((jet[1] - sign * 2.0 * found[of][2]) / scale);
                    let rate = gradient(REPORTED[of], 1);
                    let own = gradient(ratio, 0);
                    let largest = rate[1].iter().map(|g| g.norm()).fold(0.0, larger);
                    for (a, b) in own[0].iter().zip(&rate[1]) {
                        ratios.note((*a - *b * sign).norm() / largest);
                    }
                }
            })
            .unwrap()
            .unwrap();
        }
        println!(
            "{name}: values {:.1e}, rates {:.1e}, sensitivities {:.1e} and {:.1e}, ratios {:.1e}",
            values.0, rates.0, by_point[0].0, by_point[1].0, ratios.0
        );
        assert!(values.0 < 1e-13 && rates.0 < 1e-11, "{name}");
        assert!(by_point.iter().all(|e| e.0 < 1e-10), "{name}: {by_point:?}");
        assert!(ratios.0 < 1e-11, "{name}: {ratios:?}");
    }
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
