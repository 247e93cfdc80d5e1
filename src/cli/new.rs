//! `hardpoint new`: prints a commented study of a topology or a car.

mod bushings;
mod compose;
mod fittings;
mod links;
mod sections;

use super::exit::{Exit, Stop};
use super::instead::instead_of;
use super::save::{file_of_out, note_saved, save, save_all};
use super::terminal::print;
use crate::car::{CarTemplate, TEMPLATES};
use crate::model::Topology;
use crate::study::nearest;
use clap::{Args, ValueEnum};
use compose::study;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Arguments of `hardpoint new`.
#[derive(Args)]
#[command(after_help = topologies())]
pub(super) struct NewArguments {
    /// Kind of suspension, such as macpherson, or kind of car; see the list below
    topology: String,
    /// File for the study [default: standard output]; directory for the three files of a car
    #[arg(long, value_name = "STUDY")]
    out: Option<PathBuf>,
    /// Replace an existing file
    #[arg(long)]
    force: bool,
    /// Parts to add to the study, separated by commas
    #[arg(long, value_enum, value_delimiter = ',', value_name = "PART")]
    with: Vec<Part>,
}

/// Parts a template may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Part {
    /// Targets and variables
    Optimise,
    /// Solve a batch of designs
    Sweep,
    /// Pushrod and rocker
    Pushrod,
    /// Anti-roll bar and drop link
    #[value(name = "anti_roll_bar")]
    AntiRollBar,
    /// Both wheels: roll on a plane ground
    Axle,
    /// Panhard rod and a single upper link of a solid axle
    Panhard,
    /// Watt linkage and a single upper link of a solid axle
    Watt,
    /// Panhard rod in addition to two upper links of a solid axle, with the stiffness of all five links
    #[value(name = "five_links")]
    FiveLinks,
    /// Drag link, kingpins and tie rod of a steered solid axle
    #[value(name = "drag_link")]
    DragLink,
    /// Rubber bushings for `hardpoint kc`; for a solid axle, links with axial stiffness
    Bushings,
}

/// Returns the commented study of a topology. `parts` names the parts to add. The study runs without changes.
///
/// # Errors
/// The reason in words: an unknown name, or a part that the topology does not have.
pub(super) fn template(topology: &str, parts: &[String]) -> Result<String, String> {
    let named = Topology::named(topology);
    let named = named.ok_or_else(|| format!("there is no topology {topology:?}"))?;
    let part = |name: &String| {
        let unknown = |_| format!("there is no part {name:?} of a template");
        Part::from_str(name, true).map_err(unknown)
    };
    let parts = parts.iter().map(part).collect::<Result<Vec<_>, _>>()?;
    study(named, &parts).map_err(|e| e.to_string())
}

/// Writes the three studies of a car. Without `--force`, writes none of them if one of the files exists.
fn write_car((name, files): &CarTemplate, arguments: &NewArguments) -> Result<Exit, Stop> {
    if !arguments.with.is_empty() {
        return Err(Stop::wrong_input(format!(
            "{name} has no parts to add: omit --with"
        )));
    }
    let directory = arguments.out.as_deref().unwrap_or(Path::new("."));
    save_all(directory, files, arguments.force, &[])?;
    for (file, _) in files {
        print(&format!("{}\n", directory.join(file).display()))?;
    }
    Ok(Exit::Done)
}

/// All topologies and cars, one per line.
fn topologies() -> String {
    let topologies = Topology::ALL.iter().map(|t| (t.name, t.summary));
    let cars = TEMPLATES.iter().map(|(car, _)| match *car {
        "car" => ("car", "Road car: a car and two axles, in three files"),
        other => (other, "Formula Student car, in three files"),
    });
    let lines = topologies.chain(cars);
    let lines: Vec<String> = lines
        .map(|(name, summary)| format!("  {name:22} {summary}"))
        .collect();
    format!("Topologies:\n{}", lines.join("\n"))
}

