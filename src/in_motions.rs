//! Curves of the designs of a run over the named motions of their study.

use crate::checked::motion_file;
use crate::curves::Curves;
use crate::report::NamedMotionRecord;
use crate::solved::Solved;
use crate::study::Study;

/// Label of the design before a tuning.
const BEFORE: &str = "before";

/// Curves of the designs of a run over one named motion.
pub struct InMotion {
    /// Record of the motion and the designs, for the report page of the run.
    pub record: NamedMotionRecord,
    /// Curves of each design over the named motion.
    pub curves: Vec<Curves>,
}

impl InMotion {
    /// Curves over every named motion of a study, in the order of the names. `designs` contains a label and a study for each
    /// design. With `with_targets` the curves include the quantities of targets.
    ///
    /// # Errors
    ///
    /// A sentence that explains why a design cannot be solved in its design position.
    pub fn all(designs: &[(&str, &Study)], with_targets: bool) -> Result<Vec<Self>, String> {
        let names = designs.first().map(|(_, study)| study.motion_names());
        let names = names.into_iter().flatten();
        names
            .map(|name| InMotion::of(name, designs, with_targets))
            .collect()
    }

    fn of(name: &str, designs: &[(&str, &Study)], with_targets: bool) -> Result<Self, String> {
        let moved = designs.iter().map(|(label, study)| {
            let moved = study.in_motion(name).expect("every design has the motion");
            (*label, file(label, name), moved)
        });
        let moved: Vec<(&str, String, Study)> = moved.collect();
        let solved = moved.iter().map(|(_, _, study)| {
            if with_targets {
                Solved::with_targets(study)
            } else {
                Solved::of(study)
            }
        });
        let solved: Vec<Solved> = solved.collect::<Result<_, _>>()?;
        let labelled = moved.iter().zip(&solved);
        let labelled: Vec<_> = labelled
            .map(|((label, file, _), solved)| (*label, file.as_str(), solved))
            .collect();
        Ok(InMotion {
            record: NamedMotionRecord {
                name: name.to_owned(),
                motion: Solved::motion_record(name, &labelled),
            },
            curves: solved.iter().map(|own| own.curves().clone()).collect(),
        })
    }

    /// Name of the file and curves, for each design.
    pub fn files(&self) -> impl Iterator<Item = (&str, &Curves)> {
        let designs = self.record.motion.designs.iter();
        designs
            .map(|design| design.curves.as_str())
            .zip(&self.curves)
    }
}

/// Name of the file with the curves of a design over a named motion.
fn file(label: &str, name: &str) -> String {
    match label {
        BEFORE => motion_file(&format!("{BEFORE}_{name}")),
        _ => motion_file(name),
    }
}

/// Names of the files with curves over the named motions of a study. With `before` they include the files of the design before a
/// tuning.
pub fn files_in_motions(study: &Study, before: bool) -> Vec<String> {
    let names = study.motion_names().into_iter();
    let files = names.flat_map(|name| {
        let earlier = before.then(|| file(BEFORE, name));
        [Some(motion_file(name)), earlier].into_iter().flatten()
    });
    files.collect()
}
