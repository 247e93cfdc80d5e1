//! Compares the library with twelve quadratic equations in double-double precision, for knuckles on five rods.
//!
//! Derivatives of the reference are finite differences over h = 1e-4 mm of solutions with 30 digits, extrapolated
//! once. The error of these derivatives has the order of h^4 times the fifth derivative.

use super::{at, travel};
use crate::support::Worst;
use crate::support::larger;
use crate::support::quadratics::{Quadratics, design_pose};
use hardpoint::bench::DoubleDouble as Dd;
use hardpoint::characteristics::{Constants, Quantity, WheelReading};
use hardpoint::derive::{DesignSeries, Linearised};
use hardpoint::mechanism::{Failure, Pose};
use hardpoint::model::{Axis, Body, Mechanism, PointId, Rocker};
use hardpoint::number::{Jet, Matrix3, Scalar, Vector3};
use std::array::from_fn;

const H: f64 = 1e-4;

/// Largest errors: of values relative to the suspension size, and of derivatives relative to the largest derivative of
/// their kind.
#[derive(Default, Debug)]
pub struct Errors {
    pub by_order: [Worst; 3],
    pub sensitivities: [Worst; 3],
    pub solved: usize,
    pub unreachable: usize,
    pub disagreed: usize,
}

pub fn lift(v: Vector3<f64>) -> Vector3<Dd> {
    v.map(Dd::from)
}

/// Reference solutions near one station of one design.
pub struct Truth<'a> {
    mechanism: &'a Mechanism,
    factors: nalgebra::LU<f64, nalgebra::Const<12>, nalgebra::Const<12>>,
    near: Pose<Dd>,
    travel: f64,
    rack: f64,
}

impl<'a> Truth<'a> {
    pub fn around(
        mechanism: &'a Mechanism,
        design: &[Vector3<f64>],
        near: &Pose<f64>,
        travel: f64,
        rack: f64,
    ) -> Self {
        Truth {
            mechanism,
            factors: Quadratics::new(mechanism, design).factorise(near, rack),
            near: near.map(Dd::from),
            travel,
            rack,
        }
    }

    pub fn pose(&self, design: &[Vector3<Dd>], more_travel: f64, more_rack: f64) -> Pose<Dd> {
        let exact = |value: f64, more: f64| Dd::from(value) + Dd::from(more);
        Quadratics::new(self.mechanism, design).refine(
            &self.near,
            &self.factors,
            exact(self.travel, more_travel),
            exact(self.rack, more_rack),
        )
    }

    /// Positions of knuckle points with first and second derivatives with respect to travel.
    fn curve(&self, design: &[Vector3<Dd>], points: &[PointId]) -> Vec<[Vector3<Dd>; 3]> {
        let poses = [-2.0, -1.0, 0.0, 1.0, 2.0].map(|k| self.pose(design, k * H, 0.0));
        let derivatives = points.iter().map(|p| {
            let [far_below, below, here, above, far_above] =
                poses.map(|pose| place(self.mechanism, design, &pose, *p));
            let second = |a: Vector3<Dd>, b: Vector3<Dd>, by: f64| {
                (a - here - (here - b)) * reciprocal(by * by)
            };
            [
                here,
                slope([far_below, below, above, far_above], H),
                extrapolated(
                    second(above, below, H),
                    second(far_above, far_below, 2.0 * H),
                ),
            ]
        });
        derivatives.collect()
    }
}

fn reciprocal(value: f64) -> Dd {
    Dd::from(1.0) / Dd::from(value)
}

/// Extrapolation from central differences with the steps H and 2 H. Their errors have the ratio 1 to 4.
fn extrapolated(near: Vector3<Dd>, far: Vector3<Dd>) -> Vector3<Dd> {
    near + (near - far) * reciprocal(3.0)
}

/// Positions of the four values from which [`slope`] computes a derivative, in units of the step.
pub const PLACES: [f64; 4] = [-2.0, -1.0, 1.0, 2.0];

/// Derivative from values at [`PLACES`].
pub fn slope([far_below, below, above, far_above]: [Vector3<Dd>; 4], step: f64) -> Vector3<Dd> {
    extrapolated(
        (above - below) * reciprocal(2.0 * step),
        (far_above - far_below) * reciprocal(4.0 * step),
    )
}

