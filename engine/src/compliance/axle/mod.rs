//! Axle of two elastic wheels, coupled by rack, anti-roll bar and subframe, or by one body that carries both wheels.

mod body;
mod corners;
mod definition;
mod derivatives;
mod ends;
mod equations;
mod solve;
mod tape;

pub use body::AxlePlace;
pub use definition::{AxleCompliance, SteeringColumn};
pub use derivatives::{AxleChange, AxleTangent};
pub use ends::AxleWay;
pub use tape::AxleOnTape;

use super::build::{HalfOfAxle, OfAxle};
use super::carried::{CarriedForces, ElasticMember};
use super::definition::Relaxed;
use super::fault::{AxleFault, ElasticFault, Motion};
use super::ground::{RACK, SHARED};
use super::preload::SeenStep;
use super::reading::WheelFigures;
use super::system::{Hold, Singular, State};
use super::wheel::{
    BushingReading, CARRIER, ElasticWheel, HeldQuantity, SpringReading, level_task, no_balance,
    preload_fault,
};
use crate::characteristics::Inputs;
use crate::mechanism::Pose;
use crate::model::{Axis, Mechanism, Side, Suspension, mirrored};
use crate::number::{Each, Scalar, Vector3, array_of};
use equations::{AxleEquations, AxleSingular, AxleState, AxleTask, Purpose, SharedParts};

/// Equilibrium of both wheels of an axle.
#[derive(Clone, Copy, Debug)]
pub struct AxleEquilibrium<T = f64> {
    state: AxleState<T>,
    task: AxleTask<T>,
    steps: usize,
}

impl<T: Scalar> AxleEquilibrium<T> {
    /// Number of Newton steps to this equilibrium.
    pub fn steps(&self) -> usize {
        self.steps
    }
}

/// Axle of two elastic wheels in one design. Each wheel is described in the kernel's frame of a left wheel. The rack
/// displacement is positive along the left wheel's +y.
#[derive(Clone, Debug)]
pub struct ElasticAxle<T = f64> {
    wheels: [ElasticWheel<T>; 2],
    shared: SharedParts<T>,
    /// Rate of the anti-roll bar: torque per difference of the angles of its levers.
    bar_rate: Option<T>,
}

impl<T: Scalar> ElasticAxle<T> {
    /// Makes an axle from the suspensions of the left and the right wheel. Their hardpoints are at `designs`.
    pub fn of(
        suspensions: [&Suspension; 2],
        designs: [&[Vector3<T>]; 2],
        parts: &AxleCompliance<T>,
    ) -> Result<Self, AxleFault> {
        let reference = common_reference(suspensions);
        let wheel = |side: usize| {
            let own = &parts.wheels[side];
            let half = reference.map(|reference| HalfOfAxle {
                reference: if side == 0 {
                    reference
                } else {
                    mirrored(reference)
                },
                has_singles: side == 0,
            });
            let of_axle = OfAxle {
                subframe: parts.subframe.as_ref(),
                bar_rate: parts.bar_rate,
                half,
            };
            ElasticWheel::unloaded(suspensions[side], designs[side], own, of_axle)
        };
        let mut axle = ElasticAxle {
            wheels: [wheel(0), wheel(1)],
            shared: SharedParts {
                has_subframe: parts.subframe.is_some(),
                rack: parts.steering_rate().map(|rate| [rate, rate.zero()]),
                has_bar: parts.bar_rate.is_some(),
                is_joined: reference.is_some(),
            },
            bar_rate: parts.bar_rate,
        };
        if axle.relaxed() == Relaxed::AtDesignLoad {
            // The mounts of the subframe come after the bushings of a wheel.
            axle.preload(|side, number| {
                let bushings = &parts.wheels[side].bushings;
                let mounts = parts.subframe.iter().flat_map(|subframe| &subframe.mounts);
                let mechanism = &suspensions[side].mechanism;
                let own = bushings.iter().map(|part| mechanism.name(part.point));
                let mut names = own.chain(mounts.map(|mount| mount.name.as_str()));
                names.nth(number).unwrap_or_default().to_owned()
            })?;
        }
        axle.check_held()?;
        Ok(axle)
    }

    fn relaxed(&self) -> Relaxed {
        self.wheels[0].relaxed
    }

