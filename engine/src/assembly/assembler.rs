//! Assembly of parts.
//!
//! The knuckle's pose q satisfies the closure equations with the lengths and shapes of the parts. A sixth equation gives the
//! height of the wheel centre. With A the inverse of the Jacobian in the nominal position, the iteration
//!
//! ```text
//! q <- q - A F(q, parts)
//! ```
//!
//! multiplies the error of the pose by a factor that is proportional to the deviation of the parts, usually about a thousandth
//! (module `settle`). The same code is used for plain numbers, for SIMD lanes (several builds at once) and for derivative numbers.
//! For derivative numbers, each correction makes one more order exact. If a correction is more than half of the previous one, the
//! assembler changes the nominal parts to the built parts in several steps. Each step has its own Jacobian. The determinant of the
//! Jacobian keeps its sign. So the result is always the assembly that a continuous change of the parts reaches from the nominal
//! assembly.
//!
//! Then the positions of the other parts are computed:
//!
//! - A point of an arm keeps its position in the frame of arm axis and outer joint. The origin of this frame is the joint. One
//!   direction is along the arm's axis, another from the axis to the joint.
//! - A point of a rocker rotates with the rocker about the rocker's axis. The length of the rod determines the angle.
//! - The upper part of a strut rotates with the knuckle about its mount.
//!
//! A solid axle on five links is assembled in the pose of least energy instead (module `least_energy`).

use super::alignment::Alignment;
use super::assembly_error::AssemblyError;
use super::carriers::{with_eye, with_spindle};
use super::least_energy::Tensions;
use super::parts::{BuildParameter, Member, Parts, is_of_body};
use super::settle::Settling;
use crate::linear::lu::{Lu6, Matrix6, Vector6};
use crate::mechanism::Twist;
use crate::mechanism::{Closure, Configuration, DesignFault, Driver, Pose, ROUNDING};
use crate::model::{PointId, Suspension};
use crate::number::{Dual, Each, Outlined, Real, Vector3};
use crate::solve::Solver;

/// Shortest step from the nominal to the built parts, as a fraction of the built parts' deviations from nominal.
const SHORTEST_STEP: f64 = 1.0 / 1024.0;

/// Assembles builds of one suspension, one after another.
#[derive(Clone, Debug)]
pub struct Assembler {
    suspension: Suspension,
    drawn: Parts<f64>,
    /// Pose of the nominal design, and the inverse of the Jacobian there.
    home: Linearised,
    size: f64,
    /// Size of the rounding errors of positions, as a length.
    rounding: f64,
}

/// A pose of the carrier and the inverse of the closure equations' Jacobian in this pose.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Linearised {
    pub(crate) pose: Pose<f64>,
    pub(crate) inverse: Matrix6<f64>,
    determinant: f64,
    /// Number of corrections with which the pose of an axle on five links converged (module `least_energy`). 0 for
    /// other suspensions.
    pub(super) rounds: usize,
}

impl Linearised {
    /// Makes a pose with its Jacobian. `None` if the Jacobian is singular. `size` is the size of the mechanism.
    pub(super) fn of(pose: Pose<f64>, jacobian: Matrix6<f64>, size: f64) -> Option<Self> {
        let lu = Lu6::new(jacobian, size)?;
        let mut inverse = [[0.0; 6]; 6];
        for k in 0..6 {
            let mut unit = [0.0; 6];
            unit[k] = 1.0;
            for (row, entry) in inverse.iter_mut().zip(lu.solve(unit)) {
                row[k] = entry;
            }
        }
        Some(Linearised {
            pose,
            inverse,
            determinant: lu.determinant(),
            rounds: 0,
        })
    }
}

impl Assembler {
    /// Prepares to assemble builds of a suspension. Fails if the nominal design cannot move.
    pub fn new(suspension: &Suspension) -> Result<Self, DesignFault> {
        let suspension = with_eye(with_spindle(suspension));
        let (mechanism, design) = (&suspension.mechanism, &suspension.design);
        let solver = Solver::new(mechanism, design)?;
        let (pose, size) = (solver.design_pose(), solver.size());
        let drawn = Parts::drawn(&suspension);
        let rounding = ROUNDING * mechanism.coordinate_scale(design);
        let mut assembler = Assembler {
            home: Linearised {
                pose,
                inverse: [[0.0; 6]; 6],
                determinant: 0.0,
                rounds: 0,
            },
            drawn,
            size,
            rounding,
            suspension,
        };
        assembler.linearise_home()?;
        Ok(assembler)
    }

