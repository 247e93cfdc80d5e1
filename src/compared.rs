//! Prepares studies for a comparison: each one is solved over the motion of the first study.

use crate::axle::{Axle, AxleMotion};
use crate::model::{Axis, Frame, LengthUnit, Side, Suspension};
use crate::report::{Compared, ComparedPoints, CurveTable, NamedPoints};
use crate::solved::Solved;
use crate::study::{Drive, Motion, Study, Vehicle};

/// Motion of the first study. The other studies are solved over it.
#[derive(Clone, Debug)]
pub enum FirstMotion {
    /// Motion of one wheel over travel.
    Wheel {
        /// Wheel travels and rack displacements.
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
    /// Returns the motion of a study. `None` if other studies keep their own motion.
    pub fn of(study: &Study) -> Option<FirstMotion> {
        match &study.vehicle {
            Vehicle::Axle(both) => {
                let (motion, axle) = (both.plan.motion.clone(), Box::new(both.axle.clone()));
                Some(FirstMotion::Axle { motion, axle })
            }
            Vehicle::Wheel(own) => is_over_travel(&own.motion).then(|| FirstMotion::Wheel {
                motion: own.motion.clone(),
                unit: own.suspension.length_unit,
                frame: own.suspension.frame,
            }),
        }
    }

    /// Replaces the motion of another study of the same kind. `Comparison::of` refuses a mixture of wheels and axles.
    fn replace_in(&self, study: &mut Study) -> Result<(), String> {
        match (self, &mut study.vehicle) {
            (FirstMotion::Axle { motion, axle }, Vehicle::Axle(both)) => {
                both.plan.motion = motion.for_axle(axle, &both.axle)?;
                if both.axle.elastic.is_some() && !both.plan.motion.is_on_level_pads() {
                    let why = "axles with [compliance] are on level pads: the first study needs \
                               heave, or travel_left and travel_right, in [motion]";
                    return Err(why.to_owned());
                }
            }
            (
                FirstMotion::Wheel {
                    motion,
                    unit,
                    frame,
                },
                Vehicle::Wheel(own),
            ) if is_over_travel(&own.motion) => {
                own.motion = motion_in(motion, (*unit, *frame), &own.suspension);
            }
            _ => (),
        }
        Ok(())
    }
}

/// Motion of another wheel, in the unit and axes of this wheel.
fn motion_in(motion: &Motion, (unit, frame): (LengthUnit, Frame), wheel: &Suspension) -> Motion {
    let ratio = wheel.length_unit.per_metre() / unit.per_metre();
    let axes = [frame, wheel.frame].map(|frame| Frame::new(frame.meaning().0, Side::Left));
    let [from, to] = axes.map(|frame| frame.sign(Axis::Y));
    let mut own = motion.clone();
    own.values.iter_mut().for_each(|value| *value *= ratio);
    let rack = own.rack.iter_mut();
    rack.for_each(|rack| *rack = from * to * ratio * *rack + 0.0);
    own
}

fn is_over_travel(motion: &Motion) -> bool {
    motion.drive == Drive::Travel && motion.time.is_none()
}

/// Returns the curves and points of a study, and true if every curve is complete. `first` is the motion of the first study. If it
/// is `None`, this call sets it.
///
/// # Errors
/// The reason in words.
pub fn of_study(
    mut study: Study,
    label: String,
    first: &mut Option<FirstMotion>,
) -> Result<(Compared, bool), String> {
    match first {
        None => *first = FirstMotion::of(&study),
        Some(first) => first.replace_in(&mut study)?,
    }
    let solved = Solved::of(&study)?;
    let table = CurveTable::read(&solved.csv()).expect("written curves can be read");
    let record = Solved::record("compare", &[(&label, "", &solved)])?;
    let is_complete = solved.is_complete();
    let compared = Compared {
        mechanism: Some(Box::new(record)),
        ..compared(label, &study, table)
    };
    Ok((compared, is_complete))
}

/// Makes a design with these curves. If the right wheel of its axle is not mirrored, the points of both wheels are included.
pub fn compared(label: String, study: &Study, mut curves: CurveTable) -> Compared {
    let suspension = study.wheel();
    if let Some(motion) = study.one_wheel().map(|own| &own.motion)
        && let [rack] = motion.rack[..]
        && rack != 0.0
    {
        // Curves at a single rack displacement do not show it.
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

/// Points of a wheel by name.
fn named(wheel: &Suspension) -> NamedPoints {
    let points = wheel.mechanism.points.iter().zip(&wheel.design);
    let points = points.map(|(point, at)| (point.name.clone(), at.to_array()));
    NamedPoints {
        points: points.collect(),
        signs: Axis::ALL.map(|axis| wheel.frame.sign(axis)),
    }
}
