//! Reading lines of files that may be hostile, and the pieces of a line.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use crate::FormatError;
use crate::error::{Refusal, excerpt};

/// Longest line that is read, in bytes: a file without line ends must not fill the memory.
const LONGEST_LINE: u64 = 1 << 20;

/// Bytes read at a time.
const READ_BUFFER: usize = 1 << 18;

/// Opens a regular file and tells its size in bytes. Devices and pipes have no size to check counts
/// against, and may never end: they are refused.
pub(crate) fn open_regular(path: &Path) -> Result<(BufReader<File>, u64), FormatError> {
    let fail = |e| FormatError::io(path, e);
    // Asked before opening: opening a pipe would wait for its other end.
    let is_file = std::fs::metadata(path).map_err(fail)?.is_file();
    if !is_file {
        let cause = io::Error::new(io::ErrorKind::InvalidInput, "it is not a regular file");
        return Err(fail(cause));
    }
    let file = File::open(path).map_err(fail)?;
    let size = file.metadata().map_err(fail)?.len();
    Ok((BufReader::with_capacity(READ_BUFFER, file), size))
}

/// The bytes of a regular file.
pub(crate) fn read_regular(path: &Path) -> Result<Vec<u8>, FormatError> {
    let (mut reader, size) = open_regular(path)?;
    let mut bytes = Vec::with_capacity(size as usize);
    reader.read_to_end(&mut bytes).map_err(|e| FormatError::io(path, e))?;
    Ok(bytes)
}

/// What is read: a file, its inflated text, or memory.
pub(crate) type Input<'a> = Box<dyn BufRead + Send + 'a>;

/// Lines with their numbers, one in memory at a time.
pub(crate) struct Lines<'a> {
    reader: Input<'a>,
    file: PathBuf,
    size: u64,
    offset: u64,
    number: u64,
    current: Vec<u8>,
}

impl<'a> Lines<'a> {
    /// Lines of `reader`, which holds `size` bytes; `file` is for messages.
    pub(crate) fn new(reader: Input<'a>, size: u64, file: &Path) -> Self {
        let file = file.to_path_buf();
        Self { reader, file, size, offset: 0, number: 0, current: Vec::new() }
    }

    /// Goes to the next line; false at the end of the file.
    pub(crate) fn advance(&mut self) -> Result<bool, FormatError> {
        self.current.clear();
        let read = (&mut self.reader)
            .take(LONGEST_LINE)
            .read_until(b'\n', &mut self.current)
            .map_err(|e| FormatError::io(&self.file, e))? as u64;
        if read == 0 {
            return Ok(false);
        }
        self.offset += read;
        self.number += 1;
        if self.current.pop_if(|byte| *byte == b'\n').is_some() {
            self.current.pop_if(|byte| *byte == b'\r');
        } else if read == LONGEST_LINE {
            return Err(
                self.refuse(format!("a line of more than {LONGEST_LINE} bytes"), "shorter lines")
            );
        }
        Ok(true)
    }

    /// Goes to the next line, which must be there and hold what is `wanted`.
    pub(crate) fn next_or(&mut self, wanted: &str) -> Result<(), FormatError> {
        match self.advance()? {
            true => Ok(()),
            false => Err(self.refuse_end(wanted)),
        }
    }

    /// The current line without its end.
    pub(crate) fn line(&self) -> &[u8] {
        &self.current
    }

    /// Whether the current line holds nothing but white space.
    pub(crate) fn is_blank(&self) -> bool {
        self.current.iter().all(u8::is_ascii_whitespace)
    }

    /// Number of the current line, counted from 1.
    pub(crate) fn number(&self) -> u64 {
        self.number
    }

    /// Bytes left in the file.
    pub(crate) fn left(&self) -> u64 {
        self.size.saturating_sub(self.offset)
    }

    /// An error at the current line.
    pub(crate) fn refuse(
        &self,
        found: impl Into<String>,
        allowed: impl Into<String>,
    ) -> FormatError {
        self.refuse_at(self.number.max(1), found, allowed)
    }

    /// An error at another line.
    pub(crate) fn refuse_at(
        &self,
        line: u64,
        found: impl Into<String>,
        allowed: impl Into<String>,
    ) -> FormatError {
        FormatError::Content {
            file: self.file.clone(),
            line,
            found: found.into(),
            allowed: allowed.into(),
        }
    }

    /// An error for the end of the file where a line should be.
    pub(crate) fn refuse_end(&self, allowed: impl Into<String>) -> FormatError {
        self.refuse_at(self.number + 1, "the end of the file", allowed)
    }

