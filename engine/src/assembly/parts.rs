//! Parts of a suspension, with a separate dimension for each part.

use crate::model::{Axis, Body, Constraint, Mechanism, PointId, RockerId, Suspension};
use crate::number::{Each, Real, SimdReal, Vector3};

/// A member whose length is a dimension of the build.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Member {
    /// A rod, or a leg of a two-legged arm, which acts as a rod. The number is the index of its constraint in
    /// [`Mechanism::constraints`].
    Link(usize),
    /// The rod of a rocker.
    Rod(RockerId),
    /// A link of a solid axle without constraint, by its index in [`RigidAxle::extra_links`].
    ///
    /// [`RigidAxle::extra_links`]: crate::model::RigidAxle::extra_links
    Extra(usize),
}

impl Member {
    /// Returns the members of a mechanism with their names. Links are named as in the columns of loads. Rods have the
    /// name of their kind ([`Rod::key`](crate::model::Rod::key)), such as `pushrod`.
    pub fn all(mechanism: &Mechanism) -> Vec<(String, Member)> {
        let links = Member::links(mechanism).map(|(link, [inner, _])| {
            let name = mechanism.link_name(inner);
            (name.to_owned(), link)
        });
        let rods = mechanism.rockers.iter().enumerate();
        let rods = rods.map(|(number, rocker)| {
            let name = rocker.rod.key().to_owned();
            (name, Member::Rod(RockerId(number)))
        });
        links.chain(rods).collect()
    }

    /// Returns all links with their ends. The links without constraint come last.
    pub(crate) fn links(
        mechanism: &Mechanism,
    ) -> impl Iterator<Item = (Member, [PointId; 2])> + '_ {
        let constraints = mechanism.constraints.iter().enumerate();
        let held = constraints.filter_map(|(number, constraint)| match *constraint {
            Constraint::Link { inner, outer } => Some((Member::Link(number), [inner, outer])),
            _ => None,
        });
        let extra = mechanism.extra_links().iter().enumerate();
        held.chain(extra.map(|(number, ends)| (Member::Extra(number), *ends)))
    }

    /// Returns the two ends of the member. The end nearer to the body comes first. `None` if the index does not belong to a link.
    pub fn ends(self, mechanism: &Mechanism) -> Option<(PointId, PointId)> {
        match self {
            Member::Link(number) => match mechanism.constraints[number] {
                Constraint::Link { inner, outer } => Some((inner, outer)),
                _ => None,
            },
            Member::Rod(id) => {
                let rocker = mechanism.rocker(id);
                Some((rocker.inner, rocker.outer))
            }
            Member::Extra(number) => {
                let [inner, outer] = *mechanism.extra_links().get(number)?;
                Some((inner, outer))
            }
        }
    }

    /// Writes the length that the member has in `design` to `lengths`.
    fn cut<T: Real>(self, mechanism: &Mechanism, design: &[Vector3<T>], lengths: &mut [T]) {
        if let Some((inner, outer)) = self.ends(mechanism) {
            lengths[self.place(mechanism)] = (design[outer.0] - design[inner.0]).norm();
        }
    }

    /// Returns the index of the member in [`Parts::lengths`].
    #[inline(always)]
    pub(crate) fn place(self, mechanism: &Mechanism) -> usize {
        match self {
            Member::Link(number) => number,
            Member::Rod(id) => mechanism.constraints.len() + id.0,
            Member::Extra(number) => mechanism.constraints.len() + mechanism.rockers.len() + number,
        }
    }
}

/// A dimension of the parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BuildParameter {
    /// A coordinate of a point of a part, in the kernel's frame (x forward, y left, z up, for a left wheel). The part is the body,
    /// or a carrier in its nominal position. The end of a member is a point of the part to which the member is fixed.
    Coordinate(PointId, Axis),
    /// The length of a member.
    Length(Member),
}

