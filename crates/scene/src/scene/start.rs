//! Where the particles of a scene start: their number, the box, and the part of it that they fill.

use lennard_core::number::short;
use lennard_core::{DVec3, PeriodicBox};

use crate::lattice::{NoLattice, cells};
use crate::limits::LONGEST_SIDE;
use crate::{Arrangement, Geometry, HalfCrystal, Placement, Scene, SceneError, Slab};

impl Scene {
    /// Number of particles; `None` where a file has it.
    #[must_use]
    pub fn n_particles(&self) -> Option<usize> {
        match &self.system.start {
            // Every site is listed; elsewhere the scene counts molecules.
            Arrangement::Listed { positions, .. } => Some(positions.len()),
            start => Some(start.count()? * self.molecules().sites()),
        }
    }

    /// Whether each held particle is one of `n`, and one particle at least is free.
    ///
    /// # Errors
    /// [`SceneError`] with the number that no particle has.
    pub fn held_are_among(&self, n: usize) -> Result<(), SceneError> {
        let held = &self.system.held;
        let refuse = |found: String, allowed: String| {
            Err(self.refuse("system.held", "is not allowed").found(found).allowed(allowed))
        };
        if let Some(missing) = held.iter().find(|i| **i >= n) {
            let found = format!("particle {} of {n}", missing + 1);
            return refuse(found, format!("numbers from 1 to {n}"));
        }
        if held.len() == n {
            let found = format!("all {n} particles");
            return refuse(found, "fewer: something must be free to move".to_owned());
        }
        Ok(())
    }

    /// Whether each particle is held, or bonded to a held one: none can leave for an image of the box.
    #[must_use]
    pub fn all_are_tethered(&self) -> bool {
        let sites = self.molecules().sites();
        let Some(n) = self.n_particles() else {
            return false;
        };
        (0..n / sites).all(|m| self.system.held.iter().any(|i| i / sites == m))
    }

    /// The start as a crystal beside its liquid, where it is one.
    #[must_use]
    pub fn half_crystal(&self) -> Option<&HalfCrystal> {
        match &self.system.start {
            Arrangement::HalfCrystal(start) => Some(start),
            _ => None,
        }
    }

    /// Why the particles are no homogeneous fluid, in words: what confines them, or a crystal beside the liquid. `None` where the scene names
    /// nothing of the kind.
    #[must_use]
    pub fn not_homogeneous(&self) -> Option<String> {
        let confined = self.confined_by();
        let confined = confined.map(|with| format!("the fluid has {with}"));
        let crystal = self.half_crystal();
        confined.or_else(|| crystal.map(|_| "a crystal beside its liquid".to_owned()))
    }

    /// The box, with the part that the crystal fills.
    pub(crate) fn crystal_placement(&self, start: &HalfCrystal) -> Result<Placement, SceneError> {
        let side = start.side();
        let crystal = DVec3::new(side, side, start.crystal_length());
        let sides = crystal + DVec3::new(0.0, 0.0, start.liquid_length());
        Ok(Placement {
            cell: self.box_of_phases(sides)?,
            corner: DVec3::ZERO,
            filled: crystal,
            cells: Some([start.cells, start.cells, start.layers]),
        })
    }

    /// The box of a start with two phases.
    fn box_of_phases(&self, sides: DVec3) -> Result<PeriodicBox, SceneError> {
        PeriodicBox::new(sides).map_err(|_| {
            self.refuse("start", "makes an impossible box")
                .found(format!("sides of {} and {} σ", short(sides.x), short(sides.z)))
                .allowed("finite sides above 0")
        })
    }

    /// The start as a slab, where it is one.
    #[must_use]
    pub fn slab(&self) -> Option<&Slab> {
        match &self.system.start {
            Arrangement::Slab(slab) => Some(slab),
            _ => None,
        }
    }

