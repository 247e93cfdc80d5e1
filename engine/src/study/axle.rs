//! `[axle]` and the sections that belong to it: both wheels, steering, springs, the motions of an axle.

use super::compliance::axle_compliance;
use super::elastic_targets::refuse_in_outputs;
use super::error::Problems;
use super::file::{self, File};
use super::loads::loads_of_axle;
use super::motion::{time_law, values};
use super::names::{choose, choose_or};
use super::outputs::{self, distinct};
use super::resolve::Parts;
use super::right_wheel::{self, right_wheel};
use super::rocker_springs;
use super::solid_axle;
use super::suspension::{above_zero, kilograms, positive};
use super::twist_beam;
use super::value::{Number, Text, Values};
use super::{MOST_STATIONS, TimeLaw};
use crate::axle::{
    Axle, AxleKind, AxleMotion, AxlePlan, AxleTime, BumpStop, Coordinate, ForceCurve, Law, Motion,
    Quantity, Setup, SpringLaw, WheelMotion, not_in_equilibrium,
};
use crate::characteristics::Constants;
use crate::model::{Axis, Side, Suspension};
use std::path::Path;
use toml::Spanned;

/// Study of an axle.
#[derive(Clone, Debug, PartialEq)]
pub struct AxleStudy {
    /// Both wheels and the figures of the study.
    pub axle: Axle,
    /// Results to compute.
    pub plan: AxlePlan,
    /// Further motions of the axle by name, in the order of the names.
    pub motions: Vec<(String, AxleMotion)>,
}

impl AxleStudy {
    /// An axle without further motions.
    pub fn of(axle: Axle, plan: AxlePlan) -> Self {
        AxleStudy {
            axle,
            plan,
            motions: Vec::new(),
        }
    }
}

/// True if a motion as written moves an axle rather than one wheel.
pub(super) fn moves_axle(motion: &file::Motion) -> bool {
    !keys_of_axles(motion).is_empty()
}

/// Entries of a motion, a target or a band as written, for each coordinate in the order of [`Coordinate::ALL`].
macro_rules! coordinates {
    ($written:expr) => {
        [
            &$written.roll,
            &$written.heave,
            &$written.travel_left,
            &$written.travel_right,
            &$written.rack,
            &$written.steering_wheel_angle,
        ]
    };
}
pub(super) use coordinates;

/// The keys of a motion that are of axles, and where they are.
fn keys_of_axles(motion: &file::Motion) -> Vec<(&'static str, std::ops::Range<usize>)> {
    let keys = Coordinate::ALL.into_iter().zip(coordinates!(motion));
    let mut places: Vec<_> = keys
        .filter(|(coordinate, _)| *coordinate != Coordinate::Rack)
        .filter_map(|(coordinate, values)| Some((coordinate.key(), values.as_ref()?.span())))
        .collect();
    places.extend(motion.ground.as_ref().map(|text| ("ground", text.span())));
    places.extend(motion.hold.as_ref().map(|text| ("hold", text.span())));
    places
}

/// Refuses entries for an axle in a study of one wheel.
pub(super) fn refuse_without_axle(file: &File, problems: &mut Problems) {
    let motions = std::iter::once(&file.motion).chain(file.motions.values());
    let mut places: Vec<_> = motions.flat_map(|m| keys_of_axles(m.get_ref())).collect();
    let sections = [
        ("[steering]", file.steering.as_ref().map(Spanned::span)),
        (
            "[anti_roll_bar]",
            file.anti_roll_bar.as_ref().map(Spanned::span),
        ),
        (
            "[heave_spring]",
            file.heave_spring.as_ref().map(Spanned::span),
        ),
        ("[t_bar]", file.t_bar.as_ref().map(Spanned::span)),
        ("[heave_bar]", file.heave_bar.as_ref().map(Spanned::span)),
    ];
    // One elastic wheel has a spring, too.
    let springs = [
        ("[spring]", file.spring.as_ref().map(Spanned::span)),
        ("[bump_stop]", file.bump_stop.as_ref().map(Spanned::span)),
        (
            "[rebound_stop]",
            file.rebound_stop.as_ref().map(Spanned::span),
        ),
        ("[tyre]", file.tyre.as_ref().map(Spanned::span)),
    ];
    let springs = springs.into_iter().filter(|_| file.compliance.is_none());
    let sections = sections.into_iter().chain(springs);
    places.extend(sections.filter_map(|(name, span)| Some((name, span?))));
    for (key, span) in places {
        let message = format!("{key} needs [axle]; this study describes one wheel");
        let error = problems.add(span, message);
        error.help("[axle] with right = \"mirrored\" makes it a study of both wheels");
    }
}

