//! Targets of an axle: target quantity, coordinate of the motion that varies, and values of the other coordinates.

mod target_motion;

use super::axle::{AxleStudy, coordinates, lacks_nothing, quantities};
use super::drive_rounding::DriveRounding;
use super::error::Problems;
use super::file;
use super::names::choose;
use super::resolve::Context;
use super::value::{Numbers, Text};
use super::{Motion, Site, Target, TargetKind, TargetQuantity};
use crate::ask::with_unit;
use crate::axle::{Axle, AxleMotion, AxlePlan, Coordinate, Placement, Quantity};
use crate::evaluate::index_or_push;
use crate::model::Side;
use crate::number::Each;
use std::ops::Range as Span;
use target_motion::TargetMotion;
use toml::Spanned;

/// Stations of an axle's target: one coordinate of the motion varies, and the others are fixed.
#[derive(Clone, Debug, PartialEq)]
pub struct AxleSite {
    /// Name of the motion. `None` for the study's `[motion]`.
    pub motion: Option<String>,
    /// Coordinate of the motion that varies.
    pub over: Coordinate,
    /// Values of the coordinate `over` in the motion, as the study writes them: degrees, or lengths along the study's axes.
    pub values: Vec<f64>,
    /// Values of the other coordinates, in all combinations, or the rows of the motion.
    pub held: AxleMotion,
    /// Description of the other coordinates that the study gives.
    pub words: String,
}

impl AxleStudy {
    /// Returns the plan, extended by the quantities of these targets.
    pub fn plan_with(&self, targets: &[Target]) -> AxlePlan {
        let mut plan = self.plan.clone();
        for target in targets {
            if let TargetKind::Axle(quantities) = &target.of.kind {
                let new = quantities.iter().filter(|q| !plan.quantities.contains(q));
                let new: Vec<_> = new.copied().collect();
                plan.quantities.extend(new);
            }
        }
        // The wheels' Taylor polynomials end at degree 3. With quantities that already contain second derivatives along the motion,
        // only first derivatives of the quantities are available.
        if plan.degree() > 3 {
            plan.derivatives = plan.derivatives.min(1);
        }
        plan
    }
}

impl AxleSite {
    /// Makes a site (the stations of a target) that contains all stations of a motion. `name` is the motion's name.
    pub(crate) fn whole(name: Option<&str>, motion: &AxleMotion, axle: &Axle) -> Self {
        let mut held = motion.clone();
        let over = held.moving()[0];
        let along = held.along(over).cloned().unwrap_or_default();
        // Several stations of a motion may have the same value. For each value, the site (the stations of a target) contains
        // all these stations.
        let values = distinct(along.iter().map(|value| over.written(*value, axle)));
        held.steering_wheel = None;
        AxleSite {
            motion: name.map(str::to_owned),
            over,
            values,
            held,
            words: String::new(),
        }
    }

    /// Description of the motion, if it has a name, and of the other coordinates that the study gives.
    pub fn in_words(&self) -> String {
        let motion = self.motion.as_ref();
        let motion = motion.map_or(String::new(), |name| format!(", motion {name}"));
        motion + &self.words
    }

    /// Motion whose drive values are the values of the coordinate that varies.
    pub(super) fn motion(&self) -> Motion {
        Motion {
            values: self.values.clone(),
            ..Motion::still()
        }
    }

    /// Returns true if `name` is the motion of this site (the stations of a target), and the target gives no values of
    /// other coordinates. The target may still apply to a part of the motion only: see [`AxleSite::held_in`].
    pub fn is_whole_motion(&self, name: Option<&str>) -> bool {
        self.motion.as_deref() == name && self.words.is_empty()
    }

    /// Other coordinates that move in `motion`, but that have a fixed value at the stations of the target. The values are
    /// as the study writes them.
    pub fn held_in(&self, motion: &AxleMotion, axle: &Axle) -> Vec<(Coordinate, f64)> {
        let moving = motion.all_moving().into_iter();
        let (mut held, mut motion) = (self.held.clone(), motion.clone());
        let fixed = moving.filter(|coordinate| *coordinate != self.over);
        let fixed = fixed.flat_map(|coordinate| {
            let values = held.along(coordinate).cloned().unwrap_or_default();
            let is_whole = motion.along(coordinate).is_some_and(|own| *own == values);
            let values = values.into_iter().filter(move |_| !is_whole);
            values.map(move |value| (coordinate, coordinate.written(value, axle)))
        });
        fixed.collect()
    }

