//! Frames of text, one in memory at a time.

use crate::lines::Lines;
use crate::particles::TrajectoryFrame;
use crate::units::FileUnits;
use crate::{FormatError, extended_xyz, gro, lammps_dump};

/// What frames of text look like.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Grammar {
    ExtendedXyz,
    LammpsDump,
    Gro,
}

/// Reads the frames of a text one after another. After an error it ends.
pub(crate) struct TextFrames<'a> {
    lines: Lines<'a>,
    grammar: Grammar,
    /// A dump states its units before the first frame alone.
    units: FileUnits,
    ended: bool,
    /// The first line of the last frame that was read.
    pub(crate) first_line: u64,
}

impl<'a> TextFrames<'a> {
    pub(crate) fn new(lines: Lines<'a>, grammar: Grammar, units: FileUnits) -> Self {
        Self { lines, grammar, units, ended: false, first_line: 0 }
    }

    /// The next frame; `None` at the end of the file.
    pub(crate) fn next_frame(&mut self) -> Result<Option<TrajectoryFrame>, FormatError> {
        if self.ended {
            return Ok(None);
        }
        self.ended = true;
        if !self.find()? {
            return Ok(None);
        }
        let frame = self.frame(true)?;
        self.ended = false;
        Ok(frame)
    }

    /// Passes over the frames up to `most`, or up to the end of the file, by their counts, and tells how many there were.
    pub(crate) fn skip(&mut self, most: u64) -> Result<u64, FormatError> {
        let mut skipped = 0;
        while skipped < most && self.find()? {
            self.frame(false)?;
            skipped += 1;
        }
        Ok(skipped)
    }

    /// The frame whose first line is the current line, where it is wanted.
    fn frame(&mut self, wanted: bool) -> Result<Option<TrajectoryFrame>, FormatError> {
        self.first_line = self.lines.number();
        let (lines, units) = (&mut self.lines, &mut self.units);
        match self.grammar {
            Grammar::ExtendedXyz => extended_xyz::parse_frame(lines, *units, wanted),
            Grammar::LammpsDump => lammps_dump::parse_frame(lines, units, wanted),
            Grammar::Gro => gro::parse_frame(lines, *units, wanted),
        }
    }

    /// Goes to the first line of the next frame; false where the file ends, blank lines at its end aside.
    fn find(&mut self) -> Result<bool, FormatError> {
        let beginning = match self.grammar {
            Grammar::ExtendedXyz => "the number of particles of the next frame",
            Grammar::LammpsDump => "`ITEM: TIMESTEP` of the next frame",
            Grammar::Gro => "the title of the next frame",
        };
        let mut blank = None;
        while self.lines.advance()? {
            match (self.lines.is_blank(), blank) {
                (true, _) => blank = blank.or(Some(self.lines.number())),
                (false, None) => return Ok(true),
                (false, Some(line)) => {
                    let allowed = format!("{beginning}, or the end of the file");
                    return Err(self.lines.refuse_at(line, "a blank line", allowed));
                }
            }
        }
        Ok(false)
    }
}
