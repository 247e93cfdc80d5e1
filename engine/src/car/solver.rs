//! Newton's method for the equations of [`super`], with the set of wheels in contact.

use super::catalogue::WheelPlace;
use super::corner::{Corner, Steps};
use super::equations::{
    BODY, Balance, GROUND, HELD_ROWS, Held, LOADS, LONGITUDINAL, PITCH, PITCH_MOMENT, ROLL,
    ROLL_MOMENT, SIDE_FORCES, TRAVELS, UNKNOWNS, VERTICAL,
};
use super::parameters::{AxleParameter, Parameters};
use super::{Car, Case, GRAVITY, LateralShares, LongitudinalShares, NoEquilibrium};
use crate::axle::{
    AxleQuantity, AxleSolver, Carriers, Placed, Placement, Quantity, Read, Reading, WheelParts,
    WheelQuantity,
};
use crate::linear::lu::Lu;
use crate::mechanism::DesignFault;
use crate::model::Side;
use crate::number::{Dual, Each, Real, Scalar};
use crate::threads::checkpoint;

/// Terms of the series of wheels: equations are made of first derivatives by travel, their tangents of second ones, and
/// derivatives of tangents by the design of third ones.
pub(super) const TERMS: usize = 4;
/// The most Newton steps for one set of wheels in contact, those back included.
const MOST_STEPS: usize = 60;
/// The most sets of wheels in contact that are tried.
const MOST_SETS: usize = 16;
/// Steps of the load if the case is not found at once.
const RAMP: usize = 16;
/// The longest Newton step: angles in radians, travels in metres.
const LONGEST_TURN: f64 = 0.0175;
const LONGEST_TRAVEL: f64 = 0.008;

pub(super) type Matrix = [[f64; UNKNOWNS]; UNKNOWNS];

/// Solves the states of one car, one case after another.
#[derive(Clone, Debug)]
pub struct CarSolver<'a> {
    /// The car.
    pub car: &'a Car,
    /// True if gradients contain the derivatives by the racks.
    pub(super) by_rack: bool,
    /// The car at rest on rigid and on elastic tyres, once it was solved.
    pub(super) rests: [Option<Result<Equilibrium, NoEquilibrium>>; 2],
    pub(super) axles: [AxleSolver<'a, TERMS>; 2],
}

/// A state in equilibrium.
#[derive(Clone, Debug)]
pub struct Equilibrium {
    /// The unknowns.
    pub unknowns: [f64; UNKNOWNS],
    /// Wheels off the ground: front left, front right, rear left, rear right.
    pub lifted: [bool; 4],
    /// Number of evaluations of the equations.
    pub evaluations: usize,
    /// For each axle the pose of both wheels.
    pub placed: [Placed; 2],
}

/// A state with the tangent of its equations.
struct Found {
    state: Equilibrium,
    tangent: Matrix,
}

/// The wheels of a state as they were read.
pub(super) struct Readings<'a> {
    pub placed: [Placed; 2],
    /// True if the wheels are known as functions of the racks.
    pub by_rack: bool,
    pub axles: [Read<'a>; 2],
}

/// Inputs of a state: the wheels as they were read at their travels.
pub(super) struct Base<'h, 'r, R> {
    pub held: Held<'h>,
    /// Wheels in the frames of their sides: front left, front right, rear left, rear right.
    pub readings: [&'r R; 4],
    /// Travels at which they were read.
    pub travels: [f64; 4],
    /// Racks of both axles at which they were read, if they are known as functions of the racks.
    pub racks: Option<[f64; 2]>,
    /// Carriers of the wheels of each axle.
    pub carriers: [Carriers; 2],
}

impl<R> Base<'_, '_, R> {
    /// A state with its forces. `lift` makes the wheels' numbers into numbers of this kind.
    pub(super) fn balance<T: Scalar, U: Real>(
        &self,
        parameters: &Parameters<T>,
        x: [T; UNKNOWNS],
        lift: impl Fn(U) -> T + Copy,
    ) -> Balance<T>
    where
        R: WheelParts<U>,
    {
        let step = |number: usize| {
            let travel = x[TRAVELS + number];
            travel - travel.lit(self.travels[number])
        };
        let corners = [0, 1, 2, 3].each(|number| {
            let axle = number / 2;
            let sign = Side::ALL[number % 2].sign();
            let rack = self.racks.map(|racks| {
                let rack = parameters.axle(axle, AxleParameter::Rack);
                (rack - rack.lit(racks[axle])).scaled(sign)
            });
            let steps = Steps {
                own: step(number),
                other: step(number ^ 1),
                rack,
            };
            Corner::read(
                self.readings[number],
                (sign, self.carriers[axle]),
                parameters.offset(axle),
                steps,
                lift,
            )
        });
        Balance::of(&self.held, parameters, corners, x)
    }
}

impl Readings<'_> {
    /// The wheels, front left, front right, rear left, rear right.
    pub(super) fn wheels(&self) -> [&Reading<f64>; 4] {
        let [front, rear] = &self.axles;
        let ([a, b], [c, d]) = (&front.state.readings, &rear.state.readings);
        [a, b, c, d]
    }

