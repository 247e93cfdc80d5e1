//! Catalogue of axle quantities: name, unit, sign, formula, source and function of each quantity.
//!
//! Each wheel also has every wheel characteristic of [`crate::characteristics`], except `roll_centre_height`. The
//! axle's quantity of this name replaces the wheel's quantity.

use super::AxleKind;
use super::elastic::TestFigure;
use super::formulas::{loads, rigid, roll, steering};
use super::reading::WheelParts;
use super::state::AxleState;
use crate::ask::{Info, Need, NoValue, Unit};
use crate::characteristics::{Characteristic, Slot};
use crate::model::Side;
use crate::number::{Each, Scalar, SimdReal, call_outlined};

const ANGLE: Unit = Unit::Angle;
const LENGTH: Unit = Unit::Length;
const PERCENT: Unit = Unit::Percent;
const RATIO: Unit = Unit::Ratio;

const ISO: &str = "ISO 8855";
const VELOCITIES: &str = "velocities of the contact points; agrees with the statics of the links";
const LINK_LOADS: &str =
    "virtual work along both travels of the axle; agrees with the statics of the links";
const VIRTUAL_WORK: &str = "virtual work of springs and anti-roll bar; parts have no weight";

/// Defines the catalogue. Each line contains, in this order:
///
/// - variant, name, unit, meaning of a positive value, formula, source, and required inputs of the study
/// - the slots (values of each wheel) that the quantity uses in addition to position and carrier
/// - the order of the derivatives that the quantity uses
/// - true if the quantity uses derivatives with respect to the rack (axle only)
/// - `lanes` if sweeps compute the quantity in SIMD lanes, else `one_by_one`
/// - the function that computes the quantity
/// - the reason for a missing value (axle only)
///
/// Functions for SIMD lanes are generic over [`Real`](crate::number::Real) and inlined throughout.
macro_rules! catalogue {
    (@is_for lanes) => { true };
    (@is_for one_by_one) => { false };
    (@value lanes, $function:expr, $state:ident $(, $side:ident)?) => { $function($state $(, $side)?) };
    (@value one_by_one, $function:expr, $state:ident $(, $side:ident)?) => { $state.like().constant(f64::NAN) };
    (wheel { $($wheel:ident, $wname:literal, $wunit:expr, $wpositive:literal, $wformula:literal,
        $wsource:expr, [$($wneed:ident),*], [$($wreads:ident),*], $worder:literal, $wlanes:ident, $wfunction:expr;)* }
     axle { $($axle:ident, $name:literal, $unit:expr, $positive:literal, $formula:literal,
        $source:expr, [$($need:ident),*], [$($reads:ident),*], $order:literal, $rack:literal, $lanes:ident, $function:expr, $void:expr;)* }
    ) => {
        /// A quantity of each wheel, in addition to the wheel characteristics.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum WheelQuantity {
            $(#[doc = concat!("`", $wname, "`: `", $wformula, "`")] $wheel,)*
        }

        /// A quantity of the axle as a whole.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum AxleQuantity {
            $(#[doc = concat!("`", $name, "`: `", $formula, "`")] $axle,)*
        }

        impl WheelQuantity {
            /// All quantities of a wheel, in the order of the catalogue.
            pub const ALL: &'static [WheelQuantity] = &[$(WheelQuantity::$wheel),*];

            /// Catalogue entry of the quantity: name, unit, sign, formula, source and required inputs.
            pub fn info(self) -> &'static Info {
                match self {
                    $(WheelQuantity::$wheel => &Info {
                        name: $wname, unit: $wunit, positive: $wpositive, formula: $wformula,
                        source: $wsource, reads: &[$(Slot::$wreads),*], needs: &[$(Need::$wneed),*], rate_order: $worder,
                        by_rack: false,
                    },)*
                }
            }

            /// Returns the value of the quantity at one wheel. The compiler makes a separate function of each formula.
            pub fn evaluate<T: Scalar, W: WheelParts<T>>(self, state: &AxleState<T, W>, side: Side) -> T {
                match self {
                    $(WheelQuantity::$wheel => call_outlined((state, side), |(state, side)| $wfunction(state, side)),)*
                }
            }

            /// Returns true if sweeps compute the quantity in SIMD lanes.
            pub fn is_for_lanes(self) -> bool {
                match self {
                    $(WheelQuantity::$wheel => catalogue!(@is_for $wlanes),)*
                }
            }

            /// Returns the values of the quantity at one wheel, in SIMD lanes. They are NaN if the quantity is not
            /// available in lanes.
            #[inline(always)]
            pub fn evaluate_in_lanes<B: SimdReal, W: WheelParts<B>>(self, state: &AxleState<B, W>, side: Side) -> B {
                match self {
                    $(WheelQuantity::$wheel => catalogue!(@value $wlanes, $wfunction, state, side),)*
                }
            }
        }

        impl AxleQuantity {
            /// All quantities of an axle, in the order of the catalogue.
            pub const ALL: &'static [AxleQuantity] = &[$(AxleQuantity::$axle),*];

            /// Catalogue entry of the quantity: name, unit, sign, formula, source and required inputs.
            pub fn info(self) -> &'static Info {
                match self {
                    $(AxleQuantity::$axle => &Info {
                        name: $name, unit: $unit, positive: $positive, formula: $formula,
                        source: $source, reads: &[$(Slot::$reads),*], needs: &[$(Need::$need),*], rate_order: $order,
                        by_rack: $rack,
                    },)*
                }
            }

            /// Returns the value of the quantity for the axle. The compiler makes a separate function of each formula.
            pub fn evaluate<T: Scalar, W: WheelParts<T>>(self, state: &AxleState<T, W>) -> T {
                match self {
                    $(AxleQuantity::$axle => call_outlined(state, $function),)*
                }
            }

            /// Returns true if sweeps compute the quantity in SIMD lanes.
            pub fn is_for_lanes(self) -> bool {
                match self {
                    $(AxleQuantity::$axle => catalogue!(@is_for $lanes),)*
                }
            }

            /// Returns the values of the quantity in SIMD lanes. They are NaN if the quantity is not available in lanes.
            #[inline(always)]
            pub fn evaluate_in_lanes<B: SimdReal, W: WheelParts<B>>(self, state: &AxleState<B, W>) -> B {
                match self {
                    $(AxleQuantity::$axle => catalogue!(@value $lanes, $function, state),)*
                }
            }

            /// Returns the reason for a missing value, if the quantity has no value in some poses.
            pub(super) fn possible_void(self) -> Option<NoValue> {
                match self {
                    $(AxleQuantity::$axle => $void,)*
                }
            }
        }
    };
}

