//! Jacobian of the closure equations in the blocks A, B, C and D of three by three (module `linkage`), and their
//! elimination.

use crate::mechanism::{Twist, Wrench};
use crate::number::{Each, Matrix3, Real, Vector3, array_of, outlined};

/// Smallest pivot that the Jacobian of the base design (near which the tracked designs lie) may have.
const LEAST_PIVOT: f64 = 1e-3;

/// Order of the rows and columns of the Jacobian.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Order {
    rows: [usize; 6],
    columns: [usize; 6],
    /// Position of each row of the Jacobian in this order.
    places: [usize; 6],
}

impl Order {
    /// Returns the order that complete pivoting chooses for the Jacobian `wrenches`, with moments divided by the size.
    /// `None` if a pivot is not above [`LEAST_PIVOT`].
    pub(super) fn of(wrenches: &[Wrench<f64>; 6], size: f64) -> Option<Order> {
        let mut a = wrenches.each(|row| {
            let mut row = row.to_row();
            row[3..].iter_mut().for_each(|moment| *moment /= size);
            row
        });
        let mut order = Order {
            rows: array_of(|i| i),
            columns: array_of(|i| i),
            places: array_of(|i| i),
        };
        for k in 0..6 {
            let entries = (k..6).flat_map(|i| (k..6).map(move |j| (i, j)));
            let (i, j) = entries.max_by(|p, q| a[p.0][p.1].abs().total_cmp(&a[q.0][q.1].abs()))?;
            a.swap(k, i);
            order.rows.swap(k, i);
            a.iter_mut().for_each(|row| row.swap(k, j));
            order.columns.swap(k, j);
            // The condition is written so that NaN is refused.
            (a[k][k].abs() > LEAST_PIVOT).then_some(())?;
            let pivot_row = a[k];
            for row in &mut a[k + 1..] {
                let factor = row[k] / pivot_row[k];
                for (entry, above) in row.iter_mut().zip(pivot_row).skip(k) {
                    *entry -= factor * above;
                }
            }
        }
        for (place, row) in order.rows.into_iter().enumerate() {
            order.places[row] = place;
        }
        Some(order)
    }
}

/// Blocks of a Jacobian. They are filled in place, because copying the blocks would take a quarter of the whole time.
pub(super) struct Blocks<B> {
    pub(super) order: Order,
    inverse_size: B,
    /// Rows of A above rows of C.
    left: [Vector3<B>; 6],
    /// Rows of B above rows of D.
    right: [Vector3<B>; 6],
    inverse_a: Inverse<B>,
    /// Rows of A^-1 B.
    w: [Vector3<B>; 3],
    inverse_s: Inverse<B>,
}

/// Inverse of a matrix of three rows, and the determinant of the matrix.
#[derive(Clone, Copy)]
struct Inverse<B> {
    matrix: Matrix3<B>,
    determinant: B,
}

impl<B: Real> Inverse<B> {
    #[inline(always)]
    fn of([a, b, c]: [Vector3<B>; 3]) -> Self {
        let across = b.cross(c);
        let determinant = a.dot(across);
        let inverse = determinant.one() / determinant;
        Inverse {
            matrix: Matrix3 {
                columns: [across * inverse, c.cross(a) * inverse, a.cross(b) * inverse],
            },
            determinant,
        }
    }
}

/// Three elements of a row, in the given order of columns. `first` is the position of the first of them in this order.
#[inline(always)]
fn three<B: Copy>(row: &[B; 6], columns: &[usize; 6], first: usize) -> Vector3<B> {
    Vector3::new(
        row[columns[first]],
        row[columns[first + 1]],
        row[columns[first + 2]],
    )
}

/// Sum x a + y b + z c.
#[inline(always)]
fn combined<B: Real>([a, b, c]: [Vector3<B>; 3], x: B, y: B, z: B) -> Vector3<B> {
    (a * x).plus_scaled(b, y).plus_scaled(c, z)
}

impl<B: Real> Blocks<B> {
    /// Makes blocks of zeros. They must be filled before use.
    #[inline(always)]
    pub(super) fn unformed(order: Order, inverse_size: B) -> Self {
        let zero = inverse_size.zero();
        let null = Vector3::new(zero, zero, zero);
        let unformed = Inverse {
            matrix: Matrix3 { columns: [null; 3] },
            determinant: zero,
        };
        Blocks {
            order,
            inverse_size,
            left: [null; 6],
            right: [null; 6],
            inverse_a: unformed,
            w: [null; 3],
            inverse_s: unformed,
        }
    }

