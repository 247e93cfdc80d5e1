//! Which way the axes of a table point, seen from what must be so in every suspension: upper joints are
//! above lower ones, front pivots before rear ones, and the wheel is outboard of the body.

use crate::model::{Axis, Body, Frame, FrameConvention, Side, Topology};

/// The orientation that the coordinates show; `None` if they show none. Positive means that the coordinate grows
/// forward, towards the wheel, and upward.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Directions {
    /// Grows forward (or rearward).
    pub forward: Option<f64>,
    /// Grows outboard.
    pub outboard: Option<f64>,
    /// Grows upward.
    pub up: Option<f64>,
}

/// Pairs of hardpoints, the first above the second in every suspension worth the name.
const ABOVE: &[(&str, &str)] = &[
    ("upper_ball_joint", "lower_ball_joint"),
    ("strut_top", "lower_ball_joint"),
    ("strut_top", "strut_lower"),
    ("upper_front_link_outer", "lower_front_link_outer"),
    ("upper_rear_link_outer", "lower_rear_link_outer"),
    ("upper_front_link_inner", "lower_front_link_inner"),
    ("upper_rear_link_inner", "lower_rear_link_inner"),
    ("upper_arm_front", "lower_arm_front"),
    ("upper_arm_rear", "lower_arm_rear"),
];

/// Pairs of hardpoints, the first before the second.
const BEFORE: &[(&str, &str)] = &[
    ("lower_arm_front", "lower_arm_rear"),
    ("upper_arm_front", "upper_arm_rear"),
    ("lower_front_link_inner", "lower_rear_link_inner"),
    ("upper_front_link_inner", "upper_rear_link_inner"),
    ("lower_front_link_outer", "lower_rear_link_outer"),
    ("upper_front_link_outer", "upper_rear_link_outer"),
    // A trailing arm trails.
    ("arm_pivot_inner", "wheel_centre"),
    ("arm_pivot_outer", "wheel_centre"),
];

impl Directions {
    /// As a topology's points show them.
    pub(super) fn of(topology: &'static Topology, points: &[(&'static str, [f64; 3])]) -> Self {
        let at = |name: &str| {
            let found = points.iter().find(|(known, _)| *known == name);
            found.map(|(_, position)| *position)
        };
        let vote = |pairs: &[(&str, &str)], axis: Axis| {
            let differences = pairs.iter().filter_map(|(first, second)| {
                Some(at(first)?[axis as usize] - at(second)?[axis as usize])
            });
            sign(differences.map(f64::signum).sum())
        };
        // A spring on a rocker may lie any way.
        let springs = [("spring_upper", "spring_lower")];
        let springs = if at("rocker_pivot_front").is_none() {
            &springs[..]
        } else {
            &[]
        };
        Directions {
            forward: vote(BEFORE, Axis::X),
            outboard: outboard(topology, points),
            up: vote(ABOVE, Axis::Z).or_else(|| vote(springs, Axis::Z)),
        }
    }

    /// Whether a frame is one that these directions allow: each is right or not known.
    pub(super) fn allow(&self, frame: Frame) -> bool {
        let fits =
            |direction: Option<f64>, axis| direction.is_none_or(|d| d * frame.sign(axis) > 0.0);
        fits(self.forward, Axis::X) && self.allow_side(frame) && fits(self.up, Axis::Z)
    }

    /// Whether the wheel would be outboard of the body.
    pub(super) fn allow_side(&self, frame: Frame) -> bool {
        self.outboard.is_none_or(|d| d * frame.sign(Axis::Y) > 0.0)
    }

    /// The conventions and sides that they allow, the usual one first.
    pub(super) fn allowed(&self) -> Vec<(FrameConvention, Side)> {
        let both = |convention| Side::ALL.map(|side| (convention, side));
        let all = FrameConvention::ALL.into_iter().flat_map(both);
        all.filter(|(convention, side)| self.allow(Frame::new(*convention, *side)))
            .collect()
    }

    /// In words.
    pub(super) fn describe(&self) -> String {
        let words = [
            (self.forward, "x", "forward", "rearward"),
            (
                self.outboard,
                "y",
                "from the body to the wheel",
                "from the wheel to the body",
            ),
            (self.up, "z", "upward", "downward"),
        ];
        let known = words
            .iter()
            .filter_map(|(direction, axis, positive, negative)| {
                let word = if (*direction)? > 0.0 {
                    positive
                } else {
                    negative
                };
                Some(format!("{axis} points {word}"))
            });
        known.collect::<Vec<_>>().join(", ")
    }
}

fn sign(value: f64) -> Option<f64> {
    (value != 0.0).then(|| value.signum())
}

/// The wheel against the mean of the points on the body.
fn outboard(topology: &'static Topology, points: &[(&'static str, [f64; 3])]) -> Option<f64> {
    let names: Vec<&'static str> = points.iter().map(|(name, _)| *name).collect();
    let required = topology.hardpoints.iter().filter(|h| h.required);
    if !required.into_iter().all(|h| names.contains(&h.name)) {
        return None;
    }
    let mechanism = (topology.build)(topology, &names);
    let body = |name: &str| mechanism.point(name).map(|id| mechanism.body(id));
    let inboard: Vec<f64> = points
        .iter()
        .filter(|(name, _)| matches!(body(name), Some(Body::Chassis | Body::Rack)))
        .map(|(_, position)| position[1])
        .collect();
    let (_, wheel) = points.iter().find(|(name, _)| *name == "wheel_centre")?;
    sign(wheel[1] - inboard.iter().sum::<f64>() / inboard.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::Study;
    use std::path::Path;

    /// Every template, in every convention and on both sides.
    #[test]
    fn the_axes_of_every_template_are_recognised() {
        for topology in Topology::ALL {
            let study = Study::from_text("s.toml", topology.template, Path::new(".")).unwrap();
            let suspension = &study.suspension;
            for convention in FrameConvention::ALL {
                for side in Side::ALL {
                    let frame = Frame::new(convention, side);
                    let names = topology.all_hardpoints().map(|h| h.name);
                    let points: Vec<_> = names
                        .filter_map(|name| {
                            let id = suspension.mechanism.point(name)?;
                            Some((name, frame.vector(suspension.design[id.0]).to_array()))
                        })
                        .collect();
                    let allowed = Directions::of(topology, &points).allowed();
                    assert_eq!(allowed, [(convention, side)], "{}", topology.name);
                }
            }
        }
    }
}
