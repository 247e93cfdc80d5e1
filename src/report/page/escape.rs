//! Escapes text from a study for a page, so that a name cannot act as a script.

use crate::report::with_minus_signs;
use serde::Serialize;

/// Escapes text for the content or a quoted attribute of an HTML element.
pub(super) fn html(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            // HTML does not allow control characters, except for white space.
            c if c.is_control() && !c.is_whitespace() => escaped.push('\u{fffd}'),
            c => escaped.push(c),
        }
    }
    escaped
}

/// Escapes a sentence with numbers. Its negative numbers get minus signs.
pub(super) fn prose(text: &str) -> String {
    html(&with_minus_signs(text))
}

/// Writes a value as JSON for a `script` element. Characters that could end the element or a line of script are written as escapes.
/// In JSON they occur only within strings.
pub(super) fn json(value: &impl Serialize) -> String {
    let plain = serde_json::to_string(value).expect("JSON can store page data");
    let mut escaped = String::with_capacity(plain.len());
    for c in plain.chars() {
        match c {
            '<' | '>' | '&' | '\u{2028}' | '\u{2029}' => {
                escaped.push_str(&format!("\\u{:04x}", c as u32));
            }
            c => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOSTILE: &str = "</script><!--<script>alert(\"1\")</script>'&\u{2028}\u{202e}🏎";

    #[test]
    fn no_markup_is_left() {
        for text in [html(HOSTILE), json(&HOSTILE)] {
            assert!(!text.contains(['<', '>']), "{text}");
        }
        assert!(!json(&HOSTILE).contains('\u{2028}'));
        assert_eq!(html("a & b"), "a &amp; b");
        assert_eq!(html("a\u{0}b"), "a\u{fffd}b");
    }

    #[test]
    fn json_reads_back() {
        let back: String = serde_json::from_str(&json(&HOSTILE)).unwrap();
        assert_eq!(back, HOSTILE);
    }
}
