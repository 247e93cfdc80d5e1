//! Solid axle on five links: two lower and two upper links, and a Panhard rod.
//!
//! The heights of both wheels and the lengths of five links are seven equations for the six unknowns of the axle. So rigid links
//! would bind. Links with axial stiffness settle in the pose of least energy ([`crate::compliance`]). The constraints of the
//! mechanism leave out the upper link of the far half (the half of the other wheel). Without this link the axle has nearly the
//! same motion. The program uses this motion to check and to draw a study.

use super::{Mechanism, Point, PointId};
use crate::number::Each;

/// Ends of the upper link.
const UPPER_LINK: [&str; 2] = ["upper_link_chassis", "upper_link_axle"];

impl Mechanism {
    /// Replaces the single upper link of a solid axle by one upper link on each side. The points of the new far half are at the
    /// end of the list of points.
    pub fn pair_upper_links(&mut self) {
        let near = UPPER_LINK.each(|name| self.point(name));
        let (Some(rigid), [Some(chassis), Some(axle)]) = (&mut self.rigid_axle, near) else {
            return;
        };
        let far = [chassis, axle].each(|near| {
            let id = PointId(self.points.len());
            let Point { name, body } = &self.points[near.0];
            self.points.push(Point {
                name: format!("right_{name}"),
                body: *body,
            });
            rigid.singles.retain(|single| *single != near);
            rigid.pairs.push([near, id]);
            id
        });
        rigid.extra_links.push(far);
    }

    /// Links of a solid axle for which the mechanism has no constraint, because rigid links would bind.
    pub fn extra_links(&self) -> &[[PointId; 2]] {
        let rigid = self.rigid_axle.as_ref();
        rigid.map_or(&[], |rigid| &rigid.extra_links)
    }

    /// Returns true for a solid axle with more links than rigid links allow.
    pub fn has_extra_links(&self) -> bool {
        !self.extra_links().is_empty()
    }
}
