//! Results as files, tables, pictures and a page.
//!
//! A run writes its files, and a [`Record`] that explains them. [`Run`] reads them back. [`page()`] and [`pictures`] use only a
//! [`Run`].

mod abscissa;
mod accuracy;
mod accuracy_plot;
mod axle_record;
mod bands;
mod benchmarks;
mod car;
mod chart;
mod choices;
mod column;
mod common_motion;
mod comparison;
mod completeness;
mod constraint_margins;
#[cfg(test)]
pub(crate) mod contrast;
mod curve_table;
mod failures;
mod figure;
mod files;
mod finished;
mod fitted;
mod given_columns;
mod kc;
mod orientation;
mod page;
mod picture;
mod places;
mod plausibility;
mod ranges;
mod record;
mod run;
mod scene;
mod set_up_summary;
mod side_effects;
mod slip;
mod solve_summary;
mod station_label;
mod sweep;
mod table;
mod text;
mod tolerance_summary;
mod tuning_summary;
mod yields;

pub use crate::curves::Influence;
pub use accuracy::{remarks, remarks_on_motion};
pub use axle_record::SolvedAxle;
pub use bands::{BandRecord, study_bands_missed};
pub use benchmarks::{
    accuracy_picture, accuracy_summary, accuracy_table, effects_table, jobs_table, throughput_table,
};
pub use car::{
    CarCase, CarComparison, CarConstraintRecord, CarFact, CarLimits, CarMap, CarRecord, CarResults,
    CarState, CarStateRecord, CarTargetRecord, CarToleranceSummary, CarTuningRecord,
    CarVariableRecord, CarVerdict, car_constraint_names, car_constraints_table, car_limits,
    car_study_bands_missed, car_targets_json, car_targets_table, car_variables_table,
    car_with_axles, lift_limits_table, optimised_car, settings_of_car,
};
pub use choices::{FrontPoint, FrontRecord, PriceRecord, front_csv, front_remarks, front_table};
pub use column::{ColumnConversion, ConvertedColumn, split_unit};
pub use comparison::{
    Compared, ComparedKc, ComparedOutput, ComparedPoints, Comparison, KcComparison, NamedPoints,
    StationColumn,
};
pub use completeness::Completeness;
pub use constraint_margins::violated_constraints;
pub(crate) use constraint_margins::{ConstraintMargin, constraint_margins};
pub use curve_table::CurveTable;
pub use failures::FailureRange;
pub use figure::{
    as_written, brief, ends_at, figure, figures, has_digits, resolution, to_digits, with_decimals,
    with_minus_signs, with_plus,
};
pub use files::{curves_csv, history_csv, motion_names, sensitivities_csv};
pub use finished::{FinishedRun, NotARun};
pub use fitted::FittedOffset;
pub use kc::{KcResults, OtherProgram, elastic_parts, no_equilibrium, weakest_motion};
pub(crate) use orientation::{Directions, Reading, Verdict};
pub use page::{
    LimitsSheet, PageDesign, car_page, car_page_of_design, comparison_page, kc_page, limits_page,
    page, page_of_design, set_up_page, sweep_page,
};
pub use picture::{Picture, picture_names, pictures};
pub use places::{Clearance, Places, Rim, Shape};
pub use plausibility::{
    axle_plausibility, both_wheels_plausibility, plausibility, rack_doubt, scatter_doubts,
    spring_doubts, study_doubts, variable_plausibility,
};
pub use record::{
    BandCurve, DesignRecord, DrawnDesign, MotionRecord, NamedMotionRecord, OutputRecord, Record,
    TargetRecord,
};
pub(crate) use record::{readable_unit, wanted_between};
pub use run::{Run, Summary};
pub use scene::{BodyKind, Scene, SceneBody};
pub use set_up_summary::{
    AdjustmentRecord, SetUpSide, SetUpSummary, StaticRecord, set_up_refusal, static_column,
};
pub use side_effects::{
    further_in_words, shown_side_effects, side_effects_in_words, side_effects_table,
    visible_side_effects,
};
pub(crate) use slip::Slip;
pub use solve_summary::SolveSummary;
pub use sweep::{
    Choice, Done, DrawnDesigns, Finished, MergeError, PartOutcome, PartRecord, Parts, ShownDesigns,
    SweepDirectory, SweepRun, SweepSummary, SweepText, TableFile, pareto_csv, rows_header,
    write_part,
};
pub use table::{Cell, Column, Format, Table, Tables};
pub use text::{counted, is_printable, printable, unit_in_words, wrapped};
pub use tolerance_summary::{
    RankingRecord, RejectRecord, ToleranceSummary, VALUES_NOTE, ValueRecord, rejected,
};
pub use tuning_summary::{
    ConstraintStatus, HOLDING_NOTE, HoldingRecord, SlightEffectRecord, StartSummary, TuningSummary,
    contradiction_in_words, holding_table, interrupted_in_words, misfit_in_words, misfit_table,
    shown_holding, starts_in_words, starts_table,
};
pub use yields::YieldRecord;

/// Formats a number for files: the shortest decimal that reads back to the same bits, without a negative zero.
pub fn shortest(value: f64) -> String {
    format!("{:?}", value + 0.0)
}

/// Formats a value for files. A missing or undefined value is an empty cell.
fn optional(value: impl Into<Option<f64>>) -> String {
    let value = value.into().filter(|v| v.is_finite());
    value.map_or_else(String::new, shortest)
}
