//! The frames of a trajectory of any program, one in memory at a time.

use std::fs::File;
use std::io::Seek;
use std::path::{Path, PathBuf};

use crate::configuration::{Kind, text_of};
use crate::formats::XtcReader;
use crate::lines::{Input, open_regular};
use crate::text_frames::TextFrames;
use crate::{FileUnits, FormatError, FoundSpecies, TrajectoryFrame};

/// Reads XTC, extended XYZ, LAMMPS dumps and GRO, of which text may be compressed by gzip. The content tells them apart.
///
/// Columns of text may stand in any order; `species`, `pos`, `masses`, `forces`, `map_shift`, and velocities and momenta by any usual
/// name are used, others passed over. Every frame has a box, and as many particles of the same species as the first. After an
/// error it ends.
pub struct Frames<'a> {
    file: PathBuf,
    source: Source<'a>,
    /// The handle that `source` reads from tells how far reading is.
    handle: Option<File>,
    size: u64,
    number: u64,
    first: Option<(usize, FoundSpecies)>,
}

enum Source<'a> {
    Text(Box<TextFrames<'a>>),
    Xtc(XtcReader<'a>),
}

impl Frames<'static> {
    /// Opens a trajectory whose lengths and times are in these units.
    ///
    /// # Errors
    /// [`FormatError`] where the file cannot be opened, or is of a format that is not read or has no frames.
    pub fn open(file: &Path, units: FileUnits) -> Result<Self, FormatError> {
        let (reader, size) = open_regular(file)?;
        let handle = reader.get_ref().try_clone().map_err(|e| FormatError::io(file, e))?;
        Ok(Self { handle: Some(handle), ..Self::of(Box::new(reader), size, file, units)? })
    }
}

impl<'a> Frames<'a> {
    /// The same from memory.
    ///
    /// # Errors
    /// [`FormatError`] where the bytes are of a format that is not read or has no frames.
    pub fn of_bytes(bytes: &'a [u8], units: FileUnits) -> Result<Self, FormatError> {
        Self::of(Box::new(bytes), bytes.len() as u64, Path::new("trajectory in memory"), units)
    }

    fn of(
        mut reader: Input<'a>,
        size: u64,
        file: &Path,
        units: FileUnits,
    ) -> Result<Self, FormatError> {
        let head = reader.fill_buf().map_err(|e| FormatError::io(file, e))?;
        let source = match XtcReader::is_xtc(head) {
            true => Source::Xtc(XtcReader::new(reader, size, file, units)?),
            false => {
                let (kind, lines) = text_of(reader, size, file)?;
                let single = |found| {
                    let allowed = "a trajectory: XTC, LAMMPS dump, extended XYZ or GRO";
                    Err(FormatError::content(file, 1, found, allowed))
                };
                match kind {
                    Kind::Frames(grammar) => {
                        Source::Text(Box::new(TextFrames::new(lines, grammar, units)))
                    }
                    Kind::LammpsData => return single("a LAMMPS data file, one configuration"),
                    Kind::Nist => return single("NIST columns, one configuration"),
                }
            }
        };
        Ok(Self { file: file.to_owned(), source, handle: None, size, number: 0, first: None })
    }

    /// The part of the file that was read, from 0 to 1.
    pub fn part_read(&mut self) -> f64 {
        let at = self.handle.as_mut().and_then(|handle| handle.stream_position().ok());
        at.map_or(1.0, |at| at as f64 / self.size.max(1) as f64)
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
