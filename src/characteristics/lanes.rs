//! Quantities of many designs at a time, one in each lane.
//!
//! Only what is asked for is formed; which that is has been decided when the reader is made, by the [`Slot`]s of
//! the formulas. What is not read is NaN, so that a formula which reads more than it declares has no value.

use super::gains::{angle_of_gain, by_direction, by_direction_along, by_drive, is_angle};
use super::{Characteristic, Constants, Inputs, Quantity, Slot, Slots, Wheel};
use crate::derive::{DesignedSpinAxis, Gradient, Seeds};
use crate::mechanism::{Configuration, RodReach, Twist};
use crate::model::{Axis, Body, Drive, Mechanism, PointId, RockerId, Spring, SteeringAxis};
use crate::number::{Jet, MOST_LANES, Outlined, SimdReal, Vector3};
use crate::solve::{Batch, KnucklePoint, KnuckleVector, LaneDesign, LanePose};
use std::hint::black_box;

/// Reads quantities off poses in lanes.
#[derive(Clone, Debug)]
pub struct LaneReader<'a> {
    mechanism: &'a Mechanism,
    quantities: Vec<Quantity>,
    /// How each of them is evaluated.
    evaluations: Vec<Evaluation>,
    /// The points whose coordinates are read.
    points: Vec<PointId>,
    /// The rockers that what is read moves with.
    rockers: Vec<RockerId>,
    constants: Constants,
    reads: Reads,
}

/// How a quantity is evaluated.
#[derive(Clone, Copy, Debug)]
enum Evaluation {
    /// By its own formula.
    Formula(Characteristic),
    /// As the slope of this angle by the drive: driven by the travel, that is what its gain is.
    Slope(Characteristic),
    /// A coordinate of one of the points.
    Coordinate(usize, Axis),
    /// A component of the angular velocity.
    AngularVelocity(Axis),
}

/// What is read.
#[derive(Clone, Copy, Debug, Default)]
struct Reads {
    spin_axis: bool,
    centre: bool,
    steering_axis: bool,
    strut_upper: bool,
    installation: Installation,
    /// Points that the knuckle does not carry: of arms, say.
    other_points: bool,
    /// Points on rockers: their places take velocities.
    rocker_points: bool,
    rates: bool,
    /// Derivatives by the rack as well.
    by_rack: bool,
}

impl Reads {
    /// The rockers that what is read moves with, and those that turn them.
    fn rockers(&self, mechanism: &Mechanism, points: &[PointId]) -> Vec<RockerId> {
        let Installation {
            spring,
            rocker,
            anti_roll_bar,
        } = self.installation;
        let ends = spring
            .iter()
            .flat_map(|spring| [spring.upper, spring.lower]);
        let turned = [rocker, anti_roll_bar].into_iter().flatten();
        let turned: Vec<PointId> = turned.map(|id| mechanism.rocker(id).inner).collect();
        let all = ends.chain(points.iter().copied()).chain(turned);
        let mut rockers: Vec<RockerId> = all
            .flat_map(|point| mechanism.rockers_moving(point))
            .collect();
        rockers.sort_unstable_by_key(|id| id.0);
        rockers.dedup();
        rockers
    }

    fn of(mechanism: &Mechanism, slots: Slots, points: &[PointId], rates: bool) -> Self {
        let stands_on = |is: fn(Body) -> bool| points.iter().any(|id| is(mechanism.body(*id)));
        Reads {
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
            other_points: stands_on(|body| body != Body::Knuckle),
            rocker_points: stands_on(|body| matches!(body, Body::Rocker(_))),
            rates,
            by_rack: false,
        }
    }

    /// Whether poses in lanes tell all of it.
    fn are_known(&self, mechanism: &Mechanism, batch: &Batch<'_>) -> bool {
        (!self.steering_axis || batch.steers_about(mechanism.steering_axis))
            && mechanism
                .strut_upper()
                .is_none_or(|id| !self.strut_upper || mechanism.body(id) == Body::Knuckle)
    }
}

/// What is read of spring, rockers and anti-roll bar.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Installation {
    spring: Option<Spring>,
    rocker: Option<RockerId>,
    anti_roll_bar: Option<RockerId>,
}

