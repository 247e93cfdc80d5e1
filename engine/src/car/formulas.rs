//! Formulas of results. j and J are the jacking coefficients along the ground and across the wheel.

use super::catalogue::WheelPlace;
use super::equations::{
    BODY, Balance, GROUND, LONGITUDINAL, PITCH, PITCH_MOMENT, ROLL, SIDE_FORCES, TRAVELS, VERTICAL,
    WheelState,
};
use super::rates::Solved;
use crate::number::{Each, Jet, Scalar, Vector3};
use std::f64::consts::PI;

/// Formulas for one wheel in a state.
pub(super) mod wheel {
    use super::*;

    fn of<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> &WheelState<T> {
        &state.wheels[place.0]
    }

    pub(in super::super) fn travel<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
        state.unknowns[TRAVELS + place.0]
    }

    pub(in super::super) fn load<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
        of(state, place).load
    }

    pub(in super::super) fn elastic<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
        of(state, place).parts[0]
    }

    pub(in super::super) fn geometric<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
        of(state, place).parts[1]
    }

    pub(in super::super) fn longitudinal<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
        of(state, place).parts[2]
    }

    pub(in super::super) fn unsprung<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
        of(state, place).parts[3]
    }

    pub(in super::super) fn side_force<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
        of(state, place).side_force
    }

    pub(in super::super) fn longitudinal_force<T: Scalar>(
        state: &Balance<T>,
        place: WheelPlace,
    ) -> T {
        of(state, place).longitudinal_force
    }

    pub(in super::super) fn share<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
        of(state, place).share
    }

    pub(in super::super) fn friction_demand<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
        let wheel = of(state, place);
        let squared = wheel.side_force.squared() + wheel.longitudinal_force.squared();
        // The square root has no finite slope at zero.
        match squared.value() == 0.0 {
            true => squared,
            false => squared.sqrt() / wheel.load,
        }
    }

    pub(in super::super) fn gap<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
        let gap = of(state, place).gap;
        match state.lifted[place.0] {
            true => gap,
            false => gap.zero(),
        }
    }

    pub(in super::super) fn loaded_radius<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
        of(state, place).radius
    }

    pub(in super::super) fn camber<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
        -of(state, place).corner.spin.z.asin()
    }

    pub(in super::super) fn camber_to_road<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
        -state.road.up.dot(of(state, place).corner.spin).asin()
    }

    pub(in super::super) fn steer<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
        let corner = &of(state, place).corner;
        let sign = corner.sign;
        -corner.spin.x.scaled(sign).atan2(corner.spin.y.scaled(sign))
    }

    pub(in super::super) fn toe<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
        steer(state, place).scaled(-of(state, place).corner.sign)
    }

    pub(in super::super) fn steer_to_road<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
        let corner = &of(state, place).corner;
        let along = |direction: Vector3<T>| corner.spin.dot(direction).scaled(corner.sign);
        -along(state.road.forward).atan2(along(state.road.left))
    }

    pub(in super::super) fn contact_x<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
        of(state, place).contact.x
    }

    pub(in super::super) fn contact_y<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
        of(state, place).contact.y
    }

    pub(in super::super) fn contact_z<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
        of(state, place).contact.z
    }

    pub(in super::super) fn spring_force<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
        of(state, place).spring_force
    }

    pub(in super::super) fn spring_length<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
        of(state, place).corner.spring
    }

    pub(in super::super) fn spring_travel<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
        let corner = &of(state, place).corner;
        corner.design_spring - corner.spring
    }

    /// Compression of the bump stop, 0 without contact.
    pub(in super::super) fn bump_stop_compression<T: Scalar>(
        state: &Balance<T>,
        place: WheelPlace,
    ) -> T {
        let stop = of(state, place).stop_gaps[0];
        beyond(spring_travel(state, place), stop)
    }

    /// Extension of the spring beyond the gap of the rebound stop, 0 without contact.
    pub(in super::super) fn rebound_stop_extension<T: Scalar>(
        state: &Balance<T>,
        place: WheelPlace,
    ) -> T {
        let stop = of(state, place).stop_gaps[1];
        beyond(-spring_travel(state, place), stop)
    }

    /// Returns the excess of a number over a limit; NaN without a limit.
    fn beyond<T: Scalar>(number: T, end: Option<f64>) -> T {
        match end {
            None => number.constant(f64::NAN),
            Some(end) if number.value() > end => number - number.constant(end),
            Some(_) => number.zero(),
        }
    }

    /// Load gained per unit of side force, which acts inboard along the ground.
    pub(in super::super) fn jacking<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
        let wheel = of(state, place);
        let rate = wheel.contact_rate;
        rate.dot(state.road.left).scaled(wheel.corner.sign) / rate.dot(state.road.up)
    }

    /// Load gained per unit of side force, which acts inboard across the wheel.
    pub(in super::super) fn side_force_jacking<T: Scalar>(
        state: &Balance<T>,
        place: WheelPlace,
    ) -> T {
        let wheel = of(state, place);
        let rate = wheel.contact_rate;
        rate.dot(wheel.across).scaled(wheel.corner.sign) / rate.dot(state.road.up)
    }

    pub(in super::super) fn camber_gradient<T: Scalar>(
        solved: &Solved<'_, T>,
        place: WheelPlace,
    ) -> T {
        camber_to_road(&solved.by_ay, place)[1]
    }
}

