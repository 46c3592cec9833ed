//! The column format of the NIST reference configurations: box sides, number of particles, then
//! `id x y z` a line.
//!
//! Source: National Institute of Standards and Technology, Standard Reference Simulation Website,
//! "Lennard-Jones Fluid Reference Calculations: Cuboid Cell".

use std::io::BufRead;

use glam::DVec3;
use lennard_core::PeriodicBox;

use crate::error::excerpt;
use crate::lines::{Lines, finite, tokens};
use crate::{FormatError, FoundSpecies, StartConfiguration};

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

fn is_number(token: &[u8]) -> bool {
    std::str::from_utf8(token).is_ok_and(|text| text.parse::<f64>().is_ok())
}

/// Reads the whole file; nothing of it has been read yet.
pub(crate) fn parse<R: BufRead>(mut lines: Lines<R>) -> Result<StartConfiguration, FormatError> {
    if !lines.advance()? {
        return Err(lines.refuse_end("three box sides"));
    }
    let sides: Option<Vec<f64>> = tokens(lines.line()).map(finite).collect();
    let cell = match sides.as_deref() {
        Some(&[x, y, z]) => PeriodicBox::new(DVec3::new(x, y, z)).ok(),
        _ => None,
    }
    .ok_or_else(|| {
        lines.refuse(
            excerpt(lines.line()),
            "three box sides, finite positive numbers",
        )
    })?;
    if !lines.advance()? {
        return Err(lines.refuse_end("the number of particles"));
    }
    let n = lines.particle_count(0, LEAST_BYTES_A_PARTICLE)?;
    let mut positions = Vec::with_capacity(n);
    for row in 1..=n {
        if !lines.advance()? {
            return Err(lines.refuse_end(format!("particle {row} of {n}: the file is truncated")));
        }
        let mut columns = tokens(lines.line());
        let id = columns
            .next()
            .and_then(|t| std::str::from_utf8(t).ok()?.parse::<usize>().ok());
        let numbers: Option<Vec<f64>> = columns.map(finite).collect();
        match (id, numbers.as_deref()) {
            (Some(id), Some(&[x, y, z])) if id == row => positions.push(DVec3::new(x, y, z)),
            _ => {
                return Err(lines.refuse(
                    excerpt(lines.line()),
                    format!("`{row} x y z`: the particle's number, then three finite coordinates"),
                ));
            }
        }
    }
    while lines.advance()? {
        if !lines.is_blank() {
            return Err(lines.refuse(
                excerpt(lines.line()),
                format!("the end of the file after {n} particles"),
            ));
        }
    }
    Ok(StartConfiguration {
        frames: 1,
        cell,
        positions,
        velocities: None,
        step: None,
        time: None,
        species: FoundSpecies::default(),
    })
}