    /// What makes surfaces across z at the start, in words; `None` for a fluid that fills its box, and for a start from a file.
    #[must_use]
    pub fn surfaces(&self) -> Option<String> {
        match &self.system.start {
            Arrangement::Lattice { vacuum, .. } if *vacuum > 0.0 => {
                Some(format!("start.vacuum = {vacuum}"))
            }
            Arrangement::Slab(_) => Some("a slab".to_owned()),
            _ => None,
        }
    }

    /// The box of a slab, with the part that the liquid fills.
    pub(crate) fn slab_placement(&self, slab: &Slab) -> Result<Placement, SceneError> {
        let sides = slab.sides();
        Ok(Placement {
            cell: self.box_of_phases(sides)?,
            corner: DVec3::new(0.0, 0.0, 0.5 * (slab.length - slab.thickness)),
            filled: DVec3::new(sides.x, sides.y, slab.thickness),
            cells: None,
        })
    }

    /// The box and the part of it that particles fill at the start; `None` for a start from a configuration file. A start that the
    /// scene lists has the part between the walls.
    ///
    /// # Errors [`SceneError`] where the particles make no whole lattice or the box is impossible. A
    /// scene that was read from a file has been checked, and never fails.
    pub fn placement(&self) -> Result<Option<Placement>, SceneError> {
        let (lattice, n_atoms, geometry, vacuum) = match &self.system.start {
            Arrangement::Lattice { lattice, n_atoms, geometry, vacuum } => {
                (lattice.as_ref(), n_atoms, geometry, vacuum)
            }
            Arrangement::Slab(slab) => return self.slab_placement(slab).map(Some),
            Arrangement::HalfCrystal(start) => return self.crystal_placement(start).map(Some),
            Arrangement::Listed { sides, positions, .. } => {
                (None, &positions.len(), &Geometry::Box(*sides), &0.0)
            }
            Arrangement::File { .. } => return Ok(None),
        };
        let (filled, key) = match geometry {
            Geometry::Density(density) => {
                let side = (*n_atoms as f64 / density).cbrt();
                (DVec3::splat(side), "system.density")
            }
            Geometry::Box(sides) => (DVec3::from_array(*sides), "system.box"),
        };
        let mut lengths = filled;
        lengths.z += vacuum;
        let (room, clear) =
            self.room_of_walls(!matches!(self.system.start, Arrangement::Listed { .. }));
        lengths += room;
        let refuse = |found: f64| {
            let key = if filled.max_element() > LONGEST_SIDE || *vacuum == 0.0 {
                key
            } else {
                "start.vacuum"
            };
            self.refuse(key, "makes an impossible box")
                .found(format!("a side of {found:.4} σ"))
                .allowed(format!("sides above 0 and at most {LONGEST_SIDE} σ"))
        };
        for side in lengths.to_array() {
            if !(side > 0.0 && side <= LONGEST_SIDE) {
                return Err(refuse(side));
            }
        }
        let cell = PeriodicBox::new(lengths).map_err(|_| refuse(f64::NAN))?;
        let cells = lattice
            .map(|lattice| cells(*lattice, *n_atoms, filled))
            .transpose()
            .map_err(|none| self.no_lattice(*n_atoms, &none))?;
        Ok(Some(Placement {
            cell,
            corner: clear + DVec3::new(0.0, 0.0, 0.5 * vacuum),
            filled,
            cells,
        }))
    }

    fn no_lattice(&self, found: usize, none: &NoLattice) -> SceneError {
        let nearest = match (none.below, none.above) {
            (Some(below), Some(above)) => format!("{below} below, {above} above"),
            (None, Some(only)) | (Some(only), None) => only.to_string(),
            (None, None) => "none near".to_owned(),
        };
        let (key, or) = match self.molecule {
            None => ("system.n_atoms", "; or any number with start.kind = \"random\""),
            Some(_) => ("system.n_molecules", ""),
        };
        self.refuse(key, "makes no whole lattice")
            .found(found)
            .allowed(format!("{}{or}", none.rule))
            .suggestion(Some(nearest))
    }
}
