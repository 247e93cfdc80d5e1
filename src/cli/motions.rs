//! The named motions of a study, beside its own.

use super::output::motion_file;
use crate::curves::{Curves, curves};
use crate::model::Suspension;
use crate::plan::Plan;
use crate::report::FailureRange;
use crate::study::Study;

/// The curves of a named motion.
pub(super) struct NamedCurves {
    pub name: String,
    pub file: String,
    pub curves: Curves,
}

impl NamedCurves {
    /// Curves of every named motion. An axle has none, because its named motions serve constraints only.
    pub(super) fn all(study: &Study) -> Result<Vec<Self>, String> {
        let motions = study.motions.iter().filter(|_| study.axle.is_none());
        let named = motions.map(|(name, motion)| {
            let plan = Plan::of(&Study {
                motion: motion.clone(),
                ..study.clone()
            });
            let wheel = &study.suspension;
            let curves = curves(wheel, &plan).map_err(|f| f.describe(&wheel.mechanism))?;
            Ok(NamedCurves {
                file: motion_file(name),
                name: name.clone(),
                curves,
            })
        });
        named.collect()
    }

    /// Failures of the motion, one line each.
    pub(super) fn failures(&self, wheel: &Suspension) -> Vec<String> {
        let failures = FailureRange::all(&self.curves, wheel);
        let said = failures.iter();
        said.map(|failure| format!("motion {}: not solved: {failure}", self.name))
            .collect()
    }
}
