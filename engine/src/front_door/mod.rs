//! The front door for Rust programs: a suspension from numbers, its pose at a travel, curves, sweeps, tuning.
//!
//! A [`Suspension`] comes from [`Suspension::builder`] or out of a study. [`Suspension::pose_at`] answers for one
//! place of the wheel. Everything else is a [`Study`] made of it by [`Study::of`]: it says over which [`Motion`],
//! of which characteristics, what may move and what is wanted, and then answers [`Study::curves`],
//! [`Study::sweep`] and [`Study::tune`]. Nothing here needs a text or a file, and nothing is computed here: these are
//! the same objects and the same code that the commands use.
//!
//! Figures are in the units of the column names (degrees, the suspension's length unit) and in the suspension's axes.

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
