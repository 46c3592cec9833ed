//! What a restart needs of a list: the positions and the box of its build, and the pairs inserted since then.

use std::collections::HashMap;

use glam::DVec3;
use lennard_core::{PeriodicBox, RestoreError, StateReader, StateWriter};

use super::Listed;
use crate::simd::{PackedList, to_particles};
use crate::validity::build::Lacking;

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
        let inserted = self.validity.inserted.iter().flatten();
        let inserted: Vec<u64> = inserted.map(|particle| (*particle).into()).collect();
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
            // Earlier versions wrote a second counter.
            [builds] | [builds, _] => {
                self.validity.builds = *builds;
                Ok(())
            }
            other => Err(from.misfit("counters", format!("{} numbers, wanted 1", other.len()))),
        }
    }

    fn restore_inserted(&mut self, from: &StateReader<'_>, n: usize) -> Result<(), RestoreError> {
        let inserted = match from.u64("inserted") {
            // Earlier versions named slots. The list lacks their pairs until it looks for them in the next step.
            Err(RestoreError::Missing(_)) => &[],
            inserted => inserted?,
        };
        if inserted.is_empty() {
            return Ok(());
        }
        let slots: HashMap<u32, u32> = self.list.particles().iter().copied().zip(0..).collect();
        let (pairs, rest) = inserted.as_chunks::<2>();
        let is_pair = |[a, b]: &[u64; 2]| a != b && a.max(b) < &(n as u64);
        let pairs: Vec<Lacking> = pairs
            .iter()
            .filter(|pair| is_pair(pair))
            .map(|pair| {
                let particles = pair.map(|particle| particle as u32);
                let [a, b] = particles.map(|particle| slots.get(&particle).copied());
                Lacking { particles, slots: a.zip(b).map(<[u32; 2]>::from) }
            })
            .collect();
        if 2 * pairs.len() == inserted.len()
            && rest.is_empty()
            && self.validity.insert(&mut self.list, &pairs)
        {
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
