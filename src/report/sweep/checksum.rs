//! Checksum of a file of rows. It finds edits; it does not protect against forgery.

use std::io::{self, BufRead, BufReader, Read};

/// Checksum (CRC-32) of all bytes of a reader, in hexadecimal digits.
pub(super) fn checksum(bytes: impl Read) -> io::Result<String> {
    let mut bytes = BufReader::with_capacity(1 << 16, bytes);
    let mut sum = crc32fast::Hasher::new();
    loop {
        let chunk = match bytes.fill_buf() {
            Ok([]) => return Ok(format!("{:08x}", sum.finalize())),
            Ok(chunk) => chunk,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            Err(error) => return Err(error),
        };
        sum.update(chunk);
        let read = chunk.len();
        bytes.consume(read);
    }
}
