//! One frame of extended XYZ as text.

use std::path::Path;

use glam::DVec3;
use lennard_core::{Species, SpeciesTable, State};
use rayon::prelude::*;

use crate::WriteError;
use crate::text::{push_float, push_integer};

/// Particles formatted by one task: enough to be worth a task, little enough to balance.
const PARTICLES_A_TASK: usize = 2048;

/// Tasks formatted before their text is joined: bounds the memory besides the frame itself to a few MiB.
const TASKS_A_ROUND: usize = 32;

/// Typical length of a vector as text, three numbers of up to 20 characters: a first guess only.
const BYTES_A_VECTOR: usize = 60;

/// How frames are written.
///
/// The dialect, one header line and one line a particle:
///
/// ```text
/// 864
/// Lattice="Lx 0.0 0.0 0.0 Ly 0.0 0.0 0.0 Lz" Properties=species:S:1:pos:R:3:velo:R:3:map_shift:I:3 pbc="T T T" Time=0.5 Step=100 potential_energy=-5.5 units=lj
/// Ar x y z vx vy vz ix iy iz
/// ```
///
/// Floating-point numbers are the shortest text that reads back to the same bits. Velocities and
/// unwrapped positions are therefore exact. A wrapped position with its image flags, r = w + k·L, is exact
/// too, but where −L/2 < r < 0, or where r lies within rounding of a face: there the wrapped
/// coordinate has fewer bits below the point than r had, and the position read back differs by less
/// than one unit in the last place of L (or of r, where that is larger).
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
    /// The length that one σ is written as. 1 writes reduced units; 3.405 writes the Å of argon, and the
    /// header then says `length_scale=3.405`. Positions, box and velocities (length/τ) are multiplied by
    /// it, forces (ε/length) divided; our own reader takes it out again, to within rounding.
    pub length_scale: f64,
    /// Consecutive particles that make up a molecule. Above 1, each line ends with the number of its molecule, from 1
    /// (`molecule:I:1`).
    pub sites_per_molecule: usize,
}

