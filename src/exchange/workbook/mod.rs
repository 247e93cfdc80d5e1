//! Reads and writes workbooks of spreadsheet programs (.xlsx).
//!
//! Reader and writer are our own code. They use the compression crate that PNG pictures need anyway. Existing crates for workbooks
//! would be a quarter of the build. They also read a complete sheet into memory before its size can be checked, even a
//! decompression bomb.

mod archive;
mod markup;
mod reader;
mod writer;

pub(super) use reader::Workbook;
pub(super) use writer::MOST_ROWS;
pub use writer::{Page, Value, workbook};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exchange::cell::Cell;

    fn page(rows: Vec<Vec<Value>>) -> Page {
        let name = "Points [mm]".to_owned();
        Page { name, rows }
    }

    #[test]
    fn what_is_written_reads_back_to_the_same_bits() {
        let numbers = [0.1, -1.0 / 3.0, 1e-7, 123456.789, f64::MIN_POSITIVE, 1e12];
        let rows = numbers.map(|n| {
            vec![
                Value::Text(format!("a & <{n}>")),
                Value::Empty,
                Value::Number(n),
            ]
        });
        let bytes = workbook(&[page(rows.to_vec()), page(Vec::new())]);
        assert_eq!(bytes, workbook(&[page(rows.to_vec()), page(Vec::new())]));
        let book = Workbook::open(bytes).unwrap();
        assert_eq!(
            book.names().collect::<Vec<_>>(),
            ["Points _mm_", "Points _mm_ 2"]
        );
        let sheet = book.sheet(0).unwrap();
        for (number, row) in numbers.into_iter().zip(0..) {
            assert_eq!(
                sheet.cell(row, 0),
                Some(&Cell::Text(format!("a & <{number}>")))
            );
            assert_eq!(sheet.cell(row, 1), None);
            let Some(Cell::Number(read)) = sheet.cell(row, 2) else {
                panic!("row {row}");
            };
            assert_eq!(read.to_bits(), number.to_bits());
        }
    }

    #[test]
    fn damage_anywhere_is_refused_or_changes_nothing() {
        let rows = vec![vec![
            Value::Text("lower_arm_front".to_owned()),
            Value::Number(120.5),
        ]];
        let bytes = workbook(&[page(rows)]);
        let sheet = |bytes: Vec<u8>| Workbook::open(bytes)?.sheet(0);
        let whole = sheet(bytes.clone()).unwrap();
        for at in 0..bytes.len() {
            let mut damaged = bytes.clone();
            damaged[at] ^= 0x55;
            // A checksum protects the content of each file in the archive, but not the names of these files. So damage to a
            // name may give an empty sheet.
            if let Ok(read) = std::panic::catch_unwind(|| sheet(damaged)).expect("no panic") {
                assert!(
                    read.cells == whole.cells || read.cells.is_empty(),
                    "byte {at}"
                );
            }
            assert!(std::panic::catch_unwind(|| sheet(bytes[..at].to_vec())).is_ok());
        }
    }

    #[test]
    fn a_bomb_is_refused_before_it_goes_off() {
        // This workbook has about 40 kB, but unpacks to 35 MB of text.
        let text = "a".repeat(1 << 19);
        let rows = vec![vec![Value::Text(text)]; 70];
        let bytes = workbook(&[page(rows)]);
        assert!(bytes.len() < 1 << 20);
        let refused = Workbook::open(bytes).unwrap().sheet(0).unwrap_err();
        assert!(refused.contains("unpacks to more than 32 MB"), "{refused}");
    }
}
