//! `hardpoint new --with bushings`: the elastic parts of a template.

use crate::compliance::{bushing_points, link_members};
use crate::model::{Body, Constraint, Mechanism, PointId, Topology};
use crate::study::Study;
use std::fmt::Write as _;
use std::path::Path;

/// Characteristics that can be computed in equilibrium for every topology.
const OUTPUTS: &str = "[\"camber\", \"toe\", \"camber_gain\", \"bump_steer\", \"half_track_change\", \"wheelbase_change\"]";

/// Quantities of an axle in equilibrium, and results of its tests.
const OUTPUTS_OF_AXLE: &str = "[\"camber\", \"toe\", \"mean_steer\", \"track\", \"wheel_load\", \"toe_by_lateral_force\", \"recession_by_braking\"]";

/// Stiffness of a bushing at a pivot of an arm: along x, y, z (N/mm), then about x, y, z (N mm/rad). The x axis is along the
/// arm's axis.
const OF_ARM: &str = "[900.0, 6000.0, 6000.0, 6.0e4, 2.0e5, 2.0e5]";
/// Stiffness of a bushing at an end of a link, in the same order as [`OF_ARM`]. x is along the link.
const OF_LINK: &str = "[9000.0, 1200.0, 9000.0, 5.0e4, 1.2e5, 5.0e4]";
/// Stiffness of the top mount of a strut, in the same order as [`OF_ARM`]. The z axis points along the strut, and the mount lets
/// the strut turn freely about z.
const OF_STRUT: &str = "[600.0, 600.0, 1500.0, 2.0e4, 2.0e4, 0.0]";

/// Adds a spring and bushings to the text of a template, and axial stiffness to its tie rod or toe link, if it has one. Replaces
/// the outputs of the template.
///
/// # Errors
/// The reason in words why the topology has no elastic parts.
pub(super) fn with_bushings(
    text: &str,
    topology: &Topology,
    is_axle: bool,
) -> Result<String, String> {
    let read = Study::from_text("template.toml", text, Path::new(""));
    let study = read.map_err(|e| e.to_string())?;
    let mechanism = &study.wheel().mechanism;
    let two_joints = |c: &Constraint| mechanism.arm_under(c).is_some();
    if topology.carries_both_wheels() || mechanism.constraints.iter().any(two_joints) {
        return Err(format!("{} has no elastic parts yet", topology.name));
    }
    let mut written = String::new();
    for line in text.lines() {
        if line.starts_with("characteristics = [") {
            let outputs = if is_axle { OUTPUTS_OF_AXLE } else { OUTPUTS };
            let _ = writeln!(written, "characteristics = {outputs}");
        } else if !(is_axle && line.starts_with("roll = ")) {
            written = written + line + "\n";
        }
    }
    if is_axle {
        // With elastic parts, the tests give the derivative of steer with respect to roll, so it replaces `roll_steer`.
        written = written.replace(
            "{ characteristic = \"roll_steer\", over = \"roll\",",
            "{ figure = \"steer_by_roll\",",
        );
        let plane =
            "[motion]                         # every combination is solved, on a plane ground";
        written = written.replace(
            plane,
            "[motion]                         # every combination is a station of `hardpoint kc`",
        );
    }
    written += &sections(mechanism);
    Ok(written)
}

/// Sections for the spring, the elastic parts and the relaxed position.
fn sections(mechanism: &Mechanism) -> String {
    let mut text = String::from(
        "\n[spring]\n\
         rate = 40.0                      # N/mm along the spring\n\
         force = 4000.0                   # N in the design position\n\n\
         # Elastic parts: `hardpoint kc` loads the wheel as a rig does. Without these sections the mechanism is rigid.\n\
         [compliance]\n\
         relaxed = \"at_design_load\"       # the hardpoints describe the loaded car; or \"free\": no bushing has a force there\n\n\
         # Stiffness along x, y, z in N/mm, and about them in N mm/rad. Arms: x from the rear to the front pivot; links: from the\n\
         # inner to the outer end.\n",
    );
    let links = link_members(mechanism);
    let stretching = links.iter().find(|(name, _)| is_toe_link(name));
    let of_link = |id: PointId| {
        let name = mechanism.name(id);
        stretching.is_some_and(|(link, _)| name.starts_with(link.as_str()))
    };
    for id in bushing_points(mechanism) {
        if mechanism.body(id) == Body::Rack || of_link(id) {
            continue;
        }
        let name = mechanism.name(id);
        let of_arm = mechanism
            .arms
            .iter()
            .any(|arm| [arm.front, arm.rear].contains(&id));
        let stiffness = match name {
            "strut_top" => OF_STRUT,
            _ if of_arm || name.starts_with("arm_pivot") => OF_ARM,
            _ => OF_LINK,
        };
        let _ = writeln!(text, "[bushings.{name}]\nstiffness = {stiffness}\n");
    }
    if let Some((name, _)) = stretching {
        let _ = writeln!(
            text,
            "[links.{name}]\nmodulus = 70000.0                # N/mm^2\narea = 110.0                     # mm^2 of its section"
        );
    }
    text
}

/// True for the tie rod or the toe link.
fn is_toe_link(name: &str) -> bool {
    matches!(name, "tie_rod" | "toe_link")
}
