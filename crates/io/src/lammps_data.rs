//! LAMMPS' data files of atoms, read.
//!
//! Source: LAMMPS documentation, "read_data command".

use std::collections::HashMap;

use glam::DVec3;

use crate::columns::{Column, Columns, Scalar, Vector, number, particle_number};
use crate::error::{Refusal, excerpt, refused};
use crate::lammps::{Bounds, bound};
use crate::lines::{At, Lines, tokens};
use crate::particles::{ParticleReader, Place, mass, velocity};
use crate::units::{FileUnits, Scales, stated};
use crate::{FormatError, TrajectoryFrame};

/// Lines that are looked at for the number of atoms, before a file is taken for something else.
pub(crate) const LINES_OF_A_HEADER: usize = 40;

/// Shortest line of a particle, `1 1 0 0 0` and its end, in bytes.
const LEAST_BYTES_A_PARTICLE: u64 = 10;

/// Counts of what atoms do not have.
const BONDED: [&[u8]; 6] =
    [b"bonds", b"angles", b"dihedrals", b"impropers", b"ellipsoids", b"bodies"];

/// A line without its comment.
fn content(line: &[u8]) -> &[u8] {
    line.split(|b| *b == b'#').next().unwrap_or_default()
}

/// Whether this line of a header has the number of atoms.
pub(crate) fn is_count(line: &[u8]) -> bool {
    let mut words = tokens(content(line));
    words.next().is_some_and(|n| n.iter().all(u8::is_ascii_digit))
        && words.next() == Some(b"atoms")
        && words.next().is_none()
}

/// What the sections of a file say.
#[derive(Default)]
struct Sections {
    units: FileUnits,
    n: Option<usize>,
    types: Option<usize>,
    low: [Option<[f64; 2]>; 3],
    /// The tilts xy, xz and yz, and their line.
    tilts: Option<([f64; 3], u64)>,
    labels: HashMap<Vec<u8>, String>,
    masses: HashMap<String, f64>,
    atoms: Option<Atoms>,
    velocities: HashMap<u64, DVec3>,
}

/// The section `Atoms`.
struct Atoms {
    place: Place,
    without_image: Columns,
    with_image: Columns,
    rows: usize,
    particles: ParticleReader,
}

/// Reads the whole file; nothing of it has been read yet.
pub(crate) fn parse(
    mut lines: Lines<'_>,
    units: FileUnits,
) -> Result<TrajectoryFrame, FormatError> {
    let mut all = Sections { units, ..Sections::default() };
    // The first line is a title, whatever it says of anything but units.
    lines.advance()?;
    all.check_units(&lines, lines.line())?;
    let mut section = all.header(&mut lines)?;
    while let Some(name) = section {
        section = all.section(&mut lines, &name)?;
    }
    all.finish(&lines)
}

