//! Tests of every quantity of an axle with different sides. One reference is the mirrored axle. The other reference is
//! an independent evaluation from wheel positions, ground geometry and finite differences between positions.

use super::one_state::{axles, natural};
use super::reference::condition;
use hardpoint::axle::{
    Axle, AxlePose, AxleQuantity as A, AxleSolver, Placement, Quantity, WheelQuantity as W,
};
use hardpoint::characteristics::Characteristic as C;
use hardpoint::model::Side::{Left, Right};
use hardpoint::model::{AxlePosition, Side, SpinAxis};
use hardpoint::number::Vector3;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// Axles whose right wheel is not the mirror image of the left one.
fn different() -> Vec<(&'static str, Axle)> {
    let all = axles().into_iter().filter(|(_, axle)| axle.right.is_some());
    let all: Vec<_> = all.collect();
    assert_eq!(all.len(), 3);
    all
}

/// Mirrored axle: each wheel on the other side.
fn mirrored(axle: &Axle) -> Axle {
    let mut setup = axle.setup.clone();
    if let Some(springs) = &mut setup.springs {
        springs.swap(0, 1);
    }
    Axle {
        left: axle.right.clone().unwrap(),
        right: Some(axle.left.clone()),
        setup,
        elastic: None,
    }
}

fn mirrored_placement(placement: &Placement) -> Placement {
    match *placement {
        Placement::Roll { heave, roll, rack } => Placement::Roll {
            heave,
            roll: -roll,
            rack: -rack,
        },
        Placement::AtLoad { heave, roll, rack } => Placement::AtLoad {
            heave,
            roll: -roll,
            rack: -rack,
        },
        Placement::Travels {
            travels: [left, right],
            rack,
            on_plane,
        } => Placement::Travels {
            travels: [right, left],
            rack: -rack,
            on_plane,
        },
    }
}

/// True if the quantity changes its sign in the mirrored axle.
fn is_odd(quantity: Quantity) -> bool {
    match quantity {
        Quantity::Corner(..) | Quantity::Figure(_) => false,
        Quantity::Wheel(_, q) => matches!(q, W::Steer | W::RollCamber | W::RollCamberToRoad),
        Quantity::Axle(q) => matches!(
            q,
            A::RollAngle
                | A::RollCentreLateral
                | A::RollCentreMigrationVertical
                | A::ForceRollCentreMigration
                | A::JackingForceRatio
                | A::MeanSteer
                | A::BarTorque
                | A::TBarTorque
                | A::RollMoment
        ),
    }
}

fn on_other_side(quantity: Quantity) -> Quantity {
    let other = |side| if side == Left { Right } else { Left };
    match quantity {
        Quantity::Corner(side, c) => Quantity::Corner(other(side), c),
        Quantity::Wheel(side, q) => Quantity::Wheel(other(side), q),
        axle => axle,
    }
}

fn placements(steers: bool) -> Vec<Placement> {
    let rack = |rack: f64| if steers { rack } else { 0.0 };
    let roll = |heave: f64, degrees: f64, by: f64| Placement::Roll {
        heave,
        roll: degrees.to_radians(),
        rack: rack(by),
    };
    let travels = |travels: [f64; 2], by: f64, on_plane| Placement::Travels {
        travels,
        rack: rack(by),
        on_plane,
    };
    vec![
        roll(0.0, 0.0, 0.0),
        roll(6.0, -1.6, 12.0),
        roll(-7.0, 1.2, -14.0),
        travels([5.0, -8.0], 11.0, false),
        travels([-4.0, 9.0], -9.0, true),
        Placement::AtLoad {
            heave: 4.0,
            roll: 1.1_f64.to_radians(),
            rack: rack(8.0),
        },
    ]
}

/// Quantities of the catalogue that are available for the axle.
fn quantities(axle: &Axle) -> Vec<Quantity> {
    let all = Quantity::names().into_iter().flat_map(Quantity::named);
    all.filter(|quantity| axle.has(*quantity)).collect()
}

