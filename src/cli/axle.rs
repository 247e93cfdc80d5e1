//! `hardpoint solve` and `hardpoint check` of an axle; what other commands say of one.

use super::exit::{Exit, Stop};
use super::output::Output;
use super::printer::Printer;
use super::{RunArguments, StudyArguments};
use crate::axle::{
    Axle, AxleCurves, AxlePlan, AxleQuantity, Course, Quantity, WheelMotion, axle_curves,
};
use crate::mechanism::DesignFault;
use crate::model::Side;
use crate::report::{AxleSummary, axle_curves_csv, axle_doubts, axle_sensitivities_csv, doubts};
use crate::study::{AxleStudy, Study};
use std::path::Path;

/// Refuses a study of an axle in a command that only knows one wheel.
pub(super) fn refuse(study: &Study, path: &Path, command: &str) -> Result<(), Stop> {
    match study.axle {
        None => Ok(()),
        Some(_) => Err(Stop::wrong_input(format!(
            "{}: axle: `hardpoint {command}` is not yet there for an axle; without [axle] the study is of \
             one wheel",
            path.display()
        ))),
    }
}

fn fault(path: &Path, axle: &Axle, (side, fault): (Side, DesignFault)) -> Stop {
    let mechanism = &axle.suspension(side).mechanism;
    Stop::wrong_input(format!(
        "{}: {} wheel: {}",
        path.display(),
        side.name(),
        fault.describe(mechanism)
    ))
}

/// The same quantities in the design position.
fn at_design(plan: &AxlePlan) -> AxlePlan {
    let wheels = match plan.course.wheels {
        WheelMotion::Heave(_) => WheelMotion::Heave(vec![0.0]),
        WheelMotion::Roll { .. } => WheelMotion::Roll {
            heave: vec![0.0],
            roll: vec![0.0],
        },
        WheelMotion::Travels { on_plane, .. } => WheelMotion::Travels {
            left: vec![0.0],
            right: vec![0.0],
            on_plane,
        },
    };
    AxlePlan {
        course: Course {
            wheels,
            racks: vec![0.0],
            steering_wheel: None,
            ..plan.course.clone()
        },
        sensitivities: Vec::new(),
        ..plan.clone()
    }
}

/// Whether the steering wheel, turned to the left, steers the wheels to the right.
fn turns_against(axle: &Axle, plan: &AxlePlan) -> bool {
    if axle.setup.c_factor.is_none() || axle.setup.wheel_radius.is_none() {
        return false;
    }
    let plan = AxlePlan {
        quantities: vec![Quantity::Axle(AxleQuantity::SteeringRatio)],
        derivatives: false,
        ..at_design(plan)
    };
    let ratio = axle_curves(axle, &plan).ok();
    let ratio = ratio.and_then(|curves| curves.stations.first()?.value(0));
    ratio.is_some_and(|ratio| ratio < 0.0)
}

fn said(
    study: &Study,
    path: &Path,
    axle: &Axle,
    plan: &AxlePlan,
    curves: &AxleCurves,
) -> Result<Vec<String>, Stop> {
    let left = |f| fault(path, axle, (Side::Left, f));
    let mut said = doubts(&study.suspension).map_err(left)?;
    said.extend(axle_doubts(axle, curves, turns_against(axle, plan)));
    Ok(said)
}

pub(super) fn solve(
    arguments: &RunArguments,
    study: &Study,
    AxleStudy { axle, plan }: &AxleStudy,
) -> Result<Exit, Stop> {
    let path = &arguments.study.study;
    if arguments.report || arguments.plots.is_some() {
        return Err(Stop::wrong_input(
            "--report and --plots are not yet there for an axle",
        ));
    }
    let curves = axle_curves(axle, plan).map_err(|f| fault(path, axle, f))?;
    let design = axle_curves(axle, &at_design(plan)).map_err(|f| fault(path, axle, f))?;
    let output = Output::open(arguments, study, "solve")?;
    let summary = AxleSummary::of(&study.name, axle, plan, &curves, &design);
    let mut files = vec!["curves.csv"];
    output.main_csv("curves.csv", &axle_curves_csv(axle, plan, &curves))?;
    match plan.sensitivities.is_empty() {
        true => output.without("sensitivities.csv")?,
        false => {
            let csv = axle_sensitivities_csv(axle, plan, &curves);
            output.file("sensitivities.csv", &csv)?;
            files.push("sensitivities.csv");
        }
    }
    output.without("report.json")?;
    output.without("report.html")?;
    output.json("summary.json", &summary)?;
    files.push("summary.json");
    output.say(&format!("{}\n\n", summary.headline()))?;
    output.table("outputs", &summary.table())?;
    let remarks = said(study, path, axle, plan, &curves)?;
    for remark in remarks.into_iter().chain(summary.remarks()) {
        output.say(&format!("\n{remark}\n"))?;
    }
    for failure in summary.failures() {
        output.say_failure(&format!("\n{failure}\n"))?;
    }
    output.print_files(&files)?;
    Ok(match curves.are_complete() {
        true => Exit::Done,
        false => Exit::Incomplete,
    })
}

pub(super) fn check(
    arguments: &StudyArguments,
    study: &Study,
    AxleStudy { axle, plan }: &AxleStudy,
) -> Result<Exit, Stop> {
    let path = &arguments.study;
    let moving = AxlePlan {
        sensitivities: Vec::new(),
        ..plan.clone()
    };
    let curves = axle_curves(axle, &moving).map_err(|f| fault(path, axle, f))?;
    let design = axle_curves(axle, &at_design(plan)).map_err(|f| fault(path, axle, f))?;
    let summary = AxleSummary::of(&study.name, axle, plan, &curves, &design);
    let mut out = Printer::new(arguments.format);
    out.say(&format!("{}: valid\n\n", path.display()))?;
    let remarks = said(study, path, axle, plan, &curves)?;
    for remark in remarks.into_iter().chain(summary.remarks()) {
        out.remark(&format!("{remark}\n\n"))?;
    }
    for failure in summary.failures() {
        out.failure(&format!("{failure}\n\n"))?;
    }
    out.say(&format!("{}\n\n", summary.headline()))?;
    out.table("outputs", summary.table())?;
    out.finish()?;
    Ok(match curves.are_complete() {
        true => Exit::Done,
        false => Exit::Incomplete,
    })
}
