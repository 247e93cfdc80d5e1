//! Bushing between two bodies.
//!
//! A bushing connects body i, which holds the bushing's axes A (rows), to body j, which moves in the frame of body i. The
//! bushing's points on the bodies are p_i and p_j, and R_i and R_j are the rotations of the bodies. A' is the transpose
//! of A. With e = p_j - p_i, the deflection d and the rotation vector phi along the bushing's axes are
//!
//! ```text
//! d = A R_i' e,   phi = A log(R_i' R_j)                                                           (1)
//! ```
//!
//! The laws give the forces f(d) and the torques g(phi) along and about the axes of the bushing. Their energy E changes
//! by
//!
//! ```text
//! dE = F.(dp_j - dp_i - w_i x e) + M.(w_j - w_i),   F = B f,   M = B h,   B = R_i A'              (2)
//! h = J^-T g = g + phi x g/2 + c phi x (phi x g)                                                  (3)
//! c = 1/t^2 - (1 + cos t)/(2 t sin t),   t = |phi|                                                (4)
//! ```
//!
//! for small rotations w_i and w_j. The force F and the torque M act on body i, at p_j. They change by
//!
//! ```text
//! dF = w_i x F + B K B' (dp_j - dp_i - w_i x e),   dM = w_i x M + B N B' (w_j - w_i)              (5)
//! N = (dh/dphi) J^-1,   J^-1 v = v - phi x v/2 + c phi x (phi x v)                                (6)
//! ```

use super::algebra::Logarithm;
use super::law::Law;
use crate::number::{Matrix3, Outlined, SimdReal, Valued, Vector3, outlined};

/// If the square of the bushing's rotation angle t is below this limit, power series compute c of equation (4) of this
/// module and its derivative.
const SMALL_ANGLE_SQUARED: f64 = 0.25;
/// Coefficients |B_2k|/(2k)! (Bernoulli numbers B) of the powers of t^2 in c of equation (4) of this module, from the
/// highest power.
const SERIES: [f64; 7] = [
    1.0 / 74_724_249_600.0,
    691.0 / 1_307_674_368_000.0,
    1.0 / 47_900_160.0,
    1.0 / 1_209_600.0,
    1.0 / 30_240.0,
    1.0 / 720.0,
    1.0 / 12.0,
];

/// Bushing in the design position, between body i and body j.
#[derive(Clone, Debug)]
pub(super) struct Bushing<T> {
    /// Axes of the bushing as columns, A'.
    pub(super) axes: Matrix3<T>,
    /// Laws along and about the bushing's axes.
    pub(super) laws: [Law<T>; 6],
}

/// Deflection and force of a bushing, in its axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct BushingState<T> {
    pub(super) deflection: Vector3<T>,
    pub(super) rotation: Vector3<T>,
    /// Force f on body i (see equation (2) of this module). Body j receives the opposite force.
    pub(super) force: Vector3<T>,
    /// Torque h on body i, by equation (3) of this module. Body j receives the opposite torque.
    pub(super) torque: Vector3<T>,
}

/// Force F and torque M of equation (2), with their tangents B K B' and B N B' of equation (5) of this module.
#[derive(Clone, Copy, Debug)]
pub(super) struct BushingForce<T> {
    pub(super) force: Vector3<T>,
    pub(super) moment: Vector3<T>,
    pub(super) by_shift: Matrix3<T>,
    pub(super) by_turn: Matrix3<T>,
}

/// Coefficient c of equation (4) of this module, and its derivative with respect to the angle t, divided by t.
#[inline(always)]
fn coefficient<T: Valued>(rotation: &Logarithm<T>) -> (T, T) {
    let square = rotation.vector.norm_squared();
    let is_small = square.is_below(SMALL_ANGLE_SQUARED);
    if T::Plain::all(is_small) {
        return small_coefficient(square);
    }
    let large = square.outlined(LargeCoefficient(*rotation));
    if T::Plain::any(is_small) {
        let small = small_coefficient(square);
        return (
            T::choose(is_small, small.0, large.0),
            T::choose(is_small, small.1, large.1),
        );
    }
    large
}

/// Power series of the coefficient c of equation (4) of this module, and of its derivative. The argument is t^2.
#[inline(always)]
fn small_coefficient<T: Valued>(square: T) -> (T, T) {
    let (mut value, mut slope) = (square.constant(SERIES[0]), square.zero());
    for coefficient in &SERIES[1..] {
        slope = slope * square + value;
        value = value * square + square.constant(*coefficient);
    }
    (value, slope + slope)
}

/// Coefficient c of equation (4) of this module for a large angle. Few angles are large, so this code is compiled as a
/// separate function.
struct LargeCoefficient<T>(Logarithm<T>);