/// What has been read of poses in lanes.
#[derive(Clone, Debug)]
pub struct LaneInputs<B> {
    inputs: Inputs<B>,
    /// Where the points are, and their velocities.
    points: Vec<[Vector3<B>; 2]>,
    /// Velocity of the wheel centre and angular velocity by the rack, the travel held.
    by_rack: [Vector3<B>; 2],
    /// Where the rods of the rockers were at the first station, and at the last.
    rods: Vec<[RodReach<B>; 2]>,
    /// Whether there has been one with the rack in its place.
    has_begun: bool,
}

impl<B> LaneInputs<B> {
    /// Makes ready for the stations with the rack in another place, outward from the design position.
    #[inline(always)]
    pub fn begin(&mut self) {
        self.has_begun = false;
    }

    /// What formulas read.
    #[inline(always)]
    pub fn inputs(&self) -> &Inputs<B> {
        &self.inputs
    }

    /// Velocity of the wheel centre and angular velocity by the rack, the travel held; NaN where it was not asked for.
    #[inline(always)]
    pub fn by_rack(&self) -> &[Vector3<B>; 2] {
        &self.by_rack
    }
}

/// The designs whose characteristics are read.
pub struct LaneWheels<B: SimdReal> {
    spin_axis: KnuckleVector<B>,
    designed_spin_axis: DesignedSpinAxis<B>,
    centre: KnucklePoint<B>,
    strut_upper: Option<KnucklePoint<B>>,
    /// Those of the points that the knuckle carries.
    points: Vec<Option<KnucklePoint<B>>>,
    design: Wheel<B>,
}

/// The least squared leverage of a rocker. A toggle is far then, and the rocker turns no more than four
/// times as fast as with all of it.
const LEAST_LEVERAGE: f64 = 0.0625;

/// The most vertical a spin axis may be, as the sine of its inclination. Beyond, the wheel all but lies on its
/// side, where neither camber nor toe can be told well.
const STEEPEST_SPIN_AXIS: f64 = 0.9;

impl<'a> LaneReader<'a> {
    /// A reader of these quantities; `None` if one of them cannot be read in lanes.
    pub fn new(
        mechanism: &'a Mechanism,
        batch: &Batch<'_>,
        constants: Constants,
        quantities: Vec<Quantity>,
    ) -> Option<Self> {
        let mut points: Vec<PointId> = Vec::new();
        let mut evaluation = |quantity: &Quantity| match *quantity {
            Quantity::Characteristic(c) => match angle_of_gain(c) {
                Some(angle) if batch.drive() == Drive::Travel => Evaluation::Slope(angle),
                _ => Evaluation::Formula(c),
            },
            Quantity::Coordinate(id, axis) => {
                let number = points.iter().position(|p| *p == id).unwrap_or_else(|| {
                    points.push(id);
                    points.len() - 1
                });
                Evaluation::Coordinate(number, axis)
            }
            Quantity::AngularVelocity(axis) => Evaluation::AngularVelocity(axis),
        };
        let evaluations: Vec<Evaluation> = quantities.iter().map(&mut evaluation).collect();
        let rates = quantities.iter().any(|q| q.rate_order() > 0);
        let slots = Slots::of(evaluations.iter().map(|evaluation| match evaluation {
            Evaluation::Formula(c) | Evaluation::Slope(c) => c.info().reads,
            Evaluation::Coordinate(..) | Evaluation::AngularVelocity(_) => &[],
        }));
        let reads = Reads::of(mechanism, slots, &points, rates);
        reads.are_known(mechanism, batch).then_some(LaneReader {
            rockers: reads.rockers(mechanism, &points),
            mechanism,
            quantities,
            evaluations,
            points,
            constants,
            reads,
        })
    }

    /// A reader of slots, with their velocities if so wanted, for formulas that are evaluated elsewhere.
    pub fn of_slots(
        mechanism: &'a Mechanism,
        batch: &Batch<'_>,
        constants: Constants,
        slots: Slots,
        rates: bool,
    ) -> Option<Self> {
        let reads = Reads::of(mechanism, slots, &[], rates);
        reads.are_known(mechanism, batch).then_some(LaneReader {
            rockers: reads.rockers(mechanism, &[]),
            mechanism,
            quantities: Vec::new(),
            evaluations: Vec::new(),
            points: Vec::new(),
            constants,
            reads,
        })
    }

    /// With the velocities by the rack; needs those by the drive, and the wheel centre.
    #[must_use]
    pub fn with_derivatives_by_rack(mut self, is_wanted: bool) -> Self {
        self.reads.by_rack = is_wanted && self.reads.rates && self.reads.centre;
        self
    }

