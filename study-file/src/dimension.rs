//! Dimensions of the numbers in a study: how each number changes if the file uses other units or axes.
//!
//! The tables of this module have one line for each number that a study may contain. A test compares the tables with the types
//! of [`file`](mod@crate::file) and [`car_file`](crate::car_file), so a new key cannot be forgotten. Paths are written as in
//! [`schema`](crate::schema): `suspension.hardpoints{}` is each value of a table whose keys are names, and `optimise.targets[]`
//! is each element of a list. A line applies to all values below its path, too.

use crate::schema::Root;

/// Unit of a number, as powers of the units of length, force and mass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Powers {
    /// Power of the unit of length.
    pub length: i32,
    /// Power of the unit of force.
    pub force: i32,
    /// Power of the unit of mass.
    pub mass: i32,
}

impl Powers {
    const fn new(length: i32, force: i32, mass: i32) -> Self {
        Powers {
            length,
            force,
            mass,
        }
    }

    /// A number whose unit does not depend on the units of the study: an angle, a share, a time, an acceleration.
    pub const NONE: Powers = Powers::new(0, 0, 0);
    /// A length.
    pub const LENGTH: Powers = Powers::new(1, 0, 0);
    /// A force.
    pub const FORCE: Powers = Powers::new(0, 1, 0);
    /// A mass.
    pub const MASS: Powers = Powers::new(0, 0, 1);
    /// A force per length.
    pub const RATE: Powers = Powers::new(-1, 1, 0);
    /// A torque, or a torque per radian. Its unit is the force times the length.
    pub const TORQUE: Powers = Powers::new(1, 1, 0);
}

/// Dimension of a value: its units, and its directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    /// A number, or a list or a range of numbers, without directions.
    Plain(Powers),
    /// Coordinates `[x, y, z]` along the study's axes, each with the same unit: positions, directions, forces.
    Vector(Powers),
    /// Moments `[x, y, z]` about the study's axes.
    Moment,
    /// A displacement along the study's y axis.
    AlongY,
    /// Direction `[x, y, z]` of a displacement whose value is [`Dimension::AlongY`]. If the y axis is reversed, the value
    /// changes its sign, so the direction changes its sign, too.
    DirectionForY,
    /// Six numbers of a bushing: three along its axes, then three about these axes. The units are force and torque, divided by
    /// a power of the deflection.
    Bushing {
        /// Power of the deflection in the denominator.
        by_deflection: i32,
    },
    /// A list of `[x, y]` pairs.
    Pairs([Powers; 2]),
    /// Areas in m2 as coefficients of the terms 1, hf, hr, hf2, hf hr and hr2, where hf and hr are lengths.
    ByTwoLengths,
    /// A number whose dimension depends on other keys of its entry, such as a target.
    OfEntry(Role),
}

/// Role of a number in an entry, such as a target. Another key of the entry names the quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Position in the motion.
    Drive,
    /// Coefficients of the drive as a polynomial of time.
    DrivePolynomial,
    /// Value of the quantity.
    Value,
    /// Size of a difference between two values of the quantity, such as a tolerance. It has no sign.
    Size,
    /// `[lowest, highest]` of the quantity. Each of the two limits may be a curve.
    Between,
    /// Lower limit: a number or a curve.
    AtLeast,
    /// Upper limit: a number or a curve.
    AtMost,
    /// Curve of `[drive, value]` pairs.
    Curve,
    /// Target value of the characteristic that the key names.
    ByKey,
}

use Dimension::{
    AlongY, Bushing, ByTwoLengths, DirectionForY, Moment, OfEntry, Pairs, Plain, Vector,
};
use Role::{AtLeast, AtMost, Between, ByKey, Curve, Drive, DrivePolynomial, Size, Value};

const FIXED: Dimension = Plain(Powers::NONE);
const LENGTH: Dimension = Plain(Powers::LENGTH);
const FORCE: Dimension = Plain(Powers::FORCE);
const MASS: Dimension = Plain(Powers::MASS);
const RATE: Dimension = Plain(Powers::RATE);
const TORQUE: Dimension = Plain(Powers::TORQUE);
const POSITION: Dimension = Vector(Powers::LENGTH);
const DIRECTION: Dimension = Vector(Powers::NONE);
const FORCE_CURVE: Dimension = Pairs([Powers::LENGTH, Powers::FORCE]);
const TORQUE_CURVE: Dimension = Pairs([Powers::NONE, Powers::TORQUE]);

