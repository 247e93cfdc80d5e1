//! Second formulation of elastic solid axles: the energy of links and springs over six coordinates of the axle, with
//! exact first and second derivatives.
//!
//! The coordinates x are the displacement of the midpoint of both wheel centres and the Gibbs vector of the rotation.
//! With the energy E, the heights W of the wheel centres and the heights C of the lowest points of the discs,
//!
//! ```text
//! dE/dx = V_l dC_l/dx + V_r dC_r/dx,   W_l = z_l,   W_r = z_r
//! ```
//!
//! V are the vertical forces of the ground on the discs, z the prescribed heights of the wheel centres; l is left, r is right.

use crate::support::larger;
use nalgebra::{DMatrix, DVector};

/// Number with its gradient and its matrix of second derivatives.
#[derive(Clone)]
pub struct Second {
    pub value: f64,
    pub gradient: DVector<f64>,
    pub second: DMatrix<f64>,
}

impl Second {
    fn constant(value: f64, count: usize) -> Self {
        Second {
            value,
            gradient: DVector::zeros(count),
            second: DMatrix::zeros(count, count),
        }
    }

    fn variable(value: f64, number: usize, count: usize) -> Self {
        let mut own = Second::constant(value, count);
        own.gradient[number] = 1.0;
        own
    }

    fn plus(&self, other: &Self) -> Self {
        Second {
            value: self.value + other.value,
            gradient: &self.gradient + &other.gradient,
            second: &self.second + &other.second,
        }
    }

    fn times(&self, other: &Self) -> Self {
        let cross = &self.gradient * other.gradient.transpose();
        Second {
            value: self.value * other.value,
            gradient: &self.gradient * other.value + &other.gradient * self.value,
            second: &self.second * other.value
                + &other.second * self.value
                + &cross
                + cross.transpose(),
        }
    }

    fn scaled(&self, by: f64) -> Self {
        Second {
            value: self.value * by,
            gradient: &self.gradient * by,
            second: &self.second * by,
        }
    }

    fn minus(&self, other: &Self) -> Self {
        self.plus(&other.scaled(-1.0))
    }

    /// Applies a function to the number, with the chain rule. The argument contains the function's value and its first
    /// two derivatives.
    fn of(&self, [value, slope, second]: [f64; 3]) -> Self {
        Second {
            value,
            gradient: &self.gradient * slope,
            second: &self.second * slope + &self.gradient * self.gradient.transpose() * second,
        }
    }

    fn inverse(&self) -> Self {
        let v = self.value;
        self.of([1.0 / v, -1.0 / (v * v), 2.0 / (v * v * v)])
    }

    fn root(&self) -> Self {
        let root = self.value.sqrt();
        self.of([root, 0.5 / root, -0.25 / (root * self.value)])
    }

    fn arc_tangent(&self) -> Self {
        let v = self.value;
        let d = 1.0 / (1.0 + v * v);
        self.of([v.atan(), d, -2.0 * v * d * d])
    }
}

pub type Triple = [Second; 3];

fn each(f: impl Fn(usize) -> Second) -> Triple {
    [f(0), f(1), f(2)]
}

fn sum(a: &Triple, b: &Triple) -> Triple {
    each(|i| a[i].plus(&b[i]))
}

fn difference(a: &Triple, b: &Triple) -> Triple {
    each(|i| a[i].minus(&b[i]))
}

fn dot(a: &Triple, b: &Triple) -> Second {
    let [x, y, z] = each(|i| a[i].times(&b[i]));
    x.plus(&y).plus(&z)
}

fn cross(a: &Triple, b: &Triple) -> Triple {
    each(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        a[j].times(&b[k]).minus(&a[k].times(&b[j]))
    })
}

/// Link: its ends on the body and on the axle, in vehicle coordinates, and its stiffness.
#[derive(Clone, Debug)]
pub struct Link {
    pub name: String,
    pub body: [f64; 3],
    pub axle: [f64; 3],
    pub rate: f64,
}

/// Spring: its ends on the body and on the axle, its force in the design position, and its rate.
#[derive(Clone, Debug)]
pub struct Spring {
    pub body: [f64; 3],
    pub axle: [f64; 3],
    pub force: f64,
    pub rate: f64,
}

/// Elastic solid axle in vehicle coordinates.
#[derive(Clone, Debug)]
pub struct Axle {
    pub links: Vec<Link>,
    pub springs: Vec<Spring>,
    /// Centre and outboard spin axis of the left and the right wheel.
    pub wheels: [([f64; 3], [f64; 3]); 2],
    pub radius: f64,
}

/// Input of the axle, with respect to which its results have derivatives.
#[derive(Clone, Debug, PartialEq)]
pub enum Input {
    /// Coordinates of link ends that move together. Each entry has the index of the link, `true` for the end on the axle,
    /// the axis, and a weight.
    Ends(Vec<(usize, bool, usize, f64)>),
    /// Stiffness of the links with these indices. All of them change by the same amount.
    Rate(Vec<usize>),
    /// Travel of a side.
    Travel(usize),
}

