//! Rounds hardpoints to a grid with the smallest increase of the misfit.
//!
//! Let r be the residuals of a study's targets, in tolerances ([`Objective`]), and J their derivatives with respect to all coordinates. Let d
//! be the moves that round the coordinates, in steps g of the grid. Then the residuals after rounding are
//!
//! ```text
//! r + g J d,   d = k - x/g,   k integers
//! ```
//!
//! So the best rounding is the lattice point g J k nearest to a given point. Only free coordinates move; the others keep their
//! digits.
//!
//! The method is *nearest plane* (L. Babai, On Lovász' lattice reduction and the nearest lattice point problem, Combinatorica 6,
//! 1986). It rounds the coordinates one after the other. With g J = Q R it rounds the last coordinate, passes the resulting
//! change on to the other coordinates, and continues back to the first one. A weak spring (rows s I below g J) keeps coordinates
//! that no target depends on near their original values. Each coordinate goes to one of its two neighbours on the grid, so a
//! coordinate on the grid stays.
//!
//! The result depends on the order of the coordinates. The program tries three orders and also ordinary rounding, and computes
//! the misfit of each exactly.

use crate::model::LengthUnit;
use crate::number::Vector3;
use crate::optimise::{Linearisation, TargetLayout, evaluated};
use crate::study::{Optimise, Study, Variable};
use nalgebra::{DMatrix, DVector};

/// Stiffness of the spring against moves that leave the targets unchanged, in tolerances per step.
const SPRING: f64 = 1e-3;

/// A rounded design.
#[derive(Clone, Debug)]
pub struct Rounded {
    /// Points in the kernel's frame and the study's unit.
    pub design: Vec<Vector3<f64>>,
    /// Points in the study's axes, with exactly the digits of the grid's unit.
    pub coordinates: Vec<[f64; 3]>,
    /// Grid of the coordinates.
    pub grid: Grid,
    /// Change of the misfit by rounding, if the study has targets.
    pub loss: Option<Loss>,
}

/// Misfits in tolerances. `None` if a design cannot be solved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loss {
    /// Misfit of the design before rounding.
    pub exact: f64,
    /// Misfit if each coordinate is rounded to its nearest multiple.
    pub ordinary: Option<f64>,
    /// Misfit of the chosen rounding.
    pub best: f64,
    /// Number of coordinates that the chosen rounding does not round to the nearest multiple.
    pub otherwise: usize,
}

/// Rounds the free coordinates of a study's design to multiples of a grid. `free` has a flag for each coordinate, point by point.
///
/// # Errors
///
/// If the design cannot be solved before or after the rounding.
pub fn rounded(study: &Study, grid: Grid, free: &[bool]) -> Result<Rounded, String> {
    let problem = Problem::new(study, grid, free);
    let ordinary = problem.nearest();
    let Some(optimise) = &study.optimise else {
        return Ok(problem.result(&ordinary, None));
    };
    let targets = problem.targets(optimise);
    let at_design = targets.evaluated(&study.wheel().design)?;
    let exact = at_design.misfit();
    let mut best: Option<(f64, Vec<f64>)> = None;
    let mut of_ordinary = None;
    let mut candidates = vec![ordinary.clone()];
    let lengths: Vec<f64> = at_design
        .jacobian
        .column_iter()
        .map(|column| column.norm())
        .collect();
    let natural: Vec<usize> = (0..lengths.len()).filter(|n| free[*n]).collect();
    let mut rising = natural.clone();
    rising.sort_by(|a, b| lengths[*a].total_cmp(&lengths[*b]));
    let falling: Vec<usize> = rising.iter().rev().copied().collect();
    for order in [natural, rising, falling] {
        if !order.is_empty() {
            candidates.push(nearest_plane(&problem, &at_design, &order));
        }
    }
    for (number, steps) in candidates.iter().enumerate() {
        // A design outside the limits of the motion has no misfit.
        let moved = problem.result(steps, None).design;
        let misfit = targets.evaluated(&moved).ok();
        let misfit = misfit.map(|evaluation| evaluation.misfit());
        if number == 0 {
            of_ordinary = misfit;
        }
        if let Some(misfit) = misfit
            && best.as_ref().is_none_or(|(least, _)| misfit < *least)
        {
            best = Some((misfit, steps.clone()));
        }
    }
    let (misfit, steps) =
        best.ok_or("the design cannot be solved if it is rounded to this grid")?;
    let otherwise = steps.iter().zip(&ordinary).filter(|(a, b)| a != b).count();
    let loss = Loss {
        exact,
        ordinary: of_ordinary,
        best: misfit,
        otherwise,
    };
    Ok(problem.result(&steps, Some(loss)))
}

