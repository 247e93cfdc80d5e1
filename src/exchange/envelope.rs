//! Space that a tyre needs over travel and steer, as solids for CAD.
//!
//! On a solid axle or a twist beam, the travel of one wheel also moves the other wheel. So the file contains all
//! combinations of both travels. Other wheels move separately.
//!
//! Each pose of the wheel gives one closed solid: the tyre as a cylinder about the spin axis. Its rings are polygons
//! circumscribed about the circle, so the tyre lies inside. The file is binary STL: an 80-byte text, the number of triangles, and
//! then the triangles. Each triangle has its outward normal and its corners as 32-bit floats, and two unused bytes.

use super::outgoing::Outgoing;
use crate::axle::{Axle, AxleMotion, AxlePlan, Combine, Quantity, WheelMotion, axle_curves};
use crate::characteristics::Characteristic;
use crate::curves::{Station, Status};
use crate::model::{Axis, Frame, LengthUnit, Side, SpinAxis};
use crate::number::Vector3;
use crate::study::{Motion, Order, Study};
use std::f64::consts::PI;

/// Number of corners of a ring.
const CORNERS: usize = 96;

/// Cylinder of a tyre, in the file's unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tyre {
    /// Radius of the tyre.
    pub radius: f64,
    /// Width of the tyre. Half of it is on either side of the wheel centre.
    pub width: f64,
}

/// Equally spaced travels or rack displacements between two ends, including both ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// First and last travel or rack displacement.
    pub ends: [f64; 2],
    /// Number of travels or rack displacements. 1 if the ends are equal.
    pub values: usize,
}

impl Span {
    /// Travels or rack displacements in order, from the first end to the second.
    pub fn all(&self) -> Vec<f64> {
        let [first, last] = self.ends;
        if first == last || self.values < 2 {
            return vec![first];
        }
        let share = |k: usize| k as f64 / (self.values - 1) as f64;
        let value = |k: usize| first * (1.0 - share(k)) + last * share(k);
        (0..self.values).map(value).collect()
    }
}

/// Solids of the tyre in all poses of the wheels.
#[derive(Clone, Debug)]
pub struct Envelope {
    /// One solid per pose and wheel, as triangles. Seen from outside, the corners are counter-clockwise.
    pub solids: Vec<Vec<[[f32; 3]; 3]>>,
    /// Largest distance that a corner of a solid moves in one step of each motion, in the file's unit. First: travel (solid axle
    /// and twist beam: of the right wheel). Second: travel of the left wheel of a solid axle or a twist beam, else 0. Third: rack.
    pub widest_steps: [f64; 3],
    title: String,
}

impl Envelope {
    /// Makes the envelope of every wheel of a study. Travels and racks are in the file's unit; racks are along the file's y axis.
    ///
    /// # Errors
    ///
    /// In words: a pose that the wheel cannot reach, a rack that steers nothing, or a solid axle or twist beam with elastic parts.
    pub fn of(
        outgoing: &Outgoing<'_>,
        tyre: Tyre,
        travel: Span,
        rack: Span,
    ) -> Result<Self, String> {
        if rack.ends != [0.0; 2] && !outgoing.study.wheel().mechanism.is_steered() {
            return Err("--rack: this suspension is not steered".to_owned());
        }
        let mut envelope = Envelope {
            solids: Vec::new(),
            widest_steps: [0.0; 3],
            title: format!(
                "tyre envelope by hardpoint; unit {}; frame {}",
                outgoing.unit.symbol(),
                outgoing.convention.name()
            ),
        };
        let (travels, racks) = (travel.all(), rack.all());
        let is_rigid = outgoing.study.wheel().mechanism.rigid_axle.is_some();
        let both = if is_rigid { travels.len() } else { 1 };
        // Number of values of each motion. The first motion varies fastest.
        let values = [travels.len(), both, racks.len()];
        let of_wheels = match outgoing.study.axle() {
            Some(study) if is_rigid => poses_of_axle(outgoing, &study.axle, &travels, &racks)?,
            _ => {
                let wheels = outgoing.wheels().into_iter();
                let poses = wheels.map(|side| poses(outgoing, side, &travels, &racks));
                poses.collect::<Result<_, _>>()?
            }
        };
        for poses in of_wheels {
            for (number, pose) in poses.iter().enumerate() {
                let corners = corners(*pose, tyre);
                let mut stride = 1;
                for (values, widest) in values.into_iter().zip(&mut envelope.widest_steps) {
                    if !(number / stride).is_multiple_of(values) {
                        let before = self::corners(poses[number - stride], tyre);
                        *widest = widest.max(farthest(&corners, &before));
                    }
                    stride *= values;
                }
                envelope.solids.push(solid(&corners));
            }
        }
        Ok(envelope)
    }

