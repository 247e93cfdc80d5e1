//! Suspensions with elastic parts: static values of the equilibrium at rest, and their derivatives with respect to
//! each adjustment.
//!
//! The adjusted parts are assembled without load, like builds ([`crate::assembly`]). The assembled position is the design
//! of the elastic suspension. In this position the elastic parts are free of force, or have the forces of the design
//! load. Both wheels of an axle are in equilibrium together. The wheel centres stay at the height h of the assembled
//! parts. With p the built designs, x the amount of an adjustment and y a value in equilibrium,
//!
//! ```text
//! dy/dx = dy/dp (dp/dx + dp/dh dh/dx)                                                        (9)
//! ```
//!
//! Adjustments do not change the springs ([`SpringLaw::kept_from`]), so the force of a spring depends only on its length
//! l. Usually the study gives h. If an adjustment lifts the car instead, the spring keeps the length and the force of the
//! nominal equilibrium:
//!
//! ```text
//! dh/dx = -(dl/dp dp/dx)/(dl/dp dp/dh)                                                       (10)
//! ```
//!
//! A solid axle is assembled as a whole, once as seen from each of its wheels. The position and direction of the axle are
//! measured from the nominal design. Relative to the nominal design, the assembled axle is rotated by R and displaced by
//! d. In equilibrium the axle is rotated by Q and displaced by u from the assembled position. Together, rotation and
//! displacement are
//! ```text
//! Q R,   d + u                                                                               (11)
//! ```
//!
//! The parts of an axle on five links cause tensions T in the links. These tensions are further inputs, so dy/dx contains
//! the additional term (dy/dT) (dT/dx).
//!
//! [`SpringLaw::kept_from`]: crate::axle::SpringLaw::kept_from

use super::subject::{Change, build, from_design};
use super::{AdjustedSuspension, SetUpError};
use crate::ask::Unit;
use crate::assembly::assembler::Assembler;
use crate::assembly::least_energy::{TensionInput, tension_inputs};
use crate::assembly::rest::{Built, Rest, settle_height};
use crate::axle::{Axle, AxleQuantity, AxleRead, FROM_DESIGN, Quantity, place_of};
use crate::characteristics::Characteristic;
use crate::compliance::{AxleParameter, KcRun, KcValue, NoEquilibrium, Parameter};
use crate::mechanism::NoPose;
use crate::model::{Axis, PointId, Side, Suspension};
use crate::number::{Dual, Each, Matrix3, Vector3};
use crate::study::{Adjustment, ComplianceStudy};

/// A wheel or an axle with elastic parts.
pub(super) struct Elastic<'a> {
    /// One wheel, or the left and the right one.
    wheels: Vec<Half<'a>>,
    reads: Reads,
    /// Factor of each value from the kernel's unit (length unit, rad) to the printed unit.
    factors: Vec<f64>,
    /// Length that the spring keeps if an adjustment lifts the car. `None` if no adjustment lifts it, or if the study
    /// gives no spring force. If it is `Some`, the spring's length follows after the other values.
    kept: Option<f64>,
    /// True if the right wheel is the mirror image of the left wheel and has the same adjustments. False for one wheel.
    is_mirrored: bool,
    /// Tensions that the parts of a solid axle cause in its links.
    tensions: Vec<TensionInput>,
}

/// A wheel with its adjustments.
struct Half<'a> {
    assembler: &'a Assembler,
    changes: Vec<Change>,
}

/// Kind of equilibrium from which the values are read.
enum Reads {
    Wheel(Box<ComplianceStudy>, Vec<KcValue>),
    Axle(Box<Axle>, Vec<AxleRead>),
}

/// Values in an equilibrium, each with its derivatives. The derivatives are with respect to the coordinates of all
/// points, wheel after wheel, and to the tensions of links.
struct Found {
    values: Vec<f64>,
    by: Vec<Vec<f64>>,
    /// Rotation of a solid axle from the assembled position.
    rotation: Option<Matrix3<f64>>,
}

/// Derivatives of the positions of all points of each wheel, and of the tensions of links. They are with respect to one variable:
/// an adjustment or the height of the wheel centres.
struct Moves {
    points: Vec<Vec<Vector3<f64>>>,
    tensions: Vec<f64>,
}

impl Found {
    fn of(count: usize) -> Self {
        Found {
            values: vec![f64::NAN; count],
            by: vec![Vec::new(); count],
            rotation: None,
        }
    }

