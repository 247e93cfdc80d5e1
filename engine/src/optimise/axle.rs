//! Targets of an axle: rows of the least-squares problem, in addition to the rows of one wheel.
//!
//! A variable moves the same points of both wheels, each wheel in the frame of its own side. So the derivative of a row is
//! the sum of both wheels' gradients along the variable's rates. If the right wheel has different hardpoints, the variables
//! move them as mirror images of the left hardpoints. In a scattered build, the two wheels always differ.

use super::elastic_axle::elastic_axle_rows;
use super::layout::{LimitedValue, StationGoals, TargetSample};
use super::moved_wheel::WheelMoved;
use super::{Infeasible, Linearisation};
use crate::axle::{Axle, AxleSolver, Hold, Placement, Quantity};
use crate::compliance::{AxleParameter, NOT_ABOVE_ZERO, Parameter};
use crate::evaluate::index_or_push;
use crate::mechanism::{DesignFault, NoPose};
use crate::model::PointId;
use crate::number::{Each, Vector3};
use crate::study::{Limited, Optimise, Variable};
use nalgebra::DVector;

/// A pose of the axle, with its target values.
#[derive(Clone, Debug)]
pub(super) struct AxleStation {
    pub placement: Placement,
    pub goals: StationGoals,
}

/// Residuals of the targets of an axle, assigned to the poses in which they are evaluated.
#[derive(Clone, Debug)]
pub(super) struct AxleLayout {
    pub axle: Axle,
    pub quantities: Vec<Quantity>,
    pub stations: Vec<AxleStation>,
}

impl AxleLayout {
    /// Assigns the targets of an axle to poses. Adds the number of residuals to `rows`, and the number of each target's
    /// residuals to `own`.
    pub(super) fn of(
        axle: &Axle,
        optimise: &Optimise,
        rows: &mut usize,
        own: &mut [usize],
    ) -> Self {
        let mut layout = AxleLayout {
            axle: axle.clone(),
            quantities: Vec::new(),
            stations: Vec::new(),
        };
        for (number, target) in optimise.targets.iter().enumerate() {
            for sample in target.axle_samples(axle) {
                let target_sample = TargetSample {
                    row: *rows,
                    target: number,
                    of: index_or_push(&mut layout.quantities, sample.quantity),
                    wanted: sample.wanted,
                    scale: 1.0 / target.tolerance,
                };
                let goals = layout.goals_at(sample.placement);
                goals.samples.push(target_sample);
                own[number] += 1;
                *rows += 1;
            }
        }
        layout
    }

    fn goals_at(&mut self, placement: Placement) -> &mut StationGoals {
        let known = self.stations.iter().position(|s| s.placement == placement);
        let place = known.unwrap_or_else(|| {
            self.stations.push(AxleStation {
                placement,
                goals: StationGoals::default(),
            });
            self.stations.len() - 1
        });
        &mut self.stations[place].goals
    }

    /// Adds the limits of an axle's quantity in the pose `placement`. `part` is the index of the constraint part (one
    /// measure with its limits).
    pub(super) fn limit(
        &mut self,
        part: usize,
        quantity: Quantity,
        limited: &Limited,
        placement: Placement,
    ) {
        let of = index_or_push(&mut self.quantities, quantity);
        self.goals_at(placement).limit(part, of, limited);
    }

    /// Targets and limits of each station, with the station's rack displacement along +y of the kernel's frame (+y is to
    /// the left).
    pub(super) fn goals(&self) -> impl Iterator<Item = (&StationGoals, f64)> {
        let stations = self.stations.iter();
        stations.map(|station| (&station.goals, station.placement.rack()))
    }

    /// Targets and limits of each station.
    pub(super) fn goals_mut(&mut self) -> impl Iterator<Item = &mut StationGoals> {
        self.stations.iter_mut().map(|station| &mut station.goals)
    }