    /// Estimate of the largest distance by which a tyre point between two poses can be outside of all solids, in the file's unit:
    /// half of the widest step along every motion.
    pub fn gap(&self) -> f64 {
        0.5 * self.widest_steps.iter().sum::<f64>()
    }

    /// Number of triangles of all solids.
    pub fn triangles(&self) -> usize {
        self.solids.iter().map(Vec::len).sum()
    }

    /// Bytes of the binary STL file, with little-endian numbers.
    pub fn stl(&self) -> Vec<u8> {
        let mut bytes = self.title.clone().into_bytes();
        bytes.resize(80, b' ');
        let count = u32::try_from(self.triangles()).expect("poses are bounded");
        bytes.extend(count.to_le_bytes());
        for triangle in self.solids.iter().flatten() {
            let normal = normal(triangle).map(|x| x as f32);
            for number in std::iter::once(&normal).chain(triangle).flatten() {
                bytes.extend(number.to_le_bytes());
            }
            bytes.extend([0; 2]);
        }
        bytes
    }
}

/// Wheel centre and spin axis (unit vector, outboard) in the axes and the unit of the file.
type WheelPose = [Vector3<f64>; 2];

/// Poses of a wheel. Travel varies fastest. Travels and racks are in the file's unit; racks are along the file's y axis.
fn poses(
    outgoing: &Outgoing<'_>,
    side: Side,
    travels: &[f64],
    racks: &[f64],
) -> Result<Vec<WheelPose>, String> {
    let mut suspension = outgoing.suspension(side).clone();
    if let Some(both) = outgoing.study.axle() {
        suspension.frame = both.axle.frame(side);
    }
    let own = suspension.length_unit;
    let frame = suspension.frame;
    let along_rack = frame.sign(Axis::Y) * outgoing.frame(side).sign(Axis::Y);
    let of_study = |length: &f64| own.convert(*length, outgoing.unit);
    let motion = Motion {
        values: travels.iter().map(of_study).collect(),
        ..Motion::at(0.0, 0.0).map_err(|error| error.to_string())?
    };
    let racks: Vec<f64> = racks.iter().map(|r| along_rack * of_study(r)).collect();
    let motion = motion.with_racks(&racks);
    let asked = [Characteristic::Camber, Characteristic::Toe];
    let curves = Study::of(suspension)
        .over(motion.map_err(|error| error.to_string())?)
        .asking(&asked, Order::Position)
        .and_then(|study| study.asking_points(&["wheel_centre"]))
        .and_then(|study| study.curves())
        .map_err(|error| error.to_string())?;
    let mut poses = Vec::with_capacity(curves.stations.len());
    let places = curves.along("travel").zip(curves.along("rack"));
    for (station, (travel, rack)) in curves.stations.iter().zip(places) {
        let at = || {
            let unit = own.symbol();
            let [travel, rack] = [travel, rack].map(|value| value.unwrap_or(f64::NAN));
            format!(
                "{} wheel at travel {travel} {unit}, rack {rack} {unit}",
                side.name()
            )
        };
        let values =
            values_of(station, own, frame).map_err(|reason| format!("{}: {reason}", at()))?;
        poses.push(pose(outgoing, side, frame, &values));
    }
    Ok(poses)
}

/// Poses of both wheels of a solid axle or a twist beam, in all combinations of their travels. The travel of the right wheel
/// varies fastest.
fn poses_of_axle(
    outgoing: &Outgoing<'_>,
    axle: &Axle,
    travels: &[f64],
    racks: &[f64],
) -> Result<Vec<Vec<WheelPose>>, String> {
    if axle.elastic.is_some() {
        let message =
            "the pose of a solid axle with elastic parts depends on its loads, so there is no STL";
        return Err(message.to_owned());
    }
    let left = &axle.left;
    let own = left.length_unit;
    let of_study = |length: &f64| own.convert(*length, outgoing.unit);
    let travels: Vec<f64> = travels.iter().map(of_study).collect();
    // A positive rack displacement is to the left.
    let along_rack = outgoing.frame(Side::Left).sign(Axis::Y);
    let racks = racks.iter().map(|rack| along_rack * of_study(rack));
    let motion = AxleMotion {
        combine: Combine::All,
        wheels: WheelMotion::Travels {
            left: travels.clone(),
            right: travels,
            on_plane: false,
        },
        racks: racks.collect(),
        shows_rack: left.mechanism.is_steered(),
        steering_wheel: None,
        time: None,
    };
    let angles = [Characteristic::Camber, Characteristic::Toe];
    let quantities = Side::ALL.map(|side| angles.map(|angle| Quantity::Corner(side, angle)));
    let plan = AxlePlan {
        points: vec![left.mechanism.wheel_centre],
        ..AxlePlan::of(motion, quantities.concat())
    };
    let found = axle_curves(axle, &plan).map_err(|fault| axle.describe_fault(fault))?;
    let mut of_wheels = vec![Vec::new(); 2];
    for (station, placement) in found.curves.stations.iter().zip(plan.motion.placements()) {
        let values = values_of(station, own, left.frame)
            .map_err(|reason| format!("{placement} ({}): {reason}", own.symbol()))?;
        let (angles, places) = values.split_at(4);
        for side in Side::ALL {
            let number = side as usize;
            let values = [&angles[2 * number..][..2], &places[3 * number..][..3]].concat();
            of_wheels[number].push(pose(outgoing, side, axle.frame(side), &values));
        }
    }
    Ok(of_wheels)
}

