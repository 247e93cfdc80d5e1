//! The live page: a server on this machine that follows dragged points.
//!
//! A [`Studio`] serves one study to a browser on the same machine. The page sends a design, the server answers
//! with what the library makes of it: curves as `hardpoint solve` writes them, the mechanism in one position,
//! the misfit with its exact gradient by every coordinate. Nothing is computed in the page.
//!
//! The server remembers texts it has read and a tuning under way; the design being worked on is the page's
//! own, so that several tabs do not disturb each other and a server that was stopped loses nothing.
//!
//! Who may speak to it: requests to a loopback address whose path begins with a token of 128 random bits, whose
//! `Host` is the address that was printed and, for everything but the page itself, whose `Origin` is too
//! (`access.rs`). What may be written: the study, the studies of a car's axles, and plain file names beside it (`study_file.rs`).

mod access;
mod answer;
mod axle;
mod car;
mod connections;
mod directions;
mod groups;
mod http;
mod influence;
mod invitation;
mod job;
mod message;
mod misfit;
mod overview;
mod page;
mod rates;
mod reading;
mod routes;
mod server;
mod start;
mod study_file;

pub use invitation::Invitation;
pub use server::{NotServed, Studio};
