//! Table of the named rows of a file. The code for each format makes this table, and all later steps use it.

use super::adams_bushings::AdamsBushing;
use super::angle_unit::AngleUnit;
use super::axes::{Axes, Declared};
use super::figure_names::figure;
use super::notes::Notes;
use super::refusal::{Question, Refusal};
use super::roles;
use super::unit::FileUnit;
use crate::model::{AxlePosition, FrameConvention, LengthUnit, Side, Topology};

/// Wheel and axle to which a part of a file belongs, if the file states them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Marks {
    pub side: Option<Side>,
    pub axle: Option<AxlePosition>,
}

impl Marks {
    /// Takes the side or the axle from `other` if it is missing in these marks.
    pub(super) fn or(self, other: Marks) -> Marks {
        Marks {
            side: self.side.or(other.side),
            axle: self.axle.or(other.axle),
        }
    }

    /// True if neither the wheel nor the axle is known.
    pub(super) fn is_empty(self) -> bool {
        self == Marks::default()
    }
}

/// Wheel and axle of a point, as its row or its entries state them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct StatedMarks {
    pub marks: Marks,
    /// True if the point applies to the left wheel and, mirrored, to the right wheel.
    pub mirrored: bool,
}

impl StatedMarks {
    /// Adds the wheel and the axle that another cell or entry of the same point states.
    pub(super) fn add(&mut self, other: StatedMarks) {
        self.marks = self.marks.or(other.marks);
        self.mirrored |= other.mirrored;
    }
}

/// A named point of a file, in the axes and unit of the file.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct NamedPoint {
    /// Name of the point in the file, including the keys that lead to the point.
    pub name: String,
    /// Part of the name that the importer interprets.
    pub read_as: String,
    /// Wheel and axle, if the file gives them with the name.
    pub marks: Marks,
    /// True if the point applies to the left wheel and, mirrored, to the right wheel.
    pub mirrored: bool,
    /// True if at least one coordinate has a digit. A row of texts without digits is not a point.
    pub has_number: bool,
    /// Coordinates, or the reason why they cannot be read.
    pub position: Result<[f64; 3], String>,
    /// Body that carries the point, if the file gives one.
    pub body: Option<String>,
    /// Location of the point in the file.
    pub place: String,
}

/// A single number with a name.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Figure {
    /// Name of the number in the file.
    pub name: String,
    /// Part of this name that the importer interprets.
    pub read_as: String,
    /// Value of the number.
    pub value: f64,
    /// Wheel and axle of the number, if the file gives them with the name.
    pub marks: Marks,
    /// Remark in the file after the number.
    pub remark: String,
    /// Location of the number in the file.
    pub place: String,
}

/// Kind of an axle's suspension, as the file states it.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Kind {
    /// Name of a topology in studies.
    Topology(&'static str),
    /// A topology whose points the file does not identify, with the reason. Names in `--map` can identify them.
    Unclear(&'static str, String),
    /// A kind that is not a topology of this program, with a message that names the nearest topology.
    Other(String),
}

/// Spring of an axle, in newtons and the unit of the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SpringFigures {
    /// Rate along the spring's axis, in newtons per unit of the file.
    pub rate: f64,
    /// Spring force in the position of the file, in newtons.
    pub force: f64,
}

/// Values of an axle that the study of a car needs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct AxleFigures {
    /// Spring, if the file has its rate and its force.
    pub spring: Option<SpringFigures>,
    /// Mass of both wheels with their carriers, in kg.
    pub unsprung_mass: Option<f64>,
}

/// A mass with its centre of gravity, in kg and the unit of the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Mass {
    /// True for the sprung mass, false for the mass of the whole car.
    pub is_sprung: bool,
    /// Mass in kg.
    pub mass: f64,
    /// Centre of gravity in the axes of the file.
    pub cg: [f64; 3],
}

/// Values of a car with two axles.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct CarFigures {
    /// Position of the rear axle's origin in the axes of the front axle's points, if the file gives both. `None` otherwise.
    pub rear_offset: Option<[f64; 3]>,
    /// Mass of the car or of its sprung part, if this file or an accompanying file has it.
    pub mass: Option<Mass>,
    /// Values of the front and the rear axle.
    pub axles: [AxleFigures; 2],
}

/// Points and further content of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointTable {
    /// Points in the order of the file.
    pub(super) points: Vec<NamedPoint>,
    /// Single numbers with names, such as the track or the camber.
    pub(super) figures: Vec<Figure>,
    /// Unit of length, if the file states it.
    pub(super) unit: Option<FileUnit>,
    /// True if the format prescribes the unit, so that `--unit` cannot replace it.
    pub(super) has_fixed_unit: bool,
    /// Unit that applies to angles without their own unit, if the file states it.
    pub(super) angle_unit: Option<AngleUnit>,
    /// Statement of a unit that is not known, with its location in the file.
    pub(super) unknown_unit: Option<String>,
    /// Axes, if the file states them.
    pub(super) declared: Declared,
    /// Kind of suspension of each axle, if the file states it. A kind without an axle applies to all axles.
    pub(super) kinds: Vec<(Option<AxlePosition>, Kind)>,
    /// Values of the axle, if the file describes a single axle.
    pub(super) axle: AxleFigures,
    /// Values of the car, if the file describes a car.
    pub(super) car: Option<CarFigures>,
    /// Bushings of an Adams/Car subsystem.
    pub(super) bushings: Vec<AdamsBushing>,
    /// Notes for the user about the file.
    pub(super) notes: Notes,
    /// Unused parts of the file, with the reasons.
    pub(super) left_out: Vec<String>,
}

