//! Designs of a sweep, by their number.

use super::sequence::{latin_hypercube, sobol, uniform};
use crate::model::Frame;
use crate::number::Vector3;
use crate::study::{DesignTable, Rate, Sampled, Sampling, SweepVariable};

/// Source of the designs of a sweep: ranges of variables, or a table.
#[derive(Clone, Debug)]
pub enum Samples {
    /// Designs sampled from the ranges of variables.
    Sampled(Sampled),
    /// Designs from a file.
    Table(DesignTable),
}

impl Samples {
    /// Number of designs in the sweep.
    pub fn designs(&self) -> u64 {
        match self {
            Samples::Sampled(sampled) => sampled.designs(),
            Samples::Table(table) => table.designs(),
        }
    }

    /// Variables of the designs.
    pub fn variables(&self) -> &[SweepVariable] {
        match self {
            Samples::Sampled(sampled) => &sampled.variables,
            Samples::Table(table) => &table.variables,
        }
    }

    /// Writes the values of the variables in a design. The values depend only on the number of the design.
    pub fn values(&self, design: u64, into: &mut [f64]) {
        match self {
            Samples::Table(table) => into.copy_from_slice(table.row(design)),
            Samples::Sampled(sampled) => match sampled.method {
                Sampling::Grid => {
                    let mut rest = design;
                    for (value, variable) in into.iter_mut().zip(&sampled.variables).rev() {
                        let steps = variable.steps.unwrap_or(1);
                        *value = variable.level(rest % steps);
                        rest /= steps;
                    }
                }
                _ => {
                    for (k, value) in into.iter_mut().enumerate() {
                        let [low, high] = sampled.variables[k].range;
                        let fraction = fraction(sampled, design, k);
                        *value = (low + (high - low) * fraction).min(high);
                    }
                }
            },
        }
    }

    /// Writes the points of a design, given the values of its variables. `from` are the points of the study's design. All
    /// points are in the kernel's frame.
    pub fn place(
        &self,
        values: &[f64],
        frame: &Frame,
        from: &[Vector3<f64>],
        into: &mut [Vector3<f64>],
    ) {
        into.copy_from_slice(from);
        for (variable, value) in self.variables().iter().zip(values) {
            for m in &variable.moves {
                m.apply(frame, *value, variable.absolute, into);
            }
        }
    }
}

impl Samples {
    /// Rates of elastic parts that the sweep varies, in the order of the variables.
    pub fn rates(&self) -> impl Iterator<Item = &Rate> {
        self.variables().iter().filter_map(|v| v.rate.as_ref())
    }

    /// Appends the rates of elastic parts in a design, given the values of its variables.
    pub fn append_rates(&self, values: &[f64], into: &mut Vec<f64>) {
        let variables = self.variables().iter().zip(values);
        let rates = variables.filter_map(|(variable, value)| {
            let rate = variable.rate.as_ref()?;
            Some(rate.of_value(*value))
        });
        into.extend(rates);
    }
}

/// Returns the position of variable `k` within its range in a sampled design: 0 at the low end, 1 at the high end.
fn fraction(sampled: &Sampled, design: u64, k: usize) -> f64 {
    let (seed, count) = (sampled.seed, sampled.variables.len());
    match sampled.method {
        Sampling::Sobol => sobol(design, k, count, seed),
        Sampling::Random | Sampling::Grid => uniform(design, k, seed),
        Sampling::LatinHypercube => latin_hypercube(design, sampled.samples, k, seed),
        // A group has two samples A and B, then one design for each variable: A with this variable taken from B.
        Sampling::Saltelli => {
            let designs = count as u64 + 2;
            let (group, role) = (design / designs, design % designs);
            let from_b = role == 1 || role == k as u64 + 2;
            sobol(group, if from_b { count + k } else { k }, 2 * count, seed)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Axis, FrameConvention, PointId, Side};
    use crate::study::Move;

    fn variable(range: [f64; 2], steps: u64) -> SweepVariable {
        SweepVariable {
            name: "v".to_owned(),
            moves: Vec::new(),
            rate: None,
            absolute: false,
            range,
            steps: Some(steps),
        }
    }

    fn rows(method: Sampling, samples: u64) -> Vec<[f64; 2]> {
        let sampled = Sampled {
            method,
            samples,
            seed: 1,
            variables: vec![variable([-1.0, 1.0], 3), variable([0.0, 10.0], 2)],
        };
        let samples = Samples::Sampled(sampled);
        let row = |design| {
            let mut values = [0.0; 2];
            samples.values(design, &mut values);
            values
        };
        (0..samples.designs()).map(row).collect()
    }

    #[test]
    fn a_grid_runs_through_every_combination_the_last_variable_fastest() {
        let expected = [
            [-1.0, 0.0],
            [-1.0, 10.0],
            [0.0, 0.0],
            [0.0, 10.0],
            [1.0, 0.0],
            [1.0, 10.0],
        ];
        assert_eq!(rows(Sampling::Grid, 6), expected);
    }

    #[test]
    fn samples_keep_to_their_ranges_and_reach_across_them() {
        for method in [Sampling::LatinHypercube, Sampling::Sobol, Sampling::Random] {
            let rows = rows(method, 1000);
            for (k, [low, high]) in [[-1.0, 1.0], [0.0, 10.0]].into_iter().enumerate() {
                let column = || rows.iter().map(|row| row[k]);
                assert!(column().all(|v| (low..=high).contains(&v)));
                let width = column().fold(low, f64::max) - column().fold(high, f64::min);
                assert!(width > 0.98 * (high - low), "{method:?} {width}");
            }
        }
    }

    #[test]
    fn saltelli_exchanges_one_variable_after_the_other() {
        let rows = rows(Sampling::Saltelli, 5);
        assert_eq!(rows.len(), 20);
        for group in rows.chunks(4) {
            let [a, b, first, second] = [group[0], group[1], group[2], group[3]];
            assert_eq!((first, second), ([b[0], a[1]], [a[0], b[1]]));
            assert!(a[0] != b[0] && a[1] != b[1]);
        }
    }

    #[test]
    fn coupled_points_move_by_their_factors_in_the_axes_of_the_study() {
        let frame = Frame::new(FrameConvention::Iso8855, Side::Right);
        let m = |point, factor| Move {
            point: PointId(point),
            axis: Axis::Y,
            factor,
        };
        let mut both = variable([0.0, 1.0], 2);
        both.moves = vec![m(0, 1.0), m(1, -0.5)];
        let mut set = variable([0.0, 1.0], 2);
        (set.moves, set.absolute) = (vec![m(2, 1.0)], true);
        let samples = Samples::Sampled(Sampled {
            method: Sampling::Grid,
            samples: 4,
            seed: 1,
            variables: vec![both, set],
        });
        let from = vec![Vector3::new(1.0, 2.0, 3.0); 3];
        let mut moved = from.clone();
        samples.place(&[4.0, 7.0], &frame, &from, &mut moved);
        assert_eq!([moved[0].y, moved[1].y, moved[2].y], [-2.0, 4.0, -7.0]);
        assert_eq!((moved[0].x, moved[2].z), (1.0, 3.0));
    }
}
