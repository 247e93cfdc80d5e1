//! The study file as written: its sections and keys. Unknown keys are refused.
//!
//! Names are still texts, and numbers are in the file's units and axes. Each value that may be faulty has its place in the file.
//! `flatten` and tagged enums are not used, because they lose these places.

use crate::value::{
    LimitText, MemberName, Number, Numbers, RightWheel, Selection, Text, Values, Whole,
};
use serde::Deserialize;
use serde::de::IgnoredAny;
use std::collections::BTreeMap;
use toml::Spanned;

/// Coordinates. The reader accepts any number of values; three are valid.
pub type Coordinates = Spanned<Vec<Number>>;

/// Complete study file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct File {
    /// `[suspension]`
    pub suspension: Suspension,
    /// `[wheel]`
    #[serde(default)]
    pub wheel: Wheel,
    /// `[vehicle]`
    #[serde(default)]
    pub vehicle: Vehicle,
    /// `[axle]`
    pub axle: Option<Spanned<Axle>>,
    /// `[steering]`
    pub steering: Option<Spanned<Steering>>,
    /// `[spring]`
    pub spring: Option<Spanned<Spring>>,
    /// `[bump_stop]`
    pub bump_stop: Option<Spanned<BumpStop>>,
    /// `[rebound_stop]`
    pub rebound_stop: Option<Spanned<BumpStop>>,
    /// `[anti_roll_bar]`
    pub anti_roll_bar: Option<Spanned<Rate>>,
    /// `[twist_beam]`
    pub twist_beam: Option<Spanned<TwistBeam>>,
    /// `[heave_spring]`
    pub heave_spring: Option<Spanned<HeaveSpring>>,
    /// `[t_bar]`
    pub t_bar: Option<Spanned<Rate>>,
    /// `[heave_bar]`
    pub heave_bar: Option<Spanned<HeaveBar>>,
    /// `[tyre]`
    pub tyre: Option<Spanned<Tyre>>,
    /// `[compliance]`
    pub compliance: Option<Spanned<Compliance>>,
    /// `[bushings.NAME]`
    #[serde(default)]
    pub bushings: BTreeMap<Text, Spanned<Bushing>>,
    /// `[links.NAME]`
    #[serde(default)]
    pub links: BTreeMap<Text, Spanned<LinkStiffness>>,
    /// `[subframe]`
    pub subframe: Option<Spanned<Subframe>>,
    /// `[motion]`
    pub motion: Spanned<Motion>,
    /// `[motions.NAME]`
    #[serde(default)]
    pub motions: BTreeMap<Text, Spanned<Motion>>,
    /// `[solver]`
    #[serde(default)]
    pub solver: Solver,
    /// `[outputs]`
    pub outputs: Option<Outputs>,
    /// `[sweep]`
    pub sweep: Option<Spanned<Sweep>>,
    /// `[optimise]`
    pub optimise: Option<Optimise>,
    /// `[setup]`
    pub setup: Option<Setup>,
    /// `[tolerance]`
    pub tolerance: Option<Spanned<Tolerance>>,
}

/// `[suspension]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Suspension {
    /// Name of the topology.
    pub topology: Text,
    /// `left` or `right`.
    pub side: Option<Text>,
    /// `mm`, `m` or `in`.
    pub length_unit: Option<Text>,
    /// `N` or `lbf`.
    pub force_unit: Option<Text>,
    /// `kg` or `lb`.
    pub mass_unit: Option<Text>,
    /// Name of the axis convention.
    pub frame: Option<Text>,
    /// `[suspension.hardpoints]`
    pub hardpoints: Spanned<BTreeMap<Text, Coordinates>>,
    /// Links of a solid axle that exist only once and have their true y coordinate.
    pub single: Option<Spanned<Vec<Text>>>,
    /// `[suspension.bodies]`: bodies on which ends of springs and rods are mounted.
    #[serde(default)]
    pub bodies: BTreeMap<Text, Text>,
    /// `[suspension.studs]`: directions of the studs in ball joints.
    #[serde(default)]
    pub studs: BTreeMap<Text, Coordinates>,
    /// `[suspension.extra_points]`
    #[serde(default)]
    pub extra_points: BTreeMap<Text, ExtraPoint>,
}

/// A point that is not a hardpoint.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ExtraPoint {
    /// Body with which the point moves.
    pub body: Text,
    /// Design position.
    pub position: Coordinates,
}

