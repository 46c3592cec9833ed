//! XTC read back. Libraries that read it stop the program at a damaged file; this reader refuses it by its frame.

use std::io::Read;
use std::path::{Path, PathBuf};

use glam::DVec3;

use super::{LONG_MAGIC, MAGIC, MOST_UNCOMPRESSED, compression};
use crate::geometry::upright;
use crate::lines::Input;
use crate::units::{FileUnits, Scales};
use crate::{FormatError, TrajectoryFrame};

/// Words of a frame before its positions: magic number, particles, step, time, box, particles.
const HEADER: u64 = 14;

/// Reads the frames of an XTC file one after another.
pub(crate) struct XtcReader<'a> {
    reader: Input<'a>,
    left: u64,
    file: PathBuf,
    /// Number of the frame under way, from 1.
    number: u64,
    scales: Scales,
}

fn number(word: u32) -> f64 {
    f64::from(f32::from_bits(word))
}

fn vector(words: &[u32]) -> DVec3 {
    DVec3::new(number(words[0]), number(words[1]), number(words[2]))
}

impl<'a> XtcReader<'a> {
    /// Whether a file that begins so is XTC.
    pub(crate) fn is_xtc(head: &[u8]) -> bool {
        [MAGIC, LONG_MAGIC].iter().any(|magic| head.starts_with(&magic.to_be_bytes()))
    }

    /// Reads `reader`, which holds `size` bytes; the file states no units, and these are taken out.
    pub(crate) fn new(
        reader: Input<'a>,
        size: u64,
        file: &Path,
        mut units: FileUnits,
    ) -> Result<Self, FormatError> {
        units.length = units.length.or(units.xtc);
        let scales = units.scales(None);
        let scales = scales.map_err(|(f, a)| FormatError::content(file, 1, &f, &a))?;
        Ok(Self { reader, left: size, file: file.to_owned(), number: 0, scales })
    }

    fn refuse(&self, found: impl Into<String>, allowed: impl Into<String>) -> FormatError {
        let (file, frame) = (self.file.clone(), self.number);
        FormatError::Frame { file, frame, found: found.into(), allowed: allowed.into() }
    }

    /// The next bytes of the file.
    fn take(&mut self, bytes: u64) -> Result<Vec<u8>, FormatError> {
        if bytes > self.left {
            let found = format!("the end of the file after {} bytes more", self.left);
            return Err(self.refuse(found, format!("{bytes} bytes: the frame is truncated")));
        }
        self.left -= bytes;
        let mut all = vec![0; bytes as usize];
        self.reader.read_exact(&mut all).map_err(|e| FormatError::io(&self.file, e))?;
        Ok(all)
    }

    /// The next words of the file, whose first byte is the highest.
    fn words(&mut self, words: u64) -> Result<Vec<u32>, FormatError> {
        let bytes = self.take(4 * words)?;
        Ok(bytes.as_chunks().0.iter().map(|word| u32::from_be_bytes(*word)).collect())
    }

    /// The next frame; `None` at the end of the file.
    pub(crate) fn next_frame(&mut self) -> Result<Option<TrajectoryFrame>, FormatError> {
        if self.left == 0 {
            return Ok(None);
        }
        self.number += 1;
        let header = self.words(HEADER)?;
        let (magic, n, step, time) = (header[0], header[1] as usize, header[2], number(header[3]));
        let edges = [4, 7, 10].map(|at| vector(&header[at..]) / self.scales.length);
        if ![MAGIC, LONG_MAGIC].contains(&magic) || header[13] as usize != n || n == 0 {
            let allowed = "the magic number and twice the number of particles";
            return Err(self.refuse("bytes that begin no frame", allowed));
        }
        let cell = match edges == [DVec3::ZERO; 3] {
            true => None,
            false => Some(upright(edges, || format!("box edges {edges:?}"))),
        };
        let cell = cell.transpose().map_err(|(found, allowed)| self.refuse(found, allowed))?;
        let (positions, rounding) = match n <= MOST_UNCOMPRESSED {
            true => self.plain(n)?,
            false => self.compressed(n, magic == LONG_MAGIC)?,
        };
        if !positions.iter().all(|r| r.is_finite()) {
            return Err(self.refuse("a position that is not finite", "finite numbers"));
        }
        Ok(Some(TrajectoryFrame {
            step: Some(step.into()),
            time: self.scales.time(time),
            rounding,
            cell,
            positions,
            ..TrajectoryFrame::default()
        }))
    }

    /// Positions in single precision, and how they are rounded, σ.
    fn plain(&mut self, n: usize) -> Result<(Vec<DVec3>, f64), FormatError> {
        let words = self.words(3 * n as u64)?;
        let all: Vec<DVec3> = words.chunks(3).map(|r| vector(r) / self.scales.length).collect();
        let largest = all.iter().fold(0.0_f64, |most, r| most.max(r.abs().max_element()));
        Ok((all, largest * f64::from(f32::EPSILON)))
    }

    /// Positions as multiples of the precision, and how they are rounded, σ.
    fn compressed(&mut self, n: usize, long: bool) -> Result<(Vec<DVec3>, f64), FormatError> {
        let head = self.words(if long { 10 } else { 9 })?;
        let precision = number(head[0]);
        if !(precision.is_finite() && precision > 0.0) {
            return Err(self.refuse(format!("the precision {precision}"), "a number above 0"));
        }
        let bounds = [1, 4].map(|at| [0, 1, 2].map(|k| head[at + k].cast_signed()));
        let near = head[7] as usize;
        let length = head[8..].iter().fold(0, |high, word| high << 32 | u64::from(*word));
        let bits = self.take(length.div_ceil(4).saturating_mul(4))?;
        let unit = 1.0 / (precision * self.scales.length);
        let mut all = Vec::with_capacity(n.min(8 * bits.len()));
        let put = |p: compression::Multiples| all.push(DVec3::from_array(p.map(f64::from)) * unit);
        match compression::read(&bits, n, bounds, near, put) {
            Ok(()) => Ok((all, unit)),
            Err(found) => Err(self.refuse(found, format!("the positions of {n} particles"))),
        }
    }
}
