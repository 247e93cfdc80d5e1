//! Study files of `hardpoint` as written: sections, keys, values with their positions, and errors with the lines that contain
//! them.
//!
//! This crate makes a [`file::File`] (a wheel or an axle) or a [`car_file::CarFile`] (a car) from a text. `hardpoint-engine` makes
//! a study from that file: it checks the meaning of names and the combinations of values. Both crates report errors with
//! [`error`]. This crate contains nothing about suspensions, so it need not be compiled again when a formula changes. Serde's
//! code for a hundred keys is then compiled only once.
//!
//! | module | content |
//! |---|---|
//! | [`bushing_file`] | property files of bushings |
//! | [`mod@file`], [`car_file`], [`value`] | sections and keys, and their possible values |
//! | [`parse`] | from text to the file, with the parser's messages in plain words |
//! | [`overrides`] | `--set path=value` |
//! | [`error`] | errors with file, line, key and help |
//! | [`names`] | look-up of names, and suggestions for misspelt ones |
//! | [`source`] | texts from disk |
//! | [`dimension`] | units and directions of every number |
//! | [`schema`] | JSON schema of studies, derived from the code that parses them |

// This crate prints nothing; only commands print.
#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr))]
#![warn(clippy::allow_attributes_without_reason, unreachable_pub)]

pub mod bushing_file;
pub mod car_file;
pub mod dimension;
pub mod error;
pub mod file;
pub mod names;
pub mod overrides;
pub mod parse;
pub mod schema;
pub mod source;
mod syntax;
pub mod value;
