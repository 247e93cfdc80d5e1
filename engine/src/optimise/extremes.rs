//! Extremes between stations, so that constraints also hold between the stations.
//!
//! If the value at a station is above the values at both neighbours, or below both, an extreme lies nearby. The search begins
//! at the extreme of the parabola through the three values, and uses the value's derivative with respect to the drive value
//! (the travel or the arm angle). At an end of the motion the search uses the parabola through the last three values. The
//! extreme of this parabola must lie within the motion. The row of the station then holds the value at the extreme. So limits
//! hold at all extremes that the values at the stations show. At an extreme the value has zero slope along the drive value.
//! So the slopes of the row do not need the derivative of the extreme's position. While the design changes, an extreme may
//! move past a station. When the extreme is halfway between two stations, the row of the other station takes over the value at
//! this extreme. So the largest row stays continuous.

use super::Linearisation;
use super::layout::{Extremes, Leg, Part};

/// Largest number of steps in a search. A smooth extreme takes three or four steps. At the extreme, the value can also have
/// a kink, or a jump of its second derivative. For example, the nearest face of a box can change there. Such a search
/// bisects.
pub(super) const SEARCHES: usize = 32;
/// Tolerance for the position of an extreme, as a share of the distance between stations. The error of the value is
/// proportional to the square of the position error.
const PLACED: f64 = 1e-9;
/// Smallest rise of an extreme above the value at the station that counts as a separate extreme, in the unit of the rows.
/// This is a hundredth of the largest violation that still counts as satisfied.
const FLAT: f64 = 1e-9;
/// Distance of a row below its limit, in the unit of the rows, above which a tuning skips the search for an extreme. Before
/// this comparison, the code adds four times the rise of the fitted parabola to the value of the row.
pub(super) const FAR: f64 = 1.0;

/// Search for the position of an extreme between stations, where the value's slope along the motion vanishes.
pub(super) struct Search {
    /// Index of the searched limit among [`Leg::extremes`]. A leg is a motion at one rack displacement.
    pub of: usize,
    /// Constraint row that receives the value at the extreme.
    pub row: usize,
    /// Value of this row at the station.
    pub at_station: f64,
    /// Drive value of the next evaluation.
    pub place: f64,
    /// True if the search has ended.
    pub is_found: bool,
    /// Interval of drive values that contains the extreme. Each step moves one end to the position of the step.
    ends: [f64; 2],
    /// Length of this interval at the start of the search.
    span: f64,
    /// Drive value of the latest step, and slope of the searched value there.
    before: Option<(f64, f64)>,
    /// Estimate of the value's second derivative along the motion: first from the parabola through three stations, then
    /// from two slopes.
    curvature: f64,
    /// Rise of the parabola's extreme above the station's value.
    rise: f64,
}

/// Writes into `into` the searches that a leg (a motion at one rack displacement) needs for extremes between stations. The
/// function uses the values of the constraint parts and the rows of the constraints at the stations. It leaves out rows that
/// are farther than `far` below their limit.
pub(super) fn searches(
    leg: &Leg,
    parts: &[Part],
    values: &[Vec<f64>],
    (rows, far): (&Linearisation, f64),
    into: &mut Vec<Search>,
) {
    into.clear();
    for (of, extremes) in leg.extremes.iter().enumerate() {
        let Extremes {
            part,
            sign,
            rows: places,
        } = extremes;
        let scale = sign / parts[*part].limited.scale;
        let at = |k: usize| {
            let station = places[k].0;
            (leg.order.values()[station], values[*part][station])
        };
        for (k, (_, row)) in places.iter().enumerate() {
            let Some(mut search) = Search::about(k, places.len(), at, *sign) else {
                continue;
            };
            let (rise, here) = (search.rise * scale, rows.residuals[*row]);
            if rise > FLAT && here + 4.0 * rise > -far {
                (search.of, search.row, search.at_station) = (of, *row, here);
                into.push(search);
            }
        }
    }
}