    /// Changes to another nominal design of the same suspension. Fails if that design cannot move.
    pub fn redraw(&mut self, design: &[Vector3<f64>]) -> Result<(), DesignFault> {
        self.suspension.design.copy_from_slice(design);
        let softness = std::mem::take(&mut self.drawn.softness);
        self.drawn = Parts {
            softness,
            ..Parts::of_drawing(&self.suspension.mechanism, design)
        };
        self.home.pose.origin = design[self.suspension.mechanism.origin.0];
        self.linearise_home()
    }

    fn linearise_home(&mut self) -> Result<(), DesignFault> {
        let home = if self.suspension.mechanism.has_extra_links() {
            self.relax(&self.drawn, 0.0, &self.home)
        } else {
            self.linearise(&self.drawn, &self.home.pose)
        };
        self.home = home.ok_or(DesignFault::Singular)?;
        Ok(())
    }

    /// Nominal suspension. Its spin axis always runs through a point of the carrier. If the study gives static camber and
    /// toe instead of such a point, the assembler adds the point `spindle_inner`. A twist beam also gets the point
    /// `mount_eye`.
    pub fn suspension(&self) -> &Suspension {
        &self.suspension
    }

    /// Nominal parts.
    pub fn drawn(&self) -> &Parts<f64> {
        &self.drawn
    }

    pub(super) fn drawn_mut(&mut self) -> &mut Parts<f64> {
        &mut self.drawn
    }

    pub(crate) fn home(&self) -> &Linearised {
        &self.home
    }

    /// Largest distance of a point from the carrier's origin, in the first nominal design.
    pub(super) fn size(&self) -> f64 {
        self.size
    }

    /// Size of the rounding errors of positions, as a length.
    pub(super) fn rounding(&self) -> f64 {
        self.rounding
    }

    /// Assembles parts with the wheel centre `height` above its nominal height, and writes the built design. Returns the
    /// tensions that the parts cause in the links of an axle on five links.
    pub fn assemble(
        &self,
        parts: &Parts<f64>,
        height: f64,
        into: &mut [Vector3<f64>],
    ) -> Result<Tensions, AssemblyError> {
        let parts = &*self.turned(parts);
        self.check_turned(parts)?;
        if !self.suspension.mechanism.has_extra_links() {
            let pose = self.pose(parts, height)?;
            self.place_checked(parts, &pose, into)?;
            return Ok(None);
        }
        let at = self.position(parts, height)?;
        self.place_checked(parts, &at.pose, into)?;
        Ok(self.tensions(parts, height, &at))
    }

    /// Writes the built design of parts whose pose is known. Fails if a member has no positive length, or if a rod is
    /// too short, too long or at a toggle.
    pub(super) fn place_checked(
        &self,
        parts: &Parts<f64>,
        pose: &Pose<f64>,
        into: &mut [Vector3<f64>],
    ) -> Result<(), AssemblyError> {
        self.check_lengths(parts)?;
        self.place(parts, pose, into);
        self.check_rods(into)
    }

    /// Checks that every member has a positive length. The error names the first member that does not. The closure
    /// equations contain squares of lengths, so they would accept a negative length.
    fn check_lengths(&self, parts: &Parts<f64>) -> Result<(), AssemblyError> {
        let mut pairs = parts.lengths.iter().zip(&self.drawn.lengths);
        // Only rods have a length; other constraints store 0.
        let Some(place) = pairs.position(|(length, drawn)| *drawn > 0.0 && *length <= 0.0) else {
            return Ok(());
        };
        let mechanism = &self.suspension.mechanism;
        let mut members = Member::all(mechanism).into_iter();
        let named = members.find(|(_, member)| member.place(mechanism) == place);
        Err(AssemblyError::NoLength(
            named.map_or_else(String::new, |(name, _)| name),
        ))
    }

