//! Independent evaluation of an axle from wheel positions, ground geometry and finite differences between positions.

use hardpoint::axle::{Axle, AxlePose, AxleSolver, Placement, Quantity, WheelQuantity as W};
use hardpoint::characteristics::Characteristic as C;
use hardpoint::model::Side::{Left, Right};
use hardpoint::model::{Side, SpinAxis};
use hardpoint::number::Vector3;

/// A wheel in the vehicle's axes (x forward, y left, z up), with its velocity per travel.
pub(super) struct Wheel {
    pub(super) centre: Vector3<f64>,
    /// Unit vector along the spin axis, outboard.
    pub(super) axis: Vector3<f64>,
    pub(super) contact: Vector3<f64>,
    /// Velocity per travel of the carrier point that is at the contact point.
    pub(super) velocity: Vector3<f64>,
    pub(super) design_centre: Vector3<f64>,
    pub(super) design_contact: Vector3<f64>,
}

/// Ground plane: its normal, and its direction to the left.
#[derive(Clone, Copy)]
pub(super) struct Plane {
    pub(super) normal: Vector3<f64>,
    pub(super) left: Vector3<f64>,
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

/// Step of the finite differences for travels and rack, in the length unit.
pub(super) const STEP: f64 = 0.4;
/// Step of the finite differences for roll angles, radians.
pub(super) const STEP_OF_ROLL: f64 = 1e-3;

/// Axle evaluated from positions alone.
pub(super) struct Independent<'a> {
    pub(super) axle: &'a Axle,
    pub(super) solver: AxleSolver<'a, 3>,
}

impl<'a> Independent<'a> {
    pub(super) fn new(axle: &'a Axle, read: &[Quantity]) -> Self {
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

    pub(super) fn wheels(&mut self, placed: &AxlePose) -> ([Wheel; 2], Plane) {
        let plane = Plane::at(placed.roll);
        let wheels = [Left, Right].map(|side| self.wheel(placed, side, plane));
        (wheels, plane)
    }

    /// Outputs of each wheel: spring forces, motion ratios, angles of the anti-roll bar levers, and motion ratios of
    /// these levers.
    pub(super) fn own(&mut self, placed: &AxlePose) -> [[f64; 2]; 4] {
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
    pub(super) fn loads(&mut self, placed: &AxlePose, bar_rate: f64) -> [f64; 3] {
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

    pub(super) fn roll_moment(&mut self, placed: &AxlePose) -> f64 {
        let [left, right, track] = self.loads(placed, self.axle.setup.bar_rate.unwrap_or(0.0));
        0.5 * track * (right - left)
    }

    /// Roll centre: its height above the mean of both contact points, and its distance to the left of their midpoint.
    /// The normals to the velocities of both contact points intersect at the roll centre.
    pub(super) fn roll_centre(&mut self, placed: &AxlePose) -> [f64; 2] {
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

    pub(super) fn jacking(&mut self, placed: &AxlePose) -> [f64; 2] {
        let (wheels, plane) = self.wheels(placed);
        let ratio = |wheel: &Wheel, outboard: f64| {
            outboard * wheel.velocity.dot(plane.left) / wheel.velocity.dot(plane.normal)
        };
        [ratio(&wheels[0], 1.0), ratio(&wheels[1], -1.0)]
    }

    pub(super) fn force_height(&mut self, placed: &AxlePose) -> f64 {
        let [left, right] = self.jacking(placed);
        let (wheels, plane) = self.wheels(placed);
        plane.left.dot(wheels[0].contact - wheels[1].contact) * (left + right) / 4.0
    }

    /// Camber, camber relative to the ground, and steer of both wheels.
    pub(super) fn angles(&mut self, placed: &AxlePose) -> [f64; 6] {
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
    pub(super) fn along<const N: usize>(
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
