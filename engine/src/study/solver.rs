//! `[solver]`: the formulation of the equations for poses, and the outputs that it supports.

use super::error::Problems;
use super::file::File;
use super::names::choose;
use super::value::{Selection, Text};
use super::{Drive, Formulation, Motion, Order, Outputs};
use crate::characteristics::Quantity;
use crate::model::{ClosedForm, Suspension};
use std::ops::Range as Span;

impl Formulation {
    const ALL: [(&str, Formulation); 2] = [
        ("knuckle_pose", Formulation::KnucklePose),
        ("point_coordinates", Formulation::PointCoordinates),
    ];

    /// Name of the formulation in studies.
    pub fn name(self) -> &'static str {
        Formulation::ALL[self as usize].0
    }

    /// Highest derivative of a pose with respect to the drive that the formulation gives.
    fn highest_derivative(self) -> usize {
        match self {
            Formulation::KnucklePose => usize::MAX,
            Formulation::PointCoordinates => 2,
        }
    }
}

/// Reads the formulation, and checks that it supports the topology.
pub(super) fn formulation(
    file: &File,
    suspension: &Suspension,
    problems: &mut Problems,
) -> Option<Formulation> {
    let Some(text) = &file.solver.formulation else {
        return Some(Formulation::KnucklePose);
    };
    let formulation = choose(text, "formulation", &Formulation::ALL, problems)?;
    if let (Formulation::PointCoordinates, Some(section)) = (formulation, &file.compliance) {
        let message = "the equations in point coordinates are those of a rigid mechanism, without [compliance]";
        let error = problems.add(text.span(), message);
        error.related(section.span(), "the elastic parts");
        error.help(
            "formulation = \"knuckle_pose\" solves elastic parts; it is the default if [solver] is missing",
        );
        return None;
    }
    let mechanism = &suspension.mechanism;
    let is_strut = matches!(mechanism.closed_form, Some(ClosedForm::Strut));
    if formulation == Formulation::PointCoordinates && !is_strut {
        let message = format!(
            "the equations in point coordinates are those of a MacPherson strut, not of a {}",
            mechanism.topology.name
        );
        let error = problems.add(text.span(), message);
        error.help("formulation = \"knuckle_pose\" solves every topology");
        return None;
    }
    Some(formulation)
}

/// Refuses the key `accuracy`, because every study is solved with errors only at rounding level.
pub(super) fn refuse_accuracy(file: &File, problems: &mut Problems) {
    if let Some(accuracy) = &file.solver.accuracy {
        let message = "the option accuracy was removed: poses always have full double precision";
        let error = problems.add(accuracy.span(), message);
        error.help("delete this line");
    }
}

/// Refuses outputs that the formulation or the drive does not support.
pub(super) fn check_outputs(
    file: &File,
    formulation: Formulation,
    motion: Option<&Motion>,
    outputs: &Outputs,
    problems: &mut Problems,
) {
    check_derivatives(file, formulation, outputs, problems);
    let drive = motion.map(|motion| motion.drive);
    check_certificate(file, formulation, drive, outputs, problems);
    check_loads(file, formulation, outputs, problems);
    let written = &file.motion.get_ref().drive;
    let (text, what, help) = match (formulation, drive) {
        (Formulation::PointCoordinates, _) => (
            &file.solver.formulation,
            "the formulation in point coordinates",
            "formulation = \"knuckle_pose\" supports them",
        ),
        (Formulation::KnucklePose, Some(Drive::PaperTheta)) => (
            written,
            "the drive \"paper_theta\" (the meaning of its angle depends on the hardpoints)",
            "drive = \"arm_angle\" supports them",
        ),
        _ => return,
    };
    let Some(text) = text else { return };
    let wanted = [
        (!outputs.sensitivities.is_empty(), "[outputs] requests"),
        (file.optimise.is_some(), "[optimise] needs"),
    ];
    for (_, who) in wanted.into_iter().filter(|(wanted, _)| *wanted) {
        let message = format!("sensitivities are not available for {what}, but {who} them");
        let error = problems.add(text.span(), message);
        error.help(help);
        if let Some(place) = sensitivities(file).filter(|_| who.contains("[outputs]")) {
            error.related(place, "requested here");
        }
    }
}

/// Refuses certificates for outputs that do not support them.
fn check_certificate(
    file: &File,
    formulation: Formulation,
    drive: Option<Drive>,
    outputs: &Outputs,
    problems: &mut Problems,
) {
    let certify = file.outputs.as_ref().and_then(|o| o.certify.as_ref());
    let Some(certify) = certify.filter(|_| outputs.certify) else {
        return;
    };
    let (message, help) = match (formulation, drive) {
        (Formulation::PointCoordinates, _) => (
            "certify is not available for the formulation in point coordinates",
            "formulation = \"knuckle_pose\" supports them",
        ),
        (Formulation::KnucklePose, Some(Drive::PaperTheta)) => (
            "there are no certificates for the drive \"paper_theta\": the arm angle that belongs to theta \
             is rounded before a pose is found",
            "drive = \"arm_angle\" supports them",
        ),
        (Formulation::KnucklePose, _) => return,
    };
    problems.add(certify.span(), message).help(help);
}

/// Refuses loads with the point-coordinate equations.
fn check_loads(file: &File, formulation: Formulation, outputs: &Outputs, problems: &mut Problems) {
    let written = file.outputs.as_ref().and_then(|o| o.loads.as_ref());
    let Some(written) = written.filter(|_| !outputs.loads.is_empty()) else {
        return;
    };
    if formulation == Formulation::PointCoordinates {
        let message = "loads are not available for the formulation in point coordinates";
        let error = problems.add(written.span(), message);
        error.help("formulation = \"knuckle_pose\" supports them");
    }
}

fn sensitivities(file: &File) -> Option<Span<usize>> {
    match file.outputs.as_ref()?.sensitivities.as_ref()? {
        Selection::Named(names) => names.first().map(Text::span),
        Selection::All(_) => None,
    }
}

fn check_derivatives(
    file: &File,
    formulation: Formulation,
    outputs: &Outputs,
    problems: &mut Problems,
) {
    let order = outputs.order as usize;
    let given = formulation.highest_derivative();
    let Some(section) = file
        .outputs
        .as_ref()
        .filter(|_| outputs.order > Order::Position)
    else {
        return;
    };
    for (text, characteristic) in section.characteristics.iter().zip(&outputs.characteristics) {
        let takes = order + Quantity::Characteristic(*characteristic).rate_order();
        if takes > given {
            let (name, order) = (text.get_ref(), outputs.order.name());
            let message = format!(
                "{name} with order = \"{order}\" needs derivatives up to order {takes}; \
                 formulation = \"{}\" gives order {given}",
                formulation.name()
            );
            problems.add(text.span(), message);
        }
    }
}