catalogue! {
    wheel {
        Steer, "steer", ANGLE, "steered to the left, at both wheels", "-toe at the left, +toe at the right wheel", ISO, [], [], 0, lanes, steering::steer;
        CamberToRoad, "camber_to_road", ANGLE, "top of the wheel outboard", "-asin(a.n)", ISO, [], [], 0, lanes, roll::camber_to_road;
        JackingCoefficient, "jacking_coefficient", RATIO, "a side force inboard lifts the body", "(C'.o)/(C'.n), where o points outboard along the ground", VELOCITIES, [WheelRadius], [], 1, lanes, roll::jacking_coefficient;
        SideForceJacking, "side_force_jacking", RATIO, "a side force inboard lifts the body", "(C'.o)/(C'.n), where o points across the wheel, in the ground plane", VELOCITIES, [WheelRadius], [], 1, lanes, roll::side_force_jacking;
        RollCamber, "roll_camber", Unit::AnglePerAngle, "camber grows with the roll angle", "d camber/d phi, mean travel and rack held", "derivative along roll on a plane ground", [WheelRadius], [], 1, lanes, roll::roll_camber;
        RollCamberToRoad, "roll_camber_to_road", Unit::AnglePerAngle, "camber to the road grows with the roll angle", "d camber_to_road/d phi, mean travel and rack held", "derivative along roll on a plane ground", [WheelRadius], [], 1, lanes, roll::roll_camber_to_road;
        WheelLoad, "wheel_load", Unit::Force, "pressed to the ground; below 0 the wheel would lift", "U_z/(n.C'), where U is the energy of springs and bars", VIRTUAL_WORK, [WheelRadius, Springs], [SpringLength, BarAngle, RockerAngle, HeaveSpring], 1, one_by_one, loads::wheel_load;
        WheelRate, "wheel_rate", Unit::ForcePerLength, "the load grows as the wheel's pad rises", "change of the wheel load per change of the height of the wheel's pad, with the pad level; springs only, without anti-roll bar and tyre; body, rack and the other pad held", VIRTUAL_WORK, [WheelRadius, SpringForce], [SpringLength], 2, one_by_one, loads::wheel_rate;
        SpringForce, "spring_force", Unit::Force, "compressed", "force of the spring, bump stop included", "the spring's law", [SpringForce], [SpringLength], 0, one_by_one, loads::spring_force;
        WheelRollSteer, "roll_steer", Unit::AnglePerAngle, "steers to the left when rolled as in a left turn", "d steer/d phi, mean travel and rack held", "derivative along roll on a plane ground; in other tools, left jounce is positive roll", [WheelRadius], [], 1, lanes, steering::roll_steer;
    }
    axle {
        Track, "track", LENGTH, "always", "e.(C_l - C_r), contact points", ISO, [WheelRadius], [], 0, false, lanes, roll::track, None;
        TrackChange, "track_change", LENGTH, "wider than in the design position", "track - track(design)", ISO, [WheelRadius], [], 0, false, lanes, roll::track_change, None;
        RollAngle, "roll_angle", ANGLE, "right wheel in jounce, as in a left turn", "phi, the roll of the body relative to the ground", ISO, [WheelRadius], [], 0, false, lanes, roll::roll_angle, None;
        RollCentreHeight, "roll_centre_height", LENGTH, "above the ground", "track j_l j_r/(j_l + j_r), where j is the jacking coefficient; on pads of different heights, above the mean height of the pads", VELOCITIES, [WheelRadius], [], 1, false, lanes, roll::roll_centre_height, Some(NoValue::ParallelNormals);
        RollCentreLateral, "roll_centre_lateral", LENGTH, "to the left of the midpoint between the contact points", "track (j_l - j_r)/(2 (j_l + j_r))", VELOCITIES, [WheelRadius], [], 1, false, lanes, roll::roll_centre_lateral, Some(NoValue::ParallelNormals);
        ForceRollCentreHeight, "force_roll_centre_height", LENGTH, "above the ground", "track (j_l + j_r)/4: equal side forces", "SAE J670, the point at which a side force causes no roll", [WheelRadius], [], 1, false, lanes, roll::force_roll_centre_height, None;
        RollCentreMigrationVertical, "roll_centre_migration_vertical", Unit::LengthPerAngle, "rises with the roll angle", "d roll_centre_height/d phi, mean travel and rack held", VELOCITIES, [WheelRadius], [], 2, false, one_by_one, roll::roll_centre_migration_vertical, Some(NoValue::ParallelNormals);
        RollCentreMigrationLateral, "roll_centre_migration_lateral", Unit::LengthPerAngle, "moves to the left with the roll angle", "d roll_centre_lateral/d phi, mean travel and rack held", VELOCITIES, [WheelRadius], [], 2, false, one_by_one, roll::roll_centre_migration_lateral, Some(NoValue::ParallelNormals);
        ForceRollCentreMigration, "force_roll_centre_migration", Unit::LengthPerAngle, "rises with the roll angle", "d force_roll_centre_height/d phi, mean travel and rack held", VELOCITIES, [WheelRadius], [], 2, false, one_by_one, roll::force_roll_centre_migration, None;
        JackingForceRatio, "jacking_force_ratio", RATIO, "lifts in a left turn", "(j_r - j_l)/2: equal side forces", VELOCITIES, [WheelRadius], [], 1, false, lanes, roll::jacking_force_ratio, None;
        MeanSteer, "mean_steer", ANGLE, "to the left", "(steer_l + steer_r)/2", ISO, [], [], 0, false, lanes, steering::mean_steer, None;
        TotalToe, "total_toe", ANGLE, "toe-in (the wheels are closer in front)", "toe_l + toe_r", ISO, [], [], 0, false, lanes, steering::total_toe, None;
        TotalToeAtRim, "total_toe_at_rim", LENGTH, "toe-in (the rims are closer in front)", "D (sin toe_l + sin toe_r), where D is rim_diameter: distance between the rims at the rear edges minus distance at the front edges", "toe as a length on alignment racks", [RimDiameter], [], 0, false, lanes, steering::total_toe_at_rim, None;
        AckermannError, "ackermann_error", ANGLE, "the outer wheel steers more than the ideal one", "o - ideal; seen from above, the ideal outer spin axis meets the other axle's line at the same point as the inner spin axis", ISO, [Wheelbase], [], 0, false, lanes, steering::ackermann_error, None;
        Ackermann, "ackermann", PERCENT, "the inner wheel steers more than the outer one", "100 (i - o)/(i - ideal)", ISO, [Wheelbase], [], 0, false, lanes, steering::ackermann, Some(NoValue::StraightAhead);
        AckermannByInner, "ackermann_by_inner", PERCENT, "the inner wheel steers more than the outer one", "100 (i - o)/(ideal_inner - o), ideal_inner = atan2(L sin o, L cos o - T sin o), where T is the track of the wheel centres in the design position", "Simscape Vehicle Templates, sm_car_knc_calc_susp_metrics", [Wheelbase], [], 0, false, lanes, steering::ackermann_by_inner, Some(NoValue::StraightAhead);
        AckermannByCotangents, "ackermann_by_cotangents", PERCENT, "the inner wheel steers more than the outer one", "100 L (cot o - cot i)/T, where T is the track of the wheel centres in the design position", "geometry of the turn", [Wheelbase], [], 0, false, lanes, steering::ackermann_by_cotangents, Some(NoValue::StraightAhead);
        TurningCircle, "turning_circle", LENGTH, "always", "twice the distance from C_o to Z, seen from above, where Z is the midpoint between the points at which the spin axes meet the other axle's line", ISO, [WheelRadius, Wheelbase], [], 0, false, lanes, steering::turning_circle, Some(NoValue::StraightAhead);
        SteeringRatio, "steering_ratio", RATIO, "steering wheel and wheels turn in the same direction", "2 pi/(c d mean_steer/d rack), at the present position; on a plane ground, roll angle and mean travel held; on pads, both travels held", "derivative of the steering-wheel angle with respect to mean steer", [WheelRadius, CFactor], [], 1, true, lanes, steering::steering_ratio, None;
        RollSteer, "roll_steer", Unit::AnglePerAngle, "steers to the left when rolled as in a left turn", "d mean_steer/d phi, mean travel and rack held", "derivative along roll on a plane ground; in other tools, left jounce is positive roll", [WheelRadius], [], 1, false, lanes, steering::axle_roll_steer, None;
        BarTorque, "anti_roll_bar_torque", Unit::Torque, "the left lever is pushed further", "k_b (b_l - b_r)", VIRTUAL_WORK, [BarRate], [BarAngle], 0, false, one_by_one, loads::bar_torque, None;
        HeaveSpringForce, "heave_spring_force", Unit::Force, "compressed", "force + rate (l0 - l), where l is the distance between the points heave_spring of both rockers", "the spring's law", [HeaveSpring], [HeaveSpring], 0, false, one_by_one, loads::heave_spring_force, None;
        HeaveSpringLength, "heave_spring_length", LENGTH, "always", "l, the distance between the points heave_spring of both rockers", "the distance of two points", [HeaveSpring], [HeaveSpring], 0, false, one_by_one, loads::heave_spring_length, None;
        HeaveSpringMotionRatio, "heave_spring_motion_ratio", RATIO, "the heave spring shortens in heave", "-d l/d heave, equal travels on level pads", "installation ratio of the heave spring", [HeaveSpring], [HeaveSpring], 1, false, one_by_one, loads::heave_spring_motion_ratio, None;
        TBarTorque, "t_bar_torque", Unit::Torque, "the left rocker has turned further than the right", "k (rho_l - rho_r), where rho is rocker_angle", VIRTUAL_WORK, [TBar], [RockerAngle], 0, false, one_by_one, loads::t_bar_torque, None;
        HeaveBarTorque, "heave_bar_torque", Unit::Torque, "in the direction in which jounce turns it", "torque + k (rho_l + rho_r), where rho is rocker_angle", VIRTUAL_WORK, [HeaveBar], [RockerAngle], 0, false, one_by_one, loads::heave_bar_torque, None;
        RollMoment, "roll_moment", Unit::Torque, "resists a positive roll angle", "track (F_r - F_l)/2", VIRTUAL_WORK, [WheelRadius, Springs], [SpringLength, BarAngle, RockerAngle, HeaveSpring], 1, false, one_by_one, loads::roll_moment, None;
        RollStiffness, "roll_stiffness", Unit::TorquePerAngle, "always", "d roll_moment/d phi on a rig; body level, rack held, equal and opposite travels on level pads; phi is the angle of the line through both contact points", "K&C rigs", [WheelRadius, Springs], [SpringLength, BarAngle, RockerAngle, HeaveSpring], 2, false, one_by_one, loads::roll_stiffness, None;
        RollStiffnessWithTyres, "roll_stiffness_with_tyres", Unit::TorquePerAngle, "always", "1/(1/roll_stiffness + 2/(c track^2)), where c is the rate of one tyre; roll_stiffness in series with both tyres", "K&C rigs", [WheelRadius, Springs, TyreRate], [SpringLength, BarAngle, RockerAngle, HeaveSpring], 2, false, one_by_one, loads::roll_stiffness_with_tyres, None;
        RollStiffnessOnRoad, "roll_stiffness_on_road", Unit::TorquePerAngle, "always", "d roll_moment/d phi on a plane ground, mean travel and rack held", VIRTUAL_WORK, [WheelRadius, Springs], [SpringLength, BarAngle, RockerAngle, HeaveSpring], 2, false, one_by_one, loads::roll_stiffness_on_road, None;
        RollStiffnessAtLoad, "roll_stiffness_at_load", Unit::TorquePerAngle, "always", "d roll_moment/d phi on a plane ground, the sum of the wheel loads and the rack held", VIRTUAL_WORK, [WheelRadius, Springs], [SpringLength, BarAngle, RockerAngle, HeaveSpring], 2, false, one_by_one, loads::roll_stiffness_at_load, None;
        RideRate, "ride_rate", Unit::ForcePerLength, "always", "half of d(F_l + F_r)/d heave, per wheel, in series with the tyre if [tyre] gives its rate; rack held; on a plane ground, roll angle held; on pads, equal travels", VIRTUAL_WORK, [WheelRadius, Springs], [SpringLength, BarAngle, RockerAngle, HeaveSpring], 2, false, one_by_one, loads::ride_rate, None;
        RideRateWithoutTyres, "ride_rate_without_tyres", Unit::ForcePerLength, "always", "half of d(F_l + F_r)/d heave, per wheel, of the springs alone; rack held; on a plane ground, roll angle held; on pads, equal travels", VIRTUAL_WORK, [WheelRadius, Springs], [SpringLength, BarAngle, RockerAngle, HeaveSpring], 2, false, one_by_one, loads::ride_rate_without_tyres, None;
        RideFrequency, "ride_frequency", Unit::Frequency, "always", "sqrt(2 ride_rate/sprung mass)/(2 pi)", "natural frequency of the sprung mass in heave", [WheelRadius, Springs, SprungMass], [SpringLength, BarAngle, RockerAngle, HeaveSpring], 2, false, one_by_one, loads::ride_frequency, None;
        AxleSteer, "axle_steer", ANGLE, "to the left", "atan2(-a_x, a_y), where a is the direction of the line of a solid axle", "kinematics of a solid axle", [], [], 0, false, lanes, rigid::axle_steer, None;
        AxleLateral, "axle_lateral", LENGTH, "to the left", "y of the middle of both wheel centres, from the design position of a solid axle", "kinematics of a solid axle", [], [], 0, false, lanes, rigid::axle_lateral, None;
        AxleLongitudinal, "axle_longitudinal", LENGTH, "forward", "x of the middle of both wheel centres, from the design position of a solid axle", "kinematics of a solid axle", [], [], 0, false, lanes, rigid::axle_longitudinal, None;
        PinionAngle, "pinion_angle", ANGLE, "nose up", "atan2(R_zx, R_xx), where R is the rotation of a solid axle from the design position", "kinematics of a solid axle", [], [], 0, false, lanes, rigid::pinion_angle, None;
        RigidAntiSquat, "anti_squat", PERCENT, "the rear resists squatting under drive", "of a solid axle: 100 d (L/h)(f_l + f_r), where f are the loads that balance a unit drive force, half at each wheel", LINK_LOADS, [WheelRadius, Wheelbase, CgHeight, RearDrive], [], 1, false, lanes, rigid::anti_squat, None;
        RigidAntiLift, "anti_lift", PERCENT, "the rear resists lifting in braking, or a driven front axle resists lifting under drive", "of a solid axle: 100 p (L/h)(f_l + f_r) at the rear, -100 d (L/h)(f_l + f_r) in front", LINK_LOADS, [WheelRadius, Wheelbase, CgHeight, RearBrakingOrFrontDrive], [], 1, false, lanes, rigid::anti_lift, None;
        RigidAntiDive, "anti_dive", PERCENT, "the front resists diving in braking", "of a solid axle: -100 p (L/h)(f_l + f_r)", LINK_LOADS, [WheelRadius, Wheelbase, CgHeight, FrontBraking], [], 1, false, lanes, rigid::anti_dive, None;
        DriveLoadTransfer, "drive_load_transfer", RATIO, "the right wheel gains load under drive", "of a solid axle: (f_r - f_l)/2 for a unit drive force; without the torque of the propeller shaft", LINK_LOADS, [WheelRadius, RearDrive], [], 1, false, lanes, rigid::drive_load_transfer, None;
        BeamTwist, "beam_twist", ANGLE, "twisted by a positive roll angle: the right wheel in jounce", "angle by which the right half of a twist beam is rotated relative to the left half", "kinematics of a twist beam", [], [BarAngle], 0, false, one_by_one, rigid::beam_twist, None;
        BeamTorque, "beam_torque", Unit::Torque, "twisted by a positive roll angle", "torsional_rate beam_twist", "kinematics of a twist beam", [TorsionalRate], [BarAngle], 0, false, one_by_one, rigid::beam_torque, None;
        WheelHopFrequency, "wheel_hop_frequency", Unit::Frequency, "always", "sqrt(2 (wheel_rate + tyre rate)/unsprung mass)/(2 pi), where wheel_rate is the mean of both wheels; for a solid axle, the rate per wheel if both wheels rise together", "natural frequency of the wheels with the body held", [WheelRadius, SpringForce, TyreRate, UnsprungMass], [SpringLength, BarAngle], 2, false, one_by_one, loads::wheel_hop_frequency, None;
    }
}

