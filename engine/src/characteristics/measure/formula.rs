//! Formulas of the geometric measures as functions of vectors.

use super::{Across, Measure, Vectors};
use crate::number::{Each, Scalar, Vector3, array_of};

impl Measure {
    /// Evaluates the formula for the vectors that `Measure::inputs` lists.
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
                outside(&array_of::<T, 3>(|i| {
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
            Measure::FromSpinAxisAt(_, offset) => from_spin_axis_at(v, *offset),
            Measure::OuterShaftJoint(_) => versine(v[1] - v[0], v[2]),
            Measure::InnerShaftJoint(_) => {
                let shaft = v[1] - v[0];
                versine(shaft, shaft.constant(Vector3::new(0.0, 1.0, 0.0)))
            }
            Measure::Plunge(_) => (v[1] - v[0]).norm() - (v[3] - v[2]).norm(),
            Measure::Clearance(_) => between_segments([v[0], v[1]], [v[2], v[3]]),
            Measure::BallJoint { .. } => of_ball_joint(v),
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
            Measure::OffLine(_, Across { axis, is_second }) => {
                let along = (v[1] - v[0]).normalised();
                let mut unit = [0.0; 3];
                unit[*axis] = 1.0;
                let first = along.constant(Vector3::from(unit)).cross(along);
                let across = if *is_second {
                    along.cross(first)
                } else {
                    first
                };
                across.normalised().dot(v[2] - v[0])
            }
        }
    }
}

/// Versine of the angle between the stud of a ball joint and its design direction, which rotates with the arm.
#[inline]
fn of_ball_joint<T: Scalar>(v: &Vectors<T>) -> T {
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

/// Distance from the spin axis at which a member crosses the plane `offset` outboard of the wheel centre. If it does
/// not cross the plane, the result is the distance of its end nearer to the plane.
#[inline]
fn from_spin_axis_at<T: Scalar>(v: &Vectors<T>, offset: f64) -> T {
    let [outer, inner, centre, axis, ..] = *v;
    let beyond = (outer - centre).dot(axis) - centre.x.constant(offset);
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

/// Versine: 1 minus the cosine of the angle between two directions. The formula has no kink at zero angle, and no
/// cancellation.
#[inline]
pub(super) fn versine<T: Scalar>(a: Vector3<T>, b: Vector3<T>) -> T {
    (a.normalised() - b.normalised()).norm_squared().scaled(0.5)
}

/// Length |v|. At v = 0 its derivative is 0, the mean over all directions.
#[inline]
fn length<T: Scalar>(v: Vector3<T>) -> T {
    let square = v.norm_squared();
    if square.value() == 0.0 {
        square
    } else {
        square.sqrt()
    }
}

/// Absolute value |x|. Its derivative is the sign of x.
#[inline]
fn magnitude<T: Scalar>(x: T) -> T {
    if x.value() < 0.0 { -x } else { x }
}

/// Distance of a point from a region, for example a box. The point is inside if all entries of `excess` are negative.
/// Then the result is the largest entry, which is negative. Outside, the result is the norm of the positive entries.
#[inline]
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

/// Distance of two segments. Their nearest points move with the ends, so derivatives of any order are exact. At these points
/// the distance is smallest. So, to first order, a shift of the points along the segments does not change the distance.
pub(super) fn between_segments<T: Scalar>(first: [Vector3<T>; 2], second: [Vector3<T>; 2]) -> T {
    let (p, q) = (first[0], second[0]);
    let (u, w) = (first[1] - p, second[1] - q);
    let (uu, ww, uw) = (u.dot(u), w.dot(w), u.dot(w));
    let apart = p - q;
    let (ua, wa) = (u.dot(apart), w.dot(apart));
    let determinant = uu * ww - uw * uw;
    let on_second = |s: T| on_segment((uw * s + wa) / ww);
    let on_first = |t: T| on_segment((uw * t - ua) / uu);
    let (s, t) = if determinant.value() > 1e-12 * uu.value() * ww.value() {
        let s = on_segment((uw * wa - ww * ua) / determinant);
        let t = on_second(s);
        (on_first(t), t)
    } else {
        // For parallel members, take the middle of their overlap.
        let ends = [uu.zero(), uu.one()].each(on_first);
        let s = (ends[0] + ends[1]).scaled(0.5);
        (s, on_second(s))
    };
    let place = |ends: [Vector3<T>; 2], share: T| ends[0] + (ends[1] - ends[0]) * share;
    (place(first, s) - place(second, t)).norm()
}

/// Limits a fraction of a segment's length to the range from 0 to 1.
#[inline]
fn on_segment<T: Scalar>(share: T) -> T {
    let value = share.value();
    if value > 0.0 && value < 1.0 {
        share
    } else {
        share.constant(value.clamp(0.0, 1.0))
    }
}
