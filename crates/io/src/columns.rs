//! One reader of columns: where everything of a particle stands in a line, in every format of text.

use glam::{DVec3, IVec3};

use crate::error::{Refusal, excerpt, refused};
use crate::lines::{finite, tokens};

/// Most columns that a line may have.
pub(crate) const MOST_COLUMNS: usize = 256;

/// What three columns hold together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Vector {
    Position,
    Velocity,
    Momentum,
    Force,
    Image,
}

const VECTORS: [(Vector, &str); 5] = [
    (Vector::Position, "a position"),
    (Vector::Velocity, "a velocity"),
    (Vector::Momentum, "a momentum"),
    (Vector::Force, "a force"),
    (Vector::Image, "image flags"),
];

/// What one column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Scalar {
    Id,
    Name,
    Type,
    Mass,
}

/// What a name stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Column {
    Vector(Vector),
    Component(Vector, usize),
    Scalar(Scalar),
    /// Something that is not used.
    Other,
}

/// Names of velocities and of momenta in the files of other programs.
const MOTIONS: [(Vector, &[&str]); 2] = [
    (Vector::Velocity, &["v", "vel", "velo", "velocity", "velocities"]),
    (Vector::Momentum, &["p", "mom", "momentum", "momenta"]),
];

/// Velocities or momenta by a usual name (`velo`, `Velocities`, `vx`, `vel_y`, `momenta[3]`), or something else.
pub(crate) fn motion(name: &str) -> Column {
    let name = name.to_ascii_lowercase();
    let of = |root: &str| {
        MOTIONS.iter().find(|(_, names)| names.contains(&root)).map(|(vector, _)| *vector)
    };
    if let Some(vector) = of(&name) {
        return Column::Vector(vector);
    }
    let bare = name.trim_end_matches(']');
    let axis = bare.chars().last().and_then(|c| "xyz123".find(c)).map(|at| at % 3);
    let root = bare.get(..bare.len().saturating_sub(1)).unwrap_or_default();
    match (of(root.trim_end_matches(['_', '.', '-', '['])), axis) {
        (Some(vector), Some(axis)) => Column::Component(vector, axis),
        _ => Column::Other,
    }
}

/// Where in a line everything stands.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Columns {
    width: usize,
    vectors: [[Option<usize>; 3]; VECTORS.len()],
    scalars: [Option<usize>; 4],
}

impl Columns {
    /// The layout of a format whose columns have no names.
    pub(crate) fn fixed(columns: &[Column]) -> Self {
        let mut all = Self::default();
        for column in columns {
            let once = all.add(*column, if matches!(column, Column::Vector(_)) { 3 } else { 1 });
            debug_assert!(once, "{column:?} twice");
        }
        all
    }

    /// Adds what stands next in a line; false where it stood before.
    #[must_use]
    pub(crate) fn add(&mut self, column: Column, width: usize) -> bool {
        let at = self.width;
        self.width += width;
        match column {
            Column::Other => true,
            Column::Scalar(scalar) => self.scalars[scalar as usize].replace(at).is_none(),
            Column::Component(vector, axis) => {
                self.vectors[vector as usize][axis].replace(at).is_none()
            }
            Column::Vector(vector) => {
                let before = std::mem::replace(
                    &mut self.vectors[vector as usize],
                    [Some(at), Some(at + 1), Some(at + 2)],
                );
                before == [None; 3]
            }
        }
    }

    /// Takes a vector out, which is not looked at then.
    pub(crate) fn forget(&mut self, vector: Vector) {
        self.vectors[vector as usize] = [None; 3];
    }

    /// Columns of a line.
    pub(crate) fn width(&self) -> usize {
        self.width
    }

    /// Whether a vector is there.
    pub(crate) fn has(&self, vector: Vector) -> bool {
        self.vectors[vector as usize][0].is_some()
    }

    /// Whether lines have a mass.
    pub(crate) fn has_masses(&self) -> bool {
        self.scalars[Scalar::Mass as usize].is_some()
    }