/// Formulas for one axle; 0 is the front axle.
pub(super) mod axle {
    use super::*;

    fn both<T: Scalar>(
        state: &Balance<T>,
        axle: usize,
        of: impl Fn(&Balance<T>, WheelPlace) -> T,
    ) -> [T; 2] {
        [0, 1].each(|side| of(state, WheelPlace(2 * axle + side)))
    }

    /// Half of the right wheel's part less the left wheel's.
    fn transfer<T: Scalar>(
        state: &Balance<T>,
        axle: usize,
        of: impl Fn(&Balance<T>, WheelPlace) -> T,
    ) -> T {
        let [left, right] = both(state, axle, of);
        (right - left).scaled(0.5)
    }

    pub(in super::super) fn load_transfer<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
        transfer(state, axle, wheel::load)
    }

    pub(in super::super) fn elastic<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
        transfer(state, axle, wheel::elastic)
    }

    pub(in super::super) fn geometric<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
        transfer(state, axle, wheel::geometric)
    }

    pub(in super::super) fn longitudinal<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
        transfer(state, axle, wheel::longitudinal)
    }

    pub(in super::super) fn unsprung<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
        transfer(state, axle, wheel::unsprung)
    }

    pub(in super::super) fn load<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
        let [left, right] = both(state, axle, wheel::load);
        left + right
    }

    pub(in super::super) fn side_force<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
        state.unknowns[SIDE_FORCES + axle]
    }

    pub(in super::super) fn track<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
        let [left, right] = [0, 1].each(|side| state.wheels[2 * axle + side].contact);
        state.road.left.dot(left - right)
    }

    pub(in super::super) fn mean_steer<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
        let [left, right] = both(state, axle, wheel::steer);
        (left + right).scaled(0.5)
    }

    /// Velocities of the carriers' points at both contact points of a solid axle, and the angular velocity of the axle. Here
    /// the left wheel rises and the right wheel falls.
    fn by_difference<T: Scalar>(
        state: &Balance<T>,
        axle: usize,
    ) -> Option<([Vector3<T>; 2], Vector3<T>)> {
        let [left, right] = [0, 1].map(|side| &state.wheels[2 * axle + side]);
        let turn = left.corner.own.turn - left.corner.other?.turn;
        let velocities = [
            left.contact_rate - left.contact_by_other?,
            right.contact_by_other? - right.contact_rate,
        ];
        Some((velocities, turn))
    }

    /// Loads of both wheels of an axle that balance given forces at the contact points.
    fn loads_by<T: Scalar>(state: &Balance<T>, axle: usize, forces: [Vector3<T>; 2]) -> [T; 2] {
        let up = state.road.up;
        let [left, right] = [0, 1].map(|side| &state.wheels[2 * axle + side]);
        let [left_force, right_force] = forces;
        let by_left = left_force.dot(left.contact_rate);
        let by_right = right_force.dot(right.contact_rate);
        let (a, d) = (up.dot(left.contact_rate), up.dot(right.contact_rate));
        match (left.contact_by_other, right.contact_by_other) {
            (Some(left_other), Some(right_other)) => {
                let by_left = by_left + right_force.dot(right_other);
                let by_right = by_right + left_force.dot(left_other);
                let (b, c) = (up.dot(right_other), up.dot(left_other));
                let determinant = a * d - b * c;
                [
                    (b * by_right - d * by_left) / determinant,
                    (c * by_left - a * by_right) / determinant,
                ]
            }
            _ => [-(by_left / a), -(by_right / d)],
        }
    }

    /// Height at which a lateral force makes no roll. `forces` are the parts of a unit force at the two contact points.
    fn height_of_transfer<T: Scalar>(
        state: &Balance<T>,
        axle: usize,
        forces: [Vector3<T>; 2],
    ) -> T {
        let [left, right] = loads_by(state, axle, forces);
        track(state, axle).scaled(0.5) * (right - left)
    }

    pub(in super::super) fn roll_centre_height<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
        if let Some(([left, right], turn)) = by_difference(state, axle) {
            let rolling = turn.dot(state.road.forward).scaled(2.0);
            return (left + right).dot(state.road.left) / rolling;
        }
        let [left, right] = both(state, axle, wheel::jacking);
        track(state, axle) * left * right / (left + right)
    }

    pub(in super::super) fn roll_centre_lateral<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
        if let Some(([left, right], turn)) = by_difference(state, axle) {
            let rolling = turn.dot(state.road.forward).scaled(2.0);
            return -((left + right).dot(state.road.up) / rolling);
        }
        let [left, right] = both(state, axle, wheel::jacking);
        track(state, axle).scaled(0.5) * (left - right) / (left + right)
    }

    pub(in super::super) fn force_roll_centre_height<T: Scalar>(
        state: &Balance<T>,
        axle: usize,
    ) -> T {
        height_of_transfer(
            state,
            axle,
            [state.road.left * state.unknowns[0].constant(0.5); 2],
        )
    }

    pub(in super::super) fn roll_axis_height<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
        let across = |side: usize| {
            let wheel = &state.wheels[2 * axle + side];
            wheel.across * wheel.share
        };
        height_of_transfer(state, axle, [across(0), across(1)])
    }

    pub(in super::super) fn bar_torque<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
        state.bars[axle]
    }

    /// Torque of a twist beam. The equations treat the beam as a bar with a quarter of its rate and twice its angle.
    pub(in super::super) fn beam_torque<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
        -state.bars[axle].scaled(2.0)
    }

    pub(in super::super) fn heave_spring_force<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
        state.rockers[axle].heave_spring
    }

    pub(in super::super) fn heave_spring_length<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
        state.rockers[axle].heave_spring_length
    }

    pub(in super::super) fn heave_spring_travel<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
        state.rockers[axle].heave_spring_travel
    }

    pub(in super::super) fn t_bar_torque<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
        state.rockers[axle].t_bar
    }

    pub(in super::super) fn heave_bar_torque<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
        state.rockers[axle].heave_bar
    }

    pub(in super::super) fn downforce<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
        state.air[axle]
    }

    pub(in super::super) fn ride_height<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
        state.ride_heights[axle]
    }

    pub(in super::super) fn roll_steer_gradient<T: Scalar>(
        solved: &Solved<'_, T>,
        axle: usize,
    ) -> T {
        mean_steer(&solved.by_ay, axle)[1]
    }

    pub(in super::super) fn pitch_steer_gradient<T: Scalar>(
        solved: &Solved<'_, T>,
        axle: usize,
    ) -> T {
        mean_steer(&solved.by_ax, axle)[1]
    }

    /// Load gained by both wheels per rise of the ground.
    pub(in super::super) fn ride_rate<T: Scalar>(solved: &Solved<'_, T>, axle: usize) -> T {
        load(&solved.by_heave, axle)[1]
    }

    pub(in super::super) fn ride_frequency<T: Scalar>(solved: &Solved<'_, T>, axle: usize) -> T {
        let state = &solved.now;
        let (mass, _) = state.sprung;
        let share = car::front_share_at_cg(state);
        let own = match axle {
            0 => share,
            _ => share.one() - share,
        };
        let per_metre = solved.car.per_metre();
        frequency(ride_rate(solved, axle).scaled(per_metre) / (mass * own))
    }
}

