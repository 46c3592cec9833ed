//! Walls that are hit by molecules as the boundary of flights, as a force term, and in checkpoints.

use lennard_core::{
    Boundary, Configuration, DVec3, Drifted, Energetics, Flight, ForceError, ForceProperties,
    ForceTerm, Part, StepError, WallReading, Want, persist,
};

use super::MoleculesAtWalls;

impl Boundary for MoleculesAtWalls {
    fn fly(&mut self, flight: Flight<'_>) -> Result<Drifted, StepError> {
        let Flight { positions, velocities, h, .. } = flight;
        let mut heat = self.damp_all(positions, velocities, 0.5 * h, false);
        let flight = Flight { positions: &mut *positions, velocities: &mut *velocities, ..flight };
        let mut before = std::mem::take(&mut self.before);
        before.x.clear();
        before.x.extend_from_slice(flight.positions);
        before.v.clear();
        before.v.extend_from_slice(flight.velocities);
        let drifted = self.fly_all(&before, flight);
        self.before = before;
        let mut drifted = drifted?;
        heat += self.damp_all(positions, velocities, 0.5 * h, true);
        drifted.heat += heat;
        Ok(drifted)
    }
}

impl ForceTerm for MoleculesAtWalls {
    lennard_core::evaluate_by_adding!();

    fn add(
        &mut self,
        at: Configuration<'_>,
        part: Part,
        want: Want,
        scratch: &mut Vec<DVec3>,
        forces: &mut [DVec3],
    ) -> Result<Energetics, ForceError> {
        self.walls.add(at, part, want, scratch, forces)
    }

    fn force_on(&self, particle: usize, at: Configuration<'_>) -> DVec3 {
        self.walls.force_on(particle, at)
    }

    fn properties(&self) -> ForceProperties {
        self.walls.properties()
    }

    fn walls(&self) -> &[WallReading] {
        self.walls.walls()
    }

    fn boundary(&mut self) -> Option<&mut dyn Boundary> {
        Some(self)
    }
}

persist!(MoleculesAtWalls { ..walls, fixed system, solver, one, planes, damped, before });