    /// The vector that has some of its three components and not all.
    pub(crate) fn in_part(&self) -> Option<&'static str> {
        let part = |(vector, _): &&(Vector, &str)| {
            let there = self.vectors[*vector as usize].iter().flatten().count();
            (1..3).contains(&there)
        };
        VECTORS.iter().find(part).map(|(_, name)| *name)
    }

    /// What a line says; `as_said` tells where its number of columns is said.
    pub(crate) fn row<'a>(&self, line: &'a [u8], as_said: &str) -> Result<Row<'a>, Refusal> {
        let mut all: [&[u8]; MOST_COLUMNS] = [&[]; MOST_COLUMNS];
        let mut found = 0;
        for token in tokens(line).take(self.width + 1) {
            if found < self.width {
                all[found] = token;
            }
            found += 1;
        }
        if found != self.width {
            return refused(
                format!("{} columns in {}", tokens(line).count(), excerpt(line)),
                format!("{} columns, {as_said}", self.width),
            );
        }
        self.row_of(&all)
    }

    /// What the pieces of a line say.
    pub(crate) fn row_of<'a>(&self, all: &[&'a [u8]]) -> Result<Row<'a>, Refusal> {
        let vector = |vector: Vector| -> Result<Option<DVec3>, Refusal> {
            let [Some(x), Some(y), Some(z)] = self.vectors[vector as usize] else {
                return Ok(None);
            };
            Ok(Some(DVec3::new(number(all[x])?, number(all[y])?, number(all[z])?)))
        };
        let image = match self.vectors[Vector::Image as usize] {
            [Some(x), Some(y), Some(z)] => {
                Some(IVec3::new(flag(all[x])?, flag(all[y])?, flag(all[z])?))
            }
            _ => None,
        };
        let scalar = |scalar: Scalar| self.scalars[scalar as usize].map(|at| all[at]);
        Ok(Row {
            id: scalar(Scalar::Id).map(particle_number).transpose()?,
            name: scalar(Scalar::Name).map(name_of_species).transpose()?,
            kind: scalar(Scalar::Type).map(name_of_species).transpose()?,
            mass: scalar(Scalar::Mass).map(number).transpose()?,
            position: vector(Vector::Position)?.unwrap_or_default(),
            velocity: vector(Vector::Velocity)?,
            momentum: vector(Vector::Momentum)?,
            force: vector(Vector::Force)?,
            image,
        })
    }
}

/// One particle as a line has it, in the units of the file.
#[derive(Debug, Default)]
pub(crate) struct Row<'a> {
    pub(crate) id: Option<u64>,
    pub(crate) name: Option<&'a str>,
    /// The type of LAMMPS.
    pub(crate) kind: Option<&'a str>,
    pub(crate) mass: Option<f64>,
    pub(crate) position: DVec3,
    pub(crate) velocity: Option<DVec3>,
    pub(crate) momentum: Option<DVec3>,
    pub(crate) force: Option<DVec3>,
    pub(crate) image: Option<IVec3>,
}

/// A finite number, or what is said of anything else.
pub(crate) fn number(token: &[u8]) -> Result<f64, Refusal> {
    finite(token).ok_or_else(|| (excerpt(token), "a finite number".to_string()))
}

fn whole<T: std::str::FromStr>(token: &[u8], allowed: &str) -> Result<T, Refusal> {
    let text = std::str::from_utf8(token).ok();
    let found = text.and_then(|text| text.parse().ok());
    found.ok_or_else(|| (excerpt(token), allowed.to_string()))
}

/// The number of a particle in its file.
pub(crate) fn particle_number(token: &[u8]) -> Result<u64, Refusal> {
    whole(token, "the number of a particle, an integer of at least 0")
}

fn flag(token: &[u8]) -> Result<i32, Refusal> {
    whole(token, "an image flag, an integer of 32 bits")
}

fn name_of_species(token: &[u8]) -> Result<&str, Refusal> {
    std::str::from_utf8(token)
        .map_err(|_| (excerpt(token), "the name of a species in UTF-8".to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn velocities_and_momenta_are_known_by_their_usual_names() {
        use Column::{Component, Other, Vector as Whole};
        for (name, wanted) in [
            ("velo", Whole(Vector::Velocity)),
            ("Velocities", Whole(Vector::Velocity)),
            ("v", Whole(Vector::Velocity)),
            ("momenta", Whole(Vector::Momentum)),
            ("vx", Component(Vector::Velocity, 0)),
            ("vel_y", Component(Vector::Velocity, 1)),
            ("velocity.z", Component(Vector::Velocity, 2)),
            ("Momenta[3]", Component(Vector::Momentum, 2)),
            ("px", Component(Vector::Momentum, 0)),
            ("volume", Other),
            ("x", Other),
            ("vorticity", Other),
            ("ξ", Other),
            ("", Other),
        ] {
            assert_eq!(motion(name), wanted, "{name}");
        }
    }
}
