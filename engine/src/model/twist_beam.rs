//! Twist beam: two rigid halves that are hinged about the line of the cross member's shear centres.
//!
//! Each half is a trailing arm with half of the cross member. The hinge is the line along y through the shear centre S. If
//! a second point is given, the hinge runs through S and that point. So the hinge can be slightly skewed, as in a beam
//! whose parts deviate from nominal. A mount fixes its half of the beam in x and z. The rubber of the mounts lets both
//! halves move sideways, by equal distances in opposite directions. Each half has six unknowns. The hinge removes five of
//! these twelve, the mounts five, and the two travels determine the rest.
//!
//! The mechanism belongs to the near half. The far half carries the other wheel. Let M be the mount of the far half, and S
//! and T two points of the hinge. The mount of the near half gives two equations. M keeps its distances from S and T, and
//! each of these distances is a link. The travels are two equations (see `rigid_axle.rs`). The far half is a rocker on the
//! near half, with the hinge as its axis. Every point P of the far half keeps its distance from M, so a rod from M to P can
//! rotate this rocker. Every P gives the same motion. The program chooses a P that makes the rod perpendicular to its lever.

use super::rigid_axle::{AxleTravel, RigidAxle};
use super::rocker::Carriers;
use super::topology::{
    Given, SPINDLE, SPINDLE_INNER, SPRING, SPRING_UPPER, Topology, WHEEL_CENTRE, optional, required,
};
use super::{Body, Constraint, Mechanism, Point, PointId, Rocker, RockerId, Rod};
use crate::number::{Each, Vector3};

/// Name of the hinge's second point.
pub(crate) const HINGE: &str = "hinge_end";

/// The twist beam.
pub(super) static TWIST_BEAM: Topology = Topology {
    name: "twist_beam",
    summary: "Twist beam: two trailing arms and a cross member that twists about its shear centre",
    hardpoints: &[
        required("mount", "mount of the arm at the body"),
        required(
            "shear_centre",
            "shear centre of the cross member's section in the middle of the car: y = 0",
        ),
        WHEEL_CENTRE,
        SPINDLE_INNER,
        SPRING_UPPER,
        optional("spring_lower", "lower end of spring and damper, on the arm"),
        optional(
            HINGE,
            "second point of the hinge between both halves, left of the shear centre; without it the hinge is along y",
        ),
    ],
    groups: &[&SPRING],
    distinct: &[
        (
            "mount",
            "shear_centre",
            "the arm turns about the line through both",
        ),
        (HINGE, "shear_centre", "they define the hinge"),
        SPINDLE,
    ],
    build,
    template: include_str!("../../templates/twist_beam.toml"),
};

/// Points of a twist beam that define its hinge and rod.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TwistBeam {
    /// The near mount.
    pub mount: PointId,
    /// The far mount.
    pub far_mount: PointId,
    /// A point of the hinge: the shear centre.
    pub shear_centre: PointId,
    /// Second point of the hinge. If the study does not give this point, the point keeps its offset from the shear centre along
    /// y.
    pub hinge: PointId,
    /// True if the study gives the second point of the hinge.
    pub is_hinge_given: bool,
    /// End of the rod on the far half. It keeps its offset from the far mount.
    pub rod_end: PointId,
    /// Centre of the near arm's bushing, as a point of the beam. `None` in the nominal mechanism, in which it is the same point as
    /// the mount. In a build from parts, the mount is a point of the body only.
    pub eye: Option<PointId>,
}

impl TwistBeam {
    /// Points that a study does not give. Each keeps its offset from the second point of its pair.
    pub fn followers(&self) -> impl Iterator<Item = [PointId; 2]> + use<> {
        let hinge = (!self.is_hinge_given).then_some([self.hinge, self.shear_centre]);
        let eye = self.eye.map(|eye| [eye, self.mount]);
        let rod = [self.rod_end, self.far_mount];
        hinge.into_iter().chain([rod]).chain(eye)
    }

    /// Points of hinge and rod that a study does not give, with their positions in a design with these mounts and
    /// this shear centre.
    pub(crate) fn further_points(
        &self,
        design: &[Vector3<f64>],
    ) -> impl Iterator<Item = (PointId, Vector3<f64>)> + use<> {
        let [mount, centre] = [self.far_mount, self.shear_centre].each(|id| design[id.0]);
        let aside = Vector3::new(0.0, mount.y.abs(), 0.0);
        // The rod's end is on the circle in the x-z plane through the far mount and the shear centre, with their distance as
        // diameter. So by Thales' theorem, the rod from the mount is perpendicular to the lever from the hinge.
        let (x, z) = (0.5 * (mount.x - centre.x), 0.5 * (mount.z - centre.z));
        let rod = Vector3::new(-x - z, 0.0, x - z);
        let hinge = (!self.is_hinge_given).then_some((self.hinge, centre + aside));
        hinge.into_iter().chain([(self.rod_end, mount + rod)])
    }
}

fn build(topology: &'static Topology, given: &[&'static str]) -> Mechanism {
    let on_arm = Carriers::all(Body::Knuckle);
    let mut given = Given::of(topology, given, on_arm, |_| Body::Knuckle);
    let beam = RockerId(0);
    let mount = given.id("mount");
    let far_body = |id, body| match body {
        _ if id == mount => Body::Opposite(mount),
        Body::Knuckle => Body::Rocker(beam),
        body => body,
    };
    let (singles, pairs) =
        given.add_far_half(|name| name == "shear_centre" || name == HINGE, far_body);
    let given_hinge = given.find(HINGE);
    let mut add = |name: &str, body: Body| {
        let name = name.to_owned();
        given.0.push(Point { name, body });
        PointId(given.0.len() - 1)
    };
    let hinge = given_hinge.unwrap_or_else(|| add("twist_beam_axis", Body::Knuckle));
    let rod_end = add("twist_beam_rod", Body::Rocker(beam));
    let [shear_centre, far_mount, far_centre] =
        ["shear_centre", "right_mount", "right_wheel_centre"].each(|name| given.id(name));
    let held = AxleTravel::Mean;
    let link = |outer: PointId| Constraint::Link {
        inner: far_mount,
        outer,
    };
    let constraints = vec![
        Constraint::Mount { at: mount },
        link(shear_centre),
        link(hinge),
        Constraint::AxleTravel {
            near: given.id("wheel_centre"),
            far: far_centre,
            held,
        },
    ];
    let bodies = [("chassis", Body::Chassis), ("arm", Body::Knuckle)];
    Mechanism {
        constraints,
        rockers: vec![Rocker {
            rod: Rod::TwistBeam,
            first: shear_centre,
            second: hinge,
            inner: rod_end,
            outer: far_mount,
        }],
        rigid_axle: Some(RigidAxle {
            pairs,
            singles,
            extra_links: Vec::new(),
            far_centre,
            held,
            steering: None,
            twist_beam: Some(TwistBeam {
                mount,
                far_mount,
                shear_centre,
                hinge,
                is_hinge_given: given_hinge.is_some(),
                rod_end,
                eye: None,
            }),
        }),
        ..given.mechanism(topology, &bodies)
    }
}
