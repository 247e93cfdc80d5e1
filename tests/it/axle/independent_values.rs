//! Quantities of an axle from the independent evaluation in `independent`.

use super::independent::{Independent, STEP, STEP_OF_ROLL, Wheel};
use hardpoint::axle::{Axle, AxlePose, AxleQuantity as A, Placement, Quantity, WheelQuantity as W};
use hardpoint::model::AxlePosition;
use hardpoint::model::Side::{Left, Right};
use hardpoint::number::Vector3;
use std::f64::consts::TAU;

/// Turning geometry, seen from above.
struct FromAbove {
    inner: f64,
    outer: f64,
    ideal_outer: f64,
    wheelbase: f64,
    design_across: f64,
    circle: f64,
}

/// Turning geometry, seen from above. A rear axle is treated as the front axle of the reversed vehicle. A right turn is
/// mirrored, so that the left wheel is always the inner one.
fn from_above(wheels: &[Wheel; 2], steer: [f64; 2], axle: &Axle) -> FromAbove {
    let backwards = axle.setup.position == Some(AxlePosition::Rear);
    let flip = if backwards { -1.0 } else { 1.0 };
    let steer = steer.map(|angle| flip * angle);
    let to_left = steer[0] + steer[1] > 0.0;
    let sign = if to_left { 1.0 } else { -1.0 };
    let (inner, outer) = if to_left { (0, 1) } else { (1, 0) };
    let seen = |v: Vector3<f64>| [flip * v.x, sign * v.y];
    let middle = 0.5 * (wheels[0].design_centre.x + wheels[1].design_centre.x);
    let wheelbase = axle.setup.wheelbase.unwrap();
    let line = flip * middle - wheelbase;
    let meets = |wheel: &Wheel| {
        let ([x, y], [dx, dy]) = (seen(wheel.centre), seen(wheel.axis));
        y + dy / dx * (line - x)
    };
    let [inner_meets, outer_meets] = [meets(&wheels[inner]), meets(&wheels[outer])];
    let [x, y] = seen(wheels[outer].centre);
    let ideal_outer = (x - line).atan2(inner_meets - y);
    let [contact_x, contact_y] = seen(wheels[outer].contact);
    FromAbove {
        inner: sign * steer[inner],
        outer: sign * steer[outer],
        ideal_outer,
        wheelbase,
        design_across: wheels[0].design_centre.y - wheels[1].design_centre.y,
        circle: 2.0 * (contact_x - line).hypot(contact_y - 0.5 * (inner_meets + outer_meets)),
    }
}

/// Values of quantities from this evaluation.
pub(super) type Values = Vec<(Quantity, f64)>;

pub(super) fn wheel_values(both: &mut Independent<'_>, placed: &AxlePose, values: &mut Values) {
    let (wheels, plane) = both.wheels(placed);
    let angles = both.angles(placed);
    let jacking = both.jacking(placed);
    let loads = both.loads(placed, both.axle.setup.bar_rate.unwrap_or(0.0));
    let pads = both.along(
        STEP,
        |by| Placement::Travels {
            travels: placed.travels.map(|travel| travel + by),
            rack: placed.rack,
            on_plane: false,
        },
        |both, moved| {
            let [left, right, _] = both.loads(moved, 0.0);
            let (wheels, _) = both.wheels(moved);
            [left, right, wheels[0].contact.z, wheels[1].contact.z]
        },
    );
    for (k, side) in [Left, Right].into_iter().enumerate() {
        let mut add = |q: W, value: f64| values.push((Quantity::Wheel(side, q), value));
        add(W::Steer, angles[4 + k]);
        add(W::CamberToRoad, angles[2 + k]);
        add(W::JackingCoefficient, jacking[k]);
        let wheel = &wheels[k];
        let across = wheel.axis - plane.normal * wheel.axis.dot(plane.normal);
        let side_force = wheel.velocity.dot(across) / across.norm();
        add(
            W::SideForceJacking,
            side_force / wheel.velocity.dot(plane.normal),
        );
        add(W::WheelLoad, loads[k]);
        add(W::WheelRate, pads[k] / pads[2 + k]);
    }
}

