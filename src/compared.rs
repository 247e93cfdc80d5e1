//! Prepares studies for a comparison: each one is solved over the motion of the first study.

use crate::axle::{Axle, AxleMotion};
use crate::mechanism::raises_its_joint;
use crate::model::{Axis, Frame, LengthUnit, Side, Suspension};
use crate::report::{Compared, ComparedPoints, CurveTable, NamedPoints};
use crate::solved::Solved;
use crate::study::{Drive, Motion, Study, Vehicle, WheelStudy};

/// Motion of the first study of a comparison. The other studies are solved over this motion.
#[derive(Clone, Debug)]
pub enum FirstMotion {
    /// Motion of one wheel.
    Wheel {
        /// Values of the drive and rack displacements.
        motion: Motion,
        /// Unit of the lengths in the motion.
        unit: LengthUnit,
        /// Axes of the rack displacements.
        frame: Frame,
    },
    /// Motion of both wheels of an axle.
    Axle {
        /// Motion in the unit of the axle.
        motion: AxleMotion,
        /// Axle of the first study.
        axle: Box<Axle>,
    },
}

impl FirstMotion {
    /// Returns the motion of a study.
    pub fn of(study: &Study) -> FirstMotion {
        match &study.vehicle {
            Vehicle::Axle(both) => {
                let (motion, axle) = (both.plan.motion.clone(), Box::new(both.axle.clone()));
                FirstMotion::Axle { motion, axle }
            }
            Vehicle::Wheel(own) => FirstMotion::Wheel {
                motion: own.motion.clone(),
                unit: own.suspension.length_unit,
                frame: own.suspension.frame,
            },
        }
    }

    /// Gives this motion to another study, in the unit and axes of that study. Changes nothing if one study describes a wheel and
    /// the other an axle; `Comparison::of` refuses such a mixture. Returns an error if the study cannot follow the motion.
    fn replace_in(&self, study: &mut Study) -> Result<(), String> {
        match (self, &mut study.vehicle) {
            (FirstMotion::Axle { motion, axle }, Vehicle::Axle(both)) => {
                both.plan.motion = motion.for_study(axle, both)?;
            }
            (
                FirstMotion::Wheel {
                    motion,
                    unit,
                    frame,
                },
                Vehicle::Wheel(own),
            ) => {
                check_drive(motion, own)?;
                own.motion = motion_in(motion, (*unit, *frame), &own.suspension);
                if motion.drive == Drive::PaperTheta {
                    // With the drive of Attia's paper, sensitivities and certificates are not available.
                    own.outputs.sensitivities.clear();
                    own.outputs.certify = false;
                }
            }
            _ => (),
        }
        Ok(())
    }
}

/// Converts the motion of another wheel to the unit and axes of `wheel`. `unit` and `frame` belong to the other wheel.
fn motion_in(motion: &Motion, (unit, frame): (LengthUnit, Frame), wheel: &Suspension) -> Motion {
    let ratio = wheel.length_unit.per_metre() / unit.per_metre();
    let axes = [frame, wheel.frame].map(|frame| Frame::new(frame.meaning().0, Side::Left));
    let [from, to] = axes.map(|frame| frame.sign(Axis::Y));
    let mut own = motion.clone();
    if !motion.drive.is_angle() {
        own.values.iter_mut().for_each(|value| *value *= ratio);
        let law = own.time.iter_mut().flat_map(|law| &mut law.polynomial);
        law.for_each(|coefficient| *coefficient *= ratio);
    }
    let rack = own.rack.iter_mut();
    rack.for_each(|rack| *rack = from * to * ratio * *rack + 0.0);
    own
}

/// Checks that a wheel can follow the drive of the first study's motion. The error is the reason in words.
fn check_drive(motion: &Motion, own: &WheelStudy) -> Result<(), String> {
    let name = motion.drive.name();
    let lacks = |why: &str| {
        Err(format!(
            "the first study has drive = \"{name}\", which this study cannot have: {why}; give the \
             first study travel in [motion]"
        ))
    };
    let is_over_travel = motion.drive == Drive::Travel && motion.time.is_none();
    if own.compliance.is_some() && !is_over_travel {
        let why = "studies with [compliance] are solved over travel: give the first study travel \
                   in [motion]";
        return Err(why.to_owned());
    }
    let mechanism = &own.suspension.mechanism;
    match mechanism.arms.first() {
        _ if !motion.drive.is_angle() => Ok(()),
        None => lacks(&format!("{} has no arm", mechanism.topology.name)),
        Some(_) if motion.drive == Drive::PaperTheta => Ok(()),
        Some(arm) if raises_its_joint(*arm, &own.suspension.design) => Ok(()),
        Some(_) => lacks("its arm is at dead centre in the design position"),
    }
}

/// Returns the curves and points of a study. `first` is the motion of the first study. If `first` is `None`, this call sets it
/// to the motion of this study.
///
/// # Errors
/// Returns the reason in words if the study cannot follow the first motion, or cannot be solved in its design position.
pub fn of_study(
    mut study: Study,
    label: String,
    first: &mut Option<FirstMotion>,
) -> Result<Compared, String> {
    match first {
        None => *first = Some(FirstMotion::of(&study)),
        Some(first) => first.replace_in(&mut study)?,
    }
    let solved = Solved::of(&study)?;
    let table = CurveTable::read(&solved.csv()).expect("written curves can be read");
    let record = Solved::record("compare", &[(&label, "", &solved)])?;
    Ok(Compared {
        mechanism: Some(Box::new(record)),
        ..compared(label, &study, table)
    })
}

/// Makes a design for a comparison from a study and its curves. For an axle whose right wheel is not mirrored, the design has the
/// points of both wheels.
pub fn compared(label: String, study: &Study, mut curves: CurveTable) -> Compared {
    let suspension = study.wheel();
    if let Some(motion) = study.one_wheel().map(|own| &own.motion)
        && let [rack] = motion.rack[..]
        && rack != 0.0
    {
        // A motion with a single rack displacement has no column for the rack. The column is added here, except for 0.
        curves.set_constant(&format!("rack_{}", suspension.length_unit.symbol()), rack);
    }
    let axle = study.axle().map(|both| &both.axle);
    let right = axle.and_then(|axle| axle.right.as_ref());
    let points = match right {
        Some(right) => ComparedPoints::BothWheels([suspension, right].map(named)),
        None => ComparedPoints::OneWheel(named(suspension)),
    };
    Compared {
        label,
        topology: Some(suspension.mechanism.topology.name.to_owned()),
        curves,
        unit: suspension.length_unit,
        axes: Some(suspension.frame.meaning().0),
        points: Some(points),
        mechanism: None,
    }
}

/// Hardpoints of a wheel by name, in the internal frame, with the signs of the study's axes.
fn named(wheel: &Suspension) -> NamedPoints {
    let points = wheel.mechanism.points.iter().zip(&wheel.design);
    let points = points.map(|(point, at)| (point.name.clone(), at.to_array()));
    NamedPoints {
        points: points.collect(),
        signs: Axis::ALL.map(|axis| wheel.frame.sign(axis)),
    }
}
