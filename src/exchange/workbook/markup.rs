//! Reads XML as workbooks use it (W3C, Extensible Markup Language 1.0). It reads elements with attributes and text one after the
//! other, in bounded memory: a tag or a text has at most 1 MB. It refuses document types, so no entity can expand.

use std::io::BufRead;

/// The next piece of markup.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Event {
    /// Start of an element.
    Start(Element),
    /// End of the element with this name.
    End(String),
    /// Text between tags.
    Text(String),
}

/// Start tag of an element.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Element {
    /// Name without the prefix of a namespace.
    pub name: String,
    attributes: Vec<(String, String)>,
}

impl Element {
    /// Value of an attribute, by the attribute's name without the prefix of its namespace.
    pub(super) fn attribute(&self, name: &str) -> Option<&str> {
        let found = self.attributes.iter().find(|(key, _)| key == name);
        found.map(|(_, value)| value.as_str())
    }
}

/// Largest size of a tag or of a text, in bytes.
const MOST_BYTES: usize = 1 << 20;

/// Reader that returns the events of a document.
pub(super) struct Markup<R> {
    source: R,
    /// Name of an element that starts and ends in the same tag. Its end is the next event.
    pending: Option<String>,
}

impl<R: BufRead> Markup<R> {
    /// Makes a reader for a document.
    pub(super) fn new(source: R) -> Self {
        Markup {
            source,
            pending: None,
        }
    }

    /// Reads the next event of the document: start of an element, end of an element, or text. `None` at the end of the document.
    pub(super) fn next(&mut self) -> Result<Option<Event>, String> {
        if let Some(name) = self.pending.take() {
            return Ok(Some(Event::End(name)));
        }
        loop {
            let text = self.until(b'<')?;
            if !text.is_empty() {
                return Ok(Some(Event::Text(unescaped(&text)?)));
            }
            let Some(first) = self.peek()? else {
                return Ok(None);
            };
            if first == b'<' {
                self.source.consume(1);
            }
            let mut tag = self.until(b'>')?;
            if self.peek()?.is_none() {
                return Err("the workbook is damaged: a tag does not end".to_owned());
            }
            self.source.consume(1);
            if tag.starts_with("!--") {
                while !tag.ends_with("--") || tag.len() < 5 {
                    tag = self.through(tag)?;
                }
            } else if tag.starts_with("![CDATA[") {
                while !tag.ends_with("]]") {
                    tag = self.through(tag)?;
                }
                return Ok(Some(Event::Text(tag[8..tag.len() - 2].to_owned())));
            } else if tag.starts_with('!') {
                return Err(
                    "the workbook declares a document type, which is not allowed".to_owned(),
                );
            } else if let Some(name) = tag.strip_prefix('/') {
                return Ok(Some(Event::End(local(name.trim()).to_owned())));
            } else if !tag.starts_with('?') {
                // A quoted value may contain `>`.
                let mut quote = open_quote(None, &tag);
                while quote.is_some() {
                    let known = tag.len();
                    tag = self.through(tag)?;
                    quote = open_quote(quote, &tag[known..]);
                }
                let (tag, empty) = match tag.strip_suffix('/') {
                    Some(tag) => (tag, true),
                    None => (tag.as_str(), false),
                };
                let element = element(tag)?;
                self.pending = empty.then(|| element.name.clone());
                return Ok(Some(Event::Start(element)));
            }
        }
    }

    /// Reads the text up to the next end of an element `name`. Tags inside are removed.
    pub(super) fn text_of(&mut self, name: &str) -> Result<String, String> {
        let mut text = String::new();
        loop {
            match self.next()? {
                Some(Event::Text(more)) => text += &more,
                Some(Event::End(end)) if end == name => return Ok(text),
                Some(_) => (),
                None => return Err("the workbook is damaged: an element does not end".to_owned()),
            }
            if text.len() > MOST_BYTES {
                return Err(TOO_LONG.to_owned());
            }
        }
    }

    fn peek(&mut self) -> Result<Option<u8>, String> {
        let buffer = self.source.fill_buf().map_err(|error| error.to_string())?;
        Ok(buffer.first().copied())
    }

    /// Completes a tag up to the next `>`.
    fn through(&mut self, mut tag: String) -> Result<String, String> {
        tag.push('>');
        tag += &self.until(b'>')?;
        if self.peek()?.is_none() || tag.len() > MOST_BYTES {
            return Err(TOO_LONG.to_owned());
        }
        self.source.consume(1);
        Ok(tag)
    }

    /// Reads text up to the byte `stop`, which stays unread, or up to the end.
    fn until(&mut self, stop: u8) -> Result<String, String> {
        let mut bytes = Vec::new();
        loop {
            let buffer = self.source.fill_buf().map_err(|error| error.to_string())?;
            let end = buffer.iter().position(|byte| *byte == stop);
            let count = end.unwrap_or(buffer.len());
            bytes.extend_from_slice(&buffer[..count]);
            let is_end = end.is_some() || buffer.is_empty();
            self.source.consume(count);
            if bytes.len() > MOST_BYTES {
                return Err(TOO_LONG.to_owned());
            }
            if is_end {
                return String::from_utf8(bytes)
                    .map_err(|_| "the workbook is not written in UTF-8".to_owned());
            }
        }
    }
}