    /// Poses at which the varying coordinate `over` has the value `at`, in the study's unit.
    pub fn placements(&self, at: f64, axle: &Axle) -> Vec<Placement> {
        let mut motion = self.held.clone();
        if motion.has_rows() {
            let value = self.over.in_kernel(at, axle);
            let along = motion.along(self.over).cloned().unwrap_or_default();
            let rounding = DriveRounding::of(&along);
            let rows = (0..along.len()).filter(|row| rounding.is_same(along[*row], value));
            return rows
                .flat_map(|row| self.held.row(row).placements())
                .collect();
        }
        let along = motion.along(self.over).expect("a number of this motion");
        *along = vec![self.over.in_kernel(at, axle)];
        motion.placements()
    }
}

/// Values without repetition, in the order of their first occurrence.
pub(super) fn distinct(values: impl IntoIterator<Item = f64>) -> Vec<f64> {
    let mut different = Vec::new();
    for value in values {
        index_or_push(&mut different, value);
    }
    different
}

/// Keys of a target or a band that describe the stations at which the target or band applies.
pub(super) struct Where<'w> {
    motion: &'w Option<Text>,
    over: &'w Option<Text>,
    side: &'w Option<Text>,
    /// Values of the fixed coordinates, in the order of [`Coordinate::ALL`].
    held: [&'w Option<Spanned<Numbers>>; 6],
    /// True for a target of a test result without drive values. The target then applies where the varying coordinate is 0, or
    /// with limits at its values in the motion.
    is_of_design: bool,
}

impl<'w> From<&'w file::Target> for Where<'w> {
    fn from(target: &'w file::Target) -> Self {
        Where {
            motion: &target.motion,
            over: &target.over,
            side: &target.side,
            held: coordinates!(target),
            is_of_design: false,
        }
    }
}

impl<'w> From<&'w file::Band> for Where<'w> {
    fn from(band: &'w file::Band) -> Self {
        Where {
            motion: &band.motion,
            over: &band.over,
            side: &band.side,
            held: coordinates!(band),
            is_of_design: false,
        }
    }
}

impl<'w> Where<'w> {
    fn held(&self) -> impl Iterator<Item = (Coordinate, Option<&'w Spanned<Numbers>>)> {
        let held = Coordinate::ALL.into_iter().zip(self.held);
        held.map(|(coordinate, given)| (coordinate, given.as_ref()))
    }

    fn held_at(&self, coordinate: Coordinate) -> Option<&'w Spanned<Numbers>> {
        self.held().find(|(c, _)| *c == coordinate)?.1
    }

    /// Returns true if the target or band gives the varying coordinate or a fixed coordinate.
    fn is_given(&self) -> bool {
        self.over.is_some() || self.held.iter().any(|given| given.is_some())
    }

    /// Refuses the keys of an axle's target or band in a study of one wheel. The key `rack` is refused only if `rack_too` is
    /// true.
    pub(super) fn refuse(&self, rack_too: bool, problems: &mut Problems) {
        let places = self
            .held()
            .filter(|(c, _)| rack_too || *c != Coordinate::Rack)
            .map(|(c, given)| (c.key(), given.map(Spanned::span)));
        let over = ("over", self.over.as_ref().map(Text::span));
        let side = ("side", self.side.as_ref().map(Text::span));
        for (key, span) in places.chain([over, side]) {
            if let Some(span) = span {
                let message = format!("{key} needs [axle]; this study describes one wheel");
                problems.add(span, message);
            }
        }
    }
}

/// Reads the quantities of a band of an axle, and the stations at which the band applies (its site). If the site is `None`, the
/// band applies to the whole `[motion]`.
pub(super) fn band(
    spanned: &Spanned<file::Band>,
    study: &AxleStudy,
    context: &Context,
    problems: &mut Problems,
) -> Option<(TargetQuantity, Option<AxleSite>)> {
    let written = spanned.get_ref();
    let wanted = Where::from(written);
    let of = subject(&written.characteristic, wanted.side, study, problems);
    let site = match (written.at.is_some() || wanted.is_given(), wanted.motion) {
        (true, _) => Some(site(&wanted, spanned.span(), study, context, problems)?),
        (false, Some(_)) => {
            let of = TargetMotion::read(wanted.motion, study, context, problems)?;
            Some(AxleSite::whole(of.name, of.motion, &study.axle))
        }
        (false, None) => None,
    };
    Some((of?, site))
}