    /// Derivative of the carrier's pose with respect to a dimension of the parts, at the nominal design:
    /// displacement, then rotation.
    pub(super) fn twist_by(&self, (parameter, share): (BuildParameter, f64)) -> Vector6<f64> {
        let mut parts = self.drawn.map(Dual::<f64, 1>::constant);
        let along = Dual {
            value: 0.0,
            partials: [share],
        };
        parts.change(&self.suspension.mechanism, parameter, along);
        let closure = self.closure(&parts);
        let pose = self.home.pose.map(Dual::constant);
        let height = Dual::constant(0.0);
        let inverse = &self.home.inverse;
        let (_, correction) = self.corrected(&closure, &parts, height, &pose, inverse);
        correction.each(|c| c.partials[0])
    }

    /// Returns the pose of the carrier, starting from the nominal pose. For a solid axle, `parts` must be the parts that
    /// [`Assembler::turned`] returns, here and in the functions below.
    pub(crate) fn pose(&self, parts: &Parts<f64>, height: f64) -> Result<Pose<f64>, AssemblyError> {
        if self.suspension.mechanism.has_extra_links() {
            return Ok(self.position(parts, height)?.pose);
        }
        match self.settle(&mut parts.clone(), None, height, &self.home) {
            Some(pose) => Ok(pose),
            None => Ok(self.approach(parts, height)?.pose),
        }
    }

    /// Returns the pose of the carrier and the inverse of the Jacobian there, starting from the nominal pose.
    pub(super) fn position(
        &self,
        parts: &Parts<f64>,
        height: f64,
    ) -> Result<Linearised, AssemblyError> {
        if !self.suspension.mechanism.has_extra_links() {
            let pose = self.pose(parts, height)?;
            let at = self.linearise(parts, &pose);
            return at.ok_or(AssemblyError::OutOfReach { share: 1.0 });
        }
        match self.relax(parts, height, &self.home) {
            Some(at) => Ok(at),
            None => self.approach(parts, height),
        }
    }

    /// Returns the pose of parts, starting from a nearby known pose, and the inverse of the Jacobian there.
    fn next(&self, parts: &Parts<f64>, height: f64, from: &Linearised) -> Option<Linearised> {
        if self.suspension.mechanism.has_extra_links() {
            return self.relax(parts, height, from);
        }
        let pose = self.settle(&mut parts.clone(), None, height, from)?;
        self.linearise(parts, &pose)
    }

    /// Changes the nominal parts to the given parts step by step, and computes the pose after each step.
    fn approach(&self, parts: &Parts<f64>, height: f64) -> Result<Linearised, AssemblyError> {
        let (mut reached, mut step) = (0.0, 0.25_f64);
        let mut place = self.home;
        while reached < 1.0 {
            let target = (reached + step).min(1.0);
            let between = self.between(parts, target);
            let found = self.next(&between, height * target, &place);
            let found = found.filter(|found| {
                let ratio = found.determinant / place.determinant;
                ratio > 0.5 && ratio < 2.0
            });
            match found {
                Some(found) => {
                    (place, reached) = (found, target);
                    step *= 2.0;
                }
                None => {
                    step *= 0.5;
                    if step < SHORTEST_STEP {
                        return Err(AssemblyError::OutOfReach { share: reached });
                    }
                }
            }
        }
        Ok(place)
    }

    fn between(&self, parts: &Parts<f64>, share: f64) -> Parts<f64> {
        let mix = |from: f64, to: f64| match share {
            1.0 => to,
            _ => from + (to - from) * share,
        };
        let points = self.drawn.points.iter().zip(&parts.points);
        let lengths = self.drawn.lengths.iter().zip(&parts.lengths);
        Parts {
            points: points
                .map(|(a, b)| Vector3::new(mix(a.x, b.x), mix(a.y, b.y), mix(a.z, b.z)))
                .collect(),
            lengths: lengths.map(|(a, b)| mix(*a, *b)).collect(),
            softness: parts.softness.clone(),
            drawn: parts.drawn.clone(),
        }
    }

    /// Finds the pose of parts by corrections from a known pose. If there is an alignment, its adjustments are added to
    /// the parts.
    pub(super) fn settle(
        &self,
        parts: &mut Parts<f64>,
        alignment: Option<&Alignment>,
        height: f64,
        from: &Linearised,
    ) -> Option<Pose<f64>> {
        let settling = Settling {
            assembler: self,
            parts,
            alignment,
            height,
            from,
            carrier: &mut Vec::new(),
        };
        let (pose, settled) = settling.work();
        settled.then_some(pose)
    }

