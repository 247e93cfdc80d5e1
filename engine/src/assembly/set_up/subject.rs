//! Assembled parts of a set-up, their static values, and the derivatives of these values with respect to each
//! adjustment.
//!
//! A wheel is assembled separately. The module `elastic` handles suspensions with elastic parts. A solid axle is
//! assembled as a whole, once as seen from each of its wheels (`RigidAxle`). A value y of the axle then has gradients
//! with respect to the built designs p_l and p_r of both views. With x the amount of an adjustment,
//!
//! ```text
//! dy/dx = (dy/dp_l) (dp_l/dx) + (dy/dp_r) (dp_r/dx)                                          (8)
//! ```
//!
//! Position and direction of the axle itself are measured from the nominal design, not from the built one. They follow
//! from the pose in which the parts were assembled. The derivative of this pose is exact.

use super::elastic::Elastic;
use super::{AdjustedSuspension, SetUpError};
use crate::assembly::assembler::Assembler;
use crate::assembly::derivatives::built_curves;
use crate::assembly::parts::BuildParameter;
use crate::assembly::rest::{Built, Direction, Rest};
use crate::axle::{Axle, AxlePlan, FROM_DESIGN, Quantity, place_of};
use crate::characteristics::Characteristic;
use crate::evaluate::{AxleStations, Evaluated, Request};
use crate::model::{Side, Suspension};
use crate::number::Each;
use crate::plan::Plan;
use crate::study::{Adjustment, AxleStudy, Outputs, WheelStudy};
use std::borrow::Cow;

/// Dimensions that an adjustment changes in one assembled mechanism, each with its factor. Empty if the adjustment
/// changes no dimension of this mechanism.
pub(super) type Change = Vec<(BuildParameter, f64)>;

