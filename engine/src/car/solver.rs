//! Newton's method for the equations of [`super`], with a search for the set of wheels in contact.

use super::catalogue::WheelPlace;
use super::corner::{Corner, Steps};
use super::equations::{Balance, GROUND, Held, LOADS, PITCH, ROLL, TRAVELS, UNKNOWNS};
use super::parameters::{AxleParameter, Parameters};
use super::tangent::{Factors, Matrix, tangent};
use super::{Car, Case, GRAVITY, LateralShares, LongitudinalShares, NoEquilibrium};
use crate::axle::{
    Axle, AxlePose, AxleQuantity, AxleSolver, Carriers, Placement, Quantity, Read, Reading,
    WheelCurve, WheelParts, WheelQuantity,
};
use crate::mechanism::DesignFault;
use crate::model::Side;
use crate::number::{Each, Real, Scalar};
use crate::threads::checkpoint;

/// Number of terms in the series of wheels. Equations need first derivatives by travel, and their tangents need second ones.
/// Derivatives of tangents by the design need third ones.
pub(super) const TERMS: usize = 4;
/// Largest number of Newton steps for one set of wheels in contact. Steps back count as well.
const MOST_STEPS: usize = 60;
/// Largest number of sets of wheels in contact that are tried.
const MOST_SETS: usize = 16;
/// Largest changes in a Newton step: angles in radians, travels in metres.
pub(super) const LONGEST_TURN: f64 = 0.0175;
pub(super) const LONGEST_TRAVEL: f64 = 0.008;
/// A tangent is computed anew unless each step is at most this fraction of the one before.
const CONTRACTION: f64 = 0.1;
/// After a step below this, in sizes of the unknowns, the tangent serves for the next step.
const NEAR: f64 = 2e-3;
/// A step below this, in sizes of the unknowns, is rounding error.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Solver for the states of one car, one case after another.
#[derive(Clone, Debug)]
pub struct CarSolver<'a> {
    /// Car to solve.
    pub car: &'a Car,
    /// True if gradients contain the derivatives by the racks.
    pub(super) by_rack: bool,
    /// State of the car at rest on rigid and on elastic tyres, once solved.
    pub(super) rests: [Option<Result<Equilibrium, NoEquilibrium>>; 2],
    pub(super) axles: [AxleSolver<'a, TERMS>; 2],
    /// Curves of the wheels along their travels. `None` if a wheel depends on more than its own travel.
    curves: Option<Box<[WheelCurve; 4]>>,
}

/// A state in equilibrium.
#[derive(Clone, Debug)]
pub struct Equilibrium {
    /// Values of the unknowns.
    pub unknowns: [f64; UNKNOWNS],
    /// True for each lifted wheel: front left, front right, rear left, rear right.
    pub lifted: [bool; 4],
    /// Number of evaluations of the equations.
    pub evaluations: usize,
    /// Pose of both wheels of each axle.
    pub placed: [AxlePose; 2],
    /// True if the wheels come from their curves, which agree with poses up to rounding error.
    pub(super) is_near: bool,
    /// Derivatives of the equations by the unknowns.
    pub(super) tangent: Box<Matrix>,
    /// Factors of the tangent.
    pub(super) factors: Box<Factors>,
}

/// Wheels of a state during the iteration to equilibrium.
pub(super) enum Wheels<'a> {
    /// Wheels from their curves.
    Near(Box<[Reading<f64>; 4]>),
    /// Wheels from poses.
    Exact(Box<Readings<'a>>),
}

/// Start of Newton's method: unknowns, lifted wheels and factors of a tangent.
#[derive(Clone, Copy)]
pub(super) struct Start<'f> {
    unknowns: [f64; UNKNOWNS],
    lifted: [bool; 4],
    factors: Option<&'f Factors>,
    /// True if the wheels of the result may come from their curves.
    may_be_near: bool,
}

impl<'f> Start<'f> {
    /// Starts with all wheels down.
    pub(super) fn of(unknowns: [f64; UNKNOWNS]) -> Self {
        Start {
            unknowns,
            lifted: [false; 4],
            factors: None,
            may_be_near: false,
        }
    }

    /// Starts from a state that was found.
    pub(super) fn at(found: &'f Equilibrium) -> Self {
        Start {
            unknowns: found.unknowns,
            lifted: found.lifted,
            factors: Some(&found.factors),
            may_be_near: false,
        }
    }

