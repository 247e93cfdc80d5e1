//! Tests that kill, limit or measure child processes, in a binary of their own: no other test competes with them.

mod every_command;
mod results;
#[path = "../support/mod.rs"]
mod support;
