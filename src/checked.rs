//! Result of checking a study as `hardpoint check` does: curves of its own motion, curves of its named motions, and doubts.

use crate::curves::Curves;
use crate::model::Suspension;
use crate::report::{FailureRange, variable_plausibility};
use crate::solved::Solved;
use crate::study::{Study, Vehicle};

/// Curves of a study that `solve` accepts.
pub struct Checked<'s> {
    /// The curves of the study's own motion.
    pub solved: Solved<'s>,
    /// The curves of its named motions.
    pub of_motions: Vec<NamedCurves>,
    plausibility: Vec<String>,
}

impl<'s> Checked<'s> {
    /// Solves a study prepared by [`motion_alone`]. Refuses the same studies as `solve`.
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

    /// Warnings about the design, and remarks on its curves, one per line.
    pub fn remarks(&self, study: &Study) -> Vec<String> {
        let mut remarks = self.plausibility.clone();
        remarks.extend(variable_plausibility(study));
        remarks.extend(self.solved.remarks());
        remarks
    }

    /// Ranges of stations that were not solved, one per line.
    pub fn failures(&self, wheel: &Suspension) -> Vec<String> {
        not_solved(&self.solved, &self.of_motions, wheel)
    }

    /// True if every requested value was found.
    pub fn is_complete(&self) -> bool {
        let mut motions = self.of_motions.iter().map(|motion| &motion.curves);
        self.solved.is_complete() && motions.all(Curves::are_complete)
    }
}

/// Ranges of stations that were not solved, in the study's own motion and in its named ones, one per line.
pub(crate) fn not_solved(
    solved: &Solved<'_>,
    of_motions: &[NamedCurves],
    wheel: &Suspension,
) -> Vec<String> {
    let own = solved.failures();
    let own = own.iter().map(|failure| format!("not solved: {failure}"));
    let of_motions = of_motions.iter().flat_map(|motion| motion.failures(wheel));
    own.chain(of_motions).collect()
}

/// Curves of a named motion.
pub struct NamedCurves {
    /// Name of the motion.
    pub name: String,
    /// The curves.
    pub curves: Curves,
}

impl NamedCurves {
    /// Curves of every named motion of a wheel or an axle.
    pub fn all(study: &Study) -> Result<Vec<Self>, String> {
        let named = study.motion_names().into_iter().map(|name| {
            let moved = study.in_motion(name).expect("the name belongs to a motion");
            Ok(NamedCurves {
                name: name.to_owned(),
                curves: moved.curves().map_err(|error| error.to_string())?,
            })
        });
        named.collect()
    }

    /// Name of the file with the curves.
    pub fn file(&self) -> String {
        motion_file(&self.name)
    }

    /// Ranges of stations that were not solved, one per line.
    pub fn failures(&self, wheel: &Suspension) -> Vec<String> {
        let failures = FailureRange::all(&self.curves, wheel);
        failures
            .iter()
            .map(|failure| format!("motion {}: not solved: {failure}", self.name))
            .collect()
    }
}

/// Name of the file with the curves of a named motion.
pub fn motion_file(name: &str) -> String {
    format!("curves_{name}.csv")
}

/// Copy of the study that computes its motion as `solve` does, but without sensitivities and proofs.
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