/// `[wheel]`
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wheel {
    /// Loaded radius.
    pub radius: Option<Number>,
    /// Width of the tyre.
    pub tyre_width: Option<Number>,
    /// Camber in the design position, degrees.
    pub static_camber: Option<Number>,
    /// Toe in the design position, degrees.
    pub static_toe: Option<Number>,
}

/// `[vehicle]`
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Vehicle {
    /// Distance between the axles.
    pub wheelbase: Option<Number>,
    /// Distance between the wheels of the axle.
    pub track: Option<Number>,
    /// Height of the centre of gravity above the ground.
    pub cg_height: Option<Number>,
    /// Share of the braking force at the front axle.
    pub brake_share_front: Option<Number>,
    /// Share of the drive force at the front axle.
    pub drive_share_front: Option<Number>,
    /// Position of this axle: `front` or `rear`.
    pub position: Option<Text>,
    /// `outboard` or `inboard`.
    pub brakes: Option<Text>,
    /// `shafts` or `carrier`.
    pub drive_torque: Option<Text>,
    /// Mass that the axle carries, kg.
    pub sprung_mass: Option<Number>,
    /// Mass of the axle itself, kg.
    pub unsprung_mass: Option<Number>,
}

/// `[axle]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Axle {
    /// `"mirrored"`, or the differences from the mirror image. The default is the mirror image.
    pub right: Option<Spanned<RightWheel>>,
}

/// `[axle.right]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OwnRight {
    /// Hardpoints that are not the mirror images of the left ones.
    #[serde(default)]
    pub hardpoints: BTreeMap<Text, Coordinates>,
    /// Bodies on which ends of springs and rods are mounted, if they differ from the left wheel's.
    #[serde(default)]
    pub bodies: BTreeMap<Text, Text>,
    /// Camber and toe of the right wheel.
    pub wheel: Option<Spanned<OwnAngles>>,
    /// Spring of the right wheel.
    pub spring: Option<Spanned<Spring>>,
    /// Rates of bushings that differ from the left wheel's.
    #[serde(default)]
    pub bushings: BTreeMap<Text, Spanned<OwnBushing>>,
    /// Stiffness of links that differs from the left wheel's.
    #[serde(default)]
    pub links: BTreeMap<Text, Spanned<LinkStiffness>>,
}

/// `[axle.right.bushings.NAME]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OwnBushing {
    /// Stiffness along and about its axes. Six numbers are valid.
    pub stiffness: Option<Spanned<Vec<Number>>>,
    /// Factors of the force and torque laws. Six numbers are valid.
    pub scale: Option<Spanned<Vec<Number>>>,
}

/// `[axle.right.wheel]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OwnAngles {
    /// Camber in the design position, degrees.
    pub static_camber: Option<Number>,
    /// Toe in the design position, degrees.
    pub static_toe: Option<Number>,
}

/// `[steering]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Steering {
    /// Rack displacement along +y per turn of the steering wheel to the left.
    pub c_factor: Option<Number>,
    /// Stiffness between commanded and actual rack position, as force per length.
    pub rack_stiffness: Option<Number>,
    /// Torque per angle at the pinion. It requires `c_factor`.
    pub column_stiffness: Option<Number>,
    /// Direction in which the steering gear moves the drag link of a solid axle.
    pub direction: Option<Coordinates>,
}

/// `[spring]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Spring {
    /// Force per length.
    pub rate: Option<Number>,
    /// Force in the design position.
    pub force: Option<Number>,
    /// Pairs of length and force.
    pub force_curve: Option<Spanned<Vec<Spanned<Vec<Number>>>>>,
}

/// `[bump_stop]` and `[rebound_stop]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BumpStop {
    /// Travel along the spring from the design position to the contact of the stop: shortening for a bump stop, lengthening for a
    /// rebound stop.
    pub gap: Number,
    /// Pairs of stop compression and force.
    pub force_curve: Spanned<Vec<Spanned<Vec<Number>>>>,
}

/// `[tyre]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tyre {
    /// Force per length.
    pub rate: Number,
    /// Wheel load at which the tyre has `[wheel] radius`, for a car.
    pub load: Option<Number>,
}

/// `[heave_spring]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HeaveSpring {
    /// Force per length.
    pub rate: Number,
    /// Force in the design position.
    pub force: Number,
}

