//! `hardpoint new`

use super::exit::{Exit, Stop};
use super::instead::instead_of;
use crate::car::{CarTemplate, TEMPLATES};
use crate::model::Topology;
use crate::study::nearest;
use clap::{Args, ValueEnum};
use std::fmt::Write as _;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Arguments of `hardpoint new`.
#[derive(Args)]
#[command(after_help = topologies())]
pub(super) struct NewArguments {
    /// Kind of suspension, such as macpherson; or a car: see the list below
    topology: String,
    /// Directory for the three files of a car
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
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
    /// Rubber bushings, for `hardpoint kc`
    Bushings,
}

/// Points of a part, with name and description.
type Points = &'static [(&'static str, &'static str)];

const PUSHROD: Points = &[
    ("pushrod_outer", "pushrod at the {carrier}"),
    ("pushrod_inner", "pushrod at the rocker"),
    ("rocker_pivot_front", "front point of the rocker's axis"),
    ("rocker_pivot_rear", "rear point of the rocker's axis"),
    ("spring_lower", "spring and damper at the rocker"),
    ("spring_upper", "spring and damper at the body"),
];

const ANTI_ROLL_BAR: Points = &[
    ("drop_link_outer", "drop link at the {carrier}"),
    ("drop_link_inner", "drop link at the lever of the bar"),
    ("anti_roll_bar_inner", "inboard point of the bar's axis"),
    ("anti_roll_bar_outer", "outboard point of the bar's axis"),
];

const PANHARD: Points = &[
    (
        "upper_link_chassis",
        "upper link at the body; single, with its true y",
    ),
    ("upper_link_axle", "upper link at the axle"),
    ("panhard_chassis", "Panhard rod at the body; true y"),
    ("panhard_axle", "Panhard rod at the axle"),
];

const WATT: Points = &[
    PANHARD[0],
    PANHARD[1],
    (
        "watt_pivot",
        "pivot of the Watt rocker, on the axle; true y",
    ),
    ("watt_axis", "a second point of its axis"),
    ("watt_upper_chassis", "upper Watt link at the body; true y"),
    ("watt_upper_rocker", "upper Watt link at the rocker"),
    ("watt_lower_chassis", "lower Watt link at the body; true y"),
    ("watt_lower_rocker", "lower Watt link at the rocker"),
];

/// Places of the points of [`WATT`].
const WATT_PLACES: [[f64; 3]; WATT.len()] = [
    PANHARD_PLACES[0],
    PANHARD_PLACES[1],
    [-150.0, 0.0, 340.0],
    [-100.0, 0.0, 340.0],
    [-150.0, 480.0, 400.0],
    [-150.0, 0.0, 410.0],
    [-150.0, -480.0, 280.0],
    [-150.0, 0.0, 270.0],
];

/// Places of the points of [`PANHARD`] in the template of a solid axle.
const PANHARD_PLACES: [[f64; 3]; PANHARD.len()] = [
    [420.0, 50.0, 470.0],
    [15.0, 70.0, 480.0],
    [-140.0, 480.0, 360.0],
    [-140.0, -470.0, 335.0],
];

/// Differences between templates: coordinates in the template's axes.
struct Fitting {
    topology: &'static str,
    /// A hardpoint that steers the wheel in jounce.
    steers: &'static str,
    /// Body of pushrod and drop link.
    carrier: &'static str,
    pushrod: Option<[[f64; 3]; PUSHROD.len()]>,
    anti_roll_bar: Option<[[f64; 3]; ANTI_ROLL_BAR.len()]>,
}

