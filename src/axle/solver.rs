//! Finding the position of an axle: both corners, and what the ground asks of them.
//!
//! On a plane ground both contact points are at one height, f = h_l(z_l) - h_r(z_r) = 0 with h = n.C. With
//! the roll angle given and z_l, z_r = heave +- s this is one equation in s. Its slope n.C_l' + n.C_r' is
//! near 2 and positive while neither wheel is at a fold of its travel, so that the root is the only one
//! and Newton's method meets it. With both travels given it is one in the roll angle, of slope -track.

use super::ground::Ground;
use super::reading::{Parts, Reading, Snapshot, add_gradient, along, inputs_on_tape};
use super::setup::Setup;
use super::state::{Hold, State};
use super::taylor::Line;
use super::{Axle, Quantity};
use crate::derive::{DesignSeries, MotionPoint};
use crate::mechanism::{DesignFault, Failure, Pose, Toggles};
use crate::model::{Drive, Mechanism, PointId, RockerId, Side};
use crate::number::{Jet, Tape, Vector3};
use crate::solve::{Solver, StationOrder};
use std::ops::ControlFlow;

/// Where an axle is to be. Lengths as in the study; the rack towards the left wheel's outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Placement {
    /// The body rolled on a plane ground.
    Roll {
        /// Mean travel of the wheel centres.
        heave: f64,
        /// Roll angle in radians.
        roll: f64,
        /// Displacement of the rack.
        rack: f64,
    },
    /// Both travels.
    Travels {
        /// Of left and right wheel.
        travels: [f64; 2],
        /// Displacement of the rack.
        rack: f64,
        /// Whether the ground is a plane, the body level otherwise.
        on_plane: bool,
    },
}

impl Placement {
    /// Displacement of the rack.
    pub fn rack(&self) -> f64 {
        match *self {
            Placement::Roll { rack, .. } | Placement::Travels { rack, .. } => rack,
        }
    }

    /// What is held.
    pub fn hold(&self) -> Hold {
        match self {
            Placement::Roll { .. } => Hold::MeanTravel,
            Placement::Travels { on_plane: true, .. } => Hold::TravelsOnPlane,
            Placement::Travels { .. } => Hold::TravelsOnPads,
        }
    }
}

impl std::fmt::Display for Placement {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Placement::Roll { heave, roll, rack } => {
                let roll = roll.to_degrees();
                write!(
                    f,
                    "roll {roll:.6} deg, heave {heave}, rack {rack} to the left"
                )
            }
            Placement::Travels {
                travels: [left, right],
                rack,
                ..
            } => {
                write!(f, "travels {left} and {right}, rack {rack} to the left")
            }
        }
    }
}

/// Why an axle has no position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AxleFailure {
    /// A wheel does not get there.
    Wheel {
        /// Which.
        side: Side,
        /// Its travel.
        travel: f64,
        /// Why not.
        failure: Failure,
    },
    /// No difference of travels puts both wheels on the ground at this roll angle: a wheel falls where it
    /// should rise, or the iteration did not settle.
    NoGround,
}

impl AxleFailure {
    /// The word in the `status` column.
    pub fn word(&self) -> &'static str {
        match self {
            AxleFailure::Wheel { failure, .. } => crate::curves::Status::Failed(*failure).word(),
            AxleFailure::NoGround => "unreachable",
        }
    }
}

impl std::fmt::Display for AxleFailure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            AxleFailure::Wheel {
                side,
                travel,
                failure,
            } => write!(f, "{} wheel at travel {travel:.6}: {failure}", side.name()),
            AxleFailure::NoGround => {
                write!(f, "no difference of travels puts both wheels on the ground")
            }
        }
    }
}

/// A position that was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed {
    /// Travel of left and right wheel.
    pub travels: [f64; 2],
    /// Roll angle, radians.
    pub roll: f64,
    /// Displacement of the rack towards the left wheel's outside.
    pub rack: f64,
    /// What was held.
    pub hold: Hold,
    poses: [Pose<f64>; 2],
}

impl Placed {
    /// The poses of both carriers, each in the kernel's frame of its own side.
    pub fn poses(&self) -> &[Pose<f64>; 2] {
        &self.poses
    }
}

/// One corner of the axle, ready to be solved.
#[derive(Clone, Debug)]
struct Corner<'a, const N: usize> {
    mechanism: &'a Mechanism,
    solver: Solver<'a>,
    /// For heights and their slopes.
    slopes: DesignSeries<2>,
    series: DesignSeries<N>,
    /// 1, or -1 at the right wheel, whose own frame has the rack move the other way.
    rack_sign: f64,
    toggles: Toggles,
    side: Side,
}

