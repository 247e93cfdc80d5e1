//! Chooses the quantity on the horizontal axis of a curve.

use super::record::Record;

/// Name prefixes of outputs that depend on steering more than on anything else.
const OF_STEERING: [&str; 4] = ["steer_", "mean_steer_", "ackermann", "steering_ratio"];
/// Name prefixes of columns that measure the steering.
const STEERED: [&str; 2] = ["steering_wheel_angle", "rack_"];

impl Record {
    /// Column for the horizontal axis of an output. For outputs that depend on steering, it is the steering column of a steered
    /// axle. Otherwise it is the value of the drive.
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
