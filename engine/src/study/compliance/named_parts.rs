//! Elastic parts of a study, with their names.

use super::{AxleComplianceStudy, ComplianceStudy};
use crate::compliance::{AxialStiffness, Parameter, Relaxed, Shape};
use crate::model::Suspension;
use crate::study::Study;

/// A bushing of a wheel, or a mount of a subframe.
#[derive(Clone, Copy, Debug)]
pub struct NamedBushing<'s> {
    /// Name of the bushing or mount.
    pub name: &'s str,
    /// Force and torque laws along and about the axes of the bushing.
    pub shapes: &'s [Shape; 6],
    /// Constant forces along the axes of the bushing and constant torques about them.
    pub preload: [f64; 6],
}

/// A link with axial stiffness.
#[derive(Clone, Copy, Debug)]
pub struct NamedLink<'s> {
    /// Name of the link.
    pub name: &'s str,
    /// Axial stiffness of the link.
    pub stiffness: AxialStiffness,
    /// Constant tension of the link.
    pub preload: f64,
}

/// Elastic parts of a wheel. For an axle: parts of the left wheel, and mounts of the subframe.
#[derive(Clone, Debug)]
pub struct NamedParts<'s> {
    /// Bushings, then mounts, in the order of the indices in [`crate::compliance::Parameter`].
    pub bushings: Vec<NamedBushing<'s>>,
    /// Links with their stiffness.
    pub links: Vec<NamedLink<'s>>,
    /// Rates of parts other than bushings and links, by the names that variables use: spring, anti-roll bar, rack and column.
    pub rates: Vec<NamedRate>,
    /// Position in which the parts are relaxed.
    pub relaxed: Relaxed,
}

/// Rate of a part that has only one rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NamedRate {
    /// Name of the part.
    pub name: &'static str,
    /// Section and key of a study that give the rate.
    pub key: [&'static str; 2],
    /// The rate as an input of equilibria.
    pub parameter: Parameter,
    /// Value of the rate.
    pub value: f64,
}

impl<'s> NamedParts<'s> {
    /// Parts of a wheel, or otherwise of an axle. `None` if both are missing.
    pub(in super::super) fn of(
        suspension: &'s Suspension,
        of_wheel: Option<&'s ComplianceStudy>,
        of_axle: Option<&'s AxleComplianceStudy>,
    ) -> Option<Self> {
        let wheel = of_wheel.map(|own| (&own.parts, &own.link_names));
        let axle = of_axle.map(|own| (&own.parts.wheels[0], &own.link_names));
        let (parts, link_names) = wheel.or(axle)?;
        let bushings = parts.bushings.iter().map(|part| NamedBushing {
            name: suspension.mechanism.name(part.point),
            shapes: &part.shapes,
            preload: part.preload,
        });
        let subframe = of_axle.and_then(|own| own.parts.subframe.as_ref());
        let mounts = subframe.into_iter().flat_map(|own| &own.mounts);
        let mounts = mounts.map(|mount| NamedBushing {
            name: &mount.name,
            shapes: &mount.shapes,
            preload: mount.preload,
        });
        let links = link_names.iter().zip(&parts.links);
        let shared = of_axle.map(|own| &own.parts);
        let column = shared.and_then(|own| own.column);
        let rates = [
            (
                "spring",
                ["spring", "rate"],
                Parameter::SpringRate,
                parts.spring_rate(),
            ),
            (
                "anti_roll_bar",
                ["anti_roll_bar", "rate"],
                Parameter::BarRate,
                shared.and_then(|own| own.bar_rate),
            ),
            (
                "rack",
                ["steering", "rack_stiffness"],
                Parameter::RackRate,
                shared.and_then(|own| own.rack_rate),
            ),
            (
                "column",
                ["steering", "column_stiffness"],
                Parameter::ColumnRate,
                column.map(|own| own.rate),
            ),
        ];
        let rates = rates
            .into_iter()
            .filter_map(|(name, key, parameter, value)| {
                Some(NamedRate {
                    name,
                    key,
                    parameter,
                    value: value?,
                })
            });
        Some(NamedParts {
            bushings: bushings.chain(mounts).collect(),
            links: links
                .map(|(name, link)| NamedLink {
                    name,
                    stiffness: link.stiffness,
                    preload: link.preload,
                })
                .collect(),
            rates: rates.collect(),
            relaxed: parts.relaxed,
        })
    }
}

impl Study {
    /// Elastic parts with their names. `None` if the study has no elastic parts.
    pub fn elastic_parts(&self) -> Option<NamedParts<'_>> {
        let of_axle = self.axle().and_then(|both| both.axle.elastic.as_deref());
        NamedParts::of(self.wheel(), self.compliance(), of_axle)
    }
}
