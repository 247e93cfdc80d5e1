//! Plausibility warnings about a suspension: points may be swapped, or a sign or unit may be wrong. Unusual suspensions exist, so
//! these warnings are not errors.

mod axle;
mod carrier;
mod distances;
mod rack;
mod size;
mod slip;
mod spring;
mod track;
mod tuning;

pub use axle::{axle_plausibility, both_wheels_plausibility};
pub use rack::rack_doubt;
pub use size::scatter_doubts;
pub use spring::spring_doubts;

use super::figure::{as_written, resolution, with_decimals};
use super::{Directions, Reading};
use crate::axle::axle_curves;
use crate::characteristics::{Characteristic, Constants, WheelReading};
use crate::derive::{DesignSeries, MotionPoint};
use crate::mechanism::DesignFault;
use crate::model::{Constraint, Drive, PointId, Seat, Side, SteeringAxis, Suspension};
use crate::number::{Jet, Vector3};
use crate::solve::Solver;
use crate::study::{AxleStudy, Designs, Move, Study};
use track::track_doubt;

/// Largest plausible camber, degrees.
const CAMBER: f64 = 15.0;
/// Largest plausible toe, degrees.
const TOE: f64 = 5.0;
/// Largest plausible caster or kingpin inclination, degrees.
const STEERING_AXIS_ANGLE: f64 = 30.0;
/// Plausible range of the motion ratio of a spring.
const MOTION_RATIO: [f64; 2] = [0.1, 2.0];
/// Plausible range of the wheel radius, metres. These ranges reach from a model car to a haul truck.
const WHEEL_RADIUS: [f64; 2] = [0.02, 2.5];
/// Plausible range of the tyre width, metres.
const TYRE_WIDTH: [f64; 2] = [0.005, 2.0];
/// Plausible range of the rim diameter, metres.
const RIM_DIAMETER: [f64; 2] = [0.02, 2.0];
/// Plausible range of the wheelbase, metres.
const WHEELBASE: [f64; 2] = [0.1, 20.0];
/// Plausible range of the height of the centre of gravity, metres.
const CG_HEIGHT: [f64; 2] = [0.01, 5.0];
/// Plausible range of the wheelbase, in wheel radii. With less than two radii, front and rear wheels would overlap.
const WHEELBASE_IN_RADII: [f64; 2] = [2.0, 30.0];
/// Plausible range of the height of the centre of gravity, in wheel radii.
const CG_HEIGHT_IN_RADII: [f64; 2] = [0.4, 6.0];

/// Warnings about a suspension in its design position, one line each. If one coordinate with a wrong sign or decimal place
/// explains all warnings except the one about the track, the first warning names it. An error if the design cannot be solved.
pub fn plausibility(suspension: &Suspension) -> Result<Vec<String>, DesignFault> {
    let mut found = wheel_plausibility(suspension)?;
    found.extend(track_doubt([suspension; 2])?);
    Ok(found)
}

/// Warnings about a suspension, without the warning about the track (distance between both wheels), which concerns both wheels.
fn wheel_plausibility(suspension: &Suspension) -> Result<Vec<String>, DesignFault> {
    let doubts = doubts(suspension)?;
    let slip = (!doubts.is_empty()).then(|| slip::explains(suspension));
    Ok(slip.flatten().into_iter().chain(doubts).collect())
}

/// Warnings of all checks of one wheel in its design position.
fn doubts(suspension: &Suspension) -> Result<Vec<String>, DesignFault> {
    let mut remarks = PlausibilityRemarks {
        suspension,
        found: Vec::new(),
    };
    remarks.axes();
    remarks.wheel_at_the_centre_plane();
    remarks.distances();
    remarks.wheel_centre_off_its_carrier();
    remarks.joints();
    remarks.rods();
    remarks.seats();
    remarks.front_and_rear();
    remarks.steering_axis();
    remarks.figures();
    remarks.angles()?;
    Ok(remarks.found)
}

/// Warnings about a study, one per line: about its wheel, or its axle over the motion; about its rack, its variables, its targets
/// and its scatters. An error states the wheel whose design cannot be solved.
pub fn study_doubts(study: &Study) -> Result<Vec<String>, (Side, DesignFault)> {
    let mut found = match study.axle() {
        None => plausibility(study.wheel()).map_err(|fault| (Side::Left, fault))?,
        Some(AxleStudy { axle, plan, .. }) => {
            let plan = plan.values_alone();
            both_wheels_plausibility(axle, &plan, &axle_curves(axle, &plan)?)?
        }
    };
    found.extend(rack_doubt(study));
    found.extend(variable_plausibility(study));
    found.extend(scatter_doubts(study));
    Ok(found)
}

