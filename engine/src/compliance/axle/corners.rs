//! Equations of both wheels while the bodies that they share (subframe, rack, anti-roll bar) are held.
//!
//! Each independently suspended wheel has its own matrix. A solid axle is one body with both wheels. Each side contains
//! the elastic parts of its half, in its own axes. Both sides use the same reference point. Let A be the tangent of the
//! carrier: the derivatives of its forces r with respect to its motion x. The index l or r names the side, and M are the
//! signs of the reflection. Then
//!
//! ```text
//! A = A_l + M A_r M,   r = r_l + M r_r,   x_r = M x_l                                             (1)
//! ```
//!
//! The axle has these six unknowns of the carrier. The equations of the rigid links and of the two held wheel heights
//! follow.

#![expect(
    clippy::needless_range_loop,
    reason = "rows and columns of matrices are named by their numbers"
)]

use super::super::limb::is_positive;
use super::super::solve::{Bounds, Obstacle, is_definite};
use super::super::system::{Equations, LOOSE};
use super::equations::{AxleSingular, SideEquations, sign};
use crate::compliance::system::Singular;
use crate::linear::square::{MOST, SquareLu};
use crate::number::{Each, Scalar, Valued};

/// Factorised equations of both wheels.
#[derive(Clone, Debug)]
pub(super) enum Corners<T: Valued> {
    /// Factors of two independently suspended wheels.
    Apart([SquareLu<T>; 2]),
    /// One body that carries both wheels.
    Joined(Box<Joined<T>>),
}

/// Equations of a body that carries both wheels.
#[derive(Clone, Debug)]
pub(super) struct Joined<T: Valued> {
    places: Places,
    equations: Equations<T>,
    factors: SquareLu<T>,
}

/// For each side, the indices of its equations in the system of both sides (joint equations).
#[derive(Clone, Copy, Debug)]
struct Places {
    rows: [[usize; MOST]; 2],
    sizes: [usize; 2],
    size: usize,
}

impl Places {
    /// Finds the indices in the system of both sides. `sizes` are the numbers of equations of the two sides. `None` if
    /// the system of both sides would have more than [`MOST`] equations.
    fn of(sizes: [usize; 2]) -> Option<Self> {
        let size = sizes[0] + sizes[1] - 6;
        let mut rows = [[0; MOST]; 2];
        for (side, rows) in rows.iter_mut().enumerate() {
            for (i, row) in rows.iter_mut().enumerate() {
                *row = if i < 6 || side == 0 {
                    i
                } else {
                    sizes[0] + i - 6
                };
            }
        }
        (size <= MOST).then_some(Places { rows, sizes, size })
    }

    /// Returns, for each equation of a side: its index on this side, its index in the system of both sides, and its
    /// sign.
    fn of_side(&self, side: usize) -> impl Iterator<Item = (usize, usize, f64)> {
        let rows = self.rows[side];
        let sign = move |i: usize| if i < 6 { sign(side, i) } else { 1.0 };
        (0..self.sizes[side]).map(move |i| (i, rows[i], sign(i)))
    }

    fn joined<T: Scalar>(&self, parts: &[[T; MOST]; 2]) -> [T; MOST] {
        let mut sum = [parts[0][0].zero(); MOST];
        for (side, part) in parts.iter().enumerate() {
            for (i, row, sign) in self.of_side(side) {
                sum[row] = sum[row] + part[i].scaled(sign);
            }
        }
        sum
    }

    fn parted<T: Scalar>(&self, whole: &[T; MOST]) -> [[T; MOST]; 2] {
        let mut parts = [[whole[0].zero(); MOST]; 2];
        for (side, part) in parts.iter_mut().enumerate() {
            for (i, row, sign) in self.of_side(side) {
                part[i] = whole[row].scaled(sign);
            }
        }
        parts
    }
}

impl<T: Scalar> Corners<T> {
    /// Factorises the equations of independently suspended wheels.
    pub(super) fn apart(sides: &[SideEquations<T>; 2]) -> Result<Self, AxleSingular> {
        let factors = |side: usize| {
            let found = sides[side].equations.factors();
            found.ok_or(AxleSingular::Wheel(side, Singular::Carrier))
        };
        Ok(Corners::Apart([factors(0)?, factors(1)?]))
    }

