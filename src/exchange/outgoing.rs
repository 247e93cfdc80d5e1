//! Wheels of a study for an export: points in the unit and the axes of the receiving tool.

use super::rounding::Rounded;
use crate::model::{Axis, Frame, FrameConvention, LengthUnit, PointId, Side, SpinAxis, Suspension};
use crate::number::Vector3;
use crate::study::Study;
use toml_edit::Document;

/// A study in the unit and the axes of the file to be written.
#[derive(Clone, Debug)]
pub struct Outgoing<'s> {
    /// Study at the design to be written.
    pub study: &'s Study,
    /// Unit of length of the file.
    pub unit: LengthUnit,
    /// Axes of the file.
    pub convention: FrameConvention,
    /// Points of the study's wheel (for an axle, the left one), in the kernel's frame (x forward, y outboard, z up) and the
    /// file's unit.
    own: Vec<Vector3<f64>>,
    /// Points of a right wheel that is not the mirror image, in the kernel's frame (x forward, y outboard, z up) and the file's
    /// unit.
    right: Option<Vec<Vector3<f64>>>,
}

impl<'s> Outgoing<'s> {
    /// Prepares a study for a file with this unit and these axes, by default those of the study. If the unit does not
    /// change, the coordinates keep their exact values.
    pub fn of(
        study: &'s Study,
        unit: Option<LengthUnit>,
        convention: Option<FrameConvention>,
    ) -> Self {
        let suspension = study.wheel();
        let unit = unit.unwrap_or(suspension.length_unit);
        let converted = |wheel: &Suspension| {
            let length = |x: f64| unit.convert_decimal(x, wheel.length_unit);
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

    /// Prepares a study with the rounded coordinates of its wheel, which are exact in the unit of the grid. The right wheel of an
    /// axle with its own points is not rounded. `unit` and `convention` are the unit and
    /// the axes of the file, as in [`Outgoing::of`].
    pub fn rounded(
        study: &'s Study,
        rounded: &Rounded,
        unit: Option<LengthUnit>,
        convention: Option<FrameConvention>,
    ) -> Self {
        let mut outgoing = Outgoing::of(study, unit, convention);
        let (frame, unit) = (study.wheel().frame, outgoing.unit);
        let length = |x: f64| unit.convert_decimal(x, rounded.grid.unit);
        let points = rounded.coordinates.iter();
        let points = points.map(|p| frame.vector(Vector3::from(*p).map(length)));
        outgoing.own = points.collect();
        outgoing
    }

    /// Copy in other axes.
    pub fn in_convention(&self, convention: FrameConvention) -> Self {
        Outgoing {
            convention,
            ..self.clone()
        }
    }

    /// Converts a length of the study to the file's unit.
    pub fn length(&self, length: f64) -> f64 {
        self.unit
            .convert_decimal(length, self.study.wheel().length_unit)
    }

    /// Axes of the file as seen from a left or a right wheel.
    pub fn frame(&self, side: Side) -> Frame {
        Frame::new(self.convention, side)
    }

    /// Wheels whose points or angles the file must list separately. There is one, or two if the right wheel of an axle has its own
    /// points or angles. A solid axle or a twist beam counts as one, because its mechanism has the points of both halves.
    pub fn different_wheels(&self) -> Vec<Side> {
        let is_rigid = self.study.wheel().mechanism.rigid_axle.is_some();
        match &self.right {
            Some(_) if !is_rigid => Side::ALL.to_vec(),
            _ => vec![self.study.wheel().frame.meaning().1],
        }
    }

    /// All wheels of the study: one, or both of an axle.
    pub fn wheels(&self) -> Vec<Side> {
        match self.study.axle() {
            Some(_) => Side::ALL.to_vec(),
            None => self.different_wheels(),
        }
    }

    /// Suspension of the wheel on this side.
    pub fn suspension(&self, side: Side) -> &'s Suspension {
        match self.study.axle() {
            Some(both) => both.axle.suspension(side),
            None => self.study.wheel(),
        }
    }

    /// Point of a wheel, in the kernel's frame (x forward, y outboard, z up) and the file's unit.
    pub fn place(&self, side: Side, id: PointId) -> Vector3<f64> {
        match (side, &self.right) {
            (Side::Right, Some(right)) => right[id.0],
            _ => self.own[id.0],
        }
    }

    /// Coordinates of a point in the file.
    pub fn position(&self, side: Side, id: PointId) -> [f64; 3] {
        self.in_axes(side, self.place(side, id))
    }

    /// Converts a position or direction from the kernel's frame (x forward, y outboard, z up) to the axes of the file. `side`
    /// is the side of the wheel.
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

    /// Name of the body that carries a point, if a study can choose this body. Otherwise `None`.
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

    /// Spin axis of a wheel in the design position: unit vector that points outboard, in the kernel's frame (x forward, y
    /// outboard, z up).
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

    /// Static camber and toe in degrees, toe-in positive. They come from the study's text, or else from the spin axis.
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

    /// Camber and toe in the study's text, in degrees. A missing angle equals the angle of the left wheel, or 0. `None` if the text
    /// has no section for the wheel.
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
