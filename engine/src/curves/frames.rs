//! Positions of all points of a mechanism along its motion, for drawings.
//!
//! With elastic parts, the wheel carrier is drawn in its equilibrium position. Arms, struts and rockers end at their joints
//! on the carrier. The drawing neglects displacements of the bushings at their other ends.

use super::DriveLaw;
use crate::characteristics::InstantCentres;
use crate::compliance::ElasticWheel;
use crate::derive::DesignSeries;
use crate::mechanism::{Configuration, DesignFault, Failure, NoPose};
use crate::model::{Axis, Body, PointId, RockerId, SteeringAxis, Suspension};
use crate::number::{Each, Jet, Real, Vector3};
use crate::plan::Plan;
use crate::solve::{Solver, Toggles};
use crate::study::{ComplianceStudy, WheelStudy};
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

/// The mechanism at one station, in the study's axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// Drive value: wheel travel, or an angle in degrees.
    pub drive: f64,
    /// Rack displacement.
    pub rack: f64,
    /// Positions, or the reason why there is no pose.
    pub pose: Result<Placement, String>,
}

/// Positions to draw in one pose, in the study's axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Placement {
    /// Position of each point of the mechanism.
    pub points: Vec<[f64; 3]>,
    /// Unit vector along the spin axis, positive outboard.
    pub spin_axis: [f64; 3],
    /// Two points of the steering axis.
    pub steering_axis: Option<[[f64; 3]; 2]>,
    /// Contact point of the wheel. `None` if its radius is unknown, or for one wheel at a turning point (fold) of the motion.
    pub contact: Option<[f64; 3]>,
    /// Roll centre, for one wheel in the car's centre plane. `None` if the wheel's velocities are unknown, or if the centre is at
    /// infinity.
    pub roll_centre: Option<[f64; 3]>,
    /// Instantaneous centre in front view, in the transverse plane of the contact point. `None` under the same conditions as for
    /// `roll_centre`.
    pub front_view_centre: Option<[f64; 3]>,
    /// Instantaneous centre in side view, in the longitudinal plane of the contact point. `None` under the same conditions as for
    /// `roll_centre`.
    pub side_view_centre: Option<[f64; 3]>,
    /// Right wheel of an axle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub right: Option<OtherWheel>,
    /// Turning geometry of the steered wheels of an axle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub turn: Option<Turn>,
}

/// Right wheel of an axle, in the same axes as the left wheel.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OtherWheel {
    /// Unit vector along the spin axis, positive outboard.
    pub spin_axis: [f64; 3],
    /// Contact point of the wheel.
    pub contact: Option<[f64; 3]>,
    /// Instantaneous centre in front view.
    pub front_view_centre: Option<[f64; 3]>,
    /// Instantaneous centre in side view.
    pub side_view_centre: Option<[f64; 3]>,
}

/// Turning geometry, seen from above: wheels, spin axes and centre of the turn. Each point is (x, y) in the body's axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Turn {
    /// Rear and front end of the left and the right wheel.
    pub wheels: [[[f64; 2]; 2]; 2],
    /// Points in which the spin axes meet the line of the other axle. `None` straight ahead.
    pub meets: Option<[[f64; 2]; 2]>,
    /// The vehicle's turning centre: the midpoint of the points in which the spin axes meet the line of the other axle.
    pub centre: Option<[f64; 2]>,
    /// Position of the vehicle's other axle along x.
    pub other_axle: f64,
}

/// Computes the frames of one wheel at the stations of a plan, one rack displacement after another. They show equilibria if
/// there are elastic parts, otherwise poses.
///
/// # Errors
/// Returns an error if the design position cannot be solved, or if the design has no elastic model.
pub fn wheel_frames(own: &WheelStudy, plan: &Plan) -> Result<Vec<Frame>, DesignFault> {
    match &own.compliance {
        Some(elastic) => equilibrium_frames(&own.suspension, elastic, plan),
        None => frames(&own.suspension, plan),
    }
}

fn equilibrium_frames(
    suspension: &Suspension,
    elastic: &ComplianceStudy,
    plan: &Plan,
) -> Result<Vec<Frame>, DesignFault> {
    let wheel = ElasticWheel::new(suspension, &elastic.parts).map_err(|fault| fault.of_design())?;
    let origin = suspension.design[suspension.mechanism.origin.0];
    let along = suspension.frame.sign(Axis::Y);
    let stations = plan.racks.iter().flat_map(|rack| {
        let travels = plan.station_order.values().iter();
        travels.map(move |travel| (*travel, *rack))
    });
    let frame = |(travel, rack): (f64, f64)| {
        let placed = wheel.at(travel, along * rack).map_err(NoPose::from);
        let placed = placed.and_then(|at| {
            let contact = suspension.wheel_radius.map(|_| wheel.figures(&at).contact);
            let (mechanism, design) = (&suspension.mechanism, &suspension.design);
            let at = Configuration::new(mechanism, design, wheel.pose(&at, origin), at.rack());
            Ok(Placement::at_rest(suspension, &at, contact)?)
        });
        Frame {
            drive: travel,
            rack,
            pose: placed.map_err(|why| why.describe(suspension.length_unit, suspension.frame)),
        }
    };
    Ok(stations.map(frame).collect())
}