    /// Combines both sides of a body that carries both wheels, by equation (1) of this file. Afterwards, the left side in `sides`
    /// contains all forces on the body, and the forces of the right side on the body are zero. If `bounds` (limits of the solver)
    /// is given, every motion must have a stiffness. Otherwise the function returns an error.
    pub(super) fn joined(
        sides: &mut [SideEquations<T>; 2],
        bounds: Option<Bounds>,
    ) -> Result<Self, AxleSingular> {
        let sizes = sides.each_ref().each(|side| side.equations.size);
        let places = Places::of(sizes).ok_or(AxleSingular::Carrier)?;
        let residuals = sides.each_ref().each(|side| side.equations.residual);
        let mut equations = Equations::empty(residuals[0][0], 0, None);
        equations.size = places.size;
        equations.residual = places.joined(&residuals);
        for (side, of) in sides.iter_mut().enumerate() {
            let rows = || places.of_side(side);
            for (i, row, sign) in rows() {
                for (j, column, other) in rows() {
                    let entry = of.equations.matrix[i][j].scaled(sign * other);
                    let sum = &mut equations.matrix[row][column];
                    *sum = *sum + entry;
                }
            }
            for (i, row, _) in rows().take(6) {
                let force = &mut of.equations.residual[i];
                *force = match side {
                    0 => equations.residual[row],
                    _ => force.zero(),
                };
            }
        }
        if bounds.is_some_and(|bounds| !is_definite(&equations, bounds, LOOSE)) {
            return Err(AxleSingular::Carrier);
        }
        let factors = equations.factors().ok_or(AxleSingular::Carrier)?;
        Ok(Corners::Joined(Box::new(Joined {
            places,
            equations,
            factors,
        })))
    }

    /// Solves the equations of both wheels for the motions under the forces `parts`.
    pub(super) fn solve(&self, parts: &[[T; MOST]; 2]) -> [[T; MOST]; 2] {
        match self {
            Corners::Apart(factors) => [0, 1].each(|side: usize| factors[side].solve(&parts[side])),
            Corners::Joined(own) => {
                let solution = own.factors.solve(&own.places.joined(parts));
                own.places.parted(&solution)
            }
        }
    }
}

impl Corners<f64> {
    /// Checks the stability of each wheel while the shared bodies are held. The error contains the side that is unstable;
    /// `None` for the body that carries both wheels.
    pub(super) fn check_stable(
        &self,
        sides: &[SideEquations<f64>; 2],
        bounds: Bounds,
    ) -> Result<(), (Option<usize>, Obstacle)> {
        for (side, of) in sides.iter().enumerate() {
            let own = &of.equations;
            let stable = match self {
                Corners::Apart(_) => own.check_stable(bounds),
                // The matrix of one side alone may be indefinite.
                Corners::Joined(_) => match own.unstable {
                    Some(_) => Err(Obstacle::Unstable(own.unstable)),
                    None => Ok(()),
                },
            };
            stable.map_err(|why| (Some(side), why))?;
        }
        match self {
            Corners::Apart(_) => Ok(()),
            Corners::Joined(own) => own
                .equations
                .check_stable(bounds)
                .map_err(|why| (None, why)),
        }
    }

    /// Returns true if the symmetric `matrix` of the shared unknowns stays positive definite while the wheels move
    /// freely. `columns` are the derivatives of the forces on both wheels with respect to these shared unknowns.
    pub(super) fn keep_definite<const N: usize>(
        &self,
        sides: &[SideEquations<f64>; 2],
        mut matrix: [[f64; N]; N],
        columns: &[[[f64; MOST]; 2]],
    ) -> bool {
        let side = |side: usize| {
            let of_side = columns.iter().map(|both| both[side]).collect::<Vec<_>>();
            (&sides[side].equations, of_side)
        };
        let blocks = match self {
            Corners::Apart(_) => vec![side(0), side(1)],
            Corners::Joined(own) => {
                let joined = columns.iter().map(|both| own.places.joined(both));
                vec![(&own.equations, joined.collect())]
            }
        };
        for (equations, columns) in blocks {
            let size = equations.size;
            let Some(factors) = SquareLu::of(symmetric(equations), size) else {
                return false;
            };
            for (b, column) in columns.iter().enumerate() {
                let response = factors.solve(column);
                for (a, row) in columns.iter().enumerate() {
                    let less = row.iter().zip(&response).take(size);
                    matrix[a][b] -= less.map(|(c, r)| c * r).sum::<f64>();
                }
            }
        }
        is_positive(&matrix, 0.0)
    }
}

/// Symmetric part of the tangent in `equations`. Each row of a rigid joint or of a held height is also a column.
fn symmetric(equations: &Equations<f64>) -> [[f64; MOST]; MOST] {
    let mut symmetric = [[0.0; MOST]; MOST];
    for i in 0..6 {
        for j in 0..6 {
            symmetric[i][j] = 0.5 * (equations.matrix[i][j] + equations.matrix[j][i]);
        }
        for k in 6..equations.size {
            symmetric[k][i] = equations.matrix[k][i];
            symmetric[i][k] = equations.matrix[k][i];
        }
    }
    symmetric
}
