//! Targets of an axle: rows of the least-squares problem beside those of one wheel.
//!
//! A variable moves the same points of both wheels, each in the frame of its side. So the derivative of a row is the
//! sum of both wheels' gradients along the variable's rates. Where the right wheel has hardpoints of its own they are
//! moved as the mirror images of the left ones are.

use super::elastic_axle::elastic_axle_rows;
use super::layout::{Check, LimitedValue, TargetSample};
use super::moves::{PointRate, moved_design, point_rates};
use super::{Infeasible, Linearisation};
use crate::ask::NoValue;
use crate::axle::{Axle, AxleSolver, Hold, Placement, Quantity};
use crate::evaluate::place_of;
use crate::mechanism::DesignFault;
use crate::number::{Each, Vector3};
use crate::study::{Limited, Optimise, Variable};
use nalgebra::DVector;

/// A position, and the wanted value there.
#[derive(Clone, Debug)]
pub(super) struct AxleStation {
    pub placement: Placement,
    pub samples: Vec<TargetSample>,
    pub limits: Vec<LimitedValue>,
}

/// The targets of an axle, laid out.
#[derive(Clone, Debug)]
pub(super) struct AxleLayout {
    pub axle: Axle,
    pub quantities: Vec<Quantity>,
    pub stations: Vec<AxleStation>,
}

impl AxleLayout {
    /// The targets of an axle; their rows are counted on in `rows`, by target in `own`.
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
                    of: place_of(&mut layout.quantities, sample.quantity),
                    wanted: sample.wanted,
                    scale: 1.0 / target.tolerance,
                };
                layout.station(sample.placement).samples.push(target_sample);
                own[number] += 1;
                *rows += 1;
            }
        }
        layout
    }

    fn station(&mut self, placement: Placement) -> &mut AxleStation {
        let known = self.stations.iter().position(|s| s.placement == placement);
        let place = known.unwrap_or_else(|| {
            self.stations.push(AxleStation {
                placement,
                samples: Vec::new(),
                limits: Vec::new(),
            });
            self.stations.len() - 1
        });
        &mut self.stations[place]
    }

    /// Limits a quantity in a position.
    pub(super) fn limit(
        &mut self,
        part: usize,
        quantity: Quantity,
        limited: &Limited,
        placement: Placement,
    ) {
        let of = place_of(&mut self.quantities, quantity);
        let limited = LimitedValue::new(part, of, limited);
        self.station(placement).limits.push(limited);
    }

    /// Station and part of each limited quantity.
    pub(super) fn limited(&self) -> impl Iterator<Item = (usize, usize)> {
        let stations = self.stations.iter().enumerate();
        stations.flat_map(|(k, station)| station.limits.iter().map(move |own| (k, own.part)))
    }

    /// Gives limited quantities their rows, from part and station.
    pub(super) fn number_rows(&mut self, mut rows: impl FnMut(usize, usize) -> Check) {
        for (k, station) in self.stations.iter_mut().enumerate() {
            for own in &mut station.limits {
                own.check = rows(own.part, k);
            }
        }
    }

    /// Weighs the rows: the residual of each target per deviation in tolerances.
    pub(super) fn weigh(&mut self, shares: &[f64]) {
        for station in &mut self.stations {
            for target_sample in &mut station.samples {
                target_sample.scale *= shares[target_sample.target];
            }
        }
    }

    /// Derivatives by travel and rack that are read, one more where the design moves the travels.
    fn degree(&self) -> usize {
        let orders = self.quantities.iter().map(|q| q.rate_order());
        let on_plane = |s: &AxleStation| s.placement.hold() != Hold::TravelsOnPads;
        orders.max().unwrap_or(0) + usize::from(self.stations.iter().any(on_plane))
    }
}

/// A design moved by its variables.
pub(super) struct Moved<'m> {
    /// The variables.
    pub variables: &'m [Variable],
    /// Values of the variables.
    pub x: &'m DVector<f64>,
    /// The left wheel's design.
    pub design: &'m [Vector3<f64>],
    /// The ways in which the variables move its points.
    pub point_rates: &'m [PointRate],
}

/// Residuals and their derivatives.
pub(super) trait RowsBeside: Send {
    /// Writes the rows of all its targets, and those of its constraints into `rows`, if given.
    fn evaluate(
        &mut self,
        moved: &Moved<'_>,
        into: &mut Linearisation,
        rows: Option<&mut Linearisation>,
    ) -> Result<(), Infeasible>;
}