/// An equilibrium.
#[derive(Clone, Debug)]
pub struct Pose {
    pub x: DVector<f64>,
    pub vertical: [f64; 2],
}

/// Number of results at a pose: for each wheel toe, camber, centre and contact point; then steer, pitch and position of the
/// axle.
pub const RESULTS: usize = 2 * 8 + 5;

struct Frame {
    shift: Triple,
    gibbs: Triple,
    twice: Second,
    middle: [f64; 3],
    count: usize,
}

impl Frame {
    fn constant(&self, v: [f64; 3]) -> Triple {
        each(|i| Second::constant(v[i], self.count))
    }

    /// Returns a direction of the axle after the rotation of the axle.
    fn turned(&self, v: &Triple) -> Triple {
        let once = cross(&self.gibbs, v);
        let both = sum(&once, &cross(&self.gibbs, &once));
        each(|i| v[i].plus(&both[i].times(&self.twice)))
    }

    /// Returns the present position of a point of the axle. `point` is its design position.
    fn at(&self, point: &Triple) -> Triple {
        let middle = self.constant(self.middle);
        let lever = self.turned(&difference(point, &middle));
        sum(&sum(&lever, &middle), &self.shift)
    }
}

impl Axle {
    fn frame(&self, x: &DVector<f64>, count: usize) -> Frame {
        let variable = |i: usize| Second::variable(x[i], i, count);
        let gibbs = each(|i| variable(3 + i));
        let one = Second::constant(1.0, count);
        let twice = one.plus(&dot(&gibbs, &gibbs)).inverse().scaled(2.0);
        Frame {
            shift: each(variable),
            gibbs,
            twice,
            middle: std::array::from_fn(|i| 0.5 * (self.wheels[0].0[i] + self.wheels[1].0[i])),
            count,
        }
    }

    /// Returns the end of a link. The end moves with the inputs. The variables of the inputs have indices from 6.
    fn end(&self, frame: &Frame, inputs: &[Input], link: usize, is_axle: bool) -> Triple {
        let own = &self.links[link];
        let mut at = frame.constant(if is_axle { own.axle } else { own.body });
        for (k, input) in inputs.iter().enumerate() {
            let Input::Ends(ends) = input else { continue };
            for (number, end, axis, weight) in ends {
                if (*number, *end) == (link, is_axle) {
                    at[*axis].gradient[6 + k] += weight;
                }
            }
        }
        at
    }

    /// Length of a link minus its length in the design position.
    fn stretch(&self, frame: &Frame, inputs: &[Input], link: usize) -> Second {
        let [body, axle] = [false, true].map(|end| self.end(frame, inputs, link, end));
        let now = difference(&frame.at(&axle), &body);
        let before = difference(&axle, &body);
        let length = dot(&now, &now).root();
        length.minus(&dot(&before, &before).root())
    }

    fn energy(&self, frame: &Frame, inputs: &[Input]) -> Second {
        let mut energy = Second::constant(0.0, frame.count);
        for (link, own) in self.links.iter().enumerate() {
            let mut rate = Second::constant(own.rate, frame.count);
            for (k, input) in inputs.iter().enumerate() {
                if matches!(input, Input::Rate(links) if links.contains(&link)) {
                    rate.gradient[6 + k] = 1.0;
                }
            }
            let stretch = self.stretch(frame, inputs, link);
            let square = stretch.times(&stretch);
            energy = energy.plus(&rate.times(&square).scaled(0.5));
        }
        for spring in &self.springs {
            let [body, axle] = [spring.body, spring.axle].map(|v| frame.constant(v));
            let now = difference(&frame.at(&axle), &body);
            let before = difference(&axle, &body);
            let length = dot(&now, &now).root();
            let stretch = length.minus(&dot(&before, &before).root());
            let square = stretch.times(&stretch).scaled(0.5 * spring.rate);
            energy = energy.plus(&square.minus(&stretch.scaled(spring.force)));
        }
        energy
    }

    /// Centre and spin axis of a wheel.
    fn wheel(&self, frame: &Frame, side: usize) -> [Triple; 2] {
        let (centre, axis) = self.wheels[side];
        let centre = frame.at(&frame.constant(centre));
        [centre, frame.turned(&frame.constant(axis))]
    }

    /// Height of the lowest point of a disc.
    fn lowest(&self, [centre, axis]: &[Triple; 2]) -> Second {
        let one = Second::constant(1.0, axis[2].gradient.len());
        let drop = one.minus(&axis[2].times(&axis[2])).root();
        centre[2].minus(&drop.scaled(self.radius))
    }