    fn like(&self) -> T {
        self.wheels[0].built.system.like()
    }

    /// Design position with the forces of the elastic parts at the design load.
    fn start(&self) -> AxleState<T> {
        AxleState {
            wheels: [self.wheels[0].start, self.wheels[1].start],
            around: super::ground::Surroundings::of_rack(self.like()),
        }
    }

    /// Computes the forces of the elastic parts at the design load. `bushing` returns the name of a side's bushing.
    fn preload(&mut self, bushing: impl Fn(usize, usize) -> String) -> Result<(), AxleFault> {
        let state = self.start();
        let task = self.level([0.0; 2], 0.0);
        let found = self
            .shared
            .equations(&self.wheels, &state, &task, None, Purpose::Preload);
        let equations = found.map_err(|why| self.singular(why))?;
        let step = equations.newton_step(&self.wheels);
        for (side, name) in [0, 1].into_iter().zip(Side::ALL) {
            let around = state.around(side);
            let system = &self.wheels[side].built.system;
            let frames = system.frames(&state.wheels[side].carrier, &around, true);
            let shared: [T; SHARED] = array_of(|k| step.shared[k].scaled(equations::sign(side, k)));
            let seen = SeenStep {
                step: &step.wheels[side],
                around: &around,
                frames: &frames,
                shared: &shared,
            };
            let wheel = &mut self.wheels[side];
            let start = wheel.built.set_preload(&seen);
            wheel.start = start.map_err(|fault| AxleFault {
                side: Some(name),
                fault: preload_fault(&wheel.built.names, fault, |number| bushing(side, number)),
            })?;
            let has_leverage = wheel.check_leverage(&around);
            has_leverage.map_err(|fault| AxleFault {
                side: Some(name),
                fault,
            })?;
        }
        if let Some([rate, preload]) = &mut self.shared.rack {
            *preload = *rate * step.shared[RACK];
        }
        Ok(())
    }

    fn singular(&self, why: AxleSingular) -> AxleFault {
        let part = match why {
            AxleSingular::Wheel(side, why) => {
                return AxleFault {
                    side: Some(Side::ALL[side]),
                    fault: no_balance(&self.wheels[side].built.names, why),
                };
            }
            AxleSingular::Carrier => AXLE,
            // The bar has no stiffness while the forces at the design load are computed. So the cause is the subframe
            // or the rack.
            AxleSingular::Shared => match (self.shared.has_subframe, self.shared.rack.is_some()) {
                (true, false) => "the subframe",
                (false, true) => "the rack",
                _ => "the subframe or the rack",
            },
        };
        AxleFault {
            side: None,
            fault: ElasticFault::NoBalance {
                part: part.to_owned(),
            },
        }
    }

    /// Checks that every part has stiffness while the heights of both wheels are held. The check finds a free motion of
    /// carriers or shared bodies only if a pivot of the equations is exactly zero.
    fn check_held(&self) -> Result<(), AxleFault> {
        let state = self.start();
        let task = self.level([0.0; 2], 0.0);
        let found = self
            .shared
            .equations(&self.wheels, &state, &task, None, Purpose::Balance);
        let loose = |side: Option<usize>, limb: Option<usize>| {
            let (part, motion) = match (side, limb) {
                (Some(side), Some(limb)) => {
                    let wheel = &self.wheels[side];
                    (wheel.built.names[limb].clone(), wheel.spin_of(limb))
                }
                (Some(_), None) => (CARRIER.to_owned(), Motion::Turn(Axis::X)),
                (None, _) => (SHARED_NAME.to_owned(), Motion::Turn(Axis::Y)),
            };
            Err(AxleFault {
                side: side.map(|side| Side::ALL[side]),
                fault: ElasticFault::Loose { part, motion },
            })
        };
        match found {
            Err(AxleSingular::Wheel(side, Singular::Limb(limb))) => loose(Some(side), Some(limb)),
            Err(AxleSingular::Wheel(side, Singular::Carrier)) => loose(Some(side), None),
            Err(AxleSingular::Carrier) => Err(AxleFault {
                side: None,
                fault: ElasticFault::Loose {
                    part: AXLE.to_owned(),
                    motion: Motion::Shift(Axis::Y),
                },
            }),
            Err(AxleSingular::Shared) => loose(None, None),
            Ok(equations) => {
                for (side, of) in equations.sides.iter().enumerate() {
                    if let Some(limb) = of.equations.loose {
                        return loose(Some(side), Some(limb));
                    }
                }
                Ok(())
            }
        }
    }

