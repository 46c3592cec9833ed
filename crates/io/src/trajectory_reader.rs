//! Reading trajectories frame by frame.

use std::fs::File;
use std::io::{BufRead, BufReader, Cursor};
use std::path::Path;

use crate::lines::{Lines, open_regular};
use crate::particles::TrajectoryFrame;
use crate::rewind::Rewind;
use crate::units::FileUnits;
use crate::{FileMark, FormatError, extended_xyz, gro, lammps_dump};

/// What frames of text look like.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Grammar {
    ExtendedXyz,
    LammpsDump,
    Gro,
}

impl Grammar {
    /// What a frame begins with.
    fn beginning(self) -> &'static str {
        match self {
            Self::ExtendedXyz => "the number of particles of the next frame",
            Self::LammpsDump => "`ITEM: TIMESTEP` of the next frame",
            Self::Gro => "the title of the next frame",
        }
    }

    /// Goes to the first line of the next frame; false where the file ends, blank lines at its end aside.
    fn find<R: BufRead>(self, lines: &mut Lines<R>) -> Result<bool, FormatError> {
        let mut blank = None;
        while lines.advance()? {
            match (lines.is_blank(), blank) {
                (true, None) => blank = Some(lines.number()),
                (true, Some(_)) => {}
                (false, None) => return Ok(true),
                (false, Some(line)) => {
                    let allowed = format!("{}, or the end of the file", self.beginning());
                    return Err(lines.refuse_at(line, "a blank line", allowed));
                }
            }
        }
        Ok(false)
    }

    fn skip<R: BufRead>(
        self,
        lines: &mut Lines<R>,
        units: &mut FileUnits,
    ) -> Result<(), FormatError> {
        match self {
            Self::ExtendedXyz => extended_xyz::skip_frame(lines),
            Self::LammpsDump => lammps_dump::skip_frame(lines, units),
            Self::Gro => gro::skip_frame(lines),
        }
    }

    fn parse<R: BufRead>(
        self,
        lines: &mut Lines<R>,
        units: &mut FileUnits,
    ) -> Result<TrajectoryFrame, FormatError> {
        match self {
            Self::ExtendedXyz => extended_xyz::parse_frame(lines, *units),
            Self::LammpsDump => lammps_dump::parse_frame(lines, units),
            Self::Gro => gro::parse_frame(lines, *units),
        }
    }
}

/// Reads the frames of an extended XYZ file one after another, one in memory at a time.
///
/// Columns may stand in any order; `species`, `pos`, `masses`, `forces`, `map_shift`, and velocities and momenta by any usual
/// name are used, others passed over. After an error it ends.
#[derive(Debug)]
pub struct TrajectoryReader<R> {
    lines: Lines<R>,
    grammar: Grammar,
    units: FileUnits,
    ended: bool,
}

impl TrajectoryReader<BufReader<File>> {
    /// Opens a trajectory.
    ///
    /// # Errors
    /// Where the file cannot be opened or is no regular file.
    pub fn open(path: &Path) -> Result<Self, FormatError> {
        let (reader, size) = open_regular(path)?;
        Ok(Self::new(reader, size, path, Grammar::ExtendedXyz, FileUnits::default()))
    }
}

impl<'a> TrajectoryReader<Cursor<&'a [u8]>> {
    /// Reads from memory; `path` is for messages.
    #[must_use]
    pub fn over(bytes: &'a [u8], path: &Path) -> Self {
        let size = bytes.len() as u64;
        Self::new(Cursor::new(bytes), size, path, Grammar::ExtendedXyz, FileUnits::default())
    }
}

impl<R: BufRead> TrajectoryReader<R> {
    pub(crate) fn new(
        reader: R,
        size: u64,
        path: &Path,
        grammar: Grammar,
        units: FileUnits,
    ) -> Self {
        Self { lines: Lines::new(reader, size, path), grammar, units, ended: false }
    }

