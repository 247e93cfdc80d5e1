//! Measures that targets and constraints apply to: quantities of the catalogue, forces under loads, geometry of parts.
//!
//! A [`Measure`] has a value in every pose. Geometric measures are formulas of up to six vectors. Each vector is a position
//! or a direction, in the current pose or in the design position. Each formula is written once, over [`Scalar`]. With
//! derivative numbers, it gives its derivatives by its vectors. The adjoint turns these into derivatives by the hardpoints.
//!
//! Values are smooth except at these kinks, where the derivative is that of one side:
//!
//! - edges and inside of a box or tube that a point must stay away from,
//! - change of the nearest place of a member from its middle to its end,
//! - parallel members; the formula takes the middle of their overlap,
//! - members that intersect: their distance is 0 there and grows again beyond,
//! - end of a member on the edge of a rim.

use super::{CarriedForce, Quantity, Slot};
use crate::compliance::KcValue;
use crate::derive::Seeds;
use crate::mechanism::Configuration;
use crate::model::{Mechanism, PointId, RockerId};
use crate::number::{Dual, Jet, Scalar, Vector3};

/// Measure of a pose, in the kernel's frame.
#[derive(Clone, Debug, PartialEq)]
pub enum Measure {
    /// A quantity of the catalogue.
    Quantity(Quantity),
    /// A force in a link, a joint or the spring under a load.
    Carried(CarriedForce),
    /// A value of a wheel with elastic parts. It comes from equilibria, so a single pose does not give it.
    Elastic(KcValue),
    /// A quantity of an axle with elastic parts. It also comes from equilibria.
    OfAxle(crate::axle::Quantity),
    /// Distance between two points.
    Length([PointId; 2]),
    /// Signed distance of a point from a plane. Positive on the side to which the plane's unit normal points.
    Height {
        /// The point.
        point: PointId,
        /// A point of the plane.
        over: Vector3<f64>,
        /// Unit normal.
        normal: Vector3<f64>,
    },
    /// Distance of a point from a fixed point.
    DistanceFrom(PointId, Vector3<f64>),
    /// Distance of a point from a line.
    FromLine {
        /// The point.
        point: PointId,
        /// A point of the line.
        through: Vector3<f64>,
        /// Unit vector along it.
        along: Vector3<f64>,
    },
    /// Distance of a point from a box along the axes. Negative inside the box.
    FromBox {
        /// The point.
        point: PointId,
        /// Centre of the box.
        middle: Vector3<f64>,
        /// Half the edges of the box.
        half: Vector3<f64>,
    },
    /// Distance of a point from a tube with closed ends. Negative inside the tube.
    FromTube {
        /// The point.
        point: PointId,
        /// Centre of its axis.
        middle: Vector3<f64>,
        /// Unit vector along the axis.
        along: Vector3<f64>,
        /// Half its length.
        half: f64,
        /// Radius.
        radius: f64,
    },
    /// Distance of a point from the spin axis.
    FromSpinAxis(PointId),
    /// Distance of a point outboard of the wheel centre, along the spin axis.
    AlongSpinAxis(PointId),
    /// Distance from the spin axis at which a member crosses a plane normal to that axis. The points are the outer and the
    /// inner end of the member. The number is the distance of the plane outboard of the wheel centre. If the member does not
    /// cross the plane, the value is that of its end nearer to the plane.
    FromSpinAxisAt([PointId; 2], f64),
    /// Distance between two members' centre lines, each between two points.
    Clearance([[PointId; 2]; 2]),
    /// Ball joint between wheel carrier and arm: 1 minus the cosine of an angle. The angle is between the stud and its
    /// design direction, which rotates with the arm.
    BallJoint {
        /// Joint.
        joint: PointId,
        /// Axis of the arm.
        axis: [PointId; 2],
        /// Stud of the joint.
        stud: Stud,
    },
    /// Rod end on the wheel carrier: change of the angle between stud and rod since the design position, in rad.
    RodEnd {
        /// Joint, and the other end of the rod.
        rod: [PointId; 2],
        /// Stud of the joint.
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
    /// Offset of the third point from the line through the other two, along the axis with this index. All three are in
    /// the design position.
    OffLine([PointId; 3], usize),
}

/// Direction of a joint's stud, fixed in the wheel carrier.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stud {
    /// Direction from one point to another, in the design position.
    Between(PointId, PointId),
    /// Given direction, in the design position.
    Along(Vector3<f64>),
}

