//! Resolves `[axle]` and the sections that belong to it: both wheels, steering, springs and motions of an axle.

mod motion;
mod quantities;
mod springs;

pub(super) use quantities::quantities;
pub(super) use springs::{force_curve, springs};

use super::compliance::axle_compliance;
use super::elastic_targets::refuse_in_outputs;
use super::error::Problems;
use super::file::{self, File};
use super::loads::{Holding, loads_of_axle};
use super::output_measures::measured;
use super::outputs::{self, distinct};
use super::resolve::Parts;
use super::right_wheel::right_wheel;
use super::rocker_springs;
use super::solid_axle;
use super::suspension::{above_zero, kilograms, positive};
use super::twist_beam;
use super::value::{Text, Values};
use crate::axle::{Axle, AxleMotion, AxlePlan, Coordinate, Quantity, Setup, not_in_equilibrium};
use crate::characteristics::Constants;
use crate::model::{Axis, Side, Suspension};
use crate::number::Each;
use std::path::Path;
use toml::Spanned;

/// Study of an axle.
#[derive(Clone, Debug, PartialEq)]
pub struct AxleStudy {
    /// Both wheels, and further data of the axle such as steering, springs and elastic parts.
    pub axle: Axle,
    /// Results to compute.
    pub plan: AxlePlan,
    /// Further motions of the axle by name, in the order of the names.
    pub motions: Vec<(String, AxleMotion)>,
}

impl AxleStudy {
    /// Makes a study of an axle that has only the motion of its plan.
    pub fn of(axle: Axle, plan: AxlePlan) -> Self {
        AxleStudy {
            axle,
            plan,
            motions: Vec::new(),
        }
    }
}

/// Returns true if a motion in the file is a motion of an axle, not of one wheel.
pub(super) fn moves_axle(motion: &file::Motion) -> bool {
    !keys_of_axles(motion).is_empty()
}

/// Macro that lists the keys of a motion, a target or a band as written: one key for each coordinate, in the order of
/// [`Coordinate::ALL`].
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

/// Keys of a motion that only axles have, with their positions in the file.
fn keys_of_axles(motion: &file::Motion) -> Vec<(&'static str, std::ops::Range<usize>)> {
    let keys = Coordinate::ALL.into_iter().zip(coordinates!(motion));
    let mut places: Vec<_> = keys
        .filter(|(coordinate, _)| *coordinate != Coordinate::Rack)
        .filter_map(|(coordinate, values)| Some((coordinate.key(), values.as_ref()?.span())))
        .collect();
    places.extend(motion.ground.as_ref().map(|text| ("ground", text.span())));
    places.extend(motion.hold.as_ref().map(|text| ("hold", text.span())));
    places.extend(motion.combine.as_ref().map(|text| ("combine", text.span())));
    places
}

/// Refuses sections and keys for an axle in a study of one wheel.
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
    // A single wheel with elastic parts may also have a spring, stops and a tyre.
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

/// Resolves the axle. `None` if the study has an error in the axle. `suspension` is the left wheel.
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
        let message = "[suspension] of an axle is its left wheel; expected side = \"left\". `hardpoint convert --side left` writes the mirror image of the study of a right wheel";
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
    let own = motion::motion(file, &file.motion, &axle, problems);
    let mut motions = Vec::new();
    let mut places = Vec::new();
    for (name, section) in &file.motions {
        if moves_axle(section.get_ref()) {
            sound &= refuse_wheel_keys(section.get_ref(), problems);
            if let Some(time) = &section.get_ref().time {
                problems.add(
                    time.span(),
                    "the key \"time\" is not available in a named motion",
                );
                sound = false;
                continue;
            }
            match motion::motion(file, section, &axle, problems) {
                Some(motion) => {
                    places.push(section.span());
                    motions.push((name.get_ref().clone(), motion));
                }
                None => sound = false,
            }
        }
    }
    if let Some(own) = &own {
        let named = motions.iter().map(|(_, motion)| motion);
        let all = std::iter::once((file.motion.span(), own)).chain(places.into_iter().zip(named));
        let elastic = axle_compliance(file, &axle, all, parts, directory, problems);
        axle.elastic = elastic?.map(Box::new);
    }
    let plan = plan(file, &axle, own, problems)?;
    check_needs(file, &axle, &plan, problems)?;
    sound.then_some(AxleStudy {
        axle,
        plan,
        motions,
    })
}

