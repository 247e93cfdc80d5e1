//! Gradients of several designs at a time, one in each SIMD lane.
//!
//! Programs that move many designs at once use it, such as a descent from several starts. It gives either of these:
//!
//! - derivatives of quantities by every hardpoint coordinate, or along directions that move several hardpoints,
//! - the sum of squared deviations over all stations, with its gradient.
//!
//! The sum costs one adjoint per pose. The derivatives cost one adjoint per pose and angle.
//!
//! The caller receives Jacobians pose by pose; they are not stored. A strut needs 864 bytes per pose. Writing the Jacobians
//! of a whole curve to memory would take as long as computing them.

use super::Stations;
use super::aligned::Aligned;
use super::lanes::{Visitor, gather};
use crate::characteristics::{
    ByDirections, Constants, LaneInputs, LaneReader, LaneWheels, Quantity,
};
use crate::derive::{Gradient, Seeds};
use crate::mechanism::{Configuration, Wrench};
use crate::model::{Drive, PointId, Suspension};
use crate::number::{Jet, MOST_LANES, Outlined, SimdReal, SimdTask, Vector3, Width};
use crate::solve::{
    AdjointConstants, AlongTravel, CornerTracker, LaneAdjoint, LanePose, LaneRates, SeriesDesign,
};
use std::ops::Range;

/// Target value of an angle (radians) at a station, with the weight of the squared deviation from it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AngleTarget {
    /// Value.
    pub value: f64,
    /// Weight. 0 if the angle has no target.
    pub weight: f64,
}

/// Computes gradients by every hardpoint coordinate, in the kernel's frame.
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
    /// Directions that are the same in every lane.
    spread: Vec<f64>,
    /// Unknowns of a single design at the places of its routes.
    history: Vec<f64>,
}

/// Results of an evaluation, one value per lane.
#[derive(Clone)]
struct Found {
    /// Stations of a single design, group by group.
    groups: Vec<Vec<usize>>,
    /// Number of lanes.
    lanes: usize,
    points: usize,
    /// Angles of a pose, `[angle][lane]`.
    angles: Aligned,
    /// Derivatives of the angles, `[angle][point][axis][lane]`.
    jacobian: Aligned,
    /// Derivatives of the angles along directions, `[angle][direction][lane]`. `directions` is the number of directions.
    slopes: Vec<f64>,
    directions: usize,
    /// Sum of deviations, `[lane]`.
    sum: Aligned,
    /// Derivatives of the sum, `[point][axis][lane]`.
    gradient: Aligned,
}

impl Found {
    /// Memory row for the derivatives of this angle, or of the sum of deviations.
    #[inline(always)]
    fn row(&mut self, is_sum: bool, angle: usize) -> &mut [f64] {
        let length = self.points * 3 * self.lanes;
        match is_sum {
            true => &mut self.gradient,
            false => &mut self.jacobian[angle * length..][..length],
        }
    }

    #[inline(always)]
    fn number(&self, of: &[f64], row: usize, design: usize) -> f64 {
        assert!(design < self.lanes, "no such design");
        of[row * self.lanes + design]
    }

    #[inline(always)]
    fn vector(&self, of: &[f64], first: usize, point: PointId, design: usize) -> Vector3<f64> {
        let first = (first * self.points + point.0) * 3;
        let component = |axis: usize| self.number(of, first + axis, design);
        Vector3::new(component(0), component(1), component(2))
    }
}

/// Angles of several designs at a station, and their derivatives by hardpoints and along directions. Indices of designs and
/// angles follow the order in which the caller gave them.
pub struct Jacobians<'f> {
    station: usize,
    found: &'f Found,
}

/// Sums of weighted squared deviations, by the index of the design.
pub struct Deviations<'f> {
    found: &'f Found,
}

impl Deviations<'_> {
    /// Sum, in squared radians times weights.
    #[inline(always)]
    pub fn sum(&self, design: usize) -> f64 {
        self.found.number(&self.found.sum, 0, design)
    }

    /// Gradient by a hardpoint, per length unit.
    #[inline(always)]
    pub fn gradient(&self, design: usize, point: PointId) -> Vector3<f64> {
        self.found.vector(&self.found.gradient, 0, point, design)
    }
}