const FITTINGS: [Fitting; 9] = [
    Fitting {
        topology: "twist_beam",
        steers: "mount",
        carrier: "arm",
        pushrod: None,
        anti_roll_bar: None,
    },
    Fitting {
        topology: "trailing_arm_two_links",
        steers: "lower_link_inner",
        carrier: "arm",
        pushrod: Some([
            [70.0, 580.0, 270.0],
            [70.0, 442.0, 604.0],
            [90.0, 330.0, 520.0],
            [50.0, 330.0, 520.0],
            [70.0, 246.0, 632.0],
            [70.0, 46.0, 482.0],
        ]),
        anti_roll_bar: Some([
            [100.0, 580.0, 250.0],
            [100.0, 570.0, 380.0],
            [300.0, 50.0, 380.0],
            [300.0, 560.0, 380.0],
        ]),
    },
    Fitting {
        topology: "integral_link",
        steers: "toe_link_inner",
        carrier: "lower arm",
        pushrod: Some([
            [10.0, 580.0, 235.0],
            [10.0, 410.0, 500.0],
            [30.0, 330.0, 430.0],
            [-10.0, 330.0, 430.0],
            [10.0, 260.0, 520.0],
            [10.0, 60.0, 380.0],
        ]),
        anti_roll_bar: Some([
            [40.0, 560.0, 235.0],
            [40.0, 550.0, 360.0],
            [-160.0, 50.0, 360.0],
            [-160.0, 540.0, 360.0],
        ]),
    },
    Fitting {
        topology: "h_arm",
        steers: "lower_arm_front",
        carrier: "lower arm",
        pushrod: Some([
            [0.0, 590.0, 220.0],
            [0.0, 410.0, 490.0],
            [20.0, 330.0, 420.0],
            [-20.0, 330.0, 420.0],
            [0.0, 260.0, 510.0],
            [0.0, 60.0, 370.0],
        ]),
        anti_roll_bar: Some([
            [40.0, 560.0, 230.0],
            [40.0, 550.0, 350.0],
            [-160.0, 50.0, 350.0],
            [-160.0, 540.0, 350.0],
        ]),
    },
    Fitting {
        topology: "solid_axle",
        steers: "lower_link_chassis",
        carrier: "axle",
        pushrod: None,
        anti_roll_bar: Some([
            [-60.0, 520.0, 300.0],
            [-60.0, 515.0, 420.0],
            [-260.0, 50.0, 420.0],
            [-260.0, 510.0, 420.0],
        ]),
    },
    Fitting {
        topology: "macpherson",
        steers: "tie_rod_inner",
        carrier: "knuckle",
        pushrod: None,
        anti_roll_bar: Some([
            [40.0, 620.0, 230.0],
            [40.0, 610.0, 380.0],
            [-160.0, 50.0, 380.0],
            [-160.0, 600.0, 380.0],
        ]),
    },
    Fitting {
        topology: "double_wishbone",
        steers: "tie_rod_inner",
        carrier: "lower arm",
        pushrod: Some([
            [0.0, 600.0, 205.0],
            [0.0, 410.0, 470.0],
            [20.0, 330.0, 410.0],
            [-20.0, 330.0, 410.0],
            [0.0, 270.0, 490.0],
            [0.0, 70.0, 340.0],
        ]),
        anti_roll_bar: Some([
            [40.0, 560.0, 210.0],
            [40.0, 550.0, 340.0],
            [-160.0, 50.0, 340.0],
            [-160.0, 540.0, 340.0],
        ]),
    },
    Fitting {
        topology: "five_link",
        steers: "toe_link_inner",
        carrier: "knuckle",
        pushrod: Some([
            [-70.0, 640.0, 200.0],
            [-70.0, 442.0, 604.0],
            [-50.0, 330.0, 520.0],
            [-90.0, 330.0, 520.0],
            [-70.0, 246.0, 632.0],
            [-70.0, 46.0, 482.0],
        ]),
        anti_roll_bar: Some([
            [40.0, 660.0, 230.0],
            [40.0, 650.0, 380.0],
            [240.0, 50.0, 380.0],
            [240.0, 640.0, 380.0],
        ]),
    },
    Fitting {
        topology: "semi_trailing_arm",
        steers: "arm_pivot_inner",
        carrier: "arm",
        pushrod: Some([
            [70.0, 580.0, 270.0],
            [70.0, 442.0, 604.0],
            [90.0, 330.0, 520.0],
            [50.0, 330.0, 520.0],
            [70.0, 246.0, 632.0],
            [70.0, 46.0, 482.0],
        ]),
        anti_roll_bar: Some([
            [100.0, 560.0, 250.0],
            [100.0, 550.0, 380.0],
            [300.0, 50.0, 380.0],
            [300.0, 540.0, 380.0],
        ]),
    },
];

/// Targets of the template: constant toe.
const TARGETS: &str = r#"  { characteristic = "toe", points = [[-80.0, 0.1], [0.0, 0.1], [80.0, 0.1]], tolerance = 0.02 },
"#;

/// Targets of an axle: constant toe in heave, and no roll steer.
const AXLE_TARGETS: &str = r#"  { characteristic = "toe", over = "heave", points = [[-20.0, 0.1], [0.0, 0.1], [20.0, 0.1]], tolerance = 0.02 },
  { characteristic = "roll_steer", over = "roll", between = [-0.02, 0.02], tolerance = 0.005 },
