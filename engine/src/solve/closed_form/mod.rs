//! Strut and double wishbone in closed form: the pose of the knuckle from the angle of the lower arm.
//!
//! All vectors start at the lower ball joint; subscript 0 is the design position.
//!
//! ```text
//! r(th)  = c + rv cos th + rw sin th     the ball joint on its circle about the arm's axis
//! d, g, n = d x g                        to the upper end of the steering axis, to the tie rod's inner end
//! ```
//!
//! *Upper end.* [`Upper`] gives d and the knuckle vector v, whose image is d. The only remaining freedom is a rotation about
//! d, the steering axis.
//!
//! *Tie rod.* Its outer end t satisfies t.d = t0.v, t.t = t0.t0 and |t - g| = L. So t = al d + be g + ga n, with al, be from
//! the 2x2 Gram system and ga^2 |n|^2 = t.t - al t.d - be t.g. The sign of ga gives the side of the plane through steering
//! axis and rack joint on which the rod's outer end lies. The sign changes only at ga = 0 (toggle).
//!
//! *Any knuckle vector* x0. The rotation takes v to d and t0 to t, so the image of x0 is x = a d + b t + k (d x t). a and b
//! follow from x0.v and x0.t0, and k follows from x0.(v x t0).
//!
//! Each of the following numbers is zero in certain singular poses:
//!
//! - G = |n|^2: the tie rod does not steer,
//! - E = |d x t|^2: the tie rod's outer end is on the steering axis,
//! - ga: the tie rod is at its toggle,
//! - the margin of the upper end.

mod adjoint;
mod carried;
mod circle;
mod conditioning;
mod roles;
mod series;
#[cfg(test)]
mod tests;
mod upper;
mod velocity;

use crate::mechanism::DesignFault;
use crate::mechanism::Pose;
use crate::model::Mechanism;
use crate::number::Jet;
use crate::number::{Matrix3, Vector3};
use crate::number::{Real, SimdReal};
pub(crate) use adjoint::{Adjoint, Members};
pub(crate) use carried::{Carried, Carrier};
pub(crate) use circle::Circle;
pub use roles::Roles;
pub(crate) use roles::UpperRoles;
use upper::Upper;

/// Constants of the closed form for one design. The symbols are explained at the head of this module and of module `upper`.
#[derive(Clone, Copy, Debug)]
pub struct ClosedForm<T> {
    ball_joint: Circle<T>,
    upper: Upper<T>,
    tie_rod_inner: Vector3<T>,
    tie_squared: T,
    tie_by_m: T,
    tie_by_u: T,
    /// Number (t0.t0 - L^2)/2, with the tie rod's length L and the vector t0 to its outer end.
    tie_difference: T,
    /// Sign of ga in the design, +1 or -1: the side of the tie rod's outer end. It identifies the assembly.
    side: T,
    wheel_centre: Carried<T>,
    /// Unit vector u along the strut line in the knuckle.
    line: Carried<T>,
    basis: [Carried<T>; 3],
    /// Design height of the wheel centre.
    wheel_height: T,
}

/// State of the mechanism at one angle of the lower arm. The heads of this module and of module `upper` explain the
/// symbols.
#[derive(Clone, Copy, Debug)]
pub struct ArmState<T> {
    ball_joint: Vector3<T>,
    d: Vector3<T>,
    g: Vector3<T>,
    n: Vector3<T>,
    dd: T,
    gg: T,
    dg: T,
    /// Number s of the knuckle vector v = m + s u: the length of the strut above the foot. 0 for an upper arm.
    slide: T,
    tau: T,
    al: T,
    be: T,
    ga: T,
    tie_squared: T,
    /// Number G = |n|^2. It is zero if the tie rod does not steer.
    gram: T,
    /// Number E = |d x t|^2. It is zero if the tie rod's outer end is on the steering axis.
    e: T,
    inverse_e: T,
    /// Product ga^2 G. It is zero if the tie rod is at its toggle.
    toggle_square: T,
    upper_margin: T,
}

impl ClosedForm<f64> {
    /// The constants of a design, if its mechanism has a closed form and the design is not degenerate.
    pub(crate) fn of(
        mechanism: &Mechanism,
        design: &[Vector3<f64>],
    ) -> Result<Option<Self>, DesignFault> {
        let Some(roles) = Roles::of(mechanism) else {
            return Ok(None);
        };
        let form = ClosedForm::new(&roles, design);
        form.check(&roles, design)?;
        Ok(Some(form))
    }

