//! The MacPherson strut in closed form: pose of the knuckle from the angle of the lower arm.
//!
//! All vectors start at the lower ball joint (point 5 of the seed paper); subscript 0 is the design
//! position.
//!
//! ```text
//! r(th)  = c + rv cos th + rw sin th     the ball joint on its circle about the arm's axis
//! d = p4 - r,  g = p3 - r,  n = d x g    to the strut mount, to the tie rod's inner end
//! ```
//!
//! *Strut.* With u0 the strut direction in the knuckle and m the vector from the ball joint to the foot
//! of its perpendicular on the strut line, m + s u0 is carried onto d; lengths give the strut length
//! s = sqrt(d.d - m.m). What is left is a turn about d, the steering axis.
//!
//! *Tie rod.* Its outer end t obeys t.d = t0.(m + s u0), t.t = t0.t0 and |t - g| = L, so that
//! t = al d + be g + ga n with al, be from the 2x2 Gram system and
//! ga^2 |n|^2 = t.t - al t.d - be t.g. The sign of ga says on which side of the plane through steering
//! axis and rack joint the rod's end lies; it cannot change but where ga = 0 (toggle).
//!
//! *Any knuckle vector* x0: with v = m + s u0 carried onto d and t0 onto t,
//! x = a d + b t + k (d x t), a, b from x0.v, x0.t0 and k from x0.(v x t0).
//!
//! Nothing divides by |m|: a ball joint on the strut axis is an ordinary case. What can vanish is
//! s (mount at the foot), G = |n|^2 (tie rod does not steer), E = |d x t|^2 (outer end on the steering
//! axis) and ga (toggle).

use super::path::{DEGENERATE, DesignFault};
use super::pose::Pose;
use crate::model::{Constraint, Mechanism, PointId};
use crate::number::{Matrix3, Real, Vector3};
use std::array::from_fn;

/// The hardpoints the closed form speaks of.
#[derive(Clone, Copy, Debug)]
pub(super) struct StrutPoints {
    arm: [PointId; 2],
    ball_joint: PointId,
    top: PointId,
    lower: PointId,
    upper: Option<PointId>,
    tie_rod_inner: PointId,
    tie_rod_outer: PointId,
    wheel_centre: PointId,
}

impl StrutPoints {
    /// Reads the roles of the points off the constraints.
    pub(super) fn of(mechanism: &Mechanism) -> Option<Self> {
        let [
            Constraint::Link {
                inner: front,
                outer,
            },
            Constraint::Link { inner: rear, .. },
            Constraint::StrutLine { top, lower, upper },
            Constraint::Link {
                inner: tie_rod_inner,
                outer: tie_rod_outer,
            },
        ] = mechanism.constraints[..]
        else {
            return None;
        };
        Some(StrutPoints {
            arm: [front, rear],
            ball_joint: outer,
            top,
            lower,
            upper,
            tie_rod_inner,
            tie_rod_outer,
            wheel_centre: mechanism.wheel_centre,
        })
    }
}

impl StrutPoints {
    /// Names what is degenerate in a design.
    pub(super) fn check(
        &self,
        form: &StrutForm<f64>,
        design: &[Vector3<f64>],
    ) -> Result<(), DesignFault> {
        let state = form.at(1.0, 0.0, 0.0);
        let (dd, gg) = (state.dd, state.g.norm_squared());
        let to_top = design[self.top.0] - design[self.ball_joint.0];
        let tie = design[self.tie_rod_outer.0] - design[self.ball_joint.0];
        let small = DEGENERATE * DEGENERATE;
        if !(form.foot_squared < dd * (1.0 - small)) {
            return Err(DesignFault::NoStrutLength);
        }
        if !(state.n.norm_squared() > small * dd * gg) {
            return Err(DesignFault::NoSteering {
                end: self.tie_rod_inner,
            });
        }
        if !(to_top.cross(tie).norm_squared() > small * dd * form.tie_squared) {
            return Err(DesignFault::NoSteering {
                end: self.tie_rod_outer,
            });
        }
        // In the design position the tie rod's end is known directly: no root need be taken.
        let height = tie.dot(state.n).abs();
        if !(height > DEGENERATE * (form.tie_squared * state.n.norm_squared()).sqrt()) {
            return Err(DesignFault::Toggle);
        }
        Ok(())
    }
}

