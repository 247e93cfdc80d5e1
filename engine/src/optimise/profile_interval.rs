//! Confidence interval of a variable of a fit, with all variables within their ranges.
//!
//! The measurements are y = f(x0) + e, with normal errors e of one unknown variance. The true values x0 are assumed to lie
//! **within the ranges**, l <= x0 <= u. If x0 were outside, no interval within the ranges could contain it. r(x) are the
//! residuals of the fit. S is the smallest sum of squares of r, reached at x^. s^2 is the variance of a residual. The
//! smallest sum of squares for a value c of variable j is its *profile*, and T measures how much worse the fit is with this
//! value c:
//!
//! ```text
//! S_j(c) = min { |r(x)|^2 : l <= x <= u, x_j = c }                                         (1)
//! T_j(c) = (S_j(c) - S) / (k_j s^2)                                                        (2)
//! ```
//!
//! k_j corrects for the weights of the residuals (see [`StandardErrors`](super::StandardErrors)); without weights it is 1.
//! The interval contains all c with
//!
//! ```text
//! T_j(c) <= q_j(c)^2                                                                       (3)
//! ```
//!
//! The other variables move within their ranges in (1). So a variable that ended at its bound is not treated as known: its
//! error widens the intervals of the other variables. If no bound is near, T_j is the square of Student's t with the
//! degrees of freedom of s^2. Then q is the 97.5 % quantile of t, and (3) is the usual interval of linear regression.
//!
//! Near a bound of x_j itself, T is smaller than t^2, since x^_j cannot follow the errors across the bound. Let d be the
//! distance from c to the bound in standard deviations. If an error t would carry the estimate beyond the bound (t > d), the
//! estimate stays at the bound, and T is only t^2 - (t - d)^2 = d (2 t - d). Hence
//!
//! ```text
//! P(T > q^2, errors towards this bound) = P(t > q)                    if q <= d
//!                                       = P(t > (q^2 + d^2) / (2 d))  if q > d             (4)
//! P of the lower bound + P of the upper bound = 5 %                   defines q_j(c)       (5)
//! ```
//!
//! Thus q is the two-sided quantile (97.5 %) far from the bounds, and the one-sided quantile (95 %) at a bound. The interval
//! passes smoothly from two-sided to one-sided. If the choice between the two were made after looking at the data, the
//! interval would contain the truth less often (G. J. Feldman, R. D. Cousins, Unified approach to the classical statistical
//! analysis of small signals, Physical Review D 57, 1998). With x(c) the minimiser of (1), the distance also respects the
//! ranges of the other variables:
//!
//! ```text
//! d^2 = min { |J (x - x(c))|^2 : l <= x <= u, x_j = the bound } / (k_j s^2)                (6)
//! ```
//!
//! (5) is exact for a linear fit in which only x_j can reach a bound. Bounds of the other variables make T a mixture of
//! chi-squares whose weights depend on the unknown x0 (S. G. Self, K.-Y. Liang, Asymptotic properties of maximum likelihood
//! estimators and likelihood ratio tests under nonstandard conditions, J. Am. Stat. Assoc. 82, 1987). So the code also
//! simulates T: it fits the linear model to random errors about x(c), from a fixed seed
//! ([`SimulatedFits`](super::simulated_fits::SimulatedFits)). The simulation uses x(c) in place of x0, so its q may be too
//! small. Equation (5) ignores the bounds of the other variables, so its q may also be too small. The method takes the larger
//! q. If no variable has a bound within four standard errors, q is the two-sided quantile without (5) or simulation.
//!
//! For a linear r, (1) is a bounded linear least-squares problem, convex and piecewise quadratic in c. A bracketing search
//! finds the end of the interval (3). Then the true r and its Jacobian are evaluated at the point x(c) of that end. The
//! search is repeated until the end no longer moves. At this end, (1) holds for the true r. The end may not settle within
//! the allowed number of evaluations, or residuals may not exist. Then the code uses the end of the range instead. This
//! choice is safe, because x0 lies within the ranges by assumption.

use super::profile::Profile;
use super::simulated_fits::SimulatedFits;
use super::student::{Student, root};
use super::{Bounds, Linearisation};
use nalgebra::DVector;

/// Probability that the interval does not contain the true value.
const OUTSIDE: f64 = 0.05;
/// Largest number of evaluations for each end of an interval.
const EVALUATIONS: usize = 6;
/// Movement of an end of the interval, as a share of its distance from the estimate, below which this end has settled.
const AT_REST: f64 = 0.01;
/// Width of an interval, as a share of the range, above which the variable counts as not determined.
const NEARLY_ALL: f64 = 0.95;
/// Number of rounds that settle an end of the interval together with its quantile.
const SETTLING: usize = 2;
/// Distance, in standard errors, up to which a bound changes the distribution of T (equation (2) of this module).
const IN_REACH: f64 = 4.0;
/// Smallest scatter of the measurements, in multiples of the tolerance. Smaller values are rounding errors.
const RESOLUTION: f64 = 1e-9;

/// Set of values of a variable that agree with the measurements, with 95 % confidence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ConfidenceInterval {
    /// The variable is between its bounds. One end of the interval may be an end of its range.
    TwoSided {
        /// Lowest value of the interval, in the variable's unit.
        lower: f64,
        /// Highest value of the interval, in the variable's unit.
        upper: f64,
    },
    /// The variable is at its lower bound. Its true value is at most this value.
    AtMost(f64),
    /// The variable is at its upper bound. Its true value is at least this value.
    AtLeast(f64),
    /// Nearly all values of the range agree with the measurements, or the variable does not affect the measured values.
    NotDetermined,
}

