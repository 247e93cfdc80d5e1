//! Tests of builds of solid axles: geometry of the assembled parts, and builds as studies.

use super::kinds::{KINDS, Kind};
use super::own::{Point, dot, minus, mirror};
use hardpoint::axle::axle_curves;
use hardpoint::model::{Side, Suspension};
use hardpoint::number::{Vector3, Width};
use hardpoint::study::Study;
use hardpoint::tolerance::{Problem, monte_carlo, monte_carlo_in};
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::Path;

fn distance(a: Point, b: Point) -> f64 {
    dot(minus(a, b), minus(a, b)).sqrt()
}

fn on(_: u64) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn problem(study: &Study) -> Problem<'_> {
    Problem::of(study, study.tolerance.as_ref().unwrap()).unwrap()
}

/// Parts of a build, computed from the build's random numbers without the assembler: nominal points of both halves plus
/// scatter, and changes of lengths.
struct Expected {
    nominal: BTreeMap<String, Point>,
    points: BTreeMap<String, Point>,
    longer: BTreeMap<String, f64>,
}

impl Expected {
    fn of(kind: &Kind, study: &Study, build: u64) -> Self {
        let mut nominal = BTreeMap::new();
        for (name, point) in kind.points {
            nominal.insert((*name).to_owned(), *point);
            if !kind.is_single(name) {
                nominal.insert(format!("right_{name}"), mirror(*point));
            }
        }
        let tolerance = study.tolerance.as_ref().unwrap();
        let mut draws = vec![0.0; tolerance.sources()];
        tolerance.draw(build, &mut draws);
        let (mut points, mut longer) = (nominal.clone(), BTreeMap::new());
        let sources = tolerance.scatter.iter().flat_map(|c| &c.sources);
        for (source, draw) in sources.zip(draws) {
            // Names look like "left lower_link_axle x" or "panhard length".
            let (side, rest) = match source.name.split_once(' ') {
                Some(("left", rest)) => ("", rest),
                Some(("right", rest)) => ("right_", rest),
                _ => ("", &source.name[..]),
            };
            let (name, along) = rest.split_once(' ').unwrap();
            let name = format!("{side}{name}");
            let Some(axis) = ["x", "y", "z"].iter().position(|axis| *axis == along) else {
                assert_eq!(along, "length");
                longer.insert(name, draw);
                continue;
            };
            // The scatter of a right part is the mirror image of the scatter of a left part.
            let sign = if side == "right_" && axis == 1 {
                -1.0
            } else {
                1.0
            };
            points.get_mut(&name).unwrap()[axis] += sign * draw;
        }
        assert!(points.iter().all(|(name, point)| nominal[name] != *point));
        Expected {
            nominal,
            points,
            longer,
        }
    }

    fn length(&self, name: &str, [a, b]: [&str; 2]) -> f64 {
        distance(self.nominal[a], self.nominal[b]) + self.longer[name]
    }
}

/// Returns all points of a build. Points of the right half are in the frame of the right wheel.
fn places(kind: &Kind, [left, right]: [&Suspension; 2]) -> BTreeMap<String, Point> {
    let mut places = BTreeMap::new();
    for (name, _) in kind.points {
        let id = left.mechanism.point(name).unwrap();
        places.insert((*name).to_owned(), left.design[id.0].to_array());
        if !kind.is_single(name) {
            let place = right.design[id.0].to_array();
            places.insert(format!("right_{name}"), mirror(place));
        }
    }
    places
}

/// Asserts that the distances between these points equal the distances in the part.
fn rigid(names: &[String], found: &BTreeMap<String, Point>, expected: &Expected) {
    for (k, a) in names.iter().enumerate() {
        for b in &names[..k] {
            let now = distance(found[a], found[b]);
            let part = distance(expected.points[a], expected.points[b]);
            assert!((now - part).abs() < 1e-9, "{a} {b}: {now} {part}");
        }
    }
}

/// Asserts that the points of a rocker keep their position along the rocker's axis and their distance from this axis.
fn hinged(axis: [&str; 2], names: &[String], found: &BTreeMap<String, Point>, parts: &Expected) {
    let read = |[first, second]: [Point; 2], point: Point| {
        let way = minus(second, first);
        let lever = minus(point, first);
        let along = dot(lever, way) / dot(way, way).sqrt();
        [along, (dot(lever, lever) - along * along).sqrt()]
    };
    for name in names {
        let now = read(axis.map(|end| found[end]), found[name]);
        let part = read(axis.map(|end| parts.nominal[end]), parts.points[name]);
        for (now, part) in now.iter().zip(part) {
            assert!((now - part).abs() < 1e-9, "{name}: {now} {part}");
        }
    }
}

