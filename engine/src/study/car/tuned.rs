//! Tuning of the car in a study.

use super::{CarOptimise, CarStudy};
use crate::car::{CarTuning, CarVariable, Moves, moved, tune};
use crate::number::Vector3;
use crate::optimise::{Control, Fit};

/// A tuned car.
#[derive(Clone, Debug)]
pub struct TunedCar {
    /// Result of the best start.
    pub fit: Fit,
    /// Study with the tuned car.
    pub study: CarStudy,
    /// Misfit of the original car. `None` if its cases have no solution, or if a variable is outside of its range.
    pub misfit_before: Option<f64>,
    /// Number of starts that were interrupted, and total number of starts.
    pub interrupted: [usize; 2],
    /// Indices of constraints that contradict one another ([`CarTuning::contradiction`]).
    pub contradiction: Vec<usize>,
}

impl CarStudy {
    /// Tunes the car on the threads of the current rayon pool. An error says why the cases cannot be solved.
    pub fn tuned(&self, wanted: &CarOptimise, control: Control<'_>) -> Result<TunedCar, String> {
        let CarTuning {
            starts: tuning,
            contradiction,
        } = tune(&self.car, self.goals(wanted), wanted.run, control)?;
        let interrupted = [tuning.interrupted(), tuning.starts.len()];
        // The first start is the original car, moved into the ranges.
        let first = &tuning.starts[0];
        let given = wanted.variables.iter().map(|v| v.moves.value(&self.car));
        let is_given = given.eq(first.x.iter().map(|value| Some(*value)));
        let of_first = first.outcome.as_ref().ok().filter(|_| is_given);
        let misfit_before = of_first.and_then(|fit| Some(fit.history.first()?.misfit));
        let fit = tuning.best_fit().cloned();
        let fit = fit.ok_or("no start produced a design")?;
        let study = CarStudy {
            car: moved(&self.car, &wanted.variables, fit.x.as_slice()),
            ..self.clone()
        };
        Ok(TunedCar {
            fit,
            study,
            misfit_before,
            interrupted,
            contradiction,
        })
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
    /// Keeps only the variables for which `keeps` returns true, also in the lists of the axles alone.
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
