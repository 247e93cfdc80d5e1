//! Force of a spring with its stops.

use crate::number::{Jet, MOST_LANES, Scalar, SimdReal, Valued};

/// Force as a function of the length, positive in compression.
#[derive(Clone, Debug, PartialEq)]
pub enum Law<T = f64> {
    /// Linear law: `force`, plus `rate` times the shortening of the spring.
    Linear {
        /// Force in the design position, or at [`SpringLaw::own_length`] if it is set.
        force: T,
        /// Rate: force per shortening of the spring.
        rate: T,
    },
    /// Curve through points (length, force).
    Curve(ForceCurve),
}

/// A spring with its stops. The stops act in parallel with the spring.
#[derive(Clone, Debug, PartialEq)]
pub struct SpringLaw<T = f64> {
    /// The spring.
    pub spring: Law<T>,
    /// Bump stop. The abscissa of its curve is the compression of the stop.
    pub bump_stop: Option<BumpStop>,
    /// Rebound stop. The abscissa of its curve is the deformation of the stop: the spring's extension minus the gap.
    pub rebound_stop: Option<BumpStop>,
    /// Length of the spring from which its deflection and the gaps of its stops are measured. `None` means the length
    /// in the design position: the force of a linear spring in this position then stays the same if hardpoints move. For the
    /// springs of an assembled car, this length is fixed.
    pub own_length: Option<f64>,
}

/// A stop. The field comments describe a bump stop; for a rebound stop, read extension in place of compression.
#[derive(Clone, Debug, PartialEq)]
pub struct BumpStop {
    /// Compression of the spring at which the stop is reached. It counts from the length that [`SpringLaw::own_length`]
    /// describes.
    pub gap: f64,
    /// Force as a function of the stop's compression, 0 at 0.
    pub curve: ForceCurve,
}

/// The two kinds of stops of a spring.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// Stop that limits the spring's compression.
    Bump,
    /// Stop that limits the spring's extension.
    Rebound,
}

impl Stop {
    /// Both stops.
    pub const ALL: [Self; 2] = [Stop::Bump, Stop::Rebound];

    /// Name of the stop in messages.
    pub fn name(self) -> &'static str {
        match self {
            Stop::Bump => "bump stop",
            Stop::Rebound => "rebound stop",
        }
    }
}

impl<T: Copy> SpringLaw<T> {
    /// Converts the law to another number type.
    pub fn map<U: Copy>(&self, f: impl Fn(T) -> U) -> SpringLaw<U> {
        SpringLaw {
            spring: match &self.spring {
                Law::Linear { force, rate } => Law::Linear {
                    force: f(*force),
                    rate: f(*rate),
                },
                Law::Curve(curve) => Law::Curve(curve.clone()),
            },
            bump_stop: self.bump_stop.clone(),
            rebound_stop: self.rebound_stop.clone(),
            own_length: self.own_length,
        }
    }

    /// Returns the length from which deflections are measured. `design` is the length in the design position.
    #[inline(always)]
    fn reference<U: Valued>(&self, design: U) -> U {
        self.own_length.map_or(design, |own| design.constant(own))
    }

    /// Deflection of the spring at a length, positive in compression. `design` is the length in the design position.
    #[inline(always)]
    pub(crate) fn shortened<U: Valued>(&self, length: U, design: U) -> U {
        self.reference(design) - length
    }

    /// Returns the force of the spring at a length, without the stops. `over` converts the numbers of the law to the number
    /// type of the length.
    #[inline(always)]
    fn without_stops<U: Valued>(&self, length: U, design: U, over: &impl Fn(T) -> U) -> U {
        match &self.spring {
            Law::Linear { force, rate } => {
                over(*force) + over(*rate) * self.shortened(length, design)
            }
            Law::Curve(curve) => curve.at(length),
        }
    }

    /// Returns the force of the spring with its stops at a length. `over` converts the numbers of the law to the number
    /// type of the length.
    #[inline(always)]
    fn force_over<U: Valued>(&self, length: U, design: U, over: impl Fn(T) -> U) -> U {
        let shortened = self.shortened(length, design);
        let spring = self.without_stops(length, design, &over);
        let pressed = with_stop(&self.bump_stop, spring, shortened, |force, more| {
            force + more
        });
        with_stop(&self.rebound_stop, pressed, -shortened, |force, more| {
            force - more
        })
    }
}

