//! Random numbers of builds. They depend only on the seed, the number of the build, the stream and the index of the tolerance
//! source. The only wheel of a study, each wheel of an axle, and the parts that both wheels share have separate streams.

use crate::evaluate::BLOCK;
use crate::model::Side;
use crate::study::{Law, Source, Tolerance};
use crate::sweep::uniform;

impl Law {
    /// Mean of the random number.
    pub fn mean(self) -> f64 {
        match self {
            Law::Normal { .. } => 0.0,
            Law::Uniform { low, high } => 0.5 * (low + high),
        }
    }

    /// Variance of the random number.
    pub fn variance(self) -> f64 {
        match self {
            Law::Normal { sigma } => sigma * sigma,
            Law::Uniform { low, high } => (high - low) * (high - low) / 12.0,
        }
    }

    /// Kurtosis of the random number: its fourth central moment divided by the square of its variance.
    pub fn kurtosis(self) -> f64 {
        match self {
            Law::Normal { .. } => 3.0,
            Law::Uniform { .. } => 1.8,
        }
    }

    /// Value below which a random number lies with probability `fraction`.
    pub fn quantile(self, fraction: f64) -> f64 {
        match self {
            Law::Normal { sigma } => sigma * normal_quantile(fraction),
            Law::Uniform { low, high } => low + (high - low) * fraction,
        }
    }

    /// Replaces each fraction by the quantile of the distribution.
    fn quantiles(self, fractions: &mut [f64]) {
        let Law::Normal { sigma } = self else {
            for fraction in fractions {
                *fraction = self.quantile(*fraction);
            }
            return;
        };
        // Nearly all fractions are in the central region. The formula of this region is applied to all fractions at once. The
        // other fractions are corrected afterwards.
        let mut numbers = [0.0; BLOCK];
        for (number, fraction) in numbers.iter_mut().zip(&*fractions) {
            *number = sigma * centre(fraction - 0.5);
        }
        for (fraction, number) in fractions.iter_mut().zip(numbers) {
            *fraction = if (*fraction - 0.5).abs() <= HALF_CENTRE {
                number
            } else {
                self.quantile(*fraction)
            };
        }
    }
}

impl Tolerance {
    /// Number of independent tolerance sources.
    pub fn sources(&self) -> usize {
        self.each_source().count()
    }

    /// All tolerance sources, contributor by contributor.
    pub(super) fn each_source(&self) -> impl Iterator<Item = &Source> {
        self.scatter.iter().flat_map(|c| &c.sources)
    }

    /// Tolerance sources, each with its random stream and its index in the stream. Each wheel of an axle and the shared parts
    /// have separate streams, so contributors of one stream do not change the random numbers of another stream. If only shared
    /// parts scatter, they use the stream of a single wheel.
    fn streams(&self) -> impl Iterator<Item = (&Source, Stream, usize)> {
        let mut counts = [0; 3];
        let is_of_axle = self.each_source().any(|source| source.side.is_some());
        self.each_source().map(move |source| {
            let count = &mut counts[source.side.map_or(2, |side| side as usize)];
            *count += 1;
            let stream = match source.side {
                Some(side) => Stream::OfSide(side),
                None if is_of_axle => Stream::Shared,
                None => Stream::Only,
            };
            (source, stream, *count - 1)
        })
    }

    /// Writes the random numbers of a build, one for each tolerance source.
    pub fn draw(&self, build: u64, into: &mut [f64]) {
        for (number, (source, stream, k)) in into.iter_mut().zip(self.streams()) {
            *number = source.law.quantile(self.fraction(build, stream, k));
        }
    }

    /// Writes the random numbers of a block of builds from number `first` on, `[tolerance source][build]`. They equal the
    /// numbers of [`Tolerance::draw`]. Numbers of builds beyond the first `count` are 0.
    pub(super) fn draw_block(&self, first: u64, count: usize, into: &mut [f64]) {
        let rows = into.chunks_exact_mut(BLOCK);
        for (row, (source, stream, k)) in rows.zip(self.streams()) {
            let (row, rest) = row.split_at_mut(count);
            for (place, number) in row.iter_mut().enumerate() {
                *number = self.fraction(first + place as u64, stream, k);
            }
            source.law.quantiles(row);
            rest.fill(0.0);
        }
    }

    #[inline]
    fn fraction(&self, build: u64, stream: Stream, source: usize) -> f64 {
        let index = match stream {
            Stream::Only => build,
            Stream::OfSide(side) => 2 * build + side as u64,
            // Streams of wheels use the indices from 0 on. So the stream of shared parts counts down from the largest index.
            Stream::Shared => u64::MAX - build,
        };
        middle(uniform(index, source, self.seed))
    }
}

