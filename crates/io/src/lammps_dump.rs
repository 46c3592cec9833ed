//! One frame of LAMMPS' `dump custom` as text, read.
//!
//! Source: LAMMPS documentation, "dump command".

use glam::DVec3;

use crate::columns::{Column, Columns, MOST_COLUMNS, Scalar, Vector, motion, number};
use crate::error::{Refusal, excerpt, refused};
use crate::lammps::{Bounds, bound};
use crate::lines::{At, Lines, tokens};
use crate::particles::{ParticleReader, Place, skip_rows};
use crate::units::FileUnits;
use crate::{FormatError, TrajectoryFrame};

/// What the first line of a frame begins with.
pub(crate) const FIRST_WORD: &[u8] = b"ITEM:";

/// Shortest line of a particle, `0 0 0` and its end, in bytes.
const LEAST_BYTES_A_PARTICLE: u64 = 6;

/// How coordinates are written, the best for reading first.
const COORDINATES: [[&str; 3]; 4] =
    [["xu", "yu", "zu"], ["xsu", "ysu", "zsu"], ["x", "y", "z"], ["xs", "ys", "zs"]];
/// The one of them that is folded into the box, from which on image flags count.
const FOLDED: usize = 2;

/// What LAMMPS puts before the names of numbers that it computes.
const COMPUTED: [&str; 6] = ["c_", "f_", "v_", "d_", "d2_", "i_"];

/// Where in a line everything stands, and which of [`COORDINATES`] the positions are.
fn columns(line: &[u8]) -> Result<(Columns, usize), Refusal> {
    let names: Vec<&str> =
        tokens(line).skip(2).map(|n| std::str::from_utf8(n).unwrap_or_default()).collect();
    if names.len() > MOST_COLUMNS {
        return refused(
            format!("{} columns", names.len()),
            format!("at most {MOST_COLUMNS} columns"),
        );
    }
    let has = |coordinates: &[&str; 3]| coordinates.iter().all(|name| names.contains(name));
    let Some(style) = COORDINATES.iter().position(has) else {
        return refused(
            excerpt(line),
            "positions among the columns: x y z, xu yu zu, xs ys zs or xsu ysu zsu",
        );
    };
    let axis = |of: &[&str; 3], name: &str| of.iter().position(|n| *n == name);
    let mut all = Columns::default();
    for name in names {
        let vectors = [
            (Vector::Position, COORDINATES[style]),
            (Vector::Image, ["ix", "iy", "iz"]),
            (Vector::Force, ["fx", "fy", "fz"]),
        ];
        let of_vector = vectors
            .iter()
            .find_map(|(vector, of)| Some(Column::Component(*vector, axis(of, name)?)));
        let column = match (name, of_vector) {
            (_, Some(column)) => column,
            ("id", _) => Column::Scalar(Scalar::Id),
            ("type", _) => Column::Scalar(Scalar::Type),
            ("element", _) => Column::Scalar(Scalar::Name),
            ("mass", _) => Column::Scalar(Scalar::Mass),
            _ => match COMPUTED.iter().find_map(|prefix| name.strip_prefix(prefix)).map(motion) {
                Some(Column::Vector(_) | Column::Component(..)) => {
                    let found = format!(
                        "{}, a velocity or momentum that was computed",
                        excerpt(name.as_bytes())
                    );
                    return refused(found, "velocities as vx vy vz, or no such column");
                }
                Some(_) => Column::Other,
                None => motion(name),
            },
        };
        // A vector has three columns here, each with its name.
        let column =
            if let Column::Vector(vector) = column { Column::Component(vector, 0) } else { column };
        if !all.add(column, 1) {
            return refused(format!("{} twice", excerpt(name.as_bytes())), "each quantity once");
        }
    }
    if style < FOLDED {
        all.forget(Vector::Image);
    }
    match all.in_part() {
        Some(vector) => refused(
            format!("a part of {vector} in {}", excerpt(line)),
            "all three components, or none",
        ),
        None => Ok((all, style)),
    }
}

