//! Characteristics of many designs at a time, one in each lane.
//!
//! Only what the formulas asked for read is formed; which that is has been decided when the reader is
//! made, by their [`Slot`]s.

use super::gains::{angle_of_gain, by_direction, by_drive, is_angle};
use super::{Characteristic, Constants, Inputs, Slot, Slots, Wheel};
use crate::derive::{DesignedSpinAxis, Gradient, Seeds};
use crate::mechanism::{Configuration, Twist};
use crate::model::{Body, Drive, Mechanism, RockerId, Spring, SteeringAxis};
use crate::number::{Jet, MOST_LANES, Outlined, SimdReal, Vector3};
use crate::solve::{Batch, KnucklePoint, KnuckleVector, LaneDesign, LanePose};
use std::hint::black_box;

/// Reads characteristics off poses in lanes.
#[derive(Clone, Debug)]
pub struct LaneReader<'a> {
    mechanism: &'a Mechanism,
    characteristics: Vec<Characteristic>,
    /// The way to the value of each of them.
    ways: Vec<Evaluation>,
    constants: Constants,
    reads: Reads,
}

/// How a characteristic is evaluated.
#[derive(Clone, Copy, Debug)]
enum Evaluation {
    /// By its own formula.
    Formula(Characteristic),
    /// As the slope of this angle by the drive: driven by the travel, that is what its gain is.
    Slope(Characteristic),
}

/// What is read.
#[derive(Clone, Copy, Debug, Default)]
struct Reads {
    spin_axis: bool,
    centre: bool,
    steering_axis: bool,
    strut_upper: bool,
    installation: Installation,
    rates: bool,
}

/// What is read of spring, rockers and anti-roll bar.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Installation {
    spring: Option<Spring>,
    rocker: Option<RockerId>,
    anti_roll_bar: Option<RockerId>,
}

/// The designs whose characteristics are read.
pub struct LaneWheels<B: SimdReal> {
    spin_axis: KnuckleVector<B>,
    designed_spin_axis: DesignedSpinAxis<B>,
    centre: KnucklePoint<B>,
    strut_upper: Option<KnucklePoint<B>>,
    design: Wheel<B>,
}

/// The least squared leverage of a rocker. A toggle is far then, and the rocker turns no more than four
/// times as fast as with all of it.
const LEAST_LEVERAGE: f64 = 0.0625;

/// The most vertical a spin axis may be, as the sine of its inclination. Beyond, the wheel all but lies on its
/// side, where neither camber nor toe can be told well.
const STEEPEST_SPIN_AXIS: f64 = 0.9;

impl<'a> LaneReader<'a> {
    /// A reader of these characteristics; `None` if one of them cannot be read in lanes.
    pub fn new(
        mechanism: &'a Mechanism,
        batch: &Batch<'_>,
        constants: Constants,
        characteristics: Vec<Characteristic>,
    ) -> Option<Self> {
        let way = |c: &Characteristic| match angle_of_gain(*c) {
            Some(angle) if batch.drive() == Drive::Travel => Evaluation::Slope(angle),
            _ => Evaluation::Formula(*c),
        };
        let ways: Vec<Evaluation> = characteristics.iter().map(way).collect();
        let slots = ways.iter().fold(Slots::default(), |slots, way| {
            let (Evaluation::Formula(c) | Evaluation::Slope(c)) = way;
            slots.with(c.info().reads)
        });
        let reads = Reads {
            spin_axis: slots.contain_either(Slot::SpinAxis, Slot::SpinAxisRate),
            centre: slots.contain_either(Slot::Centre, Slot::CentreRate),
            steering_axis: slots.contain_steering_axis(),
            strut_upper: slots.contains(Slot::StrutUpper),
            installation: Installation {
                spring: mechanism.spring.filter(|_| {
                    slots.contain_either(Slot::SpringLength, Slot::SpringLengthRate)
                        || slots.contains(Slot::Spring)
                }),
                rocker: mechanism
                    .spring_rocker()
                    .filter(|_| slots.contains(Slot::RockerAngle)),
                anti_roll_bar: mechanism
                    .anti_roll_bar()
                    .filter(|_| slots.contain_either(Slot::BarAngle, Slot::BarAngleRate)),
            },
            rates: characteristics.iter().any(|c| c.info().reads_rates()),
        };
        let possible = (!reads.steering_axis || batch.steers_about(mechanism.steering_axis))
            && mechanism
                .strut_upper()
                .is_none_or(|id| !reads.strut_upper || mechanism.body(id) == Body::Knuckle);
        possible.then_some(LaneReader {
            mechanism,
            characteristics,
            ways,
            constants,
            reads,
        })
    }

