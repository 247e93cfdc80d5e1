//! Results of a car. Each result has a name, a unit, a sign and a formula.

mod need;

use super::equations::Balance;
use super::formulas::{axle, car, wheel};
use super::rates::Solved;
use super::{Car, Case, Longitudinal};
use crate::ask::Unit;
use crate::model::LengthUnit;
use crate::number::{Each, Scalar};
pub use need::CarNeed;

/// One of the four wheels: front left, front right, rear left, rear right.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct WheelPlace(pub usize);

impl WheelPlace {
    /// All variants, in their order.
    pub const ALL: [WheelPlace; 4] = [WheelPlace(0), WheelPlace(1), WheelPlace(2), WheelPlace(3)];

    /// Name of the wheel in columns.
    pub fn name(self) -> &'static str {
        ["front_left", "front_right", "rear_left", "rear_right"][self.0]
    }

    /// Name of the wheel in words.
    pub fn words(self) -> &'static str {
        [
            "the front left wheel",
            "the front right wheel",
            "the rear left wheel",
            "the rear right wheel",
        ][self.0]
    }
}

/// An axle of the car.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AxleEnd {
    /// The front axle.
    Front,
    /// The rear axle.
    Rear,
}

impl AxleEnd {
    /// Both axles.
    pub const ALL: [AxleEnd; 2] = [AxleEnd::Front, AxleEnd::Rear];

    /// Name in studies and columns.
    pub fn name(self) -> &'static str {
        match self {
            AxleEnd::Front => "front",
            AxleEnd::Rear => "rear",
        }
    }
}

/// Data of a result in the catalogue.
#[derive(Clone, Copy, Debug)]
pub struct CarInfo {
    /// Name in studies. For a result of an axle, `{}` is replaced by `front` or `rear`.
    pub name: &'static str,
    /// Type of the unit of the result.
    pub unit: Unit,
    /// Meaning of a positive value of the result.
    pub positive: &'static str,
    /// Formula in the notation of the manual.
    pub formula: &'static str,
    /// Parts that the car must have for this result.
    pub needs: &'static [CarNeed],
    /// True if the value is computed from derivatives of the state.
    pub is_rate: bool,
}

macro_rules! catalogue {
    (@is_rate state) => { false };
    (@is_rate rate) => { true };
    (@value state, $function:expr, $solved:ident, ($($place:ident)?)) => { $function(&$solved.now $(, $place)?) };
    (@value rate, $function:expr, $solved:ident, ($($place:ident)?)) => { $function($solved $(, $place)?) };
    (@state state, $function:expr, $state:ident, ($($place:ident)?)) => { $function($state $(, $place)?) };
    (@state rate, $function:expr, $state:ident, $place:tt) => { $state.unknowns[0].constant(f64::NAN) };
    ($($Kind:ident of $parameter:ident: $Place:ty, $place:tt {
        $($entry:ident, $name:literal, $unit:ident, $positive:literal, $formula:literal, [$($need:ident),*], $how:ident, $function:expr;)*
    })*) => {
        $(
            /// Results of one type: results of a wheel, of an axle, or of the whole car.
            #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
            pub enum $Kind {
                $(#[doc = concat!("`", $name, "`: `", $formula, "`")] $entry,)*
            }

            impl $Kind {
                /// All variants, in their order.
                pub const ALL: &'static [$Kind] = &[$($Kind::$entry),*];

                /// Returns the data of this result in the catalogue.
                pub fn info(self) -> &'static CarInfo {
                    match self {
                        $($Kind::$entry => &CarInfo {
                            name: $name, unit: Unit::$unit, positive: $positive, formula: $formula,
                            needs: &[$(CarNeed::$need),*], is_rate: catalogue!(@is_rate $how),
                        },)*
                    }
                }

                fn evaluate<T: Scalar>(self, solved: &Solved<'_, T>, $parameter: $Place) -> T {
                    match self {
                        $($Kind::$entry => catalogue!(@value $how, $function, solved, $place),)*
                    }
                }

                #[allow(unused_variables, reason = "derivatives do not use the position")]
                fn evaluate_state<T: Scalar>(self, state: &Balance<T>, $parameter: $Place) -> T {
                    match self {
                        $($Kind::$entry => catalogue!(@state $how, $function, state, $place),)*
                    }
                }
            }
        )*
    };
}