/// Combines the force of a stop with `force` by `add`, if the spring's change of length exceeds the gap of the stop.
/// Otherwise returns `force`.
#[inline(always)]
fn with_stop<U: Valued>(
    stop: &Option<BumpStop>,
    force: U,
    change: U,
    add: impl Fn(U, U) -> U + Copy,
) -> U {
    let Some(stop) = stop else {
        return force;
    };
    let touches = change.is_above(stop.gap);
    if !U::Plain::any(touches) {
        return force;
    }
    let pressed = stop.curve.at(change - change.constant(stop.gap));
    U::choose(touches, add(force, pressed), force)
}

impl<T: Valued> SpringLaw<T> {
    /// Force and rate (force per shortening) of the spring with its stops at a length. `design` is the length in the design
    /// position.
    #[inline(always)]
    pub(crate) fn at(&self, length: T, design: T) -> (T, T) {
        let series = Jet([length, -length.one()]);
        let force = self.force_over(series, Jet::constant(design), Jet::constant);
        (force[0], force[1])
    }
}

impl<T: Scalar> SpringLaw<T> {
    /// Returns true if a stop is in contact at a length.
    pub(crate) fn meets(&self, stop: Stop, length: T, design: T) -> bool {
        let shortened = self.shortened(length, design).value();
        let (stop, change) = match stop {
            Stop::Bump => (&self.bump_stop, shortened),
            Stop::Rebound => (&self.rebound_stop, -shortened),
        };
        stop.as_ref().is_some_and(|stop| change > stop.gap)
    }
}

impl<T: Copy> SpringLaw<T> {
    /// Rate of a linear spring, force per length. `None` for a curve.
    pub(crate) fn rate(&self) -> Option<T> {
        match self.spring {
            Law::Linear { rate, .. } => Some(rate),
            Law::Curve(_) => None,
        }
    }

    /// Sets the rate of a linear spring, and keeps the force in the design position (at [`SpringLaw::own_length`] if it is
    /// set). A curve does not change.
    pub(crate) fn set_rate(&mut self, value: T) {
        if let Law::Linear { rate, .. } = &mut self.spring {
            *rate = value;
        }
    }
}

impl SpringLaw {
    /// Force of the spring at a length, without the stops. `design` is the length in the design position.
    pub(crate) fn force_without_stops(&self, length: f64, design: f64) -> f64 {
        self.without_stops(length, design, &|number| number)
    }

    /// Force of the spring with its stops at a length. `design` is the length in the design position.
    pub fn force<T: Scalar>(&self, length: T, design: T) -> T {
        self.force_over(length, design, |c| length.constant(c))
    }

    /// Energy of the spring with its stops at a length: integral of the force over the shortening. It is zero in the design
    /// position. If [`SpringLaw::own_length`] is set, it is zero at this length.
    pub fn energy<T: Scalar>(&self, length: T, design: T) -> T {
        let reference = self.reference(design);
        let shortened = reference - length;
        let spring = match &self.spring {
            Law::Linear { force, rate } => {
                shortened * (length.constant(*force) + shortened.scaled(0.5 * rate))
            }
            Law::Curve(curve) => curve.integral(reference) - curve.integral(length),
        };
        let touched = |stop: &Option<BumpStop>, by: T| match stop {
            Some(stop) if by.value() > stop.gap => {
                let pressed = stop.curve.integral(by - by.constant(stop.gap));
                pressed - stop.curve.integral(by.zero())
            }
            _ => by.zero(),
        };
        spring + touched(&self.bump_stop, shortened) + touched(&self.rebound_stop, -shortened)
    }

    /// Returns a law with the same force-length curve for a new design. `length` is the length of the spring in the old
    /// design, to which this law belongs.
    pub fn kept_from(&self, length: f64) -> SpringLaw {
        let mut kept = self.clone();
        kept.own_length.get_or_insert(length);
        kept
    }
}

/// A smooth curve through points. It consists of cubic polynomials. The slopes make the curve monotone between neighbouring
/// points (F. N. Fritsch, R. E. Carlson, SIAM J. Numer. Anal. 17, 1980). Beyond its ends the curve is straight. The second
/// derivative jumps at the points.
#[derive(Clone, Debug, PartialEq)]
pub struct ForceCurve {
    points: Vec<[f64; 2]>,
    slopes: Vec<f64>,
}