"#;

/// Targets of a solid axle: little roll steer, and anti-squat.
const SOLID_AXLE_TARGETS: &str = r#"  { characteristic = "roll_steer", over = "roll", between = [-0.02, 0.02], tolerance = 0.005 },
  { characteristic = "anti_squat", over = "heave", roll = 0.0, at = 0.0, value = 100.0, tolerance = 2.0 },
"#;

/// Targets of a twist beam: little roll steer, and a roll centre at this height.
const TWIST_BEAM_TARGETS: &str = r#"  { characteristic = "roll_steer", over = "roll", between = [-0.02, 0.02], tolerance = 0.005 },
  { characteristic = "force_roll_centre_height", over = "heave", roll = 0.0, at = 0.0, value = 200.0, tolerance = 5.0 },
"#;

/// A commented study of a topology that runs, with parts by their names.
///
/// # Errors
/// The reason in words: a name that is unknown, or a part that the topology does not have.
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

/// Writes the three studies of a car. Nothing is written if one of the files is there.
fn write_car((name, files): &CarTemplate, arguments: &NewArguments) -> Result<Exit, Stop> {
    if !arguments.with.is_empty() {
        return Err(Stop::wrong_input(format!(
            "{name} has no parts to add: leave --with out"
        )));
    }
    let directory = arguments.out.as_deref().unwrap_or(Path::new("."));
    let paths = files.map(|(file, _)| directory.join(file));
    if let Some(taken) = paths.iter().find(|path| path.exists()) {
        return Err(Stop::wrong_input(format!(
            "{} is there already, and nothing is written; give another directory with --out",
            taken.display()
        )));
    }
    std::fs::create_dir_all(directory)?;
    for (path, (_, text)) in paths.iter().zip(files) {
        std::fs::write(path, text)?;
        super::terminal::print(&format!("{}\n", path.display()))?;
    }
    Ok(Exit::Done)
}

/// All topologies and cars, a line each.
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
    if arguments.out.is_some() {
        let message = "--out is for cars, which are three files; the study of a suspension goes to standard output";
        return Err(Stop::wrong_input(message));
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
    std::io::stdout().write_all(text.as_bytes())?;
    Ok(Exit::Done)
}

