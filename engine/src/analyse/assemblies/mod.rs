//! All assemblies of a design: every pose at a given travel that the lengths of the design allow, on any solution
//! branch.
//!
//! For these kinds of mechanisms there is a complete method, which cannot miss an assembly:
//!
//! - [`arm`]: strut and double wishbone, by a closed form. Interval arithmetic searches one rotation of the lower arm,
//!   for each side of the upper end and of the tie rod.
//! - [`hinge`]: a semi-trailing arm. The assemblies are at most two points of a circle.
//! - [`rods`]: a knuckle on five rods. Interval arithmetic searches all rotations.
//!
//! Newton's method on the closure equations makes each assembly more accurate. A certificate bounds the error of each
//! assembly.

mod arm;
mod hinge;
mod rods;

use super::certificate::{Certificate, Certifier};
use crate::derive::MotionPoint;
use crate::mechanism::{Configuration, Pose};
use crate::model::{Arm, Constraint, Drive, Mechanism};
use crate::number::Vector3;
use crate::number::{Each, Interval};
use crate::solve::closed_form::Circle;
use crate::solve::closed_form::Roles;
use crate::solve::{Solver, StationOrder};
use crate::sorting::sort_by;
use std::ops::ControlFlow;

/// One assembly of a design.
#[derive(Clone, Debug, PartialEq)]
pub struct Assembly {
    /// Pose of the knuckle.
    pub pose: Pose<f64>,
    /// Angle of the first arm from the design position, in radians. A positive angle raises the arm's outer joint.
    /// `None` if there is no arm.
    pub arm_angle: Option<f64>,
    /// For each of the features in [`Assemblies::traits`], true if the assembly has the same variant as the design
    /// position. `None` for the determinant in a singular pose.
    pub branch: Vec<Option<bool>>,
    /// Position of the wheel centre.
    pub wheel_centre: Vector3<f64>,
    /// Certificate of the pose. `None` if the pose is singular in double precision.
    pub certificate: Option<Certificate>,
}

/// Feature by which assemblies are distinguished. It has two variants. Each assembly has one of the variants, or is at
/// the border between them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AssemblyMode {
    /// Position of a strut's mount: above or below the foot of the perpendicular from the ball joint to the strut's
    /// axis.
    Strut,
    /// Side of the upper arm on which the steering axis is, seen along the arm's axis.
    UpperArm,
    /// Side of the plane through steering axis and rack joint on which the tie rod's end is.
    TieRod,
    /// Direction of motion of an arm's end on a hinge, up or down, while the arm's angle increases.
    Arm,
    /// Sign of the determinant of the closure equations.
    Determinant,
}

impl AssemblyMode {
    /// Name of the feature in tables.
    pub fn name(self) -> &'static str {
        match self {
            AssemblyMode::Strut => "strut",
            AssemblyMode::UpperArm => "upper_arm",
            AssemblyMode::TieRod => "tie_rod",
            AssemblyMode::Arm => "arm",
            AssemblyMode::Determinant => "determinant",
        }
    }

    /// Word for a variant of the feature: the variant of the design position if `as_designed` is true, otherwise the
    /// other variant.
    pub fn word(self, as_designed: bool) -> &'static str {
        match (self, as_designed) {
            (AssemblyMode::Strut, true) => "upright",
            (AssemblyMode::Strut, false) => "inverted",
            (AssemblyMode::Determinant, false) => "reversed",
            (_, true) => "as designed",
            (_, false) => "across",
        }
    }
}

/// Assemblies that were found at one travel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Assemblies {
    /// Features by which assemblies of this mechanism are distinguished.
    pub traits: Vec<AssemblyMode>,
    /// Assemblies, ordered by the arm angle. Without an arm, they are ordered by the rotation from the design position.
    pub found: Vec<Assembly>,
    /// Possible further assemblies that the search could not confirm or exclude. They occur in degenerate designs, and
    /// if a search takes too long.
    pub undecided: Vec<Undecided>,
    /// Number of pieces of the arm's rotation, or of boxes of poses, that the search has examined. 0 for an arm on a
    /// hinge.
    pub looked_at: usize,
}

/// Region with a possible assembly that the search could not confirm or exclude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Undecided {
    /// Between two angles of the first arm (radians).
    ArmAngle(f64, f64),
    /// Near a pose.
    Pose(Pose<f64>),
    /// Approximate fraction of all rotations of the knuckle that was not searched, because a complete search would take
    /// too long.
    Rotations(f64),
}

