//! One frame of extended XYZ, read.

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

/// Reads the frame whose count is the current line, or passes over it where it is not `wanted`.
pub(crate) fn parse_frame(
    lines: &mut Lines<'_>,
    units: FileUnits,
    wanted: bool,
) -> Result<Option<TrajectoryFrame>, FormatError> {
    let n = lines.particle_count(HEADER_LINES, LEAST_BYTES_A_PARTICLE)?;
    lines.next_or("the header line of the frame")?;
    if !wanted {
        return skip_rows(lines, n);
    }
    let Header { cell, columns, step, time, scales, info } =
        Header::parse(lines.line(), units).at(lines)?;
    let place = Place::new(DVec3::ZERO, cell, scales).at(lines)?;
    let particles = ParticleReader::read(lines, n, &columns, &place, "as the header says")?;
    Ok(Some(TrajectoryFrame {
        step,
        time: time.and_then(|time| scales.time(time)),
        info,
        unwrapped: columns.has(Vector::Image),
        ..particles
    }))
}
