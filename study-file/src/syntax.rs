//! Probable causes of errors in the syntax of a study, such as a missing comma. The parser's messages do not name them.

mod line;
#[cfg(test)]
mod tests;

use line::{
    decimal, ends_in_text, is_letter, is_number, is_word, key_or_section, last_piece,
    without_comment,
};
use std::ops::Range;

/// Sentence about the probable cause of an error in the syntax. `message` is the parser's message, and `place` is its position in
/// the text. `None` if no cause is probable.
pub(crate) fn cause(text: &str, message: &str, place: Range<usize>) -> Option<String> {
    let spot = Spot::of(text, place)?;
    let (what, expected) = message
        .split_once(", expected ")
        .unwrap_or((message, "nothing"));
    if let Some(cause) = spot.foreign_character() {
        return Some(cause);
    }
    match what {
        "string values must be quoted" => Some(spot.bare_words()),
        "missing opening quote" => {
            Some("a quotation mark is missing at the beginning of the text".to_owned())
        }
        "invalid boolean" => Some(spot.bare_words()),
        "invalid basic string" | "invalid literal string" => Some(spot.unfinished_text()),
        "invalid mantissa" | "invalid fraction" | "invalid exponent" => spot.missing_digits(what),
        "unexpected leading zero" => Some(spot.leading_zero()),
        _ if what.starts_with("invalid ") && ["`inf`", "`nan`"].contains(&expected) => {
            Some(spot.bare_words())
        }
        _ if what.starts_with("invalid ") && expected == "nothing" => spot.odd_number(),
        "key with no value" => Some(spot.no_equals_sign()),
        "extra `=`" => Some("remove one of the two equals signs".to_owned()),
        "missing value for key" | "missing value" => Some("a value is missing after =".to_owned()),
        "invalid key-value pair" => spot.value_on_next_line(),
        "unexpected key or value" => spot.after_value(),
        "unclosed table" | "unclosed array table" => Some(spot.section_name()),
        "duplicate key" => Some(format!(
            "{:?} is given twice: remove one of the two",
            spot.found
        )),
        "missing comma between array elements"
        | "unexpected `=` in array"
        | "extra comma in array"
        | "unclosed array" => Some(spot.in_list(what)),
        _ if what.contains("inline table") || what.contains("key-value pairs") => spot.in_table(),
        _ => None,
    }
}

/// Position of an error, with the text around it.
struct Spot<'a> {
    text: &'a str,
    at: usize,
    /// Text of the error's position.
    found: &'a str,
    /// Part of the line before the position.
    before: &'a str,
    /// Part of the line from the position on, without a comment.
    after: &'a str,
}

impl<'a> Spot<'a> {
    fn of(text: &'a str, place: Range<usize>) -> Option<Self> {
        let begin = text.get(..place.start)?.rfind('\n').map_or(0, |at| at + 1);
        let rest = text.get(place.start..)?;
        let line = rest.lines().next().unwrap_or("");
        Some(Spot {
            text,
            at: place.start,
            found: text.get(place.clone())?,
            before: &text[begin..place.start],
            after: without_comment(line),
        })
    }

    /// Line of the position, without a comment.
    fn line(&self) -> String {
        format!("{}{}", self.before, self.after)
    }