    /// Whether poses have to be read in the order of the march: rods of rockers are watched from station to station.
    pub(crate) fn watches_rods(&self) -> bool {
        !self.rockers.is_empty()
    }

    /// The mechanism that is read.
    pub(crate) fn mechanism(&self) -> &'a Mechanism {
        self.mechanism
    }

    /// The quantities, in the order of the values.
    pub fn quantities(&self) -> &[Quantity] {
        &self.quantities
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
        let mut points = Vec::with_capacity(self.points.len());
        for id in &self.points {
            points.push(match mechanism.body(*id) {
                Body::Knuckle => Some(lanes.point(design[id.0])),
                _ => None,
            });
        }
        LaneWheels {
            points,
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
                ..Wheel::filled(centre.x.lit(f64::NAN))
            },
        }
    }

    /// Room for what is read; nothing is yet.
    #[inline(always)]
    pub fn inputs<B: SimdReal>(&self, wheels: &LaneWheels<B>) -> LaneInputs<B> {
        let unknown = wheels.design.centre.x.lit(f64::NAN);
        let nothing = Wheel::filled(unknown);
        LaneInputs {
            inputs: Inputs {
                now: nothing,
                rate: nothing,
                turn: nothing.centre,
                design: wheels.design,
                constants: self.constants,
            },
            points: vec![[nothing.centre; 2]; self.points.len()],
            by_rack: [nothing.centre; 2],
            rods: vec![[RodReach::filled(unknown); 2]; self.rockers.len()],
            has_begun: false,
        }
    }

    /// Whether the quantities read velocities.
    pub fn reads_rates(&self) -> bool {
        self.reads.rates
    }

    /// What the formulas read in a pose, the rack where it is; with `rates`, the velocities of all of it.
    /// Says which lanes are right: those where all of it is well known (the module of [`Batch`] has the list), and
    /// no rod can have come to a toggle since the station before.
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

    /// Writes the values of all quantities, from what has been read, each `stride` numbers after the one
    /// before; NaN where one is not finite.
    #[inline(always)]
    pub fn values<B: SimdReal>(&self, read: &LaneInputs<B>, to: &mut [f64], stride: usize) {
        read.inputs.turn.x.outlined(Evaluating {
            evaluations: &self.evaluations,
            read,
            to,
            stride,
        });
    }

    /// Whether the derivatives by the hardpoints can be had in lanes: not of an instantaneous steering axis, nor of what
    /// is made of velocities of springs and rockers.
    pub fn has_gradients(&self) -> bool {
        let instantaneous = self.mechanism.steering_axis == Some(SteeringAxis::Instantaneous);
        let can_be_had = |q: &Quantity| {
            let is_of_wheel = |slot: &Slot| {
                !matches!(
                    slot,
                    Slot::SpringLength
                        | Slot::SpringLengthRate
                        | Slot::Spring
                        | Slot::RockerAngle
                        | Slot::BarAngle
                        | Slot::BarAngleRate
                        | Slot::StrutUpper
                )
            };
            q.rate_order() == 0 || q.reads().iter().all(is_of_wheel)
        };
        self.quantities.iter().all(can_be_had) && !(self.reads.steering_axis && instantaneous)
    }

    /// Whether the quantity of this number is made of velocities: [`LaneReader::differentiate_rates`] is for those.
    #[inline(always)]
    pub fn is_of_rates(&self, number: usize) -> bool {
        self.quantities[number].rate_order() > 0
    }

    /// As [`LaneReader::differentiate`] of a quantity y(u, u') made of velocities, at a configuration along the travel: the
    /// gradient by the hardpoints is the derivative by the travel, the coefficient 1, of what the seeds come to.
    ///
    /// With h and g the derivatives of y by u and u', dy/dp = h.u_p + g.u_p' is that coefficient of S.u_p for the seed
    /// S = g + h e, g and h taken as constants.
    #[inline(always)]
    pub fn differentiate_rates<B: SimdReal, G: Gradient<Jet<B, 2>> + ?Sized>(
        &self,
        number: usize,
        weight: B,
        read: &LaneInputs<B>,
        at: &Configuration<'_, Jet<B, 2>>,
        seeds: &mut Seeds<'_, '_, Jet<B, 2>, G>,
    ) {
        weight.outlined(SeedingRates {
            quantity: self.quantities[number],
            weight,
            inputs: &read.inputs,
            at,
            seeds,
        });
    }

    /// Adds, times `weight`, how the quantity of this number depends on the configuration that it has been read
    /// in: of an angle to `by`, of anything else to `seeds`.
    #[inline(always)]
    pub fn differentiate<B: SimdReal, G: Gradient<B> + ?Sized>(
        &self,
        number: usize,
        weight: B,
        read: &LaneInputs<B>,
        by: &mut ByDirections<B>,
        at: &Configuration<'_, B>,
        seeds: &mut Seeds<'_, '_, B, G>,
    ) {
        match self.quantities[number] {
            Quantity::Characteristic(c) if is_angle(c) => {
                let differentiating = Differentiating {
                    characteristic: c,
                    inputs: &read.inputs,
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
            Quantity::Characteristic(c) => weight.outlined(Seeding {
                characteristic: c,
                weight,
                inputs: &read.inputs,
                at,
                seeds,
            }),
            Quantity::Coordinate(id, axis) => weight.outlined(SeedingPoint {
                id,
                axis,
                weight,
                seeds,
            }),
            // It is a velocity.
            Quantity::AngularVelocity(_) => {}
        }
    }

    /// Writes the derivatives of all quantities by the drive, as [`LaneReader::values`] does, from what has been
    /// read with its rates. NaN for what is made of velocities: it would take accelerations.
    #[inline(always)]
    pub fn slopes<B: SimdReal>(&self, read: &LaneInputs<B>, to: &mut [f64], stride: usize) {
        let inputs = &read.inputs;
        let unknown = inputs.turn.x.lit(f64::NAN);
        let mut takes_series = false;
        for (number, evaluation) in self.evaluations.iter().enumerate() {
            let slope = match (evaluation, self.quantities[number]) {
                (Evaluation::Coordinate(point, axis), _) => read.points[*point][1][*axis],
                (_, Quantity::Characteristic(c)) if is_angle(c) => {
                    let sloping = Sloping {
                        characteristic: c,
                        inputs,
                    };
                    unknown.outlined(sloping).unwrap_or(unknown)
                }
                (_, quantity) => {
                    takes_series = takes_series || quantity.rate_order() == 0;
                    unknown
                }
            };
            slope.finite().store(&mut to[number * stride..]);
        }
        if !takes_series {
            return;
        }
        // All formulas as series in one function would take the compiler too long.
        for lane in 0..B::LANES {
            let series = LaneReader::series(inputs, lane);
            for (k, quantity) in self.quantities.iter().enumerate() {
                if let Quantity::Characteristic(c) = quantity
                    && !is_angle(*c)
                {
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
        let nothing = Wheel::filled(Jet::constant(f64::NAN));
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
        read: &LaneInputs<B>,
        seeds: &mut Seeds<'_, '_, B, G>,
    ) {
        if let Some(gradient) = self.spin_axis {
            seeds.moved_spin_axis(
                &wheels.designed_spin_axis,
                read.inputs.now.spin_axis,
                gradient,
            );
        }
        if let Some(gradient) = self.steering_axis {
            seeds.steering_axis(gradient.zero(), gradient);
        }
    }
}

/// Reads the points that the knuckle does not carry.
struct Placing<'i, B: SimdReal> {
    ids: &'i [PointId],
    at: &'i Configuration<'i, B>,
    points: &'i mut [[Vector3<B>; 2]],
}

impl<B: SimdReal> Outlined for Placing<'_, B> {
    type Output = ();
    #[inline(always)]
    fn work(self) {
        for (place, id) in self.points.iter_mut().zip(self.ids) {
            if self.at.mechanism.body(*id) != Body::Knuckle {
                place[0] = self.at.place(*id);
            }
        }
    }
}

/// Reads spring, rockers, anti-roll bar and points that the knuckle does not carry, with their velocities.
struct Installing<'i, B: SimdReal> {
    installation: Installation,
    ids: &'i [PointId],
    at: &'i Configuration<'i, B>,
    motion: &'i Twist<B>,
    inputs: &'i mut Inputs<B>,
    points: &'i mut [[Vector3<B>; 2]],
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
        for (place, id) in self.points.iter_mut().zip(self.ids) {
            if at.mechanism.body(*id) != Body::Knuckle {
                let point = at.moving_point(*id, motion);
                right = right & least.less(point.leverage_squared);
                *place = [point.now, point.rate];
            }
        }
        right
    }
}

