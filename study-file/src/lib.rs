//! Study files of `hardpoint` as written: sections, keys, values with their places, and mistakes shown in their lines.
//!
//! A file becomes a [`file::File`] here and a study in `hardpoint-engine`, which knows what names mean and what fits
//! together; both say what is wrong by way of [`error`]. Nothing here knows of suspensions, so a changed formula leaves
//! it as it is: what serde makes of a hundred keys is compiled once.
//!
//! | module | what |
//! |---|---|
//! | [`bushing_file`] | property files of bushings |
//! | [`mod@file`], [`value`] | the sections and keys, and what may stand there |
//! | [`parse`] | from text to the file, the parser's messages in plain words |
//! | [`overrides`] | `--set path=value` |
//! | [`error`] | mistakes with file, line, key and help |
//! | [`names`] | look-up of names, and suggestions for misspelt ones |
//! | [`source`] | texts from disk |
//! | [`schema`] | the JSON schema of studies, found by asking the reader |

// This crate prints nothing; only commands print.
#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr))]
#![warn(clippy::allow_attributes_without_reason, unreachable_pub)]

pub mod bushing_file;
pub mod car_file;
pub mod error;
pub mod file;
pub mod names;
pub mod overrides;
pub mod parse;
pub mod schema;
pub mod source;
pub mod value;
