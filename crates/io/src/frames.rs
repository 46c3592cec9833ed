//! The frames of a trajectory of any program, one in memory at a time.

use std::fs::File;
use std::io::{BufRead, Seek};
use std::path::{Path, PathBuf};

use crate::configuration::{Kind, kind_of};
use crate::formats::XtcReader;
use crate::lines::open_regular;
use crate::rewind::{GZIP, Gunzip, MOST_INFLATED, Rewind};
use crate::{FileUnits, FormatError, FoundSpecies, TrajectoryFrame, TrajectoryReader};

/// Reads XTC, extended XYZ, LAMMPS dumps and GRO, of which text may be compressed by gzip. The content tells them apart.
///
/// Every frame has a box, and as many particles of the same species as the first. After an error it ends.
pub struct Frames {
    file: PathBuf,
    source: Source,
    /// The handle that `source` reads from tells how far reading is.
    handle: File,
    size: u64,
    number: u64,
    first: Option<(usize, FoundSpecies)>,
}

enum Source {
    Text(Box<TrajectoryReader<Box<dyn BufRead + Send>>>),
    Xtc(XtcReader),
}

impl Frames {
    /// Opens a trajectory whose lengths and times are in these units.
    ///
    /// # Errors
    /// [`FormatError`] where the file cannot be opened, or is of a format that is not read or has no frames.
    pub fn open(file: &Path, units: FileUnits) -> Result<Self, FormatError> {
        let fail = |e| FormatError::io(file, e);
        let (mut reader, size) = open_regular(file)?;
        let handle = reader.get_ref().try_clone().map_err(fail)?;
        let head = reader.fill_buf().map_err(fail)?;
        let source = if head.starts_with(GZIP) {
            text(Gunzip::new(reader), size.saturating_mul(MOST_INFLATED), file, units)?
        } else if XtcReader::is_xtc(head) {
            Source::Xtc(XtcReader::new(reader, size, file, units)?)
        } else {
            text(reader, size, file, units)?
        };
        Ok(Self { file: file.to_owned(), source, handle, size, number: 0, first: None })
    }

    /// The number of the last frame that was read, from 1.
    #[must_use]
    pub fn number(&self) -> u64 {
        self.number
    }

    /// The part of the file that was read, from 0 to 1.
    #[must_use]
    pub fn part_read(&mut self) -> f64 {
        let at = self.handle.stream_position().unwrap_or(0);
        at as f64 / self.size.max(1) as f64
    }

    /// The refusal of the last frame that was read.
    #[must_use]
    pub fn refuse(&self, found: impl Into<String>, allowed: impl Into<String>) -> FormatError {
        FormatError::Frame {
            file: self.file.clone(),
            frame: self.number,
            found: found.into(),
            allowed: allowed.into(),
        }
    }

    /// The next frame; `None` at the end of the file.
    ///
    /// # Errors
    /// [`FormatError`] where the frame is truncated, has no box or other particles, or holds what its format does not allow.
    pub fn next_frame(&mut self) -> Result<Option<TrajectoryFrame>, FormatError> {
        let read = match &mut self.source {
            Source::Text(reader) => reader.next_frame()?,
            Source::Xtc(reader) => reader.next_frame()?,
        };
        let Some(frame) = read else {
            return Ok(None);
        };
        self.number += 1;
        if frame.cell.is_none() {
            let allowed = "a periodic box, which each frame says (extended XYZ: Lattice=\"Lx 0 0 0 Ly 0 0 0 Lz\")";
            return Err(self.refuse("no box", allowed));
        }
        let Some((n, species)) = &self.first else {
            self.first = Some((frame.positions.len(), frame.species.clone()));
            return Ok(Some(frame));
        };
        if frame.positions.len() != *n {
            let found = format!("{} particles", frame.positions.len());
            return Err(self.refuse(found, format!("{n}, as in frame 1")));
        }
        if frame.species != *species {
            return Err(self.refuse("other species or another order of them", "those of frame 1"));
        }
        Ok(Some(frame))
    }
}

/// A text that has frames.
fn text<R: Rewind + Send + 'static>(
    mut reader: R,
    size: u64,
    file: &Path,
    units: FileUnits,
) -> Result<Source, FormatError> {
    let single = |found| {
        FormatError::content(file, 1, found, "a trajectory: XTC, LAMMPS dump, extended XYZ or GRO")
    };
    match kind_of(&mut reader, size, file)? {
        Kind::Frames(grammar) => {
            let reader: Box<dyn BufRead + Send> = Box::new(reader);
            Ok(Source::Text(Box::new(TrajectoryReader::new(reader, size, file, grammar, units))))
        }
        Kind::LammpsData => Err(single("a LAMMPS data file, one configuration")),
        Kind::Nist => Err(single("NIST columns, one configuration")),
    }
}
