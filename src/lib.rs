//! Exact suspension kinematics with analytic derivatives, and the tuning of hardpoints.
//!
//! A suspension is given by its *hardpoints*, the points its arms, struts and rods hang on. This crate
//! solves the mechanism exactly for any wheel travel, arm angle and rack displacement, differentiates
//! everything it finds by travel, by time and by every hardpoint coordinate without a single difference
//! quotient, and moves hardpoints within bounds until camber, kingpin and other curves are the ones asked
//! for.
//!
//! # Conventions
//!
//! Inside the crate there is one frame: a left wheel, x forward, y left (outboard), z up (ISO 8855).
//! Right-hand wheels and other axis conventions differ by the signs of coordinates and are mapped at the
//! edges by [`model::Frame`]. Lengths are in the study's unit, whatever it is; angles are in radians
//! but where names say `deg`. Travel is the height of the wheel centre above its design position, jounce
//! positive. Signs of characteristics are stated in their catalogue, [`characteristics`].
//!
//! A derivative by a hardpoint coordinate moves the *design*: lengths and the shape of the knuckle are
//! recomputed, the value of the drive is held.
//!
//! # Map
//!
//! Data goes one way, from a study to its results:
//!
//! | module | what |
//! |---|---|
//! | [`study`] | the file as written, what it means, everything that can be wrong with it |
//! | [`model`] | hardpoints, bodies, constraints; one file for each topology |
//! | [`mechanism`] | a design in a pose, the constraint rows that hold it, why there may be no pose |
//! | [`mod@derive`] | derivatives of a pose by the drive, by the rack, by every hardpoint coordinate |
//! | [`solve`] | poses connected to the design position, one design at a time or many side by side |
//! | [`analyse`] | limits, loads, assemblies, certificates |
//! | [`attia`] | the seed paper's fifteen equations, its drive and its angles |
//! | [`build`] | mechanisms as they are built: points of the body, lengths and shapes of parts, each off by a little |
//! | [`plan`] | what a study asks for, turned into what is computed |
//! | [`characteristics`] | the catalogue of wheel characteristics, a formula each |
//! | [`curves`] | a plan carried out over a motion |
//! | [`mod@evaluate`] | quantities at stations with their gradients, of several designs at a time |
//! | [`axle`] | both wheels: roll on a plane ground, steering, springs |
//! | [`sweep`] | many designs on all cores, in constant memory |
//! | [`optimise`] | targets as bounded least squares, and their minimum |
//! | [`tolerance`] | what manufacturing scatter does, and which tolerance is worth money |
//! | [`report`] | files and tables |
//! | [`results`] | directories of results: who may replace what, locks |
//! | [`exchange`] | points and curves from and to spreadsheets and Adams/Car |
//! | [`studio`] | the live page: a server on this machine that follows dragged points |
//! | [`mod@bench`] | poses per second, what a digit and an effect cost on this machine |
//! | [`cli`] | the command line |
//! | [`number`] | Taylor series, gradients and SIMD registers as numbers: how one formula serves for all derivatives and lanes |
//!
//! # Example
//!
//! ```
//! use hardpoint::{curves::curves, model::Topology, plan::Plan, study::Study};
//! use std::path::Path;
//!
//! let template = Topology::named("macpherson").unwrap().template;
//! let study = Study::from_text("mine.toml", template, Path::new("."))?;
//! let plan = Plan::of(&study);
//! let curves = curves(&study.suspension, &plan).expect("the template can be solved");
//! assert_eq!(curves.columns[0].name, "camber_deg");
//! let full_jounce = curves.stations.last().unwrap();
//! println!("camber at {:?}: {:?}", full_jounce.travel, full_jounce.values[0]);
//! # Ok::<(), hardpoint::study::StudyErrors>(())
//! ```

pub mod analyse;
pub mod attia;
pub mod axle;
pub mod bench;
pub mod build;
pub mod characteristics;
pub mod cli;
pub mod curves;
pub mod derive;
pub mod evaluate;
pub mod exchange;
mod front_door;
mod function;
mod linear;
pub mod mechanism;
pub mod model;
pub mod number;
pub mod optimise;
pub mod plan;
pub mod report;
pub mod results;
pub mod solve;
pub mod studio;
pub mod study;
pub mod sweep;
pub mod tolerance;

pub use characteristics::Characteristic;
pub use curves::{Column, Curves, Station, Status};
pub use front_door::{Error, SuspensionPose, SweepControl};
pub use function::{DesignFunction, DesignStatus, DesignVariable, Evaluation, FunctionError};
pub use mechanism::{BuildError, SuspensionBuilder};
pub use model::{Axis, FrameConvention, LengthUnit, Side, Suspension, Topology, Vehicle};
pub use nalgebra;
pub use optimise::{Control, Tuning};
pub use study::{Motion, Order, Sampling, Study, StudyErrors, Target, Variable};
pub use sweep::Rows;
