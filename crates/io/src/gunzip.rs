//! Text compressed by gzip.

use std::io::{self, BufRead, BufReader, Read};

use flate2::bufread::MultiGzDecoder;

/// The first bytes of a gzip file.
pub(crate) const GZIP: &[u8] = &[0x1f, 0x8b];

/// The most bytes of text that a byte of gzip can stand for.
pub(crate) const MOST_INFLATED: u64 = 1032;

/// The text of a gzip file of one member or more, with errors that say what is wrong.
struct Members<R>(MultiGzDecoder<R>);

/// The text of what `reader` holds; `reader` is at its start.
pub(crate) fn inflated<R: BufRead>(reader: R) -> impl BufRead {
    BufReader::new(Members(MultiGzDecoder::new(reader)))
}

impl<R: BufRead> Read for Members<R> {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        self.0.read(to).map_err(|e| match e.kind() {
            io::ErrorKind::UnexpectedEof => io::Error::new(
                e.kind(),
                "its gzip data end in the middle: the file is truncated; allowed: the whole file",
            ),
            io::ErrorKind::InvalidData | io::ErrorKind::InvalidInput => {
                io::Error::new(e.kind(), format!("its gzip data are damaged ({e})"))
            }
            _ => e,
        })
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use flate2::{Compression, write::GzEncoder};

    use super::*;

    fn member(text: &[u8]) -> Vec<u8> {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
        encoder.write_all(text).unwrap();
        encoder.finish().unwrap()
    }

    #[test]
    fn members_are_one_text() {
        let bytes = [member(b"one\ntwo\n"), member(b"three\n")].concat();
        let mut all = String::new();
        inflated(&*bytes).read_to_string(&mut all).unwrap();
        assert_eq!(all, "one\ntwo\nthree\n");
    }

    #[test]
    fn truncated_and_damaged_members_are_told_apart() {
        let whole = member(b"one\ntwo\nthree\nfour\nfive\n");
        let read =
            |bytes: &[u8]| inflated(bytes).read_to_end(&mut Vec::new()).unwrap_err().to_string();
        assert!(read(&whole[..whole.len() - 3]).contains("truncated"));
        let mut damaged = whole.clone();
        let checksum = whole.len() - 8;
        damaged[checksum] ^= 1;
        assert!(read(&damaged).contains("damaged"));
    }
}