    /// Returns the inputs from which nearby states are evaluated.
    pub(super) fn base<'h>(&self, held: Held<'h>) -> Base<'h, '_, Reading<f64>> {
        let [front, rear] = &self.placed;
        Base {
            held,
            racks: self.by_rack.then(|| self.placed.map(|placed| placed.rack)),
            carriers: self.axles.each_ref().map(|read| read.state.carriers),
            readings: self.wheels(),
            travels: [
                front.travels[0],
                front.travels[1],
                rear.travels[0],
                rear.travels[1],
            ],
        }
    }
}

/// The quantities whose inputs the equations read.
fn read_of(car: &Car, axle: usize) -> Vec<Quantity> {
    let axle = &car.axles[axle];
    let mut quantities = Vec::new();
    for side in Side::ALL {
        if axle.setup.springs.is_some() {
            quantities.push(Quantity::Wheel(side, WheelQuantity::SpringForce));
        }
    }
    let own = [
        AxleQuantity::BarTorque,
        AxleQuantity::HeaveSpringForce,
        AxleQuantity::TBarTorque,
        AxleQuantity::HeaveBarTorque,
    ];
    let own = own.map(Quantity::Axle).into_iter();
    quantities.extend(own.filter(|quantity| axle.has(*quantity)));
    quantities
}

impl<'a> CarSolver<'a> {
    /// A solver. Errors if the design position of a wheel cannot be solved.
    pub fn new(car: &'a Car) -> Result<Self, (usize, Side, DesignFault)> {
        Self::made(car, false)
    }

    /// A solver whose gradients contain the derivatives by the racks. It takes longer.
    pub fn with_racks(car: &'a Car) -> Result<Self, (usize, Side, DesignFault)> {
        Self::made(car, true)
    }

    fn made(car: &'a Car, by_rack: bool) -> Result<Self, (usize, Side, DesignFault)> {
        let axle = |number: usize| {
            let made = AxleSolver::new(&car.axles[number], &read_of(car, number), by_rack);
            made.map_err(|(side, fault)| (number, side, fault))
        };
        Ok(CarSolver {
            car,
            by_rack,
            rests: [None, None],
            axles: [axle(0)?, axle(1)?],
        })
    }

