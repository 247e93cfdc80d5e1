//! Second formulation of elastic axles. Every body has six coordinates. Ball joints, rods and heights are constraints
//! with multipliers. The forces are the gradient of one energy. All coordinates are vehicle coordinates, for both sides.

use super::algebra::{Rotation, solved, turned};
use crate::support::larger;
use hardpoint::number::{Real, Scalar, Tape, Tracked, Vector3};

/// Index of the fixed ground.
pub const GROUND: usize = 0;

const IDENTITY: Rotation = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Possible motion of a body.
#[derive(Clone, Copy)]
pub enum Freedom {
    Fixed,
    Free,
    /// Translation along a direction of another body, the holder.
    Along(usize, Vector3<f64>),
    /// Rotation about an axis of a holder.
    About(usize, Vector3<f64>),
}

pub struct Body {
    pub freedom: Freedom,
    /// Reference point in the design position; for a lever, a point of the axis.
    pub reference: Vector3<f64>,
    pub shift: Vector3<f64>,
    pub rotation: Rotation,
    /// Displacement along the direction, or angle about the axis.
    pub slide: f64,
}

/// Point of a body, in the design position.
#[derive(Clone, Copy)]
pub struct On(pub usize, pub Vector3<f64>);

pub enum Energy {
    /// Bushing: holder, moving body, point, axes, rates, and cubic coefficients of the forces along the axes.
    Bushing(
        usize,
        usize,
        Vector3<f64>,
        [Vector3<f64>; 3],
        [f64; 6],
        [f64; 3],
    ),
    /// Spring: both ends, compression force in the design position, and rate.
    Spring(On, On, f64, f64),
    /// Elastic rod: both ends and rate.
    Rod(On, On, f64),
    /// Anti-roll bar: two levers and rate.
    Bar(usize, usize, f64),
    /// Elastic rack: sliding body, commanded displacement, and rate.
    Slide(usize, f64, f64),
}

pub enum Constraint {
    Rod(On, On),
    Ball(On, On),
    /// Height of a point above its design position.
    Height(On, f64),
    Slide(usize, f64),
}

/// Force at a point of a body, and a moment on the body.
pub struct Load {
    pub body: usize,
    pub point: Vector3<f64>,
    pub force: Vector3<f64>,
    pub moment: Vector3<f64>,
}

pub struct World {
    pub bodies: Vec<Body>,
    pub energies: Vec<Energy>,
    pub constraints: Vec<Constraint>,
    pub multipliers: Vec<f64>,
}

/// Body in tracked numbers (numbers with derivatives): reference point and columns of the rotation matrix.
struct Moved<'t> {
    at: Vector3<Tracked<'t>>,
    columns: [Vector3<Tracked<'t>>; 3],
    slide: Tracked<'t>,
    /// Indices of the body's inputs on the tape, which records all operations of the automatic differentiation.
    inputs: Vec<usize>,
}

impl World {
    pub fn new() -> Self {
        let mut world = World {
            bodies: Vec::new(),
            energies: Vec::new(),
            constraints: Vec::new(),
            multipliers: Vec::new(),
        };
        world.body(Freedom::Fixed, Vector3::new(0.0, 0.0, 0.0));
        world
    }

    pub fn body(&mut self, freedom: Freedom, reference: Vector3<f64>) -> usize {
        self.bodies.push(Body {
            freedom,
            reference,
            shift: Vector3::new(0.0, 0.0, 0.0),
            rotation: IDENTITY,
            slide: 0.0,
        });
        self.bodies.len() - 1
    }

    fn sizes(&self) -> (Vec<usize>, usize) {
        let mut first = Vec::new();
        let mut count = 0;
        for body in &self.bodies {
            first.push(count);
            count += match body.freedom {
                Freedom::Fixed => 0,
                Freedom::Free => 6,
                _ => 1,
            };
        }
        (first, count)
    }

    fn rows(&self) -> usize {
        let of = |c: &Constraint| {
            if matches!(c, Constraint::Ball(..)) {
                3
            } else {
                1
            }
        };
        self.constraints.iter().map(of).sum()
    }

