//! `report.html`: a run as one self-contained page.
//!
//! Text, tables and charts are written here. The page's own small script adds the crosshair, the zoom and the view of the
//! mechanism. The page loads nothing, and its content security policy states this.

mod car;
mod charts;
mod compare;
mod escape;
mod kc;
mod motions;
mod opening;
mod policy;
mod run;
mod scatter;
mod script;
mod sheet;
mod strips;
mod sweep;
mod table;
mod tuning_charts;
mod tuning_sections;

pub use car::{car_page, car_page_of_design};
pub use compare::comparison_page;
pub use kc::kc_page;
pub use run::{PageDesign, page, page_of_design};
pub use sheet::{LimitsSheet, limits_page, set_up_page};
pub use sweep::sweep_page;

use super::chart::page_style;
use escape::html;
use serde::Serialize;

const STYLE: &str = include_str!("style.css");

/// Style of a page and of its charts.
fn style() -> String {
    STYLE.to_owned() + &page_style()
}

/// Drawing of the mechanism with its controls.
const STAGE: &str = include_str!("stage.html");

/// Content of a page. `study`, `about` and `files` are plain text; all other texts are HTML.
struct Page<'a, Data> {
    study: &'a str,
    about: String,
    /// Key values at the top of the page: name and value of each.
    facts: Vec<(&'static str, String)>,
    /// Remarks above the charts of the page.
    remarks: String,
    /// Identifiers and names of the page's sections.
    sections: Vec<(&'static str, &'static str)>,
    controls: &'a str,
    main: String,
    files: &'a [String],
    /// Data for the page's script.
    data: Data,
    /// Parts of the page's own script.
    scripts: &'a [&'a str],
}

/// Sections that appear on the screen but not on paper: identifier and name.
const ON_SCREEN: [(&str, &str); 4] = [
    ("turn", "Steering geometry"),
    ("convergence", "Convergence"),
    ("prices", "Smallest misfit"),
    ("sensitivities", "Sensitivities"),
];

impl<Data: Serialize> Page<'_, Data> {
    /// Note on the printed page that names the omitted sections. It names only sections that the page has on the screen.
    fn omitted(&self) -> String {
        let is_there = |id: &str| match id {
            "prices" => self.main.contains("id=\"prices\""),
            id => self.sections.iter().any(|(own, _)| *own == id),
        };
        let names = ON_SCREEN.into_iter().filter(|(id, _)| is_there(id));
        let names: Vec<&str> = names.map(|(_, name)| name).collect();
        match names.as_slice() {
            [] => String::new(),
            names => format!(
                "<p class=\"printed\">Not printed: {}. The page on the screen has them.</p>",
                names.join(", ")
            ),
        }
    }

    fn html(&self) -> String {
        let script = script::script(self.scripts);
        let style = style();
        let fact =
            |(name, value): &(&str, String)| format!("<div><dt>{name}</dt><dd>{value}</dd></div>");
        let link = |(id, name): &(&str, &str)| format!("<li><a href=\"#{id}\">{name}</a></li>");
        let files: Vec<String> = self.files.iter().map(|f| html(f)).collect();
        format!(
            include_str!("page.html"),
            policy = html(&policy::policy(&[&script], &style)),
            study = html(self.study),
            heading = table::breakable(self.study),
            style = style,
            about = html(&self.about),
            facts = self.facts.iter().map(fact).collect::<String>(),
            remarks = self.remarks,
            sections = self.sections.iter().map(link).collect::<String>(),
            controls = self.controls,
            omitted = self.omitted(),
            main = self.main,
            source = if files.is_empty() {
                "Made from results in memory, without files.".to_owned()
            } else {
                format!(
                    "Read from {}. The numbers on this page are the numbers in the files.",
                    files.join(", ")
                )
            },
            data = escape::json(&self.data),
            script = script,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::contrast::{contrast, mixed, palettes};

    /// Words of a page have a contrast of at least 4.5 on paper and in panels, lines at least 3. Cells of heat maps are shaded
    /// with up to 70 % of a colour, and the text in them has the normal text colour.
    #[test]
    fn colours_can_be_read() {
        const WORDS: [&str; 4] = ["ink", "muted", "accent", "bad"];
        let all = palettes(STYLE);
        let [light, system, dark] = all.as_slice() else {
            panic!("{} palettes", all.len());
        };
        assert_eq!(dark, system);
        for palette in [light, dark] {
            let [paper, panel, ink] = ["paper", "panel", "ink"].map(|name| palette[name]);
            for (name, colour) in palette {
                let is = contrast(colour, paper);
                let least = match *name {
                    "paper" | "panel" | "rule" | "grid" | "less" => continue,
                    "target" | "centre" => 4.5,
                    name if WORDS.contains(&name) => {
                        assert!(contrast(colour, panel) >= 4.5, "{name} in a panel");
                        4.5
                    }
                    _ => 3.0,
                };
                assert!(is >= least, "{name} {colour}: {is:.2}");
            }
            for shade in ["strong", "less"] {
                let is = contrast(&mixed(palette[shade], paper, 0.7), ink);
                assert!(is >= 4.5, "{shade}: {is:.2}");
            }
        }
    }
}