impl Search {
    /// Begins a search from the parabola through station `k` and its neighbours. `sign` is 1 for a largest value and -1 for
    /// a smallest value. `None` if there are fewer than three stations. Also `None` if a neighbour has a larger (or
    /// smaller) value, or if the parabola has no extreme near the station.
    fn about(k: usize, count: usize, at: impl Fn(usize) -> (f64, f64), sign: f64) -> Option<Self> {
        let first = k.checked_sub(1);
        let beyond = |other: usize| sign * at(other).1 > sign * at(k).1;
        if count < 3 || first.is_some_and(beyond) || (k + 1 < count && beyond(k + 1)) {
            return None;
        }
        let from = first.unwrap_or(0).min(count - 3);
        let [(x0, y0), (x1, y1), (x2, y2)] = [at(from), at(from + 1), at(from + 2)];
        let (left, right) = ((y1 - y0) / (x1 - x0), (y2 - y1) / (x2 - x1));
        let curvature = 2.0 * (right - left) / (x2 - x0);
        let slope = (left * (x2 - x1) + right * (x1 - x0)) / (x2 - x0);
        let place = x1 - slope / curvature;
        let ends = [
            first.map_or(at(k).0, |before| at(before).0),
            if k + 1 < count { at(k + 1).0 } else { at(k).0 },
        ];
        // If the three values lie on a line, or if the extreme of the parabola lies outside the motion, there is no
        // extreme.
        if sign * curvature.signum() > 0.0 || !(ends[0]..=ends[1]).contains(&place) {
            return None;
        }
        let away = place - at(k).0;
        Some(Search {
            of: 0,
            row: 0,
            at_station: 0.0,
            place,
            is_found: false,
            ends,
            span: ends[1] - ends[0],
            before: None,
            curvature,
            rise: -0.5 * curvature * away * away,
        })
    }

    /// Makes a step with the slope at the current position. The step stays within the interval of the extreme: if the secant
    /// leaves the interval, the step goes to its middle. Returns true if the current position was close enough to the
    /// extreme, or if no further step is possible.
    pub(super) fn advance(&mut self, slope: f64) -> bool {
        if let Some((place, before)) = self.before
            && place != self.place
        {
            let secant = (slope - before) / (self.place - place);
            if secant * self.curvature > 0.0 {
                self.curvature = secant;
            }
        }
        let step = -slope / self.curvature;
        let close = PLACED * self.span;
        if !step.is_finite() || step.abs() <= close {
            return true;
        }
        // The curvature keeps its sign. So the extreme lies on the side of the step.
        self.ends[usize::from(step < 0.0)] = self.place;
        let [low, high] = self.ends;
        if high - low <= close {
            return true;
        }
        self.before = Some((self.place, slope));
        let next = self.place + step;
        self.place = if low < next && next < high {
            next
        } else {
            0.5 * (low + high)
        };
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Searches the minimum of a function that is known at three stations. `f` returns value and slope.
    fn minimum(stations: [f64; 3], f: impl Fn(f64) -> (f64, f64)) -> f64 {
        let at = |k: usize| (stations[k], f(stations[k]).0);
        let mut search = Search::about(1, 3, at, -1.0).unwrap();
        for _ in 0..SEARCHES {
            if search.advance(f(search.place).1) {
                break;
            }
        }
        search.place
    }

    /// The distance from a box has a jump of its second derivative where the nearest face changes. The parabola through the
    /// stations then has its extreme on the wrong side of the middle station.
    #[test]
    fn a_jump_of_the_second_derivative_does_not_mislead_the_search() {
        let f = |x: f64| {
            let (steep, flat) = (x.min(6.0) - 6.0, x - 5.8);
            (
                0.05 * steep * steep + 0.0005 * flat * flat,
                0.1 * steep + 0.001 * flat,
            )
        };
        let found = minimum([0.0, 10.0, 20.0], f);
        let exact = (0.1 * 6.0 + 0.001 * 5.8) / 0.101;
        assert!((found - exact).abs() < 1e-3, "{found} {exact}");
        assert!(f(found).0 - f(exact).0 < 1e-9);
    }

    /// In the middle of a box, the distance of a point from the box has a kink. The search finds it.
    #[test]
    fn the_search_finds_a_kink() {
        let f = |x: f64| {
            if x < 9.3 {
                (9.3 - x, -1.0)
            } else {
                (0.9 * (x - 9.3), 0.9)
            }
        };
        let found = minimum([0.0, 10.0, 20.0], f);
        assert!((found - 9.3).abs() < 1e-6, "{found}");
    }
}
