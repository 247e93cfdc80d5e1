//! Axes of a file: the direction in which each of the three coordinates increases. Headers, titles, the format or the
//! user state these directions.

use crate::model::{FrameConvention, Side};
use std::fmt;

/// Direction in which a coordinate of a file grows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// Towards the front of the car.
    Forward,
    /// Towards the rear of the car.
    Rearward,
    /// Towards the left of the car.
    Left,
    /// Towards the right of the car.
    Right,
    /// Away from the ground.
    Up,
    /// Towards the ground.
    Down,
}

impl Way {
    /// All six directions.
    const ALL: [Way; 6] = [
        Way::Forward,
        Way::Rearward,
        Way::Left,
        Way::Right,
        Way::Up,
        Way::Down,
    ];

    /// Name of the direction in `--axes`.
    pub fn name(self) -> &'static str {
        ["forward", "rearward", "left", "right", "up", "down"][self as usize]
    }

    /// Direction that a word names, in upper or lower case. `None` if it names none.
    pub(super) fn of(word: &str) -> Option<Way> {
        Some(match word.to_ascii_lowercase().as_str() {
            "forward" | "forwards" | "fwd" | "front" | "frontward" | "fore" | "ahead" => {
                Way::Forward
            }
            "rearward" | "rearwards" | "rear" | "aft" | "back" | "backward" | "backwards" => {
                Way::Rearward
            }
            "left" | "leftward" | "leftwards" => Way::Left,
            "right" | "rightward" | "rightwards" => Way::Right,
            "up" | "upward" | "upwards" => Way::Up,
            "down" | "downward" | "downwards" => Way::Down,
            _ => return None,
        })
    }

    /// Axis of the direction in ISO 8855: 0 along the car, 1 across it, 2 vertical.
    pub(super) fn axis(self) -> usize {
        self as usize / 2
    }

    /// Sign of the direction in ISO 8855 (x forward, y left, z up).
    pub(super) fn sign(self) -> f64 {
        [1.0, -1.0, 1.0, -1.0, 1.0, -1.0][self as usize]
    }

    /// Direction along an ISO axis with this sign.
    pub(super) fn along(axis: usize, sign: f64) -> Way {
        Way::ALL[2 * axis + usize::from(sign < 0.0)]
    }

    /// Opposite direction.
    pub(super) fn opposite(self) -> Way {
        Way::along(self.axis(), -self.sign())
    }
}

/// Directions of all three coordinates, one along each axis of the car.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Axes(pub(super) [Way; 3]);

impl Axes {
    /// Makes axes with these directions. `None` unless exactly one direction is along each axis of the car.
    pub(super) fn new(ways: [Way; 3]) -> Option<Self> {
        let mut axes = ways.map(Way::axis);
        axes.sort_unstable();
        (axes == [0, 1, 2]).then_some(Axes(ways))
    }

    /// Parses `left,forward,up`.
    ///
    /// # Errors
    /// The text is not three directions, one along each axis.
    pub fn parse(text: &str) -> Result<Self, String> {
        let named = |word: &str| Way::of(word.trim());
        let ways: Option<Vec<Way>> = text.split(',').map(named).collect();
        let ways: Option<[Way; 3]> = ways.and_then(|ways| ways.try_into().ok());
        ways.and_then(Axes::new).ok_or_else(|| {
            "expected the directions of the file's x, y and z, each forward, rearward, left, \
             right, up or down, along three different axes, as in --axes left,forward,up"
                .to_owned()
        })
    }

    /// Axes of a convention.
    pub fn of(convention: FrameConvention) -> Self {
        Axes(match convention {
            FrameConvention::Iso8855 => [Way::Forward, Way::Left, Way::Up],
            FrameConvention::SaeJ670 => [Way::Forward, Way::Right, Way::Down],
            FrameConvention::XRear => [Way::Rearward, Way::Right, Way::Up],
        })
    }

    /// Convention with these axes. `None` if studies have no such convention.
    pub(super) fn convention(self) -> Option<FrameConvention> {
        let mut all = FrameConvention::ALL.into_iter();
        all.find(|convention| Axes::of(*convention) == self)
    }