/// `[heave_bar]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HeaveBar {
    /// Torque per angle.
    pub rate: Number,
    /// Torque in the design position.
    pub torque: Number,
}

/// `[anti_roll_bar]` and `[t_bar]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rate {
    /// Torque per angle, or force per length.
    pub rate: Number,
}

/// `[twist_beam]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TwistBeam {
    /// Torque per angle between the two arms.
    pub torsional_rate: Number,
}

/// `[compliance]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Compliance {
    /// `free` or `at_design_load`.
    pub relaxed: Option<Text>,
    /// Tests of `hardpoint kc`.
    pub tests: Option<Spanned<Vec<Spanned<ComplianceTest>>>>,
    /// `connected` or `disconnected`.
    pub anti_roll_bar: Option<Text>,
}

/// An element of `tests` of `[compliance]`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ComplianceTest {
    /// Name of the test load or of the test motion.
    pub load: Text,
    /// Distance from the contact point back to the side force.
    pub trail: Option<Number>,
    /// `wheel_height` or `wheel_load`.
    pub hold: Option<Text>,
    /// Half-width of the range of the load.
    pub window: Option<Number>,
    /// Number of levels of the load.
    pub levels: Option<Whole>,
    /// `all` or `nearest`.
    pub stations: Option<Text>,
    /// For an axle: `parallel`, `opposed` or `single`.
    pub mode: Option<Text>,
    /// For an axle: `locked_wheel` or `locked_rack`.
    pub steering: Option<Text>,
    /// For an axle: `connected` or `disconnected`.
    pub anti_roll_bar: Option<Text>,
}

/// Pairs of deflection and force, or of angle and torque.
pub type BushingCurve = Option<Spanned<Vec<Spanned<Vec<Number>>>>>;

/// `[bushings.NAME]`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bushing {
    /// Stiffness along and about its axes. Six numbers are valid.
    pub stiffness: Option<Spanned<Vec<Number>>>,
    /// Coefficients of the cubed deflection. Six numbers are valid.
    pub cubic: Option<Spanned<Vec<Number>>>,
    /// Force along x against deflection.
    pub fx: BushingCurve,
    /// Force along y against deflection.
    pub fy: BushingCurve,
    /// Force along z against deflection.
    pub fz: BushingCurve,
    /// Torque about x against angle (rad).
    pub tx: BushingCurve,
    /// Torque about y against angle (rad).
    pub ty: BushingCurve,
    /// Torque about z against angle (rad).
    pub tz: BushingCurve,
    /// Direction of the x axis.
    pub x_axis: Option<Coordinates>,
    /// Direction whose component normal to the x axis is the z axis.
    pub z_axis: Option<Coordinates>,
    /// Constant forces and torques. Six numbers are valid.
    pub preload: Option<Spanned<Vec<Number>>>,
    /// Factors of the force and torque laws. Six numbers are valid.
    pub scale: Option<Spanned<Vec<Number>>>,
    /// Path of a bushing property file with the laws.
    pub file: Option<Text>,
}

/// `[subframe]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Subframe {
    /// Hardpoints on the subframe.
    pub carries: Spanned<Vec<Text>>,
    /// Positions of its left mounts by name.
    pub mounts: BTreeMap<Text, Coordinates>,
}

/// `[links.NAME]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LinkStiffness {
    /// Axial stiffness, as force per length. An alternative is `modulus` with `area`.
    pub axial_stiffness: Option<Number>,
    /// Elastic modulus, as force per area and strain.
    pub modulus: Option<Number>,
    /// Area of the cross-section.
    pub area: Option<Number>,
}

/// `[motion]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Motion {
    /// `travel`, `arm_angle` or `paper_theta`.
    pub drive: Option<Text>,
    /// Heights of the wheel centre above its design position.
    pub travel: Option<Spanned<Values>>,
    /// Angles of the first arm from its design position.
    pub arm_angle: Option<Spanned<Values>>,
    /// Values of the angle theta of Attia's paper.
    pub theta: Option<Spanned<Values>>,
    /// `deg` or `rad`.
    pub angle_unit: Option<Text>,
    /// Displacements of the rack along +y.
    pub rack: Option<Spanned<Values>>,
    /// Mean travels of an axle's wheel centres.
    pub heave: Option<Spanned<Values>>,
    /// Roll angles of the body, degrees.
    pub roll: Option<Spanned<Values>>,
    /// Travels of the left wheel.
    pub travel_left: Option<Spanned<Values>>,
    /// Travels of the right wheel.
    pub travel_right: Option<Spanned<Values>>,
    /// Angles of the steering wheel, degrees.
    pub steering_wheel_angle: Option<Spanned<Values>>,
    /// `plane` or `pads`.
    pub ground: Option<Text>,
    /// `mean_travel` or `load`.
    pub hold: Option<Text>,
    /// Drive as a function of time.
    pub time: Option<Spanned<Time>>,
}

