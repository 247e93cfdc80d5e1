//! Tests that kill, limit or measure child processes. They are in a separate binary, so that no other test runs at the
//! same time.

mod every_command;
mod results;
#[path = "../support/mod.rs"]
mod support;