impl Sections {
    /// Goes to the next line that holds more than a comment; false at the end of the file.
    fn next(&mut self, lines: &mut Lines<'_>) -> Result<bool, FormatError> {
        while lines.advance()? {
            if let Some(at) = lines.line().iter().position(|b| *b == b'#') {
                self.check_units(lines, &lines.line()[at..])?;
            }
            if tokens(content(lines.line())).next().is_some() {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// The scales for the units that a title or comment states.
    fn check_units(&mut self, lines: &Lines<'_>, text: &[u8]) -> Result<Scales, FormatError> {
        let said = stated(&String::from_utf8_lossy(text));
        let before = self.units;
        let scales = self.units.scales(said.as_deref()).at(lines)?;
        match self.atoms.is_some() && self.units != before {
            false => Ok(scales),
            true => Err(lines.refuse(
                format!(
                    "units {} behind the particles",
                    excerpt(said.unwrap_or_default().as_bytes())
                ),
                "units in the title, or in a comment before the section Atoms",
            )),
        }
    }

    /// Reads the header; the line of the first section is the current line then, and is given back.
    fn header(&mut self, lines: &mut Lines<'_>) -> Result<Option<Vec<u8>>, FormatError> {
        while self.next(lines)? {
            let line = lines.line().to_vec();
            let words: Vec<&[u8]> = tokens(content(&line)).collect();
            match words.as_slice() {
                [first, ..] if first[0].is_ascii_alphabetic() => return Ok(Some(line)),
                [n, b"atoms"] => self.n = Some(lines.count(n, 0, LEAST_BYTES_A_PARTICLE)?),
                [n, b"atom", b"types"] => {
                    self.types = std::str::from_utf8(n).ok().and_then(|n| n.parse().ok())
                }
                [_, _, b"xlo", b"xhi"] => self.low[0] = Some(self.bound(lines)?),
                [_, _, b"ylo", b"yhi"] => self.low[1] = Some(self.bound(lines)?),
                [_, _, b"zlo", b"zhi"] => self.low[2] = Some(self.bound(lines)?),
                [_, _, _, b"xy", b"xz", b"yz"] => {
                    self.tilts = Some((self.bound(lines)?, lines.number()));
                }
                [n, what] if BONDED.contains(what) && *n != b"0" => {
                    return Err(lines.refuse(
                        excerpt(content(&line)),
                        "atoms alone: bonds of molecules are written in the scene",
                    ));
                }
                // Numbers of types, room for more.
                _ => {}
            }
        }
        Ok(None)
    }

    fn bound<const N: usize>(&self, lines: &Lines<'_>) -> Result<[f64; N], FormatError> {
        bound(content(lines.line())).at(lines)
    }

    /// Reads the section whose first line is the current line; gives the first line of the next one back.
    fn section(
        &mut self,
        lines: &mut Lines<'_>,
        first: &[u8],
    ) -> Result<Option<Vec<u8>>, FormatError> {
        let name: Vec<&[u8]> = tokens(content(first)).collect();
        match name.as_slice() {
            [b"Atoms"] => {
                check_style(first).at(lines)?;
                self.atoms = Some(self.atoms_of(lines)?);
                self.rows(lines, Self::atom)
            }
            [b"Velocities"] => self.rows(lines, Self::velocity),
            [b"Masses"] => self.rows(lines, Self::mass),
            [b"Atom", b"Type", b"Labels"] => self.rows(lines, |all, row| {
                let [number, label] = row else {
                    return Err(wrong_row(row, "`type label`"));
                };
                let label = String::from_utf8_lossy(label).into_owned();
                all.labels.insert(number.to_vec(), label);
                Ok(())
            }),
            // The potential is the scene's.
            [.., b"Coeffs"] => self.rows(lines, |_, _| Ok(())),
            _ => Err(lines.refuse(
                format!("the section {}", excerpt(content(first))),
                "Masses, Atoms, Velocities, Atom Type Labels, and Coeffs, which are passed over",
            )),
        }
    }

    /// Hands the rows of a section to `take`, up to the first line of the next one.
    fn rows(
        &mut self,
        lines: &mut Lines<'_>,
        mut take: impl FnMut(&mut Self, &[&[u8]]) -> Result<(), Refusal>,
    ) -> Result<Option<Vec<u8>>, FormatError> {
        while self.next(lines)? {
            let words: Vec<&[u8]> = tokens(content(lines.line())).collect();
            if words[0][0].is_ascii_alphabetic() {
                return Ok(Some(lines.line().to_vec()));
            }
            take(self, &words).at(lines)?;
        }
        Ok(None)
    }

    /// The section `Atoms` before its first row.
    fn atoms_of(&mut self, lines: &Lines<'_>) -> Result<Atoms, FormatError> {
        let n = self
            .n
            .ok_or_else(|| lines.refuse("the section Atoms", "the number of atoms before it"))?;
        let [Some([x0, x1]), Some([y0, y1]), Some([z0, z1])] = self.low else {
            let allowed = "box sides before it: `xlo xhi`, `ylo yhi`, `zlo zhi`";
            return Err(lines.refuse("the section Atoms", allowed));
        };
        if self.atoms.is_some() {
            return Err(lines.refuse("a second section Atoms", "one of them"));
        }
        let scales = self.units.scales(None).at(lines)?;
        let (low, high) = (DVec3::new(x0, y0, z0), DVec3::new(x1, y1, z1));
        let (tilts, line) = self.tilts.unwrap_or(([0.0; 3], lines.number()));
        let bounds = Bounds::new(low, high, tilts).map_err(|(f, a)| lines.refuse_at(line, f, a))?;
        let place = Place::new(bounds.low, Some(bounds.cell), scales);
        let columns = [
            Column::Scalar(Scalar::Id),
            Column::Scalar(Scalar::Type),
            Column::Vector(Vector::Position),
        ];
        let without_image = Columns::fixed(&columns);
        Ok(Atoms {
            place: place.at(lines)?,
            with_image: Columns::fixed(&[&columns[..], &[Column::Vector(Vector::Image)]].concat()),
            particles: ParticleReader::new(n, &without_image),
            without_image,
            rows: 0,
        })
    }

    fn atom(&mut self, row: &[&[u8]]) -> Result<(), Refusal> {
        let atoms = self.atoms.as_mut().expect("the section has begun");
        let layouts = [&atoms.without_image, &atoms.with_image];
        let columns = layouts.into_iter().find(|columns| columns.width() == row.len());
        let columns = columns.ok_or_else(|| {
            wrong_row(row, "`id type x y z`, with or without `ix iy iz` (atom_style atomic)")
        })?;
        if Some(atoms.rows) == self.n {
            return refused(
                format!("a row after {} atoms", atoms.rows),
                "as many rows as the header says",
            );
        }
        let mut read = columns.row_of(row)?;
        let number = read.kind.and_then(|kind| kind.parse::<usize>().ok());
        if let (Some(number), Some(types)) = (number, self.types)
            && number > types
        {
            return refused(
                format!("the type {number}"),
                format!("types up to {types}, as the header says"),
            );
        }
        read.kind =
            read.kind.map(|kind| self.labels.get(kind.as_bytes()).map_or(kind, String::as_str));
        atoms.rows += 1;
        atoms.particles.take(read, &atoms.place)
    }

    fn velocity(&mut self, row: &[&[u8]]) -> Result<(), Refusal> {
        let [id, x, y, z] = row else {
            return Err(wrong_row(row, "`id vx vy vz`"));
        };
        let found = DVec3::new(number(x)?, number(y)?, number(z)?);
        let found = velocity(self.units.scales(None)?.velocity(found)?)?;
        once(self.velocities.insert(particle_number(id)?, found), id, "velocity")
    }

    fn mass(&mut self, row: &[&[u8]]) -> Result<(), Refusal> {
        let [kind, found] = row else {
            return Err(wrong_row(row, "`type mass`"));
        };
        let found = mass(self.units.scales(None)?.mass(number(found)?))?;
        once(self.masses.insert(self.name_of(kind), found), kind, "mass")
    }

    /// The label of a type, or its number.
    fn name_of(&self, kind: &[u8]) -> String {
        let number = || String::from_utf8_lossy(kind).into_owned();
        self.labels.get(kind).cloned().unwrap_or_else(number)
    }

    fn finish(self, lines: &Lines<'_>) -> Result<TrajectoryFrame, FormatError> {
        let absent = |what: &str| lines.refuse_end(what);
        let n = self.n.ok_or_else(|| absent("the number of atoms"))?;
        let atoms = self.atoms.ok_or_else(|| absent("the section Atoms"))?;
        if atoms.rows != n {
            let rows = atoms.rows;
            return Err(absent(&format!(
                "{n} rows in the section Atoms, where it has {rows}: the file is truncated"
            )));
        }
        let mut found = atoms.particles.finish().at(lines)?;
        if !self.masses.is_empty() {
            let of = |kind: &String| {
                let wanted = || format!("a row in the section Masses for the type {kind}");
                self.masses.get(kind).copied().ok_or_else(|| absent(&wanted()))
            };
            found.species.masses = found.species.names.iter().map(of).collect::<Result<_, _>>()?;
        }
        if !self.velocities.is_empty() {
            let of = |id: &u64| self.velocities.get(id).copied();
            let velocities: Option<Vec<DVec3>> = found.ids.iter().map(of).collect();
            let velocities = velocities.filter(|_| self.velocities.len() == n);
            let wanted = "a row in the section Velocities for every atom";
            found.velocities = Some(velocities.ok_or_else(|| absent(wanted))?);
        }
        Ok(TrajectoryFrame { cell: atoms.place.cell, ..found })
    }
}

/// Refuses an atom style that is named behind `Atoms` and that is not read.
fn check_style(line: &[u8]) -> Result<(), Refusal> {
    let comment = line.split(|b| *b == b'#').nth(1).unwrap_or_default();
    match tokens(comment).next() {
        None | Some(b"atomic") => Ok(()),
        Some(style) => refused(
            format!("the atom style {}", excerpt(style)),
            "`atomic`, as LAMMPS writes it with atom_style atomic",
        ),
    }
}

/// Refuses a second row for one thing.
fn once<T>(before: Option<T>, of: &[u8], what: &str) -> Result<(), Refusal> {
    match before {
        None => Ok(()),
        Some(_) => refused(format!("a second {what} of {}", excerpt(of)), "one row for each"),
    }
}

fn wrong_row(row: &[&[u8]], allowed: &str) -> Refusal {
    let found = format!("{} columns in {}", row.len(), excerpt(&row.join(&b' ')));
    (found, allowed.to_string())
}