impl<T: Real> StrutForm<T> {
    /// The constants over another kind of number.
    #[inline]
    pub(super) fn map<U>(&self, mut f: impl FnMut(T) -> U) -> StrutForm<U> {
        StrutForm {
            circle_centre: self.circle_centre.map(&mut f),
            radius: self.radius.map(&mut f),
            radius_turned: self.radius_turned.map(&mut f),
            top: self.top.map(&mut f),
            tie_rod_inner: self.tie_rod_inner.map(&mut f),
            foot_squared: f(self.foot_squared),
            tie_squared: f(self.tie_squared),
            tie_by_foot: f(self.tie_by_foot),
            tie_by_strut: f(self.tie_by_strut),
            tie_difference: f(self.tie_difference),
            side: f(self.side),
            wheel_centre: self.wheel_centre.map(&mut f),
            basis: self.basis.map(|b| b.map(&mut f)),
            wheel_height: f(self.wheel_height),
        }
    }
}

impl<T: Real> Carried<T> {
    #[inline]
    fn map<U>(&self, mut f: impl FnMut(T) -> U) -> Carried<U> {
        Carried {
            by_m: f(self.by_m),
            by_u: f(self.by_u),
            by_t: f(self.by_t),
            by_mt: f(self.by_mt),
            by_ut: f(self.by_ut),
        }
    }
}

/// A knuckle vector by what its image needs: its products with m, u0, t0, m x t0 and u0 x t0.
#[derive(Clone, Copy, Debug)]
struct Carried<T> {
    by_m: T,
    by_u: T,
    by_t: T,
    by_mt: T,
    by_ut: T,
}

/// The constants of one design.
#[derive(Clone, Copy, Debug)]
pub(super) struct StrutForm<T> {
    circle_centre: Vector3<T>,
    radius: Vector3<T>,
    radius_turned: Vector3<T>,
    top: Vector3<T>,
    tie_rod_inner: Vector3<T>,
    foot_squared: T,
    tie_squared: T,
    tie_by_foot: T,
    tie_by_strut: T,
    /// (t0.t0 - L^2)/2
    tie_difference: T,
    /// +1 or -1: the assembly the design is in.
    side: T,
    wheel_centre: Carried<T>,
    basis: [Carried<T>; 3],
    /// Design height of the wheel centre.
    wheel_height: T,
}

/// The mechanism at one arm angle.
#[derive(Clone, Copy, Debug)]
pub(super) struct StrutState<T> {
    ball_joint: Vector3<T>,
    d: Vector3<T>,
    g: Vector3<T>,
    n: Vector3<T>,
    dd: T,
    dg: T,
    strut_length: T,
    tau: T,
    al: T,
    be: T,
    ga: T,
    tie_squared: T,
    inverse_e: T,
    /// ga^2 G / t.t: squared sine of the angle between the steering arm and the plane through steering
    /// axis and rack joint, up to the cosine of t against d.
    toggle_margin: T,
}