/// Solves the positions of one axle, one design after another. `N` coefficients of every power series are
/// known: one more than the highest derivative that is read.
#[derive(Clone, Debug)]
pub struct AxleSolver<'a, const N: usize> {
    corners: [Corner<'a, N>; 2],
    setup: &'a Setup,
    parts: Parts,
    lines: &'static [Line],
    tape: Tape,
    adjoints: Vec<f64>,
    buffer: Vec<Vector3<Jet<f64, N>>>,
    gradients: [Vec<Vector3<f64>>; 2],
}

/// Newton steps in the difference of travels.
const MOST_STEPS: usize = 40;

impl<'a, const N: usize> Corner<'a, N> {
    fn new(
        axle: &'a Axle,
        side: Side,
        parts: &Parts,
        rockers: &[RockerId],
    ) -> Result<Self, DesignFault> {
        let suspension = axle.suspension(side);
        let mechanism = &suspension.mechanism;
        let design = &suspension.design;
        Ok(Corner {
            mechanism,
            solver: Solver::new(mechanism, design)?,
            slopes: DesignSeries::new(mechanism, design).with_steering_axis(false),
            series: DesignSeries::new(mechanism, design)
                .with_steering_axis(parts.contain_steering_axis()),
            rack_sign: match side {
                Side::Left => 1.0,
                Side::Right => -1.0,
            },
            toggles: Toggles::of(mechanism, rockers.iter().copied()),
            side,
        })
    }

    fn prepare(&mut self, design: &[Vector3<f64>]) -> Result<(), DesignFault> {
        self.solver.prepare(design)?;
        self.slopes.prepare(self.mechanism, design);
        self.series.prepare(self.mechanism, design);
        Ok(())
    }

    /// Solves the pose at a travel and hands it to `read`.
    fn at<R>(
        &mut self,
        travel: f64,
        rack: f64,
        mut read: impl FnMut(
            &Solver,
            &DesignSeries<2>,
            &DesignSeries<N>,
            &Pose<f64>,
        ) -> Result<R, Failure>,
    ) -> Result<R, AxleFailure> {
        let order = StationOrder::through(&[travel]);
        let mut found = Err(Failure::Singular);
        let Corner {
            solver,
            slopes,
            series,
            ..
        } = self;
        let visited = solver.for_each_pose(Drive::Travel, &order, rack, |solver, _, pose| {
            found = pose.and_then(|pose| read(solver, slopes, series, pose));
            ControlFlow::Continue(())
        });
        // The design position was looked at when the solver was made.
        let found = visited.map_err(|_| Failure::Singular).and(found);
        found.map_err(|failure| AxleFailure::Wheel {
            side: self.side,
            travel,
            failure,
        })
    }

    /// Pose, height of the contact point over the origin and its slope by travel, on this ground.
    fn height(
        &mut self,
        travel: f64,
        rack: f64,
        ground: Ground<f64>,
        radius: f64,
    ) -> Result<(Pose<f64>, Jet<f64, 2>), AxleFailure> {
        let rack = rack * self.rack_sign;
        let motion = MotionPoint {
            drive: Drive::Travel,
            value: travel,
            rack,
        };
        let centre = self.mechanism.wheel_centre;
        self.at(travel, rack, |solver, slopes, _, pose| {
            let at = solver.configuration_series(slopes, pose, &motion.along_drive())?;
            let ground = Ground {
                sine: Jet::constant(ground.sine),
                cosine: Jet::constant(ground.cosine),
            };
            let contact = at.point(centre) + ground.contact_lever(at.spin_axis(), radius);
            Ok((*pose, ground.normal().dot(contact)))
        })
    }
}

/// What is read of one wheel at a travel.
#[derive(Clone, Debug)]
pub struct WheelRead {
    travel: f64,
    pose: Pose<f64>,
    reading: Reading<f64>,
    condition: f64,
    /// Whether a rocker is at toggle or beyond.
    toggled: bool,
}

/// What is read in a position.
pub struct Read<'a> {
    /// The state.
    pub state: State<'a, f64>,
    /// The larger condition number of the two wheels.
    pub condition: f64,
    /// Whether a rocker of either wheel is at toggle or beyond.
    pub toggles: [bool; 2],
}

impl Read<'_> {
    /// Whether a quantity moves with a rocker that is at toggle or beyond.
    pub fn is_stuck(&self, quantity: Quantity) -> bool {
        let mut sides = [Side::Left, Side::Right].into_iter();
        sides.any(|side| self.toggles[side as usize] && quantity.moves_with_rocker(side))
    }
}

