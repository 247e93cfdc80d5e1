//! Targets of an axle with elastic parts: rows of the least-squares problem. Equilibria and simulated tests of the axle give
//! their values.
//!
//! A variable moves the points of both wheels. It also moves rates of parts of both wheels, or of a shared part. If the
//! wheels are mirror images, one derivative applies to both; otherwise each wheel has a separate derivative. In a build, each
//! wheel also has separate rates.

use super::axle::{AxleLayout, Moved, RowsBeside};
use super::elastic::along_variables;
use super::{Infeasible, Linearisation};
use crate::axle::{Axle, AxleRead, Placement};
use crate::compliance::{AxleCompliance, AxleParameter, Parameter};
use crate::evaluate::index_or_push;
use crate::mechanism::NoPose;
use crate::model::{Axis, PointId, Side};
use crate::number::Each;
use crate::study::{AxleComplianceStudy, Variable};

/// Makes the evaluator of the residuals and constraints that the layout lists, for an axle with elastic parts. The variables
/// move `points`.
pub(super) fn elastic_axle_rows<'a>(
    layout: &'a AxleLayout,
    axle: &'a Axle,
    elastic: &'a AxleComplianceStudy,
    points: &[PointId],
    variables: &[Variable],
) -> Box<dyn RowsBeside + 'a> {
    let sides = match axle.right {
        None => vec![None],
        Some(_) => vec![Some(Side::Left), Some(Side::Right)],
    };
    let mut parameters = Vec::new();
    for side in &sides {
        for point in points {
            parameters.extend(Axis::ALL.map(|axis| AxleParameter {
                parameter: Parameter::Point(*point, axis),
                side: *side,
            }));
        }
    }
    for rate in variables.iter().filter_map(|v| v.rate.as_ref()) {
        let parameter = rate.parameter;
        if elastic.parts.is_shared(parameter) {
            index_or_push(&mut parameters, parameter.into());
            continue;
        }
        for side in &sides {
            let side = *side;
            index_or_push(&mut parameters, AxleParameter { parameter, side });
        }
    }
    Box::new(Rows {
        layout,
        axle,
        elastic,
        sides,
        parameters,
        parts: elastic.parts.clone(),
        slopes: vec![0.0; variables.len()],
    })
}

struct Rows<'a> {
    layout: &'a AxleLayout,
    axle: &'a Axle,
    elastic: &'a AxleComplianceStudy,
    /// Wheels with separate moving points and rates: both wheels, or only one item `None` if the wheels are mirror images.
    sides: Vec<Option<Side>>,
    /// Coordinates and rates that the variables move.
    parameters: Vec<AxleParameter>,
    parts: AxleCompliance,
    slopes: Vec<f64>,
}

/// Makes the error for a position of the axle that is not on level pads. Axles with elastic parts support level pads only.
fn for_rigid_axles_only(placement: Placement, unit: &str) -> Infeasible {
    Infeasible::Refused(format!(
        "this position is available only for axles without elastic parts: {placement} ({unit})"
    ))
}

impl RowsBeside for Rows<'_> {
    fn evaluate(
        &mut self,
        moved: &Moved<'_>,
        mut into: Option<(&mut Linearisation, usize)>,
        mut rows: Option<&mut Linearisation>,
    ) -> Result<(), Infeasible> {
        let Rows {
            layout,
            axle,
            elastic,
            sides,
            parameters,
            parts,
            slopes,
        } = self;
        parts.clone_from(&elastic.parts);
        moved.set_rates(parts, AxleCompliance::set_rate, AxleCompliance::change_rate)?;
        let equilibria = axle.equilibria(moved.wheels.each(|(design, _)| design), parts);
        let equilibria = equilibria
            .map_err(|(side, fault)| Infeasible::Refused(axle.describe_fault((side, fault))))?;
        let unit = axle.left.length_unit.symbol();
        for station in &layout.stations {
            let placement = &station.placement;
            let used = station.goals.used(into.is_some(), rows.is_some());
            if used.is_empty() {
                continue;
            }
            let at = placement.on_level_pads();
            let at = at.ok_or_else(|| for_rigid_axles_only(*placement, unit))?;
            let reads = used.iter().map(|k| layout.quantities[*k].into());
            let reads: Vec<AxleRead> = reads.collect();
            let mut is_found = vec![false; used.len()];
            let mut receive = |number: usize, value: f64, by: &[f64]| {
                is_found[number] = true;
                let by = |parameter: AxleParameter| {
                    let place = parameters.iter().position(|p| *p == parameter);
                    place.map_or(0.0, |place| by[place])
                };
                along_variables(moved, sides, by, slopes);
                let goals = &station.goals;
                goals.write(used[number], value, slopes, &mut into, &mut rows);
            };
            let found = if moved.variables.is_empty() {
                // Without variables, a build is only evaluated, so it needs no derivatives.
                equilibria.values(at, &reads).map(|values| {
                    let found = values.into_iter().enumerate();
                    found
                        .filter_map(|(number, value)| Some((number, value?)))
                        .for_each(|(number, value)| receive(number, value, &[]));
                })
            } else {
                equilibria.gradients(at, &reads, parameters, &mut receive)
            };
            if let Err(why) = found {
                let why = NoPose::from(why);
                let message = format!("the axle has no equilibrium at {placement} ({unit}): {why}");
                return Err(Infeasible::Refused(message));
            }
            if let Some(missing) = is_found.iter().position(|found| !found) {
                let name = reads[missing].quantity.name();
                let message = format!("{name} has no value at {placement} ({unit})");
                return Err(Infeasible::Refused(message));
            }
        }
        Ok(())
    }
}
