//! Status codes of stations and of designs.

use hardpoint::DesignStatus;

/// Status words; the index of a word is its code. Codes are part of the interface, so new words are added at the end.
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

/// Code of a word in a `status` column. 255 if the word has no code.
pub(crate) fn code(word: &str) -> u8 {
    let place = WORDS.iter().position(|w| *w == word);
    place.map_or(u8::MAX, |place| place as u8)
}

/// Status codes of designs.
pub(crate) fn of_designs(status: &[DesignStatus]) -> Vec<u8> {
    let word = |status: &DesignStatus| match status {
        DesignStatus::Ok => "ok",
        DesignStatus::Failed => "incomplete",
        DesignStatus::Faulty => "degenerate",
    };
    status.iter().map(|status| code(word(status))).collect()
}