/// `time` of `[motion]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Time {
    /// Coefficients, lowest power first.
    pub polynomial: Spanned<Vec<Number>>,
    /// First time, seconds.
    pub from: Number,
    /// Last time, seconds.
    pub to: Number,
    /// Number of times.
    pub steps: Whole,
}

/// `[solver]`
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Solver {
    /// `knuckle_pose` or `point_coordinates`.
    pub formulation: Option<Text>,
    /// Obsolete tolerance of poses; refused with an explanation.
    pub accuracy: Option<Spanned<IgnoredAny>>,
}

/// `[outputs]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Outputs {
    /// Names of characteristics.
    #[serde(default)]
    pub characteristics: Vec<Text>,
    /// Names of points.
    #[serde(default)]
    pub points: Vec<Text>,
    /// Angular rates of the knuckle.
    pub knuckle: Option<Spanned<bool>>,
    /// `position`, `velocity` or `acceleration`.
    pub order: Option<Text>,
    /// Hardpoints by whose coordinates the outputs are differentiated.
    pub sensitivities: Option<Selection>,
    /// True if each pose is to be proved.
    pub certify: Option<Spanned<bool>>,
    /// Loads on the wheel for which forces in links and joints are reported.
    pub loads: Option<Spanned<Vec<Load>>>,
}

/// An element of `loads`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Load {
    /// First part of the names of its columns.
    pub name: Text,
    /// `contact_point` or `wheel_centre`.
    pub at: Text,
    /// For an axle, the loaded wheel. The default is both wheels.
    pub side: Option<Text>,
    /// With elastic parts, the quantity that stays: `wheel_load` or `wheel_height`.
    pub hold: Option<Text>,
    /// Force. Three components are valid.
    pub force: Option<Coordinates>,
    /// Moment. Three components are valid.
    pub moment: Option<Coordinates>,
}

/// `[sweep]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sweep {
    /// Method of sampling.
    pub method: Option<Text>,
    /// Number of samples.
    pub samples: Option<Whole>,
    /// Seed of the samples.
    pub seed: Option<Whole>,
    /// Variables of the sweep.
    pub variables: Option<Spanned<Vec<Spanned<SweepVariable>>>>,
    /// Path of a CSV file with the designs. An alternative to `variables`.
    pub designs: Option<Text>,
    /// True if the curves of every design are kept.
    pub curves: Option<bool>,
    /// `csv` or `parquet`.
    pub format: Option<Text>,
}

/// An element of `variables` of `[sweep]`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SweepVariable {
    /// Name of the hardpoint that moves.
    pub hardpoint: Option<Text>,
    /// Names of several hardpoints that move together.
    pub hardpoints: Option<Spanned<Vec<Text>>>,
    /// Displacement of each coordinate per unit of the variable.
    pub factors: Option<Spanned<Vec<Number>>>,
    /// Name of a bushing whose stiffness varies.
    pub bushing: Option<Text>,
    /// Axis of the bushing's stiffness: `x`, `y`, `z`, `tx`, `ty` or `tz`.
    pub stiffness: Option<Text>,
    /// Name of a link with axial stiffness.
    pub link: Option<Text>,
    /// Name of a part with one rate: `spring`, `anti_roll_bar`, `rack` or `column`.
    pub rate: Option<Text>,
    /// True if the values of a rate are factors.
    pub relative: Option<Spanned<bool>>,
    /// `x`, `y` or `z`.
    pub axis: Option<Text>,
    /// Lowest and highest value. Two numbers are valid.
    pub range: Spanned<Vec<Number>>,
    /// Number of values in a grid.
    pub steps: Option<Whole>,
    /// True if the values are coordinates instead of offsets.
    pub absolute: Option<Spanned<bool>>,
    /// Name of the variable's column.
    pub name: Option<Text>,
}

