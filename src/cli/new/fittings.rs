//! Points of the parts that templates can have, with the coordinates of these points in each template.

/// Points of a part: name and description.
pub(super) type Points = &'static [(&'static str, &'static str)];

pub(super) const PUSHROD: Points = &[
    ("pushrod_outer", "pushrod at the {carrier}"),
    ("pushrod_inner", "pushrod at the rocker"),
    ("rocker_pivot_front", "front point of the rocker's axis"),
    ("rocker_pivot_rear", "rear point of the rocker's axis"),
    ("spring_lower", "spring and damper at the rocker"),
    ("spring_upper", "spring and damper at the body"),
];

pub(super) const ANTI_ROLL_BAR: Points = &[
    ("drop_link_outer", "drop link at the {carrier}"),
    ("drop_link_inner", "drop link at the lever of the bar"),
    ("anti_roll_bar_inner", "inboard point of the bar's axis"),
    ("anti_roll_bar_outer", "outboard point of the bar's axis"),
];

pub(super) const PANHARD: Points = &[
    (
        "upper_link_chassis",
        "upper link at the body; single, with its actual y",
    ),
    ("upper_link_axle", "upper link at the axle"),
    ("panhard_chassis", "Panhard rod at the body; actual y"),
    ("panhard_axle", "Panhard rod at the axle"),
];

pub(super) const FIVE_LINKS: Points = &[
    ("lower_link_axle", "lower link at the axle"),
    ("upper_link_chassis", "upper link at the body"),
    ("upper_link_axle", "upper link at the axle"),
    PANHARD[2],
    PANHARD[3],
];

/// Coordinates of the points of [`FIVE_LINKS`].
pub(super) const FIVE_LINKS_PLACES: [[f64; 3]; FIVE_LINKS.len()] = [
    [5.0, 450.0, 255.0],
    [480.0, 370.0, 465.0],
    [15.0, 350.0, 475.0],
    [-140.0, 480.0, 345.0],
    PANHARD_PLACES[3],
];

pub(super) const WATT: Points = &[
    PANHARD[0],
    PANHARD[1],
    (
        "watt_pivot",
        "pivot of the Watt rocker, on the axle; actual y",
    ),
    ("watt_axis", "a second point of the rocker's axis"),
    (
        "watt_upper_chassis",
        "upper Watt link at the body; actual y",
    ),
    ("watt_upper_rocker", "upper Watt link at the rocker"),
    (
        "watt_lower_chassis",
        "lower Watt link at the body; actual y",
    ),
    ("watt_lower_rocker", "lower Watt link at the rocker"),
];

/// Coordinates of the points of [`WATT`].
pub(super) const WATT_PLACES: [[f64; 3]; WATT.len()] = [
    PANHARD_PLACES[0],
    PANHARD_PLACES[1],
    [-150.0, 0.0, 340.0],
    [-100.0, 0.0, 340.0],
    [-150.0, 480.0, 400.0],
    [-150.0, 0.0, 410.0],
    [-150.0, -480.0, 280.0],
    [-150.0, 0.0, 270.0],
];

/// Coordinates of the points of [`PANHARD`] in the template of a solid axle.
pub(super) const PANHARD_PLACES: [[f64; 3]; PANHARD.len()] = [
    [420.0, 50.0, 470.0],
    [15.0, 70.0, 480.0],
    [-140.0, 480.0, 360.0],
    [-140.0, -470.0, 335.0],
];

pub(super) const DRAG_LINK: Points = &[
    ("kingpin_upper", "upper end of the kingpin, on the axle"),
    ("kingpin_lower", "lower end of the kingpin"),
    ("drag_link_body", "drag link at the steering gear; actual y"),
    (
        "drag_link_knuckle",
        "drag link at the left knuckle; actual y",
    ),
    ("tie_rod_end", "tie rod at the knuckle"),
];

/// Coordinates of the points of [`DRAG_LINK`] in the template of a solid axle that is changed to a front axle.
pub(super) const DRAG_LINK_PLACES: [[f64; 3]; DRAG_LINK.len()] = [
    [-12.0, 655.0, 430.0],
    [12.0, 680.0, 250.0],
    [190.0, -440.0, 365.0],
    [165.0, 590.0, 340.0],
    [-150.0, 620.0, 300.0],
];

/// Values that differ between templates. Coordinates are in the template's axes.
pub(super) struct Fitting {
    pub topology: &'static str,
    /// Hardpoint that the variables of `[sweep]` and `[optimise]` move.
    pub steers: &'static str,
    /// Body that carries the pushrod and the drop link.
    pub carrier: &'static str,
    pub pushrod: Option<[[f64; 3]; PUSHROD.len()]>,
    pub anti_roll_bar: Option<[[f64; 3]; ANTI_ROLL_BAR.len()]>,
}