/// Grid of multiples of a length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Length of one step.
    pub step: f64,
    /// Unit of the step.
    pub unit: LengthUnit,
}

impl Grid {
    /// Converts a length to steps.
    fn steps(&self, length: f64) -> f64 {
        length / self.step
    }

    /// Length of this number of steps. A decimal grid gives the shortest decimal: 3 x 0.1 is 0.3.
    fn length(&self, steps: f64) -> f64 {
        let parts = (1.0 / self.step).round();
        if parts >= 1.0 && 1.0 / parts == self.step {
            steps / parts
        } else {
            steps * self.step
        }
    }
}

/// A design to be rounded.
struct Problem<'a> {
    study: &'a Study,
    grid: Grid,
    free: &'a [bool],
    /// All coordinates in the study's axes, point by point, in the grid's unit.
    before: Vec<f64>,
}

impl<'a> Problem<'a> {
    fn new(study: &'a Study, grid: Grid, free: &'a [bool]) -> Self {
        let suspension = study.wheel();
        let points = suspension.design.iter();
        let before = points
            .flat_map(|point| suspension.frame.vector(*point).to_array())
            .map(|x| grid.unit.convert(x, suspension.length_unit))
            .collect();
        Problem {
            study,
            grid,
            free,
            before,
        }
    }

    /// Steps of each coordinate, each rounded to its nearest multiple.
    fn nearest(&self) -> Vec<f64> {
        let coordinates = self.before.iter().zip(self.free);
        let steps = coordinates.map(|(x, free)| match free {
            true => self.grid.steps(*x).round(),
            false => self.grid.steps(*x),
        });
        steps.collect()
    }

    /// Design whose coordinates are these multiples of the rounding step. A coordinate that does not move keeps its exact value.
    fn result(&self, steps: &[f64], loss: Option<Loss>) -> Rounded {
        let suspension = self.study.wheel();
        let own = suspension.length_unit;
        let stays = |n: usize| !self.free[n] || self.grid.steps(self.before[n]) == steps[n];
        let mut design = Vec::with_capacity(suspension.design.len());
        let mut coordinates = Vec::with_capacity(suspension.design.len());
        for (point, before) in suspension.design.iter().enumerate() {
            let of_study = suspension.frame.vector(*before).to_array();
            let numbers = [0, 1, 2].map(|axis| 3 * point + axis);
            // A coordinate on the grid is written with the grid's digits if the units differ, because its conversion has lost the
            // last digit.
            let keeps_digits = |n: usize| !self.free[n] || stays(n) && own == self.grid.unit;
            let written = numbers.map(|n| {
                if keeps_digits(n) {
                    self.before[n]
                } else {
                    self.grid.length(steps[n])
                }
            });
            let [x, y, z] = [0, 1, 2].map(|axis| {
                if stays(numbers[axis]) {
                    of_study[axis]
                } else {
                    own.convert(written[axis], self.grid.unit)
                }
            });
            design.push(suspension.frame.vector(Vector3::new(x, y, z)));
            coordinates.push(written);
        }
        Rounded {
            design,
            coordinates,
            grid: self.grid,
            loss,
        }
    }

    fn targets(&self, optimise: &Optimise) -> Targets<'a> {
        let study = self.study;
        Targets {
            study,
            variables: Variable::every_coordinate(study.wheel(), [-1.0, 1.0]),
            layout: TargetLayout::nominal(optimise, &study.vehicle),
        }
    }
}

/// Targets of a study as functions of all its coordinates.
struct Targets<'a> {
    study: &'a Study,
    variables: Vec<Variable>,
    layout: TargetLayout,
}

