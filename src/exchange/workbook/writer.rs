//! Writes workbooks that contain only tables of texts and numbers (ECMA-376, part 1, section 12.3; part 2 for the package). A
//! number is the shortest decimal that reads back to the same bits. Equal tables give equal bytes, because the archive contains
//! no time.

use super::markup::escaped;
use crate::exchange::cell::letters;
use flate2::write::DeflateEncoder;
use flate2::{Compression, Crc};
use std::io::Write;

/// A cell to be written.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// An empty cell.
    Empty,
    /// A text.
    Text(String),
    /// A number. NaN and infinity become an empty cell.
    Number(f64),
}

/// A table to be written. Its first row is the header.
#[derive(Clone, Debug, PartialEq)]
pub struct Page {
    /// Name of the sheet for the table.
    pub name: String,
    /// Rows of cells.
    pub rows: Vec<Vec<Value>>,
}

/// Largest number of rows of a sheet in Excel and LibreOffice.
pub(crate) const MOST_ROWS: usize = 1_048_576;

const MAIN: &str = "http://schemas.openxmlformats.org/spreadsheetml/2006/main";
const OFFICE: &str = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
const PACKAGE: &str = "http://schemas.openxmlformats.org/package/2006";
const TYPE: &str = "application/vnd.openxmlformats-officedocument.spreadsheetml";
const HEAD: &str = r#"<?xml version="1.0" encoding="UTF-8" standalone="yes"?>"#;

