//! Small matrices, and rotations stored as their difference from the identity.
//!
//! The difference D = R - I of a rotation R from the identity I keeps all digits of a rotation near the identity. Let u
//! be the shift of a body's reference point. A point of the body at the vector l from the reference point then moves by u
//! + D l (1). A small rotation w changes D to
//!
//! ```text
//! D + E + E D,   E = (2 r^ + 2 r^ r^)/(1 + r.r),   r = w/2                                       (2)
//! ```
//!
//! (r^ is the cross-product matrix of r). E is exactly a rotation minus the identity, and equals w^ to first order. So
//! Newton's method converges quadratically with it. The rotation vector follows from the antisymmetric part and the
//! trace of R (R' is the transpose of R),
//!
//! ```text
//! v = (R - R')/2 as a vector, |v| = sin t, cos t = 1 + trace(D)/2, log R = v t/sin t              (3)
//! ```

use crate::mechanism::Pose;
use crate::number::{Dual, Matrix3, Outlined, Real, SimdReal, Valued, Vector3, outlined};

/// A power series computes the ratio of angle and sine if the square of the sine is below this limit. The angle must also be
/// below 90 degrees. The power series is differentiable at 0. Its last term is below 2e-20.
const SMALL_SINE_SQUARED: f64 = 1e-3;

/// Cross products v x e_k with the three unit vectors, as columns.
#[inline(always)]
pub(super) fn cross_matrix<T: Real>(v: Vector3<T>) -> Matrix3<T> {
    let zero = v.x.zero();
    Matrix3 {
        columns: [
            Vector3::new(zero, v.z, -v.y),
            Vector3::new(-v.z, zero, v.x),
            Vector3::new(v.y, -v.x, zero),
        ],
    }
}

/// Arithmetic of general matrices.
impl<T: Real> Matrix3<T> {
    /// Null matrix, with the number type of `like`.
    #[inline(always)]
    pub(super) fn null(like: T) -> Self {
        let zero = like.zero();
        Matrix3 {
            columns: [Vector3::new(zero, zero, zero); 3],
        }
    }

    #[inline(always)]
    pub(super) fn plus(&self, other: &Self) -> Self {
        let ([a, b, c], [d, e, f]) = (self.columns, other.columns);
        Matrix3 {
            columns: [a + d, b + e, c + f],
        }
    }

    #[inline(always)]
    pub(super) fn times(&self, other: &Self) -> Self {
        outlined!(
            small [T: Real] other.columns[0].x; own: &'p Matrix3<T> = self, other: &'p Matrix3<T> = other => Matrix3<T> {
                let [a, b, c] = other.columns;
                Matrix3 {
                    columns: [own.apply(a), own.apply(b), own.apply(c)],
                }
            }
        )
    }

    #[inline(always)]
    pub(super) fn transposed(&self) -> Self {
        let [a, b, c] = self.columns;
        Matrix3 {
            columns: [
                Vector3::new(a.x, b.x, c.x),
                Vector3::new(a.y, b.y, c.y),
                Vector3::new(a.z, b.z, c.z),
            ],
        }
    }

    /// Returns the product M v^ of this matrix M and the cross-product matrix v^ of a vector v.
    #[inline(always)]
    pub(super) fn times_cross(&self, v: Vector3<T>) -> Self {
        self.times(&cross_matrix(v))
    }

    /// Returns the product v^ M of the cross-product matrix v^ of a vector v and this matrix M.
    #[inline(always)]
    pub(super) fn crossed_by(&self, v: Vector3<T>) -> Self {
        let [a, b, c] = self.columns;
        Matrix3 {
            columns: [v.cross(a), v.cross(b), v.cross(c)],
        }
    }

    #[inline(always)]
    pub(super) fn negated(&self) -> Self {
        let [a, b, c] = self.columns;
        Matrix3 {
            columns: [-a, -b, -c],
        }
    }