impl Targets<'_> {
    /// Residuals of a design and their derivatives.
    fn evaluated(&self, design: &[Vector3<f64>]) -> Result<Linearisation, String> {
        let mut suspension = self.study.wheel().clone();
        suspension.design = design.to_vec();
        let here = vec![0.0; self.variables.len()];
        evaluated(&suspension, &self.variables, &self.layout, &here)
            .map_err(|fault| fault.describe(&suspension.mechanism))?
            .map_err(|infeasible| infeasible.to_string())
    }
}

/// Integers on both sides of a number. An integer, within rounding errors, is both of its own neighbours.
fn neighbours(at: f64) -> (f64, f64) {
    let nearest = at.round();
    if (at - nearest).abs() <= 1e-9 * at.abs().max(1.0) {
        (nearest, nearest)
    } else {
        (at.floor(), at.ceil())
    }
}

/// Steps of all coordinates by nearest plane. The free coordinates are processed from the last to the first of `order`.
fn nearest_plane(problem: &Problem<'_>, at_design: &Linearisation, order: &[usize]) -> Vec<f64> {
    let (rows, columns) = (at_design.jacobian.nrows(), order.len());
    let own = problem.study.wheel().length_unit;
    let step = own.convert(problem.grid.step, problem.grid.unit);
    let mut matrix = DMatrix::zeros(rows + columns, columns);
    for (column, coordinate) in order.iter().enumerate() {
        let from = at_design.jacobian.column(*coordinate);
        matrix
            .view_mut((0, column), (rows, 1))
            .copy_from(&(from * step));
        matrix[(rows + column, column)] = SPRING;
    }
    let mut wanted = DVector::zeros(rows + columns);
    wanted.rows_mut(0, rows).copy_from(&-&at_design.residuals);
    let qr = matrix.qr();
    let (r, y) = (qr.r(), qr.q().transpose() * wanted);
    let mut steps = problem.nearest();
    // Chosen moves d, in the order of the coordinates.
    let mut moves = vec![0.0; columns];
    for i in (0..columns).rev() {
        let handed_on: f64 = (i + 1..columns).map(|j| r[(i, j)] * moves[j]).sum();
        let best = (y[i] - handed_on) / r[(i, i)];
        let at = problem.grid.steps(problem.before[order[i]]);
        let (least, most) = neighbours(at);
        let step = (at + best).round().clamp(least, most);
        steps[order[i]] = step;
        moves[i] = step - at;
    }
    steps
}

/// Flags for all coordinates, point by point. True if the coordinate differs in another design.
pub fn moved_coordinates(design: &[Vector3<f64>], other: &[Vector3<f64>]) -> Vec<bool> {
    let pairs = design.iter().zip(other);
    let differs = |(a, b): (&Vector3<f64>, &Vector3<f64>)| {
        let (a, b) = (a.to_array(), b.to_array());
        [0, 1, 2].map(|axis| a[axis] != b[axis])
    };
    pairs.flat_map(differs).collect()
}

