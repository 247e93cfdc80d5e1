//! Derivatives of an axle's equilibrium with respect to loads, travels and rack. The method of
//! `compliance/derivatives.rs` for one wheel is used for both wheels.

use super::equations::{AxleEquations, AxleState, AxleStep, AxleTask, Purpose};
use super::{AxleEquilibrium, ElasticAxle};
use crate::characteristics::Inputs;
use crate::compliance::ground::{RACK, SHARED};
use crate::compliance::loads::WheelLoads;
use crate::compliance::reading::WheelFigures;
use crate::compliance::wheel::HeldQuantity;
use crate::linear::square::MOST;
use crate::model::Side;
use crate::number::{Each, Jet, Scalar, Valued, Vector3};

/// Input with respect to which an equilibrium is differentiated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AxleChange<T = f64> {
    /// Loads on both wheels, each in the kernel's frame of its side.
    Loads([WheelLoads<T>; 2]),
    /// Travels of both wheels. The heights of both wheels must be held.
    Travels([T; 2]),
    /// Commanded displacement of the rack along the left wheel's +y.
    Rack,
}

/// Factorised equations of an equilibrium of an axle, with the wheel heights or the wheel loads held.
#[derive(Clone, Debug)]
pub struct AxleTangent<T: Valued = f64> {
    pub(super) state: AxleState<T>,
    task: AxleTask<T>,
    equations: AxleEquations<T>,
}

impl<T: Scalar> ElasticAxle<T> {
    /// Computes the tangent (factorised equations) in an equilibrium.
    pub fn tangent(&self, at: &AxleEquilibrium<T>, held: HeldQuantity) -> Option<AxleTangent<T>> {
        let (state, task) = self.held_as(at, held);
        Some(AxleTangent {
            equations: self.equations(&state, &task)?,
            state,
            task,
        })
    }

    /// Adds derivatives with respect to inputs to an equilibrium of the same design.
    pub(super) fn carried(
        &self,
        at: &AxleState<f64>,
        task: &AxleTask<T>,
    ) -> Option<AxleEquilibrium<T>> {
        let like = self.like();
        let mut state = at.map(|c| like.constant(c));
        if self.shared.rack.is_none() {
            state.around.rack = task.rack;
        }
        let equations = self
            .shared
            .equations(&self.wheels, &state, task, None, Purpose::Correction)
            .ok()?;
        let step = equations.newton_step(&self.wheels);
        Some(AxleEquilibrium {
            state: state.stepped(&self.wheels, &step),
            task: *task,
            steps: 1,
        })
    }

    /// Returns the derivatives of all unknowns with respect to the input `change`.
    pub(super) fn rate(&self, tangent: &AxleTangent<T>, change: &AxleChange<T>) -> AxleStep<T> {
        let zero = self.like();
        let equations = &tangent.equations;
        let mut wheels = [[zero; MOST]; 2];
        let mut shared = [zero; SHARED];
        // A rigid rack moves exactly by the commanded displacement.
        let mut moved = false;
        match change {
            AxleChange::Loads(loads) => {
                for (side, right) in wheels.iter_mut().enumerate() {
                    let wheel = &self.wheels[side].built.system.wheel;
                    let carrier = &tangent.state.wheels[side].carrier;
                    let by_load = wheel.wrench(carrier, &loads[side]).to_array();
                    right[..6].copy_from_slice(&by_load);
                }
            }
            AxleChange::Travels(travels) => {
                for (side, right) in wheels.iter_mut().enumerate() {
                    if Self::holds_height(&tangent.task, side) {
                        right[equations.sides[side].equations.size - 1] = travels[side];
                    }
                }
            }
            AxleChange::Rack => match self.shared.rack {
                Some([rate, _]) => shared[RACK] = rate,
                None => {
                    moved = true;
                    for (side, right) in wheels.iter_mut().enumerate() {
                        let by = equations.sides[side].by_shared(side, RACK);
                        for (right, by) in right.iter_mut().zip(by) {
                            *right = -by;
                        }
                    }
                    for (k, right) in shared.iter_mut().enumerate().take(RACK) {
                        *right = -equations.own(k, RACK);
                    }
                }
            },
        }
        let (wheels, mut shared) = equations.solve(&wheels, &shared);
        if moved {
            shared[RACK] = zero.one();
        }
        equations.step(&self.wheels, &wheels, &shared, true)
    }

    /// Derivatives of angles, positions and vertical force of both wheels with respect to an input.
    pub fn figures_along(
        &self,
        tangent: &AxleTangent<T>,
        change: &AxleChange<T>,
    ) -> [WheelFigures<T>; 2] {
        let rate = self.rate(tangent, change);
        [0, 1].each(|side: usize| {
            let wheel = &self.wheels[side];
            let moving = wheel.moving(&tangent.state.wheels[side], &rate.wheels[side]);
            let geometry = wheel.geometry.map(Jet::constant);
            geometry.figures(&moving, wheel.constants).map(|c| c[1])
        })
    }

    /// Returns the inputs of the catalogue's formulas for both wheels, with their first derivatives with respect to
    /// `change`. The length of the spring is not included.
    pub(crate) fn inputs_along(
        &self,
        tangent: &AxleTangent<T>,
        change: &AxleChange<T>,
    ) -> [Inputs<Jet<T, 2>>; 2] {
        let rate = self.rate(tangent, change);
        [0, 1].each(|side: usize| {
            let wheel = &self.wheels[side];
            let moving = wheel.moving(&tangent.state.wheels[side], &rate.wheels[side]);
            let geometry = wheel.geometry.map(Jet::constant);
            geometry.inputs(&moving, wheel.constants)
        })
    }

    /// Returns the shifts of the wheel centres and the rotations of the carriers per change of loads. Each is in the
    /// frame of its side.
    pub fn twists_along(
        &self,
        tangent: &AxleTangent<T>,
        loads: &[WheelLoads<T>; 2],
    ) -> [[Vector3<T>; 2]; 2] {
        let rate = self.rate(tangent, &AxleChange::Loads(*loads));
        [0, 1].each(|side: usize| {
            let [x, y, z, a, b, c] = rate.wheels[side].carrier;
            let turn = Vector3::new(a, b, c);
            let carrier = &tangent.state.wheels[side].carrier;
            let lever = carrier.lever(self.wheels[side].built.system.wheel.centre);
            [Vector3::new(x, y, z) + turn.cross(lever), turn]
        })
    }

    /// Returns two numbers for a side: the number of parts with their own degrees of freedom, and the number of rigid
    /// joints. Tests check the size of the system with these numbers.
    pub fn parts(&self, side: Side) -> [usize; 2] {
        let system = &self.wheels[side as usize].built.system;
        [system.limbs.len(), system.joints.len()]
    }
}