/// Refuses keys for one wheel, and keys that are not available for an axle. Returns true if there are no such keys.
fn refuse_corner_keys(file: &File, problems: &mut Problems) -> bool {
    let mut sound = refuse_wheel_keys(file.motion.get_ref(), problems);
    let solver = [
        (
            file.solver.formulation.as_ref().map(Text::span),
            "an axle is always solved with formulation = \"knuckle_pose\"; remove the key \"formulation\"",
        ),
        (
            file.solver.accuracy.as_ref().map(Spanned::span),
            "an axle is always solved in full precision; remove the key \"accuracy\"",
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

/// Refuses the keys of one wheel's motion in a motion of an axle. Returns true if there are no such keys.
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
        motion.angle_unit.as_ref().map(Text::span),
        "angle_unit is the unit of arm_angle and theta; angles of an axle are in degrees, so remove the key \"angle_unit\"",
    );
    add(
        motion
            .drive
            .as_ref()
            .filter(|_| motion.time.is_none())
            .map(Text::span),
        "the drive of an axle selects the coordinate that moves over time; expected the key \"time\", or no \
         \"drive\"",
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
    let masses = [&vehicle.sprung_mass, &vehicle.unsprung_mass].each(|m| positive(m, problems));
    let masses = masses.each(|mass| Some(mass?.map(|mass| mass * kilograms.unwrap_or(1.0))));
    let newtons = left.length_unit.newtons();
    let given = file.steering.as_ref().map(Spanned::get_ref);
    let c_factor = match given.and_then(|steering| steering.c_factor.as_ref()) {
        None => Some(None),
        Some(zero) if zero.value == 0.0 => {
            let message = "with c_factor = 0 the steering wheel never moves the rack: expected another number";
            problems.refuse(zero.span.clone(), message)
        }
        Some(c_factor) => Some(Some(c_factor.value * left.frame.sign(Axis::Y))),
    };
    let springs = springs(file, left, problems);
    let rocker_springs = rocker_springs::rocker_springs(file, left, problems);
    let bar = file.anti_roll_bar.as_ref().map(|bar| &bar.get_ref().rate);
    let tyre = file.tyre.as_ref().map(Spanned::get_ref);
    let [mut bar_rate, tyre_rate] = [bar, tyre.map(|tyre| &tyre.rate)].each(|rate| match rate {
        None => Some(None),
        Some(rate) => above_zero(rate, problems).map(|rate| Some(rate * newtons)),
    });
    let tyre_load = positive(&tyre.and_then(|tyre| tyre.load.clone()), problems);
    let tyre_load = tyre_load.map(|load| load.map(|load| load * newtons));
    kilograms?;
    if let (Some(section), None) = (&file.anti_roll_bar, left.mechanism.anti_roll_bar()) {
        let message = "[anti_roll_bar] has a rate, but the hardpoints of an anti-roll bar are \
                       missing";
        let error = problems.add(section.span(), message);
        error.help(
            "drop_link_outer, drop_link_inner, anti_roll_bar_inner and anti_roll_bar_outer define an anti-roll bar",
        );
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

/// Reads the results to compute at the stations of `motion`. `None` if the study has an error in the outputs.
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
    if let Some(place) = measured(section) {
        let message = "lengths, plunges, articulations and clearances are available for one wheel only; remove [axle] to get them for the \
                       left wheel";
        return problems.refuse(place, message);
    }
    let listed = distinct(&section.characteristics, problems, |text, problems| {
        quantities(text, axle, problems)
    });
    let order = outputs::order(section, problems);
    let points = outputs::points(section, &axle.left, problems);
    let sensitivities = outputs::sensitivities(section, &axle.left, problems);
    let elastic = axle.elastic.as_ref();
    let has_spring = elastic.map(|elastic| elastic.parts.wheels[0].spring.is_some());
    let loads = loads_of_axle(section, &axle.left, Holding::of(has_spring), problems);
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

/// Checks that the study gives all inputs of a quantity, and reports missing inputs. Returns true if no input is missing. Also
/// refuses a quantity that an equilibrium of elastic parts does not have.
pub(super) fn lacks_nothing(
    text: &Text,
    quantity: Quantity,
    axle: &Axle,
    problems: &mut Problems,
) -> bool {
    if !is_in_equilibrium(text, quantity, axle, problems) {
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

/// For an axle with elastic parts, refuses a quantity that an equilibrium does not have. Returns true if the quantity is
/// available.
pub(super) fn is_in_equilibrium(
    text: &Text,
    quantity: Quantity,
    axle: &Axle,
    problems: &mut Problems,
) -> bool {
    let reason =
        not_in_equilibrium(quantity, axle.kind(), false).filter(|_| axle.elastic.is_some());
    let is_available = reason.is_none();
    if let Some(reason) = reason {
        refuse_in_equilibrium(text, reason, problems);
    }
    is_available
}

/// Refuses a quantity with a reason from [`not_in_equilibrium`].
fn refuse_in_equilibrium(text: &Text, [reason, instead]: [&str; 2], problems: &mut Problems) {
    let message = format!("{} {reason}", text.get_ref());
    problems.add(text.span(), message).help(instead);
}

/// Checks that the study gives all inputs that each quantity and the motion need. Also refuses outputs whose requested
/// derivatives do not exist.
fn check_needs(file: &File, axle: &Axle, plan: &AxlePlan, problems: &mut Problems) -> Option<()> {
    let mut sound = true;
    let has_elastic_derivatives = axle.elastic.is_some() && plan.derivatives > 0;
    for text in file.outputs.iter().flat_map(|o| &o.characteristics) {
        let Some(quantity) = axle.quantities(text.get_ref()).first().copied() else {
            continue;
        };
        let has_value = lacks_nothing(text, quantity, axle, problems);
        // Columns of test results have no derivatives.
        let is_derived = has_elastic_derivatives && !matches!(quantity, Quantity::Figure(_));
        let reason =
            not_in_equilibrium(quantity, axle.kind(), true).filter(|_| has_value && is_derived);
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
            "{name} contains second derivatives; with this order it needs derivatives above the \
             third order, which an axle does not have"
        );
        let error = problems.add(place, message);
        error.help("use order = \"velocity\"");
        sound = false;
    }
    sound.then_some(())
}
