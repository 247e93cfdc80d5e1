//! Newton's method for the equations of [`super`], with a search for the set of wheels in contact.

mod equilibrium;
mod lanes;
mod newton;
mod readings;
mod rows;
mod start;

use super::catalogue::WheelPlace;
use super::equations::{Balance, GROUND, Held, LOADS, UNKNOWNS};
use super::parameters::Parameters;
use super::{Car, Case, GRAVITY, NoEquilibrium};
use crate::axle::{
    Axle, AxlePose, AxleQuantity, AxleSolver, Placement, Quantity, WheelCurve, WheelQuantity,
};
use crate::mechanism::DesignFault;
use crate::model::Side;
use crate::number::Each;
use crate::threads::checkpoint;
pub use equilibrium::Equilibrium;
use readings::OnCurves;
pub(super) use readings::{Base, Readings, Wheels};
pub use rows::{RowResult, RowState};
pub(super) use start::Start;

/// Number of terms in the Taylor series of wheels with respect to travel. The equations need first derivatives, and their
/// tangents (derivatives of the equations with respect to the unknowns) need second derivatives. Derivatives of the
/// tangents with respect to the design need third derivatives.
pub(super) const TERMS: usize = 4;
/// Largest number of sets of wheels in contact that the search tries.
const MOST_SETS: usize = 16;
/// Largest change of an angle in one Newton step, radians.
pub(super) const LONGEST_TURN: f64 = 0.0175;
/// Largest change of a travel, or of the height of the ground, in one Newton step, metres.
pub(super) const LONGEST_TRAVEL: f64 = 0.008;

/// Solver for the states of one car, one case after another.
#[derive(Clone, Debug)]
pub struct CarSolver<'a> {
    /// Car to solve.
    pub car: &'a Car,
    /// True if gradients include the derivatives with respect to the racks.
    pub(super) by_rack: bool,
    /// States of the car at rest, on rigid and on elastic tyres; `None` until they are solved.
    pub(super) rests: [Option<Result<Equilibrium, NoEquilibrium>>; 2],
    pub(super) axles: [AxleSolver<'a, TERMS>; 2],
    /// Curves (interpolated poses) of the wheels along their travels. `None` if a wheel depends on more than its own
    /// travel.
    curves: Option<Box<[WheelCurve; 4]>>,
    /// Reused memory for the wheels that are computed from their curves.
    spare: Option<Box<OnCurves>>,
}

/// Returns the quantities that the solver of an axle must compute, because the equations of the car need them.
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
    let own = own.each(Quantity::Axle).into_iter();
    quantities.extend(own.filter(|quantity| axle.has(*quantity)));
    quantities
}

impl<'a> CarSolver<'a> {
    /// Makes a solver. The error names a wheel that has no pose in the design position.
    pub fn new(car: &'a Car) -> Result<Self, (usize, Side, DesignFault)> {
        Self::made(car, false)
    }

    /// Makes a solver whose gradients include the derivatives with respect to the racks. Such gradients take longer.
    pub fn with_racks(car: &'a Car) -> Result<Self, (usize, Side, DesignFault)> {
        Self::made(car, true)
    }

    fn made(car: &'a Car, by_rack: bool) -> Result<Self, (usize, Side, DesignFault)> {
        let axle = |number: usize| {
            let made = AxleSolver::new(&car.axles[number], &read_of(car, number), by_rack);
            made.map_err(|(side, fault)| (number, side, fault))
        };
        let axles = [axle(0)?, axle(1)?];
        let has_curves = !car.axles.iter().any(Axle::is_rigid);
        let curve = |number: usize| WheelCurve::new(&axles[number / 2], Side::ALL[number % 2]);
        Ok(CarSolver {
            car,
            by_rack,
            rests: [None, None],
            curves: has_curves.then(|| Box::new([0, 1, 2, 3].map(curve))),
            axles,
            spare: None,
        })
    }