    /// Returns the change of the value with index `number`, for these changes of points and tensions. NaN if the value has no
    /// derivatives.
    fn along(&self, number: usize, moves: &Moves) -> f64 {
        if self.by[number].is_empty() {
            return f64::NAN;
        }
        let by = &self.by[number];
        let (by_points, by_tensions) = by.split_at(by.len() - moves.tensions.len());
        let points = moves.points.iter().flatten();
        let pairs = points.zip(by_points.chunks_exact(3));
        let of_points = pairs.map(|(way, by)| way.x * by[0] + way.y * by[1] + way.z * by[2]);
        let tensions = moves.tensions.iter().zip(by_tensions);
        of_points.chain(tensions.map(|(t, by)| t * by)).sum()
    }
}

impl From<NoEquilibrium> for SetUpError {
    fn from(why: NoEquilibrium) -> Self {
        SetUpError::NoEquilibrium(NoPose::from(why))
    }
}

impl<'a> Elastic<'a> {
    /// Makes the set-up of one wheel with elastic parts, for these static values. `lifts` is true if an adjustment lifts
    /// the car.
    pub(super) fn wheel(
        assembler: &'a Assembler,
        elastic: &ComplianceStudy,
        adjust: &[Adjustment],
        characteristics: &[Characteristic],
        lifts: bool,
    ) -> Result<Self, SetUpError> {
        let suspension = assembler.suspension();
        let elastic = elastic.with_kept_spring(suspension);
        let mut values: Vec<KcValue> = characteristics
            .iter()
            .copied()
            .map(KcValue::Wheel)
            .collect();
        let keeps = lifts && elastic.parts.spring.is_some();
        if keeps {
            values.push(KcValue::Wheel(Characteristic::SpringLength));
        }
        let units = characteristics.iter().map(|c| c.info().unit);
        let half = Half {
            assembler,
            changes: adjust.iter().map(|a| vec![a.change]).collect(),
        };
        Elastic {
            factors: factors(units, suspension),
            wheels: vec![half],
            reads: Reads::Wheel(Box::new(elastic), values),
            tensions: Vec::new(),
            kept: None,
            is_mirrored: false,
        }
        .keeping(keeps)
    }

