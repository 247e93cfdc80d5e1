//! `shown_designs.json`: some designs of a sweep with their curves and their mechanism, for the page of the sweep.
//!
//! These designs are solved at the end of the sweep. A merge of directories solves them again if a directory has the study.

use crate::report::curve_table::CurveTable;
use crate::report::record::{FORM, Record};
use serde::{Deserialize, Serialize};

/// Some designs of a sweep, with their curves and their mechanism.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DrawnDesigns {
    /// Digest of the sweep to which the designs belong.
    pub digest: String,
    /// Numbers of the designs in the sweep. The first one is the nominal design, which has no number.
    pub designs: Vec<Option<u64>>,
    /// Record with the drawings and the motion of these designs.
    pub record: Record,
    /// Curves of each design.
    pub curves: Vec<CurveTable>,
}

impl DrawnDesigns {
    /// True if the record has the current format, and contains as many designs and curves as the list `designs`.
    pub(super) fn is_whole(&self) -> bool {
        let count = self.designs.len();
        self.record.form == FORM
            && self.record.motion.designs.len() == count
            && self.curves.len() == count
    }
}
