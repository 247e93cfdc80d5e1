//! Texts from disk.

use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::Path;

/// The longest study or curve, in bytes: millions of points of a curve.
pub const LONGEST_TEXT: u64 = 64 << 20;

/// The longest file of designs, in bytes: some ten million designs, which a sweep keeps in memory.
pub const LONGEST_TABLE: u64 = 1 << 30;

/// The content of a text file of at most so many bytes, or why there is none. A pipe is read to its end, a
/// device, which may have none, is refused.
pub fn read_text(path: &Path, longest: u64) -> Result<String, String> {
    let failed = |e: std::io::Error| match e.kind() {
        ErrorKind::NotFound => "there is no such file".to_owned(),
        ErrorKind::PermissionDenied => "permission denied".to_owned(),
        _ => e.to_string(),
    };
    let kind = path.metadata().map_err(failed)?.file_type();
    if kind.is_dir() {
        return Err("it is a directory".to_owned());
    }
    if is_device(kind) {
        return Err("it is a device; expected a file".to_owned());
    }
    let file = File::open(path).map_err(failed)?;
    text_of(file, longest, failed)
}

/// What comes from standard input, up to so many bytes.
pub fn read_input(longest: u64) -> Result<String, String> {
    text_of(std::io::stdin().lock(), longest, |error| error.to_string())
}

/// All that comes, up to so many bytes, as a text.
fn text_of(
    from: impl Read,
    longest: u64,
    failed: impl Fn(std::io::Error) -> String,
) -> Result<String, String> {
    let mut bytes = Vec::new();
    from.take(longest + 1)
        .read_to_end(&mut bytes)
        .map_err(failed)?;
    if bytes.len() as u64 > longest {
        return Err(format!(
            "it is longer than {} MB, the most that is read of such a file",
            longest >> 20
        ));
    }
    String::from_utf8(bytes).map_err(|e| {
        let valid = e.utf8_error().valid_up_to();
        let line = e.as_bytes()[..valid]
            .iter()
            .filter(|b| **b == b'\n')
            .count()
            + 1;
        format!("line {line} is not UTF-8 text")
    })
}

#[cfg(unix)]
fn is_device(kind: std::fs::FileType) -> bool {
    use std::os::unix::fs::FileTypeExt;
    kind.is_char_device() || kind.is_block_device()
}

#[cfg(not(unix))]
fn is_device(_: std::fs::FileType) -> bool {
    false
}
