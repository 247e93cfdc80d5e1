//! Hardpoints rounded to a grid with the least loss.
//!
//! Let r be the residuals of a study's targets (in tolerances, [`Objective`]), J their derivatives by all
//! coordinates, and d the moves of the coordinates, in steps g of the grid, that round them. The misfit
//! after rounding is that of
//!
//! ```text
//! r + g J d,   d = k - x/g,   k whole numbers
//! ```
//!
//! so the best rounding is the lattice point g J k nearest to a given one. *Nearest plane* (L. Babai, On
//! Lovász' lattice reduction and the nearest lattice point problem, Combinatorica 6, 1986) takes the
//! coordinates one after the other: with g J = Q R the last one is rounded, what it changes is handed on to
//! the others, and so back to the first. Coordinates the targets do not see are held by a small spring
//! towards where they are (rows s I below g J), and each goes to one of its two neighbours on the grid, so that
//! one that is on the grid stays. What comes out
//! depends on the order of the coordinates; three are tried, and beside them the ordinary rounding, and the
//! misfits of all are computed, not estimated.

use crate::number::Vector3;
use crate::optimise::{Linearisation, TargetLayout, evaluated};
use crate::study::{Optimise, Study, Variable};
use nalgebra::{DMatrix, DVector};

/// The spring against moves the targets do not see, in tolerances per step.
const SPRING: f64 = 1e-3;

/// A rounded design.
#[derive(Clone, Debug)]
pub struct Rounded {
    /// Its points, in the kernel's frame.
    pub design: Vec<Vector3<f64>>,
    /// Loss by rounding, if the study has targets.
    pub loss: Option<Loss>,
}

/// Misfits, in tolerances; `None` where a design cannot be solved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loss {
    /// Misfit of the design before rounding.
    pub exact: f64,
    /// Misfit with each coordinate rounded to the nearest multiple by itself.
    pub ordinary: Option<f64>,
    /// Misfit with the chosen rounding.
    pub best: f64,
    /// Number of coordinates that the chosen rounding does not round to the nearest multiple.
    pub otherwise: usize,
}

/// Rounds a study's points to multiples of `grid`, in its unit.
///
/// # Errors
///
/// If the design cannot be solved.
pub fn rounded(study: &Study, design: &[Vector3<f64>], grid: f64) -> Result<Rounded, String> {
    let grid = Grid { grid };
    let ordinary: Vec<f64> = coordinates(study, design)
        .iter()
        .map(|x| grid.steps(*x).round())
        .collect();
    let Some(optimise) = &study.optimise else {
        return Ok(Rounded {
            design: moved(study, design, &grid, &ordinary),
            loss: None,
        });
    };
    let problem = Problem::new(study, design, optimise);
    let at_design = problem.evaluated(design)?;
    let exact = at_design.misfit();
    let mut best: Option<(f64, Vec<f64>)> = None;
    let mut of_ordinary = None;
    let mut candidates = vec![ordinary.clone()];
    let lengths: Vec<f64> = at_design
        .jacobian
        .column_iter()
        .map(|column| column.norm())
        .collect();
    let natural: Vec<usize> = (0..lengths.len()).collect();
    let mut rising = natural.clone();
    rising.sort_by(|a, b| lengths[*a].total_cmp(&lengths[*b]));
    let falling: Vec<usize> = rising.iter().rev().copied().collect();
    for order in [natural, rising, falling] {
        candidates.push(nearest_plane(&problem, &at_design, &grid, &order));
    }
    for (number, steps) in candidates.iter().enumerate() {
        // A design beyond a limit of the motion has no misfit.
        let moved = moved(study, design, &grid, steps);
        let misfit = problem
            .evaluated(&moved)
            .ok()
            .map(|evaluation| evaluation.misfit());
        if number == 0 {
            of_ordinary = misfit;
        }
        if let Some(misfit) = misfit
            && best.as_ref().is_none_or(|(least, _)| misfit < *least)
        {
            best = Some((misfit, steps.clone()));
        }
    }
    let (misfit, steps) = best.ok_or("rounded to this grid the design cannot be solved")?;
    let otherwise = steps.iter().zip(&ordinary).filter(|(a, b)| a != b).count();
    Ok(Rounded {
        design: moved(study, design, &grid, &steps),
        loss: Some(Loss {
            exact,
            ordinary: of_ordinary,
            best: misfit,
            otherwise,
        }),
    })
}

/// Multiples of a length.
struct Grid {
    grid: f64,
}

impl Grid {
    /// A length in steps.
    fn steps(&self, length: f64) -> f64 {
        length / self.grid
    }

    /// The length of this number of steps; a decimal grid gives the shortest decimal: 3 x 0.1 is 0.3.
    fn length(&self, steps: f64) -> f64 {
        let parts = (1.0 / self.grid).round();
        match parts >= 1.0 && 1.0 / parts == self.grid {
            true => steps / parts,
            false => steps * self.grid,
        }
    }
}

/// All coordinates in the study's axes, point by point.
fn coordinates(study: &Study, design: &[Vector3<f64>]) -> Vec<f64> {
    let frame = study.suspension.frame;
    design
        .iter()
        .flat_map(|point| frame.vector(*point).to_array())
        .collect()
}

