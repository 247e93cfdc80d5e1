//! Suspensions of Project Chrono: `"Type": "Suspension"` with a `"Template"` and parts with locations. Locations are in metres (x
//! forward, y left, z up) and belong to the left wheel.
//!
//! | template | topology |
//! |---|---|
//! | `DoubleWishbone`, `DoubleWishboneReduced` | `double_wishbone` |
//! | `MacPhersonStrut` | `macpherson` |
//! | `MultiLink` | `five_link`: upper arm = two links with one outer joint; trailing link = lower front, lateral link = lower rear link |
//! | `SemiTrailingArm` | `semi_trailing_arm` |
//! | `ThreeLinkIRS` | `trailing_arm_two_links` |
//! | `SolidAxle` | `solid_axle` on four links |
//! | `SolidThreeLinkAxle`, `SolidBellcrankThreeLinkAxle` | `solid_axle`: the triangular link is two upper links that share their joint at the axle |
//!
//! Chrono has two elements for spring and damper (`Spring`, `Shock`); a study has one. The importer uses the ends of the
//! spring, or the ends of the damper if there is no spring. In Chrono, the axis of a MacPherson strut is the axis of the spring. As
//! in studies, `Camber Angle (deg)` is positive with the top outward, and `Toe Angle (deg)` with the front inward.

use super::chrono_vehicle;
use super::figure_names::figure;
use super::map::{Node, place, position};
use super::table::{Figure, Kind, Marks, NamedPoint, PointTable};

/// A hardpoint, and a list of locations that can give it: names of the part and of its key. The first location that the file
/// contains is used.
type Sources = (&'static str, &'static [(&'static str, &'static str)]);

const WHEEL: Sources = ("wheel_centre", &[("Spindle", "COM")]);
const LOWER_ARM: [Sources; 3] = [
    (
        "lower_arm_front",
        &[
            ("Lower Control Arm", "Location Chassis Front"),
            ("Control Arm", "Location Chassis Front"),
        ],
    ),
    (
        "lower_arm_rear",
        &[
            ("Lower Control Arm", "Location Chassis Back"),
            ("Control Arm", "Location Chassis Back"),
        ],
    ),
    (
        "lower_ball_joint",
        &[
            ("Lower Control Arm", "Location Upright"),
            ("Control Arm", "Location Upright"),
        ],
    ),
];
const UPPER_ARM: [Sources; 3] = [
    (
        "upper_arm_front",
        &[("Upper Control Arm", "Location Chassis Front")],
    ),
    (
        "upper_arm_rear",
        &[("Upper Control Arm", "Location Chassis Back")],
    ),
    (
        "upper_ball_joint",
        &[("Upper Control Arm", "Location Upright")],
    ),
];
const TIE_ROD: [Sources; 2] = [
    ("tie_rod_inner", &[("Tierod", "Location Chassis")]),
    ("tie_rod_outer", &[("Tierod", "Location Upright")]),
];
const LINKS: [Sources; 10] = [
    (
        "upper_front_link_inner",
        &[("Upper Arm", "Location Chassis Front")],
    ),
    (
        "upper_front_link_outer",
        &[("Upper Arm", "Location Upright")],
    ),
    (
        "upper_rear_link_inner",
        &[("Upper Arm", "Location Chassis Back")],
    ),
    (
        "upper_rear_link_outer",
        &[("Upper Arm", "Location Upright")],
    ),
    (
        "lower_front_link_inner",
        &[("Trailing Link", "Location Chassis")],
    ),
    (
        "lower_front_link_outer",
        &[("Trailing Link", "Location Upright")],
    ),
    ("lower_rear_link_inner", &[("Lateral", "Location Chassis")]),
    ("lower_rear_link_outer", &[("Lateral", "Location Upright")]),
    ("toe_link_inner", &[("Tierod", "Location Chassis")]),
    ("toe_link_outer", &[("Tierod", "Location Upright")]),
];
const PIVOTS: [Sources; 2] = [
    (
        "arm_pivot_inner",
        &[("Trailing Arm", "Location Chassis Inner")],
    ),
    (
        "arm_pivot_outer",
        &[("Trailing Arm", "Location Chassis Outer")],
    ),
];

