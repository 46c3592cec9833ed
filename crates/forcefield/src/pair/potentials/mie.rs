//! The Mie potential, two inverse powers.

use super::{LARGEST_EXPONENT, Potential, PotentialSpec, SMALLEST_EXPONENT};
use crate::pair::{Pair, PairPotential, Shape, Side, TwoPowers};
use lennard_core::options::OptionError;

lennard_core::options! {
    /// Mie n-m: U = C·(r⁻ⁿ − r⁻ᵐ) with C = n/(n − m)·(n/m)^{m/(n − m)}, so that the minimum is −1; 12-6 is Lennard-Jones.
    ///
    /// G. Mie, "Zur kinetischen Theorie der einatomigen Körper", Ann. Phys. 316 (1903) 657.
    #[derive(Copy)]
    pub struct Mie {
        /// The exponent n of the repulsion, above the exponent of the attraction.
        repulsive: u32 = 14, Whole(SMALLEST_EXPONENT + 1, LARGEST_EXPONENT);
        /// The exponent m of the attraction.
        attractive: u32 = 6, Whole(SMALLEST_EXPONENT, LARGEST_EXPONENT - 1);
    }
}

impl Potential for Mie {
    const SPEC: PotentialSpec = PotentialSpec {
        name: "mie",
        title: "Mie",
        summary: "Two inverse powers with a minimum of -1: the Lennard-Jones potential with other exponents.",
        equation: "U = C (r^-n - r^-m), C = n/(n-m) (n/m)^(m/(n-m))",
        source: "G. Mie, Zur kinetischen Theorie der einatomigen Körper, Ann. Phys. 316 (1903) 657",
        is_lennard_jones: false,
    };
    /// Even and odd exponents, and Lennard-Jones.
    const EXAMPLES: &'static [Self] = &[
        Self { repulsive: 14, attractive: 6 },
        Self { repulsive: 11, attractive: 5 },
        Self { repulsive: 12, attractive: 6 },
    ];
    type Formula = Formula;

    fn formula(&self) -> Formula {
        let (n, m) = (f64::from(self.repulsive), f64::from(self.attractive));
        Formula {
            n: self.repulsive,
            m: self.attractive,
            strength: n / (n - m) * (n / m).powf(m / (n - m)),
        }
    }

    fn in_words(&self) -> String {
        format!("Mie {}-{}", self.repulsive, self.attractive)
    }

    fn check_together(&self) -> Result<(), OptionError> {
        if self.attractive < self.repulsive {
            return Ok(());
        }
        Err(OptionError {
            key: "attractive",
            found: self.attractive.to_string(),
            allowed: format!("below `repulsive`, which is {}", self.repulsive),
        })
    }
}

/// The formula of a Mie potential.
#[derive(Clone, Copy, Debug)]
pub struct Formula {
    n: u32,
    m: u32,
    /// C, ε.
    strength: f64,
}

impl Formula {
    fn two_powers(&self) -> TwoPowers {
        TwoPowers { n: self.n, m: self.m }
    }
}

impl PairPotential for Formula {
    fn on(&self, _side: Side, r2: f64) -> Pair<f64> {
        self.two_powers().values([self.strength; 2], r2.recip())
    }

    fn shape(&self) -> Option<Shape> {
        Some(Shape::TwoPowers { form: self.two_powers(), strengths: [self.strength; 2] })
    }

    fn tail_energy(&self, r_cut: f64) -> f64 {
        let of = |exponent: u32| tail(exponent, r_cut);
        self.strength * (of(self.n) - of(self.m))
    }

    fn tail_virial(&self, r_cut: f64) -> f64 {
        let of = |exponent: u32| f64::from(exponent) * tail(exponent, r_cut);
        self.strength * (of(self.m) - of(self.n))
    }
}

/// ∫ r²·r⁻ⁿ dr from `r_cut` to ∞.
fn tail(exponent: u32, r_cut: f64) -> f64 {
    let power = f64::from(exponent) - 3.0;
    r_cut.powf(-power) / power
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::LennardJones;

    #[test]
    fn twelve_and_six_are_lennard_jones_and_every_minimum_is_minus_one() {
        let mie = |repulsive, attractive| Mie { repulsive, attractive }.formula();
        let lennard_jones = LennardJones {};
        for r in [0.9_f64, 1.0, 1.122_462, 1.7, 2.5] {
            let (a, b) =
                (mie(12, 6).on(Side::Inside, r * r), lennard_jones.on(Side::Inside, r * r));
            let unit = LennardJones::UNIT;
            for (a, b) in [(a.energy, b.energy), (a.force, b.force), (a.curvature, b.curvature)] {
                assert!((a - unit * b).abs() < 1e-12 * (1.0 + a.abs()), "{r}: {a} {b}");
            }
        }
        for (of_mie, of_lennard_jones) in [
            (mie(12, 6).tail_energy(2.5), lennard_jones.tail_energy(2.5)),
            (mie(12, 6).tail_virial(2.5), lennard_jones.tail_virial(2.5)),
        ] {
            assert!((of_mie / of_lennard_jones - 1.0).abs() < 1e-13);
        }
        // The strength of 11-6, to all digits of another program.
        assert!((mie(11, 6).strength - 4.553_154_66).abs() < 5e-9);
        for (n, m) in [(14, 6), (11, 5), (9, 6), (72, 4)] {
            // U′ = 0 at r = (n/m)^{1/(n−m)}.
            let (n_real, m_real) = (f64::from(n), f64::from(m));
            let r = (n_real / m_real).powf(1.0 / (n_real - m_real));
            let at_minimum = mie(n, m).on(Side::Inside, r * r);
            assert!((at_minimum.energy + 1.0).abs() < 1e-13, "{n}-{m}");
            assert!(at_minimum.force.abs() < 1e-11 && at_minimum.curvature > 0.0);
        }
    }
}