/// `[optimise]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Optimise {
    /// Name of the method.
    pub method: Option<Text>,
    /// Number of starts.
    pub starts: Option<Whole>,
    /// Seed of the starts.
    pub seed: Option<Whole>,
    /// Largest number of iterations.
    pub max_iterations: Option<Whole>,
    /// Misfit that is good enough. Below it, the tuning prefers the nearer design.
    pub good_enough: Option<Number>,
    /// True if the targets are measurements.
    pub fit: Option<Spanned<bool>>,
    /// Number of builds of `[tolerance]` over which the misfit is averaged.
    pub scatter: Option<Whole>,
    /// Objective of a robust tuning: the misfit of the builds, or the share of builds within the bands.
    pub robust: Option<Text>,
    /// Names of the targets whose trade-off is traced.
    pub front: Option<Spanned<Vec<Text>>>,
    /// False if changes that no target asks for are not reported.
    pub side_effects: Option<Spanned<bool>>,
    /// Design variables.
    pub variables: Spanned<Vec<Spanned<Variable>>>,
    /// Targets.
    pub targets: Spanned<Vec<Spanned<Target>>>,
    /// Constraints.
    #[serde(default)]
    pub constraints: Vec<Spanned<Constraint>>,
}

/// An element of `variables`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Variable {
    /// Name of the hardpoint that moves.
    pub hardpoint: Option<Text>,
    /// Names of several hardpoints that move together.
    pub hardpoints: Option<Spanned<Vec<Text>>>,
    /// Names of several hardpoints that move as one rigid body.
    pub rigid: Option<Spanned<Vec<Text>>>,
    /// Name of a bushing whose stiffness varies.
    pub bushing: Option<Text>,
    /// Axis of the bushing's stiffness: `x`, `y`, `z`, `tx`, `ty` or `tz`.
    pub stiffness: Option<Text>,
    /// Name of a link with axial stiffness.
    pub link: Option<Text>,
    /// Name of a part with one rate: `spring`, `anti_roll_bar`, `rack` or `column`.
    pub rate: Option<Text>,
    /// True if the range of a rate is in factors.
    pub relative: Option<Spanned<bool>>,
    /// Displacement of each coordinate per unit of the variable.
    pub factors: Option<Spanned<Vec<Number>>>,
    /// Direction of the move: `x`, `y` or `z`.
    pub axis: Option<Text>,
    /// Direction of the move as a vector. An alternative to `axis`.
    pub direction: Option<Coordinates>,
    /// Lowest and highest offset. Two numbers are valid.
    pub range: Option<Spanned<Vec<Number>>>,
    /// Largest shift of a body along each axis, in both directions.
    pub shift: Option<Number>,
    /// Largest turn of a body about each axis, in both directions, in degrees.
    pub turn: Option<Number>,
    /// Cost of a move across the range, relative to other variables.
    pub cost: Option<Number>,
}

/// An element of `targets`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Target {
    /// In the study of a car, the load case of the target.
    pub case: Option<Text>,
    /// In the study of a car, the axle over whose own motion the target applies.
    pub axle: Option<Text>,
    /// Name of the characteristic.
    pub characteristic: Option<Text>,
    /// Name of a point.
    pub point: Option<Text>,
    /// Coordinate of the point.
    pub axis: Option<Text>,
    /// Name or ends of a member whose length is the target.
    pub length: Option<Spanned<MemberName>>,
    /// Name of a force under a load.
    pub load: Option<Text>,
    /// Name of a result of a `kc` test.
    pub figure: Option<Text>,
    /// Curve: pairs of drive value and target value.
    pub points: Option<Spanned<Vec<Spanned<Vec<Number>>>>>,
    /// Path of a CSV file with a curve.
    pub file: Option<Text>,
    /// Column of the values in this file.
    pub column: Option<Text>,
    /// Single drive value.
    pub at: Option<Number>,
    /// Target value at the single drive value.
    pub value: Option<Number>,
    /// Lower and upper limit.
    pub between: Option<Spanned<Vec<LimitText>>>,
    /// Lower limit.
    pub at_least: Option<Spanned<LimitText>>,
    /// Upper limit.
    pub at_most: Option<Spanned<LimitText>>,
    /// For an axle, the coordinate of the motion over which the curve runs.
    pub over: Option<Text>,
    /// For an axle, the wheel to which the target applies.
    pub side: Option<Text>,
    /// For an axle, the roll angle at which the target applies, or several.
    pub roll: Option<Spanned<Numbers>>,
    /// For an axle, the heave at which the target applies, or several.
    pub heave: Option<Spanned<Numbers>>,
    /// For an axle, the travel of the left wheel at which the target applies, or several.
    pub travel_left: Option<Spanned<Numbers>>,
    /// For an axle, the travel of the right wheel at which the target applies, or several.
    pub travel_right: Option<Spanned<Numbers>>,
    /// For an axle, the angle of the steering wheel at which the target applies, or several.
    pub steering_wheel_angle: Option<Spanned<Numbers>>,
    /// Rack displacement at which the target applies, or several.
    pub rack: Option<Spanned<Numbers>>,
    /// Name of a motion.
    pub motion: Option<Text>,
    /// Deviation that is still acceptable.
    pub tolerance: Number,
    /// Weight relative to the other targets.
    pub weight: Option<Number>,
    /// `linear` or `monotone_cubic`.
    pub interpolation: Option<Text>,
}

