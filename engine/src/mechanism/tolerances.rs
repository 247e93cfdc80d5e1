//! Thresholds that all solvers of the crate share: what counts as zero, as rounding, as a good prediction.

/// Relative quantities below this are taken as zero: with less, fewer than six digits of a
/// double-precision result would be left.
pub(crate) const DEGENERATE: f64 = 1e-10;

/// How far, as a part of the move, a second-order prediction may miss. On a smooth path it misses by the
/// cube of the step; near another assembly by much more.
pub(crate) const GOOD_PREDICTION: f64 = 0.01;
/// Corrections this small relative to the size are rounding.
pub(crate) const ROUNDING: f64 = 4.0 * f64::EPSILON;
