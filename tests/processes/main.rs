//! Tests that kill, limit or measure child processes, in a separate binary so that no other test competes with them.

mod every_command;
mod results;
#[path = "../support/mod.rs"]
mod support;