    /// Residuals of the equilibrium, their derivatives with respect to coordinates and vertical forces, and their
    /// derivatives with respect to the inputs.
    fn system(
        &self,
        pose: &Pose,
        travels: [f64; 2],
        inputs: &[Input],
    ) -> (DVector<f64>, DMatrix<f64>, DMatrix<f64>) {
        let count = 6 + inputs.len();
        let frame = self.frame(&pose.x, count);
        let energy = self.energy(&frame, inputs);
        let mut force = energy.gradient.clone();
        let mut second = energy.second.clone();
        let mut residual = DVector::zeros(8);
        let mut matrix = DMatrix::zeros(8, 8);
        let mut by = DMatrix::zeros(8, inputs.len());
        for side in 0..2 {
            let wheel = self.wheel(&frame, side);
            let lowest = self.lowest(&wheel);
            let height = &wheel[0][2];
            force -= &lowest.gradient * pose.vertical[side];
            second -= &lowest.second * pose.vertical[side];
            residual[6 + side] = height.value - self.wheels[side].0[2] - travels[side];
            for i in 0..6 {
                matrix[(6 + side, i)] = height.gradient[i];
                matrix[(i, 6 + side)] = -lowest.gradient[i];
            }
            for (k, input) in inputs.iter().enumerate() {
                if *input == Input::Travel(side) {
                    by[(6 + side, k)] = -1.0;
                }
            }
        }
        for i in 0..6 {
            residual[i] = force[i];
            for j in 0..6 {
                matrix[(i, j)] = second[(i, j)];
            }
            for k in 0..inputs.len() {
                by[(i, k)] = second[(i, 6 + k)];
            }
        }
        (residual, matrix, by)
    }

    /// Finds the equilibrium at travels of both wheels by Newton's method, in small steps from the design position.
    pub fn solve(&self, travels: [f64; 2]) -> Pose {
        const STEPS: usize = 3;
        let mut pose = Pose {
            x: DVector::zeros(6),
            vertical: [0.0; 2],
        };
        for step in 1..=STEPS {
            let share = step as f64 / STEPS as f64;
            let here = travels.map(|travel| travel * share);
            let mut last = f64::INFINITY;
            for _ in 0..60 {
                let (residual, matrix, _) = self.system(&pose, here, &[]);
                let change = matrix.lu().solve(&-residual).expect("regular");
                for i in 0..6 {
                    pose.x[i] += change[i];
                }
                for side in 0..2 {
                    pose.vertical[side] += change[6 + side];
                }
                let size = (0..6).map(|i| {
                    let scale = if i < 3 { 1.0 } else { 500.0 };
                    (change[i] * scale).abs()
                });
                let size = size.fold(0.0, larger);
                // Each step of Newton's method squares the error, until the error is rounding.
                if size < 1e-9 && size >= 0.5 * last {
                    break;
                }
                last = size;
            }
        }
        pose
    }

    /// Derivatives of coordinates and vertical forces with respect to the inputs.
    pub fn sensitivities(&self, pose: &Pose, travels: [f64; 2], inputs: &[Input]) -> DMatrix<f64> {
        let (_, matrix, by) = self.system(pose, travels, inputs);
        matrix.lu().solve(&-by).expect("regular")
    }

    /// Tension of each link.
    pub fn tensions(&self, pose: &Pose) -> Vec<f64> {
        let frame = self.frame(&pose.x, 6);
        let links = self.links.iter().enumerate();
        links
            .map(|(k, link)| link.rate * self.stretch(&frame, &[], k).value)
            .collect()
    }

    /// Results at a pose, with derivatives with respect to the coordinates.
    fn read(&self, pose: &Pose) -> Vec<Second> {
        let frame = self.frame(&pose.x, 6);
        let mut found = Vec::new();
        for side in 0..2 {
            let out = if side == 0 { 1.0 } else { -1.0 };
            let wheel = self.wheel(&frame, side);
            let [centre, axis] = &wheel;
            let [x, y, z] = axis;
            let level = x.times(x).plus(&y.times(y)).root();
            found.push(x.times(&y.scaled(out).inverse()).arc_tangent());
            found.push(z.scaled(-1.0).times(&level.inverse()).arc_tangent());
            found.extend(centre.iter().cloned());
            // The lowest point lies in the disc plane, one radius from the centre. Its direction is -z minus the
            // component of -z along the axis.
            let along = z.times(&level.inverse()).scaled(self.radius);
            found.push(centre[0].plus(&along.times(x)));
            found.push(centre[1].plus(&along.times(y)));
            found.push(self.lowest(&wheel));
        }
        let [forward, line] =
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(|v| frame.turned(&frame.constant(v)));
        let steer = line[0].scaled(-1.0).times(&line[1].inverse());
        found.push(steer.arc_tangent());
        found.push(forward[2].times(&forward[0].inverse()).arc_tangent());
        found.extend(frame.shift.iter().cloned());
        found
    }

    /// Results at a pose.
    pub fn results(&self, pose: &Pose) -> Vec<f64> {
        self.read(pose).iter().map(|own| own.value).collect()
    }

    /// Derivatives of the results with respect to the inputs: one row for each result.
    pub fn slopes(&self, pose: &Pose, travels: [f64; 2], inputs: &[Input]) -> Vec<Vec<f64>> {
        let moved = self.sensitivities(pose, travels, inputs);
        let of = |own: &Second| {
            let by = |k: usize| (0..6).map(|i| own.gradient[i] * moved[(i, k)]).sum();
            (0..inputs.len()).map(by).collect()
        };
        self.read(pose).iter().map(of).collect()
    }
}