/// Every quantity of the mirrored axle, with opposite roll angle and rack displacement, has the same value or the
/// opposite value.
#[test]
fn a_mirror_exchanges_the_sides() {
    let mut compared = BTreeMap::new();
    for (name, axle) in different() {
        let image = mirrored(&axle);
        let all = quantities(&axle);
        let mut solver = AxleSolver::<3>::new(&axle, &all, true).unwrap();
        let mut image_solver = AxleSolver::<3>::new(&image, &all, true).unwrap();
        for placement in placements(axle.setup.c_factor.is_some()) {
            let placed = solver.place(&placement).unwrap();
            let read = solver.read(&placed).unwrap();
            let other = image_solver.place(&mirrored_placement(&placement)).unwrap();
            let other = image_solver.read(&other).unwrap();
            for quantity in &all {
                let values = (read.value(*quantity), other.value(on_other_side(*quantity)));
                let (Ok(a), Ok(b)) = values else {
                    assert_eq!(values.0.err(), values.1.err(), "{name} {quantity:?}");
                    continue;
                };
                let b = if is_odd(*quantity) { -b } else { b };
                let size = natural(quantity.info().unit).max(a.abs());
                let size = size * condition(&quantity.name(), &read.state);
                assert!(
                    (a - b).abs() < 1e-11 * size,
                    "{name} {placement} {}: {a}, in a mirror {b}",
                    quantity.name()
                );
                *compared.entry(quantity.info().name).or_insert(0) += 1;
            }
        }
    }
    assert_all_compared(&compared);
}

fn assert_all_compared(compared: &BTreeMap<&str, usize>) {
    let wheel = W::ALL.iter().map(|q| q.info().name);
    // `tests/it/solid` compares the quantities that exist only for solid axles and twist beams.
    let of_solid = [
        A::AxleSteer,
        A::AxleLateral,
        A::AxleLongitudinal,
        A::PinionAngle,
        A::RigidAntiSquat,
        A::RigidAntiLift,
        A::RigidAntiDive,
        A::DriveLoadTransfer,
        A::BeamTwist,
        A::BeamTorque,
    ];
    // `rocker_springs` checks springs between the rockers against their energies.
    let between = [
        A::HeaveSpringForce,
        A::HeaveSpringLength,
        A::HeaveSpringMotionRatio,
        A::TBarTorque,
        A::HeaveBarTorque,
    ];
    // `springs` checks stiffnesses with and without tyres against slopes of moments.
    let tyres = [A::RollStiffnessWithTyres, A::RideRateWithoutTyres];
    let lists: [&[A]; 3] = [&of_solid, &between, &tyres];
    let elsewhere = |q: &A| lists.iter().any(|list| list.contains(q));
    let axle = A::ALL.iter().filter(|q| !elsewhere(q));
    let axle = axle.map(|q| q.info().name);
    for name in wheel.chain(axle) {
        assert!(compared.contains_key(name), "{name} is compared nowhere");
    }
}

/// A wheel in the vehicle's axes (x forward, y left, z up), with its velocity per travel.
struct Wheel {
    centre: Vector3<f64>,
    /// Unit vector along the spin axis, outboard.
    axis: Vector3<f64>,
    contact: Vector3<f64>,
    /// Velocity per travel of the carrier point that is at the contact point.
    velocity: Vector3<f64>,
    design_centre: Vector3<f64>,
    design_contact: Vector3<f64>,
}

/// Ground plane: its normal, and its direction to the left.
#[derive(Clone, Copy)]
struct Plane {
    normal: Vector3<f64>,
    left: Vector3<f64>,
}

impl Plane {
    fn at(roll: f64) -> Self {
        let (sine, cosine) = roll.sin_cos();
        Plane {
            normal: Vector3::new(0.0, sine, cosine),
            left: Vector3::new(0.0, cosine, -sine),
        }
    }

    /// Lowest point of a disc above the ground.
    fn contact(&self, centre: Vector3<f64>, axis: Vector3<f64>, radius: f64) -> Vector3<f64> {
        let up = self.normal - axis * axis.dot(self.normal);
        centre - up * (radius / up.norm())
    }
}

