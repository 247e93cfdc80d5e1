//! Derivatives of an equilibrium with respect to loads, travel, rack and design.
//!
//! With the equations of balance G(x, p), the unknowns x, an input p and an output y(x, p),
//!
//! ```text
//! x_p = -G_x^-1 G_p,   dy/dp = y_x.x_p + y_p                                                      (1)
//! ```
//!
//! In numbers that carry derivatives, one Newton step from a state in balance computes (1). In the state after this step,
//! the equations carry the derivatives of the tangent. So the same formulas give the values of test results and their
//! derivatives with respect to the design. On a [`Tape`](crate::number::Tape), one backward pass gives the derivatives of a
//! result with respect to all inputs. This pass is the adjoint of the equations, the preloads and the rates.

use super::loads::WheelLoads;
use super::reading::WheelFigures;
use super::solve::Solution;
use super::system::{Equations, Hold, Limb, State, Step, System, Task};
use super::wheel::{Change, ElasticWheel, Equilibrium, HeldQuantity};
use crate::linear::square::{MOST, SquareLu};
use crate::number::{Dual, Each, Jet, Scalar, Valued, Vector3};

/// Factorised equations of an equilibrium, with the wheel height or the wheel load held. All derivatives with respect to
/// loads and travel use these equations.
#[derive(Clone, Debug)]
pub struct Tangent<T: Valued = f64> {
    pub(super) state: State<T>,
    pub(super) task: Task<T>,
    equations: Equations<T>,
    factors: SquareLu<T>,
}

impl<T: Scalar> ElasticWheel<T> {
    /// Adds derivatives with respect to inputs to an equilibrium of the same design. `task` contains the loads with their
    /// derivatives. `None` if the tangent (matrix of the equations) is singular.
    pub(super) fn carried(&self, at: &State<f64>, task: &Task<T>) -> Option<Equilibrium<T>> {
        let system = &self.built.system;
        let like = system.like();
        let state = at.map(|c| like.constant(c));
        let equations = system.correction(&state, task).ok()?;
        let right = equations.residual.each(|c| -c);
        let solution = equations.factors()?.solve(&right);
        Some(Equilibrium {
            solution: Solution {
                state: system.stepped(&state, &equations.step(&solution, false)),
                task: *task,
                steps: 1,
            },
        })
    }

    /// Computes the tangent (factorised equations) in an equilibrium. `None` if the equations are singular.
    pub fn tangent(&self, at: &Equilibrium<T>, held: HeldQuantity) -> Option<Tangent<T>> {
        let (state, task) = self.held_as(at, held);
        let equations = self.built.system.equations(&state, &task, None).ok()?;
        Some(Tangent {
            factors: equations.factors()?,
            state,
            task,
            equations,
        })
    }

    /// Returns the derivatives of all unknowns with respect to the input `change`.
    pub(super) fn rate(&self, tangent: &Tangent<T>, change: &Change<T>) -> Option<Step<T>> {
        let Tangent {
            state,
            task,
            equations,
            factors,
        } = tangent;
        let system = &self.built.system;
        let mut right = [system.like(); MOST];
        match change {
            Change::Load(loads) => {
                let by_load = system.wheel.wrench(&state.carrier, loads).to_array();
                right[..6].copy_from_slice(&by_load);
            }
            Change::Travel => right[equations.size - 1] = system.like().one(),
            Change::Rack => {
                // The equations contain the rack displacement, so their residuals give the derivatives with respect to
                // it. In equilibrium, the residual of an eliminated unknown is zero, so only the residual's derivative
                // has an effect.
                let dual = self.built.system_over(Dual::<T, 1>::constant);
                let mut moving = task.map(Dual::constant);
                moving.rack.partials[0] = system.like().one();
                let equations = dual.equations(&state.map(Dual::constant), &moving, None);
                let equations = equations.ok()?;
                let factors = SquareLu::of(equations.matrix, equations.size)?;
                let solution = factors.solve(&equations.residual.each(|c| -c));
                let step = equations.step(&solution, false);
                return Some(step.map(|c| c.partials[0]));
            }
        }
        Some(equations.step(&factors.solve(&right), true))
    }

