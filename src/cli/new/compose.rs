//! Composes the text of a template with additional parts.

use super::Part;
use super::bushings::with_bushings;
use super::fittings::{
    ANTI_ROLL_BAR, DRAG_LINK, DRAG_LINK_PLACES, FITTINGS, FIVE_LINKS, FIVE_LINKS_PLACES, Fitting,
    PANHARD, PANHARD_PLACES, PUSHROD, WATT, WATT_PLACES,
};
use super::links::with_links;
use super::sections::{as_steered_front_axle, with_axle, with_points, with_springs};
use crate::model::Topology;
use std::fmt::Write as _;

/// Name of the solid axle.
const SOLID_AXLE: &str = "solid_axle";

/// Targets of the template of one wheel: constant toe.
const TARGETS: &str = r#"  { characteristic = "toe", points = [[-80.0, 0.1], [0.0, 0.1], [80.0, 0.1]], tolerance = 0.03 },
"#;

/// Targets for suspensions in which moves of the inner points can hardly keep the toe constant. The target is a roll
/// centre at a given height.
const ROLL_CENTRE_TARGETS: &str = r#"  { characteristic = "roll_centre_height", at = 0.0, value = 140.0, tolerance = 2.0 },
"#;
/// Topologies that get [`ROLL_CENTRE_TARGETS`].
const STEERED_BY_TRAVEL: [&str; 3] = [
    "semi_trailing_arm",
    "trailing_arm_two_links",
    "integral_link",
];

/// Targets of an axle: constant toe in heave, and no roll steer.
const AXLE_TARGETS: &str = r#"  { characteristic = "toe", over = "heave", points = [[-20.0, 0.1], [0.0, 0.1], [20.0, 0.1]], tolerance = 0.02 },
  { characteristic = "roll_steer", over = "roll", between = [-0.02, 0.02], tolerance = 0.005 },
"#;

/// Targets of a solid axle: little roll steer, and anti-squat.
const SOLID_AXLE_TARGETS: &str = r#"  { characteristic = "roll_steer", over = "roll", between = [-0.02, 0.02], tolerance = 0.005 },
  { characteristic = "anti_squat", over = "heave", roll = 0.0, at = 0.0, value = 100.0, tolerance = 2.0 },
"#;

/// Targets of a steered solid axle: no steer in heave, and little steer in roll.
const STEERED_AXLE_TARGETS: &str = r#"  { characteristic = "mean_steer", over = "heave", roll = 0.0, points = [[-30.0, 0.0], [0.0, 0.0], [30.0, 0.0]], tolerance = 0.02 },
  { characteristic = "roll_steer", over = "roll", between = [-0.02, 0.02], tolerance = 0.005 },
"#;

/// Targets of a twist beam: a roll centre at a given height.
const TWIST_BEAM_TARGETS: &str = r#"  { characteristic = "force_roll_centre_height", over = "heave", roll = 0.0, at = 0.0, value = 200.0, tolerance = 5.0 },
"#;

/// Composes the template of a topology with parts.
///
/// # Errors
/// The reason in words, if the topology does not have a part.
pub(super) fn study(topology: &Topology, parts: &[Part]) -> Result<String, String> {
    // Editors look for the schema in the folder of the study. `hardpoint schema > hardpoint.schema.json` writes it there.
    let own = format!("{}_solve.toml", topology.name);
    let template = topology.template.replace(&own, "STUDY.toml");
    let mut composed = Composed {
        topology,
        parts,
        text: format!("#:schema ./hardpoint.schema.json\n{template}"),
    };
    if composed.has(Part::Axle) && topology.carries_both_wheels() {
        return Err(format!(
            "{} is already an axle: leave axle out of --with",
            topology.name
        ));
    }
    composed.add_lateral_linkage()?;
    composed.add_drag_link()?;
    if composed.has(Part::Axle) {
        composed.text = with_axle(&composed.text);
    }
    let needs_fitting = [
        Part::Pushrod,
        Part::AntiRollBar,
        Part::Sweep,
        Part::Optimise,
    ];
    let fitting = if needs_fitting.iter().any(|part| composed.has(*part)) {
        Some(composed.fitting()?)
    } else {
        None
    };
    if let Some(fitting) = fitting {
        composed.add_rockers(fitting)?;
    }
    if composed.is_sprung() {
        composed.text = with_springs(&composed.text, composed.has(Part::AntiRollBar));
    }
    if let Some(fitting) = fitting {
        composed.add_tasks(fitting);
    }
    match composed.is_elastic() {
        true if topology.name == SOLID_AXLE => {
            let rigid = [
                (Part::Watt, "with a Watt linkage"),
                (Part::DragLink, "that is steered"),
            ];
            match rigid.into_iter().find(|(part, _)| composed.has(*part)) {
                Some((_, words)) => Err(format!(
                    "elastic parts are not yet available for a solid axle {words}"
                )),
                None => Ok(with_links(&composed.text)),
            }
        }
        true => with_bushings(&composed.text, topology, composed.has(Part::Axle)),
        false => Ok(composed.text),
    }
}

/// Text of a template while parts are added to it.
struct Composed<'a> {
    topology: &'a Topology,
    parts: &'a [Part],
    text: String,
}

