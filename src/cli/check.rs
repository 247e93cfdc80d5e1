//! `hardpoint check`: validates a study, and solves its design position.

use super::exit::{Exit, Stop};
use super::output::design_fault;
use super::printer::Printer;
use super::terminal::is_quiet;
use super::{StudyArguments, TableFormat};
use crate::attia::PaperTheta;
use crate::checked::{Checked, motion_alone};
use crate::curves::curves;
use crate::evaluate::NotInLanes;
use crate::mechanism::DesignFault;
use crate::model::Suspension;
use crate::plan::Plan;
use crate::report::{
    Cell, Column, SolveSummary, Summary, Table, as_written, counted, study_bands_missed,
    violated_constraints,
};
use crate::solve::StationOrder;
use crate::study::{
    CarStudy, Designs, Drive, Formulation, Scatter, Study, Sweep, Tolerance, Vehicle, WheelStudy,
};
use crate::sweep::SweepPlan;
use crate::tolerance::Problem;
use std::path::Path;

pub(super) fn run(arguments: &StudyArguments) -> Result<Exit, Stop> {
    let path = &arguments.study;
    if CarStudy::is_at(path) {
        return super::car::check(arguments);
    }
    let study = Study::read_elastic(path, &arguments.set)?;
    if let Some(elastic) = study.compliance() {
        return super::elastic::check(arguments, &study, elastic);
    }
    if let Some(axle) = study.axle()
        && let Some(elastic) = &axle.axle.elastic
    {
        return super::elastic::check_axle(arguments, &study, axle, elastic);
    }
    let fault = |why| Stop::in_file(path, why);
    let alone = motion_alone(&study);
    let checked = Checked::of(&alone).map_err(fault)?;

    let mut out = Printer::new(arguments.format);
    out.say(&format!("{}: valid\n\n", path.display()))?;
    for line in checked.remarks(&study) {
        out.remark(&format!("{line}\n\n"))?;
    }
    for line in violated_constraints(&study).map_err(|why| design_fault(&study, path, &why))? {
        out.remark(&format!("{line}\n\n"))?;
    }
    for line in study_bands_missed(&study) {
        out.remark(&format!("{line}\n\n"))?;
    }
    for failure in checked.failures(study.wheel()) {
        out.failure(&format!("{failure}\n\n"))?;
    }
    if !(is_quiet() && arguments.format == TableFormat::Text) {
        match &study.vehicle {
            Vehicle::Wheel(own) => say_wheel(&mut out, &study, own, path)?,
            Vehicle::Axle(_) => {
                say_axle(&mut out, &study, &checked.solved.summary().map_err(fault)?)?
            }
        }
        out.finish()?;
    }
    Ok(Exit::of(checked.is_complete()))
}

/// Prints the outputs of one wheel in the design position. Then prints which computations the study requests, and their cost.
fn say_wheel(out: &mut Printer, study: &Study, own: &WheelStudy, path: &Path) -> Result<(), Stop> {
    let plan = Plan::of(own);
    let fault = |fault: DesignFault| design_fault(study, path, &fault);
    let design_plan = Plan {
        station_order: StationOrder::through(&[design_value(study).map_err(fault)?]),
        racks: vec![0.0],
        time: None,
        ..plan.clone()
    };
    let design = curves(study.wheel(), &design_plan).map_err(fault)?;
    for line in rods(study.wheel()) {
        out.say(&format!("{line}\n\n"))?;
    }
    let derivatives = if plan.outputs.iter().any(|o| o.highest > 0) {
        format!(", derivatives with respect to {}", drive_name(&plan))
    } else {
        String::new()
    };
    out.say(&format!("Design position{derivatives}:\n\n"))?;
    out.table("design", SolveSummary::design_table(&design))?;
    out.say(&format!("\n{}\n\n", motion(study, &plan)))?;
    out.table("effects", plan_table(study, &plan))?;
    out.say(
        "\nCosts are relative to solving the position alone (estimates; `hardpoint bench effects` measures them).\n",
    )
}

