//! Reads texts from files and from standard input.

use crate::names::nearest;
use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::Path;

/// Largest size of a study or a curve file, in bytes. It is enough for millions of points of a curve.
pub const LONGEST_TEXT: u64 = 64 << 20;

/// Largest size of a file of designs, in bytes. It is enough for about ten million designs, which a sweep keeps in memory.
pub const LONGEST_TABLE: u64 = 1 << 30;

/// Content of a text file of at most `longest` bytes without a byte-order mark, or the reason why it cannot be read. See
/// [`read_bytes`].
pub fn read_text(path: &Path, longest: u64) -> Result<String, String> {
    text_of(read_bytes(path, longest)?)
}

/// Reads a text like [`read_text`], but only from a regular file, and not from a pipe.
pub fn read_regular_text(path: &Path, longest: u64) -> Result<String, String> {
    match path.metadata() {
        Ok(there) if !there.is_file() && !there.is_dir() => {
            Err("it is not a regular file".to_owned())
        }
        _ => read_text(path, longest),
    }
}

/// Content of a file of at most `longest` bytes, or the reason why it cannot be read. A pipe of this process
/// (`/dev/stdin`, `<(...)` of a shell) is read to its end. Devices are refused because they may have no end, named
/// pipes because they may have no writer.
pub fn read_bytes(path: &Path, longest: u64) -> Result<Vec<u8>, String> {
    let failed = |e: std::io::Error| match e.kind() {
        ErrorKind::NotFound => "the file does not exist".to_owned(),
        ErrorKind::PermissionDenied => "permission denied".to_owned(),
        _ => e.to_string(),
    };
    let kind = path.metadata().map_err(failed)?.file_type();
    if kind.is_dir() {
        return Err("it is a directory".to_owned());
    }
    if let Some(other) = no_file(kind, path) {
        return Err(format!("it is a {other}; expected a file"));
    }
    let file = File::open(path).map_err(failed)?;
    bytes_of(file, longest, failed)
}

/// Text of standard input, at most `longest` bytes.
pub fn read_input(longest: u64) -> Result<String, String> {
    text_of(read_input_bytes(longest)?)
}

/// Bytes of standard input, at most `longest`.
pub fn read_input_bytes(longest: u64) -> Result<Vec<u8>, String> {
    let input = std::io::stdin().lock();
    bytes_of(input, longest, |error| error.to_string())
}

/// Reads all bytes, but at most `longest`.
fn bytes_of(
    from: impl Read,
    longest: u64,
    failed: impl Fn(std::io::Error) -> String,
) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    from.take(longest + 1)
        .read_to_end(&mut bytes)
        .map_err(failed)?;
    if bytes.len() as u64 > longest {
        return Err(format!(
            "it is longer than {} MB, the limit for such a file",
            longest >> 20
        ));
    }
    Ok(bytes)
}

/// Help for a study that does not exist: a study with a similar name in the same directory, or the directory that was searched.
/// `None` if the file exists.
pub fn absent_study(path: &Path) -> Option<String> {
    let name = path.file_name()?.to_str()?;
    if path.exists() {
        return None;
    }
    let given = path.parent().filter(|own| !own.as_os_str().is_empty());
    let given = given.unwrap_or(Path::new("."));
    let shown = std::path::absolute(given).unwrap_or(given.to_owned());
    let Ok(entries) = given.read_dir() else {
        return Some(format!("there is no directory {}", shown.display()));
    };
    let entries = entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
    let studies: Vec<String> = entries.filter(|own| own.ends_with(".toml")).collect();
    Some(match nearest(name, studies.iter().map(String::as_str)) {
        Some(near) => format!("did you mean {}?", path.with_file_name(near).display()),
        None => format!(
            "{} has no study with a similar name. `hardpoint new macpherson --out study.toml` writes a study",
            shown.display()
        ),
    })
}

/// Advice for a file that another program has written, such as a table of points. `None` for other names.
pub(crate) fn advice(name: &str) -> Option<&'static str> {
    const TABLES: [&str; 11] = [
        "csv", "tsv", "txt", "xlsx", "xlsm", "xls", "json", "yaml", "yml", "sub", "ini",
    ];
    let end = Path::new(name).extension()?.to_str()?.to_ascii_lowercase();
    let advice = "`hardpoint import` makes a study of a table of points";
    TABLES.contains(&end.as_str()).then_some(advice)
}

/// Text of a file, without the byte-order mark that spreadsheets write at its beginning.
fn text_of(bytes: Vec<u8>) -> Result<String, String> {
    const BYTE_ORDER_MARK: char = '\u{feff}';
    let mut text = String::from_utf8(bytes).map_err(|e| {
        let valid = e.utf8_error().valid_up_to();
        let line = e.as_bytes()[..valid]
            .iter()
            .filter(|b| **b == b'\n')
            .count()
            + 1;
        format!("line {line} is not UTF-8 text")
    })?;
    if text.starts_with(BYTE_ORDER_MARK) {
        text.drain(..BYTE_ORDER_MARK.len_utf8());
    }
    Ok(text)
}

/// Name of the kind of file, if it may have no end or no writer. `None` for regular files, directories and pipes of this process.
#[cfg(unix)]
fn no_file(kind: std::fs::FileType, path: &Path) -> Option<&'static str> {
    use std::os::unix::fs::FileTypeExt;
    let of_process = ["/dev", "/proc"].iter().any(|top| path.starts_with(top));
    match kind {
        kind if kind.is_char_device() || kind.is_block_device() => Some("device"),
        kind if kind.is_socket() => Some("socket"),
        kind if kind.is_fifo() && !of_process => Some("named pipe"),
        _ => None,
    }
}

#[cfg(not(unix))]
fn no_file(_: std::fs::FileType, _: &Path) -> Option<&'static str> {
    None
}
