//! Exchanges of velocities between two slabs, which drive a flow through a fluid at constant energy.

use lennard_core::{Axis, DVec3, PeriodicBox};

lennard_core::choices! {
    /// What is exchanged.
    pub enum Exchanged {
        /// Whole velocities, so that heat flows.
        #[default]
        Heat = "heat",
        /// One component of the velocities, so that momentum flows.
        Momentum = "momentum",
    }
}

/// What an exchange declares about itself.
#[derive(Debug, Clone, Copy)]
pub struct ExchangeSpec {
    /// Name in scene files.
    pub name: &'static str,
    /// One sentence.
    pub summary: &'static str,
    /// The defining equation, in plain text.
    pub equation: &'static str,
    /// Author, title, equation.
    pub source: &'static str,
}

const EXCHANGES: &[ExchangeSpec] = &[
    ExchangeSpec {
        name: "heat",
        summary: "Velocities of the fastest particle of a cold slab and of the slowest of a hot slab change places: heat flows back through the fluid.",
        equation: "lambda = sum m (v_c^2 - v_h^2)/2 / (2 A t dT/dz)",
        source: "F. Müller-Plathe, \"A simple nonequilibrium molecular dynamics method for calculating the thermal conductivity\", J. Chem. Phys. 106, 6082 (1997)",
    },
    ExchangeSpec {
        name: "momentum",
        summary: "Two particles of two slabs change one component of their velocities: momentum flows back through the fluid.",
        equation: "eta = sum m (v_x,2 - v_x,1) / (2 A t |dv_x/dz|)",
        source: "F. Müller-Plathe, \"Reversing the perturbation in nonequilibrium molecular dynamics\", Phys. Rev. E 59, 4894 (1999)",
    },
];

/// Every exchange.
#[must_use]
pub fn exchanges() -> &'static [ExchangeSpec] {
    EXCHANGES
}

lennard_core::options! {
    /// An exchange of velocities between the first and the middle slab of the box.
    pub struct ExchangeOptions {
        /// What is exchanged.
        kind: Exchanged = Exchanged::Heat, Names(Exchanged::names);
        /// Axis along which it flows.
        axis: Axis = Axis::Z, Names(Axis::names);
        /// Slabs of equal width across the axis, an even number; the exchange is between the first and the middle one.
        slabs: usize = 20, Whole(12, 1000);
        /// Steps between two exchanges.
        every: u64 = 200, Whole(1, 1_000_000), in "steps";
    }
}

impl ExchangeOptions {
    /// The axis of the momentum that flows: the next one after the axis of the slabs.
    #[must_use]
    pub fn along(&self) -> Axis {
        Axis::ALL[(self.axis.index() + 1) % 3]
    }

