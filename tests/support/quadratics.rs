//! A knuckle on five rods as twelve quadratic equations for the position of its origin and the nine entries of its
//! rotation. This independent formulation uses none of the library's constraint rows. Newton's method solves it in
//! doubles (to track) and in double-doubles (for 30 digits).
//!
//! A rod or a joint may end on an arm. A point of an arm follows from three directions (the triad), which are defined
//! by the arm's axis and outer joint.

use hardpoint::bench::DoubleDouble as Dd;
use hardpoint::mechanism::Pose;
use hardpoint::model::{ArmId, Body, Constraint, Mechanism, PointId};
use hardpoint::number::{Matrix3, Real, Scalar, Vector3};
use nalgebra::{LU, SMatrix, SVector};

type Factors = LU<f64, nalgebra::Const<12>, nalgebra::Const<12>>;

/// Equations of one design.
#[derive(Clone)]
pub struct Quadratics<T> {
    rods: Vec<Equation<T>>,
    wheel: Vector3<T>,
    wheel_height: T,
}

/// One of the five equations.
#[derive(Clone, Copy)]
enum Equation<T> {
    /// Rod: end on the body, lever on the knuckle, and squared length.
    Rod(End<T>, Vector3<T>, T),
    /// Joint with an arm, for one component of the position: end on the arm, lever on the knuckle, and number of the
    /// component.
    Joint(End<T>, Vector3<T>, usize),
}

/// End of a rod or joint that is not on the knuckle.
#[derive(Clone, Copy)]
enum End<T> {
    Body(Vector3<T>),
    Rack(Vector3<T>),
    Arm(OnArm<T>),
}

/// Point of an arm.
#[derive(Clone, Copy)]
struct OnArm<T> {
    front: Vector3<T>,
    rear: Vector3<T>,
    /// Lever of the arm's outer joint, on the knuckle.
    lever: Vector3<T>,
    /// Coordinates of the point in the triad of the arm.
    by_triad: [T; 3],
}

/// Triad of an arm: direction of the axis, direction perpendicular to the axis and to the joint's lever, and the normal
/// of both.
fn triad<T: Real>(front: Vector3<T>, rear: Vector3<T>, joint: Vector3<T>) -> [Vector3<T>; 3] {
    let along = (rear - front).normalised();
    let across = along.cross(joint - front).normalised();
    [along, across, along.cross(across)]
}

impl<T: Real> OnArm<T> {
    fn new(mechanism: &Mechanism, design: &[Vector3<T>], arm: ArmId, point: PointId) -> Self {
        let arm = mechanism.arms[arm.0];
        let [front, rear, joint] = [arm.front, arm.rear, arm.outer].map(|id| design[id.0]);
        let lever = design[point.0] - front;
        OnArm {
            front,
            rear,
            lever: joint - design[mechanism.origin.0],
            by_triad: triad(front, rear, joint).map(|axis| axis.dot(lever)),
        }
    }

    fn place(&self, pose: &Pose<T>) -> Vector3<T> {
        let joint = pose.origin + pose.rotation.apply(self.lever);
        let [a, b, c] = triad(self.front, self.rear, joint);
        let [x, y, z] = self.by_triad;
        self.front + a * x + b * y + c * z
    }
}

pub fn design_pose(mechanism: &Mechanism, design: &[Vector3<f64>]) -> Pose<f64> {
    Pose {
        origin: design[mechanism.origin.0],
        rotation: Matrix3::identity(0.0),
    }
}

