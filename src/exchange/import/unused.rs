//! Points and values of a file that the study does not use.

use super::super::complete;
use super::super::corner::Corner;
use super::super::names::cut;
use super::super::notes::Notes;
use super::super::roles::{Role, end_of_drop_link};
use super::super::table::{Marks, PointTable};
use super::{Hardpoint, ImportOptions};

/// Data of a file, from which the import finds the points and values that the study does not use.
pub(super) struct Unused<'a> {
    pub(super) table: &'a PointTable,
    pub(super) options: &'a ImportOptions<'a>,
    pub(super) roles: &'a [Option<Role>],
    pub(super) corner: Corner,
    /// Names of values that the import does not use.
    pub(super) numbers: &'a [String],
}

impl Unused<'_> {
    /// Points of the chosen axle and points without an axle, with their roles.
    fn of_axle(&self) -> (PointTable, Vec<Option<Role>>) {
        let points = self.table.points.iter().zip(self.roles);
        let own = points.filter(|(point, role)| {
            let named = role.as_ref().map_or(Marks::default(), |role| role.marks);
            let axle = point.marks.or(named).axle;
            axle.is_none() || self.corner.axle.is_none() || axle == self.corner.axle
        });
        let (points, roles) = own
            .map(|(point, role)| (point.clone(), role.clone()))
            .unzip();
        let table = PointTable {
            points,
            ..PointTable::default()
        };
        (table, roles)
    }

    /// Adds the unused points and values to `left_out`, with the reasons. Adds a note if another topology would use them.
    pub(super) fn say(
        &self,
        hardpoints: &[Hardpoint],
        notes: &mut Notes,
        left_out: &mut Vec<String>,
    ) {
        let topology = self.options.topology;
        let (table, roles) = self.of_axle();
        let (table, meanings) = (&table, meanings(&roles));
        let unused = complete::unused(table, &meanings, hardpoints);
        if let Some(other) = complete::rather(topology, &unused, table) {
            notes.doubt(format!(
                "please check: together with the unused points, the points form a {}; --topology {} \
                 would use them",
                other.name.replace('_', " "),
                other.name
            ));
        }
        // `left_out` already has a reason for points of an omitted spring, rocker or anti-roll bar.
        let is_explained = |name: &str| {
            let at = table.points.iter().position(|point| point.name == name);
            at.is_some_and(|at| meanings[at].is_some())
        };
        let nameless = unused.iter().filter(|name| !is_explained(name));
        let nameless: Vec<&str> = nameless.map(String::as_str).collect();
        let is_drop_link = |name: &&str| end_of_drop_link(&cut(name)).is_some();
        if let Some(name) = nameless.iter().copied().find(is_drop_link) {
            left_out.push(format!(
                "{name}: \"lower\" and \"upper\" do not show which end of the drop link is on the bar. Add the body to the name of the end \
                 that is not on the bar, as in \"drop link lower (on lower arm)\", or give --map"
            ));
        }
        if !nameless.is_empty() {
            left_out.push(format!(
                "{}: no hardpoint of a {} has such a name",
                nameless.join(", "),
                topology.name.replace('_', " ")
            ));
        }
        let of_texts = table.points.iter().zip(&meanings);
        let of_texts = of_texts.filter(|(point, meaning)| !point.has_number && meaning.is_none());
        let of_texts: Vec<&str> = of_texts.map(|(point, _)| point.name.as_str()).collect();
        left_out.extend(shortened(
            &of_texts,
            "these rows have texts instead of coordinates",
        ));
        let numbers: Vec<&str> = self.numbers.iter().map(String::as_str).collect();
        let reason = "these names of numbers are not known, or a study has no keys for them";
        left_out.extend(shortened(&numbers, reason));
    }
}

/// Lists the first names with a reason, and the number of further names. `None` without names.
fn shortened(names: &[&str], reason: &str) -> Option<String> {
    const SHOWN: usize = 12;
    let shown = &names[..names.len().min(SHOWN)];
    let more = match names.len() - shown.len() {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    (!names.is_empty()).then(|| format!("{}{more}: {reason}", shown.join(", ")))
}

/// Name of the hardpoint for each role.
pub(super) fn meanings(roles: &[Option<Role>]) -> Vec<Option<&'static str>> {
    let meanings = roles
        .iter()
        .map(|role| role.as_ref().map(|role| role.hardpoint));
    meanings.collect()
}
