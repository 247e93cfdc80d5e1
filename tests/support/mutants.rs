//! Generator of damaged studies (mutants). It deletes, duplicates and swaps lines, replaces numbers by unusual ones,
//! truncates files and inserts unusual characters. A number identifies each mutant.

use super::random::Random;

const NUMBERS: &[&str] = &[
    "nan",
    "-nan",
    "inf",
    "-inf",
    "1e300",
    "-1e300",
    "1e400",
    "-0.0",
    "0",
    "0.0",
    "1e-300",
    "5e-324",
    "1e17",
    "-1",
    "1",
    "3",
    "1e12",
    "1e-9",
    "9223372036854775807",
    "99999999999999999999",
    "1_000_000",
    "0x7f",
    "\"1\"",
    "[]",
    "{}",
    "true",
    "1979-05-27",
];
const TEXTS: &[&str] = &[
    "é", "\u{0}", "\u{202e}", "𝄞", "\"", "'''", "\\", "[", "]", "=", ",", "#", "\r", "\t", ".",
];

/// Study with random damage.
pub fn mutilated(text: &str, random: &mut Random) -> String {
    let mut text = text.to_owned();
    for _ in 0..=below(random, 2) {
        text = match below(random, 9) {
            0 => with_lines(&text, random, |lines, i, _| {
                lines.remove(i);
            }),
            1 => with_lines(&text, random, |lines, i, j| lines.insert(j, lines[i])),
            2 => with_lines(&text, random, |lines, i, j| lines.swap(i, j)),
            3 => {
                let end = boundary(&text, random);
                text[..end].to_owned()
            }
            4 => {
                let (at, piece) = (boundary(&text, random), TEXTS[below(random, TEXTS.len())]);
                format!("{}{piece}{}", &text[..at], &text[at..])
            }
            5 => {
                let words = tokens(&text, |c| c.is_ascii_lowercase() || c == '_');
                exchanged(&text, &words, random)
            }
            6 => {
                let numbers = tokens(&text, is_numeric);
                exchanged(&text, &numbers, random)
            }
            _ => {
                let numbers = tokens(&text, is_numeric);
                let number = NUMBERS[below(random, NUMBERS.len())];
                match numbers.get(below(random, numbers.len().max(1))) {
                    Some(place) => text[..place.start].to_owned() + number + &text[place.end..],
                    None => text,
                }
            }
        };
    }
    text
}

fn below(random: &mut Random, n: usize) -> usize {
    ((random.signed() + 1.0) * 0.5 * n as f64) as usize
}

fn with_lines(
    text: &str,
    random: &mut Random,
    change: impl FnOnce(&mut Vec<&str>, usize, usize),
) -> String {
    let mut lines: Vec<_> = text.lines().collect();
    if lines.is_empty() {
        return String::new();
    }
    let (i, j) = (below(random, lines.len()), below(random, lines.len()));
    change(&mut lines, i, j);
    lines.join("\n") + "\n"
}

/// Random position between two characters.
fn boundary(text: &str, random: &mut Random) -> usize {
    let at = below(random, text.len() + 1);
    (at..=text.len())
        .find(|i| text.is_char_boundary(*i))
        .unwrap()
}

fn is_numeric(c: char) -> bool {
    c.is_ascii_digit() || c == '.' || c == '-'
}

/// Ranges of consecutive characters for which `belongs` returns true, outside comments.
fn tokens(text: &str, belongs: impl Fn(char) -> bool) -> Vec<std::ops::Range<usize>> {
    let mut found: Vec<std::ops::Range<usize>> = Vec::new();
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        let code = line.split('#').next().unwrap_or_default();
        for (i, c) in code.char_indices().filter(|(_, c)| belongs(*c)) {
            let at = start + i;
            match found.last_mut().filter(|last| last.end == at) {
                Some(last) => last.end += c.len_utf8(),
                None => found.push(at..at + c.len_utf8()),
            }
        }
        start += line.len();
    }
    found
}

fn exchanged(text: &str, tokens: &[std::ops::Range<usize>], random: &mut Random) -> String {
    if tokens.is_empty() {
        return text.to_owned();
    }
    let mut pick = || below(random, tokens.len());
    let (a, b) = (pick(), pick());
    let (a, b) = (&tokens[a.min(b)], &tokens[a.max(b)]);
    if a == b {
        return text.to_owned();
    }
    let (before, between, after) = (&text[..a.start], &text[a.end..b.start], &text[b.end..]);
    format!(
        "{before}{}{between}{}{after}",
        &text[b.clone()],
        &text[a.clone()]
    )
}