/// The axle, if nothing is wrong with it. `suspension` is the left wheel.
pub(super) fn axle(
    file: &File,
    suspension: &Suspension,
    (parts, directory): (Parts, &Path),
    problems: &mut Problems,
) -> Option<AxleStudy> {
    let place = (file.axle.as_ref()).map_or(file.suspension.topology.span(), Spanned::span);
    let mut sound = refuse_corner_keys(file, problems);
    if suspension.mechanism.rigid_axle.is_some() {
        sound &= solid_axle::refuse(file, suspension, problems);
    }
    if suspension.frame.meaning().1 == Side::Right {
        let place = file.suspension.side.as_ref().map_or(place, Text::span);
        let message = "[suspension] of an axle is its left wheel; expected side = \"left\"";
        problems.add(place, message);
        sound = false;
    }
    if let Some(beam) = suspension
        .mechanism
        .rigid_axle
        .as_ref()
        .and_then(|rigid| rigid.twist_beam.as_ref())
    {
        twist_beam::check(&file.suspension, suspension, beam, problems)?;
    }
    let wheels = match &suspension.mechanism.rigid_axle {
        Some(rigid) => solid_axle::wheels(file, suspension, rigid, problems),
        None => {
            let right = right_wheel(file, suspension, problems);
            right.map(|right| (suspension.clone(), right))
        }
    };
    let setup = setup(file, suspension, problems);
    let ((left, right), setup) = (wheels?, setup?);
    let mut axle = Axle {
        left,
        right,
        setup,
        elastic: None,
    };
    track_agrees(file, &axle, problems)?;
    let motion = motion(file, &file.motion, &axle, problems);
    let mut motions = Vec::new();
    let mut places = Vec::new();
    for (name, section) in &file.motions {
        if moves_axle(section.get_ref()) {
            sound &= refuse_wheel_keys(section.get_ref(), problems);
            if let Some(time) = &section.get_ref().time {
                problems.add(time.span(), "a named motion has no time");
                sound = false;
                continue;
            }
            match self::motion(file, section, &axle, problems) {
                Some(motion) => {
                    places.push(section.span());
                    motions.push((name.get_ref().clone(), motion));
                }
                None => sound = false,
            }
        }
    }
    if let Some(own) = &motion {
        let named = motions.iter().map(|(_, motion)| motion);
        let all = std::iter::once((file.motion.span(), own)).chain(places.into_iter().zip(named));
        let elastic = axle_compliance(file, &axle, all, parts, directory, problems);
        axle.elastic = elastic?.map(Box::new);
    }
    let plan = plan(file, &axle, motion, problems)?;
    check_needs(file, &axle, &plan, problems)?;
    sound.then_some(AxleStudy {
        axle,
        plan,
        motions,
    })
}

/// Refuses entries for one wheel, and those that do not work for an axle. Returns true if there are none.
fn refuse_corner_keys(file: &File, problems: &mut Problems) -> bool {
    let mut sound = refuse_wheel_keys(file.motion.get_ref(), problems);
    let solver = [
        (
            file.solver.formulation.as_ref().map(Text::span),
            "an axle is always solved with formulation = \"knuckle_pose\"; leave formulation out",
        ),
        (
            file.solver.accuracy.as_ref().map(Spanned::span),
            "an axle is always solved in full precision; leave accuracy out",
        ),
    ];
    for (span, message) in solver {
        if let Some(span) = span {
            problems.add(span, message);
            sound = false;
        }
    }
    sound
}

