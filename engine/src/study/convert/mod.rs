//! Writes a study in other units and axes, or for the other side of the car, as an edit of its text.
//!
//! The crate `hardpoint-study-file` gives the dimension of each number ([`dimension`](hardpoint_study_file::dimension)).
//! Module [`scale`] converts the numbers. In entries such as targets, other keys determine the unit ([`entry`]).

mod entry;
mod scale;
mod walk;

use super::error::{Problems, Source, StudyErrors};
use super::place::place_of;
use super::{CarStudy, Study};
use crate::model::{FrameConvention, LengthUnit, MassUnit, Side};
use crate::number::Each;
use entry::Subject;
use hardpoint_study_file::schema::Root;
use scale::Conversion;
use std::path::Path;
use std::sync::Arc;
use toml_edit::{DocumentMut, Item, TableLike, Value};
use walk::Walk;

/// Units and axes of a study, and the side of its wheel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Units {
    /// Unit of lengths, with the unit of forces.
    pub length: LengthUnit,
    /// Unit of masses.
    pub mass: MassUnit,
    /// Directions of the axes.
    pub frame: FrameConvention,
    /// Side of the car on which the wheel of the study is. The study of an axle describes its left wheel.
    pub side: Side,
}

/// Requested units, axes and side. `None` keeps the unit, the axes or the side of the study.
#[derive(Clone, Copy, Debug, Default)]
pub struct UnitChoice {
    /// Unit of lengths: millimetres, metres or inches.
    pub length: Option<LengthUnit>,
    /// True for forces in pounds-force, false for newtons. Pounds-force need inches.
    pub pounds_force: Option<bool>,
    /// Unit of masses.
    pub mass: Option<MassUnit>,
    /// Directions of the axes.
    pub frame: Option<FrameConvention>,
    /// Side of the car. On the other side, the study describes the mirror image of its wheel. Only for the study of one wheel.
    pub side: Option<Side>,
}

impl UnitChoice {
    /// Units after the conversion. Forces of a study in pounds-force become newtons if its lengths are no longer in inches.
    fn applied(&self, from: Units) -> Result<Units, String> {
        let length = self.length.unwrap_or(from.length);
        let inches = length.symbol() == LengthUnit::Inch.symbol();
        let pounds = self
            .pounds_force
            .unwrap_or(inches && from.length == LengthUnit::InchPound);
        let length = match (inches, pounds) {
            (true, true) => LengthUnit::InchPound,
            (true, false) => LengthUnit::Inch,
            (false, false) => length,
            (false, true) => {
                return Err(format!(
                    "forces in lbf need lengths in inches, but the lengths would be in {}: choose inches as the unit of lengths, too",
                    length.symbol()
                ));
            }
        };
        Ok(Units {
            length,
            mass: self.mass.unwrap_or(from.mass),
            frame: self.frame.unwrap_or(from.frame),
            side: self.side.unwrap_or(from.side),
        })
    }
}

impl Study {
    /// Units and axes of the study, and the side of its wheel.
    pub fn units(&self) -> Units {
        let written = self.text.parse::<DocumentMut>().ok();
        let section = written.as_ref().and_then(|own| own.get("suspension"));
        let (frame, side) = self.wheel().frame.meaning();
        Units {
            length: self.wheel().length_unit,
            mass: mass_unit(section),
            frame,
            side,
        }
    }

    /// Returns the text of the same study in other units and axes, with its comments. For the other side of the car, the new
    /// study is the mirror image of the old one: its results are the same, apart from the signs of lateral components. The
    /// function does not read files of target curves. `name` is the file name in messages. Errors name the keys that cannot be
    /// converted.
    pub fn in_units(&self, name: &str, choice: &UnitChoice) -> Result<String, StudyErrors> {
        let from = self.units();
        let source = source(name, &self.text);
        let to = applied(choice, from, &source, "suspension")?;
        if to.length == LengthUnit::InchPound && self.is_elastic() {
            let message = "a study with elastic parts cannot have forces in lbf";
            return Err(refusal(&source, &["suspension", "force_unit"], message));
        }
        if choice.side.is_some() && self.axle().is_some() {
            let message = "this study describes both wheels of an axle: only the study of one wheel has a mirror image on the other side";
            return Err(refusal(&source, &["suspension", "topology"], message));
        }
        // Reads the text again, so that the entries of the study have the same order as the entries of the text. The
        // text contains the target curves of other files.
        let study = self.read_again(name, &self.text)?;
        let conversion = Conversion::new(from, to);
        let walk = Walk::new(Root::Suspension, Subject::Study(&study), [conversion; 2]);
        let text = walk.text(&source, |root| {
            let section = root.get_mut("suspension").and_then(Item::as_table_like_mut);
            if let Some(section) = section {
                let force = [from, to].each(|units| units.length.force_symbol());
                write_unit(
                    section,
                    "length_unit",
                    [from, to].each(|own| own.length.symbol()),
                );
                write_unit(section, "force_unit", force);
                write_unit(
                    section,
                    "mass_unit",
                    [from, to].each(|own| own.mass.symbol()),
                );
                write_unit(section, "frame", [from, to].each(|own| own.frame.name()));
                write_unit(section, "side", [from, to].each(|own| own.side.name()));
                correct_comment(
                    section,
                    "frame",
                    [from, to].each(|own| own.frame.directions()),
                );
                // The comment names the alternative to the value.
                correct_comment(section, "side", [to, from].each(|own| own.side.name()));
            }
        })?;
        self.read_again(name, &text)?;
        Ok(text)
    }
}

