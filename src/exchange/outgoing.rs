//! Wheels of a study for an export: points in the unit and the axes of the receiver.

use super::rounding::Rounded;
use crate::model::{Axis, Frame, FrameConvention, LengthUnit, PointId, Side, SpinAxis, Suspension};
use crate::number::Vector3;
use crate::study::Study;
use toml_edit::Document;

/// A study in the unit and the axes in which a file is written.
#[derive(Clone, Debug)]
pub struct Outgoing<'s> {
    /// The study, at the design that is written.
    pub study: &'s Study,
    /// Unit of the file.
    pub unit: LengthUnit,
    /// Axes of the file.
    pub convention: FrameConvention,
    /// Points of the study's own wheel in the kernel's frame, in the file's unit.
    own: Vec<Vector3<f64>>,
    /// Points of a right wheel that is not the mirror image, likewise.
    right: Option<Vec<Vector3<f64>>>,
}

impl<'s> Outgoing<'s> {
    /// Study in a unit and axes, by default its own. A coordinate keeps its bits if the unit stays.
    pub fn of(
        study: &'s Study,
        unit: Option<LengthUnit>,
        convention: Option<FrameConvention>,
    ) -> Self {
        let suspension = study.wheel();
        let unit = unit.unwrap_or(suspension.length_unit);
        let converted = |wheel: &Suspension| {
            let length = |x: f64| unit.convert(x, wheel.length_unit);
            wheel.design.iter().map(|p| p.map(length)).collect()
        };
        let right = study.axle().and_then(|a| a.axle.right.as_ref());
        Outgoing {
            study,
            unit,
            convention: convention.unwrap_or(suspension.frame.meaning().0),
            own: converted(suspension),
            right: right.map(converted),
        }
    }

    /// Study with the rounded coordinates, exact in the unit of the grid.
    pub fn rounded(
        study: &'s Study,
        rounded: &Rounded,
        convention: Option<FrameConvention>,
    ) -> Self {
        let mut outgoing = Outgoing::of(study, Some(rounded.grid.unit), convention);
        let frame = study.wheel().frame;
        let points = rounded.coordinates.iter();
        outgoing.own = points.map(|p| frame.vector(Vector3::from(*p))).collect();
        outgoing
    }

    /// The same in other axes.
    pub fn in_convention(&self, convention: FrameConvention) -> Self {
        Outgoing {
            convention,
            ..self.clone()
        }
    }

    /// A length of the study in the file's unit.
    pub fn length(&self, length: f64) -> f64 {
        self.unit.convert(length, self.study.wheel().length_unit)
    }

    /// The axes of the file, seen from the wheel of a side.
    pub fn frame(&self, side: Side) -> Frame {
        Frame::new(self.convention, side)
    }

    /// The wheels that differ: one, unless the right wheel of an axle has points or angles of its own.
    pub fn different_wheels(&self) -> Vec<Side> {
        match &self.right {
            Some(_) => Side::ALL.to_vec(),
            None => vec![self.study.wheel().frame.meaning().1],
        }
    }

    /// All wheels of the study: one, or both of an axle.
    pub fn wheels(&self) -> Vec<Side> {
        match self.study.axle() {
            Some(_) => Side::ALL.to_vec(),
            None => self.different_wheels(),
        }
    }

    /// The suspension of a wheel.
    pub fn suspension(&self, side: Side) -> &'s Suspension {
        match self.study.axle() {
            Some(both) => both.axle.suspension(side),
            None => self.study.wheel(),
        }
    }

    /// A point of a wheel in the kernel's frame, in the file's unit.
    pub fn place(&self, side: Side, id: PointId) -> Vector3<f64> {
        match (side, &self.right) {
            (Side::Right, Some(right)) => right[id.0],
            _ => self.own[id.0],
        }
    }

    /// Coordinates of a point as the file has them.
    pub fn position(&self, side: Side, id: PointId) -> [f64; 3] {
        self.in_axes(side, self.place(side, id))
    }

    /// Position or direction of the kernel's frame of a side, in the axes of the file.
    pub fn in_axes(&self, side: Side, place: Vector3<f64>) -> [f64; 3] {
        self.frame(side).vector(place).to_array().map(|x| x + 0.0)
    }

    /// Names and coordinates of all points of a wheel.
    pub fn points(&self, side: Side) -> impl Iterator<Item = (&'s str, PointId, [f64; 3])> + '_ {
        let points = self.suspension(side).mechanism.points.iter().enumerate();
        points.map(move |(number, point)| {
            let id = PointId(number);
            (point.name.as_str(), id, self.position(side, id))
        })
    }

    /// The body that a point is mounted on, where the study may choose it.
    pub fn body(&self, side: Side, id: PointId) -> Option<&'static str> {
        let mechanism = &self.suspension(side).mechanism;
        let is_extra = mechanism.topology.hardpoint(mechanism.name(id)).is_none();
        if !is_extra && mechanism.possible_bodies(id).is_empty() {
            return None;
        }
        let mut bodies = mechanism.bodies.iter();
        let found = bodies.find(|(_, body)| *body == mechanism.body(id));
        found.map(|(name, _)| *name)
    }

    /// The spin axis of a wheel in the design position: outboard, in the kernel's frame, of length 1.
    pub fn spin_axis(&self, side: Side) -> Vector3<f64> {
        let suspension = self.suspension(side);
        match suspension.mechanism.spin_axis {
            SpinAxis::Along(direction) => direction,
            SpinAxis::From(inner) => {
                let along =
                    self.place(side, suspension.mechanism.wheel_centre) - self.place(side, inner);
                along.normalised()
            }
        }
    }

    /// Static camber and toe in degrees, toe-in positive: from the study's text, or of the spin axis.
    pub fn static_angles(&self, side: Side) -> [f64; 2] {
        let suspension = self.suspension(side);
        let written = match suspension.mechanism.spin_axis {
            SpinAxis::Along(_) => self.written_angles(side),
            SpinAxis::From(_) => None,
        };
        written.unwrap_or_else(|| {
            let axis = self.spin_axis(side);
            let camber = -axis[Axis::Z].asin();
            [camber, axis[Axis::X].atan2(axis[Axis::Y])].map(f64::to_degrees)
        })
    }

    /// Angles in the study's text; a missing angle is 0, or that of the left wheel.
    fn written_angles(&self, side: Side) -> Option<[f64; 2]> {
        let document = Document::parse(self.study.text.as_str()).ok()?;
        let wheel = document.get("wheel");
        let own = document.get("axle").and_then(|axle| axle.get("right"));
        let own = own.and_then(|right| right.get("wheel"));
        let own = own.filter(|_| side == Side::Right && self.right.is_some());
        wheel.or(own)?;
        let angle = |key: &str| {
            let item = own.and_then(|own| own.get(key));
            let item = item.or(wheel.and_then(|wheel| wheel.get(key)));
            let number = item.and_then(|i| i.as_float().or(i.as_integer().map(|n| n as f64)));
            number.unwrap_or(0.0)
        };
        Some([angle("static_camber"), angle("static_toe")])
    }
}