/// Refuses the keys of one wheel's motion in a motion of an axle; true if there are none.
fn refuse_wheel_keys(motion: &file::Motion, problems: &mut Problems) -> bool {
    let mut refused = Vec::new();
    let mut add = |span: Option<std::ops::Range<usize>>, message: &str| {
        refused.extend(span.map(|span| (span, message.to_owned())));
    };
    let one_wheel =
        "drives one wheel only; an axle moves by heave, roll, or travel_left and travel_right";
    let values = |values: &Option<Spanned<Values>>| values.as_ref().map(Spanned::span);
    add(values(&motion.travel), &format!("travel {one_wheel}"));
    add(values(&motion.arm_angle), &format!("arm_angle {one_wheel}"));
    add(values(&motion.theta), &format!("theta {one_wheel}"));
    add(
        motion
            .drive
            .as_ref()
            .filter(|_| motion.time.is_none())
            .map(Text::span),
        "the drive of an axle says what moves over time; expected time, or no drive",
    );
    let sound = refused.is_empty();
    for (span, message) in refused {
        problems.add(span, message);
    }
    sound
}

fn setup(file: &File, left: &Suspension, problems: &mut Problems) -> Option<Setup> {
    let vehicle = &file.vehicle;
    let kilograms = kilograms(file, problems);
    let masses = [&vehicle.sprung_mass, &vehicle.unsprung_mass].map(|m| positive(m, problems));
    let masses = masses.map(|mass| Some(mass?.map(|mass| mass * kilograms.unwrap_or(1.0))));
    let newtons = left.length_unit.newtons();
    let given = file.steering.as_ref().map(Spanned::get_ref);
    let c_factor = match given.and_then(|steering| steering.c_factor.as_ref()) {
        None => Some(None),
        Some(zero) if zero.value == 0.0 => {
            let message = "a c_factor of 0 never moves the rack";
            problems.refuse(zero.span.clone(), message)
        }
        Some(c_factor) => Some(Some(c_factor.value * left.frame.sign(Axis::Y))),
    };
    let springs = springs(file, left, problems);
    let rocker_springs = rocker_springs::rocker_springs(file, left, problems);
    let bar = file.anti_roll_bar.as_ref().map(|bar| &bar.get_ref().rate);
    let tyre = file.tyre.as_ref().map(Spanned::get_ref);
    let [mut bar_rate, tyre_rate] = [bar, tyre.map(|tyre| &tyre.rate)].map(|rate| match rate {
        None => Some(None),
        Some(rate) => above_zero(rate, problems).map(|rate| Some(rate * newtons)),
    });
    let tyre_load = positive(&tyre.and_then(|tyre| tyre.load.clone()), problems);
    let tyre_load = tyre_load.map(|load| load.map(|load| load * newtons));
    kilograms?;
    if let (Some(section), None) = (&file.anti_roll_bar, left.mechanism.anti_roll_bar()) {
        let message = "[anti_roll_bar] has a rate, but the study gives no anti-roll bar";
        let error = problems.add(section.span(), message);
        error.help("drop_link_outer, drop_link_inner, anti_roll_bar_inner and anti_roll_bar_outer make one");
        bar_rate = None;
    }
    let beam_rate = twist_beam::bar_rate(file, left, problems)?;
    let [sprung_mass, unsprung_mass] = masses;
    Some(Setup {
        wheel_radius: left.wheel_radius,
        wheelbase: left.vehicle.wheelbase,
        position: left.vehicle.position,
        c_factor: c_factor?,
        springs: springs?,
        rocker_springs: rocker_springs?,
        bar_rate: beam_rate.or(bar_rate?),
        tyre_rate: tyre_rate?,
        tyre_load: tyre_load?,
        sprung_mass: sprung_mass?,
        unsprung_mass: unsprung_mass?,
        constants: Constants::of(left),
        per_metre: left.length_unit.per_metre(),
    })
}

