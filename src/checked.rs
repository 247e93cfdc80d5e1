//! A study checked as `hardpoint check` checks it: its own curves, those of its named motions, doubts.

use crate::curves::{Curves, curves};
use crate::model::Suspension;
use crate::plan::Plan;
use crate::report::{FailureRange, variable_plausibility};
use crate::solved::Solved;
use crate::study::{Study, Vehicle, WheelStudy};

/// Curves of a study that `solve` takes.
pub struct Checked<'s> {
    /// The curves of the study's own motion.
    pub solved: Solved<'s>,
    /// The curves of its named motions.
    pub of_motions: Vec<NamedCurves>,
    plausibility: Vec<String>,
}

impl<'s> Checked<'s> {
    /// Solves a study by itself ([`motion_alone`]), or refuses it as `solve` does.
    pub fn of(alone: &'s Study) -> Result<Self, String> {
        let solved = Solved::of(alone)?;
        let of_motions = NamedCurves::all(alone)?;
        let plausibility = solved.plausibility()?;
        Solved::record("solve", &[("design", "curves.csv", &solved)])?;
        Ok(Checked {
            solved,
            of_motions,
            plausibility,
        })
    }

    /// Doubts about the design, and remarks on its curves, a line each.
    pub fn remarks(&self, study: &Study) -> Vec<String> {
        let mut remarks = self.plausibility.clone();
        remarks.extend(variable_plausibility(study));
        remarks.extend(self.solved.remarks());
        remarks
    }

    /// Stations that are not solved, a line for each stretch.
    pub fn failures(&self, wheel: &Suspension) -> Vec<String> {
        let own = self.solved.failures();
        let own = own.iter().map(|failure| format!("not solved: {failure}"));
        let of_motions = self.of_motions.iter().flat_map(|m| m.failures(wheel));
        own.chain(of_motions).collect()
    }

    /// True if every requested value was found.
    pub fn is_complete(&self) -> bool {
        let mut motions = self.of_motions.iter().map(|motion| &motion.curves);
        self.solved.is_complete() && motions.all(Curves::are_complete)
    }
}

/// The curves of a named motion.
pub struct NamedCurves {
    /// Name of the motion.
    pub name: String,
    /// The curves.
    pub curves: Curves,
}

impl NamedCurves {
    /// Those of every named motion; of an axle none, whose named motions are for constraints.
    pub fn all(study: &Study) -> Result<Vec<Self>, String> {
        let Some(own) = study.one_wheel() else {
            return Ok(Vec::new());
        };
        let named = study.motions.iter().map(|(name, motion)| {
            let plan = Plan::of(&WheelStudy {
                motion: motion.clone(),
                ..own.clone()
            });
            let wheel = &own.suspension;
            let curves = curves(wheel, &plan).map_err(|f| f.describe(&wheel.mechanism))?;
            Ok(NamedCurves {
                name: name.clone(),
                curves,
            })
        });
        named.collect()
    }

    /// Name of the file with the curves.
    pub fn file(&self) -> String {
        motion_file(&self.name)
    }

    /// Stretches that are not solved, a line each.
    pub fn failures(&self, wheel: &Suspension) -> Vec<String> {
        let failures = FailureRange::all(&self.curves, wheel);
        let said = failures.iter();
        said.map(|failure| format!("motion {}: not solved: {failure}", self.name))
            .collect()
    }
}

/// The file with the curves of a named motion.
pub fn motion_file(name: &str) -> String {
    format!("curves_{name}.csv")
}

/// The study with its motion as `solve` visits it, and no sensitivities or proofs.
pub fn motion_alone(study: &Study) -> Study {
    let mut alone = study.clone();
    match &mut alone.vehicle {
        Vehicle::Wheel(own) => {
            own.outputs.sensitivities.clear();
            own.outputs.certify = false;
        }
        Vehicle::Axle(both) => both.plan = both.plan.values_alone(),
    }
    alone
}