    /// The characteristics, in the order of the values.
    pub fn characteristics(&self) -> &[Characteristic] {
        &self.characteristics
    }

    /// What is to be read off the poses of designs, given as their points.
    #[inline(always)]
    pub fn wheels<B: SimdReal>(
        &self,
        lanes: &LaneDesign<'_, B>,
        design: &[Vector3<B>],
    ) -> LaneWheels<B> {
        let mechanism = self.mechanism;
        let centre = design[mechanism.wheel_centre.0];
        let designed_spin_axis = DesignedSpinAxis::of(mechanism, design);
        let spin_axis = designed_spin_axis.direction;
        LaneWheels {
            spin_axis: lanes.vector(spin_axis),
            designed_spin_axis,
            centre: lanes.point(centre),
            strut_upper: match mechanism.strut_upper() {
                Some(upper) if self.reads.strut_upper => Some(lanes.point(design[upper.0])),
                _ => None,
            },
            design: Wheel {
                spin_axis,
                centre,
                ..Wheel::filled(centre.x.zero())
            },
        }
    }

    /// Room for what the formulas read.
    #[inline(always)]
    pub fn inputs<B: SimdReal>(&self, wheels: &LaneWheels<B>) -> Inputs<B> {
        let zero = wheels.design.centre.zero();
        let nothing = Wheel::filled(zero.x);
        Inputs {
            now: nothing,
            rate: nothing,
            turn: zero,
            design: wheels.design,
            constants: self.constants,
        }
    }

    /// Whether the formulas read velocities.
    pub fn reads_rates(&self) -> bool {
        self.reads.rates
    }

    /// What the formulas read in a pose, the rack where it is; with `rates`, the velocities of all of it.
    /// Says which lanes are right: those where all of it is well known (the module of [`Batch`] has the list).
    #[inline(always)]
    pub fn read<B: SimdReal>(
        &self,
        wheels: &LaneWheels<B>,
        at: &impl LanePose<B>,
        rack: B,
        rates: bool,
        inputs: &mut Inputs<B>,
    ) -> B::Mask {
        let reads = self.reads;
        let mut right = rack.everywhere();
        let now = &mut inputs.now;
        if reads.spin_axis {
            now.spin_axis = at.vector(&wheels.spin_axis);
            right = now.spin_axis.z.abs().less(rack.lit(STEEPEST_SPIN_AXIS));
        }
        if reads.centre {
            now.centre = at.point(&wheels.centre);
        }
        if reads.steering_axis {
            let (point, direction, is_known) = at.steering_axis();
            (now.steering_point, now.steering_direction) = (point, direction);
            right = right & is_known;
        }
        if let (true, Some(upper)) = (reads.strut_upper, &wheels.strut_upper) {
            now.strut_upper = at.point(upper);
        }
        let is_installed = reads.installation != Installation::default();
        if !rates && !is_installed {
            return right;
        }
        let rates = at.rates();
        right = right & at.knows(&rates);
        inputs.turn = rates.turn();
        if is_installed {
            let installing = Installing {
                installation: reads.installation,
                at: &at.configuration(rack),
                motion: &rates.twist(),
                inputs,
            };
            right = right & rack.outlined(installing);
        }
        let (now, rate) = (&inputs.now, &mut inputs.rate);
        if reads.spin_axis {
            rate.spin_axis = rates.vector(now.spin_axis);
        }
        if reads.centre {
            rate.centre = rates.point(at, now.centre);
        }
        if reads.steering_axis {
            (rate.steering_point, rate.steering_direction) = at.steering_axis_rates(&rates);
        }
        if reads.strut_upper {
            rate.strut_upper = rates.point(at, now.strut_upper);
        }
        right
    }

    /// Writes the values of all characteristics, from what has been read, each `stride` numbers after the one
    /// before; NaN where one is not finite.
    #[inline(always)]
    pub fn values<B: SimdReal>(&self, inputs: &Inputs<B>, to: &mut [f64], stride: usize) {
        inputs.turn.x.outlined(Evaluating {
            ways: &self.ways,
            inputs,
            to,
            stride,
        });
    }

