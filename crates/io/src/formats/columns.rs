//! Columns of text: what stands in the line of a particle, in every format of text.

use std::ops::Range;
use std::path::Path;

use lennard_core::State;

use super::lines::{push_field, push_float, push_integer, push_lines, push_vector};
use crate::frame::{NotFinite, finite};
use crate::{FrameStyle, WriteError};

/// What one column holds, or three that belong together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Column {
    /// The number of the particle, from 1.
    Id,
    /// The number of its species, from 1.
    Type,
    Element,
    /// The number of its molecule, from 1.
    Molecule,
    Mass,
    Position,
    Image,
    Velocity,
    Force,
    Momentum,
}

impl Column {
    fn is_in(self, style: &FrameStyle) -> bool {
        match self {
            Self::Id | Self::Type | Self::Element | Self::Position => true,
            Self::Molecule => style.sites_per_molecule > 1,
            Self::Mass => style.has_masses(),
            Self::Image => style.wrapped,
            Self::Velocity => style.velocities,
            Self::Force => style.forces,
            Self::Momentum => style.for_ase,
        }
    }
}

/// The columns of a format that a style has.
pub(crate) struct Layout<'a> {
    style: &'a FrameStyle,
    columns: Vec<Column>,
    /// Their names in a header, one after the other.
    pub(crate) names: String,
    /// The length that one σ is written as.
    scale: f64,
}

impl<'a> Layout<'a> {
    /// From all columns of a format, with their names.
    pub(crate) fn new(style: &'a FrameStyle, scale: f64, all: &[(Column, &str)]) -> Self {
        let there = || all.iter().filter(|(column, _)| column.is_in(style));
        let columns = there().map(|(column, _)| *column).collect();
        Self { style, columns, names: there().map(|(_, name)| *name).collect(), scale }
    }

    /// Appends the lines of some particles.
    pub(crate) fn push_lines_of(
        &self,
        to: &mut Vec<u8>,
        path: &Path,
        state: &State,
        particles: Range<usize>,
    ) -> Result<(), WriteError> {
        let vectors = [Column::Position, Column::Velocity, Column::Force, Column::Momentum];
        let vectors = vectors.iter().filter(|vector| self.columns.contains(vector)).count();
        push_lines(to, path, particles, vectors, |text, i| self.push(text, state, i))
    }

    /// Appends the line of a particle.
    fn push(&self, to: &mut Vec<u8>, state: &State, i: usize) -> Result<(), NotFinite> {
        let Self { style, scale, .. } = *self;
        let (position, image) = style.place(&state.cell, &state.positions, i)?;
        let (species, number) = (style.species_of(i), style.number(i));
        let start = to.len();
        for column in &self.columns {
            if to.len() > start {
                to.push(b' ');
            }
            match column {
                Column::Id => push_integer(to, number + 1),
                Column::Type => push_integer(to, style.species.of(i) + 1),
                Column::Element => to.extend_from_slice(species.element.as_bytes()),
                Column::Molecule => push_integer(to, number / style.sites_per_molecule + 1),
                Column::Mass => push_float(to, species.mass),
                Column::Position => push_vector(to, finite("position", number, position * scale)?),
                Column::Image => {
                    let [x, y, z] = image.unwrap_or_default().to_array();
                    push_integer(to, x);
                    push_field(to, y);
                    push_field(to, z);
                }
                Column::Velocity => {
                    push_vector(to, finite("velocity", number, state.velocities[i] * scale)?);
                }
                Column::Force => push_vector(to, finite("force", number, state.forces[i] / scale)?),
                Column::Momentum => {
                    let momentum = species.mass * state.velocities[i] * scale;
                    push_vector(to, finite("momentum", number, momentum)?);
                }
            }
        }
        to.push(b'\n');
        Ok(())
    }
}
