//! The mechanism as a drawing: points by name, and the lines between them.
//!
//! Positions along the motion come from [`crate::curves::frames`].

use crate::axle::Axle;
use crate::model::{
    Axis, Body, Constraint, Mechanism, PointId, RockerId, Rod, Side, Suspension, TwistBeam,
};
use serde::{Deserialize, Serialize};

/// Parts of the drawing that do not change while the mechanism moves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// Name of each point.
    pub points: Vec<String>,
    /// Bodies between the points.
    pub bodies: Vec<SceneBody>,
    /// Index of the wheel's centre.
    pub wheel_centre: usize,
    /// Loaded radius of the wheel in the study's length unit, if it is known.
    pub wheel_radius: Option<f64>,
    /// Signs of the study's axes x, y and z: 1 if the axis points forward, outboard or up, and -1 if it points the other way.
    /// Outboard refers to the wheel of the study, or to the left wheel of an axle.
    pub signs: [f64; 3],
    /// For an axle: index of the right wheel's centre. The points and bodies of the right wheel follow those of the left wheel.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub right_wheel_centre: Option<usize>,
}

/// Direction of sight on the drawing of a mechanism.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sight {
    /// From the front: the car's left is on the right.
    Front,
    /// From the side, with the wheel in front. Forward is to the left for a left wheel or an axle, and to the right for a right
    /// wheel.
    Side,
    /// From above: forward is up, and the car's left is on the left.
    Top,
}

impl Sight {
    /// All three views, in the order of an engineering drawing.
    pub(super) const ALL: [Sight; 3] = [Sight::Front, Sight::Side, Sight::Top];

    pub(super) fn title(self) -> &'static str {
        match self {
            Sight::Front => "front view",
            Sight::Side => "side view",
            Sight::Top => "top view",
        }
    }
}

/// A body of the drawing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SceneBody {
    /// Name of the body: `lower arm`, `tie rod`, `wheel carrier`.
    pub name: String,
    /// Kind of the body.
    pub kind: BodyKind,
    /// Lines of the body, at least one. Each line has the indices of the points through which it runs, in order.
    pub lines: Vec<Vec<usize>>,
}

/// Kind of a body in the drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BodyKind {
    /// A control arm.
    Arm,
    /// A link, tie rod, pushrod, pullrod or drop link.
    Link,
    /// A strut.
    Strut,
    /// A spring outside of a strut.
    Spring,
    /// A rocker, or the lever of an anti-roll bar.
    Rocker,
    /// The wheel carrier, or a knuckle of a steered solid axle.
    Knuckle,
}

impl BodyKind {
    /// CSS class of the lines of a body in a picture.
    pub(super) fn class(self) -> &'static str {
        match self {
            BodyKind::Arm => "arm",
            BodyKind::Link => "link",
            BodyKind::Strut => "strut",
            BodyKind::Spring => "spring",
            BodyKind::Rocker => "rocker",
            BodyKind::Knuckle => "knuckle",
        }
    }
}

impl Scene {
    /// Drawing of a suspension.
    pub fn of(suspension: &Suspension) -> Scene {
        let mechanism = &suspension.mechanism;
        let sign = |axis| suspension.frame.sign(axis);
        Scene {
            points: mechanism.points.iter().map(|p| p.name.clone()).collect(),
            bodies: bodies(mechanism),
            wheel_centre: mechanism.wheel_centre.0,
            wheel_radius: suspension.wheel_radius,
            signs: Axis::ALL.map(sign),
            right_wheel_centre: None,
        }
    }

    /// Axes of the study along the directions right and up of a view. Each has the index of the axis, and 1 if the axis points that
    /// way or -1 if it points the opposite way.
    pub(super) fn axes(&self, sight: Sight) -> [(usize, f64); 2] {
        let [forward, outboard, up] = self.signs;
        // Sign of the car's left along the study's lateral axis. It follows from the other two axes, because both frames
        // are right-handed. For a right wheel, the car's left is inboard.
        let left = forward * up;
        match sight {
            Sight::Front => [(1, left), (2, up)],
            Sight::Side => [(0, -forward * left * outboard), (2, up)],
            Sight::Top => [(1, -left), (0, forward)],
        }
    }

