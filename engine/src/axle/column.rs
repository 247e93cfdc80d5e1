//! Columns of an axle's curves: each column has a name, a quantity and a unit.

use super::reading::WheelParts;
use super::series::ByGear;
use super::solver::Sought;
use super::state::{AxleState, Motion};
use super::taylor::Taylor;
use super::{Axle, AxlePlan, Quantity, Read, WheelMotion};
use crate::ask::{NoValue, with_unit};
use crate::curves::{ByTime, Column, Loads, per, velocity_name};
use crate::model::{Axis, PointId, RockerId, Side};
use crate::number::{Each, Jet};

/// A column of values in the results.
#[derive(Clone, Debug, PartialEq)]
pub struct AxleColumn {
    /// Name of the column, with its unit.
    pub name: String,
    /// Content of the column.
    pub of: Of,
    /// Motion along which the column is differentiated. `None` for a value that is not differentiated.
    pub by: Option<Motion>,
    /// True if the derivative is with respect to time, while the axle moves along `by`.
    pub is_by_time: bool,
    /// Order of the derivative; 0 for a value.
    pub order: usize,
    /// Unit of the column. Empty for a plain number.
    pub unit: String,
    /// Factor that converts radians, length units and newtons to the unit of the column.
    pub factor: f64,
}

/// Content of a column of an axle's curves.
#[derive(Clone, Debug, PartialEq)]
pub enum Of {
    /// A quantity.
    Quantity(Quantity),
    /// A coordinate of a point of one wheel's suspension.
    Point {
        /// Wheel whose suspension has the point.
        side: Side,
        /// Index of the point in [`AxlePlan::points`](super::AxlePlan::points).
        number: usize,
        /// Identifier of the point.
        id: PointId,
        /// Axis along which the coordinate is measured.
        axis: Axis,
        /// Name of the column without the unit.
        name: String,
        /// Rocker that carries the point. `None` if no rocker carries it.
        rocker: Option<RockerId>,
    },
    /// A component of the angular velocity of one wheel carrier.
    Turn(Side, Axis),
    /// Force in a member that carries a load on one wheel.
    Force {
        /// Name of the column without the unit.
        name: String,
        /// Meaning of a positive force, in words.
        positive: &'static str,
    },
}

impl AxleColumn {
    /// Makes the column of a value that is not differentiated.
    fn value(of: Of, unit: String, factor: f64) -> Self {
        let mut column = AxleColumn {
            name: String::new(),
            of,
            by: None,
            is_by_time: false,
            order: 0,
            unit,
            factor,
        };
        column.name = with_unit(column.output(), &column.unit);
        column
    }

    /// Makes the column of a force in a member that carries a load on one wheel.
    fn force(side: Side, force: Column) -> Self {
        AxleColumn {
            name: format!("{}_{}", side.name(), force.name),
            of: Of::Force {
                name: format!("{}_{}", side.name(), force.output),
                positive: force.positive.unwrap_or_default(),
            },
            by: None,
            is_by_time: false,
            order: 0,
            unit: force.unit,
            factor: 1.0,
        }
    }

    /// Quantity in the column. `None` for other contents.
    pub fn quantity(&self) -> Option<Quantity> {
        match &self.of {
            Of::Quantity(quantity) => Some(*quantity),
            _ => None,
        }
    }

    /// Returns the quantity or coordinate that the column contains or differentiates. `None` if the column has no
    /// derivatives with respect to hardpoints.
    pub(super) fn sought(&self) -> Option<Sought> {
        match self.of {
            Of::Quantity(quantity) => Some(Sought::Quantity(quantity)),
            Of::Point { side, id, axis, .. } => Some(Sought::Point(side, id, axis)),
            Of::Turn(..) | Of::Force { .. } => None,
        }
    }