    /// Starts from a neighbouring state, as in a map. Wheels may come from their curves.
    fn beside(found: &'f Equilibrium) -> Self {
        Start {
            may_be_near: true,
            ..Start::at(found)
        }
    }
}

/// Readings of the wheels in a state.
pub(super) struct Readings<'a> {
    pub placed: [AxlePose; 2],
    /// True if the readings include the dependence of the wheels on the racks.
    pub by_rack: bool,
    pub axles: [Read<'a>; 2],
}

/// Inputs of a state, with readings of the wheels at their travels.
pub(super) struct Base<'h, 'r, R> {
    pub held: Held<'h>,
    /// Wheels in the frames of their sides: front left, front right, rear left, rear right.
    pub readings: [&'r R; 4],
    /// Travels of the readings.
    pub travels: [f64; 4],
    /// Racks of both axles in the readings, if these include the dependence on the racks.
    pub racks: Option<[f64; 2]>,
    /// Type of the wheel carriers of each axle.
    pub carriers: [Carriers; 2],
}

impl<R> Base<'_, '_, R> {
    /// Computes a state with its forces. `lift` converts the wheels' numbers to numbers of this kind.
    pub(super) fn balance<T: Scalar, U: Real>(
        &self,
        parameters: &Parameters<T>,
        x: [T; UNKNOWNS],
        lift: impl Fn(U) -> T + Copy,
    ) -> Balance<T>
    where
        R: WheelParts<U>,
    {
        let corners = [0, 1, 2, 3].each(|number: usize| {
            let travels = [number, number ^ 1].each(|wheel| x[TRAVELS + wheel]);
            self.corner(parameters, number, travels, lift)
        });
        Balance::of(&self.held, parameters, corners, x)
    }

    /// Computes a wheel at its own travel and the other wheel's travel.
    pub(super) fn corner<T: Scalar, U: Real>(
        &self,
        parameters: &Parameters<T>,
        number: usize,
        [own, other]: [T; 2],
        lift: impl Fn(U) -> T + Copy,
    ) -> Corner<T>
    where
        R: WheelParts<U>,
    {
        let axle = number / 2;
        let sign = Side::ALL[number % 2].sign();
        let rack = self.racks.map(|racks| {
            let rack = parameters.axle(axle, AxleParameter::Rack);
            (rack - rack.constant(racks[axle])).scaled(sign)
        });
        let steps = Steps {
            own: own - own.constant(self.travels[number]),
            other: other - other.constant(self.travels[number ^ 1]),
            rack,
        };
        Corner::read(
            self.readings[number],
            (sign, self.carriers[axle]),
            parameters.offset(axle),
            steps,
            lift,
        )
    }
}

impl Readings<'_> {
    /// Readings in order: front left, front right, rear left, rear right.
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

/// Quantities with the inputs that the equations read.
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
        AxleQuantity::BeamTorque,
        AxleQuantity::HeaveSpringForce,
        AxleQuantity::TBarTorque,
        AxleQuantity::HeaveBarTorque,
    ];
    let own = own.map(Quantity::Axle).into_iter();
    quantities.extend(own.filter(|quantity| axle.has(*quantity)));
    quantities
}

impl<'a> CarSolver<'a> {
    /// Makes a solver. The error names a wheel without a pose in the design position.
    pub fn new(car: &'a Car) -> Result<Self, (usize, Side, DesignFault)> {
        Self::made(car, false)
    }

    /// Makes a solver whose gradients include the derivatives by the racks. Its gradients take longer.
    pub fn with_racks(car: &'a Car) -> Result<Self, (usize, Side, DesignFault)> {
        Self::made(car, true)
    }

    fn made(car: &'a Car, by_rack: bool) -> Result<Self, (usize, Side, DesignFault)> {
        let axle = |number: usize| {
            let made = AxleSolver::new(&car.axles[number], &read_of(car, number), by_rack);
            made.map_err(|(side, fault)| (number, side, fault))
        };
        let axles = [axle(0)?, axle(1)?];
        let has_curves = !by_rack && !car.axles.iter().any(Axle::is_rigid);
        let curve = |number: usize| WheelCurve::new(&axles[number / 2], Side::ALL[number % 2]);
        Ok(CarSolver {
            car,
            by_rack,
            rests: [None, None],
            curves: has_curves.then(|| Box::new([0, 1, 2, 3].map(curve))),
            axles,
        })
    }

