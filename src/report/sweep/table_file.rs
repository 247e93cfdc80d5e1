//! A file of rows or curves in CSV or Parquet, written in complete blocks, and a reader for it.

use super::checksum::SummedFile;
use crate::results::{WriteError, unwritten};
use std::fs::File;
use std::io::{self, BufRead, BufReader, Write};
use std::path::{Path, PathBuf};

/// A file of rows that is being written.
pub struct TableFile {
    path: PathBuf,
    out: Out,
}

enum Out {
    Standard,
    Csv(SummedFile),
    #[cfg(feature = "parquet")]
    Parquet(Box<super::parquet_file::ParquetFile>),
}

impl TableFile {
    /// Makes a writer of CSV to standard output, and writes the header.
    pub fn standard_output(header: &[u8]) -> Result<Self, WriteError> {
        let mut file = TableFile {
            path: PathBuf::from("standard output"),
            out: Out::Standard,
        };
        file.append(header)?;
        Ok(file)
    }

    /// Starts to write a file. `path` is its final name, whose extension decides the format. `header` is a CSV header.
    pub fn begin(file: File, path: PathBuf, header: &[u8]) -> Result<Self, WriteError> {
        let file = SummedFile::new(file);
        #[cfg(feature = "parquet")]
        if is_parquet(&path) {
            let file = super::parquet_file::ParquetFile::begin(file, header);
            return Ok(TableFile {
                out: Out::Parquet(Box::new(file.map_err(unwritten(&path))?)),
                path,
            });
        }
        let mut file = TableFile {
            out: Out::Csv(file),
            path,
        };
        file.append(header)?;
        Ok(file)
    }

    /// Appends complete rows of CSV.
    pub fn append(&mut self, rows: &[u8]) -> Result<(), WriteError> {
        let written = match &mut self.out {
            Out::Standard => io::stdout().write_all(rows),
            Out::Csv(file) => file.write_all(rows),
            #[cfg(feature = "parquet")]
            Out::Parquet(file) => file.append(rows),
        };
        written.map_err(unwritten(&self.path))
    }

    /// Appends all remaining rows of a CSV text, after its header.
    pub fn copy_rows(&mut self, lines: &mut dyn BufRead) -> Result<(), WriteError> {
        if let Out::Csv(file) = &mut self.out {
            let copied = io::copy(lines, file);
            return copied.map(|_| ()).map_err(unwritten(&self.path));
        }
        let mut rows = Vec::new();
        loop {
            let read = lines.read_until(b'\n', &mut rows);
            let ended = read.map_err(unwritten(&self.path))? == 0;
            if rows.len() > 1 << 20 || ended {
                self.append(&rows)?;
                rows.clear();
            }
            if ended {
                return Ok(());
            }
        }
    }

    /// Completes the file. Returns its checksum; `None` for standard output.
    pub fn finish(self) -> Result<Option<String>, WriteError> {
        let file = match self.out {
            Out::Standard => return Ok(None),
            Out::Csv(file) => file,
            #[cfg(feature = "parquet")]
            Out::Parquet(file) => file.finish().map_err(unwritten(&self.path))?,
        };
        Ok(Some(file.checksum()))
    }
}

fn is_parquet(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending == "parquet")
}

/// Reader of the file's lines as CSV, the header first. A Parquet file is converted.
pub(super) fn open_lines(path: &Path) -> io::Result<Box<dyn BufRead>> {
    if !is_parquet(path) {
        return Ok(Box::new(BufReader::new(File::open(path)?)));
    }
    #[cfg(feature = "parquet")]
    return Ok(Box::new(super::parquet_file::CsvOfParquet::open(path)?));
    #[cfg(not(feature = "parquet"))]
    Err(io::Error::other(
        "this program was built without Parquet; cargo build --release --features parquet",
    ))
}

#[cfg(all(test, feature = "parquet"))]
mod tests {
    use super::*;
    use crate::sweep::csv;
    use std::io::Read;

    /// Rows in several row groups are read back unchanged. The size of the pieces in which rows are written does not change the
    /// file.
    #[test]
    fn parquet_gives_the_text_back() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("designs.parquet");
        let header = b"design,a+b_dz_mm,camber_min_deg,failed_stations,reason,status\n";
        let written = |value: f64| {
            let mut text = Vec::new();
            csv::append_number(value, &mut text);
            String::from_utf8(text).unwrap()
        };
        let row = |i: u64| {
            let height = written(i as f64 - 7.5);
            let camber = match i.is_multiple_of(3) {
                true => String::new(),
                false => written(1.0 / i as f64),
            };
            let reason = match i.is_multiple_of(5) {
                true => "",
                false => "\"it ends, \"\"there\"\"\"",
            };
            format!("{i},{height},{camber},{},{reason},ok\n", i % 4)
        };
        let rows: Vec<String> = (0..70_000).map(row).collect();
        let read = || {
            let mut text = String::new();
            open_lines(&path)
                .unwrap()
                .read_to_string(&mut text)
                .unwrap();
            text
        };
        let begin =
            || TableFile::begin(File::create(&path).unwrap(), path.clone(), header).unwrap();
        let mut file = begin();
        for block in rows.chunks(128) {
            file.append(block.concat().as_bytes()).unwrap();
        }
        file.finish().unwrap();
        let whole = String::from_utf8(header.to_vec()).unwrap() + &rows.concat();
        assert!(read() == whole);
        let bytes = std::fs::read(&path).unwrap();
        let mut file = begin();
        file.copy_rows(&mut whole[header.len()..].as_bytes())
            .unwrap();
        file.finish().unwrap();
        assert!(std::fs::read(&path).unwrap() == bytes);
    }
}
