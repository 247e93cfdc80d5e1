//! Points of both axles of a car, in the axes of the car.

use super::{Outgoing, Page, Value, csv, point_rows};
use crate::model::{FrameConvention, LengthUnit};
use crate::number::Vector3;
use crate::study::{CarStudy, Study};

/// Tables of the points of the front and the rear axle, at their positions in the car. Without a unit or a frame, each axle keeps
/// its own.
pub fn car_point_pages(
    study: &CarStudy,
    unit: Option<LengthUnit>,
    frame: Option<FrameConvention>,
) -> [Page; 2] {
    [0, 1].map(|axle| {
        let own = placed(study, axle);
        let outgoing = Outgoing::of(&own, unit, frame);
        Page {
            name: format!("{}_hardpoints", crate::car::AXLE_NAMES[axle]),
            rows: point_rows(&outgoing),
        }
    })
}

/// CSV file with the points of both axles. An additional column names the axle.
pub fn car_points_csv(pages: [Page; 2]) -> Vec<u8> {
    let text = |text: &str| vec![Value::Text(text.to_owned())];
    let [front, rear] = pages.map(|page| page.rows);
    // Both tables have the same header.
    let header = front.iter().take(1);
    let header = header.map(|row| [text("axle"), row.clone()].concat());
    let mut rows: Vec<Vec<Value>> = header.collect();
    for (end, own) in [("front", front), ("rear", rear)] {
        let own = own.into_iter().skip(1);
        rows.extend(own.map(|row| [text(end), row].concat()));
    }
    csv(&rows)
}

/// Study of an axle (0 front, 1 rear), with its points at their positions in the car.
fn placed(study: &CarStudy, axle: usize) -> Study {
    let mut own = study.axles[axle].clone();
    if axle == 0 {
        return own;
    }
    let offset = study.car.rear_offset;
    let shift = |design: &mut [Vector3<f64>], offset: Vector3<f64>| {
        for point in design {
            *point = *point + offset;
        }
    };
    shift(&mut own.wheel_mut().design, offset);
    if let Some(both) = own.axle_mut()
        && let Some(right) = &mut both.axle.right
    {
        // The points of a right wheel are stored like those of a left wheel, so the lateral offset changes its sign.
        let mirrored = Vector3::new(offset.x, -offset.y, offset.z);
        shift(&mut right.design, mirrored);
    }
    own
}
