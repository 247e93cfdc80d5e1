//! Elastic wheel, its equilibria, and their derivatives.

use super::build::{Built, OfAxle};
use super::definition::{Compliance, Relaxed};
use super::fault::{ElasticFault, Motion, NoEquilibrium};
use super::ground::Surroundings;
use super::loads::WheelLoads;
use super::preload::NoPreload;
use super::reading::WheelGeometry;
use super::solve::{Bounds, Obstacle, Solution, Stuck};
use super::system::{Equations, Held, Hold, Limb, Singular, State, Task};
use crate::axle::Stop;
use crate::characteristics::Constants;
use crate::linear::square::MOST;
use crate::model::{Axis, Suspension};
use crate::number::{Scalar, Valued, Vector3, array_of, larger};

/// Number of inverse iterations that find the softest motion.
const SOFT_STEPS: usize = 8;
/// Smallest ratio of wheel load to spring force. Below this limit, the spring counts as having no leverage.
const LEAST_LEVERAGE: f64 = 1e-6;

/// Quantity that stays fixed while a load changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum HeldQuantity {
    /// Height of the wheel centre.
    WheelHeight,
    /// Vertical force at the contact point.
    WheelLoad,
}

/// Input with respect to which an equilibrium is differentiated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Change<T = f64> {
    /// Load on the wheel. The trail of the load applies to its side force.
    Load(WheelLoads<T>),
    /// Wheel travel. The equilibrium must be at a given wheel height ([`HeldQuantity::WheelHeight`]).
    Travel,
    /// Displacement of the rack along the kernel's +y.
    Rack,
}

/// Equilibrium of one wheel.
#[derive(Clone, Copy, Debug)]
pub struct Equilibrium<T = f64> {
    pub(super) solution: Solution<T>,
}

impl<T: Scalar> Equilibrium<T> {
    /// Number of Newton steps to this equilibrium.
    pub fn steps(&self) -> usize {
        self.solution.steps
    }

    /// Positions of the bodies that hold the wheel's parts.
    pub(super) fn around(&self) -> Surroundings<T> {
        Surroundings::of_rack(self.solution.task.rack)
    }

    /// Rack displacement along the kernel's +y.
    pub fn rack(&self) -> T {
        self.solution.task.rack
    }
}

/// State of a bushing in its axes, as for a left wheel. Force and torque act on the body that moves. This body is an arm, a
/// link, the mount of a strut, the wheel carrier on a hinge, or the subframe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BushingReading<T = f64> {
    /// Deflection along x, y and z.
    pub deflection: Vector3<T>,
    /// Rotation vector of the bushing, in radians.
    pub rotation: Vector3<T>,
    /// Force on the moving body.
    pub force: Vector3<T>,
    /// Torque on the moving body.
    pub torque: Vector3<T>,
    /// True if the bushing is deflected beyond an end of its force curve, or rotated by more than 60 degrees.
    pub is_extrapolated: bool,
}

/// State of the spring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringReading<T = f64> {
    /// Length of the spring.
    pub length: T,
    /// Force of the spring with its stops, positive in compression.
    pub force: T,
    /// True if the suspension is in contact with the bump stop.
    pub meets_bump_stop: bool,
    /// True if the suspension is in contact with the rebound stop.
    pub meets_rebound_stop: bool,
}

impl<T> SpringReading<T> {
    /// Returns true if the suspension is in contact with a stop.
    pub fn meets(&self, stop: Stop) -> bool {
        match stop {
            Stop::Bump => self.meets_bump_stop,
            Stop::Rebound => self.meets_rebound_stop,
        }
    }
}

/// Elastic suspension of one wheel, in one design.
#[derive(Clone, Debug)]
pub struct ElasticWheel<T = f64> {
    pub(super) built: Built<T>,
    pub(super) geometry: WheelGeometry<T>,
    pub(super) constants: Constants,
    pub(super) bounds: Bounds,
    pub(super) relaxed: Relaxed,
    /// True if a bushing, a link or a mount of the subframe has a constant force. Because of this force, the design position
    /// may not be an equilibrium. Also true without the springs of a solid axle.
    pub(super) has_offset: bool,
    pub(super) start: State<T>,
}

/// Makes the inputs of an equilibrium at a given wheel height, without given loads. Only the vertical force that keeps
/// the wheel at this height acts.
#[inline(always)]
pub(super) fn level_task<T: Valued>(travel: T, rack: T) -> Task<T> {
    Task {
        rack,
        hold: Hold::Height(travel),
        loads: WheelLoads::none(rack),
    }
}