    /// Returns the square of a rotation per unit of travel. `square` is the square of the rotation for a travel equal to the
    /// mechanism's size.
    #[inline(always)]
    pub(super) fn per_size(&self, square: f64) -> B {
        self.inverse_size * self.inverse_size * self.inverse_size.constant(square)
    }

    /// Stores a row of the Jacobian.
    #[inline(always)]
    pub(super) fn put(&mut self, number: usize, wrench: &Wrench<B>) {
        let Wrench { force, moment, .. } = *wrench;
        let m = moment * self.inverse_size;
        let row = [force.x, force.y, force.z, m.x, m.y, m.z];
        let place = self.order.places[number];
        self.left[place] = three(&row, &self.order.columns, 0);
        self.right[place] = three(&row, &self.order.columns, 3);
    }

    /// Computes inverses and determinants after all rows are stored.
    #[inline(always)]
    pub(super) fn eliminate(&mut self) {
        let [a0, a1, a2, ..] = self.left;
        self.inverse_a = Inverse::of([a0, a1, a2]);
        let [p, q, r] = self.inverse_a.matrix.columns;
        let [b0, b1, b2, d0, d1, d2] = self.right;
        let b = [b0, b1, b2];
        let w = [
            combined(b, p.x, q.x, r.x),
            combined(b, p.y, q.y, r.y),
            combined(b, p.z, q.z, r.z),
        ];
        let [c0, c1, c2] = self.c();
        self.inverse_s = Inverse::of([
            d0 - combined(w, c0.x, c0.y, c0.z),
            d1 - combined(w, c1.x, c1.y, c1.z),
            d2 - combined(w, c2.x, c2.y, c2.z),
        ]);
        self.w = w;
    }

    /// Rows of C.
    #[inline(always)]
    fn c(&self) -> [Vector3<B>; 3] {
        let [.., c0, c1, c2] = self.left;
        [c0, c1, c2]
    }

    /// Solves J (v, w) = f for the twist (v, w).
    #[inline(always)]
    pub(super) fn solve(&self, f: [B; 6]) -> Twist<B> {
        outlined!(
            [B: Real] f[0]; blocks: &'p Blocks<B> = self, f: [B; 6] = f => Twist<B> { blocks.solve_inline(f) }
        )
    }

    #[inline(always)]
    fn solve_inline(&self, f: [B; 6]) -> Twist<B> {
        let (above, below) = (
            three(&f, &self.order.rows, 0),
            three(&f, &self.order.rows, 3),
        );
        let upper = self.inverse_a.matrix.apply(above);
        let [c0, c1, c2] = self.c();
        let lower = self.inverse_s.matrix.apply(Vector3::new(
            below.x - c0.dot(upper),
            below.y - c1.dot(upper),
            below.z - c2.dot(upper),
        ));
        let upper = upper
            - Vector3::new(
                self.w[0].dot(lower),
                self.w[1].dot(lower),
                self.w[2].dot(lower),
            );
        let solution = [upper.x, upper.y, upper.z, lower.x, lower.y, lower.z];
        let mut twist = solution;
        for k in 0..6 {
            twist[self.order.columns[k]] = solution[k];
        }
        let Twist { shift, turn } = Twist::from_array(twist);
        Twist {
            shift,
            turn: turn * self.inverse_size,
        }
    }

    /// Solves J^T m = wrench for the multipliers m.
    #[inline(always)]
    pub(super) fn solve_transposed(&self, wrench: &Wrench<B>) -> [B; 6] {
        let (force, moment) = (wrench.force, wrench.moment * self.inverse_size);
        let w = [force.x, force.y, force.z, moment.x, moment.y, moment.z];
        let (above, below) = (
            three(&w, &self.order.columns, 0),
            three(&w, &self.order.columns, 3),
        );
        let lower = self
            .inverse_s
            .matrix
            .apply_transposed(below - combined(self.w, above.x, above.y, above.z));
        let upper = self
            .inverse_a
            .matrix
            .apply_transposed(above - combined(self.c(), lower.x, lower.y, lower.z));
        let solution = [upper.x, upper.y, upper.z, lower.x, lower.y, lower.z];
        let mut multipliers = solution;
        for k in 0..6 {
            multipliers[self.order.rows[k]] = solution[k];
        }
        multipliers
    }

    #[inline(always)]
    pub(super) fn determinants(&self) -> [B; 2] {
        [self.inverse_a.determinant, self.inverse_s.determinant]
    }
}
