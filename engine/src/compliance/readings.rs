//! Forces and deflections of bushings, links and spring in a state.

use super::algebra::{Logarithm, Placed};
use super::build::{Built, BushingPlace, LinkPlace};
use super::bushing::{Bushing, BushingState};
use super::floating::Floating;
use super::ground::{Frames, Surroundings};
use super::limb::LimbStep;
use super::parts::Joint;
use super::reading::WheelFigures;
use super::swinging::Swinging;
use super::system::{Limb, State, System};
use super::wheel::{BushingReading, ElasticWheel, Equilibrium, SpringReading};
use crate::axle::Stop;
use crate::mechanism::Pose;
use crate::number::{Each, Scalar, Valued, Vector3};

/// Largest reliable rotation of a bushing, radians. At larger rotations, the law of the bushing is not reliable.
const LARGEST_ROTATION: f64 = std::f64::consts::FRAC_PI_3;

impl<T: Scalar> Built<T> {
    /// Returns the state of each bushing, in the order of the definition, then the states of the subframe's mounts.
    pub(super) fn bushing_readings(
        &self,
        state: &State<T>,
        around: &Surroundings<T>,
    ) -> Vec<BushingReading<T>> {
        let frames = self.system.frames(&state.carrier, around, false);
        let read = |place: &BushingPlace| match *place {
            BushingPlace::Limb { limb, end } => {
                let at = frames.of(self.system.holders.limbs[limb]);
                let states = self.system.limb_bushings(limb, at, state);
                let bushing = match &self.system.limbs[limb] {
                    Limb::Swinging(arm) => arm.ends[end].bushing.as_ref(),
                    Limb::Floating(link) if end == 0 => link.inner.as_ref(),
                    Limb::Floating(link) => Some(&link.outer),
                    _ => None,
                };
                states[end]
                    .zip(bushing)
                    .map(|(state, bushing)| reading(&state, bushing))
            }
            BushingPlace::Carrier(part) => {
                let at = frames.of(self.system.holders.bushings[part]);
                let part = &self.system.bushings[part];
                let e = at.carrier.displacement(part.lever);
                let state = part.bushing.state(e, &at.carrier.turn);
                Some(reading(&state, &part.bushing))
            }
            BushingPlace::Mount(limb) => {
                let Limb::Mount(mount) = &self.system.limbs[limb] else {
                    return None;
                };
                let found = self.system.mount(&frames, state)?;
                let ([x, y], [a, b]) = (found.tilt, found.tilt_torque);
                // The force and torque of the law act on the body that holds the mount, as in `BushingState`.
                let state = BushingState {
                    deflection: found.deflection,
                    rotation: Vector3::new(x, y, x.zero()),
                    force: found.force,
                    torque: Vector3::new(a, b, a.zero()),
                };
                Some(reading(&state, &mount.bushing))
            }
            BushingPlace::Subframe(number) => {
                let mounts = &self.system.subframe.as_ref()?.mounts;
                let state = self.system.mount_state(number, around)?;
                Some(reading(&state, &mounts[number].bushing))
            }
        };
        self.bushings.iter().filter_map(read).collect()
    }

    /// Returns the tension of each link, in the order of the definition. `None` for the rod of a rocker whose spring has no law.
    pub(super) fn tensions(&self, state: &State<T>, around: &Surroundings<T>) -> Vec<Option<T>> {
        let frames = self.system.frames(&state.carrier, around, false);
        let tension = |place: LinkPlace| match place {
            LinkPlace::Rod(number) => {
                let rod = &self.system.rods[number];
                let [rate, tension] = rod.elastic?;
                let at = frames.of(self.system.holders.rods[number]);
                Some(tension + rate * rod.line(at).stretch)
            }
            LinkPlace::RockerRod => self.system.seat(&frames, state)?.rod_tension,
        };
        let links = self.links.iter();
        links.map(|place| place.and_then(tension)).collect()
    }

    /// State of the spring: its length, its force, and contact with its stops.
    pub(super) fn spring_reading(
        &self,
        state: &State<T>,
        around: &Surroundings<T>,
    ) -> Option<SpringReading<T>> {
        let frames = self.system.frames(&state.carrier, around, false);
        let laws = self.system.limbs.iter().find_map(|limb| match limb {
            Limb::Mount(mount) => mount.spring.as_ref(),
            Limb::Swinging(arm) => arm.seat.as_ref().map(|(_, seat)| &seat.law),
            Limb::LegSeat(leg) => Some(&leg.seat.law),
            Limb::CarrierSeat(part) => Some(&part.seat.law),
            Limb::Floating(_) => None,
        })?;
        let seat = self.system.seat(&frames, state);
        let (length, design, force) = match seat {
            Some(seat) => (seat.spring_length, seat.design_length, seat.spring_force),
            None => {
                let mount = self.system.mount(&frames, state)?;
                (mount.spring_length, mount.design_length, mount.spring_force)
            }
        };
        Some(SpringReading {
            length,
            force,
            meets_bump_stop: laws.meets(Stop::Bump, length, design),
            meets_rebound_stop: laws.meets(Stop::Rebound, length, design),
        })
    }