/// Largest number of vectors that a formula reads.
const MOST: usize = 6;

/// Vectors of a formula. Entries that it does not read may have any value.
pub(crate) type Vectors<T> = [Vector3<T>; MOST];

/// A vector that a formula reads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Input {
    /// Present position of a point.
    Now(PointId),
    /// Position of a point in the design position.
    Designed(PointId),
    /// The spin axis.
    SpinAxis,
    /// Direction of a stud in the present pose.
    StudNow(Stud),
    /// Direction of a stud in the design position.
    StudDesigned(Stud),
}

impl Measure {
    /// Quantity of the catalogue, if the measure is one.
    pub fn quantity(&self) -> Option<Quantity> {
        match self {
            Measure::Quantity(quantity) => Some(*quantity),
            _ => None,
        }
    }

    /// Order of the derivatives by the drive from which the value is computed: 0 or 1.
    pub fn rate_order(&self) -> usize {
        self.quantity().map_or(0, Quantity::rate_order)
    }

    /// Slots of wheel and steering axis that the measure reads.
    pub fn reads(&self) -> &'static [Slot] {
        match self {
            Measure::Quantity(quantity) => quantity.reads(),
            Measure::Carried(_) => CarriedForce::READS,
            _ => &[],
        }
    }

    /// Rockers that influence the measure.
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

    /// Returns true if the value is 1 minus the cosine of an angle.
    pub(crate) fn is_versine(&self) -> bool {
        matches!(
            self,
            Measure::BallJoint { .. } | Measure::OuterShaftJoint(_) | Measure::InnerShaftJoint(_)
        )
    }

    /// Vectors that its formula reads, and their number. 0 if the measure is not geometric.
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

    /// Value of a geometric measure along a series of poses. [`WheelReading`](super::WheelReading) evaluates quantities of
    /// the catalogue, [`CarriedForce::value`] evaluates forces.
    pub fn value<T: Scalar>(&self, at: &Configuration<T>) -> T {
        let (inputs, count) = self.inputs(at.mechanism);
        let like = at.rack;
        let mut vectors = [Vector3::new(like, like, like).zero(); MOST];
        for (vector, input) in vectors.iter_mut().zip(&inputs[..count]) {
            *vector = input.read(at);
        }
        self.formula(&vectors)
    }

    /// Seeds the adjoint of a geometric measure with its derivatives by the vectors that it reads.
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

    /// Derivative of the formula by the vector with this index.
    pub(crate) fn by_vector(&self, number: usize, vectors: &Vectors<f64>) -> Vector3<f64> {
        let mut seeded = vectors.map(|v| v.map(Dual::<f64, 3>::constant));
        seeded[number] = Dual::inputs(vectors[number]);
        Vector3::from(self.formula(&seeded).partials)
    }

    /// Evaluates the formula for the vectors that `inputs` names.
    pub(crate) fn formula<T: Scalar>(&self, v: &Vectors<T>) -> T {
        match self {
            Measure::Quantity(_)
            | Measure::Carried(_)
            | Measure::Elastic(_)
            | Measure::OfAxle(_) => v[0].x.constant(f64::NAN),
            Measure::Length(_) => (v[0] - v[1]).norm(),
            Measure::Height { over, normal, .. } => {
                let p = v[0];
                (p - p.constant(*over)).dot(p.constant(*normal))
            }
            Measure::DistanceFrom(_, centre) => length(v[0] - v[0].constant(*centre)),
            Measure::FromLine { through, along, .. } => {
                let (p, along) = (v[0], v[0].constant(*along));
                length((p - p.constant(*through)).cross(along))
            }
            Measure::FromBox { middle, half, .. } => {
                let away = (v[0] - v[0].constant(*middle)).to_array();
                let half = half.to_array();
                outside(&std::array::from_fn::<T, 3, _>(|i| {
                    magnitude(away[i]) - away[i].constant(half[i])
                }))
            }
            Measure::FromTube {
                middle,
                along,
                half,
                radius,
                ..
            } => {
                let (p, along) = (v[0], v[0].constant(*along));
                let away = p - p.constant(*middle);
                let radial = away.cross(along).norm() - away.x.constant(*radius);
                let axial = magnitude(away.dot(along)) - away.x.constant(*half);
                outside(&[radial, axial])
            }
            Measure::FromSpinAxis(_) => (v[0] - v[1]).cross(v[2]).norm(),
            Measure::AlongSpinAxis(_) => (v[0] - v[1]).dot(v[2]),
            Measure::FromSpinAxisAt(_, offset) => {
                let [outer, inner, centre, axis, ..] = *v;
                let beyond = (outer - centre).dot(axis) - centre.x.constant(*offset);
                let span = (outer - inner).dot(axis);
                let place = if beyond.value() <= 0.0 {
                    outer
                } else if beyond.value() >= span.value() {
                    inner
                } else {
                    outer + (inner - outer) * (beyond / span)
                };
                (place - centre).cross(axis).norm()
            }
            Measure::OuterShaftJoint(_) => versine(v[1] - v[0], v[2]),
            Measure::InnerShaftJoint(_) => {
                let shaft = v[1] - v[0];
                versine(shaft, shaft.constant(Vector3::new(0.0, 1.0, 0.0)))
            }
            Measure::Plunge(_) => (v[1] - v[0]).norm() - (v[3] - v[2]).norm(),
            Measure::Clearance(_) => between_segments([v[0], v[1]], [v[2], v[3]]),
            Measure::BallJoint { .. } => {
                let [now, designed, front, rear, joint, joint_now] = *v;
                let axis = (rear - front).normalised();
                let across = |p: Vector3<T>| p - axis * axis.dot(p);
                let (radius, radius_now) = (across(joint - front), across(joint_now - front));
                let inverse = axis.x.one() / radius.norm_squared();
                let cosine = radius.dot(radius_now) * inverse;
                let sine = axis.dot(radius.cross(radius_now)) * inverse;
                // Direction of the stud after its rotation with the arm.
                let lever = across(designed);
                let carried = designed - lever + lever * cosine + axis.cross(lever) * sine;
                versine(now, carried)
            }
            Measure::RodEnd { .. } => {
                let angle = |stud: Vector3<T>, joint: Vector3<T>, other: Vector3<T>| {
                    let rod = other - joint;
                    stud.cross(rod).norm().atan2(stud.dot(rod))
                };
                angle(v[0], v[2], v[3]) - angle(v[1], v[4], v[5])
            }
            Measure::OffPlane(_) => {
                let normal = (v[1] - v[0]).cross(v[2] - v[0]).normalised();
                normal.dot(v[3] - v[0])
            }
            Measure::OffLine(_, axis) => {
                let along = (v[1] - v[0]).normalised();
                let away = v[2] - v[0];
                (away - along * along.dot(away)).to_array()[*axis]
            }
        }
    }
}

