//! Outlines of the letters of a TrueType font, as commands of an SVG path.
//!
//! A table directory lists the tables of a font (OpenType specification 1.9.1, chapters otff, cmap, head, hhea, hmtx, loca,
//! glyf). `cmap` maps characters to glyphs, `hmtx` has the advance widths, and `loca` has the positions of outlines in `glyf`.
//! An outline consists of closed contours, or of other glyphs that are moved and scaled. A contour has points on and off the
//! curve. Between two points off the curve there is an implied point on the curve, halfway:
//!
//! ```text
//! p = (a + b) / 2                                                                       (1)
//! ```
//!
//! Hinting, kerning and variations are left out, because a picture does not need them.

/// Deepest nesting of composite glyphs.
const DEEPEST: usize = 8;

/// A TrueType font.
#[derive(Clone, Copy)]
pub(in crate::report) struct Font<'a> {
    characters: Bytes<'a>,
    advances: Bytes<'a>,
    places: Bytes<'a>,
    outlines: Bytes<'a>,
    /// Font units per em.
    pub(in crate::report) units_per_em: u16,
    /// Number of glyphs with their own advance width.
    widths: usize,
    has_long_places: bool,
}

/// A command of a path. Points are in the font's units, y up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::report) enum Command {
    /// Begins a contour.
    Move([f32; 2]),
    /// Draws a straight line.
    Line([f32; 2]),
    /// Draws a parabola: first its control point, then its end.
    Curve([f32; 2], [f32; 2]),
    /// Closes the contour.
    Close,
}

impl<'a> Font<'a> {
    /// Reads the tables of a font. `None` if one is missing, or if the font has no map of Unicode characters.
    pub(in crate::report) fn new(data: &'a [u8]) -> Option<Self> {
        let data = Bytes(data);
        let head = table(data, b"head")?;
        Some(Font {
            characters: unicode_map(table(data, b"cmap")?)?,
            advances: table(data, b"hmtx")?,
            places: table(data, b"loca")?,
            outlines: table(data, b"glyf")?,
            units_per_em: head.u16(18)?,
            widths: usize::from(table(data, b"hhea")?.u16(34)?),
            has_long_places: head.u16(50)? == 1,
        })
    }

    /// Glyph of a character. Returns 0, a box, if the font does not have the character. `characters` has segments of consecutive
    /// characters with consecutive glyphs (format 12).
    pub(in crate::report) fn glyph(&self, character: char) -> u16 {
        let (map, code) = (self.characters, u32::from(character));
        let find = || {
            let (mut first, mut last) = (0, map.u32(12)? as usize);
            // The segments of `characters` are sorted, so a binary search finds the segment of the character.
            while first < last {
                let middle = first.midpoint(last);
                let [start, end, glyph] = [0, 4, 8].map(|k| map.u32(16 + 12 * middle + k));
                if code > end? {
                    first = middle + 1;
                } else if code < start? {
                    last = middle;
                } else {
                    return u16::try_from(glyph? + (code - start?)).ok();
                }
            }
            None
        };
        find().unwrap_or(0)
    }

    /// Advance width: horizontal distance from the start of this glyph to the start of the next one, in font units.
    pub(in crate::report) fn advance(&self, glyph: u16) -> u16 {
        // The last width applies to all further glyphs.
        let place = usize::from(glyph).min(self.widths.saturating_sub(1));
        self.advances.u16(4 * place).unwrap_or(0)
    }

    /// Draws the outline of a glyph. Draws nothing for a space, or if the font is damaged.
    pub(in crate::report) fn draw(&self, glyph: u16, draw: &mut impl FnMut(Command)) {
        let _ = self.draw_moved(glyph, &Placement::HERE, DEEPEST, draw);
    }

