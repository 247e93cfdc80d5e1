//! The poses of a single design, which fills the lanes with itself.

use super::{Acceptance, Batch, LanePose, Rejection, Visit};
use crate::mechanism::Pose;
use crate::model::{Drive, Mechanism};
use crate::number::{MOST_LANES, Matrix3, SimdReal, SimdTask, Vector3, Width};
use crate::solve::StationOrder;

/// Ways that are kept, each for a drive, a rack and an order of stations.
const MOST_KEPT: usize = 32;

/// Tracks one design after another of a mechanism.
#[derive(Clone, Debug)]
pub(crate) struct PoseTracker<'m> {
    mechanism: &'m Mechanism,
    /// Designs are taken to be near this one.
    base: Vec<Vector3<f64>>,
    width: Width,
    ways: Vec<Way<'m>>,
}

/// The way through the stations.
#[derive(Clone, Debug)]
struct Way<'m> {
    drive: Drive,
    rack: f64,
    values: Vec<f64>,
    /// None where the mechanism cannot be tracked.
    batch: Option<Batch<'m>>,
}

/// What the tracker makes of a design.
#[derive(Clone, Debug, Default)]
pub(crate) struct TrackedPoses {
    /// By station.
    pub poses: Vec<Result<Pose<f64>, Rejection>>,
    /// Rounds of corrections.
    pub rounds: u64,
}

impl TrackedPoses {
    /// Of nothing tracked yet.
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
            width: Width::widest(),
            ways: Vec::new(),
        }
    }

    /// Finds the poses of a design at every station, as far as the guards let pass; `found` has been cleared.
    pub(crate) fn track(
        &mut self,
        design: &[Vector3<f64>],
        drive: Drive,
        station_order: &StationOrder,
        rack: f64,
        found: &mut TrackedPoses,
    ) {
        let values = station_order.values();
        let is_way = |w: &Way| w.drive == drive && w.rack == rack && w.values == values;
        let number = match self.ways.iter().position(is_way) {
            Some(number) => number,
            None => {
                if self.ways.len() == MOST_KEPT {
                    self.ways.remove(0);
                }
                self.ways.push(Way {
                    drive,
                    rack,
                    values: values.to_vec(),
                    batch: Batch::new(self.mechanism, &self.base, drive, station_order, &[rack]),
                });
                self.ways.len() - 1
            }
        };
        if let Some(batch) = &self.ways[number].batch {
            self.width.run(Tracking {
                batch,
                design,
                rack,
                station_order,
                found,
            });
        }
    }
}

struct Tracking<'t, 'm> {
    batch: &'t Batch<'m>,
    design: &'t [Vector3<f64>],
    rack: f64,
    station_order: &'t StationOrder,
    found: &'t mut TrackedPoses,
}

impl SimdTask for Tracking<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<B: SimdReal>(self, like: B) {
        let mut points = Vec::with_capacity(self.design.len());
        for point in self.design {
            points.push(Vector3::new(
                like.lit(point.x),
                like.lit(point.y),
                like.lit(point.z),
            ));
        }
        let design = self.batch.design(&points);
        let mut history = self.batch.history(like);
        let mut collecting = Collecting {
            rack: like.lit(self.rack),
            poses: &mut self.found.poses,
        };
        let tracked = self.batch.solve(&design, 0, &mut history, &mut collecting);
        self.found.rounds = tracked.rounds;
        // Where a leg has come to its end before a station, the reason is that of the leg.
        for (side, leg) in self.station_order.sides().into_iter().zip(tracked.legs) {
            if let Some(reason) = leg.reasons()[0] {
                for station in side {
                    let pose = &mut self.found.poses[*station];
                    if *pose == Err(Rejection::NotOnTheWay) {
                        *pose = Err(reason);
                    }
                }
            }
        }
    }
}

struct Collecting<'t, B> {
    rack: B,
    poses: &'t mut [Result<Pose<f64>, Rejection>],
}

impl<B: SimdReal> Visit<B> for Collecting<'_, B> {
    #[inline(always)]
    fn pose(&mut self, station: usize, at: &impl LanePose<B>, accepted: Acceptance<B>) {
        if !B::any(accepted.lanes()) {
            return;
        }
        let Pose { origin, rotation } = at.configuration(self.rack).pose;
        let [x, y, z] = rotation.columns;
        self.poses[station] = Ok(Pose {
            origin: first(origin),
            rotation: Matrix3 {
                columns: [first(x), first(y), first(z)],
            },
        });
    }
}

/// What the first lane holds.
#[inline(always)]
fn first<B: SimdReal>(vector: Vector3<B>) -> Vector3<f64> {
    let mut lanes = [[0.0; MOST_LANES]; 3];
    vector.x.store(&mut lanes[0]);
    vector.y.store(&mut lanes[1]);
    vector.z.store(&mut lanes[2]);
    Vector3::new(lanes[0][0], lanes[1][0], lanes[2][0])
}
