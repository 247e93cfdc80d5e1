//! Measures of how far strut, upper arm and tie rod are from their singular positions. Each measure is the sine of an
//! angle, calculated from points alone.

use hardpoint::mechanism::{LimitCause, Pose};
use hardpoint::model::{Body, Mechanism};
use hardpoint::number::Vector3;

/// Points of a mechanism in a pose.
pub struct Points<'a> {
    pub mechanism: &'a Mechanism,
    pub design: &'a [Vector3<f64>],
    pub pose: Pose<f64>,
    pub rack: f64,
}

impl Points<'_> {
    /// Position of a point of the carrier, the rack or the body.
    pub fn at(&self, name: &str) -> Vector3<f64> {
        let id = self.mechanism.point(name).unwrap();
        let designed = self.design[id.0];
        match self.mechanism.points[id.0].body {
            Body::Chassis => designed,
            Body::Rack => designed + Vector3::new(0.0, self.rack, 0.0),
            _ => {
                let origin = self.design[self.mechanism.origin.0];
                self.pose.origin + self.pose.rotation.apply(designed - origin)
            }
        }
    }

    /// Causes of limits, each with the sine that measures the distance of the part from its singular position.
    pub fn measures(&self) -> Vec<(LimitCause, f64)> {
        let ball_joint = self.at("lower_ball_joint");
        let (upper, part) = if self.mechanism.point("strut_top").is_some() {
            let top = self.at("strut_top");
            let second = match self.mechanism.point("strut_upper") {
                Some(_) => self.at("strut_upper"),
                None => top,
            };
            let line = second - self.at("strut_lower");
            let axis = top - ball_joint;
            let sine = line.dot(axis) / (line.norm() * axis.norm());
            (top, (LimitCause::StrutSquare, sine))
        } else {
            let [front, rear, joint] = ["front", "rear", "joint"].map(|end| match end {
                "joint" => self.at("upper_ball_joint"),
                end => self.at(&format!("upper_arm_{end}")),
            });
            let axis = joint - ball_joint;
            let way = (front - rear).cross(joint - rear);
            let sine = way.dot(axis) / (way.norm() * axis.norm());
            (joint, (LimitCause::UpperArmStraight, sine))
        };
        let along = (upper - ball_joint) * (1.0 / (upper - ball_joint).norm());
        let [inner, outer] = ["inner", "outer"].map(|end| {
            let lever = self.at(&format!("tie_rod_{end}")) - ball_joint;
            lever - along * along.dot(lever)
        });
        let volume = along.dot(inner.cross(outer));
        let tie_rod = volume / (inner.norm() * outer.norm());
        vec![
            (part.0, part.1.abs()),
            (LimitCause::TieRodToggle, tie_rod.abs()),
        ]
    }
}
