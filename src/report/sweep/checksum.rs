//! Checksum of a file of rows or curves. It finds edits; it does not protect against forgery.

use crc32fast::Hasher;
use std::fs::File;
use std::io::{self, Read, Write};

/// Checksum (CRC-32) of all bytes that can be read from `bytes`, in hexadecimal digits.
pub(super) fn checksum(mut bytes: impl Read) -> io::Result<String> {
    let mut sum = Summing {
        to: io::sink(),
        sum: Hasher::new(),
    };
    io::copy(&mut bytes, &mut sum)?;
    Ok(sum.checksum())
}

/// File whose checksum is computed while it is written.
pub(super) type SummedFile = Summing<File>;

/// Writer that passes its bytes on and computes their checksum.
pub(super) struct Summing<W> {
    to: W,
    sum: Hasher,
}

impl Summing<File> {
    /// Starts a checksum of the bytes that the caller will write to a file.
    pub(super) fn new(file: File) -> Self {
        Summing {
            to: file,
            sum: Hasher::new(),
        }
    }
}

impl<W> Summing<W> {
    /// Checksum of all bytes that were passed on, in hexadecimal digits.
    pub(super) fn checksum(self) -> String {
        format!("{:08x}", self.sum.finalize())
    }
}

impl<W: Write> Write for Summing<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.to.write(bytes)?;
        self.sum.update(&bytes[..written]);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.to.flush()
    }
}
