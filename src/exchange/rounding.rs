//! Rounds hardpoints to a grid with the smallest increase of the misfit.
//!
//! Let r be the residuals of a study's targets, divided by the tolerances (`Objective` of the engine), and J their derivatives with
//! respect to all coordinates x. Let g be the step of the grid, and d the moves that round the coordinates, in steps. Then the
//! residuals after rounding are
//!
//! ```text
//! r + g J d,   d = k - x/g,   k integers
//! ```
//!
//! So the best rounding is the lattice point g J k nearest to a given point. Only free coordinates move; all others keep
//! their digits.
//!
//! The method is *nearest plane* (L. Babai, On Lovász' lattice reduction and the nearest lattice point problem,
//! Combinatorica 6, 1986). It rounds the coordinates one after the other. With g J = Q R (Q orthogonal, R upper
//! triangular), it rounds the last coordinate first and passes the resulting change on to the other coordinates. It continues in
//! this way back to the first coordinate. A weak spring of stiffness s (additional rows s I below g J, I the identity matrix)
//! keeps coordinates that no target depends on near their original values. Each coordinate is rounded to one of its two
//! neighbours on the grid, so a coordinate on the grid stays.
//!
//! The result depends on the order of the coordinates. The program tries three orders and also ordinary rounding, and computes
//! the misfit of each exactly.
//!
//! Constraints and ranges have priority over the misfit. A coordinate with a range is rounded to a neighbour within this
//! range, if there is one. Among the candidates, the program keeps the one with the smallest violation of the
//! constraints. If violations are equal, it keeps the one with the smallest misfit. Then it changes single coordinates
//! and pairs of coordinates to their other neighbours, as long as this improves the result.

mod targets;

use crate::model::{Axis, LengthUnit, PointId};
use crate::number::Vector3;
use crate::optimise::{Linearisation, TargetLayout};
use crate::report::{ConstraintMargin, brief};
use crate::study::{Optimise, Study, Variable};
use nalgebra::{DMatrix, DVector};
use targets::Targets;

/// Largest number of roundings that the program evaluates when it tries other neighbours.
const MOST_TRIALS: usize = 2000;
/// Stiffness s of the weak spring that opposes moves without effect on the targets: residual (1 = one tolerance) per grid step.
const SPRING: f64 = 1e-3;

/// A rounded design.
#[derive(Clone, Debug)]
pub struct Rounded {
    /// Points in the kernel's frame (x forward, y outboard, z up) and the study's unit.
    pub design: Vec<Vector3<f64>>,
    /// Coordinates of the points in the study's axes and the grid's unit. Rounded coordinates are written with exactly the decimals
    /// of the grid's step.
    pub coordinates: Vec<[f64; 3]>,
    /// Grid to whose multiples the coordinates are rounded.
    pub grid: Grid,
    /// Change of the misfit because of the rounding, if the study has targets.
    pub loss: Option<Loss>,
    /// Constraints that the rounded design violates, and ranges that contain no multiple of the grid.
    pub broken: Vec<Broken>,
}

/// Misfits before and after rounding, in multiples of the tolerances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loss {
    /// Misfit of the design before rounding.
    pub exact: f64,
    /// Misfit if each coordinate is rounded to its nearest multiple. `None` if this design cannot be solved.
    pub ordinary: Option<f64>,
    /// Misfit of the chosen rounding.
    pub best: f64,
    /// Number of coordinates that are not rounded to the nearest multiple in the chosen rounding.
    pub otherwise: usize,
}

/// A constraint or a range that the rounded design violates. Its distances are in `unit`.
#[derive(Clone, Debug, PartialEq)]
pub struct Broken {
    /// Name of the constraint with its limits, or of the coordinate with its range.
    pub name: String,
    /// Distance between the rounded design's value and the nearest limit. Infinite if the constraint has no value.
    pub missed: f64,
    /// Distance between the value before rounding and the nearest limit. Zero if the constraint was satisfied.
    pub missed_before: f64,
    /// Unit of `missed` and `missed_before`.
    pub unit: String,
}

