//! A pose of a linkage in lanes: its rates, steering axis and adjoint.

use super::super::{
    AdjointConstants, AdjointPose, KnuckleVector, LaneAdjoint, LanePose, LaneRates,
};
use super::LinkageDesign;
use super::linear::{Linear, Linearising};
use crate::derive::Gradient;
use crate::derive::sensitivity::HardpointGradient;
use crate::derive::steering::screw_axis;
use crate::mechanism::{Closure, Configuration, Driver, RowSet, Twist, Wrench};
use crate::number::{Jet, Real, SimdReal, Vector3};
use std::cell::{Cell, Ref, RefCell};

/// Smallest squared rotation of the knuckle for a rack displacement equal to the mechanism's size. Below it, the axis
/// of this rotation is not accurate enough to be the steering axis.
const LEAST_STEERING: f64 = 0.25;
/// Smallest squared sine of the angle between the steering axis and the horizontal. For a nearly horizontal axis, caster
/// and kingpin inclination are not accurate.
const LEAST_UPRIGHT: f64 = 0.04;
/// Upper bound on the square of the knuckle's rotation for a travel equal to the mechanism's size.
const FASTEST_TURN: f64 = 100.0;

/// Macro for those methods of [`LanePose`] that need only the configuration `at` of a pose.
macro_rules! from_configuration {
    ($number:ident) => {
        #[inline(always)]
        fn vector(&self, vector: &KnuckleVector<$number>) -> Vector3<$number> {
            self.at.pose.rotation.apply(vector.designed())
        }

        #[inline(always)]
        fn origin(&self) -> Vector3<$number> {
            self.at.pose.origin
        }

        #[inline(always)]
        fn configuration(&self, _: $number) -> Configuration<'_, $number> {
            self.at
        }
    };
}
pub(super) use from_configuration;

/// A pose of a linkage.
pub(crate) struct LinkagePose<'p, 'd, B> {
    pub(super) linkage: &'p LinkageDesign<'d, B>,
    pub(super) at: Configuration<'d, B>,
    pub(super) travel: B,
    /// Storage for the equations linearised about the pose. `is_linear` is true once they are computed.
    pub(super) linear: &'p RefCell<Linear<B>>,
    pub(super) is_linear: Cell<bool>,
}

impl<B: SimdReal> LinkagePose<'_, '_, B> {
    /// Equations linearised about the pose, computed at the first request.
    #[inline(always)]
    fn linear(&self) -> Ref<'_, Linear<B>> {
        if !self.is_linear.replace(true) {
            self.travel.outlined(Linearising {
                linkage: self.linkage,
                at: &self.at,
                travel: self.travel,
                linear: &mut self.linear.borrow_mut(),
            });
        }
        self.linear.borrow()
    }
}

impl<B: SimdReal> LanePose<B> for LinkagePose<'_, '_, B> {
    from_configuration!(B);

    #[inline(always)]
    fn steering_axis(&self) -> (Vector3<B>, Vector3<B>, B::Mask) {
        let linear = self.linear();
        let steering = linear.steering();
        let (point, direction) = screw_axis(self.at.pose.origin, &steering);
        let (turn, square) = (steering.turn, steering.turn.norm_squared());
        let is_known = linear.blocks.per_size(LEAST_STEERING).less(square)
            & (square * turn.z.constant(LEAST_UPRIGHT)).less(turn.z * turn.z);
        (point, direction, is_known)
    }

    #[inline(always)]
    fn rates(&self) -> LaneRates<B> {
        LaneRates::of(self.linear().by_travel())
    }

    #[inline(always)]
    fn by_rack(&self, _: &LaneRates<B>) -> Twist<B> {
        self.linear().steering()
    }

    #[inline(always)]
    fn velocity_is_reliable(&self, rates: &LaneRates<B>) -> B::Mask {
        let fastest = self.linear().blocks.per_size(FASTEST_TURN);
        rates.turn.norm_squared().less(fastest)
    }

    #[inline(always)]
    fn steering_axis_rates(&self, rates: &LaneRates<B>) -> (Vector3<B>, Vector3<B>) {
        let linear = self.linear();
        let by_rack = linear.steering();
        let motion = Twist {
            shift: rates.origin,
            turn: rates.turn,
        };
        let slopes = self.linkage.closure.wrench_rates(&self.at, &motion);
        let mut right = [self.travel.zero(); 6];
        for k in 0..6 {
            let Wrench {
                force,
                moment,
                rack,
            } = slopes[k];
            right[k] = -(rack + force.dot(by_rack.shift) + moment.dot(by_rack.turn));
        }
        let rate = linear.blocks.solve(right);
        let moving = Twist {
            shift: by_rack.shift.with_rate(rate.shift),
            turn: by_rack.turn.with_rate(rate.turn),
        };
        let (point, direction) = screw_axis(self.at.pose.origin.with_rate(rates.origin), &moving);
        (slope(point), slope(direction))
    }
}

impl<B: SimdReal> AdjointPose<B> for LinkagePose<'_, '_, B> {
    #[inline(always)]
    fn adjoint<'p>(
        &'p self,
        _: &'p AdjointConstants<B>,
        at: &'p Configuration<'p, B>,
        _: &LaneRates<B>,
    ) -> impl LaneAdjoint<B> + 'p {
        LinkageAdjoint {
            closure: &self.linkage.closure,
            at,
            travel: self.travel,
            linear: self.linear(),
        }
    }
}

/// The first derivatives of a vector of Taylor series.
#[inline(always)]
fn slope<B: Real>(vector: Vector3<Jet<B, 2>>) -> Vector3<B> {
    Vector3::new(vector.x[1], vector.y[1], vector.z[1])
}

/// Computes gradients from the closure equations in a pose.
struct LinkageAdjoint<'p, B> {
    closure: &'p Closure<B>,
    at: &'p Configuration<'p, B>,
    travel: B,
    linear: Ref<'p, Linear<B>>,
}

impl<B: SimdReal> LaneAdjoint<B> for LinkageAdjoint<'_, B> {
    #[inline(always)]
    fn subtract(&self, wrench: &Wrench<B>, gradient: &mut (impl Gradient<B> + ?Sized)) {
        let mut multipliers = self.linear.blocks.solve_transposed(wrench);
        for multiplier in &mut multipliers {
            *multiplier = -*multiplier;
        }
        let driver = Driver::Travel(self.travel);
        let mut sink = HardpointGradient(gradient);
        self.closure
            .differential_inlined(RowSet::ALL, self.at, driver, &multipliers, &mut sink);
    }
}
