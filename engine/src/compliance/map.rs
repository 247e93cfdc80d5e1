//! Conversion of a system to another number type, for derivatives in a state.

use super::bushing::Bushing;
use super::floating::Floating;
use super::ground::SubframePart;
use super::law::Law;
use super::legs::{BarFoot, BarPart, LegPoint, LegSeat};
use super::loads::WheelPart;
use super::parts::{CarrierSeat, Joint, Mount, RodPart};
use super::point::{BarSeat, RockerSeat, Seat};
use super::reading::WheelFigures;
use super::swinging::{End, Swinging};
use super::system::{CarrierBushing, Limb, System};
use crate::number::{Each, Valued};

impl<T: Valued> Law<T> {
    fn map<U: Valued>(&self, f: impl Fn(T) -> U + Copy) -> Law<U> {
        self.with(self.shape.map(f), f)
    }
}

impl<T: Valued> Bushing<T> {
    fn map<U: Valued>(&self, f: impl Fn(T) -> U + Copy) -> Bushing<U> {
        Bushing {
            axes: self.axes.map(f),
            laws: self.laws.each_ref().map(|law| law.map(f)),
        }
    }
}

impl<T: Valued> Seat<T> {
    fn map<U: Valued>(&self, f: impl Fn(T) -> U + Copy) -> Seat<U> {
        Seat {
            point: self.point.map(f),
            upper: self.upper.map(f),
            law: self.law.map(f),
            rocker: self.rocker.as_ref().map(|rocker| rocker.map(f)),
            is_across: self.is_across,
        }
    }
}

impl<T: Valued> RockerSeat<T> {
    fn map<U: Valued>(&self, f: impl Fn(T) -> U + Copy) -> RockerSeat<U> {
        RockerSeat {
            axis: self.axis.each(|point| point.map(f)),
            inner: self.inner.map(f),
            spring: self.spring.map(f),
            rod: self.rod.map(|rod| rod.each(f)),
        }
    }
}

impl<T: Valued> BarSeat<T> {
    fn map<U: Valued>(&self, f: impl Fn(T) -> U + Copy) -> BarSeat<U> {
        let rocker = self.rocker.as_ref();
        BarSeat {
            point: self.point.map(f),
            rocker: rocker.map(|(rocker, link)| (rocker.map(f), link.map(f))),
            axis: self.axis.each(|point| point.map(f)),
            inner: self.inner.map(f),
            rate: f(self.rate),
        }
    }
}

impl<T: Valued> LegPoint<T> {
    fn map<U: Valued>(&self, f: impl Fn(T) -> U + Copy) -> LegPoint<U> {
        LegPoint {
            joint: self.joint.map(f),
            axis: self.axis.map(f),
            radius: self.radius.map(f),
            place: self.place.each(f),
        }
    }
}

impl<T: Valued> BarPart<T> {
    fn map<U: Valued>(&self, f: impl Fn(T) -> U + Copy) -> BarPart<U> {
        BarPart {
            foot: match &self.foot {
                BarFoot::Carrier(lever) => BarFoot::Carrier(lever.map(f)),
                BarFoot::Leg(leg) => BarFoot::Leg(leg.map(f)),
            },
            seat: self.seat.map(f),
        }
    }
}

impl<T: Valued> RodPart<T> {
    fn map<U: Valued>(&self, f: impl Fn(T) -> U + Copy) -> RodPart<U> {
        RodPart {
            joint: self.joint.map(f),
            along: self.along.map(f),
            on_rack: self.on_rack,
            elastic: self.elastic.map(|elastic| elastic.each(f)),
        }
    }
}