    /// Tangent of half the arm's angle in a pose.
    pub(crate) fn half_tangent(&self, pose: &Pose<f64>) -> f64 {
        self.ball_joint.half_tangent(pose.origin)
    }
}

impl<T: Real> ClosedForm<T> {
    /// Makes the constants of the closed form for a design.
    #[inline(always)]
    pub fn new(roles: &Roles, design: &[Vector3<T>]) -> Self {
        ClosedForm::with_carrier(roles, design).0
    }

    /// Makes the constants of a design, and the [`Carrier`] for further vectors of the knuckle.
    #[inline(always)]
    pub(crate) fn with_carrier(roles: &Roles, design: &[Vector3<T>]) -> (Self, Carrier<T>) {
        let ball_joint = design[roles.lower_arm.outer.0];
        let (upper, to_upper) = Upper::new(roles, design);
        let (m, u) = upper.knuckle_vector(to_upper);
        let inner = design[roles.tie_rod_inner.0];
        let tie = design[roles.tie_rod_outer.0] - ball_joint;
        let rod = design[roles.tie_rod_outer.0] - inner;
        let carrier = Carrier {
            m,
            u,
            tie,
            foot_tie: m.cross(tie),
            slide_tie: u.cross(tie),
        };
        let [x, y, z] = Matrix3::identity(tie.x).columns;
        let orientation = tie.dot(to_upper.cross(inner - ball_joint));
        let form = ClosedForm {
            ball_joint: Circle::of(roles.lower_arm, design),
            upper,
            tie_rod_inner: inner,
            tie_squared: tie.norm_squared(),
            tie_by_m: tie.dot(m),
            tie_by_u: tie.dot(u),
            tie_difference: (tie.norm_squared() - rod.norm_squared()).scaled(0.5),
            side: orientation.sign(),
            wheel_centre: carrier.carried(design[roles.wheel_centre.0] - ball_joint),
            line: carrier.carried(u),
            basis: [carrier.carried(x), carrier.carried(y), carrier.carried(z)],
            wheel_height: design[roles.wheel_centre.0].z,
        };
        (form, carrier)
    }

    /// Converts the constants to another number type.
    #[inline]
    pub fn map<U: Copy>(&self, f: impl Fn(T) -> U + Copy) -> ClosedForm<U> {
        let [x, y, z] = &self.basis;
        ClosedForm {
            ball_joint: self.ball_joint.map(f),
            upper: self.upper.map(f),
            tie_rod_inner: self.tie_rod_inner.map(f),
            tie_squared: f(self.tie_squared),
            tie_by_m: f(self.tie_by_m),
            tie_by_u: f(self.tie_by_u),
            tie_difference: f(self.tie_difference),
            side: f(self.side),
            wheel_centre: self.wheel_centre.map(f),
            line: self.line.map(f),
            basis: [x.map(f), y.map(f), z.map(f)],
            wheel_height: f(self.wheel_height),
        }
    }

    /// State at an arm angle given by cosine and sine, with the rack displaced by `rack`. If the mechanism cannot be
    /// assembled there, the state contains NaN.
    #[inline(always)]
    pub(crate) fn at(&self, cosine: T, sine: T, rack: T) -> ArmState<T> {
        self.at_knowing(cosine, sine, rack, None)
    }

    /// State as in [`ClosedForm::at`], with a more accurate value of [`ClosedForm::upper_square`] than the angle gives.
    #[inline(always)]
    pub(crate) fn at_knowing(&self, cosine: T, sine: T, rack: T, square: Option<T>) -> ArmState<T> {
        let ball_joint = self.ball_joint.at(cosine, sine);
        let (d, slide, upper_margin) = self.upper.at(ball_joint, square);
        let mut g = self.tie_rod_inner - ball_joint;
        g.y = g.y + rack;
        let n = d.cross(g);
        let dd = self.upper.length_squared(d);
        let (gg, dg) = (g.norm_squared(), d.dot(g));
        let tau = self.tie_by_m.plus_product(self.tie_by_u, slide);
        let kappa = self.tie_difference.plus_product(gg, gg.constant(0.5));
        let gram = (dd * gg).minus_product(dg, dg);
        let e = (dd * self.tie_squared).minus_product(tau, tau);
        let [inverse_gram, inverse_e] = gram.inverses(e);
        let al = (gg * tau).minus_product(dg, kappa) * inverse_gram;
        let be = (dd * kappa).minus_product(dg, tau) * inverse_gram;
        let rest = self
            .tie_squared
            .minus_product(al, tau)
            .minus_product(be, kappa);
        ArmState {
            ball_joint,
            d,
            g,
            n,
            dd,
            gg,
            dg,
            slide,
            tau,
            al,
            be,
            ga: self.side * (rest * inverse_gram).sqrt(),
            tie_squared: self.tie_squared,
            gram,
            e,
            inverse_e,
            toggle_square: rest,
            upper_margin,
        }
    }

