//! Springs and stops of an axle, and force curves.

use super::super::error::Problems;
use super::super::file::{self, File};
use super::super::right_wheel;
use super::super::suspension::above_zero;
use super::super::value::Number;
use crate::axle::{BumpStop, ForceCurve, Law, SpringLaw};
use crate::model::Suspension;
use toml::Spanned;

/// Force laws of the springs of both wheels. `Some(None)` if the axle has no springs, `None` if they have an error.
pub(in crate::study) fn springs(
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
            "[bump_stop]" => "[bump_stop] acts together with a spring: expected [spring] too",
            "[rebound_stop]" => "[rebound_stop] acts together with a spring: expected [spring] too",
            _ => "[axle.right.spring] gives the differences from [spring]: expected [spring] too",
        };
        return problems.refuse(span, message);
    };
    if left.mechanism.spring.is_none() {
        let message = "[spring] is given, but the hardpoints of a spring are missing";
        let error = problems.add(section.span(), message);
        error.help("spring_upper and spring_lower in [suspension.hardpoints] define a spring");
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
                // If the study gives a rate or force for this wheel, it replaces the common rate or force.
                None => (own_rate.or(rate), own_force.or(force), None),
            };
            spring(given, newtons, section.span(), problems)
        }
    };
    let law = |spring: Law| SpringLaw {
        spring,
        bump_stop: bump_stop.clone(),
        rebound_stop: rebound_stop.clone(),
        own_length: None,
    };
    Some(Some([law(left?), law(right?)]))
}

/// Rate, force and force curve of a spring, as written in the study.
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
            let message = "force_curve already gives the spring; expected either \"rate\" and \"force\", or \"force_curve\"";
            problems.refuse(curve.span(), message)
        }
        _ => {
            let message = "expected the keys \"rate\" and \"force\" (in the design position), or \"force_curve\"";
            problems.refuse(place, message)
        }
    }
}

/// Force curve through pairs of length and force. `newtons` is the unit of the forces, in N.
pub(in crate::study) fn force_curve(
    written: &Spanned<Vec<Spanned<Vec<Number>>>>,
    newtons: f64,
    problems: &mut Problems,
) -> Option<ForceCurve> {
    let mut points = Vec::new();
    for pair in written.get_ref() {
        match pair.get_ref().as_slice() {
            [x, y] => points.push([x.value, y.value * newtons]),
            other => {
                let message = format!(
                    "expected a pair [length, force], found {} numbers",
                    other.len()
                );
                return problems.refuse_count(pair, 2, message);
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
