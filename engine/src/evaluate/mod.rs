//! Evaluates quantities of many designs at stations, for one wheel or for an axle.
//!
//! A `Request` names the vehicle, the quantities and the stations. An [`Evaluator`] fills a [`Block`] with the values of
//! designs. It uses SIMD lanes for designs that the tracker accepts, and solves all other designs one by one. A
//! [`GradientEvaluator`] computes values with their gradients with respect to the hardpoints ([`Evaluated`]). The values of a
//! design depend only on this design, never on its neighbours.

mod aligned;
mod axle;
mod axle_gradients;
mod axle_lanes;
mod block;
mod elastic;
mod elastic_axle;
mod elastic_lanes;
mod evaluator;
mod gradient_evaluator;
mod gradients_one_by_one;
mod lane_gradients;
mod lanes;
mod one_by_one;
mod rate_slopes;
mod request;
mod stations;

pub(crate) use axle::AxleStations;
pub use block::{BLOCK, Block, FailedStation};
pub(crate) use elastic::{ElasticQuantities, ElasticRead};
pub(crate) use elastic_axle::ElasticAxleParts;
pub use evaluator::{Evaluator, Pairs};
pub(crate) use gradient_evaluator::along;
pub use gradient_evaluator::{Evaluated, GradientEvaluator};
pub use lane_gradients::{AngleTarget, Deviations, Gradients, Jacobians};
pub use lanes::NotInLanes;
pub(crate) use lanes::scatter;
pub(crate) use request::Request;
pub use stations::Stations;
pub(crate) use stations::index_or_push;
