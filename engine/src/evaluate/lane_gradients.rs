//! Gradients of several designs at a time, one in each SIMD lane.
//!
//! Programs that change many designs at once use this module, for example an optimisation from several starts. An
//! evaluation computes one of these results:
//!
//! - derivatives of quantities with respect to every hardpoint coordinate, or along directions that move several hardpoints,
//! - the sum of squared deviations over all stations, with its gradient.
//!
//! The sum costs one adjoint per pose. The derivatives cost one adjoint per pose and angle.
//!
//! The caller receives Jacobians pose by pose; the module does not store them. The Jacobian of four angles of a strut takes
//! 864 bytes per pose. Storing the Jacobians of a whole curve would take as long as computing them.

mod differentiate;
mod results;

use super::Stations;
use super::aligned::Aligned;
use super::lanes::{Visitor, gather};
use crate::characteristics::{Constants, LaneReader, Quantity};
use crate::model::{Drive, Suspension};
use crate::number::{MOST_LANES, SimdReal, SimdTask, Vector3, Width};
use crate::solve::{AlongTravel, CornerTracker};
pub(super) use differentiate::Differentiating;
use results::Found;
pub use results::{Deviations, Jacobians};

/// Target value of an angle (radians) at a station, with the weight of the squared deviation from it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AngleTarget {
    /// Target value of the angle.
    pub value: f64,
    /// Weight. 0 if the angle has no target.
    pub weight: f64,
}

/// Computes gradients with respect to every hardpoint coordinate, in the kernel's frame.
#[derive(Clone)]
pub struct Gradients<'a> {
    width: Width,
    batch: CornerTracker<'a>,
    reader: LaneReader<'a>,
    /// Equations for gradients of quantities that contain velocities. `None` if there are no such quantities.
    along_travel: Option<AlongTravel>,
    stations: Stations,
    accepted: [bool; MOST_LANES],
    found: Found,
    /// Directions in which hardpoints move, given for a single design and copied to every lane.
    spread: Vec<f64>,
    /// Unknowns of the pose of a single design, for every pose that the tracker visits, in the order of the visits.
    history: Vec<f64>,
}

impl<'a> Gradients<'a> {
    /// Prepares gradients of these quantities. Returns `None` if a quantity or the mechanism cannot be differentiated
    /// in lanes ([`LaneReader::has_gradients`]), if the drive is not the travel, or if the tracker does not support every
    /// station.
    pub fn new(
        suspension: &'a Suspension,
        stations: &Stations,
        quantities: &[Quantity],
        width: Width,
    ) -> Option<Self> {
        let (mechanism, design) = (&suspension.mechanism, &suspension.design);
        let (drive, racks) = (stations.drive, &stations.racks);
        (drive == Drive::Travel).then_some(())?;
        let batch = CornerTracker::new(mechanism, design, drive, &stations.station_order, racks)?;
        batch.is_complete().then_some(())?;
        let constants = Constants::of(suspension);
        let reader = LaneReader::new(mechanism, &batch, constants, quantities.to_vec())?;
        reader.has_gradients().then_some(())?;
        let along_travel = if reader.reads_rates() {
            Some(AlongTravel::of(mechanism, design)?)
        } else {
            None
        };
        let (angles, points) = (quantities.len(), design.len());
        let groups = (0..racks.len()).flat_map(|rack| {
            let values = batch.stations_in_lanes(rack);
            let stations: Vec<usize> = values.map(|v| stations.number(rack, v)).collect();
            let groups = stations.chunks(width.lanes());
            groups.map(<[usize]>::to_vec).collect::<Vec<_>>()
        });
        let groups = groups.collect();
        Some(Gradients {
            width,
            batch,
            reader,
            along_travel,
            stations: stations.clone(),
            accepted: [false; MOST_LANES],
            spread: Vec::new(),
            history: Vec::new(),
            found: Found {
                groups,
                lanes: 1,
                points,
                angles: Aligned::new(0.0, angles * MOST_LANES),
                jacobian: Aligned::new(0.0, angles * points * 3 * MOST_LANES),
                slopes: Vec::new(),
                directions: 0,
                sum: Aligned::new(0.0, MOST_LANES),
                gradient: Aligned::new(0.0, points * 3 * MOST_LANES),
            },
        })
    }

    /// Number of designs that fit into the lanes.
    pub fn at_once(&self) -> usize {
        self.width.lanes()
    }

