//! Blocks of the text files of Adams Car ("TeimOrbit" format): their headings, their assignments and their unit of length.

use crate::model::LengthUnit;

/// Name of the block that begins on this line of a file, in capitals. `None` if no block begins here.
pub(super) fn block(line: &str) -> Option<String> {
    let name = line.trim().strip_prefix('[')?.split(']').next()?;
    Some(name.trim().to_ascii_uppercase())
}

/// First two lines of a block: a comment line with the block's name, and the heading in brackets.
pub(super) fn heading(name: &str) -> String {
    format!("${name:->79}\n[{name}]\n")
}

/// Splits `KEY = 'value'` into the key in capitals and the value without quotes.
pub(super) fn assignment(line: &str) -> Option<(String, String)> {
    let (key, value) = line.split_once('=')?;
    let value = value.trim().trim_matches('\'').trim();
    Some((key.trim().to_ascii_uppercase(), value.to_owned()))
}

/// Unit of length with this name, in upper or lower case. `None` for any other unit.
pub(super) fn length_unit(name: &str) -> Option<LengthUnit> {
    match name.to_ascii_lowercase().as_str() {
        "mm" | "millimeter" => Some(LengthUnit::Millimetre),
        "m" | "meter" => Some(LengthUnit::Metre),
        "in" | "inch" => Some(LengthUnit::Inch),
        _ => None,
    }
}

/// Name of this unit of length in the text files of Adams Car.
pub(super) fn name_of_unit(unit: LengthUnit) -> &'static str {
    match unit {
        LengthUnit::Millimetre => "mm",
        LengthUnit::Metre => "meter",
        LengthUnit::Inch | LengthUnit::InchPound => "inch",
    }
}
