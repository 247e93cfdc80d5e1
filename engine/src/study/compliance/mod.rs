//! `[compliance]`, `[bushings.NAME]` and `[links.NAME]`: the elastic parts of one wheel and their tests.

mod bushing;
mod link;
mod tests;

pub(super) use bushing::BushingText;

use super::axle;
use super::error::Problems;
use super::file::{self, File};
use super::names::choose;
use super::resolve::each;
use super::suspension::positive;
use super::value::Text;
use crate::compliance::{Compliance, ElasticWheel, KcTest, Relaxed};
use crate::model::{Body, Constraint, Suspension};
use std::path::Path;
use toml::Spanned;

/// The elastic parts of a study and their tests.
#[derive(Clone, Debug, PartialEq)]
pub struct ComplianceStudy {
    /// The parts.
    pub parts: Compliance,
    /// Names of the links, in the order of [`Compliance::links`].
    pub link_names: Vec<String>,
    /// The tests.
    pub tests: Vec<KcTest>,
    /// Rate of the tyre, force per length.
    pub tyre_rate: Option<f64>,
}

/// The elastic parts, if they have no error; the inner `None` without elastic parts.
pub(super) fn compliance(
    file: &File,
    suspension: &Suspension,
    knows_elastic: bool,
    directory: &Path,
    problems: &mut Problems,
) -> Option<Option<ComplianceStudy>> {
    if let Some(subframe) = &file.subframe {
        return problems.refuse(subframe.span(), "subframes are not available yet");
    }
    let parts = file.bushings.iter().map(|(name, part)| (name, part.span()));
    let links = file.links.iter().map(|(name, part)| (name, part.span()));
    let mut parts = parts.chain(links);
    let Some(section) = &file.compliance else {
        let Some((name, _)) = parts.next() else {
            return Some(None);
        };
        let message = "an elastic part needs the section [compliance]";
        let error = problems.add(name.span(), message);
        error.help(RELAXED);
        return None;
    };
    if !knows_elastic {
        let message = "this command does not know elastic parts; here they would be left out";
        let error = problems.add(section.span(), message);
        error.help(
            "kc, solve, sweep, optimise, tolerance, compare and export take them; for the rigid mechanism remove [compliance], [bushings] and [links]",
        );
        return None;
    }
    if let Some(axle) = &file.axle {
        let message = "[axle] with [compliance] is not available yet";
        let error = problems.add(axle.span(), message);
        error.help("without [axle] the study is of the left wheel alone");
        return None;
    }
    let mechanism = &suspension.mechanism;
    let carries_link = |c: &Constraint| mechanism.arm_under(c).is_some();
    if mechanism.constraints.iter().any(carries_link) {
        let message = format!(
            "{} has no elastic parts yet: its lower arm holds the wheel carrier at two points, which the elastic arm does not",
            mechanism.topology.name
        );
        let error = problems.add(section.span(), message);
        error.help(
            "for results of the rigid mechanism, remove [compliance], [bushings] and [links]",
        );
        return None;
    }
    if suspension.wheel_radius.is_none() {
        let message = "[compliance] needs radius in [wheel]: loads act at the contact point";
        return problems.refuse(section.span(), message);
    }
    if parts.next().is_none() {
        let message = "nothing is elastic: expected [bushings.NAME] or [links.NAME]";
        let error = problems.add(section.span(), message);
        error.help(
            "`hardpoint kc` of a study without [compliance] has the tests of the rigid mechanism",
        );
        return None;
    }
    refuse_motions(file, problems)?;
    let relaxed = relaxed(section, problems);
    let springs = axle::springs(file, suspension, problems);
    let bushings = each(&file.bushings, |(name, part)| {
        bushing::bushing(name, part, suspension, directory, problems)
    });
    let links = each(&file.links, |(name, part)| {
        link::link(name, part, suspension, problems)
    });
    let tyre_rate = positive(
        &file.tyre.as_ref().map(|t| t.get_ref().rate.clone()),
        problems,
    );
    let (links, springs) = (links?, springs?);
    let link_names = links.iter().map(|(name, _)| name.clone()).collect();
    let spring = springs.map(|[left, _]| left);
    if relaxed? == Relaxed::AtDesignLoad && spring.is_none() {
        let message = "relaxed = \"at_design_load\" needs [spring]: its force at design gives the design load";
        return problems.refuse(section.span(), message);
    }
    check_spring(suspension, section, problems)?;
    let parts = Compliance {
        relaxed: relaxed?,
        bushings: bushings?,
        links: links.into_iter().map(|(_, part)| part).collect(),
        spring,
    };
    link::check_members(file, suspension, &parts, problems)?;
    let tests = tests::tests(section, suspension, parts.spring.is_some(), problems)?;
    match ElasticWheel::new(suspension, &parts) {
        Ok(_) => Some(Some(ComplianceStudy {
            parts,
            link_names,
            tests,
            tyre_rate: tyre_rate?,
        })),
        Err(fault) => {
            let message = fault.describe(&parts, suspension);
            problems.refuse(section.span(), &message)
        }
    }
}

