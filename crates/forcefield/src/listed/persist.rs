//! What a restart needs of a list: the positions and the box of its build, and the pairs inserted since then.

use std::collections::HashMap;

use glam::DVec3;
use lennard_core::{PeriodicBox, RestoreError, StateReader, StateWriter};

use super::Listed;
use crate::simd::{PackedList, to_particles};

impl<P: PackedList> Listed<P> {
    /// Writes what a restart needs.
    pub fn save(&self, to: &mut StateWriter<'_>) {
        let mut built_at = Vec::new();
        if let Some(cell) = self.validity.build_cell() {
            let built = &self.validity.built;
            match &self.validity.part {
                None => {
                    built_at.resize(built.len(), DVec3::ZERO);
                    to_particles(&self.list, built, &mut built_at);
                }
                Some(part) => {
                    built_at.resize(part.numbers().len(), DVec3::ZERO);
                    part.to_numbers(&self.list, built, &mut built_at);
                }
            }
            to.put_f64("built_box", &cell.lengths().to_array());
        }
        to.put_vec3("built_at", &built_at);
        let inserted = self.validity.inserted();
        let inserted: Vec<u64> = inserted.iter().flatten().map(|k| (*k).into()).collect();
        to.put_u64("inserted", &inserted);
        to.put_u64("counters", &[self.validity.builds]);
    }

    /// Builds the list of the saved run again and inserts the pairs that were inserted since its build.
    pub fn restore(&mut self, from: &StateReader<'_>, n: usize) -> Result<(), RestoreError> {
        let built = from.vec3("built_at")?;
        if !built.is_empty() {
            if built.len() != n {
                return Err(
                    from.misfit("built_at", format!("{} particles, wanted {n}", built.len()))
                );
            }
            let cell = build_box(from)?;
            self.build(&cell, built).map_err(|e| from.misfit("built_at", e.to_string()))?;
            let whole = self.list.whole();
            self.restore_inserted(from, whole)?;
        } else {
            self.validity.forget();
        }
        match from.u64("counters")? {
            [builds] => {
                self.validity.builds = *builds;
                Ok(())
            }
            other => Err(from.misfit("counters", format!("{} numbers, wanted 1", other.len()))),
        }
    }

    fn restore_inserted(&mut self, from: &StateReader<'_>, n: usize) -> Result<(), RestoreError> {
        let inserted = from.u64("inserted")?;
        if inserted.is_empty() {
            return Ok(());
        }
        let slots: HashMap<u32, u32> = self.list.particles().iter().copied().zip(0..).collect();
        let (pairs, rest) = inserted.as_chunks::<2>();
        let is_pair = |[a, b]: &[u64; 2]| a != b && a.max(b) < &(n as u64);
        let mut is_right = rest.is_empty() && pairs.iter().all(is_pair);
        for pair in pairs {
            if let Some(part) = &self.validity.part {
                part.begin_search();
            }
            // Other ranks have slots for the particles that are far from this one.
            if let [Some(a), Some(b)] = pair.map(|k| slots.get(&(k as u32)).copied()) {
                is_right = is_right && self.validity.insert(&mut self.list, &[[a, b]], true);
            }
        }
        if is_right {
            return Ok(());
        }
        Err(from.misfit("inserted", format!("no pairs of {n} particles that this list can take")))
    }
}

/// The box of the build.
fn build_box(from: &StateReader<'_>) -> Result<PeriodicBox, RestoreError> {
    let sides: [f64; 3] = from.f64s("built_box")?;
    PeriodicBox::new(sides.into()).map_err(|e| from.misfit("built_box", e.to_string()))
}
