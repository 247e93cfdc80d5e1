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
//! edges by [`Frame`]. Lengths are in the study's unit, whatever it is; angles are in radians
//! but where names say `deg`. Travel is the height of the wheel centre above its design position, jounce
//! positive. Signs of characteristics are stated in their catalogue ([`Characteristic::info`]).
//!
//! A derivative by a hardpoint coordinate moves the *design*: lengths and the shape of the knuckle are
//! recomputed, the value of the drive is held.
//!
//! # The front door
//!
//! What a program embeds is at the root of the crate: [`Suspension::builder`] makes a suspension from numbers and
//! says what is wrong with them, [`Suspension::pose_at`] answers for one place of the wheel, and a [`Study`] made by
//! [`Study::of`] holds what is asked and answers [`Study::curves`], [`Study::sweep`] and [`Study::tune`].
//! [`DesignFunction`] is the same as a function with an exact Jacobian, for optimisers of one's own. All errors
//! implement [`std::error::Error`].
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
//! let camber = full_jounce.characteristic(Characteristic::Camber).expect("every wheel has one");
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
//! Inside, data goes one way, from a study to its results. What is public is at the root of the crate; the rooms
//! behind it are documented at the head of their files and may change with every version. What computes is a crate
//! of its own in `engine` (`hardpoint-engine`), which knows nothing of files of results, pages and commands, and has the
//! keys of studies and the words for what is wrong with them from another, in `study-file` (`hardpoint-study-file`):
//!
//! | module of `engine` | what |
//! |---|---|
//! | `study` | what the file means, everything that can be wrong with it |
//! | `model` | hardpoints, bodies, constraints; one file for each topology |
//! | `mechanism` | a design in a pose, the constraint rows that hold it, why there may be no pose |
//! | `derive` | derivatives of a pose by the drive, by the rack, by every hardpoint coordinate |
//! | `solve` | poses connected to the design position, one design at a time or many side by side |
//! | `analyse` | limits, loads, assemblies, certificates |
//! | `assembly` | mechanisms as they are built: points of the body, lengths and shapes of parts, each off by a little |
//! | `plan` | what a study asks for, turned into what is computed |
//! | `characteristics` | the catalogue of wheel characteristics, a formula each |
//! | `curves` | a plan carried out over a motion |
//! | `evaluate` | quantities at stations with their gradients, of several designs at a time |
//! | `axle` | both wheels: roll on a plane ground, steering, springs |
//! | `sweep` | many designs on all cores, in constant memory |
//! | `optimise` | targets as bounded least squares, and their minimum |
//! | `tolerance` | what manufacturing scatter does, and which tolerance is worth money |
//! | `linear` | one elimination with its series, for every number of unknowns |
//! | `threads` | pools of threads with stacks that are large enough |
//! | `number` | Taylor series, gradients and SIMD registers as numbers: how one formula serves for all derivatives and lanes |
//!
//! Two more crates stand beside the engine: `attia` (`hardpoint-attia`) has the fifteen equations of Attia's paper as a
//! formulation, which the program registers; `bench` (`hardpoint-bench`) measures poses per second, the cost of a digit
//! and of an effect on this machine.
//!
//! What is made of it is here:
//!
//! | module | what |
//! |---|---|
//! | `drawing` | what a page shows beside the curves, solved before it is made |
//! | `checked` | a study checked: its curves, doubts, stations that are not solved |
//! | `assembled`, `compared`, `scatter` | assemblies, comparisons and builds, in memory |
//! | `solved` | a study's curves, of one wheel or of both, and what is made of them |
//! | `report` | files, tables, pages |
//! | `results` | directories of results: who may replace what, locks |
//! | `exchange` | points and curves from and to spreadsheets, CAD and other tools |
//! | `studio` | the live page: a server on this machine that follows dragged points |
//! | `cli` | the command line |

// What a command says goes through `cli::terminal`, which knows of pipes, widths and colours.
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
pub mod report;
#[doc(hidden)]
pub mod results;
#[doc(hidden)]
pub mod scatter;
#[doc(hidden)]
pub mod solved;
#[doc(hidden)]
pub mod studio;

// By the same names: what is public, and the rooms of the engine for those here.
#[doc(inline)]
pub use hardpoint_engine::*;

#[doc(hidden)]
pub use hardpoint_attia as attia;
#[doc(hidden)]
pub use hardpoint_bench as bench;

/// The example of the manual's page is run.
#[cfg(doctest)]
#[doc = include_str!("../docs/rust.md")]
struct Manual;
