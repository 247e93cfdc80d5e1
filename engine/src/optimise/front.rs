//! Trade-off between goals: the Pareto front of two or three goals, and the price list (misfit against size of the design change).
//!
//! A design is on the *Pareto front* (here: front) of some criteria f_1, f_2, ... if no other design within ranges and
//! constraints is better in one criterion and no worse in the others. The front consists of minima of one criterion with bounds
//! on the others (Y. Haimes, L. Lasdon, D. Wismer, On a bicriterion formulation of the problems of integrated system
//! identification and system optimization, IEEE Trans. Systems, Man, Cybernetics 1, 1971):
//!
//! ```text
//! minimise f_g(x)   subject to   f_h(x) <= level_h,  h != g,  and the constraints            (1)
//! ```
//!
//! This method also reaches concave parts of the front, where no weighted sum has a minimum. For two criteria, the search
//! first finds the two ends of the front. At an end, one criterion has its least value, and the other criterion is as low as
//! this value allows. Then the search halves the widest gap. It limits one criterion to the middle of the gap, in the
//! direction in which the gap is wider. Starting from the points on either side, it lowers the other criterion. If this finds
//! no design that is better than a known point, no design lies in that part, and the gap shrinks. In this way the search
//! detects a front with gaps. For three criteria the limits form a grid, and the search lowers each criterion in turn. It
//! keeps the points that are farthest apart.
//!
//! The residuals of criterion h have the norm r_h = u_h f_h, with a constant factor u_h. Problem (1) minimises and limits
//! r_h^2 / 2. With the multipliers L_h of its limits,
//!
//! ```text
//! sum_h m_h df_h = 0 along the front,   m_g = u_g^2 f_g,   m_h = L_h u_h^2 f_h                (2)
//! ```
//!
//! The values m, scaled to a sum of 1, are the weights of the criteria at that point. If criterion 1 falls by one tolerance,
//! criterion 2 rises by m_1/m_2 tolerances.

use super::constrained::{Assessment, Constrained, constrained_fit};
use super::nearest::NEAR_LEVEL;
use super::trade::{ConstrainedTrade, Criterion, Distance};
use super::{Bounds, Control, Options};
use crate::sorting::sort_by;
use nalgebra::DVector;
use rayon::prelude::*;

/// Largest number of points of a Pareto front.
const POINTS: usize = 50;
/// Largest number of halved gaps for each point of a Pareto front of two criteria. Every gap without a point is also halved
/// several times. Each time needs two minimisations of equation (1) of this module.
const EFFORT: usize = 3;
/// Number of equal intervals into which the levels divide the range of a limited criterion, for a Pareto front of three criteria.
const LEVELS: usize = 6;
/// A criterion counts as equally low if it is at most this multiple of its least value. A limit at exactly the least value
/// would leave no freedom to lower the other criteria: no neighbouring design satisfies such a limit.
const AS_LOW: f64 = 1.0001;
/// Smallest limit (level) of a criterion.
const LEAST_LEVEL: f64 = 1e-6;
/// Smallest improvement that counts, as a share of the extent of the Pareto front.
const NO_BETTER: f64 = 1e-4;

/// A design that is optimal under given limits (levels) of the other criteria.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Found {
    pub x: DVector<f64>,
    /// Value of each criterion at this design.
    pub amounts: Vec<f64>,
    /// Weight of each criterion by equation (2) of this module. All are zero if there is no trade-off.
    pub weights: Vec<f64>,
}

/// A traced Pareto front.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Traced {
    /// Points in the order of rising value of the first criterion.
    pub points: Vec<Found>,
    /// Indices of the points after which a Pareto front of two criteria has a gap.
    pub breaks: Vec<usize>,
}

/// Lowers one criterion of a problem at a time, with limits on the others.
pub(super) struct Tracer<'a, F> {
    pub problem: F,
    pub bounds: &'a Bounds,
    pub distance: &'a Distance<'a>,
    pub aims: Vec<Criterion>,
    /// Further criteria that every minimisation limits, each with its upper limit.
    pub rest: Vec<(Criterion, f64)>,
    pub options: &'a Options,
    pub control: Control<'a>,
}

