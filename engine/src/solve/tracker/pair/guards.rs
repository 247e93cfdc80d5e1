//! Tests the check of two wheels on one ground at its threshold.

use super::super::boundary::{Noise, template};
use super::super::{Acceptance, LanePose, Rejection};
use super::{AxleTracker, GroundContact, PairDrive, PairStations, VisitPair, WheelOnKnuckle};
use crate::mechanism::Ground;
use crate::number::Vector3;
use crate::solve::StationOrder;

/// Smallest rise of a contact point per travel of its wheel, over the stations of an axle.
struct Rises {
    on: [WheelOnKnuckle<f64>; 2],
    radius: f64,
    least: f64,
}

impl VisitPair<f64> for Rises {
    fn pair<P: LanePose<f64>, Q: LanePose<f64>>(
        &mut self,
        _: usize,
        left: &P,
        right: &Q,
        stand: GroundContact<f64>,
        _: Acceptance<f64>,
    ) {
        self.see(left, 0, stand.ground);
        self.see(right, 1, stand.ground.mirrored());
    }
}

impl Rises {
    fn see(&mut self, at: &impl LanePose<f64>, side: usize, ground: Ground<f64>) {
        let rates = at.rates();
        let axis = at.vector(&self.on[side].axis);
        let lever = ground.contact_lever(axis, self.radius);
        let centre = at.point(&self.on[side].centre);
        let velocity = rates.point(at, centre) + rates.turn().cross(lever);
        self.least = self.least.min(ground.normal().dot(velocity));
    }
}

/// Tests axles of five-link suspensions. Their wheels are so large that a tilted wheel rolls on its side. Bisection from
/// the template to random designs ends where a contact point rises half as fast as its wheel. No other check of these
/// equations gives the reason `FoldNear`, so only this check rejects the neighbouring design.
#[test]
fn contact_points_rise_half_as_fast_as_their_wheels() {
    let suspension = template("five_link");
    let (mechanism, base) = (&suspension.mechanism, &suspension.design);
    let size = suspension.size();
    let radius = 3.0 * size;
    let drive = PairDrive::Roll {
        half_track: 2.0 * size,
        radius,
    };
    let stations: Vec<f64> = (-8..=8).map(|k| 0.005 * f64::from(k)).collect();
    let stations = PairStations {
        heave: 0.0,
        rack: 0.0,
        lift: 0.0,
        order: StationOrder::through(&stations),
    };
    let tracker = AxleTracker::new([mechanism; 2], [base; 2], drive, &[stations]).unwrap();
    let mut history = tracker.history(0.0_f64);
    let mut follow = |points: &[Vector3<f64>]| {
        let design = tracker.wheel(0).design(points);
        let on = [(), ()].map(|()| WheelOnKnuckle::of(mechanism, &design, points));
        let least = f64::INFINITY;
        let mut rises = Rises { on, radius, least };
        let tracked = tracker.solve(
            [&design; 2],
            [points; 2],
            [0.0; 2],
            0,
            &mut history,
            &mut rises,
        );
        let reason = tracked.legs.iter().find_map(|leg| leg.reason(0));
        (reason, rises.least)
    };
    assert_eq!(follow(base).0, None);
    let mut noise = Noise(3);
    let mut found = 0;
    for _ in 0..200 {
        let direction: Vec<Vector3<f64>> = base
            .iter()
            .map(|_| Vector3::new(noise.next(), noise.next(), noise.next()) * (0.3 * size))
            .collect();
        let at = |t: f64| -> Vec<Vector3<f64>> {
            let points = base.iter().zip(&direction);
            points.map(|(point, along)| *point + *along * t).collect()
        };
        let (mut low, mut high) = (0.0, 1.0);
        if follow(&at(high)).0.is_none() {
            continue;
        }
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            match follow(&at(middle)).0 {
                Some(_) => high = middle,
                None => low = middle,
            }
        }
        if follow(&at(high)).0 != Some(Rejection::FoldNear) {
            continue;
        }
        let (reason, least) = follow(&at(low));
        assert_eq!(reason, None);
        // The check uses the predicted pose, which is this close to the solved pose.
        assert!((least - 0.5).abs() < 1e-3, "{least}");
        found += 1;
    }
    println!("{found} of 200 lines end there");
    assert!(found > 0);
}