pub(super) fn axle_values(both: &mut Independent<'_>, placed: &AxlePose, values: &mut Values) {
    let axle = both.axle;
    let (wheels, plane) = both.wheels(placed);
    let mut add = |q: A, value: f64| values.push((Quantity::Axle(q), value));
    let track = plane.left.dot(wheels[0].contact - wheels[1].contact);
    add(A::Track, track);
    let designed = wheels[0].design_contact.y - wheels[1].design_contact.y;
    add(A::TrackChange, track - designed);
    add(A::RollAngle, placed.roll);
    let [height, lateral] = both.roll_centre(placed);
    add(A::RollCentreHeight, height);
    add(A::RollCentreLateral, lateral);
    add(A::ForceRollCentreHeight, both.force_height(placed));
    let [left, right] = both.jacking(placed);
    add(A::JackingForceRatio, 0.5 * (right - left));
    let angles = both.angles(placed);
    let mean = 0.5 * (angles[4] + angles[5]);
    add(A::MeanSteer, mean);
    add(A::TotalToe, angles[5] - angles[4]);
    if let Some(diameter) = axle.left.rim_diameter {
        // Distance between the rear edges of both rims, and between their front edges.
        let edges = |end: f64| {
            let edge = |wheel: &Wheel, side: f64| {
                let level = Vector3::new(0.0, 0.0, 1.0).cross(wheel.axis) * -side;
                side * end * 0.5 * diameter * level.y / level.norm()
            };
            edge(&wheels[0], 1.0) + edge(&wheels[1], -1.0)
        };
        add(A::TotalToeAtRim, edges(-1.0) - edges(1.0));
    }
    if axle.setup.wheelbase.is_some() && mean.abs() > 0.021 {
        let turn = from_above(&wheels, [angles[4], angles[5]], axle);
        let (i, o) = (turn.inner, turn.outer);
        add(A::AckermannError, o - turn.ideal_outer);
        add(A::Ackermann, 100.0 * (i - o) / (i - turn.ideal_outer));
        let (l, t) = (turn.wheelbase, turn.design_across);
        let ideal_inner = (l * o.sin()).atan2(l * o.cos() - t * o.sin());
        add(A::AckermannByInner, 100.0 * (i - o) / (ideal_inner - o));
        let cotangents = 1.0 / o.tan() - 1.0 / i.tan();
        add(A::AckermannByCotangents, 100.0 * l * cotangents / t);
        add(A::TurningCircle, turn.circle);
    }
    if let Some(rate) = axle.setup.bar_rate {
        let [_, _, lever, _] = both.own(placed);
        add(A::BarTorque, rate * (lever[0] - lever[1]));
    }
    add(A::RollMoment, both.roll_moment(placed));
    let travels = placed.travels;
    let [moment, angle] = both.along(
        STEP,
        |by| Placement::Travels {
            travels: [travels[0] - by, travels[1] + by],
            rack: placed.rack,
            on_plane: false,
        },
        |both, moved| {
            let (wheels, _) = both.wheels(moved);
            let apart = wheels[0].contact - wheels[1].contact;
            [both.roll_moment(moved), (-apart.z).atan2(apart.y)]
        },
    );
    add(A::RollStiffness, moment / angle);
}

/// Derivatives with respect to roll, heave and rack on a plane, and natural frequencies.
pub(super) fn values_of_motions(
    both: &mut Independent<'_>,
    [heave, roll, rack]: [f64; 3],
    at_load: bool,
    values: &mut Values,
) {
    let mut add = |q: Quantity, value: f64| values.push((q, value));
    let at = |heave: f64, roll: f64, rack: f64| Placement::Roll { heave, roll, rack };
    let rolled = both.along(
        STEP_OF_ROLL,
        |by| at(heave, roll + by, rack),
        |both, placed| {
            let [
                camber_left,
                camber_right,
                road_left,
                road_right,
                left,
                right,
            ] = both.angles(placed);
            let [height, lateral] = both.roll_centre(placed);
            let (force, moment) = (both.force_height(placed), both.roll_moment(placed));
            [
                camber_left,
                camber_right,
                road_left,
                road_right,
                left,
                right,
                height,
                lateral,
                force,
                moment,
            ]
        },
    );
    for (k, side) in [Left, Right].into_iter().enumerate() {
        add(Quantity::Wheel(side, W::RollCamber), rolled[k]);
        add(Quantity::Wheel(side, W::RollCamberToRoad), rolled[2 + k]);
        add(Quantity::Wheel(side, W::WheelRollSteer), rolled[4 + k]);
    }
    let of_axle = [
        (A::RollSteer, 0.5 * (rolled[4] + rolled[5])),
        (A::RollCentreMigrationVertical, rolled[6]),
        (A::RollCentreMigrationLateral, rolled[7]),
        (A::ForceRollCentreMigration, rolled[8]),
        (A::RollStiffnessOnRoad, rolled[9]),
    ];
    for (q, value) in of_axle {
        add(Quantity::Axle(q), value);
    }
    let setup = &both.axle.setup;
    let bar_rate = setup.bar_rate.unwrap_or(0.0);
    let [axle_load] = both.along(
        STEP,
        |by| at(heave + by, roll, rack),
        |both, placed| {
            let [left, right, _] = both.loads(placed, bar_rate);
            [left + right]
        },
    );
    let spring = 0.5 * axle_load;
    let tyre = setup.tyre_rate.unwrap();
    let ride = 1.0 / (1.0 / spring + 1.0 / tyre);
    add(Quantity::Axle(A::RideRate), ride);
    let hertz = |rate: f64, mass: f64| (2.0 * rate * setup.per_metre / mass).sqrt() / TAU;
    let frequency = hertz(ride, setup.sprung_mass.unwrap());
    add(Quantity::Axle(A::RideFrequency), frequency);
    let placed = both.solver.place(&at(heave, roll, rack)).unwrap();
    let mut wheels = Vec::new();
    wheel_values(both, &placed, &mut wheels);
    let rates = wheels
        .iter()
        .filter(|(q, _)| matches!(q, Quantity::Wheel(_, W::WheelRate)));
    let mean = 0.5 * rates.map(|(_, rate)| rate).sum::<f64>();
    let hop = hertz(mean + tyre, setup.unsprung_mass.unwrap());
    add(Quantity::Axle(A::WheelHopFrequency), hop);
    if let Some(c_factor) = setup.c_factor {
        let [left, right] = both.along(
            STEP,
            |by| at(heave, roll, rack + by),
            |both, placed| {
                let [.., left, right] = both.angles(placed);
                [left, right]
            },
        );
        let ratio = TAU / (c_factor * 0.5 * (left + right));
        add(Quantity::Axle(A::SteeringRatio), ratio);
    }
    if at_load {
        let [moment] = both.along(
            STEP_OF_ROLL,
            |by| Placement::AtLoad {
                heave,
                roll: roll + by,
                rack,
            },
            |both, placed| [both.roll_moment(placed)],
        );
        add(Quantity::Axle(A::RollStiffnessAtLoad), moment);
    }
}