/// Derivative at 0 from finite differences of sixth order.
fn derivative<const N: usize>(step: f64, mut at: impl FnMut(f64) -> [f64; N]) -> [f64; N] {
    let values = [-3.0, -2.0, -1.0, 1.0, 2.0, 3.0].map(|k| at(k * step));
    let weights = [-1.0, 9.0, -45.0, 45.0, -9.0, 1.0];
    std::array::from_fn(|n| {
        let terms = values.iter().zip(weights);
        terms.map(|(value, weight)| value[n] * weight).sum::<f64>() / (60.0 * step)
    })
}

/// Steps of the finite differences: first for travels and rack, then for roll angles.
const STEP: f64 = 0.4;
const STEP_OF_ROLL: f64 = 1e-3;

/// Axle evaluated from positions alone.
struct Independent<'a> {
    axle: &'a Axle,
    solver: AxleSolver<'a, 3>,
}

impl<'a> Independent<'a> {
    fn new(axle: &'a Axle, read: &[Quantity]) -> Self {
        let solver = AxleSolver::<3>::new(axle, read, true).unwrap();
        Independent { axle, solver }
    }

    /// Position of the carrier point whose design position is `designed`, in the solver's frame of the side.
    fn carried(&self, placed: &AxlePose, side: Side, designed: Vector3<f64>) -> Vector3<f64> {
        let suspension = self.axle.suspension(side);
        let origin = suspension.design[suspension.mechanism.origin.0];
        let pose = &placed.poses()[side as usize];
        pose.origin + pose.rotation.apply(designed - origin)
    }

    fn wheel(&mut self, placed: &AxlePose, side: Side, plane: Plane) -> Wheel {
        let suspension = self.axle.suspension(side);
        let mechanism = &suspension.mechanism;
        let vehicle = |v: Vector3<f64>| match side {
            Left => v,
            Right => Vector3::new(v.x, -v.y, v.z),
        };
        let designed = suspension.design[mechanism.wheel_centre.0];
        let direction = match mechanism.spin_axis {
            SpinAxis::Along(direction) => direction,
            SpinAxis::From(inner) => {
                let along = designed - suspension.design[inner.0];
                along * (1.0 / along.norm())
            }
        };
        let radius = self.axle.setup.wheel_radius.unwrap();
        let centre = self.carried(placed, side, designed);
        let axis = placed.poses()[side as usize].rotation.apply(direction);
        let contact = plane.contact(vehicle(centre), vehicle(axis), radius);
        let level = Plane::at(0.0);
        // Design position of the carrier point that is now at the contact point.
        let pose = placed.poses()[side as usize];
        let [x, y, z] = pose.rotation.columns;
        let lever = vehicle(contact) - pose.origin;
        let origin = suspension.design[mechanism.origin.0];
        let locked = origin + Vector3::new(x.dot(lever), y.dot(lever), z.dot(lever));
        let velocity = derivative(STEP, |step| {
            let moved = self.solver.place(&Placement::Travels {
                travels: placed.travels.map(|travel| travel + step),
                rack: placed.rack,
                on_plane: false,
            });
            vehicle(self.carried(&moved.unwrap(), side, locked)).to_array()
        });
        Wheel {
            centre: vehicle(centre),
            axis: vehicle(axis),
            contact,
            velocity: velocity.into(),
            design_centre: vehicle(designed),
            design_contact: level.contact(vehicle(designed), vehicle(direction), radius),
        }
    }

    fn wheels(&mut self, placed: &AxlePose) -> ([Wheel; 2], Plane) {
        let plane = Plane::at(placed.roll);
        let wheels = [Left, Right].map(|side| self.wheel(placed, side, plane));
        (wheels, plane)
    }