    /// Exchanges velocities once, and returns what was carried, ε or mσ/τ; 0 where no two particles differ in the wanted sense.
    ///
    /// With heat, the fastest particle of the first slab and the slowest one of the middle slab change velocities. The energy
    /// ½m(v₁² − v₂²) goes to the middle slab. With momentum, two particles change their component along
    /// [`ExchangeOptions::along`]: the smallest of the first slab, and the largest of the middle slab. The momentum m(v₂ − v₁) goes
    /// to the first slab. Nothing changes where that would be negative. All masses are `mass`, so that total energy and momentum stay to the last place of their sums.
    pub fn apply(
        &self,
        cell: &PeriodicBox,
        positions: &[DVec3],
        mass: f64,
        velocities: &mut [DVec3],
    ) -> f64 {
        let (axis, along) = (self.axis.index(), self.along().index());
        let per_length = self.slabs as f64 / cell.lengths()[axis];
        let measure = |v: &DVec3| match self.kind {
            Exchanged::Heat => v.length_squared(),
            // The first slab gives the smallest component.
            Exchanged::Momentum => -v[along],
        };
        let mut first: Option<(f64, usize)> = None;
        let mut middle = first;
        for (i, (r, v)) in positions.iter().zip(&*velocities).enumerate() {
            let slab = (cell.wrap(*r)[axis] * per_length) as usize;
            let value = measure(v);
            // Of equal values the first particle counts.
            if slab == 0 && first.is_none_or(|(most, _)| value > most) {
                first = Some((value, i));
            } else if slab == self.slabs / 2 && middle.is_none_or(|(least, _)| value < least) {
                middle = Some((value, i));
            }
        }
        let (Some((most, i)), Some((least, j))) = (first, middle) else {
            return 0.0;
        };
        if most <= least {
            return 0.0;
        }
        match self.kind {
            Exchanged::Heat => {
                velocities.swap(i, j);
                0.5 * mass * (most - least)
            }
            Exchanged::Momentum => {
                let kept = velocities[i][along];
                velocities[i][along] = velocities[j][along];
                velocities[j][along] = kept;
                mass * (most - least)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lennard_core::options::Options;

    /// A particle in the middle of each of ten slabs, with velocities that tell them apart.
    fn column() -> (PeriodicBox, Vec<DVec3>, Vec<DVec3>) {
        let cell = PeriodicBox::new(DVec3::new(3.0, 3.0, 10.0)).unwrap();
        // Unwrapped: some boxes away.
        let place = |k: usize| DVec3::new(1.0, 1.0, k as f64 + 0.5 + 10.0 * (k % 3) as f64);
        let positions = (0..10).chain([0, 5]).map(place).collect();
        let velocities =
            (0..12).map(|k| DVec3::new(f64::from(k) - 4.0, 0.1 * f64::from(k), -0.2)).collect();
        (cell, positions, velocities)
    }

    fn ten(kind: Exchanged) -> ExchangeOptions {
        ExchangeOptions { kind, slabs: 10, ..ExchangeOptions::default() }
    }

    #[test]
    fn heat_goes_from_the_fastest_of_the_first_slab_to_the_slowest_of_the_middle() {
        let (cell, positions, start) = column();
        let mut velocities = start.clone();
        // Slab 0 has particles 0 and 10, slab 5 has 5 and 11.
        let carried = ten(Exchanged::Heat).apply(&cell, &positions, 2.0, &mut velocities);
        assert_eq!((velocities[10], velocities[5]), (start[5], start[10]));
        assert_eq!(carried, start[10].length_squared() - start[5].length_squared());
        let others = |k: &usize| ![5, 10].contains(k);
        assert!((0..12).filter(others).all(|k| velocities[k] == start[k]));
        // Now the fastest of the first slab, 4.005 σ/τ, is slower than the slowest of the middle: nothing is left to carry.
        let before = velocities.clone();
        let next = ten(Exchanged::Heat).apply(&cell, &positions, 2.0, &mut velocities);
        assert_eq!((next, &velocities), (0.0, &before));
    }

    #[test]
    fn momentum_along_the_next_axis_goes_to_the_first_slab() {
        let (cell, positions, start) = column();
        let mut velocities = start.clone();
        let exchange = ten(Exchanged::Momentum);
        assert_eq!(exchange.along(), Axis::X);
        let carried = exchange.apply(&cell, &positions, 1.0, &mut velocities);
        // The smallest of slab 0 is −4, the largest of slab 5 is 7.
        assert_eq!(carried, 11.0);
        assert_eq!((velocities[0].x, velocities[11].x), (7.0, -4.0));
        assert_eq!((velocities[0].y, velocities[11].y), (start[0].y, start[11].y));
        let sum = |all: &[DVec3]| all.iter().copied().sum::<DVec3>();
        assert_eq!(sum(&velocities).x, sum(&start).x);
    }

    #[test]
    fn the_list_and_the_names_agree() {
        let names: Vec<&str> = exchanges().iter().map(|e| e.name).collect();
        assert_eq!(names, Exchanged::names());
        assert!(ExchangeOptions::default().check().is_ok());
    }
}
