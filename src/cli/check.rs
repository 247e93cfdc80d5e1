//! `hardpoint check`

use super::StudyArguments;
use super::exit::{Exit, Stop};
use super::output::design_fault;
use crate::curves::curves;
use crate::kinematics::March;
use crate::plan::Plan;
use crate::report::{SolveSummary, Table};
use crate::study::{Drive, Formulation, Study};
use std::io::Write;

pub(super) fn run(arguments: &StudyArguments) -> Result<Exit, Stop> {
    let path = &arguments.study;
    let study = Study::read(path, &arguments.set)?;
    let plan = Plan::of(&study);

    // The design position alone, whatever the motion is.
    let mut design_study = study.clone();
    design_study.motion.time = None;
    design_study.motion.rack = vec![0.0];
    let design_plan = Plan {
        drive: match plan.drive {
            Drive::PaperTheta => Drive::ArmAngle,
            drive => drive,
        },
        march: March::through(&[0.0]),
        racks: vec![0.0],
        time: None,
        ..plan.clone()
    };
    let design = curves(&study.suspension, &design_plan)
        .map_err(|fault| design_fault(&study, path, &fault))?;
    let values = SolveSummary::of(&design_study, &design).design_table();

    let mut out = std::io::stdout().lock();
    let format = arguments.format.into();
    if format == crate::report::Format::Text {
        writeln!(out, "{}: valid\n", path.display())?;
        writeln!(out, "{}\n", motion(&study, &plan))?;
        write!(out, "{}", plan_table(&study, &plan).render(format))?;
        writeln!(
            out,
            "\nCosts are estimates, in poses without anything else; `hardpoint bench effects` measures \
             them.\n\nDesign position:"
        )?;
    }
    write!(out, "{}", values.render(format))?;
    Ok(Exit::Done)
}

/// What the motion asks for, in a sentence.
fn motion(study: &Study, plan: &Plan) -> String {
    let drive = match plan.drive {
        Drive::Travel => "wheel travel",
        Drive::ArmAngle => "arm angle",
        Drive::PaperTheta => "the seed paper's theta",
    };
    let formulation = match plan.formulation {
        Formulation::KnucklePose => "",
        Formulation::PointCoordinates => ", in point coordinates",
    };
    let racks = plan.racks.len();
    let mut text = format!(
        "{} values of {drive} x {racks} of rack{formulation}",
        plan.stations() / racks
    );
    let outputs: Vec<&str> = plan.outputs.iter().map(|o| o.name.as_str()).collect();
    text += &format!("; outputs: {}.", outputs.join(", "));
    if let Some(optimise) = &study.optimise {
        text += &format!(
            " Tuning (optimise only): {} variables, {} targets, {} starts.",
            optimise.variables.len(),
            optimise.targets.len(),
            optimise.starts
        );
    }
    text
}

/// Every effect, on or off, what in the study asks for it and about what it costs.
fn plan_table(study: &Study, plan: &Plan) -> Table {
    let mut table = Table::new(["effect", "state", "cost", "because of", "what"]);
    for effect in plan.effects(study) {
        let state = if effect.on { "on" } else { "off" };
        let cost = match effect.cost {
            _ if !effect.on => String::new(),
            cost if effect.name == "position" => format!("{cost}"),
            cost => format!("+{cost:.1}"),
        };
        table.push([
            effect.name.to_owned(),
            state.to_owned(),
            cost,
            effect.because,
            effect.what,
        ]);
    }
    table
}
