//! Text that can be read again from any place, compressed or not.

use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom};

use flate2::bufread::MultiGzDecoder;

/// The first bytes of a gzip file.
pub(crate) const GZIP: &[u8] = &[0x1f, 0x8b];

/// The most bytes of text that a byte of gzip can stand for.
pub(crate) const MOST_INFLATED: u64 = 1032;

/// Text that can be read again.
pub(crate) trait Rewind: BufRead {
    /// Goes to `offset` bytes behind the start of the text.
    fn go_to(&mut self, offset: u64) -> io::Result<()>;
}

impl<R: BufRead + Seek> Rewind for R {
    fn go_to(&mut self, offset: u64) -> io::Result<()> {
        self.seek(SeekFrom::Start(offset)).map(|_| ())
    }
}

/// The text of a gzip file of one member or more.
pub(crate) struct Gunzip<R: BufRead> {
    text: Option<BufReader<Members<R>>>,
}

impl<R: BufRead + Seek> Gunzip<R> {
    /// The text of what `reader` holds; `reader` is at its start.
    pub(crate) fn new(reader: R) -> Self {
        let members = Members(MultiGzDecoder::new(reader));
        Self { text: Some(BufReader::new(members)) }
    }

    fn text(&mut self) -> &mut BufReader<Members<R>> {
        self.text.as_mut().expect("it is taken in go_to alone")
    }
}

impl<R: BufRead + Seek> Read for Gunzip<R> {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        self.text().read(to)
    }
}

impl<R: BufRead + Seek> BufRead for Gunzip<R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        self.text().fill_buf()
    }

    fn consume(&mut self, bytes: usize) {
        self.text().consume(bytes);
    }
}

impl<R: BufRead + Seek> Rewind for Gunzip<R> {
    /// Members have no table of contents: the text before `offset` is read again and dropped.
    fn go_to(&mut self, offset: u64) -> io::Result<()> {
        let text = self.text.take().expect("it is taken here alone");
        let mut reader = text.into_inner().0.into_inner();
        let rewound = reader.rewind();
        *self = Self::new(reader);
        rewound?;
        io::copy(&mut self.take(offset), &mut io::sink()).map(|_| ())
    }
}

/// The members of a gzip file, with errors that say what is wrong.
struct Members<R>(MultiGzDecoder<R>);

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
    use std::io::{Cursor, Write};

    use flate2::{Compression, write::GzEncoder};

    use super::*;

    fn member(text: &[u8]) -> Vec<u8> {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
        encoder.write_all(text).unwrap();
        encoder.finish().unwrap()
    }

    #[test]
    fn members_are_one_text_that_can_be_read_again_from_any_place() {
        let bytes = [member(b"one\ntwo\n"), member(b"three\n")].concat();
        let mut text = Gunzip::new(Cursor::new(bytes));
        let mut all = String::new();
        text.read_to_string(&mut all).unwrap();
        assert_eq!(all, "one\ntwo\nthree\n");
        for offset in [4, 0, 9, 14] {
            text.go_to(offset as u64).unwrap();
            let mut rest = String::new();
            text.read_to_string(&mut rest).unwrap();
            assert_eq!(rest, all[offset..]);
        }
    }

    #[test]
    fn truncated_and_damaged_members_are_told_apart() {
        let whole = member(b"one\ntwo\nthree\nfour\nfive\n");
        let read = |bytes: &[u8]| {
            let mut text = Gunzip::new(Cursor::new(bytes));
            text.read_to_end(&mut Vec::new()).unwrap_err().to_string()
        };
        assert!(read(&whole[..whole.len() - 3]).contains("truncated"));
        let mut damaged = whole.clone();
        let checksum = whole.len() - 8;
        damaged[checksum] ^= 1;
        assert!(read(&damaged).contains("damaged"));
    }
}