impl<T: Valued> Limb<T> {
    fn map<U: Valued>(&self, f: impl Fn(T) -> U + Copy) -> Limb<U> {
        match self {
            Limb::Swinging(arm) => Limb::Swinging(Swinging {
                joint: arm.joint.map(f),
                ends: arm
                    .ends
                    .iter()
                    .map(|end| End {
                        lever: end.lever.map(f),
                        on_rack: end.on_rack,
                        bushing: end.bushing.as_ref().map(|bushing| bushing.map(f)),
                        normals: end.normals.each(|normal| normal.map(f)),
                    })
                    .collect(),
                seat: arm
                    .seat
                    .as_ref()
                    .map(|(lever, seat)| (lever.map(f), seat.map(f))),
                bar: arm
                    .bar
                    .as_ref()
                    .map(|(lever, bar)| (lever.map(f), bar.map(f))),
                spin: arm.spin.map(|spin| spin.map(f)),
            }),
            Limb::Floating(link) => Limb::Floating(Floating {
                along: link.along.map(f),
                on_rack: link.on_rack,
                inner: link.inner.as_ref().map(|bushing| bushing.map(f)),
                outer: link.outer.map(f),
                joint: link.joint.map(f),
                spin: link.spin.map(f),
            }),
            Limb::Mount(mount) => Limb::Mount(Mount {
                top: mount.top.map(f),
                along: mount.along.map(f),
                spring_line: mount.spring_line.map(f),
                bushing: mount.bushing.map(f),
                spring: mount.spring.as_ref().map(|spring| spring.map(f)),
            }),
            Limb::LegSeat(own) => Limb::LegSeat(LegSeat {
                leg: own.leg.map(f),
                seat: own.seat.map(f),
            }),
            Limb::CarrierSeat(part) => Limb::CarrierSeat(CarrierSeat {
                lever: part.lever.map(f),
                seat: part.seat.map(f),
            }),
        }
    }
}

impl<T: Valued> Joint<T> {
    fn map<U: Valued>(&self, f: impl Fn(T) -> U + Copy) -> Joint<U> {
        match self {
            Joint::Rod(rod) => Joint::Rod(rod.map(f)),
            Joint::Line { normal, top } => Joint::Line {
                normal: normal.map(f),
                top: top.map(f),
            },
            Joint::Pin { lever, direction } => Joint::Pin {
                lever: lever.map(f),
                direction: direction.map(f),
            },
        }
    }
}

impl<T: Valued> System<T> {
    /// Converts the system to another number type.
    pub(super) fn map<U: Valued>(&self, f: impl Fn(T) -> U + Copy) -> System<U> {
        let bushing = |part: &CarrierBushing<T>| CarrierBushing {
            lever: part.lever.map(f),
            bushing: part.bushing.map(f),
        };
        System {
            limbs: self.limbs.iter().map(|limb| limb.map(f)).collect(),
            bushings: self.bushings.iter().map(bushing).collect(),
            rods: self.rods.iter().map(|rod| rod.map(f)).collect(),
            joints: self.joints.iter().map(|joint| joint.map(f)).collect(),
            wheel: WheelPart {
                centre: self.wheel.centre.map(f),
                spin_axis: self.wheel.spin_axis.map(f),
                radius: self.wheel.radius,
            },
            holders: self.holders.clone(),
            subframe: self.subframe.as_ref().map(|part| SubframePart {
                to_carrier: part.to_carrier.map(f),
                mounts: part.mounts.iter().map(bushing).collect(),
                upper: part.upper.map(|upper| upper.map(f)),
            }),
            bar: self.bar.as_ref().map(|bar| bar.map(f)),
            bar_on: self.bar_on,
        }
    }
}

impl<T: Copy> WheelFigures<T> {
    /// Converts the angles and positions to another number type.
    pub fn map<U: Copy>(&self, f: impl Fn(T) -> U + Copy) -> WheelFigures<U> {
        WheelFigures {
            toe: f(self.toe),
            camber: f(self.camber),
            steering: self.steering.map(|angles| angles.each(f)),
            spin: f(self.spin),
            centre: self.centre.map(f),
            contact: self.contact.map(f),
            vertical: f(self.vertical),
        }
    }
}
