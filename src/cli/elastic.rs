//! `hardpoint check` of a study with elastic parts.

use super::StudyArguments;
use super::exit::{Exit, Stop};
use super::output::design_fault;
use super::printer::Printer;
use crate::compliance::{AxleKcRun, Compliance, ElasticWheel, KcWheelState, Relaxed};
use crate::model::{LengthUnit, Suspension};
use crate::report::{
    Table, brief, elastic_parts, no_equilibrium, study_bands_missed, study_doubts,
    violated_constraints,
};
use crate::study::{AxleComplianceStudy, AxleStudy, ComplianceStudy, Study};

/// Limit of a plausible stiffness in N/mm. A larger value may be in N/m by mistake. Applies if lengths are in millimetres.
const DOUBTFUL_RATE: f64 = 1e6;

/// Names the commands that accept elastic parts.
const COMMANDS: &str = "`hardpoint kc` runs the tests; `solve`, `sweep`, `optimise`, `tolerance`, \
                        `setup`, `limits` and `compare` also include the elastic parts.";

/// Prints the table of elastic parts, and the values of the wheel in equilibrium at the design height. Returns exit code 1
/// (`Incomplete`) without an equilibrium.
pub(super) fn check(
    arguments: &StudyArguments,
    study: &Study,
    elastic: &ComplianceStudy,
) -> Result<Exit, Stop> {
    let mut out = say_doubts(arguments, study, std::slice::from_ref(&elastic.parts))?;
    let relaxed = relaxed_in_words(elastic.parts.relaxed);
    out.say(&format!("Elastic parts, {relaxed}:\n\n"))?;
    out.table("elastic_parts", elastic_parts(study))?;
    out.say(&format!(
        "\nEverything else is rigid. Links and arms do not bend, and parts have no weight. {COMMANDS}\n"
    ))?;
    let complete = say_design(&mut out, study, elastic)?;
    out.finish()?;
    Ok(Exit::of(complete))
}

/// Prints the table of elastic parts of an axle, and the values of both wheels in equilibrium at the design height. Returns exit
/// code 1 (`Incomplete`) without an equilibrium.
pub(super) fn check_axle(
    arguments: &StudyArguments,
    study: &Study,
    axle: &AxleStudy,
    elastic: &AxleComplianceStudy,
) -> Result<Exit, Stop> {
    let mut out = say_doubts(arguments, study, &elastic.parts.wheels)?;
    out.say(&format!(
        "Elastic parts of one side, {}:\n\n",
        relaxed_in_words(elastic.parts.relaxed())
    ))?;
    out.table("elastic_parts", elastic_parts(study))?;
    if let Some(subframe) = &elastic.parts.subframe {
        let names = subframe.carries.iter();
        let names: Vec<&str> = names.map(|id| study.wheel().mechanism.name(*id)).collect();
        out.say(&format!("\nThe subframe holds {}.\n", names.join(", ")))?;
    }
    out.say(&format!("\nEverything else is rigid. {COMMANDS}\n"))?;
    let complete = say_axle_design(&mut out, axle, elastic)?;
    out.finish()?;
    Ok(Exit::of(complete))
}

/// Prints that a study is valid, then warnings about its points and about the elastic parts of its wheels.
fn say_doubts(
    arguments: &StudyArguments,
    study: &Study,
    wheels: &[Compliance],
) -> Result<Printer, Stop> {
    let path = &arguments.study;
    let out = Printer::new(arguments.format);
    out.say(&format!("{}: valid\n\n", path.display()))?;
    let found = study_doubts(study).map_err(|(side, fault)| match study.axle() {
        Some(both) => Stop::in_file(path, both.axle.describe_fault((side, fault))),
        None => design_fault(study, path, &fault),
    })?;
    let of_left = doubts(study, &wheels[0], "");
    let right = wheels.get(1);
    let right = right.filter(|right| doubts(study, right, "") != of_left);
    let of_right = right.map(|right| doubts(study, right, "right wheel: "));
    let limits = violated_constraints(study).map_err(|fault| design_fault(study, path, &fault))?;
    let doubts = found.into_iter().chain(of_left);
    let doubts = doubts.chain(of_right.into_iter().flatten()).chain(limits);
    for doubt in doubts.chain(study_bands_missed(study)) {
        out.remark(&format!("{doubt}\n\n"))?;
    }
    Ok(out)
}

