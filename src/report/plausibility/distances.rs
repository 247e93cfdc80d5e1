//! Warnings about points at the centre plane, far from the wheel or below the ground.

use super::PlausibilityRemarks;
use crate::model::Body;
use crate::number::Vector3;
use crate::report::figure::{as_written, brief};

/// Smallest plausible distance of a wheel from the centre plane, relative to the distance between the wheel and the points on
/// the body.
const WHEEL_AT_CENTRE: f64 = 0.5;
/// Largest plausible distance of a point from the wheel centre, in wheel radii.
pub(super) const FAR: f64 = 12.0;
/// Plausible range of the distance of the farthest point from the wheel centre, in metres, for a study without a wheel radius.
const REACH: [f64; 2] = [0.05, 4.0];
/// Usual distance of the wheel centre from the centre plane, in wheel radii (2.0 to 2.6 in the sample suspensions). It gives
/// an estimate of the wheel radius if the study has none.
const HALF_TRACK_IN_RADII: f64 = 2.4;

impl PlausibilityRemarks<'_> {
    /// Warning if the wheel centre is near the centre plane, compared with its distance from the points of the body. Probably the
    /// coordinates are measured from the wheel.
    pub(super) fn wheel_at_the_centre_plane(&mut self) {
        if self.is_at_the_centre_plane() {
            let wheel = as_written(self.at(self.suspension.mechanism.wheel_centre).y);
            let unit = self.suspension.length_unit.symbol();
            self.say(format!(
                "the wheel centre is {wheel} {unit} from the centre plane, y = 0. Is the origin \
                 at the wheel? Roll centre and track need y from the centre plane: add half the \
                 track to every y"
            ));
        }
    }

    /// True if the wheel centre is near the centre plane of the car, compared with its lateral distance from the points of the
    /// body.
    fn is_at_the_centre_plane(&self) -> bool {
        let mechanism = &self.suspension.mechanism;
        let wheel = self.at(mechanism.wheel_centre).y;
        let on_body: Vec<f64> = mechanism
            .points
            .iter()
            .zip(&self.suspension.design)
            .filter(|(point, _)| matches!(point.body, Body::Chassis | Body::Rack))
            .map(|(_, at)| at.y)
            .collect();
        if on_body.is_empty() {
            return false;
        }
        let reach = wheel - on_body.iter().sum::<f64>() / on_body.len() as f64;
        reach > 0.0 && wheel < WHEEL_AT_CENTRE * reach
    }

    /// Wheel radius of the study. If the study has none, the usual radius for this half track (distance of the wheel centre from
    /// the centre plane). `None` if the points do not show the half track.
    pub(super) fn usual_radius(&self) -> Option<f64> {
        let wheel = self.at(self.suspension.mechanism.wheel_centre).y;
        let shows_track = wheel > 0.0 && !self.is_at_the_centre_plane();
        let usual = shows_track.then_some(wheel / HALF_TRACK_IN_RADII);
        self.suspension.wheel_radius.or(usual)
    }

    /// Warnings about the point farthest from the wheel centre, and about the lowest point if it is below the ground. Probably a
    /// coordinate has another unit or the wrong sign.
    pub(super) fn distances(&mut self) {
        let suspension = self.suspension;
        let centre = self.at(suspension.mechanism.wheel_centre);
        let unit = suspension.length_unit.symbol();
        let points = suspension.mechanism.points.iter().zip(&suspension.design);
        let away = |at: &Vector3<f64>| (*at - centre).norm();
        let farthest = points
            .clone()
            .max_by(|a, b| away(a.1).total_cmp(&away(b.1)));
        let Some((point, at)) = farthest else { return };
        let (name, reach) = (&point.name, away(at));
        let metres = reach / suspension.length_unit.per_metre();
        let (is_far, is_near) = match suspension.wheel_radius {
            Some(radius) => (reach > FAR * radius, false),
            None => (metres > REACH[1], metres < REACH[0]),
        };
        let reach = brief(reach);
        if is_far {
            self.say(format!(
                "{name} is {reach} {unit} away from wheel_centre. Is one of them in another unit?"
            ));
        }
        if is_near {
            self.say(format!(
                "no point is more than {reach} {unit} away from wheel_centre. Is length_unit \
                 correct?"
            ));
        }
        let Some(radius) = self.usual_radius() else {
            return;
        };
        let ground = centre.z - radius;
        let lowest = points.min_by(|a, b| a.1.z.total_cmp(&b.1.z));
        if let Some((point, at)) = lowest
            && at.z < ground
        {
            let depth = brief(ground - at.z);
            let assumed = match suspension.wheel_radius {
                Some(_) => String::new(),
                None => format!(
                    " (assumed radius {} {unit}; [wheel] radius is not given)",
                    brief(radius)
                ),
            };
            self.say(format!(
                "{} is {depth} {unit} below the ground{assumed}. Does z have the wrong sign?",
                point.name
            ));
        }
    }
}
