//! Solves station by station outward from the design position, and returns the knuckle pose in the engine's form.

use super::knuckle::KnuckleRotation;
use super::{PointCoordinates, Pose, Rates, Refusal, Station};
use hardpoint_engine::mechanism;
use hardpoint_engine::number::Jet;
use hardpoint_engine::number::{Matrix3, Vector3};

impl PointCoordinates {
    /// Returns the pose with the drive at its design value and the rack displaced.
    pub fn placed(&self, rack: f64) -> Result<Pose, Refusal> {
        let design = self.design();
        let to = Station {
            rack,
            ..design.station()
        };
        self.track(&design, to).map_err(|refusal| match refusal {
            Refusal::Unreachable { limit, .. } => Refusal::RackUnreachable { limit },
            other => other,
        })
    }

    /// Visits the drive's values outward from `start`. The search for each pose starts from the previous pose on the same
    /// side. `visit` receives the index of the value, and its pose or the reason why it has no pose.
    ///
    /// The order uses the form in which the value enters the drive's equation: the cosine for the paper's angle. So values on
    /// both sides of a dead centre are visited in the order of the arm's positions.
    pub fn for_each_pose(
        &self,
        start: &Pose,
        values: &[f64],
        visit: &mut dyn FnMut(usize, Result<&Pose, Refusal>),
    ) {
        let Station { value, rack } = start.station();
        let parameter = |value: f64| self.driving.parameter(value);
        let distance = |i: &usize| parameter(values[*i]) - parameter(value);
        let mut sides: [Vec<usize>; 2] = (0..values.len()).partition(|i| distance(i) >= 0.0).into();
        for side in &mut sides {
            side.sort_by(|a, b| distance(a).abs().total_cmp(&distance(b).abs()));
            let mut last = Ok(*start);
            for &mut station in side {
                let to = Station {
                    value: values[station],
                    rack,
                };
                last = last.and_then(|from| self.track(&from, to));
                visit(station, last.as_ref().map_err(|refusal| *refusal));
            }
        }
    }

    /// Returns the pose of the knuckle as a Taylor series along the motion with these rates. The origin of the pose is the
    /// ball joint. The series has `N` coefficients, at most three.
    pub fn knuckle_pose<const N: usize>(
        &self,
        pose: &Pose,
        rates: Rates,
    ) -> Result<mechanism::Pose<Jet<f64, N>>, Refusal> {
        debug_assert!(N <= 3, "the paper's equations give two derivatives");
        let still = [Vector3::new(0.0, 0.0, 0.0); 5];
        let [velocity, acceleration] = match N {
            1 => [still; 2],
            _ => {
                let motion = self.motion(pose, rates)?;
                [motion.velocity, motion.acceleration]
            }
        };
        let orders = [*pose.moving(), velocity, acceleration.map(|a| a * 0.5)];
        let rotation = KnuckleRotation::new(self.design().moving())
            .expect("the points of the knuckle span a volume");
        let rotations = orders.map(|points| rotation.of(&points));
        let series = |coefficient: [Vector3<f64>; 3]| {
            let along = |of: fn(&Vector3<f64>) -> f64| {
                Jet(std::array::from_fn(|k| coefficient.get(k).map_or(0.0, of)))
            };
            Vector3::new(along(|v| v.x), along(|v| v.y), along(|v| v.z))
        };
        Ok(mechanism::Pose {
            origin: series(orders.map(|points| points[0])),
            rotation: Matrix3 {
                columns: [0, 1, 2].map(|k| series(rotations.map(|columns| columns[k]))),
            },
        })
    }
}