    /// Makes the set-up of an axle with elastic parts, for these static values. Adjustments without a side act on both
    /// wheels of an axle with independent wheels.
    pub(super) fn axle(
        assemblers: [&'a Assembler; 2],
        nominal: &Axle,
        adjust: &[Adjustment],
        quantities: &[Quantity],
        lifts: bool,
    ) -> Result<Self, SetUpError> {
        let mut axle = nominal.clone();
        let [left, right] = assemblers.map(|assembler| assembler.suspension().clone());
        (axle.left, axle.right) = (left, Some(right));
        let axle = axle.with_kept_springs();
        let keeps = lifts && axle.setup.springs.is_some();
        let mut reads: Vec<AxleRead> = quantities.iter().copied().map(AxleRead::from).collect();
        if keeps {
            let length = Quantity::Corner(Side::Left, Characteristic::SpringLength);
            reads.push(length.into());
        }
        let units = quantities.iter().map(|quantity| quantity.info().unit);
        let halves = Side::ALL.into_iter().zip(assemblers);
        let is_solid = axle.is_rigid();
        let halves = halves.map(|(side, assembler)| {
            let change = |a: &Adjustment| {
                if is_solid {
                    a.seen_from(side)
                } else {
                    let own = a.is_of(Some(side)).then_some(a.change);
                    own.into_iter().collect()
                }
            };
            Half {
                assembler,
                changes: adjust.iter().map(change).collect(),
            }
        });
        let tensions = tension_inputs(&axle);
        Elastic {
            wheels: halves.collect(),
            factors: factors(units, &axle.left),
            is_mirrored: !is_solid && adjust.iter().all(|a| a.side.is_none()),
            reads: Reads::Axle(Box::new(axle), reads),
            tensions,
            kept: None,
        }
        .keeping(keeps)
    }

    /// If `keeps` is true, stores the spring's length in the nominal equilibrium as the length to keep.
    fn keeping(mut self, keeps: bool) -> Result<Self, SetUpError> {
        if keeps {
            let none = vec![0.0; self.wheels[0].changes.len()];
            let (_, found) = self.at(&none, Rest::Height(0.0))?;
            self.kept = found.values.last().copied();
        }
        Ok(self)
    }

    /// The nominal suspension of the wheel, or of the left wheel of an axle.
    pub(super) fn suspension(&self) -> &Suspension {
        self.wheels[0].assembler.suspension()
    }

    /// Assembles the parts with these amounts of the adjustments, and finds their equilibrium.
    pub(super) fn state(
        &self,
        amounts: &[f64],
        rest: Rest,
    ) -> Result<AdjustedSuspension, SetUpError> {
        let lifted = self.kept.filter(|_| matches!(rest, Rest::Spring(_)));
        let (mut built, found) = match lifted {
            Some(length) => self.settle(amounts, length)?,
            None => self.at(amounts, rest)?,
        };
        let spring = self.factors.len();
        let by_height = lifted.map(|_| self.by_height(&built));
        let by = (0..amounts.len()).map(|k| {
            let (moves, mut rise) = self.by_adjustment(&built, k);
            if let Some(by_height) = &by_height {
                rise = -found.along(spring, &moves) / found.along(spring, by_height);
            }
            let slope = |number: usize| {
                let own = found.along(number, &moves);
                match &by_height {
                    Some(by_height) => own + rise * found.along(number, by_height),
                    None => own,
                }
            };
            let placed = self.placed(&built, &found, Some(k));
            let slopes = self.factors.iter().enumerate();
            let slopes = slopes.map(|(number, factor)| factor * (slope(number) + placed[number]));
            // The car rises by the same amount by which the wheel falls. The form 0 - x avoids a negative zero.
            slopes.chain([0.0 - rise]).collect()
        });
        let by = by.collect();
        let placed = self.placed(&built, &found, None);
        let values = found.values.iter().zip(placed);
        let values = values.zip(&self.factors);
        let values = values.map(|((value, placed), factor)| (value + placed) * factor);
        let values = values.chain([0.0 - built[0].height]).collect();
        let right = (built.len() > 1).then(|| built.swap_remove(1));
        Ok(AdjustedSuspension {
            amounts: amounts.to_vec(),
            values,
            by,
            built: built.swap_remove(0),
            seen_from_right: right.filter(|_| !self.is_mirrored),
        })
    }

    /// Assembles parts, and computes their values in equilibrium.
    fn at(&self, amounts: &[f64], rest: Rest) -> Result<(Vec<Built>, Found), SetUpError> {
        let built = self.wheels.iter();
        let built = built.map(|half| build(half.assembler, &half.changes, amounts, rest));
        let built: Vec<Built> = built.collect::<Result<_, _>>()?;
        let found = self.evaluate(&built)?;
        Ok((built, found))
    }

    /// Finds the height at which the spring has a given length in equilibrium, by Newton steps with the derivative in equation (10)
    /// of this module. Starts from the height of the rigid mechanism.
    fn settle(&self, amounts: &[f64], length: f64) -> Result<(Vec<Built>, Found), SetUpError> {
        let Half { assembler, changes } = &self.wheels[0];
        let height = build(assembler, changes, amounts, Rest::Spring(0.0))?.height;
        let mut at = self.at(amounts, Rest::Height(height))?;
        let spring = self.factors.len();
        let step = |(built, found): &(Vec<Built>, Found)| -> Result<f64, SetUpError> {
            let slope = found.along(spring, &self.by_height(built));
            Ok((length - found.values[spring]) / slope)
        };
        let place = |at: &mut (Vec<Built>, Found), height: f64| -> Result<(), SetUpError> {
            *at = self.at(amounts, Rest::Height(height))?;
            Ok(())
        };
        let size = assembler.suspension().size();
        settle_height(&mut at, height, size, step, place)?;
        Ok(at)
    }

    /// Returns the derivatives of all points with respect to the height of the wheel centres, for unchanged parts.
    /// Tensions have zero derivatives, because no adjustment lifts an axle whose links have tensions.
    fn by_height(&self, built: &[Built]) -> Moves {
        let wheels = self.wheels.iter().zip(built);
        let rates = wheels.map(|(half, built)| half.assembler.design_by_height(built));
        Moves {
            points: rates.collect(),
            tensions: vec![0.0; self.tensions.len()],
        }
    }

    /// Returns the derivatives of all points, of tensions and of the height with respect to an adjustment.
    fn by_adjustment(&self, built: &[Built], k: usize) -> (Moves, f64) {
        let wheels = self.wheels.iter().zip(built);
        let rates = wheels.map(|(half, built)| half.assembler.design_by(built, &half.changes[k]));
        let (points, rises): (Vec<_>, Vec<f64>) = rates.unzip();
        let left = &self.wheels[0];
        let by = left.assembler.tensions_by(&built[0], &left.changes[k]);
        let tensions = self.tensions.iter();
        let tensions = tensions.map(|own| by.map_or(0.0, |by| by[own.link]));
        let tensions = tensions.collect();
        (Moves { points, tensions }, rises[0])
    }

    /// Returns the part of each value that comes from the pose of the assembled axle: from R and d in equation (11) of this module.
    /// With `adjustment`, returns the derivative of this part with respect to this adjustment. The part is 0 for values that
    /// [`FROM_DESIGN`] does not list. It is also 0 for the direction of the axle, because the equilibrium already includes R. The
    /// derivatives of the equilibrium do not include R, so this function returns them for the direction, too.
    fn placed(&self, built: &[Built], found: &Found, adjustment: Option<usize>) -> Vec<f64> {
        let mut placed = vec![0.0; self.factors.len() + 1];
        let Reads::Axle(_, reads) = &self.reads else {
            return placed;
        };
        let Half { assembler, changes } = &self.wheels[0];
        let change = adjustment.map_or(&[][..], |k| &changes[k]);
        let of_axle = assembler.axle_by(&built[0], change);
        let Some(((turn, displacement), rotation)) = of_axle.zip(found.rotation) else {
            return placed;
        };
        let rotation = rotation.map(Dual::constant);
        let turn = Matrix3 {
            columns: turn.columns.each(|column| rotation.apply(column)),
        };
        let place = place_of(&turn, displacement);
        for (entry, read) in placed.iter_mut().zip(reads) {
            let Some(number) = from_design(read.quantity) else {
                continue;
            };
            *entry = match (adjustment, is_direction(FROM_DESIGN[number])) {
                (Some(_), _) => place[number].partials[0],
                (None, true) => 0.0,
                (None, false) => place[number].value,
            };
        }
        placed
    }

    /// Computes the values of assembled parts in equilibrium, with their derivatives.
    fn evaluate(&self, built: &[Built]) -> Result<Found, SetUpError> {
        let points = (0..built[0].suspension.design.len()).map(PointId);
        let coordinates = points.flat_map(|point| Axis::ALL.each(|axis| (point, axis)));
        let parameters = coordinates.map(|(point, axis)| Parameter::Point(point, axis));
        match &self.reads {
            Reads::Wheel(elastic, wanted) => {
                let (suspension, parts) = (self.suspension(), &elastic.parts);
                let design = &built[0].suspension.design;
                let run = KcRun::of(suspension, design, parts, elastic.tyre_rate)
                    .map_err(|fault| SetUpError::Fault(fault.of_design()))?;
                let parameters: Vec<Parameter> = parameters.collect();
                let mut found = Found::of(wanted.len());
                run.gradients([0.0; 2], wanted, &parameters, &mut |own| {
                    if let Some(value) = own.value {
                        found.values[own.number] = value;
                        found.by[own.number] = own.by.to_vec();
                    }
                })?;
                Ok(found)
            }
            Reads::Axle(axle, wanted) => {
                let elastic = axle.elastic.as_ref().expect("an axle with elastic parts");
                let designs = [0, 1].map(|side: usize| &built[side].suspension.design[..]);
                let mut parts = elastic.parts.clone();
                for own in &self.tensions {
                    let tension = built[0].tensions.map_or(0.0, |all| all[own.link]);
                    parts.set_rate(own.parameter, own.nominal + tension);
                }
                let equilibria = axle
                    .equilibria(designs, &parts)
                    .map_err(|(_, fault)| SetUpError::Fault(fault))?;
                let home = self.wheels[0].assembler.axle_by(&built[0], &[]);
                let home = home.map(|(turn, _)| turn.map(|c| c.value));
                let equilibria = equilibria.counted_from(home);
                let parameters: Vec<Parameter> = parameters.collect();
                let sides = Side::ALL.into_iter();
                let parameters = sides.flat_map(|side| {
                    let of_side = move |parameter: &Parameter| AxleParameter {
                        parameter: *parameter,
                        side: Some(side),
                    };
                    parameters.iter().map(of_side)
                });
                let tensions = self.tensions.iter().map(|own| own.parameter);
                let parameters: Vec<AxleParameter> = parameters.chain(tensions).collect();
                let mut found = Found::of(wanted.len());
                let at = ([0.0; 2], 0.0);
                found.rotation = equilibria.rotation(at)?;
                equilibria.gradients(at, wanted, &parameters, &mut |k, value, by| {
                    found.values[k] = value;
                    found.by[k] = by.to_vec();
                })?;
                Ok(found)
            }
        }
    }
}

/// Returns true for a value that follows from the rotation of a solid axle, not from its displacement.
fn is_direction(of: AxleQuantity) -> bool {
    matches!(of, AxleQuantity::AxleSteer | AxleQuantity::PinionAngle)
}

/// Factor of each value from the kernel's unit (length unit, rad) to the printed unit.
fn factors(units: impl Iterator<Item = Unit>, suspension: &Suspension) -> Vec<f64> {
    units
        .map(|unit| unit.printed_factor(suspension.length_unit))
        .collect()
}
