//! Tests of builds of elastic solid axles: five links that do not fit without force, rates of single parts, gradients,
//! Monte Carlo analyses and the rigid limit.

use super::rigid_limit::{rigid, stiffer, values};
use super::{Kind, Scatter, made};
use crate::solid::own::{Point, cross, dot, minus};
use crate::support::larger;
use crate::support::random::Random;
use hardpoint::study::Study;
use hardpoint::tolerance::{Expansion, Problem, monte_carlo, monte_carlo_in};
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::Path;

const KINDS: [Kind; 3] = [Kind::FourLink, Kind::ThreeLinkPanhard, Kind::FiveLink];
pub(super) const MOTION: &str = "[motion]\ntravel_left = [-30.0, 20.0]\ntravel_right = [10.0]\n[outputs]\n\
                      characteristics = [\"camber\", \"toe\", \"mean_steer\", \"axle_steer\", \"axle_lateral\", \"pinion_angle\", \
                      \"roll_centre_height\", \"wheel_load\"]\n";
/// Motion and outputs that rigid axles support too.
const RIGID_MOTION: &str = "[motion]\ntravel_left = [-30.0, 20.0]\ntravel_right = [10.0]\n[outputs]\n\
                            characteristics = [\"camber\", \"toe\", \"axle_steer\", \"axle_lateral\", \"pinion_angle\", \"roll_centre_height\"]\n";
/// Half the width of the scatter range. The range is so narrow that the deviation of a part is known.
const NARROW: f64 = 1e-13;

/// Study of a random axle whose lower links have one rate.
pub(super) fn text(kind: Kind, relaxed: &str, motion: &str) -> String {
    let scatter = Scatter {
        points: 20.0,
        differs: true,
        rates: [3.7, 4.0],
        springs: true,
    };
    let text = made(kind, scatter, &mut Random(5), motion).text;
    // A rate scatters about one nominal value, so both lower links get the same rate.
    let start = text.find("[axle.right.links.lower_link]").unwrap();
    let length: usize = text[start..]
        .lines()
        .take(2)
        .map(|line| line.len() + 1)
        .sum();
    let text = format!("{}{}", &text[..start], &text[start + length..]);
    text.replace("relaxed = \"free\"", &format!("relaxed = \"{relaxed}\""))
}

fn study(text: &str, tolerance: &str) -> Study {
    let text = format!("{text}[tolerance]\n{tolerance}\n");
    let read = Study::elastic_from_text("solid.toml", &text, Path::new(""));
    read.unwrap_or_else(|errors| panic!("{errors}\n{text}"))
}

fn problem(study: &Study) -> Problem<'_> {
    Problem::of(study, study.tolerance.as_ref().unwrap()).unwrap_or_else(|e| panic!("{e:?}"))
}

fn on(_: u64) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// Scattered parts with one random number each, and the steps of the difference quotients.
fn entries(kind: Kind) -> Vec<(&'static str, f64)> {
    let mut entries = vec![
        (
            "hardpoint = \"lower_link_axle\", axis = \"z\", side = \"left\"",
            0.2,
        ),
        (
            "hardpoint = \"lower_link_chassis\", axis = \"y\", side = \"right\"",
            0.2,
        ),
        (
            "hardpoint = \"wheel_centre\", axis = \"z\", side = \"left\"",
            0.2,
        ),
        (
            "hardpoint = \"spring_upper\", axis = \"x\", side = \"right\"",
            0.2,
        ),
        ("length = \"lower_link\", side = \"right\"", 0.2),
        (
            "link = \"lower_link\", relative = true, side = \"right\"",
            0.02,
        ),
        ("rate = \"spring\", relative = true, side = \"left\"", 0.02),
    ];
    if kind == Kind::ThreeLinkPanhard {
        entries.push(("length = \"upper_link\"", 0.2));
        entries.push(("link = \"upper_link\", relative = true", 0.02));
    } else {
        entries.push(("length = \"upper_link\", side = \"right\"", 0.2));
        entries.push(("length = \"upper_link\", side = \"left\"", 0.2));
        entries.push((
            "link = \"upper_link\", relative = true, side = \"left\"",
            0.02,
        ));
    }
    if kind != Kind::FourLink {
        entries.push(("length = \"panhard\"", 0.2));
        entries.push(("hardpoint = \"panhard_axle\", axis = \"z\"", 0.2));
        entries.push(("link = \"panhard\", relative = true", 0.02));
    }
    entries
}