impl<T: Valued> Outlined for LargeCoefficient<T> {
    type Output = (T, T);
    #[inline(always)]
    fn work(self) -> (T, T) {
        let rotation = self.0;
        let square = rotation.vector.norm_squared();
        let one = square.one();
        let inverse = one / square;
        // The next value is cot(t/2)/(2t), because the sine vector and the rotation vector are parallel.
        let sine_by_angle = rotation.sine.dot(rotation.vector);
        let cotangent = (one + rotation.cosine) / (sine_by_angle + sine_by_angle);
        let half = one.constant(0.5);
        let value = inverse - cotangent;
        let slope = (cotangent + half / (one - rotation.cosine) - (inverse + inverse)) * inverse;
        (value, slope)
    }
}

/// Terms from which the matrix N of equation (6) of this module is computed.
struct TorqueTangent<T> {
    phi: Vector3<T>,
    g: Vector3<T>,
    /// The vector phi x g.
    once: Vector3<T>,
    /// The vector phi x (phi x g).
    twice: Vector3<T>,
    rates: Vector3<T>,
    /// The three numbers 1/2, c and (dc/dt)/t.
    coefficients: [T; 3],
}

impl<T: Valued> TorqueTangent<T> {
    /// Returns the column of N for a rotation about the axis `unit`.
    #[inline(always)]
    fn column(&self, unit: Vector3<T>) -> Vector3<T> {
        let TorqueTangent {
            phi,
            g,
            once,
            twice,
            rates,
            coefficients: [half, c, slope],
        } = *self;
        let across = phi.cross(unit);
        let by = unit - across * half + phi.cross(across) * c;
        let dg = Vector3::new(rates.x * by.x, rates.y * by.y, rates.z * by.z);
        let first = by.cross(g) + phi.cross(dg);
        let second = by.cross(once) + phi.cross(first);
        dg + first * half + second * c + twice * (slope * phi.dot(by))
    }
}

impl<T: Valued> Bushing<T> {
    /// Returns deflection and force of the bushing. `e` is the vector e of equation (1) of this module, in the axes of
    /// body i, and `turn` is R_i' R_j - I.
    #[inline(always)]
    pub(super) fn state(&self, e: Vector3<T>, turn: &Matrix3<T>) -> BushingState<T> {
        let rotation = Logarithm::of(turn);
        let (c, _) = coefficient(&rotation);
        let deflection = self.axes.apply_transposed(e);
        let phi = self.axes.apply_transposed(rotation.vector);
        let (force, _) = self.forces(deflection);
        let (g, _) = self.torques(phi);
        let once = phi.cross(g);
        BushingState {
            deflection,
            rotation: phi,
            force,
            torque: g + once * c.constant(0.5) + phi.cross(once) * c,
        }
    }

    #[inline(always)]
    fn forces(&self, d: Vector3<T>) -> (Vector3<T>, Vector3<T>) {
        let [x, y, z] = [
            self.laws[0].at(d.x),
            self.laws[1].at(d.y),
            self.laws[2].at(d.z),
        ];
        (Vector3::new(x.0, y.0, z.0), Vector3::new(x.1, y.1, z.1))
    }

    #[inline(always)]
    fn torques(&self, phi: Vector3<T>) -> (Vector3<T>, Vector3<T>) {
        let [x, y, z] = [
            self.laws[3].at(phi.x),
            self.laws[4].at(phi.y),
            self.laws[5].at(phi.z),
        ];
        (Vector3::new(x.0, y.0, z.0), Vector3::new(x.1, y.1, z.1))
    }

