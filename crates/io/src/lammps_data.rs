//! LAMMPS' data files of atoms, read.
//!
//! Source: LAMMPS documentation, "read_data command".

use std::collections::HashMap;
use std::io::BufRead;

use glam::{DVec3, IVec3};

use crate::error::excerpt;
use crate::lammps::{Bounds, Order, bound, number, triclinic, whole};
use crate::lines::{Lines, tokens};
use crate::species_reader::SpeciesReader;
use crate::xyz_header::Refusal;
use crate::{FormatError, StartConfiguration};

/// Lines that are looked at for the number of atoms, before a file is taken for something else.
pub(crate) const LINES_OF_A_HEADER: usize = 40;

/// Shortest line of a particle, `1 1 0 0 0` and its end, in bytes.
const LEAST_BYTES_A_PARTICLE: u64 = 10;

/// Counts of what atoms do not have.
const BONDED: [&[u8]; 6] = [
    b"bonds",
    b"angles",
    b"dihedrals",
    b"impropers",
    b"ellipsoids",
    b"bodies",
];

/// A line without its comment.
fn content(line: &[u8]) -> &[u8] {
    line.split(|b| *b == b'#').next().unwrap_or_default()
}

/// Whether this line of a header has the number of atoms.
pub(crate) fn is_count(line: &[u8]) -> bool {
    let mut words = tokens(content(line));
    words
        .next()
        .is_some_and(|n| n.iter().all(u8::is_ascii_digit))
        && words.next() == Some(b"atoms")
        && words.next().is_none()
}

/// What the sections of a file say.
#[derive(Default)]
struct Sections {
    n: Option<usize>,
    low: [Option<[f64; 2]>; 3],
    labels: HashMap<Vec<u8>, String>,
    masses: HashMap<String, f64>,
    ids: Vec<u64>,
    kinds: Vec<String>,
    of_particle: Vec<u16>,
    positions: Vec<DVec3>,
    images: Vec<IVec3>,
    velocities: HashMap<u64, DVec3>,
}

/// Reads the whole file; nothing of it has been read yet.
pub(crate) fn parse<R: BufRead>(mut lines: Lines<R>) -> Result<StartConfiguration, FormatError> {
    let mut all = Sections::default();
    // The first line is a title, whatever it says.
    lines.advance()?;
    let mut section = all.header(&mut lines)?;
    while let Some(name) = section {
        section = all.section(&mut lines, &name)?;
    }
    all.finish(&lines)
}

/// Goes to the next line that holds more than a comment; false at the end of the file.
fn next<R: BufRead>(lines: &mut Lines<R>) -> Result<bool, FormatError> {
    while lines.advance()? {
        if tokens(content(lines.line())).next().is_some() {
            return Ok(true);
        }
    }
    Ok(false)
}

impl Sections {
    /// Reads the header; the line of the first section is the current line then, and is given back.
    fn header<R: BufRead>(&mut self, lines: &mut Lines<R>) -> Result<Option<Vec<u8>>, FormatError> {
        while next(lines)? {
            let line = lines.line().to_vec();
            let words: Vec<&[u8]> = tokens(content(&line)).collect();
            match words.as_slice() {
                [first, ..] if first[0].is_ascii_alphabetic() => return Ok(Some(line)),
                [_, b"atoms"] => self.n = Some(self.count(lines, words[0])?),
                [_, _, b"xlo", b"xhi"] => self.low[0] = Some(self.bound(lines)?),
                [_, _, b"ylo", b"yhi"] => self.low[1] = Some(self.bound(lines)?),
                [_, _, b"zlo", b"zhi"] => self.low[2] = Some(self.bound(lines)?),
                [tilts @ .., b"xy", b"xz", b"yz"]
                    if tilts.iter().any(|t| whole::<f64>(t) != Some(0.0)) =>
                {
                    let (found, allowed) = triclinic(&line);
                    return Err(lines.refuse(found, allowed));
                }
                [n, what] if BONDED.contains(what) && *n != b"0" => {
                    return Err(lines.refuse(
                        excerpt(content(&line)),
                        "atoms alone: bonds of molecules are written in the scene",
                    ));
                }
                // Numbers of types, room for more, and tilts of zero.
                _ => {}
            }
        }
        Ok(None)
    }