/// Prints the headline of an axle's study, and the ranges of its outputs over the motion. Then prints sentences about sections
/// such as `[sweep]`, which `solve` does not use.
fn say_axle(out: &mut Printer, study: &Study, summary: &Summary) -> Result<(), Stop> {
    out.say(&format!("{}\n\n", summary.headline()))?;
    if let Some([ranges, ..]) = summary.tables() {
        out.table("outputs", ranges)?;
    }
    for line in asked(study) {
        out.say(&format!("\n{line}\n"))?;
    }
    Ok(())
}

/// Value of the study's drive in the design position. The motion need not contain this position.
fn design_value(study: &Study) -> Result<f64, DesignFault> {
    let suspension = study.wheel();
    match study.motion().drive {
        Drive::Travel | Drive::ArmAngle => Ok(0.0),
        Drive::PaperTheta => {
            let drive = PaperTheta::of(&suspension.mechanism, &suspension.design)?;
            Ok(drive.design_value())
        }
    }
}

fn drive_name(plan: &Plan) -> &'static str {
    match plan.drive {
        Drive::Travel => "wheel travel",
        Drive::ArmAngle => "arm angle",
        Drive::PaperTheta => "theta of Attia's paper",
    }
}

/// Sentence about the motion and the outputs.
fn motion(study: &Study, plan: &Plan) -> String {
    let formulation = match plan.formulation {
        Formulation::KnucklePose => "",
        Formulation::PointCoordinates => ", in point coordinates",
    };
    let racks = match plan.racks.as_slice() {
        [] | [0.0] if !study.wheel().mechanism.is_steered() => String::new(),
        [] | [0.0] => ", rack at 0".to_owned(),
        [rack] => format!(
            ", rack at {} {}",
            as_written(*rack),
            study.wheel().length_unit.symbol()
        ),
        racks => format!(", {} rack positions", racks.len()),
    };
    let value = match plan.drive {
        Drive::PaperTheta => "value of theta",
        Drive::Travel | Drive::ArmAngle => drive_name(plan),
    };
    let drives = counted(plan.stations() / plan.racks.len().max(1), value);
    let mut text = format!("{drives}{racks}{formulation}");
    let outputs: Vec<&str> = plan.outputs.iter().map(|o| o.name.as_str()).collect();
    text += &format!("; outputs: {}.", outputs.join(", "));
    for line in asked(study) {
        text += &format!(" {line}");
    }
    text
}

/// Sentences about the sections of the study that only commands other than `solve` use, such as `[sweep]`.
fn asked(study: &Study) -> Vec<String> {
    let mut lines = Vec::new();
    if let Some(sweep) = &study.sweep {
        lines.push(swept(study, sweep));
    }
    if let Some(optimise) = &study.optimise {
        lines.push(format!(
            "Tuning (optimise only): {}, {}, {}, {}.",
            counted(optimise.variables.len(), "variable"),
            counted(optimise.targets.len(), "target"),
            counted(optimise.constraints.len(), "constraint"),
            counted(optimise.starts, "start")
        ));
        lines.extend(optimise.scatter.as_ref().map(robust));
        let effects = if optimise.side_effects {
            "changes that no target asks for are reported"
        } else {
            "off (side_effects = false)"
        };
        lines.push(format!("Side effects (optimise only): {effects}."));
    }
    if let Some(setup) = &study.setup {
        lines.push(format!(
            "Set-up (setup only): {}, {}.",
            counted(setup.adjust.len(), "adjustment"),
            counted(setup.want.len(), "target value")
        ));
    }
    lines.extend(study.tolerance.as_ref().map(|of| scattered(study, of)));
    lines
}

/// Sentence about a robust tuning, which compares many builds (assembled parts with random deviations) with the targets.
fn robust(scatter: &Scatter) -> String {
    let builds = counted(scatter.builds, "build");
    if scatter.lowers_misfit() {
        format!("Robust tuning: minimises the mean squared misfit of {builds}.")
    } else {
        format!("Robust tuning: maximises the share of {builds} within the bands.")
    }
}

