//! Look-up of names, and suggestions for unknown names.

use crate::error::Problems;
use crate::value::Text;

/// Common names that do not resemble the names in this program, each with the corresponding name of this program.
const SYNONYMS: [(&str, &str); 31] = [
    ("kpi", "kingpin_inclination"),
    ("sai", "kingpin_inclination"),
    ("steering_axis_inclination", "kingpin_inclination"),
    ("castor", "caster"),
    ("trail", "caster_trail"),
    ("mechanical_trail", "caster_trail"),
    ("roll_center", "roll_centre_height"),
    ("roll_centre", "roll_centre_height"),
    ("rch", "roll_centre_height"),
    ("fvsa", "front_view_swing_arm"),
    ("svsa", "side_view_swing_arm"),
    ("installation_ratio", "motion_ratio"),
    ("ackerman", "ackermann"),
    ("trailing_arm", "semi_trailing_arm"),
    ("a_arm", "double_wishbone"),
    ("sla", "double_wishbone"),
    ("wishbone", "double_wishbone"),
    ("strut", "macpherson"),
    ("mcpherson", "macpherson"),
    ("multilink", "five_link"),
    ("multi_link", "five_link"),
    ("5_link", "five_link"),
    ("live_axle", "solid_axle"),
    ("beam_axle", "solid_axle"),
    ("lltd", "lateral_load_transfer_distribution"),
    ("tlltd", "lateral_load_transfer_distribution"),
    ("magic_number", "lateral_load_transfer_distribution"),
    ("weight_transfer", "lateral_load_transfer"),
    ("understeer_gradient", "roll_understeer"),
    ("corner_weight", "wheel_load"),
    ("wedge", "cross_weight"),
];

/// Endings that names of other programs and of columns have in addition, as in `roll_angle` and `heave_mm`.
const ENDINGS: [&str; 5] = ["_angle", "_deg", "_mm", "_in", "_percent"];

/// Candidate that the user probably meant by `name`. `None` if no candidate is similar.
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let candidates: Vec<&str> = candidates.into_iter().collect();
    nearest_of(name, &candidates)
}

fn nearest_of<'a>(name: &str, candidates: &[&'a str]) -> Option<&'a str> {
    let plain = |s: &str| s.trim().to_lowercase().replace(['-', ' '], "_");
    let name = plain(name);
    let length = name.chars().count();
    let synonym = SYNONYMS.iter().find(|(usual, _)| *usual == name);
    let meant = synonym.and_then(|(_, own)| candidates.iter().find(|candidate| *candidate == own));
    if let Some(meant) = meant {
        return Some(meant);
    }
    let shortened = ENDINGS.iter().find_map(|ending| name.strip_suffix(ending));
    let meant =
        shortened.and_then(|short| candidates.iter().find(|candidate| **candidate == short));
    if let Some(meant) = meant {
        return Some(meant);
    }
    let all = candidates.iter().copied();
    let near = all
        .clone()
        .filter_map(|candidate| {
            let target = plain(candidate);
            let distance = strsim::damerau_levenshtein(&name, &target);
            let close = 3 * distance <= length.max(target.chars().count());
            // The name may be an abbreviation, or one part of the candidate: "kingpin", "ball_joint".
            let part = length >= 3 && target.contains(&name);
            (close || part).then_some((!close, distance, candidate))
        })
        .min_by_key(|(far, distance, _)| (*far, *distance));
    if let Some((.., candidate)) = near {
        return Some(candidate);
    }
    // If no candidate matches in this way, finds a candidate that shares words with `name`, in any order: at least two words, and
    // at least half of the words of `name`.
    let words: Vec<&str> = name.split('_').collect();
    let shared = |candidate: &str| {
        let own: Vec<&str> = candidate.split('_').collect();
        words.iter().filter(|word| own.contains(word)).count()
    };
    let counted = all.map(|candidate| (shared(candidate), candidate));
    let alike = counted.filter(|(count, _)| *count >= 2 && 2 * count >= words.len());
    alike
        .min_by_key(|(count, candidate)| (words.len() - count, candidate.len()))
        .map(|(_, candidate)| candidate)
}

/// List of names, each in quotes: `"a"`, `"a" or "b"`, `"a", "b" or "c"`.
pub fn alternatives<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    let names: Vec<String> = names.into_iter().map(|n| format!("\"{n}\"")).collect();
    match names.as_slice() {
        [] => String::new(),
        [only] => only.clone(),
        [rest @ .., last] => format!("{} or {last}", rest.join(", ")),
    }
}

/// Returns the option with this name, or records an error that lists all options.
pub fn choose<T: Clone>(
    text: &Text,
    what: &str,
    options: &[(&str, T)],
    problems: &mut Problems,
) -> Option<T> {
    let names: Vec<&str> = options.iter().map(|(name, _)| *name).collect();
    let chosen = place_of(text, what, &names, problems)?;
    Some(options[chosen].1.clone())
}

/// Returns the index of this name among the options, or records an error that lists them. This function takes only the names
/// of the options, so it is compiled once for all types of options.
fn place_of(text: &Text, what: &str, names: &[&str], problems: &mut Problems) -> Option<usize> {
    let name = text.get_ref();
    if let Some(found) = names.iter().position(|option| option == name) {
        return Some(found);
    }
    let few = names.len() <= 6;
    let mut message = format!("unknown {what} {name:?}");
    if few && !names.is_empty() {
        message += &format!("; expected {}", alternatives(names.iter().copied()));
    }
    let error = problems.add(text.span(), message);
    if let Some(near) = nearest_of(name, names) {
        error.help(format!("did you mean \"{near}\"?"));
    } else if !few {
        error.help(format!("there are {}", names.join(", ")));
    }
    None
}

/// Returns the option with this name, or the default if there is no name. `None` if the name is unknown.
pub fn choose_or<T: Clone>(
    text: &Option<Text>,
    default: T,
    what: &str,
    options: &[(&str, T)],
    problems: &mut Problems,
) -> Option<T> {
    match text {
        Some(text) => choose(text, what, options, problems),
        None => Some(default),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_abbreviations_and_other_spellings_are_recognised() {
        let names = [
            "camber",
            "camber_gain",
            "kingpin_inclination",
            "wheel_centre",
            "toe_by_lateral_force_trail_30",
            "toe_by_lateral_force_trail_30_opposed",
        ];
        for (written, meant) in [
            // Names with the same words, and one name from another program.
            (
                "lateral_toe_compliance_trail_30",
                Some("toe_by_lateral_force_trail_30"),
            ),
            ("lateral_compliance", None),
            ("chamber", Some("camber")),
            ("Camber", Some("camber")),
            ("camber-gain", Some("camber_gain")),
            ("wheel_center", Some("wheel_centre")),
            ("kingpin", Some("kingpin_inclination")),
            ("KPI", Some("kingpin_inclination")),
            ("camber_angle", Some("camber")),
            ("camber_gain_deg", Some("camber_gain")),
            ("steer_angle", None),
            // The function suggests only names among the candidates.
            ("trailing_arm", None),
            ("roll_centre_height", None),
            ("x", None),
        ] {
            assert_eq!(nearest(written, names), meant, "{written}");
        }
    }
}
