//! Writes a study in other units and axes, as an edit of its text.
//!
//! The crate `hardpoint-study-file` gives the dimension of each number ([`dimension`](hardpoint_study_file::dimension)).
//! Module [`scale`] converts the numbers. In entries such as targets, other keys determine the unit ([`entry`]).

mod entry;
mod scale;
mod walk;

use super::error::{Problems, Source, StudyErrors};
use super::place::place_of;
use super::{CarStudy, Study};
use crate::model::{FrameConvention, LengthUnit, MassUnit};
use crate::number::Each;
use entry::Subject;
use hardpoint_study_file::schema::Root;
use scale::Conversion;
use std::path::Path;
use std::sync::Arc;
use toml_edit::{DocumentMut, Item, TableLike, Value};
use walk::Walk;

/// Units and axes of a study.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Units {
    /// Unit of lengths, with the unit of forces.
    pub length: LengthUnit,
    /// Unit of masses.
    pub mass: MassUnit,
    /// Directions of the axes.
    pub frame: FrameConvention,
}

/// Requested units and axes. `None` keeps the unit or the axes of the study.
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
        })
    }
}

impl Study {
    /// Units and axes of the study.
    pub fn units(&self) -> Units {
        let written = self.text.parse::<DocumentMut>().ok();
        let section = written.as_ref().and_then(|own| own.get("suspension"));
        Units {
            length: self.wheel().length_unit,
            mass: mass_unit(section),
            frame: self.wheel().frame.meaning().0,
        }
    }

    /// Returns the text of the same study in other units and axes, with its comments. The function does not read files of
    /// target curves. `name` is the file name in messages. Errors name the keys that cannot be converted.
    pub fn in_units(&self, name: &str, choice: &UnitChoice) -> Result<String, StudyErrors> {
        let from = self.units();
        let source = source(name, &self.text);
        let to = applied(choice, from, &source, "suspension")?;
        if to.length == LengthUnit::InchPound && self.is_elastic() {
            let message = "a study with elastic parts cannot have forces in lbf";
            return Err(refusal(&source, &["suspension", "force_unit"], message));
        }
        // Reads the text again, so that the entries of the study have the same order as the entries of the text. The
        // text contains the target curves of other files.
        let study = self.read_again(name, &self.text)?;
        let conversion = Conversion::new(from, to, self.wheel().frame.meaning().1);
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
                describe_axes(section, from.frame, to.frame);
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
            to.map(|to| Conversion::new(own, to, crate::model::Side::Left))
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

/// Writes the name of a unit or of axes, if it changes. `both` has the old and the new name.
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

/// Corrects the comment behind `frame` that states the directions of the axes.
fn describe_axes(section: &mut dyn TableLike, from: FrameConvention, to: FrameConvention) {
    let frame = section.get_mut("frame").and_then(Item::as_value_mut);
    if let Some(decor) = frame.map(Value::decor_mut)
        && let Some(comment) = decor.suffix().and_then(|suffix| suffix.as_str())
    {
        let new = comment.replace(from.directions(), to.directions());
        decor.set_suffix(new);
    }
}
