//! The six closure equations of a mechanism in the pose of its knuckle: five constraints and a drive.
//!
//! Every equation is written as a residual F and, beside it, as its differential
//!
//! ```text
//! dF = force . d(origin) + moment . d(rotation) + sum over hardpoints gradient . d(hardpoint)
//! ```
//!
//! Force and moment form the row of the 6x6 Jacobian J; they are the Pluecker coordinates of the line
//! the constraint acts along, so J is singular exactly where the mechanism is. The gradients are the
//! rest of the implicit function theorem (see [`super::sensitivity`]). Rows are scaled to lengths, so
//! that forces are about one and moments about one length.

use super::lu::{Lu6, Matrix6, Vector6};
use super::pose::{Pose, Posture, Sink};
use crate::model::{Constraint, Mechanism, PointId};
use crate::number::{Real, Vector3};

/// The sixth equation: what drives the mechanism, with its present value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Driver<T> {
    /// Height of the wheel centre above its design position.
    Travel(T),
    /// Angle of the first arm from its design position, about its axis taken pointing forward.
    ArmAngle {
        /// Sine of the angle.
        sine: T,
        /// Cosine of the angle.
        cosine: T,
    },
}

/// A wrench on the knuckle at its origin: a row of the Jacobian, or the derivative of an output by the
/// pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Wrench<T> {
    pub force: Vector3<T>,
    pub moment: Vector3<T>,
}

impl<T: Real> Wrench<T> {
    pub(super) fn zero(like: T) -> Self {
        let zero = Vector3::new(like, like, like).zero();
        Wrench {
            force: zero,
            moment: zero,
        }
    }

    pub(super) fn to_row(self) -> Vector6<T> {
        let (f, m) = (self.force, self.moment);
        [f.x, f.y, f.z, m.x, m.y, m.z]
    }
}

impl<T: Real> Sink<T> for Wrench<T> {
    #[inline]
    fn wrench(&mut self, force: Vector3<T>, moment: Vector3<T>) {
        self.force = self.force + force;
        self.moment = self.moment + moment;
    }
    #[inline]
    fn hardpoint(&mut self, _: PointId, _: Vector3<T>) {}
}

/// One scalar closure equation, with what of it depends on the design alone.
#[derive(Clone, Copy, Debug)]
enum Row<T> {
    /// (|d|^2 - |d0|^2)/(2 |d0|) = 0, d from the inner to the outer joint, d0 its design value.
    Link {
        inner: PointId,
        outer: PointId,
        half_squared_length: T,
        /// 1/|d0|, held fixed: it only scales the row.
        scale: T,
    },
    /// R n . (top - R top0) = 0: the strut mount stays on the strut line, whose normal n is fixed in
    /// the knuckle; R top0 stands for the knuckle-fixed point that was at the mount in the design.
    StrutLine {
        top: PointId,
        lower: PointId,
        upper: Option<PointId>,
        /// n.
        normal: Vector3<T>,
        /// Direction of the line, u.
        along: Vector3<T>,
        /// 1 over the design distance of the two points that give the direction.
        inverse_base: T,
    },
}

impl<T: Real> Row<T> {
    /// Appends the rows of a constraint.
    fn prepare(constraint: Constraint, design: &[Vector3<T>], rows: &mut Vec<Row<T>>) {
        match constraint {
            Constraint::Link { inner, outer } => {
                let squared = (design[outer.0] - design[inner.0]).norm_squared();
                rows.push(Row::Link {
                    inner,
                    outer,
                    half_squared_length: squared.scaled(0.5),
                    scale: squared.one() / squared.sqrt(),
                });
            }
            Constraint::StrutLine { top, lower, upper } => {
                let base = design[upper.unwrap_or(top).0] - design[lower.0];
                let inverse_base = base.x.one() / base.norm();
                let along = base * inverse_base;
                for normal in normals(along) {
                    rows.push(Row::StrutLine {
                        top,
                        lower,
                        upper,
                        normal,
                        along,
                        inverse_base,
                    });
                }
            }
        }
    }

    #[inline]
    fn residual(&self, at: &Posture<T>) -> T {
        match *self {
            Row::Link {
                inner,
                outer,
                half_squared_length,
                scale,
            } => {
                let d = at.point(outer) - at.point(inner);
                (d.norm_squared().scaled(0.5) - half_squared_length) * scale
            }
            Row::StrutLine { top, normal, .. } => {
                let gap = at.point(top) - at.pose.origin;
                at.pose.rotation.apply(normal).dot(gap) - normal.dot(at.designed_lever(top))
            }
        }
    }

