//! Six unknowns: the pose of the knuckle, solved from the closure equations.
//!
//! The unknowns are the displacement of the knuckle's origin, and its rotation from the design position as tan(angle/2)
//! times the axis. At a prediction, a step of Newton's method on five constraints and the travel
//!
//! ```text
//! J (v, w) = -F        x + v,  r + h + h x r + r (r.h),  h = w/2
//! ```
//!
//! leaves an error of second order. The residuals after the step show whether the pose is accurate enough. If so, one more step
//! with J removes the remaining residuals, because these would disturb rates near a fold.
//!
//! J, its moments divided by the size of the mechanism, is split into four blocks of three by three,
//!
//! ```text
//! J = | A  B |        S = D - C A^-1 B,   det J = det A det S
//!     | C  D |
//! ```
//!
//! in an order of rows and columns that a factorisation with complete pivoting finds for the base design, near which the
//! tracked designs lie. Then only the two determinants of A and S must not vanish. A lane is rejected if a determinant is
//! less than a fourth of its value in the base design. It is also rejected if a determinant changes by more than half, or
//! more than doubles, from one waypoint to the next. The determinants of a lane come from its last step, with which it
//! converged.
//!
//! An instantaneous steering axis is the axis of the screw t with J t = -F_r (module `steering`). F_r is the derivative of
//! F with respect to the rack. Along the motion, the derivative of t, t', follows from J t' = -(F_r' + J' t).

#![allow(
    clippy::needless_range_loop,
    reason = "the closures of iterators may be left as calls, compiled for no lanes"
)]

mod blocks;
mod corner;
#[cfg(test)]
mod guards;
mod linear;
mod mirrored;
mod newton;
mod one_body;
mod pose;
mod series;
mod wheel;

use super::Visit;
use super::pair::WheelOnKnuckle;
use crate::mechanism::{Closure, Driver};
use crate::mechanism::{Configuration, Pose, Twist};
use crate::model::{Drive, Mechanism};
use crate::number::Real;
use crate::number::SimdReal;
use crate::number::{Each, Matrix3, Vector3};
use blocks::{Blocks, Order};
pub(super) use corner::LinkageCorner;
use linear::Linear;
pub(super) use newton::NewtonSteps;
pub(super) use one_body::{ALL as UNKNOWNS_OF_AXLE, OneBody};
pub(crate) use pose::LinkagePose;
pub(crate) use series::SeriesAdjoint;
use std::cell::{Cell, RefCell};
pub(super) use wheel::LinkageWheel;

/// Number of unknowns of a pose: three for the displacement of the knuckle's origin, three for its rotation (a Rodrigues
/// vector).
pub(crate) const UNKNOWNS: usize = 6;

/// Equations of a mechanism without a closed form.
#[derive(Clone, Debug)]
pub(crate) struct ByLinkage {
    order: Order,
    size: f64,
    /// Determinants of the Jacobian's blocks A and S in the base design.
    determinants: [f64; 2],
    /// Derivatives of the unknowns with respect to travel, in the base design.
    by_travel: [f64; UNKNOWNS],
    /// Derivatives of the unknowns with respect to the rack, in the base design.
    by_rack: [f64; UNKNOWNS],
}

/// Constants of the designs, one design in each SIMD lane.
#[derive(Clone)]
pub(crate) struct LinkageDesign<'d, B> {
    mechanism: &'d Mechanism,
    design: &'d [Vector3<B>],
    closure: Closure<B>,
}

impl<'d, B: Real> LinkageDesign<'d, B> {
    #[inline(always)]
    pub(crate) fn new(mechanism: &'d Mechanism, design: &'d [Vector3<B>]) -> Self {
        LinkageDesign {
            mechanism,
            design,
            closure: Closure::new(mechanism, design),
        }
    }

    /// Configuration of the mechanism with these unknowns.
    #[inline(always)]
    fn configuration(&self, [x, y, z, a, b, c]: [B; UNKNOWNS], rack: B) -> Configuration<'d, B> {
        let shift = Vector3::new(x, y, z);
        Configuration {
            mechanism: self.mechanism,
            design: self.design,
            pose: Pose {
                origin: self.design[self.mechanism.origin.0] + shift,
                rotation: Matrix3::by_rodrigues(Vector3::new(a, b, c)),
            },
            rack,
            steering: None,
        }
    }
}

