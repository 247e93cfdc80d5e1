//! Units and directions of numbers in entries such as targets and variables. These units and directions depend on other keys of
//! the same entry.

use super::super::{CarStudy, Constraint, Study, Target, TargetKind};
use super::scale::{Conversion, Measured};
use crate::ask::Unit;
use crate::axle::Coordinate;
use crate::car::CarQuantity;
use crate::characteristics::{Characteristic, Measure, Quantity};
use crate::compliance::{follows_y_axis, is_steer_to_left};
use crate::model::Axis;
use crate::number::Each;
use hardpoint_study_file::dimension::Powers;
use toml_edit::{Item, TableLike, Value};

/// Study whose text is converted.
#[derive(Clone, Copy)]
pub(super) enum Subject<'a> {
    /// A study of one wheel or an axle.
    Study(&'a Study),
    /// A study of a car.
    Car(&'a CarStudy),
}

impl Subject<'_> {
    /// Trails of the tests of elastic parts. A trail is the distance from the contact point back to the side force.
    pub(super) fn trails(&self) -> Vec<f64> {
        let Subject::Study(study) = self else {
            return Vec::new();
        };
        let elastic = study.one_wheel().and_then(|own| own.compliance.as_ref());
        let of_wheel = elastic.iter().flat_map(|own| &own.tests);
        let of_wheel = of_wheel.map(|test| test.trail);
        let figures = study.axle().map(|both| both.axle.figures());
        let of_axle = figures.iter().flat_map(|own| own.iter());
        of_wheel
            .chain(of_axle.map(|figure| figure.test.trail))
            .collect()
    }
}

/// Reason why a key of an entry cannot be converted.
#[derive(Debug)]
pub(super) struct Refused {
    pub(super) key: &'static str,
    pub(super) reason: String,
}

fn refused<T>(key: &'static str, reason: impl Into<String>) -> Result<T, Refused> {
    let reason = reason.into();
    Err(Refused { key, reason })
}

/// Units and directions of the numbers in an entry, such as a target.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub(super) conversion: Conversion,
    pub(super) value: Measured,
    pub(super) drive: Measured,
}

/// Text at a key. `None` if the key has no text.
fn text<'t>(table: &'t dyn TableLike, key: &str) -> Option<&'t str> {
    table.get(key)?.as_str()
}

fn axis(table: &dyn TableLike) -> Option<Axis> {
    let name = text(table, "axis")?;
    Axis::ALL.into_iter().find(|axis| axis.name() == name)
}

/// Unit and direction of a drive, or of a coordinate of a motion.
fn drive(name: &str, conversion: &Conversion) -> Measured {
    let along = Measured::plain(Powers::LENGTH);
    match name {
        "rack" => along.signed(conversion.sign(Axis::Y)),
        "travel" | "heave" | "travel_left" | "travel_right" => along,
        _ => Measured::plain(Powers::NONE),
    }
}

/// Unit of the rate with this name, as powers of the units of length, force and mass. `None` for an unknown name.
fn rate(name: &str) -> Option<Powers> {
    match name {
        "spring" | "heave_spring" | "tyre" | "rack" => Some(Powers::RATE),
        "anti_roll_bar" | "t_bar" | "heave_bar" | "column" => Some(Powers::TORQUE),
        _ => None,
    }
}

/// Sign of a result in the new text, relative to the old text. Characteristics depend neither on the axes nor on the side of the
/// wheel, but some test results do.
fn sign_of_name(name: &str, conversion: &Conversion) -> f64 {
    let along = if follows_y_axis(name) {
        conversion.sign(Axis::Y)
    } else {
        1.0
    };
    // A mirror image turns a steer to the left into a steer to the right.
    let turns_back = is_steer_to_left(name) && conversion.mirrors();
    along * if turns_back { -1.0 } else { 1.0 }
}

/// Number of entries before an entry of a list, such as a target. `all` counts every entry. `of_axle` counts only the entries
/// for the front axle, and only those for the rear axle, of a car.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Before {
    pub(super) all: usize,
    pub(super) of_axle: [usize; 2],
}

