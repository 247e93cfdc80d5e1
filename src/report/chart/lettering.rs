//! Words on a picture: as text, which the program that shows the SVG draws in its fonts, or as outlines.
//!
//! A PNG must not depend on the fonts of a machine, because a machine may have no fonts. Its letters come from DejaVu Sans. The
//! licence of this font (Bitstream Vera's) is permissive, and its crate contains nothing else. Most other fonts in crates have
//! the Open Font License, or are part of a crate for user interfaces. [`glyphs`](super::glyphs) reads the outlines, and they are
//! drawn as paths before `resvg` gets the picture. The text feature of `resvg` also supports shaping and right-to-left scripts.
//! It needs a dozen more crates, and `resvg` then takes three times as long to compile. Labels of axes and names of designs do
//! not need it. A character that the font does not have becomes a box.

use super::glyphs::{Command, Font};
use super::mark::number;
use std::fmt::Write;

/// Form in which words are written.
pub(in crate::report) enum Lettering {
    /// Text elements of SVG.
    Text,
    /// Outlines from a font.
    Outlines(Font<'static>),
}

/// Part of some words that is at the given position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::report) enum Anchor {
    /// Left end of the words.
    Start,
    /// Middle of the words.
    Middle,
    /// Right end of the words.
    End,
}

/// Words at a position.
pub(in crate::report) struct Words<'a> {
    text: &'a str,
    at: [f64; 2],
    anchor: Anchor,
    label: bool,
    class: &'a str,
    upward: bool,
}

impl<'a> Words<'a> {
    /// Makes small horizontal words whose baseline is at this position.
    pub(in crate::report) fn new(text: &'a str, at: [f64; 2], anchor: Anchor) -> Self {
        Words {
            text,
            at,
            anchor,
            label: false,
            class: "",
            upward: false,
        }
    }

    /// Makes the words larger, as for the label of an axis.
    pub(in crate::report) fn label(mut self) -> Self {
        self.label = true;
        self
    }

    /// Adds CSS classes to the words.
    pub(in crate::report) fn class(mut self, class: &'a str) -> Self {
        self.class = class;
        self
    }

    /// Turns the words upward, so that they read from bottom to top.
    pub(in crate::report) fn upward(mut self) -> Self {
        self.upward = true;
        self
    }
}

/// Ratio of the letter size of outlines to the letter size of text. The letters of DejaVu Sans are large for their nominal size.
/// This ratio makes them look like the usual fonts for SVG.
const OUTLINE_SHARE: f64 = 0.92;
/// Size of small words, as in the CSS style of charts.
const SIZE: f64 = 12.0;
/// Size of axis labels, as in the CSS style of charts.
const LABEL_SIZE: f64 = 13.0;

impl Lettering {
    /// Lettering with outlines.
    pub(in crate::report) fn outlines() -> Self {
        let font = Font::new(dejavu::sans::regular());
        Lettering::Outlines(font.expect("the crate contains a font"))
    }

    /// Writes words to a picture.
    pub(in crate::report) fn write(&self, svg: &mut String, words: &Words) {
        match self {
            Lettering::Text => write_text(svg, words),
            Lettering::Outlines(font) => write_outlines(svg, words, font),
        }
    }
}

fn write_text(svg: &mut String, words: &Words) {
    let [x, y] = words.at.map(number);
    let class = classes("", words);
    let anchor = match words.anchor {
        Anchor::Start => "",
        Anchor::Middle => " text-anchor=\"middle\"",
        Anchor::End => " text-anchor=\"end\"",
    };
    let turned = if words.upward {
        format!(" transform=\"rotate(-90 {x} {y})\"")
    } else {
        String::new()
    };
    let text = text(words.text);
    let _ = write!(
        svg,
        "<text{class} x=\"{x}\" y=\"{y}\"{anchor}{turned}>{text}</text>"
    );
}

fn write_outlines(svg: &mut String, words: &Words, font: &Font) {
    let size = if words.label { LABEL_SIZE } else { SIZE };
    let scale = OUTLINE_SHARE * size / f64::from(font.units_per_em);
    let mut path = Outline::default();
    for letter in words.text.chars() {
        let glyph = font.glyph(letter);
        font.draw(glyph, &mut |command| path.draw(command));
        path.pen += i32::from(font.advance(glyph));
    }
    let before = match words.anchor {
        Anchor::Start => 0,
        Anchor::Middle => path.pen / 2,
        Anchor::End => path.pen,
    };
    let [x, y] = words.at.map(number);
    let turned = if words.upward { " rotate(-90)" } else { "" };
    let class = classes("letters", words);
    let _ = write!(
        svg,
        "<path{class} transform=\"translate({x} {y}){turned} scale({scale:.6} {:.6}) \
         translate({} 0)\" d=\"{}\"/>",
        -scale, -before, path.commands
    );
}

/// Attribute with the classes of words. Empty if the words have no classes.
fn classes(first: &str, words: &Words) -> String {
    let label = if words.label { "label" } else { "" };
    let all: Vec<&str> = [first, label, words.class]
        .into_iter()
        .filter(|c| !c.is_empty())
        .collect();
    if all.is_empty() {
        String::new()
    } else {
        format!(" class=\"{}\"", all.join(" "))
    }
}

/// Outline of some letters as path commands, in the font's units (y up).
#[derive(Default)]
struct Outline {
    commands: String,
    /// Horizontal start of the next letter.
    pen: i32,
}

impl Outline {
    fn draw(&mut self, command: Command) {
        match command {
            Command::Move(point) => self.add('M', [point]),
            Command::Line(point) => self.add('L', [point]),
            Command::Curve(control, point) => self.add('Q', [control, point]),
            Command::Close => self.commands.push('Z'),
        }
    }

    fn add<const N: usize>(&mut self, command: char, places: [[f32; 2]; N]) {
        self.commands.push(command);
        for [x, y] in places {
            // Coordinates are integers, except in scaled parts of glyphs, where the fraction can be ignored.
            let _ = write!(
                self.commands,
                "{} {} ",
                x.round() as i32 + self.pen,
                y.round()
            );
        }
    }
}

/// Escapes text for the content of an SVG element. Control characters become �, because SVG has no notation for them.
pub(in crate::report) fn text(plain: &str) -> String {
    let shown = |c: char| if c.is_control() { '\u{fffd}' } else { c };
    let plain: String = plain.chars().map(shown).collect();
    let plain = plain.replace('&', "&amp;");
    plain.replace('<', "&lt;").replace('>', "&gt;")
}
