//! Arc sine and arc tangent with elementary arithmetic. The results are bit-identical in all lanes and on every platform, and
//! take a fraction of the time of a mathematical library. Results for a plain `f64` can differ from results in lanes in the
//! last digit, because lanes round products with sums once.
//!
//! atan t = t + t u P(u) for |t| <= tan(pi/8), asin x = x + x u Q(u) for |x| <= 1/2, with u the square of the argument. P
//! and Q interpolate at Chebyshev points. Their coefficients were computed with sixty digits, then rounded to doubles.
//! Their relative errors are 8e-18 and 5e-18, so the only significant error is the rounding of two sums. For other
//! arguments:
//!
//! ```text
//! atan t = pi/4 + atan (t-1)/(t+1)            tan(pi/8) < t <= 1
//! atan t = pi/2 - atan 1/t                    1 < t
//! asin x = pi/2 - 2 asin sqrt((1-x)/2)        1/2 < x <= 1
//! ```

use super::{Outlined, SimdReal};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

const ATAN: [f64; 11] = [
    -0.3333333333333333,
    0.19999999999995516,
    -0.14285714284665682,
    0.11111111015187018,
    -0.0909090457530649,
    0.07692183125376892,
    -0.06664510525508936,
    0.05858140904866328,
    -0.050854078345894844,
    0.03923044778479309,
    -0.019175404711104935,
];

const ASIN: [f64; 13] = [
    0.16666666666666669,
    0.07499999999998433,
    0.04464285714635543,
    0.030381944138531247,
    0.02237217294214989,
    0.017352392720869973,
    0.013971212973552933,
    0.011479177415184906,
    0.01032281435018578,
    0.005457506718640358,
    0.01740087944269402,
    -0.014851887071247204,
    0.028757851367421566,
];

/// tan(pi/8).
const TAN_EIGHTH: f64 = 0.41421356237309503;
/// Difference between pi/2 and its nearest double.
const FRAC_PI_2_REST: f64 = 6.123233995736766e-17;
/// Difference between pi/4 and its nearest double.
const FRAC_PI_4_REST: f64 = 0.5 * FRAC_PI_2_REST;

/// Odd polynomial x + x u (c0 + c1 u + ...), u = x^2. Separate sums of even and odd coefficients halve the latency.
#[inline(always)]
fn odd<B: SimdReal, const N: usize>(x: B, coefficients: &[f64; N]) -> B {
    let u = x * x;
    let v = u * u;
    let (mut last, mut before) = (
        x.constant(coefficients[N - 1]),
        x.constant(coefficients[N - 2]),
    );
    let mut k = N - 2;
    while k >= 2 {
        last = x.constant(coefficients[k - 1]).plus_product(last, v);
        before = x.constant(coefficients[k - 2]).plus_product(before, v);
        k -= 2;
    }
    // If the number of coefficients is odd, the last coefficient has no partner.
    let (even, odd) = if k == 1 {
        (x.constant(coefficients[0]).plus_product(last, v), before)
    } else {
        (before, last)
    };
    x.plus_product(x, u * even.plus_product(odd, u))
}

/// Arc sine. NaN outside [-1, 1].
#[inline(always)]
pub(super) fn asin<B: SimdReal>(x: B) -> B {
    let size = x.abs();
    let beyond = x.constant(0.5).less(size);
    if B::all(!beyond) {
        return odd(x, &ASIN);
    }
    x.outlined(AnyArc(x))
}

/// Arc sine of any argument, as a separate function. Small arguments are more frequent and do not need this function.
struct AnyArc<B>(B);

impl<B: SimdReal> Outlined for AnyArc<B> {
    const IS_SMALL: bool = true;
    type Output = B;
    #[inline(always)]
    fn work(self) -> B {
        let x = self.0;
        let size = x.abs();
        let beyond = x.constant(0.5).less(size);
        let half = x.constant(0.5);
        let root = (half - half * size).sqrt();
        let arc = odd(B::select(beyond, root, size), &ASIN);
        let far = x.constant(FRAC_PI_2) - (arc + arc - x.constant(FRAC_PI_2_REST));
        B::select(beyond, far, arc).copysign(x)
    }
}

/// Angle of the vector (x, y) from the x-axis. 0 for the zero vector.
#[inline(always)]
pub(super) fn atan2<B: SimdReal>(y: B, x: B) -> B {
    if B::all(y.abs().less(x * x.constant(TAN_EIGHTH))) {
        return odd(y / x, &ATAN);
    }
    x.outlined(AnyAngle { y, x })
}