    /// Design position as an equilibrium that the solver has not balanced yet.
    pub(super) fn unsolved(&self) -> AxleEquilibrium<T> {
        AxleEquilibrium {
            state: self.start(),
            task: self.level([0.0; 2], 0.0),
            steps: 0,
        }
    }

    fn level(&self, travels: [f64; 2], rack: f64) -> AxleTask<T> {
        let like = self.like();
        let task = |travel: f64| level_task(like.constant(travel), like.zero());
        AxleTask {
            rack: like.constant(rack),
            wheels: travels.each(task),
        }
    }

    /// Vertical forces at the contact points that balance elastic parts and springs in the design position, without constant
    /// forces. `None` if the parts are not relaxed at the design load.
    pub fn design_loads(&self) -> Option<[T; 2]> {
        let loads = self.wheels.each_ref().each(|wheel| wheel.start.vertical);
        (self.relaxed() == Relaxed::AtDesignLoad).then_some(loads)
    }

    /// Angles and positions of a wheel, in the kernel's frame of its side.
    pub fn figures(&self, at: &AxleEquilibrium<T>, side: Side) -> WheelFigures<T> {
        let wheel = &self.wheels[side as usize];
        let state = &at.state.wheels[side as usize];
        wheel.geometry.figures(state, wheel.constants)
    }

    /// Angles and positions of a wheel, like [`ElasticAxle::figures`]. The vertical force is the total force at the contact point.
    pub(crate) fn figures_with_load(&self, at: &AxleEquilibrium<T>, side: Side) -> WheelFigures<T> {
        WheelFigures {
            vertical: self.wheel_load(at, side),
            ..self.figures(at, side)
        }
    }

    /// Pose of a wheel carrier, in the kernel's frame of its side. `origin` is the knuckle's origin in the design position.
    pub(crate) fn pose(&self, at: &AxleEquilibrium<T>, side: Side, origin: Vector3<T>) -> Pose<T> {
        let carrier = &at.state.wheels[side as usize].carrier;
        carrier.as_pose(self.wheels[side as usize].built.reference, origin)
    }

    /// Returns the inputs of the catalogue's formulas for a wheel, in the kernel's frame of its side. Rates, rocker and
    /// bar are not included.
    pub(crate) fn inputs(&self, at: &AxleEquilibrium<T>, side: Side) -> Inputs<T> {
        let wheel = &self.wheels[side as usize];
        let state = &at.state.wheels[side as usize];
        let mut inputs = wheel.geometry.inputs(state, wheel.constants);
        if let Some(spring) = self.spring(at, side) {
            inputs.now.spring_length = spring.length;
        }
        inputs
    }

    /// Height of a wheel centre above its design position.
    pub fn travel(&self, at: &AxleEquilibrium<T>, side: Side) -> T {
        let centre = self.wheels[side as usize].built.system.wheel.centre;
        let carrier = &at.state.wheels[side as usize].carrier;
        carrier.displacement(centre).z
    }

    /// Total vertical force at a contact point.
    pub fn wheel_load(&self, at: &AxleEquilibrium<T>, side: Side) -> T {
        let loads = &at.task.wheels[side as usize].loads;
        at.state.wheels[side as usize].vertical + loads.contact.z
    }

    /// State of each bushing of a side, in the order of the definition, followed by the subframe's mounts.
    pub fn bushings(&self, at: &AxleEquilibrium<T>, side: Side) -> Vec<BushingReading<T>> {
        let around = at.state.around(side as usize);
        let built = &self.wheels[side as usize].built;
        built.bushing_readings(&at.state.wheels[side as usize], &around)
    }

    /// Tension of each link of a side, in the order of the definition. `None` for the rod of a rocker whose spring has no law.
    pub fn tensions(&self, at: &AxleEquilibrium<T>, side: Side) -> Vec<Option<T>> {
        let around = at.state.around(side as usize);
        let built = &self.wheels[side as usize].built;
        built.tensions(&at.state.wheels[side as usize], &around)
    }