/// Versine: 1 minus the cosine of the angle between two directions. The formula has no kink at zero angle, and no
/// cancellation.
fn versine<T: Scalar>(a: Vector3<T>, b: Vector3<T>) -> T {
    (a.normalised() - b.normalised()).norm_squared().scaled(0.5)
}

/// Length |v|. At v = 0 its derivative is 0, the mean over all directions.
fn length<T: Scalar>(v: Vector3<T>) -> T {
    let square = v.norm_squared();
    if square.value() == 0.0 {
        square
    } else {
        square.sqrt()
    }
}

/// Absolute value |x|. Its derivative is the sign of x.
fn magnitude<T: Scalar>(x: T) -> T {
    if x.value() < 0.0 { -x } else { x }
}

/// Distance from the region in which all of `excess` are negative. Outside it is the norm of the positive ones as a vector,
/// inside it is the largest one.
fn outside<T: Scalar>(excess: &[T]) -> T {
    let mut largest = excess[0];
    let mut square = largest.zero();
    let mut positive = 0;
    for &e in excess {
        if e.value() > largest.value() {
            largest = e;
        }
        if e.value() > 0.0 {
            square = square + e.squared();
            positive += 1;
        }
    }
    match positive {
        0 | 1 => largest,
        _ => square.sqrt(),
    }
}

