//! The study file as written: its sections and keys. Unknown keys are refused.
//!
//! Names are still texts, and numbers are in the file's units and axes. Each value that may be faulty has its
//! position in the file. `flatten` and tagged enums are not used, because they lose these positions.

mod compliance;
mod constraint;
mod motion;
mod optimise;
mod outputs;
mod springs;
mod suspension;
mod tolerance;
mod vehicle;

use crate::value::{Number, Text};
use serde::Deserialize;
use std::collections::BTreeMap;
use toml::Spanned;

pub use compliance::{Bushing, BushingCurve, Compliance, ComplianceTest, LinkStiffness, Subframe};
pub use constraint::{Constraint, Cylinder, HalfSpace, Region, Sphere};
pub use motion::{Motion, Solver, Time};
pub use optimise::{Optimise, Sweep, SweepVariable, Target, Variable};
pub use outputs::{Load, Outputs};
pub use springs::{BumpStop, HeaveBar, HeaveSpring, Rate, Spring, TwistBeam, Tyre};
pub use suspension::{ExtraPoint, Suspension, Wheel};
pub use tolerance::{Adjustment, Band, Scatter, Setup, Tolerance};
pub use vehicle::{Axle, OwnAngles, OwnBushing, OwnRight, Steering, Vehicle};

/// Coordinates. This type accepts any number of values, but only three are valid.
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
