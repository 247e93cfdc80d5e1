//! Adds the spring, the anti-roll bar and the subframe to a system.

use super::super::definition::{LinkMember, SubframeMount};
use super::super::ground::SubframePart;
use super::super::legs::{BarFoot, BarPart, LegPoint, LegSeat};
use super::super::parts::CarrierSeat;
use super::super::point::{BarSeat, RockerSeat, Seat};
use super::super::system::{CarrierBushing, Limb};
use super::{Builder, BushingPlace, LimbPlace, LinkPlace, axes_of, bushing, rate};
use crate::compliance::ground::Holder;
use crate::model::{Arm, Body, PointId};
use crate::number::Scalar;

impl<T: Scalar> Builder<'_, T> {
    /// Adds the spring to the part on which it acts, if the spring has a law.
    pub(super) fn spring(&mut self, arms: &[Option<usize>]) {
        let (Some(spring), Some(law)) = (self.mechanism.spring, &self.compliance.spring) else {
            return;
        };
        let in_strut = self
            .system
            .limbs
            .iter()
            .any(|l| matches!(l, Limb::Mount(_)));
        if in_strut && self.mechanism.body(spring.upper) == Body::Chassis {
            return;
        }
        let law = law.clone();
        self.places.has_spring = true;
        let mut point = spring.lower;
        let rocker = match self.mechanism.body(spring.lower) {
            Body::Rocker(id) => {
                let rocker = self.mechanism.rocker(id);
                point = rocker.outer;
                self.places.rocker_rod = Some(rocker.rod);
                let member = LinkMember::RockerRod(id);
                let along = self.at(rocker.inner) - self.at(rocker.outer);
                let part = self.compliance.link(member);
                let rod = part.map(|part| [rate(&part.stiffness, along), part.preload]);
                if rod.is_some() {
                    self.place_link(member, LinkPlace::RockerRod);
                }
                Some(RockerSeat {
                    axis: [self.at(rocker.first), self.at(rocker.second)],
                    inner: self.at(rocker.inner),
                    spring: self.at(spring.lower),
                    rod,
                })
            }
            _ => None,
        };
        let seat = Seat {
            point: self.at(point),
            upper: self.at(spring.upper),
            law,
            rocker,
            is_across: false,
        };
        match self.mechanism.body(point) {
            Body::Arm(id) => {
                let arm = self.mechanism.arms[id.0];
                match arms[id.0] {
                    Some(limb) => {
                        let lever = self.at(point) - self.at(arm.outer);
                        let is_across = self.holder(arm.front) != self.holder(spring.upper);
                        let seat = Seat { is_across, ..seat };
                        if let Limb::Swinging(swinging) = &mut self.system.limbs[limb] {
                            swinging.seat = Some((lever, seat));
                        }
                    }
                    None => {
                        let is_across = self.holder(arm.front) != self.holder(spring.upper);
                        let seat = Seat { is_across, ..seat };
                        let leg = self.leg_point(&arm, point);
                        let limb = Limb::LegSeat(LegSeat { leg, seat });
                        let place = LimbPlace::Seat(Some(arm.outer));
                        self.push_limb(limb, "spring", self.holder(arm.front), place);
                    }
                }
            }
            _ => {
                let lever = self.on_carrier(point);
                let limb = Limb::CarrierSeat(CarrierSeat { lever, seat });
                let place = LimbPlace::Seat(None);
                self.push_limb(limb, "spring", self.holder(spring.upper), place);
            }
        }
    }

    fn leg_point(&self, arm: &Arm, point: PointId) -> LegPoint<T> {
        let front = self.at(arm.front);
        let axis = (self.at(arm.rear) - front).normalised();
        let radius = (self.at(arm.outer) - front).across(axis);
        let radial = radius.normalised();
        let from_axis = self.at(point) - front;
        LegPoint {
            joint: self.on_carrier(arm.outer),
            axis,
            radius,
            place: [radial.dot(from_axis), axis.cross(radial).dot(from_axis)],
        }
    }

    /// Adds the anti-roll bar, if it has a rate.
    pub(super) fn bar(&mut self, arms: &[Option<usize>]) {
        let (Some(id), Some(rate)) = (self.mechanism.anti_roll_bar(), self.of_axle.bar_rate) else {
            return;
        };
        let lever = self.mechanism.rocker(id);
        self.system.bar_on = self.holder(lever.first);
        let under = match self.mechanism.body(lever.outer) {
            Body::Rocker(id) => Some(self.mechanism.rocker(id)),
            _ => None,
        };
        let point = under.map_or(lever.outer, |rocker| rocker.outer);
        let seat = BarSeat {
            point: self.at(point),
            rocker: under.map(|rocker| {
                let seat = RockerSeat {
                    axis: [self.at(rocker.first), self.at(rocker.second)],
                    inner: self.at(rocker.inner),
                    spring: self.at(lever.outer),
                    rod: None,
                };
                (seat, self.at(lever.outer))
            }),
            axis: [self.at(lever.first), self.at(lever.second)],
            inner: self.at(lever.inner),
            rate: rate + rate,
        };
        let foot = match self.mechanism.body(point) {
            Body::Arm(id) => {
                let arm = self.mechanism.arms[id.0];
                if let Some(limb) = arms[id.0]
                    && let Limb::Swinging(swinging) = &mut self.system.limbs[limb]
                {
                    let from_joint = self.design[point.0] - self.design[arm.outer.0];
                    swinging.bar = Some((from_joint, seat));
                    return;
                }
                self.places.bar = Some(arm.outer);
                BarFoot::Leg(self.leg_point(&arm, point))
            }
            _ => BarFoot::Carrier(self.on_carrier(point)),
        };
        self.system.bar = Some(BarPart { foot, seat });
    }

    /// Adds the subframe with its mounts on the side of this wheel. Returns the locations of the mounts.
    pub(super) fn subframe(&mut self) -> Vec<BushingPlace> {
        let Some(subframe) = self.of_axle.subframe else {
            return Vec::new();
        };
        let reference = subframe.reference(self.system.like());
        let mount = |mount: &SubframeMount<T>| {
            let axes = axes_of(mount.directions());
            CarrierBushing {
                lever: mount.at - reference,
                bushing: bushing(&mount.shapes, &mount.preload, axes),
            }
        };
        let mounts: Vec<CarrierBushing<T>> = subframe.mounts.iter().map(mount).collect();
        let places = (0..mounts.len()).map(BushingPlace::Subframe).collect();
        let across = |limb: &Limb<T>| match limb {
            Limb::Swinging(arm) => arm.seat.as_ref().is_some_and(|(_, seat)| seat.is_across),
            Limb::LegSeat(leg) => leg.seat.is_across,
            _ => false,
        };
        let is_across = self.system.limbs.iter().any(across);
        let upper = self.mechanism.spring.filter(|_| is_across);
        self.system.subframe = Some(SubframePart {
            to_carrier: self.reference - reference,
            mounts,
            upper: upper.map(|spring| self.at(spring.upper) - reference),
        });
        let on_rack = |id: &&PointId| self.is_on_rack(**id);
        if subframe.carries.iter().any(|id| on_rack(&id)) {
            self.system.holders.rack = Holder::Subframe;
        }
        places
    }
}