/// Prints camber, toe, vertical force and spring force of both wheels in equilibrium at the design height. Returns false if they
/// have no equilibrium.
fn say_axle_design(
    out: &mut Printer,
    study: &AxleStudy,
    elastic: &AxleComplianceStudy,
) -> Result<bool, Stop> {
    let vehicle = study.axle.on_rig(elastic.tyre_rate);
    // Reading the study has already built the axle once, so building it again does not fail.
    let Ok(run) = AxleKcRun::new(vehicle, &elastic.parts) else {
        return Ok(false);
    };
    let state = match run.at_design() {
        Ok(state) => state,
        Err(why) => {
            out.failure(&format!(
                "\nnot solved: design height: {}\n",
                no_equilibrium(&why)
            ))?;
            return Ok(false);
        }
    };
    out.say(&design_heading(&study.axle.left))?;
    let mut table = Table::new(["output", "left", "right", "unit"]);
    let [left, right] = &state.wheels[..] else {
        return Ok(false);
    };
    let mut add = |name: &str, [left, right]: [f64; 2], unit: &str| {
        let figure = |value| crate::report::Cell::figure(value, unit);
        table.push([name.into(), figure(left), figure(right), unit.into()]);
    };
    let angles = |of: fn(&KcWheelState) -> f64| [left, right].map(|wheel| of(wheel).to_degrees());
    add("camber", angles(|wheel| wheel.figures.camber), "deg");
    add("toe", angles(|wheel| wheel.figures.toe), "deg");
    add("vertical_force", [left.wheel_load, right.wheel_load], "N");
    if let (Some(left), Some(right)) = (left.spring, right.spring) {
        add("spring_force", [left.force, right.force], "N");
    }
    out.table("design", table)?;
    Ok(true)
}

/// Heading of the values at the design height. It names the rack if the suspension has one.
fn design_heading(suspension: &Suspension) -> String {
    let rack = if suspension.mechanism.is_steered() {
        ", rack at 0"
    } else {
        ""
    };
    format!("\nEquilibrium at the design height{rack}:\n\n")
}

fn relaxed_in_words(relaxed: Relaxed) -> &'static str {
    match relaxed {
        Relaxed::Free => "without force in the design position (relaxed = \"free\")",
        Relaxed::AtDesignLoad => {
            "in equilibrium in the design position (relaxed = \"at_design_load\")"
        }
    }
}

/// Prints angles, vertical force and spring force of the wheel in equilibrium at the design height. Returns false if it has no
/// equilibrium.
fn say_design(out: &mut Printer, study: &Study, elastic: &ComplianceStudy) -> Result<bool, Stop> {
    // Reading the study has already built the wheel once, so building it again does not fail.
    let Ok(wheel) = ElasticWheel::new(study.wheel(), &elastic.parts) else {
        return Ok(false);
    };
    let at = match wheel.at(0.0, 0.0) {
        Ok(at) => at,
        Err(why) => {
            out.failure(&format!(
                "\nnot solved: design height: {}\n",
                no_equilibrium(&why)
            ))?;
            return Ok(false);
        }
    };
    let figures = wheel.figures(&at);
    out.say(&design_heading(study.wheel()))?;
    let mut table = Table::new(["output", "value", "unit"]);
    let mut add = |name: &str, value: f64, unit: &str| {
        table.push([
            name.into(),
            crate::report::Cell::figure(value, unit),
            unit.into(),
        ]);
    };
    add("camber", figures.camber.to_degrees(), "deg");
    add("toe", figures.toe.to_degrees(), "deg");
    if let Some([caster, inclination]) = figures.steering {
        add("caster", caster.to_degrees(), "deg");
        add("kingpin_inclination", inclination.to_degrees(), "deg");
    }
    add("vertical_force", wheel.wheel_load(&at), "N");
    if let Some(spring) = wheel.spring(&at) {
        add("spring_force", spring.force, "N");
    }
    out.table("design", table)?;
    Ok(true)
}

/// Warnings about the elastic parts of a wheel, one per line. `wheel` is the text that names the wheel in each warning, such as
/// `right wheel: `. It may be empty.
fn doubts(study: &Study, parts: &Compliance, wheel: &str) -> Vec<String> {
    let mechanism = &study.wheel().mechanism;
    let mut doubts = Vec::new();
    for arm in &mechanism.arms {
        let given = [arm.front, arm.rear].map(|id| parts.bushing_at(id).is_some());
        let [one, other] = match given {
            [true, false] => [arm.front, arm.rear],
            [false, true] => [arm.rear, arm.front],
            _ => continue,
        };
        doubts.push(format!(
            "{wheel}{} has a bushing, but {} has none and is a rigid ball joint",
            mechanism.name(one),
            mechanism.name(other)
        ));
    }
    let rates = parts
        .bushings
        .iter()
        .flat_map(|part| part.shapes[..3].iter().map(|shape| shape.initial_rate()))
        .filter(|rate| *rate > 0.0);
    let least = rates.fold(f64::INFINITY, f64::min);
    let in_millimetres = study.wheel().length_unit == LengthUnit::Millimetre;
    if in_millimetres && least.is_finite() && least > DOUBTFUL_RATE {
        doubts.push(format!(
            "please check: {wheel}all rates of bushings are above 1e6 N/mm (the lowest is {} N/mm); are they \
             in N/m?",
            brief(least)
        ));
    }
    doubts
}
