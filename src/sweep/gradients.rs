//! Gradients of several designs at a time, one in each SIMD lane.
//!
//! For programs that move many designs at once, such as a descent from several starts: quantities by every
//! hardpoint coordinate, or a sum of their squared deviations over all stations with its gradient. The
//! second costs one adjoint a pose, the first one for each angle.
//!
//! Jacobians are handed over pose by pose, not kept: 864 bytes a pose for a strut, so that to write those of
//! a whole curve to memory takes as long as to find them.

use super::Stations;
use super::aligned::Aligned;
use super::lanes::gather;
use crate::characteristics::{
    ByDirections, Constants, LaneInputs, LaneReader, LaneWheels, Quantity,
};
use crate::derive::{Gradient, Seeds};
use crate::model::{Drive, PointId, Suspension};
use crate::number::{MOST_LANES, SimdReal, SimdTask, Vector3, Width};
use crate::solve::{Acceptance, Batch, LaneAdjoint, LaneMembers, LanePose, Visit};

/// A wanted value of an angle (radians) at a station, and the weight of the squared deviation from it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wanted {
    /// Value.
    pub value: f64,
    /// Weight; 0 where nothing is wanted.
    pub weight: f64,
}

/// Forms gradients by every hardpoint coordinate, in the kernel's frame.
pub struct Gradients<'a> {
    width: Width,
    batch: Batch<'a>,
    reader: LaneReader<'a>,
    stations: &'a Stations,
    right: [bool; MOST_LANES],
    found: Found,
}

/// What has been found, side by side in the lanes.
struct Found {
    /// Lanes there are.
    lanes: usize,
    points: usize,
    /// The angles of a pose, `[angle][lane]`.
    angles: Aligned,
    /// Their derivatives, `[angle][point][axis][lane]`.
    jacobian: Aligned,
    /// A sum of deviations, `[lane]`.
    sum: Aligned,
    /// Its derivatives, `[point][axis][lane]`.
    gradient: Aligned,
}

impl Found {
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

/// The angles of several designs at a station, and their derivatives. Designs are numbered as they were given,
/// angles as those that gradients were asked of.
pub struct Jacobians<'f> {
    station: usize,
    found: &'f Found,
}

/// Sums of weighted squared deviations, by the number of the design.
pub struct Deviations<'f> {
    found: &'f Found,
}

impl Deviations<'_> {
    /// The sum, in squared radians times weights.
    #[inline(always)]
    pub fn sum(&self, design: usize) -> f64 {
        self.found.number(&self.found.sum, 0, design)
    }

    /// Its gradient by a hardpoint, per length unit.
    #[inline(always)]
    pub fn gradient(&self, design: usize, point: PointId) -> Vector3<f64> {
        self.found.vector(&self.found.gradient, 0, point, design)
    }
}

impl Jacobians<'_> {
    /// The station, as [`Stations::number`] has it.
    pub fn station(&self) -> usize {
        self.station
    }

    /// The value of an angle, in radians.
    #[inline(always)]
    pub fn value(&self, design: usize, angle: usize) -> f64 {
        self.found.number(&self.found.angles, angle, design)
    }

    /// Its gradient by a hardpoint, in radians per length unit.
    #[inline(always)]
    pub fn gradient(&self, design: usize, angle: usize, point: PointId) -> Vector3<f64> {
        self.found
            .vector(&self.found.jacobian, angle, point, design)
    }
}

impl<'a> Gradients<'a> {
    /// Of these quantities; `None` where they, or the mechanism, cannot be differentiated in lanes
    /// ([`LaneReader::has_gradients`]; the drive must be the travel).
    pub fn new(
        suspension: &'a Suspension,
        stations: &'a Stations,
        quantities: &[Quantity],
        width: Width,
    ) -> Option<Self> {
        let (mechanism, design) = (&suspension.mechanism, &suspension.design);
        let (drive, racks) = (stations.drive, &stations.racks);
        (drive == Drive::Travel).then_some(())?;
        let batch = Batch::new(mechanism, design, drive, &stations.station_order, racks)?;
        batch.is_complete().then_some(())?;
        let constants = Constants::of(suspension);
        let reader = LaneReader::new(mechanism, &batch, constants, quantities.to_vec())?;
        reader.has_gradients().then_some(())?;
        let (angles, points) = (quantities.len(), design.len());
        Some(Gradients {
            width,
            batch,
            reader,
            stations,
            right: [false; MOST_LANES],
            found: Found {
                lanes: 1,
                points,
                angles: Aligned::new(0.0, angles * MOST_LANES),
                jacobian: Aligned::new(0.0, angles * points * 3 * MOST_LANES),
                sum: Aligned::new(0.0, MOST_LANES),
                gradient: Aligned::new(0.0, points * 3 * MOST_LANES),
            },
        })
    }

    /// Designs that fit into the lanes.
    pub fn at_once(&self) -> usize {
        struct Count;
        impl SimdTask for Count {
            type Output = usize;
            #[inline(always)]
            fn run<B: SimdReal>(self, _: B) -> usize {
                B::LANES
            }
        }
        self.width.run(Count)
    }