    /// Part of the line from the last equals sign to the position.
    fn value_before(&self) -> &'a str {
        let begin = self.before.rfind('=').map_or(0, |at| at + 1);
        self.before[begin..].trim_start()
    }

    /// Number or word that contains the position.
    fn token(&self) -> &'a str {
        let ends = |c: char| c.is_whitespace() || ",[]{}=#".contains(c);
        let head = self.before.rsplit(ends).next().unwrap_or("");
        let tail = self.after.split(ends).next().unwrap_or("");
        &self.text[self.at - head.len()..self.at + tail.len()]
    }

    /// Cause for a character that looks like a minus sign, a quotation mark or a space, but is a different one.
    fn foreign_character(&self) -> Option<String> {
        let (own, meant) = [
            ("\u{2212}\u{2013}\u{2014}", "the minus sign -"),
            (
                "\u{201c}\u{201d}\u{201e}\u{ab}\u{bb}",
                "the quotation mark \"",
            ),
            ("\u{2018}\u{2019}\u{201a}\u{b4}", "the quotation mark '"),
            ("\u{a0}\u{202f}\u{2009}", "a plain space"),
        ]
        .into_iter()
        .find_map(|(characters, meant)| {
            let found = self.found.find(|c| characters.contains(c))?;
            Some((self.found[found..].chars().next()?, meant))
        })?;
        Some(format!(
            "the character {own:?} is not part of the syntax: write {meant}"
        ))
    }

    /// Cause for a value that is neither a number nor a text in quotes.
    fn bare_words(&self) -> String {
        let found = self.found.trim();
        let words: Vec<&str> = found.split_whitespace().collect();
        let are_numbers = words.iter().all(|word| is_number(word));
        if found.is_empty() || found.starts_with('#') {
            return "a value is missing after =".to_owned();
        }
        if words.len() > 1 && are_numbers {
            let list = words.join(", ");
            return if self.innermost().is_some_and(|(bracket, _)| bracket == '[') {
                format!("a comma is missing between two numbers: {list}")
            } else {
                format!("a list has square brackets and commas: [{list}]")
            };
        }
        if let [sign @ ("-" | "+"), number] = words[..]
            && is_number(number)
        {
            return format!("remove the space after the sign: {sign}{number}");
        }
        let mut pieces = found.split(';').map(str::trim).peekable();
        pieces.next_if(|piece| is_number(piece));
        if found.contains(';') && pieces.all(|piece| piece.is_empty() || is_number(piece)) {
            return "separate the numbers with commas instead of semicolons".to_owned();
        }
        if found.contains("//") || found.contains("/*") {
            return COMMENT.to_owned();
        }
        match words[..] {
            [number, unit] if is_number(number) && is_word(unit) => {
                format!("write the number without a unit: {number}")
            }
            [word] if ["true", "yes", "on"].contains(&&*word.to_lowercase()) => {
                "write true, in small letters and without quotes".to_owned()
            }
            [word] if ["false", "no", "off"].contains(&&*word.to_lowercase()) => {
                "write false, in small letters and without quotes".to_owned()
            }
            _ if found.contains('"') => {
                "a quotation mark is missing at the beginning or at the end of the text".to_owned()
            }
            _ if found.starts_with(|c: char| c.is_ascii_digit() || "+-.(".contains(c)) => {
                format!(
                    "expected a number such as 1.5, a list in square brackets or a text in quotes, found {found}"
                )
            }
            _ => format!("write a text in quotes: {found:?}"),
        }
    }

    /// Cause for a text without a quotation mark at its end. In a table in braces, the parser also reports a number with a comma in
    /// this way.
    fn unfinished_text(&self) -> String {
        let tail = self.line();
        let is_number = self.found.is_empty() || !ends_in_text(&tail);
        match self.list_without_brackets() {
            Some(cause) if is_number => cause,
            _ => "a quotation mark is missing at the end of the text".to_owned(),
        }
    }

    /// Cause for a number without digits in front of or after its decimal point.
    fn missing_digits(&self, what: &str) -> Option<String> {
        let token = self.token();
        match what {
            "invalid mantissa" if token.contains('.') => Some(format!(
                "write a digit before the decimal point: {}",
                token.replacen('.', "0.", 1)
            )),
            "invalid fraction" if token.ends_with('.') => {
                Some(format!("write a digit after the decimal point: {token}0"))
            }
            "invalid exponent" => Some("write digits after e, as in 1e-3".to_owned()),
            _ => None,
        }
    }

    /// Cause for a number with a superfluous zero. With a comma in front of it, it is probably the fraction of a number.
    fn leading_zero(&self) -> String {
        let whole = self.before.strip_suffix(',').map(last_piece);
        match whole.and_then(|whole| decimal(whole, self.after)) {
            Some(number) => format!("write a decimal point instead of a decimal comma: {number}"),
            None => format!(
                "remove the zero at the beginning of the number {}",
                self.token()
            ),
        }
    }

    /// Cause for characters after a number.
    fn odd_number(&self) -> Option<String> {
        let token = self.token();
        if token.ends_with(';') {
            return Some("remove the semicolon: the end of the line ends the value".to_owned());
        }
        if token.matches('.').count() > 1 {
            return Some(format!(
                "the number {token} has more than one decimal point"
            ));
        }
        let end = token.find(|c: char| !c.is_ascii_digit() && !"+-._".contains(c))?;
        let (number, unit) = token.split_at(end);
        (is_number(number) && is_word(unit))
            .then(|| format!("write the number without a unit: {number}"))
    }

    /// Cause for a line without an equals sign after its first word.
    fn no_equals_sign(&self) -> String {
        let line = self.line();
        let line = line.trim();
        let name = self.before.trim().trim_matches(['(', ')']);
        if ["//", ";", "%", "/*", "--"]
            .iter()
            .any(|mark| line.starts_with(mark))
        {
            return COMMENT.to_owned();
        }
        let first = self.after.chars().next();
        if let Some(name) = name.strip_suffix(':') {
            return format!("write an equals sign instead of the colon: {name} =");
        }
        match first {
            Some(':') => format!("write an equals sign instead of the colon: {name} ="),
            Some(']') => format!("a section has a bracket on each side: [{name}]"),
            Some(')') => "the name of a section is in square brackets, such as [wheel]".to_owned(),
            Some(c) if "[{\"'+-.".contains(c) || c.is_ascii_digit() => {
                format!("an equals sign is missing: {name} = {}", self.after.trim())
            }
            _ => match line.split_once('=') {
                Some((words, _)) if words.split_whitespace().all(is_word) => {
                    let words: Vec<&str> = words.split_whitespace().collect();
                    format!("a name has no spaces: {}", words.join("_"))
                }
                _ if self.after.trim().is_empty() => format!(
                    "expected {name} = and a value. A section is in square brackets: [{name}]"
                ),
                _ => "expected a name, an equals sign and a value. A comment begins with #"
                    .to_owned(),
            },
        }
    }

    /// Cause for a line that begins with a value. The line before it ends with an equals sign.
    fn value_on_next_line(&self) -> Option<String> {
        let above = self.text[..self.at].trim_end();
        above.ends_with('=').then(|| {
            let line = self.number_of_line(above.len() - 1);
            format!("a value begins in the line of its equals sign, here line {line}. A list begins with [")
        })
    }

    /// Cause for characters after a complete value or after the name of a section.
    fn after_value(&self) -> Option<String> {
        let rest = self.after.trim();
        if self.before.trim_start().starts_with('[') && !self.before.contains('=') {
            return Some(match rest {
                "]" => "remove the second ]".to_owned(),
                _ => "write the keys of a section below the line with its name".to_owned(),
            });
        }
        if ends_in_text(&self.line()) {
            return Some("a quotation mark is missing in this line".to_owned());
        }
        match rest.chars().next()? {
            ',' if rest == "," => Some("remove the comma at the end of the line".to_owned()),
            ',' => self.list_without_brackets(),
            '=' => Some(
                "write each key in its own line, or several keys in braces: { from = 0.0, to = 1.0 }".to_owned(),
            ),
            bracket @ (']' | '}') => Some(format!("remove the {bracket}, or add the bracket that opens the value")),
            _ => None,
        }
    }

    /// Cause for numbers or texts with commas, but without brackets: a list without brackets, or a number with a decimal comma.
    fn list_without_brackets(&self) -> Option<String> {
        let value = format!("{}{}", self.value_before(), self.after);
        let value = value.trim().trim_end_matches(',');
        let pieces: Vec<&str> = value.split(',').collect();
        if let [whole, fraction, ..] = pieces[..]
            && let Some(number) = decimal(whole, fraction)
            && (pieces.len() == 2 || !is_number(pieces[2].trim()))
        {
            return Some(format!(
                "write a decimal point instead of a decimal comma: {number}"
            ));
        }
        if let [whole, rest] = pieces[..]
            && is_number(whole)
            && rest.find(|c: char| !c.is_ascii_digit()) == Some(3)
            && is_number(rest)
        {
            return Some(format!("write the number without a comma: {whole}{rest}"));
        }
        if value.ends_with('}') && pieces.get(1).is_some_and(|piece| piece.contains('=')) {
            return Some("the brace { is missing at the beginning of the table".to_owned());
        }
        if value.ends_with(']') && !value.contains('[') {
            return Some("the bracket [ is missing at the beginning of the list".to_owned());
        }
        let items = pieces
            .iter()
            .map(|piece| piece.trim_matches(|c: char| c.is_whitespace() || "()}".contains(c)));
        let items: Vec<&str> = items
            .take_while(|piece| is_number(piece) || piece.starts_with('"'))
            .collect();
        (items.len() > 1).then(|| format!("a list is in square brackets: [{}]", items.join(", ")))
    }

    /// Cause for the name of a section without brackets at its end.
    fn section_name(&self) -> String {
        let name = self.before.trim().trim_matches('[');
        match self.after.chars().next() {
            Some(c) if is_word(&c.to_string()) || self.after.trim().starts_with(is_letter) => {
                "the name of a section has no spaces; a point separates its parts, as in [suspension.hardpoints]".to_owned()
            }
            _ if self.before.trim_start().starts_with("[[") => {
                format!("a section has as many brackets at its end as at its beginning: [{}]", name.trim_matches(']'))
            }
            _ => format!("the bracket ] is missing at the end: [{name}]"),
        }
    }

    /// Cause for an error in a list in square brackets.
    fn in_list(&self, what: &str) -> String {
        if what == "extra comma in array" {
            return "remove one of the two commas, or write the missing value between them"
                .to_owned();
        }
        if ends_in_text(&self.line()) {
            return "a quotation mark is missing in this line".to_owned();
        }
        let open = self.innermost();
        if let Some((_, at)) = open {
            let begun = self.line_at(at);
            let line = self.number_of_line(at);
            if ends_in_text(begun) {
                return format!("a quotation mark is missing in line {line}");
            }
            let between = self.text[at + 1..self.at].trim();
            if what == "unexpected `=` in array" && is_word(between) {
                return "write keys and their values in braces: { from = 0.0, to = 1.0 }"
                    .to_owned();
            }
            let is_key = self.before.trim().is_empty() && key_or_section(self.after);
            if is_key || what != "missing comma between array elements" {
                return format!(
                    "the bracket ] is missing at the end of the list that begins in line {line}"
                );
            }
            if between.ends_with('}') && !between.contains('{') {
                return "the bracket ] is missing in front of the brace }".to_owned();
            }
        }
        let next = self.after.trim();
        match next.chars().next() {
            Some('}') => "the bracket ] is missing in front of the brace }".to_owned(),
            Some('{') => "a comma is missing after the brace } of the entry before".to_owned(),
            Some('[') => "a comma is missing after the bracket ] of the entry before".to_owned(),
            _ => "a comma is missing between two entries of the list".to_owned(),
        }
    }

    /// Cause for an error in a table in braces.
    fn in_table(&self) -> Option<String> {
        if ends_in_text(&self.line()) {
            return Some("a quotation mark is missing in this line".to_owned());
        }
        let (bracket, at) = self.innermost()?;
        let line = self.number_of_line(at);
        if ends_in_text(self.line_at(at)) {
            return Some(format!("a quotation mark is missing in line {line}"));
        }
        if self.before.trim().is_empty() {
            return Some(format!(
                "the brace }} is missing at the end of the table that begins in line {line}"
            ));
        }
        let inside = &self.text[at + 1..self.at];
        let first = self.after.chars().next();
        if bracket == '{' && !inside.contains('=') && is_number(inside.trim()) {
            return Some("write a list in square brackets, not in braces".to_owned());
        }
        match first {
            Some(']') => Some("the brace } is missing in front of the bracket ]".to_owned()),
            Some(',') => self.list_without_brackets(),
            Some('=') if self.value_before().contains(';') => {
                Some("separate the keys with commas instead of semicolons".to_owned())
            }
            Some('=') => Some("a comma is missing between two keys".to_owned()),
            _ if inside.trim_end().ends_with(':') || self.after.starts_with(':') => {
                Some("write an equals sign instead of the colon".to_owned())
            }
            _ if inside.trim_end().ends_with(|c: char| "\"]}".contains(c)) => {
                Some("a comma is missing between two keys".to_owned())
            }
            Some(_) => Some("an equals sign is missing after the name of the key".to_owned()),
            None => Some("the brace } is missing at the end of the table".to_owned()),
        }
    }

    /// Innermost bracket or brace that is open at the position, and its place in the text.
    fn innermost(&self) -> Option<(char, usize)> {
        let mut open = Vec::new();
        let mut begin = 0;
        for line in self.text[..self.at].split_inclusive('\n') {
            let visible = without_comment(line);
            let mut quote = None;
            for (at, c) in visible.char_indices() {
                match (quote, c) {
                    (Some(own), _) if own == c => quote = None,
                    (Some(_), _) => {}
                    (None, '"' | '\'') => quote = Some(c),
                    (None, '[' | '{') => open.push((c, begin + at)),
                    (None, ']' | '}') => drop(open.pop()),
                    (None, _) => {}
                }
            }
            begin += line.len();
        }
        open.pop()
    }

    /// Number of the line with this byte, from 1.
    fn number_of_line(&self, at: usize) -> usize {
        self.text[..at].matches('\n').count() + 1
    }

    /// Line with this byte.
    fn line_at(&self, at: usize) -> &'a str {
        let begin = self.text[..at].rfind('\n').map_or(0, |at| at + 1);
        self.text[begin..].lines().next().unwrap_or("")
    }
}

/// Help for a line that seems to be a comment.
const COMMENT: &str = "a comment begins with #";