/// Stream of random numbers.
#[derive(Clone, Copy)]
enum Stream {
    /// Parts of a study without parts of a left or right wheel.
    Only,
    /// Parts of one wheel of an axle.
    OfSide(Side),
    /// Parts that both wheels of an axle share.
    Shared,
}

/// Middle of one of 2^53 intervals of the fractions from 0 to 1, rounded. It is never 0 and never 1.
#[inline]
pub(super) fn middle(fraction: f64) -> f64 {
    (fraction + 0.5_f64.powi(54)).min(1.0 - 0.5_f64.powi(53))
}

/// Standard normal quantile of a fraction in (0, 1), with a relative error of about 1e-15 (M. J. Wichura, Algorithm AS 241:
/// The percentage points of the normal distribution, Applied Statistics 37, 1988, routine PPND16).
pub fn normal_quantile(fraction: f64) -> f64 {
    let q = fraction - 0.5;
    if q.abs() <= HALF_CENTRE {
        return centre(q);
    }
    let tail = fraction.min(1.0 - fraction);
    let r = (-tail.ln()).sqrt();
    let value = if r <= 5.0 {
        ratio(r - 1.6, &FLANK)
    } else {
        ratio(r - 5.0, &TAIL)
    };
    value.copysign(q)
}

/// Half the width of the central region, which is the range of fractions around 0.5. The approximation in this region needs no
/// logarithm.
const HALF_CENTRE: f64 = 0.425;

#[inline]
fn centre(q: f64) -> f64 {
    q * ratio(0.180625 - q * q, &CENTRE)
}

/// Quotient of two polynomials of `x`. `above` and `below` are their coefficients, from the lowest power on.
#[inline]
fn ratio(x: f64, [above, below]: &[[f64; 8]; 2]) -> f64 {
    let horner = |c: &[f64; 8]| c.iter().rev().fold(0.0, |sum, c| sum * x + c);
    horner(above) / horner(below)
}

const CENTRE: [[f64; 8]; 2] = [
    [
        3.387_132_872_796_366_5,
        1.331_416_678_917_843_8e2,
        1.971_590_950_306_551_3e3,
        1.373_169_376_550_946e4,
        4.592_195_393_154_987e4,
        6.726_577_092_700_87e4,
        3.343_057_558_358_813e4,
        2.509_080_928_730_122_7e3,
    ],
    [
        1.0,
        4.231_333_070_160_091e1,
        6.871_870_074_920_579e2,
        5.394_196_021_424_751e3,
        2.121_379_430_158_66e4,
        3.930_789_580_009_271e4,
        2.872_908_573_572_194_3e4,
        5.226_495_278_852_854e3,
    ],
];

const FLANK: [[f64; 8]; 2] = [
    [
        1.423_437_110_749_683_5,
        4.630_337_846_156_546,
        5.769_497_221_460_691,
        3.647_848_324_763_204_5,
        1.270_458_252_452_368_4,
        2.417_807_251_774_506e-1,
        2.272_384_498_926_918_4e-2,
        7.745_450_142_783_414e-4,
    ],
    [
        1.0,
        2.053_191_626_637_759,
        1.676_384_830_183_803_8,
        6.897_673_349_851e-1,
        1.481_039_764_274_800_8e-1,
        1.519_866_656_361_645_7e-2,
        5.475_938_084_995_345e-4,
        1.050_750_071_644_416_9e-9,
    ],
];