/// Rounds the free coordinates of a study's design to multiples of a grid. `free` has a flag for each coordinate, point by point.
/// `ranges` has the smallest and largest value of each coordinate, in the study's axes and unit.
///
/// # Errors
///
/// If the design cannot be solved before or after the rounding.
pub fn rounded(
    study: &Study,
    grid: Grid,
    free: &[bool],
    ranges: &[[f64; 2]],
) -> Result<Rounded, String> {
    let problem = Problem::new(study, grid, free, ranges);
    let ordinary = problem.nearest();
    let Some(optimise) = &study.optimise else {
        return Ok(problem.result(&ordinary, None));
    };
    let targets = problem.targets(optimise);
    let at_design = targets.evaluated(&study.wheel().design)?;
    let exact = at_design.misfit();
    let (_, margins_before) = targets.assessed(&study.wheel().design)?;
    let mut best: Option<Candidate> = None;
    let mut candidates = vec![problem.within_ranges(&ordinary)];
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
    for steps in candidates {
        let candidate = targets.candidate(&problem, steps);
        if let Some(candidate) = candidate
            && best.as_ref().is_none_or(|best| candidate.is_better(best))
        {
            best = Some(candidate);
        }
    }
    let best = best.ok_or("the rounded design cannot be solved; round to a smaller length")?;
    let best = targets.improved(&problem, best);
    let (steps, pairs) = (&best.steps, best.steps.iter().zip(&ordinary));
    let of_ordinary = targets.assessed(&problem.result(&ordinary, None).design);
    let loss = Loss {
        exact,
        // A design outside the limits of the motion has no misfit.
        ordinary: of_ordinary.ok().map(|(misfit, _)| misfit),
        best: best.misfit,
        otherwise: pairs.filter(|(a, b)| a != b).count(),
    };
    let mut rounded = problem.result(steps, Some(loss));
    let margins = best.margins.iter().zip(&margins_before);
    let violated = margins.filter(|(own, _)| own.is_violated);
    rounded.broken = violated
        .map(|(own, before)| Broken {
            name: own.name.clone(),
            missed: missed(own),
            missed_before: missed(before),
            unit: own.unit.clone(),
        })
        .chain(problem.outside_ranges(steps))
        .collect();
    Ok(rounded)
}

/// Distance of a constraint's value from the nearest limit, in the constraint's unit. Zero if the constraint is
/// satisfied, infinite if it has no value.
fn missed(own: &ConstraintMargin) -> f64 {
    if !own.is_violated {
        0.0
    } else if own.margin.is_nan() {
        f64::INFINITY
    } else {
        -own.margin
    }
}

/// A rounding of all coordinates, with the resulting misfit.
struct Candidate {
    steps: Vec<f64>,
    /// Sum of the violations of all constraints. Each violation is a multiple of a visible change, such as 1 mm or 1 degree.
    violation: f64,
    misfit: f64,
    margins: Vec<ConstraintMargin>,
}

impl Candidate {
    /// True if this rounding violates the constraints less. If the violations are equal, true if the misfit is smaller.
    fn is_better(&self, than: &Candidate) -> bool {
        let own = (self.violation, self.misfit);
        own < (than.violation, than.misfit)
    }
}

/// Grid of multiples of a length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Length of one step.
    pub step: f64,
    /// Unit of `step`.
    pub unit: LengthUnit,
}

impl Grid {
    /// Converts a length to steps.
    fn steps(&self, length: f64) -> f64 {
        length / self.step
    }

    /// Length of this number of steps. A step with up to 9 decimals gives the shortest decimal: 3 x 0.1 is 0.3.
    fn length(&self, steps: f64) -> f64 {
        let parts = (1.0 / self.step).round();
        if parts >= 1.0 && 1.0 / parts == self.step {
            return steps / parts;
        }
        // The step is a whole number of tenths, hundredths, and so on.
        for scale in [1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9] {
            let whole = (self.step * scale).round();
            if whole / scale == self.step {
                return steps * whole / scale;
            }
        }
        steps * self.step
    }
}