/// Every build has the lengths, the shapes of rigid bodies and the body points that its random numbers define. Both wheel
/// centres are at their nominal heights, and the mechanisms of both wheels describe the same axle.
#[test]
fn builds_have_the_dimensions_of_their_parts() {
    for kind in KINDS {
        let study = kind.study(&kind.scatter(1.5), "");
        let problem = problem(&study);
        for build in [0, 1, 12] {
            let wheels = problem.built_wheels(build).unwrap();
            let [left, right] = &wheels[..] else {
                panic!("two wheels");
            };
            let found = places(kind, [left, right]);
            let expected = Expected::of(kind, &study, build);
            for name in ["wheel_centre", "right_wheel_centre"] {
                let off = found[name][2] - expected.nominal[name][2];
                assert!(off.abs() < 1e-10, "{} {name}: {off:e}", kind.name);
            }
            for name in kind.on_body().flat_map(|name| kind.both(name)) {
                let off = distance(found[&name], expected.points[&name]);
                assert!(off < 1e-12, "{} {name}: {off:e}", kind.name);
            }
            let on_axle: Vec<_> = kind.on_axle().flat_map(|n| kind.both(n)).collect();
            rigid(&on_axle, &found, &expected);
            for (axis, names) in kind.rockers {
                let names: Vec<_> = names.iter().map(|name| (*name).to_owned()).collect();
                rigid(&names, &found, &expected);
                hinged(*axis, &names, &found, &expected);
            }
            for (name, ends) in kind.members() {
                let now = distance(found[&ends[0]], found[&ends[1]]);
                let part = expected.length(&name, [&ends[0], &ends[1]]);
                assert!(
                    (now - part).abs() < 1e-9,
                    "{} {name}: {now} {part}",
                    kind.name
                );
            }
            // The left wheel's mechanism does not contain the bar lever of the right half, so the test skips this lever.
            for (number, point) in left.mechanism.points.iter().enumerate() {
                let Some(near) = point.name.strip_prefix("right_") else {
                    continue;
                };
                let id = right.mechanism.point(near).unwrap();
                if !near.starts_with("drop_link_inner") {
                    let own = Vector3::from(mirror(right.design[id.0].to_array()));
                    let off = (left.design[number] - own).norm();
                    assert!(off < 1e-9, "{} {near}: {off:e}", kind.name);
                }
            }
        }
    }
}

/// A build that is printed as a study equals the build: the curves of the study are the values of the Monte Carlo
/// analysis.
#[test]
fn printed_builds_are_the_builds() {
    for kind in KINDS {
        let study = kind.study(&kind.scatter(0.5), "builds = 2\n");
        let problem = problem(&study);
        let drawn = problem.drawn().unwrap();
        let found = monte_carlo(&problem, &drawn, on).unwrap();
        let curves = [0, 1].map(|number| {
            let printed = problem.built_text(number).unwrap();
            let printed = Study::from_text("built.toml", &printed, Path::new("."));
            let printed = printed.unwrap_or_else(|e| panic!("{}: {e}", kind.name));
            let both = printed.axle().unwrap().clone();
            axle_curves(&both.axle, &both.plan).unwrap().curves
        });
        for (k, column) in curves[0].columns.iter().enumerate() {
            for station in 0..curves[0].stations.len() {
                let mut values =
                    [0, 1].map(|build| curves[build].stations[station].value(k).unwrap());
                values.sort_by(f64::total_cmp);
                let factor = problem.outputs()[k].factor();
                let range = found.spreads[problem.cell(k, station)].range;
                for (value, limit) in values.into_iter().zip(range) {
                    let off = (value - limit * factor).abs();
                    assert!(
                        off < 1e-8,
                        "{} {} {station}: {off:e}",
                        kind.name,
                        column.name
                    );
                }
            }
        }
    }
}

/// SIMD lanes and single builds give the same values. The bits do not depend on the number of CPU threads.
#[test]
fn results_are_the_same_however_they_are_found() {
    if !crate::support::has_lanes() {
        return;
    }
    assert!(Width::available().next().is_some());
    for kind in KINDS {
        let study = kind.study(&kind.scatter(0.3), "builds = 150\n");
        let problem = problem(&study);
        assert_eq!(problem.not_in_lanes(), None);
        let drawn = problem.drawn().unwrap();
        let on_threads = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.unwrap()
                .install(|| monte_carlo(&problem, &drawn, on).unwrap())
        };
        let (one, three) = (on_threads(1), on_threads(3));
        assert_eq!(one.rejected(), 0);
        assert_eq!(one.spreads, three.spreads);
        let single = monte_carlo_in(None, &problem, &drawn, on).unwrap();
        for (a, b) in one.spreads.iter().zip(&single.spreads) {
            let near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * (1.0 + b.abs());
            assert!(
                near(a.mean, b.mean) && near(a.sigma, b.sigma),
                "{}: {a:?} {b:?}",
                kind.name
            );
        }
    }
}

/// If an axle cannot be assembled, the program names the whole axle and the rod that is too short.
#[test]
fn a_rod_that_cannot_reach_is_named() {
    let steered = KINDS.iter().find(|kind| kind.is_steered()).unwrap();
    let study = steered.study(
        "{ length = \"tie_rod\", limits = [-400.0, -399.0] }",
        "builds = 5\n",
    );
    let problem = problem(&study);
    let (side, why) = problem.built_wheels(0).unwrap_err();
    assert_eq!(side, None::<Side>);
    assert_eq!(
        why.to_string(),
        "the tie rod is too short, too long or at its toggle"
    );
}
