//! Angles and positions of the wheel in an equilibrium. The formulas come from the catalogue of characteristics.
//!
//! The spin is the rotation of the carrier about the spin axis. In the design position, the direction h of the carrier is
//! along the wheel's heading. The spin is
//!
//! ```text
//! spin = atan2(h.u, h.T),   u = T x a                                                             (1)
//! ```
//!
//! where T is the horizontal heading of the wheel and a its spin axis. The spin is positive if the front of the carrier rises,
//! as for increasing caster.

use super::build::Built;
use super::loads::WheelPart;
use super::system::{Limb, State};
use crate::characteristics::{Characteristic, Constants, DesignWheel, Inputs, Wheel};
use crate::mechanism::Ground;
use crate::model::{Mechanism, SteeringAxis};
use crate::number::{Each, Real, Scalar, Vector3};

/// Points from which the pose of a wheel is computed, in the design position.
#[derive(Clone, Copy, Debug)]
pub(super) struct WheelGeometry<T> {
    /// Reference point of the carrier.
    pub(super) origin: Vector3<T>,
    pub(super) wheel: WheelPart<T>,
    pub(super) steering: SteeringJoints<T>,
}

/// Points of the steering axis, as vectors from the carrier's reference point.
#[derive(Clone, Copy, Debug)]
pub(super) enum SteeringJoints<T> {
    /// The joints do not give a steering axis.
    None,
    /// Two joints of the carrier.
    Joints([Vector3<T>; 2]),
    /// Joint of the carrier, and mount of the strut at the body. An elastic mount moves along the line of the strut.
    Strut {
        lower: Vector3<T>,
        top: Vector3<T>,
        /// For an elastic mount: its index among the parts that have their own degrees of freedom, and the direction of the strut.
        /// `None` for a rigid mount.
        mount: Option<(usize, Vector3<T>)>,
    },
}

/// Angles and positions of the wheel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelFigures<T = f64> {
    /// Toe angle.
    pub toe: T,
    /// Camber angle.
    pub camber: T,
    /// Caster angle and kingpin inclination; `None` without joints that give a steering axis.
    pub steering: Option<[T; 2]>,
    /// Spin of the carrier, by equation (1) of this module.
    pub spin: T,
    /// Position of the wheel centre.
    pub centre: Vector3<T>,
    /// Position of the contact point.
    pub contact: Vector3<T>,
    /// Vertical force at the contact point that holds the height; 0 if the wheel load is held.
    pub vertical: T,
}

impl<T: Real> WheelGeometry<T> {
    pub(super) fn map<U: Copy>(&self, f: impl Fn(T) -> U + Copy) -> WheelGeometry<U> {
        let steering = match self.steering {
            SteeringJoints::None => SteeringJoints::None,
            SteeringJoints::Joints(points) => {
                SteeringJoints::Joints(points.each(|point| point.map(f)))
            }
            SteeringJoints::Strut { lower, top, mount } => SteeringJoints::Strut {
                lower: lower.map(f),
                top: top.map(f),
                mount: mount.map(|(limb, along)| (limb, along.map(f))),
            },
        };
        WheelGeometry {
            origin: self.origin.map(f),
            wheel: WheelPart {
                centre: self.wheel.centre.map(f),
                spin_axis: self.wheel.spin_axis.map(f),
                radius: self.wheel.radius,
            },
            steering,
        }
    }
}

impl<T: Scalar> WheelGeometry<T> {
    /// Collects the points of a design from which the pose of its wheel is computed.
    pub(super) fn of(mechanism: &Mechanism, design: &[Vector3<T>], built: &Built<T>) -> Self {
        let (origin, system) = (built.reference, &built.system);
        let mount = system
            .limbs
            .iter()
            .enumerate()
            .find_map(|(k, limb)| match limb {
                Limb::Mount(mount) => Some((k, mount.along)),
                _ => None,
            });
        let steering = match mechanism.steering_axis {
            Some(SteeringAxis::Through { lower, upper }) => {
                let points = [lower, upper].each(|id| design[id.0] - origin);
                match mechanism.body(upper) {
                    crate::model::Body::Knuckle => SteeringJoints::Joints(points),
                    _ => SteeringJoints::Strut {
                        lower: points[0],
                        top: points[1],
                        mount,
                    },
                }
            }
            Some(SteeringAxis::Instantaneous) | None => SteeringJoints::None,
        };
        WheelGeometry {
            origin,
            wheel: system.wheel,
            steering,
        }
    }

    /// Returns the inputs of the catalogue's formulas in a state. Rates, spring, rocker and bar are not included.
    pub(super) fn inputs(&self, state: &State<T>, constants: Constants) -> Inputs<T> {
        let carrier = &state.carrier;
        let nothing = carrier.shift.x.constant(f64::NAN);
        let unknown = Wheel::of_parts(|_| carrier.shift.constant(NOTHING), |_| nothing);
        let mut now = unknown;
        let at = |lever: Vector3<T>| self.origin + lever + carrier.displacement(lever);
        now.spin_axis = carrier.lever(self.wheel.spin_axis);
        now.centre = at(self.wheel.centre);
        let steering = match self.steering {
            SteeringJoints::None => None,
            SteeringJoints::Joints([lower, upper]) => {
                Some((at(lower), carrier.lever(upper - lower)))
            }
            SteeringJoints::Strut { lower, top, mount } => {
                let upper = match mount {
                    None => self.origin + top,
                    Some((limb, along)) => at(top) + carrier.lever(along) * state.limbs[limb].slide,
                };
                let lower = at(lower);
                Some((lower, upper - lower))
            }
        };
        if let Some((point, direction)) = steering {
            (now.steering_point, now.steering_direction) = (point, direction);
        }
        let mut design = DesignWheel::filled(nothing);
        design.spin_axis = self.wheel.spin_axis;
        design.centre = self.origin + self.wheel.centre;
        Inputs {
            now,
            rate: unknown,
            turn: carrier.shift.constant(NOTHING),
            design,
            constants,
        }
    }

    /// Angles and positions of the wheel in a state.
    pub(super) fn figures(&self, state: &State<T>, constants: Constants) -> WheelFigures<T> {
        let inputs = self.inputs(state, constants);
        let (axis, centre) = (inputs.now.spin_axis, inputs.now.centre);
        let has_axis = !matches!(self.steering, SteeringJoints::None);
        let of = |characteristic: Characteristic| characteristic.evaluate(&inputs);
        let lever = Ground::level(axis.x).contact_lever(axis, self.wheel.radius);
        let (heading, _) = Wheel::<T>::heading_and_outboard_of(axis);
        let (designed, _) = Wheel::<T>::heading_and_outboard_of(self.wheel.spin_axis);
        let nose = state.carrier.lever(designed);
        WheelFigures {
            toe: of(Characteristic::Toe),
            camber: of(Characteristic::Camber),
            steering: has_axis.then(|| {
                [
                    of(Characteristic::Caster),
                    of(Characteristic::KingpinInclination),
                ]
            }),
            spin: nose.dot(heading.cross(axis)).atan2(nose.dot(heading)),
            centre,
            contact: centre + lever,
            vertical: state.vertical,
        }
    }
}

/// Vector of NaN, for inputs that are not known.
const NOTHING: Vector3<f64> = Vector3::new(f64::NAN, f64::NAN, f64::NAN);
