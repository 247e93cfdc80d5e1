//! The elastic parts of an axle and their tests.

use super::super::error::Problems;
use super::super::file::File;
use super::super::resolve::Parts;
use super::super::suspension::above_zero;
use super::{
    check_design_load, check_spring, link, section, subframe, tests, tyre_rate, wheel_parts,
};
use crate::axle::{Axle, AxleMotion, WheelMotion};
use crate::compliance::{AxleCompliance, AxleKcRun, AxleVehicle, KcTest};
use crate::model::{Side, Suspension};
use std::f64::consts::TAU;
use std::path::Path;
use toml::Spanned;

/// The elastic parts of an axle and their tests.
#[derive(Clone, Debug, PartialEq)]
pub struct AxleComplianceStudy {
    /// The parts.
    pub parts: AxleCompliance,
    /// Names of the links of a wheel, in the order of [`crate::compliance::Compliance::links`].
    pub link_names: Vec<String>,
    /// The tests.
    pub tests: Vec<KcTest>,
    /// Rate of the tyre, force per length.
    pub tyre_rate: Option<f64>,
}

impl AxleComplianceStudy {
    /// Names of the bushings of a wheel, then of the mounts of the subframe.
    pub fn bushing_names(&self, suspension: &Suspension) -> Vec<String> {
        let bushings = self.parts.wheels[0].bushings.iter();
        let names = bushings.map(|part| suspension.mechanism.name(part.point).to_owned());
        let mounts = self.parts.subframe.iter().flat_map(|own| &own.mounts);
        names
            .chain(mounts.map(|mount| mount.name.clone()))
            .collect()
    }
}

/// The elastic parts of an axle, if they have no error; the inner `None` without elastic parts.
pub(in super::super) fn axle_compliance(
    file: &File,
    axle: &Axle,
    motion: &AxleMotion,
    parts: Parts,
    directory: &Path,
    problems: &mut Problems,
) -> Option<Option<AxleComplianceStudy>> {
    let suspension = &axle.left;
    let Some(section) = section(file, suspension, parts, problems)? else {
        refuse_stiffness(file, problems)?;
        return Some(None);
    };
    if parts != Parts::ElasticAxles {
        let message = "this command does not take elastic parts of an axle";
        let error = problems.add(section.span(), message);
        error.help("kc and check take them; without [axle] the study is of the left wheel alone, for every command");
        return None;
    }
    refuse_motion(file, motion, problems)?;
    let setup = &axle.setup;
    let between = [
        (
            "[heave_spring]",
            file.heave_spring.as_ref().map(Spanned::span),
        ),
        ("[t_bar]", file.t_bar.as_ref().map(Spanned::span)),
        ("[heave_bar]", file.heave_bar.as_ref().map(Spanned::span)),
    ];
    for (name, span) in between {
        if let Some(span) = span {
            let message = format!(
                "{name} with [compliance] is not available: springs between the rockers are of rigid axles"
            );
            return problems.refuse(span, &message);
        }
    }
    let own = subframe::subframe(file, suspension, directory, problems);
    let mounts: Vec<&str> = file
        .subframe
        .iter()
        .flat_map(|section| section.get_ref().mounts.keys())
        .map(|name| name.get_ref().as_str())
        .collect();
    let found = wheel_parts(file, section, suspension, &mounts, directory, problems);
    let rates = (rack_rate(file, axle, problems), tyre_rate(file, problems));
    let (own, found, rack_rate, tyre_rate) = (own?, found?, rates.0?, rates.1?);
    let link_names = found.link_names();
    let springs = setup.springs.clone();
    let wheel = found.with(springs.as_ref().map(|[left, _]| left.clone()));
    check_design_load(section, wheel.relaxed, wheel.spring.is_some(), problems)?;
    for side in Side::ALL {
        check_spring(axle.suspension(side), section, problems)?;
        let has_bar = setup.bar_rate.is_some();
        let wheel = &wheel;
        subframe::check_reach(
            section,
            own.as_ref(),
            axle.suspension(side),
            wheel,
            has_bar,
            problems,
        )?;
    }
    link::check_members(file, suspension, &wheel, problems)?;
    let steers = suspension.mechanism.has_rack();
    let has_spring = wheel.spring.is_some();
    let tests = tests::tests_of_axle(section, suspension, has_spring, steers, problems)?;
    let mut right = wheel.clone();
    right.spring = springs.map(|[_, right]| right);
    let parts = AxleCompliance {
        wheels: [wheel, right],
        subframe: own,
        rack_rate: rack_rate.filter(|_| steers),
        bar_rate: setup.bar_rate,
    };
    let vehicle = AxleVehicle {
        suspensions: Side::ALL.map(|side| axle.suspension(side)),
        tyre_rate,
    };
    match AxleKcRun::new(vehicle, &parts) {
        Ok(_) => Some(Some(AxleComplianceStudy {
            parts,
            link_names,
            tests,
            tyre_rate,
        })),
        Err(fault) => {
            let message = fault.describe(&parts.wheels, suspension);
            problems.refuse(section.span(), &message)
        }
    }
}

/// Refuses the stiffness of rack and column in a rigid study.
fn refuse_stiffness(file: &File, problems: &mut Problems) -> Option<()> {
    let steering = file.steering.as_ref().map(Spanned::get_ref);
    let rates = steering.map(|own| [&own.rack_stiffness, &own.column_stiffness]);
    match rates.into_iter().flatten().flatten().next() {
        None => Some(()),
        Some(rate) => {
            let message = "the stiffness of rack and column needs [compliance]";
            problems.refuse(rate.span.clone(), message)
        }
    }
}

/// Stiffness between the commanded rack and the rack, the column in series; the inner `None` if both are rigid.
fn rack_rate(file: &File, axle: &Axle, problems: &mut Problems) -> Option<Option<f64>> {
    let Some(steering) = file.steering.as_ref().map(Spanned::get_ref) else {
        return Some(None);
    };
    let mut compliance = 0.0;
    if let Some(rate) = &steering.rack_stiffness {
        compliance += 1.0 / above_zero(rate, problems)?;
    }
    if let Some(rate) = &steering.column_stiffness {
        let Some(per_turn) = axle.setup.c_factor else {
            let message =
                "column_stiffness needs c_factor: the rack's displacement per turn of the pinion";
            return problems.refuse(rate.span.clone(), message);
        };
        let per_angle = per_turn / TAU;
        compliance += per_angle * per_angle / above_zero(rate, problems)?;
    }
    Some((compliance > 0.0).then(|| 1.0 / compliance))
}

/// Elastic axles are driven by travels on level pads and the rack.
fn refuse_motion(file: &File, motion: &AxleMotion, problems: &mut Problems) -> Option<()> {
    let on_plane = matches!(motion.wheels, WheelMotion::Travels { on_plane: true, .. });
    let message = if motion.time.is_some() {
        "time is of rigid axles; with [compliance] expected heave, travel_left and travel_right, and rack"
    } else if matches!(motion.wheels, WheelMotion::Roll { .. }) {
        "roll is of rigid axles; with [compliance] ask the test load = \"roll\" of kc"
    } else if on_plane {
        "ground = \"plane\" is of rigid axles; with [compliance] both wheels stand on level pads"
    } else {
        return Some(());
    };
    problems.refuse(file.motion.span(), message)
}
