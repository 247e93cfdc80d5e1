//! An axle of two elastic wheels, coupled by rack, anti-roll bar and subframe.

mod definition;
mod derivatives;
mod equations;
mod tape;

pub use definition::AxleCompliance;
pub use derivatives::{AxleChange, AxleTangent};
pub use tape::AxleOnTape;

use super::build::OfAxle;
use super::definition::Relaxed;
use super::fault::{AxleFault, ElasticFault, Motion, NoEquilibrium};
use super::ground::{RACK, SHARED, TWIST};
use super::loads::WheelLoads;
use super::preload::{NoPreload, SeenStep};
use super::reading::WheelFigures;
use super::solve::{Judge, Obstacle, Unraised, Verdict, between, raised};
use super::system::{Held, Hold, Singular, State, Step};
use super::wheel::{
    BushingReading, CARRIER, ElasticWheel, HeldQuantity, SpringReading, TURN_LEVER, largest_axis,
    level_task, preload_fault,
};
use crate::linear::square::MOST;
use crate::model::{Side, Suspension};
use crate::number::{Scalar, Vector3};
use equations::{
    AxleEquations, AxleHeld, AxleSingular, AxleState, AxleStep, AxleTask, Purpose, SharedParts,
};

/// Steps of inverse iteration that find the softest motion.
const SOFT_STEPS: usize = 8;

/// An equilibrium of both wheels.
#[derive(Clone, Copy, Debug)]
pub struct AxleEquilibrium<T = f64> {
    state: AxleState<T>,
    task: AxleTask<T>,
    steps: usize,
}

impl<T: Scalar> AxleEquilibrium<T> {
    /// Newton steps that led to it.
    pub fn steps(&self) -> usize {
        self.steps
    }
}

/// An axle of two elastic wheels, in one design. Each wheel is in the kernel's frame of a left wheel; the rack moves along
/// the left wheel's +y.
#[derive(Clone, Debug)]
pub struct ElasticAxle<T = f64> {
    wheels: [ElasticWheel<T>; 2],
    shared: SharedParts<T>,
    /// Rate of the anti-roll bar.
    bar_rate: Option<T>,
}

