//! Curves interpolated between few exact poses: effect of the number of poses and of the interpolation.

use super::poses::lagrange;
use super::subject::Subject;
use super::{Clock, Family, Measurement, Unmeasurable, worse};
use crate::DoubleDouble;
use hardpoint_engine::mechanism::Pose;
use hardpoint_engine::number::Scalar;
use hardpoint_engine::solve::{Solver, StationOrder};
use std::f64::consts::PI;

/// Number of points at which an interpolated curve is compared with the exact one.
const READ: usize = 161;

/// Numbers of stations between which curves are interpolated.
const STATIONS: [usize; 10] = [3, 5, 7, 9, 13, 17, 25, 33, 65, 129];

/// Method of interpolation between stations.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Between {
    /// Straight lines between evenly spaced stations.
    Linear,
    /// Cubic through the four nearest of evenly spaced stations; a parabola if there are only three stations.
    Cubic,
    /// Polynomial through stations at Chebyshev points.
    Chebyshev,
}

impl Between {
    fn name(self) -> &'static str {
        ["linear", "cubic", "Chebyshev"][self as usize]
    }

    /// Stations in a range, including both ends.
    fn stations(self, count: usize, [low, high]: [f64; 2]) -> Vec<f64> {
        let last = (count - 1) as f64;
        let share = |i: usize| match self {
            Between::Linear | Between::Cubic => i as f64 / last,
            Between::Chebyshev => 0.5 - 0.5 * (PI * i as f64 / last).cos(),
        };
        (0..count).map(|i| low + (high - low) * share(i)).collect()
    }

    /// Returns the first of the consecutive stations that give the value at `x`, and their weights.
    fn weights(self, stations: &[f64], x: f64) -> (usize, Vec<f64>) {
        let count = stations.len();
        let width = match self {
            Between::Linear => 2,
            Between::Cubic => 4.min(count),
            Between::Chebyshev => count,
        };
        let interval = stations.partition_point(|s| *s <= x).clamp(1, count - 1) - 1;
        let first = (interval + 1).saturating_sub(width / 2).min(count - width);
        if self == Between::Chebyshev {
            return (0, barycentric(stations, x));
        }
        let near = &stations[first..first + width];
        (first, (0..width).map(|i| lagrange(near, i, x)).collect())
    }
}

/// Barycentric weights of the polynomial through Chebyshev points of the second kind (J.-P. Berrut, L. N. Trefethen, Barycentric
/// Lagrange interpolation, SIAM Review 46, 2004).
fn barycentric(nodes: &[f64], x: f64) -> Vec<f64> {
    if let Some(hit) = nodes.iter().position(|n| *n == x) {
        return (0..nodes.len()).map(|i| f64::from(i == hit)).collect();
    }
    let last = nodes.len() - 1;
    let terms = nodes.iter().enumerate().map(|(i, node)| {
        let sign = if i % 2 == 0 { 1.0 } else { -1.0 };
        let half = if i == 0 || i == last { 0.5 } else { 1.0 };
        sign * half / (x - node)
    });
    let terms: Vec<f64> = terms.collect();
    let sum: f64 = terms.iter().sum();
    terms.into_iter().map(|t| t / sum).collect()
}

/// Measures all interpolations. The time is the time per point of the interpolated curve.
pub(super) fn measure(
    subject: &Subject<'_>,
    clock: &Clock,
) -> Result<Vec<Measurement>, Unmeasurable> {
    let suspension = subject.suspension;
    let range = [
        subject.travels[0],
        subject.travels[subject.travels.len() - 1],
    ];
    let read = Between::Linear.stations(READ, range);
    let exact: Vec<_> = (subject.exact(&read)?.iter())
        .map(|(travel, pose)| (*travel, subject.camber_of(pose)))
        .collect();
    let mut solver = Solver::new(&suspension.mechanism, &suspension.design)?;
    let mut found = Vec::new();
    for between in [Between::Linear, Between::Cubic, Between::Chebyshev] {
        for count in STATIONS {
            // A Chebyshev polynomial reaches full accuracy with at most 33 points. So it is not measured with more points.
            if between == Between::Chebyshev && count > 33 {
                continue;
            }
            let stations = between.stations(count, range);
            let weights: Vec<_> = exact
                .iter()
                .map(|(travel, _)| between.weights(&stations, *travel))
                .collect();
            let station_order = StationOrder::through(&stations);
            let mut solved = vec![f64::NAN; count];
            let mut curve = vec![f64::NAN; exact.len()];
            let mut draw = |curve: &mut [f64]| {
                let take = |_: &Solver<'_>, station: usize, pose: Result<&Pose<f64>, _>| {
                    solved[station] = pose.map_or(f64::NAN, |pose| subject.camber_at(pose));
                };
                let visited = subject.for_each_pose(&mut solver, &station_order, take);
                visited.expect("the design was solved before");
                for (value, (first, weights)) in curve.iter_mut().zip(&weights) {
                    let near = solved[*first..].iter().zip(weights);
                    *value = near.map(|(v, w)| v * w).sum();
                }
            };
            draw(&mut curve);
            let errors = curve.iter().zip(&exact).map(|(value, (_, exact))| {
                let missed = *exact + DoubleDouble::from(-*value);
                missed.value().abs().to_degrees()
            });
            let error = errors.fold(0.0, worse);
            let time = clock.time(exact.len(), || draw(&mut curve));
            found.push(Measurement {
                family: Family::Curve,
                method: between.name().to_owned(),
                setting: format!("{count} stations"),
                time,
                error,
                evaluations: Some(count as f64 / exact.len() as f64),
            });
        }
    }
    Ok(found)
}
