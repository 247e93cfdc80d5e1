//! Quantities of several designs at a time. Each design is in one SIMD lane.
//!
//! A [`LaneReader`] computes only the inputs ([`Slot`]s) that the formulas of its quantities need. A slot that is not
//! read is NaN, so a formula that reads an undeclared slot has no value.

mod evaluating;
mod gradients;
mod pose;
mod watching;

pub use gradients::ByDirections;

use super::gains::angle_of_gain;
use super::reading::ReadSet;
use super::{Characteristic, Constants, Inputs, Quantity, Slot, Slots};
use crate::derive::DesignedSpinAxis;
use crate::model::{Axis, Body, Drive, Mechanism, PointId, RockerId, SteeringAxis};
use crate::number::{SimdReal, Vector3};
use crate::solve::{CornerTracker, KnucklePoint, KnuckleVector, LaneDesign};
use crate::sorting::sort_by_key;
use watching::ToggleWatch;

/// Reads quantities from several poses at once, one in each SIMD lane.
#[derive(Clone, Debug)]
pub struct LaneReader<'a> {
    mechanism: &'a Mechanism,
    quantities: Vec<Quantity>,
    /// Evaluation rule of each quantity.
    rules: Vec<EvaluationRule>,
    /// True for each quantity that contains velocities.
    of_rates: Vec<bool>,
    constants: Constants,
    slots: Slots,
    /// Points whose coordinates are read.
    points: Vec<PointId>,
    /// Points on the knuckle that are read (`carried`). `place[id]` is the index in `carried` of the mechanism's point
    /// `id`, or `None` if the point is not read.
    carried: Vec<PointId>,
    place: Vec<Option<usize>>,
    /// True if the reader needs a part outside the knuckle: another body's point, or a rocker.
    reads_others: bool,
    /// Rockers on which the parts that are read depend. This includes rockers that move these rockers. To check the
    /// rods of these rockers for toggles, the reader needs velocities.
    rockers: Vec<RockerId>,
    rates: bool,
    /// True if the reader also reads derivatives with respect to the rack.
    by_rack: bool,
    /// Knuckle that carries the wheel of a steered axle.
    steered: Option<RockerId>,
    /// Lower and upper end of the kingpin of a steered axle, if its steering axis is read.
    kingpin: Option<[PointId; 2]>,
    /// True if the reader also reads the body of a rigid axle.
    of_axle: bool,
}

/// Evaluation rule of a quantity.
#[derive(Clone, Copy, Debug)]
enum EvaluationRule {
    /// The quantity's own formula.
    Formula(Characteristic),
    /// Slope of this angle with respect to the drive coordinate. If the travel is the drive, this slope is the angle's
    /// gain.
    Slope(Characteristic),
    /// A coordinate of the point with this index among the points whose coordinates are read.
    Coordinate(usize, Axis),
    /// A component of the knuckle's angular velocity.
    AngularVelocity(Axis),
}

/// Body of a rigid axle, with one pose in each SIMD lane.
#[derive(Clone, Copy, Debug)]
pub struct LaneAxle<B> {
    /// Columns along x and y of the body's rotation matrix, from the design position.
    pub columns: [Vector3<B>; 2],
    /// Angular velocities with respect to two coordinates: the drive coordinate, and the travel that the drive does not
    /// change (mean travel or difference of travels).
    pub turns: [Vector3<B>; 2],
    /// Velocity of the steering axis's point with respect to the travel that the drive does not change.
    pub kingpin_by_held: Vector3<B>,
    /// True if the wheel is on a knuckle that turns in the axle.
    pub is_steered: bool,
}

/// Inputs of formulas, read from several poses at once (one in each SIMD lane).
#[derive(Clone, Debug)]
pub struct LaneInputs<B> {
    inputs: Inputs<B>,
    /// Positions and velocities of the points whose coordinates are read.
    points: Vec<[Vector3<B>; 2]>,
    /// Velocity of the wheel centre and angular velocity of the knuckle with respect to the rack, at constant travel. For a rigid
    /// axle, with respect to the travel that the drive does not change.
    by_rack: [Vector3<B>; 2],
    axle: LaneAxle<B>,
    rods: ToggleWatch<B>,
}

