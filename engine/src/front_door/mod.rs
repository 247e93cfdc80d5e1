//! Interface for Rust programs: a suspension from numbers, its pose at a travel, curves, sweeps, tuning.
//!
//! A [`Suspension`] comes from [`Suspension::builder`] or from a study. [`Suspension::pose_at`] computes one pose of the
//! wheel. For everything else, [`Study::of`] makes a [`Study`] of it. The study holds the [`Motion`], the requested
//! characteristics, the variables and the targets. Its methods are [`Study::curves`], [`Study::sweep`] and [`Study::tune`].
//! No text or file is needed. The commands use the same objects and the same code.
//!
//! Numbers are in the units of the column names (degrees, the suspension's length unit) and in the suspension's axes.

mod ask;
mod build;
mod error;
mod pose;
mod run;

pub use error::Error;
pub use pose::SuspensionPose;
pub use run::SweepControl;

#[cfg(doc)]
use crate::{Motion, Study, Suspension};
