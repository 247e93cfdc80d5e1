//! Values of both wheels of an axle, for the comparison of a design before and after a tuning.

use super::observed::{Gain, Grid, Observed, Series, Station};
use super::{PlaceCoordinate, customary};
use crate::ask::Unit;
use crate::axle::{
    AxleColumn, AxlePlan, AxleQuantity, Coordinate, Of, Placement, Quantity, axle_curves,
};
use crate::characteristics::{Characteristic, Measure, Quantity as WheelQuantity};
use crate::mechanism::DesignFault;
use crate::model::{Axis, Side};
use crate::study::{AxleSample, AxleStudy, Limited, Optimise, Study, Target, TargetKind};

/// Names of the quantities that are compared in addition to the study's outputs.
const COMPARED: [&str; 10] = [
    "camber",
    "toe",
    "caster",
    "kingpin_inclination",
    "scrub_radius",
    "half_track_change",
    "roll_centre_height",
    "force_roll_centre_height",
    "roll_steer",
    "ackermann_error",
];

/// Computes the study's outputs and the compared quantities over the study's motion. `name` is the name of the motion.
pub(super) fn observe(
    study: &Study,
    both: &AxleStudy,
    name: Option<&str>,
) -> Result<Observed, DesignFault> {
    let gains = gains(study, both);
    let shown = plan(both, &[]).quantities;
    let plan = plan(both, &gains);
    let found = axle_curves(&both.axle, &plan).map_err(|(_, fault)| fault)?;
    let found = found.curves;
    let placements = plan.motion.placements();
    let coordinates = coordinates(&plan);
    let place = |placement: &Placement| -> Vec<f64> {
        coordinates.iter().map(|c| placement.along(*c)).collect()
    };
    let places: Vec<Vec<f64>> = placements.iter().map(place).collect();
    let grid = Grid::of(&places);
    let positions = places.iter().map(|place| grid.shares(place));
    let stations = stations(&placements, positions.collect(), both, &plan);
    // Returns the stations at which targets or constraints apply, for the quantities that `is_own` accepts.
    let wanted = |is_own: &dyn Fn(Quantity) -> bool| -> Vec<usize> {
        let targets = study.optimise.iter().flat_map(|o| &o.targets);
        let of_target = |target: &Target| {
            let site = target.site.axle.as_ref();
            let along = site.and_then(|site| {
                let mut own = coordinates.iter();
                own.position(|c| is_same(*c, site.over))
            });
            let motion = site.and_then(|site| site.motion.as_deref());
            let station = |sample: AxleSample| {
                if motion == name {
                    return grid.station(&place(&sample.placement), along?);
                }
                // In another motion, the stations have different coordinates. So a target in that motion applies only to a
                // station at exactly the same position.
                placements.iter().position(|own| *own == sample.placement)
            };
            let samples = target.axle_samples(&both.axle).into_iter();
            let own = samples.filter(|sample| is_own(sample.quantity));
            own.filter_map(station).collect::<Vec<usize>>()
        };
        let limited = limited((study, both, name), &placements, is_own);
        targets.flat_map(of_target).chain(limited).collect()
    };
    let columns = plan.columns(&both.axle);
    let values = |number: usize| found.stations.iter().map(move |s| s.value(number));
    let mut series = Vec::new();
    for (number, column) in columns.iter().enumerate() {
        let quantity = column.quantity();
        // If a gain is not among the compared quantities, it has no separate series. Its values are then used only as
        // slopes of other curves.
        if quantity.is_some_and(|own| gains.contains(&own) && !shown.contains(&own)) {
            continue;
        }
        let Some(of_column) = series_of(column, &stations, study) else {
            continue;
        };
        let as_slope = |gain: &Quantity| {
            let slope = slope_by_gain(*gain, quantity?, both)?;
            let number = columns.iter().position(|c| c.quantity() == Some(*gain))?;
            Some(Gain {
                wanted: wanted(&|own| own == *gain).into_iter().collect(),
                slopes: values(number).map(|v| Some(slope * v?)).collect(),
                travels: placements.iter().map(|p| p.travel(gain.side()?)).collect(),
            })
        };
        series.push(Series {
            wanted: wanted(&|own| is_about(own, column)),
            gains: gains.iter().filter_map(as_slope).collect(),
            values: values(number).collect(),
            ..of_column
        });
    }
    Ok(Observed {
        motion: None,
        stations,
        series,
    })
}

/// Quantity of one wheel, or of the axle, that a part of a constraint limits. `None` if it limits no quantity of this wheel.
/// Limits of an axle with equal wheels apply to both wheels.
fn limited_quantity(of: &Measure, side: Side, both: &AxleStudy) -> Option<Quantity> {
    let is_mirrored = both.axle.right.is_none() && both.axle.elastic.is_none();
    match *of {
        Measure::Quantity(WheelQuantity::Characteristic(of)) => {
            (is_mirrored || side == Side::Left).then_some(Quantity::Corner(side, of))
        }
        Measure::OfAxle(Quantity::Corner(_, of)) if is_mirrored => Some(Quantity::Corner(side, of)),
        Measure::OfAxle(Quantity::Wheel(_, of)) if is_mirrored => Some(Quantity::Wheel(side, of)),
        Measure::OfAxle(of) => of.side().is_none_or(|own| own == side).then_some(of),
        _ => None,
    }
}

