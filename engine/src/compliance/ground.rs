//! Bodies that hold the inner ends of a wheel's parts: body, subframe and rack.
//!
//! The energy of parts on the subframe depends only on the carrier's pose relative to the subframe. So the program
//! computes the forces of these parts in the subframe's axes, with the formulas for a body at rest. Let O and S be the
//! reference points of carrier and subframe, and r = O - S. Small shifts and rotations are du and dw for the carrier,
//! and ds and w_s for the subframe. Relative to the subframe, the carrier moves by du' and dw'. With the subframe's
//! rotation R (transpose R'), and the force f and moment m on the carrier,
//!
//! ```text
//! du' = R'(du - ds - w_s x r),   dw' = R'(dw - w_s)                                               (1)
//! on the subframe: -f, -(m + r x f)                                                               (2)
//! d(R f) = R df' + w_s x f                                                                        (3)
//! ```
//!
//! Relative to the subframe, a point P of the body, at p = P - S, moves by dp' = R'(-ds + p x w_s) (4). The rack shifts
//! along y in the axes of its holder. For parts on the rack, this shift is equivalent to the opposite shift of the
//! carrier (5).

use super::algebra::{Placed, cross_matrix};
use super::bushing::BushingState;
use super::coupling::{InFrame, JointRow};
use super::gather::Gathered;
use super::limb::{BESIDE, Conditions, Sum, TWIST_BESIDE, joined, tangent_of};
use super::point::PointForce;
use super::system::{CarrierBushing, Equations, System};
use crate::linear::square::MOST;
use crate::number::{Each, Matrix3, Scalar, Valued, Vector3};

/// Number of unknowns that both wheels share: shift and rotation of the subframe, shift of the rack, and twist of the
/// anti-roll bar's middle.
pub(super) const SHARED: usize = 8;
/// Index of the rack's shift among the shared unknowns.
pub(super) const RACK: usize = 6;
/// Index of the bar's twist among the shared unknowns.
pub(super) const TWIST: usize = 7;

/// Body that holds the inner end of a part: body of the vehicle, or subframe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Holder {
    Body,
    Subframe,
}

impl Holder {
    /// Index of the sum for the parts on the rack. The sums for the body and the subframe have the indices 0 and 1.
    pub(super) const RACK: usize = 2;
}

/// Bodies that hold the parts of a system, in the order of the parts.
#[derive(Clone, Debug)]
pub(super) struct Holders {
    pub(super) limbs: Vec<Holder>,
    pub(super) bushings: Vec<Holder>,
    pub(super) rods: Vec<Holder>,
    pub(super) joints: Vec<Holder>,
    /// Body that holds the housing of the rack.
    pub(super) rack: Holder,
}

impl Holders {
    /// Returns empty lists of holders, for a system without parts.
    pub(super) fn none() -> Self {
        Holders {
            limbs: Vec::new(),
            bushings: Vec::new(),
            rods: Vec::new(),
            joints: Vec::new(),
            rack: Holder::Body,
        }
    }
}

/// Connection of one wheel's parts to the subframe.
#[derive(Clone, Debug)]
pub(super) struct SubframePart<T> {
    /// Vector from the subframe's reference point to the carrier's, in the design position.
    pub(super) to_carrier: Vector3<T>,
    /// Mounts at the body. Their lever arms start at the subframe's reference point.
    pub(super) mounts: Vec<CarrierBushing<T>>,
    /// Vector from the subframe's reference point to the upper end of the spring at the body. `None` unless the spring
    /// acts on an arm of the subframe.
    pub(super) upper: Option<Vector3<T>>,
}

/// Positions of the shared bodies, in the axes of a left wheel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surroundings<T> {
    pub(super) subframe: Placed<T>,
    pub(super) rack: T,
    pub(super) twist: T,
}

impl<T: Valued> Surroundings<T> {
    /// Positions of the shared bodies if only the rack is displaced.
    #[inline(always)]
    pub(super) fn of_rack(rack: T) -> Self {
        Surroundings {
            subframe: Placed::design(rack),
            rack,
            twist: rack.zero(),
        }
    }

    /// Converts the positions of the shared bodies to the axes of the other wheel.
    pub(super) fn mirrored(&self) -> Self {
        let Placed { shift, turn } = &self.subframe;
        let [a, b, c] = turn.columns;
        Surroundings {
            subframe: Placed {
                shift: Vector3::new(shift.x, -shift.y, shift.z),
                turn: Matrix3 {
                    columns: [
                        Vector3::new(a.x, -a.y, a.z),
                        Vector3::new(-b.x, b.y, -b.z),
                        Vector3::new(c.x, -c.y, c.z),
                    ],
                },
            },
            rack: -self.rack,
            twist: self.twist,
        }
    }
}

/// Signs that convert the shared unknowns to the axes of the other wheel.
pub(super) const MIRROR: [f64; SHARED] = [1.0, -1.0, 1.0, -1.0, 1.0, -1.0, -1.0, 1.0];

