//! Positions of all points of both wheels along a motion, for drawings: the ground is level and the body rolls.
//!
//! Curves of an axle are in the axes of the body, so the ground is inclined. For a drawing, the program rotates both
//! wheels and the ground back by the roll angle about x. It then moves the body vertically. So the ground has the same
//! height as in the design position.

use super::elastic::Equilibria;
use super::formulas::steering::turn;
use super::reading::WheelParts;
use super::solver::{AxlePose, AxleSolver, Placement};
use super::{Axle, AxleQuantity, AxleState, Quantity};
use crate::characteristics::instant_centres_of;
use crate::compliance::Here;
use crate::curves::{OtherWheel, Placement as Drawn, Turn};
use crate::mechanism::{Configuration, DesignFault, NoPose};
use crate::model::{Frame, PointId, Side};
use crate::number::{Each, Vector3};
use crate::study::AxleComplianceStudy;

/// Returns both wheels in every pose, in the study's axes, or the reason why a pose does not exist. With elastic parts,
/// the carriers are in their equilibrium positions, and there are no instant centres. The error is the reason why the
/// design position of a wheel cannot be solved, or why it has no elastic model.
pub fn axle_frames(
    axle: &Axle,
    placements: &[Placement],
) -> Result<Vec<Result<Drawn, NoPose>>, (Side, DesignFault)> {
    if let Some(elastic) = &axle.elastic {
        return equilibrium_frames(axle, elastic, placements);
    }
    let mut quantities = Vec::new();
    if axle.setup.wheel_radius.is_some() {
        quantities.push(Quantity::Axle(AxleQuantity::RollCentreHeight));
        quantities.push(Quantity::Axle(AxleQuantity::RollCentreLateral));
    }
    let mut solver = AxleSolver::<2>::new(axle, &quantities, false)?;
    solver.watch_all_rockers();
    let ground = design_ground(axle, &mut solver);
    let placed = solver.place_all(placements);
    let drawn = placed.into_iter().map(|placed| {
        let placed = placed?;
        drawn(axle, &mut solver, &placed, ground)
    });
    Ok(drawn.collect())
}

/// Returns both wheels in the body's axes, or the reason why there is no pose. The points of each wheel are in the
/// study's axes, on the correct side. With elastic parts, the carriers are in their equilibrium positions.
///
/// # Errors
/// If the design position of a wheel cannot be solved, or has no elastic model.
pub fn axle_sides(
    axle: &Axle,
    placement: &Placement,
) -> Result<Result<[Drawn; 2], NoPose>, (Side, DesignFault)> {
    let mut solver = AxleSolver::<2>::new(axle, &[], false)?;
    let Some(elastic) = &axle.elastic else {
        solver.watch_all_rockers();
        return Ok(rigid_sides(axle, &mut solver, placement));
    };
    let equilibria = axle.own_equilibria(elastic)?;
    Ok(in_equilibrium(&equilibria, placement).and_then(|here| {
        each_side(|side| {
            let (at, contact) = carrier_at(axle, &solver, &here, side);
            side_at_rest(axle, side, &at, contact)
        })
    }))
}

fn in_equilibrium(equilibria: &Equilibria<'_>, placement: &Placement) -> Result<Here, NoPose> {
    let place = placement.on_level_pads().ok_or(NoPose::NoGround)?;
    Ok(equilibria.here(place)?)
}

/// Returns a wheel of an axle in equilibrium, and the contact point of this wheel.
fn carrier_at<'a>(
    axle: &'a Axle,
    solver: &'a AxleSolver<'_, 2>,
    here: &Here,
    side: Side,
) -> (Configuration<'a, f64>, Vector3<f64>) {
    let (design, mechanism) = (solver.design(side), &axle.suspension(side).mechanism);
    let pose = here.axle.pose(&here.at, side, design[mechanism.origin.0]);
    let rack = here.axle.rack(&here.at) * side.sign();
    let contact = here.axle.figures(&here.at, side).contact;
    (Configuration::new(mechanism, design, pose, rack), contact)
}

