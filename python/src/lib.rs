//! The Python module, a thin layer over the Rust library's public interface. It computes nothing itself.
//!
//! Arrays are float64 in C order. Column names give the units, and the study gives the axes. NaN means "no value". An error in a
//! study raises `StudyError`. A result that does not fit into memory raises `MemoryError`. A sweep whose files cannot be written
//! raises `OSError`. Other failures raise `HardpointError`. The module releases the global interpreter lock during
//! computations. Between pieces of work it checks for Ctrl-C.

#![allow(
    clippy::type_complexity,
    reason = "Python passes and returns tuples of arrays"
)]

mod answers;
mod car;
mod curves;
mod errors;
mod function;
mod limits;
mod status;
mod study;
mod sweep;
mod tables;
mod threads;
mod tuning;

use pyo3::prelude::*;

#[pymodule]
fn _hardpoint(module: &Bound<'_, PyModule>) -> PyResult<()> {
    hardpoint::attia::register();
    let python = module.py();
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("STATUS", status::WORDS.to_vec())?;
    module.add("StudyError", python.get_type::<errors::StudyError>())?;
    module.add(
        "HardpointError",
        python.get_type::<errors::HardpointError>(),
    )?;
    module.add_class::<study::Study>()?;
    module.add_class::<car::Car>()?;
    module.add_class::<function::Function>()?;
    module.add_class::<tuning::Residuals>()?;
    module.add_function(wrap_pyfunction!(study::topologies, module)?)?;
    module.add_function(wrap_pyfunction!(study::template, module)?)?;
    module.add_function(wrap_pyfunction!(curves::solve, module)?)?;
    module.add_function(wrap_pyfunction!(car::car_solve, module)?)?;
    module.add_function(wrap_pyfunction!(car::car_derivatives, module)?)?;
    module.add_function(wrap_pyfunction!(car::car_sweep, module)?)?;
    module.add_function(wrap_pyfunction!(car::car_optimise, module)?)?;
    module.add_function(wrap_pyfunction!(car::car_check, module)?)?;
    module.add_function(wrap_pyfunction!(car::car_limits, module)?)?;
    module.add_function(wrap_pyfunction!(car::car_compare, module)?)?;
    module.add_function(wrap_pyfunction!(car::car_tolerance, module)?)?;
    module.add_function(wrap_pyfunction!(limits::limits, module)?)?;
    module.add_function(wrap_pyfunction!(limits::limits_of_builds, module)?)?;
    module.add_function(wrap_pyfunction!(study::drawing, module)?)?;
    module.add_function(wrap_pyfunction!(study::check, module)?)?;
    module.add_function(wrap_pyfunction!(study::schema, module)?)?;
    module.add_function(wrap_pyfunction!(study::catalogue, module)?)?;
    module.add_function(wrap_pyfunction!(tables::read_tables, module)?)?;
    module.add_function(wrap_pyfunction!(tables::parse_table, module)?)?;
    module.add_function(wrap_pyfunction!(tables::split_unit, module)?)?;
    module.add_function(wrap_pyfunction!(sweep::sweep_columns, module)?)?;
    module.add_function(wrap_pyfunction!(study::command, module)?)?;
    module.add_function(wrap_pyfunction!(study::command_captured, module)?)?;
    module.add_function(wrap_pyfunction!(answers::report, module)?)?;
    module.add_function(wrap_pyfunction!(answers::solve_files, module)?)?;
    module.add_function(wrap_pyfunction!(answers::page_of_files, module)?)?;
    module.add_function(wrap_pyfunction!(tuning::tuning_files, module)?)?;
    module.add_function(wrap_pyfunction!(sweep::sweep_page, module)?)?;
    module.add_function(wrap_pyfunction!(sweep::sweep_into, module)?)?;
    module.add_function(wrap_pyfunction!(study::export_study, module)?)?;
    module.add_function(wrap_pyfunction!(study::import_study, module)?)?;
    module.add_function(wrap_pyfunction!(tuning::optimise, module)?)?;
    module.add_function(wrap_pyfunction!(sweep::sweep, module)?)?;
    module.add_function(wrap_pyfunction!(answers::kc, module)?)?;
    module.add_function(wrap_pyfunction!(answers::setup, module)?)?;
    module.add_function(wrap_pyfunction!(answers::tolerance, module)?)?;
    module.add_function(wrap_pyfunction!(answers::build, module)?)?;
    module.add_function(wrap_pyfunction!(answers::swept_design, module)?)?;
    module.add_function(wrap_pyfunction!(answers::assemblies, module)?)?;
    module.add_function(wrap_pyfunction!(answers::compare, module)?)?;
    module.add_function(wrap_pyfunction!(sweep::sweep_parts, module)?)?;
    Ok(())
}
