//! Warning about a track of the study that does not agree with the positions of the wheels.

use super::design_reading;
use crate::mechanism::DesignFault;
use crate::model::Suspension;
use crate::report::figure::brief;

/// Largest difference in metres between the track in the study and the track of its wheels that counts as rounding of the written
/// track.
const ROUNDING: f64 = 1e-3;

/// Warning if the track in `[vehicle]` differs from the distance of the wheel centres, and also from the distance of the contact
/// points. The wheels are the left and the right wheel. For a single wheel, the other wheel is its mirror image.
pub(super) fn track_doubt(wheels: [&Suspension; 2]) -> Result<Option<String>, DesignFault> {
    let own = wheels[0];
    let Some(track) = own.vehicle.track else {
        return Ok(None);
    };
    let centre = |wheel: &Suspension| wheel.design[wheel.mechanism.wheel_centre.0].y;
    let centres = wheels.map(centre).iter().sum::<f64>();
    let rounding = ROUNDING * own.length_unit.per_metre();
    let agrees = |distance: f64| (distance - track).abs() <= rounding;
    if agrees(centres) {
        return Ok(None);
    }
    let mut contacts = own.wheel_radius.map(|_| 0.0);
    for wheel in wheels {
        let reading = design_reading(wheel)?;
        let half = reading.map(|reading| reading.contact_point().y[0]);
        contacts = contacts.zip(half).map(|(sum, half)| sum + half);
    }
    if contacts.is_some_and(agrees) {
        return Ok(None);
    }
    let unit = own.length_unit.symbol();
    let at_the_ground = contacts.map_or_else(String::new, |contacts| {
        format!(", and the contact points {} {unit}", brief(contacts))
    });
    Ok(Some(format!(
        "please check: [vehicle] track is {} {unit}, but the wheel centres are {} {unit} apart{at_the_ground}. Results use \
         the hardpoints. Correct the key \"track\", or remove it",
        brief(track),
        brief(centres)
    )))
}
