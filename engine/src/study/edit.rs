//! Writes studies back as edits of their text, so that comments and line breaks do not change.

mod inside;

use super::{AxleComplianceStudy, Designs, NamedLink, Study};
use crate::compliance::{AxialStiffness, Compliance, LinkPart, Shape};
use crate::model::{Axis, Frame, HINGE, Mechanism, PointId, SPINDLE_INNER, Suspension};
use crate::number::{Each, Vector3};
pub(super) use inside::{with_bushings_inside, with_curves_inside};
use std::path::{Component, Path, PathBuf};
use toml_edit::{Array, DocumentMut, Item, Table, TableLike, Value};

impl Study {
    /// Returns the study that the text describes. `self` differs from the returned study if the vehicle was changed in
    /// memory. A study without text describes itself.
    ///
    /// # Panics
    /// If the text cannot be read. The study was read from this text, so this is a defect of the program.
    pub(crate) fn as_written(&self) -> Study {
        if self.text.is_empty() {
            return self.clone();
        }
        let read = self.read_again(&self.name, &self.text);
        read.unwrap_or_else(|errors| {
            panic!(
                "the text of the study {} cannot be read again: {errors}",
                self.name
            )
        })
    }

    /// Returns a built suspension ([`crate::assembly`]) as the text of a study. If angles define the spin axis of the study,
    /// a point `spindle_inner` replaces them, because points define the axis of a build. For a twist beam, the text also
    /// gets the second point of the hinge.
    pub fn with_built(&self, built: &Suspension) -> String {
        let text = self.as_written().rewritten(&self.text, &built.design, None);
        let mechanism = &built.mechanism;
        let given = self.wheel().mechanism.points.len();
        let spindle = mechanism.points.get(given);
        let spindle = spindle.filter(|added| added.name == SPINDLE_INNER);
        let rigid = mechanism.rigid_axle.as_ref();
        let beam = rigid.and_then(|rigid| rigid.twist_beam);
        let hinge = beam.filter(|beam| !beam.is_hinge_given);
        let Ok(mut document) = text.parse::<DocumentMut>() else {
            return text;
        };
        let root = document.as_table_mut();
        let added = [
            spindle.map(|_| (SPINDLE_INNER, built.design[given])),
            hinge.map(|beam| (HINGE, built.design[beam.hinge.0])),
        ];
        for (name, place) in added.into_iter().flatten() {
            if let Some(hardpoints) = table(root, &["suspension", "hardpoints"]) {
                hardpoints.insert(name, written(place, built.frame));
            }
        }
        if let (Some(_), Some(wheel)) = (spindle, table(root, &["wheel"])) {
            wheel.remove("static_camber");
            wheel.remove("static_toe");
        }
        document.to_string()
    }

    /// Returns a built axle as the text of a study. The text contains every hardpoint of the right wheel. For a solid axle,
    /// these are the hardpoints of its right half.
    pub fn with_built_axle(&self, [left, right]: [&Suspension; 2]) -> String {
        let text = self.with_built(left);
        let Ok(mut document) = text.parse::<DocumentMut>() else {
            return text;
        };
        let frame = left.frame.of_other_side();
        let mut hardpoints = Table::new();
        let mechanism = &right.mechanism;
        let is_of_half = |id: PointId| match &mechanism.rigid_axle {
            None => true,
            Some(rigid) => rigid.far_of(id).is_some(),
        };
        for (number, (point, place)) in mechanism.points.iter().zip(&right.design).enumerate() {
            if is_of_half(PointId(number)) {
                hardpoints.insert(&point.name, written(*place, frame));
            }
        }
        let root = document.as_table_mut();
        // A solid axle needs no [axle].
        let axle = root.entry("axle").or_insert_with(|| {
            let mut axle = Table::new();
            axle.set_implicit(true);
            Item::Table(axle)
        });
        if let Some(axle) = axle.as_table_like_mut() {
            let own = axle.get_mut("right").and_then(Item::as_table_like_mut);
            match own {
                Some(right) => {
                    // Points define the spin axis of the build, so the angles are removed.
                    right.remove("wheel");
                    right.insert("hardpoints", Item::Table(hardpoints));
                }
                None => {
                    let mut right = Table::new();
                    right.set_implicit(true);
                    right.insert("hardpoints", Item::Table(hardpoints));
                    axle.insert("right", Item::Table(right));
                }
            }
        }
        document.to_string()
    }

