//! One frame of extended XYZ, read.

use std::io::BufRead;

use glam::{DVec3, IVec3};
use lennard_core::PeriodicBox;

use crate::error::excerpt;
use crate::lines::{Lines, finite, tokens};
use crate::species_reader::SpeciesReader;
use crate::xyz_header::{Column, Header};
use crate::{FormatError, FoundSpecies, TrajectoryFrame};

/// Shortest line of a particle, `0 0 0` and its end, in bytes.
pub(crate) const LEAST_BYTES_A_PARTICLE: u64 = 6;

/// Lines of a frame between its count and its particles: the header.
const HEADER_LINES: u64 = 1;

/// Positions further than this many boxes away have no image flags in 32 bits.
const MOST_BOXES_AWAY: f64 = 2_147_483_647.0;

/// Passes over the frame whose count is the current line.
pub(crate) fn skip_frame<R: BufRead>(lines: &mut Lines<R>) -> Result<(), FormatError> {
    let n = lines.particle_count(HEADER_LINES, LEAST_BYTES_A_PARTICLE)?;
    for row in 0..=n {
        if !lines.advance()? {
            return Err(lines.refuse_end(missing(row, n)));
        }
    }
    Ok(())
}

fn missing(row: usize, n: usize) -> String {
    if row == 0 {
        "the header line of the frame".into()
    } else {
        format!("particle {row} of {n}: the frame is truncated")
    }
}

/// Reads the frame whose count is the current line.
pub(crate) fn parse_frame<R: BufRead>(
    lines: &mut Lines<R>,
) -> Result<TrajectoryFrame, FormatError> {
    let count_line = lines.number();
    let n = lines.particle_count(HEADER_LINES, LEAST_BYTES_A_PARTICLE)?;
    if !lines.advance()? {
        return Err(lines.refuse_end(missing(0, n)));
    }
    let header = Header::parse(lines.line()).map_err(|(f, a)| lines.refuse(f, a))?;
    let width: usize = header.columns.iter().map(|c| c.width()).sum();
    // A character and a separator for each column: before memory for all arrays is taken.
    let least = 2 * width as u64;
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
    let cell = match header.cell {
        None => None,
        Some(cell) => Some(
            PeriodicBox::new(cell.lengths() / header.length_scale)
                .map_err(|e| lines.refuse(e.to_string(), "a box that its length scale allows"))?,
        ),
    };
    let wants = |column| header.columns.contains(&column);
    let array = |wanted: bool| wanted.then(|| Vec::with_capacity(n));
    let mut frame = TrajectoryFrame {
        cell,
        positions: Vec::with_capacity(n),
        velocities: array(wants(Column::Velocity)),
        forces: array(wants(Column::Force)),
        species: FoundSpecies::default(),
        step: header.step,
        time: header.time,
        info: header.info.clone(),
    };
    let mut species = SpeciesReader::new(n);
    for row in 1..=n {
        if !lines.advance()? {
            return Err(lines.refuse_end(missing(row, n)));
        }
        let particle =
            parse_particle(lines.line(), &header, width).map_err(|(f, a)| lines.refuse(f, a))?;
        let position = match (particle.image, cell) {
            (Some(image), Some(cell)) => particle.position + image.as_dvec3() * cell.lengths(),
            _ => particle.position,
        };
        let reach = cell.map_or(DVec3::splat(f64::MAX), |c| c.lengths() * MOST_BOXES_AWAY);
        if !position.abs().cmple(reach).all() {
            return Err(lines.refuse(
                format!("particle {row} at {position}"),
                "positions within 2^31 boxes of the origin",
            ));
        }
        frame.positions.push(position);
        if let (Some(all), Some(velocity)) = (&mut frame.velocities, particle.velocity) {
            all.push(velocity);
        }
        if let (Some(all), Some(force)) = (&mut frame.forces, particle.force) {
            all.push(force);
        }
        species
            .take(particle.species, particle.mass)
            .map_err(|(f, a)| lines.refuse(f, a))?;
    }
    frame.species = species.found;
    Ok(frame)
}

/// One line of a frame, lengths in σ.
struct Particle<'a> {
    species: Option<&'a str>,
    position: DVec3,
    velocity: Option<DVec3>,
    force: Option<DVec3>,
    image: Option<IVec3>,
    mass: Option<f64>,
}

fn parse_particle<'a>(
    line: &'a [u8],
    header: &Header,
    width: usize,
) -> Result<Particle<'a>, (String, String)> {
    let mut rest = tokens(line);
    let wrong_width = || {
        (
            format!("{} columns in {}", tokens(line).count(), excerpt(line)),
            format!("{width} columns, as the header says"),
        )
    };
    let mut particle = Particle {
        species: None,
        position: DVec3::ZERO,
        velocity: None,
        force: None,
        image: None,
        mass: None,
    };
    for column in &header.columns {
        match column {
            Column::Species => {
                let token = rest.next().ok_or_else(wrong_width)?;
                particle.species =
                    Some(std::str::from_utf8(token).map_err(|_| {
                        (excerpt(token), "the name of a species in UTF-8".to_string())
                    })?);
            }
            Column::Position => {
                particle.position = vector(&mut rest, wrong_width)? / header.length_scale;
            }
            Column::Velocity => {
                particle.velocity = Some(vector(&mut rest, wrong_width)? / header.length_scale);
            }
            Column::Force => {
                particle.force = Some(vector(&mut rest, wrong_width)? * header.length_scale);
            }
            Column::ImageFlags => {
                let mut image = IVec3::ZERO;
                for axis in 0..3 {
                    let token = rest.next().ok_or_else(wrong_width)?;
                    image[axis] = std::str::from_utf8(token)
                        .ok()
                        .and_then(|t| t.parse().ok())
                        .ok_or_else(|| {
                            (
                                excerpt(token),
                                "an image flag, an integer of 32 bits".to_string(),
                            )
                        })?;
                }
                particle.image = Some(image);
            }
            Column::Mass => {
                particle.mass = Some(number(rest.next().ok_or_else(wrong_width)?)?);
            }
            Column::Other(width) => {
                for _ in 0..*width {
                    rest.next().ok_or_else(wrong_width)?;
                }
            }
        }
    }
    if rest.next().is_some() {
        return Err(wrong_width());
    }
    for vector in [Some(particle.position), particle.velocity, particle.force] {
        if !vector.is_none_or(DVec3::is_finite) {
            return Err((
                excerpt(line),
                "numbers that stay finite when the length scale is taken out".into(),
            ));
        }
    }
    Ok(particle)
}

fn number(token: &[u8]) -> Result<f64, (String, String)> {
    finite(token).ok_or_else(|| (excerpt(token), "a finite number".to_string()))
}

fn vector<'a>(
    rest: &mut impl Iterator<Item = &'a [u8]>,
    wrong_width: impl Fn() -> (String, String),
) -> Result<DVec3, (String, String)> {
    let mut next = || number(rest.next().ok_or_else(&wrong_width)?);
    Ok(DVec3::new(next()?, next()?, next()?))
}
