//! Numbers that record their operations, for gradients with respect to many inputs at once.
//!
//! Every operation records its operands and its derivatives with respect to them. One backward pass over this record gives
//! the derivatives of a result with respect to all inputs, for a few times the cost of the result (A. Griewank, A. Walther,
//! *Evaluating Derivatives*, 2nd ed., SIAM 2008, chapter 3). [`super::Dual`] is the better choice for a few inputs.
//!
//! The record belongs to the CPU thread, and a number contains only its value and its index in the record. So the number fits
//! in two registers. If it contained a reference to its record, it would be passed through memory. Rig tests with derivatives
//! would take a tenth longer.

use super::{Real, Scalar, array_of};
use std::cell::RefCell;
use std::marker::PhantomData;
use std::num::NonZeroU32;
use std::ops::{Add, Div, Mul, Neg, Range, Sub};

/// Number of results in one backward pass.
const AT_ONCE: usize = 8;

thread_local! {
    /// Operations of all tapes of the thread.
    static RECORD: RefCell<Record> = const { RefCell::new(Record::empty()) };
}

/// A computation with recorded numbers. It uses the record of its thread; the next tape reuses the memory.
///
/// Operations may only use numbers of the thread's newest tape. Dropping a tape removes its numbers from the record.
#[derive(Debug)]
pub struct Tape {
    /// Index of the tape's first number in the record of the thread.
    first: usize,
    /// Count of older tapes of the thread, and index of the first number of the last older tape.
    older: (usize, usize),
    /// Marker that keeps a tape in its thread.
    of_thread: PhantomData<*const ()>,
}

#[derive(Debug)]
struct Record {
    nodes: Vec<Node>,
    adjoints: Adjoints,
    /// Count of the thread's tapes.
    tapes: usize,
    /// Index of the first number of the newest tape.
    newest: usize,
}

/// Record of a number: up to two operands, and the derivatives with respect to them. Indices have only four bytes, because
/// a long computation writes and reads many records.
#[derive(Clone, Copy, Debug, Default)]
struct Node {
    operands: [u32; 2],
    slopes: [f64; 2],
}

/// Derivatives of some results with respect to each number. All are zero between two passes.
#[derive(Debug)]
struct Adjoints {
    of: Vec<[f64; AT_ONCE]>,
    /// One bit for each number, set if the derivative with respect to it may be nonzero. A pass visits only these numbers.
    /// Most numbers of a long tape do not contribute to a result.
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

    /// Propagates the derivatives with respect to a number to its operands. A zero derivative adds nothing, even if a slope
    /// is NaN.
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

    /// Processes all marked numbers below `end`, from last to first. Only the derivatives with respect to the inputs
    /// remain; all others are set to zero again.
    fn pass_back(&mut self, end: usize, inputs: &Range<usize>, nodes: &[Node]) {
        for word in (inputs.start / 64..end.div_ceil(64)).rev() {
            // Operands have lower indices than their results. The flag of an operand is often in the same 64-bit word.
            while self.noted[word] != 0 {
                let bit = 63 - self.noted[word].leading_zeros() as usize;
                self.noted[word] &= !(1 << bit);
                let number = 64 * word + bit;
                self.pass_on(number, &nodes[number]);
                if number >= inputs.end {
                    self.of[number] = [0.0; AT_ONCE];
                }
            }
        }
    }
}

impl Record {
    const fn empty() -> Self {
        Record {
            nodes: Vec::new(),
            adjoints: Adjoints {
                of: Vec::new(),
                noted: Vec::new(),
            },
            tapes: 0,
            newest: 0,
        }
    }

    /// Adds a number to the record.
    ///
    /// # Panics
    /// If the record has 2^32 entries, which need 100 GB.
    #[inline(always)]
    fn note<'t>(&mut self, value: f64, node: Node) -> Tracked<'t> {
        self.nodes.push(node);
        let place = u32::try_from(self.nodes.len()).expect("fewer than 2^32 entries");
        Tracked {
            value,
            place: NonZeroU32::new(place),
            of_tape: PhantomData,
        }
    }

    /// Adds the result of an operation to the record.
    #[inline(always)]
    fn note_result<'t>(
        &mut self,
        value: f64,
        operands: [NonZeroU32; 2],
        slopes: [f64; 2],
    ) -> Tracked<'t> {
        let [first, second] = operands;
        let operands = [first.get() - 1, second.get() - 1];
        debug_assert!(
            operands[0].min(operands[1]) as usize >= self.newest,
            "numbers of one tape"
        );
        self.note(value, Node { operands, slopes })
    }

    /// Derivatives of numbers with respect to the inputs. Numbers that are near each other on the record share a backward
    /// pass, because they depend on the same numbers.
    fn pass_back(&mut self, numbers: &[usize], inputs: &Range<usize>) -> Vec<[f64; AT_ONCE]> {
        let Record {
            nodes, adjoints, ..
        } = self;
        adjoints.fit(nodes.len());
        let mut found = Vec::new();
        for results in numbers.chunks(AT_ONCE) {
            for (lane, number) in results.iter().enumerate() {
                adjoints.note(*number)[lane] = 1.0;
            }
            let end = results.last().map_or(0, |last| last + 1);
            adjoints.pass_back(end, inputs, nodes);
            found.extend_from_slice(&adjoints.of[inputs.clone()]);
            adjoints.of[inputs.clone()].fill([0.0; AT_ONCE]);
        }
        found
    }

    /// Follows a number back through operations with one operand. Returns the number at which these operations start, and
    /// the derivative of the given number with respect to it. So numbers that differ only by a factor share a backward
    /// pass.
    fn origin_of(&self, number: usize, inputs: &Range<usize>) -> (usize, f64) {
        let (mut number, mut factor) = (number, 1.0);
        while number >= inputs.end {
            let Node {
                operands: [operand, _],
                slopes: [slope, other],
            } = self.nodes[number];
            if other != 0.0 || slope == 0.0 || !slope.is_finite() {
                break;
            }
            (number, factor) = (operand as usize, factor * slope);
        }
        (number, factor)
    }
}