/// Reads the quantity of an axle's target, its stations, and the motion of its curve.
pub(super) fn target(
    spanned: &Spanned<file::Target>,
    study: &AxleStudy,
    context: &Context,
    problems: &mut Problems,
) -> Option<(TargetQuantity, Site, Motion)> {
    let written = spanned.get_ref();
    let of_one_wheel = [
        ("point", written.point.as_ref().map(Text::span)),
        ("length", written.length.as_ref().map(Spanned::span)),
    ];
    for (key, span) in of_one_wheel {
        if let Some(span) = span {
            let message = format!(
                "a target of an axle needs the key \"characteristic\"; {key} is available for one wheel only"
            );
            let error = problems.add(span, message);
            error.help("use a constraint for lengths and positions of points");
            return None;
        }
    }
    if let Some(load) = &written.load {
        return problems.refuse(load.span(), super::subject::NO_FORCES_OF_AN_AXLE);
    }
    if let Some(path) = &written.file {
        let message = "targets of an axle cannot read a file; expected points";
        return problems.refuse(path.span(), message);
    }
    let name = match (&written.characteristic, &written.figure) {
        (Some(name), None) => name,
        (None, Some(name)) if study.axle.elastic.is_some() => name,
        (None, Some(name)) => {
            let message =
                "the key \"figure\" (a test result) needs [compliance] with elastic parts";
            return problems.refuse(name.span(), message);
        }
        (Some(_), Some(name)) => {
            let message = "expected either \"figure\" or \"characteristic\", found both";
            return problems.refuse(name.span(), message);
        }
        (None, None) => return problems.refuse(spanned.span(), "expected characteristic"),
    };
    let of = subject(name, &written.side, study, problems);
    let is_figure = of.as_ref().is_some_and(TargetQuantity::is_figure);
    let along = [
        written.at.is_some(),
        written.points.is_some(),
        written.file.is_some(),
    ];
    let mut wanted = Where::from(written);
    wanted.is_of_design = is_figure && !along.contains(&true);
    let site = site(&wanted, spanned.span(), study, context, problems);
    let (of, site) = (of?, site?);
    let motion = site.motion();
    let site = Site {
        axle: Some(site),
        ..Site::default()
    };
    Some((of, site, motion))
}

fn subject(
    name: &Text,
    side: &Option<Text>,
    study: &AxleStudy,
    problems: &mut Problems,
) -> Option<TargetQuantity> {
    let quantities = quantities_of_side(name, side, &study.axle, problems)?;
    Some(subject_of(quantities, name.get_ref(), &study.axle))
}

/// Quantities with this name on this side. Without a side, the name may denote the same quantity of both wheels.
pub(super) fn quantities_of_side(
    name: &Text,
    side: &Option<Text>,
    axle: &Axle,
    problems: &mut Problems,
) -> Option<Vec<Quantity>> {
    let all = quantities(name, axle, problems)?;
    let quantities: Vec<Quantity> = match side {
        Some(text) => {
            let sides = Side::ALL.each(|side| (side.name(), side));
            let side = choose(text, "side", &sides, problems)?;
            let of_side = |quantity: &Quantity| quantity.side() == Some(side);
            let own: Vec<_> = all.into_iter().filter(of_side).collect();
            if own.is_empty() {
                let name = name.get_ref();
                let message = format!("{name} belongs to the axle, so it has no side");
                return problems.refuse(text.span(), message);
            }
            own
        }
        // A quantity of the axle itself takes precedence over quantities of its wheels.
        None => match all.iter().find(|q| q.side().is_none()) {
            Some(own) => vec![*own],
            None => all,
        },
    };
    lacks_nothing(name, quantities[0], axle, problems).then_some(quantities)
}

/// Subject of a target for quantities with this name: one quantity, or the same quantity of both wheels.
pub(super) fn subject_of(quantities: Vec<Quantity>, name: &str, axle: &Axle) -> TargetQuantity {
    let length = axle.left.length_unit;
    let unit = quantities[0].info().unit;
    let stem = match quantities.as_slice() {
        [one] => one.name(),
        _ => name.to_owned(),
    };
    TargetQuantity {
        kind: TargetKind::Axle(quantities),
        column: with_unit(stem, &unit.suffix(length)),
        unit,
        length,
        sign: 1.0,
    }
}