catalogue! {
    WheelResult of place: WheelPlace, (place) {
        Travel, "travel", Length, "jounce", "z", [], state, wheel::travel;
        Load, "wheel_load", Force, "pressed to the ground", "N, the total load", [], state, wheel::load;
        Elastic, "wheel_load_elastic", Force, "pressed to the ground", "U_z/(n.C')", [], state, wheel::elastic;
        Geometric, "wheel_load_geometric", Force, "pressed to the ground", "-S lambda.C'/(n.C')", [], state, wheel::geometric;
        Longitudinal, "wheel_load_longitudinal", Force, "pressed to the ground", "-X t.B'/(n.C')", [], state, wheel::longitudinal;
        Unsprung, "wheel_load_unsprung", Force, "pressed to the ground", "m_b alpha.W'/(n.C')", [], state, wheel::unsprung;
        SideForce, "side_force", Force, "to the left (force on the car)", "S", [], state, wheel::side_force;
        LongitudinalForce, "longitudinal_force", Force, "forward (force on the car)", "X", [], state, wheel::longitudinal_force;
        LateralShare, "lateral_share", Ratio, "always", "S/A, where A is the side force of the axle", [], state, wheel::share;
        FrictionDemand, "friction_demand", Ratio, "always", "hypot(S, X)/N", [], state, wheel::friction_demand;
        Gap, "gap", Length, "lifted", "height of the lifted wheel's lowest point", [], state, wheel::gap;
        LoadedRadius, "loaded_radius", Length, "always", "R_l", [], state, wheel::loaded_radius;
        Camber, "camber", Angle, "top of the wheel outboard", "-asin(a_z)", [], state, wheel::camber;
        CamberToRoad, "camber_to_road", Angle, "top of the wheel outboard", "-asin(a.n)", [], state, wheel::camber_to_road;
        Toe, "toe", Angle, "front of the wheel inboard", "atan2(a_x, a_y outboard)", [], state, wheel::toe;
        Steer, "steer", Angle, "steered to the left, at both wheels", "-toe at the left, +toe at the right wheel", [], state, wheel::steer;
        SteerToRoad, "steer_to_road", Angle, "steered to the left, at both wheels", "steer with the axes i and e of the ground", [], state, wheel::steer_to_road;
        ContactX, "contact_point_x", Length, "forward", "C_x, body axes", [], state, wheel::contact_x;
        ContactY, "contact_point_y", Length, "left", "C_y, body axes", [], state, wheel::contact_y;
        ContactZ, "contact_point_z", Length, "upward", "C_z, body axes", [], state, wheel::contact_z;
        SpringForce, "spring_force", Force, "compressed", "force of the spring, stops included", [Spring], state, wheel::spring_force;
        SpringLength, "spring_length", Length, "always", "length of the spring", [Spring], state, wheel::spring_length;
        SpringTravel, "spring_travel", Length, "compressed", "length in the design position minus the present length", [Spring], state, wheel::spring_travel;
        BumpStopCompression, "bump_stop_compression", Length, "always; 0 without contact", "shortening of the spring beyond the gap", [BumpStop], state, wheel::bump_stop_compression;
        ReboundStopExtension, "rebound_stop_extension", Length, "always; 0 without contact", "lengthening of the spring beyond the gap", [ReboundStop], state, wheel::rebound_stop_extension;
        Jacking, "jacking_coefficient", Ratio, "a side force inboard lifts the body", "(C'.o)/(C'.n), where o points outboard along the ground", [Independent], state, wheel::jacking;
        SideForceJacking, "side_force_jacking", Ratio, "a side force inboard lifts the body", "(C'.o)/(C'.n), where o points across the wheel, in the ground plane", [Independent], state, wheel::side_force_jacking;
        CamberGradient, "camber_gradient", AnglePerG, "camber to the road grows with ay", "d camber_to_road/d ay", [], rate, wheel::camber_gradient;
    }
    AxleResult of place: usize, (place) {
        RideHeight, "ride_height_{}", Length, "above the ground", "n.P - gamma", [RideHeight], state, axle::ride_height;
        Transfer, "lateral_load_transfer_{}", Force, "to the right, as in a left turn", "(N_r - N_l)/2", [], state, axle::load_transfer;
        Elastic, "lateral_load_transfer_{}_elastic", Force, "to the right", "(p_r - p_l)/2, where p is the part U_z/(n.C') of the wheel load", [], state, axle::elastic;
        Geometric, "lateral_load_transfer_{}_geometric", Force, "to the right", "(p_r - p_l)/2, where p is the part -S lambda.C'/(n.C') of the wheel load", [], state, axle::geometric;
        Longitudinal, "lateral_load_transfer_{}_longitudinal", Force, "to the right", "(p_r - p_l)/2, where p is the part -X t.B'/(n.C') of the wheel load", [], state, axle::longitudinal;
        Unsprung, "lateral_load_transfer_{}_unsprung", Force, "to the right", "(p_r - p_l)/2, where p is the part m_b alpha.W'/(n.C') of the wheel load", [], state, axle::unsprung;
        Load, "axle_load_{}", Force, "pressed to the ground", "N_l + N_r", [], state, axle::load;
        SideForce, "axle_side_force_{}", Force, "to the left (force on the car)", "A", [], state, axle::side_force;
        Track, "track_{}", Length, "always", "e.(C_l - C_r)", [], state, axle::track;
        MeanSteer, "mean_steer_{}", Angle, "to the left", "(steer_l + steer_r)/2", [], state, axle::mean_steer;
        RollCentreHeight, "roll_centre_height_{}", Length, "above the ground", "track j_l j_r/(j_l + j_r)", [], state, axle::roll_centre_height;
        RollCentreLateral, "roll_centre_lateral_{}", Length, "to the left of the midpoint between the contact points", "track (j_l - j_r)/(2 (j_l + j_r))", [], state, axle::roll_centre_lateral;
        ForceRollCentre, "force_roll_centre_height_{}", Length, "above the ground", "track (j_l + j_r)/4", [], state, axle::force_roll_centre_height;
        RollAxisHeight, "roll_axis_height_{}", Length, "above the ground", "track (f_l J_l + f_r J_r)/2", [], state, axle::roll_axis_height;
        BarTorque, "anti_roll_bar_torque_{}", Torque, "the left lever is pushed further", "k_b (b_l - b_r)", [Bar], state, axle::bar_torque;
        BeamTorque, "beam_torque_{}", Torque, "twisted by a positive roll angle", "torsional_rate times the twist of the twist beam", [Beam], state, axle::beam_torque;
        HeaveSpringForce, "heave_spring_force_{}", Force, "compressed", "force + rate (l0 - l)", [HeaveSpring], state, axle::heave_spring_force;
        HeaveSpringLength, "heave_spring_length_{}", Length, "always", "distance between the points heave_spring of both rockers", [HeaveSpring], state, axle::heave_spring_length;
        HeaveSpringTravel, "heave_spring_travel_{}", Length, "compressed", "length in the design position minus the present length", [HeaveSpring], state, axle::heave_spring_travel;
        TBarTorque, "t_bar_torque_{}", Torque, "the left rocker has turned further than the right", "k (rho_l - rho_r)", [TBar], state, axle::t_bar_torque;
        HeaveBarTorque, "heave_bar_torque_{}", Torque, "in the direction in which jounce turns it", "torque + k (rho_l + rho_r)", [HeaveBar], state, axle::heave_bar_torque;
        Downforce, "downforce_{}", Force, "down", "force of the air along -n", [Air], state, axle::downforce;
        RollSteerGradient, "roll_steer_gradient_{}", AnglePerG, "steers to the left as ay grows", "d mean_steer/d ay, rack held", [], rate, axle::roll_steer_gradient;
        PitchSteerGradient, "pitch_steer_gradient_{}", AnglePerG, "steers to the left as ax grows", "d mean_steer/d ax, rack held", [], rate, axle::pitch_steer_gradient;
        RideRate, "axle_ride_rate_{}", ForcePerLength, "always", "d(N_l + N_r)/d gamma; attitude, A, B held, tyres in series", [], rate, axle::ride_rate;
        RideFrequency, "ride_frequency_{}", Frequency, "always", "sqrt(K_A/m_A)/(2 pi), where m_A is the part of the sprung mass on this axle, by the lever rule", [], rate, axle::ride_frequency;
    }
    WholeResult of _place: (), () {
        Roll, "roll", Angle, "right side down", "phi", [], state, car::roll;
        Pitch, "pitch", Angle, "nose down", "theta", [], state, car::pitch;
        Heave, "heave", Length, "body down", "gamma - n.P0, P0 the mean contact point in the design position", [], state, car::heave;
        JackingHeave, "jacking_heave", Length, "body up", "static heave minus heave", [], rate, car::jacking_heave;
        Energy, "energy", Torque, "stored since the design position", "U of springs, stops and bars", [], state, car::energy;
        WarpStiffness, "warp_stiffness", ForcePerLength, "always", "derivative of (N_fl - N_fr - N_rl + N_rr)/4 with respect to the height of the ground under front left and rear right; the ground under the other wheels falls by the same height; body free", [], rate, car::warp_stiffness;
        Rake, "rake", Length, "nose down", "ride_height_rear - ride_height_front", [RideHeights], state, car::rake;
        Wheelbase, "wheelbase_at_contact", Length, "always", "i.(mid contact points front - rear)", [], state, car::wheelbase;
        CgHeight, "cg_height", Length, "above the ground", "height of the centre of gravity of all masses", [], state, car::cg_height;
        SprungCgHeight, "sprung_cg_height", Length, "above the ground", "n.G - gamma", [], state, car::sprung_cg_height;
        RollCentreInclination, "roll_centre_inclination", Angle, "rises to the front", "atan2(h_f - h_r, L), where h is roll_centre_height", [], state, car::roll_centre_inclination;
        RollCentreAtCg, "roll_centre_height_at_cg", Length, "above the ground", "height at G of the line through the roll centres", [], state, car::roll_centre_height_at_cg;
        RollCentreArm, "roll_centre_moment_arm", Length, "G above the line", "n.G - gamma - roll_centre_height_at_cg", [], state, car::roll_centre_moment_arm;
        RollAxisInclination, "roll_axis_inclination", Angle, "rises to the front", "atan2(h_f - h_r, L), where h is roll_axis_height", [], state, car::roll_axis_inclination;
        RollAxisAtCg, "roll_axis_height_at_cg", Length, "above the ground", "height of the roll axis at G", [], state, car::roll_axis_height_at_cg;
        RollAxisArm, "roll_axis_moment_arm", Length, "G above the axis", "n.G - gamma - roll_axis_height_at_cg", [], state, car::roll_axis_moment_arm;
        LongitudinalForce, "longitudinal_force", Force, "forward", "B", [], state, car::longitudinal_force;
        Transfer, "lateral_load_transfer", Force, "to the right, as in a left turn", "front + rear", [], state, car::load_transfer;
        Distribution, "lateral_load_transfer_distribution", Percent, "always", "100 front/(front + rear)", [], state, car::distribution;
        DistributionElastic, "lateral_load_transfer_distribution_elastic", Percent, "in the direction of the total transfer", "100 (elastic part at the front)/(total lateral load transfer)", [], state, car::distribution_elastic;
        DistributionGeometric, "lateral_load_transfer_distribution_geometric", Percent, "in the direction of the total transfer", "100 (geometric part at the front)/(total lateral load transfer)", [], state, car::distribution_geometric;
        DistributionLongitudinal, "lateral_load_transfer_distribution_longitudinal", Percent, "in the direction of the total transfer", "100 (longitudinal part at the front)/(total lateral load transfer)", [], state, car::distribution_longitudinal;
        DistributionUnsprung, "lateral_load_transfer_distribution_unsprung", Percent, "in the direction of the total transfer", "100 (unsprung part at the front)/(total lateral load transfer)", [], state, car::distribution_unsprung;
        LocalDistribution, "lateral_load_transfer_distribution_local", Percent, "always", "100 front/(front + rear) of d(load transfer)/d ay", [], rate, car::local_distribution;
        RollGradient, "roll_gradient", AnglePerG, "rolls to the right as ay grows", "d phi/d ay", [], rate, car::roll_gradient;
        PitchGradient, "pitch_gradient", AnglePerG, "the nose dips as ax grows; below 0 it dips in braking", "d theta/d ax", [], rate, car::pitch_gradient;
        RollStiffness, "body_roll_stiffness", TorquePerAngle, "always", "1/(d phi/d M), where M is a couple on the body about i; tyres in series, weight and side forces included", [], rate, car::roll_stiffness;
        RollStiffnessDistribution, "body_roll_stiffness_distribution", Percent, "always", "100 front/(front + rear) of d(track (N_r - N_l)/2)/d M", [], rate, car::roll_stiffness_distribution;
        AntiDive, "anti_dive_by_force", Percent, "resists the dive", "100 (sum of wheel_load_longitudinal at the front)/T, where T = -sum(F.i) h/L; braking", [], state, car::anti_front;
        AntiLiftRear, "anti_lift_by_force_rear", Percent, "resists the lift", "-100 (sum of wheel_load_longitudinal at the rear)/T; braking", [], state, car::anti_rear;
        AntiLiftFront, "anti_lift_by_force_front", Percent, "resists the lift", "100 (sum of wheel_load_longitudinal at the front)/T; drive", [], state, car::anti_front;
        AntiSquat, "anti_squat_by_force", Percent, "resists the squat", "-100 (sum of wheel_load_longitudinal at the rear)/T; drive", [], state, car::anti_rear;
        RollUndersteer, "roll_understeer", AnglePerG, "understeers", "roll_steer_gradient_rear - roll_steer_gradient_front", [], rate, car::roll_understeer;
        CrossWeight, "cross_weight", Percent, "always", "100 (front right + rear left)/(sum of all wheel loads)", [], state, car::cross_weight;
        WeightFront, "weight_distribution_front", Percent, "always", "100 (front wheel loads)/(sum of all wheel loads)", [], state, car::weight_front;
        WeightLeft, "weight_distribution_left", Percent, "always", "100 (left wheel loads)/(sum of all wheel loads)", [], state, car::weight_left;
        Downforce, "downforce", Force, "down", "front + rear", [Air], state, car::downforce;
        AeroBalance, "aero_balance", Percent, "always", "100 (downforce at the front)/downforce", [Air], state, car::aero_balance;
        Drag, "drag", Force, "backward", "force of the air along -i", [Air], state, car::drag;
        HeaveRate, "body_heave_rate", ForcePerLength, "always", "d(vertical force)/d gamma, attitude held, tyres in series", [], rate, car::heave_rate;
        HeaveFrequency, "heave_frequency_uncoupled", Frequency, "always", "sqrt(body_heave_rate/m_s)/(2 pi)", [], rate, car::heave_frequency;
        LowFrequency, "body_frequency_low", Frequency, "always", "heave and pitch of the sprung mass, massless wheels, tyres in series", [PitchInertia], rate, car::low_frequency;
        HighFrequency, "body_frequency_high", Frequency, "always", "heave and pitch of the sprung mass, massless wheels, tyres in series", [PitchInertia], rate, car::high_frequency;
    }
}