/// Number of starting points for Newton's method. The search uses them if the exact method has left a region undecided.
const TRIES: usize = 400;
/// Largest distance, relative to the mechanism's size, at which an assembly without certificate counts as equal to another one.
/// The two are then a double assembly. The error of its position is the square root of the rounding error.
const DOUBLE: f64 = 1e-5;
/// Largest number of undecided regions in the result.
const MOST_UNDECIDED: usize = 64;

/// Merges overlapping ranges of the arm's angle, and keeps at most [`MOST_UNDECIDED`] regions. The fraction of the rotations
/// that was not searched comes first, so this limit never removes it.
fn merge(undecided: &mut Vec<Undecided>) {
    let mut ranges: Vec<(f64, f64)> = Vec::new();
    let (mut unsearched, mut poses) = (Vec::new(), Vec::new());
    for place in undecided.drain(..) {
        match place {
            Undecided::Rotations(_) => unsearched.push(place),
            Undecided::ArmAngle(low, high) => ranges.push((low, high)),
            Undecided::Pose(_) => poses.push(place),
        }
    }
    undecided.append(&mut unsearched);
    sort_by(&mut ranges, |a, b| a.0.total_cmp(&b.0));
    for (low, high) in ranges {
        match undecided.last_mut() {
            Some(Undecided::ArmAngle(_, end)) if low <= *end => *end = end.max(high),
            _ => undecided.push(Undecided::ArmAngle(low, high)),
        }
    }
    undecided.append(&mut poses);
    undecided.truncate(MOST_UNDECIDED);
}

impl Assembly {
    /// Angle of the knuckle's rotation from the design position (radians, 0 to pi).
    pub fn turn(&self) -> f64 {
        let [a, b, c] = self.pose.rotation.columns;
        let twice_sine = Vector3::new(b.z - c.y, c.x - a.z, a.y - b.x).norm();
        twice_sine.atan2(a.x + b.y + c.z - 1.0)
    }
}

impl Solver<'_> {
    /// Returns every assembly that the lengths of the design allow at a wheel travel. The rack is displaced by `rack`
    /// (towards the kernel's +y). `None` for a mechanism without a complete method.
    pub fn assemblies(&self, travel: f64, rack: f64) -> Option<Assemblies> {
        let mut search = Search::new(self, travel, rack);
        // First add the assembly that is connected to the design position. Then the result contains this assembly even
        // if the search fails.
        search.take_connected();
        let mechanism = self.mechanism();
        match (Roles::of(mechanism), mechanism.constraints.as_slice()) {
            (Some(roles), _) => search.by_arm(&roles),
            (None, [Constraint::Revolute { .. }]) => search.by_hinge(),
            _ => search.by_rods()?,
        }
        if !search.all.undecided.is_empty() {
            search.try_others();
        }
        let mut all = search.all;
        merge(&mut all.undecided);
        let place = |a: &Assembly| a.arm_angle.unwrap_or_else(|| a.turn());
        sort_by(&mut all.found, |a, b| place(a).total_cmp(&place(b)));
        Some(all)
    }
}

/// Returns the features by which assemblies of a mechanism are distinguished.
fn traits(mechanism: &Mechanism) -> Vec<AssemblyMode> {
    match (Roles::of(mechanism), mechanism.constraints.as_slice()) {
        (Some(roles), _) if roles.is_strut() => vec![AssemblyMode::Strut, AssemblyMode::TieRod],
        (Some(_), _) => vec![AssemblyMode::UpperArm, AssemblyMode::TieRod],
        (None, [Constraint::Revolute { .. }]) => vec![AssemblyMode::Arm],
        _ => vec![AssemblyMode::Determinant],
    }
}

/// Search for the assemblies of one design at one travel, with the assemblies found so far.
struct Search<'a> {
    solver: &'a Solver<'a>,
    certifier: Certifier<'a>,
    point: MotionPoint<f64>,
    /// Design points as exact intervals: their width is zero.
    exact: Vec<Vector3<Interval>>,
    all: Assemblies,
}

