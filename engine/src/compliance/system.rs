//! Elastic suspension of one design, and its equations.
//!
//! Unknowns are the shift and rotation of the carrier, and a force for each rigid joint. If the height of the wheel centre is
//! held, the vertical force at the contact point is unknown as well. The program first eliminates the parts between body and
//! carrier (`limb.rs`). Let A be the stiffness matrix of the carrier: the sum of the tangents of all parts and loads. A
//! tangent has the derivatives of forces with respect to displacements. Let C be the rows of the rigid
//! joints (transpose C'), and h the row of the height. Let q be the wrench of a vertical unit force at the contact point. A Newton
//! step solves
//!
//! ```text
//! | A  C' -q | | du, w |     | unbalanced forces     |
//! | C  0   0 | | dl    | = - | gaps of the joints    |                                            (1)
//! | h  0   0 | | dV    |     | error of the height   |
//! ```
//!
//! for the shift du and rotation w of the carrier, and the changes dl of the joint forces and dV of the vertical force.

#![expect(
    clippy::needless_range_loop,
    reason = "rows and columns of matrices are named by their numbers"
)]

mod equations;
mod state;

use super::algebra::Placed;
use super::bushing::{Bushing, BushingState};
use super::floating::Floating;
use super::ground::{Frames, Holder, Holders, SubframePart, Surroundings};
use super::legs::{BarPart, LegSeat};
use super::limb::{Beside, Conditions, Evaluated, LimbState, LimbStep, Sum};
use super::loads::{WheelLoads, WheelPart};
use super::parts::{CarrierSeat, Joint, Mount, MountState, RodPart};
use super::point::SeatState;
use super::swinging::Swinging;
use crate::number::{Each, Real, Scalar, SimdReal, Valued, Vector3, larger, outlined};
pub(super) use equations::{Equations, Singular};
pub(super) use state::{State, Step};

/// Largest number of parts with their own degrees of freedom: five links and a spring on the carrier.
pub(super) const MOST_LIMBS: usize = 6;
/// If a pivot of the equations is below this fraction of the largest pivot, a motion has no stiffness.
pub(super) const LOOSE: f64 = 1e-9;
/// Largest number of rigid joints.
pub(super) const MOST_JOINTS: usize = 5;

/// Part with inner unknowns.
#[derive(Clone, Debug)]
pub(super) enum Limb<T> {
    Swinging(Swinging<T>),
    Floating(Floating<T>),
    Mount(Mount<T>),
    LegSeat(LegSeat<T>),
    CarrierSeat(CarrierSeat<T>),
}

/// Bushing between body and carrier.
#[derive(Clone, Debug)]
pub(super) struct CarrierBushing<T> {
    /// Vector from the carrier's reference point to the bushing.
    pub(super) lever: Vector3<T>,
    pub(super) bushing: Bushing<T>,
}

/// Elastic suspension of one design.
#[derive(Clone, Debug)]
pub(super) struct System<T> {
    pub(super) limbs: Vec<Limb<T>>,
    pub(super) bushings: Vec<CarrierBushing<T>>,
    pub(super) rods: Vec<RodPart<T>>,
    pub(super) joints: Vec<Joint<T>>,
    pub(super) wheel: WheelPart<T>,
    /// Bodies that hold the inner ends of the parts.
    pub(super) holders: Holders,
    /// Connection of the wheel's parts to the subframe.
    pub(super) subframe: Option<SubframePart<T>>,
    /// Drop link of the anti-roll bar, if it is on the carrier or on an arm with legs.
    pub(super) bar: Option<BarPart<T>>,
    /// Body that holds the anti-roll bar.
    pub(super) bar_on: Holder,
}

/// Quantity that stays fixed while loads change.
#[derive(Clone, Copy, Debug)]
pub(super) enum Hold<T> {
    /// Height of the wheel centre above its design position.
    Height(T),
    /// All given loads, including the vertical load.
    Load,
}

