//! Named rows of a file: the result of every format's reader, and the input of all later steps.

use super::adams_bushings::AdamsBushing;
use super::axes::Declared;
use super::refusal::{Question, Refusal};
use super::roles;
use crate::model::{AxlePosition, LengthUnit, Side, Topology};

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

    /// Returns true if there are no marks.
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
    /// Wheel and axle, where the file says so beside the name.
    pub marks: Marks,
    /// True if the point gives the left wheel and, mirrored, the right one.
    pub mirrored: bool,
    /// Coordinates, or their fault.
    pub position: Result<[f64; 3], String>,
    /// The body that carries it, if the file gives one.
    pub body: Option<String>,
    /// Place in the file.
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
    /// Wheel and axle, where the file says so beside the name.
    pub marks: Marks,
    /// Remarks beside it.
    pub remark: String,
    /// Place in the file.
    pub place: String,
}

/// Kind of an axle's suspension, as the file states it.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Kind {
    /// A topology, by its name in studies.
    Topology(&'static str),
    /// A topology whose points the file leaves open, with the reason. Names of `--map` settle it.
    Unclear(&'static str, String),
    /// No topology of this program, and the nearest one.
    Other(String),
}

/// A spring of an axle, in newtons and the unit of the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SpringFigures {
    /// Rate along the spring.
    pub rate: f64,
    /// Force in the position of the file.
    pub force: f64,
}

/// Figures of an axle that the study of a car needs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct AxleFigures {
    /// The spring, if the file has its rate and its force.
    pub spring: Option<SpringFigures>,
    /// Mass of both wheels with their carriers, kg.
    pub unsprung_mass: Option<f64>,
}

/// A mass with its centre of gravity, kg and the unit of the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Mass {
    /// True for the sprung mass, false for the mass of the whole car.
    pub is_sprung: bool,
    /// The mass.
    pub mass: f64,
    /// The centre of gravity, in the axes of the file.
    pub cg: [f64; 3],
}

/// Figures of a car with two axles.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct CarFigures {
    /// Place of the rear axle's origin in the axes of the front axle's points, if the file shows it.
    pub rear_offset: Option<[f64; 3]>,
    /// The mass, if the file or one beside it has it.
    pub mass: Option<Mass>,
    /// Figures of the front and the rear axle.
    pub axles: [AxleFigures; 2],
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
    /// Figures of the car, if the file describes one.
    pub(super) car: Option<CarFigures>,
    /// Bushings of an Adams/Car subsystem.
    pub(super) bushings: Vec<AdamsBushing>,
    /// Notes for the user on the reading.
    pub(super) notes: Vec<String>,
    /// Parts that are not used, with the reason.
    pub(super) left_out: Vec<String>,
}

impl PointTable {
    /// The topology that the file states for an axle.
    ///
    /// # Errors
    /// The file states none, or one for each axle and no axle is chosen.
    pub fn topology(&self, axle: Option<AxlePosition>) -> Result<&'static Topology, Refusal> {
        let of_axle = |of: &Option<AxlePosition>| of.is_none() || axle.is_none() || *of == axle;
        let kinds: Vec<&Kind> = self
            .kinds
            .iter()
            .filter(|(of, _)| of_axle(of))
            .map(|(_, kind)| kind)
            .collect();
        match kinds.as_slice() {
            [Kind::Topology(name) | Kind::Unclear(name, _)] => {
                Ok(Topology::named(name).expect("readers name topologies that are there"))
            }
            [Kind::Other(reason)] => Err(Refusal::Wrong(reason.clone())),
            [] => Err(Refusal::Wrong(
                "the file does not say the kind of its suspension: give --topology, as in --topology double_wishbone \
                 (`hardpoint new --help` lists all)"
                    .to_owned(),
            )),
            _ => Err(Question::of(
                "the file has a front and a rear axle, and a study describes one (--car --out DIR makes a car of both)"
                    .to_owned(),
                "--axle",
                &["front", "rear"],
            )),
        }
    }

    /// Returns true if the file has points of both axles.
    pub fn has_two_axles(&self) -> bool {
        let kinds = self.kinds.iter().map(|(axle, _)| Marks {
            side: None,
            axle: *axle,
        });
        let letters = roles::Letters::of_points(&self.points);
        let of_names = self.points.iter().map(|point| {
            let named = roles::marks(&point.read_as, letters);
            point.marks.or(named)
        });
        roles::axles(kinds.chain(of_names)).len() == 2
    }
}