    /// Outputs of each wheel: spring forces, motion ratios, angles of the anti-roll bar levers, and motion ratios of
    /// these levers.
    fn own(&mut self, placed: &AxlePose) -> [[f64; 2]; 4] {
        let read = self.solver.read(placed).unwrap();
        let has_bar = self.axle.setup.bar_rate.is_some();
        let of = |quantity: Quantity| quantity.evaluate(&read.state);
        let corner = |c: C| [Left, Right].map(|side| of(Quantity::Corner(side, c)));
        let bar = |c: C| if has_bar { corner(c) } else { [0.0; 2] };
        [
            [Left, Right].map(|side| of(Quantity::Wheel(side, W::SpringForce))),
            corner(C::MotionRatio),
            bar(C::AntiRollBarAngle),
            bar(C::AntiRollBarMotionRatio),
        ]
    }

    /// Track, and loads of both wheels from the virtual work of springs and bar.
    fn loads(&mut self, placed: &AxlePose, bar_rate: f64) -> [f64; 3] {
        let [force, ratio, lever, lever_ratio] = self.own(placed);
        let torque = bar_rate * (lever[0] - lever[1]);
        let (wheels, plane) = self.wheels(placed);
        let load = |side: usize, torque: f64| {
            let rise = wheels[side].velocity.dot(plane.normal);
            (force[side] * ratio[side] + torque * lever_ratio[side]) / rise
        };
        let track = plane.left.dot(wheels[0].contact - wheels[1].contact);
        [load(0, torque), load(1, -torque), track]
    }

    fn roll_moment(&mut self, placed: &AxlePose) -> f64 {
        let [left, right, track] = self.loads(placed, self.axle.setup.bar_rate.unwrap_or(0.0));
        0.5 * track * (right - left)
    }

    /// Roll centre: its height above the mean of both contact points, and its distance to the left of their midpoint.
    /// The normals to the velocities of both contact points intersect at the roll centre.
    fn roll_centre(&mut self, placed: &AxlePose) -> [f64; 2] {
        let (wheels, plane) = self.wheels(placed);
        let along = |v: Vector3<f64>| [plane.left.dot(v), plane.normal.dot(v)];
        let [[a, b], [c, d]] = [along(wheels[0].velocity), along(wheels[1].velocity)];
        let [left, right] = [along(wheels[0].contact), along(wheels[1].contact)];
        let (one, two) = (a * left[0] + b * left[1], c * right[0] + d * right[1]);
        let determinant = a * d - b * c;
        let lateral = (one * d - b * two) / determinant;
        let height = (a * two - one * c) / determinant;
        [
            height - 0.5 * (left[1] + right[1]),
            lateral - 0.5 * (left[0] + right[0]),
        ]
    }

    fn jacking(&mut self, placed: &AxlePose) -> [f64; 2] {
        let (wheels, plane) = self.wheels(placed);
        let ratio = |wheel: &Wheel, outboard: f64| {
            outboard * wheel.velocity.dot(plane.left) / wheel.velocity.dot(plane.normal)
        };
        [ratio(&wheels[0], 1.0), ratio(&wheels[1], -1.0)]
    }

    fn force_height(&mut self, placed: &AxlePose) -> f64 {
        let [left, right] = self.jacking(placed);
        let (wheels, plane) = self.wheels(placed);
        plane.left.dot(wheels[0].contact - wheels[1].contact) * (left + right) / 4.0
    }

    /// Camber, camber relative to the ground, and steer of both wheels.
    fn angles(&mut self, placed: &AxlePose) -> [f64; 6] {
        let (wheels, plane) = self.wheels(placed);
        let steer = |wheel: &Wheel, side: f64| {
            // The heading of the wheel is z x a, with the sign that points forward.
            let ahead = Vector3::new(0.0, 0.0, 1.0).cross(wheel.axis) * -side;
            ahead.y.atan2(ahead.x)
        };
        let [left, right] = &wheels;
        [
            -left.axis.z.asin(),
            -right.axis.z.asin(),
            -left.axis.dot(plane.normal).asin(),
            -right.axis.dot(plane.normal).asin(),
            steer(left, 1.0),
            steer(right, -1.0),
        ]
    }

