//! The live page: a server on this machine that computes the results of dragged points.
//!
//! A [`Studio`] serves one study to a browser on the same machine. The page sends a design. The server answers with curves as
//! `hardpoint solve` writes them, with the mechanism in one position, and with the misfit. The answer also has the exact
//! gradient of the misfit with respect to every coordinate. The page computes no pose, curve or misfit.
//!
//! The server stores the latest texts that it has read or edited, the latest tuning, and a few report pages. It also stores the
//! running request of each page (`turns.rs`). The page keeps the design in progress. So several tabs do not disturb each other, and
//! a stopped server loses no moved point.
//!
//! The server accepts requests to a loopback address whose path begins with a token of 128 random bits. `Host` must be 127.0.0.1
//! or localhost with the port of the server. `Origin` must be the same address. A GET request may have no `Origin`
//! (`access.rs`). The server only writes the study, the studies of a car's axles, and new files with plain names in the folder of
//! the study (`study_file.rs`).

mod access;
mod answer;
mod axle;
mod beside;
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
mod page_design;
mod rates;
mod reading;
mod routes;
mod server;
mod start;
mod study_file;
mod turns;

pub use invitation::Invitation;
pub use server::{NotServed, Studio};
