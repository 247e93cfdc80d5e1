//! Gradients of several designs at a time, one in each SIMD lane.
//!
//! For programs that move many designs at once, such as a descent from several starts: the four angles by
//! every hardpoint coordinate at every station, or a sum of their squared deviations with its gradient. The
//! second costs one adjoint a pose, the first one for each angle.

use super::Stations;
use super::aligned::Aligned;
use super::lanes::gather;
use crate::characteristics::{Characteristic, Constants, Inputs, LaneReader, LaneWheels};
use crate::kinematics::{Batch, LaneAdjoint, LanePose, Seeds, Visit};
use crate::model::{Drive, PointId, Suspension};
use crate::number::{Bundle, InLanes, MOST_LANES, Vector3, Width};

/// A wanted value of an angle (radians) at a station, and the weight of the squared deviation from it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wanted {
    /// Value.
    pub value: f64,
    /// Weight; 0 where nothing is wanted.
    pub weight: f64,
}

/// What is differentiated.
#[derive(Clone, Debug, PartialEq)]
pub enum Of {
    /// Every angle at every station.
    Angles,
    /// The sum of weighted squared deviations; what is wanted, angle by angle and station by station.
    Deviations(Vec<Wanted>),
}

/// Forms gradients by every hardpoint coordinate, in the kernel's frame.
pub struct Gradients<'a> {
    width: Width,
    batch: Batch<'a>,
    reader: LaneReader<'a>,
    stations: &'a Stations,
    points: usize,
    of: Of,
    /// Lanes of the last group.
    lanes: usize,
    right: [bool; MOST_LANES],
    /// `[angle][station][lane]`, or `[lane]`
    values: Aligned,
    /// `[angle][station][point][axis][lane]`, or `[point][axis][lane]`
    gradients: Aligned,
}

impl<'a> Gradients<'a> {
    /// Of these angles; `None` where they, or the mechanism, cannot be differentiated in lanes
    /// ([`LaneReader::has_gradients`]; the drive must be the travel).
    pub fn new(
        suspension: &'a Suspension,
        stations: &'a Stations,
        angles: &[Characteristic],
        of: Of,
        width: Width,
    ) -> Option<Self> {
        let (mechanism, design) = (&suspension.mechanism, &suspension.design);
        let (drive, racks) = (stations.drive, &stations.racks);
        (drive == Drive::Travel).then_some(())?;
        let batch = Batch::new(mechanism, design, drive, &stations.march, racks)?;
        let constants = Constants::of(suspension);
        let reader = LaneReader::new(mechanism, &batch, constants, angles.to_vec())?;
        reader.has_gradients().then_some(())?;
        let rows = angles.len() * stations.count();
        let rows = match &of {
            Of::Angles => rows,
            Of::Deviations(wanted) => {
                assert_eq!(wanted.len(), rows, "one for each angle and station");
                1
            }
        };
        Some(Gradients {
            width,
            batch,
            reader,
            stations,
            points: design.len(),
            of,
            lanes: 1,
            right: [false; MOST_LANES],
            values: Aligned::new(0.0, rows * MOST_LANES),
            gradients: Aligned::new(0.0, rows * design.len() * 3 * MOST_LANES),
        })
    }

    /// Designs that fit into the lanes.
    pub fn at_once(&self) -> usize {
        struct Count;
        impl InLanes for Count {
            type Output = usize;
            #[inline(always)]
            fn run<B: Bundle>(self, _: B) -> usize {
                B::LANES
            }
        }
        self.width.run(Count)
    }

    /// Evaluates designs, as many as fit into the lanes at most.
    pub fn evaluate(&mut self, designs: &[Vector3<f64>]) {
        let width = self.width;
        width.run(Evaluation {
            gradients: self,
            designs,
        });
    }

    /// Whether a design of the last evaluation is right; if not, it is one for the careful path.
    pub fn is_right(&self, design: usize) -> bool {
        self.right[design]
    }

    /// The value of an angle at a station, or with both 0 the sum of deviations.
    pub fn value(&self, design: usize, angle: usize, station: usize) -> f64 {
        let row = angle * self.stations.count() + station;
        self.values[row * self.lanes + design]
    }

    /// Its gradient by a hardpoint.
    pub fn gradient(
        &self,
        design: usize,
        angle: usize,
        station: usize,
        point: PointId,
    ) -> Vector3<f64> {
        let row = angle * self.stations.count() + station;
        let first = (row * self.points + point.0) * 3;
        let component = |axis: usize| self.gradients[(first + axis) * self.lanes + design];
        Vector3::new(component(0), component(1), component(2))
    }
}

struct Evaluation<'s, 'a> {
    gradients: &'s mut Gradients<'a>,
    designs: &'s [Vector3<f64>],
}

