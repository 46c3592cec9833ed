//! Start configurations, in whichever format their content is.

use std::io::{BufRead, Cursor, Seek};
use std::path::Path;

use lennard_core::PeriodicBox;

use crate::error::excerpt;
use crate::found::StartConfiguration;
use crate::lines::{Lines, one_token, open_regular};
use crate::rewind::{GZIP, Gunzip, MOST_INFLATED, Rewind};
use crate::trajectory_reader::{Grammar, last_frame};
use crate::{FormatError, lammps_data, lammps_dump, nist};

/// Two statements of the same box may differ by this much of a side: one may have been rounded to
/// 15 digits.
const SAME_BOX: f64 = 1e-14;

/// The first bytes of an XTC file: the number 1995, or 2023 in files of very many particles.
const XTC: [[u8; 4]; 2] = [[0, 0, 0x07, 0xcb], [0, 0, 0x07, 0xe7]];

/// Reads a start configuration: the last frame of extended XYZ or of a LAMMPS dump, a LAMMPS data file of atoms, or NIST
/// columns. The content tells them apart, and each may be compressed by gzip.
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

/// The formats of text.
enum Kind {
    Frames(Grammar),
    LammpsData,
    Nist,
}

fn parse<R: BufRead + Seek>(
    mut reader: R,
    size: u64,
    path: &Path,
    given: Option<PeriodicBox>,
) -> Result<StartConfiguration, FormatError> {
    let head = reader.fill_buf().map_err(|e| FormatError::io(path, e))?;
    if XTC.iter().any(|magic| head.starts_with(magic)) {
        return Err(FormatError::Content {
            file: path.to_path_buf(),
            line: 1,
            found: "an XTC trajectory, whose positions are rounded and which has neither velocities nor species".into(),
            allowed: "extended XYZ (such as the `final.xyz` beside it), LAMMPS dump or data, or NIST columns".into(),
        });
    }
    if head.starts_with(GZIP) {
        let most = size.saturating_mul(MOST_INFLATED);
        return parse_text(Gunzip::new(reader), most, path, given);
    }
    parse_text(reader, size, path, given)
}

/// Tells the format by the first lines.
fn kind<R: BufRead>(lines: &mut Lines<R>) -> Result<Kind, FormatError> {
    if !lines.advance()? {
        return Err(
            lines.refuse_end("a configuration: extended XYZ, LAMMPS dump or data, or NIST columns")
        );
    }
    if nist::is_box_line(lines.line()) {
        return Ok(Kind::Nist);
    }
    if lines.line().starts_with(lammps_dump::FIRST_WORD) {
        return Ok(Kind::Frames(Grammar::LammpsDump));
    }
    let first = lines.line().to_vec();
    let count = one_token(&first);
    if count.is_some_and(|token| token.iter().all(u8::is_ascii_digit)) {
        if lines.advance()? && nist::is_triclinic_line(lines.line()) {
            return Err(lines.refuse(
                format!("{}, a triclinic NIST box", excerpt(lines.line())),
                "an orthorhombic box; triclinic boxes are not there yet",
            ));
        }
        return Ok(Kind::Frames(Grammar::ExtendedXyz));
    }
    for _ in 0..lammps_data::LINES_OF_A_HEADER {
        if !lines.advance()? {
            break;
        }
        if lammps_data::is_count(lines.line()) {
            return Ok(Kind::LammpsData);
        }
    }
    if count.is_some() {
        return Ok(Kind::Frames(Grammar::ExtendedXyz));
    }
    Err(lines.refuse_at(
        1,
        excerpt(&first),
        "the number of particles (extended XYZ), three box sides (NIST columns), `ITEM: TIMESTEP` (LAMMPS dump), \
         or a title before `N atoms` (LAMMPS data)",
    ))
}

fn parse_text<R: Rewind>(
    mut reader: R,
    size: u64,
    path: &Path,
    given: Option<PeriodicBox>,
) -> Result<StartConfiguration, FormatError> {
    let kind = kind(&mut Lines::new(&mut reader, size, path))?;
    reader.go_to(0).map_err(|e| FormatError::io(path, e))?;
    let (start, box_line) = match kind {
        Kind::Nist => (nist::parse(Lines::new(reader, size, path))?, 1),
        Kind::LammpsData => (lammps_data::parse(Lines::new(reader, size, path))?, 1),
        Kind::Frames(grammar) => last_of(reader, size, path, given, grammar)?,
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

/// The last frame as a start, and the line that names its box.
fn last_of<R: Rewind>(
    reader: R,
    size: u64,
    path: &Path,
    given: Option<PeriodicBox>,
    grammar: Grammar,
) -> Result<(StartConfiguration, u64), FormatError> {
    let content = |line, found: &str, allowed: &str| FormatError::Content {
        file: path.to_path_buf(),
        line,
        found: found.into(),
        allowed: allowed.into(),
    };
    let (frame, first_line, frames) = last_frame(reader, size, path, grammar)?
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
    Ok((start, first_line + 1))
}
