//! What a restart needs of a list: the positions and the box of its build, and the pairs inserted since then.

use glam::DVec3;
use lennard_core::{PeriodicBox, RestoreError, StateReader, StateWriter};

use super::Listed;
use crate::simd::PackedList;

impl<P: PackedList> Listed<P> {
    /// Writes what a restart needs.
    pub fn save(&self, to: &mut StateWriter<'_>) {
        let mut built_at = Vec::new();
        if let Some(cell) = self.validity.build_cell() {
            let built = &self.validity.built;
            built_at.resize(built.len(), DVec3::ZERO);
            for (particle, r) in self.list.particles().iter().zip(built) {
                built_at[*particle as usize] = *r;
            }
            to.put_f64("built_box", &cell.lengths().to_array());
        }
        to.put_vec3("built_at", &built_at);
        let inserted = self.validity.inserted.iter().flatten();
        let inserted: Vec<u64> = inserted.map(|slot| (*slot).into()).collect();
        to.put_u64("named", &inserted);
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
            self.restore_inserted(from, n)?;
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
        let inserted = match from.u64("named") {
            // Earlier versions inserted no pairs.
            Err(RestoreError::Missing(_)) => &[],
            inserted => inserted?,
        };
        if inserted.is_empty() {
            return Ok(());
        }
        let (pairs, rest) = inserted.as_chunks::<2>();
        let is_pair = |[a, b]: &[u64; 2]| a < b && *b < n as u64;
        let pairs: Vec<[u32; 2]> = pairs
            .iter()
            .filter(|pair| is_pair(pair))
            .map(|pair| pair.map(|slot| slot as u32))
            .collect();
        if 2 * pairs.len() == inserted.len()
            && rest.is_empty()
            && self.validity.insert(&mut self.list, &pairs)
        {
            return Ok(());
        }
        Err(from.misfit("named", format!("no pairs of {n} slots that this list can take")))
    }
}

/// The box of the build.
fn build_box(from: &StateReader<'_>) -> Result<PeriodicBox, RestoreError> {
    let sides: [f64; 3] = from.f64s("built_box")?;
    PeriodicBox::new(sides.into()).map_err(|e| from.misfit("built_box", e.to_string()))
}