/// Sentence about `[tolerance]`: numbers of builds (assembled parts with random deviations), scattering numbers and bands. If
/// the program does not solve several builds at once in SIMD lanes, the sentence states the reason.
fn scattered(study: &Study, tolerance: &Tolerance) -> String {
    let mut text = format!(
        "Tolerances (tolerance only): {}, {}, {}.",
        counted(tolerance.builds, "build"),
        counted(tolerance.sources(), "scattering number"),
        counted(tolerance.bands.len(), "band")
    );
    let problem = Problem::of(study, tolerance).ok();
    if let Some(why) = problem.and_then(|problem| problem.not_in_lanes()) {
        let why = why.describe();
        text += &format!(
            " The program solves builds one by one, not several at once in SIMD lanes: {why}."
        );
    }
    text
}

/// Sentence about `[sweep]`: its method and its numbers of designs and variables. If the program does not solve several designs
/// at once in SIMD lanes, the sentence states the reason.
fn swept(study: &Study, sweep: &Sweep) -> String {
    let mut text = match &sweep.designs {
        Designs::Sampled(sampled) => format!(
            "Sweep (sweep only): {}, {} of {}.",
            sampled.method.name(),
            counted(sampled.designs(), "design"),
            counted(sampled.variables.len(), "variable")
        ),
        Designs::File(path) => format!("Sweep (sweep only): the rows of {}.", path.display()),
        Designs::Given(table) => format!(
            "Sweep (sweep only): {}.",
            counted(table.designs(), "design")
        ),
    };
    let plan = SweepPlan::of(study, sweep).ok();
    if let Some(why) = plan.and_then(|plan| one_by_one(&plan)) {
        text += &format!(" {why}");
    }
    text
}

/// Sentence that explains why a sweep does not solve several designs at once in SIMD lanes. `None` if it does.
pub(super) fn one_by_one(plan: &SweepPlan) -> Option<String> {
    let why = plan.worker().ok()?.not_in_lanes()?;
    let mut text = format!(
        "The sweep solves designs one by one, not several at once in SIMD lanes: {}",
        why.describe()
    );
    let quantities = plan.axle_quantities().iter();
    let names = quantities.filter(|q| why == NotInLanes::Reading && !q.is_for_lanes());
    let names = names.map(|q| q.name());
    let names: Vec<String> = names.collect();
    if !names.is_empty() {
        text += &format!(": {}", names.join(", "));
    }
    Some(text + ".")
}

/// One sentence for each rocker: length of its rod (such as a pushrod), and the bodies at the ends of the rod.
fn rods(suspension: &Suspension) -> impl Iterator<Item = String> {
    let Suspension {
        mechanism, design, ..
    } = suspension;
    mechanism.rockers.iter().map(|rocker| {
        let length = (design[rocker.outer.0] - design[rocker.inner.0]).norm();
        format!(
            "The {} from the {} to {} is {length:.3} {} long.",
            rocker.rod,
            mechanism.seat(rocker),
            rocker.rod.turns(),
            suspension.length_unit.symbol()
        )
    })
}

/// Table of all effects: computations that a study can request, such as loads. Each row states whether the effect is computed,
/// the reason, and its approximate cost.
fn plan_table(study: &Study, plan: &Plan) -> Table {
    let mut table = Table::with_columns([
        Column::from("effect"),
        "state".into(),
        "cost".into(),
        Column::named("requested by", "because of"),
        Column::named("detail", "what"),
    ]);
    for effect in plan.effects(study) {
        let cost = match effect.cost {
            cost if !effect.on => Cell::shown(cost, ""),
            cost if effect.name == "position" => Cell::shown(cost, format!("{cost}")),
            cost => Cell::shown(cost, format!("+{cost:.1}")),
        };
        table.push([
            Cell::from(effect.name),
            if effect.on { "on" } else { "off" }.into(),
            cost,
            effect.because.into(),
            effect.what.into(),
        ]);
    }
    table
}
