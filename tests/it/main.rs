//! Tests of the library and of the program in one binary, so that the engine is linked once.
//!
//! Each module covers one subject. `cargo test --test it tuning::` runs a single module. A test here must not change its
//! own process: no signals, limits, environment variables or current directory. Tests that kill, limit or measure child
//! processes are in `tests/processes`.

mod anti;
mod assemblies;
mod axle;
mod bench;
mod book;
mod builds;
mod car;
mod certificate;
mod command_line;
mod compliance;
mod convert;
mod derivatives;
mod design_function;
mod effects;
mod exchange;
mod front_door;
mod hard_cases;
mod infinity;
mod lanes;
mod limits;
mod loads;
mod measures;
mod packages;
mod point_coordinates;
mod readme;
mod reference;
mod report;
mod robustness;
mod rockers;
mod side_effects;
mod solid;
mod studio;
mod study_errors;
mod study_files;
mod study_keys;
mod study_meaning;
#[path = "../support/mod.rs"]
mod support;
mod sweep;
mod terminal;
mod toe_at_rim;
mod topologies;
mod tuning;
mod units;
