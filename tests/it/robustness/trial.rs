//! Random designs of a strut: a number determines each design.

use crate::support::random::Random;
use hardpoint::characteristics::Characteristic;
use hardpoint::model::{
    Drive, Frame, FrameConvention, LengthUnit, Mechanism, Side, Suspension, Topology,
    VehicleFigures,
};
use hardpoint::number::Vector3;
use hardpoint::plan::Plan;
use hardpoint::study::{self, Formulation, Motion, Order, Outputs, WheelStudy};

const POINTS: [(&str, [f64; 3]); 10] = [
    ("lower_arm_front", [0.12, 0.36, 0.195]),
    ("lower_arm_rear", [-0.26, 0.35, 0.205]),
    ("lower_ball_joint", [0.005, 0.705, 0.19]),
    ("strut_top", [-0.035, 0.575, 0.85]),
    ("strut_lower", [-0.011, 0.623, 0.37]),
    ("strut_upper", [-0.017, 0.611, 0.49]),
    ("tie_rod_inner", [-0.11, 0.33, 0.243]),
    ("tie_rod_outer", [-0.13, 0.69, 0.24]),
    ("wheel_centre", [0.0, 0.76, 0.3]),
    ("spindle_inner", [-0.0002, 0.66, 0.2991]),
];

pub(super) struct Trial {
    pub mechanism: Mechanism,
    pub design: Vec<Vector3<f64>>,
    pub drive: Drive,
    pub values: Vec<f64>,
    pub rack: f64,
    /// True if the design has no degenerate change.
    pub ordinary: bool,
}

pub(super) fn trial(number: u64) -> Trial {
    let random = &mut Random(number);
    let scatter = [0.02, 0.08, 0.2, 0.6][random.below(4)];
    let mut points = POINTS.map(|(_, p)| p.map(|c| c + scatter * random.signed()));
    let ordinary = random.chance(2);
    if !ordinary {
        for _ in 0..=random.below(3) {
            degrade(&mut points, random);
        }
    }
    let mut scale = 1.0;
    if !ordinary && random.chance(3) {
        scale = 10f64.powi(random.below(13) as i32 - 6);
        points = points.map(|p| p.map(|c| c * scale));
    }
    if !ordinary && random.chance(6) {
        let away = [0, 1, 2].map(|_| 1e4 * scale * random.signed());
        for p in &mut points {
            for (c, a) in p.iter_mut().zip(away) {
                *c += a;
            }
        }
    }
    let topology = Topology::named("macpherson").unwrap();
    let with_upper = !random.chance(4);
    let given: Vec<&str> = topology
        .hardpoints
        .iter()
        .map(|h| h.name)
        .filter(|n| with_upper || *n != "strut_upper")
        .collect();
    let mechanism = (topology.build)(topology, &given);
    let design = mechanism
        .points
        .iter()
        .map(|p| POINTS.iter().position(|(n, _)| *n == p.name).unwrap())
        .map(|k| Vector3::from(points[k]))
        .collect();
    let drive = if random.chance(4) {
        Drive::ArmAngle
    } else {
        Drive::Travel
    };
    let reach = match drive {
        Drive::Travel => [0.05, 0.1, 0.3][random.below(3)] * scale,
        Drive::ArmAngle => [0.2, 0.5, 3.1][random.below(3)],
    };
    let values = (0..2 + random.below(5))
        .map(|_| reach * random.signed())
        .collect();
    let rack = if random.chance(4) {
        0.1 * scale * random.signed()
    } else {
        0.0
    };
    Trial {
        mechanism,
        design,
        drive,
        values,
        rack,
        ordinary,
    }
}

impl Trial {
    pub fn suspension(&self) -> Suspension {
        Suspension {
            mechanism: self.mechanism.clone(),
            design: self.design.clone(),
            frame: Frame::new(FrameConvention::Iso8855, Side::Left),
            length_unit: LengthUnit::Metre,
            wheel_radius: None,
            tyre_width: None,
            rim_diameter: None,
            vehicle: VehicleFigures::default(),
        }
    }

    /// Plan of outputs: angles and positions with their rates, sensitivities to the strut's mount, and a certificate of
    /// each pose.
    pub fn plan(&self, suspension: &Suspension) -> Plan {
        let point = |name: &str| self.mechanism.point(name).unwrap();
        Plan::of(&WheelStudy {
            suspension: suspension.clone(),
            motion: Motion {
                drive: match self.drive {
                    Drive::Travel => study::Drive::Travel,
                    Drive::ArmAngle => study::Drive::ArmAngle,
                },
                values: self.values.clone(),
                rack: vec![self.rack],
                rack_moves: false,
                time: None,
            },
            formulation: Formulation::KnucklePose,
            outputs: Outputs {
                characteristics: vec![
                    Characteristic::Camber,
                    Characteristic::Toe,
                    Characteristic::KingpinInclination,
                ],
                points: vec![point("lower_ball_joint"), point("tie_rod_outer")],
                knuckle: false,
                order: Order::Velocity,
                sensitivities: vec![point("strut_top")],
                certify: true,
                measures: Vec::new(),
                figures: Vec::new(),
                loads: Vec::new(),
            },
            compliance: None,
        })
    }
}

#[allow(
    clippy::needless_range_loop,
    reason = "several points are read and one is written, coordinate by coordinate"
)]
fn degrade(points: &mut [[f64; 3]; 10], random: &mut Random) {
    let (a, b, c) = (random.below(10), random.below(10), random.below(10));
    let tiny = [0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3][random.below(6)];
    let t = 2.0 * random.signed();
    match random.below(8) {
        // Points that coincide, or nearly coincide.
        0 => points[a] = points[b].map(|v| v + tiny * random.signed()),
        // A point on a line with two others.
        1 => {
            for k in 0..3 {
                points[a][k] =
                    points[b][k] + t * (points[c][k] - points[b][k]) + tiny * random.signed();
            }
        }
        // A point in a coordinate plane with another.
        2 => points[a][b % 3] = points[c][b % 3] + tiny * random.signed(),
        // All points in one plane.
        3 => points
            .iter_mut()
            .for_each(|p| p[a % 3] = 0.3 + tiny * random.signed()),
        // The strut along a coordinate axis.
        4 => {
            for k in (0..3).filter(|k| k != &(a % 3)) {
                points[4][k] = points[3][k] + tiny * random.signed();
                points[5][k] = points[3][k] + tiny * random.signed();
            }
        }
        // The tie rod's outer end in the plane of the steering axis and the inner end.
        5 => {
            for k in 0..3 {
                points[7][k] = points[2][k]
                    + t * (points[3][k] - points[2][k])
                    + 0.3 * (points[6][k] - points[2][k])
                    + tiny * random.signed();
            }
        }
        // Strut points close together.
        6 => {
            for k in 0..3 {
                points[5][k] = points[4][k] + tiny * (points[3][k] - points[4][k]);
            }
        }
        // Integer coordinates.
        _ => points.iter_mut().for_each(|p| *p = p.map(f64::round)),
    }
}
