//! Measured points of a curve, as a function of the drive value.

use crate::sorting::sort_by;

/// Largest number of passes of a hysteresis loop.
const MOST_PASSES: usize = 8;

/// Converts measured points to a function of the drive value, sorted by drive value. For a hysteresis loop, the function is the
/// mean of the rising and the falling branch. It then covers only the range that both branches share. Values at the same drive
/// value are averaged, too.
pub(super) fn function(points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    let mut sorted = mean_of_branches(&points).unwrap_or(points);
    sort_by(&mut sorted, |a, b| a[0].total_cmp(&b[0]));
    let same = sorted.chunk_by(|a, b| a[0] == b[0]);
    same.map(|at| {
        let sum: f64 = at.iter().map(|p| p[1]).sum();
        [at[0][0], sum / at.len() as f64]
    })
    .collect()
}

/// Mean of the branches of a hysteresis loop, at the drive values that both branches have. `None` if the points are no loop.
///
/// A loop may start anywhere, so a branch may have several passes. A loop has few passes and no step over more than half of the
/// range, and its branches share more than half of the range. Otherwise the points are only unsorted.
fn mean_of_branches(points: &[[f64; 2]]) -> Option<Vec<[f64; 2]>> {
    let ways = ways(points);
    let half = 0.5 * length(points);
    let mut steps = points.windows(2).map(|p| (p[1][0] - p[0][0]).abs());
    if ways.len() > MOST_PASSES || steps.any(|step| step > half) {
        return None;
    }
    let both = points.iter().filter_map(|[x, _]| {
        let [rising, falling] = [true, false].map(|is_rising| branch(&ways, is_rising, *x));
        Some([*x, 0.5 * (rising? + falling?)])
    });
    let both: Vec<[f64; 2]> = both.collect();
    (length(&both) > half).then_some(both)
}

/// Length of the range of drive values.
fn length(points: &[[f64; 2]]) -> f64 {
    let drives = points.iter().map(|p| p[0]);
    let [lowest, highest] = drives.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
        [low.min(x), high.max(x)]
    });
    highest - lowest
}

/// Value of a branch at a drive value: the mean of its passes there. `None` if no pass has this drive value.
fn branch(ways: &[Way], is_rising: bool, x: f64) -> Option<f64> {
    let of_branch = ways.iter().filter(|way| way.is_rising == is_rising);
    let there = of_branch.filter(|way| way.has(x));
    let values: Vec<f64> = there.map(|way| way.at(x)).collect();
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// A pass of a curve in one direction of the drive value.
struct Way {
    is_rising: bool,
    /// Points of the pass, at least two, sorted by drive value.
    points: Vec<[f64; 2]>,
}

impl Way {
    /// Returns true if the pass has this drive value, or passes it.
    fn has(&self, x: f64) -> bool {
        self.points[0][0] <= x && x <= self.points[self.points.len() - 1][0]
    }

    /// Value at a drive value of the pass, interpolated linearly.
    fn at(&self, x: f64) -> f64 {
        let points = &self.points;
        let right = points.partition_point(|p| p[0] <= x);
        let right = right.clamp(1, points.len() - 1);
        let ([x0, y0], [x1, y1]) = (points[right - 1], points[right]);
        y0 + (y1 - y0) * (x - x0) / (x1 - x0)
    }
}

/// Splits the points into passes. Points that do not move are no pass.
fn ways(points: &[[f64; 2]]) -> Vec<Way> {
    let mut ways = Vec::new();
    let mut begin = 0;
    let mut rising = None;
    for k in 1..=points.len() {
        let step = points.get(k).map(|p| p[0] - points[k - 1][0]);
        let turns = match (step, rising) {
            (None, _) => true,
            (Some(step), Some(rising)) => step != 0.0 && (step > 0.0) != rising,
            _ => false,
        };
        if turns {
            let mut way = points[begin..k].to_vec();
            if rising == Some(false) {
                way.reverse();
            }
            way.dedup_by(|a, b| a[0] == b[0]);
            ways.extend(rising.map(|is_rising| Way {
                is_rising,
                points: way,
            }));
            begin = k - 1;
            rising = None;
        }
        if let (Some(step), None) = (step, rising)
            && step != 0.0
        {
            rising = Some(step > 0.0);
        }
    }
    ways
}
