//! Both wheels of an axle: roll on a plane ground, steering and springs.
//!
//! An independent axle has two corners at travels z_l and z_r and racks r and -r, each in the kernel's frame of a left
//! wheel. Each corner is solved like a single wheel, with one difference: its contact point depends on the ground's
//! normal instead of the vertical. The signs of both wheels follow ISO 8855. `steer` and `mean_steer` are
//! positive to the left. Roll is positive about +x.

mod adjoint;
mod at_load;
mod axle_motion;
mod carriers;
mod catalogue;
mod certificate;
mod column;
mod coordinate;
mod curves;
mod elastic;
mod expanded;
mod force_ends;
mod formulas;
mod frames;
mod lanes;
mod limits;
mod moving;
mod places;
mod reading;
mod rocker_springs;
mod series;
mod setup;
mod solver;
mod spring;
mod state;
mod taylor;
mod wheel_curve;

pub use crate::mechanism::Ground;
pub use axle_motion::{AxleMotion, AxleTime, Combine, WheelMotion};
pub use carriers::Carriers;
pub use catalogue::{AxleQuantity, Quantity, WheelQuantity};
pub use certificate::{AxleCertifier, AxleProof};
pub use column::{AxleColumn, Of};
pub use coordinate::Coordinate;
pub use curves::{AxleCurves, AxlePlan, axle_curves};
pub(crate) use elastic::{AxleRead, Equilibria};
pub use elastic::{TestFigure, not_in_equilibrium};
pub(crate) use expanded::{Expandable, ExpandedWheel};
pub use force_ends::{BeyondCurve, ForcePart, Pull};
pub(crate) use formulas::rigid::{FROM_DESIGN, place_of};
pub use frames::{axle_frames, axle_sides};
pub use lanes::LaneWheel;
pub use limits::{AxleEnd, AxleLimits, TravelRanges};
pub use moving::Moving;
pub use reading::{Parts, Reading, Snapshot, WheelParts};
pub use rocker_springs::{Preloaded, RockerForces, RockerMotion, RockerSprings};
pub(crate) use series::{ByGear, DesignedWheel, Series, SeriesPosition};
pub use setup::Setup;
pub(crate) use solver::displace;
pub use solver::{AxlePose, AxleSolver, Placement, Read, WheelRead};
pub use spring::{BumpStop, ForceCurve, Law, SpringLaw, Stop};
pub use state::{AxleState, Hold, Motion, WheelState};
pub use taylor::{Line, Taylor};
pub(crate) use wheel_curve::{
    CurveLanes, CurveWheel, LANES as CURVE_LANES, LaneCurveWheel, WheelCurve,
};

use crate::ask::Need;
use crate::characteristics::Slot;
use crate::mechanism::DesignFault;
use crate::model::{Frame, RockerId, Side, Suspension};
use crate::number::Vector3;
use crate::study::AxleComplianceStudy;

/// An axle with two wheels, its set-up and its elastic parts.
#[derive(Clone, Debug, PartialEq)]
pub struct Axle {
    /// Left wheel.
    pub left: Suspension,
    /// Right wheel in the kernel's frame, described like a left wheel. `None` if it is the mirror image of the left
    /// wheel. For a rigid axle, the axle as seen from its right wheel; `None` if the axle is symmetric.
    pub right: Option<Suspension>,
    /// Further inputs of the study: steering, springs, masses.
    pub setup: Setup,
    /// Elastic parts and their tests, if the study has elastic parts.
    pub elastic: Option<Box<AxleComplianceStudy>>,
}

/// Kinds of axles. The available quantities depend on the kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxleKind {
    /// Each wheel has its own suspension.
    Independent,
    /// One body carries both wheels.
    Solid,
    /// One body carries both wheels, and a drag link steers them.
    SteeredSolid,
    /// Twist beam: two halves that twist relative to each other.
    TwistBeam,
}

impl Axle {
    /// Suspension of a side, in the kernel's frame of that side.
    pub fn suspension(&self, side: Side) -> &Suspension {
        match (side, &self.right) {
            (Side::Right, Some(right)) => right,
            _ => &self.left,
        }
    }

