//! Chooses the quantity on the horizontal axis of a curve.

use super::record::MotionRecord;

/// Name prefixes of outputs that depend on steering more than on anything else.
const OF_STEERING: [&str; 4] = ["steer_", "mean_steer_", "ackermann", "steering_ratio"];
/// Name prefixes of motion columns that measure the steering: angle of the steering wheel, displacement of the rack.
const STEERED: [&str; 2] = ["steering_wheel_angle", "rack_"];

impl MotionRecord {
    /// Initial column on the horizontal axis of an output: time if the curves are over time, otherwise the column from
    /// [`MotionRecord::natural_abscissa`].
    pub(super) fn usual_abscissa(&self, output: &str) -> &str {
        let by_time = self.abscissae.iter().find(|a| *a == "time_s");
        by_time.map_or(self.natural_abscissa(output), String::as_str)
    }

    /// Columns that can be on the horizontal axis.
    pub(super) fn all_abscissae(&self) -> Vec<&str> {
        let further = self.abscissae.iter().filter(|a| **a != self.drive);
        let all = std::iter::once(&self.drive).chain(further);
        all.map(String::as_str).collect()
    }

    /// Column for the horizontal axis of an output, also for curves over time. For outputs that depend on steering, it is the
    /// steering column, if the motion of an axle steers. Otherwise it is the column of the drive: the coordinate that moves the
    /// wheel or, for an axle, the first moving coordinate.
    pub(super) fn natural_abscissa(&self, output: &str) -> &str {
        let name = output.strip_prefix("left_").unwrap_or(output);
        let name = name.strip_prefix("right_").unwrap_or(name);
        let is_of = |starts: &[&str], name: &str| starts.iter().any(|s| name.starts_with(s));
        let mut further = self.further.iter();
        let steered = further.find(|column| is_of(&STEERED, column));
        match steered {
            Some(steered) if is_of(&OF_STEERING, name) => steered,
            _ => &self.drive,
        }
    }
}