const TOO_LONG: &str = "a text of the workbook is longer than 1 MB";

/// Quotation mark that is open at the end of a part of a tag. `before` is the mark that is open at its start.
fn open_quote(before: Option<char>, part: &str) -> Option<char> {
    part.chars().fold(before, |open, c| match open {
        Some(quote) if quote == c => None,
        None if ['"', '\''].contains(&c) => Some(c),
        other => other,
    })
}

/// Name without the prefix of a namespace.
fn local(name: &str) -> &str {
    name.rsplit_once(':').map_or(name, |(_, name)| name)
}

fn element(tag: &str) -> Result<Element, String> {
    let tag = tag.trim_end();
    let (name, mut rest) = tag.split_once(char::is_whitespace).unwrap_or((tag, ""));
    let mut attributes = Vec::new();
    loop {
        rest = rest.trim_start();
        let Some((key, more)) = rest.split_once('=') else {
            break;
        };
        let more = more.trim_start();
        let quote = more.chars().next().filter(|c| ['"', '\''].contains(c));
        let value = quote.and_then(|quote| more[1..].split_once(quote));
        let Some((value, more)) = value else {
            return Err("the workbook is damaged: an attribute has no value".to_owned());
        };
        attributes.push((local(key.trim()).to_owned(), unescaped(value)?));
        rest = more;
    }
    Ok(Element {
        name: local(name).to_owned(),
        attributes,
    })
}

/// Replaces the five named entities and numeric character references.
fn unescaped(text: &str) -> Result<String, String> {
    let mut parts = text.split('&');
    let mut plain = parts.next().unwrap_or("").to_owned();
    for part in parts {
        let entity = part.split_once(';').and_then(|(name, rest)| {
            let number = name
                .strip_prefix('#')
                .map(|code| match code.strip_prefix('x') {
                    Some(hex) => u32::from_str_radix(hex, 16),
                    None => code.parse(),
                });
            let character = match name {
                "amp" => Some('&'),
                "lt" => Some('<'),
                "gt" => Some('>'),
                "quot" => Some('"'),
                "apos" => Some('\''),
                _ => number.and_then(|code| char::from_u32(code.ok()?)),
            };
            Some((character?, rest))
        });
        let (character, rest) = entity.ok_or("the workbook uses an entity that is not defined")?;
        plain.push(character);
        plain += rest;
    }
    Ok(plain)
}

/// Escapes a text for the content or a quoted attribute of an element. Characters that XML forbids become �.
pub(super) fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '"' => escaped += "&quot;",
            '\t' | '\n' => escaped.push(c),
            c if c.is_control() || ['\u{fffe}', '\u{ffff}'].contains(&c) => {
                escaped.push('\u{fffd}')
            }
            c => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    fn events(text: &str) -> Result<Vec<Event>, String> {
        let mut markup = Markup::new(text.as_bytes());
        std::iter::from_fn(|| markup.next().transpose()).collect()
    }

    #[test]
    fn elements_attributes_and_text() {
        let read = events(
            "<?xml version='1.0'?><!-- a > b --><x:row r=\"1\"><c t='s'/>a&amp;&#x41;<![CDATA[<b>]]></x:row>",
        );
        let read = read.unwrap();
        let [
            Event::Start(row),
            Event::Start(c),
            Event::End(end),
            Event::Text(text),
            Event::Text(raw),
            Event::End(last),
        ] = read.as_slice()
        else {
            panic!("{read:?}");
        };
        assert_eq!((row.name.as_str(), row.attribute("r")), ("row", Some("1")));
        assert_eq!((c.attribute("t"), end.as_str()), (Some("s"), "c"));
        assert_eq!(
            (text.as_str(), raw.as_str(), last.as_str()),
            ("a&A", "<b>", "row")
        );
    }

    #[test]
    fn quoted_values_may_contain_the_end_of_a_tag() {
        let read = events("<x a='[>1]\"' b=\"'>'\"/>y").unwrap();
        let [Event::Start(x), Event::End(_), Event::Text(_)] = read.as_slice() else {
            panic!("{read:?}");
        };
        assert_eq!(
            (x.attribute("a"), x.attribute("b")),
            (Some("[>1]\""), Some("'>'"))
        );
    }

    #[test]
    fn what_could_grow_or_is_broken_is_refused() {
        assert!(events("<!DOCTYPE x [<!ENTITY a 'b'>]><x>&a;</x>").is_err());
        assert!(events("<x>&a;</x>").is_err());
        assert!(events("<x").is_err());
        assert!(events(&format!("<x>{}</x>", "a".repeat(2 << 20))).is_err());
    }

    #[test]
    fn escaped_text_reads_back() {
        let text = "a & b < \"c\" > d";
        assert_eq!(unescaped(&escaped(text)).unwrap(), text);
    }
}