/// Warnings about the variables and targets of a study, one per line. They report ranges of coordinates where the key expects
/// offsets, ranges of offsets where it expects coordinates, ranges that are large for the suspension, and target points far beyond
/// the motion.
pub fn variable_plausibility(study: &Study) -> Vec<String> {
    let mut remarks = PlausibilityRemarks {
        suspension: study.wheel(),
        found: Vec::new(),
    };
    if let Some(Designs::Sampled(sampled)) = study.sweep.as_ref().map(|sweep| &sweep.designs) {
        for variable in &sampled.variables {
            remarks.variable(&variable.moves, variable.absolute, variable.range);
        }
    }
    for variable in study.optimise.iter().flat_map(|o| &o.variables) {
        remarks.variable(&variable.moves, false, variable.range);
    }
    remarks.found.extend(tuning::target_doubts(study));
    remarks.found
}

struct PlausibilityRemarks<'a> {
    suspension: &'a Suspension,
    found: Vec<String>,
}

impl<'a> PlausibilityRemarks<'a> {
    fn say(&mut self, doubt: String) {
        self.found.push(format!("please check: {doubt}"));
    }

    fn at(&self, id: PointId) -> Vector3<f64> {
        self.suspension.design[id.0]
    }

    fn name(&self, id: PointId) -> &'a str {
        self.suspension.mechanism.name(id)
    }

    /// Warning if the points show other axes than the study states. Columns may be in another order, or a sign may be wrong.
    fn axes(&mut self) {
        let points = self.suspension.mechanism.points.iter();
        let points: Vec<(&str, [f64; 3])> = points
            .zip(&self.suspension.design)
            .map(|(point, at)| (point.name.as_str(), at.to_array()))
            .collect();
        let directions = Directions::of(&points);
        let own = Reading {
            forward: (0, 1.0),
            outboard: (1, 1.0),
            up: (2, 1.0),
        };
        let Some(other) = directions.contradict(&own) else {
            return;
        };
        // Another warning reports a front pivot behind a rear pivot, and names the likely cause.
        if other.forward.0 == 0 && other.outboard.0 == 1 && other.up.0 == 2 {
            return;
        }
        self.say(format!(
            "the axes seem to be different: with x forward, y outboard and z up as in the study, \
             {}. Were the coordinates in another order?",
            directions.describe(&other)
        ));
    }

    /// Warnings about the direction of rods. The inner end of a rod is at the body or at a rocker, and is usually inboard of the
    /// outer end.
    fn rods(&mut self) {
        let mechanism = &self.suspension.mechanism;
        if mechanism.rigid_axle.is_some() {
            // Links of a solid axle are not checked, because they may lead in either direction.
            return;
        }
        // A link on an arm may lead in any direction, so it is left out.
        let to_body = |c: &&Constraint| mechanism.arm_under(c).is_none();
        let links = mechanism.constraints.iter().filter(to_body);
        let links = links.filter_map(Constraint::link);
        let rockers = mechanism.rockers.iter().filter(|r| r.rod.is_of_spring());
        for (inner, outer) in links.chain(rockers.map(|r| (r.inner, r.outer))) {
            let rod = self.at(outer) - self.at(inner);
            if rod.y < -0.5 * rod.norm() {
                let [inner, outer] = [inner, outer].map(|id| self.name(id));
                self.say(format!(
                    "{inner} is outboard of {outer}. Are they swapped, or has one of them the wrong sign?"
                ));
            }
        }
    }

    /// Warnings about points for which the study does not name a body. One warning states the assumed body of the drop link, if the
    /// drop link could be on a rocker. Other warnings are about points that are clearly nearer to a different body.
    fn seats(&mut self) {
        let Suspension {
            mechanism,
            design,
            length_unit,
            ..
        } = self.suspension;
        let away = |seat: &Seat| {
            let (body, unit) = (seat.name.replace('_', " "), length_unit.symbol());
            // Two digits of a distance are enough to show which body is nearer. A rounding error becomes 0.
            let decimals = if seat.distance < resolution(unit) {
                0
            } else {
                (1.0 - seat.distance.log10().floor()).clamp(0.0, 12.0) as usize
            };
            format!(
                "{body} ({} {unit} away)",
                with_decimals(seat.distance, decimals)
            )
        };
        let drop_link = mechanism.unsaid_drop_link();
        for id in mechanism.unsaid_seats.iter().copied() {
            let name = self.name(id);
            let seats = mechanism.seats(design, id);
            let Some(own) = seats.iter().find(|seat| seat.body == mechanism.body(id)) else {
                continue;
            };
            let say = |body: &str| format!("[suspension.bodies] {name} = \"{body}\"");
            if drop_link == Some(id) {
                let others = seats.iter().filter(|seat| seat.body != own.body);
                let others: Vec<String> = others.map(away).collect();
                self.say(format!(
                    "the study does not give the body of {name}. Assumed: {}; others: {}. Give \
                     the body: {}",
                    away(own),
                    others.join(", "),
                    say(own.name)
                ));
            } else if let Some([own, nearest]) = mechanism.doubtful_seat(design, id) {
                self.say(format!(
                    "{name} is assumed on the {}, but the {} is nearer. Give its body: {}",
                    away(&own),
                    away(&nearest),
                    say(nearest.name)
                ));
            }
        }
    }

    /// Warning about a rear point that is further forward than its front point. Equal positions are allowed, as for a transverse
    /// axis.
    fn front_and_rear(&mut self) {
        let mechanism = &self.suspension.mechanism;
        for (front, point) in mechanism.points.iter().enumerate() {
            let Some((before, after)) = point.name.split_once("front") else {
                continue;
            };
            let Some(rear) = mechanism.point(&format!("{before}rear{after}")) else {
                continue;
            };
            let apart = self.at(rear) - self.at(PointId(front));
            if apart.x > 0.5 * apart.norm() {
                let (front, rear) = (&point.name, self.name(rear));
                self.say(format!(
                    "{front} is behind {rear}. Are they exchanged, or does x point rearward (frame = \"x_rear\")?"
                ));
            }
        }
    }

    /// Warning about the range of a variable that moves points: a range of offsets instead of coordinates (or the reverse), or else
    /// a range that is too large. A range of the wrong kind is usually also too large, so only the first warning is given.
    fn variable(&mut self, moves: &[Move], absolute: bool, range: [f64; 2]) {
        let before = self.found.len();
        self.range(moves, absolute, range);
        if self.found.len() == before {
            self.reach(moves, absolute, range);
        }
    }

    /// Warning about the range of a variable that moves a single coordinate. Coordinates (`absolute`) are doubtful if the range
    /// contains 0 and is far from the design. Offsets are doubtful if the range contains the design and is far from 0.
    fn range(&mut self, moves: &[Move], absolute: bool, range: [f64; 2]) {
        let [
            Move {
                point,
                axis,
                factor,
            },
        ] = *moves
        else {
            return;
        };
        let [one, other] = range.map(|end| factor * end + 0.0);
        let (low, high) = (one.min(other), one.max(other));
        let designed = self.suspension.frame.vector(self.at(point));
        let coordinate = designed[axis];
        let [shown, from, to] = [coordinate, low, high].map(as_written);
        let unit = self.suspension.length_unit.symbol();
        let (name, axis) = (self.name(point), axis.name());
        let holds = |value: f64| (low..=high).contains(&value);
        let width = high - low;
        if absolute && holds(0.0) && (coordinate < low - width || coordinate > high + width) {
            self.say(format!(
                "{axis} of {name} is {shown} {unit} in the design, and its range is {from} to \
                 {to} {unit}, with absolute = true. Are these offsets?"
            ));
        } else if !absolute && holds(coordinate) && low.abs().min(high.abs()) > width {
            self.say(format!(
                "{axis} of {name}, which is {shown} {unit} in the design, has offsets from {from} to \
                 {to} {unit}. Are these coordinates? In a sweep, coordinates need absolute = true"
            ));
        }
    }

    /// Warnings about a steering axis through two points: its direction, kingpin inclination and caster.
    fn steering_axis(&mut self) {
        let axis = self.suspension.mechanism.steering_axis;
        let Some(SteeringAxis::Through { lower, upper }) = axis else {
            return;
        };
        let along = self.at(upper) - self.at(lower);
        let [lower, upper] = [lower, upper].map(|id| self.name(id));
        if along.z <= 0.0 {
            self.say(format!(
                "{upper} is not above {lower}, but the steering axis runs from {lower} to \
                 {upper}. Are they swapped?"
            ));
            return;
        }
        for (name, across) in [("kingpin inclination", -along.y), ("caster", -along.x)] {
            let angle = across.atan2(along.z).to_degrees();
            if angle.abs() > STEERING_AXIS_ANGLE {
                self.say(format!(
                    "the {name} is {angle:.1} deg, from {lower} to {upper}; usual: at most {STEERING_AXIS_ANGLE} deg"
                ));
            }
        }
    }

    /// Warnings about lengths of wheel and vehicle that are not plausible: in the study's unit, or compared with the wheel radius.
    fn figures(&mut self) {
        let Suspension {
            vehicle,
            wheel_radius,
            tyre_width,
            rim_diameter,
            length_unit,
            ..
        } = self.suspension;
        let (unit, metre) = (length_unit.symbol(), length_unit.per_metre());
        for (name, length, [least, most]) in [
            ("[wheel] radius", *wheel_radius, WHEEL_RADIUS),
            ("[wheel] tyre_width", *tyre_width, TYRE_WIDTH),
            ("[wheel] rim_diameter", *rim_diameter, RIM_DIAMETER),
            ("[vehicle] wheelbase", vehicle.wheelbase, WHEELBASE),
            ("[vehicle] cg_height", vehicle.cg_height, CG_HEIGHT),
        ] {
            if let Some(length) = length
                && !(least * metre..=most * metre).contains(&length)
            {
                let length = as_written(length);
                self.say(format!(
                    "{name} is {length} {unit}. Every length in the study must be in length_unit"
                ));
            }
        }
        // A length that is plausible in metres is also compared with the wheel radius.
        for (name, length, in_metres, [least, most]) in [
            (
                "wheelbase",
                vehicle.wheelbase,
                WHEELBASE,
                WHEELBASE_IN_RADII,
            ),
            (
                "cg_height",
                vehicle.cg_height,
                CG_HEIGHT,
                CG_HEIGHT_IN_RADII,
            ),
        ] {
            if let (Some(length), Some(radius)) = (length, *wheel_radius)
                && (in_metres[0] * metre..=in_metres[1] * metre).contains(&length)
                && !(least * radius..=most * radius).contains(&length)
            {
                let [length, radius] = [length, radius].map(as_written);
                self.say(format!(
                    "[vehicle] {name} is {length} {unit} at a wheel radius of {radius} {unit}. Is one of them in another unit?"
                ));
            }
        }
        if let (Some(rim), Some(radius)) = (*rim_diameter, *wheel_radius)
            && rim >= 2.0 * radius
        {
            let [rim, diameter] = [rim, 2.0 * radius].map(as_written);
            self.say(format!(
                "[wheel] rim_diameter is {rim} {unit}, but the wheel with its tyre has a diameter of {diameter} {unit}"
            ));
        }
    }

    /// Warnings about camber, toe and motion ratio in the design position.
    fn angles(&mut self) -> Result<(), DesignFault> {
        let Some(view) = design_reading(self.suspension)? else {
            return Ok(());
        };
        for (name, angle, most) in [
            ("camber", Characteristic::Camber, CAMBER),
            ("toe", Characteristic::Toe, TOE),
        ] {
            let angle = view.characteristic(angle)[0].to_degrees();
            if angle.abs() > most {
                self.say(format!(
                    "the {name} is {angle:.1} deg in the design position; usual: at most {most} deg"
                ));
            }
        }
        let Some(spring) = self.suspension.mechanism.spring else {
            return Ok(());
        };
        let ratio = view.characteristic(Characteristic::MotionRatio)[0];
        let [least, most] = MOTION_RATIO;
        let [upper, lower] = [spring.upper, spring.lower].map(|id| self.name(id));
        if ratio < 0.0 {
            self.say(format!(
                "the spring from {lower} to {upper} lengthens in jounce: its motion ratio is {ratio:.3}. Are its \
                 ends, or those of a rod, swapped?"
            ));
        } else if !(least..=most).contains(&ratio) {
            self.say(format!(
                "the motion ratio of the spring from {lower} to {upper} is {ratio:.3}; usual: {least} to {most}"
            ));
        }
        Ok(())
    }
}

/// Wheel, steering axis and spring in the design position, with their rates. `None` if the design position has no rates: at a
/// turning point of the path, where the travel reverses. Another check reports this case.
fn design_reading(suspension: &Suspension) -> Result<Option<WheelReading<2>>, DesignFault> {
    let Suspension {
        mechanism, design, ..
    } = suspension;
    let solver = Solver::new(mechanism, design)?;
    let design_series = DesignSeries::<2>::new(mechanism, design);
    let motion = MotionPoint {
        drive: Drive::Travel,
        value: Jet::variable(0.0),
        rack: Jet::constant(0.0),
    };
    let found = solver.configuration_series(&design_series, &solver.design_pose(), &motion);
    Ok(found
        .ok()
        .map(|at| WheelReading::of(&at, Constants::of(suspension))))
}