    /// Visits the stations of designs, as many as fit into the lanes at most, in the order in which they are
    /// solved. Which designs were right is known afterwards ([`Gradients::is_right`]): what is visited of
    /// others is anything, NaN included.
    pub fn jacobians(&mut self, designs: &[Vector3<f64>], mut visit: impl FnMut(&Jacobians<'_>)) {
        self.evaluate(designs, Task::Jacobians(&mut visit));
    }

    /// Forms the sums of weighted squared deviations of designs, as many as fit into the lanes at most;
    /// `wanted` angle by angle and station by station. Which designs were right is known from then on.
    pub fn deviations(&mut self, designs: &[Vector3<f64>], wanted: &[Wanted]) -> Deviations<'_> {
        let all = self.reader.quantities().len() * self.stations.count();
        assert_eq!(wanted.len(), all, "one for each angle and station");
        self.found.gradient.fill(0.0);
        self.evaluate(designs, Task::Deviations(wanted));
        Deviations { found: &self.found }
    }

    fn evaluate(&mut self, designs: &[Vector3<f64>], task: Task<'_>) {
        let width = self.width;
        width.run(Evaluation {
            gradients: self,
            designs,
            task,
        });
    }

    /// Whether a design of the last evaluation is right; if not, it is to be solved one by one.
    pub fn is_right(&self, design: usize) -> bool {
        self.right[design]
    }
}

/// What is formed.
enum Task<'t> {
    /// Every angle's derivatives, to be handed over.
    Jacobians(&'t mut dyn FnMut(&Jacobians<'_>)),
    /// A sum of deviations, with its derivatives.
    Deviations(&'t [Wanted]),
}

struct Evaluation<'s, 'a, 't> {
    gradients: &'s mut Gradients<'a>,
    designs: &'s [Vector3<f64>],
    task: Task<'t>,
}

impl SimdTask for Evaluation<'_, '_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<B: SimdReal>(self, like: B) {
        let Gradients {
            batch,
            reader,
            stations,
            right,
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
        let mut history = batch.history(like);
        gather(self.designs, points, 0, count, &mut group);
        let design = batch.design(&group);
        let wheels = reader.wheels(&design, &group);
        let members = batch.members(&design);
        let mut reading = Differentiating {
            reader,
            wheels: &wheels,
            members: &members,
            inputs: reader.inputs(&wheels),
            rack: like,
            right: like.everywhere(),
            count: stations.count(),
            first: 0,
            task: self.task,
            sum: zero,
            found,
        };
        let mut rack = 0;
        while rack < stations.racks.len() {
            reading.first = stations.number(rack, 0);
            reading.inputs.begin();
            reading.rack = like.lit(stations.racks[rack]);
            let solved = batch.solve(&design, rack, &mut history, &mut reading);
            reading.right = reading.right & solved.everywhere();
            rack += 1;
        }
        let solved = reading.right;
        if let Task::Deviations(_) = reading.task {
            reading.sum.store(&mut reading.found.sum);
        }
        for (lane, right) in right.iter_mut().enumerate() {
            *right = lane < count && B::lane(solved, lane);
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

/// Differentiates the angles in the poses of a group.
struct Differentiating<'r, 't, B: SimdReal> {
    reader: &'r LaneReader<'r>,
    wheels: &'r LaneWheels<B>,
    members: &'r LaneMembers<B>,
    inputs: LaneInputs<B>,
    rack: B,
    /// Lanes that are right so far.
    right: B::Mask,
    /// Stations in all, and the first one with the rack where it is.
    count: usize,
    first: usize,
    task: Task<'t>,
    /// Of the deviations so far.
    sum: B,
    found: &'r mut Found,
}

impl<B: SimdReal> Visit<B> for Differentiating<'_, '_, B> {
    #[inline(always)]
    fn pose(&mut self, station: usize, at: &impl LanePose<B>, _: Acceptance<B>) {
        let station = self.first + station;
        let right = self
            .reader
            .read(self.wheels, at, self.rack, false, &mut self.inputs);
        let angles = self.reader.quantities().len();
        let zero = self.rack.zero();
        let rates = at.rates();
        self.right = self.right & right & at.knows(&rates);
        let configuration = at.configuration(self.rack);
        let adjoint = at.adjoint(self.members, &configuration, &rates);
        let Found {
            angles: values,
            jacobian,
            gradient,
            points,
            ..
        } = &mut *self.found;
        self.reader.values(&self.inputs, values, B::LANES);
        let mut angle = 0;
        while angle < angles {
            let (end, row) = match self.task {
                Task::Jacobians(_) => {
                    let length = *points * 3 * B::LANES;
                    let row = &mut jacobian[angle * length..][..length];
                    row.fill(0.0);
                    (angle + 1, row)
                }
                Task::Deviations(_) => (angles, &mut gradient[..]),
            };
            let row = &mut Row(row);
            let mut by = ByDirections::default();
            let mut seeds = Seeds::new(&configuration, row);
            while angle < end {
                let weight = match self.task {
                    Task::Jacobians(_) => zero.one(),
                    Task::Deviations(wanted) => {
                        let Wanted { value, weight } = wanted[angle * self.count + station];
                        let missed = zero.load(&values[angle * B::LANES..]) - zero.lit(value);
                        let weighted = missed * zero.lit(weight);
                        self.sum = self.sum.plus_product(weighted, missed);
                        weighted + weighted
                    }
                };
                self.reader.differentiate(
                    angle,
                    weight,
                    &self.inputs,
                    &mut by,
                    &configuration,
                    &mut seeds,
                );
                angle += 1;
            }
            by.seed(self.wheels, &self.inputs, &mut seeds);
            let wrench = seeds.wrench();
            adjoint.subtract(&wrench, row);
        }
        if let Task::Jacobians(visit) = &mut self.task {
            let found = &*self.found;
            visit(&Jacobians { station, found });
        }
    }
}