impl Tape {
    /// Makes an empty tape, which becomes the thread's newest tape. Drop it before tapes that are older.
    #[expect(
        clippy::new_without_default,
        reason = "a tape changes its thread's record"
    )]
    pub fn new() -> Self {
        RECORD.with_borrow_mut(|record| {
            let tape = Tape {
                first: record.nodes.len(),
                older: (record.tapes, record.newest),
                of_thread: PhantomData,
            };
            (record.tapes, record.newest) = (record.tapes + 1, tape.first);
            tape
        })
    }

    /// Removes all entries but the first `length`. Do not use the numbers of removed entries afterwards.
    pub fn truncate(&self, length: usize) {
        RECORD.with_borrow_mut(|record| record.nodes.truncate(self.first + length));
    }

    /// Adds an input. If all inputs come first on the tape, their indices count from 0.
    pub fn input(&self, value: f64) -> Tracked<'_> {
        RECORD.with_borrow_mut(|record| record.note(value, Node::default()))
    }

    /// Number of entries on the tape, which is the index of the next entry.
    pub fn len(&self) -> usize {
        RECORD.with_borrow(|record| record.nodes.len() - self.first)
    }

    /// Returns true if the tape is empty.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Computes the derivatives of results with respect to the first `inputs` numbers of the tape. `receive` gets the index
    /// of each result and its derivatives. Several results share a backward pass; separate passes would give bit-identical
    /// derivatives.
    ///
    /// # Panics
    /// May panic if the tape has fewer numbers than `inputs`.
    pub fn gradients(
        &self,
        of: &[Tracked<'_>],
        inputs: usize,
        mut receive: impl FnMut(usize, &[f64]),
    ) {
        let inputs = self.first..self.first + inputs;
        let (origins, distinct, found) = RECORD.with_borrow_mut(|record| {
            let origins: Vec<Option<(usize, f64)>> = of
                .iter()
                .map(|result| {
                    let place = result.place?.get() as usize;
                    Some(record.origin_of(place - 1, &inputs))
                })
                .collect();
            let mut distinct: Vec<usize> = origins
                .iter()
                .flatten()
                .map(|(number, _)| *number)
                .collect();
            distinct.sort_unstable();
            distinct.dedup();
            let found = record.pass_back(&distinct, &inputs);
            (origins, distinct, found)
        });
        let mut gradient = vec![0.0; inputs.len()];
        for (result, origin) in origins.into_iter().enumerate() {
            gradient.fill(0.0);
            if let Some((number, factor)) = origin {
                let place = distinct.partition_point(|own| *own < number);
                let group = &found[place / AT_ONCE * inputs.len()..][..inputs.len()];
                for (by, found) in gradient.iter_mut().zip(group) {
                    *by = found[place % AT_ONCE] * factor;
                }
            }
            receive(result, &gradient);
        }
    }
}

impl Drop for Tape {
    fn drop(&mut self) {
        RECORD.with_borrow_mut(|record| {
            record.tapes -= 1;
            // If tapes are not dropped in the reverse order of their creation, the last tape removes the remaining numbers.
            let (first, newest) = match (record.tapes, self.older) {
                (0, _) => (0, 0),
                (tapes, (older, newest)) if tapes == older => (self.first, newest),
                _ => return,
            };
            record.nodes.truncate(first);
            record.newest = newest;
        });
    }
}

/// A number on a [`Tape`], or a constant, which is on no tape.
#[derive(Clone, Copy, Debug)]
pub struct Tracked<'t> {
    value: f64,
    /// Index on the record, from 1. `None` for a constant.
    place: Option<NonZeroU32>,
    of_tape: PhantomData<&'t Tape>,
}

impl<'t> Tracked<'t> {
    /// Makes a number that depends on no input.
    #[inline(always)]
    pub fn constant(value: f64) -> Self {
        Tracked {
            value,
            place: None,
            of_tape: PhantomData,
        }
    }

    /// The value without its derivatives.
    pub fn plain(self) -> f64 {
        self.value
    }

    #[inline(never)]
    fn of_one(self, value: f64, slope: f64) -> Self {
        match self.place {
            // If the derivative with respect to the operand is zero, the result is a constant and does not enter the
            // record.
            Some(place) if slope != 0.0 => {
                RECORD.with_borrow_mut(|record| record.note_result(value, [place; 2], [slope, 0.0]))
            }
            _ => Tracked::constant(value),
        }
    }

    #[inline(never)]
    fn of_two(self, other: Self, value: f64, slopes: [f64; 2]) -> Self {
        match (self.place, other.place) {
            (Some(own), Some(its)) => {
                RECORD.with_borrow_mut(|record| record.note_result(value, [own, its], slopes))
            }
            (Some(_), None) => self.of_one(value, slopes[0]),
            (None, _) => other.of_one(value, slopes[1]),
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
    /// True, because recording an operation takes longer than a function call.
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
mod tests;
