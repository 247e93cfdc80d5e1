//! Derivatives with respect to time, from derivatives with respect to the coordinate that follows a time law.

use crate::number::Jet;
use crate::study::TimeLaw;

/// First and second time derivative of the coordinate that follows the time law. `None` if results are not derivatives with respect
/// to time.
#[derive(Clone, Copy)]
pub(crate) struct ByTime(Option<[f64; 2]>);

impl ByTime {
    /// Time derivatives of the coordinate that follows the time law, at the time with index `number`. Without a time law, the
    /// results are derivatives with respect to the drive coordinate.
    pub(crate) fn at(law: Option<&TimeLaw>, number: usize) -> Self {
        ByTime(law.map(|law| {
            let series = law
                .polynomial
                .iter()
                .rev()
                .fold(Jet::<f64, 3>::constant(0.0), |sum, c| {
                    sum * Jet::variable(law.times[number]) + Jet::constant(*c)
                });
            [series.derivative(1), series.derivative(2)]
        }))
    }

    /// Derivative of this order with respect to the drive coordinate or to time. With the derivatives y', y'' with
    /// respect to the drive coordinate q(t), dy/dt = y' q' and d2y/dt2 = y'' q'^2 + y' q''. A quantity w that is itself
    /// a rate with respect to the drive coordinate (an angular velocity) becomes w q' and w' q'^2 + w q''.
    pub(crate) fn apply(self, is_rate: bool, by_drive: [f64; 3], order: usize) -> f64 {
        let Some([velocity, acceleration]) = self.0 else {
            return by_drive[order];
        };
        let [y, first, second] = if is_rate {
            [f64::NAN, by_drive[0], by_drive[1]]
        } else {
            by_drive
        };
        match order + is_rate as usize {
            0 => y,
            1 => first * velocity,
            _ => second * velocity * velocity + first * acceleration,
        }
    }
}
