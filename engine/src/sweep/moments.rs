//! Sums from which main effects are computed.

use super::SweepRecord;
use crate::number::Each;
use serde::{Deserialize, Serialize};

/// Largest number of levels (intervals of the range) of a variable.
const MOST_LEVELS: u64 = 32;

/// Scaling of a variable: -1 at the low end of its range, 1 at the high end. Also contains the number of levels of the
/// range.
pub(super) struct Span {
    middle: f64,
    half: f64,
    levels: usize,
}

impl Span {
    /// Returns the spans of a sweep's variables. Each range is divided into levels. For a grid, the levels are the values
    /// of the variable in the grid. If there are more than [`MOST_LEVELS`], neighbouring levels form groups. For other
    /// samples the number of levels is the cube root of the number of designs, but from 2 to [`MOST_LEVELS`]. With this
    /// choice, the error from the width of a level and the random error decrease equally fast if the number of designs
    /// grows.
    pub(super) fn all(record: &SweepRecord) -> Vec<Span> {
        let levels = (record.designs as f64).cbrt().floor() as u64;
        let span = |v: &super::VariableRecord| Span {
            middle: 0.5 * (v.low + v.high),
            half: 0.5 * (v.high - v.low),
            levels: match v.steps {
                Some(steps) => steps.min(MOST_LEVELS),
                None => levels.clamp(2, MOST_LEVELS),
            } as usize,
        };
        record.variables.iter().map(span).collect()
    }

    pub(super) fn scaled(&self, value: f64) -> f64 {
        // A variable from a file may be constant.
        if self.half > 0.0 {
            (value - self.middle) / self.half
        } else {
            0.0
        }
    }
}

fn add_to(sums: &mut [f64], others: &[f64]) {
    for (sum, other) in sums.iter_mut().zip(others) {
        *sum += other;
    }
}

/// Sums, sums of squares and sums of products of scaled variables u and shifted outputs y. u goes from -1 to 1 over a
/// variable's range. y is the difference of an output from its value in the study's own design.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Moments {
    /// Number of designs in the sums.
    pub count: u64,
    /// Sums of u, by variable.
    #[serde(with = "super::or_null")]
    pub u: Vec<f64>,
    /// Sums of u_i u_j, `[i][j]` with j <= i.
    #[serde(with = "super::or_null")]
    pub uu: Vec<f64>,
    /// Sums of y, by output.
    #[serde(with = "super::or_null")]
    pub y: Vec<f64>,
    /// Sums of y^2, by output.
    #[serde(with = "super::or_null")]
    pub yy: Vec<f64>,
    /// Sums of u y, `[variable][output]`.
    #[serde(with = "super::or_null")]
    pub uy: Vec<f64>,
}

impl Moments {
    pub(super) fn empty(record: &SweepRecord) -> Self {
        let (d, c) = (record.variables.len(), record.outputs.len());
        Moments {
            count: 0,
            u: vec![0.0; d],
            uu: vec![0.0; d * (d + 1) / 2],
            y: vec![0.0; c],
            yy: vec![0.0; c],
            uy: vec![0.0; d * c],
        }
    }

    pub(super) fn add(&mut self, scaled: &[f64], outputs: &[f64]) {
        self.count += 1;
        add_to(&mut self.u, scaled);
        add_to(&mut self.y, outputs);
        for (sum, y) in self.yy.iter_mut().zip(outputs) {
            *sum += y * y;
        }
        let mut products = self.uu.iter_mut();
        let rows = self.uy.chunks_exact_mut(outputs.len());
        for ((i, u), row) in scaled.iter().enumerate().zip(rows) {
            for (other, sum) in scaled[..=i].iter().zip(&mut products) {
                *sum += u * other;
            }
            for (sum, y) in row.iter_mut().zip(outputs) {
                *sum += u * y;
            }
        }
    }

    /// Returns true if these sums and `other` have the same dimensions.
    pub(super) fn fits(&self, other: &Self) -> bool {
        let lengths = |m: &Self| [&m.u, &m.uu, &m.y, &m.yy, &m.uy].each(Vec::len);
        lengths(self) == lengths(other)
    }

    pub(super) fn absorb(&mut self, next: &Self) {
        self.count += next.count;
        add_to(&mut self.u, &next.u);
        add_to(&mut self.uu, &next.uu);
        add_to(&mut self.y, &next.y);
        add_to(&mut self.yy, &next.yy);
        add_to(&mut self.uy, &next.uy);
    }
}

/// Sums of shifted outputs (differences from the study's own design), grouped by the level (interval of the range) of
/// each variable.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BinnedSums {
    /// Sums for each variable.
    pub of: Vec<LevelSums>,
}

/// Sums of shifted outputs and scaled variables, grouped by the level of one variable.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LevelSums {
    /// Number of designs in each level.
    pub counts: Vec<u64>,
    /// Sums of the shifted outputs, `[level][output]`.
    #[serde(with = "super::or_null")]
    pub sums: Vec<f64>,
    /// Sums of the scaled variables, `[level][variable]`.
    #[serde(with = "super::or_null")]
    pub places: Vec<f64>,
}