impl<'a> Search<'a> {
    fn new(solver: &'a Solver<'a>, travel: f64, rack: f64) -> Self {
        let design = solver.design();
        Search {
            solver,
            certifier: Certifier::new(solver.mechanism(), design),
            point: MotionPoint {
                drive: Drive::Travel,
                value: travel,
                rack,
            },
            exact: design.iter().map(|p| p.map(Interval::point)).collect(),
            all: Assemblies {
                traits: traits(solver.mechanism()),
                ..Assemblies::default()
            },
        }
    }

    /// Adds the assembly that is connected to the design position, if there is one.
    fn take_connected(&mut self) {
        let (mechanism, design) = (self.solver.mechanism(), self.solver.design());
        let Ok(mut walker) = Solver::new(mechanism, design) else {
            return;
        };
        let mut connected = None;
        let stations = StationOrder::through(&[self.point.value]);
        let walked =
            walker.for_each_pose(Drive::Travel, &stations, self.point.rack, |_, _, pose| {
                connected = pose.ok().copied();
                ControlFlow::Continue(())
            });
        let near = connected.filter(|_| walked.is_ok());
        if let Some(assembly) = near.and_then(|near| self.assembly(&near)) {
            self.add(assembly);
        }
    }

    /// Starts Newton's method from the undecided poses, and from rotations of every direction and angle. This search
    /// often finds poses that the exact search left undecided. It cannot exclude further poses.
    fn try_others(&mut self) {
        let design = self.solver.design_pose();
        let starts: Vec<Pose<f64>> = self
            .all
            .undecided
            .iter()
            .filter_map(|undecided| match undecided {
                Undecided::Pose(pose) => Some(*pose),
                _ => None,
            })
            .collect();
        let turns = (0..TRIES).map(|k| {
            // The axes of rotation are distributed evenly over the sphere by the golden angle. Each axis has several
            // angles of rotation.
            let k = k as f64 + 0.5;
            let (height, around) = (1.0 - 2.0 * k / TRIES as f64, k * 2.399_963_229_728_653);
            let level = (1.0 - height * height).sqrt();
            let axis = Vector3::new(level * around.cos(), level * around.sin(), height);
            let turn = (k * 0.618_033_988_749_895).fract() * std::f64::consts::PI;
            design.moved(Vector3::default(), axis * (0.5 * turn).tan())
        });
        for start in starts.into_iter().chain(turns) {
            // A design with a free rotation has infinitely many assemblies. None of these assemblies can be certified.
            let found = self.assembly(&start);
            if let Some(assembly) = found.filter(|a| a.certificate.is_some()) {
                self.add(assembly);
            }
        }
    }

    /// Returns the assembly that Newton's method reaches from a pose. The method may also stop near a pose that almost
    /// satisfies the equations. So a result without certificate must at least satisfy the equations.
    fn assembly(&self, near: &Pose<f64>) -> Option<Assembly> {
        let pose = self.solver.polished(near, &self.point)?;
        let certificate = self.certifier.pose(&pose, &self.point).ok();
        if certificate.is_none() && !self.solver.closes(&pose, &self.point) {
            return None;
        }
        let at = self.solver.configuration(&pose, self.point.rack);
        let mechanism = self.solver.mechanism();
        let angle = mechanism.arms.first().map(|arm| {
            let circle = Circle::of(*arm, self.solver.design());
            circle.angle(at.point(arm.outer))
        });
        Some(Assembly {
            pose,
            arm_angle: angle,
            branch: self.branch(&at),
            wheel_centre: at.point(mechanism.wheel_centre),
            certificate,
        })
    }

    /// Returns, for each feature of the mechanism, true if a pose has the same variant as the design position, and
    /// false if it has the other variant. `None` if [`Search::sign`] is `None` for one of the poses.
    fn branch(&self, now: &Configuration<f64>) -> Vec<Option<bool>> {
        let start = self.solver.design_pose();
        let design = self.solver.configuration(&start, 0.0);
        let alike = |what: &AssemblyMode| {
            let (sign, designed) = (self.sign(*what, now)?, self.sign(*what, &design)?);
            Some((sign < 0.0) == (designed < 0.0))
        };
        self.all.traits.iter().map(alike).collect()
    }