impl Default for FrameStyle {
    fn default() -> Self {
        Self {
            species: SpeciesTable::one(Species::unnamed(), 0),
            velocities: true,
            forces: false,
            wrapped: true,
            length_scale: 1.0,
            sites_per_molecule: 1,
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
    name == "X"
        || ELEMENTS
            .split_ascii_whitespace()
            .any(|symbol| symbol == name)
}

/// Keys of the header that the dialect itself uses or that readers take for something else.
const TAKEN_KEYS: [&str; 12] = [
    "species_names",
    "Lattice",
    "Properties",
    "pbc",
    "Time",
    "Step",
    "units",
    "length_scale",
    "energy",
    "free_energy",
    "stress",
    "virial",
];

fn is_plain_key(key: &str) -> bool {
    key.starts_with(|c: char| c.is_ascii_alphabetic())
        && key.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
        && !TAKEN_KEYS.contains(&key)
}

impl FrameStyle {
    /// Checks what does not depend on the frame.
    pub(crate) fn check(&self, path: &Path) -> Result<(), WriteError> {
        let refuse = |what, found: String, allowed: &str| WriteError::Unwritable {
            path: path.to_path_buf(),
            what,
            found,
            allowed: allowed.into(),
        };
        for Species { element, .. } in self.species.all() {
            if !is_element_symbol(element) {
                return Err(refuse(
                    "element",
                    format!("`{}`", element.escape_debug()),
                    "a chemical symbol (Ar, Kr, …) or X",
                ));
            }
        }
        if !(self.length_scale.is_finite() && self.length_scale > 0.0) {
            return Err(refuse(
                "length scale",
                self.length_scale.to_string(),
                "a finite positive number",
            ));
        }
        Ok(())
    }

    /// Whether lines have a mass: where not all masses are 1.
    fn has_masses(&self) -> bool {
        self.species.is_mixture() || self.species.species(0).mass != 1.0
    }
}

/// Appends the frame to `to`; `path` is for messages.
pub(crate) fn push_frame(
    to: &mut Vec<u8>,
    path: &Path,
    style: &FrameStyle,
    frame: &Frame<'_>,
) -> Result<(), WriteError> {
    let state = frame.state;
    let n = state.len();
    let refuse = |what, found: String, allowed: &str| WriteError::Unwritable {
        path: path.to_path_buf(),
        what,
        found,
        allowed: allowed.into(),
    };
    if n == 0 {
        return Err(refuse("number of particles", "0".into(), "at least 1"));
    }
    // A state that was set aside has none.
    let has_forces = style.forces || !state.forces.is_empty();
    let with_species = style.species.of_particles().map_or(n, <[u8]>::len);
    if with_species != n {
        return Err(refuse(
            "species of the particles",
            format!("{with_species} for {n} particles"),
            "one for every particle",
        ));
    }
    if state.velocities.len() != n || has_forces && state.forces.len() != n {
        return Err(refuse(
            "arrays of the state",
            format!(
                "{n} positions, {} velocities, {} forces",
                state.velocities.len(),
                state.forces.len()
            ),
            "one of each for every particle",
        ));
    }
    push_header(to, path, style, frame)?;

    let vectors = 1 + usize::from(style.velocities) + usize::from(style.forces);
    to.reserve(n * (10 + vectors * BYTES_A_VECTOR));
    let starts: Vec<usize> = (0..n).step_by(PARTICLES_A_TASK).collect();
    let one_task = |&first: &usize, text: &mut Vec<u8>| {
        text.clear();
        (first..(first + PARTICLES_A_TASK).min(n))
            .try_for_each(|i| push_particle(text, style, frame, i))
    };
    let fault = |bad: NotFinite| WriteError::NotFinite {
        path: path.to_path_buf(),
        quantity: bad.quantity,
        particle: bad.particle,
        value: bad.value,
    };
    let mut texts: Vec<Vec<u8>> = vec![Vec::new(); starts.len().min(TASKS_A_ROUND)];
    for round in starts.chunks(TASKS_A_ROUND) {
        let texts = &mut texts[..round.len()];
        if let ([first], [text]) = (round, &mut *texts) {
            one_task(first, text).map_err(fault)?;
        } else {
            // All results are looked at in order, so that the particle named is always the first.
            let results: Vec<Result<(), NotFinite>> = round
                .par_iter()
                .zip(texts.par_iter_mut())
                .map(|(first, text)| one_task(first, text))
                .collect();
            results
                .into_iter()
                .collect::<Result<(), _>>()
                .map_err(fault)?;
        }
        for text in texts.iter() {
            to.extend_from_slice(text);
        }
    }
    Ok(())
}

fn push_header(
    to: &mut Vec<u8>,
    path: &Path,
    style: &FrameStyle,
    frame: &Frame<'_>,
) -> Result<(), WriteError> {
    push_integer(to, frame.state.len());
    to.extend_from_slice(b"\nLattice=\"");
    let sides = frame.state.cell.lengths() * style.length_scale;
    push_float(to, sides.x);
    to.extend_from_slice(b" 0.0 0.0 0.0 ");
    push_float(to, sides.y);
    to.extend_from_slice(b" 0.0 0.0 0.0 ");
    push_float(to, sides.z);
    to.extend_from_slice(b"\" Properties=species:S:1:pos:R:3");
    if style.velocities {
        to.extend_from_slice(b":velo:R:3");
    }
    if style.forces {
        to.extend_from_slice(b":forces:R:3");
    }
    if style.wrapped {
        to.extend_from_slice(b":map_shift:I:3");
    }
    if style.sites_per_molecule > 1 {
        to.extend_from_slice(b":molecule:I:1");
    }
    if style.has_masses() {
        to.extend_from_slice(b":masses:R:1");
    }
    to.extend_from_slice(b" pbc=\"T T T\"");
    let number = |to: &mut Vec<u8>, key: &str, value: f64| {
        if !value.is_finite() {
            return Err(WriteError::Unwritable {
                path: path.to_path_buf(),
                what: "number in the header",
                found: format!("{key}={value}"),
                allowed: "a finite number".into(),
            });
        }
        to.push(b' ');
        to.extend_from_slice(key.as_bytes());
        to.push(b'=');
        push_float(to, value);
        Ok(())
    };
    number(to, "Time", frame.state.time)?;
    to.extend_from_slice(b" Step=");
    push_integer(to, frame.state.step);
    for &(key, value) in frame.extra {
        if !is_plain_key(key) {
            return Err(WriteError::Unwritable {
                path: path.to_path_buf(),
                what: "key in the header",
                found: format!("`{}`", key.escape_debug()),
                allowed: format!(
                    "letters, digits and _, but none of {}",
                    TAKEN_KEYS.join(", ")
                ),
            });
        }
        number(to, key, value)?;
    }
    if style.species.is_mixture() {
        let all = style.species.all().iter();
        let names: Vec<String> = all.map(|s| format!("{}={}", s.element, s.name)).collect();
        to.extend_from_slice(format!(" species_names=\"{}\"", names.join(" ")).as_bytes());
    }
    to.extend_from_slice(b" units=lj");
    if style.length_scale != 1.0 {
        number(to, "length_scale", style.length_scale)?;
    }
    to.push(b'\n');
    Ok(())
}

/// A number of a particle that is not written.
struct NotFinite {
    quantity: &'static str,
    particle: usize,
    value: f64,
}

fn push_particle(
    to: &mut Vec<u8>,
    style: &FrameStyle,
    frame: &Frame<'_>,
    i: usize,
) -> Result<(), NotFinite> {
    let state = frame.state;
    let finite = |quantity, vector: DVec3| match vector.to_array().iter().find(|c| !c.is_finite()) {
        None => Ok(vector),
        Some(&value) => Err(NotFinite {
            quantity,
            particle: i,
            value,
        }),
    };
    let position = finite("position", state.positions[i])?;
    let (written, image) = if style.wrapped {
        let (wrapped, image) = frame.state.cell.split(position);
        // The conversion to 32 bits saturates there: the flag would be wrong.
        if let Some(axis) = (0..3).find(|&a| matches!(image[a], i32::MIN | i32::MAX)) {
            return Err(NotFinite {
                quantity: "position",
                particle: i,
                value: position[axis],
            });
        }
        (wrapped, Some(image))
    } else {
        (position, None)
    };
    let species = style.species.species(style.species.of(i));
    to.extend_from_slice(species.element.as_bytes());
    push_vector(to, finite("position", written * style.length_scale)?);
    if style.velocities {
        let velocity = state.velocities[i] * style.length_scale;
        push_vector(to, finite("velocity", velocity)?);
    }
    if style.forces {
        let force = state.forces[i] / style.length_scale;
        push_vector(to, finite("force", force)?);
    }
    if let Some(image) = image {
        for flag in image.to_array() {
            to.push(b' ');
            push_integer(to, flag);
        }
    }
    if style.sites_per_molecule > 1 {
        to.push(b' ');
        push_integer(to, i / style.sites_per_molecule + 1);
    }
    if style.has_masses() {
        to.push(b' ');
        push_float(to, species.mass);
    }
    to.push(b'\n');
    Ok(())
}

fn push_vector(to: &mut Vec<u8>, vector: DVec3) {
    for component in vector.to_array() {
        to.push(b' ');
        push_float(to, component);
    }
}
