//! Unit in the name of a file's column.

use super::super::TargetQuantity;
use super::super::error::Problems;
use super::super::value::Text;

/// Units that the names of columns contain, in small letters.
const UNITS: [&str; 19] = [
    "deg", "degree", "degrees", "mdeg", "rad", "radian", "radians", "mrad", "arcmin", "mm", "cm",
    "m", "in", "inch", "ft", "n", "kn", "lbf", "percent",
];
/// Units that are also words in names: `toe_in`.
const WORDS: [&str; 2] = ["in", "m"];

/// Name of the column of a target's values. Refuses a name that states another unit than the unit of these values.
pub(super) fn checked<'n>(
    column: Option<&'n Text>,
    of: &'n TargetQuantity,
    problems: &mut Problems,
) -> Option<&'n str> {
    let Some(column) = column else {
        return Some(&of.column);
    };
    let own = of.unit.suffix(of.length).to_lowercase();
    let name = plain(column.get_ref());
    match stated(&name, &own) {
        Some(other) if other != own => {
            let unit = match own.as_str() {
                "" => "plain numbers",
                unit => unit,
            };
            let message = format!(
                "the column {} is in {other} according to its name, and the target {} is in {unit}: convert the values, \
                 and rename the column",
                column.get_ref(),
                of.column
            );
            problems.refuse(column.span(), message)
        }
        _ => Some(column.get_ref()),
    }
}

/// Name of a column in small letters, with `_` before its unit: `toe_rad` for `Toe [rad]`.
fn plain(name: &str) -> String {
    let name = name.to_lowercase().replace([' ', '/', '[', '('], "_");
    let name = name.replace([']', ')'], "");
    let parts: Vec<&str> = name.split('_').filter(|part| !part.is_empty()).collect();
    parts.join("_")
}

/// Unit at the end of a column's name, such as `deg` or `deg_per_mm`. `own` is the unit of the target.
fn stated<'n>(name: &'n str, own: &'n str) -> Option<&'n str> {
    if !own.is_empty()
        && name
            .strip_suffix(own)
            .is_some_and(|stem| stem.ends_with('_'))
    {
        return Some(own);
    }
    let is_length = own.is_empty() || own.split('_').any(|part| ["mm", "m", "in"].contains(&part));
    let (stem, last) = name.rsplit_once('_')?;
    if let Some(stem) = stem.strip_suffix("_per") {
        let (before, above) = stem.rsplit_once('_')?;
        let is_unit = [above, last].iter().all(|part| UNITS.contains(part));
        return is_unit.then(|| &name[before.len() + 1..]);
    }
    let is_word = WORDS.contains(&last) && !is_length;
    (UNITS.contains(&last) && !is_word).then_some(last)
}

#[cfg(test)]
mod tests {
    use super::{plain, stated};

    #[test]
    fn names_state_units() {
        for (name, own, unit) in [
            ("toe_deg", "deg", Some("deg")),
            ("toe_rad", "deg", Some("rad")),
            ("toe_in", "deg", None),
            ("toe", "deg", None),
            ("toe_left", "deg", None),
            ("deg", "deg", None),
            ("toe_mm", "deg", Some("mm")),
            ("scrub_in", "mm", Some("in")),
            ("gain_rad_per_m", "deg_per_mm", Some("rad_per_m")),
            ("gain_deg_per_mm", "deg_per_mm", Some("deg_per_mm")),
            ("change_per_mm", "deg_per_mm", None),
            ("ratio_percent", "", Some("percent")),
            ("toe (rad)", "deg", Some("rad")),
            ("Toe [mm]", "deg", Some("mm")),
            ("toe/rad", "deg", Some("rad")),
            ("camber [deg]", "deg", Some("deg")),
            ("force [kN]", "n", Some("kn")),
        ] {
            assert_eq!(stated(&plain(name), own), unit, "{name}");
        }
    }
}