    /// State as in [`ClosedForm::at`], for an angle given by the tangent of its half. The calculation needs no
    /// trigonometric functions.
    #[inline(always)]
    pub fn at_half_tangent(&self, tangent: T, rack: T) -> ArmState<T> {
        let inverse = tangent.one() / (tangent.one() + tangent.squared());
        let cosine = inverse + inverse - tangent.one();
        self.at(cosine, (tangent + tangent) * inverse, rack)
    }

    /// Returns one of the constants. The caller uses it to make other constants of the same number type.
    #[inline(always)]
    pub(crate) fn like(&self) -> T {
        self.wheel_height
    }

    /// Height of the wheel centre above its design position.
    #[inline(always)]
    pub fn travel(&self, state: &ArmState<T>) -> T {
        let (by_d, by_g, by_n) = state.image(&self.wheel_centre);
        let rise = (by_d * state.d.z)
            .plus_product(by_g, state.g.z)
            .plus_product(by_n, state.n.z);
        state.ball_joint.z - self.wheel_height + rise
    }

    /// Pose of the knuckle. Two columns of the rotation are rotated knuckle vectors. The third column is their cross
    /// product.
    #[inline(always)]
    pub(crate) fn pose_by_two(&self, state: &ArmState<T>) -> Pose<T> {
        let (x, y) = (state.carry(&self.basis[0]), state.carry(&self.basis[1]));
        Pose {
            origin: state.ball_joint,
            rotation: Matrix3 {
                columns: [x, y, x.cross(y)],
            },
        }
    }

    /// Pose of the knuckle.
    #[inline]
    pub fn pose(&self, state: &ArmState<T>) -> Pose<T> {
        Pose {
            origin: state.ball_joint,
            rotation: Matrix3 {
                columns: [
                    state.carry(&self.basis[0]),
                    state.carry(&self.basis[1]),
                    state.carry(&self.basis[2]),
                ],
            },
        }
    }
}

impl<T: Real> ClosedForm<T> {
    /// Constants of another assembly with the same lengths. `upper_across` mirrors the upper end: the mount of a strut is
    /// then below the foot, and the root w of an upper arm changes sign. `tie_rod_across` puts the tie rod's outer end on
    /// the other side of the plane through steering axis and rack joint.
    pub(crate) fn assembled(&self, upper_across: bool, tie_rod_across: bool) -> Self {
        let mut form = *self;
        if let (Upper::Arm { side, .. }, true) = (&mut form.upper, upper_across) {
            *side = -*side;
        } else if upper_across {
            form.tie_by_u = -form.tie_by_u;
            let vectors = [&mut form.wheel_centre, &mut form.line];
            for vector in form.basis.iter_mut().chain(vectors) {
                vector.by_u = -vector.by_u;
                vector.by_ut = -vector.by_ut;
            }
        }
        if tie_rod_across {
            form.side = -form.side;
        }
        form
    }

    /// Replaces ga^2 G in a state by a more accurate value. This number is zero at the toggle of the tie rod.
    pub(crate) fn with_toggle_square(&self, state: ArmState<T>, square: T) -> ArmState<T> {
        ArmState {
            ga: self.side * (square / state.gram).sqrt(),
            toggle_square: square,
            ..state
        }
    }

    /// Returns the number under the square root in the position of the upper end, at the arm angle with this cosine and sine.
    /// The number is negative if the mechanism cannot be assembled.
    pub(crate) fn upper_square(&self, cosine: T, sine: T) -> T {
        self.upper.square(self.ball_joint.at(cosine, sine))
    }
}

impl ArmState<f64> {
    /// Moves the tie rod's outer end to the toggle (ga = 0) if rounding has left this end without a real position.
    pub(crate) fn at_toggle_if_beyond(&mut self) {
        if self.ga.is_nan() {
            self.ga = 0.0;
        }
    }
}

/// Smallest squared sine that may be a divisor in the closed form.
const LEAST: f64 = 0.0625;
/// Smallest permitted margin of the upper end, see [`ArmState::upper_margin`]. For an upper arm, the margin is a sine.
const LEAST_UPPER: f64 = 0.25;

