//! Causes of limits, by measures of the parts that are written down here once more.
//!
//! - of random designs ([`random`]): a named part is singular by its own measure, and a part that is not named is
//!   not;
//! - ([`agreement`]) the reports of `check`, `solve` and `limits` on a motion;
//! - of designs that are led away from a toggle that was planted ([`planted`]): it is found again, and named.

mod agreement;
mod measures;
mod planted;
mod random;

use hardpoint::study::Study;
use std::path::Path;

/// A sample study's suspension.
fn sample(name: &str) -> hardpoint::model::Suspension {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies");
    let study = Study::read(&path.join(format!("{name}.toml")), &[]);
    study.unwrap().into_wheel()
}
