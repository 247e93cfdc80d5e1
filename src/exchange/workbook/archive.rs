//! Reads the ZIP archive of a workbook (PKWARE, .ZIP File Format Specification 6.3, sections 4.3 to 4.5). It supports the
//! features that spreadsheet programs use. It never unpacks more than a limit, even if the archive states other sizes.

use flate2::Crc;
use flate2::read::DeflateDecoder;
use std::io::{self, BufReader, Read};

/// A file in the archive.
struct Member {
    name: String,
    stored: Stored,
    packed: usize,
    crc: u32,
    offset: usize,
}

/// Compression method of a member.
#[derive(Clone, Copy)]
enum Stored {
    Plain,
    Deflated,
    /// The member is encrypted, or compressed by another method.
    Otherwise,
}

/// An archive in memory.
pub(super) struct Archive {
    bytes: Vec<u8>,
    members: Vec<Member>,
}

/// Largest unpacked size of a member, in bytes.
const MOST_UNPACKED: u64 = 32 << 20;

const DAMAGED: &str = "the workbook is damaged";

/// Unsigned integer of `width` bytes at position `at`, lowest byte first. `None` beyond the end.
fn number(bytes: &[u8], at: usize, width: usize) -> Option<usize> {
    let field = bytes.get(at..at.checked_add(width)?)?;
    let digits = field.iter().rev();
    Some(digits.fold(0, |sum, byte| sum << 8 | usize::from(*byte)))
}

impl Archive {
    /// Opens an archive and reads the list of its members (files in the archive).
    pub(super) fn open(bytes: Vec<u8>) -> Result<Self, String> {
        let members = members(&bytes).ok_or(DAMAGED)?;
        Ok(Archive { bytes, members })
    }

    /// Names of the members (files) of the archive.
    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.members.iter().map(|member| member.name.as_str())
    }

    /// Reader that unpacks a member while it is read. `None` if there is no such member.
    pub(super) fn member(&self, name: &str) -> Option<Result<impl io::BufRead + '_, String>> {
        let found = self.members.iter().find(|member| member.name == name)?;
        Some(self.unpacked(found))
    }

    fn unpacked(&self, member: &Member) -> Result<impl io::BufRead + '_, String> {
        let data = self.data(member).ok_or(DAMAGED)?;
        let unpacked: Box<dyn Read + '_> = match member.stored {
            Stored::Plain => Box::new(data),
            Stored::Deflated => Box::new(DeflateDecoder::new(data)),
            Stored::Otherwise => {
                return Err("the workbook is encrypted or packed in an unusual way".to_owned());
            }
        };
        Ok(BufReader::new(Checked {
            unpacked,
            crc: Crc::new(),
            expected: member.crc,
            left: MOST_UNPACKED,
        }))
    }

    /// Packed bytes of a member, after its local header.
    fn data(&self, member: &Member) -> Option<&[u8]> {
        let header = member.offset;
        if number(&self.bytes, header, 4)? != 0x0403_4b50 {
            return None;
        }
        let name = number(&self.bytes, header + 26, 2)?;
        let extra = number(&self.bytes, header + 28, 2)?;
        let start = header + 30 + name + extra;
        self.bytes.get(start..start.checked_add(member.packed)?)
    }
}

/// Members that the central directory at the end of the archive lists. The last record of the archive gives the position of this
/// directory.
fn members(bytes: &[u8]) -> Option<Vec<Member>> {
    const END: usize = 22;
    let last = bytes.len().checked_sub(END)?;
    let first = last.saturating_sub(usize::from(u16::MAX));
    let end = (first..=last)
        .rev()
        .find(|at| number(bytes, *at, 4) == Some(0x0605_4b50))?;
    let count = number(bytes, end + 10, 2)?;
    let mut at = number(bytes, end + 16, 4)?;
    let mut members = Vec::new();
    for _ in 0..count {
        if number(bytes, at, 4)? != 0x0201_4b50 {
            return None;
        }
        let flags = number(bytes, at + 8, 2)?;
        let stored = match number(bytes, at + 10, 2)? {
            _ if flags & 1 != 0 => Stored::Otherwise,
            0 => Stored::Plain,
            8 => Stored::Deflated,
            _ => Stored::Otherwise,
        };
        let lengths = [28, 30, 32].map(|field| number(bytes, at + field, 2));
        let [name, extra, comment] = [lengths[0]?, lengths[1]?, lengths[2]?];
        let text = bytes.get(at + 46..at + 46 + name)?;
        members.push(Member {
            name: String::from_utf8_lossy(text).into_owned(),
            stored,
            packed: number(bytes, at + 20, 4)?,
            crc: u32::try_from(number(bytes, at + 16, 4)?).ok()?,
            offset: number(bytes, at + 42, 4)?,
        });
        at += 46 + name + extra + comment;
    }
    Some(members)
}

/// Reader that counts unpacked bytes, and compares them with their checksum at the end.
struct Checked<'a> {
    unpacked: Box<dyn Read + 'a>,
    crc: Crc,
    expected: u32,
    left: u64,
}

impl Read for Checked<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.unpacked.read(buffer)?;
        if count == 0 && !buffer.is_empty() && self.crc.sum() != self.expected {
            return Err(io::Error::other(DAMAGED));
        }
        self.crc.update(&buffer[..count]);
        self.left = self.left.checked_sub(count as u64).ok_or_else(|| {
            let most = MOST_UNPACKED >> 20;
            io::Error::other(format!(
                "a part of the workbook unpacks to more than {most} MB"
            ))
        })?;
        Ok(count)
    }
}