    /// Returns the number in the column for a pose, in radians, length units, newtons and seconds, or the reason why
    /// the number does not exist. `None` for a force, because the pose alone does not determine it. If the number
    /// depends on the displacement of a steering gear, `by_drag_link` contains the derivatives with respect to this
    /// displacement ([`AxleSolver::by_drag_link`](super::AxleSolver)).
    pub(crate) fn evaluate(
        &self,
        read: &Read,
        time: ByTime,
        by_drag_link: Option<ByGear>,
    ) -> Option<Result<f64, NoValue>> {
        let along = |order: usize| match by_drag_link {
            None => self.along(read, order),
            Some(by) => Some(self.exists(read).map(|()| by[order - 1])),
        };
        if !self.is_by_time {
            return along(self.order);
        }
        let mut derivatives = [f64::NAN; 3];
        for (order, derivative) in derivatives.iter_mut().enumerate().skip(1) {
            if order > self.order {
                break;
            }
            match along(order)? {
                Ok(value) => *derivative = value,
                Err(reason) => return Some(Err(reason)),
            }
        }
        Some(Ok(time.apply(false, derivatives, self.order)))
    }

    /// Returns the reason if the value, without a derivative, does not exist in a pose.
    fn exists(&self, read: &Read) -> Result<(), NoValue> {
        match &self.of {
            Of::Quantity(quantity) => read.value(*quantity).map(drop),
            Of::Point { side, rocker, .. } if rocker.is_some_and(|id| read.holds(*side, id)) => {
                Err(NoValue::Toggle)
            }
            _ => Ok(()),
        }
    }

    /// Returns the value of the column, or its derivative of this order along the motion of the column. `None` for a
    /// force.
    fn along(&self, read: &Read, order: usize) -> Option<Result<f64, NoValue>> {
        match &self.of {
            Of::Quantity(quantity) => Some(self.quantity_in(*quantity, read, order)),
            Of::Point {
                side, number, axis, ..
            } => {
                let place = &read.points[*side as usize][*number][*axis];
                Some(self.exists(read).map(|()| match self.by {
                    None => place.coefficient([0, 0]),
                    Some(motion) => of_point(place, motion, *side, &read.state, order),
                }))
            }
            Of::Turn(side, axis) => Some(Ok(of_turn(*axis, self.by?, *side, &read.state, order))),
            Of::Force { .. } => None,
        }
    }

    fn quantity_in(&self, quantity: Quantity, read: &Read, order: usize) -> Result<f64, NoValue> {
        let value = read.value(quantity)?;
        Ok(match (self.by, order) {
            (None, _) => value,
            (Some(motion), 1) => quantity.evaluate(&read.state.moving(motion))[1],
            (Some(motion), _) => {
                let once = read.state.moving(motion);
                quantity.evaluate(&once.moving(motion))[1][1]
            }
        })
    }

    /// Makes the column for the derivative of this value along a motion. `rack_sign` is the sign of the rack's axis in
    /// the study.
    fn by_motion(
        &self,
        order: usize,
        (motion, by, per, by_factor): &ByMotion,
        rack_sign: f64,
    ) -> AxleColumn {
        let (stem, per) = match (order, &self.of) {
            // An angular velocity is already a first derivative.
            (1, _) => (format!("{}_by_{by}", self.output()), per.clone()),
            (_, Of::Turn(side, axis)) => {
                let stem = format!("{}_knuckle_alpha_{}", side.name(), axis.name());
                (format!("{stem}_by_{by}"), format!("{per}2"))
            }
            _ => (format!("{}_by_{by}_d2", self.output()), format!("{per}2")),
        };
        let unit = if self.unit.is_empty() {
            per
        } else {
            format!("{}_{per}", self.unit)
        };
        let sign = match motion {
            Motion::Rack => rack_sign,
            _ => 1.0,
        };
        AxleColumn {
            name: with_unit(stem, &unit),
            by: Some(*motion),
            is_by_time: false,
            order,
            factor: self.factor * (by_factor * sign).powi(order as i32),
            unit,
            of: self.of.clone(),
        }
    }

    /// Makes the column for a time derivative of this value, if the coordinate of this motion is a function of time.
    fn by_time(&self, order: usize, (motion, ..): &ByMotion) -> AxleColumn {
        let unit = per(&self.unit, "s", order);
        let stem = match &self.of {
            Of::Turn(..) if order == 1 => self.output(),
            Of::Turn(side, axis) => format!("{}_knuckle_alpha_{}", side.name(), axis.name()),
            Of::Point { axis, .. } => velocity_name(&self.output(), *axis, order),
            Of::Quantity(_) | Of::Force { .. } => format!("{}_d{order}", self.output()),
        };
        AxleColumn {
            name: with_unit(stem, &unit),
            by: Some(*motion),
            is_by_time: true,
            order,
            unit,
            ..self.clone()
        }
    }