/// Reads the frame whose first line is the current line, or passes over its particles where it is not `wanted`.
pub(crate) fn parse_frame(
    lines: &mut Lines<'_>,
    units: &mut FileUnits,
    wanted: bool,
) -> Result<Option<TrajectoryFrame>, FormatError> {
    let (mut step, mut n, mut bounds, mut time) = (None, None, None, None);
    loop {
        let item = lines.line().strip_prefix(FIRST_WORD).map(<[u8]>::to_vec);
        let item = item.ok_or_else(|| lines.refuse(excerpt(lines.line()), "a line `ITEM: …`"))?;
        let words: Vec<&[u8]> = tokens(&item).collect();
        match words.as_slice() {
            [b"TIMESTEP"] => {
                lines.next_or("the number of the step")?;
                let text = std::str::from_utf8(lines.line()).unwrap_or_default().trim();
                let refuse = |_| lines.refuse(excerpt(lines.line()), "an integer of at least 0");
                step = Some(text.parse::<u64>().map_err(refuse)?);
            }
            [b"NUMBER", b"OF", b"ATOMS"] => {
                lines.next_or("the number of particles")?;
                n = Some(lines.particle_count(1, LEAST_BYTES_A_PARTICLE)?);
            }
            [b"UNITS"] => {
                lines.next_or("the units")?;
                let unit = String::from_utf8_lossy(lines.line()).trim().to_owned();
                units.scales(Some(&unit)).at(lines)?;
            }
            [b"TIME"] => {
                lines.next_or("the time")?;
                time = Some(number(lines.line().trim_ascii()).at(lines)?);
            }
            [b"BOX", b"BOUNDS", edges @ ..] => bounds = Some(read_bounds(lines, edges)?),
            [b"ATOMS", ..] => break,
            _ => {
                let allowed = "TIMESTEP, UNITS, TIME, NUMBER OF ATOMS, BOX BOUNDS or ATOMS";
                return Err(lines.refuse(excerpt(lines.line()), allowed));
            }
        }
        lines.next_or("`ITEM: ATOMS` with the names of the columns")?;
    }
    let missing = |item: &str| {
        let found = format!("particles before `ITEM: {item}`");
        lines.refuse(found, format!("`ITEM: {item}` before them"))
    };
    let n = n.ok_or_else(|| missing("NUMBER OF ATOMS"))?;
    if !wanted {
        return skip_rows(lines, n);
    }
    let (columns, style) = columns(lines.line()).at(lines)?;
    let step = Some(step.ok_or_else(|| missing("TIMESTEP"))?);
    let Bounds { low, cell } = bounds.ok_or_else(|| missing("BOX BOUNDS"))?;
    let scales = units.scales(None).at(lines)?;
    let scaled = COORDINATES[style][0].starts_with("xs");
    let place = Place { scaled, ..Place::new(low, Some(cell), scales).at(lines)? };
    let unwrapped = style < FOLDED || columns.has(Vector::Image);
    let time = time.and_then(|time| scales.time(time));
    let read = ParticleReader::read(lines, n, &columns, &place, "as `ITEM: ATOMS` says")?;
    Ok(Some(TrajectoryFrame { step, time, unwrapped, ..read }))
}

fn read_bounds(lines: &mut Lines<'_>, edges: &[&[u8]]) -> Result<Bounds, FormatError> {
    let (edges, is_tilted) = match edges {
        [b"xy", b"xz", b"yz", edges @ ..] => (edges, true),
        edges => (edges, false),
    };
    if let Some(edge) = edges.iter().find(|edge| **edge != b"pp") {
        return Err(lines.refuse(
            format!("the boundary {}", excerpt(edge)),
            "pp pp pp; boxes that are not periodic in all directions are not there yet",
        ));
    }
    let (mut low, mut high, mut tilts) = (DVec3::ZERO, DVec3::ZERO, [0.0; 3]);
    for axis in 0..3 {
        lines.next_or("where the box begins and ends")?;
        let row = match is_tilted {
            true => bound(lines.line()),
            false => bound(lines.line()).map(|[low, high]| [low, high, 0.0]),
        };
        [low[axis], high[axis], tilts[axis]] = row.at(lines)?;
    }
    Bounds::new(low, high, tilts).at(lines)
}
