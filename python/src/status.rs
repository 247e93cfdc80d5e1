//! Codes of the result at a station, or of a design.

use hardpoint::DesignStatus;

/// Words by code. Codes are part of the interface: new ones are appended.
pub(crate) const WORDS: [&str; 12] = [
    "ok",
    "ill_conditioned",
    "unsupported",
    "toggle",
    "unreachable",
    "singular",
    "uncertified",
    "degenerate",
    "not_finite",
    "incomplete",
    "no_equilibrium",
    "unstable",
];

/// The code of a word of a `status` column; 255 for a word that has none.
pub(crate) fn code(word: &str) -> u8 {
    let place = WORDS.iter().position(|w| *w == word);
    place.map_or(u8::MAX, |place| place as u8)
}

/// The codes of designs.
pub(crate) fn of_designs(status: &[DesignStatus]) -> Vec<u8> {
    let word = |status: &DesignStatus| match status {
        DesignStatus::Ok => "ok",
        DesignStatus::Failed => "incomplete",
        DesignStatus::Faulty => "degenerate",
    };
    status.iter().map(|status| code(word(status))).collect()
}