/// Frequency in hertz, from the square of an angular frequency.
fn frequency<T: Scalar>(squared: T) -> T {
    squared.sqrt().scaled(0.5 / PI)
}

/// Formulas for the car as a whole.
pub(super) mod car {
    use super::*;

    pub(in super::super) fn roll<T: Scalar>(state: &Balance<T>) -> T {
        state.unknowns[ROLL]
    }

    pub(in super::super) fn pitch<T: Scalar>(state: &Balance<T>) -> T {
        state.unknowns[PITCH]
    }

    pub(in super::super) fn heave<T: Scalar>(state: &Balance<T>) -> T {
        state.unknowns[GROUND] - state.road.up.dot(state.design_contact)
    }

    /// Rise of the body relative to the car at rest.
    pub(in super::super) fn jacking_heave<T: Scalar>(solved: &Solved<'_, T>) -> T {
        heave(&solved.now).constant(solved.rest_heave) - heave(&solved.now)
    }

    pub(in super::super) fn energy<T: Scalar>(state: &Balance<T>) -> T {
        state.energy
    }

    /// Load that each wheel gains or loses per warp of the ground. The ground rises under one diagonal pair of wheels and
    /// falls under the other.
    pub(in super::super) fn warp_stiffness<T: Scalar>(solved: &Solved<'_, T>) -> T {
        let [a, b, c, d] = loads(&solved.by_warp).map(|load| load[1]);
        (a - b - c + d).scaled(0.25)
    }

