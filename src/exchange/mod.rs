//! Import of points from other tools' files, and export of points and curves.
//!
//! An import has these steps, each in its own files:
//!
//! | step | files |
//! |---|---|
//! | bytes to a format's own structure | `source`, `sheets`, `delimited`, `workbook`, `cell`, `decimals`, `header`, `yaml`, `map`, `adams`, `adams_bushings` |
//! | a format to a table of named rows, with the axes, units, wheels and axles that the file states | `points`, `map`, `chrono`, `chrono_vehicle`, `assetto_in`, `assetto_axle`, `hub_face`, `source`, into `table` |
//! | names to roles | `names`, `roles` |
//! | choice of axle and wheel | `corner`, `right_half` |
//! | unit and values | `unit`, `angle_unit`, `angle_remark`, `figure_names`, `figures` |
//! | axes and side, and the half track | `axes`, `place`, `optimum`, `slips` |
//! | completeness, bodies, bushings, parts that are left out | `complete`, `seats`, `bushings` |
//! | a study that runs, or the studies of a car | `compose`, `car` |
//!
//! An export starts from [`Outgoing`], a study in the unit and the axes of a file (after `rounding`). From it `export` (tables),
//! `curve_columns`, `subsystem`, `optimum_table`, `suspensions_ini`, `property_file`, `centre_lines` and `envelope` write files.
//!
//! [`read_points`] makes the table, [`import()`] makes the wheel, and [`Imported::study`] makes the study. If the file's axes are
//! a convention of studies, the study keeps them. Then every coordinate is exactly the number in the file. Otherwise only the
//! order and the signs of the coordinates change. Coordinates in cm, dm or ft are converted. If the file's origin is at the wheel,
//! the importer moves the points outboard by the half track.

mod adams;
mod adams_blocks;
mod adams_bushings;
mod angle_remark;
mod angle_unit;
mod assetto_axle;
mod assetto_in;
mod axes;
mod bushings;
mod car;
mod car_points;
mod cell;
mod centre_lines;
mod chrono;
mod chrono_vehicle;
mod complete;
mod compose;
mod corner;
mod curve_columns;
mod decimals;
mod delimited;
mod envelope;
mod export;
mod figure_names;
mod figures;
mod header;
mod hub_face;
mod import;
mod map;
mod names;
mod notes;
mod optimum;
mod optimum_table;
mod outgoing;
mod place;
mod points;
mod property_file;
mod refusal;
mod right_half;
mod roles;
mod rounding;
mod seats;
mod sheets;
mod slips;
mod source;
mod subsystem;
mod suspensions_ini;
mod table;
mod unit;
mod workbook;
mod yaml;

pub use axes::{Axes, Way};
pub use car::{CAR_FILES, ImportedCar, import_car};
pub use car_points::{car_point_pages, car_points_csv};
pub use centre_lines::drawing;
pub use curve_columns::{Tool, cases_in, curves_in, under_names_of};
pub use decimals::length_with_unit;
pub use envelope::{Envelope, Span, Tyre};
pub use export::{csv, page_of_csv, point_rows};
pub use import::{Hardpoint, ImportOptions, Imported, import};
pub use notes::Notes;
pub use optimum_table::{RowsAndNotes, optimum_k_rows};
pub use outgoing::Outgoing;
pub use property_file::property_file;
pub use refusal::{Question, Refusal, for_shell};
pub use rounding::{
    Broken, Grid, Loss, Rounded, moved_coordinates, ranges_of_coordinates, rounded,
    tuned_coordinates,
};
pub use source::{
    STANDARD_INPUT, bytes_of, read as read_points, read_car as read_car_points, read_map,
};
pub use subsystem::{Written, into_subsystem, subsystem};
pub use suspensions_ini::{suspensions_ini, suspensions_ini_of_car};
pub use table::PointTable;
pub use unit::{FileUnit, unit_of};
pub use workbook::{Page, Value, workbook};