    /// Adds `weight` times the differential to the sink.
    #[inline]
    fn differential(&self, at: &Posture<T>, weight: T, sink: &mut impl Sink<T>) {
        match *self {
            Row::Link {
                inner,
                outer,
                scale,
                ..
            } => {
                // d(d^2/2)/L = d.(d outer - d inner)/L, less the same in the design position.
                let weight = weight * scale;
                let now = (at.point(outer) - at.point(inner)) * weight;
                let designed = (at.designed(outer) - at.designed(inner)) * weight;
                at.push_point(outer, now, sink);
                at.push_point(inner, -now, sink);
                sink.hardpoint(outer, -designed);
                sink.hardpoint(inner, designed);
            }
            Row::StrutLine {
                top,
                lower,
                upper,
                normal,
                inverse_base,
                along,
            } => {
                // F = Rn.(top - origin) - n.(top0 - origin0).
                let gap = at.point(top) - at.pose.origin;
                let turned = at.pose.rotation.apply(normal) * weight;
                sink.wrench(-turned, turned.cross(gap));
                at.push_point(top, turned, sink);
                sink.hardpoint(top, -(normal * weight));
                sink.hardpoint(at.mechanism.origin, normal * weight);
                // With the line turns its normal: dn = -u (n.du), du normal to u; what is left of F is
                // how far the knuckle has slid along the line.
                let slid =
                    at.pose.rotation.apply(along).dot(gap) - along.dot(at.designed_lever(top));
                let by_direction = normal * (-(slid * weight) * inverse_base);
                sink.hardpoint(upper.unwrap_or(top), by_direction);
                sink.hardpoint(lower, -by_direction);
            }
        }
    }
}

/// Two unit vectors that form a right-handed frame with the given one.
fn normals<T: Real>(along: Vector3<T>) -> [Vector3<T>; 2] {
    let size = along.map(|c| c.value().abs());
    let helper = if size.x <= size.y && size.x <= size.z {
        Vector3::new(1.0, 0.0, 0.0)
    } else if size.y <= size.z {
        Vector3::new(0.0, 1.0, 0.0)
    } else {
        Vector3::new(0.0, 0.0, 1.0)
    };
    let first = along.cross(along.lit(helper)).normalised();
    [first, along.cross(first)]
}

/// The closure equations of one design.
#[derive(Clone, Debug)]
pub struct Closure<T> {
    rows: Vec<Row<T>>,
}

impl<T: Real> Closure<T> {
    /// The equations of a design.
    pub fn new(mechanism: &Mechanism, design: &[Vector3<T>]) -> Self {
        let mut closure = Closure {
            rows: Vec::with_capacity(5),
        };
        closure.prepare(mechanism, design);
        closure
    }

    /// Takes over another design of the same mechanism, without allocating.
    pub fn prepare(&mut self, mechanism: &Mechanism, design: &[Vector3<T>]) {
        self.rows.clear();
        for constraint in &mechanism.constraints {
            Row::prepare(*constraint, design, &mut self.rows);
        }
        debug_assert_eq!(self.rows.len(), 5, "five constraints hold a knuckle");
    }

    /// The residuals, as lengths: five constraints, then the drive.
    #[inline]
    pub(super) fn residuals(&self, at: &Posture<T>, driver: Driver<T>) -> Vector6<T> {
        let mut residuals = [at.rack.zero(); 6];
        for (residual, row) in residuals.iter_mut().zip(&self.rows) {
            *residual = row.residual(at);
        }
        residuals[5] = driver.residual(at);
        residuals
    }

    /// The Jacobian by the pose.
    #[inline]
    pub(super) fn jacobian(&self, at: &Posture<T>, driver: Driver<T>) -> Matrix6<T> {
        let like = at.rack;
        let mut jacobian = [[like.zero(); 6]; 6];
        for (line, row) in jacobian.iter_mut().zip(&self.rows) {
            let mut wrench = Wrench::zero(like);
            row.differential(at, like.one(), &mut wrench);
            *line = wrench.to_row();
        }
        let mut wrench = Wrench::zero(like);
        driver.differential(at, like.one(), &mut wrench);
        jacobian[5] = wrench.to_row();
        jacobian
    }

    /// Adds `weights` times the differentials of the six equations to the sink.
    #[inline]
    pub(super) fn differential(
        &self,
        at: &Posture<T>,
        driver: Driver<T>,
        weights: &Vector6<T>,
        sink: &mut impl Sink<T>,
    ) {
        for (row, weight) in self.rows.iter().zip(weights) {
            row.differential(at, *weight, sink);
        }
        driver.differential(at, weights[5], sink);
    }
}

