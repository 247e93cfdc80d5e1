//! Completeness of an imported wheel: groups of hardpoints (spring, rocker, anti-roll bar) with missing points, unused points of
//! the file, and missing hardpoints.

use super::figure_names::{FigureKind, figure};
use super::roles::{self, Letters};
use super::table::PointTable;
use super::{Hardpoint, ImportOptions};
use crate::model::Topology;

/// Leaves out springs, rockers and anti-roll bars with missing parts, each with the reason.
///
/// A rocker carries the lower end of the spring. If the rocker is incomplete, the spring is left out, too: on the lower arm it
/// would have a different motion ratio. A spring that the file attaches to another body is kept.
///
/// # Errors
/// A point that `--map` names would be left out.
pub(super) fn drop_incomplete(
    options: &ImportOptions<'_>,
    hardpoints: &mut Vec<Hardpoint>,
    left_out: &mut Vec<String>,
) -> Result<(), String> {
    let before: Vec<Hardpoint> = hardpoints.clone();
    let mut has_lost_rocker = false;
    for group in options.topology.groups {
        let given = |name: &&&str| hardpoints.iter().any(|h| h.name == **name);
        let complete = |list: &&&[&str]| list.iter().all(|name| given(&name));
        let lists = || group.complete.iter();
        let in_complete: Vec<&&str> = lists().filter(complete).copied().flatten().collect();
        let mut loose: Vec<&str> = Vec::new();
        for name in lists().copied().flatten().filter(given) {
            if !in_complete.contains(&name) && !loose.contains(name) {
                loose.push(name);
            }
        }
        if loose.is_empty() {
            continue;
        }
        has_lost_rocker |= group.what == "the rocker";
        // Each list is a complete variant of the group, for example with a pushrod or with a pullrod. The message names the missing
        // points of the list with the most points in the file. Of equal lists, it takes the first one.
        let nearest = lists()
            .rev()
            .max_by_key(|list| list.iter().filter(given).count());
        let missing = nearest.copied().into_iter().flatten();
        let missing: Vec<&str> = missing.filter(|name| !given(name)).copied().collect();
        left_out.push(format!(
            "{} ({}): {} missing",
            group.what,
            loose.join(", "),
            match missing.as_slice() {
                [one] => format!("{one} is"),
                several => format!("{} are", several.join(", ")),
            }
        ));
        hardpoints.retain(|h| !loose.contains(&h.name));
    }
    drop_from_rocker(has_lost_rocker, hardpoints, left_out);
    // Points that the user has named must not be dropped.
    let lost = before.iter().find(|was| {
        options.names.contains_key(was.name) && !hardpoints.iter().any(|h| h.name == was.name)
    });
    let Some(lost) = lost else {
        return Ok(());
    };
    let mut reasons = left_out.iter();
    let reason = reasons.find(|reason| reason.contains(lost.name));
    let reason = reason.or(left_out.last());
    Err(format!(
        "--map names {}, which cannot be used: {}",
        lost.name,
        reason.map_or("", String::as_str)
    ))
}

/// Leaves out a spring and an anti-roll bar whose lower end or drop link is on a rocker with missing points.
fn drop_from_rocker(
    has_lost_rocker: bool,
    hardpoints: &mut Vec<Hardpoint>,
    left_out: &mut Vec<String>,
) {
    let on_rocker = |name: &str, hardpoints: &[Hardpoint]| {
        let found = hardpoints.iter().find(|h| h.name == name);
        found.is_some_and(|h| h.body.as_deref().or(h.named_body) == Some("rocker"))
    };
    let says_other = |name: &str, hardpoints: &[Hardpoint]| {
        let found = hardpoints.iter().find(|h| h.name == name);
        found.is_some_and(|h| h.body.as_deref().or(h.named_body).is_some())
            && !on_rocker(name, hardpoints)
    };
    let has_rocker = hardpoints.iter().any(|h| h.name == "rocker_pivot_front");
    let has_spring = hardpoints.iter().any(|h| h.name == "spring_lower");
    if has_spring
        && !has_rocker
        && (on_rocker("spring_lower", hardpoints)
            || (has_lost_rocker && !says_other("spring_lower", hardpoints)))
    {
        left_out.push(
            "the spring (spring_upper, spring_lower): its lower end is on the rocker, but points of the rocker are missing".to_owned(),
        );
        hardpoints.retain(|h| !["spring_upper", "spring_lower"].contains(&h.name));
    }
    if !has_rocker && on_rocker("drop_link_outer", hardpoints) {
        left_out.push(
            "the anti-roll bar: its drop link is on the rocker, but points of the rocker are missing".to_owned(),
        );
        let bar = [
            "drop_link_outer",
            "drop_link_inner",
            "anti_roll_bar_inner",
            "anti_roll_bar_outer",
        ];
        hardpoints.retain(|h| !bar.contains(&h.name));
    }
}

