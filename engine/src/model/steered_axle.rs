//! Steering of a solid axle: a drag link turns the left knuckle about its kingpin, and a tie rod transmits this rotation to the
//! right knuckle.
//!
//! Each knuckle is a rocker of the axle (see `mechanism/rocker.rs`). The rod of the left knuckle is the drag link, from the
//! steering gear to the knuckle. The rod of the right knuckle is the tie rod, from the left to the right knuckle. Wheel centre
//! and spin axis are on the knuckle. So the pose of the axle stays the only unknown of the closure equations. Both steering
//! angles follow from this pose by equation (3) of `mechanism/rocker.rs`, the left one first.
//!
//! # The steering gear
//!
//! The steering gear has moved the drag link's end by the displacement s along the unit vector d. If p is the hardpoint of this
//! end, the end is at
//!
//! ```text
//! p' = p + s d                                                                                 (1)
//! ```
//!
//! The design contains p' as a separate point, so s is not an input of the mechanism. In `mechanism/rocker.rs`, p' is
//! the present position o' of the rod's outer end, and p its position o in the design. Let g be the gradient of a
//! number y with respect to p', as the adjoint of the closure equations gives it for every point. Then
//!
//! ```text
//! dy/ds = g.d                                                                                  (2)
//! dy/dp = g + the gradient with respect to p at fixed p', because p' moves with p                           (3)
//! ```
//!
//! # Travels
//!
//! Steering lifts or lowers the wheel centres even while the axle rests. Let w_n and w_f be the hardpoints of the near and
//! the far wheel centre. c_n and c_f are the positions of both centres after the knuckles have turned, with the axle at
//! rest. The closure equations count the travels from c_n and c_f. They compute both positions from p' for each new design;
//! designs do not store them. The mean and the difference are the two travels of `rigid_axle.rs`:
//!
//! ```text
//! mean of the equations        = mean travel - (c_n.z - w_n.z + c_f.z - w_f.z)/2               (4)
//! difference of the equations  = difference of travels - (c_n.z - w_n.z - c_f.z + w_f.z)/2     (5)
//! ```
//!
//! Both travels of the equations are 0 in the design pose, for every s. So the path to a station begins in the design pose:
//! the knuckles turn first, then the axle moves. The travels of a station always follow from the heights of the wheel centres
//! above their hardpoints.
//! Derivatives with respect to hardpoints are taken at constant values of these travels.

use super::topology::{Given, Group, NO_LINK, NO_TIE_ROD, optional};
use super::{
    Body, Mechanism, Point, PointId, RigidAxle, Rocker, RockerId, Rod, SteeringAxis, rocker,
};
use crate::number::{Each, Real, Vector3};

/// Drag link, kingpins and tie rod. A study gives all points or none.
pub(super) static STEERING: Group = Group {
    what: "the steering",
    hardpoints: &[
        optional(
            "drag_link_body",
            "drag link at the steering gear on the body; actual y (not mirrored)",
        ),
        optional(
            "drag_link_knuckle",
            "drag link at the left knuckle; actual y (not mirrored)",
        ),
        optional("kingpin_upper", "upper end of the kingpin, on the axle"),
        optional("kingpin_lower", "lower end of the kingpin, on the axle"),
        optional("tie_rod_end", "tie rod at the knuckle"),
    ],
    complete: &[&[
        "drag_link_body",
        "drag_link_knuckle",
        "kingpin_upper",
        "kingpin_lower",
        "tie_rod_end",
    ]],
    beside: &[],
    distinct: &[
        (
            "kingpin_upper",
            "kingpin_lower",
            "they define the axis of the knuckle",
        ),
        ("drag_link_body", "drag_link_knuckle", NO_LINK),
        ("tie_rod_end", "right_tie_rod_end", NO_TIE_ROD),
    ],
};

/// Steering of a solid axle, as seen from the near wheel (the wheel to which the mechanism belongs).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxleSteering {
    /// Knuckle of the near wheel.
    pub near_knuckle: RockerId,
    /// Knuckle of the far wheel.
    pub far_knuckle: RockerId,
    /// End of the drag link at the steering gear, in the design position.
    pub end: PointId,
    /// Position of the drag link's end after a displacement of the steering gear: p' in equation (1) of this module.
    pub place: PointId,
    /// Unit vector along which the steering gear moves the end, in the kernel's frame of the near side.
    pub direction: Vector3<f64>,
}

impl AxleSteering {
    /// Point that a study does not give, and the hardpoint with which it coincides while the wheels are straight
    /// ahead.
    pub(super) fn follower(&self) -> [PointId; 2] {
        [self.place, self.end]
    }

    /// Moves the drag link's end from its hardpoint by equation (1) of this module.
    #[inline(always)]
    pub(crate) fn displace<T: Real>(&self, displacement: T, design: &mut [Vector3<T>]) {
        let end = design[self.end.0];
        design[self.place.0] = end + end.constant(self.direction) * displacement;
    }
}

