//! `drawn.json`: some designs of a sweep with their curves and their mechanism, for its page.
//!
//! They are solved when the sweep ends, while its study is at hand; a merge of directories has no study.

use crate::report::curve_table::CurveTable;
use crate::report::record::{FORM, Record};
use serde::{Deserialize, Serialize};

/// Some designs of a sweep with their curves and their mechanism.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DrawnDesigns {
    /// The sweep's digest.
    pub digest: String,
    /// Their numbers; the first is the design as given, which has none.
    pub designs: Vec<Option<u64>>,
    /// The drawing.
    pub record: Record,
    /// The curves of each.
    pub curves: Vec<CurveTable>,
}

impl DrawnDesigns {
    /// Returns true if the files have the present form and agree in their number of designs.
    pub(super) fn is_whole(&self) -> bool {
        let count = self.designs.len();
        self.record.form == FORM && self.record.designs.len() == count && self.curves.len() == count
    }
}
