//! Other tools' files: points in, points and curves out.
//!
//! Data comes from a table of text, a workbook, a map in JSON or YAML or an Adams/Car subsystem as named points
//! in the file's own axes and unit ([`read_points`]), becomes the wheel of a topology ([`import()`]) and then a study
//! ([`Imported::study`]). The study keeps the file's axes and unit, so that every coordinate is the double
//! that was written.

mod adams;
mod cell;
mod centre_lines;
mod compose;
mod curve_columns;
mod delimited;
mod envelope;
mod export;
mod hub_face;
mod import;
mod map;
mod names;
mod optimum_table;
mod orientation;
mod outgoing;
mod points;
mod rounding;
mod source;
mod subsystem;
mod suspensions_ini;
mod workbook;
mod yaml;

pub use centre_lines::drawing;
pub use curve_columns::{Tool, curves_in, under_names_of, unit_of_column};
pub use envelope::{Envelope, Span, Tyre};
pub use export::{csv, page_of_csv, point_rows};
pub use import::{Hardpoint, ImportOptions, Imported, import};
pub use optimum_table::{RowsAndNotes, optimum_k_rows};
pub use outgoing::Outgoing;
pub use points::{NamedPoint, PointTable, unit_of};
pub use rounding::{Grid, Loss, Rounded, moved_coordinates, rounded, tuned_coordinates};
pub use source::{bytes_of, read as read_points};
pub use subsystem::{Written, into_subsystem, subsystem};
pub use suspensions_ini::suspensions_ini;
pub use workbook::{Page, Value, workbook};