    /// Mean position of both wheel centres, each in the frame of its side. The y of this position is half the distance
    /// between the wheel centres.
    pub(crate) fn mean_wheel_centre(&self) -> Vector3<f64> {
        let centre = |side: Side| {
            let wheel = self.suspension(side);
            wheel.design[wheel.mechanism.wheel_centre.0]
        };
        (centre(Side::Left) + centre(Side::Right)) * 0.5
    }

    /// Returns the right wheel if it has independent hardpoints. `None` if it is a mirror image, or if one mechanism
    /// carries both wheels.
    pub fn own_right(&self) -> Option<&Suspension> {
        self.right.as_ref().filter(|_| !self.is_rigid())
    }

    /// Returns true if one mechanism carries both wheels: for a solid axle and a twist beam.
    pub fn is_rigid(&self) -> bool {
        self.left.mechanism.rigid_axle.is_some()
    }

    /// Returns true if a rack or a drag link steers the wheels.
    pub(crate) fn has_steering_gear(&self) -> bool {
        !self.is_rigid() || self.left.mechanism.axle_steering().is_some()
    }

    /// Kind of this axle.
    pub fn kind(&self) -> AxleKind {
        match &self.left.mechanism.rigid_axle {
            None => AxleKind::Independent,
            Some(rigid) if rigid.twist_beam.is_some() => AxleKind::TwistBeam,
            Some(rigid) if rigid.steering.is_some() => AxleKind::SteeredSolid,
            Some(_) => AxleKind::Solid,
        }
    }

    /// Converts derivatives with respect to every point of both sides. The result is the derivative with respect to the
    /// displacement of a steered axle's steering gear, by equation (2) of `model/steered_axle.rs`. `None` for other
    /// axles.
    pub(crate) fn by_steering_gear(&self, gradients: [&[Vector3<f64>]; 2]) -> Option<f64> {
        let along = |(side, gradient): (Side, &[Vector3<f64>])| {
            let steering = self.suspension(side).mechanism.axle_steering()?;
            Some(gradient[steering.place.0].dot(steering.direction))
        };
        Side::ALL.into_iter().zip(gradients).map(along).sum()
    }

    /// Returns the reason why the design of a wheel cannot be solved, in words with the names of the points.
    pub fn describe_fault(&self, (side, fault): (Side, DesignFault)) -> String {
        let words = fault.describe(&self.suspension(side).mechanism);
        match fault {
            // If one wheel is the reason for an elastic fault, the description already names this wheel.
            DesignFault::Elastic(_) => words,
            _ => side.about(&words),
        }
    }

    /// Returns the transformation between the study's axes and the kernel's frame of a side.
    pub fn frame(&self, side: Side) -> Frame {
        match side {
            Side::Left => self.left.frame,
            Side::Right => self.left.frame.of_other_side(),
        }
    }

    /// Returns the points of a right wheel with independent hardpoints, after the points of the left wheel have moved
    /// to `left`. Each right point moves by the same displacement as the corresponding left point. A point that is a
    /// mirror image stays an exact mirror image. For a rigid axle, returns the axle as seen from its right wheel. `None` if
    /// [`Axle::right`] is `None`.
    pub fn right_design(
        &self,
        left: &[Vector3<f64>],
    ) -> Option<impl Iterator<Item = Vector3<f64>>> {
        let own = self.right.as_ref()?.design.iter();
        let ways = self.left.design.iter().zip(left);
        let whole = self.left.mechanism.rigid_axle.as_ref().map(|rigid| {
            let mut whole = left.to_vec();
            rigid.complete(&self.left.design, &mut whole);
            let mut right = whole.clone();
            rigid.turn_over(&whole, &mut right);
            right
        });
        Some(
            own.zip(ways)
                .enumerate()
                .map(move |(number, (own, (before, now)))| match &whole {
                    Some(right) => right[number],
                    None if own == before => *now,
                    None => *own + (*now - *before),
                }),
        )
    }

