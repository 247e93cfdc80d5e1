//! Quantities of many designs at a time, one in each lane.
//!
//! Only requested numbers are formed. The reader decides about them when it is made, by the [`Slot`]s of the formulas. A slot
//! that is not read is NaN, so a formula that reads an undeclared slot has no value.

mod evaluating;
mod gradients;
mod pose;
mod watching;

pub use gradients::ByDirections;

use super::gains::angle_of_gain;
use super::reading::ReadSet;
use super::{Characteristic, Constants, Inputs, Quantity, Slot, Slots};
use crate::derive::DesignedSpinAxis;
use crate::model::{Axis, Body, Drive, Mechanism, PointId, RockerId};
use crate::number::{SimdReal, Vector3};
use crate::solve::{CornerTracker, KnucklePoint, KnuckleVector, LaneDesign};
use watching::ToggleWatch;

/// Reads quantities off poses in lanes.
#[derive(Clone, Debug)]
pub struct LaneReader<'a> {
    mechanism: &'a Mechanism,
    quantities: Vec<Quantity>,
    /// Evaluation rule of each quantity.
    rules: Vec<EvaluationRule>,
    /// True for each quantity that is made of velocities.
    of_rates: Vec<bool>,
    constants: Constants,
    slots: Slots,
    /// Points whose coordinates are read.
    points: Vec<PointId>,
    /// `carried`: all points on the knuckle that are read. `place[id]`: index in `carried` of the point `id` of the
    /// mechanism, or `None` if that point is not among them.
    carried: Vec<PointId>,
    place: Vec<Option<usize>>,
    /// True if a part outside the knuckle is read: another body's point, or a rocker.
    reads_others: bool,
    /// Rockers that move a part that is read, and the rockers that turn them. Their positions need velocities.
    rockers: Vec<RockerId>,
    rates: bool,
    /// True if derivatives by the rack are read, too.
    by_rack: bool,
}

/// Evaluation rule of a quantity.
#[derive(Clone, Copy, Debug)]
enum EvaluationRule {
    /// Own formula.
    Formula(Characteristic),
    /// The slope of this angle by the drive. This is the angle's gain if the travel is the drive.
    Slope(Characteristic),
    /// A coordinate of one of the points.
    Coordinate(usize, Axis),
    /// A component of the angular velocity.
    AngularVelocity(Axis),
}

/// Inputs read from poses in lanes.
#[derive(Clone, Debug)]
pub struct LaneInputs<B> {
    inputs: Inputs<B>,
    /// Positions of the points, and their velocities.
    points: Vec<[Vector3<B>; 2]>,
    /// Velocity of the wheel centre and angular velocity by the rack, the travel held.
    by_rack: [Vector3<B>; 2],
    rods: ToggleWatch<B>,
}

impl<B> LaneInputs<B> {
    /// Makes ready for the stations at another rack displacement, which are visited outward from the design position.
    #[inline(always)]
    pub fn begin(&mut self) {
        self.rods.begin();
    }

    /// The inputs of formulas.
    #[inline(always)]
    pub fn inputs(&self) -> &Inputs<B> {
        &self.inputs
    }

    /// Velocity of the wheel centre and angular velocity by the rack, with the travel held; NaN if not requested.
    #[inline(always)]
    pub fn by_rack(&self) -> &[Vector3<B>; 2] {
        &self.by_rack
    }
}

/// Designs whose characteristics are read.
pub struct LaneWheels<B: SimdReal> {
    spin_axis: KnuckleVector<B>,
    designed_spin_axis: DesignedSpinAxis<B>,
    /// The points that the knuckle carries.
    carried: Vec<KnucklePoint<B>>,
}

impl<'a> LaneReader<'a> {
    /// A reader of these quantities; `None` if one of them cannot be read in lanes.
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

    /// A reader of slots, with their velocities if `rates` is true, for formulas that are evaluated elsewhere. `None`
    /// if lanes cannot read one of them.
    pub fn of_slots(
        mechanism: &'a Mechanism,
        batch: &CornerTracker<'_>,
        constants: Constants,
        slots: Slots,
        rates: bool,
    ) -> Option<Self> {
        LaneReader::reading(mechanism, batch, constants, slots, Vec::new(), rates)
    }

    /// A reader of these slots and of the coordinates of these points. `None` if one of them cannot be read in lanes.
    fn reading(
        mechanism: &'a Mechanism,
        batch: &CornerTracker<'_>,
        constants: Constants,
        slots: Slots,
        points: Vec<PointId>,
        rates: bool,
    ) -> Option<Self> {
        let mut asked = ReadSet::by(mechanism, slots);
        if asked.steering_axis && !batch.steers_about(mechanism.steering_axis) {
            return None;
        }
        asked.points.extend(&points);
        let mut rockers: Vec<RockerId> = asked
            .rockers(mechanism)
            .flat_map(|id| mechanism.rockers_moving(mechanism.rocker(id).inner))
            .collect();
        rockers.sort_unstable_by_key(|id| id.0);
        rockers.dedup();
        let is_carried = |id: &PointId| mechanism.body(*id) == Body::Knuckle;
        let reads_others = !rockers.is_empty() || !asked.points.iter().all(is_carried);
        let mut carried = asked.points;
        carried.retain(is_carried);
        carried.sort_unstable_by_key(|id| id.0);
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
        })
    }

    /// The reader with velocities by the rack, too, if `is_wanted`. They are read only if the reader reads velocities
    /// by the drive and the wheel centre.
    #[must_use]
    pub fn with_derivatives_by_rack(mut self, is_wanted: bool) -> Self {
        let knows_centre = self.slots.contain_either(Slot::Centre, Slot::CentreRate);
        self.by_rack = is_wanted && self.rates && knows_centre;
        self
    }

    /// Returns true if poses must be read in the order of the visit, because rods of rockers are watched from station to station.
    #[inline]
    pub(crate) fn watches_rods(&self) -> bool {
        !self.rockers.is_empty()
    }

    /// The mechanism that is read.
    #[inline]
    pub(crate) fn mechanism(&self) -> &'a Mechanism {
        self.mechanism
    }

    /// The quantities, in the order of the values.
    #[inline]
    pub fn quantities(&self) -> &[Quantity] {
        &self.quantities
    }

    /// Returns true if the quantities read velocities.
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

    /// Storage for the inputs, all NaN.
    #[inline(always)]
    pub fn inputs<B: SimdReal>(&self, like: B) -> LaneInputs<B> {
        let unknown = like.constant(f64::NAN);
        let inputs = Inputs::unknown(unknown, self.constants);
        let nothing = inputs.turn;
        LaneInputs {
            inputs,
            points: vec![[nothing; 2]; self.points.len()],
            by_rack: [nothing; 2],
            rods: ToggleWatch::of(self.rockers.len(), unknown),
        }
    }

    /// Reads the slots that depend on the designs alone, before the first of their poses.
    #[inline(always)]
    pub fn read_designs<B: SimdReal>(&self, design: &[Vector3<B>], into: &mut LaneInputs<B>) {
        into.inputs.read_design(self.mechanism, design, self.slots);
    }
}