    /// Highest order of derivatives with respect to travel and rack that the quantities need. It is one higher if the travels
    /// of some pose depend on the design.
    fn degree(&self) -> usize {
        let orders = self.quantities.iter().map(|q| q.rate_order());
        let on_plane = |s: &AxleStation| s.placement.hold() != Hold::TravelsOnPads;
        orders.max().unwrap_or(0) + usize::from(self.stations.iter().any(on_plane))
    }
}

/// Designs of the wheels, moved by the variables.
pub(super) struct Moved<'m> {
    /// Design variables of the tuning.
    pub variables: &'m [Variable],
    /// Values of the variables.
    pub x: &'m DVector<f64>,
    /// Left and right wheel. The two are equal in a study of one wheel, and for an axle whose wheels are mirror images.
    pub wheels: [WheelMoved<'m>; 2],
    /// Scatter of elastic rates in a build. Empty for the nominal design.
    pub scattered: &'m [ScatteredRate],
    /// True for a build. The points of a build move independently of each other, including the points of the right half of a
    /// solid axle.
    pub is_build: bool,
}

/// Scatter of the rate of an elastic part.
#[derive(Clone, Copy, Debug)]
pub(super) struct ScatteredRate {
    /// Rate that scatters. It belongs to one wheel, or to a part that both wheels share.
    pub of: AxleParameter,
    /// Change of the rate in the build.
    pub change: f64,
    /// True if the change is a fraction of the rate.
    pub is_relative: bool,
}

impl Moved<'_> {
    /// Derivative of the rate in a build with respect to the nominal rate.
    pub(super) fn gain(&self, of: AxleParameter) -> f64 {
        let is_own = |own: &&ScatteredRate| {
            let is_of_side = own.of.side.is_none() || own.of.side == of.side;
            own.of.parameter == of.parameter && is_of_side
        };
        let own = self.scattered.iter().filter(is_own);
        let relative = own.filter(|own| own.is_relative);
        relative.map(|own| 1.0 + own.change).product()
    }

    /// Design variables that are rates of elastic parts. Each item holds the variable's index, the rate's name, and the
    /// rate's value and derivative.
    pub(super) fn rates(&self) -> impl Iterator<Item = (usize, Parameter, [f64; 2])> {
        let variables = self.variables.iter().zip(self.x.iter()).enumerate();
        variables.filter_map(|(column, (variable, x))| {
            let rate = variable.rate.as_ref()?;
            Some((column, rate.parameter, rate.at(*x)))
        })
    }

    /// Sets the rates of the elastic parts to the rates of this design. `set` sets a nominal rate. `change` adds the scatter
    /// to a rate, and returns false if the changed rate is not above 0.
    pub(super) fn set_rates<P>(
        &self,
        parts: &mut P,
        set: impl Fn(&mut P, AxleParameter, f64),
        change: impl Fn(&mut P, AxleParameter, f64, bool) -> bool,
    ) -> Result<(), Infeasible> {
        for (_, parameter, [rate, _]) in self.rates() {
            set(parts, parameter.into(), rate);
        }
        let mut scattered = self.scattered.iter();
        if scattered.all(|own| change(parts, own.of, own.change, own.is_relative)) {
            Ok(())
        } else {
            Err(Infeasible::Refused(NOT_ABOVE_ZERO.to_owned()))
        }
    }
}

/// Points that the variables move, without duplicates.
pub(super) fn moved_points(variables: &[Variable]) -> Vec<PointId> {
    let mut points: Vec<PointId> = variables.iter().flat_map(Variable::points).collect();
    points.sort();
    points.dedup();
    points
}

/// Evaluates the residuals and constraints of an axle or of elastic parts, with their derivatives.
pub(super) trait RowsBeside: Send {
    /// Writes the residuals of all targets into `into`, from the given row on, and the rows of the constraints into `rows`.
    fn evaluate(
        &mut self,
        moved: &Moved<'_>,
        into: Option<(&mut Linearisation, usize)>,
        rows: Option<&mut Linearisation>,
    ) -> Result<(), Infeasible>;
}