/// The template of a topology with parts.
fn study(topology: &Topology, parts: &[Part]) -> Result<String, String> {
    // Editors look for the schema beside the study: `hardpoint schema > hardpoint.schema.json`.
    let own = format!("{}_solve.toml", topology.name);
    let template = topology.template.replace(&own, "STUDY.toml");
    let mut text = format!("#:schema ./hardpoint.schema.json\n{template}");
    let is_axle = parts.contains(&Part::Axle);
    let is_solid = topology.carries_both_wheels();
    if is_axle && is_solid {
        return Err(format!("{} is an axle without this part", topology.name));
    }
    let lateral = [
        (Part::Panhard, "Panhard rod", PANHARD, &PANHARD_PLACES[..]),
        (Part::Watt, "Watt linkage", WATT, &WATT_PLACES[..]),
    ];
    let lateral: Vec<_> = lateral
        .into_iter()
        .filter(|(part, ..)| parts.contains(part))
        .collect();
    if lateral.len() > 1 {
        return Err("a Panhard rod or a Watt linkage holds an axle sideways, not both".to_owned());
    }
    for (_, name, points, places) in lateral {
        if topology.hardpoint("panhard_axle").is_none() {
            return Err(format!("{} has no {name}", topology.name));
        }
        let single = "# single = [\"upper_link\"]        # with a Panhard rod or a Watt linkage";
        let with = format!("single = [\"upper_link\"]          # with a {name}");
        text = text.replace(single, &with);
        text = with_points(&text, points, places, "axle", "jacking_force_ratio");
    }
    if is_axle {
        text = with_axle(&text);
    }
    let has_bushings = parts.contains(&Part::Bushings);
    let finished = |text: String| match has_bushings {
        true => super::new_bushings::with_bushings(&text, topology, is_axle),
        false => Ok(text),
    };
    let is_done = |part: &Part| {
        matches!(
            part,
            Part::Axle | Part::Panhard | Part::Watt | Part::Bushings
        )
    };
    // Elastic parts bring a spring of their own.
    let is_sprung = |text: &str| {
        let has_ends = text.contains("\nspring_lower ") || text.contains("\nstrut_top ");
        has_ends && is_axle && !has_bushings
    };
    if parts.iter().all(is_done) {
        return finished(match is_sprung(&text) {
            true => with_springs(&text, false),
            false => text,
        });
    }
    let fitting = FITTINGS
        .iter()
        .find(|fitting| fitting.topology == topology.name);
    let fitting =
        fitting.ok_or_else(|| format!("{} has no parts to choose from yet", topology.name))?;
    if parts.contains(&Part::Pushrod) {
        let places = fitting.pushrod.ok_or_else(|| match is_solid {
            true => format!("{} has no pushrod", topology.name),
            false => format!("{} has no pushrod: its strut is the spring", topology.name),
        })?;
        text = with_points(&text, PUSHROD, &places, fitting.carrier, "rocker_angle");
    }
    if parts.contains(&Part::AntiRollBar) {
        let places = fitting.anti_roll_bar.ok_or_else(|| {
            format!(
                "{} has no anti-roll bar of its own: add its rate to torsional_rate",
                topology.name
            )
        })?;
        let carrier = fitting.carrier;
        text = with_points(
            &text,
            ANTI_ROLL_BAR,
            &places,
            carrier,
            "anti_roll_bar_angle",
        );
        if parts.contains(&Part::Pushrod) {
            // Beside a rocker a study must say where the drop link stands.
            let body = carrier.replace(' ', "_");
            let said = format!("\n[suspension.bodies]\ndrop_link_outer = \"{body}\"\n\n[wheel]");
            text = text.replacen("\n[wheel]", &said, 1);
        }
    }
    if is_sprung(&text) {
        text = with_springs(&text, parts.contains(&Part::AntiRollBar));
    }
    let steers = fitting.steers;
    if parts.contains(&Part::Sweep) {
        let _ = write!(
            text,
            r#"
[sweep]
method = "sobol"                 # or "latin_hypercube", "random", "saltelli"; or "grid" with steps in each variable
samples = 1024
variables = [                    # offsets from the design
  {{ hardpoint = "{steers}", axis = "z", range = [-10.0, 10.0] }},
  {{ hardpoint = "{steers}", axis = "y", range = [-10.0, 10.0] }},
]
"#
        );
    }
    if parts.contains(&Part::Optimise) {
        let targets = match (is_solid, is_axle) {
            _ if topology.is_twist_beam() => TWIST_BEAM_TARGETS,
            (true, _) => SOLID_AXLE_TARGETS,
            (false, true) => AXLE_TARGETS,
            (false, false) => TARGETS,
        };
        let _ = write!(
            text,
            r#"
[optimise]
starts = 4                       # the design, then points spread over the ranges
variables = [                    # offsets from the design
  {{ hardpoint = "{steers}", axis = "z", range = [-20.0, 20.0] }},
  {{ hardpoint = "{steers}", axis = "y", range = [-20.0, 20.0] }},
]
targets = [                      # a curve over the motion, or `at` one value of it
{targets}]
"#
        );
    }
    finished(text)
}

/// Outputs of an axle.
const AXLE_OUTPUTS: [&str; 8] = [
    "camber",
    "camber_to_road",
    "toe",
    "track",
    "roll_centre_height",
    "force_roll_centre_height",
    "roll_camber",
    "roll_steer",
];

/// The text with both wheels in place of one: with the motion and the outputs of an axle.
fn with_axle(text: &str) -> String {
    let is_steered = text.lines().any(|line| line.starts_with("rack = "));
    let mut written = String::new();
    let mut is_left_out = false;
    for line in text.lines() {
        if line.starts_with('[') {
            is_left_out = true;
        }
        match line.trim() {
            "[motion]" => {
                written += "[axle]\n\
                    right = \"mirrored\"               # or [axle.right.hardpoints]: those that are not the mirror image\n\n";
                if is_steered {
                    written += "[steering]\n\
                        c_factor = -52.0                 # length of rack along +y per turn of the steering wheel to the left; \
                        negative: behind the axle\n\n";
                }
                written += "[motion]                         # every combination is solved, on a plane ground\n\
                    roll = { from = -3.0, to = 3.0, steps = 13 }   # degrees; positive: right wheel in jounce, as in a left turn\n\
                    heave = [-20.0, 0.0, 20.0]       # mean travel of both wheels\n";
                if is_steered {
                    written +=
                        "steering_wheel_angle = [0.0, 90.0]   # degrees to the left; or rack\n";
                }
                written += "\n";
            }
            "[outputs]" => {
                let steered = is_steered.then_some("mean_steer");
                let names = AXLE_OUTPUTS.into_iter().chain(steered);
                let names: Vec<String> = names.map(|name| format!("\"{name}\"")).collect();
                let _ = writeln!(
                    written,
                    "[outputs]                        # of a wheel: columns for left and right\n\
                     characteristics = [{}]\n\
                     # order = \"velocity\"             # derivatives by roll, heave and rack as well\n\
                     # sensitivities = [\"wheel_centre\"]   # derivatives by hardpoint coordinates; true: all hardpoints",
                    names.join(", ")
                );
            }
            _ => {
                is_left_out &= !line.starts_with('[');
                if !is_left_out {
                    written = written + line + "\n";
                }
            }
        }
    }
    written
}