    /// Reads the wheels at these travels.
    pub(super) fn read(
        &mut self,
        travels: [f64; 4],
        racks: [f64; 2],
    ) -> Result<Readings<'a>, NoEquilibrium> {
        let mut read = |axle: usize| {
            let solver = &mut self.axles[axle];
            let placement = Placement::Travels {
                travels: [travels[2 * axle], travels[2 * axle + 1]],
                rack: racks[axle],
                on_plane: false,
            };
            let fails = |failure| NoEquilibrium::NoPose { axle, failure };
            let placed = solver.place(&placement).map_err(fails)?;
            let read = solver.read(&placed).map_err(fails)?;
            match read.toggle_failure(&placed) {
                Some(failure) => Err(fails(failure)),
                None => Ok((placed, read)),
            }
        };
        let (front, rear) = (read(0)?, read(1)?);
        Ok(Readings {
            by_rack: self.by_rack,
            placed: [front.0, rear.0],
            axles: [front.1, rear.1],
        })
    }

    /// Finds the state of a case.
    pub fn solve(&mut self, case: &Case) -> Result<Equilibrium, NoEquilibrium> {
        if self.has_no_springs() {
            return Err(NoEquilibrium::Unsupported);
        }
        let start = self.start(case);
        let first = match self.with_contact(case, start, [false; 4]) {
            Ok(found) => return Self::stable(found),
            Err(failure) => failure,
        };
        // Along the load from rest; the failure of the direct way says more if this fails, too.
        let mut at = (start, [false; 4]);
        let mut evaluations = 0;
        for step in 0..=RAMP {
            let part = step as f64 / RAMP as f64;
            let partial = case.scaled(part);
            match self.with_contact(&partial, at.0, at.1) {
                Ok(mut found) => {
                    at = (found.state.unknowns, found.state.lifted);
                    evaluations += found.state.evaluations;
                    if step == RAMP {
                        found.state.evaluations = evaluations;
                        return Self::stable(found);
                    }
                }
                Err(_) => return Err(first),
            }
        }
        Err(first)
    }

    /// Finds the state of a case from a neighbouring state.
    pub fn solve_from(
        &mut self,
        case: &Case,
        from: &Equilibrium,
    ) -> Result<Equilibrium, NoEquilibrium> {
        match self.with_contact(case, from.unknowns, from.lifted) {
            Ok(found) => Self::stable(found),
            Err(_) => self.solve(case),
        }
    }

    /// Finds the state of a case from given attitude and travels: roll, pitch, height of the ground, travels.
    pub fn solve_from_attitude(
        &mut self,
        case: &Case,
        attitude: [f64; 7],
    ) -> Result<Equilibrium, NoEquilibrium> {
        let mut start = self.start(case);
        start[..7].copy_from_slice(&attitude);
        match self.with_contact(case, start, [false; 4]) {
            Ok(found) => Self::stable(found),
            Err(_) => self.solve(case),
        }
    }

    fn has_no_springs(&self) -> bool {
        let axles = self.car.axles.iter();
        axles.clone().any(|axle| !axle.setup.is_sprung())
    }

    /// The design position with a quarter of the weight on each wheel.
    pub(super) fn start(&self, case: &Case) -> [f64; UNKNOWNS] {
        let car = self.car;
        let mut x = [0.0; UNKNOWNS];
        let heights = car.axles.iter().enumerate().flat_map(|(number, axle)| {
            let offset = if number == 0 { 0.0 } else { car.rear_offset.z };
            let radius = axle.setup.wheel_radius.unwrap_or(f64::NAN);
            Side::ALL.map(|side| {
                let wheel = axle.suspension(side);
                wheel.design[wheel.mechanism.wheel_centre.0].z + offset - radius
            })
        });
        x[GROUND] = 0.25 * heights.sum::<f64>();
        let unsprung: f64 = car
            .axles
            .iter()
            .filter_map(|axle| axle.setup.unsprung_mass)
            .sum();
        let mass = match car.masses {
            super::Masses::Whole => car.mass,
            super::Masses::Sprung => car.mass + unsprung,
        };
        x[LOADS..LOADS + 4].fill(0.25 * mass * GRAVITY * (1.0 + case.az));
        x
    }

    /// Solves with one set of wheels in contact after another until one fits.
    fn with_contact(
        &mut self,
        case: &Case,
        start: [f64; UNKNOWNS],
        lifted: [bool; 4],
    ) -> Result<Found, NoEquilibrium> {
        let mut seen: Vec<[bool; 4]> = Vec::new();
        let mut lifted = lifted;
        let mut x = start;
        let mut evaluations = 0;
        for _ in 0..MOST_SETS {
            checkpoint();
            seen.push(lifted);
            self.refuse_lifted_axles(case, &lifted)?;
            let mut found = self.newton(case, x, lifted)?;
            evaluations += found.state.evaluations;
            let gaps = self.gaps(case, &found.state)?;
            let next = [0, 1, 2, 3].map(|number| match lifted[number] {
                true => gaps[number] >= 0.0,
                false => found.state.unknowns[LOADS + number] < 0.0,
            });
            if next == lifted {
                found.state.evaluations = evaluations;
                return Ok(found);
            }
            if seen.contains(&next) {
                let changing = (0..4).find(|number| next[*number] != lifted[*number]);
                let setting = &case.setting;
                return Err(NoEquilibrium::NoContactSet {
                    wheel: WheelPlace(changing.unwrap_or(0)),
                    equal_shares: setting.lateral_shares != LateralShares::ByLoad
                        || setting.longitudinal_shares != LongitudinalShares::ByLoad,
                });
            }
            x = found.state.unknowns;
            lifted = next;
        }
        Err(NoEquilibrium::NotFound)
    }

    fn refuse_lifted_axles(&self, case: &Case, lifted: &[bool; 4]) -> Result<(), NoEquilibrium> {
        let off = [lifted[0] && lifted[1], lifted[2] && lifted[3]];
        if off == [true; 2] || case.az <= -1.0 {
            return Err(NoEquilibrium::AllLifted);
        }
        match off.iter().position(|off| *off) {
            Some(axle) => Err(NoEquilibrium::AxleLifted { axle }),
            None => Ok(()),
        }
    }

    fn gaps(&mut self, case: &Case, found: &Equilibrium) -> Result<[f64; 4], NoEquilibrium> {
        if found.lifted == [false; 4] {
            return Ok([0.0; 4]);
        }
        let balance = self.balance(case, found)?;
        Ok(balance.wheels.map(|wheel| wheel.gap))
    }

    /// A state with its forces.
    pub fn balance(
        &mut self,
        case: &Case,
        found: &Equilibrium,
    ) -> Result<Balance<f64>, NoEquilibrium> {
        let readings = self.readings(found)?;
        let parameters = Parameters::of(self.car, case);
        let base = readings.base(self.held(case, found));
        Ok(base.balance(&parameters, found.unknowns, |c: f64| c))
    }

    /// The wheels of a state that was found.
    pub(super) fn readings(&mut self, found: &Equilibrium) -> Result<Readings<'a>, NoEquilibrium> {
        let mut read = |axle: usize| {
            let placed = &found.placed[axle];
            let read = self.axles[axle].read(placed);
            read.map_err(|failure| NoEquilibrium::NoPose { axle, failure })
        };
        let axles = [read(0)?, read(1)?];
        Ok(Readings {
            by_rack: self.by_rack,
            axles,
            placed: found.placed,
        })
    }

    pub(super) fn held<'h>(&self, case: &'h Case, found: &Equilibrium) -> Held<'h>
    where
        'a: 'h,
    {
        Held {
            car: self.car,
            case,
            lifted: found.lifted,
        }
    }

    /// Newton's method for one set of wheels in contact.
    fn newton(
        &mut self,
        case: &Case,
        start: [f64; UNKNOWNS],
        lifted: [bool; 4],
    ) -> Result<Found, NoEquilibrium> {
        let held = Held {
            car: self.car,
            case,
            lifted,
        };
        let parameters = Parameters::of(self.car, case);
        let metre = self.car.per_metre();
        let weight = start[LOADS..LOADS + 4]
            .iter()
            .map(|n| n.abs())
            .sum::<f64>()
            .max(1.0);
        let size = |k: usize| match k {
            ROLL | PITCH => 1.0,
            GROUND..LOADS => metre,
            _ => weight,
        };
        let mut x = start;
        let mut reached: Option<[f64; UNKNOWNS]> = None;
        let mut smallest = f64::INFINITY;
        let mut evaluations = 0;
        for _ in 0..MOST_STEPS {
            let travels: [f64; 4] = [0, 1, 2, 3].map(|k| x[TRAVELS + k]);
            let readings = match self.read(travels, case.racks) {
                Ok(readings) => readings,
                // Half the way back to where the wheels had poses.
                Err(failure) => {
                    let back = reached.ok_or_else(|| failure.clone())?;
                    let far = (0..4).map(|k| (x[TRAVELS + k] - back[TRAVELS + k]).abs());
                    if far.fold(0.0, f64::max) <= 1e-9 * metre {
                        return Err(failure);
                    }
                    for k in 0..UNKNOWNS {
                        x[k] = 0.5 * (x[k] + back[k]);
                    }
                    continue;
                }
            };
            evaluations += 1;
            let (residuals, tangent) = tangent(&readings.base(held), &parameters, &x);
            let (matrix, scales) = scaled(&tangent);
            let lu = Lu::of(matrix, 1.0).ok_or(NoEquilibrium::Singular)?;
            let mut right = residuals;
            for (residual, scale) in right.iter_mut().zip(scales) {
                *residual *= -scale;
            }
            let step = lu.solve(right);
            let longest = (0..UNKNOWNS)
                .map(|k| (step[k] / size(k)).abs())
                .fold(0.0_f64, f64::max);
            if !longest.is_finite() {
                return Err(NoEquilibrium::Singular);
            }
            if longest <= 2.0 * f64::EPSILON || longest >= smallest && smallest <= 1e-10 {
                return Ok(Found {
                    state: Equilibrium {
                        unknowns: x,
                        lifted,
                        evaluations,
                        placed: readings.placed,
                    },
                    tangent,
                });
            }
            smallest = smallest.min(longest);
            let too_long = (0..LOADS).map(|k| match k {
                ROLL | PITCH => step[k].abs() / LONGEST_TURN,
                _ => step[k].abs() / (LONGEST_TRAVEL * metre),
            });
            let shrink = 1.0 / too_long.fold(1.0, f64::max);
            reached = Some(x);
            for k in 0..UNKNOWNS {
                x[k] += shrink * step[k];
            }
        }
        Err(NoEquilibrium::NotFound)
    }

    /// The state, if springs turn and lift the body back to it: the symmetric part of the body's stiffness is positive
    /// definite, travels and loads free, A and B held.
    fn stable(found: Found) -> Result<Equilibrium, NoEquilibrium> {
        let Found { state, tangent } = found;
        let inverse = held_inverse(&tangent).ok_or(NoEquilibrium::Singular)?;
        let stiffness = body_stiffness(&tangent, &inverse);
        let k = |i: usize, j: usize| 0.5 * (stiffness[i][j] + stiffness[j][i]);
        let minor = k(0, 0) * k(1, 1) - k(0, 1) * k(0, 1);
        let determinant = k(0, 0) * (k(1, 1) * k(2, 2) - k(1, 2) * k(1, 2))
            - k(0, 1) * (k(0, 1) * k(2, 2) - k(1, 2) * k(0, 2))
            + k(0, 2) * (k(0, 1) * k(1, 2) - k(1, 1) * k(0, 2));
        match k(0, 0) > 0.0 && minor > 0.0 && determinant > 0.0 {
            true => Ok(state),
            false => Err(NoEquilibrium::Tips),
        }
    }
}