fn known(steps: &[(&str, f64)]) -> String {
    let entry = |(part, step): &(&str, f64)| {
        let [low, high] = [step - NARROW, step + NARROW];
        format!("{{ {part}, limits = [{low:?}, {high:?}] }}")
    };
    let entries: Vec<String> = steps.iter().map(entry).collect();
    format!("builds = 2\nscatter = [{}]", entries.join(", "))
}

/// Returns the study text of the build whose parts deviate by these amounts.
fn built(text: &str, steps: &[(&str, f64)]) -> String {
    let study = study(text, &known(steps));
    let text = problem(&study).built_text(0);
    text.unwrap_or_else(|e| panic!("{e:?}"))
}

/// Gradients with respect to every part equal difference quotients of builds that are written as studies. Three central
/// differences are extrapolated to sixth order.
#[test]
fn gradients_are_slopes_of_builds() {
    for (kind, relaxed) in KINDS.into_iter().zip(["free", "at_design_load", "free"]) {
        let text = text(kind, relaxed, MOTION);
        let entries = entries(kind);
        let scatter: Vec<String> = entries
            .iter()
            .map(|(part, step)| format!("{{ {part}, sigma = {step:?} }}"))
            .collect();
        let study = study(&text, &format!("scatter = [{}]", scatter.join(", ")));
        let problem = problem(&study);
        let expansion = Expansion::of(&problem).unwrap();
        let mut looked_at = 0;
        for (number, (part, h)) in entries.iter().enumerate() {
            let at = |step: f64| values(&built(&text, &[(*part, step * h)]));
            let [a, b, c, d, e, f] = [-3.0, -2.0, -1.0, 1.0, 2.0, 3.0].map(at);
            let mut cell = 0;
            for station in problem.stations().of_motion() {
                for (output, column) in problem.outputs().iter().enumerate() {
                    let slope = 45.0 * (d[cell] - c[cell]) - 9.0 * (e[cell] - b[cell])
                        + (f[cell] - a[cell]);
                    let slope = slope / (60.0 * h * column.factor());
                    let found = expansion.gradient(problem.cell(output, station))[number];
                    // Equilibria are accurate to about 1e-11 of their values.
                    let size = (c[cell].abs() + d[cell].abs()).max(1e-2) * 1e-11 / h;
                    assert!(
                        (found - slope).abs() < 1e-6 * slope.abs() + size,
                        "{kind:?}, {part}, {} {station}: {found} {slope}",
                        column.name
                    );
                    looked_at += usize::from(slope.abs() > 1e3 * size);
                    cell += 1;
                }
            }
        }
        assert!(looked_at > 8 * entries.len(), "{kind:?}: {looked_at}");
    }
}

/// A build with known deviations, written as a study, has the values of the Monte Carlo analysis. So the written build
/// has the same tensions of the links and the same rates.
#[test]
fn written_builds_are_those_of_the_analysis() {
    for (kind, relaxed) in KINDS
        .into_iter()
        .zip(["at_design_load", "free", "at_design_load"])
    {
        let text = text(kind, relaxed, MOTION);
        let steps: Vec<(&str, f64)> = entries(kind)
            .into_iter()
            .enumerate()
            .map(|(k, (part, h))| {
                (
                    part,
                    h * (3.0 + (k % 3) as f64) * if k % 2 == 0 { 1.0 } else { -1.0 },
                )
            })
            .collect();
        let study = study(&text, &known(&steps));
        let problem = problem(&study);
        let drawn = problem.drawn().unwrap();
        let spreads = monte_carlo(&problem, &drawn, on).unwrap().spreads;
        let expected = values(&built(&text, &steps));
        let mut expected = expected.into_iter();
        for station in problem.stations().of_motion() {
            for (output, column) in problem.outputs().iter().enumerate() {
                let cell = problem.cell(output, station);
                let found = spreads[cell].mean * column.factor();
                let expected = expected.next().unwrap();
                let nominal = drawn[cell] * column.factor();
                let size = 1e-9 * expected.abs().max(1.0);
                let name = &column.name;
                assert!(
                    (found - expected).abs() < size,
                    "{kind:?}, {name}: {found} {expected}"
                );
                assert!(
                    (found - nominal).abs() > 1e-6,
                    "{kind:?}, {name}: no change"
                );
            }
        }
    }
}

