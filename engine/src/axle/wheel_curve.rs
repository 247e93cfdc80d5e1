//! A wheel of an independent axle as a function of its own travel: piecewise polynomials between poses.
//!
//! Newton's method for a car evaluates the same wheels at thousands of travels. A pose takes longer than everything else in
//! a step. So a wheel is solved only at nodes, one piece apart, with three derivatives by travel. In a piece of length h
//! from z_0, with t = (z - z_0)/h, each number f is the polynomial of degree 7 with the values and derivatives at both
//! nodes:
//!
//! ```text
//! p(t) = c_0 + c_1 t + c_2 t^2 + c_3 t^3 + t^4 q(t),     c_k = h^k f^(k)(z_0)/k!                                (1)
//! q(t) = q_0 + q_1 (t-1) + q_2 (t-1)^2 + q_3 (t-1)^3                                                            (2)
//! D_k  = sum_i binom(4, i) q_(k-i)                                                                              (3)
//! f - p = f^(8)(..) h^8 t^4 (1-t)^4/8!                                                                          (4)
//! ```
//!
//! D_k is the coefficient of f at the second node minus that of the cubic. The error (4) falls with the eighth power of h,
//! and so does that of the first derivative, which is largest near t = 0.31. There a further pose checks value and
//! derivative of each piece. If they differ by more than rounding, all pieces become half as long.

use super::reading::{Reading, WheelPose, zipped};
use super::solver::AxleSolver;
use super::taylor::Taylor;
use crate::model::Side;
use std::cell::Cell;

/// Number of pieces on each side of the design position.
const MOST_PIECES: i32 = 48;
/// Initial length of pieces, as a share of the mechanism's size.
const LENGTH: f64 = 1.0 / 24.0;
/// Largest number of times that pieces are halved.
const MOST_HALVINGS: u32 = 4;
/// Value of t at which a piece is checked.
const CHECK: f64 = 0.31;
/// Largest error, relative to the size of the number and the length of the piece.
const TOLERANCE: f64 = 4e-13;

/// Coefficients of (1).
type Polynomial = [f64; 8];

/// A wheel as a function of its own travel, at one rack displacement.
#[derive(Clone, Debug)]
pub(crate) struct WheelCurve {
    side: Side,
    rack: f64,
    length: f64,
    halvings: u32,
    nodes: Vec<Known<Reading<f64>>>,
    pieces: Vec<Known<WheelPose<Polynomial>>>,
}

/// A value that is computed when it is first needed.
#[derive(Clone, Debug)]
enum Known<T> {
    NotYet,
    /// The value does not exist: the wheel has no pose at some travel of this interval.
    Absent,
    Here(Box<T>),
}

impl<T> Known<T> {
    fn of(found: Option<T>) -> Self {
        match found {
            Some(found) => Known::Here(Box::new(found)),
            None => Known::Absent,
        }
    }

    fn get(&self) -> Option<&T> {
        match self {
            Known::Here(found) => Some(found),
            _ => None,
        }
    }
}

impl WheelCurve {
    /// Curve of one wheel of the solver's axle, without any pieces yet.
    pub(crate) fn new<const N: usize>(solver: &AxleSolver<'_, N>, side: Side) -> Self {
        let mut curve = WheelCurve {
            side,
            rack: 0.0,
            length: LENGTH * solver.size(),
            halvings: 0,
            nodes: Vec::new(),
            pieces: Vec::new(),
        };
        curve.clear();
        curve
    }

    fn clear(&mut self) {
        let pieces = 2 * MOST_PIECES as usize;
        self.pieces.clear();
        self.pieces.resize(pieces, Known::NotYet);
        self.nodes.clear();
        self.nodes.resize(pieces + 1, Known::NotYet);
    }

    /// The wheel at a travel. `None` if the curve has no piece there that is exact to rounding.
    pub(crate) fn at<const N: usize>(
        &mut self,
        solver: &mut AxleSolver<'_, N>,
        travel: f64,
        rack: f64,
    ) -> Option<Reading<f64>> {
        if rack != self.rack {
            self.rack = rack;
            self.clear();
        }
        loop {
            let place = (travel / self.length).floor();
            let is_far = place.is_nan() || place.abs() >= f64::from(MOST_PIECES);
            if is_far || self.halvings > MOST_HALVINGS {
                return None;
            }
            let number = (place as i32 + MOST_PIECES) as usize;
            if let Known::NotYet = self.pieces[number] {
                let made = self.piece(solver, number);
                if self.is_inexact(solver, number, made.as_ref()) {
                    self.halvings += 1;
                    self.length *= 0.5;
                    self.clear();
                    continue;
                }
                self.pieces[number] = Known::of(made);
            }
            let t = travel / self.length - place;
            return Some(evaluated(self.pieces[number].get()?, t, self.length));
        }
    }

