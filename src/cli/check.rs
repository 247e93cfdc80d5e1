//! `hardpoint check`

use super::StudyArguments;
use super::exit::{Exit, Stop};
use super::output::design_fault;
use crate::curves::curves;
use crate::kinematics::March;
use crate::model::PointId;
use crate::plan::Plan;
use crate::report::{SolveSummary, Table};
use crate::study::{Designs, Drive, Formulation, Study};
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
        write!(out, "{}", plan_table(&study, &plan).render(format))?;
        writeln!(out, "\nDesign position:")?;
    }
    write!(out, "{}", values.render(format))?;
    Ok(Exit::Done)
}

/// What will be computed, and what in the study asks for it.
fn plan_table(study: &Study, plan: &Plan) -> Table {
    let mechanism = &study.suspension.mechanism;
    let mut table = Table::new(["will compute", "because of", "in all"]);
    let drive = match plan.drive {
        Drive::Travel => "wheel travel",
        Drive::ArmAngle => "arm angle",
        Drive::PaperTheta => "the seed paper's theta",
    };
    let formulation = match plan.formulation {
        Formulation::KnucklePose => "positions",
        Formulation::PointCoordinates => "positions, in point coordinates",
    };
    let stations = plan.stations();
    table.push([
        formulation.to_owned(),
        format!(
            "[motion]: {} of {drive} x {} of rack",
            stations / plan.racks.len(),
            plan.racks.len()
        ),
        format!("{stations} poses"),
    ]);
    if plan.coefficients > 1 {
        let depth = plan
            .outputs
            .iter()
            .map(|o| o.quantity.depth())
            .max()
            .unwrap_or(0);
        let mut reasons = Vec::new();
        if study.outputs.order as usize > 0 {
            reasons.push(format!(
                "outputs.order = \"{}\"",
                study.outputs.order.name()
            ));
        }
        if depth > 0 {
            reasons.push("characteristics made of velocities".to_owned());
        }
        table.push([
            format!("derivatives up to order {}", plan.coefficients - 1),
            reasons.join(", "),
            format!("{} right-hand sides", stations * (plan.coefficients - 1)),
        ]);
    }
    if !plan.sensitivities.is_empty() {
        let names: Vec<&str> = plan
            .sensitivities
            .iter()
            .map(|id: &PointId| mechanism.name(*id))
            .collect();
        table.push([
            "sensitivities".to_owned(),
            format!("outputs.sensitivities: {}", names.join(", ")),
            format!("{} adjoints", stations * plan.outputs.len()),
        ]);
    }
    let outputs: Vec<&str> = plan.outputs.iter().map(|o| o.name.as_str()).collect();
    table.push([
        "outputs".to_owned(),
        format!("[outputs]: {}", outputs.join(", ")),
        format!(
            "{} values",
            stations * plan.outputs.iter().map(|o| o.highest + 1).sum::<usize>()
        ),
    ]);
    if let Some(sweep) = &study.sweep {
        let (what, designs) = match &sweep.designs {
            Designs::Sampled(sampled) => (
                format!(
                    "{} of {} variables",
                    sampled.method.name(),
                    sampled.variables.len()
                ),
                format!("{} designs", sampled.designs()),
            ),
            Designs::File(path) => (path.display().to_string(), "its rows".to_owned()),
        };
        let what = format!("[sweep]: {what}");
        table.push(["sweep (sweep only)".to_owned(), what, designs]);
    }
    if let Some(optimise) = &study.optimise {
        table.push([
            "tuning (optimise only)".to_owned(),
            format!(
                "[optimise]: {} variables, {} targets",
                optimise.variables.len(),
                optimise.targets.len()
            ),
            format!("{} starts", optimise.starts),
        ]);
    }
    table
}