/// Inputs of an equilibrium: rack displacement, loads, and the height or the load that stays fixed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Task<T> {
    pub(super) rack: T,
    pub(super) hold: Hold<T>,
    pub(super) loads: WheelLoads<T>,
}

impl<T: Copy> Hold<T> {
    /// Converts the held height to another number type.
    #[inline(always)]
    pub(super) fn map<U>(self, f: impl Fn(T) -> U) -> Hold<U> {
        match self {
            Hold::Height(travel) => Hold::Height(f(travel)),
            Hold::Load => Hold::Load,
        }
    }
}

impl<T: Valued> Task<T> {
    #[inline(always)]
    pub(super) fn map<U: Valued>(&self, f: impl Fn(T) -> U + Copy) -> Task<U> {
        Task {
            rack: f(self.rack),
            hold: self.hold.map(f),
            loads: self.loads.map(f),
        }
    }
}

/// External forces that hold the design position at the start, if this position is not an equilibrium. The solver
/// reduces these forces step by step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Held<T> {
    pub(super) carrier: [T; 6],
    pub(super) limbs: [[T; 7]; MOST_LIMBS],
}

impl<T: Valued> Held<T> {
    /// Returns a fraction of the external forces that hold the design position.
    pub(super) fn share(&self, share: T) -> Self {
        Held {
            carrier: self.carrier.each(|c| c * share),
            limbs: self.limbs.each(|limb| limb.each(|c| c * share)),
        }
    }
}

impl<T: Valued> Limb<T> {
    pub(super) fn evaluate(
        &self,
        at: &Conditions<T>,
        state: &LimbState<T>,
        held: &[T; 7],
        sum: &mut Sum<T>,
        beside: Option<&mut Beside<T>>,
    ) -> Option<Evaluated<T>> {
        match self {
            Limb::Swinging(arm) => arm.evaluate(at, state, held, sum, beside),
            Limb::Floating(link) => link.evaluate(at, state, held, sum),
            // SIMD lanes do not support systems with an elastic strut mount (`fits_lanes`), so this code is not
            // compiled for them.
            Limb::Mount(_) if T::IN_REGISTERS => None,
            Limb::Mount(mount) => mount.evaluate(at, state, held, sum),
            Limb::LegSeat(seat) => Some(seat.evaluate(at, state, held, sum, beside)),
            Limb::CarrierSeat(seat) => Some(seat.evaluate(at, state, held, sum)),
        }
    }

    /// Returns true if the part depends on the coordinates in [`Beside`].
    pub(super) fn has_beside(&self) -> bool {
        match self {
            Limb::Swinging(arm) => arm.has_beside(),
            Limb::LegSeat(leg) => leg.seat.is_across,
            _ => false,
        }
    }

    /// Returns true if the inner end is on the rack.
    pub(super) fn is_on_rack(&self) -> bool {
        match self {
            Limb::Swinging(arm) => arm.ends.iter().any(|end| end.on_rack),
            Limb::Floating(link) => link.on_rack,
            _ => false,
        }
    }

    /// Returns the state of the part after a step of its inner unknowns.
    #[inline(always)]
    fn stepped(&self, state: &LimbState<T>, step: &LimbStep<T>) -> LimbState<T> {
        let [a, b, c, d, e, f] = step.inner;
        let (first, second) = (Vector3::new(a, b, c), Vector3::new(d, e, f));
        let mut next = *state;
        match self {
            Limb::Swinging(_) => {
                next.placed = state.placed.moved(first.zero(), first);
                next.pivot = [state.pivot[0] + d, state.pivot[1] + e];
            }
            Limb::Floating(Floating { inner: Some(_), .. }) => {
                next.placed = state.placed.moved(first, second);
            }
            Limb::Floating(_) => next.placed = state.placed.moved(first.zero(), first),
            Limb::Mount(_) => {
                next.slide = state.slide + a;
                return next;
            }
            Limb::LegSeat(_) | Limb::CarrierSeat(_) => {}
        }
        // Addition formula of the tangent: `slide` is the tangent of half the rocker's angle.
        let half = step.slide * a.constant(0.5);
        next.slide = (state.slide + half) / (a.one() - state.slide * half);
        next
    }
}