/// A suspension to set up.
pub(super) enum Subject<'a> {
    /// One wheel.
    Wheel {
        assembler: &'a Assembler,
        changes: Vec<Change>,
        plan: Box<Plan>,
    },
    /// A solid axle.
    Axle(Box<WholeAxle<'a>>),
    /// A wheel or an axle with elastic parts.
    Elastic(Box<Elastic<'a>>),
}

/// Mechanisms of a solid axle as seen from its left and from its right wheel, in this order.
pub(super) struct WholeAxle<'a> {
    assemblers: [&'a Assembler; 2],
    changes: [Vec<Change>; 2],
    quantities: Vec<Quantity>,
    /// Request for the quantities that are computed on the built design. It excludes those in [`FROM_DESIGN`], which are measured
    /// from the nominal design.
    request: Request<'static>,
}

impl<'a> Subject<'a> {
    /// Makes the subject of one wheel with these characteristics.
    pub(super) fn wheel(
        assembler: &'a Assembler,
        adjust: &[Adjustment],
        characteristics: Vec<Characteristic>,
    ) -> Self {
        let mut at_rest = WheelStudy::of(assembler.suspension().clone());
        at_rest.outputs = Outputs::of(characteristics);
        Subject::Wheel {
            assembler,
            changes: adjust.iter().map(|a| vec![a.change]).collect(),
            plan: Box::new(Plan::of(&at_rest)),
        }
    }

    /// Makes the subject of a solid axle with these quantities.
    pub(super) fn axle(
        assemblers: [&'a Assembler; 2],
        both: &AxleStudy,
        adjust: &[Adjustment],
        quantities: Vec<Quantity>,
    ) -> Self {
        let drawn = |side: Side| assemblers[side as usize].suspension().clone();
        let axle = Axle {
            left: drawn(Side::Left),
            right: Some(drawn(Side::Right)),
            setup: both.axle.setup.clone(),
            elastic: None,
        };
        let of_design = quantities.iter().copied();
        let of_design = of_design.filter(|quantity| from_design(*quantity).is_none());
        let plan = AxlePlan::of(both.plan.motion.at_design(), of_design.collect());
        let mut stations = AxleStations::of(Cow::Owned(axle), &plan, []);
        stations.of_builds = true;
        let seen = |side: Side| adjust.iter().map(|a| a.seen_from(side)).collect();
        Subject::Axle(Box::new(WholeAxle {
            assemblers,
            changes: Side::ALL.map(seen),
            quantities,
            request: Request::of_axle(stations),
        }))
    }

    /// The nominal suspension.
    pub(super) fn suspension(&self) -> &Suspension {
        match self {
            Subject::Wheel { assembler, .. } => assembler.suspension(),
            Subject::Axle(axle) => axle.assemblers[0].suspension(),
            Subject::Elastic(elastic) => elastic.suspension(),
        }
    }

    /// Returns the state of the parts assembled with these amounts of the adjustments.
    pub(super) fn state(
        &self,
        amounts: &[f64],
        rest: Rest,
    ) -> Result<AdjustedSuspension, SetUpError> {
        match self {
            Subject::Wheel {
                assembler,
                changes,
                plan,
            } => state_of_wheel((assembler, plan), changes, amounts, rest),
            Subject::Axle(axle) => axle.state(amounts, rest),
            Subject::Elastic(elastic) => elastic.state(amounts, rest),
        }
    }
}

/// Index in [`FROM_DESIGN`] of a quantity that is measured from the nominal design.
pub(super) fn from_design(quantity: Quantity) -> Option<usize> {
    let mut all = FROM_DESIGN.into_iter();
    all.position(|own| Quantity::Axle(own) == quantity)
}

/// Changes the parts by these amounts of the adjustments, and assembles them.
pub(super) fn build(
    assembler: &Assembler,
    changes: &[Change],
    amounts: &[f64],
    rest: Rest,
) -> Result<Built, SetUpError> {
    let mut parts = assembler.drawn().clone();
    for (changes, amount) in changes.iter().zip(amounts) {
        for (parameter, share) in changes {
            let mechanism = &assembler.suspension().mechanism;
            parts.change(mechanism, *parameter, share * amount);
        }
    }
    Ok(assembler.build(&parts, rest)?)
}

fn state_of_wheel(
    (assembler, plan): (&Assembler, &Plan),
    changes: &[Change],
    amounts: &[f64],
    rest: Rest,
) -> Result<AdjustedSuspension, SetUpError> {
    let built = build(assembler, changes, amounts, rest)?;
    let directions: Vec<&Direction> = changes.iter().map(|d| &d[..]).collect();
    let found = built_curves(assembler, &built, plan, &directions)?;
    let values = found.curves.stations[0].values.iter();
    let values = values.map(|v| v.unwrap_or(f64::NAN));
    let columns = found.curves.columns.len();
    // The car rises by the same amount by which the wheel falls. The form 0 - x avoids a negative zero.
    let change = 0.0 - built.height;
    Ok(AdjustedSuspension {
        amounts: amounts.to_vec(),
        values: values.chain([change]).collect(),
        by: (0..directions.len())
            .map(|d| {
                let by = (0..columns).map(|column| found.derivative(d, 0, column));
                by.chain([0.0 - found.height[d]]).collect()
            })
            .collect(),
        built,
        seen_from_right: None,
    })
}

impl WholeAxle<'_> {
    fn state(&self, amounts: &[f64], rest: Rest) -> Result<AdjustedSuspension, SetUpError> {
        let of_side =
            |side: usize| build(self.assemblers[side], &self.changes[side], amounts, rest);
        let built = [of_side(0)?, of_side(1)?];
        let evaluator = self.request.gradients(&[], None);
        let mut evaluator = evaluator.map_err(|(_, fault)| SetUpError::Fault(fault))?;
        let mut found = Evaluated::default();
        let designs = built.each_ref().each(|built| &built.suspension.design[..]);
        evaluator.evaluate(designs, &mut found);
        if let Some(fault) = found.fault(0) {
            return Err(SetUpError::Fault(fault.clone()));
        }
        let drawn = self.values(&built, None, &found);
        let by = (0..amounts.len()).map(|k| {
            let slopes = self.values(&built, Some(k), &found);
            // No adjustment of a solid axle lifts the car.
            slopes.chain([0.0]).collect()
        });
        let by = by.collect();
        let values = drawn.chain([0.0 - built[0].height]).collect();
        let [built, seen_from_right] = built;
        Ok(AdjustedSuspension {
            amounts: amounts.to_vec(),
            values,
            by,
            built,
            seen_from_right: Some(seen_from_right),
        })
    }

    /// Returns the printed values, or their derivatives with respect to an adjustment.
    fn values<'s>(
        &'s self,
        built: &[Built; 2],
        adjustment: Option<usize>,
        found: &'s Evaluated,
    ) -> impl Iterator<Item = f64> + 's {
        let change = |side: usize| adjustment.map_or(&[][..], |k| &self.changes[side][k]);
        let moves = [0, 1].map(|side| {
            let (moves, _) = self.assemblers[side].design_by(&built[side], change(side));
            moves
        });
        let place = self.assemblers[0].axle_by(&built[0], change(0));
        let place = place.map(|(rotation, displacement)| place_of(&rotation, displacement));
        let mut of_design = 0..;
        self.quantities.iter().map(move |quantity| {
            let value = match from_design(*quantity) {
                Some(number) => place.map_or(f64::NAN, |place| match adjustment {
                    None => place[number].value,
                    Some(_) => place[number].partials[0],
                }),
                None => {
                    let cell = (0, of_design.next().unwrap_or_default(), 0);
                    if adjustment.is_some() {
                        let sides = Side::ALL.into_iter().zip(&moves);
                        let along = sides.map(|(side, moves)| found.along(cell, side, moves));
                        along.sum()
                    } else {
                        found.value(cell.0, cell.1, cell.2)
                    }
                }
            };
            let length = self.assemblers[0].suspension().length_unit;
            value * quantity.info().unit.printed_factor(length)
        })
    }
}