/// A design to be rounded.
struct Problem<'a> {
    study: &'a Study,
    grid: Grid,
    free: &'a [bool],
    /// All coordinates in the study's axes, point by point, in the grid's unit.
    before: Vec<f64>,
    /// Range of each coordinate, in steps of the grid: smallest and largest number of steps. The numbers are not
    /// rounded to integers.
    ranges: Vec<[f64; 2]>,
}

impl<'a> Problem<'a> {
    fn new(study: &'a Study, grid: Grid, free: &'a [bool], ranges: &[[f64; 2]]) -> Self {
        let suspension = study.wheel();
        let points = suspension.design.iter();
        let before = points
            .flat_map(|point| suspension.frame.vector(*point).to_array())
            .map(|x| grid.unit.convert(x, suspension.length_unit))
            .collect();
        let steps = |x: f64| grid.steps(grid.unit.convert(x, suspension.length_unit));
        Problem {
            study,
            grid,
            free,
            before,
            ranges: ranges.iter().map(|range| range.map(steps)).collect(),
        }
    }

    /// Returns the two multiples of the grid's step next to a coordinate, in steps: below and above its present value. A multiple
    /// outside of the coordinate's range is left out, unless both are outside.
    fn neighbours(&self, coordinate: usize) -> (f64, f64) {
        let (below, above) = neighbours(self.grid.steps(self.before[coordinate]));
        let is_within = |steps: f64| self.outside(coordinate, steps) == 0.0;
        match (is_within(below), is_within(above)) {
            (true, false) => (below, below),
            (false, true) => (above, above),
            _ => (below, above),
        }
    }

    /// Distance of a coordinate, in steps, from the nearest end of its range. Zero within the range.
    fn outside(&self, coordinate: usize, steps: f64) -> f64 {
        let [least, most] = self.ranges[coordinate];
        let missed = (least - steps).max(steps - most);
        // This tolerance, in steps, allows for rounding errors in the ends of a range.
        let slack = 1e-9 * most.abs().max(least.abs()).max(1.0);
        if missed > slack { missed } else { 0.0 }
    }

    /// Rounded coordinates outside of their ranges, with their distances from the ranges.
    fn outside_ranges(&self, steps: &[f64]) -> Vec<Broken> {
        let wheel = self.study.wheel();
        let unit = self.grid.unit.symbol();
        let free = (0..steps.len()).filter(|coordinate| self.free[*coordinate]);
        let outside = free.filter_map(|coordinate| {
            let [before, after] = [self.grid.steps(self.before[coordinate]), steps[coordinate]]
                .map(|steps| self.grid.length(self.outside(coordinate, steps)));
            let name = wheel.mechanism.name(PointId(coordinate / 3));
            let [low, high] = self.ranges[coordinate].map(|end| brief(self.grid.length(end)));
            (after > 0.0).then(|| Broken {
                name: format!(
                    "{} of {name} in its range from {low} to {high}",
                    Axis::ALL[coordinate % 3].name()
                ),
                missed: after,
                missed_before: before,
                unit: unit.to_owned(),
            })
        });
        outside.collect()
    }

    /// Moves each free coordinate to the nearest multiple of the grid's step within its range. This multiple is one of its two
    /// neighbours on the grid. Without a neighbour within the range, the range has no effect.
    fn within_ranges(&self, steps: &[f64]) -> Vec<f64> {
        let mut within = steps.to_vec();
        for (coordinate, steps) in within.iter_mut().enumerate() {
            if self.free[coordinate] {
                let (least, most) = self.neighbours(coordinate);
                *steps = steps.clamp(least, most);
            }
        }
        within
    }

    /// Coordinates in steps of the grid. Free coordinates are rounded to the nearest integer.
    fn nearest(&self) -> Vec<f64> {
        let coordinates = self.before.iter().zip(self.free);
        let steps = coordinates.map(|(x, free)| match free {
            true => self.grid.steps(*x).round(),
            false => self.grid.steps(*x),
        });
        steps.collect()
    }

