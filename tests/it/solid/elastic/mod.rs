//! Tests of elastic solid axles against a second formulation, against the rigid program, and against mechanics.

mod agreement;
mod builds;
mod commands;
mod mechanics;
mod refused;
mod rigid_limit;
mod robust;
mod second;
mod set_up;
mod slopes;

use crate::support::random::Random;
use hardpoint::compliance::{AxleEquilibrium, ElasticAxle};
use hardpoint::model::Side;
use hardpoint::study::{AxleStudy, Study};
use second::{Axle, Link, Spring};
use std::fmt::Write as _;
use std::path::Path;

/// Kinds of axles. The link lengths and the heights of both wheels together give these kinds 6, 6 and 7 equations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    FourLink,
    ThreeLinkPanhard,
    FiveLink,
}

/// Axle as the text of a study, and in vehicle coordinates for the second formulation.
#[derive(Clone, Debug)]
pub struct Made {
    pub text: String,
    pub axle: Axle,
}

const RADIUS: f64 = 335.0;

/// Points of the left half: name, and position before random displacements.
const POINTS: [(&str, [f64; 3]); 4] = [
    ("lower_link_chassis", [540.0, 420.0, 305.0]),
    ("lower_link_axle", [5.0, 530.0, 255.0]),
    ("upper_link_chassis", [440.0, 370.0, 445.0]),
    ("upper_link_axle", [15.0, 350.0, 475.0]),
];
/// Converging pair of upper links.
const SPLAYED: [[f64; 3]; 2] = [[340.0, 470.0, 445.0], [15.0, 150.0, 475.0]];
/// Single upper link.
const SINGLE: [[f64; 3]; 2] = [[420.0, 50.0, 470.0], [15.0, 70.0, 480.0]];
const PANHARD: [(&str, [f64; 3]); 2] = [
    ("panhard_chassis", [-140.0, 480.0, 360.0]),
    ("panhard_axle", [-140.0, -470.0, 335.0]),
];
const SPRING: [(&str, [f64; 3]); 2] = [
    ("spring_upper", [40.0, 460.0, 650.0]),
    ("spring_lower", [60.0, 500.0, 350.0]),
];

fn flipped([x, y, z]: [f64; 3]) -> [f64; 3] {
    [x, -y, z]
}

fn line(name: &str, [x, y, z]: [f64; 3]) -> String {
    format!("{name} = [{x:?}, {y:?}, {z:?}]\n")
}

/// Ranges of an axle's random values, and its options.
#[derive(Clone, Copy, Debug)]
pub struct Scatter {
    /// Largest random displacement of a point along each axis, in mm.
    pub points: f64,
    /// True if the right half has other points, rates and springs.
    pub differs: bool,
    /// Decimal logarithms of the smallest and the largest rate.
    pub rates: [f64; 2],
    /// True if the axle has springs.
    pub springs: bool,
}