impl<T: Real> StrutForm<T> {
    /// The constants of a design.
    pub(super) fn new(points: &StrutPoints, design: &[Vector3<T>]) -> Self {
        let at = |id: PointId| design[id.0];
        let [front, rear] = points.arm.map(at);
        let ball_joint = at(points.ball_joint);
        // The axis taken pointing forward, like the arm-angle drive.
        let rear_to_front = (front - rear).normalised();
        let axis = if rear_to_front.x.value() >= 0.0 {
            rear_to_front
        } else {
            -rear_to_front
        };
        let circle_centre = front + axis * (ball_joint - front).dot(axis);
        let radius = ball_joint - circle_centre;

        let (top, inner) = (at(points.top), at(points.tie_rod_inner));
        let to_top = top - ball_joint;
        let line = (at(points.upper.unwrap_or(points.top)) - at(points.lower)).normalised();
        let along = line.dot(to_top);
        let (u, along) = if along.value() < 0.0 {
            (-line, -along)
        } else {
            (line, along)
        };
        let foot = to_top - u * along;
        let tie = at(points.tie_rod_outer) - ball_joint;
        let rod = at(points.tie_rod_outer) - inner;
        let (foot_tie, strut_tie) = (foot.cross(tie), u.cross(tie));
        let carried = |x: Vector3<T>| Carried {
            by_m: x.dot(foot),
            by_u: x.dot(u),
            by_t: x.dot(tie),
            by_mt: x.dot(foot_tie),
            by_ut: x.dot(strut_tie),
        };
        let orientation = tie.dot(to_top.cross(inner - ball_joint)).value();
        let like = along;
        StrutForm {
            circle_centre,
            radius,
            radius_turned: axis.cross(radius),
            top,
            tie_rod_inner: inner,
            foot_squared: foot.norm_squared(),
            tie_squared: tie.norm_squared(),
            tie_by_foot: tie.dot(foot),
            tie_by_strut: tie.dot(u),
            tie_difference: (tie.norm_squared() - rod.norm_squared()).scaled(0.5),
            side: like.lit(if orientation < 0.0 { -1.0 } else { 1.0 }),
            wheel_centre: carried(at(points.wheel_centre) - ball_joint),
            basis: Matrix3::identity(like).columns.map(carried),
            wheel_height: at(points.wheel_centre).z,
        }
    }

    /// The mechanism at an arm angle given by cosine and sine, the rack displaced by `rack`. Where the
    /// mechanism cannot be assembled the state holds NaN.
    #[inline]
    pub(super) fn at(&self, cosine: T, sine: T, rack: T) -> StrutState<T> {
        let ball_joint = self.circle_centre + self.radius * cosine + self.radius_turned * sine;
        let d = self.top - ball_joint;
        let mut g = self.tie_rod_inner - ball_joint;
        g.y = g.y + rack;
        let n = d.cross(g);
        let (dd, gg, dg) = (d.norm_squared(), g.norm_squared(), d.dot(g));
        let strut_length = (dd - self.foot_squared).sqrt();
        let tau = self.tie_by_foot + self.tie_by_strut * strut_length;
        let kappa = self.tie_difference + gg.scaled(0.5);
        let gram = dd * gg - dg * dg;
        let e = dd * self.tie_squared - tau * tau;
        let inverse = dd.one() / (gram * e);
        let (inverse_gram, inverse_e) = (inverse * e, inverse * gram);
        let al = (gg * tau - dg * kappa) * inverse_gram;
        let be = (dd * kappa - dg * tau) * inverse_gram;
        let rest = self.tie_squared - al * tau - be * kappa;
        StrutState {
            ball_joint,
            d,
            g,
            n,
            dd,
            dg,
            strut_length,
            tau,
            al,
            be,
            ga: self.side * (rest * inverse_gram).sqrt(),
            tie_squared: self.tie_squared,
            inverse_e,
            toggle_margin: rest / self.tie_squared,
        }
    }

    /// As [`StrutForm::at`], the angle given by the tangent of its half: no trigonometry is needed.
    #[inline]
    pub(super) fn at_half_tangent(&self, tangent: T, rack: T) -> StrutState<T> {
        let inverse = tangent.one() / (tangent.one() + tangent.squared());
        let cosine = inverse + inverse - tangent.one();
        self.at(cosine, (tangent + tangent) * inverse, rack)
    }

