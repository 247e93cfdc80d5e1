//! Random and low-discrepancy numbers in [0, 1). Each number depends only on seed, index and dimension, and on the number
//! of dimensions (Sobol) or of points (Latin hypercube). So a sweep can start at any design.

/// Number of points of one scrambled Sobol sequence of `sobol_burley`.
const SOBOL_POINTS: u64 = 1 << 16;

/// Returns coordinate `dimension` of point `index` of an Owen-scrambled Sobol sequence with this number of `dimensions`.
/// The coordinate is a multiple of 2^-23. One sequence of `sobol_burley` has 2^16 points with 256 dimensions. For more
/// points or dimensions, the function continues with an independent sequence (part) of another seed.
pub fn sobol(index: u64, dimension: usize, dimensions: usize, seed: u32) -> f64 {
    let most = sobol_burley::NUM_DIMENSIONS as usize;
    let across = dimensions.div_ceil(most) as u64;
    let part = index / SOBOL_POINTS * across + (dimension / most) as u64;
    // The first sequence (part 0) uses the seed itself, because mixed(0) is 0.
    let seed = seed ^ mixed(part) as u32;
    let fraction = sobol_burley::sample(
        (index % SOBOL_POINTS) as u32,
        (dimension % most) as u32,
        seed,
    );
    f64::from(fraction)
}

/// Returns a uniformly distributed number that is independent for every index, dimension and seed.
pub fn uniform(index: u64, dimension: usize, seed: u32) -> f64 {
    let bits = mixed(mixed(index.wrapping_add(STRIDE)) ^ key(dimension, seed));
    (bits >> 11) as f64 / (1_u64 << 53) as f64
}

/// Returns coordinate `dimension` of point `index` of a Latin hypercube of `count` points. The coordinate is a uniform
/// number in an interval of width 1 / `count`, and no other point has its coordinate in this interval (M. D. McKay, R.
/// J. Beckman, W. J. Conover, Technometrics 21, 1979).
pub fn latin_hypercube(index: u64, count: u64, dimension: usize, seed: u32) -> f64 {
    let stratum = permuted(index, count, key(dimension, seed));
    let within = uniform(index, dimension, !seed);
    // Rounding must not give the end of the interval, 1.
    ((stratum as f64 + within) / count as f64).min(1.0 - f64::EPSILON / 2.0)
}

/// Stride of SplitMix64: the fractional part of the golden ratio times 2^64.
const STRIDE: u64 = 0x9e37_79b9_7f4a_7c15;

/// Finaliser of SplitMix64: a bijection whose results show no pattern for consecutive arguments (G. L. Steele, D. Lea, C. H.
/// Flood, Fast splittable pseudorandom number generators, OOPSLA 2014).
fn mixed(x: u64) -> u64 {
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

fn key(dimension: usize, seed: u32) -> u64 {
    mixed((dimension as u64 + 1).wrapping_mul(STRIDE) ^ (u64::from(seed) << 32))
}

/// Returns the number to which a permutation of `0..count` moves `index`. The permutation is a Feistel network over the
/// next even power of two, which is repeated until the result is in the range (J. Black, P. Rogaway, Ciphers with
/// arbitrary finite domains, CT-RSA 2002).
fn permuted(index: u64, count: u64, key: u64) -> u64 {
    let bits = (u64::BITS - (count - 1).leading_zeros()).max(2).div_ceil(2);
    let mask = (1_u64 << bits) - 1;
    let mut place = index;
    loop {
        let (mut left, mut right) = (place >> bits, place & mask);
        for round in 0..6 {
            let turned = mixed(right ^ key ^ STRIDE.wrapping_mul(round)) & mask;
            (left, right) = (right, left ^ turned);
        }
        place = left << bits | right;
        if place < count {
            return place;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_stratum_of_a_latin_hypercube_is_met_once() {
        for count in [1, 2, 3, 5, 64, 100, 1000] {
            for dimension in [0, 1, 7] {
                let mut strata: Vec<u64> = (0..count)
                    .map(|i| latin_hypercube(i, count, dimension, 3) * count as f64)
                    .map(|x| x as u64)
                    .collect();
                strata.sort_unstable();
                assert!(strata.into_iter().eq(0..count), "{count} {dimension}");
            }
        }
    }

    /// Means, variances, and correlations between neighbours and between dimensions agree with the theoretical values of
    /// uniform random numbers, within four standard deviations.
    #[test]
    fn uniform_numbers_are_uniform_and_independent() {
        let count = 40_000;
        let centred =
            |index: u64, dimension: usize, seed: u32| uniform(index, dimension, seed) - 0.5;
        for (dimension, seed) in [(0, 0), (1, 0), (0, 1), (5, 77)] {
            let (mut mean, mut square, mut next, mut beside, mut reseeded) =
                (0.0, 0.0, 0.0, 0.0, 0.0);
            for i in 0..count {
                let x = centred(i, dimension, seed);
                mean += x;
                square += x * x;
                next += x * centred(i + 1, dimension, seed);
                beside += x * centred(i, dimension + 1, seed);
                reseeded += x * centred(i, dimension, seed + 1);
            }
            let n = count as f64;
            let bound = 4.0 / n.sqrt();
            assert!((mean / n).abs() < bound * (1.0_f64 / 12.0).sqrt());
            assert!((square / n - 1.0 / 12.0).abs() < bound * (1.0_f64 / 180.0).sqrt());
            for product in [next, beside, reseeded] {
                assert!(
                    (product / n).abs() < bound / 12.0,
                    "{dimension} {seed} {product}"
                );
            }
        }
    }

    /// The first 256 points of a sequence of 2^16 points lie in 256 different intervals of equal width. This also holds
    /// for the sequence that continues it, and the second sequence has other points.
    #[test]
    fn sobol_points_fill_strata_beyond_the_first_run_too() {
        for start in [0, 1 << 16, 5 << 16] {
            for dimension in [0, 3, 299] {
                let mut strata: Vec<u64> = (start..start + 256)
                    .map(|i| (sobol(i, dimension, 300, 1) * 256.0) as u64)
                    .collect();
                strata.sort_unstable();
                assert!(strata.into_iter().eq(0..256), "{start} {dimension}");
            }
        }
        assert_ne!(sobol(3, 0, 1, 1), sobol(3 + (1 << 16), 0, 1, 1));
    }
}