impl Jacobians<'_> {
    /// Index of the station that the designs share, as [`Stations::number`] returns it.
    pub fn station(&self) -> usize {
        self.station
    }

    /// Stations of a single design, one per lane, if the lanes hold stations instead of designs.
    pub fn side_by_side(&self) -> &[usize] {
        &self.found.groups[self.station]
    }

    /// Value of an angle, in radians.
    #[inline(always)]
    pub fn value(&self, design: usize, angle: usize) -> f64 {
        self.found.number(&self.found.angles, angle, design)
    }

    /// Gradient by a hardpoint, in radians per length unit.
    #[inline(always)]
    pub fn gradient(&self, design: usize, angle: usize, point: PointId) -> Vector3<f64> {
        self.found
            .vector(&self.found.jacobian, angle, point, design)
    }

    /// Derivative of an angle along a direction, if directions were requested.
    #[inline(always)]
    pub fn slope(&self, design: usize, angle: usize, direction: usize) -> f64 {
        let row = angle * self.found.directions + direction;
        self.found.number(&self.found.slopes, row, design)
    }
}

impl<'a> Gradients<'a> {
    /// Prepares gradients of these quantities. Returns `None` if a quantity or the mechanism cannot be differentiated
    /// in lanes ([`LaneReader::has_gradients`]), or if the drive is not the travel.
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
        let along_travel = match reader.reads_rates() {
            true => Some(AlongTravel::of(mechanism, design)?),
            false => None,
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

    /// The same as [`Gradients::jacobians`], along directions. `along` holds the rate of every coordinate in each direction,
    /// `[direction][point][axis][lane]`, with [`at_once`](Self::at_once) lanes.
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

    /// The same as [`Gradients::jacobians`] for a single design, with one station per lane. The visitor gets the stations of
    /// [`Jacobians::side_by_side`] in place of designs. Returns true if the design was accepted. If not, the visited values
    /// must not be used. No design is accepted if [`Gradients::takes_one`] is false.
    pub fn jacobians_of_one(
        &mut self,
        design: &[Vector3<f64>],
        mut visit: impl FnMut(&Jacobians<'_>),
    ) -> bool {
        self.evaluate_one(design, Task::Jacobians(&mut visit))
    }

    /// The same as [`Gradients::jacobians_of_one`], along directions. `along` is that of [`Gradients::slopes`] for one lane.
    pub fn slopes_of_one(
        &mut self,
        design: &[Vector3<f64>],
        along: &[f64],
        mut visit: impl FnMut(&Jacobians<'_>),
    ) -> bool {
        self.make_room(along.len(), 1);
        let at_once = self.at_once();
        // A tuning requests the same directions each time.
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

    /// Makes room for slopes along directions that are given as `along` numbers, for `lanes` lanes.
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
        let is_solved =
            racks.all(|rack| (self.batch).track_one(self.width, design, rack, &mut history));
        if is_solved {
            self.evaluate(design, Some(&history), task);
        }
        self.history = history;
        self.is_accepted(0)
    }

    /// Returns true if the lanes can hold the stations of a single design. They cannot if rods of rockers are watched
    /// from one station to the next.
    pub fn takes_one(&self) -> bool {
        !self.reader.watches_rods()
    }

    /// Computes the sum of weighted squared deviations of each design. There must not be more designs than lanes. `wanted`
    /// lists the targets angle by angle and station by station. Afterwards, [`is_accepted`](Self::is_accepted) identifies
    /// the accepted designs.
    pub fn deviations(
        &mut self,
        designs: &[Vector3<f64>],
        wanted: &[AngleTarget],
    ) -> Deviations<'_> {
        let all = self.reader.quantities().len() * self.stations.count();
        assert_eq!(wanted.len(), all, "one for each angle and station");
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

    /// Returns true if the last evaluation accepted a design. The caller must solve a rejected design on its own.
    pub fn is_accepted(&self, design: usize) -> bool {
        self.accepted[design]
    }
}

/// Result that an evaluation computes.
enum Task<'t> {
    /// Derivatives of every angle by hardpoint coordinates, passed to a visitor.
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
    /// One design per lane, or a single design repeated in all lanes.
    designs: &'s [Vector3<f64>],
    /// Unknowns of a single design whose stations are side by side in the lanes. `None` if lanes hold designs.
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
        let mut history = match self.tracked {
            Some(_) => Vec::new(),
            None => batch.history(like),
        };
        gather(self.designs, points, 0, count, &mut group);
        let design = batch.design(&group);
        let wheels = reader.wheels(&design, &group);
        let members = batch.members(&design);
        let series = match along_travel {
            Some(along) => Some((&*along, along.design(reader.mechanism(), &group))),
            None => None,
        };
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

/// Derivatives by the hardpoints, `[point][axis][lane]`.
struct Row<'r>(&'r mut [f64]);

impl<B: SimdReal> Gradient<B> for Row<'_> {
    #[inline(always)]
    fn add(&mut self, id: PointId, by: Vector3<B>) {
        let first = id.0 * 3 * B::LANES;
        let (x, rest) = self.0[first..first + 3 * B::LANES].split_at_mut(B::LANES);
        let (y, z) = rest.split_at_mut(B::LANES);
        (by.x.load(x) + by.x).store(x);
        (by.y.load(y) + by.y).store(y);
        (by.z.load(z) + by.z).store(z);
    }
}

/// Fills a row with zeros, for the instructions of the lanes.
#[inline(always)]
fn clear<B: SimdReal>(zero: B, row: &mut [f64]) {
    for place in row.chunks_exact_mut(B::LANES) {
        zero.store(place);
    }
}

/// Computes derivatives along directions from those by the hardpoints. It takes a few directions at a time, because the
/// additions of a single sum would wait for each other.
#[inline(always)]
fn chain<B: SimdReal>(like: B, gradient: &[f64], along: &[f64], slopes: &mut [f64]) {
    const TOGETHER: usize = 3;
    let (length, directions) = (gradient.len(), slopes.len() / B::LANES);
    let mut first = 0;
    while first < directions {
        let together = TOGETHER.min(directions - first);
        let mut sums = [like.zero(); TOGETHER];
        let mut place = 0;
        while place < length {
            let by = like.load(&gradient[place..]);
            let mut k = 0;
            while k < TOGETHER {
                // Beyond the last direction its sum is computed again and not used.
                let direction = first + k.min(together - 1);
                let rate = like.load(&along[direction * length + place..]);
                sums[k] = sums[k].plus_product(by, rate);
                k += 1;
            }
            place += B::LANES;
        }
        for (k, sum) in sums[..together].iter().enumerate() {
            sum.store(&mut slopes[(first + k) * B::LANES..]);
        }
        first += together;
    }
}

/// Differentiates the angles in the poses of a group.
pub(super) struct Differentiating<'r, 't, B: SimdReal> {
    reader: &'r LaneReader<'r>,
    wheels: &'r LaneWheels<B>,
    members: &'r AdjointConstants<B>,
    /// Designs as series along the travel, if a quantity contains velocities, and a buffer for a gradient.
    series: Option<&'r (&'r AlongTravel, SeriesDesign<B>)>,
    series_gradient: Vec<Vector3<Jet<B, 2>>>,
    inputs: &'r mut LaneInputs<B>,
    rack: B,
    /// Lanes accepted so far.
    accepted: B::Mask,
    /// Number of all stations, and index of the first one at this rack displacement.
    count: usize,
    first: usize,
    task: Task<'t>,
    /// Weighted sum of squared deviations of the poses visited so far.
    sum: B,
    found: &'r mut Found,
}

