//! Test results that no test of the study gives.

use super::error::Problems;
use super::names::nearest;
use super::value::Text;
use crate::compliance::{
    KcTest, TestMode, figure_and_keys, figure_names, is_figure_of_axles, loads_of_figure,
};

/// Refuses a test result that no test of the study gives, even if its name is misspelt. `known` has all names that the study
/// offers. Returns true if the name was refused.
pub(super) fn refuses<'n, N: Iterator<Item = &'n str>>(
    text: &'n Text,
    what: &str,
    known: impl Fn() -> N,
    tests: &[KcTest],
    problems: &mut Problems,
) -> bool {
    let name = text.get_ref().as_str();
    let is_known = |name: &str| known().any(|own| own == name);
    if is_known(name) {
        return false;
    }
    let is_named = figure_and_keys(name).is_some();
    let all = known().chain(figure_names());
    let meant = if is_named {
        Some(name)
    } else {
        nearest(name, all)
    };
    let Some(meant) = meant.filter(|meant| !is_known(meant)) else {
        return false;
    };
    let Some((figure, keys)) = figure_and_keys(meant) else {
        return false;
    };
    let loads = || loads_of_figure(figure);
    let is_tested = tests
        .iter()
        .any(|test| loads().any(|load| load == test.load));
    let load = loads().next().map_or("", |load| load.name());
    let is_one_wheel = tests.iter().all(|test| test.mode == TestMode::OneWheel);
    let message = if is_named {
        format!("no test of the study gives a result {name:?}")
    } else {
        format!("unknown {what} {name:?}; did you mean {meant:?}?")
    };
    let help = if is_one_wheel && is_figure_of_axles(figure) {
        format!("{meant} describes both wheels: it needs [axle]")
    } else if is_tested && keys.is_empty() {
        format!(
            "the study has a test with load = {load:?}, but this test does not give the result: docs/compliance.md lists the inputs of \
             each result"
        )
    } else {
        let keys = std::iter::once(format!("load = {load:?}")).chain(keys);
        let keys: Vec<String> = keys.collect();
        format!("add {{ {} }} to tests in [compliance]", keys.join(", "))
    };
    problems.add(text.span(), message).help(help);
    true
}