/// The rows of a layout.
pub(super) fn axle_rows<'a>(
    layout: &'a AxleLayout,
    variables: &[Variable],
) -> Result<Box<dyn RowsBeside + 'a>, DesignFault> {
    fn rows<'a, const N: usize>(
        layout: &'a AxleLayout,
    ) -> Result<Box<dyn RowsBeside + 'a>, DesignFault> {
        let solver = AxleSolver::<N>::new(&layout.axle, &layout.quantities, false);
        Ok(Box::new(Rows {
            layout,
            solver: solver.map_err(|(_, fault)| fault)?,
            right: Vec::new(),
            right_rates: Vec::new(),
            wanted: Vec::new(),
        }))
    }
    if let Some(elastic) = &layout.axle.elastic {
        return Ok(elastic_axle_rows(layout, elastic, variables));
    }
    match layout.degree() {
        0 => rows::<1>(layout),
        1 => rows::<2>(layout),
        2 => rows::<3>(layout),
        _ => rows::<4>(layout),
    }
}

struct Rows<'a, const N: usize> {
    layout: &'a AxleLayout,
    solver: AxleSolver<'a, N>,
    /// Design and ways of the right wheel, if it has hardpoints of its own.
    right: Vec<Vector3<f64>>,
    right_rates: Vec<PointRate>,
    wanted: Vec<Quantity>,
}

impl<const N: usize> RowsBeside for Rows<'_, N> {
    fn evaluate(
        &mut self,
        moved: &Moved<'_>,
        into: &mut Linearisation,
        _rows: Option<&mut Linearisation>,
    ) -> Result<(), Infeasible> {
        let Rows {
            layout,
            solver,
            right,
            right_rates,
            wanted,
        } = self;
        let AxleLayout {
            axle, quantities, ..
        } = *layout;
        let frame = &axle.left.frame;
        let mut sides = [(moved.design, moved.point_rates); 2];
        if let Some(own) = &axle.right {
            right.clone_from(&own.design);
            moved_design(&own.design, frame, moved.variables, moved.x, right);
            point_rates(&own.design, frame, moved.variables, moved.x, right_rates);
            sides[1] = (right, right_rates);
        }
        solver
            .prepare(sides.each(|(design, _)| design))
            .map_err(|fault| Infeasible::Refused(axle.describe_fault(fault)))?;
        let placements: Vec<Placement> = layout.stations.iter().map(|s| s.placement).collect();
        let placed = solver.place_all(&placements);
        let mut pulling: Vec<&TargetSample> = Vec::new();
        for (station, placed) in layout.stations.iter().zip(placed) {
            let AxleStation {
                placement, samples, ..
            } = station;
            let unreached = |failure| {
                Infeasible::Refused(format!("the axle does not reach {placement}: {failure}"))
            };
            let placed = placed.map_err(unreached)?;
            let read = solver.read(&placed).map_err(unreached)?;
            wanted.clear();
            pulling.clear();
            for target_sample in samples {
                let quantity = quantities[target_sample.of];
                if read.is_stuck(quantity) {
                    let name = quantity.name();
                    let why = NoValue::Toggle.reason();
                    return Err(Infeasible::Refused(format!("{name} at {placement}: {why}")));
                }
                let found = quantity.value(&read.state).map_err(|void| {
                    let (name, why) = (quantity.name(), void.reason());
                    Infeasible::Refused(format!("{name} has no value at {placement}: {why}"))
                })?;
                if target_sample.write_residual(target_sample.row, found, into) {
                    into.jacobian.row_mut(target_sample.row).fill(0.0);
                    pulling.push(target_sample);
                    if !wanted.contains(&quantity) {
                        wanted.push(quantity);
                    }
                }
            }
            let receive = |number: usize, [left, right]: [&[Vector3<f64>]; 2]| {
                let own = |sample: &&&TargetSample| quantities[sample.of] == wanted[number];
                for sample in pulling.iter().filter(own) {
                    for ((_, point_rates), gradient) in sides.iter().zip([left, right]) {
                        for rate in *point_rates {
                            let slope = gradient[rate.point].dot(rate.by);
                            into.jacobian[(sample.row, rate.column)] += slope * sample.scale;
                        }
                    }
                }
            };
            solver
                .gradients(&placed, wanted, receive)
                .map_err(unreached)?;
        }
        Ok(())
    }
}
