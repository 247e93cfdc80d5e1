//! Tables in the layout of OptimumKinematics.
//!
//! The layout is based on public descriptions and readers of such files, not on an original file. The name is in column B, the
//! left wheel in C to E, the right wheel in G to I. Column A has a title for each group of points. The axes are x forward, y left
//! and z up. Toe-out is positive. The half track is that of the contact point. In the plane of the wheel, the wheel centre is
//! half of the tyre's diameter above the contact point. With a spin axis a (outboard), radius R and upward direction z,
//!
//! ```text
//! C = W - R (z - (z.a) a) / |z - (z.a) a|                                                        (1)
//! ```
//!
//! C is (longitudinal offset, half track, vertical offset), and W is the wheel centre.

use super::outgoing::Outgoing;
use super::workbook::Value;
use crate::model::{Body, FrameConvention, LengthUnit, PointId, Rocker, Side};
use crate::number::Vector3;

/// Rows of a table, and notes about parts of the study that the layout cannot hold.
pub type RowsAndNotes = (Vec<Vec<Value>>, Vec<String>);

/// Hardpoints of a double wishbone with their names in OptimumKinematics.
const ARMS: [(&str, &str); 8] = [
    ("lower_arm_front", "CHAS_LowFor"),
    ("lower_arm_rear", "CHAS_LowAft"),
    ("upper_arm_front", "CHAS_UppFor"),
    ("upper_arm_rear", "CHAS_UppAft"),
    ("lower_ball_joint", "UPRI_LowPnt"),
    ("upper_ball_joint", "UPRI_UppPnt"),
    ("tie_rod_inner", "CHAS_TiePnt"),
    ("tie_rod_outer", "UPRI_TiePnt"),
];

/// Hardpoints of spring and rocker. The ends of the rod are `pushrod` or `pullrod`.
const ROCKER: [(&str, &str); 6] = [
    ("ROD_outer", "NSMA_PPAttPnt_L"),
    ("spring_upper", "CHAS_AttPnt_L"),
    ("rocker_pivot_rear", "CHAS_RocAxi_L"),
    ("rocker_pivot_front", "CHAS_RocPiv_L"),
    ("ROD_inner", "ROCK_RodPnt_L"),
    ("spring_lower", "ROCK_CoiPnt_L"),
];

/// Hardpoints of an anti-roll bar that lies across the car.
const BAR: [(&str, &str); 3] = [
    ("drop_link_outer", "NSMA_UBarAttPnt_L"),
    ("drop_link_inner", "UBAR_AttPnt_L"),
    ("anti_roll_bar_outer", "CHAS_PivPnt_L"),
];

/// Makes the rows of the OptimumKinematics table for a study, and notes about the parts that this layout cannot hold.
///
/// # Errors
///
/// The layout does not support the topology. Or the study has no wheel radius, which gives the wheel centre from the
/// contact point.
pub fn optimum_k_rows(outgoing: &Outgoing<'_>) -> Result<RowsAndNotes, String> {
    let topology = outgoing.study.wheel().mechanism.topology;
    if topology.name != "double_wishbone" {
        return Err(format!(
            "there is no public description of a {} in files of OptimumKinematics; --to optimumk \
             is available for a double_wishbone",
            topology.name
        ));
    }
    let outgoing = outgoing.in_convention(FrameConvention::Iso8855);
    let mut table = Table {
        outgoing: &outgoing,
        rows: Vec::new(),
        written: Vec::new(),
        notes: Vec::new(),
    };
    table.title();
    table.points(
        "Double A-Arm",
        &ARMS.map(|(own, name)| (own.to_owned(), name)),
    );
    table.rocker();
    table.bar();
    table.wheels()?;
    table.attachments();
    table.say_what_is_left_out();
    Ok((table.rows, table.notes))
}

struct Table<'a> {
    outgoing: &'a Outgoing<'a>,
    rows: Vec<Vec<Value>>,
    /// Names of the hardpoints that already have a row.
    written: Vec<String>,
    notes: Vec<String>,
}