    /// Returns the study with another design. A right wheel with independent hardpoints moves by the same displacements as
    /// the left wheel.
    pub fn at_design(&self, design: Vec<Vector3<f64>>) -> Study {
        let mut moved = self.clone();
        moved.vehicle.set_design(design);
        moved
    }

    /// Returns the text with the points of the study `moved`, including the points of the right wheel. Rewrites only
    /// coordinates that differ from the text. Reading the text again gives exactly the numbers of `moved`.
    pub fn with_points_of(&self, moved: &Study) -> String {
        self.text_with_points_of(&self.text, moved)
    }

    /// Returns another text of this study with the points of `moved`, like [`Study::with_points_of`]. An example of another
    /// text is the study file itself: [`Study::text`] also contains curves from other files.
    pub fn text_with_points_of(&self, text: &str, moved: &Study) -> String {
        let right = moved.axle().and_then(|a| a.axle.right.as_ref());
        let text = self.rewritten(text, &moved.wheel().design, right.map(|r| &r.design[..]));
        self.with_rates_of(text, moved)
    }

    /// Writes the rates of elastic parts of the study `moved` into the text, where they differ from the rates of this study.
    pub fn with_rates_of(&self, text: String, moved: &Study) -> String {
        let Some((old, new)) = self.elastic_parts().zip(moved.elastic_parts()) else {
            return text;
        };
        let Ok(mut document) = text.parse::<DocumentMut>() else {
            return text;
        };
        let root = document.as_table_mut();
        let mechanism = &self.wheel().mechanism;
        for (old, new) in old.bushings.iter().zip(&new.bushings) {
            if let Some(bushing) = table(root, &["bushings", old.name]) {
                rewrite_rates(bushing, old.shapes, new.shapes);
            }
        }
        for (old, new) in old.links.iter().zip(&new.links) {
            if let Some(link) = table(root, &["links", old.name]) {
                rewrite_link(link, old, new);
            }
        }
        for (old, new) in old.rates.iter().zip(&new.rates) {
            let [section, key] = new.key;
            if old.value != new.value
                && let Some(section) = table(root, &[section])
            {
                set(section, key, new.value);
            }
        }
        let of_axle = moved.axle().and_then(|both| both.axle.elastic.as_ref());
        let differ = of_axle.is_some_and(|elastic| write_right_rates(root, elastic, mechanism));
        let left_out = if differ {
            leave_out_rates(root)
        } else {
            Vec::new()
        };
        if left_out.is_empty() {
            document.to_string()
        } else {
            format!(
                "# Without {}: rates in these sections apply to both wheels, but the wheels have different \
                 rates here.\n{document}",
                left_out.join(", ")
            )
        }
    }

    fn rewritten(
        &self,
        text: &str,
        left: &[Vector3<f64>],
        right: Option<&[Vector3<f64>]>,
    ) -> String {
        let Ok(mut document) = text.parse::<DocumentMut>() else {
            return text.to_owned();
        };
        rewrite(&mut document, self.wheel(), left, coordinates);
        let own = self.axle().and_then(|a| a.axle.right.as_ref());
        if let (Some(own), Some(right)) = (own, right) {
            rewrite(&mut document, own, right, right_coordinates);
        }
        document.to_string()
    }

    /// Returns the text for a file in another directory. The path of a file of designs becomes relative to this directory.
    pub fn text_in(&self, directory: &Path) -> String {
        self.with_paths_in(self.text.clone(), directory)
    }

