//! Numbers in memory that start at a cache line, because SIMD registers load such numbers fastest.

use std::ops::{Deref, DerefMut};

/// Size of a cache line, in bytes.
const LINE: usize = 64;
/// Number of `f64` numbers in a cache line.
const IN_LINE: usize = LINE / size_of::<f64>();

/// Numbers that start at a cache line, so that no SIMD register crosses the border of a cache line.
#[derive(Debug)]
pub(super) struct Aligned {
    numbers: Vec<f64>,
    start: usize,
    length: usize,
}

impl Aligned {
    /// Makes `length` copies of a number.
    pub(super) fn new(number: f64, length: usize) -> Self {
        let numbers = vec![number; length + IN_LINE - 1];
        // The alignment affects only the speed.
        let start = numbers.as_ptr().align_offset(LINE).min(IN_LINE - 1);
        Aligned {
            numbers,
            start,
            length,
        }
    }
}

impl Clone for Aligned {
    fn clone(&self) -> Self {
        let mut clone = Aligned::new(0.0, self.length);
        clone.copy_from_slice(self);
        clone
    }
}

impl Deref for Aligned {
    type Target = [f64];
    #[inline(always)]
    fn deref(&self) -> &[f64] {
        &self.numbers[self.start..self.start + self.length]
    }
}

impl DerefMut for Aligned {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [f64] {
        &mut self.numbers[self.start..self.start + self.length]
    }
}