    /// Height of the wheel centre above its design position.
    #[inline]
    pub(super) fn travel(&self, state: &StrutState<T>) -> T {
        let (by_d, by_g, by_n) = state.image(&self.wheel_centre);
        let rise = by_d * state.d.z + by_g * state.g.z + by_n * state.n.z;
        state.ball_joint.z - self.wheel_height + rise
    }

    /// The pose of the knuckle.
    #[inline]
    pub(super) fn pose(&self, state: &StrutState<T>) -> Pose<T> {
        Pose {
            origin: state.ball_joint,
            rotation: Matrix3 {
                columns: from_fn(|k| {
                    let (by_d, by_g, by_n) = state.image(&self.basis[k]);
                    state.d * by_d + state.g * by_g + state.n * by_n
                }),
            },
        }
    }
}

impl<T: Real> StrutForm<T> {
    /// The same design with the strut mounted the other way up (the mount below the foot), the tie rod's
    /// end on the other side of its plane, or both: the other assemblies of the same lengths.
    pub(super) fn assembled(&self, strut_inverted: bool, tie_rod_across: bool) -> Self {
        let mut form = *self;
        if strut_inverted {
            form.tie_by_strut = -form.tie_by_strut;
            for vector in form.basis.iter_mut().chain([&mut form.wheel_centre]) {
                vector.by_u = -vector.by_u;
                vector.by_ut = -vector.by_ut;
            }
        }
        if tie_rod_across {
            form.side = -form.side;
        }
        form
    }

    /// Squares that are negative where the mechanism cannot be assembled: of the strut's length, and of
    /// the tie-rod end's distance from its plane.
    pub(super) fn squares(&self, state: &StrutState<T>) -> [T; 2] {
        [state.dd - self.foot_squared, state.toggle_margin]
    }
}

impl StrutForm<f64> {
    /// Tangent of half the arm angle of a pose.
    pub(super) fn half_tangent(&self, pose: &Pose<f64>) -> f64 {
        let from_centre = pose.origin - self.circle_centre;
        let squared = self.radius.norm_squared();
        let cosine = from_centre.dot(self.radius) / squared;
        let sine = from_centre.dot(self.radius_turned) / squared;
        sine / (1.0 + cosine)
    }
}

impl StrutState<f64> {
    /// Moves the tie rod's end into its plane where it has no real place: for a state at a toggle but
    /// for rounding.
    pub(super) fn at_toggle_if_beyond(&mut self) {
        if self.ga.is_nan() {
            self.ga = 0.0;
        }
    }

    /// Whether the closed form loses no more than four digits here: the squared sines between steering
    /// arm and steering plane, and between steering axis and rack joint, are what it divides by.
    #[inline]
    pub(super) fn is_ordinary(&self) -> bool {
        let gram = self.n.norm_squared();
        self.toggle_margin > 1e-4 && gram > 1e-4 * self.dd * self.g.norm_squared()
    }
}

impl<T: Real> StrutState<T> {
    /// What may not vanish on a path: distance from the tie rod's toggle, and the strut's length.
    #[inline]
    pub(super) fn margins(&self) -> [T; 2] {
        [self.toggle_margin, self.strut_length]
    }

    /// The image of a knuckle vector, in d, g and n.
    #[inline]
    fn image(&self, x: &Carried<T>) -> (T, T, T) {
        let by_v = x.by_m + self.strut_length * x.by_u;
        let a = (self.tie_squared * by_v - self.tau * x.by_t) * self.inverse_e;
        let b = (self.dd * x.by_t - self.tau * by_v) * self.inverse_e;
        let k = (x.by_mt + self.strut_length * x.by_ut) * self.inverse_e;
        // d x t = be n + ga d x n, and d x n = (d.g) d - (d.d) g.
        (
            a + b * self.al + k * self.ga * self.dg,
            b * self.be - k * self.ga * self.dd,
            b * self.ga + k * self.be,
        )
    }
}
