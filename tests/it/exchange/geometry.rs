//! Random suspensions for tests of the axes of files.

/// Random numbers between bounds.
pub(super) struct Chance(pub u64);

impl Chance {
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        let share = (self.0 >> 11) as f64 / (1u64 << 53) as f64;
        ((low + share * (high - low)) * 1000.0).round() / 1000.0
    }

    fn point(&mut self, x: [f64; 2], y: [f64; 2], z: [f64; 2]) -> [f64; 3] {
        [x, y, z].map(|[low, high]| self.between(low, high))
    }
}

pub(super) type Points = Vec<(&'static str, [f64; 3])>;

/// Hardpoint, and the ranges of its coordinates.
type Range = (&'static str, [[f64; 2]; 3]);

/// Lower arm, tie rod and wheel centre.
const LOWER_ARM: [Range; 6] = [
    (
        "lower_arm_front",
        [[80.0, 250.0], [150.0, 400.0], [90.0, 220.0]],
    ),
    (
        "lower_arm_rear",
        [[-300.0, -80.0], [150.0, 400.0], [90.0, 220.0]],
    ),
    (
        "lower_ball_joint",
        [[-40.0, 40.0], [560.0, 740.0], [100.0, 210.0]],
    ),
    (
        "tie_rod_inner",
        [[-160.0, 120.0], [140.0, 360.0], [120.0, 260.0]],
    ),
    (
        "tie_rod_outer",
        [[-150.0, 120.0], [540.0, 720.0], [130.0, 260.0]],
    ),
    (
        "wheel_centre",
        [[-30.0, 30.0], [610.0, 800.0], [200.0, 330.0]],
    ),
];

/// Upper arm of a double wishbone.
const UPPER_ARM: [Range; 3] = [
    (
        "upper_arm_front",
        [[60.0, 220.0], [200.0, 420.0], [260.0, 430.0]],
    ),
    (
        "upper_arm_rear",
        [[-250.0, -60.0], [200.0, 420.0], [260.0, 430.0]],
    ),
    (
        "upper_ball_joint",
        [[-60.0, 20.0], [520.0, 700.0], [300.0, 500.0]],
    ),
];

/// Strut of a MacPherson suspension.
const STRUT: [Range; 2] = [
    ("strut_top", [[-70.0, 20.0], [480.0, 600.0], [720.0, 900.0]]),
    (
        "strut_lower",
        [[-20.0, 20.0], [600.0, 660.0], [330.0, 420.0]],
    ),
];

/// Points of a five-link suspension.
const FIVE_LINK: [Range; 11] = [
    (
        "upper_front_link_inner",
        [[80.0, 300.0], [250.0, 420.0], [400.0, 500.0]],
    ),
    (
        "upper_front_link_outer",
        [[20.0, 60.0], [620.0, 720.0], [400.0, 500.0]],
    ),
    (
        "upper_rear_link_inner",
        [[-260.0, -80.0], [250.0, 420.0], [400.0, 500.0]],
    ),
    (
        "upper_rear_link_outer",
        [[-60.0, -20.0], [620.0, 720.0], [400.0, 500.0]],
    ),
    (
        "lower_front_link_inner",
        [[80.0, 300.0], [250.0, 420.0], [150.0, 240.0]],
    ),
    (
        "lower_front_link_outer",
        [[20.0, 60.0], [620.0, 720.0], [150.0, 240.0]],
    ),
    (
        "lower_rear_link_inner",
        [[-260.0, -80.0], [250.0, 420.0], [150.0, 240.0]],
    ),
    (
        "lower_rear_link_outer",
        [[-60.0, -20.0], [620.0, 720.0], [150.0, 240.0]],
    ),
    (
        "toe_link_inner",
        [[-200.0, -100.0], [250.0, 400.0], [250.0, 330.0]],
    ),
    (
        "toe_link_outer",
        [[-180.0, -100.0], [620.0, 720.0], [250.0, 330.0]],
    ),
    (
        "wheel_centre",
        [[-20.0, 20.0], [690.0, 800.0], [280.0, 330.0]],
    ),
];

/// Points of a suspension with an H-arm.
const H_ARM: [Range; 7] = [
    (
        "lower_arm_front",
        [[120.0, 260.0], [200.0, 350.0], [220.0, 280.0]],
    ),
    (
        "lower_arm_rear",
        [[-220.0, -100.0], [200.0, 350.0], [210.0, 270.0]],
    ),
    (
        "lower_joint_front",
        [[70.0, 140.0], [640.0, 700.0], [190.0, 240.0]],
    ),
    (
        "lower_joint_rear",
        [[-150.0, -80.0], [640.0, 700.0], [190.0, 240.0]],
    ),
    (
        "upper_link_inner",
        [[-30.0, 30.0], [360.0, 430.0], [430.0, 490.0]],
    ),
    (
        "upper_link_outer",
        [[-30.0, 30.0], [640.0, 690.0], [440.0, 500.0]],
    ),
    (
        "wheel_centre",
        [[-20.0, 20.0], [720.0, 800.0], [290.0, 340.0]],
    ),
];

/// Points of an integral link suspension, besides the lower arm and the wheel centre.
const INTEGRAL_LINK: [Range; 6] = [
    (
        "integral_link_inner",
        [[70.0, 120.0], [600.0, 650.0], [180.0, 230.0]],
    ),
    (
        "integral_link_outer",
        [[70.0, 120.0], [620.0, 670.0], [310.0, 370.0]],
    ),
    (
        "upper_link_inner",
        [[-30.0, 30.0], [360.0, 430.0], [430.0, 490.0]],
    ),
    (
        "upper_link_outer",
        [[-30.0, 30.0], [640.0, 690.0], [440.0, 500.0]],
    ),
    (
        "toe_link_inner",
        [[-220.0, -150.0], [300.0, 380.0], [230.0, 280.0]],
    ),
    (
        "toe_link_outer",
        [[-220.0, -150.0], [660.0, 720.0], [230.0, 280.0]],
    ),
];

/// Points of a trailing arm with two links.
const TRAILING_ARM: [Range; 6] = [
    (
        "arm_pivot",
        [[430.0, 560.0], [500.0, 620.0], [260.0, 330.0]],
    ),
    (
        "upper_link_inner",
        [[-40.0, 60.0], [320.0, 420.0], [390.0, 440.0]],
    ),
    (
        "upper_link_outer",
        [[-40.0, 60.0], [600.0, 660.0], [400.0, 450.0]],
    ),
    (
        "lower_link_inner",
        [[-90.0, 40.0], [220.0, 320.0], [200.0, 250.0]],
    ),
    (
        "lower_link_outer",
        [[-90.0, 40.0], [620.0, 680.0], [200.0, 250.0]],
    ),
    (
        "wheel_centre",
        [[-20.0, 20.0], [690.0, 800.0], [280.0, 330.0]],
    ),
];

/// Points of a solid axle.
const SOLID_AXLE: [Range; 5] = [
    (
        "lower_link_chassis",
        [[430.0, 560.0], [380.0, 480.0], [280.0, 330.0]],
    ),
    (
        "lower_link_axle",
        [[-20.0, 20.0], [480.0, 560.0], [230.0, 280.0]],
    ),
    (
        "upper_link_chassis",
        [[300.0, 380.0], [420.0, 500.0], [420.0, 470.0]],
    ),
    (
        "upper_link_axle",
        [[-20.0, 30.0], [120.0, 180.0], [450.0, 500.0]],
    ),
    (
        "wheel_centre",
        [[-20.0, 20.0], [720.0, 800.0], [310.0, 350.0]],
    ),
];

/// Points of a semi-trailing arm.
const SEMI_TRAILING_ARM: [Range; 3] = [
    (
        "arm_pivot_inner",
        [[300.0, 420.0], [150.0, 300.0], [200.0, 330.0]],
    ),
    (
        "arm_pivot_outer",
        [[380.0, 520.0], [480.0, 640.0], [200.0, 330.0]],
    ),
    (
        "wheel_centre",
        [[-20.0, 20.0], [650.0, 800.0], [260.0, 330.0]],
    ),
];

/// Spring of a trailing arm.
const SPRING: [Range; 2] = [
    (
        "spring_upper",
        [[-50.0, 80.0], [440.0, 520.0], [500.0, 640.0]],
    ),
    (
        "spring_lower",
        [[-50.0, 80.0], [480.0, 560.0], [180.0, 300.0]],
    ),
];

/// Random left wheel in ISO 8855 (mm), anywhere along the car. If `has_spring` is true, a trailing arm gets its spring.
pub(super) fn geometry(topology: &str, c: &mut Chance, has_spring: bool) -> Points {
    let parts: [&[Range]; 2] = match topology {
        "double_wishbone" => [&LOWER_ARM, &UPPER_ARM],
        "macpherson" => [&LOWER_ARM, &STRUT],
        "five_link" => [&FIVE_LINK, &[]],
        "h_arm" => [&H_ARM, &[]],
        "integral_link" => [&LOWER_ARM, &INTEGRAL_LINK],
        "trailing_arm_two_links" => [&TRAILING_ARM, &[]],
        "solid_axle" => [&SOLID_AXLE, &[]],
        _ => [&SEMI_TRAILING_ARM, &[]],
    };
    let spring: &[Range] = if has_spring { &SPRING } else { &[] };
    let ranges = parts.into_iter().flatten().chain(spring);
    let mut points: Points = ranges
        .map(|(name, [x, y, z])| (*name, c.point(*x, *y, *z)))
        .collect();
    // An integral link suspension has no tie rod.
    points.retain(|(name, _)| topology != "integral_link" || !name.starts_with("tie_rod"));
    // Random offset along the car, because a file can contain a rear axle or have another origin.
    let along = c.between(-2800.0, 1200.0);
    for (_, [x, ..]) in &mut points {
        *x += along;
    }
    points
}
