//! What a frame is made of, and how frames are written.

use std::ops::Range;
use std::path::Path;

use glam::{DVec3, IVec3};
use lennard_core::{Own, PeriodicBox, Species, SpeciesTable, State};

use crate::WriteError;

/// Positions of XTC are multiples of this share of a σ where nothing else is asked for: an error of 5·10⁻⁵ σ at most.
pub const DEFAULT_PRECISION: f64 = 1e4;

/// How frames are written.
///
/// The dialect of extended XYZ has one header line and one line a particle:
///
/// ```text
/// 864
/// Lattice="Lx 0.0 0.0 0.0 Ly 0.0 0.0 0.0 Lz" Properties=species:S:1:pos:R:3:velo:R:3:map_shift:I:3 pbc="T T T" Time=0.5 Step=100 potential_energy=-5.5 units=lj
/// Ar x y z vx vy vz ix iy iz
/// ```
///
/// Floating-point numbers are the shortest text that reads back to the same bits. Velocities and
/// unwrapped positions are therefore exact. A wrapped position with its image flags, r = w + k·L, is exact
/// too, with two exceptions: −L/2 < r < 0, and r within rounding of a face. There the wrapped coordinate
/// has fewer bits below the point than r had. The position read back then differs by less than one unit in
/// the last place of L (or of r, where r is larger). A site that is folded with its molecule is such a position too.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameStyle {
    /// The species, whose chemical symbol (or `X`) stands in the first column: readers refuse anything else. The header of a
    /// mixture names the species of each symbol (`species_names="Ar=A Kr=B"`), and each line has a mass (`masses:R:1`).
    pub species: SpeciesTable,
    /// Whether velocities are written (`velo:R:3`, σ/τ).
    pub velocities: bool,
    /// Whether forces are written (`forces:R:3`, ε/σ).
    pub forces: bool,
    /// Whether positions are folded into the home box `[0, L)` and image flags written beside
    /// (`map_shift:I:3`, r = pos + map_shift·L); otherwise positions are written as they are.
    pub wrapped: bool,
    /// Whether extended XYZ holds too what ASE looks for: momenta (`momenta:R:3`, m σ/τ), masses (`masses:R:1`, m), and the
    /// potential energy (`energy`, ε for the whole system).
    pub for_ase: bool,
    /// The length that one σ is written as. 1 writes reduced units; 3.405 writes the Å of argon, and the
    /// header then says `length_scale=3.405`. Positions, box and velocities (length/τ) are multiplied by
    /// it, forces (ε/length) divided; our own reader takes it out again, to within rounding.
    pub length_scale: f64,
    /// Positions of XTC are whole multiples of σ over this number, where coordinates are not too large for it.
    pub precision: f64,
    /// Consecutive particles that make up a molecule; at least 1. Above 1, each line ends with the number of its molecule, from 1
    /// (`molecule:I:1`).
    pub sites_per_molecule: usize,
    /// Which of all particles the states of frames have, where ranks share them: each rank then writes the lines of its own.
    pub own: Option<Own>,
    /// Whether the sites of a molecule are folded into the box together, by the image flags of its first site. The others may
    /// then stand outside.
    pub whole: bool,
}

impl Default for FrameStyle {
    fn default() -> Self {
        Self {
            species: SpeciesTable::one(Species::unnamed(), 0),
            velocities: true,
            forces: false,
            wrapped: true,
            for_ase: false,
            length_scale: 1.0,
            precision: DEFAULT_PRECISION,
            sites_per_molecule: 1,
            own: None,
            whole: true,
        }
    }
}

/// What a frame holds.
#[derive(Debug, Clone, Copy)]
pub struct Frame<'a> {
    /// Box, positions, velocities, forces, step and time.
    pub state: &'a State,
    /// More numbers for the header line (`potential_energy`, ε for the whole system unless the
    /// caller says otherwise). Not `energy`, `free_energy`, `stress`: ASE takes those for eV.
    pub extra: &'a [(&'a str, f64)],
}

/// Chemical symbols of the elements 1 to 118.
const ELEMENTS: &str = "H He Li Be B C N O F Ne Na Mg Al Si P S Cl Ar K Ca Sc Ti V Cr Mn Fe Co Ni Cu \
    Zn Ga Ge As Se Br Kr Rb Sr Y Zr Nb Mo Tc Ru Rh Pd Ag Cd In Sn Sb Te I Xe Cs Ba La Ce Pr Nd Pm \
    Sm Eu Gd Tb Dy Ho Er Tm Yb Lu Hf Ta W Re Os Ir Pt Au Hg Tl Pb Bi Po At Rn Fr Ra Ac Th Pa U Np \
    Pu Am Cm Bk Cf Es Fm Md No Lr Rf Db Sg Bh Hs Mt Ds Rg Cn Nh Fl Mc Lv Ts Og";

/// Whether readers know this particle name: a chemical symbol, or `X` for none.
#[must_use]
pub fn is_element_symbol(name: &str) -> bool {
    name == "X" || ELEMENTS.split_ascii_whitespace().any(|symbol| symbol == name)
}

/// What cannot be written of a file at `path`.
pub(crate) fn unwritable(
    path: &Path,
    what: &'static str,
    found: impl Into<String>,
    allowed: impl Into<String>,
) -> WriteError {
    WriteError::Unwritable {
        path: path.to_path_buf(),
        what,
        found: found.into(),
        allowed: allowed.into(),
    }
}