/// Makes the evaluator of the residuals and constraints that an axle's layout lists. The variables move `points`.
pub(super) fn axle_rows<'a>(
    layout: &'a AxleLayout,
    axle: &'a Axle,
    points: &[PointId],
    variables: &[Variable],
) -> Result<Box<dyn RowsBeside + 'a>, DesignFault> {
    fn rows<'a, const N: usize>(
        layout: &'a AxleLayout,
        axle: &'a Axle,
        variables: usize,
    ) -> Result<Box<dyn RowsBeside + 'a>, DesignFault> {
        let solver = AxleSolver::<N>::new(axle, &layout.quantities, false);
        Ok(Box::new(Rows {
            layout,
            axle,
            solver: solver.map_err(|(_, fault)| fault)?,
            wanted: Vec::new(),
            slopes: vec![0.0; variables],
        }))
    }
    if let Some(elastic) = &axle.elastic {
        return Ok(elastic_axle_rows(layout, axle, elastic, points, variables));
    }
    match layout.degree() {
        0 => rows::<1>(layout, axle, variables.len()),
        1 => rows::<2>(layout, axle, variables.len()),
        2 => rows::<3>(layout, axle, variables.len()),
        _ => rows::<4>(layout, axle, variables.len()),
    }
}

struct Rows<'a, const N: usize> {
    layout: &'a AxleLayout,
    axle: &'a Axle,
    solver: AxleSolver<'a, N>,
    wanted: Vec<Quantity>,
    slopes: Vec<f64>,
}

impl<const N: usize> RowsBeside for Rows<'_, N> {
    fn evaluate(
        &mut self,
        moved: &Moved<'_>,
        mut into: Option<(&mut Linearisation, usize)>,
        mut rows: Option<&mut Linearisation>,
    ) -> Result<(), Infeasible> {
        let Rows {
            layout,
            axle,
            solver,
            wanted,
            slopes,
        } = self;
        let is_used = |station: &&AxleStation| {
            into.is_some() && !station.goals.samples.is_empty()
                || rows.is_some() && !station.goals.limits.is_empty()
        };
        let stations: Vec<&AxleStation> = layout.stations.iter().filter(is_used).collect();
        if stations.is_empty() {
            return Ok(());
        }
        let designs = moved.wheels.each(|(design, _)| design);
        let prepared = if moved.is_build {
            solver.prepare_whole(designs)
        } else {
            solver.prepare(designs)
        };
        prepared.map_err(|fault| Infeasible::Refused(axle.describe_fault(fault)))?;
        let placements: Vec<Placement> = stations.iter().map(|s| s.placement).collect();
        let placed = solver.place_all(&placements);
        let (unit, frame) = (axle.left.length_unit, axle.left.frame);
        for (station, placed) in stations.into_iter().zip(placed) {
            let placement = station.placement;
            let place = || format!("{placement} ({})", unit.symbol());
            let unreached = |failure: NoPose| {
                let (place, reason) = (place(), failure.describe(unit, frame));
                Infeasible::Refused(format!("the axle does not reach {place}: {reason}"))
            };
            let placed = placed.map_err(unreached)?;
            let read = solver.read(&placed).map_err(unreached)?;
            let value = |quantity: Quantity| {
                read.value(quantity).map_err(|void| {
                    let (name, place, why) = (quantity.name(), place(), void.reason());
                    Infeasible::Refused(format!("{name} has no value at {place}: {why}"))
                })
            };
            let mut at = StationRows {
                layout,
                goals: &station.goals,
                pulling: Vec::new(),
                limited: Vec::new(),
            };
            at.write_values(value, wanted, &mut into, &mut rows)?;
            if moved.variables.is_empty() {
                continue;
            }
            let receive = |number: usize, by_wheel: [&[Vector3<f64>]; 2]| {
                at.write_slopes(moved, wanted[number], by_wheel, &mut into);
                at.write_limit_slopes(moved, wanted[number], by_wheel, slopes, &mut rows);
            };
            let found = if moved.is_build {
                solver.gradients_by_each_point(&placed, wanted, receive)
            } else {
                solver.gradients(&placed, wanted, receive)
            };
            found.map_err(unreached)?;
        }
        Ok(())
    }
}