impl<T: Real> Quadratics<T> {
    pub fn new(mechanism: &Mechanism, design: &[Vector3<T>]) -> Self {
        let origin = design[mechanism.origin.0];
        let rods = mechanism
            .constraints
            .iter()
            .flat_map(|constraint| match *constraint {
                Constraint::Link { inner, outer } => {
                    let (c, o) = (design[inner.0], design[outer.0]);
                    let length = o - c;
                    let end = match mechanism.body(inner) {
                        Body::Rack => End::Rack(c),
                        Body::Arm(arm) => End::Arm(OnArm::new(mechanism, design, arm, inner)),
                        _ => End::Body(c),
                    };
                    vec![Equation::Rod(end, o - origin, length.dot(length))]
                }
                Constraint::ArmJoint { arm, at } => {
                    let end = End::Arm(OnArm::new(mechanism, design, arm, at));
                    let lever = design[at.0] - origin;
                    // The line through both joints is nearly along x.
                    [1, 2]
                        .map(|axis| Equation::Joint(end, lever, axis))
                        .to_vec()
                }
                _ => panic!("rods only"),
            });
        let centre = design[mechanism.wheel_centre.0];
        Quadratics {
            rods: rods.collect(),
            wheel: centre - origin,
            wheel_height: centre.z,
        }
    }

    /// Vector from the inner to the outer end.
    fn rod(&self, i: usize, pose: &Pose<T>, rack: T) -> Vector3<T> {
        let (Equation::Rod(end, lever, _) | Equation::Joint(end, lever, _)) = self.rods[i];
        let inner = match end {
            End::Body(inner) => inner,
            End::Rack(inner) => Vector3::new(inner.x, inner.y + rack, inner.z),
            End::Arm(point) => point.place(pose),
        };
        pose.origin + pose.rotation.apply(lever) - inner
    }

    fn residual(&self, i: usize, pose: &Pose<T>, rack: T) -> T {
        let d = self.rod(i, pose, rack);
        match self.rods[i] {
            Equation::Rod(_, _, squared) => d.dot(d) - squared,
            Equation::Joint(_, _, axis) => d.to_array()[axis],
        }
    }

    fn residuals(&self, pose: &Pose<T>, travel: T, rack: T) -> [T; 12] {
        let mut all = [travel.zero(); 12];
        for (i, residual) in all[..5].iter_mut().enumerate() {
            *residual = self.residual(i, pose, rack);
        }
        let wheel = pose.origin + pose.rotation.apply(self.wheel);
        all[5] = wheel.z - self.wheel_height - travel;
        let c = pose.rotation.columns;
        for (k, (i, j)) in PAIRS.into_iter().enumerate() {
            let one = if i == j { travel.one() } else { travel.zero() };
            all[6 + k] = c[i].dot(c[j]) - one;
        }
        all
    }
}

const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)];

impl Quadratics<f64> {
    pub fn factorise(&self, pose: &Pose<f64>, rack: f64) -> Factors {
        let mut jacobian = SMatrix::<f64, 12, 12>::zeros();
        for i in 0..5 {
            let lever = match self.rods[i] {
                Equation::Rod(End::Body(_) | End::Rack(_), lever, _) => lever.to_array(),
                // Derivatives from finite differences are sufficient for Newton's method.
                _ => {
                    for j in 0..12 {
                        let mut unit = SVector::<f64, 12>::zeros();
                        unit[j] = if j < 3 { 1e-3 } else { 1e-5 };
                        let at = |sign: f64| {
                            let moved = apply(pose, &unit, |a, b| a + sign * b);
                            self.residual(i, &moved, rack)
                        };
                        jacobian[(i, j)] = (at(1.0) - at(-1.0)) / (2.0 * unit[j]);
                    }
                    continue;
                }
            };
            let d = self.rod(i, pose, rack).to_array();
            for a in 0..3 {
                jacobian[(i, a)] = 2.0 * d[a];
                for k in 0..3 {
                    jacobian[(i, 3 + 3 * k + a)] = 2.0 * d[a] * lever[k];
                }
            }
        }
        let wheel = self.wheel.to_array();
        jacobian[(5, 2)] = 1.0;
        for k in 0..3 {
            jacobian[(5, 3 + 3 * k + 2)] = wheel[k];
        }
        let c = pose.rotation.columns.map(|c| c.to_array());
        for (row, (i, j)) in PAIRS.into_iter().enumerate() {
            for a in 0..3 {
                jacobian[(6 + row, 3 + 3 * i + a)] += c[j][a];
                jacobian[(6 + row, 3 + 3 * j + a)] += c[i][a];
            }
        }
        jacobian.lu()
    }