    /// Reads the wheels at these travels from their curves; `None` if a wheel has no curve there.
    fn near(&mut self, travels: [f64; 4], racks: [f64; 2]) -> Option<Box<[Reading<f64>; 4]>> {
        let curves = self.curves.as_mut()?;
        let mut read = |number: usize| {
            let axle = number / 2;
            let solver = &mut self.axles[axle];
            curves[number].at(solver, travels[number], racks[axle])
        };
        let wheels = [read(0)?, read(1)?, read(2)?, read(3)?];
        Some(Box::new(wheels))
    }

    /// Solves the poses of all wheels at these travels.
    fn placed(
        &mut self,
        travels: [f64; 4],
        racks: [f64; 2],
    ) -> Result<[AxlePose; 2], NoEquilibrium> {
        let mut place = |axle: usize| {
            let placement = Placement::Travels {
                travels: [travels[2 * axle], travels[2 * axle + 1]],
                rack: racks[axle],
                on_plane: false,
            };
            let placed = self.axles[axle].place(&placement);
            placed.map_err(|failure| NoEquilibrium::NoPose { axle, failure })
        };
        Ok([place(0)?, place(1)?])
    }

    /// Reads the wheels at these travels.
    pub(super) fn read(
        &mut self,
        travels: [f64; 4],
        racks: [f64; 2],
    ) -> Result<Readings<'a>, NoEquilibrium> {
        let placed = self.placed(travels, racks)?;
        let mut read = |axle: usize| {
            let solver = &mut self.axles[axle];
            let fails = |failure| NoEquilibrium::NoPose { axle, failure };
            let placed = placed[axle];
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
        match self.with_contact(case, Start::of(self.start(case))) {
            Ok(found) if found.is_stiff() => Ok(found),
            Ok(_) => self.along_load(case),
            // Both searches failed. The direct search gives the more specific reason.
            Err(first) => self.along_load(case).map_err(|along| match first {
                NoEquilibrium::NotFound
                | NoEquilibrium::Singular
                | NoEquilibrium::NoContactSet {
                    equal_shares: false,
                    ..
                } => along,
                _ => first,
            }),
        }
    }

    /// Finds the state of a case from a neighbouring state that was accepted. Its wheels come from their curves, so its
    /// numbers can differ from those of [`CarSolver::solve`] by rounding error.
    pub fn solve_from(
        &mut self,
        case: &Case,
        from: &Equilibrium,
    ) -> Result<Equilibrium, NoEquilibrium> {
        match self.solve_beside(case, from) {
            Some(found) => Ok(found),
            None => self.solve(case),
        }
    }

    /// Finds the state of a case that follows a neighbouring state without a turning point. `None` if Newton's method does
    /// not lead from one to the other.
    pub(super) fn solve_beside(&mut self, case: &Case, from: &Equilibrium) -> Option<Equilibrium> {
        let found = self.with_contact(case, Start::beside(from)).ok()?;
        (found.is_stiff() || found.follows(from, self.car)).then_some(found)
    }

    /// Finds the state of a case from a given start: roll, pitch, height of the ground, travels.
    pub fn solve_from_attitude(
        &mut self,
        case: &Case,
        attitude: [f64; 7],
    ) -> Result<Equilibrium, NoEquilibrium> {
        let mut start = self.start(case);
        start[..7].copy_from_slice(&attitude);
        match self.with_contact(case, Start::of(start)) {
            Ok(found) if found.is_stiff() => Ok(found),
            _ => self.solve(case),
        }
    }

    fn has_no_springs(&self) -> bool {
        let axles = self.car.axles.iter();
        axles.clone().any(|axle| !axle.setup.is_sprung())
    }

    /// Start in the design position, with a quarter of the weight on each wheel.
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

