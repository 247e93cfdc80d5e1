//! Checksum of a file of rows. It finds edits; it does not protect against forgery.

use std::io::{self, Read};

/// Number of bytes that are read at once. A multiple of eight.
const CHUNK: usize = 1 << 16;
/// Offset basis and prime of FNV-1a with 64 bits (G. Fowler, L. C. Noll, P. Vo). Here a step takes eight bytes instead of one,
/// because a part of a sweep has tens of megabytes.
const BASIS: u64 = 0xcbf2_9ce4_8422_2325;
const PRIME: u64 = 0x0000_0100_0000_01b3;

/// Checksum of all bytes of a reader, in hexadecimal digits.
pub fn checksum(mut bytes: impl Read) -> io::Result<String> {
    let mut chunk = vec![0; CHUNK];
    let (mut sum, mut length) = (BASIS, 0_u64);
    loop {
        let mut filled = 0;
        while filled < CHUNK {
            match bytes.read(&mut chunk[filled..]) {
                Ok(0) => break,
                Ok(read) => filled += read,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        // The last word ends in zeros. The length tells them from zeros in the file.
        chunk[filled..].fill(0);
        for word in chunk[..filled.next_multiple_of(8)].as_chunks().0 {
            sum = step(sum, u64::from_le_bytes(*word));
        }
        length += filled as u64;
        if filled < CHUNK {
            return Ok(format!("{:016x}", step(sum, length)));
        }
    }
}

/// One step of the checksum. The rotation carries changes of the upper bits down, which a product alone does not. All operations
/// have an inverse, so two files that differ in one word have different checksums.
fn step(sum: u64, word: u64) -> u64 {
    (sum ^ word).wrapping_mul(PRIME).rotate_left(29)
}

#[cfg(test)]
mod tests {
    use super::checksum;

    /// Every change of one byte changes the sum, and so does another length.
    #[test]
    fn edits_change_the_checksum() {
        let text: Vec<u8> = (0..70_001_u32).map(|i| b'0' + (i % 10) as u8).collect();
        let of = |bytes: &[u8]| checksum(bytes).unwrap();
        let whole = of(&text);
        assert_eq!(of(&text), whole);
        for place in [0, 7, 8, 65_535, 65_536, 70_000] {
            let mut edited = text.clone();
            edited[place] ^= 1;
            assert_ne!(of(&edited), whole, "{place}");
        }
        assert_ne!(of(&text[..70_000]), whole);
        let longer = [&text[..], &[0]].concat();
        assert_ne!(of(&longer), whole);
        assert_eq!(of(b"").len(), 16);
    }
}
