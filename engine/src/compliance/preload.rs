//! Forces in bushings and links in the design position, if the design position is the equilibrium at the design load.
//!
//! This calculation takes torques and constant forces as zero. Many sets of forces f0 balance every body under the spring's
//! force and a vertical force F at the contact point. The program uses the set with the smallest sum f0.K^-1 f0/2, where K
//! contains the slopes of the laws at zero deflection. B, C and q are the lever arms of the forces f0, of the forces l in
//! the rigid joints, and of F. With the spring's forces r and the transposes B' and C',
//!
//! ```text
//! f0 = K B' v,   B K B' v + C' l - q F = -r,   C v = 0,   q.v = 0                                 (1)
//! ```
//!
//! v is a small motion of the parts, without torsional stiffness and at constant height of the contact point. The program
//! eliminates the unknowns of these equations in the same way as for an equilibrium. No force affects the rotation of a
//! link about its line, so an artificial stiffness holds this rotation.

use super::build::{Built, BushingPlace, LinkPlace};
use super::ground::{Frames, Holder, SHARED, Surroundings};
use super::solve::{Bounds, is_definite};
use super::system::{Equations, LOOSE, Limb, Singular, State, Step};
use crate::linear::square::SquareLu;
use crate::number::{Each, Scalar, Vector3};

/// Reason why no forces at the design load exist.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NoPreload {
    /// A motion has no stiffness.
    Singular(Singular),
    /// The force curve of a bushing does not reach the force along an axis.
    OutOfReach {
        /// Index of the bushing.
        bushing: usize,
        /// Index of the axis of the bushing.
        axis: usize,
    },
}

/// Small step from the design position. It can be converted to a step relative to the body that holds a part.
pub(super) struct SeenStep<'s, T> {
    pub(super) step: &'s Step<T>,
    pub(super) around: &'s Surroundings<T>,
    pub(super) frames: &'s Frames<T>,
    pub(super) shared: &'s [T; SHARED],
}

impl<T: Scalar> Built<T> {
    /// Sets the forces at the design load of a single wheel, and returns its state in the design position.
    pub(super) fn preload(&mut self, bounds: Bounds) -> Result<State<T>, NoPreload> {
        let like = self.system.like();
        let design = State::design(like);
        let around = Surroundings::of_rack(like);
        let frames = self.system.frames(&design.carrier, &around, true);
        let singular = NoPreload::Singular;
        let mut equations = Equations::empty(like, self.system.joints.len(), None);
        let gathered = self
            .system
            .gather(&frames, &design, None, false, &mut equations);
        self.system
            .add_alone(&gathered.map_err(singular)?, &mut equations);
        self.border_for_preload(&mut equations, Some(bounds))?;
        let factors = SquareLu::of(equations.matrix, equations.size);
        let factors = factors.ok_or(singular(Singular::Carrier))?;
        let solution = factors.solve(&equations.residual.each(|c| -c));
        let step = equations.step(&solution, false);
        self.set_preload(&SeenStep {
            step: &step,
            around: &around,
            frames: &frames,
            shared: &[like; SHARED],
        })
    }

    /// Adds the vertical force at the contact point as an unknown, and the equation that keeps the height of the contact
    /// point. Returns an error if a part can move without resistance. If `bounds` is given, the carrier is checked in the
    /// same way.
    pub(super) fn border_for_preload(
        &self,
        equations: &mut Equations<T>,
        bounds: Option<Bounds>,
    ) -> Result<(), NoPreload> {
        let singular = NoPreload::Singular;
        if let Some(limb) = equations.loose {
            return Err(singular(Singular::Limb(limb)));
        }
        let design = State::design(self.system.like());
        let upward = self.system.vertical_force(&design.carrier);
        self.system
            .border(equations, &design, upward, self.system.like());
        if bounds.is_none_or(|bounds| is_definite(equations, bounds, LOOSE)) {
            Ok(())
        } else {
            Err(singular(Singular::Carrier))
        }
    }

    /// Sets the forces of bushings and links that follow from a step of equation (1) of this module. Returns the state in
    /// the design position.
    pub(super) fn set_preload(&mut self, seen: &SeenStep<'_, T>) -> Result<State<T>, NoPreload> {
        let step = seen.step;
        let mut start = State::design(self.system.like());
        start.joints = step.joints;
        start.vertical = step.vertical;
        for (k, limb) in self.system.limbs.iter().enumerate() {
            if let Limb::Swinging(_) = limb {
                let [.., d, e, _] = step.limbs[k].inner;
                start.limbs[k].pivot = [d, e];
            }
        }
        self.set_bushings(seen)?;
        self.set_links(seen);
        Ok(start)
    }