const TRAILING_ARM: [Sources; 5] = [
    ("arm_pivot", &[("Trailing Arm", "Location Chassis")]),
    ("upper_link_inner", &[("Upper Link", "Location Chassis")]),
    ("upper_link_outer", &[("Upper Link", "Location Arm")]),
    ("lower_link_inner", &[("Lower Link", "Location Chassis")]),
    ("lower_link_outer", &[("Lower Link", "Location Arm")]),
];
const SOLID_LOWER: [Sources; 2] = [
    (
        "lower_link_chassis",
        &[
            ("Lower Link", "Location Chassis"),
            ("Longitudinal Link", "Location Chassis"),
        ],
    ),
    (
        "lower_link_axle",
        &[
            ("Lower Link", "Location Axle"),
            ("Longitudinal Link", "Location Axle"),
        ],
    ),
];
const SOLID_UPPER: [Sources; 2] = [
    (
        "upper_link_chassis",
        &[
            ("Upper Link", "Location Chassis"),
            ("Triangular Link", "Location Chassis"),
        ],
    ),
    (
        "upper_link_axle",
        &[
            ("Upper Link", "Location Axle"),
            ("Triangular Link", "Location Axle"),
        ],
    ),
];

/// Parts of a solid axle of Project Chrono that steer it.
const STEERING_OF_AXLES: [&str; 5] = ["Tierod", "Draglink", "Bell Crank", "Bellcrank", "Knuckle"];

/// Keys for the lower end of spring and damper, and the body in studies that carries this end.
const LOWER_ENDS: [(&str, &str); 4] = [
    ("Location Axle", "axle"),
    ("Location Arm", "arm"),
    ("Location Upright", "knuckle"),
    ("Location Link", "link"),
];

/// Points of a suspension of Project Chrono. `None` if the map is not such a suspension.
///
/// # Errors
/// The template corresponds to no topology of this program.
pub(super) fn points_of(root: &Node) -> Result<Option<PointTable>, String> {
    let is_suspension = text(root, "Type") == Some("Suspension");
    let Some(template) = text(root, "Template").filter(|_| is_suspension) else {
        return Ok(None);
    };
    let mut table = PointTable::in_metres();
    let topology = match template {
        "DoubleWishbone" | "DoubleWishboneReduced" => "double_wishbone",
        "MacPhersonStrut" => "macpherson",
        "MultiLink" => "five_link",
        "SemiTrailingArm" => "semi_trailing_arm",
        "ThreeLinkIRS" => "trailing_arm_two_links",
        "SolidAxle" | "SolidThreeLinkAxle" | "SolidBellcrankThreeLinkAxle" => "solid_axle",
        other => return Err(refusal(other)),
    };
    let note =
        format!("a suspension of Project Chrono, template {template}: metres, iso8855, left wheel");
    table.notes.push(note);
    table.kinds.push((None, Kind::Topology(topology)));
    let mut sources: Vec<Sources> = vec![WHEEL];
    match topology {
        "double_wishbone" => sources.extend(LOWER_ARM.into_iter().chain(UPPER_ARM).chain(TIE_ROD)),
        "macpherson" => sources.extend(LOWER_ARM.into_iter().chain(TIE_ROD)),
        "five_link" => sources.extend(LINKS),
        "trailing_arm_two_links" => sources.extend(TRAILING_ARM),
        "solid_axle" => sources.extend(SOLID_LOWER.into_iter().chain(SOLID_UPPER)),
        _ => sources.extend(PIVOTS),
    }
    for (hardpoint, places) in sources {
        let found = places
            .iter()
            .find_map(|keys| Some((keys, location(root, *keys)?)));
        if let Some((keys, position)) = found {
            table.points.push(point(hardpoint, *keys, position, None));
        }
    }
    if topology == "solid_axle" {
        let steering = STEERING_OF_AXLES.iter();
        let steering: Vec<&str> = steering
            .filter(|part| entry(root, part).is_some())
            .copied()
            .collect();
        if !steering.is_empty() {
            table.left_out.push(format!(
                "{}: the steering of a solid axle is not imported",
                steering.join(", ")
            ));
        }
    }
    spring(root, topology, &mut table);
    table.axle.spring = chrono_vehicle::spring(root);
    angles(root, &mut table);
    Ok(Some(table))
}

