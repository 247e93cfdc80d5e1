//! Measures that targets and constraints apply to: catalogue quantities, forces under loads, and geometry of parts.
//!
//! A [`Measure`] has a value in every pose. A geometric measure is a formula of up to six vectors. Each vector is a position or
//! a direction, in the current pose or in the design position. Each formula is written once, over [`Scalar`]. With number types
//! that carry derivatives, it also gives the derivatives with respect to its vectors. The adjoint converts these derivatives
//! into derivatives with respect to the hardpoints.
//!
//! Values are smooth except at these kinks, where the derivative belongs to one side:
//!
//! - edges and inside of a box or tube that a point must stay away from,
//! - change of a member's nearest point from its middle to its end,
//! - parallel members (the formula takes the middle of their overlap),
//! - members that intersect: their distance is 0 at the intersection and grows again beyond it,
//! - end of a member on the edge of a rim,
//! - distances and angles that are 0.

mod formula;
mod input;
#[cfg(test)]
mod tests;

use super::wheel_reading::each_derivative;
use super::{CarriedForce, Quantity, Slot};
use crate::ask::Unit;
use crate::compliance::KcValue;
use crate::derive::{Linearised, Seeds};
use crate::mechanism::Configuration;
use crate::model::{Mechanism, PointId, RockerId};
use crate::number::{Dual, Each, Jet, Real, Scalar, Vector3};
pub(crate) use input::Input;
pub use input::Stud;

/// Measure of a pose, in the kernel's frame.
#[derive(Clone, Debug, PartialEq)]
pub enum Measure {
    /// A quantity of the catalogue.
    Quantity(Quantity),
    /// A force in a link, a joint or the spring under a load.
    Carried(CarriedForce),
    /// Test result, or characteristic, of a wheel with elastic parts. It is computed from equilibria under loads, not from one
    /// pose.
    Elastic(KcValue),
    /// A quantity of an axle with elastic parts. It also follows from equilibria.
    OfAxle(crate::axle::Quantity),
    /// Distance between two points.
    Length([PointId; 2]),
    /// Signed distance of a point from a plane. Positive on the side to which the plane's unit normal points.
    Height {
        /// Point whose distance is measured.
        point: PointId,
        /// A point of the plane.
        over: Vector3<f64>,
        /// Unit normal of the plane.
        normal: Vector3<f64>,
    },
    /// Distance of a point from a fixed point.
    DistanceFrom(PointId, Vector3<f64>),
    /// Distance of a point from a line.
    FromLine {
        /// Point whose distance is measured.
        point: PointId,
        /// A point of the line.
        through: Vector3<f64>,
        /// Unit vector along the line.
        along: Vector3<f64>,
    },
    /// Distance of a point from a box with edges along the coordinate axes. Negative inside the box.
    FromBox {
        /// Point whose distance is measured.
        point: PointId,
        /// Centre of the box.
        middle: Vector3<f64>,
        /// Half the edges of the box.
        half: Vector3<f64>,
    },
    /// Distance of a point from a tube with closed ends. Negative inside the tube.
    FromTube {
        /// Point whose distance is measured.
        point: PointId,
        /// Centre of the tube's axis.
        middle: Vector3<f64>,
        /// Unit vector along the tube's axis.
        along: Vector3<f64>,
        /// Half the length of the tube.
        half: f64,
        /// Radius of the tube.
        radius: f64,
    },
    /// Distance of a point from the spin axis.
    FromSpinAxis(PointId),
    /// Coordinate of a point along the spin axis, positive outboard of the wheel centre.
    AlongSpinAxis(PointId),
    /// Distance from the spin axis at which a member crosses a plane normal to this axis. The points are the outer and the
    /// inner end of the member. The number is the distance of the plane outboard of the wheel centre. If the member does not
    /// cross the plane, the value is the distance of its end nearer to the plane.
    FromSpinAxisAt([PointId; 2], f64),
    /// Distance between two members' centre lines, each between two points.
    Clearance([[PointId; 2]; 2]),
    /// Ball joint between wheel carrier and arm: 1 minus the cosine of an angle. The angle is between the stud and its
    /// design direction, which rotates with the arm.
    BallJoint {
        /// Centre of the ball joint.
        joint: PointId,
        /// Two points of the arm's axis.
        axis: [PointId; 2],
        /// Stud of the ball joint.
        stud: Stud,
    },
    /// Rod end on the wheel carrier: change of the angle between stud and rod since the design position, in rad.
    RodEnd {
        /// Joint of the rod on the wheel carrier, and the other end of the rod.
        rod: [PointId; 2],
        /// Stud of this joint.
        stud: Stud,
    },
    /// Joint at the outer end of a drive shaft: 1 minus the cosine of the angle between shaft and spin axis. The points are
    /// the shaft's inner and outer end.
    OuterShaftJoint([PointId; 2]),
    /// Joint at the inner end of a drive shaft: 1 minus the cosine of the angle between shaft and y axis. The points are the
    /// shaft's inner and outer end.
    InnerShaftJoint([PointId; 2]),
    /// Change of the distance between two points since the design position.
    Plunge([PointId; 2]),
    /// Signed distance of the fourth point from the plane through the other three, in the design position.
    OffPlane([PointId; 4]),
    /// Component of the third point's distance from the line through the other two. All three are in the design position.
    OffLine([PointId; 3], Across),
}