    /// Whether only the four angles are read.
    fn is_of_angles(&self) -> bool {
        self.characteristics.iter().all(|c| is_angle(*c))
    }

    /// Whether the derivatives by the hardpoints can be had in lanes: those of the four angles, and not of an
    /// instantaneous steering axis. (All formulas differentiated in one function would take the compiler too
    /// long.)
    pub fn has_gradients(&self) -> bool {
        let instantaneous = self.mechanism.steering_axis == Some(SteeringAxis::Instantaneous);
        self.is_of_angles() && !(self.reads.steering_axis && instantaneous)
    }

    /// Adds, times `weight`, how the angle of this number depends on what the angles read.
    #[inline(always)]
    pub fn differentiate<B: SimdReal>(
        &self,
        number: usize,
        weight: B,
        inputs: &Inputs<B>,
        by: &mut ByDirections<B>,
    ) {
        let c = self.characteristics[number];
        let differentiating = Differentiating {
            characteristic: c,
            inputs,
        };
        if let Some(gradient) = weight.outlined(differentiating) {
            let sum = match c.info().reads {
                [Slot::SpinAxis] => &mut by.spin_axis,
                _ => &mut by.steering_axis,
            };
            let before = sum.unwrap_or(gradient.zero());
            *sum = Some(before.plus_scaled(gradient, weight));
        }
    }

    /// Writes the derivatives of all characteristics by the drive, as [`LaneReader::values`] does, from what
    /// has been read with its rates. NaN for what is made of velocities: it would take accelerations.
    #[inline(always)]
    pub fn slopes<B: SimdReal>(&self, inputs: &Inputs<B>, to: &mut [f64], stride: usize) {
        let mut first = 0;
        for c in &self.characteristics {
            let sloping = Sloping {
                characteristic: *c,
                inputs,
            };
            if let Some(slope) = inputs.turn.x.outlined(sloping) {
                slope.finite().store(&mut to[first..]);
            }
            first += stride;
        }
        if self.is_of_angles() {
            return;
        }
        // All formulas as series in one function would take the compiler too long.
        for lane in 0..B::LANES {
            let series = LaneReader::series(inputs, lane);
            for (k, c) in self.characteristics.iter().enumerate() {
                if !is_angle(*c) {
                    to[k * stride + lane] = c.slope(&series).finite();
                }
            }
        }
    }

    /// The inputs of one lane as series in the drive.
    #[inline(always)]
    fn series<B: SimdReal>(inputs: &Inputs<B>, lane: usize) -> Inputs<Jet<f64, 2>> {
        let of = |number: B| {
            let mut lanes = [0.0; MOST_LANES];
            number.store(&mut lanes);
            lanes[lane]
        };
        let (now, rate) = (&inputs.now, &inputs.rate);
        let pair = |value: B, slope: B| Jet([of(value), of(slope)]);
        let pairs = |value: Vector3<B>, slope: Vector3<B>| {
            Vector3::new(
                pair(value.x, slope.x),
                pair(value.y, slope.y),
                pair(value.z, slope.z),
            )
        };
        let still = inputs.design.centre.zero();
        let nothing = Wheel::filled(Jet::constant(0.0));
        let design = Wheel {
            spin_axis: pairs(inputs.design.spin_axis, still),
            centre: pairs(inputs.design.centre, still),
            ..nothing
        };
        Inputs {
            now: Wheel {
                spin_axis: pairs(now.spin_axis, rate.spin_axis),
                centre: pairs(now.centre, rate.centre),
                steering_point: pairs(now.steering_point, rate.steering_point),
                steering_direction: pairs(now.steering_direction, rate.steering_direction),
                spring_length: pair(now.spring_length, rate.spring_length),
                spring: pairs(now.spring, rate.spring),
                strut_upper: pairs(now.strut_upper, rate.strut_upper),
                rocker_angle: pair(now.rocker_angle, rate.rocker_angle),
                bar_angle: pair(now.bar_angle, rate.bar_angle),
            },
            rate: nothing,
            turn: nothing.centre,
            design,
            constants: inputs.constants,
        }
    }
}

/// A derivative by the two directions that the angles read; none where it depends on neither.
#[derive(Clone, Copy, Debug)]
pub struct ByDirections<B> {
    spin_axis: Option<Vector3<B>>,
    steering_axis: Option<Vector3<B>>,
}

impl<B> Default for ByDirections<B> {
    fn default() -> Self {
        ByDirections {
            spin_axis: None,
            steering_axis: None,
        }
    }
}