/// The remedy where `relaxed` is missing.
const RELAXED: &str = "relaxed = \"at_design_load\" if the hardpoints are of the loaded car, \"free\" if bushings are slack in the drawing";

fn relaxed(section: &Spanned<file::Compliance>, problems: &mut Problems) -> Option<Relaxed> {
    let Some(text) = &section.get_ref().relaxed else {
        let message = "expected relaxed: the position in which elastic parts are relaxed";
        problems.add(section.span(), message).help(RELAXED);
        return None;
    };
    let options = [
        ("free", Relaxed::Free),
        ("at_design_load", Relaxed::AtDesignLoad),
    ];
    choose(text, "value of relaxed", &options, problems)
}

/// Elastic wheels are driven by travel and rack.
fn refuse_motions(file: &File, problems: &mut Problems) -> Option<()> {
    let named = file.motions.values().map(Spanned::get_ref);
    std::iter::once(file.motion.get_ref())
        .chain(named)
        .try_for_each(|motion| refuse_motion(motion, problems))
}

fn refuse_motion(motion: &file::Motion, problems: &mut Problems) -> Option<()> {
    let drive = motion.drive.as_ref();
    let places = [
        (
            "drive",
            drive.filter(|d| d.get_ref() != "travel").map(Text::span),
        ),
        ("arm_angle", motion.arm_angle.as_ref().map(Spanned::span)),
        ("theta", motion.theta.as_ref().map(Spanned::span)),
        ("time", motion.time.as_ref().map(Spanned::span)),
    ];
    let mut found = places
        .into_iter()
        .filter_map(|(key, span)| Some((key, span?)));
    let Some((key, span)) = found.next() else {
        return Some(());
    };
    let message =
        format!("{key} is of a rigid mechanism; with [compliance] expected travel and rack");
    problems.refuse(span, &message)
}

/// Refuses a spring that the elastic wheel does not have.
fn check_spring(
    suspension: &Suspension,
    section: &Spanned<file::Compliance>,
    problems: &mut Problems,
) -> Option<()> {
    let mechanism = &suspension.mechanism;
    let Some(spring) = mechanism.spring else {
        return Some(());
    };
    let rockers = mechanism.rockers_moving(spring.lower).count();
    let seat = mechanism.spring_seat().unwrap_or(spring.lower);
    let on_rod = matches!(mechanism.body(seat), Body::StrutRod(_));
    if rockers > 1 || on_rod {
        let message = "with [compliance] the spring stands on an arm, the wheel carrier or one rocker; a spring on \
                       a rocker of a rocker or on the rod of a strut is not available yet";
        return problems.refuse(section.span(), message);
    }
    Some(())
}