    /// Returns another text of this study for a file in another directory, like [`Study::text_in`].
    pub fn with_paths_in(&self, text: String, directory: &Path) -> String {
        let designs = match self.sweep.as_ref().map(|sweep| &sweep.designs) {
            Some(Designs::File(path)) => path_from(directory, path),
            _ => None,
        };
        match (designs, text.parse::<DocumentMut>()) {
            (Some(path), Ok(mut document)) => {
                document["sweep"]["designs"] = path.into();
                document.to_string()
            }
            _ => text,
        }
    }
}

/// Path of a file relative to a directory. The full path if file and directory have no common parent. `None` if the file does
/// not exist, or has no Unicode name. The directory need not exist yet.
fn path_from(directory: &Path, file: &Path) -> Option<String> {
    let (directory, file) = (resolved(directory)?, file.canonicalize().ok()?);
    let common = |(a, b): &(Component<'_>, Component<'_>)| a == b;
    let shared = directory.components().zip(file.components());
    let shared = shared.take_while(common).count();
    if shared == 0 {
        return Some(file.to_str()?.to_owned());
    }
    let up = directory.components().skip(shared).map(|_| Some(".."));
    let down = file.components().skip(shared);
    let names: Option<Vec<&str>> = up
        .chain(down.map(|name| name.as_os_str().to_str()))
        .collect();
    Some(names?.join("/"))
}

/// Full path of a directory without symbolic links, also if the directory does not exist yet.
fn resolved(directory: &Path) -> Option<PathBuf> {
    if directory.as_os_str().is_empty() {
        return Path::new(".").canonicalize().ok();
    }
    let full = directory.canonicalize().ok();
    full.or_else(|| Some(resolved(directory.parent()?)?.join(directory.file_name()?)))
}

/// Writes the coordinates that differ from the suspension's design. `find` returns the array of a point in the document.
fn rewrite(
    document: &mut DocumentMut,
    suspension: &Suspension,
    design: &[Vector3<f64>],
    find: for<'a> fn(&'a mut dyn TableLike, &str) -> Option<&'a mut Array>,
) {
    let frame = suspension.frame;
    let points = suspension.mechanism.points.iter();
    for ((point, old), new) in points.zip(&suspension.design).zip(design) {
        let Some(coordinates) = find(document.as_table_mut(), &point.name) else {
            continue;
        };
        let (old, new) = (old.to_array(), new.to_array());
        for axis in Axis::ALL {
            let i = axis as usize;
            if old[i].to_bits() != new[i].to_bits()
                && let Some(number) = coordinates.get_mut(i)
            {
                replace(number, frame.sign(axis) * new[i]);
            }
        }
    }
}

/// Reads a number with or without a decimal point.
fn number(item: &Item) -> Option<f64> {
    let whole = item.as_integer().map(|whole| whole as f64);
    item.as_float().or(whole)
}

/// Writes those rates of a bushing that changed: the stiffness divided by its factor, or the factor of a curve.
fn rewrite_rates(bushing: &mut dyn TableLike, old: &[Shape; 6], new: &[Shape; 6]) {
    for (k, (old, new)) in old.iter().zip(new).enumerate() {
        let entry = |bushing: &dyn TableLike, key: &str| {
            let list = bushing.get(key)?.as_array()?;
            let value = list.get(k)?;
            value.as_float().or(value.as_integer().map(|n| n as f64))
        };
        let (key, value) = match (old, new) {
            (Shape::Cubic { rate: old, .. }, Shape::Cubic { rate: new, .. }) if old != new => {
                ("stiffness", new / entry(bushing, "scale").unwrap_or(1.0))
            }
            (Shape::Curve { scale: old, .. }, Shape::Curve { scale: new, .. }) if old != new => {
                ("scale", *new)
            }
            _ => continue,
        };
        if bushing.get(key).is_none() {
            bushing.insert(key, Item::Value(Array::from_iter([1.0; 6]).into()));
        }
        let list = bushing.get_mut(key).and_then(Item::as_array_mut);
        if let Some(place) = list.and_then(|list| list.get_mut(k)) {
            replace(place, value);
        }
    }
}

