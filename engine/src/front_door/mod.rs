//! Interface for Rust programs: makes a suspension from numbers, and computes its pose at a travel, curves, sweeps and
//! tunings.
//!
//! A [`Suspension`] comes from [`Suspension::builder`] or from a study. [`Suspension::pose_at`] computes one pose of the
//! wheel. For all other results, [`Study::of`] makes a [`Study`] of the suspension. The study holds the [`Motion`], the
//! requested characteristics, the variables and the targets. Its methods are [`Study::curves`], [`Study::sweep`] and
//! [`Study::tune`]. No text or file is needed. The commands of `hardpoint` use the same objects and the same code.
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