    fn at_frame<T>(
        &mut self,
        work: impl FnOnce(&mut Lines<R>, &mut FileUnits) -> Result<T, FormatError>,
    ) -> Result<Option<T>, FormatError> {
        if self.ended {
            return Ok(None);
        }
        let result = match self.grammar.find(&mut self.lines) {
            Ok(true) => work(&mut self.lines, &mut self.units).map(Some),
            Ok(false) => Ok(None),
            Err(error) => Err(error),
        };
        self.ended = !matches!(result, Ok(Some(_)));
        result
    }

    /// The next frame; `None` at the end of the file.
    ///
    /// # Errors
    /// Where the frame is truncated or holds what its header does not allow.
    pub fn next_frame(&mut self) -> Result<Option<TrajectoryFrame>, FormatError> {
        let grammar = self.grammar;
        self.at_frame(|lines, units| grammar.parse(lines, units))
    }

    /// Passes over the next frame, looking at its count and its lines but not into them; false at the end.
    ///
    /// # Errors
    /// Where the frame is truncated or its count is impossible.
    pub fn skip_frame(&mut self) -> Result<bool, FormatError> {
        let grammar = self.grammar;
        Ok(self.at_frame(|lines, units| grammar.skip(lines, units))?.is_some())
    }
}

impl<R: BufRead> Iterator for TrajectoryReader<R> {
    type Item = Result<TrajectoryFrame, FormatError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.next_frame().transpose()
    }
}

/// The last frame and the line that it starts at, without looking into those before; `None` where
/// there is no frame. `size` is the most bytes that the text can have.
pub(crate) fn last_frame<R: Rewind>(
    mut reader: R,
    size: u64,
    path: &Path,
    grammar: Grammar,
    units: FileUnits,
) -> Result<Option<(TrajectoryFrame, u64, u64)>, FormatError> {
    let mut start = None;
    let mut frames = 0;
    let mut scan = TrajectoryReader::new(&mut reader, size, path, grammar, units);
    loop {
        let before = (scan.lines.offset(), scan.lines.number());
        if !scan.skip_frame()? {
            break;
        }
        start = Some(before);
        frames += 1;
    }
    // A dump states its units before the first frame alone.
    let (length, units) = (scan.lines.offset(), scan.units);
    let Some((offset, line)) = start else {
        return Ok(None);
    };
    reader.go_to(offset).map_err(|e| FormatError::io(path, e))?;
    let mut last = TrajectoryReader::new(reader, length, path, grammar, units);
    last.lines.start_at(offset, line);
    Ok(last.next_frame()?.map(|frame| (frame, line + 1, frames)))
}

/// Every frame of a trajectory. For files larger than memory use [`TrajectoryReader`].
///
/// # Errors
/// Where the file cannot be read or any of its frames is at fault.
pub fn read_trajectory(path: &Path) -> Result<Vec<TrajectoryFrame>, FormatError> {
    TrajectoryReader::open(path)?.collect()
}

/// Every frame of a trajectory in memory.
///
/// # Errors
/// Where any of the frames is at fault.
pub fn read_trajectory_bytes(bytes: &[u8]) -> Result<Vec<TrajectoryFrame>, FormatError> {
    TrajectoryReader::over(bytes, Path::new("trajectory in memory")).collect()
}

/// How much of a trajectory is whole: the frames before the first one that is truncated.
///
/// # Errors
/// Where the file cannot be opened or read.
pub fn whole_frames(path: &Path) -> Result<FileMark, FormatError> {
    let mut reader = TrajectoryReader::open(path)?;
    let mut mark = FileMark::default();
    loop {
        match reader.skip_frame() {
            Ok(true) if reader.lines.ended_with_line_end() => {
                mark.bytes = reader.lines.offset();
                mark.records += 1;
            }
            Ok(_) | Err(FormatError::Content { .. }) => return Ok(mark),
            Err(error) => return Err(error),
        }
    }
}