    /// Solves with one set of wheels in contact after another, until a set fits.
    pub(super) fn with_contact(
        &mut self,
        case: &Case,
        start: Start<'_>,
    ) -> Result<Equilibrium, NoEquilibrium> {
        let mut seen: Vec<[bool; 4]> = Vec::new();
        let Start {
            unknowns: mut x,
            mut lifted,
            mut factors,
            may_be_near,
        } = start;
        let mut evaluations = 0;
        for _ in 0..MOST_SETS {
            checkpoint();
            seen.push(lifted);
            self.refuse_lifted_axles(case, &lifted)?;
            let start = Start {
                unknowns: x,
                lifted,
                factors: factors.take(),
                may_be_near,
            };
            let mut found = self.newton(case, start)?;
            evaluations += found.evaluations;
            let gaps = self.gaps(case, &found)?;
            let next = [0, 1, 2, 3].map(|number| match lifted[number] {
                true => gaps[number] >= 0.0,
                false => found.unknowns[LOADS + number] < 0.0,
            });
            if next == lifted {
                found.evaluations = evaluations;
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
            x = found.unknowns;
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

    /// Computes a state with its forces.
    pub fn balance(
        &mut self,
        case: &Case,
        found: &Equilibrium,
    ) -> Result<Balance<f64>, NoEquilibrium> {
        let wheels = self.wheels_of(found)?;
        let parameters = Parameters::of(self.car, case);
        let base = wheels.base(self.held(case, found), found.travels());
        Ok(base.balance(&parameters, found.unknowns, |c: f64| c))
    }

    /// Reads the wheels of a state that was found: from their curves if the state used those, otherwise from poses.
    pub(super) fn wheels_of(&mut self, found: &Equilibrium) -> Result<Wheels<'a>, NoEquilibrium> {
        if found.is_near {
            let racks = found.placed.map(|placed| placed.rack);
            if let Some(near) = self.near(found.travels(), racks) {
                return Ok(Wheels::Near(near));
            }
        }
        Ok(Wheels::Exact(Box::new(self.readings(found)?)))
    }

    /// Reads the wheels of a state that was found, from their poses.
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

    /// Reads the wheels at these travels. `is_exact` demands poses.
    fn wheels(
        &mut self,
        travels: [f64; 4],
        racks: [f64; 2],
        is_exact: bool,
    ) -> Result<Wheels<'a>, NoEquilibrium> {
        if !is_exact && let Some(near) = self.near(travels, racks) {
            return Ok(Wheels::Near(near));
        }
        Ok(Wheels::Exact(Box::new(self.read(travels, racks)?)))
    }

    /// Newton's method for one set of wheels in contact. It keeps the factors of a tangent, at first those of the start,
    /// while each step is at most a tenth of the one before. The wheels come from their curves until the last step, which
    /// reads poses. If the state may be near, the last step uses the curves as well.
    fn newton(&mut self, case: &Case, start: Start<'_>) -> Result<Equilibrium, NoEquilibrium> {
        let Start {
            unknowns: start,
            lifted,
            factors: known,
            may_be_near,
        } = start;
        let held = Held {
            car: self.car,
            case,
            lifted,
        };
        let parameters = Parameters::of(self.car, case);
        let sizes = Sizes::of(&start, self.car);
        let mut x = start;
        let mut reached: Option<[f64; UNKNOWNS]> = None;
        let mut smallest = f64::INFINITY;
        let mut evaluations = 0;
        let mut factors = known.cloned();
        let mut is_last = self.curves.is_none();
        for _ in 0..MOST_STEPS {
            let travels: [f64; 4] = [0, 1, 2, 3].map(|k| x[TRAVELS + k]);
            let wheels = match self.wheels(travels, case.racks, is_last) {
                Ok(wheels) => wheels,
                Err(failure) => {
                    x = sizes.half_way_back(&x, reached.as_ref()).ok_or(failure)?;
                    continue;
                }
            };
            evaluations += 1;
            let base = wheels.base(held, travels);
            let is_fresh = factors.is_none();
            let (residuals, lu) = match factors.take() {
                Some(factors) => (base.balance(&parameters, x, |c: f64| c).residuals, factors),
                None => {
                    let (residuals, tangent) = tangent(&base, &parameters, &x);
                    let factors = Factors::of(&tangent).ok_or(NoEquilibrium::Singular)?;
                    (residuals, factors)
                }
            };
            let step = lu.solve(residuals.map(|residual| -residual));
            let longest = sizes.longest(&step);
            if !longest.is_finite() {
                // Factors of another state can fail here, so the tangent is computed here.
                if is_fresh {
                    return Err(NoEquilibrium::Singular);
                }
                continue;
            }
            let is_end = longest <= ROUNDING || longest >= smallest && smallest <= 1e-10;
            let is_near = matches!(wheels, Wheels::Near(_));
            if is_end && is_near && !may_be_near {
                (is_last, smallest) = (true, f64::INFINITY);
                factors = Some(lu);
                continue;
            }
            if is_end {
                let (residuals, tangent) = tangent(&base, &parameters, &x);
                let placed = match &wheels {
                    Wheels::Exact(readings) => readings.placed,
                    Wheels::Near(_) => self.placed(travels, case.racks)?,
                };
                let near = Equilibrium {
                    unknowns: x,
                    lifted,
                    evaluations,
                    placed,
                    is_near,
                    factors: Box::new(Factors::of(&tangent).ok_or(NoEquilibrium::Singular)?),
                    tangent: Box::new(tangent),
                };
                return Ok(near.after_last_step(residuals));
            }
            if !is_fresh && longest > CONTRACTION * smallest {
                // Convergence is too slow: the tangent is computed here.
                smallest = longest.max(smallest);
                continue;
            }
            smallest = smallest.min(longest);
            let shrink = sizes.shrink(&step);
            reached = Some(x);
            for k in 0..UNKNOWNS {
                x[k] += shrink * step[k];
            }
            if shrink == 1.0 && longest <= NEAR {
                factors = Some(lu);
            }
        }
        Err(NoEquilibrium::NotFound)
    }
}

impl Equilibrium {
    /// Takes one last step with the tangent of this state. The readings also hold near their travels, so they need no
    /// update.
    fn after_last_step(mut self, residuals: [f64; UNKNOWNS]) -> Self {
        let last = self.factors.solve(residuals.map(|residual| -residual));
        for (unknown, step) in self.unknowns.iter_mut().zip(last) {
            *unknown += step;
        }
        self
    }

