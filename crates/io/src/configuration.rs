//! Start configurations, in whichever format their content is.

use std::io::{BufRead, Cursor, Seek};
use std::path::Path;

use lennard_core::PeriodicBox;

use crate::error::excerpt;
use crate::geometry::is_same_box;
use crate::lines::{Lines, one_token, open_regular};
use crate::particles::StartConfiguration;
use crate::rewind::{GZIP, Gunzip, MOST_INFLATED, Rewind};
use crate::trajectory_reader::{Grammar, last_frame};
use crate::units::FileUnits;
use crate::{FormatError, foreign, gro, lammps_data, lammps_dump, nist};

/// What a scene says of the file that it names.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Beside {
    /// The box, for a file that names none. Where the file names one too, both must be the same.
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
/// Where the file cannot be read, holds what its format does not allow, names another box, or states other units.
pub fn read_configuration_in(
    path: &Path,
    beside: Beside,
) -> Result<StartConfiguration, FormatError> {
    let (reader, size) = open_regular(path)?;
    parse(reader, size, path, beside)
}

/// Like [`read_configuration`], from memory.
///
/// # Errors
/// Where the content has no box or holds what its format does not allow.
pub fn read_configuration_bytes(bytes: &[u8]) -> Result<StartConfiguration, FormatError> {
    let path = Path::new("configuration in memory");
    parse(Cursor::new(bytes), bytes.len() as u64, path, Beside::default())
}

/// The formats of text.
pub(crate) enum Kind {
    Frames(Grammar),
    LammpsData,
    Nist,
}

fn parse<R: BufRead + Seek>(
    mut reader: R,
    size: u64,
    path: &Path,
    beside: Beside,
) -> Result<StartConfiguration, FormatError> {
    let head = reader.fill_buf().map_err(|e| FormatError::io(path, e))?;
    if head.starts_with(GZIP) {
        let most = size.saturating_mul(MOST_INFLATED);
        return parse_text(Gunzip::new(reader), most, path, beside);
    }
    parse_text(reader, size, path, beside)
}

/// Tells the format by the first lines.
fn kind<R: BufRead>(lines: &mut Lines<R>) -> Result<Kind, FormatError> {
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

/// Tells the format of a text and goes back to its beginning.
pub(crate) fn kind_of<R: Rewind>(
    reader: &mut R,
    size: u64,
    path: &Path,
) -> Result<Kind, FormatError> {
    let head = reader.fill_buf().map_err(|e| FormatError::io(path, e))?;
    if let Some((name, way)) = foreign::binary(head) {
        return Err(FormatError::content(path, 1, name, way));
    }
    let kind = kind(&mut Lines::new(&mut *reader, size, path))?;
    reader.go_to(0).map_err(|e| FormatError::io(path, e))?;
    Ok(kind)
}

fn parse_text<R: Rewind>(
    mut reader: R,
    size: u64,
    path: &Path,
    beside: Beside,
) -> Result<StartConfiguration, FormatError> {
    let content =
        |line, found: &str, allowed: &str| FormatError::content(path, line, found, allowed);
    let kind = kind_of(&mut reader, size, path)?;
    let units = beside.units;
    let (frame, first_line, frames) = match kind {
        Kind::Nist => (nist::parse(Lines::new(reader, size, path), units)?, 0, 1),
        Kind::LammpsData => (lammps_data::parse(Lines::new(reader, size, path), units)?, 0, 1),
        Kind::Frames(grammar) => last_frame(reader, size, path, grammar, units)?
            .ok_or_else(|| content(1, "no frame", "at least one frame"))?,
    };
    let cell = frame.cell.or(beside.cell).ok_or_else(|| {
        content(
            first_line + 1,
            "no box",
            "a Lattice=\"Lx 0.0 0.0 0.0 Ly 0.0 0.0 0.0 Lz\" entry, or a box in the scene",
        )
    })?;
    if let Some(given) = beside.cell.filter(|given| !is_same_box(given, &cell)) {
        let (ours, theirs) = (given.lengths(), cell.lengths());
        let allowed = format!("the same box as the scene's, {ours}, or none in one of them");
        return Err(content(first_line + 1, &format!("the box {theirs}"), &allowed));
    }
    Ok(frame.into_start(cell, frames))
}