/// Angle of any vector, as a separate function. Small angles are more frequent and do not need this function.
struct AnyAngle<B> {
    y: B,
    x: B,
}

impl<B: SimdReal> Outlined for AnyAngle<B> {
    const IS_SMALL: bool = true;
    type Output = B;
    #[inline(always)]
    fn work(self) -> B {
        let AnyAngle { y, x } = self;
        let (height, width) = (y.abs(), x.abs());
        let flat = x.constant(TAN_EIGHTH);
        let steep = width.less(height);
        let (small, large) = (
            B::select(steep, width, height),
            B::select(steep, height, width),
        );
        let near_diagonal = !small.less(large * flat);
        let numerator = B::select(near_diagonal, small - large, small);
        let denominator = B::select(near_diagonal, small + large, large);
        let zero = x.zero();
        let denominator = B::select(zero.less(denominator), denominator, x.one());
        let arc = odd(numerator / denominator, &ATAN);
        let arc = B::select(
            near_diagonal & zero.less(large),
            x.constant(FRAC_PI_4) + (arc + x.constant(FRAC_PI_4_REST)),
            arc,
        );
        let arc = B::select(
            steep,
            x.constant(FRAC_PI_2) - (arc - x.constant(FRAC_PI_2_REST)),
            arc,
        );
        let behind = x.constant(PI) - (arc - x.constant(2.0 * FRAC_PI_2_REST));
        B::select(x.less(zero), behind, arc).copysign(y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::{SimdTask, Width, run_one};

    /// Difference from the platform's library, in units of the last place. The library itself is accurate to one unit.
    fn apart(computed: f64, library: f64) -> f64 {
        let unit = library.abs().next_up() - library.abs();
        (computed - library).abs() / unit
    }

    fn arguments() -> impl Iterator<Item = f64> {
        (-4000..=4000).map(|k| f64::from(k) * 2.5e-4 + 1e-7 * f64::from(k % 7))
    }

    #[test]
    fn the_library_agrees_to_two_units_in_the_last_place() {
        for x in arguments().filter(|x| x.abs() <= 1.0) {
            let (own, library) = (asin(x), x.asin());
            assert!(
                x == 0.0 || apart(own, library) <= 2.0,
                "asin {x}: {own} {library}"
            );
        }
        for k in 0..20_000 {
            let angle = f64::from(k) * 3.14e-4 - PI + 1e-5;
            let size = 1.0 + f64::from(k % 17);
            let (y, x) = (size * angle.sin(), size * angle.cos());
            let (own, library) = (atan2(y, x), y.atan2(x));
            assert!(apart(own, library) <= 2.0, "atan2 {y} {x}: {own} {library}");
        }
    }

    #[test]
    fn axes_diagonals_and_nothing() {
        for (y, x) in [
            (0.0, 1.0),
            (1.0, 0.0),
            (-1.0, 0.0),
            (0.0, -1.0),
            (1.0, 1.0),
            (-3.0, 3.0),
            (-2.0, -2.0),
            (0.0, 0.0),
        ] {
            assert_eq!(atan2::<f64>(y, x), f64::atan2(y, x), "{y} {x}");
        }
        assert_eq!(asin(1.0), FRAC_PI_2);
        assert_eq!(asin(-1.0), -FRAC_PI_2);
        assert!(asin(1.0 + f64::EPSILON).is_nan() && asin(f64::NAN).is_nan());
        assert!(atan2(f64::NAN, 1.0).is_nan() && atan2(1.0, f64::NAN).is_nan());
    }

    struct Arcs<'a>(&'a [f64], &'a mut [f64]);

    impl SimdTask for Arcs<'_> {
        type Output = ();
        #[inline(always)]
        fn run<B: SimdReal>(self, like: B) {
            for (from, to) in self
                .0
                .chunks_exact(B::LANES)
                .zip(self.1.chunks_exact_mut(B::LANES))
            {
                let x = like.load(from);
                (asin(x) + atan2(x, x.squared() - x.constant(0.3))).store(to);
            }
        }
    }

    /// The numbers in the other lanes decide which branch of the code runs. But they do not change the result of a lane by
    /// a single bit.
    #[test]
    fn every_width_yields_the_same_bits() {
        let within = arguments().filter(|x| x.abs() <= 1.0);
        let x: Vec<f64> = within.take(7984).collect();
        let mut expected = vec![0.0; x.len()];
        run_one(Arcs(&x, &mut expected));
        for width in Width::available() {
            let mut found = vec![0.0; x.len()];
            width.run(Arcs(&x, &mut found));
            assert_eq!(found, expected, "{}", width.name());
        }
    }
}
