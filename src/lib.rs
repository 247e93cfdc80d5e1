//! Exact suspension kinematics with analytic derivatives, and the tuning of hardpoints.
//!
//! *Hardpoints* define a suspension: the points at which its arms, struts and rods are attached. This crate solves the mechanism
//! exactly for any wheel travel, arm angle and rack displacement. It differentiates all results with respect to travel, time and
//! every hardpoint coordinate, without difference quotients. It moves hardpoints within bounds until camber, kingpin inclination
//! and other curves meet their targets.
//!
//! # Conventions
//!
//! Internally, the crate uses one frame: a left wheel, x forward, y left (outboard), z up (ISO 8855). Right wheels and other axis
//! conventions differ by signs of coordinates, and [`Frame`] converts them on input and output. Lengths are in the study's unit.
//! Angles are in radians, except where names say `deg`. Travel is the height of the wheel centre above its design position,
//! positive in jounce. The catalogue states the signs of characteristics ([`Characteristic::info`]).
//!
//! A derivative with respect to a hardpoint coordinate moves the *design*: lengths and the shape of the knuckle are recomputed,
//! and the value of the drive (wheel travel or an angle) stays constant.
//!
//! # Public interface
//!
//! The interface for other programs is at the root of the crate. [`Suspension::builder`] makes a suspension from numbers
//! and reports mistakes. [`Suspension::pose_at`] solves one position of the wheel. [`Study::of`] makes a [`Study`] that
//! holds the requests for [`Study::curves`], [`Study::sweep`] and [`Study::tune`]. [`DesignFunction`] is a function with an
//! exact Jacobian for your own optimiser. All errors implement [`std::error::Error`].
//!
//! ```
//! use hardpoint::{Characteristic, Motion, Order, Study, Suspension};
//!
//! let suspension = Suspension::builder("double_wishbone")
//!     .hardpoint("lower_arm_front", [150.0, 350.0, 150.0])
//!     .hardpoint("lower_arm_rear", [-150.0, 350.0, 155.0])
//!     .hardpoint("lower_ball_joint", [0.0, 700.0, 140.0])
//!     .hardpoint("upper_arm_front", [100.0, 400.0, 430.0])
//!     .hardpoint("upper_arm_rear", [-120.0, 400.0, 425.0])
//!     .hardpoint("upper_ball_joint", [-20.0, 660.0, 450.0])
//!     .hardpoint("tie_rod_inner", [-120.0, 340.0, 200.0])
//!     .hardpoint("tie_rod_outer", [-130.0, 680.0, 205.0])
//!     .hardpoint("wheel_centre", [0.0, 750.0, 300.0])
//!     .static_angles_deg(-1.0, 0.1)
//!     .build()?;
//! let full_jounce = suspension.pose_at(40.0, 0.0)?;
//! let camber = full_jounce.characteristic(Characteristic::Camber).expect("every wheel has a camber");
//!
//! let study = Study::of(suspension)
//!     .over(Motion::travel(-40.0..=40.0, 17)?)
//!     .asking(&[Characteristic::Camber, Characteristic::Toe], Order::Velocity)?;
//! let curves = study.curves()?;
//! assert_eq!(curves.columns[1].name, "camber_d1_deg_per_mm");
//! assert!((curves.stations[16].values[0].unwrap() - camber).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Map
//!
//! Data flows in one direction, from a study to its results. Public items are at the root of the crate. The modules behind them
//! are documented at the head of their files and may change with every version. The numerics are in a separate crate, `engine`
//! (`hardpoint-engine`), without result files, pages and commands. The keys of studies and the error messages come from another
//! crate, in `study-file` (`hardpoint-study-file`). `ARCHITECTURE.md` describes the whole project.
//!
//! | module of `engine` | content |
//! |---|---|
//! | `study` | the meaning of a study file, and its mistakes |
//! | `model` | hardpoints, bodies, constraints; one file for each topology |
//! | `mechanism` | a design in a pose, its constraint equations, the reasons for a missing pose |
//! | `derive` | derivatives of a pose with respect to the drive, the rack and every hardpoint coordinate |
//! | `solve` | poses connected to the design position, one design at a time or many side by side |
//! | `analyse` | limits, loads, assemblies, certificates |
//! | `assembly` | builds: mechanisms whose points, lengths and part shapes have deviations |
//! | `plan` | the computations that a study needs |
//! | `characteristics` | the catalogue of wheel characteristics, with one formula for each |
//! | `curves` | the outputs of a plan over a motion |
//! | `evaluate` | quantities at stations with their gradients, of several designs at a time |
//! | `axle` | both wheels: roll on a plane ground, steering, springs |
//! | `compliance` | bushings and elastic links: equilibria under load |
//! | `car` | two axles and a body: equilibria of load cases |
//! | `sweep` | many designs on all cores, in constant memory |
//! | `optimise` | targets as bounded least squares, and their minimum |
//! | `side_effects` | changes of a tuned design that no target requests |
//! | `tolerance` | effects of manufacturing scatter, and their contributors |
//! | `linear` | elimination with series, for every number of unknowns |
//! | `threads` | thread pools with large stacks |
//! | `number` | Taylor series, gradients and SIMD registers as numbers, for formulas with derivatives or with several poses at once |
//!
//! Two more crates use the engine: `attia` (`hardpoint-attia`) has the fifteen equations of Attia's paper as a formulation,
//! which the program registers. `bench` (`hardpoint-bench`) measures on this machine: poses per second, the time for a number
//! of correct digits, and the time for each requested result.
//!
//! This crate has the modules that show results:
//!
//! | module | content |
//! |---|---|
//! | `drawing` | drawings of a page, solved in advance |
//! | `in_motions` | curves over the named motions of a study |
//! | `set_up`, `rig` | set-ups, and the tests of `kc` |
//! | `checked` | a checked study: curves, warnings, and stations that are not solved |
//! | `assembled`, `compared`, `scatter` | assemblies, comparisons and builds, in memory |
//! | `solved` | curves of a study, of one wheel or of both, with their files, tables and remarks |
//! | `yields` | yields of builds, before and after a robust tuning |
//! | `limits` | limits of the mechanism, as a table; nearest limits of builds |
//! | `report` | files, tables, pages |
//! | `results` | directories of results: rules for replacing files, locks |
//! | `exchange` | points and curves from and to spreadsheets, CAD and other tools |
//! | `studio` | the live page: a server on this machine that solves dragged points |
//! | `cli` | the command line |