/// Flags for all coordinates, point by point. True if a variable of `[optimise]` moves the coordinate.
pub fn tuned_coordinates(study: &Study) -> Vec<bool> {
    let mut tuned = vec![false; 3 * study.wheel().design.len()];
    let variables = study.optimise.iter().flat_map(|o| &o.variables);
    for variable in variables {
        for step in &variable.moves {
            tuned[3 * step.point.0 + step.axis as usize] |= step.factor != 0.0;
        }
        for point in variable.turn.iter().flat_map(|turn| &turn.points) {
            tuned[3 * point.0..3 * point.0 + 3].fill(true);
        }
    }
    tuned
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn multiples_of_a_decimal_grid_are_decimals() {
        for (step, steps, length) in [
            (0.1, 3.0, 0.3),
            (0.5, -3.0, -1.5),
            (2.0, 7.0, 14.0),
            (0.001, 1234.0, 1.234),
        ] {
            let unit = LengthUnit::Millimetre;
            assert_eq!(Grid { step, unit }.length(steps), length);
        }
    }

    #[test]
    fn decimals_of_any_length_are_the_shortest() {
        let unit = LengthUnit::Metre;
        for (step, parts) in [(0.001, 1000.0), (0.0001, 10_000.0), (1.0, 1.0)] {
            for steps in 0..2000 {
                let steps = f64::from(steps);
                assert_eq!(Grid { step, unit }.length(steps), steps / parts);
            }
        }
    }

    /// A number counts as an integer if it is within a relative 1e-9 of one, or within 1e-9 for numbers below 1.
    #[test]
    fn whole_numbers_have_no_neighbours() {
        for (at, expected) in [
            (3.0, (3.0, 3.0)),
            (3.0 + 2.9985e-9, (3.0, 3.0)),
            (3.0 + 3.0015e-9, (3.0, 4.0)),
            (0.9995e-9, (0.0, 0.0)),
            (1.0005e-9, (0.0, 1.0)),
            (-2.5, (-3.0, -2.0)),
        ] {
            assert_eq!(neighbours(at), expected, "{at}");
        }
    }

    fn front() -> Study {
        let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies");
        let text = std::fs::read_to_string(directory.join("macpherson_front.toml")).unwrap();
        let study = Study::from_text("front.toml", &text, &directory).unwrap();
        // In this design, as after a tuning, no coordinate is on the grid.
        let design = study.wheel().design.iter().zip(1..).map(|(p, n)| {
            let off = 0.37 * f64::from(n);
            *p + Vector3::new(off.sin(), off.cos(), (2.0 * off).sin()) * 0.4
        });
        study.at_design(design.collect())
    }

    /// The sample's targets are met to a tenth of a tolerance, and rounding to a millimetre raises the misfit by several
    /// tolerances. The best rounding must be no worse than ordinary rounding, must be on the grid, and must be within one step.
    /// This holds in any unit of the grid.
    #[test]
    fn nearest_plane_loses_no_more_than_ordinary_rounding() {
        let study = front();
        let all = vec![true; 3 * study.wheel().design.len()];
        let mut better = 0;
        for (step, unit) in [
            (1.0, LengthUnit::Millimetre),
            (0.1, LengthUnit::Millimetre),
            (0.05, LengthUnit::Inch),
            (0.001, LengthUnit::Metre),
        ] {
            let grid = Grid { step, unit };
            let rounded = rounded(&study, grid, &all).unwrap();
            let loss = rounded.loss.unwrap();
            assert!(loss.best <= loss.ordinary.unwrap(), "{loss:?}");
            better += usize::from(loss.best < loss.ordinary.unwrap());
            // Rounding a second time does not change the design.
            let after = study.at_design(rounded.design.clone());
            let again = super::rounded(&after, grid, &all).unwrap();
            assert_eq!(again.coordinates, rounded.coordinates);
            let before = Problem::new(&study, grid, &all).before;
            let written = rounded.coordinates.iter().flatten();
            for (before, after) in before.iter().zip(written) {
                assert!(
                    (after - before).abs() <= step * (1.0 + 1e-9),
                    "{before} {after}"
                );
                assert_eq!(grid.length((after / step).round()), *after);
            }
            // The curves belong to the points in the file.
            let own = study.wheel().length_unit;
            for (point, written) in rounded.design.iter().zip(&rounded.coordinates) {
                let point = study.wheel().frame.vector(*point).to_array();
                for (x, written) in point.iter().zip(written) {
                    assert!((x - own.convert(*written, unit)).abs() <= 1e-12 * x.abs());
                }
            }
        }
        assert!(better >= 1, "{better}");
    }

    #[test]
    fn coordinates_that_are_not_free_keep_their_bits() {
        let study = front();
        let tuned = tuned_coordinates(&study);
        let count = tuned.iter().filter(|free| **free).count();
        assert!(count > 0 && count < tuned.len(), "{count}");
        for unit in LengthUnit::ALL {
            let step = unit.convert(1.0, LengthUnit::Millimetre);
            let grid = Grid { step, unit };
            let rounded = rounded(&study, grid, &tuned).unwrap();
            let moved = moved_coordinates(&study.wheel().design, &rounded.design);
            for (moved, tuned) in moved.iter().zip(&tuned) {
                assert_eq!(moved, tuned);
            }
        }
    }
}