/// Frames of the rigid mechanism of a suspension at the stations of a plan, one rack displacement after another.
pub fn frames(suspension: &Suspension, plan: &Plan) -> Result<Vec<Frame>, DesignFault> {
    let mut solver = Solver::new(&suspension.mechanism, &suspension.design)?;
    let mechanism = &suspension.mechanism;
    let still = DesignSeries::<1>::new(mechanism, &suspension.design);
    let moving = DesignSeries::<2>::new(mechanism, &suspension.design);
    let drive_law = DriveLaw::of(suspension, plan)?;
    let rockers = (0..mechanism.rockers.len()).map(RockerId);
    let toggles = Toggles::of(mechanism, rockers);
    let values = plan.station_order.values();
    let mut frames = Vec::with_capacity(plan.stations());
    for rack in &plan.racks {
        let first = frames.len();
        frames.extend(values.iter().map(|value| Frame {
            drive: plan.drive.printed(*value),
            rack: *rack,
            pose: Err(Failure::DeadCentre.to_string()),
        }));
        let rack = rack * plan.rack_sign;
        let drive = plan.drive.in_kernel();
        toggles.begin(&mut solver, drive, rack)?;
        solver.for_each_pose(
            drive,
            &drive_law.station_order,
            rack,
            |solver, place, pose| {
                let number = drive_law.stations[place];
                let motion = drive_law.motion::<1>(values[number], rack);
                let placed = pose.and_then(|pose| {
                    let at = solver.configuration_series(&still, pose, &motion)?;
                    if let Some(rod) = toggles.note(Some(solver), &at, motion.value[0]) {
                        return Err(Failure::Toggle(rod));
                    }
                    // At a turning point (fold) of the motion, the velocities do not exist.
                    let motion = drive_law.motion::<2>(values[number], rack);
                    let moving = solver.configuration_series(&moving, pose, &motion);
                    let centres = match moving {
                        Ok(moving) => InstantCentres::of(suspension, &moving),
                        Err(_) => InstantCentres::default(),
                    };
                    Ok(Placement::of(suspension, &at, centres))
                });
                frames[first + number].pose = placed
                    .map_err(|failure| failure.describe(suspension.length_unit, suspension.frame));
                ControlFlow::Continue(())
            },
        )?;
    }
    Ok(frames)
}

impl Placement {
    /// Combines both wheels of an axle. The points of the left wheel come first.
    pub(crate) fn of_axle(
        points: Vec<[f64; 3]>,
        [left, right]: [OtherWheel; 2],
        roll_centre: Option<[f64; 3]>,
        turn: Option<Turn>,
    ) -> Placement {
        Placement {
            points,
            spin_axis: left.spin_axis,
            steering_axis: None,
            contact: left.contact,
            roll_centre,
            front_view_centre: left.front_view_centre,
            side_view_centre: left.side_view_centre,
            right: Some(right),
            turn,
        }
    }

    /// Positions to draw for the mechanism in a configuration without velocities. `suspension` gives the axes. An error
    /// names the first rod that does not reach its rocker.
    pub(crate) fn at_rest(
        suspension: &Suspension,
        at: &Configuration<f64>,
        contact: Option<Vector3<f64>>,
    ) -> Result<Placement, Failure> {
        let design = at.design.iter();
        let design: Vec<_> = design.map(|v| v.map(Jet::<f64, 1>::constant)).collect();
        let still = Configuration {
            mechanism: at.mechanism,
            design: &design,
            pose: at.pose.map(Jet::constant),
            rack: Jet::constant(at.rack),
            steering: None,
        };
        let centres = InstantCentres {
            contact,
            ..InstantCentres::default()
        };
        let placed = Placement::of(suspension, &still, centres);
        for (point, place) in at.mechanism.points.iter().zip(&placed.points) {
            if let (Body::Rocker(id), false) = (point.body, place.iter().all(|c| c.is_finite())) {
                return Err(Failure::Toggle(at.mechanism.rockers[id.0].rod));
            }
        }
        Ok(placed)
    }

    fn of<const N: usize>(
        suspension: &Suspension,
        at: &Configuration<Jet<f64, N>>,
        centres: InstantCentres,
    ) -> Placement {
        let outside = |v: Vector3<f64>| suspension.frame.vector(v).to_array().each(|x| x + 0.0);
        let now = |v: Vector3<Jet<f64, N>>| outside(v.map(|c| c[0]));
        let points = 0..suspension.mechanism.points.len();
        Placement {
            points: points.map(|i| now(at.point(PointId(i)))).collect(),
            spin_axis: now(at.spin_axis()),
            steering_axis: steering_axis(suspension, at).map(|ends| ends.each(now)),
            contact: centres.contact.map(outside),
            roll_centre: centres.roll_centre.map(outside),
            front_view_centre: centres.front_view.map(outside),
            side_view_centre: centres.side_view.map(outside),
            right: None,
            turn: None,
        }
    }
}

/// Two points of the steering axis: its joints. For an instantaneous axis, one point below and one above the point nearest to
/// the wheel centre.
fn steering_axis<T: Real>(
    suspension: &Suspension,
    at: &Configuration<T>,
) -> Option<[Vector3<T>; 2]> {
    if let SteeringAxis::Through { lower, upper } = at.mechanism.steering_axis? {
        return Some([lower, upper].each(|id| at.point(id)));
    }
    let (point, along) = at.steering_axis()?;
    let along = along.normalised();
    let foot = point + along * along.dot(at.point(at.mechanism.wheel_centre) - point);
    let half = along.scaled(0.5 * suspension.size());
    Some([foot - half, foot + half])
}