impl<B> LaneInputs<B> {
    /// Prepares for the stations at another rack displacement. Their order must be outward from the design position.
    #[inline(always)]
    pub fn begin(&mut self) {
        self.rods.begin();
    }

    /// Inputs of formulas.
    #[inline(always)]
    pub fn inputs(&self) -> &Inputs<B> {
        &self.inputs
    }

    /// Velocity of the wheel centre and angular velocity of the knuckle with respect to the rack, at constant travel. NaN if not
    /// requested.
    #[inline(always)]
    pub fn by_rack(&self) -> &[Vector3<B>; 2] {
        &self.by_rack
    }

    /// The body of a rigid axle. NaN if not requested.
    #[inline(always)]
    pub fn axle(&self) -> &LaneAxle<B> {
        &self.axle
    }
}

/// Designs whose characteristics are read, one in each lane.
pub struct LaneWheels<B: SimdReal> {
    spin_axis: KnuckleVector<B>,
    designed_spin_axis: DesignedSpinAxis<B>,
    /// Points on the knuckle that are read.
    carried: Vec<KnucklePoint<B>>,
}

impl<'a> LaneReader<'a> {
    /// Makes a reader of these quantities. `None` if one of the quantities cannot be read in SIMD lanes.
    pub fn new(
        mechanism: &'a Mechanism,
        batch: &CornerTracker<'_>,
        constants: Constants,
        quantities: Vec<Quantity>,
    ) -> Option<Self> {
        let mut points: Vec<PointId> = Vec::new();
        let mut rule = |quantity: &Quantity| match *quantity {
            Quantity::Characteristic(c) => match angle_of_gain(c) {
                Some(angle) if batch.drive() == Drive::Travel => EvaluationRule::Slope(angle),
                _ => EvaluationRule::Formula(c),
            },
            Quantity::Coordinate(id, axis) => {
                let number = points.iter().position(|p| *p == id).unwrap_or_else(|| {
                    points.push(id);
                    points.len() - 1
                });
                EvaluationRule::Coordinate(number, axis)
            }
            Quantity::AngularVelocity(axis) => EvaluationRule::AngularVelocity(axis),
        };
        let rules: Vec<EvaluationRule> = quantities.iter().map(&mut rule).collect();
        let of_rates: Vec<bool> = quantities.iter().map(|q| q.rate_order() > 0).collect();
        let rates = of_rates.contains(&true);
        let slots = Slots::of(rules.iter().map(|rule| match rule {
            EvaluationRule::Formula(c) | EvaluationRule::Slope(c) => c.info().reads,
            EvaluationRule::Coordinate(..) | EvaluationRule::AngularVelocity(_) => &[],
        }));
        let reader = LaneReader::reading(mechanism, batch, constants, slots, points, rates)?;
        Some(LaneReader {
            quantities,
            rules,
            of_rates,
            ..reader
        })
    }

    /// Makes a reader of slots, for formulas that are evaluated elsewhere. It includes the slots' velocities if `rates` is
    /// true. `None` if one of the slots cannot be read in SIMD lanes.
    pub fn of_slots(
        mechanism: &'a Mechanism,
        batch: &CornerTracker<'_>,
        constants: Constants,
        slots: Slots,
        rates: bool,
    ) -> Option<Self> {
        LaneReader::reading(mechanism, batch, constants, slots, Vec::new(), rates)
    }