    fn outline(&self, glyph: u16) -> Option<Bytes<'a>> {
        let place = |k: usize| {
            if self.has_long_places {
                Some(self.places.u32(4 * k)? as usize)
            } else {
                Some(2 * usize::from(self.places.u16(2 * k)?))
            }
        };
        let number = usize::from(glyph);
        let outline = self.outlines.0.get(place(number)?..place(number + 1)?)?;
        Some(Bytes(outline))
    }

    fn draw_moved(
        &self,
        glyph: u16,
        placement: &Placement,
        depth: usize,
        draw: &mut impl FnMut(Command),
    ) -> Option<()> {
        let outline = self.outline(glyph)?;
        match usize::try_from(outline.i16(0)?) {
            Ok(contours) => contour_points(outline, contours, placement, draw),
            Err(_) => self.draw_parts(outline, placement, depth.checked_sub(1)?, draw),
        }
    }

    /// Draws a glyph that consists of other glyphs.
    fn draw_parts(
        &self,
        outline: Bytes,
        placement: &Placement,
        depth: usize,
        draw: &mut impl FnMut(Command),
    ) -> Option<()> {
        const WORDS: u16 = 0x1;
        const OFFSETS: u16 = 0x2;
        const SCALE: u16 = 0x8;
        const MORE: u16 = 0x20;
        const TWO_SCALES: u16 = 0x40;
        const MATRIX: u16 = 0x80;
        let mut at = 10;
        loop {
            let (flags, glyph) = (outline.u16(at)?, outline.u16(at + 2)?);
            at += 4;
            let mut part = Placement::HERE;
            if flags & WORDS != 0 {
                part.offset = [outline.i16(at)?, outline.i16(at + 2)?].map(f32::from);
                at += 4;
            } else {
                part.offset = [outline.i8(at)?, outline.i8(at + 1)?].map(f32::from);
                at += 2;
            }
            if flags & OFFSETS == 0 {
                part.offset = [0.0; 2];
            }
            // A scale is a 16-bit number with 14 fractional bits.
            let mut scale = || {
                let value = f32::from(outline.i16(at)?) / 16384.0;
                at += 2;
                Some(value)
            };
            if flags & SCALE != 0 {
                let scale = scale()?;
                part.columns = [[scale, 0.0], [0.0, scale]];
            } else if flags & TWO_SCALES != 0 {
                part.columns = [[scale()?, 0.0], [0.0, scale()?]];
            } else if flags & MATRIX != 0 {
                part.columns = [[scale()?, scale()?], [scale()?, scale()?]];
            }
            self.draw_moved(glyph, &placement.after(&part), depth, draw)?;
            if flags & MORE == 0 {
                return Some(());
            }
        }
    }
}

/// Position of a glyph inside another one: `columns [x y]^T + offset`.
struct Placement {
    columns: [[f32; 2]; 2],
    offset: [f32; 2],
}

impl Placement {
    const HERE: Placement = Placement {
        columns: [[1.0, 0.0], [0.0, 1.0]],
        offset: [0.0; 2],
    };

    fn turn(&self, [x, y]: [f32; 2]) -> [f32; 2] {
        let [a, b] = self.columns;
        [a[0] * x + b[0] * y, a[1] * x + b[1] * y]
    }

    fn apply(&self, point: [f32; 2]) -> [f32; 2] {
        let [x, y] = self.turn(point);
        [x + self.offset[0], y + self.offset[1]]
    }

    /// Combines two placements: `inner` inside a glyph that has this placement.
    fn after(&self, inner: &Placement) -> Placement {
        Placement {
            columns: inner.columns.map(|column| self.turn(column)),
            offset: self.apply(inner.offset),
        }
    }
}

/// Reads the contours of an outline and draws them.
fn contour_points(
    outline: Bytes,
    contours: usize,
    placement: &Placement,
    draw: &mut impl FnMut(Command),
) -> Option<()> {
    const ON_CURVE: u8 = 0x1;
    const REPEATED: u8 = 0x8;
    let Some(last) = contours.checked_sub(1) else {
        return Some(());
    };
    let points = usize::from(outline.u16(10 + 2 * last)?) + 1;
    let mut at = 10 + 2 * contours;
    at += 2 + usize::from(outline.u16(at)?);
    let mut flags = Vec::with_capacity(points);
    while flags.len() < points {
        let flag = outline.u8(at)?;
        at += 1;
        let mut times = 1;
        if flag & REPEATED != 0 {
            times += usize::from(outline.u8(at)?);
            at += 1;
        }
        flags.extend(std::iter::repeat_n(flag, times));
    }
    flags.truncate(points);
    let x = coordinates(outline, &mut at, &flags, 0x2, 0x10)?;
    let y = coordinates(outline, &mut at, &flags, 0x4, 0x20)?;
    let mut first = 0;
    for contour in 0..contours {
        let end = usize::from(outline.u16(10 + 2 * contour)?) + 1;
        let end = end.min(points).max(first);
        let own = (first..end).map(|k| {
            let point = placement.apply([x[k], y[k]].map(f32::from));
            (point, flags[k] & ON_CURVE != 0)
        });
        draw_contour(&own.collect::<Vec<_>>(), draw);
        first = end;
    }
    Some(())
}

