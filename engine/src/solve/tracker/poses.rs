//! Tracks a single design with ordinary numbers instead of SIMD lanes. Lanes filled with copies of one design would be
//! no faster.

use super::{Acceptance, AdjointPose, CornerTracker, Rejection, Visit};
use crate::mechanism::Pose;
use crate::model::{Drive, Mechanism};
use crate::number::{Each, Matrix3, SimdReal, SimdTask, Vector3, run_one};
use crate::solve::StationOrder;

/// Largest number of routes that are kept, each for a drive, a rack displacement and an order of stations.
const MOST_KEPT: usize = 32;

/// Tracks the designs of a mechanism, one after another.
#[derive(Clone, Debug)]
pub(crate) struct PoseTracker<'m> {
    mechanism: &'m Mechanism,
    /// Design near which other designs are expected.
    base: Vec<Vector3<f64>>,
    prepared: Vec<PreparedBatch<'m>>,
    /// Buffer for the unknowns at all waypoints of a route: the stations, and the points that divide long steps.
    history: Vec<f64>,
}

/// A route through stations, prepared for one drive, rack displacement and list of values.
#[derive(Clone, Debug)]
struct PreparedBatch<'m> {
    drive: Drive,
    rack: f64,
    values: Vec<f64>,
    /// Tracker of the route. `None` if the mechanism cannot be tracked.
    tracker: Option<CornerTracker<'m>>,
}

/// Poses of a design that the tracker found.
#[derive(Clone, Debug, Default)]
pub(crate) struct TrackedPoses {
    /// Pose of each station, or the reason why the tracker has none.
    pub poses: Vec<Result<Pose<f64>, Rejection>>,
    /// Number of rounds of corrections by Newton's method, over all waypoints.
    pub rounds: u64,
}

impl TrackedPoses {
    /// Deletes all poses. All stations then count as not visited.
    pub(crate) fn clear(&mut self, station_order: &StationOrder) {
        self.poses.clear();
        let nowhere = Err(Rejection::NotOnTheWay);
        self.poses.resize(station_order.values().len(), nowhere);
        self.rounds = 0;
    }
}

impl<'m> PoseTracker<'m> {
    pub(crate) fn new(mechanism: &'m Mechanism, base: &[Vector3<f64>]) -> Self {
        PoseTracker {
            mechanism,
            base: base.to_vec(),
            prepared: Vec::new(),
            history: Vec::new(),
        }
    }

    /// Finds the poses of a design at every station, as far as the checks accept them. `found` must have been cleared.
    pub(crate) fn track(
        &mut self,
        design: &[Vector3<f64>],
        drive: Drive,
        station_order: &StationOrder,
        rack: f64,
        found: &mut TrackedPoses,
    ) {
        let values = station_order.values();
        let is_same = |w: &PreparedBatch| w.drive == drive && w.rack == rack && w.values == values;
        let number = match self.prepared.iter().position(is_same) {
            Some(number) => number,
            None => {
                if self.prepared.len() == MOST_KEPT {
                    self.prepared.remove(0);
                }
                self.prepared.push(PreparedBatch {
                    drive,
                    rack,
                    values: values.to_vec(),
                    tracker: CornerTracker::new(
                        self.mechanism,
                        &self.base,
                        drive,
                        station_order,
                        &[rack],
                    ),
                });
                self.prepared.len() - 1
            }
        };
        if let Some(tracker) = &self.prepared[number].tracker {
            self.history.clear();
            let legs = run_one(Tracking {
                tracker,
                design,
                number: 0,
                rack,
                into: &mut found.poses,
                history: &mut self.history,
                rounds: &mut found.rounds,
            });
            // For stations that a leg of the route did not reach, the reason is the one for which the leg ended.
            for (side, rejection) in station_order.sides().into_iter().zip(legs) {
                if let Some(reason) = rejection {
                    for station in side {
                        let pose = &mut found.poses[*station];
                        if *pose == Err(Rejection::NotOnTheWay) {
                            *pose = Err(reason);
                        }
                    }
                }
            }
        }
    }
}

impl CornerTracker<'_> {
    /// Tracks a single design with the rack at its `rack`-th displacement. Appends to `history` the unknowns that
    /// [`CornerTracker::visit_stations_in_lanes`] needs. Returns true if every station was accepted.
    pub(crate) fn track_one(
        &self,
        design: &[Vector3<f64>],
        rack: usize,
        history: &mut Vec<f64>,
    ) -> bool {
        let legs = run_one(Tracking {
            tracker: self,
            design,
            number: rack,
            rack: 0.0,
            into: &mut [],
            history,
            rounds: &mut 0,
        });
        legs == [None; 2]
    }
}

struct Tracking<'t, 'm> {
    tracker: &'t CornerTracker<'m>,
    design: &'t [Vector3<f64>],
    /// Index of this rack displacement in the tracker's list.
    number: usize,
    /// Rack displacement.
    rack: f64,
    /// Receives the poses by station. Empty if poses are not requested.
    into: &'t mut [Result<Pose<f64>, Rejection>],
    /// Receives the unknowns, waypoint by waypoint.
    history: &'t mut Vec<f64>,
    /// Receives the number of rounds of corrections.
    rounds: &'t mut u64,
}

impl SimdTask for Tracking<'_, '_> {
    /// Reasons why the tracker did not reach the last station, above the design position and below it.
    type Output = [Option<Rejection>; 2];

    #[inline(always)]
    fn run<B: SimdReal>(self, like: B) -> Self::Output {
        let mut points = Vec::with_capacity(self.design.len());
        for point in self.design {
            points.push(Vector3::new(
                like.constant(point.x),
                like.constant(point.y),
                like.constant(point.z),
            ));
        }
        let design = self.tracker.design(&points);
        let mut history = self.tracker.history(like);
        let mut collecting = Collecting {
            rack: like.constant(self.rack),
            poses: self.into,
        };
        let tracked = (self.tracker).solve(&design, self.number, &mut history, &mut collecting);
        *self.rounds = tracked.rounds;
        for unknown in &history[..self.tracker.steps(self.number)] {
            self.history.push(unknown.in_lane(0));
        }
        let [up, down] = tracked.legs;
        [up.reason(0), down.reason(0)]
    }
}

struct Collecting<'t, B> {
    rack: B,
    poses: &'t mut [Result<Pose<f64>, Rejection>],
}

impl<B: SimdReal> Visit<B> for Collecting<'_, B> {
    #[inline(always)]
    fn pose(&mut self, station: usize, at: &impl AdjointPose<B>, accepted: Acceptance<B>) {
        if self.poses.is_empty() || !B::any(accepted.lanes()) {
            return;
        }
        let Pose { origin, rotation } = at.configuration(self.rack).pose;
        self.poses[station] = Ok(Pose {
            origin: first_of(origin),
            rotation: Matrix3 {
                columns: rotation.columns.each(first_of),
            },
        });
    }
}

/// The first lane of each component.
#[inline(always)]
fn first_of<B: SimdReal>(vector: Vector3<B>) -> Vector3<f64> {
    vector.map(
        #[inline(always)]
        |number| number.in_lane(0),
    )
}
