//! Curves of a wheel with elastic parts: equilibria over travel and rack, without horizontal loads.

use super::elastic_loads::ElasticLoads;
use super::run::{motion, place};
use super::{Column, Curves, Sensitivity, Station, Status};
use crate::ask::NoValue;
use crate::characteristics::{Characteristic, Quantity};
use crate::compliance::{KcRun, KcValue, NoEquilibrium, Parameter, sign_of_figure};
use crate::mechanism::DesignFault;
use crate::model::{Axis, LengthUnit, PointId, Suspension};
use crate::number::Each;
use crate::plan::Plan;
use crate::study::{ComplianceStudy, ElasticFigure};

/// Value that a column shows, and the reason to report if this value does not exist.
struct Read {
    value: KcValue,
    undefined: NoValue,
}

/// Columns of a plan's characteristics, then of its test results, each with the value that it shows.
fn columns(length: LengthUnit, plan: &Plan) -> Vec<(Column, Read)> {
    let mut found = Vec::new();
    for column in Column::all(plan, length) {
        let of: Option<Characteristic> =
            column.of.and_then(|of| match plan.outputs[of].quantity() {
                Some(Quantity::Characteristic(of)) => Some(of),
                _ => None,
            });
        let Some(of) = of else { continue };
        let value = match column.order {
            0 => KcValue::Wheel(of),
            _ => KcValue::WheelRate(of),
        };
        let undefined = NoValue::Undefined(of.undefined_where());
        found.push((column, Read { value, undefined }));
    }
    found.extend(plan.figures.iter().map(|figure| {
        let column = figure.as_column(length);
        let read = Read {
            value: figure.value,
            undefined: NoValue::NotFinite,
        };
        (column, read)
    }));
    found
}

impl ElasticFigure {
    /// Returns the test result as a column of results.
    pub(crate) fn as_column(&self, length: LengthUnit) -> Column {
        let (suffix, factor) = (self.unit.suffix(length), self.unit.printed_factor(length));
        Column::of_value(
            self.name.clone(),
            suffix,
            sign_of_figure(&self.name),
            factor,
        )
    }
}

/// Curves of a wheel with elastic parts that a plan requests. An error says why the design has no elastic model.
pub(super) fn elastic_curves(
    suspension: &Suspension,
    elastic: &ComplianceStudy,
    plan: &Plan,
) -> Result<Curves, DesignFault> {
    let run = KcRun::new(suspension, &elastic.parts, elastic.tyre_rate)
        .map_err(|fault| fault.of_design())?;
    let (columns, reads): (Vec<Column>, Vec<Read>) =
        columns(suspension.length_unit, plan).into_iter().unzip();
    let wanted: Vec<KcValue> = reads.iter().map(|read| read.value).collect();
    let points = plan.sensitivities.iter();
    let inputs = points.flat_map(|point| Axis::ALL.each(|axis| (*point, axis)));
    let inputs: Vec<(PointId, Axis)> = inputs.collect();
    let parameters: Vec<Parameter> = inputs
        .iter()
        .map(|(point, axis)| Parameter::Point(*point, *axis))
        .collect();
    let loads = ElasticLoads::of(suspension, &elastic.parts, run.wheel(), &plan.loads);
    let mut curves = Curves {
        motion: motion(plan, suspension.length_unit.symbol()),
        columns: columns.into_iter().chain(loads.columns()).collect(),
        ..Curves::default()
    };
    for rack in &plan.racks {
        for (number, travel) in plan.station_order.values().iter().enumerate() {
            let at = [*travel, *rack];
            let found = values_and_gradients(&run, at, &wanted, &parameters);
            let (status, values, gradients) = match found {
                Ok((values, gradients)) => (Status::Ok, values, gradients),
                Err(why) => (Status::Failed(why.into()), Vec::new(), Vec::new()),
            };
            let missing = |read: &Read| match status {
                Status::Ok => read.undefined,
                _ => NoValue::NoPose,
            };
            let cells = reads.iter().enumerate().map(|(k, read)| {
                let value = values.get(k).copied().flatten();
                let printed = value.map(|value| value * curves.columns[k].factor());
                printed.ok_or_else(|| missing(read))
            });
            let mut values: Vec<_> = cells.collect();
            let status = loads.add_values(at, status, &mut values);
            let station = curves.stations.len();
            for (column, by) in gradients {
                let factor = curves.columns[column].factor();
                let slopes = inputs.iter().zip(by);
                let slope = |((point, axis), by): (&(PointId, Axis), f64)| Sensitivity {
                    station,
                    column,
                    side: None,
                    point: *point,
                    axis: *axis,
                    value: by * factor * suspension.frame.sign(*axis),
                };
                curves.sensitivities.extend(slopes.map(slope));
            }
            curves.stations.push(Station {
                at: place(plan, number, *travel, *rack),
                status,
                values,
                condition: None,
                proof: None,
            });
        }
    }
    Ok(curves)
}

/// Values of a station, and derivatives of the existing values with respect to `parameters`, each with the index of its
/// value.
type ValuesAndGradients = (Vec<Option<f64>>, Vec<(usize, Vec<f64>)>);

/// Values at a travel and a rack displacement, with their derivatives with respect to `parameters`.
fn values_and_gradients(
    run: &KcRun,
    at: [f64; 2],
    wanted: &[KcValue],
    parameters: &[Parameter],
) -> Result<ValuesAndGradients, NoEquilibrium> {
    if parameters.is_empty() {
        return Ok((run.values(at, wanted)?, Vec::new()));
    }
    let (mut values, mut gradients) = (vec![None; wanted.len()], Vec::new());
    run.gradients(at, wanted, parameters, &mut |found| {
        values[found.number] = found.value;
        if found.value.is_some() {
            gradients.push((found.number, found.by.to_vec()));
        }
    })?;
    Ok((values, gradients))
}
