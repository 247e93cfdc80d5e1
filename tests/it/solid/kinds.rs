//! Solid axles of each kind, with scatter of every part.

use super::own::Point;
use hardpoint::study::Study;
use std::path::Path;

/// Hinged bodies: two points of the hinge axis, and the points of the body.
type Rockers = &'static [([&'static str; 2], &'static [&'static str])];

/// Solid axle.
pub struct Kind {
    pub name: &'static str,
    /// Hardpoints of the left half, and those that the axle has only once.
    pub points: &'static [(&'static str, Point)],
    has_single_upper_link: bool,
    /// Hinged bodies of both halves, with the names that the left wheel's mechanism uses.
    pub rockers: Rockers,
}

/// One solid axle of each kind without a surplus link: with rigid links, these axles can move.
pub const KINDS: &[Kind] = &[
    Kind {
        name: "four links and an anti-roll bar",
        points: &[
            ("lower_link_chassis", [540.0, 420.0, 305.0]),
            ("lower_link_axle", [5.0, 530.0, 255.0]),
            ("upper_link_chassis", [340.0, 470.0, 445.0]),
            ("upper_link_axle", [15.0, 150.0, 475.0]),
            ("wheel_centre", [0.0, 760.0, 335.0]),
            ("spring_upper", [40.0, 460.0, 650.0]),
            ("spring_lower", [60.0, 500.0, 350.0]),
            ("drop_link_outer", [-60.0, 520.0, 300.0]),
            ("drop_link_inner", [-60.0, 515.0, 420.0]),
            ("anti_roll_bar_inner", [-260.0, 50.0, 420.0]),
            ("anti_roll_bar_outer", [-260.0, 510.0, 420.0]),
        ],
        has_single_upper_link: false,
        rockers: &[(
            ["anti_roll_bar_inner", "anti_roll_bar_outer"],
            &["drop_link_inner"],
        )],
    },
    Kind {
        name: "Watt linkage on the axle",
        points: &[
            ("lower_link_chassis", [540.0, 420.0, 305.0]),
            ("lower_link_axle", [5.0, 530.0, 255.0]),
            ("upper_link_chassis", [420.0, 50.0, 470.0]),
            ("upper_link_axle", [15.0, 70.0, 480.0]),
            ("wheel_centre", [0.0, 760.0, 335.0]),
            ("spindle_inner", [1.0, 600.0, 334.0]),
            ("watt_pivot", [-150.0, 0.0, 340.0]),
            ("watt_axis", [-100.0, 0.0, 340.0]),
            ("watt_upper_chassis", [-150.0, 480.0, 400.0]),
            ("watt_upper_rocker", [-150.0, 0.0, 410.0]),
            ("watt_lower_chassis", [-150.0, -480.0, 280.0]),
            ("watt_lower_rocker", [-150.0, 0.0, 270.0]),
        ],
        has_single_upper_link: true,
        rockers: &[(
            ["watt_pivot", "watt_axis"],
            &["watt_upper_rocker", "watt_lower_rocker"],
        )],
    },
    Kind {
        name: "Watt linkage on the body",
        points: &[
            ("lower_link_chassis", [540.0, 420.0, 305.0]),
            ("lower_link_axle", [5.0, 530.0, 255.0]),
            ("upper_link_chassis", [420.0, 50.0, 470.0]),
            ("upper_link_axle", [15.0, 70.0, 480.0]),
            ("wheel_centre", [0.0, 760.0, 335.0]),
            ("watt_pivot", [-150.0, 10.0, 340.0]),
            ("watt_axis", [-100.0, 0.0, 345.0]),
            ("watt_upper_axle", [-150.0, 480.0, 400.0]),
            ("watt_upper_rocker", [-150.0, 5.0, 410.0]),
            ("watt_lower_axle", [-150.0, -480.0, 280.0]),
            ("watt_lower_rocker", [-150.0, 0.0, 270.0]),
        ],
        has_single_upper_link: true,
        rockers: &[(
            ["watt_pivot", "watt_axis"],
            &["watt_upper_rocker", "watt_lower_rocker"],
        )],
    },
    Kind {
        name: "Panhard rod, drag link and tie rod",
        points: &[
            ("lower_link_chassis", [-840.0, 420.0, 385.0]),
            ("lower_link_axle", [-5.0, 430.0, 305.0]),
            ("upper_link_chassis", [-640.0, 270.0, 525.0]),
            ("upper_link_axle", [-15.0, 250.0, 555.0]),
            ("panhard_chassis", [130.0, -480.0, 560.0]),
            ("panhard_axle", [120.0, 470.0, 500.0]),
            ("wheel_centre", [0.0, 760.0, 375.0]),
            ("kingpin_upper", [-18.0, 650.0, 470.0]),
            ("kingpin_lower", [12.0, 675.0, 280.0]),
            ("drag_link_body", [190.0, -420.0, 545.0]),
            ("drag_link_knuckle", [160.0, 560.0, 480.0]),
            ("tie_rod_end", [-150.0, 610.0, 330.0]),
        ],
        has_single_upper_link: true,
        rockers: &[
            (
                ["kingpin_lower", "kingpin_upper"],
                &["wheel_centre", "tie_rod_end", "drag_link_knuckle"],
            ),
            (
                ["right_kingpin_lower", "right_kingpin_upper"],
                &["right_wheel_centre", "right_tie_rod_end"],
            ),
        ],
    },
];

/// Outputs that SIMD lanes can compute.
const OUTPUTS: &str =
    r#""camber", "toe", "mean_steer", "roll_steer", "force_roll_centre_height", "track""#;