impl InLanes for Evaluation<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<B: Bundle>(self, like: B) {
        let Gradients {
            batch,
            reader,
            stations,
            points,
            of,
            lanes,
            right,
            values,
            gradients,
            ..
        } = self.gradients;
        let count = self.designs.len() / *points;
        assert!(count <= B::LANES, "more designs than lanes");
        *lanes = B::LANES;
        let nothing = Vector3::new(like, like, like);
        let mut group = vec![nothing; *points];
        let mut gradient = vec![nothing; *points];
        let mut evaluated = vec![0.0; reader.characteristics().len() * B::LANES];
        let mut history = batch.history(like);
        gather(self.designs, *points, 0, count, &mut group);
        let design = batch.design(&group);
        let wheels = reader.wheels(&design, &group);
        if let Of::Deviations(_) = of {
            values.fill(0.0);
            gradients.fill(0.0);
        }
        let mut reading = Differentiating {
            reader,
            wheels: &wheels,
            inputs: reader.inputs(&wheels),
            rack: like,
            right: design.is_regular(),
            count: stations.count(),
            first: 0,
            wanted: match of {
                Of::Angles => None,
                Of::Deviations(wanted) => Some(wanted),
            },
            evaluated: &mut evaluated,
            gradient: &mut gradient,
            values,
            gradients,
        };
        let mut rack = 0;
        while rack < stations.racks.len() {
            reading.first = stations.number(rack, 0);
            reading.rack = like.lit(stations.racks[rack]);
            let solved = batch.solve(&design, rack, &mut history, &mut reading);
            reading.right = reading.right & solved;
            rack += 1;
        }
        let solved = reading.right;
        for (lane, right) in right.iter_mut().enumerate() {
            *right = lane < count && B::lane(solved, lane);
        }
    }
}

/// Differentiates the angles in the poses of a group.
struct Differentiating<'r, B: Bundle> {
    reader: &'r LaneReader<'r>,
    wheels: &'r LaneWheels<B>,
    inputs: Inputs<B>,
    rack: B,
    /// Lanes that are right so far.
    right: B::Mask,
    /// Stations in all, and the first one with the rack where it is.
    count: usize,
    first: usize,
    wanted: Option<&'r [Wanted]>,
    /// The angles in this pose.
    evaluated: &'r mut [f64],
    gradient: &'r mut [Vector3<B>],
    values: &'r mut [f64],
    gradients: &'r mut [f64],
}

impl<B: Bundle> Visit<B> for Differentiating<'_, B> {
    #[inline(always)]
    fn pose(&mut self, station: usize, at: &impl LanePose<B>) {
        let station = self.first + station;
        let right = self
            .reader
            .read(self.wheels, at, self.rack, false, &mut self.inputs);
        self.right = self.right & right;
        let angles = self.reader.characteristics().len();
        let zero = self.rack.zero();
        let rates = at.rates();
        let posture = at.posture(self.rack);
        let adjoint = at.adjoint(&posture, &rates);
        self.reader.values(&self.inputs, self.evaluated, B::LANES);
        let at_once = if self.wanted.is_some() { angles } else { 1 };
        let mut next = 0;
        while next < angles {
            for component in self.gradient.iter_mut() {
                *component = Vector3::new(zero, zero, zero);
            }
            let mut seeds = Seeds::new(&posture, self.gradient);
            let row = match self.wanted {
                None => next * self.count + station,
                Some(_) => 0,
            };
            let end = next + at_once;
            while next < end {
                let inputs = &self.inputs;
                let value = zero.load(&self.evaluated[next * B::LANES..]);
                let to = &mut self.values[row * B::LANES..];
                let weight = match self.wanted {
                    None => {
                        value.store(to);
                        zero.one()
                    }
                    Some(wanted) => {
                        let Wanted { value: v, weight } = wanted[next * self.count + station];
                        let missed = value - zero.lit(v);
                        let weighted = missed * zero.lit(weight);
                        zero.load(to).plus_product(weighted, missed).store(to);
                        weighted + weighted
                    }
                };
                self.reader.seed(next, weight, inputs, &posture, &mut seeds);
                next += 1;
            }
            let wrench = seeds.wrench();
            adjoint.subtract(&wrench, self.gradient);
            let to = &mut self.gradients[row * self.gradient.len() * 3 * B::LANES..];
            let components = to.chunks_exact_mut(3 * B::LANES);
            for (to, component) in components.zip(self.gradient.iter()) {
                let (x, rest) = to.split_at_mut(B::LANES);
                let (y, z) = rest.split_at_mut(B::LANES);
                if self.wanted.is_some() {
                    (zero.load(x) + component.x).store(x);
                    (zero.load(y) + component.y).store(y);
                    (zero.load(z) + component.z).store(z);
                } else {
                    component.x.store(x);
                    component.y.store(y);
                    component.z.store(z);
                }
            }
        }
    }
}