/// The laws of both springs; the inner `None` without springs.
pub(super) fn springs(
    file: &File,
    left: &Suspension,
    problems: &mut Problems,
) -> Option<Option<[SpringLaw; 2]>> {
    let own = right_wheel::own(file).and_then(|own| own.spring.as_ref());
    let newtons = left.length_unit.newtons();
    let mut stop = |section: &Option<Spanned<file::BumpStop>>| match section {
        None => Some(None),
        Some(stop) => {
            let points = force_curve(&stop.get_ref().force_curve, newtons, problems);
            Some(Some(BumpStop {
                gap: stop.get_ref().gap.value,
                curve: points?,
            }))
        }
    };
    let (bump_stop, rebound_stop) = (stop(&file.bump_stop)?, stop(&file.rebound_stop)?);
    let Some(section) = &file.spring else {
        let stop = file.bump_stop.as_ref().map(Spanned::span);
        let rebound = file.rebound_stop.as_ref().map(Spanned::span);
        let beside = [
            ("[bump_stop]", stop),
            ("[rebound_stop]", rebound),
            ("[axle.right.spring]", own.map(Spanned::span)),
        ];
        let mut beside = beside
            .into_iter()
            .filter_map(|(name, span)| Some((name, span?)));
        let Some((name, span)) = beside.next() else {
            return Some(None);
        };
        let message = match name {
            "[bump_stop]" => "[bump_stop] acts beside a spring: expected [spring] too",
            "[rebound_stop]" => "[rebound_stop] acts beside a spring: expected [spring] too",
            _ => "[axle.right.spring] is what differs from [spring]: expected [spring] too",
        };
        return problems.refuse(span, message);
    };
    if left.mechanism.spring.is_none() {
        let message = "[spring] is given, but the study gives no spring";
        let error = problems.add(section.span(), message);
        error.help("spring_upper and spring_lower in [suspension.hardpoints] make one");
        return None;
    }
    let common = section.get_ref();
    let (rate, force) = (common.rate.as_ref(), common.force.as_ref());
    let given = (rate, force, common.force_curve.as_ref());
    let left = spring(given, newtons, section.span(), problems);
    let right = match own {
        None => left.clone(),
        Some(section) => {
            let own = section.get_ref();
            let (own_rate, own_force) = (own.rate.as_ref(), own.force.as_ref());
            let given = match &own.force_curve {
                Some(curve) => (own_rate, own_force, Some(curve)),
                // Rate or force alone differs from what both have.
                None => (own_rate.or(rate), own_force.or(force), None),
            };
            spring(given, newtons, section.span(), problems)
        }
    };
    let law = |spring: Law| SpringLaw {
        spring,
        bump_stop: bump_stop.clone(),
        rebound_stop: rebound_stop.clone(),
    };
    Some(Some([law(left?), law(right?)]))
}

/// Rate, force and curve as they are written.
type GivenSpring<'a> = (
    Option<&'a Number>,
    Option<&'a Number>,
    Option<&'a Spanned<Vec<Spanned<Vec<Number>>>>>,
);

fn spring(
    given: GivenSpring<'_>,
    newtons: f64,
    place: std::ops::Range<usize>,
    problems: &mut Problems,
) -> Option<Law> {
    match given {
        (Some(rate), Some(force), None) => Some(Law::Linear {
            rate: above_zero(rate, problems)? * newtons,
            force: force.value * newtons,
        }),
        (None, None, Some(curve)) => Some(Law::Curve(force_curve(curve, newtons, problems)?)),
        (_, _, Some(curve)) => {
            let message =
                "force_curve already gives the spring; expected rate and force, or force_curve";
            problems.refuse(curve.span(), message)
        }
        _ => {
            let message = "expected rate and force (in the design position), or force_curve";
            problems.refuse(place, message)
        }
    }
}

/// The curve through pairs of length and force; `newtons` is the unit of its forces.
pub(super) fn force_curve(
    written: &Spanned<Vec<Spanned<Vec<Number>>>>,
    newtons: f64,
    problems: &mut Problems,
) -> Option<ForceCurve> {
    let mut points = Vec::new();
    for pair in written.get_ref() {
        match pair.get_ref().as_slice() {
            [x, y] => points.push([x.value, y.value * newtons]),
            other => {
                let message = format!("expected a pair [length, force], found {}", other.len());
                return problems.refuse(pair.span(), message);
            }
        }
    }
    let curve = ForceCurve::through(&points);
    if curve.is_none() {
        let message = "expected two or more pairs, each length above the one before";
        problems.add(written.span(), message);
    }
    curve
}

/// The track of `[vehicle]` must be the design's.
fn track_agrees(file: &File, axle: &Axle, problems: &mut Problems) -> Option<()> {
    let Some(track) = &file.vehicle.track else {
        return Some(());
    };
    let half = |side| {
        let wheel = axle.suspension(side);
        wheel.design[wheel.mechanism.wheel_centre.0].y
    };
    let design = half(Side::Left) + half(Side::Right);
    let tenth = 1e-4 * axle.setup.per_metre;
    if (track.value - design).abs() <= tenth {
        return Some(());
    }
    let message = format!(
        "the wheel centres of this axle are {design} apart, not {}",
        track.value
    );
    problems
        .add(track.span.clone(), message)
        .help("leave out track");
    None
}