    /// Name of the column without motion and unit.
    pub fn output(&self) -> String {
        match &self.of {
            Of::Quantity(quantity) => quantity.name(),
            Of::Point { name, .. } | Of::Force { name, .. } => name.clone(),
            Of::Turn(side, axis) => format!("{}_knuckle_omega_{}", side.name(), axis.name()),
        }
    }

    /// Meaning of a positive value, in words. `None` for derivatives.
    pub fn positive(&self) -> Option<&'static str> {
        match &self.of {
            _ if self.by.is_some() => None,
            Of::Quantity(quantity) => Some(quantity.info().positive),
            Of::Force { positive, .. } => Some(positive),
            Of::Point { .. } | Of::Turn(..) => None,
        }
    }
}

/// Derivative of a coordinate. The coordinate is a function of the travel of its own wheel and of the rack.
fn of_point(
    place: &Taylor<f64>,
    motion: Motion,
    side: Side,
    state: &AxleState<'_, f64>,
    order: usize,
) -> f64 {
    let by = |powers: [usize; 2]| {
        let [travel, rack] = powers;
        let factorials = [1.0, 1.0, 2.0];
        place.coefficient(powers) * factorials[travel] * factorials[rack]
    };
    let [by_travel, by_rack] = [by([1, 0]), by([0, 1])];
    if order == 1 {
        return state.along(motion, side, [by_travel, by_rack]);
    }
    let further = |powers| state.along(motion, side, powers);
    let by_travel = Jet([by_travel, further([by([2, 0]), by([1, 1])])]);
    let by_rack = Jet([by_rack, further([by([1, 1]), by([0, 2])])]);
    let moving = state.moving(motion);
    moving.along(motion, side, [by_travel, by_rack])[1]
}

/// Component of an angular velocity, or its derivative.
fn of_turn(
    axis: Axis,
    motion: Motion,
    side: Side,
    state: &AxleState<'_, f64>,
    order: usize,
) -> f64 {
    if order == 1 {
        let wheel = &state.readings[side as usize];
        let by = [wheel.by_travel(), wheel.by_rack()].each(|[_, turn]| turn[axis]);
        return state.along(motion, side, by);
    }
    let moving = state.moving(motion);
    let wheel = &moving.readings[side as usize];
    let by = [wheel.by_travel(), wheel.by_rack()].each(|[_, turn]| turn[axis]);
    moving.along(motion, side, by)[1]
}

impl From<&AxleColumn> for Column {
    fn from(column: &AxleColumn) -> Self {
        Column {
            name: column.name.clone(),
            output: column.output(),
            unit: column.unit.clone(),
            positive: column.positive(),
            order: column.order,
            by: column.by.filter(|_| !column.is_by_time).map(Motion::name),
            of: None,
            factor: column.factor,
        }
    }
}