/// `[setup]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Setup {
    /// Adjustments.
    pub adjust: Spanned<Vec<Spanned<Adjustment>>>,
    /// Target static values by characteristic.
    pub want: Option<BTreeMap<Text, Number>>,
    /// Target change of the ride height, positive if the car becomes higher. An alternative is `travel`.
    pub ride_height_change: Option<Number>,
    /// Wheel travel of the new static position, the negative of `ride_height_change`. An alternative to it.
    pub travel: Option<Number>,
}

/// An element of `adjust`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Adjustment {
    /// Member with an adjustable length. An alternative is `shim`.
    pub length: Option<Spanned<MemberName>>,
    /// Hardpoint that shims move. An alternative to `length`.
    pub shim: Option<Text>,
    /// Direction in which shims move the hardpoint.
    pub axis: Option<Text>,
    /// Change of length per turn, of both threads together.
    pub per_turn: Option<Number>,
    /// Thickness of the thinnest shim.
    pub step: Option<Number>,
    /// Only half of a solid axle whose part is adjusted.
    pub side: Option<Text>,
}

/// `[tolerance]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tolerance {
    /// Number of builds.
    pub builds: Option<Whole>,
    /// Seed of the builds.
    pub seed: Option<Whole>,
    /// True if toe and camber are set again after assembly.
    pub aligned: Option<Spanned<bool>>,
    /// Dimensions that scatter.
    pub scatter: Spanned<Vec<Spanned<Scatter>>>,
    /// Limits for the builds.
    pub bands: Option<Vec<Spanned<Band>>>,
}

/// An element of `scatter`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scatter {
    /// Name of a hardpoint.
    pub hardpoint: Option<Text>,
    /// Names of several hardpoints that scatter independently.
    pub hardpoints: Option<Spanned<Vec<Text>>>,
    /// Name of a member whose length scatters.
    pub length: Option<Spanned<MemberName>>,
    /// Names of hardpoints that a jig moves together.
    pub jig: Option<Spanned<Vec<Text>>>,
    /// Name of a bushing whose stiffness scatters.
    pub bushing: Option<Text>,
    /// Axis of the bushing's stiffness: `x`, `y`, `z`, `tx`, `ty` or `tz`.
    pub stiffness: Option<Text>,
    /// Name of a link with axial stiffness.
    pub link: Option<Text>,
    /// Name of a part with one rate: `spring`, `anti_roll_bar`, `rack` or `column`.
    pub rate: Option<Text>,
    /// True if the scatter of a rate is relative to the rate.
    pub relative: Option<Spanned<bool>>,
    /// For an axle, the only wheel whose parts scatter.
    pub side: Option<Text>,
    /// The only coordinate that scatters.
    pub axis: Option<Text>,
    /// Standard deviation of a normal scatter.
    pub sigma: Option<Number>,
    /// Ends of a uniform scatter.
    pub limits: Option<Spanned<Vec<Number>>>,
    /// Standard deviation of each component of a jig's shift.
    pub shift: Option<Number>,
    /// Standard deviation of each component of a jig's turn, degrees.
    pub turn: Option<Number>,
}