    /// Visits the stations of designs in the order of their solution. There must not be more designs than lanes. Afterwards,
    /// [`Gradients::is_accepted`] identifies the accepted designs. Values of other designs are undefined and may be NaN.
    pub fn jacobians(&mut self, designs: &[Vector3<f64>], mut visit: impl FnMut(&Jacobians<'_>)) {
        self.evaluate(designs, None, Task::Jacobians(&mut visit));
    }

    /// Visits the stations like [`Gradients::jacobians`], but with derivatives along directions. `along` holds the rate of
    /// every coordinate in each direction, `[direction][point][axis][lane]`, with [`at_once`](Self::at_once) lanes.
    pub fn slopes(
        &mut self,
        designs: &[Vector3<f64>],
        along: &[f64],
        mut visit: impl FnMut(&Jacobians<'_>),
    ) {
        self.make_room(along.len(), self.at_once());
        let visit = &mut visit;
        self.evaluate(designs, None, Task::Slopes { along, visit });
    }

    /// Visits the stations of a single design, with one station per lane. In all other respects it equals
    /// [`Gradients::jacobians`]. The visitor gets the stations of [`Jacobians::side_by_side`] instead of designs. Returns
    /// true if the design was accepted. If the design was not accepted, the visited values must not be used. No design is
    /// accepted if [`Gradients::takes_one`] is false.
    pub fn jacobians_of_one(
        &mut self,
        design: &[Vector3<f64>],
        mut visit: impl FnMut(&Jacobians<'_>),
    ) -> bool {
        self.evaluate_one(design, Task::Jacobians(&mut visit))
    }

    /// Visits the stations like [`Gradients::jacobians_of_one`], but with derivatives along directions. `along` has the form
    /// of [`Gradients::slopes`], for one lane.
    pub fn slopes_of_one(
        &mut self,
        design: &[Vector3<f64>],
        along: &[f64],
        mut visit: impl FnMut(&Jacobians<'_>),
    ) -> bool {
        self.make_room(along.len(), 1);
        let at_once = self.at_once();
        // The directions are copied to all lanes only if they have changed. A tuning requests the same directions each
        // time.
        let is_spread = self.spread.len() == along.len() * at_once
            && self.spread.iter().step_by(at_once).eq(along);
        if !is_spread {
            self.spread.clear();
            for rate in along {
                self.spread.extend(std::iter::repeat_n(*rate, at_once));
            }
        }
        let along = std::mem::take(&mut self.spread);
        let slopes = Task::Slopes {
            along: &along,
            visit: &mut visit,
        };
        let is_accepted = self.evaluate_one(design, slopes);
        self.spread = along;
        is_accepted
    }

    /// Allocates memory for slopes along directions. `along` is the number of values in the list of directions, for
    /// `lanes` lanes.
    fn make_room(&mut self, along: usize, lanes: usize) {
        let one = self.found.points * 3 * lanes;
        assert!(along.is_multiple_of(one), "whole directions");
        self.found.directions = along / one;
        let room = self.reader.quantities().len() * self.found.directions * self.at_once();
        self.found.slopes.resize(room, 0.0);
    }

    fn evaluate_one(&mut self, design: &[Vector3<f64>], task: Task<'_>) -> bool {
        self.accepted.fill(false);
        if !self.takes_one() {
            return false;
        }
        let mut history = std::mem::take(&mut self.history);
        history.clear();
        let mut racks = 0..self.stations.racks.len();
        let is_solved = racks.all(|rack| (self.batch).track_one(design, rack, &mut history));
        if is_solved {
            self.evaluate(design, Some(&history), task);
        }
        self.history = history;
        self.is_accepted(0)
    }

    /// Returns true if the lanes can hold the stations of a single design. Otherwise the reader must check rods of
    /// rockers from one station to the next, so the stations must come one after another.
    pub fn takes_one(&self) -> bool {
        !self.reader.watches_rods()
    }

    /// Computes the sum of weighted squared deviations of each design. There must not be more designs than lanes. `wanted`
    /// lists the targets, `[angle][station]`. Afterwards, [`is_accepted`](Self::is_accepted) identifies the accepted designs.
    pub fn deviations(
        &mut self,
        designs: &[Vector3<f64>],
        wanted: &[AngleTarget],
    ) -> Deviations<'_> {
        let all = self.reader.quantities().len() * self.stations.count();
        assert_eq!(wanted.len(), all, "each angle has a value at each station");
        self.found.gradient.fill(0.0);
        self.evaluate(designs, None, Task::Deviations(wanted));
        Deviations { found: &self.found }
    }

    fn evaluate(&mut self, designs: &[Vector3<f64>], tracked: Option<&[f64]>, task: Task<'_>) {
        let width = self.width;
        width.run(GradientTask {
            gradients: self,
            designs,
            tracked,
            task,
        });
    }

    /// Returns true if the last evaluation accepted a design. The caller must solve a rejected design by another method.
    pub fn is_accepted(&self, design: usize) -> bool {
        self.accepted[design]
    }
}

/// Result that an evaluation computes.
enum Task<'t> {
    /// Derivatives of every angle with respect to hardpoint coordinates, passed to a visitor.
    Jacobians(&'t mut dyn FnMut(&Jacobians<'_>)),
    /// Derivatives of every angle along directions, passed to a visitor.
    Slopes {
        along: &'t [f64],
        visit: &'t mut dyn FnMut(&Jacobians<'_>),
    },
    /// Sum of weighted squared deviations, with its derivatives.
    Deviations(&'t [AngleTarget]),
}

struct GradientTask<'s, 'a, 't> {
    gradients: &'s mut Gradients<'a>,
    /// Points of the designs: one design per lane, or a single design repeated in all lanes.
    designs: &'s [Vector3<f64>],
    /// Unknowns of the poses of a single design whose stations are side by side in the lanes. `None` if lanes hold
    /// designs.
    tracked: Option<&'s [f64]>,
    task: Task<'t>,
}

