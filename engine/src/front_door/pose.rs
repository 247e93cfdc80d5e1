//! One pose of the wheel.

use super::Error;
use crate::characteristics::Characteristic;
use crate::curves::{Status, curves};
use crate::model::{PointId, Suspension};
use crate::plan::Plan;
use crate::study::{Motion, WheelStudy};
use std::collections::BTreeMap;

/// Pose of a suspension at one travel of the wheel and one displacement of the rack.
#[derive(Clone, Debug, PartialEq)]
pub struct SuspensionPose {
    /// Wheel travel, jounce positive.
    pub travel: f64,
    /// Rack displacement along the suspension's +y.
    pub rack: f64,
    /// Condition number of the Jacobian of the equations that determine the pose. NaN if it is not known.
    pub condition: f64,
    points: BTreeMap<String, [f64; 3]>,
    characteristics: BTreeMap<Characteristic, f64>,
}

impl SuspensionPose {
    /// Position of the point with this name, in the suspension's axes and unit. `None` if the topology has no such name, or
    /// if the point moves with a rocker that is at a toggle.
    pub fn point(&self, name: &str) -> Option<[f64; 3]> {
        self.points.get(name).copied()
    }

    /// Positions of all points except those on a rocker at a toggle, with their names.
    pub fn points(&self) -> impl Iterator<Item = (&str, [f64; 3])> {
        self.points.iter().map(|(name, p)| (name.as_str(), *p))
    }

    /// Value of a characteristic in the unit of its column. [`Characteristic::info`] gives sign and formula. `None` if
    /// the suspension lacks an input of the characteristic. Also `None` if the characteristic has no value in this
    /// pose, for example a swing arm with its centre at infinity.
    pub fn characteristic(&self, characteristic: Characteristic) -> Option<f64> {
        self.characteristics.get(&characteristic).copied()
    }
}

impl Suspension {
    /// Computes the pose of the suspension with the wheel at `travel` above its design position and the rack displaced by
    /// `rack` along the suspension's +y. The pose contains every point except those on a rocker at a toggle. It contains every
    /// characteristic that has a value and for which the suspension has the inputs.
    ///
    /// The result is the pose that a continuous motion from the design position reaches. Other assemblies of the mechanism at
    /// this travel are excluded.
    ///
    /// ```
    /// # extern crate hardpoint_engine as hardpoint;
    /// use hardpoint::{Characteristic, Suspension};
    ///
    /// let suspension = Suspension::builder("semi_trailing_arm")
    ///     .hardpoint("arm_pivot_inner", [420.0, 240.0, 330.0])
    ///     .hardpoint("arm_pivot_outer", [350.0, 610.0, 310.0])
    ///     .hardpoint("wheel_centre", [0.0, 730.0, 300.0])
    ///     .static_angles_deg(-1.0, 0.1)
    ///     .build()?;
    /// let pose = suspension.pose_at(40.0, 0.0)?;
    /// let [_, _, z] = pose.point("wheel_centre").expect("every suspension has a wheel_centre");
    /// assert!((z - 340.0).abs() < 1e-10);
    /// println!("camber {:?} deg", pose.characteristic(Characteristic::Camber));
    /// let design = suspension.pose_at(0.0, 0.0)?;
    /// assert!((design.characteristic(Characteristic::Camber).unwrap() + 1.0).abs() < 1e-12);
    ///
    /// // If the wheel cannot reach a travel, the error gives the reason.
    /// let error = suspension.pose_at(4000.0, 0.0).unwrap_err();
    /// assert!(error.to_string().starts_with("no pose at travel 4000 mm, rack 0 mm: the wheel travel ends at"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::NoPose`] if the wheel cannot reach this pose. [`Error::Design`] if the design position itself cannot be
    /// solved. [`Error::Number`] if a number is not finite.
    pub fn pose_at(&self, travel: f64, rack: f64) -> Result<SuspensionPose, Error> {
        let mut own = WheelStudy::of(self.clone());
        own.motion = Motion::at(travel, rack)?;
        let outputs = &mut own.outputs;
        outputs.characteristics = Characteristic::available(self).collect();
        outputs.points = (0..self.mechanism.points.len()).map(PointId).collect();
        let curves = curves(self, &Plan::of(&own)).map_err(|fault| Error::design(self, &fault))?;
        let station = &curves.stations[0];
        if let Status::Failed(failure) = station.status {
            return Err(Error::NoPose {
                travel,
                rack,
                unit: self.length_unit.symbol(),
                reason: failure.describe(self.length_unit, self.frame),
            });
        }
        let mut values = station.values.iter().map(|value| value.ok());
        let mut characteristics = BTreeMap::new();
        for characteristic in &own.outputs.characteristics {
            if let Some(value) = values.next().flatten() {
                characteristics.insert(*characteristic, value);
            }
        }
        let mut points = BTreeMap::new();
        for id in &own.outputs.points {
            let mut coordinate = || values.next().flatten();
            if let (Some(x), Some(y), Some(z)) = (coordinate(), coordinate(), coordinate()) {
                points.insert(self.mechanism.name(*id).to_owned(), [x, y, z]);
            }
        }
        Ok(SuspensionPose {
            travel,
            rack,
            condition: station.condition.unwrap_or(f64::NAN),
            points,
            characteristics,
        })
    }
}
