//! Fits text to a width, and replaces control characters of the terminal.

use std::fmt::Display;

/// Number with a noun: `1 design`, `5 designs`.
pub fn counted<N: Display + PartialEq + From<u8>>(number: N, thing: &str) -> String {
    if number == N::from(1) {
        format!("{number} {thing}")
    } else {
        format!("{number} {thing}s")
    }
}

/// Unit of length for a sentence, from its symbol. The symbol `in` would read as a preposition.
pub fn unit_in_words(symbol: &str) -> &str {
    match symbol {
        "in" => "inches",
        other => other,
    }
}

/// Characters after which a line may break within a word.
const JOINTS: [char; 4] = ['_', '/', ',', '.'];

/// Splits a text into lines of at most `width` characters (at least one), and into at least one line. Lines break at spaces; or
/// after an underscore, slash, comma or dot; or, if necessary, anywhere in a word.
pub(super) fn broken(text: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let (line, own) = (last(&lines), word.chars().count());
        if line > 0 && line + 1 + own <= width {
            lines.last_mut().expect("the list has an element").push(' ');
        } else if line > 0 {
            lines.push(String::new());
        }
        for part in word.split_inclusive(JOINTS) {
            let own = part.chars().count();
            if last(&lines) + own > width && last(&lines) > 0 {
                lines.push(String::new());
            }
            for c in part.chars() {
                if last(&lines) >= width.max(1) {
                    lines.push(String::new());
                }
                lines.last_mut().expect("the list has an element").push(c);
            }
        }
    }
    lines
}

/// Number of characters in the last of these lines.
fn last(lines: &[String]) -> usize {
    lines.last().map_or(0, |line| line.chars().count())
}

/// Number of characters in the longest part of a text whose lines break only at spaces and after the characters in [`JOINTS`].
pub(super) fn widest(text: &str) -> usize {
    let parts = text
        .split(' ')
        .flat_map(|word| word.split_inclusive(JOINTS));
    parts.map(|part| part.chars().count()).max().unwrap_or(0)
}

/// Wraps the lines of a text to at most `width` characters. Continued lines are indented by two more spaces. Short lines stay
/// unchanged. Words stay whole, so a line with a long word or a deep indent may be wider.
pub fn wrapped(text: &str, width: usize) -> String {
    let mut wrapped = String::with_capacity(text.len());
    for line in text.split_inclusive('\n') {
        let (line, end) = match line.strip_suffix('\n') {
            Some(line) => (line, "\n"),
            None => (line, ""),
        };
        if line.chars().count() <= width {
            wrapped.push_str(line);
        } else {
            let words = line.trim_start_matches(' ');
            let indent = line.len() - words.len();
            let room = width.saturating_sub(indent + 2).max(20);
            for (number, part) in words_within(words, room).into_iter().enumerate() {
                let margin = if number == 0 { indent } else { indent + 2 };
                let start = if number == 0 { "" } else { "\n" };
                wrapped.push_str(start);
                wrapped.extend(std::iter::repeat_n(' ', margin));
                wrapped.push_str(&part);
            }
        }
        wrapped.push_str(end);
    }
    wrapped
}

/// Lines of a text that breaks only at spaces, so that paths and names stay whole.
fn words_within(text: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let line = last(&lines);
        if line > 0 && line + 1 + word.chars().count() > width {
            lines.push(String::new());
        } else if line > 0 {
            lines.last_mut().expect("the list has an element").push(' ');
        }
        lines
            .last_mut()
            .expect("the list has an element")
            .push_str(word);
    }
    lines
}

/// Replaces characters that control a terminal or change the direction of reading by escapes (`\u{1b}`). Line breaks and tabs
/// stay.
pub fn printable(text: &str) -> String {
    let mut printable = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\n' | '\t' => printable.push(c),
            c if c.is_control() || turns(c) => printable.extend(c.escape_unicode()),
            c => printable.push(c),
        }
    }
    printable
}

/// Replaces characters that control a terminal or change the direction of reading by JSON escapes. In JSON they only occur within
/// strings, so the meaning stays the same. Line breaks stay.
pub(super) fn printable_json(json: &str) -> String {
    let mut printable = String::with_capacity(json.len());
    for c in json.chars() {
        match c {
            '\n' => printable.push(c),
            c if c.is_control() || turns(c) => printable.push_str(&format!("\\u{:04x}", c as u32)),
            c => printable.push(c),
        }
    }
    printable
}

/// True if [`printable`] would not change a text.
pub fn is_printable(text: &str) -> bool {
    text.chars()
        .all(|c| "\n\t".contains(c) || !(c.is_control() || turns(c)))
}

/// True for characters that change the direction of reading (marks, embeddings, overrides and isolates of bidirectional text), and
/// for line separators.
fn turns(c: char) -> bool {
    matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_broken_where_it_may_be() {
        assert_eq!(broken("one two three", 8), ["one two", "three"]);
        assert_eq!(
            broken("upper_front_link_inner", 12),
            ["upper_front_", "link_inner"]
        );
        assert_eq!(broken("abcdefgh", 3), ["abc", "def", "gh"]);
        assert_eq!(broken("", 3), [""]);
        assert_eq!(widest("camber_gain_deg at"), 7);
    }

    #[test]
    fn long_lines_go_on_further_in() {
        let text = "short\n  a long line of words that go on\n";
        let lines = "short\n  a long line of words\n    that go on\n";
        assert_eq!(wrapped(text, 24), lines);
        assert_eq!(wrapped(text, 100), text);
    }

    #[test]
    fn a_terminal_obeys_nothing() {
        let hostile = "a\u{1b}[31mb\u{7}\r\u{9b}c\u{202e}d\u{61c}\n\té";
        let shown = printable(hostile);
        assert_eq!(
            shown,
            "a\\u{1b}[31mb\\u{7}\\u{d}\\u{9b}c\\u{202e}d\\u{61c}\n\té"
        );
        assert!(is_printable(&shown) && !is_printable(hostile));
        let json = serde_json::to_string(hostile).unwrap();
        let shown = printable_json(&json);
        assert!(is_printable(&shown) && !is_printable(&json));
        assert_eq!(serde_json::from_str::<String>(&shown).unwrap(), hostile);
    }
}
