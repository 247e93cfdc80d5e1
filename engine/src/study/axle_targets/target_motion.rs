//! Motion of a target or a band of an axle.

use super::super::axle::{AxleStudy, coordinates};
use super::super::error::Problems;
use super::super::motion::list;
use super::super::names::choose;
use super::super::resolve::Context;
use super::super::value::Text;
use super::super::{file, named_motions};
use super::distinct;
use crate::axle::{Axle, AxleMotion, Coordinate};

/// Motion of a target or a band: the motion that the target or band names, or `[motion]`.
pub(super) struct TargetMotion<'m> {
    pub(super) name: Option<&'m str>,
    pub(super) written: &'m file::Motion,
    pub(super) motion: &'m AxleMotion,
}

impl<'m> TargetMotion<'m> {
    pub(super) fn read(
        name: &Option<Text>,
        study: &'m AxleStudy,
        context: &Context<'m>,
        problems: &mut Problems,
    ) -> Option<Self> {
        let Some(text) = name else {
            return Some(TargetMotion {
                name: None,
                written: context.file.motion.get_ref(),
                motion: &study.plan.motion,
            });
        };
        if named_motions::is_refused(text.get_ref(), context) {
            return None;
        }
        if named_motions::is_of_wheel(text.get_ref(), context) {
            let name = text.get_ref();
            let message = format!(
                "the motion {name} moves the left wheel alone; a target or a band of an axle needs a motion of the axle"
            );
            let error = problems.add(text.span(), message);
            error.help(format!(
                "give heave, roll, or travel_left and travel_right in [motions.{name}]"
            ));
            return None;
        }
        let options: Vec<_> = study
            .motions
            .iter()
            .map(|own| (own.0.as_str(), own))
            .collect();
        if options.is_empty() {
            let message =
                "this study has no named motions of the axle; give them in sections [motions.NAME]";
            return problems.refuse(text.span(), message);
        }
        let (name, motion) = choose(text, "motion", &options, problems)?;
        let mut sections = context.file.motions.iter();
        let (_, section) = sections.find(|(own, _)| own.get_ref() == name)?;
        Some(TargetMotion {
            name: Some(name),
            written: section.get_ref(),
            motion,
        })
    }

    /// Distinct values of a coordinate in the motion, as the study writes them. A coordinate that moves over time has the values
    /// of its law at the given times.
    pub(super) fn values(
        &self,
        coordinate: Coordinate,
        axle: &Axle,
        problems: &mut Problems,
    ) -> Vec<f64> {
        let written = coordinates!(self.written)[coordinate as usize];
        let time = self.motion.time.as_ref();
        let values = match written {
            Some(given) => list(given, problems),
            None if time.is_some_and(|time| time.coordinate == coordinate) => {
                let mut motion = self.motion.clone();
                let along = motion.along(coordinate);
                along.map(|own| own.iter().map(|v| coordinate.written(*v, axle)).collect())
            }
            None => None,
        };
        distinct(values.unwrap_or_else(|| vec![0.0]))
    }

    /// Description of the motion in messages.
    pub(super) fn words(&self) -> String {
        match self.name {
            Some(name) => format!("the motion {name}"),
            None => "the motion of this study".to_owned(),
        }
    }
}