/// In a function of its own, which all that visit poses share.
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
            reader,
            wheels,
            at,
            rack,
            rates,
            into,
        } = self;
        let reads = reader.reads;
        let mut right = rack.everywhere();
        let LaneInputs {
            inputs,
            points,
            by_rack,
            rods,
            has_begun,
        } = into;
        if !rods.is_empty() {
            right = rack.outlined(Watching {
                rockers: &reader.rockers,
                at: &at.configuration(rack),
                motion: &at.rates().twist(),
                rods,
                has_begun,
            });
        }
        let now = &mut inputs.now;
        if reads.spin_axis {
            now.spin_axis = at.vector(&wheels.spin_axis);
            right = right & now.spin_axis.z.abs().less(rack.lit(STEEPEST_SPIN_AXIS));
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
        for (place, carried) in points.iter_mut().zip(&wheels.points) {
            if let Some(carried) = carried {
                place[0] = at.point(carried);
            }
        }
        let is_installed = reads.installation != Installation::default();
        if !rates && !is_installed && !reads.rocker_points {
            if reads.other_points {
                rack.outlined(Placing {
                    ids: &reader.points,
                    at: &at.configuration(rack),
                    points,
                });
            }
            return right;
        }
        let rates = at.rates();
        right = right & at.knows(&rates);
        inputs.turn = rates.turn();
        if reads.by_rack {
            let Twist { shift, turn } = at.by_rack(&rates);
            *by_rack = [shift + turn.cross(now.centre - at.origin()), turn];
        }
        if is_installed || reads.other_points {
            let installing = Installing {
                installation: reads.installation,
                ids: &reader.points,
                at: &at.configuration(rack),
                motion: &rates.twist(),
                inputs,
                points,
            };
            right = right & rack.outlined(installing);
        }
        for (place, carried) in points.iter_mut().zip(&wheels.points) {
            if carried.is_some() {
                place[1] = rates.point(at, place[0]);
            }
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
}

/// Watches the rods of rockers on their way from station to station.
struct Watching<'i, B: SimdReal> {
    rockers: &'i [RockerId],
    at: &'i Configuration<'i, B>,
    motion: &'i Twist<B>,
    rods: &'i mut [[RodReach<B>; 2]],
    has_begun: &'i mut bool,
}