type Line = (&'static str, Dimension);

/// Numbers of a study of one wheel or an axle.
const OF_SUSPENSION: &[Line] = &[
    ("suspension.hardpoints{}", POSITION),
    ("suspension.studs{}", DIRECTION),
    ("suspension.extra_points{}.position", POSITION),
    ("wheel.radius", LENGTH),
    ("wheel.tyre_width", LENGTH),
    ("wheel.rim_diameter", LENGTH),
    ("wheel.static_camber", FIXED),
    ("wheel.static_toe", FIXED),
    ("vehicle.wheelbase", LENGTH),
    ("vehicle.track", LENGTH),
    ("vehicle.cg_height", LENGTH),
    ("vehicle.brake_share_front", FIXED),
    ("vehicle.drive_share_front", FIXED),
    ("vehicle.sprung_mass", MASS),
    ("vehicle.unsprung_mass", MASS),
    ("axle.right.hardpoints{}", POSITION),
    ("axle.right.wheel.static_camber", FIXED),
    ("axle.right.wheel.static_toe", FIXED),
    ("axle.right.spring.rate", RATE),
    ("axle.right.spring.force", FORCE),
    ("axle.right.spring.force_curve", FORCE_CURVE),
    (
        "axle.right.bushings{}.stiffness",
        Bushing { by_deflection: 1 },
    ),
    ("axle.right.bushings{}.scale", FIXED),
    ("axle.right.links{}.axial_stiffness", RATE),
    ("axle.right.links{}.preload", FORCE),
    ("axle.right.links{}.modulus", Plain(Powers::new(-2, 1, 0))),
    ("axle.right.links{}.area", Plain(Powers::new(2, 0, 0))),
    ("steering.c_factor", AlongY),
    ("steering.rack_stiffness", RATE),
    ("steering.column_stiffness", TORQUE),
    ("steering.direction", DirectionForY),
    ("spring.rate", RATE),
    ("spring.force", FORCE),
    ("spring.force_curve", FORCE_CURVE),
    ("bump_stop.gap", LENGTH),
    ("bump_stop.force_curve", FORCE_CURVE),
    ("rebound_stop.gap", LENGTH),
    ("rebound_stop.force_curve", FORCE_CURVE),
    ("anti_roll_bar.rate", TORQUE),
    ("twist_beam.torsional_rate", TORQUE),
    ("heave_spring.rate", RATE),
    ("heave_spring.force", FORCE),
    ("t_bar.rate", TORQUE),
    ("heave_bar.rate", TORQUE),
    ("heave_bar.torque", TORQUE),
    ("tyre.rate", RATE),
    ("tyre.load", FORCE),
    ("compliance.tests[].trail", LENGTH),
    ("compliance.tests[].window", OfEntry(Size)),
    ("bushings{}.stiffness", Bushing { by_deflection: 1 }),
    ("bushings{}.cubic", Bushing { by_deflection: 3 }),
    ("bushings{}.preload", Bushing { by_deflection: 0 }),
    ("bushings{}.scale", FIXED),
    ("bushings{}.fx", FORCE_CURVE),
    ("bushings{}.fy", FORCE_CURVE),
    ("bushings{}.fz", FORCE_CURVE),
    ("bushings{}.tx", TORQUE_CURVE),
    ("bushings{}.ty", TORQUE_CURVE),
    ("bushings{}.tz", TORQUE_CURVE),
    ("bushings{}.x_axis", DIRECTION),
    ("bushings{}.z_axis", DIRECTION),
    ("links{}.axial_stiffness", RATE),
    ("links{}.preload", FORCE),
    ("links{}.modulus", Plain(Powers::new(-2, 1, 0))),
    ("links{}.area", Plain(Powers::new(2, 0, 0))),
    ("subframe.mounts{}", POSITION),
    ("motion.travel", LENGTH),
    ("motion.arm_angle", FIXED),
    ("motion.theta", FIXED),
    ("motion.rack", AlongY),
    ("motion.heave", LENGTH),
    ("motion.roll", FIXED),
    ("motion.travel_left", LENGTH),
    ("motion.travel_right", LENGTH),
    ("motion.steering_wheel_angle", FIXED),
    ("motion.time.polynomial", OfEntry(DrivePolynomial)),
    ("motion.time.from", FIXED),
    ("motion.time.to", FIXED),
    ("motions{}.travel", LENGTH),
    ("motions{}.arm_angle", FIXED),
    ("motions{}.theta", FIXED),
    ("motions{}.rack", AlongY),
    ("motions{}.heave", LENGTH),
    ("motions{}.roll", FIXED),
    ("motions{}.travel_left", LENGTH),
    ("motions{}.travel_right", LENGTH),
    ("motions{}.steering_wheel_angle", FIXED),
    ("motions{}.time.polynomial", OfEntry(DrivePolynomial)),
    ("motions{}.time.from", FIXED),
    ("motions{}.time.to", FIXED),
    // The resolver refuses this key with an explanation.
    ("solver.accuracy", FIXED),
    ("outputs.loads[].force", Vector(Powers::FORCE)),
    ("outputs.loads[].moment", Moment),
    ("sweep.variables[].factors", FIXED),
    ("sweep.variables[].range", OfEntry(Between)),
    ("optimise.good_enough", FIXED),
    ("optimise.variables[].factors", FIXED),
    ("optimise.variables[].direction", DIRECTION),
    ("optimise.variables[].range", OfEntry(Between)),
    ("optimise.variables[].shift", LENGTH),
    ("optimise.variables[].turn", FIXED),
    ("optimise.variables[].cost", FIXED),
    ("setup.adjust[].per_turn", LENGTH),
    ("setup.adjust[].step", LENGTH),
    ("setup.want{}", OfEntry(ByKey)),
    ("setup.ride_height_change", LENGTH),
    ("setup.travel", LENGTH),
    ("tolerance.scatter[].sigma", OfEntry(Size)),
    ("tolerance.scatter[].limits", OfEntry(Between)),
    ("tolerance.scatter[].shift", LENGTH),
    ("tolerance.scatter[].turn", FIXED),
    ("tolerance.bands[].at", OfEntry(Drive)),
    ("tolerance.bands[].roll", FIXED),
    ("tolerance.bands[].heave", LENGTH),
    ("tolerance.bands[].travel_left", LENGTH),
    ("tolerance.bands[].travel_right", LENGTH),
    ("tolerance.bands[].steering_wheel_angle", FIXED),
    ("tolerance.bands[].rack", AlongY),
    ("tolerance.bands[].between", OfEntry(Between)),
    ("tolerance.bands[].at_least", OfEntry(AtLeast)),
    ("tolerance.bands[].at_most", OfEntry(AtMost)),
];

/// Numbers of a study of a car.
const OF_CAR: &[Line] = &[
    ("car.wheelbase", LENGTH),
    ("car.rear_offset", POSITION),
    ("car.mass", MASS),
    ("car.cg", POSITION),
    ("car.sprung_mass", MASS),
    ("car.sprung_cg", POSITION),
    ("car.brake_share_front", FIXED),
    ("car.drive_share_front", FIXED),
    // Inertias are in kg m2 whatever the units of the file.
    ("car.yaw_inertia", FIXED),
    ("car.pitch_inertia", FIXED),
    ("car.ride_height_point_front", POSITION),
    ("car.ride_height_point_rear", POSITION),
    ("car.aero.density", FIXED),
    ("car.aero.front.point", POSITION),
    ("car.aero.front.downforce", ByTwoLengths),
    ("car.aero.rear.point", POSITION),
    ("car.aero.rear.downforce", ByTwoLengths),
    ("car.aero.drag.point", POSITION),
    // Aerodynamic areas are in m2.
    ("car.aero.drag.drag_area", FIXED),
    ("cases[].ax", FIXED),
    ("cases[].ay", FIXED),
    ("cases[].az", FIXED),
    ("cases[].speed", FIXED),
    ("cases[].yaw_acceleration", FIXED),
    ("cases[].rack", AlongY),
    ("cases[].steering_wheel_angle", FIXED),
    ("cases[].rack_rear", AlongY),
    ("cases[].lateral_share_left", FIXED),
    ("gg_map.ax", FIXED),
    ("gg_map.ay", FIXED),
    ("gg_map.az", FIXED),
    ("gg_map.speed", FIXED),
    ("gg_map.rack", AlongY),
    ("sweep.variables[].factors", FIXED),
    ("sweep.variables[].direction", DIRECTION),
    ("sweep.variables[].range", OfEntry(Between)),
    ("sweep.variables[].percent", FIXED),
    ("optimise.variables[].factors", FIXED),
    ("optimise.variables[].direction", DIRECTION),
    ("optimise.variables[].range", OfEntry(Between)),
    ("optimise.variables[].percent", FIXED),
    ("tolerance.scatter[].sigma", OfEntry(Size)),
    ("tolerance.scatter[].percent", FIXED),
    ("tolerance.scatter[].limits", OfEntry(Between)),
    ("tolerance.scatter[].shift", LENGTH),
    ("tolerance.scatter[].turn", FIXED),
    ("tolerance.bands[].between", OfEntry(Between)),
    ("tolerance.bands[].at_least", OfEntry(AtLeast)),
    ("tolerance.bands[].at_most", OfEntry(AtMost)),
];

/// Numbers of targets and constraints, which both kinds of study have.
const OF_TUNING: &[Line] = &[
    ("optimise.targets[].points", OfEntry(Curve)),
    ("optimise.targets[].at", OfEntry(Drive)),
    ("optimise.targets[].value", OfEntry(Value)),
    ("optimise.targets[].between", OfEntry(Between)),
    ("optimise.targets[].at_least", OfEntry(AtLeast)),
    ("optimise.targets[].at_most", OfEntry(AtMost)),
    ("optimise.targets[].roll", FIXED),
    ("optimise.targets[].heave", LENGTH),
    ("optimise.targets[].travel_left", LENGTH),
    ("optimise.targets[].travel_right", LENGTH),
    ("optimise.targets[].steering_wheel_angle", FIXED),
    ("optimise.targets[].rack", AlongY),
    ("optimise.targets[].tolerance", OfEntry(Size)),
    ("optimise.targets[].weight", FIXED),
    ("optimise.constraints[].between", OfEntry(Between)),
    ("optimise.constraints[].at_least", OfEntry(AtLeast)),
    ("optimise.constraints[].at_most", OfEntry(AtMost)),
    ("optimise.constraints[].clearance", LENGTH),
    ("optimise.constraints[].radii", LENGTH),
    ("optimise.constraints[].rack", AlongY),
    ("optimise.constraints[].inside.box", POSITION),
    ("optimise.constraints[].inside.half_space.point", POSITION),
    ("optimise.constraints[].inside.half_space.normal", DIRECTION),
    ("optimise.constraints[].inside.sphere.centre", POSITION),
    ("optimise.constraints[].inside.sphere.radius", LENGTH),
    ("optimise.constraints[].inside.cylinder.from", POSITION),
    ("optimise.constraints[].inside.cylinder.to", POSITION),
    ("optimise.constraints[].inside.cylinder.radius", LENGTH),
    ("optimise.constraints[].inside.rim", LENGTH),
    ("optimise.constraints[].inside.from", LENGTH),
    ("optimise.constraints[].inside.to", LENGTH),
    ("optimise.constraints[].outside.box", POSITION),
    ("optimise.constraints[].outside.half_space.point", POSITION),
    (
        "optimise.constraints[].outside.half_space.normal",
        DIRECTION,
    ),
    ("optimise.constraints[].outside.sphere.centre", POSITION),
    ("optimise.constraints[].outside.sphere.radius", LENGTH),
    ("optimise.constraints[].outside.cylinder.from", POSITION),
    ("optimise.constraints[].outside.cylinder.to", POSITION),
    ("optimise.constraints[].outside.cylinder.radius", LENGTH),
    ("optimise.constraints[].outside.rim", LENGTH),
    ("optimise.constraints[].outside.from", LENGTH),
    ("optimise.constraints[].outside.to", LENGTH),
];

fn lines(root: Root) -> impl Iterator<Item = &'static Line> {
    let own = match root {
        Root::Suspension => OF_SUSPENSION,
        Root::Car => OF_CAR,
    };
    own.iter().chain(OF_TUNING)
}

