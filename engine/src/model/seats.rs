//! Choice of the bodies that carry ends of springs and rods, if a study does not name these bodies.

use super::{Body, Mechanism, PointId, SpinAxis};
use crate::number::Vector3;
use crate::sorting::sort_by;

/// Ratio of two distances from a point: to another body, and to the assigned body. Below this ratio, the other body counts
/// as clearly nearer.
const CLEARLY_NEARER: f64 = 0.5;

/// A body that may carry a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seat {
    /// Name of the body in studies.
    pub name: &'static str,
    /// The body.
    pub body: Body,
    /// Distance of the point from the nearest segment between two of the body's other points, in the design position.
    /// Infinite if the body has no other points.
    pub distance: f64,
}

impl Mechanism {
    /// Bodies that may carry a hardpoint, with the hardpoint's distance from each, nearest first.
    pub fn seats(&self, design: &[Vector3<f64>], id: PointId) -> Vec<Seat> {
        let possible = self.possible_bodies(id).into_iter();
        let seat = |(name, body)| Seat {
            name,
            body,
            distance: self.distance(design, id, body),
        };
        let mut seats: Vec<Seat> = possible.map(seat).collect();
        sort_by(&mut seats, |a, b| a.distance.total_cmp(&b.distance));
        seats
    }

    /// Returns the assigned body of a hardpoint, then the nearest body. `None` unless the nearest body is clearly nearer
    /// than the assigned body.
    pub fn doubtful_seat(&self, design: &[Vector3<f64>], id: PointId) -> Option<[Seat; 2]> {
        let seats = self.seats(design, id);
        let own = seats.iter().find(|seat| seat.body == self.body(id))?;
        let nearest = seats.first()?;
        let is_doubtful = nearest.distance < CLEARLY_NEARER * own.distance;
        is_doubtful.then_some([*own, *nearest])
    }

    /// Marks the assigned body as assumed, for every point with several possible bodies.
    pub fn assume_seats(&mut self) {
        let points = (0..self.points.len()).map(PointId);
        let may_choose = |id: &PointId| self.possible_bodies(*id).len() > 1;
        self.unsaid_seats = points.filter(may_choose).collect();
    }

    /// Assigns the drop link of an anti-roll bar to the body that is clearly nearest to it. The function changes the body
    /// only if the study does not name it, and if a rocker is among the possible bodies. With the drop link on the wrong
    /// body, the bar would rotate ten times too little or too much.
    pub fn seat_drop_link(&mut self, design: &[Vector3<f64>]) {
        if let Some(id) = self.unsaid_drop_link()
            && let Some([_, nearest]) = self.doubtful_seat(design, id)
        {
            self.points[id.0].body = nearest.body;
        }
    }

    /// Returns true if a drop link whose body the study does not name stays on its body when the points move to
    /// `design`.
    pub fn keeps_drop_link(&self, design: &[Vector3<f64>]) -> bool {
        let Some(id) = self.unsaid_drop_link() else {
            return true;
        };
        let mut anew = self.clone();
        anew.points[id.0].body = self.usual_body(id);
        anew.seat_drop_link(design);
        anew.body(id) == self.body(id)
    }

    /// Outer end of the drop link, if a rocker is among the bodies that may carry it and the study does not name its body.
    pub fn unsaid_drop_link(&self) -> Option<PointId> {
        self.spring_rocker()?;
        let id = self.rocker(self.anti_roll_bar()?).outer;
        self.unsaid_seats.contains(&id).then_some(id)
    }

    fn distance(&self, design: &[Vector3<f64>], id: PointId, body: Body) -> f64 {
        let own = (0..self.points.len()).map(PointId);
        let mut points: Vec<PointId> = own.filter(|point| self.body(*point) == body).collect();
        match body {
            Body::Arm(arm) => {
                let arm = self.arms[arm.0];
                points.extend([arm.front, arm.rear, arm.outer]);
            }
            Body::Rocker(rocker) => {
                let rocker = self.rocker(rocker);
                points.extend([rocker.first, rocker.second]);
            }
            Body::Chassis
            | Body::Rack
            | Body::Opposite(_)
            | Body::SteeringGear(_)
            | Body::Knuckle
            | Body::StrutRod(_) => {}
        }
        // The point of the spin axis only gives a direction. It may be far inboard of the real knuckle, so the distance ignores
        // it.
        let shows_spin =
            |point: PointId| matches!(self.spin_axis, SpinAxis::From(own) if own == point);
        points.retain(|point| *point != id && !shows_spin(*point));
        let at = |point: PointId| design[point.0];
        let mut least = f64::INFINITY;
        for (k, a) in points.iter().enumerate() {
            for b in &points[k..] {
                least = least.min(from_segment(at(id), [at(*a), at(*b)]));
            }
        }
        least
    }
}

/// Distance of a point from a segment. The ends of the segment may coincide.
fn from_segment(point: Vector3<f64>, [a, b]: [Vector3<f64>; 2]) -> f64 {
    let (along, away) = (b - a, point - a);
    let share = match along.norm_squared() {
        0.0 => 0.0,
        square => (along.dot(away) / square).clamp(0.0, 1.0),
    };
    (away - along * share).norm()
}