fn norm(a: Point) -> f64 {
    dot(a, a).sqrt()
}

/// Points of both halves, with the actual y.
fn points(study: &Study) -> BTreeMap<String, Point> {
    let left = &study.axle().unwrap().axle.left;
    let named = left.mechanism.points.iter().zip(&left.design);
    named
        .map(|(point, place)| (point.name.clone(), place.to_array()))
        .collect()
}

/// Links of an axle: prefix of their names, left or right half, and both ends.
const LINKS: [(&str, usize, [&str; 2]); 5] = [
    ("lower_link", 0, ["lower_link_chassis", "lower_link_axle"]),
    (
        "lower_link",
        1,
        ["right_lower_link_chassis", "right_lower_link_axle"],
    ),
    ("upper_link", 0, ["upper_link_chassis", "upper_link_axle"]),
    (
        "upper_link",
        1,
        ["right_upper_link_chassis", "right_upper_link_axle"],
    ),
    ("panhard", 0, ["panhard_chassis", "panhard_axle"]),
];

/// Five links with deviations do not fit without force. The assembled axle keeps the shapes of body and axle and the
/// heights of both wheels. Each link is longer than its free length by tension divided by stiffness. The link forces
/// are in balance with vertical forces at the wheels.
#[test]
fn five_links_share_the_misfit_in_balance() {
    let text = text(Kind::FiveLink, "free", MOTION);
    let longer = [1.5, -1.0, 0.0, 0.8, -2.0];
    let softer = [0.0, 0.3, 0.0, 0.0, -0.2];
    let steps = [
        ("length = \"lower_link\", side = \"left\"", longer[0]),
        ("length = \"lower_link\", side = \"right\"", longer[1]),
        ("length = \"upper_link\", side = \"right\"", longer[3]),
        ("length = \"panhard\"", longer[4]),
        (
            "link = \"lower_link\", relative = true, side = \"right\"",
            softer[1],
        ),
        ("link = \"panhard\", relative = true", softer[4]),
    ];
    let nominal = study(&text, &known(&steps));
    let text = built(&text, &steps);
    let after = Study::elastic_from_text("built.toml", &text, Path::new("")).unwrap();
    let (before, now) = (points(&nominal), points(&after));
    let on_axle = |name: &&String| name.ends_with("_axle") || name.ends_with("wheel_centre");
    let carried: Vec<&String> = before.keys().filter(on_axle).collect();
    for (k, a) in carried.iter().enumerate() {
        for b in &carried[..k] {
            let [old, new] = [&before, &now].map(|own| norm(minus(own[*a], own[*b])));
            assert!((old - new).abs() < 1e-9, "{a} {b}");
        }
    }
    for name in before.keys().filter(|name| name.ends_with("_chassis")) {
        assert!(norm(minus(before[name], now[name])) < 1e-12, "{name}");
    }
    let centres = ["wheel_centre", "right_wheel_centre"];
    for name in centres {
        assert!((before[name][2] - now[name][2]).abs() < 1e-10, "{name}");
        assert!(
            norm(minus(before[name], now[name])) > 0.1,
            "{name} has not moved"
        );
    }
    let parts = |study: &Study| {
        let own = study.axle().unwrap().axle.elastic.clone().unwrap();
        (own.parts.wheels, own.link_names)
    };
    let (wheels, names) = parts(&after);
    let (mut force, mut moment) = ([0.0; 3], [0.0; 3]);
    let mut largest: f64 = 0.0;
    for (k, (name, half, [inner, outer])) in LINKS.into_iter().enumerate() {
        let number = names.iter().position(|own| own == name).unwrap();
        let part = &wheels[half].links[number];
        let hardpoint::compliance::AxialStiffness::Rate(rate) = part.stiffness else {
            panic!("a rate");
        };
        let (line, drawn) = (
            minus(now[outer], now[inner]),
            minus(before[outer], before[inner]),
        );
        let stretch = norm(line) - norm(drawn) - longer[k];
        assert!(
            (part.preload - rate * stretch).abs() < 1e-6,
            "{name}: {} {stretch}",
            part.preload
        );
        let pull = line.map(|c| -c * part.preload / norm(line));
        let about = cross(now[outer], pull);
        for i in 0..3 {
            force[i] += pull[i];
            moment[i] += about[i];
        }
        largest = larger(largest, part.preload.abs());
    }
    assert!(largest > 500.0, "{largest}");
    // The vertical forces at the wheel centres balance the vertical link force and the moments about x and y. The other
    // three sums are zero without them: forces along x and y, and the moment about z.
    assert!(
        force[0].abs() < 1e-7 * largest && force[1].abs() < 1e-7 * largest,
        "{force:?}"
    );
    assert!(moment[2].abs() < 1e-4 * largest, "{moment:?}");
    let [a, b] = centres.map(|name| now[name]);
    // f_a + f_b = -F, and the moments about x and y.
    let roll = -moment[0];
    let fa = (roll + force[2] * b[1]) / (a[1] - b[1]);
    let fb = -force[2] - fa;
    let pitch = moment[1] - a[0] * fa - b[0] * fb;
    assert!(pitch.abs() < 1e-4 * largest, "{pitch}");
}