    /// Drawing of an axle. The names of points begin with `left_` or `right_`.
    pub fn of_axle(axle: &Axle) -> Scene {
        let mut scene = Scene::of(&axle.left);
        let right = Scene::of(axle.suspension(Side::Right));
        let first = scene.points.len();
        scene.right_wheel_centre = Some(first + right.wheel_centre);
        let named = |side: Side, name: &String| format!("{}_{name}", side.name());
        let lefts = scene.points.iter().map(|name| named(Side::Left, name));
        let rights = right.points.iter().map(|name| named(Side::Right, name));
        scene.points = lefts.chain(rights).collect();
        for mut body in right.bodies {
            for line in &mut body.lines {
                line.iter_mut().for_each(|point| *point += first);
            }
            scene.bodies.push(body);
        }
        scene
    }
}

/// Half of a twist beam that carries one wheel: arm, half of the cross member, and spring.
fn half_beam(mechanism: &Mechanism, beam: &TwistBeam) -> Vec<SceneBody> {
    let body = |name: &str, kind, line: &[PointId]| SceneBody {
        name: name.to_owned(),
        kind,
        lines: vec![line.iter().map(|id| id.0).collect()],
    };
    let arm = [
        beam.mount,
        mechanism.wheel_centre,
        beam.shear_centre,
        beam.mount,
    ];
    let mut bodies = vec![body("twist beam", BodyKind::Arm, &arm)];
    bodies.extend(
        mechanism
            .spring
            .map(|spring| body("spring", BodyKind::Spring, &[spring.lower, spring.upper])),
    );
    bodies
}

/// Bodies of a mechanism, from its constraints and arms.
fn bodies(mechanism: &Mechanism) -> Vec<SceneBody> {
    let rigid = mechanism.rigid_axle.as_ref();
    if let Some(beam) = rigid.and_then(|rigid| rigid.twist_beam.as_ref()) {
        return half_beam(mechanism, beam);
    }
    let mut parts = Parts::default();
    parts.arms(mechanism);
    parts.constraints(mechanism);
    for [inner, outer] in rigid.iter().flat_map(|rigid| &rigid.extra_links) {
        let name = body_name(mechanism.name(*inner));
        parts.add(BodyKind::Link, name, &[&[*inner, *outer]]);
        parts.joints.push(*outer);
    }
    if let Some(spring) = mechanism.spring
        && parts.strut != Some((spring.upper, spring.lower))
    {
        let line = [spring.lower, spring.upper];
        parts.add(BodyKind::Spring, "spring".to_owned(), &[&line]);
    }
    for number in 0..mechanism.rockers.len() {
        parts.rocker(mechanism, RockerId(number));
    }
    parts.carrier(mechanism);
    parts.bodies
}

/// Bodies of a drawing that is being made, with the joints and the strut found so far.
#[derive(Default)]
struct Parts {
    bodies: Vec<SceneBody>,
    /// Joints on the wheel carrier.
    joints: Vec<PointId>,
    /// Upper and lower end of a strut.
    strut: Option<(PointId, PointId)>,
}

impl Parts {
    fn add(&mut self, kind: BodyKind, name: String, lines: &[&[PointId]]) {
        let line = |line: &&[PointId]| line.iter().map(|id| id.0).collect();
        self.bodies.push(SceneBody {
            name,
            kind,
            lines: lines.iter().map(line).collect(),
        });
    }

    /// Adds each arm as a line from its front pivot through its joints to its rear pivot.
    fn arms(&mut self, mechanism: &Mechanism) {
        for arm in &mechanism.arms {
            let constraints = mechanism.constraints.iter();
            let second = constraints.filter_map(|constraint| match *constraint {
                Constraint::ArmJoint { arm: of, at } if mechanism.arms[of.0] == *arm => Some(at),
                _ => None,
            });
            let mut line = vec![arm.front, arm.outer];
            line.extend(second);
            line.push(arm.rear);
            let name = body_name(mechanism.name(arm.front));
            self.add(BodyKind::Arm, name, &[&line]);
        }
    }