impl SimdTask for GradientTask<'_, '_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<B: SimdReal>(self, like: B) {
        let Gradients {
            batch,
            reader,
            along_travel,
            stations,
            accepted,
            found,
            ..
        } = self.gradients;
        let points = found.points;
        let count = self.designs.len() / points;
        assert!(count <= B::LANES, "more designs than lanes");
        found.lanes = B::LANES;
        let zero = like.zero();
        let nothing = Vector3::new(zero, zero, zero);
        let mut group = vec![nothing; points];
        gather(self.designs, points, 0, count, &mut group);
        let design = batch.design(&group);
        let wheels = reader.wheels(&design, &group);
        let members = batch.members(&design);
        let series = along_travel.as_ref();
        let series = series.map(|along| (along, along.design(reader.mechanism(), &group)));
        let mut inputs = reader.inputs(like);
        reader.read_designs(&group, &mut inputs);
        let series = series.as_ref();
        let mut reading = Differentiating {
            reader,
            wheels: &wheels,
            members: &members,
            series,
            series_gradient: vec![nothing.with_rate(nothing); series.map_or(0, |_| points)],
            inputs: &mut inputs,
            rack: zero,
            accepted: like.everywhere(),
            count: stations.count(),
            first: 0,
            task: self.task,
            sum: zero,
            found,
        };
        let own_history = || batch.history(like);
        let mut history = self.tracked.map_or_else(own_history, |_| Vec::new());
        let mut groups = 0;
        let mut tracked = self.tracked;
        let mut rack = 0;
        while rack < stations.racks.len() {
            reading.rack = like.constant(stations.racks[rack]);
            reading.first = stations.number(rack, 0);
            reading.inputs.begin();
            if let Some(history) = &mut tracked {
                let (here, rest) = history.split_at(batch.steps(rack));
                *history = rest;
                reading.first = groups;
                batch.visit_stations_in_lanes(
                    &design,
                    rack,
                    here,
                    &mut Visitor::Gradients(&mut reading),
                );
                groups += batch.stations_in_lanes(rack).count().div_ceil(B::LANES);
            } else {
                let mut visitor = Visitor::Gradients(&mut reading);
                let solved = batch.solve(&design, rack, &mut history, &mut visitor);
                reading.accepted = reading.accepted & solved.everywhere();
            }
            rack += 1;
        }
        let solved = reading.accepted;
        if let Task::Deviations(_) = reading.task {
            reading.sum.store(&mut reading.found.sum);
        }
        for (lane, accepted) in accepted.iter_mut().enumerate() {
            *accepted = match self.tracked {
                Some(_) => B::all(solved),
                None => lane < count && B::lane(solved, lane),
            };
        }
    }
}