impl ElasticWheel {
    /// Makes the elastic suspension, with the hardpoints at `suspension.design`.
    pub fn new(suspension: &Suspension, compliance: &Compliance) -> Result<Self, ElasticFault> {
        Self::of(suspension, &suspension.design, compliance)
    }
}

impl<T: Scalar> ElasticWheel<T> {
    /// Makes the elastic suspension with its hardpoints at `design`.
    pub fn of(
        suspension: &Suspension,
        design: &[Vector3<T>],
        compliance: &Compliance<T>,
    ) -> Result<Self, ElasticFault> {
        let alone = OfAxle {
            subframe: None,
            bar_rate: None,
            half: None,
        };
        let mut wheel = Self::unloaded(suspension, design, compliance, alone);
        if compliance.relaxed == Relaxed::AtDesignLoad {
            let found = wheel.built.preload(wheel.bounds);
            let name = |number: usize| {
                let point = compliance.bushings[number].point;
                suspension.mechanism.name(point).to_owned()
            };
            let found = found.map_err(|fault| preload_fault(&wheel.built.names, fault, name));
            wheel.start = found?;
            let around = Surroundings::of_rack(wheel.start.vertical.zero());
            wheel.check_leverage(&around)?;
        }
        wheel.check_held()?;
        Ok(wheel)
    }

    /// Makes the elastic suspension like `of`, in the design position. The forces of elastic parts at the design load
    /// are not set.
    pub(super) fn unloaded(
        suspension: &Suspension,
        design: &[Vector3<T>],
        compliance: &Compliance<T>,
        of_axle: OfAxle<'_, T>,
    ) -> Self {
        let mechanism = &suspension.mechanism;
        let radius = suspension.wheel_radius.unwrap_or(0.0);
        let built = Built::of(mechanism, design, radius, compliance, of_axle);
        let mounts = of_axle.subframe.iter().flat_map(|own| &own.mounts);
        let preloads = compliance.bushings.iter().map(|part| &part.preload);
        let preloads = preloads.chain(mounts.map(|mount| &mount.preload)).flatten();
        let mut preloads = preloads.chain(compliance.links.iter().map(|part| &part.preload));
        let has_offset = preloads.any(|offset| offset.value() != 0.0);
        ElasticWheel {
            geometry: WheelGeometry::of(mechanism, design, &built),
            constants: Constants::of(suspension),
            bounds: Bounds {
                millimetre: suspension.length_unit.per_metre() / 1000.0,
            },
            relaxed: compliance.relaxed,
            has_offset,
            start: State::design(built.system.like()),
            built,
        }
    }

    /// Checks that the spring supports the wheel in the design position.
    pub(super) fn check_leverage(&self, around: &Surroundings<T>) -> Result<(), ElasticFault> {
        let spring = self.built.spring_reading(&self.start, around);
        let force = spring.as_ref().map_or(0.0, |spring| spring.force.value());
        if self.start.vertical.value().abs() > LEAST_LEVERAGE * force.abs() {
            Ok(())
        } else if spring.is_some() && force == 0.0 {
            Err(ElasticFault::NoForce)
        } else {
            Err(ElasticFault::NoLeverage)
        }
    }

    /// Checks that every part has stiffness while the wheel height stays fixed. The check finds a free motion of the carrier
    /// only if a pivot of its equations is exactly zero.
    fn check_held(&self) -> Result<(), ElasticFault> {
        let equations = self
            .built
            .system
            .equations(&self.start, &self.level(), None);
        let loose = |part: String, motion| Err(ElasticFault::Loose { part, motion });
        match equations {
            Err(Singular::Limb(limb)) => loose(self.built.names[limb].clone(), self.spin_of(limb)),
            Err(Singular::Carrier) => loose(CARRIER.to_owned(), Motion::Turn(Axis::X)),
            Ok(equations) => match (equations.loose, equations.factors()) {
                (Some(limb), _) => loose(self.built.names[limb].clone(), self.spin_of(limb)),
                (None, Some(_)) => Ok(()),
                (None, None) => loose(CARRIER.to_owned(), Motion::Turn(Axis::X)),
            },
        }
    }

    /// Returns the rotation of a link about its line. The rotation axis is the axis of the vehicle nearest to this line.
    /// Only torsional stiffness resists this rotation. For an arm, the line is from its outer joint to its front end;
    /// other parts get the x axis.
    pub(super) fn spin_of(&self, limb: usize) -> Motion {
        let along = match &self.built.system.limbs[limb] {
            Limb::Swinging(arm) => arm.ends[0].lever,
            Limb::Floating(link) => link.along,
            _ => return Motion::Turn(Axis::X),
        };
        Motion::Turn(largest_axis(along.map(Scalar::value)))
    }

