//! Named rows of a file: the result of every format's reader, and the input of all later steps.

use super::axes::Declared;
use crate::model::{AxlePosition, LengthUnit, Side};

/// Wheel or axle of a part of a file, if the file states it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Marks {
    pub side: Option<Side>,
    pub axle: Option<AxlePosition>,
}

impl Marks {
    /// These marks, completed by those of another part.
    pub(super) fn or(self, other: Marks) -> Marks {
        Marks {
            side: self.side.or(other.side),
            axle: self.axle.or(other.axle),
        }
    }

    /// Whether there are no marks.
    pub(super) fn is_empty(self) -> bool {
        self == Marks::default()
    }
}

/// A named point of a file, in the file's axes and unit.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct NamedPoint {
    /// Name as written, including the keys that lead to it.
    pub name: String,
    /// Part of the name with its meaning.
    pub read_as: String,
    /// Its wheel and axle, where the file says so beside the name.
    pub marks: Marks,
    /// Whether it gives the left wheel and, mirrored, the right one.
    pub mirrored: bool,
    /// Coordinates, or their fault.
    pub position: Result<[f64; 3], String>,
    /// The body it sits on, where the file says so.
    pub body: Option<String>,
    /// Its place in the file.
    pub place: String,
}

/// A single number with a name.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Figure {
    /// Name as written.
    pub name: String,
    /// The part of the name that says what it is.
    pub read_as: String,
    /// The number.
    pub value: f64,
    /// Its wheel and axle, where the file says so beside the name.
    pub marks: Marks,
    /// Remarks beside it.
    pub remark: String,
    /// Its place in the file.
    pub place: String,
}

/// Kind of an axle's suspension, as the file states it.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Kind {
    /// A topology, by its name in studies.
    Topology(&'static str),
    /// No topology of this program, and the nearest one.
    Other(String),
}

/// The points of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointTable {
    /// The points, in the order of the file.
    pub(super) points: Vec<NamedPoint>,
    /// Single numbers with names.
    pub(super) figures: Vec<Figure>,
    /// The unit of length, where the file says so.
    pub(super) unit: Option<LengthUnit>,
    /// Axes, if the file states them.
    pub(super) declared: Declared,
    /// Kind of suspension of each axle, if the file states it; without an axle, of all axles.
    pub(super) kinds: Vec<(Option<AxlePosition>, Kind)>,
    /// Notes for the user on the reading.
    pub(super) notes: Vec<String>,
    /// Parts that are not used, with the reason.
    pub(super) left_out: Vec<String>,
}