    /// Makes the design whose coordinates are these multiples of the step. A coordinate that does not move keeps its
    /// exact value.
    fn result(&self, steps: &[f64], loss: Option<Loss>) -> Rounded {
        let suspension = self.study.wheel();
        let own = suspension.length_unit;
        let stays = |n: usize| !self.free[n] || self.grid.steps(self.before[n]) == steps[n];
        let mut design = Vec::with_capacity(suspension.design.len());
        let mut coordinates = Vec::with_capacity(suspension.design.len());
        for (point, before) in suspension.design.iter().enumerate() {
            let of_study = suspension.frame.vector(*before).to_array();
            let numbers = [0, 1, 2].map(|axis| 3 * point + axis);
            // A conversion from the study's unit to another unit of the grid changes the last digits. So a coordinate on the grid
            // is written with the decimals of the grid's step.
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
                    own.convert_decimal(written[axis], self.grid.unit)
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
            broken: Vec::new(),
        }
    }

    fn targets(&self, optimise: &Optimise) -> Targets<'a> {
        let study = self.study;
        Targets {
            study,
            variables: Variable::every_coordinate(study.wheel(), [-1.0, 1.0]),
            layout: TargetLayout::nominal(optimise, &study.vehicle),
            optimise: optimise.clone(),
        }
    }
}

/// Returns the integers below and above a number. For an integer (within rounding errors), both are this integer.
fn neighbours(at: f64) -> (f64, f64) {
    let nearest = at.round();
    if (at - nearest).abs() <= 1e-9 * at.abs().max(1.0) {
        (nearest, nearest)
    } else {
        (at.floor(), at.ceil())
    }
}

/// Returns the rounded coordinates in steps, by the method nearest plane (see the head of this module). The method rounds the free
/// coordinates from the last to the first of `order`.
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
    // Chosen moves d (change of each coordinate by rounding, in steps), in the order of the coordinates.
    let mut moves = vec![0.0; columns];
    for i in (0..columns).rev() {
        let handed_on: f64 = (i + 1..columns).map(|j| r[(i, j)] * moves[j]).sum();
        let best = (y[i] - handed_on) / r[(i, i)];
        let at = problem.grid.steps(problem.before[order[i]]);
        let (least, most) = problem.neighbours(order[i]);
        let step = (at + best).round().clamp(least, most);
        steps[order[i]] = step;
        moves[i] = step - at;
    }
    steps
}

/// Flags for all coordinates, point by point. True if the coordinate has different values in the two designs.
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

/// Smallest and largest value of each coordinate that the variables of `[optimise]` allow, in the study's axes and unit.
/// The ranges are measured from the design `origin`. Rotations do not limit the points that they move.
pub fn ranges_of_coordinates(study: &Study, origin: &[Vector3<f64>]) -> Vec<[f64; 2]> {
    const ANY: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];
    let wheel = study.wheel();
    let mut moves: Vec<Option<[f64; 2]>> = vec![None; 3 * wheel.design.len()];
    let mut add = |coordinate: usize, ends: [f64; 2]| {
        let [least, most] = moves[coordinate].unwrap_or_default();
        moves[coordinate] = Some([least + ends[0].min(ends[1]), most + ends[0].max(ends[1])]);
    };
    for variable in study.optimise.iter().flat_map(|o| &o.variables) {
        for step in variable.moves.iter().filter(|step| step.factor != 0.0) {
            let ends = variable.range.map(|offset| step.factor * offset);
            add(3 * step.point.0 + step.axis as usize, ends);
        }
        for point in variable.turn.iter().flat_map(|turn| &turn.points) {
            (0..3).for_each(|axis| add(3 * point.0 + axis, ANY));
        }
    }
    let origins = origin
        .iter()
        .flat_map(|point| wheel.frame.vector(*point).to_array());
    let moves = moves.into_iter().zip(origins);
    let ranges = moves.map(|(ends, from)| ends.map_or(ANY, |ends| ends.map(|end| from + end)));
    ranges.collect()
}

#[cfg(test)]
mod tests;