impl CarStudy {
    /// Units and axes of the car and of its axles, [car, front, rear]. The car has the axes of its front study.
    pub fn units(&self) -> [Units; 3] {
        let written = self.text.parse::<DocumentMut>().ok();
        let section = written.as_ref().and_then(|own| own.get("car"));
        let [front, rear] = self.axles.each_ref().each(Study::units);
        let car = Units {
            mass: mass_unit(section),
            ..front
        };
        [car, front, rear]
    }

    /// Returns the texts of the same car in other units and axes: the car, its front axle and its rear axle. `names` are
    /// their file names in messages.
    pub fn in_units(
        &self,
        names: [&str; 3],
        choice: &UnitChoice,
    ) -> Result<[String; 3], StudyErrors> {
        let [name, of_front, of_rear] = names;
        let [front, rear] = [
            self.axles[0].in_units(of_front, choice)?,
            self.axles[1].in_units(of_rear, choice)?,
        ];
        let source = source(name, &self.text);
        let [from, front_units, rear_units] = self.units();
        let to = applied(choice, from, &source, "car")?;
        let ends = [front_units, rear_units].map(|own| {
            let to = applied(choice, own, &source, "car");
            to.map(|to| Conversion::new(own, to))
        });
        let [first, second] = ends;
        let walk = Walk::new(Root::Car, Subject::Car(self), [first?, second?]);
        // The car has a separate unit of mass.
        let walk = walk.with_masses(from.mass, to.mass);
        let text = walk.text(&source, |root| {
            let section = root.get_mut("car").and_then(Item::as_table_like_mut);
            if let Some(section) = section {
                write_unit(
                    section,
                    "mass_unit",
                    [from, to].each(|own| own.mass.symbol()),
                );
            }
        })?;
        let axles = [(of_front, &front), (of_rear, &rear)];
        let axles = axles.map(|(name, text)| Study::from_text(name, text, Path::new("")));
        let [first, second] = axles;
        CarStudy::of_axles(&self.name, &text, [first?, second?])?;
        Ok([text, front, rear])
    }
}

fn source(name: &str, text: &str) -> Arc<Source> {
    Arc::new(Source {
        name: name.to_owned(),
        text: text.to_owned(),
    })
}

fn applied(
    choice: &UnitChoice,
    from: Units,
    source: &Arc<Source>,
    section: &str,
) -> Result<Units, StudyErrors> {
    let to = choice.applied(from);
    to.map_err(|message| refusal(source, &[section, "length_unit"], &message))
}

/// Error at a path of keys and indices.
fn refusal(source: &Arc<Source>, path: &[&str], message: &str) -> StudyErrors {
    let mut problems = Problems::new(source.clone());
    problems.add(place_of(&source.text, path), message);
    problems.finish::<()>(None).expect_err("it has a problem")
}

/// Unit of masses that a section names.
fn mass_unit(section: Option<&Item>) -> MassUnit {
    let name = section.and_then(|own| own.get("mass_unit")?.as_str());
    let named = MassUnit::ALL.into_iter();
    let mut named = named.filter(|unit| Some(unit.symbol()) == name);
    named.next().unwrap_or_default()
}

/// Writes the name of a unit, of axes or of a side, if it changes. `both` has the old and the new name.
fn write_unit(section: &mut dyn TableLike, key: &str, both: [&str; 2]) {
    if both[0] == both[1] {
        return;
    }
    let mut new = Value::from(both[1]);
    match section.get_mut(key).and_then(Item::as_value_mut) {
        Some(old) => {
            *new.decor_mut() = old.decor().clone();
            *old = new;
        }
        None => _ = section.insert(key, Item::Value(new)),
    }
}

/// Replaces words in the comment behind a key. `both` has the old and the new words.
fn correct_comment(section: &mut dyn TableLike, key: &str, both: [&str; 2]) {
    let value = section.get_mut(key).and_then(Item::as_value_mut);
    if let Some(decor) = value.map(Value::decor_mut)
        && let Some(comment) = decor.suffix().and_then(|suffix| suffix.as_str())
    {
        let new = comment.replace(both[0], both[1]);
        decor.set_suffix(new);
    }
}