const TAIL: [[f64; 8]; 2] = [
    [
        6.657_904_643_501_103,
        5.463_784_911_164_114,
        1.784_826_539_917_291_3,
        2.965_605_718_285_048_7e-1,
        2.653_218_952_657_612_4e-2,
        1.242_660_947_388_078_4e-3,
        2.711_555_568_743_487_6e-5,
        2.010_334_399_292_288_1e-7,
    ],
    [
        1.0,
        5.998_322_065_558_88e-1,
        1.369_298_809_227_358e-1,
        1.487_536_129_085_061_5e-2,
        7.868_691_311_456_133e-4,
        1.846_318_317_510_054_8e-5,
        1.421_511_758_316_446e-7,
        2.044_263_103_389_939_8e-15,
    ],
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::Contributor;

    /// The random numbers of a block equal the numbers of its single builds bit for bit. The test covers both distributions,
    /// and tolerance sources of one wheel and of both wheels.
    #[test]
    fn draws_by_the_block_are_those_by_the_build() {
        let source = |law: Law, side: Option<Side>| Source {
            name: String::new(),
            changes: Vec::new(),
            rate: None,
            law,
            side,
            seen_from_other: Vec::new(),
        };
        let normal = Law::Normal { sigma: 0.7 };
        let uniform = Law::Uniform {
            low: -2.0,
            high: 1.0,
        };
        let sources = [normal, uniform].into_iter().flat_map(|law| {
            let sides = [None, Some(Side::Left), Some(Side::Right)];
            sides.map(|side| source(law, side))
        });
        let tolerance = Tolerance {
            builds: 100,
            seed: 5,
            aligned: false,
            scatter: vec![Contributor {
                name: String::new(),
                sources: sources.collect(),
            }],
            bands: Vec::new(),
        };
        let mut block = vec![1.0; tolerance.sources() * BLOCK];
        tolerance.draw_block(1000, 100, &mut block);
        let mut draws = vec![0.0; tolerance.sources()];
        for place in 0..100 {
            tolerance.draw(1000 + place as u64, &mut draws);
            for (source, draw) in draws.iter().enumerate() {
                assert_eq!(block[source * BLOCK + place].to_bits(), draw.to_bits());
            }
        }
        assert!(block[100..BLOCK].iter().all(|z| *z == 0.0));
    }

    /// The parts that both wheels share have other random numbers than each wheel, in every build. If no part belongs to one wheel,
    /// a study has the same random numbers as a study of one wheel.
    #[test]
    fn shared_parts_have_a_separate_stream() {
        let source = |side: Option<Side>| Source {
            name: String::new(),
            changes: Vec::new(),
            rate: None,
            law: Law::Uniform {
                low: 0.0,
                high: 1.0,
            },
            side,
            seen_from_other: Vec::new(),
        };
        let draws = |sides: &[Option<Side>]| {
            let tolerance = Tolerance {
                builds: 50,
                seed: 5,
                aligned: false,
                scatter: vec![Contributor {
                    name: String::new(),
                    sources: sides.iter().copied().map(source).collect(),
                }],
                bands: Vec::new(),
            };
            let mut numbers = vec![0.0; sides.len()];
            let mut all = Vec::new();
            for build in 0..50 {
                tolerance.draw(build, &mut numbers);
                all.extend(numbers.iter().map(|number| number.to_bits()));
            }
            all
        };
        let mut all = draws(&[None, Some(Side::Left), Some(Side::Right)]);
        let of_wheels: Vec<u64> = all.chunks(3).flat_map(|own| own[1..].to_vec()).collect();
        assert_eq!(of_wheels, draws(&[Some(Side::Left), Some(Side::Right)]));
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), 150);
        let alone = draws(&[None]);
        assert_eq!(alone[7], middle(uniform(7, 0, 5)).to_bits());
    }

    /// The largest and the smallest random number have finite quantiles.
    #[test]
    fn every_random_number_has_a_quantile() {
        let largest = 1.0 - 0.5_f64.powi(53);
        for fraction in [0.0, 0.5, largest] {
            assert!(
                (Law::Normal { sigma: 1.0 })
                    .quantile(middle(fraction))
                    .is_finite()
            );
        }
        assert_eq!(middle(largest), largest);
    }

    /// The integral of the normal density between two quantiles equals the difference of their fractions.
    #[test]
    fn quantiles_are_those_of_the_normal_law() {
        let density = |x: f64| (-0.5 * x * x).exp() / (2.0 * std::f64::consts::PI).sqrt();
        let fractions = [
            1e-12, 1e-9, 1e-5, 0.01, 0.074, 0.076, 0.3, 0.5, 0.8, 0.924, 0.926, 0.999,
        ];
        for pair in fractions.windows(2) {
            let [a, b] = [pair[0], pair[1]].map(normal_quantile);
            let n = 20_000;
            let h = (b - a) / f64::from(n);
            let inner: f64 = (0..n)
                .map(|i| {
                    let x = a + h * f64::from(i);
                    // Gauss-Legendre rule with three points.
                    let node = 0.5 * (0.6_f64).sqrt() * h;
                    let middle = x + 0.5 * h;
                    h * (8.0 * density(middle)
                        + 5.0 * (density(middle - node) + density(middle + node)))
                        / 18.0
                })
                .sum();
            let expected = pair[1] - pair[0];
            assert!((inner - expected).abs() < 2e-13 * expected, "{pair:?}");
        }
        assert_eq!(normal_quantile(0.5), 0.0);
        assert!((normal_quantile(0.975) - 1.959_963_984_540_054).abs() < 1e-14);
    }
}
