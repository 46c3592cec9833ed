//! Paths of particles in a box that may change.

use lennard_core::{DVec3, Own, PeriodicBox, Persist, RestoreError, StateReader, StateWriter};

/// What the changing box has moved each particle by, taken off its position.
///
/// A barostat scales positions with the box, and that motion is no diffusion. Between two samples a particle moves by
/// ½(L + L′)·(r/L − r′/L′) along each axis, and the box moves it by the rest, ½(L − L′)·(r/L + r′/L′). In a box that stays, paths are
/// positions to the bit.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Paths {
    /// Sides of the last sample, σ.
    sides: DVec3,
    /// What the box has moved each particle by, σ; empty as long as it has stayed.
    moved: Vec<DVec3>,
    /// Which of the particles that are followed this process has.
    own: Own,
}

impl Paths {
    /// Nothing has moved in the box of the start.
    pub(super) fn new(start: &PeriodicBox, own: &Own) -> Self {
        Self { sides: start.lengths(), moved: Vec::new(), own: own.clone() }
    }

    /// Makes paths of the unwrapped positions of a sample; `before` are the paths of the sample before.
    pub(super) fn follow(
        &mut self,
        cell: &PeriodicBox,
        positions: &mut [DVec3],
        before: Option<&Vec<DVec3>>,
    ) {
        let (now, then) = (cell.lengths(), self.sides);
        self.sides = now;
        if let Some(before) = before
            && now != then
        {
            self.moved.resize(positions.len(), DVec3::ZERO);
            let half = 0.5 * (now - then);
            for ((moved, r), path) in self.moved.iter_mut().zip(&*positions).zip(before) {
                let last = *path + *moved;
                *moved += half * (*r / now + last / then);
            }
        }
        for (r, moved) in positions.iter_mut().zip(&self.moved) {
            *r -= *moved;
        }
    }

    /// What is to be said where the box has changed.
    pub(super) fn remark(&self) -> Option<String> {
        (!self.moved.is_empty()).then(|| {
            "the box changed: displacements are sums of L·Δ(r/L), without what the box moves"
                .to_owned()
        })
    }
}

impl Persist for Paths {
    fn save(&self, to: &mut StateWriter<'_>) {
        let Self { sides, moved, own } = self;
        sides.save(&mut to.section("sides"));
        to.put_vec3("moved", &own.collect_vectors(moved));
    }

    fn restore(&mut self, from: &StateReader<'_>) -> Result<(), RestoreError> {
        self.sides.restore(&from.section("sides"))?;
        let (all, n) = (from.vec3("moved")?, self.own.all());
        if !all.is_empty() && all.len() != n {
            return Err(from.misfit("moved", format!("{} vectors, wanted {n}", all.len())));
        }
        self.moved = self.own.parts_of_rows(all).flatten().copied().collect();
        Ok(())
    }
}
