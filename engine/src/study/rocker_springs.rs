//! `[heave_spring]`, `[t_bar]` and `[heave_bar]`: springs between the rockers of both wheels.

use super::error::Problems;
use super::file::File;
use super::suspension::above_zero;
use crate::axle::{Preloaded, RockerSprings};
use crate::model::Suspension;

/// Reads the springs between the rockers. `None` if one of them has an error.
pub(super) fn rocker_springs(
    file: &File,
    left: &Suspension,
    problems: &mut Problems,
) -> Option<RockerSprings> {
    let mechanism = &left.mechanism;
    let has_rocker = mechanism.spring_rocker().is_some();
    let newtons = left.length_unit.newtons();
    let mut springs = RockerSprings::default();
    let mut sound = true;
    if let Some(section) = &file.heave_spring {
        let written = section.get_ref();
        let rate = above_zero(&written.rate, problems);
        sound &= rate.is_some();
        springs.heave_spring = rate.map(|rate| Preloaded {
            load: written.force.value * newtons,
            rate: rate * newtons,
        });
        if mechanism.heave_spring().is_none() {
            let message = "[heave_spring] is given, but the hardpoint of its end is missing";
            let error = problems.add(section.span(), message);
            error.help(
                "the hardpoint heave_spring is the end on the left rocker; it needs the rocker and its rod",
            );
            sound = false;
        }
    }
    let mut needs_rocker = |key: &str, place: std::ops::Range<usize>, problems: &mut Problems| {
        if !has_rocker {
            let message = format!("{key} acts on rockers, but the study has no rockers");
            let error = problems.add(place, message);
            error.help(
                "pushrod_outer, pushrod_inner, rocker_pivot_front and rocker_pivot_rear define a rocker",
            );
            sound = false;
        }
    };
    if let Some(section) = &file.t_bar {
        needs_rocker("[t_bar]", section.span(), problems);
        springs.t_bar = Some(above_zero(&section.get_ref().rate, problems)? * newtons);
    }
    if let Some(section) = &file.heave_bar {
        needs_rocker("[heave_bar]", section.span(), problems);
        let written = section.get_ref();
        springs.heave_bar = Some(Preloaded {
            load: written.torque.value * newtons,
            rate: above_zero(&written.rate, problems)? * newtons,
        });
    }
    sound.then_some(springs)
}
