//! Wheels whose nominal designs depend on the variables, with the rates at which the variables move the points.

use super::moves::{PointRate, moved_design, point_rates, sort_by_point};
use crate::model::{Frame, PointId, RigidAxle, Suspension};
use crate::number::{Dual, Vector3};
use crate::study::Variable;
use nalgebra::DVector;

/// Number of variables with respect to which one pass differentiates.
pub(super) const AT_ONCE: usize = 4;

/// A number with its derivatives with respect to [`AT_ONCE`] variables.
pub(super) type ByVariables = Dual<f64, AT_ONCE>;

/// Design of a wheel, and the rates at which the variables move its points.
pub(super) type WheelMoved<'m> = (&'m [Vector3<f64>], &'m [PointRate]);

/// Nominal design of a wheel, moved by the variables of a tuning.
pub(super) struct MovedWheel<'a> {
    frame: Frame,
    /// Design of the wheel before the variables move it.
    own: &'a [Vector3<f64>],
    /// An added point and the wheel centre, with which the added point moves. The program adds this point to define the
    /// spin axis, if the carrier has no hardpoint for this axis.
    follower: Option<(PointId, PointId)>,
    /// Design of the wheel after the variables have moved it.
    pub design: Vec<Vector3<f64>>,
    /// Rates at which the variables move the points of the design.
    pub point_rates: Vec<PointRate>,
}

impl<'a> MovedWheel<'a> {
    /// Makes the wheel of a suspension. `frame` has the axes of the study.
    pub(super) fn new(suspension: &'a Suspension, frame: Frame) -> Self {
        MovedWheel {
            frame,
            own: &suspension.design,
            follower: None,
            design: suspension.design.clone(),
            point_rates: Vec::new(),
        }
    }

    /// Makes the wheel of an assembled suspension ([`crate::assembly::Assembler::suspension`]). An added point of the spin
    /// axis keeps its direction from the wheel centre when the wheel centre moves.
    pub(super) fn assembled(suspension: &'a Suspension, frame: Frame) -> Self {
        let leader = suspension.mechanism.wheel_centre;
        let follower = suspension.mechanism.moves_with(leader);
        MovedWheel {
            follower: follower.map(|follower| (follower, leader)),
            ..MovedWheel::new(suspension, frame)
        }
    }

    /// The wheel as a pair of design and rates.
    pub(super) fn moved(&self) -> WheelMoved<'_> {
        (&self.design, &self.point_rates)
    }

    /// Moves the design to the offsets `x` of the variables.
    pub(super) fn move_to(&mut self, variables: &[Variable], x: &DVector<f64>) {
        let MovedWheel {
            frame,
            own,
            follower,
            design,
            point_rates: rates,
        } = self;
        moved_design(own, frame, variables, x, design);
        point_rates(own, frame, variables, x, rates);
        if let Some((follower, leader)) = *follower {
            design[follower.0] = design[leader.0] + (own[follower.0] - own[leader.0]);
            let point = follower.0;
            let follows = rates.iter().filter(|rate| rate.point == leader.0);
            let follows: Vec<PointRate> =
                follows.map(|rate| PointRate { point, ..*rate }).collect();
            rates.extend(follows);
        }
    }

    /// Completes the design of a solid axle or twist beam after its left half has moved. The right half moves as the mirror
    /// image of the left half. `self` is the axle as seen from its left wheel, `right` the same axle as seen from the right
    /// wheel.
    pub(super) fn complete(
        &mut self,
        right: &mut MovedWheel<'a>,
        rigid: &RigidAxle,
        variables: usize,
    ) {
        let (mut whole, mut turned) = (Vec::new(), Vec::new());
        let near = std::mem::take(&mut self.point_rates);
        right.point_rates.clear();
        // Without variables, one pass is still needed to complete the designs.
        for first in (0..variables.max(1)).step_by(AT_ONCE) {
            along_variables(&self.design, &near, first, &mut whole);
            rigid.complete(self.own, &mut whole);
            turned.clone_from(&whole);
            rigid.turn_over(&whole, &mut turned);
            if let Some((follower, leader)) = right.follower {
                let apart = right.own[follower.0] - right.own[leader.0];
                turned[follower.0] = turned[leader.0] + apart.map(Dual::constant);
            }
            append_rates(&whole, first, variables, &mut self.point_rates);
            append_rates(&turned, first, variables, &mut right.point_rates);
        }
        for (wheel, duals) in [(&mut *self, whole), (right, turned)] {
            wheel.design.clear();
            wheel
                .design
                .extend(duals.iter().map(|p| p.map(|c| c.value)));
            sort_by_point(&mut wheel.point_rates);
        }
    }
}

/// Writes a design with its derivatives with respect to the variables from number `first` on into `into`.
pub(super) fn along_variables(
    design: &[Vector3<f64>],
    rates: &[PointRate],
    first: usize,
    into: &mut Vec<Vector3<ByVariables>>,
) {
    into.clear();
    into.extend(design.iter().map(|p| p.map(Dual::constant)));
    let own = first..first + AT_ONCE;
    for rate in rates.iter().filter(|rate| own.contains(&rate.column)) {
        let point = &mut into[rate.point];
        let k = rate.column - first;
        point.x.partials[k] += rate.by.x;
        point.y.partials[k] += rate.by.y;
        point.z.partials[k] += rate.by.z;
    }
}

/// Appends the rates of a design with respect to some of the `variables`, beginning with number `first`.
pub(super) fn append_rates(
    design: &[Vector3<ByVariables>],
    first: usize,
    variables: usize,
    into: &mut Vec<PointRate>,
) {
    for (point, series) in design.iter().enumerate() {
        for k in 0..AT_ONCE.min(variables - first) {
            let by = series.map(|c| c.partials[k]);
            if by.norm_squared() > 0.0 {
                let column = first + k;
                into.push(PointRate { column, point, by });
            }
        }
    }
}