/// Returns both wheels in equilibrium for each of these placements. The body is level, and each wheel is on a separate
/// pad. The mean height of the pads equals the height of the ground in the design position.
fn equilibrium_frames(
    axle: &Axle,
    elastic: &AxleComplianceStudy,
    placements: &[Placement],
) -> Result<Vec<Result<Drawn, NoPose>>, (Side, DesignFault)> {
    let mut solver = AxleSolver::<2>::new(axle, &[], false)?;
    let ground = design_ground(axle, &mut solver);
    let equilibria = axle.own_equilibria(elastic)?;
    let has_ground = axle.setup.wheel_radius.is_some();
    let drawn = placements.iter().map(|placement| {
        let here = in_equilibrium(&equilibria, placement)?;
        let wheels = Side::ALL.each(|side| carrier_at(axle, &solver, &here, side));
        let [left, right] = &wheels;
        let attitude = Attitude {
            frame: &axle.left.frame,
            sine: 0.0,
            cosine: 1.0,
            lifted: if has_ground {
                ground - 0.5 * (left.1.z + right.1.z)
            } else {
                0.0
            },
        };
        let wheel = |side: Side| {
            let (at, contact) = &wheels[side as usize];
            OtherWheel {
                spin_axis: attitude.direction(side, at.spin_axis()),
                contact: has_ground.then(|| attitude.place(side, *contact)),
                front_view_centre: None,
                side_view_centre: None,
            }
        };
        let points = attitude.points([&left.0, &right.0]);
        Ok(Drawn::of_axle(points, Side::ALL.map(wheel), None, None))
    });
    Ok(drawn.collect())
}

fn rigid_sides(
    axle: &Axle,
    solver: &mut AxleSolver<2>,
    placement: &Placement,
) -> Result<[Drawn; 2], NoPose> {
    let placed = solver.place(placement)?;
    let read = solver.read(&placed)?;
    if let Some(failure) = read.toggle_failure(&placed) {
        return Err(failure);
    }
    each_side(|side| {
        let at = solver.drawn_configuration(side, &placed);
        let contact = read.state.wheels()[side as usize].contact_point();
        side_at_rest(axle, side, &at, contact)
    })
}

fn each_side(of: impl Fn(Side) -> Result<Drawn, NoPose>) -> Result<[Drawn; 2], NoPose> {
    Ok([of(Side::Left)?, of(Side::Right)?])
}

fn side_at_rest(
    axle: &Axle,
    side: Side,
    at: &Configuration<f64>,
    contact: Vector3<f64>,
) -> Result<Drawn, NoPose> {
    let contact = axle.setup.wheel_radius.map(|_| contact);
    let mut wheel = axle.suspension(side).clone();
    if side == Side::Right {
        wheel.frame = axle.left.frame.of_other_side();
    }
    Ok(Drawn::at_rest(&wheel, at, contact)?)
}

/// Height of the ground in the design position.
fn design_ground(axle: &Axle, solver: &mut AxleSolver<2>) -> f64 {
    let radius = axle.setup.wheel_radius.unwrap_or(0.0);
    let [left, right] = Side::ALL.each(|side| {
        let corner = axle.suspension(side);
        let centre = corner.design[corner.mechanism.wheel_centre.0];
        let level = super::Ground::level(0.0);
        let axis = solver.spin_axis(side);
        (centre + level.contact_lever(axis, radius)).z
    });
    0.5 * (left + right)
}

/// Position of the body in a drawing: the body is rotated by the roll angle, and the ground keeps its height.
struct Attitude<'a> {
    frame: &'a Frame,
    sine: f64,
    cosine: f64,
    /// Vertical displacement of the body, positive up.
    lifted: f64,
}

