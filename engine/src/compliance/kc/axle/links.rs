//! Test results for the links of a solid axle: tensions of the links, and their contribution to the roll stiffness.
//!
//! A solid axle on five links cannot roll unless the lengths of the links change. So the links contribute to the roll
//! stiffness. This contribution is the roll stiffness without springs and anti-roll bar. It is zero if the axle can
//! roll with constant lengths of the links.

use super::{AxleFigure, AxleKcRun, Here, roll};
use crate::ask::Unit;
use crate::compliance::{AxleChange, HeldQuantity, KcSubject, LinkMember, WheelFigures};
use crate::model::Side;
use crate::number::Scalar;

/// Links of a solid axle, each with the name of the result for its tension.
const TENSIONS: [(&str, &str); 3] = [
    ("lower_link", "lower_link_tension"),
    ("upper_link", "upper_link_tension"),
    ("panhard", "panhard_tension"),
];

impl AxleKcRun<'_> {
    /// Returns the tensions of the elastic links on each half of a solid axle.
    pub(super) fn wheel_tensions<T: Scalar>(&self, here: &Here<T>) -> Vec<AxleFigure<T>> {
        let of_side = |side| self.tensions(here, side).into_iter().filter(is_of_wheel);
        Side::ALL.into_iter().flat_map(of_side).collect()
    }

    /// Returns the results of the links for the whole axle: tensions of the links that exist only once, and the roll
    /// stiffness of the links.
    pub(super) fn link_figures<T: Scalar>(&self, here: &Here<T>) -> Vec<AxleFigure<T>> {
        if !here.axle.is_joined() {
            return Vec::new();
        }
        let mut found = self.tensions(here, Side::Left);
        found.retain(|figure| !is_of_wheel(figure));
        found.push(AxleFigure {
            quantity: "link_roll_stiffness",
            unit: Unit::TorquePerAngle,
            value: roll_stiffness(here).filter(|value| value.value().is_finite()),
            secant: None,
            of: KcSubject::Axle,
        });
        found
    }

    /// Tensions of the elastic links of a side.
    fn tensions<T: Scalar>(&self, here: &Here<T>, side: Side) -> Vec<AxleFigure<T>> {
        let mechanism = &self.vehicle.suspensions[0].mechanism;
        if mechanism.rigid_axle.is_none() {
            return Vec::new();
        }
        let parts = self.parts.wheels[side as usize].links.iter();
        let tensions = here.axle.tensions(&here.at, side);
        let figure = |(member, tension): (LinkMember, Option<T>)| {
            let LinkMember::Rod { inner, .. } = member else {
                return None;
            };
            let name = mechanism.link_name(inner);
            let (_, quantity) = TENSIONS.iter().find(|(link, _)| *link == name)?;
            Some(AxleFigure {
                quantity,
                unit: Unit::Force,
                value: tension,
                secant: None,
                of: if mechanism.is_single(inner) {
                    KcSubject::Axle
                } else {
                    KcSubject::Wheel(side)
                },
            })
        };
        let members = parts.map(|part| part.member);
        members.zip(tensions).filter_map(figure).collect()
    }
}

fn is_of_wheel<T>(figure: &AxleFigure<T>) -> bool {
    matches!(figure.of, KcSubject::Wheel(_))
}

/// Returns the roll stiffness of an axle without springs and anti-roll bar: roll moment per roll angle.
fn roll_stiffness<T: Scalar>(here: &Here<T>) -> Option<T> {
    let (axle, at) = here.links.as_ref()?;
    let one = axle.travel(at, Side::Left).one();
    let tangent = axle.tangent(at, HeldQuantity::WheelHeight)?;
    let by: [WheelFigures<T>; 2] = axle.figures_along(&tangent, &AxleChange::Travels([-one, one]));
    let [angle, moment] = roll((axle, at), &by);
    Some(moment / angle)
}
