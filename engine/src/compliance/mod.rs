//! Elasto-kinematics of a wheel: equilibrium with bushings and elastic links, and its derivatives with respect to loads.
//!
//! Elastic suspensions have these bodies: the wheel carrier, arms on bushings, links with bushings, the mount of a
//! strut, and the rocker of a spring. An axle also has a rack, a subframe and an anti-roll bar. Rods can have axial
//! stiffness. All other parts are rigid. The state has the displacements of the bodies from the design position.
//! Deflections are computed from these displacements (`algebra.rs`), not as differences of coordinates. The program
//! eliminates the parts between body and carrier one by one (`limb.rs`, `swinging.rs`, `floating.rs`, `parts.rs`). A
//! system of at most twelve equations remains for a wheel or a solid axle (`system.rs`). Newton's method solves it, if
//! necessary with a gradual increase of the loads (`solve.rs`). The formulas work with numbers that carry derivatives,
//! so the same code gives derivatives with respect to loads, travel, rack and design.

mod algebra;
mod axle;
mod build;
mod bushing;
mod carried;
mod characteristics;
mod coupling;
mod definition;
mod derivatives;
mod ends;
mod fault;
mod floating;
mod gather;
mod ground;
mod inputs;
mod kc;
mod lanes;
mod law;
mod legs;
mod limb;
mod loads;
mod map;
mod parts;
mod point;
mod preload;
mod reading;
mod readings;
mod rod_turn;
mod solve;
mod swinging;
mod system;
mod wheel;

pub use axle::{
    AxleChange, AxleCompliance, AxleEquilibrium, AxleOnTape, AxlePlace, AxleTangent, AxleWay,
    ElasticAxle, SteeringColumn,
};
pub(crate) use carried::{CarriedForces, ElasticMember};
pub use characteristics::not_of_equilibrium;
pub use definition::{
    AxialStiffness, BushingPart, Compliance, LinkMember, LinkPart, Relaxed, Subframe,
    SubframeMount, bushing_points, link_members,
};
pub use derivatives::Tangent;
pub use ends::{DrivingForce, EndCause, EquilibriumEnd, Event, LARGEST_FORCE};
pub use fault::{AxleFault, ElasticFault, Lack, Motion, NoEquilibrium};
pub(crate) use inputs::NOT_ABOVE_ZERO;
pub use inputs::{AxleParameter, OnTape, Parameter};
pub(crate) use kc::{AxleFigure, Conditions, Here};
pub use kc::{
    AxleKcRun, AxleVehicle, FigureGradients, KcAxleState, KcFigure, KcGradient, KcLevel, KcOutcome,
    KcRun, KcState, KcStation, KcSubject, KcTest, KcValue, KcWheelState, TestLoad, TestMode,
    TestPlace, figure_and_keys, figure_names, figures_by, follows_y_axis, is_figure_of_axles,
    is_steer_to_left, loads_of_figure, quantities, sign_of_figure,
};
pub(crate) use lanes::{EquilibriaInLanes, LaneMemory, WheelsInLanes};
pub use law::Shape;
pub use loads::WheelLoads;
pub use reading::WheelFigures;
pub use wheel::{BushingReading, Change, ElasticWheel, Equilibrium, HeldQuantity, SpringReading};