impl BuildParameter {
    /// Returns true for a dimension of a part that exists only once on a solid axle: a Panhard rod, a Watt linkage, a
    /// single upper link, a drag link or a tie rod.
    pub(crate) fn is_single(self, mechanism: &Mechanism) -> bool {
        let Some(rigid) = &mechanism.rigid_axle else {
            return false;
        };
        match self {
            BuildParameter::Coordinate(id, _) => rigid.singles.contains(&id),
            BuildParameter::Length(member) => {
                let ends = member.ends(mechanism);
                ends.is_some_and(|(inner, outer)| {
                    let own = rigid.singles.contains(&inner) && rigid.singles.contains(&outer);
                    own || rigid.partner(inner) == outer
                })
            }
        }
    }

    /// Returns the same dimension of a solid axle in the mechanism of the other wheel. The factor converts a change of
    /// the dimension in this mechanism to a change in the other one. `None` if that wheel's mechanism does not have the
    /// part. Also `None` for an independent wheel.
    pub(crate) fn seen_from_other(self, mechanism: &Mechanism) -> Option<(BuildParameter, f64)> {
        let rigid = mechanism.rigid_axle.as_ref()?;
        match self {
            BuildParameter::Coordinate(id, axis) => {
                let sign = if axis == Axis::Y { -1.0 } else { 1.0 };
                Some((BuildParameter::Coordinate(rigid.partner(id), axis), sign))
            }
            BuildParameter::Length(member @ (Member::Link(_) | Member::Extra(_)))
                if !self.is_single(mechanism) =>
            {
                let (inner, outer) = member.ends(mechanism)?;
                let ends = [inner, outer].each(|end| rigid.partner(end));
                let (other, _) = Member::links(mechanism).find(|(_, own)| *own == ends)?;
                Some((BuildParameter::Length(other), 1.0))
            }
            // The mechanism of each wheel contains only the lever of the anti-roll bar on its own side.
            BuildParameter::Length(_) => self.is_single(mechanism).then_some((self, 1.0)),
        }
    }
}

/// Dimensions of all parts, over any number type.
#[derive(Clone, Debug, PartialEq)]
pub struct Parts<T> {
    /// Position of every point in its part. The part is the body, or a carrier in its nominal position.
    pub points: Vec<Vector3<T>>,
    /// Lengths of members: first by the index of the constraint, then rods of rockers, then links without constraint.
    /// 0 for a constraint that is not a rod.
    pub lengths: Vec<T>,
    /// Length by which a unit tension stretches each member, in the order of `lengths`. Only [`Assembler::of_axle`]
    /// sets it, for an elastic axle with more links than rigid links allow. Otherwise it is empty.
    ///
    /// [`Assembler::of_axle`]: super::Assembler::of_axle
    pub softness: Vec<f64>,
    /// Position of every point in the nominal design.
    pub drawn: Vec<Vector3<T>>,
}

impl Parts<f64> {
    /// Makes the nominal parts.
    pub fn drawn(suspension: &Suspension) -> Self {
        Parts::of_drawing(&suspension.mechanism, &suspension.design)
    }

    /// Converts the parts to another number type.
    pub fn map<T: Copy>(&self, f: impl Fn(f64) -> T + Copy) -> Parts<T> {
        Parts {
            points: self.points.iter().map(|p| p.map(f)).collect(),
            lengths: self.lengths.iter().map(|l| f(*l)).collect(),
            softness: self.softness.clone(),
            drawn: self.drawn.iter().map(|p| p.map(f)).collect(),
        }
    }
}

impl Parts<f64> {
    /// Copies the parts to every SIMD lane.
    #[inline(always)]
    pub(crate) fn in_lanes<B: SimdReal>(&self, like: B) -> Parts<B> {
        let shape = Vector3::new(like, like, like);
        let mut parts = Parts {
            points: Vec::with_capacity(self.points.len()),
            lengths: Vec::with_capacity(self.lengths.len()),
            softness: self.softness.clone(),
            drawn: Vec::with_capacity(self.points.len()),
        };
        for (point, drawn) in self.points.iter().zip(&self.drawn) {
            parts.points.push(shape.constant(*point));
            parts.drawn.push(shape.constant(*drawn));
        }
        for length in &self.lengths {
            parts.lengths.push(like.constant(*length));
        }
        parts
    }
}