/// Position of a point from formulas that differ from the library's. A point of an arm follows from the axis and the
/// outer joint of the arm. A point of a rocker follows from Newton's method on the length of the rod.
pub fn place(
    mechanism: &Mechanism,
    design: &[Vector3<Dd>],
    pose: &Pose<Dd>,
    id: PointId,
) -> Vector3<Dd> {
    let point = design[id.0];
    match mechanism.body(id) {
        Body::Chassis => point,
        Body::Knuckle => pose.origin + pose.rotation.apply(point - design[mechanism.origin.0]),
        Body::Arm(arm) => {
            let arm = mechanism.arms[arm.0];
            let [front, rear] = [arm.front, arm.rear].map(|p| design[p.0]);
            let triad = |joint: Vector3<Dd>| {
                let along = (rear - front).normalised();
                let across = along.cross(joint - front).normalised();
                [along, across, along.cross(across)]
            };
            let before = triad(design[arm.outer.0]);
            let now = triad(place(mechanism, design, pose, arm.outer));
            let lever = point - front;
            let turned = before.map(|axis| axis.dot(lever));
            front + now[0] * turned[0] + now[1] * turned[1] + now[2] * turned[2]
        }
        Body::Rocker(rocker) => {
            let rocker = mechanism.rocker(rocker);
            let u = half_tangent(mechanism, design, pose, &rocker);
            turn_about(design, &rocker, u, point)
        }
        other => panic!("{other:?}"),
    }
}

/// Point rotated with a rocker. `u` is the tangent of half the angle.
fn turn_about(design: &[Vector3<Dd>], rocker: &Rocker, u: Dd, point: Vector3<Dd>) -> Vector3<Dd> {
    let [first, second] = [rocker.first, rocker.second].map(|p| design[p.0]);
    let rodrigues = (second - first).normalised() * u;
    first + Matrix3::identity(u).turned(rodrigues).apply(point - first)
}

/// Tangent of half the rocker's angle from its design position, about the line from its first to its second point.
/// Newton's method solves |inner - outer|^2 = L^2 in small steps of the outer end's path.
pub fn half_tangent(
    mechanism: &Mechanism,
    design: &[Vector3<Dd>],
    pose: &Pose<Dd>,
    rocker: &Rocker,
) -> Dd {
    const STEPS: i32 = 8;
    let [inner, outer] = [rocker.inner, rocker.outer].map(|p| design[p.0]);
    let end = place(mechanism, design, pose, rocker.outer);
    let length = (inner - outer).norm_squared();
    let [first, second] = [rocker.first, rocker.second].map(|p| design[p.0]);
    let axis = (second - first).normalised();
    let mut u = Dd::from(0.0);
    for step in 1..=STEPS {
        let outer = outer + (end - outer) * reciprocal(f64::from(STEPS) / f64::from(step));
        for _ in 0..10 {
            let now = turn_about(design, rocker, u, inner);
            let missed = (now - outer).norm_squared() - length;
            // The derivative of the angle with respect to u is 2/(1 + u^2).
            let by_angle = axis.cross(now - first).dot(now - outer) * Dd::from(2.0);
            let one = Dd::from(1.0);
            u = u - missed * (one + u * u) / (by_angle * Dd::from(2.0));
        }
    }
    u
}

