//! Tests of the forces of twist beams under loads: each half is in balance as a free body. The test reads only the
//! columns of the curves.

use super::axle;
use super::own::{Point, cross, dot, minus};
use super::twist_beam::random;
use crate::support::random::Random;
use hardpoint::axle::axle_curves;
use hardpoint::curves::Curves;
use hardpoint::model::Side;

/// Weight on the axle in N, the scale of the errors.
const WEIGHT: f64 = 7000.0;

fn scaled(a: Point, by: f64) -> Point {
    a.map(|c| by * c)
}

struct Read<'a>(&'a Curves);

impl Read<'_> {
    fn number(&self, name: &str) -> f64 {
        let columns = &self.0.columns;
        let place = columns.iter().position(|c| c.name == name);
        let place = place.unwrap_or_else(|| {
            panic!(
                "{name}: {:?}",
                columns.iter().map(|c| &c.name).collect::<Vec<_>>()
            )
        });
        self.0.stations[0].value(place).unwrap()
    }

    fn vector(&self, stem: &str, unit: &str) -> Point {
        ["x", "y", "z"].map(|axis| self.number(&format!("{stem}_{axis}_{unit}")))
    }

    fn point(&self, side: Side, name: &str) -> Point {
        self.vector(&format!("{}_{name}", side.name()), "mm")
    }
}

/// Returns the sum of the forces on one half of the axle, and the sum of the moments on this half about the origin. The
/// moments include the couples.
fn sums(forces: &[(Point, Point)], couples: &[Point]) -> [Point; 2] {
    let (mut sum, mut about) = ([0.0; 3], [0.0; 3]);
    for (place, force) in forces {
        let moment = cross(*place, *force);
        for i in 0..3 {
            sum[i] += force[i];
            about[i] += moment[i];
        }
    }
    for couple in couples {
        (0..3).for_each(|i| about[i] += couple[i]);
    }
    [sum, about]
}

/// Forces and moments on each half are in balance. They come from the mount, the spring, the load, and from the other
/// half at the shear centre. The beam's moment has no component along the hinge. Both mounts carry the same lateral
/// force. The test covers heave and roll, loads on either wheel, and different halves.
#[test]
fn each_half_is_in_balance() {
    let mut generator = Random(91);
    for number in 0..4 {
        let own_right = number % 2 == 1;
        let beam = random(&mut generator);
        let force = generator.vector(0.5 * WEIGHT).to_array();
        let moment = generator.vector(1e6).to_array();
        let [x, y, z] = beam.shear_centre;
        let right = if own_right {
            let [x, y, z] = beam.mount;
            format!(
                "[axle.right.hardpoints]\nmount = [{:?}, {:?}, {:?}]\n",
                x + 7.0,
                -y + 3.0,
                z - 4.0
            )
        } else {
            String::new()
        };
        let text = beam.text(&format!(
            "[suspension.extra_points]\nhinge = {{ body = \"arm\", position = [{x:?}, {:?}, {z:?}] }}\n{right}\
             [motion]\nroll = [1.5]\nheave = [20.0]\n[outputs]\ncharacteristics = [\"toe\"]\n\
             points = [\"mount\", \"shear_centre\", \"hinge\", \"wheel_centre\", \"spring_upper\", \"spring_lower\"]\n\
             loads = [{{ name = \"kerb\", at = \"wheel_centre\", force = {force:?}, moment = {moment:?} }}]\n",
            y + 100.0,
        ));
        let study = axle(&text);
        let curves = axle_curves(&study.axle, &study.plan).unwrap().curves;
        let read = Read(&curves);
        for loaded in Side::ALL {
            let of = |stem: &str, unit: &str| {
                read.vector(&format!("{}_kerb_{stem}", loaded.name()), unit)
            };
            let (by_other, couple) = (of("beam_force", "N"), scaled(of("beam_moment", "N_m"), 1e3));
            let side_forces = Side::ALL.map(|side| of(&format!("{}_mount", side.name()), "N")[1]);
            assert!((side_forces[0] - side_forces[1]).abs() < 1e-11 * WEIGHT);
            for half in Side::ALL {
                let name = half.name();
                let sign = if half == Side::Left { 1.0 } else { -1.0 };
                let centre = read.point(half, "shear_centre");
                let mut forces = vec![
                    (read.point(half, "mount"), of(&format!("{name}_mount"), "N")),
                    (centre, scaled(by_other, sign)),
                ];
                let [lower, upper] =
                    ["spring_lower", "spring_upper"].map(|end| read.point(half, end));
                let along = minus(lower, upper);
                let spring = read.number(&format!("{}_kerb_{name}_spring_N", loaded.name()));
                forces.push((lower, scaled(along, spring / dot(along, along).sqrt())));
                let mut couples = vec![scaled(couple, sign)];
                if half == loaded {
                    forces.push((read.point(half, "wheel_centre"), force));
                    couples.push(moment);
                }
                let [sum, about] = sums(&forces, &couples);
                for i in 0..3 {
                    assert!(
                        sum[i].abs() < 1e-11 * WEIGHT,
                        "{number} {loaded:?} {half:?}: {sum:?}"
                    );
                    // Levers are up to 1 m long.
                    assert!(
                        about[i].abs() < 1e-11 * WEIGHT * 1e3,
                        "{number} {loaded:?} {half:?}: {about:?}"
                    );
                }
                let hinge = minus(read.point(half, "hinge"), centre);
                let along = dot(couple, hinge) / dot(hinge, hinge).sqrt();
                assert!(
                    along.abs() < 1e-11 * WEIGHT * 1e3,
                    "{number} {half:?}: {along}"
                );
                assert!(couple.iter().any(|c| c.abs() > 1e4));
            }
        }
    }
}
