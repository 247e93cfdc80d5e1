//! Random numbers that are the same on every platform: SplitMix64.

use hardpoint::number::Vector3;

pub struct Random(pub u64);

impl Random {
    /// Sixty-four random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Uniform random number in [-1, 1).
    pub fn signed(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// Random index below `n`.
    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    /// True with the probability 1/`one_in`.
    pub fn chance(&mut self, one_in: usize) -> bool {
        self.below(one_in) == 0
    }

    pub fn vector(&mut self, size: f64) -> Vector3<f64> {
        let mut part = || size * self.signed();
        Vector3::new(part(), part(), part())
    }

    /// Design with every point moved by up to `size` along each axis.
    pub fn scattered(&mut self, design: &[Vector3<f64>], size: f64) -> Vec<Vector3<f64>> {
        design.iter().map(|p| *p + self.vector(size)).collect()
    }
}
