//! Forces in bushings and links in the design position, where that is the equilibrium at the design load.
//!
//! Torques are zero there. Many sets of forces f0 hold every body in balance with the spring's force and a vertical
//! force F at the contact point. The set with the least sum f0.K^-1 f0/2 is taken. K are the slopes of the laws without
//! deflection. With B the arms of the forces, C those of rigid joints, q that of F and r the spring's forces,
//!
//! ```text
//! f0 = K B' v,   B K B' v + C' l - q F = -r,   C v = 0,   q.v = 0                                 (1)
//! ```
//!
//! so v is the velocity that the parts would have without torsion and at constant height of the contact point. The
//! same elimination solves it as an equilibrium. A link's spin, which no force affects, is held.

use super::build::{Built, BushingPlace, LinkPlace};
use super::limb::Conditions;
use super::solve::{Bounds, is_definite};
use super::system::{LOOSE, Limb, Singular, State, Step};
use crate::linear::square::SquareLu;
use crate::number::{Scalar, Vector3};

/// Why there is no preload.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NoPreload {
    /// Some motion has no stiffness.
    Singular(Singular),
    /// The law of a bushing does not reach the force along an axis.
    OutOfReach {
        /// Number of the bushing.
        bushing: usize,
        /// Number of the axis.
        axis: usize,
    },
}

impl<T: Scalar> Built<T> {
    /// Sets the forces at the design load and returns the state in the design position.
    pub(super) fn preload(&mut self, bounds: Bounds) -> Result<State<T>, NoPreload> {
        let like = self.system.like();
        let design = State::design(like);
        let at = Conditions {
            carrier: design.carrier,
            rack: like,
            balance_only: true,
        };
        let singular = NoPreload::Singular;
        let mut equations = self
            .system
            .assembled(&at, &design, None)
            .map_err(singular)?;
        if let Some(limb) = equations.loose {
            return Err(singular(Singular::Limb(limb)));
        }
        let upward = self.system.vertical_force(&design.carrier);
        self.system.border(&mut equations, &design, upward, like);
        if !is_definite(&equations, bounds, LOOSE) {
            return Err(singular(Singular::Carrier));
        }
        let factors = SquareLu::of(equations.matrix, equations.size);
        let factors = factors.ok_or(singular(Singular::Carrier))?;
        let solution = factors.solve(&equations.residual.map(|c| -c));
        let step = equations.step(&solution, false);
        let mut start = design;
        start.joints = step.joints;
        start.vertical = step.vertical;
        for (k, limb) in self.system.limbs.iter().enumerate() {
            if let Limb::Swinging(_) = limb {
                let [.., d, e, _] = step.limbs[k].inner;
                start.limbs[k].pivot = [d, e];
            }
        }
        self.set_bushings(&step)?;
        self.set_links(&step);
        Ok(start)
    }

    fn set_bushings(&mut self, step: &Step<T>) -> Result<(), NoPreload> {
        for (number, place) in self.bushings.iter().enumerate() {
            let moved = self.shift_at(*place, step);
            let bushing = match *place {
                BushingPlace::Limb { limb, end } => match &mut self.system.limbs[limb] {
                    Limb::Swinging(arm) => arm.ends[end].bushing.as_mut(),
                    Limb::Floating(link) if end == 0 => link.inner.as_mut(),
                    Limb::Floating(link) => Some(&mut link.outer),
                    _ => None,
                },
                BushingPlace::Mount(limb) => match &mut self.system.limbs[limb] {
                    Limb::Mount(mount) => Some(&mut mount.bushing),
                    _ => None,
                },
                BushingPlace::Carrier(part) => Some(&mut self.system.bushings[part].bushing),
            };
            let Some(bushing) = bushing else { continue };
            let along = bushing.axes.apply_transposed(moved).to_array();
            for (axis, along) in along.into_iter().enumerate() {
                let law = &mut bushing.laws[axis];
                let slope = law.shape.slope(along);
                if slope.value() == 0.0 {
                    continue;
                }
                // The offset of `preload` is part of f0: the law takes the rest.
                if !law.preloaded(slope * along) {
                    return Err(NoPreload::OutOfReach {
                        bushing: number,
                        axis,
                    });
                }
            }
        }
        Ok(())
    }

    /// Relative shift of the bodies at a bushing.
    fn shift_at(&self, place: BushingPlace, step: &Step<T>) -> Vector3<T> {
        let at = |lever: Vector3<T>| carrier_shift(step, lever);
        match place {
            BushingPlace::Carrier(part) => at(self.system.bushings[part].lever),
            BushingPlace::Mount(limb) => match &self.system.limbs[limb] {
                Limb::Mount(mount) => at(mount.top) + mount.along * step.limbs[limb].inner[0],
                _ => at(self.system.wheel.centre.zero()),
            },
            BushingPlace::Limb { limb, end } => {
                let [a, b, c, d, e, f] = step.limbs[limb].inner;
                let (first, second) = (Vector3::new(a, b, c), Vector3::new(d, e, f));
                match &self.system.limbs[limb] {
                    Limb::Swinging(arm) => at(arm.joint) + first.cross(arm.ends[end].lever),
                    Limb::Floating(link) => {
                        let (shift, turn) = match link.inner {
                            Some(_) => (first, second),
                            None => (first.zero(), first),
                        };
                        if end == 0 {
                            shift
                        } else {
                            shift + turn.cross(link.along) - at(link.joint)
                        }
                    }
                    _ => at(self.system.wheel.centre.zero()),
                }
            }
        }
    }

    fn set_links(&mut self, step: &Step<T>) {
        for place in self.links.clone() {
            match place {
                LinkPlace::Rod(number) => {
                    let rod = &mut self.system.rods[number];
                    if let Some([rate, tension]) = &mut rod.elastic {
                        let moved = carrier_shift(step, rod.joint);
                        *tension = *rate * rod.along.normalised().dot(moved);
                    }
                }
                LinkPlace::RockerRod => self.set_rocker_rod(step),
            }
        }
    }

    fn set_rocker_rod(&mut self, step: &Step<T>) {
        for (limb, step_of) in self.system.limbs.iter_mut().zip(&step.limbs) {
            let [a, b, c, ..] = step_of.inner;
            let (moved, seat) = match limb {
                Limb::Swinging(arm) => {
                    let joint = carrier_shift(step, arm.joint);
                    let Some((lever, seat)) = &mut arm.seat else {
                        continue;
                    };
                    (joint + Vector3::new(a, b, c).cross(*lever), seat)
                }
                Limb::LegSeat(leg) => (leg.shift(carrier_shift(step, leg.joint)), &mut leg.seat),
                Limb::CarrierSeat(part) => (carrier_shift(step, part.lever), &mut part.seat),
                _ => continue,
            };
            seat.preload_rod(moved, step_of.slide);
        }
    }
}

/// Shift of a point of the carrier in a small step from the design position.
fn carrier_shift<T: Scalar>(step: &Step<T>, lever: Vector3<T>) -> Vector3<T> {
    let [x, y, z, a, b, c] = step.carrier;
    Vector3::new(x, y, z) + Vector3::new(a, b, c).cross(lever)
}
