//! A file of rows that grows by whole blocks, as CSV or Parquet, and the way to read one back.

use super::unwritten;
use crate::report::WriteError;
use std::fs::{File, OpenOptions};
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// A file of rows that is being written.
pub struct TableFile {
    path: PathBuf,
    out: Out,
    /// Bytes written, as CSV.
    length: u64,
}

enum Out {
    Standard,
    Csv(File),
    #[cfg(feature = "parquet")]
    Parquet(Box<super::parquet_file::ParquetFile>),
}

impl TableFile {
    /// Writes CSV to standard output.
    pub fn standard_output(header: &[u8]) -> Result<Self, WriteError> {
        let mut file = TableFile {
            path: PathBuf::from("standard output"),
            out: Out::Standard,
            length: 0,
        };
        file.append(header)?;
        Ok(file)
    }

    /// Begins a file; the ending of its name says what it is. `header` is that of a CSV file.
    pub fn begin(path: PathBuf, header: &[u8]) -> Result<Self, WriteError> {
        #[cfg(feature = "parquet")]
        if is_parquet(&path) {
            let file = super::parquet_file::ParquetFile::begin(&path, header);
            return Ok(TableFile {
                out: Out::Parquet(Box::new(file.map_err(unwritten(&path))?)),
                path,
                length: header.len() as u64,
            });
        }
        let file = File::create(&path).map_err(unwritten(&path))?;
        let mut file = TableFile {
            out: Out::Csv(file),
            path,
            length: 0,
        };
        file.append(header)?;
        Ok(file)
    }

    /// Opens a file to go on after so many bytes (as CSV); the rest is dropped.
    pub fn reopen(path: PathBuf, header: &[u8], length: u64) -> Result<Self, WriteError> {
        if is_parquet(&path) {
            // A Parquet file has an end: it is written again.
            let copy = || -> io::Result<TableFile> {
                let mut lines = open_lines(&path)?;
                let rest = length - header.len() as u64;
                io::copy(&mut (&mut lines).take(header.len() as u64), &mut io::sink())?;
                let mut file = TableFile::begin(path.clone(), header).map_err(|e| e.source)?;
                file.copy_rows(&mut lines.take(rest))
                    .map_err(|e| e.source)?;
                Ok(file)
            };
            return copy().map_err(unwritten(&path));
        }
        let open = || -> io::Result<File> {
            let mut file = OpenOptions::new().write(true).open(&path)?;
            file.set_len(length)?;
            file.seek(SeekFrom::End(0))?;
            Ok(file)
        };
        Ok(TableFile {
            out: Out::Csv(open().map_err(unwritten(&path))?),
            path,
            length,
        })
    }

    /// Appends rows of CSV.
    pub fn append(&mut self, rows: &[u8]) -> Result<(), WriteError> {
        let written = match &mut self.out {
            Out::Standard => io::stdout().write_all(rows),
            Out::Csv(file) => file.write_all(rows).inspect_err(|_| {
                // A disk that is full: what there is of the block goes. If that fails as well,
                // resuming will find the torn row.
                let _ = file.set_len(self.length);
            }),
            #[cfg(feature = "parquet")]
            Out::Parquet(file) => file.append(rows),
        };
        written.map_err(unwritten(&self.path))?;
        self.length += rows.len() as u64;
        Ok(())
    }

    /// Appends all that is left of some rows of CSV.
    pub fn copy_rows(&mut self, lines: &mut dyn BufRead) -> Result<(), WriteError> {
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

    /// Ends the file.
    pub fn finish(self) -> Result<(), WriteError> {
        match self.out {
            Out::Standard | Out::Csv(_) => Ok(()),
            #[cfg(feature = "parquet")]
            Out::Parquet(file) => file.finish().map_err(unwritten(&self.path)),
        }
    }
}

fn is_parquet(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending == "parquet")
}

/// The lines of a file as CSV, the header first.
pub fn open_lines(path: &Path) -> io::Result<Box<dyn BufRead>> {
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
    use super::super::rows_csv;
    use super::*;

    /// Rows of several groups come back as they were written, and after a part of them is kept.
    #[test]
    fn parquet_gives_the_text_back() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("designs.parquet");
        let header = b"design,a+b_dz_mm,camber_min_deg,failed_stations,reason,status\n";
        let written = |value: f64| {
            let mut text = Vec::new();
            rows_csv::append_number(value, &mut text);
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
        let mut file = TableFile::begin(path.clone(), header).unwrap();
        for block in rows.chunks(128) {
            file.append(block.concat().as_bytes()).unwrap();
        }
        file.finish().unwrap();
        let whole = String::from_utf8(header.to_vec()).unwrap() + &rows.concat();
        assert!(read() == whole);
        let bytes = std::fs::read(&path).unwrap();
        let kept = header.len() + rows[..1000].concat().len();
        let mut file = TableFile::reopen(path.clone(), header, kept as u64).unwrap();
        file.append(rows[1000..].concat().as_bytes()).unwrap();
        file.finish().unwrap();
        assert!(std::fs::read(&path).unwrap() == bytes);
    }
}
