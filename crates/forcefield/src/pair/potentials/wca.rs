//! Weeks–Chandler–Andersen, the repulsive part of Lennard-Jones.

use super::{LennardJones, OwnEnd, Potential, PotentialSpec};
use crate::pair::{Pair, PairPotential, Shape, Side};

lennard_core::options! {
    /// Weeks–Chandler–Andersen: U = 4·(r⁻¹² − r⁻⁶) + 1 inside 2^{1/6} σ, where the cutoff ends it.
    ///
    /// J. D. Weeks, D. Chandler and H. C. Andersen, "Role of repulsive forces in determining the
    /// equilibrium structure of simple liquids", J. Chem. Phys. 54 (1971) 5237, eq. 4.
    #[derive(Copy)]
    pub struct Wca {}
}

/// 2^{1/6} σ, the minimum of the Lennard-Jones potential.
const END: f64 = 1.122_462_048_309_373;

impl Potential for Wca {
    const SPEC: PotentialSpec = PotentialSpec {
        name: "wca",
        title: "WCA",
        summary: "The repulsive part of Lennard-Jones, ending smoothly at its minimum.",
        equation: "U = 4 (r^-12 - r^-6) + 1 for r <= 2^(1/6), else 0",
        source: "J. D. Weeks, D. Chandler and H. C. Andersen, Role of repulsive forces in determining the equilibrium structure of simple liquids, J. Chem. Phys. 54 (1971) 5237, eq. 4",
        is_lennard_jones: false,
    };
    const END: Option<OwnEnd> = Some(OwnEnd { r: END, in_words: "2^(1/6)" });
    const EXAMPLES: &'static [Self] = &[Self {}];
    type Formula = Self;

    fn formula(&self) -> Self {
        *self
    }

    fn in_words(&self) -> String {
        "Weeks–Chandler–Andersen, ending at 2^(1/6) σ".to_owned()
    }
}

impl PairPotential for Wca {
    fn unit(&self) -> f64 {
        LennardJones::UNIT
    }

    fn on(&self, side: Side, r2: f64) -> Pair<f64> {
        let pair = LennardJones {}.on(side, r2);
        Pair { energy: pair.energy + 1.0 / LennardJones::UNIT, ..pair }
    }

    fn shape(&self) -> Option<Shape> {
        Some(Shape::TwelveSix { below: -1.0 / LennardJones::UNIT })
    }

    fn tail_energy(&self, _r_cut: f64) -> f64 {
        0.0
    }

    fn tail_virial(&self, _r_cut: f64) -> f64 {
        0.0
    }
}