    /// Makes a reader of these slots and of the coordinates of these points. `None` if one of them cannot be read in SIMD
    /// lanes.
    fn reading(
        mechanism: &'a Mechanism,
        batch: &CornerTracker<'_>,
        constants: Constants,
        slots: Slots,
        points: Vec<PointId>,
        rates: bool,
    ) -> Option<Self> {
        let mut asked = ReadSet::by(mechanism, slots);
        let steered = mechanism
            .axle_steering()
            .map(|steering| steering.near_knuckle);
        let kingpin = match mechanism.steering_axis {
            Some(SteeringAxis::Through { lower, upper }) if steered.is_some() => {
                asked.steering_axis.then_some([lower, upper])
            }
            axis if asked.steering_axis && !batch.steers_about(axis) => return None,
            _ => None,
        };
        asked.points.extend(&points);
        asked.points.extend(kingpin.iter().flatten());
        let mut rockers: Vec<RockerId> = asked
            .rockers(mechanism)
            .chain(steered)
            .flat_map(|id| mechanism.rockers_moving(mechanism.rocker(id).inner))
            .collect();
        sort_by_key(&mut rockers, |id| id.0);
        rockers.dedup();
        let is_carried = |id: &PointId| mechanism.body(*id) == Body::Knuckle;
        let reads_others = !rockers.is_empty() || !asked.points.iter().all(is_carried);
        let mut carried = asked.points;
        carried.retain(is_carried);
        sort_by_key(&mut carried, |id| id.0);
        carried.dedup();
        let all = (0..mechanism.points.len()).map(PointId);
        Some(LaneReader {
            mechanism,
            quantities: Vec::new(),
            rules: Vec::new(),
            of_rates: Vec::new(),
            constants,
            slots,
            points,
            place: all
                .map(|id| carried.iter().position(|carried| *carried == id))
                .collect(),
            carried,
            reads_others,
            rockers,
            rates,
            by_rack: false,
            steered,
            kingpin,
            of_axle: false,
        })
    }

    /// If `is_wanted`, the reader also reads the body of a rigid axle. It reads the body's velocities only if it also
    /// reads velocities with respect to the rack.
    #[must_use]
    pub fn with_axle(mut self, is_wanted: bool) -> Self {
        self.of_axle = is_wanted;
        self
    }

    /// If `is_wanted`, the reader also reads velocities with respect to the rack. For this it needs the wheel centre,
    /// and velocities with respect to the drive coordinate. Without these two, it reads no velocities with respect to
    /// the rack.
    #[must_use]
    pub fn with_derivatives_by_rack(mut self, is_wanted: bool) -> Self {
        let knows_centre = self.slots.contain_either(Slot::Centre, Slot::CentreRate);
        self.by_rack = is_wanted && self.rates && knows_centre;
        self
    }

    /// Returns true if the reader checks the rods of rockers from station to station. Poses must then be read in the order of
    /// their stations.
    #[inline]
    pub(crate) fn watches_rods(&self) -> bool {
        !self.rockers.is_empty()
    }

    /// Mechanism of the reader.
    #[inline]
    pub(crate) fn mechanism(&self) -> &'a Mechanism {
        self.mechanism
    }

    /// Quantities, in the order of the values.
    #[inline]
    pub fn quantities(&self) -> &[Quantity] {
        &self.quantities
    }

    /// Returns true if the quantities contain velocities.
    #[inline]
    pub fn reads_rates(&self) -> bool {
        self.rates
    }

    /// Prepares to read poses of these designs, given as their points.
    #[inline(always)]
    pub fn wheels<B: SimdReal>(
        &self,
        lanes: &LaneDesign<'_, B>,
        design: &[Vector3<B>],
    ) -> LaneWheels<B> {
        let designed_spin_axis = DesignedSpinAxis::of(self.mechanism, design);
        let mut carried = Vec::with_capacity(self.carried.len());
        for id in &self.carried {
            carried.push(lanes.point(design[id.0]));
        }
        let spin_axis = designed_spin_axis.direction;
        LaneWheels {
            spin_axis: lanes.vector(spin_axis),
            designed_spin_axis,
            carried,
        }
    }

    /// Makes storage for the inputs. All numbers are NaN.
    #[inline(always)]
    pub fn inputs<B: SimdReal>(&self, like: B) -> LaneInputs<B> {
        let unknown = like.constant(f64::NAN);
        let inputs = Inputs::unknown(unknown, self.constants);
        let nothing = inputs.turn;
        LaneInputs {
            inputs,
            points: vec![[nothing; 2]; self.points.len()],
            by_rack: [nothing; 2],
            axle: LaneAxle {
                columns: [nothing; 2],
                turns: [nothing; 2],
                kingpin_by_held: nothing,
                is_steered: self.steered.is_some(),
            },
            rods: ToggleWatch::of(self.rockers.len(), unknown),
        }
    }

    /// Reads the slots that depend only on the designs. Call it before the first pose of these designs.
    #[inline(always)]
    pub fn read_designs<B: SimdReal>(&self, design: &[Vector3<B>], into: &mut LaneInputs<B>) {
        into.inputs.read_design(self.mechanism, design, self.slots);
    }
}
