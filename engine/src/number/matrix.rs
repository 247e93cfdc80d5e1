//! Matrices and rotations over any [`Real`].

use super::{Real, Vector3, outlined};

/// A 3x3 matrix, stored by columns. Nearly all matrices are rotations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Matrix3<T> {
    /// Images of the three unit vectors.
    pub columns: [Vector3<T>; 3],
}

impl<T: Real> Matrix3<T> {
    /// Identity, with the number type of `like`.
    #[inline(always)]
    pub fn identity(like: T) -> Self {
        let (zero, one) = (like.zero(), like.one());
        Matrix3 {
            columns: [
                Vector3::new(one, zero, zero),
                Vector3::new(zero, one, zero),
                Vector3::new(zero, zero, one),
            ],
        }
    }

    /// Rotation with the Rodrigues vector `rodrigues` = tan(angle/2) times the axis.
    #[inline(always)]
    pub fn by_rodrigues(rodrigues: Vector3<T>) -> Self {
        let Vector3 { x, y, z } = rodrigues;
        let one = x.one();
        let factor = (one + one) / (one + rodrigues.norm_squared());
        let (p, q, r) = (x * factor, y * factor, z * factor);
        let (xx, yy, zz) = (x * p, y * q, z * r);
        Matrix3 {
            columns: [
                Vector3::new(
                    one - (yy + zz),
                    r.plus_product(x, q),
                    (-q).plus_product(x, r),
                ),
                Vector3::new(
                    (-r).plus_product(x, q),
                    one - (zz + xx),
                    p.plus_product(y, r),
                ),
                Vector3::new(
                    q.plus_product(x, r),
                    (-p).plus_product(y, r),
                    one - (xx + yy),
                ),
            ],
        }
    }

    /// Product of the matrix and a column vector.
    #[inline(always)]
    pub fn apply(&self, v: Vector3<T>) -> Vector3<T> {
        if Vector3::<T>::IN_PIECES {
            outlined!(
                small [T: Real] v.x; m: &'p Matrix3<T> = self, v: Vector3<T> = v => Vector3<T> { m.apply_inline(v) }
            )
        } else if Vector3::<T>::IN_FUNCTIONS {
            self.apply_called(v)
        } else {
            self.apply_inline(v)
        }
    }

    #[inline]
    fn apply_called(&self, v: Vector3<T>) -> Vector3<T> {
        self.apply_inline(v)
    }

    #[inline(always)]
    fn apply_inline(&self, v: Vector3<T>) -> Vector3<T> {
        let [a, b, c] = self.columns;
        a.times_inline(v.x)
            .plus_scaled_inline(b, v.y)
            .plus_scaled_inline(c, v.z)
    }

    /// Product of the transposed matrix (the inverse rotation) and a column vector.
    #[inline(always)]
    pub fn apply_transposed(&self, v: Vector3<T>) -> Vector3<T> {
        if Vector3::<T>::IN_PIECES {
            outlined!(
                small [T: Real] v.x; m: &'p Matrix3<T> = self, v: Vector3<T> = v => Vector3<T> { m.apply_transposed_inline(v) }
            )
        } else if Vector3::<T>::IN_FUNCTIONS {
            self.apply_transposed_called(v)
        } else {
            self.apply_transposed_inline(v)
        }
    }

    #[inline]
    fn apply_transposed_called(&self, v: Vector3<T>) -> Vector3<T> {
        self.apply_transposed_inline(v)
    }

    #[inline(always)]
    fn apply_transposed_inline(&self, v: Vector3<T>) -> Vector3<T> {
        let [a, b, c] = self.columns;
        Vector3::new(a.dot_inline(v), b.dot_inline(v), c.dot_inline(v))
    }

    /// This rotation followed by the rotation with Rodrigues vector `rodrigues` = tan(angle/2) times the axis (Cayley's
    /// form: rational, and exactly orthogonal for every number type).
    #[inline(always)]
    pub fn turned(&self, rodrigues: Vector3<T>) -> Self {
        if T::IN_REGISTERS {
            self.turned_inline(rodrigues)
        } else {
            self.turned_outlined(rodrigues)
        }
    }

    #[inline]
    fn turned_outlined(&self, rodrigues: Vector3<T>) -> Self {
        self.turned_inline(rodrigues)
    }

    #[inline(always)]
    fn turned_inline(&self, rodrigues: Vector3<T>) -> Self {
        let one = rodrigues.x.one();
        let factor = (one + one) / (one + rodrigues.norm_squared());
        // The loop uses no closure. The compiler might call a closure instead of inlining it, and the called code would not
        // be compiled for lanes.
        let mut columns = self.columns;
        for column in &mut columns {
            let across = rodrigues.cross(*column);
            *column = *column + (across + rodrigues.cross(across)) * factor;
        }
        Matrix3 { columns }
    }

    /// Nearest rotation, to second order in the deviation: one Newton step of the polar decomposition, R (3 - R'R)/2.
    #[inline]
    pub fn orthonormalised(&self) -> Self {
        let [a, b, c] = self.columns;
        let half = a.x.constant(0.5);
        let (aa, bb, cc) = (a.norm_squared(), b.norm_squared(), c.norm_squared());
        let (ab, bc, ca) = (a.dot(b) * half, b.dot(c) * half, c.dot(a) * half);
        let own = |square: T| a.x.constant(1.5) - square * half;
        Matrix3 {
            columns: [
                a * own(aa) - b * ab - c * ca,
                b * own(bb) - a * ab - c * bc,
                c * own(cc) - a * ca - b * bc,
            ],
        }
    }

    /// Applies `f` to each entry.
    #[inline(always)]
    pub fn map<U: Copy>(self, f: impl Fn(T) -> U + Copy) -> Matrix3<U> {
        let [x, y, z] = self.columns;
        Matrix3 {
            columns: [x.map(f), y.map(f), z.map(f)],
        }
    }

    /// Combines each entry with the same entry of another matrix.
    #[inline(always)]
    pub(crate) fn zip<U: Copy, V: Copy>(
        self,
        other: Matrix3<U>,
        f: impl Fn(T, U) -> V + Copy,
    ) -> Matrix3<V> {
        let ([a, b, c], [d, e, g]) = (self.columns, other.columns);
        Matrix3 {
            columns: [a.zip(d, f), b.zip(e, f), c.zip(g, f)],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_by_cayley_is_a_rotation_about_its_axis() {
        let axis = Vector3::new(1.0, 2.0, 2.0) * (1.0 / 3.0);
        let turn = Matrix3::identity(0.0).turned(axis * (0.5_f64 * 0.8).tan());
        let across = Vector3::new(2.0, 1.0, -2.0) * (1.0 / 3.0);
        let image = turn.apply(across);
        let expected = across * 0.8_f64.cos() + axis.cross(across) * 0.8_f64.sin();
        assert!((image - expected).norm() < 4.0 * f64::EPSILON);
        assert!((turn.apply(axis) - axis).norm() < 4.0 * f64::EPSILON);
    }

    #[test]
    fn orthonormalising_removes_a_small_stretch() {
        let turn = Matrix3::identity(0.0).turned(Vector3::new(0.1, -0.2, 0.3));
        let bent = turn.map(|c| c * (1.0 + 1e-9));
        let mended = bent.orthonormalised();
        for (a, b) in mended.columns.iter().zip(turn.columns) {
            assert!((*a - b).norm() < 1e-15);
        }
    }
}
