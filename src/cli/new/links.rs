//! Elastic links of the template of a solid axle.

use std::fmt::Write as _;

/// Start of the first line of the template with four links. [`FIVE`] replaces it if the template gets five links.
const FOUR: &str = "# A solid rear axle on four links. Every";
const FIVE: &str = "# A solid rear axle on five elastic links: two lower and two upper links, and a Panhard rod.\n# Every";

/// Quantities of a solid axle in equilibrium, and results of its roll test.
const OUTPUTS: &str = "[\"axle_steer\", \"axle_lateral\", \"pinion_angle\", \"roll_centre_height\", \"wheel_load\", \"steer_by_roll\", \
                       \"compliant_roll_stiffness\", \"link_roll_stiffness\", \"lower_link_tension\", \"upper_link_tension\"";

/// Motion of a template with elastic links. It replaces the roll motion on a plane ground.
const MOTION: &str = "[motion]                         # every combination is a station: roll where the travels differ\n\
                      travel_left = { from = -50.0, to = 50.0, steps = 5 }\n\
                      travel_right = { from = -50.0, to = 50.0, steps = 5 }\n";

/// Targets of the roll test. They replace the targets of a rigid axle.
const TARGETS: &str =
    "  { figure = \"steer_by_roll\", between = [-0.02, 0.02], tolerance = 0.005 },\n";

/// Adds a spring and the stiffness of the links to the text of a solid axle. Replaces its motion, outputs and targets.
pub(super) fn with_links(text: &str) -> String {
    let has_rod = text.contains("\npanhard_axle ");
    let text = if has_rod && !text.contains("\nsingle = ") {
        text.replace(FOUR, FIVE)
    } else {
        text.to_owned()
    };
    let mut written = String::new();
    let mut is_motion = false;
    for line in text.lines() {
        if line.starts_with('[') {
            is_motion = line.starts_with("[motion]");
        }
        if is_motion {
            if line.starts_with('[') {
                written += MOTION;
            }
            if line.is_empty() {
                written += "\n";
            }
            continue;
        }
        let is_target = line.starts_with("  { characteristic = ");
        if line.starts_with("characteristics = [") {
            let rod = if has_rod { ", \"panhard_tension\"" } else { "" };
            let _ = writeln!(written, "characteristics = {OUTPUTS}{rod}]");
        } else if is_target && line.contains("\"roll_steer\"") {
            written += TARGETS;
        } else if !is_target && !is_of_spring(line) {
            // Each group of omitted lines is between two empty lines. Only one of these two empty lines is written.
            let is_second = line.is_empty() && written.ends_with("\n\n");
            if !is_second {
                let _ = writeln!(written, "{line}");
            }
        }
    }
    written += SECTIONS;
    for link in ["lower_link", "upper_link"] {
        let _ = write!(written, "[links.{link}]\naxial_stiffness = 8000.0\n\n");
    }
    if has_rod {
        written += "[links.panhard]\naxial_stiffness = 8000.0\n";
    }
    written
}

/// True for a line of the section `[spring]` that the template has as a comment.
fn is_of_spring(line: &str) -> bool {
    ["# [spring]", "# rate = ", "# force = "]
        .iter()
        .any(|start| line.starts_with(start))
}

/// Text of the sections for the spring and for the state of the elastic parts in the design position (`relaxed`).
const SECTIONS: &str = "\n[spring]\n\
    rate = 32.0                      # N/mm along the spring\n\
    force = 4200.0                   # N in the design position\n\n\
    # Elastic links: `hardpoint kc` loads the wheels as a rig does. Links without a section are rigid.\n\
    [compliance]\n\
    relaxed = \"at_design_load\"       # the hardpoints describe the loaded car; or \"free\": no link has a force there\n\n\
    # Stiffness in N/mm between both ends, with the rubber of both joints in series.\n";
