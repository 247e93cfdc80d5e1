//! `[compliance]`, `[bushings.NAME]` and `[links.NAME]`: elastic parts of one wheel, and their tests. `axle.rs` reads the
//! parts of both wheels.

mod axle;
mod bushing;
mod link;
mod named_parts;
mod solid;
mod subframe;
mod tests;

pub use axle::AxleComplianceStudy;
pub(super) use axle::axle_compliance;
pub(super) use bushing::BushingText;
pub use named_parts::{NamedBushing, NamedLink, NamedParts};

use super::axle as of_axle;
use super::error::Problems;
use super::file::{self, File};
use super::names::choose;
use super::resolve::{Parts, each};
use super::suspension::positive;
use super::value::Text;
use crate::axle::SpringLaw;
use crate::compliance::{BushingPart, Compliance, ElasticWheel, KcTest, LinkPart, Relaxed};
use crate::model::{Body, Constraint, Suspension};
use std::path::Path;
use toml::Spanned;

/// Elastic parts of a study and their tests.
#[derive(Clone, Debug, PartialEq)]
pub struct ComplianceStudy {
    /// Elastic parts of the wheel.
    pub parts: Compliance,
    /// Names of the links, in the order of [`Compliance::links`].
    pub link_names: Vec<String>,
    /// Tests of the elastic parts.
    pub tests: Vec<KcTest>,
    /// Rate of the tyre, in N per length unit.
    pub tyre_rate: Option<f64>,
}

impl ComplianceStudy {
    /// Returns the parts with a spring that keeps its force-length curve if the design changes. `suspension` has the design
    /// of these parts.
    pub fn with_kept_spring(&self, suspension: &Suspension) -> Self {
        let mut kept = self.clone();
        if let (Some(law), Some(length)) = (
            &mut kept.parts.spring,
            suspension.spring_length(&suspension.design),
        ) {
            *law = law.kept_from(length);
        }
        kept
    }
}