/// An element of `bands`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Band {
    /// Name of the characteristic.
    pub characteristic: Text,
    /// Position in the motion at which the band applies. The default is the whole motion.
    pub at: Option<Number>,
    /// For an axle, the coordinate of the motion to which `at` refers.
    pub over: Option<Text>,
    /// For an axle, the wheel to which the band applies.
    pub side: Option<Text>,
    /// For an axle, the roll angle at which the band applies, or several.
    pub roll: Option<Spanned<Numbers>>,
    /// For an axle, the heave at which the band applies, or several.
    pub heave: Option<Spanned<Numbers>>,
    /// For an axle, the travel of the left wheel at which the band applies, or several.
    pub travel_left: Option<Spanned<Numbers>>,
    /// For an axle, the travel of the right wheel at which the band applies, or several.
    pub travel_right: Option<Spanned<Numbers>>,
    /// For an axle, the angle of the steering wheel at which the band applies, or several.
    pub steering_wheel_angle: Option<Spanned<Numbers>>,
    /// Rack displacement at which the band applies, or several.
    pub rack: Option<Spanned<Numbers>>,
    /// Lowest and highest value.
    pub between: Option<Spanned<Vec<Number>>>,
    /// Lowest value, if there is no highest value.
    pub at_least: Option<Number>,
    /// Highest value, if there is no lowest value.
    pub at_most: Option<Number>,
}

/// An element of `constraints`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Constraint {
    /// In the study of a car, the load case of the constraint.
    pub case: Option<Text>,
    /// In the study of a car, the axle to which the constraint applies.
    pub axle: Option<Text>,
    /// Name of the constraint.
    pub name: Option<Text>,
    /// Length of a member, or distance between two points.
    pub length: Option<Spanned<MemberName>>,
    /// Name of a point.
    pub point: Option<Text>,
    /// Two members that must stay apart, or members that must stay inside of the rim.
    pub members: Option<Spanned<Vec<Text>>>,
    /// Name of a joint whose angle is limited.
    pub articulation: Option<Text>,
    /// Length that may change along the motion: of a member, or between two points.
    pub plunge: Option<Spanned<MemberName>>,
    /// Name of a characteristic.
    pub characteristic: Option<Text>,
    /// Name of a force under a load.
    pub load: Option<Text>,
    /// Points that must lie in one plane.
    pub coplanar: Option<Spanned<Vec<Text>>>,
    /// Points that must lie on one line.
    pub line: Option<Spanned<Vec<Text>>>,
    /// Lower and upper limit.
    pub between: Option<Spanned<Vec<Number>>>,
    /// Lower limit.
    pub at_least: Option<Number>,
    /// Upper limit.
    pub at_most: Option<Number>,
    /// True if a length must keep its design value.
    pub kept: Option<Spanned<bool>>,
    /// Region in which a point must stay.
    pub inside: Option<Spanned<Region>>,
    /// Region that a point must not enter.
    pub outside: Option<Spanned<Region>>,
    /// Smallest distance.
    pub clearance: Option<Number>,
    /// Radii of the members.
    pub radii: Option<Spanned<Vec<Number>>>,
    /// `design` if the constraint applies to the design position only.
    pub at: Option<Text>,
    /// Rack displacement at which the constraint applies, or several.
    pub rack: Option<Spanned<Numbers>>,
    /// Name of a motion.
    pub motion: Option<Text>,
    /// For the motion of an axle, the only wheel to which the constraint applies.
    pub side: Option<Text>,
}

/// A region. It has one of these shapes.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Region {
    /// Box with two opposite corners.
    #[serde(rename = "box")]
    pub corners: Option<Spanned<Vec<Coordinates>>>,
    /// Half-space on the side to which a normal points.
    pub half_space: Option<HalfSpace>,
    /// Sphere.
    pub sphere: Option<Sphere>,
    /// Cylinder with closed ends.
    pub cylinder: Option<Cylinder>,
    /// Radius of the inner space of the rim, about the spin axis.
    pub rim: Option<Number>,
    /// Start of the rim's space, as distance outboard of the wheel centre.
    pub from: Option<Number>,
    /// End of the rim's space, as distance outboard of the wheel centre.
    pub to: Option<Number>,
}

/// `half_space`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HalfSpace {
    /// Point on the boundary plane.
    pub point: Coordinates,
    /// Normal of the plane. It points into the region.
    pub normal: Coordinates,
}

/// `sphere`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sphere {
    /// Centre of the sphere.
    pub centre: Coordinates,
    /// Radius of the sphere.
    pub radius: Number,
}

/// `cylinder`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cylinder {
    /// First end of the axis.
    pub from: Coordinates,
    /// Second end of the axis.
    pub to: Coordinates,
    /// Radius of the cylinder.
    pub radius: Number,
}