/// Random axle: the text of its study, and the same axle in vehicle coordinates. `further` is appended to the text.
pub fn made(kind: Kind, scatter: Scatter, random: &mut Random, further: &str) -> Made {
    let mut near = |place: [f64; 3]| place.map(|c| c + scatter.points * random.signed());
    let mut points: Vec<(&'static str, [f64; 3])> =
        POINTS.iter().map(|(n, p)| (*n, near(*p))).collect();
    let uppers = match kind {
        Kind::FourLink => Some(SPLAYED),
        Kind::ThreeLinkPanhard => Some(SINGLE),
        Kind::FiveLink => None,
    };
    if let Some([chassis, axle]) = uppers {
        (points[2].1, points[3].1) = (near(chassis), near(axle));
    }
    let rod: Vec<_> = PANHARD.iter().map(|(n, p)| (*n, near(*p))).collect();
    let seats: Vec<_> = SPRING.iter().map(|(n, p)| (*n, near(*p))).collect();
    let centre = near([0.0, 760.0, RADIUS]);
    let is_single = |name: &str| kind == Kind::ThreeLinkPanhard && name.starts_with("upper");
    let mut right = String::new();
    let mut others = Vec::new();
    for (name, place) in points.iter().chain(&seats) {
        let other = if scatter.differs && !is_single(name) {
            near(*place)
        } else {
            *place
        };
        others.push(flipped(other));
        if other != *place {
            right += &line(name, flipped(other));
        }
    }
    let [least, most] = scatter.rates;
    let mut rate = || 10.0_f64.powf(least + (most - least) * 0.5 * (1.0 + random.signed()));
    let rates = [rate(), rate(), rate()];
    let right_lower = if scatter.differs { rate() } else { rates[0] };
    let mut links = Vec::new();
    let mut link = |name: &str, body: [f64; 3], axle: [f64; 3], rate: f64| {
        let name = name.to_owned();
        links.push(Link {
            name,
            body,
            axle,
            rate,
        });
    };
    link("lower_link", points[0].1, points[1].1, rates[0]);
    link("lower_link", others[0], others[1], right_lower);
    link("upper_link", points[2].1, points[3].1, rates[1]);
    if kind != Kind::ThreeLinkPanhard {
        link("upper_link", others[2], others[3], rates[1]);
    }
    if kind != Kind::FourLink {
        link("panhard", rod[0].1, rod[1].1, rates[2]);
    }
    let force = 4000.0 + 1000.0 * random.signed();
    let spring_rate = 35.0 + 10.0 * random.signed();
    let (camber, toe) = (1.5 * random.signed(), 0.5 * random.signed());
    let (sin_c, cos_c) = camber.to_radians().sin_cos();
    let (sin_t, cos_t) = toe.to_radians().sin_cos();
    let axis = [cos_c * sin_t, cos_c * cos_t, -sin_c];
    let spring = |body, axle| Spring {
        body,
        axle,
        force,
        rate: spring_rate,
    };
    let springs = if scatter.springs {
        vec![spring(seats[0].1, seats[1].1), spring(others[4], others[5])]
    } else {
        Vec::new()
    };

    points.extend(seats.iter().copied());
    points.extend(rod.iter().copied().filter(|_| kind != Kind::FourLink));
    points.push(("wheel_centre", centre));
    let text = text_of(&Written {
        kind,
        points,
        right,
        angles: [camber, toe],
        rates,
        right_lower,
        spring: scatter.springs.then_some([force, spring_rate]),
    });
    Made {
        text: text + further,
        axle: Axle {
            links,
            springs,
            wheels: [(centre, axis), (flipped(centre), flipped(axis))],
            radius: RADIUS,
        },
    }
}

/// Values from which the text of a study is made.
struct Written {
    kind: Kind,
    points: Vec<(&'static str, [f64; 3])>,
    /// Lines that define the points of the right half.
    right: String,
    /// Static camber and toe.
    angles: [f64; 2],
    rates: [f64; 3],
    right_lower: f64,
    /// Force and rate of the springs. `None` without springs.
    spring: Option<[f64; 2]>,
}

fn text_of(own: &Written) -> String {
    let mut text = String::from("[suspension]\ntopology = \"solid_axle\"\n");
    if own.kind == Kind::ThreeLinkPanhard {
        text += "single = [\"upper_link\"]\n";
    }
    text += "[suspension.hardpoints]\n";
    for (name, place) in &own.points {
        text += &line(name, *place);
    }
    if !own.right.is_empty() {
        let _ = write!(text, "[axle.right.hardpoints]\n{}", own.right);
    }
    let ([camber, toe], rates) = (own.angles, own.rates);
    let _ = write!(
        text,
        "[wheel]\nradius = {RADIUS:?}\nstatic_camber = {camber:?}\nstatic_toe = {toe:?}\n\
         [compliance]\nrelaxed = \"free\"\n[links.lower_link]\naxial_stiffness = {:?}\n\
         [links.upper_link]\naxial_stiffness = {:?}\n",
        rates[0], rates[1]
    );
    if own.kind != Kind::FourLink {
        let _ = writeln!(text, "[links.panhard]\naxial_stiffness = {:?}", rates[2]);
    }
    if own.right_lower != rates[0] {
        let rate = own.right_lower;
        let _ = writeln!(
            text,
            "[axle.right.links.lower_link]\naxial_stiffness = {rate:?}"
        );
    }
    if let Some([force, rate]) = own.spring {
        let _ = writeln!(text, "[spring]\nforce = {force:?}\nrate = {rate:?}");
    }
    text
}

/// Placeholder motion for tests of single states.
pub const STILL: &str = "[motion]\nheave = [0.0]\n";

pub fn study(text: &str) -> AxleStudy {
    let read = Study::elastic_from_text("solid.toml", text, Path::new(""));
    let read = read.unwrap_or_else(|errors| panic!("{errors}\n{text}"));
    read.axle().expect("an axle").clone()
}

/// Elastic axle of a study.
pub fn elastic(study: &AxleStudy) -> ElasticAxle {
    let axle = &study.axle;
    let parts = &axle.elastic.as_ref().expect("elastic parts").parts;
    let sides = Side::ALL.map(|side| axle.suspension(side));
    let designs = sides.map(|side| &side.design[..]);
    ElasticAxle::of(sides, designs, parts).unwrap_or_else(|e| panic!("{e:?}"))
}

/// Returns the results of the program, in the order of the second formulation.
pub fn results(axle: &ElasticAxle, at: &AxleEquilibrium) -> Vec<f64> {
    let mut found = Vec::new();
    for side in Side::ALL {
        let own = axle.figures(at, side);
        let out = if side == Side::Left { 1.0 } else { -1.0 };
        found.extend([own.toe, own.camber]);
        for point in [own.centre, own.contact] {
            found.extend([point.x, out * point.y, point.z]);
        }
    }
    let place = axle.place(at).expect("a solid axle");
    found.push((-place.line.x).atan2(place.line.y));
    found.push(place.forward.z.atan2(place.forward.x));
    found.extend(place.middle.to_array());
    found
}

/// Returns the index of a link among the links of a half.
pub fn number_of(study: &AxleStudy, name: &str) -> usize {
    let names = &study
        .axle
        .elastic
        .as_ref()
        .expect("elastic parts")
        .link_names;
    names.iter().position(|own| own == name).expect("a link")
}

/// Returns the tensions in the order of the second formulation's links. If two links have one name, the second one
/// belongs to the right half.
pub fn tensions(
    made: &Made,
    study: &AxleStudy,
    axle: &ElasticAxle,
    at: &AxleEquilibrium,
) -> Vec<f64> {
    let own = Side::ALL.map(|side| axle.tensions(at, side));
    let links = &made.axle.links;
    let of = |(k, link): (usize, &Link)| {
        let is_second = links[..k].iter().any(|before| before.name == link.name);
        own[usize::from(is_second)][number_of(study, &link.name)].unwrap()
    };
    links.iter().enumerate().map(of).collect()
}

/// Returns true for results that are angles.
pub fn is_angle(number: usize) -> bool {
    matches!(number, 0 | 1 | 8 | 9 | 16 | 17)
}
