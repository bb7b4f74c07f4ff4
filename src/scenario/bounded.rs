//! Reading of files and streams that may have no end: memory ends before `/dev/zero` does.

use std::io::{self, Read};

/// Largest size of a scenario (bytes): 100,000 springs with a path each take less.
pub const MOST_BYTES: u64 = 64 << 20;
/// Largest size of a table or another file that is read as a whole (bytes): a day of one tip at 100
/// frames a second takes half of it.
pub const MOST_BYTES_OF_TABLE: u64 = 1 << 30;

/// The whole text of `source`, which may have `most` bytes.
///
/// # Errors
/// When the text is longer, when it is not UTF-8, or when it cannot be read.
pub fn read_text(source: impl Read, most: u64) -> io::Result<String> {
    let mut text = String::new();
    let mut bounded = source.take(most + 1);
    let read = bounded.read_to_string(&mut text);
    if bounded.limit() == 0 {
        let rule = format!("must have at most {} MiB, found more", most >> 20);
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, rule));
    }
    read.map(|_| text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_read_up_to_the_bound_and_no_further() {
        let of = |n: u64| io::repeat(b'x').take(n);
        assert_eq!(read_text(of(1 << 20), 1 << 20).unwrap().len(), 1 << 20);
        for endless in [Box::new(of((1 << 20) + 1)) as Box<dyn Read>, Box::new(io::repeat(0)), Box::new(io::repeat(0xff))] {
            assert_eq!(read_text(endless, 1 << 20).unwrap_err().to_string(), "must have at most 1 MiB, found more");
        }
        assert_eq!(read_text(&[0xff_u8][..], 10).unwrap_err().kind(), io::ErrorKind::InvalidData);
    }
}