/// Direction normal to a line.
///
/// The first direction is normal to the line and to a coordinate axis. The second is normal to the line and to the first. Two
/// components of a vector, along these two directions, give its distance from the line: the norm of both components.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Across {
    /// Index of the coordinate axis: 0 for x, 1 for y, 2 for z. It must not be parallel to the line.
    pub axis: usize,
    /// True for the second direction, false for the first.
    pub is_second: bool,
}

/// Largest number of vectors that a formula reads.
const MOST: usize = 6;

/// Vectors of a formula. Entries that the formula does not read may have any value.
pub(crate) type Vectors<T> = [Vector3<T>; MOST];

impl Measure {
    /// Quantity of the catalogue. `None` for all other measures.
    pub fn quantity(&self) -> Option<Quantity> {
        match self {
            Measure::Quantity(quantity) => Some(*quantity),
            _ => None,
        }
    }

    /// Highest order of the derivatives with respect to the drive coordinate that the value contains: 1 if it contains
    /// velocities, else 0.
    pub fn rate_order(&self) -> usize {
        self.quantity().map_or(0, Quantity::rate_order)
    }

    /// Inputs (slots) of wheel and steering axis that the measure reads.
    pub fn reads(&self) -> &'static [Slot] {
        match self {
            Measure::Quantity(quantity) => quantity.reads(),
            Measure::Carried(_) => CarriedForce::READS,
            _ => &[],
        }
    }

    /// Rockers that directly influence the measure. Empty for values of equilibria.
    pub fn rockers(&self, mechanism: &Mechanism) -> Vec<RockerId> {
        match self {
            Measure::Quantity(quantity) => return quantity.rockers(mechanism),
            Measure::Carried(force) => return force.rocker(mechanism).into_iter().collect(),
            _ => {}
        }
        let (inputs, count) = self.inputs(mechanism);
        let points = inputs[..count].iter().filter_map(|input| match input {
            Input::Now(point) => mechanism.rockers_moving(*point).next(),
            _ => None,
        });
        points.collect()
    }

    /// Returns true if the value is the same in every pose. Examples are the distance between two points of one part,
    /// and the length of a rod or of a leg of an arm.
    pub fn is_fixed(&self, mechanism: &Mechanism) -> bool {
        match self {
            Measure::Length([a, b]) => mechanism.are_rigidly_joined(*a, *b),
            Measure::OffPlane(_) | Measure::OffLine(..) => true,
            _ => false,
        }
    }

    /// Both components of a point's distance from a line, if the measure is one of these components.
    pub(crate) fn components(&self) -> Option<[Measure; 2]> {
        let Measure::OffLine(points, Across { axis, .. }) = *self else {
            return None;
        };
        let along = |is_second| Measure::OffLine(points, Across { axis, is_second });
        Some([false, true].map(along))
    }

    /// Returns true if the value is 1 minus the cosine of an angle.
    pub(crate) fn is_versine(&self) -> bool {
        matches!(
            self,
            Measure::BallJoint { .. } | Measure::OuterShaftJoint(_) | Measure::InnerShaftJoint(_)
        )
    }

    /// Vectors that the measure's formula reads, and their number. The number is 0 if the measure is not geometric.
    pub(crate) fn inputs(&self, mechanism: &Mechanism) -> ([Input; MOST], usize) {
        let list = |given: &[Input]| {
            let mut inputs = [Input::SpinAxis; MOST];
            inputs[..given.len()].copy_from_slice(given);
            (inputs, given.len())
        };
        use Input::{Designed, Now, StudDesigned, StudNow};
        match *self {
            Measure::Quantity(_)
            | Measure::Carried(_)
            | Measure::Elastic(_)
            | Measure::OfAxle(_) => list(&[]),
            Measure::Length([a, b]) => list(&[Now(a), Now(b)]),
            Measure::Height { point, .. }
            | Measure::DistanceFrom(point, _)
            | Measure::FromLine { point, .. }
            | Measure::FromBox { point, .. }
            | Measure::FromTube { point, .. } => list(&[Now(point)]),
            Measure::FromSpinAxis(point) | Measure::AlongSpinAxis(point) => {
                list(&[Now(point), Now(mechanism.wheel_centre), Input::SpinAxis])
            }
            Measure::FromSpinAxisAt([outer, inner], _) => list(&[
                Now(outer),
                Now(inner),
                Now(mechanism.wheel_centre),
                Input::SpinAxis,
            ]),
            Measure::OuterShaftJoint([inner, outer]) => {
                list(&[Now(inner), Now(outer), Input::SpinAxis])
            }
            Measure::InnerShaftJoint([inner, outer]) => list(&[Now(inner), Now(outer)]),
            Measure::Plunge([a, b]) => list(&[Now(a), Now(b), Designed(a), Designed(b)]),
            Measure::Clearance([[a, b], [c, d]]) => list(&[Now(a), Now(b), Now(c), Now(d)]),
            Measure::BallJoint { joint, axis, stud } => list(&[
                StudNow(stud),
                StudDesigned(stud),
                Designed(axis[0]),
                Designed(axis[1]),
                Designed(joint),
                Now(joint),
            ]),
            Measure::RodEnd {
                rod: [joint, other],
                stud,
            } => list(&[
                StudNow(stud),
                StudDesigned(stud),
                Now(joint),
                Now(other),
                Designed(joint),
                Designed(other),
            ]),
            Measure::OffPlane([a, b, c, d]) => {
                list(&[Designed(a), Designed(b), Designed(c), Designed(d)])
            }
            Measure::OffLine([a, b, c], _) => list(&[Designed(a), Designed(b), Designed(c)]),
        }
    }

    /// Value of a geometric measure in a configuration. If the configuration is a Taylor series, the value is also a
    /// series. For catalogue quantities use [`WheelReading`](super::WheelReading), for forces [`CarriedForce::value`].
    pub fn value<T: Scalar>(&self, at: &Configuration<T>) -> T {
        let (inputs, count) = self.inputs(at.mechanism);
        let like = at.rack;
        let mut vectors = [Vector3::new(like, like, like).zero(); MOST];
        for (vector, input) in vectors.iter_mut().zip(&inputs[..count]) {
            *vector = input.read(at);
        }
        self.formula(&vectors)
    }

    /// Seeds the adjoint of a geometric measure with its derivatives with respect to the vectors that it reads. The
    /// seeds are constants, so only the value of the result is right, not its rates.
    pub fn seed<const N: usize>(
        &self,
        at: &Configuration<Jet<f64, N>>,
        seeds: &mut Seeds<'_, '_, Jet<f64, N>>,
    ) {
        let (inputs, count) = self.inputs(at.mechanism);
        let mut vectors = [Vector3::new(0.0, 0.0, 0.0); MOST];
        for (vector, input) in vectors.iter_mut().zip(&inputs[..count]) {
            *vector = input.read(at).map(|c| c[0]);
        }
        for (k, input) in inputs[..count].iter().enumerate() {
            let gradient = self.by_vector(k, &vectors);
            input.push(gradient.map(Jet::constant), at, seeds);
        }
    }

    /// Unit of the shown value of a geometric measure.
    pub fn shown_unit(&self) -> Unit {
        if self.is_versine() || matches!(self, Measure::RodEnd { .. }) {
            Unit::Angle
        } else {
            Unit::Length
        }
    }

    /// Reason for a missing derivative of an angle.
    pub const KINK: &'static str = "the angle of the joint is 0, where it has a kink";

    /// Smallest angle, in rad, at which derivatives are computed. Rounding errors rotate the direction of the stud by
    /// about 1e-15 rad. At smaller angles, these errors would change the derivatives by more than 1e-6 of their value.
    const LEAST_ANGLE: f64 = 1e-9;

    /// Versine (1 minus the cosine) of an angle. Below [`Self::LEAST_ANGLE`], the versine is exactly 0 and has no
    /// derivatives.
    fn versine_of_angle<T: Scalar>(versine: T) -> T {
        let least = 0.5 * Self::LEAST_ANGLE * Self::LEAST_ANGLE;
        if versine.value() < least {
            versine.zero()
        } else {
            versine
        }
    }

    /// Value that outputs show. If the measure is 1 minus the cosine of an angle, the shown value is this angle in rad.
    /// Otherwise it is the measure itself. 1 - cos a = v gives a = 2 asin(sqrt(v/2)), which is accurate for small
    /// angles, too.
    pub fn shown<T: Scalar>(&self, at: &Configuration<T>) -> T {
        let value = self.value(at);
        if self.is_versine() {
            let value = Self::versine_of_angle(value);
            value.scaled(0.5).sqrt().asin().scaled(2.0)
        } else {
            value
        }
    }

    /// Computes gradients of the shown value with respect to every hardpoint coordinate. Also computes the gradients of
    /// its derivatives with respect to the drive coordinate, up to the order `highest`. `buffer` has one entry per
    /// point. `receive` gets the order, the point and the gradient, for every order and point.
    ///
    /// With f the measure's formula and v_k its vectors, the seed series are df/dv_k. For an angle they are multiplied by
    /// da/dv = 1/sqrt(v (2 - v)).
    pub fn shown_gradients<const N: usize>(
        &self,
        linearised: &Linearised<'_, N>,
        highest: usize,
        buffer: &mut [Vector3<Jet<f64, N>>],
        receive: &mut dyn FnMut(usize, PointId, Vector3<f64>),
    ) {
        let at = &linearised.at;
        let (inputs, count) = self.inputs(at.mechanism);
        let zero = Vector3::new(0.0, 0.0, 0.0).map(Jet::constant);
        let mut vectors = [zero; MOST];
        for (vector, input) in vectors.iter_mut().zip(&inputs[..count]) {
            *vector = input.read(at);
        }
        let mut slope = Jet::constant(1.0);
        if self.is_versine() {
            let value = Self::versine_of_angle(self.formula(&vectors));
            slope = slope / (value * (Jet::constant(2.0) - value)).sqrt();
        }
        buffer.fill(zero);
        linearised.gradient(buffer, |seeds: &mut Seeds<'_, '_, _>| {
            for (k, input) in inputs[..count].iter().enumerate() {
                input.push(self.by_vector(k, &vectors) * slope, at, seeds);
            }
        });
        each_derivative(buffer, highest, receive);
    }

    /// Derivative of the formula with respect to the vector with this index.
    pub(crate) fn by_vector<T: Scalar>(&self, number: usize, vectors: &Vectors<T>) -> Vector3<T> {
        let mut seeded = vectors.each(|v| v.map(Dual::<T, 3>::constant));
        seeded[number] = Dual::inputs(vectors[number]);
        Vector3::from(self.formula(&seeded).partials)
    }
}