/// Section `[compliance]`. `None` if there is an error, such as a section without elastic parts. `Some(None)` if the study has
/// neither the section nor elastic parts.
fn section<'f>(
    file: &'f File,
    suspension: &Suspension,
    parts: Parts,
    problems: &mut Problems,
) -> Option<Option<&'f Spanned<file::Compliance>>> {
    let bushings = file.bushings.keys().map(|name| ("[bushings]", name.span()));
    let links = file.links.keys().map(|name| ("[links]", name.span()));
    let mut elastic = bushings.chain(links);
    let subframe = file.subframe.as_ref().map(Spanned::span);
    let Some(section) = &file.compliance else {
        let Some((_, place)) = elastic.next().or(subframe.map(|span| ("[subframe]", span))) else {
            return Some(None);
        };
        let message = "an elastic part needs the section [compliance]";
        problems.add(place, message).help(RELAXED);
        return None;
    };
    if parts == Parts::Rigid {
        let message = "this command does not support elastic parts and would ignore them";
        let error = problems.add(section.span(), message);
        error.help(
            "kc, solve, sweep, optimise, setup, tolerance, limits, compare, export and studio \
             support them; for the rigid mechanism remove [compliance], [bushings] and [links]",
        );
        return None;
    }
    let mechanism = &suspension.mechanism;
    let carries_link = |c: &Constraint| mechanism.arm_under(c).is_some();
    if mechanism.constraints.iter().any(carries_link) {
        let message = format!(
            "{} does not support elastic parts yet: its lower arm is joined to the wheel carrier at two \
             points, and an elastic arm must be joined to the carrier at one point",
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
    let steering = file.steering.as_ref().map(Spanned::get_ref);
    let stiffness = steering.map(|own| [&own.rack_stiffness, &own.column_stiffness]);
    let is_steering_elastic =
        stiffness.is_some_and(|rates| rates.iter().any(|rate| rate.is_some()));
    if elastic.next().is_none() && !is_steering_elastic {
        let message = "nothing is elastic: expected [bushings.NAME] or [links.NAME]";
        let error = problems.add(section.span(), message);
        let mechanism = &suspension.mechanism;
        error.help(match (&mechanism.rigid_axle, mechanism.why_not_elastic()) {
            (Some(_), Some(_)) => "`hardpoint solve` computes the rigid axle without [compliance]",
            (Some(_), None) => {
                "give axial_stiffness in [links.NAME]; `hardpoint kc` needs it, and `hardpoint solve` computes the rigid axle \
                 without [compliance]"
            }
            (None, _) => {
                "without [compliance], `hardpoint kc` runs the tests of the rigid mechanism"
            }
        });
        return None;
    }
    Some(Some(section))
}

/// Elastic parts of one wheel, filled in while the study is read.
#[derive(Clone)]
struct WheelParts {
    bushings: Vec<BushingPart>,
    links: Vec<(String, LinkPart)>,
    relaxed: Relaxed,
}

/// Reads the links, and the bushings that are not one of the subframe's `mounts`.
fn wheel_parts(
    file: &File,
    section: &Spanned<file::Compliance>,
    suspension: &Suspension,
    mounts: &[&str],
    directory: &Path,
    problems: &mut Problems,
) -> Option<WheelParts> {
    let relaxed = relaxed(section, problems);
    let of_wheel = file
        .bushings
        .iter()
        .filter(|(name, _)| !mounts.contains(&name.get_ref().as_str()));
    let bushings = each(of_wheel, |(name, part)| {
        bushing::bushing(name, part, suspension, directory, problems)
    });
    let links = each(&file.links, |(name, part)| {
        link::link(name, part, suspension, problems)
    });
    let mut parts = WheelParts {
        bushings: bushings?,
        links: links?,
        relaxed: relaxed?,
    };
    parts.order(&suspension.mechanism);
    Some(parts)
}

impl WheelParts {
    fn link_names(&self) -> Vec<String> {
        self.links.iter().map(|(name, _)| name.clone()).collect()
    }

    /// Combines the parts with a spring.
    fn with(self, spring: Option<SpringLaw>) -> Compliance {
        Compliance {
            relaxed: self.relaxed,
            bushings: self.bushings,
            links: self.links.into_iter().map(|(_, part)| part).collect(),
            spring,
        }
    }
}

/// Refuses a design load without a spring.
fn check_design_load(
    section: &Spanned<file::Compliance>,
    relaxed: Relaxed,
    has_spring: bool,
    problems: &mut Problems,
) -> Option<()> {
    if relaxed == Relaxed::AtDesignLoad && !has_spring {
        let message = "relaxed = \"at_design_load\" needs [spring]: its force at design gives the design load";
        return problems.refuse(section.span(), message);
    }
    Some(())
}

/// Rate of the tyre. `Some(None)` if the study does not give it, `None` if it has an error.
fn tyre_rate(file: &File, problems: &mut Problems) -> Option<Option<f64>> {
    let rate = file.tyre.as_ref().map(|tyre| tyre.get_ref().rate.clone());
    positive(&rate, problems)
}

/// Elastic parts of one wheel. `None` if these parts have an error, `Some(None)` if there are no such parts.
pub(super) fn compliance(
    file: &File,
    suspension: &Suspension,
    parts: Parts,
    directory: &Path,
    problems: &mut Problems,
) -> Option<Option<ComplianceStudy>> {
    let Some(section) = section(file, suspension, parts, problems)? else {
        return Some(None);
    };
    if let Some(subframe) = &file.subframe {
        let error = problems.add(
            subframe.span(),
            "[subframe] needs [axle]: it holds both wheels",
        );
        error.help("[axle] with right = \"mirrored\" makes it a study of both wheels");
        return None;
    }
    if let Some(bar) = &section.get_ref().anti_roll_bar {
        let message = "anti_roll_bar needs [axle]: the bar acts between the wheels";
        return problems.refuse(bar.span(), message);
    }
    refuse_motions(file, problems)?;
    let springs = of_axle::springs(file, suspension, problems);
    let parts = wheel_parts(file, section, suspension, &[], directory, problems);
    let tyre_rate = tyre_rate(file, problems);
    let (parts, springs) = (parts?, springs?);
    let link_names = parts.link_names();
    let parts = parts.with(springs.map(|[left, _]| left));
    check_design_load(section, parts.relaxed, parts.spring.is_some(), problems)?;
    check_spring(suspension, section, problems)?;
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
            let message = fault.describe();
            problems.refuse(section.span(), &message)
        }
    }
}

/// Hint for a missing key `relaxed`.
const RELAXED: &str = "relaxed = \"at_design_load\" if the hardpoints describe the loaded car, \"free\" \
                       if the bushings carry no force in the design position";

fn relaxed(section: &Spanned<file::Compliance>, problems: &mut Problems) -> Option<Relaxed> {
    let Some(text) = &section.get_ref().relaxed else {
        let message =
            "expected the key \"relaxed\": the position in which elastic parts are relaxed";
        problems.add(section.span(), message).help(RELAXED);
        return None;
    };
    let options = [
        ("free", Relaxed::Free),
        ("at_design_load", Relaxed::AtDesignLoad),
    ];
    choose(text, "value of relaxed", &options, problems)
}

/// Refuses motions of one elastic wheel except travel and rack.
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
        format!("{key} needs a rigid mechanism; with [compliance] expected travel and rack");
    problems.refuse(span, &message)
}

/// Refuses a spring that the elastic wheel cannot have.
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
        let message = "with [compliance] the spring must act on an arm, the wheel carrier or one \
                       rocker; a spring on a rocker of a rocker or on the rod of a strut is not \
                       available yet";
        return problems.refuse(section.span(), message);
    }
    Some(())
}
