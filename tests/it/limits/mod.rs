//! Tests of the causes of limits. Independent measures, calculated from points alone, show which parts are singular.
//!
//! - [`random`]: in random designs, the measure of a named part is zero. If no part is named, no measure is zero.
//! - [`agreement`]: `check`, `solve` and `limits` report the same about a motion.
//! - [`planted`]: in designs that were moved away from a constructed toggle, the program finds and names this toggle.

mod agreement;
mod measures;
mod planted;
mod random;

/// Suspension of a sample study.
fn sample(name: &str) -> hardpoint::model::Suspension {
    crate::support::study(&format!("{name}.toml"), &[]).into_wheel()
}