/// Bytes of a workbook. Rows beyond the largest number of rows of a sheet are left out, so callers count the rows first.
pub fn workbook(pages: &[Page]) -> Vec<u8> {
    let names = sheet_names(pages);
    let numbers = 1..=pages.len();
    let overrides: String = numbers
        .clone()
        .map(|n| format!(r#"<Override PartName="/xl/worksheets/sheet{n}.xml" ContentType="{TYPE}.worksheet+xml"/>"#))
        .collect();
    let sheets: String = numbers
        .clone()
        .zip(&names)
        .map(|(n, name)| {
            format!(
                r#"<sheet name="{}" sheetId="{n}" r:id="rId{n}"/>"#,
                escaped(name)
            )
        })
        .collect();
    let relations: String = numbers
        .clone()
        .map(|n| format!(r#"<Relationship Id="rId{n}" Type="{OFFICE}/worksheet" Target="worksheets/sheet{n}.xml"/>"#))
        .collect();
    let styles_id = pages.len() + 1;
    let mut archive = Archive::default();
    archive.add("[Content_Types].xml", &format!(
        r#"{HEAD}<Types xmlns="{PACKAGE}/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="xml" ContentType="application/xml"/><Override PartName="/xl/workbook.xml" ContentType="{TYPE}.sheet.main+xml"/><Override PartName="/xl/styles.xml" ContentType="{TYPE}.styles+xml"/>{overrides}</Types>"#
    ));
    archive.add("_rels/.rels", &format!(
        r#"{HEAD}<Relationships xmlns="{PACKAGE}/relationships"><Relationship Id="rId1" Type="{OFFICE}/officeDocument" Target="xl/workbook.xml"/></Relationships>"#
    ));
    archive.add("xl/workbook.xml", &format!(
        r#"{HEAD}<workbook xmlns="{MAIN}" xmlns:r="{OFFICE}"><sheets>{sheets}</sheets></workbook>"#
    ));
    archive.add("xl/_rels/workbook.xml.rels", &format!(
        r#"{HEAD}<Relationships xmlns="{PACKAGE}/relationships">{relations}<Relationship Id="rId{styles_id}" Type="{OFFICE}/styles" Target="styles.xml"/></Relationships>"#
    ));
    archive.add("xl/styles.xml", &format!(
        r#"{HEAD}<styleSheet xmlns="{MAIN}"><fonts count="2"><font><sz val="11"/><name val="Calibri"/></font><font><b/><sz val="11"/><name val="Calibri"/></font></fonts><fills count="2"><fill><patternFill patternType="none"/></fill><fill><patternFill patternType="gray125"/></fill></fills><borders count="1"><border><left/><right/><top/><bottom/><diagonal/></border></borders><cellStyleXfs count="1"><xf numFmtId="0" fontId="0" fillId="0" borderId="0"/></cellStyleXfs><cellXfs count="2"><xf numFmtId="0" fontId="0" fillId="0" borderId="0" xfId="0"/><xf numFmtId="0" fontId="1" fillId="0" borderId="0" xfId="0" applyFont="1"/></cellXfs><cellStyles count="1"><cellStyle name="Normal" xfId="0" builtinId="0"/></cellStyles></styleSheet>"#
    ));
    for (n, page) in numbers.zip(pages) {
        archive.add(&format!("xl/worksheets/sheet{n}.xml"), &sheet(page));
    }
    archive.finish()
}

/// Sheet names as Excel requires them: short, distinct, and without some characters.
fn sheet_names(pages: &[Page]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for page in pages {
        let plain = page.name.replace(['[', ']', ':', '*', '?', '/', '\\'], "_");
        let plain: String = plain.chars().take(31).collect();
        // Excel refuses an apostrophe at the start or end.
        let plain = plain.trim_matches('\'').to_owned();
        let plain = if plain.is_empty() {
            "Sheet".to_owned()
        } else {
            plain
        };
        let taken = |name: &str| {
            names
                .iter()
                .any(|n| n.to_lowercase() == name.to_lowercase())
        };
        let mut name = plain.clone();
        let mut number = 2;
        while taken(&name) {
            let short: String = plain.chars().take(26).collect();
            name = format!("{short} {number}");
            number += 1;
        }
        names.push(name);
    }
    names
}

fn sheet(page: &Page) -> String {
    let widths = column_widths(page);
    let columns: String = widths
        .iter()
        .zip(1..)
        .map(|(width, n)| format!(r#"<col min="{n}" max="{n}" width="{width}" customWidth="1"/>"#))
        .collect();
    let columns = if columns.is_empty() {
        columns
    } else {
        format!("<cols>{columns}</cols>")
    };
    let mut text = format!(
        r#"{HEAD}<worksheet xmlns="{MAIN}"><sheetViews><sheetView workbookViewId="0"><pane ySplit="1" topLeftCell="A2" state="frozen"/></sheetView></sheetViews>{columns}<sheetData>"#
    );
    for (cells, row) in page.rows.iter().take(MOST_ROWS).zip(1..) {
        text += &format!(r#"<row r="{row}">"#);
        let style = if row == 1 { r#" s="1""# } else { "" };
        for (cell, column) in cells.iter().zip(0..) {
            let place = || format!("{}{row}", letters(column));
            match cell {
                Value::Number(number) if number.is_finite() => {
                    text += &format!(r#"<c r="{}"{style}><v>{:?}</v></c>"#, place(), number + 0.0);
                }
                Value::Text(cell) if !cell.is_empty() => {
                    text += &format!(
                        r#"<c r="{}"{style} t="inlineStr"><is><t xml:space="preserve">{}</t></is></c>"#,
                        place(),
                        escaped(cell)
                    );
                }
                _ => (),
            }
        }
        text += "</row>";
    }
    text + "</sheetData></worksheet>"
}

/// Column widths that fit the header and the first rows.
fn column_widths(page: &Page) -> Vec<usize> {
    let columns = page.rows.iter().take(100).map(Vec::len).max().unwrap_or(0);
    let width = |cell: &Value| match cell {
        Value::Empty => 0,
        Value::Number(_) => 10,
        Value::Text(text) => text.chars().count(),
    };
    (0..columns)
        .map(|column| {
            let cells = page.rows.iter().take(100).filter_map(|row| row.get(column));
            cells.map(width).max().unwrap_or(0).clamp(6, 40) + 2
        })
        .collect()
}

/// ZIP archive to which files are added.
#[derive(Default)]
struct Archive {
    bytes: Vec<u8>,
    directory: Vec<u8>,
    members: u16,
}

impl Archive {
    fn add(&mut self, name: &str, text: &str) {
        let mut crc = Crc::new();
        crc.update(text.as_bytes());
        let mut encoder = DeflateEncoder::new(Vec::new(), Compression::default());
        encoder
            .write_all(text.as_bytes())
            .expect("writing to memory does not fail");
        let packed = encoder.finish().expect("writing to memory does not fail");
        let offset = self.bytes.len() as u32;
        // Fields of the entry: version 2.0, no flags, deflated, and the earliest time of the format.
        let mut common = Vec::new();
        for field in [20u16, 0, 8, 0, 0x21] {
            common.extend(field.to_le_bytes());
        }
        for field in [crc.sum(), packed.len() as u32, text.len() as u32] {
            common.extend(field.to_le_bytes());
        }
        common.extend((name.len() as u16).to_le_bytes());
        common.extend(0u16.to_le_bytes());

        self.bytes.extend(0x0403_4b50u32.to_le_bytes());
        self.bytes.extend(&common);
        self.bytes.extend(name.as_bytes());
        self.bytes.extend(packed);

        self.directory.extend(0x0201_4b50u32.to_le_bytes());
        self.directory.extend(20u16.to_le_bytes());
        self.directory.extend(&common);
        // Fields of the directory entry: no comment, disk 0, no attributes.
        self.directory.extend([0; 10]);
        self.directory.extend(offset.to_le_bytes());
        self.directory.extend(name.as_bytes());
        self.members += 1;
    }

    fn finish(mut self) -> Vec<u8> {
        let offset = self.bytes.len() as u32;
        let size = self.directory.len() as u32;
        self.bytes.append(&mut self.directory);
        self.bytes.extend(0x0605_4b50u32.to_le_bytes());
        self.bytes.extend([0; 4]);
        self.bytes.extend(self.members.to_le_bytes());
        self.bytes.extend(self.members.to_le_bytes());
        self.bytes.extend(size.to_le_bytes());
        self.bytes.extend(offset.to_le_bytes());
        self.bytes.extend([0; 2]);
        self.bytes
    }
}