    fn set_bushings(&mut self, seen: &SeenStep<'_, T>) -> Result<(), NoPreload> {
        for (number, place) in self.bushings.iter().enumerate() {
            let moved = self.shift_at(*place, seen);
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
                BushingPlace::Subframe(mount) => {
                    let own = self.system.subframe.as_mut();
                    own.map(|own| &mut own.mounts[mount].bushing)
                }
            };
            let Some(bushing) = bushing else { continue };
            let along = bushing.axes.apply_transposed(moved).to_array();
            for (axis, along) in along.into_iter().enumerate() {
                let law = &mut bushing.laws[axis];
                let slope = law.shape.slope(along);
                if slope.value() == 0.0 {
                    continue;
                }
                // The law must produce the whole force f0. A constant offset is added to f0.
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

    /// Returns the shift of one body relative to the other body of a bushing, in a small step.
    fn shift_at(&self, place: BushingPlace, seen: &SeenStep<'_, T>) -> Vector3<T> {
        let step = seen.step;
        let body = |lever: Vector3<T>| shifted(&step.carrier, lever);
        let of_limb = |limb: usize| {
            let on_rack = self.system.limbs[limb].is_on_rack();
            self.carrier_seen(self.system.holders.limbs[limb], on_rack, seen)
        };
        match place {
            BushingPlace::Carrier(part) => {
                let holder = self.system.holders.bushings[part];
                let carrier = self.carrier_seen(holder, false, seen);
                shifted(&carrier, self.system.bushings[part].lever)
            }
            BushingPlace::Subframe(mount) => {
                let own = self.system.subframe.as_ref();
                let lever = own.map(|own| own.mounts[mount].lever);
                let [x, y, z, a, b, c, ..] = *seen.shared;
                lever.map_or(body(self.system.wheel.centre.zero()), |lever| {
                    shifted(&[x, y, z, a, b, c], lever)
                })
            }
            BushingPlace::Mount(limb) => match &self.system.limbs[limb] {
                Limb::Mount(mount) => body(mount.top) + mount.along * step.limbs[limb].inner[0],
                _ => body(self.system.wheel.centre.zero()),
            },
            BushingPlace::Limb { limb, end } => {
                let [a, b, c, d, e, f] = step.limbs[limb].inner;
                let (first, second) = (Vector3::new(a, b, c), Vector3::new(d, e, f));
                let carrier = of_limb(limb);
                let at = |lever: Vector3<T>| shifted(&carrier, lever);
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

    /// Returns the step of the carrier relative to the body that holds a part.
    fn carrier_seen(&self, holder: Holder, on_rack: bool, seen: &SeenStep<'_, T>) -> [T; 6] {
        let carrier = &seen.step.carrier;
        let found = self.system.seen_by(
            holder,
            on_rack,
            carrier,
            seen.shared,
            seen.frames,
            seen.around,
        );
        found.0
    }

    fn set_links(&mut self, seen: &SeenStep<'_, T>) {
        for place in self.links.clone().into_iter().flatten() {
            match place {
                LinkPlace::Rod(number) => {
                    let on_rack = self.system.rods[number].on_rack;
                    let holder = self.system.holders.rods[number];
                    let carrier = self.carrier_seen(holder, on_rack, seen);
                    let rod = &mut self.system.rods[number];
                    if let Some([rate, tension]) = &mut rod.elastic {
                        let moved = shifted(&carrier, rod.joint);
                        // The tension already contains the preload that the study gives the rod.
                        *tension = *tension + *rate * rod.along.normalised().dot(moved);
                    }
                }
                LinkPlace::RockerRod => self.set_rocker_rod(seen),
            }
        }
    }

    fn set_rocker_rod(&mut self, seen: &SeenStep<'_, T>) {
        let holders = self.system.holders.limbs.clone();
        let carriers: Vec<[T; 6]> = holders
            .into_iter()
            .map(|holder| self.carrier_seen(holder, false, seen))
            .collect();
        let limbs = self.system.limbs.iter_mut().zip(&carriers);
        for ((limb, carrier), step_of) in limbs.zip(&seen.step.limbs) {
            let [a, b, c, ..] = step_of.inner;
            let (moved, seat) = match limb {
                Limb::Swinging(arm) => {
                    let joint = shifted(carrier, arm.joint);
                    let Some((lever, seat)) = &mut arm.seat else {
                        continue;
                    };
                    (joint + Vector3::new(a, b, c).cross(*lever), seat)
                }
                Limb::LegSeat(own) => {
                    let joint = shifted(carrier, own.leg.joint);
                    (own.leg.shift(joint), &mut own.seat)
                }
                Limb::CarrierSeat(part) => (shifted(carrier, part.lever), &mut part.seat),
                _ => continue,
            };
            seat.preload_rod(moved, step_of.slide);
        }
    }
}

/// Returns the shift of a point for a small step of a body. `lever` is the vector from the body's reference point to
/// the point.
fn shifted<T: Scalar>(step: &[T; 6], lever: Vector3<T>) -> Vector3<T> {
    let [x, y, z, a, b, c] = *step;
    Vector3::new(x, y, z) + Vector3::new(a, b, c).cross(lever)
}
