//! `hardpoint assemblies`: finds all positions ("assemblies") in which the parts of a design fit together at a given travel.

use super::exit::{Exit, Stop};
use super::printer::Printer;
use super::terminal::eprint;
use super::{AssembliesArguments, TableFormat};
use crate::assembled::{WheelAssemblies, assemblies};
use crate::report::{as_written, counted};
use crate::study::Study;

/// Largest number of undecided search regions (such as a range of the arm angle) that are printed one by one.
const MOST_UNDECIDED: usize = 3;

pub(super) fn run(arguments: &AssembliesArguments) -> Result<Exit, Stop> {
    let path = &arguments.study.study;
    let study = Study::read(path, &arguments.study.set)?;
    for (option, value) in [("--travel", arguments.travel), ("--rack", arguments.rack)] {
        if !value.is_finite() {
            return Err(Stop::wrong_input(format!(
                "{option} {value}: expected a finite length"
            )));
        }
    }
    let found = assemblies(&study, arguments.travel, arguments.rack);
    let found = found.map_err(|why| Stop::in_file(path, why))?;
    let is_complete = found.is_complete();
    let mut out = Printer::new(arguments.study.format);
    let none = found.wheels.iter().all(|wheel| wheel.found == 0);
    if !none || arguments.study.format != TableFormat::Text {
        out.table("assemblies", found.table)?;
    }
    let unit = study.wheel().length_unit.symbol();
    for wheel in &found.wheels {
        print_number(&out, wheel, arguments, unit)?;
    }
    if let (Some(_), [_]) = (study.axle(), &found.wheels[..]) {
        out.remark(
            "The right wheel is the mirror image of the left wheel and has the same assemblies.\n",
        )?;
    }
    out.finish()?;
    for wheel in &found.wheels {
        print_undecided(wheel);
    }
    Ok(Exit::of(is_complete))
}

/// Prints the number of assemblies of a wheel. If the wheel has no assembly, also prints the travel and the rack displacement.
fn print_number(
    out: &Printer,
    wheel: &WheelAssemblies,
    arguments: &AssembliesArguments,
    unit: &str,
) -> Result<(), Stop> {
    let proof = match wheel.unproved {
        0 => String::new(),
        n => format!("; {n} not certified: another assembly is identical or too close"),
    };
    let number = match wheel.found {
        0 => {
            let none = format!(
                "at travel {} {unit}, rack {} {unit} the parts of the design cannot be assembled",
                as_written(arguments.travel),
                as_written(arguments.rack)
            );
            return out.failure(&format!("{}\n", wheel.about(&none)));
        }
        1 => format!("1 assembly with the lengths of the design{proof}"),
        n => format!("{n} assemblies with the lengths of the design{proof}"),
    };
    out.say(&format!("\n{}\n", wheel.about(&number)))
}

/// Prints the search regions, such as a range of the arm angle, in which it is not known whether an assembly exists.
fn print_undecided(wheel: &WheelAssemblies) {
    for unknown in wheel.undecided.iter().take(MOST_UNDECIDED) {
        let unknown = format!("undecided: {unknown}");
        eprint(&format!("{}\n", wheel.about(&unknown)));
    }
    if let Some(more) = wheel.undecided.len().checked_sub(MOST_UNDECIDED + 1) {
        let more = format!("undecided: {}", counted(more + 1, "more place"));
        eprint(&format!("{}\n", wheel.about(&more)));
    }
}
