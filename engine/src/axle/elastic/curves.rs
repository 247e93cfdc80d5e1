//! Curves of an axle with elastic parts: equilibria at all stations of the motion.

use super::super::places::{motion_columns, place};
use super::super::{Axle, AxleColumn, AxleCurves, AxlePlan};
use super::loads::AxleLoads;
use super::{AxleRead, Equilibria};
use crate::ask::NoValue;
use crate::compliance::{AxleParameter, NoEquilibrium, Parameter};
use crate::curves::{Column, Curves, Sensitivity, Station, Status};
use crate::mechanism::{DesignFault, NoPose};
use crate::model::{Axis, Side};
use crate::study::AxleComplianceStudy;

/// Computes the curves of an axle for a plan. Returns an error if the axle has no elastic model.
pub(in crate::axle) fn curves(
    axle: &Axle,
    elastic: &AxleComplianceStudy,
    plan: &AxlePlan,
) -> Result<AxleCurves, (Side, DesignFault)> {
    let equilibria = axle.own_equilibria(elastic)?;
    // Forces under loads have separate columns here, because elastic parts distribute loads differently from rigid parts.
    let mut columns = plan.columns(axle);
    columns.retain(|column| column.read().is_some());
    let reads: Vec<AxleRead> = columns.iter().filter_map(AxleColumn::read).collect();
    let mut found = Curves {
        motion: motion_columns(&plan.motion, axle),
        columns: columns.iter().map(Column::from).collect(),
        ..Curves::default()
    };
    let loads = AxleLoads::of(axle, elastic, equilibria.axle(), plan);
    found.columns.extend(loads.columns());
    let count = found.columns.len();
    let mut reader = StationReader {
        axle,
        plan,
        equilibria: &equilibria,
        reads,
        columns,
    };
    for (number, placement) in plan.motion.placements().iter().enumerate() {
        let at = place(&plan.motion, axle, (number, placement), None);
        let read = match placement.on_level_pads() {
            Some(place) => reader
                .read(number, place)
                .map(|found| (found, loads.values(place)))
                .map_err(NoPose::from),
            None => Err(NoPose::NoGround),
        };
        let (status, values) = match read {
            Ok(((mut values, sensitivities), forces)) => {
                found.sensitivities.extend(sensitivities);
                let status = if forces.contains(&None) {
                    Status::Unsupported
                } else {
                    Status::Ok
                };
                let forces = forces.into_iter();
                values.extend(forces.map(|force| force.ok_or(NoValue::NotHeld)));
                (status, values)
            }
            Err(why) => {
                let none = vec![Err(NoValue::NoPose); count];
                (Status::Failed(why), none)
            }
        };
        found.stations.push(Station {
            at,
            status,
            values,
            condition: None,
            proof: None,
        });
    }
    Ok(AxleCurves {
        curves: found,
        placed: Vec::new(),
    })
}

/// Printed values of a station, and their derivatives with respect to hardpoints.
type Found = (Vec<Result<f64, NoValue>>, Vec<Sensitivity>);

struct StationReader<'a> {
    axle: &'a Axle,
    plan: &'a AxlePlan,
    equilibria: &'a Equilibria<'a>,
    reads: Vec<AxleRead>,
    columns: Vec<AxleColumn>,
}

impl StationReader<'_> {
    fn read(&mut self, station: usize, at: ([f64; 2], f64)) -> Result<Found, NoEquilibrium> {
        let found = self.equilibria.values(at, &self.reads)?;
        let printed = found.iter().zip(&self.columns).map(|(value, column)| {
            let value = value.map(|value| value * column.factor);
            value.ok_or_else(|| self.undefined(column))
        });
        let values: Vec<_> = printed.collect();
        Ok((values, self.sensitivities(station, at)?))
    }

    /// Reason why a column has no value in an equilibrium.
    fn undefined(&self, column: &AxleColumn) -> NoValue {
        match column.quantity() {
            Some(super::super::Quantity::Corner(_, of)) => NoValue::Undefined(of.undefined_where()),
            _ => NoValue::NotFinite,
        }
    }

    fn sensitivities(
        &mut self,
        station: usize,
        at: ([f64; 2], f64),
    ) -> Result<Vec<Sensitivity>, NoEquilibrium> {
        // Mirror-image wheels move together, and so do the halves of a solid axle: one derivative applies to both sides.
        // Other wheels move independently, with one derivative for each side.
        let sides = match self.axle.right {
            None => &[None][..],
            Some(_) if self.axle.is_rigid() => &[None],
            Some(_) => &[Some(Side::Left), Some(Side::Right)],
        };
        let mut parameters: Vec<AxleParameter> = Vec::new();
        for point in &self.plan.sensitivities {
            for axis in Axis::ALL {
                let parameter = Parameter::Point(*point, axis);
                let of_side = |side: &Option<Side>| AxleParameter {
                    parameter,
                    side: *side,
                };
                parameters.extend(sides.iter().map(of_side));
            }
        }
        let mut found = Vec::new();
        if parameters.is_empty() {
            return Ok(found);
        }
        let values: Vec<usize> = (0..self.reads.len())
            .filter(|k| self.reads[*k].by.is_none())
            .collect();
        let reads: Vec<AxleRead> = values.iter().map(|k| self.reads[*k]).collect();
        let (columns, axle) = (&self.columns, self.axle);
        self.equilibria
            .gradients(at, &reads, &parameters, &mut |k, _, by| {
                let column = values[k];
                let factor = columns[column].factor;
                for (of, by) in parameters.iter().zip(by) {
                    if let Parameter::Point(point, axis) = of.parameter {
                        let frame = axle.suspension(of.side.unwrap_or(Side::Left)).frame;
                        found.push(Sensitivity {
                            station,
                            column,
                            side: of.side,
                            point,
                            axis,
                            value: by * factor * frame.sign(axis),
                        });
                    }
                }
            })?;
        Ok(found)
    }
}