impl Case {
    /// The case with a part of its accelerations; everything else as it is.
    fn scaled(&self, part: f64) -> Case {
        Case {
            ax: self.ax * part,
            ay: self.ay * part,
            az: self.az * part,
            yaw_acceleration: self.yaw_acceleration * part,
            ..self.clone()
        }
    }
}

/// Residuals and their derivatives by the unknowns.
pub(super) fn tangent(
    base: &Base<'_, '_, Reading<f64>>,
    parameters: &Parameters<f64>,
    x: &[f64; UNKNOWNS],
) -> ([f64; UNKNOWNS], Matrix) {
    let mut unknowns = [Dual::<f64, UNKNOWNS>::constant(0.0); UNKNOWNS];
    for (k, unknown) in unknowns.iter_mut().enumerate() {
        *unknown = Dual::input(x[k], k);
    }
    let balance = base.balance(&parameters.map(Dual::constant), unknowns, Dual::constant);
    (
        balance.residuals.map(|row| row.value),
        balance.residuals.map(|row| row.partials),
    )
}

/// The matrix with each row divided by its largest entry, and the factors.
fn scaled(matrix: &Matrix) -> (Matrix, [f64; UNKNOWNS]) {
    let scales = matrix.map(|row| 1.0 / row.iter().fold(0.0_f64, |m, c| m.max(c.abs())));
    let mut scaled = *matrix;
    for (row, scale) in scaled.iter_mut().zip(scales) {
        row.iter_mut().for_each(|c| *c *= scale);
    }
    (scaled, scales)
}

