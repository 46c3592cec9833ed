//! The box as an observable saw it, for averages over boxes that change.

use lennard_core::{DVec3, PeriodicBox, persist};

/// Running means of the box over samples. Of a box that does not change they are that box to the bit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SeenBox {
    samples: u64,
    sides: DVec3,
    volume: f64,
    first_volume: f64,
    smallest: f64,
}

impl SeenBox {
    /// The box of the start, before any sample.
    pub(crate) fn new(start: &PeriodicBox) -> Self {
        Self {
            samples: 0,
            sides: start.lengths(),
            volume: start.volume(),
            first_volume: start.volume(),
            smallest: start.shortest(),
        }
    }

    /// Counts the box of one sample.
    pub(crate) fn see(&mut self, cell: &PeriodicBox) {
        self.samples += 1;
        let weight = 1.0 / self.samples as f64;
        self.sides += (cell.lengths() - self.sides) * weight;
        self.volume += (cell.volume() - self.volume) * weight;
        self.smallest = self.smallest.min(cell.shortest());
    }

    /// Mean sides, σ.
    pub(crate) fn sides(&self) -> DVec3 {
        self.sides
    }

    /// Mean volume, σ³.
    pub(crate) fn volume(&self) -> f64 {
        self.volume
    }

    /// The volume of the start, σ³: the unit of weights by volume.
    pub(crate) fn first_volume(&self) -> f64 {
        self.first_volume
    }

    /// Half of the shortest side that any sample had, σ: no pair farther apart was counted in every sample.
    pub(crate) fn half_shortest(&self) -> f64 {
        0.5 * self.smallest
    }
}

persist!(SeenBox { samples, sides, [volume, first_volume, smallest] as "volumes" });

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_of_a_box_that_stays_are_that_box_to_the_bit() {
        let cell = PeriodicBox::new(DVec3::new(7.1, 8.3, 9.7)).unwrap();
        let mut seen = SeenBox::new(&cell);
        for _ in 0..1000 {
            seen.see(&cell);
        }
        assert_eq!((seen.sides(), seen.volume()), (cell.lengths(), cell.volume()));
        assert_eq!(seen.half_shortest(), 3.55);
    }

    #[test]
    fn means_of_a_box_that_changes_are_those_of_its_samples() {
        let cell = |side| PeriodicBox::new(DVec3::splat(side)).unwrap();
        let mut seen = SeenBox::new(&cell(10.0));
        for side in [8.0, 12.0] {
            seen.see(&cell(side));
        }
        assert!((seen.sides().x - 10.0).abs() < 1e-12);
        assert!((seen.volume() - 0.5 * (512.0 + 1728.0)).abs() < 1e-9);
        assert_eq!((seen.half_shortest(), seen.first_volume()), (4.0, 1000.0));
    }
}