impl<'a, const N: usize> AxleSolver<'a, N> {
    /// For these quantities; `by_rack` where derivatives by the rack are taken beyond what they ask for.
    pub fn new(
        axle: &'a Axle,
        quantities: &[Quantity],
        by_rack: bool,
    ) -> Result<Self, (Side, DesignFault)> {
        let slots: Vec<_> = quantities.iter().flat_map(|q| q.reads()).copied().collect();
        let parts = Parts::of(&slots);
        let by_rack = by_rack || quantities.iter().any(|q| q.takes_rack());
        let corner = |side| {
            let rockers = axle.rockers(side, quantities);
            let mut corner = Corner::new(axle, side, &parts, &rockers).map_err(|f| (side, f))?;
            let begun = corner.toggles.begin(&mut corner.solver, Drive::Travel, 0.0);
            begun.map_err(|fault| (side, fault))?;
            Ok(corner)
        };
        let corners = [corner(Side::Left)?, corner(Side::Right)?];
        let zero = Vector3::new(0.0, 0.0, 0.0);
        let points = corners[0].mechanism.points.len();
        Ok(AxleSolver {
            corners,
            setup: &axle.setup,
            parts,
            lines: Line::needed(N - 1, by_rack),
            tape: Tape::default(),
            adjoints: Vec::new(),
            buffer: vec![zero.map(Jet::constant); points],
            gradients: [vec![zero; points], vec![zero; points]],
        })
    }

    /// Takes over other designs of the same mechanisms, each in the frame of its side.
    pub fn prepare(&mut self, designs: [&[Vector3<f64>]; 2]) -> Result<(), (Side, DesignFault)> {
        for (corner, design) in self.corners.iter_mut().zip(designs) {
            let side = corner.side;
            corner.prepare(design).map_err(|fault| (side, fault))?;
        }
        Ok(())
    }

    fn radius(&self) -> f64 {
        self.setup.wheel_radius.unwrap_or(f64::NAN)
    }

    /// Finds a position.
    pub fn place(&mut self, placement: &Placement) -> Result<Placed, AxleFailure> {
        let rack = placement.rack();
        let (travels, poses, roll) = match *placement {
            Placement::Roll { heave, roll, .. } => {
                let (travels, poses) = self.rolled(heave, roll, rack)?;
                (travels, poses, roll)
            }
            Placement::Travels {
                travels, on_plane, ..
            } => {
                let mut pose = |side: Side| {
                    let corner = &mut self.corners[side as usize];
                    let rack = rack * corner.rack_sign;
                    corner.at(travels[side as usize], rack, |_, _, _, pose| Ok(*pose))
                };
                let poses = [pose(Side::Left)?, pose(Side::Right)?];
                let roll = match on_plane {
                    false => 0.0,
                    true => self.tilted(&poses)?,
                };
                (travels, poses, roll)
            }
        };
        Ok(Placed {
            travels,
            roll,
            rack,
            hold: placement.hold(),
            poses,
        })
    }