/// Displacements of carrier and rack, with options, for computing the forces of a wheel's parts. One set is relative to the body,
/// the other to the subframe.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frames<T> {
    pub(super) body: Conditions<T>,
    pub(super) subframe: Conditions<T>,
}

impl<T: Valued> Frames<T> {
    /// Sets [`Conditions::is_correction`] for both frames.
    #[inline(always)]
    pub(super) fn for_correction(mut self) -> Self {
        self.body.is_correction = true;
        self.subframe.is_correction = true;
        self
    }

    #[inline(always)]
    pub(super) fn of(&self, holder: Holder) -> &Conditions<T> {
        match holder {
            Holder::Body => &self.body,
            Holder::Subframe => &self.subframe,
        }
    }
}

/// Forces of a wheel's parts on the shared bodies, with their tangents, in the axes of a left wheel.
#[derive(Clone, Debug)]
pub(super) struct Coupling<T> {
    pub(super) force: [T; SHARED],
    pub(super) own: [[T; SHARED]; SHARED],
    pub(super) by_corner: [[T; MOST]; SHARED],
    pub(super) corner_by: [[T; SHARED]; MOST],
    /// Responses of the parts that have their own degrees of freedom and also depend on the coordinates in `Beside`. Each
    /// response is stored with the index of its part.
    pub(super) beside: Vec<(usize, [[T; BESIDE]; 6])>,
}

impl<T: Valued> Coupling<T> {
    /// Makes the tangents constant: removes their derivatives, as [`Conditions::is_correction`] requires.
    pub(super) fn fix_tangents(&mut self) {
        let fixed = |c: T| tangent_of(c, true);
        self.own = self.own.each(|row| row.each(fixed));
        self.by_corner = self.by_corner.each(|row| row.each(fixed));
        self.corner_by = self.corner_by.each(|row| row.each(fixed));
        for (_, by) in &mut self.beside {
            *by = by.each(|row| row.each(fixed));
        }
    }
}

impl<T: Valued> System<T> {
    #[inline(always)]
    pub(super) fn frames(
        &self,
        carrier: &Placed<T>,
        around: &Surroundings<T>,
        balance_only: bool,
    ) -> Frames<T> {
        let zero = around.rack.zero();
        let body = Conditions {
            carrier: *carrier,
            rack: around.rack,
            upper: Vector3::new(zero, zero, zero),
            twist: around.twist,
            balance_only,
            is_correction: false,
        };
        let subframe = match &self.subframe {
            None => body,
            Some(part) => part.seen(&body, &around.subframe),
        };
        Frames { body, subframe }
    }
}

impl<T: Scalar> System<T> {
    /// Adds the elastic parts and joints of a wheel that is connected to shared bodies. Returns the forces of these
    /// parts on the shared bodies.
    pub(super) fn add_coupled(
        &self,
        found: &Gathered<T>,
        frames: &Frames<T>,
        around: &Surroundings<T>,
        equations: &mut Equations<T>,
    ) -> Coupling<T> {
        let zero = around.rack.zero();
        let mut coupling = Coupling {
            force: [zero; SHARED],
            own: [[zero; SHARED]; SHARED],
            by_corner: [[zero; MOST]; SHARED],
            corner_by: [[zero; SHARED]; MOST],
            beside: Vec::new(),
        };
        for holder in [Holder::Body, Holder::Subframe] {
            let mut part = InFrame::of(&found.sums[holder as usize]);
            if self.holders.rack == holder {
                part.add_rack(&found.sums[Holder::RACK]);
            }
            for (limb, on, beside) in &found.beside {
                if *on == holder {
                    part.add_beside(beside);
                    coupling.beside.push((*limb, beside.inner_by));
                }
            }
            let seat = match (&self.subframe, holder) {
                (Some(own), Holder::Subframe) => Some(own.pose(frames, around)),
                _ => None,
            };
            part.add_to(seat.as_ref(), equations, &mut coupling);
            for (k, joint) in self.joints.iter().enumerate() {
                if self.holders.joints[k] == holder {
                    let row = JointRow {
                        number: k,
                        miss: found.joints[k].0,
                        row: found.joints[k].1,
                        on_rack: joint.is_on_rack(),
                    };
                    row.add_to(seat.as_ref(), equations, &mut coupling);
                }
            }
        }
        if let Some(own) = &self.subframe {
            own.add_mounts(frames, around, &mut coupling);
        }
        coupling
    }

    /// Returns the step of the carrier, and the step of the coordinates in [`Beside`]. Both steps are relative to the
    /// body that holds the part `limb` (index of a part with its own degrees of freedom).
    pub(super) fn seen_step(
        &self,
        limb: usize,
        carrier: &[T; 6],
        shared: &[T; SHARED],
        frames: &Frames<T>,
        around: &Surroundings<T>,
    ) -> ([T; 6], [T; BESIDE]) {
        let on_rack = self.limbs[limb].is_on_rack();
        self.seen_by(
            self.holders.limbs[limb],
            on_rack,
            carrier,
            shared,
            frames,
            around,
        )
    }