/// The unknowns after a small twist of the knuckle.
#[inline(always)]
fn moved<B: Real>(unknowns: [B; UNKNOWNS], twist: &Twist<B>) -> [B; UNKNOWNS] {
    let [x, y, z, a, b, c] = unknowns;
    let turned = Vector3::new(a, b, c);
    let half = turned.x.constant(0.5);
    let h = twist.turn * half;
    let r = (turned + h + h.cross(turned)).plus_scaled(turned, turned.dot(h));
    let v = twist.shift;
    [x + v.x, y + v.y, z + v.z, r.x, r.y, r.z]
}

impl ByLinkage {
    /// Prepares to solve designs of a mechanism with the travel as the drive. `None` if the drive is another quantity, or if
    /// designs near `base` cannot be tracked.
    pub(crate) fn of(
        mechanism: &Mechanism,
        base: &[Vector3<f64>],
        drive: Drive,
        size: f64,
    ) -> Option<ByLinkage> {
        (drive == Drive::Travel).then_some(())?;
        let linkage = LinkageDesign::new(mechanism, base);
        let at = linkage.configuration([0.0; UNKNOWNS], 0.0);
        let wrenches = linkage.closure.wrenches(&at, Driver::Travel(0.0));
        let mut blocks = Blocks::unformed(Order::of(&wrenches, size)?, 1.0 / size);
        for (number, wrench) in wrenches.iter().enumerate() {
            blocks.put(number, wrench);
        }
        blocks.eliminate();
        let slope = |twist: Twist<f64>| moved([0.0; UNKNOWNS], &twist);
        Some(ByLinkage {
            order: blocks.order,
            size,
            determinants: blocks.determinants(),
            by_travel: slope(blocks.solve([0.0, 0.0, 0.0, 0.0, 0.0, 1.0])),
            by_rack: slope(blocks.solve(wrenches.each(|row| -row.rack))),
        })
    }

    /// Passes the poses with these unknowns to a visitor.
    #[inline(always)]
    pub(crate) fn visit_stations_in_lanes<B: SimdReal>(
        &self,
        linkage: &LinkageDesign<'_, B>,
        unknowns: [B; UNKNOWNS],
        travel: B,
        rack: B,
        visit: impl FnOnce(&LinkagePose<'_, '_, B>),
    ) {
        let room = RefCell::new(Linear::unformed(self, travel));
        visit(&LinkagePose {
            linkage,
            at: linkage.configuration(unknowns, rack),
            travel,
            linear: &room,
            is_linear: Cell::new(false),
        });
    }

    /// Equations of a single wheel, for a design that this tracker has made.
    #[inline(always)]
    pub(super) fn corner<'w, 'd, B: SimdReal, V: Visit<B>>(
        &'w self,
        linkage: &'w LinkageDesign<'d, B>,
        tolerance: f64,
        visitor: &'w mut V,
    ) -> LinkageCorner<'w, 'd, B, V> {
        let steps = NewtonSteps::of(self, linkage, tolerance);
        LinkageCorner {
            is_near: steps.determinants[0].everywhere(),
            steps,
            visitor,
        }
    }

    /// Equations of one wheel of a pair, for a design that this tracker has made.
    #[inline(always)]
    pub(super) fn wheel<'w, 'd, B: SimdReal>(
        &'w self,
        linkage: &'w LinkageDesign<'d, B>,
        on_knuckle: WheelOnKnuckle<B>,
        tolerance: f64,
    ) -> LinkageWheel<'w, 'd, B> {
        let steps = NewtonSteps::of(self, linkage, tolerance);
        let zero = steps.determinants[0];
        let null = Vector3::new(zero, zero, zero);
        let rest = Twist {
            shift: null,
            turn: null,
        };
        LinkageWheel {
            steps,
            on_knuckle,
            rest,
            by_travel: rest,
        }
    }
}