    /// Returns force and torque of the bushing with their tangents. `e` and the results are in the axes in which body i
    /// has the rotation `body` (R_i). `body` is `None` for a body at rest.
    #[inline(always)]
    pub(super) fn force(
        &self,
        e: Vector3<T>,
        turn: &Matrix3<T>,
        body: Option<&Matrix3<T>>,
    ) -> BushingForce<T> {
        outlined!(
            [T: Valued] e.x;
            own: &'p Bushing<T> = self, e: Vector3<T> = e, turn: &'p Matrix3<T> = turn,
            body: Option<&'p Matrix3<T>> = body => BushingForce<T> {
                own.force_inline(e, turn, body)
            }
        )
    }

    #[inline(always)]
    fn force_inline(
        &self,
        e: Vector3<T>,
        turn: &Matrix3<T>,
        body: Option<&Matrix3<T>>,
    ) -> BushingForce<T> {
        let axes = match body {
            None => self.axes,
            Some(rotation) => rotation.times(&self.axes),
        };
        let rotation = Logarithm::of(turn);
        let (c, slope) = coefficient(&rotation);
        let phi = self.axes.apply_transposed(rotation.vector);
        let (force, rate) = self.forces(axes.apply_transposed(e));
        let mut by_shift = Matrix3::null(c);
        let [x, y, z] = axes.columns;
        by_shift.add_product(x, x, rate.x);
        by_shift.add_product(y, y, rate.y);
        by_shift.add_product(z, z, rate.z);
        let (g, rates) = self.torques(phi);
        let (once, half) = (phi.cross(g), c.constant(0.5));
        let twice = phi.cross(once);
        // Columns of N in equation (6) of this module, one for each rotation about an axis of the bushing.
        let one = c.one();
        let zero = c.zero();
        let tangent = TorqueTangent {
            phi,
            g,
            once,
            twice,
            rates,
            coefficients: [half, c, slope],
        };
        let local = Matrix3 {
            columns: [
                tangent.column(Vector3::new(one, zero, zero)),
                tangent.column(Vector3::new(zero, one, zero)),
                tangent.column(Vector3::new(zero, zero, one)),
            ],
        };
        BushingForce {
            force: axes.apply(force),
            moment: axes.apply(g + once * half + twice * c),
            by_shift,
            by_turn: axes.times(&local).times(&axes.transposed()),
        }
    }

    /// Stiffness of the bushing against shifts at zero deflection, without forces and without torsional stiffness. The
    /// calculation of the forces at the design load uses it.
    pub(super) fn slack(&self) -> BushingForce<T> {
        let like = self.axes.columns[0].x;
        let nothing = Matrix3::null(like);
        let mut by_shift = nothing;
        for (axis, law) in self.axes.columns.into_iter().zip(&self.laws) {
            by_shift.add_product(axis, axis, law.shape.slope(like));
        }
        BushingForce {
            force: nothing.columns[0],
            moment: nothing.columns[0],
            by_shift,
            by_turn: nothing,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::algebra::Placed;
    use super::super::law::Shape;
    use super::*;
    use crate::number::{Dual, Real, Scalar};

    fn bushing<T: Scalar>(like: T) -> Bushing<T> {
        let unit = Vector3::new(1.0, 2.0, -2.0) * (1.0 / 3.0);
        let next = Vector3::new(2.0, 1.0, 2.0) * (1.0 / 3.0);
        let axes = Matrix3 {
            columns: [unit, next, unit.cross(next)].map(|v| v.map(|c| like.constant(c))),
        };
        let law = |rate: f64, cubic: f64| {
            let shape = Shape::Cubic {
                rate: like.constant(rate),
                cubic: like.constant(cubic),
            };
            Law::new(shape, like.constant(30.0))
        };
        let laws = [
            law(700.0, 60.0),
            law(2500.0, 900.0),
            law(1800.0, 0.0),
            law(8e4, 1e5),
            law(2.5e5, 0.0),
            law(2e5, 0.0),
        ];
        Bushing { axes, laws }
    }

    /// The tangent of the moment equals the derivative of the moment with respect to small rotations. The test uses angles
    /// below and above the limit of the power series. The torques have an energy, so this tangent is symmetric except for a
    /// term with the moment.
    #[test]
    fn tangents_are_derivatives() {
        for angle in [0.0, 0.1, 0.4999, 0.5001, 1.3] {
            let axis = Vector3::new(0.6, -0.48, 0.64);
            let at = |w: Vector3<f64>, v: Vector3<f64>| {
                let w = Dual::<f64, 3>::inputs(w);
                let like = w.x;
                let turn = axis.map(|c| like.constant(2.0 * c * (0.5_f64 * angle).tan()));
                let body = Placed::design(like)
                    .moved(w.zero(), turn)
                    .moved(w.zero(), w);
                let e = v.map(|c| like.constant(c));
                bushing(like).force(e, &body.turn, None)
            };
            let found = at(Vector3::new(0.0, 0.0, 0.0), Vector3::new(0.3, -0.7, 0.9));
            for row in 0..3 {
                for column in 0..3 {
                    let expected = found.moment.to_array()[row].partials[column];
                    let tangent = found.by_turn.entry(row, column).value;
                    assert!(
                        (tangent - expected).abs() < 1e-9 * 3e5,
                        "{angle} {tangent} {expected}"
                    );
                }
            }
            // For rotations about fixed axes, N - N' = -M^.
            let (m, n) = (found.moment.map(|c| c.value), found.by_turn);
            let skew = [
                n.entry(2, 1).value - n.entry(1, 2).value,
                n.entry(0, 2).value - n.entry(2, 0).value,
                n.entry(1, 0).value - n.entry(0, 1).value,
            ];
            for (skew, m) in skew.into_iter().zip(m.to_array()) {
                assert!((skew + m).abs() < 1e-9 * 3e5, "{angle} {skew} {m}");
            }
        }
    }
}