    /// True if x, y and z form a right-handed system.
    pub fn is_right_handed(self) -> bool {
        let [x, y, z] = self.0.map(Way::axis);
        // An even permutation of the three axes keeps the handedness.
        let is_even = [[0, 1, 2], [1, 2, 0], [2, 0, 1]].contains(&[x, y, z]);
        let sign: f64 = self.0.iter().map(|way| way.sign()).product();
        is_even == (sign > 0.0)
    }

    /// Number of the coordinate that runs across the car, and 1 if it grows towards the left, else -1.
    pub(super) fn across(self) -> (usize, f64) {
        let column = self.0.iter().position(|way| way.axis() == 1);
        let column = column.expect("expected three different axes");
        (column, self.0[column].sign())
    }

    /// Converts a position or vector of the file to ISO 8855. Only the order and the signs of its coordinates change.
    pub(super) fn to_iso(self, position: [f64; 3]) -> [f64; 3] {
        let mut iso = [0.0; 3];
        for (way, coordinate) in self.0.iter().zip(position) {
            iso[way.axis()] = if way.sign() > 0.0 {
                coordinate
            } else {
                0.0 - coordinate
            };
        }
        iso
    }

    /// Converts a vector of ISO 8855 to the file's coordinates.
    pub(super) fn iso_in_file(self, vector: [f64; 3]) -> [f64; 3] {
        self.0.map(|way| way.sign() * vector[way.axis()])
    }
}

impl fmt::Display for Axes {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let [x, y, z] = self.0.map(Way::name);
        write!(f, "{x},{y},{z}")
    }
}

/// Direction of one coordinate, as far as it is known from the file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Coordinate {
    /// The file states nothing about this coordinate.
    #[default]
    Unknown,
    /// The file states the axis of the coordinate (index in ISO 8855, as for "lateral"), but not its sign.
    Along(usize),
    /// The file states the direction in which the coordinate grows.
    Grows(Way),
}

impl Coordinate {
    /// Combines two statements about the same coordinate. `None` if they contradict each other.
    pub(super) fn and(self, other: Coordinate) -> Option<Coordinate> {
        match (self, other) {
            (Coordinate::Unknown, other) | (other, Coordinate::Unknown) => Some(other),
            (Coordinate::Along(a), Coordinate::Along(b)) => (a == b).then_some(self),
            (Coordinate::Grows(a), Coordinate::Grows(b)) => (a == b).then_some(self),
            (Coordinate::Along(a), Coordinate::Grows(way))
            | (Coordinate::Grows(way), Coordinate::Along(a)) => {
                (a == way.axis()).then_some(Coordinate::Grows(way))
            }
        }
    }
}

/// Directions of all axes, as far as they are known from the file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Declared(pub(super) [Coordinate; 3]);

impl Declared {
    /// Makes a statement that gives the directions of all three axes.
    pub(super) fn whole(axes: Axes) -> Self {
        Declared(axes.0.map(Coordinate::Grows))
    }

    /// Combines two statements about the axes. Returns an error that names `place` if they contradict each other.
    pub(super) fn and(self, other: Declared, place: &str) -> Result<Declared, String> {
        let mut both = self;
        for (k, coordinate) in both.0.iter_mut().enumerate() {
            *coordinate = coordinate.and(other.0[k]).ok_or_else(|| {
                format!(
                    "{place}: the axes differ from those above; give the directions of x, y and z with --axes, \
                     as in --axes forward,left,up"
                )
            })?;
        }
        Ok(both)
    }

    /// Axes of a convention of studies by its name, such as `iso8855`. `None` for other names.
    pub(super) fn named(name: &str) -> Option<Self> {
        FrameConvention::named(name).map(|known| Declared::whole(Axes::of(known)))
    }

    /// Axes, if the file states all of them.
    pub(super) fn axes(self) -> Option<Axes> {
        let way = |coordinate| match coordinate {
            Coordinate::Grows(way) => Some(way),
            _ => None,
        };
        let [x, y, z] = self.0.map(way);
        Axes::new([x?, y?, z?])
    }

    /// True if `axes` agree with all directions that the file states.
    pub(super) fn allows(self, axes: Axes) -> bool {
        let agrees = |(stated, way): (&Coordinate, Way)| match stated {
            Coordinate::Unknown => true,
            Coordinate::Along(axis) => way.axis() == *axis,
            Coordinate::Grows(stated) => *stated == way,
        };
        self.0.iter().zip(axes.0).all(agrees)
    }