impl<T: Scalar> ElasticAxle<T> {
    /// The axle of two suspensions with their hardpoints at `designs`.
    pub fn of(
        suspensions: [&Suspension; 2],
        designs: [&[Vector3<T>]; 2],
        parts: &AxleCompliance<T>,
    ) -> Result<Self, AxleFault> {
        let of_axle = OfAxle {
            subframe: parts.subframe.as_ref(),
            bar_rate: parts.bar_rate,
        };
        let wheel = |side: usize| {
            let own = &parts.wheels[side];
            ElasticWheel::unloaded(suspensions[side], designs[side], own, of_axle)
        };
        let mut axle = ElasticAxle {
            wheels: [wheel(0), wheel(1)],
            shared: SharedParts {
                has_subframe: parts.subframe.is_some(),
                rack: parts.rack_rate.map(|rate| [rate, rate.zero()]),
                has_bar: parts.bar_rate.is_some(),
            },
            bar_rate: parts.bar_rate,
        };
        if axle.relaxed() == Relaxed::AtDesignLoad {
            axle.preload()?;
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

    /// The design position with the forces at the design load.
    fn start(&self) -> AxleState<T> {
        AxleState {
            wheels: [self.wheels[0].start, self.wheels[1].start],
            around: super::ground::Surroundings::of_rack(self.like()),
        }
    }

    /// Sets the forces at the design load.
    fn preload(&mut self) -> Result<(), AxleFault> {
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
            let shared: [T; SHARED] =
                std::array::from_fn(|k| step.shared[k].scaled(equations::sign(side, k)));
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
                fault: preload_fault(&wheel.built.names, fault),
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
        match why {
            AxleSingular::Wheel(side, why) => AxleFault {
                side: Some(Side::ALL[side]),
                fault: preload_fault(&self.wheels[side].built.names, NoPreload::Singular(why)),
            },
            AxleSingular::Shared => AxleFault {
                side: None,
                fault: ElasticFault::NoBalance {
                    part: SHARED_NAME.to_owned(),
                },
            },
        }
    }

    /// Refuses a design in which a motion has no stiffness while the heights are held.
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
                (Some(_), None) => (CARRIER.to_owned(), Motion::Turn(crate::model::Axis::X)),
                (None, _) => (SHARED_NAME.to_owned(), Motion::Turn(crate::model::Axis::Y)),
            };
            Err(AxleFault {
                side: side.map(|side| Side::ALL[side]),
                fault: ElasticFault::Loose { part, motion },
            })
        };
        match found {
            Err(AxleSingular::Wheel(side, Singular::Limb(limb))) => loose(Some(side), Some(limb)),
            Err(AxleSingular::Wheel(side, Singular::Carrier)) => loose(Some(side), None),
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

    fn level(&self, travels: [f64; 2], rack: f64) -> AxleTask<T> {
        let like = self.like();
        let task = |travel: f64| level_task(like.lit(travel), like.zero());
        AxleTask {
            rack: like.lit(rack),
            wheels: travels.map(task),
        }
    }

    /// The vertical forces at the contact points in the design position, if that is an equilibrium.
    pub fn design_loads(&self) -> Option<[T; 2]> {
        let loads = self.wheels.each_ref().map(|wheel| wheel.start.vertical);
        (self.relaxed() == Relaxed::AtDesignLoad).then_some(loads)
    }

    /// Angles and positions of a wheel, in the kernel's frame of its side.
    pub fn figures(&self, at: &AxleEquilibrium<T>, side: Side) -> WheelFigures<T> {
        let wheel = &self.wheels[side as usize];
        let state = &at.state.wheels[side as usize];
        wheel.geometry.figures(state, wheel.constants)
    }

    /// Height of a wheel centre above its design position.
    pub fn travel(&self, at: &AxleEquilibrium<T>, side: Side) -> T {
        let centre = self.wheels[side as usize].built.system.wheel.centre;
        let carrier = &at.state.wheels[side as usize].carrier;
        carrier.displacement(centre).z
    }

    /// All of the vertical force at a contact point.
    pub fn wheel_load(&self, at: &AxleEquilibrium<T>, side: Side) -> T {
        let loads = &at.task.wheels[side as usize].loads;
        at.state.wheels[side as usize].vertical + loads.contact.z
    }

    /// State of each bushing of a side, in the order of the definition; mounts of the subframe at the end.
    pub fn bushings(&self, at: &AxleEquilibrium<T>, side: Side) -> Vec<BushingReading<T>> {
        let around = at.state.around(side as usize);
        let built = &self.wheels[side as usize].built;
        built.bushing_readings(&at.state.wheels[side as usize], &around)
    }

    /// Tension of each link of a side, in the order of the definition.
    pub fn tensions(&self, at: &AxleEquilibrium<T>, side: Side) -> Vec<T> {
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

    /// Force on the rack along the left wheel's +y that holds it.
    pub fn rack_force(&self, at: &AxleEquilibrium<T>) -> T {
        let of = |side: usize| {
            let around = at.state.around(side);
            let built = &self.wheels[side].built;
            built.rack_force(&at.state.wheels[side], &around)
        };
        of(0) - of(1)
    }

    /// Torque of the anti-roll bar: its rate times the left lever's angle less the right one's.
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

/// Name of the shared bodies in messages.
const SHARED_NAME: &str = "the subframe, rack or anti-roll bar";

impl ElasticAxle {
    /// The equilibrium with the wheel centres at heights and without horizontal loads.
    pub fn at(&self, travels: [f64; 2], rack: f64) -> Result<AxleEquilibrium, NoEquilibrium> {
        let (from, to) = (self.level([0.0; 2], 0.0), self.level(travels, rack));
        let has_offset = self.wheels.iter().any(|wheel| wheel.has_offset);
        let held = match self.relaxed() {
            Relaxed::AtDesignLoad if !has_offset => None,
            _ => {
                let equations = self.shared.equations(
                    &self.wheels,
                    &self.start(),
                    &from,
                    None,
                    Purpose::Balance,
                );
                equations.ok().map(|equations| AxleHeld {
                    wheels: [0, 1].map(|side: usize| {
                        let of = &equations.sides[side].equations;
                        Held {
                            carrier: std::array::from_fn(|i| of.residual[i]),
                            limbs: of.inner,
                        }
                    }),
                    shared: equations.force,
                })
            }
        };
        self.solved(&self.start(), &from, &to, held.as_ref())
    }

    /// The equilibrium under loads beside those of a station, from a neighbour of it. Loads are in the kernel's frame of
    /// each side. What is held are the station's heights or wheel loads.
    pub fn loaded_about(
        &self,
        station: &AxleEquilibrium,
        from: &AxleEquilibrium,
        loads: &[WheelLoads; 2],
        held: HeldQuantity,
    ) -> Result<AxleEquilibrium, NoEquilibrium> {
        let (_, base) = self.held_as(station, held);
        let (state, mut task) = self.held_as(from, held);
        let mut to = base;
        for (side, load) in loads.iter().enumerate() {
            task.wheels[side].loads.trail = load.trail;
            to.wheels[side].loads = base.wheels[side].loads.plus(load, 1.0);
            to.wheels[side].loads.trail = load.trail;
        }
        self.solved(&state, &task, &to, None)
    }

    fn solved(
        &self,
        start: &AxleState<f64>,
        from: &AxleTask<f64>,
        to: &AxleTask<f64>,
        held: Option<&AxleHeld<f64>>,
    ) -> Result<AxleEquilibrium, NoEquilibrium> {
        let way = |share: f64| AxleTask {
            rack: from.rack + (to.rack - from.rack) * share,
            wheels: [0, 1].map(|side: usize| {
                between(&from.wheels[side], &to.wheels[side], share)
            }),
        };
        let mut side = None;
        let newton = |state: &AxleState<f64>, share: f64, is_first: bool| {
            let rest = held.filter(|_| !is_first).map(|held| AxleHeld {
                wheels: held.wheels.each_ref().map(|held| held.share(1.0 - share)),
                shared: held.shared.map(|force| force * (1.0 - share)),
            });
            let found = self.newton(state, &way(share), rest.as_ref());
            found.map_err(|(of, obstacle)| {
                side = of;
                obstacle
            })
        };
        match raised(start, newton) {
            Ok((state, steps)) => Ok(AxleEquilibrium {
                state,
                task: *to,
                steps,
            }),
            Err(stuck) => Err(self.explained(&stuck, side, way)),
        }
    }

    /// Newton's method from a state. An obstacle of one wheel comes with its number.
    fn newton(
        &self,
        start: &AxleState<f64>,
        task: &AxleTask<f64>,
        held: Option<&AxleHeld<f64>>,
    ) -> Result<(AxleState<f64>, usize), (Option<usize>, Obstacle)> {
        let mut state = *start;
        if self.shared.rack.is_none() {
            state.around.rack = task.rack;
        }
        let bounds = self.wheels[0].bounds;
        let mut judge = Judge::new(bounds);
        loop {
            let found =
                self.shared
                    .equations(&self.wheels, &state, task, held, Purpose::Balance);
            let equations = found.map_err(|why| match why {
                AxleSingular::Wheel(side, why) => (Some(side), Obstacle::Singular(why)),
                AxleSingular::Shared => (None, Obstacle::Singular(Singular::Carrier)),
            })?;
            let step = equations.newton_step(&self.wheels);
            let verdict = judge.judge(step.sizes(&self.wheels));
            let verdict = verdict.map_err(|why| (None, why))?;
            state = state.stepped(&self.wheels, &step);
            if verdict == Verdict::Settled {
                equations.check_stable(&self.wheels, bounds)?;
                return Ok((state, judge.steps()));
            }
        }
    }

    fn explained(
        &self,
        stuck: &Unraised<AxleState<f64>>,
        side: Option<usize>,
        way: impl Fn(f64) -> AxleTask<f64>,
    ) -> NoEquilibrium {
        let by_limb = match (side, stuck.obstacle) {
            (
                Some(side),
                Obstacle::Unstable(Some(limb)) | Obstacle::Singular(Singular::Limb(limb)),
            ) => {
                let wheel = &self.wheels[side];
                let name = of_side(side, &wheel.built.names[limb]);
                Some((name, wheel.spin_of(limb)))
            }
            _ => None,
        };
        let last = stuck.last.as_ref();
        NoEquilibrium {
            share: stuck.share,
            is_unstable: stuck.share == 0.0 && matches!(stuck.obstacle, Obstacle::Unstable(_)),
            softest: last
                .and_then(|state| self.softest(state, &way(stuck.share)))
                .or(by_limb),
        }
    }

    /// The motion with the least stiffness: inverse iteration on the tangent.
    fn softest(&self, state: &AxleState<f64>, task: &AxleTask<f64>) -> Option<(String, Motion)> {
        let found = self
            .shared
            .equations(&self.wheels, state, task, None, Purpose::Balance);
        let equations = found.ok()?;
        let mut wheels = [[0.0; MOST]; 2];
        for (k, right) in wheels.iter_mut().enumerate() {
            let k = k as f64;
            right[..6].copy_from_slice(&[1.0, 0.8 - k, 0.6, 100.0, 80.0 + k, 60.0]);
        }
        let mut shared = [0.0; SHARED];
        let mut step = None;
        for _ in 0..SOFT_STEPS {
            let (solution, moved) = equations.solve(&wheels, &shared);
            let all = solution.iter().flat_map(|x| &x[..6]).chain(&moved);
            let size = all.fold(0.0_f64, |m, c| m.max(c.abs()));
            wheels = [[0.0; MOST]; 2];
            for (right, solution) in wheels.iter_mut().zip(&solution) {
                for (right, x) in right.iter_mut().zip(&solution[..6]) {
                    *right = x / size;
                }
            }
            shared = moved.map(|c| c / size);
            step = Some(equations.step(&self.wheels, &solution, &moved, true));
        }
        Some(self.largest_motion(&step?))
    }

    /// The largest motion of a step, with the name of its part.
    fn largest_motion(&self, step: &AxleStep<f64>) -> (String, Motion) {
        let lever = TURN_LEVER * self.wheels[0].bounds.millimetre;
        let mut found = (-1.0, String::new(), Motion::Turn(crate::model::Axis::X));
        let mut note = |size: f64, name: String, motion: Motion| {
            if size > found.0 {
                found = (size, name, motion);
            }
        };
        let mut body = |[x, y, z, a, b, c]: [f64; 6], name: &str| {
            let (shift, turn) = (Vector3::new(x, y, z), Vector3::new(a, b, c));
            note(shift.norm(), name.to_owned(), Motion::Shift(largest_axis(shift)));
            note(turn.norm() * lever, name.to_owned(), Motion::Turn(largest_axis(turn)));
        };
        let carrier = |step: &Step<f64>| step.carrier;
        for (side, wheel) in self.wheels.iter().enumerate() {
            let own = &step.wheels[side];
            body(carrier(own), &of_side(side, CARRIER));
            for (k, limb) in wheel.built.system.limbs.iter().enumerate() {
                let turn = limb.turn_vector(&own.limbs[k]);
                let [a, b, c] = turn.to_array();
                body([0.0, 0.0, 0.0, a, b, c], &of_side(side, &wheel.built.names[k]));
            }
        }
        let [x, y, z, a, b, c, rack, twist] = step.shared;
        body([x, y, z, a, b, c], "the subframe");
        body([0.0, rack, 0.0, 0.0, 0.0, 0.0], "the rack");
        body([0.0, 0.0, 0.0, 0.0, twist, 0.0], "the anti-roll bar");
        (found.1, found.2)
    }

    /// The largest force that is out of balance in a state. A moment counts by its force at a lever of 300 mm. Infinite if
    /// the state has no equations.
    pub fn out_of_balance(&self, at: &AxleEquilibrium) -> f64 {
        let found = self.shared.equations(
            &self.wheels,
            &at.state,
            &at.task,
            None,
            Purpose::Balance,
        );
        let Ok(equations) = found else {
            return f64::INFINITY;
        };
        let mut worst = 0.0;
        for (side, wheel) in self.wheels.iter().enumerate() {
            let own = wheel.largest_force(&equations.sides[side].equations);
            worst = if own <= worst { worst } else { own };
        }
        let lever = TURN_LEVER * self.wheels[0].bounds.millimetre;
        for k in self.shared.active(Purpose::Balance) {
            let unit = if (3..RACK).contains(&k) || k == TWIST { lever } else { 1.0 };
            let force = equations.force[k].abs() / unit;
            worst = if force <= worst { worst } else { force };
        }
        worst
    }
}

/// A part of a side in words.
fn of_side(side: usize, name: &str) -> String {
    let name = name.strip_prefix("the ").unwrap_or(name);
    format!("the {} {name}", Side::ALL[side].name())
}

impl<T: Scalar> ElasticAxle<T> {
    /// An equilibrium as one in which another quantity is held.
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