impl PointTable {
    /// Empty table of a format that prescribes metres and the axes of ISO 8855.
    pub(super) fn in_metres() -> Self {
        PointTable {
            unit: Some(FileUnit::of(LengthUnit::Metre)),
            has_fixed_unit: true,
            declared: Declared::whole(Axes::of(FrameConvention::Iso8855)),
            ..PointTable::default()
        }
    }

    /// Stores the unit of lengths that the file states at `place`.
    ///
    /// # Errors
    /// The file stated another unit before.
    pub(super) fn state_unit(&mut self, unit: FileUnit, place: &str) -> Result<(), String> {
        if self.unit.is_some_and(|known| known != unit) {
            return Err(format!(
                "{place}: the unit {} differs from the unit above",
                unit.symbol
            ));
        }
        self.unit = Some(unit);
        Ok(())
    }

    /// Stores the axes that the file states at `place`.
    ///
    /// # Errors
    /// The file stated other axes before.
    pub(super) fn declare(&mut self, declared: Declared, place: &str) -> Result<(), String> {
        self.declared = self.declared.and(declared, place)?;
        Ok(())
    }

    /// Topology that the file states for an axle.
    ///
    /// # Errors
    /// The file states no topology, or a kind of suspension that is not a topology of this program. Or it states one for each axle,
    /// and no axle is chosen.
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
                Ok(Topology::named(name).expect("readers use names of existing topologies"))
            }
            [Kind::Other(reason)] => Err(Refusal::Wrong(reason.clone())),
            [] => Err(Refusal::Wrong(
                "the file does not state the kind of its suspension: give --topology, as in \
                 --topology double_wishbone (`hardpoint new --help` lists all)"
                    .to_owned(),
            )),
            _ => Err(Question::of(
                "the file has a front and a rear axle, but a study describes only one (--car --out DIR imports both as a car)"
                    .to_owned(),
                "--axle",
                &["front", "rear"],
            )),
        }
    }

    /// Adds the sheet of an axle to the table of a car. `place` names the sheet.
    ///
    /// # Errors
    /// The sheet states another unit or other axes than the sheet before it.
    pub(super) fn add_axle(
        &mut self,
        sheet: PointTable,
        axle: AxlePosition,
        place: &str,
    ) -> Result<(), String> {
        let units = self.unit.zip(sheet.unit);
        let angle_units = self.angle_unit.zip(sheet.angle_unit);
        if units.is_some_and(|(a, b)| a != b) || angle_units.is_some_and(|(a, b)| a != b) {
            return Err(format!(
                "{place}: its units differ from the units of the other axle"
            ));
        }
        self.unit = self.unit.or(sheet.unit);
        self.angle_unit = self.angle_unit.or(sheet.angle_unit);
        self.unknown_unit = self.unknown_unit.take().or(sheet.unknown_unit);
        self.declare(sheet.declared, place)?;
        self.points
            .extend(sheet.points.into_iter().map(|mut point| {
                point.marks.axle = Some(axle);
                point
            }));
        self.figures
            .extend(sheet.figures.into_iter().map(|mut figure| {
                figure.marks.axle = Some(axle);
                figure
            }));
        self.notes.add(&sheet.notes);
        self.left_out.extend(sheet.left_out);
        Ok(())
    }

    /// True if the file has points of both axles.
    pub fn has_two_axles(&self) -> bool {
        self.axles().len() == 2
    }

    /// Spring and unsprung mass of one axle, for the study of an axle or of a car.
    pub(super) fn figures_of(&self, axle: Option<AxlePosition>) -> AxleFigures {
        match (&self.car, axle) {
            (Some(car), Some(AxlePosition::Front)) => car.axles[0],
            (Some(car), Some(AxlePosition::Rear)) => car.axles[1],
            _ => self.axle,
        }
    }

    /// True if the file has points or values that it assigns to a right wheel.
    pub(super) fn has_right_wheel(&self) -> bool {
        let of_points = self.marks_of_points().map(|marks| marks.side);
        let of_figures = self.figures.iter().map(|row| {
            let named = figure(&row.read_as).and_then(|(_, marks, _)| marks.side);
            row.marks.side.or(named)
        });
        of_points
            .chain(of_figures)
            .any(|side| side == Some(Side::Right))
    }

    /// Axles that the kinds of suspension and the points state.
    pub(super) fn axles(&self) -> Vec<AxlePosition> {
        let kinds = self.kinds.iter().map(|(axle, _)| Marks {
            side: None,
            axle: *axle,
        });
        roles::axles(kinds.chain(self.marks_of_points()))
    }

    /// Wheel and axle of each point: those that the file states, otherwise those in its name.
    fn marks_of_points(&self) -> impl Iterator<Item = Marks> {
        let letters = roles::Letters::of_points(&self.points);
        self.points.iter().map(move |point| {
            let named = roles::marks(&point.read_as, letters);
            point.marks.or(named)
        })
    }
}