    /// Makes the inputs of the equilibrium at the design height and at rack displacement 0.
    fn level(&self) -> Task<T> {
        let nothing = self.start.vertical.zero();
        level_task(nothing, nothing)
    }

    /// Returns the vertical force at the contact point that balances bushings and spring in the design position. `None`
    /// if the parts are not relaxed at the design load. Constant forces of bushings and links are not included.
    pub fn design_load(&self) -> Option<T> {
        (self.relaxed == Relaxed::AtDesignLoad).then_some(self.start.vertical)
    }
}

impl ElasticWheel {
    /// Returns the largest unbalanced force in an equilibrium, on the carrier or on a part of the suspension. A moment counts
    /// as the force that produces it at a lever of 300 mm. The result is infinite if the equations cannot be formed.
    pub fn out_of_balance(&self, at: &Equilibrium) -> f64 {
        let Solution { state, task, .. } = &at.solution;
        let equations = self.built.system.equations(state, task, None);
        equations.map_or(f64::INFINITY, |equations| self.largest_force(&equations))
    }

    /// Largest residual force of the equations. A moment counts as the force that produces it at a lever of 300 mm.
    pub(super) fn largest_force(&self, equations: &Equations<f64>) -> f64 {
        let lever = self.bounds.lever();
        let mut worst = 0.0;
        let mut note = |force: f64| worst = larger(worst, force);
        for (k, force) in equations.residual[..6].iter().enumerate() {
            let force = if k < 3 { *force } else { force / lever };
            note(force.abs());
        }
        for (limb, forces) in self.built.system.limbs.iter().zip(&equations.inner) {
            let shifts = match limb {
                Limb::Floating(link) if link.inner.is_some() => 3,
                Limb::Mount(_) => 1,
                _ => 0,
            };
            for (k, force) in forces.iter().enumerate() {
                let force = if k < shifts { *force } else { force / lever };
                note(force.abs());
            }
        }
        worst
    }

    /// Returns true if no external forces need to hold the design position at first.
    pub(super) fn starts_in_balance(&self) -> bool {
        self.relaxed == Relaxed::AtDesignLoad && !self.has_offset
    }

    /// Finds the equilibrium with the wheel centre at a height, without horizontal loads.
    pub fn at(&self, travel: f64, rack: f64) -> Result<Equilibrium, NoEquilibrium> {
        let (from, to) = (level_task(0.0, 0.0), level_task(travel, rack));
        let held = if self.starts_in_balance() {
            None
        } else {
            let equations = self.built.system.equations(&self.start, &from, None);
            equations.ok().map(|equations| Held {
                carrier: array_of(|i| equations.residual[i]),
                limbs: equations.inner,
            })
        };
        self.solved(&self.start, &from, &to, held.as_ref())
    }

    fn solved(
        &self,
        start: &State<f64>,
        from: &Task<f64>,
        to: &Task<f64>,
        held: Option<&Held<f64>>,
    ) -> Result<Equilibrium, NoEquilibrium> {
        let found = self.built.system.solve(start, from, to, held, self.bounds);
        found
            .map(|solution| Equilibrium { solution })
            .map_err(|stuck| self.explained(&stuck))
    }

    /// Finds the equilibrium under other loads, from a known equilibrium. The height or the wheel load of the known
    /// equilibrium stays held.
    pub fn loaded(
        &self,
        from: &Equilibrium,
        loads: &WheelLoads,
        held: HeldQuantity,
    ) -> Result<Equilibrium, NoEquilibrium> {
        let (state, task) = self.held_as(from, held);
        let mut to = task;
        to.loads = loads.plus(&task.loads, 0.0);
        to.loads.trail = loads.trail;
        if let Hold::Load = to.hold {
            // The vertical load is added to the wheel load that is held.
            to.loads.contact.z += task.loads.contact.z;
        }
        let mut start = task;
        start.loads.trail = loads.trail;
        self.solved(&state, &start, &to, None)
    }

    /// Finds the equilibrium under loads that act in addition to the loads of a station. The search starts from a
    /// neighbouring equilibrium. The height or the wheel load of the station stays held.
    pub fn loaded_about(
        &self,
        station: &Equilibrium,
        from: &Equilibrium,
        loads: &WheelLoads,
        held: HeldQuantity,
    ) -> Result<Equilibrium, NoEquilibrium> {
        let (_, base) = self.held_as(station, held);
        let (state, mut task) = self.held_as(from, held);
        task.loads.trail = loads.trail;
        let mut to = base;
        to.loads = base.loads.plus(loads, 1.0);
        self.solved(&state, &task, &to, None)
    }