/// The design with its coordinates at these numbers of steps.
fn moved(study: &Study, design: &[Vector3<f64>], grid: &Grid, steps: &[f64]) -> Vec<Vector3<f64>> {
    let frame = study.suspension.frame;
    let before = coordinates(study, design);
    let length = |number: usize| {
        let rounded = grid.length(steps[number]);
        // A coordinate on the grid keeps its bits.
        let same = grid.steps(before[number]) == steps[number];
        if same { before[number] } else { rounded }
    };
    let points = (0..design.len()).map(|point| {
        let [x, y, z] = [0, 1, 2].map(|axis| length(3 * point + axis));
        frame.vector(Vector3::new(x, y, z))
    });
    points.collect()
}

/// The targets of a study over all of its coordinates.
struct Problem<'a> {
    study: &'a Study,
    variables: Vec<Variable>,
    layout: TargetLayout,
    before: Vec<f64>,
}

impl<'a> Problem<'a> {
    fn new(study: &'a Study, design: &[Vector3<f64>], optimise: &Optimise) -> Self {
        Problem {
            study,
            variables: Variable::every_coordinate(&study.suspension, [-1.0, 1.0]),
            layout: TargetLayout::of(optimise, &study.motion, &study.suspension),
            before: coordinates(study, design),
        }
    }

    /// Residuals and derivatives of a design.
    fn evaluated(&self, design: &[Vector3<f64>]) -> Result<Linearisation, String> {
        let mut suspension = self.study.suspension.clone();
        suspension.design = design.to_vec();
        let here = vec![0.0; self.variables.len()];
        evaluated(&suspension, &self.variables, &self.layout, &here)
            .map_err(|fault| fault.describe(&suspension.mechanism))?
            .map_err(|infeasible| infeasible.to_string())
    }
}

/// The whole numbers on both sides of a number; itself twice where it is one, but for rounding.
fn neighbours(at: f64) -> (f64, f64) {
    let nearest = at.round();
    match (at - nearest).abs() <= 1e-9 * at.abs().max(1.0) {
        true => (nearest, nearest),
        false => (at.floor(), at.ceil()),
    }
}

/// The steps of all coordinates by nearest plane, taken in an order from its last to its first.
fn nearest_plane(
    problem: &Problem<'_>,
    at_design: &Linearisation,
    grid: &Grid,
    order: &[usize],
) -> Vec<f64> {
    let (rows, columns) = at_design.jacobian.shape();
    let mut matrix = DMatrix::zeros(rows + columns, columns);
    for (column, coordinate) in order.iter().enumerate() {
        let from = at_design.jacobian.column(*coordinate);
        matrix
            .view_mut((0, column), (rows, 1))
            .copy_from(&(from * grid.grid));
        matrix[(rows + column, column)] = SPRING;
    }
    let mut wanted = DVector::zeros(rows + columns);
    wanted.rows_mut(0, rows).copy_from(&-&at_design.residuals);
    let qr = matrix.qr();
    let (r, y) = (qr.r(), qr.q().transpose() * wanted);
    let mut steps = vec![0.0; columns];
    // The moves d chosen so far, by their place in the order.
    let mut moves = vec![0.0; columns];
    for i in (0..columns).rev() {
        let handed_on: f64 = (i + 1..columns).map(|j| r[(i, j)] * moves[j]).sum();
        let best = (y[i] - handed_on) / r[(i, i)];
        let at = grid.steps(problem.before[order[i]]);
        let (least, most) = neighbours(at);
        let step = (at + best).round().clamp(least, most);
        steps[order[i]] = step;
        moves[i] = step - at;
    }
    steps
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn multiples_of_a_decimal_grid_are_decimals() {
        for (grid, steps, length) in [
            (0.1, 3.0, 0.3),
            (0.5, -3.0, -1.5),
            (2.0, 7.0, 14.0),
            (0.001, 1234.0, 1.234),
        ] {
            assert_eq!(Grid { grid }.length(steps), length);
        }
    }

    /// The sample's targets are met to a tenth of a tolerance and rounding to a millimetre costs several:
    /// the best rounding must be no worse than the ordinary one, on the grid, and within a step.
    #[test]
    fn nearest_plane_loses_no_more_than_ordinary_rounding() {
        let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies");
        let text = std::fs::read_to_string(directory.join("macpherson_front.toml")).unwrap();
        let study = Study::from_text("front.toml", &text, &directory).unwrap();
        // Off the grid everywhere, as a tuned design is.
        let design = study.suspension.design.iter().zip(1..).map(|(p, n)| {
            let off = 0.37 * f64::from(n);
            *p + Vector3::new(off.sin(), off.cos(), (2.0 * off).sin()) * 0.4
        });
        let design: Vec<_> = design.collect();
        for grid in [1.0, 0.1] {
            let rounded = rounded(&study, &design, grid).unwrap();
            let loss = rounded.loss.unwrap();
            // What is rounded once stays.
            let again = super::rounded(&study, &rounded.design, grid).unwrap();
            assert_eq!(again.design, rounded.design);
            assert!(loss.best <= loss.ordinary.unwrap(), "{loss:?}");
            let [before, after] = [&design, &rounded.design].map(|d| coordinates(&study, d));
            for (before, after) in before.iter().zip(after) {
                assert!(
                    (after - before).abs() <= grid * (1.0 + 1e-9),
                    "{before} {after}"
                );
                assert_eq!(Grid { grid }.length((after / grid).round()), after);
            }
        }
    }
}