/// Distance of two segments. The nearest places are found in plain numbers. The distance has its minimum there, so to first
/// order the derivative does not depend on a move of these places.
fn between_segments<T: Scalar>(first: [Vector3<T>; 2], second: [Vector3<T>; 2]) -> T {
    let plain = |v: Vector3<T>| v.map(|c| c.value());
    let (p, q) = (plain(first[0]), plain(second[0]));
    let (u, w) = (plain(first[1]) - p, plain(second[1]) - q);
    let (uu, ww, uw) = (u.dot(u), w.dot(w), u.dot(w));
    let apart = p - q;
    let (ua, wa) = (u.dot(apart), w.dot(apart));
    let determinant = uu * ww - uw * uw;
    let on_second = |s: f64| ((uw * s + wa) / ww).clamp(0.0, 1.0);
    let on_first = |t: f64| ((uw * t - ua) / uu).clamp(0.0, 1.0);
    let (s, t) = if determinant > 1e-12 * uu * ww {
        let s = ((uw * wa - ww * ua) / determinant).clamp(0.0, 1.0);
        let t = on_second(s);
        (on_first(t), t)
    } else {
        // Parallel members: the middle of their overlap.
        let ends = [on_first(0.0), on_first(1.0)];
        let s = 0.5 * (ends[0] + ends[1]);
        (s, on_second(s))
    };
    let place = |ends: [Vector3<T>; 2], share: f64| {
        let share = ends[0].x.constant(share);
        ends[0] + (ends[1] - ends[0]) * share
    };
    (place(first, s) - place(second, t)).norm()
}

impl Stud {
    fn designed<T: Scalar>(self, at: &Configuration<T>) -> Vector3<T> {
        match self {
            Stud::Between(from, to) => at.designed(to) - at.designed(from),
            Stud::Along(direction) => at.pose.origin.constant(direction),
        }
    }

    fn push_designed<T: Scalar>(self, gradient: Vector3<T>, seeds: &mut Seeds<'_, '_, T>) {
        if let Stud::Between(from, to) = self {
            seeds.hardpoint(to, gradient);
            seeds.hardpoint(from, -gradient);
        }
    }
}

impl Input {
    fn read<T: Scalar>(self, at: &Configuration<T>) -> Vector3<T> {
        match self {
            Input::Now(point) => at.point(point),
            Input::Designed(point) => at.designed(point),
            Input::SpinAxis => at.spin_axis(),
            Input::StudNow(stud) => at.pose.rotation.apply(stud.designed(at)),
            Input::StudDesigned(stud) => stud.designed(at),
        }
    }

