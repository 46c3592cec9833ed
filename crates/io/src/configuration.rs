//! Start configurations, in whichever format their content is.

use std::io::{Cursor, Read};
use std::path::Path;

use lennard_core::PeriodicBox;

use crate::error::excerpt;
use crate::gunzip::{GZIP, MOST_INFLATED, inflated};
use crate::lines::{Input, Lines, one_token, open_regular};
use crate::particles::StartConfiguration;
use crate::text_frames::{Grammar, TextFrames};
use crate::units::FileUnits;
use crate::{FormatError, foreign, gro, lammps_data, lammps_dump, nist};

/// What a scene says of the file that it names.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Beside {
    /// The box, for a file that names none.
    pub cell: Option<PeriodicBox>,
    /// The units of the file.
    pub units: FileUnits,
}

/// Reads a start configuration: the last frame of extended XYZ, a LAMMPS dump or GRO, a LAMMPS data file of atoms, or NIST columns.
/// The content tells them apart, and each may be compressed by gzip.
///
/// # Errors
/// Where the file cannot be read, has no box, or holds what its format does not allow.
pub fn read_configuration(path: &Path) -> Result<StartConfiguration, FormatError> {
    read_configuration_in(path, Beside::default())
}

/// Like [`read_configuration`], with what stands beside the file.
///
/// # Errors
/// Where the file cannot be read, holds what its format does not allow, or states other units.
pub fn read_configuration_in(
    path: &Path,
    beside: Beside,
) -> Result<StartConfiguration, FormatError> {
    let open = || open_regular(path).map(|(reader, size)| (Box::new(reader) as Input<'_>, size));
    parse(open, path, beside)
}

/// Like [`read_configuration`], from memory.
///
/// # Errors
/// Where the content has no box or holds what its format does not allow.
pub fn read_configuration_bytes(bytes: &[u8]) -> Result<StartConfiguration, FormatError> {
    let path = Path::new("configuration in memory");
    parse(|| Ok((Box::new(bytes), bytes.len() as u64)), path, Beside::default())
}

/// So many bytes of a text tell its format.
const HEAD: u64 = 1 << 16;

/// The formats of text.
pub(crate) enum Kind {
    Frames(Grammar),
    LammpsData,
    Nist,
}

/// Tells the format by the first lines.
fn kind(lines: &mut Lines<'_>) -> Result<Kind, FormatError> {
    let mut head: Vec<Vec<u8>> = Vec::new();
    while head.len() < lammps_data::LINES_OF_A_HEADER && lines.advance()? {
        head.push(lines.line().to_vec());
    }
    let Some(first) = head.first() else {
        return Err(lines.refuse_end(
            "a configuration: extended XYZ, LAMMPS dump or data, GRO, or NIST columns",
        ));
    };
    let line = |number: usize| head.get(number - 1).map(Vec::as_slice).unwrap_or_default();
    let is_count = |line: &[u8]| one_token(line).is_some_and(|n| n.iter().all(u8::is_ascii_digit));
    if nist::is_box_line(first) {
        return Ok(Kind::Nist);
    }
    if first.starts_with(lammps_dump::FIRST_WORD) {
        return Ok(Kind::Frames(Grammar::LammpsDump));
    }
    if is_count(line(2)) && gro::is_row(line(3)) {
        return Ok(Kind::Frames(Grammar::Gro));
    }
    if is_count(first) {
        if nist::is_triclinic_line(line(2)) {
            return Err(lines.refuse_at(
                2,
                format!("{}, a triclinic NIST box", excerpt(line(2))),
                "an orthorhombic box; triclinic boxes are not there yet",
            ));
        }
        return Ok(Kind::Frames(Grammar::ExtendedXyz));
    }
    if head[1..].iter().any(|line| lammps_data::is_count(line)) {
        return Ok(Kind::LammpsData);
    }
    if let Some((name, way)) = foreign::text(&head) {
        return Err(lines.refuse_at(1, name, way));
    }
    if one_token(first).is_some() {
        return Ok(Kind::Frames(Grammar::ExtendedXyz));
    }
    Err(lines.refuse_at(
        1,
        excerpt(first),
        "the number of particles (extended XYZ), three box sides (NIST columns), `ITEM: TIMESTEP` (LAMMPS dump), \
         or a title before `N atoms` (LAMMPS data) or before the number of particles (GRO)",
    ))
}

/// The format of a text, and its lines; compressed text is inflated.
pub(crate) fn text_of<'a>(
    mut reader: Input<'a>,
    mut size: u64,
    path: &Path,
) -> Result<(Kind, Lines<'a>), FormatError> {
    let fail = |e| FormatError::io(path, e);
    if reader.fill_buf().map_err(fail)?.starts_with(GZIP) {
        (reader, size) = (Box::new(inflated(reader)), size.saturating_mul(MOST_INFLATED));
    }
    let mut head = Vec::new();
    (&mut reader).take(HEAD).read_to_end(&mut head).map_err(fail)?;
    if let Some((name, way)) = foreign::binary(&head) {
        return Err(FormatError::content(path, 1, name, way));
    }
    let kind = kind(&mut Lines::new(Box::new(&*head), size, path))?;
    Ok((kind, Lines::new(Box::new(Cursor::new(head).chain(reader)), size, path)))
}

/// Reads what `open` opens. Of several frames the last is wanted, and which is the last their counts tell.
fn parse<'a>(
    open: impl Fn() -> Result<(Input<'a>, u64), FormatError>,
    path: &Path,
    beside: Beside,
) -> Result<StartConfiguration, FormatError> {
    let content =
        |line, found: &str, allowed: &str| FormatError::content(path, line, found, allowed);
    let units = beside.units;
    let text = || open().and_then(|(reader, size)| text_of(reader, size, path));
    let (kind, lines) = text()?;
    let (frame, first_line, frames) = match kind {
        Kind::Nist => (nist::parse(lines, units)?, 0, 1),
        Kind::LammpsData => (lammps_data::parse(lines, units)?, 0, 1),
        Kind::Frames(grammar) => {
            let frames = TextFrames::new(lines, grammar, units).skip(u64::MAX)?;
            let mut again = TextFrames::new(text()?.1, grammar, units);
            again.skip(frames.saturating_sub(1))?;
            let last = again.next_frame()?;
            let last = last.ok_or_else(|| content(1, "no frame", "at least one frame"))?;
            (last, again.first_line, frames)
        }
    };
    let cell = frame.cell.or(beside.cell).ok_or_else(|| {
        content(
            first_line + 1,
            "no box",
            "a Lattice=\"Lx 0.0 0.0 0.0 Ly 0.0 0.0 0.0 Lz\" entry, or a box in the scene",
        )
    })?;
    Ok(frame.into_start(cell, frames))
}