impl<T: Valued> System<T> {
    /// Returns true if the system can be solved in SIMD lanes: a single wheel without an elastic strut mount.
    pub(super) fn fits_lanes(&self) -> bool {
        let is_mount = |limb: &Limb<T>| matches!(limb, Limb::Mount(_));
        self.subframe.is_none() && self.bar.is_none() && !self.limbs.iter().any(is_mount)
    }

    #[inline(always)]
    pub(super) fn like(&self) -> T {
        self.wheel.centre.x.zero()
    }

    /// Forms the equations (1) of this module for a single wheel in a state.
    #[inline(always)]
    pub(super) fn equations(
        &self,
        state: &State<T>,
        task: &Task<T>,
        held: Option<&Held<T>>,
    ) -> Result<Equations<T>, Singular> {
        let around = Surroundings::of_rack(task.rack);
        let frames = self.frames(&state.carrier, &around, false);
        self.equations_in(&frames, state, task, held)
    }

    /// Forms the equations for the step that adds derivatives to an equilibrium. Their tangents are constants.
    pub(super) fn correction(
        &self,
        state: &State<T>,
        task: &Task<T>,
    ) -> Result<Equations<T>, Singular> {
        let around = Surroundings::of_rack(task.rack);
        let frames = self.frames(&state.carrier, &around, false).for_correction();
        let mut equations = self.equations_in(&frames, state, task, None)?;
        equations.fix_tangents();
        Ok(equations)
    }

    #[inline(always)]
    fn equations_in(
        &self,
        frames: &Frames<T>,
        state: &State<T>,
        task: &Task<T>,
        held: Option<&Held<T>>,
    ) -> Result<Equations<T>, Singular> {
        let mut equations = Equations::empty(task.rack, self.joints.len(), held);
        self.fill(frames, state, task, held, &mut equations)?;
        Ok(equations)
    }

    /// Forms the equations (1) of this module like `equations`. They overwrite the equations of an earlier state.
    #[inline(always)]
    pub(super) fn renew_equations(
        &self,
        state: &State<T>,
        task: &Task<T>,
        held: Option<&Held<T>>,
        equations: &mut Equations<T>,
    ) -> Result<(), Singular> {
        let around = Surroundings::of_rack(task.rack);
        let frames = self.frames(&state.carrier, &around, false);
        equations.clear();
        equations.hold(held);
        self.fill(&frames, state, task, held, equations)
    }