    /// Travels of the wheels.
    pub(super) fn travels(&self) -> [f64; 4] {
        [0, 1, 2, 3].map(|k| self.unknowns[TRAVELS + k])
    }
}

/// Sizes of the unknowns, which scale the steps.
struct Sizes {
    metre: f64,
    weight: f64,
}

impl Sizes {
    /// Point halfway back to `reached`, the last point at which the wheels had poses. `None` without such a point, or if it
    /// is no distance away.
    fn half_way_back(
        &self,
        x: &[f64; UNKNOWNS],
        reached: Option<&[f64; UNKNOWNS]>,
    ) -> Option<[f64; UNKNOWNS]> {
        let back = reached?;
        let far = (0..4).map(|k| (x[TRAVELS + k] - back[TRAVELS + k]).abs());
        let is_far = far.fold(0.0, f64::max) > 1e-9 * self.metre;
        is_far.then(|| std::array::from_fn(|k| 0.5 * (x[k] + back[k])))
    }

    fn of(start: &[f64; UNKNOWNS], car: &Car) -> Self {
        let loads = start[LOADS..LOADS + 4].iter();
        Sizes {
            metre: car.per_metre(),
            weight: loads.map(|n| n.abs()).sum::<f64>().max(1.0),
        }
    }

    /// Largest component of a step, in sizes; NaN if a component is NaN.
    fn longest(&self, step: &[f64; UNKNOWNS]) -> f64 {
        let mut longest = 0.0_f64;
        for (k, part) in step.iter().enumerate() {
            let size = match k {
                ROLL | PITCH => 1.0,
                GROUND..LOADS => self.metre,
                _ => self.weight,
            };
            let part = (part / size).abs();
            if part.is_nan() {
                return part;
            }
            longest = longest.max(part);
        }
        longest
    }

    /// Largest fraction of a step that respects the limits on attitude and travels.
    fn shrink(&self, step: &[f64; UNKNOWNS]) -> f64 {
        let too_long = (0..LOADS).map(|k| match k {
            ROLL | PITCH => step[k].abs() / LONGEST_TURN,
            _ => step[k].abs() / (LONGEST_TRAVEL * self.metre),
        });
        1.0 / too_long.fold(1.0, f64::max)
    }
}

impl<'a> Wheels<'a> {
    /// Inputs from which nearby states are evaluated.
    pub(super) fn base<'h>(&self, held: Held<'h>, travels: [f64; 4]) -> Base<'h, '_, Reading<f64>> {
        match self {
            Wheels::Exact(readings) => readings.base(held),
            Wheels::Near(wheels) => Base {
                held,
                racks: None,
                carriers: [Carriers::Independent; 2],
                readings: wheels.each_ref(),
                travels,
            },
        }
    }
}