/// Returns true if roll holds the load instead of the mean travel.
fn at_load(
    file: &File,
    section: &file::Motion,
    axle: &Axle,
    problems: &mut Problems,
) -> Option<bool> {
    let Some(text) = &section.hold else {
        return Some(false);
    };
    let holds = [("mean_travel", false), ("load", true)];
    let at_load = choose(text, "hold", &holds, problems)?;
    let certifies = file.outputs.as_ref().and_then(|o| o.certify.as_ref());
    let message = if section.roll.is_none() {
        "hold applies to roll, and this motion has no roll"
    } else if at_load && !axle.setup.is_sprung() {
        "hold = \"load\" needs [spring] for the wheel loads"
    } else if at_load && certifies.is_some_and(|c| *c.get_ref()) {
        "certify does not work with hold = \"load\"; expected hold = \"mean_travel\", or no certify"
    } else if at_load && file.tolerance.is_some() {
        "[tolerance] does not work with hold = \"load\"; expected hold = \"mean_travel\", or no [tolerance]"
    } else {
        return Some(at_load);
    };
    problems.refuse(text.span(), message)
}

/// The law of the coordinate that moves over time, and its values as the study would write them; `Some(None)` without one.
fn over_time(
    section: &file::Motion,
    axle: &Axle,
    problems: &mut Problems,
) -> Option<Option<(AxleTime, Vec<f64>)>> {
    let Some(time) = &section.time else {
        return Some(None);
    };
    let names = Coordinate::ALL.map(|coordinate| (coordinate.key(), coordinate));
    let coordinate = choose_or(&section.drive, Coordinate::Heave, "drive", &names, problems)?;
    let key = coordinate.key();
    let given = Coordinate::ALL.into_iter().zip(coordinates!(section));
    for (_, given) in given.filter(|(other, _)| *other == coordinate) {
        if let Some(given) = given {
            let message = format!("time already gives the drive; expected {key} or time");
            let error = problems.add(given.span(), message);
            error.related(time.span(), "given here");
            return None;
        }
    }
    let polynomial = time.get_ref().polynomial.span();
    let written = time_law(time.get_ref(), |c| c, problems)?;
    let values: Vec<f64> = written.times.iter().map(|t| written.value(*t)).collect();
    if values.iter().any(|v| v.abs() > Number::MOST) {
        let message = "the polynomial grows beyond 1e12 between these times";
        return problems.refuse(polynomial, message);
    }
    let in_course = |c: &f64| coordinate.in_course(*c, axle);
    let law = TimeLaw {
        polynomial: written.polynomial.iter().map(in_course).collect(),
        ..written
    };
    Some(Some((AxleTime { coordinate, law }, values)))
}