pub(super) fn run(arguments: &NewArguments) -> Result<Exit, Stop> {
    let name = &arguments.topology;
    if let Some(car) = TEMPLATES.iter().find(|(car, _)| car == name) {
        return write_car(car, arguments);
    }
    let Some(topology) = Topology::named(name) else {
        let cars = TEMPLATES.iter().map(|(car, _)| *car);
        let meant = nearest(name, Topology::ALL.iter().map(|t| t.name).chain(cars));
        let meant = match (instead_of(name), meant) {
            (Some(answer), _) => format!(": {answer}"),
            (None, Some(near)) => format!("; did you mean {near}?"),
            (None, None) => String::new(),
        };
        return Err(Stop::wrong_input(format!(
            "there is no topology \"{name}\"{meant}\n{}",
            topologies()
        )));
    };
    let text = study(topology, &arguments.with).map_err(Stop::wrong_input)?;
    match file_of_out(&arguments.out) {
        None => std::io::stdout().write_all(text.as_bytes())?,
        Some(out) => {
            save(out, text.as_bytes(), arguments.force, &[])?;
            note_saved(out);
        }
    }
    Ok(Exit::Done)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axle::axle_curves;
    use crate::curves::curves;
    use crate::plan::Plan;
    use crate::study::Study;
    use std::path::Path;

    /// An axle template contains everything that loads, stiffnesses and frequencies need. A template of one wheel has no such
    /// sections.
    #[test]
    fn axles_with_springs_have_their_rates() {
        for (name, parts, sprung) in [
            ("macpherson", vec![Part::AntiRollBar, Part::Axle], true),
            ("double_wishbone", vec![Part::Pushrod, Part::Axle], true),
            ("double_wishbone", vec![Part::Axle], true),
            ("double_wishbone", vec![Part::Pushrod], false),
        ] {
            let topology = Topology::named(name).unwrap();
            let text = study(topology, &parts).unwrap();
            for section in ["\n[spring]", "\n[bump_stop]", "\n[tyre]", "\n[vehicle]"] {
                assert_eq!(text.contains(section), sprung, "{name} {section}");
            }
            let has_bar = parts.contains(&Part::AntiRollBar);
            assert_eq!(text.contains("[anti_roll_bar]"), has_bar, "{name}");
            assert_eq!(text.contains("\"roll_stiffness\""), sprung, "{name}");
        }
    }

    /// Each template runs over its whole motion: with each rigid part alone, with all rigid parts together, and with all rigid
    /// parts of one wheel. A solid axle gets a Panhard rod or a Watt linkage.
    #[test]
    fn every_template_runs_with_every_part() {
        for topology in Topology::ALL {
            let all: Vec<Part> = Part::value_variants()
                .iter()
                .copied()
                .filter(|part| ![Part::Bushings, Part::FiveLinks].contains(part))
                .filter(|part| study(topology, &[*part]).is_ok())
                .collect();
            let alone = all.iter().map(|part| vec![*part]);
            let without = |left_out: &[Part]| {
                let mut parts = all.clone();
                parts.retain(|part| !left_out.contains(part));
                parts
            };
            let mut together = vec![without(&[Part::Axle, Part::Watt]), without(&[Part::Watt])];
            if all.contains(&Part::Watt) {
                together.push(without(&[Part::Panhard]));
            }
            for parts in alone.chain(together) {
                let text = study(topology, &parts).unwrap();
                let study = Study::from_text("new.toml", &text, Path::new(""));
                let study = study.unwrap_or_else(|e| panic!("{} {parts:?}: {e}", topology.name));
                let complete = match study.axle() {
                    Some(axle) => axle_curves(&axle.axle, &axle.plan)
                        .unwrap()
                        .curves
                        .are_complete(),
                    None => curves(study.wheel(), &Plan::of(study.one_wheel().unwrap()))
                        .unwrap()
                        .are_complete(),
                };
                assert!(complete, "{} {parts:?}", topology.name);
                let mechanism = &study.wheel().mechanism;
                assert_eq!(mechanism.unsaid_drop_link(), None, "{parts:?}");
                let is_axle = parts.contains(&Part::Axle) || topology.carries_both_wheels();
                assert_eq!(study.axle().is_some(), is_axle);
                assert_eq!(study.optimise.is_some(), parts.contains(&Part::Optimise));
                assert_eq!(study.sweep.is_some(), parts.contains(&Part::Sweep));
            }
        }
    }

    /// Templates with bushings have an equilibrium in all their tests, for one wheel and for an axle.
    #[test]
    fn templates_with_bushings_run_on_the_rig() {
        let mut names = Vec::new();
        for topology in Topology::ALL {
            let parts = [
                &[Part::Bushings][..],
                &[Part::Bushings, Part::Axle],
                &[Part::Bushings, Part::Axle, Part::AntiRollBar],
                &[Part::Bushings, Part::Optimise],
                &[Part::Bushings, Part::Axle, Part::Optimise],
                &[Part::Bushings, Part::Panhard, Part::Sweep],
                &[Part::FiveLinks],
                &[Part::FiveLinks, Part::AntiRollBar, Part::Optimise],
            ];
            for parts in parts {
                let Ok(text) = study(topology, parts) else {
                    continue;
                };
                let study = Study::elastic_from_text("new.toml", &text, Path::new(""));
                let study = study.unwrap_or_else(|e| panic!("{} {parts:?}: {e}", topology.name));
                let tests = crate::rig::RigTests::of(&study, None).unwrap();
                assert_eq!(tests.results.failures(), Vec::<String>::new(), "{parts:?}");
                names.push(topology.name);
            }
        }
        names.dedup();
        let expected = [
            "macpherson",
            "double_wishbone",
            "five_link",
            "semi_trailing_arm",
            "trailing_arm_two_links",
            "solid_axle",
        ];
        assert!(
            expected.iter().all(|name| names.contains(name)),
            "{names:?}"
        );
    }
}