impl<T: Real> Parts<T> {
    /// Makes the parts of a design, over any number type.
    pub fn of_drawing(mechanism: &Mechanism, design: &[Vector3<T>]) -> Self {
        let none = design[0].x.zero();
        let extra = mechanism.extra_links().len();
        let count = mechanism.constraints.len() + mechanism.rockers.len() + extra;
        let mut lengths = vec![none; count];
        for (link, _) in Member::links(mechanism) {
            link.cut(mechanism, design, &mut lengths);
        }
        for number in 0..mechanism.rockers.len() {
            Member::Rod(RockerId(number)).cut(mechanism, design, &mut lengths);
        }
        Parts {
            points: design.to_vec(),
            lengths,
            softness: Vec::new(),
            drawn: design.to_vec(),
        }
    }

    /// Changes a dimension. If the study defines the spin axis by angles, this axis moves with the wheel centre and does not
    /// rotate. A sideways change of a twist beam's near mount also moves the far mount, by equation (1) of module
    /// `carriers`.
    #[inline(always)]
    pub fn change(&mut self, mechanism: &Mechanism, parameter: BuildParameter, by: T) {
        match parameter {
            BuildParameter::Coordinate(point, axis) => {
                self.shift(point, axis, by);
                if let Some(beside) = mechanism.moves_with(point) {
                    self.shift(beside, axis, by);
                }
                let rigid = mechanism.rigid_axle.as_ref();
                let beam = rigid.and_then(|rigid| rigid.twist_beam);
                if let Some(beam) = beam.filter(|beam| beam.mount == point && axis == Axis::Y) {
                    self.shift(beam.far_mount, axis, by);
                }
            }
            BuildParameter::Length(member) => {
                let length = &mut self.lengths[member.place(mechanism)];
                *length = *length + by;
            }
        }
    }

    /// Moves a point in its part.
    #[inline(always)]
    fn shift(&mut self, point: PointId, axis: Axis, by: T) {
        let point = &mut self.points[point.0];
        match axis {
            Axis::X => point.x = point.x + by,
            Axis::Y => point.y = point.y + by,
            Axis::Z => point.z = point.z + by,
        }
    }
}

impl<B: SimdReal> Parts<B> {
    /// Sets these parts to the nominal parts `drawn` plus scatter, one build per SIMD lane. Each tolerance source lists
    /// the dimensions that change with one random number, and their changes per unit of this number. `draws` holds the
    /// random numbers, `[source][build]`. `first` is the index of the first build in `draws`, and `stride` the number
    /// of entries per source.
    #[inline(always)]
    pub(crate) fn scatter<'c>(
        &mut self,
        mechanism: &Mechanism,
        drawn: &Self,
        sources: impl Iterator<Item = &'c [(BuildParameter, f64)]>,
        (draws, first, stride): (&[f64], usize, usize),
    ) {
        self.points.copy_from_slice(&drawn.points);
        self.lengths.copy_from_slice(&drawn.lengths);
        let like = drawn.points[0].x;
        let mut place = first;
        for changes in sources {
            let z = like.load(&draws[place..]);
            for (parameter, share) in changes {
                self.change(mechanism, *parameter, z.scaled(*share));
            }
            place += stride;
        }
    }
}

/// Returns true if a point belongs to the vehicle body. Points of the rack count as points of the body.
#[inline(always)]
pub(crate) fn is_of_body(mechanism: &Mechanism, id: PointId) -> bool {
    matches!(mechanism.body(id), Body::Chassis | Body::Rack)
}