    /// The current line as a count of particles whose lines, `least_bytes_each` at least, and `more_lines`
    /// besides must still fit into the file.
    pub(crate) fn particle_count(
        &self,
        more_lines: u64,
        least_bytes_each: u64,
    ) -> Result<usize, FormatError> {
        self.count(one_token(&self.current).unwrap_or(&self.current), more_lines, least_bytes_each)
    }

    /// The same of a word of the current line.
    pub(crate) fn count(
        &self,
        word: &[u8],
        more_lines: u64,
        least_bytes_each: u64,
    ) -> Result<usize, FormatError> {
        let allowed = "the number of particles, an integer of at least 1";
        if word.is_empty() || !word.iter().all(u8::is_ascii_digit) {
            return Err(self.refuse(excerpt(word), allowed));
        }
        match std::str::from_utf8(word).ok().and_then(|digits| digits.parse().ok()) {
            Some(0) => Err(self.refuse("0 particles", allowed)),
            Some(n) if self.check_room(n, more_lines, least_bytes_each) => Ok(n),
            _ => Err(self.refuse(
                format!("{} particles", excerpt(word)),
                format!(
                    "at most what the {} bytes left in the file can hold, {least_bytes_each} bytes per particle",
                    self.left()
                ),
            )),
        }
    }

    /// Whether `n` lines of `least_bytes_each` bytes and `more_lines` besides fit into the rest of the file;
    /// the last line may lack its end.
    pub(crate) fn check_room(&self, n: usize, more_lines: u64, least_bytes_each: u64) -> bool {
        let bytes = (n as u64).checked_mul(least_bytes_each);
        let bytes = bytes.and_then(|bytes| bytes.checked_add(more_lines));
        bytes.is_some_and(|bytes| bytes - 1 <= self.left())
    }
}

/// What a refusal becomes: an error at the current line.
pub(crate) trait At<T> {
    /// The value, or the refusal with the file and the line.
    fn at(self, lines: &Lines<'_>) -> Result<T, FormatError>;
}

impl<T> At<T> for Result<T, Refusal> {
    fn at(self, lines: &Lines<'_>) -> Result<T, FormatError> {
        self.map_err(|(found, allowed)| lines.refuse(found, allowed))
    }
}

/// The pieces of a line between white space.
pub(crate) fn tokens(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|t| !t.is_empty())
}

/// The only piece of a line, if it has exactly one.
pub(crate) fn one_token(line: &[u8]) -> Option<&[u8]> {
    let mut all = tokens(line);
    all.next().filter(|_| all.next().is_none())
}

/// A finite number.
pub(crate) fn finite(token: &[u8]) -> Option<f64> {
    let value: f64 = std::str::from_utf8(token).ok()?.parse().ok()?;
    value.is_finite().then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_kinds_of_line_ends_and_a_missing_last_one_are_read() {
        let text = b"a\r\nb\n\nc";
        let mut lines = Lines::new(Box::new(&text[..]), text.len() as u64, Path::new("f"));
        let mut all = Vec::new();
        while lines.advance().unwrap() {
            all.push(lines.line().to_vec());
        }
        assert_eq!(all, [b"a".to_vec(), b"b".to_vec(), vec![], b"c".to_vec()]);
        assert_eq!((lines.number(), lines.left()), (4, 0));
    }

    #[test]
    fn a_file_without_line_ends_is_refused_before_it_fills_the_memory() {
        let endless = io::repeat(b'x');
        let mut lines = Lines::new(Box::new(BufReader::new(endless)), u64::MAX, Path::new("f"));
        assert!(lines.advance().unwrap_err().to_string().contains("more than"));
    }

    #[cfg(unix)]
    #[test]
    fn what_is_no_regular_file_is_refused() {
        for path in ["/dev/zero", "/"] {
            let error = open_regular(Path::new(path)).unwrap_err();
            assert!(error.to_string().contains("not a regular file"), "{error}");
        }
    }

    #[test]
    fn words_and_overflows_are_no_finite_numbers() {
        for bad in ["nan", "inf", "-infinity", "1e999", "1,5", "", "1.0D0", "0x10", "\u{661}"] {
            assert_eq!(finite(bad.as_bytes()), None, "{bad}");
        }
        assert_eq!(finite(b"-1.5e-3"), Some(-1.5e-3));
        assert_eq!(finite(&[0xff]), None);
    }
}