    /// Adds links and struts, and collects the joints on the wheel carrier.
    fn constraints(&mut self, mechanism: &Mechanism) {
        let of_an_arm = |from, to| {
            let mut arms = mechanism.arms.iter();
            arms.any(|arm| arm.outer == to && (arm.front == from || arm.rear == from))
        };
        for constraint in &mechanism.constraints {
            match *constraint {
                Constraint::Link { inner, outer } => {
                    if !of_an_arm(inner, outer) {
                        let name = body_name(mechanism.name(inner));
                        self.add(BodyKind::Link, name, &[&[inner, outer]]);
                    }
                    self.joints.push(outer);
                }
                Constraint::StrutLine { top, lower, upper } => {
                    let line: Vec<PointId> =
                        [lower].into_iter().chain(upper).chain([top]).collect();
                    self.add(BodyKind::Strut, "strut".to_owned(), &[&line]);
                    self.strut = Some((top, lower));
                    self.joints.push(lower);
                }
                Constraint::BallJoint { at } | Constraint::ArmJoint { at, .. } => {
                    self.joints.push(at);
                }
                // In a hinged mechanism, the arm itself is the knuckle.
                Constraint::Mount { .. }
                | Constraint::Revolute { .. }
                | Constraint::AxleTravel { .. } => {}
            }
        }
    }

    /// Adds the rod of a rocker, and the rocker as a line through its axis and all points on it.
    fn rocker(&mut self, mechanism: &Mechanism, id: RockerId) {
        let rocker = mechanism.rocker(id);
        let rod = [rocker.inner, rocker.outer];
        self.add(BodyKind::Link, rocker.rod.to_string(), &[&rod]);
        let spring_end = mechanism.spring.map(|spring| spring.lower);
        let far_centre = mechanism.rigid_axle.as_ref().map(|rigid| rigid.far_centre);
        let links = mechanism.constraints.iter().filter_map(Constraint::link);
        let further = spring_end
            .into_iter()
            .chain(mechanism.rockers.iter().map(|r| r.outer))
            .chain([mechanism.wheel_centre])
            .chain(far_centre)
            .chain(links.flat_map(|(inner, outer)| [inner, outer]));
        let mut through = vec![rocker.first, rocker.inner];
        through.extend(further.filter(|point| mechanism.body(*point) == Body::Rocker(id)));
        through.extend([rocker.second, rocker.first]);
        let name = rocker.rod.turns().trim_start_matches("the ").to_owned();
        let kind = match rocker.rod {
            Rod::DragLink | Rod::TieRod => BodyKind::Knuckle,
            _ => BodyKind::Rocker,
        };
        self.add(kind, name, &[&through]);
        if kind == BodyKind::Knuckle {
            self.joints.extend([rocker.first, rocker.second]);
        }
        if mechanism.body(rocker.outer) == Body::Knuckle {
            self.joints.push(rocker.outer);
        }
    }

    /// Adds the wheel carrier: a line from each joint to the wheel centre. On a steered solid axle, the lines lead to the origin of
    /// the mechanism instead, because its wheels are on knuckles.
    fn carrier(&mut self, mechanism: &Mechanism) {
        let centre = match mechanism.axle_steering() {
            Some(_) => mechanism.origin,
            None => mechanism.wheel_centre,
        };
        let mut joints = std::mem::take(&mut self.joints);
        joints.sort();
        joints.dedup();
        joints.retain(|joint| mechanism.body(*joint) == Body::Knuckle && *joint != centre);
        let spokes: Vec<[PointId; 2]> = joints.iter().map(|joint| [*joint, centre]).collect();
        if !spokes.is_empty() {
            let lines: Vec<&[PointId]> = spokes.iter().map(|s| s.as_slice()).collect();
            self.add(BodyKind::Knuckle, "wheel carrier".to_owned(), &lines);
        }
    }
}

/// Name of the body of a point: `lower_arm_front` is on the `lower arm`, `tie_rod_inner` on the `tie rod`.
fn body_name(point: &str) -> String {
    let ends = ["_front", "_rear", "_inner", "_outer", "_pivot"];
    let mut name = point;
    while let Some(shorter) = ends.iter().find_map(|end| name.strip_suffix(end)) {
        name = shorter;
    }
    name.replace('_', " ")
}