impl<B: SimdReal> Differentiating<'_, '_, B> {
    /// Factor of an angle's derivatives: 1, or the derivative of a sum of deviations by the angle. In the second case the
    /// angle's deviation is added to the sum.
    #[inline(always)]
    fn weight(&mut self, angle: usize, station: usize) -> B {
        let one = self.rack.one();
        let Task::Deviations(wanted) = self.task else {
            return one;
        };
        let AngleTarget { value, weight } = wanted[angle * self.count + station];
        let missed = one.load(&self.found.angles[angle * B::LANES..]) - one.constant(value);
        let weighted = missed * one.constant(weight);
        self.sum = self.sum.plus_product(weighted, missed);
        weighted + weighted
    }
}

impl<B: SimdReal> Differentiating<'_, '_, B> {
    #[inline(always)]
    pub(super) fn differentiate(&mut self, station: usize, at: &impl LanePose<B>) {
        let rack = self.rack;
        rack.outlined(AtPose {
            station: self.first + station,
            differentiating: self,
            at,
        });
    }
}

/// Work piece in a separate function, so that poses of one design side by side and poses of many designs share the code.
struct AtPose<'v, 'r, 't, B: SimdReal, P> {
    differentiating: &'v mut Differentiating<'r, 't, B>,
    station: usize,
    at: &'v P,
}

impl<B: SimdReal, P: LanePose<B>> Outlined for AtPose<'_, '_, '_, B, P> {
    type Output = ();
    #[inline(always)]
    fn work(self) {
        self.differentiating
            .differentiate_inline(self.station, self.at);
    }
}