impl<B: SimdReal> Outlined for Watching<'_, B> {
    type Output = B::Mask;
    #[inline(always)]
    fn work(self) -> B::Mask {
        let mut right = self.at.rack.everywhere();
        for ([first, last], id) in self.rods.iter_mut().zip(self.rockers) {
            let rod = self.at.moving_rod(*id, self.motion);
            let before = match *self.has_begun {
                // The rack has gone to its place in between.
                false => {
                    *first = rod;
                    self.at.designed_rod(*id)
                }
                // The march may have turned to the other side of where it began.
                true => rod.nearer(first, last),
            };
            right = right & before.keeps_leverage_to(&rod);
            *last = rod;
        }
        *self.has_begun = true;
        right
    }
}

/// Evaluates quantities.
struct Evaluating<'i, B> {
    evaluations: &'i [Evaluation],
    read: &'i LaneInputs<B>,
    to: &'i mut [f64],
    stride: usize,
}

impl<B: SimdReal> Outlined for Evaluating<'_, B> {
    type Output = ();
    #[inline(always)]
    fn work(self) {
        let mut first = 0;
        for evaluation in self.evaluations {
            // Else the compiler takes what does not depend on the characteristic out of the loop: the divisions
            // and roots of every formula there is, for any one of them.
            let read = black_box(self.read);
            let value = match evaluation {
                Evaluation::Formula(c) => c.evaluate(&read.inputs),
                Evaluation::Slope(angle) => by_drive(*angle, &read.inputs).expect("it is an angle"),
                Evaluation::Coordinate(point, axis) => read.points[*point][0][*axis],
                Evaluation::AngularVelocity(axis) => read.inputs.turn[*axis],
            };
            value.finite().store(&mut self.to[first..]);
            first += self.stride;
        }
    }
}

/// Seeds an adjoint with what a characteristic reads.
struct Seeding<'i, 'c, 's, 'a, B, G: ?Sized> {
    characteristic: Characteristic,
    weight: B,
    inputs: &'i Inputs<B>,
    at: &'i Configuration<'c, B>,
    seeds: &'i mut Seeds<'s, 'a, B, G>,
}