impl Composed<'_> {
    fn has(&self, part: Part) -> bool {
        self.parts.contains(&part)
    }

    /// True if the study gets elastic parts.
    fn is_elastic(&self) -> bool {
        self.has(Part::Bushings) || self.has(Part::FiveLinks)
    }

    fn fitting(&self) -> Result<&'static Fitting, String> {
        let name = self.topology.name;
        let found = FITTINGS.iter().find(|fitting| fitting.topology == name);
        found.ok_or_else(|| format!("{name} has no parts to add: leave out --with"))
    }

    /// Adds a Panhard rod or a Watt linkage.
    fn add_lateral_linkage(&mut self) -> Result<(), String> {
        let lateral = [
            (Part::Panhard, "Panhard rod", PANHARD, &PANHARD_PLACES[..]),
            (Part::Watt, "Watt linkage", WATT, &WATT_PLACES[..]),
            (
                Part::FiveLinks,
                "Panhard rod",
                FIVE_LINKS,
                &FIVE_LINKS_PLACES[..],
            ),
        ];
        let lateral: Vec<_> = lateral
            .into_iter()
            .filter(|(part, ..)| self.has(*part))
            .collect();
        if lateral.len() > 1 {
            return Err(
                "choose only one of panhard, watt and five_links: each locates the axle laterally"
                    .to_owned(),
            );
        }
        for (part, name, points, places) in lateral {
            if self.topology.hardpoint("panhard_axle").is_none() {
                return Err(format!("{} has no {name}", self.topology.name));
            }
            let single =
                "# single = [\"upper_link\"]        # with a Panhard rod or a Watt linkage";
            let with = format!("single = [\"upper_link\"]          # with a {name}");
            if part != Part::FiveLinks {
                self.text = self.text.replace(single, &with);
            }
            self.text = with_points(&self.text, points, places, "axle", "jacking_force_ratio");
        }
        Ok(())
    }

    /// Adds drag link, kingpins and tie rod. The axle becomes a front axle.
    fn add_drag_link(&mut self) -> Result<(), String> {
        if !self.has(Part::DragLink) {
            return Ok(());
        }
        if self.topology.hardpoint("drag_link_body").is_none() {
            return Err(format!("{} has no drag link", self.topology.name));
        }
        self.text = as_steered_front_axle(&self.text);
        self.text = with_points(
            &self.text,
            DRAG_LINK,
            &DRAG_LINK_PLACES,
            "axle",
            "mean_steer",
        );
        Ok(())
    }

    /// Adds the pushrod and the anti-roll bar, if they are requested. Returns an error if the topology has no such part.
    fn add_rockers(&mut self, fitting: &Fitting) -> Result<(), String> {
        let name = self.topology.name;
        let carrier = fitting.carrier;
        if self.has(Part::Pushrod) {
            let places = fitting.pushrod.ok_or_else(|| {
                if self.topology.carries_both_wheels() {
                    format!("{name} has no pushrod")
                } else {
                    format!("{name} has no pushrod: its strut is the spring")
                }
            })?;
            self.text = with_points(&self.text, PUSHROD, &places, carrier, "rocker_angle");
        }
        if self.has(Part::AntiRollBar) {
            let places = fitting.anti_roll_bar.ok_or_else(|| {
                format!("{name} has no separate anti-roll bar: add its rate to torsional_rate")
            })?;
            let output = "anti_roll_bar_angle";
            self.text = with_points(&self.text, ANTI_ROLL_BAR, &places, carrier, output);
            if self.has(Part::Pushrod) {
                // If there is a rocker, the study must state the body to which the drop link is attached.
                let body = carrier.replace(' ', "_");
                let bodies =
                    format!("\n[suspension.bodies]\ndrop_link_outer = \"{body}\"\n\n[wheel]");
                self.text = self.text.replacen("\n[wheel]", &bodies, 1);
            }
        }
        Ok(())
    }

    /// True if the template of an axle gets a spring: it has the end points of a spring or strut, and no elastic parts. Elastic
    /// parts add their own spring.
    fn is_sprung(&self) -> bool {
        let has_ends = ["\nspring_lower ", "\nstrut_top "]
            .iter()
            .any(|end| self.text.contains(end));
        has_ends && self.has(Part::Axle) && !self.is_elastic()
    }

    /// Adds the sections `[sweep]` and `[optimise]`.
    fn add_tasks(&mut self, fitting: &Fitting) {
        let steers = if self.has(Part::DragLink) {
            "drag_link_body"
        } else {
            fitting.steers
        };
        if self.has(Part::Sweep) {
            let _ = write!(
                self.text,
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
        if self.has(Part::Optimise) {
            let targets = match (self.topology.carries_both_wheels(), self.has(Part::Axle)) {
                _ if self.topology.is_twist_beam() => TWIST_BEAM_TARGETS,
                _ if self.has(Part::DragLink) => STEERED_AXLE_TARGETS,
                (true, _) => SOLID_AXLE_TARGETS,
                (false, true) => AXLE_TARGETS,
                // The roll centre of a single wheel needs a rigid mechanism.
                (false, false)
                    if STEERED_BY_TRAVEL.contains(&self.topology.name) && !self.is_elastic() =>
                {
                    ROLL_CENTRE_TARGETS
                }
                (false, false) => TARGETS,
            };
            let _ = write!(
                self.text,
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
    }
}