/// The text of an axle with springs, bump stops, tyres, masses and, if there is a bar, its rate; and with their outputs.
fn with_springs(text: &str, has_bar: bool) -> String {
    let bar = match has_bar {
        true => {
            "[anti_roll_bar]\n\
             rate = 6.0e5                     # N mm per rad between its levers\n\n"
        }
        false => "",
    };
    let vehicle = match text.contains("\n[vehicle]") {
        true => "",
        false => {
            "[vehicle]\n\
             sprung_mass = 680.0              # kg on this axle\n\
             unsprung_mass = 84.0             # kg of the axle\n\n"
        }
    };
    let sections = format!(
        "\n[spring]\n\
         rate = 30.0                      # N/mm along the spring\n\
         force = 3800.0                   # N in the design position\n\n\
         [bump_stop]\n\
         gap = 45.0                       # mm of spring compression before contact with the stop\n\
         force_curve = [[0.0, 0.0], [10.0, 400.0], [20.0, 1500.0], [40.0, 9000.0]]   # its compression, its force\n\n\
         {bar}[tyre]\n\
         rate = 220.0                     # N/mm\n\n\
         {vehicle}[motion]"
    );
    let text = text.replacen("\n[motion]", &sections, 1);
    let outputs = "\"wheel_load\", \"roll_stiffness\", \"ride_rate\"";
    let mut written = String::new();
    for line in text.lines() {
        match line.strip_prefix("characteristics = [") {
            Some(names) => {
                let names = names.trim_end_matches(']');
                let _ = writeln!(written, "characteristics = [{names}, {outputs}]");
            }
            None => written = written + line + "\n",
        }
    }
    written
}

/// Text with the points of a part after its hardpoints, replacing those of the same name, and with one more output.
fn with_points(
    text: &str,
    points: Points,
    places: &[[f64; 3]],
    carrier: &str,
    output: &str,
) -> String {
    let is_replaced = |line: &str| {
        let key = line.split('=').next().unwrap_or("").trim();
        points.iter().any(|(name, _)| *name == key)
    };
    let mut written = String::new();
    let mut within = false;
    for line in text.lines() {
        if within && (line.trim().is_empty() || line.starts_with("# Pushrod")) {
            for ((name, what), [x, y, z]) in points.iter().zip(places) {
                let what = what.replace("{carrier}", carrier);
                let _ = writeln!(
                    written,
                    "{name:20} = [{x:7.1}, {y:6.1}, {z:6.1}]   # {what}"
                );
            }
            within = false;
        }
        within |= line.starts_with("[suspension.hardpoints]");
        if is_replaced(line) || line.starts_with("# Pushrod") {
            continue;
        }
        match line.strip_prefix("characteristics = [") {
            Some(names) => {
                let names = names.trim_end_matches(']');
                let _ = writeln!(written, "characteristics = [{names}, \"{output}\"]");
            }
            None => written = written + line + "\n",
        }
    }
    written
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axle::axle_curves;
    use crate::curves::curves;
    use crate::plan::Plan;
    use crate::study::Study;
    use std::path::Path;

    /// An axle has what loads, stiffnesses and frequencies need; one wheel has no such sections.
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

    /// Each part, all parts together, and all parts of one wheel, over the whole motion. A solid axle has a Panhard rod or a Watt
    /// linkage.
    #[test]
    fn every_template_runs_with_every_part() {
        for topology in Topology::ALL {
            let all: Vec<Part> = Part::value_variants()
                .iter()
                .copied()
                .filter(|part| *part != Part::Bushings && study(topology, &[*part]).is_ok())
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

    /// Templates with bushings have equilibria in all their tests, of one wheel and of an axle.
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
        ];
        assert!(
            expected.iter().all(|name| names.contains(name)),
            "{names:?}"
        );
    }
}