    /// Adds the outer product a b', multiplied by `factor`.
    #[inline(always)]
    pub(super) fn add_product(&mut self, a: Vector3<T>, b: Vector3<T>, factor: T) {
        let [x, y, z] = (b * factor).to_array();
        let columns = &mut self.columns;
        columns[0] = columns[0].plus_scaled(a, x);
        columns[1] = columns[1].plus_scaled(a, y);
        columns[2] = columns[2].plus_scaled(a, z);
    }

    /// Adds the identity, multiplied by `factor`.
    #[inline(always)]
    pub(super) fn add_identity(&mut self, factor: T) {
        let [x, y, z] = &mut self.columns;
        x.x = x.x + factor;
        y.y = y.y + factor;
        z.z = z.z + factor;
    }

    /// Returns the entry of the matrix in a row and a column.
    #[inline(always)]
    pub(super) fn entry(&self, row: usize, column: usize) -> T {
        self.columns[column].to_array()[row]
    }
}

/// Position of a rigid body, as its difference from the design position.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed<T> {
    /// Displacement of the reference point.
    pub(super) shift: Vector3<T>,
    /// Rotation as D = R - I.
    pub(super) turn: Matrix3<T>,
}

impl<T: Real> Placed<T> {
    /// Returns the design position: no displacement and no rotation.
    #[inline(always)]
    pub(super) fn design(like: T) -> Self {
        let turn = Matrix3::null(like);
        Placed {
            shift: turn.columns[0],
            turn,
        }
    }

    /// Returns the displacement of a point, by equation (1) of this module. `lever` is the vector from the reference
    /// point to this point in the design position.
    #[inline(always)]
    pub(super) fn displacement(&self, lever: Vector3<T>) -> Vector3<T> {
        self.shift + self.turn.apply(lever)
    }

    /// Rotates a vector from its direction in the design position to its present direction.
    #[inline(always)]
    pub(super) fn lever(&self, lever: Vector3<T>) -> Vector3<T> {
        lever + self.turn.apply(lever)
    }

    /// Moves the body by a shift of its reference point and a small rotation.
    #[inline(always)]
    pub(super) fn moved(&self, shift: Vector3<T>, turn: Vector3<T>) -> Self {
        Placed {
            shift: self.shift + shift,
            turn: turned(&self.turn, turn),
        }
    }

    /// Rotation R of the body from the design position.
    #[inline(always)]
    pub(super) fn rotation(&self) -> Matrix3<T> {
        let mut rotation = self.turn;
        rotation.add_identity(rotation.columns[0].x.one());
        rotation
    }

    /// Converts the position of the wheel carrier to the pose of the knuckle. `reference` is the reference point of the
    /// carrier. `origin` is the origin of the knuckle. Both points are given in the design position.
    pub(super) fn as_pose(&self, reference: Vector3<T>, origin: Vector3<T>) -> Pose<T> {
        Pose {
            origin: origin + self.displacement(origin - reference),
            rotation: self.rotation(),
        }
    }

    /// Converts the position to another number type.
    #[inline(always)]
    pub(super) fn map<U: Copy>(&self, f: impl Fn(T) -> U + Copy) -> Placed<U> {
        Placed {
            shift: self.shift.map(f),
            turn: self.turn.map(f),
        }
    }
}

/// Adds a small rotation `turn` to the rotation R = D + I, by equation (2) of this module.
#[inline(always)]
fn turned<T: Real>(difference: &Matrix3<T>, turn: Vector3<T>) -> Matrix3<T> {
    outlined!(
        small [T: Real] turn.x; difference: &'p Matrix3<T> = difference, turn: Vector3<T> = turn => Matrix3<T> {
            turned_inline(difference, turn)
        }
    )
}

#[inline(always)]
fn turned_inline<T: Real>(difference: &Matrix3<T>, turn: Vector3<T>) -> Matrix3<T> {
    let half = turn * turn.x.constant(0.5);
    let one = turn.x.one();
    let factor = (one + one) / (one + half.norm_squared());
    let units = Matrix3::identity(one).columns;
    let mut columns = difference.columns;
    for k in 0..3 {
        let across = half.cross(columns[k] + units[k]);
        columns[k] = columns[k] + (across + half.cross(across)) * factor;
    }
    Matrix3 { columns }
}

