//! Builder of suspensions from numbers.

use super::validation::{GeometryFault, HardpointFault};
use crate::model::{
    Frame, FrameConvention, LengthUnit, Side, SpinAxis, Suspension, Topology, VehicleFigures,
};
use crate::number::Vector3;
use hardpoint_study_file::names::nearest;
use thiserror::Error;

/// Reason why a suspension cannot be built.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum BuildError {
    /// No topology has this name.
    #[error("there is no topology {0:?}; {hint}", hint = topologies(.0))]
    UnknownTopology(String),
    /// A hardpoint is unknown or missing.
    #[error("{0}{hint}", hint = meant(.0))]
    Hardpoint(HardpointFault),
    /// A hardpoint is given twice.
    #[error("{0} is given twice")]
    GivenTwice(String),
    /// A number is not finite, or is outside its allowed range.
    #[error("{what} is {value}; expected {expected}")]
    Number {
        /// Name of the number.
        what: String,
        /// Value of the number.
        value: f64,
        /// Expected range, in words.
        expected: &'static str,
    },
    /// The builder received neither `spindle_inner` nor static camber and toe, or it received all of them.
    #[error(
        "the direction of the wheel needs either the hardpoint spindle_inner, or static camber and toe"
    )]
    SpinAxis,
    /// In this topology one body carries both wheels, so the topology does not describe the suspension of one wheel.
    #[error("{0} carries both wheels; expected a topology of one wheel, or a study")]
    BothWheels(&'static str),
    /// The hardpoints do not form a suspension.
    #[error(transparent)]
    Geometry(Box<GeometryFault>),
    /// The design position cannot be solved.
    #[error("{0}")]
    Design(String),
}

/// Suggests the topology that was probably meant, and lists all topologies.
fn topologies(name: &str) -> String {
    let names = || Topology::ALL.iter().map(|topology| topology.name);
    let all = names().collect::<Vec<_>>().join(", ");
    match nearest(name, names()) {
        Some(near) => format!("did you mean {near:?}? There are {all}"),
        None => format!("there are {all}"),
    }
}

/// Suggests the hardpoint that was probably meant by an unknown name, or lists all hardpoints. Empty for all other faults.
fn meant(fault: &HardpointFault) -> String {
    let HardpointFault::Unknown { topology, name } = fault else {
        return String::new();
    };
    let hardpoints = Topology::named(topology).into_iter();
    let names: Vec<_> = hardpoints
        .flat_map(|topology| topology.all_hardpoints())
        .map(|hardpoint| hardpoint.name)
        .collect();
    match nearest(name, names.iter().copied()) {
        Some(near) => format!("; did you mean {near:?}?"),
        None => format!("; there are {}", names.join(", ")),
    }
}

/// A suspension under construction from hardpoints with names. Their coordinates are in the axes and the unit of the
/// caller.
///
/// ```
/// # extern crate hardpoint_engine as hardpoint;
/// use hardpoint::{Suspension, Side};
///
/// let suspension = Suspension::builder("semi_trailing_arm")
///     .side(Side::Left)
///     .hardpoint("arm_pivot_inner", [420.0, 240.0, 330.0])
///     .hardpoint("arm_pivot_outer", [350.0, 610.0, 310.0])
///     .hardpoint("wheel_centre", [0.0, 730.0, 300.0])
///     .static_angles_deg(-1.0, 0.1)
///     .wheel_radius(300.0)
///     .build()?;
/// assert!(suspension.size() > 400.0);
///
/// // The error names the fault.
/// let error = Suspension::builder("semi_trailing_arm").build().unwrap_err();
/// assert!(error.to_string().starts_with("missing for semi_trailing_arm: arm_pivot_inner"));
/// # Ok::<(), hardpoint::BuildError>(())
/// ```
#[derive(Clone, Debug)]
pub struct SuspensionBuilder {
    topology: String,
    side: Side,
    convention: FrameConvention,
    length_unit: LengthUnit,
    hardpoints: Vec<(String, [f64; 3])>,
    static_angles: Option<[f64; 2]>,
    wheel_radius: Option<f64>,
    tyre_width: Option<f64>,
    rim_diameter: Option<f64>,
    vehicle: VehicleFigures,
}

impl Suspension {
    /// Starts a suspension of a topology. [`Topology::ALL`] lists the topologies with their names and hardpoints. The defaults
    /// are a left wheel, ISO 8855 axes and millimetres.
    pub fn builder(topology: &str) -> SuspensionBuilder {
        SuspensionBuilder {
            topology: topology.to_owned(),
            side: Side::Left,
            convention: FrameConvention::Iso8855,
            length_unit: LengthUnit::Millimetre,
            hardpoints: Vec::new(),
            static_angles: None,
            wheel_radius: None,
            tyre_width: None,
            rim_diameter: None,
            vehicle: VehicleFigures::default(),
        }
    }
}

impl SuspensionBuilder {
    /// Sets the side of the car.
    pub fn side(mut self, side: Side) -> Self {
        self.side = side;
        self
    }

    /// Sets the axes of all coordinates.
    pub fn frame(mut self, convention: FrameConvention) -> Self {
        self.convention = convention;
        self
    }

    /// Sets the unit of all lengths.
    pub fn length_unit(mut self, unit: LengthUnit) -> Self {
        self.length_unit = unit;
        self
    }

    /// Adds a hardpoint.
    pub fn hardpoint(mut self, name: &str, position: [f64; 3]) -> Self {
        self.hardpoints.push((name.to_owned(), position));
        self
    }