/// The stations of a motion.
fn motion(
    file: &File,
    section: &Spanned<file::Motion>,
    axle: &Axle,
    problems: &mut Problems,
) -> Option<AxleMotion> {
    let (place, section) = (section.span(), section.get_ref());
    let on_plane = match &section.ground {
        None => None,
        Some(text) => Some((
            choose(
                text,
                "ground",
                &[("plane", true), ("pads", false)],
                problems,
            )?,
            text.span(),
        )),
    };
    let at_load = at_load(file, section, axle, problems);
    let time = over_time(section, axle, problems)?;
    let coordinates = Coordinate::ALL.into_iter().zip(coordinates!(section));
    let mut read = coordinates.map(|(coordinate, given)| match (&time, given) {
        (Some((time, values)), _) if time.coordinate == coordinate => Some(Some(values.clone())),
        (_, None) => Some(None),
        (_, Some(given)) => values(given, problems).map(Some),
    });
    let mut next = || read.next().flatten();
    let (roll, heave, left, right) = (next()?, next()?, next()?, next()?);
    let (racks, wheel_angles) = (next()?, next()?);
    let in_course = |coordinate: Coordinate, written: &[f64]| -> Vec<f64> {
        let values = written.iter();
        values.map(|v| coordinate.in_course(*v, axle)).collect()
    };
    let refuse = |problems: &mut Problems, given: &Option<Spanned<Values>>, message: &str| {
        let place = given.as_ref().map_or(place.clone(), Spanned::span);
        problems.refuse(place, message)
    };
    let wheels = match (heave, roll, left, right) {
        (_, Some(_), l, r) if l.is_some() || r.is_some() => {
            let message = "roll holds the mean travel; expected roll and heave, or travel_left and travel_right";
            return refuse(problems, &section.roll, message);
        }
        (Some(_), _, l, r) if l.is_some() || r.is_some() => {
            let message =
                "heave moves both wheels; expected heave, or travel_left and travel_right";
            return refuse(problems, &section.heave, message);
        }
        (heave, Some(roll), ..) => {
            if let Some((false, span)) = on_plane {
                let message = "roll needs a plane ground; expected ground = \"plane\", or travel_left and travel_right on pads";
                return problems.refuse(span, message);
            }
            WheelMotion::Roll {
                heave: heave.unwrap_or_else(|| vec![0.0]),
                roll: in_course(Coordinate::Roll, &roll),
                at_load: at_load?,
            }
        }
        (Some(heave), None, ..) => match on_plane {
            Some((true, _)) => WheelMotion::Roll {
                heave,
                roll: vec![0.0],
                at_load: false,
            },
            _ => WheelMotion::Heave(heave),
        },
        (None, None, None, None) => {
            let message = "expected heave, roll, or travel_left and travel_right";
            return problems.refuse(place, message);
        }
        (None, None, left, right) => WheelMotion::Travels {
            left: left.unwrap_or_else(|| vec![0.0]),
            right: right.unwrap_or_else(|| vec![0.0]),
            on_plane: on_plane.is_some_and(|(plane, _)| plane),
        },
    };
    let (racks, steering_wheel) = match (racks, wheel_angles) {
        (Some(_), Some(_)) => {
            let message = "rack and steering_wheel_angle both give the rack; expected one of them";
            return refuse(problems, &section.steering_wheel_angle, message);
        }
        (racks, None) => {
            let racks = racks.unwrap_or_else(|| vec![0.0]);
            (in_course(Coordinate::Rack, &racks), None)
        }
        (None, Some(angles)) => {
            if axle.setup.c_factor.is_none() {
                let message = "steering_wheel_angle needs c_factor in [steering]";
                return refuse(problems, &section.steering_wheel_angle, message);
            }
            let racks = in_course(Coordinate::SteeringWheel, &angles);
            let angles = angles.into_iter().map(f64::to_radians).collect();
            (racks, Some(angles))
        }
    };
    let motion = AxleMotion {
        wheels,
        racks,
        shows_rack: section.rack.is_some()
            || section.steering_wheel_angle.is_some()
            || time
                .as_ref()
                .is_some_and(|(time, _)| time.coordinate.motion() == Motion::Rack),
        steering_wheel,
        time: time.map(|(time, _)| time),
    };
    if motion.stations() > MOST_STATIONS {
        let message = format!(
            "{} stations; expected at most {MOST_STATIONS}",
            motion.stations()
        );
        return problems.refuse(place, message);
    }
    Some(motion)
}

/// Returns the results to compute at these stations, if the study has no error in them.
fn plan(
    file: &File,
    axle: &Axle,
    motion: Option<AxleMotion>,
    problems: &mut Problems,
) -> Option<AxlePlan> {
    let Some(section) = &file.outputs else {
        let default = ["camber", "steer", "mean_steer"];
        let quantities = default.iter().flat_map(|name| axle.quantities(name));
        return Some(AxlePlan::of(motion?, quantities.collect()));
    };
    if axle.elastic.is_some() {
        refuse_in_outputs(section, problems)?;
    }
    let listed = distinct(&section.characteristics, problems, |text, problems| {
        quantities(text, axle, problems)
    });
    let order = outputs::order(section, problems);
    let points = outputs::points(section, &axle.left, problems);
    let sensitivities = outputs::sensitivities(section, &axle.left, problems);
    let loads = loads_of_axle(section, &axle.left, problems);
    let order = order?;
    let knuckle = outputs::knuckle(section, order, problems);
    let quantities = listed?.into_iter().flatten().collect();
    Some(AxlePlan {
        derivatives: order as usize,
        sensitivities: sensitivities?,
        certify: outputs::certify(section),
        points: points?,
        knuckle,
        loads: loads?,
        ..AxlePlan::of(motion?, quantities)
    })
}