impl ForceCurve {
    /// Makes a curve through two or more points whose abscissas increase. `None` for any other points.
    pub fn through(points: &[[f64; 2]]) -> Option<Self> {
        let rises = points.windows(2).all(|p| p[0][0] < p[1][0]);
        if points.len() < 2 || !rises {
            return None;
        }
        let secants: Vec<f64> = points
            .windows(2)
            .map(|p| (p[1][1] - p[0][1]) / (p[1][0] - p[0][0]))
            .collect();
        let last = secants.len() - 1;
        // At an inner point, the slope is the weighted harmonic mean of the neighbouring secants (Fritsch and Butland
        // 1984). The slope is 0 if the secants have different signs.
        let inside = |i: usize| {
            let (a, b) = (secants[i - 1], secants[i]);
            if a * b <= 0.0 {
                return 0.0;
            }
            let (h, k) = (
                points[i][0] - points[i - 1][0],
                points[i + 1][0] - points[i][0],
            );
            let (p, q) = (2.0 * k + h, k + 2.0 * h);
            (p + q) / (p / a + q / b)
        };
        let slopes = (0..points.len())
            .map(|i| match i {
                0 => secants[0],
                i if i == last + 1 => secants[last],
                i => inside(i),
            })
            .collect();
        Some(ForceCurve {
            points: points.to_vec(),
            slopes,
        })
    }

    /// Points of the curve: pairs of abscissa and value.
    pub fn points(&self) -> &[[f64; 2]] {
        &self.points
    }

    /// Returns the polynomial at an abscissa: the start a of its interval, the inverse 1/h of the interval's length,
    /// and its coefficients in powers of (x - a)/h. For the straight ends, h is 1.
    fn piece(&self, here: f64) -> [f64; 6] {
        let points = &self.points;
        let end = points.len() - 1;
        let straight = |i: usize| [points[i][0], 1.0, points[i][1], self.slopes[i], 0.0, 0.0];
        if here <= points[0][0] {
            return straight(0);
        }
        // The comparison is false for NaN.
        let is_inside = here < points[end][0];
        if !is_inside {
            return straight(end);
        }
        let i = points.partition_point(|p| p[0] <= here) - 1;
        let (h, [left, m, quadratic, cubic]) = self.cubic(i);
        [points[i][0], 1.0 / h, left, m, quadratic, cubic]
    }

    /// Returns the length h of interval `i`, and its Hermite cubic polynomial: the coefficients in powers of (x - a)/h.
    fn cubic(&self, i: usize) -> (f64, [f64; 4]) {
        let [[a, left], [b, right]] = [self.points[i], self.points[i + 1]];
        let h = b - a;
        let secant = right - left;
        let (m, n) = (self.slopes[i] * h, self.slopes[i + 1] * h);
        (
            h,
            [left, m, 3.0 * secant - 2.0 * m - n, m + n - 2.0 * secant],
        )
    }

    /// Value of the curve at the abscissa `x`.
    pub fn at<T: Valued>(&self, x: T) -> T {
        let [a, inverse, left, m, quadratic, cubic] = if T::IN_REGISTERS {
            self.pieces(x)
        } else {
            self.piece(x.plain_value().in_lane(0))
                .map(|c| x.constant(c))
        };
        let t = (x - a) * inverse;
        left + t * (m + t * (quadratic + t * cubic))
    }

    /// Returns the polynomials for all SIMD lanes, each in the form of [`ForceCurve::piece`].
    #[inline(always)]
    fn pieces<T: Valued>(&self, x: T) -> [T; 6] {
        let mut values = [0.0; MOST_LANES];
        x.plain_value().store(&mut values);
        let mut parts = [[0.0; MOST_LANES]; 6];
        for lane in 0..T::Plain::LANES {
            let piece = self.piece(values[lane]);
            for k in 0..6 {
                parts[k][lane] = piece[k];
            }
        }
        let mut pieces = [x; 6];
        for k in 0..6 {
            pieces[k] = x.of_plain(x.plain_value().load(&parts[k]));
        }
        pieces
    }

