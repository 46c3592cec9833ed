//! One frame of LAMMPS' `dump custom` as text, read.
//!
//! Source: LAMMPS documentation, "dump command".

use std::collections::BTreeMap;
use std::io::BufRead;

use glam::{DVec3, IVec3};

use crate::error::excerpt;
use crate::lammps::{Bounds, Order, bound, number, triclinic, whole};
use crate::lines::{Lines, tokens};
use crate::species_reader::SpeciesReader;
use crate::xyz_header::Refusal;
use crate::{FormatError, TrajectoryFrame};

/// What the first line of a frame begins with.
pub(crate) const FIRST_WORD: &[u8] = b"ITEM:";

/// Shortest line of a particle, `0 0 0` and its end, in bytes.
const LEAST_BYTES_A_PARTICLE: u64 = 6;

/// Most columns that a line may have.
const MOST_COLUMNS: usize = 256;

/// How coordinates are written, the best for reading first.
const COORDINATES: [[&str; 3]; 4] = [
    ["xu", "yu", "zu"],
    ["xsu", "ysu", "zsu"],
    ["x", "y", "z"],
    ["xs", "ys", "zs"],
];
/// The one of them that is folded into the box, from which on image flags count.
const FOLDED: usize = 2;

/// What a frame says before its particles.
struct Header {
    step: u64,
    n: usize,
    bounds: Bounds,
    columns: Columns,
}

/// Where in a line everything stands.
struct Columns {
    width: usize,
    id: Option<usize>,
    kind: Option<usize>,
    element: Option<usize>,
    mass: Option<usize>,
    position: [usize; 3],
    scaled: bool,
    velocity: Option<[usize; 3]>,
    force: Option<[usize; 3]>,
    image: Option<[usize; 3]>,
}

impl Columns {
    fn parse(line: &[u8]) -> Result<Self, Refusal> {
        let names: Vec<&[u8]> = tokens(line).skip(2).collect();
        if names.len() > MOST_COLUMNS {
            return Err((
                format!("{} columns", names.len()),
                format!("at most {MOST_COLUMNS} columns"),
            ));
        }
        let find = |name: &str| names.iter().position(|n| *n == name.as_bytes());
        let all = |names: [&str; 3]| Some([find(names[0])?, find(names[1])?, find(names[2])?]);
        let found = COORDINATES.iter().position(|names| all(*names).is_some());
        let Some(style) = found else {
            return Err((
                excerpt(line),
                "positions among the columns: x y z, xu yu zu, xs ys zs or xsu ysu zsu".into(),
            ));
        };
        Ok(Self {
            width: names.len(),
            id: find("id"),
            kind: find("type"),
            element: find("element"),
            mass: find("mass"),
            position: all(COORDINATES[style]).expect("it was found"),
            scaled: COORDINATES[style][0].starts_with("xs"),
            velocity: all(["vx", "vy", "vz"]),
            force: all(["fx", "fy", "fz"]),
            image: all(["ix", "iy", "iz"]).filter(|_| style >= FOLDED),
        })
    }
}

/// Goes to the next line, which must be there.
fn next<R: BufRead>(lines: &mut Lines<R>, wanted: &str) -> Result<(), FormatError> {
    match lines.advance()? {
        true => Ok(()),
        false => Err(lines.refuse_end(wanted)),
    }
}

/// Reads the lines before the particles; the current line is the first.
fn header<R: BufRead>(lines: &mut Lines<R>) -> Result<Header, FormatError> {
    let (mut step, mut n, mut bounds) = (None, None, None);
    loop {
        let item = lines.line().strip_prefix(FIRST_WORD).map(<[u8]>::to_vec);
        let item = item.ok_or_else(|| lines.refuse(excerpt(lines.line()), "a line `ITEM: …`"))?;
        let words: Vec<&[u8]> = tokens(&item).collect();
        match words.as_slice() {
            [b"TIMESTEP"] => {
                next(lines, "the number of the step")?;
                let found = tokens(lines.line()).next().and_then(whole::<u64>);
                step = Some(found.ok_or_else(|| {
                    lines.refuse(excerpt(lines.line()), "an integer of at least 0")
                })?);
            }
            [b"NUMBER", b"OF", b"ATOMS"] => {
                next(lines, "the number of particles")?;
                n = Some(lines.particle_count(1, LEAST_BYTES_A_PARTICLE)?);
            }
            [b"UNITS"] => {
                next(lines, "the units")?;
                if tokens(lines.line()).next() != Some(b"lj") {
                    let found = format!("units {}", excerpt(lines.line()));
                    return Err(lines.refuse(found, "lj (reduced units), or no such entry"));
                }
            }
            [b"TIME"] => next(lines, "the time")?,
            [b"BOX", b"BOUNDS", edges @ ..] => bounds = Some(read_bounds(lines, edges)?),
            [b"ATOMS", ..] => {
                let columns = Columns::parse(lines.line()).map_err(|(f, a)| lines.refuse(f, a))?;
                let missing = |item: &str| {
                    let found = format!("particles before `ITEM: {item}`");
                    lines.refuse(found, format!("`ITEM: {item}` before them"))
                };
                return Ok(Header {
                    step: step.ok_or_else(|| missing("TIMESTEP"))?,
                    n: n.ok_or_else(|| missing("NUMBER OF ATOMS"))?,
                    bounds: bounds.ok_or_else(|| missing("BOX BOUNDS"))?,
                    columns,
                });
            }
            _ => {
                let allowed = "TIMESTEP, UNITS, TIME, NUMBER OF ATOMS, BOX BOUNDS or ATOMS";
                return Err(lines.refuse(excerpt(lines.line()), allowed));
            }
        }
        next(lines, "`ITEM: ATOMS` with the names of the columns")?;
    }
}

