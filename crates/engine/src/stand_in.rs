//! Stands in for pair forces that ranks share: each rank computes all forces, and keeps its own.

use lennard_core::{
    Array, Backend, Configuration, DVec3, Energetics, ForceError, ForceProperties, ForceStatistics,
    ForceTerm, FusedSteps, HaloSize, Own, Part, Persist, RestoreError, StateArchive, StateReader,
    StateWriter, Team, TooManyRanks, Want,
};
use lennard_forcefield::PairForces;

/// Pair forces, and which particles are kept here.
pub struct StandIn {
    inner: PairForces,
    own: Option<Own>,
}

impl StandIn {
    /// Of all particles.
    #[must_use]
    pub fn new(inner: PairForces) -> Self {
        Self { inner, own: None }
    }

    fn whole(&self, own: &[DVec3]) -> Vec<DVec3> {
        let Some(team) = self.own.as_ref().and_then(Own::team) else { return own.to_vec() };
        let all = team.concat(&own.iter().flat_map(|v| v.to_array().map(f64::to_bits)).collect::<Vec<u64>>());
        all.as_chunks().0.iter().map(|v: &[u64; 3]| DVec3::from_array(v.map(f64::from_bits))).collect()
    }
}

impl ForceTerm for StandIn {
    fn evaluate(
        &mut self,
        at: Configuration<'_>,
        part: Part,
        want: Want,
        forces: &mut [DVec3],
    ) -> Result<Energetics, ForceError> {
        let Some(own) = self.own.clone() else {
            return self.inner.evaluate(at, part, want, forces);
        };
        let positions = self.whole(at.positions);
        let mut all = vec![DVec3::ZERO; positions.len()];
        let at = Configuration { positions: &positions, ..at };
        let found = self.inner.evaluate(at, part, want, &mut all)?;
        forces.copy_from_slice(&all[own.numbers()]);
        Ok(found)
    }

    fn properties(&self) -> ForceProperties {
        self.inner.properties()
    }

    fn statistics(&self) -> ForceStatistics {
        self.inner.statistics()
    }

    fn keep(&mut self, own: &Own) {
        self.own = Some(own.clone());
    }
}

impl Backend for StandIn {
    fn advance(&mut self, steps: &mut FusedSteps<'_>) -> u64 {
        if self.own.is_none() { self.inner.advance(steps) } else { 0 }
    }

    fn share(&mut self, _: &Team) -> Result<bool, TooManyRanks> {
        Ok(true)
    }

    fn halo_on(&self, ranks: usize) -> Option<HaloSize> {
        self.inner.halo_on(ranks)
    }
}

impl Persist for StandIn {
    fn save(&self, to: &mut StateWriter<'_>) {
        let Some(own) = &self.own else { return self.inner.save(to) };
        let mut archive = StateArchive::default();
        self.inner.save(&mut archive.writer());
        for (name, array) in archive.arrays {
            to.put(&name, match array {
                Array::Vec3(all) if all.len() == own.all() => Array::Vec3(all[own.numbers()].to_vec()),
                array => array,
            });
        }
    }

    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        if self.own.is_none() {
            return self.inner.restore(from);
        }
        let mut archive = StateArchive::default();
        let mut to = archive.writer();
        to.put_u64("evaluations", from.u64("evaluations")?);
        to.put_f64("seconds", from.f64("seconds")?);
        if let Ok(built) = from.vec3("list/built_at") {
            to.put_vec3("list/built_at", &self.whole(built));
            to.put_u64("list/named", from.u64("list/named")?);
            to.put_u64("list/counters", from.u64("list/counters")?);
            if let Ok(cell) = from.f64("list/built_box") {
                to.put_f64("list/built_box", cell);
            }
        }
        self.inner.restore(&archive.reader())
    }
}