    /// True if the file states no direction.
    pub(super) fn is_empty(self) -> bool {
        self == Declared::default()
    }

    /// Reads directions of axes from a line of text, such as "SAE axes" or "x forward, y left, z up". The result is empty unless
    /// the text states all three axes.
    pub(super) fn in_text(text: &str) -> Declared {
        let words = super::names::cut(text);
        let has = |wanted: &str| words.iter().any(|word| word == wanted);
        // The name "Formula SAE" does not refer to a convention of axes.
        const ABOUT_AXES: [&str; 8] = [
            "axes",
            "axis",
            "frame",
            "coordinate",
            "coordinates",
            "system",
            "convention",
            "j670",
        ];
        if has("j670") || (has("sae") && ABOUT_AXES.into_iter().any(has)) {
            return Declared::whole(Axes::of(FrameConvention::SaeJ670));
        }
        if has("iso8855") || (has("iso") && has("8855")) {
            return Declared::whole(Axes::of(FrameConvention::Iso8855));
        }
        let mut declared = Declared::default();
        for (axis, letter) in ["x", "y", "z"].iter().enumerate() {
            let Some(at) = words.iter().position(|word| word == letter) else {
                continue;
            };
            // Reads phrases such as "x points forward" and "x is positive rearward".
            let behind = words[at + 1..].iter().take(3);
            let before_next = behind.take_while(|word| !["x", "y", "z"].contains(&word.as_str()));
            let mut flipped = false;
            for word in before_next {
                flipped |= ["negative", "neg", "minus"].contains(&word.as_str());
                if let Some(way) = Way::of(word) {
                    let way = if flipped { way.opposite() } else { way };
                    declared.0[axis] = Coordinate::Grows(way);
                    break;
                }
            }
        }
        // Text about another subject may also contain words such as "x" and "up". So only a statement of all three axes is
        // accepted.
        match declared.axes() {
            Some(_) => declared,
            None => Declared::default(),
        }
    }
}

/// Converts a reading to directions of the axes, for a wheel of this side. A reading states which coordinates run along, across and
/// upright, each with its sign towards forward, outboard or up.
pub(super) fn of_reading(reading: &crate::report::Reading, side: Side) -> Axes {
    let mut ways = [Way::Forward; 3];
    let (along, forward) = reading.forward;
    let (across, outboard) = reading.outboard;
    let (upright, up) = reading.up;
    ways[along] = Way::along(0, forward);
    ways[across] = Way::along(1, outboard * side.sign());
    ways[upright] = Way::along(2, up);
    Axes(ways)
}

/// Converts directions of the axes to a reading, for a wheel of this side. It is the inverse of [`of_reading`].
pub(super) fn reading_of(axes: Axes, side: Side) -> crate::report::Reading {
    let at = |axis: usize| {
        let column = axes.0.iter().position(|way| way.axis() == axis);
        let column = column.expect("expected three different axes");
        (column, axes.0[column].sign())
    };
    let (across, left) = at(1);
    crate::report::Reading {
        forward: at(0),
        outboard: (across, left * side.sign()),
        up: at(2),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hands_are_told_apart() {
        for convention in FrameConvention::ALL {
            let axes = Axes::of(convention);
            assert!(axes.is_right_handed());
            assert_eq!(axes.convention(), Some(convention));
        }
        for (text, right_handed) in [
            ("left,forward,up", false),
            ("right,forward,up", true),
            ("forward,up,right", true),
            ("forward,up,left", false),
            ("rearward,left,up", false),
        ] {
            assert_eq!(
                Axes::parse(text).unwrap().is_right_handed(),
                right_handed,
                "{text}"
            );
        }
        for wrong in ["", "left,right,up", "left,forward", "left,forward,in"] {
            assert!(Axes::parse(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn lines_of_text_say_axes() {
        let axes = |text: &str| Declared::in_text(text).axes().map(|axes| axes.to_string());
        assert_eq!(axes("SAE axes").as_deref(), Some("forward,right,down"));
        assert_eq!(
            axes("x points rearward, y is positive right, z up").as_deref(),
            Some("rearward,right,up")
        );
        for text in [
            "origin at the front, x and y in mm",
            "Formula SAE 2026, front",
        ] {
            assert_eq!(axes(text), None, "{text}");
        }
    }
}
