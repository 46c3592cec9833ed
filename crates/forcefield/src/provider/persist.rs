//! What a restart needs of the forces: their lists, and what was counted.

use lennard_core::{Persist, RestoreError, StateReader, StateWriter};

use super::{PairForces, Strategy};
use crate::listed::{AnyListed, with_listed};

impl Persist for PairForces {
    fn save(&self, to: &mut StateWriter<'_>) {
        to.put_u64("evaluations", &[self.evaluations]);
        to.put_f64("seconds", &[self.clock.force, self.clock.neighbor]);
        if let Strategy::Verlet(listed) = &self.strategy {
            with_listed!(listed, l => l.save(&mut to.section("list")));
        }
        if let Some(near) = self.near.as_ref().and_then(|near| near.list.as_ref()) {
            with_listed!(near, l => l.save(&mut to.section("near_list")));
        }
    }

    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        if let Strategy::Verlet(listed) = &mut self.strategy {
            with_listed!(listed, l => l.restore(&from.section("list"), self.n_atoms))?;
        }
        if let Some(near) = self.near.as_mut().and_then(|near| near.list.as_mut()) {
            with_listed!(near, l => l.restore(&from.section("near_list"), self.n_atoms))?;
        }
        [self.evaluations] = from.u64s("evaluations")?;
        [self.clock.force, self.clock.neighbor] = from.f64s("seconds")?;
        Ok(())
    }
}
