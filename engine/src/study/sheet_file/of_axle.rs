//! Rows of a measured sheet for an axle: their test result and their station.

use super::super::AxleStudy;
use super::super::axle_targets::{self, AxleSite, distinct};
use super::super::error::StudyErrors;
use super::{Reader, Row, SheetFigure};
use crate::axle::{Coordinate, Quantity, TestFigure, WheelMotion};
use crate::model::Side;

impl Reader<'_> {
    /// Test result that a row of a measured sheet contains. The test result belongs to one wheel or to the axle. If the row
    /// names no wheel, the result can belong to both wheels.
    pub(super) fn figure_of_axle(
        &self,
        both: &AxleStudy,
        row: &Row<'_>,
        is_secant: bool,
    ) -> Result<Option<SheetFigure>, StudyErrors> {
        let wheel = row.cell("wheel");
        let side = match wheel {
            "" | "axle" => None,
            name => match Side::ALL.into_iter().find(|side| side.name() == name) {
                Some(side) => Some(side),
                None => {
                    return row.wrong(format!(
                        "expected left, right or axle as wheel, found {name:?}"
                    ));
                }
            },
        };
        let mut found: Vec<TestFigure> = Vec::new();
        for figure in both.axle.figures() {
            let same_wheel = wheel.is_empty() || figure.side() == side;
            if figure.is_secant == is_secant
                && figure.quantity == row.cell("quantity")
                && same_wheel
                && self.is_of(row, &figure.test)?
            {
                found.push(*figure);
            }
        }
        // A row without a wheel denotes the result of the axle itself, if there is one.
        if let Some(own) = found.iter().find(|figure| figure.side().is_none()).copied()
            && wheel.is_empty()
        {
            found.retain(|figure| figure.side().is_none() || figure.stem() != own.stem());
        }
        let mut stems: Vec<String> = found.iter().map(TestFigure::stem).collect();
        stems.dedup();
        let u = self.context.suspension.length_unit.symbol();
        let columns = format!("mode, trail_{u}, hold, anti_roll_bar, steering and wheel");
        let stem = Self::only_one(row, is_secant, stems, &columns)?;
        Ok(stem.map(|name| SheetFigure {
            of: axle_targets::subject_of(
                found.iter().map(|f| Quantity::Figure(*f)).collect(),
                &name,
                &both.axle,
            ),
            name,
            side,
        }))
    }

    /// Station of a row in the motion of an axle. The station consists of the site (the stations of a target), the value
    /// of the varying coordinate, and the keys of a target.
    pub(super) fn place_of_axle(
        &self,
        both: &AxleStudy,
        row: &Row<'_>,
    ) -> Result<AxlePlace, StudyErrors> {
        let axle = &both.axle;
        let u = axle.left.length_unit.symbol();
        let travel = |side: &str| -> Result<f64, StudyErrors> {
            let own = format!("travel_{side}_{u}");
            let both = format!("travel_{u}");
            row.position(if row.has(&own) { &own } else { &both })
        };
        let [left, right] = [travel("left")?, travel("right")?];
        let rack = row.position(&format!("rack_{u}"))?;
        let mut held = both.plan.motion.clone();
        if held.has_rows() {
            return row.wrong(
                "the motion of this study has combine = \"rows\", which fixes all positions of a row: expected a motion \
                 without \"combine\" for a measured sheet"
                    .to_owned(),
            );
        }
        let by_wheel = held.steering_wheel.take().is_some();
        if by_wheel && rack != 0.0 {
            return row.wrong(
                "the sheet gives a rack displacement, but the motion of this study has \
                 steering_wheel_angle: expected rack in [motion]"
                    .to_owned(),
            );
        }
        let is_heave = matches!(both.plan.motion.wheels, WheelMotion::Heave(_));
        let over = if is_heave {
            Coordinate::Heave
        } else {
            Coordinate::TravelLeft
        };
        // The values of heave and of the left travel are the same numbers in the motion and in the study's text.
        let values = held.along(over).cloned().unwrap_or_default();
        let mut put = |coordinate: Coordinate, value: f64| {
            if let Some(along) = held.along(coordinate) {
                *along = vec![coordinate.in_kernel(value, axle)];
            }
        };
        put(Coordinate::Rack, rack);
        if is_heave && left != right {
            return row.wrong(
                "the travels of both wheels differ in this row, but the motion of \
                              this study is heave: expected equal travels, or travel_left and \
                              travel_right in [motion]"
                    .to_owned(),
            );
        }
        put(over, left);
        let mut numbers = vec![("at", left)];
        if !is_heave {
            put(Coordinate::TravelRight, right);
            numbers.push(("travel_right", right));
        }
        let steering = if by_wheel {
            "steering_wheel_angle"
        } else {
            "rack"
        };
        numbers.push((steering, rack));
        let words = match rack {
            0.0 => String::new(),
            rack => format!(", rack {rack}"),
        };
        Ok(AxlePlace {
            site: AxleSite {
                motion: None,
                over,
                values: distinct(values),
                held,
                words,
            },
            at: left,
            numbers,
        })
    }
}

/// Station of a row in the motion of an axle.
pub(super) struct AxlePlace {
    pub(super) site: AxleSite,
    /// Value of the coordinate that varies.
    pub(super) at: f64,
    /// Keys and values that describe the station in a target, such as `at` and `rack`.
    pub(super) numbers: Vec<(&'static str, f64)>,
}