    /// Returns the force that holds the rack, along +y of its holder. This force is the derivative of the energy with
    /// respect to the rack's displacement.
    pub(super) fn rack_force(&self, state: &State<T>, around: &Surroundings<T>) -> T {
        let frames = self.system.frames(&state.carrier, around, false);
        let at = *frames.of(self.system.holders.rack);
        let mut force = around.rack.zero();
        for rod in &self.system.rods {
            if let Some([rate, tension]) = rod.elastic.filter(|_| rod.on_rack) {
                let line = rod.line(&at);
                force = force - (tension + rate * line.stretch) * line.direction.y;
            }
        }
        for (joint, pull) in self.system.joints.iter().zip(state.joints) {
            if let Joint::Rod(rod) = joint
                && rod.on_rack
            {
                force = force - pull * rod.line(&at).direction.y;
            }
        }
        for (k, limb) in self.system.limbs.iter().enumerate() {
            let states = self.system.limb_bushings(k, &at, state);
            match limb {
                Limb::Swinging(arm) => {
                    for (end, found) in arm.ends.iter().zip(states) {
                        if let (true, Some(bushing), Some(found)) =
                            (end.on_rack, &end.bushing, found)
                        {
                            force = force - bushing.axes.apply(found.force).y;
                        }
                    }
                }
                Limb::Floating(link) if link.on_rack => {
                    force = force - rack_force_of(link, &states, &at.carrier)
                }
                _ => {}
            }
        }
        force
    }

    /// Converts the system to another number type.
    pub(super) fn system_over<U: Scalar>(&self, f: impl Fn(T) -> U + Copy) -> System<U> {
        self.system.map(f)
    }
}

impl System<f64> {
    /// Returns the tension of the rod between suspension and rocker. A rigid rod carries the whole force at its outer
    /// end, along its line. The angle between this line and its direction in the design position stays below 90
    /// degrees.
    pub(super) fn rocker_rod(&self, frames: &Frames<f64>, state: &State<f64>) -> Option<f64> {
        let limbs = self.limbs.iter().zip(&self.holders.limbs);
        let (seat, moved, slide) = limbs.zip(&state.limbs).find_map(|((limb, holder), own)| {
            let at = frames.of(*holder);
            match limb {
                Limb::Swinging(arm) => {
                    let place = arm.seat.as_ref()?;
                    Some((&place.1, arm.seat_displacement(place, at, own), own.slide))
                }
                Limb::LegSeat(leg) => Some((&leg.seat, leg.displacement(at), own.slide)),
                Limb::CarrierSeat(part) => {
                    let moved = at.carrier.displacement(part.lever);
                    Some((&part.seat, moved, own.slide))
                }
                _ => None,
            }
        })?;
        let rocker = seat.rocker.as_ref()?;
        // The derivative of the energy is minus the force of the rod on the suspension.
        let force = -seat.force(moved, slide, 0.0, false).point.force;
        let inward = rocker.inner - seat.point;
        Some(force.norm().copysign(force.dot(inward)))
    }
}

impl<T: Scalar> System<T> {
    /// Length of the spring; `None` without a spring.
    pub(super) fn spring_length(&self, state: &State<T>, rack: T) -> Option<T> {
        let frames = self.frames(&state.carrier, &Surroundings::of_rack(rack), false);
        match self.seat(&frames, state) {
            Some(seat) => Some(seat.spring_length),
            None => Some(self.mount(&frames, state)?.spring_length),
        }
    }
}

impl<T: Scalar> ElasticWheel<T> {
    /// Angles and positions of the wheel.
    pub fn figures(&self, at: &Equilibrium<T>) -> WheelFigures<T> {
        self.geometry.figures(&at.solution.state, self.constants)
    }

    /// Angles and positions of the wheel. The vertical force is the total force at the contact point.
    pub(crate) fn figures_with_load(&self, at: &Equilibrium<T>) -> WheelFigures<T> {
        let mut figures = self.figures(at);
        figures.vertical = self.wheel_load(at);
        figures
    }