    fn count<R: BufRead>(&self, lines: &Lines<R>, word: &[u8]) -> Result<usize, FormatError> {
        let n = whole::<u64>(word).filter(|n| *n > 0).ok_or_else(|| {
            lines.refuse(
                excerpt(word),
                "the number of atoms, an integer of at least 1",
            )
        })?;
        let fits = lines.check_room(n, 0, LEAST_BYTES_A_PARTICLE);
        fits.then_some(n)
            .and_then(|n| usize::try_from(n).ok())
            .ok_or_else(|| {
                lines.refuse(
                    format!("{n} atoms"),
                    format!(
                        "at most what the {} bytes left in the file can hold, {LEAST_BYTES_A_PARTICLE} bytes per atom",
                        lines.left()
                    ),
                )
            })
    }

    fn bound<R: BufRead>(&self, lines: &Lines<R>) -> Result<[f64; 2], FormatError> {
        bound(content(lines.line())).map_err(|(f, a)| lines.refuse(f, a))
    }

    /// Reads the section whose first line is the current line; gives the first line of the next one back.
    fn section<R: BufRead>(
        &mut self,
        lines: &mut Lines<R>,
        first: &[u8],
    ) -> Result<Option<Vec<u8>>, FormatError> {
        let name: Vec<&[u8]> = tokens(content(first)).collect();
        match name.as_slice() {
            [b"Atoms"] => {
                check_style(first).map_err(|(f, a)| lines.refuse(f, a))?;
                self.rows(lines, |all, row| all.atom(row))
            }
            [b"Velocities"] => self.rows(lines, |all, row| all.velocity(row)),
            [b"Masses"] => self.rows(lines, |all, row| all.mass(row)),
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
    fn rows<R: BufRead>(
        &mut self,
        lines: &mut Lines<R>,
        mut take: impl FnMut(&mut Self, &[&[u8]]) -> Result<(), Refusal>,
    ) -> Result<Option<Vec<u8>>, FormatError> {
        while next(lines)? {
            let words: Vec<&[u8]> = tokens(content(lines.line())).collect();
            if words[0][0].is_ascii_alphabetic() {
                return Ok(Some(lines.line().to_vec()));
            }
            take(self, &words).map_err(|(f, a)| lines.refuse(f, a))?;
        }
        Ok(None)
    }

    fn atom(&mut self, row: &[&[u8]]) -> Result<(), Refusal> {
        let (image, row) = match row {
            [row @ .., ix, iy, iz] if row.len() == 5 => {
                let flag = |token: &[u8]| {
                    whole::<i32>(token)
                        .ok_or_else(|| (excerpt(token), "an integer of 32 bits".to_string()))
                };
                (IVec3::new(flag(ix)?, flag(iy)?, flag(iz)?), row)
            }
            row => (IVec3::ZERO, row),
        };
        let [id, kind, x, y, z] = row else {
            return Err(wrong_row(
                row,
                "`id type x y z`, with or without `ix iy iz` (atom_style atomic)",
            ));
        };
        if Some(self.ids.len()) == self.n {
            return Err((
                format!("a row after {} atoms", self.ids.len()),
                "as many rows as the header says".into(),
            ));
        }
        let position = DVec3::new(number(x)?, number(y)?, number(z)?);
        let name = self.name_of(kind);
        let number = match self.kinds.iter().position(|known| *known == name) {
            Some(number) => number,
            None => {
                self.kinds.push(name);
                self.kinds.len() - 1
            }
        };
        self.of_particle.push(u16::try_from(number).map_err(|_| {
            let allowed = format!("at most {} types", u16::MAX);
            (format!("{} types", self.kinds.len()), allowed)
        })?);
        self.ids.push(particle_number(id)?);
        self.positions.push(position);
        self.images.push(image);
        Ok(())
    }

    fn velocity(&mut self, row: &[&[u8]]) -> Result<(), Refusal> {
        let [id, x, y, z] = row else {
            return Err(wrong_row(row, "`id vx vy vz`"));
        };
        let velocity = DVec3::new(number(x)?, number(y)?, number(z)?);
        self.velocities.insert(particle_number(id)?, velocity);
        Ok(())
    }

    fn mass(&mut self, row: &[&[u8]]) -> Result<(), Refusal> {
        let [kind, mass] = row else {
            return Err(wrong_row(row, "`type mass`"));
        };
        let mass = number(mass)
            .ok()
            .filter(|mass| *mass > 0.0)
            .ok_or_else(|| {
                (
                    format!("the mass {}", excerpt(mass)),
                    "a positive number".to_string(),
                )
            })?;
        let name = self.name_of(kind);
        self.masses.insert(name, mass);
        Ok(())
    }

    /// The label of a type, or its number.
    fn name_of(&self, kind: &[u8]) -> String {
        let number = || String::from_utf8_lossy(kind).into_owned();
        self.labels.get(kind).cloned().unwrap_or_else(number)
    }

    fn finish<R: BufRead>(self, lines: &Lines<R>) -> Result<StartConfiguration, FormatError> {
        let absent = |what: &str| lines.refuse_end(what);
        let n = self.n.ok_or_else(|| absent("the number of atoms"))?;
        let [Some([x0, x1]), Some([y0, y1]), Some([z0, z1])] = self.low else {
            return Err(absent(
                "box sides before it: `xlo xhi`, `ylo yhi`, `zlo zhi`",
            ));
        };
        let bounds = Bounds::new(DVec3::new(x0, y0, z0), DVec3::new(x1, y1, z1))
            .map_err(|(f, a)| lines.refuse(f, a))?;
        if self.ids.len() != n {
            let atoms = self.ids.len();
            return Err(absent(&format!(
                "{n} rows in the section Atoms, where it has {atoms}: the file is truncated"
            )));
        }
        let without = |kind: &&String| !self.masses.contains_key(*kind);
        if let Some(kind) = self.kinds.iter().find(without)
            && !self.masses.is_empty()
        {
            let wanted = format!("a row in the section Masses for the type {kind}");
            return Err(absent(&wanted));
        }
        let mut species = SpeciesReader::new(n);
        for kind in &self.of_particle {
            let name = &self.kinds[usize::from(*kind)];
            species
                .take(Some(name), self.masses.get(name).copied())
                .map_err(|(f, a)| lines.refuse(f, a))?;
        }
        let unfolded = self.positions.iter().zip(&self.images);
        let mut positions: Vec<DVec3> = unfolded
            .map(|(r, image)| *r - bounds.low + image.as_dvec3() * bounds.cell.lengths())
            .collect();
        if let Some(i) = positions.iter().position(|r| !r.is_finite()) {
            return Err(absent(&format!(
                "positions that stay finite, unlike the one of atom {}",
                self.ids[i]
            )));
        }
        let velocities = match self.velocities.len() {
            0 => None,
            _ => {
                let of = |id: &u64| self.velocities.get(id).copied();
                let found: Option<Vec<DVec3>> = self.ids.iter().map(of).collect();
                let wanted = "a row in the section Velocities for every atom";
                Some(found.ok_or_else(|| absent(wanted))?)
            }
        };
        let order = Order::of(&self.ids).map_err(|(f, a)| lines.refuse(f, a))?;
        order.sort(&mut positions);
        let velocities = velocities.map(|mut velocities| {
            order.sort(&mut velocities);
            velocities
        });
        order.sort(&mut species.found.of_particle);
        Ok(StartConfiguration {
            frames: 1,
            cell: bounds.cell,
            positions,
            velocities,
            step: None,
            time: None,
            species: species.found,
        })
    }
}

/// Refuses an atom style that is named behind `Atoms` and that is not read.
fn check_style(line: &[u8]) -> Result<(), Refusal> {
    let comment = line.split(|b| *b == b'#').nth(1).unwrap_or_default();
    match tokens(comment).next() {
        None | Some(b"atomic") => Ok(()),
        Some(style) => Err((
            format!("the atom style {}", excerpt(style)),
            "`atomic`, as LAMMPS writes it with atom_style atomic".into(),
        )),
    }
}

fn particle_number(id: &[u8]) -> Result<u64, Refusal> {
    let allowed = "the number of an atom, an integer of at least 0";
    whole::<u64>(id).ok_or_else(|| (excerpt(id), allowed.to_string()))
}

fn wrong_row(row: &[&[u8]], allowed: &str) -> Refusal {
    let found = format!("{} columns in {}", row.len(), excerpt(&row.join(&b' ')));
    (found, allowed.to_string())
}
