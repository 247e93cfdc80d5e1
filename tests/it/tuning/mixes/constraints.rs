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
            3 => {
                let centre = all[a].1;
                let low = centre.map(|c| c - draw.between(0.0, 8.0));
                let high = centre.map(|c| c + draw.between(0.0, 8.0));
                let name = &all[a].0;
                let text = format!(
                    "point = \"{name}\", inside = {{ box = [{low:?}, {high:?}] }}, at = \"design\""
                );
                (text, "box")
            }
            4 => {
                let (name, tolerance) = CHARACTERISTICS[draw.of(2)];
                let values = column(curves, name);
                let least = values.iter().copied().fold(f64::INFINITY, f64::min);
                let most = values.iter().copied().fold(f64::NEG_INFINITY, larger);
                let low = least - draw.between(0.0, 6.0) * tolerance;
                let high = most + draw.between(0.0, 6.0) * tolerance;
                (
                    format!("characteristic = \"{name}\", between = [{low}, {high}]"),
                    "band",
                )
            }
            5 => {
                let centre = all[a].1.map(|c| c + draw.off(3.0));
                let radius = apart(centre, all[a].1) + draw.between(0.0, 6.0);
                let name = &all[a].0;
                let text = format!(
                    "point = \"{name}\", inside = {{ sphere = {{ centre = {centre:?}, radius = {radius} }} }}, at = \"design\""
                );
                (text, "sphere")
            }
            // Lengths that no variable affects, at their limits.
            6 if degenerate && still.len() > 1 => {
                let (c, d) = (still[0], still[1 + draw.of(still.len() - 1)]);
                let long = apart(all[c].1, all[d].1);
                let limit = match draw.of(3) {
                    0 if kind == Kind::Any => "kept = true".to_owned(),
                    0 | 1 => format!("at_most = {long}"),
                    _ => format!("between = [{long}, {}]", long + 1.0),
                };
                let text = format!(
                    "length = [\"{}\", \"{}\"], {limit}, at = \"design\"",
                    all[c].0, all[d].0
                );
                (text, "still")
            }
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
            // A violated constraint that no variable affects.
            8 if still.len() > 1 => {
                let (c, d) = (still[0], still[1 + draw.of(still.len() - 1)]);
                let most = apart(all[c].1, all[d].1) - draw.between(0.5, 5.0);
                let text = format!(
                    "length = [\"{}\", \"{}\"], at_most = {most}, at = \"design\"",
                    all[c].0, all[d].0
                );
                (text, "missed")
            }
            9 => {
                let text = format!("{pair}, at_most = {}, at = \"design\"", long - 1.0);
                written.push(format!("{{ {text} }}"));
                kinds.push("short");
                (
                    format!("{pair}, at_least = {}, at = \"design\"", long + 1.0),
                    "contradiction",
                )
            }
            _ => {
                let other = |k: usize| (a + 1 + (b + k) % (all.len() - 1)) % all.len();
                let four: Vec<usize> = if all.len() > 3 {
                    vec![a, other(0), other(1), other(2)]
                } else {
                    // The wheel has at most three movable points, and the constraint uses all of them. Three points
                    // always lie in a plane.
                    (0..all.len()).collect()
                };
                let names: Vec<String> =
                    four.iter().map(|k| format!("\"{}\"", all[*k].0)).collect();
                (
                    format!("coplanar = [{}], at = \"design\"", names.join(", ")),
                    "coplanar",
                )
            }
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