    /// Result of Newton's method from any start: a pose to within rounding, or a reflection of a pose. `None` if the
    /// method does not converge.
    pub fn solve_from(&self, start: Pose<f64>, travel: f64, rack: f64) -> Option<Pose<f64>> {
        let mut pose = start;
        for _ in 0..80 {
            let lu = self.factorise(&pose, rack);
            let step = lu.solve(&SVector::from(self.residuals(&pose, travel, rack)))?;
            pose = apply(&pose, &step, |a, b| a - b);
            if step.rows(3, 9).amax() < 1e-12 {
                return Some(pose);
            }
        }
        None
    }

    /// Largest relative error of a rod's length.
    pub fn length_error(&self, pose: &Pose<f64>, rack: f64) -> f64 {
        let error = |i: usize| match self.rods[i] {
            Equation::Rod(_, _, squared) => {
                (self.rod(i, pose, rack).norm() / squared.sqrt() - 1.0).abs()
            }
            Equation::Joint(..) => panic!("rods only"),
        };
        (0..5).map(error).fold(0.0, f64::max)
    }

    /// Pose reached from the design position. The rack moves first, then the wheel, each in `steps` small steps. `None`
    /// if Newton's method would jump.
    pub fn track(
        &self,
        start: Pose<f64>,
        travel: f64,
        rack: f64,
        steps: usize,
    ) -> Option<Pose<f64>> {
        let mut pose = start;
        let rack_steps = if rack == 0.0 { 0 } else { steps };
        let racks = (1..=rack_steps).map(|i| (0.0, rack * i as f64 / steps as f64));
        let travels = (1..=steps).map(|i| (travel * i as f64 / steps as f64, rack));
        for (z, r) in racks.chain(travels) {
            let mut last = f64::INFINITY;
            for _ in 0..6 {
                let lu = self.factorise(&pose, r);
                let step = lu.solve(&SVector::from(self.residuals(&pose, z, r)))?;
                pose = apply(&pose, &step, |a, b| a - b);
                let size = step.rows(3, 9).amax();
                if size > 0.2 || size > 2.0 * last {
                    return None;
                }
                last = size;
                if size < 1e-13 {
                    break;
                }
            }
        }
        Some(pose)
    }
}

fn apply<T: Real>(pose: &Pose<T>, step: &SVector<f64, 12>, less: impl Fn(T, f64) -> T) -> Pose<T> {
    let part = |v: Vector3<T>, first: usize| {
        Vector3::new(
            less(v.x, step[first]),
            less(v.y, step[first + 1]),
            less(v.z, step[first + 2]),
        )
    };
    let [a, b, c] = pose.rotation.columns;
    Pose {
        origin: part(pose.origin, 0),
        rotation: Matrix3 {
            columns: [part(a, 3), part(b, 6), part(c, 9)],
        },
    }
}

impl Quadratics<Dd> {
    /// Solution near a given pose, to the last digits of a double-double. `factors` may be those of a neighbouring
    /// design or station.
    pub fn refine(&self, start: &Pose<Dd>, factors: &Factors, travel: Dd, rack: Dd) -> Pose<Dd> {
        let mut pose = *start;
        for _ in 0..12 {
            let residuals = self.residuals(&pose, travel, rack).map(|r| r.value());
            let step = factors.solve(&SVector::from(residuals)).unwrap();
            pose = apply(&pose, &step, |a, b| a - Dd::from(b));
            if step.amax() < 1e-27 {
                return pose;
            }
        }
        panic!("the refinement does not settle");
    }
}