/// Keys of coordinates, for messages.
fn keys(of: &[Coordinate]) -> String {
    of.iter().map(|c| c.key()).collect::<Vec<_>>().join(", ")
}

/// Coordinate that varies: the coordinate that the target or band names, or otherwise the only coordinate that moves. If no
/// coordinate moves, it is the first available one. A target without drive values takes the first that moves.
fn over(
    written: &Where,
    place: Span<usize>,
    of: &TargetMotion,
    (axle, available): (&Axle, &[Coordinate]),
    problems: &mut Problems,
) -> Option<Coordinate> {
    let moving: Vec<Coordinate> = available
        .iter()
        .copied()
        .filter(|c| of.values(*c, axle, problems).len() > 1)
        .collect();
    match (written.over, moving.as_slice()) {
        (Some(text), _) => {
            let options: Vec<_> = available.iter().map(|c| (c.key(), *c)).collect();
            choose(text, "over", &options, problems)
        }
        (None, [one]) => Some(*one),
        (None, []) => Some(available[0]),
        (None, [first, ..]) if written.is_of_design => Some(*first),
        (None, several) => {
            let message = format!(
                "several coordinates of the motion vary; expected over = one of {}",
                keys(several)
            );
            problems.refuse(place, message)
        }
    }
}

/// Reason why a target over the coordinate `over` cannot fix another coordinate, or `over` itself.
fn not_fixed(
    coordinate: Coordinate,
    over: Coordinate,
    available: &[Coordinate],
    of: &TargetMotion,
) -> String {
    let (key, motion) = (coordinate.key(), of.words());
    if !available.contains(&coordinate) {
        format!("{motion} has {}, but no {key}", keys(available))
    } else if coordinate == over {
        format!("the target is a curve over {key}, so {key} cannot have a fixed value")
    } else {
        format!("the rows of {motion} give {key}; remove the key {key}")
    }
}

/// Reads the stations of a target or a band.
fn site(
    written: &Where,
    place: Span<usize>,
    study: &AxleStudy,
    context: &Context,
    problems: &mut Problems,
) -> Option<AxleSite> {
    let of = TargetMotion::read(written.motion, study, context, problems)?;
    let axle = &study.axle;
    let mut held = of.motion.clone();
    let by_wheel = held.steering_wheel.take().is_some();
    let mut available: Vec<Coordinate> = Coordinate::ALL.to_vec();
    available.retain(|c| held.along(*c).is_some());
    available.retain(|c| match c {
        Coordinate::Rack => !by_wheel,
        Coordinate::SteeringWheel => by_wheel,
        _ => true,
    });
    let has_rows = held.has_rows();
    let over = match written.over {
        // In a motion given as a table of rows, all coordinates may change from row to row. The first of the moving coordinates
        // then counts as the varying one.
        None if has_rows => held.moving()[0],
        _ => over(written, place, &of, (axle, &available), problems)?,
    };
    // If the motion gives angles of the steering wheel, these angles vary instead of the rack displacement.
    let over = match over {
        Coordinate::Rack if by_wheel => Coordinate::SteeringWheel,
        over => over,
    };
    let mut words = String::new();
    for coordinate in Coordinate::ALL {
        let given = written.held_at(coordinate);
        let can_be_fixed = available.contains(&coordinate) && coordinate != over && !has_rows;
        if !can_be_fixed {
            let Some(given) = given else { continue };
            let reason = not_fixed(coordinate, over, &available, &of);
            return problems.refuse(given.span(), reason);
        }
        let list = match given.map(Spanned::get_ref) {
            Some(Numbers::One(value)) => vec![*value],
            Some(Numbers::Many(list)) => list.iter().map(|number| number.value).collect(),
            None => match of.values(coordinate, axle, problems).as_slice() {
                [one] => vec![*one],
                _ => vec![0.0],
            },
        };
        if let Some(given) = given {
            if list.is_empty() {
                let message = format!("expected at least one value of {}", coordinate.key());
                return problems.refuse(given.span(), message);
            }
            let texts: Vec<_> = list.iter().map(ToString::to_string).collect();
            words += &format!(", {} {}", coordinate.key(), texts.join(" "));
        }
        let values = list.iter().map(|v| coordinate.in_kernel(*v, axle));
        let along = held.along(coordinate).expect("a number of this motion");
        *along = values.collect();
    }
    Some(AxleSite {
        motion: of.name.map(str::to_owned),
        over,
        values: of.values(over, axle, problems),
        held,
        words,
    })
}