    /// Travel at a node.
    fn travel(&self, node: f64) -> f64 {
        (node - f64::from(MOST_PIECES)) * self.length
    }

    /// The wheel in a solved pose. `None` if it has no pose, or if a rocker is at a toggle.
    fn read<const N: usize>(
        &self,
        solver: &mut AxleSolver<'_, N>,
        travel: f64,
    ) -> Option<Reading<f64>> {
        let mut read = solver.wheel_curve(self.side, &[travel], self.rack);
        read.pop()?.ok()?.without_toggle()
    }

    fn node<const N: usize>(
        &mut self,
        solver: &mut AxleSolver<'_, N>,
        node: usize,
    ) -> Option<&Reading<f64>> {
        if let Known::NotYet = self.nodes[node] {
            self.nodes[node] = Known::of(self.read(solver, self.travel(node as f64)));
        }
        self.nodes[node].get()
    }

    /// Computes a piece by equations (1) to (3).
    fn piece<const N: usize>(
        &mut self,
        solver: &mut AxleSolver<'_, N>,
        number: usize,
    ) -> Option<WheelPose<Polynomial>> {
        let length = self.length;
        let from = self.node(solver, number)?.pose();
        let to = self.node(solver, number + 1)?.pose();
        let join = |(from, to): (Taylor<f64>, Taylor<f64>)| {
            let c = scaled(from, length);
            let end = scaled(to, length);
            let at_end = [
                c[0] + c[1] + c[2] + c[3],
                c[1] + 2.0 * c[2] + 3.0 * c[3],
                c[2] + 3.0 * c[3],
                c[3],
            ];
            let d: [f64; 4] = std::array::from_fn(|k| end[k] - at_end[k]);
            let q0 = d[0];
            let q1 = d[1] - 4.0 * q0;
            let q2 = d[2] - 4.0 * q1 - 6.0 * q0;
            let q3 = d[3] - 4.0 * q2 - 6.0 * q1 - 4.0 * q0;
            let [a, b, e, f] = c;
            [
                a,
                b,
                e,
                f,
                q0 - q1 + q2 - q3,
                q1 - 2.0 * q2 + 3.0 * q3,
                q2 - 3.0 * q3,
                q3,
            ]
        };
        Some(zipped(&from, &to).map(join))
    }

    /// Returns true if a piece differs from a pose within it by more than rounding.
    fn is_inexact<const N: usize>(
        &self,
        solver: &mut AxleSolver<'_, N>,
        number: usize,
        piece: Option<&WheelPose<Polynomial>>,
    ) -> bool {
        let Some(piece) = piece else {
            return false;
        };
        let travel = self.travel(number as f64 + CHECK);
        let Some(read) = self.read(solver, travel) else {
            return true;
        };
        let length = self.length;
        let found = evaluated(piece, CHECK, length).pose();
        let is_exact = Cell::new(true);
        zipped(&found, &read.pose()).map(|(found, read): (Taylor<f64>, Taylor<f64>)| {
            let (found, read) = (scaled(found, length), scaled(read, length));
            let bound = TOLERANCE * (read[0].abs() + length);
            // Numbers that are not read are NaN in both.
            if (found[0] - read[0]).abs() > bound || (found[1] - read[1]).abs() > bound {
                is_exact.set(false);
            }
        });
        !is_exact.get()
    }
}

/// Coefficients by travel, in units of the length of a piece.
fn scaled(number: Taylor<f64>, length: f64) -> [f64; 4] {
    let mut power = 1.0;
    [0, 1, 2, 3].map(|k| {
        let coefficient = number.coefficient([k, 0]) * power;
        power *= length;
        coefficient
    })
}

/// The wheel at a place in its piece.
fn evaluated(piece: &WheelPose<Polynomial>, t: f64, length: f64) -> Reading<f64> {
    let unread = Taylor::unknown(0.0);
    let inverse = 1.0 / length;
    let moving = |p: Polynomial| {
        if p[0].is_nan() {
            return unread;
        }
        // Horner's scheme, four times. It gives the first four coefficients about t.
        let mut c = p;
        for first in 0..4 {
            for k in (first..7).rev() {
                c[k] += t * c[k + 1];
            }
        }
        let (one, two) = (inverse, inverse * inverse);
        Taylor::through(&[&[c[0], c[1] * one, c[2] * two, c[3] * two * one]])
    };
    Reading::made_of(piece, moving, |p: Polynomial| p[0])
}
