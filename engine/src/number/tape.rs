//! Numbers that remember how they were made, for gradients by many inputs at once.
//!
//! Every operation notes its operands and its slopes by them; one pass backwards over these notes gives
//! the derivatives of a result by all inputs, for a few times the cost of the result (A. Griewank,
//! A. Walther, *Evaluating Derivatives*, 2nd ed., SIAM 2008, chapter 3). [`super::Dual`] is the better
//! choice for a handful of inputs.

use super::{Real, Scalar};
use std::cell::RefCell;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// The notes of one computation.
#[derive(Clone, Debug, Default)]
pub struct Tape {
    /// For each number, the indices of up to two operands and the derivatives by them.
    nodes: RefCell<Vec<[(usize, f64); 2]>>,
}

impl Tape {
    /// Forgets everything, and keeps its memory.
    pub fn clear(&mut self) {
        self.nodes.get_mut().clear();
    }

    /// Forgets all numbers but the first `length`. Numbers made after these must not be used any more.
    pub fn rewind(&self, length: usize) {
        self.nodes.borrow_mut().truncate(length);
    }

    /// An input; inputs are numbered from 0 in the order they are made, if all are made first.
    pub fn input(&self, value: f64) -> Tracked<'_> {
        self.note(value, [(0, 0.0); 2])
    }

    /// Number of entries on the tape, and index of the next one.
    pub fn len(&self) -> usize {
        self.nodes.borrow().len()
    }

    /// Returns true if the tape is empty.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    fn note(&self, value: f64, node: [(usize, f64); 2]) -> Tracked<'_> {
        let mut nodes = self.nodes.borrow_mut();
        nodes.push(node);
        Tracked {
            value,
            origin: Some((self, nodes.len() - 1)),
        }
    }

    /// The derivatives of a number by every input and every number between, by index.
    pub fn gradient(&self, of: Tracked<'_>, gradient: &mut Vec<f64>) {
        let nodes = self.nodes.borrow();
        gradient.clear();
        gradient.resize(nodes.len(), 0.0);
        let Some((_, last)) = of.origin else { return };
        gradient[last] = 1.0;
        for index in (0..=last).rev() {
            let weight = gradient[index];
            // A weight of zero passes nothing on, even if a slope is unknown.
            if weight == 0.0 {
                continue;
            }
            for (operand, slope) in nodes[index] {
                if slope != 0.0 {
                    gradient[operand] += weight * slope;
                }
            }
        }
    }
}

/// A number on a [`Tape`], or a constant, which is on none.
#[derive(Clone, Copy, Debug)]
pub struct Tracked<'t> {
    value: f64,
    origin: Option<(&'t Tape, usize)>,
}

impl<'t> Tracked<'t> {
    /// A number that depends on no input.
    #[inline(always)]
    pub fn constant(value: f64) -> Self {
        Tracked {
            value,
            origin: None,
        }
    }

    /// The value without its derivatives.
    pub fn plain(self) -> f64 {
        self.value
    }

    /// Index of its note; `None` of a constant.
    pub fn index(self) -> Option<usize> {
        self.origin.map(|(_, index)| index)
    }

    #[inline(never)]
    fn of_one(self, value: f64, slope: f64) -> Self {
        match self.origin {
            // What does not change with its operand needs no note.
            Some(_) if slope == 0.0 => Tracked::constant(value),
            None => Tracked::constant(value),
            Some((tape, index)) => tape.note(value, [(index, slope), (index, 0.0)]),
        }
    }

    #[inline(never)]
    fn of_two(self, other: Self, value: f64, [by_self, by_other]: [f64; 2]) -> Self {
        match (self.origin, other.origin) {
            (Some((tape, a)), Some((_, b))) => tape.note(value, [(a, by_self), (b, by_other)]),
            (Some(_), None) => self.of_one(value, by_self),
            (None, _) => other.of_one(value, by_other),
        }
    }
}

impl Add for Tracked<'_> {
    type Output = Self;
    #[inline(never)]
    fn add(self, other: Self) -> Self {
        self.of_two(other, self.value + other.value, [1.0, 1.0])
    }
}

impl Sub for Tracked<'_> {
    type Output = Self;
    #[inline(never)]
    fn sub(self, other: Self) -> Self {
        self.of_two(other, self.value - other.value, [1.0, -1.0])
    }
}

impl Mul for Tracked<'_> {
    type Output = Self;
    #[inline(never)]
    fn mul(self, other: Self) -> Self {
        self.of_two(other, self.value * other.value, [other.value, self.value])
    }
}

impl Div for Tracked<'_> {
    type Output = Self;
    #[inline(never)]
    fn div(self, other: Self) -> Self {
        let quotient = self.value / other.value;
        let slopes = [1.0 / other.value, -quotient / other.value];
        self.of_two(other, quotient, slopes)
    }
}

impl Neg for Tracked<'_> {
    type Output = Self;
    #[inline(never)]
    fn neg(self) -> Self {
        self.of_one(-self.value, -1.0)
    }
}

impl Real for Tracked<'_> {
    /// Notes cost more than a call.
    const IS_NESTED: bool = true;

    fn lit(self, value: f64) -> Self {
        Tracked::constant(value)
    }
    fn sqrt(self) -> Self {
        let root = Real::sqrt(self.value);
        self.of_one(root, 0.5 / root)
    }
    fn asin(self) -> Self {
        let slope = 1.0 / Real::sqrt(1.0 - self.value * self.value);
        self.of_one(Real::asin(self.value), slope)
    }
    fn atan2(self, x: Self) -> Self {
        let inverse = 1.0 / (self.value * self.value + x.value * x.value);
        let slopes = [x.value * inverse, -self.value * inverse];
        self.of_two(x, Real::atan2(self.value, x.value), slopes)
    }
    fn sign(self) -> Self {
        Tracked::constant(self.value.sign())
    }
}

impl Scalar for Tracked<'_> {
    fn value(self) -> f64 {
        self.value
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Dual, Jet};
    use super::*;

    fn formula<T: Real>(x: T, y: T) -> T {
        (x.sqrt() / (x.one() + y * y)).asin() + (x * y - x).atan2(x.lit(0.3) + y) - (-y)
    }

    /// Backwards and forwards agree, also in the slope of a series.
    #[test]
    fn agrees_with_dual_numbers() {
        let mut tape = Tape::default();
        let mut gradient = Vec::new();
        tape.clear();
        let (x, y) = (tape.input(0.6), tape.input(-0.4));
        tape.gradient(formula(x, y), &mut gradient);
        let (p, q) = (Dual::<f64, 2>::input(0.6, 0), Dual::input(-0.4, 1));
        let expected = formula(p, q).partials;
        for (found, expected) in gradient.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-15, "{found} {expected}");
        }
        let (x, y) = (Jet([x, x.one()]), Jet::constant(y));
        tape.gradient(formula(x, y)[1], &mut gradient);
        let along = formula(Jet::<_, 2>::variable(p), Jet::constant(q))[1].partials;
        for (found, expected) in gradient.iter().zip(along) {
            assert!((found - expected).abs() < 1e-14, "{found} {expected}");
        }
    }
}