/// A quantity that has a value in a state of an axle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Quantity {
    /// A wheel characteristic of one wheel.
    Corner(Side, Characteristic),
    /// A quantity of one wheel that is not a wheel characteristic.
    Wheel(Side, WheelQuantity),
    /// A quantity of the axle as a whole.
    Axle(AxleQuantity),
    /// A test result of an axle with elastic parts.
    Figure(TestFigure),
}

impl Quantity {
    /// Returns the quantities with this name, left before right. Empty if there are none. The name `roll_steer` belongs
    /// to a quantity of each wheel and to a quantity of the axle.
    pub fn named(name: &str) -> Vec<Quantity> {
        let sides = Side::ALL;
        let mut found = Vec::new();
        if let Some(c) =
            Characteristic::named(name).filter(|c| *c != Characteristic::RollCentreHeight)
        {
            found.extend(sides.each(|side| Quantity::Corner(side, c)));
        }
        if let Some(q) = WheelQuantity::ALL.iter().find(|q| q.info().name == name) {
            found.extend(sides.each(|side| Quantity::Wheel(side, *q)));
        }
        let own = AxleQuantity::ALL.iter().find(|q| q.info().name == name);
        found.extend(own.map(|q| Quantity::Axle(*q)));
        found
    }

    /// Returns true if an axle of this kind has the quantity. If one body carries both wheels, derivatives with respect to a
    /// wheel's own travel are not defined. Only a solid axle has an axle line, a pitch angle and an angular velocity.
    pub fn is_of(self, kind: AxleKind) -> bool {
        use AxleQuantity as A;
        use WheelQuantity as W;
        let rigid = kind != AxleKind::Independent;
        match self {
            Quantity::Corner(_, c) => {
                let turns_bar = || c.info().reads.contains(&Slot::BarAngle);
                let is_of_beam = kind == AxleKind::TwistBeam && turns_bar();
                (!rigid || c.info().rate_order == 0) && !is_of_beam
            }
            Quantity::Wheel(_, q) => {
                let by_own_travel = [W::JackingCoefficient, W::SideForceJacking];
                !(rigid && by_own_travel.contains(&q))
            }
            Quantity::Axle(
                A::AckermannError
                | A::Ackermann
                | A::AckermannByInner
                | A::AckermannByCotangents
                | A::TurningCircle,
            ) => !rigid || kind == AxleKind::SteeredSolid,
            Quantity::Axle(A::SteeringRatio) => !rigid,
            Quantity::Axle(A::AxleSteer | A::PinionAngle) => {
                matches!(kind, AxleKind::Solid | AxleKind::SteeredSolid)
            }
            Quantity::Axle(
                A::RollCentreHeight
                | A::RollCentreLateral
                | A::RollCentreMigrationVertical
                | A::RollCentreMigrationLateral
                | A::BarTorque,
            ) => kind != AxleKind::TwistBeam,
            Quantity::Axle(A::BeamTwist | A::BeamTorque) => kind == AxleKind::TwistBeam,
            Quantity::Axle(
                A::AxleLateral
                | A::AxleLongitudinal
                | A::RigidAntiSquat
                | A::RigidAntiLift
                | A::RigidAntiDive
                | A::DriveLoadTransfer,
            ) => rigid,
            Quantity::Axle(_) => true,
            Quantity::Figure(_) => kind != AxleKind::TwistBeam,
        }
    }

