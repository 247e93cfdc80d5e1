//! Reads the parts of several poses at once, one pose in each SIMD lane.

use super::{LaneInputs, LaneReader, LaneWheels};
use crate::characteristics::reading::{Moving, PoseReader};
use crate::mechanism::{Configuration, MovingBody, Twist};
use crate::model::{PointId, RockerId};
use crate::number::{Outlined, SimdReal, Vector3};
use crate::solve::{LanePose, LaneRates};

/// Smallest squared leverage of a rocker's rod in an accepted lane. The leverage is 1 if the rod is square to its lever and to the
/// rocker's axis, and 0 at a toggle. With a larger leverage than this limit, the rocker is far from its toggle. It rotates at most
/// four times as fast as with full leverage.
const LEAST_LEVERAGE: f64 = 0.0625;

/// Largest accepted inclination of a spin axis, as its sine. Beyond it the wheel nearly lies on its side, and neither camber
/// nor toe is accurate.
const STEEPEST_SPIN_AXIS: f64 = 0.9;

impl LaneReader<'_> {
    /// Reads the inputs of formulas from a pose, with their velocities if `rates` is true. Returns the accepted lanes. Every
    /// input of an accepted lane is well determined (see [`CornerTracker`](crate::solve::CornerTracker)), and no rod can
    /// have reached a toggle since the previous station.
    #[inline(always)]
    pub fn read<B: SimdReal>(
        &self,
        wheels: &LaneWheels<B>,
        at: &impl LanePose<B>,
        rack: B,
        rates: bool,
        into: &mut LaneInputs<B>,
    ) -> B::Mask {
        rack.outlined(ReadingPose {
            reader: self,
            wheels,
            at,
            rack,
            rates,
            into,
        })
    }
}

/// Task that reads a pose. It is compiled as a separate function, so that all visitors of poses share the code.
struct ReadingPose<'r, 'm, B: SimdReal, P> {
    reader: &'r LaneReader<'m>,
    wheels: &'r LaneWheels<B>,
    at: &'r P,
    rack: B,
    rates: bool,
    into: &'r mut LaneInputs<B>,
}

impl<B: SimdReal, P: LanePose<B>> Outlined for ReadingPose<'_, '_, B, P> {
    type Output = B::Mask;
    #[inline(always)]
    fn work(self) -> B::Mask {
        let ReadingPose {
            reader, wheels, at, ..
        } = self;
        let LaneInputs {
            inputs,
            points,
            by_rack,
            axle,
            rods,
        } = self.into;
        let mut accepted = self.rack.everywhere();
        let rates = if self.rates || reader.watches_rods() {
            Some(at.rates())
        } else {
            None
        };
        let configuration = if reader.reads_others || reader.of_axle {
            Some(at.configuration(self.rack))
        } else {
            None
        };
        if let Some(rates) = &rates {
            accepted = at.velocity_is_reliable(rates);
            inputs.turn = rates.turn();
            if let (true, Some(at)) = (reader.watches_rods(), &configuration) {
                accepted = accepted & rods.watch(&reader.rockers, at, &rates.twist());
            }
        }
        let carrier = match (reader.steered, &rates, &configuration) {
            (Some(knuckle), Some(rates), Some(at)) => {
                let carrier = at.moving_body(Some(knuckle), &rates.twist());
                inputs.turn = carrier.motion.turn;
                Some(carrier)
            }
            _ => None,
        };
        let mut pose = PoseInLanes {
            reader,
            wheels,
            at,
            rates: rates.as_ref(),
            configuration: configuration.as_ref(),
            carrier: carrier.as_ref(),
            accepted,
        };
        inputs.read(&mut pose, reader.mechanism, reader.slots);
        for ([now, rate], id) in points.iter_mut().zip(&reader.points) {
            pose.point(*id).put(now, rate);
        }
        let accepted = pose.accepted;
        if let (true, Some(at)) = (reader.of_axle, &configuration) {
            let [x, y, _] = at.pose.rotation.columns;
            axle.columns = [x, y];
        }
        if let (true, Some(rates)) = (reader.by_rack, &rates) {
            let motion = at.by_rack(rates);
            let Twist { shift, turn } = motion;
            *by_rack = match (reader.steered, &configuration) {
                (Some(knuckle), Some(at)) => {
                    let carrier = at.moving_body(Some(knuckle), &motion);
                    [carrier.velocity(inputs.now.centre), carrier.motion.turn]
                }
                _ => [shift + turn.cross(inputs.now.centre - at.origin()), turn],
            };
            if reader.of_axle {
                axle.turns = [rates.turn(), turn];
                axle.kingpin_by_held = shift + turn.cross(inputs.now.steering_point - at.origin());
            }
        }
        accepted
    }
}