    /// Completes the design of a rigid axle after points of its left half have moved. `left` contains the points of
    /// both halves. The right half moves by the mirror image of the displacement. Points that the study does not give
    /// are computed again. Designs of independent wheels do not change.
    pub fn complete(&self, left: &mut [Vector3<f64>]) {
        let Some(rigid) = &self.left.mechanism.rigid_axle else {
            return;
        };
        rigid.complete(&self.left.design, left);
        if let Some(beam) = &rigid.twist_beam {
            for (point, place) in beam.further_points(left) {
                left[point.0] = place;
            }
        }
    }

    /// Returns the axle with other wheels of the same topology at rest. The springs are the same physical parts as in
    /// this axle. So if the new design makes a spring shorter, the force of the spring increases. Springs among the
    /// elastic parts keep their force in the design position.
    pub fn with_wheels(&self, left: Suspension, right: Option<Suspension>) -> Axle {
        let mut changed = self.clone();
        changed.setup.springs = self.kept_springs();
        (changed.left, changed.right) = (left, right);
        if let Some(law) = &mut changed.setup.rocker_springs.heave_spring {
            let before = self.design_heave_spring();
            let now = Axle::heave_spring_between(&changed.left, changed.right.as_ref());
            let shortened = before.zip(now).map_or(0.0, |(before, now)| before - now);
            law.load += law.rate * shortened;
        }
        changed
    }

    /// Returns the axle with springs that keep their force-length curve if the design changes. This includes springs
    /// among the elastic parts.
    pub fn with_kept_springs(&self) -> Axle {
        let mut kept = self.clone();
        kept.setup.springs = self.kept_springs();
        if let (Some(elastic), Some(laws)) = (&mut kept.elastic, &kept.setup.springs) {
            for (wheel, law) in elastic.parts.wheels.iter_mut().zip(laws) {
                wheel.spring = Some(law.clone());
            }
        }
        kept
    }

    /// Returns the laws of springs that keep their force-length curve if the design changes.
    fn kept_springs(&self) -> Option<[SpringLaw; 2]> {
        let laws = self.setup.springs.as_ref()?;
        let kept = |side: Side| {
            let (law, wheel) = (&laws[side as usize], self.suspension(side));
            let length = wheel.spring_length(&wheel.design);
            length.map_or_else(|| law.clone(), |length| law.kept_from(length))
        };
        Some(Side::ALL.map(kept))
    }

    /// Returns true if a set-up must adjust both wheels in one calculation: one body carries both wheels, or elastic
    /// parts couple two different wheels. Otherwise the set-up adjusts each wheel separately, or both wheels alike.
    pub fn is_set_up_as_a_whole(&self) -> bool {
        let differs = |elastic: &AxleComplianceStudy| {
            let [left, right] = &elastic.parts.wheels;
            self.right.is_some() || left != right
        };
        self.is_rigid() || self.elastic.as_deref().is_some_and(differs)
    }

    /// Length of the heave spring in the design position.
    pub fn design_heave_spring(&self) -> Option<f64> {
        Axle::heave_spring_between(&self.left, self.right.as_ref())
    }

    fn heave_spring_between(left: &Suspension, right: Option<&Suspension>) -> Option<f64> {
        let end = |wheel: &Suspension| Some(wheel.design[wheel.mechanism.heave_spring()?.0]);
        let (left, right) = (end(left)?, end(right.unwrap_or(left))?);
        Some(rocker_springs::between(left, right).norm())
    }

    /// Returns true if the study contains this input.
    pub fn meets(&self, need: Need) -> bool {
        let setup = &self.setup;
        match need {
            Need::WheelRadius => setup.wheel_radius.is_some(),
            Need::Wheelbase => setup.wheelbase.is_some(),
            Need::CFactor => setup.c_factor.is_some(),
            Need::SpringForce => setup.springs.is_some(),
            Need::Springs => setup.is_sprung(),
            Need::HeaveSpring => setup.rocker_springs.heave_spring.is_some(),
            Need::TBar => setup.rocker_springs.t_bar.is_some(),
            Need::HeaveBar => setup.rocker_springs.heave_bar.is_some(),
            Need::BarRate | Need::TorsionalRate => setup.bar_rate.is_some(),
            Need::TyreRate => setup.tyre_rate.is_some(),
            Need::SprungMass => setup.sprung_mass.is_some(),
            Need::UnsprungMass => setup.unsprung_mass.is_some(),
            _ => need.met_by(&self.left),
        }
    }