/// The quantities of this name, which those of both wheels share.
pub(super) fn quantities(
    text: &Text,
    axle: &Axle,
    problems: &mut Problems,
) -> Option<Vec<Quantity>> {
    let names = axle.quantity_names();
    let names: Vec<_> = names.iter().map(|name| (&**name, &**name)).collect();
    let name = choose(text, "quantity of an axle", &names, problems)?;
    let found = axle.quantities(name);
    if found.is_empty() {
        let of = |kind: AxleKind| Quantity::named(name).iter().any(|q| q.is_of(kind));
        let needs = match (of(AxleKind::Independent), of(AxleKind::Solid)) {
            (true, _) => "wheels that move by themselves",
            (_, true) => "a solid axle",
            _ => "a twist beam",
        };
        let message = match axle.kind() {
            AxleKind::Independent => {
                format!("{name} needs {needs}; these wheels move by themselves")
            }
            AxleKind::Solid => format!("{name} needs {needs}; this is a solid axle"),
            AxleKind::TwistBeam => format!("{name} needs {needs}; this is a twist beam"),
        };
        return problems.refuse(text.span(), message);
    }
    Some(found)
}

/// Returns true if the study gives everything that a quantity requires. Reports what is missing.
pub(super) fn lacks_nothing(
    text: &Text,
    quantity: Quantity,
    axle: &Axle,
    problems: &mut Problems,
) -> bool {
    let reason = not_in_equilibrium(quantity, false).filter(|_| axle.elastic.is_some());
    if let Some(reason) = reason {
        refuse_in_equilibrium(text, reason, problems);
        return false;
    }
    if let Quantity::Corner(..) = quantity {
        return super::outputs::characteristic(text, &axle.left, problems).is_some();
    }
    let needs = quantity.info().needs.iter();
    let missing: Vec<_> = needs
        .filter(|need| !axle.meets(**need))
        .filter_map(|need| need.key())
        .collect();
    if missing.is_empty() {
        return true;
    }
    let (name, needs) = (text.get_ref(), missing.join(", "));
    let message = format!("{name} needs {needs}, which this study does not give");
    problems.add(text.span(), message);
    false
}

/// Refuses a quantity for a reason of [`not_in_equilibrium`].
fn refuse_in_equilibrium(text: &Text, [reason, instead]: [&str; 2], problems: &mut Problems) {
    let message = format!("{} {reason}", text.get_ref());
    problems.add(text.span(), message).help(instead);
}

/// Checks that the study gives all inputs that each quantity and the motion need.
fn check_needs(file: &File, axle: &Axle, plan: &AxlePlan, problems: &mut Problems) -> Option<()> {
    let mut sound = true;
    let has_elastic_derivatives = axle.elastic.is_some() && plan.derivatives > 0;
    for text in file.outputs.iter().flat_map(|o| &o.characteristics) {
        let Some(quantity) = axle.quantities(text.get_ref()).first().copied() else {
            continue;
        };
        let has_value = lacks_nothing(text, quantity, axle, problems);
        // Columns of figures have no derivatives.
        let is_derived = has_elastic_derivatives && !matches!(quantity, Quantity::Figure(_));
        let reason = not_in_equilibrium(quantity, true).filter(|_| has_value && is_derived);
        if let Some(reason) = reason {
            refuse_in_equilibrium(text, reason, problems);
        }
        sound &= has_value && reason.is_none();
    }
    let takes_ground = plan.motion.shows_roll() || plan.derivatives > 0;
    if takes_ground && axle.setup.wheel_radius.is_none() {
        let message =
            "an axle on a plane ground needs radius in [wheel], which this study does not give";
        problems.add(file.motion.span(), message);
        sound = false;
    }
    if plan.degree() > 3 {
        let texts = file.outputs.iter().flat_map(|o| &o.characteristics);
        let orders = |text: &&Text| {
            let quantities = axle.quantities(text.get_ref()).into_iter();
            quantities.map(|q| q.rate_order()).max()
        };
        let made_of_most = texts.max_by_key(orders);
        let place = made_of_most.map_or(file.motion.span(), Text::span);
        let name = made_of_most.map_or("an output", |text| text.get_ref());
        let message = format!(
            "{name} contains second derivatives, and an axle has derivatives up to the third only"
        );
        let error = problems.add(place, message);
        error.help("use order = \"velocity\"");
        sound = false;
    }
    sound.then_some(())
}