    /// All names of quantities that a study may request.
    pub fn names() -> Vec<&'static str> {
        let corner = Characteristic::ALL.iter().map(|c| c.info().name);
        let wheel = WheelQuantity::ALL.iter().map(|q| q.info().name);
        let axle = AxleQuantity::ALL.iter().map(|q| q.info().name);
        let mut names: Vec<_> = corner.chain(wheel).chain(axle).collect();
        let mut seen = std::collections::HashSet::new();
        names.retain(|name| seen.insert(*name));
        names
    }

    /// Name of the quantity in columns of results, without the unit.
    pub fn name(self) -> String {
        let of_side = |side: Side, name: &str| format!("{}_{name}", side.name());
        match self {
            Quantity::Corner(side, c) => of_side(side, c.info().name),
            Quantity::Wheel(side, q) => of_side(side, q.info().name),
            Quantity::Axle(q) => q.info().name.to_owned(),
            Quantity::Figure(figure) => figure.name(),
        }
    }

    /// Wheel to which the quantity belongs. `None` for a quantity of the axle.
    pub fn side(self) -> Option<Side> {
        match self {
            Quantity::Corner(side, _) | Quantity::Wheel(side, _) => Some(side),
            Quantity::Axle(_) => None,
            Quantity::Figure(figure) => figure.side(),
        }
    }

    /// Catalogue entry of the quantity: name, unit, sign, formula, source and required inputs.
    pub fn info(self) -> Info {
        match self {
            Quantity::Corner(_, c) => *c.info(),
            Quantity::Wheel(_, q) => *q.info(),
            Quantity::Axle(q) => *q.info(),
            Quantity::Figure(figure) => figure.info(),
        }
    }

    /// Returns the order of the highest derivative, with respect to travel and rack, from which the value is computed.
    pub fn rate_order(self) -> usize {
        self.info().rate_order
    }

    /// Value of the quantity in a state of the axle.
    pub fn evaluate<T: Scalar, W: WheelParts<T>>(self, state: &AxleState<T, W>) -> T {
        match self {
            Quantity::Corner(side, c) => {
                let inputs = state.readings[side as usize].inputs(state.setup.constants);
                c.evaluate(&inputs)
            }
            Quantity::Wheel(side, q) => q.evaluate(state, side),
            Quantity::Axle(q) => q.evaluate(state),
            // A rigid mechanism has no test results.
            Quantity::Figure(_) => state.like().constant(f64::NAN),
        }
    }

    /// Largest height difference of two contact points on one plane, relative to the track.
    pub(super) const SAME_PLANE: f64 = 1e-9;

    /// Returns true if the quantity is a derivative along a motion on a plane ground, such as roll.
    pub(super) fn is_of_the_plane(self) -> bool {
        matches!(
            self,
            Quantity::Wheel(
                _,
                WheelQuantity::RollCamber
                    | WheelQuantity::RollCamberToRoad
                    | WheelQuantity::WheelRollSteer
            ) | Quantity::Axle(
                AxleQuantity::RollSteer
                    | AxleQuantity::RollCentreMigrationVertical
                    | AxleQuantity::RollCentreMigrationLateral
                    | AxleQuantity::ForceRollCentreMigration
                    | AxleQuantity::RollStiffnessOnRoad
                    | AxleQuantity::RollStiffnessAtLoad
            )
        )
    }

    /// Returns the reason, in words, why the quantity has no value in some poses.
    pub fn undefined_where(self) -> &'static str {
        let void = match self {
            Quantity::Corner(_, c) => return c.undefined_where(),
            Quantity::Axle(q) => q.possible_void(),
            Quantity::Wheel(..) | Quantity::Figure(_) => None,
        };
        let plane = self.is_of_the_plane().then_some(NoValue::NoPlane);
        void.or(plane).unwrap_or(NoValue::NotFinite).reason()
    }

    /// Value of the quantity in a state of the axle, or the reason for a missing value.
    pub fn value(self, state: &AxleState<f64>) -> Result<f64, NoValue> {
        let is_void = |void: &NoValue| match void {
            NoValue::StraightAhead => steering::is_straight_ahead(state),
            NoValue::ParallelNormals => !roll::normals_meet(state),
            NoValue::NoPlane => !state.is_on_plane(),
            _ => false,
        };
        let plane = self.is_of_the_plane().then_some(NoValue::NoPlane);
        let own = match self {
            Quantity::Axle(q) => q.possible_void(),
            _ => None,
        };
        let void = plane.into_iter().chain(own).find(is_void);
        match void {
            Some(void) => Err(void),
            None => {
                let value = self.evaluate(state);
                value.is_finite().then_some(value).ok_or(NoValue::NotFinite)
            }
        }
    }
}