impl Closure<f64> {
    /// One Newton step from a pose: the corrected pose, the size of the correction as a length (the
    /// rotation counted at the distance `size`), and the factorised Jacobian it was made with.
    pub(super) fn newton_step(
        &self,
        at: &Posture<f64>,
        driver: Driver<f64>,
        size: f64,
    ) -> Option<(Pose<f64>, f64, Lu6<f64>)> {
        let lu = Lu6::new(self.jacobian(at, driver), size)?;
        let [x, y, z, a, b, c] = lu.solve(self.residuals(at, driver)).map(|v| -v);
        let (shift, turn) = (Vector3::new(x, y, z), Vector3::new(a, b, c));
        let pose = at.pose.moved(shift, turn * 0.5);
        Some((pose, shift.norm().max(turn.norm() * size), lu))
    }
}

impl<T: Real> Driver<T> {
    #[inline]
    fn residual(&self, at: &Posture<T>) -> T {
        match *self {
            Driver::Travel(travel) => {
                let centre = at.mechanism.wheel_centre;
                at.point(centre).z - at.designed(centre).z - travel
            }
            Driver::ArmAngle { sine, cosine } => {
                let arm = ArmFrame::of(at);
                (cosine * arm.sine() - sine * arm.cosine()) * arm.inverse_radius
            }
        }
    }

    #[inline]
    fn differential(&self, at: &Posture<T>, weight: T, sink: &mut impl Sink<T>) {
        match *self {
            Driver::Travel(_) => {
                let centre = at.mechanism.wheel_centre;
                let zero = weight.zero();
                let up = Vector3::new(zero, zero, weight);
                at.push_point(centre, up, sink);
                sink.hardpoint(centre, -up);
            }
            Driver::ArmAngle { sine, cosine } => {
                let arm = ArmFrame::of(at);
                let (e, from, to) = (arm.axis, arm.designed, arm.now);
                let weight = weight * arm.inverse_radius;
                let (c, s) = (cosine * weight, sine * weight);
                let along = (e.dot(from), e.dot(to));
                let by_now = e.cross(from) * c - (from - e * along.0) * s;
                let by_designed = to.cross(e) * c - (to - e * along.1) * s;
                let by_axis = from.cross(to) * c + (to * along.0 + from * along.1) * s;
                let by_base = (by_axis - e * e.dot(by_axis)) * arm.inverse_base;
                let (tail, head) = arm.tail_and_head;
                let outer = at.mechanism.arms[0].outer;
                at.push_point(outer, by_now, sink);
                sink.hardpoint(outer, by_designed);
                sink.hardpoint(tail, -(by_now + by_designed + by_base));
                sink.hardpoint(head, by_base);
            }
        }
    }
}

/// The first arm in the design and now, about its axis. With a0 and a from the axis to the outer
/// joint, e the unit axis:
///
/// ```text
/// sine   = e.(a0 x a)              = r^2 sin(angle)
/// cosine = a.a0 - (a.e)(a0.e)      = r^2 cos(angle)
/// ```
struct ArmFrame<T> {
    /// Unit vector along the axis, taken pointing forward.
    axis: Vector3<T>,
    designed: Vector3<T>,
    now: Vector3<T>,
    /// The axis points from the first to the second.
    tail_and_head: (PointId, PointId),
    inverse_base: T,
    /// 1 over the arm's radius, held fixed: it only scales the row.
    inverse_radius: T,
}

impl<T: Real> ArmFrame<T> {
    #[inline]
    fn of(at: &Posture<T>) -> Self {
        let arm = at.mechanism.arms[0];
        let rear_to_front = at.designed(arm.front) - at.designed(arm.rear);
        // "Forward" must not depend on the order in which the two pivots are named.
        let (tail, head, base) = if rear_to_front.x.value() >= 0.0 {
            (arm.rear, arm.front, rear_to_front)
        } else {
            (arm.front, arm.rear, -rear_to_front)
        };
        let inverse_base = base.x.one() / base.norm();
        let axis = base * inverse_base;
        let designed = at.designed(arm.outer) - at.designed(tail);
        let radius = (designed - axis * axis.dot(designed)).norm();
        ArmFrame {
            axis,
            designed,
            now: at.point(arm.outer) - at.designed(tail),
            tail_and_head: (tail, head),
            inverse_base,
            inverse_radius: radius.one() / radius,
        }
    }

    #[inline]
    fn sine(&self) -> T {
        self.axis.dot(self.designed.cross(self.now))
    }

    #[inline]
    fn cosine(&self) -> T {
        self.now.dot(self.designed) - self.now.dot(self.axis) * self.designed.dot(self.axis)
    }
}
