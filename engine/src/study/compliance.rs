//! `[compliance]`, `[bushings.NAME]` and `[links.NAME]`: the elastic parts of one wheel and their tests.

use super::axle;
use super::error::Problems;
use super::file::{self, File};
use super::names::{choose, choose_or, nearest};
use super::resolve::each;
use super::suspension::{above_zero, positive, three};
use super::value::{Number, Text};
use crate::axle::ForceCurve;
use crate::compliance::{
    AxialStiffness, BushingPart, Compliance, ElasticFault, ElasticWheel, HeldQuantity, KcTest,
    LinkMember, LinkPart, Motion, Relaxed, Shape, TestLoad, bushing_points, link_members,
};
use crate::model::{Body, Constraint, PointId, Suspension};
use crate::number::{Each, Vector3};
use toml::Spanned;

/// Sine of the angle between an x axis and the vertical below which the z axis must be given: 1 degree.
const UPRIGHT: f64 = 0.01745;
/// The most levels of a test.
const MOST_LEVELS: i64 = 1001;

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

/// The elastic parts, if nothing is wrong with them; the inner `None` if there are none.
pub(super) fn compliance(
    file: &File,
    suspension: &Suspension,
    knows_elastic: bool,
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
        let message = "elastic parts are known to `hardpoint kc`, `optimise` and `check` alone; here they would be left out";
        let error = problems.add(section.span(), message);
        error.help(
            "for results of the rigid mechanism, remove [compliance], [bushings] and [links]",
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
    if mechanism
        .constraints
        .iter()
        .any(|c| mechanism.arm_under(c).is_some())
    {
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
        bushing(name, part, suspension, problems)
    });
    let links = each(&file.links, |(name, part)| {
        link(name, part, suspension, problems)
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
    check_members(file, suspension, &parts, problems)?;
    let tests = tests(section, suspension, parts.spring.is_some(), problems)?;
    match ElasticWheel::new(suspension, &parts) {
        Ok(_) => Some(Some(ComplianceStudy {
            parts,
            link_names,
            tests,
            tyre_rate: tyre_rate?,
        })),
        Err(fault) => {
            let message = described(&fault, &parts, suspension);
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
    let motion = file.motion.get_ref();
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

/// Six numbers, of which `is_right` holds; `default` where the key is missing.
fn six(
    written: &Option<Spanned<Vec<Number>>>,
    default: f64,
    expected: &str,
    is_right: impl Fn(f64) -> bool,
    problems: &mut Problems,
) -> Option<[f64; 6]> {
    let Some(list) = written else {
        return Some([default; 6]);
    };
    let Ok(numbers) = <&[Number; 6]>::try_from(list.get_ref().as_slice()) else {
        let message = format!(
            "expected six numbers (along x, y, z and about them), found {}",
            list.get_ref().len()
        );
        return problems.refuse(list.span(), &message);
    };
    for number in numbers {
        if !is_right(number.value) {
            let message = format!("expected {expected}, found {}", number.value);
            return problems.refuse(number.span.clone(), &message);
        }
    }
    Some(numbers.each_ref().each(|number| number.value))
}

fn bushing(
    name: &Text,
    written: &Spanned<file::Bushing>,
    suspension: &Suspension,
    problems: &mut Problems,
) -> Option<BushingPart> {
    let part = written.get_ref();
    let point = bushing_point(name, suspension, problems)?;
    if let Some(file) = &part.file {
        return problems.refuse(file.span(), "bushing files are not available yet");
    }
    let shapes = shapes(name, written, problems)?;
    let any = |_: f64| true;
    let preload = six(&part.preload, 0.0, "a number", any, problems)?;
    let direction = |axis: &Option<file::Coordinates>, problems: &mut Problems| match axis {
        None => Some(None),
        Some(written) => {
            let v = three(written, "components [x, y, z]", problems)?;
            if v == Vector3::default() {
                return problems
                    .refuse(written.span(), "expected a direction, found a null vector");
            }
            Some(Some(suspension.frame.vector(v)))
        }
    };
    let x_axis = direction(&part.x_axis, problems)?;
    let z_axis = direction(&part.z_axis, problems)?;
    let part = BushingPart {
        point,
        shapes,
        preload,
        x_axis,
        z_axis,
    };
    check_axes(name, written, &part, suspension, problems)?;
    Some(part)
}

fn bushing_point(name: &Text, suspension: &Suspension, problems: &mut Problems) -> Option<PointId> {
    let mechanism = &suspension.mechanism;
    let points = bushing_points(mechanism);
    let found = points
        .iter()
        .find(|id| mechanism.name(**id) == name.get_ref());
    if found.is_none() {
        let message = format!("{:?} takes no bushing", name.get_ref());
        let error = problems.add(name.span(), message);
        let names = || points.iter().map(|id| mechanism.name(*id));
        match nearest(name.get_ref(), names()) {
            Some(near) => error.help(format!("did you mean \"{near}\"?")),
            None => error.help(format!(
                "bushings may be at {}",
                names().collect::<Vec<_>>().join(", ")
            )),
        };
    }
    found.copied()
}

/// The laws of a bushing along and about its axes.
fn shapes(
    name: &Text,
    written: &Spanned<file::Bushing>,
    problems: &mut Problems,
) -> Option<[Shape; 6]> {
    let part = written.get_ref();
    let curves = [&part.fx, &part.fy, &part.fz, &part.tx, &part.ty, &part.tz];
    if part.stiffness.is_none() && curves.iter().any(|curve| curve.is_none()) {
        let message = format!("expected stiffness of {:?}, or six curves", name.get_ref());
        return problems.refuse(written.span(), &message);
    }
    let not_negative = |number: f64| number >= 0.0;
    let zero_or_more = "a number of 0 or more";
    let stiffness = six(&part.stiffness, 0.0, zero_or_more, not_negative, problems);
    let cubic = six(&part.cubic, 0.0, zero_or_more, not_negative, problems);
    let above = |number: f64| number > 0.0;
    let scale = six(&part.scale, 1.0, "a number above 0", above, problems);
    let (stiffness, cubic, scale) = (stiffness?, cubic?, scale?);
    let mut shapes = Vec::new();
    for (k, curve) in curves.into_iter().enumerate() {
        let Some(curve) = curve else {
            shapes.push(Shape::Cubic {
                rate: stiffness[k] * scale[k],
                cubic: cubic[k] * scale[k],
            });
            continue;
        };
        if stiffness[k] != 0.0 || cubic[k] != 0.0 {
            let key = ["fx", "fy", "fz", "tx", "ty", "tz"][k];
            let message = format!(
                "{key} is the law of this axis; expected 0.0 as entry {} of stiffness and cubic",
                k + 1
            );
            return problems.refuse(curve.span(), &message);
        }
        shapes.push(Shape::Curve {
            curve: rising(curve, problems)?,
            scale: scale[k],
        });
    }
    if name.get_ref() == "strut_top" && !is_free_about_z(&shapes) {
        let message = "a strut turns freely about its line: expected 0.0 as the last entry of stiffness and cubic, and no tz";
        return problems.refuse(written.span(), message);
    }
    shapes.try_into().ok()
}

fn is_free_about_z(shapes: &[Shape]) -> bool {
    matches!(shapes[5], Shape::Cubic { rate, cubic } if rate == 0.0 && cubic == 0.0)
}

/// A curve that rises in both numbers.
fn rising(
    written: &Spanned<Vec<Spanned<Vec<Number>>>>,
    problems: &mut Problems,
) -> Option<ForceCurve> {
    let curve = axle::force_curve(written, problems)?;
    for (k, pair) in curve.points().windows(2).enumerate() {
        if pair[0][1] >= pair[1][1] {
            let message = format!(
                "expected a force above that of the point before, found {} after {}",
                pair[1][1], pair[0][1]
            );
            return problems.refuse(written.get_ref()[k + 1].span(), &message);
        }
    }
    Some(curve)
}

/// The axes of a bushing must be given by two directions that differ.
fn check_axes(
    name: &Text,
    written: &Spanned<file::Bushing>,
    part: &BushingPart,
    suspension: &Suspension,
    problems: &mut Problems,
) -> Option<()> {
    let (mechanism, design) = (&suspension.mechanism, &suspension.design);
    let at = |id: PointId| design[id.0];
    let of = |constraint: &Constraint| match *constraint {
        Constraint::Link { inner, outer } if inner == part.point || outer == part.point => {
            let arm = mechanism.arms.iter().find(|arm| arm.outer == outer);
            Some(match arm {
                Some(arm) => at(arm.front) - at(arm.rear),
                None => at(outer) - at(inner),
            })
        }
        Constraint::Revolute { first, second } => Some(at(second) - at(first)),
        _ => None,
    };
    let default = mechanism.constraints.iter().find_map(of);
    let up = Vector3::new(0.0, 0.0, 1.0);
    // The mount of a strut has z along the strut and x forward.
    let (x, z) = match default {
        Some(default) => (part.x_axis.unwrap_or(default), part.z_axis.unwrap_or(up)),
        None => (
            part.x_axis.unwrap_or(Vector3::new(1.0, 0.0, 0.0)),
            part.z_axis.unwrap_or(up),
        ),
    };
    if x.normalised().cross(z.normalised()).norm() >= UPRIGHT {
        return Some(());
    }
    let message = match part.z_axis {
        Some(_) => format!("x_axis and z_axis of {:?} are parallel", name.get_ref()),
        None => format!(
            "the x axis of {:?} is within 1 degree of the vertical: expected z_axis",
            name.get_ref()
        ),
    };
    problems.refuse(written.span(), &message)
}

fn link(
    name: &Text,
    written: &Spanned<file::LinkStiffness>,
    suspension: &Suspension,
    problems: &mut Problems,
) -> Option<(String, LinkPart)> {
    let members = link_members(&suspension.mechanism);
    let found = members.iter().find(|(known, _)| known == name.get_ref());
    let Some((known, member)) = found else {
        let message = format!("{:?} is no link", name.get_ref());
        let error = problems.add(name.span(), message);
        let names = || members.iter().map(|(name, _)| name.as_str());
        match nearest(name.get_ref(), names()) {
            Some(near) => error.help(format!("did you mean \"{near}\"?")),
            None => error.help(format!(
                "links are {}",
                names().collect::<Vec<_>>().join(", ")
            )),
        };
        return None;
    };
    let part = written.get_ref();
    let stiffness = match (&part.axial_stiffness, &part.modulus, &part.area) {
        (Some(rate), None, None) => AxialStiffness::Rate(above_zero(rate, problems)?),
        (None, Some(modulus), Some(area)) => {
            let (modulus, area) = (above_zero(modulus, problems), above_zero(area, problems));
            AxialStiffness::PerStrain(modulus? * area?)
        }
        _ => {
            let message = "expected axial_stiffness, or modulus and area";
            return problems.refuse(written.span(), message);
        }
    };
    let part = LinkPart {
        member: *member,
        stiffness,
    };
    Some((known.clone(), part))
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

/// Refuses members that are elastic twice, and arms of which one leg stretches.
fn check_members(
    file: &File,
    suspension: &Suspension,
    parts: &Compliance,
    problems: &mut Problems,
) -> Option<()> {
    let mechanism = &suspension.mechanism;
    let stretches = |inner: PointId, outer: PointId| {
        let member = LinkMember::Rod { inner, outer };
        parts.links.iter().any(|part| part.member == member)
    };
    let place = |name: &str| {
        let written = file.links.iter().find(|(known, _)| known.get_ref() == name);
        written.map_or(0..0, |(known, _)| known.span())
    };
    for constraint in &mechanism.constraints {
        let Constraint::Link { inner, outer } = *constraint else {
            continue;
        };
        if !stretches(inner, outer) {
            continue;
        }
        let name = mechanism.name(inner);
        let name = name.strip_suffix("_inner").unwrap_or(name);
        let arm = mechanism.arms.iter().find(|arm| arm.outer == outer);
        let ends = match arm {
            Some(arm) => [arm.front, arm.rear],
            None => [inner, outer],
        };
        if let Some(end) = ends.into_iter().find(|id| parts.bushing_at(*id).is_some()) {
            let message = format!(
                "{name} has axial stiffness, and a bushing at {}: expected one of them",
                mechanism.name(end)
            );
            return problems.refuse(place(name), &message);
        }
        if let Some(arm) = arm
            && let Some(other) = ends.into_iter().find(|id| !stretches(*id, arm.outer))
        {
            let message = format!(
                "one leg of an arm stretches and the other does not: expected [links.{}] too, or bushings",
                mechanism.name(other)
            );
            return problems.refuse(place(name), &message);
        }
    }
    Some(())
}

fn tests(
    section: &Spanned<file::Compliance>,
    suspension: &Suspension,
    has_spring: bool,
    problems: &mut Problems,
) -> Option<Vec<KcTest>> {
    let Some(list) = &section.get_ref().tests else {
        return Some(KcTest::defaults(false, has_spring, suspension.length_unit));
    };
    let tests = each(list.get_ref(), |written| {
        test(written, suspension, has_spring, problems)
    })?;
    for (k, test) in tests.iter().enumerate() {
        let same = |other: &KcTest| {
            (other.load, other.trail, other.held) == (test.load, test.trail, test.held)
        };
        if let Some(first) = tests[..k].iter().position(same) {
            let error = problems.add(list.get_ref()[k].span(), "this test is there already");
            error.related(list.get_ref()[first].span(), "first here");
            return None;
        }
    }
    Some(tests)
}

fn test(
    written: &Spanned<file::ComplianceTest>,
    suspension: &Suspension,
    has_spring: bool,
    problems: &mut Problems,
) -> Option<KcTest> {
    let part = written.get_ref();
    let load = choose(&part.load, "test load", &TestLoad::ALL, problems)?;
    let not_yet = [
        (
            &part.mode,
            "mode is of both wheels of an axle, which is not available yet",
        ),
        (&part.steering, "steering is not available yet"),
    ];
    for (key, message) in not_yet {
        if let Some(key) = key {
            return problems.refuse(key.span(), message);
        }
    }
    let mut test = KcTest::new(load, suspension.length_unit);
    let of_loads = [
        ("hold", part.hold.as_ref().map(Text::span)),
        ("window", part.window.as_ref().map(|n| n.span.clone())),
        ("levels", part.levels.as_ref().map(Spanned::span)),
    ];
    for (key, span) in of_loads {
        if let (Some(span), true) = (span, load.is_motion()) {
            let message = format!("{key} is of loads; {} is a motion", load.name());
            return problems.refuse(span, &message);
        }
    }
    if let Some(trail) = &part.trail {
        if load != TestLoad::Lateral {
            return problems.refuse(trail.span.clone(), "trail is of load = \"lateral\"");
        }
        if trail.value < 0.0 {
            let message = format!("expected 0 or more, found {}", trail.value);
            return problems.refuse(trail.span.clone(), &message);
        }
        test.trail = trail.value;
    }
    let holds = [
        ("wheel_height", HeldQuantity::WheelHeight),
        ("wheel_load", HeldQuantity::WheelLoad),
    ];
    test.held = choose_or(&part.hold, test.held, "value of hold", &holds, problems)?;
    let place = part.hold.as_ref().map_or(written.span(), Text::span);
    if load == TestLoad::Vertical && test.held == HeldQuantity::WheelHeight {
        let message = "a vertical load moves the wheel: expected hold = \"wheel_load\", or no hold";
        return problems.refuse(place, message);
    }
    if test.held == HeldQuantity::WheelLoad && !has_spring {
        let message = "the wheel load needs [spring]: nothing else carries it";
        return problems.refuse(place, message);
    }
    if let Some(window) = &part.window {
        test.window = above_zero(window, problems)?;
    }
    if let Some(levels) = &part.levels {
        let count = *levels.get_ref();
        if !(3..=MOST_LEVELS).contains(&count) || count % 2 == 0 {
            let message = format!("expected an odd number from 3 to {MOST_LEVELS}, found {count}");
            return problems.refuse(levels.span(), &message);
        }
        test.levels = (count / 2) as usize;
    }
    let stations = [("nearest", false), ("all", true)];
    test.at_all_stations = choose_or(
        &part.stations,
        false,
        "value of stations",
        &stations,
        problems,
    )?;
    Some(test)
}

/// A fault of the elastic wheel in words.
fn described(fault: &ElasticFault, parts: &Compliance, suspension: &Suspension) -> String {
    let motion = |motion: &Motion| match motion {
        Motion::Turn(axis) => format!("turns freely about a line near {}", axis.name()),
        Motion::Shift(axis) => format!("moves freely along {}", axis.name()),
    };
    match fault {
        ElasticFault::Loose { part, motion: how } => format!(
            "{part} {}: expected stiffness about or along that direction in its bushings",
            motion(how)
        ),
        ElasticFault::NoBalance { part } => format!(
            "the forces at the design load cannot be found: without torsion nothing holds {part}"
        ),
        ElasticFault::OutOfReach { bushing, axis } => {
            let point = parts.bushings[*bushing].point;
            format!(
                "the curve along {} of {} does not reach its force at the design load",
                ["x", "y", "z"][*axis],
                suspension.mechanism.name(point)
            )
        }
        ElasticFault::NoLeverage => {
            "the spring's force has no leverage on the wheel in the design position".to_owned()
        }
    }
}