    /// Integral of the curve from its first point to the abscissa `x`.
    pub fn integral<T: Scalar>(&self, x: T) -> T {
        let points = &self.points;
        let end = points.len() - 1;
        let straight = |i: usize| {
            let along = x - x.constant(points[i][0]);
            along * (x.constant(points[i][1]) + along.scaled(0.5 * self.slopes[i]))
        };
        let here = x.value();
        if here <= points[0][0] {
            return straight(0);
        }
        let mut sum = 0.0;
        for i in 0..end {
            let (h, [c, m, quadratic, cubic]) = self.cubic(i);
            if here < points[i + 1][0] {
                let t = (x - x.constant(points[i][0])).scaled(1.0 / h);
                let power = t.scaled(cubic / 4.0) + t.constant(quadratic / 3.0);
                let power = t * power + t.constant(m / 2.0);
                return x.constant(sum) + (t * (t * power + t.constant(c))).scaled(h);
            }
            sum += h * (c + m / 2.0 + quadratic / 3.0 + cubic / 4.0);
        }
        x.constant(sum) + straight(end)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::Jet;

    #[test]
    fn a_curve_goes_through_its_points_smoothly() {
        let points = [[0.0, 0.0], [10.0, 200.0], [25.0, 1200.0], [30.0, 2500.0]];
        let curve = ForceCurve::through(&points).unwrap();
        for [x, y] in points {
            assert!((curve.at(x) - y).abs() < 1e-9);
            let slope = |x: f64| curve.at(Jet::<f64, 2>::variable(x))[1];
            assert!((slope(x - 1e-9) - slope(x + 1e-9)).abs() < 1e-4);
        }
        assert!(ForceCurve::through(&points[..1]).is_none());
        assert!(ForceCurve::through(&[[1.0, 0.0], [1.0, 2.0]]).is_none());
    }

    /// Between points, the curve is the Hermite cubic polynomial with the slopes of Fritsch and Butland. Beyond the
    /// ends it is straight.
    #[test]
    fn a_curve_has_the_slopes_of_fritsch_and_butland() {
        let points = [
            [-3.0, -50.0],
            [1.0, 10.0],
            [3.5, 250.0],
            [4.0, 240.0],
            [6.0, 300.0],
        ];
        let curve = ForceCurve::through(&points).unwrap();
        let secant = |i: usize| {
            let [[a, left], [b, right]] = [points[i], points[i + 1]];
            (right - left) / (b - a)
        };
        let slope = |i: usize| match i {
            0 => secant(0),
            4 => secant(3),
            // The curve has an extremum at these points, so its slope is zero.
            2 | 3 => 0.0,
            _ => {
                let (h, k) = (4.0, 2.5);
                3.0 * (h + k) / ((2.0 * k + h) / secant(0) + (k + 2.0 * h) / secant(1))
            }
        };
        for i in 0..4 {
            let [[a, left], [b, right]] = [points[i], points[i + 1]];
            let h = b - a;
            for t in [0.125, 0.5, 0.75] {
                let s = 1.0 - t;
                let ends = left * (1.0 + 2.0 * t) * s * s + right * t * t * (1.0 + 2.0 * s);
                let expected = ends + h * t * s * (s * slope(i) - t * slope(i + 1));
                let found = curve.at(a + t * h);
                assert!(
                    (found - expected).abs() < 1e-10,
                    "{i} {t}: {found} {expected}"
                );
            }
        }
        assert_eq!(curve.at(-5.0), -50.0 - 2.0 * secant(0));
        assert_eq!(curve.at(7.0), 300.0 + secant(3));
    }

    /// Linear spring with a bump stop and a rebound stop.
    fn law_with_stops() -> SpringLaw {
        SpringLaw {
            spring: Law::Linear {
                force: 3000.0,
                rate: 30.0,
            },
            bump_stop: Some(BumpStop {
                gap: 20.0,
                curve: ForceCurve::through(&[[0.0, 0.0], [10.0, 500.0]]).unwrap(),
            }),
            rebound_stop: Some(BumpStop {
                gap: 25.0,
                curve: ForceCurve::through(&[[0.0, 0.0], [5.0, 400.0]]).unwrap(),
            }),
            own_length: None,
        }
    }

    #[test]
    fn a_bump_stop_acts_beyond_its_gap() {
        let law = law_with_stops();
        assert_eq!(law.force(490.0, 500.0), 3300.0);
        assert_eq!(law.force(475.0, 500.0), 3750.0 + 250.0);
        assert_eq!(law.force(520.0, 500.0), 2400.0);
        assert_eq!(law.force(530.0, 500.0), 2100.0 - 400.0);
    }

    #[test]
    fn kept_parts_have_the_same_forces_in_every_design() {
        let law = law_with_stops();
        let kept = law.kept_from(500.0);
        for length in [535.0, 528.0, 510.0, 492.0, 475.0] {
            for design in [492.0, 500.0, 507.0] {
                assert_eq!(kept.force(length, design), law.force(length, 500.0));
                for stop in Stop::ALL {
                    assert_eq!(
                        kept.meets(stop, length, design),
                        law.meets(stop, length, 500.0)
                    );
                }
            }
        }
        // The force depends only on the length, so its derivative with respect to the design length is zero.
        let design = Jet::<f64, 2>::variable(492.0);
        assert_eq!(kept.force(Jet::constant(470.0), design)[1], 0.0);
    }
}
