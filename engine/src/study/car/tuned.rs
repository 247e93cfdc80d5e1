//! Tuning of the car in a study.

use super::{CarOptimise, CarStudy};
use crate::car::{CarTuning, CarVariable, Moves, moved, tune};
use crate::number::Vector3;
use crate::optimise::{Control, Fit};

/// A tuned car.
#[derive(Clone, Debug)]
pub struct TunedCar {
    /// Result of the best start of the tuning.
    pub fit: Fit,
    /// Study with the tuned car.
    pub study: CarStudy,
    /// Results of all starts, and the assessment of targets and constraints.
    pub tuning: CarTuning,
}

impl CarStudy {
    /// Tunes the car on the threads of the current rayon pool. An error says why the cases cannot be solved.
    pub fn tuned(&self, wanted: &CarOptimise, control: Control<'_>) -> Result<TunedCar, String> {
        let tuning = tune(&self.car, self.goals(wanted), wanted.run, control)?;
        let fit = tuning.starts.best_fit().cloned();
        let fit = fit.ok_or("no start produced a design")?;
        let study = CarStudy {
            car: moved(&self.car, &wanted.variables, fit.x.as_slice()),
            ..self.clone()
        };
        Ok(TunedCar { fit, study, tuning })
    }

    /// Returns the study with other designs of the axles, [front, rear]. If the study gives a wheelbase, the wheelbase does
    /// not change.
    pub fn at_design(&self, designs: [Vec<Vector3<f64>>; 2]) -> CarStudy {
        let mut study = self.clone();
        for (end, design) in designs.into_iter().enumerate() {
            study.axles[end] = study.axles[end].at_design(design);
            if let Some(both) = study.axles[end].axle() {
                study.car.axles[end] = both.axle.clone();
            }
        }
        if let Some(wheelbase) = self.wheelbase {
            Moves::Wheelbase.apply(wheelbase, &mut study.car);
        }
        study
    }
}

impl CarOptimise {
    /// Removes the variables for which `keeps` returns false, also from the lists of the single axles.
    pub fn retain(&mut self, keeps: impl Fn(&CarVariable) -> bool) {
        let kept: Vec<bool> = self.variables.iter().map(&keeps).collect();
        self.variables.retain(&keeps);
        for rig in self.rigs.iter_mut().flatten() {
            let own = std::mem::take(&mut rig.optimise.variables).into_iter();
            let own = own.zip(std::mem::take(&mut rig.columns));
            for (variable, column) in own.filter(|(_, column)| kept[*column]) {
                rig.optimise.variables.push(variable);
                let before = kept[..column].iter().filter(|kept| **kept);
                rig.columns.push(before.count());
            }
        }
    }
}