    /// Adds the forces of all parts and all loads to equations that do not contain them yet.
    #[inline(always)]
    fn fill(
        &self,
        frames: &Frames<T>,
        state: &State<T>,
        task: &Task<T>,
        held: Option<&Held<T>>,
        equations: &mut Equations<T>,
    ) -> Result<(), Singular> {
        outlined!(
            [T: Valued] task.rack;
            system: &'p System<T> = self, frames: &'p Frames<T> = frames, state: &'p State<T> = state,
            task: &'p Task<T> = task, held: Option<&'p Held<T>> = held,
            equations: &'p mut Equations<T> = equations => Result<(), Singular> {
                let gathered = system.gather(frames, state, held, false, equations)?;
                system.add_alone(&gathered, equations);
                system.add_loads(equations, state, task);
                Ok(())
            }
        )
    }

    /// Adds the loads. If the wheel height is fixed, the function also adds the vertical force as an unknown, and the equation for
    /// this height.
    #[inline(always)]
    pub(super) fn add_loads(&self, equations: &mut Equations<T>, state: &State<T>, task: &Task<T>) {
        let mut loads = task.loads;
        if let Hold::Height(_) = task.hold {
            loads.contact.z = loads.contact.z + state.vertical;
        }
        let mut load = Sum::zero(task.rack);
        self.wheel.subtract(&state.carrier, &loads, &mut load);
        for i in 0..6 {
            equations.residual[i] = equations.residual[i] + load.force[i];
            for j in 0..6 {
                equations.matrix[i][j] = equations.matrix[i][j] + load.tangent[i][j];
            }
        }
        if let Hold::Height(travel) = task.hold {
            let (row, height) = self.height(&state.carrier);
            self.border(equations, state, row, height - travel);
        }
    }

    /// Returns two results. The first is the derivative of the wheel centre's height with respect to the carrier's
    /// motion. The second is the height of the wheel centre above its design position.
    #[inline(always)]
    fn height(&self, carrier: &Placed<T>) -> ([T; 6], T) {
        let lever = carrier.lever(self.wheel.centre);
        let zero = lever.x.zero();
        // The moment of a vertical unit force at the vector `lever` is lever x z.
        let row = [zero, zero, zero.one(), lever.y, -lever.x, zero];
        (row, carrier.displacement(self.wheel.centre).z)
    }

    /// Adds the vertical force at the contact point as an unknown, and the equation with the coefficients `row`.
    #[inline(always)]
    pub(super) fn border(
        &self,
        equations: &mut Equations<T>,
        state: &State<T>,
        row: [T; 6],
        residual: T,
    ) {
        let upward = self.vertical_force(&state.carrier);
        let last = equations.size;
        for i in 0..6 {
            equations.matrix[i][last] = -upward[i];
            equations.matrix[last][i] = row[i];
        }
        equations.residual[last] = residual;
        equations.size += 1;
    }

    /// Returns the force and moment (wrench) of a vertical unit force at the contact point, on the carrier.
    #[inline(always)]
    pub(super) fn vertical_force(&self, carrier: &Placed<T>) -> [T; 6] {
        let mut unit = WheelLoads::none(carrier.shift.x);
        unit.contact.z = unit.contact.z.one();
        self.wheel.wrench(carrier, &unit).to_array()
    }

    /// Returns the state after a step of all unknowns.
    #[inline(always)]
    pub(super) fn stepped(&self, state: &State<T>, step: &Step<T>) -> State<T> {
        outlined!(
            [T: Valued] state.vertical;
            system: &'p System<T> = self, state: &'p State<T> = state, step: &'p Step<T> = step => State<T> {
                system.stepped_inline(state, step)
            }
        )
    }

    #[inline(always)]
    fn stepped_inline(&self, state: &State<T>, step: &Step<T>) -> State<T> {
        let [x, y, z, a, b, c] = step.carrier;
        let mut next = *state;
        let (shift, turn) = (Vector3::new(x, y, z), Vector3::new(a, b, c));
        next.carrier = state.carrier.moved(shift, turn);
        for k in 0..self.limbs.len() {
            next.limbs[k] = self.limbs[k].stepped(&state.limbs[k], &step.limbs[k]);
        }
        for k in 0..MOST_JOINTS {
            next.joints[k] = state.joints[k] + step.joints[k];
        }
        next.vertical = state.vertical + step.vertical;
        next
    }

    /// Returns the largest translation and the largest rotation of a step. Changes of forces are not included. The rotation
    /// of a link about its own line is not included either. This rotation moves no point of the suspension, and it is
    /// inaccurate if the torsional stiffness is low.
    #[inline(always)]
    pub(super) fn size_of(&self, step: &Step<T>) -> [T::Plain; 2] {
        outlined!(
            [T: Valued] step.vertical;
            system: &'p System<T> = self, step: &'p Step<T> = step => [T::Plain; 2] { system.size_inline(step) }
        )
    }

    #[inline(always)]
    fn size_inline(&self, step: &Step<T>) -> [T::Plain; 2] {
        let [x, y, z, a, b, c] = step.carrier;
        let zero = step.vertical.plain_value().zero();
        let mut shift = largest_of(zero, [x, y, z]);
        let mut turn = largest_of(zero, [a, b, c]);
        for k in 0..self.limbs.len() {
            let (limb, step) = (&self.limbs[k], &step.limbs[k]);
            let [d, e, f, ..] = step.inner;
            match limb {
                Limb::Floating(Floating { inner: Some(_), .. }) => {
                    shift = largest_of(shift, [d, e, f]);
                }
                Limb::Mount(_) => shift = largest_of(shift, [d]),
                _ => {}
            }
            turn = largest_of(turn, limb.turn_across(step).to_array());
            turn = largest_of(turn, [step.slide]);
        }
        [shift, turn]
    }
}

