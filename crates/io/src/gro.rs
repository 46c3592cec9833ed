//! One frame of GROMACS' `.gro`, read.
//!
//! Source: GROMACS reference manual, "File formats: gro". Positions have n decimals in n + 5 columns, velocities n + 1 in as many.

use glam::DVec3;
use lennard_core::PeriodicBox;

use crate::columns::{Column, Columns, Scalar, Vector};
use crate::error::{Refusal, excerpt, refused};
use crate::geometry::upright;
use crate::lines::{At, Lines, finite, tokens};
use crate::particles::{ParticleReader, Place, next_row, skip_rows};
use crate::units::{FileUnits, OF_GRO, stated};
use crate::{FormatError, TrajectoryFrame};

/// Residue number and name, atom name and number have five columns each.
const WIDTH_OF_NAMES: usize = 5;
/// Where the position begins.
const NAMES: usize = 4 * WIDTH_OF_NAMES;
/// Columns before the point of a position, a space and a sign among them, and the point.
const BEFORE_DECIMALS: usize = 5;

/// Shortest line of a particle and its end, in bytes: positions without decimals.
const LEAST_BYTES_A_PARTICLE: u64 = (NAMES + 3 * BEFORE_DECIMALS) as u64 + 1;

const SIDES: &str = "the sides of the box after the particles";

/// How the title of a topology begins that this program wrote.
const OWN_TITLE: &[u8] = b"Lennard: names";

/// How the numbers of a file are laid out.
#[derive(Debug, Clone, PartialEq)]
struct Layout {
    /// Columns of a number.
    width: usize,
    columns: Columns,
}

impl Layout {
    /// The layout of a line; the distance of the points tells the number of decimals.
    fn of(line: &[u8]) -> Option<Self> {
        let line = line.trim_ascii_end();
        let mut points =
            line.iter().skip(NAMES).enumerate().filter(|(_, b)| **b == b'.').map(|(at, _)| at);
        let width = points.next().zip(points.next()).map(|(first, second)| second - first)?;
        let mut columns =
            vec![Column::Other, Column::Other, Column::Scalar(Scalar::Name), Column::Other];
        columns.push(Column::Vector(Vector::Position));
        match line.len().checked_sub(NAMES)?.checked_div(width) {
            Some(3) => {}
            Some(6) => columns.push(Column::Vector(Vector::Velocity)),
            _ => return None,
        }
        let columns = Columns::fixed(&columns);
        (width > BEFORE_DECIMALS).then_some(Self { width, columns })
    }

    /// The pieces of a line, by their places.
    fn pieces<'a>(&self, line: &'a [u8]) -> Result<Vec<&'a [u8]>, Refusal> {
        let line = line.trim_ascii_end();
        let width = NAMES + (self.columns.width() - 4) * self.width;
        if line.len() != width {
            let found = format!("{} characters in {}", line.len(), excerpt(line));
            return refused(
                found,
                format!("{width} characters, as in the first line of a particle"),
            );
        }
        let (names, numbers) = line.split_at(NAMES);
        let all = names.chunks(WIDTH_OF_NAMES).chain(numbers.chunks(self.width));
        Ok(all.map(<[u8]>::trim_ascii).collect())
    }
}

/// Whether this can be the line of a particle.
pub(crate) fn is_row(line: &[u8]) -> bool {
    let row = |layout: Layout| {
        let pieces = layout.pieces(line).ok()?;
        let counts = [pieces[0], pieces[3]].iter().all(|n| n.iter().all(u8::is_ascii_digit));
        counts.then(|| layout.columns.row_of(&pieces).ok()).flatten()
    };
    Layout::of(line).and_then(row).is_some()
}

/// Reads the frame whose title is the current line, or passes over it where it is not `wanted`.
pub(crate) fn parse_frame(
    lines: &mut Lines<'_>,
    mut units: FileUnits,
    wanted: bool,
) -> Result<Option<TrajectoryFrame>, FormatError> {
    let title = lines.line().to_vec();
    let said = stated(&String::from_utf8_lossy(&title));
    let is_own = title.starts_with(OWN_TITLE);
    let said = said.or((units.substance.is_some() && !is_own).then(|| OF_GRO.to_owned()));
    if said.is_none() && units.length.is_none() {
        let (found, first) = match is_own {
            true => (
                "a topology of this program, whose positions are rounded",
                "the `final.xyz` beside it, or ",
            ),
            false => ("a GRO file, in nm and ps", ""),
        };
        let allowed = "`start.length_scale` and `start.time_scale` in the scene: one σ in nm and one τ in ps; or `units.substance`";
        return Err(lines.refuse(found, format!("{first}{allowed}")));
    }
    let scales = units.scales(said.as_deref()).at(lines)?;
    lines.next_or("the number of particles")?;
    let n = lines.particle_count(1, LEAST_BYTES_A_PARTICLE)?;
    if !wanted {
        skip_rows(lines, n)?;
        return lines.next_or(SIDES).map(|()| None);
    }
    // The box comes last.
    let mut rows = Vec::with_capacity(n);
    for row in 1..=n {
        next_row(lines, row, n)?;
        rows.push((lines.number(), lines.line().to_vec()));
    }
    lines.next_or(SIDES)?;
    let place = Place::new(DVec3::ZERO, sides(lines.line()).at(lines)?, scales).at(lines)?;
    let first = &rows[0];
    let layout = Layout::of(&first.1).ok_or_else(|| {
        let allowed = "names and numbers in 20 columns, then a position, or a position and a velocity, in columns of one width";
        lines.refuse_at(first.0, excerpt(&first.1), allowed)
    })?;
    let mut particles = ParticleReader::new(n, &layout.columns);
    for (number, row) in &rows {
        let read = layout.pieces(row).and_then(|pieces| layout.columns.row_of(&pieces));
        let taken = read.and_then(|row| particles.take(row, &place));
        taken.map_err(|(f, a)| lines.refuse_at(*number, f, a))?;
    }
    let particles = particles.finish().at(lines)?;
    let time = time_of(&title).and_then(|time| scales.time(time));
    Ok(Some(TrajectoryFrame { cell: place.cell, time, ..particles }))
}

/// The time in a title, as GROMACS writes it: `t= 1.00000`.
fn time_of(title: &[u8]) -> Option<f64> {
    let title = String::from_utf8_lossy(title);
    let after = title.rsplit_once(" t=").or(title.rsplit_once("\tt="))?.1;
    finite(after.split_whitespace().next()?.as_bytes())
}

/// The sides of the box; none where they are zeros.
fn sides(line: &[u8]) -> Result<Option<PeriodicBox>, Refusal> {
    let numbers: Option<Vec<f64>> = tokens(line).map(finite).collect();
    let edges = match numbers.as_deref() {
        Some(&[x, y, z]) => [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]],
        Some(&[ax, by, cz, ay, az, bx, bz, cx, cy]) => [[ax, ay, az], [bx, by, bz], [cx, cy, cz]],
        _ => {
            return refused(excerpt(line), "three or nine finite numbers, the sides of the box");
        }
    };
    if edges == [[0.0; 3]; 3] {
        return Ok(None);
    }
    upright(edges.map(DVec3::from_array), || excerpt(line)).map(Some)
}