/// Camber, toe and wheel centre at a station, or the reason why they are missing. The reason uses `unit` and `frame` of the study.
fn values_of(station: &Station, unit: LengthUnit, frame: Frame) -> Result<Vec<f64>, String> {
    if let Status::Failed(failure) = station.status {
        return Err(failure.describe(unit, frame));
    }
    let values: Result<Vec<f64>, _> = station.values.iter().copied().collect();
    values.map_err(|_| "the wheel has no angles".to_owned())
}

/// Pose of a wheel from `values`: camber and toe in degrees, and the position of its centre. The position is in the unit and the
/// axes (`frame`) of the study.
fn pose(outgoing: &Outgoing<'_>, side: Side, frame: Frame, values: &[f64]) -> WheelPose {
    let [camber, toe, x, y, z] = values[..] else {
        unreachable!("two angles and a point were requested")
    };
    let SpinAxis::Along(axis) = SpinAxis::standing(camber.to_radians(), toe.to_radians()) else {
        unreachable!("the angles define a direction")
    };
    let centre = frame.vector(Vector3::new(x, y, z));
    let file = outgoing.frame(side);
    [centre.map(|x| outgoing.length(x)), axis].map(|v| file.vector(v))
}

/// Corners of the inboard and the outboard ring of a cylinder. The last vector of each ring is the centre of the ring.
type Rings = [Vec<Vector3<f64>>; 2];

/// Rings of the cylinder of a tyre in this pose.
fn corners([centre, axis]: WheelPose, tyre: Tyre) -> Rings {
    // up, across and axis are right-handed, so the corners are counter-clockwise seen from outboard.
    let up = if axis.z.abs() < 0.9 {
        Vector3::new(0.0, 0.0, 1.0)
    } else {
        Vector3::new(1.0, 0.0, 0.0)
    };
    let across = axis.cross(up);
    let across = across * (1.0 / across.norm_squared().sqrt());
    let up = across.cross(axis);
    let radius = tyre.radius / (PI / CORNERS as f64).cos();
    [-0.5, 0.5].map(|half| {
        let middle = centre + axis * (half * tyre.width);
        let corner = |k: usize| {
            let (sine, cosine) = (2.0 * PI * k as f64 / CORNERS as f64).sin_cos();
            middle + (up * cosine + across * sine) * radius
        };
        (0..CORNERS).map(corner).chain([middle]).collect()
    })
}

/// Largest distance between corresponding corners of two solids.
fn farthest(one: &Rings, other: &Rings) -> f64 {
    let pairs = one.iter().flatten().zip(other.iter().flatten());
    let squares = pairs.map(|(a, b)| (*a - *b).norm_squared());
    squares.fold(0.0, f64::max).sqrt()
}

/// Triangles of a cylinder. Corners are rounded only once, so triangles with a common edge have identical corners.
fn solid(rings: &Rings) -> Vec<[[f32; 3]; 3]> {
    let [inner, outer] = rings.each_ref().map(|ring| {
        let single = |p: &Vector3<f64>| p.to_array().map(|x| x as f32);
        ring.iter().map(single).collect::<Vec<[f32; 3]>>()
    });
    let mut triangles = Vec::with_capacity(4 * CORNERS);
    for k in 0..CORNERS {
        let next = (k + 1) % CORNERS;
        triangles.push([outer[CORNERS], outer[k], outer[next]]);
        triangles.push([inner[CORNERS], inner[next], inner[k]]);
        triangles.push([inner[k], inner[next], outer[next]]);
        triangles.push([inner[k], outer[next], outer[k]]);
    }
    triangles
}

/// Unit normal of a triangle.
fn normal(triangle: &[[f32; 3]; 3]) -> [f64; 3] {
    let [a, b, c] = triangle.map(|p| Vector3::from(p.map(f64::from)));
    let across = (b - a).cross(c - a);
    (across * (1.0 / across.norm_squared().sqrt())).to_array()
}