/// Returns the largest of `known` and the magnitudes of the numbers.
#[inline(always)]
fn largest_of<T: Valued, const N: usize>(known: T::Plain, numbers: [T; N]) -> T::Plain {
    let mut largest = known;
    for k in 0..N {
        largest = larger(largest, numbers[k].plain_value().abs());
    }
    largest
}

impl<T: Scalar> System<T> {
    /// States of the bushings of a part with its own degrees of freedom, in the order of its ends.
    pub(super) fn limb_bushings(
        &self,
        limb: usize,
        at: &Conditions<T>,
        state: &State<T>,
    ) -> [Option<BushingState<T>>; 2] {
        let own = &state.limbs[limb];
        match &self.limbs[limb] {
            Limb::Swinging(arm) => {
                let of = |k: usize| {
                    let end = arm.ends.get(k)?;
                    let bushing = end.bushing.as_ref()?;
                    Some(arm.bushing_state(end, bushing, at, own))
                };
                [of(0), of(1)]
            }
            Limb::Floating(link) => link.bushing_states(at, own),
            _ => [None, None],
        }
    }

    /// State of the top mount.
    pub(super) fn mount(&self, frames: &Frames<T>, state: &State<T>) -> Option<MountState<T>> {
        self.limbs
            .iter()
            .zip(&state.limbs)
            .find_map(|(limb, own)| match limb {
                Limb::Mount(mount) => Some(mount.state(&frames.body, own)),
                _ => None,
            })
    }

    /// State of the spring and its rod.
    pub(super) fn seat(&self, frames: &Frames<T>, state: &State<T>) -> Option<SeatState<T>> {
        let limbs = self.limbs.iter().zip(&self.holders.limbs);
        limbs.zip(&state.limbs).find_map(|((limb, holder), own)| {
            let at = frames.of(*holder);
            match limb {
                Limb::Swinging(arm) => arm.seat.as_ref().map(|place| {
                    let moved = arm.seat_displacement(place, at, own);
                    place.1.state(moved, own.slide)
                }),
                Limb::LegSeat(leg) => Some(leg.seat.state(leg.displacement(at), own.slide)),
                Limb::CarrierSeat(part) => {
                    let moved = at.carrier.displacement(part.lever);
                    Some(part.seat.state(moved, own.slide))
                }
                _ => None,
            }
        })
    }

    /// Angle of the anti-roll bar's lever.
    pub(super) fn bar_angle(&self, frames: &Frames<T>, state: &State<T>) -> Option<T> {
        if let Some(bar) = &self.bar {
            return Some(bar.angle(frames.of(self.bar_on)));
        }
        let limbs = self.limbs.iter().zip(&self.holders.limbs);
        limbs.zip(&state.limbs).find_map(|((limb, holder), own)| {
            let at = frames.of(*holder);
            let Limb::Swinging(arm) = limb else {
                return None;
            };
            let (lever, bar) = arm.bar.as_ref()?;
            let moved = arm.displacement(*lever, at, own);
            Some(bar.force(moved, at.twist).angle)
        })
    }
}
