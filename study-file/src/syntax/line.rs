//! Numbers, words, comments and texts in quotes within a line.

/// Line without its comment. A `#` in a text in quotes is not the beginning of a comment.
pub(super) fn without_comment(line: &str) -> &str {
    let mut quote = None;
    for (at, c) in line.char_indices() {
        match (quote, c) {
            (Some(own), _) if own == c => quote = None,
            (None, '"' | '\'') => quote = Some(c),
            (None, '#') => return &line[..at],
            _ => {}
        }
    }
    line
}

/// Returns true if the line ends within a text, so that a quotation mark is missing.
pub(super) fn ends_in_text(line: &str) -> bool {
    let mut quote = None;
    for c in line.chars() {
        match (quote, c) {
            (Some(own), _) if own == c => quote = None,
            (None, '"' | '\'') => quote = Some(c),
            (None, '#') => return false,
            _ => {}
        }
    }
    quote.is_some()
}

/// Returns true if the line begins with a key and an equals sign, or with the name of a section.
pub(super) fn key_or_section(line: &str) -> bool {
    let is_section =
        line.starts_with('[') && line[1..].trim_start_matches('[').starts_with(is_letter);
    is_section
        || line
            .split_once('=')
            .is_some_and(|(key, _)| is_word(key.trim()))
}

/// Number with a decimal point, if the decimal comma between both parts is probable.
pub(super) fn decimal(whole: &str, fraction: &str) -> Option<String> {
    let whole = whole.trim();
    let end = fraction.find(|c: char| !c.is_ascii_digit());
    let (digits, rest) = fraction.split_at(end.unwrap_or(fraction.len()));
    let is_whole = is_number(whole) && !whole.contains(['.', 'e', 'E']);
    let is_fraction = !digits.is_empty() && !rest.starts_with(['.', 'e', 'E']);
    (is_whole && is_fraction).then(|| format!("{whole}.{digits}"))
}

/// Last number or word of a text.
pub(super) fn last_piece(text: &str) -> &str {
    let ends = |c: char| c.is_whitespace() || ",[{=".contains(c);
    text.rsplit(ends).next().unwrap_or("")
}

pub(super) fn is_number(text: &str) -> bool {
    text.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c))
        && text.parse::<f64>().is_ok()
}

pub(super) fn is_letter(c: char) -> bool {
    c.is_alphabetic() || c == '_'
}

pub(super) fn is_word(text: &str) -> bool {
    text.starts_with(is_letter)
        && text
            .chars()
            .all(|c| c.is_alphanumeric() || "_-.".contains(c))
}