impl<P: Constrained, F: Fn() -> P + Sync> Tracer<'_, F> {
    /// Finds the least value of a criterion with limits on the others, from several starts. `None` if no start ends with the
    /// levels and constraints satisfied.
    pub(super) fn lower(
        &self,
        aim: usize,
        held: &[(usize, f64)],
        starts: &[&DVector<f64>],
    ) -> Option<Found> {
        let run = |start: &&DVector<f64>| self.lower_from(aim, held, start);
        let found: Vec<Option<Found>> = starts.par_iter().map(run).collect();
        let found = found.into_iter().flatten();
        found.min_by(|a, b| a.amounts[aim].total_cmp(&b.amounts[aim]))
    }

    /// Lowers a criterion from one start. A step that exceeds a level by far can lead to a region of the variables without
    /// feasible designs, so the run refuses such steps.
    fn lower_from(&self, aim: usize, held: &[(usize, f64)], start: &DVector<f64>) -> Option<Found> {
        let own = held.iter().map(|(h, level)| (&self.aims[*h], *level));
        let rest = self.rest.iter().map(|(rest, level)| (rest, *level));
        let levels = own.chain(rest).collect();
        let trade = ConstrainedTrade::new((self.problem)(), self.distance, &self.aims[aim], levels);
        let control = Control {
            watch: None,
            ..self.control
        };
        let options = Options {
            violation_below: NEAR_LEVEL,
            ..self.options.clone()
        };
        let fit = constrained_fit(0, trade, self.bounds, start, &options, control).ok()?;
        if !fit.is_feasible() {
            return None;
        }
        let amount = |aim: usize, norm: f64| norm / self.aims[aim].unit;
        let mut amounts = vec![f64::NAN; self.aims.len()];
        amounts[aim] = amount(aim, fit.at.goal.residuals.norm());
        let mut weights = vec![0.0; self.aims.len()];
        let weight = |aim: usize, amount: f64| self.aims[aim].unit.powi(2) * amount;
        weights[aim] = weight(aim, amounts[aim]);
        for (k, (h, _)) in held.iter().enumerate() {
            amounts[*h] = amount(*h, fit.at.levels[k].residuals.norm());
            weights[*h] = fit.level_multipliers[k] * weight(*h, amounts[*h]);
        }
        if amounts.iter().any(|a| a.is_nan()) {
            amounts = self.amounts(&fit.x)?;
        }
        let sum: f64 = weights.iter().sum();
        for weight in &mut weights {
            *weight = if sum > 0.0 { *weight / sum } else { 0.0 };
        }
        Some(Found {
            x: fit.x,
            amounts,
            weights,
        })
    }

    /// Values of all criteria at `x`.
    pub(super) fn amounts(&self, x: &DVector<f64>) -> Option<Vec<f64>> {
        let mut problem = (self.problem)();
        let mut at = Assessment::new(&problem.shape());
        problem.assess(x, &mut at).ok()?;
        let amount = |aim: &Criterion| match aim.rows() {
            None => self.distance.of(x),
            Some(rows) => {
                let squares = rows.iter().map(|row| at.goal.residuals[*row].powi(2));
                squares.sum::<f64>().sqrt() / aim.unit
            }
        };
        Some(self.aims.iter().map(amount).collect())
    }

    /// Traces the Pareto front, starting from these designs. Criterion values below `good` count as equal.
    pub(super) fn front(&self, starts: &[&DVector<f64>], good: f64) -> Traced {
        let all: Vec<usize> = (0..self.aims.len()).collect();
        let ends: Vec<Found> = orders(&all)
            .into_iter()
            .filter_map(|order| self.end(&order, starts, good))
            .collect();
        if self.aims.len() == 2 {
            self.front_of_two(ends, good)
        } else {
            let points = self.front_of_many(ends);
            Traced {
                points,
                breaks: Vec::new(),
            }
        }
    }

    /// Finds an end of the Pareto front: lowers the criteria one after the other, and limits each of them to the value reached.
    fn end(&self, order: &[usize], starts: &[&DVector<f64>], good: f64) -> Option<Found> {
        let mut held: Vec<(usize, f64)> = Vec::new();
        let mut found: Option<Found> = None;
        for aim in order {
            let from: Vec<&DVector<f64>> = match &found {
                None => starts.to_vec(),
                Some(found) => vec![&found.x],
            };
            let Some(next) = self.lower(*aim, &held, &from) else {
                // No start satisfies the limits. The previous result then counts as the end of the Pareto front, though it
                // may be inexact.
                break;
            };
            held.push((
                *aim,
                (AS_LOW * next.amounts[*aim]).max(good).max(LEAST_LEVEL),
            ));
            found = Some(next);
        }
        found
    }

    /// Repeatedly halves the widest gap in a Pareto front of two criteria.
    fn front_of_two(&self, ends: Vec<Found>, good: f64) -> Traced {
        let [first, last] = &ends[..] else {
            return Traced {
                points: ends,
                breaks: Vec::new(),
            };
        };
        let extent = [
            last.amounts[0] - first.amounts[0],
            first.amounts[1] - last.amounts[1],
        ];
        if let Some(end) = single_end([first, last], good) {
            return Traced {
                points: vec![end.clone()],
                breaks: Vec::new(),
            };
        }
        let mut points = ends;
        let mut gaps = vec![Gap::between(&points, 0, 1)];
        let narrow = 0.25 / POINTS as f64;
        for _ in 0..EFFORT * POINTS {
            let wide = |gap: &Gap| gap.width(extent);
            let widest = (0..gaps.len()).max_by(|a, b| wide(&gaps[*a]).total_cmp(&wide(&gaps[*b])));
            let Some(widest) = widest else { break };
            if points.len() >= POINTS
                || wide(&gaps[widest]) < narrow
                || self.control.is_interrupted()
            {
                break;
            }
            let mut gap = gaps.swap_remove(widest);
            let held = gap.wider(extent);
            let lowered = 1 - held;
            let level = gap.middle(held);
            let from = [&points[gap.ends[0]].x, &points[gap.ends[1]].x];
            // This end of the gap already satisfies the level. A new point must be better than this end.
            let has = &points[gap.ends[held]].amounts;
            let found = self
                .lower(lowered, &[(held, level)], &from)
                .filter(|found| {
                    found.amounts[lowered] < has[lowered] - NO_BETTER * extent[lowered]
                });
            let Some(found) = found else {
                gap.low[held] = level;
                gaps.push(gap);
                continue;
            };
            let slack = found.amounts[held] < level;
            let new = points.len();
            points.push(found);
            let mut parts = [
                Gap::between(&points, gap.ends[0], new),
                Gap::between(&points, new, gap.ends[1]),
            ];
            if slack {
                // The Pareto front has no design between the found point and the level.
                parts[1 - held].low[held] = level;
            }
            gaps.extend(parts);
        }
        // Width of the widest interval between neighbouring points that the search has not examined. If two points are much
        // farther apart than this, the search found no design between them.
        let unknown = gaps.iter().map(|gap| gap.width(extent)).fold(0.0, f64::max);
        let mut kept: Vec<usize> = best_of(&points);
        sort_by(&mut kept, |a, b| {
            points[*a].amounts[0].total_cmp(&points[*b].amounts[0])
        });
        let is_break = |pair: &[usize]| {
            let apart = Gap::between(&points, pair[0], pair[1]).width(extent);
            apart > (2.0 * unknown).max(2.0 / POINTS as f64)
        };
        let pairs = kept.windows(2).enumerate();
        Traced {
            breaks: pairs
                .filter(|(_, pair)| is_break(pair))
                .map(|(k, _)| k)
                .collect(),
            points: kept.iter().map(|k| points[*k].clone()).collect(),
        }
    }

    /// Lowers each criterion in turn over a grid of levels (limits of the other criteria). Keeps the points farthest apart.
    fn front_of_many(&self, ends: Vec<Found>) -> Vec<Found> {
        let count = self.aims.len();
        if ends.len() < 2 {
            return ends;
        }
        let range = |aim: usize| {
            let amounts = || ends.iter().map(move |end| end.amounts[aim]);
            let (low, high) = (
                amounts().fold(f64::INFINITY, f64::min),
                amounts().fold(0.0, f64::max),
            );
            [low, high]
        };
        let ranges: Vec<[f64; 2]> = (0..count).map(range).collect();
        // Each point of a grid row starts from its neighbour in the row. The grid rows do not depend on one another.
        let rows: Vec<(usize, usize)> = (0..count)
            .flat_map(|lowered| (1..LEVELS).map(move |row| (lowered, row)))
            .collect();
        let level = |aim: usize, step: usize| {
            let [low, high] = ranges[aim];
            low + (high - low) * step as f64 / LEVELS as f64
        };
        let row = |(lowered, row): &(usize, usize)| {
            let others: Vec<usize> = (0..count).filter(|aim| aim != lowered).collect();
            let mut found: Vec<Found> = Vec::new();
            for step in (1..LEVELS).rev() {
                if self.control.is_interrupted() {
                    break;
                }
                let held = [
                    (others[0], level(others[0], *row)),
                    (others[1], level(others[1], step)),
                ];
                let before = found.last().map(|before| &before.x);
                let starts: Vec<&DVector<f64>> = match before {
                    Some(before) => vec![before],
                    None => ends.iter().map(|end| &end.x).collect(),
                };
                found.extend(self.lower(*lowered, &held, &starts));
            }
            found
        };
        let mut points: Vec<Found> = rows.par_iter().map(row).flatten().collect();
        points.extend(ends.iter().cloned());
        let best: Vec<Found> = best_of(&points)
            .into_iter()
            .map(|k| points[k].clone())
            .collect();
        let mut kept = farthest_apart(best, &ranges);
        sort_by(&mut kept, |a, b| {
            let order = a
                .amounts
                .iter()
                .zip(&b.amounts)
                .map(|(a, b)| a.total_cmp(b));
            order.fold(std::cmp::Ordering::Equal, std::cmp::Ordering::then)
        });
        kept
    }

    /// Least values of the first criterion for `steps` rising limits of the second criterion. The limits rise from the value
    /// at the given design to the value at the design with the least first criterion.
    pub(super) fn list(
        &self,
        from: &DVector<f64>,
        start: &DVector<f64>,
        steps: usize,
    ) -> Vec<Found> {
        let Some(last) = self.lower(0, &[], &[start]) else {
            return Vec::new();
        };
        let most = last.amounts[1];
        let mut found: Vec<Found> = Vec::new();
        for step in 1..steps {
            if self.control.is_interrupted() {
                break;
            }
            let level = most * step as f64 / steps as f64;
            let before = found.last().map_or(from, |f| &f.x);
            // The second start lies on the line from the given design to the last design of the list, at the fraction `step /
            // steps`.
            let ahead = from + (&last.x - from) * (step as f64 / steps as f64);
            found.extend(self.lower(0, &[(1, level)], &[before, &ahead]));
        }
        found.push(last);
        // Steps without a gain are left out.
        let mut least = f64::INFINITY;
        found.retain(|step| {
            let buys = step.amounts[0] < least;
            least = least.min(step.amounts[0]);
            buys
        });
        found
    }
}