    pub(in super::super) fn rake<T: Scalar>(state: &Balance<T>) -> T {
        state.ride_heights[1] - state.ride_heights[0]
    }

    fn mid_contact<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
        let [left, right] = [0, 1].map(|side| state.wheels[2 * axle + side].contact);
        state.road.forward.dot(left + right).scaled(0.5)
    }

    pub(in super::super) fn wheelbase<T: Scalar>(state: &Balance<T>) -> T {
        mid_contact(state, 0) - mid_contact(state, 1)
    }

    /// Distance of the sprung mass ahead of the rear axle, divided by the wheelbase.
    pub(in super::super) fn front_share_at_cg<T: Scalar>(state: &Balance<T>) -> T {
        (state.road.forward.dot(state.sprung.1) - mid_contact(state, 1)) / wheelbase(state)
    }

    fn height<T: Scalar>(state: &Balance<T>, point: Vector3<T>) -> T {
        state.road.up.dot(point) - state.unknowns[GROUND]
    }

    pub(in super::super) fn cg_height<T: Scalar>(state: &Balance<T>) -> T {
        height(state, state.whole.1)
    }

    pub(in super::super) fn sprung_cg_height<T: Scalar>(state: &Balance<T>) -> T {
        height(state, state.sprung.1)
    }

    type OfAxle<T> = fn(&Balance<T>, usize) -> T;

    fn inclination<T: Scalar>(state: &Balance<T>, of: OfAxle<T>) -> T {
        (of(state, 0) - of(state, 1)).atan2(wheelbase(state))
    }

    fn at_cg<T: Scalar>(state: &Balance<T>, of: OfAxle<T>) -> T {
        let (front, rear) = (of(state, 0), of(state, 1));
        rear + (front - rear) * front_share_at_cg(state)
    }

    pub(in super::super) fn roll_centre_inclination<T: Scalar>(state: &Balance<T>) -> T {
        inclination(state, axle::roll_centre_height)
    }

    pub(in super::super) fn roll_centre_height_at_cg<T: Scalar>(state: &Balance<T>) -> T {
        at_cg(state, axle::roll_centre_height)
    }

    pub(in super::super) fn roll_centre_moment_arm<T: Scalar>(state: &Balance<T>) -> T {
        sprung_cg_height(state) - roll_centre_height_at_cg(state)
    }

    pub(in super::super) fn roll_axis_inclination<T: Scalar>(state: &Balance<T>) -> T {
        inclination(state, axle::roll_axis_height)
    }

    pub(in super::super) fn roll_axis_height_at_cg<T: Scalar>(state: &Balance<T>) -> T {
        at_cg(state, axle::roll_axis_height)
    }

    pub(in super::super) fn roll_axis_moment_arm<T: Scalar>(state: &Balance<T>) -> T {
        sprung_cg_height(state) - roll_axis_height_at_cg(state)
    }

    pub(in super::super) fn longitudinal_force<T: Scalar>(state: &Balance<T>) -> T {
        state.unknowns[LONGITUDINAL]
    }

    pub(in super::super) fn load_transfer<T: Scalar>(state: &Balance<T>) -> T {
        axle::load_transfer(state, 0) + axle::load_transfer(state, 1)
    }

    fn share_of_transfer<T: Scalar>(state: &Balance<T>, of: OfAxle<T>) -> T {
        of(state, 0).scaled(100.0) / load_transfer(state)
    }

    pub(in super::super) fn distribution<T: Scalar>(state: &Balance<T>) -> T {
        share_of_transfer(state, axle::load_transfer)
    }

    pub(in super::super) fn distribution_elastic<T: Scalar>(state: &Balance<T>) -> T {
        share_of_transfer(state, axle::elastic)
    }

    pub(in super::super) fn distribution_geometric<T: Scalar>(state: &Balance<T>) -> T {
        share_of_transfer(state, axle::geometric)
    }

    pub(in super::super) fn distribution_longitudinal<T: Scalar>(state: &Balance<T>) -> T {
        share_of_transfer(state, axle::longitudinal)
    }

    pub(in super::super) fn distribution_unsprung<T: Scalar>(state: &Balance<T>) -> T {
        share_of_transfer(state, axle::unsprung)
    }

    fn loads<T: Scalar>(state: &Balance<T>) -> [T; 4] {
        state.wheels.map(|wheel| wheel.load)
    }

    pub(in super::super) fn cross_weight<T: Scalar>(state: &Balance<T>) -> T {
        let [a, b, c, d] = loads(state);
        (b + c).scaled(100.0) / (a + b + c + d)
    }

    pub(in super::super) fn weight_front<T: Scalar>(state: &Balance<T>) -> T {
        let [a, b, c, d] = loads(state);
        (a + b).scaled(100.0) / (a + b + c + d)
    }

    pub(in super::super) fn weight_left<T: Scalar>(state: &Balance<T>) -> T {
        let [a, b, c, d] = loads(state);
        (a + c).scaled(100.0) / (a + b + c + d)
    }

    pub(in super::super) fn downforce<T: Scalar>(state: &Balance<T>) -> T {
        state.air[0] + state.air[1]
    }

    pub(in super::super) fn aero_balance<T: Scalar>(state: &Balance<T>) -> T {
        state.air[0].scaled(100.0) / downforce(state)
    }

    pub(in super::super) fn drag<T: Scalar>(state: &Balance<T>) -> T {
        state.air[2]
    }

    /// Longitudinal parts of an axle's loads, in percent of the load that the tyres' longitudinal forces transfer.
    pub(in super::super) fn anti<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
        let push = |wheel: &WheelState<T>| {
            let force = wheel.across * wheel.side_force + wheel.heading * wheel.longitudinal_force;
            force.dot(state.road.forward)
        };
        let [a, b, c, d] = state.wheels.each_ref().map(push);
        let transfer = -(a + b + c + d) * cg_height(state) / wheelbase(state);
        let parts = [0, 1].map(|side| state.wheels[2 * axle + side].parts[2]);
        let own = (parts[0] + parts[1]).scaled(match axle {
            0 => 100.0,
            _ => -100.0,
        });
        own / transfer
    }

    pub(in super::super) fn anti_front<T: Scalar>(state: &Balance<T>) -> T {
        anti(state, 0)
    }

    pub(in super::super) fn anti_rear<T: Scalar>(state: &Balance<T>) -> T {
        anti(state, 1)
    }

    pub(in super::super) fn roll_gradient<T: Scalar>(solved: &Solved<'_, T>) -> T {
        roll(&solved.by_ay)[1]
    }

    pub(in super::super) fn pitch_gradient<T: Scalar>(solved: &Solved<'_, T>) -> T {
        pitch(&solved.by_ax)[1]
    }

    pub(in super::super) fn local_distribution<T: Scalar>(solved: &Solved<'_, T>) -> T {
        let [front, rear] = [0, 1].map(|end| axle::load_transfer(&solved.by_ay, end)[1]);
        front.scaled(100.0) / (front + rear)
    }

    pub(in super::super) fn roll_understeer<T: Scalar>(solved: &Solved<'_, T>) -> T {
        axle::roll_steer_gradient(solved, 1) - axle::roll_steer_gradient(solved, 0)
    }

    pub(in super::super) fn roll_stiffness<T: Scalar>(solved: &Solved<'_, T>) -> T {
        let by_couple = roll(&solved.by_couple)[1];
        by_couple.one() / by_couple
    }

    pub(in super::super) fn roll_stiffness_distribution<T: Scalar>(solved: &Solved<'_, T>) -> T {
        let state = &solved.by_couple;
        let [front, rear] =
            [0, 1].map(|end| (axle::track(state, end) * axle::load_transfer(state, end))[1]);
        front.scaled(100.0) / (front + rear)
    }

    pub(in super::super) fn heave_rate<T: Scalar>(solved: &Solved<'_, T>) -> T {
        solved.by_heave.residuals[VERTICAL][1]
    }

    pub(in super::super) fn heave_frequency<T: Scalar>(solved: &Solved<'_, T>) -> T {
        let per_metre = solved.car.per_metre();
        frequency(heave_rate(solved).scaled(per_metre) / solved.now.sprung.0)
    }

    /// Squared angular frequencies of the sprung mass in heave and pitch on massless wheels. They are the roots w of det(K -
    /// w M) = 0, with M for the height of G and the pitch angle.
    fn body_frequency<T: Scalar>(solved: &Solved<'_, T>, sign: f64) -> T {
        // The residuals are the vertical force and the moment about -e at the mean contact point of the design position.
        // They depend on gamma and theta.
        let height = solved.now.road.up.dot(solved.now.design_contact);
        let along = |state: &Balance<Jet<T, 2>>| {
            let [forward, up, pitch] =
                [BODY, VERTICAL, PITCH_MOMENT].map(|row| state.residuals[row][1]);
            [up, height * forward - pitch]
        };
        let [by_heave, by_pitch] = [along(&solved.by_heave), along(&solved.by_pitch)];
        let k = [[by_heave[0], by_pitch[0]], [by_heave[1], by_pitch[1]]];
        let per_metre = solved.car.per_metre();
        let (mass, cg) = solved.now.sprung;
        let lever = solved.now.road.forward.dot(cg);
        let inertia = solved.car.pitch_inertia.unwrap_or(f64::NAN) * per_metre * per_metre;
        let m = [
            [mass, mass * lever],
            [
                mass * lever,
                mass * lever.squared() + mass.constant(inertia),
            ],
        ];
        let product = mass.scaled(inertia);
        let middle = k[0][0] * m[1][1] + k[1][1] * m[0][0] - (k[0][1] + k[1][0]) * m[0][1];
        let determinant = k[0][0] * k[1][1] - k[0][1] * k[1][0];
        let root = (middle.squared() - (product * determinant).scaled(4.0)).sqrt();
        let squared = (middle + root.scaled(sign)) / product.scaled(2.0);
        frequency(squared.scaled(per_metre))
    }

    pub(in super::super) fn low_frequency<T: Scalar>(solved: &Solved<'_, T>) -> T {
        body_frequency(solved, -1.0)
    }

    pub(in super::super) fn high_frequency<T: Scalar>(solved: &Solved<'_, T>) -> T {
        body_frequency(solved, 1.0)
    }
}
