//! Tests of the bell cranks of pushrods and pullrods on a trailing arm, whose angles are known.

use super::at;
use crate::support::larger;
use crate::support::random::Random;
use hardpoint::derive::{DesignSeries, MotionPoint};
use hardpoint::model::{Drive, Mechanism, RockerId, Topology};
use hardpoint::number::{Jet, Matrix3, Vector3};

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