impl<B: SimdReal> Differentiating<'_, '_, B> {
    #[inline(always)]
    fn differentiate_inline(&mut self, station: usize, at: &impl LanePose<B>) {
        let reads_rates = self.reader.reads_rates();
        let accepted = self
            .reader
            .read(self.wheels, at, self.rack, reads_rates, self.inputs);
        let angles = self.reader.quantities().len();
        let rates = at.rates();
        self.accepted = self.accepted & accepted & at.velocity_is_reliable(&rates);
        let configuration = at.configuration(self.rack);
        let adjoint = at.adjoint(self.members, &configuration, &rates);
        self.reader
            .values(self.inputs, &mut self.found.angles, B::LANES);
        let is_sum = matches!(self.task, Task::Deviations(_));
        let length = self.found.points * 3 * B::LANES;
        let mut angle = 0;
        while angle < angles {
            let (first, end) = match is_sum {
                true => (angle, angles),
                false => (angle, angle + 1),
            };
            if !is_sum {
                clear(
                    self.rack.zero(),
                    &mut self.found.jacobian[angle * length..][..length],
                );
            }
            let mut is_posed = false;
            for number in first..end {
                if self.reader.is_of_rates(number) {
                    let weight = self.weight(number, station);
                    weight.outlined(AddingGradientOfRates {
                        differentiating: self,
                        number,
                        weight,
                        configuration: &configuration,
                        rates: &rates,
                    });
                } else {
                    is_posed = true;
                }
            }
            if is_posed {
                self.add_gradients(first..end, station, &configuration, &adjoint);
            }
            if let Task::Slopes { along, .. } = self.task {
                let Found {
                    jacobian,
                    slopes,
                    directions,
                    ..
                } = &mut *self.found;
                let row = &jacobian[first * length..][..length];
                let room = *directions * B::LANES;
                chain(self.rack, row, along, &mut slopes[first * room..][..room]);
            }
            angle = end;
        }
        let found = &*self.found;
        match &mut self.task {
            Task::Jacobians(visit) | Task::Slopes { visit, .. } => {
                visit(&Jacobians { station, found });
            }
            Task::Deviations(_) => {}
        }
    }

    /// Adds the gradients of those quantities in the range that contain no velocities, each times its weight, to the row of
    /// the first.
    #[inline(always)]
    fn add_gradients(
        &mut self,
        numbers: Range<usize>,
        station: usize,
        configuration: &Configuration<'_, B>,
        adjoint: &impl LaneAdjoint<B>,
    ) {
        let is_sum = matches!(self.task, Task::Deviations(_));
        let (reader, first) = (self.reader, numbers.start);
        let mut by = ByDirections::default();
        let mut wrench = Wrench::zero(self.rack);
        for number in numbers {
            if reader.is_of_rates(number) {
                continue;
            }
            let weight = self.weight(number, station);
            if reader.add_by_directions(number, weight, self.inputs, &mut by) {
                continue;
            }
            let row = &mut Row(self.found.row(is_sum, first));
            let mut seeds = Seeds::continuing(configuration, wrench, row);
            reader.differentiate(number, weight, self.inputs, configuration, &mut seeds);
            wrench = seeds.wrench();
        }
        let row = &mut Row(self.found.row(is_sum, first));
        let mut seeds = Seeds::continuing(configuration, wrench, row);
        by.seed(self.wheels, self.inputs, &mut seeds);
        let wrench = seeds.wrench();
        adjoint.subtract(&wrench, row);
    }
}

/// Adds the gradient of a quantity that contains velocities, times a weight, to its row. A separate function, since its many
/// series would use stack in every pose.
struct AddingGradientOfRates<'v, 'r, 't, 'c, B: SimdReal> {
    differentiating: &'v mut Differentiating<'r, 't, B>,
    number: usize,
    weight: B,
    configuration: &'v Configuration<'c, B>,
    rates: &'v LaneRates<B>,
}

impl<B: SimdReal> Outlined for AddingGradientOfRates<'_, '_, '_, '_, B> {
    type Output = ();
    #[inline(always)]
    fn work(self) {
        let AddingGradientOfRates { number, weight, .. } = self;
        let Differentiating {
            reader,
            series,
            series_gradient,
            inputs,
            task,
            found,
            ..
        } = self.differentiating;
        let Some((along, design)) = *series else {
            return;
        };
        let at = design.along(self.configuration, self.rates);
        let adjoint = along.adjoint(design, &at);
        let gradient = &mut series_gradient[..];
        let zero = Jet([weight.zero(); 2]);
        gradient.fill(Vector3::new(zero, zero, zero));
        let mut seeds = Seeds::new(&at, gradient);
        reader.differentiate_rates(number, weight, inputs, &at, &mut seeds);
        let wrench = seeds.wrench();
        adjoint.subtract(&wrench, gradient);
        let is_sum = matches!(task, Task::Deviations(_));
        let mut row = Row(found.row(is_sum, number));
        for (point, by) in series_gradient.iter().enumerate() {
            let slope = Vector3::new(by.x.0[1], by.y.0[1], by.z.0[1]);
            row.add(PointId(point), slope);
        }
    }
}
