//! Twist beams: stiffness of the cross member, and conditions for the hardpoints.

use super::error::Problems;
use super::file::{self, File};
use super::suspension::above_zero;
use super::value::Text;
use crate::ask::six_digits;
use crate::model::{Suspension, TwistBeam};
use crate::number::Each;

/// Factor from the beam's torsional rate k_t to the rate of the equivalent anti-roll bar. The beam's twist psi is the rotation
/// of one half relative to the other. The two levers of the equivalent bar rotate by psi and -psi, so their angle is 2 psi.
/// With equal energy, k_t psi^2/2 = (k_t/4) (2 psi)^2/2.
const OF_BOTH_LEVERS: f64 = 0.25;

/// Rate of the anti-roll bar that represents the twist beam in formulas. `Some(None)` if there is no `[twist_beam]`, `None` if
/// the study has an error.
pub(super) fn bar_rate(
    file: &File,
    left: &Suspension,
    problems: &mut Problems,
) -> Option<Option<f64>> {
    let is_beam = left.mechanism.topology.is_twist_beam();
    if let (true, Some(bar)) = (is_beam, &file.anti_roll_bar) {
        let message = "a twist beam is its own anti-roll bar: leave [anti_roll_bar] out";
        let error = problems.add(bar.span(), message);
        error.help("add the rate of a bar in the cross member to torsional_rate in [twist_beam]");
        return None;
    }
    let Some(section) = file.twist_beam.as_ref().filter(|_| is_beam) else {
        return Some(None);
    };
    let rate = above_zero(&section.get_ref().torsional_rate, problems)?;
    Some(Some(OF_BOTH_LEVERS * rate * left.length_unit.newtons()))
}

/// Checks that the shear centre is not on the line through both mounts. Without `hinge_end`, it must be in the middle of the
/// car. Also checks the direction of the hinge and the side of the mount.
pub(super) fn check(
    section: &file::Suspension,
    suspension: &Suspension,
    beam: &TwistBeam,
    problems: &mut Problems,
) -> Option<()> {
    let design = &suspension.design;
    let (mount, centre) = (design[beam.mount.0], design[beam.shear_centre.0]);
    let place = |name: &str| {
        let mut names = section.hardpoints.get_ref().keys();
        let written = names.find(|text| text.get_ref() == name);
        written.map_or(section.hardpoints.span(), Text::span)
    };
    if centre.y != 0.0 && !beam.is_hinge_given {
        let message = "the shear centre is given in the middle of the car: expected y = 0";
        let error = problems.add(place("shear_centre"), message);
        error.help("a hinge that is not along y has a second point, hinge_end");
        return None;
    }
    let along = design[beam.hinge.0] - centre;
    if along.y <= LEAST_SLOPE * along.norm() {
        let message = "the hinge runs across the car: expected hinge_end left of the shear centre";
        return problems.refuse(place("hinge_end"), message);
    }
    if mount.y <= 0.0 {
        let message = "the mount of the left half is not on the left side of the car: expected the coordinates of the left mount";
        return problems.refuse(place("mount"), message);
    }
    let apart = (mount.x - centre.x).hypot(mount.z - centre.z);
    let least = LEAST_APART * suspension.size();
    if apart < least {
        let [apart, least] = [apart, least].each(six_digits);
        let unit = suspension.length_unit.symbol();
        let message = format!(
            "the shear centre lies {apart} {unit} from the line through both mounts, so the halves can hardly turn against each \
             other: expected {least} {unit} or more"
        );
        return problems.refuse(place("shear_centre"), message);
    }
    Some(())
}

/// Smallest y component of the hinge's unit direction vector.
const LEAST_SLOPE: f64 = 0.5;

/// Smallest distance of the shear centre from the line through both mounts, relative to the mechanism's size.
const LEAST_APART: f64 = 1e-3;
