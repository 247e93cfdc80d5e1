//! The live page: a server on this machine that computes the results of dragged points.
//!
//! A [`Studio`] serves one study to a browser on the same machine. The page sends a design. The server answers with curves as
//! `hardpoint solve` writes them, with the mechanism in one position, and with the misfit. The answer also has the exact
//! gradient of the misfit with respect to every coordinate. The page itself computes nothing.
//!
//! The server stores the texts that it has read, a running tuning, and the latest request of each page (`turns.rs`). The page
//! keeps the design in progress. So several tabs do not disturb each other, and a stopped server loses nothing.
//!
//! The server accepts requests to a loopback address whose path begins with a token of 128 random bits. `Host` must be the
//! printed address. `Origin` must be the printed address, too, except in a request for the page itself (`access.rs`). The
//! server only writes the study, and files with plain names in the same folder (`study_file.rs`).

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