impl<B: SimdReal, G: Gradient<B> + ?Sized> Outlined for Seeding<'_, '_, '_, '_, B, G> {
    type Output = ();
    #[inline(always)]
    fn work(self) {
        let by_slot = gradient(self.characteristic, self.inputs);
        for (slot, by) in self.characteristic.info().reads.iter().zip(by_slot) {
            slot.push(by * self.weight, self.at, self.seeds);
        }
    }
}

/// Seeds an adjoint along the travel with what a quantity made of velocities reads.
struct SeedingRates<'i, 'c, 's, 'a, B, G: ?Sized> {
    quantity: Quantity,
    weight: B,
    inputs: &'i Inputs<B>,
    at: &'i Configuration<'c, Jet<B, 2>>,
    seeds: &'i mut Seeds<'s, 'a, Jet<B, 2>, G>,
}

impl<B: SimdReal, G: Gradient<Jet<B, 2>> + ?Sized> Outlined for SeedingRates<'_, '_, '_, '_, B, G> {
    type Output = ();
    #[inline(always)]
    fn work(self) {
        let zero = self.weight.zero();
        if let Quantity::Characteristic(c) = self.quantity
            && let Some(angle) = angle_of_gain(c)
            && let Some(by) = by_direction_along(angle, self.inputs)
        {
            // The slope of the angle along the travel, by which the wheel centre rises evenly.
            for slot in angle.info().reads {
                slot.push(by * Jet::constant(self.weight), self.at, self.seeds);
            }
            return;
        }
        let mut by_slot = [Vector3::new(zero, zero, zero); Slot::MOST];
        match self.quantity {
            Quantity::Characteristic(c) => by_slot = gradient(c, self.inputs),
            Quantity::AngularVelocity(axis) => by_slot[0][axis] = zero.one(),
            Quantity::Coordinate(..) => {}
        }
        for (slot, by) in self.quantity.reads().iter().zip(by_slot) {
            let by = by * self.weight;
            let rising = |v: Vector3<B>| v.zero().with_rate(v);
            if *slot == Slot::Turn {
                // dw = d(turn)' + d(turn) x w, so g.dw has the part d(turn).(w x g).
                self.seeds.turn(rising(self.inputs.turn.cross(by)));
            }
            let seed = match slot.is_rate() {
                true => by.with_rate(by.zero()),
                false => rising(by),
            };
            slot.push(seed, self.at, self.seeds);
        }
    }
}

/// The derivatives of a characteristic by the slots it reads. Lane by lane: all formulas over dual numbers in one function
/// would take the compiler too long.
#[inline(always)]
fn gradient<B: SimdReal>(c: Characteristic, inputs: &Inputs<B>) -> [Vector3<B>; Slot::MOST] {
    let mut lanes = [[[0.0; MOST_LANES]; 3]; Slot::MOST];
    for lane in 0..B::LANES {
        let gradient = c.gradient(&of_lane(inputs, lane));
        for (slot, by) in lanes.iter_mut().zip(gradient) {
            slot[0][lane] = by.x;
            slot[1][lane] = by.y;
            slot[2][lane] = by.z;
        }
    }
    let like = inputs.turn.x;
    let mut gradient = [inputs.turn; Slot::MOST];
    for (by, [x, y, z]) in gradient.iter_mut().zip(&lanes) {
        *by = Vector3::new(like.load(x), like.load(y), like.load(z));
    }
    gradient
}

/// What one lane holds.
#[inline(always)]
fn of_lane<B: SimdReal>(inputs: &Inputs<B>, lane: usize) -> Inputs<f64> {
    inputs.map(
        #[inline(always)]
        |number| {
            let mut lanes = [0.0; MOST_LANES];
            number.store(&mut lanes);
            lanes[lane]
        },
    )
}

/// Seeds an adjoint with a coordinate of a point.
struct SeedingPoint<'i, 's, 'a, B, G: ?Sized> {
    id: PointId,
    axis: Axis,
    weight: B,
    seeds: &'i mut Seeds<'s, 'a, B, G>,
}

impl<B: SimdReal, G: Gradient<B> + ?Sized> Outlined for SeedingPoint<'_, '_, '_, B, G> {
    type Output = ();
    #[inline(always)]
    fn work(self) {
        let zero = self.weight.zero();
        let mut along = Vector3::new(zero, zero, zero);
        along[self.axis] = self.weight;
        self.seeds.point(self.id, along);
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