/// Sine, cosine and rotation vector of a rotation R, computed from D = R - I by equation (3) of this module.
#[derive(Clone, Copy, Debug)]
pub(super) struct Logarithm<T> {
    pub(super) vector: Vector3<T>,
    pub(super) sine: Vector3<T>,
    pub(super) cosine: T,
}

impl<T: Valued> Logarithm<T> {
    #[inline(always)]
    pub(super) fn of(difference: &Matrix3<T>) -> Self {
        let [a, b, c] = difference.columns;
        let half = a.x.constant(0.5);
        let sine = Vector3::new(b.z - c.y, c.x - a.z, a.y - b.x) * half;
        let cosine = half.one() + (a.x + b.y + c.z) * half;
        Logarithm {
            vector: sine * angle_by_sine(sine.norm_squared(), cosine),
            sine,
            cosine,
        }
    }
}

/// Returns the ratio t/sin t of an angle t. The arguments are the square of sin t, and cos t.
#[inline(always)]
pub(super) fn angle_by_sine<T: Valued>(squared: T, cosine: T) -> T {
    let is_small = squared.is_below(SMALL_SINE_SQUARED) & cosine.is_above(0.0);
    if T::Plain::all(is_small) {
        return angle_by_small_sine(squared);
    }
    let ratio = squared.outlined(AngleBySine { squared, cosine });
    if T::Plain::any(is_small) {
        return T::choose(is_small, angle_by_small_sine(squared), ratio);
    }
    ratio
}

/// Power series of asin(s)/s for a small sine s. The argument is the square of s.
#[inline(always)]
fn angle_by_small_sine<T: Valued>(squared: T) -> T {
    let coefficients = [
        63.0 / 2816.0,
        35.0 / 1152.0,
        5.0 / 112.0,
        3.0 / 40.0,
        1.0 / 6.0,
    ];
    let mut sum = squared.constant(231.0 / 13312.0);
    for coefficient in coefficients {
        sum = sum * squared + squared.constant(coefficient);
    }
    sum * squared + squared.one()
}

/// Ratio t/sin t of an angle between 0 and 180 degrees. Few angles need this code, so it is compiled as a separate function.
struct AngleBySine<T> {
    squared: T,
    cosine: T,
}

impl<T: Valued> Outlined for AngleBySine<T> {
    type Output = T;
    #[inline(always)]
    fn work(self) -> T {
        let sine = self.squared.sqrt();
        sine.atan2(self.cosine) / sine
    }
}

/// Value, gradient and second derivatives of a function of `N` numbers.
#[inline(always)]
pub(super) fn second_order<T: Real, const N: usize>(
    at: [T; N],
    f: impl Fn([Dual<Dual<T, N>, N>; N]) -> Dual<Dual<T, N>, N>,
) -> (T, [T; N], [[T; N]; N]) {
    let mut inputs = [Dual::constant(Dual::constant(at[0])); N];
    for k in 0..N {
        inputs[k] = Dual::input(Dual::input(at[k], k), k);
    }
    let found = f(inputs);
    let mut second = [[at[0]; N]; N];
    for (row, partial) in second.iter_mut().zip(&found.partials) {
        *row = partial.partials;
    }
    (found.value.value, found.value.partials, second)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If two equal rotations about one axis are combined, the logarithm returns this axis times the sum of the angles.
    #[test]
    fn the_logarithm_inverts_turns() {
        for angle in [1e-9, 1e-3, 0.031, 0.032, 0.4, 1.9, 3.0] {
            let axis = Vector3::new(2.0, -1.0, 2.0) * (1.0 / 3.0);
            // Two equal rotations, each with this Cayley vector, give a rotation by the angle.
            let step = axis * (2.0 * (angle / 4.0_f64).tan());
            let body = Placed::design(0.0)
                .moved(axis.zero(), step)
                .moved(axis.zero(), step);
            let found = Logarithm::of(&body.turn).vector;
            let error = (found - axis * angle).norm();
            assert!(
                error < 8.0 * f64::EPSILON * angle.max(1.0) / (1.0 + angle.cos()).min(1.0),
                "{angle}: {error:e}"
            );
        }
    }
}
