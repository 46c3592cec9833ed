//! Particles that the scene lists one by one, and particles that are held.

use lennard_core::DVec3;
use lennard_io::LARGEST;

use crate::error::SceneError;
use crate::read::Reader;
use crate::{Geometry, Scene, Start};

/// A row of numbers as a vector.
fn vectors(rows: &[[f64; 3]]) -> Vec<DVec3> {
    rows.iter().map(|row| DVec3::from_array(*row)).collect()
}

impl Reader<'_> {
    /// The start of particles that are listed, in a box.
    pub fn listed(
        &self,
        positions: &[[f64; 3]],
        velocities: Option<&[[f64; 3]]>,
        geometry: Option<Geometry>,
    ) -> Result<Start, SceneError> {
        let refuse = |key: &str, message: &str, found: String, allowed: &str| {
            let key = format!("system.{key}");
            Err(self.source.refuse(&key, message).found(found).allowed(allowed))
        };
        let Some(Geometry::Box(sides)) = geometry else {
            let found = "`positions` without a box".to_owned();
            let allowed = "`box` with one side, or three sides [Lx, Ly, Lz]";
            return refuse("box", "is missing", found, allowed);
        };
        if positions.is_empty() {
            let found = "an empty list".to_owned();
            return refuse("positions", "has no particle", found, "at least one position");
        }
        for (key, rows) in [("positions", Some(positions)), ("velocities", velocities)] {
            let bad =
                rows.into_iter().flatten().flatten().find(|x| !(-LARGEST..=LARGEST).contains(*x));
            if let Some(x) = bad {
                let allowed = format!("numbers from -{LARGEST:e} to {LARGEST:e}");
                return refuse(key, "is not allowed", x.to_string(), &allowed);
            }
        }
        if let Some(velocities) = velocities
            && velocities.len() != positions.len()
        {
            let found = format!("{} velocities of {} particles", velocities.len(), positions.len());
            let allowed = "one velocity for each of `positions`";
            return refuse("velocities", "has another length", found, allowed);
        }
        Ok(Start::Listed {
            sides,
            positions: vectors(positions),
            velocities: velocities.map(vectors),
        })
    }

    /// The held particles by their numbers from 0, from numbers from 1.
    pub fn held(&self, written: &[u64]) -> Result<Vec<usize>, SceneError> {
        let mut held = Vec::new();
        for number in written {
            let place = (*number as usize).wrapping_sub(1);
            if *number == 0 || held.contains(&place) {
                return Err(self
                    .source
                    .refuse("system.held", "is not allowed")
                    .found(format!("{number} in {written:?}"))
                    .allowed("numbers of particles, from 1, each once"));
            }
            held.push(place);
        }
        held.sort_unstable();
        Ok(held)
    }
}

impl Scene {
    /// Number of particles; `None` where a file has it.
    #[must_use]
    pub fn n_particles(&self) -> Option<usize> {
        let count = self.system.start.count()?;
        match self.system.start {
            Start::Lattice { .. } | Start::Slab(_) => Some(count * self.molecules().sites()),
            Start::HalfCrystal(_) | Start::Listed { .. } | Start::Configuration { .. } => {
                Some(count)
            }
        }
    }

    /// Whether each held particle is one of `n`, and one particle at least is free.
    ///
    /// # Errors
    /// [`SceneError`] with the number that no particle has.
    pub fn held_are_among(&self, n: usize) -> Result<(), SceneError> {
        let held = &self.system.held;
        let refuse = |found: String, allowed: String| {
            Err(self.source.refuse("system.held", "is not allowed").found(found).allowed(allowed))
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
}