/// A result of a car.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CarQuantity {
    /// A result of a wheel.
    Wheel(WheelPlace, WheelResult),
    /// A result of an axle.
    Axle(AxleEnd, AxleResult),
    /// A result of the whole car.
    Whole(WholeResult),
}

impl CarQuantity {
    /// Returns all results: of the whole car, of each wheel, and of each axle.
    pub fn all() -> Vec<CarQuantity> {
        let whole = WholeResult::ALL.iter().copied().map(CarQuantity::Whole);
        let wheels = WheelPlace::ALL.into_iter().flat_map(|place| {
            let of = move |result: &WheelResult| CarQuantity::Wheel(place, *result);
            WheelResult::ALL.iter().map(of)
        });
        let axles = AxleEnd::ALL.into_iter().flat_map(|end| {
            let of = move |result: &AxleResult| CarQuantity::Axle(end, *result);
            AxleResult::ALL.iter().map(of)
        });
        whole.chain(wheels).chain(axles).collect()
    }

    /// Returns all names that [`CarQuantity::named`] accepts. A name selects one result, or the result of each wheel or
    /// of each axle.
    pub fn names() -> Vec<String> {
        let all = CarQuantity::all().into_iter();
        let mut names: Vec<String> = all.map(CarQuantity::name).collect();
        names.extend(WheelResult::ALL.iter().map(|of| of.info().name.to_owned()));
        let of_axles = AxleResult::ALL.iter();
        names.extend(of_axles.map(|of| of.info().name.replace("_{}", "")));
        names.sort_unstable();
        names.dedup();
        names
    }