impl BinnedSums {
    pub(super) fn empty(record: &SweepRecord) -> Self {
        let spans = Span::all(record);
        let of = spans.iter().map(|span| LevelSums {
            counts: vec![0; span.levels],
            sums: vec![0.0; span.levels * record.outputs.len()],
            places: vec![0.0; span.levels * spans.len()],
        });
        BinnedSums { of: of.collect() }
    }

    pub(super) fn add(&mut self, scaled: &[f64], outputs: &[f64]) {
        let (width, depth) = (outputs.len(), scaled.len());
        for (level_sums, u) in self.of.iter_mut().zip(scaled) {
            let (share, levels) = (0.5 * (u + 1.0), level_sums.counts.len());
            let level = ((share * levels as f64) as usize).min(levels - 1);
            level_sums.counts[level] += 1;
            add_to(&mut level_sums.sums[level * width..][..width], outputs);
            add_to(&mut level_sums.places[level * depth..][..depth], scaled);
        }
    }

    /// Returns true if these sums and `other` have the same dimensions.
    pub(super) fn fits(&self, other: &Self) -> bool {
        let lengths = |l: &LevelSums| [l.counts.len(), l.sums.len(), l.places.len()];
        let (own, others) = (self.of.iter(), other.of.iter());
        own.map(lengths).eq(others.map(lengths))
    }

    pub(super) fn absorb(&mut self, next: &Self) {
        for (sums, other) in self.of.iter_mut().zip(&next.of) {
            for (count, other) in sums.counts.iter_mut().zip(&other.counts) {
                *count += other;
            }
            add_to(&mut sums.sums, &other.sums);
            add_to(&mut sums.places, &other.places);
        }
    }
}

/// Sums over Saltelli's groups. A group contains a design A, a design B, and then one design C for each variable: A with
/// this variable taken from B. y_A, y_B and y_C are the shifted outputs (differences from the study's own design) of
/// these designs. Groups with a design without values are left out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SaltelliSums {
    /// Number of groups in the sums.
    pub groups: u64,
    /// Sums of y_A + y_B, by output.
    #[serde(with = "super::or_null")]
    pub sum: Vec<f64>,
    /// Sums of y_A^2 + y_B^2, by output.
    #[serde(with = "super::or_null")]
    pub squares: Vec<f64>,
    /// Sums of y_C - y_A, `[variable][output]`.
    #[serde(with = "super::or_null")]
    pub steps: Vec<f64>,
    /// Sums of y_B (y_C - y_A), `[variable][output]`.
    #[serde(with = "super::or_null")]
    pub first: Vec<f64>,
    /// Sums of (y_A - y_C)^2, `[variable][output]`.
    #[serde(with = "super::or_null")]
    pub total: Vec<f64>,
    /// Shifted outputs of the designs of the present group, `[role][output]`. Empty for other methods of sampling.
    #[serde(skip)]
    group: Vec<f64>,
    #[serde(skip)]
    complete: bool,
}

impl SaltelliSums {
    pub(super) fn empty(record: &SweepRecord) -> Self {
        let [group, d, c] = match record.group() {
            Some(group) => [group as usize, record.variables.len(), record.outputs.len()],
            None => [0; 3],
        };
        SaltelliSums {
            groups: 0,
            sum: vec![0.0; c],
            squares: vec![0.0; c],
            steps: vec![0.0; d * c],
            first: vec![0.0; d * c],
            total: vec![0.0; d * c],
            group: vec![0.0; group * c],
            complete: false,
        }
    }

    /// Adds the next design. `role` is its index in its group: 0 for A, 1 for B, then one index for each C.
    pub(super) fn add(&mut self, role: usize, complete: bool, outputs: &[f64]) {
        let width = outputs.len();
        if role == 0 {
            self.complete = true;
        }
        self.complete &= complete;
        self.group[role * width..][..width].copy_from_slice(outputs);
        if (role + 1) * width < self.group.len() || !self.complete {
            return;
        }
        self.groups += 1;
        let (a, rest) = self.group.split_at(width);
        let (b, exchanged) = rest.split_at(width);
        for k in 0..width {
            self.sum[k] += a[k] + b[k];
            self.squares[k] += a[k] * a[k] + b[k] * b[k];
        }
        for (variable, c) in exchanged.chunks(width).enumerate() {
            for k in 0..width {
                let (at, step) = (variable * width + k, c[k] - a[k]);
                self.steps[at] += step;
                self.first[at] += b[k] * step;
                self.total[at] += step * step;
            }
        }
    }

    /// Returns true if these sums and `other` have the same dimensions.
    pub(super) fn fits(&self, other: &Self) -> bool {
        let lengths = |s: &Self| [&s.sum, &s.squares, &s.steps, &s.first, &s.total].each(Vec::len);
        lengths(self) == lengths(other)
    }

    pub(super) fn absorb(&mut self, next: &Self) {
        self.groups += next.groups;
        add_to(&mut self.sum, &next.sum);
        add_to(&mut self.squares, &next.squares);
        add_to(&mut self.steps, &next.steps);
        add_to(&mut self.first, &next.first);
        add_to(&mut self.total, &next.total);
    }
}