impl Errors {
    /// Compares one design at one station. If `sensitivities` is true, also compares the sensitivities of values and
    /// derivatives.
    pub fn check(
        &mut self,
        mechanism: &Mechanism,
        design: &[Vector3<f64>],
        value: f64,
        rack: f64,
        sensitivities: bool,
    ) {
        let quadratics = Quadratics::new(mechanism, design);
        let start = design_pose(mechanism, design);
        // Repeats the path with fine steps, because coarse steps may have jumped to another solution branch.
        let track = |steps| quadratics.track(start, value, rack, steps);
        let point = travel(value, rack);
        let design_series = DesignSeries::<3>::new(mechanism, design).with_steering_axis(false);
        let read = at(mechanism, design, point, |solver, pose| {
            let size = solver.size();
            let same = |steps| {
                track(steps).is_some_and(|tracked| {
                    let columns = tracked.rotation.columns.into_iter();
                    let pairs = columns.zip(pose.rotation.columns);
                    let turned = pairs.map(|(a, b)| (a - b).norm());
                    let apart = (tracked.origin - pose.origin).norm() / size;
                    turned.fold(apart, larger) < 1e-6
                })
            };
            if ![10, 1000].into_iter().any(same) {
                println!("another pose than tracked: {value} {rack} {design:?}");
                self.disagreed += 1;
                return;
            }
            self.solved += 1;
            let linearised = solver
                .linearised(&design_series, pose, &point.along_drive())
                .unwrap();
            let view = WheelReading::of(&linearised.at, Constants::default());
            let points: Vec<PointId> = [
                "tie_rod_outer",
                "toe_link_outer",
                "wheel_centre",
                "spindle_inner",
                "spring_lower",
                "drop_link_inner",
            ]
            .iter()
            .filter_map(|name| mechanism.point(name))
            .collect();
            let truth = Truth::around(mechanism, design, pose, value, rack);
            let exact: Vec<_> = design.iter().copied().map(lift).collect();
            let curve = truth.curve(&exact, &points);
            for (id, wanted) in points.iter().zip(&curve) {
                for axis in Axis::ALL {
                    let found = view.value(&linearised.at, Quantity::Coordinate(*id, axis));
                    for order in 0..3 {
                        let wanted = wanted[order].to_array()[axis as usize];
                        let scale = if order == 0 {
                            size
                        } else {
                            largest(&curve, order)
                        };
                        let error = Dd::from(found.derivative(order)) - wanted;
                        self.by_order[order].note(error.value() / scale);
                    }
                }
            }
            if sensitivities {
                self.check_sensitivities(&truth, &exact, &points, &view, &linearised);
            }
        });
        match read {
            Ok(Ok(())) => {}
            Ok(Err(Failure::Unreachable { .. } | Failure::RackUnreachable { .. }))
                if track(1000).is_none() =>
            {
                self.unreachable += 1;
            }
            other => {
                println!("{other:?} at {value} {rack} {design:?}");
                self.disagreed += 1;
            }
        }
    }

    /// Compares the gradients of points, and of their derivatives, with difference quotients of exact curves.
    fn check_sensitivities(
        &mut self,
        truth: &Truth<'_>,
        exact: &[Vector3<Dd>],
        points: &[PointId],
        view: &WheelReading<3>,
        linearised: &Linearised<'_, 3>,
    ) {
        let mut wanted = Vec::new();
        for hardpoint in 0..exact.len() {
            for axis in 0..3 {
                let moved = |by: f64| {
                    let mut design = exact.to_vec();
                    let mut p = design[hardpoint].to_array();
                    p[axis] = p[axis] + Dd::from(by);
                    design[hardpoint] = Vector3::from(p);
                    truth.curve(&design, points)
                };
                let moved = PLACES.map(|k| moved(k * H));
                let slopes: Vec<[Vector3<Dd>; 3]> = (0..points.len())
                    .map(|i| from_fn(|order| slope(from_fn(|k| moved[k][i][order]), H)))
                    .collect();
                wanted.push(slopes);
            }
        }
        let scale: [f64; 3] =
            from_fn(|order| wanted.iter().map(|w| largest(w, order)).fold(0.0, larger));
        let mut buffer = vec![Vector3::new(0.0, 0.0, 0.0).map(Jet::constant); exact.len()];
        for (k, id) in points.iter().enumerate() {
            for axis in Axis::ALL {
                view.gradients(
                    linearised,
                    Quantity::Coordinate(*id, axis),
                    2,
                    &mut buffer,
                    &mut |order, PointId(p), gradient| {
                        for (by, found) in gradient.to_array().into_iter().enumerate() {
                            let wanted = wanted[3 * p + by][k][order].to_array()[axis as usize];
                            self.sensitivities[order].note((found - wanted.value()) / scale[order]);
                        }
                    },
                );
            }
        }
    }
}

/// Largest position of several points, or their largest derivative of an order.
fn largest(curve: &[[Vector3<Dd>; 3]], order: usize) -> f64 {
    let sizes = curve.iter().map(|c| c[order].map(|v| v.value()).norm());
    sizes.fold(0.0, larger)
}