/// Calls `take` once for each point rate of each wheel. The arguments are the index of the variable, and the contribution of
/// the point to the derivative of a value with respect to this variable. `by_wheel` has the gradient of the value with
/// respect to the points of both wheels.
fn each_slope(moved: &Moved<'_>, by_wheel: [&[Vector3<f64>]; 2], mut take: impl FnMut(usize, f64)) {
    for ((_, point_rates), gradient) in moved.wheels.iter().zip(by_wheel) {
        for rate in *point_rates {
            take(rate.column, gradient[rate.point].dot(rate.by));
        }
    }
}

/// One station of an axle: its targets and limits, as far as their derivatives are needed.
struct StationRows<'r> {
    layout: &'r AxleLayout,
    goals: &'r StationGoals,
    /// Targets whose residuals have derivatives. A target with a band has none while the value is within the band.
    pulling: Vec<&'r TargetSample>,
    /// Limits that apply at this station, each with the value of its quantity.
    limited: Vec<(&'r LimitedValue, f64)>,
}

impl StationRows<'_> {
    /// Writes the residuals of the targets and the rows of the limits, without their slopes. `value` returns the value of a
    /// quantity. The function writes the quantities whose gradients are needed into `wanted`.
    fn write_values(
        &mut self,
        value: impl Fn(Quantity) -> Result<f64, Infeasible>,
        wanted: &mut Vec<Quantity>,
        into: &mut Option<(&mut Linearisation, usize)>,
        rows: &mut Option<&mut Linearisation>,
    ) -> Result<(), Infeasible> {
        let quantities = &self.layout.quantities;
        wanted.clear();
        if let Some((into, first)) = into {
            for sample in &self.goals.samples {
                let quantity = quantities[sample.of];
                let row = *first + sample.row;
                if sample.write_residual(row, value(quantity)?, into) {
                    into.jacobian.row_mut(row).fill(0.0);
                    self.pulling.push(sample);
                    index_or_push(wanted, quantity);
                }
            }
        }
        if let Some(rows) = rows {
            for own in &self.goals.limits {
                let quantity = quantities[own.of];
                let found = value(quantity)?;
                own.check.write(&own.limited, found, &[], rows);
                self.limited.push((own, found));
                index_or_push(wanted, quantity);
            }
        }
        Ok(())
    }
    /// Writes the slopes of the targets of a quantity, from its gradient with respect to the points of both wheels.
    fn write_slopes(
        &self,
        moved: &Moved<'_>,
        quantity: Quantity,
        by_wheel: [&[Vector3<f64>]; 2],
        into: &mut Option<(&mut Linearisation, usize)>,
    ) {
        let Some((into, first)) = into else {
            return;
        };
        let is_own = |sample: &&&TargetSample| self.layout.quantities[sample.of] == quantity;
        for sample in self.pulling.iter().filter(is_own) {
            let row = *first + sample.row;
            each_slope(moved, by_wheel, |column, slope| {
                into.jacobian[(row, column)] += slope * sample.scale;
            });
        }
    }

    /// Writes the slopes of the limits of a quantity, from its gradient with respect to the points of both wheels. `slopes` is
    /// a workspace.
    fn write_limit_slopes(
        &self,
        moved: &Moved<'_>,
        quantity: Quantity,
        by_wheel: [&[Vector3<f64>]; 2],
        slopes: &mut [f64],
        rows: &mut Option<&mut Linearisation>,
    ) {
        let Some(rows) = rows else {
            return;
        };
        for (own, value) in &self.limited {
            if self.layout.quantities[own.of] == quantity {
                slopes.fill(0.0);
                each_slope(moved, by_wheel, |column, slope| slopes[column] += slope);
                own.check.write(&own.limited, *value, slopes, rows);
            }
        }
    }
}