/// Reads the coordinates of one axis, which are stored as differences. With the flag `short`, a difference has one byte and the
/// flag `same` gives its sign. Without `short`, it has two bytes, or no byte if `same` states that the coordinate does not
/// change.
fn coordinates(
    outline: Bytes,
    at: &mut usize,
    flags: &[u8],
    short: u8,
    same: u8,
) -> Option<Vec<i16>> {
    let mut value = 0i16;
    let values = flags.iter().map(|flag| {
        let step = match (flag & short != 0, flag & same != 0) {
            (true, positive) => {
                let size = i16::from(outline.u8(*at)?);
                *at += 1;
                if positive { size } else { -size }
            }
            (false, true) => 0,
            (false, false) => {
                let step = outline.i16(*at)?;
                *at += 2;
                step
            }
        };
        value = value.wrapping_add(step);
        Some(value)
    });
    values.collect()
}

/// Draws a contour from its points. The flag of a point is true if the point is on the curve. Equation (1) of this module gives the
/// implied points halfway between two points off the curve.
fn draw_contour(points: &[([f32; 2], bool)], draw: &mut impl FnMut(Command)) {
    let Some((first, others)) = points.split_first() else {
        return;
    };
    // A contour begins on the curve: at its first point, else at its second point, else halfway between both.
    let (start, others, last) = match (first, others) {
        ((start, true), _) => (*start, others, None),
        (_, []) => return,
        (off, [(start, true), others @ ..]) => (*start, others, Some(off)),
        ((off, false), [(next, false), ..]) => (halfway(*off, *next), others, Some(first)),
    };
    draw(Command::Move(start));
    let mut control = None;
    for (point, is_on) in others.iter().chain(last) {
        match (control, is_on) {
            (None, true) => draw(Command::Line(*point)),
            (Some(off), true) => draw(Command::Curve(off, *point)),
            (Some(off), false) => draw(Command::Curve(off, halfway(off, *point))),
            (None, false) => {}
        }
        control = (!is_on).then_some(*point);
    }
    draw(control.map_or(Command::Line(start), |off| Command::Curve(off, start)));
    draw(Command::Close);
}

fn halfway(a: [f32; 2], b: [f32; 2]) -> [f32; 2] {
    [0, 1].map(|k| a[k] + 0.5 * (b[k] - a[k]))
}

/// Table with this name.
fn table<'a>(data: Bytes<'a>, name: &[u8; 4]) -> Option<Bytes<'a>> {
    let tables = usize::from(data.u16(4)?);
    let mut records = (0..tables).map(|k| 12 + 16 * k);
    let record = records.find(|at| data.0.get(*at..at + 4) == Some(name))?;
    let (start, length) = (
        data.u32(record + 8)? as usize,
        data.u32(record + 12)? as usize,
    );
    Some(Bytes(data.0.get(start..start.checked_add(length)?)?))
}

/// Map of all Unicode characters (format 12) in a `cmap` table.
fn unicode_map(table: Bytes) -> Option<Bytes> {
    let maps = usize::from(table.u16(2)?);
    let starts = (0..maps).filter_map(|k| table.u32(8 + 8 * k));
    let mut found = starts.filter_map(|start| Some(Bytes(table.0.get(start as usize..)?)));
    found.find(|map| map.u16(0) == Some(12))
}

/// Bytes of a font. Numbers are big-endian.
#[derive(Clone, Copy)]
struct Bytes<'a>(&'a [u8]);