fn read_bounds<R: BufRead>(lines: &mut Lines<R>, edges: &[&[u8]]) -> Result<Bounds, FormatError> {
    if edges.iter().any(|word| word.contains(&b'x')) {
        let (found, allowed) = triclinic(lines.line());
        return Err(lines.refuse(found, allowed));
    }
    if let Some(edge) = edges.iter().find(|edge| **edge != b"pp") {
        return Err(lines.refuse(
            format!("the boundary {}", excerpt(edge)),
            "pp pp pp; boxes that are not periodic in all directions are not there yet",
        ));
    }
    let (mut low, mut high) = (DVec3::ZERO, DVec3::ZERO);
    for axis in 0..3 {
        next(lines, "where the box begins and ends")?;
        [low[axis], high[axis]] = bound(lines.line()).map_err(|(f, a)| lines.refuse(f, a))?;
    }
    Bounds::new(low, high).map_err(|(f, a)| lines.refuse(f, a))
}

fn missing(row: usize, n: usize) -> String {
    format!("particle {row} of {n}: the frame is truncated")
}

/// Passes over the frame whose first line is the current line.
pub(crate) fn skip_frame<R: BufRead>(lines: &mut Lines<R>) -> Result<(), FormatError> {
    let n = header(lines)?.n;
    for row in 1..=n {
        next(lines, &missing(row, n))?;
    }
    Ok(())
}

/// Reads the frame whose first line is the current line.
pub(crate) fn parse_frame<R: BufRead>(
    lines: &mut Lines<R>,
) -> Result<TrajectoryFrame, FormatError> {
    let Header {
        step,
        n,
        bounds,
        columns,
    } = header(lines)?;
    let least = 2 * columns.width as u64;
    if !lines.check_room(n as u64, 0, least) {
        let allowed = format!(
            "at most what the {} bytes left in the file can hold: the count is wrong or the frame is truncated",
            lines.left()
        );
        return Err(lines.refuse(format!("{n} particles"), allowed));
    }
    let (mut ids, mut positions) = (Vec::with_capacity(n), Vec::with_capacity(n));
    let (mut velocities, mut forces) = (Vec::new(), Vec::new());
    let mut species = SpeciesReader::new(n);
    for row in 1..=n {
        next(lines, &missing(row, n))?;
        let particle = parse_particle(lines.line(), &columns, &bounds);
        let particle = particle.map_err(|(f, a)| lines.refuse(f, a))?;
        ids.extend(particle.id);
        positions.push(particle.position);
        velocities.extend(particle.velocity);
        forces.extend(particle.force);
        species
            .take(particle.name, particle.mass)
            .map_err(|(f, a)| lines.refuse(f, a))?;
    }
    let order = Order::of(&ids).map_err(|(f, a)| lines.refuse(f, a))?;
    order.sort(&mut positions);
    order.sort(&mut velocities);
    order.sort(&mut forces);
    order.sort(&mut species.found.of_particle);
    Ok(TrajectoryFrame {
        cell: Some(bounds.cell),
        positions,
        velocities: columns.velocity.map(|_| velocities),
        forces: columns.force.map(|_| forces),
        species: species.found,
        step: Some(step),
        time: None,
        info: BTreeMap::new(),
    })
}

/// One line of a frame.
struct Particle<'a> {
    id: Option<u64>,
    name: Option<&'a str>,
    mass: Option<f64>,
    position: DVec3,
    velocity: Option<DVec3>,
    force: Option<DVec3>,
}

fn parse_particle<'a>(
    line: &'a [u8],
    columns: &Columns,
    bounds: &Bounds,
) -> Result<Particle<'a>, Refusal> {
    let mut all: [&[u8]; MOST_COLUMNS] = [&[]; MOST_COLUMNS];
    let mut width = 0;
    for token in tokens(line) {
        if width == columns.width {
            width += 1;
            break;
        }
        all[width] = token;
        width += 1;
    }
    if width != columns.width {
        return Err((
            format!("{} columns in {}", tokens(line).count(), excerpt(line)),
            format!("{} columns, as `ITEM: ATOMS` says", columns.width),
        ));
    }
    let vector = |at: [usize; 3]| -> Result<DVec3, Refusal> {
        Ok(DVec3::new(
            number(all[at[0]])?,
            number(all[at[1]])?,
            number(all[at[2]])?,
        ))
    };
    let integer = |at: usize, allowed: &str| {
        whole::<u64>(all[at]).ok_or_else(|| (excerpt(all[at]), allowed.to_string()))
    };
    let mut position = vector(columns.position)?;
    let sides = bounds.cell.lengths();
    if columns.scaled {
        position *= sides;
    } else {
        position -= bounds.low;
    }
    if let Some(at) = columns.image {
        let flag = |at: usize| {
            whole::<i32>(all[at])
                .ok_or_else(|| (excerpt(all[at]), "an integer of 32 bits".to_string()))
        };
        let image = IVec3::new(flag(at[0])?, flag(at[1])?, flag(at[2])?);
        position += image.as_dvec3() * sides;
    }
    if !position.is_finite() {
        return Err((excerpt(line), "a position that stays finite".into()));
    }
    let name = columns.element.or(columns.kind).map(|at| {
        std::str::from_utf8(all[at]).map_err(|_| {
            (
                excerpt(all[at]),
                "the name of a species in UTF-8".to_string(),
            )
        })
    });
    Ok(Particle {
        id: columns
            .id
            .map(|at| integer(at, "the number of a particle, an integer of at least 0"))
            .transpose()?,
        name: name.transpose()?,
        mass: columns.mass.map(|at| number(all[at])).transpose()?,
        position,
        velocity: columns.velocity.map(vector).transpose()?,
        force: columns.force.map(vector).transpose()?,
    })
}
