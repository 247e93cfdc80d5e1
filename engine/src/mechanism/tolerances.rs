//! Thresholds that all solvers of the crate share: for zero, for rounding errors and for a good prediction.

/// Threshold below which relative quantities count as zero. For smaller quantities, fewer than six digits of a
/// double-precision result would be correct.
pub(crate) const DEGENERATE: f64 = 1e-10;

/// Largest error of a second-order prediction, as a share of the step. On a smooth path the error is of third order;
/// near another assembly branch it is much larger.
pub(crate) const GOOD_PREDICTION: f64 = 0.01;
/// Largest correction that counts as a rounding error, relative to the largest coordinate of the design.
pub(crate) const ROUNDING: f64 = 4.0 * f64::EPSILON;