    /// State of the spring of a side, if it has a law.
    pub fn spring(&self, at: &AxleEquilibrium<T>, side: Side) -> Option<SpringReading<T>> {
        let around = at.state.around(side as usize);
        let built = &self.wheels[side as usize].built;
        built.spring_reading(&at.state.wheels[side as usize], &around)
    }

    /// Force that holds the rack, positive along the left wheel's +y.
    pub fn rack_force(&self, at: &AxleEquilibrium<T>) -> T {
        let of = |side: usize| {
            let around = at.state.around(side);
            let built = &self.wheels[side].built;
            built.rack_force(&at.state.wheels[side], &around)
        };
        of(0) - of(1)
    }

    /// Torque of the anti-roll bar: its rate times the difference of the lever angles, left minus right.
    pub fn bar_torque(&self, at: &AxleEquilibrium<T>) -> Option<T> {
        let angle = |side: usize| {
            let around = at.state.around(side);
            let state = &at.state.wheels[side];
            let system = &self.wheels[side].built.system;
            let frames = system.frames(&state.carrier, &around, false);
            system.bar_angle(&frames, state)
        };
        Some(self.bar_rate? * (angle(0)? - angle(1)?))
    }

    /// Displacement of the rack, along the left wheel's +y.
    pub fn rack(&self, at: &AxleEquilibrium<T>) -> T {
        at.state.around.rack
    }

    /// Displacement of the subframe's reference point and its rotation vector.
    pub fn subframe(&self, at: &AxleEquilibrium<T>) -> [Vector3<T>; 2] {
        let subframe = &at.state.around.subframe;
        [
            subframe.shift,
            super::algebra::Logarithm::of(&subframe.turn).vector,
        ]
    }
}

/// Name of a body that carries both wheels, in messages.
const AXLE: &str = "the axle";
/// Name of the shared bodies in messages.
const SHARED_NAME: &str = "the subframe, rack or anti-roll bar";

/// Returns the reference point of a body that carries both wheels, in the axes of the left wheel. This point is midway
/// between the wheel centres. `None` for independently suspended wheels.
fn common_reference(suspensions: [&Suspension; 2]) -> Option<Vector3<f64>> {
    suspensions[0].mechanism.rigid_axle.as_ref()?;
    let [left, right] = suspensions.each(|wheel| wheel.design[wheel.mechanism.wheel_centre.0]);
    Some((left + mirrored(right)) * 0.5)
}

impl<T: Scalar> ElasticAxle<T> {
    /// Converts this equilibrium to a state and its inputs. The quantity `held` (wheel heights or wheel loads) stays
    /// fixed in them.
    fn held_as(&self, at: &AxleEquilibrium<T>, held: HeldQuantity) -> (AxleState<T>, AxleTask<T>) {
        let (mut state, mut task) = (at.state, at.task);
        for (side, wheel) in self.wheels.iter().enumerate() {
            let system = &wheel.built.system;
            let found: (State<T>, _) =
                system.held_as(&state.wheels[side], &task.wheels[side], held);
            (state.wheels[side], task.wheels[side]) = found;
        }
        (state, task)
    }

    /// Returns true if the height of a wheel is held.
    fn holds_height(task: &AxleTask<T>, side: usize) -> bool {
        matches!(task.wheels[side].hold, Hold::Height(_))
    }

    fn equations(&self, state: &AxleState<T>, task: &AxleTask<T>) -> Option<AxleEquations<T>> {
        let found = self
            .shared
            .equations(&self.wheels, state, task, None, Purpose::Balance);
        found.ok()
    }
}

impl ElasticAxle {
    /// Returns the parts of a side whose forces are in the results.
    pub(crate) fn members(
        &self,
        side: Side,
        mechanism: &Mechanism,
        bushings: &[String],
    ) -> Vec<ElasticMember> {
        let built = &self.wheels[side as usize].built;
        built.members(mechanism, bushings)
    }

    /// Returns the forces of all parts of a side in an equilibrium.
    pub(crate) fn member_forces(&self, at: &AxleEquilibrium, side: Side) -> Option<CarriedForces> {
        let around = at.state.around(side as usize);
        let built = &self.wheels[side as usize].built;
        built.member_forces(&at.state.wheels[side as usize], &around)
    }
}