/// Writes the stiffness and the constant tension of a link, if they changed.
fn rewrite_link(link: &mut dyn TableLike, old: &NamedLink, new: &NamedLink) {
    if old.preload != new.preload {
        set(link, "preload", new.preload);
    }
    let (key, value) = match (old.stiffness, new.stiffness) {
        (AxialStiffness::Rate(old), AxialStiffness::Rate(new)) if old != new => {
            ("axial_stiffness", new)
        }
        (AxialStiffness::PerStrain(old), AxialStiffness::PerStrain(new)) if old != new => {
            ("modulus", new)
        }
        _ => return,
    };
    // A modulus is always written together with an area.
    let area = link
        .get("area")
        .and_then(number)
        .filter(|_| key == "modulus");
    set(link, key, value / area.unwrap_or(1.0));
}

/// Sets a number of a table. Keeps comments in the same line.
fn set(table: &mut dyn TableLike, key: &str, number: f64) {
    match table.get_mut(key).and_then(Item::as_value_mut) {
        Some(value) => replace(value, number),
        None => _ = table.insert(key, Item::Value(number.into())),
    }
}

/// Removes the sections in which rates are variables or scatter. Returns their names.
fn leave_out_rates(root: &mut Table) -> Vec<String> {
    let is_rate = |entry: &dyn TableLike| {
        let names = ["bushing", "link", "rate"];
        names.iter().any(|key| entry.contains_key(key))
    };
    let moves_rates = |section: &Item| {
        let keys = ["variables", "scatter"].into_iter();
        let lists = keys.filter_map(|key| section.get(key));
        lists.flat_map(tables).any(is_rate)
    };
    let has_rates = |name: &str| root.get(name).is_some_and(moves_rates);
    // A robust tuning also scatters the rates of [tolerance].
    let is_robust = root
        .get("optimise")
        .is_some_and(|own| own.get("scatter").is_some());
    let is_left_out = |name: &&str| {
        let is_of_builds = *name == "optimise" && is_robust;
        has_rates(name) || is_of_builds && has_rates("tolerance")
    };
    let sections = ["sweep", "optimise", "tolerance"].into_iter();
    let found: Vec<&str> = sections.filter(is_left_out).collect();
    let names = found.into_iter().filter(|name| root.remove(name).is_some());
    names.map(|name| format!("[{name}]")).collect()
}

/// Tables of a list: the inline tables of an array, or tables with separate sections.
fn tables(list: &Item) -> Vec<&dyn TableLike> {
    match list {
        Item::ArrayOfTables(tables) => tables.iter().map(|own| own as &dyn TableLike).collect(),
        Item::Value(Value::Array(array)) => {
            let inline = array.iter().filter_map(Value::as_inline_table);
            inline.map(|own| own as &dyn TableLike).collect()
        }
        _ => Vec::new(),
    }
}

/// Writes stiffnesses, link preloads and the spring rate of the right wheel into `[axle.right]`: those that differ from the left
/// wheel's values, and those that `[axle.right]` already contains. Returns true if any stiffness or the spring rate differs.
fn write_right_rates(
    root: &mut dyn TableLike,
    elastic: &AxleComplianceStudy,
    mechanism: &Mechanism,
) -> bool {
    let [left, right] = &elastic.parts.wheels;
    let mut differ = false;
    for (left, right) in left.bushings.iter().zip(&right.bushings) {
        let name = mechanism.name(left.point);
        let differs = left.shapes != right.shapes;
        if !differs && table(root, &["axle", "right", "bushings", name]).is_none() {
            continue;
        }
        let written = table(root, &["bushings", name]);
        let mut lists = written.map_or_else(Table::new, |own| {
            let given = ["stiffness", "scale"].into_iter();
            let given = given.filter_map(|key| Some((key, own.get(key)?.clone())));
            Table::from_iter(given)
        });
        rewrite_rates(&mut lists, &left.shapes, &right.shapes);
        own_table(root, "bushings").insert(name, Item::Table(lists));
        differ |= differs;
    }
    let links = elastic
        .link_names
        .iter()
        .zip(left.links.iter().zip(&right.links));
    for (name, (left, right)) in links {
        let differs = left.stiffness != right.stiffness;
        let is_alike = !differs && left.preload == right.preload;
        if is_alike && table(root, &["axle", "right", "links", name]).is_none() {
            continue;
        }
        let Some(written) = table(root, &["links", name]) else {
            continue;
        };
        let keys = written
            .iter()
            .map(|(key, value)| (key.to_owned(), value.clone()));
        let mut link = Table::from_iter(keys);
        let named = |part: &LinkPart| NamedLink {
            name,
            stiffness: part.stiffness,
            preload: part.preload,
        };
        rewrite_link(&mut link, &named(left), &named(right));
        own_table(root, "links").insert(name, Item::Table(link));
        differ |= differs;
    }
    let rates = elastic
        .parts
        .wheels
        .each_ref()
        .each(Compliance::spring_rate);
    if let [Some(of_left), Some(of_right)] = rates {
        let stands_there =
            table(root, &["axle", "right", "spring"]).is_some_and(|own| own.get("rate").is_some());
        if of_left != of_right || stands_there {
            set(own_table(root, "spring"), "rate", of_right);
        }
        differ |= of_left != of_right;
    }
    differ
}