    /// Returns the step of the carrier, and the step of the coordinates in [`Beside`]. Both steps are relative to the
    /// body `holder`, and to the rack if `on_rack` is true.
    pub(super) fn seen_by(
        &self,
        holder: Holder,
        on_rack: bool,
        carrier: &[T; 6],
        shared: &[T; SHARED],
        frames: &Frames<T>,
        around: &Surroundings<T>,
    ) -> ([T; 6], [T; BESIDE]) {
        let zero = shared[0].zero();
        let mut seen = *carrier;
        let mut beside = [zero; BESIDE];
        beside[TWIST_BESIDE] = shared[TWIST];
        if let (Some(own), Holder::Subframe) = (&self.subframe, holder) {
            let pose = own.pose(frames, around);
            let [x, y, z, a, b, c, ..] = *shared;
            let (s, w) = (Vector3::new(x, y, z), Vector3::new(a, b, c));
            let [x, y, z, a, b, c] = *carrier;
            let shift = Vector3::new(x, y, z) - s + pose.lever.cross(w);
            let turn = Vector3::new(a, b, c) - w;
            let back = |v: Vector3<T>| pose.rotation.apply_transposed(v);
            seen = joined(back(shift), back(turn));
            if let Some(upper) = pose.upper {
                let moved = back(upper.cross(w) - s).to_array();
                beside[..3].copy_from_slice(&moved);
            }
        }
        if on_rack {
            seen[1] = seen[1] - shared[RACK];
        }
        (seen, beside)
    }

    /// State of a mount of the subframe.
    pub(super) fn mount_state(
        &self,
        number: usize,
        around: &Surroundings<T>,
    ) -> Option<BushingState<T>> {
        let mount = self.subframe.as_ref()?.mounts.get(number)?;
        let moved = around.subframe.displacement(mount.lever);
        Some(mount.bushing.state(moved, &around.subframe.turn))
    }
}

/// Present position of the subframe, with the vectors of equations (1) to (4) of this module.
pub(super) struct Pose<T> {
    pub(super) rotation: Matrix3<T>,
    /// Vector r of equation (1) of this module, from the subframe's reference point S to the carrier's reference point O.
    pub(super) lever: Vector3<T>,
    /// Vector p of equation (4) of this module, from the subframe's reference point to the spring's upper end.
    pub(super) upper: Option<Vector3<T>>,
    /// True while the program computes the forces at the design load (see [`Conditions::balance_only`]). Then forces do
    /// not rotate with the subframe, and their lever arms stay constant.
    balance_only: bool,
}

impl<T: Valued> Pose<T> {
    /// Returns the cross-product matrix of a force. With this matrix, the program computes the change of the force with
    /// a rotation, and the change of the moment with the lever arm.
    pub(super) fn turning(&self, force: Vector3<T>) -> Matrix3<T> {
        if self.balance_only {
            Matrix3::null(force.x)
        } else {
            cross_matrix(force)
        }
    }
}

impl<T: Valued> SubframePart<T> {
    /// Returns the displacements of a wheel's parts and the options, relative to the subframe.
    fn seen(&self, body: &Conditions<T>, subframe: &Placed<T>) -> Conditions<T> {
        let back = subframe.turn.transposed();
        let unturned = |v: Vector3<T>| v + back.apply(v);
        let carrier = Placed {
            shift: unturned(body.carrier.shift - subframe.shift) + back.apply(self.to_carrier),
            turn: back
                .plus(&body.carrier.turn)
                .plus(&back.times(&body.carrier.turn)),
        };
        let upper = match self.upper {
            Some(upper) => back.apply(upper) - unturned(subframe.shift),
            None => body.upper,
        };
        Conditions {
            carrier,
            upper,
            ..*body
        }
    }

    fn pose(&self, frames: &Frames<T>, around: &Surroundings<T>) -> Pose<T> {
        Pose {
            rotation: around.subframe.rotation(),
            lever: self.to_carrier + frames.body.carrier.shift - around.subframe.shift,
            upper: self.upper.map(|upper| upper - around.subframe.shift),
            balance_only: frames.body.balance_only,
        }
    }

    /// Adds the forces of the subframe's mounts at the body.
    fn add_mounts(&self, frames: &Frames<T>, around: &Surroundings<T>, coupling: &mut Coupling<T>) {
        let mut sum = Sum::zero(around.rack);
        for mount in &self.mounts {
            let e = around.subframe.displacement(mount.lever);
            let force = frames
                .body
                .force(&mount.bushing, e, &around.subframe.turn, None);
            let point = PointForce::of(force.force, force.by_shift);
            sum.add_point(around.subframe.lever(mount.lever), &point);
            sum.add_moment(force.moment, &force.by_turn);
        }
        for i in 0..6 {
            coupling.force[i] = coupling.force[i] + sum.force[i];
            for j in 0..6 {
                coupling.own[i][j] = coupling.own[i][j] + sum.tangent[i][j];
            }
        }
    }
}
