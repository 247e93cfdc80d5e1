//! Constraints of an axle: its motions, and limits of an elastic or solid axle.

use super::super::axle_targets::quantities_of_side;
use super::super::error::Problems;
use super::super::names::choose;
use super::super::subject::site;
use super::super::value::Text;
use super::super::{AxleStudy, Constraint, Motion, Site};
use super::Reader;
use super::limits::{LIMITS, words};
use crate::characteristics::Measure;
use crate::model::{Axis, Side};
use crate::number::Each;
use toml::Spanned;

impl Reader<'_> {
    /// Limits of a quantity of an elastic axle, a solid axle or a twist beam in the design position: one constraint for each
    /// wheel that has the quantity. If the wheels of a rigid axle are mirror images, the limits of the left wheel suffice.
    pub(super) fn of_whole_axle(
        &self,
        both: &AxleStudy,
        name: &Text,
        problems: &mut Problems,
    ) -> Option<Vec<Constraint>> {
        self.takes(&LIMITS, problems);
        let written = self.written;
        let places = [
            written.motion.as_ref().map(Text::span),
            written.rack.as_ref().map(Spanned::span),
            written
                .at
                .as_ref()
                .filter(|at| at.get_ref() != "design")
                .map(Text::span),
        ];
        if let Some(place) = places.into_iter().flatten().next() {
            let message = "limits of a quantity of this axle apply to the design position; a target with \
                           between, at_least or at_most applies to a motion";
            return problems.refuse(place, message);
        }
        let mut quantities = quantities_of_side(name, &written.side, &both.axle, problems)?;
        let is_mirrored = both.axle.elastic.is_none() && both.axle.right.is_none();
        if is_mirrored && written.side.is_none() {
            quantities.retain(|quantity| quantity.side() != Some(Side::Right));
        }
        let limits = self.needed_limits(problems)?;
        let called = written.name.as_ref().map(|name| name.get_ref().clone());
        let called = called.unwrap_or_else(|| format!("{} {}", name.get_ref(), words(limits)));
        let constraint = |quantity: &crate::axle::Quantity| Constraint {
            name: match quantity.side() {
                Some(side) if !is_mirrored => format!("{called}, {} wheel", side.name()),
                _ => called.clone(),
            },
            parts: vec![self.limited_as_printed(
                Measure::OfAxle(*quantity),
                quantity.info().unit,
                limits,
            )],
            site: None,
        };
        Some(quantities.iter().map(constraint).collect())
    }

    /// Motion and rack displacements of the constraint. A motion of an axle becomes a motion of each wheel, in the axes of a
    /// left wheel.
    pub(super) fn sites(&self, problems: &mut Problems) -> Option<Vec<(Option<Side>, Site)>> {
        let written = self.written;
        let of_axle = written.motion.as_ref().zip(self.context.axle);
        let of_axle = of_axle.and_then(|(text, both)| {
            let named = both.motions.iter().find(|(name, _)| name == text.get_ref());
            Some((text, both, named?))
        });
        let side = self.side(of_axle.is_some(), problems)?;
        if let Some((text, both, _)) = of_axle
            && both.axle.is_rigid()
        {
            let message = "constraints of this axle apply to the design position: expected at = \
                           \"design\", and no motion";
            return problems.refuse(text.span(), message);
        }
        let Some((text, _, (name, motion))) = of_axle else {
            let site = site(&written.motion, &written.rack, self.context, problems)?;
            return Some(vec![(side, site)]);
        };
        if let Some(rack) = &written.rack {
            let message =
                format!("the motion {name} gives the rack displacement; remove the key \"rack\"");
            return problems.refuse(rack.span(), message);
        }
        if motion.has_rows() {
            let message = format!(
                "constraints cannot use the rows of the motion {name}; expected combine = \"all\" in [motions.{name}], or a \
                 target with a band"
            );
            return problems.refuse(text.span(), message);
        }
        let Some(travels) = motion.wheel_travels() else {
            let message = format!(
                "on a plane ground the travels of the wheels follow from the design, and a constraint needs them: expected \
                 heave on pads, or travel_left and travel_right, in [motions.{name}]"
            );
            return problems.refuse(text.span(), message);
        };
        let sign = self.suspension().frame.sign(Axis::Y);
        let of_side = |side: Side| {
            // The right wheel is treated as a left wheel, so its rack moves with the opposite sign.
            let outwards = if side == Side::Left { sign } else { -sign };
            let racks: Vec<f64> = motion.racks.iter().map(|r| outwards * r + 0.0).collect();
            let motion = Motion {
                values: travels[side as usize].to_vec(),
                rack: racks.clone(),
                rack_moves: true,
                ..Motion::still()
            };
            Site {
                motion: Some((name.clone(), motion)),
                racks,
                axle: None,
            }
        };
        let sides = Side::ALL
            .into_iter()
            .filter(|own| side.is_none_or(|s| s == *own));
        Some(sides.map(|side| (Some(side), of_side(side))).collect())
    }

    /// Reads the wheel of the constraint. `None` for both wheels. If the wheels have different dimensions, the study must
    /// name the left wheel, because constraints do not support the dimensions of the right wheel.
    fn side(&self, moves_axle: bool, problems: &mut Problems) -> Option<Option<Side>> {
        let written = self.written;
        let Some(both) = self.context.axle else {
            return match &written.side {
                None => Some(None),
                Some(text) => {
                    let message = "side needs [axle]; this study describes one wheel";
                    problems.refuse(text.span(), message)
                }
            };
        };
        let side = match &written.side {
            None => None,
            Some(text) => {
                let sides = Side::ALL.each(|side| (side.name(), side));
                Some(choose(text, "side", &sides, problems)?)
            }
        };
        if both.axle.right.is_some() && side != Some(Side::Left) {
            let message = "the right wheel has different dimensions, for which constraints are \
                           not available: expected side = \"left\"";
            return problems.refuse(self.place.clone(), message);
        }
        if let (false, Some(motion), Some(Side::Right)) = (moves_axle, &written.motion, side) {
            let name = motion.get_ref();
            let message = format!(
                "the motion {name} moves the left wheel alone: expected side = \"left\", or a motion of the axle"
            );
            return problems.refuse(self.place.clone(), message);
        }
        Some(side)
    }
}