/// Returns the message that refuses a template without a topology in this program. It names the most similar topology.
fn refusal(template: &str) -> String {
    let nearest = match template {
        "LeafspringAxle"
        | "ToeBarLeafspringAxle"
        | "DeDionAxle"
        | "ToeBarDeDionAxle"
        | "RigidPanhardAxle"
        | "ToeBarRigidPanhardAxle"
        | "HendricksonPRIMAXX"
        | "SAELeafspringAxle"
        | "SAEToeBarLeafspringAxle" => {
            "an axle that joins both wheels, located by other parts than links; the most similar \
             topology is a solid_axle on four links, or on three links and a Panhard rod"
        }
        "RigidSuspension" | "RigidPinnedAxle" => "it has no links that a study could contain",
        "GenericWheeledSuspension" => {
            "it lists bodies and joints of any kind; put the joints into a table, as hardpoints \
             of a topology"
        }
        _ => {
            "expected DoubleWishbone, DoubleWishboneReduced, MacPhersonStrut, MultiLink, SemiTrailingArm, ThreeLinkIRS, SolidAxle or \
             SolidThreeLinkAxle"
        }
    };
    format!(
        "its suspension is a {template} of Project Chrono, for which there is no topology: \
         {nearest}"
    )
}

/// Adds the ends of the spring, or of the damper if there is no spring. In a MacPherson suspension they are the ends of the strut.
/// A spring whose lower end is on a body that the topology does not allow is listed as left out.
fn spring(root: &Node, topology: &str, table: &mut PointTable) {
    let ends = |part: &'static str| {
        let upper = location(root, (part, "Location Chassis"))?;
        let lower = LOWER_ENDS
            .iter()
            .find_map(|(key, body)| Some((*key, *body, location(root, (part, key))?)));
        Some((part, upper, lower?))
    };
    let (spring, shock) = (ends("Spring"), ends("Shock"));
    if let (Some((_, upper, (_, _, lower))), Some((_, other_upper, (_, _, other_lower)))) =
        (spring, shock)
        && (upper, lower) != (other_upper, other_lower)
    {
        table.left_out.push(
            "Shock: its ends differ from those of Spring, and in a study spring and damper have \
             the same ends"
                .to_owned(),
        );
    }
    let Some((part, upper, (key, on, lower))) = spring.or(shock) else {
        return;
    };
    if topology == "macpherson" {
        let top = point("strut_top", (part, "Location Chassis"), upper, None);
        let foot = point("strut_lower", (part, key), lower, None);
        table.points.extend([top, foot]);
        return;
    }
    let body = match (topology, on) {
        ("double_wishbone", "arm") => "lower_arm",
        ("double_wishbone", "knuckle") | ("five_link", "knuckle") => "knuckle",
        ("semi_trailing_arm" | "trailing_arm_two_links", _) => "arm",
        ("solid_axle", "axle") => "axle",
        _ => {
            table
                .left_out
                .push(on_link(root, part, topology, upper, lower));
            return;
        }
    };
    let top = point("spring_upper", (part, "Location Chassis"), upper, None);
    let foot = point("spring_lower", (part, key), lower, Some(body));
    table.points.extend([top, foot]);
}

/// Explains why a spring on the trailing link is left out, and how to compute the spring's motion ratio.
///
/// The link turns about its inner joint. So a spring foot at the fraction t of the link's length moves t times as far as the
/// outer joint. A parallel spring at the outer joint therefore has 1/t times the motion ratio. A foot that is not on the line
/// between the joints also moves along the link. This explanation neglects that motion.
fn on_link(root: &Node, part: &str, topology: &str, upper: [f64; 3], lower: [f64; 3]) -> String {
    let reason = format!(
        "{part}: its lower end is on a link, but in a {topology} it must be on the knuckle or on \
         a rocker. The motion of the wheel is the same without the spring; motion_ratio is not \
         requested"
    );
    let inner = location(root, ("Trailing Link", "Location Chassis"));
    let outer = location(root, ("Trailing Link", "Location Upright"));
    let (Some(inner), Some(outer)) = (inner, outer) else {
        return reason;
    };
    let minus = |a: [f64; 3], b: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| a[k] - b[k]) };
    let dot = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let (link, foot, spring) = (
        minus(outer, inner),
        minus(lower, inner),
        minus(upper, lower),
    );
    let share = dot(foot, link) / dot(link, link);
    if !(0.0..=1.0).contains(&share) {
        return reason;
    }
    let shown = |point: [f64; 3]| {
        // Adding 0.0 removes the sign of a negative zero after rounding.
        let [x, y, z] = point.map(|number| (number * 1e4).round() / 1e4 + 0.0);
        format!("[{x:.4}, {y:.4}, {z:.4}]")
    };
    let top: [f64; 3] = std::array::from_fn(|k| outer[k] + spring[k]);
    format!(
        "{reason}. To get its motion ratio, add a parallel spring at the outer joint of the link to \
         the study: spring_lower = {}, spring_upper = {}. Then multiply its motion_ratio by \
         {share:.2}, because the lower end is at {share:.2} of the link. The result is approximate \
         and applies to the design position",
        shown(outer),
        shown(top)
    )
}

