//! One frame of extended XYZ, read.

use std::io::BufRead;

use glam::DVec3;

use crate::columns::Vector;
use crate::lines::{At, Lines};
use crate::particles::{ParticleReader, Place, skip_rows};
use crate::units::FileUnits;
use crate::xyz_header::Header;
use crate::{FormatError, TrajectoryFrame};

/// Shortest line of a particle, `0 0 0` and its end, in bytes.
const LEAST_BYTES_A_PARTICLE: u64 = 6;

/// Lines of a frame between its count and its particles: the header.
const HEADER_LINES: u64 = 1;

const HEADER: &str = "the header line of the frame";

/// Passes over the frame whose count is the current line.
pub(crate) fn skip_frame<R: BufRead>(lines: &mut Lines<R>) -> Result<(), FormatError> {
    let n = lines.particle_count(HEADER_LINES, LEAST_BYTES_A_PARTICLE)?;
    lines.next_or(HEADER)?;
    skip_rows(lines, n)
}

/// Reads the frame whose count is the current line.
pub(crate) fn parse_frame<R: BufRead>(
    lines: &mut Lines<R>,
    units: FileUnits,
) -> Result<TrajectoryFrame, FormatError> {
    let count_line = lines.number();
    let n = lines.particle_count(HEADER_LINES, LEAST_BYTES_A_PARTICLE)?;
    lines.next_or(HEADER)?;
    let header = Header::parse(lines.line(), units).at(lines)?;
    let columns = &header.columns;
    // A character and a separator for each column: before memory for all arrays is taken.
    let least = 2 * columns.width() as u64;
    if !lines.check_room(n as u64, 0, least) {
        return Err(lines.refuse_at(
            count_line,
            format!("{n} particles"),
            format!(
                "at most what the {} bytes left in the file can hold, {least} bytes per particle: \
                 the count is wrong or the frame is truncated",
                lines.left()
            ),
        ));
    }
    let place = Place::new(DVec3::ZERO, header.cell, header.scales).at(lines)?;
    let particles = ParticleReader::read(lines, n, columns, &place, "as the header says")?;
    Ok(TrajectoryFrame {
        step: header.step,
        time: header.time.and_then(|time| header.scales.time(time)),
        info: header.info,
        unwrapped: header.columns.has(Vector::Image),
        ..TrajectoryFrame::of(particles, place.cell)
    })
}
