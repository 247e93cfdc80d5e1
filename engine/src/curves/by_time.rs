//! Derivatives with respect to time, from those by the coordinate that follows a time law.

use crate::number::Jet;
use crate::study::TimeLaw;

/// First and second derivative with respect to time of the moving coordinate, if results are by time.
#[derive(Clone, Copy)]
pub(crate) struct ByTime(Option<[f64; 2]>);

impl ByTime {
    /// Derivatives at the time with this index. `None` for results that are not by time.
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

    /// Derivative of this order by the drive, or by time. With y', y'' by the drive q(t), dy/dt = y' q' and d2y/dt2 = y''
    /// q'^2 + y' q''. A quantity that is itself a rate by the drive (an angular velocity) becomes w q' and w' q'^2 + w q''.
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