/// The inverse of a matrix.
pub(super) fn inverse(matrix: &Matrix) -> Option<Matrix> {
    let (scaled, scales) = scaled(matrix);
    let mut inverse = Lu::of(scaled, 1.0)?.inverse();
    for row in &mut inverse {
        for (c, scale) in row.iter_mut().zip(scales) {
            *c *= scale;
        }
    }
    Some(inverse)
}

/// Unknowns that are held in motions of the body: the attitude and the forces along the ground.
pub(super) const HELD: [usize; 6] = [
    ROLL,
    PITCH,
    GROUND,
    SIDE_FORCES,
    SIDE_FORCES + 1,
    LONGITUDINAL,
];

/// The inverse of the tangent with the equations of the whole car replaced by held unknowns, in the order of [`HELD`].
pub(super) fn held_inverse(tangent: &Matrix) -> Option<Matrix> {
    let mut matrix = *tangent;
    for (row, unknown) in matrix[BODY..].iter_mut().zip(HELD) {
        row.fill(0.0);
        row[unknown] = 1.0;
    }
    inverse(&matrix)
}

/// Stiffness of the body by (gamma, phi, theta): growth of the vertical force and of the moments about -x and -e.
pub(super) fn body_stiffness(tangent: &Matrix, held: &Matrix) -> [[f64; 3]; 3] {
    let rows = [(VERTICAL, 1.0), (ROLL_MOMENT, -1.0), (PITCH_MOMENT, -1.0)];
    // The change of all unknowns by one of gamma, phi, theta is a column of the inverse.
    rows.map(|(row, sign)| {
        HELD_ROWS.map(|motion| {
            let change = (0..UNKNOWNS).map(|k| tangent[row][k] * held[k][BODY + motion]);
            sign * change.sum::<f64>()
        })
    })
}