    /// Pose of the wheel carrier. `origin` is the knuckle's origin in the design position.
    pub(crate) fn pose(&self, at: &Equilibrium<T>, origin: Vector3<T>) -> Pose<T> {
        let carrier = &at.solution.state.carrier;
        carrier.as_pose(self.built.reference, origin)
    }

    /// Height of the wheel centre above its design position.
    pub fn travel(&self, at: &Equilibrium<T>) -> T {
        let centre = self.built.system.wheel.centre;
        at.solution.state.carrier.displacement(centre).z
    }

    /// Total vertical force at the contact point.
    pub fn wheel_load(&self, at: &Equilibrium<T>) -> T {
        at.solution.state.vertical + at.solution.task.loads.contact.z
    }

    /// State of each bushing, in the order of the definition.
    pub fn bushings(&self, at: &Equilibrium<T>) -> Vec<BushingReading<T>> {
        self.built
            .bushing_readings(&at.solution.state, &at.around())
    }

    /// Tension of each link, in the order of the definition. `None` for the rod of a rocker whose spring has no law.
    pub fn tensions(&self, at: &Equilibrium<T>) -> Vec<Option<T>> {
        self.built.tensions(&at.solution.state, &at.around())
    }

    /// State of the spring, if it has a law.
    pub fn spring(&self, at: &Equilibrium<T>) -> Option<SpringReading<T>> {
        self.built.spring_reading(&at.solution.state, &at.around())
    }

    /// Force that holds the rack, along the kernel's +y.
    pub fn rack_force(&self, at: &Equilibrium<T>) -> T {
        self.built.rack_force(&at.solution.state, &at.around())
    }

    /// Rotation vector of the carrier.
    pub fn rotation(&self, at: &Equilibrium<T>) -> Vector3<T> {
        Logarithm::of(&at.solution.state.carrier.turn).vector
    }
}

/// Returns the force of a link on the rack, along +y. If the link has a ball joint at the rack, this force equals the
/// force of the carrier's bushing on the link.
fn rack_force_of<T: Scalar>(
    link: &Floating<T>,
    states: &[Option<BushingState<T>>; 2],
    carrier: &Placed<T>,
) -> T {
    match (&link.inner, states) {
        (Some(bushing), [Some(found), _]) => bushing.axes.apply(found.force).y,
        (_, [_, Some(found)]) => {
            let in_carrier = link.outer.axes.apply(found.force);
            // Let F be the force of the bushing on the carrier. The carrier exerts -F on the link. So the rack exerts
            // +F on the link, and the link exerts -F on the rack.
            -carrier.rotation().apply(in_carrier).y
        }
        _ => carrier.shift.x.zero(),
    }
}

fn reading<T: Scalar>(state: &BushingState<T>, bushing: &Bushing<T>) -> BushingReading<T> {
    let [d, r] = [state.deflection, state.rotation].each(|v| v.map(Scalar::value).to_array());
    let beyond =
        (0..3).any(|k| bushing.laws[k].is_beyond(d[k]) || bushing.laws[3 + k].is_beyond(r[k]));
    BushingReading {
        deflection: state.deflection,
        rotation: state.rotation,
        force: -state.force,
        torque: -state.torque,
        is_extrapolated: beyond || Vector3::from(r).norm() > LARGEST_ROTATION,
    }
}

impl<T: Valued> Limb<T> {
    /// Returns the rotation vector of a part in a Newton step.
    #[inline(always)]
    pub(super) fn turn_vector(&self, step: &LimbStep<T>) -> Vector3<T> {
        let [a, b, c, d, e, f] = step.inner;
        match self {
            Limb::Swinging(_) | Limb::Floating(Floating { inner: None, .. }) => {
                Vector3::new(a, b, c)
            }
            Limb::Floating(_) => Vector3::new(d, e, f),
            Limb::Mount(_) | Limb::LegSeat(_) | Limb::CarrierSeat(_) => {
                Vector3::new(a, b, c).zero()
            }
        }
    }

    /// Returns the rotation vector of a part in a Newton step, without the rotation of a link about its own line.
    #[inline(always)]
    pub(super) fn turn_across(&self, step: &LimbStep<T>) -> Vector3<T> {
        let turn = self.turn_vector(step);
        match self {
            Limb::Swinging(Swinging {
                spin: Some(along), ..
            })
            | Limb::Floating(Floating { spin: along, .. }) => turn.across(along.normalised()),
            _ => turn,
        }
    }
}