    fn explained(&self, stuck: &Stuck) -> NoEquilibrium {
        let by_limb = match stuck.obstacle {
            Obstacle::Unstable(Some(limb)) | Obstacle::Singular(Singular::Limb(limb)) => {
                Some((self.built.names[limb].clone(), self.spin_of(limb)))
            }
            _ => None,
        };
        NoEquilibrium {
            share: stuck.share,
            lack: NoEquilibrium::lack(stuck.share, &stuck.obstacle, || self.barely_held()),
            softest: stuck
                .last
                .and_then(|(state, task)| self.softest(&state, &task))
                .map(|(_, motion)| motion)
                .or(by_limb),
        }
    }

    /// Returns the name of a part that at most the torsional stiffness of bushings holds in the design position. `None`
    /// if there is no such part.
    fn barely_held(&self) -> Option<String> {
        match self.built.clone().preload(self.bounds) {
            Err(NoPreload::Singular(singular)) => Some(name_of(&self.built.names, singular)),
            Err(NoPreload::OutOfReach { .. }) | Ok(_) => None,
        }
    }

    /// Finds the motion of the suspension with the least stiffness by inverse iteration on the tangent. Returns its
    /// displacement per unit force, the part that moves, and the direction of the motion.
    pub(super) fn softest(
        &self,
        state: &State<f64>,
        task: &Task<f64>,
    ) -> Option<(f64, (String, Motion))> {
        let equations = self.built.system.equations(state, task, None).ok()?;
        let factors = equations.factors()?;
        let mut right = [0.0; MOST];
        right[..6].copy_from_slice(&[1.0, 0.8, 0.6, 100.0, 80.0, 60.0]);
        let mut step = None;
        let mut softness = 0.0;
        for _ in 0..SOFT_STEPS {
            let solution = factors.solve(&right);
            let size = solution[..6].iter().fold(0.0_f64, |m, c| m.max(c.abs()));
            softness = size;
            right = [0.0; MOST];
            for i in 0..6 {
                right[i] = solution[i] / size;
            }
            step = Some(equations.step(&solution, true));
        }
        let step = step?;
        let lever = self.bounds.lever();
        let [x, y, z, a, b, c] = step.carrier;
        let (shift, turn) = (Vector3::new(x, y, z), Vector3::new(a, b, c));
        let mut found = if shift.norm() > turn.norm() * lever {
            (
                shift.norm(),
                CARRIER.to_owned(),
                Motion::Shift(largest_axis(shift)),
            )
        } else {
            let motion = Motion::Turn(largest_axis(turn));
            (turn.norm() * lever, CARRIER.to_owned(), motion)
        };
        for (k, limb) in self.built.system.limbs.iter().enumerate() {
            let turn = limb.turn_vector(&step.limbs[k]);
            if turn.norm() * lever > found.0 {
                let motion = Motion::Turn(largest_axis(turn));
                found = (turn.norm() * lever, self.built.names[k].clone(), motion);
            }
        }
        Some((softness, (found.1, found.2)))
    }
}

/// Name of the wheel carrier in messages.
pub(super) const CARRIER: &str = "the wheel carrier";

pub(super) fn largest_axis(v: Vector3<f64>) -> Axis {
    let size = |axis: &Axis| v[*axis].abs();
    let [x, y, z] = Axis::ALL;
    [y, z]
        .into_iter()
        .fold(x, |m, a| if size(&a) > size(&m) { a } else { m })
}

/// Fault of parts whose forces at the design load cannot be computed. `names` are the names of the parts with their own degrees
/// of freedom.
pub(super) fn no_balance(names: &[String], singular: Singular) -> ElasticFault {
    ElasticFault::NoBalance {
        part: name_of(names, singular),
    }
}

/// Name of a part that can move without resistance. `names` are the names of the parts with their own degrees of freedom.
fn name_of(names: &[String], singular: Singular) -> String {
    match singular {
        Singular::Limb(limb) => names[limb].clone(),
        Singular::Carrier => CARRIER.to_owned(),
    }
}

/// Fault of parts that have no forces at the design load. `bushing` returns the name of a bushing.
pub(super) fn preload_fault(
    names: &[String],
    fault: NoPreload,
    bushing: impl Fn(usize) -> String,
) -> ElasticFault {
    match fault {
        NoPreload::Singular(singular) => no_balance(names, singular),
        NoPreload::OutOfReach {
            bushing: number,
            axis,
        } => ElasticFault::OutOfReach {
            bushing: bushing(number),
            axis,
        },
    }
}