/// Parts that deviate but still fit cause no tension. Here the Panhard rod is longer, and its bracket is farther away
/// along the same line by the same length.
#[test]
fn parts_that_fit_have_no_tension() {
    let symmetric = Scatter {
        points: 0.0,
        differs: false,
        rates: [4.0, 4.0],
        springs: true,
    };
    let text = made(Kind::FiveLink, symmetric, &mut Random(1), MOTION).text;
    let line = [0.0, 480.0 + 470.0, 360.0 - 335.0];
    let longer = 2.0;
    let [_, y, z] = line.map(|c| c * longer / norm(line));
    let tension = |steps: &[(&str, f64)]| {
        let text = built(&text, steps);
        let after = Study::elastic_from_text("built.toml", &text, Path::new("")).unwrap();
        let elastic = after.axle().unwrap().axle.elastic.clone().unwrap();
        let links = elastic
            .parts
            .wheels
            .into_iter()
            .flat_map(|wheel| wheel.links);
        links.map(|part| part.preload.abs()).fold(0.0, larger)
    };
    let steps = [
        ("hardpoint = \"panhard_chassis\", axis = \"y\"", y),
        ("hardpoint = \"panhard_chassis\", axis = \"z\"", z),
        ("length = \"panhard\"", longer),
    ];
    // The bound is the rounding of lengths of a metre times the stiffness.
    let fits = tension(&steps);
    assert!(fits < 1e-7, "{fits}");
    let misses = tension(&steps[..2]);
    assert!(misses > 100.0, "{misses}");
}

/// A part that exists only once on the axle has one rate. Its rate scatters with one random number and has no side.
#[test]
fn the_rate_of_a_single_link_scatters_once() {
    let text = text(Kind::ThreeLinkPanhard, "free", MOTION);
    for (name, sources) in [("panhard", 1), ("upper_link", 1), ("lower_link", 2)] {
        let scatter = format!("scatter = [{{ link = \"{name}\", sigma = 0.05, relative = true }}]");
        let study = study(&text, &scatter);
        assert_eq!(
            study.tolerance.as_ref().unwrap().sources(),
            sources,
            "{name}"
        );
        let variance = Expansion::of(&problem(&study)).unwrap().variance;
        assert!(variance.iter().any(|own| *own > 1e-14), "{name}");
    }
    let scatter =
        "scatter = [{ link = \"panhard\", sigma = 0.05, relative = true, side = \"left\" }]";
    let text = format!("{text}[tolerance]\n{scatter}\n");
    let found = Study::elastic_from_text("solid.toml", &text, Path::new("")).unwrap_err();
    assert!(
        found.to_string().contains("remove the key \"side\""),
        "{found}"
    );
}