impl Attitude<'_> {
    /// Rotates a vector with the body. The vector is in the frame of its side. The frame of the right side is the
    /// mirror image of the frame of the left side.
    fn turned(&self, side: Side, v: Vector3<f64>) -> Vector3<f64> {
        let y = match side {
            Side::Left => v.y,
            Side::Right => -v.y,
        };
        let (sine, cosine) = (self.sine, self.cosine);
        Vector3::new(v.x, y * cosine - v.z * sine, y * sine + v.z * cosine)
    }

    /// Returns the position of a point in the drawing, in the kernel's axes.
    fn placed(&self, side: Side, v: Vector3<f64>) -> Vector3<f64> {
        self.turned(side, v) + Vector3::new(0.0, 0.0, self.lifted)
    }

    /// Converts a vector to the study's axes, and replaces -0 by 0.
    fn written(&self, v: Vector3<f64>) -> [f64; 3] {
        self.frame.vector(v).to_array().each(|x| x + 0.0)
    }

    fn direction(&self, side: Side, v: Vector3<f64>) -> [f64; 3] {
        self.written(self.turned(side, v))
    }

    fn place(&self, side: Side, v: Vector3<f64>) -> [f64; 3] {
        self.written(self.placed(side, v))
    }

    /// Positions of all points. The points of the left wheel come first.
    fn points(&self, wheels: [&Configuration<f64>; 2]) -> Vec<[f64; 3]> {
        let wheels = Side::ALL.into_iter().zip(wheels);
        let points = wheels.flat_map(|(side, at)| {
            let all = 0..at.mechanism.points.len();
            all.map(move |i| self.place(side, at.point(PointId(i))))
        });
        points.collect()
    }

    /// Spin axis, contact point and instant centres of a wheel.
    fn wheel(&self, side: Side, state: &AxleState<f64>, has_ground: bool) -> OtherWheel {
        let wheel = &state.wheels()[side as usize];
        let mut drawn = OtherWheel {
            spin_axis: self.direction(side, wheel.reading.spin_axis()),
            contact: None,
            front_view_centre: None,
            side_view_centre: None,
        };
        if has_ground {
            let contact = wheel.contact_point();
            let [_, turn] = wheel.reading.by_travel();
            let (velocity, size) = (wheel.contact_velocity(), state.setup.constants.size);
            let [front, view] = instant_centres_of(contact, velocity, turn, size);
            drawn.contact = Some(self.place(side, contact));
            drawn.front_view_centre = front.map(|v| self.place(side, v));
            drawn.side_view_centre = view.map(|v| self.place(side, v));
        }
        drawn
    }

    /// Position of the roll centre in the drawing. It is computed from the coordinates along the ground and above the
    /// ground.
    fn roll_centre(&self, state: &AxleState<f64>) -> Option<[f64; 3]> {
        let value = |quantity| Quantity::Axle(quantity).value(state).ok();
        let height = value(AxleQuantity::RollCentreHeight)?;
        let lateral = value(AxleQuantity::RollCentreLateral)?;
        let contacts = Side::ALL.each(|side| {
            let wheel = &state.wheels()[side as usize];
            self.placed(side, wheel.contact_point())
        });
        let between = (contacts[0] + contacts[1]) * 0.5;
        Some(self.written(between + Vector3::new(0.0, lateral, height)))
    }
}

fn drawn(
    axle: &Axle,
    solver: &mut AxleSolver<2>,
    placed: &AxlePose,
    ground: f64,
) -> Result<Drawn, NoPose> {
    let read = solver.read(placed)?;
    if let Some(failure) = read.toggle_failure(placed) {
        return Err(failure);
    }
    let state = read.state;
    let has_ground = axle.setup.wheel_radius.is_some();
    let (sine, cosine) = placed.roll.sin_cos();
    let wheels = state.wheels();
    let frame = &axle.left.frame;
    let attitude = Attitude {
        frame,
        sine,
        cosine,
        lifted: if has_ground {
            ground - 0.5 * (wheels[0].height() + wheels[1].height())
        } else {
            0.0
        },
    };
    let [left, right] = Side::ALL.each(|side| solver.drawn_configuration(side, placed));
    let points = attitude.points([&left, &right]);
    let wheels = Side::ALL.map(|side| attitude.wheel(side, &state, has_ground));
    let roll_centre = if has_ground {
        attitude.roll_centre(&state)
    } else {
        None
    };
    let flat = |[x, y]: [f64; 2]| {
        let [x, y, _] = frame.vector(Vector3::new(x, y, 0.0)).to_array();
        [x + 0.0, y + 0.0]
    };
    let turn = turn(&state).map(|turn| Turn {
        wheels: turn.wheels.each(|ends| ends.each(flat)),
        meets: turn.meets.map(|meets| meets.each(flat)),
        centre: turn.centre.map(flat),
        other_axle: flat([turn.other_axle, 0.0])[0],
    });
    Ok(Drawn::of_axle(points, wheels, roll_centre, turn))
}
