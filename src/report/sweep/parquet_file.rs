//! Tables of results as Apache Parquet: the columns and values of the CSV file, in row groups, compressed with Zstandard. The
//! workers pass rows as CSV text, and [`CsvOfParquet`] returns CSV text. The conversion to text and back changes no number.

use super::checksum::SummedFile;
use crate::sweep::csv::{append_number, append_text, append_whole};
use parquet::basic::{Compression, ZstdLevel};
use parquet::column::reader::ColumnReader;
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;
use std::fs::File;
use std::io::{self, BufRead, Read};
use std::path::Path;
use std::sync::Arc;

/// Number of rows in a row group.
const GROUP: usize = 1 << 15;

/// Parquet file that is being written.
pub(super) struct ParquetFile {
    writer: SerializedFileWriter<SummedFile>,
    columns: Vec<Column>,
    rows: usize,
}

/// Values of a column in the current row group. In `levels`, each row has a 1 if it has a value, or else a 0.
enum Column {
    Whole(Vec<i64>),
    Number {
        values: Vec<f64>,
        levels: Vec<i16>,
    },
    Text {
        values: Vec<ByteArray>,
        levels: Vec<i16>,
    },
}

impl Column {
    /// Empty column. Its name determines the type of its values.
    fn named(name: &str) -> Self {
        match name {
            "design" | "failed_stations" => Column::Whole(Vec::new()),
            "reason" | "status" => Column::Text {
                values: Vec::new(),
                levels: Vec::new(),
            },
            _ => Column::Number {
                values: Vec::new(),
                levels: Vec::new(),
            },
        }
    }

    /// Field of the column in a Parquet schema.
    fn schema(&self, name: &str) -> String {
        match self {
            Column::Whole(_) => format!("REQUIRED INT64 {name};"),
            Column::Number { .. } => format!("OPTIONAL DOUBLE {name};"),
            Column::Text { .. } => format!("OPTIONAL BINARY {name} (UTF8);"),
        }
    }

    /// Appends a cell of CSV. `None` if the cell does not have the type of the column.
    fn push(&mut self, cell: &str) -> Option<()> {
        match self {
            Column::Whole(values) => values.push(cell.parse().ok()?),
            Column::Number { values, levels } => {
                levels.push(i16::from(!cell.is_empty()));
                if !cell.is_empty() {
                    values.push(cell.parse().ok()?);
                }
            }
            Column::Text { values, levels } => {
                levels.push(i16::from(!cell.is_empty()));
                if !cell.is_empty() {
                    values.push(cell.into());
                }
            }
        }
        Some(())
    }

    fn clear(&mut self) {
        match self {
            Column::Whole(values) => values.clear(),
            Column::Number { values, levels } => {
                values.clear();
                levels.clear();
            }
            Column::Text { values, levels } => {
                values.clear();
                levels.clear();
            }
        }
    }
}

fn failed(error: ParquetError) -> io::Error {
    match error {
        ParquetError::External(error) => io::Error::other(error.to_string()),
        other => io::Error::other(other),
    }
}

impl ParquetFile {
    /// Begins a file with the columns of a CSV header.
    pub(super) fn begin(file: SummedFile, header: &[u8]) -> io::Result<Self> {
        let header = String::from_utf8_lossy(header);
        let names: Vec<&str> = header.trim_end().split(',').collect();
        let columns: Vec<Column> = names.iter().map(|name| Column::named(name)).collect();
        let fields: Vec<String> = columns
            .iter()
            .zip(&names)
            .map(|(column, name)| column.schema(name))
            .collect();
        let schema = format!("message table {{ {} }}", fields.join(" "));
        let schema = Arc::new(parse_message_type(&schema).map_err(failed)?);
        let properties = WriterProperties::builder()
            .set_compression(Compression::ZSTD(ZstdLevel::default()))
            .set_created_by(format!("hardpoint {}", env!("CARGO_PKG_VERSION")))
            .build();
        Ok(ParquetFile {
            writer: SerializedFileWriter::new(file, schema, Arc::new(properties))
                .map_err(failed)?,
            columns,
            rows: 0,
        })
    }

    /// Appends complete rows of CSV. An error if a cell does not have the type of its column.
    pub(super) fn append(&mut self, rows: &[u8]) -> io::Result<()> {
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .from_reader(rows);
        let mut record = csv::StringRecord::new();
        while reader.read_record(&mut record).map_err(io::Error::other)? {
            for (column, cell) in self.columns.iter_mut().zip(&record) {
                let wrong =
                    || io::Error::other(format!("{cell:?} does not have the type of its column"));
                column.push(cell).ok_or_else(wrong)?;
            }
            self.rows += 1;
            if self.rows == GROUP {
                self.write_group().map_err(failed)?;
            }
        }
        Ok(())
    }