/// Properties of the study that entries refer to.
pub(super) struct Facts<'a> {
    pub(super) subject: Subject<'a>,
    /// Conversions of the front and the rear study of a car. For a single study, both are equal.
    pub(super) ends: [Conversion; 2],
    /// Text of the study before the conversion.
    pub(super) before: &'a Item,
}

impl Facts<'_> {
    /// Axles of a car that an entry names.
    pub(super) fn axles(table: &dyn TableLike) -> Vec<usize> {
        let index = |name: &str| ["front", "rear"].iter().position(|end| *end == name);
        match table.get("axle").and_then(Item::as_value) {
            Some(Value::String(name)) => index(name.value()).into_iter().collect(),
            Some(Value::Array(list)) => {
                let names = list.iter().filter_map(Value::as_str);
                names.filter_map(index).collect()
            }
            _ => Vec::new(),
        }
    }

    /// Conversion of the axes that an entry uses. An entry for an axle uses the axes of this axle. Other entries use the
    /// axes of the study or the car.
    pub(super) fn conversion(&self, table: &dyn TableLike) -> Result<Conversion, Refused> {
        let axles = Facts::axles(table);
        let own = axles.first().map_or(self.ends[0], |end| self.ends[*end]);
        let differs = |end: &usize| self.ends[*end].frames() != own.frames();
        if axles.iter().any(differs) {
            let reason = "the studies of the two axles have different axes: write one entry of the car's study for each axle";
            return refused("axle", reason);
        }
        Ok(own)
    }

    fn study(&self, table: &dyn TableLike) -> Option<&Study> {
        match self.subject {
            Subject::Study(study) => Some(study),
            Subject::Car(car) => Facts::axles(table).first().map(|end| &car.axles[*end]),
        }
    }

    /// Unit of the result that an entry names.
    fn named(&self, table: &dyn TableLike, key: &'static str) -> Result<Measured, Refused> {
        let name = text(table, key).unwrap_or_default();
        let unit = match (self.subject, table.contains_key("case")) {
            (Subject::Car(_), true) => {
                let found = CarQuantity::named(name);
                found.first().map(|quantity| quantity.info().unit)
            }
            _ => self.study(table).and_then(|study| unit_named(study, name)),
        };
        let sign = sign_of_name(name, &self.conversion(table)?);
        match unit {
            Some(unit) => Ok(Measured::printed(unit).signed(sign)),
            None => refused(key, format!("the unit of {name:?} is not known")),
        }
    }

    /// Units and directions for an entry at this position of the text. `None` if the numbers of the entry do not depend on
    /// other keys.
    pub(super) fn entry(
        &self,
        place: &str,
        table: &dyn TableLike,
        before: Before,
    ) -> Result<Option<Entry>, Refused> {
        let conversion = self.conversion(table)?;
        let fixed = Measured::plain(Powers::NONE);
        let of = |value: Measured, drive: Measured| {
            Ok(Some(Entry {
                conversion,
                value,
                drive,
            }))
        };
        match place {
            "motion" | "motions{}" => {
                let default = match self.subject {
                    Subject::Study(study) if study.axle().is_some() => "heave",
                    _ => "travel",
                };
                let name = text(table, "drive").unwrap_or(default);
                of(fixed, drive(name, &conversion))
            }
            "compliance.tests[]" => {
                let is_torque = text(table, "load") == Some("aligning");
                let powers = if is_torque {
                    Powers::TORQUE
                } else {
                    Powers::FORCE
                };
                of(Measured::plain(powers), fixed)
            }
            "optimise.variables[]" | "sweep.variables[]" => {
                of(self.part(table, &conversion)?, fixed)
            }
            "tolerance.scatter[]" => of(self.scatter(table, &conversion)?, fixed),
            "tolerance.bands[]" => of(
                self.named(table, "characteristic")?,
                self.drive_of_band(table, before, &conversion),
            ),
            "optimise.targets[]" => {
                if text(table, "case").is_some() {
                    return of(self.named(table, "characteristic")?, fixed);
                }
                let Some(target) = self.target(table, before) else {
                    return refused("tolerance", "the quantity of this target is not known");
                };
                let (value, drive) = self.of_target(target, &conversion);
                let names = ["figure", "characteristic"].into_iter();
                let name = names.filter_map(|key| text(table, key)).next();
                let sign = name.map_or(1.0, |name| sign_of_name(name, &conversion));
                of(value.signed(value.sign * sign), drive)
            }
            "optimise.constraints[]" => of(self.constraint(table, before, &conversion)?, fixed),
            _ => Ok(None),
        }
    }

    /// Unit and direction of a design variable, or of the deviation of a part.
    fn part(&self, table: &dyn TableLike, conversion: &Conversion) -> Result<Measured, Refused> {
        if table.get("relative").and_then(Item::as_bool) == Some(true) {
            return Ok(Measured::plain(Powers::NONE));
        }
        if let Some(name) = text(table, "rate") {
            return match rate(name) {
                Some(powers) => Ok(Measured::plain(powers)),
                None => refused("rate", format!("the unit of {name:?} is not known")),
            };
        }
        if table.contains_key("bushing") {
            let is_torque = text(table, "stiffness").is_some_and(|axis| axis.starts_with('t'));
            let powers = if is_torque {
                Powers::TORQUE
            } else {
                Powers::RATE
            };
            return Ok(Measured::plain(powers));
        }
        if let Some(name) = text(table, "link") {
            let link = self.before.get("links").and_then(|links| links.get(name));
            // The variable of a link with a modulus is the modulus times the area.
            let by_area = link.is_some_and(|link| link.get("modulus").is_some());
            let powers = if by_area { Powers::FORCE } else { Powers::RATE };
            return Ok(Measured::plain(powers));
        }
        let length = Measured::plain(Powers::LENGTH);
        match text(table, "car") {
            None => {}
            Some("mass") => return Ok(Measured::plain(Powers::MASS)),
            Some("wheelbase") => return Ok(length),
            Some("brake_share_front" | "drive_share_front") => {
                return Ok(Measured::plain(Powers::NONE));
            }
            Some(name) => {
                let mut axes = Axis::ALL.into_iter();
                let along = axes.find(|axis| name == format!("cg_{}", axis.name()));
                return match along {
                    Some(axis) => Ok(length.signed(conversion.sign(axis))),
                    None => refused("car", format!("the unit of {name:?} is not known")),
                };
            }
        }
        let sign = axis(table).map_or(1.0, |axis| conversion.sign(axis));
        Ok(length.signed(sign))
    }

    /// Unit and direction of a scatter entry. An entry for all three coordinates has one distribution. If only some axes
    /// change their direction, the limits of this distribution must be symmetric about 0.
    fn scatter(&self, table: &dyn TableLike, conversion: &Conversion) -> Result<Measured, Refused> {
        let own = self.part(table, conversion)?;
        let of_point = table.contains_key("hardpoint") || table.contains_key("hardpoints");
        let limits = table.get("limits").and_then(Item::as_array);
        let ends: Vec<f64> = limits
            .into_iter()
            .flatten()
            .filter_map(super::walk::number)
            .collect();
        let is_lopsided = matches!(ends[..], [low, high] if low != -high);
        let turns = Axis::ALL
            .into_iter()
            .any(|axis| conversion.sign(axis) < 0.0);
        if of_point && axis(table).is_none() && is_lopsided && turns {
            let reason = "these limits are not symmetric about 0, and the conversion reverses \
                          only some axes: write one entry with axis for each coordinate";
            return refused("limits", reason);
        }
        Ok(own)
    }

    /// Units and directions of a target's quantity and of the drive values in its motion.
    fn of_target(&self, target: &Target, conversion: &Conversion) -> (Measured, Measured) {
        let [from, to] = conversion.frames();
        let sign = match &target.of.kind {
            TargetKind::Wheel(Measure::Quantity(Quantity::Coordinate(_, axis))) => {
                conversion.sign(*axis)
            }
            TargetKind::Wheel(Measure::Carried(force)) => {
                force.what.sign(&from) * force.what.sign(&to)
            }
            _ => 1.0,
        };
        let at = match (&target.site.axle, &target.site.motion) {
            (Some(site), _) => drive(site.over.key(), conversion),
            (None, Some((_, motion))) => drive(motion.drive.key(), conversion),
            (None, None) => self.own_drive(conversion),
        };
        (Measured::printed(target.of.unit).signed(sign), at)
    }

    /// Unit and direction of the drive values in the study's own motion.
    fn own_drive(&self, conversion: &Conversion) -> Measured {
        match self.subject {
            Subject::Study(study) => drive(study.motion().drive.key(), conversion),
            Subject::Car(_) => Measured::plain(Powers::NONE),
        }
    }

    /// Target of an entry.
    fn target(&self, table: &dyn TableLike, before: Before) -> Option<&Target> {
        match self.subject {
            Subject::Study(study) => study.optimise.as_ref()?.targets.get(before.all),
            Subject::Car(car) => {
                let end = *Facts::axles(table).first()?;
                let goals = car.optimise.as_ref()?.rigs[end].as_ref()?;
                goals.optimise.targets.get(before.of_axle[end])
            }
        }
    }

    /// Unit and direction of a band's drive value in the motion.
    fn drive_of_band(
        &self,
        table: &dyn TableLike,
        before: Before,
        conversion: &Conversion,
    ) -> Measured {
        let Subject::Study(study) = self.subject else {
            return Measured::plain(Powers::NONE);
        };
        let bands = study.tolerance.as_ref().map(|own| &own.bands);
        let site = bands.and_then(|bands| bands.get(before.all)?.site.as_ref());
        let over = site.map_or(Coordinate::Heave, |site| site.over);
        match (study.axle(), text(table, "over")) {
            (Some(_), named) => drive(named.unwrap_or(over.key()), conversion),
            (None, _) => self.own_drive(conversion),
        }
    }

    /// Unit and direction of the limits of a constraint.
    fn constraint(
        &self,
        table: &dyn TableLike,
        before: Before,
        conversion: &Conversion,
    ) -> Result<Measured, Refused> {
        if table.contains_key("characteristic") {
            return self.named(table, "characteristic");
        }
        if table.contains_key("articulation") {
            return Ok(Measured::plain(Powers::NONE));
        }
        if !table.contains_key("load") {
            return Ok(Measured::plain(Powers::LENGTH));
        }
        let Subject::Study(study) = self.subject else {
            return refused("load", "the direction of this force is not known");
        };
        let constraints = study.optimise.iter().flat_map(|own| &own.constraints);
        let own: Option<&Constraint> = constraints.into_iter().nth(before.all);
        let force = own.and_then(|own| match &own.parts.first()?.of {
            Measure::Carried(force) => Some(force),
            _ => None,
        });
        match force {
            Some(force) => {
                let [from, to] = conversion.frames().each(|frame| force.what.sign(&frame));
                Ok(Measured::plain(Powers::FORCE).signed(from * to))
            }
            None => refused("load", "the direction of this force is not known"),
        }
    }
}

/// Unit of the quantity with this name, without a side. It is a quantity of the axle, a test result of elastic parts, or a
/// quantity of a wheel.
pub(super) fn unit_named(study: &Study, name: &str) -> Option<Unit> {
    let of_wheel = || Characteristic::named(name).map(|own| own.info().unit);
    match study.axle() {
        Some(both) => {
            let found = both.axle.quantities(name);
            found.first().map(|own| own.info().unit).or_else(of_wheel)
        }
        None => {
            let figures = study.one_wheel().map(|own| own.figures());
            let mut figures = figures.into_iter().flatten();
            let figure = figures.find(|figure| figure.name == name);
            figure.map(|figure| figure.unit).or_else(of_wheel)
        }
    }
}
