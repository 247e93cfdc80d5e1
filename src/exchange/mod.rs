//! Other tools' files: points in, points and curves out.
//!
//! Data comes from a table of text, a workbook, a map in JSON or YAML or an Adams/Car subsystem as named points
//! in the file's own axes and unit ([`read_points`]), becomes the wheel of a topology ([`import()`]) and then a study
//! ([`Imported::study`]). The study keeps the file's axes and unit, so that every coordinate is the double
//! that was written.

mod adams;
mod cell;
mod compose;
mod delimited;
mod export;
mod hub_face;
mod import;
mod map;
mod names;
mod orientation;
mod points;
mod rounding;
mod source;
mod workbook;
mod yaml;

pub use export::{Written, csv, into_subsystem, page_of_csv, point_rows, subsystem};
pub use import::{Hardpoint, ImportOptions, Imported, import};
pub use points::{NamedPoint, PointTable, unit_of};
pub use rounding::{Loss, Rounded, rounded};
pub use source::read as read_points;
pub use workbook::{Page, Value, workbook};
