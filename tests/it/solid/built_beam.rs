//! Independent formulation of built twist beams: two rigid bodies, each with a position and a quaternion. The mounts on
//! the body and on the arms are separate points.

use super::own::{Point, minus, mirror, turned};
use super::twist_beam::{Unknowns, carried, half, in_steps};
use hardpoint::study::Study;
use std::path::Path;

/// Points of the left half.
const NOMINAL: [(&str, Point); 4] = [
    ("mount", [410.0, 530.0, 340.0]),
    ("shear_centre", [300.0, 0.0, 390.0]),
    ("wheel_centre", [0.0, 740.0, 300.0]),
    ("spindle_inner", [1.5, 640.0, 298.0]),
];

pub(super) fn study(motion: &str, further: &str) -> Study {
    study_of(motion, OUTPUTS, further)
}

/// Study with these outputs.
pub(super) fn study_of(motion: &str, outputs: &str, further: &str) -> Study {
    let points: String = NOMINAL
        .iter()
        .map(|(name, place)| format!("{name} = {place:?}\n"))
        .collect();
    let text = format!(
        "[suspension]\ntopology = \"twist_beam\"\n[suspension.hardpoints]\n{points}[wheel]\nradius = 300.0\n\
         [vehicle]\nwheelbase = 2600.0\ncg_height = 550.0\nposition = \"rear\"\nbrakes = \"outboard\"\nbrake_share_front = 0.7\n\
         [motion]\n{motion}\n[outputs]\ncharacteristics = [{outputs}]\n{further}\n"
    );
    Study::from_text("beam.toml", &text, Path::new("")).unwrap_or_else(|e| panic!("{e}"))
}

pub(super) const OUTPUTS: &str = r#""camber", "toe", "mean_steer", "track", "axle_lateral", "beam_twist", "roll_steer", "anti_lift""#;
pub(super) const HEAVE: &str = "heave = [0.0]";
pub(super) const ROLL: &str = "roll = [-2.0, 0.0, 1.5]\nheave = [-20.0]";

/// Dimensions of a beam with their actual y: positions of the mounts on the body, and the shapes of both halves.
pub(super) struct Parts {
    mounts: [Point; 2],
    shear_centre: Point,
    centres: [Point; 2],
    spindles: [Point; 2],
}

pub(super) fn nominal(name: &str, side: usize) -> Point {
    let own = NOMINAL.iter().find(|(own, _)| *own == name).unwrap().1;
    if side == 0 { own } else { mirror(own) }
}

impl Parts {
    pub(super) fn nominal() -> Self {
        let both = |name| [0, 1].map(|side| nominal(name, side));
        Parts {
            mounts: both("mount"),
            shear_centre: nominal("shear_centre", 0),
            centres: both("wheel_centre"),
            spindles: both("spindle_inner"),
        }
    }

    /// Changes a part by its name, such as `left mount x`. Parts of the right half change in mirror image.
    pub(super) fn change(&mut self, name: &str, by: f64) {
        let words: Vec<&str> = name.split(' ').collect();
        let (side, point, axis) = match words[..] {
            ["left", point, axis] => (0, point, axis),
            ["right", point, axis] => (1, point, axis),
            [point, axis] => (0, point, axis),
            _ => panic!("{name}"),
        };
        let place = match point {
            "mount" => &mut self.mounts[side],
            "shear_centre" => &mut self.shear_centre,
            "wheel_centre" => &mut self.centres[side],
            _ => &mut self.spindles[side],
        };
        let axis = ["x", "y", "z"].iter().position(|own| *own == axis).unwrap();
        place[axis] += if side == 1 && axis == 1 { -by } else { by };
    }

    /// Returns the parts of a build, from the build's random numbers.
    pub(super) fn of_build(study: &Study, build: u64) -> Self {
        let tolerance = study.tolerance.as_ref().unwrap();
        let mut draws = vec![0.0; tolerance.sources()];
        tolerance.draw(build, &mut draws);
        let mut parts = Parts::nominal();
        let sources = tolerance.scatter.iter().flat_map(|c| &c.sources);
        for (source, draw) in sources.zip(draws) {
            parts.change(&source.name, draw);
        }
        parts
    }

    /// Returns the residuals. Hinge and mounts hold both halves, and the wheel centres are at their nominal heights plus
    /// the travels. The arms may move sideways relative to the body's mounts, by equal and opposite distances.
    fn residuals(&self, x: &Unknowns, travels: [f64; 2]) -> Unknowns {
        let centre = self.shear_centre;
        let [left, right] = [0, 1].map(|side| carried(x, side, centre));
        let [along, other] = [0, 1].map(|side| turned(half(x, side).1, [0.0, 300.0, 0.0]));
        let mounts =
            [0, 1].map(|side| minus(carried(x, side, nominal("mount", side)), self.mounts[side]));
        let height = |side: usize| {
            let now = carried(x, side, self.centres[side]);
            now[2] - nominal("wheel_centre", side)[2] - travels[side]
        };
        let unit = |side: usize| {
            let (_, q) = half(x, side);
            300.0 * (q.iter().map(|c| c * c).sum::<f64>() - 1.0)
        };
        [
            left[0] - right[0],
            left[1] - right[1],
            left[2] - right[2],
            along[0] - other[0],
            along[2] - other[2],
            mounts[0][0],
            mounts[0][2],
            mounts[1][0],
            mounts[1][2],
            mounts[0][1] + mounts[1][1],
            height(0),
            height(1),
            unit(0),
            unit(1),
        ]
    }

    pub(super) fn solved(&self, travels: [f64; 2]) -> Unknowns {
        in_steps(travels, |x, travels| self.residuals(x, travels))
    }

    /// Wheel centre and outboard spin axis of a wheel, with their actual y.
    pub(super) fn wheel(&self, x: &Unknowns, side: usize) -> [Point; 2] {
        let [centre, spindle] =
            [self.centres[side], self.spindles[side]].map(|point| carried(x, side, point));
        let way = minus(centre, spindle);
        let length = way.iter().map(|c| c * c).sum::<f64>().sqrt();
        [centre, way.map(|c| c / length)]
    }
}

/// Camber and toe from the outboard spin axis, in degrees.
pub(super) fn angles([x, y, z]: Point) -> [f64; 2] {
    let camber = (-z).atan2(x.hypot(y));
    [camber.to_degrees(), x.atan2(y.abs()).to_degrees()]
}