pub(super) const FITTINGS: [Fitting; 9] = [
    Fitting {
        topology: "twist_beam",
        steers: "mount",
        carrier: "arm",
        pushrod: None,
        anti_roll_bar: None,
    },
    Fitting {
        topology: "trailing_arm_two_links",
        steers: "lower_link_inner",
        carrier: "arm",
        pushrod: Some([
            [70.0, 580.0, 270.0],
            [70.0, 442.0, 604.0],
            [90.0, 330.0, 520.0],
            [50.0, 330.0, 520.0],
            [70.0, 246.0, 632.0],
            [70.0, 46.0, 482.0],
        ]),
        anti_roll_bar: Some([
            [100.0, 580.0, 250.0],
            [100.0, 570.0, 380.0],
            [300.0, 50.0, 380.0],
            [300.0, 560.0, 380.0],
        ]),
    },
    Fitting {
        topology: "integral_link",
        steers: "toe_link_inner",
        carrier: "lower arm",
        pushrod: Some([
            [10.0, 580.0, 235.0],
            [10.0, 410.0, 500.0],
            [30.0, 330.0, 430.0],
            [-10.0, 330.0, 430.0],
            [10.0, 260.0, 520.0],
            [10.0, 60.0, 380.0],
        ]),
        anti_roll_bar: Some([
            [40.0, 560.0, 235.0],
            [40.0, 550.0, 360.0],
            [-160.0, 50.0, 360.0],
            [-160.0, 540.0, 360.0],
        ]),
    },
    Fitting {
        topology: "h_arm",
        steers: "lower_arm_front",
        carrier: "lower arm",
        pushrod: Some([
            [0.0, 590.0, 220.0],
            [0.0, 410.0, 490.0],
            [20.0, 330.0, 420.0],
            [-20.0, 330.0, 420.0],
            [0.0, 260.0, 510.0],
            [0.0, 60.0, 370.0],
        ]),
        anti_roll_bar: Some([
            [40.0, 560.0, 230.0],
            [40.0, 550.0, 350.0],
            [-160.0, 50.0, 350.0],
            [-160.0, 540.0, 350.0],
        ]),
    },
    Fitting {
        topology: "solid_axle",
        steers: "lower_link_chassis",
        carrier: "axle",
        pushrod: None,
        anti_roll_bar: Some([
            [-60.0, 520.0, 300.0],
            [-60.0, 515.0, 420.0],
            [-260.0, 50.0, 420.0],
            [-260.0, 510.0, 420.0],
        ]),
    },
    Fitting {
        topology: "macpherson",
        steers: "tie_rod_inner",
        carrier: "knuckle",
        pushrod: None,
        anti_roll_bar: Some([
            [40.0, 620.0, 230.0],
            [40.0, 610.0, 380.0],
            [-160.0, 50.0, 380.0],
            [-160.0, 600.0, 380.0],
        ]),
    },
    Fitting {
        topology: "double_wishbone",
        steers: "tie_rod_inner",
        carrier: "lower arm",
        pushrod: Some([
            [0.0, 600.0, 205.0],
            [0.0, 410.0, 470.0],
            [20.0, 330.0, 410.0],
            [-20.0, 330.0, 410.0],
            [0.0, 270.0, 490.0],
            [0.0, 70.0, 340.0],
        ]),
        anti_roll_bar: Some([
            [40.0, 560.0, 210.0],
            [40.0, 550.0, 340.0],
            [-160.0, 50.0, 340.0],
            [-160.0, 540.0, 340.0],
        ]),
    },
    Fitting {
        topology: "five_link",
        steers: "toe_link_inner",
        carrier: "knuckle",
        pushrod: Some([
            [-70.0, 640.0, 200.0],
            [-70.0, 442.0, 604.0],
            [-50.0, 330.0, 520.0],
            [-90.0, 330.0, 520.0],
            [-70.0, 246.0, 632.0],
            [-70.0, 46.0, 482.0],
        ]),
        anti_roll_bar: Some([
            [40.0, 660.0, 230.0],
            [40.0, 650.0, 380.0],
            [240.0, 50.0, 380.0],
            [240.0, 640.0, 380.0],
        ]),
    },
    Fitting {
        topology: "semi_trailing_arm",
        steers: "arm_pivot_inner",
        carrier: "arm",
        pushrod: Some([
            [70.0, 580.0, 270.0],
            [70.0, 442.0, 604.0],
            [90.0, 330.0, 520.0],
            [50.0, 330.0, 520.0],
            [70.0, 246.0, 632.0],
            [70.0, 46.0, 482.0],
        ]),
        anti_roll_bar: Some([
            [100.0, 560.0, 250.0],
            [100.0, 550.0, 380.0],
            [300.0, 50.0, 380.0],
            [300.0, 540.0, 380.0],
        ]),
    },
];