/// Table with this name in `[axle.right]`.
fn own_table<'a>(root: &'a mut dyn TableLike, name: &str) -> &'a mut Table {
    let axle = root.entry("axle").or_insert(Item::None);
    let right = &mut of_tables(axle)["right"];
    of_tables(&mut of_tables(right)[name])
}

/// Converts the item to a table with a separate section. An inline table keeps its entries. Any other item becomes an empty
/// table.
fn of_tables(item: &mut Item) -> &mut Table {
    if !item.is_table() {
        let inline = std::mem::take(item).into_table();
        let mut own = inline.unwrap_or_default();
        own.set_implicit(own.is_empty());
        *item = Item::Table(own);
    }
    item.as_table_mut().expect("the item is a table")
}

/// Array with a point's coordinates at the right wheel, if the study gives them.
fn right_coordinates<'a>(root: &'a mut dyn TableLike, name: &str) -> Option<&'a mut Array> {
    let points = table(root, &["axle", "right", "hardpoints"])?;
    points.get_mut(name)?.as_array_mut()
}

/// Array with a point's coordinates.
fn coordinates<'a>(root: &'a mut dyn TableLike, name: &str) -> Option<&'a mut Array> {
    let suspension = table(root, &["suspension"])?;
    let is_hardpoint = suspension
        .get("hardpoints")
        .and_then(Item::as_table_like)
        .is_some_and(|hardpoints| hardpoints.contains_key(name));
    let item = if is_hardpoint {
        table(suspension, &["hardpoints"])?.get_mut(name)?
    } else {
        table(suspension, &["extra_points", name])?.get_mut("position")?
    };
    item.as_array_mut()
}

/// Table at a path of keys.
fn table<'a>(root: &'a mut dyn TableLike, path: &[&str]) -> Option<&'a mut dyn TableLike> {
    let mut keys = path.iter();
    keys.try_fold(root, |table, key| table.get_mut(key)?.as_table_like_mut())
}

/// Converts a point from the kernel's frame (left wheel, x forward, y left, z up) to its form in a study file.
fn written(place: Vector3<f64>, frame: Frame) -> Item {
    Item::Value(Array::from_iter(frame.vector(place).to_array()).into())
}

/// Replaces a value by a number, and keeps the spaces and comments around it.
fn replace(value: &mut Value, number: f64) {
    let decor = value.decor().clone();
    *value = number.into();
    *value.decor_mut() = decor;
}

fn target(root: &mut dyn TableLike, place: usize) -> Option<&mut dyn TableLike> {
    match table(root, &["optimise"])?.get_mut("targets")? {
        Item::ArrayOfTables(tables) => Some(tables.get_mut(place)?),
        Item::Value(Value::Array(array)) => Some(array.get_mut(place)?.as_inline_table_mut()?),
        _ => None,
    }
}