/// Returns the only point of the Pareto front, if one criterion is equally good at both ends. Criterion values below `good`
/// count as equal. The returned end is the one that is better in the other criterion.
fn single_end([first, last]: [&Found; 2], good: f64) -> Option<&Found> {
    let same = |low: f64, high: f64| high.max(good) - low.max(good) <= NO_BETTER * high.max(good);
    if same(first.amounts[0], last.amounts[0]) {
        Some(last)
    } else if same(last.amounts[1], first.amounts[1]) {
        Some(first)
    } else {
        None
    }
}

/// A gap between two points of a Pareto front of two criteria that may contain further points.
#[derive(Clone, Debug)]
struct Gap {
    /// Indices of the points at the ends of the gap: first the point with the lower first criterion, then the point with
    /// the lower second criterion.
    ends: [usize; 2],
    low: [f64; 2],
    high: [f64; 2],
}

impl Gap {
    fn between(points: &[Found], first: usize, second: usize) -> Self {
        let (a, b) = (&points[first].amounts, &points[second].amounts);
        Gap {
            ends: [first, second],
            low: [a[0], b[1]],
            high: [b[0], a[1]],
        }
    }

    /// Extent of the gap in each criterion, as shares of the extent of the Pareto front.
    fn sides(&self, extent: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k| (self.high[k] - self.low[k]) / extent[k])
    }

    /// Criterion in which the gap is wider.
    fn wider(&self, extent: [f64; 2]) -> usize {
        let [first, second] = self.sides(extent);
        usize::from(second > first)
    }

    /// Width of the gap. Zero if one of its ends is better than the other.
    fn width(&self, extent: [f64; 2]) -> f64 {
        let [first, second] = self.sides(extent);
        if first.min(second) > 0.0 {
            first.max(second)
        } else {
            0.0
        }
    }

    fn middle(&self, aim: usize) -> f64 {
        0.5 * (self.low[aim] + self.high[aim])
    }
}

