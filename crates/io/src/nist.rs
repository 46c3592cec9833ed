//! The column format of the NIST reference configurations: box sides, number of particles, then
//! `id x y z` a line.
//!
//! Source: National Institute of Standards and Technology, Standard Reference Simulation Website,
//! "Lennard-Jones Fluid Reference Calculations: Cuboid Cell".

use glam::DVec3;
use lennard_core::PeriodicBox;

use crate::columns::{Column, Columns, Scalar, Vector};
use crate::error::excerpt;
use crate::lines::{At, Lines, finite, tokens};
use crate::particles::{ParticleReader, Place};
use crate::units::FileUnits;
use crate::{FormatError, TrajectoryFrame};

/// Shortest line of a particle, `1 0 0 0` and its end, in bytes.
const LEAST_BYTES_A_PARTICLE: u64 = 8;

/// Whether this can be the first line: three numbers.
pub(crate) fn is_box_line(line: &[u8]) -> bool {
    tokens(line).count() == 3 && tokens(line).all(is_number)
}

/// Whether this is the second line of the non-cuboid kind: an index, then three sides and three tilts.
pub(crate) fn is_triclinic_line(line: &[u8]) -> bool {
    tokens(line).count() == 7 && tokens(line).all(is_number)
}

/// Whether this piece of a line is a number, finite or not.
pub(crate) fn is_number(token: &[u8]) -> bool {
    std::str::from_utf8(token).is_ok_and(|text| text.parse::<f64>().is_ok())
}

/// Reads the whole file; nothing of it has been read yet.
pub(crate) fn parse(
    mut lines: Lines<'_>,
    mut units: FileUnits,
) -> Result<TrajectoryFrame, FormatError> {
    lines.next_or("three box sides")?;
    let scales = units.scales(None).at(&lines)?;
    let sides: Option<Vec<f64>> = tokens(lines.line()).map(finite).collect();
    let cell = match sides.as_deref() {
        Some(&[x, y, z]) => PeriodicBox::new(DVec3::new(x, y, z)).ok(),
        _ => None,
    }
    .ok_or_else(|| {
        lines.refuse(excerpt(lines.line()), "three box sides, finite positive numbers")
    })?;
    lines.next_or("the number of particles")?;
    let n = lines.particle_count(0, LEAST_BYTES_A_PARTICLE)?;
    let columns = Columns::fixed(&[Column::Scalar(Scalar::Id), Column::Vector(Vector::Position)]);
    let place = Place::new(DVec3::ZERO, Some(cell), scales).at(&lines)?;
    let as_said = "the particle's number, then three coordinates";
    let particles = ParticleReader::read(&mut lines, n, &columns, &place, as_said)?;
    // In their order, and no two alike.
    if let Some((other, _)) = particles.ids.iter().zip(1..).find(|(id, k)| *id != k) {
        return Err(lines.refuse(format!("the number {other}"), format!("numbers from 1 to {n}")));
    }
    while lines.advance()? {
        if !lines.is_blank() {
            return Err(lines.refuse(
                excerpt(lines.line()),
                format!("the end of the file after {n} particles"),
            ));
        }
    }
    Ok(particles)
}