// Commands print through `cli::terminal`, which handles pipes, widths and colours.
#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr))]
#![warn(clippy::allow_attributes_without_reason, unreachable_pub)]

#[doc(hidden)]
pub mod assembled;
#[doc(hidden)]
pub mod checked;
#[doc(hidden)]
pub mod cli;
#[doc(hidden)]
pub mod compared;
#[doc(hidden)]
pub mod drawing;
#[doc(hidden)]
pub mod exchange;
#[doc(hidden)]
pub mod in_motions;
#[doc(hidden)]
pub mod limits;
#[doc(hidden)]
pub mod report;
#[doc(hidden)]
pub mod results;
#[doc(hidden)]
pub mod rig;
#[doc(hidden)]
pub mod scatter;
#[doc(hidden)]
pub mod set_up;
#[doc(hidden)]
pub mod solved;
#[doc(hidden)]
pub mod studio;
#[doc(hidden)]
pub mod yields;

// Public items and modules of the engine, with the same names.
#[doc(inline)]
pub use hardpoint_engine::*;

#[doc(hidden)]
pub use hardpoint_attia as attia;
#[doc(hidden)]
pub use hardpoint_bench as bench;

/// Runs the example in the manual as a doc test.
#[cfg(doctest)]
#[doc = include_str!("../docs/rust.md")]
struct Manual;