    /// Derivatives with respect to the parameter of a placement.
    fn along<const N: usize>(
        &mut self,
        step: f64,
        placement: impl Fn(f64) -> Placement,
        of: impl Fn(&mut Self, &AxlePose) -> [f64; N],
    ) -> [f64; N] {
        derivative(step, |by| {
            let placed = self.solver.place(&placement(by)).unwrap();
            of(self, &placed)
        })
    }
}

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
type Values = Vec<(Quantity, f64)>;

fn wheel_values(both: &mut Independent<'_>, placed: &AxlePose, values: &mut Values) {
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

fn axle_values(both: &mut Independent<'_>, placed: &AxlePose, values: &mut Values) {
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
fn values_of_motions(
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

/// On axles with different sides, every quantity of the catalogue equals its independent evaluation. That evaluation
/// uses only wheel positions, the outputs of each wheel, and finite differences between positions.
#[test]
fn quantities_are_those_of_an_independent_evaluation() {
    let mut compared = BTreeMap::new();
    for (name, mut axle) in different() {
        axle.setup.tyre_rate.get_or_insert(190.0);
        axle.setup.sprung_mass.get_or_insert(610.0);
        axle.setup.unsprung_mass.get_or_insert(85.0);
        let all: Vec<Quantity> = quantities(&axle);
        let mut both = Independent::new(&axle, &all);
        for placement in placements(axle.setup.c_factor.is_some()) {
            let placed = both.solver.place(&placement).unwrap();
            let mut values = Values::new();
            wheel_values(&mut both, &placed, &mut values);
            axle_values(&mut both, &placed, &mut values);
            match placement {
                Placement::Roll { heave, roll, rack } => {
                    values_of_motions(&mut both, [heave, roll, rack], false, &mut values);
                }
                Placement::AtLoad { heave, roll, rack } => {
                    let mean = 0.5 * (placed.travels[0] + placed.travels[1]);
                    let mut moving = Values::new();
                    values_of_motions(&mut both, [mean, roll, rack], false, &mut moving);
                    values.append(&mut moving);
                    values_of_motions(&mut both, [heave, roll, rack], true, &mut moving);
                    let of_load = Quantity::Axle(A::RollStiffnessAtLoad);
                    values.extend(moving.into_iter().filter(|(q, _)| *q == of_load));
                }
                Placement::Travels { .. } => {}
            }
            for side in [Left, Right] {
                let spring = &axle.setup.springs.as_ref().unwrap()[side as usize];
                let read = both.solver.read(&placed).unwrap();
                let length = Quantity::Corner(side, C::SpringLength).evaluate(&read.state);
                let designed = both.axle.suspension(side);
                let [lower, upper] = spring_ends(designed);
                let force = spring.force(length, (upper - lower).norm());
                values.push((Quantity::Wheel(side, W::SpringForce), force));
            }
            let read = both.solver.read(&placed).unwrap();
            for (quantity, expected) in values.into_iter().filter(|(q, _)| axle.has(*q)) {
                let found = read
                    .value(quantity)
                    .unwrap_or_else(|why| panic!("{quantity:?}: {why:?}"));
                let size = natural(quantity.info().unit).max(expected.abs());
                let size = size * condition(&quantity.name(), &read.state);
                assert!(
                    (found - expected).abs() < 1e-7 * size,
                    "{name} {placement} {}: {found}, not {expected}",
                    quantity.name()
                );
                *compared.entry(quantity.info().name).or_insert(0) += 1;
            }
        }
    }
    assert_all_compared(&compared);
}

/// Ends of the spring or of the strut in the design position.
fn spring_ends(suspension: &hardpoint::model::Suspension) -> [Vector3<f64>; 2] {
    let names = ["spring_lower", "spring_upper", "strut_lower", "strut_top"];
    let found = names.map(|name| suspension.mechanism.point(name));
    let at = |id: Option<hardpoint::model::PointId>| id.map(|id| suspension.design[id.0]);
    match found.map(at) {
        [Some(lower), Some(upper), ..] | [_, _, Some(lower), Some(upper)] => [lower, upper],
        _ => panic!("no spring"),
    }
}