/// A motion, its name and unit in columns, and the factor that converts a derivative along this motion to the unit of
/// the column.
type ByMotion = (Motion, &'static str, String, f64);

/// Lists all three axes for the left wheel, then all three axes for the right wheel.
fn by_wheel() -> impl Iterator<Item = (Side, Axis)> {
    let sides = Side::ALL.into_iter();
    sides.flat_map(|side| Axis::ALL.each(|axis| (side, axis)))
}

impl AxlePlan {
    /// Motions along which results have derivatives, with the name and unit of each motion.
    fn motions(&self, axle: &Axle) -> Vec<ByMotion> {
        let length = axle.left.length_unit;
        if self.derivatives == 0 {
            return Vec::new();
        }
        let per_length = || format!("per_{}", length.symbol());
        let by_length = |motion, name| (motion, name, per_length(), 1.0);
        if let Some(time) = &self.motion.time {
            return vec![(time.coordinate.motion(), "time", "per_s".to_owned(), 1.0)];
        }
        let roll = (
            Motion::Roll,
            "roll",
            "per_deg".to_owned(),
            1.0_f64.to_radians(),
        );
        let mut motions = match &self.motion.wheels {
            WheelMotion::Heave(_) => vec![by_length(Motion::Heave, "heave")],
            WheelMotion::Roll { .. } => vec![roll, by_length(Motion::Heave, "heave")],
            WheelMotion::Travels { .. } => vec![
                by_length(Motion::TravelLeft, "travel_left"),
                by_length(Motion::TravelRight, "travel_right"),
            ],
        };
        // The motion of another study may move a rack that this axle does not have.
        if self.motion.shows_rack && axle.has_steering_gear() {
            motions.push(by_length(Motion::Rack, "rack"));
        }
        motions
    }

    /// Returns the columns of the derivatives of a value along these motions.
    fn derivatives_of(
        &self,
        value: &AxleColumn,
        motions: &[ByMotion],
        axle: &Axle,
    ) -> Vec<AxleColumn> {
        let rack_sign = axle.left.frame.sign(Axis::Y);
        let is_steered = axle.left.mechanism.axle_steering().is_some();
        let by = |(order, by)| match self.motion.time {
            Some(_) => value.by_time(order, by),
            None => value.by_motion(order, by, rack_sign),
        };
        // Quantities that contain velocities have no second derivative with respect to the displacement of a drag link.
        let is_of_rates = value.quantity().is_some_and(|q| q.rate_order() > 0);
        let is_known = |(order, by): &(usize, &ByMotion)| {
            let is_by_gear = is_steered && by.0 == Motion::Rack;
            !(is_by_gear && is_of_rates && *order > 1)
        };
        let orders = 1..=self.derivatives;
        let all = orders.flat_map(|order| motions.iter().map(move |motion| (order, motion)));
        all.filter(is_known).map(by).collect()
    }

    /// Returns the columns of the plan. Each value comes before its derivatives. The order is: quantities, points,
    /// wheel carriers, forces.
    pub fn columns(&self, axle: &Axle) -> Vec<AxleColumn> {
        let length = axle.left.length_unit;
        let motions = self.motions(axle);
        let derivatives = |value: &AxleColumn| self.derivatives_of(value, &motions, axle);
        let mut columns = Vec::new();
        for quantity in &self.quantities {
            let unit = quantity.info().unit;
            let (suffix, factor) = (unit.suffix(length), unit.printed_factor(length));
            let value = AxleColumn::value(Of::Quantity(*quantity), suffix, factor);
            // A test result is already a derivative.
            let derivatives = match quantity {
                Quantity::Figure(_) => Vec::new(),
                _ => derivatives(&value),
            };
            columns.push(value);
            columns.extend(derivatives);
        }
        for (number, id) in self.points.iter().enumerate() {
            for (side, axis) in by_wheel() {
                let mechanism = &axle.suspension(side).mechanism;
                let of = Of::Point {
                    side,
                    number,
                    id: *id,
                    axis,
                    name: format!("{}_{}_{}", side.name(), mechanism.name(*id), axis.name()),
                    rocker: mechanism.rockers_moving(*id).next(),
                };
                let sign = axle.frame(side).sign(axis);
                let value = AxleColumn::value(of, length.symbol().to_owned(), sign);
                let derivatives = derivatives(&value);
                columns.push(value);
                columns.extend(derivatives);
            }
        }
        if self.knuckle {
            for (side, axis) in by_wheel() {
                let sign = axle.frame(side).turn_sign(axis);
                let turn = AxleColumn::value(Of::Turn(side, axis), "rad".to_owned(), sign);
                columns.extend(derivatives(&turn));
            }
        }
        for side in Side::ALL {
            let loads = self.carried(axle, side);
            let forces = loads.columns();
            columns.extend(forces.map(|force| AxleColumn::force(side, force)));
        }
        columns
    }

    /// Returns the loads on one wheel, and the members that carry these loads.
    pub(super) fn carried<'a>(&'a self, axle: &'a Axle, side: Side) -> Loads<'a> {
        let mechanism = &axle.suspension(side).mechanism;
        let units = (axle.frame(side), axle.left.length_unit);
        Loads::of(mechanism, units, &self.loads[side as usize])
    }
}