/// Poses that are being read, one in each SIMD lane.
struct PoseInLanes<'r, 'm, 'c, B: SimdReal, P> {
    reader: &'r LaneReader<'m>,
    wheels: &'r LaneWheels<B>,
    at: &'r P,
    /// Velocities, if requested.
    rates: Option<&'r LaneRates<B>>,
    /// Configuration of the mechanism in these poses, for parts that are not on the knuckle.
    configuration: Option<&'r Configuration<'c, B>>,
    /// Knuckle that carries the wheel of a steered axle.
    carrier: Option<&'r MovingBody<B>>,
    /// Mask of the lanes in which all inputs read so far are accurate.
    accepted: B::Mask,
}

impl<B: SimdReal, P: LanePose<B>> PoseInLanes<'_, '_, '_, B, P> {
    #[inline(always)]
    fn beyond_the_knuckle(&self) -> &Configuration<'_, B> {
        match self.configuration {
            Some(configuration) => configuration,
            None => unreachable!("a part that was not requested"),
        }
    }

    /// Rejects lanes in which a rocker may be near its toggle.
    #[inline(always)]
    fn require_leverage(&mut self, squared: B) {
        self.accepted = self.accepted & squared.constant(LEAST_LEVERAGE).less(squared);
    }
}

impl<B: SimdReal, P: LanePose<B>> PoseReader<B> for PoseInLanes<'_, '_, '_, B, P> {
    #[inline(always)]
    fn spin_axis(&mut self) -> Moving<Vector3<B>> {
        let now = match self.carrier {
            None => self.at.vector(&self.wheels.spin_axis),
            Some(carrier) => {
                self.require_leverage(carrier.leverage_squared);
                let designed = self.wheels.designed_spin_axis.direction;
                carrier.place.rotation.apply(designed)
            }
        };
        self.accepted = self.accepted & now.z.abs().less(now.z.constant(STEEPEST_SPIN_AXIS));
        let mut axis = Moving::without_rate(now);
        if let Some(rates) = self.rates {
            axis.rate = Some(match self.carrier {
                None => rates.vector(now),
                Some(carrier) => carrier.motion.turn.cross(now),
            });
        }
        axis
    }

    #[inline(always)]
    fn point(&mut self, id: PointId) -> Moving<Vector3<B>> {
        if let Some(place) = self.reader.place[id.0] {
            let now = self.at.point(&self.wheels.carried[place]);
            let mut point = Moving::without_rate(now);
            if let Some(rates) = self.rates {
                point.rate = Some(rates.point(self.at, now));
            }
            return point;
        }
        let at = self.beyond_the_knuckle();
        match self.rates {
            Some(rates) => {
                let point = at.moving_point(id, &rates.twist());
                self.require_leverage(point.leverage_squared);
                Moving {
                    now: point.now,
                    rate: Some(point.rate),
                }
            }
            None => Moving::without_rate(at.point(id)),
        }
    }

    #[inline(always)]
    fn steering_axis(&mut self) -> Option<[Moving<Vector3<B>>; 2]> {
        if let Some([lower, upper]) = self.reader.kingpin {
            let point = self.point(lower);
            return Some([point, self.point(upper).minus(point)]);
        }
        let (point, along, is_known) = self.at.steering_axis();
        self.accepted = self.accepted & is_known;
        let mut axis = [Moving::without_rate(point), Moving::without_rate(along)];
        if let Some(rates) = self.rates {
            let (point, along) = self.at.steering_axis_rates(rates);
            (axis[0].rate, axis[1].rate) = (Some(point), Some(along));
        }
        Some(axis)
    }

    #[inline(always)]
    fn rocker_angle(&mut self, id: RockerId) -> Moving<B> {
        let (at, Some(rates)) = (self.beyond_the_knuckle(), self.rates) else {
            unreachable!("rockers need velocities")
        };
        let angle = at.moving_rocker(id, &rates.twist());
        self.require_leverage(angle.leverage_squared);
        Moving {
            now: angle.now,
            rate: Some(angle.rate),
        }
    }
}
