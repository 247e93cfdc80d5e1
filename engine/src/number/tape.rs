//! Numbers that record their operations, for gradients by many inputs at once.
//!
//! Every operation records its operands and its derivatives by them. One backward pass over this record gives the
//! derivatives of a result by all inputs, for a few times the cost of the result (A. Griewank, A. Walther, *Evaluating
//! Derivatives*, 2nd ed., SIAM 2008, chapter 3). [`super::Dual`] is the better choice for a few inputs.

use super::{Real, Scalar, array_of};
use std::cell::RefCell;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Number of results in one backward pass.
const AT_ONCE: usize = 8;

/// Record of one computation.
#[derive(Clone, Debug, Default)]
pub struct Tape {
    nodes: RefCell<Vec<Node>>,
    adjoints: RefCell<Adjoints>,
}

/// Record of a number: up to two operands, and the derivatives by them. Indices have four bytes, because a long computation
/// writes and reads many records.
#[derive(Clone, Copy, Debug, Default)]
struct Node {
    operands: [u32; 2],
    slopes: [f64; 2],
}

/// Derivatives of some results by each number. All are zero between two passes.
#[derive(Clone, Debug, Default)]
struct Adjoints {
    of: Vec<[f64; AT_ONCE]>,
    /// One bit for each number, set if its derivative may be nonzero. A pass visits only these numbers. Most numbers of a
    /// long tape do not contribute to a result.
    noted: Vec<u64>,
}

impl Adjoints {
    /// Allocates memory for this count of numbers.
    fn fit(&mut self, numbers: usize) {
        let length = self.of.len().max(numbers);
        self.of.resize(length, [0.0; AT_ONCE]);
        self.noted.resize(length.div_ceil(64), 0);
    }

    #[inline(always)]
    fn note(&mut self, number: usize) -> &mut [f64; AT_ONCE] {
        self.noted[number / 64] |= 1 << (number % 64);
        &mut self.of[number]
    }

    /// Adds the derivatives by a number to those by its operands. A zero derivative adds nothing, even if a slope is NaN.
    #[inline(always)]
    fn pass_on(&mut self, number: usize, node: &Node) {
        let weights = self.of[number];
        for k in 0..2 {
            let slope = node.slopes[k];
            if slope == 0.0 {
                continue;
            }
            let sums = self.note(node.operands[k] as usize);
            *sums = if slope.is_finite() {
                array_of(|k| sums[k] + weights[k] * slope)
            } else {
                array_of(|k| match weights[k] {
                    0.0 => sums[k],
                    weight => sums[k] + weight * slope,
                })
            };
        }
    }

    /// Processes all marked numbers below `end`, from last to first. Only the derivatives by the first `inputs` numbers
    /// remain.
    fn pass_back(&mut self, end: usize, inputs: usize, nodes: &[Node]) {
        for word in (0..end.div_ceil(64)).rev() {
            // Operands have lower indices than their results, often in the same word.
            while self.noted[word] != 0 {
                let bit = 63 - self.noted[word].leading_zeros() as usize;
                self.noted[word] &= !(1 << bit);
                let number = 64 * word + bit;
                self.pass_on(number, &nodes[number]);
                if number >= inputs {
                    self.of[number] = [0.0; AT_ONCE];
                }
            }
        }
    }
}

impl Tape {
    /// Clears the tape, and keeps its memory.
    pub fn clear(&mut self) {
        self.nodes.get_mut().clear();
    }

    /// Removes all entries but the first `length`. The numbers that they record must not be used any more.
    pub fn truncate(&self, length: usize) {
        self.nodes.borrow_mut().truncate(length);
    }

    /// Adds an input. If all inputs are made first, their indices start from 0 in order.
    pub fn input(&self, value: f64) -> Tracked<'_> {
        self.note(value, Node::default())
    }

    /// Number of entries on the tape, which is the index of the next one.
    pub fn len(&self) -> usize {
        self.nodes.borrow().len()
    }

    /// Returns true if the tape is empty.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// # Panics
    /// If the tape has 2^32 entries, which need 100 GB.
    #[inline(always)]
    fn note(&self, value: f64, node: Node) -> Tracked<'_> {
        let mut nodes = self.nodes.borrow_mut();
        let index = u32::try_from(nodes.len()).expect("fewer than 2^32 entries");
        nodes.push(node);
        Tracked {
            value,
            origin: Some((self, index)),
        }
    }

    /// Derivatives of results by the first `inputs` numbers of the tape. `receive` gets the index of each result and its
    /// derivatives. Several results share a backward pass; each has the same bits as it would have alone. Results that are
    /// near each other on the tape share a pass, because they depend on the same numbers.
    ///
    /// # Panics
    /// If the tape has fewer numbers than `inputs`.
    pub fn gradients(
        &self,
        of: &[Tracked<'_>],
        inputs: usize,
        mut receive: impl FnMut(usize, &[f64]),
    ) {
        let nodes = self.nodes.borrow();
        let mut adjoints = self.adjoints.borrow_mut();
        adjoints.fit(nodes.len());
        let origins: Vec<Option<(usize, f64)>> = of
            .iter()
            .map(|result| Some(origin_of(result.index()?, inputs, &nodes)))
            .collect();
        let mut distinct: Vec<usize> = origins
            .iter()
            .flatten()
            .map(|(number, _)| *number)
            .collect();
        distinct.sort_unstable();
        distinct.dedup();
        let mut found: Vec<[f64; AT_ONCE]> = Vec::new();
        for results in distinct.chunks(AT_ONCE) {
            for (lane, number) in results.iter().enumerate() {
                adjoints.note(*number)[lane] = 1.0;
            }
            let end = results.last().map_or(0, |last| last + 1);
            adjoints.pass_back(end, inputs, &nodes);
            found.extend_from_slice(&adjoints.of[..inputs]);
            adjoints.of[..inputs].fill([0.0; AT_ONCE]);
        }
        let mut gradient = vec![0.0; inputs];
        for (result, origin) in origins.into_iter().enumerate() {
            gradient.fill(0.0);
            if let Some((number, factor)) = origin {
                let place = distinct.partition_point(|own| *own < number);
                let group = &found[place / AT_ONCE * inputs..][..inputs];
                for (by, found) in gradient.iter_mut().zip(group) {
                    *by = found[place % AT_ONCE] * factor;
                }
            }
            receive(result, &gradient);
        }
    }
}