fn text(text: &str) -> Value {
    match text {
        "" => Value::Empty,
        text => Value::Text(text.to_owned()),
    }
}

impl Table<'_> {
    fn row<const N: usize>(&mut self, cells: [&str; N]) {
        self.rows.push(cells.map(text).to_vec());
    }

    fn title(&mut self) {
        let name = self.outgoing.study.name.clone();
        let (word, symbol) = match self.outgoing.unit {
            LengthUnit::Millimetre => ("millimeter", "mm"),
            LengthUnit::Metre => ("meter", "m"),
            LengthUnit::Inch | LengthUnit::InchPound => ("inch", "in"),
        };
        let version = concat!("hardpoint ", env!("CARGO_PKG_VERSION"));
        self.row(["", "Name:", &name]);
        self.row(["", "Type:", "Suspension", "Created by:", version]);
        self.row(["", "Frame:", self.outgoing.convention.name()]);
        self.row(["User Options", "Length", word, symbol]);
        self.row(["", "Angle", "degree", "deg"]);
    }

    /// Writes a group of points for the left and the right wheel.
    fn points(&mut self, title: &str, names: &[(String, &str)]) {
        self.rows.push(Vec::new());
        self.row([title, "Point Name", "Left", "", "", "", "Right", "", ""]);
        self.row(["", "", "X", "Y", "Z", "", "X", "Y", "Z"]);
        for (own, name) in names {
            let mut row = vec![Value::Empty, text(name)];
            for side in Side::ALL {
                let id = self.point(own).expect("a group is given completely");
                row.extend(self.outgoing.position(side, id).map(Value::Number));
                row.extend((side == Side::Left).then_some(Value::Empty));
            }
            self.rows.push(row);
            self.written.push(own.clone());
        }
    }

    fn point(&self, name: &str) -> Option<PointId> {
        self.outgoing.study.wheel().mechanism.point(name)
    }

    fn spring_rocker(&self) -> Option<Rocker> {
        let mechanism = &self.outgoing.study.wheel().mechanism;
        mechanism.spring_rocker().map(|id| mechanism.rocker(id))
    }

    fn rocker(&mut self) {
        let Some(rocker) = self.spring_rocker() else {
            return;
        };
        let rod = rocker.rod.to_string();
        let names = ROCKER.map(|(own, name)| (own.replace("ROD", &rod), name));
        if names.iter().all(|(own, _)| self.point(own).is_some()) {
            self.points("Push Pull", &names);
        }
    }

    /// Writes the points of the anti-roll bar if its axis is transverse to the car (parallel to y). Otherwise the bar is left out,
    /// because the file has only one point of this axis.
    fn bar(&mut self) {
        let [Some(inner), Some(outer)] =
            ["anti_roll_bar_inner", "anti_roll_bar_outer"].map(|name| self.point(name))
        else {
            return;
        };
        let along = |side| self.outgoing.place(side, outer) - self.outgoing.place(side, inner);
        let lies_across = Side::ALL
            .map(along)
            .iter()
            .all(|d| d.x == 0.0 && d.z == 0.0);
        if !lies_across {
            self.notes.push(
                "omitted: the anti-roll bar, because its axis is not transverse to the car (the \
                 file can contain only one point of the axis)"
                    .to_owned(),
            );
            return;
        }
        self.points("U-Bar", &BAR.map(|(own, name)| (own.to_owned(), name)));
        self.written.push("anti_roll_bar_inner".to_owned());
        self.notes.push(
            "anti_roll_bar_inner is not in the file, which has one point of the bar's axis on \
             each side"
                .to_owned(),
        );
    }

    fn wheels(&mut self) -> Result<(), String> {
        let suspension = self.outgoing.study.wheel();
        let radius = suspension.wheel_radius.ok_or(
            "[wheel] radius is missing: OptimumKinematics describes the wheel by half track and \
             tyre diameter",
        )?;
        let radius = self.outgoing.length(radius);
        let width = suspension
            .tyre_width
            .map(|width| self.outgoing.length(width));
        let of_sides = Side::ALL.map(|side| {
            let axis = self.outgoing.spin_axis(side);
            let centre = self.outgoing.place(side, suspension.mechanism.wheel_centre);
            let contact = centre - upward(axis) * radius;
            let [camber, toe] = self.outgoing.static_angles(side);
            [
                Some(contact.y),
                Some(contact.x),
                Some(0.0),
                Some(contact.z),
                Some(camber),
                // Toe-out is positive in OptimumKinematics.
                Some(0.0 - toe),
                Some(2.0 * radius),
                width,
            ]
        });
        self.rows.push(Vec::new());
        self.row(["Wheels", "Point Name", "Left", "", "", "", "Right"]);
        let names = [
            "Half Track",
            "Longitudinal Offset",
            "Lateral Offset",
            "Vertical Offset",
            "Static Camber",
            "Static Toe",
            "Tire Diameter",
            "Tire Width",
        ];
        for (number, name) in names.iter().enumerate() {
            let [Some(left), Some(right)] = of_sides.map(|values| values[number]) else {
                self.notes.push(format!("{name} is not in the study"));
                continue;
            };
            let mut row = vec![Value::Empty, text(name), Value::Number(left)];
            row.extend([Value::Empty, Value::Empty, Value::Empty]);
            row.push(Value::Number(right));
            self.rows.push(row);
        }
        self.written
            .extend(["wheel_centre", "spindle_inner"].map(str::to_owned));
        self.notes.push(
            "the file describes the wheel by half track, offsets, diameter and static angles; Rim \
             Diameter must be filled in"
                .to_owned(),
        );
        Ok(())
    }

    /// Writes the rows that name the bodies to which the rod and the drop link are attached.
    fn attachments(&mut self) {
        let mechanism = &self.outgoing.study.wheel().mechanism;
        let is_written = |name: &str| self.written.iter().any(|known| known == name);
        let carrier = |id: PointId| match mechanism.body(id) {
            Body::Arm(arm) if arm.0 == 0 => ["Double A-Arm", "LowerAArm"],
            Body::Arm(_) => ["Double A-Arm", "UpperAArm"],
            Body::Rocker(_) => ["Push Pull", "Rocker"],
            _ => ["Double A-Arm", "Upright"],
        };
        let rods = mechanism.rockers.iter().filter_map(|rocker| {
            let outer = mechanism.name(rocker.outer);
            let names = match outer {
                "drop_link_outer" => ["U-Bar", "NSMA_UBarAttPnt_L"],
                _ => ["Push Pull", "NSMA_PPAttPnt_L"],
            };
            is_written(outer).then(|| (names, carrier(rocker.outer)))
        });
        let rods: Vec<_> = rods.collect();
        if rods.is_empty() {
            return;
        }
        self.rows.push(Vec::new());
        self.row(["Attachment", "Element", "", "Attached To"]);
        for ([element, point], [group, part]) in rods {
            self.row(["", element, point, group, part]);
        }
    }

    fn say_what_is_left_out(&mut self) {
        let points = self.outgoing.study.wheel().mechanism.points.iter();
        let names = points.map(|point| point.name.clone());
        let absent: Vec<String> = names.filter(|name| !self.written.contains(name)).collect();
        if !absent.is_empty() {
            self.notes.push(format!(
                "omitted, because the file cannot contain it: {}",
                absent.join(", ")
            ));
        }
        if self.outgoing.study.axle().is_none() {
            let (_, side) = self.outgoing.study.wheel().frame.meaning();
            let note = format!(
                "the study is of the {} wheel; the other is its mirror image",
                side.name()
            );
            self.notes.push(note);
        }
        self.notes
            .push("springs, vehicle, motion and targets are not in the file".to_owned());
    }
}

/// Unit vector from the contact point to the wheel centre: upward in the plane of the wheel. It is the fraction in equation (1) of
/// this module. `axis` is the spin axis.
fn upward(axis: Vector3<f64>) -> Vector3<f64> {
    let up = Vector3::new(0.0, 0.0, 1.0) - axis * axis.z;
    up * (1.0 / up.norm_squared().sqrt())
}
