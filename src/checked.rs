//! Result of checking a study as `hardpoint check` does: curves of its own motion, curves of its named motions, and warnings.

use crate::curves::Curves;
use crate::in_motions::InMotion;
use crate::model::Suspension;
use crate::report::{FailureRange, remarks_on_motion, scatter_doubts, variable_plausibility};
use crate::solved::Solved;
use crate::study::{Study, Vehicle};

/// Curves and warnings of a study that `solve` accepts.
pub struct Checked<'s> {
    /// The curves of the study's own motion.
    pub solved: Solved<'s>,
    /// The curves of the study's named motions.
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
        remarks.extend(scatter_doubts(study));
        remarks.extend(self.motions().remarks(study.wheel()));
        remarks
    }

    /// Ranges of stations that were not solved, in the study's own motion and in its named motions, one per line.
    pub fn failures(&self, wheel: &Suspension) -> Vec<String> {
        not_solved(&self.solved, &self.of_motions, wheel)
    }

    /// True if every station is solved, and every quantity has a value in some motion.
    pub fn is_complete(&self) -> bool {
        self.motions().are_complete()
    }

    fn motions(&self) -> AllMotions<'_> {
        AllMotions {
            own: self.solved.curves(),
            named: &self.of_motions,
        }
    }
}

/// Curves of a study's own motion and of its named motions. A quantity may be undefined throughout one motion, for example the
/// Ackermann percentage without steering. The quantity counts as missing only if it has no value in any motion.
pub(crate) struct AllMotions<'c> {
    pub(crate) own: &'c Curves,
    pub(crate) named: &'c [NamedCurves],
}

impl AllMotions<'_> {
    /// True if every station is solved, and every column has a value in some motion.
    pub(crate) fn are_complete(&self) -> bool {
        let mut names = self.all().flat_map(|curves| &curves.columns);
        self.all().all(Curves::are_whole) && names.all(|column| self.has_value(&column.name))
    }

    /// Remarks on the curves, one per line: their accuracy, and missing values. A remark on a named motion names that motion.
    pub(crate) fn remarks(&self, wheel: &Suspension) -> Vec<String> {
        let of =
            |curves| remarks_on_motion(curves, wheel.length_unit, |column| self.has_value(column));
        let mut found = of(self.own);
        for NamedCurves { name, curves } in self.named {
            let named = of(curves);
            found.extend(named.iter().map(|line| match line.split_once("warning: ") {
                Some(("", rest)) => format!("warning: motion {name}: {rest}"),
                _ => format!("motion {name}: {line}"),
            }));
        }
        found
    }

    fn all(&self) -> impl Iterator<Item = &Curves> {
        std::iter::once(self.own).chain(self.named.iter().map(|motion| &motion.curves))
    }

    fn has_value(&self, name: &str) -> bool {
        let has = |curves: &Curves| {
            let own = curves.columns.iter().position(|column| column.name == name);
            own.is_some_and(|column| curves.has_value(column))
        };
        self.all().any(has)
    }
}

/// Ranges of stations that were not solved, in the study's own motion and in its named motions, one per line.
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

    /// Curves of the last design over a named motion: after a tuning, the tuned design.
    pub fn of_last(motion: &InMotion) -> Option<Self> {
        Some(NamedCurves {
            name: motion.record.name.clone(),
            curves: motion.curves.last()?.clone(),
        })
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

/// Copy of the study that computes only the curves of its motion, as `solve` does. The copy requests no sensitivities and no
/// certificates.
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