impl FrameStyle {
    /// Checks what does not depend on the frame.
    pub(crate) fn check(&self, path: &Path) -> Result<(), WriteError> {
        for Species { element, .. } in self.species.all() {
            if !is_element_symbol(element) {
                return Err(unwritable(
                    path,
                    "element",
                    format!("`{}`", element.escape_debug()),
                    "a chemical symbol (Ar, Kr, …) or X",
                ));
            }
        }
        for (what, number) in [("length scale", self.length_scale), ("precision", self.precision)] {
            if !(number.is_finite() && number > 0.0) {
                let found = number.to_string();
                return Err(unwritable(path, what, found, "a finite positive number"));
            }
        }
        Ok(())
    }

    /// Checks that a frame has all that the style asks for.
    pub(crate) fn check_frame(&self, path: &Path, frame: &Frame<'_>) -> Result<(), WriteError> {
        let state = frame.state;
        let n = state.len();
        if n == 0 {
            return Err(unwritable(path, "number of particles", "0", "at least 1"));
        }
        // A state that was set aside has none.
        let has_forces = self.forces || !state.forces.is_empty();
        let with_species = self.species.of_particles().map_or(n, <[u8]>::len);
        if with_species != n {
            return Err(unwritable(
                path,
                "species of the particles",
                format!("{with_species} for {n} particles"),
                "one for every particle",
            ));
        }
        if state.velocities.len() != n || has_forces && state.forces.len() != n {
            return Err(unwritable(
                path,
                "arrays of the state",
                format!(
                    "{n} positions, {} velocities, {} forces",
                    state.velocities.len(),
                    state.forces.len()
                ),
                "one of each for every particle",
            ));
        }
        Ok(())
    }

    /// The number of the particle with an index in the arrays of a frame.
    pub(crate) fn number(&self, i: usize) -> usize {
        i + self.own.as_ref().map_or(0, Own::first)
    }

    /// The number of all particles, where a frame has `n`.
    pub(crate) fn all(&self, n: usize) -> usize {
        self.own.as_ref().map_or(n, Own::all)
    }

    /// Whether what stands before all particles is written here.
    pub(crate) fn begins(&self) -> bool {
        self.own.as_ref().is_none_or(|own| own.first() == 0)
    }

    /// Whether what stands behind all particles is written here.
    pub(crate) fn ends(&self) -> bool {
        self.own.as_ref().is_none_or(|own| own.numbers().end == own.all())
    }

    /// Lets rank 0 take the text of all ranks, one after another, in pieces of so many of the particles that are here. Each piece is made
    /// in a buffer, unless `checked` is an error.
    ///
    /// # Errors
    /// The first error here; [`WriteError::Elsewhere`] where another rank has one.
    pub(crate) fn pass(
        &self,
        path: &Path,
        checked: Result<(), WriteError>,
        (n, of_piece): (usize, usize),
        buffer: &mut Vec<u8>,
        mut push: impl FnMut(&mut Vec<u8>, Range<usize>) -> Result<(), WriteError>,
        take: impl FnMut(&[u8]),
    ) -> Result<(), WriteError> {
        let own = self.own.clone().unwrap_or_else(|| Own::all_of(n));
        let mut done = checked;
        let make = |range, text: &mut Vec<u8>| {
            if done.is_ok() {
                done = push(text, range);
            }
        };
        own.pass_texts((n, of_piece), buffer, make, take);
        let failed = own.team().is_some_and(|team| team.any(done.is_err()));
        done?;
        if failed {
            return Err(WriteError::Elsewhere { path: path.to_path_buf() });
        }
        Ok(())
    }

    /// Whether lines have a mass: where not all masses are 1, and where ASE would take the mass of the element.
    pub(crate) fn has_masses(&self) -> bool {
        self.for_ase || self.species.is_mixture() || self.species.species(0).mass != 1.0
    }

    /// The species of a particle.
    pub(crate) fn species_of(&self, i: usize) -> &Species {
        self.species.species(self.species.of(i))
    }

    /// Position of a particle in σ, folded into the box with its image flags where the style says so: alone, or with its molecule.
    #[inline]
    pub(crate) fn place(
        &self,
        cell: &PeriodicBox,
        positions: &[DVec3],
        i: usize,
    ) -> Result<(DVec3, Option<IVec3>), NotFinite> {
        let position = finite("position", self.number(i), positions[i])?;
        if !self.wrapped {
            return Ok((position, None));
        }
        let first = match self.whole {
            true => i - i % self.sites_per_molecule,
            false => i,
        };
        let (mut wrapped, image) = cell.split(positions[first]);
        if first != i {
            wrapped = position - image.as_dvec3() * cell.lengths();
        }
        // The conversion to 32 bits saturates there: the flag would be wrong.
        if let Some(axis) = (0..3).find(|&a| matches!(image[a], i32::MIN | i32::MAX)) {
            let particle = self.number(i);
            return Err(NotFinite { quantity: "position", particle, value: position[axis] });
        }
        Ok((wrapped, Some(image)))
    }
}

/// A number of a particle that is not written.
pub(crate) struct NotFinite {
    quantity: &'static str,
    particle: usize,
    value: f64,
}

impl NotFinite {
    /// As the error of a file.
    pub(crate) fn in_file(self, path: &Path) -> WriteError {
        WriteError::NotFinite {
            path: path.to_path_buf(),
            quantity: self.quantity,
            particle: self.particle,
            value: self.value,
        }
    }
}

/// The vector of particle `i`, where all its components are finite.
#[inline]
pub(crate) fn finite(quantity: &'static str, i: usize, vector: DVec3) -> Result<DVec3, NotFinite> {
    match vector.to_array().iter().find(|c| !c.is_finite()) {
        None => Ok(vector),
        Some(&value) => Err(NotFinite { quantity, particle: i, value }),
    }
}