    fn push<T: Scalar>(
        self,
        gradient: Vector3<T>,
        at: &Configuration<T>,
        seeds: &mut Seeds<'_, '_, T>,
    ) {
        match self {
            Input::Now(point) => seeds.point(point, gradient),
            Input::Designed(point) => seeds.hardpoint(point, gradient),
            Input::SpinAxis => seeds.spin_axis(gradient),
            Input::StudNow(stud) => {
                seeds.turn(self.read(at).cross(gradient));
                stud.push_designed(at.pose.rotation.apply_transposed(gradient), seeds);
            }
            Input::StudDesigned(stud) => stud.push_designed(gradient, seeds),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn vector(x: f64, y: f64, z: f64) -> Vector3<f64> {
        Vector3::new(x, y, z)
    }

    #[test]
    fn distances_of_segments_are_those_of_their_nearest_places() {
        let along_x = [vector(0.0, 0.0, 0.0), vector(10.0, 0.0, 0.0)];
        for (other, distance) in [
            // Cases: crossing above, beyond an end, end to end, parallel with overlap, parallel without overlap.
            ([vector(5.0, -5.0, 3.0), vector(5.0, 5.0, 3.0)], 3.0),
            ([vector(13.0, 4.0, 0.0), vector(13.0, 9.0, 0.0)], 5.0),
            ([vector(12.0, 0.0, 0.0), vector(20.0, 1.0, 0.0)], 2.0),
            ([vector(4.0, 0.0, 7.0), vector(30.0, 0.0, 7.0)], 7.0),
            ([vector(13.0, 4.0, 0.0), vector(20.0, 4.0, 0.0)], 5.0),
        ] {
            let found = between_segments(along_x, other);
            assert!((found - distance).abs() < 1e-12, "{found} {distance}");
            let swapped = between_segments(other, along_x);
            assert!((swapped - distance).abs() < 1e-12, "{swapped} {distance}");
        }
    }

    #[test]
    fn a_box_is_negative_inside_and_round_outside() {
        let measure = Measure::FromBox {
            point: PointId(0),
            middle: vector(0.0, 0.0, 0.0),
            half: vector(1.0, 2.0, 3.0),
        };
        let at = |x, y, z| {
            let mut inputs = [vector(0.0, 0.0, 0.0); MOST];
            inputs[0] = vector(x, y, z);
            measure.formula(&inputs)
        };
        assert_eq!(at(0.0, 0.0, 0.0), -1.0);
        assert_eq!(at(0.0, -1.5, 0.0), -0.5);
        assert_eq!(at(-3.0, 0.0, 0.0), 2.0);
        assert_eq!(at(4.0, 6.0, 0.0), 5.0);
    }

    /// Inside the edge of a rim, a member is farthest from the spin axis at its outer end or in the plane of that edge.
    #[test]
    fn a_member_is_inside_of_a_rim_where_its_outer_end_and_its_entry_are() {
        let mut seed = 1_u64;
        let mut off = |by: f64| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            by * (2.0 * (seed >> 11) as f64 / (1_u64 << 53) as f64 - 1.0)
        };
        for _ in 0..200 {
            let axis = vector(off(0.2), 1.0, off(0.2)).normalised();
            let centre = vector(off(9.0), 700.0, 300.0);
            let outer = centre + vector(off(150.0), -40.0 + off(30.0), off(150.0));
            let inner = outer + vector(off(200.0), -300.0 + off(250.0), off(200.0));
            let from = -80.0;
            if (outer - centre).dot(axis) < from {
                continue;
            }
            let mut inputs = [vector(0.0, 0.0, 0.0); MOST];
            inputs[..4].copy_from_slice(&[outer, inner, centre, axis]);
            let entry = Measure::FromSpinAxisAt([PointId(0); 2], from).formula(&inputs);
            let radial = |p: Vector3<f64>| (p - centre).cross(axis).norm();
            let places = (0..=2000).map(|k| outer + (inner - outer) * (f64::from(k) / 2000.0));
            let beyond = places.filter(|p| (*p - centre).dot(axis) >= from);
            let farthest = beyond.map(radial).fold(0.0, f64::max);
            let found = radial(outer).max(entry);
            // The member is sampled at steps of a few tenths of a millimetre.
            assert!(
                found >= farthest - 1e-9 && found <= farthest + 0.4,
                "{found} {farthest}"
            );
        }
    }

    /// Derivatives near a kink are those of their own side. The test passes each of these kinks at t = 0:
    ///
    /// - edge and middle of a box,
    /// - rim of the end of a tube,
    /// - change of the nearest place of a member to its end,
    /// - parallel members,
    /// - end of a member on the edge of a rim.
    #[test]
    fn derivatives_beside_kinks_are_those_of_their_side() {
        let ids = [PointId(0); 2];
        let still = vector(0.0, 0.0, 0.0);
        let (x, y, z) = (
            vector(1.0, 0.0, 0.0),
            vector(0.0, 1.0, 0.0),
            vector(0.0, 0.0, 1.0),
        );
        let cube = Measure::FromBox {
            point: PointId(0),
            middle: still,
            half: vector(2.0, 2.0, 2.0),
        };
        let tube = Measure::FromTube {
            point: PointId(0),
            middle: still,
            along: z,
            half: 3.0,
            radius: 2.0,
        };
        let clearance = Measure::Clearance([ids; 2]);
        let member = [still, x * 10.0];
        let rim = Measure::FromSpinAxisAt(ids, -80.0);
        // Each case has the measure, its vectors at t = 0, and their rates.
        let cases = [
            (&cube, vec![vector(3.0, 2.0, 0.5)], vec![y]),
            (&cube, vec![vector(1.5, 1.5, 0.2)], vec![y - x * 0.3]),
            (&tube, vec![vector(2.0, 0.0, 4.0)], vec![x + z * 0.4]),
            (
                &clearance,
                vec![
                    member[0],
                    member[1],
                    vector(10.0, -5.0, 3.0),
                    vector(10.0, 5.0, 3.0),
                ],
                vec![still, still, x, x + y * 0.1],
            ),
            (
                &clearance,
                vec![
                    member[0],
                    member[1],
                    vector(3.0, 0.0, 4.0),
                    vector(8.0, 0.0, 4.0),
                ],
                vec![still, still, z, z * -1.0],
            ),
            (
                &rim,
                vec![
                    vector(90.0, 620.0, 310.0),
                    vector(40.0, 300.0, 280.0),
                    vector(0.0, 700.0, 300.0),
                    y,
                ],
                vec![y, still, still, still],
            ),
        ];
        for (number, (measure, at, by)) in cases.into_iter().enumerate() {
            let inputs = |t: Dual<f64, 1>| {
                let mut inputs = [still.map(Dual::constant); MOST];
                for (input, (at, by)) in inputs.iter_mut().zip(at.iter().zip(&by)) {
                    *input = at.map(Dual::constant) + by.map(Dual::constant) * t;
                }
                inputs
            };
            let value = |t: f64| measure.formula(&inputs(Dual::constant(t))).value;
            let slope = |t: f64| measure.formula(&inputs(Dual::input(t, 0))).partials[0];
            let sides = [-1e-2, 1e-2].map(|t: f64| {
                let h = 1e-3;
                let rise = |k: f64| value(t + k * h) - value(t - k * h);
                let difference = (0.75 * rise(1.0) - 0.15 * rise(2.0) + rise(3.0) / 60.0) / h;
                let found = slope(t);
                assert!(
                    (found - difference).abs() < 1e-9,
                    "{number} at {t}: {found} {difference}"
                );
                found
            });
            assert!(
                (sides[0] - sides[1]).abs() > 1e-3,
                "{number} has a kink: {sides:?}"
            );
            // At the kink itself the derivative lies between both, within their change near the kink.
            let (low, high) = (sides[0].min(sides[1]), sides[0].max(sides[1]));
            assert!((low - 0.02..=high + 0.02).contains(&slope(0.0)), "{number}");
        }
    }

    #[test]
    fn the_versine_of_an_angle_is_smooth_at_none() {
        let x = vector(2.0, 0.0, 0.0);
        let turned = |angle: f64| vector(3.0 * angle.cos(), 3.0 * angle.sin(), 0.0);
        for angle in [0.0, 1e-8, 0.3, 1.5] {
            let wanted = 2.0 * (0.5_f64 * angle).sin().powi(2);
            assert!((versine(x, turned(angle)) - wanted).abs() <= 1e-15 * (1.0 + wanted));
        }
    }
}
