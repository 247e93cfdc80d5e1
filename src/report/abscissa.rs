//! The quantity over which a curve is usually drawn.

use super::record::Record;

/// Beginnings of the names of quantities that steering changes more than anything else.
const OF_STEERING: [&str; 4] = ["steer_", "mean_steer_", "ackermann", "steering_ratio"];
/// Beginnings of the names of columns that measure the steering.
const STEERED: [&str; 2] = ["steering_wheel_angle", "rack_"];

impl Record {
    /// Column that an output is naturally drawn over: of an axle that steers, the steering for what steering changes;
    /// else the drive value.
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