/// Stations of a motion at which constraints apply, for the quantities that `is_own` accepts. `name` is the name of the motion.
fn limited(
    (study, both, name): (&Study, &AxleStudy, Option<&str>),
    placements: &[Placement],
    is_own: &dyn Fn(Quantity) -> bool,
) -> Vec<usize> {
    let sign = both.axle.left.frame.sign(Axis::Y);
    let mut found = Vec::new();
    for (side, outwards) in [(Side::Left, sign), (Side::Right, -sign)] {
        for constraint in study.optimise.iter().flat_map(|o| &o.constraints) {
            let limits =
                |part: &Limited| limited_quantity(&part.of, side, both).is_some_and(is_own);
            let site = constraint.site.as_ref();
            let motion = site.and_then(|site| site.motion.as_ref());
            let is_here = motion.map(|(own, _)| own.as_str()) == name;
            if !is_here || !constraint.parts.iter().any(limits) {
                continue;
            }
            // Without a motion, a constraint applies to the design position. The constraint gives rack displacements as a left
            // wheel sees them, so their sign is reversed for the right wheel.
            let travels = motion.map_or(&[0.0][..], |(_, motion)| &motion.values);
            let racks = site.map_or(&[][..], |site| &site.racks);
            let applies = |place: &Placement| {
                let is_level = place.along(Coordinate::Roll) == 0.0;
                let level = || is_level.then(|| place.along(Coordinate::Heave));
                let travel = place.travel(side).or_else(level);
                let rack = outwards * place.rack() + 0.0;
                travel.is_some_and(|travel| travels.contains(&travel))
                    && (racks.contains(&rack) || racks.is_empty() && rack == 0.0)
            };
            let stations = (0..placements.len()).filter(|k| applies(&placements[*k]));
            found.extend(stations);
        }
    }
    found
}

/// Gains of the wheels (derivatives with respect to travel) for which the study has targets or constraints. Each gain occurs
/// once.
fn gains(study: &Study, both: &AxleStudy) -> Vec<Quantity> {
    let targets = study.optimise.iter().flat_map(|o| &o.targets);
    let samples = targets.flat_map(|target| target.axle_samples(&both.axle));
    let constraints = study.optimise.iter().flat_map(|o| &o.constraints);
    let parts = constraints.flat_map(|constraint| &constraint.parts);
    let limited =
        parts.flat_map(|part| Side::ALL.map(|side| limited_quantity(&part.of, side, both)));
    let mut gains = Vec::new();
    for quantity in samples
        .map(|sample| sample.quantity)
        .chain(limited.flatten())
    {
        let is_gain =
            matches!(quantity, Quantity::Corner(_, of) if customary::integral_of(of).is_some());
        if is_gain && !gains.contains(&quantity) {
            gains.push(quantity);
        }
    }
    gains
}

/// Slope of a quantity's curve over the travel of the wheel to which the gain belongs, for a gain of 1. The slope is in printed
/// units. `None` if the gain does not determine the curve.
fn slope_by_gain(gain: Quantity, of: Quantity, both: &AxleStudy) -> Option<f64> {
    use AxleQuantity::{TotalToe, TotalToeAtRim};
    let Quantity::Corner(side, gain) = gain else {
        return None;
    };
    let of = match of {
        Quantity::Corner(own, of) if own == side => of,
        // Total toe is the sum of the toe angles of both wheels.
        Quantity::Axle(TotalToe) => Characteristic::Toe,
        Quantity::Axle(TotalToeAtRim) => Characteristic::ToeAtRim,
        _ => return None,
    };
    customary::slope_by_gain(gain, of, both.axle.suspension(side))
}

/// Returns true if a target for a quantity also applies to a column of the results.
fn is_about(quantity: Quantity, column: &AxleColumn) -> bool {
    use AxleQuantity::{TotalToe, TotalToeAtRim};
    match (quantity, column.quantity()) {
        (Quantity::Corner(side, target), Some(Quantity::Corner(own, of))) => {
            side == own && customary::determines(target, of)
        }
        // Targets for both wheels also determine the sum of their values.
        (Quantity::Corner(_, target), Some(Quantity::Axle(TotalToe | TotalToeAtRim))) => {
            customary::determines(target, Characteristic::Toe)
        }
        (Quantity::Axle(TotalToe), Some(Quantity::Axle(TotalToeAtRim)))
        | (Quantity::Axle(TotalToeAtRim), Some(Quantity::Axle(TotalToe))) => true,
        (quantity, of) => of == Some(quantity),
    }
}