const SCATTER: &str = "{ hardpoints = [\"lower_link_axle\", \"upper_link_chassis\"], sigma = 0.2 }, { length = \"lower_link\", sigma = 0.1 }, \
                       { hardpoint = \"wheel_centre\", axis = \"z\", sigma = 0.2 }";

/// For small scatter, the first-order standard deviations agree with those of the Monte Carlo analysis. The results do
/// not depend on SIMD lanes or on the number of CPU threads.
#[test]
fn first_order_is_the_monte_carlo_where_scatter_is_small() {
    for kind in KINDS {
        let text = text(kind, "at_design_load", MOTION);
        let scatter = format!(
            "builds = 200\nscatter = [{}, {{ link = \"lower_link\", sigma = 0.01, relative = true }}]",
            SCATTER.replace("0.2", "0.02").replace("0.1", "0.01")
        );
        let study = study(&text, &scatter);
        let problem = problem(&study);
        let expansion = Expansion::of(&problem).unwrap();
        let drawn = problem.drawn().unwrap();
        let on_threads = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.unwrap()
                .install(|| monte_carlo(&problem, &drawn, on).unwrap().spreads)
        };
        let (found, two) = (on_threads(1), on_threads(2));
        let one_by_one = monte_carlo_in(None, &problem, &drawn, on).unwrap().spreads;
        let mut looked_at = 0;
        for (cell, spread) in found.iter().enumerate() {
            assert_eq!(spread.mean.to_bits(), two[cell].mean.to_bits());
            assert_eq!(spread.sigma.to_bits(), two[cell].sigma.to_bits());
            let linear = expansion.variance[cell].sqrt();
            let size = 1e-9 * spread.mean.abs().max(1.0);
            assert!((spread.mean - one_by_one[cell].mean).abs() < size);
            if linear < 1e-9 {
                continue;
            }
            looked_at += 1;
            let off = (spread.sigma - linear).abs();
            assert!(
                off < 0.01 * linear + 4.5 * spread.sigma_error,
                "{kind:?}, {cell}: {spread:?} {linear}"
            );
        }
        // There are eleven outputs at two stations.
        assert!(looked_at >= 16, "{kind:?}: {looked_at}");
    }
}

/// With stiff links the tolerance results approach those of the rigid axle. The difference is proportional to one over
/// the stiffness.
#[test]
fn stiff_links_have_the_tolerance_of_the_rigid_axle() {
    for kind in [Kind::FourLink, Kind::ThreeLinkPanhard] {
        let text = text(kind, "free", RIGID_MOTION);
        let sigmas = |text: &str| -> Vec<f64> {
            let study = study(text, &format!("scatter = [{SCATTER}]"));
            let problem = problem(&study);
            let variance = Expansion::of(&problem).unwrap().variance;
            variance.iter().map(|own| own.sqrt()).collect()
        };
        let expected = sigmas(&rigid(&text));
        let errors: Vec<f64> = [1.0, 10.0, 100.0, 1e5]
            .into_iter()
            .map(|factor| {
                let found = sigmas(&stiffer(&text, factor));
                let errors = found.iter().zip(&expected).map(|(a, b)| (a - b).abs());
                errors.fold(0.0, larger)
            })
            .collect();
        for pair in errors[..3].windows(2) {
            assert!(
                (0.08..0.12).contains(&(pair[1] / pair[0])),
                "{kind:?}: {errors:?}"
            );
        }
        assert!(
            errors[0] > 1e-6 && errors[3] < 1e-4 * errors[0],
            "{kind:?}: {errors:?}"
        );
    }
}