/// Dimension of the value at exactly this path. `None` for texts, counts, and tables with further keys.
pub fn dimension(root: Root, place: &str) -> Option<Dimension> {
    let line = lines(root).find(|(own, _)| *own == place);
    line.map(|(_, dimension)| *dimension)
}

/// Path of the value with this key in the table at a path. In a table whose keys are names, all values have one path.
pub fn place_of_key(root: Root, table: &str, key: &str) -> String {
    let named = format!("{table}{{}}");
    if lines(root).any(|(own, _)| is_at_or_below(own, &named)) {
        return named;
    }
    crate::schema::key_path(table, key)
}

/// Returns true if `place` is `root` itself or a path below it.
fn is_at_or_below(place: &str, root: &str) -> bool {
    let rest = place.strip_prefix(root);
    rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[', '{']))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::number_places;

    /// The types of [`file`](mod@crate::file) accept a number at exactly the paths that the tables name. Exactly one line of
    /// the tables applies to each path.
    #[test]
    fn every_number_of_a_study_has_one_dimension() {
        for root in Root::ALL {
            let places = number_places(root);
            assert!(places.len() > 60, "{root:?}: {places:?}");
            for place in &places {
                let own = lines(root).filter(|(line, _)| is_at_or_below(place, line));
                assert_eq!(own.count(), 1, "{root:?}: {place}");
            }
            for (line, _) in lines(root) {
                let is_read = places.iter().any(|place| is_at_or_below(place, line));
                assert!(is_read, "{root:?}: the reader knows no number at {line}");
            }
        }
    }

    #[test]
    fn names_and_keys_of_tables_are_told_apart() {
        let of = |table: &str, key: &str| place_of_key(Root::Suspension, table, key);
        assert_eq!(of("", "motion"), "motion");
        assert_eq!(of("motion", "travel"), "motion.travel");
        // A motion may have the same name as a key.
        assert_eq!(of("motions", "travel"), "motions{}");
        assert_eq!(
            of("suspension.hardpoints", "rate"),
            "suspension.hardpoints{}"
        );
        assert_eq!(of("setup.want", "toe"), "setup.want{}");
    }
}