    /// Returns the results with this name: one result, or the results of all four wheels, or the results of both axles.
    pub fn named(name: &str) -> Vec<CarQuantity> {
        let matches = |quantity: &CarQuantity| {
            let plain = match quantity {
                CarQuantity::Wheel(_, result) => result.info().name == name,
                CarQuantity::Axle(_, result) => result.info().name.replace("_{}", "") == name,
                CarQuantity::Whole(_) => false,
            };
            plain || quantity.name() == name
        };
        let mut found = CarQuantity::all();
        found.retain(matches);
        // A result of the whole car takes precedence over results of the axles with the same name.
        if let Some(whole) = found.iter().find(|q| matches!(q, CarQuantity::Whole(_))) {
            return vec![*whole];
        }
        found
    }

    /// Returns the default columns, for a study without a list of columns.
    pub fn default_columns(car: &Car) -> Vec<CarQuantity> {
        let whole = |list: &[WholeResult]| -> Vec<CarQuantity> {
            list.iter().copied().map(CarQuantity::Whole).collect()
        };
        let axles = |list: &[AxleResult]| -> Vec<CarQuantity> {
            let of = |end: AxleEnd| {
                list.iter()
                    .map(move |result| CarQuantity::Axle(end, *result))
            };
            AxleEnd::ALL.into_iter().flat_map(of).collect()
        };
        let mut columns = whole(&[WholeResult::Roll, WholeResult::Pitch, WholeResult::Heave]);
        columns.extend(axles(&[AxleResult::RideHeight]));
        let of_wheel = [
            WheelResult::Travel,
            WheelResult::Load,
            WheelResult::Elastic,
            WheelResult::Geometric,
            WheelResult::Longitudinal,
            WheelResult::Unsprung,
            WheelResult::SideForce,
            WheelResult::LongitudinalForce,
            WheelResult::FrictionDemand,
            WheelResult::Gap,
            WheelResult::CamberToRoad,
            WheelResult::Toe,
            WheelResult::Steer,
            WheelResult::SpringForce,
            WheelResult::SpringTravel,
        ];
        for place in WheelPlace::ALL {
            columns.extend(of_wheel.each(|result| CarQuantity::Wheel(place, result)));
        }
        columns.extend(axles(&[
            AxleResult::Transfer,
            AxleResult::Elastic,
            AxleResult::Geometric,
            AxleResult::Longitudinal,
            AxleResult::Unsprung,
            AxleResult::RollCentreHeight,
            AxleResult::ForceRollCentre,
            AxleResult::RollAxisHeight,
        ]));
        columns.extend(whole(&[
            WholeResult::Distribution,
            WholeResult::LocalDistribution,
            WholeResult::RollGradient,
            WholeResult::PitchGradient,
            WholeResult::RollStiffness,
            WholeResult::RollStiffnessDistribution,
            WholeResult::AntiDive,
            WholeResult::AntiLiftRear,
            WholeResult::AntiLiftFront,
            WholeResult::AntiSquat,
            WholeResult::RollUndersteer,
            WholeResult::AeroBalance,
            WholeResult::WeightFront,
            WholeResult::WeightLeft,
            WholeResult::CrossWeight,
        ]));
        columns.retain(|quantity| quantity.is_met_by(car));
        columns
    }