/// Follows a number back through operations with one operand. Returns the number where they start, and the derivative by it. In
/// this way, numbers that differ only by a factor share their derivatives.
fn origin_of(number: usize, inputs: usize, nodes: &[Node]) -> (usize, f64) {
    let (mut number, mut factor) = (number, 1.0);
    while number >= inputs {
        let Node {
            operands: [operand, _],
            slopes: [slope, other],
        } = nodes[number];
        if other != 0.0 || slope == 0.0 || !slope.is_finite() {
            break;
        }
        (number, factor) = (operand as usize, factor * slope);
    }
    (number, factor)
}

/// A number on a [`Tape`], or a constant, which is on no tape.
#[derive(Clone, Copy, Debug)]
pub struct Tracked<'t> {
    value: f64,
    origin: Option<(&'t Tape, u32)>,
}

impl<'t> Tracked<'t> {
    /// Makes a number that depends on no input.
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

    /// Index of the number on the tape. `None` for a constant.
    pub fn index(self) -> Option<usize> {
        self.origin.map(|(_, index)| index as usize)
    }

    #[inline(never)]
    fn of_one(self, value: f64, slope: f64) -> Self {
        match self.origin {
            // A number that does not change with its operand needs no record.
            Some(_) if slope == 0.0 => Tracked::constant(value),
            None => Tracked::constant(value),
            Some((tape, index)) => tape.note(
                value,
                Node {
                    operands: [index, index],
                    slopes: [slope, 0.0],
                },
            ),
        }
    }

    #[inline(never)]
    fn of_two(self, other: Self, value: f64, [by_self, by_other]: [f64; 2]) -> Self {
        match (self.origin, other.origin) {
            (Some((tape, a)), Some((_, b))) => tape.note(
                value,
                Node {
                    operands: [a, b],
                    slopes: [by_self, by_other],
                },
            ),
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
    /// True, because a record takes longer than a function call.
    const IS_NESTED: bool = true;

    fn constant(self, value: f64) -> Self {
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
        (x.sqrt() / (x.one() + y * y)).asin() + (x * y - x).atan2(x.constant(0.3) + y) - (-y)
    }

    /// Backward and forward differentiation give the same derivatives, also for the slope of a series.
    #[test]
    fn agrees_with_dual_numbers() {
        let tape = Tape::default();
        let (x, y) = (tape.input(0.6), tape.input(-0.4));
        let (p, q) = (Dual::<f64, 2>::input(0.6, 0), Dual::input(-0.4, 1));
        let series = (Jet([x, x.one()]), Jet::constant(y));
        let results = [formula(x, y), formula(series.0, series.1)[1]];
        let along = formula(Jet::<_, 2>::variable(p), Jet::constant(q))[1];
        let expected = [formula(p, q).partials, along.partials];
        tape.gradients(&results, 2, |number, gradient| {
            for (found, expected) in gradient.iter().zip(expected[number]) {
                assert!((found - expected).abs() < 1e-14, "{found} {expected}");
            }
        });
    }

    /// Results that share a pass have the same bits as results of separate passes. Some results are constants or inputs, or have
    /// undefined slopes.
    #[test]
    fn results_do_not_touch_each_other() {
        let tape = Tape::default();
        let inputs: Vec<_> = (0..5)
            .map(|k| tape.input(0.3 + 0.1 * f64::from(k)))
            .collect();
        let mut results: Vec<_> = (0..30)
            .map(|k| formula(inputs[k % 5], inputs[(k * 3 + 1) % 5].scaled(-1.0)))
            .collect();
        results[4] = Tracked::constant(2.0);
        results[9] = inputs[3];
        results[17] = (inputs[0] - inputs[0]).sqrt();
        let gradients = |of: &[Tracked<'_>]| {
            let mut all = Vec::new();
            tape.gradients(of, inputs.len(), |_, gradient| {
                all.push(gradient.iter().map(|g| g.to_bits()).collect::<Vec<_>>());
            });
            all
        };
        let together = gradients(&results);
        let alone: Vec<_> = results
            .iter()
            .flat_map(|result| gradients(&[*result]))
            .collect();
        assert_eq!(together, alone);
        assert_eq!(together[4], [0; 5]);
        assert!(f64::from_bits(together[17][0]).is_nan());
        let finite = together.iter().enumerate().filter(|(k, _)| *k != 17);
        assert!(
            finite
                .flat_map(|(_, g)| g)
                .all(|bits| f64::from_bits(*bits).is_finite())
        );
    }
}