    /// Returns the quantities of this axle with this name, left before right. Empty if the axle has no such quantity.
    pub fn quantities(&self, name: &str) -> Vec<Quantity> {
        let mut found = Quantity::named(name);
        found.retain(|quantity| quantity.is_of(self.kind()));
        let figures = self.figures().iter().filter(|own| own.stem() == name);
        found.extend(figures.map(|figure| Quantity::Figure(*figure)));
        found
    }

    /// Names of all quantities, without sides: first the catalogue, then the test results.
    pub fn quantity_names(&self) -> Vec<String> {
        let mut names: Vec<String> = Quantity::names().into_iter().map(str::to_owned).collect();
        for figure in self.figures() {
            let stem = figure.stem();
            if !names.contains(&stem) {
                names.push(stem);
            }
        }
        names
    }

    /// Test results of the elastic parts.
    pub fn figures(&self) -> &[TestFigure] {
        self.elastic.as_ref().map_or(&[], |own| &own.figures)
    }

    /// Returns true if the study contains all inputs of a quantity, and the quantity is available for this kind of axle. With
    /// elastic parts, it must also be available in an equilibrium.
    pub fn has(&self, quantity: Quantity) -> bool {
        let in_equilibrium =
            self.elastic.is_none() || not_in_equilibrium(quantity, self.kind(), false).is_none();
        let needs = quantity.info().needs;
        in_equilibrium && quantity.is_of(self.kind()) && needs.iter().all(|need| self.meets(*need))
    }

    /// Returns the rockers on one side whose motion changes these quantities, and the knuckles of a steered axle.
    fn rockers(&self, side: Side, quantities: &[Quantity]) -> Vec<RockerId> {
        let mechanism = &self.suspension(side).mechanism;
        let reads = |slots: &[Slot]| {
            quantities
                .iter()
                .any(|q| q.info().reads.iter().any(|s| slots.contains(s)))
        };
        let mut rockers = Vec::new();
        if reads(&[Slot::Spring, Slot::SpringLength, Slot::SpringLengthRate]) {
            let lower = mechanism.spring.map(|spring| spring.lower);
            rockers.extend(lower.and_then(|lower| mechanism.rockers_moving(lower).next()));
        }
        if reads(&[Slot::RockerAngle, Slot::HeaveSpring]) {
            rockers.extend(mechanism.spring_rocker());
        }
        if reads(&[Slot::BarAngle, Slot::BarAngleRate]) {
            rockers.extend(mechanism.anti_roll_bar());
        }
        if let Some(steering) = mechanism.axle_steering() {
            rockers.extend([steering.near_knuckle, steering.far_knuckle]);
        }
        rockers
    }

    /// Returns the rockers on one side whose motion changes this quantity of the other wheel. The load of a wheel depends on the
    /// other wheel through the anti-roll bar and the springs between the rockers. In a rigid axle, load and rate of a wheel
    /// also depend on the other wheel's spring.
    fn rockers_felt_across(&self, side: Side, quantity: Quantity) -> Vec<RockerId> {
        use WheelQuantity::{WheelLoad, WheelRate};
        match quantity {
            Quantity::Wheel(_, WheelLoad | WheelRate) if self.is_rigid() => {
                self.rockers(side, &[quantity])
            }
            Quantity::Wheel(_, WheelLoad) => {
                let mechanism = &self.suspension(side).mechanism;
                let bar = self.setup.bar_rate.and(mechanism.anti_roll_bar());
                let springs = !self.setup.rocker_springs.are_none();
                let of_springs = mechanism.spring_rocker().filter(|_| springs);
                bar.into_iter().chain(of_springs).collect()
            }
            _ => Vec::new(),
        }
    }
}