    /// Returns a number whose sign distinguishes the two variants of the feature `of`. `None` if the mechanism does not
    /// have this feature, or if the equations cannot be factorised in this pose.
    fn sign(&self, of: AssemblyMode, at: &Configuration<f64>) -> Option<f64> {
        let mechanism = self.solver.mechanism();
        let roles = Roles::of(mechanism);
        let steering_axis =
            |roles: &Roles| at.point(roles.upper_end()) - at.point(roles.ball_joint());
        match of {
            AssemblyMode::Strut => {
                let line = roles?.strut_line(self.solver.design())?;
                Some(at.pose.rotation.apply(line).dot(steering_axis(&roles?)))
            }
            AssemblyMode::UpperArm => {
                Some(velocity(at, mechanism.arms.get(1)?).dot(steering_axis(&roles?)))
            }
            AssemblyMode::TieRod => {
                let from = at.point(roles?.ball_joint());
                let [inner, outer] = roles?.tie_rod().each(|id| at.point(id) - from);
                Some(outer.dot(steering_axis(&roles?).cross(inner)))
            }
            AssemblyMode::Arm => Some(velocity(at, mechanism.arms.first()?).z),
            AssemblyMode::Determinant => {
                let lu = self.solver.factorise(&at.pose, &self.point)?;
                Some(lu.determinant())
            }
        }
    }

    /// Adds an assembly, unless it was already found, for example from the other side of a toggle.
    fn add(&mut self, assembly: Assembly) {
        if self.is_settled(&assembly.pose.map(Interval::point)) {
            return;
        }
        let size = self.solver.size();
        let known = self.all.found.iter_mut().find(|a| {
            let unproved = a.certificate.is_none() || assembly.certificate.is_none();
            unproved && pose_distance(&a.pose, &assembly.pose, size) < DOUBLE * size
        });
        match known {
            Some(known) if known.certificate.is_none() => *known = assembly,
            Some(_) => (),
            None => self.all.found.push(assembly),
        }
    }

    /// Returns true if all these poses are so close to one certified assembly that they contain no other assembly.
    fn is_settled(&self, poses: &Pose<Interval>) -> bool {
        self.all.found.iter().any(|assembly| {
            let Some(proof) = assembly.certificate else {
                return false;
            };
            let far = |a: Vector3<Interval>, b: Vector3<f64>| {
                let parts = (a - b.map(Interval::point)).to_array();
                parts
                    .each(Interval::magnitude)
                    .into_iter()
                    .fold(0.0, f64::max)
            };
            let turned = poses
                .rotation
                .columns
                .into_iter()
                .zip(assembly.pose.rotation.columns);
            let turned = turned.map(|(a, b)| far(a, b)).fold(0.0, f64::max);
            // The distance of the origins is a length. The difference of the rotation matrices' entries becomes a
            // length after multiplication by the scale.
            far(poses.origin, assembly.pose.origin) < proof.uniqueness
                && turned * proof.scale < proof.uniqueness
        })
    }
}

/// Velocity of an arm's outer joint for a rotation about the arm's axis, up to a positive factor.
fn velocity(at: &Configuration<f64>, arm: &Arm) -> Vector3<f64> {
    let from = at.point(arm.rear);
    (at.point(arm.front) - from).cross(at.point(arm.outer) - from)
}

/// Distance of two poses, as a length.
fn pose_distance(a: &Pose<f64>, b: &Pose<f64>, size: f64) -> f64 {
    let columns = a.rotation.columns.iter().zip(b.rotation.columns);
    let turned = columns.map(|(p, q)| (*p - q).norm()).fold(0.0, f64::max);
    (a.origin - b.origin).norm() + turned * size
}

#[cfg(test)]
mod tests {
    use super::{MOST_UNDECIDED, Undecided, merge};
    use crate::mechanism::Pose;
    use crate::number::{Matrix3, Vector3};

    /// Even if the search left very many poses undecided, the result states the fraction of the rotations that was not
    /// searched.
    #[test]
    fn a_search_that_stopped_early_is_said_to_be_one() {
        let pose = Undecided::Pose(Pose {
            origin: Vector3::default(),
            rotation: Matrix3::identity(1.0),
        });
        let mut undecided = vec![pose; MOST_UNDECIDED];
        undecided.push(Undecided::Rotations(0.25));
        merge(&mut undecided);
        assert_eq!(undecided.len(), MOST_UNDECIDED);
        assert_eq!(undecided[0], Undecided::Rotations(0.25));
    }
}