    /// Makes one correction q - A F of a pose q, with the symbols of this module. `inverse` is A. Returns the corrected pose and
    /// the correction.
    #[inline(always)]
    pub(crate) fn corrected<T: Real>(
        &self,
        closure: &Closure<T>,
        parts: &Parts<T>,
        height: T,
        pose: &Pose<T>,
        inverse: &Matrix6<f64>,
    ) -> (Pose<T>, Vector6<T>) {
        let mut at = self.configuration(parts, pose);
        if self.suspension.mechanism.rigid_axle.is_some() {
            at.rack = height;
        }
        let residuals = if T::IN_REGISTERS {
            closure.residuals_inlined(&at, self.driver(parts, height))
        } else {
            closure.residuals(&at, self.driver(parts, height))
        };
        let mut correction = residuals;
        for (entry, row) in correction.iter_mut().zip(inverse) {
            let mut sum = residuals[0].scaled(-row[0]);
            for k in 1..6 {
                sum = sum.minus_product(residuals[k], sum.constant(row[k]));
            }
            *entry = sum;
        }
        let twist = Twist::from_array(correction);
        (
            pose.moved(twist.shift, twist.turn * height.constant(0.5)),
            correction,
        )
    }

    /// Equation that keeps the wheel centre at `height` above its nominal height. `parts` gives the position of the wheel
    /// centre in the carrier. On a solid axle, both wheel centres have this height.
    #[inline(always)]
    fn driver<T: Real>(&self, parts: &Parts<T>, height: T) -> Driver<T> {
        if self.suspension.mechanism.rigid_axle.is_some() {
            return Driver::Travel(height.zero());
        }
        let centre = self.suspension.mechanism.wheel_centre.0;
        let drawn = parts.drawn[centre].z;
        Driver::Travel(drawn - parts.points[centre].z + height)
    }

    #[inline(always)]
    pub(super) fn configuration<'a, T: Real>(
        &'a self,
        parts: &'a Parts<T>,
        pose: &Pose<T>,
    ) -> Configuration<'a, T> {
        Configuration::new(
            &self.suspension.mechanism,
            &parts.points,
            *pose,
            pose.origin.x.zero(),
        )
    }

    /// Returns the closure equations of parts.
    pub(crate) fn closure<T: Real>(&self, parts: &Parts<T>) -> Closure<T> {
        self.closure_in(parts, &mut Vec::new())
    }

    /// Returns the position of a point in the undisplaced carrier. For a point of the body or of the rack, it is the nominal
    /// position. The same applies to the mount of a twist beam at the wheel to which the mechanism belongs.
    #[inline(always)]
    pub(super) fn in_carrier<T: Real>(&self, parts: &Parts<T>, number: usize) -> Vector3<T> {
        let mechanism = &self.suspension.mechanism;
        let beam = mechanism
            .rigid_axle
            .as_ref()
            .and_then(|rigid| rigid.twist_beam);
        let id = PointId(number);
        if is_of_body(mechanism, id) || beam.is_some_and(|beam| beam.mount == id) {
            parts.drawn[number]
        } else {
            parts.points[number]
        }
    }

    /// Returns a pose with the inverse of the closure equations' Jacobian in this pose. `None` if the Jacobian is singular.
    pub(crate) fn linearise(&self, parts: &Parts<f64>, pose: &Pose<f64>) -> Option<Linearised> {
        let at = self.configuration(parts, pose);
        let jacobian = self.closure(parts).jacobian(&at, Driver::Travel(0.0));
        Linearised::of(*pose, jacobian, self.size)
    }

    /// Returns the pose of parts whose dimensions are derivative numbers with `orders` orders. `at` holds the values of the pose.
    /// One correction per order makes the derivatives exact.
    pub(crate) fn pose_series<T: Real>(
        &self,
        parts: &Parts<T>,
        height: T,
        at: &Linearised,
        orders: usize,
    ) -> Pose<T> {
        if self.suspension.mechanism.has_extra_links() {
            return self.relaxed_series(parts, height, at, orders).0;
        }
        let closure = self.closure(parts);
        let mut pose = at.pose.map(|c| height.constant(c));
        for _ in 0..orders {
            pose = self
                .corrected(&closure, parts, height, &pose, &at.inverse)
                .0;
        }
        pose
    }
}
