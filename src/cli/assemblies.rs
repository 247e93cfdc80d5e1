//! `hardpoint assemblies`

use super::exit::{Exit, Stop};
use super::printer::Printer;
use super::terminal::eprint;
use super::{AssembliesArguments, TableFormat};
use crate::assembled::{Assembled, assemblies};
use crate::report::{as_written, counted};
use crate::study::Study;

/// Number of undecided places that are printed one by one.
const MOST_UNDECIDED: usize = 3;

pub(super) fn run(arguments: &AssembliesArguments) -> Result<Exit, Stop> {
    let path = &arguments.study.study;
    let study = Study::read(path, &arguments.study.set)?;
    let why = "each wheel is assembled independently, and both are almost alike";
    super::axle::refuse(&study, path, "assemblies", why)?;
    for (option, value) in [("--travel", arguments.travel), ("--rack", arguments.rack)] {
        if !value.is_finite() {
            return Err(Stop::wrong_input(format!(
                "{option} {value}: expected a finite length"
            )));
        }
    }
    let found = assemblies(&study, arguments.travel, arguments.rack);
    let Assembled {
        table,
        found,
        unproved,
        undecided,
    } = found.map_err(|why| Stop::in_file(path, why))?;
    let unit = study.suspension.length_unit.symbol();
    let mut out = Printer::new(arguments.study.format);
    if found > 0 || arguments.study.format != TableFormat::Text {
        out.table("assemblies", table)?;
    }
    let proof = match unproved {
        0 => String::new(),
        n => format!("; {n} not proved: another assembly is too close, or the same"),
    };
    match found {
        0 => out.failure(&format!(
            "at travel {} {unit}, rack {} {unit} the design's lengths cannot be assembled\n",
            as_written(arguments.travel),
            as_written(arguments.rack)
        ))?,
        1 => out.say(&format!("\n1 assembly of the design's lengths{proof}\n"))?,
        n => out.say(&format!(
            "\n{n} assemblies of the design's lengths{proof}\n"
        ))?,
    }
    out.finish()?;
    for unknown in undecided.iter().take(MOST_UNDECIDED) {
        eprint(&format!(
            "undecided: it is not known whether there {unknown}\n"
        ));
    }
    if let Some(more) = undecided.len().checked_sub(MOST_UNDECIDED + 1) {
        eprint(&format!("undecided: {}\n", counted(more + 1, "more place")));
    }
    Ok(Exit::of(undecided.is_empty() && found > 0))
}