/// Selects the points for which no other point is better in one criterion and no worse in the others. Keeps only the first of
/// several equal points.
fn best_of(points: &[Found]) -> Vec<usize> {
    let no_worse = |a: &Found, b: &Found| a.amounts.iter().zip(&b.amounts).all(|(a, b)| a <= b);
    let is_best = |k: &usize| {
        !points.iter().enumerate().any(|(other, point)| {
            let same = point.amounts == points[*k].amounts;
            no_worse(point, &points[*k]) && (!same || other < *k)
        })
    };
    (0..points.len()).filter(is_best).collect()
}

/// Selects at most [`POINTS`] points, each as far as possible from the points selected before it.
fn farthest_apart(points: Vec<Found>, ranges: &[[f64; 2]]) -> Vec<Found> {
    let between = |a: &Found, b: &Found| {
        let parts = a.amounts.iter().zip(&b.amounts).zip(ranges);
        let squares =
            parts.map(|((a, b), [low, high])| ((a - b) / (high - low).max(1e-300)).powi(2));
        squares.sum::<f64>()
    };
    let mut rest = points;
    let mut kept: Vec<Found> = Vec::new();
    while kept.len() < POINTS && !rest.is_empty() {
        let apart = |k: &usize| {
            let distances = kept.iter().map(|other| between(&rest[*k], other));
            distances.fold(f64::INFINITY, f64::min)
        };
        let next = (0..rest.len()).max_by(|a, b| apart(a).total_cmp(&apart(b)).then(b.cmp(a)));
        let Some(next) = next else { break };
        // All remaining points are within a thousandth of the ranges from a selected point. A diagram could not show the
        // difference.
        if apart(&next) < 1e-6 {
            break;
        }
        kept.push(rest.swap_remove(next));
    }
    kept
}

/// All permutations of the criteria.
fn orders(aims: &[usize]) -> Vec<Vec<usize>> {
    if aims.is_empty() {
        return vec![Vec::new()];
    }
    let mut all = Vec::new();
    for (place, aim) in aims.iter().enumerate() {
        let rest: Vec<usize> = [&aims[..place], &aims[place + 1..]].concat();
        for mut order in orders(&rest) {
            order.insert(0, *aim);
            all.push(order);
        }
    }
    all
}

#[cfg(test)]
mod tests;
