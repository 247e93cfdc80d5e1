//! The tuning of a study of a car.

use super::{CarOptimise, CarStudy};
use crate::car::{moved, tune};
use crate::optimise::{Control, Fit};

/// A tuned car.
#[derive(Clone, Debug)]
pub struct TunedCar {
    /// End of the best start.
    pub fit: Fit,
    /// The study with the tuned car.
    pub study: CarStudy,
}

impl CarStudy {
    /// Tunes the car. Errors say why its cases cannot be solved.
    pub fn tuned(&self, wanted: &CarOptimise, control: Control<'_>) -> Result<TunedCar, String> {
        let fit = tune(&self.car, self.goals(wanted), wanted.run, control)?;
        let study = CarStudy {
            car: moved(&self.car, &wanted.variables, fit.x.as_slice()),
            ..self.clone()
        };
        Ok(TunedCar { fit, study })
    }
}
