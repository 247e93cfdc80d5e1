//! Equilibria of an axle. The methods of `compliance/solve.rs` and `compliance/wheel.rs` for one wheel are used for both
//! wheels.

use super::equations::{AxleHeld, AxleSingular, AxleState, AxleStep, AxleTask, Purpose, lever_of};
use super::{AXLE, AxleEquilibrium, ElasticAxle};
use crate::compliance::definition::Relaxed;
use crate::compliance::fault::{AxleFault, ElasticFault, Motion, NoEquilibrium};
use crate::compliance::ground::SHARED;
use crate::compliance::loads::WheelLoads;
use crate::compliance::solve::{Judge, Obstacle, Unraised, Verdict, between, raised};
use crate::compliance::system::{Held, Singular};
use crate::compliance::wheel::{CARRIER, HeldQuantity, largest_axis};
use crate::linear::square::MOST;
use crate::model::{Axis, Side};
use crate::number::{Each, Vector3, array_of, larger};
use crate::threads::checkpoint;

/// Number of inverse iterations that find the softest motion.
const SOFT_STEPS: usize = 8;

impl ElasticAxle {
    /// Finds the equilibrium with the wheel centres at the heights `travels`, without horizontal loads.
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
                    wheels: [0, 1].each(|side: usize| {
                        let of = &equations.sides[side].equations;
                        Held {
                            carrier: array_of(|i| of.residual[i]),
                            limbs: of.inner,
                        }
                    }),
                    shared: equations.force,
                })
            }
        };
        self.solved(&self.start(), &from, &to, held.as_ref())
    }

    /// Finds the equilibrium under loads that act in addition to the loads of a station. The search starts from a
    /// neighbouring equilibrium. The loads are in the kernel's frame of each side. The wheel heights or the wheel loads
    /// of the station stay held.
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
            wheels: [0, 1].each(|side: usize| between(&from.wheels[side], &to.wheels[side], share)),
        };
        let mut side = None;
        let newton = |state: &AxleState<f64>, share: f64, is_first: bool| {
            let rest = held.filter(|_| !is_first).map(|held| AxleHeld {
                wheels: held.wheels.each_ref().each(|held| held.share(1.0 - share)),
                shared: held.shared.each(|force| force * (1.0 - share)),
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
            Err(stuck) => Err(self.explained(start, &stuck, side, way)),
        }
    }

    /// Runs Newton's method from a state. If a wheel fails, the error contains the index of its side.
    pub(super) fn newton(
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
            checkpoint();
            let found = self
                .shared
                .equations(&self.wheels, &state, task, held, Purpose::Balance);
            let equations = found.map_err(|why| match why {
                AxleSingular::Wheel(side, why) => (Some(side), Obstacle::Singular(why)),
                AxleSingular::Carrier | AxleSingular::Shared => {
                    (None, Obstacle::Singular(Singular::Carrier))
                }
            })?;
            let step = equations.newton_step(&self.wheels);
            let verdict = judge.judge(step.sizes(&self.wheels));
            let verdict = verdict.map_err(|why| (None, why))?;
            state = state.stepped(&self.wheels, &step);
            if verdict == Verdict::Settled {
                equations.check_stable(bounds)?;
                return Ok((state, judge.steps()));
            }
        }
    }

    fn explained(
        &self,
        start: &AxleState<f64>,
        stuck: &Unraised<AxleState<f64>>,
        side: Option<usize>,
        way: impl Fn(f64) -> AxleTask<f64>,
    ) -> NoEquilibrium {
        let by_limb = match (side, stuck.obstacle) {
            (
                Some(side),
                Obstacle::Unstable(Some(limb)) | Obstacle::Singular(Singular::Limb(limb)),
            ) => Some(self.limb_of(side, limb)),
            _ => None,
        };
        let softest = |state: &AxleState<f64>| {
            let found = self.softest(state, &way(stuck.share));
            found.map(|(_, motion)| motion)
        };
        let last = stuck.last.as_ref();
        NoEquilibrium {
            share: stuck.share,
            lack: NoEquilibrium::lack(stuck.share, &stuck.obstacle, || self.barely_held()),
            softest: last
                .and_then(softest)
                .or(by_limb)
                .or_else(|| softest(start)),
        }
    }

    /// Returns the name of a part that at most the torsional stiffness of bushings holds in the design position. `None`
    /// if there is no such part.
    fn barely_held(&self) -> Option<String> {
        let (start, level) = (self.start(), self.level([0.0; 2], 0.0));
        let found = self
            .shared
            .equations(&self.wheels, &start, &level, None, Purpose::Preload);
        let AxleFault { side, fault } = self.singular(found.err()?);
        match (side, fault) {
            (Some(side), ElasticFault::NoBalance { part }) => Some(of_side(side as usize, &part)),
            (None, ElasticFault::NoBalance { part }) => Some(part),
            _ => None,
        }
    }

    /// Returns the name of a part with its own degrees of freedom, and the direction in which this part moves without
    /// stiffness.
    pub(super) fn limb_of(&self, side: usize, limb: usize) -> (String, Motion) {
        let wheel = &self.wheels[side];
        let name = of_side(side, &wheel.built.names[limb]);
        (name, wheel.spin_of(limb))
    }

    /// Finds the motion with the least stiffness by inverse iteration on the tangent of both wheels and the shared
    /// bodies. Returns its displacement per unit force, the part that moves, and the direction of the motion.
    pub(super) fn softest(
        &self,
        state: &AxleState<f64>,
        task: &AxleTask<f64>,
    ) -> Option<(f64, (String, Motion))> {
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
        let mut softness = 0.0;
        for _ in 0..SOFT_STEPS {
            let (solution, moved) = equations.solve(&wheels, &shared);
            let all = solution.iter().flat_map(|x| &x[..6]).chain(&moved);
            let size = all.fold(0.0_f64, |m, c| m.max(c.abs()));
            softness = size;
            wheels = [[0.0; MOST]; 2];
            for (right, solution) in wheels.iter_mut().zip(&solution) {
                for (right, x) in right.iter_mut().zip(&solution[..6]) {
                    *right = x / size;
                }
            }
            shared = moved.each(|c| c / size);
            step = Some(equations.step(&self.wheels, &solution, &moved, true));
        }
        Some((softness, self.largest_motion(&step?)))
    }

    /// Largest motion of a step, and the name of the part that moves.
    fn largest_motion(&self, step: &AxleStep<f64>) -> (String, Motion) {
        let lever = self.wheels[0].bounds.lever();
        let mut found = (-1.0, String::new(), Motion::Turn(Axis::X));
        let mut note = |size: f64, name: String, motion: Motion| {
            if size > found.0 {
                found = (size, name, motion);
            }
        };
        let mut body = |[x, y, z, a, b, c]: [f64; 6], name: &str| {
            let (shift, turn) = (Vector3::new(x, y, z), Vector3::new(a, b, c));
            note(
                shift.norm(),
                name.to_owned(),
                Motion::Shift(largest_axis(shift)),
            );
            note(
                turn.norm() * lever,
                name.to_owned(),
                Motion::Turn(largest_axis(turn)),
            );
        };
        for (side, wheel) in self.wheels.iter().enumerate() {
            let own = &step.wheels[side];
            if self.shared.is_joined {
                body(own.carrier, AXLE)
            } else {
                body(own.carrier, &of_side(side, CARRIER))
            }
            for (k, limb) in wheel.built.system.limbs.iter().enumerate() {
                let turn = limb.turn_vector(&own.limbs[k]);
                let [a, b, c] = turn.to_array();
                body(
                    [0.0, 0.0, 0.0, a, b, c],
                    &of_side(side, &wheel.built.names[k]),
                );
            }
        }
        let [x, y, z, a, b, c, rack, twist] = step.shared;
        body([x, y, z, a, b, c], "the subframe");
        body([0.0, rack, 0.0, 0.0, 0.0, 0.0], "the rack");
        body([0.0, 0.0, 0.0, 0.0, twist, 0.0], "the anti-roll bar");
        (found.1, found.2)
    }

    /// Returns the largest unbalanced force in an equilibrium. A moment counts as the force that produces it at a lever of 300
    /// mm. The result is infinite if the equations cannot be formed.
    pub fn out_of_balance(&self, at: &AxleEquilibrium) -> f64 {
        let found =
            self.shared
                .equations(&self.wheels, &at.state, &at.task, None, Purpose::Balance);
        let Ok(equations) = found else {
            return f64::INFINITY;
        };
        let mut worst = 0.0;
        for (side, wheel) in self.wheels.iter().enumerate() {
            let own = wheel.largest_force(&equations.sides[side].equations);
            worst = larger(worst, own);
        }
        for k in self.shared.active(Purpose::Balance) {
            let force = equations.force[k].abs() / lever_of(k, self.wheels[0].bounds);
            worst = larger(worst, force);
        }
        worst
    }
}

/// Name of a part with its side, for messages.
fn of_side(side: usize, name: &str) -> String {
    let name = name.strip_prefix("the ").unwrap_or(name);
    format!("the {} {name}", Side::ALL[side].name())
}