/// Adds the static angles, such as `Camber Angle (deg)`.
fn angles(root: &Node, table: &mut PointTable) {
    let Node::Table(entries) = root else {
        return;
    };
    for (key, node) in entries {
        let is_angle = figure(key).is_some_and(|(kind, ..)| kind.is_angle());
        if let Node::Number(value) = node
            && is_angle
        {
            table.figures.push(Figure {
                name: key.clone(),
                read_as: key.clone(),
                value: *value,
                marks: Marks::default(),
                remark: String::new(),
                place: place(&[key]),
            });
        }
    }
}

/// Point of a wheel with this position. It applies to the left wheel and, mirrored, to the right wheel. `part` and `key` are its
/// keys in the file.
fn point(
    hardpoint: &'static str,
    (part, key): (&str, &str),
    position: [f64; 3],
    body: Option<&str>,
) -> NamedPoint {
    NamedPoint {
        name: format!("{part} {key}"),
        read_as: hardpoint.to_owned(),
        marks: Marks::default(),
        mirrored: true,
        position: Ok(position),
        has_number: true,
        body: body.map(str::to_owned),
        place: place(&[part, key]),
    }
}

/// First value under a key. Upper and lower case are equal.
pub(super) fn entry<'n>(node: &'n Node, key: &str) -> Option<&'n Node> {
    let Node::Table(entries) = node else {
        return None;
    };
    let found = entries
        .iter()
        .find(|(known, _)| known.eq_ignore_ascii_case(key));
    found.map(|(_, node)| node)
}

/// Text under a key. `None` if the key is missing or has another type.
pub(super) fn text<'n>(node: &'n Node, key: &str) -> Option<&'n str> {
    match entry(node, key)? {
        Node::Text(text) => Some(text),
        _ => None,
    }
}

/// Three numbers under the key of a part. `None` if they are missing.
pub(super) fn location(root: &Node, (part, key): (&str, &str)) -> Option<[f64; 3]> {
    position(entry(entry(root, part)?, key)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// For a spring on the link, the explanation describes a parallel spring at the link's outer joint. It also gives the
    /// position of the spring's foot as a fraction of the link. There is no such explanation for a foot beyond either joint.
    #[test]
    fn a_foot_between_the_joints_has_a_share() {
        let list = |point: [f64; 3]| Node::List(Vec::from(point.map(Node::Number)));
        let (inner, outer) = ([1.0, 0.5, 0.25], [3.0, 0.5, -0.75]);
        let joints = vec![
            ("Location Chassis".to_owned(), list(inner)),
            ("Location Upright".to_owned(), list(outer)),
        ];
        let root = Node::Table(vec![("Trailing Link".to_owned(), Node::Table(joints))]);
        let message = |share: f64| {
            let lower = std::array::from_fn(|k| inner[k] + share * (outer[k] - inner[k]));
            let upper = std::array::from_fn(|k| lower[k] + [0.0, 0.0, 0.5][k]);
            on_link(&root, "Spring", "five_link", upper, lower)
        };
        for (share, is_between) in [
            (-0.0005, false),
            (0.0005, true),
            (0.9995, true),
            (1.0005, false),
        ] {
            let text = message(share);
            assert_eq!(
                text.contains("add a parallel spring"),
                is_between,
                "{share}: {text}"
            );
        }
        let text = message(0.75);
        assert!(text.contains("multiply its motion_ratio by 0.75"), "{text}");
        assert!(
            text.contains("spring_lower = [3.0000, 0.5000, -0.7500]"),
            "{text}"
        );
        assert!(
            text.contains("spring_upper = [3.0000, 0.5000, -0.2500]"),
            "{text}"
        );
    }
}