/// Names of points that the import does not use, each name once. `meanings` has the hardpoint of each point of the table. A contact
/// point counts as used, because it gives the loaded radius of the wheel. Rows without a digit and without a meaning are not
/// points.
pub(super) fn unused(
    table: &PointTable,
    meanings: &[Option<&'static str>],
    hardpoints: &[Hardpoint],
) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for (point, meaning) in table.points.iter().zip(meanings) {
        let is_used = meaning.is_some_and(|name| hardpoints.iter().any(|h| h.name == name));
        let is_contact =
            figure(&point.read_as).is_some_and(|(kind, ..)| kind == FigureKind::ContactPoint);
        let is_text = !point.has_number && meaning.is_none();
        if !is_used && !is_contact && !is_text && !names.contains(&point.name) {
            names.push(point.name.clone());
        }
    }
    names
}

/// Finds a topology for which no hardpoint is missing, and which requires at least one of the unused points. Topologies with both
/// wheels in one mechanism are not tried.
pub(super) fn rather(
    topology: &Topology,
    unused: &[String],
    table: &PointTable,
) -> Option<&'static Topology> {
    let letters = Letters::of_points(&table.points);
    let meaning =
        |name: &str, other: &Topology| roles::read(name, other, letters).map(|role| role.hardpoint);
    let mut others = Topology::ALL
        .iter()
        .filter(|other| **other != topology && !other.carries_both_wheels());
    let found = others.find(|other| {
        let is_there = |name: &str| {
            let mut points = table.points.iter();
            points.any(|point| meaning(&point.read_as, other) == Some(name))
        };
        let required = other.hardpoints.iter().filter(|h| h.required);
        let needs = |given: &String| {
            let meant = meaning(given, other).and_then(|name| other.hardpoint(name));
            meant.is_some_and(|hardpoint| hardpoint.required)
        };
        required.map(|h| h.name).all(is_there) && unused.iter().any(needs)
    });
    found.copied()
}

/// Refuses a file with missing hardpoints. The message lists them, the points found and the unused points. Hardpoints in `made` are
/// not missing, because the import computes them later.
pub(super) fn missing(
    topology: &Topology,
    hardpoints: &[Hardpoint],
    unused: &[String],
    made: &[&str],
) -> Result<(), String> {
    let given = |name: &str| hardpoints.iter().any(|h| h.name == name) || made.contains(&name);
    let required = topology.hardpoints.iter().filter(|h| h.required);
    let missing: Vec<String> = required
        .filter(|h| !given(h.name))
        .map(|h| format!("  {} ({})", h.name, h.about))
        .collect();
    if missing.is_empty() {
        return Ok(());
    }
    let mut message = format!("missing for {}:\n{}", topology.name, missing.join("\n"));
    let found: Vec<String> = hardpoints
        .iter()
        .map(|h| format!("{} from {:?}", h.name, h.called))
        .collect();
    if !found.is_empty() {
        message += &format!("\nfound: {}", found.join(", "));
    }
    if !unused.is_empty() {
        message += &format!(
            "\nunused points: {}\nIf some of these are the missing points, name them in a file \
             for --map, as in\n  {} = {:?}",
            unused.join(", "),
            missing[0].split_whitespace().next().unwrap_or(""),
            unused[0]
        );
    }
    Err(message)
}
