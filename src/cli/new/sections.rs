//! Sections and points that are inserted into the text of a template.

use super::fittings::Points;
use std::fmt::Write as _;

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

/// Changes the study text of one wheel into the study text of an axle, with the motion and the outputs of an axle.
pub(super) fn with_axle(text: &str) -> String {
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
                     # order = \"velocity\"             # also derivatives with respect to roll, heave and rack\n\
                     # sensitivities = [\"wheel_centre\"]   # derivatives with respect to hardpoint \
                     coordinates; true: all hardpoints",
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

/// Outputs of a steered solid axle, in addition to `mean_steer`.
const STEERED_AXLE_OUTPUTS: [&str; 11] = [
    "steer",
    "camber",
    "caster",
    "kingpin_inclination",
    "scrub_radius",
    "ackermann_error",
    "roll_steer",
    "axle_lateral",
    "roll_centre_height",
    "force_roll_centre_height",
    "anti_dive",
];

/// Changes the study text of a solid rear axle into the study text of a steered front axle. All points change the sign of x.
/// Points of the Panhard rod and of the Watt linkage also change the sign of y. The Panhard rod is then nearly parallel to the
/// drag link.
pub(super) fn as_steered_front_axle(text: &str) -> String {
    let mut written = String::new();
    let mut within = false;
    for line in text.lines() {
        within = if line.starts_with('[') {
            line.starts_with("[suspension.hardpoints]")
        } else {
            within
        };
        let line = line
            .replace("A solid rear axle", "A steered solid front axle")
            .replace("position = \"rear\" ", "position = \"front\"")
            .replace("or \"front\": which", "or \"rear\": which")
            .replace(
                "needed for anti_squat and anti_lift",
                "needed for anti_dive",
            );
        let point = line.split_once(" = [").filter(|_| within);
        let coordinates = point.and_then(|(name, rest)| {
            let (numbers, about) = rest.split_once(']')?;
            let mut numbers = numbers
                .split(',')
                .map(|number| number.trim().parse::<f64>());
            let mut next = || numbers.next()?.ok();
            Some((name, [next()?, next()?, next()?], about))
        });
        if let Some((name, [x, y, z], about)) = coordinates {
            let is_single = name.starts_with("panhard") || name.starts_with("watt");
            let (x, y) = (0.0 - x, if is_single { 0.0 - y } else { y });
            let _ = writeln!(written, "{name} = [{x:6.1}, {y:6.1}, {z:6.1}]{about}");
        } else if line.starts_with("characteristics = [") {
            let names = STEERED_AXLE_OUTPUTS.map(|name| format!("\"{name}\""));
            let _ = writeln!(written, "characteristics = [{}]", names.join(", "));
        } else if line.starts_with("[motion]") {
            written += "[steering]\n\
                direction = [0.0, 1.0, 0.0]      # in which the steering gear moves drag_link_body\n\n";
            written = written + &line + "\n";
        } else if line.starts_with("heave = ") {
            written = written + &line + "\n";
            written += "rack = [-50.0, 0.0, 50.0]        # displacement of drag_link_body along the direction\n";
        } else {
            written = written + &line + "\n";
        }
    }
    written
}

/// Adds springs, bump stops, tyres and masses to the text of an axle. Also adds outputs that need these parts. With `has_bar`
/// it also adds the rate of the anti-roll bar.
pub(super) fn with_springs(text: &str, has_bar: bool) -> String {
    let bar = if has_bar {
        "[anti_roll_bar]\n\
         rate = 6.0e5                     # N mm per rad between its levers\n\n"
    } else {
        ""
    };
    let vehicle = if text.contains("\n[vehicle]") {
        ""
    } else {
        "[vehicle]\n\
         sprung_mass = 680.0              # kg on this axle\n\
         unsprung_mass = 84.0             # kg of the axle\n\n"
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

/// Adds the points of a part after the hardpoints of a study text. Also adds `output` to the requested characteristics. Points
/// of the same name are replaced.
pub(super) fn with_points(
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