/// Body of a hardpoint on a knuckle: the rocker `first`, which is the left knuckle. `None` for hardpoints on other bodies.
pub(super) fn body(name: &str, first: RockerId) -> Option<Body> {
    let is_on_knuckle = matches!(
        name,
        "wheel_centre" | "spindle_inner" | "tie_rod_end" | "drag_link_knuckle"
    );
    is_on_knuckle.then_some(Body::Rocker(first))
}

/// Adds the point of [`AxleSteering::follower`] and returns the steering. The far half must be complete.
pub(super) fn add(given: &mut Given, first: RockerId) -> AxleSteering {
    let second = RockerId(first.0 + 1);
    let end = given.id("drag_link_body");
    let place = PointId(given.0.len());
    given.0.push(Point {
        name: "drag_link_place".to_owned(),
        body: Body::Chassis,
    });
    given.0[end.0].body = Body::SteeringGear(place);
    AxleSteering {
        near_knuckle: first,
        far_knuckle: second,
        end,
        place,
        direction: Vector3::new(0.0, 1.0, 0.0),
    }
}

/// The knuckles as rockers, the left one first.
pub(super) fn knuckles(find: impl Fn(&str) -> PointId) -> [Rocker; 2] {
    [
        Rocker {
            rod: Rod::DragLink,
            first: find("kingpin_lower"),
            second: find("kingpin_upper"),
            inner: find("drag_link_knuckle"),
            outer: find("drag_link_body"),
        },
        Rocker {
            rod: Rod::TieRod,
            first: find("right_kingpin_lower"),
            second: find("right_kingpin_upper"),
            inner: find("right_tie_rod_end"),
            outer: find("tie_rod_end"),
        },
    ]
}

/// Adds steering to the mechanism of a solid axle.
pub(super) fn steer(mechanism: &mut Mechanism, steering: AxleSteering) {
    let id = |name: &str| {
        let found = mechanism.point(name);
        found.expect("the points of the steering are given together")
    };
    let knuckles = knuckles(id);
    let [lower, upper] = ["kingpin_lower", "kingpin_upper"].each(id);
    let first = mechanism.rockers.len();
    mechanism.rockers.extend(knuckles);
    let near = rocker::bodies(&mechanism.rockers).nth(first);
    mechanism.bodies.extend(near);
    // The wheel centre is not on the axle itself, so another point gives its position.
    mechanism.origin = lower;
    mechanism.steering_axis = Some(SteeringAxis::Through { lower, upper });
    if let Some(rigid) = &mut mechanism.rigid_axle {
        rigid.steering = Some(steering);
    }
}

impl RigidAxle {
    /// The other point of a pair: the far one of a near point, or the near one of a far point. A point that is in no pair is its
    /// own partner.
    pub(crate) fn partner(&self, id: PointId) -> PointId {
        let pair = self.pairs.iter().find(|pair| pair.contains(&id));
        pair.map_or(id, |[near, far]| if *near == id { *far } else { *near })
    }
}

impl Mechanism {
    /// The steering of a solid axle, if it is steered.
    #[inline(always)]
    pub fn axle_steering(&self) -> Option<&AxleSteering> {
        self.rigid_axle.as_ref()?.steering.as_ref()
    }

    /// Returns the mechanism of a rigid axle as seen from its other wheel. It has the same points. In a steered axle, the drag
    /// link then turns the far knuckle, and the tie rod the near one.
    pub fn from_other_wheel(&self) -> Mechanism {
        let mut turned = self.clone();
        let Some(rigid) = &mut turned.rigid_axle else {
            return turned;
        };
        let Some(steering) = &self.rigid_axle.as_ref().and_then(|rigid| rigid.steering) else {
            return turned;
        };
        let own = rigid.clone();
        let (first, second) = (steering.near_knuckle, steering.far_knuckle);
        rigid.steering = Some(AxleSteering {
            near_knuckle: second,
            far_knuckle: first,
            direction: super::mirrored(steering.direction),
            ..*steering
        });
        for rocker in [first, second] {
            let rocker = &mut turned.rockers[rocker.0];
            for id in [
                &mut rocker.first,
                &mut rocker.second,
                &mut rocker.inner,
                &mut rocker.outer,
            ] {
                *id = own.partner(*id);
            }
        }
        for (number, point) in turned.points.iter_mut().enumerate() {
            // Near and far points are exchanged. The drag link's end is single and stays on the first knuckle.
            let is_single = own.singles.contains(&PointId(number));
            point.body = match point.body {
                Body::Rocker(id) if id == first && !is_single => Body::Rocker(second),
                Body::Rocker(id) if id == second => Body::Rocker(first),
                body => body,
            };
        }
        for (_, body) in &mut turned.bodies {
            if *body == Body::Rocker(first) {
                *body = Body::Rocker(second);
            }
        }
        turned
    }
}