impl Kind {
    pub fn is_steered(&self) -> bool {
        self.has("drag_link_body")
    }

    fn has(&self, name: &str) -> bool {
        self.points.iter().any(|(own, _)| *own == name)
    }

    /// Returns true for a point that exists only once on the axle.
    pub fn is_single(&self, name: &str) -> bool {
        let of_once = ["panhard_", "watt_", "drag_link_"];
        of_once.iter().any(|of| name.starts_with(of))
            || self.has_single_upper_link && name.starts_with("upper_link_")
    }

    /// Returns the names of a point in both halves. For a point that exists once, returns this name.
    pub fn both(&self, name: &str) -> Vec<String> {
        if self.is_single(name) {
            vec![name.to_owned()]
        } else {
            vec![name.to_owned(), format!("right_{name}")]
        }
    }

    /// Points of the body of the car.
    pub fn on_body(&self) -> impl Iterator<Item = &'static str> {
        let on_body = |name: &str| {
            let own = [
                "spring_upper",
                "drag_link_body",
                "anti_roll_bar_inner",
                "anti_roll_bar_outer",
            ];
            let is_watt_axis = ["watt_pivot", "watt_axis"].contains(&name);
            name.ends_with("_chassis")
                || own.contains(&name)
                || is_watt_axis && self.has("watt_upper_axle")
        };
        let names = self.points.iter().map(|(name, _)| *name);
        names.filter(move |name| on_body(name))
    }

    /// Points of the axle itself.
    pub fn on_axle(&self) -> impl Iterator<Item = &'static str> {
        let on_body: Vec<&str> = self.on_body().collect();
        let names = self.points.iter().map(|(name, _)| *name);
        names.filter(move |name| {
            let mut rockers = self.rockers.iter();
            !on_body.contains(name) && !rockers.any(|(_, points)| points.contains(name))
        })
    }

    /// Rods with their ends: those of both halves, and those that the axle has only once.
    pub fn members(&self) -> Vec<(String, [String; 2])> {
        let rods = [
            ("lower_link", "lower_link_chassis", "lower_link_axle"),
            ("upper_link", "upper_link_chassis", "upper_link_axle"),
            ("panhard", "panhard_chassis", "panhard_axle"),
            ("watt_upper", "watt_upper_chassis", "watt_upper_rocker"),
            ("watt_upper", "watt_upper_axle", "watt_upper_rocker"),
            ("watt_lower", "watt_lower_chassis", "watt_lower_rocker"),
            ("watt_lower", "watt_lower_axle", "watt_lower_rocker"),
            ("drag_link", "drag_link_body", "drag_link_knuckle"),
            ("drop_link", "drop_link_inner", "drop_link_outer"),
        ];
        let mut members = Vec::new();
        for (name, inner, outer) in rods {
            if self.has(inner) && self.has(outer) {
                members.push((name.to_owned(), [inner.to_owned(), outer.to_owned()]));
                if !self.is_single(inner) {
                    let right = |name: &str| format!("right_{name}");
                    members.push((right(name), [right(inner), right(outer)]));
                }
            }
        }
        if self.has("tie_rod_end") {
            let ends = ["tie_rod_end", "right_tie_rod_end"].map(str::to_owned);
            members.push(("tie_rod".to_owned(), ends));
        }
        members
    }

    /// Entries that scatter every point and every length.
    pub fn scatter(&self, sigma: f64) -> String {
        let names: Vec<String> = self
            .points
            .iter()
            .map(|(name, _)| format!("\"{name}\""))
            .collect();
        let mut entries = format!(
            "{{ hardpoints = [{}], sigma = {sigma:?} }}",
            names.join(", ")
        );
        for (name, _) in self.members() {
            if !name.starts_with("right_") {
                entries += &format!(", {{ length = \"{name}\", sigma = {sigma:?} }}");
            }
        }
        entries
    }

    /// Makes a study with this scatter and these further keys of `[tolerance]`. The motion is a position with roll, heave
    /// and steer.
    pub fn study(&self, scatter: &str, further: &str) -> Study {
        self.study_of(
            (scatter, further),
            "roll = [-2.0, 0.0, 1.5]\nheave = [-20.0, 0.0]\n",
            OUTPUTS,
        )
    }

    /// Makes the same study with this motion and these outputs.
    pub fn study_of(&self, (scatter, further): (&str, &str), motion: &str, outputs: &str) -> Study {
        let mut text = String::from("[suspension]\ntopology = \"solid_axle\"\n");
        if self.has_single_upper_link {
            text += "single = [\"upper_link\"]\n";
        }
        text += "[suspension.hardpoints]\n";
        for (name, [x, y, z]) in self.points {
            text += &format!("{name} = [{x:?}, {y:?}, {z:?}]\n");
        }
        text += "[wheel]\nradius = 330.0\n";
        if !self.has("spindle_inner") {
            text += "static_camber = -0.5\nstatic_toe = 0.1\n";
        }
        let rack = if self.is_steered() {
            "rack = [0.0, 15.0]\n"
        } else {
            ""
        };
        text += &format!(
            "[vehicle]\nwheelbase = 2700.0\ncg_height = 620.0\nposition = \"rear\"\nbrakes = \"outboard\"\n\
             brake_share_front = 0.6\ndrive_torque = \"carrier\"\ndrive_share_front = 0.0\n\
             [motion]\n{motion}{rack}[outputs]\ncharacteristics = [{outputs}]\n\
             [tolerance]\nseed = 3\n{further}scatter = [{scatter}]\n"
        );
        let study = Study::from_text("solid.toml", &text, Path::new("."));
        study.unwrap_or_else(|e| panic!("{}: {e}\n{text}", self.name))
    }
}
