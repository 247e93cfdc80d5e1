//! Random constraints of mixes.

use super::{CHARACTERISTICS, Draw, Kind, apart, column};
use crate::support::larger;
use hardpoint::curves::Curves;

/// Random constraints, with the kind of each constraint.
pub(super) fn constraints(
    draw: &mut Draw,
    kind: Kind,
    all: &[(String, [f64; 3])],
    moved: &[usize],
    curves: &Curves,
) -> (Vec<String>, Vec<&'static str>) {
    let still: Vec<usize> = (0..all.len()).filter(|k| !moved.contains(k)).collect();
    let (mut written, mut kinds): (Vec<String>, Vec<&'static str>) = (Vec::new(), Vec::new());
    let degenerate = kind != Kind::Kept;
    for place in 0..1 + draw.of(5) {
        let a = moved[draw.of(moved.len())];
        let b = (a + 1 + draw.of(all.len() - 1)) % all.len();
        let pair = format!("length = [\"{}\", \"{}\"]", all[a].0, all[b].0);
        let long = apart(all[a].1, all[b].1);
        let slack = draw.between(0.0, 6.0);
        let choice = match (kind, place) {
            (Kind::Degenerate, 0) => 6 + draw.of(2),
            (Kind::Any, _) => draw.of(11),
            // Omits equalities, because the crate `slsqp`, with which the test compares, does not support them.
            (Kind::Degenerate, _) => 1 + draw.of(5),
            _ => draw.of(6),
        };
        let (text, name) = match choice {
            0 => (format!("{pair}, kept = true, at = \"design\""), "kept"),
            1 | 2 => {
                let (low, high) = (long - slack, long + draw.between(0.0, 4.0));
                (
                    format!("{pair}, between = [{low}, {high}], at = \"design\""),
                    "length",
                )
            }
            3 => (inside_box(draw, &all[a]), "box"),
            4 => (band(draw, curves), "band"),
            5 => (inside_sphere(draw, &all[a]), "sphere"),
            6 if degenerate && still.len() > 1 => (still_length(draw, kind, all, &still), "still"),
            // Repeats a constraint.
            7 | 6 => match (written.last(), kind) {
                (Some(last), _) => (last.clone(), "twice"),
                (None, _) => {
                    let text = format!("{pair}, at_most = {}, at = \"design\"", long + slack);
                    written.push(format!("{{ {text} }}"));
                    kinds.push("length");
                    (text, "twice")
                }
            },
            8 if still.len() > 1 => (missed_length(draw, all, &still), "missed"),
            9 => {
                let text = format!("{pair}, at_most = {}, at = \"design\"", long - 1.0);
                written.push(format!("{{ {text} }}"));
                kinds.push("short");
                (
                    format!("{pair}, at_least = {}, at = \"design\"", long + 1.0),
                    "contradiction",
                )
            }
            _ => (coplanar(all, a, b), "coplanar"),
        };
        // A text that begins with a brace is a copy of an earlier constraint.
        written.push(if text.starts_with('{') {
            text
        } else {
            format!("{{ {text} }}")
        });
        kinds.push(name);
    }
    (written, kinds)
}

/// A point stays in a box about its nominal position.
fn inside_box(draw: &mut Draw, (name, centre): &(String, [f64; 3])) -> String {
    let low = centre.map(|c| c - draw.between(0.0, 8.0));
    let high = centre.map(|c| c + draw.between(0.0, 8.0));
    format!("point = \"{name}\", inside = {{ box = [{low:?}, {high:?}] }}, at = \"design\"")
}

/// A point stays in a sphere that contains its nominal position.
fn inside_sphere(draw: &mut Draw, (name, place): &(String, [f64; 3])) -> String {
    let centre = place.map(|c| c + draw.off(3.0));
    let radius = apart(centre, *place) + draw.between(0.0, 6.0);
    format!(
        "point = \"{name}\", inside = {{ sphere = {{ centre = {centre:?}, radius = {radius} }} }}, at = \"design\""
    )
}

/// A characteristic stays in a band that contains its nominal values.
fn band(draw: &mut Draw, curves: &Curves) -> String {
    let (name, tolerance) = CHARACTERISTICS[draw.of(2)];
    let values = column(curves, name);
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let most = values.iter().copied().fold(f64::NEG_INFINITY, larger);
    let low = least - draw.between(0.0, 6.0) * tolerance;
    let high = most + draw.between(0.0, 6.0) * tolerance;
    format!("characteristic = \"{name}\", between = [{low}, {high}]")
}

/// A length that no variable affects, at its limit.
fn still_length(
    draw: &mut Draw,
    kind: Kind,
    all: &[(String, [f64; 3])],
    still: &[usize],
) -> String {
    let (c, d) = (still[0], still[1 + draw.of(still.len() - 1)]);
    let long = apart(all[c].1, all[d].1);
    let limit = match draw.of(3) {
        0 if kind == Kind::Any => "kept = true".to_owned(),
        0 | 1 => format!("at_most = {long}"),
        _ => format!("between = [{long}, {}]", long + 1.0),
    };
    format!(
        "length = [\"{}\", \"{}\"], {limit}, at = \"design\"",
        all[c].0, all[d].0
    )
}

/// A violated constraint that no variable affects.
fn missed_length(draw: &mut Draw, all: &[(String, [f64; 3])], still: &[usize]) -> String {
    let (c, d) = (still[0], still[1 + draw.of(still.len() - 1)]);
    let most = apart(all[c].1, all[d].1) - draw.between(0.5, 5.0);
    format!(
        "length = [\"{}\", \"{}\"], at_most = {most}, at = \"design\"",
        all[c].0, all[d].0
    )
}

/// Four points lie in a plane.
fn coplanar(all: &[(String, [f64; 3])], a: usize, b: usize) -> String {
    let other = |k: usize| (a + 1 + (b + k) % (all.len() - 1)) % all.len();
    let points: Vec<usize> = if all.len() > 3 {
        vec![a, other(0), other(1), other(2)]
    } else {
        // The wheel has at most three movable points, and the constraint uses all of them. Three points
        // always lie in a plane.
        (0..all.len()).collect()
    };
    let names: Vec<String> = points
        .iter()
        .map(|k| format!("\"{}\"", all[*k].0))
        .collect();
    format!("coplanar = [{}], at = \"design\"", names.join(", "))
}