/// A fit whose intervals are computed.
pub(super) struct Solved<'a> {
    pub x: &'a DVector<f64>,
    pub at: &'a Linearisation,
    pub bounds: &'a Bounds,
    /// Student's distribution with the degrees of freedom of the fit.
    pub student: Student,
    /// Standard error of each variable, with all variables free. `None` for an unknown error.
    pub errors: &'a [Option<f64>],
    pub simulated: SimulatedFits<'a>,
}

/// Writes the residuals of a point. Returns true if the point has residuals.
type Evaluate<'e> = dyn FnMut(&DVector<f64>, &mut Linearisation) -> bool + 'e;

impl Solved<'_> {
    /// Interval of a variable by equation (3) of this module. `scale` contains s, the standard deviation of a residual, and
    /// the root of k_j, the correction for weights.
    pub(super) fn interval(
        &self,
        variable: usize,
        scale: [f64; 2],
        evaluate: &mut Evaluate<'_>,
    ) -> ConfidenceInterval {
        let [low, high] = [self.bounds.lower(), self.bounds.upper()].map(|bound| bound[variable]);
        let value = self.x[variable];
        let mut end = |bound: f64| {
            if value == bound {
                return bound;
            }
            let end = self.end(variable, bound, scale, evaluate);
            end.unwrap_or(bound)
        };
        let (lower, upper) = (end(low), end(high));
        if upper - lower >= NEARLY_ALL * (high - low) {
            ConfidenceInterval::NotDetermined
        } else if value <= low {
            ConfidenceInterval::AtMost(upper)
        } else if value >= high {
            ConfidenceInterval::AtLeast(lower)
        } else {
            ConfidenceInterval::TwoSided { lower, upper }
        }
    }

    /// End of the interval on the side of `bound`. `None` if the interval includes the bound, or if no end is found.
    fn end(
        &self,
        variable: usize,
        bound: f64,
        [scatter, ratio]: [f64; 2],
        evaluate: &mut Evaluate<'_>,
    ) -> Option<f64> {
        let from = self.x[variable];
        let deviation = ratio * scatter.max(RESOLUTION);
        let least = self.at.residuals.norm_squared();
        let level = |quantile: f64| least + (quantile * deviation).powi(2);
        // The search first uses the linear model to find the quantile of Student's distribution that belongs to this end.
        // This model needs no evaluations.
        let linear = Profile::new(self.x, self.at, self.bounds, variable);
        let mut quantile = self.student.quantile(0.5 * OUTSIDE);
        for _ in 0..SETTLING {
            let found = linear.end(from, bound, level(quantile));
            let x = found.map_or_else(|| linear.point(bound), |(_, x)| x);
            quantile = self.quantile(variable, &x, deviation, ratio);
        }
        let (mut end, mut x) = linear.end(from, bound, level(quantile))?;
        let mut at = self.at.clone();
        for _ in 0..EVALUATIONS {
            if !evaluate(&x, &mut at) {
                return None;
            }
            let model = Profile::new(&x, &at, self.bounds, variable);
            let (next, place) = model.end(from, bound, level(quantile))?;
            if (next - end).abs() <= AT_REST * (next - from).abs() {
                return Some(next);
            }
            (end, x) = (next, place);
        }
        None
    }

    /// Quantile q of equation (3) of this module for the value that a variable has in `x`. The other variables of `x`
    /// minimise the sum of squares of equation (1).
    fn quantile(&self, variable: usize, x: &DVector<f64>, deviation: f64, ratio: f64) -> f64 {
        let bounds = [self.bounds.lower(), self.bounds.upper()];
        let is_near = |at: &DVector<f64>, j: usize| {
            let room = bounds.map(|bound| (bound[j] - at[j]).abs());
            let error = self.errors[j].unwrap_or(f64::INFINITY);
            room[0].min(room[1]) < IN_REACH * error
        };
        let is_near = |j: usize| is_near(x, j) || is_near(self.x, j);
        if !(0..x.len()).any(is_near) {
            return self.student.quantile(0.5 * OUTSIDE);
        }
        let profile = Profile::new(x, self.at, self.bounds, variable);
        let distances = bounds.map(|bound| profile.distance(bound[variable]) / deviation);
        let alone = threshold(&self.student, distances);
        let scatter = deviation / ratio;
        let simulated = self.simulated.quantile(variable, x, scatter, 1.0 - OUTSIDE);
        alone.max(simulated / ratio)
    }
}

/// Quantile q of equation (5) of this module for a value with these distances to its lower and upper bound. The distances
/// are in standard deviations.
fn threshold(student: &Student, distances: [f64; 2]) -> f64 {
    let two_sided = student.quantile(0.5 * OUTSIDE);
    if distances.iter().all(|d| *d >= two_sided) {
        return two_sided;
    }
    let tail = |q: f64, d: f64| {
        if q <= d {
            student.tail(q)
        } else if d > 0.0 {
            student.tail((q * q + d * d) / (2.0 * d))
        } else {
            0.0
        }
    };
    let outside = |q: f64| distances.iter().map(|d| tail(q, *d)).sum::<f64>();
    root(0.0, two_sided, |q| outside(q) > OUTSIDE)
}