    /// Computes the wheels at these travels from their curves; `None` if a wheel has no curve there.
    fn near(&mut self, travels: [f64; 4], racks: [f64; 2]) -> Option<Box<OnCurves>> {
        let curves = self.curves.as_mut()?;
        let mut near = self.spare.take().unwrap_or_default();
        near.travels = travels;
        for (number, curve) in curves.iter_mut().enumerate() {
            let axle = number / 2;
            let at = [travels[number], racks[axle]];
            curve.at(&mut self.axles[axle], at, &mut near.wheels[number])?;
        }
        Some(near)
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

    /// Computes the wheels at these travels from poses.
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

    /// Finds the state of a case. The solver keeps the state of the car at rest, because results of other cases are measured
    /// from it.
    pub fn solve(&mut self, case: &Case) -> Result<Equilibrium, NoEquilibrium> {
        if *case != self.rest_of(case, &case.name) {
            return self.find(case);
        }
        let place = usize::from(case.setting.elastic_tyres);
        if let Some(known) = &self.rests[place] {
            return known.clone();
        }
        let found = self.find(case);
        self.rests[place] = Some(found.clone());
        found
    }

    /// Returns the case `name` of the car at rest, with the tyres of a case (rigid or elastic). A car without tyre
    /// springs is always on rigid tyres.
    pub(super) fn rest_of(&self, case: &Case, name: &str) -> Case {
        let mut rest = Case::at_rest(name);
        rest.setting.elastic_tyres = case.setting.elastic_tyres && self.car.tyres.is_some();
        rest
    }

    /// Finds the state of a case from the design position.
    fn find(&mut self, case: &Case) -> Result<Equilibrium, NoEquilibrium> {
        if self.has_no_springs() {
            return Err(NoEquilibrium::Unsupported);
        }
        match self.search(case) {
            // The failure proposes a change of the case's keys (a remedy). It is only right if the changed case has an
            // equilibrium. Otherwise the distribution of the forces is not the reason for the failure.
            Err(
                failure @ NoEquilibrium::NoContactSet {
                    remedy: Some(_), ..
                },
            ) => Err(self
                .search(&case.with_shares_by_load())
                .err()
                .unwrap_or(failure)),
            found => found,
        }
    }

    /// Searches the state of a case directly. If this fails, increases the load from zero to the case.
    fn search(&mut self, case: &Case) -> Result<Equilibrium, NoEquilibrium> {
        match self.with_contact(case, Start::of(self.start(case))) {
            Ok(found) if found.is_stiff() => Ok(found),
            Ok(_) => self.along_load(case),
            // Both searches failed. If the direct search has only a general reason, report the reason of the search with
            // increasing load.
            Err(first) => self.along_load(case).map_err(|along| match first {
                NoEquilibrium::NotFound
                | NoEquilibrium::Singular
                | NoEquilibrium::NoContactSet { remedy: None, .. } => along,
                _ => first,
            }),
        }
    }

    /// Finds the state of a case from a neighbouring state that was accepted. The wheels are computed from their
    /// curves. So results can differ from [`CarSolver::solve`] by rounding errors.
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

    /// Finds the state of a case from a neighbouring state, if there is no turning point between them. `None` if Newton's
    /// method does not find the state. Also `None` if the state does not meet the stability condition (2) of
    /// [`super::stability`] and is not close to the neighbouring state.
    pub(super) fn solve_beside(&mut self, case: &Case, from: &Equilibrium) -> Option<Equilibrium> {
        let found = self.with_contact(case, Start::beside(from)).ok()?;
        (found.is_stiff() || found.follows(from, self.car)).then_some(found)
    }

    /// Finds the state of a case from a given start: roll, pitch, height of the ground, travels. If this fails, solves
    /// the case as [`CarSolver::solve`] does.
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

    /// Returns a start of Newton's method: the design position, with a quarter of the weight on each wheel.
    pub(super) fn start(&self, case: &Case) -> [f64; UNKNOWNS] {
        let car = self.car;
        let mut x = [0.0; UNKNOWNS];
        let heights = car.axles.iter().enumerate().flat_map(|(number, axle)| {
            let offset = if number == 0 { 0.0 } else { car.rear_offset.z };
            let radius = axle.setup.wheel_radius.unwrap_or(f64::NAN);
            Side::ALL.each(|side| {
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

    /// Solves the equations with one set of wheels in contact after another, until the solution agrees with the set.
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
            most_steps,
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
                most_steps,
            };
            let mut found = self.newton(case, start)?;
            evaluations += found.evaluations;
            let gaps = self.gaps(case, &found)?;
            let next = [0, 1, 2, 3].each(|number| {
                if lifted[number] {
                    gaps[number] >= 0.0
                } else {
                    found.unknowns[LOADS + number] < 0.0
                }
            });
            if next == lifted {
                found.evaluations = evaluations;
                return Ok(found);
            }
            if seen.contains(&next) {
                let changing = (0..4).find(|number| next[*number] != lifted[*number]);
                return Err(NoEquilibrium::NoContactSet {
                    wheel: WheelPlace(changing.unwrap_or(0)),
                    remedy: case.setting.towards_shares_by_load(),
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
        Ok(balance.wheels.each(|wheel| wheel.gap))
    }

    /// Computes a state with its forces.
    pub fn balance(
        &mut self,
        case: &Case,
        found: &Equilibrium,
    ) -> Result<Balance<f64>, NoEquilibrium> {
        let wheels = self.wheels_of(found)?;
        let parameters = Parameters::of(self.car, case);
        Ok(wheels.balance(self.held(case, found), &parameters, found.unknowns))
    }

    /// Poses of both axles in a solved state.
    pub fn poses(&mut self, found: &Equilibrium) -> Result<[AxlePose; 2], NoEquilibrium> {
        match &found.placed {
            Some(placed) => Ok(**placed),
            None => self.placed(found.travels(), found.racks),
        }
    }

    /// Computes the wheels of a solved state: from their curves if the state used curves, otherwise from poses.
    pub(super) fn wheels_of(&mut self, found: &Equilibrium) -> Result<Wheels<'a>, NoEquilibrium> {
        if found.placed.is_none()
            && let Some(near) = self.near(found.travels(), found.racks)
        {
            return Ok(Wheels::Near(near));
        }
        Ok(Wheels::Exact(Box::new(self.readings(found)?)))
    }

    /// Computes the wheels of a solved state from their poses.
    pub(super) fn readings(&mut self, found: &Equilibrium) -> Result<Readings<'a>, NoEquilibrium> {
        let placed = self.poses(found)?;
        let mut read = |axle: usize| {
            let read = self.axles[axle].read(&placed[axle]);
            read.map_err(|failure| NoEquilibrium::NoPose { axle, failure })
        };
        let axles = [read(0)?, read(1)?];
        Ok(Readings {
            by_rack: self.by_rack,
            axles,
            placed,
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
}