impl Bytes<'_> {
    fn u8(self, at: usize) -> Option<u8> {
        self.0.get(at).copied()
    }

    fn i8(self, at: usize) -> Option<i8> {
        Some(self.u8(at)? as i8)
    }

    fn u16(self, at: usize) -> Option<u16> {
        Some(u16::from_be_bytes(self.0.get(at..at + 2)?.try_into().ok()?))
    }

    fn i16(self, at: usize) -> Option<i16> {
        Some(self.u16(at)? as i16)
    }

    fn u32(self, at: usize) -> Option<u32> {
        Some(u32::from_be_bytes(self.0.get(at..at + 4)?.try_into().ok()?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn font() -> Font<'static> {
        Font::new(dejavu::sans::regular()).unwrap()
    }

    /// For every glyph the font stores the extent of its outline, in integer units. For Latin and Greek letters that are not
    /// composite, the extent of the curves differs from the stored extent by less than a unit. (For 47 rarer glyphs the stored
    /// extent is wrong by up to 19 units.)
    #[test]
    fn outlines_reach_as_far_as_the_font_says() {
        let (font, mut outlines) = (font(), 0);
        for character in ' '..='\u{3ff}' {
            let glyph = font.glyph(character);
            let Some(outline) = font.outline(glyph) else {
                continue;
            };
            if outline.i16(0).is_none_or(|contours| contours <= 0) {
                continue;
            }
            let box_ends = [2, 4, 6, 8].map(|at| f32::from(outline.i16(at).unwrap()));
            let mut reach = [f32::MAX, f32::MAX, f32::MIN, f32::MIN];
            let mut widen = |[x, y]: [f32; 2]| {
                let [left, low, right, high] = reach;
                reach = [left.min(x), low.min(y), right.max(x), high.max(y)];
            };
            let (mut open, mut at) = (0, [0.0; 2]);
            font.draw(glyph, &mut |command| match command {
                Command::Move(p) | Command::Line(p) => {
                    open += i32::from(matches!(command, Command::Move(_)));
                    widen(p);
                    at = p;
                }
                Command::Curve(control, p) => {
                    // Position between the ends where a coordinate of the parabola has its extreme value.
                    let (a, b, c) = (at, control, p);
                    let place = |t: f32, k: usize| {
                        let u = 1.0 - t;
                        u * u * a[k] + 2.0 * u * t * b[k] + t * t * c[k]
                    };
                    for k in 0..2 {
                        let turn = (a[k] - b[k]) / (a[k] - 2.0 * b[k] + c[k]);
                        if turn > 0.0 && turn < 1.0 {
                            widen([place(turn, 0), place(turn, 1)]);
                        }
                    }
                    widen(p);
                    at = p;
                }
                Command::Close => open -= 1,
            });
            assert_eq!(open, 0, "glyph {glyph}");
            for (reach, end) in reach.iter().zip(box_ends) {
                assert!((reach - end).abs() < 1.0, "glyph {glyph}: {reach} {end}");
            }
            outlines += 1;
        }
        assert!(outlines > 400, "{outlines}");
    }

    /// A letter with an accent consists of the letter and the moved accent. A character without a glyph becomes a box.
    #[test]
    fn letters_are_made_of_others_and_missing_ones_are_boxes() {
        let font = font();
        let commands = |character| {
            let mut commands = Vec::new();
            font.draw(font.glyph(character), &mut |command| commands.push(command));
            commands
        };
        let (plain, accented) = (commands('e'), commands('\u{e9}'));
        assert_eq!(plain, accented[..plain.len()]);
        assert!(accented.len() > plain.len());
        assert_eq!(
            font.advance(font.glyph('e')),
            font.advance(font.glyph('\u{e9}'))
        );
        assert_eq!(font.glyph('\u{10ffff}'), 0);
        assert_eq!(commands('\u{10ffff}'), commands('\u{e000}'));
        assert!(commands(' ').is_empty() && font.advance(font.glyph(' ')) > 0);
    }

    /// A truncated font draws fewer outlines, and never panics.
    #[test]
    fn a_broken_font_draws_less() {
        let whole = dejavu::sans::regular();
        for part in 0..60 {
            if let Some(font) = Font::new(&whole[..whole.len() * part / 60]) {
                for character in ['A', '\u{e9}', '\u{3b1}'] {
                    font.draw(font.glyph(character), &mut |_| ());
                }
            }
        }
        let mut bytes = whole[..].to_vec();
        for k in (0..bytes.len()).step_by(97) {
            bytes[k] = bytes[k].wrapping_mul(31).wrapping_add(17);
        }
        if let Some(font) = Font::new(&bytes) {
            for glyph in 0..200 {
                font.draw(glyph, &mut |_| ());
            }
        }
    }
}