    fn moved<'t>(&self, tape: &'t Tape) -> Vec<Moved<'t>> {
        let constant = |v: Vector3<f64>| v.map(Tracked::constant);
        let mut all: Vec<Moved> = Vec::new();
        for body in &self.bodies {
            let first = tape.len();
            let columns: [Vector3<Tracked>; 3] = std::array::from_fn(|j| {
                let r = &body.rotation;
                constant(Vector3::new(r[0][j], r[1][j], r[2][j]))
            });
            let now = match body.freedom {
                Freedom::Fixed => Moved {
                    at: constant(body.reference),
                    columns,
                    slide: Tracked::constant(0.0),
                    inputs: Vec::new(),
                },
                Freedom::Free => {
                    let [x, y, z, a, b, c] = std::array::from_fn(|_| tape.input(0.0));
                    let turn = Vector3::new(a, b, c);
                    Moved {
                        at: constant(body.reference + body.shift) + Vector3::new(x, y, z),
                        columns: columns.map(|v| v + turn.cross(v)),
                        slide: x,
                        inputs: (first..first + 6).collect(),
                    }
                }
                Freedom::Along(holder, direction) => {
                    let slide = tape.input(0.0) + Tracked::constant(body.slide);
                    let holder = &all[holder];
                    let along = rotated(holder, direction);
                    Moved {
                        at: placed(holder, self.reference_of(body), body.reference) + along * slide,
                        columns: holder.columns,
                        slide,
                        inputs: vec![first],
                    }
                }
                Freedom::About(holder, axis) => {
                    let change = tape.input(0.0);
                    let slide = change + Tracked::constant(body.slide);
                    let holder = &all[holder];
                    let axis = constant(axis);
                    let (sine, cosine) = body.slide.sin_cos();
                    // Rotation by the angle, with its first derivative.
                    let turned = |v: Vector3<f64>| {
                        let v = constant(v);
                        let across = v - axis * axis.dot(v);
                        let square = axis.cross(across);
                        let (s, c) = (Tracked::constant(sine), Tracked::constant(cosine));
                        let now = v - across + across * c + square * s;
                        now + axis.cross(now) * change
                    };
                    let unit = |k: usize| {
                        let mut v = Vector3::new(0.0, 0.0, 0.0);
                        match k {
                            0 => v.x = 1.0,
                            1 => v.y = 1.0,
                            _ => v.z = 1.0,
                        }
                        let w = turned(v);
                        holder.columns[0] * w.x + holder.columns[1] * w.y + holder.columns[2] * w.z
                    };
                    Moved {
                        at: placed(holder, self.reference_of(body), body.reference),
                        columns: [unit(0), unit(1), unit(2)],
                        slide,
                        inputs: vec![first],
                    }
                }
            };
            all.push(now);
        }
        all
    }

    /// Reference point of a body's holder.
    fn reference_of(&self, body: &Body) -> Vector3<f64> {
        match body.freedom {
            Freedom::Along(holder, _) | Freedom::About(holder, _) => self.bodies[holder].reference,
            _ => body.reference,
        }
    }

    fn at<'t>(&self, all: &[Moved<'t>], on: On) -> Vector3<Tracked<'t>> {
        placed(&all[on.0], self.bodies[on.0].reference, on.1)
    }

    fn energy<'t>(&self, all: &[Moved<'t>], energy: &Energy) -> Tracked<'t> {
        let lit = Tracked::constant;
        match energy {
            Energy::Bushing(i, j, point, axes, rates, cubic) => {
                let e = self.at(all, On(*j, *point)) - self.at(all, On(*i, *point));
                let rotation = logarithm(&all[*i], &all[*j]);
                let mut sum = lit(0.0);
                for k in 0..3 {
                    let axis = axes[k];
                    let d = rotated(&all[*i], axis).dot(e);
                    let square = d * d;
                    sum =
                        sum + square * lit(0.5 * rates[k]) + square * square * lit(0.25 * cubic[k]);
                    let phi = axis.map(lit).dot(rotation);
                    sum = sum + phi * phi * lit(0.5 * rates[3 + k]);
                }
                sum
            }
            Energy::Spring(a, b, force, rate) => {
                let shortened =
                    lit((a.1 - b.1).norm()) - (self.at(all, *a) - self.at(all, *b)).norm();
                shortened * (lit(*force) + shortened * lit(0.5 * rate))
            }
            Energy::Rod(a, b, rate) => {
                let stretch =
                    (self.at(all, *a) - self.at(all, *b)).norm() - lit((a.1 - b.1).norm());
                stretch * stretch * lit(0.5 * rate)
            }
            Energy::Bar(left, right, rate) => {
                let twist = all[*left].slide - all[*right].slide;
                twist * twist * lit(0.5 * rate)
            }
            Energy::Slide(body, command, rate) => {
                let off = all[*body].slide - lit(*command);
                off * off * lit(0.5 * rate)
            }
        }
    }

    fn misses<'t>(&self, all: &[Moved<'t>]) -> Vec<Tracked<'t>> {
        let lit = Tracked::constant;
        let mut found = Vec::new();
        for constraint in &self.constraints {
            match constraint {
                Constraint::Rod(a, b) => {
                    let length = (self.at(all, *a) - self.at(all, *b)).norm();
                    found.push(length - lit((a.1 - b.1).norm()));
                }
                Constraint::Ball(a, b) => {
                    found.extend((self.at(all, *a) - self.at(all, *b)).to_array());
                }
                Constraint::Height(on, travel) => {
                    found.push(self.at(all, *on).z - lit(on.1.z + travel));
                }
                Constraint::Slide(body, command) => found.push(all[*body].slide - lit(*command)),
            }
        }
        found
    }

    /// Unbalanced forces, then the errors of the constraints.
    fn residual(&self, loads: &[Load]) -> Vec<f64> {
        let tape = Tape::new();
        let (first, count) = self.sizes();
        let all = self.moved(&tape);
        let mut sum = Tracked::constant(0.0);
        for energy in &self.energies {
            sum = sum + self.energy(&all, energy);
        }
        let misses = self.misses(&all);
        for (miss, multiplier) in misses.iter().zip(&self.multipliers) {
            sum = sum + *miss * Tracked::constant(*multiplier);
        }
        let mut gradient = Vec::new();
        tape.gradients(&[sum], tape.len(), |_, by| gradient = by.to_vec());
        let mut residual = vec![0.0; count];
        for (first, moved) in first.iter().zip(&all) {
            for (k, index) in moved.inputs.iter().enumerate() {
                residual[first + k] = gradient[*index];
            }
        }
        for load in loads {
            let body = &self.bodies[load.body];
            let lever = load.point - (body.reference + body.shift);
            let moment = lever.cross(load.force) + load.moment;
            let all = load.force.to_array().into_iter().chain(moment.to_array());
            for (k, force) in all.enumerate() {
                residual[first[load.body] + k] -= force;
            }
        }
        residual.extend(misses.iter().map(|miss| miss.value()));
        residual
    }

    fn step(&mut self, step: &[f64]) {
        let (first, count) = self.sizes();
        for (body, k) in self.bodies.iter_mut().zip(first) {
            match body.freedom {
                Freedom::Fixed => {}
                Freedom::Free => {
                    body.shift = body.shift + Vector3::new(step[k], step[k + 1], step[k + 2]);
                    let turn = Vector3::new(step[k + 3], step[k + 4], step[k + 5]);
                    body.rotation = turned(&body.rotation, turn);
                }
                _ => body.slide += step[k],
            }
        }
        for (multiplier, step) in self.multipliers.iter_mut().zip(&step[count..]) {
            *multiplier += step;
        }
    }

    /// Solves for the equilibrium. `loads` returns the loads for the present state. The function applies loads, heights and rack
    /// displacements in one step. If Newton's method fails, it applies them in more and more increments.
    pub fn solve(&mut self, loads: impl Fn(&World) -> Vec<Load>) {
        let start = self.copy();
        let wanted = start.constraints.iter().map(Constraint::copy);
        let wanted: Vec<Constraint> = wanted.collect();
        let mut last = Ok(());
        for parts in [1, 8, 64] {
            *self = start.copy();
            self.multipliers = vec![0.0; self.rows()];
            last = (1..=parts).try_for_each(|part| {
                let share = f64::from(part) / f64::from(parts);
                self.constraints = wanted.iter().map(|own| own.scaled(share)).collect();
                self.settle(&|world| {
                    let mut loads = loads(world);
                    for load in &mut loads {
                        load.force = load.force * share;
                        load.moment = load.moment * share;
                    }
                    loads
                })
            });
            if last.is_ok() {
                return;
            }
        }
        panic!("the second formulation does not settle: its last step is {last:?}");
    }

    /// Newton's method with a matrix from central differences. If it fails, returns the size of the last step.
    fn settle(&mut self, loads: &impl Fn(&World) -> Vec<Load>) -> Result<(), f64> {
        let (_, count) = self.sizes();
        let total = count + self.multipliers.len();
        let mut matrix = Vec::new();
        let mut size = f64::INFINITY;
        for round in 0..80 {
            let residual = self.residual(&loads(self));
            // Near the solution, steps with an old matrix shrink by a constant factor. Far from the solution they hardly
            // shrink, so a new matrix is needed.
            if size > 1e-2 || round % 4 == 0 && size > 1e-7 {
                matrix = vec![vec![0.0; total]; total];
                for column in 0..total {
                    let scale = if column < count { 1e-4 } else { 1.0 };
                    let mut ends = [-1.0, 1.0].map(|sign: f64| {
                        let mut near = self.copy();
                        let mut step = vec![0.0; total];
                        step[column] = sign * scale;
                        near.step(&step);
                        near.residual(&loads(&near))
                    });
                    let [low, high] = &mut ends;
                    for row in 0..total {
                        matrix[row][column] = (high[row] - low[row]) / (2.0 * scale);
                    }
                }
            }
            let right: Vec<f64> = residual.iter().map(|r| -r).collect();
            let step = solved(matrix.clone(), right);
            size = step[..count].iter().map(|s| s.abs()).fold(0.0, larger);
            self.step(&step);
            if size < 1e-12 {
                return Ok(());
            }
        }
        Err(size)
    }

    fn copy(&self) -> World {
        let body = |b: &Body| Body {
            freedom: b.freedom,
            reference: b.reference,
            shift: b.shift,
            rotation: b.rotation,
            slide: b.slide,
        };
        World {
            bodies: self.bodies.iter().map(body).collect(),
            energies: self.energies.iter().map(Energy::copy).collect(),
            constraints: self.constraints.iter().map(Constraint::copy).collect(),
            multipliers: self.multipliers.clone(),
        }
    }

    /// Present position of a point.
    pub fn position(&self, on: On) -> Vector3<f64> {
        let tape = Tape::new();
        let all = self.moved(&tape);
        self.at(&all, on).map(|c| c.value())
    }

    /// Returns a direction of a body after the rotation of the body.
    pub fn direction(&self, body: usize, v: Vector3<f64>) -> Vector3<f64> {
        let r = &self.bodies[body].rotation;
        let row = |k: usize| r[k][0] * v.x + r[k][1] * v.y + r[k][2] * v.z;
        Vector3::new(row(0), row(1), row(2))
    }
}