impl<B: SimdReal> ByDirections<B> {
    /// What that makes of the configuration that the inputs have been read in.
    #[inline(always)]
    pub fn seed<G: Gradient<B> + ?Sized>(
        &self,
        wheels: &LaneWheels<B>,
        inputs: &Inputs<B>,
        seeds: &mut Seeds<'_, '_, B, G>,
    ) {
        if let Some(gradient) = self.spin_axis {
            seeds.moved_spin_axis(&wheels.designed_spin_axis, inputs.now.spin_axis, gradient);
        }
        if let Some(gradient) = self.steering_axis {
            seeds.steering_axis(gradient.zero(), gradient);
        }
    }
}

/// Reads spring, rockers and anti-roll bar with their velocities.
struct Installing<'i, B: SimdReal> {
    installation: Installation,
    at: &'i Configuration<'i, B>,
    motion: &'i Twist<B>,
    inputs: &'i mut Inputs<B>,
}

impl<B: SimdReal> Outlined for Installing<'_, B> {
    type Output = B::Mask;
    #[inline(always)]
    fn work(self) -> B::Mask {
        let (at, motion) = (self.at, self.motion);
        let (now, rate) = (&mut self.inputs.now, &mut self.inputs.rate);
        let least = at.rack.lit(LEAST_LEVERAGE);
        let mut right = at.rack.everywhere();
        if let Some(spring) = self.installation.spring {
            let upper = at.moving_point(spring.upper, motion);
            let lower = at.moving_point(spring.lower, motion);
            right = right & least.less(upper.leverage_squared) & least.less(lower.leverage_squared);
            now.spring = upper.now - lower.now;
            now.spring_length = now.spring.norm();
            rate.spring = upper.rate - lower.rate;
            rate.spring_length = now.spring.dot(rate.spring) / now.spring_length;
        }
        if let Some(rocker) = self.installation.rocker {
            let angle = at.moving_rocker(rocker, motion);
            right = right & least.less(angle.leverage_squared);
            (now.rocker_angle, rate.rocker_angle) = (angle.now, angle.rate);
        }
        if let Some(bar) = self.installation.anti_roll_bar {
            let angle = at.moving_rocker(bar, motion);
            right = right & least.less(angle.leverage_squared);
            (now.bar_angle, rate.bar_angle) = (angle.now, angle.rate);
        }
        right
    }
}

/// Evaluates characteristics.
struct Evaluating<'i, B> {
    ways: &'i [Evaluation],
    inputs: &'i Inputs<B>,
    to: &'i mut [f64],
    stride: usize,
}

impl<B: SimdReal> Outlined for Evaluating<'_, B> {
    type Output = ();
    #[inline(always)]
    fn work(self) {
        let mut first = 0;
        for way in self.ways {
            // Else the compiler takes what does not depend on the characteristic out of the loop: the divisions
            // and roots of every formula there is, for any one of them.
            let inputs = black_box(self.inputs);
            let value = match way {
                Evaluation::Formula(c) => c.evaluate(inputs),
                Evaluation::Slope(angle) => by_drive(*angle, inputs).expect("it is an angle"),
            };
            value.finite().store(&mut self.to[first..]);
            first += self.stride;
        }
    }
}

/// The derivative of an angle by the direction it reads.
struct Differentiating<'i, B> {
    characteristic: Characteristic,
    inputs: &'i Inputs<B>,
}

impl<B: SimdReal> Outlined for Differentiating<'_, B> {
    type Output = Option<Vector3<B>>;
    #[inline(always)]
    fn work(self) -> Option<Vector3<B>> {
        by_direction(self.characteristic, self.inputs)
    }
}

/// The slope of an angle.
struct Sloping<'i, B> {
    characteristic: Characteristic,
    inputs: &'i Inputs<B>,
}

impl<B: SimdReal> Outlined for Sloping<'_, B> {
    type Output = Option<B>;
    #[inline(always)]
    fn work(self) -> Option<B> {
        by_drive(self.characteristic, self.inputs)
    }
}

impl Characteristic {
    /// The slope by the drive in one lane, from inputs as series. Out of line, since there is one for each
    /// formula.
    #[inline(never)]
    fn slope(self, inputs: &Inputs<Jet<f64, 2>>) -> f64 {
        match self.info().reads_rates() {
            true => f64::NAN,
            false => self.evaluate(inputs)[1],
        }
    }
}
