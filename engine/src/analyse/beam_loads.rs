//! Forces at the mounts and in the cross member of a twist beam under a load.
//!
//! `model/twist_beam.rs` describes the model. The near half carries the wheel whose mechanism is used (the near wheel).
//! The far half carries the opposite wheel (the far wheel). A mount holds one half of the beam in x and z. Relative to
//! the mounts, both arms move sideways by equal distances in opposite directions, so the forces on the mounts along y
//! are equal. In the model, three rods connect the far mount M to two points of the hinge and to a point of the far
//! half. The tensions t of these rods act along the unit vectors u towards M. The body acts on the far half with the
//! sum of these forces:
//!
//! ```text
//! F = sum t u                                                                                    (1)
//! ```
//!
//! A is the force of the far half's spring or, without a spring, the vertical force that supports the far wheel centre.
//! It acts at the point a. The far half acts on the near half at the shear centre S. From the balance of the far half,
//! this force H and this moment M_S are
//!
//! ```text
//! H = F + A,        M_S = (M - S) x F + (a - S) x A                                              (2)
//! ```
//!
//! M_S has no component along the hinge. The torque of the twisted cross member is not a reaction to the load: it
//! depends on the position (`beam_torque`).

use super::loads::{Balance, Balanced, Reaction};
use crate::model::{Axis, PointId, Side};
use crate::number::Vector3;

/// Forces of a twist beam under a load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeamForces<T> {
    /// Forces of the body on the halves of the beam at their mounts: first on the near half, then on the far half.
    pub mounts: [Vector3<T>; 2],
    /// Force of the far half on the near half at the shear centre.
    pub force: Vector3<T>,
    /// Moment of the far half on the near half, about the shear centre.
    pub moment: Vector3<T>,
}

/// A component of one of the forces or moments in [`BeamForces`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BeamForce {
    /// Force of the body on the half of the near wheel.
    Mount(Axis),
    /// Force of the body on the half of the far (opposite) wheel.
    FarMount(Axis),
    /// Force of the right half on the left half at the shear centre.
    Force(Axis),
    /// Moment of the right half on the left half about the shear centre.
    Moment(Axis),
}

impl BeamForce {
    /// All components, with their names. `far` is the prefix of the names in the far half.
    pub(super) fn all(far: &str) -> impl Iterator<Item = (String, BeamForce)> {
        let kinds = [
            (
                "mount".to_owned(),
                BeamForce::Mount as fn(Axis) -> BeamForce,
            ),
            (format!("{far}mount"), BeamForce::FarMount),
            ("beam_force".to_owned(), BeamForce::Force),
            ("beam_moment".to_owned(), BeamForce::Moment),
        ];
        kinds.into_iter().flat_map(|(name, kind)| {
            Axis::ALL.map(|axis| (format!("{name}_{}", axis.name()), kind(axis)))
        })
    }

    /// Returns true for a force or moment of the whole beam, and false for one that exists at each wheel.
    pub(crate) fn is_single(self) -> bool {
        matches!(self, BeamForce::Force(_) | BeamForce::Moment(_))
    }

    /// Returns the sign that converts a component from the mechanism of the loaded wheel to the study. If the load is
    /// on the right wheel, forces and moments between the halves change sign, because they then act on the right half.
    pub(crate) fn sign_of(self, wheel: Side) -> f64 {
        if self.is_single() && wheel == Side::Right {
            -1.0
        } else {
            1.0
        }
    }

    /// Axis of the component.
    pub(crate) fn axis(self) -> Axis {
        let (BeamForce::Mount(axis)
        | BeamForce::FarMount(axis)
        | BeamForce::Force(axis)
        | BeamForce::Moment(axis)) = self;
        axis
    }

    /// Direction of a positive value, in words.
    pub(super) fn positive(self) -> &'static str {
        let of = |texts: [&'static str; 3]| texts[self.axis() as usize];
        match self {
            BeamForce::Mount(_) | BeamForce::FarMount(_) => of([
                "on the arm along +x",
                "on the arm along +y",
                "on the arm along +z",
            ]),
            BeamForce::Force(_) => of([
                "on the left half along +x",
                "on the left half along +y",
                "on the left half along +z",
            ]),
            BeamForce::Moment(_) => of([
                "on the left half about +x",
                "on the left half about +y",
                "on the left half about +z",
            ]),
        }
    }

    /// Returns the value of the component in these forces.
    pub(super) fn of<T: Copy>(self, forces: &BeamForces<T>) -> T {
        let vector = match self {
            BeamForce::Mount(_) => forces.mounts[0],
            BeamForce::FarMount(_) => forces.mounts[1],
            BeamForce::Force(_) => forces.force,
            BeamForce::Moment(_) => forces.moment,
        };
        vector[self.axis()]
    }
}

impl<T: Balanced> Balance<'_, T> {
    /// Computes the forces of a twist beam by equations (1) and (2) of this module. The load is on the near wheel. `far` is the
    /// force of the spring or support at the far wheel.
    pub(super) fn beam(&self, constraints: &[Reaction<T>; 5], far: T) -> Option<BeamForces<T>> {
        let at = &self.at;
        let rigid = at.mechanism.rigid_axle.as_ref()?;
        let beam = rigid.twist_beam.as_ref()?;
        let zero = at.rack.zero();
        let none = Vector3::new(zero, zero, zero);
        let place = |id: PointId| at.point(id);
        let (support_at, support) = match at.mechanism.spring.filter(|_| !self.is_at_wheel) {
            Some(spring) => {
                let end = |id: PointId| place(rigid.far_of(id).unwrap_or(id));
                let lower = end(spring.lower);
                (lower, (lower - end(spring.upper)).normalised() * far)
            }
            None => (place(rigid.far_centre), Vector3::new(zero, zero, far)),
        };
        let mount = place(beam.far_mount);
        let pull = |id: PointId, tension: T| (mount - place(id)).normalised() * tension;
        let rocker = at.mechanism.rockers_moving(beam.rod_end).next()?;
        let rod = at.rod_tension(rocker, support_at, support);
        let rods = constraints.iter().filter_map(|reaction| match *reaction {
            Reaction::Rod { outer, tension, .. } => Some(pull(outer, tension)),
            _ => None,
        });
        let own = rods.fold(pull(beam.rod_end, rod), |sum, force| sum + force);
        let held = constraints.iter().filter_map(|reaction| match *reaction {
            Reaction::Force { point, force } if point == beam.mount => Some(force),
            _ => None,
        });
        let held = held.fold(none, |sum, force| sum + force);
        let centre = place(beam.shear_centre);
        Some(BeamForces {
            mounts: [Vector3::new(held.x, own.y, held.z), own],
            force: own + support,
            moment: (mount - centre).cross(own) + (support_at - centre).cross(support),
        })
    }
}
