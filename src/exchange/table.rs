//! Named rows of a file: what every reader of a format makes, and all that comes after it takes.

use super::axes::Declared;
use crate::model::{AxlePosition, LengthUnit, Side};

/// The wheel or axle that a part of a file is about, as far as the file says so.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Marks {
    pub side: Option<Side>,
    pub axle: Option<AxlePosition>,
}

impl Marks {
    /// These marks, and those of another part where these say nothing.
    pub(super) fn or(self, other: Marks) -> Marks {
        Marks {
            side: self.side.or(other.side),
            axle: self.axle.or(other.axle),
        }
    }

    /// Whether nothing is said.
    pub(super) fn is_empty(self) -> bool {
        self == Marks::default()
    }
}

/// A named point of a file, in the file's axes and unit.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct NamedPoint {
    /// Its name as it stands there, the keys on the way to it included.
    pub name: String,
    /// The part of the name that says which hardpoint it is.
    pub read_as: String,
    /// Its wheel and axle, where the file says so beside the name.
    pub marks: Marks,
    /// Whether it stands for the left wheel, and mirrored for the right one.
    pub mirrored: bool,
    /// Its coordinates, or what is wrong with them.
    pub position: Result<[f64; 3], String>,
    /// The body it sits on, where the file says so.
    pub body: Option<String>,
    /// Its place in the file.
    pub place: String,
}

/// A single number with a name.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Figure {
    /// Its name as it stands there.
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
    /// None of ours, and what comes nearest.
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
    /// The axes, as far as the file says so.
    pub(super) declared: Declared,
    /// The kind of suspension of each axle, where the file says so; without an axle, of all.
    pub(super) kinds: Vec<(Option<AxlePosition>, Kind)>,
    /// Notes for the user on the reading.
    pub(super) notes: Vec<String>,
    /// Parts that are not used, with the reason.
    pub(super) left_out: Vec<String>,
}