    /// Travels and poses at a roll angle.
    fn rolled(
        &mut self,
        heave: f64,
        roll: f64,
        rack: f64,
    ) -> Result<([f64; 2], [Pose<f64>; 2]), AxleFailure> {
        let (sine, cosine) = roll.sin_cos();
        let ground = Ground { sine, cosine };
        let radius = self.radius();
        let size = self.corners[0].solver.size();
        // Not from the station before: the same position is the same bits, and its mirror image mirrored ones.
        let [left, right] = self.corners.each_ref().map(|corner| {
            let centre = corner.mechanism.wheel_centre;
            corner.solver.design()[centre.0].y
        });
        let mut half = -0.5 * roll * (left + right);
        // Where both wheels stood last, which a step may go back towards.
        let mut reached = None;
        let mut smallest = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            let [left, right] = &mut self.corners;
            let found = left
                .height(heave + half, rack, ground, radius)
                .and_then(|l| {
                    let r = right.height(heave - half, rack, ground.mirrored(), radius)?;
                    Ok((l, r))
                });
            let ((left_pose, left), (right_pose, right)) = match (found, reached) {
                (Ok(found), _) => found,
                // Half the way back to where both wheels could stand.
                (Err(failure), before) => {
                    let back = before.unwrap_or(0.0);
                    if (half - back).abs() <= 1e-9 * size {
                        return Err(failure);
                    }
                    half = 0.5 * (half + back);
                    continue;
                }
            };
            let (mismatch, slope) = (left[0] - right[0], left[1] + right[1]);
            // Written so that NaN is refused.
            if !(left[1] > 0.0 && right[1] > 0.0) {
                return Err(AxleFailure::NoGround);
            }
            let step = -mismatch / slope;
            let is_rounding = step.abs() <= 4.0 * f64::EPSILON * size;
            if is_rounding || step.abs() >= smallest && smallest <= 1e-9 * size {
                return Ok(([heave + half, heave - half], [left_pose, right_pose]));
            }
            smallest = smallest.min(step.abs());
            reached = Some(half);
            half += step;
        }
        Err(AxleFailure::NoGround)
    }

    fn contact(&self, side: Side, pose: &Pose<f64>, ground: Ground<f64>) -> Vector3<f64> {
        let corner = &self.corners[side as usize];
        let design = corner.solver.design();
        let at = crate::mechanism::Configuration {
            mechanism: corner.mechanism,
            design,
            pose: *pose,
            rack: 0.0,
            steering: None,
        };
        at.point(corner.mechanism.wheel_centre)
            + ground.contact_lever(at.spin_axis(), self.radius())
    }

    fn track_of(&self, [left, right]: [&Pose<f64>; 2], ground: Ground<f64>) -> f64 {
        let mirrored = ground.mirrored();
        self.contact(Side::Left, left, ground)
            .dot(ground.outboard())
            + self
                .contact(Side::Right, right, mirrored)
                .dot(mirrored.outboard())
    }

    /// The roll angle at which both wheels stand on a plane.
    fn tilted(&self, [left, right]: &[Pose<f64>; 2]) -> Result<f64, AxleFailure> {
        let mut roll = 0.0_f64;
        let mut smallest = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            let (sine, cosine) = roll.sin_cos();
            let ground = Ground { sine, cosine };
            let mirrored = ground.mirrored();
            let heights = [
                self.contact(Side::Left, left, ground).dot(ground.normal()),
                self.contact(Side::Right, right, mirrored)
                    .dot(mirrored.normal()),
            ];
            let step = -(heights[0] - heights[1]) / self.track_of([left, right], ground);
            if step.abs() <= 2.0 * f64::EPSILON || step.abs() >= smallest && smallest <= 1e-12 {
                return Ok(roll);
            }
            smallest = smallest.min(step.abs());
            roll += step;
        }
        Err(AxleFailure::NoGround)
    }

    /// Reads a position.
    pub fn read(&mut self, placed: &Placed) -> Result<Read<'a>, AxleFailure> {
        let mut wheel = |side: Side| {
            let travel = placed.travels[side as usize];
            let mut curve = self.wheel_curve(side, &[travel], placed.rack);
            curve.swap_remove(0)
        };
        let [left, right] = [wheel(Side::Left)?, wheel(Side::Right)?];
        Ok(self.both([&left, &right], placed))
    }

    /// Reads one wheel at travels, with the rack where it is: outward from the design position, as the curves of
    /// a corner are.
    pub fn wheel_curve(
        &mut self,
        side: Side,
        travels: &[f64],
        rack: f64,
    ) -> Vec<Result<WheelRead, AxleFailure>> {
        let (lines, parts) = (self.lines, self.parts);
        let Corner {
            solver,
            series,
            rack_sign,
            toggles,
            ..
        } = &mut self.corners[side as usize];
        let rack = rack * *rack_sign;
        let fails = |travel: f64, failure| AxleFailure::Wheel {
            side,
            travel,
            failure,
        };
        let unvisited = |travel: &f64| Err(fails(*travel, Failure::Singular));
        let mut found: Vec<_> = travels.iter().map(unvisited).collect();
        let read = |solver: &Solver, pose: &Pose<f64>, travel: f64| {
            let mut snapshots = [Snapshot::<N>::unknown(); 4];
            let (mut condition, mut toggled) = (0.0_f64, false);
            for (number, line) in lines.iter().enumerate() {
                let motion = along(line, travel, rack);
                let (at, conditioning) = solver.conditioned_series(series, pose, &motion)?;
                condition = condition.max(conditioning.number);
                snapshots[number] = Snapshot::of(&at, &parts);
                if number == 0 {
                    toggled = toggles.note(&at, travel).is_some();
                }
            }
            Ok(WheelRead {
                travel,
                pose: *pose,
                reading: Reading::of(&snapshots[..lines.len()]),
                condition,
                toggled,
            })
        };
        // The design position was looked at when the solver was made; what cannot be visited keeps its failure.
        if toggles.begin(solver, Drive::Travel, rack).is_err() {
            return found;
        }
        let order = StationOrder::through(travels);
        let _ = solver.for_each_pose(Drive::Travel, &order, rack, |solver, station, pose| {
            let travel = travels[station];
            let wheel = pose.and_then(|pose| read(solver, pose, travel));
            found[station] = wheel.map_err(|failure| fails(travel, failure));
            ControlFlow::Continue(())
        });
        found
    }

    /// The position of two wheels that were read at their travels.
    pub fn pair(
        &self,
        wheels: [&WheelRead; 2],
        rack: f64,
        on_plane: bool,
    ) -> Result<(Placed, Read<'a>), AxleFailure> {
        let poses = wheels.map(|wheel| wheel.pose);
        let (roll, hold) = match on_plane {
            false => (0.0, Hold::TravelsOnPads),
            true => (self.tilted(&poses)?, Hold::TravelsOnPlane),
        };
        let placed = Placed {
            travels: wheels.map(|wheel| wheel.travel),
            roll,
            rack,
            hold,
            poses,
        };
        Ok((placed, self.both(wheels, &placed)))
    }

    fn both(&self, wheels: [&WheelRead; 2], placed: &Placed) -> Read<'a> {
        let [left, right] = wheels;
        Read {
            state: self.state([left.reading, right.reading], placed),
            condition: left.condition.max(right.condition),
            toggles: [left.toggled, right.toggled],
        }
    }

    fn state<T: crate::number::Real>(
        &self,
        readings: [Reading<T>; 2],
        placed: &Placed,
    ) -> State<'a, T> {
        let like = readings[0].like();
        let (sine, cosine) = placed.roll.sin_cos();
        State {
            readings,
            ground: Ground {
                sine: like.lit(sine),
                cosine: like.lit(cosine),
            },
            roll: like.lit(placed.roll),
            hold: placed.hold,
            setup: self.setup,
        }
    }

    /// The gradients of quantities in a position by every hardpoint coordinate of each side, in the frame of
    /// that side. `receive` gets the number of the quantity and both gradients, by point.
    ///
    /// What a series does not know (because `N` is too small) makes a gradient NaN.
    pub fn gradients(
        &mut self,
        placed: &Placed,
        quantities: &[Quantity],
        mut receive: impl FnMut(usize, [&[Vector3<f64>]; 2]),
    ) -> Result<(), AxleFailure> {
        let (lines, parts) = (self.lines, self.parts);
        let plain = self.read(placed)?.state;
        let slopes = {
            let [left, right] = plain.wheels().map(|wheel| wheel.rise());
            [left + right, plain.track()]
        };
        let motion = |corner: &Corner<'a, N>, line: &Line| {
            let travel = placed.travels[corner.side as usize];
            along::<N>(line, travel, placed.rack * corner.rack_sign)
        };
        let fails = |corner: &Corner<'a, N>, failure| AxleFailure::Wheel {
            side: corner.side,
            travel: placed.travels[corner.side as usize],
            failure,
        };
        let mut linearised = [Vec::new(), Vec::new()];
        for (corner, linearised) in self.corners.iter().zip(&mut linearised) {
            for line in lines {
                let pose = &placed.poses[corner.side as usize];
                let motion = motion(corner, line);
                let found = corner.solver.linearised(&corner.series, pose, &motion);
                linearised.push(found.map_err(|failure| fails(corner, failure))?);
            }
        }
        let snapshots = linearised.each_ref().map(|of_wheel| {
            let lines = of_wheel.iter();
            lines
                .map(|linearised| Snapshot::of(&linearised.at, &parts))
                .collect::<Vec<_>>()
        });
        let inputs = inputs_on_tape::<N>(&parts, lines.len());
        let per_line = inputs / lines.len();
        for (number, quantity) in quantities.iter().enumerate() {
            self.tape.clear();
            let tape = &self.tape;
            let mut first = [0; 2];
            let readings = [0, 1].map(|wheel| {
                first[wheel] = tape.len();
                Reading::on_tape(tape, &snapshots[wheel], &parts)
            });
            let state = self.state(readings, placed).settled(slopes);
            tape.gradient(quantity.evaluate(&state), &mut self.adjoints);
            for wheel in [0, 1] {
                let gradient = &mut self.gradients[wheel];
                gradient.fill(Vector3::new(0.0, 0.0, 0.0));
                let by_wheel = &self.adjoints[first[wheel]..first[wheel] + inputs];
                for (linearised, by) in linearised[wheel].iter().zip(by_wheel.chunks(per_line)) {
                    add_gradient(linearised, &parts, by, &mut self.buffer, gradient);
                }
            }
            let [left, right] = &self.gradients;
            receive(number, [left, right]);
        }
        Ok(())
    }

    /// Number of points of each wheel.
    pub fn points(&self) -> impl Iterator<Item = PointId> {
        (0..self.buffer.len()).map(PointId)
    }
}