    /// Writes the current rows as a row group.
    fn write_group(&mut self) -> Result<(), ParquetError> {
        let mut group = self.writer.next_row_group()?;
        for column in &mut self.columns {
            let mut writer = group.next_column()?.expect("each column has a writer");
            match column {
                Column::Whole(values) => writer
                    .typed::<Int64Type>()
                    .write_batch(values, None, None)?,
                Column::Number { values, levels } => {
                    writer
                        .typed::<DoubleType>()
                        .write_batch(values, Some(levels), None)?
                }
                Column::Text { values, levels } => {
                    writer
                        .typed::<ByteArrayType>()
                        .write_batch(values, Some(levels), None)?
                }
            };
            writer.close()?;
            column.clear();
        }
        group.close()?;
        self.rows = 0;
        Ok(())
    }

    /// Writes the remaining rows and the end of the file. Returns the complete file.
    pub(super) fn finish(mut self) -> io::Result<SummedFile> {
        if self.rows > 0 {
            self.write_group().map_err(failed)?;
        }
        self.writer.into_inner().map_err(failed)
    }
}

/// Reader that converts a Parquet file to CSV text, one row group after the other.
pub(super) struct CsvOfParquet {
    reader: SerializedFileReader<File>,
    next_group: usize,
    text: Vec<u8>,
    at: usize,
}

impl CsvOfParquet {
    /// Opens a file.
    pub(super) fn open(path: &Path) -> io::Result<Self> {
        let reader = SerializedFileReader::new(File::open(path)?).map_err(failed)?;
        let schema = reader.metadata().file_metadata().schema_descr();
        let names: Vec<&str> = schema.columns().iter().map(|c| c.name()).collect();
        Ok(CsvOfParquet {
            text: (names.join(",") + "\n").into_bytes(),
            reader,
            next_group: 0,
            at: 0,
        })
    }

    /// Replaces the text by the rows of the next row group.
    fn read_group(&mut self) -> Result<(), ParquetError> {
        let group = self.reader.get_row_group(self.next_group)?;
        self.next_group += 1;
        let rows = group.metadata().num_rows() as usize;
        let columns = (0..group.num_columns())
            .map(|k| read_column(group.get_column_reader(k)?, rows))
            .collect::<Result<Vec<Column>, ParquetError>>()?;
        self.text.clear();
        self.at = 0;
        let mut taken = vec![0; columns.len()];
        for row in 0..rows {
            for (k, column) in columns.iter().enumerate() {
                if k > 0 {
                    self.text.push(b',');
                }
                let next = &mut taken[k];
                match column {
                    Column::Whole(values) => append_whole(values[row] as u64, &mut self.text),
                    Column::Number { values, levels } if levels[row] > 0 => {
                        append_number(values[*next], &mut self.text);
                        *next += 1;
                    }
                    Column::Text { values, levels } if levels[row] > 0 => {
                        append_text(values[*next].as_utf8()?, &mut self.text);
                        *next += 1;
                    }
                    _ => {}
                }
            }
            self.text.push(b'\n');
        }
        Ok(())
    }
}

/// Reads all rows of a column in a row group.
fn read_column(reader: ColumnReader, rows: usize) -> Result<Column, ParquetError> {
    let (mut whole, mut numbers, mut texts, mut levels) = (vec![], vec![], vec![], vec![]);
    Ok(match reader {
        ColumnReader::Int64ColumnReader(mut reader) => {
            reader.read_records(rows, None, None, &mut whole)?;
            Column::Whole(whole)
        }
        ColumnReader::DoubleColumnReader(mut reader) => {
            reader.read_records(rows, Some(&mut levels), None, &mut numbers)?;
            Column::Number {
                values: numbers,
                levels,
            }
        }
        ColumnReader::ByteArrayColumnReader(mut reader) => {
            reader.read_records(rows, Some(&mut levels), None, &mut texts)?;
            Column::Text {
                values: texts,
                levels,
            }
        }
        _ => return Err(ParquetError::General("a column of another kind".to_owned())),
    })
}

impl BufRead for CsvOfParquet {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        while self.at == self.text.len()
            && self.next_group < self.reader.metadata().num_row_groups()
        {
            self.read_group().map_err(failed)?;
        }
        Ok(&self.text[self.at..])
    }

    fn consume(&mut self, count: usize) {
        self.at += count;
    }
}

impl Read for CsvOfParquet {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let count = self.fill_buf()?.read(into)?;
        self.consume(count);
        Ok(count)
    }
}