impl Energy {
    fn copy(&self) -> Energy {
        match *self {
            Energy::Bushing(i, j, p, a, k, c) => Energy::Bushing(i, j, p, a, k, c),
            Energy::Spring(a, b, f, k) => Energy::Spring(a, b, f, k),
            Energy::Rod(a, b, k) => Energy::Rod(a, b, k),
            Energy::Bar(a, b, k) => Energy::Bar(a, b, k),
            Energy::Slide(b, c, k) => Energy::Slide(b, c, k),
        }
    }
}

impl Constraint {
    fn copy(&self) -> Constraint {
        self.scaled(1.0)
    }

    /// Constraint with a share of its height or displacement.
    fn scaled(&self, share: f64) -> Constraint {
        match *self {
            Constraint::Rod(a, b) => Constraint::Rod(a, b),
            Constraint::Ball(a, b) => Constraint::Ball(a, b),
            Constraint::Height(a, z) => Constraint::Height(a, share * z),
            Constraint::Slide(b, c) => Constraint::Slide(b, share * c),
        }
    }
}

fn rotated<'t>(body: &Moved<'t>, v: Vector3<f64>) -> Vector3<Tracked<'t>> {
    let [a, b, c] = body.columns;
    a * Tracked::constant(v.x) + b * Tracked::constant(v.y) + c * Tracked::constant(v.z)
}

fn placed<'t>(
    body: &Moved<'t>,
    reference: Vector3<f64>,
    point: Vector3<f64>,
) -> Vector3<Tracked<'t>> {
    body.at + rotated(body, point - reference)
}

/// Rotation vector of body j relative to body i.
fn logarithm<'t>(i: &Moved<'t>, j: &Moved<'t>) -> Vector3<Tracked<'t>> {
    let entry = |a: usize, b: usize| i.columns[a].dot(j.columns[b]);
    let half = Tracked::constant(0.5);
    let sine = Vector3::new(
        (entry(2, 1) - entry(1, 2)) * half,
        (entry(0, 2) - entry(2, 0)) * half,
        (entry(1, 0) - entry(0, 1)) * half,
    );
    let square = sine.norm_squared();
    if square.value() < 1e-5 {
        let lit = Tracked::constant;
        let series = square * lit(5.0 / 112.0) + lit(3.0 / 40.0);
        let series = (series * square + lit(1.0 / 6.0)) * square + lit(1.0);
        return sine * series;
    }
    let one = Tracked::constant(1.0);
    let cosine = (entry(0, 0) + entry(1, 1) + entry(2, 2) - one) * half;
    let size = square.sqrt();
    sine * (size.atan2(cosine) / size)
}
