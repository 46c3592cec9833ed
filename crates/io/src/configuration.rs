//! Start configurations, in whichever format their content is.

use std::io::{BufRead, Cursor, Seek};
use std::path::Path;

use lennard_core::PeriodicBox;

use crate::error::excerpt;
use crate::found::StartConfiguration;
use crate::lines::{Lines, one_token, open_regular};
use crate::trajectory_reader::last_frame;
use crate::{FormatError, nist};

/// Two statements of the same box may differ by this much of a side: one may have been rounded to
/// 15 digits.
const SAME_BOX: f64 = 1e-14;

/// Reads a start configuration: the last frame of an extended XYZ file, or NIST columns, told apart
/// by their content.
///
/// # Errors
/// Where the file cannot be read, has no box, or holds what its format does not allow.
pub fn read_configuration(path: &Path) -> Result<StartConfiguration, FormatError> {
    read_configuration_in(path, None)
}

/// Like [`read_configuration`], with the box for a file that names none. Where the file names one
/// too, both must be the same.
///
/// # Errors
/// Where the file cannot be read, holds what its format does not allow, or names another box.
pub fn read_configuration_in(
    path: &Path,
    cell: Option<PeriodicBox>,
) -> Result<StartConfiguration, FormatError> {
    let (reader, size) = open_regular(path)?;
    parse(reader, size, path, cell)
}

/// Like [`read_configuration`], from memory.
///
/// # Errors
/// Where the content has no box or holds what its format does not allow.
pub fn read_configuration_bytes(bytes: &[u8]) -> Result<StartConfiguration, FormatError> {
    let path = Path::new("configuration in memory");
    parse(Cursor::new(bytes), bytes.len() as u64, path, None)
}

fn parse<R: BufRead + Seek>(
    mut reader: R,
    size: u64,
    path: &Path,
    given: Option<PeriodicBox>,
) -> Result<StartConfiguration, FormatError> {
    let mut lines = Lines::new(&mut reader, size, path);
    if !lines.advance()? {
        return Err(lines.refuse_end("a configuration: extended XYZ or NIST columns"));
    }
    let is_nist = nist::is_box_line(lines.line());
    if !is_nist {
        if one_token(lines.line()).is_none() {
            return Err(lines.refuse(
                excerpt(lines.line()),
                "the number of particles (extended XYZ) or three box sides (NIST columns)",
            ));
        }
        if lines.advance()? && nist::is_triclinic_line(lines.line()) {
            return Err(lines.refuse(
                format!("{}, a triclinic NIST box", excerpt(lines.line())),
                "an orthorhombic box; triclinic boxes are not there yet",
            ));
        }
    }
    reader.rewind().map_err(|e| FormatError::io(path, e))?;

    let (start, box_line) = if is_nist {
        (nist::parse(Lines::new(reader, size, path))?, 1)
    } else {
        let content = |line, found: &str, allowed: &str| FormatError::Content {
            file: path.to_path_buf(),
            line,
            found: found.into(),
            allowed: allowed.into(),
        };
        let (frame, first_line, frames) = last_frame(reader, size, path)?
            .ok_or_else(|| content(1, "no frame", "at least one frame"))?;
        let cell = frame.cell.or(given).ok_or_else(|| {
            content(
                first_line + 1,
                "no box",
                "a Lattice=\"Lx 0.0 0.0 0.0 Ly 0.0 0.0 0.0 Lz\" entry, or a box in the scene",
            )
        })?;
        let start = StartConfiguration {
            cell,
            positions: frame.positions,
            velocities: frame.velocities,
            step: frame.step,
            time: frame.time,
            species: frame.species,
            frames,
        };
        (start, first_line + 1)
    };
    if let Some(given) = given {
        let (ours, theirs) = (given.lengths(), start.cell.lengths());
        if !(ours - theirs).abs().cmple(theirs * SAME_BOX).all() {
            return Err(FormatError::Content {
                file: path.to_path_buf(),
                line: box_line,
                found: format!("the box {theirs}"),
                allowed: format!("the same box as the scene's, {ours}, or none in one of them"),
            });
        }
    }
    Ok(start)
}