/// Returns true for the kinematic roll centre. In roll, the normals of both wheels become parallel, and the roll centre moves
/// without bounds.
fn is_unbounded(quantity: Quantity) -> bool {
    use AxleQuantity::{RollCentreHeight, RollCentreLateral};
    matches!(
        quantity,
        Quantity::Axle(RollCentreHeight | RollCentreLateral)
    )
}

/// Returns true for the turning circle if the study has a target for the Ackermann geometry. The turning circle then follows
/// from the steer angles of both wheels.
fn follows_a_target(quantity: Quantity, study: &Study) -> bool {
    use AxleQuantity::{Ackermann, AckermannByCotangents, AckermannError, TurningCircle};
    let mut targets = study.optimise.iter().flat_map(|o| &o.targets);
    let asks = |of: &Quantity| {
        matches!(
            of,
            Quantity::Axle(Ackermann | AckermannByCotangents | AckermannError)
        )
    };
    quantity == Quantity::Axle(TurningCircle)
        && targets.any(|target| match &target.of.kind {
            TargetKind::Axle(quantities) => quantities.iter().any(asks),
            _ => false,
        })
}

/// Plans the study without derivatives. Adds the compared quantities that this axle offers, and `gains`.
fn plan(both: &AxleStudy, gains: &[Quantity]) -> AxlePlan {
    let mut plan = AxlePlan {
        derivatives: 0,
        ..both.plan.values_alone()
    };
    for quantity in COMPARED.into_iter().flat_map(Quantity::named) {
        // The name `roll_steer` means a quantity of the axle and one of each wheel. Only the axle's quantity is added.
        let is_double = matches!(quantity, Quantity::Wheel(..));
        if !is_double && both.axle.has(quantity) && !plan.quantities.contains(&quantity) {
            plan.quantities.push(quantity);
        }
    }
    for gain in gains {
        if !plan.quantities.contains(gain) {
            plan.quantities.push(*gain);
        }
    }
    plan
}

/// Coordinates of a motion. If the motion gives steering wheel angles, the coordinate is the rack displacement.
fn coordinates(plan: &AxlePlan) -> Vec<Coordinate> {
    let mut motion = plan.motion.clone();
    let all = Coordinate::ALL.into_iter();
    all.filter(|c| *c != Coordinate::SteeringWheel && motion.along(*c).is_some())
        .collect()
}

fn is_same(coordinate: Coordinate, over: Coordinate) -> bool {
    coordinate == over || (coordinate, over) == (Coordinate::Rack, Coordinate::SteeringWheel)
}

fn stations(
    placements: &[Placement],
    positions: Vec<Vec<f64>>,
    both: &AxleStudy,
    plan: &AxlePlan,
) -> Vec<Station> {
    let moving = plan.motion.moving();
    let length = both.axle.left.length_unit;
    let stations = placements.iter().zip(positions);
    let station = |(placement, position): (&Placement, Vec<f64>)| Station {
        position,
        place: moving
            .iter()
            .map(|c| PlaceCoordinate {
                name: c.key().to_owned(),
                value: c.written(placement.along(*c), &both.axle) + 0.0,
                unit: c.unit(length).to_owned(),
            })
            .collect(),
        case: None,
        is_straight: placement.rack() == 0.0,
    };
    stations.map(station).collect()
}

/// Series of a column, without its values. `None` if the column is not compared.
fn series_of(column: &AxleColumn, stations: &[Station], study: &Study) -> Option<Series> {
    let length = study.wheel().length_unit;
    let new = |name: &str, unit: Unit| Series::new(name, unit, length, stations);
    Some(match &column.of {
        Of::Quantity(quantity) => {
            let info = quantity.info();
            let wheel = quantity.side();
            let is_axle_name = AxleQuantity::ALL.iter().any(|q| q.info().name == info.name);
            let name = match quantity {
                Quantity::Figure(figure) => figure.stem(),
                _ => info.name.to_owned(),
            };
            let series = new(&name, info.unit);
            Series {
                output: match wheel {
                    Some(_) if is_axle_name => format!("wheel_{name}"),
                    _ => name,
                },
                wheel: wheel.map(Side::name),
                tolerance: series
                    .tolerance
                    .filter(|_| !is_unbounded(*quantity) && !follows_a_target(*quantity, study)),
                ..series
            }
        }
        Of::Point { id, name, .. } => {
            let variables = study.optimise.iter().flat_map(|o: &Optimise| &o.variables);
            // If a variable moves this point, the move is intended, so it is not a side effect.
            if variables.flat_map(|v| v.points()).any(|p| p == *id) {
                return None;
            }
            new(name, Unit::Length)
        }
        Of::Force { name, .. } => Series {
            unit: column.unit.clone(),
            ..new(name, Unit::Force)
        },
        Of::Turn(..) => return None,
    })
}