    /// Derivatives of angles, positions and vertical force with respect to an input.
    pub fn figures_along(
        &self,
        tangent: &Tangent<T>,
        change: &Change<T>,
    ) -> Option<WheelFigures<T>> {
        let moving = self.moving_by(tangent, change)?;
        let geometry = self.geometry.map(Jet::constant);
        Some(geometry.figures(&moving, self.constants).map(|c| c[1]))
    }

    /// Returns the state with its derivatives with respect to an input. The result omits the derivatives of unknowns that do
    /// not affect angles, positions and the vertical force of the wheel.
    pub(super) fn moving_by(
        &self,
        tangent: &Tangent<T>,
        change: &Change<T>,
    ) -> Option<State<Jet<T, 2>>> {
        let rate = self.rate(tangent, change)?;
        Some(self.moving(&tangent.state, &rate))
    }

    /// Computes the tangent in an equilibrium, then the derivatives that `figures_along` returns.
    pub fn figures_by(
        &self,
        at: &Equilibrium<T>,
        change: &Change<T>,
        held: HeldQuantity,
    ) -> Option<WheelFigures<T>> {
        self.figures_along(&self.tangent(at, held)?, change)
    }

    /// Returns the shift of the wheel centre and the rotation of the carrier per change of load.
    pub fn twist_along(
        &self,
        tangent: &Tangent<T>,
        loads: &WheelLoads<T>,
    ) -> Option<[Vector3<T>; 2]> {
        let rate = self.rate(tangent, &Change::Load(*loads))?;
        let [x, y, z, a, b, c] = rate.carrier;
        let turn = Vector3::new(a, b, c);
        let lever = tangent.state.carrier.lever(self.built.system.wheel.centre);
        Some([Vector3::new(x, y, z) + turn.cross(lever), turn])
    }

    /// Returns the state with the derivatives `rate`. The result omits the derivatives of unknowns that do not affect angles,
    /// positions and the vertical force of the wheel.
    pub(super) fn moving(&self, state: &State<T>, rate: &Step<T>) -> State<Jet<T, 2>> {
        let mut moving = state.map(Jet::constant);
        let [x, y, z, a, b, c] = rate.carrier.each(|c| Jet([c.zero(), c]));
        let (shift, turn) = (Vector3::new(x, y, z), Vector3::new(a, b, c));
        moving.carrier = moving.carrier.moved(shift, turn);
        for (k, limb) in self.built.system.limbs.iter().enumerate() {
            if let Limb::Mount(_) = limb {
                moving.limbs[k].slide.0[1] = rate.limbs[k].inner[0];
            }
        }
        moving.vertical.0[1] = rate.vertical;
        moving
    }

    /// Converts an equilibrium to a state and its inputs, in which the quantity `held` stays fixed.
    pub(super) fn held_as(&self, from: &Equilibrium<T>, held: HeldQuantity) -> (State<T>, Task<T>) {
        self.built
            .system
            .held_as(&from.solution.state, &from.solution.task, held)
    }
}

impl<T: Valued> System<T> {
    /// Converts a state and its inputs, so that the quantity `held` stays fixed in them.
    #[inline(always)]
    pub(super) fn held_as(
        &self,
        state: &State<T>,
        task: &Task<T>,
        held: HeldQuantity,
    ) -> (State<T>, Task<T>) {
        let (mut state, mut task) = (*state, *task);
        match (task.hold, held) {
            (Hold::Height(_), HeldQuantity::WheelLoad) => {
                task.loads.contact.z = task.loads.contact.z + state.vertical;
                state.vertical = state.vertical.zero();
                task.hold = Hold::Load;
            }
            (Hold::Load, HeldQuantity::WheelHeight) => {
                let moved = state.carrier.displacement(self.wheel.centre);
                task.hold = Hold::Height(moved.z);
            }
            _ => {}
        }
        (state, task)
    }
}