impl<B: SimdReal> ArmState<B> {
    /// SIMD lanes in which the closed form is well conditioned, because no divisor is small. NaN counts as ill conditioned.
    #[inline(always)]
    pub(crate) fn is_well_conditioned(&self) -> B::Mask {
        let least = self.ga.constant(LEAST);
        let [a, b, c] = self.squares();
        (a.1 * least).less(a.0)
            & (b.1 * least).less(b.0)
            & (c.1 * least).less(c.0)
            & self.ga.constant(LEAST_UPPER).less(self.upper_margin)
    }
}

impl<const N: usize> ArmState<Jet<f64, N>> {
    /// The state without its derivatives.
    #[inline]
    pub(crate) fn now(&self) -> ArmState<f64> {
        let vector = |v: Vector3<Jet<f64, N>>| v.map(|c| c[0]);
        ArmState {
            ball_joint: vector(self.ball_joint),
            d: vector(self.d),
            g: vector(self.g),
            n: vector(self.n),
            dd: self.dd[0],
            gg: self.gg[0],
            dg: self.dg[0],
            slide: self.slide[0],
            tau: self.tau[0],
            al: self.al[0],
            be: self.be[0],
            ga: self.ga[0],
            tie_squared: self.tie_squared[0],
            inverse_e: self.inverse_e[0],
            toggle_square: self.toggle_square[0],
            gram: self.gram[0],
            e: self.e[0],
            upper_margin: self.upper_margin[0],
        }
    }
}

impl<T: Real> ArmState<T> {
    /// Squares by which the closed form divides, or of which it takes the root. Each square has a second number. The square
    /// divided by this number is the squared sine of an angle. First angle: between the steering arm and the plane through
    /// steering axis and rack joint. Second angle: between the rack joint and the steering axis. Third angle: between the
    /// steering arm and the steering axis.
    #[inline(always)]
    pub(crate) fn squares(&self) -> [(T, T); 3] {
        [
            (self.toggle_square, self.tie_squared),
            (self.gram, self.dd * self.gg),
            (self.e, self.dd * self.tie_squared),
        ]
    }

    /// Product ga^2 G. It is zero if the tie rod is at its toggle.
    pub(crate) fn toggle_square(&self) -> T {
        self.toggle_square
    }

    /// Margin of the upper end, which is zero at its limit. For a strut, the margin is the length from the foot of the ball
    /// joint's perpendicular to the mount, divided by the design distance from ball joint to mount. For an upper arm, it is the
    /// sine of the angle between the steering axis and the plane through the arm's axis and the upper ball joint.
    #[inline(always)]
    pub(crate) fn upper_margin(&self) -> T {
        self.upper_margin
    }

    /// Lower end of the steering axis.
    #[inline(always)]
    pub(crate) fn ball_joint(&self) -> Vector3<T> {
        self.ball_joint
    }

    /// Vector from the lower to the upper end of the steering axis.
    #[inline(always)]
    pub(crate) fn steering_axis(&self) -> Vector3<T> {
        self.d
    }

    /// Vector t from the lower ball joint to the tie rod's outer end.
    #[inline(always)]
    fn tie_rod_outer(&self) -> Vector3<T> {
        (self.d * self.al)
            .plus_scaled(self.g, self.be)
            .plus_scaled(self.n, self.ga)
    }

    /// Rotates a knuckle vector from the design position to this state.
    #[inline(always)]
    pub(crate) fn carry(&self, x: &Carried<T>) -> Vector3<T> {
        let (by_d, by_g, by_n) = self.image(x);
        (self.d * by_d)
            .plus_scaled(self.g, by_g)
            .plus_scaled(self.n, by_n)
    }

    /// Rotates a knuckle vector from the design position to this state. Returns components along d, g and n.
    #[inline(always)]
    fn image(&self, x: &Carried<T>) -> (T, T, T) {
        let by_v = x.by_m.plus_product(self.slide, x.by_u);
        let a = (self.tie_squared * by_v).minus_product(self.tau, x.by_t) * self.inverse_e;
        let b = (self.dd * x.by_t).minus_product(self.tau, by_v) * self.inverse_e;
        let k = x.by_mt.plus_product(self.slide, x.by_ut) * self.inverse_e;
        // d x t = be n + ga d x n, and d x n = (d.g) d - (d.d) g.
        (
            a.plus_product(b, self.al)
                .plus_product(k * self.ga, self.dg),
            (b * self.be).minus_product(k * self.ga, self.dd),
            (b * self.ga).plus_product(k, self.be),
        )
    }
}