    /// Default results of sweeps and tolerance studies.
    pub fn key_columns(car: &Car) -> Vec<CarQuantity> {
        let load = |place| CarQuantity::Wheel(place, WheelResult::Load);
        let mut columns = WheelPlace::ALL.each(load).to_vec();
        let whole = [
            WholeResult::Roll,
            WholeResult::Pitch,
            WholeResult::Distribution,
            WholeResult::LocalDistribution,
            WholeResult::RollGradient,
            WholeResult::PitchGradient,
            WholeResult::RollUndersteer,
            WholeResult::AntiDive,
            WholeResult::AntiSquat,
            WholeResult::AeroBalance,
            WholeResult::WeightFront,
            WholeResult::CrossWeight,
        ];
        columns.extend(whole.each(CarQuantity::Whole));
        columns.retain(|quantity| quantity.is_met_by(car));
        columns
    }

    /// Returns the data of this result in the catalogue.
    pub fn info(self) -> &'static CarInfo {
        match self {
            CarQuantity::Wheel(_, result) => result.info(),
            CarQuantity::Axle(_, result) => result.info(),
            CarQuantity::Whole(result) => result.info(),
        }
    }

    /// Name of the result in columns, without the unit.
    pub fn name(self) -> String {
        match self {
            CarQuantity::Wheel(place, result) => {
                format!("{}_{}", place.name(), result.info().name)
            }
            CarQuantity::Axle(end, result) => result.info().name.replace("{}", end.name()),
            CarQuantity::Whole(result) => result.info().name.to_owned(),
        }
    }

    /// Returns the name of the result's column.
    pub fn column(self, length: LengthUnit) -> String {
        crate::ask::with_unit(self.name(), &self.info().unit.suffix(length))
    }

    /// Returns true if a car has all parts and inputs that the quantity needs.
    pub fn is_met_by(self, car: &Car) -> bool {
        let has_height = |axle: usize| car.ride_height_points[axle].is_some();
        self.info().needs.iter().all(|need| match (need, self) {
            (CarNeed::RideHeight, CarQuantity::Axle(end, _)) => has_height(end as usize),
            (CarNeed::RideHeight | CarNeed::RideHeights, _) => has_height(0) && has_height(1),
            (CarNeed::Air, _) => car.air.is_some(),
            (CarNeed::PitchInertia, _) => car.pitch_inertia.is_some(),
            (need, CarQuantity::Axle(end, _)) => need.met_by(&car.axles[end as usize]),
            (need, CarQuantity::Wheel(place, _)) => need.met_by(&car.axles[place.0 / 2]),
            (_, CarQuantity::Whole(_)) => true,
        })
    }

    /// Returns true if the value is a difference from the heave of the car at rest.
    pub(super) fn is_since_rest(self) -> bool {
        self == CarQuantity::Whole(WholeResult::JackingHeave)
    }

    /// Returns the reason why the result is undefined in a case; `None` if it is defined. The check uses only the inputs
    /// of the case. A result is undefined if its formula is 0/0 for a symmetric car without drag. A result for braking
    /// is also undefined in a case with drive, and a result for drive in a case with braking.
    pub fn undefined_in(self, case: &Case) -> Option<&'static str> {
        use WholeResult::{
            AntiDive, AntiLiftFront, AntiLiftRear, AntiSquat, Distribution, DistributionElastic,
            DistributionGeometric, DistributionLongitudinal, DistributionUnsprung,
        };
        let CarQuantity::Whole(result) = self else {
            return None;
        };
        if result == WholeResult::AeroBalance && case.speed == 0.0 {
            return Some("at speed 0 the air has no force");
        }
        let is_braked = case.setting.longitudinal == Longitudinal::Brake;
        match result {
            Distribution
            | DistributionElastic
            | DistributionGeometric
            | DistributionLongitudinal
            | DistributionUnsprung
                if case.ay == 0.0 =>
            {
                Some("at ay = 0 no load is transferred across the car")
            }
            AntiDive | AntiLiftRear if !is_braked => {
                Some("it applies to braking, but the case has drive")
            }
            AntiLiftFront | AntiSquat if is_braked => {
                Some("it applies to drive, but the case has braking")
            }
            AntiDive | AntiLiftRear | AntiLiftFront | AntiSquat if case.ax == 0.0 => {
                Some("at ax = 0 no load is transferred along the car")
            }
            _ => None,
        }
    }

    /// Value in printed units. `None` if the result is undefined in the case, or if the value is not finite.
    pub fn printed(self, solved: &Solved<'_, f64>, case: &Case) -> Option<f64> {
        if self.undefined_in(case).is_some() {
            return None;
        }
        let value = self.evaluate(solved) * self.info().unit.printed_factor(solved.car.length_unit);
        value.is_finite().then_some(value)
    }

    /// Returns the value of a result that needs no derivatives of the state. NaN for other results.
    pub fn evaluate_state<T: Scalar>(self, state: &Balance<T>) -> T {
        match self {
            CarQuantity::Wheel(place, result) => result.evaluate_state(state, place),
            CarQuantity::Axle(end, result) => result.evaluate_state(state, end as usize),
            CarQuantity::Whole(result) => result.evaluate_state(state, ()),
        }
    }

    /// Returns the value, in radians, newtons and the car's length unit. The number is not finite if the result is not
    /// defined.
    pub fn evaluate<T: Scalar>(self, solved: &Solved<'_, T>) -> T {
        match self {
            CarQuantity::Wheel(place, result) => result.evaluate(solved, place),
            CarQuantity::Axle(end, result) => result.evaluate(solved, end as usize),
            CarQuantity::Whole(result) => result.evaluate(solved, ()),
        }
    }
}