    /// Sets camber and toe (degrees) in the design position, in place of the hardpoint `spindle_inner`. Camber is positive
    /// with the top outboard, toe with the front inboard.
    pub fn static_angles_deg(mut self, camber: f64, toe: f64) -> Self {
        self.static_angles = Some([camber, toe]);
        self
    }

    /// Sets the loaded radius of the wheel.
    pub fn wheel_radius(mut self, radius: f64) -> Self {
        self.wheel_radius = Some(radius);
        self
    }

    /// Sets the width of the tyre, which the envelope of the tyre needs.
    pub fn tyre_width(mut self, width: f64) -> Self {
        self.tyre_width = Some(width);
        self
    }

    /// Sets the diameter of the rim edge, at which toe is measured as a length.
    pub fn rim_diameter(mut self, diameter: f64) -> Self {
        self.rim_diameter = Some(diameter);
        self
    }

    /// Sets the data of the whole vehicle.
    pub fn vehicle(mut self, vehicle: VehicleFigures) -> Self {
        self.vehicle = vehicle;
        self
    }

    /// Assembles the suspension. Its design position is not solved yet.
    pub(crate) fn assemble(self) -> Result<Suspension, BuildError> {
        let topology = Topology::named(&self.topology)
            .ok_or_else(|| BuildError::UnknownTopology(self.topology.clone()))?;
        if topology.carries_both_wheels() {
            return Err(BuildError::BothWheels(topology.name));
        }
        let given = self.given(topology)?;
        let names: Vec<&'static str> = given.iter().map(|(name, _)| *name).collect();
        if let Some(fault) = HardpointFault::missing(topology, |name| names.contains(&name)) {
            return Err(BuildError::Hardpoint(fault));
        }
        let groups = topology.groups.iter();
        let mut faults =
            groups.filter_map(|group| HardpointFault::of_group(topology, group, &names));
        if let Some(fault) = faults.next() {
            return Err(BuildError::Hardpoint(fault));
        }
        self.check_figures()?;
        let frame = Frame::new(self.convention, self.side);
        let mut mechanism = (topology.build)(topology, &names);
        mechanism.spin_axis = match (mechanism.spin_axis, self.static_angles) {
            (axis @ SpinAxis::From(_), None) => axis,
            (SpinAxis::Along(_), Some([camber, toe])) => {
                let below = "between -90 and 90 degrees";
                checked("static camber", camber, below, |a| a.abs() < 90.0)?;
                checked("static toe", toe, below, |a| a.abs() < 90.0)?;
                SpinAxis::standing(camber.to_radians(), toe.to_radians())
            }
            _ => return Err(BuildError::SpinAxis),
        };
        let position = |name: &str| given.iter().find(|(known, _)| *known == name);
        let design = mechanism.points.iter();
        let design: Vec<_> = design
            .filter_map(|point| position(&point.name))
            .map(|(_, position)| frame.vector(*position))
            .collect();
        mechanism.assume_seats();
        mechanism.seat_drop_link(&design);
        let suspension = Suspension {
            mechanism,
            design,
            frame,
            length_unit: self.length_unit,
            wheel_radius: self.wheel_radius,
            tyre_width: self.tyre_width,
            rim_diameter: self.rim_diameter,
            vehicle: self.vehicle,
        };
        match GeometryFault::first_of(&suspension) {
            Some(fault) => Err(BuildError::Geometry(Box::new(fault))),
            None => Ok(suspension),
        }
    }

    /// Returns an error for data of wheel and vehicle that are out of range, such as a negative length.
    fn check_figures(&self) -> Result<(), BuildError> {
        let vehicle = &self.vehicle;
        let lengths = [
            ("wheel_radius", self.wheel_radius),
            ("tyre_width", self.tyre_width),
            ("rim_diameter", self.rim_diameter),
            ("wheelbase", vehicle.wheelbase),
            ("track", vehicle.track),
            ("cg_height", vehicle.cg_height),
        ];
        let shares = [
            ("brake_share_front", vehicle.brake_share_front),
            ("drive_share_front", vehicle.drive_share_front),
        ];
        for (what, length) in lengths {
            let is_length = |l: f64| l.is_finite() && l > 0.0;
            checked(
                what,
                length.unwrap_or(1.0),
                "a finite number above 0",
                is_length,
            )?;
        }
        for (what, share) in shares {
            let is_share = |s: f64| (0.0..=1.0).contains(&s);
            checked(what, share.unwrap_or(1.0), "a share from 0 to 1", is_share)?;
        }
        Ok(())
    }

    /// Hardpoints in the caller's order, with the topology's names.
    fn given(
        &self,
        topology: &'static Topology,
    ) -> Result<Vec<(&'static str, Vector3<f64>)>, BuildError> {
        let mut given: Vec<(&'static str, Vector3<f64>)> = Vec::new();
        for (name, position) in &self.hardpoints {
            let Some(hardpoint) = topology.hardpoint(name) else {
                return Err(BuildError::Hardpoint(HardpointFault::Unknown {
                    topology: topology.name,
                    name: name.clone(),
                }));
            };
            if given.iter().any(|(known, _)| *known == hardpoint.name) {
                return Err(BuildError::GivenTwice(name.clone()));
            }
            for coordinate in position {
                checked(name, *coordinate, "finite coordinates", f64::is_finite)?;
            }
            given.push((hardpoint.name, Vector3::from(*position)));
        }
        Ok(given)
    }
}

fn checked(
    what: &str,
    value: f64,
    expected: &'static str,
    is_right: impl Fn(f64) -> bool,
) -> Result<(), BuildError> {
    if is_right(value) {
        Ok(())
    } else {
        Err(BuildError::Number {
            what: what.to_owned(),
            value,
            expected,
        })
    }
}
