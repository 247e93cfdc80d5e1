//! Positions of a car's points relative to the ground, for drawings.

use super::{CarQuantity, CarSolver, Case, Equilibrium, NoEquilibrium, WheelPlace, WheelResult};
use crate::model::{PointId, Side};
use crate::number::{Each, Vector3};

/// Positions in the axes of the ground under the car. Order of the coordinates: forward, left, height above the ground.
#[derive(Clone, Debug, PartialEq)]
pub struct CarDrawing {
    /// Points of each axle: first the left wheel's points, then the right wheel's points.
    pub points: [Vec<[f64; 3]>; 2],
    /// Lowest point of each wheel: front left, front right, rear left, rear right.
    pub contacts: [[f64; 3]; 4],
    /// Wheel centres, in the order of `contacts`.
    pub centres: [[f64; 3]; 4],
    /// Unit vectors along the spin axes, outboard, in the order of `contacts`.
    pub spin_axes: [[f64; 3]; 4],
    /// Centre of gravity of the sprung mass.
    pub sprung_cg: [f64; 3],
    /// Forward, left and upward direction of the ground, as unit vectors in the axes of the body.
    pub axes: [[f64; 3]; 3],
}

impl CarSolver<'_> {
    /// Computes the positions of all points in a state.
    ///
    /// # Errors
    /// Returns the reason if a wheel has no pose.
    pub fn drawing(
        &mut self,
        case: &Case,
        found: &Equilibrium,
    ) -> Result<CarDrawing, NoEquilibrium> {
        let balance = self.balance(case, found)?;
        let poses = self.poses(found)?;
        let (road, ground) = (&balance.road, found.unknowns[super::equations::GROUND]);
        let place = |v: Vector3<f64>| {
            [
                road.forward.dot(v),
                road.left.dot(v),
                road.up.dot(v) - ground,
            ]
            .each(|c| c + 0.0)
        };
        let offset = |axle: usize| match axle {
            0 => Vector3::default(),
            _ => self.car.rear_offset,
        };
        // The coordinates of each wheel are in the frame of its side. The frame of a right wheel is the mirror image of
        // the left wheel's frame.
        let plain = |axle: usize, side: Side, v: Vector3<f64>| {
            Vector3::new(v.x, side.sign() * v.y, v.z) + offset(axle)
        };
        // The design of a steered solid axle contains the displacement of its steering gear.
        for (axle, placed) in poses.iter().enumerate() {
            let steered = self.axles[axle].steer(placed.rack);
            steered.map_err(|failure| NoEquilibrium::NoPose { axle, failure })?;
        }
        let configuration =
            |axle: usize, side: Side| self.axles[axle].drawn_configuration(side, &poses[axle]);
        let points = [0, 1].map(|axle| {
            let of_side = |side: Side| {
                let at = configuration(axle, side);
                let all = 0..at.mechanism.points.len();
                let places = all.map(|k| place(plain(axle, side, at.point(PointId(k)))));
                places.collect::<Vec<_>>()
            };
            Side::ALL.map(of_side).concat()
        });
        let turned = |v: Vector3<f64>| [road.forward, road.left, road.up].each(|axis| axis.dot(v));
        let spin_axes = WheelPlace::ALL.each(|wheel| {
            let side = Side::ALL[wheel.0 % 2];
            let own = configuration(wheel.0 / 2, side).spin_axis();
            turned(Vector3::new(own.x, side.sign() * own.y, own.z))
        });
        let centres = [0, 1, 2, 3].each(|number| {
            let (axle, side) = (number / 2, number % 2);
            let wheel = self.car.axles[axle].suspension(Side::ALL[side]);
            let own = &points[axle][side * (points[axle].len() / 2)..];
            own[wheel.mechanism.wheel_centre.0]
        });
        let contacts = WheelPlace::ALL.each(|wheel| {
            let coordinates = [
                WheelResult::ContactX,
                WheelResult::ContactY,
                WheelResult::ContactZ,
            ];
            let of = |result| CarQuantity::Wheel(wheel, result).evaluate_state(&balance);
            place(Vector3::from(coordinates.each(of)))
        });
        Ok(CarDrawing {
            points,
            contacts,
            centres,
            spin_axes,
            sprung_cg: place(balance.sprung.1),
            axes: [road.forward, road.left, road.up].each(|axis| axis.to_array()),
        })
    }
}
